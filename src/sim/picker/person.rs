//! One simulated person who picks: what is on the screen, what the hands do about it, and what goes wrong.
//!
//! Main types: [`SimPicker`], [`StationScreen`]. Refuses: to know what the fleet believes; it sees the screen, the rack
//! and the totes.

use super::limbs::limbs;
use super::path::HandPath;
use super::screen::{ShownLine, StationScreen};
use super::watch::{TruePicker, angles_of};
use super::work::{LineWork, PickFigures};
use crate::cell::arm::Capsule;
use crate::cell::{FacePlace, LineChange, PickFace};
use crate::fleet::{StationOrder, WrongReach};
use crate::id::JobId;
use crate::sim::random::Stream;
use crate::sim::{HandSide, PickerHabits};
use crate::time::{Span, Time};
use crate::warehouse::SlotName;

/// How deep behind the face pieces lie, metres; and in front of it a hand is straight ahead of its slot.
const PIECE_M: f64 = 0.12;
const AHEAD_M: f64 = 0.22;
/// Where the picker stands, metres from the rack's middle.
const STANDS_M: f64 = 1.05;
/// A hand that carries a piece takes so much longer than one that reaches, as moves to a place do beside reaches in
/// MTM-1 (Maynard, Stegemerten and Schwab 1948).
const CARRIES: f64 = 1.15;
/// Where both hands pick, the other one is so far beside, metres.
const BESIDE_M: f64 = 0.04;
/// How long a hand is in a tote (a light position and a release in MTM-1) and at a button, seconds.
const PUT_S: f64 = 0.25;
const PRESS_S: f64 = 0.12;
/// A person who was warned acts so much later, seconds; and so many do.
const REACTS_S: f64 = 0.25;
const REACTS: f64 = 0.95;
/// A line that is still lit so long after its last piece was put down is confirmed by the button, seconds.
const ASKED_S: f64 = 0.8;
/// Spread of the logarithm of the time in a slot.
const RUMMAGE_SPREAD: f64 = 0.35;
/// How far the eyes are ahead of the hand, seconds; and what the head does of it, in yaw and in pitch.
const LEAD_S: f64 = 0.2;
const TURNS: [f64; 2] = [0.7, 0.4];
/// Who reaches lower than this bends, by so much of it; metres.
const BENDS_BELOW_M: f64 = 1.0;
const BENDS: f64 = 0.45;
/// Warnings so soon after a hand was astray are about that, seconds.
const ASTRAY_S: f64 = 1.0;

/// What comes when the present movement or stay is over.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Next {
    Look,
    Redirect,
    Enter,
    Out,
    PutBack,
    Over(usize),
    Put(usize),
    TakeUp(usize),
    Press(bool),
    Pressed(bool),
}

/// A line whose pieces are all put down, as far as the picker knows.
#[derive(Clone, Copy, Debug)]
struct ClaimedLine {
    job: JobId,
    n: usize,
    since: Time,
    is_short: bool,
}

/// A simulated person who picks.
#[derive(Clone, Debug)]
pub struct SimPicker {
    habits: PickerHabits,
    /// Whether each line is confirmed by a button.
    presses: bool,
    random: Stream,
    face: PickFace,
    hands: [HandPath; 2],
    next: Next,
    until: Time,
    work: Option<LineWork>,
    claim: Option<ClaimedLine>,
    /// When the person acts on a warning, and which.
    react: Option<(Time, WrongReach)>,
    /// When the hand was on a wrong way last.
    astray: Time,
    away: Option<Time>,
    goes_away: Time,
    /// What truly happened.
    pub figures: PickFigures,
}

impl SimPicker {
    /// A person who stands before a rack's face.
    pub fn new(
        habits: PickerHabits,
        presses: bool,
        face: PickFace,
        mut random: Stream,
        now: Time,
    ) -> SimPicker {
        let goes_away = next_away(&habits, now, &mut random);
        let hands = [0, 1].map(|i| HandPath::rest(rests_at(i), now));
        SimPicker {
            habits,
            presses,
            random,
            face,
            hands,
            next: Next::Look,
            until: now,
            work: None,
            claim: None,
            react: None,
            astray: Time::ZERO,
            away: None,
            goes_away,
            figures: PickFigures::default(),
        }
    }

    /// The face of the rack that is there, or was last.
    pub fn face(&self) -> &PickFace {
        &self.face
    }

    /// Another rack is there.
    pub fn turn_to(&mut self, face: PickFace) {
        self.face = face;
    }

    /// Whether the person is away.
    pub fn is_away(&self) -> bool {
        self.away.is_some()
    }

    /// Whether the person has nothing to pick and nothing to confirm.
    pub fn is_idle(&self) -> bool {
        self.work.is_none() && self.claim.is_none() && self.away.is_none() && self.next == Next::Look
    }

    /// The line that is picked, or was picked last, with how many of its pieces are put down.
    pub fn pieces_put(&self) -> Option<((JobId, usize), u32)> {
        let work = self.work.as_ref().or(self.figures.finished.as_ref())?;
        Some(((work.line.job, work.line.n), work.put()))
    }

    /// Whether a hand is in the opening or in the rack.
    pub fn is_inside(&self, now: Time) -> bool {
        self.hands.iter().any(|hand| self.face.is_inside(hand.at(now)))
    }

    /// Where the person is.
    pub fn truth(&mut self, now: Time) -> TruePicker {
        let (hand, head) = (&self.hands[self.main()], self.head(now));
        let (yaw, pitch) = angles_of(hand.at(now + Span::from_secs_f64(LEAD_S)) - head);
        let shakes = |at: FacePlace, random: &mut Stream, m: f64| {
            at + FacePlace::new(random.normal(), random.normal(), random.normal()) * m
        };
        let grips = [0, 1].map(|i| self.hands[i].at(now));
        let grips = grips.map(|at| shakes(at, &mut self.random, self.habits.tremor_m));
        TruePicker { head, faces: [TURNS[0] * yaw, TURNS[1] * pitch], grips }
    }

    /// Where the middle of the head is: who reaches low bends down.
    fn head(&self, now: Time) -> FacePlace {
        let low_m = (BENDS_BELOW_M - self.hands[self.main()].at(now).z).max(0.0);
        FacePlace::new(0.0, STANDS_M, 0.93 * self.habits.height_m - BENDS * low_m)
    }

    /// Steps back, out of reach, until then; a person who is away longer anyway stays away.
    pub fn step_back(&mut self, until: Time) {
        self.away = self.away.max(Some(until));
    }

    /// Arms, head and trunk where they are, or would be if the person were there.
    pub fn limbs_there(&self, now: Time) -> Vec<Capsule> {
        let grips = [0, 1].map(|i| self.hands[i].at(now));
        limbs(&self.face, self.habits.height_m, self.head(now), grips)
    }

    /// Arms, head and trunk; nothing of a person who is away.
    pub fn limbs(&self, now: Time) -> Vec<Capsule> {
        if self.is_away() { Vec::new() } else { self.limbs_there(now) }
    }

    /// The hands stop for so long.
    pub fn wait(&mut self, now: Time, by: Span) {
        if self.until > now {
            self.hands.iter_mut().filter(|hand| hand.end() > now).for_each(|hand| hand.delay(by));
            self.until += by;
        }
    }

    fn main(&self) -> usize {
        match self.habits.hand {
            HandSide::Left => 0,
            HandSide::Right => 1,
        }
    }

    /// The screen warns.
    pub fn warn(&mut self, now: Time, wrong: WrongReach) {
        let is_wrong = match wrong {
            WrongReach::Slot(_) => self.is_astray(now),
            WrongReach::Tote(_) => self.is_wrong_tote() || now - self.astray < Span::from_secs_f64(ASTRAY_S),
        };
        self.figures.note_warning(wrong, is_wrong, self.work.as_mut(), now);
        if is_wrong && self.react.is_none() && self.random.happens_of(REACTS) {
            self.react = Some((now + Span::from_secs_f64(REACTS_S), wrong));
        }
    }

    /// Whether a piece is in a wrong tote, or about to be.
    fn is_wrong_tote(&self) -> bool {
        match (self.next, &self.work) {
            (Next::Over(tote) | Next::Put(tote), Some(work)) => tote != work.line.tote,
            _ => self.figures.is_wrong_tote(self.work.as_ref(), self.claim.map(|c| (c.job, c.n))),
        }
    }

    fn is_astray(&self, now: Time) -> bool {
        let aims = self.work.as_ref().is_some_and(|w| w.aims_at != w.line.slot);
        aims || self.next == Next::PutBack || now - self.astray < Span::from_secs_f64(ASTRAY_S)
    }

    /// Lives until `now`. Gives what the person says, with when.
    pub fn advance(&mut self, now: Time, screen: &StationScreen) -> Vec<(Time, StationOrder)> {
        let mut said = Vec::new();
        loop {
            let reacts = self.react.filter(|(at, _)| *at <= self.until && *at <= now);
            if let Some((at, wrong)) = reacts {
                self.react = None;
                self.mend(at, wrong);
            } else if self.until <= now {
                let at = self.until;
                said.extend(self.go_on(at, now, screen).map(|order| (at, order)));
            } else {
                return said;
            }
        }
    }

    fn stay(&mut self, at: Time, seconds: f64, next: Next) {
        (self.until, self.next) = (at + Span::from_secs_f64(seconds), next);
    }

    /// Moves a hand, and the other one with it where both pick.
    fn reach(&mut self, at: Time, to: FacePlace, next: Next) {
        let main = self.main();
        let both = self.work.as_ref().is_some_and(|w| w.both_hands);
        let mut ends = at;
        for i in [main, 1 - main] {
            let other = i != main;
            if other && !both {
                self.rest(i, at);
                continue;
            }
            let side_m = if i == 0 { -BESIDE_M } else { BESIDE_M };
            let aside = FacePlace::new(if other { side_m } else { 0.0 }, 0.0, 0.0);
            let (from, to) = (self.hands[i].at(at), to + aside);
            let ways = [self.straight_out(from), self.straight_out(to)];
            let pace = self.habits.pace * if matches!(next, Next::Over(_)) { CARRIES } else { 1.0 };
            self.hands[i] = HandPath::new([from, to], ways, at, pace, &mut self.random);
            ends = ends.max(self.hands[i].end());
        }
        (self.until, self.next) = (ends, next);
    }

    fn piece_in(&self, slot: SlotName) -> FacePlace {
        self.face.slot(slot) - FacePlace::new(0.0, PIECE_M, 0.0)
    }

    fn button(&self) -> FacePlace {
        FacePlace::new(0.5, self.face.opening_m() + 0.15, 1.2)
    }

    fn go_on(&mut self, at: Time, now: Time, screen: &StationScreen) -> Option<StationOrder> {
        match self.next {
            Next::Look => {
                self.look(at, now, screen);
                None
            }
            Next::Redirect => {
                let slot = self.work.as_ref().expect("it goes to a slot").line.slot;
                self.astray = at;
                self.aim(at, slot);
                None
            }
            Next::Enter => self.enter(at, screen),
            Next::Out => self.come_out(at),
            Next::PutBack => {
                self.astray = at;
                self.aim_anew(at);
                None
            }
            Next::Over(tote) => {
                self.stay(at, PUT_S, Next::Put(tote));
                None
            }
            Next::Put(tote) => self.put(at, tote),
            Next::TakeUp(from) => {
                self.figures.take_up(self.work.as_mut().expect("a line is picked"), from);
                let tote = self.work.as_ref().expect("a line is picked").line.tote;
                self.carry(at, tote);
                None
            }
            Next::Press(is_short) => {
                self.stay(at, PRESS_S, Next::Pressed(is_short));
                None
            }
            Next::Pressed(is_short) => {
                self.stay(at, 0.0, Next::Look);
                self.press(at, is_short, screen)
            }
        }
    }

    /// Nothing is in hand: what is to be done next?
    fn look(&mut self, at: Time, now: Time, screen: &StationScreen) {
        // It looks again at the next moment at which the screen may have changed.
        self.until = now + Span(1);
        if let Some(back) = self.away {
            if at < back {
                return;
            }
            self.away = None;
            self.goes_away = next_away(&self.habits, at, &mut self.random);
        }
        if let Some(claim) = self.claim {
            let is_it = |line: &ShownLine| (line.job, line.n) == (claim.job, claim.n);
            if ![screen.lit, screen.last].iter().flatten().any(is_it) {
                self.claim = None;
            } else if at - claim.since >= Span::from_secs_f64(ASKED_S) {
                return self.reach(at, self.button(), Next::Press(claim.is_short));
            } else {
                return;
            }
        }
        if at >= self.goes_away {
            self.away = Some(at + Span::from_secs_f64(self.random.exponential(self.habits.away_s)));
            self.hands = [0, 1].map(|i| HandPath::rest(rests_at(i), at));
            return;
        }
        match screen.lit.filter(|_| screen.is_here) {
            Some(line) => self.begin(at, line),
            None => [0, 1].into_iter().for_each(|hand| self.rest(hand, at)),
        }
    }

    /// A hand goes to where it rests, if it is not on its way there.
    fn rest(&mut self, hand: usize, at: Time) {
        let from = self.hands[hand].at(at);
        if self.hands[hand].to() != rests_at(hand) {
            let leaves = self.straight_out(from);
            let (ends, pace) = ([from, rests_at(hand)], self.habits.pace);
            self.hands[hand] = HandPath::new(ends, [leaves, None], at, pace, &mut self.random);
        }
    }

    /// Where a hand is straight ahead of the slot in which it is; nothing of one that is in none.
    fn straight_out(&self, at: FacePlace) -> Option<FacePlace> {
        (self.face.depth_m(at) > 0.0).then(|| FacePlace::new(at.x, at.y + PIECE_M + AHEAD_M, at.z))
    }

    fn begin(&mut self, at: Time, line: ShownLine) {
        let (h, random) = (&self.habits, &mut self.random);
        let mut looks_s = h.looks_first_s * (0.3 * random.normal()).exp() * h.pace;
        let (missing, both) = (random.happens_of(h.missing), random.happens_of(h.both_hands));
        if random.happens_of(h.wanders) {
            looks_s *= 2.0;
        }
        self.work = Some(LineWork::new(line, missing, both && line.left >= 2));
        self.aim_anew(at + Span::from_secs_f64(looks_s));
    }

    /// A reach for a piece: to the slot, or to a wrong one, or first towards another.
    fn aim_anew(&mut self, at: Time) {
        let slot = self.work.as_ref().expect("a line is picked").line.slot;
        let (mistakes, changes) = (self.habits.mispick, self.habits.changes_mind);
        if self.random.happens_of(mistakes) {
            let wrong = self.another(slot);
            self.figures.begin_wrong(self.work.as_mut().expect("a line is picked"));
            self.aim(at, wrong);
        } else if self.random.happens_of(changes) {
            let other = self.another(slot);
            self.aim(at, other);
            let whole = (self.until - at).as_secs_f64();
            self.work.as_mut().expect("a line is picked").aims_at = slot;
            self.astray = at + Span::from_secs_f64(0.5 * whole);
            let before_s = self.random.between(0.3, 0.5) * whole;
            self.stay(at, before_s, Next::Redirect);
        } else {
            self.aim(at, slot);
        }
    }

    /// A slot beside another one.
    fn another(&mut self, slot: SlotName) -> SlotName {
        let beside = |s: SlotName| {
            let apart = s.column().abs_diff(slot.column()) + s.row().abs_diff(slot.row());
            (1..=2).contains(&apart)
        };
        let all: Vec<SlotName> = self.face.slots().map(|(s, _)| s).filter(|s| beside(*s)).collect();
        if all.is_empty() { slot } else { all[self.random.below(all.len())] }
    }

    fn aim(&mut self, at: Time, slot: SlotName) {
        self.work.as_mut().expect("a line is picked").aims_at = slot;
        let to = self.piece_in(slot);
        self.reach(at, to, Next::Enter);
    }

    /// The hand is in a slot. If the rack has left meanwhile, there is nothing.
    fn enter(&mut self, at: Time, screen: &StationScreen) -> Option<StationOrder> {
        let work = self.work.as_mut().expect("a line is picked");
        if !screen.is_here {
            self.figures.dismissed_early += 1;
            self.claim = Some(ClaimedLine { job: work.line.job, n: work.line.n, since: at, is_short: true });
            self.work = None;
            self.stay(at, 0.0, Next::Look);
            return None;
        }
        work.hand_in = Some(at);
        let spread = (RUMMAGE_SPREAD * self.random.normal()).exp();
        self.stay(at, self.habits.rummage_s * spread * self.habits.pace, Next::Out);
        None
    }

    /// The hand has a piece, or has found none.
    fn come_out(&mut self, at: Time) -> Option<StationOrder> {
        let work = self.work.as_mut().expect("a line is picked");
        if work.finds_nothing() {
            self.claim = Some(ClaimedLine { job: work.line.job, n: work.line.n, since: at, is_short: true });
            self.work = None;
            self.reach(at, self.button(), Next::Press(true));
            return None;
        }
        work.grasp();
        self.figures.came_out(work, at);
        let (right, totes) = (work.line.tote, self.face.totes());
        let wrong = totes > 1 && self.random.happens_of(self.habits.mistote);
        let tote = if wrong { (right + 1 + self.random.below(totes - 1)) % totes } else { right };
        self.figures.carry(wrong);
        self.carry(at, tote);
        None
    }

    fn carry(&mut self, at: Time, tote: usize) {
        let rim = self.face.tote(tote).expect("the line names a tote of the station");
        self.reach(at, rim - FacePlace::new(0.0, 0.0, 0.05), Next::Over(tote));
    }

    fn put(&mut self, at: Time, tote: usize) -> Option<StationOrder> {
        let work = self.work.as_mut().expect("a line is picked");
        self.figures.put(work, tote);
        if work.is_filled() {
            let line = work.line;
            self.claim = Some(ClaimedLine { job: line.job, n: line.n, since: at, is_short: false });
            if self.presses {
                self.work = None;
                self.reach(at, self.button(), Next::Press(false));
            } else {
                self.stay(at, 0.0, Next::Look);
                self.figures.finished = self.work.take();
            }
        } else {
            self.aim_anew(at);
        }
        None
    }

    /// What the button says, of what is on the screen.
    fn press(&mut self, at: Time, is_short: bool, screen: &StationScreen) -> Option<StationOrder> {
        let claim = self.claim.as_mut()?;
        claim.since = at;
        let is_it = |line: &&ShownLine| (line.job, line.n) == (claim.job, claim.n);
        let change = |line: &ShownLine| match is_short {
            true => LineChange::Short,
            false => LineChange::Done(line.left),
        };
        self.figures.presses += 1;
        self.figures.lines.entry((claim.job, claim.n)).or_default().is_pressed = true;
        if let Some(line) = screen.lit.as_ref().filter(is_it) {
            return Some(StationOrder::Line(line.n, change(line)));
        }
        screen.last.as_ref().filter(is_it).map(|line| StationOrder::Last(change(line)))
    }

    /// Acts on a warning, if it is not too late.
    fn mend(&mut self, at: Time, wrong: WrongReach) {
        match (wrong, self.next) {
            (WrongReach::Slot(_), Next::Enter | Next::Out) => {
                let Some(work) = self.work.as_mut().filter(|w| w.aims_at != w.line.slot) else { return };
                let (slot, hand_in) = (work.line.slot, work.hand_in.unwrap_or(self.until));
                self.figures.note_lead_of(work, hand_in);
                self.astray = at;
                self.aim(at, slot);
            }
            (WrongReach::Slot(_), Next::Over(_)) => {
                // The wrong piece goes back, and the right one is fetched.
                let Some(work) = self.work.as_mut().filter(|w| w.aims_at != w.line.slot) else { return };
                work.drop_pieces();
                let (slot, line) = (work.aims_at, work.line.slot);
                work.aims_at = line;
                self.astray = at;
                let to = self.piece_in(slot);
                self.reach(at, to, Next::PutBack);
            }
            (WrongReach::Tote(_), Next::Over(tote) | Next::Put(tote)) => {
                let right = self.work.as_ref().expect("a piece is in hand").line.tote;
                if tote != right {
                    self.astray = at;
                    self.carry(at, right);
                }
            }
            (WrongReach::Tote(tote), Next::Look | Next::Enter | Next::Redirect | Next::Press(_)) => {
                let work = self.work.take().or_else(|| self.figures.finished.take());
                let Some(work) = work.filter(|w| w.misplaced == Some(tote)) else { return };
                (self.work, self.claim) = (Some(work), None);
                let rim = self.face.tote(tote).expect("it was put there");
                self.reach(at, rim - FacePlace::new(0.0, 0.0, 0.05), Next::TakeUp(tote));
            }
            _ => {}
        }
    }
}

fn rests_at(hand: usize) -> FacePlace {
    FacePlace::new(if hand == 0 { -0.22 } else { 0.22 }, STANDS_M - 0.1, 0.95)
}

fn next_away(habits: &PickerHabits, now: Time, random: &mut Stream) -> Time {
    match habits.away_per_hour {
        0.0 => Time::MAX,
        rate => now + Span::from_secs_f64(random.exponential(3600.0 / rate)),
    }
}

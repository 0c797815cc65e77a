//! One simulated person who picks: reads the screen, moves the hands accordingly, and makes mistakes.
//!
//! Main types: [`SimPicker`], [`StationScreen`]. Refuses: to know what the fleet believes; it sees the screen, the rack
//! and the totes.

mod reach;
mod warned;

use super::eyes::Eyes;
use super::limbs::limbs;
use super::path::HandPath;
use super::screen::{ShownLine, StationScreen};
use super::watch::TruePicker;
use super::work::{LineWork, PickFigures};
use crate::random::Stream;
use crate::scenario::{HandSide, PickerHabits};
use giveway_cell::arm::Capsule;
use giveway_cell::{FacePlace, LineChange, PickFace};
use giveway_fleet::{StationOrder, WrongReach};
use giveway_floor::id::JobId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::SlotName;

/// Distance of the picker from the rack's middle, metres.
const STANDS_M: f64 = 1.05;
/// How long a hand is in a tote (a light position and a release in MTM-1) and at a button, seconds.
const PUT_S: f64 = 0.25;
const PRESS_S: f64 = 0.12;
/// A line still lit this long after its last piece was put down is confirmed by the button, seconds.
const ASKED_S: f64 = 0.8;
/// A rack still there this long after its last line was over is released by the button.
const STUCK: Span = Span::from_secs(3);
/// Standard deviation of the logarithm of the time in a slot.
const RUMMAGE_SPREAD: f64 = 0.35;
/// Height of the screen above the floor, over the opening, metres.
const SCREEN_M: f64 = 2.15;
/// A person who reaches lower than this bends down by this share of the difference; metres.
const BENDS_BELOW_M: f64 = 1.0;
const BENDS: f64 = 0.45;
/// How far a lowered head tilts down, radians per metre: about a third of the trunk's bend if the trunk does all the
/// lowering; knees and neck do the rest. Recorded people stood upright.
const NODS: f64 = 0.9;

/// The picker's next action when the present movement or stay is over.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Next {
    Look,
    /// The hand sets out, towards another slot first where one is named.
    SetOut(Option<SlotName>),
    /// The hand was on its way to this slot and turns.
    Redirect(SlotName),
    Enter,
    Out,
    PutBack(SlotName),
    Over(usize),
    Put(usize),
    TakeUp(usize),
    Press(PickButton),
    Pressed(PickButton),
}

/// What a press of the button reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PickButton {
    /// The line is done.
    Done,
    /// Pieces of the line are missing.
    Short,
    /// The rack may leave.
    LetGo,
}

/// A line whose pieces are all put down, as far as the picker knows.
#[derive(Clone, Copy, Debug)]
struct ClaimedLine {
    job: JobId,
    n: usize,
    since: Time,
    button: PickButton,
}

/// A simulated picker.
#[derive(Clone, Debug)]
pub struct SimPicker {
    habits: PickerHabits,
    /// Whether the picker confirms each line by a button.
    presses: bool,
    random: Stream,
    /// A separate stream for tremor, so that a person acts the same whether or not a headset looks.
    tremor: Stream,
    face: PickFace,
    hands: [HandPath; 2],
    eyes: Eyes,
    next: Next,
    until: Time,
    work: Option<LineWork>,
    claim: Option<ClaimedLine>,
    /// Since when a rack stands there with nothing left to pick from it.
    stuck: Option<Time>,
    /// Warnings under way, with their arrival times.
    warnings: Vec<(Time, WrongReach)>,
    /// When the person acts on a warning, and on which.
    react: Option<(Time, WrongReach)>,
    /// When the hand last was on a wrong path, and where that led.
    astray: Option<(Time, WrongReach)>,
    away: Option<Time>,
    goes_away: Time,
    /// True figures of this person's picks.
    pub figures: PickFigures,
}

impl SimPicker {
    /// A person who stands before a rack's face; one of the streams is for actions, the other for tremor.
    pub fn new(
        habits: PickerHabits,
        presses: bool,
        face: PickFace,
        [mut random, tremor]: [Stream; 2],
        now: Time,
    ) -> SimPicker {
        let goes_away = next_away(&habits, now, &mut random);
        let hands = [0, 1].map(|i| HandPath::rest(rests_at(i), now));
        SimPicker {
            habits,
            presses,
            random,
            tremor,
            eyes: Eyes::new(screen_over(&face), now),
            face,
            hands,
            next: Next::Look,
            until: now,
            work: None,
            claim: None,
            stuck: None,
            warnings: Vec::new(),
            react: None,
            astray: None,
            away: None,
            goes_away,
            figures: PickFigures::default(),
        }
    }

    /// The face of the rack that is there, or of the last one.
    pub fn face(&self) -> &PickFace {
        &self.face
    }

    /// Turns to the face of another rack.
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

    /// The line in progress, or the last one, with how many of its pieces are put down.
    pub fn pieces_put(&self) -> Option<((JobId, usize), u32)> {
        let work = self.work.as_ref().or(self.figures.finished.as_ref())?;
        Some(((work.line.job, work.line.n), work.put()))
    }

    /// Whether a hand is in the opening or in the rack.
    pub fn is_inside(&self, now: Time) -> bool {
        self.hands.iter().any(|hand| self.face.is_inside(hand.at(now)))
    }

    /// The person's true head and hands.
    pub fn truth(&mut self, now: Time) -> TruePicker {
        let head = self.head(now);
        self.eyes.follow(now, head);
        let ([yaw, pitch], looks) = (self.eyes.faces(now, head), self.eyes.looks(head));
        let faces = [yaw, pitch - NODS * self.lowered_m(now)];
        let shakes = |at: FacePlace, random: &mut Stream, m: f64| {
            at + FacePlace::new(random.normal(), random.normal(), random.normal()) * m
        };
        let grips = [0, 1].map(|i| self.hands[i].at(now));
        let grips = grips.map(|at| shakes(at, &mut self.tremor, self.habits.tremor_m));
        TruePicker { head, faces, looks, grips }
    }

    /// Position of the middle of the head.
    fn head(&self, now: Time) -> FacePlace {
        FacePlace::new(0.0, STANDS_M, 0.93 * self.habits.height_m - self.lowered_m(now))
    }

    /// How much lower the head is than upright, metres: a person who reaches low bends down.
    fn lowered_m(&self, now: Time) -> f64 {
        BENDS * (BENDS_BELOW_M - self.hands[self.main()].at(now).z).max(0.0)
    }

    /// The person steps back, out of reach, until `until`; a person already away for longer stays away.
    pub fn step_back(&mut self, until: Time) {
        self.away = self.away.max(Some(until));
    }

    /// Capsules of arms, head and trunk, even of a person who is away.
    pub fn limbs_there(&self, now: Time) -> Vec<Capsule> {
        let grips = [0, 1].map(|i| self.hands[i].at(now));
        limbs(&self.face, self.habits.height_m, self.head(now), grips)
    }

    /// Capsules of arms, head and trunk; none of a person who is away.
    pub fn limbs(&self, now: Time) -> Vec<Capsule> {
        if self.is_away() { Vec::new() } else { self.limbs_there(now) }
    }

    /// Stops the hands for `by`.
    pub fn wait(&mut self, now: Time, by: Span) {
        if self.until > now {
            self.hands.iter_mut().filter(|hand| hand.end() > now).for_each(|hand| hand.delay(by));
            self.until += by;
            self.eyes.delay(by);
        }
    }

    fn main(&self) -> usize {
        match self.habits.hand {
            HandSide::Left => 0,
            HandSide::Right => 1,
        }
    }

    /// Advances the person to `now`. Gives what the person reports, with times.
    pub fn advance(&mut self, now: Time, screen: &StationScreen) -> Vec<(Time, StationOrder)> {
        let mut said = Vec::new();
        loop {
            while self.is_warned_until(now.min(self.until)) {}
            if self.until > now {
                return said;
            }
            let at = self.until;
            said.extend(self.go_on(at, now, screen).map(|order| (at, order)));
        }
    }

    fn stay(&mut self, at: Time, seconds: f64, next: Next) {
        (self.until, self.next) = (at + Span::from_secs_f64(seconds), next);
    }

    fn go_on(&mut self, at: Time, now: Time, screen: &StationScreen) -> Option<StationOrder> {
        match self.next {
            Next::Look => {
                self.look(at, now, screen);
                None
            }
            Next::SetOut(first) => {
                self.set_out(at, first);
                None
            }
            Next::Redirect(from) => {
                self.redirect(at, from);
                None
            }
            Next::Enter => self.enter(at, screen),
            Next::Out => self.come_out(at),
            Next::PutBack(slot) => {
                self.astray = Some((at, WrongReach::Slot(slot)));
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
            Next::Press(button) => {
                self.stay(at, PRESS_S, Next::Pressed(button));
                None
            }
            Next::Pressed(button) => {
                self.stay(at, 0.0, Next::Look);
                self.press(at, button, screen)
            }
        }
    }

    /// With nothing in hand, decides what to do next.
    fn look(&mut self, at: Time, now: Time, screen: &StationScreen) {
        // The person looks again at the next moment at which the screen may have changed.
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
                return self.go_press(at, claim.button);
            } else {
                return self.turn_eyes(at, screen_over(&self.face));
            }
        }
        if at >= self.goes_away {
            self.away = Some(at + Span::from_secs_f64(self.random.exponential(self.habits.away_s)));
            self.hands = [0, 1].map(|i| HandPath::rest(rests_at(i), at));
            self.stuck = None;
            return;
        }
        self.stuck = screen.is_over.then(|| self.stuck.unwrap_or(at));
        if self.stuck.take_if(|since| at - *since >= STUCK).is_some() {
            return self.go_press(at, PickButton::LetGo);
        }
        match screen.lit.filter(|_| screen.is_here) {
            Some(line) => self.begin(at, line),
            None => {
                self.turn_eyes(at, screen_over(&self.face));
                [0, 1].into_iter().for_each(|hand| self.rest(hand, at));
            }
        }
    }

    fn begin(&mut self, at: Time, line: ShownLine) {
        let (h, random) = (&self.habits, &mut self.random);
        let looks_s = h.looks_first_s * (0.3 * random.normal()).exp() * h.pace;
        let (missing, both) = (random.happens_of(h.missing), random.happens_of(h.both_hands));
        self.work = Some(LineWork::new(line, missing, both && line.left >= 2));
        let (first, glances_s) = self.choose(at);
        self.stay(at, looks_s + glances_s, Next::SetOut(first));
    }

    /// The hand is in a slot. If the rack has left meanwhile, the hand finds nothing.
    fn enter(&mut self, at: Time, screen: &StationScreen) -> Option<StationOrder> {
        if !screen.is_here {
            self.note_lead(at);
            let ShownLine { job, n, .. } = self.work.take().expect("a line is picked").line;
            self.figures.dismissed_early += 1;
            self.claim = Some(ClaimedLine { job, n, since: at, button: PickButton::Short });
            self.stay(at, 0.0, Next::Look);
            return None;
        }
        let spread = (RUMMAGE_SPREAD * self.random.normal()).exp();
        self.stay(at, self.habits.rummage_s * spread * self.habits.pace, Next::Out);
        None
    }

    /// The hand has a piece, or has found none.
    fn come_out(&mut self, at: Time) -> Option<StationOrder> {
        let work = self.work.as_mut().expect("a line is picked");
        if work.finds_nothing() {
            let (ShownLine { job, n, .. }, button) = (work.line, PickButton::Short);
            self.claim = Some(ClaimedLine { job, n, since: at, button });
            self.work = None;
            self.go_press(at, button);
            return None;
        }
        work.grasp();
        self.note_lead(at);
        let work = self.work.as_mut().expect("a line is picked");
        let (right, totes) = (work.line.tote, self.face.totes());
        let wrong = totes > 1 && self.random.happens_of(self.habits.mistote);
        let tote = if wrong { (right + 1 + self.random.below(totes - 1)) % totes } else { right };
        self.figures.carry(wrong);
        self.carry(at, tote);
        None
    }

    fn put(&mut self, at: Time, tote: usize) -> Option<StationOrder> {
        let work = self.work.as_mut().expect("a line is picked");
        self.figures.put(work, tote);
        if work.is_filled() {
            let (ShownLine { job, n, .. }, button) = (work.line, PickButton::Done);
            self.claim = Some(ClaimedLine { job, n, since: at, button });
            if self.presses {
                self.work = None;
                self.go_press(at, button);
            } else {
                self.stay(at, 0.0, Next::Look);
                self.figures.finished = self.work.take();
            }
        } else {
            self.aim_anew(at);
        }
        None
    }

    /// What a press of the button reports, given the screen.
    fn press(&mut self, at: Time, button: PickButton, screen: &StationScreen) -> Option<StationOrder> {
        if button == PickButton::LetGo {
            self.figures.released += u64::from(screen.is_over);
            return screen.is_over.then_some(StationOrder::Release);
        }
        let claim = self.claim.as_mut()?;
        claim.since = at;
        let is_it = |line: &&ShownLine| (line.job, line.n) == (claim.job, claim.n);
        let change = |line: &ShownLine| match button {
            PickButton::Short => LineChange::Short,
            _ => LineChange::Done(line.left),
        };
        self.figures.presses += 1;
        self.figures.lines.entry((claim.job, claim.n)).or_default().is_pressed = true;
        if let Some(line) = screen.lit.as_ref().filter(is_it) {
            return Some(StationOrder::Line(line.n, change(line)));
        }
        screen.last.as_ref().filter(is_it).map(|line| StationOrder::Last(change(line)))
    }
}

/// Position of the screen, over the opening to a rack.
fn screen_over(face: &PickFace) -> FacePlace {
    FacePlace::new(0.0, face.opening_m(), SCREEN_M)
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

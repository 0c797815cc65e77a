//! Where a picker's hands and eyes go, and how: slots (sometimes a wrong one), totes, the button, and back to rest.
//!
//! Eyes go first: they are at a hand's target when it sets out, and leave with it. Refuses: to judge the outcome.

use super::{Next, PickButton, SimPicker, rests_at};
use crate::picker::path::HandPath;
use giveway_cell::FacePlace;
use giveway_fleet::WrongReach;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::SlotName;

/// Depth of pieces behind the face, and distance in front of it at which a hand is straight ahead of its slot, metres.
const PIECE_M: f64 = 0.12;
const AHEAD_M: f64 = 0.22;
/// Offset of pieces from the middle of their slot in the mean square, metres; then the distance that fingers keep from
/// its walls, metres.
const STREWN_M: f64 = 0.03;
const WALL_M: f64 = 0.03;
/// Factor by which a hand that carries a piece is slower than one that reaches, as moves compare with reaches in MTM-1
/// (Maynard, Stegemerten and Schwab 1948).
const CARRIES: f64 = 1.15;
/// Distance between the hands where both pick, metres.
const BESIDE_M: f64 = 0.04;
/// How long wandering eyes are on another slot, seconds.
const GLANCES_S: [f64; 2] = [0.25, 0.45];
/// A hand that changes its target turns after such a share of the path's duration …
const TURNS_AFTER: [f64; 2] = [0.3, 0.5];
/// … and is visibly on the wrong path after this share.
const LEAVES_AFTER: f64 = 0.5;

impl SimPicker {
    /// Makes the eyes jump to a place.
    pub(super) fn turn_eyes(&mut self, at: Time, place: FacePlace) {
        let head = self.head(at);
        self.eyes.look_at(place, at, head);
    }

    /// Moves a hand, and the other one with it if both pick.
    fn reach(&mut self, at: Time, to: FacePlace, next: Next) {
        let main = self.main();
        let both = self.picks_with_both();
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

    fn picks_with_both(&self) -> bool {
        self.work.as_ref().is_some_and(|w| w.both_hands)
    }

    /// Sends a hand to its resting place, if it is not on its way there.
    pub(super) fn rest(&mut self, hand: usize, at: Time) {
        let from = self.hands[hand].at(at);
        if self.hands[hand].to() != rests_at(hand) {
            let leaves = self.straight_out(from);
            let (ends, pace) = ([from, rests_at(hand)], self.habits.pace);
            self.hands[hand] = HandPath::new(ends, [leaves, None], at, pace, &mut self.random);
        }
    }

    /// The point straight ahead of the slot that a hand is in; nothing if it is in none.
    fn straight_out(&self, at: FacePlace) -> Option<FacePlace> {
        (self.face.depth_m(at) > 0.0).then(|| FacePlace::new(at.x, at.y + PIECE_M + AHEAD_M, at.z))
    }

    /// Where the hand finds a piece in a slot.
    fn piece_in(&mut self, slot: SlotName) -> FacePlace {
        let columns = self.face.slots().filter(|(s, _)| s.row() == slot.row()).count();
        let half_m = self.face.width_m() / (2.0 * columns.max(1) as f64);
        let room_m = half_m - WALL_M - if self.picks_with_both() { BESIDE_M } else { 0.0 };
        let aside_m = STREWN_M * self.random.normal();
        self.face.slot(slot) + FacePlace::new(aside_m.clamp(-room_m.max(0.0), room_m.max(0.0)), -PIECE_M, 0.0)
    }

    /// Chooses the slot to reach for, perhaps a wrong one, and looks at it, or first at another one. Gives the slot
    /// towards which the hand first sets out if it will change its target, and for how long the eyes are elsewhere,
    /// seconds.
    pub(super) fn choose(&mut self, at: Time) -> (Option<SlotName>, f64) {
        let slot = self.work.as_ref().expect("a line is picked").line.slot;
        let (mistakes, changes, wanders) =
            (self.habits.mispick, self.habits.changes_mind, self.habits.wanders);
        let (errs, changes) = (self.random.happens_of(mistakes), self.random.happens_of(changes));
        let wanders = self.random.happens_of(wanders);
        let aims_at = if errs { self.another(slot) } else { slot };
        let first = (changes && !errs).then(|| self.another(slot));
        let work = self.work.as_mut().expect("a line is picked");
        work.aims_at = aims_at;
        if errs {
            self.figures.begin_wrong(work);
        }
        let target = first.unwrap_or(aims_at);
        if !wanders {
            self.turn_eyes(at, self.face.slot(target));
            return (first, 0.0);
        }
        let (other, glances_s) = (self.another(target), self.random.between(GLANCES_S[0], GLANCES_S[1]));
        self.turn_eyes(at, self.face.slot(other));
        self.eyes.look_later(self.face.slot(target), at + Span::from_secs_f64(glances_s));
        (first, glances_s)
    }

    /// A further reach for a piece of the line: the hand does not wait for the eyes.
    pub(super) fn aim_anew(&mut self, at: Time) {
        let (first, _) = self.choose(at);
        self.set_out(at, first);
    }

    /// The hand sets out to the chosen slot.
    pub(super) fn set_out(&mut self, at: Time, first: Option<SlotName>) {
        let aims_at = self.work.as_ref().expect("a line is picked").aims_at;
        self.go_to(at, first.unwrap_or(aims_at));
        if let Some(first) = first {
            let whole_s = (self.until - at).as_secs_f64();
            let leaves = at + Span::from_secs_f64(LEAVES_AFTER * whole_s);
            self.astray = Some((leaves, WrongReach::Slot(first)));
            let before_s = self.random.between(TURNS_AFTER[0], TURNS_AFTER[1]) * whole_s;
            self.stay(at, before_s, Next::Redirect(first));
        }
    }

    /// A hand on its way to a slot turns to the slot of the line.
    pub(super) fn redirect(&mut self, at: Time, from: SlotName) {
        self.astray = Some((at, WrongReach::Slot(from)));
        let slot = self.work.as_ref().expect("it goes to a slot").line.slot;
        self.aim(at, slot);
    }

    /// Eyes and hand go to a slot.
    pub(super) fn aim(&mut self, at: Time, slot: SlotName) {
        self.work.as_mut().expect("a line is picked").aims_at = slot;
        self.turn_eyes(at, self.face.slot(slot));
        self.go_to(at, slot);
    }

    fn go_to(&mut self, at: Time, slot: SlotName) {
        let to = self.piece_in(slot);
        self.reach(at, to, Next::Enter);
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

    /// The hand puts its pieces back into their slot.
    pub(super) fn put_back(&mut self, at: Time, slot: SlotName) {
        self.turn_eyes(at, self.face.slot(slot));
        let to = self.piece_in(slot);
        self.reach(at, to, Next::PutBack(slot));
    }

    /// The hand carries its pieces to a tote. The eyes stay on it until it is out of the slot.
    pub(super) fn carry(&mut self, at: Time, tote: usize) {
        let rim = self.over_tote(at, tote, Next::Over(tote));
        let is_out = |place| self.face.depth_m(place) <= 0.0;
        let out = self.hands[self.main()].first(is_out).unwrap_or(at);
        self.eyes.look_later(rim, out);
    }

    /// The hand fetches a piece out of a tote.
    pub(super) fn fetch(&mut self, at: Time, tote: usize) {
        let rim = self.over_tote(at, tote, Next::TakeUp(tote));
        self.turn_eyes(at, rim);
    }

    /// Moves the hand over a tote; gives the middle of the tote's rim.
    fn over_tote(&mut self, at: Time, tote: usize, next: Next) -> FacePlace {
        let rim = self.face.tote(tote).expect("it is a tote of the station");
        self.reach(at, rim - FacePlace::new(0.0, 0.0, 0.05), next);
        rim
    }

    /// Eyes and hand go to the button.
    pub(super) fn go_press(&mut self, at: Time, button: PickButton) {
        let place = FacePlace::new(0.5, self.face.opening_m() + 0.15, 1.2);
        self.turn_eyes(at, place);
        self.reach(at, place, Next::Press(button));
    }

    /// When the finger tips of the first hand that reaches into the rack pass its face, or would.
    pub(super) fn passes_face(&self) -> Option<Time> {
        let is_in = |place| self.face.depth_m(place) >= 0.0;
        self.reaching().filter_map(|hand| hand.first(is_in)).min()
    }

    /// When the finger tips of the first hand that reaches into the rack come, or would come, to rest at a piece.
    pub(super) fn is_at_piece(&self) -> Option<Time> {
        self.reaching().map(HandPath::end).min()
    }

    fn reaching(&self) -> impl Iterator<Item = &HandPath> {
        let reaches = |i: &usize| *i == self.main() || self.picks_with_both();
        (0..2).filter(reaches).map(|i| &self.hands[i])
    }
}

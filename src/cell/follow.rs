//! One hand at a work cell: in which slot or tote it is, and from which slot it holds a piece.
//!
//! Main types: [`HandFollower`], [`HandEvent`]. A hand that dwells in a slot and comes out has grasped a piece; one
//! that stops in a tote has put it down. A place that the hand cannot have reached is not believed until it has been
//! seen for a while. Refuses: to be sure of what happened while the hand was not seen.

use super::face::{FacePlace, PickFace};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::SlotName;

/// Greatest speed of a hand, metres per second, and the error of measurement, metres.
const FASTEST_MPS: f64 = 3.5;
const ERR_M: f64 = 0.05;
/// Length of a gap after which the hand's deeds in between are unknown; in a shorter one it cannot have been in another
/// slot or tote and back.
const GAP: Span = Span::from_millis(450);
/// Time that the start and the end of a quick movement take together, seconds, and the speed of its middle, metres per
/// second.
const QUICK_S: f64 = 0.2;
const QUICK_MPS: f64 = 2.0;
/// Length of a gap after which the hand's velocity is unknown.
const STEADY: Span = Span::from_millis(120);
/// A hand that has been in a slot for less than this has passed through and grasped nothing.
const GRASP: Span = Span::from_millis(150);
/// A hand this slow in a tote puts down what it holds, metres per second.
const STOPS_MPS: f64 = 0.45;
/// Time over which velocities are averaged, approximately, seconds.
const SMOOTH_S: f64 = 0.04;

/// Time that a quick hand takes for a straight movement of this length in metres, seconds: a hand that takes no longer
/// has not been in another slot or tote meanwhile.
fn quick_s(way_m: f64) -> f64 {
    QUICK_S + way_m / QUICK_MPS
}

/// What a hand has done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HandEvent {
    /// It came out of a slot with a piece, and was deepest inside at this place.
    Grasped(SlotName, FacePlace),
    /// It put a piece into the tote with this number at the station.
    Placed(HeldPiece, usize),
    /// It has stopped in a tote without holding anything.
    Searched(usize),
}

/// A piece in a hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeldPiece {
    /// The slot that it is from.
    pub from: SlotName,
    /// Whether the hand was seen all the time since the grasp.
    pub sure: bool,
    /// Whether the piece is from the rack before the present one.
    pub is_of_before: bool,
}

/// A stay of the hand in a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SlotStay {
    since: Time,
    /// The deepest place of the stay, and its slot.
    slot: SlotName,
    at: FacePlace,
}

/// What is believed of one hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandFollower {
    last: Option<(Time, FacePlace)>,
    velocity: FacePlace,
    /// Whether the hand's velocity is known.
    is_steady: bool,
    stay: Option<SlotStay>,
    /// The tote in which the hand has stopped.
    tote: Option<usize>,
    /// Whether the hand is in a tote or just above one.
    is_over_tote: bool,
    held: Option<HeldPiece>,
}

impl HandFollower {
    /// When and where the hand was seen last.
    pub fn last(&self) -> Option<(Time, FacePlace)> {
        self.last
    }

    /// Velocity of the hand, metres per second.
    pub fn velocity(&self) -> FacePlace {
        self.velocity
    }

    /// The piece that the hand holds.
    pub fn held(&self) -> Option<HeldPiece> {
        self.held
    }

    /// Whether the hand is in a slot.
    pub fn is_in_slot(&self) -> bool {
        self.stay.is_some()
    }

    /// Whether the hand is in a tote or just above one.
    pub fn is_over_tote(&self) -> bool {
        self.is_over_tote
    }

    /// Records that the hand again holds a piece that it had put down.
    pub fn take_up(&mut self, piece: HeldPiece) {
        self.held = Some(piece);
    }

    /// Records another rack: the piece in the hand is from the one before.
    pub fn begin(&mut self) {
        self.stay = None;
        self.held = self.held.map(|held| HeldPiece { is_of_before: true, ..held });
    }

    /// Forgets a piece from this slot of the present rack, which is no longer wanted.
    pub fn forget(&mut self, slot: SlotName) {
        self.held = self.held.filter(|held| held.is_of_before || held.from != slot);
    }

    /// Whether the hand can have reached a place by now.
    pub fn can_be_at(&self, at: FacePlace, seen: Time) -> bool {
        self.last.is_none_or(|(then, before)| {
            let bound_m = FASTEST_MPS * (seen - then).as_secs_f64() + ERR_M;
            seen - then > GAP || (at - before).norm() <= bound_m
        })
    }

    /// Takes in where the hand is. Observations must come in order.
    pub fn see(&mut self, face: &PickFace, at: FacePlace, seen: Time) -> Option<HandEvent> {
        if !self.can_be_at(at, seen) {
            return None;
        }
        let gap = self.last.map_or(GAP, |(then, _)| seen - then);
        let seconds = gap.as_secs_f64().max(1e-3);
        if let Some((_, before)) = self.last.filter(|_| gap < GAP) {
            let moved = (at - before) / seconds;
            let share = if gap < STEADY { seconds / (seconds + SMOOTH_S) } else { 1.0 };
            self.velocity += (moved - self.velocity) * share;
            self.is_steady = true;
        } else {
            let is_direct = self.last.is_some_and(|(_, before)| seconds <= quick_s((at - before).norm()));
            (self.velocity, self.is_steady, self.stay) = (FacePlace::zeros(), false, None);
            self.held = self.held.map(|held| HeldPiece { sure: held.sure && is_direct, ..held });
        }
        self.last = Some((seen, at));
        self.slots(face, at, seen).or_else(|| self.totes(face, at))
    }

    fn slots(&mut self, face: &PickFace, at: FacePlace, seen: Time) -> Option<HandEvent> {
        match (face.slot_at(at), self.stay.as_mut()) {
            (Some(slot), None) => self.stay = Some(SlotStay { since: seen, slot, at }),
            (Some(slot), Some(stay)) if at.y < stay.at.y => (stay.slot, stay.at) = (slot, at),
            (None, Some(stay)) if face.depth_m(at) < 0.0 => {
                let SlotStay { slot, at: deepest, since } = *stay;
                let dwelt = seen - since;
                self.stay = None;
                if dwelt >= GRASP {
                    self.held = Some(HeldPiece { from: slot, sure: true, is_of_before: false });
                    return Some(HandEvent::Grasped(slot, deepest));
                }
            }
            _ => {}
        }
        None
    }

    fn totes(&mut self, face: &PickFace, at: FacePlace) -> Option<HandEvent> {
        let tote = face.tote_at(at);
        self.is_over_tote = tote.is_some();
        if tote.is_none() {
            self.tote = None;
        }
        let tote =
            tote.filter(|_| self.is_steady && self.velocity.norm() < STOPS_MPS && self.tote.is_none())?;
        self.tote = Some(tote);
        Some(self.held.take().map_or(HandEvent::Searched(tote), |held| HandEvent::Placed(held, tote)))
    }
}

//! The hands at one work cell, followed from slot to tote, and warned before they are in a wrong slot.
//!
//! Main types: [`Desk`], [`DeskEvent`]. Refuses: hands of two persons at once, and to confirm anything by guessing.

use super::aim::aims_wrong;
use super::face::{FacePlace, PickFace};
use super::follow::{HandEvent, HandFollower, Held};
use super::hands::HandsSeen;
use crate::time::{Span, Time};
use crate::warehouse::SlotName;
use smallvec::SmallVec;

/// Hands that were not seen for so long are not known of.
const STALE: Span = Span::from_secs(1);
/// A hand is expected where it will be after so long if it goes on as it does, seconds.
const SOON_S: f64 = 0.3;
/// For so long after two persons' hands were seen nothing is confirmed by hand.
const ALONE: Span = Span::from_secs(2);

/// What happened at a work cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeskEvent {
    /// A piece was taken out of a slot.
    Grasped(SlotName),
    /// A piece from a slot was put into a tote, by its number at the station, and the hand was seen all the way.
    Placed(SlotName, usize),
    /// A hand goes to this slot, most likely, and not to the one that is lit.
    AimsAt(SlotName),
}

/// What is believed of the hands at one work cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Desk {
    hands: [HandFollower; 2],
    /// Whose hands were seen last, and when.
    person: Option<(u32, Time)>,
    /// Nothing is confirmed by hand before.
    crowded_until: Option<Time>,
    /// Pieces that were put into totes, with their slots, since the rack came: they may be taken out again.
    placed: SmallVec<[(usize, SlotName); 8]>,
    /// For each hand the tote and the slot of the piece that it put where it does not belong, until it grasps again.
    strayed: [Option<(usize, SlotName)>; 2],
    /// For each hand the slot that was warned of while it goes there.
    warned: [Option<SlotName>; 2],
}

impl Desk {
    /// Another rack is here: what was put down before stays where it is.
    pub fn begin(&mut self) {
        self.placed.clear();
    }

    /// Takes in hands, with the slot and the tote that are lit. Gives what happened, in order. Observations that come out of order
    /// are dropped.
    pub fn see(
        &mut self,
        face: &PickFace,
        lit: Option<(SlotName, usize)>,
        seen: &HandsSeen,
    ) -> SmallVec<[DeskEvent; 4]> {
        let mut events = SmallVec::new();
        match self.person {
            Some((_, at)) if seen.seen <= at && at - seen.seen < STALE => return events,
            Some((person, at)) if person != seen.person && seen.seen - at < STALE => {
                self.crowded_until = Some(seen.seen + ALONE);
                self.hands = Default::default();
            }
            _ => {}
        }
        self.person = Some((seen.person, seen.seen));
        let is_alone = self.crowded_until.is_none_or(|until| seen.seen >= until);
        let mut grips = seen.hands.map(|hand| hand.filter(|h| h.is_sound()).map(|h| face.of(h.grip())));
        if self.are_swapped(&grips, seen.seen) {
            grips.swap(0, 1);
        }
        for (i, grip) in grips.into_iter().enumerate() {
            let Some(at) = grip else { continue };
            if let Some(event) = self.hands[i].see(face, at, seen.seen).and_then(|e| self.took(i, e, lit)) {
                events.extend(Some(event).filter(|_| is_alone));
            }
            let aims = lit.filter(|_| is_alone).and_then(|(slot, _)| self.aims(face, i, slot));
            events.extend(aims.map(DeskEvent::AimsAt));
        }
        events
    }

    /// What a hand's deed means. A hand that stops in a tote where pieces were put may have taken one out again; one that
    /// comes from a wrong tote to the lit one brings what it had there.
    fn took(&mut self, hand: usize, event: HandEvent, lit: Option<(SlotName, usize)>) -> Option<DeskEvent> {
        match event {
            HandEvent::Grasped(slot) => {
                self.strayed[hand] = None;
                Some(DeskEvent::Grasped(slot))
            }
            HandEvent::Placed { from, tote, sure } => {
                self.placed.push((tote, from));
                let is_wrong = lit.is_none_or(|(_, wanted)| wanted != tote);
                self.strayed[hand] = is_wrong.then_some((tote, from));
                sure.then_some(DeskEvent::Placed(from, tote))
            }
            HandEvent::Searched(tote) => {
                let of = |tote: usize| move |(t, _): &(usize, SlotName)| *t == tote;
                if let Some((there, from)) = self.strayed[hand].filter(|(there, _)| *there != tote) {
                    let last = self.placed.iter().rposition(of(there))?;
                    self.placed.remove(last);
                    self.placed.push((tote, from));
                    self.strayed[hand] = None;
                    return Some(DeskEvent::Placed(from, tote));
                }
                let last = self.placed.iter().rposition(of(tote))?;
                let (_, from) = self.placed.remove(last);
                self.hands[hand].take_up(from);
                None
            }
        }
    }

    /// Whether left and right have changed places since they were seen last.
    fn are_swapped(&self, grips: &[Option<FacePlace>; 2], seen: Time) -> bool {
        let can = |hand: usize, at: Option<FacePlace>| at.is_none_or(|at| self.hands[hand].can_be_at(at, seen));
        let [a, b] = *grips;
        !(can(0, a) && can(1, b)) && can(0, b) && can(1, a)
    }

    /// The wrong slot to which a hand goes, once for each reach.
    fn aims(&mut self, face: &PickFace, hand: usize, lit: SlotName) -> Option<SlotName> {
        let follower = &self.hands[hand];
        let (_, at) = follower.last()?;
        let slot = if follower.is_in_slot() {
            face.slot_at(at).filter(|slot| *slot != lit)
        } else if follower.velocity().y < 0.0 {
            aims_wrong(face, lit, at, follower.velocity())
        } else {
            self.warned[hand] = None;
            return None;
        };
        let slot = slot.filter(|_| self.warned[hand].is_none())?;
        self.warned[hand] = Some(slot);
        Some(slot)
    }

    /// The tote in which a piece lies that belongs elsewhere, as long as the hand that put it there has not grasped again.
    pub fn strayed(&self) -> Option<usize> {
        self.strayed.iter().flatten().map(|(tote, _)| *tote).next()
    }

    /// How many pieces from a slot are in hands that were seen all the time since.
    pub fn in_hand(&self, slot: SlotName) -> u32 {
        let of = |held: Held| held.sure && held.from == slot;
        self.hands.iter().filter(|h| h.held().is_some_and(of)).count() as u32
    }

    /// Whether hands were seen within the last second.
    pub fn sees(&self, now: Time) -> bool {
        self.person.is_some_and(|(_, at)| now - at < STALE)
    }

    /// Whether a hand is in the opening or beyond it, or will be there in a moment, as far as hands are seen.
    pub fn comes_inside(&self, face: &PickFace, now: Time) -> bool {
        let comes = |h: &HandFollower| {
            h.last().is_some_and(|(seen, at)| {
                let soon = at + h.velocity() * SOON_S;
                now - seen < STALE && (face.is_inside(at) || face.is_inside(soon))
            })
        };
        self.hands.iter().any(comes)
    }

    /// Whether a hand is in the opening or beyond it, as far as hands are seen.
    pub fn is_inside(&self, face: &PickFace, now: Time) -> bool {
        let inside =
            |h: &HandFollower| h.last().is_some_and(|(seen, at)| now - seen < STALE && face.is_inside(at));
        self.hands.iter().any(inside)
    }
}

//! The hands at one work cell, followed from slot to tote, and warned before they are in a wrong slot.
//!
//! Main types: [`CellHands`], [`CellHandsEvent`]. Refuses: hands of two persons at once, and to confirm anything by
//! guessing.

use super::aim::aims_wrong;
use super::belief::{ReachBeliefs, ReachPlace};
use super::eyes::{Fixation, LookedAt};
use super::face::{FacePlace, PickFace};
use super::follow::{HandEvent, HandFollower, HeldPiece};
use super::hands::{HandPoints, HandsSeen};
use super::phase::{PickPhase, PiecePhases, SpentPhase};
use super::share::LitShare;
use super::soon::{STAYS, inside_soon};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::SlotName;
use giveway_people::reach::PickModel;
use smallvec::SmallVec;
use std::sync::Arc;

/// Time after which an unseen hand is unknown.
const STALE: Span = Span::from_secs(1);
/// Depth from which a hand counts as in a slot, metres, and distance from the slot's edge within which the hand may
/// belong to the slot beside.
const DEEP_M: f64 = 0.05;
const EDGE_M: f64 = 0.03;
/// Time within which a hand must have been seen to be shown on its way …
const FRESH: Span = Span::from_millis(500);
/// … while it is faster than this, metres per second, or in a slot.
const MOVES_MPS: f64 = 0.2;
/// Time within which a hand must have been seen to count as still in view.
const GONE: Span = Span::from_millis(150);
/// Least probability with which a place is reported.
const LIKELY: f64 = 0.05;
/// Time within which hands must have been seen to count as a person seen picking: between two pieces they may be out of
/// view.
const OF_LATE: Span = Span::from_secs(10);
/// Time after two persons' hands were seen during which nothing is confirmed by hand.
const ALONE: Span = Span::from_secs(2);

/// What happened at a work cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellHandsEvent {
    /// A piece was taken out of a slot.
    Grasped(SlotName),
    /// A piece was put into the tote with this number at the station. This confirms something only if the hand was seen
    /// all the way.
    Placed(HeldPiece, usize),
    /// A hand most likely goes to this slot, which is not the lit one.
    AimsAt(SlotName),
}

/// The scene in which hands are seen.
#[derive(Clone, Copy, Debug)]
pub struct CellHandsScene<'a> {
    /// The face of the rack that stands there, or stood there last.
    pub face: &'a Arc<PickFace>,
    /// The learned model of reaches.
    pub model: &'a Arc<PickModel>,
    /// The slot that is lit.
    pub lit: Option<SlotName>,
    /// The tote that is wanted.
    pub tote: Option<usize>,
}

/// Where a hand most likely goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenReach {
    /// Whether the hand is the left one.
    pub is_left: bool,
    /// The slot or tote.
    pub place: ReachPlace,
    /// Probability that the hand goes there.
    pub probability: f64,
}

/// What is believed of the hands at one work cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellHands {
    hands: [HandFollower; 2],
    /// The person whose hands were seen last, and when.
    person: Option<(u32, Time)>,
    /// Until when nothing is confirmed by hand, because another person was there.
    crowded_until: Option<Time>,
    /// When a hand was last inside while several persons' hands were seen.
    crowd_inside: Option<Time>,
    /// Misplaced pieces of each hand and the totes that hold them, until the hand grasps again.
    strayed: [Option<(HeldPiece, usize)>; 2],
    /// For each hand the slot that it was warned of while it goes there.
    warned: [Option<SlotName>; 2],
    /// For each hand the slot of its last grasp, and the deepest place in it, until the piece is in a tote.
    grasped: [Option<(SlotName, FacePlace)>; 2],
    /// How often this person goes to the lit slot.
    share: LitShare,
    /// Where the eyes rest, where they are measured, and where the head is.
    eyes: Option<(Fixation, FacePlace)>,
    /// Beliefs about where the hands go, once hands were seen.
    beliefs: Option<ReachBeliefs>,
    /// The slot of the piece that is picked now, and the piece's phases.
    piece: Option<(SlotName, PiecePhases)>,
    /// The phase that has ended most recently.
    spent: Option<SpentPhase>,
}

impl CellHands {
    /// Begins with another rack.
    pub fn begin(&mut self) {
        self.hands.iter_mut().for_each(HandFollower::begin);
        self.strayed = [None; 2];
    }

    /// Ends a line: no piece from this slot is wanted any more.
    pub fn forget(&mut self, slot: SlotName) {
        self.hands.iter_mut().for_each(|hand| hand.forget(slot));
    }

    /// Takes in hands. Gives what happened, in order. Observations out of order are dropped.
    pub fn see(&mut self, scene: CellHandsScene<'_>, seen: &HandsSeen) -> SmallVec<[CellHandsEvent; 4]> {
        let (events, hands) = self.follow(scene, seen);
        for (i, hand) in hands.iter().enumerate().filter_map(|(i, hand)| Some((i, hand.as_ref()?))) {
            self.believe(scene, (i, hand), seen);
        }
        if hands.iter().any(Option::is_some) {
            self.note_phase(scene.lit, seen.seen);
        }
        events
    }

    /// Notes how far the piece of the lit line is.
    fn note_phase(&mut self, lit: Option<SlotName>, seen: Time) {
        let Some(lit) = lit else {
            self.piece = None;
            return;
        };
        let is_fresh = |h: &&HandFollower| h.last().is_some_and(|(at, _)| seen - at < FRESH);
        let hands = || self.hands.iter().filter(is_fresh);
        let places = |h: &HandFollower| h.is_over_tote() && h.held().is_some_and(|held| held.from == lit);
        let phase = if self.in_hand(lit) > 0 {
            if hands().any(places) { PickPhase::Place } else { PickPhase::Carry }
        } else if hands().any(HandFollower::is_in_slot) {
            PickPhase::Grasp
        } else if hands().any(|h| h.velocity().y < -MOVES_MPS) {
            PickPhase::Reach
        } else {
            PickPhase::Search
        };
        match &mut self.piece {
            Some((slot, piece)) if *slot == lit => self.spent = piece.see(phase, seen).or(self.spent),
            piece => *piece = Some((lit, PiecePhases::begin(phase, seen))),
        }
    }

    /// What a hand does with a piece of this slot, and for how long, seconds; nothing if that was not seen recently.
    pub fn phase(&self, slot: SlotName, now: Time) -> Option<(PickPhase, f64)> {
        self.piece.as_ref().filter(|(of, _)| *of == slot)?.1.now(now)
    }

    /// The phase that has ended since the last call.
    pub fn spent(&mut self) -> Option<SpentPhase> {
        self.spent.take()
    }

    /// The event by these hands, seen now, that would be a reason for a warning. This costs little and changes nothing.
    pub fn would_warn(&self, scene: CellHandsScene<'_>, seen: &HandsSeen) -> Option<CellHandsEvent> {
        // Beliefs are large, and warnings do not depend on them.
        let mut hands = CellHands { beliefs: None, ..*self };
        let (events, _) = hands.follow(scene, seen);
        events.into_iter().find(|event| match event {
            CellHandsEvent::AimsAt(_) => true,
            CellHandsEvent::Grasped(slot) => scene.lit.is_some_and(|lit| lit != *slot),
            CellHandsEvent::Placed(piece, tote) => {
                scene.lit == Some(piece.from) && scene.tote.is_some_and(|wanted| wanted != *tote)
            }
        })
    }

    /// Follows hands from slot to tote. Gives the events, and the hands that can be believed, each under its true side.
    fn follow(
        &mut self,
        scene: CellHandsScene<'_>,
        seen: &HandsSeen,
    ) -> (SmallVec<[CellHandsEvent; 4]>, [Option<HandPoints>; 2]) {
        let (face, mut events) = (scene.face, SmallVec::new());
        match self.person {
            Some((_, at)) if seen.seen <= at && at - seen.seen < STALE => return (events, [None; 2]),
            Some((person, at)) if person != seen.person && seen.seen - at < STALE => {
                self.crowded_until = Some(seen.seen + ALONE);
                self.hands = Default::default();
                self.forget_person();
            }
            Some((person, _)) if person != seen.person => self.forget_person(),
            _ => {}
        }
        self.person = Some((seen.person, seen.seen));
        self.eyes = seen.eyes.map(|ray| {
            let (before, now_s) = (self.eyes.map(|(eyes, _)| eyes), seen.seen.as_secs_f64());
            (Fixation::then(before, face.direction(ray), now_s), face.of(seen.head))
        });
        let is_alone = self.crowded_until.is_none_or(|until| seen.seen >= until);
        let mut hands = seen.hands.map(|hand| hand.filter(HandPoints::is_sound));
        let grips = hands.map(|hand| hand.map(|h| face.of(h.grip())));
        if self.are_swapped(&grips, seen.seen) {
            hands.swap(0, 1);
        }
        for (i, hand) in hands.iter_mut().enumerate() {
            let Some(at) = hand.map(|h| face.of(h.grip())) else { continue };
            let event = self.hands[i].see(face, at, seen.seen);
            // A hand's deed in a crowd counts for nothing, but must not be taken for an earlier one.
            let event = event.and_then(|event| self.took(i, event, scene));
            if !is_alone {
                self.crowd_inside = Some(seen.seen).filter(|_| face.is_inside(at)).or(self.crowd_inside);
                *hand = None;
                continue;
            }
            events.extend(event);
            events.extend(scene.lit.and_then(|slot| self.aims(face, i, slot)).map(CellHandsEvent::AimsAt));
        }
        (events, hands)
    }

    /// Follows where a hand goes while a slot is lit or a tote is wanted.
    fn believe(&mut self, scene: CellHandsScene<'_>, (i, hand): (usize, &HandPoints), seen: &HandsSeen) {
        let can_be = self.hands[i].last().is_some_and(|(at, _)| at == seen.seen);
        if !can_be || (scene.lit.is_none() && scene.tote.is_none()) {
            return;
        }
        let beliefs = self.beliefs.get_or_insert_with(|| ReachBeliefs::new(scene.model, scene.face));
        beliefs.turn_to(scene.face);
        let carries = self.hands[i].held().is_some();
        beliefs.see((i, hand), (scene.lit, scene.tote, self.share.get()), carries, seen);
    }

    /// Where moving hands go, with probabilities of at least 0.05.
    pub fn reaches(&self, now: Time) -> SmallVec<[SeenReach; 4]> {
        let Some(beliefs) = &self.beliefs else { return SmallVec::new() };
        let looked = self.looked_at(now);
        let is_moving = |i: &usize| {
            let hand = &self.hands[*i];
            let is_fresh = hand.last().is_some_and(|(seen, _)| now - seen < FRESH);
            is_fresh && (hand.velocity().norm() > MOVES_MPS || hand.is_in_slot())
        };
        let of = |i: usize| {
            let likely = beliefs.probabilities(i, looked).into_iter().filter(|(_, p)| *p >= LIKELY);
            likely.map(move |(place, probability)| SeenReach { is_left: i == 0, place, probability })
        };
        (0..2).filter(is_moving).flat_map(of).collect()
    }

    /// What a hand's deed means. A hand that stops again where it put a misplaced piece takes it out again; a hand that
    /// then goes to the wanted tote without such a stop brings no piece that was seen. A piece that lies where it
    /// belongs counts once.
    fn took(&mut self, hand: usize, event: HandEvent, scene: CellHandsScene<'_>) -> Option<CellHandsEvent> {
        match event {
            HandEvent::Grasped(slot, deepest) => {
                self.strayed[hand] = None;
                self.grasped[hand] = Some((slot, deepest));
                // A reach with a warning has been counted already.
                if let Some(lit) = scene.lit.filter(|_| self.warned[hand].is_none()) {
                    self.share.learn(lit == slot);
                }
                Some(CellHandsEvent::Grasped(slot))
            }
            HandEvent::Placed(piece, tote) => {
                self.strayed[hand] = scene.tote.filter(|wanted| *wanted != tote).map(|_| (piece, tote));
                let reached = self.grasped[hand].take().filter(|_| piece.sure && scene.tote == Some(tote));
                if let Some(((slot, deepest), beliefs)) = reached.zip(self.beliefs.as_mut()) {
                    beliefs.learn(slot, deepest);
                }
                Some(CellHandsEvent::Placed(piece, tote))
            }
            HandEvent::Searched(tote) => {
                let (piece, _) = self.strayed[hand].take_if(|(_, there)| *there == tote)?;
                self.hands[hand].take_up(piece);
                None
            }
        }
    }

    /// What the eyes rest on, where they are measured.
    fn looked_at(&self, now: Time) -> Option<LookedAt> {
        let (eyes, head) = self.eyes.as_ref()?;
        eyes.from(*head, now.as_secs_f64())
    }

    /// Forgets what was learned of a person, since another one is here.
    fn forget_person(&mut self) {
        self.eyes = None;
        (self.beliefs, self.share, self.grasped) = (None, LitShare::default(), [None; 2]);
    }

    /// Whether left and right have changed places since they were seen last: neither can be where it is said to be, or
    /// only one is seen, which was out of view, where the other one was a moment ago.
    fn are_swapped(&self, grips: &[Option<FacePlace>; 2], seen: Time) -> bool {
        let silent = |hand: usize| self.hands[hand].last().map_or(STALE, |(at, _)| seen - at);
        let takes_place = |hand: usize, at: FacePlace| {
            let other = &self.hands[1 - hand];
            silent(hand) >= FRESH && silent(1 - hand) < GONE && other.can_be_at(at, seen)
        };
        let can =
            |hand: usize, at: Option<FacePlace>| at.is_none_or(|at| self.hands[hand].can_be_at(at, seen));
        if let [Some(at), None] = *grips {
            return takes_place(0, at);
        }
        if let [None, Some(at)] = *grips {
            return takes_place(1, at);
        }
        let [a, b] = *grips;
        !(can(0, a) && can(1, b)) && can(0, b) && can(1, a)
    }

    /// The wrong slot to which a hand goes, once for each reach.
    fn aims(&mut self, face: &PickFace, hand: usize, lit: SlotName) -> Option<SlotName> {
        let follower = &self.hands[hand];
        let (seen, at) = follower.last()?;
        let slot = if follower.is_in_slot() {
            // At the edge of a slot beside the lit one the hand may still be on its way to the lit one.
            let to_lit = (face.slot(lit) - at).try_normalize(1e-6).unwrap_or_default() * EDGE_M;
            let nearer = FacePlace::new(at.x + to_lit.x, at.y, at.z + to_lit.z);
            face.slot_at(nearer).filter(|slot| *slot != lit && face.depth_m(at) > DEEP_M)
        } else if follower.velocity().y < 0.0 {
            aims_wrong(face, (lit, self.share), (at, follower.velocity()), self.looked_at(seen))
        } else {
            self.warned[hand] = None;
            return None;
        };
        let slot = slot.filter(|_| self.warned[hand].is_none())?;
        self.warned[hand] = Some(slot);
        self.share.learn(false);
        Some(slot)
    }

    /// Number of pieces from a slot of the present rack in hands that were seen all the time since.
    pub fn in_hand(&self, slot: SlotName) -> u32 {
        let of = |held: HeldPiece| held.sure && !held.is_of_before && held.from == slot;
        self.hands.iter().filter(|h| h.held().is_some_and(of)).count() as u32
    }

    /// Notes a second person in the workplace: it is unknown whose hand does what.
    pub fn note_company(&mut self, now: Time) {
        self.crowded_until = self.crowded_until.max(Some(now + ALONE));
    }

    /// Notes a person's word that no hand out of view is inside.
    pub fn forget_lost(&mut self, now: Time) {
        let is_lost = |hand: &&mut HandFollower| hand.last().is_some_and(|(at, _)| now - at >= STALE);
        self.hands.iter_mut().filter(is_lost).for_each(|hand| *hand = HandFollower::default());
    }

    /// Whether hands were seen within the last second.
    pub fn sees(&self, now: Time) -> bool {
        self.person.is_some_and(|(_, at)| now - at < STALE)
    }

    /// Whether hands were seen within the last 10 s, of one person alone, so that they may confirm lines.
    pub fn saw_of_late(&self, now: Time) -> bool {
        let is_alone = self.crowded_until.is_none_or(|until| now >= until);
        is_alone && self.person.is_some_and(|(_, at)| now - at < OF_LATE)
    }

    /// Whether a hand is in the opening or beyond it, or will be there within 0.3 s with a probability of at least 0.1,
    /// as far as hands are seen.
    pub fn comes_inside(&self, face: &PickFace, now: Time) -> bool {
        self.inside_soon(face, now) >= STAYS
    }

    /// The probability that one of the visible hands is in the opening or beyond it, or will be within 0.3 s.
    pub fn inside_soon(&self, face: &PickFace, now: Time) -> f64 {
        if self.crowd_inside.is_some_and(|seen| now - seen < STALE) {
            return 1.0;
        }
        let of = |hand: &HandFollower| {
            let (_, at) = hand.last().filter(|(seen, _)| now - *seen < STALE)?;
            Some(inside_soon(face, at, hand.velocity()))
        };
        self.hands.iter().filter_map(of).fold(0.0, f64::max)
    }

    /// Whether a hand is in the opening or beyond it, as far as hands are seen.
    pub fn is_inside(&self, face: &PickFace, now: Time) -> bool {
        self.is_any(now, |at| face.is_inside(at))
    }

    /// Whether a hand was inside when it was seen last, however long ago: it may still be there.
    pub fn may_be_inside(&self, face: &PickFace) -> bool {
        self.hands.iter().any(|h| h.last().is_some_and(|(_, at)| face.is_inside(at)))
    }

    fn is_any(&self, now: Time, is: impl Fn(FacePlace) -> bool) -> bool {
        let is_fresh = |seen: Time| now - seen < STALE;
        let crowd = self.crowd_inside.is_some_and(is_fresh);
        crowd || self.hands.iter().any(|h| h.last().is_some_and(|(seen, at)| is_fresh(seen) && is(at)))
    }
}

#[cfg(test)]
mod tests;

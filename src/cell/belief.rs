//! To which slot or tote each hand at a work cell goes, with learned probabilities.
//!
//! Main types: [`ReachBeliefs`], [`ReachPlace`]. Shoulders and elbows follow from head and hands; where this person's
//! hand ends in a slot is learned from each grasp, and kept no longer than hands are seen. Refuses: to decide anything.

use super::eyes::LookedAt;
use super::face::{FacePlace, PickFace};
use super::hands::{HandPoints, HandsSeen};
use giveway_floor::warehouse::SlotName;
use giveway_people::reach::posture::{BodyLengths, SeenArm, SeenHead};
use giveway_people::reach::sample::angles;
use giveway_people::reach::{ArmPoint, PickModel, ReachTarget, SlotTracker};
use smallvec::SmallVec;
use std::sync::Arc;

/// Depth behind a slot's front at which a hand is expected to end before anything is learned, metres …
const DEEP_M: f64 = 0.1;
/// … and the number of grasps that this counts for.
const PRIOR_GRASPS: f64 = 4.0;
/// Depth below a tote's rim at which a hand puts pieces down, metres.
const BELOW_RIM_M: f64 = 0.03;

/// Height above the floor of the middle of the rack, which a head without known direction is taken to face, metres.
const MIDDLE_M: f64 = 1.2;

/// A place to which a hand can go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReachPlace {
    /// A slot of the rack.
    Slot(SlotName),
    /// The tote with this number at the station.
    Tote(usize),
}

/// What a hand is expected to do next: the slot and the tote decide which place is lit for it, and the last value is
/// the probability that the hand goes there.
type Expected = (Option<SlotName>, Option<usize>, f64);

/// What is known of one hand.
#[derive(Clone, Debug, PartialEq)]
struct WatchedHand {
    tracker: SlotTracker,
    /// The lit place that the hand's belief was last given.
    lit: Option<ReachPlace>,
    is_stale: bool,
}

/// Beliefs about both hands at one work cell.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachBeliefs {
    face: Arc<PickFace>,
    places: Vec<ReachPlace>,
    lengths: Option<BodyLengths>,
    hands: [WatchedHand; 2],
    /// Where this person's hand ends, relative to the middle of a slot's front, and how many grasps taught it.
    ends: (FacePlace, f64),
}

/// A place of the face in the frame of the opening.
fn of_face(at: FacePlace) -> ArmPoint {
    ArmPoint::new(-at.y, -at.x, at.z)
}

impl ReachBeliefs {
    /// Beliefs about hands at a face that were not seen yet.
    pub fn new(model: &Arc<PickModel>, face: &Arc<PickFace>) -> ReachBeliefs {
        let hand = WatchedHand { tracker: SlotTracker::new(model.clone()), lit: None, is_stale: true };
        let ends = (FacePlace::new(0.0, -DEEP_M, 0.0), PRIOR_GRASPS);
        let (places, hands) = (places_of(face), [hand.clone(), hand]);
        ReachBeliefs { face: face.clone(), places, lengths: None, hands, ends }
    }

    /// Switches to another face.
    pub fn turn_to(&mut self, face: &Arc<PickFace>) {
        if !Arc::ptr_eq(face, &self.face) {
            (self.face, self.places) = (face.clone(), places_of(face));
            self.hands.iter_mut().for_each(|hand| hand.is_stale = true);
        }
    }

    /// Takes in one hand. `carries` says that it holds a piece: then the hand is expected at the wanted tote, otherwise
    /// at the lit slot. A hand that no arm of this person reaches changes nothing.
    pub fn see(
        &mut self,
        (hand, points): (usize, &HandPoints),
        (lit, tote, share): Expected,
        carries: bool,
        seen: &HandsSeen,
    ) {
        let head_at = self.face.of(seen.head);
        let facing = seen
            .facing
            .map_or_else(|| FacePlace::new(0.0, 0.0, MIDDLE_M) - head_at, |ahead| self.face.direction(ahead));
        let (yaw, pitch) = angles(of_face(facing).coords);
        let head = SeenHead { at: of_face(head_at), yaw, pitch };
        let place = |p| of_face(self.face.of(p));
        let arm = SeenArm {
            is_left: hand == 0,
            wrist: place(points.wrist),
            palm: place(points.palm),
            finger: place(points.grip()),
        };
        let lengths = self.lengths.get_or_insert_with(|| BodyLengths::of_head(head.at.z));
        lengths.learn(&head, &arm);
        let Some(sample) = lengths.sample(seen.seen.as_secs_f64(), &head, &arm) else { return };
        let expected = if carries { tote.map(ReachPlace::Tote) } else { lit.map(ReachPlace::Slot) };
        if self.hands[hand].is_stale || self.hands[hand].lit != expected {
            self.tell_places(hand, expected, share);
        }
        self.hands[hand].tracker.follow(sample);
    }

    fn tell_places(&mut self, hand: usize, lit: Option<ReachPlace>, share: f64) {
        let target = |place: &ReachPlace| {
            let (ends, looks) = match *place {
                ReachPlace::Slot(slot) => (self.face.slot(slot) + self.ends.0, self.face.slot(slot)),
                ReachPlace::Tote(tote) => {
                    let rim = self.face.tote(tote).expect("it is a tote of this face");
                    (rim - FacePlace::new(0.0, 0.0, BELOW_RIM_M), rim)
                }
            };
            let target = ReachTarget { hand: of_face(ends), look: of_face(looks) };
            if hand == 0 { target.mirrored() } else { target }
        };
        let targets: Vec<ReachTarget> = self.places.iter().map(target).collect();
        let index = lit.and_then(|lit| self.places.iter().position(|place| *place == lit));
        let lit_share = index.map(|index| (index, share));
        let watched = &mut self.hands[hand];
        watched.tracker.set_places(&targets, lit_share);
        (watched.lit, watched.is_stale) = (lit, false);
    }

    /// Learns from a hand that has grasped in a slot and was deepest in it at this place.
    pub fn learn(&mut self, slot: SlotName, deepest: FacePlace) {
        let (ends, count) = &mut self.ends;
        *count += 1.0;
        *ends += (deepest - self.face.slot(slot) - *ends) / *count;
        self.hands.iter_mut().for_each(|hand| hand.is_stale = true);
    }

    /// Places with the probability that a hand goes there, given where the eyes rest, if they are measured; the
    /// remainder to one is the probability of no place.
    pub fn probabilities(&self, hand: usize, looked: Option<LookedAt>) -> SmallVec<[(ReachPlace, f64); 32]> {
        let known = self.hands[hand].tracker.probabilities();
        let middle = |place: &ReachPlace| match *place {
            ReachPlace::Slot(slot) => self.face.slot(slot),
            ReachPlace::Tote(tote) => self.face.tote(tote).expect("it is a tote of this face"),
        };
        let ratio = |place: &ReachPlace| looked.map_or(1.0, |looked| looked.ratio(middle(place)));
        let pairs = self.places.iter().zip(known);
        let mut all: SmallVec<[_; 32]> = pairs.map(|(place, p)| (*place, p * ratio(place))).collect();
        let no_place = (1.0 - known.iter().sum::<f64>()).max(0.0);
        let sum = no_place + all.iter().map(|(_, p)| p).sum::<f64>();
        if looked.is_some() && sum > 0.0 {
            all.iter_mut().for_each(|(_, p)| *p /= sum);
        }
        all
    }
}

fn places_of(face: &PickFace) -> Vec<ReachPlace> {
    let slots = face.slots().map(|(slot, _)| ReachPlace::Slot(slot));
    slots.chain((0..face.totes()).map(ReachPlace::Tote)).collect()
}

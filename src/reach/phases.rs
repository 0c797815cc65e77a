//! Phases of a hand at work: it searches, reaches, grasps, carries, places.
//!
//! Main types: [`HandPhase`], [`PhaseTracker`], [`PhaseEvent`]. Told from where the hand is and how fast, with
//! different thresholds for entering and leaving a place, so that a trembling hand makes no events. A grasp is a stay
//! at a slot; that a piece was taken with it is not seen. Refuses: events of a hand that was not seen well enough,
//! and guessing what happened meanwhile.

use super::sample::ArmPoint;

/// A hand is at a place within this distance, metres.
const ENTERS_M: f64 = 0.10;
/// It has left the place beyond this distance, metres.
const LEAVES_M: f64 = 0.16;
/// A slower hand stays, metres per second.
const STAYS_MPS: f64 = 0.35;
/// A faster hand is on its way.
const MOVES_MPS: f64 = 0.25;
/// A stay this long is a grasp, seconds; a hand that only passes by is no event.
const GRASP_S: f64 = 0.12;
/// A hand that was not seen for this long starts anew, seconds.
const UNSEEN_S: f64 = 0.5;

/// What a hand is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HandPhase {
    /// Nothing yet: it rests, or looks for the slot.
    #[default]
    Search,
    /// It is on its way to a slot.
    Reach,
    /// It is in a slot, by its number.
    Grasp(usize),
    /// It has been in a slot and is on its way to a tote.
    Carry(usize),
    /// It is at a tote with what it took from a slot: slot, tote.
    Place(usize, usize),
}

/// What a hand has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseEvent {
    /// It was in a slot and has left it.
    Grasped(usize),
    /// It was at a tote after a slot: slot, tote.
    Placed(usize, usize),
}

/// One hand. Slots and totes are numbered by the caller.
#[derive(Clone, Debug, Default)]
pub struct PhaseTracker {
    phase: HandPhase,
    last: Option<(f64, ArmPoint)>,
    speed_mps: f64,
    /// Since when the hand stays at the place of its phase.
    since_s: f64,
}

/// The nearest place within a distance.
fn nearest(places: &[ArmPoint], hand: ArmPoint, within_m: f64) -> Option<usize> {
    let far = |i: usize| (places[i] - hand).norm();
    let best = (0..places.len()).min_by(|a, b| far(*a).total_cmp(&far(*b)))?;
    (far(best) <= within_m).then_some(best)
}

impl PhaseTracker {
    /// What the hand is doing.
    pub fn phase(&self) -> HandPhase {
        self.phase
    }

    /// Forgets the hand: it was lost, or it is another one.
    pub fn forget(&mut self) {
        *self = PhaseTracker::default();
    }

    /// One sample of the hand; a sample that is not later than the last one is left out.
    pub fn observe(
        &mut self,
        at_s: f64,
        hand: ArmPoint,
        slots: &[ArmPoint],
        totes: &[ArmPoint],
    ) -> Option<PhaseEvent> {
        if self.last.is_some_and(|(seen_s, _)| at_s - seen_s > UNSEEN_S) {
            self.forget();
        }
        let Some((seen_s, before)) = self.last else {
            self.last = Some((at_s, hand));
            return None;
        };
        if at_s <= seen_s {
            return None;
        }
        let dt = at_s - seen_s;
        // A mean over some 60 ms, so that one jumping sample is no movement.
        let share = 1.0 - libm::exp(-dt / 0.06);
        self.speed_mps += ((hand - before).norm() / dt - self.speed_mps) * share;
        self.last = Some((at_s, hand));
        self.next(at_s, hand, slots, totes)
    }

    fn enter(&mut self, at_s: f64, phase: HandPhase) {
        self.phase = phase;
        self.since_s = at_s;
    }

    fn next(
        &mut self,
        at_s: f64,
        hand: ArmPoint,
        slots: &[ArmPoint],
        totes: &[ArmPoint],
    ) -> Option<PhaseEvent> {
        let stays = self.speed_mps < STAYS_MPS;
        let has_left = |place: Option<&ArmPoint>| place.is_none_or(|p| (p - hand).norm() > LEAVES_M);
        match self.phase {
            HandPhase::Search | HandPhase::Reach => {
                match nearest(slots, hand, ENTERS_M).filter(|_| stays) {
                    Some(slot) => self.enter(at_s, HandPhase::Grasp(slot)),
                    None if self.speed_mps > MOVES_MPS => self.enter(at_s, HandPhase::Reach),
                    None => {}
                }
                None
            }
            HandPhase::Grasp(slot) => {
                if !has_left(slots.get(slot)) {
                    return None;
                }
                let is_long = at_s - self.since_s >= GRASP_S;
                self.phase = if is_long { HandPhase::Carry(slot) } else { HandPhase::Reach };
                is_long.then_some(PhaseEvent::Grasped(slot))
            }
            HandPhase::Carry(slot) => {
                if let Some(tote) = nearest(totes, hand, ENTERS_M).filter(|_| stays) {
                    self.enter(at_s, HandPhase::Place(slot, tote));
                } else if let Some(other) = nearest(slots, hand, ENTERS_M).filter(|_| stays) {
                    // It went to another slot, or back, before it came to a tote.
                    self.enter(at_s, HandPhase::Grasp(other));
                }
                None
            }
            HandPhase::Place(slot, tote) => {
                if !has_left(totes.get(tote)) {
                    return None;
                }
                self.phase = HandPhase::Search;
                Some(PhaseEvent::Placed(slot, tote))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slots() -> [ArmPoint; 2] {
        [ArmPoint::new(0.6, 0.0, 1.4), ArmPoint::new(0.6, 0.35, 1.4)]
    }

    fn totes() -> [ArmPoint; 2] {
        [ArmPoint::new(0.3, -0.5, 0.9), ArmPoint::new(0.3, 0.6, 0.9)]
    }

    /// A hand that goes from place to place in 0.6 s each and stays there for so long; 60 samples a second.
    fn events(way: &[(ArmPoint, f64)]) -> Vec<PhaseEvent> {
        let (mut tracker, mut all, mut at_s) = (PhaseTracker::default(), Vec::new(), 0.0);
        let mut from = ArmPoint::new(0.1, 0.0, 1.0);
        for (to, stay_s) in way {
            for k in 0..((0.6 + stay_s) * 60.0) as usize {
                let s = (k as f64 / 36.0).min(1.0);
                let share = s * s * s * (10.0 + s * (6.0 * s - 15.0));
                let tremor = ArmPoint::new(0.0, 0.002 * libm::sin(50.0 * at_s), 0.0).coords;
                at_s += 1.0 / 60.0;
                all.extend(tracker.observe(at_s, from + (to - from) * share + tremor, &slots(), &totes()));
            }
            from = *to;
        }
        all
    }

    #[test]
    fn two_pieces_into_a_tote_are_two_grasps_and_two_places() {
        let (slot, tote) = (slots()[0], totes()[1]);
        let seen = events(&[
            (slot, 0.4),
            (tote, 0.2),
            (slot, 0.4),
            (tote, 0.2),
            (ArmPoint::new(0.1, 0.0, 1.0), 0.2),
        ]);
        let one = [PhaseEvent::Grasped(0), PhaseEvent::Placed(0, 1)];
        assert_eq!(seen, [one, one].concat());
    }

    #[test]
    fn a_hand_that_passes_a_slot_on_its_way_grasps_nothing_there() {
        let beyond = ArmPoint::new(0.6, -0.5, 1.4);
        assert_eq!(
            events(&[(slots()[1], 0.4), (beyond, 0.3), (totes()[0], 0.2)])[..1],
            [PhaseEvent::Grasped(1)]
        );
        assert!(!events(&[(slots()[1], 0.4), (beyond, 0.3)]).contains(&PhaseEvent::Grasped(0)));
    }

    #[test]
    fn a_hand_that_was_lost_on_the_way_places_nothing() {
        let mut tracker = PhaseTracker::default();
        let steps = [(0.0, slots()[0]), (0.1, slots()[0]), (0.3, slots()[0]), (0.4, slots()[0])];
        steps.iter().for_each(|(t, p)| _ = tracker.observe(*t, *p, &slots(), &totes()));
        assert_eq!(tracker.phase(), HandPhase::Grasp(0));
        for k in 0..20 {
            let event = tracker.observe(2.0 + f64::from(k) * 0.05, totes()[0], &slots(), &totes());
            assert_eq!(event, None);
        }
        assert_eq!(tracker.phase(), HandPhase::Search);
    }
}

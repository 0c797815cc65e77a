//! Tracks one hand: samples in, probabilities of places out.
//!
//! Main type: [`SlotTracker`]. The nets step every 0.04 s of the samples' own time, whatever their rate; a sample
//! between two steps is evaluated with a copy of the state. So sensors of 30 and of 60 Hz give the same result. Places
//! come and go between any two samples. After its first second nothing here allocates. Refuses: samples that go back in
//! time.

use super::ends::{END_FIGURES, EndState, end_coordinates, end_score};
use super::features::{ArmMotion, BODY};
use super::model::PickModel;
use super::net::squash::softmax;
use super::sample::{ArmSample, ReachTarget};
use std::sync::Arc;

/// Step of the nets, seconds.
const STEP_S: f64 = 0.04;
/// After a gap this long the hand counts as a new one, seconds.
const GAP_S: f64 = 0.4;
/// Number of samples kept: enough for one step at 240 Hz.
const KEPT: usize = 12;
/// Prior probability that a hand goes to none of the places.
const NONE: f64 = 0.005;

/// The tracker of one hand.
#[derive(Clone, Debug, PartialEq)]
pub struct SlotTracker {
    model: Arc<PickModel>,
    states: Vec<EndState>,
    glimpses: Vec<EndState>,
    said: Vec<[f32; END_FIGURES]>,
    motion: Option<ArmMotion>,
    next_s: f64,
    kept: [Option<ArmSample>; KEPT],
    newest: usize,
    targets: Vec<ReachTarget>,
    priors: Vec<f64>,
    probabilities: Vec<f64>,
}

impl SlotTracker {
    /// A tracker of a hand not seen yet, without places.
    pub fn new(model: Arc<PickModel>) -> SlotTracker {
        let states: Vec<EndState> = model.slots.nets.iter().map(|n| n.state()).collect();
        SlotTracker {
            glimpses: states.clone(),
            said: vec![[0.0; END_FIGURES]; states.len()],
            states,
            model,
            motion: None,
            next_s: 0.0,
            kept: [None; KEPT],
            newest: 0,
            targets: Vec::new(),
            priors: Vec::new(),
            probabilities: Vec::new(),
        }
    }

    /// Sets the places, and which of them is lit, if any, with the share of reaches that go to it. Places need no
    /// history: what was seen of the hand counts for all of them.
    pub fn set_places(&mut self, targets: &[ReachTarget], lit: Option<(usize, f64)>) {
        self.targets.clear();
        self.targets.extend_from_slice(targets);
        let others = targets.len().saturating_sub(1).max(1) as f64;
        let prior = |i: usize| match lit {
            Some((lit, share)) if lit == i => share * (1.0 - NONE),
            Some((_, share)) => (1.0 - share) * (1.0 - NONE) / others,
            None => (1.0 - NONE) / targets.len() as f64,
        };
        self.priors.clear();
        self.priors.extend((0..targets.len()).map(|i| libm::log(prior(i))));
        self.weigh();
    }

    /// Processes one sample. A sample that is not later than the last one is dropped.
    pub fn observe(&mut self, sample: ArmSample) {
        let Some((motion, is_new)) = self.advance(sample) else { return };
        if !is_new && sample.at_s - motion.now().at_s > 1e-3 {
            self.glimpse(&motion, sample);
        }
        self.weigh();
    }

    /// Processes one sample for callers that rarely read the result: the nets are evaluated only when their step is
    /// due, so that probabilities may be a step old, at a third of the cost.
    pub fn follow(&mut self, sample: ArmSample) {
        let due_s = self.next_s;
        if let Some((_, is_new)) = self.advance(sample)
            && (is_new || self.next_s > due_s)
        {
            self.weigh();
        }
    }

    /// Processes a sample with the steps that are due. Gives the motion as of the last step, and whether it is a new
    /// hand; nothing for a dropped sample.
    fn advance(&mut self, sample: ArmSample) -> Option<(ArmMotion, bool)> {
        let last = self.kept[self.newest];
        let Some((motion, last)) = self.motion.zip(last).filter(|(_, l)| sample.at_s - l.at_s < GAP_S) else {
            return Some((self.begin(sample), true));
        };
        if sample.at_s <= last.at_s {
            return None;
        }
        let mut motion = motion;
        while self.next_s <= sample.at_s {
            let share = (self.next_s - last.at_s) / (sample.at_s - last.at_s);
            motion = motion.then(last.towards(&sample, share.clamp(0.0, 1.0)));
            self.step(&motion);
            self.next_s += STEP_S;
        }
        self.motion = Some(motion);
        self.newest = (self.newest + 1) % KEPT;
        self.kept[self.newest] = Some(sample);
        Some((motion, false))
    }

    fn begin(&mut self, sample: ArmSample) -> ArmMotion {
        self.kept = [None; KEPT];
        self.newest = 0;
        self.kept[0] = Some(sample);
        let motion = ArmMotion::new(sample);
        let model = self.model.clone();
        model.slots.nets.iter().zip(&mut self.states).for_each(|(net, state)| net.clear(state));
        self.step(&motion);
        self.motion = Some(motion);
        self.next_s = sample.at_s + STEP_S;
        motion
    }

    fn step(&mut self, motion: &ArmMotion) {
        let mut body = [0.0; BODY];
        motion.body(&mut body);
        let nets = self.model.slots.nets.iter().zip(&mut self.states);
        nets.zip(&mut self.said).for_each(|((net, state), said)| net.step(state, &body, said));
    }

    fn glimpse(&mut self, motion: &ArmMotion, sample: ArmSample) {
        let earlier = self.seen_at(sample.at_s - STEP_S).unwrap_or(*motion.now());
        let mut body = [0.0; BODY];
        motion.glimpse(&earlier, sample, STEP_S).body(&mut body);
        let states = self.states.iter().zip(&mut self.glimpses);
        for ((net, (state, copy)), said) in self.model.slots.nets.iter().zip(states).zip(&mut self.said) {
            net.copy(state, copy);
            net.step(copy, &body, said);
        }
    }

    /// The sample at a time, interpolated between two samples.
    fn seen_at(&self, at_s: f64) -> Option<ArmSample> {
        let back = |k: usize| self.kept[(self.newest + KEPT - k) % KEPT];
        for k in 0..KEPT - 1 {
            let (later, earlier) = (back(k)?, back(k + 1)?);
            if earlier.at_s <= at_s {
                let share = (at_s - earlier.at_s) / (later.at_s - earlier.at_s).max(1e-9);
                return Some(earlier.towards(&later, share.clamp(0.0, 1.0)));
            }
        }
        None
    }

    /// Computes probabilities from the nets' last outputs.
    fn weigh(&mut self) {
        self.probabilities.clear();
        self.probabilities.resize(self.targets.len() + 1, 0.0);
        let none = self.targets.len();
        let Some(now) = self.kept[self.newest] else {
            let priors = self.priors.iter().map(|p| libm::exp(*p));
            self.probabilities.iter_mut().zip(priors).for_each(|(p, prior)| *p = prior);
            self.probabilities[none] = if none == 0 { 1.0 } else { NONE };
            return;
        };
        let seen = ArmMotion::new(now);
        let slots = &self.model.slots;
        let share = slots.sharpness / self.said.len() as f64;
        for (i, target) in self.targets.iter().enumerate() {
            let place = end_coordinates(&seen, target);
            let sum: f64 = self.said.iter().map(|said| f64::from(end_score(said, &place))).sum();
            self.probabilities[i] = sum * share + self.priors[i];
        }
        self.probabilities[none] = slots.none + libm::log(NONE);
        softmax(&mut self.probabilities);
    }

    /// Probabilities of the places in their order; the remainder to one is that of none of them.
    pub fn probabilities(&self) -> &[f64] {
        &self.probabilities[..self.targets.len().min(self.probabilities.len())]
    }

    /// Probability that the hand goes to none of the places.
    pub fn none(&self) -> f64 {
        self.probabilities.get(self.targets.len()).copied().unwrap_or(1.0)
    }

    /// The hand's motion; nothing before it was seen.
    pub fn motion(&self) -> Option<&ArmMotion> {
        self.motion.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reach::sample::ArmPoint;

    fn rack() -> Vec<ReachTarget> {
        let places = (0..9).map(|i| (f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0));
        let target = |(y, z): (f64, f64)| ReachTarget {
            hand: ArmPoint::new(0.6, -0.1 + 0.35 * y, 1.45 + 0.35 * z),
            look: ArmPoint::new(0.7, -0.1 + 0.35 * y, 1.45 + 0.35 * z),
        };
        places.map(target).collect()
    }

    /// A hand on its way to a place, `at_s` seconds after its start.
    fn on_the_way(target: &ReachTarget, at_s: f64) -> ArmSample {
        let s = (at_s / 0.8).clamp(0.0, 1.0);
        let share = s * s * s * (10.0 + s * (6.0 * s - 15.0));
        let (rest, shoulder) = (ArmPoint::new(0.1, -0.1, 1.0), ArmPoint::new(0.0, -0.2, 1.4));
        let finger = rest + (target.hand - rest) * share;
        let (yaw, pitch) = crate::reach::sample::angles(target.look - ArmPoint::new(0.05, 0.0, 1.65));
        ArmSample {
            at_s,
            shoulder,
            forearm: shoulder + (finger - shoulder) * 0.5,
            hand: finger - (finger - shoulder) * 0.15,
            finger,
            head: ArmPoint::new(0.05, 0.0, 1.65),
            yaw: 0.7 * yaw * share,
            pitch: 0.37 * pitch * share,
        }
    }

    fn watched(hz: f64, until_s: f64, place: usize) -> SlotTracker {
        let mut tracker = SlotTracker::new(PickModel::builtin());
        tracker.set_places(&rack(), None);
        let count = ((until_s + 0.4) * hz) as usize;
        (0..=count).for_each(|k| tracker.observe(on_the_way(&rack()[place], k as f64 / hz - 0.4)));
        tracker
    }

    #[test]
    fn the_place_a_hand_goes_to_is_told_before_it_arrives() {
        for place in 0..9 {
            let tracker = watched(60.0, 0.6, place);
            let p = tracker.probabilities();
            assert!(p[place] > 0.5, "{place}: {p:?}");
        }
    }

    #[test]
    fn sensors_of_30_and_60_hz_are_told_the_same() {
        for until_s in [0.2, 0.3, 0.4, 0.5] {
            let (slow, fast) = (watched(30.0, until_s, 2), watched(60.0, until_s, 2));
            for (a, b) in slow.probabilities().iter().zip(fast.probabilities()) {
                assert!((a - b).abs() < 0.06, "{until_s}: {a} and {b}");
            }
        }
    }

    #[test]
    fn who_looks_seldom_is_told_the_same_at_each_step() {
        let mut seldom = SlotTracker::new(PickModel::builtin());
        seldom.set_places(&rack(), None);
        // The twelfth sample at 60 per second is at the fifth step at 25.
        (0..=24).for_each(|k| seldom.follow(on_the_way(&rack()[2], f64::from(k) / 60.0)));
        let mut often = SlotTracker::new(PickModel::builtin());
        often.set_places(&rack(), None);
        (0..=24).for_each(|k| often.observe(on_the_way(&rack()[2], f64::from(k) / 60.0)));
        for (a, b) in seldom.probabilities().iter().zip(often.probabilities()) {
            assert!((a - b).abs() < 0.1, "{a} and {b}");
        }
        assert!(seldom.probabilities()[2] > seldom.probabilities()[0]);
    }

    #[test]
    fn a_place_that_comes_late_counts_at_once_and_one_that_goes_leaves_the_rest() {
        let mut tracker = watched(60.0, 0.6, 4);
        let (all, p) = (rack(), tracker.probabilities()[4]);
        let without: Vec<ReachTarget> =
            all.iter().enumerate().filter(|(i, _)| *i != 4).map(|t| *t.1).collect();
        let none = tracker.none();
        tracker.set_places(&without, None);
        assert!(tracker.none() > none && tracker.probabilities().len() == 8);
        tracker.set_places(&all, None);
        assert!((tracker.probabilities()[4] - p).abs() < 1e-9);
        let sum: f64 = tracker.probabilities().iter().sum::<f64>() + tracker.none();
        assert!((sum - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_lit_place_is_expected_until_the_hand_says_otherwise() {
        let mut tracker = SlotTracker::new(PickModel::builtin());
        tracker.set_places(&rack(), Some((3, 0.95)));
        tracker.observe(on_the_way(&rack()[5], -0.4));
        assert!(tracker.probabilities()[3] > 0.5);
        (1..=70).for_each(|k| tracker.observe(on_the_way(&rack()[5], f64::from(k) / 60.0 - 0.4)));
        assert!(tracker.probabilities()[5] > 0.5, "{:?}", tracker.probabilities());
    }

    #[test]
    fn samples_that_repeat_or_go_back_change_nothing() {
        let mut tracker = watched(60.0, 0.5, 1);
        let before = tracker.probabilities().to_vec();
        tracker.observe(on_the_way(&rack()[8], 0.5));
        tracker.observe(on_the_way(&rack()[8], 0.3));
        assert_eq!(tracker.probabilities(), before);
    }
}

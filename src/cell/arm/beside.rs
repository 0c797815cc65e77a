//! The distance that an arm keeps from the picker beside it.
//!
//! Main types: [`BesidePicker`]. Refuses: to know of a picker who is not seen.

use super::capsule::{Capsule, least_distance_m};
use super::kinematics::Joints;
use super::risk::overlap_probability;
use super::sight::PickerAhead;
use super::space::ArmSpace;

/// Motion is risky if any step, until the arm could stand, meets the picker's arms with more than this probability.
pub const DELTA: f64 = 0.05;
/// Distance that links keep from head and trunk, and from arms (with probability `DELTA`), metres: the arm's own stop
/// acts before they touch.
const BODY_M: f64 = 0.12;
const ARMS_M: f64 = 0.07;
/// Distance kept by an arm that is already nearer than that, metres.
const NEAR_M: f64 = 0.01;

/// The arm's space with a picker in it, thickened by `clear_m` metres.
pub(super) fn space_beside(space: &ArmSpace, picker: Option<&PickerAhead>, clear_m: f64) -> ArmSpace {
    let mut space = space.clone();
    let limbs = |p: &PickerAhead| p.arms.first().map_or_else(Vec::new, |limbs| limbs.capsules(clear_m));
    let body = |c: &Capsule| Capsule { radius_m: c.radius_m + clear_m, ..*c };
    if let Some(picker) = picker {
        space.obstacles.extend(limbs(picker));
        space.obstacles.extend(picker.body.iter().map(body));
    }
    space
}

/// An arm beside a picker in one cycle.
pub(super) struct BesidePicker<'a> {
    space: &'a ArmSpace,
    picker: Option<&'a PickerAhead>,
    /// Distances kept from head and trunk, and from arms, metres: less where the arm is nearer already.
    body_m: f64,
    arms_m: f64,
}

impl<'a> BesidePicker<'a> {
    /// The situation of one cycle, with the arm as it is now.
    pub fn new(space: &'a ArmSpace, picker: Option<&'a PickerAhead>, present: &Joints) -> BesidePicker<'a> {
        let mut beside = BesidePicker { space, picker, body_m: BODY_M, arms_m: ARMS_M };
        let Some(picker) = picker else { return beside };
        let links = beside.links(present, 0.0);
        beside.body_m = (least_distance_m(&links, &picker.body) - NEAR_M).clamp(NEAR_M, BODY_M);
        if picker.arms.first().is_some_and(|a| overlap_probability(&beside.links(present, ARMS_M), a) > DELTA)
        {
            beside.arms_m = NEAR_M;
        }
        beside
    }

    fn links(&self, q: &Joints, margin_m: f64) -> Vec<Capsule> {
        self.space.kind.capsules(&self.space.kind.pose(&self.space.base, q), margin_m)
    }

    /// The probability that the arm at these angles meets the picker at a step of a trajectory.
    pub fn risk(&self, q: &Joints, step: usize) -> f64 {
        let Some(picker) = self.picker else { return 0.0 };
        if least_distance_m(&self.links(q, 0.0), &picker.body) < self.body_m {
            return 1.0;
        }
        let links = self.links(q, self.arms_m);
        picker.arms.get(step).map_or(0.0, |limbs| overlap_probability(&links, limbs))
    }
}

//! Where the picker's arms are and will be, for the robot arm beside: from head and hands as a headset sees them.
//!
//! Main types: [`PickerSight`] (recent observations), [`PickerAhead`] (limbs at the steps of a trajectory). Shoulders
//! and elbows follow from head and hands; the next 0.4 s are forecast by the learned model, and beyond that the last
//! forecast stays in place and becomes less certain. Refuses: to know the picker's intentions otherwise.

use super::capsule::Capsule;
use super::mpc::{CYCLE_S, HORIZON};
use super::risk::{LimbBone, UncertainLimbs, UncertainPoint};
use crate::{FacePlace, HandsSeen, PickFace};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Place;
use giveway_people::reach::arm::{ARM_STEP_S, ARM_STEPS};
use giveway_people::reach::posture::{ArmEstimate, BodyLengths, SeenArm, SeenHead};
use giveway_people::reach::{ArmPoint, ArmSample, PickModel};
use nalgebra::Matrix3;
use std::collections::VecDeque;

/// Number of observations kept: half a second at 90 Hz.
const KEPT: usize = 45;
/// Time after which an unseen hand is unknown.
const STALE: Span = Span::from_secs(1);
/// Standard deviation of measured hand positions, metres.
const MEASURED_M: f64 = 0.012;
/// Growth of the standard deviation for a hand that is unseen for 0.1 s or lies beyond the forecast, metres per second.
const DRIFTS_MPS: f64 = 0.12;
/// Radii of upper arm, lower arm and hand, of head and trunk, metres.
const UPPER_M: f64 = 0.055;
const LOWER_M: f64 = 0.045;
const HAND_M: f64 = 0.045;
const HEAD_M: f64 = 0.14;
const TRUNK_M: f64 = 0.19;
/// Width of the 95 % region of a direction in space, in standard deviations.
const REGION: f64 = 2.8;
/// Distance from wrist to palm, metres.
const PALM_M: f64 = 0.08;

/// Recent observations of a picker.
#[derive(Clone, Debug, Default)]
pub struct PickerSight {
    seen: VecDeque<HandsSeen>,
    lengths: Option<BodyLengths>,
}

/// Where a picker will be.
#[derive(Clone, Debug, PartialEq)]
pub struct PickerAhead {
    /// Head and trunk, which hardly move.
    pub body: Vec<Capsule>,
    /// Both arms at each step of a trajectory.
    pub arms: Vec<UncertainLimbs>,
}

/// Shoulder, elbow, palm and finger tip of one arm with their standard deviations in metres, in the opening's frame.
type ArmBelief = [(ArmPoint, f64); 4];

impl PickerSight {
    /// Adds an observation. Observations out of order are dropped; a new person starts afresh.
    pub fn see(&mut self, seen: &HandsSeen) {
        if self.seen.back().is_some_and(|last| last.seen >= seen.seen) {
            return;
        }
        if self.seen.back().is_some_and(|last| last.person != seen.person) {
            self.seen.clear();
            self.lengths = None;
        }
        if self.seen.len() == KEPT {
            self.seen.pop_front();
        }
        self.seen.push_back(*seen);
        let standing = BodyLengths::of_head(seen.head.z);
        let lengths = self.lengths.get_or_insert(standing);
        if standing.height_m > lengths.height_m {
            *lengths = standing;
        }
    }

    /// Whether hands were seen within the last second.
    pub fn is_fresh(&self, now: Time) -> bool {
        self.seen.back().is_some_and(|last| now - last.seen < STALE)
    }

    /// Where the picker's limbs are as far as they were seen, or will be by a model; nothing for a picker who has not
    /// been seen for a second.
    pub fn ahead(&self, face: &PickFace, now: Time, model: Option<&PickModel>) -> Option<PickerAhead> {
        let last = self.seen.back().filter(|last| now - last.seen < STALE)?;
        let lengths = self.lengths?;
        let sides = [true, false];
        let arms: Vec<Vec<ArmBelief>> =
            sides.iter().filter_map(|left| self.arm(face, &lengths, *left, now, model)).collect();
        let limbs = |k: usize| {
            let mut all = UncertainLimbs { points: Vec::new(), bones: Vec::new() };
            arms.iter().for_each(|arm| add(&mut all, face, &arm[k]));
            all
        };
        let head = head_of(face, &last.head);
        let neck = head.at - nalgebra::Vector3::z() * 0.2;
        let hip = ArmPoint::new(neck.x, neck.y, 0.55 * lengths.height_m * 0.9);
        let body = vec![
            Capsule { a: last.head, b: last.head, radius_m: HEAD_M },
            Capsule { a: on_map(face, neck), b: on_map(face, hip), radius_m: TRUNK_M },
        ];
        Some(PickerAhead { body, arms: (0..HORIZON).map(limbs).collect() })
    }

    /// One arm at the steps of a trajectory.
    fn arm(
        &self,
        face: &PickFace,
        lengths: &BodyLengths,
        is_left: bool,
        now: Time,
        model: Option<&PickModel>,
    ) -> Option<Vec<ArmBelief>> {
        let i = usize::from(!is_left);
        let shown = |seen: &HandsSeen| {
            let hand = seen.hands[i].filter(|h| h.is_sound())?;
            let head = head_of(face, &seen.head);
            let at = |place: &Place| in_opening(face, place);
            let arm =
                SeenArm { is_left, wrist: at(&hand.wrist), palm: at(&hand.palm), finger: at(&hand.grip()) };
            Some((seen.seen, head, arm, lengths.arm(&head, &arm)?))
        };
        let (seen, _, arm, estimate) = self.seen.iter().rev().find_map(shown)?;
        let ago_s = (now - seen).as_secs_f64().max(0.0);
        let still = belief(&arm, &estimate, ago_s);
        let Some(model) = model else { return Some(vec![still; HORIZON]) };
        let samples: Vec<ArmSample> = self
            .seen
            .iter()
            .filter_map(|s| {
                let (at, head, arm, _) = shown(s)?;
                lengths.sample((at - seen).as_secs_f64(), &head, &arm)
            })
            .collect();
        let observed = spaced(&samples);
        let forecast = model.arm.forecast(&observed).filter(|_| observed.len() > 2);
        let Some(forecast) = forecast else { return Some(vec![still; HORIZON]) };
        let flip = |p: ArmPoint| if is_left { ArmPoint::new(p.x, -p.y, p.z) } else { p };
        let step = |k: usize| {
            let ahead_s = ago_s + CYCLE_S * (k + 1) as f64;
            let step = ((ahead_s / ARM_STEP_S).round() as usize).clamp(1, ARM_STEPS) - 1;
            let beyond_s = (ahead_s - (step + 1) as f64 * ARM_STEP_S).max(0.0);
            let part = |p: usize| {
                let sd_m = model.arm.radius_m(&forecast, step, p) / REGION + beyond_s * DRIFTS_MPS;
                (flip(forecast.middle[step][p]), sd_m.min(0.2))
            };
            let [shoulder, forearm, palm, finger] = [0, 1, 2, 3].map(part);
            let to_palm = (palm.0 - forearm.0).try_normalize(1e-6).unwrap_or_default();
            let wrist = palm.0 - to_palm * PALM_M;
            let elbow = forearm.0 + (forearm.0 - wrist);
            [shoulder, (elbow, forearm.1 + 0.02), palm, finger]
        };
        Some((0..HORIZON).map(step).collect())
    }
}

fn belief(arm: &SeenArm, estimate: &ArmEstimate, ago_s: f64) -> ArmBelief {
    let drift_m = (ago_s - 0.1).max(0.0) * DRIFTS_MPS;
    let measured = MEASURED_M + drift_m;
    let ArmEstimate { shoulder, shoulder_sd_m, elbow, elbow_sd_m } = *estimate;
    [
        (shoulder, shoulder_sd_m.min(0.04)),
        (elbow, elbow_sd_m.min(0.04) + drift_m),
        (arm.palm, measured),
        (arm.finger, measured),
    ]
}

/// The last samples, resampled to the interval that the model has learned.
fn spaced(samples: &[ArmSample]) -> Vec<ArmSample> {
    let Some(last) = samples.last() else { return Vec::new() };
    let mut all = Vec::with_capacity(ARM_STEPS);
    for k in (0..ARM_STEPS).rev() {
        let at_s = last.at_s - k as f64 * ARM_STEP_S;
        let Some(after) = samples.iter().position(|s| s.at_s >= at_s - 1e-9) else { continue };
        let later = &samples[after];
        if after == 0 {
            if later.at_s - at_s < 1e-3 {
                all.push(*later);
            }
            continue;
        }
        let before = &samples[after - 1];
        all.push(before.towards(later, (at_s - before.at_s) / (later.at_s - before.at_s).max(1e-6)));
    }
    all
}

fn add(limbs: &mut UncertainLimbs, face: &PickFace, arm: &ArmBelief) {
    let first = limbs.points.len();
    limbs.points.extend(arm.iter().map(|(at, sd_m)| UncertainPoint {
        mean: on_map(face, *at),
        cov: Matrix3::identity() * (sd_m * sd_m),
    }));
    for (k, radius_m) in [UPPER_M, LOWER_M, HAND_M].into_iter().enumerate() {
        limbs.bones.push(LimbBone { from: first + k, to: first + k + 1, radius_m });
    }
}

fn head_of(face: &PickFace, head: &Place) -> SeenHead {
    SeenHead { at: in_opening(face, head), yaw: 0.0, pitch: 0.0 }
}

/// A place on the map in the frame of the opening: x into it, y to the picker's left.
fn in_opening(face: &PickFace, place: &Place) -> ArmPoint {
    let at = face.of(*place);
    ArmPoint::new(-at.y, -at.x, at.z)
}

fn on_map(face: &PickFace, at: ArmPoint) -> Place {
    face.on_map(FacePlace::new(-at.y, -at.x, at.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HandPoints;
    use giveway_floor::id::StationId;
    use giveway_floor::warehouse::stations;

    fn face() -> PickFace {
        let w = stations();
        let place = &w.stations[StationId(0)];
        let rack = w.rack_types.iter().next().unwrap();
        PickFace::new(place.cell.as_ref().unwrap(), w.nodes[place.node].at, rack)
    }

    /// A right hand that goes into the rack at half a metre a second; the left one rests. 60 a second.
    fn sight(face: &PickFace, frames: usize) -> (PickerSight, Time) {
        let mut sight = PickerSight::default();
        let at = |frame: usize| Time((frame as f64 / 60.0 * 1e6) as i64);
        for frame in 0..frames {
            let hand = |x: f64, y: f64| {
                let place = |back: f64| face.on_map(FacePlace::new(x, y + back, 1.1));
                Some(HandPoints { wrist: place(0.17), palm: place(0.09), tips: [place(0.0); 2] })
            };
            let y = 0.95 - 0.5 * frame as f64 / 60.0;
            let hands = [hand(-0.22, 0.95), hand(0.22, y)];
            let head = face.on_map(FacePlace::new(0.0, 1.05, 1.63));
            sight.see(&HandsSeen {
                station: StationId(0),
                person: 1,
                seen: at(frame),
                head,
                facing: None,
                eyes: None,
                hands,
            });
        }
        (sight, at(frames - 1))
    }

    #[test]
    fn limbs_are_where_hands_were_seen_and_a_forecast_is_ahead_of_them() {
        let face = face();
        let (sight, now) = sight(&face, 40);
        let seen = sight.ahead(&face, now, None).expect("hands are seen");
        assert_eq!((seen.arms.len(), seen.arms[0].bones.len(), seen.body.len()), (HORIZON, 6, 2));
        let tip = |ahead: &PickerAhead, k: usize| face.of(ahead.arms[k].points[7].mean);
        let here = tip(&seen, 9);
        assert!((here - FacePlace::new(0.22, 0.95 - 0.5 * 39.0 / 60.0, 1.1)).norm() < 1e-6);
        let forecast = sight.ahead(&face, now, Some(&PickModel::builtin())).unwrap();
        let then = tip(&forecast, 2);
        assert!(then.y < here.y - 0.03 && then.y > here.y - 0.5, "{then} after {here}");
        let spread = |k: usize| forecast.arms[k].points[7].cov[(0, 0)].sqrt();
        assert!(spread(9) > spread(0), "what is farther ahead is less certain");
    }

    #[test]
    fn a_picker_who_was_not_seen_for_a_second_is_not_known_of() {
        let face = face();
        let (sight, now) = sight(&face, 40);
        assert!(sight.is_fresh(now) && !sight.is_fresh(now + Span::from_secs(1)));
        assert_eq!(sight.ahead(&face, now + Span::from_secs(1), None), None);
    }
}

//! Postures estimated from headsets' samples, for simulated people whose arms are known.

use crate::picker::motion::{ArmBuild, ArmPose, ArmReach};
use crate::random::Stream;
use giveway_people::reach::posture::{BodyLengths, SeenArm, SeenHead};
use giveway_people::reach::{ArmPoint, ReachTarget};

/// Poses of simulated people on their way to a place.
fn poses(person: u64) -> (ArmBuild, Vec<ArmPose>) {
    let mut chance = Stream::new(9, 9, person);
    let build = ArmBuild::any(0.0, &mut chance);
    let hand = ArmPoint::new(0.5, chance.between(-0.5, 0.4), chance.between(0.9, 1.8));
    let place = ReachTarget { hand, look: hand };
    let reach = ArmReach::new(&build, &build.rest(&mut chance), &place, &mut chance);
    let end_s = reach.duration_s();
    (build, (0..=10).map(|k| reach.at(end_s * f64::from(k) / 10.0)).collect())
}

fn seen(pose: &ArmPose) -> (SeenHead, SeenArm) {
    let s = &pose.sample;
    let head = SeenHead { at: s.head, yaw: s.yaw, pitch: s.pitch };
    (head, SeenArm { is_left: false, wrist: pose.wrist, palm: s.hand, finger: s.finger })
}

#[test]
fn shoulders_and_elbows_of_simulated_people_lie_where_they_are_said_to() {
    let (mut count, mut shoulders, mut elbows, mut far) = (0, 0, 0, 0.0);
    for person in 0..60 {
        let (build, poses) = poses(person);
        let mut lengths = BodyLengths::of_head(build.head.z);
        for pose in &poses {
            let (head, arm) = seen(pose);
            lengths.learn(&head, &arm);
            let said = lengths.arm(&head, &arm).expect("the arm is the wearer's own");
            // 2.8 standard deviations hold 95 % of directions in space.
            let shoulder = (said.shoulder - pose.sample.shoulder).norm();
            let elbow = (said.elbow - pose.elbow).norm();
            count += 1;
            shoulders += usize::from(shoulder < 2.8 * said.shoulder_sd_m);
            elbows += usize::from(elbow < 2.8 * said.elbow_sd_m);
            far += elbow;
        }
    }
    let share = |n: usize| n as f64 / f64::from(count);
    assert!(share(shoulders) > 0.85 && share(elbows) > 0.85, "{} {}", share(shoulders), share(elbows));
    assert!(far / f64::from(count) < 0.12, "elbows are {:.3} m off", far / f64::from(count));
}

//! Quantiles of simulated people's movements, compared with recorded ones.

use super::*;
use crate::random::Stream;
use giveway_people::reach::sample::angles;
use giveway_people::reach::{ArmPoint, ReachTarget};

/// Places like those that recorded people pointed at: three columns, three rows, 1.5 m ahead; hands end within reach.
fn places(build: &ArmBuild) -> Vec<ReachTarget> {
    let mut all = Vec::new();
    for y in [0.9, -0.1, -1.1] {
        for z in [2.4, 1.4, 0.5] {
            let look = ArmPoint::new(build.shoulder.x + 1.6, y, z);
            let ahead = (look - build.shoulder).normalize();
            all.push(ReachTarget { hand: build.shoulder + ahead * build.longest_m() * 0.97, look });
        }
    }
    all
}

/// Figures of one movement.
#[derive(Default)]
struct Figures {
    time_s: Vec<f64>,
    distance_m: Vec<f64>,
    peak_mps: Vec<f64>,
    peak_share: Vec<f64>,
    path_ratio: Vec<f64>,
    shoulder_m: Vec<f64>,
    head_m: Vec<f64>,
    yaw_share: Vec<f64>,
    pitch_share: Vec<f64>,
}

impl Figures {
    /// Onset and arrival are where the finger tip passes 0.10 m/s, as in recordings at 25 Hz.
    fn add(&mut self, reach: &ArmReach, rest: &ArmRest, place: &ReachTarget) {
        const STEP_S: f64 = 0.04;
        let poses: Vec<ArmPose> = (0..80).map(|k| reach.at(-0.4 + k as f64 * STEP_S)).collect();
        let finger = |i: usize| poses[i].sample.finger;
        let speed = |i: usize| (finger(i) - finger(i - 1)).norm() / STEP_S;
        let fastest = (1..80).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap();
        let onset = (1..fastest).rev().find(|i| speed(*i) < 0.1).unwrap();
        let arrival = (fastest..80).find(|i| speed(*i) < 0.1).unwrap();
        let time = (arrival - onset) as f64;
        let distance = (finger(arrival) - finger(onset)).norm();
        let path: f64 = (onset + 1..=arrival).map(|i| (finger(i) - finger(i - 1)).norm()).sum();
        self.time_s.push(time * STEP_S);
        self.distance_m.push(distance);
        self.peak_mps.push(speed(fastest));
        self.peak_share.push((fastest - onset) as f64 / time);
        self.path_ratio.push(path / distance);
        let (first, last) = (&poses[onset].sample, &poses[arrival].sample);
        self.shoulder_m.push((last.shoulder - first.shoulder).norm());
        self.head_m.push((last.head - first.head).norm());
        let (yaw, pitch) = angles(place.look - last.head);
        if yaw.abs() > 0.3 {
            self.yaw_share.push((last.yaw - rest.yaw) / yaw);
        }
        if pitch.abs() > 0.3 {
            self.pitch_share.push((last.pitch - rest.pitch) / pitch);
        }
    }
}

fn quantiles(mut of: Vec<f64>) -> [f64; 3] {
    of.sort_by(f64::total_cmp);
    [0.05, 0.5, 0.95].map(|q| of[((of.len() - 1) as f64 * q) as usize])
}

/// Tolerance: each quantile within this share of the recorded one, or of the recorded median.
fn check(what: &str, simulated: Vec<f64>, recorded: [f64; 3], share: f64) {
    let simulated = quantiles(simulated);
    for (s, r) in simulated.into_iter().zip(recorded) {
        let far = (s - r).abs() / r.abs().max(0.5 * recorded[1]);
        assert!(far <= share, "{what}: 5/50/95 % {simulated:.3?}, recorded {recorded:?}");
    }
}

#[test]
fn simulated_people_move_as_recorded_ones_do() {
    let mut figures = Figures::default();
    for person in 0..60 {
        let mut chance = Stream::new(1, 7, person);
        let build = ArmBuild::any(0.3, &mut chance);
        for place in places(&build) {
            let rest = build.rest(&mut chance);
            figures.add(&ArmReach::new(&build, &rest, &place, &mut chance), &rest, &place);
        }
    }
    check("movement time, s", figures.time_s, [0.68, 0.88, 1.24], 0.15);
    check("distance, m", figures.distance_m, [0.52, 0.80, 1.04], 0.25);
    check("peak speed, m/s", figures.peak_mps, [1.3, 2.1, 3.0], 0.20);
    check("share of the time at the peak", figures.peak_share, [0.22, 0.37, 0.53], 0.20);
    check("path over straight line", figures.path_ratio, [1.05, 1.14, 1.34], 0.08);
    check("shoulder, m", figures.shoulder_m, [0.02, 0.05, 0.09], 0.40);
    check("head, m", figures.head_m, [0.02, 0.04, 0.08], 0.40);
    let [_, yaw, _] = quantiles(figures.yaw_share);
    let [_, pitch, _] = quantiles(figures.pitch_share);
    assert!((yaw - 0.70).abs() < 0.08 && (pitch - 0.37).abs() < 0.08, "{yaw} {pitch}");
}

#[test]
fn bones_keep_their_lengths_and_left_is_the_mirror_of_right() {
    let mut chance = Stream::new(2, 7, 0);
    let right = ArmBuild::any(0.0, &mut chance);
    let left = ArmBuild { side: ArmSide::Left, ..right };
    let place = places(&right)[0];
    let rest = right.rest(&mut chance);
    let a = ArmReach::new(&right, &rest, &place, &mut Stream::new(3, 7, 0));
    let b = ArmReach::new(&left, &rest, &place.mirrored(), &mut Stream::new(3, 7, 0));
    for k in 0..=20 {
        let t_s = a.duration_s() * f64::from(k) / 20.0;
        let (r, l) = (a.at(t_s), b.at(t_s));
        assert!(((r.elbow - r.sample.shoulder).norm() - right.upper_m).abs() < 1e-9);
        assert!(((r.wrist - r.elbow).norm() - right.lower_m).abs() < 1e-9);
        assert!((l.sample.finger.y + r.sample.finger.y).abs() < 1e-12 && l.sample.yaw == -r.sample.yaw);
    }
}

#[test]
fn eyes_are_at_the_place_before_the_hand_moves_and_the_head_goes_only_part_of_the_way() {
    let mut chance = Stream::new(4, 7, 0);
    let build = ArmBuild { wanders: 0.0, ..ArmBuild::any(0.0, &mut chance) };
    let place = places(&build)[0];
    let reach = ArmReach::new(&build, &build.rest(&mut chance), &place, &mut chance);
    let late = reach.at(reach.duration_s());
    let (yaw, pitch) = angles(place.look - late.sample.head);
    assert!((late.gaze.0 - yaw).abs() < 0.05 && (late.gaze.1 - pitch).abs() < 0.05);
    assert!((late.sample.yaw - yaw).abs() > 0.1, "the head must not be where the eyes are");
}

//! Movements of simulated people to learn from, among places on random racks.
//!
//! Main functions: [`simulated_lessons`], [`simulated_reach`]. Every person stands before a different rack: rows,
//! columns, distances and heights differ, and so does how far behind its slots a person looks. Refuses: recordings.

use super::ends::EndCourse;
use super::items::{ReachItem, STEP_S, Variety};
use super::lessons::PickLessons;
use super::slots::END_COURSE;
use crate::picks::{GazeSample, GazeTrial};
use giveway_people::reach::sample::angles;
use giveway_people::reach::{ArmPoint, ArmSample, ReachTarget};
use giveway_sim::picker::motion::{ArmBuild, ArmPose, ArmReach};
use giveway_sim::random::Stream;

/// Number of reaches per person.
const REACHES: usize = 15;
/// A finger tip slower than this rests, metres per second.
const REST_MPS: f64 = 0.10;
/// Number of samples before the onset and after the arrival, as in recordings.
const BEFORE: usize = 5;
const AFTER: usize = 3;

/// Training parameters for simulated people, who are more numerous and already vary.
pub const SIMULATED_COURSE: EndCourse = EndCourse {
    epochs: 10,
    variety: Variety { size: 0.05, pace: 0.10, turn: 0.08, gain: 0.10, bias: 0.05, ends: 0.02, noise: 0.003 },
    strangers: Some(Variety {
        size: 0.12,
        pace: 0.20,
        turn: 0.15,
        gain: 0.30,
        bias: 0.12,
        ends: 0.06,
        noise: 0.004,
    }),
    ..END_COURSE
};

/// A rack of slots before a person.
fn rack(build: &ArmBuild, chance: &mut Stream) -> Vec<ReachTarget> {
    let (columns, rows) = (2 + chance.below(4), 2 + chance.below(4));
    let (width, height) = (chance.between(0.5, 1.1), chance.between(0.5, 1.1));
    let reach = build.longest_m();
    let middle = ArmPoint::new(
        build.shoulder.x + reach * chance.between(0.75, 1.0),
        build.shoulder.y + chance.between(0.0, 0.35),
        build.shoulder.z + chance.between(-0.15, 0.25),
    );
    let deeper = chance.between(0.02, 1.0);
    let mut places = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let share = |i: usize, n: usize| (i as f64 + 0.5) / n as f64 - 0.5;
            let hand = middle
                + giveway_people::reach::ArmVector::new(
                    0.0,
                    width * share(column, columns),
                    height * share(row, rows),
                );
            // Far corners are reached with a bent body or not at all: they are moved nearer.
            let from = hand - build.shoulder;
            let hand = build.shoulder + from * (1.08 * reach / from.norm()).min(1.0);
            let look = hand + (hand - build.head) * deeper;
            places.push(ReachTarget { hand, look });
        }
    }
    places
}

/// One reach as in a recording: from shortly before the onset to shortly after the arrival; nothing if the finger tip
/// was never fast.
pub fn simulated_reach(
    build: &ArmBuild,
    places: &[ReachTarget],
    right: usize,
    chance: &mut Stream,
) -> Option<ReachItem> {
    let reach = ArmReach::new(build, &build.rest(chance), &places[right], chance);
    let start_s = -0.4 - STEP_S * chance.unit();
    let count = ((reach.duration_s() + 1.0) / STEP_S) as usize;
    let poses: Vec<ArmPose> = (0..count).map(|k| reach.at(start_s + k as f64 * STEP_S)).collect();
    let samples: Vec<ArmSample> = poses.iter().map(|p| p.sample).collect();
    let speed = |i: usize| (samples[i].finger - samples[i - 1].finger).norm() / STEP_S;
    let fastest = (1..samples.len()).max_by(|a, b| speed(*a).total_cmp(&speed(*b)))?;
    let onset = (1..fastest).rev().find(|i| speed(*i) < REST_MPS)?;
    let arrival = (fastest..samples.len()).find(|i| speed(*i) < REST_MPS)?;
    let (from, to) = (onset.saturating_sub(BEFORE), (arrival + AFTER + 1).min(samples.len()));
    Some(ReachItem {
        person: 0,
        samples: samples[from..to].to_vec(),
        onset: onset - from,
        arrival: arrival - from,
        targets: places.to_vec(),
        right,
        places: Vec::new(),
    })
}

/// Movements and eyes of `pickers` simulated people, and how much their eyes are at the places they reach for.
pub fn simulated_lessons(pickers: usize, seed: u64) -> (PickLessons, f64) {
    let mut lessons = PickLessons {
        sources: vec![format!("{pickers} simulated pickers of seed {seed}")],
        people: (0..pickers).map(|p| format!("simulated {p}")).collect(),
        ..PickLessons::default()
    };
    let (mut over, mut under) = (0.0, 1e-9);
    for person in 0..pickers {
        let mut chance = Stream::new(seed, 310, person as u64);
        let build = ArmBuild::any(0.0, &mut chance);
        let places = rack(&build, &mut chance);
        for _ in 0..REACHES {
            let right = chance.below(places.len());
            let item = simulated_reach(&build, &places, right, &mut chance);
            lessons.items.extend(item.map(|i| ReachItem { person, ..i }));
        }
        let right = chance.below(places.len());
        let reach = ArmReach::new(&build, &build.rest(&mut chance), &places[right], &mut chance);
        let end_s = reach.duration_s();
        let poses: Vec<ArmPose> = (0..25).map(|k| reach.at(end_s + 0.2 - (24 - k) as f64 * 0.07)).collect();
        for pose in &poses {
            let head = (pose.sample.yaw, pose.sample.pitch);
            let place = angles(places[right].look - pose.sample.head);
            for (head, eye, place) in [(head.0, pose.gaze.0, place.0), (head.1, pose.gaze.1, place.1)] {
                let way = place - 1.3 * head;
                over += way * (eye - 1.3 * head);
                under += way * way;
            }
        }
        let sample = |(k, p): (usize, &ArmPose)| GazeSample {
            at_s: (k as f64 - 24.0) * 0.07,
            eye: p.gaze,
            head: (p.sample.yaw, p.sample.pitch),
        };
        lessons.gaze.push(GazeTrial { samples: poses.iter().enumerate().map(sample).collect() });
    }
    (lessons, (over / under).clamp(0.0, 1.0))
}

//! Reaches to learn from, recorded or simulated, and how they are varied.
//!
//! Main types: [`ReachItem`], [`Variety`]. A few people can represent many only if what differs between people is
//! varied: size, direction, pace, how far a head turns, where a hand ends. Refuses: to change which place is the right
//! one.

use crate::picks::{PickRecording, RecordedReach};
use giveway_people::reach::{ArmPoint, ArmSample, ArmVector, ReachTarget};
use giveway_sim::random::Stream;

/// One movement with its candidate places.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachItem {
    /// Number of the person.
    pub person: usize,
    /// Samples in order of time.
    pub samples: Vec<ArmSample>,
    /// Index of the sample at the onset.
    pub onset: usize,
    /// Index of the sample at the arrival.
    pub arrival: usize,
    /// Candidate places.
    pub targets: Vec<ReachTarget>,
    /// Index of the right candidate.
    pub right: usize,
    /// The candidates' numbers among all places; empty where places have none.
    pub places: Vec<usize>,
}

impl ReachItem {
    /// A recorded movement among places of which one is the right one.
    pub fn of(recording: &PickRecording, reach: &RecordedReach, places: &[usize]) -> Option<ReachItem> {
        Some(ReachItem {
            person: reach.person,
            samples: reach.samples.clone(),
            onset: reach.onset,
            arrival: reach.arrival,
            targets: recording.targets(reach, places),
            right: places.iter().position(|p| *p == reach.place)?,
            places: places.to_vec(),
        })
    }
}

/// Standard deviations of variations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variety {
    /// Relative variation of all lengths.
    pub size: f64,
    /// Relative variation of all times.
    pub pace: f64,
    /// Variation of the body's direction, radians.
    pub turn: f64,
    /// Relative variation of the head's turn.
    pub gain: f64,
    /// Variation of the head's direction when it faces ahead, radians.
    pub bias: f64,
    /// Variation of the hand's end, metres.
    pub ends: f64,
    /// Noise of measured positions, metres.
    pub noise: f64,
}

/// Step of the nets, seconds.
pub const STEP_S: f64 = 0.04;

/// Largest number of steps of rest before a movement.
const LONGEST_REST: usize = 8;

impl Variety {
    /// Variations as large as the differences between people.
    pub const PEOPLE: Variety =
        Variety { size: 0.06, pace: 0.10, turn: 0.06, gain: 0.15, bias: 0.05, ends: 0.02, noise: 0.001 };

    /// A random variation of a movement.
    pub fn vary(&self, item: &ReachItem, chance: &mut Stream) -> ReachItem {
        let mut limited = |sd: f64| sd * chance.normal().clamp(-2.5, 2.5);
        let (size, pace) = (1.0 + limited(self.size), 1.0 + limited(self.pace));
        let turn = limited(self.turn);
        let (yaw_gain, pitch_gain) = (1.0 + limited(self.gain), 1.0 + 1.5 * limited(self.gain));
        let (yaw_bias, pitch_bias) = (limited(self.bias), limited(self.bias));
        let ends = ArmVector::new(limited(self.ends), limited(self.ends), limited(self.ends));
        let first = item.samples[item.onset].shoulder;
        let (sin, cos) = (libm::sin(turn), libm::cos(turn));
        let place = |p: ArmPoint| {
            let v = (p - first) * size;
            first + ArmVector::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
        };
        let start = item.samples[0];
        let varied = |s: &ArmSample| ArmSample {
            at_s: start.at_s + (s.at_s - start.at_s) * pace,
            shoulder: place(s.shoulder),
            forearm: place(s.forearm),
            hand: place(s.hand),
            finger: place(s.finger),
            head: place(s.head),
            yaw: s.yaw * yaw_gain + yaw_bias + turn,
            pitch: s.pitch * pitch_gain + pitch_bias,
        };
        let samples: Vec<ArmSample> = item.samples.iter().map(varied).collect();
        let target = |t: &ReachTarget| ReachTarget { hand: place(t.hand) + ends, look: place(t.look) };
        let (onset_s, arrival_s) = (samples[item.onset].at_s, samples[item.arrival].at_s);
        let mut samples = still_before(stepped(&samples, STEP_S * chance.unit()), chance.below(LONGEST_REST));
        for s in &mut samples {
            let mut noise = || self.noise * chance.normal();
            for p in [&mut s.shoulder, &mut s.forearm, &mut s.hand, &mut s.finger, &mut s.head] {
                *p += ArmVector::new(noise(), noise(), noise());
            }
        }
        let nearest = |at_s: f64| {
            let far = |i: &usize| (samples[*i].at_s - at_s).abs();
            (0..samples.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
        };
        let (onset, arrival) = (nearest(onset_s), nearest(arrival_s));
        let targets = item.targets.iter().map(target).collect();
        ReachItem { samples, onset, arrival, targets, places: item.places.clone(), ..*item }
    }
}

/// The samples after `steps` steps of rest, so that how long a person was seen tells nothing.
fn still_before(samples: Vec<ArmSample>, steps: usize) -> Vec<ArmSample> {
    let first = samples[0];
    let still = |k: usize| ArmSample { at_s: first.at_s - (steps - k) as f64 * STEP_S, ..first };
    (0..steps).map(still).chain(samples).collect()
}

/// The samples resampled to [`STEP_S`], the first one `first_s` after the first sample.
pub fn stepped(samples: &[ArmSample], first_s: f64) -> Vec<ArmSample> {
    let (begin, end) = (samples[0].at_s + first_s, samples[samples.len() - 1].at_s);
    let count = ((end - begin) / STEP_S + 1e-6).floor().max(0.0) as usize + 1;
    let mut i = 0;
    let at = |k: usize| {
        let at_s = begin + k as f64 * STEP_S;
        while i + 2 < samples.len() && samples[i + 1].at_s < at_s {
            i += 1;
        }
        let (a, b) = (&samples[i], &samples[(i + 1).min(samples.len() - 1)]);
        let share = (at_s - a.at_s) / (b.at_s - a.at_s).max(1e-9);
        a.towards(b, share.clamp(0.0, 1.0))
    };
    (0..count).map(at).collect()
}

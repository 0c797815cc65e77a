//! Predictions for recorded people, and their scores.
//!
//! Main types: [`PickReport`], [`ArmScore`], [`PickPart`]; main functions: [`fold`], [`with_model`]. Refuses: to
//! average over folds; all movements count equally.

use super::data::{PickRecording, SlotChoice};
use super::score::{SlotScore, SlotTally, tally_item};
use crate::learning::picks::{
    ArmWindow, LearnedPicks, PickCourse, PickLessons, PlaceVariant, ReachItem, at_parts, candidates_of,
    degrees_between, end_scores, gaze_net_degrees, gaze_pairs, gaze_quantiles, hand_scores, head_scores,
    learn_picks, mean_scores, mixture_scores, place_scores, windows,
};
use giveway_people::reach::arm::{ARM_STEP_S, ARM_STEPS};
use giveway_people::reach::sample::ARM_PARTS;
use giveway_people::reach::{ArmPoint, ArmVector};
use giveway_sim::random::Stream;
use std::collections::BTreeMap;

/// Number of people left out together.
const TOGETHER: usize = 2;
/// Forecast steps at which the arm is scored: 0.08, 0.20 and 0.40 s.
pub const ARM_LOOKS: [usize; 3] = [1, 4, 9];
/// The words of these steps in reports.
pub const ARM_LOOK_WORDS: [&str; 3] = ["0.08", "0.20", "0.40"];
/// The arm's parts, in their order.
pub const ARM_WORDS: [&str; ARM_PARTS] = ["shoulder", "forearm", "hand", "finger"];
/// The 95 % quantile of the length of a normal vector in space.
const NORMAL_95: f64 = 2.7955;

/// Counts of forecasts of the arm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmScore {
    /// Number of windows.
    pub windows: usize,
    /// Sums of errors, metres, by step and part.
    errors: [[f64; ARM_PARTS]; ARM_LOOKS.len()],
    /// How many lay in their 95 % region; nothing if the method has no regions.
    held: Option<[[usize; ARM_PARTS]; ARM_LOOKS.len()]>,
}

/// Figures of some of the people; parts can be merged.
#[derive(Clone, Debug, Default)]
pub struct PickPart {
    movements: usize,
    slots: BTreeMap<&'static str, SlotTally>,
    arm: BTreeMap<&'static str, ArmScore>,
    gaze: BTreeMap<&'static str, Vec<f64>>,
}

/// The whole report.
#[derive(Clone, Debug)]
pub struct PickReport {
    /// Number of people.
    pub people: usize,
    /// Number of movements to the candidates.
    pub movements: usize,
    /// Scores of predicted places, by method.
    pub models: BTreeMap<&'static str, SlotScore>,
    /// Scores of forecasts of the arm, by method.
    pub arm: BTreeMap<&'static str, ArmScore>,
    /// Median and 90 % quantile of the gaze error, degrees, by method.
    pub gaze: BTreeMap<&'static str, (f64, f64)>,
}

impl ArmScore {
    /// Mean error of a part at a step, millimetres.
    pub fn error_mm(&self, look: usize, part: usize) -> f64 {
        self.errors[look][part] / self.windows.max(1) as f64 * 1000.0
    }

    /// Share in the 95 % region; nothing if the method has no regions.
    pub fn cov95(&self, look: usize, part: usize) -> Option<f64> {
        Some(self.held?[look][part] as f64 / self.windows.max(1) as f64)
    }

    /// Adds one window: forecast positions, and whether a part's region contains the truth.
    fn add(
        &mut self,
        window: &ArmWindow,
        middle: &[[ArmPoint; ARM_PARTS]; ARM_STEPS],
        holds: Option<&dyn Fn(usize, usize, ArmVector) -> bool>,
    ) {
        self.windows += 1;
        for (look, k) in ARM_LOOKS.into_iter().enumerate() {
            let truth = window.after[k].parts();
            for p in 0..ARM_PARTS {
                let error = truth[p] - middle[k][p];
                self.errors[look][p] += error.norm();
                if let Some(holds) = holds {
                    let held = self.held.get_or_insert_default();
                    held[look][p] += usize::from(holds(k, p, error));
                }
            }
        }
    }

    fn merge(&mut self, other: &ArmScore) {
        self.windows += other.windows;
        for look in 0..ARM_LOOKS.len() {
            for p in 0..ARM_PARTS {
                self.errors[look][p] += other.errors[look][p];
                if let Some(theirs) = &other.held {
                    self.held.get_or_insert_default()[look][p] += theirs[look][p];
                }
            }
        }
    }
}

/// Number of folds of a recording.
pub fn folds(recording: &PickRecording) -> usize {
    recording.people.len().div_ceil(TOGETHER)
}

/// One fold: learns from all other people, and predicts its own two. Trials of eyes are left out in as many parts,
/// since one wearer made them all.
pub fn fold(
    recording: &PickRecording,
    slots: SlotChoice,
    number: usize,
    course: &PickCourse,
    tell: impl FnMut(&str),
) -> PickPart {
    let is_left_out = |person: usize| person / TOGETHER == number;
    let all = PickLessons::of(&[("recording".to_owned(), recording.clone())]);
    let mut lessons = all.only(|p| !is_left_out(p));
    let count = folds(recording);
    let trial_is_left_out = |i: usize| i * count / recording.gaze.len().max(1) == number;
    let trials = recording.gaze.iter().enumerate().filter(|(i, _)| !trial_is_left_out(*i));
    lessons.gaze = trials.map(|t| t.1.clone()).collect();
    let learned = learn_picks(&lessons, course, tell);
    ask(recording, slots, &learned, is_left_out, trial_is_left_out)
}

/// Predictions of a model learned elsewhere, for all people.
pub fn with_model(recording: &PickRecording, slots: SlotChoice, learned: &LearnedPicks) -> PickPart {
    ask(recording, slots, learned, |_| true, |_| true)
}

/// Merges all parts into the report.
pub fn report(recording: &PickRecording, parts: Vec<PickPart>) -> PickReport {
    let mut all = PickPart::default();
    for part in parts {
        all.movements += part.movements;
        for (word, tally) in part.slots {
            all.slots.entry(word).or_default().merge(&tally);
        }
        for (word, score) in part.arm {
            all.arm.entry(word).or_default().merge(&score);
        }
        for (word, errors) in part.gaze {
            all.gaze.entry(word).or_default().extend(errors);
        }
    }
    PickReport {
        people: recording.people.len(),
        movements: all.movements,
        models: all.slots.iter().filter_map(|(w, t)| Some((*w, t.score()?))).collect(),
        arm: all.arm,
        gaze: all.gaze.into_iter().filter_map(|(w, e)| Some((w, gaze_quantiles(e)?))).collect(),
    }
}

fn ask(
    recording: &PickRecording,
    slots: SlotChoice,
    learned: &LearnedPicks,
    is_asked: impl Fn(usize) -> bool,
    trial_is_asked: impl Fn(usize) -> bool,
) -> PickPart {
    let mut part = PickPart::default();
    let candidates = recording.candidates(slots);
    let names: Vec<String> = recording.places.iter().map(|p| p.name.clone()).collect();
    for (number, reach) in recording.reaches.iter().enumerate().filter(|(_, r)| is_asked(r.person)) {
        if let Some(item) = ReachItem::of(recording, reach, &candidates) {
            part.movements += 1;
            ask_slots(&mut part, &item, &names, learned);
        }
        let everywhere: Vec<usize> = (0..recording.places.len()).collect();
        if let Some(item) = ReachItem::of(recording, reach, &everywhere) {
            ask_arm(&mut part, &item, number as u64, learned);
        }
    }
    let trials = recording.gaze.iter().enumerate().filter(|(i, _)| trial_is_asked(*i));
    for pair in trials.flat_map(|(_, trial)| gaze_pairs(trial)) {
        let mut add = |word, degrees| part.gaze.entry(word).or_default().push(degrees);
        add("head_ray", degrees_between(pair.head, pair.eye));
        add("giveway", degrees_between(learned.model.gaze.from_head(pair.head, pair.speed), pair.eye));
        if let Some(net) = learned.published.as_ref().and_then(|p| p.gaze.as_ref()) {
            add("mlp", gaze_net_degrees(net, &pair));
        }
    }
    part
}

fn ask_slots(part: &mut PickPart, item: &ReachItem, names: &[String], learned: &LearnedPicks) {
    let slots = &learned.model.slots;
    let mut add = |word, scores: &[Vec<f64>], sharpness| {
        tally_item(part.slots.entry(word).or_default(), item, scores, sharpness);
    };
    add("hand", &at_parts(item, &hand_scores(item)), slots.hand_rule);
    add("head", &at_parts(item, &head_scores(item)), slots.head_rule);
    let nets: Vec<Vec<Vec<f64>>> =
        slots.nets.iter().map(|net| at_parts(item, &end_scores(net, item))).collect();
    let ours = mean_scores(&nets);
    if let Some(published) = &learned.published {
        for variant in PlaceVariant::ALL {
            if let Some(net) = published.net(variant, item.targets.len()) {
                add(variant.word(), &at_parts(item, &place_scores(&net.net, item)), net.sharpness);
            }
        }
        let mixtures = candidates_of(names, item, &published.mixtures);
        if mixtures.iter().all(Option::is_some) {
            add("mixtures", &mixture_scores(item, &mixtures, None), published.observed);
            let ahead = mixture_scores(item, &mixtures, Some(&learned.model.arm));
            add("mixtures_ahead", &ahead, published.ahead);
            let [share, sharpness] = published.both;
            let weigh = |(ours, ahead): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                ours.iter().zip(ahead).map(|(o, a)| o * (1.0 - share) + a * share).collect()
            };
            let both: Vec<Vec<f64>> = ours.iter().zip(&ahead).map(weigh).collect();
            add("giveway_with_mixtures", &both, sharpness);
        }
    }
    add("giveway", &ours, slots.sharpness);
}

fn ask_arm(part: &mut PickPart, item: &ReachItem, number: u64, learned: &LearnedPicks) {
    let mut chance = Stream::new(learned.model.seed, 305, number);
    for window in windows(item) {
        let last = window.observed[ARM_STEPS - 1];
        let before = window.observed[ARM_STEPS - 2];
        let mut add = |word, middle: &_, holds: Option<&dyn Fn(usize, usize, ArmVector) -> bool>| {
            part.arm.entry(word).or_default().add(&window, middle, holds);
        };
        add("still", &[last.parts(); ARM_STEPS], None);
        let (old, new) = (before.parts(), last.parts());
        let straight = std::array::from_fn(|k| {
            let share = (k + 1) as f64 * ARM_STEP_S / (last.at_s - before.at_s).max(1e-3);
            std::array::from_fn(|p| new[p] + (new[p] - old[p]) * share)
        });
        add("velocity", &straight, None);
        let arm = &learned.model.arm;
        if let Some(forecast) = arm.forecast(&window.observed) {
            let holds = |k: usize, p: usize, e: ArmVector| e.norm() <= arm.radius_m(&forecast, k, p);
            add("giveway", &forecast.middle, Some(&holds));
        }
        if let Some(published) = &learned.published {
            add("seq2seq", &published.seq2seq.forecast(&window), None);
            add("vae", &published.vae.forecast(&window), None);
            let bones = published.bones.forecast(&window, &mut chance);
            let holds = |k: usize, p: usize, e: ArmVector| {
                let v = bones.variance[k][p];
                let square: f64 = (0..3).map(|d| e[d] * e[d] / v[d].max(1e-12)).sum();
                square <= NORMAL_95 * NORMAL_95
            };
            add("bones", &bones.mean, Some(&holds));
        }
    }
}

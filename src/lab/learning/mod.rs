//! Learning about people from recorded tracks.
//!
//! Main types: [`Lesson`] (a recording with its goals), main function: [`learn`]. Refuses: to read files.

mod motion;
pub mod picks;
mod purpose;
pub mod shapes;

use crate::recorded::{Ground, OBSERVED, RecordedWalks, STEPS, Subject, TrackPoint, all};
use giveway_floor::geometry::Point;
use giveway_people::human::forecast::Shapes;
use giveway_people::human::motion::MotionModel;
use giveway_people::human::{Method, Model};
use shapes::Item;
use std::sync::Arc;

/// Standard deviation of positions in recordings, metres. Any larger error counts as sway.
pub const RECORDED_M: f64 = 0.005;
/// Number of groups of people, each of which is left out once.
const FOLDS: usize = 5;
/// Largest number of stretches of a recording to learn from.
const STRETCHES: usize = 2500;
/// Largest number of stretches for choosing among ways of moving.
const TRIED: usize = 400;

/// A recording to learn from.
#[derive(Clone, Debug)]
pub struct Lesson {
    /// Name of the recording.
    pub name: String,
    /// The recorded walks.
    pub recording: RecordedWalks,
    /// Goals of people, if they are known.
    pub goals: Vec<Point>,
}

/// Learns from recordings, starting from a known model.
pub fn learn(lessons: &[Lesson], start: &Model, mut tell: impl FnMut(&str)) -> Model {
    let mut model = start.clone();
    model.learned_from =
        lessons.iter().map(|l| format!("{} ({} walks)", l.name, l.recording.walks.len())).collect();
    tell("ways of moving");
    model.motion = least_surprised(lessons, &model, motion::fit(lessons, start.motion));
    if lessons.iter().any(|l| !l.goals.is_empty()) {
        tell("goals");
        model.purpose = Arc::new(purpose::fit(lessons, &model));
        tell("forecasts with goals");
        model.bound = forecasts(lessons, &model, true);
    }
    tell("forecasts without goals");
    model.free = forecasts(lessons, &model, false);
    model
}

/// Among ways of moving with similar errors, the one for which the whole forecast is least surprised.
fn least_surprised(lessons: &[Lesson], model: &Model, fitted: MotionModel) -> MotionModel {
    let with_goals = lessons.iter().any(|l| !l.goals.is_empty());
    let surprise = |motion: &MotionModel| {
        let model = Model { motion: *motion, ..model.clone() };
        let known = if with_goals { &model.bound } else { &model.free };
        shapes::surprise(&items(lessons, &model, known.blend_s, with_goals, TRIED), known)
    };
    let scored = motion::calmer(lessons, fitted).into_iter().map(|m| (surprise(&m), m));
    scored.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(fitted, |best| best.1)
}

/// Shapes of forecasts, with or without goals.
fn forecasts(lessons: &[Lesson], model: &Model, with_goals: bool) -> Shapes {
    let old = if with_goals { &model.bound } else { &model.free };
    let items = items(lessons, model, old.blend_s, with_goals, STRETCHES);
    let mut found = shapes::fit(&items, old, |_| false);
    shapes::calibrate(&mut found, &items, old, FOLDS);
    found
}

/// Predictions at every horizon for all stretches, with or without goals.
fn items(lessons: &[Lesson], model: &Model, blend_s: f64, with_goals: bool, at_most: usize) -> Vec<Item> {
    let mut items = Vec::new();
    let mut people = 0;
    for lesson in lessons.iter().filter(|l| !with_goals || !l.goals.is_empty()) {
        let ground = Ground::new(if with_goals { &lesson.goals } else { &[] });
        let stretches = all(&lesson.recording);
        let every = stretches.len().div_ceil(at_most).max(1);
        for s in stretches.iter().step_by(every) {
            let person = people + person_of(&lesson.recording, s.walk);
            let seen = &lesson.recording.walks[s.walk].seen[s.first..s.first + STEPS];
            predict(
                &mut items,
                seen,
                person,
                Subject::new(&ground, model, Method::Detour, RECORDED_M),
                blend_s,
            );
        }
        people += lesson.recording.walks.len();
    }
    items
}

/// The number of the same person's first walk.
fn person_of(recording: &RecordedWalks, walk: usize) -> usize {
    let name = &recording.walks[walk].person;
    recording.walks.iter().position(|w| w.person == *name).unwrap_or(walk)
}

fn predict(
    items: &mut Vec<Item>,
    seen: &[TrackPoint],
    person: usize,
    mut subject: Subject<'_>,
    blend_s: f64,
) {
    let (observed, later) = seen.split_at(OBSERVED);
    observed.iter().for_each(|p| subject.see(p.t, p.at));
    subject.forecast(|forecast| {
        for (horizon, p) in later.iter().enumerate() {
            let guesses = forecast.guesses(p.t, blend_s).expect("eight samples were seen");
            items.push(Item { guesses, truth: p.at, horizon, person });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Dice;
    use crate::recorded::forecasting::{Predictor, score};
    use crate::recorded::{Format, RecordedWalk, scored, trips};
    use giveway_floor::time::Time;

    const GOALS: [(f64, f64); 4] = [(0.0, 0.0), (9.0, 0.0), (9.0, 7.0), (0.0, 7.0)];

    fn goals() -> Vec<Point> {
        GOALS.map(|(x, y)| Point::new(x, y)).to_vec()
    }

    /// People who walk from goal to goal at speeds of their own, slow down there, and sway a little.
    fn people(n: usize, seed: u64) -> RecordedWalks {
        let mut dice = Dice::new(seed);
        let mut chance = move || dice.below(1000) as f64 / 1000.0;
        let walks = (0..n).map(|k| {
            let pace = 0.8 + 0.6 * chance();
            let (mut goal, mut at, mut speed) = (k % 4, goals()[(k + 1) % 4], 0.0);
            let seen = (0..90).map(|i| {
                let to = goals()[goal] - at;
                if to.norm() < 0.6 {
                    goal = (goal + 1 + (chance() * 2.9) as usize) % 4;
                }
                let wanted = if to.norm() < 1.5 { 0.5 * pace } else { pace };
                speed += 0.5 * (wanted - speed);
                at += to / to.norm().max(1e-9) * speed * 0.4;
                let sway = giveway_floor::geometry::Vector::new(chance() - 0.5, chance() - 0.5) * 0.06;
                TrackPoint { t: Time(i * 400_000), step: i, at: at + sway }
            });
            RecordedWalk { person: format!("{k}"), seen: seen.collect(), tracklets: Vec::new() }
        });
        RecordedWalks { format: Format::Thor, walks: walks.collect() }
    }

    #[test]
    fn what_was_learned_from_some_people_holds_for_others() {
        let lesson = Lesson { name: "some".into(), recording: people(6, 1), goals: goals() };
        let mut told = Vec::new();
        let model = learn(&[lesson], &Model::builtin(), |what| told.push(what.to_owned()));
        assert_eq!(Model::parse(&model.to_json()).expect("it can be read again"), model);
        assert_eq!((told.len(), model.learned_from.len()), (4, 1));
        let others = people(4, 2);
        assert!(trips(&others, &goals()).len() > 5);
        let stretches: Vec<_> = scored(&others).into_iter().step_by(6).collect();
        let of = |p| score(&others, &stretches, &goals(), &model, p, RECORDED_M, <[TrackPoint]>::to_vec);
        let (ours, last_step) = (of(Predictor::Giveway), of(Predictor::Constant));
        assert!(ours.ade < 0.8 * last_step.ade, "{} and {}", ours.ade, last_step.ade);
        let covered = ours.covered[2].iter().sum::<f64>() / 12.0;
        assert!((0.88..1.001).contains(&covered), "{covered}");
        assert!(ours.nll < last_step.nll, "{} and {}", ours.nll, last_step.nll);
    }
}

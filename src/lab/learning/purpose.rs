//! Fits the goal recogniser: the figures with the highest likelihood for recorded trips.
//!
//! Main function: [`fit`]. Samples of one trip are dependent, so a trip counts as one observation, and a few trips move
//! the prior (the figures of [`PurposeModel::default`], give or take [`SPREAD`]) only so far. Refuses: people whose
//! goals are not known.

use super::{Lesson, RECORDED_M};
use crate::recorded::{Ground, Subject, Trip, trips, visits};
use giveway_floor::geometry::Point;
use giveway_floor::id::GoalId;
use giveway_people::human::intention::{DetourPlace, PurposeModel};
use giveway_people::human::{Method, Model};
use std::sync::Arc;

/// Number of rounds over all figures.
const ROUNDS: i32 = 4;
/// Number of imagined trips from each goal to each other one.
const IMAGINED: f64 = 4.0;
/// Least probability of a goal.
const FLOOR: f64 = 1e-6;
/// Prior standard deviation of the logarithm of a figure.
const SPREAD: f64 = 0.5;
/// Number of people whose degrees of resoluteness the prior is worth.
const KNOWN: f64 = 5.0;

/// Fits all figures; the places are those of the first lesson with goals.
pub fn fit(lessons: &[Lesson], start: &Model) -> PurposeModel {
    let known: Vec<(&Lesson, Vec<Trip>)> =
        lessons.iter().filter(|l| !l.goals.is_empty()).map(|l| (l, trips(&l.recording, &l.goals))).collect();
    // Starts without learned places: they would be scored on the trips that they were counted from.
    let mut best = PurposeModel { elsewhere: start.purpose.elsewhere, ..PurposeModel::default() };
    let mut least = loss(&known, start, &best);
    for round in 0..ROUNDS {
        let factor = 1.0 + 1.0 / f64::from(1 << round);
        for figure in 0..6 {
            for by in [factor, 1.0 / factor] {
                let tried = changed(best.clone(), figure, by);
                let l = loss(&known, start, &tried);
                if l < least {
                    (least, best) = (l, tried);
                }
            }
        }
    }
    if let Some((lesson, trips)) = known.first() {
        best.places = places(lesson, trips);
        best.dwell_s = best.places.iter().map(|p| p.dwell_s).sum::<f64>() / best.places.len() as f64;
    }
    best
}

fn changed(mut m: PurposeModel, figure: usize, by: f64) -> PurposeModel {
    match figure {
        0 => m.changes_per_s = (m.changes_per_s * by).clamp(1e-3, 2.0),
        1 => m.kappa = (m.kappa * by).clamp(0.1, 20.0),
        2 => m.betas_per_m = m.betas_per_m.map(|b| (b * by).clamp(0.1, 60.0)),
        figure => {
            // More or less of one degree of resoluteness, less or more of all others.
            let i = if figure == 3 { 0 } else { figure - 2 };
            m.beta_shares[i] *= by;
            let total: f64 = m.beta_shares.iter().sum();
            m.beta_shares = m.beta_shares.map(|b| b / total);
        }
    }
    m
}

/// Negative log posterior of the figures, up to a constant: the mean of -ln of the true goal's probability over the
/// interior samples, counted once per trip, plus the prior's term.
fn loss(known: &[(&Lesson, Vec<Trip>)], model: &Model, purpose: &PurposeModel) -> f64 {
    let model = Model { purpose: Arc::new(purpose.clone()), ..model.clone() };
    let (mut sum, mut n) = (0.0, 0);
    for (lesson, trips) in known {
        let ground = Ground::new(&lesson.goals);
        for trip in trips {
            let mut subject = Subject::new(&ground, &model, Method::Detour, RECORDED_M);
            let seen = &lesson.recording.walks[trip.walk].seen[trip.first..trip.last];
            for (i, p) in seen.iter().enumerate() {
                subject.see(p.t, p.at);
                if i > 0 {
                    let belief = subject.belief();
                    let others: f64 = belief.goals.iter().map(|g| g.1).sum();
                    let rest = others - belief.of(GoalId(trip.origin as u64));
                    sum -= (belief.of(GoalId(trip.goal as u64)) / rest).max(FLOOR).ln();
                    n += 1;
                }
            }
        }
    }
    let trips: usize = known.iter().map(|(_, trips)| trips.len()).sum();
    sum / f64::from(n.max(1)) * trips as f64 + surprise(purpose)
}

/// Negative log prior of the figures, up to a constant: log-normal, and Dirichlet for the shares.
fn surprise(purpose: &PurposeModel) -> f64 {
    let usual = PurposeModel::default();
    let off = |a: f64, b: f64| ((a / b).ln() / SPREAD).powi(2) / 2.0;
    let shares = purpose.beta_shares.iter().zip(usual.beta_shares).map(|(s, u)| KNOWN * u * (u / s).ln());
    off(purpose.kappa, usual.kappa)
        + off(purpose.betas_per_m[0], usual.betas_per_m[0])
        + off(purpose.changes_per_s, usual.changes_per_s)
        + shares.sum::<f64>()
}

/// How long people stay at each goal, and where they go next.
fn places(lesson: &Lesson, trips: &[Trip]) -> Vec<DetourPlace> {
    let n = lesson.goals.len();
    let mut stays = vec![Vec::new(); n];
    for walk in &lesson.recording.walks {
        for (goal, first, last) in visits(walk, &lesson.goals) {
            stays[goal].push((walk.seen[last].t - walk.seen[first].t).as_secs_f64());
        }
    }
    let place = |(i, at): (usize, &Point)| {
        let count = |to: usize| trips.iter().filter(|t| t.origin == i && t.goal == to).count() as f64;
        let weights: Vec<f64> = (0..n).map(|to| if to == i { 0.0 } else { count(to) + IMAGINED }).collect();
        let total: f64 = weights.iter().sum::<f64>().max(1e-9);
        let dwell_s = stays[i].iter().sum::<f64>() / stays[i].len().max(1) as f64;
        let next = weights.iter().map(|w| w / total).collect();
        DetourPlace { x_m: at.x, y_m: at.y, dwell_s: dwell_s.max(0.5), next }
    };
    lesson.goals.iter().enumerate().map(place).collect()
}

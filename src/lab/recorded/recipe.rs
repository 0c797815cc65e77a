//! A simple recipe for comparison: goals recognised by figures set by hand, straight ways to all of them, and the mean
//! of these ways as the prediction.
//!
//! Main functions: [`by_hand`] (the figures), [`mean_ways`]. Refuses: to learn anything.

use super::subject::Subject;
use super::tracks::TrackPoint;
use super::windows::PREDICTED;
use giveway_floor::geometry::{Point, Vector};
use giveway_people::human::Model;
use giveway_people::human::intention::PurposeModel;
use std::sync::Arc;

/// How long the last step counts more than the goals, seconds.
const MOMENTUM_S: f64 = 0.8;
/// Least speed of a person who walks to a goal, metres per second.
const SPEED_MIN: f64 = 0.25;

/// The model with hand-set goal figures: one resoluteness for all, 1 % of minds changed in every 0.4 s.
pub fn by_hand(model: &Model) -> Model {
    let purpose = PurposeModel {
        betas_per_m: [3.0; 4],
        kappa: 3.0,
        changes_per_s: 0.025,
        places: Vec::new(),
        ..PurposeModel::default()
    };
    Model { purpose: Arc::new(purpose), ..model.clone() }
}

/// The mean of the straight ways to all goals, weighted by the belief of `subject`; at first it continues the last
/// step.
pub fn mean_ways(
    subject: &Subject<'_>,
    goals: &[Point],
    seen: &[TrackPoint],
    later: &[TrackPoint],
) -> [Point; PREDICTED] {
    let last = seen[seen.len() - 1];
    let velocity = |back: usize| {
        let from = seen[seen.len().saturating_sub(back + 1)];
        let dt = (last.t - from.t).as_secs_f64();
        if dt > 0.0 { (last.at - from.at) / dt } else { Vector::zeros() }
    };
    let speed = ((velocity(1).norm() + velocity(2).norm()) / 2.0).max(SPEED_MIN);
    let belief = subject.belief().goals;
    let known: f64 = belief.iter().map(|g| g.1).sum();
    std::array::from_fn(|i| {
        let ahead = (later[i].t - last.t).as_secs_f64();
        let on = velocity(1) * ahead;
        let ways: Vector = belief
            .iter()
            .map(|(goal, share)| {
                let way = goals[goal.0 as usize] - last.at;
                way * ((speed * ahead / way.norm().max(1e-9)).min(1.0) * share / known)
            })
            .sum();
        let momentum = (-ahead / MOMENTUM_S).exp();
        last.at + on * momentum + ways * (1.0 - momentum)
    })
}

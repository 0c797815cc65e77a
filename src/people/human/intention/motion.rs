//! How well a step fits each goal: the motion validation of the published method.
//!
//! Main function: [`validate`]. A pose has a modulated distance to each goal, and a step is judged by comparing the
//! distance of the reached pose with those of the poses that could have been reached instead (Petković 2021, eq. 3.11
//! to 3.15 and 4.1). Differences from the print: the cases of eq. 3.11 are in the order that its text means; σ is tied
//! to the spacing of the nodes (0.005 has no unit, and at 7 cm only the nearest node would count); candidates off the
//! floor are left out; a range of zero judges nothing; a goal without a way is not approached. Refuses: time.

use crate::human::Distances;
use giveway_floor::geometry::{Point, Segment, turn_between};
use giveway_floor::id::GoalId;
use std::f64::consts::{PI, TAU};

/// Standard deviation of the association, metres: about the spacing of the nodes.
const SIGMA_M: f64 = 0.85;
/// Number of alternative points on the circle.
const POINTS: usize = 16;
/// Number of alternative headings: −π and π are one.
const HEADINGS: usize = 8;
/// Weight of a node right behind a person, so that a person who sees no other node still has a distance.
const BEHIND: f64 = 1e-6;
/// Ranges smaller than this judge nothing, metres.
const SAME_M: f64 = 1e-3;
/// Fit of a step that is neither towards a goal nor away from it.
const NEUTRAL: f64 = 0.5;
/// A shorter move is a turn on the spot, metres.
const ON_THE_SPOT_M: f64 = 0.05;

/// For each goal, how well the step from one point to a pose fits: 1 towards it, 0 away from it. Without a heading,
/// only positions are compared.
pub(super) fn validate(
    distances: &Distances,
    goals: &[GoalId],
    from: Point,
    to: Point,
    heading: Option<f64>,
) -> Vec<f64> {
    let reached = Association::at(distances, to);
    let walked = (to - from).norm();
    let mut alternatives: Vec<Vec<Option<f64>>> = Vec::new();
    let is_free = |p: &Point| distances.walkways().is_none_or(|w| w.is_free(*p));
    for point in around(from, walked).into_iter().filter(is_free) {
        let association = Association::at(distances, point);
        match heading {
            None => alternatives.push(association.distances(distances, goals, None)),
            Some(_) => alternatives
                .extend((0..HEADINGS).map(|k| {
                    association.distances(distances, goals, Some(TAU * k as f64 / HEADINGS as f64))
                })),
        }
    }
    let reached = reached.distances(distances, goals, heading);
    (0..goals.len())
        .map(|g| {
            let Some(distance) = reached[g] else { return 0.0 };
            let others = alternatives.iter().filter_map(|row| row[g]);
            let (low, high) =
                others.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
            if high - low < SAME_M { NEUTRAL } else { ((high - distance) / (high - low)).clamp(0.0, 1.0) }
        })
        .collect()
}

/// The places to which a person could have gone instead; for a turn on the spot, the present place.
fn around(from: Point, walked: f64) -> Vec<Point> {
    if walked < ON_THE_SPOT_M {
        return vec![from];
    }
    let point = |k: usize| {
        let a = TAU * k as f64 / POINTS as f64;
        Point::new(from.x + walked * a.cos(), from.y + walked * a.sin())
    };
    (0..POINTS).map(point).collect()
}

/// The nodes in sight of a place: weight by distance, and bearing (eq. 3.11).
struct Association {
    nodes: Vec<(giveway_floor::id::WalkNodeId, f64, f64)>,
    /// The place itself in the open, where goals are in sight directly.
    open: Option<Point>,
}

impl Association {
    fn at(distances: &Distances, p: Point) -> Association {
        let Some(walkways) = distances.walkways() else {
            return Association { nodes: Vec::new(), open: Some(p) };
        };
        let nodes = walkways.nodes();
        let seen = distances.from(p);
        let weigh = |away: f64| (-away * away / (2.0 * SIGMA_M * SIGMA_M)).exp();
        let bearing = |at: Point| Segment { a: p, b: at }.heading();
        let steps = seen.steps().iter();
        let nodes = steps.map(|(n, away)| (*n, weigh(*away), bearing(nodes[*n].at))).collect();
        Association { nodes, open: None }
    }

    /// The modulated distances of eq. 3.14, with weights normalised over the nodes from which the goal can be reached.
    fn distances(&self, distances: &Distances, goals: &[GoalId], heading: Option<f64>) -> Vec<Option<f64>> {
        if let Some(at) = self.open {
            return goals.iter().map(|g| distances.to_goal(*g, at)).collect();
        }
        // Eq. 3.12.
        let facing = |bearing: f64| match heading {
            Some(h) => (PI - turn_between(h, bearing)) / (PI * PI) + BEHIND,
            None => 1.0,
        };
        let to_goal = |goal: &GoalId| {
            let (mut sum, mut total) = (0.0, 0.0);
            for (n, weight, bearing) in &self.nodes {
                if let Some(metres) = distances.from_node(*n, *goal) {
                    let c = weight * facing(*bearing);
                    sum += c * metres;
                    total += c;
                }
            }
            (total > 0.0).then(|| sum / total)
        };
        goals.iter().map(to_goal).collect()
    }
}

//! Choice among given trajectories by their risk (Liu and Jebelli 2023, algorithm 2).
//!
//! Main types: [`Choice`]. Refuses: to make trajectories, and to prefer one that finishes sooner over one that is
//! nearer.

use super::kinematics::{Joints, joint_distance};

/// What the arm should do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Continue with the planned trajectory.
    Planned,
    /// Switch to the trajectory of the set with this index.
    Other(usize),
    /// Stand: all trajectories are too risky.
    Stand,
}

/// Keeps the planned trajectory if its risk is at most `delta` at each step; otherwise takes, among the trajectories of
/// the set whose risk is at most `delta`, the shortest one from the present configuration. `risk` gives the probability
/// of an overlap at these angles at a step, counted from 0.
pub fn choose(
    present: &Joints,
    planned: &[Joints],
    set: &[Vec<Joints>],
    delta: f64,
    mut risk: impl FnMut(&Joints, usize) -> f64,
) -> Choice {
    let mut is_free = |way: &[Joints]| way.iter().enumerate().all(|(step, q)| risk(q, step) <= delta);
    if is_free(planned) {
        return Choice::Planned;
    }
    let free = set.iter().enumerate().filter(|(_, way)| !way.is_empty() && is_free(way));
    let length = |way: &[Joints]| {
        let first = joint_distance(present, &way[0]);
        first + way.windows(2).map(|pair| joint_distance(&pair[0], &pair[1])).sum::<f64>()
    };
    let shortest = free.map(|(k, way)| (k, length(way))).min_by(|a, b| a.1.total_cmp(&b.1));
    shortest.map_or(Choice::Stand, |(k, _)| Choice::Other(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trajectory with the first axis at these angles.
    fn way(angles: &[f64]) -> Vec<Joints> {
        angles.iter().map(|a| [*a, 0.0, 0.0, 0.0, 0.0, 0.0]).collect()
    }

    #[test]
    fn the_planned_one_is_kept_up_to_the_threshold_and_the_nearest_free_one_is_taken_above_it() {
        let planned = way(&[0.1, 0.2]);
        let set = [way(&[0.9, 1.8]), way(&[0.2, 0.3]), way(&[-0.3, -0.6])];
        // Positive angles up to 0.5 are dangerous at the second step.
        let risk = |q: &Joints, step: usize| if step == 1 && (0.0..0.5).contains(&q[0]) { 0.05 } else { 0.0 };
        assert_eq!(choose(&[0.0; 6], &planned, &set, 0.05, risk), Choice::Planned);
        assert_eq!(choose(&[0.0; 6], &planned, &set, 0.04, risk), Choice::Other(2));
        assert_eq!(choose(&[0.0; 6], &planned, &set[1..2], 0.04, risk), Choice::Stand);
    }
}

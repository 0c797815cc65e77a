//! An object that appears, disappears and reappears while a person is on the way to it (thesis, Figure 5.8).
//!
//! Main types: [`ChangeTrace`], [`ChangeFigures`]; main function: [`changed_goal`]. Corrected: a new object replays its
//! own last frames instead of taking over the state of a neighbour. Refuses: nets for a fixed number of objects.

use super::body::{FRAMES, ObjectMove};
use super::nets::{ObjectNet, ObjectWatch};
use super::score::best_of;

/// Frames in which the right object appears, disappears and reappears.
pub const CHANGES: [usize; 3] = [100, 180, 220];
/// Probabilities that differ by less than this agree.
const AGREES: f64 = 0.05;

/// Probabilities of the right object in every frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangeTrace {
    /// Probabilities if all objects are there from the beginning.
    pub unchanged: Vec<f64>,
    /// Probabilities if the right object appears at 100, disappears at 180 and reappears at 220; nothing while it is
    /// away.
    pub changed: Vec<Option<f64>>,
    /// Frames in which the right object is there and the most probable.
    pub is_first: Vec<bool>,
}

/// Figures over many movements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChangeFigures {
    /// Number of movements.
    pub movements: usize,
    /// Share in which the right object is the most probable in the last frame, all objects there from the beginning.
    pub first_at_end: f64,
    /// The share of `first_at_end` with the changes.
    pub first_at_end_changed: f64,
    /// Mean number of frames after the object's first and second appearance until its probability agrees within 0.05
    /// with that without changes.
    pub agrees_after: [f64; 2],
}

/// Runs a net over a movement with and without the changes; nothing if the net cannot drop an object.
pub fn changed_goal(net: &ObjectNet, m: &ObjectMove) -> Option<ChangeTrace> {
    let others: Vec<_> = (0..m.objects.len()).filter(|i| *i != m.right).map(|i| m.objects[i]).collect();
    let mut whole = ObjectWatch::new(net, &m.objects);
    let mut partial = ObjectWatch::new(net, &others);
    let mut trace = ChangeTrace { unchanged: Vec::new(), changed: Vec::new(), is_first: Vec::new() };
    for (k, frame) in m.frames.iter().enumerate() {
        let is_done = match CHANGES.iter().position(|c| *c == k) {
            Some(1) => partial.remove(others.len()),
            Some(_) => partial.add(m.objects[m.right]),
            None => true,
        };
        if !is_done {
            return None;
        }
        whole.observe(frame);
        partial.observe(frame);
        trace.unchanged.push(whole.probabilities()[m.right]);
        let p = partial.probabilities();
        trace.is_first.push(best_of(&p) == others.len());
        trace.changed.push(p.get(others.len()).copied());
    }
    Some(trace)
}

impl ChangeTrace {
    /// Number of frames from `change` until the object's probability is as without changes.
    fn agrees_after(&self, change: usize) -> usize {
        let agrees = |k: &usize| self.changed[*k].is_some_and(|p| (p - self.unchanged[*k]).abs() < AGREES);
        (change..FRAMES).find(agrees).unwrap_or(FRAMES) - change
    }
}

impl ChangeFigures {
    /// Figures from movements that the net did not learn from.
    pub fn of(net: &ObjectNet, moves: &[&ObjectMove]) -> ChangeFigures {
        let traces: Vec<(ChangeTrace, bool)> = (moves.iter())
            .filter_map(|m| {
                let last = best_of(net.probabilities(m).last()?) == m.right;
                Some((changed_goal(net, m)?, last))
            })
            .collect();
        let count = traces.len().max(1) as f64;
        let share = |of: &dyn Fn(&(ChangeTrace, bool)) -> f64| traces.iter().map(of).sum::<f64>() / count;
        ChangeFigures {
            movements: traces.len(),
            first_at_end: share(&|t| f64::from(u8::from(t.1))),
            first_at_end_changed: share(&|t| f64::from(u8::from(t.0.is_first[FRAMES - 1]))),
            agrees_after: [0, 2].map(|c| share(&|t| t.0.agrees_after(CHANGES[c]) as f64)),
        }
    }
}

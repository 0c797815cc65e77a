//! Hidden Markov models over goals.
//!
//! Main type: [`IntentBelief`] (forward filter and most probable sequence side by side). The published text calls the
//! scores of Viterbi's algorithm probabilities; they are not (the maximum keeps one past per state), so here posteriors
//! come from sums and the sequence from maxima (`sequence.rs`). Refuses: to know what is observed.

use super::Belief;
use super::sequence::{IntentSequence, IntentState};
use giveway_floor::id::GoalId;
use giveway_floor::time::Time;

/// Least emission: no observation makes a state impossible, so that one odd step cannot rule out a goal for ever.
const FLOOR: f64 = 1e-6;

/// The present belief of the chain.
#[derive(Clone, Debug)]
pub(super) struct IntentBelief {
    states: Vec<IntentState>,
    probability: Vec<f64>,
    sequence: IntentSequence,
}

impl IntentBelief {
    /// A chain with these states (sorted) and probabilities.
    pub fn new(states: Vec<IntentState>, probability: Vec<f64>) -> IntentBelief {
        let sequence = IntentSequence::new(states.clone(), &probability, FLOOR);
        IntentBelief { states, probability, sequence }
    }

    /// The chain of chapter 3 without goals: *undecided* is certain (eq. 3.19).
    pub fn undecided() -> IntentBelief {
        IntentBelief::new(vec![IntentState::Undecided, IntentState::Elsewhere], vec![1.0, 0.0])
    }

    pub fn states(&self) -> &[IntentState] {
        &self.states
    }

    pub fn goals(&self) -> impl Iterator<Item = GoalId> {
        self.states.iter().filter_map(|s| if let IntentState::Goal(g) = s { Some(*g) } else { None })
    }

    fn index(&self, state: IntentState) -> Option<usize> {
        self.states.binary_search(&state).ok()
    }

    /// One update: `transition(from, to)`, and one emission per state. Neither needs to sum to one.
    pub fn update(
        &mut self,
        transition: impl Fn(IntentState, IntentState) -> f64,
        emission: &[f64],
        seen: Time,
    ) {
        let n = self.states.len();
        let total: f64 = emission.iter().map(|e| e.max(0.0)).sum();
        let emit = |i: usize| (emission[i].max(0.0) / total.max(FLOOR)).max(FLOOR);
        let step = |from: usize, to: usize| transition(self.states[from], self.states[to]);
        let mut next: Vec<f64> = (0..n)
            .map(|to| emit(to) * (0..n).map(|from| self.probability[from] * step(from, to)).sum::<f64>())
            .collect();
        normalise(&mut next);
        self.sequence.update(seen, &transition, |i| emit(i).ln());
        self.probability = next;
    }

    /// Adds a goal with a share of the probability: the smallest that any goal has, but at least 0.1.
    pub fn add_goal(&mut self, goal: GoalId) {
        let state = IntentState::Goal(goal);
        let Err(at) = self.states.binary_search(&state) else { return };
        let least =
            self.goals().filter_map(|g| self.index(IntentState::Goal(g))).map(|i| self.probability[i]);
        let share = least.fold(f64::INFINITY, f64::min);
        let share = if share.is_finite() { share.max(0.1) } else { 0.1 };
        self.states.insert(at, state);
        self.probability.insert(at, share);
        self.sequence.add(state, share);
        normalise(&mut self.probability);
    }

    /// Removes a goal; its probability goes to `heir`, or to all others if that is no state.
    pub fn remove_goal(&mut self, goal: GoalId, heir: IntentState) {
        let Some(at) = self.index(IntentState::Goal(goal)) else { return };
        self.states.remove(at);
        self.sequence.remove(IntentState::Goal(goal));
        let share = self.probability.remove(at);
        if let Some(heir) = self.index(heir) {
            self.probability[heir] += share;
        }
        normalise(&mut self.probability);
    }

    pub fn belief(&self) -> Belief {
        let of = |state: IntentState| self.index(state).map_or(0.0, |i| self.probability[i]);
        Belief {
            goals: self.goals().map(|g| (g, of(IntentState::Goal(g)))).collect(),
            undecided: of(IntentState::Undecided),
            elsewhere: of(IntentState::Elsewhere),
        }
    }

    /// The most probable sequence that accompanies the probabilities.
    pub fn sequence(&self) -> &IntentSequence {
        &self.sequence
    }
}

fn normalise(p: &mut [f64]) {
    let total: f64 = p.iter().sum();
    let n = p.len() as f64;
    p.iter_mut().for_each(|x| *x = if total > 0.0 { *x / total } else { 1.0 / n });
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: IntentState = IntentState::Goal(GoalId(1));
    const B: IntentState = IntentState::Goal(GoalId(2));

    #[test]
    fn the_filter_and_the_sequence_are_those_of_the_textbook() {
        // Fever or healthy, in the well-known example: two states, three observations.
        let mut chain = IntentBelief::new(vec![A, B], vec![0.6, 0.4]);
        let hold = |from: IntentState, to: IntentState| match (from, to) {
            (A, A) => 0.7,
            (A, _) => 0.3,
            (B, A) => 0.4,
            _ => 0.6,
        };
        // The first observation acts on the prior itself.
        let still = |from: IntentState, to: IntentState| if from == to { 1.0 } else { 0.0 };
        chain.update(still, &[0.5, 0.1], Time(1));
        chain.update(hold, &[0.4, 0.3], Time(2));
        chain.update(hold, &[0.1, 0.6], Time(3));
        assert_eq!(chain.sequence().states()[1..], [A, A, B]);
        // By hand: .30/.04 → .0904/.0342 → .007696/.028584, to be normalised.
        let p = chain.belief().goals[0].1;
        assert!((p - 0.007696 / (0.007696 + 0.028584)).abs() < 1e-9, "{p}");
    }

    #[test]
    fn goals_come_with_a_tenth_and_leave_theirs_behind() {
        let mut chain =
            IntentBelief::new(vec![A, IntentState::Undecided, IntentState::Elsewhere], vec![0.5, 0.4, 0.1]);
        chain.add_goal(GoalId(2));
        let belief = chain.belief();
        assert!(
            (belief.goals[1].1 - 0.5 / 1.5).abs() < 1e-12,
            "the least of the goals has more than a tenth"
        );
        chain.remove_goal(GoalId(1), IntentState::Undecided);
        let belief = chain.belief();
        assert_eq!(belief.goals.len(), 1);
        assert!((belief.undecided - 0.9 / 1.5).abs() < 1e-12);
        assert!((belief.sum() - 1.0).abs() < 1e-12);
        chain.update(|_, _| 0.25, &[0.0, 0.0, 0.0], Time(1));
        assert!((chain.belief().sum() - 1.0).abs() < 1e-12, "an impossible observation says nothing");
    }
}

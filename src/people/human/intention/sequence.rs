//! The most probable sequence of states of a hidden Markov model (Viterbi 1967).
//!
//! Main types: [`IntentSequence`], [`IntentEpisode`] (a stretch of it), [`IntentState`]. Its scores are not
//! probabilities of states, since the maximum keeps one past for each of them: posteriors come from a forward filter
//! beside it. Refuses: to know what is observed.

use giveway_floor::id::GoalId;
use giveway_floor::time::Time;
use std::collections::VecDeque;

/// Number of updates that are kept: about a hundred metres of walking.
const MEMORY: usize = 256;
/// Least probability of a transition, so that its logarithm is finite.
const LEAST: f64 = 1e-12;

/// What a person may intend (Petković 2021, table 3.1), in the order of the chain's rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum IntentState {
    /// On the way to this goal.
    Goal(GoalId),
    /// On the way to one of several goals; written G? in the thesis.
    Undecided,
    /// On the way to none of the goals, or nowhere; written Gx in the thesis.
    Elsewhere,
}

/// A stretch of the most probable sequence with one state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntentEpisode {
    /// The person's state.
    pub state: IntentState,
    /// Time of the first update with this state.
    pub since: Time,
}

/// The best sequence to each state.
#[derive(Clone, Debug)]
pub(super) struct IntentSequence {
    states: Vec<IntentState>,
    /// Log-probability of the best sequence that ends in each state, up to a constant.
    best: Vec<f64>,
    /// Time of each update, and for each state the best state before it.
    past: VecDeque<(Time, Vec<(IntentState, IntentState)>)>,
}

impl IntentSequence {
    /// A sequence with these states (sorted) and their prior probabilities.
    pub fn new(states: Vec<IntentState>, probability: &[f64], least: f64) -> IntentSequence {
        let best = probability.iter().map(|p| p.max(least).ln()).collect();
        IntentSequence { states, best, past: VecDeque::new() }
    }

    /// One update: `transition(from, to)`, and the logarithm of one emission per state.
    pub fn update(
        &mut self,
        seen: Time,
        transition: impl Fn(IntentState, IntentState) -> f64,
        emission_ln: impl Fn(usize) -> f64,
    ) {
        let n = self.states.len();
        let (mut best, mut before) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for to in 0..n {
            let step = |from: usize| transition(self.states[from], self.states[to]).max(LEAST).ln();
            let via = (0..n).map(|from| (self.best[from] + step(from), from));
            let (score, from) =
                via.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))).expect("a chain has states");
            best.push(score + emission_ln(to));
            before.push((self.states[to], self.states[from]));
        }
        let highest = best.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        best.iter_mut().for_each(|b| *b -= highest);
        self.best = best;
        self.past.push_back((seen, before));
        if self.past.len() > MEMORY {
            self.past.pop_front();
        }
    }

    /// Adds a state. Its past is that of the most probable state now.
    pub fn add(&mut self, state: IntentState, share: f64) {
        let Err(at) = self.states.binary_search(&state) else { return };
        let now = self.last();
        if let (Some(now), Some((_, before))) = (now, self.past.back_mut())
            && let Some((_, from)) = before.iter().find(|(to, _)| *to == now).copied()
        {
            before.push((state, from));
        }
        self.states.insert(at, state);
        self.best.insert(at, share.max(LEAST).ln());
    }

    /// Removes a state. Sequences that led through it stay.
    pub fn remove(&mut self, state: IntentState) {
        if let Ok(at) = self.states.binary_search(&state) {
            self.states.remove(at);
            self.best.remove(at);
        }
    }

    /// The state in which the best sequence ends; the first of equals.
    fn last(&self) -> Option<IntentState> {
        let all = 0..self.states.len();
        let best = all.reduce(|a, b| if self.best[b] > self.best[a] { b } else { a });
        best.map(|i| self.states[i])
    }

    /// The states of the best sequence, oldest first: one before the first update, and one for each update.
    pub fn states(&self) -> Vec<IntentState> {
        let Some(mut state) = self.last() else { return Vec::new() };
        let mut out = vec![state];
        for (_, before) in self.past.iter().rev() {
            // Every update has some state, but one that came back may not have been known then.
            let Some((_, from)) = before.iter().find(|(to, _)| *to == state) else { break };
            state = *from;
            out.push(state);
        }
        out.reverse();
        out
    }

    /// The best sequence as stretches of one state, oldest first; empty before the first update.
    pub fn episodes(&self) -> Vec<IntentEpisode> {
        let states = self.states();
        let known = states.len().saturating_sub(1).min(self.past.len());
        let updates = self.past.iter().skip(self.past.len() - known);
        let mut episodes: Vec<IntentEpisode> = Vec::new();
        for ((since, _), state) in updates.zip(states.into_iter().skip(1)) {
            if episodes.last().is_none_or(|e| e.state != state) {
                episodes.push(IntentEpisode { state, since: *since });
            }
        }
        episodes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random-looking figures that are the same every time.
    fn figures(mut seed: u64) -> impl FnMut() -> f64 {
        move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 33) as f64 / (1_u64 << 31) as f64).max(1e-3)
        }
    }

    fn states() -> Vec<IntentState> {
        vec![
            IntentState::Goal(GoalId(1)),
            IntentState::Goal(GoalId(2)),
            IntentState::Undecided,
            IntentState::Elsewhere,
        ]
    }

    /// The best of all sequences, by trying every one of them.
    fn by_force(prior: &[f64], steps: &[[[f64; 4]; 4]], emissions: &[[f64; 4]]) -> Vec<usize> {
        let length = steps.len() + 1;
        let all = (0..4_usize.pow(length as u32))
            .map(|code| (0..length).map(|t| code / 4_usize.pow(t as u32) % 4).collect::<Vec<usize>>());
        let score = |s: &Vec<usize>| {
            let moves = (1..length).map(|t| steps[t - 1][s[t - 1]][s[t]].ln() + emissions[t - 1][s[t]].ln());
            prior[s[0]].ln() + moves.sum::<f64>()
        };
        all.max_by(|a, b| score(a).total_cmp(&score(b))).expect("there are sequences")
    }

    #[test]
    fn it_is_the_best_of_all_sequences() {
        let mut distinct = std::collections::BTreeSet::new();
        for seed in 0..60 {
            let mut draw = figures(seed);
            let prior: [f64; 4] = std::array::from_fn(|_| draw());
            let updates = 1 + seed as usize % 5;
            let steps: Vec<[[f64; 4]; 4]> =
                (0..updates).map(|_| std::array::from_fn(|_| std::array::from_fn(|_| draw()))).collect();
            let emissions: Vec<[f64; 4]> = (0..updates).map(|_| std::array::from_fn(|_| draw())).collect();
            let mut sequence = IntentSequence::new(states(), &prior, 1e-6);
            for (t, (step, emission)) in steps.iter().zip(&emissions).enumerate() {
                let ix = |s| states().binary_search(&s).expect("a state");
                let between = |from, to| step[ix(from)][ix(to)];
                sequence.update(Time(t as i64), between, |i| emission[i].ln());
            }
            let best: Vec<IntentState> =
                by_force(&prior, &steps, &emissions).into_iter().map(|i| states()[i]).collect();
            assert_eq!(sequence.states(), best, "seed {seed}");
            distinct.extend(best.windows(2).map(|w| (w[0], w[1])));
        }
        assert!(distinct.len() > 10, "the sequences change their state in many ways: {}", distinct.len());
    }

    #[test]
    fn stretches_of_one_state_begin_with_the_update_that_changed_it() {
        let all = states();
        let mut sequence = IntentSequence::new(all.clone(), &[0.25; 4], 1e-6);
        let stays = |from, to| if from == to { 0.9 } else { 0.1 / 3.0 };
        for (t, likely) in [0, 0, 0, 1, 1, 1].into_iter().enumerate() {
            sequence.update(Time(10 * t as i64), stays, |i| if i == likely { 0.0 } else { -5.0 });
        }
        let episode = |state, since| IntentEpisode { state, since: Time(since) };
        assert_eq!(sequence.episodes(), [episode(all[0], 0), episode(all[1], 30)]);
        // A removed goal stays in the sequence that led through it, and a new one takes over from the best state.
        sequence.remove(all[1]);
        sequence.add(IntentState::Goal(GoalId(7)), 0.3);
        sequence.update(Time(60), stays, |i| if i == 1 { 0.0 } else { -9.0 });
        let last = sequence.episodes();
        assert_eq!(last[0], episode(all[0], 0));
        assert_eq!(last.last().map(|e| e.state), Some(IntentState::Goal(GoalId(7))), "{last:?}");
    }

    #[test]
    fn it_forgets_what_is_long_past_and_nothing_is_wrong_then() {
        let mut sequence = IntentSequence::new(states(), &[0.25; 4], 1e-6);
        let stays = |from, to| if from == to { 0.9 } else { 0.1 / 3.0 };
        for t in 0..3 * MEMORY as i64 {
            sequence.update(Time(t), stays, |i| if i == 2 { 0.0 } else { -1.0 });
        }
        assert_eq!(sequence.states(), vec![IntentState::Undecided; MEMORY + 1]);
        assert_eq!(sequence.episodes().len(), 1);
    }
}

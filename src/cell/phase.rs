//! How far a hand is with a piece, and how long each phase of it takes.
//!
//! Main types: [`PickPhase`], [`PiecePhases`] (the piece that is picked now), [`PhasePace`] (what was learned). Means
//! are learned for each station and drawn towards those of all stations while little is known of it. Kept in memory
//! only, and of stations, not of people. Refuses: to learn from phases that were not seen from beginning to end.

use super::pace::{PickSums, rest_of};
use giveway_floor::id::StationId;
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// What a hand does with a piece, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PickPhase {
    /// No hand is on its way yet.
    Search,
    /// A hand moves towards the rack.
    Reach,
    /// A hand is in a slot.
    Grasp,
    /// A hand holds the piece, and brings it to a tote.
    Carry,
    /// The hand with the piece is in a tote, and has not put it down yet.
    Place,
}

impl PickPhase {
    /// All phases, in order.
    pub const ALL: [PickPhase; 5] =
        [PickPhase::Search, PickPhase::Reach, PickPhase::Grasp, PickPhase::Carry, PickPhase::Place];
}

/// Times of the phases before anything is learned, seconds.
const USUAL_S: [f64; 5] = [0.5, 0.6, 0.9, 0.8, 0.1];
/// Spread of their logarithms before anything is learned, and the number of phases that it counts for.
const SPREAD: f64 = 0.6;
const SPREAD_PHASES: f64 = 10.0;
/// Number of phases that the starting value counts for, and that the value of all stations counts for at one of them.
const START_PHASES: f64 = 5.0;
const CREW_PHASES: f64 = 8.0;
/// Factor from the expected time beyond which a phase is a break, and is not learned from.
const FARTHEST: f64 = 12.0;
/// Observations farther apart than this leave a gap.
const GAP: Span = Span::from_millis(450);

/// The phases of the piece that is picked now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecePhases {
    phase: PickPhase,
    since: Time,
    seen: Time,
    /// Whether the present phase was seen from its beginning, without a gap.
    is_whole: bool,
}

/// A phase that is over, and how long it took, seconds.
pub type SpentPhase = (PickPhase, f64);

impl PiecePhases {
    /// The phases of a piece that is wanted and not seen yet.
    pub fn begin(phase: PickPhase, now: Time) -> PiecePhases {
        PiecePhases { phase, since: now, seen: now, is_whole: phase == PickPhase::Search }
    }

    /// The present phase and its time so far, seconds; nothing if no hand was seen recently.
    pub fn now(&self, now: Time) -> Option<(PickPhase, f64)> {
        (now - self.seen < GAP).then(|| (self.phase, (now - self.since).as_secs_f64().max(0.0)))
    }

    /// Notes the phase in which a hand is seen. Gives the phase that is over.
    pub fn see(&mut self, phase: PickPhase, seen: Time) -> Option<SpentPhase> {
        let gap = seen - self.seen > GAP;
        self.seen = seen;
        if gap {
            (self.phase, self.since, self.is_whole) = (phase, seen, false);
            return None;
        }
        if phase == self.phase {
            return None;
        }
        let spent = (self.phase, (seen - self.since).as_secs_f64());
        // A hand that turns back has not ended a phase, unless it has put the piece down.
        let has_put = self.phase >= PickPhase::Carry && phase < PickPhase::Carry;
        let goes_on = phase > self.phase || has_put;
        let is_over = self.is_whole && goes_on;
        (self.phase, self.since, self.is_whole) = (phase, seen, goes_on);
        is_over.then_some(spent)
    }
}

/// What is known of how long phases take.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhasePace {
    crew: [PickSums; 5],
    residuals: [PickSums; 5],
    stations: BTreeMap<StationId, [PickSums; 5]>,
}

impl PhasePace {
    /// Learns the times of phases at a station.
    pub fn learn(&mut self, station: StationId, spent: &[SpentPhase]) {
        for (phase, seconds) in spent {
            let k = *phase as usize;
            let factor = seconds / USUAL_S[k];
            if factor <= 0.0 || !(1.0 / FARTHEST..FARTHEST).contains(&factor) {
                continue;
            }
            let log = libm::log(factor);
            let off = log - self.middle(station, k);
            self.residuals[k].note(off);
            self.crew[k].note(log);
            self.stations.entry(station).or_default()[k].note(log);
        }
    }

    fn middle(&self, station: StationId, k: usize) -> f64 {
        let crew = self.crew[k].logs / (START_PHASES + self.crew[k].lines);
        let own = self.stations.get(&station).map(|all| all[k]).unwrap_or_default();
        (CREW_PHASES * crew + own.logs) / (CREW_PHASES + own.lines)
    }

    fn spread(&self, k: usize) -> f64 {
        let PickSums { lines, squares, .. } = self.residuals[k];
        ((SPREAD * SPREAD * SPREAD_PHASES + squares) / (SPREAD_PHASES + lines)).sqrt()
    }

    /// Mean and variance of the time of the phases from `from` until `to` is over, together, seconds; `from` has taken
    /// `spent_s` so far.
    pub fn rest(&self, station: StationId, (from, spent_s): (PickPhase, f64), to: PickPhase) -> (f64, f64) {
        let all = PickPhase::ALL.into_iter().filter(|p| *p >= from && *p <= to);
        all.fold((0.0, 0.0), |(mean, variance), phase| {
            let (k, spread) = (phase as usize, self.spread(phase as usize));
            let whole_s = USUAL_S[k] * libm::exp(self.middle(station, k) + spread * spread / 2.0);
            let spent_s = if phase == from { spent_s } else { 0.0 };
            let (m, v) = rest_of(whole_s, spread, spent_s);
            (mean + m, variance + v)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: StationId = StationId(0);

    fn at(ms: i64) -> Time {
        Time(ms * 1_000)
    }

    /// Follows phases with these durations in milliseconds, seen every 50 ms; gives the ended phases and the last
    /// state.
    fn followed(all: &[(PickPhase, i64)]) -> (Vec<SpentPhase>, PiecePhases) {
        let mut piece = PiecePhases::begin(PickPhase::Search, at(0));
        let (mut now, mut spent) = (0, Vec::new());
        for (phase, ms) in all {
            for _ in 0..ms / 50 {
                now += 50;
                spent.extend(piece.see(*phase, at(now)));
            }
        }
        (spent, piece)
    }

    use PickPhase::{Carry, Grasp, Place, Reach, Search};

    #[test]
    fn each_phase_of_a_piece_is_told_of_once_it_is_over_with_how_long_it_took() {
        let (spent, piece) =
            followed(&[(Search, 500), (Reach, 600), (Grasp, 900), (Carry, 600), (Place, 100), (Search, 100)]);
        let phases: Vec<PickPhase> = spent.iter().map(|(p, _)| *p).collect();
        assert_eq!(phases, PickPhase::ALL);
        let off = spent.iter().zip([0.55, 0.6, 0.9, 0.6, 0.1]).map(|((_, s), true_s)| (s - true_s).abs());
        assert!(off.fold(0.0, f64::max) < 0.051, "{spent:?}");
        assert_eq!(piece.now(at(2_900)), Some((Search, 0.15)));
        assert_eq!(piece.now(at(4_000)), None, "it was not seen of late");
    }

    #[test]
    fn a_hand_that_passes_over_a_tote_with_its_piece_has_not_put_it_down() {
        let (spent, _) =
            followed(&[(Search, 500), (Reach, 600), (Grasp, 900), (Carry, 300), (Place, 50), (Carry, 300)]);
        assert!(spent.iter().all(|(phase, _)| *phase != Place), "{spent:?}");
    }

    #[test]
    fn nothing_is_learned_of_a_hand_that_turns_back_or_was_not_seen() {
        let (spent, _) = followed(&[(Search, 300), (Reach, 200), (Search, 300), (Reach, 200)]);
        assert_eq!(
            spent.iter().map(|(p, _)| *p).collect::<Vec<_>>(),
            [Search],
            "the second search began before"
        );
        let mut piece = PiecePhases::begin(Search, at(0));
        assert_eq!(piece.see(Grasp, at(900)), None, "it may have searched and reached meanwhile");
        assert_eq!(piece.see(Carry, at(1_000)), None, "nobody knows when the grasp began");
        assert!(piece.see(Search, at(1_300)).is_some());
    }

    #[test]
    fn the_rest_shrinks_from_phase_to_phase_and_a_slow_station_is_learned() {
        let mut pace = PhasePace::default();
        let rest = |pace: &PhasePace, from| pace.rest(S, (from, 0.0), Place).0;
        let all = PickPhase::ALL.map(|phase| rest(&pace, phase));
        assert!(all[..4].windows(2).all(|pair| pair[0] > pair[1] + 0.3), "{all:?}");
        assert!(
            pace.rest(S, (Reach, 0.0), Grasp).0 < rest(&pace, Reach),
            "the hand is out before it has placed"
        );
        let (early, late) = (pace.rest(S, (Grasp, 0.1), Grasp).0, pace.rest(S, (Grasp, 0.7), Grasp).0);
        assert!(late < early, "{late} after {early}");
        (0..60).for_each(|_| pace.learn(S, &[(Grasp, 3.0)]));
        assert!((pace.rest(S, (Grasp, 0.0), Grasp).0 - 3.0).abs() < 0.4);
        assert!(pace.rest(StationId(1), (Grasp, 0.0), Grasp).0 > 1.5, "others are taken for the crew's");
        let before = pace.clone();
        pace.learn(S, &[(Grasp, 90.0)]);
        assert_eq!(pace, before, "that was a break");
    }
}

//! How long the rest of a visit takes, from how long earlier lines took.
//!
//! Main types: [`PickPace`] (what was learned), [`Remaining`] (a distribution). A line takes a time for the first piece
//! and one for each further piece, times a factor with a lognormal spread; the factor's middle is learned for each
//! station and drawn towards that of all stations while little is known of it. Kept in memory only, and of stations,
//! not of people. Refuses: to know why a line takes long.

use super::phase::{PhasePace, PickPhase, SpentPhase};
use super::{LineProgress, LineState, Lines};
use giveway_floor::id::StationId;
use std::collections::BTreeMap;

/// Times before anything is learned: for the first piece of a line and for each further one, seconds.
const FIRST_S: f64 = 3.5;
const FURTHER_S: f64 = 2.4;
/// Spread of the factor before anything is learned, and the number of lines that it counts for.
const SPREAD: f64 = 0.45;
const SPREAD_LINES: f64 = 10.0;
/// Number of lines that the starting value counts for, and that the value of all stations counts for at one of them.
const START_LINES: f64 = 5.0;
const CREW_LINES: f64 = 8.0;
/// Largest deviation that a line counts with, in spreads.
const FARTHEST: f64 = 1.8;
/// Weight of a line relative to the one after it: older lines count less.
const KEPT: f64 = 0.99;
/// A factor beyond this is a break, not a pick.
const SLOWEST: f64 = 12.0;
/// Share of its time so far that a line taking longer than any is expected to take in addition.
const OVERDUE: f64 = 0.25;
/// Least time until anything ends, seconds.
const AT_LEAST_S: f64 = 0.3;
/// Time of a robot arm for a piece before anything is learned, seconds, and the weight of each new piece.
const ARM_PIECE_S: f64 = 9.0;
const ARM_SHARE: f64 = 0.1;
/// Quantiles of the standard normal distribution at the middle of each sixteenth.
const NORMALS: [f64; 16] = [
    -1.8627, -1.3180, -1.0100, -0.7764, -0.5791, -0.4023, -0.2372, -0.0784, 0.0784, 0.2372, 0.4023, 0.5791,
    0.7764, 1.0100, 1.3180, 1.8627,
];
/// The 90 % quantile of the standard normal distribution.
const NINETIETH: f64 = 1.2816;

/// How much each end of a visit widens or narrows the spread of ends, as a logarithm, and the limit of the total.
const WIDENS: f64 = 0.02;
const WIDEST: f64 = 1.0;
/// Wanted share of ends between the 10 % and the 90 % quantile.
const BETWEEN: f64 = 0.8;

/// Sums over lines or phases, the newest counting most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PickSums {
    pub lines: f64,
    pub logs: f64,
    pub squares: f64,
}

/// What is known of how long lines take.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PickPace {
    crew: PickSums,
    /// Deviations of lines from what was expected of their station.
    residuals: PickSums,
    stations: BTreeMap<StationId, PickSums>,
    /// How much wider ends of visits are spread than lines and phases suggest, as a logarithm.
    wider: f64,
    /// Time of each station's robot arm for a piece, seconds.
    arms: BTreeMap<StationId, f64>,
    /// Times of the phases of a piece.
    phases: PhasePace,
}

/// What is seen of the present visit, and known of its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct VisitSeen {
    /// Time since the last piece of the lit line, or since it was lit, seconds.
    pub lit_s: f64,
    /// The customer's estimate of the whole visit, seconds.
    pub said_s: Option<f64>,
    /// What a hand does with the piece of the lit line, and for how long, seconds; nothing if no hand is seen.
    pub piece: Option<(PickPhase, f64)>,
    /// Whether the visit ends when the hand is out for the last time, not when the last piece is in its tote.
    pub ends_out: bool,
}

/// How long a visit will last from now on, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remaining {
    /// Mean, seconds.
    pub mean_s: f64,
    /// Time before which one visit in ten ends, seconds.
    pub p10_s: f64,
    /// Time before which half the visits end, seconds.
    pub p50_s: f64,
    /// Time before which nine visits in ten end, seconds.
    pub p90_s: f64,
}

impl PickSums {
    pub fn note(&mut self, log: f64) {
        self.lines = self.lines * KEPT + 1.0;
        self.logs = self.logs * KEPT + log;
        self.squares = self.squares * KEPT + log * log;
    }
}

/// Average time for `pieces` pieces of one slot before anything is learned, seconds; if the line has begun, for its
/// next pieces.
fn usual_s(pieces: u32, begun: bool) -> f64 {
    let first = if begun { FURTHER_S } else { FIRST_S };
    first + FURTHER_S * f64::from(pieces.saturating_sub(1))
}

impl PickPace {
    /// Learns that a line of this many pieces took this many seconds.
    pub fn learn(&mut self, station: StationId, pieces: u32, seconds: f64) {
        let factor = seconds / usual_s(pieces, false);
        if factor > 0.0 && factor <= SLOWEST {
            let log = factor.ln();
            // A break in the middle of a line says nothing about how long lines take.
            let most = FARTHEST * self.spread();
            self.residuals.note((log - self.middle(station)).clamp(-most, most));
            self.crew.note(log);
            self.stations.entry(station).or_default().note(log);
        }
    }

    /// The middle of the factor at a station, as a logarithm.
    fn middle(&self, station: StationId) -> f64 {
        let crew = self.crew.logs / (START_LINES + self.crew.lines);
        let own = self.stations.get(&station).copied().unwrap_or_default();
        (CREW_LINES * crew + own.logs) / (CREW_LINES + own.lines)
    }

    /// The spread of the factor's logarithm.
    fn spread(&self) -> f64 {
        let PickSums { lines, squares, .. } = self.residuals;
        ((SPREAD * SPREAD * SPREAD_LINES + squares) / (SPREAD_LINES + lines)).sqrt()
    }

    /// Average time of a line of this many pieces at a station, seconds.
    pub fn line_s(&self, station: StationId, pieces: u32) -> f64 {
        usual_s(pieces, false) * self.mean_factor(station)
    }

    fn mean_factor(&self, station: StationId) -> f64 {
        (self.middle(station) + self.spread().powi(2) / 2.0).exp()
    }

    /// How long the rest of a visit takes.
    pub fn remaining(&self, station: StationId, lines: &Lines, seen: VisitSeen) -> Remaining {
        let (mut mean, mut variance) = self.hand(station, lines, seen);
        // The arm picks at the same time.
        let is_arms = |p: &&LineProgress| p.state == LineState::Arm;
        let pieces: u32 = lines.all().iter().filter(is_arms).map(LineProgress::left).sum();
        let arm_s = f64::from(pieces) * self.arm_piece_s(station);
        if arm_s > mean {
            let spread = self.spread();
            (mean, variance) = (arm_s, variance.max(arm_s * arm_s * ((spread * spread).exp() - 1.0)));
        }
        Remaining::of(mean, variance, self.wider.exp())
    }

    /// Mean and variance of the hand's time for its lines.
    fn hand(&self, station: StationId, lines: &Lines, seen: VisitSeen) -> (f64, f64) {
        let (spread, mean_factor) = (self.spread(), self.mean_factor(station));
        let whole_s: f64 = lines.all().iter().map(|p| usual_s(p.line.quantity, false)).sum();
        let factor = seen.said_s.map_or(mean_factor, |said_s| said_s / whole_s.max(AT_LEAST_S));
        let hands = || lines.all().iter().filter(|p| p.left() > 0 && p.state != LineState::Arm);
        let is_last = hands().count() == 1;
        let relative = (spread * spread).exp() - 1.0;
        hands().fold((0.0, 0.0), |(mean, variance), p| {
            let line_s = factor * usual_s(p.left(), p.pieces > 0);
            let (m, v) = match (p.state, seen.piece) {
                (LineState::Lit, Some(piece)) => {
                    let further_s = factor * FURTHER_S * f64::from(p.left() - 1);
                    let ends_out = seen.ends_out && is_last;
                    let (m, v) = self.piece(station, piece, ends_out.then_some(p.left()));
                    let scale = factor / mean_factor;
                    (m * scale + further_s, v * scale * scale + further_s * further_s * relative)
                }
                (LineState::Lit, None) => rest_of(line_s, spread, seen.lit_s),
                _ => (line_s, line_s * line_s * relative),
            };
            (mean + m, variance + v)
        })
    }

    /// Mean and variance of the rest of the present piece. The last piece of `last_of` need not be carried until the
    /// hand is out.
    fn piece(&self, station: StationId, piece: (PickPhase, f64), last_of: Option<u32>) -> (f64, f64) {
        let until_out = (PickPhase::Carry, 0.0);
        match last_of {
            Some(1) if piece.0 >= PickPhase::Carry => (AT_LEAST_S, 0.0),
            Some(1) => self.phases.rest(station, piece, PickPhase::Grasp),
            Some(_) => {
                let (mean, variance) = self.phases.rest(station, piece, PickPhase::Place);
                let carry_s = self.phases.rest(station, until_out, PickPhase::Place).0;
                ((mean - carry_s).max(AT_LEAST_S), variance)
            }
            None => self.phases.rest(station, piece, PickPhase::Place),
        }
    }

    /// Learns the times of phases of a piece at a station.
    pub fn learn_phases(&mut self, station: StationId, spent: &[SpentPhase]) {
        self.phases.learn(station, spent);
    }

    /// Average time of the hand for its lines, seconds.
    pub fn hand_s(&self, station: StationId, lines: &Lines, seen: VisitSeen) -> f64 {
        self.hand(station, lines, seen).0
    }

    /// Learns whether a visit has ended between the 10 % and the 90 % quantile. Narrow expectations widen until they
    /// hold eight in ten (adaptive conformal inference: Gibbs and Candès 2021, equation 2): wrong slots, missing pieces
    /// and buttons are in no model of lines and phases.
    pub fn learn_end(&mut self, held: bool) {
        let off = if held { BETWEEN - 1.0 } else { BETWEEN };
        self.wider = (self.wider + WIDENS * off).clamp(-WIDEST, WIDEST);
    }

    /// Learns the time in which a robot arm picked a piece, or found none.
    pub fn learn_arm(&mut self, station: StationId, seconds: f64) {
        let mean = self.arms.entry(station).or_insert(ARM_PIECE_S);
        *mean += (seconds.min(SLOWEST * ARM_PIECE_S) - *mean) * ARM_SHARE;
    }

    /// Time of a station's arm for a piece, seconds.
    pub fn arm_piece_s(&self, station: StationId) -> f64 {
        self.arms.get(&station).copied().unwrap_or(ARM_PIECE_S)
    }
}

/// Mean and variance of the rest of a line that takes `line_s` on average and has taken `spent_s` so far.
pub(super) fn rest_of(line_s: f64, spread: f64, spent_s: f64) -> (f64, f64) {
    let middle_s = line_s * (-spread * spread / 2.0).exp();
    let least_s = AT_LEAST_S.min(line_s / 2.0);
    let left = NORMALS.iter().map(|z| middle_s * (spread * z).exp() - spent_s).filter(|s| *s > 0.0);
    let (n, sum, squares) = left.fold((0.0, 0.0, 0.0), |(n, a, b), s| (n + 1.0, a + s, b + s * s));
    if n == 0.0 {
        let mean = (spent_s * OVERDUE).max(least_s);
        return (mean, mean * mean);
    }
    let mean: f64 = sum / n;
    (mean.max(least_s), (squares / n - mean * mean).max(0.0))
}

impl Remaining {
    /// An exactly known remaining time; at least zero.
    pub fn exactly(seconds: f64) -> Remaining {
        let s = seconds.max(0.0);
        Remaining { mean_s: s, p10_s: s, p50_s: s, p90_s: s }
    }

    /// The lognormal distribution of this mean and variance, with its spread multiplied by `wider`.
    fn of(mean_s: f64, variance: f64, wider: f64) -> Remaining {
        if mean_s <= 0.0 {
            return Remaining { mean_s: 0.0, p10_s: 0.0, p50_s: 0.0, p90_s: 0.0 };
        }
        let square = (variance / (mean_s * mean_s)).ln_1p();
        let p50_s = mean_s * (-square / 2.0).exp();
        let off = (NINETIETH * square.sqrt() * wider).exp();
        Remaining { mean_s, p10_s: p50_s / off, p50_s, p90_s: p50_s * off }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{LineChange, OrderLine, PickedBy};
    use super::*;

    const S: StationId = StationId(0);

    fn lines(quantities: &[u32]) -> Lines {
        let slot = |i: usize| giveway_floor::warehouse::SlotName::new(i as u8, 0);
        let line = |(i, quantity): (usize, &u32)| OrderLine {
            slot: slot(i),
            quantity: *quantity,
            tote: "A".into(),
            item: None,
            by: PickedBy::Hand,
        };
        Lines::new(quantities.iter().enumerate().map(line))
    }

    #[test]
    fn more_lines_and_more_pieces_take_longer_and_what_is_done_takes_no_more() {
        let pace = PickPace::default();
        let mean = |quantities: &[u32]| {
            pace.remaining(
                S,
                &lines(quantities),
                VisitSeen { lit_s: 0.0, said_s: None, ..VisitSeen::default() },
            )
            .mean_s
        };
        assert!(mean(&[1]) < mean(&[2]) && mean(&[2]) < mean(&[1, 1]) && mean(&[1, 1]) < mean(&[1, 3, 1]));
        let mut visit = lines(&[1, 3]);
        let whole =
            pace.remaining(S, &visit, VisitSeen { lit_s: 0.0, said_s: None, ..VisitSeen::default() }).mean_s;
        visit.change(0, LineChange::Done(1)).unwrap();
        let half =
            pace.remaining(S, &visit, VisitSeen { lit_s: 0.0, said_s: None, ..VisitSeen::default() }).mean_s;
        visit.change(1, LineChange::Done(2)).unwrap();
        let last =
            pace.remaining(S, &visit, VisitSeen { lit_s: 0.0, said_s: None, ..VisitSeen::default() }).mean_s;
        assert!(whole > half && half > last && last > 1.0, "{whole} {half} {last}");
        visit.change(1, LineChange::Done(1)).unwrap();
        assert_eq!(
            pace.remaining(S, &visit, VisitSeen { lit_s: 0.0, said_s: None, ..VisitSeen::default() }).p90_s,
            0.0
        );
    }

    #[test]
    fn a_slow_station_is_learned_and_a_new_one_is_taken_for_one_of_the_crew() {
        let mut pace = PickPace::default();
        (0..60).for_each(|_| pace.learn(S, 1, 2.0 * FIRST_S));
        (0..60).for_each(|_| pace.learn(StationId(1), 1, FIRST_S));
        let line_s = |s: u32| pace.line_s(StationId(s), 1);
        assert!(line_s(0) > 1.6 * line_s(1), "{} and {}", line_s(0), line_s(1));
        assert!(line_s(1) < line_s(2) && line_s(2) < line_s(0), "in between: {}", line_s(2));
        let before = pace.clone();
        pace.learn(S, 1, 600.0);
        assert_eq!(pace, before, "somebody had a break");
    }

    #[test]
    fn a_line_that_is_overdue_takes_some_time_more_and_never_less_than_a_moment() {
        let pace = PickPace::default();
        let left = |lit_s: f64| {
            pace.remaining(S, &lines(&[1]), VisitSeen { lit_s, said_s: None, ..VisitSeen::default() })
        };
        let mean_s = left(0.0).mean_s;
        assert!(left(4.0).mean_s < mean_s && left(4.0).mean_s > mean_s - 4.0, "what ends soon has ended");
        for lit_s in [5.0, 10.0, 60.0, 600.0] {
            assert!(
                left(lit_s).mean_s >= AT_LEAST_S && left(lit_s).mean_s < lit_s,
                "{lit_s}: {:?}",
                left(lit_s)
            );
        }
        assert!(left(600.0).mean_s > left(60.0).mean_s, "who has been away for long stays away for longer");
    }

    #[test]
    fn quantiles_hold_as_many_visits_as_they_say_once_the_pace_is_learned() {
        let mut pace = PickPace::default();
        // Factors spread like the sixteenths themselves, in a mixed order.
        let factor = |i: usize| (0.3 * NORMALS[i * 7 % 16]).exp();
        (0..400).for_each(|i| pace.learn(S, 1, FIRST_S * factor(i)));
        let r =
            pace.remaining(S, &lines(&[1]), VisitSeen { lit_s: 0.0, said_s: None, ..VisitSeen::default() });
        let share = |below: f64| (0..16).filter(|i| FIRST_S * factor(*i) < below).count();
        assert!((1..=2).contains(&share(r.p10_s)) && (7..=9).contains(&share(r.p50_s)), "{r:?}");
        assert!((14..=15).contains(&share(r.p90_s)), "{r:?}");
    }

    #[test]
    fn expectations_that_hold_too_few_ends_widen_until_they_hold_eight_in_ten() {
        let mut pace = PickPace::default();
        let visit = lines(&[1, 2]);
        // Ends are spread twice as far as the pace of lines says.
        let (mut held, mut counted) = (0, 0);
        for i in 0..4000 {
            let r = pace.remaining(S, &visit, VisitSeen::default());
            let share = (0.5 + f64::from(i) * 0.618_034).fract().clamp(1e-3, 0.999);
            let end_s = r.p50_s * (0.5 * (share / (1.0 - share)).ln()).exp();
            let is_held = (r.p10_s..=r.p90_s).contains(&end_s);
            pace.learn_end(is_held);
            if i >= 1000 {
                (held, counted) = (held + u32::from(is_held), counted + 1);
            }
        }
        let share = f64::from(held) / f64::from(counted);
        assert!((0.77..0.83).contains(&share), "{share}");
    }

    #[test]
    fn what_the_customer_said_of_the_whole_visit_holds_for_what_is_left_of_it_in_proportion() {
        let pace = PickPace::default();
        let mut visit = lines(&[1, 1]);
        assert!(
            (pace
                .remaining(S, &visit, VisitSeen { lit_s: 0.0, said_s: Some(900.0), ..VisitSeen::default() })
                .mean_s
                - 900.0)
                .abs()
                < 20.0
        );
        visit.change(0, LineChange::Done(1)).unwrap();
        assert!(
            (pace
                .remaining(S, &visit, VisitSeen { lit_s: 0.0, said_s: Some(900.0), ..VisitSeen::default() })
                .mean_s
                - 450.0)
                .abs()
                < 10.0
        );
    }
}

//! Where a person's arm will be within a second, from earlier movements with a similar beginning.
//!
//! Main types: [`Analogues`], [`Watched`]. The present arm is compared with all recorded instants; the paths that
//! followed the most similar ones are the forecast, their spread its covariance, scaled per horizon on people left out.
//! Refuses: goals; it knows only what was seen.

use super::person::{ArmJoints, BONES};
use giveway_cell::arm::{UncertainLimbs, UncertainPoint};
use nalgebra::{Matrix3, Vector3};

/// Interval of observations and forecasts, seconds.
pub const STEP_S: f64 = 0.05;
/// Number of forecast steps: one second.
pub const AHEAD: usize = 20;
/// Number of compared observations: 0.2 s.
const BEHIND: usize = 4;
/// A hand slower than this rests, metres per second.
const RESTS_MPS: f64 = 0.15;
/// Share of the paths that is trimmed at either end if the hand rests.
const TRIM: f64 = 0.1;
/// Number of paths that make a forecast.
const WAYS: usize = 16;
/// Standard deviation of a measured joint, metres.
pub const SENSOR_M: f64 = 0.006;

/// Observations of one arm, [`STEP_S`] apart.
pub type Watched = Vec<ArmJoints>;

/// Recorded movements, from which others are forecast.
#[derive(Clone, Debug)]
pub struct Analogues {
    recorded: Vec<Watched>,
    scale: [f64; AHEAD],
}

impl Analogues {
    /// Learns from recordings; those of `left_out` tell how much wider the forecasts must be to contain 95 of 100.
    pub fn learn(recorded: Vec<Watched>, left_out: &[Watched]) -> Analogues {
        let mut learned = Analogues { recorded, scale: [1.0; AHEAD] };
        let mut squares: Vec<Vec<f64>> = vec![Vec::new(); AHEAD];
        for watched in left_out {
            for end in (BEHIND + 1..watched.len().saturating_sub(AHEAD)).step_by(3) {
                let forecast = learned.forecast(&watched[..end]);
                for (h, limbs) in forecast.iter().enumerate() {
                    let palm = &limbs.points[3];
                    let off = watched[end + h][3] - palm.mean;
                    squares[h].extend(palm.cov.cholesky().map(|c| off.dot(&c.solve(&off))));
                }
            }
        }
        // The 95 % quantile of chi-square with three degrees of freedom.
        const CHI2_95: f64 = 7.815;
        for (scale, mut squares) in learned.scale.iter_mut().zip(squares) {
            squares.sort_by(f64::total_cmp);
            if let Some(q) = squares.get(squares.len() * 95 / 100) {
                *scale = (q / CHI2_95).max(0.25);
            }
        }
        learned
    }

    /// Forecast of the limbs, [`STEP_S`] from now and so on; where they are now if nothing recorded is similar.
    pub fn forecast(&self, seen: &[ArmJoints]) -> Vec<UncertainLimbs> {
        let Some(now) = seen.last() else { return Vec::new() };
        let ways = self.alike(seen);
        let total: f64 = ways.iter().map(|w| w.0).sum();
        // Few resting hands set off within a second; all moving hands go somewhere.
        let before = seen.len().checked_sub(BEHIND).map_or(now, |k| &seen[k]);
        let speed_mps = (now[3] - before[3]).norm() / ((BEHIND - 1) as f64 * STEP_S);
        let trim = if speed_mps > RESTS_MPS { 0.0 } else { TRIM };
        let step = |h: usize| {
            let point = |j: usize| {
                let moved = |(_, k, at): &(f64, usize, usize)| {
                    let way = &self.recorded[*k];
                    way[(at + h + 1).min(way.len() - 1)][j] - way[*at][j]
                };
                let mean = Vector3::from_fn(|i, _| middle(ways.iter().map(|w| (moved(w)[i], w.0)), trim));
                let floor = SENSOR_M * SENSOR_M + (0.02 * (h + 1) as f64 * STEP_S).powi(2);
                let mut cov = Matrix3::identity() * floor;
                for way in &ways {
                    let off = moved(way) - mean;
                    cov += off * off.transpose() * (way.0 / total);
                }
                let mean = if ways.is_empty() { now[j] } else { now[j] + mean };
                UncertainPoint { mean, cov: cov * self.scale[h] }
            };
            UncertainLimbs { points: (0..4).map(point).collect(), bones: BONES.to_vec() }
        };
        (0..AHEAD).map(step).collect()
    }

    /// The most similar instants: weight, recording and index.
    fn alike(&self, seen: &[ArmJoints]) -> Vec<(f64, usize, usize)> {
        if seen.len() < BEHIND {
            return Vec::new();
        }
        let last = &seen[seen.len() - BEHIND..];
        let mut best: Vec<(f64, usize, usize)> = Vec::new();
        for (k, way) in self.recorded.iter().enumerate() {
            for at in BEHIND - 1..way.len().saturating_sub(1) {
                let limit = if best.len() < WAYS { f64::INFINITY } else { best[WAYS - 1].0 };
                let mut square = (way[at][3] - last[BEHIND - 1][3]).norm_squared();
                for b in 1..BEHIND {
                    let theirs = way[at][3] - way[at - b][3];
                    let ours = last[BEHIND - 1][3] - last[BEHIND - 1 - b][3];
                    square += (theirs - ours).norm_squared() * 2.0;
                    if square >= limit {
                        break;
                    }
                }
                if square < limit {
                    let place = best.partition_point(|b| b.0 <= square);
                    best.insert(place, (square, k, at));
                    best.truncate(WAYS);
                }
            }
        }
        let width = best.last().map_or(1.0, |b| b.0).max(4.0 * SENSOR_M * SENSOR_M);
        best.into_iter().map(|(square, k, at)| (libm::exp(-square / width), k, at)).collect()
    }
}

/// The weighted mean without this share of the weight at either end; 0 if there is none.
fn middle(of: impl Iterator<Item = (f64, f64)>, trim: f64) -> f64 {
    let mut all: Vec<(f64, f64)> = of.collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = all.iter().map(|a| a.1).sum();
    let (low, high) = (total * trim, total * (1.0 - trim));
    let (mut begins, mut sum) = (0.0, 0.0);
    for (x, weight) in all {
        let ends = begins + weight;
        sum += x * (ends.min(high) - f64::max(begins, low)).max(0.0);
        begins = ends;
    }
    if high > low { sum / (high - low) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::person::BenchPerson;
    use giveway_sim::random::Stream;
    use nalgebra::Point3;

    #[test]
    fn a_movement_like_recorded_ones_is_forecast_better_than_by_standing_still() {
        let mut chance = Stream::new(4, 0, 0);
        let person = BenchPerson::random(&mut chance, Point3::new(0.15, -0.4, 0.35));
        let mut watch = |x: f64| -> Watched {
            let reach = person.reach(&mut chance, Point3::new(0.1, -0.38, 0.05), Point3::new(x, 0.1, 0.05));
            (0..50).map(|k| person.joints(reach.palm((f64::from(k) - 8.0).max(0.0) * STEP_S))).collect()
        };
        let recorded: Vec<Watched> = (0..24).map(|k| watch([-0.2, 0.0, 0.2][k % 3])).collect();
        let left_out = [watch(0.0), watch(0.2)];
        let learned = Analogues::learn(recorded, &left_out);
        let new = watch(-0.2);
        let forecast = learned.forecast(&new[..15]);
        let off = (forecast[9].points[3].mean - new[24][3]).norm();
        let still = (new[14][3] - new[24][3]).norm();
        assert!(off < 0.3 * still, "{off} {still}");
        assert_eq!(forecast.len(), AHEAD);
        assert!(learned.forecast(&[]).is_empty());
    }

    #[test]
    fn the_middle_leaves_out_the_few() {
        let of = |all: &[(f64, f64)]| middle(all.iter().copied(), 0.25);
        assert_eq!(of(&[(5.0, 1.0), (0.0, 2.0), (0.0, 2.0)]), 0.0);
        assert_eq!(of(&[(5.0, 3.0), (0.0, 0.5), (1.0, 0.5)]), 5.0);
        assert_eq!(of(&[(2.0, 1.0), (4.0, 1.0)]), 3.0);
        assert_eq!(of(&[]), 0.0);
    }
}

//! The feature study of the thesis (Table 5.1): how features correlate, and how well each alone predicts the object.
//!
//! Main type: [`FeatureStudy`], main function: [`feature_study`]. Refuses: to choose the nets' features; they use those
//! that the thesis selected.

use super::body::{FEATURES, FRAMES, ObjectMove};
use super::score::best_of;

/// The study uses one of this many frames.
const EVERY: usize = 6;
/// Features that correlate more than this belong to one group.
const ALIKE: f64 = 0.9;
/// Number of selected features.
const SELECTED: usize = 3;

/// Table 5.1 and its consequences.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureStudy {
    /// Pearson's correlation of every two features over frames and objects.
    pub correlation: [[f64; FEATURES.len()]; FEATURES.len()],
    /// Share of frames in which the feature alone is smallest for the right object.
    pub merit: [f64; FEATURES.len()],
    /// The best feature of every group of correlated ones, in order of merit.
    pub selected: Vec<usize>,
}

/// Studies the features of movements.
pub fn feature_study(moves: &[&ObjectMove]) -> FeatureStudy {
    const N: usize = FEATURES.len();
    let (mut count, mut sums, mut products) = (0.0, [0.0; N], [[0.0; N]; N]);
    for m in moves {
        for frame in (0..FRAMES).step_by(EVERY) {
            for object in 0..m.objects.len() {
                let figures = m.figures_at(frame, object);
                count += 1.0;
                for i in 0..N {
                    sums[i] += f64::from(figures[i]);
                    for j in 0..=i {
                        products[i][j] += f64::from(figures[i]) * f64::from(figures[j]);
                    }
                }
            }
        }
    }
    let covariance =
        |i: usize, j: usize| products[i.max(j)][i.min(j)] / count - sums[i] / count * (sums[j] / count);
    let correlation = std::array::from_fn(|i| {
        std::array::from_fn(|j| covariance(i, j) / (covariance(i, i) * covariance(j, j)).max(1e-30).sqrt())
    });
    let merit = std::array::from_fn(|i| merit(moves, i));
    FeatureStudy { correlation, merit, selected: select(&correlation, &merit) }
}

/// Share of frames in which a feature alone predicts the right object.
fn merit(moves: &[&ObjectMove], feature: usize) -> f64 {
    let hits = |m: &ObjectMove| {
        let of = |frame: usize| {
            let scores: Vec<f64> =
                (0..m.objects.len()).map(|o| -f64::from(m.figures_at(frame, o)[feature])).collect();
            f64::from(u8::from(best_of(&scores) == m.right))
        };
        (0..FRAMES).map(of).sum::<f64>()
    };
    moves.iter().map(|m| hits(m)).sum::<f64>() / (moves.len().max(1) * FRAMES) as f64
}

/// Features by merit, without those that correlate with a better one (Hall 1999).
fn select(correlation: &[[f64; FEATURES.len()]; FEATURES.len()], merit: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..FEATURES.len()).collect();
    order.sort_by(|a, b| merit[*b].total_cmp(&merit[*a]));
    let mut selected: Vec<usize> = Vec::new();
    for i in order {
        let is_new = selected.iter().all(|s| correlation[*s][i].abs() < ALIKE);
        if is_new && selected.len() < SELECTED {
            selected.push(i);
        }
    }
    selected
}

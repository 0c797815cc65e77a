//! Fits sums of Gaussians to palm points (expectation maximisation, Dempster, Laird and Rubin 1977).
//!
//! Main functions: [`fit_mixture`], [`palm_points`]. Schwarz's criterion chooses the number of Gaussians. Refuses:
//! random numbers; the first guess cuts the way into pieces of equal length.

use super::items::ReachItem;
use giveway_people::reach::ArmVector;
use giveway_people::reach::mixtures::{PalmGaussian, PalmMixture};
use nalgebra::Matrix3;

/// Numbers of Gaussians to try.
const TRIED: [usize; 4] = [3, 6, 9, 12];
const ROUNDS: usize = 25;
/// Least width of a Gaussian, metres: people differ by more.
const NARROWEST_M: f64 = 0.015;

/// Palm points on the way, relative to the shoulder, each with the share of the way behind it.
pub fn palm_points(item: &ReachItem) -> Vec<(f64, ArmVector)> {
    let count = (item.arrival - item.onset).max(1) as f64;
    let share = |t: usize| (t - item.onset) as f64 / count;
    let point = |t: usize| (share(t), item.samples[t].hand - item.samples[t].shoulder);
    (item.onset..=item.arrival).map(point).collect()
}

/// The mixture of one place; nothing if there are too few points.
pub fn fit_mixture(place: &str, mut points: Vec<(f64, ArmVector)>) -> Option<PalmMixture> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let points: Vec<ArmVector> = points.into_iter().map(|p| p.1).collect();
    let fits = TRIED.iter().filter(|k| points.len() >= 10 * **k).filter_map(|k| {
        let parts = maximise(&points, *k)?;
        let mixture = PalmMixture { place: place.to_owned(), parts };
        let log: f64 = points.iter().map(|p| mixture.log_density(*p)).sum();
        let figures = (10 * k - 1) as f64;
        Some((figures * libm::log(points.len() as f64) - 2.0 * log, mixture))
    });
    fits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|f| f.1)
}

fn maximise(points: &[ArmVector], count: usize) -> Option<Vec<PalmGaussian>> {
    let pieces = points.chunks(points.len().div_ceil(count));
    let first = |p: &[ArmVector]| gaussian(p, &vec![1.0; p.len()], points.len());
    let mut parts: Vec<PalmGaussian> = pieces.map(first).collect::<Option<_>>()?;
    let mut held = vec![vec![0.0; points.len()]; parts.len()];
    for _ in 0..ROUNDS {
        for (i, point) in points.iter().enumerate() {
            let logs: Vec<f64> = parts.iter().map(|p| p.log_density(*point)).collect();
            let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let shares: Vec<f64> = logs.iter().map(|l| libm::exp(l - highest)).collect();
            let sum: f64 = shares.iter().sum();
            held.iter_mut().zip(shares).for_each(|(h, s)| h[i] = s / sum);
        }
        parts = held.iter().filter_map(|h| gaussian(points, h, points.len())).collect();
        held.truncate(parts.len());
    }
    (!parts.is_empty()).then_some(parts)
}

fn gaussian(points: &[ArmVector], held: &[f64], all: usize) -> Option<PalmGaussian> {
    let sum: f64 = held.iter().sum();
    if sum < 1.0 {
        return None;
    }
    let mean = points.iter().zip(held).map(|(p, h)| p * *h).sum::<ArmVector>() / sum;
    let spread = |(p, h): (&ArmVector, &f64)| (p - mean) * (p - mean).transpose() * *h;
    let cov = points.iter().zip(held).map(spread).sum::<Matrix3<f64>>() / sum;
    let least = Matrix3::from_diagonal_element(NARROWEST_M * NARROWEST_M);
    PalmGaussian::new(sum / all as f64, mean, cov + least)
}

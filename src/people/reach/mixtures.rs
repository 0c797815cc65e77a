//! Where palms pass on their way to a place: a sum of Gaussians per place (seed 002, equations 2 to 5).
//!
//! Main types: [`PalmMixture`], [`PalmGaussian`]. Points are relative to the shoulder. Corrected: the density has
//! |Σ|^½, and sums over points close in time are tempered by their number, since such points are far from independent.
//! Refuses: to say anything of a place that nobody was seen to reach for.

use super::sample::ArmVector;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// One Gaussian of palm points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PalmGaussian {
    /// Share of the points in this Gaussian.
    pub share: f64,
    /// Mean, metres from the shoulder.
    pub mean: [f64; 3],
    /// Inverse of the covariance's lower Cholesky factor, row by row, per metre.
    pub whitening: [f64; 6],
}

/// The palm points of one place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PalmMixture {
    /// Name of the place.
    pub place: String,
    /// Gaussians of the place.
    pub parts: Vec<PalmGaussian>,
}

/// Smallest density, as a logarithm: a point far from all others is a surprise, not a proof.
const FLOOR: f64 = -30.0;

impl PalmGaussian {
    /// A Gaussian with a mean and a covariance; nothing if the matrix is not a covariance.
    pub fn new(share: f64, mean: ArmVector, cov: Matrix3<f64>) -> Option<PalmGaussian> {
        let root = cov.cholesky()?.l().try_inverse()?;
        let whitening = [root[(0, 0)], root[(1, 0)], root[(1, 1)], root[(2, 0)], root[(2, 1)], root[(2, 2)]];
        Some(PalmGaussian { share, mean: mean.into(), whitening })
    }

    /// Logarithm of the weighted density at a point (equation 3 with |Σ|^½).
    pub fn log_density(&self, at: ArmVector) -> f64 {
        let [x, y, z] = [at.x - self.mean[0], at.y - self.mean[1], at.z - self.mean[2]];
        let w = &self.whitening;
        let (a, b, c) = (w[0] * x, w[1] * x + w[2] * y, w[3] * x + w[4] * y + w[5] * z);
        let log_roots = libm::log(w[0] * w[2] * w[5]);
        let turns = 1.5 * libm::log(std::f64::consts::TAU);
        libm::log(self.share) + log_roots - turns - 0.5 * (a * a + b * b + c * c)
    }
}

impl PalmMixture {
    /// Logarithm of the density at a point (equation 2).
    pub fn log_density(&self, at: ArmVector) -> f64 {
        let logs = self.parts.iter().map(|p| p.log_density(at));
        let highest = logs.clone().fold(f64::NEG_INFINITY, f64::max);
        if highest < FLOOR {
            return FLOOR;
        }
        highest + libm::log(logs.map(|l| libm::exp(l - highest)).sum::<f64>())
    }

    /// Logarithm of the density of points (equations 4 and 5), tempered: divided by the square root of their number.
    pub fn log_likelihood(&self, points: &[ArmVector]) -> f64 {
        let sum: f64 = points.iter().map(|p| self.log_density(*p)).sum();
        sum / libm::sqrt(points.len().max(1) as f64)
    }

    /// What is wrong with the mixture's figures, if anything.
    pub fn fault(&self) -> Option<String> {
        let is_sound = |p: &PalmGaussian| {
            let figures = p.mean.iter().chain(&p.whitening);
            let [a, _, b, _, _, c] = p.whitening;
            (0.0..=1.0).contains(&p.share)
                && p.share > 0.0
                && figures.into_iter().all(|f| f.abs() < 1e5)
                && [a, b, c].into_iter().all(|d| d > 0.0)
        };
        let all = !self.parts.is_empty() && self.parts.iter().all(is_sound);
        (!all).then(|| format!("the mixture of {} has figures that no Gaussian has", self.place))
    }
}

//! Target of a movement from the palm's positions: one mixture per target (Lyu et al. 2022, equations 2 to 5).
//!
//! Main types: [`MixtureLibrary`]. Equation 3 has |Σ|^½ as it must; for probabilities the sum of equation 5 is tempered
//! by a constant, since neighbouring positions are not independent. Refuses: priors that differ.

use nalgebra::{Matrix3, Point3, Vector3};

/// One Gaussian of a mixture.
#[derive(Clone, Copy, Debug)]
struct Component {
    weight: f64,
    mean: Vector3<f64>,
    inverse: Matrix3<f64>,
    /// Logarithm of the exponential's factor, including the weight.
    scale: f64,
}

impl Component {
    fn new(weight: f64, mean: Vector3<f64>, cov: Matrix3<f64>) -> Component {
        // No position is known better than to 8 mm.
        let cov = cov + Matrix3::identity() * 6.4e-5;
        let inverse = cov.try_inverse().unwrap_or_else(Matrix3::identity);
        let norm = 0.5 * (std::f64::consts::TAU.powi(3) * cov.determinant()).ln();
        Component { weight, mean, inverse, scale: weight.max(1e-12).ln() - norm }
    }

    fn log_density(&self, at: &Vector3<f64>) -> f64 {
        let off = at - self.mean;
        self.scale - 0.5 * off.dot(&(self.inverse * off))
    }
}

/// One mixture per target.
#[derive(Clone, Debug)]
pub struct MixtureLibrary {
    targets: Vec<Vec<Component>>,
}

/// Components per target, the published number.
pub const COMPONENTS: usize = 18;
/// Rounds of expectation and maximisation.
const ROUNDS: usize = 25;

impl MixtureLibrary {
    /// Learns from the palms of movements, per target.
    pub fn learn(movements: &[Vec<Vec<Point3<f64>>>]) -> MixtureLibrary {
        MixtureLibrary { targets: movements.iter().map(|of| mixture(of)).collect() }
    }

    /// Log-likelihood of these palms on the way to each target (equation 5).
    pub fn log_likelihoods(&self, palms: &[Point3<f64>]) -> Vec<f64> {
        let of = |components: &Vec<Component>| {
            palms.iter().map(|p| log_sum(components.iter().map(|c| c.log_density(&p.coords)))).sum()
        };
        self.targets.iter().map(of).collect()
    }

    /// The most probable target.
    pub fn target(&self, palms: &[Point3<f64>]) -> usize {
        let logs = self.log_likelihoods(palms);
        (0..logs.len()).max_by(|a, b| logs[*a].total_cmp(&logs[*b])).unwrap_or(0)
    }

    /// The probabilities of all targets, tempered.
    pub fn probabilities(&self, palms: &[Point3<f64>]) -> Vec<f64> {
        // Positions 0.05 s apart give the same evidence four times.
        let temper = 0.25;
        let logs: Vec<f64> = self.log_likelihoods(palms).iter().map(|l| l * temper).collect();
        let sum = log_sum(logs.iter().copied());
        logs.iter().map(|l| libm::exp(l - sum)).collect()
    }
}

fn log_sum(logs: impl Iterator<Item = f64> + Clone) -> f64 {
    let most = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    if !most.is_finite() {
        return most;
    }
    most + libm::log(logs.map(|l| libm::exp(l - most)).sum())
}

/// The mixture of all positions of these movements, starting from equal parts of their time.
fn mixture(movements: &[Vec<Point3<f64>>]) -> Vec<Component> {
    let timed = movements
        .iter()
        .flat_map(|way| way.iter().enumerate().map(move |(k, p)| (k as f64 / way.len() as f64, p.coords)));
    let timed: Vec<(f64, Vector3<f64>)> = timed.collect();
    let mut shares: Vec<[f64; COMPONENTS]> = timed
        .iter()
        .map(|(share, _)| {
            let mine = ((share * COMPONENTS as f64) as usize).min(COMPONENTS - 1);
            std::array::from_fn(|k| f64::from(u8::from(k == mine)))
        })
        .collect();
    let mut components = Vec::new();
    for _ in 0..ROUNDS {
        components = (0..COMPONENTS).map(|k| maximised(&timed, &shares, k)).collect::<Vec<_>>();
        for ((_, at), share) in timed.iter().zip(&mut shares) {
            let logs: [f64; COMPONENTS] = std::array::from_fn(|k| components[k].log_density(at));
            let sum = log_sum(logs.iter().copied());
            *share = logs.map(|l| libm::exp(l - sum));
        }
    }
    components.retain(|c| c.weight > 1e-6);
    components
}

fn maximised(timed: &[(f64, Vector3<f64>)], shares: &[[f64; COMPONENTS]], k: usize) -> Component {
    let total: f64 = shares.iter().map(|s| s[k]).sum::<f64>().max(1e-9);
    let places = || timed.iter().zip(shares).map(|((_, at), s)| (at, s[k] / total));
    let mean: Vector3<f64> = places().map(|(at, w)| at * w).sum();
    let cov: Matrix3<f64> = places().map(|(at, w)| (at - mean) * (at - mean).transpose() * w).sum();
    Component::new(total / timed.len().max(1) as f64, mean, cov)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_movement_is_taken_for_the_target_that_it_goes_to() {
        let way = |x: f64, off: f64| -> Vec<Point3<f64>> {
            (0..20).map(|k| Point3::new(x * f64::from(k) / 19.0 + off, f64::from(k) / 40.0, off)).collect()
        };
        let of = |x: f64| [-0.01, 0.0, 0.01].map(|off| way(x, off)).to_vec();
        let library = MixtureLibrary::learn(&[of(-0.2), of(0.0), of(0.2)]);
        for (k, x) in [-0.2, 0.0, 0.2].into_iter().enumerate() {
            let seen = way(x, 0.004);
            assert_eq!(library.target(&seen), k);
            let (early, late) = (library.probabilities(&seen[..4]), library.probabilities(&seen[..14]));
            assert!(late[k] > early[k] && late[k] > 0.9, "{early:?} {late:?}");
            assert!((early.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        }
    }
}

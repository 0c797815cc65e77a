//! A probability over places, as a sum of Gaussians.
//!
//! Main types: [`Part`], [`Mixture`]. Regions are those of highest density, so a region of several parts is several
//! islands and never the rack between them. Refuses: to know the time, and the person.

use giveway_floor::geometry::{Point, Vector};
use nalgebra::Matrix2;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// One Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Share of this part in the whole.
    pub weight: f64,
    /// Mean, metres.
    pub mean: Point,
    /// Covariance, m².
    pub cov: Matrix2<f64>,
}

impl Part {
    /// Weighted density at a place, per m².
    fn density(&self, at: Point) -> f64 {
        let (a, b, c) = (self.cov[(0, 0)], self.cov[(0, 1)], self.cov[(1, 1)]);
        let determinant = (a * c - b * b).max(1e-18);
        let d: Vector = at - self.mean;
        let square = (c * d.x * d.x - 2.0 * b * d.x * d.y + a * d.y * d.y) / determinant;
        self.weight * (-0.5 * square).exp() / (TAU * determinant.sqrt())
    }

    /// The lower triangular square root of the covariance.
    fn root(&self) -> [f64; 3] {
        let a = self.cov[(0, 0)].max(1e-12).sqrt();
        let b = self.cov[(0, 1)] / a;
        [a, b, (self.cov[(1, 1)] - b * b).max(1e-12).sqrt()]
    }
}

impl Part {
    /// Which of [`PLACES`], spread like this part, lie in an axis-aligned rectangle, as bits. The same place of a later
    /// forecast's part lies to the same side of its middle.
    pub fn places_within(&self, low: Point, high: Point) -> u64 {
        let [a, b, c] = self.root();
        let reach = FARTHEST * (self.cov[(0, 0)] + self.cov[(1, 1)]).sqrt();
        let beside = |low: f64, high: f64, at: f64| at + reach < low || at - reach > high;
        if beside(low.x, high.x, self.mean.x) || beside(low.y, high.y, self.mean.y) {
            return 0;
        }
        let within = |(u, v): &(f64, f64)| {
            let (x, y) = (self.mean.x + a * u, self.mean.y + b * u + c * v);
            x >= low.x && x <= high.x && y >= low.y && y <= high.y
        };
        let bits = NORMALS.iter().enumerate().map(|(k, place)| u64::from(within(place)) << k);
        bits.fold(0, |all, bit| all | bit)
    }
}

impl Part {
    /// [`FEW_PLACES`] of the places spread like this part, with their numbers. The same number of a later forecast's
    /// part is the same person, a little later.
    pub fn few_places(&self) -> impl Iterator<Item = (usize, Point)> {
        let ([a, b, c], mean) = (self.root(), self.mean);
        let some = NORMALS.iter().step_by(PLACES / FEW_PLACES).enumerate();
        some.map(move |(k, (u, v))| (k, Point::new(mean.x + a * u, mean.y + b * u + c * v)))
    }
}

impl Part {
    /// Both parts merged into one with the same mean and covariance.
    fn with(&self, other: &Part) -> Part {
        let weight = self.weight + other.weight;
        let share = other.weight / weight;
        let apart = other.mean - self.mean;
        let spread = apart * apart.transpose() * (share * (1.0 - share));
        let cov = self.cov * (1.0 - share) + other.cov * share + spread;
        Part { weight, mean: self.mean + apart * share, cov }
    }

    /// Upper bound of the loss from merging both parts, as relative entropy.
    fn loss(&self, other: &Part) -> f64 {
        let log = |p: &Part| p.weight * p.cov.determinant().max(1e-18).ln();
        0.5 * (log(&self.with(other)) - log(self) - log(other))
    }
}

/// Largest number of parts considered for merging; the largest parts are kept.
const LOOKED_AT: usize = 12;

/// Parts with less than this share are dropped when merging.
const SMALL: f64 = 0.02;

/// Gaussians whose weights sum to one.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mixture {
    /// The Gaussians of the mixture.
    pub parts: Vec<Part>,
}

/// Number of places per part for counting probabilities.
pub const PLACES: usize = 64;

/// Number of places per part if there are many nodes to check.
pub const FEW_PLACES: usize = 16;

/// The places of a round Gaussian.
static NORMALS: LazyLock<[(f64, f64); PLACES]> = LazyLock::new(|| std::array::from_fn(normal));

/// No place is farther out than this, in standard deviations.
const FARTHEST: f64 = 3.2;

impl Mixture {
    /// The mean place; nothing if there are no parts.
    pub fn mean(&self) -> Option<Point> {
        let total: f64 = self.parts.iter().map(|p| p.weight).sum();
        let sum: Vector = self.parts.iter().map(|p| p.mean.coords * p.weight).sum();
        (total > 0.0).then(|| Point::from(sum / total))
    }

    /// Density at a place, per m².
    pub fn density(&self, at: Point) -> f64 {
        self.parts.iter().map(|p| p.density(at)).sum()
    }

    /// The probability of the smallest region of highest density that contains a place: 0 at the highest peak, near 1
    /// far out. The stated 95 % region contains the place if this is at most 0.95.
    pub fn level(&self, at: Point) -> f64 {
        let here = self.density(at);
        self.samples().filter(|(p, _)| self.density(*p) > here).map(|(_, w)| w).sum::<f64>().min(1.0)
    }

    /// Area of the smallest region with probability `level`, m² (importance sampling over its own density).
    pub fn area(&self, level: f64) -> f64 {
        let mut all: Vec<(f64, f64)> = self.samples().map(|(p, w)| (self.density(p), w)).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (mut mass, mut area) = (0.0, 0.0);
        for (density, weight) in all {
            if mass >= level || density <= 0.0 {
                break;
            }
            mass += weight;
            area += weight / density;
        }
        area
    }

    /// Weighted places spread like the probability itself: always the same ones, so results repeat.
    fn samples(&self) -> impl Iterator<Item = (Point, f64)> + '_ {
        self.parts.iter().filter(|p| p.weight > 0.0).flat_map(|part| {
            let [a, b, c] = part.root();
            NORMALS.iter().map(move |(u, v)| {
                let at = Point::new(part.mean.x + a * u, part.mean.y + b * u + c * v);
                (at, part.weight / PLACES as f64)
            })
        })
    }

    /// Approximates the mixture by at most `most` parts, for display: small shares are dropped, and of the rest the
    /// pairs that lose least are merged (Runnalls 2007, eq. 16), keeping mean and covariance (eqs. 2 to 4).
    #[must_use]
    pub fn merged(mut self, most: usize) -> Mixture {
        self.parts.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        self.parts.truncate(LOOKED_AT);
        let total: f64 = self.parts.iter().map(|p| p.weight).sum();
        self.parts.retain(|p| p.weight > SMALL * total);
        while self.parts.len() > most.max(1) {
            let n = self.parts.len();
            let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
            let cost = |(i, j): (usize, usize)| (self.parts[i].loss(&self.parts[j]), i, j);
            let Some((_, i, j)) = pairs.map(cost).min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            let other = self.parts.remove(j);
            self.parts[i] = self.parts[i].with(&other);
        }
        let total: f64 = self.parts.iter().map(|p| p.weight).sum();
        self.parts.iter_mut().for_each(|p| p.weight /= total.max(1e-12));
        self
    }

    /// The mixture with all parts scaled about their means: `scale` multiplies standard deviations.
    #[must_use]
    pub fn scaled(mut self, scale: f64) -> Mixture {
        self.parts.iter_mut().for_each(|p| p.cov *= scale * scale);
        self
    }
}

/// The k-th of [`PLACES`] places spread evenly under a round Gaussian: rings of equal probability, turned by the golden
/// angle (Vogel 1979).
fn normal(k: usize) -> (f64, f64) {
    let share = (k as f64 + 0.5) / PLACES as f64;
    let radius = (-2.0 * (1.0 - share).ln()).sqrt();
    let angle = k as f64 * 2.399_963_229_728_653;
    (radius * angle.cos(), radius * angle.sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round(weight: f64, x: f64, sigma: f64) -> Part {
        Part { weight, mean: Point::new(x, 0.0), cov: Matrix2::identity() * sigma * sigma }
    }

    #[test]
    fn the_region_of_one_gaussian_is_its_ellipse() {
        let one = Mixture { parts: vec![round(1.0, 0.0, 0.5)] };
        for level in [0.5, 0.9, 0.95] {
            // Of a round Gaussian, the share within r is 1 − exp(−r²/2σ²).
            let r = 0.5 * (-2.0 * f64::ln(1.0 - level)).sqrt();
            assert!((one.level(Point::new(0.0, r)) - level).abs() < 0.02, "{level}");
            assert!((one.area(level) / (std::f64::consts::PI * r * r) - 1.0).abs() < 0.15, "{level}");
        }
    }

    #[test]
    fn the_places_in_a_rectangle_are_its_share_and_stay_on_their_side() {
        let skew = Part { weight: 1.0, mean: Point::new(0.4, -0.2), cov: Matrix2::new(0.5, 0.3, 0.3, 0.4) };
        let m = Mixture { parts: vec![skew] };
        let (low, high) = (Point::new(-0.3, -0.5), Point::new(0.9, 0.1));
        let step = 0.01;
        let cells = (0..120).flat_map(|i| (0..60).map(move |j| (i as f64 + 0.5, j as f64 + 0.5)));
        let cell =
            |(i, j): (f64, f64)| m.density(Point::new(low.x + i * step, low.y + j * step)) * step * step;
        let sum: f64 = cells.map(cell).sum();
        let counted = f64::from(skew.places_within(low, high).count_ones()) / PLACES as f64;
        assert!((counted - sum).abs() < 0.03, "{counted} and {sum}");
        assert_eq!(skew.places_within(Point::new(-9.0, -9.0), Point::new(9.0, 9.0)), u64::MAX);
        assert_eq!(skew.places_within(Point::new(20.0, 20.0), Point::new(21.0, 21.0)), 0);
        // Three metres on and twice as wide, the same half is to the left.
        let later = Part { mean: Point::new(3.4, -0.2), cov: skew.cov * 4.0, ..skew };
        let left = |p: &Part| p.places_within(Point::new(-99.0, -99.0), Point::new(p.mean.x, 99.0));
        assert_eq!(left(&skew), left(&later));
    }

    #[test]
    fn a_mixture_in_few_parts_keeps_what_is_to_be_seen() {
        let near = [0.0, 0.1, 0.2, 0.3].map(|x| round(0.15, x, 0.4));
        let far = [8.0, 8.2].map(|x| round(0.195, x, 0.5));
        let parts = near.into_iter().chain(far).chain([round(0.01, 40.0, 1.0)]).collect();
        let few = Mixture { parts }.merged(2);
        assert_eq!(few.parts.len(), 2);
        assert!((few.parts.iter().map(|p| p.weight).sum::<f64>() - 1.0).abs() < 1e-9);
        let at = |x: f64| few.parts.iter().find(|p| (p.mean.x - x).abs() < 0.01).expect("one at each place");
        assert!((at(0.15).weight - 0.6 / 0.99).abs() < 1e-9, "{few:?}");
        // Variances add: that of each part, and that of their means.
        assert!((at(0.15).cov[(0, 0)] - (0.16 + 0.0125)).abs() < 1e-9);
        assert!((at(8.1).cov[(1, 1)] - 0.25).abs() < 1e-9);
    }

    #[test]
    fn between_two_ways_nobody_is() {
        let two = Mixture { parts: vec![round(0.5, -3.0, 0.4), round(0.5, 3.0, 0.4)] };
        assert!(two.level(Point::new(0.0, 0.0)) > 0.99 && two.level(Point::new(3.0, 0.0)) < 0.05);
        assert!(two.mean().unwrap().x.abs() < 1e-9);
    }

    #[test]
    fn density_integrates_to_one() {
        let skew = Part { weight: 0.3, mean: Point::new(1.0, 1.0), cov: Matrix2::new(0.5, 0.3, 0.3, 0.4) };
        let m = Mixture { parts: vec![round(0.7, 0.0, 0.6), skew] };
        let cells =
            (-60..60).flat_map(|i| (-60..60).map(move |j| Point::new(0.1 * i as f64, 0.1 * j as f64)));
        let sum: f64 = cells.map(|p| m.density(p) * 0.01).sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
    }
}

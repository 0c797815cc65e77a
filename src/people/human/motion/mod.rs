//! How a person moves now: three ways of moving at once, each with its probability.
//!
//! Main types: [`Motion`] (interacting multiple models: Blom and Bar-Shalom 1988), [`MotionModel`] (its figures,
//! learned from recorded people), [`Fix`] (a measured position), [`Ahead`]. Time is continuous: any rate of fixes, and
//! gaps, mean the same motion; silence makes the Gaussian grow. Refuses: goals and walls.

mod mode;

use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};
use mode::{KinematicState, Mat5, MotionMode, Vec5};
use nalgebra::{Matrix2, Matrix4, Matrix5x2, Vector4};
use serde::{Deserialize, Serialize};
use std::f64::consts::{LN_2, TAU};

/// Figures of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionModel {
    /// Rate at which people change their way of moving, per second.
    pub changes_per_s: f64,
    /// Probabilities of standing, straight and turning after a change.
    pub shares: [f64; 3],
    /// Process noise of each way of moving: power spectral density of acceleration, m²/s³.
    pub accel_psd: [f64; 3],
    /// Time in which a stop takes off all but 1/e of the speed, seconds.
    pub halt_s: f64,
    /// Time in which a turn loses half of its rate, seconds.
    pub straighten_s: f64,
    /// Standard deviation of turn rates, radians per second.
    pub turn_rps: f64,
    /// Sway of the head or tag about the walked path: standard deviation, metres.
    pub sway_m: f64,
}

impl Default for MotionModel {
    fn default() -> MotionModel {
        MotionModel {
            changes_per_s: 0.6,
            shares: [0.2, 0.6, 0.2],
            accel_psd: [0.05, 0.15, 0.4],
            halt_s: 0.5,
            straighten_s: 0.4,
            turn_rps: 1.0,
            sway_m: 0.03,
        }
    }
}

impl MotionModel {
    fn straighten_per_s(&self) -> f64 {
        LN_2 / self.straighten_s
    }

    fn turn_variance(&self) -> f64 {
        self.turn_rps * self.turn_rps
    }

    /// What is wrong with the figures, if anything.
    pub fn fault(&self) -> Option<&'static str> {
        let positive = [self.changes_per_s, self.halt_s, self.straighten_s, self.turn_rps];
        let shares: f64 = self.shares.iter().sum();
        if positive.iter().any(|v| !(1e-4..=1e4).contains(v)) {
            return Some("changes_per_s, halt_s, straighten_s and turn_rps must be positive");
        }
        if self.shares.iter().any(|s| !(1e-6..=1.0).contains(s)) || (shares - 1.0).abs() > 1e-6 {
            return Some("shares must be positive and sum to one");
        }
        if self.accel_psd.iter().any(|q| !(1e-6..=1e4).contains(q)) || !(0.0..=1.0).contains(&self.sway_m) {
            return Some("accel_psd must be positive, sway_m from 0 to 1");
        }
        None
    }
}

/// A measured position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// Time of the measurement.
    pub seen: Time,
    /// Measured position, metres.
    pub at: Point,
    /// Standard deviation along each axis, metres.
    pub sigma_m: f64,
}

/// What the filter did with a fix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// The fix was used.
    Taken,
    /// The fix is not newer than the newest one.
    Late,
    /// The fix is too far from the expected position.
    Doubted,
    /// Several fixes in a row were too far: the filter starts anew here.
    Restarted,
}

/// A person's expected state at one moment, as one Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ahead {
    /// Mean position, metres.
    pub at: Point,
    /// Covariance of the position, m².
    pub cov: Matrix2<f64>,
    /// Mean velocity, metres per second.
    pub velocity: Vector,
    /// Probabilities of standing, straight and turning.
    pub modes: [f64; 3],
}

/// The filter's estimate at its newest fix: a Gaussian over position and velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionEstimate {
    /// Time of the newest fix.
    pub seen: Time,
    /// Position and velocity, metres and metres per second.
    pub mean: Vector4<f64>,
    /// Covariance of position and velocity.
    pub cov: Matrix4<f64>,
}

impl MotionEstimate {
    /// The normalised estimation error squared of position and velocity: chi-square with four degrees of freedom if the
    /// filter is consistent (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).
    pub fn nees(&self, at: Point, velocity: Vector) -> f64 {
        let error = Vector4::new(at.x, at.y, velocity.x, velocity.y) - self.mean;
        let inverse = self.cov.try_inverse().expect("the covariance of an estimate has an inverse");
        error.dot(&(inverse * error))
    }

    /// The normalised estimation error squared of the position alone: two degrees of freedom.
    pub fn nees_of_place(&self, at: Point) -> f64 {
        let error = Vector::new(at.x - self.mean[0], at.y - self.mean[1]);
        let place = self.cov.fixed_view::<2, 2>(0, 0).into_owned();
        let inverse = place.try_inverse().expect("the covariance of a place has an inverse");
        error.dot(&(inverse * error))
    }
}

/// Squared Mahalanobis distance beyond which a fix is doubted (one in two million true ones).
const GATE: f64 = 29.0;
/// After this many doubted fixes in a row, the fixes are taken to be right and the filter wrong.
const DOUBTS: u32 = 2;
/// Prior standard deviation of the velocity along each axis, metres per second.
const SPEED_MPS: f64 = 0.9;
/// After a longer gap than this the filter starts anew, seconds.
const GAP_S: f64 = 30.0;

/// The filter of one person.
#[derive(Clone, Debug)]
pub struct Motion {
    model: MotionModel,
    seen: Option<Time>,
    states: [KinematicState; 3],
    chances: [f64; 3],
    doubts: u32,
    /// Sum of the logarithms of each fix's likelihood (density per m²), and number of fixes.
    likelihood: (f64, u32),
}

impl Motion {
    /// A filter without fixes.
    pub fn new(model: MotionModel) -> Motion {
        let nothing = KinematicState { mean: Vec5::zeros(), cov: Mat5::identity() };
        let (states, chances) = ([nothing; 3], model.shares);
        Motion { model, seen: None, states, chances, doubts: 0, likelihood: (0.0, 0) }
    }

    /// Time of the newest fix.
    pub fn seen(&self) -> Option<Time> {
        self.seen
    }

    /// The estimate at the newest fix; nothing before the first.
    pub fn estimate(&self) -> Option<MotionEstimate> {
        let (seen, s) = (self.seen?, blend(&self.states, &self.chances));
        let mean = s.mean.fixed_rows::<4>(0).into_owned();
        Some(MotionEstimate { seen, mean, cov: s.cov.fixed_view::<4, 4>(0, 0).into_owned() })
    }

    /// Sum of the logarithms of all fixes' likelihoods (density per m²), and number of fixes.
    pub fn likelihood(&self) -> (f64, u32) {
        self.likelihood
    }

    /// Processes a fix.
    pub fn see(&mut self, fix: Fix) -> Use {
        let Some(before) = self.seen else {
            self.start(fix);
            return Use::Taken;
        };
        if fix.seen <= before {
            return Use::Late;
        }
        let dt = (fix.seen - before).as_secs_f64();
        if dt > GAP_S {
            self.start(fix);
            return Use::Restarted;
        }
        let (states, prior) = self.mixed(dt);
        let predicted: Vec<KinematicState> = (MotionMode::ALL.iter().zip(&states))
            .map(|(mode, s)| mode.predict(&self.model, s, dt, true))
            .collect();
        let variance = fix.sigma_m * fix.sigma_m + self.model.sway_m * self.model.sway_m;
        let surprises: Vec<Surprise> = predicted.iter().map(|s| Surprise::of(s, fix.at, variance)).collect();
        if surprises.iter().all(|s| s.mahalanobis2 > GATE) {
            self.doubts += 1;
            if self.doubts < DOUBTS {
                return Use::Doubted;
            }
            self.start(fix);
            return Use::Restarted;
        }
        self.doubts = 0;
        self.seen = Some(fix.seen);
        let best = surprises.iter().map(|s| s.log_density).fold(f64::NEG_INFINITY, f64::max);
        let mut total = 0.0;
        for i in 0..3 {
            self.states[i] = surprises[i].update(&predicted[i]);
            self.chances[i] = prior[i] * (surprises[i].log_density - best).exp() + 1e-12;
            total += self.chances[i];
        }
        self.chances.iter_mut().for_each(|c| *c /= total);
        self.likelihood = (self.likelihood.0 + best + total.ln(), self.likelihood.1 + 1);
        Use::Taken
    }

    fn start(&mut self, fix: Fix) {
        let place = fix.sigma_m * fix.sigma_m + self.model.sway_m * self.model.sway_m;
        let speed = SPEED_MPS * SPEED_MPS;
        let spread = Vec5::new(place, place, speed, speed, self.model.turn_variance());
        let mean = Vec5::new(fix.at.x, fix.at.y, 0.0, 0.0, 0.0);
        self.states = [KinematicState { mean, cov: Mat5::from_diagonal(&spread) }; 3];
        (self.chances, self.doubts, self.seen) = (self.model.shares, 0, Some(fix.seen));
    }

    /// The state with which each mode starts a step of `dt` seconds, and the probabilities of the modes then. A change
    /// leads to any mode, so two steps equal one of twice the length.
    fn mixed(&self, dt: f64) -> ([KinematicState; 3], [f64; 3]) {
        let kept = (-self.model.changes_per_s * dt).exp();
        let mut prior = [0.0; 3];
        let states = std::array::from_fn(|to| {
            let share = (1.0 - kept) * self.model.shares[to];
            let from: [f64; 3] =
                std::array::from_fn(|i| self.chances[i] * (share + if i == to { kept } else { 0.0 }));
            prior[to] = from.iter().sum();
            blend(&self.states, &from.map(|w| w / prior[to]))
        });
        (states, prior)
    }

    /// The person's expected state at some moment, `noisy` or as if the person changed nothing after the newest fix.
    fn at(&self, t: Time, noisy: bool) -> Option<(KinematicState, [f64; 3])> {
        let seen = self.seen?;
        let dt = (t - seen).max(Span::ZERO).as_secs_f64();
        if dt == 0.0 {
            return Some((blend(&self.states, &self.chances), self.chances));
        }
        let moved: [KinematicState; 3] =
            std::array::from_fn(|i| MotionMode::ALL[i].predict(&self.model, &self.states[i], dt, noisy));
        Some((blend(&moved, &self.chances), self.chances))
    }

    /// The person's expected state at the newest fix or later; nothing before the first fix.
    pub fn ahead(&self, t: Time) -> Option<Ahead> {
        self.at(t, true).map(|(s, modes)| ahead(&s, modes))
    }

    /// The expected state with only the uncertainty about the present position and motion, and none about what the
    /// person will do.
    pub fn carried(&self, t: Time) -> Option<Ahead> {
        self.at(t, false).map(|(s, modes)| ahead(&s, modes))
    }
}

fn ahead(s: &KinematicState, modes: [f64; 3]) -> Ahead {
    Ahead {
        at: Point::new(s.mean[0], s.mean[1]),
        cov: s.cov.fixed_view::<2, 2>(0, 0).into_owned(),
        velocity: Vector::new(s.mean[2], s.mean[3]),
        modes,
    }
}

/// One Gaussian with the mean and covariance of several.
fn blend(states: &[KinematicState; 3], weights: &[f64; 3]) -> KinematicState {
    let mut mean = Vec5::zeros();
    states.iter().zip(weights).for_each(|(s, w)| mean += s.mean * *w);
    let mut cov = Mat5::zeros();
    for (s, w) in states.iter().zip(weights) {
        let off = s.mean - mean;
        cov += (s.cov + off * off.transpose()) * *w;
    }
    KinematicState { mean, cov }
}

/// The deviation of a fix from the prediction.
struct Surprise {
    gain: Matrix5x2<f64>,
    spread: Matrix2<f64>,
    innovation: Vector,
    mahalanobis2: f64,
    log_density: f64,
}

impl Surprise {
    fn of(s: &KinematicState, at: Point, variance: f64) -> Surprise {
        let spread = s.cov.fixed_view::<2, 2>(0, 0).into_owned() + Matrix2::identity() * variance;
        let inverse = spread.try_inverse().expect("a covariance with a fix's own variance has an inverse");
        let innovation = Vector::new(at.x - s.mean[0], at.y - s.mean[1]);
        let mahalanobis2 = innovation.dot(&(inverse * innovation));
        let log_density = -0.5 * mahalanobis2 - 0.5 * spread.determinant().ln() - TAU.ln();
        let gain = s.cov.fixed_view::<5, 2>(0, 0) * inverse;
        Surprise { gain, spread, innovation, mahalanobis2, log_density }
    }

    fn update(&self, s: &KinematicState) -> KinematicState {
        let cov = s.cov - self.gain * self.spread * self.gain.transpose();
        KinematicState { mean: s.mean + self.gain * self.innovation, cov: (cov + cov.transpose()) / 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normally distributed numbers, the same every time (Box and Muller 1958).
    struct Normal(u64);

    impl Normal {
        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        }

        fn draw(&mut self) -> f64 {
            (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
        }
    }

    /// Mean error of many people who move as the filter assumes, three seconds after the first fix.
    fn mean_nees(believed: MotionModel, true_psd: f64, people: usize) -> [f64; 2] {
        let (dt, sigma_m, mut dice, mut sums) = (0.1_f64, 0.05, Normal(7), [0.0, 0.0]);
        for _ in 0..people {
            let mut filter = Motion::new(believed);
            let (mut at, mut velocity) = (Point::origin(), Vector::new(dice.draw(), dice.draw()) * SPEED_MPS);
            for k in 0..=30 {
                if k > 0 {
                    let push = Vector::new(dice.draw(), dice.draw()) * (true_psd * dt).sqrt();
                    let stray = Vector::new(dice.draw(), dice.draw()) * (true_psd * dt.powi(3) / 12.0).sqrt();
                    at += velocity * dt + push * (dt / 2.0) + stray;
                    velocity += push;
                }
                let seen = at + Vector::new(dice.draw(), dice.draw()) * sigma_m;
                let used = filter.see(Fix { seen: Time(k * 100_000), at: seen, sigma_m });
                assert_eq!(used, Use::Taken);
            }
            let estimate = filter.estimate().expect("it was seen");
            sums = [sums[0] + estimate.nees_of_place(at), sums[1] + estimate.nees(at, velocity)];
        }
        sums.map(|s| s / people as f64)
    }

    #[test]
    fn the_filter_is_consistent_with_people_who_move_as_it_takes_them_to_move() {
        let psd = 0.15;
        let straight = MotionModel {
            changes_per_s: 1e-4,
            shares: [1e-6, 1.0 - 2e-6, 1e-6],
            accel_psd: [psd; 3],
            sway_m: 0.0,
            ..MotionModel::default()
        };
        // 95 % bounds of the mean of 400 chi-square variables of two and of four degrees of freedom.
        let [place, motion] = mean_nees(straight, psd, 400);
        assert!((1.81..2.20).contains(&place) && (3.73..4.28).contains(&motion), "{place} {motion}");
        // People with four times the process noise are farther off than the filter states.
        let [_, surprised] = mean_nees(straight, 4.0 * psd, 400);
        assert!(surprised > 5.5, "{surprised}");
    }
}

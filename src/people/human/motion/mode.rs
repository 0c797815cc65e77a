//! The ways in which people move, and how a state evolves in each.
//!
//! Main types: [`KinematicState`] (a Gaussian over position, velocity and turn rate), [`MotionMode`]. The prediction is
//! that of a cubature Kalman filter (Arasaratnam and Haykin 2009). Refuses: measurements.

use super::MotionModel;
use nalgebra::{SMatrix, SVector};

/// Dimensions: x, y, velocity along x and y, turn rate.
pub(super) const N: usize = 5;
pub(super) type Vec5 = SVector<f64, N>;
pub(super) type Mat5 = SMatrix<f64, N, N>;

/// A Gaussian state: metres, metres per second, radians per second.
#[derive(Clone, Copy, Debug)]
pub(super) struct KinematicState {
    pub mean: Vec5,
    pub cov: Mat5,
}

/// A way of moving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MotionMode {
    /// Coming to rest, or at rest.
    Standing,
    /// At a nearly constant velocity.
    Straight,
    /// In a curve that straightens out: people do not walk in circles.
    Turning,
}

impl MotionMode {
    pub const ALL: [MotionMode; 3] = [MotionMode::Standing, MotionMode::Straight, MotionMode::Turning];

    /// The state `x` after `dt` seconds.
    fn move_on(self, m: &MotionModel, x: &Vec5, dt: f64) -> Vec5 {
        let (vx, vy) = (x[2], x[3]);
        match self {
            MotionMode::Standing => {
                let kept = (-dt / m.halt_s).exp();
                let run = m.halt_s * (1.0 - kept);
                Vec5::new(x[0] + vx * run, x[1] + vy * run, vx * kept, vy * kept, 0.0)
            }
            MotionMode::Straight => Vec5::new(x[0] + vx * dt, x[1] + vy * dt, vx, vy, 0.0),
            MotionMode::Turning => {
                let decay = m.straighten_per_s();
                let kept = (-decay * dt).exp();
                let turned = x[4] * (1.0 - kept) / decay;
                let (sin, cos) = turned.sin_cos();
                // The chord of the arc, with its limit for no turn (the print of eq. 10 divides by zero there).
                let (along, across) = if turned.abs() < 1e-6 {
                    (1.0, 0.5 * turned)
                } else {
                    (sin / turned, (1.0 - cos) / turned)
                };
                Vec5::new(
                    x[0] + dt * (along * vx - across * vy),
                    x[1] + dt * (along * vy + across * vx),
                    cos * vx - sin * vy,
                    sin * vx + cos * vy,
                    x[4] * kept,
                )
            }
        }
    }

    /// The process noise of the step.
    fn noise(self, m: &MotionModel, dt: f64) -> Mat5 {
        let q = m.accel_psd[self as usize];
        let (pp, pv, vv) = match self {
            // A velocity with random accelerations that comes to rest (Ornstein and Uhlenbeck).
            MotionMode::Standing => {
                let (t, e) = (m.halt_s, (-dt / m.halt_s).exp());
                let settled = t / 2.0 * (1.0 - e * e);
                (
                    q * t * t * (dt - 2.0 * t * (1.0 - e) + settled),
                    q * t * t / 2.0 * (1.0 - e).powi(2),
                    q * settled,
                )
            }
            MotionMode::Straight | MotionMode::Turning => (q * dt.powi(3) / 3.0, q * dt * dt / 2.0, q * dt),
        };
        let turn = m.turn_variance();
        let ww = match self {
            MotionMode::Turning => turn * (1.0 - (-2.0 * m.straighten_per_s() * dt).exp()),
            // A person who begins to turn may do so at any rate.
            MotionMode::Standing | MotionMode::Straight => turn,
        };
        let mut noise = Mat5::zeros();
        for i in 0..2 {
            noise[(i, i)] = pp.max(0.0);
            noise[(i, i + 2)] = pv;
            noise[(i + 2, i)] = pv;
            noise[(i + 2, i + 2)] = vv;
        }
        noise[(4, 4)] = ww;
        noise
    }

    /// The state after `dt` seconds; `noisy` says whether process noise counts, or only the present uncertainty.
    pub fn predict(self, m: &MotionModel, s: &KinematicState, dt: f64, noisy: bool) -> KinematicState {
        let root = root_of(&s.cov) * (N as f64).sqrt();
        let mut points = [Vec5::zeros(); 2 * N];
        let mut mean = Vec5::zeros();
        for i in 0..N {
            let off = root.column(i);
            points[i] = self.move_on(m, &(s.mean + off), dt);
            points[N + i] = self.move_on(m, &(s.mean - off), dt);
            mean += points[i] + points[N + i];
        }
        mean /= 2.0 * N as f64;
        let mut cov = Mat5::zeros();
        for p in &points {
            let off = p - mean;
            cov += off * off.transpose();
        }
        cov /= 2.0 * N as f64;
        if noisy {
            cov += self.noise(m, dt);
        }
        KinematicState { mean, cov: (cov + cov.transpose()) / 2.0 }
    }
}

/// The lower triangular L with L Lᵀ = `cov`. If rounding made `cov` not quite positive, a little is added.
fn root_of(cov: &Mat5) -> Mat5 {
    let mut lift = 1e-12;
    loop {
        if let Some(c) = (cov + Mat5::identity() * lift).cholesky() {
            return c.l();
        }
        lift *= 100.0;
        assert!(lift < 1.0, "a covariance is not one: {cov}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> MotionModel {
        MotionModel::default()
    }

    #[test]
    fn a_turn_of_constant_rate_is_the_arc_of_the_printed_formula_and_its_limit_is_a_straight_line() {
        // x += v/w (sin(θ + w dt) − sin θ), y += v/w (cos θ − cos(θ + w dt)), with turns that hardly decay.
        let m = MotionModel { straighten_s: 1e9, ..model() };
        let (v, w, dt) = (1.3, 0.8, 0.5);
        let x = MotionMode::Turning.move_on(&m, &Vec5::new(2.0, 1.0, v, 0.0, w), dt);
        assert!((x[0] - (2.0 + v / w * (w * dt).sin())).abs() < 1e-6, "{x}");
        assert!((x[1] - (1.0 + v / w * (1.0 - (w * dt).cos()))).abs() < 1e-6, "{x}");
        let straight = MotionMode::Turning.move_on(&m, &Vec5::new(2.0, 1.0, v, 0.0, 0.0), dt);
        assert_eq!(straight, MotionMode::Straight.move_on(&m, &Vec5::new(2.0, 1.0, v, 0.0, 0.0), dt));
    }

    #[test]
    fn two_steps_are_one_step_twice_as_long() {
        let m = model();
        let cov = Mat5::from_diagonal(&Vec5::new(0.01, 0.02, 0.2, 0.1, 1e-12));
        let s = KinematicState { mean: Vec5::new(1.0, 2.0, 1.0, -0.5, 0.0), cov };
        for mode in [MotionMode::Standing, MotionMode::Straight] {
            let one = mode.predict(&m, &s, 0.8, true);
            let two = mode.predict(&m, &mode.predict(&m, &s, 0.4, true), 0.4, true);
            assert!((one.mean - two.mean).norm() < 1e-9, "{mode:?}");
            let differs = (one.cov - two.cov).fixed_view::<4, 4>(0, 0).norm();
            assert!(differs < 1e-9, "{mode:?}: {differs}");
        }
    }

    #[test]
    fn who_comes_to_rest_stays_within_the_run_out() {
        let m = model();
        let x = MotionMode::Standing.move_on(&m, &Vec5::new(0.0, 0.0, 1.2, 0.0, 0.0), 60.0);
        assert!((x[0] - 1.2 * m.halt_s).abs() < 1e-9 && x[2].abs() < 1e-9);
    }
}

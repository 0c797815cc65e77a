//! How an arm follows a path: as fast as its limits allow, slowly around corners, and never so fast that it could not
//! stand well before the end of the second that it is given.
//!
//! Main types: [`WayRun`], [`RunAhead`]. Refuses: to leave the path.

use super::kinematics::{ArmKind, Joints, joint_distance};
use super::mpc::{ArmPlan, CYCLE_S, HORIZON};
use super::space::ArmWay;

/// Share of the arm's limits that is used.
const USED: f64 = 0.9;
/// Interval at which speeds change, seconds.
const TICK_S: f64 = 0.02;
const TICKS: usize = 5;
/// Step of its second from which an arm stands if nothing newer arrives.
pub const STANDS_BY: usize = 6;

/// An arm on its path.
#[derive(Clone, Debug)]
pub struct WayRun {
    way: ArmWay,
    /// The pieces of the path: where each ends, radians from its beginning, and its greatest speed and acceleration.
    pieces: Vec<WayPiece>,
    /// How far the arm has come, radians.
    along: f64,
    /// Speed of the arm along the path, rad/s; negative backwards.
    speed: f64,
}

#[derive(Clone, Copy, Debug)]
struct WayPiece {
    ends: f64,
    speed: f64,
    acceleration: f64,
    /// Greatest speed around the corner at the end of the piece, rad/s.
    corner: f64,
}

/// The next second of a run.
#[derive(Clone, Copy, Debug)]
pub struct RunAhead {
    /// The trajectory of that second.
    pub plan: ArmPlan,
    along: f64,
    speed: f64,
}

impl RunAhead {
    /// The configurations until the arm could stand.
    pub fn soon(&self) -> &[Joints] {
        &self.plan.steps[..STANDS_BY]
    }
}

impl WayRun {
    /// A run of an arm that stands at the beginning of a path.
    pub fn new(kind: &ArmKind, way: ArmWay) -> WayRun {
        let all = way.configurations();
        let direction = |pair: &[Joints]| -> Joints {
            let length = joint_distance(&pair[0], &pair[1]).max(1e-9);
            std::array::from_fn(|k| (pair[1][k] - pair[0][k]) / length)
        };
        let directions: Vec<Joints> = all.windows(2).map(direction).collect();
        let least = |of: &Joints, over: &dyn Fn(usize) -> f64| {
            (0..6).map(|k| USED * of[k] / over(k).abs().max(1e-6)).fold(f64::INFINITY, f64::min)
        };
        let mut ends = 0.0;
        let piece = |(i, pair): (usize, &[Joints])| {
            ends += joint_distance(&pair[0], &pair[1]);
            let here = directions[i];
            let corner = directions
                .get(i + 1)
                .map_or(0.0, |next| 0.6 * CYCLE_S * least(&kind.acceleration_radps2, &|k| next[k] - here[k]));
            let speed = least(&kind.speed_radps, &|k| here[k]);
            WayPiece { ends, speed, acceleration: least(&kind.acceleration_radps2, &|k| here[k]), corner }
        };
        let pieces = all.windows(2).enumerate().map(piece).collect();
        WayRun { way, pieces, along: 0.0, speed: 0.0 }
    }

    /// Whether the arm stands at the end of the path.
    pub fn is_over(&self) -> bool {
        self.speed.abs() < 1e-3 && self.along >= self.way.length_rad() - 1e-3
    }

    /// Whether the arm stands.
    pub fn stands(&self) -> bool {
        self.speed.abs() < 1e-3
    }

    /// The configuration `rad` radians farther along the path.
    pub fn farther(&self, rad: f64) -> Joints {
        self.way.at_rad((self.along + rad).min(self.way.length_rad()))
    }

    /// The next second: forwards (1), to a stand (0), or back (-1).
    pub fn ahead(&self, wanted: f64) -> RunAhead {
        let length = self.way.length_rad();
        let (mut along, mut speed) = (self.along, self.speed);
        let (mut steps, mut first) = ([self.way.at_rad(along); HORIZON], (along, speed));
        for (k, step) in steps.iter_mut().enumerate() {
            for tick in 0..TICKS {
                let left_s = (STANDS_BY * TICKS).saturating_sub(k * TICKS + tick) as f64 * TICK_S;
                let piece = self.piece_at(along, wanted);
                let most = self.most(along, wanted).min(piece.acceleration * left_s);
                let change = piece.acceleration * TICK_S;
                speed += (wanted * most - speed).clamp(-change, change);
                along = (along + speed * TICK_S).clamp(0.0, length);
                if (along <= 0.0 && speed < 0.0) || (along >= length && speed > 0.0) {
                    speed = 0.0;
                }
            }
            *step = self.way.at_rad(along);
            if k == 0 {
                first = (along, speed);
            }
        }
        RunAhead { plan: ArmPlan { steps }, along: first.0, speed: first.1 }
    }

    /// Records that the arm moves by the first step of this second.
    pub fn take(&mut self, ahead: &RunAhead) {
        (self.along, self.speed) = (ahead.along, ahead.speed);
    }

    fn piece_at(&self, along: f64, wanted: f64) -> WayPiece {
        let is_here = |p: &&WayPiece| if wanted < 0.0 { along <= p.ends } else { along < p.ends };
        let still = WayPiece { ends: 0.0, speed: 0.0, acceleration: 1.0, corner: 0.0 };
        self.pieces.iter().find(is_here).or(self.pieces.last()).copied().unwrap_or(still)
    }

    /// The greatest speed here from which every corner ahead, and the end, can be taken.
    fn most(&self, along: f64, wanted: f64) -> f64 {
        let here = self.piece_at(along, wanted);
        let brakes = |to: f64, corner: f64, by: f64| (corner * corner + 2.0 * by * to.abs()).sqrt();
        let corners = self.pieces.iter();
        let ahead = corners.filter(|p| if wanted < 0.0 { p.ends < along } else { p.ends >= along });
        let most =
            ahead.map(|p| brakes(p.ends - along, p.corner, 0.8 * here.acceleration.min(p.acceleration)));
        let to_begin = if wanted < 0.0 { brakes(along, 0.0, 0.8 * here.acceleration) } else { f64::INFINITY };
        most.fold(here.speed, f64::min).min(to_begin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::ArmSpace;
    use nalgebra::Isometry3;

    const A: Joints = [0.0, -1.3, 1.7, -1.97, -1.57, 0.0];

    fn run() -> WayRun {
        let kind = ArmKind::collaborative().clone();
        let mut b = A;
        b[0] = 1.5;
        let mut c = b;
        c[1] = -1.0;
        let space = ArmSpace {
            kind: kind.clone(),
            base: Isometry3::identity(),
            obstacles: Vec::new(),
            floor_m: -2.0,
            low_rad: kind.low_rad,
            high_rad: kind.high_rad,
        };
        WayRun::new(&kind, space.check(vec![A, b, c]).expect("nothing is in the way"))
    }

    /// Follows a run; gives the configurations at its cycles.
    fn followed(run: &mut WayRun, wanted: f64, cycles: usize) -> Vec<Joints> {
        let step = |_| {
            let ahead = run.ahead(wanted);
            run.take(&ahead);
            ahead.plan.steps[0]
        };
        (0..cycles).map(step).collect()
    }

    #[test]
    fn it_comes_to_the_end_within_the_arms_limits_and_stands_there() {
        let mut run = run();
        let kind = ArmKind::collaborative();
        let mut all = vec![A, A];
        all.extend(followed(&mut run, 1.0, 60));
        assert!(run.is_over() && (all[all.len() - 1][1] + 1.0).abs() < 1e-2);
        for w in all.windows(3) {
            for (k, most) in kind.acceleration_radps2.iter().enumerate() {
                let (before, after) = ((w[1][k] - w[0][k]) / CYCLE_S, (w[2][k] - w[1][k]) / CYCLE_S);
                assert!(after.abs() <= kind.speed_radps[k] + 1e-9);
                let acceleration = (after - before).abs() / CYCLE_S;
                assert!(acceleration <= 1.3 * most, "{k}: {acceleration}");
            }
        }
    }

    #[test]
    fn it_stands_soon_and_goes_back_the_way_it_came() {
        let mut run = run();
        followed(&mut run, 1.0, 8);
        assert!(!run.stands());
        let there = followed(&mut run, 0.0, 6)[5];
        assert!(run.stands() && there[0] > 0.3 && there[0] < 1.5);
        followed(&mut run, -1.0, 30);
        assert_eq!(run.farther(0.0), A);
        assert!(run.stands() && !run.is_over());
    }

    #[test]
    fn a_second_that_nothing_newer_follows_ends_at_a_stand() {
        let mut run = run();
        followed(&mut run, 1.0, 6);
        let steps = run.ahead(1.0).plan.steps;
        let last = joint_distance(&steps[STANDS_BY], &steps[HORIZON - 1]) / CYCLE_S;
        assert!(last < 0.05, "{last}");
    }
}

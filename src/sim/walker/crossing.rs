//! How a walker takes account of robots that are about to cross its path: it slows down, or waits until they are past.
//!
//! Refuses: to wait for long, since a robot may wait for the walker; a walker that ignores robots, or hurries and is
//! through first, does not wait at all.

use super::legs::{RobotNear, STANDS_MPS, WalkerSurroundings};
use super::person::BODY_M;
use super::persona::Persona;
use super::{Walker, WalkerDoing};
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};

/// Room that a walker likes to have between its body and a robot that drives past, metres.
const COMFORT_M: f64 = 0.3;
/// How far a walker looks along its path, metres.
const AHEAD_M: f64 = 3.0;
/// A walker considers robots that cross its path within this time, seconds.
const SOON_S: f64 = 3.5;
/// A slower walker stands, metres per second.
const CREEPS_MPS: f64 = 0.25;
/// How long a walker waits in total, and for how long it then does not wait again.
const WAITS: Span = Span::from_secs(6);
const NO_MORE: Span = Span::from_secs(8);
/// Factor on its usual speed that a hurrying walker counts on.
const HURRY: f64 = 1.3;

/// Where and when the paths of a walker and a robot cross.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Metres to walk until the walker comes near the robot's path, and until it has left it behind.
    enters_m: f64,
    leaves_m: f64,
    /// Seconds until the robot is where the two ways meet, and until it has left.
    comes_s: f64,
    gone_s: f64,
}

impl Crossing {
    /// The crossing of a robot's path and a straight one from `at`; nothing if they do not meet ahead of both, or the
    /// walker is in the robot's path already.
    fn of(robot: &RobotNear, at: Point, way: Vector) -> Option<Crossing> {
        let speed = robot.velocity.norm();
        if speed < 2.0 * STANDS_MPS {
            return None;
        }
        let drives = robot.velocity / speed;
        // How much a step of the walker leads across the robot's path.
        let across = drives.perp(&way);
        if across.abs() < 0.3 {
            return None;
        }
        let d = at - robot.at;
        let reach = robot.half_m * (drives.x.abs() + drives.y.abs()) + BODY_M + COMFORT_M;
        let off = drives.perp(&d);
        let (near, far) =
            ((-reach * across.signum() - off) / across, (reach * across.signum() - off) / across);
        if near <= 0.0 || near > AHEAD_M {
            return None;
        }
        let along = |m: f64| d.dot(&drives) + m * way.dot(&drives);
        let (first, last) = (along(near).min(along(far)), along(near).max(along(far)));
        let (comes_s, gone_s) = ((first - reach) / speed, (last + reach) / speed);
        let soon = gone_s > 0.0 && comes_s < SOON_S;
        soon.then_some(Crossing { enters_m: near, leaves_m: far, comes_s, gone_s })
    }
}

impl Walker {
    /// The speed at which the walker lets robots pass that are about to cross its path, metres per second.
    pub(super) fn pace_for_robots(
        &mut self,
        now: Time,
        dt: f64,
        wanted: f64,
        around: &WalkerSurroundings<'_>,
    ) -> f64 {
        let Some(aim) = self.legs.route.front() else { return wanted };
        let way = aim - self.legs.at;
        let heedless =
            self.traits.persona == Persona::CutsThrough || matches!(self.doing, WalkerDoing::Work(..));
        if heedless || wanted <= 0.0 || way.norm() <= 0.0 || now < self.waits_no_more_until {
            return wanted;
        }
        let (length, straight) = (way.norm(), way.normalize());
        let mut pace = wanted;
        for robot in around.robots {
            let crossing = Crossing::of(robot, self.legs.at, straight);
            let Some(c) = crossing.filter(|c| c.enters_m < length) else { continue };
            let hurries = self.traits.persona == Persona::Hurries;
            let fast = if hurries { wanted.max(HURRY * self.traits.speed_mps) } else { wanted };
            let through = c.leaves_m / fast < c.comes_s;
            let behind = c.enters_m / wanted > c.gone_s;
            match () {
                () if behind => {}
                () if through => pace = pace.max(fast),
                () => pace = pace.min(c.enters_m / c.gone_s),
            }
        }
        if pace >= CREEPS_MPS {
            self.waited = (self.waited - Span::from_secs_f64(0.5 * dt)).max(Span::ZERO);
            return pace;
        }
        self.waited += Span::from_secs_f64(dt);
        if self.waited > WAITS {
            (self.waited, self.waits_no_more_until) = (Span::ZERO, now + NO_MORE);
        }
        0.0
    }
}

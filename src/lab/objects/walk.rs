//! How a simulated person walks to where an object can be reached: a bent path, and a body that turns along it.
//!
//! Main type: [`RoomWalk`]. All random values are drawn when the walk is made; from then on it is a function of time.
//! Refuses: straight ways; a person who is already there steps aside.

use super::room::Stance;
use giveway_sim::picker::motion::minimum_jerk;
use giveway_sim::random::Stream;

/// Ways shorter than this are steps aside: the body does not turn along them, metres.
const STEP_M: f64 = 0.6;
/// Mean speed of a person of usual pace, metres per second.
const SPEED_MPS: f64 = 1.2;
/// Time that starting and stopping take, seconds.
const STARTS_S: f64 = 0.4;
/// Steps per second of both feet while walking.
const STEPS_HZ: f64 = 1.8;

/// A walk from one stance to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoomWalk {
    from: Stance,
    bend: (f64, f64),
    to: Stance,
    begins_s: f64,
    takes_s: f64,
    sway: f64,
}

/// The angle from −π to π.
pub(super) fn wrapped(angle: f64) -> f64 {
    libm::atan2(libm::sin(angle), libm::cos(angle))
}

/// Interpolates between two directions, the short way round.
fn turned(from: f64, to: f64, share: f64) -> f64 {
    from + wrapped(to - from) * share
}

impl RoomWalk {
    /// A walk that begins at `begins_s` seconds; `aside_m` is how far the middle of the path is off the straight line,
    /// to the left positive.
    pub fn new(
        from: Stance,
        to: Stance,
        begins_s: f64,
        pace: f64,
        aside_m: f64,
        chance: &mut Stream,
    ) -> RoomWalk {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let length = libm::hypot(dx, dy);
        let aside = if length < STEP_M { 0.1 * aside_m } else { aside_m } / length.max(0.05);
        let bend = (0.5 * (from.x + to.x) - 2.0 * aside * dy, 0.5 * (from.y + to.y) + 2.0 * aside * dx);
        let bent = length + 2.0 * (aside * length).powi(2) / length.max(0.05);
        let takes_s = pace * (STARTS_S + bent / SPEED_MPS) * libm::exp(0.08 * chance.normal());
        RoomWalk { from, bend, to, begins_s, takes_s, sway: chance.between(0.0, std::f64::consts::TAU) }
    }

    /// When the walk ends, seconds.
    pub fn ends_s(&self) -> f64 {
        self.begins_s + self.takes_s
    }

    /// Share of the path, and its change per second.
    fn share(&self, t_s: f64) -> (f64, f64) {
        let s = ((t_s - self.begins_s) / self.takes_s).clamp(0.0, 1.0);
        (s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / self.takes_s)
    }

    /// The body's stance at a time.
    pub fn at(&self, t_s: f64) -> Stance {
        let (s, rate) = self.share(t_s);
        let along = |a: f64, b: f64, c: f64| (1.0 - s) * (1.0 - s) * a + 2.0 * s * (1.0 - s) * b + s * s * c;
        let slope = |a: f64, b: f64, c: f64| 2.0 * (1.0 - s) * (b - a) + 2.0 * s * (c - b);
        let (vx, vy) =
            (slope(self.from.x, self.bend.0, self.to.x), slope(self.from.y, self.bend.1, self.to.y));
        let (dx, dy) = (self.to.x - self.from.x, self.to.y - self.from.y);
        let heading = if libm::hypot(dx, dy) < STEP_M {
            turned(self.from.heading, self.to.heading, minimum_jerk(s))
        } else {
            // The straight path decides which way round the body turns, so that it never jumps.
            let straight = self.from.heading + wrapped(libm::atan2(dy, dx) - self.from.heading);
            let ahead = straight + wrapped(libm::atan2(vy, vx) - straight);
            let end = straight + wrapped(self.to.heading - straight);
            let leaves = self.from.heading + (ahead - self.from.heading) * minimum_jerk(s / 0.3);
            leaves + (end - leaves) * minimum_jerk((s - 0.6) / 0.4)
        };
        let speed = rate * libm::hypot(vx, vy);
        let sway = 0.015 * speed.min(1.2) * libm::sin(std::f64::consts::PI * STEPS_HZ * t_s + self.sway);
        let (sin, cos) = (libm::sin(heading), libm::cos(heading));
        Stance {
            x: along(self.from.x, self.bend.0, self.to.x) - sway * sin,
            y: along(self.from.y, self.bend.1, self.to.y) + sway * cos,
            heading,
        }
    }

    /// Speed of the body, metres per second.
    pub fn speed_mps(&self, t_s: f64) -> f64 {
        let (a, b) = (self.at(t_s - 0.02), self.at(t_s + 0.02));
        libm::hypot(b.x - a.x, b.y - a.y) / 0.04
    }

    /// How far the free arm swings forward, metres.
    pub fn swing_m(&self, t_s: f64) -> f64 {
        let phase = std::f64::consts::PI * STEPS_HZ * t_s + self.sway;
        0.12 * self.speed_mps(t_s).min(1.2) * libm::sin(phase)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_turn_without_jumps_wherever_they_face() {
        for k in 0..60 {
            let mut chance = Stream::new(1, 2, k);
            let mut any = || Stance {
                x: chance.between(-1.5, 1.5),
                y: chance.between(-1.5, 1.5),
                heading: chance.between(-4.0, 4.0),
            };
            let walk = RoomWalk::new(any(), any(), 0.0, 1.0, 0.5, &mut Stream::new(2, 2, k));
            for i in 0..500 {
                let (a, b) = (walk.at(f64::from(i) / 120.0), walk.at(f64::from(i + 1) / 120.0));
                assert!((a.heading - b.heading).abs() < 0.15, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_walk_begins_and_ends_where_it_should_and_nobody_runs() {
        let from = Stance { x: 0.0, y: 0.0, heading: 2.0 };
        let to = Stance { x: 2.0, y: 1.0, heading: -1.0 };
        let walk = RoomWalk::new(from, to, 1.0, 1.0, 0.3, &mut Stream::new(1, 1, 1));
        let (first, last) = (walk.at(0.0), walk.at(walk.ends_s() + 1.0));
        assert!(libm::hypot(first.x, first.y) < 1e-9 && first.heading == 2.0);
        assert!(libm::hypot(last.x - 2.0, last.y - 1.0) < 1e-9);
        assert!(wrapped(last.heading + 1.0).abs() < 1e-9);
        let speeds = (0..400).map(|k| walk.speed_mps(0.5 + f64::from(k) * 0.01));
        let fastest = speeds.fold(0.0, f64::max);
        assert!((0.8..2.2).contains(&fastest), "{fastest}");
        let middle = walk.at(0.5 * (1.0 + walk.ends_s()));
        let off = (middle.y * 2.0 - middle.x) / libm::sqrt(5.0);
        assert!(off > 0.2, "the way is bent to the left: {off}");
    }
}

//! The published safe spaces in figures, beside the distances that robots keep here; and the answers to the four cases.
//!
//! Main functions: [`spaces`], [`answers`]. The formulas are those of [`giveway_people::aware::safe_space`], which the
//! fleet uses itself: this only puts numbers in. Refuses: the published tables of planning times and path lengths,
//! which are about another search on another floor (and two of the three are pictures).

use giveway_floor::route::Kinematics;
use giveway_floor::time::{Span, Time, Window};
use giveway_people::aware::Regions;
use giveway_people::aware::safe_space::{Adaptation, Case, StoppingTimes, Zone};
use giveway_people::human::BODY_M;

/// Speeds in the table, metres per second.
pub const SPEEDS_MPS: [f64; 5] = [0.3, 0.5, 0.7, 1.0, 1.5];
/// Standard deviation of a headset's position, metres.
const SIGMA_M: f64 = 0.02;

/// Distances at one speed, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// Speed of the robot, metres per second.
    pub speed_mps: f64,
    /// Whether the robot carries a rack.
    pub loaded: bool,
    /// Reaction time T_r and braking time T_s.
    pub times: StoppingTimes,
    /// Distance walked, equation 4.
    pub walked_m: f64,
    /// Distance driven while reacting, equation 7.
    pub reacting_m: f64,
    /// Distance driven while braking, equation 8.
    pub stopping_m: f64,
    /// Radius of the worker's safe space.
    pub worker_m: f64,
    /// Radius of the construction robot's safe space.
    pub robot_m: f64,
    /// Our distance between the centres at which a robot of this speed must begin to brake for a person who stands.
    pub stop_m: f64,
    /// Our distance between the centres at which it must begin to brake if the person walks on towards it.
    pub separation_m: f64,
}

/// The table for one kind of robot, `footprint_m` wide, in a fleet that decides every `period_s`.
pub fn spaces(kinematics: Kinematics, footprint_m: f64, period_s: f64) -> Vec<Space> {
    let regions = Regions::new(kinematics, footprint_m, period_s);
    let circle_m = footprint_m * std::f64::consts::FRAC_1_SQRT_2;
    let space = |loaded: bool, speed_mps: f64| {
        let times = regions.times(speed_mps, loaded);
        let bodies_m = BODY_M + footprint_m / 2.0;
        Space {
            speed_mps,
            loaded,
            times,
            walked_m: times.walked_m(),
            reacting_m: times.reacting_m(speed_mps),
            stopping_m: times.stopping_m(speed_mps),
            worker_m: times.worker_m(),
            robot_m: times.robot_m(speed_mps, circle_m),
            stop_m: regions.stop_radius_at_m(speed_mps, loaded, SIGMA_M),
            separation_m: bodies_m + regions.separation_m(speed_mps, loaded, SIGMA_M),
        }
    };
    [false, true].into_iter().flat_map(|l| SPEEDS_MPS.map(|v| space(l, v))).collect()
}

/// A zone with its answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answered {
    /// When the robot is there, and when the worker.
    pub zone: Zone,
    /// The case of the zone.
    pub case: Case,
    /// The published answer.
    pub published: Adaptation,
    /// Our answer.
    pub ours: Adaptation,
}

/// All four cases, also with equal times; a robot may be delayed by `slack`.
pub fn answers(slack: Span) -> Vec<Answered> {
    let window = |a: f64, b: f64| Window::new(Time::from_secs_f64(a), Time::from_secs_f64(b));
    let worker = window(10.0, 12.0);
    let robots = [(6.0, 9.0), (8.0, 10.0), (13.0, 15.0), (12.0, 14.0)].into_iter();
    let robots =
        robots.chain([(9.5, 11.0), (9.5, 13.0), (5.0, 13.0), (10.0, 12.0), (10.5, 11.5), (11.0, 13.0)]);
    let zones = robots.map(|(a, b)| Zone { robot: window(a, b), worker });
    zones
        .map(|zone| Answered {
            zone,
            case: zone.case(),
            published: zone.published(slack),
            ours: zone.answer(slack),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_safe_spaces_touch_lies_beyond_where_robots_brake_for_who_stands() {
        for s in spaces(Kinematics::default(), 0.9, 0.1) {
            assert!(s.worker_m + s.robot_m > s.stop_m, "{s:?}");
            // Walking and braking are the same in both: the difference is constant, arms and distance against bodies
            // and doubt.
            let constant = s.worker_m + s.robot_m - s.separation_m;
            let arms = 0.89 + 0.9 * std::f64::consts::FRAC_1_SQRT_2 + 0.5;
            assert!((constant - (arms - (0.25 + 0.45 + 0.04 + 0.1))).abs() < 1e-9, "{s:?}");
        }
    }

    #[test]
    fn the_samples_show_every_case() {
        let cases: std::collections::BTreeSet<Case> =
            answers(Span::from_secs(3)).iter().map(|a| a.case).collect();
        assert_eq!(cases.len(), 4);
    }
}

//! Safe spaces of workers and robots, and how a robot adapts if its plan and a worker's share a place.
//!
//! Main types: [`StoppingTimes`] (how long a robot takes to react and to stop), [`Zone`] (a potential collision zone),
//! [`Case`], [`Adaptation`]. Source: Ye, Guo, Guo and Luo 2024, "A construction robot path planning method based on
//! safe space and worker trajectory prediction", equations 3 to 8 and the decision model of section 3.4. Read with its
//! errata: 1.78 m is an arm span, so the radius of the circle is half of it; the texts of cases 1 and 2 are swapped
//! (there the *robot* has left before the worker comes, and the worker before the robot); "and" between the orders of
//! times means "or"; equal times, which no case covers, are those of half-open windows here. Refuses: to know where a
//! worker or a robot is, and to be a safety function.

use crate::human::WALK_MPS;
use giveway_floor::time::{Span, Time, Window};

/// Arm span of a standing man, the 90th percentile, metres (GB/T 13547-92, as quoted by Ye et al.).
pub const ARM_SPAN_M: f64 = 1.78;
/// The least distance between a worker and a robot that work together, metres (ISO 10218-2, as quoted there).
pub const APART_M: f64 = 0.5;

/// Reaction and braking times of a robot, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoppingTimes {
    /// Time from a worker being seen to the brakes: T_r.
    pub react_s: f64,
    /// Time from the brakes to a stand: T_s.
    pub stop_s: f64,
}

impl StoppingTimes {
    /// How far a worker walks during both times, metres (Ye et al., equation 4).
    pub fn walked_m(self) -> f64 {
        WALK_MPS * (self.react_s + self.stop_s)
    }

    /// How far a robot drives at `v` before it brakes, metres (equation 7).
    pub fn reacting_m(self, v: f64) -> f64 {
        v * self.react_s
    }

    /// How far a robot at speed `v` drives while it brakes evenly, metres (equation 8).
    pub fn stopping_m(self, v: f64) -> f64 {
        0.5 * v * self.stop_s
    }

    /// Radius of a worker's safe space, metres: the reach of the arms, plus walking (section 3.3.1).
    pub fn worker_m(self) -> f64 {
        ARM_SPAN_M / 2.0 + self.walked_m()
    }

    /// Radius of a robot's safe space at speed `v`, metres: the circle around a robot of this half width, the least
    /// distance, and braking (section 3.3.1).
    pub fn robot_m(self, v: f64, circle_m: f64) -> f64 {
        circle_m + APART_M + self.reacting_m(v) + self.stopping_m(v)
    }
}

/// A place in the plans of a robot and of a worker, with the window of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Zone {
    /// The robot's window, from `t_p` to `t_q`.
    pub robot: Window,
    /// The worker's window, from `t_i` to `t_j`.
    pub worker: Window,
}

/// Which of the two is in a zone first, and whether they meet: the four cases of Ye et al. (2024).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Case {
    /// 1: the robot has left when the worker comes, `t_q ≤ t_i`.
    RobotBefore,
    /// 2: the worker has left when the robot comes, `t_j ≤ t_p`.
    WorkerBefore,
    /// 3: they meet, and the robot is there first, `t_p < t_i`.
    RobotFirst,
    /// 4: they meet, and the worker is there first or both come at once, `t_i ≤ t_p`.
    WorkerFirst,
}

/// How the robot adapts to a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Adaptation {
    /// Keep the route and the speed.
    Keep,
    /// Keep the route, but arrive no sooner than this.
    Slow(Time),
    /// Look for another route.
    Change,
}

impl Zone {
    /// Whether robot and worker would meet.
    pub fn meets(self) -> bool {
        self.robot.overlaps(self.worker)
    }

    /// The case of this zone.
    pub fn case(self) -> Case {
        let (robot, worker) = (self.robot, self.worker);
        if robot.end() <= worker.start() {
            Case::RobotBefore
        } else if worker.end() <= robot.start() {
            Case::WorkerBefore
        } else if robot.start() < worker.start() {
            Case::RobotFirst
        } else {
            Case::WorkerFirst
        }
    }

    /// Delay of the robot that lets the worker through.
    pub fn delay(self) -> Span {
        self.worker.end() - self.robot.start()
    }

    /// The published decision: slower only if the worker is first, and if the delay is at most `slack`.
    pub fn published(self, slack: Span) -> Adaptation {
        match self.case() {
            Case::RobotBefore | Case::WorkerBefore => Adaptation::Keep,
            Case::RobotFirst => Adaptation::Change,
            Case::WorkerFirst => self.later(slack),
        }
    }

    /// Our decision: slower wherever that is enough. A robot that would be first can let the worker through as well,
    /// and reaches its goal sooner than by most other routes.
    pub fn answer(self, slack: Span) -> Adaptation {
        match self.case() {
            Case::RobotBefore | Case::WorkerBefore => Adaptation::Keep,
            Case::RobotFirst | Case::WorkerFirst => self.later(slack),
        }
    }

    fn later(self, slack: Span) -> Adaptation {
        if self.delay() > slack { Adaptation::Change } else { Adaptation::Slow(self.worker.end()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn safe_spaces_are_those_of_equations_4_7_and_8() {
        let times = StoppingTimes { react_s: 0.5, stop_s: 2.0 };
        assert!(near(times.walked_m(), 1.6 * 2.5), "equation 4");
        assert!(near(times.reacting_m(1.0), 0.5), "equation 7");
        assert!(near(times.stopping_m(1.0), 1.0), "equation 8");
        assert!(near(times.worker_m(), 0.89 + 4.0), "half of 1.78 m, and walking");
        assert!(near(times.robot_m(1.0, 0.4), 0.4 + 0.5 + 0.5 + 1.0));
    }

    #[test]
    fn equations_7_and_8_are_the_integrals_5_and_6_of_even_speed_and_even_braking() {
        let (times, v, steps) = (StoppingTimes { react_s: 0.3, stop_s: 1.5 }, 1.2, 100_000);
        let dt = (times.react_s + times.stop_s) / f64::from(steps);
        let speed = |t: f64| v * (1.0 - ((t - times.react_s) / times.stop_s).max(0.0));
        let driven: f64 = (0..steps).map(|i| speed((f64::from(i) + 0.5) * dt) * dt).sum();
        assert!((driven - times.reacting_m(v) - times.stopping_m(v)).abs() < 1e-6, "{driven}");
    }

    fn zone(robot: (i64, i64), worker: (i64, i64)) -> Zone {
        let window = |(a, b): (i64, i64)| Window::new(Time(a), Time(b));
        Zone { robot: window(robot), worker: window(worker) }
    }

    #[test]
    fn the_four_cases_are_told_apart_also_where_times_are_equal() {
        for (robot, worker, case) in [
            ((0, 4), (6, 9), Case::RobotBefore),
            ((0, 6), (6, 9), Case::RobotBefore),
            ((9, 12), (5, 8), Case::WorkerBefore),
            ((8, 12), (5, 8), Case::WorkerBefore),
            ((3, 7), (5, 9), Case::RobotFirst),
            ((3, 12), (5, 9), Case::RobotFirst),
            ((3, 9), (5, 9), Case::RobotFirst),
            ((6, 8), (5, 9), Case::WorkerFirst),
            ((6, 12), (5, 9), Case::WorkerFirst),
            ((5, 9), (5, 9), Case::WorkerFirst),
            ((5, 12), (5, 9), Case::WorkerFirst),
        ] {
            assert_eq!(zone(robot, worker).case(), case, "{robot:?} {worker:?}");
        }
    }

    /// All pairs of windows within a few instants.
    fn all() -> impl Iterator<Item = Zone> {
        let windows = (0..7).flat_map(|a| (a + 1..8).map(move |b| (a, b)));
        windows.clone().flat_map(move |robot| windows.clone().map(move |worker| zone(robot, worker)))
    }

    #[test]
    fn a_route_is_kept_exactly_where_nobody_is_met() {
        for z in all() {
            let shared = (0..8).any(|t| z.robot.contains(Time(t)) && z.worker.contains(Time(t)));
            assert_eq!((z.meets(), z.answer(Span(2)) != Adaptation::Keep), (shared, shared), "{z:?}");
            assert_eq!(z.published(Span(2)) != Adaptation::Keep, shared, "{z:?}");
        }
    }

    #[test]
    fn ours_differs_from_the_published_answer_only_where_the_robot_is_first_and_the_worker_soon_through() {
        for z in all() {
            let slack = Span(3);
            let differs = z.case() == Case::RobotFirst && z.delay() <= slack;
            assert_eq!(z.answer(slack) != z.published(slack), differs, "{z:?}");
        }
    }

    #[test]
    fn who_slows_down_comes_when_the_worker_is_through_and_not_too_late() {
        for z in all() {
            let Adaptation::Slow(from) = z.answer(Span(3)) else { continue };
            let stay = z.robot.end() - z.robot.start();
            assert!(!Zone { robot: Window::new(from, from + stay), ..z }.meets(), "{z:?}");
            assert!(from - z.robot.start() <= Span(3), "{z:?}");
        }
    }
}

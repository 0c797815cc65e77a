//! How robots spend their time, and what the standing ones wait for: how a floor loses deliveries.
//!
//! Main types: [`RobotTime`], [`TimeUse`]. Refuses: to suggest improvements.

use giveway_fleet::{Activity, Edge, Fleet, Party, Why};
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;

/// A robot's activity at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUse {
    /// The robot drives.
    Drives,
    /// The robot lifts a rack, sets it down, or stands at a station or in its queue.
    AtWork,
    /// The robot gives way to a worker.
    GivesWay,
    /// The robot waits for a robot that waits for a worker, over any number of robots.
    BehindOneThatGivesWay,
    /// The robot waits for robots of which none waits for a worker.
    WaitsForRobots,
    /// The robot has not found a route, and no worker is known to be the reason.
    NoRoute,
    /// The robot waits outside its station, and no worker is ultimately the reason.
    StationFull,
    /// The robot has nothing to do, charges, or is out of order.
    Other,
}

impl TimeUse {
    /// All activities.
    pub const ALL: [TimeUse; 8] = [
        TimeUse::Drives,
        TimeUse::AtWork,
        TimeUse::GivesWay,
        TimeUse::BehindOneThatGivesWay,
        TimeUse::WaitsForRobots,
        TimeUse::NoRoute,
        TimeUse::StationFull,
        TimeUse::Other,
    ];

    /// The activity's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            TimeUse::Drives => "drives",
            TimeUse::AtWork => "at_work",
            TimeUse::GivesWay => "gives_way",
            TimeUse::BehindOneThatGivesWay => "behind_one_that_gives_way",
            TimeUse::WaitsForRobots => "waits_for_robots",
            TimeUse::NoRoute => "no_route",
            TimeUse::StationFull => "station_full",
            TimeUse::Other => "other",
        }
    }

    /// A robot's activity in its last step.
    fn of(fleet: &Fleet, robot: RobotId, now: Time) -> TimeUse {
        match fleet.activity(robot, now).0 {
            Activity::Driving => TimeUse::Drives,
            Activity::Handling | Activity::Queueing | Activity::Picking => TimeUse::AtWork,
            Activity::Waiting => TimeUse::of_waiting(fleet, robot),
            Activity::Idle
            | Activity::Charging
            | Activity::Paused
            | Activity::Stopped
            | Activity::OutOfService
            | Activity::Failed
            | Activity::Offline
            | Activity::Gone => TimeUse::Other,
        }
    }

    fn of_waiting(fleet: &Fleet, robot: RobotId) -> TimeUse {
        if let Some(Why::GivesWay(_)) = fleet.why(robot) {
            return TimeUse::GivesWay;
        }
        let mut at = Party::Robot(robot);
        let (mut steps, mut last) = (0, fleet.why(robot));
        // A circle of waiting is no longer than the fleet.
        while let Edge::On(next) = fleet.wait(at).edge
            && steps <= fleet.ledger().robots.len()
        {
            match next {
                Party::Worker(_) => return TimeUse::BehindOneThatGivesWay,
                Party::Robot(r) => last = fleet.why(r),
            }
            (at, steps) = (next, steps + 1);
        }
        match last {
            Some(Why::GivesWay(_)) => TimeUse::BehindOneThatGivesWay,
            Some(Why::NoRoute) => TimeUse::NoRoute,
            _ if fleet.why(robot).is_some_and(|why| why.station().is_some()) => TimeUse::StationFull,
            _ if steps > 0 => TimeUse::WaitsForRobots,
            _ => TimeUse::Other,
        }
    }
}

/// How often robots were seen at each activity.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RobotTime {
    seen: [u64; TimeUse::ALL.len()],
    /// Sum of all speeds of robots seen driving, millimetres per second.
    speeds_mmps: u64,
}

impl RobotTime {
    /// Adds one look at all robots of a fleet.
    pub fn look(&mut self, fleet: &Fleet, now: Time) {
        for robot in fleet.ledger().present() {
            let time_use = TimeUse::of(fleet, robot, now);
            self.seen[time_use as usize] += 1;
            let speed_mps = fleet.telemetry(robot).map_or(0.0, |t| t.speed_mps);
            if time_use == TimeUse::Drives {
                self.speeds_mmps += (speed_mps * 1000.0) as u64;
            }
        }
    }

    /// The sum over several runs.
    pub fn of_runs<'a>(runs: impl Iterator<Item = &'a RobotTime>) -> RobotTime {
        let mut all = RobotTime::default();
        for run in runs {
            all.seen.iter_mut().zip(run.seen).for_each(|(sum, n)| *sum += n);
            all.speeds_mmps += run.speeds_mmps;
        }
        all
    }

    /// Mean speed of driving robots, metres per second; nothing if none drives.
    pub fn mean_mps(&self) -> Option<f64> {
        let driving = self.seen[TimeUse::Drives as usize];
        (driving > 0).then(|| self.speeds_mmps as f64 / 1000.0 / driving as f64)
    }

    /// Share of all robots' time spent on this activity; nothing if there are no robots.
    pub fn share(&self, time_use: TimeUse) -> Option<f64> {
        let all: u64 = self.seen.iter().sum();
        (all > 0).then(|| self.seen[time_use as usize] as f64 / all as f64)
    }
}

//! What robots spend their time on, and what those wait for that stand: how a floor loses deliveries.
//!
//! Main types: [`RobotTime`], [`TimeUse`]. Refuses: to say what would be better.

use giveway_fleet::{Activity, Edge, Fleet, Party, Why};
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;

/// What a robot spends a moment on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUse {
    /// It drives.
    Drives,
    /// It lifts a rack, sets it down, or stands at a station or in its queue.
    AtWork,
    /// It gives way to a worker.
    GivesWay,
    /// It waits for a robot that waits for a worker, over any number of robots.
    BehindOneThatGivesWay,
    /// It waits for robots of which none waits for a worker.
    WaitsForRobots,
    /// It has not found a route, and no worker is known to be the reason.
    NoRoute,
    /// It waits outside its station, and no worker is the reason in the end.
    StationFull,
    /// It has nothing to do, charges, or is out of order.
    Other,
}

impl TimeUse {
    /// All of them.
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

    /// The word for it in reports.
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

    /// What a robot of a fleet spent its last step on.
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
        // A circle of waiting is shorter than the fleet.
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

/// How often robots were seen at what.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RobotTime {
    seen: [u64; TimeUse::ALL.len()],
    /// The sum of all speeds of those seen driving, millimetres per second.
    speeds_mmps: u64,
}

impl RobotTime {
    /// Looks at all robots of a fleet.
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

    /// The same of several runs.
    pub fn of_runs<'a>(runs: impl Iterator<Item = &'a RobotTime>) -> RobotTime {
        let mut all = RobotTime::default();
        for run in runs {
            all.seen.iter_mut().zip(run.seen).for_each(|(sum, n)| *sum += n);
            all.speeds_mmps += run.speeds_mmps;
        }
        all
    }

    /// How fast robots drive on average, metres per second; nothing where none drives.
    pub fn mean_mps(&self) -> Option<f64> {
        let driving = self.seen[TimeUse::Drives as usize];
        (driving > 0).then(|| self.speeds_mmps as f64 / 1000.0 / driving as f64)
    }

    /// What share of all robots' time went to this; nothing where there are no robots.
    pub fn share(&self, time_use: TimeUse) -> Option<f64> {
        let all: u64 = self.seen.iter().sum();
        (all > 0).then(|| self.seen[time_use as usize] as f64 / all as f64)
    }
}

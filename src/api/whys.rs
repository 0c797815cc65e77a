//! Why jobs and robots do not go on, and why jobs failed, in words.
//!
//! Adds these questions to [`Names`]. `web/src/language/said/` has each sentence in other languages. Refuses: to find
//! out why; the fleet does.

use super::dto::Names;
use super::text::{closure_name, hand_words, job_name, worker_name};
use crate::alarm::displacement_words;
use crate::fleet::{JobFailure, JobWhy, JobsAhead, RobotView, Why};
use crate::id::{Dense, RobotId};
use crate::warehouse::NodeKind;

impl Names<'_> {
    /// Why a job does not go on, in words.
    pub fn why_job(&self, why: JobWhy) -> String {
        let rack = |r| self.map.racks.get(r).map_or_else(|| format!("{r:?}"), |rack| rack.name.clone());
        let station = |s| self.map.stations.get(s).map_or_else(|| format!("{s:?}"), |s| s.name.clone());
        match why {
            JobWhy::After(job) => format!("waiting for {} to be over", job_name(job)),
            JobWhy::RackBusy(k, r, _) if self.trouble(r).is_some() => {
                let is_on = self.view.robots.get(r.ix()).is_some_and(|robot| robot.rack == Some(k));
                let at = if is_on { "which is on" } else { "which was to be fetched by" };
                format!("waiting for rack {}, {at} {}", rack(k), self.with_trouble(r))
            }
            JobWhy::RackBusy(k, r, Some(job)) => {
                format!("waiting for rack {}, which {} moves for {}", rack(k), self.robot(r), job_name(job))
            }
            JobWhy::RackBusy(k, r, None) => {
                format!("waiting for rack {}, which {} brings back to storage", rack(k), self.robot(r))
            }
            JobWhy::RobotBusy(r, Some(job)) => {
                format!("waiting for {}, which works on {}", self.robot(r), job_name(job))
            }
            JobWhy::RobotBusy(r, None) => {
                format!("waiting for {}, which is on its way somewhere", self.robot(r))
            }
            JobWhy::NoRobot => "no robot is free".into(),
            JobWhy::Outranked(ahead) => format!("no robot is free; jobs ahead: {}", ahead_words(ahead)),
            JobWhy::NoKind => "no robot of a kind that can do this job has joined".into(),
            JobWhy::StationFull(s) => {
                format!("waiting for room at {}: a robot stands in every place", station(s))
            }
            JobWhy::RacksWait(s, r) => {
                let (station, robot) = (station(s), self.robot(r));
                format!(
                    "waiting for room at {station}: enough racks wait for it already, first that on {robot}"
                )
            }
            JobWhy::StationPaused(s) => format!("waiting for {} to resume: it is paused", station(s)),
            JobWhy::ClosedOff => "waiting for a closed or obstructed place at its rack or destination".into(),
            JobWhy::StationBlocked(s, r) => {
                format!(
                    "waiting for the way to or from {}, on which stands {}",
                    station(s),
                    self.with_trouble(r)
                )
            }
            JobWhy::WayBlocked(r) => {
                format!(
                    "waiting for the only way to its rack or destination, on which stands {}",
                    self.with_trouble(r)
                )
            }
            JobWhy::WayClosed(c) => {
                let area = closure_name(c);
                format!("waiting for closed area {area} to open: it cuts the rack off from its destination")
            }
            JobWhy::RackBlocked(k, r) => {
                format!("waiting for rack {}, beneath which stands {}", rack(k), self.with_trouble(r))
            }
            JobWhy::NoPlace(NodeKind::Charger) => "waiting for a charger: all are taken or closed".into(),
            JobWhy::NoPlace(_) => "waiting for a parking place: all are taken or closed".into(),
            JobWhy::RobotLow(r) => format!("waiting for {} to charge", self.robot(r)),
            JobWhy::Robot(r, why) => match self.view.robots.get(r.ix()) {
                Some(robot) => format!("{}: {}", robot.name, self.why_of(robot, why)),
                None => self.why(why),
            },
        }
    }

    /// What is wrong with a robot itself, if something is.
    fn trouble(&self, r: RobotId) -> Option<Why> {
        self.view.robots.get(r.ix())?.why.filter(|why| why.is_by_itself())
    }

    /// A robot, with what is wrong with it.
    fn with_trouble(&self, r: RobotId) -> String {
        let robot = self.view.robots.get(r.ix());
        let trouble = robot.and_then(|robot| Some(self.why_of(robot, self.trouble(r)?)));
        self.robot(r) + &trouble.map(|words| format!(" ({words})")).unwrap_or_default()
    }

    /// Why a robot does not go on, in words, with what becomes of its rack.
    pub fn why_of(&self, robot: &RobotView, why: Why) -> String {
        let rack = robot.rack.and_then(|r| self.map.racks.get(r));
        match (why, rack) {
            (Why::Failed, Some(rack)) => {
                let name = &rack.name;
                format!(
                    "cannot drive, and has rack {name} on it: repair it, or push it onto a free node; or set the rack \
                     down in storage by hand and say where with POST /v1/racks/{name}/taken"
                )
            }
            _ => self.why(why),
        }
    }

    /// Why a robot does not go on, in words.
    pub fn why(&self, why: Why) -> String {
        match why {
            Why::WaitsFor(resource, r) => {
                format!("waiting for {}, held by {}", self.map.resource_name(resource), self.robot(r))
            }
            Why::GivesWay(w) => format!("giving way to worker {}", worker_name(w)),
            Why::Closed(c) => format!("the way leads into closed area {}", closure_name(c)),
            Why::QueueFull(s) => match self.map.stations.get(s) {
                Some(station) => format!("the queue of station {} is full", station.name),
                None => "the queue of its station is full".into(),
            },
            Why::NotItsTurn(s, r) => match self.map.stations.get(s) {
                Some(station) => {
                    format!(
                        "waiting for its turn at station {}: before it comes {}",
                        station.name,
                        self.robot(r)
                    )
                }
                None => format!("waiting for its turn at its station: before it comes {}", self.robot(r)),
            },
            Why::StationPaused(s) => {
                let station = self.map.stations.get(s).map_or("its station", |s| s.name.as_str());
                format!("waiting for {station} to resume: it is paused")
            }
            Why::HandInOpening(s) => hand_words(self.map.stations.get(s)),
            Why::NoRoute => "no route found yet; trying again".into(),
            Why::Failed => {
                "cannot drive: repair it, push it onto a free node, or take it off the floor".into()
            }
            Why::EmergencyStop => {
                "stopped: its emergency stop is pressed; release it when the way is clear".into()
            }
            Why::Manual => "driven by hand: it goes on by itself once it is left on a free node".into(),
            Why::Obstructed(n) => {
                let node = self.map.nodes.get(n).map_or("the next node", |n| n.name.as_str());
                format!(
                    "cannot pass: something stands on its way to {node}; clear the way; the robot looks for another"
                )
            }
            Why::WayObstructed(n) => {
                let node = self.node(n);
                format!("waiting for {node} to be cleared: a robot reported that something stands there")
            }
            Why::Unplugged => "gets no current from its charger: check the plug and the charger".into(),
            Why::Displaced(displacement) => displacement_words(self.map, |r| self.robot(r), displacement),
            Why::BlockedBy(r) => {
                format!("waiting for {} to be repaired or moved out of its way", self.robot(r))
            }
            Why::Silent => "no telemetry".into(),
            Why::Paused => PAUSED.into(),
            Why::Maintenance => "in maintenance".into(),
            Why::Leaving => "leaves the floor: switch it off before you take it away".into(),
            Why::Gone => "has left the floor".into(),
            Why::Stopped => "stopped with the whole fleet".into(),
            Why::Evacuation => "stands while the building is evacuated".into(),
        }
    }

    /// Why a job failed, in words; `gone` is what a place was called that the map no longer has.
    pub fn why_failed(&self, why: JobFailure, gone: Option<String>) -> String {
        match why {
        JobFailure::Predecessor(job) => {
            format!("{}, which had to be over first, was cancelled or failed", job_name(job))
        }
        JobFailure::Unreachable => "no route leads there, even on an empty floor".into(),
        JobFailure::Short => "the station reported that goods were missing".into(),
        JobFailure::NoPlaceAside => {
            "robots want one another's places, and no free place is left at which one of them could make room"
                .into()
        }
        JobFailure::RobotGone => "the robot that it names has left the floor".into(),
        JobFailure::MapChanged => "the map was changed and no longer has what this job names".into(),
        JobFailure::StorageTaken(node) => {
            let node = gone.unwrap_or_else(|| self.node(node));
            format!("{node} has another rack, or is reserved for one: the rack was put elsewhere")
        }
    }
    }
}

/// Who is before a job, in words.
fn ahead_words(JobsAhead { higher, others, more }: JobsAhead) -> String {
    match (higher, others) {
        _ if more => format!("{} or more", higher + others),
        (_, 0) => format!("{higher} of higher priority"),
        (0, _) => format!("{others} older or due sooner"),
        _ => format!("{higher} of higher priority and {others} older or due sooner"),
    }
}

/// What a robot says that was paused; pages go by it.
const PAUSED: &str = "paused by hand";

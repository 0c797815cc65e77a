//! What waits for what, in names and words.
//!
//! Main types: [`WhyDto`], [`LinkDto`]. Refuses: to add knowledge of its own.

use super::dto::Names;
use super::port::WaitChain;
use super::text::{closure_name, job_name, round3, time_text, worker_name};
use crate::fleet::{Act, Because, JobWhy, Waiting, Who, Why};
use crate::id::Dense;
use crate::time::Time;
use crate::timeline::Holder;
use serde::Serialize;
use utoipa::ToSchema;

/// Why a robot or a job does not go on.
#[derive(Debug, Serialize, ToSchema)]
pub struct WhyDto {
    /// The robot or the job.
    #[schema(example = "robot-1")]
    pub id: String,
    /// Whether it waits at all.
    pub waiting: bool,
    /// When this was so, RFC 3339.
    pub at: String,
    /// The whole chain in one sentence.
    #[schema(example = "robot-1 waits for R33, held by robot-2; robot-2 is being picked from.")]
    pub text: String,
    /// From the robot or job that waits to the root cause: all other links depend on the last one.
    pub chain: Vec<LinkDto>,
}

/// One link of the chain.
#[derive(Debug, PartialEq, Serialize, ToSchema)]
pub struct LinkDto {
    /// The robot, the job or the worker.
    #[schema(example = "robot-1")]
    pub who: String,
    /// robot, job or worker.
    pub kind: &'static str,
    /// What the link is about: resource, queue, person, closure, route, failed, emergency_stop, manual, obstructed,
    /// unplugged, displaced, silent, job, rack, robot, no_robot, station, closed, blocked, place, battery; or, for a
    /// robot that waits for nothing, stop, drives, later, stays; for a worker, robot, no_way, walks, stands, lost.
    pub cause: &'static str,
    /// In words, without the name of the robot or job.
    #[schema(example = "waits for R33, held by robot-2")]
    pub text: String,
    /// Node or lane that is waited for.
    #[schema(example = "R33")]
    pub resource: Option<String>,
    /// What holds it, or what the link is about: a robot, worker, job, closure or station.
    #[schema(example = "robot-2")]
    pub by: Option<String>,
    /// robot, worker, job, closure or station.
    pub by_kind: Option<&'static str>,
    /// How many others pass first.
    pub ahead: usize,
    /// Until when, as things stand, RFC 3339; null if that cannot be known.
    pub until: Option<String>,
    /// The same in seconds from `at`.
    pub until_s: Option<f64>,
}

impl Names<'_> {
    /// A chain.
    pub fn chain(&self, id: String, waits: &WaitChain) -> WhyDto {
        let chain: Vec<LinkDto> = waits.what.iter().map(|w| self.link(w, waits.at)).collect();
        let waiting = waits.what.first().is_some_and(|w| w.because.is_waiting());
        let parts: Vec<String> = chain.iter().map(|l| format!("{} {}", l.who, l.text)).collect();
        let text = if parts.is_empty() { "Nothing waits.".into() } else { parts.join("; ") + "." };
        WhyDto { id, waiting, at: time_text(waits.at), text, chain }
    }

    fn link(&self, waiting: &Waiting, at: Time) -> LinkDto {
        let (who, kind) = match waiting.who {
            Who::Robot(r) => (self.robot(r), "robot"),
            Who::Job(j) => (job_name(j), "job"),
            Who::Worker(w) => (worker_name(w), "worker"),
        };
        let link = |cause, by: Option<(String, &'static str)>, text: String| {
            let (by, by_kind) = by.unzip();
            let until = waiting.until.map(time_text);
            let until_s = waiting.until.map(|t| round3((t - at).as_secs_f64()));
            LinkDto {
                who,
                kind,
                cause,
                text,
                resource: None,
                by,
                by_kind,
                ahead: waiting.ahead,
                until,
                until_s,
            }
        };
        match waiting.because {
            Because::Robot(why) => {
                let (cause, by) = self.about(why);
                let resource = match why {
                    Why::WaitsFor(r, _) => Some(self.map.resource_name(r)),
                    _ => None,
                };
                let text = self.why_of_party(waiting.who, why);
                LinkDto { resource, ..link(cause, by, active(&text)) }
            }
            Because::Job(why) => {
                let (cause, by) = match why {
                    JobWhy::After(j) => ("job", Some((job_name(j), "job"))),
                    JobWhy::RackBusy(_, r, _) => ("rack", Some((self.robot(r), "robot"))),
                    JobWhy::RobotBusy(r, _) | JobWhy::Robot(r, _) => {
                        ("robot", Some((self.robot(r), "robot")))
                    }
                    JobWhy::NoRobot | JobWhy::NoKind => ("no_robot", None),
                    JobWhy::StationFull(s) | JobWhy::StationPaused(s) | JobWhy::StationBlocked(s, _) => {
                        let name = self.map.stations.get(s).map(|s| (s.name.clone(), "station"));
                        ("station", name)
                    }
                    JobWhy::ClosedOff => ("closed", None),
                    JobWhy::RackBlocked(_, r) | JobWhy::WayBlocked(r) => {
                        ("blocked", Some((self.robot(r), "robot")))
                    }
                    JobWhy::NoPlace(_) => ("place", None),
                    JobWhy::RobotLow(r) => ("battery", Some((self.robot(r), "robot"))),
                };
                link(cause, by, active(&self.why_job(why)))
            }
            Because::AtStop(act) => link("stop", None, at_stop(act).into()),
            Because::Drives => link("drives", None, "drives on and then frees it".into()),
            Because::Later => link("later", None, "goes on as planned".into()),
            Because::Stays => link("stays", None, "stands where it may stay".into()),
            Because::Walks => link("walks", None, "walks on, or is at work".into()),
            Because::InTheWay(r) => {
                let by = self.robot(r);
                let text = format!("waits for {by}, which is in the way");
                link("robot", Some((by, "robot")), text)
            }
            Because::NoWay => link("no_way", None, "was told to stop: there is no way on".into()),
            Because::Stands => link("stands", None, "stands, and may walk on or not".into()),
            Because::Lost => link("lost", None, "cannot be placed: the headset has lost its place".into()),
        }
    }

    /// Why a robot does not go on, in words.
    fn why_of_party(&self, who: Who, why: Why) -> String {
        let robot = match who {
            Who::Robot(r) => self.view.robots.get(r.ix()),
            Who::Job(_) | Who::Worker(_) => None,
        };
        robot.map_or_else(|| self.why(why), |robot| self.why_of(robot, why))
    }

    fn about(&self, why: Why) -> (&'static str, Option<(String, &'static str)>) {
        match why {
            Why::WaitsFor(_, Holder::Robot(r)) => ("resource", Some((self.robot(r), "robot"))),
            Why::WaitsFor(_, Holder::Worker(w)) => ("resource", Some((worker_name(w), "worker"))),
            Why::GivesWay(w) => ("person", Some((worker_name(w), "worker"))),
            Why::Closed(c) => ("closure", Some((closure_name(c), "closure"))),
            Why::QueueFull(s) => ("queue", self.map.stations.get(s).map(|s| (s.name.clone(), "station"))),
            Why::NoRoute => ("route", None),
            Why::Failed => ("failed", None),
            Why::EmergencyStop => ("emergency_stop", None),
            Why::Manual => ("manual", None),
            Why::Obstructed(_) | Why::WayObstructed(_) => ("obstructed", None),
            Why::Unplugged => ("unplugged", None),
            Why::Displaced(_) => ("displaced", None),
            Why::BlockedBy(r) => ("robot", Some((self.robot(r), "robot"))),
            Why::Silent => ("silent", None),
            Why::Paused => ("paused", None),
            Why::Maintenance => ("maintenance", None),
            Why::Leaving | Why::Gone => ("leaving", None),
            Why::Stopped => ("stopped", None),
            Why::Evacuation => ("evacuation", None),
        }
    }
}

/// What a robot does at a stop, in words.
fn at_stop(act: Act) -> &'static str {
    match act {
        Act::Lift(_) => "is lifting its rack",
        Act::Set(_) => "is setting its rack down",
        Act::Pick(_) => "is being picked from",
        Act::Arrive => "has arrived",
    }
}

/// The reason as a predicate: "waiting for …" becomes "waits for …".
fn active(text: &str) -> String {
    for (from, to) in [
        ("waiting for ", "waits for "),
        ("giving way to ", "gives way to "),
        ("no robot is free", "waits for a robot: none is free"),
        ("no route found yet; trying again", "has found no route yet and tries again"),
        ("no telemetry", "sends no telemetry"),
        ("driven by hand", "is driven by hand"),
        ("in maintenance", "is in maintenance"),
        ("no robot of a kind", "waits for a robot: none of a kind"),
        ("paused", "is paused"),
        ("stopped", "is stopped"),
        ("stands while the building", "stands while the building"),
        ("the way leads into ", "stands before "),
        ("the queue of ", "waits outside: the queue of "),
    ] {
        if let Some(rest) = text.strip_prefix(from) {
            return format!("{to}{rest}");
        }
    }
    text.to_owned()
}

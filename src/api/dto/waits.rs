//! Wait chains on the wire, in names and words.
//!
//! Main types: [`WhyDto`], [`LinkDto`]. Refuses: to add knowledge of its own.

use crate::dto::names::Names;
use crate::port::questions::WaitChain;
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::{closure_name, job_name, round3, time_text, worker_name};
use crate::wire::words::{WaitCauseDto as About, WaitedKindDto as By, WaiterKindDto};
use giveway_fleet::{Act, Because, JobWhy, Waiting, Who, Why};
use giveway_floor::id::Dense;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::reasons;
use giveway_floor::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// Why a robot or a job does not go on.
#[derive(Debug, Serialize, ToSchema)]
pub struct WhyDto {
    /// The robot or the job.
    #[schema(example = "robot-1")]
    pub id: String,
    /// Whether the robot or job waits at all.
    pub waiting: bool,
    /// The time at which this was so, RFC 3339.
    pub at: String,
    /// The whole chain in one sentence in English: the texts of its links.
    #[schema(example = "robot-1 waits for R33, held by robot-2; robot-2 is being picked from.")]
    pub text: String,
    /// The links from the waiting robot or job to the root cause: every link depends on the next one.
    pub chain: Vec<LinkDto>,
}

/// One link of the chain.
#[derive(Debug, PartialEq, Serialize, ToSchema)]
pub struct LinkDto {
    /// The robot, job or worker.
    #[schema(example = "robot-1")]
    pub who: String,
    /// Whether `who` is a robot, a job or a worker.
    pub kind: WaiterKindDto,
    /// What the link is about.
    pub cause: About,
    /// The link in words, without the name of the robot, job or worker.
    #[schema(value_type = SentenceSchema)]
    pub text: Sentence,
    /// The node or lane that is waited for.
    #[schema(example = "R33")]
    pub resource: Option<String>,
    /// What holds the resource, or what the link is about: a robot, worker, job, closure or station.
    #[schema(example = "robot-2")]
    pub by: Option<String>,
    /// Whether `by` is a robot, worker, job, closure or station.
    pub by_kind: Option<By>,
    /// How many others pass first.
    pub ahead: usize,
    /// When the wait is expected to end, RFC 3339; null if that cannot be known.
    pub until: Option<String>,
    /// Seconds from `at` until the wait is expected to end.
    pub until_s: Option<f64>,
}

impl Names<'_> {
    /// A wait chain on the wire.
    pub fn chain(&self, id: String, waits: &WaitChain) -> WhyDto {
        let chain: Vec<LinkDto> = waits.what.iter().map(|w| self.link(w, waits.at)).collect();
        let waiting = waits.what.first().is_some_and(|w| w.because.is_waiting());
        let parts: Vec<String> = chain.iter().map(|l| format!("{} {}", l.who, l.text)).collect();
        let text = if parts.is_empty() { "Nothing waits.".into() } else { parts.join("; ") + "." };
        WhyDto { id, waiting, at: time_text(waits.at), text, chain }
    }

    fn link(&self, waiting: &Waiting, at: Time) -> LinkDto {
        let (who, kind) = match waiting.who {
            Who::Robot(r) => (self.robot(r), WaiterKindDto::Robot),
            Who::Job(j) => (job_name(j), WaiterKindDto::Job),
            Who::Worker(w) => (worker_name(w), WaiterKindDto::Worker),
        };
        let link = |cause, by: Option<(String, By)>, text: Sentence| {
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
                LinkDto { resource, ..link(cause, by, text) }
            }
            Because::Job(why) => {
                let (cause, by) = self.about_job(why);
                link(cause, by, self.why_job(why))
            }
            Because::AtStop(act) => link(About::Stop, None, at_stop(act)),
            Because::Drives => link(About::Drives, None, reasons::drives_on()),
            Because::Later => link(About::Later, None, reasons::goes_on_as_planned()),
            Because::Stays => link(About::Stays, None, reasons::stays()),
            Because::Walks => link(About::Walks, None, reasons::walks()),
            Because::InTheWay(r) => {
                let by = self.robot(r);
                let text = reasons::robot_in_the_way(&by);
                link(About::Robot, Some((by, By::Robot)), text)
            }
            Because::NoWay => link(About::NoWay, None, reasons::told_to_stop()),
            Because::Stands => link(About::Stands, None, reasons::person_stands()),
            Because::Lost => link(About::Lost, None, reasons::person_lost()),
        }
    }

    fn about_job(&self, why: JobWhy) -> (About, Option<(String, By)>) {
        match why {
            JobWhy::After(j) => (About::Job, Some((job_name(j), By::Job))),
            JobWhy::RackBusy(_, r, _) => (About::Rack, Some((self.robot(r), By::Robot))),
            JobWhy::RobotBusy(r, _) | JobWhy::Robot(r, _) => (About::Robot, Some((self.robot(r), By::Robot))),
            JobWhy::NoRobot | JobWhy::Outranked(_) | JobWhy::NoKind => (About::NoRobot, None),
            JobWhy::StationFull(s) | JobWhy::StationPaused(s) | JobWhy::StationBlocked(s, _) => {
                let name = self.map.stations.get(s).map(|s| (s.name.clone(), By::Station));
                (About::Station, name)
            }
            JobWhy::RacksWait(_, r) => (About::Turn, Some((self.robot(r), By::Robot))),
            JobWhy::ClosedOff => (About::Closed, None),
            JobWhy::WayClosed(c) => (About::Closure, Some((closure_name(c), By::Closure))),
            JobWhy::RackBlocked(_, r) | JobWhy::NodeTaken(_, r) | JobWhy::WayBlocked(r) => {
                (About::Blocked, Some((self.robot(r), By::Robot)))
            }
            JobWhy::NoPlace(_) => (About::Place, None),
            JobWhy::RobotLow(r) => (About::Battery, Some((self.robot(r), By::Robot))),
        }
    }

    /// Why a robot, job or worker does not go on, in words.
    fn why_of_party(&self, who: Who, why: Why) -> Sentence {
        let robot = match who {
            Who::Robot(r) => self.view.robots.get(r.ix()),
            Who::Job(_) | Who::Worker(_) => None,
        };
        robot.map_or_else(|| self.why(why), |robot| self.why_of(robot, why))
    }

    fn about(&self, why: Why) -> (About, Option<(String, By)>) {
        match why {
            Why::WaitsFor(_, r) => (About::Resource, Some((self.robot(r), By::Robot))),
            Why::GivesWay(w) => (About::Person, Some((worker_name(w), By::Worker))),
            Why::Closed(c) => (About::Closure, Some((closure_name(c), By::Closure))),
            Why::QueueFull(s) => {
                (About::Queue, self.map.stations.get(s).map(|s| (s.name.clone(), By::Station)))
            }
            Why::NotItsTurn(_, r) => (About::Turn, Some((self.robot(r), By::Robot))),
            Why::StationPaused(s) => {
                (About::Station, self.map.stations.get(s).map(|s| (s.name.clone(), By::Station)))
            }
            Why::HandInOpening(s) => {
                (About::Person, self.map.stations.get(s).map(|s| (s.name.clone(), By::Station)))
            }
            Why::NoRoute => (About::Route, None),
            Why::Failed => (About::Failed, None),
            Why::EmergencyStop => (About::EmergencyStop, None),
            Why::Manual => (About::Manual, None),
            Why::Obstructed(_) | Why::WayObstructed(_) => (About::Obstructed, None),
            Why::Unplugged => (About::Unplugged, None),
            Why::Displaced(_) => (About::Displaced, None),
            Why::BlockedBy(r) => (About::Robot, Some((self.robot(r), By::Robot))),
            Why::Silent => (About::Silent, None),
            Why::Refused => (About::Refused, None),
            Why::Paused => (About::Paused, None),
            Why::Maintenance => (About::Maintenance, None),
            Why::Leaving | Why::Gone => (About::Leaving, None),
            Why::Stopped => (About::Stopped, None),
            Why::Evacuation => (About::Evacuation, None),
        }
    }
}

/// What a robot does at a stop.
fn at_stop(act: Act) -> Sentence {
    match act {
        Act::Lift(_) => reasons::lifts(),
        Act::Set(_) => reasons::sets_down(),
        Act::Pick(_) => reasons::is_picked_from(),
        Act::Arrive => reasons::has_arrived(),
    }
}

//! Jobs: what a customer wants, and how far it has come.
//!
//! Main types: [`JobKind`], [`JobRequest`], [`JobChange`], [`Job`], [`JobState`]. Refuses: to know how a job is carried
//! out.

use super::job_kind::JobKind;
use super::keys::ClientKey;
use giveway_cell::{Lines, OrderLine};
use giveway_floor::id::{BodyId, JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};

/// A station at which a rack is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Visiting {
    /// The station.
    pub station: StationId,
    /// How long the pick takes; the station's usual time where absent.
    pub pick: Option<Span>,
}

/// A job as a customer submits it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobRequest {
    /// What is wanted; of a delivery to several stations, the delivery to the next one.
    pub kind: JobKind,
    /// The stations that the rack goes on to from there, in this order; for deliveries only.
    pub then: Vec<Visiting>,
    /// Priority, from 0 (whenever there is time) to 9 (before all others).
    pub priority: u8,
    /// When the job should be done.
    pub deadline: Option<Time>,
    /// Jobs that must be done first.
    pub after: Vec<JobId>,
    /// The customer's own key: the same key never makes a second job.
    pub key: Option<ClientKey>,
    /// The customer's own text, for people and for finding the job again. Nothing is decided by it.
    pub reference: Option<String>,
    /// The customer's own labels by key. Nothing is decided by them.
    pub labels: BTreeMap<String, String>,
    /// What is to be picked at each station of a delivery, in the order in which the stations were submitted; empty if
    /// no station has lines.
    pub lines: Vec<Vec<OrderLine>>,
}

impl Hash for JobRequest {
    fn hash<H: Hasher>(&self, to: &mut H) {
        let JobRequest { kind, then, priority, deadline, after, key, reference, labels, lines } = self;
        (kind, then, priority, deadline, after, key, reference, labels).hash(to);
        // Digests of recordings without lines stay what they were.
        if !lines.is_empty() {
            lines.hash(to);
        }
    }
}

impl JobRequest {
    /// A request for this, whenever there is time for it.
    pub fn new(kind: JobKind) -> JobRequest {
        let (then, after, labels, lines) = (Vec::new(), Vec::new(), BTreeMap::new(), Vec::new());
        JobRequest {
            kind,
            then,
            priority: 0,
            deadline: None,
            after,
            key: None,
            reference: None,
            labels,
            lines,
        }
    }

    /// Whether robots of a kind can do the job with its rack on a node, at all of its stations.
    pub fn is_for(&self, w: &Warehouse, body: BodyId, rack: (RackId, NodeId)) -> bool {
        let reaches = |v: &Visiting| w.may_be_at(body, w.stations[v.station].node);
        self.kind.is_for(w, body, rack) && self.then.iter().all(reaches)
    }

    /// The stations at which the rack is still wanted, in their order.
    pub fn stations(&self) -> impl Iterator<Item = Visiting> {
        let next = match self.kind {
            JobKind::Deliver { station, pick, .. } => Some(Visiting { station, pick }),
            _ => None,
        };
        next.into_iter().chain(self.then.iter().copied())
    }
}

/// Which robots may do a job for a rack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RobotChoice {
    /// Any robot that can.
    #[default]
    Any,
    /// Any robot except this one, from which the job was taken, until this time.
    Except(RobotId, Time),
    /// This robot, as an operator wants, until this time: if it cannot, others do the job.
    Only(RobotId, Time),
}

impl RobotChoice {
    /// Whether a robot may do the job.
    pub fn allows(&self, robot: RobotId, now: Time) -> bool {
        match *self {
            RobotChoice::Any => true,
            RobotChoice::Except(other, until) => robot != other || until <= now,
            RobotChoice::Only(chosen, until) => robot == chosen || until <= now,
        }
    }
}

/// What is to be changed about a waiting job; a field that holds nothing stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct JobChange {
    /// The new priority, 0 to 9.
    pub priority: Option<u8>,
    /// When the job should be done; an inner nothing removes the deadline.
    pub deadline: Option<Option<Time>>,
    /// The station at which the job's rack is wanted.
    pub station: Option<StationId>,
    /// The robot that has to do the job.
    pub robot: Option<RobotId>,
}

/// How far a job has come. `Waiting → Assigned → Carrying → Picking → Done`; [`super::life`] has the whole table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JobState {
    /// No robot has the job yet.
    Waiting,
    /// A robot is on its way to the rack, or to where it was sent.
    Assigned {
        /// The robot.
        robot: RobotId,
    },
    /// A robot carries the rack.
    Carrying {
        /// The robot.
        robot: RobotId,
    },
    /// The rack stands at the station.
    Picking {
        /// The robot under the rack.
        robot: RobotId,
    },
    /// Done.
    Done,
    /// The customer no longer wants the job. The jobs behind it fail.
    Cancelled,
    /// The job cannot be done.
    Failed(JobFailure),
}

/// Why a job cannot be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JobFailure {
    /// A job that this one was to come after was cancelled or failed.
    Predecessor(JobId),
    /// No way leads to where the job has to go, even on an empty floor.
    Unreachable,
    /// Another rack has come to stand on the storage node, or is promised it.
    StorageTaken(NodeId),
    /// The rack came to its station, but goods were missing.
    Short,
    /// Robots want one another's places, and there is no free place where one of them could make room.
    NoPlaceAside,
    /// The robot that the job names has left the floor.
    RobotGone,
    /// The map was changed, and no longer has a rack, a station or a node that the job names.
    MapChanged,
}

impl JobState {
    /// Whether nothing more will happen to the job.
    pub fn is_over(&self) -> bool {
        matches!(self, JobState::Done | JobState::Cancelled | JobState::Failed(_))
    }

    /// The robot that works on the job.
    pub fn robot(&self) -> Option<RobotId> {
        match *self {
            JobState::Assigned { robot } | JobState::Carrying { robot } | JobState::Picking { robot } => {
                Some(robot)
            }
            JobState::Waiting | JobState::Done | JobState::Cancelled | JobState::Failed(_) => None,
        }
    }

    /// The state's word on the wire.
    pub fn word(&self) -> &'static str {
        match self {
            JobState::Waiting => "waiting",
            JobState::Assigned { .. } => "assigned",
            JobState::Carrying { .. } => "carrying",
            JobState::Picking { .. } => "picking",
            JobState::Done => "done",
            JobState::Cancelled => "cancelled",
            JobState::Failed(_) => "failed",
        }
    }
}

/// A job with its state.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Job {
    /// What is wanted from now on: the request without the stations that were served.
    pub request: JobRequest,
    /// How far the job has come.
    pub state: JobState,
    /// When the job was accepted.
    pub accepted: Time,
    /// The stations that were served, and when the pick at each of them ended.
    pub served: Vec<(Visiting, Time)>,
    /// Which robots may do the job, if it is for a rack.
    pub choice: RobotChoice,
    /// How far the lines at each station are, in the order of [`JobRequest::lines`].
    pub lines: Vec<Lines>,
}

impl Job {
    /// A job that was just accepted.
    pub fn new(request: JobRequest, accepted: Time) -> Job {
        let (state, choice) = (JobState::Waiting, RobotChoice::Any);
        let lines = request.lines.iter().map(|lines| Lines::new(lines.iter().cloned())).collect();
        Job { request, state, accepted, served: Vec::new(), choice, lines }
    }

    /// The lines at the station where the job's rack is wanted now, if there are any.
    pub fn lines_now(&self) -> Option<&Lines> {
        self.lines.get(self.served.len()).filter(|lines| !lines.all().is_empty())
    }

    /// The lines at the station where the job's rack is wanted now, to be changed.
    pub fn lines_now_mut(&mut self) -> Option<&mut Lines> {
        self.lines.get_mut(self.served.len()).filter(|lines| !lines.all().is_empty())
    }

    /// Ends the pick at the station, after which the rack goes on to the next one. Returns the station that was served;
    /// if there is no next one, returns nothing and changes nothing.
    pub fn go_on(&mut self, robot: RobotId, at: Time) -> Option<StationId> {
        let JobKind::Deliver { rack, station, pick } = self.request.kind else { return None };
        if self.request.then.is_empty() {
            return None;
        }
        let next = self.request.then.remove(0);
        self.served.push((Visiting { station, pick }, at));
        self.request.kind = JobKind::Deliver { rack, station: next.station, pick: next.pick };
        self.state = JobState::Carrying { robot };
        Some(station)
    }

    /// The request as it was submitted, with the stations that were served since.
    pub fn submitted(&self) -> JobRequest {
        let visits: Vec<Visiting> =
            self.served.iter().map(|(v, _)| *v).chain(self.request.stations()).collect();
        let mut request = self.request.clone();
        if let (JobKind::Deliver { rack, .. }, Some((first, then))) = (request.kind, visits.split_first()) {
            request.kind = JobKind::Deliver { rack, station: first.station, pick: first.pick };
            request.then = then.to_vec();
        }
        request
    }
}

//! Requests about jobs: they are submitted and cancelled.
//!
//! Refuses: to give a job to a robot.

use crate::requests::intake::Intake;
use crate::state::fact::{JobFact, Purpose, Task};
use crate::state::floor::Floor;
use crate::state::job::{JobRequest, JobState};
use crate::state::job_kind::JobKind;
use crate::state::ledger::RackAt;
use crate::state::refusal::{Bounded, JobRefusal, PickRefusal, RackRefusal, Refusal, RobotRefusal};
use crate::state::request::{Answer, Answered, JobTaken, Made};
use giveway_floor::id::{Dense, JobId, RobotId, StationId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;

impl Intake<'_> {
    /// Accepts a job, whole or not at all; the same client key makes no second one.
    pub(super) fn submit(&mut self, request: JobRequest, now: Time) -> JobTaken {
        if let Some(job) = request.key.as_ref().and_then(|k| self.writer.ledger().keys.get(k)) {
            return Ok(Made { id: *job, new: false });
        }
        self.writer.floor().check_request(&request)?;
        if request.priority > 9 {
            return Err(Refusal::Job(JobRefusal::Priority(request.priority)));
        }
        if request.deadline.is_some_and(|deadline| deadline < now) {
            return Err(Refusal::Job(JobRefusal::DeadlineIsOver));
        }
        if request.after.len() > self.writer.settings.limits.after {
            return Err(Refusal::Job(JobRefusal::TooManyBefore(self.writer.settings.limits.after)));
        }
        if let Some(job) = request.after.iter().find(|j| j.0 == 0 || j.0 >= self.writer.ledger().next_job) {
            return Err(Refusal::Job(JobRefusal::UnknownPredecessor(*job)));
        }
        if self.writer.ledger().jobs.len() >= self.writer.settings.limits.open_jobs {
            return Err(Refusal::TooMany(Bounded::Jobs, self.writer.ledger().jobs.len()));
        }
        let job = JobId(self.writer.ledger().next_job);
        self.writer.record(JobFact::Accepted { job, request, at: now });
        Ok(Made { id: job, new: true })
    }

    /// Cancels a job at any stage: the job is over at once; a robot at work on it brings its rack to storage.
    pub(super) fn cancel(&mut self, job: JobId, now: Time) -> Answered {
        if job.0 == 0 || job.0 >= self.writer.ledger().next_job {
            return Err(Refusal::Job(JobRefusal::Unknown(job)));
        }
        let Some(record) = self.writer.ledger().jobs.get(&job) else {
            return Err(Refusal::Job(JobRefusal::IsOver(job)));
        };
        let tasked = record.state.robot().map(|robot| (robot, self.writer.floor().task_without_job(robot)));
        self.writer.progress(job, JobState::Cancelled, tasked, now);
        if let Some((robot, _)) = tasked {
            self.end_cancelled_pick(robot);
            self.heard.left_early.push(robot);
        }
        Ok(Answer::Done)
    }
}

impl Floor<'_> {
    /// Checks that everything that a job names exists, and that some robots can do the job at all of its stations.
    pub(super) fn check_request(&self, request: &JobRequest) -> Result<(), Refusal> {
        let w = self.warehouse();
        if request.then.iter().any(|v| v.station.ix() >= w.stations.len()) {
            return Err(Refusal::UnknownPlace);
        }
        let visits: Vec<StationId> = request.stations().map(|v| v.station).collect();
        if (!request.then.is_empty() && request.kind.station().is_none())
            || visits.windows(2).any(|pair| pair[0] == pair[1])
        {
            return Err(Refusal::Job(JobRefusal::SameStationTwice));
        }
        self.check_places(&request.kind)?;
        self.check_lines(request, visits)?;
        self.check_kinds(request)
    }

    /// Checks that each line can be picked at its station.
    fn check_lines(&self, request: &JobRequest, visits: Vec<StationId>) -> Result<(), Refusal> {
        if request.lines.is_empty() {
            return Ok(());
        }
        if request.lines.len() != visits.len() {
            return Err(Refusal::Pick(PickRefusal::LinesPerStation));
        }
        let Some(rack) = request.kind.rack() else { return Ok(()) };
        for (visit, (station, lines)) in visits.into_iter().zip(&request.lines).enumerate() {
            if let Some((line, problem)) = giveway_cell::problem(self.warehouse(), rack, station, lines) {
                return Err(Refusal::Pick(PickRefusal::CannotPick(visit, line, problem)));
            }
        }
        Ok(())
    }

    fn check_places(&self, kind: &JobKind) -> Result<(), Refusal> {
        let w = self.warehouse();
        let robot_known = |r: RobotId| r.ix() < self.ledger.robots.len();
        let gone = kind.robot().filter(|r| robot_known(*r) && self.ledger.robots[*r].is_gone());
        if let Some(robot) = gone {
            return Err(Refusal::Robot(RobotRefusal::IsGone(robot)));
        }
        if !kind.is_known(w, self.ledger.robots.len()) {
            return Err(Refusal::UnknownPlace);
        }
        if let Some(place) = kind.place().filter(|p| !w.nodes.iter().any(|n| n.kind == *p)) {
            return Err(Refusal::NoSuchPlace(place));
        }
        if let JobKind::Relocate { rack, node } = *kind {
            if w.nodes[node].kind != NodeKind::Storage {
                return Err(Refusal::Rack(RackRefusal::NotStorage(node)));
            }
            if self.storage_taken(node, rack) {
                return Err(Refusal::Rack(RackRefusal::StorageTaken(node)));
            }
        }
        Ok(())
    }

    /// Checks that some robot kind can do the job, or the kind of the robot that the customer names.
    fn check_kinds(&self, request: &JobRequest) -> Result<(), Refusal> {
        let w = self.warehouse();
        let kind = &request.kind;
        if let JobKind::Go { robot, node } = *kind
            && !self.may_be_at(robot, node)
        {
            return Err(Refusal::Robot(RobotRefusal::NotForKind(node)));
        }
        let Some(rack) = kind.rack() else { return Ok(()) };
        let node = match self.ledger.racks[rack] {
            RackAt::Stored(node) => node,
            RackAt::On(robot) => self.ledger.node_of(robot),
        };
        let fits = w.bodies().ids().any(|body| request.is_for(w, body, (rack, node)));
        if fits { Ok(()) } else { Err(Refusal::Rack(RackRefusal::NoKindFor(rack))) }
    }

    /// The task with which a robot goes on when its job is over before its task is: it brings its rack to storage, or
    /// goes to where it may stay.
    pub(super) fn task_without_job(&self, robot: RobotId) -> Task {
        match self.ledger.robots[robot].task {
            Task::Deliver { rack, store, .. } | Task::Store { rack, store, .. } => {
                Task::Store { job: None, rack, store }
            }
            // A robot that may already drive to the rack will lift it, and then puts it back.
            Task::Fetch { rack, node, .. } if self.next_stop_is_granted(robot) => {
                Task::Fetch { job: None, rack, node }
            }
            Task::Fetch { node, .. } => Task::rest_at(node, Purpose::Park),
            Task::Move { stay, purpose, .. } => Task::rest_at(stay, purpose),
            Task::Idle => Task::Idle,
        }
    }
}

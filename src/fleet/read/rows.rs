//! Jobs, assignments and encounters as listed, and queries for them.
//!
//! Main types: [`JobRow`], [`JobTimes`], [`AssignmentRow`], [`EncounterRow`], and a query for each. The store reads
//! them, a recording makes them from facts, and the API adds their names. Refuses: to know where they are stored.

use crate::state::job::{Job, JobState};
use crate::state::worker::{Assignment, Encounter};
use giveway_cell::LineChange;
use giveway_floor::id::{AssignmentId, JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::Time;
use std::collections::BTreeMap;

/// The words for the states of a job, in order of life.
pub const JOB_STATES: [&str; 7] =
    ["waiting", "assigned", "carrying", "picking", "done", "cancelled", "failed"];

/// A page of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed<T, I> {
    /// The rows of the page. There may be fewer than were asked for, or none, though the list goes on: a page looks at
    /// a limited number of rows that the filters leave out.
    pub rows: Vec<T>,
    /// Where the list goes on: before this row; nothing if it ends.
    pub next: Option<I>,
}

impl<T, I> Listed<T, I> {
    /// Makes a page of rows, of which there may be one more than the limit to show that the list goes on. If there are
    /// no more, the list goes on before `rest`.
    pub fn cut(mut rows: Vec<T>, limit: u32, rest: Option<I>, id: impl Fn(&T) -> I) -> Listed<T, I> {
        let is_full = rows.len() > limit as usize;
        rows.truncate(limit as usize);
        let next = if is_full { rows.last().map(id) } else { rest };
        Listed { rows, next }
    }
}

/// A job as it is listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobRow {
    /// The number of the job.
    pub id: JobId,
    /// What the job is and how far it has come.
    pub job: Job,
    /// The robot that works on the job, or the last one that did.
    pub robot: Option<RobotId>,
    /// When the job or its state last changed.
    pub updated: Time,
    /// When the job came to each state.
    pub times: JobTimes,
    /// Whether the job was changed after it was submitted.
    pub changed: bool,
    /// Names of what the job refers to and the map no longer has.
    pub gone: GoneNames,
}

impl JobRow {
    /// Changes a line of the visit in progress.
    pub fn change_line(&mut self, line: usize, change: LineChange, at: Time) {
        if let Some(lines) = self.job.lines_now_mut() {
            // The ledger has checked the change.
            _ = lines.change(line, change);
        }
        self.updated = at;
    }

    /// Notes that the job's rack was served at a station that is not its last.
    pub fn serve(&mut self, robot: RobotId, at: Time) {
        self.job.go_on(robot, at);
        (self.updated, self.times.arrived) = (at, None);
    }
}

/// When a job came to each state. If a robot gives it back, the times of that attempt are forgotten.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JobTimes {
    /// When a robot got the job.
    pub assigned: Option<Time>,
    /// When the robot had lifted the rack.
    pub lifted: Option<Time>,
    /// When the rack came to the station.
    pub arrived: Option<Time>,
    /// When the job was over: done, cancelled or failed.
    pub ended: Option<Time>,
}

impl JobTimes {
    /// Notes that the job has come to this state.
    pub fn note(&mut self, state: JobState, at: Time) {
        match state {
            JobState::Waiting => *self = JobTimes::default(),
            JobState::Assigned { .. } => *self = JobTimes { assigned: Some(at), ..JobTimes::default() },
            JobState::Carrying { .. } => (self.lifted, self.arrived) = (Some(at), None),
            JobState::Picking { .. } => self.arrived = Some(at),
            JobState::Done | JobState::Cancelled | JobState::Failed(_) => self.ended = Some(at),
        }
    }
}

/// The names of what a row refers to and the map no longer has.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GoneNames {
    /// The name of its rack.
    pub rack: Option<String>,
    /// The name of its station.
    pub station: Option<String>,
    /// The name of its node, or place.
    pub node: Option<String>,
    /// The names of the other stations of a delivery.
    pub stops: BTreeMap<StationId, String>,
}

/// Which jobs to list, newest first.
#[derive(Clone, Debug, Default)]
pub struct JobQuery {
    /// Only jobs in one of these states, by their words; in any if there are none.
    pub states: Vec<&'static str>,
    /// Only jobs of this rack.
    pub rack: Option<RackId>,
    /// Only jobs for this station.
    pub station: Option<StationId>,
    /// Only jobs that this robot has, or had last.
    pub robot: Option<RobotId>,
    /// Only jobs that changed at this time or later.
    pub updated_since: Option<Time>,
    /// Only jobs that were accepted at this time or later.
    pub from: Option<Time>,
    /// Only jobs that were accepted before this time.
    pub to: Option<Time>,
    /// Only jobs with this reference.
    pub reference: Option<String>,
    /// Only jobs whose reference contains this text of three or more characters, whatever the case.
    pub reference_part: Option<String>,
    /// Only jobs with this label: its key and value.
    pub label: Option<(String, String)>,
    /// Only jobs older than this one.
    pub before: Option<JobId>,
    /// How many jobs at most.
    pub limit: u32,
}

/// An assignment as it is listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssignmentRow {
    /// The number of the assignment.
    pub id: AssignmentId,
    /// What the assignment is and how far it has come.
    pub assignment: Assignment,
    /// When the assignment's state last changed.
    pub updated: Time,
    /// Names of what the assignment refers to and the map no longer has.
    pub gone: GoneNames,
}

/// Which assignments to list, newest first.
#[derive(Clone, Debug, Default)]
pub struct AssignmentQuery {
    /// Only assignments of this worker.
    pub worker: Option<WorkerId>,
    /// Only assignments in one of these states, by their words; in any if there are none.
    pub states: Vec<&'static str>,
    /// Only assignments at this place.
    pub place: Option<NodeId>,
    /// Only assignments whose state changed at this time or later.
    pub updated_since: Option<Time>,
    /// Only assignments that were accepted at this time or later.
    pub from: Option<Time>,
    /// Only assignments that were accepted before this time.
    pub to: Option<Time>,
    /// Only assignments older than this one.
    pub before: Option<AssignmentId>,
    /// How many assignments at most.
    pub limit: u32,
}

/// An encounter as it is listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncounterRow {
    /// The number of the encounter, in the order of recording.
    pub seq: i64,
    /// What happened. `worker` means nothing if the encounter is anonymous.
    pub encounter: Encounter,
    /// Whether the list no longer says who the worker was.
    pub is_anonymous: bool,
}

impl EncounterRow {
    /// The worker, if that is still known.
    pub fn worker(&self) -> Option<WorkerId> {
        (!self.is_anonymous).then_some(self.encounter.worker)
    }
}

/// Which encounters to list, newest first.
#[derive(Clone, Debug, Default)]
pub struct EncounterQuery {
    /// Only encounters that began at this time or later.
    pub from: Option<Time>,
    /// Only encounters that began before this time.
    pub to: Option<Time>,
    /// Only encounters of this worker.
    pub worker: Option<WorkerId>,
    /// Only encounters of this robot.
    pub robot: Option<RobotId>,
    /// Only encounters about which the fleet did one of these things, by their words; any if there are none.
    pub reactions: Vec<&'static str>,
    /// Only encounters that ended at this time or later: encounters are listed when they have ended.
    pub updated_since: Option<Time>,
    /// Only encounters recorded before this one.
    pub before: Option<i64>,
    /// How many encounters at most.
    pub limit: u32,
}

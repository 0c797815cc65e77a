//! Jobs, assignments and encounters as lists have them, and which of them are wanted.
//!
//! Main types: [`JobRow`], [`JobTimes`], [`AssignmentRow`], [`EncounterRow`], and a query for each. The store reads
//! them, a recording makes them from facts, and the API gives their names. Refuses: to know where they are kept.

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
    /// Its rows. There may be fewer than were asked for, or none, though the list goes on: a page looks at no more than
    /// so many rows that the filters leave out.
    pub rows: Vec<T>,
    /// The list goes on with what is before this; nothing where it ends.
    pub next: Option<I>,
}

impl<T, I> Listed<T, I> {
    /// Makes a page of rows, one more than it may have if there are so many. Where there are not, the list goes on
    /// before `rest`.
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
    /// Its number.
    pub id: JobId,
    /// What it is and how far it has come.
    pub job: Job,
    /// The robot at work on it, or the last one that was.
    pub robot: Option<RobotId>,
    /// When it or its state changed last.
    pub updated: Time,
    /// When it came to each state.
    pub times: JobTimes,
    /// Whether it was changed after it was submitted.
    pub changed: bool,
    /// Names of what it speaks of and the map no longer has.
    pub gone: GoneNames,
}

impl JobRow {
    /// Something was said about a line of the visit that is on.
    pub fn change_line(&mut self, line: usize, change: LineChange, at: Time) {
        if let Some(lines) = self.job.lines_now_mut() {
            // The ledger has checked it.
            _ = lines.change(line, change);
        }
        self.updated = at;
    }

    /// Its rack was served at a station that is not its last.
    pub fn serve(&mut self, robot: RobotId, at: Time) {
        self.job.go_on(robot, at);
        (self.updated, self.times.arrived) = (at, None);
    }
}

/// When a job came to each state. If a robot gives it back, the times of that attempt are forgotten.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JobTimes {
    /// A robot got it.
    pub assigned: Option<Time>,
    /// The robot had lifted the rack.
    pub lifted: Option<Time>,
    /// The rack stood at the station.
    pub arrived: Option<Time>,
    /// It was over: done, cancelled or failed.
    pub ended: Option<Time>,
}

impl JobTimes {
    /// The job has come to this state.
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

/// The names of what a row speaks of, where the map does not have it any more.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GoneNames {
    /// Of its rack.
    pub rack: Option<String>,
    /// Of its station.
    pub station: Option<String>,
    /// Of its node, or place.
    pub node: Option<String>,
    /// Of the other stations of a delivery.
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
    /// Only jobs whose reference has this in it, whatever the case; three characters or more.
    pub reference_part: Option<String>,
    /// Only jobs with this label: its key and value.
    pub label: Option<(String, String)>,
    /// Only jobs older than this one.
    pub before: Option<JobId>,
    /// How many at most.
    pub limit: u32,
}

/// An assignment as it is listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssignmentRow {
    /// Its number.
    pub id: AssignmentId,
    /// What it is and how far it has come.
    pub assignment: Assignment,
    /// When its state changed last.
    pub updated: Time,
    /// Names of what it speaks of and the map no longer has.
    pub gone: GoneNames,
}

/// Which assignments to list, newest first.
#[derive(Clone, Debug, Default)]
pub struct AssignmentQuery {
    /// Only those of this worker.
    pub worker: Option<WorkerId>,
    /// Only those in one of these states, by their words; in any if there are none.
    pub states: Vec<&'static str>,
    /// Only those at this place.
    pub place: Option<NodeId>,
    /// Only those whose state changed at this time or later.
    pub updated_since: Option<Time>,
    /// Only those that were accepted at this time or later.
    pub from: Option<Time>,
    /// Only those that were accepted before this time.
    pub to: Option<Time>,
    /// Only those older than this one.
    pub before: Option<AssignmentId>,
    /// How many at most.
    pub limit: u32,
}

/// An encounter as it is listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncounterRow {
    /// Its number, in the order of recording.
    pub seq: i64,
    /// What happened. `worker` means nothing if it is anonymous.
    pub encounter: Encounter,
    /// Whether the list no longer says who it was.
    pub is_anonymous: bool,
}

impl EncounterRow {
    /// Who it was, if that is still known.
    pub fn worker(&self) -> Option<WorkerId> {
        (!self.is_anonymous).then_some(self.encounter.worker)
    }
}

/// Which encounters to list, newest first.
#[derive(Clone, Debug, Default)]
pub struct EncounterQuery {
    /// Only those that began at this time or later.
    pub from: Option<Time>,
    /// Only those that began before this time.
    pub to: Option<Time>,
    /// Only those of this worker.
    pub worker: Option<WorkerId>,
    /// Only those of this robot.
    pub robot: Option<RobotId>,
    /// Only those about which the fleet did one of these things, by their words; any if there are none.
    pub reactions: Vec<&'static str>,
    /// Only those that ended at this time or later: encounters are listed when they have ended.
    pub updated_since: Option<Time>,
    /// Only those recorded before this one.
    pub before: Option<i64>,
    /// How many at most.
    pub limit: u32,
}

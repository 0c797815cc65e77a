//! An event as it is told, in pages, in streams and to webhooks.
//!
//! Main type: [`EventDto`]. Refuses: to read events.

use super::text::{alarm_name, assignment_name, closure_name, job_name, time_text, worker_name};
use crate::fleet::{EventKind, EventRow, View};
use crate::id::{AssignmentId, ClosureId, Dense, JobId, RobotId};
use serde::Serialize;
use utoipa::ToSchema;

/// Something that happened.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EventDto {
    /// Its number. Later events have greater numbers; some numbers may be missing.
    pub seq: i64,
    /// When, RFC 3339.
    pub at: String,
    /// What it is about: job, robot, fleet, worker, assignment, closure, alarm or encounter.
    #[schema(example = "job")]
    pub kind: &'static str,
    /// The job, robot, worker, assignment, closure or alarm; null for the fleet and for encounters.
    #[schema(example = "j17")]
    pub id: Option<String>,
    /// The state before; null if none is known.
    #[schema(example = "picking")]
    pub old: Option<String>,
    /// The state since then. Of a job, its state; if that is the same as before, something else about the job was
    /// changed. Of a robot, what happened last, as in its history. Of a worker registered, on_floor, deviated,
    /// lost_near or left. Of an assignment waiting, given, walking, working, done or cancelled. Of a closure closed or
    /// reopened. Of an alarm active, acknowledged or cleared. Of the fleet fleet_stopped, fleet_resumed,
    /// evacuation_began or evacuation_ended. Of an encounter what the fleet did about the robot.
    #[schema(example = "done")]
    pub new: String,
    /// The robot that has to do with it.
    #[schema(example = "robot-3")]
    pub robot: Option<String>,
    /// The worker who has to do with it.
    #[schema(example = "w2")]
    pub worker: Option<String>,
    /// Of a job, your reference.
    #[schema(example = "order 4711")]
    pub reference: Option<String>,
    /// Of an alarm, its text.
    pub text: Option<String>,
}

/// An event with names.
pub fn event(view: &View, row: EventRow) -> EventDto {
    let robot = |r: RobotId| view.robots.get(r.ix()).map(|r| r.name.clone());
    let subject = row.subject.unwrap_or(0);
    let id = match row.kind {
        EventKind::Job => Some(job_name(JobId(subject))),
        EventKind::Robot => row.robot.and_then(robot),
        EventKind::Worker => row.worker.map(worker_name),
        EventKind::Assignment => Some(assignment_name(AssignmentId(subject))),
        EventKind::Closure => Some(closure_name(ClosureId(subject))),
        EventKind::Alarm => Some(alarm_name(subject)),
        EventKind::Fleet | EventKind::Encounter => None,
    };
    EventDto {
        seq: row.seq,
        at: time_text(row.at),
        kind: row.kind.word(),
        id,
        old: row.old,
        new: row.new,
        robot: row.robot.and_then(robot),
        worker: row.worker.map(worker_name),
        reference: row.reference,
        text: row.text,
    }
}

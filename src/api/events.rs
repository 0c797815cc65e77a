//! An event as it is told, in pages, in streams and to webhooks.
//!
//! Main type: [`EventDto`]. Refuses: to read events.

use super::caller::Role;
use super::dto::Names;
use super::text::{alarm_name, assignment_name, closure_name, job_name, time_text, worker_name};
use crate::fleet::{EventKind, EventRow};
use crate::id::{AssignmentId, ClosureId, Dense, JobId, RobotId, StationId};
use serde::Serialize;
use utoipa::ToSchema;

/// Something that happened.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EventDto {
    /// Its number. Later events have greater numbers; some numbers may be missing.
    pub seq: i64,
    /// When, RFC 3339.
    pub at: String,
    /// What it is about: job, robot, fleet, station, worker, assignment, closure, alarm or encounter.
    #[schema(example = "job")]
    pub kind: &'static str,
    /// The job, robot, station, worker, assignment, closure or alarm; null for the fleet and for encounters.
    #[schema(example = "j17")]
    pub id: Option<String>,
    /// The state before; null if none is known.
    #[schema(example = "picking")]
    pub old: Option<String>,
    /// The state since then. Of a job, its state; if that is the same as before, something else about the job was
    /// changed. Of a robot, what happened last, as in its history. Of a station paused or resumed. Of a worker
    /// registered, on_floor, deviated, lost_near or left. Of an assignment waiting, given, walking, working, done or
    /// cancelled. Of a closure closed or reopened. Of an alarm active, acknowledged or cleared. Of the fleet
    /// fleet_stopped, fleet_resumed, evacuation_began or evacuation_ended. Of an encounter what the fleet did about the
    /// robot.
    #[schema(example = "done")]
    pub new: String,
    /// The robot that has to do with it.
    #[schema(example = "robot-3")]
    pub robot: Option<String>,
    /// The worker who has to do with it. In events of assignments it is null for roles below admin: with their times,
    /// these would tell how fast a person works.
    #[schema(example = "w2")]
    pub worker: Option<String>,
    /// Of a job, your reference.
    #[schema(example = "order 4711")]
    pub reference: Option<String>,
    /// Of an alarm, its text.
    pub text: Option<String>,
}

/// An event with names, as this role sees it.
pub fn event(names: Names<'_>, role: Role, row: EventRow) -> EventDto {
    let robot = |r: RobotId| names.view.robots.get(r.ix()).map(|r| r.name.clone());
    let station = |id: u32| names.map.stations.get(StationId(id)).map(|s| s.name.clone());
    let is_shown = role == Role::Admin || row.kind != EventKind::Assignment;
    let subject = row.subject.unwrap_or(0);
    let id = match row.kind {
        EventKind::Job => Some(job_name(JobId(subject))),
        EventKind::Robot => row.robot.and_then(robot),
        EventKind::Station => row.text.clone().or_else(|| station(u32::try_from(subject).ok()?)),
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
        worker: row.worker.filter(|_| is_shown).map(worker_name),
        reference: row.reference,
        text: row.text.filter(|_| row.kind == EventKind::Alarm),
    }
}

//! Events on the wire: in pages, in streams and to webhooks.
//!
//! Main type: [`EventDto`]. Refuses: to read events.

use super::replans::{ReplanCauseDto, ReplannedDto};
use crate::access::caller::Role;
use crate::dto::names::Names;
use crate::wire::sentence::{SentenceArgsSchema, kept_parts};
use crate::wire::text::{alarm_name, assignment_name, closure_name, job_name, time_text, worker_name};
use giveway_fleet::{EventDetails, EventKind, EventRow, ReplanCause, RobotView};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::{AssignmentId, ClosureId, Dense, JobId, RobotId, StationId};
use giveway_floor::text::SentenceArgs;
use serde::Serialize;
use utoipa::ToSchema;

/// The largest distance of a place from a node that counts as being at the node, metres.
const SAME_M: f64 = 0.02;

/// An event: something that happened on the floor or in the server.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct EventDto {
    /// The event's number. Later events have greater numbers; some numbers may be missing.
    pub seq: i64,
    /// When the event happened, RFC 3339.
    pub at: String,
    /// The kind of event: job, robot, fleet, station, worker, assignment, closure, alarm, encounter, robot_replanned,
    /// worker_deviated or worker_goal.
    #[schema(example = "job")]
    pub kind: &'static str,
    /// The job, robot, station, worker, assignment, closure or alarm of the event; null for the fleet and for
    /// encounters.
    #[schema(example = "j17")]
    pub id: Option<String>,
    /// The state before; null if none is known.
    #[schema(example = "picking")]
    pub old: Option<String>,
    /// The state since then. For a job, its state; if that is the same as before, something else about the job was
    /// changed. For a robot, what happened last, as in its history. For a station, paused or resumed. For a worker,
    /// registered, on_floor, lost_near, left, in_vehicle or on_foot. For an assignment, waiting, given, walking,
    /// working, done or cancelled. For a closure, closed or reopened. For an alarm, active, acknowledged or cleared.
    /// For the fleet, fleet_stopped, fleet_resumed, evacuation_began or evacuation_ended. For an encounter, what the
    /// fleet did about the robot. For a robot that was replanned, the kind of `cause`; for a worker who left the path,
    /// deviated; for a worker's goal, goal.
    #[schema(example = "done")]
    pub new: String,
    /// The robot that is involved.
    #[schema(example = "robot-3")]
    pub robot: Option<String>,
    /// The worker who is involved. In events of assignments it is null for roles below admin: with their times, these
    /// would reveal how fast a person works.
    #[schema(example = "w2")]
    pub worker: Option<String>,
    /// For a job, your reference.
    #[schema(example = "order 4711")]
    pub reference: Option<String>,
    /// For an alarm, its text in English.
    pub text: Option<String>,
    /// For an alarm, the code of the sentence in `text`; absent from other events, and if a version without codes wrote
    /// it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, nullable = false, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// The values for the placeholders of the sentence; absent if `code` is absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    #[schema(value_type = Option<SentenceArgsSchema>)]
    pub args: Option<SentenceArgs>,
    /// Details of a replanned robot or of a worker's goal.
    #[serde(flatten)]
    pub details: EventDetailsDto,
}

/// What an event says besides a state. Each field is absent from events that it does not concern.
#[derive(Clone, Debug, Default, Serialize, ToSchema)]
pub struct EventDetailsDto {
    /// For a replanned robot: the worker, closure, robot or obstruction that caused it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cause: Option<ReplanCauseDto>,
    /// For a replanned robot: its previous route, the nodes ahead of it in order, at most 40.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub was: Option<Vec<String>>,
    /// For a replanned robot: its new route, the nodes ahead of it in order, at most 40.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub now: Option<Vec<String>>,
    /// For a worker's goal: its place `[x, y]`, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub goal: Option<[f64; 2]>,
    /// For a worker's goal: how probable it was at that time, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub probability: Option<f64>,
}

impl Names<'_> {
    /// What caused a robot's new route.
    pub fn replan_cause(&self, cause: ReplanCause) -> ReplanCauseDto {
        let id = match cause {
            ReplanCause::Worker(worker) => Some(worker_name(worker)),
            ReplanCause::Closure(closure) => Some(closure_name(closure)),
            ReplanCause::Robot(robot) => Some(self.robot(robot)),
            ReplanCause::Obstruction => None,
        };
        ReplanCauseDto { kind: cause.word(), id }
    }

    /// What caused a robot's latest replanning, and when that was; nothing if there has been none.
    pub(crate) fn replanned(&self, robot: &RobotView) -> Option<ReplannedDto> {
        let (cause, at) = robot.replanned?;
        Some(ReplannedDto { cause: self.replan_cause(cause), at: time_text(at) })
    }

    /// What an event says besides a state.
    pub fn event_details(&self, details: Option<EventDetails>) -> EventDetailsDto {
        match details {
            None => EventDetailsDto::default(),
            Some(EventDetails::Replanned { cause, was, now }) => EventDetailsDto {
                cause: Some(self.replan_cause(cause)),
                was: Some(self.places(&was)),
                now: Some(self.places(&now)),
                ..EventDetailsDto::default()
            },
            Some(EventDetails::Goal { place, percent }) => EventDetailsDto {
                goal: Some([place.x_mm, place.y_mm].map(|mm| mm as f64 / 1000.0)),
                probability: Some(f64::from(percent) / 100.0),
                ..EventDetailsDto::default()
            },
        }
    }

    /// Names of the nodes at these places, or coordinates where the map no longer has a node.
    fn places(&self, spots: &[Spot]) -> Vec<String> {
        let name = |spot: &Spot| {
            let at = Point::from(*spot);
            let node = self.map.nodes_within(at, SAME_M).first().copied();
            node.map_or_else(|| format!("{}, {}", at.x, at.y), |node| self.node(node))
        };
        spots.iter().map(name).collect()
    }
}

/// An event with names, as this role may see it.
pub fn event(names: Names<'_>, role: Role, row: EventRow) -> EventDto {
    let robot = |r: RobotId| names.view.robots.get(r.ix()).map(|r| r.name.clone());
    let station = |id: u32| names.map.stations.get(StationId(id)).map(|s| s.name.clone());
    let is_shown = role == Role::Admin || row.kind != EventKind::Assignment;
    let subject = row.subject.unwrap_or(0);
    let id = match row.kind {
        EventKind::Job => Some(job_name(JobId(subject))),
        EventKind::Robot | EventKind::RobotReplanned => row.robot.and_then(robot),
        EventKind::Station => row.text.clone().or_else(|| station(u32::try_from(subject).ok()?)),
        EventKind::Worker | EventKind::WorkerDeviated => row.worker.map(worker_name),
        EventKind::WorkerGoal => row.worker.map(worker_name),
        EventKind::Assignment => Some(assignment_name(AssignmentId(subject))),
        EventKind::Closure => Some(closure_name(ClosureId(subject))),
        EventKind::Alarm => Some(alarm_name(subject)),
        EventKind::Fleet | EventKind::Encounter => None,
    };
    let (code, args, text) = kept_parts(row.text.filter(|_| row.kind == EventKind::Alarm));
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
        text,
        code,
        args,
        details: names.event_details(row.details),
    }
}

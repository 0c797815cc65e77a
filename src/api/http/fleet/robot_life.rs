//! `/v1/robots/{id}` and its history: one robot with its errors, its link and what it has done, and what happened
//! to it.
//!
//! Main types: [`RobotDetailDto`], [`RobotEventDto`]. Refuses: pages of more than 500.

use crate::dto::alarms::AlarmDto;
use crate::dto::events::EventDetailsDto;
use crate::dto::names::{Names, Page, RobotDto};
use crate::http::shared::named::parse_robot;
use crate::http::shared::paging::checked_limit;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{Params, PathPart, read_end, read_time};
use crate::wire::sentence::{SentenceArgsSchema, kept_parts};
use crate::wire::text::{alarm_name, job_name, round3, time_text};
use axum::Json;
use giveway_fleet::alarm::{AlarmSubject, SubjectKind};
use giveway_fleet::{LinkState, RobotEventQuery, RobotEventRow, RobotEventSource, RobotView};
use giveway_floor::id::{Dense, JobId};
use giveway_floor::text::SentenceArgs;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// One robot with what lists leave out.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotDetailDto {
    /// As in the list.
    #[serde(flatten)]
    pub robot: RobotDto,
    /// How it is reached.
    pub link: RobotLinkDto,
    /// When its last report came in, RFC 3339; null if none has since the server started.
    pub heard: Option<String>,
    /// For how long no report has come in, seconds.
    pub silent_s: Option<f64>,
    /// How far it was seen to drive since the server started, metres.
    pub driven_m: f64,
    /// When the server started, RFC 3339.
    pub started: String,
    /// Jobs that it did, as far as the list of jobs reaches.
    pub jobs_done: u64,
    /// Jobs that it could not do, likewise.
    pub jobs_failed: u64,
    /// Active alarms about it, the worst first.
    pub alarms: Vec<AlarmDto>,
}

/// The link by which a robot is reached, and how it is with the robot there.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotLinkDto {
    /// Its name.
    #[schema(example = "sim")]
    pub name: String,
    /// Whether messages get through, as far as the link knows.
    pub connected: bool,
    /// How many visits the robot can be told beyond the last that it reached; null for any number.
    pub capacity: Option<usize>,
    /// Why it takes no orders, in the link's words; null where it takes them.
    #[schema(example = "a person drives it")]
    pub refuses: Option<String>,
}

impl From<&RobotView> for RobotLinkDto {
    fn from(row: &RobotView) -> RobotLinkDto {
        let LinkState { connected, capacity, refuses } = row.link_state.clone().unwrap_or_default();
        RobotLinkDto { name: row.link.clone(), connected, capacity, refuses }
    }
}

/// Something that happened to a robot.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotEventDto {
    /// When, RFC 3339: of a job, when its state changed last; of an alarm, when it was raised.
    pub at: String,
    /// job, alarm, change or replan.
    pub kind: &'static str,
    /// The job or the alarm; null for a change and a replan.
    #[schema(example = "j17")]
    pub id: Option<String>,
    /// The state of the job; the kind of the alarm; or joined, failed, repaired, fenced, paused, resumed,
    /// fleet_stopped, fleet_resumed, out_of_service, back_in_service, leaving, left or returned;
    /// or because of what it was replanned: worker, closure, robot or obstruction.
    #[schema(example = "done")]
    pub what: String,
    /// The kind of the job, or the text of the alarm.
    #[schema(example = "deliver")]
    pub text: Option<String>,
    /// Which sentence `text` is, of an alarm; absent from others, and where a version that had no codes wrote it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, nullable = false, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// What stands in its places; absent where `code` is.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    #[schema(value_type = Option<SentenceArgsSchema>)]
    pub args: Option<SentenceArgs>,
    /// When the alarm ended, RFC 3339.
    pub ended: Option<String>,
    /// Of a replan, because of whom or what, and the way before and since.
    #[serde(flatten)]
    pub details: EventDetailsDto,
}

/// Which part of a history to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RobotHistoryParams {
    /// Only what happened at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only what happened before this time.
    to: Option<String>,
    /// How many at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// One robot: what it is at, its errors, its link, how far it drove and which jobs it did.
#[utoipa::path(get, path = "/v1/robots/{id}", tag = "floor", operation_id = "getRobot",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 200, description = "The robot", body = RobotDetailDto),
    (status = 404, description = "No robot has this name"),
    (status = 503, description = "The database does not answer")))]
pub async fn get(Called(api): Called, PathPart(id): PathPart) -> Result<Json<RobotDetailDto>, Problem> {
    let robot = parse_robot(&api, &id)?;
    let jobs = api.records.robot_jobs(robot).await.map_err(Problem::of_records)?;
    let moment = api.moment();
    let row = &moment.view.robots[robot.ix()];
    let alarms = api.alarms.about(&AlarmSubject::new(SubjectKind::Robot, id));
    Ok(Json(RobotDetailDto {
        robot: Names { map: &api.map, view: &moment.view }.one_robot(row),
        link: RobotLinkDto::from(row),
        heard: row.heard.map(time_text),
        silent_s: row.heard.map(|t| round3((moment.view.now - t).as_secs_f64().max(0.0))),
        driven_m: round3(row.driven_m),
        started: time_text(api.figures.started),
        jobs_done: jobs.done,
        jobs_failed: jobs.failed,
        alarms: alarms.iter().map(AlarmDto::from).collect(),
    }))
}

/// What happened to a robot, newest first: its jobs, alarms about it, failures, and what people ordered.
#[utoipa::path(get, path = "/v1/robots/{id}/history", tag = "floor", operation_id = "listRobotHistory",
    params(("id" = String, Path, example = "robot-1"), RobotHistoryParams), responses(
    (status = 200, description = "What happened, newest first", body = Page<RobotEventDto>),
    (status = 404, description = "No robot has this name"),
    (status = 422, description = "A parameter is wrong"),
    (status = 503, description = "The database does not answer")))]
pub async fn history(
    Called(api): Called,
    PathPart(id): PathPart,
    Params(p): Params<RobotHistoryParams>,
) -> Result<Json<Page<RobotEventDto>>, Problem> {
    let robot = parse_robot(&api, &id)?;
    let limit = checked_limit(p.limit, 50)?;
    let mut errors = Vec::new();
    let from = read_time("from", p.from.as_deref(), &mut errors);
    let to = read_end("to", p.to.as_deref(), &mut errors);
    let before = p.cursor.as_deref().and_then(|text| {
        let entry = parse_cursor(text);
        if entry.is_none() {
            errors.push(FieldError::new("cursor", requests::not_a_cursor()));
        }
        entry
    });
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    let query = RobotEventQuery { robot, name: id, from, to, before, limit: limit + 1 };
    let mut rows = api.records.robot_events(query).await.map_err(Problem::of_records)?;
    let more = rows.len() > limit as usize;
    rows.truncate(limit as usize);
    let cursor = |row: &RobotEventRow| format!("{}-{}-{}", row.at.0, row.source.number(), row.id);
    let next = rows.last().filter(|_| more).map(cursor);
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    Ok(Json(Page { items: rows.into_iter().map(|row| event(names, row)).collect(), next }))
}

/// The entry after which a page begins: its time, its list and its number there.
fn parse_cursor(text: &str) -> Option<(Time, RobotEventSource, i64)> {
    let mut parts = text.splitn(3, '-').map(str::parse::<i64>);
    let mut number = || parts.next()?.ok();
    Some((Time(number()?), RobotEventSource::of_number(number()?)?, number()?))
}

fn event(names: Names<'_>, row: RobotEventRow) -> RobotEventDto {
    let number = row.id.unsigned_abs();
    let (kind, id) = match row.source {
        RobotEventSource::Job => ("job", Some(job_name(JobId(number)))),
        RobotEventSource::Alarm => ("alarm", Some(alarm_name(number))),
        RobotEventSource::Change => ("change", None),
        RobotEventSource::Replan => ("replan", None),
    };
    let (code, args, text) = match row.source {
        RobotEventSource::Alarm => kept_parts(row.text),
        RobotEventSource::Job | RobotEventSource::Change | RobotEventSource::Replan => (None, None, row.text),
    };
    RobotEventDto {
        at: time_text(row.at),
        kind,
        id,
        what: row.word,
        text,
        code,
        args,
        ended: row.ended.map(time_text),
        details: names.event_details(row.details),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_is_read_as_it_was_written_and_nothing_else_is() {
        let entry = (Time(1_800_000_000_000_001), RobotEventSource::Alarm, 17);
        assert_eq!(parse_cursor("1800000000000001-2-17"), Some(entry));
        for wrong in ["", "17", "1-2", "1-9-3", "1-2-x", "1-2-3-4"] {
            assert_eq!(parse_cursor(wrong), None, "{wrong}");
        }
    }
}

//! `/v1/robots/{id}` and its history: one robot with its errors, its link and its totals, and what happened to it.
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
use crate::wire::sentence::SentenceSchema;
use crate::wire::sentence::{SentenceArgsSchema, kept_parts};
use crate::wire::text::{alarm_name, job_name, round3, time_text};
use axum::Json;
use giveway_fleet::alarm::{AlarmSubject, SubjectKind};
use giveway_fleet::{LinkState, RobotEventQuery, RobotEventRow, RobotEventSource, RobotView};
use giveway_floor::id::{Dense, JobId};
use giveway_floor::text::Sentence;
use giveway_floor::text::SentenceArgs;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// One robot, with details that lists leave out.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotDetailDto {
    /// The robot, as in the list of robots.
    #[serde(flatten)]
    pub robot: RobotDto,
    /// The robot's link.
    pub link: RobotLinkDto,
    /// When the robot's last report arrived, RFC 3339; null if none has since the server started.
    pub heard: Option<String>,
    /// Seconds since the robot's last report arrived; null if none has since the server started.
    pub silent_s: Option<f64>,
    /// The distance that the robot was seen to drive since the server started, metres.
    pub driven_m: f64,
    /// When the server started, RFC 3339.
    pub started: String,
    /// How many jobs the robot has done, as far back as the list of jobs reaches.
    pub jobs_done: u64,
    /// How many jobs failed on the robot, as far back as the list of jobs reaches.
    pub jobs_failed: u64,
    /// Active alarms about the robot, the worst first.
    pub alarms: Vec<AlarmDto>,
}

/// The link to a robot, and its state for this robot.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotLinkDto {
    /// The link's name.
    #[schema(example = "sim")]
    pub name: String,
    /// Whether messages reach the robot, as far as the link knows.
    pub connected: bool,
    /// How the link knows: `by_reports` (it does not: a robot that sends no reports is silent), `answers` (the robot
    /// answers when it is asked), `lost` (nothing reaches it), `off` (it has said that it is being switched off),
    /// `line_down` (nothing reaches any robot of the link).
    #[schema(example = "answers")]
    pub reach: &'static str,
    /// How many visits beyond the last one reached an order can contain; null for any number.
    pub capacity: Option<usize>,
    /// Why the robot takes no orders; null if it takes them.
    #[schema(value_type = Option<SentenceSchema>)]
    pub refuses: Option<Sentence>,
}

impl From<&RobotView> for RobotLinkDto {
    fn from(row: &RobotView) -> RobotLinkDto {
        let LinkState { reach, capacity, refuses, .. } = row.link_state.clone().unwrap_or_default();
        RobotLinkDto {
            name: row.link.clone(),
            connected: reach.is_up(),
            reach: reach.word(),
            capacity,
            refuses,
        }
    }
}

/// An entry in a robot's history.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotEventDto {
    /// When it happened, RFC 3339: for a job, when its state last changed; for an alarm, when it was raised.
    pub at: String,
    /// The kind of entry: job, alarm, change or replan.
    pub kind: &'static str,
    /// The job or the alarm; null for a change and a replan.
    #[schema(example = "j17")]
    pub id: Option<String>,
    /// For a job, its state; for an alarm, its kind; for a change, joined, failed, repaired, fenced, paused, resumed,
    /// fleet_stopped, fleet_resumed, out_of_service, back_in_service, leaving, left or returned; for a replan, its
    /// cause: worker, closure, robot or obstruction.
    #[schema(example = "done")]
    pub what: String,
    /// For a job, its kind; for an alarm, its text in English.
    #[schema(example = "deliver")]
    pub text: Option<String>,
    /// For an alarm, the code of the sentence in `text`; absent from other entries, and if a version without codes
    /// wrote it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, nullable = false, example = "robot_silent")]
    pub code: Option<&'static str>,
    /// The values for the placeholders of the sentence; absent if `code` is absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    #[schema(value_type = Option<SentenceArgsSchema>)]
    pub args: Option<SentenceArgs>,
    /// When the alarm ended, RFC 3339.
    pub ended: Option<String>,
    /// For a replan: its cause, and the routes before and after.
    #[serde(flatten)]
    pub details: EventDetailsDto,
}

/// Filters for a robot's history.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RobotHistoryParams {
    /// Only entries of this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only entries before this time, RFC 3339.
    to: Option<String>,
    /// How many entries at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// Get one robot: its activity, its errors, its link, how far it drove and how many jobs it did.
#[utoipa::path(get, path = "/v1/robots/{id}", tag = "floor", operation_id = "getRobot",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 200, description = "The robot", body = RobotDetailDto)))]
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

/// List what happened to a robot, newest first: its jobs, alarms about it, failures, and what people ordered.
#[utoipa::path(get, path = "/v1/robots/{id}/history", tag = "floor", operation_id = "listRobotHistory",
    params(("id" = String, Path, example = "robot-1"), RobotHistoryParams), responses(
    (status = 200, description = "What happened, newest first", body = Page<RobotEventDto>)))]
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

/// The entry after which a page begins: its time, the list it comes from, and its number there.
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

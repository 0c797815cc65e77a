//! `/v1/alarms`: what is wrong now, what was wrong, and who has taken note.
//!
//! Main types: [`AlarmParams`], [`AcknowledgeBody`]. Refuses: to acknowledge what is over, and without a name.

use super::lists::checked_limit;
use crate::alarm::{Alarm, AlarmQuery};
use crate::api::Api;
use crate::api::alarms::AlarmDto;
use crate::api::called::Called;
use crate::api::dto::Page;
use crate::api::error::{FieldError, Problem};
use crate::api::extract::{JsonBody, Params, PathPart, read_end, read_time, signed};
use crate::api::text::parse_alarm;
use axum::Json;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

/// Which alarms to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct AlarmParams {
    /// `active` (if absent, and no other parameter is given): those that are active now, all of them, the worst first.
    /// `any`: also those that are over, newest first.
    #[param(example = "any")]
    state: Option<String>,
    /// Only those that had not ended before this time, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only those that began before this time.
    to: Option<String>,
    /// How many at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List alarms: those that are active, or the history.
#[utoipa::path(get, path = "/v1/alarms", tag = "server", operation_id = "listAlarms", params(AlarmParams), responses(
    (status = 200, description = "Alarms: the active ones, the worst first; or the history, newest first",
     body = Page<AlarmDto>),
    (status = 422, description = "A parameter is wrong", body = Problem, content_type = "application/problem+json"),
    (status = 503, description = "The database does not answer", body = Problem,
     content_type = "application/problem+json")))]
pub async fn list(
    Called(api): Called,
    Params(p): Params<AlarmParams>,
) -> Result<Json<Page<AlarmDto>>, Problem> {
    let active = api.alarms.list();
    let is_history = p.from.is_some() || p.to.is_some() || p.limit.is_some() || p.cursor.is_some();
    match p.state.as_deref() {
        Some("active") if is_history => {
            let detail = "active alarms are listed all at once: leave out from, to, limit and cursor";
            return Err(Problem::invalid(vec![FieldError::new("state", detail)]));
        }
        Some("active") => {}
        None if !is_history => {}
        Some("any") | None => return history(&api, &p, &active).await,
        Some(other) => {
            let detail = format!("\"{other}\" is neither active nor any");
            return Err(Problem::invalid(vec![FieldError::new("state", detail)]));
        }
    }
    Ok(Json(Page { items: active.iter().map(AlarmDto::from).collect(), next: None }))
}

async fn history(api: &Api, p: &AlarmParams, active: &[Alarm]) -> Result<Json<Page<AlarmDto>>, Problem> {
    let limit = checked_limit(p.limit, 50)?;
    let query = AlarmQuery { limit: limit + 1, ..query(p)? };
    let mut rows = api.records.alarms(query).await.map_err(|why| Problem::unavailable(why, 2))?;
    let more = rows.len() > limit as usize;
    rows.truncate(limit as usize);
    let next = rows.last().filter(|_| more).map(|row| row.id.to_string());
    // What is active has changed since it was written down.
    let newest = |row: &Alarm| AlarmDto::from(active.iter().find(|a| a.id == row.id).unwrap_or(row));
    Ok(Json(Page { items: rows.iter().map(newest).collect(), next }))
}

fn query(p: &AlarmParams) -> Result<AlarmQuery, Problem> {
    let mut errors = Vec::new();
    let from = read_time("from", p.from.as_deref(), &mut errors);
    let to = read_end("to", p.to.as_deref(), &mut errors);
    let before = p.cursor.as_deref().map(str::parse::<u64>);
    if let Some(Err(_)) = before {
        errors.push(FieldError::new("cursor", "use the value of `next` in the previous page"));
    }
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    Ok(AlarmQuery { from, to, before: before.and_then(Result::ok), limit: 0 })
}

/// Who acknowledges an alarm.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AcknowledgeBody {
    /// The name that others shall see, 1 to 80 characters.
    #[schema(example = "Ben")]
    by: String,
}

/// Acknowledge an active alarm: others see who looks after it, and it makes no sound any more. It stays active until
/// its cause is gone. Who acknowledged first stays. If the alarm becomes more severe, it asks for a new
/// acknowledgement. An acknowledgement is written down within a second and survives a restart.
#[utoipa::path(post, path = "/v1/alarms/{id}/acknowledge", tag = "server", operation_id = "acknowledgeAlarm",
    params(("id" = String, Path, example = "al17")), request_body = AcknowledgeBody, responses(
    (status = 200, description = "The alarm, with who acknowledged it", body = AlarmDto),
    (status = 400, description = "The body is not JSON", body = Problem, content_type = "application/problem+json"),
    (status = 404, description = "No alarm of this id is active", body = Problem,
     content_type = "application/problem+json"),
    (status = 409, description = "A recording is shown", body = Problem, content_type = "application/problem+json"),
    (status = 413, description = "The body is too large", body = Problem, content_type = "application/problem+json"),
    (status = 415, description = "The body is not sent as JSON", body = Problem,
     content_type = "application/problem+json"),
    (status = 422, description = "There is no name", body = Problem, content_type = "application/problem+json")))]
pub async fn acknowledge(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(body): JsonBody<AcknowledgeBody>,
) -> Result<Json<AlarmDto>, Problem> {
    api.queue()?;
    let by = signed(&body.by).map_err(|e| Problem::invalid(vec![e]))?;
    let alarm = parse_alarm(&id).and_then(|id| api.alarms.acknowledge(id, &by, (api.now)()));
    let unknown = || {
        let detail = format!("no alarm \"{id}\" is active; GET /v1/alarms lists those that are");
        Problem::unknown("alarm", detail)
    };
    alarm.as_ref().map(|alarm| Json(AlarmDto::from(alarm))).ok_or_else(unknown)
}

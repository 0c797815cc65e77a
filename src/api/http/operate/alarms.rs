//! `/v1/alarms`: alarms, active and past, with their acknowledgements, shelvings and notes.
//!
//! Main types: [`AlarmParams`], [`AcknowledgeBody`], [`ShelveBody`], [`NoteBody`]. Refuses: to change alarms that are
//! over, and changes without a person's name.

use crate::dto::alarms::AlarmDto;
use crate::dto::names::Page;
use crate::http::shared::paging::checked_limit;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, Params, PathPart, read_end, read_time, signed};
use crate::wire::text::parse_alarm;
use axum::Json;
use giveway_fleet::alarm::{
    Alarm, AlarmNote, AlarmQuery, CareRefusal, LONGEST_SHELVING, MOST_NOTES, MOST_SHELVED, Shelving,
};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Span;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

/// Filters for the list of alarms.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct AlarmParams {
    /// `active` (if absent, and no other parameter is given): all active alarms, the worst first. `any`: also alarms
    /// that are over, newest first.
    #[param(example = "any")]
    state: Option<String>,
    /// Only alarms that had not ended before this time, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only alarms that began before this time, RFC 3339.
    to: Option<String>,
    /// Only members of this group.
    #[param(example = "al18")]
    group: Option<String>,
    /// How many alarms at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List alarms: the active ones, or the history. If many robots have the same trouble, one alarm stands for all of them
/// and has their alarms as its `members`.
#[utoipa::path(get, path = "/v1/alarms", tag = "server", operation_id = "listAlarms", params(AlarmParams), responses(
    (status = 200, description = "Alarms: the active ones, the worst first; or the history, newest first",
     body = Page<AlarmDto>)))]
pub async fn list(
    Called(api): Called,
    Params(p): Params<AlarmParams>,
) -> Result<Json<Page<AlarmDto>>, Problem> {
    let active = api.alarms.list();
    let is_limited = p.limit.is_some() || p.cursor.is_some() || p.group.is_some();
    let is_history = p.from.is_some() || p.to.is_some() || is_limited;
    match p.state.as_deref() {
        Some("active") if is_history => {
            let detail = "active alarms are listed all at once: leave out from, to, group, limit and cursor";
            return Err(Problem::invalid(vec![FieldError::new("state", requests::malformed(detail))]));
        }
        Some("active") => {}
        None if !is_history => {}
        Some("any") | None => return history(&api, &p).await,
        Some(other) => {
            let detail = requests::not_one_of(other, vec!["active", "any"]);
            return Err(Problem::invalid(vec![FieldError::new("state", detail)]));
        }
    }
    Ok(Json(Page { items: active.iter().map(AlarmDto::from).collect(), next: None }))
}

async fn history(api: &Api, p: &AlarmParams) -> Result<Json<Page<AlarmDto>>, Problem> {
    let limit = checked_limit(p.limit, 50)?;
    let query = AlarmQuery { limit: limit + 1, ..query(p)? };
    let mut rows = api.records.alarms(query).await.map_err(Problem::of_records)?;
    let more = rows.len() > limit as usize;
    rows.truncate(limit as usize);
    let next = rows.last().filter(|_| more).map(|row| row.id.to_string());
    // An active alarm has changed since it was stored.
    let newest = |row: &Alarm| AlarmDto::from(api.alarms.find(row.id).as_ref().unwrap_or(row));
    Ok(Json(Page { items: rows.iter().map(newest).collect(), next }))
}

fn query(p: &AlarmParams) -> Result<AlarmQuery, Problem> {
    let mut errors = Vec::new();
    let from = read_time("from", p.from.as_deref(), &mut errors);
    let to = read_end("to", p.to.as_deref(), &mut errors);
    let before = p.cursor.as_deref().map(str::parse::<u64>);
    if let Some(Err(_)) = before {
        errors.push(FieldError::new("cursor", requests::not_a_cursor()));
    }
    let group = p.group.as_deref().map(parse_alarm);
    if let Some(None) = group {
        errors.push(FieldError::new("group", requests::malformed("give the id of an alarm, such as al18")));
    }
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    Ok(AlarmQuery { from, to, group: group.flatten(), before: before.and_then(Result::ok), limit: 0 })
}

/// The person who acknowledges an alarm.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AcknowledgeBody {
    /// Your name, as other people will see it, 1 to 80 characters.
    #[schema(example = "Ben")]
    by: String,
}

/// Acknowledge an active alarm: other people see who takes care of it, and it makes no more sound. It stays active
/// until its cause is gone. The first acknowledgement stays. If the alarm becomes more severe, it asks for a new
/// acknowledgement. Acknowledging a group acknowledges all its members; a group asks anew when it has more than
/// doubled. An acknowledgement is stored within a second and survives a restart.
#[utoipa::path(post, path = "/v1/alarms/{id}/acknowledge", tag = "server", operation_id = "acknowledgeAlarm",
    params(("id" = String, Path, example = "al17")), request_body = AcknowledgeBody, responses(
    (status = 200, description = "The alarm, with who acknowledged it", body = AlarmDto),
    (status = 404, description = "No alarm of this id is active"),
    (status = 409, description = "A recording is shown"),
    (status = 413, description = "The body is too large"),
    (status = 422, description = "There is no name")))]
pub async fn acknowledge(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(body): JsonBody<AcknowledgeBody>,
) -> Result<Json<AlarmDto>, Problem> {
    api.queue()?;
    let by = signed(&body.by).map_err(|e| Problem::invalid(vec![e]))?;
    let alarm = parse_alarm(&id).and_then(|id| api.alarms.acknowledge(id, &by, (api.now)()));
    alarm.as_ref().map(|alarm| Json(AlarmDto::from(alarm))).ok_or_else(|| not_active(&id))
}

/// The person who shelves an alarm, for how long, and why.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ShelveBody {
    /// Your name, as other people will see it, 1 to 80 characters.
    #[schema(example = "Ben")]
    by: String,
    /// How long to shelve the alarm, seconds, 60 to 43200 (twelve hours).
    #[schema(minimum = 60, maximum = 43200, example = 3600)]
    for_s: u32,
    /// Why the alarm is shelved, 1 to 200 characters.
    #[schema(example = "the radio is being mended", max_length = 200)]
    reason: String,
}

/// Shelve an active alarm: it stays active, is listed last, and calls nobody until its time is over or it becomes more
/// severe. If the alarm is cleared and raised again meanwhile, the new one is shelved as well. Evacuations, and alarms
/// about faults that keep the server from promising anything, always call.
#[utoipa::path(post, path = "/v1/alarms/{id}/shelve", tag = "server", operation_id = "shelveAlarm",
    params(("id" = String, Path, example = "al17")), request_body = ShelveBody, responses(
    (status = 200, description = "The alarm, with who put it aside", body = AlarmDto),
    (status = 404, description = "No alarm of this id is active"),
    (status = 409, description = "This one always calls, or a recording is shown"),
    (status = 429, description = "Too many are put aside")))]
pub async fn shelve(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(body): JsonBody<ShelveBody>,
) -> Result<Json<AlarmDto>, Problem> {
    api.queue()?;
    let (mut errors, length) = (Vec::new(), Span::from_secs(i64::from(body.for_s)));
    let by = signed(&body.by).unwrap_or_else(|e| {
        errors.push(e);
        String::new()
    });
    let reason = written("reason", &body.reason, 200, &mut errors);
    if length < Span::from_secs(60) || length > LONGEST_SHELVING {
        errors.push(FieldError::new("for_s", requests::shelving_out_of_range()));
    }
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    let at = (api.now)();
    let shelving = Shelving { by, at, until: at + length, reason };
    let number = parse_alarm(&id).ok_or_else(|| not_active(&id))?;
    let alarm = api.alarms.shelve(number, shelving).map_err(|why| refusal(why, &id))?;
    Ok(Json(AlarmDto::from(&alarm)))
}

/// Unshelve an alarm: it calls for attention again.
#[utoipa::path(delete, path = "/v1/alarms/{id}/shelve", tag = "server", operation_id = "unshelveAlarm",
    params(("id" = String, Path, example = "al17")), responses(
    (status = 200, description = "The alarm", body = AlarmDto),
    (status = 404, description = "No alarm of this id is active"),
    (status = 409, description = "A recording is shown")))]
pub async fn unshelve(Called(api): Called, PathPart(id): PathPart) -> Result<Json<AlarmDto>, Problem> {
    api.queue()?;
    let alarm = parse_alarm(&id).and_then(|id| api.alarms.unshelve(id));
    alarm.as_ref().map(|alarm| Json(AlarmDto::from(alarm))).ok_or_else(|| not_active(&id))
}

/// A note about an alarm.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NoteBody {
    /// Your name, as other people will see it, 1 to 80 characters.
    #[schema(example = "Ben")]
    by: String,
    /// The text of the note, 1 to 500 characters.
    #[schema(example = "the access point has no power; electrician at 15:00", max_length = 500)]
    text: String,
}

/// Write a note about an active alarm, for the people who take care of it next. Notes stay with the alarm when it is
/// over.
#[utoipa::path(post, path = "/v1/alarms/{id}/notes", tag = "server", operation_id = "noteAlarm",
    params(("id" = String, Path, example = "al17")), request_body = NoteBody, responses(
    (status = 200, description = "The alarm, with its notes", body = AlarmDto),
    (status = 404, description = "No alarm of this id is active"),
    (status = 409, description = "A recording is shown"),
    (status = 429, description = "It has as many notes as it may have")))]
pub async fn write_note(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(body): JsonBody<NoteBody>,
) -> Result<Json<AlarmDto>, Problem> {
    api.queue()?;
    let mut errors = Vec::new();
    let by = signed(&body.by).unwrap_or_else(|e| {
        errors.push(e);
        String::new()
    });
    let text = written("text", &body.text, 500, &mut errors);
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    let number = parse_alarm(&id).ok_or_else(|| not_active(&id))?;
    let note = AlarmNote { by, at: (api.now)(), text };
    let alarm = api.alarms.write_note(number, note).map_err(|why| refusal(why, &id))?;
    Ok(Json(AlarmDto::from(&alarm)))
}

/// A text that a person typed, trimmed; adds an error if it is empty or too long.
fn written(field: &str, text: &str, most: usize, errors: &mut Vec<FieldError>) -> String {
    let text = text.trim();
    let is_text = |c: char| !c.is_control() || c == '\n';
    if text.is_empty() || text.chars().count() > most || !text.chars().all(is_text) {
        errors.push(FieldError::new(field, requests::give_a_text(most)));
    }
    text.to_owned()
}

fn not_active(id: &str) -> Problem {
    Problem::unknown("alarm", requests::alarm_not_active(id))
}

fn refusal(why: CareRefusal, id: &str) -> Problem {
    match why {
        CareRefusal::NotActive => not_active(id),
        CareRefusal::AlwaysCalls => {
            let detail = requests::alarm_always_calls(id);
            Problem::conflict("always-calls", "This alarm cannot be put aside", detail)
        }
        CareRefusal::TooManyNotes => Problem::too_many(requests::too_many_notes(id, MOST_NOTES), 3600),
        CareRefusal::TooManyShelved => Problem::too_many(requests::too_many_shelved(MOST_SHELVED), 60),
    }
}

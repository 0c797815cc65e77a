//! `/v1/audit`: the requests that were to change something, with their callers and outcomes.
//!
//! Main types: [`AuditDto`], [`AuditParams`]. Refuses: pages of more than 500.

use crate::access::acts::AuditAct;
use crate::access::audit::{AuditEntry, AuditQuery};
use crate::access::caller::Role;
use crate::dto::names::Page;
use crate::http::shared::paging::checked_limit;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{Params, read_end, read_time};
use crate::wire::text::time_text;
use axum::Json;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// A request that was to change something.
#[derive(Debug, Serialize, ToSchema)]
pub struct AuditDto {
    /// The entry's number.
    #[schema(example = "1800000000000000")]
    pub id: String,
    /// When the request came, RFC 3339.
    #[schema(example = "2027-01-31T12:00:00Z")]
    pub at: String,
    /// The caller: the name of the token, `configuration` for tokens of the settings, `this machine` if no token was
    /// needed, `command line` for `giveway token`.
    #[schema(example = "night shift")]
    pub actor: String,
    /// The caller's role.
    pub role: Role,
    /// The request: method and route.
    #[schema(example = "POST /v1/robots/{id}/pause")]
    pub what: String,
    /// The request as an act; null if only an earlier or a later version knows it.
    pub act: Option<AuditAct>,
    /// The thing that the request concerned: the id in the path, or of the thing created; null if there is none.
    #[schema(example = "robot-2")]
    pub subject: Option<String>,
    /// The outcome of the request.
    pub outcome: AuditOutcome,
    /// The HTTP status of the answer; null if none is known.
    #[schema(example = 204)]
    pub status: Option<u16>,
}

/// The outcome of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AuditOutcome {
    /// The request was carried out.
    Done,
    /// The request was refused: the caller may not do this, or it is impossible.
    Refused,
    /// The server could not carry out the request.
    Failed,
    /// The request changed something, and no answer was sent over HTTP: it came over a feed, or the server ended.
    Unanswered,
}

/// Filters for the audit.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct AuditParams {
    /// Only requests that came at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only requests that came before this time, RFC 3339.
    to: Option<String>,
    /// Only requests of the caller of this name.
    #[param(example = "night shift")]
    actor: Option<String>,
    /// How many requests at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List requests that were to change something, newest first: every request except reads and reports of positions,
/// including requests that were refused because of the caller's role.
#[utoipa::path(get, path = "/v1/audit", tag = "server", operation_id = "listAudit", params(AuditParams), responses(
    (status = 200, description = "Requests, newest first", body = Page<AuditDto>)))]
pub async fn list(
    Called(api): Called,
    Params(p): Params<AuditParams>,
) -> Result<Json<Page<AuditDto>>, Problem> {
    let limit = checked_limit(p.limit, 50)?;
    let mut errors = Vec::new();
    let from = read_time("from", p.from.as_deref(), &mut errors);
    let to = read_end("to", p.to.as_deref(), &mut errors);
    let before = p.cursor.as_deref().map(str::parse::<i64>);
    if let Some(Err(_)) = before {
        errors.push(FieldError::new("cursor", requests::not_a_cursor()));
    }
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    let query =
        AuditQuery { from, to, actor: p.actor, before: before.and_then(Result::ok), limit: limit + 1 };
    let mut rows = api.records.audit(query).await.map_err(Problem::of_records)?;
    let more = rows.len() > limit as usize;
    rows.truncate(limit as usize);
    let next = rows.last().filter(|_| more).map(|row| row.id.to_string());
    Ok(Json(Page { items: rows.into_iter().map(dto).collect(), next }))
}

fn dto(entry: AuditEntry) -> AuditDto {
    let AuditEntry { id, actor, role, what, subject, status } = entry;
    let outcome = match status {
        None => AuditOutcome::Unanswered,
        Some(0..400) => AuditOutcome::Done,
        Some(400..500) => AuditOutcome::Refused,
        Some(_) => AuditOutcome::Failed,
    };
    let (act, id, at) = (AuditAct::of(&what), id.to_string(), time_text(Time(id)));
    AuditDto { id, at, actor, role, what, act, subject, outcome, status }
}

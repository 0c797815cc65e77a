//! `/v1/encounters`: every time a robot came into region 1 of a worker, as a list or as a table.
//!
//! Main type: [`EncounterParams`]. Refuses: to leave out any encounter.

use crate::dto::names::{Names, Page};
use crate::dto::people::EncounterDto;
use crate::http::shared::named::robot_named;
use crate::http::shared::paging::{checked_limit, named, read_words, refuse_wrong};
use crate::http::shared::table::{quoted, wants_table};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{Params, read_end, read_time};
use crate::wire::words::ReactionDto;
use axum::Json;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use giveway_fleet::{EncounterQuery, Listed};
use giveway_floor::text::sentence::requests;
use serde::Deserialize;
use utoipa::IntoParams;

/// The most rows of a table.
const LONGEST_TABLE: u32 = 100_000;

/// Filters for the list of encounters.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct EncounterParams {
    /// Only encounters that began at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only encounters that began before this time, RFC 3339.
    to: Option<String>,
    /// Only encounters of this worker.
    #[param(example = "w1")]
    worker: Option<String>,
    /// Only encounters of this robot.
    #[param(example = "robot-1")]
    robot: Option<String>,
    /// Only encounters with this reaction of the fleet, or with any of several with commas between them.
    #[param(value_type = Option<Vec<ReactionDto>>, style = Form, explode = false)]
    reaction: Option<String>,
    /// Only encounters that ended at this time or later, RFC 3339: an encounter is listed once it has ended.
    #[param(example = "2027-01-31T06:00:00Z")]
    updated_since: Option<String>,
    /// How many encounters at most: for a list 1 to 500, 50 if absent; for a table 1 to 100000, 100000 if absent.
    limit: Option<u32>,
    /// `next` of the previous page; for a table, from its `Link` header.
    cursor: Option<String>,
    /// `csv` for a table, as with `Accept: text/csv`.
    format: Option<String>,
}

/// List encounters, newest first, as JSON or as CSV.
#[utoipa::path(get, path = "/v1/encounters", tag = "people",
    operation_id = "listEncounters", params(EncounterParams), responses(
    (status = 200, description = "Encounters, newest first", content(
        (Page<EncounterDto> = "application/json"), (String = "text/csv")))))]
pub async fn list(
    Called(api): Called,
    headers: HeaderMap,
    Params(p): Params<EncounterParams>,
) -> Result<Response, Problem> {
    let table = wants_table(&headers, p.format.as_deref())?;
    let limit = match p.limit {
        Some(n) if table && n > 0 => n.min(LONGEST_TABLE),
        None if table => LONGEST_TABLE,
        limit => checked_limit(limit, 50)?,
    };
    let filter = EncounterQuery { limit, ..filter(&api, &p)? };
    let page = api.records.encounters(filter).await.map_err(Problem::of_records)?;
    let Listed { rows, next } = page;
    let next = next.map(|seq| seq.to_string());
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let items: Vec<EncounterDto> = rows.iter().map(|row| names.encounter(row)).collect();
    if !table {
        return Ok(Json(Page { items, next }).into_response());
    }
    let mut response = ([(header::CONTENT_TYPE, "text/csv; charset=utf-8")], csv(&items)).into_response();
    if let Some(link) = next.and_then(|next| format!("<?cursor={next}>; rel=\"next\"").parse().ok()) {
        response.headers_mut().insert(header::LINK, link);
    }
    Ok(response)
}

fn filter(api: &Api, p: &EncounterParams) -> Result<EncounterQuery, Problem> {
    let mut errors = Vec::new();
    let from = read_time("from", p.from.as_deref(), &mut errors);
    let to = read_end("to", p.to.as_deref(), &mut errors);
    let worker = p.worker.as_deref().and_then(|text| {
        let worker = api.feeds.worker(text);
        worker.map_err(|problem| errors.push(FieldError::new("worker", problem.sentence()))).ok()
    });
    let moment = api.moment();
    let robot = named("robot", p.robot.as_deref(), |name| robot_named(&moment, name), &mut errors);
    let reactions = ReactionDto::ALL.map(ReactionDto::word);
    let reactions = read_words("reaction", p.reaction.as_deref(), &reactions, &mut errors);
    let updated_since = read_time("updated_since", p.updated_since.as_deref(), &mut errors);
    let before = p.cursor.as_deref().and_then(|cursor| {
        let seq = cursor.parse::<i64>().ok();
        if seq.is_none() {
            errors.push(FieldError::new("cursor", requests::not_a_cursor()));
        }
        seq
    });
    refuse_wrong(errors)?;
    Ok(EncounterQuery { from, to, worker, robot, reactions, updated_since, before, limit: 0 })
}

/// The encounters as a table (RFC 4180).
fn csv(items: &[EncounterDto]) -> String {
    let mut text = String::from(
        "id,worker,robot,began,lasted_s,x,y,region,radius,closest,robot_speed,worker_speed,reaction,delay_s\r\n",
    );
    for e in items {
        let numbers = [e.x, e.y, f64::from(e.region), e.radius, e.closest, e.robot_speed, e.worker_speed]
            .map(|n| n.to_string());
        let cells =
            [e.id.to_string(), e.worker.clone().unwrap_or_default(), quoted(&e.robot), e.began.clone()];
        let cells = cells.join(",");
        let numbers = numbers.join(",");
        text += &format!("{cells},{},{numbers},{},{}\r\n", e.lasted_s, e.reaction.word(), e.delay_s);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_a_line_for_each_and_quotes_what_it_must() {
        let e = EncounterDto {
            id: 7,
            worker: Some("w1".into()),
            robot: "the \"big\", red one".into(),
            began: "2027-01-31T12:00:00Z".into(),
            lasted_s: 1.5,
            x: 1.25,
            y: -3.0,
            region: 1,
            radius: 1.4,
            closest: 0.9,
            robot_speed: 0.5,
            worker_speed: 1.2,
            reaction: crate::wire::words::ReactionDto::Stopped,
            delay_s: 2.0,
        };
        let text = csv(&[e]);
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(lines[0].split(',').count(), 14);
        let expected =
            "7,w1,\"the \"\"big\"\", red one\",2027-01-31T12:00:00Z,1.5,1.25,-3,1,1.4,0.9,0.5,1.2,stopped,2";
        assert_eq!(lines[1], expected);
    }
}

//! `/v1/report`: the report of a period, for a shift leader, as JSON or as a table.
//!
//! Main type: [`ReportParams`]. Refuses: more than 31 days at once, since older figures are not kept.

use crate::dto::shift::{ShiftReportDto, ShiftSources};
use crate::http::shared::stretch::stretch;
use crate::http::shared::table::{quoted, wants_table};
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::Params;
use axum::Json;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use giveway_fleet::alarm::AlarmQuery;
use giveway_fleet::history::TIERS;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::{Span, Time};
use serde::Deserialize;
use serde_json::{Value, json};
use utoipa::IntoParams;

/// The longest period.
const LONGEST: Span = Span::from_secs(31 * 24 * 3600);

/// The most alarms that are counted: the newest.
const ALARMS: u32 = 20_000;

/// Start and end of a report, and its format.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ReportParams {
    /// Start of the period, RFC 3339; an hour before the end if absent.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// End of the period, RFC 3339, at most 31 days after the start; now if absent or in the future.
    to: Option<String>,
    /// `csv` for a table, as with `Accept: text/csv`.
    format: Option<String>,
}

/// Get the report of a period: deliveries by station, how long orders took, late deliveries, what robots, stations and
/// chargers did, what robots waited for, alarms, acts, encounters, people. Counts of jobs and encounters are exact;
/// shares of time, and figures counted with them, are summed in steps of ten seconds in the last hour, a minute in the
/// last day, ten minutes before that.
#[utoipa::path(get, path = "/v1/report", tag = "floor", operation_id = "getReport", params(ReportParams), responses(
    (status = 200, description = "The report", content(
        (ShiftReportDto = "application/json"), (String = "text/csv")))))]
pub async fn report(
    Called(api): Called,
    headers: HeaderMap,
    Params(p): Params<ReportParams>,
) -> Result<Response, Problem> {
    let table = wants_table(&headers, p.format.as_deref())?;
    let (from, to) = stretch(&api, p.from.as_deref(), p.to.as_deref())?;
    let now = api.moment().view.now;
    // The fleet's time is the time of its last step; acts since then belong to the period, too.
    let acts_to = if to > now { Time(i64::MAX) } else { to };
    let to = to.min(now + Span(1)).max(from + Span(1));
    if to - from > LONGEST {
        let detail = requests::report_too_long();
        return Err(Problem::invalid(vec![FieldError::new("from", detail)]));
    }
    let refused = Problem::of_records;
    let rows = api.records.shift((from, to), now).await.map_err(refused)?;
    let asked = AlarmQuery { from: Some(from), to: Some(to), limit: ALARMS, ..AlarmQuery::default() };
    let alarms = api.records.alarms(asked).await.map_err(refused)?;
    let buckets = api.figures.with(|h| h.read(from, to, step(from, now)));
    let acts = api.records.acts((from, acts_to)).await.map_err(refused)?;
    let (between, map) = ((from, to), &*api.map);
    let sources = ShiftSources { map, between, buckets: &buckets, rows: &rows, alarms: &alarms, acts: &acts };
    let report = sources.report();
    if !table {
        return Ok(Json(report).into_response());
    }
    let headers = [
        (header::CONTENT_TYPE, "text/csv; charset=utf-8"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"report.csv\""),
    ];
    Ok((headers, csv(&report)).into_response())
}

/// The finest step in which figures since `from` are kept.
fn step(from: Time, now: Time) -> Span {
    let reaches = |(step, most): &&(Span, usize)| now - from <= *step * *most as i64;
    TIERS.iter().find(reaches).unwrap_or(&TIERS[TIERS.len() - 1]).0
}

/// The report as a table (RFC 4180): one figure per line, with the row to which it belongs.
fn csv(report: &ShiftReportDto) -> String {
    let mut text = String::from("table,row,figure,value\r\n");
    let Value::Object(tables) = json!(report) else { return text };
    for (table, value) in tables {
        match value {
            Value::Array(rows) => rows.iter().for_each(|row| lines(&mut text, &table, row)),
            Value::Object(_) => lines(&mut text, &table, &value),
            figure => line(&mut text, ["report", "", &table], &figure),
        }
    }
    text
}

/// The lines of one row. Rows of a list are distinguished by their name: station, kind, cause or act.
fn lines(text: &mut String, table: &str, row: &Value) {
    let name =
        ["station", "kind", "cause", "act"].into_iter().find_map(|key| row[key].as_str()).unwrap_or("");
    for (figure, value) in row.as_object().into_iter().flatten() {
        match value {
            Value::Object(parts) => {
                for (part, value) in parts {
                    line(text, [table, name, &format!("{figure}.{part}")], value);
                }
            }
            Value::String(s) if s == name => {}
            value => line(text, [table, name, figure], value),
        }
    }
}

fn line(text: &mut String, cells: [&str; 3], value: &Value) {
    let value = match value {
        Value::String(s) => quoted(s),
        Value::Null => String::new(),
        other => other.to_string(),
    };
    *text += &format!("{},{value}\r\n", cells.map(quoted).join(","));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_come_from_the_finest_steps_that_go_back_so_far() {
        let now = Time(50 * 24 * 3_600_000_000);
        let ago = |s: i64| step(now - Span::from_secs(s), now);
        assert_eq!(ago(3600), Span::from_secs(10));
        assert_eq!(ago(8 * 3600), Span::from_secs(60));
        assert_eq!(ago(8 * 86_400), Span::from_secs(600));
    }
}

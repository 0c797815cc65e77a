//! `/v1/heat`: where robots waited, and where robots and workers met, summed over a period.
//!
//! Main types: [`HeatDto`], [`CellDto`]. Refuses: to name robots and workers; lists and reports name them.

use crate::dto::names::Names;
use crate::http::shared::stretch::stretch;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::Params;
use crate::wire::text::{round3, time_text};
use crate::wire::words::HeatUnitDto;
use axum::Json;
use giveway_fleet::EncounterQuery;
use giveway_fleet::history::{DAY, HEAT_STEP, floor};
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::{IntoParams, ToSchema};

/// Side of a cell in which encounters are counted, millimetres.
const CELL_MM: i64 = 1000;

/// The most cells in an answer: the ones with the largest amounts.
const MOST: usize = 5000;

/// The most encounters that are counted: the newest.
const ENCOUNTERS: u32 = 100_000;

/// The quantity that is summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeatKind {
    /// Seconds that robots stood still although they had to drive on.
    Waiting,
    /// Robots that came into region 1 of a worker.
    Encounters,
}

/// Quantity and period of a heat map.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct HeatParams {
    /// The quantity: waiting or encounters.
    kind: HeatKind,
    /// Start of the period, RFC 3339; an hour before the end if absent. Waiting is kept for a day.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// End of the period, RFC 3339; now if absent.
    to: Option<String>,
}

/// Sums by place.
#[derive(Debug, Serialize, ToSchema)]
pub struct HeatDto {
    /// The quantity: waiting or encounters.
    pub kind: HeatKind,
    /// Start of the sum, RFC 3339: waiting is kept in steps of five minutes.
    pub from: String,
    /// End of the sum, RFC 3339.
    pub to: String,
    /// What `amount` counts.
    pub unit: HeatUnitDto,
    /// Side of the square that represents a place, metres.
    pub size: f64,
    /// Places, the largest amounts first, 5000 at most.
    pub cells: Vec<CellDto>,
}

/// The sum at one place.
#[derive(Debug, Serialize, ToSchema)]
pub struct CellDto {
    /// x of the place's centre, metres.
    pub x: f64,
    /// y of the place's centre, metres.
    pub y: f64,
    /// The node, if the place is one; else null.
    pub node: Option<String>,
    /// The sum, in `unit`.
    pub amount: f64,
}

/// Get where robots waited (by node), or where robots and workers met (by square metre, where the worker was).
#[utoipa::path(get, path = "/v1/heat", tag = "floor", operation_id = "getHeat", params(HeatParams), responses(
    (status = 200, description = "Amounts by place", body = HeatDto)))]
pub async fn heat(Called(api): Called, Params(p): Params<HeatParams>) -> Result<Json<HeatDto>, Problem> {
    let (from, to) = stretch(&api, p.from.as_deref(), p.to.as_deref())?;
    let (from, unit, size, mut cells) = match p.kind {
        HeatKind::Waiting => {
            let oldest = api.moment().view.now - HEAT_STEP * DAY as i64;
            let from = floor(from.max(oldest), HEAT_STEP);
            (from, HeatUnitDto::Seconds, api.map.footprint_m, waiting(&api, from, to))
        }
        HeatKind::Encounters => {
            (from, HeatUnitDto::Encounters, CELL_MM as f64 / 1000.0, encounters(&api, from, to).await?)
        }
    };
    cells.sort_by(|a, b| b.amount.total_cmp(&a.amount).then(a.x.total_cmp(&b.x)).then(a.y.total_cmp(&b.y)));
    cells.truncate(MOST);
    let (from, to) = (time_text(from), time_text(to));
    Ok(Json(HeatDto { kind: p.kind, from, to, unit, size: round3(size), cells }))
}

fn waiting(api: &Api, from: Time, to: Time) -> Vec<CellDto> {
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let waited = api.figures.with(|h| h.heat().read(from, to));
    let cell = |(node, span): (_, giveway_floor::time::Span)| {
        let at = api.map.nodes.get(node)?.at;
        let (x, y, amount) = (round3(at.x), round3(at.y), round3(span.as_secs_f64()));
        Some(CellDto { x, y, node: Some(names.node(node)), amount })
    };
    waited.into_iter().filter_map(cell).collect()
}

async fn encounters(api: &Api, from: Time, to: Time) -> Result<Vec<CellDto>, Problem> {
    let filter =
        EncounterQuery { from: Some(from), to: Some(to), limit: ENCOUNTERS, ..EncounterQuery::default() };
    let rows = api.records.encounters(filter).await.map_err(Problem::of_records)?.rows;
    let mut cells: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for row in rows {
        let at = row.encounter.at;
        *cells.entry((cell_of(at.x_mm), cell_of(at.y_mm))).or_default() += 1.0;
    }
    let middle = |n: i64| (n * CELL_MM) as f64 / 1000.0;
    let cell = |((x, y), amount)| CellDto { x: middle(x), y: middle(y), node: None, amount };
    Ok(cells.into_iter().map(cell).collect())
}

/// Cells are centred on whole metres, where most maps have their nodes, so all that happens at such a node is in one
/// cell.
fn cell_of(mm: i64) -> i64 {
    (mm + CELL_MM / 2).div_euclid(CELL_MM)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_happens_around_a_whole_metre_is_in_one_cell() {
        assert_eq!([-501, -500, -3, 0, 3, 499, 500].map(cell_of), [-1, 0, 0, 0, 0, 0, 1]);
    }
}

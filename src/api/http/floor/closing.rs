//! The effect of closing an area, as `/v1/closures` and `/v1/closures/preview` report it.
//!
//! Main type: [`ClosingEffectDto`]. Refuses: to close anything.

use crate::dto::names::Names;
use crate::port::questions::Question;
use crate::state::api::Api;
use crate::wire::error::Problem;
use crate::wire::text::{job_name, time_text};
use giveway_fleet::{Affected, ClosingEffect, Closure};
use serde::Serialize;
use utoipa::ToSchema;

/// The effect of closing an area on robots, racks and jobs.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ClosingEffectDto {
    /// How many nodes are inside the area.
    pub nodes: usize,
    /// Stations that no rack can reach, or that no rack can leave, while the area is closed.
    #[schema(example = json!(["W1"]))]
    pub stations: Vec<String>,
    /// Racks in storage that can reach no station.
    pub racks: AffectedDto,
    /// Robots that can reach no place where they can stay.
    pub trapped: AffectedDto,
    /// Jobs that wait until the area is opened.
    pub waiting: AffectedDto,
    /// Jobs in progress whose robots are to pass the area.
    pub under_way: AffectedDto,
    /// When the last robot of these jobs is expected to have left the area, RFC 3339: if closed from then on, the area
    /// lets them pass; null if there are none.
    #[schema(example = "2027-01-31T12:00:40Z")]
    pub clear_at: Option<String>,
}

/// A number of things, with the names of the first.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct AffectedDto {
    /// How many there are.
    pub total: usize,
    /// The names of the first 20.
    pub first: Vec<String>,
}

/// The effect of closing an area in the current situation.
pub(super) async fn effect_of(api: &Api, area: &Closure) -> Result<ClosingEffectDto, Problem> {
    let effect = api.query(|reply| Question::Closing(area.clone(), reply)).await?.what;
    let moment = api.moment();
    Ok(ClosingEffectDto::new(effect, Names { map: &api.map, view: &moment.view }))
}

impl ClosingEffectDto {
    fn new(effect: ClosingEffect, names: Names) -> ClosingEffectDto {
        let station = |s: &giveway_floor::id::StationId| names.map.stations[*s].name.clone();
        ClosingEffectDto {
            nodes: effect.nodes,
            stations: effect.stations.iter().map(station).collect(),
            racks: affected(effect.racks, |k| names.map.racks[k].name.clone()),
            trapped: affected(effect.trapped, |r| names.robot(r)),
            waiting: affected(effect.waiting, job_name),
            under_way: affected(effect.under_way, |(job, _)| job_name(job)),
            clear_at: effect.clear.map(time_text),
        }
    }
}

fn affected<T>(found: Affected<T>, name: impl Fn(T) -> String) -> AffectedDto {
    AffectedDto { total: found.total, first: found.first.into_iter().map(name).collect() }
}

//! What closing an area does, as `/v1/closures` and `/v1/closures/preview` say it.
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

/// What closing an area does to robots, racks and jobs.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ClosingEffectDto {
    /// How many nodes are inside.
    pub nodes: usize,
    /// Stations to which no rack comes, or from which none gets away, while it is closed.
    #[schema(example = json!(["W1"]))]
    pub stations: Vec<String>,
    /// Racks in storage that come to no station.
    pub racks: AffectedDto,
    /// Robots that get to no place where they can stay.
    pub trapped: AffectedDto,
    /// Jobs that wait until it is opened.
    pub waiting: AffectedDto,
    /// Jobs at work whose robots are to pass it.
    pub under_way: AffectedDto,
    /// When the last of these robots is expected to be out of it, RFC 3339: closed from then on, it lets them pass;
    /// null if there are none.
    #[schema(example = "2027-01-31T12:00:40Z")]
    pub clear_at: Option<String>,
}

/// Some things, the first of them by name.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct AffectedDto {
    /// How many.
    pub total: usize,
    /// The names of the first 20.
    pub first: Vec<String>,
}

/// What closing an area does, as things stand.
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

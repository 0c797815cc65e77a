//! `/v1/racks`, `/v1/stations`, `/v1/robots`: lists of what is on the floor, from the latest view.
//!
//! Main functions: [`racks`], [`stations`], [`robots`]. Refuses: to query durable lists.

use crate::dto::linked::{LinkedRobotDto, UnlistedRobotDto};
use crate::dto::names::{Names, Page, RackDto, RobotDto, StationDto};
use crate::http::shared::named::robot_named;
use crate::http::shared::paging::{Paging, is_wanted, named, page, read_words, refuse_wrong};
use crate::port::linked::LinkQuestion;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::{Params, read_time};
use crate::wire::words::{ActivityDto, RobotStateDto};
use axum::Json;
use giveway_fleet::{Activity, RobotView};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// List all racks.
#[utoipa::path(get, path = "/v1/racks", tag = "floor", operation_id = "listRacks", params(Paging), responses(
    (status = 200, description = "Racks in the map's order", body = Page<RackDto>)))]
pub async fn racks(Called(api): Called, Params(p): Params<Paging>) -> Result<Json<Page<RackDto>>, Problem> {
    let moment = api.moment();
    page(Names { map: &api.map, view: &moment.view }.racks(), &p)
}

/// Filters for the list of stations.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct StationParams {
    /// True: only stations where picking is paused by hand; false: only the other stations.
    paused: Option<bool>,
    /// True: only stations where a rack stands to be picked from; false: only the other stations.
    picking: Option<bool>,
    /// Only the station with this robot at its picking place or in its queue.
    #[param(example = "robot-1")]
    robot: Option<String>,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List stations.
#[utoipa::path(get, path = "/v1/stations", tag = "floor", operation_id = "listStations",
    params(StationParams), responses(
    (status = 200, description = "Stations in the map's order", body = Page<StationDto>)))]
pub async fn stations(
    Called(api): Called,
    Params(p): Params<StationParams>,
) -> Result<Json<Page<StationDto>>, Problem> {
    let (moment, mut errors) = (api.moment(), Vec::new());
    named("robot", p.robot.as_deref(), |name| robot_named(&moment, name), &mut errors);
    refuse_wrong(errors)?;
    let mut stations = Names { map: &api.map, view: &moment.view }.stations();
    stations.retain(|s| {
        p.paused.is_none_or(|paused| s.paused.is_some() == paused)
            && p.picking.is_none_or(|picking| s.picking == picking)
            && p.robot.as_ref().is_none_or(|robot| s.robot.as_ref() == Some(robot) || s.queue.contains(robot))
    });
    page(stations, &Paging { limit: p.limit, cursor: p.cursor })
}

/// Filters for the list of robots.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RobotParams {
    /// Only robots with this activity, or with any of several with commas between them; `gone` finds none.
    #[param(value_type = Option<Vec<ActivityDto>>, style = Form, explode = false)]
    activity: Option<String>,
    /// Only robots in this state, or in any of several with commas between them; `gone` finds none.
    #[param(value_type = Option<Vec<RobotStateDto>>, style = Form, explode = false)]
    state: Option<String>,
    /// Only robots of this kind.
    #[param(example = "robot")]
    kind: Option<String>,
    /// Only robots that have had their activity since this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    updated_since: Option<String>,
    /// Whether to add robots that speak VDA 5050 and have not joined: those that are listed, and those that nobody
    /// listed.
    #[serde(default)]
    unlisted: bool,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// Robots on the floor and, if asked for, robots that have not joined.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotsDto {
    #[serde(flatten)]
    robots: Page<RobotDto>,
    /// Robots that are listed and have not joined the fleet, if `unlisted` was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    waiting: Option<Vec<LinkedRobotDto>>,
    /// Robots that were heard of and that nobody listed, if `unlisted` was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    unlisted: Option<Vec<UnlistedRobotDto>>,
}

/// List the robots on the floor.
#[utoipa::path(get, path = "/v1/robots", tag = "floor", operation_id = "listRobots", params(RobotParams), responses(
    (status = 200, description = "Robots in order of joining", body = RobotsDto)))]
pub async fn robots(Called(api): Called, Params(p): Params<RobotParams>) -> Result<Json<RobotsDto>, Problem> {
    let mut errors = Vec::new();
    let activities = Activity::ALL.map(Activity::word);
    let activities = read_words("activity", p.activity.as_deref(), &activities, &mut errors);
    let states = RobotStateDto::ALL.map(RobotStateDto::word);
    let states = read_words("state", p.state.as_deref(), &states, &mut errors);
    let kinds = api.moment().view.all_kinds.clone();
    let is_kind = |name: &str| kinds.named(name).map(drop);
    named("kind", p.kind.as_deref(), is_kind, &mut errors);
    let since = read_time("updated_since", p.updated_since.as_deref(), &mut errors);
    refuse_wrong(errors)?;
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let wanted = |r: &&RobotView| {
        r.activity != Activity::Gone
            && is_wanted(&activities, r.activity.word())
            && is_wanted(&states, RobotStateDto::from(r.state).word())
            && p.kind.as_ref().is_none_or(|kind| r.kind == *kind)
            && since.is_none_or(|t| r.since >= t)
    };
    let robots = moment.view.robots.iter().filter(wanted).map(|r| names.one_robot(r)).collect();
    let Json(robots) = page(robots, &Paging { limit: p.limit, cursor: p.cursor })?;
    let (waiting, unlisted) = match p.unlisted {
        // Without such a link nobody waits and nobody is heard.
        true if api.link.is_none() => (Some(Vec::new()), Some(Vec::new())),
        true => {
            let waiting = api.ask_link(LinkQuestion::Waiting).await?.into_iter().map(LinkedRobotDto::from);
            let unlisted =
                api.ask_link(LinkQuestion::Unlisted).await?.into_iter().map(UnlistedRobotDto::from);
            (Some(waiting.collect()), Some(unlisted.collect()))
        }
        false => (None, None),
    };
    Ok(Json(RobotsDto { robots, waiting, unlisted }))
}

//! `/v1/racks`, `/v1/stations`, `/v1/robots`: what is on the floor, as the latest view has it.
//!
//! Main functions: [`racks`], [`stations`], [`robots`]. Refuses: pages of more than 500.

use crate::api::called::Called;
use crate::api::dto::{Names, Page, RackDto, RobotDto, StationDto};
use crate::api::error::{FieldError, Problem};
use crate::api::extract::Params;
use crate::api::words::ActivityDto;
use crate::fleet::{Activity, RobotView};
use axum::Json;
use serde::Deserialize;
use utoipa::IntoParams;

/// The longest page.
pub const LONGEST_PAGE: u32 = 500;

/// Which page of a list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Paging {
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// All racks.
#[utoipa::path(get, path = "/v1/racks", tag = "floor", operation_id = "listRacks", params(Paging), responses(
    (status = 200, description = "Racks in the map's order", body = Page<RackDto>),
    (status = 422, body = Problem, content_type = "application/problem+json")))]
pub async fn racks(Called(api): Called, Params(p): Params<Paging>) -> Result<Json<Page<RackDto>>, Problem> {
    let moment = api.moment();
    page(Names { map: &api.map, view: &moment.view }.racks(), &p)
}

/// All stations.
#[utoipa::path(get, path = "/v1/stations", tag = "floor", operation_id = "listStations", params(Paging), responses(
    (status = 200, description = "Stations in the map's order", body = Page<StationDto>),
    (status = 422, body = Problem, content_type = "application/problem+json")))]
pub async fn stations(
    Called(api): Called,
    Params(p): Params<Paging>,
) -> Result<Json<Page<StationDto>>, Problem> {
    let moment = api.moment();
    page(Names { map: &api.map, view: &moment.view }.stations(), &p)
}

/// Which robots to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RobotParams {
    /// Only robots that are at this; `gone` finds none.
    #[param(value_type = Option<ActivityDto>)]
    activity: Option<String>,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// All robots on the floor, or those that are at something.
#[utoipa::path(get, path = "/v1/robots", tag = "floor", operation_id = "listRobots", params(RobotParams), responses(
    (status = 200, description = "Robots in order of joining", body = Page<RobotDto>),
    (status = 422, body = Problem, content_type = "application/problem+json")))]
pub async fn robots(
    Called(api): Called,
    Params(p): Params<RobotParams>,
) -> Result<Json<Page<RobotDto>>, Problem> {
    let wanted = p.activity.as_deref().map(Activity::of_word);
    if wanted == Some(None) {
        let words = Activity::ALL.map(Activity::word).join(", ");
        return Err(Problem::invalid(vec![FieldError::new("activity", format!("it is not one of {words}"))]));
    }
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let is_wanted = |r: &&RobotView| {
        r.activity != Activity::Gone && wanted.flatten().is_none_or(|activity| r.activity == activity)
    };
    let robots = moment.view.robots.iter().filter(is_wanted).map(|r| names.one_robot(r)).collect();
    page(robots, &Paging { limit: p.limit, cursor: p.cursor })
}

/// A limit within bounds.
pub fn checked_limit(limit: Option<u32>, usual: u32) -> Result<u32, Problem> {
    match limit.unwrap_or(usual) {
        n @ 1..=LONGEST_PAGE => Ok(n),
        n => Err(Problem::invalid(vec![FieldError::new("limit", format!("{n} is not between 1 and 500"))])),
    }
}

/// One page of a list.
pub fn page<T>(all: Vec<T>, p: &Paging) -> Result<Json<Page<T>>, Problem> {
    let limit = checked_limit(p.limit, 100)? as usize;
    let start = match p.cursor.as_deref().map(str::parse::<usize>) {
        None => 0,
        Some(Ok(start)) => start,
        Some(Err(_)) => {
            let detail = "use the value of `next` in the previous page";
            return Err(Problem::invalid(vec![FieldError::new("cursor", detail)]));
        }
    };
    let end = start.saturating_add(limit);
    let next = (end < all.len()).then(|| end.to_string());
    Ok(Json(Page { items: all.into_iter().skip(start).take(limit).collect(), next }))
}

//! `/v1/racks`, `/v1/stations`, `/v1/robots`: what is on the floor, as the latest view has it.
//!
//! Main functions: [`racks`], [`stations`], [`robots`]. Refuses: pages of more than 500.

use super::new_job::{robot_named, unknown};
use crate::called::Called;
use crate::dto::{Names, Page, RackDto, RobotDto, StationDto};
use crate::error::{FieldError, Problem};
use crate::extract::{Params, read_time};
use crate::words::{ActivityDto, RobotStateDto};
use axum::Json;
use giveway_fleet::{Activity, RobotView};
use giveway_floor::text::sentence::requests;
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
    pub limit: Option<u32>,
    /// `next` of the previous page.
    pub cursor: Option<String>,
}

/// All racks.
#[utoipa::path(get, path = "/v1/racks", tag = "floor", operation_id = "listRacks", params(Paging), responses(
    (status = 200, description = "Racks in the map's order", body = Page<RackDto>),
    (status = 422)))]
pub async fn racks(Called(api): Called, Params(p): Params<Paging>) -> Result<Json<Page<RackDto>>, Problem> {
    let moment = api.moment();
    page(Names { map: &api.map, view: &moment.view }.racks(), &p)
}

/// Which stations to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct StationParams {
    /// Only stations where picking is paused by hand, or only others.
    paused: Option<bool>,
    /// Only stations where a rack stands to be picked from, or only others.
    picking: Option<bool>,
    /// Only the station with this robot at its picking place or in its queue.
    #[param(example = "robot-1")]
    robot: Option<String>,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// All stations, or some of them.
#[utoipa::path(get, path = "/v1/stations", tag = "floor", operation_id = "listStations",
    params(StationParams), responses(
    (status = 200, description = "Stations in the map's order", body = Page<StationDto>),
    (status = 422)))]
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

/// Which robots to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RobotParams {
    /// Only robots that are at this, or at one of several with commas between them; `gone` finds none.
    #[param(value_type = Option<Vec<ActivityDto>>, style = Form, explode = false)]
    activity: Option<String>,
    /// Only robots in this state, or in one of several with commas between them; `gone` finds none.
    #[param(value_type = Option<Vec<RobotStateDto>>, style = Form, explode = false)]
    state: Option<String>,
    /// Only robots of this kind.
    #[param(example = "robot")]
    kind: Option<String>,
    /// Only robots that are at what they are at since this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    updated_since: Option<String>,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// All robots on the floor, or some of them.
#[utoipa::path(get, path = "/v1/robots", tag = "floor", operation_id = "listRobots", params(RobotParams), responses(
    (status = 200, description = "Robots in order of joining", body = Page<RobotDto>),
    (status = 422)))]
pub async fn robots(
    Called(api): Called,
    Params(p): Params<RobotParams>,
) -> Result<Json<Page<RobotDto>>, Problem> {
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
    page(robots, &Paging { limit: p.limit, cursor: p.cursor })
}

/// The words of a parameter, with commas between them; complains about those that are none.
pub fn read_words(
    field: &str,
    text: Option<&str>,
    known: &[&'static str],
    errors: &mut Vec<FieldError>,
) -> Vec<&'static str> {
    let mut found = Vec::new();
    for word in text.into_iter().flat_map(|text| text.split(',')).map(str::trim) {
        match known.iter().find(|known| **known == word) {
            Some(known) => found.push(*known),
            None => {
                errors.push(FieldError::new(field, requests::not_one_of(word, known.to_vec())));
            }
        }
    }
    found
}

/// Whether a word is one of those that are wanted; if none are, all of them.
pub fn is_wanted(wanted: &[&'static str], word: &str) -> bool {
    wanted.is_empty() || wanted.contains(&word)
}

/// What has the name in a parameter, if there is one; complains where nothing has.
pub fn named<T>(
    field: &str,
    name: Option<&str>,
    find: impl Fn(&str) -> Option<T>,
    errors: &mut Vec<FieldError>,
) -> Option<T> {
    let name = name?;
    let found = find(name);
    if found.is_none() {
        errors.push(FieldError::new(field, unknown(field, name)));
    }
    found
}

/// Refuses a request with wrong fields.
pub fn refuse_wrong(errors: Vec<FieldError>) -> Result<(), Problem> {
    if errors.is_empty() { Ok(()) } else { Err(Problem::invalid(errors)) }
}

/// A limit within bounds.
pub fn checked_limit(limit: Option<u32>, usual: u32) -> Result<u32, Problem> {
    match limit.unwrap_or(usual) {
        n @ 1..=LONGEST_PAGE => Ok(n),
        n => Err(Problem::invalid(vec![FieldError::new("limit", requests::not_between(n, 1, LONGEST_PAGE))])),
    }
}

/// One page of a list.
pub fn page<T>(all: Vec<T>, p: &Paging) -> Result<Json<Page<T>>, Problem> {
    let limit = checked_limit(p.limit, 100)? as usize;
    let start = match p.cursor.as_deref().map(str::parse::<usize>) {
        None => 0,
        Some(Ok(start)) => start,
        Some(Err(_)) => {
            return Err(Problem::invalid(vec![FieldError::new("cursor", requests::not_a_cursor())]));
        }
    };
    let end = start.saturating_add(limit);
    let next = (end < all.len()).then(|| end.to_string());
    Ok(Json(Page { items: all.into_iter().skip(start).take(limit).collect(), next }))
}

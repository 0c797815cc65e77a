//! `/v1/closures`: areas that operators close to robots, people or both.
//!
//! Main type: [`NewClosure`]. Refuses: empty areas, and times in the past.

use super::closing::{ClosingEffectDto, effect_of};
use super::recurring::NewRecurrence;
use crate::dto::names::{Names, Page};
use crate::dto::people::{ClosureDto, CoveredDto, RecurringClosureDto};
use crate::dto::refusal::refused;
use crate::http::shared::done::done;
use crate::http::shared::named::unknown;
use crate::http::shared::paging::{Paging, is_wanted, page, read_words, refuse_wrong};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, Params, PathPart, read_end, read_time};
use crate::wire::text::{closure_name, parse_closure, parse_series, series_name};
use crate::wire::words::{BindsDto, ClosureStateDto};
use axum::Json;
use axum::http::{HeaderName, StatusCode, header};
use giveway_fleet::{AreaRefusal, Ask, Binds, Closure, Recurrence, RecurringClosure, Refusal};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::{ClosureId, NodeId, SeriesId};
use giveway_floor::text::sentence::{refusals, requests};
use giveway_floor::time::{Time, Window};
use giveway_people::aware::check_area;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// The most corners of an area, and the most named nodes.
const MOST_CORNERS: usize = 100;

/// The longest reason, in characters.
const LONGEST_REASON: usize = 500;

/// Distance of the outline around named nodes, metres.
const AROUND_NODE_M: f64 = 0.25;

/// An area to keep out of: an outline, or nodes.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewClosure {
    /// Corners of the area, 3 to 100, each `[x, y]` in metres.
    outline: Option<Vec<[f64; 2]>>,
    /// Instead of an outline, the names of 1 to 100 nodes: only these are closed. The outline in the answer goes around
    /// them.
    nodes: Option<Vec<String>>,
    /// When the closure begins, RFC 3339; at once if absent.
    from: Option<String>,
    /// When the closure ends, RFC 3339; if absent, the area stays closed until somebody opens it.
    #[schema(example = "2027-01-31T12:00:00Z")]
    until: Option<String>,
    /// Why the area is closed; people see this text.
    #[schema(example = "oil on the floor")]
    reason: String,
    /// Whether the closure keeps out robots, people or both; both if absent.
    #[schema(value_type = Option<BindsDto>, example = "both")]
    binds: Option<String>,
    /// Makes the closure recur. `from` and `until` then limit the time in which occurrences begin.
    recurs: Option<NewRecurrence>,
}

/// The new closure and its effect: a single one, or a recurring one.
///
/// An enum of two whole structs, since client generators drop an enum that is flattened into a struct.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
pub enum JustClosedDto {
    /// A single closure.
    Once(JustClosedAreaDto<ClosureDto>),
    /// A recurring closure.
    Recurring(JustClosedAreaDto<RecurringClosureDto>),
}

/// A closed area, what it contains, and the effect of closing it.
#[derive(Serialize, ToSchema)]
pub struct JustClosedAreaDto<T> {
    /// The closed area.
    #[serde(flatten)]
    closed: T,
    /// What the area contains.
    covered: CoveredDto,
    /// The effect on robots, racks and jobs, as things stood when the request came.
    effect: ClosingEffectDto,
}

/// A closed area: a single closure, or a recurring one.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
pub enum ClosedDto {
    /// A single closure.
    Once(ClosedAreaDto<ClosureDto>),
    /// A recurring closure.
    Recurring(ClosedAreaDto<RecurringClosureDto>),
}

/// A closed area, and what it contains.
#[derive(Serialize, ToSchema)]
pub struct ClosedAreaDto<T> {
    /// The closed area.
    #[serde(flatten)]
    pub closed: T,
    /// What the area contains.
    pub covered: CoveredDto,
}

/// The closure of an id.
enum ClosedId {
    Once(ClosureId),
    Recurring(SeriesId),
}

/// Filters for the list of closed areas.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ClosureParams {
    /// Only areas in this state, or in one of several with commas between them.
    #[param(value_type = Option<Vec<ClosureStateDto>>, style = Form, explode = false)]
    state: Option<String>,
    /// Only areas that keep out robots, people or both, or any of several with commas between them.
    #[param(value_type = Option<Vec<BindsDto>>, style = Form, explode = false)]
    binds: Option<String>,
    /// Only areas that are closed at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only areas that are closed before this time, RFC 3339.
    to: Option<String>,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List closed areas: those that are closed or announced, and those whose closure ended less than a day ago.
#[utoipa::path(get, path = "/v1/closures", tag = "people", operation_id = "listClosures",
    params(ClosureParams), responses(
    (status = 200, description = "Areas in the order in which they were requested", body = Page<ClosureDto>)))]
pub async fn list(
    Called(api): Called,
    Params(p): Params<ClosureParams>,
) -> Result<Json<Page<ClosureDto>>, Problem> {
    let mut errors = Vec::new();
    let states = ClosureStateDto::ALL.map(ClosureStateDto::word);
    let states = read_words("state", p.state.as_deref(), &states, &mut errors);
    let binds = BindsDto::ALL.map(BindsDto::word);
    let binds = read_words("binds", p.binds.as_deref(), &binds, &mut errors);
    let from = read_time("from", p.from.as_deref(), &mut errors);
    let to = read_end("to", p.to.as_deref(), &mut errors);
    refuse_wrong(errors)?;
    let (moment, now) = (api.moment(), (api.now)());
    let names = Names { map: &api.map, view: &moment.view };
    let is_within =
        |window: Window| from.is_none_or(|t| window.end() > t) && to.is_none_or(|t| window.start() < t);
    let closures = moment.view.closures.iter().filter(|c| is_within(c.closure.window));
    let closures = closures.map(|c| names.closure(c.id, &c.closure, now));
    let closures =
        closures.filter(|c| is_wanted(&states, c.state.word()) && is_wanted(&binds, c.binds.word()));
    page(closures.collect(), &Paging { limit: p.limit, cursor: p.cursor })
}

/// Close an area, now or later. When this call returns, the closure is durable. Before the closure begins, robots are
/// routed around the area, and robots parked inside leave it; once it has begun, robots inside drive out and other
/// robots stay out. When the closure ends, the area opens by itself.
#[utoipa::path(post, path = "/v1/closures", tag = "people",
    operation_id = "closeArea", request_body = NewClosure,
    params(("Idempotency-Key" = Option<String>, Header,
        description = "Your own key, up to 255 characters: a repeat gets the same answer and makes nothing")),
    responses(
    (status = 201, description = "Closed and durable", body = JustClosedDto, headers(("Location" = String))),
    (status = 409, description = "The request with this key is still in progress, or its outcome is not known"),
    (status = 429)))]
pub async fn close(
    Called(api): Called,
    JsonBody(new): JsonBody<NewClosure>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<JustClosedDto>), Problem> {
    let (area, recurs) = new.read(&api)?;
    let effect = effect_of(&api, &area).await?;
    if let Some((recurrence, earliest)) = recurs {
        let series = RecurringClosure::new(area, recurrence).not_before(earliest);
        return recur(&api, series, effect).await;
    }
    let closure = api.ask(Ask::close(area.clone())).await?;
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let ClosedAreaDto { closed, covered } = once(names, closure, &area, (api.now)());
    let place = format!("/v1/closures/{}", closure_name(closure));
    let just_closed = JustClosedDto::Once(JustClosedAreaDto { closed, covered, effect });
    Ok((StatusCode::CREATED, [(header::LOCATION, place)], Json(just_closed)))
}

/// Preview the effect of closing an area now: stations and racks that would be cut off, robots that would be trapped,
/// jobs that would wait, and jobs in progress that lead through the area. Nothing is closed.
#[utoipa::path(post, path = "/v1/closures/preview", tag = "people",
    operation_id = "previewClosure", request_body = NewClosure,
    responses(
    (status = 200, description = "What it would do", body = ClosingEffectDto)))]
pub async fn preview(
    Called(api): Called,
    JsonBody(new): JsonBody<NewClosure>,
) -> Result<Json<ClosingEffectDto>, Problem> {
    let (area, _) = new.read(&api)?;
    Ok(Json(effect_of(&api, &area).await?))
}

async fn recur(
    api: &Api,
    closure: RecurringClosure,
    effect: ClosingEffectDto,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<JustClosedDto>), Problem> {
    let series = api.ask(Ask::recur(closure.clone())).await?;
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let ClosedAreaDto { closed, covered } = recurring(names, series, &closure, (api.now)());
    let place = format!("/v1/closures/{}", series_name(series));
    let just_closed = JustClosedDto::Recurring(JustClosedAreaDto { closed, covered, effect });
    Ok((StatusCode::CREATED, [(header::LOCATION, place)], Json(just_closed)))
}

/// Get one closure, single or recurring.
#[utoipa::path(get, path = "/v1/closures/{id}", tag = "people", operation_id = "getClosure",
    params(("id" = String, Path, example = "c2")), responses(
    (status = 200, description = "The area", body = ClosedDto)))]
pub async fn get(Called(api): Called, PathPart(id): PathPart) -> Result<Json<ClosedDto>, Problem> {
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let id = match parse_id(&id)? {
        ClosedId::Once(id) => id,
        ClosedId::Recurring(series) => {
            let found = moment.view.recurring.get(&series);
            let found =
                found.ok_or_else(|| refused(&api.map, Refusal::Area(AreaRefusal::UnknownSeries(series))))?;
            return Ok(Json(ClosedDto::Recurring(recurring(names, series, found, (api.now)()))));
        }
    };
    let found = moment.view.closures.iter().find(|c| c.id == id);
    let detail = || refusals::closure_unknown(closure_name(id));
    let found = found.ok_or_else(|| Problem::unknown("closure", detail()))?;
    Ok(Json(ClosedDto::Once(once(names, id, &found.closure, (api.now)()))))
}

fn once(names: Names<'_>, id: ClosureId, area: &Closure, now: Time) -> ClosedAreaDto<ClosureDto> {
    ClosedAreaDto { closed: names.closure(id, area, now), covered: names.covered(area) }
}

fn recurring(
    names: Names<'_>,
    id: SeriesId,
    area: &RecurringClosure,
    now: Time,
) -> ClosedAreaDto<RecurringClosureDto> {
    ClosedAreaDto { closed: names.recurring(id, area, now), covered: names.covered(&area.area) }
}

/// Open an area again. For a recurring closure, open one occurrence (c7), or end the recurrence for good (s1).
#[utoipa::path(delete, path = "/v1/closures/{id}", tag = "people", operation_id = "openArea",
    params(("id" = String, Path, example = "c2")), responses(
    (status = 204, description = "Open again")))]
pub async fn reopen(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    let open = match parse_id(&id)? {
        ClosedId::Once(id) => Ask::reopen(id),
        ClosedId::Recurring(series) => Ask::end_series(series),
    };
    done(&api, open).await
}

fn parse_id(text: &str) -> Result<ClosedId, Problem> {
    let detail = || requests::not_a_closure_id(text);
    let recurring = || parse_series(text).map(ClosedId::Recurring);
    parse_closure(text)
        .map(ClosedId::Once)
        .or_else(recurring)
        .ok_or_else(|| Problem::unknown("closure", detail()))
}

impl NewClosure {
    /// The area and, if it recurs, the recurrence and when it starts.
    pub(super) fn read(&self, api: &Api) -> Result<(Closure, Option<(Recurrence, Time)>), Problem> {
        let mut errors = Vec::new();
        let mut nodes = Vec::new();
        let binds = self.binds.as_deref().map_or(Some(Binds::default()), Binds::of);
        if binds.is_none() {
            errors.push(FieldError::new("binds", requests::binds_whom()));
        }
        let binds = binds.unwrap_or_default();
        let outline = match (&self.outline, &self.nodes) {
            (Some(corners), None) => checked_outline(api, corners, binds, &mut errors),
            (None, Some(names)) => {
                nodes = named(api, names, &mut errors);
                around(api, &nodes)
            }
            _ => {
                errors.push(FieldError::new("outline", requests::outline_or_nodes()));
                Vec::new()
            }
        };
        let now = (api.now)();
        let from = read_time("from", self.from.as_deref(), &mut errors).unwrap_or(now);
        let given = self.from.as_ref().map(|_| from);
        let until = read_end("until", self.until.as_deref(), &mut errors).unwrap_or(Time::MAX);
        if until <= from.max(now) {
            errors.push(FieldError::new("until", requests::until_after_from()));
        }
        let reason = self.reason.trim();
        if reason.is_empty() || reason.chars().count() > LONGEST_REASON {
            errors.push(FieldError::new("reason", requests::say_why_closed(LONGEST_REASON)));
        }
        let recurs = self.recurs.as_ref().and_then(|r| r.read((given, until), now, &mut errors));
        if !errors.is_empty() {
            return Err(Problem::invalid(errors));
        }
        let outline = outline.into_iter().map(Spot::from).collect();
        let window = recurs.as_ref().map_or_else(|| Window::new(from, until), |(window, ..)| *window);
        let area = Closure { outline, nodes, window, reason: reason.into(), binds, series: None };
        Ok((area, recurs.map(|(_, recurrence, earliest)| (recurrence, earliest))))
    }
}

/// The corners of an area; adds an error if they are not on this floor.
fn checked_outline(
    api: &Api,
    corners: &[[f64; 2]],
    binds: Binds,
    errors: &mut Vec<FieldError>,
) -> Vec<Point> {
    let outline: Vec<Point> = corners.iter().map(|c| Point::new(c[0], c[1])).collect();
    if !(3..=MOST_CORNERS).contains(&outline.len()) {
        errors.push(FieldError::new("outline", requests::corners_out_of_range(MOST_CORNERS)));
    } else if let Err(fault) = check_area(&api.map, &outline, binds.robots(), binds.people()) {
        errors.push(FieldError::new("outline", fault.sentence()));
    }
    outline
}

/// The nodes of these names; adds an error for each unknown name.
fn named(api: &Api, names: &[String], errors: &mut Vec<FieldError>) -> Vec<NodeId> {
    if names.is_empty() || names.len() > MOST_CORNERS {
        errors.push(FieldError::new("nodes", requests::node_names_out_of_range(MOST_CORNERS)));
        return Vec::new();
    }
    let mut nodes = Vec::new();
    for (i, name) in names.iter().enumerate() {
        match api.map.node_named(name) {
            Some(node) => nodes.push(node),
            None => {
                errors.push(FieldError::new(format!("nodes[{i}]"), unknown("node", name)));
            }
        }
    }
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// The convex outline around the surroundings of some nodes, for display on a map.
fn around(api: &Api, nodes: &[NodeId]) -> Vec<Point> {
    let d = AROUND_NODE_M;
    let square =
        |at: Point| [(-d, -d), (d, -d), (d, d), (-d, d)].map(|(x, y)| Point::new(at.x + x, at.y + y));
    hull(nodes.iter().flat_map(|n| square(api.map.nodes[*n].at)).collect())
}

/// Twice the signed area of the triangle `abc`.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b - a).perp(&(c - a))
}

/// The convex hull, counter-clockwise (Andrew 1979, monotone chain).
fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while chain.len() > 1 && turn(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0.0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let lower = half(&mut points.iter().copied());
    let upper = half(&mut points.iter().rev().copied());
    [lower, upper].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_goes_around_all_points_once() {
        let points = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.5), (2.0, 2.0), (1.0, 0.0), (0.0, 2.0)];
        let around = hull(points.iter().map(|p| Point::new(p.0, p.1)).collect());
        assert_eq!(around.len(), 4, "{around:?}");
        assert_eq!(giveway_floor::geometry::outline_area_m2(&around), Ok(4.0));
    }
}

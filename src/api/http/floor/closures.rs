//! `/v1/closures`: areas that robots, people or both keep out of, marked by hand.
//!
//! Main type: [`NewClosure`]. Refuses: areas of nothing, and times that are over.

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

/// The most corners.
const MOST_CORNERS: usize = 100;

/// The longest reason.
const LONGEST_REASON: usize = 500;

/// The outline goes around nodes at this distance, metres.
const AROUND_NODE_M: f64 = 0.25;

/// An area to keep out of: an outline, or nodes.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewClosure {
    /// Its corners, metres, 3 to 100.
    outline: Option<Vec<[f64; 2]>>,
    /// Or the names of 1 to 100 nodes: only these are closed. The outline in the answer goes around all of them.
    nodes: Option<Vec<String>>,
    /// From when, RFC 3339; at once if absent.
    from: Option<String>,
    /// Until when, RFC 3339; if absent, until somebody opens it.
    #[schema(example = "2027-01-31T12:00:00Z")]
    until: Option<String>,
    /// Why, for people who see it.
    #[schema(example = "oil on the floor")]
    reason: String,
    /// Whom it keeps out; both if absent.
    #[schema(value_type = Option<BindsDto>, example = "both")]
    binds: Option<String>,
    /// Closed again and again. `from` and `until` then say between which times occurrences begin.
    recurs: Option<NewRecurrence>,
}

/// What was closed and what that does: an area once, or again and again.
///
/// A choice of wholes rather than a whole with a choice inside, which generators of clients leave out.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
pub enum JustClosedDto {
    /// Once.
    Once(JustClosedAreaDto<ClosureDto>),
    /// Again and again.
    Recurring(JustClosedAreaDto<RecurringClosureDto>),
}

/// A closed area, what it covers, and what closing it does.
#[derive(Serialize, ToSchema)]
pub struct JustClosedAreaDto<T> {
    /// The area.
    #[serde(flatten)]
    closed: T,
    /// What it covers.
    covered: CoveredDto,
    /// What closing it does to robots, racks and jobs, as things stood.
    effect: ClosingEffectDto,
}

/// What was closed: an area once, or again and again.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
pub enum ClosedDto {
    /// Once.
    Once(ClosedAreaDto<ClosureDto>),
    /// Again and again.
    Recurring(ClosedAreaDto<RecurringClosureDto>),
}

/// A closed area, and what it covers.
#[derive(Serialize, ToSchema)]
pub struct ClosedAreaDto<T> {
    /// The area.
    #[serde(flatten)]
    pub closed: T,
    /// What it covers.
    pub covered: CoveredDto,
}

/// What a closure's number stands for.
enum ClosedId {
    Once(ClosureId),
    Recurring(SeriesId),
}

/// Which closed areas to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ClosureParams {
    /// Only areas in this state, or in one of several with commas between them.
    #[param(value_type = Option<Vec<ClosureStateDto>>, style = Form, explode = false)]
    state: Option<String>,
    /// Only areas that keep these out, or one of several with commas between them.
    #[param(value_type = Option<Vec<BindsDto>>, style = Form, explode = false)]
    binds: Option<String>,
    /// Only areas that are closed at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// Only areas that are closed before this time.
    to: Option<String>,
    /// How many items at most, 1 to 500; 100 if absent.
    limit: Option<u32>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// All areas that are closed or announced, and those whose closure ended less than a day ago; or some of them.
#[utoipa::path(get, path = "/v1/closures", tag = "people", operation_id = "listClosures",
    params(ClosureParams), responses(
    (status = 200, description = "Areas in the order in which they were requested", body = Page<ClosureDto>),
    (status = 422)))]
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

/// Close an area, now or later. When this call returns, the closure is durable. Before it begins, robots are routed
/// around it and robots parked inside leave; once it has begun, robots inside drive out and others stay out. At its
/// end the area opens by itself.
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

/// What closing an area would do as things stand: which stations and racks it would cut off, which robots it would
/// trap, which jobs would wait and which are under way through it. Nothing is closed.
#[utoipa::path(post, path = "/v1/closures/preview", tag = "people",
    operation_id = "previewClosure", request_body = NewClosure,
    responses(
    (status = 200, description = "What it would do", body = ClosingEffectDto),
    (status = 503, description = "Too many questions; see Retry-After")))]
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

/// One closed area, or one that is closed again and again.
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

/// Open an area again. Of a recurring closure, one occurrence (c7), or all of them for good (s1).
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
    /// The area, and if it recurs, when and from when on.
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

/// The corners of an area; complains where they are none of this floor.
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

/// The nodes of these names.
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

/// The convex outline of all that is close to some nodes, for those who look at a map.
fn around(api: &Api, nodes: &[NodeId]) -> Vec<Point> {
    let d = AROUND_NODE_M;
    let square =
        |at: Point| [(-d, -d), (d, -d), (d, d), (-d, d)].map(|(x, y)| Point::new(at.x + x, at.y + y));
    hull(nodes.iter().flat_map(|n| square(api.map.nodes[*n].at)).collect())
}

/// Twice the signed area of the triangle.
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

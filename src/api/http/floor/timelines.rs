//! `/v1/timelines`: what the planner knows about an area of the floor, node by node.
//!
//! Main types: [`TimelinesDto`], [`AreaParams`]. Refuses: areas with too many nodes, and a long look ahead: everything
//! that far ahead is replanned before it happens.

use crate::dto::names::Names;
use crate::port::questions::Question;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::Params;
use crate::wire::text::{closure_name, round3, time_text, worker_name};
use crate::wire::words::{CauseKindDto, EffectDto, HolderKindDto};
use axum::Json;
use giveway_fleet::{Area, MOST_NODES, NodeOccupancy, Party, RegionStay, SafetyRegion};
use giveway_floor::geometry::{FARTHEST_M, Point};
use giveway_floor::route::{Cause, Condition, Effect};
use giveway_floor::text::SentenceArg;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::timeline::{Held, Layer};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// How far ahead a request may look, seconds.
const FARTHEST_S: f64 = 120.0;

/// How far ahead to look if the request does not say, seconds.
const USUAL_S: f64 = 60.0;

/// An area of the floor.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct AreaParams {
    /// x of one corner, metres.
    x0: f64,
    /// y of one corner, metres.
    y0: f64,
    /// x of the opposite corner, metres.
    x1: f64,
    /// y of the opposite corner, metres.
    y1: f64,
    /// How far to look ahead, seconds, 1 to 120; 60 if absent.
    ahead_s: Option<f64>,
}

/// What the planner knows about an area of the floor.
#[derive(Debug, Serialize, ToSchema)]
pub struct TimelinesDto {
    /// The time of this answer, RFC 3339. All other times are seconds from it.
    pub at: String,
    /// How far ahead the answer reaches, seconds.
    pub ahead_s: f64,
    /// The nodes, starting at the top left.
    pub nodes: Vec<StripDto>,
}

/// What the planner knows about one node.
#[derive(Debug, Serialize, ToSchema)]
pub struct StripDto {
    /// The node's name.
    #[schema(example = "R33")]
    pub id: String,
    /// The node's x, metres.
    pub x: f64,
    /// The node's y, metres.
    pub y: f64,
    /// The holds of the node by robots and workers, in order.
    pub holds: Vec<HoldDto>,
    /// Conditions that people and closures impose on the node.
    pub conditions: Vec<ConditionDto>,
    /// Safety regions that the node is in, and when.
    pub regions: Vec<RegionStayDto>,
}

/// A time in which a node is in a safety region.
#[derive(Debug, Serialize, ToSchema)]
pub struct RegionStayDto {
    /// The robot or worker around which the region lies.
    #[schema(example = "robot-2")]
    pub of: String,
    /// Whether `of` is a robot or a worker.
    pub kind: HolderKindDto,
    /// 2: nothing is planned into this region; 3: around region 2, robots are slow. For regions of a robot: where a
    /// person would be that near to the robot.
    pub region: u8,
    /// Start in seconds from `at`; negative if it has begun.
    pub from_s: f64,
    /// End in seconds from `at`; null if it has no end.
    pub to_s: Option<f64>,
}

/// A hold: the node belongs to a robot or worker for a time.
#[derive(Debug, Serialize, ToSchema)]
pub struct HoldDto {
    /// The robot or worker that holds the node.
    #[schema(example = "robot-2")]
    pub by: String,
    /// Whether `by` is a robot or a worker.
    pub kind: HolderKindDto,
    /// Start in seconds from `at`; negative if it has begun.
    pub from_s: f64,
    /// End in seconds from `at`; null if it has no end.
    pub to_s: Option<f64>,
    /// Whether the hold is granted, not only reserved: the holder may be there already.
    pub granted: bool,
    /// Whether the hold is of a resource in conflict with the node, not of the node itself.
    pub conflict: bool,
}

/// A condition on a node.
#[derive(Debug, Serialize, ToSchema)]
pub struct ConditionDto {
    /// The worker, the closure, or the robot that stands there but has its reservations elsewhere.
    #[schema(example = "w1")]
    pub by: String,
    /// What imposes the condition.
    pub kind: CauseKindDto,
    /// Start in seconds from `at`; negative if it has begun.
    pub from_s: f64,
    /// End in seconds from `at`; null if it has no end.
    pub to_s: Option<f64>,
    /// The effect on robots.
    pub effect: EffectDto,
    /// For `slow`: the top speed, metres per second, without and with a rack.
    pub limit_mps: Option<[f64; 2]>,
    /// For `price`: the cost, in seconds of delay.
    pub price_s: Option<f64>,
}

/// Get which robots and workers hold the nodes of an area and when, and what people and closed areas impose there, for
/// up to two minutes ahead.
#[utoipa::path(get, path = "/v1/timelines", tag = "floor", operation_id = "getTimelines", params(AreaParams), responses(
    (status = 200, description = "Up to 200 nodes, from the top left on", body = TimelinesDto)))]
pub async fn timelines(
    Called(api): Called,
    Params(p): Params<AreaParams>,
) -> Result<Json<TimelinesDto>, Problem> {
    let (area, ahead) = p.read()?;
    let seen = api.query(|reply| Question::Occupancy(area, ahead, reply)).await?;
    let strips = seen.what.map_err(|count| {
        let detail = requests::area_too_large(count, MOST_NODES);
        Problem::invalid(vec![FieldError::new("area", detail)])
    })?;
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let nodes = strips.iter().map(|s| strip(names, s, seen.at)).collect();
    Ok(Json(TimelinesDto { at: time_text(seen.at), ahead_s: ahead.as_secs_f64(), nodes }))
}

impl AreaParams {
    fn read(&self) -> Result<(Area, Span), Problem> {
        let mut errors = Vec::new();
        for (field, value) in [("x0", self.x0), ("y0", self.y0), ("x1", self.x1), ("y1", self.y1)] {
            if value.is_nan() || value.abs() > FARTHEST_M {
                errors.push(FieldError::new(field, requests::metres_on_the_map(FARTHEST_M as i64)));
            }
        }
        let ahead_s = self.ahead_s.unwrap_or(USUAL_S);
        if !(1.0..=FARTHEST_S).contains(&ahead_s) {
            errors.push(FieldError::new(
                "ahead_s",
                requests::not_between(SentenceArg::up_to(ahead_s, 3), 1, FARTHEST_S as i64),
            ));
        }
        if !errors.is_empty() {
            return Err(Problem::invalid(errors));
        }
        let low = Point::new(self.x0.min(self.x1), self.y0.min(self.y1));
        let high = Point::new(self.x0.max(self.x1), self.y0.max(self.y1));
        Ok((Area { low, high }, Span::from_secs_f64(ahead_s)))
    }
}

fn strip(names: Names, strip: &NodeOccupancy, at: Time) -> StripDto {
    let place = names.map.nodes[strip.node].at;
    StripDto {
        id: names.node(strip.node),
        x: round3(place.x),
        y: round3(place.y),
        holds: strip.holds.iter().map(|h| hold(names, h, at)).collect(),
        conditions: strip.conditions.iter().map(|c| condition(names, c, at)).collect(),
        regions: strip.regions.iter().map(|r| region_stay(names, r, at)).collect(),
    }
}

fn region_stay(names: Names, stay: &RegionStay, at: Time) -> RegionStayDto {
    let (of, kind) = match stay.of {
        Party::Robot(r) => (names.robot(r), HolderKindDto::Robot),
        Party::Worker(w) => (worker_name(w), HolderKindDto::Worker),
    };
    let region = match stay.region {
        SafetyRegion::KeepOut => 2,
        SafetyRegion::Slow => 3,
    };
    let (from_s, to_s) = seconds(stay.window, at);
    RegionStayDto { of, kind, region, from_s, to_s }
}

fn hold(names: Names, held: &Held, at: Time) -> HoldDto {
    let (by, kind) = (names.robot(held.holder), HolderKindDto::Robot);
    let (from_s, to_s) = seconds(held.window, at);
    HoldDto { by, kind, from_s, to_s, granted: held.granted, conflict: held.layer == Layer::Conflict }
}

fn condition(names: Names, c: &Condition, at: Time) -> ConditionDto {
    let (by, kind) = match c.cause {
        Cause::Worker(w) => (worker_name(w), CauseKindDto::Worker),
        Cause::Closure(c) => (closure_name(c), CauseKindDto::Closure),
        Cause::Robot(r) => (names.robot(r), CauseKindDto::Robot),
        Cause::Obstruction(n) => (names.node(n), CauseKindDto::Obstruction),
        Cause::Evacuation => ("evacuation".into(), CauseKindDto::Evacuation),
    };
    let (effect, limit_mps, price_s) = match c.effect {
        Effect::Closed => (EffectDto::Closed, None, None),
        Effect::NoEntryOrExit => (EffectDto::Still, None, None),
        // An infinite limit has no number in JSON.
        Effect::Slow(l) => (EffectDto::Slow, Some(l.map(round3)), None),
        Effect::SoftCost(p) => (EffectDto::Price, None, Some(round3(p.as_secs_f64()))),
    };
    let (from_s, to_s) = seconds(c.window, at);
    ConditionDto { by, kind, from_s, to_s, effect, limit_mps, price_s }
}

/// Both ends of a window, in seconds from `at`.
fn seconds(w: Window, at: Time) -> (f64, Option<f64>) {
    let s = |t: Time| round3((t - at).as_secs_f64());
    (s(w.start()), (!w.end().is_forever()).then(|| s(w.end())))
}

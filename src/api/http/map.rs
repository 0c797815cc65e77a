//! `/v1/map`: the building, once; it does not change while the server runs.
//!
//! Main type: [`MapDto`]. Refuses: anything that moves.

use crate::api::Api;
use crate::api::dto::round3;
use crate::geometry::Point;
use crate::id::Dense;
use crate::warehouse::{NodeKind, Users, Warehouse};
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use sha2::{Digest, Sha256};
use utoipa::ToSchema;

/// The building. Everything else refers to nodes by their index here.
#[derive(Serialize, ToSchema)]
pub struct MapDto {
    name: String,
    /// x0, y0, x1, y1, metres.
    bounds: [f64; 4],
    /// Side of the square that a robot with its rack takes, metres.
    footprint_m: f64,
    nodes: Vec<NodeDto>,
    lanes: Vec<LaneDto>,
    stations: Vec<StationPlaceDto>,
    racks: Vec<RackHomeDto>,
    /// Outlines of what stands in the way.
    obstacles: Vec<Vec<[f64; 2]>>,
    /// Outlines of the floor on which people may walk.
    walkable: Vec<Vec<[f64; 2]>>,
}

/// A place where a robot can stand.
#[derive(Serialize, ToSchema)]
struct NodeDto {
    id: String,
    x: f64,
    y: f64,
    /// aisle, storage, station, queue, charger, parking or exit.
    kind: &'static str,
}

/// A lane between two nodes.
#[derive(Serialize, ToSchema)]
struct LaneDto {
    /// Index of a node.
    from: usize,
    /// Index of a node.
    to: usize,
    /// Whether it may be driven both ways.
    both: bool,
    /// Who may use it: loaded, unloaded, people.
    #[serde(rename = "for")]
    users: Vec<&'static str>,
}

/// A picking station.
#[derive(Serialize, ToSchema)]
struct StationPlaceDto {
    id: String,
    /// Index of its node.
    node: usize,
    /// Indices of its waiting places, the one next to the station first.
    queue: Vec<usize>,
}

/// A rack.
#[derive(Serialize, ToSchema)]
struct RackHomeDto {
    id: String,
    /// Index of the node on which it stands at first.
    node: usize,
}

/// The building.
#[utoipa::path(get, path = "/v1/map", tag = "floor", responses(
    (status = 200, description = "The building", body = MapDto),
    (status = 304, description = "Still the one with the ETag in If-None-Match")))]
pub async fn map(State(api): State<Api>, headers: HeaderMap) -> Response {
    let text = map_text(&api.map);
    let digest = Sha256::digest(&text);
    let etag = format!("\"{}\"", digest[..12].iter().map(|b| format!("{b:02x}")).collect::<String>());
    let known = headers.get(header::IF_NONE_MATCH).and_then(|v| v.to_str().ok());
    if known.is_some_and(|known| known.contains(&etag)) {
        return (StatusCode::NOT_MODIFIED, [(header::ETAG, etag)]).into_response();
    }
    let headers = [
        (header::ETAG, etag.as_str()),
        (header::CONTENT_TYPE, "application/json"),
        (header::CACHE_CONTROL, "no-cache"),
    ];
    (headers, text).into_response()
}

/// The building as JSON.
pub fn map_text(map: &Warehouse) -> String {
    serde_json::to_string(&MapDto::from(map)).expect("maps are plain")
}

impl From<&Warehouse> for MapDto {
    fn from(w: &Warehouse) -> MapDto {
        let (low, high) = w.bounds();
        let pair = |p: &Point| [round3(p.x), round3(p.y)];
        let outlines = |o: &[Vec<Point>]| o.iter().map(|ring| ring.iter().map(pair).collect()).collect();
        MapDto {
            name: w.name.clone(),
            bounds: [round3(low.x), round3(low.y), round3(high.x), round3(high.y)],
            footprint_m: w.footprint_m,
            nodes: w
                .nodes
                .iter()
                .map(|n| NodeDto {
                    id: n.name.clone(),
                    x: round3(n.at.x),
                    y: round3(n.at.y),
                    kind: kind_word(n.kind),
                })
                .collect(),
            lanes: w
                .lanes
                .iter()
                .map(|l| LaneDto { from: l.a.ix(), to: l.b.ix(), both: l.both, users: user_words(l.users) })
                .collect(),
            stations: w
                .stations
                .iter()
                .map(|s| StationPlaceDto {
                    id: s.name.clone(),
                    node: s.node.ix(),
                    queue: s.queue.iter().map(|n| n.ix()).collect(),
                })
                .collect(),
            racks: w.racks.iter().map(|r| RackHomeDto { id: r.name.clone(), node: r.home.ix() }).collect(),
            obstacles: outlines(&w.obstacles),
            walkable: outlines(&w.walkable),
        }
    }
}

fn kind_word(kind: NodeKind) -> &'static str {
    match kind {
        NodeKind::Aisle => "aisle",
        NodeKind::Storage => "storage",
        NodeKind::Station(_) => "station",
        NodeKind::Queue(_) => "queue",
        NodeKind::Charger => "charger",
        NodeKind::Parking => "parking",
        NodeKind::Exit => "exit",
    }
}

fn user_words(users: Users) -> Vec<&'static str> {
    let all = [(users.loaded, "loaded"), (users.unloaded, "unloaded"), (users.people, "people")];
    all.into_iter().filter(|(may, _)| *may).map(|(_, word)| word).collect()
}

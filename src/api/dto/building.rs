//! The building on the wire, sent once for each version.
//!
//! Main type: [`MapDto`]; main function [`map_text`]. Refuses: anything that moves.

use crate::wire::text::round3;
use giveway_floor::geometry::Point;
use giveway_floor::id::Dense;
use giveway_floor::warehouse::formats::json;
use giveway_floor::warehouse::{NodeKind, Users, Warehouse};
use serde::Serialize;
use sha2::{Digest, Sha256};
use utoipa::ToSchema;

/// The building. All other messages refer to nodes by their index here.
#[derive(Serialize, ToSchema)]
pub struct MapDto {
    /// The version of the map's content: maps that differ have different versions. It is the map's ETag, too.
    #[schema(example = "5f2c8a1b90de4f6677c31a02")]
    version: String,
    name: String,
    /// Bounds of the map: x0, y0, x1, y1, metres.
    bounds: [f64; 4],
    /// Side of the square that a robot with its rack occupies, metres.
    footprint_m: f64,
    nodes: Vec<NodeDto>,
    lanes: Vec<LaneDto>,
    stations: Vec<StationPlaceDto>,
    racks: Vec<RackHomeDto>,
    /// Outlines of obstacles.
    obstacles: Vec<Vec<[f64; 2]>>,
    /// Outlines of the floor where people may walk.
    walkable: Vec<Vec<[f64; 2]>>,
    /// Marks on the floor, by which headsets determine where they are.
    marks: Vec<MarkDto>,
}

/// A mark on the floor.
#[derive(Serialize, ToSchema)]
struct MarkDto {
    name: String,
    /// The mark's x, metres.
    x: f64,
    /// The mark's y, metres.
    y: f64,
}

/// A place where a robot can stand.
#[derive(Serialize, ToSchema)]
struct NodeDto {
    id: String,
    x: f64,
    y: f64,
    /// The kind of node: aisle, storage, station, queue, charger, parking or exit.
    kind: &'static str,
}

/// A lane between two nodes.
#[derive(Serialize, ToSchema)]
struct LaneDto {
    /// Index of the node where the lane begins.
    from: usize,
    /// Index of the node where the lane ends.
    to: usize,
    /// Whether the lane may be driven both ways.
    both: bool,
    /// What may use the lane: loaded robots, unloaded robots, people.
    #[serde(rename = "for")]
    users: Vec<&'static str>,
}

/// A picking station.
#[derive(Serialize, ToSchema)]
struct StationPlaceDto {
    id: String,
    /// Index of the station's node.
    node: usize,
    /// Indices of the station's queue places, the one next to the station first.
    queue: Vec<usize>,
}

/// A rack.
#[derive(Serialize, ToSchema)]
struct RackHomeDto {
    id: String,
    /// Index of the node on which the rack stands at first.
    node: usize,
}

/// The building as JSON.
pub fn map_text(map: &Warehouse) -> String {
    serde_json::to_string(&MapDto { version: map_version(map), ..MapDto::from(map) }).expect("maps are plain")
}

/// The version of a map: a hash of everything that its file says and that clients receive of it.
pub fn map_version(map: &Warehouse) -> String {
    let sent = serde_json::to_string(&MapDto::from(map)).expect("maps are plain");
    let digest = Sha256::new().chain_update(sent).chain_update(json::write(map)).finalize();
    digest[..12].iter().map(|b| format!("{b:02x}")).collect()
}

impl From<&Warehouse> for MapDto {
    fn from(w: &Warehouse) -> MapDto {
        let (low, high) = w.bounds();
        let pair = |p: &Point| [round3(p.x), round3(p.y)];
        let outlines = |o: &[Vec<Point>]| o.iter().map(|ring| ring.iter().map(pair).collect()).collect();
        MapDto {
            version: String::new(),
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
            marks: (w.marks.iter())
                .map(|m| MarkDto { name: m.name.clone(), x: round3(m.at.x), y: round3(m.at.y) })
                .collect(),
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

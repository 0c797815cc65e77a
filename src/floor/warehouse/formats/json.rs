//! The project's own map format: JSON, one node or lane a line.
//!
//! Main functions: [`parse`], [`write()`]; `maps/map.schema.json` describes the format for other programs.
//! Refuses: unknown keys, other versions, and buildings with findings.

use super::MapError;
use super::cell_record::{CellRecord, RackTypeRecord};
use crate::geometry::Point;
use crate::id::NodeId;
use crate::time::Span;
use crate::warehouse::{
    Corridor, Draft, DraftLane, DraftNode, DraftRack, DraftStation, FloorMark, NodeKind, Users, Warehouse,
};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The version that this build reads and writes.
const VERSION: u32 = 1;

/// Reads and validates a map.
///
/// # Errors
/// [`MapError::Syntax`] with line and column, or [`MapError::Findings`] with everything that is wrong.
pub fn parse(text: &str) -> Result<Warehouse, MapError> {
    Ok(parse_draft(text)?.build()?)
}

/// Reads a map without validating it, so that it can be changed first.
///
/// # Errors
/// [`MapError::Syntax`] with line and column.
pub fn parse_draft(text: &str) -> Result<Draft, MapError> {
    let record: MapRecord = serde_json::from_str(text).map_err(|e| {
        let message = e.to_string();
        let plain = message.rsplit_once(" at line ").map_or(message.as_str(), |(plain, _)| plain);
        MapError::syntax(e.line(), e.column(), plain)
    })?;
    Ok(record.into())
}

/// Writes a map, one node or lane a line: reading it again gives the same map.
pub fn write(w: &Warehouse) -> String {
    let record = MapRecord::from(w);
    let mut text = String::from("{");
    field(&mut text, "giveway_map", &record.giveway_map);
    field(&mut text, "name", &record.name);
    field(&mut text, "footprint_m", &Number(record.footprint_m));
    rows(&mut text, "nodes", &record.nodes, 1);
    rows(&mut text, "lanes", &record.lanes, 1);
    rows(&mut text, "storage", &record.storage, 16);
    rows(&mut text, "rack_types", &record.rack_types, 1);
    rows(&mut text, "racks", &record.racks, 1);
    rows(&mut text, "stations", &record.stations, 1);
    rows(&mut text, "chargers", &record.chargers, 16);
    rows(&mut text, "parking", &record.parking, 16);
    rows(&mut text, "exits", &record.exits, 16);
    rows(&mut text, "walkable", &record.walkable, 1);
    rows(&mut text, "obstacles", &record.obstacles, 1);
    rows(&mut text, "marks", &record.marks, 1);
    text.pop();
    text.push_str("\n}\n");
    text
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("records have string keys and finite numbers only")
}

fn field(text: &mut String, key: &str, value: &impl Serialize) {
    text.push_str(&format!("\n\"{key}\":{},", json(value)));
}

/// Writes a list with `per_line` items a line, or nothing if it is empty and may be left out.
fn rows<T: Serialize>(text: &mut String, key: &str, items: &[T], per_line: usize) {
    if items.is_empty() && !["nodes", "lanes"].contains(&key) {
        return;
    }
    let line = |items: &[T]| items.iter().map(json).collect::<Vec<_>>().join(",");
    let lines: Vec<String> = items.chunks(per_line).map(line).collect();
    text.push_str(&format!("\n\"{key}\":[\n{}\n],", lines.join(",\n")));
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapRecord {
    #[serde(deserialize_with = "known_version")]
    giveway_map: u32,
    name: String,
    footprint_m: f64,
    nodes: Vec<NodeRecord>,
    lanes: Vec<LaneRecord>,
    #[serde(default)]
    storage: Vec<String>,
    #[serde(default)]
    rack_types: Vec<RackTypeRecord>,
    #[serde(default)]
    racks: Vec<RackRecord>,
    #[serde(default)]
    stations: Vec<StationRecord>,
    #[serde(default)]
    chargers: Vec<String>,
    #[serde(default)]
    parking: Vec<String>,
    #[serde(default)]
    exits: Vec<String>,
    #[serde(default)]
    walkable: Vec<Vec<Corner>>,
    #[serde(default)]
    obstacles: Vec<Vec<Corner>>,
    #[serde(default)]
    marks: Vec<MarkRecord>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MarkRecord {
    id: String,
    x: Number,
    y: Number,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NodeRecord {
    id: String,
    x: Number,
    y: Number,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LaneRecord {
    from: String,
    to: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    both: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    length_m: Option<Number>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    speed_limit_mps: Option<Number>,
    #[serde(default, rename = "for", skip_serializing_if = "Option::is_none")]
    users: Option<Vec<User>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kinds: Option<Vec<String>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    corridor: Option<CorridorRecord>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CorridorRecord {
    left: Number,
    right: Number,
}

#[derive(Serialize, Deserialize, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
enum User {
    Loaded,
    Unloaded,
    People,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RackRecord {
    id: String,
    node: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    load: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    weight_kg: Option<Number>,
    #[serde(default, rename = "type", skip_serializing_if = "Option::is_none")]
    rack_type: Option<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StationRecord {
    id: String,
    node: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    queue: Vec<String>,
    pick_s: Number,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cell: Option<CellRecord>,
}

/// A corner of an outline: `[x, y]`.
#[derive(Serialize, Deserialize, Clone, Copy)]
pub(super) struct Corner(pub Number, pub Number);

/// A number that is written without a fraction if it has none.
#[derive(Deserialize, Clone, Copy)]
#[serde(transparent)]
pub(super) struct Number(pub f64);

impl Corner {
    /// The corners of an outline.
    pub fn outline(corners: &[Corner]) -> Vec<Point> {
        corners.iter().map(|c| Point::new(c.0.0, c.1.0)).collect()
    }

    /// The corners of an outline in their written form.
    pub fn of_outline(outline: &[Point]) -> Vec<Corner> {
        outline.iter().map(|p| Corner(Number(p.x), Number(p.y))).collect()
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let whole = self.0.fract() == 0.0 && self.0.abs() < 1e15;
        if whole { s.serialize_i64(self.0 as i64) } else { s.serialize_f64(self.0) }
    }
}

fn known_version<'de, D: Deserializer<'de>>(d: D) -> Result<u32, D::Error> {
    let version = u32::deserialize(d)?;
    let message = || format!("map format {version} is unknown, this build reads format {VERSION}");
    if version == VERSION { Ok(version) } else { Err(D::Error::custom(message())) }
}

/// Reads a draft from its written form, without validation.
impl<'de> Deserialize<'de> for Draft {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Draft, D::Error> {
        MapRecord::deserialize(d).map(Draft::from)
    }
}

impl From<MapRecord> for Draft {
    fn from(r: MapRecord) -> Draft {
        let node = |n: NodeRecord| DraftNode { name: n.id, at: Point::new(n.x.0, n.y.0) };
        Draft {
            name: r.name,
            footprint_m: r.footprint_m,
            nodes: r.nodes.into_iter().map(node).collect(),
            lanes: r.lanes.into_iter().map(DraftLane::from).collect(),
            stations: r.stations.into_iter().map(DraftStation::from).collect(),
            racks: r.racks.into_iter().map(DraftRack::from).collect(),
            rack_types: r.rack_types.into_iter().map(|t| t.rack_type(r.footprint_m)).collect(),
            storage: r.storage,
            chargers: r.chargers,
            parking: r.parking,
            exits: r.exits,
            walkable: r.walkable.iter().map(|o| Corner::outline(o)).collect(),
            obstacles: r.obstacles.iter().map(|o| Corner::outline(o)).collect(),
            marks: (r.marks.into_iter())
                .map(|m| FloorMark { name: m.id, at: Point::new(m.x.0, m.y.0) })
                .collect(),
        }
    }
}

impl From<LaneRecord> for DraftLane {
    fn from(l: LaneRecord) -> DraftLane {
        let users = l.users.map_or(Users::ALL, |list| Users {
            loaded: list.contains(&User::Loaded),
            unloaded: list.contains(&User::Unloaded),
            people: list.contains(&User::People),
        });
        let (length_m, speed_limit_mps) = (l.length_m.map(|n| n.0), l.speed_limit_mps.map(|n| n.0));
        let corridor = l.corridor.map(|c| Corridor { left_m: c.left.0, right_m: c.right.0 });
        let LaneRecord { from, to, both, kinds, .. } = l;
        DraftLane { from, to, both, length_m, speed_limit_mps, users, kinds, corridor }
    }
}

impl From<RackRecord> for DraftRack {
    fn from(RackRecord { id, node, load, weight_kg, rack_type }: RackRecord) -> DraftRack {
        DraftRack { name: id, node, load, weight_kg: weight_kg.map_or(0.0, |n| n.0), rack_type }
    }
}

impl From<StationRecord> for DraftStation {
    fn from(s: StationRecord) -> DraftStation {
        let (pick, cell) = (Span::from_secs_f64(s.pick_s.0), s.cell.map(CellRecord::cell));
        DraftStation { name: s.id, node: s.node, queue: s.queue, pick, cell }
    }
}

impl From<&Warehouse> for MapRecord {
    fn from(w: &Warehouse) -> MapRecord {
        let name = |n: NodeId| w.nodes[n].name.clone();
        let of = |kind: NodeKind| w.nodes_where(|k| k == kind).into_iter().map(name).collect();
        let node = |n: &crate::warehouse::Node| NodeRecord {
            id: n.name.clone(),
            x: Number(n.at.x),
            y: Number(n.at.y),
        };
        MapRecord {
            giveway_map: VERSION,
            name: w.name.clone(),
            footprint_m: w.footprint_m,
            nodes: w.nodes.iter().map(node).collect(),
            lanes: w.lanes.iter().map(|l| lane_record(w, l)).collect(),
            storage: of(NodeKind::Storage),
            rack_types: w.rack_types.iter().map(RackTypeRecord::of).collect(),
            racks: (w.racks.iter())
                .map(|r| RackRecord {
                    id: r.name.clone(),
                    node: name(r.home),
                    load: r.load.clone(),
                    weight_kg: (r.weight_kg != 0.0).then_some(Number(r.weight_kg)),
                    rack_type: r.rack_type.map(|t| w.rack_types[t].name.clone()),
                })
                .collect(),
            stations: (w.stations.iter())
                .map(|s| StationRecord {
                    id: s.name.clone(),
                    node: name(s.node),
                    queue: s.queue.iter().map(|&q| name(q)).collect(),
                    pick_s: Number(s.pick.as_secs_f64()),
                    cell: s.cell.as_ref().map(CellRecord::of),
                })
                .collect(),
            chargers: of(NodeKind::Charger),
            parking: of(NodeKind::Parking),
            exits: of(NodeKind::Exit),
            walkable: w.walkable.iter().map(|o| Corner::of_outline(o)).collect(),
            obstacles: w.obstacles.iter().map(|o| Corner::of_outline(o)).collect(),
            marks: (w.marks.iter())
                .map(|m| MarkRecord { id: m.name.clone(), x: Number(m.at.x), y: Number(m.at.y) })
                .collect(),
        }
    }
}

fn lane_record(w: &Warehouse, l: &crate::warehouse::Lane) -> LaneRecord {
    let (a, b) = (&w.nodes[l.a], &w.nodes[l.b]);
    let straight = crate::geometry::Segment { a: a.at, b: b.at }.length();
    let named =
        [(l.users.loaded, User::Loaded), (l.users.unloaded, User::Unloaded), (l.users.people, User::People)];
    let users = named.into_iter().filter(|(may, _)| *may).map(|(_, user)| user).collect();
    LaneRecord {
        from: a.name.clone(),
        to: b.name.clone(),
        both: l.both,
        length_m: (l.length_m != straight).then_some(Number(l.length_m)),
        speed_limit_mps: l.speed_limit_mps.map(Number),
        users: (l.users != Users::ALL).then_some(users),
        kinds: l.kinds.clone(),
        corridor: l.corridor.map(|c| CorridorRecord { left: Number(c.left_m), right: Number(c.right_m) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::sketch;

    const SMALL: &str = r#"{
"giveway_map":1,
"name":"small",
"footprint_m":0.9,
"nodes":[
{"id":"a","x":0,"y":0.1},
{"id":"b","x":1.25,"y":0.1},
{"id":"s","x":1.25,"y":-1},
{"id":"w","x":0,"y":1.3}
],
"lanes":[
{"from":"a","to":"b","both":true,"length_m":1.3,"corridor":{"left":0.6,"right":0}},
{"from":"b","to":"s","both":true,"for":["loaded","unloaded"]},
{"from":"a","to":"w","speed_limit_mps":0.5},
{"from":"w","to":"b"}
],
"storage":[
"s"
],
"racks":[
{"id":"k \"1\"","node":"s"}
],
"stations":[
{"id":"W","node":"w","pick_s":7.5}
],
"exits":[
"a"
],
"walkable":[
[[0,0],[2,0],[2,2.5]]
],
"marks":[
{"id":"M 1","x":0.5,"y":-2}
]
}
"#;

    #[test]
    fn what_is_read_is_written_the_same() {
        let w = parse(SMALL).expect("a well-formed map");
        assert_eq!(write(&w), SMALL);
    }

    #[test]
    fn what_is_written_is_read_the_same() {
        let mut draft = sketch("RS..C\n.....\nP.1.X");
        for (i, node) in draft.nodes.iter_mut().enumerate() {
            node.at += nalgebra::Vector2::new(0.1 / 3.0 * i as f64, 1e-7 / 7.0 * i as f64);
        }
        draft.footprint_m = 0.3;
        let w = draft.build().expect("still well-formed");
        let again = parse(&write(&w)).expect("our own writing is readable");
        assert_eq!((&w.nodes, &w.lanes, &w.arcs), (&again.nodes, &again.lanes, &again.arcs));
        assert_eq!((&w.stations, &w.racks, &w.walkable), (&again.stations, &again.racks, &again.walkable));
        assert_eq!((&w.name, w.footprint_m), (&again.name, again.footprint_m));
    }

    fn refused(text: &str, at_line: usize, says: &str) {
        match parse(text).expect_err("a bad text") {
            MapError::Syntax { line, message, .. } => {
                assert_eq!(line, at_line, "{message}");
                assert!(message.contains(says) && !message.contains("at line"), "{message}");
            }
            MapError::Findings(findings) => panic!("{findings}"),
        }
    }

    #[test]
    fn a_misspelt_key_is_refused_at_its_line_with_the_keys_there_are() {
        refused(&SMALL.replace("speed_limit_mps", "speed"), 14, "unknown field `speed`, expected one of");
        refused(&SMALL.replace("\"storage\"", "\"Storage\""), 17, "unknown field `Storage`");
    }

    #[test]
    fn a_missing_key_and_a_wrong_word_are_refused() {
        refused(&SMALL.replace(",\"pick_s\":7.5", ""), 24, "missing field `pick_s`");
        refused(&SMALL.replace("\"unloaded\"", "\"empty\""), 13, "unknown variant `empty`");
    }

    #[test]
    fn another_version_is_refused_before_anything_else() {
        refused(&SMALL.replace("_map\":1", "_map\":2").replace("name", "title"), 2, "format 2 is unknown");
    }

    #[test]
    fn a_readable_text_with_a_bad_building_lists_the_findings() {
        let error = parse(&SMALL.replace("\"w\",\"to\":\"b\"", "\"w\",\"to\":\"c\"")).expect_err("no node c");
        assert!(matches!(&error, MapError::Findings(f) if f.0.len() == 1), "{error}");
        assert!(error.to_string().contains("there is no node c"), "{error}");
    }
}

//! The shipped maps are what their generators make, and the published schema says what the reader does.
//!
//! `UPDATE_MAPS=1 cargo test --test maps` writes the maps anew after a generator has changed.

use giveway::warehouse::{
    ShutIn, Warehouse, docks, formats, kiva, lab, mixed, shut_in, shut_in_text, stations, thesis,
};
use serde_json::{Value, json};
use std::path::PathBuf;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("maps").join(name)
}

fn shipped() -> [Warehouse; 6] {
    [lab(), thesis(), kiva(), mixed(), stations(), docks()]
}

fn schema() -> Value {
    let text = std::fs::read_to_string(path("map.schema.json")).expect("the schema ships");
    serde_json::from_str(&text).expect("the schema is JSON")
}

#[test]
fn the_shipped_maps_are_what_their_generators_make() {
    for w in shipped() {
        let (text, path) = (formats::json::write(&w), path(&format!("{}.json", w.name)));
        if std::env::var_os("UPDATE_MAPS").is_some() {
            std::fs::write(&path, &text).expect("maps/ is writable");
        }
        let file = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(file == text, "{} differs: run UPDATE_MAPS=1 cargo test --test maps", path.display());
    }
}

#[test]
fn a_shipped_map_reads_back_as_it_was_written_and_is_no_mebibyte() {
    for w in shipped() {
        let text = formats::json::write(&w);
        assert!(text.len() < 1 << 20, "{} has {} bytes", w.name, text.len());
        let again = formats::json::parse(&text).expect("well-formed");
        assert_eq!((&again.nodes, &again.arcs), (&w.nodes, &w.arcs));
        assert_eq!(formats::json::write(&again), text);
    }
}

#[test]
fn a_robot_that_breaks_down_shuts_others_in_on_the_shipped_maps_only_so() {
    let found = |w: &Warehouse| {
        let (stations, ends): (Vec<ShutIn>, Vec<ShutIn>) =
            shut_in(w).into_iter().partition(|s| !s.stations.is_empty());
        let most = |all: &[ShutIn]| all.iter().map(|s| s.shut_in.len()).max().unwrap_or(0);
        (stations.len(), most(&stations), ends.len(), most(&ends))
    };
    // At stations: how many findings, nodes of the largest; the same for dead ends.
    assert_eq!(
        shipped().map(|w| found(&w)),
        [(1, 2, 0, 0), (2, 6, 0, 0), (60, 13, 110, 11), (2, 7, 0, 0), (7, 13, 31, 11), (16, 13, 78, 11)]
    );
    let lines = shut_in_text(&shut_in(&kiva()));
    assert!(lines.len() <= 13, "few lines: {lines:#?}");
}

#[test]
fn every_shipped_map_follows_the_schema() {
    let schema = schema();
    for w in shipped() {
        let map: Value = serde_json::from_str(&formats::json::write(&w)).expect("our writing is JSON");
        assert_eq!(fault(&schema, &schema, &map), None, "{}", w.name);
    }
}

/// A map that uses every key of the format.
fn full() -> Value {
    json!({
        "giveway_map": 1, "name": "full", "footprint_m": 0.9,
        "nodes": [
            {"id": "a", "x": 0, "y": 0}, {"id": "b", "x": 1, "y": 0}, {"id": "s", "x": 1, "y": 1},
            {"id": "c", "x": 0, "y": 1}, {"id": "p", "x": 0, "y": -1}, {"id": "q", "x": 2, "y": 0},
            {"id": "w", "x": 2, "y": -1}, {"id": "o", "x": 1, "y": -1},
        ],
        "lanes": [
            {"from": "a", "to": "b", "both": true, "length_m": 1.5, "speed_limit_mps": 1,
             "for": ["loaded", "unloaded"]},
            {"from": "b", "to": "s", "both": true}, {"from": "a", "to": "c", "both": true},
            {"from": "a", "to": "p", "both": true}, {"from": "b", "to": "q"},
            {"from": "q", "to": "w"},
            {"from": "w", "to": "o", "corridor": {"left": 0.1, "right": 0.2}}, {"from": "o", "to": "b"},
        ],
        "storage": ["s"],
        "rack_types": [{"id": "shelf", "columns": 4, "heights_m": [0.4, 0.8], "width_m": 0.8, "face_m": 0.4}],
        "racks": [{"id": "k", "node": "s", "load": "box", "weight_kg": 20, "type": "shelf"}],
        "stations": [{"id": "W", "node": "w", "queue": ["q"], "pick_s": 8, "cell": {
            "workplace": [[1.6, -2.5], [2.4, -2.5], [2.4, -1.8]],
            "opening": {"outline": [[1.6, -1.6], [2.4, -1.6], [2.4, -1.5]], "from_m": 0.2, "to_m": 2},
            "totes": [{"id": "A", "at": [1.7, -2.6, 0.9]}],
            "arm": {"base": [2.6, -2, 0.8], "heading_deg": 90, "kind": "ur5"},
        }}],
        "chargers": ["c"], "parking": ["p"], "exits": ["o"],
        "walkable": [[[0, 0], [1, 0], [1, 1]]], "obstacles": [[[0, 0], [1, 0], [1, 1]]],
        "marks": [{"id": "m", "x": 2, "y": 0.5}],
    })
}

/// Every object inside `value`, as a JSON pointer.
fn objects(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            found.push(at.to_string());
            fields.iter().for_each(|(key, v)| objects(v, &format!("{at}/{key}"), found));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| objects(v, &format!("{at}/{i}"), found));
        }
        _ => {}
    }
}

#[test]
fn schema_and_reader_agree_on_every_unknown_and_every_missing_key() {
    let (schema, full) = (schema(), full());
    assert_eq!(fault(&schema, &schema, &full), None);
    formats::json::parse(&full.to_string()).expect("the full map is well-formed");
    let mut places = Vec::new();
    objects(&full, "", &mut places);
    for place in &places {
        let fields = |map: &Value| map.pointer(place).and_then(Value::as_object).expect("an object").clone();
        let keys: Vec<String> = fields(&full).keys().cloned().collect();
        let changed = |change: &dyn Fn(&mut serde_json::Map<String, Value>)| {
            let mut map = full.clone();
            let object = map.pointer_mut(place).and_then(Value::as_object_mut);
            change(object.expect("an object"));
            map
        };
        agree(&schema, &changed(&|o| drop(o.insert("unheard_of".into(), json!(1)))));
        for key in keys {
            agree(&schema, &changed(&|o| drop(o.remove(&key))));
            agree(&schema, &changed(&|o| drop(o.insert(key.clone(), json!({"not": "this"})))));
        }
    }
}

#[test]
fn schema_and_reader_agree_on_numbers_out_of_range() {
    let schema = schema();
    for (pointer, value) in [
        ("/giveway_map", json!(2)),
        ("/footprint_m", json!(0)),
        ("/footprint_m", json!(11)),
        ("/nodes", json!([])),
        ("/nodes/0/x", json!(100_001)),
        ("/nodes/0/id", json!("")),
        ("/lanes/0/length_m", json!(0)),
        ("/lanes/0/length_m", json!(1001)),
        ("/lanes/0/speed_limit_mps", json!(-1)),
        ("/lanes/0/for", json!([])),
        ("/lanes/0/for", json!(["dogs"])),
        ("/lanes/6/corridor/left", json!(-0.1)),
        ("/lanes/6/corridor/right", json!(21)),
        ("/stations/0/pick_s", json!(-1)),
        ("/stations/0/cell/workplace", json!([[0, 0], [1, 1]])),
        ("/stations/0/cell/opening/to_m", json!(3.5)),
        ("/stations/0/cell/totes", json!([])),
        ("/stations/0/cell/totes/0/at", json!([0, 0])),
        ("/rack_types/0/columns", json!(0)),
        ("/rack_types/0/columns", json!(27)),
        ("/rack_types/0/columns", json!(2.5)),
        ("/rack_types/0/heights_m", json!([])),
        ("/rack_types/0/width_m", json!(0)),
        ("/rack_types/0/face_m", json!(-0.1)),
        ("/walkable/0", json!([[0, 0], [1, 1]])),
        ("/walkable/0/0", json!([0])),
    ] {
        let mut map = full();
        *map.pointer_mut(pointer).expect("the full map has everything") = value;
        assert!(fault(&schema, &schema, &map).is_some(), "the schema allows {pointer} of {map}");
        assert!(formats::json::parse(&map.to_string()).is_err(), "the reader allows {pointer} of {map}");
    }
}

/// The schema finds a fault exactly where the reader refuses the text. (That a building is not well-formed
/// is beyond a schema: such findings do not count.)
fn agree(schema: &Value, map: &Value) {
    let reader = match formats::json::parse(&map.to_string()) {
        Err(formats::MapError::Syntax { message, .. }) => Some(message),
        _ => None,
    };
    let fault = fault(schema, schema, map);
    assert_eq!(fault.is_some(), reader.is_some(), "schema: {fault:?}, reader: {reader:?}, map: {map}");
}

/// What `value` does against `schema`, for the few keywords that ours uses.
fn fault(root: &Value, schema: &Value, value: &Value) -> Option<String> {
    let rules = schema.as_object().expect("a schema is an object");
    rules.iter().find_map(|(rule, want)| {
        let ok = match rule.as_str() {
            "$ref" => {
                let name = want.as_str().and_then(|r| r.strip_prefix('#')).expect("a local reference");
                return fault(root, root.pointer(name).expect("a known definition"), value);
            }
            "type" => has_type(want, value),
            "const" => want == value,
            "enum" => want.as_array().is_some_and(|all| all.contains(value)),
            "minimum" => number(value).is_none_or(|v| v >= number(want).expect("a number")),
            "maximum" => number(value).is_none_or(|v| v <= number(want).expect("a number")),
            "exclusiveMinimum" => number(value).is_none_or(|v| v > number(want).expect("a number")),
            "minItems" => value.as_array().is_none_or(|v| v.len() as f64 >= number(want).expect("a number")),
            "maxItems" => value.as_array().is_none_or(|v| v.len() as f64 <= number(want).expect("a number")),
            "minLength" => {
                value.as_str().is_none_or(|v| v.chars().count() as f64 >= number(want).expect("a number"))
            }
            "maxLength" => {
                value.as_str().is_none_or(|v| v.chars().count() as f64 <= number(want).expect("a number"))
            }
            "required" => {
                let names = want.as_array().expect("a list").iter().filter_map(Value::as_str);
                value.as_object().is_none_or(|o| names.into_iter().all(|name| o.contains_key(name)))
            }
            "additionalProperties" => {
                let known = rules["properties"].as_object().expect("known properties");
                value.as_object().is_none_or(|o| o.keys().all(|key| known.contains_key(key)))
            }
            "properties" => {
                let inner = value.as_object().into_iter().flatten();
                return inner.into_iter().find_map(|(key, v)| fault(root, want.get(key)?, v));
            }
            "items" => return value.as_array()?.iter().find_map(|v| fault(root, want, v)),
            "$schema" | "$id" | "$defs" | "title" | "description" | "default" => true,
            other => panic!("the schema uses {other}, which this test does not know"),
        };
        (!ok).then(|| format!("{rule} {want} refuses {value}"))
    })
}

fn has_type(name: &Value, value: &Value) -> bool {
    match name.as_str().expect("one type") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "boolean" => value.is_boolean(),
        other => panic!("unknown type {other}"),
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_f64()
}

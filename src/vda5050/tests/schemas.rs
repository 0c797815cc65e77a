//! What is written is valid by the official schemas, and has no field that they do not have.

use super::strategies::{Numbers, header, message};
use super::{a_header, kind_of};
use crate::*;
use jsonschema::Validator;
use proptest::prelude::*;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::LazyLock;

macro_rules! schemas_of {
    ($version:literal) => {
        [
            (TopicKind::Order, include_str!(concat!("../schemas/", $version, "/order.schema.json"))),
            (
                TopicKind::InstantActions,
                include_str!(concat!("../schemas/", $version, "/instantActions.schema.json")),
            ),
            (TopicKind::State, include_str!(concat!("../schemas/", $version, "/state.schema.json"))),
            (
                TopicKind::Visualization,
                include_str!(concat!("../schemas/", $version, "/visualization.schema.json")),
            ),
            (
                TopicKind::Connection,
                include_str!(concat!("../schemas/", $version, "/connection.schema.json")),
            ),
            (TopicKind::Factsheet, include_str!(concat!("../schemas/", $version, "/factsheet.schema.json"))),
        ]
    };
}

static VALIDATORS: LazyLock<HashMap<(Version, TopicKind), Validator>> = LazyLock::new(|| {
    let all = [
        (Version::V2_0, schemas_of!("2.0.0")),
        (Version::V2_1, schemas_of!("2.1.0")),
        (Version::V3_0, schemas_of!("3.0.0")),
    ];
    let new = [
        (TopicKind::Responses, include_str!("../schemas/3.0.0/responses.schema.json")),
        (TopicKind::ZoneSet, include_str!("../schemas/3.0.0/zoneSet.schema.json")),
    ];
    let all = all.into_iter().flat_map(|(version, kinds)| kinds.map(|(kind, text)| ((version, kind), text)));
    let new = new.map(|(kind, text)| ((Version::V3_0, kind), text));
    all.chain(new)
        .map(|(key, text)| {
            let mut schema: Value = serde_json::from_str(text).expect("a schema is JSON");
            // The rules of zones have fields of their own, each under a condition.
            if key.1 != TopicKind::ZoneSet {
                close(&mut schema);
            }
            let validator = jsonschema::options().should_validate_formats(true).build(&schema);
            (key, validator.expect("a schema is valid"))
        })
        .collect()
});

/// Forbids fields that a schema does not name: the official ones allow any, and so do not see a misspelled name.
fn close(schema: &mut Value) {
    match schema {
        Value::Object(fields) => {
            fields.values_mut().for_each(close);
            if fields.get("properties").is_some_and(|properties| properties.is_object()) {
                fields.entry("additionalProperties").or_insert(json!(false));
            }
        }
        Value::Array(elements) => elements.iter_mut().for_each(close),
        _ => {}
    }
}

/// What the schema of a version has against a message, in words; empty if it is valid.
pub(super) fn faults(version: Version, kind: TopicKind, value: &Value) -> String {
    let Some(validator) = VALIDATORS.get(&(version, kind)) else {
        assert!(!kind.is_in(version), "{version} has a schema for {kind:?}");
        return String::new();
    };
    validator
        .iter_errors(value)
        .map(|fault| format!("{version} {kind:?}: {fault} at {}\n", fault.instance_path()))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn what_is_written_in_any_version_is_valid_by_its_schema_whatever_the_numbers(
        header in header(), message in prop_oneof![message(Numbers::Sane), message(Numbers::Any)],
    ) {
        for version in Version::ALL {
            let written = write(&header, &message, version);
            prop_assert_eq!(faults(version, kind_of(&message), &written), "");
        }
    }
}

fn edge(corridor: Corridor) -> Message {
    let node = |id: &str, sequence| Node {
        id: id.to_owned(),
        sequence,
        released: true,
        position: Some(NodePosition {
            x: 1.0,
            y: 2.0,
            theta: None,
            deviation_m: Some(0.5),
            deviation_rad: None,
            map: "hall".to_owned(),
        }),
        actions: Vec::new(),
    };
    let edge = Edge {
        id: "ab".to_owned(),
        sequence: 1,
        released: true,
        from: "a".to_owned(),
        to: "b".to_owned(),
        max_speed_mps: Some(1.5),
        corridor: Some(corridor),
        actions: Vec::new(),
    };
    Message::Order(Order {
        id: "o".to_owned(),
        update: 0,
        nodes: vec![node("a", 0), node("b", 2)],
        edges: vec![edge],
    })
}

#[test]
fn an_edge_has_the_names_of_its_version() {
    let order = edge(Corridor { left_m: 0.25, right_m: 1.0, of_contour: false, release_required: false });
    let edges = Version::ALL.map(|version| write(&a_header(""), &order, version)["edges"][0].clone());
    let old = json!({
        "edgeId": "ab", "sequenceId": 1, "released": true, "startNodeId": "a", "endNodeId": "b", "maxSpeed": 1.5,
        "actions": [],
    });
    let mut middle = old.clone();
    middle["corridor"] = json!({"leftWidth": 0.25, "rightWidth": 1.0, "corridorRefPoint": "KINEMATICCENTER"});
    let corridor = json!({
        "leftWidth": 0.25, "rightWidth": 1.0, "corridorReferencePoint": "KINEMATIC_CENTER",
        "releaseRequired": false,
    });
    let new = json!({
        "edgeId": "ab", "sequenceId": 1, "released": true, "maximumSpeed": 1.5, "corridor": corridor, "actions": [],
    });
    assert_eq!(edges, [old, middle, new]);
}

#[test]
fn a_deviation_is_a_number_before_3_0_and_a_circle_in_3_0() {
    let order = edge(Corridor { left_m: 1.0, right_m: 1.0, of_contour: true, release_required: true });
    let deviations = Version::ALL.map(|version| {
        write(&a_header(""), &order, version)["nodes"][0]["nodePosition"]["allowedDeviationXY"].clone()
    });
    assert_eq!(deviations, [json!(0.5), json!(0.5), json!({"a": 0.5, "b": 0.5, "theta": 0.0})]);
}

#[test]
fn a_corridor_that_must_be_asked_for_is_not_written_as_one_that_need_not() {
    let order = edge(Corridor { left_m: 1.0, right_m: 1.0, of_contour: true, release_required: true });
    let has = Version::ALL
        .map(|version| write(&a_header(""), &order, version)["edges"][0].get("corridor").is_some());
    assert_eq!(has, [false, false, true]);
}

#[test]
fn the_header_names_the_version_in_which_the_message_is_written() {
    let message = Message::Connection(ConnectionState::Broken);
    let written = write(&a_header("2.1.0"), &message, Version::V3_0);
    assert_eq!(
        (&written["version"], &written["connectionState"]),
        (&json!("3.0.0"), &json!("CONNECTION_BROKEN"))
    );
    assert_eq!(
        write(&a_header("3.0.0"), &message, Version::V2_0)["connectionState"],
        json!("CONNECTIONBROKEN")
    );
}

//! Whether messages are valid by the official schema of their version.
//!
//! Main function: [`faults`]. Refuses: messages of robots, some of which say what no schema allows.

use giveway_vda5050::{TopicKind, Version};
use jsonschema::Validator;
use serde_json::Value;
use std::collections::HashMap;
use std::sync::LazyLock;

macro_rules! schema {
    ($version:literal, $name:literal) => {
        include_str!(concat!("../../../vda5050/schemas/", $version, "/", $name, ".schema.json"))
    };
}

static VALIDATORS: LazyLock<HashMap<(TopicKind, Version), Validator>> = LazyLock::new(|| {
    let all = [
        (TopicKind::Order, Version::V2_0, schema!("2.0.0", "order")),
        (TopicKind::Order, Version::V2_1, schema!("2.1.0", "order")),
        (TopicKind::Order, Version::V3_0, schema!("3.0.0", "order")),
        (TopicKind::InstantActions, Version::V2_0, schema!("2.0.0", "instantActions")),
        (TopicKind::InstantActions, Version::V2_1, schema!("2.1.0", "instantActions")),
        (TopicKind::InstantActions, Version::V3_0, schema!("3.0.0", "instantActions")),
        (TopicKind::Responses, Version::V3_0, schema!("3.0.0", "responses")),
        (TopicKind::ZoneSet, Version::V3_0, schema!("3.0.0", "zoneSet")),
    ];
    let built = |text: &str| {
        let schema: Value = serde_json::from_str(text).expect("a schema is JSON");
        let options = jsonschema::options().should_validate_formats(true);
        options.build(&schema).expect("a schema is valid")
    };
    all.map(|(kind, version, text)| ((kind, version), built(text))).into_iter().collect()
});

/// What the schema has against a message for a robot, in words; empty if it is valid.
pub(super) fn faults(kind: TopicKind, version: Version, message: &Value) -> String {
    if kind.is_from_robot() {
        return String::new();
    }
    let validator = VALIDATORS.get(&(kind, version)).expect("the version has such messages");
    validator.iter_errors(message).map(|fault| format!("{fault} at {}\n", fault.instance_path())).collect()
}

#[test]
fn a_message_that_lacks_what_its_schema_requires_is_found() {
    let message = serde_json::json!({"headerId": 1});
    assert!(faults(TopicKind::Responses, Version::V3_0, &message).contains("timestamp"));
}

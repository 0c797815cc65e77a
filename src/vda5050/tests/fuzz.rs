//! Bad input: no bytes make the reader panic, and whatever it reads can be written.

use super::recordings::recorded;
use super::schemas::faults;
use crate::read::MOST_ODDITIES;
use crate::*;
use proptest::prelude::*;
use proptest::sample::Index;
use serde_json::{Value, json};

/// Reads a payload as each kind of message, and writes what was read in each version.
fn read_and_write(payload: &[u8]) -> Result<(), TestCaseError> {
    for kind in TopicKind::ALL {
        let Ok(read) = read(kind, payload) else { continue };
        prop_assert!(read.oddities.len() <= MOST_ODDITIES + 1);
        prop_assert!(read.oddities.iter().all(|oddity| oddity.to_string().len() < 2_000));
        // The timestamp is the sender's own text.
        let header = Header { timestamp: "2026-11-30T12:00:00Z".to_owned(), ..read.header };
        for version in Version::ALL {
            prop_assert_eq!(faults(version, kind, &write(&header, &read.message, version)), "");
        }
    }
    Ok(())
}

fn a_recorded_payload() -> impl Strategy<Value = Vec<u8>> {
    any::<Index>().prop_map(|index| index.get(&recorded()).payload.clone())
}

/// A change of some bytes: where, what is taken away, and what is put in its place.
fn byte_changes() -> impl Strategy<Value = Vec<(Index, usize, Vec<u8>)>> {
    let piece = prop_oneof![
        proptest::collection::vec(any::<u8>(), 0..4),
        prop::sample::select(vec!["\"", "{", "]", "\\u", "-", "1e999", "null", ",", ":", "NaN"])
            .prop_map(|text| text.as_bytes().to_vec()),
    ];
    proptest::collection::vec((any::<Index>(), 0..4usize, piece), 1..6)
}

/// What takes the place of a value.
fn replacement() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        ".{0,9}".prop_map(Value::from),
        prop::sample::select(vec!["NaN", "-1", "1e400", "true", "4294967296", "AUTOMATIC"])
            .prop_map(Value::from),
        Just(json!([])),
        Just(json!({})),
        Just(json!([null, 0, "a", [], {"x": {}}])),
        (1..150usize).prop_map(|depth| (0..depth).fold(json!(1), |inner, _| json!([inner]))),
        (1..150usize).prop_map(|depth| (0..depth).fold(json!(1), |inner, _| json!({"actions": inner}))),
        Just(Value::from("x".repeat(3_000))),
        Just(Value::from(vec![0; 12_000])),
    ]
}

fn renamed(key: &str, way: usize) -> String {
    match way % 5 {
        0 => key.to_uppercase(),
        1 => key.to_lowercase(),
        2 => key.chars().flat_map(|c| if c.is_uppercase() { vec!['_', c] } else { vec![c] }).collect(),
        3 => format!("{key} "),
        _ => format!("x{key}"),
    }
}

/// All values of a message, as the paths to them.
fn paths(value: &Value, here: String, all: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                paths(value, format!("{here}/{}", key.replace('~', "~0").replace('/', "~1")), all);
            }
        }
        Value::Array(elements) => {
            for (index, value) in elements.iter().enumerate() {
                paths(value, format!("{here}/{index}"), all);
            }
        }
        _ => {}
    }
    all.push(here);
}

/// Replaces a value, renames a key, or repeats the elements of a list.
fn change(message: &mut Value, place: Index, way: usize, replacement: Value) {
    let mut all = Vec::new();
    paths(message, String::new(), &mut all);
    let Some(target) = message.pointer_mut(place.get::<String>(&all)) else { return };
    match (way % 3, target) {
        (0, Value::Object(fields)) if !fields.is_empty() => {
            let key = fields.keys().nth(way / 3 % fields.len()).cloned().unwrap_or_default();
            if let Some(value) = fields.remove(&key) {
                fields.insert(renamed(&key, way / 7), value);
            }
        }
        (1, Value::Array(elements)) if !elements.is_empty() => {
            let many = elements.iter().cycle().take(elements.len() * 100).cloned().collect();
            *elements = many;
        }
        (_, target) => *target = replacement,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_bytes_make_the_reader_panic(
        bytes in prop_oneof![
            proptest::collection::vec(any::<u8>(), 0..200),
            "[\\[\\]{}\",:0-9eE.+\\-a-z\\\\ \u{feff}ü]{0,80}".prop_map(String::into_bytes),
        ],
    ) {
        read_and_write(&bytes)?;
    }

    #[test]
    fn recorded_messages_with_changed_bytes_do_not_make_the_reader_panic(
        mut payload in a_recorded_payload(), changes in byte_changes(),
    ) {
        for (place, gone, piece) in changes {
            let from = place.index(payload.len() + 1);
            let to = (from + gone).min(payload.len());
            payload.splice(from..to, piece);
        }
        read_and_write(&payload)?;
    }

    #[test]
    fn recorded_messages_with_other_keys_and_values_do_not_make_the_reader_panic(
        payload in a_recorded_payload(),
        changes in proptest::collection::vec((any::<Index>(), any::<usize>(), replacement()), 1..5),
    ) {
        let mut message: Value = serde_json::from_slice(&payload).unwrap_or_default();
        for (place, way, replacement) in changes {
            change(&mut message, place, way, replacement);
        }
        read_and_write(message.to_string().as_bytes())?;
    }
}

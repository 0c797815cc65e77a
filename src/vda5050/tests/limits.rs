//! What is not kept of long messages, and what is not read at all.

use super::words;
use crate::read::{LONGEST_LIST, LONGEST_TEXT, MOST_BYTES, MOST_ODDITIES, MOST_PARTS};
use crate::*;
use serde_json::json;

fn refusal(payload: &[u8]) -> Unreadable {
    read(TopicKind::State, payload).expect_err("unreadable")
}

#[test]
fn a_payload_over_the_limit_is_refused_and_one_at_the_limit_is_read() {
    let mut payload = br#"{"connectionState":"ONLINE"}"#.to_vec();
    payload.resize(MOST_BYTES, b' ');
    assert!(read(TopicKind::Connection, &payload).is_ok());
    payload.push(b' ');
    let length = MOST_BYTES + 1;
    assert_eq!(read(TopicKind::Connection, &payload), Err(Unreadable::TooLong { length }));
}

#[test]
fn what_is_no_json_object_is_refused_in_words() {
    assert_eq!(refusal(b""), Unreadable::Empty);
    assert_eq!(refusal(b" \0\0"), Unreadable::Empty);
    assert_eq!(refusal(b"[1]").to_string(), "the payload is a list instead of an object");
    assert!(refusal(b"{\"a\":").to_string().starts_with("the payload is no JSON that can be read: EOF"));
    assert!(matches!(refusal(b"{nonsense"), Unreadable::NotJson { .. }));
}

#[test]
fn marks_that_programs_leave_around_a_message_do_no_harm() {
    let payload = b"\xef\xbb\xbf{\"connectionState\":\"ONLINE\"}\n\0";
    let read = read(TopicKind::Connection, payload).expect("readable");
    assert_eq!(read.message, Message::Connection(ConnectionState::Online));
}

#[test]
fn a_text_that_is_not_utf_8_is_read_with_marks() {
    let payload = b"{\"connectionState\":\"ONLINE\",\"manufacturer\":\"M\xfcller\"}";
    let read = read(TopicKind::Connection, payload).expect("readable");
    assert_eq!(read.header.manufacturer, "M\u{fffd}ller");
    assert_eq!(read.oddities[0], Oddity::NotUtf8);
}

#[test]
fn what_looks_like_json_within_a_text_is_text() {
    let text = r#"a \" NaN, \\ {[ 1e999 \" \u00fc"#;
    let payload = format!("{{\"connectionState\":\"ONLINE\",\"manufacturer\":\"{text}\"}}");
    let read = read(TopicKind::Connection, payload.as_bytes()).expect("readable");
    assert_eq!(read.header.manufacturer, "a \" NaN, \\ {[ 1e999 \" ü");
}

#[test]
fn too_deep_and_too_many_parts_are_refused() {
    let deep = format!("{{\"a\":{}{}}}", "[".repeat(200), "]".repeat(200));
    assert!(matches!(refusal(deep.as_bytes()), Unreadable::NotJson { .. }));
    let many = format!("{{\"a\":[{}{{}}]}}", "{},".repeat(MOST_PARTS));
    assert_eq!(refusal(many.as_bytes()), Unreadable::TooManyParts);
    let brackets = "[".repeat(MOST_BYTES);
    assert_eq!(refusal(brackets.as_bytes()), Unreadable::TooManyParts);
}

#[test]
fn long_lists_are_cut_and_operators_are_told() {
    let one = json!({"actionId": "1", "actionStatus": "RUNNING"});
    let state = json!({"actionStates": vec![one; LONGEST_LIST + 5]});
    let read = read(TopicKind::State, state.to_string().as_bytes()).expect("readable");
    let Message::State(state) = read.message else { panic!() };
    assert_eq!(state.actions.len(), LONGEST_LIST);
    let expected = "actionStates has 10005 elements, of which the first 10000 were kept".to_owned();
    assert!(words(&read.oddities).contains(&expected));
}

#[test]
fn long_texts_are_cut_at_a_character() {
    let long = "ü".repeat(LONGEST_TEXT + 1);
    let action = json!({
        "actionId": "1", "actionType": "x",
        "actionParameters": [{"key": "k", "value": {"deep": [long.clone()]}}, {"key": long.clone(), "value": 1}],
    });
    let payload = json!({"actions": [action], "manufacturer": long}).to_string();
    let read = read(TopicKind::InstantActions, payload.as_bytes()).expect("readable");
    let short = "ü".repeat(LONGEST_TEXT);
    assert_eq!(read.header.manufacturer, short);
    let Message::InstantActions(actions) = read.message else { panic!() };
    assert_eq!(actions[0].parameters[0].value, json!({"deep": [short.clone()]}));
    assert_eq!(actions[0].parameters[1].key, short);
    let expected = "manufacturer has 1001 characters, of which the first 1000 were kept".to_owned();
    assert!(words(&read.oddities).contains(&expected));
}

#[test]
fn more_oddities_than_anybody_reads_are_counted() {
    let payload = json!({"actionStates": vec![json!({}); 5000]}).to_string();
    let read = read(TopicKind::State, payload.as_bytes()).expect("readable");
    assert_eq!(read.oddities.len(), MOST_ODDITIES + 1);
    let last = read.oddities.last().map(ToString::to_string).expect("one");
    assert!(last.ends_with(" further oddities"), "{last}");
}

/// What would take long if some work were not linear: each payload fills the limit.
#[test]
fn payloads_that_fill_the_limit_with_one_thing_are_read_or_refused() {
    let filled = |unit: &str| unit.repeat((MOST_BYTES - 200) / unit.len());
    let payloads = [
        format!("{{{}\"z\":0}}", filled("\"a\":0,")),
        format!("{{{}0}}", (0..90_000).map(|key| format!("\"{key:x}\":")).collect::<Vec<_>>().join("0,")),
        format!("{{\"x\":{}}}", filled("9")),
        format!("{{\"x\":0.{}}}", filled("1")),
        format!("{{\"x\":\"{}\"}}", filled("\\\"")),
        format!("{{\"{}\":1}}", filled("_")),
        format!("{{\"a\":[{}0]}}", filled("0,")),
        format!("{{\"a\":[{}0]}}", filled("NaN,")),
        format!("{{\"actionStates\":[{}0]}}", filled("{},")),
        format!("{{\"nodeStates\":[{}0]}}", filled("0,")),
        format!("{{\"errors\":[{{\"errorReferences\":[{}0]}}]}}", filled("0,")),
        filled("\""),
        filled("\\"),
        filled("-"),
        filled("{\"a\":"),
    ];
    for payload in &payloads {
        assert!((MOST_BYTES - 300_000..=MOST_BYTES).contains(&payload.len()));
        for kind in TopicKind::ALL {
            let _ = read(kind, payload.as_bytes());
        }
    }
}

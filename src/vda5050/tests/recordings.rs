//! What three robots of others sent and were sent (`recorded/README.md`).

use super::words;
use crate::*;
use serde_json::{Value, json};

const COATY: &str = include_str!("../recorded/coaty-2.0.0.jsonl");
const ROSI: &str = include_str!("../recorded/rosi-2.0.0.jsonl");
const SDK: &str = include_str!("../recorded/sdk-2.1.0.jsonl");

/// A recorded message.
pub(super) struct Recorded {
    /// What it shows.
    pub(super) what: String,
    /// The kind of its topic.
    pub(super) kind: TopicKind,
    /// Its payload.
    pub(super) payload: Vec<u8>,
}

/// All recorded messages.
pub(super) fn recorded() -> Vec<Recorded> {
    [COATY, ROSI, SDK].into_iter().flat_map(messages).collect()
}

fn messages(lines: &str) -> Vec<Recorded> {
    let each = |line: &str| {
        let line: Value = serde_json::from_str(line).expect("a line is JSON");
        let topic = line["topic"].as_str().expect("a topic");
        let payload = match &line["payload"] {
            Value::String(text) => text.clone(),
            object => object.to_string(),
        };
        Recorded {
            what: line["what"].as_str().expect("a note").to_owned(),
            kind: TopicKind::ALL.into_iter().find(|kind| kind.level() == topic).expect("a kind"),
            payload: payload.into_bytes(),
        }
    };
    lines.lines().map(each).collect()
}

fn the(lines: &str, what: &str) -> Result<Read, Unreadable> {
    let message =
        messages(lines).into_iter().find(|message| message.what == what).expect("a recorded message");
    read(message.kind, &message.payload)
}

fn the_state(lines: &str, what: &str) -> State {
    match the(lines, what).expect("readable").message {
        Message::State(state) => *state,
        other => panic!("{what}: {other:?}"),
    }
}

fn the_order(lines: &str, what: &str) -> Order {
    match the(lines, what).expect("readable").message {
        Message::Order(order) => order,
        other => panic!("{what}: {other:?}"),
    }
}

fn the_actions(lines: &str, what: &str) -> Vec<Action> {
    match the(lines, what).expect("readable").message {
        Message::InstantActions(actions) => actions,
        other => panic!("{what}: {other:?}"),
    }
}

fn the_factsheet(lines: &str, what: &str) -> (Factsheet, Vec<Oddity>) {
    let read = the(lines, what).expect("readable");
    match read.message {
        Message::Factsheet(sheet) => (*sheet, read.oddities),
        other => panic!("{what}: {other:?}"),
    }
}

#[test]
fn every_recorded_message_but_the_one_that_is_no_json_reads_without_oddities_but_those_of_factsheets() {
    let mut unreadable = Vec::new();
    for message in recorded() {
        match read(message.kind, &message.payload) {
            Ok(read) if message.kind == TopicKind::Factsheet => assert!(!read.oddities.is_empty()),
            Ok(read) => assert_eq!(read.oddities, [], "{}", message.what),
            Err(_) => unreadable.push(message.what),
        }
    }
    assert_eq!(unreadable, ["no JSON"]);
    assert!(matches!(the(ROSI, "no JSON"), Err(Unreadable::NotJson { .. })));
}

#[test]
fn a_factsheet_without_content_says_nothing_and_operators_are_told_what_is_missing() {
    let (sheet, oddities) = the_factsheet(COATY, "factsheet without content");
    assert_eq!(sheet, Factsheet::default());
    let missing = [
        "typeSpecification",
        "physicalParameters",
        "protocolLimits",
        "protocolFeatures",
        "agvGeometry",
        "loadSpecification",
    ];
    assert_eq!(words(&oddities), missing.map(|part| format!("{part} is missing and was taken as unknown")));
}

#[test]
fn a_factsheet_with_nulls_says_what_is_not_null() {
    let (sheet, oddities) = the_factsheet(ROSI, "factsheet with nulls");
    let expected = Factsheet {
        series: Some("Generic AMR".to_owned()),
        speed_mps: Some(1.5),
        accel_mps2: Some(0.5),
        brake_mps2: Some(0.5),
        turn_radps: None,
        length_m: Some(0.8),
        width_m: Some(0.6),
        payload_kg: Some(100.0),
        most_nodes: Some(1000),
        longest_id: Some(128),
        order_interval_s: None,
        actions: Some(Vec::new()),
        zones: Vec::new(),
        critical: None,
    };
    assert_eq!(sheet, expected);
    let missing = ["agvGeometry", "loadSpecification"];
    assert_eq!(words(&oddities), missing.map(|part| format!("{part} is missing and was taken as unknown")));
}

#[test]
fn the_first_message_of_a_topic_may_have_the_number_0() {
    let first = the(COATY, "first state, header id 0").expect("readable");
    let expected = Header {
        id: 0,
        timestamp: "2026-11-22T17:01:31.332Z".to_owned(),
        version: "2.0.0".to_owned(),
        manufacturer: "coaty".to_owned(),
        serial: "a1".to_owned(),
    };
    assert_eq!(first.header, expected);
    let state = the_state(COATY, "first state, header id 0");
    let at = Position { x: 0.0, y: 0.0, theta: 0.0, map: "floor".to_owned(), localized: true };
    assert_eq!((state.position, state.order.as_str(), state.last_node.as_str()), (Some(at), "", "n0"));
    assert_eq!(state.power, Power { charge: Some(0.9), charging: false });
}

#[test]
fn last_wills_and_retained_connections_are_read() {
    for (lines, what, expected) in [
        (COATY, "offline, kept by the broker", ConnectionState::Offline),
        (COATY, "last will", ConnectionState::Broken),
        (SDK, "last will", ConnectionState::Broken),
    ] {
        assert_eq!(the(lines, what).expect("readable").message, Message::Connection(expected), "{what}");
    }
}

#[test]
fn instant_actions_are_read_under_either_key_and_once_under_both() {
    let kinds = |actions: Vec<Action>| actions.into_iter().map(|action| action.kind).collect::<Vec<_>>();
    assert_eq!(kinds(the_actions(COATY, "key instantActions")), ["stateRequest"]);
    assert_eq!(kinds(the_actions(ROSI, "key instantActions")), ["stateRequest"]);
    assert_eq!(kinds(the_actions(ROSI, "both keys")), ["stateRequest"]);
    assert_eq!(kinds(the_actions(SDK, "two instant actions")), ["stateRequest", "factsheetRequest"]);
}

#[test]
fn parameters_keep_the_form_of_their_values() {
    let actions = the_actions(ROSI, "numbers as parameters");
    let values: Vec<_> = actions[0].parameters.iter().map(|p| (p.key.as_str(), p.value.clone())).collect();
    let expected = [
        ("x", json!(0)),
        ("y", json!(0)),
        ("theta", json!(0)),
        ("mapId", json!("lab")),
        ("lastNodeId", json!("P")),
    ];
    assert_eq!(values, expected);
}

#[test]
fn orders_are_read_with_base_and_horizon_and_actions() {
    let order = the_order(COATY, "order with a horizon");
    let released: Vec<_> = order.nodes.iter().map(|node| (node.sequence, node.released)).collect();
    assert_eq!(released, [(0, true), (2, true), (4, false)]);
    let update = the_order(COATY, "update with a pick");
    assert_eq!((update.id.as_str(), update.update), ("o1", 1));
    let pick = &update.nodes[1].actions[0];
    assert_eq!((pick.kind.as_str(), pick.blocking, pick.parameters.len()), ("pick", BlockingType::Hard, 3));
}

#[test]
fn an_order_whose_names_are_not_of_its_version_is_understood() {
    let order = the_order(ROSI, "order of 3.0.0 with names of 2.0");
    let ends = (order.edges[0].from.as_str(), order.edges[0].to.as_str());
    assert_eq!(ends, ("P", "A"));
    let place = order.nodes[1].position.as_ref().expect("a position");
    assert_eq!((place.deviation_m, place.deviation_rad), (Some(0.5), Some(3.0)));
}

#[test]
fn an_accepted_order_may_still_list_the_node_where_the_robot_stands() {
    let state = the_state(COATY, "order accepted, start still listed");
    let left: Vec<_> = state.nodes.iter().map(|node| node.sequence).collect();
    assert_eq!((left, state.last_sequence), (vec![0, 2, 4], 0));
}

#[test]
fn loads_are_told_from_no_loads_and_from_not_saying() {
    let loads = |what| the_state(COATY, what).loads;
    assert_eq!(loads("paused").expect("said").len(), 1);
    assert_eq!(loads("loaded").expect("said")[0].kind.as_deref(), Some("EPAL"));
    assert_eq!(loads("unloaded"), Some(Vec::new()));
    assert_eq!(loads("first state, header id 0"), None);
}

#[test]
fn what_a_robot_never_says_is_not_assumed() {
    let state = the_state(ROSI, "nodes with deviations");
    assert_eq!((state.paused, state.velocity, state.loads), (None, None, None));
    assert!(!state.position.expect("a position").localized);
    assert_eq!(the_state(COATY, "paused").paused, Some(true));
    assert!(the_state(SDK, "asks for more base").wants_base);
}

#[test]
fn errors_are_read_with_levels_references_and_hints() {
    let kinds = |state: &State| {
        let errors = state.errors.iter();
        errors.map(|error| (error.kind.clone(), error.level)).collect::<Vec<_>>()
    };
    let idle = the_state(ROSI, "five fatal errors and idle");
    assert_eq!((idle.nodes.len(), idle.errors.len()), (0, 5));
    assert!(idle.errors.iter().all(|error| error.level == ErrorLevel::Fatal));
    assert_eq!(idle.errors[2].refers_to("orderId"), Some("m2"));
    assert_eq!(idle.errors[0].references, []);
    let cancel = the_state(SDK, "cancel failed");
    assert_eq!(kinds(&cancel), [("noOrderToCancel".to_owned(), ErrorLevel::Warning)]);
    assert_eq!(cancel.errors[0].hint.as_deref(), Some("ignore the action or re-check the order state"));
    let refused = the_state(COATY, "error about the key actions");
    assert_eq!(kinds(&refused), [("validationError".to_owned(), ErrorLevel::Warning)]);
    assert_eq!(refused.errors[0].refers_to("headerId"), Some("3"));
    assert_eq!(kinds(&the_state(COATY, "no order to cancel"))[0].0, "noOrderToCancel");
}

#[test]
fn results_of_actions_are_read() {
    let state = the_state(ROSI, "pause failed");
    let pause = state.actions.last().expect("an action");
    assert_eq!(pause.status, ActionStatus::Failed);
    assert_eq!(pause.result.as_deref(), Some("Failed to run action"));
    let state = the_state(SDK, "unknown action finished");
    assert_eq!(state.actions[0].status, ActionStatus::Finished);
}

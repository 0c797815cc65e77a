//! What is understood although no version spells it so, and what is not guessed.

use super::{read_value, words};
use crate::*;
use serde_json::{Value, json};

fn a_state() -> Value {
    json!({
        "headerId": 1, "timestamp": "2026-11-30T12:00:00Z", "version": "2.1.0", "manufacturer": "m",
        "serialNumber": "s", "orderId": "o", "orderUpdateId": 3, "lastNodeId": "a", "lastNodeSequenceId": 2,
        "nodeStates": [{"nodeId": "b", "sequenceId": 4, "released": true}],
        "edgeStates": [{"edgeId": "ab", "sequenceId": 3, "released": true}],
        "agvPosition": {"x": 1.5, "y": -2, "theta": 0.5, "mapId": "hall", "positionInitialized": true},
        "driving": true, "actionStates": [], "batteryState": {"batteryCharge": 50, "charging": false},
        "operatingMode": "AUTOMATIC", "errors": [], "safetyState": {"eStop": "NONE", "fieldViolation": false},
    })
}

fn an_order() -> Value {
    json!({
        "headerId": 1, "timestamp": "2026-11-30T12:00:00Z", "version": "2.0.0", "manufacturer": "m",
        "serialNumber": "s", "orderId": "o", "orderUpdateId": 0,
        "nodes": [
            {"nodeId": "a", "sequenceId": 0, "released": true, "actions": []},
            {"nodeId": "b", "sequenceId": 2, "released": true, "actions": [],
             "nodePosition": {"x": 1, "y": 2, "mapId": "hall"}},
        ],
        "edges": [{"edgeId": "ab", "sequenceId": 1, "released": true, "startNodeId": "a", "endNodeId": "b",
                   "actions": []}],
    })
}

/// A message with one value replaced, or with a key removed if the value is null.
fn with(mut message: Value, pointer: &str, value: Value) -> Value {
    let (parent, key) = pointer.rsplit_once('/').expect("a path");
    let parent = message.pointer_mut(parent).expect("a parent");
    match (parent, value) {
        (Value::Object(fields), Value::Null) => drop(fields.remove(key)),
        (Value::Array(elements), value) => elements[key.parse::<usize>().expect("an index")] = value,
        (parent, value) => parent[key] = value,
    }
    message
}

fn state(value: &Value) -> (State, Vec<String>) {
    let read = read_value(TopicKind::State, value).expect("readable");
    match read.message {
        Message::State(state) => (*state, words(&read.oddities)),
        other => panic!("{other:?}"),
    }
}

fn order(value: &Value) -> (Order, Vec<String>) {
    let read = read_value(TopicKind::Order, value).expect("readable");
    match read.message {
        Message::Order(order) => (order, words(&read.oddities)),
        other => panic!("{other:?}"),
    }
}

fn refusal(kind: TopicKind, value: &Value) -> String {
    read_value(kind, value).expect_err("unreadable").to_string()
}

#[test]
fn keys_of_other_versions_are_read_without_remark_and_similar_keys_with_one() {
    let plain = state(&a_state());
    assert_eq!(plain.1, [""; 0]);
    let mut other = with(a_state(), "/agvPosition", Value::Null);
    other["mobileRobotPosition"] =
        json!({"x": 1.5, "y": -2, "theta": 0.5, "mapId": "hall", "localized": true});
    other["unheardOf"] = json!({"by": ["any", "version"]});
    assert_eq!(state(&other), plain);
    let mut similar = with(a_state(), "/lastNodeId", Value::Null);
    similar["last_node_ID"] = json!("a");
    let (read, oddities) = state(&similar);
    assert_eq!(read, plain.0);
    assert_eq!(oddities, [r#"the message: "last_node_ID" was understood as "lastNodeId""#]);
}

#[test]
fn words_of_all_versions_and_similar_ones_are_read_and_unknown_ones_are_taken_carefully() {
    let mode = |word: &str| {
        let (state, oddities) = state(&with(a_state(), "/operatingMode", json!(word)));
        (state.mode, oddities.concat())
    };
    assert_eq!(mode("TEACHIN"), (OperatingMode::TeachIn, String::new()));
    assert_eq!(mode("TEACH_IN"), (OperatingMode::TeachIn, String::new()));
    let automatic = r#"operatingMode: "automatic" was understood as "AUTOMATIC""#;
    assert_eq!(mode("automatic"), (OperatingMode::Automatic, automatic.to_owned()));
    let unknown = r#"operatingMode is "CHAOS", a word that no version knows, and was taken as MANUAL"#;
    assert_eq!(mode("CHAOS"), (OperatingMode::Manual, unknown.to_owned()));
    let paused =
        json!([{"actionId": "1", "actionStatus": "PAUSED"}, {"actionId": "2", "actionStatus": "DANCING"}]);
    let (read, oddities) = state(&with(a_state(), "/actionStates", paused));
    let statuses: Vec<_> = read.actions.iter().map(|action| action.status).collect();
    assert_eq!(statuses, [ActionStatus::Paused, ActionStatus::Running]);
    assert_eq!(oddities.len(), 1);
    for word in ["CONNECTIONBROKEN", "CONNECTION_BROKEN", "connection-broken", "VANISHED"] {
        let read = read_value(TopicKind::Connection, &json!({"connectionState": word})).expect("readable");
        assert_eq!(read.message, Message::Connection(ConnectionState::Broken), "{word}");
    }
}

#[test]
fn numbers_as_texts_and_whole_numbers_with_a_fraction_of_0_are_read() {
    let odd = with(a_state(), "/agvPosition/x", json!("1.5"));
    let odd = with(odd, "/lastNodeSequenceId", json!(2.0));
    let odd = with(odd, "/driving", json!("true"));
    let odd = with(odd, "/orderId", json!(17));
    let (read, oddities) = state(&odd);
    assert_eq!(read, State { order: "17".to_owned(), ..state(&a_state()).0 });
    let expected = [
        "orderId is a number instead of a text, and was understood",
        "agvPosition.x is a text instead of a number, and was understood",
        "driving is a text instead of true or false, and was understood",
    ];
    assert_eq!(oddities, expected);
}

#[test]
fn numbers_that_cannot_be_meant_are_missing() {
    let text = a_state().to_string();
    for bad in ["NaN", "-Infinity", "1e999", "1e10", "\"NaN\""] {
        let text = text.replace("\"x\":1.5", &format!("\"x\":{bad}"));
        let read = read(TopicKind::State, text.as_bytes()).expect("readable");
        let Message::State(state) = &read.message else { panic!("{bad}") };
        assert_eq!(state.position, None, "{bad}");
        assert!(matches!(read.oddities[..], [.., Oddity::LeftOut { .. }]), "{bad}: {:?}", read.oddities);
        assert!(read.oddities.iter().any(|oddity| matches!(oddity, Oddity::BadNumber { .. })), "{bad}");
    }
    for bad in [json!(-1), json!(4_294_967_296_u64), json!(0.5)] {
        let (read, oddities) = state(&with(a_state(), "/lastNodeSequenceId", bad.clone()));
        assert_eq!(read.last_sequence, 0);
        let bad = bad.to_string();
        assert_eq!(
            oddities[0],
            format!("lastNodeSequenceId is {bad}, which cannot be meant, and was ignored")
        );
        assert_eq!(oddities[1], "lastNodeSequenceId is missing and was taken as 0");
    }
}

#[test]
fn a_charge_is_in_percent_and_one_that_cannot_be_is_unknown() {
    let charge =
        |percent: Value| state(&with(a_state(), "/batteryState/batteryCharge", percent)).0.power.charge;
    assert_eq!([json!(0), json!(50), json!(100.4)].map(charge), [Some(0.0), Some(0.5), Some(1.0)]);
    assert_eq!([json!(-1), json!(250), Value::Null].map(charge), [None; 3]);
}

#[test]
fn a_state_that_says_nothing_is_taken_as_that_of_a_robot_that_must_be_left_alone() {
    let (read, oddities) = state(&json!({}));
    assert_eq!((read.mode, read.e_stop, read.power.charge), (OperatingMode::Manual, EStop::Manual, None));
    assert_eq!((read.position, read.loads, read.paused), (None, None, None));
    for expected in [
        "version is missing and was taken as empty",
        "nodeStates is missing and was taken as empty",
        "safetyState.eStop is missing and was taken as MANUAL",
        "batteryState.batteryCharge is missing and was taken as unknown",
    ] {
        assert!(oddities.iter().any(|oddity| oddity == expected), "{expected}: {oddities:#?}");
    }
}

#[test]
fn a_robot_never_seems_to_have_arrived_because_its_numbers_are_odd() {
    for bad in [Value::Null, json!(-4), json!("four")] {
        let odd = with(a_state(), "/nodeStates/0/sequenceId", bad);
        let expected = "nodeStates[0].sequenceId is missing or cannot be understood, and must not be guessed";
        assert_eq!(refusal(TopicKind::State, &odd), expected);
    }
    let (read, oddities) = state(&with(a_state(), "/nodeStates/0/released", Value::Null));
    assert!(read.nodes[0].released);
    assert_eq!(oddities, ["nodeStates[0].released is missing and was taken as true"]);
}

#[test]
fn what_the_rest_does_not_depend_on_is_left_out() {
    let (read, oddities) = state(&with(a_state(), "/actionStates", json!([{"actionStatus": "RUNNING"}, 5])));
    assert_eq!(read.actions, []);
    assert_eq!(
        oddities,
        [
            "actionStates[0] was left out: \
             actionStates[0].actionId is missing or cannot be understood, and must not be guessed",
            "actionStates[1] is a number instead of an object, and was ignored",
            "actionStates[1] was left out: \
             actionStates[1].actionId is missing or cannot be understood, and must not be guessed",
        ]
    );
    let actions = json!({"actions": [{"actionId": "1"}, {"actionId": "2", "actionType": "startPause"}]});
    let read = read_value(TopicKind::InstantActions, &actions).expect("readable");
    let Message::InstantActions(actions) = read.message else { panic!() };
    assert_eq!((actions.len(), actions[0].kind.as_str()), (1, "startPause"));
    assert_eq!(actions[0].blocking, BlockingType::None);
}

#[test]
fn requests_of_3_0_are_read_with_what_they_are_about() {
    let mut odd = with(a_state(), "/version", json!("3.0.0"));
    odd["zoneRequests"] = json!([{"requestId": "1", "requestType": "ACCESS", "zoneId": "z", "zoneSetId": "s",
                                  "requestStatus": "GRANTED"}]);
    odd["edgeRequests"] = json!([{"requestId": "2", "requestType": "CORRIDOR", "edgeId": "e", "sequenceId": 3,
                                  "requestStatus": "LOST"}]);
    odd["instantActionStates"] = json!([{"actionId": "i", "actionStatus": "RETRIABLE"}]);
    odd["safetyState"] = json!({"activeEmergencyStop": "REMOTE", "fieldViolation": true});
    odd["errors"] = json!([{"errorType": "x", "errorLevel": "URGENT"}]);
    let (read, _) = state(&odd);
    let about = read.requests.iter().map(|request| (&request.subject, request.status)).collect::<Vec<_>>();
    let zone = RequestSubject::Zone { zone: "z".to_owned(), zone_set: "s".to_owned(), replanning: false };
    let corridor = RequestSubject::Corridor { edge: "e".to_owned(), sequence: 3 };
    assert_eq!(about, [(&zone, RequestStatus::Granted), (&corridor, RequestStatus::Requested)]);
    assert_eq!(read.instant_actions[0].status, ActionStatus::Retriable);
    assert_eq!((read.e_stop, read.field_violation), (EStop::Remote, true));
    assert_eq!(read.errors[0].level, ErrorLevel::Urgent);
}

#[test]
fn a_deviation_is_read_as_a_number_under_its_old_key_and_as_an_ellipse() {
    let deviation = |key: &str, value: Value| {
        let mut odd = an_order();
        odd["nodes"][1]["nodePosition"][key] = value;
        let (order, oddities) = order(&odd);
        (order.nodes[1].position.as_ref().and_then(|place| place.deviation_m), oddities.len())
    };
    assert_eq!(deviation("allowedDeviationXY", json!(0.5)), (Some(0.5), 0));
    assert_eq!(deviation("allowedDeviationXy", json!(0.5)), (Some(0.5), 0));
    assert_eq!(deviation("AllowedDeviation_XY", json!(0.5)), (Some(0.5), 1));
    let ellipse = json!({"a": 1.5, "b": 0.25, "theta": 1});
    assert_eq!(deviation("allowedDeviationXY", ellipse.clone()), (Some(0.25), 0));
    assert_eq!(deviation("ALLOWED_DEVIATION_XY", ellipse), (Some(0.25), 1));
    assert_eq!(deviation("allowedDeviationXY", json!(-1)), (None, 1));
}

#[test]
fn edges_without_ends_have_those_that_their_numbers_say() {
    let mut new = with(an_order(), "/version", json!("3.0.0"));
    let edge = new["edges"][0].as_object_mut().expect("an edge");
    edge.remove("startNodeId");
    edge.remove("endNodeId");
    assert_eq!(order(&new), order(&an_order()));
    let (read, oddities) = order(&with(an_order(), "/edges/0/endNodeId", Value::Null));
    assert_eq!(read.edges[0].to, "b");
    assert_eq!(oddities, ["edges[0].endNodeId is missing and was taken as b"]);
}

#[test]
fn an_order_is_read_as_a_whole_or_not_at_all() {
    for place in [
        "orderId",
        "orderUpdateId",
        "nodes",
        "nodes[1].nodeId",
        "nodes[1].sequenceId",
        "nodes[1].nodePosition.x",
        "nodes[1].nodePosition.mapId",
        "edges[0].edgeId",
        "edges[0].sequenceId",
    ] {
        let pointer = format!("/{}", place.replace("[", "/").replace("].", "/").replace(".", "/"));
        let odd = with(an_order(), &pointer, Value::Null);
        let expected = format!("{place} is missing or cannot be understood, and must not be guessed");
        assert_eq!(refusal(TopicKind::Order, &odd), expected);
    }
    let mut odd = an_order();
    odd["nodes"][1]["actions"] = json!([{"actionId": "1", "blockingType": "HARD"}]);
    let expected =
        "nodes[1].actions[0].actionType is missing or cannot be understood, and must not be guessed";
    assert_eq!(refusal(TopicKind::Order, &odd), expected);
}

#[test]
fn what_is_not_released_for_sure_is_not_released() {
    let (read, oddities) = order(&with(an_order(), "/nodes/1/released", json!("perhaps")));
    assert!(!read.nodes[1].released);
    assert_eq!(oddities.len(), 2);
    let mut odd = an_order();
    odd["nodes"][1]["actions"] =
        json!([{"actionId": "1", "actionType": "pick", "blockingType": "SOMETIMES"}]);
    assert_eq!(order(&odd).0.nodes[1].actions[0].blocking, BlockingType::Hard);
}

#[test]
fn an_action_may_be_called_as_in_the_tag_2_0_0() {
    let tagged =
        json!({"instantActions": [{"actionId": "1", "actionName": "cancelOrder", "blockingType": "HARD"}]});
    let read = read_value(TopicKind::InstantActions, &tagged).expect("readable");
    let Message::InstantActions(actions) = read.message else { panic!() };
    assert_eq!((actions[0].kind.as_str(), actions[0].blocking), ("cancelOrder", BlockingType::Hard));
    let both = json!({
        "actions": [{"actionId": "1", "actionType": "a"}],
        "instantActions": [{"actionId": "1", "actionType": "a"}, {"actionId": "2", "actionType": "b"}],
    });
    let read = read_value(TopicKind::InstantActions, &both).expect("readable");
    assert!(matches!(read.message, Message::InstantActions(actions) if actions.len() == 2));
    let refused = refusal(TopicKind::InstantActions, &json!({"headerId": 1}));
    assert_eq!(refused, "actions is missing or cannot be understood, and must not be guessed");
}

#[test]
fn a_connection_without_a_state_is_not_guessed() {
    let expected = "connectionState is missing or cannot be understood, and must not be guessed";
    for value in [json!({}), json!({"connectionState": null}), json!({"connectionState": 3})] {
        assert_eq!(refusal(TopicKind::Connection, &value), expected);
    }
}

#[test]
fn a_factsheet_of_the_tag_3_0_0_has_a_blank_in_a_key() {
    let sheet = json!({"mobileRobotConfiguration": {"batteryCharging ": {"criticalLowChargingLevel": 15}}});
    let read = read_value(TopicKind::Factsheet, &sheet).expect("readable");
    assert!(matches!(read.message, Message::Factsheet(sheet) if sheet.critical == Some(0.15)));
}

#[test]
fn an_answer_that_cannot_be_read_grants_nothing_and_does_not_stop_others() {
    let responses = json!({"responses": [
        {"requestId": "1", "responseType": "granted", "leaseExpiry": "2026-11-30T12:00:00.5Z"},
        {"requestId": "2", "grantType": "GRANTED", "leaseExpiry": "soon"},
        {"grantType": "GRANTED"},
        {"requestId": "4", "grantType": "PERHAPS"},
    ]});
    let read = read_value(TopicKind::Responses, &responses).expect("readable");
    let Message::Responses(read) = read.message else { panic!() };
    let said: Vec<_> = read.iter().map(|r| (r.request.as_str(), r.grant, r.until_us)).collect();
    let half_past = Some(1_796_040_000_500_000);
    assert_eq!(said, [("1", Grant::Granted, half_past), ("4", Grant::Rejected, None)]);
}

#[test]
fn a_zone_set_is_read_as_a_whole_and_nobody_enters_a_zone_with_an_unknown_rule() {
    let corner = |x: f64, y: f64| json!({"x": x, "y": y});
    let corners = json!([corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0)]);
    let set = |vertices: &Value| {
        let zone = json!({"zoneId": "z", "zoneType": "LAVA", "vertices": vertices});
        json!({"zoneSet": {"zoneSetId": "s", "mapId": "m", "zones": [zone]}})
    };
    let read = read_value(TopicKind::ZoneSet, &set(&corners)).expect("readable");
    let Message::ZoneSet(read) = read.message else { panic!() };
    assert_eq!((read.zones[0].kind, read.zones[0].corners.len()), (ZoneKind::Blocked, 3));
    for wrong in [json!([]), json!([corner(0.0, 0.0)]), json!([{"x": 1}, {"x": 2}, {"x": 3}])] {
        assert!(read_value(TopicKind::ZoneSet, &set(&wrong)).is_err(), "{wrong}");
    }
}

//! Tests of a robot whose messages travel as bytes.

use super::*;
use crate::read::read;
use crate::robot::wire::{ReadMessage, WireRobot};
use crate::robot::{GarbledMessage, RobotQuirks, VersionCheck};
use crate::topic::TopicKind;
use crate::write::write;
use crate::{Header, Oddity};
use serde_json::json;

fn header(version: &str) -> Header {
    Header {
        id: 7,
        timestamp: "2026-01-01T00:00:00.000Z".into(),
        version: version.into(),
        manufacturer: "maker".into(),
        serial: "r1".into(),
    }
}

fn bytes(message: &Message, version: Version) -> Value {
    write(&header(version.text()), message, version)
}

fn clear(robot: &WireRobot, kind: TopicKind, text: &Value) -> bool {
    matches!(robot.read(kind, text.to_string().as_bytes()), ReadMessage::Clear(_))
}

#[test]
fn a_robot_reads_instant_actions_under_its_own_key_and_both_keys_suit_every_robot() {
    let ask = bytes(&Message::InstantActions(vec![action("stateRequest", "i1")]), Version::V2_0);
    let mut other = ask.clone();
    let fields = other.as_object_mut().expect("an object");
    let actions = fields.remove("actions").expect("the key");
    fields.insert("instantActions".into(), actions);
    let mut both = ask.clone();
    both["instantActions"] = ask["actions"].clone();
    let (a, b) = (WireRobot::new(RobotSetup::like_a()), WireRobot::new(RobotSetup::like_b()));
    let understood =
        |robot: &WireRobot| [&ask, &other, &both].map(|text| clear(robot, TopicKind::InstantActions, text));
    assert_eq!((understood(&a), understood(&b)), ([false, true, true], [true, false, true]));
}

#[test]
fn a_robot_reads_the_deviation_that_it_can_spell_and_no_other() {
    let mut sent = short_order("o1");
    let place = sent.nodes[0].position.as_mut().expect("a place");
    place.deviation_m = Some(0.7);
    let text = bytes(&Message::Order(sent), Version::V2_0);
    let read_by = |setup: RobotSetup, text: &Value| {
        let read = WireRobot::new(setup).read(TopicKind::Order, text.to_string().as_bytes());
        let ReadMessage::Clear(Message::Order(order)) = read else { panic!("no order: {read:?}") };
        order.nodes[0].position.as_ref().and_then(|place| place.deviation_m)
    };
    assert_eq!(read_by(RobotSetup::like_c(), &text), Some(0.7));
    assert_eq!(read_by(RobotSetup::like_a(), &text), None);
    let mut lower = text.clone();
    let place = lower["nodes"][0]["nodePosition"].as_object_mut().expect("a place");
    place.remove("allowedDeviationXY");
    place.insert("allowedDeviationXy".into(), json!(0.7));
    assert_eq!(read_by(RobotSetup::like_a(), &lower), Some(0.7));
    assert_eq!(read_by(RobotSetup::like_c(), &lower), None);
}

#[test]
fn a_robot_refuses_other_versions_and_what_is_no_json_unless_it_is_not_choosy() {
    let text = bytes(&Message::Order(short_order("o1")), Version::V3_0);
    let b = WireRobot::new(RobotSetup::like_b());
    let garbled = |why| ReadMessage::Garbled(TopicKind::Order, why);
    assert_eq!(b.read(TopicKind::Order, text.to_string().as_bytes()), garbled(GarbledMessage::WrongForm));
    assert_eq!(b.read(TopicKind::Order, b"no"), garbled(GarbledMessage::NotJson));
    let quirks = RobotQuirks { version_check: VersionCheck::Any, ..RobotQuirks::default() };
    let any = WireRobot::new(RobotSetup { quirks, ..RobotSetup::like_b() });
    assert!(clear(&any, TopicKind::Order, &text));
}

#[test]
fn a_robot_numbers_its_messages_and_its_factsheet_is_as_bad_as_measured() {
    let sheet_of = |setup: RobotSetup| {
        let mut robot = WireRobot::new(RobotSetup { announces_factsheet: true, ..setup });
        let said = robot.step(0, "2026-01-01T00:00:00.000Z", Vec::new());
        let sheet = said.iter().find(|said| said.kind == TopicKind::Factsheet).expect("a factsheet");
        read(TopicKind::Factsheet, &sheet.payload).expect("readable")
    };
    let missing = |setup: RobotSetup| {
        let oddities = sheet_of(setup).oddities;
        oddities.iter().filter(|odd| matches!(odd, Oddity::Missing { .. })).count()
    };
    let standard = RobotSetup::new(Version::V2_1, "maker", "r1", "lab", "n0");
    assert_eq!(missing(standard.clone()), 0);
    assert_eq!(missing(RobotSetup::like_a()), 6, "the header and nothing else");
    assert_eq!(missing(RobotSetup::like_c()), 1, "no loads");
    let mut robot = WireRobot::new(RobotSetup { state_interval_us: TICK_US, ..standard });
    let ids = [0, 1, 2].map(|i| {
        let said = robot.step(i * 2 * TICK_US, "2026-01-01T00:00:00.000Z", Vec::new());
        let state = said.iter().find(|said| said.kind == TopicKind::State).expect("a state");
        read(TopicKind::State, &state.payload).expect("readable").header.id
    });
    assert_eq!(ids, [0, 1, 2]);
}

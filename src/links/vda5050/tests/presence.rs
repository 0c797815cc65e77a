//! Robots that are somewhere before they are commanded, and what operators send them.

use super::*;
use giveway_floor::geometry::{Point, Pose};
use giveway_vda5050::OperatingMode;

#[test]
fn a_robot_off_all_nodes_that_a_person_drives_is_in_others_way_before_it_may_be_commanded() {
    let mut floor = LinkFloor::new(thesis(), vec![standard(Version::V2_0), standard(Version::V2_1)]);
    let node = floor.map().nodes_where(|kind| kind == NodeKind::Parking)[5];
    floor.switch_on_beside(standard(Version::V3_0), node, 0.45);
    floor.pairs[2].robot.robot.set_mode(OperatingMode::Manual);
    floor.until(10, "it is on the floor", |f| f.pairs[2].number.is_some());
    floor.run(2);
    let robot = floor.pairs[2].number.expect("it has joined");
    assert!(floor.fleet.why(robot).is_some_and(|why| why.is_by_itself()), "{:?}", floor.fleet.why(robot));
    let not_ready = floor.pairs[2].session.not_ready(floor.now);
    assert_eq!(not_ready, Some(NotReady::Mode(OperatingMode::Manual)));
    let jobs = floor.submit_deliveries(6);
    floor.until_done(&jobs, 1800);
    let told = &floor.pairs[2].told;
    assert!(told.iter().all(|(_, kind, _)| *kind != TopicKind::Order), "nobody commands it");
}

#[test]
fn a_robot_joins_at_the_nearest_free_node_and_none_joins_from_beyond_the_floor() {
    let floor = LinkFloor::new(lab(), Vec::new());
    let (fleet, map) = (&floor.fleet, floor.map());
    let kind = fleet.ledger().kinds()[0].name.clone();
    let node = map.nodes_where(|kind| kind == NodeKind::Parking)[0];
    assert_eq!(fleet.place_to_join(&kind, map.nodes[node].at), Some(node));
    assert_eq!(fleet.place_to_join(&kind, Point::new(1e4, 1e4)), None);
    assert_eq!(fleet.place_to_join("no such kind", map.nodes[node].at), None);
}

#[test]
fn a_robot_that_says_little_gets_jobs_all_the_same() {
    let mut quiet = RobotSetup::like_c();
    quiet.quirks.localized_flag = LocalizedFlag::Reported;
    let mut floor = LinkFloor::new(lab(), vec![quiet]);
    floor.run(20);
    floor.pairs[0].session.consent();
    floor.run(90);
    let robot = floor.pairs[0].number.expect("it has joined");
    assert_eq!(floor.fleet.why(robot), None, "it is idle, not silent");
}

#[test]
fn an_action_of_an_operator_is_sent_alone_and_its_fate_is_known() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_1)]);
    floor.all_ready();
    let (now, pair) = (floor.now, &mut floor.pairs[0]);
    let place = Pose { at: Point::new(2.0, 1.0), heading: 0.5 };
    let parameters = pair.session.init_position(place).expect("the floor's map is known");
    let keys: Vec<&str> = parameters.iter().map(|p| p.key.as_str()).collect();
    assert_eq!(keys, ["x", "y", "theta", "mapId", "lastNodeId"]);
    let (id, out) = pair.session.act(now, "stateRequest", Vec::new()).expect("it is sent");
    let sent = |told: &RobotTold| matches!(&told.message, Message::InstantActions(all) if all.len() == 1);
    assert!(out.told.iter().all(sent) && !out.told.is_empty());
    assert_eq!(pair.session.sent_action(&id).and_then(|sent| sent.status), None);
    floor.take(0, out, &mut Vec::new());
    let wanted = id.clone();
    floor.until(5, "it is done", move |f| {
        let status = f.pairs[0].session.sent_action(&wanted).and_then(|sent| sent.status);
        status.is_some_and(|status| status.is_over())
    });
    for ours in ["startPause", "stopPause", "cancelOrder"] {
        let why = floor.pairs[0].session.act(floor.now, ours, Vec::new()).expect_err("Giveway says it");
        assert!(why.text().contains("by itself"), "{why}");
    }
    assert_eq!(floor.pairs[0].session.sent_action("gw-1-999"), None);
}

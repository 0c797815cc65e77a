//! Robot B, PyPI `vda5050-sdk` 0.2.0: each line of `data/vda5050/README.md` that the preset shows.

use super::*;
use crate::TopicKind;
use crate::robot::{GarbledMessage, MidwayUpdate, ReadingHabit};

fn robot() -> RobotBench {
    RobotBench::new(RobotSetup::like_b())
}

/// The robot whose executor runs beside its reader.
fn beside() -> RobotSetup {
    let mut setup = RobotSetup::like_b();
    setup.quirks.reading = ReadingHabit::AtOnce;
    setup
}

#[test]
fn messages_while_it_drives_reads_nothing_until_it_stands_at_the_end_of_its_base() {
    let mut bench = robot();
    bench.order(&order_with_horizon());
    bench.run(1.0);
    bench.instant("startPause", "a1");
    bench.instant("stopPause", "a2");
    bench.order(&order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0)], 2));
    bench.run(1.0);
    assert_eq!((bench.status("a1"), bench.state().update), (None, 0));
    assert!(bench.state().driving);
    while bench.state().update == 0 {
        bench.run(0.05);
    }
    assert_eq!(bench.state().last_sequence, 2, "late, in order, where its base ended");
    assert!(bench.status("a1").is_some() && bench.status("a2").is_some());
    bench.instant("cancelOrder", "c1");
    bench.run(20.0);
    assert_eq!(bench.x(), 6.0);
    assert_eq!(bench.status("c1"), Some(ActionStatus::Failed), "there is nothing left to cancel");
}

#[test]
fn executor_beside_the_reader_nodes_of_the_base_that_are_not_passed_yet_vanish_from_node_states() {
    let mut bench = RobotBench::new(beside());
    bench.order(&order_with_horizon());
    bench.run(1.0);
    bench.order(&order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0)], 2));
    let state = bench.state();
    assert_eq!((bench.nodes_left(), state.last_sequence), (vec!["n2".to_owned()], 0));
    assert!(bench.x() < 1.0);
    bench.run(15.0);
    assert_eq!((bench.x(), bench.state().last_sequence), (6.0, 4), "it passes n1 all the same");
    assert!(bench.states().iter().any(|s| s.last_node == "n1"));
}

#[test]
fn executor_beside_the_reader_it_may_stand_for_ever_with_released_nodes_ahead_no_error_driving_false() {
    let mut setup = beside();
    setup.quirks.midway_update = MidwayUpdate::Strands;
    let mut bench = RobotBench::new(setup);
    bench.order(&order_with_horizon());
    bench.run(1.0);
    bench.order(&order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0)], 2));
    bench.run(60.0);
    let state = bench.state();
    assert!(bench.x() < 3.0 && !state.driving && state.errors.is_empty());
    assert!(state.nodes.iter().any(|node| node.released));
    bench.instant("cancelOrder", "c1");
    assert_eq!(bench.status("c1"), Some(ActionStatus::Finished));
}

#[test]
fn resent_stitching_actions_recognised_by_id_not_done_again() {
    let mut bench = robot();
    let mut first = short_order("o1");
    first.nodes[1].actions = vec![hard("pick", "p1")];
    bench.order(&first);
    bench.run(15.0);
    let mut update = order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0)], 2);
    update.nodes[0].actions = first.nodes[1].actions.clone();
    bench.order(&update);
    bench.run(15.0);
    assert_eq!((bench.state().actions.len(), bench.x()), (1, 6.0));
}

#[test]
fn key_of_instant_actions_actions_both_keys_are_fine() {
    let key = RobotSetup::like_b().quirks.instant_actions_key;
    assert!(key.understands(true, false) && !key.understands(false, true) && key.understands(true, true));
}

#[test]
fn a_header_with_2_0_0_accepted_with_3_0_0_validation_error() {
    let mut bench = robot();
    let check = bench.robot.robot.setup().quirks.version_check;
    assert!(check.accepts(Version::V2_1, Version::V2_0) && !check.accepts(Version::V2_1, Version::V3_0));
    bench.robot.robot.receive_unreadable(TopicKind::Order, GarbledMessage::WrongForm);
    bench.run(0.1);
    assert_eq!(bench.errors(), ["validationError"]);
}

#[test]
fn unknown_action_in_an_order_done_as_if_it_knew_it() {
    let mut bench = robot();
    let mut driven = short_order("o1");
    driven.nodes[0].actions = vec![hard("juggle", "j1")];
    bench.order(&driven);
    assert_eq!(bench.status("j1"), Some(ActionStatus::Running));
    bench.run(1.2);
    assert_eq!((bench.status("j1"), bench.errors().len()), (Some(ActionStatus::Finished), 0));
}

#[test]
fn second_cancel_order_failed_and_no_order_to_cancel_kept_for_ever() {
    let mut bench = robot();
    bench.instant("cancelOrder", "c1");
    assert_eq!(
        (bench.status("c1"), bench.errors()),
        (Some(ActionStatus::Failed), vec!["noOrderToCancel".to_owned()])
    );
    bench.order(&order("far", 0, 0, &[("n9", 9.0)], 1));
    assert_eq!(bench.errors().len(), 2);
    bench.order(&short_order("o1"));
    assert_eq!(bench.errors(), ["noOrderToCancel"], "the order's error went");
}

#[test]
fn lower_or_equal_number_other_order_while_busy_start_too_far_away() {
    let mut bench = RobotBench::new(beside());
    bench.order(&order("o1", 1, 0, &[("n0", 0.0), ("n1", 3.0)], 2));
    let before = bench.states().len();
    bench.order(&order("o1", 1, 0, &[("n0", 0.0), ("n9", 3.0)], 2));
    assert_eq!((bench.states().len(), bench.errors().len()), (before, 0), "silence");
    bench.order(&order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0)], 2));
    bench.order(&short_order("o2"));
    assert_eq!(bench.errors(), ["orderUpdateError", "orderError"]);
    bench.run(10.0);
    bench.order(&short_order("o3"));
    assert_eq!(bench.errors().last().map(String::as_str), Some("orderError"));
}

#[test]
fn first_node_must_be_its_last_node_with_the_same_number_or_lie_within_the_deviation_of_its_pose() {
    let mut bench = robot();
    let mut near = order("o1", 0, 0, &[("t", 0.01), ("n1", 3.0)], 2);
    bench.order(&near);
    assert_eq!(bench.errors(), ["orderError"], "none given: exactly there");
    near.nodes[0].position.as_mut().expect("given").deviation_m = Some(0.5);
    bench.order(&near);
    assert!(bench.errors().is_empty());
    let mut bench = robot();
    bench.order(&order("o1", 0, 0, &[("n0", 2.0), ("n1", 3.0)], 2));
    assert!(bench.errors().is_empty(), "its last node with the same number, wherever that is");
}

#[test]
fn new_base_request_true_at_the_end_of_every_base() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    bench.run(1.0);
    assert!(!bench.state().wants_base);
    bench.run(10.0);
    assert!(bench.state().wants_base && bench.nodes_left().is_empty());
}

#[test]
fn factsheet_none_and_loads_unknown() {
    let mut bench = robot();
    bench.instant("factsheetRequest", "f1");
    assert_eq!(bench.status("f1"), Some(ActionStatus::Finished));
    assert!(bench.said.iter().all(|said| said.topic != TopicKind::Factsheet));
    assert_eq!(bench.state().loads, None);
    bench.run(5.0);
    assert!(bench.said.iter().all(|said| said.topic != TopicKind::Visualization));
}

#[test]
fn broker_gone_never_comes_back_until_a_reboot() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    bench.run(1.0);
    bench.robot.robot.lose_broker();
    bench.said.clear();
    bench.run(5.0);
    bench.robot.robot.find_broker();
    bench.instant("stateRequest", "s1");
    bench.run(100.0);
    assert!(bench.said.is_empty() && !bench.robot.robot.is_online());
    assert_eq!(bench.x(), 3.0, "it drove to the end of its base");
    let position = bench.state().position.expect("it says");
    bench.robot.robot.reboot(position, "n1");
    bench.run(0.1);
    assert_eq!(bench.connections(), [ConnectionState::Online]);
}

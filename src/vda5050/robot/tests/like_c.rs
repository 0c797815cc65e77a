//! Robot C, PyPI `vda5050-core` 0.1.0rc2: each line of `data/vda5050/README.md` that the preset shows.

use super::*;
use crate::TopicKind;
use crate::model::error::ErrorLevel;
use crate::robot::GarbledMessage;
use serde_json::json;

fn robot() -> RobotBench {
    RobotBench::new(RobotSetup::like_c())
}

fn fatal(bench: &RobotBench) -> Vec<String> {
    assert!(bench.state().errors.iter().all(|error| error.level == ErrorLevel::Fatal));
    bench.errors()
}

#[test]
fn start_connection_online_no_state_until_something_happens() {
    let mut bench = robot();
    bench.run(120.0);
    assert_eq!((bench.connections(), bench.said.len()), (vec![ConnectionState::Online], 1));
    bench.instant("stateRequest", "s1");
    assert_eq!(bench.states().len(), 1);
    bench.run(120.0);
    assert_eq!(bench.states().len(), 1, "state is no heartbeat");
}

#[test]
fn instant_actions_under_the_wrong_key_json_deserialization_error_fatal() {
    let mut bench = robot();
    let key = bench.robot.robot.setup().quirks.instant_actions_key;
    assert!(key.understands(true, false) && !key.understands(false, true) && key.understands(true, true));
    bench.robot.robot.receive_unreadable(TopicKind::InstantActions, GarbledMessage::WrongForm);
    bench.run(0.1);
    assert_eq!(fatal(&bench), ["JSON_DESERIALIZATION_ERROR"]);
}

#[test]
fn two_instant_actions_in_a_message_fine_and_factsheet_on_request_sent() {
    let mut bench = robot();
    let both = vec![action("stateRequest", "s1"), action("factsheetRequest", "f1")];
    bench.hear(&[Message::InstantActions(both)]);
    assert_eq!(
        (bench.status("s1"), bench.status("f1")),
        (Some(ActionStatus::Finished), Some(ActionStatus::Finished))
    );
    assert!(bench.said.iter().any(|said| said.topic == TopicKind::Factsheet));
}

#[test]
fn order_of_version_3_0_0_on_the_2_0_topic_accepted() {
    assert!(RobotSetup::like_c().quirks.version_check.accepts(Version::V2_0, Version::V3_0));
}

#[test]
fn the_same_bytes_again_order_update_error_fatal_beside_the_running_order() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    bench.run(1.0);
    bench.order(&short_order("o1"));
    assert_eq!(fatal(&bench), ["orderUpdateError"]);
    bench.run(10.0);
    assert_eq!(bench.x(), 3.0);
}

#[test]
fn other_order_while_busy_lower_number_start_far_away_order_update_error_fatal_each_never_removed() {
    let mut bench = robot();
    bench.order(&order("o1", 1, 0, &[("n0", 0.0), ("n1", 3.0)], 2));
    bench.order(&order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0)], 2));
    bench.order(&short_order("o2"));
    bench.run(10.0);
    bench.order(&order("far", 0, 0, &[("n9", 9.0)], 1));
    assert_eq!(fatal(&bench), ["orderUpdateError"; 3]);
    bench.order(&order("o3", 0, 0, &[("n1", 3.0), ("n2", 6.0)], 2));
    bench.run(10.0);
    assert_eq!((bench.x(), bench.errors().len()), (6.0, 3), "it goes on obeying");
}

#[test]
fn start_pause_failed_at_once_drives_on_to_the_end_of_its_base() {
    let mut bench = robot();
    bench.order(&order_with_horizon());
    bench.run(1.0);
    bench.instant("startPause", "a1");
    assert_eq!((bench.status("a1"), bench.errors().len()), (Some(ActionStatus::Failed), 0));
    bench.run(10.0);
    assert_eq!((bench.x(), bench.state().paused), (3.0, None));
}

#[test]
fn cancel_order_in_mid_way_finished_drives_on_to_the_end_of_the_order_node_states_keep_shrinking() {
    let mut bench = robot();
    bench.order(&order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 3));
    bench.run(1.0);
    bench.instant("cancelOrder", "c1");
    assert_eq!((bench.status("c1"), bench.nodes_left().len()), (Some(ActionStatus::Finished), 2));
    bench.run(2.5);
    assert_eq!(bench.nodes_left().len(), 1);
    bench.run(10.0);
    assert_eq!((bench.x(), bench.nodes_left().len(), bench.errors().len()), (6.0, 0, 0));
}

#[test]
fn cancel_order_and_start_charging_without_an_order_finished_and_nothing_happens() {
    let mut bench = robot();
    bench.instant("cancelOrder", "c1");
    bench.instant("startCharging", "s1");
    assert_eq!(
        (bench.status("c1"), bench.status("s1")),
        (Some(ActionStatus::Finished), Some(ActionStatus::Finished))
    );
    assert!(bench.errors().is_empty() && !bench.state().power.charging);
    bench.order(&short_order("o1"));
    assert!(bench.status("c1").is_some(), "finished instant actions stay listed");
}

#[test]
fn pick_on_a_node_an_unknown_action_not_done_no_action_state_the_order_ends_as_done() {
    let mut bench = robot();
    let mut driven = short_order("o1");
    driven.nodes[1].actions = vec![hard("pick", "p1"), hard("dance", "d1")];
    bench.order(&driven);
    bench.run(10.0);
    let state = bench.state();
    assert_eq!((bench.x(), state.nodes.len(), state.actions.len(), state.errors.len()), (3.0, 0, 0, 0));
    assert_eq!(state.loads, None);
}

#[test]
fn init_position_with_numbers_as_values_parse_error_fatal() {
    let mut bench = robot();
    let place = [("x", json!(5)), ("y", json!(0)), ("theta", json!(0)), ("mapId", json!("lab"))];
    bench.instant_with("initPosition", "i1", &place);
    assert_eq!(fatal(&bench), ["JSON_DESERIALIZATION_ERROR"]);
    assert_eq!(bench.status("i1"), None);
}

#[test]
fn driving_paused_new_base_request_visualization_always_false_absent_absent_none() {
    let mut bench = robot();
    bench.order(&order_with_horizon());
    bench.run(10.0);
    for state in bench.states() {
        assert!(!state.driving && state.paused.is_none() && !state.wants_base && state.velocity.is_none());
        assert!(state.position.is_some_and(|position| !position.localized));
    }
    assert!(bench.said.iter().all(|said| said.topic != TopicKind::Visualization));
}

#[test]
fn update_at_the_end_of_its_base_and_in_mid_way_stitched_rightly() {
    let mut bench = robot();
    bench.order(&order_with_horizon());
    bench.run(10.0);
    bench.order(&order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0)], 2));
    bench.run(1.0);
    bench.order(&order("o1", 2, 4, &[("n2", 6.0), ("n3", 9.0)], 2));
    // As recorded: the state after the update lists what is behind the stitching node alone.
    assert_eq!(bench.nodes_left(), ["n3"]);
    bench.run(10.0);
    assert_eq!((bench.x(), bench.errors().len()), (9.0, 0));
}

#[test]
fn broker_killed_drives_to_the_end_of_its_base_no_online_no_state() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    bench.run(1.0);
    bench.robot.robot.lose_broker();
    bench.said.clear();
    bench.run(5.0);
    bench.robot.robot.find_broker();
    bench.run(20.0);
    assert!(bench.x() == 3.0 && bench.said.is_empty());
}

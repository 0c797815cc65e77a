//! What stops and steers a robot from outside its order: pause, cancel, modes, emergency stop, position.

use super::*;
use crate::model::error::ErrorLevel;
use crate::model::state::{EStop, OperatingMode};
use crate::robot::{CancelHabit, PauseHabit};
use serde_json::json;

/// A robot at full speed on a way of 20 m with a node in the middle.
fn driving(version: Version) -> RobotBench {
    driving_as(RobotSetup::new(version, "maker", "r1", "lab", "n0"))
}

fn driving_as(setup: RobotSetup) -> RobotBench {
    let mut bench = RobotBench::new(setup);
    let mut driven = order("o1", 0, 0, &[("n0", 0.0), ("n1", 10.0), ("n2", 20.0)], 3);
    driven.nodes[2].actions = vec![hard("pick", "p1")];
    bench.order(&driven);
    bench.run(3.0);
    assert!(bench.state().driving);
    bench
}

#[test]
fn a_pause_stops_the_robot_anywhere_and_ends_with_stop_pause() {
    for version in Version::ALL {
        let mut bench = driving(version);
        bench.instant("startPause", "a1");
        assert_eq!((bench.status("a1"), bench.state().paused), (Some(ActionStatus::Running), Some(false)));
        bench.run(2.0);
        assert_eq!((bench.status("a1"), bench.state().paused), (Some(ActionStatus::Finished), Some(true)));
        let stood = bench.x();
        assert!(stood > 2.0 && stood < 6.0 && !bench.state().driving);
        bench.instant("startPause", "a2");
        assert_eq!(bench.status("a2"), Some(ActionStatus::Finished), "it is idempotent");
        bench.run(5.0);
        assert_eq!(bench.x(), stood);
        bench.instant("stopPause", "a3");
        assert_eq!((bench.status("a3"), bench.state().paused), (Some(ActionStatus::Finished), Some(false)));
        bench.run(30.0);
        assert_eq!(bench.x(), 20.0);
    }
}

#[test]
fn a_standing_robot_is_paused_within_the_same_step() {
    let mut bench = RobotBench::of_version(Version::V2_0);
    bench.instant("startPause", "a1");
    let state = bench.states().last().cloned().expect("a state");
    assert_eq!((state.paused, state.actions[0].status), (Some(true), ActionStatus::Finished));
    bench.order(&short_order("o1"));
    bench.run(5.0);
    assert_eq!((bench.x(), bench.state().order.as_str()), (0.0, "o1"), "it takes orders and does not drive");
    bench.instant("stopPause", "a2");
    bench.run(10.0);
    assert_eq!(bench.x(), 3.0);
}

#[test]
fn a_pause_interrupts_actions() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    let mut driven = short_order("o1");
    driven.nodes[0].actions = vec![hard("pick", "p1")];
    bench.order(&driven);
    bench.run(1.0);
    bench.instant("startPause", "a1");
    assert_eq!(bench.status("p1"), Some(ActionStatus::Paused));
    bench.run(10.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Paused));
    bench.instant("stopPause", "a2");
    assert_eq!(bench.status("p1"), Some(ActionStatus::Running));
    bench.run(1.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Running), "a second of three was done");
    bench.run(1.2);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Finished));
}

#[test]
fn a_robot_may_stop_at_the_next_node_only() {
    let mut setup = RobotSetup::new(Version::V2_1, "maker", "r1", "lab", "n0");
    setup.quirks.pause = PauseHabit::AtNextNode;
    setup.quirks.cancel = CancelHabit::AtNextNode;
    let mut bench = driving_as(setup.clone());
    bench.instant("startPause", "a1");
    bench.run(3.0);
    assert!(bench.state().driving && bench.state().paused == Some(false));
    bench.run(10.0);
    assert_eq!((bench.x(), bench.state().paused), (10.0, Some(true)));
    let mut bench = driving_as(setup);
    bench.instant("cancelOrder", "c1");
    bench.run(3.0);
    assert_eq!((bench.status("c1"), bench.nodes_left().len()), (Some(ActionStatus::Running), 2));
    bench.run(10.0);
    assert_eq!((bench.status("c1"), bench.nodes_left().len()), (Some(ActionStatus::Finished), 0));
    assert_eq!((bench.x(), bench.state().last_node.as_str()), (10.0, "n1"));
}

#[test]
fn a_cancelled_order_is_finished_when_the_robot_stands_and_both_ways_to_go_on_are_accepted() {
    for version in Version::ALL {
        for from_last_node in [true, false] {
            let mut bench = driving(version);
            bench.instant("cancelOrder", "c1");
            assert_eq!(bench.status("c1"), Some(ActionStatus::Running));
            assert_eq!(bench.status("p1"), Some(ActionStatus::Failed), "what was scheduled fails");
            bench.run(2.5);
            assert_eq!(bench.status("c1"), Some(ActionStatus::Finished));
            let state = bench.state();
            assert!(state.nodes.is_empty() && state.edges.is_empty() && !state.driving);
            assert_eq!((state.order.as_str(), state.last_node.as_str()), ("o1", "n0"), "both are kept");
            let start = if from_last_node { ("n0", 0.0) } else { ("~r1", bench.x()) };
            let mut next = order("o2", 0, 0, &[start, ("n1", 10.0)], 2);
            let position = next.nodes[0].position.as_mut().expect("given");
            position.deviation_m = from_last_node.then_some(8.0);
            bench.order(&next);
            bench.run(15.0);
            assert_eq!((bench.errors().len(), bench.x()), (0, 10.0));
        }
    }
}

#[test]
fn there_is_nothing_to_cancel_without_the_order_that_is_meant() {
    let kinds = ["noOrderToCancel", "noOrderToCancel", "NO_ORDER_TO_CANCEL"];
    for (version, kind) in Version::ALL.into_iter().zip(kinds) {
        let mut bench = RobotBench::of_version(version);
        bench.instant("cancelOrder", "c1");
        let error = bench.state().errors.first().cloned().expect("an error");
        assert_eq!((error.kind.as_str(), error.level), (kind, ErrorLevel::Warning));
        assert_eq!(
            (error.refers_to("actionId"), bench.status("c1")),
            (Some("c1"), Some(ActionStatus::Failed))
        );
        bench.order(&short_order("o1"));
        assert!(bench.errors().is_empty());
        bench.instant_with("cancelOrder", "c2", &[("orderId", json!("another"))]);
        assert_eq!((bench.errors(), bench.status("c2")), (vec![kind.to_owned()], Some(ActionStatus::Failed)));
        bench.run(10.0);
        assert_eq!(bench.x(), 3.0);
    }
}

#[test]
fn a_left_over_horizon_can_be_cancelled() {
    let mut bench = RobotBench::of_version(Version::V2_0);
    bench.order(&order_with_horizon());
    bench.run(10.0);
    bench.instant("cancelOrder", "c1");
    assert_eq!((bench.status("c1"), bench.nodes_left().len()), (Some(ActionStatus::Finished), 0));
    bench.order(&order("o2", 0, 0, &[("n1", 3.0), ("n0", 0.0)], 2));
    bench.run(12.0);
    assert_eq!((bench.errors().len(), bench.x()), (0, 0.0));
}

#[test]
fn a_doubled_instant_action_is_done_once() {
    let mut bench = driving(Version::V2_1);
    bench.instant("cancelOrder", "c1");
    bench.instant("cancelOrder", "c1");
    bench.run(3.0);
    bench.instant("cancelOrder", "c1");
    assert!(bench.errors().is_empty());
    let listed = bench.state().actions.iter().filter(|action| action.id == "c1").count();
    assert_eq!(listed, 1);
}

#[test]
fn a_mode_that_takes_the_robot_from_the_master_clears_the_order() {
    for (mode, node) in
        [(OperatingMode::Manual, "n0"), (OperatingMode::Service, ""), (OperatingMode::Startup, "")]
    {
        let mut bench = driving(Version::V3_0);
        bench.robot.robot.set_mode(mode);
        bench.run(0.05);
        let state = bench.states().last().cloned().expect("a state");
        assert_eq!((state.mode, state.order.as_str(), state.last_node.as_str()), (mode, "o1", node));
        assert!(state.nodes.is_empty() && state.edges.is_empty());
        assert_eq!(state.actions[0].status, ActionStatus::Failed);
        bench.instant("startCharging", "s1");
        assert_eq!(bench.status("s1"), Some(ActionStatus::Failed));
        bench.instant("stateRequest", "s2");
        assert_eq!(bench.status("s2"), Some(ActionStatus::Finished));
        let stood = bench.x();
        bench.robot.robot.set_mode(OperatingMode::Automatic);
        bench.run(5.0);
        assert_eq!(bench.x(), stood);
    }
    let mut bench = driving(Version::V2_0);
    bench.robot.robot.set_mode(OperatingMode::Intervened);
    assert_eq!(bench.state().mode, OperatingMode::Manual, "INTERVENED is of 3.0");
}

#[test]
fn an_intervened_robot_keeps_its_order_queues_updates_and_obeys_cancels_alone() {
    let mut bench = driving(Version::V3_0);
    bench.robot.robot.set_mode(OperatingMode::Intervened);
    bench.run(3.0);
    let stood = bench.x();
    assert!(bench.stands());
    assert_eq!(bench.nodes_left(), ["n1", "n2"]);
    bench.instant("startPause", "s1");
    assert_eq!(
        (bench.status("s1"), bench.errors()),
        (Some(ActionStatus::Failed), vec!["INVALID_INSTANT_ACTION".to_owned()])
    );
    let mut update = order("o1", 1, 4, &[("n2", 20.0), ("n3", 22.0)], 2);
    update.nodes[0].actions = vec![hard("pick", "p1")];
    bench.order(&update);
    bench.run(3.0);
    assert_eq!((bench.state().update, bench.x()), (1, stood));
    bench.robot.robot.set_mode(OperatingMode::Automatic);
    bench.run(30.0);
    assert_eq!(bench.x(), 22.0);
    bench.order(&order("o2", 0, 0, &[("n3", 22.0), ("n0", 0.0)], 2));
    bench.run(3.0);
    bench.robot.robot.set_mode(OperatingMode::Intervened);
    bench.instant("cancelOrder", "c1");
    bench.run(3.0);
    assert_eq!((bench.status("c1"), bench.nodes_left().len()), (Some(ActionStatus::Finished), 0));
}

#[test]
fn an_emergency_stop_and_a_protective_field_hold_the_robot_and_keep_its_order() {
    let mut bench = driving(Version::V2_1);
    bench.robot.robot.set_e_stop(EStop::Manual);
    bench.run(3.0);
    let stood = bench.x();
    let state = bench.states().last().cloned().expect("a state");
    assert_eq!((state.e_stop, state.driving, state.nodes.len()), (EStop::Manual, false, 2));
    bench.robot.robot.set_e_stop(EStop::None);
    bench.robot.robot.set_field_violation(true);
    bench.run(3.0);
    assert_eq!(bench.x(), stood);
    assert!(bench.states().last().is_some_and(|s| s.field_violation && s.e_stop == EStop::None));
    bench.robot.robot.set_field_violation(false);
    bench.run(30.0);
    assert_eq!(bench.x(), 20.0);
}

#[test]
fn a_robot_that_does_not_know_where_it_is_stands_until_a_position_is_given() {
    for (version, kind, error) in [
        (Version::V2_0, "initPosition", "localizationError"),
        (Version::V3_0, "initializePosition", "LOCALIZATION_ERROR"),
    ] {
        let mut bench = RobotBench::of_version(version);
        bench.robot.robot.set_localized(false);
        bench.order(&short_order("o1"));
        let state = bench.state();
        assert_eq!(state.errors[0].kind, error);
        assert_eq!(
            (state.errors[0].level, state.errors.len()),
            (ErrorLevel::Fatal, 2),
            "and the order is refused"
        );
        let place = [("x", json!(5.0)), ("y", json!(1)), ("theta", json!(0.5)), ("mapId", json!("hall"))];
        bench.instant_with(kind, "i1", &place[..3]);
        assert_eq!(bench.status("i1"), Some(ActionStatus::Failed), "a map is missing");
        bench.instant_with(kind, "i2", &[&place[..], &[("lastNodeId", json!("h7"))]].concat());
        assert_eq!(bench.status("i2"), Some(ActionStatus::Finished));
        bench.run(0.1);
        let state = bench.state();
        let position = state.position.expect("it says");
        assert_eq!((position.x, position.y, position.theta, position.map.as_str()), (5.0, 1.0, 0.5, "hall"));
        assert!(position.localized && state.last_node == "h7");
        assert!(!bench.errors().contains(&error.to_owned()));
    }
}

#[test]
fn an_instant_action_that_the_robot_does_not_know_fails_with_an_error() {
    let kinds = ["instantActionError", "instantActionError", "INVALID_INSTANT_ACTION"];
    for (version, kind) in Version::ALL.into_iter().zip(kinds) {
        let mut bench = RobotBench::of_version(version);
        bench.instant("juggle", "j1");
        assert_eq!((bench.status("j1"), bench.errors()), (Some(ActionStatus::Failed), vec![kind.to_owned()]));
        let is_3_0 = version >= Version::V3_0;
        bench.instant("stateRequest", "s1");
        assert_eq!(bench.errors().is_empty(), is_3_0, "since 3.0 until an instant action is accepted");
    }
}

#[test]
fn since_3_0_instant_actions_are_listed_apart_until_they_are_cleared() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.instant("stateRequest", "s1");
    bench.order(&short_order("o1"));
    let state = bench.state();
    assert!(state.actions.is_empty() && state.instant_actions.len() == 1, "an order does not clear them");
    bench.instant("clearInstantActions", "x1");
    assert_eq!((bench.status("s1"), bench.status("x1")), (None, Some(ActionStatus::Finished)));
    let mut bench = RobotBench::of_version(Version::V2_1);
    bench.instant("stateRequest", "s1");
    assert_eq!(bench.state().actions.len(), 1, "before 3.0 in one list");
    bench.order(&short_order("o1"));
    assert_eq!(bench.state().actions.len(), 0);
}

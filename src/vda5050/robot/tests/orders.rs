//! Orders that are driven: base, horizon, updates, what is reported on the way and when.

use super::*;
use crate::model::state::NodeLeft;
use crate::robot::EqualUpdate;

#[test]
fn an_order_is_driven_from_start_to_end_in_each_version() {
    for version in Version::ALL {
        let mut bench = RobotBench::of_version(version);
        bench.order(&order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 3));
        let state = bench.states().last().cloned().expect("a state on the order");
        assert_eq!((state.order.as_str(), state.last_node.as_str(), state.last_sequence), ("o1", "n0", 0));
        assert_eq!(bench.nodes_left(), ["n1", "n2"], "the first node is not reported");
        bench.run(2.5);
        assert!(bench.state().driving && bench.state().last_node == "n0", "{version}");
        bench.run(5.0);
        let state = bench.states().last().cloned().expect("a state at the end");
        assert_eq!((state.last_node.as_str(), state.last_sequence), ("n2", 4));
        assert!(
            state.nodes.is_empty() && state.edges.is_empty() && !state.driving && state.errors.is_empty()
        );
        assert_eq!(bench.x(), 6.0);
        let passed: Vec<u32> = bench.states().iter().map(|s| s.last_sequence).collect();
        assert!(passed.is_sorted() && passed.contains(&2), "{passed:?}");
    }
}

#[test]
fn the_robot_stops_at_the_last_released_node_asks_for_more_and_is_not_idle() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.order(&order_with_horizon());
    bench.run(1.0);
    assert!(!bench.state().wants_base, "there is way enough yet");
    bench.run(1.5);
    assert!(bench.state().wants_base && bench.state().driving, "it will brake soon");
    bench.run(20.0);
    assert_eq!(bench.x(), 3.0);
    assert!(bench.state().wants_base && !bench.state().driving);
    let left = NodeLeft { id: "n2".to_owned(), sequence: 4, released: false };
    assert_eq!(bench.state().nodes, [left]);
    bench.order(&order("o2", 0, 0, &[("n1", 3.0), ("n0", 0.0)], 2));
    assert_eq!(bench.errors(), ["OTHER_ORDER_ACTIVE"]);
}

#[test]
fn an_update_in_mid_way_is_stitched_without_a_stop_and_replaces_the_horizon() {
    for version in Version::ALL {
        let mut bench = RobotBench::of_version(version);
        bench.order(&order_with_horizon());
        bench.run(1.5);
        let mut update = order("o1", 1, 2, &[("n1", 3.0), ("m2", 5.0), ("m3", 9.0)], 3);
        update.nodes[2].actions = vec![hard("drop", "d1")];
        bench.order(&update);
        assert_eq!(bench.nodes_left(), ["n1", "m2", "m3"], "the base stays, the horizon goes");
        assert_eq!(bench.state().update, 1);
        assert_eq!(bench.status("d1"), Some(ActionStatus::Waiting));
        let mut slowest = f64::INFINITY;
        while bench.x() < 5.0 {
            bench.run(0.05);
            slowest = slowest.min(bench.state().velocity.expect("it says").vx);
        }
        assert!(slowest > 0.8, "it did not brake at n1: {slowest}");
        bench.run(20.0);
        assert_eq!((bench.x(), bench.state().last_sequence), (9.0, 6));
        // A finished order goes on where it ended.
        bench.order(&order("o1", 2, 6, &[("m3", 9.0), ("m4", 11.0)], 2));
        if version >= Version::V3_0 {
            assert_eq!(bench.errors(), ["VALIDATION_FAILURE"], "the actions of m3 were not sent again");
        } else {
            bench.run(10.0);
            assert_eq!(bench.x(), 11.0);
        }
    }
}

#[test]
fn the_actions_of_the_stitching_node_are_not_done_again() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    let mut first = short_order("o1");
    first.nodes[1].actions = vec![hard("pick", "p1")];
    bench.order(&first);
    bench.run(12.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Finished));
    let mut update = order("o1", 1, 2, &[("n1", 3.0), ("n1", 3.0), ("n2", 6.0)], 3);
    update.nodes[0].actions = vec![hard("pick", "p1")];
    update.nodes[1].actions = vec![hard("drop", "d1")];
    bench.order(&update);
    bench.run(12.0);
    let state = bench.state();
    assert_eq!(state.actions.len(), 2, "{:?}", state.actions);
    assert_eq!(bench.status("d1"), Some(ActionStatus::Finished), "new actions where it stands");
    assert_eq!((state.loads.map(|l| l.len()), bench.x()), (Some(0), 6.0));
}

#[test]
fn a_repetition_is_ignored_and_answered_with_a_state() {
    for version in Version::ALL {
        let mut bench = RobotBench::of_version(version);
        assert_eq!(bench.robot.robot.setup().quirks.equal_update, EqualUpdate::ByVersion);
        bench.order(&short_order("o1"));
        bench.run(1.0);
        let before = bench.states().len();
        bench.order(&short_order("o1"));
        assert_eq!(bench.states().len(), before + 1);
        assert!(bench.errors().is_empty());
        bench.run(10.0);
        assert_eq!(bench.x(), 3.0);
    }
}

#[test]
fn actions_follow_their_blocking_types() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    let mut driven = order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 9.0)], 3);
    let soft = |id: &str| Action { blocking: BlockingType::Soft, ..action("detectObject", id) };
    let single = Action { blocking: BlockingType::Single, ..action("detectObject", "c") };
    driven.nodes[0].actions = vec![soft("a"), soft("b"), hard("detectObject", "h")];
    driven.nodes[1].actions = vec![action("detectObject", "n"), single];
    bench.order(&driven);
    let is = |bench: &RobotBench, id: &str, status| assert_eq!(bench.status(id), Some(status), "{id}");
    is(&bench, "a", ActionStatus::Running);
    is(&bench, "b", ActionStatus::Running);
    is(&bench, "h", ActionStatus::Waiting);
    bench.run(1.5);
    is(&bench, "a", ActionStatus::Finished);
    is(&bench, "h", ActionStatus::Running);
    assert!(bench.stands() && bench.x() == 0.0, "SOFT and HARD keep it standing");
    bench.run(0.8);
    assert!(bench.x() > 0.0);
    while bench.x() < 3.0 {
        bench.run(0.05);
    }
    bench.run(0.1);
    is(&bench, "n", ActionStatus::Running);
    is(&bench, "c", ActionStatus::Waiting);
    bench.run(1.0);
    is(&bench, "c", ActionStatus::Running);
    assert!(!bench.stands(), "NONE and SINGLE let it drive");
}

#[test]
fn actions_of_an_edge_end_with_the_edge() {
    let mut bench = RobotBench::of_version(Version::V2_1);
    let mut driven = order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 3);
    driven.edges[0].actions = vec![hard("finePositioning", "f")];
    driven.edges[1].actions = vec![Action { blocking: BlockingType::None, ..action("detectObject", "e") }];
    let mut setup = RobotSetup::new(Version::V2_1, "maker", "r1", "lab", "n0");
    setup.abilities.other_action_us = 60_000_000;
    bench.order(&driven);
    bench.run(0.5);
    assert_eq!((bench.status("f"), bench.x()), (Some(ActionStatus::Running), 0.0));
    bench.run(20.0);
    assert_eq!(bench.status("e"), Some(ActionStatus::Finished));
    let mut bench = RobotBench::new(setup);
    driven.edges[0].actions.clear();
    bench.order(&driven);
    while bench.x() < 4.0 {
        bench.run(0.05);
    }
    assert_eq!(bench.status("e"), Some(ActionStatus::Running));
    bench.run(10.0);
    assert_eq!(bench.status("e"), Some(ActionStatus::Finished), "a minute's action ends with its edge");
}

#[test]
fn a_state_comes_on_events_and_every_thirty_seconds_and_a_visualization_every_second() {
    let mut bench = RobotBench::of_version(Version::V2_0);
    assert_eq!(bench.states().len(), 1);
    bench.run(29.0);
    assert_eq!(bench.states().len(), 1);
    bench.run(62.0);
    assert_eq!(bench.states().len(), 4);
    let visualizations = bench.said.iter().filter(|said| matches!(said.message, Message::Visualization(_)));
    assert_eq!(visualizations.count(), 91);
    for said in &bench.said {
        let kind = crate::TopicKind::State;
        assert_eq!(said.topic == kind, matches!(said.message, Message::State(_)));
        assert!(said.topic.is_from_robot());
    }
}

#[test]
fn a_node_without_a_position_is_reached_if_the_robot_knows_its_name() {
    let mut setup = RobotSetup::new(Version::V3_0, "maker", "r1", "lab", "n0");
    setup.places = [("n1".to_owned(), (2.0, 0.0))].into();
    let mut bench = RobotBench::new(setup);
    let mut driven = order("o1", 0, 0, &[("n0", 0.0), ("n1", 0.0), ("n2", 0.0)], 3);
    driven.nodes.iter_mut().for_each(|node| node.position = None);
    bench.order(&driven);
    assert_eq!(bench.errors(), ["NO_ROUTE_TO_TARGET"]);
    driven.nodes.pop();
    driven.edges.pop();
    bench.order(&driven);
    bench.run(10.0);
    assert_eq!((bench.x(), bench.errors().len()), (2.0, 0));
}

#[test]
fn the_first_node_counts_as_reached_within_the_deviation_that_it_allows() {
    for version in Version::ALL {
        let mut bench = RobotBench::of_version(version);
        let mut driven = order("o1", 0, 0, &[("t", 0.8), ("n1", 3.0)], 2);
        bench.order(&driven);
        assert_eq!(bench.state().order, "");
        driven.nodes[0].position.as_mut().expect("given").deviation_m = Some(1.0);
        bench.order(&driven);
        assert_eq!(bench.state().last_node, "t");
        assert!(bench.errors().is_empty(), "an accepted order clears the error of the refused one");
        bench.run(10.0);
        assert_eq!(bench.x(), 3.0);
    }
}

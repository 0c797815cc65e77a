//! Each rejection of the standard: the version's own type and level, the references, and that nothing changes.

use super::*;
use crate::model::error::ErrorLevel;
use crate::model::factsheet::Factsheet;
use crate::model::state::OperatingMode;

/// A robot in mid-way of [`order_with_horizon`], at update 1.
fn busy(version: Version) -> RobotBench {
    let mut bench = RobotBench::of_version(version);
    bench.order(&order_with_horizon());
    bench.order(&order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0), ("n3", 9.0)], 2));
    bench.run(1.0);
    assert!(bench.errors().is_empty() && bench.state().update == 1);
    bench
}

/// Sends an order that must be rejected with the types of 2.0, 2.1 and 3.0, and checks that nothing else changes.
fn check(made: impl Fn(Version) -> RobotBench, rejected: &Order, kinds: [&str; 3]) {
    for (version, kind) in Version::ALL.into_iter().zip(kinds) {
        let mut bench = made(version);
        let before = bench.state();
        bench.order(rejected);
        let after = bench.state();
        assert_eq!(bench.errors(), [kind], "{version} {rejected:?}");
        let error = &after.errors[0];
        assert_eq!(error.level, ErrorLevel::Warning);
        assert_eq!(error.refers_to("orderId"), Some(rejected.id.as_str()));
        assert_eq!(error.refers_to("orderUpdateId"), Some(rejected.update.to_string().as_str()));
        assert_eq!((after.order, after.update, after.nodes), (before.order, before.update, before.nodes));
        assert_eq!(after.actions, before.actions);
        assert_eq!(bench.states().last().map(|s| s.errors.len()), Some(1), "it is said at once");
        bench.order(rejected);
        assert_eq!(bench.errors().len(), 1, "and not piled up");
    }
}

const MALFORMED: [&str; 3] = ["validationError", "validationError", "VALIDATION_FAILURE"];
const UPDATE: [&str; 2] = ["orderUpdateError", "orderUpdateError"];

#[test]
fn a_malformed_order_is_rejected() {
    let sound = order("o2", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 2);
    let broken: [fn(&mut Order); 16] = [
        |o| o.nodes.clear(),
        |o| o.id.clear(),
        |o| drop(o.edges.pop()),
        |o| o.nodes[0].released = false,
        |o| o.nodes[1].released = false,
        |o| o.edges[1].released = true,
        |o| o.nodes[2].released = true,
        |o| o.nodes[2].sequence = 6,
        |o| o.edges[0].sequence = 2,
        |o| o.edges[0].to = "n2".to_owned(),
        |o| o.edges[0].max_speed_mps = Some(0.0),
        |o| o.edges[0].max_speed_mps = Some(f64::NAN),
        |o| o.nodes[1].position.as_mut().expect("given").x = f64::INFINITY,
        |o| o.nodes[1].actions = vec![action("pick", "same"), action("drop", "same")],
        |o| o.nodes[1].actions = vec![action("pick", "")],
        |o| o.nodes[1].id.clear(),
    ];
    for break_it in broken {
        let mut order = sound.clone();
        break_it(&mut order);
        check(RobotBench::of_version, &order, MALFORMED);
    }
    let mut endless = sound;
    endless.nodes[0].sequence = u32::MAX - 1;
    check(RobotBench::of_version, &endless, MALFORMED);
}

#[test]
fn an_order_beyond_the_limits_of_the_factsheet_is_rejected() {
    let limited = |version| {
        let mut setup = RobotSetup::new(version, "maker", "r1", "lab", "n0");
        setup.factsheet =
            Some(Factsheet { most_nodes: Some(2), longest_id: Some(5), ..Factsheet::default() });
        RobotBench::new(setup)
    };
    check(limited, &order("o2", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 2), MALFORMED);
    check(limited, &order("long-id", 0, 0, &[("n0", 0.0)], 1), MALFORMED);
}

#[test]
fn an_order_with_an_action_that_the_robot_cannot_do_is_rejected_whole() {
    let kinds = ["orderError", "orderError", "INVALID_ORDER_ACTION"];
    let mut unknown = short_order("o2");
    unknown.nodes[1].actions = vec![hard("juggle", "j1")];
    check(RobotBench::of_version, &unknown, kinds);
    let mut misplaced = short_order("o2");
    misplaced.edges[0].actions = vec![action("startCharging", "s1")];
    check(RobotBench::of_version, &misplaced, kinds);
    let mut bench = RobotBench::of_version(Version::V2_0);
    bench.order(&unknown);
    assert_eq!(bench.state().errors[0].refers_to("actionId"), Some("j1"));
}

#[test]
fn a_lower_number_is_rejected_and_the_order_goes_on() {
    check(busy, &order_with_horizon(), [UPDATE[0], UPDATE[1], "OUTDATED_ORDER_UPDATE"]);
    let mut bench = busy(Version::V3_0);
    bench.order(&order_with_horizon());
    bench.run(20.0);
    assert_eq!(bench.x(), 6.0);
}

#[test]
fn the_same_number_with_other_content_is_an_error_since_3_0_and_ignored_before() {
    let other = order("o1", 1, 2, &[("n1", 3.0), ("elsewhere", 5.0)], 2);
    for (version, errors) in Version::ALL.into_iter().zip([&[][..], &[], &["SAME_ORDER_UPDATE_ID"]]) {
        let mut bench = busy(version);
        bench.order(&other);
        assert_eq!(bench.errors(), errors);
        assert!(!bench.nodes_left().contains(&"elsewhere".to_owned()));
    }
}

#[test]
fn another_order_while_one_is_active_is_rejected() {
    let other = order("o2", 0, 0, &[("n0", 0.0), ("n1", 3.0)], 2);
    check(busy, &other, ["orderError", "orderError", "OTHER_ORDER_ACTIVE"]);
}

#[test]
fn an_update_that_does_not_begin_at_the_last_released_node_is_rejected() {
    let kinds = [UPDATE[0], UPDATE[1], "VALIDATION_FAILURE"];
    check(busy, &order("o1", 2, 2, &[("n1", 3.0), ("n2", 6.0)], 2), kinds);
    check(busy, &order("o1", 2, 4, &[("n1", 6.0), ("n3", 9.0)], 2), kinds);
    check(busy, &order("o1", 2, 6, &[("n3", 9.0), ("n4", 12.0)], 2), kinds);
    // Since 3.0 the node must be sent again as it was.
    let mut changed = order("o1", 2, 4, &[("n2", 6.0), ("n3", 9.0)], 2);
    changed.nodes[0].actions = vec![hard("pick", "p1")];
    let mut bench = busy(Version::V3_0);
    bench.order(&changed);
    assert_eq!(bench.errors(), ["VALIDATION_FAILURE"]);
    let mut bench = busy(Version::V2_1);
    bench.order(&changed);
    assert_eq!((bench.errors().len(), bench.status("p1")), (0, None), "what it knew of the node holds");
}

#[test]
fn a_new_order_begins_with_the_numbers_zero() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.order(&Order { update: 3, ..short_order("o1") });
    assert_eq!(bench.errors(), ["VALIDATION_FAILURE"]);
    let late = order("o1", 1, 2, &[("n0", 0.0), ("n1", 3.0)], 2);
    check(RobotBench::of_version, &late, MALFORMED);
}

#[test]
fn an_order_that_starts_far_away_is_rejected() {
    let far = order("o2", 0, 0, &[("n1", 3.0), ("n0", 0.0)], 2);
    let kinds = ["noRouteError", "noRouteError", "START_NODE_OUT_OF_RANGE"];
    check(RobotBench::of_version, &far, kinds);
    let mut turned = short_order("o2");
    let position = turned.nodes[0].position.as_mut().expect("given");
    (position.theta, position.deviation_rad) = (Some(2.0), Some(0.3));
    check(RobotBench::of_version, &turned, kinds);
}

#[test]
fn an_order_to_where_no_way_leads_is_rejected() {
    let mut beyond = short_order("o2");
    beyond.nodes[1].position.as_mut().expect("given").x = 1e9;
    let kinds = ["noRouteError", "noRouteError", "NO_ROUTE_TO_TARGET"];
    check(RobotBench::of_version, &beyond, kinds);
    let mut unknown = short_order("o2");
    unknown.nodes[1].position.as_mut().expect("given").map = "cellar".to_owned();
    check(RobotBench::of_version, &unknown, ["orderError", "orderError", "UNKNOWN_MAP_ID"]);
}

#[test]
fn an_order_in_a_mode_that_allows_none_is_rejected_until_the_mode_does() {
    let manual = |version| {
        let mut bench = RobotBench::of_version(version);
        bench.robot.robot.set_mode(OperatingMode::Manual);
        bench.run(0.1);
        bench
    };
    check(manual, &short_order("o2"), ["orderError", "orderError", "MOBILE_ROBOT_NOT_AVAILABLE"]);
    let mut bench = manual(Version::V3_0);
    bench.order(&short_order("o2"));
    bench.robot.robot.set_mode(OperatingMode::Automatic);
    assert!(bench.errors().is_empty());
    bench.order(&short_order("o2"));
    bench.run(10.0);
    assert_eq!(bench.x(), 3.0);
}

#[test]
fn an_update_of_a_cancelled_order_is_rejected() {
    let cancelled = |version| {
        let mut bench = busy(version);
        bench.instant("cancelOrder", "c1");
        bench.run(3.0);
        assert_eq!(bench.status("c1"), Some(ActionStatus::Finished));
        bench
    };
    let update = order("o1", 2, 4, &[("n2", 6.0), ("n3", 9.0)], 2);
    check(cancelled, &update, [UPDATE[0], UPDATE[1], "ORDER_UPDATE_FOLLOWING_CANCEL"]);
}

#[test]
fn a_message_that_cannot_be_read_is_a_warning() {
    for (version, kind) in Version::ALL.into_iter().zip(MALFORMED) {
        let mut bench = RobotBench::of_version(version);
        bench.robot.robot.receive_unreadable(crate::TopicKind::Order, crate::robot::GarbledMessage::NotJson);
        bench.run(0.1);
        let state = bench.states().last().cloned().expect("a state");
        assert_eq!((state.errors[0].kind.as_str(), state.errors[0].level), (kind, ErrorLevel::Warning));
        bench.order(&short_order("o1"));
        assert!(bench.errors().is_empty(), "until an order is accepted");
    }
}

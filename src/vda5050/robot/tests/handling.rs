//! Actions with an effect: pick and drop, charging, triggers, retries.

use super::*;
use crate::model::state::Load;
use crate::robot::ChargingPlaces;
use serde_json::json;

#[test]
fn pick_and_drop_take_their_time_and_change_the_load() {
    for version in Version::ALL {
        let mut bench = RobotBench::of_version(version);
        let mut driven = order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 3);
        let named = [("loadId", json!("K4")), ("loadType", json!("EPAL"))];
        driven.nodes[1].actions = vec![with(hard("pick", "p1"), &named)];
        driven.nodes[2].actions = vec![hard("drop", "d1")];
        bench.order(&driven);
        while bench.status("p1") == Some(ActionStatus::Waiting) {
            bench.run(0.05);
        }
        assert_eq!((bench.x(), bench.stands()), (3.0, true), "it stops for a HARD action");
        bench.run(2.9);
        assert_eq!(bench.status("p1"), Some(ActionStatus::Running));
        assert_eq!(bench.state().loads, Some(Vec::new()));
        bench.run(0.2);
        assert_eq!(bench.status("p1"), Some(ActionStatus::Finished));
        let load = Load { id: Some("K4".to_owned()), kind: Some("EPAL".to_owned()) };
        assert_eq!(bench.states().last().and_then(|s| s.loads.clone()), Some(vec![load]));
        bench.run(10.0);
        assert_eq!((bench.x(), bench.status("d1")), (6.0, Some(ActionStatus::Finished)));
        assert_eq!(bench.state().loads, Some(Vec::new()));
    }
}

#[test]
fn a_pick_with_a_load_and_a_drop_without_one_fail_and_the_order_goes_on() {
    let mut bench = RobotBench::of_version(Version::V2_1);
    bench.robot.robot.set_loads(vec![Load { id: None, kind: None }]);
    let mut driven = order("o1", 0, 0, &[("n0", 0.0), ("n1", 1.0), ("n2", 2.0)], 3);
    driven.nodes[0].actions = vec![hard("pick", "p1"), hard("drop", "d1"), hard("drop", "d2")];
    bench.order(&driven);
    bench.run(20.0);
    let statuses = ["p1", "d1", "d2"].map(|id| bench.status(id));
    assert_eq!(statuses, [ActionStatus::Failed, ActionStatus::Finished, ActionStatus::Failed].map(Some));
    assert_eq!(bench.x(), 2.0);
}

#[test]
fn since_3_0_a_retriable_action_waits_for_a_decision() {
    let mut retried = short_order("o1");
    retried.nodes[0].actions = vec![Action { retriable: true, ..hard("pick", "p1") }];
    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.robot.robot.set_handling_fault(true);
    bench.order(&retried);
    bench.run(20.0);
    assert_eq!((bench.status("p1"), bench.x()), (Some(ActionStatus::Retriable), 0.0));
    bench.robot.robot.set_handling_fault(false);
    bench.instant_with("retry", "r0", &[("actionId", json!("another"))]);
    assert_eq!(bench.status("r0"), Some(ActionStatus::Failed));
    bench.instant_with("retry", "r1", &[("actionId", json!("p1"))]);
    assert_eq!(
        (bench.status("r1"), bench.status("p1")),
        (Some(ActionStatus::Finished), Some(ActionStatus::Running))
    );
    bench.run(10.0);
    assert_eq!((bench.status("p1"), bench.x()), (Some(ActionStatus::Finished), 3.0));

    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.robot.robot.set_handling_fault(true);
    bench.order(&retried);
    bench.run(5.0);
    bench.instant_with("skipRetry", "r1", &[("actionId", json!("p1"))]);
    bench.run(10.0);
    assert_eq!((bench.status("p1"), bench.x()), (Some(ActionStatus::Failed), 3.0));

    let mut bench = RobotBench::of_version(Version::V2_1);
    bench.robot.robot.set_handling_fault(true);
    bench.order(&retried);
    bench.run(5.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Failed), "before 3.0 there is no retry");
}

#[test]
fn charging_begins_and_ends_by_instant_action_and_by_order() {
    for version in Version::ALL {
        let mut setup = RobotSetup::new(version, "maker", "r1", "lab", "n0");
        setup.abilities.charging_places = ChargingPlaces::Nodes(vec!["n1".to_owned()]);
        setup.abilities.charge_per_s = 0.01;
        let mut bench = RobotBench::new(setup);
        bench.robot.robot.set_charge(0.5);
        bench.instant("startCharging", "s1");
        assert_eq!((bench.status("s1"), bench.state().power.charging), (Some(ActionStatus::Failed), false));
        let mut driven = short_order("o1");
        driven.nodes[1].actions = vec![hard("startCharging", "s2")];
        bench.order(&driven);
        bench.run(6.0);
        assert_eq!((bench.status("s2"), bench.state().power.charging), (Some(ActionStatus::Finished), true));
        let before = bench.state().power.charge.unwrap();
        bench.run(10.0);
        assert!((bench.state().power.charge.unwrap() - before - 0.1).abs() < 0.01);
        bench.instant("stopCharging", "s3");
        assert_eq!(bench.states().last().map(|s| s.power.charging), Some(false));
        bench.instant("startCharging", "s4");
        assert!(bench.state().power.charging);
        bench.run(100.0);
        assert_eq!(
            (bench.state().power.charge, bench.state().power.charging),
            (Some(1.0), false),
            "it stops when full"
        );
        bench.instant("startCharging", "s5");
        bench.order(&order("o2", 0, 0, &[("n1", 3.0), ("n0", 0.0)], 2));
        bench.run(1.0);
        assert!(!bench.state().power.charging, "driving off ends it");
    }
}

#[test]
fn a_robot_that_waits_for_a_trigger_goes_on_by_the_master_since_3_0_or_by_its_own_button() {
    let mut waiting = short_order("o1");
    waiting.nodes[0].actions = vec![hard("waitForTrigger", "w1")];
    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.instant("trigger", "t0");
    assert_eq!(bench.status("t0"), Some(ActionStatus::Failed), "nothing waits");
    bench.order(&waiting);
    bench.run(60.0);
    assert_eq!((bench.status("w1"), bench.x()), (Some(ActionStatus::Running), 0.0));
    bench.instant("trigger", "t1");
    bench.run(10.0);
    assert_eq!(
        (bench.status("t1"), bench.status("w1")),
        (Some(ActionStatus::Finished), Some(ActionStatus::Finished))
    );
    assert_eq!(bench.x(), 3.0);

    let mut bench = RobotBench::of_version(Version::V2_1);
    bench.order(&waiting);
    bench.instant("trigger", "t1");
    assert_eq!(bench.status("t1"), Some(ActionStatus::Failed), "the master's trigger is of 3.0");
    bench.robot.robot.press_trigger();
    bench.run(10.0);
    assert_eq!(bench.x(), 3.0);
}

#[test]
fn actions_of_the_horizon_wait_and_go_with_it() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    let mut driven = order_with_horizon();
    driven.nodes[2].actions = vec![hard("pick", "p1")];
    bench.order(&driven);
    bench.run(20.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Waiting));
    bench.order(&order("o1", 1, 2, &[("n1", 3.0), ("m2", 4.0)], 2));
    assert_eq!(bench.status("p1"), None);
}

#[test]
fn an_edge_s_speed_limit_is_heeded() {
    let mut bench = RobotBench::of_version(Version::V2_0);
    let mut driven = short_order("o1");
    driven.edges[0].max_speed_mps = Some(0.4);
    bench.order(&driven);
    bench.run(20.0);
    let speeds = bench.said.iter().filter_map(|said| match &said.message {
        Message::Visualization(seen) => seen.velocity.map(|v| v.vx),
        _ => None,
    });
    let top = speeds.fold(0.0, f64::max);
    assert!(top > 0.35 && top <= 0.4, "{top}");
}

//! The connection: ONLINE, OFFLINE, the will, losses of the broker, reboots, the factsheet.

use super::*;
use crate::TopicKind;
use crate::model::state::{Load, Position};
use crate::robot::VirtualRobot;

#[test]
fn a_robot_says_online_then_its_factsheet_and_a_state_and_takes_leave_with_offline() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    let topics: Vec<TopicKind> = bench.said.iter().map(|said| said.topic).collect();
    assert_eq!(topics, [TopicKind::Connection, TopicKind::Factsheet, TopicKind::State]);
    assert_eq!(bench.connections(), [ConnectionState::Online]);
    let will = VirtualRobot::will();
    assert_eq!(will.message, Message::Connection(ConnectionState::Broken));
    bench.robot.robot.leave();
    bench.run(0.05);
    assert_eq!(
        bench.said.last().map(|said| &said.message),
        Some(&Message::Connection(ConnectionState::Offline))
    );
    let said = bench.said.len();
    bench.order(&short_order("o1"));
    bench.run(60.0);
    assert_eq!((bench.said.len(), bench.x()), (said, 0.0));
}

#[test]
fn the_factsheet_comes_when_asked() {
    let mut bench = RobotBench::of_version(Version::V2_0);
    bench.said.clear();
    bench.instant("factsheetRequest", "f1");
    let topics: Vec<TopicKind> = bench.said.iter().map(|said| said.topic).collect();
    assert_eq!(topics, [TopicKind::Factsheet, TopicKind::State]);
    assert_eq!(bench.status("f1"), Some(ActionStatus::Finished));
}

#[test]
fn a_robot_that_lost_the_broker_drives_to_the_end_of_its_base_and_comes_back_with_online_and_a_state() {
    let mut bench = RobotBench::of_version(Version::V2_1);
    bench.order(&order_with_horizon());
    bench.run(1.0);
    bench.robot.robot.lose_broker();
    assert!(!bench.robot.robot.is_online());
    bench.said.clear();
    bench.run(60.0);
    bench.order(&order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0)], 2));
    bench.run(10.0);
    assert_eq!((bench.x(), bench.said.len()), (3.0, 0));
    bench.robot.robot.find_broker();
    bench.run(0.05);
    assert_eq!(bench.connections(), [ConnectionState::Online]);
    assert_eq!(bench.states().last().map(|s| s.last_sequence), Some(2));
}

#[test]
fn a_robot_that_is_switched_on_without_a_broker_says_online_when_there_is_one() {
    for setup in [RobotSetup::like_a(), RobotSetup::like_b(), RobotSetup::like_c()] {
        let mut bench = RobotBench { robot: EmbodiedRobot::new(setup), now_us: 0, said: Vec::new() };
        bench.robot.robot.lose_broker();
        bench.run(60.0);
        assert!(bench.said.is_empty());
        bench.robot.robot.find_broker();
        bench.run(0.1);
        assert_eq!(bench.connections(), [ConnectionState::Online]);
    }
}

#[test]
fn a_rebooted_robot_has_forgotten_everything_and_may_stand_elsewhere() {
    let mut bench = RobotBench::of_version(Version::V2_0);
    bench.robot.robot.set_loads(vec![Load { id: None, kind: None }]);
    bench.order(&order_with_horizon());
    bench.instant("startPause", "a1");
    bench.run(1.0);
    bench.said.clear();
    let elsewhere = Position { x: 7.0, y: 0.0, theta: 0.0, map: "lab".to_owned(), localized: true };
    bench.robot.robot.reboot(elsewhere, "n7");
    bench.run(0.05);
    assert_eq!(bench.connections(), [ConnectionState::Online]);
    let state = bench.states().last().cloned().expect("a state");
    assert_eq!((state.order.as_str(), state.update, state.last_node.as_str()), ("", 0, "n7"));
    assert!(state.nodes.is_empty() && state.actions.is_empty() && state.paused == Some(false));
    assert_eq!((state.position.expect("it says").x, state.loads), (7.0, Some(Vec::new())));
    bench.order(&order("o1", 0, 0, &[("n7", 7.0), ("n1", 3.0)], 2));
    bench.run(15.0);
    assert_eq!((bench.x(), bench.errors().len()), (3.0, 0));
}

#[test]
fn the_same_calls_give_the_same_answers() {
    let run = || {
        let mut bench = RobotBench::of_version(Version::V3_0);
        bench.order(&order_with_horizon());
        bench.run(2.0);
        bench.instant("startPause", "a1");
        bench.run(3.0);
        bench.said
    };
    assert_eq!(run(), run());
}

//! The published reaction to a worker who left the path: its branches, one by one.

use super::people::Puppet;
use super::*;
use crate::aware::Arm;
use crate::geometry::Point;

const NEVER: Time = Time::MAX;

fn at(floor: &Floor, x: f64, y: f64) -> NodeId {
    let w = floor.fleet.warehouse();
    w.nodes.pairs().find(|(_, n)| (n.at - Point::new(x, y)).norm() < 0.1).expect("the hall has it").0
}

fn hall(arm: Arm, robots: usize) -> Floor {
    Floor::new(thesis(), &Scenario { arm, ..scenario(robots) })
}

/// Sends a robot somewhere and breaks it there.
fn break_at(floor: &mut Floor, robot: u32, x: f64, y: f64) {
    let (robot, node) = (RobotId(robot), at(floor, x, y));
    floor.submit(request(JobKind::Go { robot, node }));
    for _ in 0..3000 {
        floor.step(vec![]);
        let place = floor.world.truth().find(|(r, _)| *r == robot).expect("it is there").1.pose.at;
        if (place - Point::new(x, y)).norm() < 0.3 {
            floor.world.fail(robot, NEVER);
            floor.run(3);
            return;
        }
    }
    panic!("the robot did not get there");
}

/// Somebody on the way from the south of the second aisle to its north.
fn worker(floor: &mut Floor) -> Puppet {
    let ana = floor.hire(Point::new(3.0, 0.2));
    let place = at(floor, 3.0, 12.0);
    floor.assign(&ana, place, 5);
    ana
}

fn told(floor: &mut Floor, puppet: &mut Puppet, steps: usize) -> Vec<GuidanceState> {
    let mut states = Vec::new();
    for _ in 0..steps {
        let step = floor.walk(puppet);
        states.extend(step.guidance.iter().map(|(_, g)| g.state));
    }
    states
}

#[test]
fn all_robots_are_interrupted_and_go_on_when_somebody_leaves_the_path() {
    let mut floor = hall(Arm::Phir, 8);
    floor.submit_batch(20);
    floor.run(5);
    let mut ana = worker(&mut floor);
    (ana.own, ana.way) = (true, vec![Point::new(0.0, 0.0), Point::new(0.0, 2.0)]);
    let before = floor.facts.len();
    told(&mut floor, &mut ana, 50);
    let interrupted = floor.facts[before..].iter().filter(|f| matches!(f, Fact::Interrupted { .. })).count();
    assert!(floor.deviations() > 0, "{:?}, waited {} s", ana.at, ana.waited_s);
    assert!(interrupted >= 3, "{interrupted} robots");
    let served = floor.fleet.ledger().counts.robot_deliveries;
    told(&mut floor, &mut ana, 900);
    assert!(floor.fleet.ledger().counts.robot_deliveries > served, "they go on");
}

#[test]
fn without_prediction_nobody_reacts_before_a_robot_is_near() {
    let mut floor = hall(Arm::Nhir, 4);
    let mut ana = worker(&mut floor);
    told(&mut floor, &mut ana, 10);
    (ana.own, ana.way) = (true, vec![Point::new(3.0, 0.0), Point::new(12.0, 0.0)]);
    let version = |f: &Floor| f.fleet.view(f.now).workers[0].guidance.version;
    let before = version(&floor);
    told(&mut floor, &mut ana, 60);
    assert!(floor.deviations() > 0, "it is noticed");
    assert_eq!(version(&floor), before, "but no robot is near, and nothing is planned");
}

#[test]
fn a_robot_that_stands_on_the_way_is_walked_round() {
    let mut floor = hall(Arm::Nhir, 2);
    break_at(&mut floor, 0, 3.0, 4.0);
    let mut ana = worker(&mut floor);
    told(&mut floor, &mut ana, 3);
    // She was led another way, but takes the aisle where the robot stands.
    (ana.own, ana.way) = (true, vec![Point::new(3.0, 3.1)]);
    let states = told(&mut floor, &mut ana, 120);
    assert!(states.contains(&GuidanceState::Deviating), "{states:?}");
    assert!(states.contains(&GuidanceState::Redirected), "{states:?}");
    let path = floor.fleet.view(floor.now).workers[0].guidance.path.clone();
    assert!(path.iter().all(|p| (p - Point::new(3.0, 4.0)).norm() > 0.6), "{path:?}");
}

#[test]
fn who_is_shut_in_between_robots_that_cannot_move_is_told_to_stop() {
    let mut floor = hall(Arm::Nhir, 2);
    break_at(&mut floor, 0, 3.0, 5.0);
    let mut ana = worker(&mut floor);
    (ana.own, ana.way) = (true, vec![Point::new(3.0, 3.7)]);
    told(&mut floor, &mut ana, 40);
    break_at_while(&mut floor, &mut ana, 1, 3.0, 1.0);
    let states = told(&mut floor, &mut ana, 150);
    let mut words: Vec<&str> = states.iter().map(|s| s.word()).collect();
    words.dedup();
    assert!(words.contains(&"stop"), "{words:?}");
}

/// [`break_at`] while somebody is on the floor, whom the robot must not be afraid of: she is cleared for the
/// time.
fn break_at_while(floor: &mut Floor, puppet: &mut Puppet, robot: u32, x: f64, y: f64) {
    floor.step(vec![Input::Clear { token: 9, worker: puppet.worker }]);
    break_at(floor, robot, x, y);
    let place = puppet.at;
    // She comes back a little to the side of her path, which starts anew where she is.
    (puppet.own, puppet.way) = (true, vec![place, Point::new(3.0, 3.2), place]);
}

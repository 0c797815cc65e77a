//! The published reaction to a worker who left the path: its branches, one by one.

use super::people::Puppet;
use super::*;
use giveway_fleet::internals::{Person, WalkMode};
use giveway_floor::geometry::Point;
use giveway_floor::warehouse::sketch;
use giveway_people::aware::HumanAwarePolicy;

const NEVER: Time = Time::MAX;

fn at(floor: &TestFloor, x: f64, y: f64) -> NodeId {
    let w = floor.fleet.warehouse();
    w.nodes.pairs().find(|(_, n)| (n.at - Point::new(x, y)).norm() < 0.1).expect("the hall has it").0
}

fn hall(policy: HumanAwarePolicy, robots: usize) -> TestFloor {
    let mut hall = scenario(robots);
    hall.site.policy = policy;
    TestFloor::new(thesis(), &hall)
}

/// Sends a robot somewhere and breaks it there.
fn break_at(floor: &mut TestFloor, robot: u32, x: f64, y: f64) {
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

/// A worker on the way from the south of the second aisle to its north.
fn worker(floor: &mut TestFloor) -> Puppet {
    let ana = floor.hire(Point::new(3.0, 0.2));
    let place = at(floor, 3.0, 12.0);
    floor.assign(&ana, place, 5);
    ana
}

fn told(floor: &mut TestFloor, puppet: &mut Puppet, steps: usize) -> Vec<GuidanceState> {
    let mut states = Vec::new();
    for _ in 0..steps {
        let step = floor.walk(puppet);
        states.extend(step.guidance.iter().map(|(_, g)| g.state));
    }
    states
}

#[test]
fn all_robots_are_interrupted_and_go_on_when_somebody_leaves_the_path() {
    let mut floor = hall(HumanAwarePolicy::Phir, 8);
    floor.submit_batch(20);
    floor.run(5);
    let mut ana = worker(&mut floor);
    (ana.own, ana.way) = (true, vec![Point::new(0.0, 0.0), Point::new(0.0, 2.0)]);
    let before = floor.facts.len();
    told(&mut floor, &mut ana, 50);
    let interrupted = floor.facts[before..]
        .iter()
        .filter(|f| matches!(f, Fact::Encounter(EncounterFact::Interrupted { .. })))
        .count();
    assert!(floor.deviations() > 0, "{:?}, waited {} s", ana.at, ana.waited_s);
    assert!(interrupted >= 3, "{interrupted} robots");
    let served = floor.fleet.ledger().counts.robot_deliveries;
    told(&mut floor, &mut ana, 900);
    assert!(floor.fleet.ledger().counts.robot_deliveries > served, "they go on");
}

#[test]
fn without_prediction_nobody_reacts_before_a_robot_is_near() {
    let mut floor = hall(HumanAwarePolicy::Nhir, 4);
    let mut ana = worker(&mut floor);
    told(&mut floor, &mut ana, 10);
    (ana.own, ana.way) = (true, vec![Point::new(3.0, 0.0), Point::new(12.0, 0.0)]);
    let version = |f: &TestFloor| f.fleet.view(f.now).workers[0].guidance.version;
    let before = version(&floor);
    told(&mut floor, &mut ana, 60);
    assert!(floor.deviations() > 0, "it is noticed");
    assert_eq!(version(&floor), before, "but no robot is near, and nothing is planned");
}

#[test]
fn a_robot_that_stands_on_the_way_is_walked_round() {
    let mut floor = hall(HumanAwarePolicy::Nhir, 2);
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
    let mut floor = hall(HumanAwarePolicy::Nhir, 2);
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

/// [`break_at`] while a person is on the floor of whom the robot must not be afraid: she is cleared for that time.
fn break_at_while(floor: &mut TestFloor, puppet: &mut Puppet, robot: u32, x: f64, y: f64) {
    floor.step(vec![Input::ask(9, WorkerAction::Clear { worker: puppet.worker, by: "Ben".into() })]);
    break_at(floor, robot, x, y);
    let place = puppet.at;
    // She comes back a little to the side of her path, which starts anew where she is.
    (puppet.own, puppet.way) = (true, vec![place, Point::new(3.0, 3.2), place]);
}

/// A corridor of 24 m that a robot fills, with bays so deep that a robot in one is in no one's way. People walk in the
/// corridor only.
fn corridor(bays: &str, robots: usize) -> TestFloor {
    let stem = bays.replace('P', ".");
    let mut draft = sketch(&[bays, &stem, &stem, &stem, "X......................X"].join("\n"));
    let corner = |x: f64, y: f64| Point::new(x, y);
    draft.walkable = vec![vec![corner(-0.5, -0.5), corner(23.5, -0.5), corner(23.5, 0.5), corner(-0.5, 0.5)]];
    let mut scenario = scenario(robots);
    scenario.site.policy = HumanAwarePolicy::Shir;
    TestFloor::new(draft.build().expect("well-formed"), &scenario)
}

/// Ana walks east, robots come behind her, and she turns back: they are on her only way. Steps until it is
/// decided what she is told; `meanwhile` happens before the robots stand.
fn turn_back(floor: &mut TestFloor, meanwhile: impl FnOnce(&mut TestFloor)) -> Puppet {
    let mut ana = floor.hire(Point::new(9.0, 0.0));
    let place = at(floor, 22.0, 0.0);
    floor.assign(&ana, place, 5);
    let node = at(floor, 20.0, 0.0);
    for robot in floor.fleet.ledger().robots.ids().rev().collect::<Vec<_>>() {
        floor.submit(request(JobKind::Go { robot, node }));
    }
    told(floor, &mut ana, 60);
    (ana.own, ana.way) = (true, vec![Point::new(0.0, 0.0)]);
    while floor.deviations() == 0 {
        floor.walk(&mut ana);
    }
    meanwhile(floor);
    let version = floor.fleet.internals().people.people[ana.worker].version;
    let is_decided =
        |person: &Person| person.version > version || matches!(person.mode, WalkMode::Stopped { .. });
    while !is_decided(&floor.fleet.internals().people.people[ana.worker]) {
        floor.walk(&mut ana);
    }
    ana.own = false;
    ana
}

fn place(floor: &TestFloor, robot: usize) -> Point {
    floor.world.truth().nth(robot).expect("it is there").1.pose.at
}

#[test]
fn a_robot_on_the_only_way_leaves_it_and_the_worker_gets_through() {
    let mut floor = corridor("####P###P######P########", 1);
    let mut ana = turn_back(&mut floor, |_| {});
    let robot = place(&floor, 0);
    assert!(robot.x < ana.at.x && robot.y.abs() < 0.1, "it stands on her way west: {robot}");
    // She keeps to the way that she chose herself: what is expected of her is not shown.
    ana.own = true;
    let states = told(&mut floor, &mut ana, 90);
    assert!(ana.at.x < 2.0, "she is at {}", ana.at);
    assert!(place(&floor, 0).y > 2.5, "it is in a bay: {}", place(&floor, 0));
    assert!(!states.contains(&GuidanceState::Stop), "{states:?}");
    ana.own = false;
    told(&mut floor, &mut ana, 600);
    assert_eq!(floor.done(), 1, "it goes on with its own job");
}

#[test]
fn where_the_robot_on_the_only_way_cannot_leave_it_the_worker_is_told_to_stop_and_stays_so() {
    let mut floor = corridor("####P###P######P########", 1);
    let mut ana = turn_back(&mut floor, |f| f.world.fail(RobotId(0), NEVER));
    let states = told(&mut floor, &mut ana, 40);
    assert!(states.len() > 10 && states.iter().all(|s| *s == GuidanceState::Stop), "{states:?}");
    assert_eq!(floor.deviations(), 1, "she left the path once");
}

#[test]
fn where_one_of_two_robots_cannot_leave_the_only_way_neither_moves() {
    let mut floor = corridor("##P#P##########P########", 2);
    let outline = [(3.9, 3.9), (4.1, 3.9), (4.1, 4.1)].map(|(x, y)| Point::new(x, y).into()).to_vec();
    let window = giveway_floor::time::Window::new(Time::ZERO, NEVER);
    let area = Closure {
        outline,
        nodes: vec![],
        window,
        reason: "a spill".into(),
        binds: Binds::Robots,
        series: None,
    };
    floor.run(5);
    let ana = turn_back(&mut floor, |f| drop(f.step(vec![Input::ask(3, FloorAction::Close(area))])));
    assert!(place(&floor, 0).x < place(&floor, 1).x, "the one behind has a bay, the one in front has none");
    let mode = floor.fleet.internals().people.people[ana.worker].mode;
    assert!(matches!(mode, WalkMode::Stopped { .. }), "{mode:?}");
    let since =
        floor.facts.iter().skip_while(|f| !matches!(f, Fact::Encounter(EncounterFact::Deviated { .. })));
    assert_eq!(
        since.filter(|f| matches!(f, Fact::Route(RouteFact::Routed { .. }))).count(),
        0,
        "both keep their routes"
    );
}

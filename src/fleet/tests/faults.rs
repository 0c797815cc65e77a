//! What robots report as wrong with them: each fault has one reaction and one reason, and ends.

use super::*;
use giveway_floor::route::Cause;
use giveway_sim::Simulation;

const R0: RobotId = RobotId(0);

/// Robot 0 drives with a rack, and has this fault for this long.
fn afflicted(robots: usize, fault: Fault, seconds: i64) -> (TestFloor, JobId) {
    let mut floor = TestFloor::thesis(robots);
    let job = floor.submit(request(deliver(3)));
    let drives = |f: &TestFloor| {
        let robot = f.state(job).and_then(|s| s.robot());
        f.is(job, "carrying")
            && robot.is_some_and(|r| f.fleet.telemetry(r).is_some_and(|t| t.speed_mps > 0.5))
    };
    floor.until(300, "it drives with its rack", drives);
    let robot = floor.state(job).and_then(|s| s.robot()).expect("just seen");
    assert!(robots > 1 || robot == R0);
    floor.world.afflict(robot, fault, floor.now + Span::from_secs(seconds));
    (floor, job)
}

fn robot_of(floor: &TestFloor, job: JobId) -> RobotId {
    floor.state(job).and_then(|s| s.robot()).expect("it carries the rack")
}

#[test]
fn a_robot_whose_emergency_stop_is_pressed_stands_says_so_and_goes_on_when_it_is_released() {
    let (mut floor, job) = afflicted(1, Fault::EmergencyStop, 60);
    floor.run(5);
    assert_eq!(floor.fleet.why(R0), Some(Why::EmergencyStop));
    let (at, view) = (floor.robot_at(), floor.fleet.view(floor.now));
    assert_eq!(
        (view.robots[0].fault, view.robots[0].state),
        (Some(Fault::EmergencyStop), RobotState::Failed)
    );
    floor.run(50);
    assert_eq!(floor.robot_at(), at, "it stands");
    floor.until_over(600);
    assert_eq!(floor.story(job).last(), Some(&"done"), "the same robot brings the rack");
    assert_ne!(floor.fleet.why(R0), Some(Why::EmergencyStop));
}

#[test]
fn a_robot_that_is_driven_by_hand_is_taken_up_where_that_ends() {
    let (mut floor, job) = afflicted(1, Fault::Manual, 60);
    floor.run(5);
    assert_eq!(floor.fleet.why(R0), Some(Why::Manual));
    // A person drives the robot to a free node that it does not hold.
    let ledger = floor.fleet.ledger();
    let held: Vec<NodeId> = ledger.chain(R0).visits().map(|v| v.node).collect();
    let aisle = |n: &NodeId| floor.fleet.warehouse().kind(*n) == NodeKind::Aisle && !held.contains(n);
    let to = floor.fleet.warehouse().nodes.ids().find(aisle).expect("aisles are free");
    let at = floor.fleet.warehouse().nodes[to].at;
    floor.world.put(R0, at);
    floor.run(10);
    assert_eq!(floor.fleet.why(R0), Some(Why::Manual), "it is still driven by hand");
    assert_ne!(floor.fleet.ledger().node_of(R0), to, "and keeps what it held");
    assert!(floor.fleet.internals().writer.floor().is_closing(to), "where it truly is, the floor is closed");
    floor.until(120, "it is taken up", |f| f.fleet.ledger().node_of(R0) == to);
    floor.until_over(600);
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn an_obstructed_robot_is_called_back_and_goes_round() {
    let (mut floor, job) = afflicted(1, Fault::Obstructed, 3600);
    let view = |f: &TestFloor| f.fleet.why(R0);
    floor.until(10, "it says so", |f| matches!(view(f), Some(Why::Obstructed(_))));
    let Some(Why::Obstructed(node)) = view(&floor) else { panic!("just seen") };
    floor.until(60, "it has come back", |f| !matches!(view(f), Some(Why::Obstructed(_))));
    let step = floor.fleet.internals().writer.floor().is_closing(node);
    assert!(step, "no robot goes there for a while");
    let causes = floor.fleet.internals().writer.floor().conditions(R0).of(node).iter().map(|c| c.cause);
    assert!(
        causes.clone().any(|c| c == Cause::Obstruction(node)),
        "what waits is told of the node: {causes:?}"
    );
    floor.until_over(900);
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn a_robot_without_current_leaves_its_charger_for_another_one() {
    let mut floor = TestFloor::thesis(3);
    floor.run(1);
    let charges =
        |f: &TestFloor, r: RobotId| f.fleet.internals().writer.floor().at_charger(r) && f.is_idle(r);
    let any = |f: &TestFloor| f.fleet.ledger().robots.ids().find(|r| charges(f, *r));
    floor.until(300, "some robot charges", |f| any(f).is_some());
    let robot = any(&floor).expect("just seen");
    let charger = floor.fleet.ledger().node_of(robot);
    floor.world.afflict(robot, Fault::Unplugged, floor.now + Span::from_secs(3600));
    floor.run(1);
    assert_eq!(floor.fleet.why(robot), Some(Why::Unplugged));
    floor.until(300, "it has left", |f| f.fleet.ledger().node_of(robot) != charger);
    let away = |f: &TestFloor| f.fleet.ledger().robots.ids().all(|r| f.fleet.ledger().node_of(r) != charger);
    floor.run(30);
    assert!(away(&floor), "and no robot goes there meanwhile");
}

#[test]
fn a_lost_load_is_said_and_the_robot_goes_on_when_it_has_it_again() {
    let (mut floor, job) = afflicted(1, Fault::EmergencyStop, 1);
    let rack = RackId(3);
    floor.run(2);
    floor.world.load(R0, None);
    let lost = |f: &TestFloor| matches!(f.fleet.why(R0), Some(Why::Displaced(Displacement::Load { .. })));
    floor.until(60, "it is said", lost);
    floor.world.load(R0, Some(rack));
    floor.until_over(900);
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn others_deliver_while_a_robot_has_a_fault() {
    for fault in [Fault::EmergencyStop, Fault::Manual, Fault::Obstructed] {
        let (mut floor, job) = afflicted(4, fault, 900);
        let robot = robot_of(&floor, job);
        let others: Vec<JobId> = (10..16).map(|rack| floor.submit(request(deliver(rack)))).collect();
        floor.until(800, "the others are served", |f| others.iter().all(|j| f.state(*j).is_none()));
        assert!(others.iter().all(|j| floor.story(*j).last() == Some(&"done")), "{fault:?}");
        assert!(fault == Fault::Obstructed || floor.fleet.ledger().robots[robot].failed, "{fault:?}");
    }
}

#[test]
fn with_faults_of_every_kind_the_floor_drains() {
    let faults = Faults {
        failures_per_hour: 2.0,
        emergency_stops_per_hour: 2.0,
        obstacles_per_hour: 4.0,
        manual_drives_per_hour: 2.0,
        unplugged_per_hour: 4.0,
        repair_s: 60.0,
        ..Faults::default()
    };
    let (duration, drain) = (Span::from_secs(900), Span::from_secs(3600));
    let usual = Scenario { faults, duration, drain, demand: Demand::PerHour(300.0), ..scenario(12) };
    for seed in 1..=12 {
        let scenario = Scenario { seed, ..usual.clone() };
        let mut sim = Simulation::new(Arc::new(thesis()), &scenario, &[], seed, false, || 0);
        while !sim.is_over() {
            sim.step();
        }
        let outcome = sim.outcome();
        assert_eq!((outcome.broken, outcome.drained), (vec![], Some(true)), "seed {seed}");
    }
}

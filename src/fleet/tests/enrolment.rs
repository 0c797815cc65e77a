//! Robots that join while the fleet works, go to maintenance and come back.

use super::*;

const R0: RobotId = RobotId(0);

fn join(name: &str, node: NodeId) -> Input {
    Input::Register { token: 7, name: name.into(), kind: "robot".into(), node }
}

fn maintain(robot: RobotId, begins: bool) -> Input {
    Input::Maintain { token: 7, robot, begins }
}

/// A parking place that no robot holds.
fn free_parking(floor: &Floor) -> NodeId {
    let held = |n: &NodeId| floor.fleet.ledger().resident(*n).is_some();
    let all = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Parking);
    all.into_iter().find(|n| !held(n)).expect("some parking place is free")
}

#[test]
fn a_robot_that_joins_later_works_like_the_others() {
    let mut floor = Floor::thesis(2);
    let node = floor.free_storage();
    let reply = floor.answer_to(7, vec![join("late", node)]);
    assert_eq!(reply, Reply::Registered { token: 7, robot: RobotId(2), new: true });
    let again = floor.answer_to(7, vec![join("late", node)]);
    assert_eq!(again, Reply::Registered { token: 7, robot: RobotId(2), new: false });
    let jobs = floor.submit_batch(9);
    floor.until_over(3_000);
    floor.assert_done_once(&jobs);
    let late = JobState::Assigned { robot: RobotId(2) };
    let served = |f: &&Fact| matches!(f, Fact::Progressed { state, .. } if *state == late);
    assert!(floor.facts.iter().filter(served).count() > 0, "it had work");
}

#[test]
fn no_robot_joins_where_another_one_is_or_is_to_be_or_beyond_the_limit() {
    let mut floor = Floor::lab(2);
    let taken = floor.fleet.ledger().node_of(R0);
    let why = |reply: Reply| match reply {
        Reply::Refused { why, .. } => Some(why),
        _ => None,
    };
    assert_eq!(why(floor.answer_to(7, vec![join("x", taken)])), Some(Refusal::PlaceTaken(taken)));
    let job = floor.submit(request(deliver(3)));
    floor.until(60, "a robot is on its way", |f| f.is(job, "assigned"));
    let robot = floor.state(job).and_then(|s| s.robot()).expect("it is assigned");
    let ahead = floor.fleet.ledger().chain(robot).last().expect("it goes somewhere").node;
    assert_eq!(why(floor.answer_to(7, vec![join("x", ahead)])), Some(Refusal::PlaceTaken(ahead)));
    let forklift = Input::Register { token: 7, name: "x".into(), kind: "forklift".into(), node: taken };
    assert_eq!(why(floor.answer_to(7, vec![forklift])), Some(Refusal::UnknownKind));
    floor.fleet.core.settings.robots_max = 2;
    let full = Some(Refusal::TooMany(Bounded::Robots, 2));
    assert_eq!(why(floor.answer_to(7, vec![join("x", taken)])), full);
}

#[test]
fn a_robot_in_maintenance_finishes_what_it_carries_and_rests_until_it_may_work_again() {
    let mut floor = Floor::thesis(1);
    let first = floor.submit(request(deliver(3)));
    floor.until(300, "it carries", |f| f.is(first, "carrying"));
    let second = floor.submit(request(deliver(5)));
    floor.step(vec![maintain(R0, true)]);
    floor.until(600, "it has finished", |f| f.state(first).is_none());
    assert_eq!(floor.story(first).last(), Some(&"done"));
    let parked = |f: &Floor| f.fleet.warehouse().kind(f.fleet.ledger().node_of(R0)) == NodeKind::Parking;
    floor.until(600, "it rests at a parking place", |f| f.is_idle(R0) && parked(f));
    assert_eq!(floor.fleet.why(R0, floor.now), Some(Why::Maintenance));
    floor.run(120);
    assert!(floor.is(second, "waiting"), "it takes no job");
    let named = floor.submit(request(JobKind::Park { robot: R0 }));
    floor.run(5);
    let view = floor.fleet.view(floor.now);
    let why = view.why_job(floor.fleet.warehouse(), named, &floor.fleet.ledger().jobs[&named]);
    assert_eq!(why, Some(JobWhy::Robot(R0, Why::Maintenance)), "not even by name");
    floor.step(vec![maintain(R0, false)]);
    floor.until_over(900);
    assert_eq!(floor.story(second).last(), Some(&"done"));
}

#[test]
fn a_robot_on_its_way_to_a_rack_gives_the_job_to_another_one_when_it_goes_to_maintenance() {
    let mut floor = Floor::thesis(2);
    let job = floor.submit(request(deliver(3)));
    floor.until(60, "a robot has it", |f| f.is(job, "assigned"));
    let robot = floor.state(job).and_then(|s| s.robot()).expect("it is assigned");
    floor.step(vec![maintain(robot, true)]);
    floor.until(60, "it has given it back", |f| f.state(job).is_some_and(|s| s.robot() != Some(robot)));
    floor.until_over(900);
    assert_eq!(floor.story(job).last(), Some(&"done"));
    assert_ne!(floor.fleet.ledger().robots[robot].service, Service::Works, "it is still there");
}

#[test]
fn maintenance_survives_a_restart() {
    let mut floor = Floor::thesis(1);
    floor.step(vec![maintain(R0, true)]);
    let facts = floor.facts.clone();
    let settings = floor.fleet.settings().clone();
    let fleet = Fleet::restore(floor.fleet.warehouse().clone(), settings, facts);
    assert_eq!(fleet.ledger().robots[R0].service, floor.fleet.ledger().robots[R0].service);
    assert_ne!(fleet.ledger().robots[R0].service, Service::Works);
    let place = free_parking(&floor);
    let reply = floor.answer_to(7, vec![join("new", place)]);
    assert!(matches!(reply, Reply::Registered { new: true, .. }), "{reply:?}");
}

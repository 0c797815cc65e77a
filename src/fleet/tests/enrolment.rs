//! Robots that join during operation, go to maintenance, leave the floor and come back.

use super::*;

const R0: RobotId = RobotId(0);

fn join(name: &str, node: NodeId) -> Input {
    Input::ask(7, RobotAction::Register { name: name.into(), kind: "robot".into(), node, link: None })
}

fn maintain(robot: RobotId, begins: bool) -> Input {
    let action = if begins { RobotAction::BeginMaintenance } else { RobotAction::EndMaintenance };
    Input::ask(7, action(robot))
}

/// A parking place that no robot holds.
fn free_parking(floor: &TestFloor) -> NodeId {
    let held = |n: &NodeId| floor.fleet.ledger().resident(*n).is_some();
    let all = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Parking);
    all.into_iter().find(|n| !held(n)).expect("some parking place is free")
}

#[test]
fn a_robot_that_joins_later_works_like_the_others() {
    let mut floor = TestFloor::thesis(2);
    let node = floor.free_storage();
    let reply = floor.answer_to(7, vec![join("late", node)]);
    assert_eq!(reply, Ok(Answer::Robot(Made { id: RobotId(2), new: true })));
    let again = floor.answer_to(7, vec![join("late", node)]);
    assert_eq!(again, Ok(Answer::Robot(Made { id: RobotId(2), new: false })));
    let jobs = floor.submit_batch(9);
    floor.until_over(3_000);
    floor.assert_done_once(&jobs);
    let late = JobState::Assigned { robot: RobotId(2) };
    let served = |f: &&Fact| matches!(f, Fact::Job(JobFact::Progressed { state, .. }) if *state == late);
    assert!(floor.facts.iter().filter(served).count() > 0, "it had work");
}

#[test]
fn no_robot_joins_where_another_one_is_or_is_to_be_or_beyond_the_limit() {
    let mut floor = TestFloor::lab(2);
    let taken = floor.fleet.ledger().node_of(R0);
    let why = Answered::err;
    assert_eq!(
        why(floor.answer_to(7, vec![join("x", taken)])),
        Some(Refusal::Robot(RobotRefusal::PlaceTaken(taken)))
    );
    let job = floor.submit(request(deliver(3)));
    floor.until(60, "a robot is on its way", |f| f.is(job, "assigned"));
    let robot = floor.state(job).and_then(|s| s.robot()).expect("it is assigned");
    let ahead = floor.fleet.ledger().chain(robot).last().expect("it goes somewhere").node;
    assert_eq!(
        why(floor.answer_to(7, vec![join("x", ahead)])),
        Some(Refusal::Robot(RobotRefusal::PlaceTaken(ahead)))
    );
    let forklift = Input::ask(
        7,
        RobotAction::Register { name: "x".into(), kind: "forklift".into(), node: taken, link: None },
    );
    assert_eq!(why(floor.answer_to(7, vec![forklift])), Some(Refusal::Robot(RobotRefusal::UnknownKind)));
    floor.fleet.internals_mut().writer.settings.limits.robots = 2;
    let full = Some(Refusal::TooMany(Bounded::Robots, 2));
    assert_eq!(why(floor.answer_to(7, vec![join("x", taken)])), full);
}

#[test]
fn no_robot_joins_where_a_late_one_still_stands() {
    let mut floor = TestFloor::lab(2);
    let job = floor.submit(request(deliver(3)));
    floor.until(60, "a robot is on its way", |f| f.is(job, "assigned"));
    let robot = floor.state(job).and_then(|s| s.robot()).expect("it is assigned");
    let drives =
        |f: &TestFloor| f.fleet.ledger().chain(robot).granted() > f.fleet.ledger().chain(robot).first() + 1;
    floor.until(60, "it may drive", drives);
    let (node, mut now) = (floor.fleet.ledger().node_of(robot), floor.now);
    let refused =
        |r: &Reply| matches!(&r.answer, Err(Refusal::Robot(RobotRefusal::PlaceTaken(n))) if *n == node);
    // By the plan the robot was to be gone soon, and is not heard of. Its windows slide, but not in every step.
    for _ in 0..600 {
        now += floor.fleet.settings().period;
        floor.fleet.step(now, vec![]);
        assert_eq!(floor.fleet.ledger().node_of(robot), node);
        let step = floor.fleet.clone().step(now, vec![join("x", node)]);
        assert!(step.replies.iter().any(refused), "{:?}", step.replies);
    }
}

#[test]
fn a_robot_in_maintenance_finishes_what_it_carries_and_rests_until_it_may_work_again() {
    let mut floor = TestFloor::thesis(1);
    let first = floor.submit(request(deliver(3)));
    floor.until(300, "it carries", |f| f.is(first, "carrying"));
    let second = floor.submit(request(deliver(5)));
    floor.step(vec![maintain(R0, true)]);
    floor.until(600, "it has finished", |f| f.state(first).is_none());
    assert_eq!(floor.story(first).last(), Some(&"done"));
    let parked = |f: &TestFloor| f.fleet.warehouse().kind(f.fleet.ledger().node_of(R0)) == NodeKind::Parking;
    floor.until(600, "it rests at a parking place", |f| f.is_idle(R0) && parked(f));
    assert_eq!(floor.fleet.why(R0), Some(Why::Maintenance));
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
    let mut floor = TestFloor::thesis(2);
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
    let mut floor = TestFloor::thesis(1);
    floor.step(vec![maintain(R0, true)]);
    let facts = floor.facts.clone();
    let settings = floor.fleet.settings().clone();
    let fleet = Fleet::restore(floor.fleet.warehouse().clone(), settings, facts);
    assert_eq!(fleet.ledger().robots[R0].service, floor.fleet.ledger().robots[R0].service);
    assert_ne!(fleet.ledger().robots[R0].service, Service::Works);
    let place = free_parking(&floor);
    let reply = floor.answer_to(7, vec![join("new", place)]);
    assert!(matches!(reply, Ok(Answer::Robot(Made { new: true, .. }))), "{reply:?}");
}

impl TestFloor {
    fn retire(&mut self, robot: RobotId) -> Answered {
        self.answer_to(7, vec![Input::ask(7, RobotAction::Retire(robot))])
    }

    fn is_gone(&self, robot: RobotId) -> bool {
        self.fleet.ledger().robots[robot].is_gone()
    }
}

#[test]
fn a_robot_that_is_to_leave_finishes_its_job_and_is_gone_when_it_was_switched_off() {
    let mut floor = TestFloor::lab(2);
    let job = floor.submit(request(deliver(0)));
    floor.until(60, "a robot is at it", |f| f.is(job, "carrying"));
    let robot = floor.fleet.ledger().jobs[&job].state.robot().expect("it carries");
    assert_eq!(floor.retire(robot), Ok(Answer::Done));
    let named = floor.submit(request(JobKind::Park { robot }));
    floor.until(300, "the job is done", |f| f.state(job).is_none());
    floor.assert_done_once(&[job]);
    floor.until(300, "it is gone", |f| f.is_gone(robot));
    assert!(floor.fleet.ledger().timeline().chain(robot).is_some_and(|c| c.is_absent()));
    assert_eq!(floor.fleet.telemetry(robot), None, "what it said before it left is forgotten");
    assert_eq!(floor.story(named), ["failed"], "what names it cannot be done any more");
    let view = floor.fleet.view(floor.now);
    assert_eq!((view.robots[robot.ix()].state, view.kinds.len()), (RobotState::Gone, 1));
    let other = floor.submit(request(deliver(3)));
    floor.until(300, "the other one works on", |f| f.state(other).is_none());
    floor.assert_done_once(&[other]);
    let refused = floor.ask(request(JobKind::Park { robot }));
    assert_eq!(refused, Err(Refusal::Robot(RobotRefusal::IsGone(robot))));
}

#[test]
fn the_place_of_a_robot_that_has_left_is_free_and_it_comes_back_elsewhere() {
    let mut floor = TestFloor::thesis(2);
    floor.retire(R0).unwrap();
    floor.until(300, "it is gone", |f| f.is_gone(R0));
    // A panic may still concern the robot, which is in no robot's way.
    floor.fleet.fence(R0, floor.now);
    assert!(floor.fleet.ledger().robots[R0].fenced.is_none());
    let place = floor.fleet.ledger().node_of(R0);
    let one = RobotId(1);
    let job = floor.submit(request(JobKind::Go { robot: one, node: place }));
    floor.until(300, "another one stands there", |f| f.state(job).is_none());
    assert_eq!(floor.fleet.ledger().node_of(one), place);
    let name = floor.fleet.ledger().robots[R0].name.clone();
    let taken = floor.answer_to(7, vec![join(&name, place)]);
    assert_eq!(taken, Err(Refusal::Robot(RobotRefusal::PlaceTaken(place))));
    let free = floor.free_storage();
    assert_eq!(floor.answer_to(7, vec![join(&name, free)]), Ok(Answer::Robot(Made { id: R0, new: true })));
    assert_eq!(floor.fleet.ledger().robots.len(), 2, "it is the same robot");
    let job = floor.submit(request(JobKind::Park { robot: R0 }));
    floor.until(300, "it works again", |f| f.state(job).is_none());
    floor.assert_done_once(&[job]);
}

#[test]
fn a_broken_robot_leaves_where_it_stands_and_its_job_goes_to_another() {
    let mut floor = TestFloor::lab(2);
    let job = floor.submit(request(deliver(0)));
    floor.until(60, "a robot drives to the rack", |f| f.is(job, "assigned"));
    let robot = floor.fleet.ledger().jobs[&job].state.robot().expect("it drives");
    floor.run(1);
    floor.world.fail(robot, Time::MAX);
    floor.until(10, "the fleet knows", |f| f.fleet.ledger().robots[robot].failed);
    floor.retire(robot).unwrap();
    floor.until(30, "it is gone", |f| f.is_gone(robot));
    floor.until(600, "the job is done", |f| f.state(job).is_none());
    floor.assert_done_once(&[job]);
}

#[test]
fn a_robot_that_drove_when_it_was_heard_of_last_is_gone_only_when_it_must_stand() {
    let mut floor = TestFloor::lab(1);
    floor.submit(request(deliver(0)));
    floor.until(60, "it drives", |f| f.fleet.telemetry(R0).is_some_and(|t| t.speed_mps > 0.0));
    floor.retire(R0).unwrap();
    // The robot is not heard of any more, as if its link were down.
    let mut is_gone_after = |seconds: i64| {
        floor.fleet.step(floor.now + Span::from_secs(seconds), vec![]);
        floor.is_gone(R0)
    };
    assert_eq!([5, 15, 55, 65].map(&mut is_gone_after), [false, false, false, true]);
}

fn goes_while_its_link_is_down(is_up_again: bool) {
    let mut floor = TestFloor::lab(1);
    floor.run(1);
    let link = |reach| Input::Link(R0, LinkState { reach, ..LinkState::default() });
    floor.step(vec![link(LinkReach::Lost)]);
    floor.retire(R0).unwrap();
    let began = floor.now;
    let mut is_gone_at = |seconds: i64, said: Vec<Input>| {
        floor.fleet.step(began + Span::from_secs(seconds), said);
        floor.is_gone(R0)
    };
    assert!(!is_gone_at(590, vec![]), "it may be driving for all that anybody knows");
    if is_up_again {
        assert!(!is_gone_at(591, vec![link(LinkReach::ByReports)]), "its reports are on the way");
        assert!(!is_gone_at(600, vec![]));
        assert!(is_gone_at(602, vec![]), "it rested there, and is switched off");
    } else {
        assert!(is_gone_at(601, vec![]), "it was switched off, and its link with it");
    }
}

#[test]
fn a_robot_whose_link_is_down_is_gone_after_ten_minutes_or_soon_after_it_is_up_again() {
    goes_while_its_link_is_down(true);
    goes_while_its_link_is_down(false);
}

#[test]
fn a_robot_that_is_to_leave_can_stay_and_a_restart_forgets_neither() {
    let mut floor = TestFloor::lab(2);
    floor.retire(R0).unwrap();
    floor.restart(&scenario(2));
    assert!(matches!(floor.fleet.ledger().robots[R0].service, Service::Leaving { .. }));
    floor.answer_to(7, vec![maintain(R0, false)]).unwrap();
    assert_eq!(floor.fleet.ledger().robots[R0].service, Service::Works);
    floor.run(5);
    floor.retire(R0).unwrap();
    floor.until(120, "it is gone", |f| f.is_gone(R0));
    floor.restart(&scenario(2));
    assert!(floor.is_gone(R0));
    let job = floor.submit(request(deliver(0)));
    floor.until(600, "the other one works", |f| f.state(job).is_none());
    let parts = floor.fleet.ledger().to_parts();
    let again =
        Ledger::from_parts(floor.fleet.warehouse().clone(), &floor.fleet.settings().site_kinds, parts)
            .expect("it is sound");
    assert!(again == *floor.fleet.ledger(), "a snapshot says the same");
}

#[test]
fn a_silent_robot_that_rests_is_not_gone_before_ten_seconds_and_none_that_was_not_to_leave() {
    let mut floor = TestFloor::lab(2);
    floor.run(2);
    let at = floor.now;
    floor.retire(R0).unwrap();
    floor.until(120, "it is gone", |f| f.is_gone(R0));
    assert!(floor.now - at >= Span::from_secs(10), "{}", floor.now);
    floor.run(30);
    assert!(!floor.is_gone(RobotId(1)));
}

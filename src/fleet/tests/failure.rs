//! Robots that break down: other robots take over and go round them, and they go on when they are repaired.

use super::*;

const NEVER: Time = Time::MAX;

/// A robot that drives among racks on a task that `wanted` accepts, and shuts no robot in: from most storage nodes, a
/// loaded robot has one way out.
fn in_an_aisle(floor: &TestFloor, wanted: fn(&Task) -> bool) -> Option<RobotId> {
    let (w, ledger) = (floor.fleet.warehouse(), floor.fleet.ledger());
    let near = |a: NodeId, b: NodeId| (w.nodes[a].at - w.nodes[b].at).norm() < 1.5 * w.footprint_m;
    let granted = |r: RobotId| {
        let chain = ledger.chain(r);
        let count = (chain.granted() - chain.first()) as usize;
        chain.visits().take(count).map(|v| v.node).collect::<Vec<NodeId>>()
    };
    let racks =
        ledger.jobs.values().filter_map(|j| j.request.kind.rack()).filter_map(|k| match ledger.racks[k] {
            RackAt::Stored(node) => Some(node),
            RackAt::On(_) => None,
        });
    let racks: Vec<NodeId> = racks.collect();
    ledger.robots.ids().find(|r| {
        let own = granted(*r);
        let between = own.iter().all(|n| w.racks.iter().any(|k| near(k.home, *n)));
        // Robots without a rack drive beneath racks.
        let street =
            ledger.robots[*r].task.carried().is_none() || own.iter().all(|n| !w.nodes[*n].kind.is_lasting());
        let others = ledger.robots.ids().filter(|o| o != r).flat_map(granted);
        let shut_in = others.chain(racks.iter().copied()).any(|n| own.iter().any(|o| near(n, *o)));
        wanted(&ledger.robots[*r].task) && own.len() > 1 && between && street && !shut_in
    })
}

#[test]
fn a_robot_that_fails_on_its_way_to_a_rack_gives_its_job_to_another() {
    let mut floor = TestFloor::thesis(3);
    let job = floor.submit(request(deliver(40)));
    floor.until(10, "a robot has the job", |f| f.is(job, "assigned"));
    let first = floor.state(job).and_then(|s| s.robot()).expect("assigned jobs have a robot");
    floor.run(4);
    floor.world.fail(first, NEVER);
    floor.until(5, "another has it", |f| f.state(job).and_then(|s| s.robot()).is_some_and(|r| r != first));
    floor.until_over(600);
    assert_eq!(floor.story(job), ["assigned", "waiting", "assigned", "carrying", "picking", "done"]);
    assert!(floor.fleet.ledger().robots[first].failed, "nobody repaired it");
}

#[track_caller]
fn check_others_go_on(wanted: fn(&Task) -> bool) {
    let mut floor = TestFloor::thesis(6);
    let jobs = floor.submit_batch(12);
    floor.until(300, "a robot is in an aisle", |f| in_an_aisle(f, wanted).is_some());
    let broken = in_an_aisle(&floor, wanted).expect("just seen");
    let own = floor.fleet.ledger().robots[broken].task;
    floor.world.fail(broken, NEVER);
    let kept = u64::from(own.carried().is_some());
    floor.until(3000, "the others did everything else", |f| f.done() == jobs.len() as u64 - kept);
    assert_eq!(floor.fleet.view(floor.now).robots[broken.ix()].state, RobotState::Failed);
    floor.world.fail(broken, floor.now);
    floor.until(5, "it works again", |f| !f.fleet.ledger().robots[broken].failed);
    floor.until_over(600);
    floor.assert_done_once(&jobs);
    floor.until(600, "it brought its rack away", |f| f.is_idle(broken));
    assert!(
        floor
            .facts
            .iter()
            .any(|f| matches!(f, Fact::Robot(RobotFact::Repaired { robot, .. }) if *robot == broken))
    );
}

#[test]
fn a_robot_that_fails_between_the_racks_without_one_does_not_stop_the_others() {
    check_others_go_on(|t| matches!(t, Task::Fetch { .. }));
}

#[test]
fn a_robot_that_fails_in_an_aisle_with_a_rack_does_not_stop_the_others_and_finishes_when_repaired() {
    check_others_go_on(|t| matches!(t, Task::Deliver { .. }));
}

#[test]
fn a_robot_that_fails_with_a_rack_keeps_its_job_and_does_it_after_repair() {
    let mut floor = TestFloor::thesis(2);
    let job = floor.submit(request(deliver(40)));
    floor.until(300, "it is carried", |f| f.is(job, "carrying"));
    floor.run(3);
    let robot = floor.state(job).and_then(|s| s.robot()).expect("carried by a robot");
    floor.world.fail(robot, floor.now + Span::from_secs(60));
    floor.run(50);
    assert_eq!(floor.state(job), Some(JobState::Carrying { robot }));
    floor.until_over(600);
    assert_eq!(floor.story(job), ["assigned", "carrying", "picking", "done"]);
}

#[test]
fn a_batch_is_done_although_robots_fail_again_and_again() {
    let faults = Faults { failures_per_hour: 40.0, repair_s: 60.0, ..Faults::default() };
    let mut floor = TestFloor::new(thesis(), &Scenario { faults, ..scenario(6) });
    let jobs = floor.submit_batch(24);
    floor.until_over(3600);
    floor.assert_done_once(&jobs);
    let failures = floor.facts.iter().filter(|f| matches!(f, Fact::Robot(RobotFact::Failed { .. }))).count();
    assert!(failures >= 5, "only {failures} failures");
}

#[test]
fn a_robot_that_is_fenced_off_stands_whatever_it_says_and_others_take_over_until_it_is_released() {
    let mut floor = TestFloor::thesis(3);
    let job = floor.submit(request(deliver(40)));
    floor.until(10, "a robot has the job", |f| f.is(job, "assigned"));
    let fenced = floor.state(job).and_then(|s| s.robot()).expect("assigned jobs have a robot");
    floor.run(4);
    floor.fleet.fence(fenced, floor.now);
    floor.fleet.fence(fenced, floor.now);
    floor.until(5, "another has it", |f| f.state(job).and_then(|s| s.robot()).is_some_and(|r| r != fenced));
    let fences =
        |f: &TestFloor| f.facts.iter().filter(|f| matches!(f, Fact::Robot(RobotFact::Fenced { .. }))).count();
    assert_eq!(fences(&floor), 1, "once, and in the facts of the next step");
    floor.until_over(600);
    let about = |fact: &&Fact| match fact {
        Fact::Route(RouteFact::Passed { robot, .. } | RouteFact::Acted { robot, .. }) => *robot == fenced,
        _ => false,
    };
    let fence = floor
        .facts
        .iter()
        .position(|f| matches!(f, Fact::Robot(RobotFact::Fenced { .. })))
        .expect("just seen");
    assert_eq!(floor.facts[fence..].iter().find(about), None, "what it says changes nothing");
    let (map, settings) = (floor.fleet.warehouse().clone(), floor.fleet.settings().clone());
    floor.fleet = Fleet::restore(map, settings, floor.facts.iter().cloned());
    floor.run(2);
    assert_eq!(floor.fleet.why(fenced), Some(Why::Failed), "also after a restart");
    let released = floor.step(vec![Input::ask(6, FloorAction::Release(Some(fenced)))]);
    assert_eq!(released.replies, [Reply { token: 6.into(), answer: Ok(Answer::Done) }]);
    let kind = JobKind::Go { robot: fenced, node: floor.fleet.warehouse().racks[RackId(3)].home };
    let job = floor.submit(request(kind));
    floor.until_over(600);
    assert_eq!(floor.story(job).last(), Some(&"done"), "it works again");
}

//! Job life cycles at their seams: two jobs for one robot, two racks for one place, cancels, ends that are true.

use super::*;

/// Two robots with plenty to do, and jobs for the first one by name.
fn busy_floor_with_named_jobs() -> (TestFloor, Vec<JobId>, JobId, JobId) {
    let mut floor = TestFloor::lab(2);
    let deliveries = (0..8).map(|k| floor.submit(request(deliver(k)))).collect();
    let robot = RobotId::at(0);
    let go = JobKind::Go { robot, node: floor.node("R117") };
    let go = floor.submit(request(go));
    let park = floor.submit(request(JobKind::Park { robot }));
    (floor, deliveries, go, park)
}

#[test]
fn jobs_for_a_named_robot_end_although_racks_wait_for_it_too() {
    let (mut floor, deliveries, go, park) = busy_floor_with_named_jobs();
    floor.until_over(4_000);
    assert_eq!((floor.story(go), floor.story(park)), (vec!["assigned", "done"], vec!["assigned", "done"]));
    floor.assert_done_once(&deliveries);
}

#[test]
fn a_named_job_does_not_wait_until_its_robot_runs_out_of_racks() {
    let mut floor = TestFloor::lab(1);
    // The same rack again and again: the robot could carry it from pick to pick for ever.
    let deliveries: Vec<JobId> = (0..6).map(|_| floor.submit(request(deliver(3)))).collect();
    floor.until(300, "the first is carried", |f| f.is(deliveries[0], "carrying"));
    let park = floor.submit(request(JobKind::Park { robot: RobotId::at(0) }));
    floor.until_over(4_000);
    let last = deliveries.iter().map(|j| floor.when(*j, "done")).max().expect("six of them");
    assert!(floor.when(park, "done") < last, "it came last");
}

#[test]
fn a_cancelled_job_leaves_the_job_that_its_robot_is_at_alone() {
    let (mut floor, deliveries, go, park) = busy_floor_with_named_jobs();
    floor.run(30);
    for job in [go, park] {
        floor.cancel(job).unwrap();
        floor.run(5);
    }
    floor.until_over(4_000);
    floor.assert_done_once(&deliveries);
}

#[test]
fn two_racks_are_not_promised_to_one_place() {
    let mut floor = TestFloor::thesis(2);
    let node = floor.free_storage();
    let first = floor.submit(request(JobKind::Relocate { rack: RackId(40), node }));
    let again = floor.ask(request(JobKind::Relocate { rack: RackId(50), node }));
    assert_eq!(again, Err(Refusal::Rack(RackRefusal::StorageTaken(node))));
    floor.until_over(900);
    assert_eq!(floor.story(first).last(), Some(&"done"));
    assert_eq!(floor.rack(40), RackAt::Stored(node));
}

#[test]
fn jobs_for_one_robot_are_done_by_priority() {
    let mut floor = TestFloor::lab(1);
    let (robot, node) = (RobotId::at(0), floor.node("R117"));
    let busy = floor.submit(request(deliver(3)));
    floor.until(300, "it is carried", |f| f.is(busy, "carrying"));
    let park = floor.submit(request(JobKind::Park { robot }));
    let go = floor.submit(JobRequest { priority: 7, ..request(JobKind::Go { robot, node }) });
    floor.until_over(900);
    assert!(floor.when(go, "done") < floor.when(park, "assigned"));
}

#[test]
fn a_paused_robot_gets_no_job_by_name_until_it_goes_on() {
    let mut floor = TestFloor::lab(1);
    let robot = RobotId::at(0);
    floor.step(vec![Input::ask(9, FloorAction::Halt(Some(robot)))]);
    let park = floor.submit(request(JobKind::Park { robot }));
    floor.run(20);
    assert!(floor.is(park, "waiting"));
    floor.step(vec![Input::ask(9, FloorAction::Release(Some(robot)))]);
    floor.until_over(300);
    assert_eq!(floor.story(park), ["assigned", "done"]);
}

/// Runs until a robot has got this far, breaks it for two minutes, and lets everything end.
#[track_caller]
fn break_down(so: impl Fn(&TestFloor, RobotId) -> bool) {
    let mut floor = TestFloor::lab(2);
    let jobs: Vec<JobId> = (0..4).map(|k| floor.submit(request(deliver(k)))).collect();
    let found = |f: &TestFloor| (0..2).map(RobotId::at).find(|r| so(f, *r));
    floor.until(600, "a robot is there", |f| found(f).is_some());
    let (robot, until) = (found(&floor).expect("just seen"), floor.now + Span::from_secs(120));
    floor.world.fail(robot, until);
    floor.until_over(4_000);
    floor.assert_done_once(&jobs);
    floor.until(600, "all robots have nothing to do", |f| (0..2).all(|r| f.is_idle(RobotId::at(r))));
    (0..4).for_each(|k| floor.assert_stored(k));
}

#[test]
fn a_robot_that_breaks_down_when_it_was_granted_its_rack_keeps_the_job() {
    break_down(|f, r| {
        let record = &f.fleet.ledger().robots[r];
        let lift = record.stops.first().filter(|s| matches!(s.act, Act::Lift(_)));
        lift.is_some_and(|s| s.serial < f.fleet.ledger().chain(r).granted())
    });
}

#[test]
fn a_robot_that_breaks_down_on_its_way_to_a_rack_gives_the_job_away() {
    break_down(|f, r| matches!(f.fleet.ledger().robots[r].task, Task::Fetch { .. }));
}

#[test]
fn a_robot_that_breaks_down_at_the_station_goes_on_when_it_is_repaired() {
    break_down(|f, r| {
        matches!(f.fleet.ledger().robots[r].task, Task::Deliver { .. })
            && f.fleet.view(f.now).robots[r.ix()].doing == Doing::Picking
    });
}

//! Cancelling at every stage: the job is over at once, the robot is free soon and the rack is back in storage.

use super::*;

#[track_caller]
fn check(stage: &str, wait_s: i64, rack_moves: bool) {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(request(deliver(3)));
    floor.until(300, stage, |f| f.is(job, stage));
    floor.run(wait_s);
    assert!(floor.is(job, stage), "it is still {stage}");
    assert_eq!(floor.cancel(job), Ok(Answer::Done));
    assert_eq!(floor.state(job), None, "it is over at once");
    assert_eq!(floor.story(job).last(), Some(&"cancelled"));
    assert_eq!(floor.cancel(job), Err(Refusal::Job(JobRefusal::IsOver(job))));
    floor.until(300, "the robot has nothing to do", TestFloor::first_robot_is_idle);
    floor.assert_stored(3);
    let stores = |f: &Fact| {
        matches!(
            f,
            Fact::Robot(RobotFact::Tasked { task: Task::Store { .. }, .. })
                | Fact::Job(JobFact::Progressed { tasked: Some((_, Task::Store { .. })), .. })
        )
    };
    let lifted = floor.facts.iter().any(stores);
    assert_eq!(lifted, rack_moves);
    assert_eq!(floor.story(job).last(), Some(&"cancelled"));
    assert_eq!((floor.done(), floor.fleet.ledger().counts.cancelled), (0, 1));
    let again = floor.submit(request(deliver(3)));
    floor.until_over(300);
    assert_eq!(floor.story(again).last(), Some(&"done"), "the rack can be wanted again");
}

#[test]
fn a_job_can_be_cancelled_when_it_was_just_assigned() {
    check("assigned", 0, false);
}

#[test]
fn a_job_can_be_cancelled_while_its_robot_drives_to_the_rack() {
    check("assigned", 3, false);
}

#[test]
fn a_job_can_be_cancelled_when_its_rack_was_just_lifted() {
    check("carrying", 0, true);
}

#[test]
fn a_job_can_be_cancelled_while_its_rack_is_carried() {
    check("carrying", 6, true);
}

#[test]
fn a_job_can_be_cancelled_while_somebody_picks() {
    check("picking", 2, true);
}

#[test]
fn a_job_can_be_cancelled_while_its_rack_is_being_lifted() {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(request(deliver(3)));
    let lifting = |f: &TestFloor| f.fleet.view(f.now).robots[0].doing == Doing::Lifting;
    floor.until(300, "the robot lifts", lifting);
    floor.cancel(job).unwrap();
    assert_eq!(floor.story(job), ["assigned", "cancelled"]);
    floor.until(300, "the robot has nothing to do", TestFloor::first_robot_is_idle);
    floor.assert_stored(3);
}

#[test]
fn a_job_can_be_cancelled_while_it_waits() {
    let mut floor = TestFloor::lab(1);
    let first = floor.submit(request(deliver(3)));
    floor.until(10, "a robot has the first", |f| f.is(first, "assigned"));
    let second = floor.submit(request(deliver(8)));
    assert!(floor.is(second, "waiting"));
    floor.cancel(second).unwrap();
    floor.until_over(300);
    assert_eq!((floor.story(first).last(), floor.story(second)), (Some(&"done"), vec!["cancelled"]));
}

#[test]
fn a_relocation_can_be_cancelled_while_its_rack_is_carried() {
    let mut floor = TestFloor::thesis(1);
    let node = floor.free_storage();
    let job = floor.submit(request(JobKind::Relocate { rack: RackId(40), node }));
    floor.until(300, "it is carried", |f| f.is(job, "carrying"));
    floor.cancel(job).unwrap();
    floor.until(300, "the robot has nothing to do", TestFloor::first_robot_is_idle);
    floor.assert_stored(40);
    assert_eq!(floor.story(job).last(), Some(&"cancelled"));
}

#[test]
fn a_robot_sent_somewhere_goes_to_where_it_may_stay_when_that_is_cancelled() {
    let mut floor = TestFloor::lab(1);
    let robot = RobotId::at(0);
    let node = floor.node("R117");
    let job = floor.submit(request(JobKind::Go { robot, node }));
    floor.run(2);
    floor.cancel(job).unwrap();
    floor.until(300, "the robot has nothing to do", TestFloor::first_robot_is_idle);
    let stands = floor.fleet.warehouse().nodes[floor.fleet.ledger().node_of(robot)].kind;
    assert!(stands.is_lasting(), "it stands on {stands:?}");
    assert_eq!(floor.story(job), ["assigned", "cancelled"]);
}

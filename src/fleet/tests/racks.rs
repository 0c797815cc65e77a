//! What becomes of a rack on a robot that breaks down, and of the jobs that want it: in each stage of a delivery.

use super::*;

const NEVER: Time = Time::MAX;
const RACK: u32 = 40;

impl TestFloor {
    /// A robot that has broken down for good with the rack of a job in this state, and that drives if it can.
    fn broken_with_rack(state: &str) -> (TestFloor, JobId, RobotId) {
        let mut floor = TestFloor::thesis(3);
        let job = floor.submit(request(deliver(RACK)));
        floor.until(300, state, |f| f.is(job, state));
        floor.run(2);
        let robot = floor.state(job).and_then(|s| s.robot()).expect("a robot has it");
        floor.world.fail(robot, NEVER);
        floor.run(5);
        (floor, job, robot)
    }

    fn take_rack(&mut self, rack: RackId, node: NodeId) -> Answered {
        self.answer_to(9, vec![Input::ask(9, RobotAction::TakeRack { rack, node })])
    }
}

#[test]
fn a_job_whose_rack_is_on_a_broken_robot_says_so_and_so_do_others_that_want_the_rack() {
    for state in ["carrying", "picking"] {
        let (mut floor, job, robot) = TestFloor::broken_with_rack(state);
        let next = floor.submit(request(JobKind::Return { rack: RackId(RACK) }));
        assert!(floor.is(job, state) || floor.is(job, "done"), "the person at the station may finish");
        if floor.is(job, state) {
            assert_eq!(floor.why_job(job), Some(JobWhy::Robot(robot, Why::Failed)));
        }
        let job_of_rack = floor.fleet.ledger().robots[robot].task.job();
        assert_eq!(floor.why_job(next), Some(JobWhy::RackBusy(RackId(RACK), robot, job_of_rack)));
        let chain = floor.fleet.job_waits(next, floor.now);
        assert_eq!(chain.last().map(|w| w.because), Some(Because::Robot(Why::Failed)), "{chain:?}");
        floor.world.fail(robot, floor.now);
        floor.until_over(900);
        floor.assert_done_once(&[job, next]);
    }
}

#[test]
fn a_robot_that_breaks_down_on_its_way_back_keeps_the_rack_and_stores_it_after_the_repair() {
    let mut floor = TestFloor::thesis(3);
    let job = floor.submit(request(deliver(RACK)));
    floor.until_over(600);
    floor.assert_done_once(&[job]);
    let RackAt::On(robot) = floor.rack(RACK) else { panic!("it is on its way back") };
    floor.world.fail(robot, NEVER);
    let next = floor.submit(request(deliver(RACK)));
    floor.run(5);
    assert_eq!(floor.why_job(next), Some(JobWhy::RackBusy(RackId(RACK), robot, None)));
    floor.world.fail(robot, floor.now);
    floor.until_over(900);
    floor.assert_done_once(&[next]);
    floor.until(600, "it is stored", |f| matches!(f.rack(RACK), RackAt::Stored(_)));
}

#[test]
fn a_rack_that_people_take_off_a_broken_robot_is_in_storage_and_another_robot_goes_on_with_its_job() {
    for state in ["carrying", "picking"] {
        let (mut floor, job, robot) = TestFloor::broken_with_rack(state);
        let free = floor.free_storage();
        floor.world.take_rack((RackId(RACK), robot), free);
        let was_picked = !floor.is(job, state);
        assert_eq!(floor.take_rack(RackId(RACK), free), Ok(Answer::Done));
        assert_eq!(floor.rack(RACK), RackAt::Stored(free));
        assert_eq!(floor.fleet.ledger().robots[robot].task, Task::Idle);
        assert!(was_picked || floor.state(job).is_none_or(|s| s.robot() != Some(robot)));
        floor.fleet.ledger().assert_indexed();
        assert_eq!(floor.answer_to(4, vec![Input::ask(4, RobotAction::Retire(robot))]), Ok(Answer::Done));
        let gone = |f: &TestFloor| f.fleet.ledger().robots[robot].is_gone();
        floor.until(120, "the robot can be taken away", gone);
        // In one of the two cases, the robot broke down at the station, and no other robot came there before.
        floor.until(900, "another robot has done it", |f| f.state(job).is_none());
        floor.assert_done_once(&[job]);
    }
}

#[test]
fn a_robot_whose_rack_was_taken_off_drives_on_after_the_repair() {
    let (mut floor, job, robot) = TestFloor::broken_with_rack("carrying");
    let free = floor.free_storage();
    floor.world.take_rack((RackId(RACK), robot), free);
    floor.take_rack(RackId(RACK), free).unwrap();
    floor.world.fail(robot, floor.now);
    floor.until_over(900);
    floor.assert_done_once(&[job]);
    let rests = |f: &TestFloor| {
        f.is_idle(robot) && f.fleet.warehouse().kind(f.fleet.ledger().node_of(robot)).is_lasting()
    };
    floor.until(300, "it rests where it may stay", rests);
}

#[test]
fn a_rack_that_was_to_be_stored_where_people_set_it_down_is_done() {
    let mut floor = TestFloor::thesis(2);
    let node = floor.free_storage();
    let job = floor.submit(request(JobKind::Relocate { rack: RackId(RACK), node }));
    floor.until(300, "it is carried", |f| f.is(job, "carrying"));
    let robot = floor.state(job).and_then(|s| s.robot()).expect("carried by a robot");
    floor.world.fail(robot, NEVER);
    floor.run(2);
    floor.world.take_rack((RackId(RACK), robot), node);
    floor.take_rack(RackId(RACK), node).unwrap();
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn people_may_take_a_rack_off_only_a_robot_that_cannot_drive_and_only_to_free_storage() {
    let (mut floor, _, robot) = TestFloor::broken_with_rack("carrying");
    let (rack, free) = (RackId(RACK), floor.free_storage());
    let refused = |why| Err(why);
    let w = floor.fleet.warehouse().clone();
    let aisle = w.nodes_where(|k| k == NodeKind::Aisle)[0];
    assert_eq!(floor.take_rack(rack, aisle), refused(Refusal::Rack(RackRefusal::NotStorage(aisle))));
    let taken = w.racks[RackId(3)].home;
    assert_eq!(floor.take_rack(rack, taken), refused(Refusal::Rack(RackRefusal::StorageTaken(taken))));
    assert_eq!(floor.take_rack(RackId(3), free), refused(Refusal::Rack(RackRefusal::IsStored(RackId(3)))));
    assert_eq!(floor.take_rack(RackId(9999), free), refused(Refusal::UnknownPlace));
    floor.world.fail(robot, floor.now);
    floor.until(10, "it can drive again", |f| !f.fleet.ledger().robots[robot].failed);
    assert_eq!(floor.take_rack(rack, free), refused(Refusal::Robot(RobotRefusal::CanDrive(robot))));
}

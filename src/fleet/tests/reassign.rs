//! An operator takes a job from its robot: another one does it, and the rack is not left anywhere.

use super::*;

impl TestFloor {
    fn reassign(&mut self, job: JobId, robot: Option<RobotId>) -> Answered {
        self.answer_to(9, vec![Input::ask(9, JobAction::Reassign(job, robot))])
    }

    fn why_waits(&self, job: JobId) -> Option<JobWhy> {
        let (view, record) = (self.fleet.view(self.now), &self.fleet.ledger().jobs[&job]);
        view.why_job(self.fleet.warehouse(), job, record)
    }

    fn robot_of(&self, job: JobId) -> Option<RobotId> {
        self.state(job).and_then(|s| s.robot())
    }
}

#[track_caller]
fn another_robot_does_it(stage: &str, wait_s: i64) {
    let mut floor = TestFloor::thesis(3);
    let job = floor.submit(request(deliver(40)));
    floor.until(300, stage, |f| f.is(job, stage));
    floor.run(wait_s);
    let first = floor.robot_of(job).expect("a robot has it");
    assert_eq!(floor.reassign(job, None), Ok(Answer::Done));
    assert_ne!(floor.robot_of(job), Some(first));
    floor.until(300, "another robot has it", |f| f.robot_of(job).is_some());
    assert_ne!(floor.robot_of(job), Some(first));
    floor.until_over(600);
    floor.assert_done_once(&[job]);
}

#[test]
fn a_job_can_be_taken_from_a_robot_that_drives_to_the_rack() {
    another_robot_does_it("assigned", 0);
    another_robot_does_it("assigned", 3);
}

#[test]
fn a_job_can_be_taken_from_a_robot_that_carries_the_rack_to_its_station() {
    another_robot_does_it("carrying", 2);
}

/// A robot with the job for which it carries a rack, and another job that it is to do next.
fn given_to_a_busy_robot() -> (TestFloor, JobId, JobId, RobotId) {
    let mut floor = TestFloor::thesis(3);
    let busy = floor.submit(request(deliver(7)));
    floor.until(60, "a robot has it", |f| f.is(busy, "carrying"));
    let chosen = floor.robot_of(busy).expect("a robot has it");
    let job = floor.submit(request(deliver(40)));
    floor.until(60, "another robot has it", |f| f.is(job, "assigned"));
    assert_ne!(floor.robot_of(job), Some(chosen));
    floor.reassign(job, Some(chosen)).unwrap();
    (floor, busy, job, chosen)
}

#[test]
fn a_robot_that_is_named_does_it_as_soon_as_it_is_free() {
    let (mut floor, busy, job, chosen) = given_to_a_busy_robot();
    assert_eq!(floor.why_waits(job), Some(JobWhy::RobotBusy(chosen, Some(busy))));
    floor.until(600, "the chosen robot has it", |f| f.robot_of(job) == Some(chosen));
    floor.until_over(600);
    floor.assert_done_once(&[job, busy]);
}

#[test]
fn a_job_that_waits_for_its_chosen_robot_keeps_no_other_job_for_the_rack_waiting() {
    let mut floor = TestFloor::thesis(2);
    let long = JobKind::Deliver { rack: RackId(7), station: StationId(1), pick: Some(Span::from_secs(200)) };
    let busy = floor.submit(request(long));
    floor.until(60, "a robot has it", |f| f.robot_of(busy).is_some());
    let chosen = floor.robot_of(busy).expect("just seen");
    floor.step(vec![Input::ask(4, Request::Station(StationId(0), StationOrder::Pause))]);
    let [first, second] = [(); 2].map(|()| floor.submit(request(deliver(40))));
    floor.reassign(first, Some(chosen)).unwrap();
    floor.step(vec![Input::ask(4, Request::Station(StationId(0), StationOrder::Resume))]);
    floor
        .until(60, "the other robot does the other one", |f| f.robot_of(second).is_some_and(|r| r != chosen));
    assert_eq!(floor.robot_of(first), None);
    floor.until_over(1200);
    floor.assert_done_once(&[busy, first, second]);
}

#[test]
fn a_robot_that_rests_beneath_the_rack_makes_room_for_the_chosen_one() {
    let mut floor = TestFloor::thesis(2);
    let RackAt::Stored(node) = floor.rack(40) else { panic!("it is stored") };
    let beneath = floor.submit(request(JobKind::Go { robot: RobotId(0), node }));
    floor.until(300, "a robot rests beneath it", |f| f.state(beneath).is_none());
    let busy = floor.submit(request(JobKind::Deliver { rack: RackId(7), station: StationId(1), pick: None }));
    floor.reassign(busy, Some(RobotId(1))).unwrap();
    let job = floor.submit(request(deliver(40)));
    floor.reassign(job, Some(RobotId(1))).unwrap();
    floor.until_over(900);
    floor.assert_done_once(&[job, busy]);
}

#[test]
fn a_choice_ends_when_its_robot_goes_out_of_service() {
    let mut floor = TestFloor::thesis(2);
    let busy = floor.submit(request(deliver(7)));
    floor.until(60, "a robot has it", |f| f.is(busy, "carrying"));
    let chosen = floor.robot_of(busy).expect("a robot has it");
    let job = floor.submit(request(deliver(40)));
    floor.reassign(job, Some(chosen)).unwrap();
    floor.answer_to(4, vec![Input::ask(4, RobotAction::BeginMaintenance(chosen))]).unwrap();
    floor.until(300, "the other one has it", |f| f.robot_of(job).is_some_and(|r| r != chosen));
    floor.until_over(600);
}

#[test]
fn a_choice_that_cannot_be_kept_binds_for_five_minutes() {
    let mut floor = TestFloor::thesis(2);
    floor.answer_to(3, vec![Input::ask(3, FloorAction::Halt(Some(RobotId(0))))]).unwrap();
    let job = floor.submit(request(deliver(40)));
    floor.reassign(job, Some(RobotId(0))).unwrap();
    floor.run(290);
    assert!(floor.is(job, "waiting"), "{:?}", floor.state(job));
    floor.until(60, "the other one has it", |f| f.robot_of(job) == Some(RobotId(1)));
}

#[test]
fn the_only_robot_gets_its_job_again_after_a_while() {
    let mut floor = TestFloor::thesis(1);
    let job = floor.submit(request(deliver(40)));
    floor.until(60, "the robot has it", |f| f.is(job, "assigned"));
    floor.reassign(job, None).unwrap();
    floor.run(60);
    assert!(floor.is(job, "waiting"));
    floor.until(90, "it has it again", |f| f.is(job, "assigned"));
}

#[test]
fn what_cannot_be_taken_is_refused_with_the_reason() {
    let mut floor = TestFloor::thesis(2);
    let refused = |why| Err(why);
    let job = floor.submit(request(deliver(40)));
    floor.until(300, "somebody picks", |f| f.is(job, "picking"));
    assert_eq!(floor.reassign(job, None), refused(Refusal::Job(JobRefusal::CannotBeTaken(job))));
    let parks = floor.submit(request(JobKind::Park { robot: RobotId(0) }));
    assert_eq!(floor.reassign(parks, None), refused(Refusal::Job(JobRefusal::NamesItsRobot("park"))));
    assert_eq!(floor.reassign(JobId(99), None), refused(Refusal::Job(JobRefusal::Unknown(JobId(99)))));
    let node = floor.free_storage();
    let put = floor.submit(request(JobKind::Relocate { rack: RackId(41), node }));
    floor.until(300, "it is carried", |f| f.is(put, "carrying"));
    assert_eq!(floor.reassign(put, None), refused(Refusal::Job(JobRefusal::CannotBeTaken(put))));
    assert_eq!(floor.reassign(put, Some(RobotId(9))), refused(Refusal::UnknownPlace));
    floor.until_over(600);
    assert_eq!(floor.reassign(job, None), refused(Refusal::Job(JobRefusal::IsOver(job))));
}

#[test]
fn a_job_that_waits_while_its_chosen_robot_puts_a_rack_away_says_so() {
    let (mut floor, busy, job, chosen) = given_to_a_busy_robot();
    floor.step(vec![Input::ask(9, JobAction::Cancel(busy))]);
    assert_eq!(floor.why_waits(job), Some(JobWhy::RobotBusy(chosen, None)));
}

//! The fleet and single robots stand by hand, and go on; jobs change their order.

use super::*;

impl TestFloor {
    fn hand(&mut self, input: Input) -> Answered {
        self.step(vec![input]).replies.remove(0).answer
    }

    fn moves(&self, robot: RobotId) -> bool {
        self.world.truth().any(|(r, t)| r == robot && t.speed_mps > 0.01)
    }
}

const ALL: Option<RobotId> = None;
const R0: RobotId = RobotId(0);

#[test]
fn a_stopped_fleet_stands_over_a_restart_until_somebody_lets_it_go_on() {
    let mut floor = TestFloor::lab(2);
    let jobs = floor.submit_batch(2);
    floor.until(60, "a robot drives", |f| f.moves(R0));
    let step = floor.step(vec![Input::ask(4, FloorAction::Halt(ALL))]);
    assert_eq!(step.replies, [Reply { token: 4.into(), answer: Ok(Answer::Done) }]);
    let told = |r: u32| step.urgent.contains(&(RobotId(r), Command::Limit(Some(0.0))));
    assert!(told(0) && told(1), "stops leave at once: {:?}", step.urgent);
    assert_eq!(floor.hand(Input::ask(5, FloorAction::Halt(ALL))), Ok(Answer::Done));
    floor.run(5);
    assert!(floor.world.truth().all(|(_, t)| t.speed_mps == 0.0));
    assert_eq!(floor.fleet.why(R0), Some(Why::Stopped));
    let stopped = floor.fleet.view(floor.now).stopped;
    assert!(stopped.is_some_and(|t| t < floor.now - Span::from_secs(4)), "{stopped:?}");
    let halted = |f: &&Fact| matches!(f, Fact::Floor(FloorFact::Halted { .. }));
    assert_eq!(floor.facts.iter().filter(halted).count(), 1, "what is so already is no second fact");
    let (map, settings) = (floor.fleet.warehouse().clone(), floor.fleet.settings().clone());
    floor.fleet = Fleet::restore(map, settings, floor.facts.iter().cloned());
    assert_eq!(floor.fleet.view(floor.now).stopped, stopped);
    floor.run(10);
    assert!(floor.world.truth().all(|(_, t)| t.speed_mps == 0.0), "they stand after a restart, too");
    assert_eq!(floor.hand(Input::ask(6, FloorAction::Release(ALL))), Ok(Answer::Done));
    floor.until_over(600);
    floor.assert_done_once(&jobs);
}

#[test]
fn a_paused_robot_stands_alone_and_gets_no_job() {
    let mut floor = TestFloor::lab(2);
    floor.hand(Input::ask(4, FloorAction::Halt(Some(R0)))).unwrap();
    let jobs = floor.submit_batch(3);
    floor.until_over(900);
    floor.assert_done_once(&jobs);
    assert!(floor.is_idle(R0), "the other one did all of them");
    assert_eq!(floor.fleet.why(R0), Some(Why::Paused));
    floor.hand(Input::ask(5, FloorAction::Release(Some(R0)))).unwrap();
    assert_eq!(floor.fleet.why(R0), None);
    let unknown = floor.hand(Input::ask(6, FloorAction::Halt(Some(RobotId(9)))));
    assert_eq!(unknown, Err(Refusal::UnknownPlace));
}

#[test]
fn a_waiting_job_changes_its_priority_and_one_at_work_does_not() {
    let mut floor = TestFloor::lab(1);
    let first = floor.submit(request(deliver(3)));
    floor.until(60, "a robot has it", |f| f.is(first, "assigned"));
    let (second, third) = (floor.submit(request(deliver(8))), floor.submit(request(deliver(5))));
    let set = |job, priority| {
        let change = JobChange { priority: Some(priority), ..JobChange::default() };
        Input::ask(3, JobAction::Change(job, change))
    };
    assert_eq!(floor.hand(set(third, 9)), Ok(Answer::Done));
    let refused = |why| Err(why);
    assert_eq!(floor.hand(set(first, 9)), refused(Refusal::Job(JobRefusal::HasBegun(first))));
    assert_eq!(floor.hand(set(third, 10)), refused(Refusal::Job(JobRefusal::Priority(10))));
    assert_eq!(floor.hand(set(JobId(77), 1)), refused(Refusal::Job(JobRefusal::Unknown(JobId(77)))));
    floor.until_over(900);
    assert!(floor.when(third, "assigned") < floor.when(second, "assigned"), "it overtook");
    assert_eq!(floor.hand(set(second, 1)), refused(Refusal::Job(JobRefusal::IsOver(second))));
}

#[test]
fn a_waiting_job_changes_its_station_its_deadline_and_its_robot_whole_or_not_at_all() {
    let mut floor = TestFloor::lab(2);
    let first = floor.submit(request(deliver(3)));
    let after = |kind| JobRequest { after: vec![first], ..request(kind) };
    let second = floor.submit(after(deliver(8)));
    let go = JobKind::Park { robot: RobotId(0) };
    let third = floor.submit(after(go));
    let now = floor.now;
    let none = JobChange::default();
    let set = |job, change| Input::ask(3, JobAction::Change(job, change));
    let refused = |why| Err(why);
    let wanted = |floor: &TestFloor, job| floor.fleet.ledger().jobs[&job].request.clone();
    let before = wanted(&floor, second);

    let past = JobChange { deadline: Some(Some(Time(1))), priority: Some(4), ..none };
    assert_eq!(floor.hand(set(second, past)), refused(Refusal::Job(JobRefusal::DeadlineIsOver)));
    let robot = JobChange { robot: Some(RobotId(1)), priority: Some(4), ..none };
    assert_eq!(floor.hand(set(second, robot)), refused(Refusal::Job(JobRefusal::HasNoRobot("deliver"))));
    let nowhere = JobChange { station: Some(StationId(99)), priority: Some(4), ..none };
    assert_eq!(floor.hand(set(second, nowhere)), refused(Refusal::UnknownPlace));
    let station = JobChange { station: Some(StationId(0)), ..none };
    assert_eq!(floor.hand(set(third, station)), refused(Refusal::Job(JobRefusal::HasNoStation("park"))));
    assert_eq!(wanted(&floor, second), before, "nothing of a refused change is done");

    let deadline = now + Span::from_secs(3600);
    let other = StationId::at(floor.fleet.warehouse().stations.len() - 1);
    let all =
        JobChange { deadline: Some(Some(deadline)), station: Some(other), priority: Some(4), robot: None };
    assert_eq!(floor.hand(set(second, all)), Ok(Answer::Done));
    let changed = wanted(&floor, second);
    assert_eq!((changed.deadline, changed.priority), (Some(deadline), 4));
    assert_eq!((changed.kind.station(), changed.kind.rack()), (Some(other), before.kind.rack()));
    assert_eq!(floor.hand(set(second, JobChange { deadline: Some(None), ..none })), Ok(Answer::Done));
    assert_eq!(wanted(&floor, second), JobRequest { deadline: None, ..changed });
    assert_eq!(floor.hand(set(third, robot)), Ok(Answer::Done));
    assert_eq!(wanted(&floor, third).kind, JobKind::Park { robot: RobotId(1) });
    floor.until_over(900);
    assert_eq!(floor.done(), 3);
}

#[test]
fn a_batch_is_taken_in_one_step_and_each_job_for_itself() {
    let mut floor = TestFloor::lab(1);
    floor.step(vec![]);
    let keyed = |key: &str, kind| JobRequest { key: Some(key.into()), ..request(kind) };
    let late = JobRequest { deadline: Some(Time(1)), ..request(deliver(5)) };
    let requests = vec![keyed("a", deliver(3)), keyed("a", deliver(3)), late, keyed("b", deliver(8))];
    let step = floor.step(vec![Input::ask(5, JobAction::SubmitBatch(requests.clone()))]);
    let (first, second) = (JobId(1), JobId(2));
    let made = |id, new| Ok(Made { id, new });
    let results = vec![
        made(first, true),
        made(first, false),
        Err(Refusal::Job(JobRefusal::DeadlineIsOver)),
        made(second, true),
    ];
    assert_eq!(step.replies, [Reply { token: 5.into(), answer: Ok(Answer::Jobs(results)) }]);
    // A key is answered with its job even when the deadline has passed since.
    let again = requests.into_iter().map(|r| JobRequest { deadline: Some(Time(1)), ..r }).take(1).collect();
    let step = floor.step(vec![Input::ask(6, JobAction::SubmitBatch(again))]);
    assert_eq!(
        step.replies,
        [Reply { token: 6.into(), answer: Ok(Answer::Jobs(vec![Ok(Made { id: first, new: false })])) }]
    );
}

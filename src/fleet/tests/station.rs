//! Picks end when the station says so; a paused station gets no racks.

use super::*;

impl TestFloor {
    fn tell_station(&mut self, order: StationOrder) -> Answered {
        self.answer_to(5, vec![Input::ask(5, Request::Station(StationId(0), order))])
    }

    /// A delivery whose simulated picker takes very long, with the rack at the station.
    fn long_pick(robots: usize) -> (TestFloor, JobId) {
        let mut floor = TestFloor::lab(robots);
        let pick = Some(Span::from_secs(900));
        let job = floor.submit(request(JobKind::Deliver { rack: RackId(3), station: StationId(0), pick }));
        floor.until(300, "the rack is picked from", |f| f.is(job, "picking"));
        (floor, job)
    }
}

#[test]
fn a_pick_that_is_done_early_lets_its_robot_leave_at_once() {
    let (mut floor, job) = TestFloor::long_pick(1);
    floor.run(5);
    assert_eq!(floor.tell_station(StationOrder::Done), Ok(Answer::Done));
    assert_eq!(floor.story(job).last(), Some(&"done"));
    let node = floor.fleet.warehouse().stations[StationId(0)].node;
    let robot = RobotId::at(0);
    floor.until(5, "the robot has left", |f| f.fleet.ledger().node_of(robot) != node);
    floor.until(300, "it has nothing to do", TestFloor::first_robot_is_idle);
    floor.assert_stored(3);
}

#[test]
fn a_pick_with_missing_goods_fails_its_job_with_the_reason_and_the_rack_goes_back() {
    let (mut floor, job) = TestFloor::long_pick(1);
    floor.tell_station(StationOrder::Short).unwrap();
    let last = floor.progress(job).last().expect("it ended").0;
    assert_eq!(last, JobState::Failed(JobFailure::Short));
    floor.until(300, "it has nothing to do", TestFloor::first_robot_is_idle);
    floor.assert_stored(3);
    assert_eq!(floor.fleet.ledger().counts.robot_deliveries, 0, "nothing was served");
}

#[test]
fn a_cancelled_pick_lets_its_robot_leave_at_once() {
    let (mut floor, job) = TestFloor::long_pick(1);
    floor.cancel(job).unwrap();
    let node = floor.fleet.warehouse().stations[StationId(0)].node;
    floor.until(5, "the robot has left", |f| f.fleet.ledger().node_of(RobotId::at(0)) != node);
    floor.until(300, "it has nothing to do", TestFloor::first_robot_is_idle);
    floor.assert_stored(3);
}

#[test]
fn the_next_robot_goes_on_when_a_long_pick_is_cancelled() {
    let (mut floor, job) = TestFloor::long_pick(2);
    let next = floor.submit(request(JobKind::Deliver { rack: RackId(1), station: StationId(0), pick: None }));
    floor.run(60);
    let second = RobotId::at(1);
    let place = |f: &TestFloor, robot: RobotId| {
        f.world.truth().find(|(r, _)| *r == robot).expect("it is there").1.pose.at
    };
    let waits = [0, 1].map(|r| place(&floor, RobotId::at(r)));
    floor.run(5);
    assert_eq!(waits, [0, 1].map(|r| place(&floor, RobotId::at(r))), "both stand");
    floor.cancel(job).unwrap();
    let cancelled = floor.now;
    floor.until(2, "the second robot moves", |f| (place(f, second) - waits[1]).norm() > 0.02);
    floor.until(30, "it is served", |f| f.state(next).is_none());
    assert!(floor.now - cancelled < Span::from_secs(30), "not when the pick was to end");
}

#[test]
fn where_nothing_is_picked_no_pick_can_end() {
    let mut floor = TestFloor::lab(1);
    let why = Refusal::Pick(PickRefusal::NothingThere(StationId(0)));
    for order in [StationOrder::Done, StationOrder::Short] {
        assert_eq!(floor.tell_station(order), Err(why));
    }
}

#[test]
fn a_paused_station_gets_no_racks_until_it_goes_on() {
    let mut floor = TestFloor::lab(2);
    floor.tell_station(StationOrder::Pause).unwrap();
    floor.tell_station(StationOrder::Pause).unwrap();
    let job = floor.submit(request(deliver(3)));
    floor.run(60);
    assert!(floor.is(job, "waiting"));
    let why =
        floor.fleet.view(floor.now).why_job(floor.fleet.warehouse(), job, &floor.fleet.ledger().jobs[&job]);
    assert_eq!(why, Some(JobWhy::StationPaused(StationId(0))));
    floor.tell_station(StationOrder::Resume).unwrap();
    floor.until_over(300);
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn a_slow_picker_delays_and_nothing_else_breaks() {
    let mut floor = TestFloor::lab(4);
    let slow = JobKind::Deliver { rack: RackId(2), station: StationId(0), pick: Some(Span::from_secs(400)) };
    let first = floor.submit(request(slow));
    let others: Vec<JobId> = (3..7).map(|k| floor.submit(request(deliver(k)))).collect();
    floor.until_over(3_000);
    floor.assert_done_once(&[first]);
    floor.assert_done_once(&others);
}

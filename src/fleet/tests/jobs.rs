//! Jobs of every kind, from the request to the end; priorities, order, keys and refusals.

use super::*;

#[test]
fn a_delivery_goes_through_its_states_once_and_the_rack_comes_back_to_storage() {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(request(deliver(3)));
    floor.until_over(300);
    assert_eq!(floor.story(job), ["assigned", "carrying", "picking", "done"]);
    let RackAt::On(robot) = floor.rack(3) else {
        panic!("a delivery is done while the rack is still on its robot")
    };
    floor.until(300, "the robot has nothing to do", |f| f.is_idle(robot));
    floor.assert_stored(3);
    assert_eq!(floor.story(job).len(), 4, "nothing happens to a job that is over");
    assert_eq!(floor.fleet.ledger().served[StationId(0)], 1);
}

#[test]
fn the_pick_takes_as_long_as_the_customer_said() {
    let mut floor = TestFloor::lab(1);
    let kind = JobKind::Deliver { rack: RackId(0), station: StationId(0), pick: Some(Span::from_secs(40)) };
    let job = floor.submit(request(kind));
    floor.until_over(300);
    let picked = floor.when(job, "done") - floor.when(job, "picking");
    assert!(picked >= Span::from_secs(39) && picked < Span::from_secs(43), "it took {picked:?}");
}

#[test]
fn the_same_key_makes_no_second_job_not_even_when_the_first_is_over() {
    let mut floor = TestFloor::lab(1);
    let keyed = JobRequest { key: Some("order 1".into()), ..request(deliver(3)) };
    let job = floor.submit(keyed.clone());
    assert_eq!(floor.ask(keyed.clone()), Ok(Answer::Job(Made { id: job, new: false })));
    floor.until_over(300);
    assert_eq!(floor.ask(keyed), Ok(Answer::Job(Made { id: job, new: false })));
    floor.run(100);
    assert_eq!((floor.done(), floor.fleet.ledger().next_job), (1, 2));
    let other = JobRequest { key: Some("order 2".into()), ..request(deliver(3)) };
    assert_ne!(floor.submit(other), job);
}

#[test]
fn an_urgent_job_overtakes_those_that_waited_before() {
    let mut floor = TestFloor::lab(1);
    let usual: Vec<JobId> = (0..4).map(|k| floor.submit(request(deliver(k)))).collect();
    let urgent = floor.submit(JobRequest { priority: 9, ..request(deliver(11)) });
    floor.until_over(2000);
    let first = *usual.iter().min_by_key(|j| floor.when(**j, "assigned")).expect("four of them");
    for job in usual.into_iter().filter(|j| *j != first) {
        assert!(floor.when(urgent, "assigned") < floor.when(job, "assigned"), "{job:?} came before");
        assert!(floor.when(urgent, "done") < floor.when(job, "done"), "{job:?} came before");
    }
}

#[test]
fn the_backlog_has_the_most_urgent_jobs_first_and_no_more_than_asked_for() {
    let mut floor = TestFloor::lab(1);
    floor.submit(JobRequest { priority: 9, ..request(deliver(0)) });
    floor.until(300, "the robot has the first one", |f| f.fleet.backlog(9, f.now).jobs.is_empty());
    let low: Vec<JobId> = (1..6).map(|rack| floor.submit(request(deliver(rack)))).collect();
    let high = floor.submit(JobRequest { priority: 5, ..request(deliver(7)) });
    let later = floor.submit(JobRequest { priority: 7, after: vec![high], ..request(deliver(8)) });
    let backlog = floor.fleet.backlog(4, floor.now);
    let jobs: Vec<JobId> = backlog.jobs.iter().map(|p| p.job).collect();
    assert_eq!(jobs, [later, high, low[0], low[1]]);
    assert_eq!((backlog.at, backlog.jobs[0].after, backlog.jobs[1].after), (floor.now, Some(high), None));
    assert_eq!((backlog.jobs[2].kind, backlog.jobs[2].priority), (deliver(1), 0));
    assert!(backlog.jobs[2].accepted < floor.now);
    assert_eq!(floor.fleet.backlog(100, floor.now).jobs.len(), 7);
    assert!(floor.fleet.backlog(0, floor.now).jobs.is_empty());
    // The robot takes them in this order.
    let order = |f: &TestFloor, job| f.state(job).is_some_and(|s| s.robot().is_some());
    floor.until(600, "the next one is taken", |f| order(f, high) || order(f, low[0]));
    assert!(order(&floor, high));
}

/// One robot has `picks` long picks of high priority to do, while three jobs wait; during the last pick, a job comes
/// that is due `due` seconds later.
fn with_a_deadline(picks: u32, due: i64) -> (TestFloor, Vec<JobId>, JobId, Time) {
    let mut floor = TestFloor::lab(1);
    let long = |rack| {
        let pick = Some(Span::from_secs(500));
        let kind = JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick };
        JobRequest { priority: 9, ..request(kind) }
    };
    let before: Vec<JobId> = (0..picks).map(|rack| floor.submit(long(rack))).collect();
    let old = [4, 5, 6].map(|rack| floor.submit(request(deliver(rack)))).to_vec();
    let nearly = |f: &TestFloor| before.iter().all(|j| f.is(*j, "picking") || f.state(*j).is_none());
    floor.until(2_000, "the last long pick", nearly);
    floor.run(450);
    let deadline = floor.now + Span::from_secs(due);
    let urgent = floor.submit(JobRequest { deadline: Some(deadline), ..request(deliver(11)) });
    floor.until_over(2_000);
    (floor, old, urgent, deadline)
}

#[test]
fn a_job_with_a_near_deadline_overtakes_older_ones_and_makes_it() {
    for picks in [1, 3] {
        let (floor, old, urgent, deadline) = with_a_deadline(picks, 240);
        for job in old {
            let (first, then) = (floor.when(urgent, "assigned"), floor.when(job, "assigned"));
            assert!(first < then, "after {picks} picks: {job:?}");
        }
        assert!(floor.when(urgent, "done") <= deadline, "after {picks} picks");
    }
}

#[test]
fn a_deadline_that_is_far_away_overtakes_nobody() {
    let (floor, old, urgent, deadline) = with_a_deadline(3, 3_600);
    for job in old {
        assert!(floor.when(urgent, "assigned") > floor.when(job, "assigned"), "{job:?}");
    }
    assert!(floor.when(urgent, "done") <= deadline);
}

#[test]
fn a_job_after_another_starts_only_when_that_is_over() {
    let mut floor = TestFloor::lab(2);
    let first = floor.submit(request(deliver(3)));
    let second = floor.submit(JobRequest { after: vec![first], ..request(deliver(8)) });
    floor.until_over(900);
    assert!(floor.when(second, "assigned") >= floor.when(first, "done"));
    assert_eq!(floor.story(second), ["assigned", "carrying", "picking", "done"]);
}

#[test]
fn without_after_two_robots_work_at_once() {
    let mut floor = TestFloor::lab(2);
    let first = floor.submit(request(deliver(3)));
    let second = floor.submit(request(deliver(8)));
    floor.until_over(900);
    assert!(floor.when(second, "assigned") < floor.when(first, "done"));
}

#[test]
fn cancelling_a_job_fails_those_that_wait_for_it_and_those_that_wait_for_them() {
    let mut floor = TestFloor::lab(1);
    let first = floor.submit(request(deliver(3)));
    let second = floor.submit(JobRequest { after: vec![first], ..request(deliver(8)) });
    let third = floor.submit(JobRequest { after: vec![second], ..request(deliver(9)) });
    let apart = floor.submit(request(deliver(1)));
    assert_eq!(floor.cancel(first), Ok(Answer::Done));
    floor.until_over(600);
    let last = |j| floor.progress(j).last().expect("something happened").0;
    assert_eq!(last(second), JobState::Failed(JobFailure::Predecessor(first)));
    assert_eq!(last(third), JobState::Failed(JobFailure::Predecessor(second)));
    assert_eq!(last(apart), JobState::Done);
}

#[test]
fn a_relocated_rack_stands_where_it_was_to_stand() {
    let mut floor = TestFloor::thesis(2);
    let node = floor.free_storage();
    assert_ne!(floor.rack(40), RackAt::Stored(node));
    let job = floor.submit(request(JobKind::Relocate { rack: RackId(40), node }));
    floor.until_over(600);
    assert_eq!(floor.story(job), ["assigned", "carrying", "done"]);
    assert_eq!(floor.rack(40), RackAt::Stored(node));
}

#[test]
fn a_returned_rack_stands_on_storage() {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(request(JobKind::Return { rack: RackId(5) }));
    floor.until_over(600);
    assert_eq!(floor.story(job), ["assigned", "carrying", "done"]);
    floor.assert_stored(5);
}

#[test]
fn robots_go_where_they_are_sent_and_do_not_stay_where_they_must_not() {
    let mut floor = TestFloor::lab(1);
    let (robot, street) = (RobotId::at(0), floor.node("R117"));
    let job = floor.submit(request(JobKind::Go { robot, node: street }));
    floor.until(300, "it is there", |f| f.fleet.ledger().node_of(robot) == street);
    floor.until_over(10);
    assert_eq!(floor.story(job), ["assigned", "done"]);
    floor.until(300, "it has nothing to do", |f| f.is_idle(robot));
    let stands = floor.fleet.warehouse().nodes[floor.fleet.ledger().node_of(robot)].kind;
    assert!(stands.is_lasting(), "it stands on {stands:?}");
}

#[test]
fn robots_park_and_charge_when_they_are_told_to() {
    let mut floor = TestFloor::lab(1);
    let robot = RobotId::at(0);
    for (kind, wanted) in
        [(JobKind::Park { robot }, NodeKind::Parking), (JobKind::Charge { robot }, NodeKind::Charger)]
    {
        floor.until(300, "it has nothing to do", TestFloor::first_robot_is_idle);
        let job = floor.submit(request(kind));
        floor.until_over(300);
        assert_eq!(floor.story(job), ["assigned", "done"], "{kind:?}");
        let stands = floor.fleet.warehouse().nodes[floor.fleet.ledger().node_of(robot)].kind;
        assert_eq!(stands, wanted);
    }
}

#[track_caller]
fn check_refused(floor: &mut TestFloor, request: JobRequest, why: Refusal) {
    let next = floor.fleet.ledger().next_job;
    assert_eq!(floor.ask(request), Err(why));
    assert_eq!(floor.fleet.ledger().next_job, next, "what is refused is no job");
}

#[test]
fn what_cannot_be_done_is_refused_with_a_reason() {
    let mut floor = TestFloor::thesis(1);
    let (rack, robot) = (RackId(0), RobotId::at(0));
    let racks = floor.fleet.warehouse().racks.len() as u32;
    let nodes = NodeId::at(floor.fleet.warehouse().nodes.len());
    let station = StationId::at(floor.fleet.warehouse().stations.len());
    for kind in [
        deliver(racks),
        JobKind::Deliver { rack, station, pick: None },
        JobKind::Return { rack: RackId(racks) },
        JobKind::Relocate { rack, node: nodes },
        JobKind::Charge { robot: RobotId::at(1) },
        JobKind::Park { robot: RobotId::at(1) },
        JobKind::Go { robot: RobotId::at(1), node: NodeId(0) },
        JobKind::Go { robot, node: nodes },
    ] {
        check_refused(&mut floor, request(kind), Refusal::UnknownPlace);
    }
    let street = floor.node("G3-3");
    let relocate = |node| request(JobKind::Relocate { rack, node });
    check_refused(&mut floor, relocate(street), Refusal::Rack(RackRefusal::NotStorage(street)));
    let RackAt::Stored(taken) = floor.rack(1) else { panic!("racks are at home at first") };
    check_refused(&mut floor, relocate(taken), Refusal::Rack(RackRefusal::StorageTaken(taken)));
    check_refused(
        &mut floor,
        JobRequest { priority: 10, ..request(deliver(0)) },
        Refusal::Job(JobRefusal::Priority(10)),
    );
    let after = |job| JobRequest { after: vec![job], ..request(deliver(0)) };
    check_refused(&mut floor, after(JobId(9)), Refusal::Job(JobRefusal::UnknownPredecessor(JobId(9))));
    assert_eq!(floor.cancel(JobId(1)), Err(Refusal::Job(JobRefusal::Unknown(JobId(1)))));
}

#[test]
fn a_job_that_one_robot_alone_can_do_is_not_lost_behind_a_hundred_others() {
    let kiva = giveway_floor::warehouse::formats::json::parse(include_str!("../../../maps/kiva.json"))
        .expect("is a map");
    let mut floor = TestFloor::new(kiva, &scenario(200));
    // Robots that begin beneath racks, behind more idle robots than a step matches.
    let beneath = |r: usize| {
        let node = floor.fleet.ledger().node_of(RobotId::at(r));
        floor.fleet.ledger().racks.pairs().find(|(_, at)| **at == RackAt::Stored(node)).map(|(rack, _)| rack)
    };
    let racks: Vec<RackId> = (150..200).filter_map(beneath).collect();
    assert!(racks.len() > 10, "{}", racks.len());
    let jobs: Vec<JobId> = racks.iter().map(|rack| floor.submit(request(deliver(rack.0)))).collect();
    floor.run(1);
    let begun = jobs.iter().filter(|job| !floor.is(**job, "waiting")).count();
    assert!(begun >= 5, "{begun} of {}: as many as the station has places", jobs.len());
}

#[test]
fn robots_choose_among_all_jobs_that_are_as_urgent_and_do_not_crowd_where_a_stock_count_begins() {
    let kiva = giveway_floor::warehouse::formats::json::parse(include_str!("../../../maps/kiva.json"))
        .expect("is a map");
    let mut floor = TestFloor::new(kiva, &scenario(50));
    // Each rack once, in the order of the map.
    let jobs = (0..600).map(|rack| Input::ask(7, JobAction::Submit(request(deliver(rack)))));
    floor.step(jobs.collect());
    floor.run(1);
    let fetched = floor.fleet.ledger().robots.iter().filter_map(|robot| match robot.task {
        Task::Fetch { rack, .. } => Some(rack.0),
        _ => None,
    });
    let (near, far): (Vec<u32>, Vec<u32>) = fetched.partition(|rack| *rack < 300);
    assert!(near.len() + far.len() > 20 && far.len() > 5, "{near:?} {far:?}");
}

#[test]
fn a_robot_that_rests_where_another_is_sent_makes_way() {
    let mut floor = TestFloor::thesis(2);
    let parking = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Parking)[0];
    let [a, b] = [0, 1].map(RobotId::at);
    let there = floor.submit(request(JobKind::Go { robot: a, node: parking }));
    floor.until(300, "it rests there", |f| f.state(there).is_none());
    let go = floor.submit(request(JobKind::Go { robot: b, node: parking }));
    floor.until(300, "the other one was there", |f| f.state(go).is_none());
    floor.assert_done_once(&[there, go]);
}

#[test]
fn a_robot_comes_to_where_another_rests_though_more_rest_on_the_straight_way() {
    let mut floor = TestFloor::thesis(6);
    let rests: Vec<NodeId> = (1..=6).map(|y| floor.node(&format!("S1-{y}"))).collect();
    let rest = |robot: usize| request(JobKind::Go { robot: RobotId::at(robot), node: rests[robot] });
    // The innermost robot first, so that no robot is in another's way.
    let there: Vec<JobId> = [5, 4, 3, 2, 1, 0].map(|robot| floor.submit(rest(robot))).to_vec();
    floor.until(600, "all rest", |f| there.iter().all(|job| f.state(*job).is_none()));
    floor.until(60, "all are idle", |f| (0..6).all(|r| f.is_idle(RobotId::at(r))));
    let go = floor.submit(request(JobKind::Go { robot: RobotId::at(0), node: rests[5] }));
    floor.until(120, "it was there", |f| f.state(go).is_none());
    floor.assert_done_once(&[go]);
}

#[test]
fn of_robots_that_are_sent_to_one_node_one_goes_and_another_does_other_jobs_meanwhile_and_says_so() {
    let mut floor = TestFloor::thesis(2);
    let parking = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Parking)[0];
    let [a, b] = [0, 1].map(RobotId::at);
    let [first, second] = [a, b].map(|robot| floor.submit(request(JobKind::Go { robot, node: parking })));
    let delivery = floor.submit(request(deliver(3)));
    floor.run(2);
    assert!(floor.is(first, "assigned") && floor.is(second, "waiting"), "{:?}", floor.state(second));
    assert_eq!(floor.state(delivery).and_then(|state| state.robot()), Some(b));
    floor.until(300, "it rests there", |f| f.state(first).is_none());
    floor.until_over(600);
    floor.assert_done_once(&[first, second, delivery]);
}

#[test]
fn a_job_that_sends_a_robot_where_another_is_going_to_stay_says_which_one() {
    let mut floor = TestFloor::thesis(2);
    let parking = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Parking)[0];
    let [a, b] = [0, 1].map(RobotId::at);
    let [_, second] = [a, b].map(|robot| floor.submit(request(JobKind::Go { robot, node: parking })));
    floor.run(2);
    let (view, job) = (floor.fleet.view(floor.now), &floor.fleet.ledger().jobs[&second]);
    let why = view.why_job(floor.fleet.warehouse(), second, job);
    assert_eq!(why, Some(JobWhy::NodeTaken(parking, a)));
}

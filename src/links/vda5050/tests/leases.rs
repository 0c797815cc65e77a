//! Leases: what robots of 3.0 ask for, and what they are answered.

use super::corridors::free;
use super::*;
use giveway_fleet::{Command, FloorAction};
use giveway_vda5050::{Grant, Request, RequestStatus, RequestSubject, Response, State};

impl LinkFloor {
    /// The answers to the first robot since a time.
    pub(super) fn answers(&self, since: Time) -> Vec<Response> {
        let told = self.pairs[0].told.iter().filter(|(at, ..)| *at >= since);
        let answers = told.filter_map(|(.., message)| match message {
            Message::Responses(responses) => Some(responses.clone()),
            _ => None,
        });
        answers.flatten().collect()
    }

    fn grants(&self, since: Time) -> Vec<Grant> {
        self.answers(since).iter().map(|response| response.grant).collect()
    }

    /// What the first robot says of its requests.
    fn asks(&self) -> Vec<RequestStatus> {
        self.pairs[0].robot.robot.state().requests.iter().map(|request| request.status).collect()
    }

    /// A slow robot in a lane with a corridor, with something in its way.
    fn obstructed() -> (LinkFloor, JobId) {
        let mut slow = standard(Version::V3_0);
        slow.body.speed_mps = 0.08;
        let mut floor = free(slow);
        let job = floor.go("end");
        floor.until(120, "it is on a lane with a corridor", |f| f.pairs[0].place().0 > 0.2);
        floor.pairs[0].robot.robot.set_obstructed(true);
        (floor, job)
    }

    /// Nothing is in the robot's way any more: it gets to where it was to go.
    fn ends(&mut self, job: JobId) {
        self.pairs[0].robot.robot.set_obstructed(false);
        self.until_done(&[job], 1800);
    }

    /// The session hears a state of the robot with these requests. Gives the answers.
    fn hears_requests(&mut self, requests: Vec<Request>) -> Vec<Response> {
        let since = self.now;
        let state = State { requests, ..self.pairs[0].robot.robot.state() };
        let stamp = MessageStamp { id: self.pairs[0].next, timestamp: format!("{:020}", self.now.0) };
        let heard = RobotHeard::State(Box::new(state), stamp);
        let out = self.pairs[0].session.hear(self.now, heard);
        self.take(0, out, &mut Vec::new());
        self.answers(since)
    }

    /// The edge on which the first robot is, as its order has it.
    fn edge_driven(&self) -> (String, u32) {
        let state = self.pairs[0].robot.robot.state();
        let edge = state.edges.first().expect("it drives");
        (edge.id.clone(), edge.sequence)
    }
}

fn about(id: &str, edge: &str, sequence: u32) -> Request {
    let subject = RequestSubject::Corridor { edge: edge.to_owned(), sequence };
    Request { id: id.to_owned(), subject, status: RequestStatus::Requested }
}

#[test]
fn a_robot_that_asks_leaves_the_line_by_a_lease_that_is_renewed_until_it_is_past() {
    let (mut floor, job) = LinkFloor::obstructed();
    let begun = floor.now;
    floor.until(5, "it is granted", |f| f.asks() == [RequestStatus::Granted]);
    let (id, until) = (floor.answers(begun)[0].request.clone(), floor.answers(begun)[0].until_us);
    assert!(
        until > Some((floor.now + Span::from_secs(25)).0)
            && until <= Some((floor.now + Span::from_secs(30)).0)
    );
    floor.run(40);
    assert_eq!(floor.asks(), [RequestStatus::Granted], "longer than one lease");
    let renewed: Vec<Response> =
        floor.answers(begun).into_iter().filter(|answer| answer.request == id).collect();
    assert!((3..=6).contains(&renewed.len()), "{renewed:?}");
    assert!(renewed.windows(2).all(|pair| pair[0].until_us < pair[1].until_us));
    floor.pairs[0].robot.robot.set_obstructed(false);
    floor.until(5, "it asks no more", |f| f.asks().is_empty());
    floor.run(5);
    let past = floor.now;
    floor.run(15);
    assert_eq!(floor.grants(past), [], "what is not asked for is not renewed");
    floor.ends(job);
}

#[test]
fn a_limit_revokes_the_lease_in_the_same_turn_and_it_counts_until_the_state_confirms_it() {
    let (mut floor, job) = LinkFloor::obstructed();
    floor.until(5, "it is granted", |f| f.asks() == [RequestStatus::Granted]);
    let out = floor.pairs[0].session.command(floor.now, &Command::Limit(Some(0.5)));
    let revokes =
        |told: &RobotTold| matches!(&told.message, Message::Responses(r) if r[0].grant == Grant::Revoked);
    assert!(out.told.iter().any(revokes), "{out:?}");
    // The first answer is lost.
    floor.now += PERIOD;
    let since = floor.now;
    assert_eq!(floor.pairs[0].session.leases.held(), 1, "it counts");
    assert!(floor.pairs[0].session.order_text().ends_with("may leave its line"));
    while floor.asks() != [RequestStatus::Revoked] {
        assert!(floor.now - since < Span::from_secs(5), "it is told again");
        let out = floor.pairs[0].session.command(floor.now, &Command::Limit(Some(0.5)));
        floor.take(0, out, &mut Vec::new());
        floor.hear(0, &mut Vec::new());
        floor.now += PERIOD;
    }
    floor.hear(0, &mut Vec::new());
    floor.now += PERIOD * 3;
    floor.hear(0, &mut Vec::new());
    assert_eq!(floor.pairs[0].session.leases.held(), 0, "the state has confirmed it");
    let state = floor.pairs[0].robot.robot.state();
    assert!(
        state.errors.iter().any(|error| error.kind == "RELEASE_LOST") && floor.pairs[0].speed_mps() == 0.0
    );
    let out = floor.pairs[0].session.command(floor.now, &Command::Limit(None));
    floor.take(0, out, &mut Vec::new());
    floor.until(20, "it asks anew", |f| f.asks() == [RequestStatus::Granted]);
    assert!(floor.pairs[0].robot.robot.state().errors.is_empty());
    floor.ends(job);
    assert_eq!(floor.notices(0), [""; 0]);
}

#[test]
fn a_robot_that_is_to_stand_is_refused_and_gets_its_lease_when_it_may_go_on() {
    let (mut floor, job) = LinkFloor::obstructed();
    floor.pairs[0].robot.robot.set_obstructed(false);
    floor.step(vec![Input::ask(5, FloorAction::Halt(None))]);
    floor.run(2);
    floor.pairs[0].robot.robot.set_obstructed(true);
    let since = floor.now;
    floor.run(20);
    let answers = floor.grants(since);
    assert!(answers.len() >= 2 && answers.iter().all(|grant| *grant == Grant::Rejected), "{answers:?}");
    floor.step(vec![Input::ask(5, FloorAction::Release(None))]);
    floor.until(20, "it is granted", |f| f.asks() == [RequestStatus::Granted]);
    floor.ends(job);
}

#[test]
fn only_released_edges_with_a_corridor_are_granted_under_their_own_names() {
    let (mut floor, _job) = LinkFloor::obstructed();
    floor.pairs[0].robot.robot.set_obstructed(false);
    floor.run(1);
    let (edge, sequence) = floor.edge_driven();
    let announced = {
        let state = floor.pairs[0].robot.robot.state();
        let edge = state.edges.iter().find(|edge| !edge.released).expect("a horizon").clone();
        (edge.id, edge.sequence)
    };
    let asked = vec![
        about("right", &edge, sequence),
        about("announced", &announced.0, announced.1),
        about("behind", "home-n0", 1),
        about("node", &edge, sequence - 1),
        about("other name", "n3-n4", sequence),
        about("far", &edge, u32::MAX),
        about("", "", 0),
    ];
    let answers = floor.hears_requests(asked);
    let granted = |id: &str| answers.iter().find(|answer| answer.request == id).map(|answer| answer.grant);
    assert_eq!(granted("right"), Some(Grant::Granted));
    for id in ["announced", "behind", "node", "other name", "far", ""] {
        assert_eq!(granted(id), Some(Grant::Rejected), "{id:?}");
    }
}

#[test]
fn access_to_a_release_zone_is_granted_by_the_same_rule_and_another_way_through_one_is_not() {
    let (mut floor, _job) = LinkFloor::obstructed();
    floor.pairs[0].robot.robot.set_obstructed(false);
    floor.run(1);
    let zone = |id: &str, replanning| {
        let subject = RequestSubject::Zone { zone: "z".into(), zone_set: "s".into(), replanning };
        Request { id: id.into(), subject, status: RequestStatus::Requested }
    };
    let answers = floor.hears_requests(vec![zone("enter", false), zone("replan", true)]);
    let said: Vec<(&str, Grant)> = answers.iter().map(|a| (a.request.as_str(), a.grant)).collect();
    assert_eq!(said, [("enter", Grant::Granted), ("replan", Grant::Rejected)]);
}

#[test]
fn thousands_of_requests_are_neither_remembered_nor_answered() {
    let (mut floor, job) = LinkFloor::obstructed();
    floor.pairs[0].robot.robot.set_obstructed(false);
    floor.run(1);
    let (edge, sequence) = floor.edge_driven();
    for round in 0..20 {
        let id = |i: u32| format!("{round}-{i}");
        let answers = floor.hears_requests((0..5_000).map(|i| about(&id(i), &edge, sequence)).collect());
        assert_eq!(answers.len(), 32);
        assert_eq!(floor.pairs[0].session.leases.held(), 32);
        floor.now += PERIOD;
    }
    // One id many times is one request.
    let same = (0..5_000).map(|_| about("same", &edge, sequence)).collect();
    assert_eq!(floor.hears_requests(same).len(), 1);
    assert_eq!(floor.pairs[0].session.leases.held(), 1);
    floor.ends(job);
}

#[test]
fn a_lease_of_a_process_that_died_goes_on_with_the_next_one() {
    let (mut floor, job) = LinkFloor::obstructed();
    floor.until(5, "it is granted", |f| f.asks() == [RequestStatus::Granted]);
    floor.restart();
    let since = floor.now;
    floor.until(10, "it is renewed", |f| !f.answers(since).is_empty());
    floor.run(20);
    assert!(floor.asks().iter().all(|status| *status == RequestStatus::Granted), "{:?}", floor.asks());
    floor.ends(job);
}

#[test]
fn leases_hold_what_they_promise_when_messages_are_lost_doubled_and_late() {
    for seed in 1..=6 {
        let (mut floor, job) = LinkFloor::obstructed();
        floor.chance = Chance { state: seed, lost: 0.1, doubled: 0.1, late_ms: 400.0 };
        floor.until(1200, "it is at the end of the corridor", |f| f.pairs[0].place().0 > 17.0);
        floor.ends(job);
        // Nothing was ever granted for longer than the lease, and the robot was never on its own for longer.
        let told = floor.pairs[0].told.iter();
        for (at, _, message) in told {
            let Message::Responses(responses) = message else { continue };
            let latest = responses.iter().filter_map(|response| response.until_us).max();
            assert!(latest.is_none_or(|until| until == (*at + Span::from_secs(30)).0));
        }
        assert!(floor.grants(Time::ZERO).contains(&Grant::Granted));
    }
}

//! Turns at stations and chargers: in the order of lifting; promises to robots that cannot come lapse.

use super::*;
use giveway_sim::Closing;

fn crowd() -> TestFloor {
    let mut floor = TestFloor::new(thesis(), &scenario(14));
    for rack in 0..14 {
        floor.submit(request(deliver(rack * 5)));
    }
    floor
}

impl TestFloor {
    /// Robots that have lifted racks for a station, and have a route there.
    fn with_a_place(&self) -> Vec<RobotId> {
        let floor = self.fleet.internals().writer.floor();
        let tickets = self.fleet.internals().traffic.needs.tickets.all();
        tickets.map(|(robot, _)| robot).filter(|r| !floor.lacks_route(*r)).collect()
    }
}

#[test]
fn places_at_a_station_are_given_in_the_order_of_lifting() {
    let mut floor = crowd();
    let (mut given, mut had_to_wait) = (0, 0);
    for _ in 0..3000 {
        let waiting: Vec<(Time, RobotId)> = (floor.fleet.internals().traffic.needs.tickets.all())
            .filter(|(r, _)| floor.fleet.internals().writer.floor().lacks_route(*r))
            .map(|(r, ticket)| (ticket.since, r))
            .collect();
        had_to_wait = had_to_wait.max(waiting.len());
        let before = floor.with_a_place();
        floor.step(vec![]);
        let new: Vec<RobotId> = floor.with_a_place().into_iter().filter(|r| !before.contains(r)).collect();
        let since = |r: &RobotId| waiting.iter().find(|(_, w)| w == r).map(|(since, _)| *since);
        for robot in &new {
            let Some(own) = since(robot) else { continue };
            let passed: Vec<_> =
                waiting.iter().filter(|(t, w)| (*t, *w) < (own, *robot) && !new.contains(w)).collect();
            assert!(passed.is_empty(), "{robot:?} overtakes {passed:?} at {:?}", floor.now);
            given += 1;
        }
    }
    assert!(given >= 5 && had_to_wait >= 3, "{given} places were given, {had_to_wait} waited at a time");
}

#[test]
fn a_station_is_said_to_be_full_only_while_a_robot_stands_in_every_place_of_it() {
    let mut floor = TestFloor::new(thesis(), &scenario(14));
    // Picks that last so long that the line fills up behind them.
    let pick = Some(Span::from_secs(60));
    for rack in 0..14 {
        let kind = JobKind::Deliver { rack: RackId(rack * 5), station: StationId(0), pick };
        floor.submit(request(kind));
    }
    let (mut full, mut turns) = (0, 0);
    for _ in 0..6000 {
        floor.step(vec![]);
        let node = floor.fleet.warehouse().stations[StationId(0)].node;
        let queue = floor.fleet.warehouse().stations[StationId(0)].queue.clone();
        let stands = |n: &NodeId| (0..14).map(RobotId::at).any(|r| floor.fleet.ledger().node_of(r) == *n);
        let there = queue.iter().chain([&node]).filter(|n| stands(n)).count();
        for robot in (0..14).map(RobotId::at) {
            match floor.fleet.why(robot) {
                Some(Why::QueueFull(_)) => {
                    assert_eq!(there, queue.len() + 1, "at {:?}", floor.now);
                    full += 1;
                }
                Some(Why::NotItsTurn(_, first)) => {
                    let edge = floor.fleet.wait(Party::Robot(robot)).edge;
                    assert_eq!(
                        edge,
                        Edge::On(Party::Robot(first)),
                        "the chain goes on with who comes before it"
                    );
                    turns += 1;
                }
                _ => {}
            }
        }
    }
    assert!(full > 0 && turns > 0, "full {full}, turns {turns}");
}

#[test]
fn a_robot_outside_a_station_at_which_nobody_picks_says_so() {
    let mut floor = crowd();
    let outside =
        |f: &TestFloor| (0..14).map(RobotId::at).find(|r| f.fleet.why(*r).and_then(Why::station).is_some());
    floor.until(120, "one waits outside", |f| outside(f).is_some());
    let robot = outside(&floor).expect("just seen");
    floor.step(vec![Input::ask(4, Request::Station(StationId(0), StationOrder::Pause))]);
    assert_eq!(floor.fleet.why(robot), Some(Why::StationPaused(StationId(0))));
    assert_eq!(floor.fleet.wait(Party::Robot(robot)).edge, Edge::Operator);
}

#[test]
fn a_place_that_was_promised_to_robots_that_cannot_come_goes_to_others_after_a_minute() {
    let mut floor = crowd();
    let mut paused = Vec::new();
    while paused.len() < 5 {
        let next = floor.with_a_place().into_iter().find(|r| !paused.contains(r));
        match next {
            Some(robot) => {
                floor.step(vec![Input::ask(4, FloorAction::Halt(Some(robot)))]);
                paused.push(robot);
            }
            None => drop(floor.step(vec![])),
        }
    }
    floor.run(40);
    assert_eq!(floor.fleet.ledger().counts.robot_deliveries, 0, "all places are promised");
    let waits = |r: RobotId| matches!(floor.fleet.why(r), Some(Why::NotItsTurn(..)));
    assert!((0..14).map(RobotId::at).any(waits), "others wait for room");
    floor.until(120, "another robot delivers", |f| f.fleet.ledger().counts.robot_deliveries > 0);
    for robot in &paused {
        floor.step(vec![Input::ask(5, FloorAction::Release(Some(*robot)))]);
    }
    floor.until_over(3600);
    assert_eq!(floor.fleet.ledger().counts.robot_deliveries, 14, "those that had been paused came after all");
}

/// Two robots in the hall of the thesis with one charger, to which one of them is on its way.
fn one_charger() -> (TestFloor, RobotId, NodeId) {
    let closed = (2..=10).map(|i| format!("C{i}-15")).collect();
    let closing = Closing { nodes: closed, ..Closing::default() };
    let scenario = Scenario { closures: vec![closing], ..scenario(2) };
    let mut floor = TestFloor::new(thesis(), &scenario);
    floor.run(5);
    let charger = floor.node("C1-15");
    let away = floor.node("G6-2");
    for r in 0..2 {
        floor.submit(request(JobKind::Go { robot: RobotId::at(r), node: away }));
    }
    floor.until_over(300);
    let first = RobotId::at(0);
    floor.submit(request(JobKind::Charge { robot: first }));
    let is_sent = |f: &TestFloor| f.fleet.ledger().chain(first).last().is_some_and(|v| v.node == charger);
    floor.until(60, "it is on its way to the charger", is_sent);
    (floor, first, charger)
}

fn takes_turns(stop: Input, go_on: Input) {
    let (mut floor, first, charger) = one_charger();
    floor.step(vec![stop]);
    let second = RobotId::at(1);
    let job = floor.submit(request(JobKind::Charge { robot: second }));
    floor.until(200, "the other robot gets the charger", |f| f.fleet.ledger().node_of(second) == charger);
    floor.until(60, "its job is done", |f| f.state(job).is_none());
    assert_ne!(floor.fleet.ledger().node_of(first), charger);
    floor.step(vec![go_on]);
    let away = floor.node("G6-2");
    floor.submit(request(JobKind::Go { robot: second, node: away }));
    floor.until(300, "the first robot comes after it", |f| f.fleet.ledger().node_of(first) == charger);
}

#[test]
fn a_charger_that_was_promised_to_a_robot_that_cannot_come_goes_to_another_one() {
    let robot = Some(RobotId::at(0));
    takes_turns(Input::ask(4, FloorAction::Halt(robot)), Input::ask(5, FloorAction::Release(robot)));
}

#[test]
fn a_robot_that_fails_on_its_way_to_a_charger_keeps_it_from_no_other() {
    let (mut floor, first, charger) = one_charger();
    floor.world.fail(first, Time::MAX);
    let second = RobotId::at(1);
    floor.submit(request(JobKind::Charge { robot: second }));
    floor.until(60, "the other robot gets the charger", |f| f.fleet.ledger().node_of(second) == charger);
}

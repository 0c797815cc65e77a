//! Areas that are closed to people: walked round, left, waited for.

use super::people::Puppet;
use super::*;
use giveway_floor::geometry::{Point, inside};
use giveway_floor::id::ClosureId;
use giveway_floor::time::Window;

/// The lower middle aisle of the hall.
const AISLE: [(f64, f64); 4] = [(5.4, 0.8), (6.6, 0.8), (6.6, 6.2), (5.4, 6.2)];

fn corners(of: &[(f64, f64)]) -> Vec<Point> {
    of.iter().map(|(x, y)| Point::new(*x, *y)).collect()
}

fn is_in_aisle(p: Point) -> bool {
    inside(&corners(&AISLE), p)
}

impl TestFloor {
    fn bar(&mut self, of: &[(f64, f64)], from_s: f64, until_s: f64, binds: Binds) -> ClosureId {
        let outline = corners(of).into_iter().map(Into::into).collect();
        let window = Window::new(Time::from_secs_f64(from_s), Time::from_secs_f64(until_s));
        let area = Closure { outline, nodes: vec![], window, reason: "oil".into(), binds, series: None };
        match self.step(vec![Input::ask(5, FloorAction::Close(area))]).replies.remove(0).answer {
            Ok(Answer::Closure(closure)) => closure,
            other => panic!("not closed: {other:?}"),
        }
    }

    fn told(&self, puppet: &Puppet) -> (GuidanceState, Option<GuidanceReason>) {
        let view = self.fleet.view(self.now);
        let told = &view.workers[puppet.worker.ix()].guidance;
        (told.state, told.reason)
    }

    /// The node nearest to a place.
    fn near(&self, x: f64, y: f64) -> NodeId {
        let w = self.fleet.warehouse();
        let off = |n: &NodeId| (w.nodes[*n].at - Point::new(x, y)).norm();
        w.nodes.ids().min_by(|a, b| off(a).total_cmp(&off(b))).expect("some node")
    }

    /// Walks for this many periods; returns in how many of them the puppet was in the aisle.
    fn stroll(&mut self, puppet: &mut Puppet, periods: usize) -> usize {
        let mut inside = 0;
        for _ in 0..periods {
            self.walk(puppet);
            inside += usize::from(is_in_aisle(puppet.at));
        }
        inside
    }
}

#[test]
fn a_way_leads_round_an_area_that_is_closed_to_people_and_straight_through_one_for_robots() {
    for (binds, through) in [(Binds::Robots, true), (Binds::People, false), (Binds::Both, false)] {
        let mut floor = TestFloor::thesis(0);
        let mut ana = floor.hire(Point::new(6.0, 7.0));
        let goal = floor.near(6.0, 0.0);
        let closure = floor.bar(&AISLE, 0.0, 900.0, binds);
        floor.assign(&ana, goal, 2);
        let first = floor.stroll(&mut ana, 3);
        let round = (GuidanceState::Following, Some(GuidanceReason::RoundClosure(closure)));
        assert_eq!(floor.told(&ana) == round, !through, "{binds:?}: {:?}", floor.told(&ana));
        let inside = first + floor.stroll(&mut ana, 600);
        assert_eq!(inside > 20, through, "{binds:?}: {inside} periods inside");
        assert_eq!(floor.fleet.ledger().counts.human_deliveries, 1, "{binds:?}");
    }
}

#[test]
fn an_area_that_closes_before_somebody_would_be_through_is_walked_round() {
    // Six metres and a margin take less than 60 s and more than 4 s.
    for (from_s, through) in [(60.0, true), (4.0, false)] {
        let mut floor = TestFloor::thesis(0);
        let mut ana = floor.hire(Point::new(6.0, 7.0));
        let goal = floor.near(6.0, 0.0);
        floor.bar(&AISLE, from_s, 900.0, Binds::Both);
        floor.assign(&ana, goal, 2);
        let inside = floor.stroll(&mut ana, 400);
        assert_eq!(inside > 20, through, "closed from {from_s} s on: {inside} periods inside");
        assert_eq!(floor.fleet.ledger().counts.human_deliveries, 1);
    }
}

#[test]
fn who_has_work_in_a_closed_area_does_other_work_first_and_waits_outside_for_the_rest() {
    let mut floor = TestFloor::thesis(0);
    let mut ana = floor.hire(Point::new(6.0, 7.0));
    let (shut, open) = (floor.near(6.0, 3.0), floor.near(8.0, 7.0));
    let closure = floor.bar(&AISLE, 0.0, 120.0, Binds::People);
    let first = floor.assign(&ana, shut, 2);
    let second = floor.assign(&ana, open, 2);
    assert_eq!(floor.stroll(&mut ana, 300), 0);
    let ledger = floor.fleet.ledger();
    assert!(ledger.assignments.contains_key(&first) && !ledger.assignments.contains_key(&second));
    assert_eq!(floor.told(&ana), (GuidanceState::Idle, Some(GuidanceReason::PlaceClosed(closure))));
    let before = (1200 - (floor.now.0 / 100_000) as usize).saturating_sub(5);
    assert_eq!(floor.stroll(&mut ana, before), 0, "until it opens");
    floor.stroll(&mut ana, 200);
    assert!(floor.fleet.ledger().assignments.is_empty(), "and then the work is done");
}

#[test]
fn who_is_inside_when_it_begins_is_led_out_and_goes_on_when_it_is_over() {
    let mut floor = TestFloor::thesis(0);
    let mut ana = floor.hire(Point::new(6.0, 3.0));
    let place = floor.near(6.0, 3.0);
    // The work takes longer than there is time, which was not known when it began.
    floor.assign(&ana, place, 40);
    floor.stroll(&mut ana, 100);
    let closure = floor.bar(&AISLE, 25.0, 60.0, Binds::Both);
    let mut led = false;
    while floor.now < Time::from_secs_f64(25.0) {
        floor.stroll(&mut ana, 1);
        led |= floor.told(&ana).1 == Some(GuidanceReason::LeavesClosure(closure));
    }
    assert!(led && !is_in_aisle(ana.at), "she is out when it begins: {:?}", ana.at);
    assert_eq!(floor.stroll(&mut ana, 330), 0);
    assert_eq!(floor.fleet.in_closed_areas(floor.now), []);
    floor.stroll(&mut ana, 700);
    assert!(floor.fleet.ledger().assignments.is_empty(), "the work went on");
}

#[test]
fn who_walks_into_a_closed_area_all_the_same_is_named() {
    let mut floor = TestFloor::thesis(0);
    let mut ana = floor.hire(Point::new(6.0, 7.0));
    let closure = floor.bar(&AISLE, 0.0, 900.0, Binds::People);
    floor.stroll(&mut ana, 400);
    assert_eq!(floor.fleet.in_closed_areas(floor.now), []);
    (ana.own, ana.way) = (true, vec![Point::new(6.0, 3.0)]);
    floor.stroll(&mut ana, 60);
    assert_eq!(floor.fleet.in_closed_areas(floor.now), [(ana.worker, closure)]);
    assert_eq!(floor.told(&ana).1, Some(GuidanceReason::LeavesClosure(closure)));
}

//! What is recorded of robots that get another route, and of where people are going.

use super::*;
use crate::{FloorNote, ReplanCause};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::time::Window;
use std::collections::BTreeMap;

/// One replan: the robot, the cause, both routes and when.
type Replan = (RobotId, ReplanCause, Vec<Spot>, Vec<Spot>, Time);

impl TestFloor {
    fn notes(&self) -> impl Iterator<Item = &FloorNote> {
        self.facts.iter().filter_map(|fact| if let Fact::Noted(note) = fact { Some(note) } else { None })
    }

    fn replans(&self) -> Vec<Replan> {
        let of = |note: &FloorNote| match note {
            FloorNote::Replanned { robot, cause, was, now, at } => {
                Some((*robot, *cause, was.clone(), now.clone(), *at))
            }
            FloorNote::Goal { .. } => None,
        };
        self.notes().filter_map(of).collect()
    }

    /// Keeps all robots at work.
    fn keep_busy(&mut self) {
        if self.fleet.ledger().jobs.len() < 20 {
            let next = self.fleet.ledger().next_job as usize;
            let rack = RackId::at(next * 7 % self.fleet.warehouse().racks.len());
            let station = StationId::at(next % self.fleet.warehouse().stations.len());
            self.submit(request(JobKind::Deliver { rack, station, pick: None }));
        }
    }
}

#[test]
fn a_closed_aisle_is_noted_as_the_cause_with_a_way_through_it_before_and_another_since() {
    let mut floor = TestFloor::thesis(10);
    let corners = [(5.8, 0.8), (6.2, 0.8), (6.2, 6.2), (5.8, 6.2)];
    let outline: Vec<Spot> = corners.iter().map(|(x, y)| Point::new(*x, *y).into()).collect();
    let mut replans = Vec::new();
    while replans.is_empty() {
        assert!(floor.now < Time::from_secs_f64(900.0), "nobody is routed round the aisle");
        let end = floor.now + Span::from_secs(5);
        while floor.now < end {
            floor.keep_busy();
            floor.step(vec![]);
        }
        let window = Window::new(floor.now + Span::from_secs(20), floor.now + Span::from_secs(120));
        let (nodes, reason, binds) = (vec![], "oil".to_owned(), Binds::Robots);
        let area = Closure { outline: outline.clone(), nodes, window, reason, binds, series: None };
        let reply = floor.step(vec![Input::ask(5, FloorAction::Close(area))]).replies.remove(0).answer;
        let Ok(Answer::Closure(closure)) = reply else { panic!("not closed: {reply:?}") };
        floor.run(10);
        let by_it = |r: &Replan| r.1 == ReplanCause::Closure(closure);
        replans = floor.replans().into_iter().filter(by_it).collect();
        floor.step(vec![Input::ask(6, FloorAction::Reopen(closure))]);
    }
    let in_aisle = |s: &Spot| (s.x_mm - 6000).abs() < 500 && (500..6500).contains(&s.y_mm);
    for (robot, _, was, now, _) in &replans {
        // Only the first forty nodes of a route are recorded.
        assert!(was.len() == 40 || was.iter().any(in_aisle), "{robot:?} was to drive through it: {was:?}");
        assert_ne!(was, now);
    }
    let shown = floor.fleet.view(floor.now).robots[replans[0].0.ix()].replanned;
    assert!(shown.is_some(), "it is shown");
}

#[test]
fn people_among_robots_are_noted_as_the_cause_and_no_robot_is_noted_more_than_once_in_five_seconds() {
    let mut floor = TestFloor::thesis(10);
    let mut ana = floor.hire(Point::new(6.0, 7.0));
    ana.own = true;
    let corners = [(6.0, 1.0), (6.0, 13.0), (3.0, 7.0), (9.0, 7.0)].map(|(x, y)| Point::new(x, y));
    while floor.now < Time::from_secs_f64(400.0) {
        floor.keep_busy();
        if ana.way.is_empty() {
            ana.way = corners.to_vec();
        }
        floor.walk(&mut ana);
    }
    let by_ana = |r: &&Replan| r.1 == ReplanCause::Worker(ana.worker);
    let replans = floor.replans();
    assert!(replans.iter().any(|r| by_ana(&r)), "in six minutes somebody was replanned for her");
    let mut last: BTreeMap<(RobotId, ReplanCause), Time> = BTreeMap::new();
    for (robot, cause, was, now, at) in replans {
        assert!(!was.is_empty() && was != now, "{robot:?}: {was:?}");
        let before = last.insert((robot, cause), at);
        assert!(before.is_none_or(|before| at - before >= Span::from_secs(5)), "{robot:?} at {at:?}");
    }
}

#[test]
fn where_somebody_is_going_is_noted_once_when_it_is_probable() {
    let mut floor = TestFloor::lab(2);
    let start = floor.fleet.warehouse().nodes[floor.node("R32")].at;
    let mut ana = floor.hire(start);
    let place = floor.node("R116");
    floor.assign(&ana, place, 5);
    for _ in 0..400 {
        floor.walk(&mut ana);
    }
    let goals: Vec<(Spot, u8)> = floor
        .notes()
        .filter_map(|n| {
            if let FloorNote::Goal { place, percent, .. } = n { Some((*place, *percent)) } else { None }
        })
        .collect();
    let there = floor.fleet.warehouse().nodes[place].at;
    let near = |s: &Spot| (Point::from(*s) - there).norm() < 2.0;
    assert!(goals.iter().any(|(at, percent)| near(at) && *percent >= 60), "{goals:?}");
    assert!(goals.len() < 8, "it is noted when it changes, not while it is so: {goals:?}");
}

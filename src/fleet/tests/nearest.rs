//! Assignments that wait for the nearest free worker.

use super::people::Puppet;
use super::*;
use giveway_floor::geometry::Point;
use giveway_floor::id::{AssignmentId, WorkerId};
use giveway_sim::{Assignments, TaskSharing};
use std::collections::{BTreeMap, BTreeSet};

impl TestFloor {
    fn place_of(&self, name: &str) -> Point {
        self.fleet.warehouse().nodes[self.node(name)].at
    }

    fn offer(&mut self, place: &str, key: Option<&str>) -> AssignmentId {
        let place = self.node(place);
        let (stay, what) = (Span::from_secs(5), "pick".to_owned());
        let request = AssignmentRequest { place, stay, what, key: key.map(Into::into) };
        match self.answer_to(2, vec![Input::ask(2, WorkerAction::Assign { worker: None, request })]) {
            Ok(Answer::Assignment(Made { id: assignment, .. })) => assignment,
            other => panic!("not taken: {other:?}"),
        }
    }

    /// Both workers are seen where they stand.
    fn see(&mut self, puppets: &mut [Puppet]) {
        let seen = puppets.iter_mut().map(|p| p.sighting(self.now)).collect();
        self.step(seen);
    }

    fn given(&self) -> Vec<(AssignmentId, WorkerId)> {
        let given = |f: &Fact| match f {
            Fact::Assignment(AssignmentFact::Given { assignment, worker, .. }) => {
                Some((*assignment, *worker))
            }
            _ => None,
        };
        self.facts.iter().filter_map(given).collect()
    }
}

#[test]
fn the_nearest_on_foot_gets_the_oldest_assignment_and_the_next_one_goes_to_the_next() {
    let mut floor = TestFloor::thesis(0);
    let mut both =
        [floor.hire_as("Ana", floor.place_of("G0-14")), floor.hire_as("Ivo", floor.place_of("G12-1"))];
    let [first, second, third] = ["S10-1", "S11-1", "S1-13"].map(|place| floor.offer(place, None));
    assert_eq!(floor.given(), [], "nobody is on the floor");
    floor.see(&mut both);
    let [ana, ivo] = [both[0].worker, both[1].worker];
    assert_eq!(floor.given(), [(first, ivo), (second, ana)], "the older one first, to whoever is nearer");
    assert_eq!(floor.fleet.ledger().assignments[&third].worker, None, "it waits");
    floor.step(vec![Input::ask(3, WorkerAction::Finish(ana, second))]);
    floor.see(&mut both);
    assert_eq!(floor.given()[2..], [(third, ana)], "she is free again");
    floor.fleet.ledger().assert_indexed();
    floor.assert_fold();
}

#[test]
fn of_two_who_have_the_same_way_the_one_with_the_lower_number_gets_it_and_nobody_who_is_lost_does() {
    let mut floor = TestFloor::thesis(0);
    let mut both =
        [floor.hire_as("Ana", floor.place_of("G0-14")), floor.hire_as("Ivo", floor.place_of("G0-14"))];
    floor.see(&mut both);
    let first = floor.offer("S10-1", None);
    assert_eq!(floor.given(), [(first, both[0].worker)]);
    // No worker is seen any more.
    for _ in 0..100 {
        floor.step(vec![]);
    }
    floor.offer("S11-1", None);
    floor.step(vec![]);
    assert_eq!(floor.given().len(), 1, "Ivo is lost");
    floor.see(&mut both);
    assert_eq!(floor.given()[1].1, both[1].worker, "he is seen again");
}

#[test]
fn one_that_waits_is_made_once_cancelled_and_survives_a_restart() {
    let scenario = scenario(0);
    let mut floor = TestFloor::new(thesis(), &scenario);
    let kept = floor.offer("S10-1", Some("k"));
    assert_eq!(floor.offer("S10-1", Some("k")), kept, "the key says that it is the same");
    let gone = floor.offer("S11-1", None);
    let reply = floor.answer_to(4, vec![Input::ask(4, WorkerAction::Unassign(gone))]);
    assert_eq!(reply, Ok(Answer::Done));
    let nobody = Input::ask(5, WorkerAction::Finish(WorkerId(0), kept));
    let refused = floor.answer_to(5, vec![nobody]);
    assert!(matches!(refused, Err(Refusal::Worker(WorkerRefusal::UnknownAssignment(id))) if id == kept));
    floor.restart(&scenario);
    floor.assert_fold();
    let parts = floor.fleet.ledger().to_parts();
    assert_eq!(parts.promises.assignments[&kept].worker, None);
    let mut ana = [floor.hire_as("Ana", floor.place_of("G0-14"))];
    floor.see(&mut ana);
    assert_eq!(floor.given(), [(kept, ana[0].worker)]);
    floor.restart(&scenario);
    assert_eq!(floor.fleet.ledger().assignments[&kept].worker, Some(ana[0].worker));
    floor.fleet.ledger().assert_indexed();
}

#[test]
fn no_assignment_of_a_crew_that_shares_its_work_is_lost_or_done_twice() {
    let workers = Workers {
        count: 3,
        assignments: Assignments::Random { stay_s: 5.0 },
        tasks: TaskSharing::Nearest,
        leave_s: Some(500.0),
        ..Workers::default()
    };
    let mut floor = TestFloor::new(thesis(), &Scenario { workers, ..scenario(4) });
    let mut most_waiting = 0;
    for _ in 0..6000 {
        floor.step(vec![]);
        most_waiting = most_waiting.max(floor.fleet.ledger().index().unassigned().count());
    }
    let (mut made, mut given, mut over) = (BTreeSet::new(), BTreeMap::new(), BTreeMap::new());
    for fact in &floor.facts {
        match fact {
            Fact::Assignment(AssignmentFact::Assigned { assignment, worker, .. }) => {
                assert_eq!(*worker, None);
                made.insert(*assignment);
            }
            Fact::Assignment(AssignmentFact::Given { assignment, worker, .. }) => {
                assert_eq!(given.insert(*assignment, *worker), None, "given twice");
            }
            Fact::Assignment(AssignmentFact::Advanced { assignment, state, .. }) if state.is_over() => {
                assert_eq!(over.insert(*assignment, *state), None, "over twice");
            }
            _ => {}
        }
    }
    let done: Vec<_> = over.iter().filter(|(_, s)| **s == AssignmentState::Done).map(|(id, _)| *id).collect();
    assert!(done.iter().all(|id| given.contains_key(id)), "somebody did each of them");
    assert!(made.iter().all(|id| over.contains_key(id)), "they went home, and nothing was left or lost");
    assert!(floor.fleet.ledger().assignments.is_empty());
    let busy: BTreeSet<_> = given.values().collect();
    assert!(done.len() > 30 && busy.len() >= 2, "{} done by {}", done.len(), busy.len());
    assert!(most_waiting <= 3, "{most_waiting} waited at once");
}

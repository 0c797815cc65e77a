//! Workers in vehicles: what they move as is a fact, robots keep out of more floor around them, and ways lead only
//! where they fit.

use super::people::Puppet;
use super::*;
use giveway_floor::route::Effect;
use giveway_people::human::{Mover, Vehicle, VehicleFigures};

/// A truck too wide for the aisles of the hall, which are a metre wide; or one that is narrow enough for them.
fn truck(width_m: f64) -> Mover {
    let figures = VehicleFigures { speed_mps: 3.0, ..VehicleFigures::of_size(2.0, width_m) };
    Mover::Vehicle(Vehicle::new(figures).expect("it is a vehicle"))
}

impl TestFloor {
    fn get_in(&mut self, puppet: &Puppet, mover: Mover) -> Answered {
        self.step(vec![Input::ask(3, WorkerAction::MoveAs(puppet.worker, mover))]).replies.remove(0).answer
    }

    fn regions_of(&self, puppet: &Puppet) -> [f64; 3] {
        self.fleet.view(self.now).workers[puppet.worker.ix()].regions_m
    }

    /// Nodes that no robot may enter because of somebody.
    fn closed(&self) -> usize {
        let floor = self.fleet.internals().writer.floor();
        let is_hard = |effect: &Effect| matches!(effect, Effect::NoEntryOrExit | Effect::Closed);
        let is_closed = |n: &NodeId| floor.conditions(RobotId(0)).of(*n).iter().any(|c| is_hard(&c.effect));
        self.fleet.warehouse().nodes.ids().filter(is_closed).count()
    }
}

#[test]
fn robots_keep_out_of_more_floor_around_a_vehicle_than_around_its_driver_on_foot() {
    let mut floor = TestFloor::thesis(2);
    let at =
        floor.fleet.warehouse().nodes[floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Aisle)[0]].at;
    let mut ana = floor.hire(at);
    ana.own = true;
    (0..30).for_each(|_| _ = floor.walk(&mut ana));
    let (on_foot, closed) = (floor.regions_of(&ana), floor.closed());
    assert_eq!(floor.get_in(&ana, truck(1.2)), Ok(Answer::Done));
    floor.walk(&mut ana);
    let driving = floor.regions_of(&ana);
    // It stands and cannot be fast at once: regions 2 and 3 hardly grow, but for its size.
    assert!(driving[0] > on_foot[0] + 0.9, "{on_foot:?} {driving:?}");
    assert!((1..3).all(|i| driving[i] > on_foot[i]), "{on_foot:?} {driving:?}");
    assert!(floor.closed() >= closed, "{} and {closed} nodes", floor.closed());
    floor.get_in(&ana, Mover::OnFoot).expect("she gets off");
    floor.walk(&mut ana);
    assert_eq!((floor.regions_of(&ana), floor.closed()), (on_foot, closed), "as before");
}

#[test]
fn what_a_worker_moves_as_is_noted_once_and_known_after_a_restart() {
    let mut floor = TestFloor::thesis(1);
    let ana = floor.hire(giveway_floor::geometry::Point::origin());
    for _ in 0..2 {
        floor.get_in(&ana, truck(0.8)).expect("she is known");
    }
    let noted = floor.facts.iter().filter(|f| matches!(f, Fact::Worker(WorkerFact::Moves { .. }))).count();
    assert_eq!(noted, 1, "the second time nothing has changed");
    let (map, settings) = (floor.fleet.warehouse().clone(), floor.fleet.settings().clone());
    let again = Fleet::restore(map, settings, floor.facts.iter().cloned());
    assert_eq!(again.ledger().mover(ana.worker), truck(0.8));
    let nobody = giveway_floor::id::WorkerId(9);
    let asked = Input::ask(3, WorkerAction::MoveAs(nobody, truck(0.8)));
    let unknown = Refusal::Worker(WorkerRefusal::Unknown(nobody));
    assert_eq!(floor.step(vec![asked]).replies.remove(0).answer, Err(unknown));
}

#[test]
fn a_worker_who_gets_the_number_of_a_driver_who_has_gone_is_on_foot() {
    let mut floor = TestFloor::thesis(1);
    let ana = floor.hire(giveway_floor::geometry::Point::origin());
    floor.get_in(&ana, truck(0.8)).expect("she is known");
    floor.step(vec![Input::ask(4, WorkerAction::Forget(ana.worker))]);
    assert_eq!(floor.fleet.ledger().mover(ana.worker), Mover::OnFoot);
}

#[test]
fn a_vehicle_is_not_sent_where_it_does_not_fit() {
    let mut floor = TestFloor::thesis(1);
    let w = floor.fleet.warehouse().clone();
    let middle = w.nodes_where(|k| k == NodeKind::Storage)[30];
    let ana = floor.hire(w.nodes[middle].at);
    floor.get_in(&ana, truck(1.8)).expect("she is known");
    let request =
        AssignmentRequest { place: middle, stay: Span::from_secs(5), what: "fetch".into(), key: None };
    let wanted = Input::ask(2, WorkerAction::Assign { worker: Some(ana.worker), request: request.clone() });
    let refused = floor.step(vec![wanted]).replies.remove(0).answer;
    assert_eq!(refused, Err(Refusal::Worker(WorkerRefusal::OutOfReach(middle))), "all aisles are too narrow");
    floor.get_in(&ana, Mover::OnFoot).expect("she gets off");
    let wanted = Input::ask(2, WorkerAction::Assign { worker: Some(ana.worker), request });
    assert!(floor.step(vec![wanted]).replies.remove(0).answer.is_ok(), "on foot she gets there");
}

//! Robots that leave the floor for good, and come back.

use super::*;
use crate::fleet::state::ledger::Service;

const R0: RobotId = RobotId(0);

impl Floor {
    fn retire(&mut self, robot: RobotId) -> Reply {
        self.answer_to(7, vec![Input::Retire { token: 7, robot }])
    }

    fn is_gone(&self, robot: RobotId) -> bool {
        self.fleet.ledger().robots[robot].is_gone()
    }
}

#[test]
fn a_robot_that_is_to_leave_finishes_its_job_and_is_gone_when_it_was_switched_off() {
    let mut floor = Floor::lab(2);
    let job = floor.submit(request(deliver(0)));
    floor.until(60, "a robot is at it", |f| f.is(job, "carrying"));
    let robot = floor.fleet.ledger().jobs[&job].state.robot().expect("it carries");
    assert_eq!(floor.retire(robot), Reply::Done { token: 7 });
    let named = floor.submit(request(JobKind::Park { robot }));
    floor.until(300, "the job is done", |f| f.state(job).is_none());
    floor.assert_done_once(&[job]);
    floor.until(300, "it is gone", |f| f.is_gone(robot));
    let holder = crate::timeline::Holder::Robot(robot);
    assert!(floor.fleet.ledger().timeline().chain(holder).is_some_and(|c| c.is_absent()));
    assert_eq!(floor.story(named), ["failed"], "what names it cannot be done any more");
    let view = floor.fleet.view(floor.now);
    assert_eq!((view.robots[robot.ix()].state, view.kinds.len()), (RobotState::Gone, 1));
    let other = floor.submit(request(deliver(3)));
    floor.until(300, "the other one works on", |f| f.state(other).is_none());
    floor.assert_done_once(&[other]);
    let refused = floor.ask(request(JobKind::Park { robot }));
    assert_eq!(refused, Reply::Refused { token: 7, why: Refusal::RobotIsGone(robot) });
}

#[test]
fn the_place_of_a_robot_that_has_left_is_free_and_it_comes_back_elsewhere() {
    let mut floor = Floor::thesis(2);
    floor.retire(R0);
    floor.until(300, "it is gone", |f| f.is_gone(R0));
    let place = floor.fleet.ledger().node_of(R0);
    let one = RobotId(1);
    let job = floor.submit(request(JobKind::Go { robot: one, node: place }));
    floor.until(300, "another one stands there", |f| f.state(job).is_none());
    assert_eq!(floor.fleet.ledger().node_of(one), place);
    let name = floor.fleet.ledger().robots[R0].name.clone();
    let join = |node| Input::Register { token: 7, name: name.clone(), kind: "robot".into(), node };
    let taken = floor.answer_to(7, vec![join(place)]);
    assert_eq!(taken, Reply::Refused { token: 7, why: Refusal::PlaceTaken(place) });
    let free = floor.free_storage();
    assert_eq!(floor.answer_to(7, vec![join(free)]), Reply::Registered { token: 7, robot: R0, new: true });
    assert_eq!(floor.fleet.ledger().robots.len(), 2, "it is the same robot");
    let job = floor.submit(request(JobKind::Park { robot: R0 }));
    floor.until(300, "it works again", |f| f.state(job).is_none());
    floor.assert_done_once(&[job]);
}

#[test]
fn a_broken_robot_leaves_where_it_stands_and_its_job_goes_to_another() {
    let mut floor = Floor::lab(2);
    let job = floor.submit(request(deliver(0)));
    floor.until(60, "a robot drives to the rack", |f| f.is(job, "assigned"));
    let robot = floor.fleet.ledger().jobs[&job].state.robot().expect("it drives");
    floor.run(1);
    floor.world.fail(robot, Time::MAX);
    floor.until(10, "the fleet knows", |f| f.fleet.ledger().robots[robot].failed);
    floor.retire(robot);
    floor.until(30, "it is gone", |f| f.is_gone(robot));
    floor.until(600, "the job is done", |f| f.state(job).is_none());
    floor.assert_done_once(&[job]);
}

#[test]
fn a_robot_that_is_to_leave_can_stay_and_a_restart_forgets_neither() {
    let mut floor = Floor::lab(2);
    floor.retire(R0);
    floor.restart(&scenario(2));
    assert!(matches!(floor.fleet.ledger().robots[R0].service, Service::Leaving { .. }));
    floor.answer_to(7, vec![Input::Maintain { token: 7, robot: R0, begins: false }]);
    assert_eq!(floor.fleet.ledger().robots[R0].service, Service::Works);
    floor.run(5);
    floor.retire(R0);
    floor.until(120, "it is gone", |f| f.is_gone(R0));
    floor.restart(&scenario(2));
    assert!(floor.is_gone(R0));
    let job = floor.submit(request(deliver(0)));
    floor.until(600, "the other one works", |f| f.state(job).is_none());
    let parts = floor.fleet.ledger().to_parts();
    let clearance = floor.fleet.settings().clearance();
    let again = Ledger::from_parts(floor.fleet.warehouse().clone(), clearance, parts).expect("it is sound");
    assert!(again == *floor.fleet.ledger(), "a snapshot says the same");
}

#[test]
fn a_silent_robot_that_rests_is_not_gone_before_ten_seconds_and_none_that_was_not_to_leave() {
    let mut floor = Floor::lab(2);
    floor.run(2);
    let at = floor.now;
    floor.retire(R0);
    floor.until(120, "it is gone", |f| f.is_gone(R0));
    assert!(floor.now - at >= Span::from_secs(10), "{}", floor.now);
    floor.run(30);
    assert!(!floor.is_gone(RobotId(1)));
}

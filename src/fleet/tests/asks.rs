//! Requests whose answers have a form of their own.

use super::*;
use giveway_fleet::Ask;
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::WorkerId;
use giveway_floor::time::Window;

/// The answer to a request, in the form that the request says.
#[track_caller]
fn answered<A: std::fmt::Debug>(floor: &mut TestFloor, ask: Ask<A>) -> A {
    let answer = floor.answer_to(3, vec![Input::ask(3, ask.request.clone())]);
    let answer = answer.unwrap_or_else(|why| panic!("{:?} is refused: {why:?}", ask.request));
    ask.read(answer.clone()).unwrap_or_else(|| panic!("{:?} is answered with {answer:?}", ask.request))
}

#[test]
fn every_request_is_answered_in_its_own_form() {
    let mut floor = TestFloor::thesis(2);
    let f = &mut floor;
    let new = |id| Made { id, new: true };
    assert_eq!(answered(f, Ask::submit(request(deliver(3)))), new(JobId(1)));
    let batch = vec![request(deliver(4)), request(deliver(5))];
    assert_eq!(answered(f, Ask::submit_batch(batch)), [Ok(new(JobId(2))), Ok(new(JobId(3)))]);
    answered(f, Ask::change(JobId(3), JobChange { priority: Some(4), ..JobChange::default() }));
    answered(f, Ask::reassign(JobId(2), Some(RobotId(1))));
    answered(f, Ask::cancel(JobId(3)));

    let worker = answered(f, Ask::register_worker("Ana".into()));
    assert_eq!(worker, Made { id: WorkerId(0), new: true });
    let place = f.fleet.warehouse().nodes_where(|k| k == NodeKind::Storage)[0];
    let look = AssignmentRequest { place, stay: Span::from_secs(1), what: "look".into(), key: None };
    let first = answered(f, Ask::assign(None, look.clone())).id;
    answered(f, Ask::unassign(first));
    let second = answered(f, Ask::assign(Some(worker.id), look)).id;
    answered(f, Ask::finish(worker.id, second));
    answered(f, Ask::clear_worker(worker.id, "Ben".into()));
    answered(f, Ask::sign_off(worker.id));

    let outline: Vec<Spot> =
        [(0.0, 0.0), (0.1, 0.0), (0.0, 0.1)].map(|(x, y)| Point::new(x, y).into()).into();
    let window = Window::new(f.now, f.now + Span::from_secs(600));
    let (nodes, reason, binds) = (vec![], "oil".to_owned(), Binds::Robots);
    let area = Closure { outline, nodes, window, reason, binds, series: None };
    let closure = answered(f, Ask::close(area.clone()));
    answered(f, Ask::reopen(closure));
    let (every, weekdays, clock) = (Span::from_secs(3600), Weekdays::ALL, LocalClock::default());
    let recurrence = Recurrence { every, weekdays, clock, until: Time::MAX };
    let series = answered(f, Ask::recur(RecurringClosure::new(area, recurrence)));
    answered(f, Ask::end_series(series));
    answered(f, Ask::evacuate());
    answered(f, Ask::end_evacuation());

    answered(f, Ask::station(StationId(0), StationOrder::Pause));
    answered(f, Ask::station(StationId(0), StationOrder::Resume));
    answered(f, Ask::halt(None));
    answered(f, Ask::release(None));
    answered(f, Ask::begin_maintenance(RobotId(0)));
    answered(f, Ask::end_maintenance(RobotId(0)));
    let node = f.free_storage();
    let robot = answered(f, Ask::register_robot("late".into(), "robot".into(), node, None));
    assert_eq!(robot, Made { id: RobotId(2), new: true });
    answered(f, Ask::retire(RobotId(2)));
}

#[test]
fn an_answer_to_a_request_of_another_form_is_not_read() {
    let ask = Ask::submit(request(deliver(3)));
    assert_eq!(ask.read(Answer::Done), None);
    assert_eq!(ask.read(Answer::Robot(Made { id: RobotId(1), new: true })), None);
    assert_eq!(Ask::cancel(JobId(1)).read(Answer::Job(Made { id: JobId(1), new: true })), None);
}

//! Requests have limits, and a client that meets one is told.

use super::*;
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::time::Window;

fn limited(settings: impl Fn(&mut Settings)) -> Fleet {
    let mut s = Settings::default();
    settings(&mut s);
    Fleet::new(Arc::new(lab()), s)
}

fn refusals(fleet: &mut Fleet, inputs: Vec<Input>) -> Vec<Option<Refusal>> {
    let why = |reply: &Reply| match reply {
        Reply { answer: Err(why), .. } => Some(*why),
        _ => None,
    };
    fleet.step(Time::ZERO, inputs).replies.iter().map(why).collect()
}

fn area(corners: usize) -> Closure {
    let corner = |i: usize| Spot::from(Point::new(i as f64, (i * i) as f64));
    let window = Window::new(Time(1_000_000), Time(2_000_000));
    Closure {
        outline: (0..corners).map(corner).collect(),
        nodes: vec![],
        window,
        reason: "test".into(),
        binds: Binds::Robots,
        series: None,
    }
}

#[test]
fn one_job_too_many_is_refused_and_one_that_comes_after_too_many() {
    let mut fleet = limited(|s| (s.limits.open_jobs, s.limits.after) = (2, 1));
    let submit =
        |after: Vec<JobId>| Input::ask(1, JobAction::Submit(JobRequest { after, ..request(deliver(1)) }));
    let why = refusals(
        &mut fleet,
        vec![submit(vec![]), submit(vec![JobId(1), JobId(1)]), submit(vec![]), submit(vec![])],
    );
    let full = Refusal::TooMany(Bounded::Jobs, 2);
    assert_eq!(why, [None, Some(Refusal::Job(JobRefusal::TooManyBefore(1))), None, Some(full)]);
}

#[test]
fn one_worker_too_many_is_refused_and_a_known_one_is_not() {
    let mut fleet = limited(|s| s.limits.workers = 1);
    let hire = |name: &str| Input::ask(1, WorkerAction::Register(name.into()));
    let why = refusals(&mut fleet, vec![hire("anna"), hire("ben"), hire("anna")]);
    assert_eq!(why, [None, Some(Refusal::TooMany(Bounded::Workers, 1)), None]);
}

#[test]
fn a_worker_who_is_forgotten_frees_a_place_and_numbers_are_given_again_only_when_there_are_no_others() {
    let mut fleet = limited(|s| s.limits.workers = 3);
    let hire = |name: &str| Input::ask(1, WorkerAction::Register(name.into()));
    let forget = |n: u32| Input::ask(1, WorkerAction::Forget(giveway_floor::id::WorkerId(n)));
    let names = |fleet: &Fleet| fleet.ledger().workers.iter().cloned().collect::<Vec<_>>();
    assert_eq!(refusals(&mut fleet, vec![hire("anna"), hire("ben"), forget(0), hire("carl")]), [None; 4]);
    assert_eq!(names(&fleet), ["", "ben", "carl"]);
    let why = refusals(&mut fleet, vec![forget(0), hire("dora"), hire("emil"), forget(1), hire("emil")]);
    let unknown = Some(Refusal::Worker(WorkerRefusal::Unknown(giveway_floor::id::WorkerId(0))));
    let full = Some(Refusal::TooMany(Bounded::Workers, 3));
    assert_eq!(why, [unknown, None, full, None, None]);
    assert_eq!(names(&fleet), ["dora", "emil", "carl"]);
    let loaded = Fleet::resume(fleet.ledger().clone(), fleet.settings().clone(), std::iter::empty());
    assert_eq!(names(&loaded), ["dora", "emil", "carl"]);
}

#[test]
fn a_worker_who_has_something_to_do_or_is_on_the_floor_is_not_forgotten() {
    let mut fleet = limited(|_| ());
    let place = fleet.warehouse().nodes_where(|k| k == NodeKind::Storage)[0];
    let request = AssignmentRequest { place, stay: Span::from_secs(1), what: "look".into(), key: None };
    let anna = giveway_floor::id::WorkerId(0);
    let hire = Input::ask(1, WorkerAction::Register("anna".into()));
    let assign = Input::ask(1, WorkerAction::Assign { worker: Some(anna), request });
    let forget = || Input::ask(1, WorkerAction::Forget(anna));
    let take_back = Input::ask(1, WorkerAction::Unassign(giveway_floor::id::AssignmentId(1)));
    let why = refusals(&mut fleet, vec![hire, assign, forget(), take_back, forget()]);
    assert_eq!(why, [None, None, Some(Refusal::Worker(WorkerRefusal::Busy(anna))), None, None]);
}

#[test]
fn one_assignment_too_many_is_refused_until_another_is_over() {
    let mut fleet = limited(|s| s.limits.open_assignments = 1);
    let place = fleet.warehouse().nodes_where(|k| k == NodeKind::Storage)[0];
    let request = AssignmentRequest { place, stay: Span::from_secs(1), what: "look".into(), key: None };
    let assign = || {
        Input::ask(
            1,
            WorkerAction::Assign { worker: Some(giveway_floor::id::WorkerId(0)), request: request.clone() },
        )
    };
    let take_back = Input::ask(1, WorkerAction::Unassign(giveway_floor::id::AssignmentId(1)));
    let hire = Input::ask(1, WorkerAction::Register("anna".into()));
    let why = refusals(&mut fleet, vec![hire, assign(), assign(), take_back, assign()]);
    let full = Some(Refusal::TooMany(Bounded::Assignments, 1));
    assert_eq!(why, [None, None, full, None, None]);
}

#[test]
fn one_closure_too_many_is_refused_until_another_is_taken_back_and_one_with_too_many_corners() {
    let mut fleet = limited(|s| (s.limits.closures, s.limits.corners) = (1, 4));
    let close = |corners| Input::ask(1, FloorAction::Close(area(corners)));
    let reopen = Input::ask(1, FloorAction::Reopen(giveway_floor::id::ClosureId(1)));
    let why = refusals(&mut fleet, vec![close(5), close(4), close(4), reopen, close(4)]);
    let full = Some(Refusal::TooMany(Bounded::Closures, 1));
    assert_eq!(why, [Some(Refusal::Area(AreaRefusal::TooManyCorners(4))), None, full, None, None]);
}

#[test]
fn searches_of_one_step_expand_no_more_than_a_step_may_and_the_last_search() {
    let faults = Faults { failures_per_hour: 60.0, repair_s: 40.0, ..Faults::default() };
    let scenario = Scenario { faults, ..scenario(20) };
    let settings =
        Settings { expansions_per_step: 1_200, expansions_per_plan: 500, ..scenario.site.settings() };
    let warehouse = scenario.site.fit(&Arc::new(thesis())).expect("the map is for these robots");
    let fleet = Fleet::new(warehouse.clone(), settings);
    let world = World::new(warehouse, &scenario, &[], 1, fleet.ledger(), Time::ZERO);
    let laws = Laws::new(&fleet);
    let mut floor = TestFloor { fleet, world, laws, now: Time::ZERO, facts: Vec::new() };
    floor.step(vec![]);
    floor.submit_batch(60);
    let mut met = 0;
    for _ in 0..6_000 {
        floor.step(vec![]);
        let effort = floor.fleet.internals().traffic.effort;
        met += u32::from(effort.is_spent());
        // A search counts the label that it may not expand.
        assert!(effort.spent <= 1_200 + 501, "{effort:?} at {}", floor.now);
    }
    assert!(met > 0, "the limit was never met, so nothing was shown");
    assert!(floor.done() > 10, "{} deliveries done", floor.done());
}

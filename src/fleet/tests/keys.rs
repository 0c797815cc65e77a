//! Customers' keys: known for at least a week, and as long as their job or assignment is open; then forgotten.

use super::*;
use giveway_fleet::state::worker::AssignmentRequest;
use giveway_floor::id::{AssignmentId, CustomerId, WorkerId};

const DAY: Span = Span::from_secs(24 * 3600);

fn keyed(key: &str) -> JobRequest {
    JobRequest { key: Some(key.into()), ..request(deliver(3)) }
}

fn facts_of_expiry(facts: &[Fact]) -> Vec<(usize, usize)> {
    let sizes = facts.iter().filter_map(|f| match f {
        Fact::Floor(FloorFact::KeysExpired { jobs, assignments }) => Some((jobs.len(), assignments.len())),
        _ => None,
    });
    sizes.collect()
}

#[test]
fn a_key_makes_no_second_job_for_a_week_and_a_new_one_after_eight_days() {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(keyed("order"));
    floor.until_over(300);
    floor.until(300, "the rack is put away", TestFloor::first_robot_is_idle);
    floor.now = Time::ZERO + DAY * 6;
    assert_eq!(floor.ask(keyed("order")), Ok(Answer::Job(Made { id: job, new: false })));
    floor.now = Time::ZERO + DAY * 8;
    // The law of progress sees the idle robot before it gets a task; otherwise it counts the two days against it.
    floor.step(vec![]);
    let again = floor.submit(keyed("order"));
    assert!(again > job, "a new job");
    assert_eq!(facts_of_expiry(&floor.facts), [(1, 0)]);
    floor.assert_fold();
}

#[test]
fn the_same_key_of_two_customers_makes_two_jobs_and_two_assignments() {
    let mut floor = TestFloor::lab(1);
    let of = |owner| Some(ClientKey { owner: Some(CustomerId(owner)), text: "4711".into() });
    let keyed = |owner| JobRequest { key: of(owner), ..request(deliver(3)) };
    let place = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Aisle)[0];
    let assign = |owner| {
        let request = AssignmentRequest { place, stay: Span::ZERO, what: "count".into(), key: of(owner) };
        Input::ask(2, WorkerAction::Assign { worker: None, request })
    };
    let (wms, mes) = (floor.submit(keyed(1)), floor.submit(keyed(2)));
    assert_ne!(wms, mes, "a key of one customer never gives another customer's job");
    let [first, second] = [1, 2].map(|owner| floor.step(vec![assign(owner)]).replies.remove(0).answer);
    let made = |assignment| Ok(Answer::Assignment(Made { id: AssignmentId(assignment), new: true }));
    assert_eq!((first, second), (made(1), made(2)));
    assert_eq!(floor.ask(keyed(1)), Ok(Answer::Job(Made { id: wms, new: false })));
    assert_eq!(floor.ask(keyed(2)), Ok(Answer::Job(Made { id: mes, new: false })));
    floor.assert_fold();
}

#[test]
fn a_key_of_which_nobody_knows_whose_it_is_makes_no_second_job_for_any_customer() {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(keyed("order"));
    let of_one = ClientKey { owner: Some(CustomerId(1)), text: "order".into() };
    let again = JobRequest { key: Some(of_one), ..request(deliver(3)) };
    assert_eq!(floor.ask(again), Ok(Answer::Job(Made { id: job, new: false })));
}

#[test]
fn the_key_of_an_open_job_is_known_however_old_it_is_and_goes_when_the_job_is_over() {
    let mut floor = TestFloor::lab(1);
    let first = floor.submit(request(deliver(1)));
    let waits = JobRequest { after: vec![first], ..keyed("waits") };
    assert!(matches!(
        floor.step(vec![Input::ask(1, FloorAction::Halt(None))]).replies[..],
        [Reply { answer: Ok(Answer::Done), .. }]
    ));
    let job = floor.submit(waits.clone());
    floor.now = Time::ZERO + DAY * 30;
    assert_eq!(floor.ask(waits.clone()), Ok(Answer::Job(Made { id: job, new: false })));
    floor.cancel(job).unwrap();
    assert!(
        matches!(floor.ask(waits), Ok(Answer::Job(Made { new: true, .. }))),
        "over, and older than a week"
    );
}

#[test]
fn keys_of_assignments_are_forgotten_too() {
    let mut floor = TestFloor::lab(1);
    let place = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Aisle)[0];
    let what = AssignmentRequest { place, stay: Span::ZERO, what: "count".into(), key: Some("k".into()) };
    let assign = |request: &AssignmentRequest| {
        Input::ask(2, WorkerAction::Assign { worker: Some(WorkerId(0)), request: request.clone() })
    };
    floor.step(vec![Input::ask(1, WorkerAction::Register("anna".into()))]);
    floor.step(vec![assign(&what)]);
    floor.step(vec![Input::ask(3, WorkerAction::Unassign(AssignmentId(1)))]);
    floor.now = Time::ZERO + DAY * 8;
    let reply = floor.step(vec![assign(&what)]).replies.remove(0).answer;
    assert_eq!(reply, Ok(Answer::Assignment(Made { id: AssignmentId(2), new: true })));
    floor.assert_fold();
}

#[test]
fn the_memory_of_keys_is_bounded_and_no_step_forgets_many() {
    let mut floor = TestFloor::lab(0);
    let mut most = 0;
    for day in 0..40 {
        floor.now = Time::ZERO + DAY * day;
        let order = |i: i64| keyed(&format!("{day}-{i}"));
        let inputs = (0..100).map(|i| Input::ask(7, JobAction::Submit(order(i)))).collect();
        let jobs = floor.step(inputs).replies.into_iter().filter_map(|r| match r {
            Reply { answer: Ok(Answer::Job(Made { id: job, new: true })), .. } => {
                Some(Input::ask(8, JobAction::Cancel(job)))
            }
            _ => None,
        });
        let cancels: Vec<Input> = jobs.collect();
        assert_eq!(cancels.len(), 100);
        floor.step(cancels);
        floor.step(vec![]);
        most = most.max(floor.fleet.ledger().keys.len());
    }
    assert!((700..=900).contains(&most), "a week of 100 keys a day, not 40 days: {most}");
    let sizes = facts_of_expiry(&floor.facts);
    assert!(sizes.iter().all(|(jobs, _)| *jobs <= 64) && sizes.len() > 32, "{sizes:?}");
}

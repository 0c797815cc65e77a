//! The store: what goes in comes out, once; and a server with a database that is locked or full.

use crate::helper::{Folder, all_jobs, delivery, empty_ledger, eventually, get, map, post, start};
use giveway::fleet::{
    Act, AreaFact, AssignmentFact, AssignmentQuery, AssignmentRequest, AssignmentState, Binds, Booking,
    Capabilities, Charging, Closure, Encounter, EncounterFact, EncounterQuery, EventDetails, EventKind,
    EventQuery, Fact, FloorFact, FloorNote, JobFact, JobFailure, JobKind, JobQuery, JobRequest, JobState,
    KeptRoute, LastPlace, LocalClock, Moved, ObeyedLimits, Purpose, Reaction, Recurrence, RecurringClosure,
    ReplanCause, RobotEventQuery, RobotEventSource, RobotFact, RobotKind, RouteFact, Stop, Task, Weekdays,
    WorkerFact,
};
use giveway::geometry::{Point, Spot};
use giveway::id::{
    AssignmentId, ClosureId, JobId, NodeId, RackId, ResourceId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway::route::Kinematics;
use giveway::store::{StepEntry, Store, StoreError, record};
use giveway::time::{Span, Time, Window};
use giveway::timeline::{Shift, Visit};
use giveway::warehouse::Footprint;
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use std::net::SocketAddr;

fn request(kind: JobKind) -> JobRequest {
    JobRequest { priority: 3, ..JobRequest::new(kind) }
}

fn deliver() -> JobRequest {
    request(JobKind::Deliver { rack: RackId(1), station: StationId(0), pick: Some(Span(5)) })
}

/// A kind of robots of which nothing is as usual.
fn odd_kind() -> RobotKind {
    let corners = [(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2)].map(|(x, y)| Point::new(x, y)).to_vec();
    RobotKind {
        name: "odd".into(),
        kinematics: Kinematics {
            speed_mps: 0.1 + 0.2,
            turn_radps: f64::INFINITY,
            lift: Span(5),
            ..Kinematics::default()
        },
        charging: Charging { opportunity: false, driving_h: 3.3, ..Charging::default() },
        footprints: [
            Some(Footprint::Circle { radius_m: 0.15 }),
            Some(Footprint::Polygon { corners, turns: true }),
        ],
        carries: Some(vec!["bin".into()]),
        payload_kg: 60.5,
        free_navigation: true,
        capabilities: Capabilities {
            revocation: false,
            limits: ObeyedLimits::Stops,
            drives_back: false,
            horizon_nodes: 3,
        },
    }
}

/// Every variant of everything at least once.
fn every_fact() -> Vec<Fact> {
    let (robot, job, rack, node, at) =
        (RobotId(2), JobId(7), RackId(3), NodeId(4), Time(1_800_000_000_000_000));
    let kinds = [
        JobKind::Deliver { rack, station: StationId(1), pick: Some(Span(8)) },
        JobKind::Deliver { rack, station: StationId(1), pick: None },
        JobKind::Return { rack },
        JobKind::Relocate { rack, node },
        JobKind::Charge { robot },
        JobKind::Park { robot },
        JobKind::Go { robot, node },
    ];
    let states = [
        JobState::Waiting,
        JobState::Assigned { robot },
        JobState::Carrying { robot },
        JobState::Picking { robot },
        JobState::Done,
        JobState::Cancelled,
        JobState::Failed(JobFailure::MapChanged),
        JobState::Failed(JobFailure::Unreachable),
        JobState::Failed(JobFailure::Predecessor(job)),
    ];
    let moves = [Purpose::Charge, Purpose::Park, Purpose::Go];
    let tasks = [
        Task::Idle,
        Task::Fetch { job: Some(job), rack, node },
        Task::Deliver { job, rack, station: node, store: NodeId(9) },
        Task::Store { job: Some(job), rack, store: node },
        Task::Store { job: None, rack, store: node },
    ];
    let mut facts = vec![
        Fact::Robot(RobotFact::Registered {
            robot,
            name: "robot-\"ü\"".into(),
            kind: "mover".into(),
            node,
            at,
        }),
        Fact::Floor(FloorFact::KeysExpired { jobs: vec![job], assignments: vec![] }),
        Fact::Floor(FloorFact::KeysExpired { jobs: vec![], assignments: vec![AssignmentId(3)] }),
        Fact::Robot(RobotFact::Linked { robot, link: "mqtt".into() }),
        Fact::Robot(RobotFact::Failed { robot, at }),
        Fact::Robot(RobotFact::Repaired { robot, at }),
        Fact::Robot(RobotFact::Fenced { robot, at }),
        Fact::Floor(FloorFact::KindPut { kind: Box::new(odd_kind()), at }),
        Fact::Floor(FloorFact::KindPut { kind: Box::default(), at }),
        Fact::Floor(FloorFact::KindRemoved { name: "odd".into(), at }),
        Fact::Floor(FloorFact::Halted { robot: None, at }),
        Fact::Floor(FloorFact::Halted { robot: Some(robot), at }),
        Fact::Floor(FloorFact::Released { robot: Some(robot), at }),
        Fact::Job(JobFact::Prioritised { job: JobId(99), priority: 9, at }),
        Fact::Job(JobFact::Changed { job: JobId(99), kind: kinds[0], priority: 9, deadline: Some(at), at }),
    ];
    for (i, kind) in kinds.into_iter().enumerate() {
        let mut request = request(kind);
        request.deadline = Some(at);
        request.after = vec![JobId(1), JobId(2)];
        request.key = Some("a key".into());
        request.reference = Some("order 4711".into());
        request.labels = [("wave".to_owned(), format!("{i}"))].into();
        facts.push(Fact::Job(JobFact::Accepted { job: JobId(i as u64 + 1), request, at }));
    }
    facts.extend(states.map(|state| Fact::Job(JobFact::Progressed { job, state, tasked: None, at })));
    facts.extend(facts_about_routes(at));
    facts.extend(facts_about_people(at));
    facts.extend(tasks.map(|task| Fact::Robot(RobotFact::Tasked { robot, task })));
    facts.extend(moves.map(|purpose| {
        let task = Task::Move { job: Some(job), goal: node, stay: NodeId(5), purpose };
        Fact::Robot(RobotFact::Tasked { robot, task })
    }));
    facts
}

fn facts_about_routes(at: Time) -> Vec<Fact> {
    let (robot, rack) = (RobotId(2), RackId(3));
    let visit = |serial: u32, last: bool| Visit {
        node: NodeId(serial),
        lane: (!last).then_some(ResourceId(99)),
        loaded: last,
        enter: at,
        arrive: at,
        depart: if last { Time::MAX } else { at },
        leave: if last { Time::MAX } else { at },
        stay: Span(if last { 0 } else { 2_200_000 }),
    };
    let stop = |serial, act| Stop { serial, act };
    vec![
        Fact::Route(RouteFact::Routed {
            bookings: vec![Booking {
                robot,
                keep: u64::MAX,
                kept: visit(1, false),
                visits: vec![visit(2, false), visit(3, true)],
                stops: vec![
                    stop(1, Act::Lift(rack)),
                    stop(2, Act::Set(rack)),
                    stop(3, Act::Pick(Span(9))),
                    stop(4, Act::Arrive),
                ],
            }],
        }),
        Fact::Route(RouteFact::Granted { robot, serial: 8, at }),
        Fact::Route(RouteFact::Passed { robot, serial: 8 }),
        Fact::Route(RouteFact::Acted { robot, serial: 8 }),
        Fact::Route(RouteFact::Retimed { moved: vec![Moved { robot, shifts: shifts(at) }] }),
        Fact::Route(RouteFact::Revoked { robot, serial: 8, recalls: 3, at }),
        Fact::Route(RouteFact::Placed {
            robot,
            node: NodeId(7),
            serial: 12,
            cut: vec![KeptRoute { robot, end: 9, shifts: shifts(at) }],
            at,
        }),
        Fact::Route(RouteFact::Truncated { robots: vec![KeptRoute { robot, end: 9, shifts: shifts(at) }] }),
    ]
}

/// A visit that ends, one that is held for ever though its robot leaves, and one that never ends.
fn shifts(at: Time) -> Vec<Shift> {
    let shift = |serial, depart, leave| Shift { serial, enter: at, arrive: at + Span(5), depart, leave };
    vec![
        shift(7, at + Span(9), at + Span(20)),
        shift(8, at + Span(9), Time::MAX),
        shift(9, Time::MAX, Time::MAX),
    ]
}

fn facts_about_people(at: Time) -> Vec<Fact> {
    let (worker, robot, closure) = (WorkerId(1), RobotId(2), ClosureId(4));
    let corner = |x_mm, y_mm| Spot { x_mm, y_mm };
    let outline = vec![corner(0, 0), corner(-1000, 0), corner(0, 2500)];
    let area = Closure {
        outline,
        nodes: vec![NodeId(3)],
        window: Window::from(at),
        reason: "öl".into(),
        binds: Binds::Robots,
        series: None,
    };
    let request =
        AssignmentRequest { place: NodeId(5), stay: Span(9), what: "count".into(), key: Some("k".into()) };
    let met = |reaction| {
        Fact::Encounter(EncounterFact::Met(Encounter {
            worker,
            robot,
            began: at,
            ended: at + Span(7),
            at: corner(-5, 5),
            radius_mm: 1400,
            closest_mm: 800,
            robot_mmps: 500,
            worker_mmps: 1200,
            reaction,
            delay: Span(3),
        }))
    };
    let mut facts = vec![
        Fact::Worker(WorkerFact::Registered { worker, name: "anna".into(), at }),
        Fact::Area(AreaFact::Closed { closure, area: area.clone() }),
        Fact::Area(AreaFact::Reopened { closure, at }),
        Fact::Encounter(EncounterFact::Deviated { worker, at }),
    ];
    for (i, state) in ASSIGNMENT_STATES.into_iter().enumerate() {
        let assignment = AssignmentId(i as u64 + 1);
        // Half of them waited for somebody.
        let waits = i % 2 == 1;
        let of = (!waits).then_some(worker);
        facts.push(Fact::Assignment(AssignmentFact::Assigned {
            assignment,
            worker: of,
            request: request.clone(),
            at,
        }));
        facts.extend(waits.then_some(Fact::Assignment(AssignmentFact::Given { assignment, worker, at })));
        facts.push(Fact::Assignment(AssignmentFact::Advanced { assignment, state, at: at + Span(1) }));
    }
    facts.extend(REACTIONS.map(met));
    facts.extend(
        REACTIONS.map(|reaction| Fact::Encounter(EncounterFact::Interrupted { robot, worker, reaction, at })),
    );
    facts.extend(facts_about_closures(&area, at));
    facts.extend(notes(at));
    facts
}

/// What is noted for the record.
fn notes(at: Time) -> Vec<Fact> {
    let (robot, worker, place) = (RobotId(2), WorkerId(1), Spot { x_mm: 3100, y_mm: -40 });
    let causes = [
        ReplanCause::Worker(worker),
        ReplanCause::Closure(ClosureId(5)),
        ReplanCause::Robot(RobotId(4)),
        ReplanCause::Obstruction,
    ];
    let replanned =
        |cause| Fact::Noted(FloorNote::Replanned { robot, cause, was: vec![place; 2], now: vec![place], at });
    let goal = Fact::Noted(FloorNote::Goal { worker, place, percent: 72, at });
    causes.map(replanned).into_iter().chain([goal]).collect()
}

/// For whom an area is closed, what recurs, and evacuations.
fn facts_about_closures(area: &Closure, at: Time) -> Vec<Fact> {
    let series = SeriesId(2);
    let window = Window::new(at, at + Span(600));
    let of = |binds| Closure { window, binds, series: Some(series), ..area.clone() };
    let changes = vec![(at + Span::from_secs(1_000_000), Span(7))];
    let clock = LocalClock { zone: Some("Europe/Berlin".into()), offset: Span(-7), changes };
    let recurrence = Recurrence { every: Span(900), weekdays: Weekdays(0b101), clock, until: Time::MAX };
    vec![
        Fact::Area(AreaFact::Recurs { series, closure: RecurringClosure::new(of(Binds::Both), recurrence) }),
        Fact::Area(AreaFact::Closed { closure: ClosureId(5), area: of(Binds::Both) }),
        Fact::Area(AreaFact::Scheduled { series, next: Some(at + Span(900)) }),
        Fact::Area(AreaFact::Closed { closure: ClosureId(6), area: of(Binds::People) }),
        Fact::Area(AreaFact::Scheduled { series, next: None }),
        Fact::Area(AreaFact::SeriesEnded { series, at }),
        Fact::Floor(FloorFact::Evacuated { at }),
        Fact::Floor(FloorFact::EvacuationEnded { at }),
    ]
}

const ASSIGNMENT_STATES: [AssignmentState; 5] = [
    AssignmentState::Waiting,
    AssignmentState::Walking,
    AssignmentState::Working,
    AssignmentState::Done,
    AssignmentState::Cancelled,
];

const REACTIONS: [Reaction; 5] =
    [Reaction::Kept, Reaction::Slowed, Reaction::Held, Reaction::Rerouted, Reaction::Stopped];

#[tokio::test]
async fn lists_about_people_follow_the_facts() {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let at = Time(1_800_000_000_000_000);
    let facts = facts_about_people(at);
    store.append(1, &entries(facts.clone())).await.unwrap();
    store.append(1, &entries(facts.clone())).await.unwrap();
    let all = AssignmentQuery { limit: 10, ..AssignmentQuery::default() };
    let rows = store.assignments(&all).await.unwrap().rows;
    let states: Vec<_> = rows.iter().rev().map(|row| row.assignment.state).collect();
    assert_eq!(states, ASSIGNMENT_STATES);
    let Fact::Assignment(AssignmentFact::Assigned { request, worker, .. }) = &facts[4] else {
        panic!("the first assignment")
    };
    assert!(rows.iter().all(|row| row.assignment.worker == Some(WorkerId(1))), "each was given to her");
    let first = store.assignment(AssignmentId(1)).await.unwrap().unwrap();
    assert_eq!((&first.assignment.request, first.assignment.worker), (request, *worker));
    assert_eq!((first.assignment.accepted, first.updated), (at, at + Span(1)));
    let others = AssignmentQuery { worker: Some(WorkerId(9)), ..all.clone() };
    assert_eq!(store.assignments(&others).await.unwrap().rows, []);
    let done = AssignmentQuery { states: vec!["done"], ..all };
    assert_eq!(store.assignments(&done).await.unwrap().rows[0].id, AssignmentId(4));

    let all = EncounterQuery { limit: 10, ..EncounterQuery::default() };
    let rows = store.encounters(&all).await.unwrap().rows;
    let met: Vec<_> =
        rows.iter().rev().map(|row| Fact::Encounter(EncounterFact::Met(row.encounter.clone()))).collect();
    let expected: Vec<_> =
        facts.iter().filter(|f| matches!(f, Fact::Encounter(EncounterFact::Met(_)))).cloned().collect();
    assert_eq!(met, expected, "each once");
    let later = EncounterQuery { from: Some(at + Span(1)), ..all.clone() };
    assert_eq!(store.encounters(&later).await.unwrap().rows, []);
    let before = EncounterQuery { before: Some(rows[2].seq), ..all };
    assert_eq!(store.encounters(&before).await.unwrap().rows, rows[3..]);
}

/// Steps of three facts each.
fn entries(facts: Vec<Fact>) -> Vec<StepEntry> {
    let step = |(i, facts): (usize, &[Fact])| StepEntry {
        at: Time(1000 + i as i64),
        facts: facts.to_vec(),
        causes: Vec::new(),
    };
    facts.chunks(3).enumerate().map(step).collect()
}

#[test]
fn every_fact_comes_back_from_its_record() {
    for fact in every_fact() {
        let text = record::encode(std::slice::from_ref(&fact));
        assert_eq!(record::decode(record::VERSION, &text).unwrap(), [fact], "{text}");
    }
}

#[test]
fn records_of_version_2_are_read_for_ever() {
    let text = r#"[{"fact":"routed","bookings":[[2,5,[1,null,5,[10,10,10,20]],[[2,7,0,[30,10,null,null]]],[[6,{"lift":3}],[7,"arrive"]]]]},{"fact":"delayed","moved":[[2,[[6,[1,2,3,null]]]]]}]"#;
    let facts = record::decode(2, text).unwrap();
    let [Fact::Route(RouteFact::Routed { bookings }), Fact::Route(RouteFact::Retimed { moved })] = &facts[..]
    else {
        panic!("{text}")
    };
    let Booking { keep: 5, kept, visits, stops, .. } = &bookings[0] else { panic!("{text}") };
    assert_eq!((kept.enter, kept.arrive, kept.depart, kept.leave), (Time(10), Time(20), Time(30), Time(40)));
    assert!(visits[0].depart.is_forever());
    assert_eq!(stops[1].act, Act::Arrive);
    let shift = Shift { serial: 6, enter: Time(1), arrive: Time(3), depart: Time(6), leave: Time::MAX };
    assert_eq!(moved, &[Moved { robot: RobotId(2), shifts: vec![shift] }]);
    let newer = record::decode(record::VERSION + 1, text).unwrap_err().to_string();
    assert!(newer.contains("newer Giveway"), "{newer}");
    let older = record::decode(1, text).unwrap_err().to_string();
    assert!(older.contains("another --database"), "{older}");
    assert!(record::decode(2, "[").unwrap_err().to_string().contains("backup"));
}

#[tokio::test]
async fn what_was_appended_is_loaded_and_projected() {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    assert_eq!(store.load(empty_ledger()).await.unwrap().next, 1);
    let facts = every_fact();
    let steps = entries(facts.clone());
    let (first, second) = steps.split_at(4);
    store.append(1, first).await.unwrap();
    store.append(5, second).await.unwrap();
    store.close().await;
    drop(store);

    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let loaded = store.load(empty_ledger()).await.unwrap();
    assert_eq!(loaded.steps, steps);
    assert_eq!(loaded.next, steps.len() as i64 + 1);
    assert_eq!(loaded.last, steps.last().map(|s| s.at));
    for fact in &facts {
        if let Fact::Job(JobFact::Accepted { job, request, at }) = fact {
            let row = store.job(*job).await.unwrap().unwrap();
            assert_eq!((&row.job.request, row.job.accepted), (request, *at));
        }
    }
    let row = store.job(JobId(7)).await.unwrap().unwrap();
    assert_eq!(row.job.state, JobState::Failed(JobFailure::Predecessor(JobId(7))));
    assert_eq!(row.robot, Some(RobotId(2)), "the last one at work on it");
    let failed = JobQuery { states: vec!["failed"], limit: 10, ..JobQuery::default() };
    assert_eq!(store.jobs(&failed).await.unwrap().rows.len(), 1);
    let older = JobQuery { before: Some(JobId(3)), limit: 10, ..JobQuery::default() };
    let ids: Vec<_> = store.jobs(&older).await.unwrap().rows.iter().map(|row| row.id).collect();
    assert_eq!(ids, [JobId(2), JobId(1)]);
    assert_eq!(store.count_jobs().await.unwrap(), (7, 6));
    let named = JobQuery { reference: Some("order 4711".into()), limit: 10, ..JobQuery::default() };
    assert_eq!(store.jobs(&named).await.unwrap().rows.len(), 7);
    let labelled = JobQuery { label: Some(("wave".into(), "2".into())), limit: 10, ..JobQuery::default() };
    let ids: Vec<_> = store.jobs(&labelled).await.unwrap().rows.iter().map(|row| row.id).collect();
    assert_eq!(ids, [JobId(3)]);
}

#[tokio::test]
async fn a_batch_that_is_appended_again_is_written_once_and_a_gap_is_refused() {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let facts = vec![Fact::Job(JobFact::Accepted { job: JobId(1), request: deliver(), at: Time(5) })];
    let batch = [StepEntry { at: Time(5), facts, causes: Vec::new() }];
    store.append(1, &batch).await.unwrap();
    store.append(1, &batch).await.unwrap();
    assert_eq!(store.load(empty_ledger()).await.unwrap().facts(), 1);
    let gap = store.append(5, &batch).await.unwrap_err();
    assert!(matches!(gap, StoreError::OutOfStep { expected: 4, found: 1 }) && gap.is_fatal(), "{gap}");
    let double = store.append(2, &batch).await.unwrap_err();
    assert!(double.is_fatal(), "the same job twice: {double}");
    assert_eq!(store.load(empty_ledger()).await.unwrap().facts(), 1, "all or none");
}

#[tokio::test]
async fn a_database_belongs_to_its_map() {
    let folder = Folder::new();
    drop(Store::open(&folder.database(), &map()).await.unwrap());
    let mut other = map();
    let last = other.racks.ids().next_back().unwrap();
    other.racks[last].name = "another".into();
    let error = Store::open(&folder.database(), &other).await.unwrap_err().to_string();
    assert!(error.contains("use another --database, or the same map"), "{error}");
    // Holds that were promised may overlap on it, so it is refused in words and not found out by a panic.
    let mut moved = map();
    let node = moved.nodes.ids().next().unwrap();
    moved.nodes[node].at.x += 0.15;
    let error = Store::open(&folder.database(), &moved).await.unwrap_err().to_string();
    assert!(error.contains("where they are"), "{error}");
    let mut faster = map();
    faster.name = "renamed".into();
    Store::open(&folder.database(), &faster).await.unwrap();
}

/// Waits until health has this status.
async fn wait_for_health(at: SocketAddr, status: u16) -> String {
    let becomes = async || Some(get(at, "/v1/health").await).filter(|answer| answer.status == status);
    eventually(&format!("health becomes {status}"), becomes).await.text
}

#[tokio::test(flavor = "multi_thread")]
async fn a_locked_database_delays_answers_and_loses_nothing() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let before = post(at, None, &delivery(0)).await.unwrap().json();
    let options = SqliteConnectOptions::new().filename(folder.database());
    let mut other = SqliteConnection::connect_with(&options).await.unwrap();
    sqlx::query("BEGIN EXCLUSIVE").execute(&mut other).await.unwrap();
    let late = tokio::spawn(async move { post(at, Some("late"), &delivery(1)).await.unwrap() });
    let text = wait_for_health(at, 503).await;
    assert!(text.contains("journal"), "{text}");
    assert!(!late.is_finished(), "not durable, not acknowledged");
    let refused = post(at, None, &delivery(2)).await.unwrap();
    refused.problem(503);
    assert!(refused.header("retry-after").is_some());
    assert_eq!(
        get(at, &format!("/v1/jobs/{}", before["id"].as_str().unwrap())).await.status,
        200,
        "reads go on"
    );
    sqlx::query("COMMIT").execute(&mut other).await.unwrap();
    let late = late.await.unwrap();
    assert_eq!(late.status, 201, "{late:?}");
    wait_for_health(at, 200).await;
    assert_eq!(post(at, None, &delivery(2)).await.unwrap().status, 201);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_full_disk_stops_acknowledgements_and_loses_nothing() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    server.store().cap(1).await.unwrap();
    let mut acknowledged = Vec::new();
    for i in 0..400 {
        let key = format!("{i:0200}");
        let answer = post(at, Some(&key), &delivery(i)).await.unwrap();
        if answer.status != 201 {
            answer.problem(503);
            break;
        }
        acknowledged.push(answer.json()["id"].clone());
    }
    let text = wait_for_health(at, 503).await;
    assert!(text.contains("the disk is full; make room"), "{text}");
    assert!(acknowledged.len() < 400, "the cap holds");
    server.store().cap(1 << 20).await.unwrap();
    wait_for_health(at, 200).await;
    acknowledged.push(post(at, None, &delivery(0)).await.unwrap().json()["id"].clone());
    let listed = all_jobs(at, 500).await;
    for id in acknowledged {
        assert_eq!(listed.iter().filter(|j| j["id"] == id).count(), 1, "{id}");
    }
    server.stop().await.unwrap();
}

#[tokio::test]
async fn a_worker_who_is_noted_again_is_no_event_and_a_replan_is_one_with_both_ways() {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let (worker, at) = (WorkerId(1), Time(1_800_000_000_000_000));
    let place = LastPlace { at: Spot { x_mm: 1, y_mm: 2 }, seen: at, within_mm: None };
    let noted = Fact::Worker(WorkerFact::Noted { worker, place });
    let facts = vec![
        Fact::Worker(WorkerFact::Registered { worker, name: "anna".into(), at }),
        noted.clone(),
        noted.clone(),
        Fact::Encounter(EncounterFact::Deviated { worker, at }),
        noted.clone(),
        Fact::Worker(WorkerFact::Cleared { worker, by: None, at }),
        noted,
    ];
    let facts: Vec<Fact> = facts.into_iter().chain(notes(at)).collect();
    store.append(1, &entries(facts)).await.unwrap();
    let query = EventQuery { limit: 100, ..EventQuery::default() };
    let events = store.events(&query).await.unwrap();
    let states: Vec<(Option<&str>, &str)> = (events.iter().filter(|e| e.kind == EventKind::Worker))
        .map(|e| (e.old.as_deref(), e.new.as_str()))
        .collect();
    let expected = [
        (None, "registered"),
        (Some("registered"), "on_floor"),
        (Some("on_floor"), "left"),
        (Some("left"), "on_floor"),
    ];
    assert_eq!(states, expected);
    let of = |kind| events.iter().filter(move |e| e.kind == kind);
    assert_eq!(of(EventKind::WorkerDeviated).count(), 1);
    let replans: Vec<_> = of(EventKind::RobotReplanned).collect();
    assert_eq!(
        replans.iter().map(|e| e.new.as_str()).collect::<Vec<_>>(),
        ["worker", "closure", "robot", "obstruction"]
    );
    let Some(EventDetails::Replanned { cause, was, now }) = &replans[0].details else {
        panic!("{replans:?}")
    };
    assert_eq!((*cause, was.len(), now.len()), (ReplanCause::Worker(worker), 2, 1));
    assert_eq!((replans[0].old.as_ref(), replans[0].worker), (None, Some(worker)));
    let goal: Vec<_> = of(EventKind::WorkerGoal).filter_map(|e| e.details.clone()).collect();
    assert_eq!(goal, [EventDetails::Goal { place: Spot { x_mm: 3100, y_mm: -40 }, percent: 72 }]);
    let history = RobotEventQuery {
        robot: RobotId(2),
        name: "robot-3".into(),
        from: None,
        to: None,
        before: None,
        limit: 10,
    };
    let history = store.robot_events(&history).await.unwrap();
    assert_eq!(
        history.iter().filter(|row| row.source == RobotEventSource::Replan && row.details.is_some()).count(),
        4
    );
}

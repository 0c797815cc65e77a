//! The order in which waiting jobs are kept is the order in which they would be sorted; and closures that come and go
//! leave the same conditions as if they were looked at in every step.

use super::*;
use giveway_fleet::state::index::urgency_ms;
use giveway_floor::geometry::Spot;
use giveway_floor::id::{BodyId, ClosureId};
use giveway_floor::route::{Cause, Condition, Effect};
use giveway_floor::time::Window;
use proptest::prelude::*;

/// What happens to jobs: one is accepted, one is taken out, one gets another priority.
#[derive(Clone, Debug)]
enum OrderEvent {
    Accept { rack: u32, station: u32, priority: u8, due_s: Option<i64>, after: Option<u64> },
    End { job: u64, well: bool },
    Prioritise { job: u64, priority: u8 },
}

fn event() -> impl Strategy<Value = OrderEvent> {
    let due = proptest::option::of(-100..2_000i64);
    let accept = (0u32..6, 0u32..1, 0u8..10, due, proptest::option::of(1u64..40));
    prop_oneof![
        4 => accept.prop_map(|(rack, station, priority, due_s, after)| {
            OrderEvent::Accept { rack, station, priority, due_s, after }
        }),
        1 => (1u64..40, any::<bool>()).prop_map(|(job, well)| OrderEvent::End { job, well }),
        1 => (1u64..40, 0u8..10).prop_map(|(job, priority)| OrderEvent::Prioritise { job, priority }),
    ]
}

fn take_in(ledger: &mut Ledger, event: &OrderEvent, at: Time) {
    let live = |l: &Ledger, job: u64| l.jobs.contains_key(&JobId(job));
    match *event {
        OrderEvent::Accept { rack, station, priority, due_s, after } => {
            let (robot, station) = (RobotId(0), StationId(station));
            // Jobs that a robot can begin and end at once, among deliveries, which wait.
            let kind = match rack {
                0 => JobKind::Park { robot },
                _ => JobKind::Deliver { rack: RackId(rack), station, pick: None },
            };
            let after = after.filter(|a| *a < ledger.next_job).map(JobId).into_iter().collect();
            let deadline = due_s.map(|s| at + Span::from_secs(s));
            let request = JobRequest { priority, deadline, after, ..JobRequest::new(kind) };
            ledger.evolve(&Fact::Job(JobFact::Accepted { job: JobId(ledger.next_job), request, at }));
        }
        OrderEvent::End { job, well } if live(ledger, job) => end(ledger, JobId(job), well, at),
        OrderEvent::Prioritise { job, priority } if live(ledger, job) => {
            ledger.evolve(&Fact::Job(JobFact::Prioritised { job: JobId(job), priority, at }));
        }
        OrderEvent::End { .. } | OrderEvent::Prioritise { .. } => {}
    }
}

/// Cancels a job, or ends it as done if the robot can begin it at once.
fn end(ledger: &mut Ledger, job: JobId, well: bool, at: Time) {
    let ends = |state, tasked| Fact::Job(JobFact::Progressed { job, state, tasked, at });
    let record = &ledger.jobs[&job];
    let (Some(robot), true, true) = (record.request.kind.robot(), well, is_ready(ledger, record)) else {
        return ledger.evolve(&ends(JobState::Cancelled, None));
    };
    let stay = ledger.node_of(robot);
    let task = Task::Move { job: Some(job), goal: stay, stay, purpose: Purpose::Park };
    ledger.evolve(&ends(JobState::Assigned { robot }, Some((robot, task))));
    ledger.evolve(&ends(JobState::Done, Some((robot, Task::Idle))));
}

/// Whether nothing keeps a job from starting, computed from the ledger alone.
fn is_ready(ledger: &Ledger, job: &Job) -> bool {
    let is_over = |a: &JobId| !ledger.jobs.contains_key(a) && !ledger.ended_badly.contains_key(a);
    job.request.after.iter().all(is_over)
}

/// The urgency of all waiting jobs by number, computed one by one.
fn urgencies(ledger: &Ledger, now: Time) -> Vec<(JobId, i64)> {
    let urgency = |job: &Job| {
        let same = ledger.jobs.values().filter(|j| j.request.priority == job.request.priority);
        let oldest = same.filter(|j| is_ready(ledger, j)).map(|j| j.accepted).min().unwrap_or(now);
        urgency_ms(job.request.priority, job.accepted, job.request.deadline, now, oldest)
    };
    ledger.jobs.iter().map(|(id, job)| (*id, urgency(job))).collect()
}

proptest! {
    #[test]
    fn waiting_jobs_come_in_order_of_urgency_and_for_each_rack_the_most_urgent_is_offered_first(
        events in proptest::collection::vec((event(), 0i64..90), 1..60),
    ) {
        let mut ledger = Ledger::new(Arc::new(lab()), &[with_clearance(Span::from_millis(500))], false);
        let mut now = Time::ZERO;
        let (robot, node) = (RobotId(0), ledger.warehouse().nodes_where(|k| k == NodeKind::Parking)[0]);
        let (name, kind) = ("one".into(), "robot".into());
        ledger.evolve(&RobotFact::Registered { robot, name, kind, node, at: now }.into());
        for (event, pause_s) in &events {
            take_in(&mut ledger, event, now);
            now += Span::from_secs(*pause_s);
            ledger.advance_queue(now);
        }
        ledger.assert_indexed();
        let known = urgencies(&ledger, now);
        let of = |id: JobId| known.iter().find(|(j, _)| *j == id).expect("it waits").1;
        let order: Vec<JobId> = ledger.index().queue.in_order(now).collect();
        prop_assert_eq!(order.len(), ledger.jobs.len());
        // If the urgency of two jobs differs by less than rounding, either may come first.
        prop_assert!(order.windows(2).all(|w| of(w[0]) + 2 >= of(w[1])), "{order:?} {known:?}");
        let mut offered: Vec<JobId> = ledger.index().queue.offers(now, |_| true).collect();
        let mut seen = std::collections::BTreeSet::new();
        offered.retain(|id| seen.insert(ledger.jobs[id].request.kind.rack()));
        for id in &offered {
            let rack = ledger.jobs[id].request.kind.rack();
            let same = (ledger.jobs.iter()).filter(|(_, j)| j.request.kind.rack() == rack && is_ready(&ledger, j));
            let best = same.map(|(id, _)| of(*id)).max().expect("it is offered");
            prop_assert!(is_ready(&ledger, &ledger.jobs[id]) && of(*id) + 2 >= best);
        }
        let ready = ledger.jobs.values().filter(|j| is_ready(&ledger, j));
        let racks = ready.filter_map(|j| j.request.kind.rack());
        prop_assert_eq!(seen.len(), racks.collect::<std::collections::BTreeSet<_>>().len());
    }
}

fn close(floor: &mut TestFloor, nodes: Vec<NodeId>, from_s: i64, until_s: i64) -> ClosureId {
    let at = |s: i64| floor.now + Span::from_secs(s);
    let spot = |x: f64| Spot::from(giveway_floor::geometry::Point::new(x, x * x));
    let (window, outline) = (Window::new(at(from_s), at(until_s)), vec![spot(0.0), spot(1.0), spot(2.0)]);
    let area = Closure { outline, nodes, window, reason: "test".into(), binds: Binds::Robots, series: None };
    match floor.step(vec![Input::ask(9, FloorAction::Close(area))]).replies.remove(0).answer {
        Ok(Answer::Closure(closure)) => closure,
        other => panic!("not closed: {other:?}"),
    }
}

#[test]
fn closures_that_come_and_go_leave_the_conditions_that_the_list_says() {
    let mut floor = TestFloor::lab(1);
    let nodes = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Aisle);
    let [a, b, c] = [nodes[2], nodes[3], nodes[4]];
    close(&mut floor, vec![a, b, a], 10, 60);
    let second = close(&mut floor, vec![b, c], 300, 600);
    close(&mut floor, vec![c], 170, 200);
    let mut changes = 0;
    let mut before = String::new();
    for step in 0..4_000 {
        let extra = if step == 2_500 { vec![Input::ask(9, FloorAction::Reopen(second))] } else { vec![] };
        floor.step(extra);
        let now = floor.now - floor.fleet.settings().period;
        let closures = &floor.fleet.ledger().closures;
        for node in floor.fleet.warehouse().nodes.ids() {
            let open = closures.iter().filter(|(_, k)| k.nodes.contains(&node) && now < k.window.end());
            let wanted = open.map(|(id, k)| Condition {
                window: k.window,
                effect: Effect::Closed,
                cause: Cause::Closure(*id),
            });
            let wanted: Vec<Condition> = wanted.collect();
            assert_eq!(
                floor.fleet.internals().writer.restrictions.conditions.of(BodyId(0)).of(node),
                wanted,
                "{node:?} at {now}"
            );
            let soon = Window::new(now, now + Span::from_secs(180));
            let counts = wanted.iter().any(|k| k.window.overlaps(soon));
            assert!(!counts || floor.fleet.internals().writer.floor().is_closing(node), "{node:?} at {now}");
        }
        let state = format!("{:?}", floor.fleet.internals().writer.restrictions.areas);
        changes += usize::from(state != before);
        before = state;
    }
    assert!(changes < 20, "closures are looked at when they change: {changes} times in 4000 steps");
}

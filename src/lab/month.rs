//! A small floor for a long time: jobs, workers, assignments and closures come and go, day after day.
//!
//! Main types: [`Day`] (what the fleet keeps at the end of a day); main function: [`run`]. Steps of a second make a
//! month quick. Refuses: to read the memory of the process; the caller does, at the end of each day.

use giveway_fleet::{
    AssignmentRequest, Binds, Closure, Fleet, FloorAction, Input, JobAction, JobKind, JobRequest,
    WorkerAction,
};
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::{AssignmentId, Dense, JobId, NodeId, RackId, StationId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_people::human::{Quality, Sighting, SourceId};
use giveway_sim::{Scenario, World};
use std::sync::Arc;

const MINUTE: i64 = 60;
const HOUR: i64 = 3_600;
const DAY: i64 = 86_400;
/// Number of workers who come in turn, one each hour.
const WORKERS: i64 = 10;
/// How much of its hour a worker is on the floor, seconds.
const ON_FLOOR: i64 = 20 * MINUTE;

/// What the fleet keeps at the end of a day.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Day {
    /// Number of the day, from 1.
    pub day: u64,
    /// Jobs accepted and done so far.
    pub jobs: [u64; 2],
    /// Assignments accepted so far.
    pub assignments: u64,
    /// Closures announced so far.
    pub closures: u64,
    /// Number of open jobs.
    pub open_jobs: usize,
    /// Number of open assignments.
    pub open_assignments: usize,
    /// Number of closures that are kept.
    pub kept_closures: usize,
    /// Number of badly ended jobs that are kept.
    pub bad_ends: usize,
    /// Number of customers' keys that are kept.
    pub keys: usize,
}

/// Runs `days` days with `robots` robots; calls `at_end` after each.
///
/// # Panics
/// If its own scenario text is refused, which would be a bug here.
pub fn run(warehouse: &Arc<Warehouse>, robots: usize, days: u64, mut at_end: impl FnMut(&Day)) {
    let text = format!(
        r#"{{"giveway_scenario": 1, "name": "month", "map": "-", "robots": {robots}, "period_ms": 1000,
            "jobs": {{"per_hour": 40}}, "customers": {{"twice": 0.5}},
            "faults": {{"failures_per_hour": 0.2, "repair_s": 120}}}}"#
    );
    let scenario = Scenario::parse(&text).expect("the text is a scenario");
    let mut fleet = Fleet::new(warehouse.clone(), scenario.site.settings());
    let mut world = World::new(warehouse.clone(), &scenario, &[], 1, fleet.ledger(), Time::ZERO);
    let aisles = warehouse.nodes_where(|k| k == NodeKind::Aisle);
    let mut s = 0;
    for day in 1..=days {
        while s < day as i64 * DAY {
            let now = Time::ZERO + Span::from_secs(s);
            let mut inputs = world.advance(now, fleet.ledger());
            people(warehouse, &aisles, &fleet, s, now, &mut inputs);
            orders(warehouse, &aisles, &fleet, s, now, &mut inputs);
            let done = fleet.step(now, inputs);
            drop(fleet.take_plan_times());
            world.take(now, &done);
            s += 1;
        }
        at_end(&what_is_kept(&fleet, day));
    }
}

fn what_is_kept(fleet: &Fleet, day: u64) -> Day {
    let l = fleet.ledger();
    Day {
        day,
        jobs: [l.next_job - 1, l.counts.done],
        assignments: l.next_assignment - 1,
        closures: l.next_closure - 1,
        open_jobs: l.jobs.len(),
        open_assignments: l.assignments.len(),
        kept_closures: l.closures.len(),
        bad_ends: l.ended_badly.len(),
        keys: l.keys.len() + l.assignment_keys.len(),
    }
}

/// One worker an hour walks to and fro, has an assignment, and leaves; open assignments are then taken back.
fn people(w: &Warehouse, aisles: &[NodeId], fleet: &Fleet, s: i64, now: Time, inputs: &mut Vec<Input>) {
    let (hour, second) = (s / HOUR, s % HOUR);
    let worker = WorkerId((hour % WORKERS) as u32);
    match second {
        0 => inputs.push(Input::ask(0, WorkerAction::Register(format!("worker-{}", worker.0)))),
        1 => {
            let place = aisles[(hour * 31) as usize % aisles.len()];
            let stay = Span::from_secs(30);
            let request = AssignmentRequest {
                place,
                stay,
                what: "round".into(),
                key: Some(format!("round {hour}").into()),
            };
            inputs.push(Input::ask(0, WorkerAction::Assign { worker: Some(worker), request }));
        }
        ON_FLOOR => {
            inputs.push(Input::ask(0, WorkerAction::Clear { worker, by: "month".into() }));
            let left: Vec<AssignmentId> = fleet.ledger().assignments.keys().copied().collect();
            inputs
                .extend(left.into_iter().map(|assignment| Input::ask(0, WorkerAction::Unassign(assignment))));
        }
        2..ON_FLOOR => {
            let node = |i: i64| w.nodes[aisles[(hour * 7 + i) as usize % aisles.len()]].at;
            let (a, b) = (node(0), node(aisles.len() as i64 / 3));
            let share = ((second % 60) as f64 / 30.0 - 1.0).abs();
            let at = a + (b - a) * share;
            let seq = s.unsigned_abs();
            let (heading, accuracy_m, quality) = (Some(0.0), 0.05, Quality::Tracked);
            let seen = now;
            let (source, epoch, at_marks) = (SourceId::Headset, 1, true);
            inputs.push(Input::Sighted(Sighting {
                mirror: None,
                worker,
                source,
                seen,
                epoch,
                at_marks,
                seq,
                at,
                heading,
                accuracy_m,
                quality,
            }));
        }
        _ => {}
    }
}

/// Twice an hour a closure; once an hour a job that three others wait for, which is cancelled a minute later.
fn orders(w: &Warehouse, aisles: &[NodeId], fleet: &Fleet, s: i64, now: Time, inputs: &mut Vec<Input>) {
    if s % (HOUR / 2) == 5 {
        let at = |seconds: i64| now + Span::from_secs(seconds);
        let node = aisles[(s / (HOUR / 2) * 11) as usize % aisles.len()];
        let spot = |x: f64| Spot::from(Point::new(x, x * x));
        let outline = vec![spot(0.0), spot(1.0), spot(2.0)];
        let window = Window::new(at(4 * MINUTE), at(9 * MINUTE));
        let area = Closure {
            outline,
            nodes: vec![node],
            window,
            reason: "cleaning".into(),
            binds: Binds::Robots,
            series: None,
        };
        inputs.push(Input::ask(0, FloorAction::Close(area)));
    }
    if s % HOUR == 10 {
        let next = fleet.ledger().next_job;
        let rack = RackId::at((s / HOUR) as usize % w.racks.len());
        let kind = JobKind::Deliver { rack, station: StationId(0), pick: None };
        for i in 0..4 {
            let after = if i == 0 { vec![] } else { vec![JobId(next)] };
            let key = Some(format!("order {s}, line {i}"));
            let request = JobRequest {
                priority: 1,
                deadline: Some(now),
                after,
                key: key.map(Into::into),
                ..JobRequest::new(kind)
            };
            inputs.push(Input::ask(0, JobAction::Submit(request)));
        }
    }
    if s % HOUR == 10 + MINUTE {
        let first = fleet.ledger().jobs.iter().find(|(_, j)| !j.request.after.is_empty());
        let job = first.map(|(_, j)| j.request.after[0]);
        inputs.extend(job.map(|job| Input::ask(0, JobAction::Cancel(job))));
    }
}

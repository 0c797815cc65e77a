//! What one step of the fleet costs on floors where much exists and little changes.
//!
//! Main types: [`StepsCase`] (what exists), [`Measured`]; main function: [`run`]. Robots, radios and batteries are
//! those of the simulator; only [`Fleet::step`] is timed. Refuses: to look at a clock itself; the caller passes a
//! stopwatch in.

use giveway_cell::{OrderLine, PickedBy};
use giveway_fleet::{
    AssignmentRequest, Binds, Closure, Fleet, FloorAction, Input, JobAction, JobKind, JobRequest, Settings,
    WorkerAction,
};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{Dense, JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::{NodeKind, SlotName, Station, Warehouse};
use giveway_people::human::{Quality, Sighting, SourceId};
use giveway_sim::{Scenario, World};
use std::sync::Arc;

/// Requests per step while the floor is filled.
pub(super) const PER_STEP: usize = 2_000;
/// Number of workers with assignments.
const WORKERS: usize = 10;
/// Number of nodes per closure.
const CLOSED_NODES: usize = 4;

/// What exists on the floor while steps are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepsCase {
    /// Robots without anything to do.
    Idle,
    /// Announced areas, half of them over already, half of them hours ahead.
    Closures(usize),
    /// Jobs that wait for one that does not end.
    WaitingAfter(usize),
    /// Jobs for one rack that a robot already has.
    WaitingRack(usize),
    /// Jobs that could start at once if a robot were free.
    Waiting(usize),
    /// Open assignments of ten workers, who are on the floor.
    Assignments(usize),
    /// Jobs with order lines that could start at once, on a map with work cells. No hands are seen there, and a button
    /// confirms each line.
    Lines(usize),
    /// Jobs with order lines on a map with work cells where all hands are seen and the map's robot arms work.
    Staffed(usize),
}

/// Results of the measurement.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Durations of steps, nanoseconds, ascending.
    pub step_ns: Vec<u64>,
    /// Share of each step spent on recording why robots and people wait, nanoseconds, ascending.
    pub waits_ns: Vec<u64>,
    /// Number of jobs, closures and assignments open at the end.
    pub open: usize,
}

/// Parameters of the measurement.
#[derive(Clone, Copy, Debug)]
pub struct StepSetup {
    /// Number of robots.
    pub robots: usize,
    /// Steps before any is measured.
    pub settle: usize,
    /// Steps that are measured.
    pub steps: usize,
}

/// Fills a floor as the case demands, lets it settle, and measures steps.
///
/// # Panics
/// If its own scenario text is refused, which would be a bug here.
pub fn run(
    warehouse: &Arc<Warehouse>,
    case: StepsCase,
    setup: &StepSetup,
    stopwatch: fn() -> u64,
) -> Measured {
    let text = format!(
        r#"{{"giveway_scenario": 1, "name": "steps", "map": "-", "robots": {}, "period_ms": 50{}}}"#,
        setup.robots,
        cells(warehouse, case)
    );
    let scenario = Scenario::parse(&text).expect("the text is a scenario");
    // Hours after zero, so that closures can already be over.
    let mut now = Time::ZERO + Span::from_secs(4 * 3600);
    let mut fleet = Fleet::new(warehouse.clone(), Settings { stopwatch, ..scenario.site.settings() });
    let mut world = World::new(warehouse.clone(), &scenario, &[], 1, fleet.ledger(), now);
    let mut requests = requests(warehouse, case, now).into_iter();
    let mut measured = Measured::default();
    let filling = requests.len().div_ceil(PER_STEP) + 1;
    for step in 0..filling + setup.settle + setup.steps {
        let mut inputs = world.advance(now, fleet.ledger());
        if step > 0 {
            inputs.extend(requests.by_ref().take(PER_STEP));
        }
        if matches!(case, StepsCase::Assignments(_)) && step > 0 {
            inputs.extend((0..WORKERS).map(|w| sighting(warehouse, w, step as u64, now)));
        }
        let start = stopwatch();
        let done = fleet.step(now, inputs);
        let spent = stopwatch() - start;
        if step >= filling + setup.settle {
            measured.step_ns.push(spent);
            measured.waits_ns.push(fleet.waits_ns());
        }
        world.take(now, &done);
        now += Span::from_millis(50);
    }
    let ledger = fleet.ledger();
    measured.open = ledger.jobs.len() + ledger.closures.len() + ledger.assignments.len();
    measured.step_ns.sort_unstable();
    measured.waits_ns.sort_unstable();
    measured
}

/// The scenario's text for work cells.
fn cells(warehouse: &Warehouse, case: StepsCase) -> String {
    let has_arm = |s: &&Station| s.cell.as_ref().is_some_and(|cell| cell.arm.is_some());
    match case {
        StepsCase::Lines(_) => r#", "cells": {"flow": "usual"}"#.to_owned(),
        StepsCase::Staffed(_) => {
            let arms = warehouse.stations.iter().filter(has_arm).map(|s| format!("\"{}\"", s.name));
            format!(r#", "cells": {{"flow": "seen", "arms": [{}]}}"#, arms.collect::<Vec<_>>().join(", "))
        }
        _ => String::new(),
    }
}

/// Order lines for a visit.
fn lines(i: usize) -> Vec<OrderLine> {
    let line = |k: usize| OrderLine {
        slot: SlotName::new((i + k) as u8 % 4, (i / 4 + 2 * k) as u8 % 5),
        quantity: 1 + ((i + k) % 3) as u32,
        tote: ["A", "B", "C"][(i + k) % 3].to_owned(),
        item: None,
        by: PickedBy::Either,
    };
    vec![line(0), line(1), line(2)]
}

/// Requests sent before anything is measured.
pub(super) fn requests(warehouse: &Warehouse, case: StepsCase, now: Time) -> Vec<Input> {
    let racks = warehouse.racks.len();
    let deliver = |i: usize, rack: usize| JobKind::Deliver {
        rack: RackId::at(rack),
        station: StationId::at(i % warehouse.stations.len()),
        pick: None,
    };
    match case {
        StepsCase::Idle => Vec::new(),
        StepsCase::Closures(n) => (0..n).map(|i| close(warehouse, i, now)).collect(),
        StepsCase::Waiting(n) => (0..n).map(|i| submit(i, deliver(i, i * 7919 % racks), &[])).collect(),
        StepsCase::Lines(n) | StepsCase::Staffed(n) => {
            let job = |i: usize| {
                let request =
                    JobRequest { lines: vec![lines(i)], ..JobRequest::new(deliver(i, i * 7919 % racks)) };
                Input::ask(i as u64, JobAction::Submit(JobRequest { priority: 5, ..request }))
            };
            (0..n).map(job).collect()
        }
        StepsCase::WaitingRack(n) => (0..n).map(|i| submit(i, deliver(0, racks / 2), &[])).collect(),
        StepsCase::WaitingAfter(n) => {
            // A halted robot never gets there.
            let robot = RobotId(0);
            let node = warehouse.racks[RackId::at(racks / 2)].home;
            let halt = Input::ask(0, FloorAction::Halt(Some(robot)));
            let first = submit(0, JobKind::Go { robot, node }, &[]);
            let rest = (1..n).map(|i| submit(i, deliver(i, i * 7919 % racks), &[JobId(1)]));
            [halt, first].into_iter().chain(rest).collect()
        }
        StepsCase::Assignments(n) => {
            let hired = (0..WORKERS).map(|w| Input::ask(0, WorkerAction::Register(format!("worker-{w}"))));
            hired.chain((0..n).map(|i| assign(warehouse, i))).collect()
        }
    }
}

fn submit(token: usize, kind: JobKind, after: &[JobId]) -> Input {
    let request = JobRequest { priority: 5, after: after.to_vec(), ..JobRequest::new(kind) };
    Input::ask(token as u64, JobAction::Submit(request))
}

/// A closure of a few nodes. The nodes are named; the outline is only there for display.
fn close(warehouse: &Warehouse, i: usize, now: Time) -> Input {
    let nodes = (0..CLOSED_NODES).map(|k| NodeId::at((i * 7 + k) % warehouse.nodes.len())).collect();
    let hour = Span::from_secs(3600);
    let start = if i.is_multiple_of(2) { now + hour } else { now - hour * 2 };
    let spot = |x: f64, y: f64| Spot::from(giveway_floor::geometry::Point::new(x, y));
    let outline = vec![spot(0.0, 0.0), spot(1.0, 0.0), spot(1.0, 1.0)];
    let window = Window::new(start, start + hour);
    Input::ask(
        i as u64,
        FloorAction::Close(Closure {
            outline,
            nodes,
            window,
            reason: "bench".into(),
            binds: Binds::Robots,
            series: None,
        }),
    )
}

fn assign(warehouse: &Warehouse, i: usize) -> Input {
    let places = warehouse.nodes_where(|k| k == NodeKind::Storage);
    let place = places[i * 7919 % places.len().min(200)];
    let request = AssignmentRequest { place, stay: Span::from_secs(60), what: "bench".into(), key: None };
    Input::ask(i as u64, WorkerAction::Assign { worker: Some(WorkerId::at(i % WORKERS)), request })
}

/// A sighting of a worker who stands at an aisle.
fn sighting(warehouse: &Warehouse, worker: usize, seq: u64, now: Time) -> Input {
    let aisles = warehouse.nodes_where(|k| k == NodeKind::Aisle);
    let at = warehouse.nodes[aisles[(worker + 1) * aisles.len() / (WORKERS + 2)]].at;
    let worker = WorkerId::at(worker);
    let (heading, accuracy_m, quality) = (Some(0.0), 0.05, Quality::Tracked);
    let (source, at_marks) = (SourceId::Headset, true);
    Input::Sighted(Sighting {
        mirror: None,
        worker,
        source,
        seen: now,
        epoch: 1,
        at_marks,
        seq,
        at,
        heading,
        accuracy_m,
        quality,
    })
}

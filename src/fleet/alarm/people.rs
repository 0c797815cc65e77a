//! What is wrong with people on the floor: lost, kept in one spot, in a closed area.
//!
//! Main function: [`conditions`]. Refuses: to say anything about a worker who is where the fleet expects people.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind};
use super::kind::{AlarmKind, AlarmSeverity};
use super::roots::Roots;
use crate::{Edge, Fleet, Party, View};
use giveway_floor::id::{Dense, RobotId, WorkerId};
use giveway_floor::text::sentence::alarms;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::Span;
use std::collections::{BTreeMap, BTreeSet};

/// A worker of whom no source has known for this long has to be looked for.
const LOST: Span = Span::from_secs(30);
/// How long a person may be kept in one spot.
const KEPT: Span = Span::from_secs(60);

/// What is wrong with people. If the robot that keeps a person has a cause of its own, only that cause is reported.
pub(super) fn conditions(
    fleet: &Fleet,
    view: &View,
    roots: &Roots,
    robots: &BTreeMap<RobotId, AlarmCondition>,
) -> Vec<AlarmCondition> {
    let mut found = Vec::new();
    for lost in fleet.lost_workers(LOST, view.now) {
        let behind = roots.behind(Party::Worker(lost.worker));
        let waiting: BTreeSet<RobotId> = lost.waiting.iter().chain(behind).copied().collect();
        let name = called(fleet, lost.worker);
        let said = match waiting.len() {
            0 => alarms::worker_lost(name),
            1 => alarms::worker_lost_one_waits(name),
            n => alarms::worker_lost_robots_wait(name, n),
        };
        let severity = if waiting.is_empty() { AlarmSeverity::Warning } else { AlarmSeverity::Critical };
        let one = about(view, AlarmKind::WorkerLost, lost.worker, said).at_least(severity);
        found.push(AlarmCondition { waiting: waiting.len(), since: Some(view.now - lost.silent), ..one });
    }
    for (worker, waited) in fleet.kept_workers(KEPT) {
        let by = match fleet.wait(Party::Worker(worker)).edge {
            Edge::On(Party::Robot(robot)) => Some(robot),
            _ => None,
        };
        if by.is_some_and(|robot| robots.contains_key(&robot)) {
            continue;
        }
        let name = called(fleet, worker);
        let said = match by {
            Some(robot) => alarms::worker_kept_by(name, &fleet.ledger().robots[robot].name),
            None => alarms::worker_kept(name),
        };
        let one = about(view, AlarmKind::WorkerKept, worker, said);
        found.push(AlarmCondition { since: Some(view.now - waited), ..one });
    }
    for (worker, closure) in fleet.in_closed_areas(view.now) {
        let reason = fleet.ledger().closures.get(&closure).map_or("", |c| c.reason.as_str());
        let area = format!("c{}", closure.0);
        let said = alarms::worker_in_closed_area(called(fleet, worker), area, reason);
        found.push(about(view, AlarmKind::WorkerInClosedArea, worker, said));
    }
    found
}

fn about(view: &View, kind: AlarmKind, worker: WorkerId, text: Sentence) -> AlarmCondition {
    let subject = AlarmSubject::new(SubjectKind::Worker, format!("w{}", worker.0 + 1));
    let found = AlarmCondition::new(kind, subject, text);
    match view.workers.get(worker.ix()).and_then(|w| w.pose) {
        Some(pose) => found.at(pose.at),
        None => found,
    }
}

/// What people call a worker, with the number.
pub(super) fn called(fleet: &Fleet, worker: WorkerId) -> SentenceArg {
    let number = worker.0 + 1;
    match fleet.ledger().workers.get(worker) {
        Some(name) => format!("{name} (w{number})").into(),
        None => alarms::worker_numbered(number).into(),
    }
}

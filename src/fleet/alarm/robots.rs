//! What is wrong with single robots. A robot that merely waits behind another one has no condition of its own.
//!
//! Main type: [`RobotWatch`]. Refuses: to report a robot twice: of several conditions, the first in order of cause.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind};
use super::displaced::words;
use super::kind::{AlarmKind, AlarmSeverity};
use super::roots::{Roots, robots_wait};
use crate::{Because, Doing, Edge, Fault, Fleet, Party, RobotView, Task, View, Why};
use giveway_floor::id::{Dense, NodeId, RobotId};
use giveway_floor::text::sentence::{alarms, remedies};
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// A robot with a task that could go on and has made no progress for this long is stuck.
const STUCK: Span = Span::from_secs(120);
/// A robot that waits for others is stuck only after this: the cause is theirs, and busy stations have long queues.
const STUCK_BEHIND: Span = Span::from_secs(3600);
/// A robot that left the floor and was heard of within this still reports.
const REPORTS: Span = Span::from_secs(10);
/// If this many robots wait for one thing, a person has to act at once.
const SEVERE: usize = 5;

/// What a robot did last, and since when it has done nothing more.
#[derive(Clone, Copy, Debug)]
struct Progress {
    visit: u64,
    acted: Option<u64>,
    since: Time,
    /// Since when the robot has done nothing more although it waits for no other party.
    free_since: Time,
}

/// What is remembered of robots from look to look.
#[derive(Clone, Debug, Default)]
pub(super) struct RobotWatch {
    progress: BTreeMap<RobotId, Progress>,
}

impl RobotWatch {
    /// Notes what every robot has done since the last look.
    pub fn note(&mut self, fleet: &Fleet, now: Time) {
        let ledger = fleet.ledger();
        for (robot, record) in ledger.robots.pairs() {
            let (visit, acted) = (ledger.chain(robot).first(), record.acted);
            let fresh = Progress { visit, acted, since: now, free_since: now };
            let entry = self.progress.entry(robot).or_insert(fresh);
            // A robot that a person stopped goes on as soon as it may; a pick takes as long as it takes.
            let excused = record.task == Task::Idle
                || record.paused.is_some()
                || ledger.stopped.is_some()
                || ledger.evacuation.is_some()
                || fleet.is_picked_from(robot);
            if (entry.visit, entry.acted) != (visit, acted) || excused {
                *entry = fresh;
            } else if waits_for_others(fleet, robot) {
                entry.free_since = now;
            }
        }
    }

    /// For how long a robot has made no progress although it has a task.
    pub fn without_progress(&self, robot: RobotId, now: Time) -> Span {
        self.progress.get(&robot).map_or(Span::ZERO, |p| now - p.since)
    }

    /// The conditions of single robots, by robot.
    pub fn conditions(&self, fleet: &Fleet, view: &View, roots: &Roots) -> BTreeMap<RobotId, AlarmCondition> {
        let looked = |(i, row): (usize, &RobotView)| {
            let robot = RobotId::at(i);
            let waiting = roots.behind(Party::Robot(robot)).len();
            let found = self.condition(fleet, view, robot, robots_wait(waiting))?;
            let severity = if waiting >= SEVERE { AlarmSeverity::Critical } else { AlarmSeverity::Notice };
            Some((robot, AlarmCondition { waiting, ..found }.at_least(severity).at(row.pose.at)))
        };
        let mut found: BTreeMap<_, _> = view.robots.iter().enumerate().filter_map(looked).collect();
        // Only now is it known which robots have a cause of their own: a robot behind one of them is not stuck.
        let stuck: Vec<RobotId> =
            found.iter().filter(|(_, c)| c.kind == AlarmKind::RobotStuck).map(|(r, _)| *r).collect();
        for robot in stuck {
            let root = roots.root(robot);
            if root != Party::Robot(robot) && matches!(root, Party::Robot(r) if found.contains_key(&r)) {
                found.remove(&robot);
            }
        }
        found
    }

    /// What is wrong with a robot; `waiting` says how many others wait for it, as the end of the sentence.
    fn condition(
        &self,
        fleet: &Fleet,
        view: &View,
        robot: RobotId,
        waiting: Option<Sentence>,
    ) -> Option<AlarmCondition> {
        let record = &fleet.ledger().robots[robot];
        let is = |kind, text: Sentence| {
            let subject = AlarmSubject::new(SubjectKind::Robot, record.name.clone());
            Some(AlarmCondition::new(kind, subject, text))
        };
        let name = &record.name;
        if record.is_gone() {
            let heard = fleet.telemetry(robot).is_some_and(|t| view.now - t.seen <= REPORTS);
            return heard.then(|| is(AlarmKind::RobotReturned, alarms::robot_returned(name, waiting)))?;
        }
        if record.fenced.is_some() {
            return is(AlarmKind::RobotFenced, alarms::robot_fenced(name, waiting));
        }
        if is_beyond_grant(fleet, robot) {
            return is(AlarmKind::BeyondGrant, alarms::robot_beyond_grant(name, waiting));
        }
        let fault = fault(fleet, view, robot, waiting.clone());
        if let Some((kind, text)) = fault {
            return is(kind, text);
        }
        let since = self.stuck_since(fleet, view, robot)?;
        let found = is(AlarmKind::RobotStuck, alarms::robot_stuck(name, waiting))?;
        Some(AlarmCondition { since: Some(since), ..found })
    }

    /// Since when a robot has made no progress although it has a task, if that is for long and no person wanted it.
    fn stuck_since(&self, fleet: &Fleet, view: &View, robot: RobotId) -> Option<Time> {
        let stood = self.without_progress(robot, view.now);
        let free = self.progress.get(&robot).map_or(Span::ZERO, |p| view.now - p.free_since);
        if free <= STUCK && stood <= STUCK_BEHIND {
            return None;
        }
        let row = &view.robots[robot.ix()];
        // What a person wanted, and what is planned for later, takes as long as it takes.
        let is_wanted = row.why.is_some_and(|why| why.is_by_itself() || matches!(why, Why::Closed(_)));
        let is_planned = || {
            let first = fleet.waits(robot, view.now).first().copied();
            first
                .is_some_and(|w| matches!(w.because, Because::Later) && w.until.is_some_and(|t| t > view.now))
        };
        (!is_wanted && !is_planned()).then(|| view.now - stood)
    }
}

/// The fault that keeps a robot from going on, if one does.
fn fault(
    fleet: &Fleet,
    view: &View,
    robot: RobotId,
    waiting: Option<Sentence>,
) -> Option<(AlarmKind, Sentence)> {
    let (record, row) = (&fleet.ledger().robots[robot], &view.robots[robot.ix()]);
    let name = &record.name;
    let other = |r: RobotId| fleet.ledger().robots[r].name.clone();
    Some(match row.why {
        Some(Why::EmergencyStop) => (AlarmKind::EmergencyStop, alarms::robot_emergency_stop(name, waiting)),
        Some(Why::Displaced(how)) => {
            let how = words(fleet.warehouse(), other, how);
            (AlarmKind::RobotDisplaced, alarms::robot_displaced(name, how, waiting))
        }
        Some(Why::Silent) => (AlarmKind::RobotSilent, alarms::robot_silent(name, waiting)),
        Some(Why::Unplugged) => (AlarmKind::RobotUnplugged, alarms::robot_unplugged(name, waiting)),
        Some(Why::Obstructed(node)) => {
            let node = &fleet.warehouse().nodes[node].name;
            (AlarmKind::RobotObstructed, alarms::robot_obstructed_before(name, node, waiting))
        }
        // The robot reports it, whatever else it waits for meanwhile, such as another route.
        _ if row.fault == Some(Fault::Obstructed) => {
            (AlarmKind::RobotObstructed, alarms::robot_obstructed(name, waiting))
        }
        Some(Why::NoRoute) if fleet.wait(Party::Robot(robot)).edge == Edge::NoWay => {
            (AlarmKind::RobotBlocked, alarms::robot_finds_no_route(name, waiting))
        }
        // A person with the robot sees what is wrong.
        Some(Why::Manual | Why::Maintenance | Why::Leaving | Why::Gone) => return None,
        _ if record.failed => (AlarmKind::RobotFailed, alarms::robot_failed(name, waiting)),
        _ if is_low(row) => {
            let percent = SentenceArg::rounded(row.battery * 100.0, 0);
            (AlarmKind::RobotLow, alarms::robot_low(name, percent, waiting))
        }
        _ => return None,
    })
}

/// Obstacles that robots have turned away from: no robot stands before them any more, but the way still has to be
/// cleared.
pub(super) fn left_obstacles(
    fleet: &Fleet,
    robots: &BTreeMap<RobotId, AlarmCondition>,
) -> Vec<AlarmCondition> {
    let is_there = |robot: &RobotId| robots.get(robot).is_some_and(|c| c.kind == AlarmKind::RobotObstructed);
    let left = fleet.left_obstacles().into_iter().filter(|(_, robot, _)| !is_there(robot));
    let condition = |(node, robot, since): (NodeId, RobotId, Time)| {
        let (node, name) = (&fleet.warehouse().nodes[node], &fleet.ledger().robots[robot].name);
        let said = alarms::obstacle_left(name, &node.name);
        let subject = AlarmSubject::new(SubjectKind::Robot, name.clone());
        let one = AlarmCondition::new(AlarmKind::RobotObstructed, subject, said).at(node.at);
        AlarmCondition { since: Some(since), remedy: remedies::do_clear_place(), ..one }
    };
    // Two places that one robot found are one alarm.
    let by_robot: BTreeMap<RobotId, AlarmCondition> = left.map(|l| (l.1, condition(l))).collect();
    by_robot.into_values().collect()
}

/// Whether a robot waits for another robot, a person, or something that a person asked for.
fn waits_for_others(fleet: &Fleet, robot: RobotId) -> bool {
    let wanted = |why: Why| why.is_by_itself() || matches!(why, Why::Closed(_)) || why.station().is_some();
    fleet.why(robot).is_some_and(wanted)
        || matches!(fleet.wait(Party::Robot(robot)).edge, Edge::On(_) | Edge::Until(_))
}

/// Whether a robot reports that it reached, or knows of, more than it was granted.
fn is_beyond_grant(fleet: &Fleet, robot: RobotId) -> bool {
    let granted = fleet.ledger().chain(robot).granted();
    fleet.telemetry(robot).is_some_and(|t| t.reached.max(t.known) >= granted)
}

/// Whether a robot has too little charge for any job, and is not on its way to a charger. A robot with a task ends it
/// first, unless less than half of the critical charge is left.
fn is_low(row: &RobotView) -> bool {
    let charges = matches!(row.doing, Doing::Charging | Doing::ToCharger);
    let ends_its_task = row.task != Task::Idle && row.battery >= row.critical / 2.0;
    row.seen.is_some() && row.battery < row.critical && !charges && !ends_its_task
}

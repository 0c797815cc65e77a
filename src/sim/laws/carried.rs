//! The law about racks on robots: no robot carries a rack for long without a way to its goal while it could set the
//! rack down at a free storage place that it can reach.
//!
//! Main type: [`CarryLaws`]. It searches the floor anew, from the areas closed and robots broken at this moment, and
//! uses nothing that the fleet has computed. Refuses: to judge robots that are told to stand, and robots blocked by
//! people or other robots: these do not cut a way off for long.

use super::violation::{CARRIED, Violation};
use crate::world::World;
use giveway_fleet::{Fleet, JobState, RackAt, Task, Telemetry};
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use std::collections::{BTreeMap, BTreeSet};

/// Number of steps between two checks of all robots.
const LOOKS_EVERY: u64 = 50;

/// Robots that stand with a rack and have no way for it: where, and since when.
#[derive(Debug, Default)]
pub(super) struct CarryLaws {
    in_vain: BTreeMap<RobotId, (NodeId, Time)>,
    steps: u64,
}

impl CarryLaws {
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        self.steps += 1;
        if !self.steps.is_multiple_of(LOOKS_EVERY) {
            return Vec::new();
        }
        let held = held(fleet, now);
        if held.is_empty() || fleet.ledger().stopped.is_some() {
            self.in_vain.clear();
            return Vec::new();
        }
        self.look(now, world, fleet, &held)
    }

    /// Checks all robots; no robot passes a node of `held`.
    fn look(&mut self, now: Time, world: &World, fleet: &Fleet, held: &BTreeSet<NodeId>) -> Vec<Violation> {
        let ledger = fleet.ledger();
        let taken = taken_storage(fleet);
        let w = fleet.warehouse();
        let is_free = |n: NodeId, robot: RobotId| {
            w.kind(n) == NodeKind::Storage && taken.get(&n).is_none_or(|by| *by == Some(robot))
        };
        let stands = |(r, t): (RobotId, Telemetry)| (t.speed_mps == 0.0).then(|| ledger.node_of(r));
        let others: BTreeSet<NodeId> = world.truth().filter_map(stands).collect();
        let mut broken = Vec::new();
        for (robot, truth) in world.truth() {
            let here = ledger.node_of(robot);
            let record = &ledger.robots[robot];
            let is_told = !record.failed && record.paused.is_none() && world.takes_orders(robot);
            let may_drive = is_told && truth.fault.is_none();
            let stands = may_drive && truth.speed_mps == 0.0;
            let goal = bound_for(fleet, robot).filter(|g| stands && *g != here);
            let in_vain = goal.is_some_and(|goal| {
                let past_others = || held.iter().chain(&others).copied().collect();
                !reached(w, held, here, goal).contains(&goal)
                    && reached(w, &past_others(), here, goal).iter().any(|n| is_free(*n, robot))
            });
            if !in_vain {
                self.in_vain.remove(&robot);
                continue;
            }
            let (at, since) = self.in_vain.entry(robot).or_insert((here, now));
            if *at != here {
                (*at, *since) = (here, now);
            }
            if now - *since > CARRIED {
                *since = now;
                broken.push(Violation::CarriedInVain(robot));
            }
        }
        broken
    }
}

/// The goal of the rack that a robot carries.
fn bound_for(fleet: &Fleet, robot: RobotId) -> Option<NodeId> {
    let ledger = fleet.ledger();
    match ledger.robots[robot].task {
        Task::Deliver { job, station, store, .. } => match ledger.jobs.get(&job).map(|j| &j.state) {
            Some(JobState::Carrying { .. }) => Some(station),
            Some(JobState::Picking { .. }) => None,
            _ => Some(store),
        },
        Task::Store { store, .. } => Some(store),
        Task::Idle | Task::Fetch { .. } | Task::Move { .. } => None,
    }
}

/// Nodes that are closed to robots, and nodes on or beside which a broken robot stands.
fn held(fleet: &Fleet, now: Time) -> BTreeSet<NodeId> {
    let (ledger, w) = (fleet.ledger(), fleet.warehouse());
    let closed = ledger.closures.values().filter(|c| c.binds.robots() && c.window.contains(now));
    let closed = closed.flat_map(|c| fleet.closed_by(c));
    let failed = ledger.present().filter(|r| ledger.robots[*r].failed).map(|r| ledger.node_of(r));
    let beside = |n: NodeId| w.conflicts(w.node_resource(n)).iter().filter_map(|r| w.resource(*r).ok());
    closed.chain(failed.flat_map(|n| beside(n).chain([n]))).collect()
}

/// Storage nodes that hold a rack or that a robot is bringing one to, with that robot.
fn taken_storage(fleet: &Fleet) -> BTreeMap<NodeId, Option<RobotId>> {
    let ledger = fleet.ledger();
    let promised = ledger.robots.pairs().filter_map(|(robot, r)| match r.task {
        Task::Deliver { store, .. } | Task::Store { store, .. } => Some((store, Some(robot))),
        Task::Fetch { .. } | Task::Idle | Task::Move { .. } => None,
    });
    let stored = ledger.racks.iter().filter_map(|r| if let RackAt::Stored(n) = r { Some(*n) } else { None });
    promised.chain(stored.map(|n| (n, None))).collect()
}

/// Nodes that a loaded robot can reach on its way to a goal, without passing held nodes, storage, or the places of a
/// station other than its own.
fn reached(w: &Warehouse, held: &BTreeSet<NodeId>, here: NodeId, goal: NodeId) -> BTreeSet<NodeId> {
    let bound = w.kind(goal).reserved_for();
    let (mut seen, mut next) = (BTreeSet::from([here]), vec![here]);
    while let Some(node) = next.pop() {
        if node != here && w.kind(node) == NodeKind::Storage {
            continue;
        }
        let leaves = w.kind(node).reserved_for();
        for (_, arc) in w.out(node).filter(|(_, a)| a.users.allows(true) && !held.contains(&a.to)) {
            let theirs = w.kind(arc.to).reserved_for();
            if (theirs.is_none() || theirs == bound || theirs == leaves) && seen.insert(arc.to) {
                next.push(arc.to);
            }
        }
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Simulation;
    use crate::scenario::Scenario;
    use giveway_floor::id::StationId;
    use giveway_floor::time::Span;
    use giveway_floor::warehouse::formats;
    use std::sync::Arc;

    /// Interval between two checks of the robots.
    const LOOK: Span = Span::from_secs(5);

    /// How often the law is broken within a time, for a robot that stands with the rack it has just lifted: with
    /// `closes`, no robot can reach the station; else every robot can. The fleet is not told, so it does nothing about
    /// it.
    fn broken(closes: bool, within: Span) -> usize {
        let map = formats::json::parse(include_str!("../../../docs/small.json")).expect("a map");
        let text = r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 1, "period_ms": 100, "duration_s": 600,
            "jobs": {"backlog": 4}}"#;
        let scenario = Scenario::parse(text).expect("a scenario");
        let mut sim = Simulation::new(Arc::new(map), &scenario, &[], 1, false, || 0);
        let lifted = |sim: &Simulation| {
            sim.fleet().ledger().jobs.values().any(|j| matches!(j.state, JobState::Carrying { .. }))
        };
        while !lifted(&sim) {
            assert!(!sim.is_over(), "no rack was lifted");
            sim.step();
        }
        let station = &sim.fleet().warehouse().stations[StationId(0)];
        let places = station.queue.iter().copied().chain([station.node]);
        let held: BTreeSet<NodeId> = places.filter(|_| closes).collect();
        let mut laws = CarryLaws::default();
        let now = sim.now();
        let looks = within.0 / LOOK.0;
        (0..=looks).map(|n| laws.look(now + LOOK * n, &sim.world, sim.fleet(), &held).len()).sum()
    }

    #[test]
    fn a_robot_that_stands_with_a_rack_before_a_closed_station_breaks_the_law_after_three_minutes() {
        assert_eq!(broken(true, CARRIED), 0);
        assert_eq!(broken(true, CARRIED + LOOK), 1);
        assert_eq!(broken(false, CARRIED + LOOK), 0);
    }
}

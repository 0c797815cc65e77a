//! The law of fairness: no job for a rack waits while less urgent jobs begin one after the other.
//!
//! Main type: [`FairLaws`]. The order is the stated one: priority, age and nearness of the deadline, where one priority
//! is worth eight minutes of waiting. A job counts as passed by if the other one is less urgent by more than driving
//! distances can make up for, and only if the robot could have done the waiting job: its rack stands free in storage,
//! and its station has room or is the station of the other job. Jobs that name a robot, and jobs for which an operator
//! chose one, are orders to that robot and have an order of their own. Refuses: to count the first jobs that pass: two
//! robots may settle in one step what each alone would have settled otherwise.

use super::violation::{PASSED_BY, Violation};
use crate::world::World;
use giveway_fleet::{
    CHAIN_BEHIND_MS, Fact, Fleet, Job, JobFact, JobState, RackAt, RobotChoice, Task, chain_saves_ms,
};
use giveway_floor::id::{JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use std::collections::{BTreeMap, BTreeSet};

/// Most that a rack on its way to a station adds to the cost of others there, milliseconds.
const CONGESTION_MS: i64 = 8_000;

/// Waiting jobs, with how many less urgent jobs have begun since.
#[derive(Debug)]
pub(super) struct FairLaws {
    waiting: BTreeMap<JobId, u32>,
    /// Stations for which no more racks were fetched after the previous step.
    full: BTreeSet<StationId>,
    /// Which robot stood on, or was to end at, each node after the previous step.
    stood: BTreeMap<NodeId, RobotId>,
    /// The extent of the floor: the sum of its sides, metres.
    extent_m: f64,
}

/// A job that has begun, and the robot that does it.
struct Begun {
    job: JobId,
    robot: RobotId,
    /// Whether the robot continued with the rack it already had.
    goes_on: bool,
}

impl FairLaws {
    pub fn new(fleet: &Fleet) -> FairLaws {
        let waits = fleet.ledger().jobs.iter().filter(|(_, j)| j.state == JobState::Waiting);
        let waiting = waits.map(|(id, _)| (*id, 0)).collect();
        FairLaws {
            waiting,
            full: BTreeSet::new(),
            stood: stood(fleet),
            extent_m: extent_m(fleet.warehouse()),
        }
    }

    /// Checks which jobs began in a step, and which waited meanwhile.
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet, facts: &[Fact]) -> Vec<Violation> {
        let mut begun = Vec::new();
        let mut fresh = BTreeSet::new();
        for fact in facts {
            match *fact {
                Fact::Job(JobFact::Accepted { job, .. }) => _ = fresh.insert(job),
                Fact::Job(JobFact::Progressed { job, state: JobState::Waiting, .. }) => _ = fresh.insert(job),
                Fact::Job(JobFact::Progressed { job, state, .. }) => {
                    let waited = self.waiting.remove(&job).is_some() || fresh.remove(&job);
                    let goes_on = matches!(state, JobState::Carrying { .. });
                    let robot = state.robot().filter(|_| waited);
                    begun.extend(robot.map(|robot| Begun { job, robot, goes_on }));
                }
                _ => {}
            }
        }
        let full = fleet.full_stations(now);
        let broken = begun.iter().filter_map(|b| self.passed_by(b, &full, now, world, fleet)).collect();
        self.full = full;
        self.stood = stood(fleet);
        self.waiting.extend(fresh.into_iter().map(|id| (id, 0)));
        broken
    }

    /// Counts one job that has begun against all more urgent jobs that waited.
    fn passed_by(
        &mut self,
        begun: &Begun,
        full: &BTreeSet<StationId>,
        now: Time,
        world: &World,
        fleet: &Fleet,
    ) -> Option<Violation> {
        let ledger = fleet.ledger();
        let job = ledger.jobs.get(&begun.job)?;
        let rack = job.request.kind.rack()?;
        if matches!(job.choice, RobotChoice::Only(..)) || begun.goes_on && is_low(begun.robot, world, fleet) {
            return None;
        }
        let urgency = fleet.urgency_ms(job, now);
        let is_open = |s: StationId| !full.contains(&s) && !self.full.contains(&s);
        let ways_ms = self.ways_ms(fleet, begun);
        let mut first: BTreeMap<RackId, (i64, JobId)> = BTreeMap::new();
        for id in self.waiting.keys() {
            let Some(other) = ledger.jobs.get(id) else { continue };
            let ahead = fleet.urgency_ms(other, now) - urgency;
            let at_one = other.request.kind.station() == job.request.kind.station();
            let allowed_ms = ways_ms + if begun.goes_on { self.chain_ms(fleet, begun, at_one) } else { 0 };
            if ahead <= allowed_ms || !self.could_go_first((*id, other), (begun, job), is_open, now, fleet) {
                continue;
            }
            let of_rack = other.request.kind.rack().unwrap_or(rack);
            let best = first.entry(of_rack).or_insert((ahead, *id));
            if ahead > best.0 {
                *best = (ahead, *id);
            }
        }
        let mut broken = None;
        for (_, id) in first.into_values() {
            let passed = self.waiting.get_mut(&id).expect("it waits");
            *passed += 1;
            if *passed > PASSED_BY {
                *passed = 0;
                broken = Some(Violation::PassedBy(id, begun.job));
            }
        }
        broken
    }

    /// Whether a waiting job could have begun in place of this one.
    fn could_go_first(
        &self,
        (id, waits): (JobId, &Job),
        (begun, job): (&Begun, &Job),
        is_open: impl Fn(StationId) -> bool,
        now: Time,
        fleet: &Fleet,
    ) -> bool {
        let ledger = fleet.ledger();
        let station = waits.request.kind.station();
        let is_free = waits.request.after.iter().all(|a| !ledger.jobs.contains_key(a))
            && !waits.request.after.iter().any(|a| ledger.ended_badly.contains_key(a));
        if waits.state != JobState::Waiting || !is_free {
            return false;
        }
        let Some(rack) = waits.request.kind.rack() else { return false };
        let same_rack = job.request.kind.rack() == Some(rack);
        let same_station = station.is_some() && station == job.request.kind.station();
        // The choice among jobs for one rack costs no driving, but their stations may differ in load, and a robot that
        // continues does not trade its station for a place at another one.
        if same_rack {
            let has_room = || !begun.goes_on && station.is_none_or(|s| is_open(s) && has_room(fleet, s));
            let could = match begun.goes_on {
                true => fleet.is_allowed_for(begun.robot, waits, now),
                false => fleet.could_do(begun.robot, id, now),
            };
            return could && (same_station || has_room());
        }
        let RackAt::Stored(node) = ledger.racks[rack] else { return false };
        // No other robot can drive under a rack while a robot stands there, even if that robot may set off in the same
        // step.
        if self.stood.get(&node).is_some_and(|r| *r != begun.robot) {
            return false;
        }
        let fetches = |r: RobotId| matches!(ledger.robots[r].task, Task::Fetch { rack: k, .. } if k == rack);
        let has_room = match station {
            Some(_) if same_station && begun.goes_on => true,
            Some(s) => is_open(s) && (same_station || has_room(fleet, s)),
            None => true,
        };
        has_room && !ledger.present().any(fetches) && fleet.could_do(begun.robot, id, now)
    }

    /// Largest difference between one robot's ways to two racks, plus what congestion at stations is worth,
    /// milliseconds.
    fn ways_ms(&self, fleet: &Fleet, begun: &Begun) -> i64 {
        let moves = &fleet.ledger().kinds().of(&fleet.ledger().robots[begun.robot].kind).kinematics;
        let places = fleet.warehouse().stations.iter().map(|s| s.queue.len() + 1).max().unwrap_or(1);
        (self.extent_m / moves.speed_mps * 1000.0) as i64 + CONGESTION_MS * places as i64
    }

    /// How much more urgent another job may be than one with which a robot continues, milliseconds: at most what it
    /// saves not to put the rack away; at the same station, if that is more, the time that robots behind it may have to
    /// wait.
    fn chain_ms(&self, fleet: &Fleet, begun: &Begun, at_one_station: bool) -> i64 {
        let moves = &fleet.ledger().kinds().of(&fleet.ledger().robots[begun.robot].kind).kinematics;
        let saves_ms = chain_saves_ms(self.extent_m, moves.speed_loaded_mps);
        if at_one_station { saves_ms.max(CHAIN_BEHIND_MS) } else { saves_ms }
    }
}

/// Which robot stands on, or is to end at, each node.
fn stood(fleet: &Fleet) -> BTreeMap<NodeId, RobotId> {
    let ledger = fleet.ledger();
    let ends = |r: RobotId| ledger.chain(r).visits().last().map(|v| v.node);
    ledger
        .present()
        .flat_map(|r| [Some(ledger.node_of(r)), ends(r)].map(|n| Some((n?, r))))
        .flatten()
        .collect()
}

/// Whether fewer racks are on their way to a station than it has places, and order lines do not affect their cost.
fn has_room(fleet: &Fleet, station: StationId) -> bool {
    let place = &fleet.warehouse().stations[station];
    let ledger = fleet.ledger();
    let jobs = ledger.robots.iter().filter_map(|r| ledger.jobs.get(&r.task.job()?));
    let under_way = jobs.filter(|j| j.request.kind.station() == Some(station)).count();
    let has_cells = fleet.warehouse().stations.iter().any(|s| s.cell.is_some());
    let counts_lines = has_cells && fleet.settings().flow.counts_lines();
    !counts_lines && under_way <= place.queue.len() + 1
}

/// Whether a robot must charge before it fetches another rack.
fn is_low(robot: RobotId, world: &World, fleet: &Fleet) -> bool {
    let charging = &fleet.ledger().kinds().of(&fleet.ledger().robots[robot].kind).charging;
    world.truth().any(|(r, t)| r == robot && t.battery < charging.low + 0.01)
}

fn extent_m(warehouse: &Warehouse) -> f64 {
    let (low, high) = warehouse.bounds();
    (high.x - low.x) + (high.y - low.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Simulation;
    use crate::scenario::Scenario;
    use giveway_fleet::{FloorAction, Input, JobAction, JobKind, JobRequest};
    use giveway_floor::warehouse::formats;
    use std::sync::Arc;

    #[test]
    fn a_job_that_less_urgent_ones_pass_by_is_found_at_the_fourth_of_them() {
        let map = formats::json::parse(include_str!("../../../docs/small.json")).expect("a map");
        let text = r#"{"giveway_scenario": 1, "name": "t", "map": "", "robots": 1, "period_ms": 100,
            "duration_s": 60, "jobs": "none"}"#;
        let scenario = Scenario::parse(text).expect("a scenario");
        let mut sim = Simulation::new(Arc::new(map), &scenario, &[], 1, false, || 0);
        for _ in 0..20 {
            sim.step();
        }
        let now = sim.fleet().view(Time::ZERO).robots[0].seen.expect("it reports");
        let robot = RobotId(0);
        let submit = |rack, priority| {
            let kind = JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick: None };
            let request = JobRequest { priority, ..JobRequest::new(kind) };
            Input::ask(1, JobAction::Submit(request))
        };
        let mut inputs = vec![Input::ask(2, FloorAction::Halt(Some(robot))), submit(0, 8), submit(1, 9)];
        inputs.extend((0..4).map(|_| submit(1, 0)));
        sim.drive_mut().fleet_mut().step(now, inputs);
        let mut laws = FairLaws::new(sim.fleet());
        let mut begins = |job| {
            let state = JobState::Assigned { robot };
            let fact = Fact::Job(JobFact::Progressed { job: JobId(job), state, tasked: None, at: now });
            laws.check(now, &sim.world, sim.fleet(), &[fact])
        };
        assert_eq!(begins(2), [], "it is more urgent");
        assert_eq!([3, 4, 5].map(&mut begins), [vec![], vec![], vec![]]);
        assert_eq!(begins(6), [Violation::PassedBy(JobId(1), JobId(6))]);
    }
}

//! Robots whose rack was just picked from and is wanted at a station again, so that it need not be put away first.
//!
//! Main type: [`ChainedJob`]. Such a job saves ways, and no more than that: it is matched together with all others, so
//! a more urgent one is not passed over. Refuses: to keep a robot at a station for a place at another one, and to let
//! the robots behind it wait for jobs that are less urgent than theirs.

use crate::dispatch::enough::with_enough_racks;
use crate::state::fact::Task;
use crate::state::floor::Floor;
use crate::state::index::{RackGoal, urgency_ms};
use crate::state::job_kind::JobKind;
use crate::state::ledger::Service;
use crate::state::needs::Needs;
use crate::state::storage::along_axes;
use giveway_floor::id::{IdVec, JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::Time;
use std::cmp::Reverse;

/// How much more urgent the jobs of robots behind may be, milliseconds: two steps of priority, since these robots wait
/// no longer than a rack is picked from.
pub const CHAIN_BEHIND_MS: i64 = 240_000;
/// Putting a rack away costs this many times the way in the end: the rack is put away, some robot drives there again,
/// and brings it back.
const WAYS: i64 = 3;
/// How long it takes to set a rack down and to lift another one, milliseconds.
const SETS_DOWN_MS: i64 = 10_000;

/// A job that a robot can do with the rack that it has.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChainedJob {
    pub robot: RobotId,
    pub job: JobId,
    pub rack: RackId,
    /// The node of the station at which the rack is wanted.
    pub station: NodeId,
    /// Where the rack is to be stored.
    pub store: NodeId,
}

impl ChainedJob {
    /// The task of the robot if it gets the job.
    pub fn task(&self) -> Task {
        Task::Deliver { job: self.job, rack: self.rack, station: self.station, store: self.store }
    }
}

/// The chains that are possible: one for each of the robots that were picked from, at most.
pub(super) fn chains(floor: Floor<'_>, needs: &Needs, picked: &[RobotId], now: Time) -> Vec<ChainedJob> {
    if picked.is_empty() {
        return Vec::new();
    }
    let mut room = Room::of(floor, needs, now);
    let mut found = Vec::new();
    for robot in picked.iter().copied() {
        let Some(chain) = floor.chain(robot, &room, now) else { continue };
        let node = floor.ledger.node_of(robot);
        if chain.station != node {
            room.bound[floor.warehouse().nodes[chain.station].kind.reserved_for().expect("a station")] += 1;
        }
        found.push(chain);
    }
    found
}

/// Whether stations have room for racks that come from other stations.
struct Room {
    /// How many robots have a place at each station, or wait for one.
    bound: IdVec<StationId, usize>,
    /// The most urgent job of the robots with racks for each station, apart from those that are picked from; and of
    /// the jobs that wait for it because it has enough.
    urgent_ms: IdVec<StationId, i64>,
}

impl Room {
    fn of(floor: Floor<'_>, needs: &Needs, now: Time) -> Room {
        let mut bound = floor.bound_for_stations();
        let mut urgent_ms = IdVec::filled(i64::MIN, floor.warehouse().stations.len());
        let queue = &floor.ledger.index().queue;
        let oldest = queue.oldest(now);
        for station in with_enough_racks(floor, needs, now).into_keys() {
            let first = queue.offers(now, move |goal| goal == RackGoal::Station(station)).next();
            urgent_ms[station] = first.map_or(i64::MIN, |id| queue.urgency_ms(id, now, &oldest));
        }
        for robot in floor.ledger.present() {
            let Some(station) = floor.station_of(robot) else { continue };
            if floor.lacks_route(robot) {
                bound[station] += 1;
            }
            let id = floor.ledger.robots[robot].task.job();
            let Some(job) = id.and_then(|id| floor.ledger.jobs.get(&id)) else { continue };
            let (priority, deadline) = (job.request.priority, job.request.deadline);
            let first = oldest[usize::from(priority)];
            let urgency = urgency_ms(priority, job.accepted, deadline, now, first);
            urgent_ms[station] = urgent_ms[station].max(urgency);
        }
        Room { bound, urgent_ms }
    }
}

impl Floor<'_> {
    /// The most urgent job for the rack on a robot, if that is a delivery with which the robot can go on at once.
    fn chain(&self, robot: RobotId, room: &Room, now: Time) -> Option<ChainedJob> {
        let record = &self.ledger.robots[robot];
        let Task::Store { job: None, rack, store } = record.task else { return None };
        let is_wanted = self.named_job_for(robot).is_some() || record.service != Service::Works;
        if is_wanted || self.is_critical(robot) {
            return None;
        }
        let queue = &self.ledger.index().queue;
        let oldest = queue.oldest(now);
        let urgency = |id: JobId| queue.urgency_ms(id, now, &oldest);
        let open = queue.firsts_of(rack).filter(|id| self.can_go_on(robot, *id, urgency(*id), room, now));
        let job = open.max_by_key(|id| (urgency(*id), Reverse(*id)))?;
        let JobKind::Deliver { station, .. } = self.ledger.jobs[&job].request.kind else { return None };
        let station = self.warehouse().stations[station].node;
        Some(ChainedJob { robot, job, rack, station, store })
    }

    /// Whether a robot that has the rack of a job could go on with the job at once. True for jobs that bring the rack
    /// to storage.
    fn can_go_on(&self, robot: RobotId, id: JobId, urgency_ms: i64, room: &Room, now: Time) -> bool {
        let job = &self.ledger.jobs[&id];
        let Some(station) = job.request.kind.station() else { return true };
        let place = &self.warehouse().stations[station];
        let is_there = self.ledger.node_of(robot) == place.node;
        let has_room = match is_there {
            true => room.urgent_ms[station] <= urgency_ms.saturating_add(CHAIN_BEHIND_MS),
            false => room.bound[station] <= place.queue.len(),
        };
        has_room
            && self.may_be_at(robot, place.node)
            && self.is_allowed(robot, job, now)
            && !self.ledger.paused_stations.contains_key(&station)
            && !self.is_shut_off(place.node)
            && self.restrictions.cut_off.blocks_for_long(station, now).is_none()
    }

    /// What a robot saves by going on with its chain instead of putting the rack away, milliseconds of robots: the way
    /// there, and the ways of the robot that fetches the rack for the job later.
    pub(super) fn saves_ms(&self, chain: &ChainedJob) -> i64 {
        let at = |n: NodeId| self.warehouse().nodes[n].at;
        let way_m = along_axes(at(self.ledger.node_of(chain.robot)), at(chain.store));
        chain_saves_ms(way_m, self.kinematics(chain.robot).speed_loaded_mps)
    }
}

/// What is saved by not putting a rack away over this many metres, milliseconds of robots.
pub fn chain_saves_ms(way_m: f64, speed_loaded_mps: f64) -> i64 {
    WAYS * ((way_m / speed_loaded_mps * 1000.0) as i64 + SETS_DOWN_MS)
}

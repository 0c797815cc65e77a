//! Fourth phase: which idle robot gets which waiting job? All of them are matched together, at the least sum of costs.
//!
//! Refuses: first come, first served; and to give a job to a robot that should charge first.

use crate::fleet::dispatch::assignment::{NEVER, least_cost};
use crate::fleet::dispatch::blocked::give_back_blocked;
use crate::fleet::dispatch::charging::{give_back_jobs, rest};
use crate::fleet::dispatch::leaving::let_leave;
use crate::fleet::dispatch::maintenance::send_to_maintenance;
use crate::fleet::state::core::Core;
use crate::fleet::state::fact::{Purpose, Task};
use crate::fleet::state::floor::Floor;
use crate::fleet::state::index::RackGoal;
use crate::fleet::state::job::{JobFailure, JobKind, JobState};
use crate::fleet::state::ledger::RackAt;
use crate::fleet::state::needs::Needs;
use crate::fleet::state::planners::Planners;
use crate::fleet::state::storage::along_axes;
use crate::id::{IdVec, JobId, NodeId, RackId, RobotId, StationId};
use crate::route::Stage;
use crate::time::{Span, Time};
use crate::warehouse::NodeKind;
use std::collections::BTreeSet;

/// How many waiting jobs and idle robots one step matches at most.
const JOBS: usize = 128;
const ROBOTS: usize = 64;
/// What it costs that the station has as many racks under way as places, per rack beyond.
const CONGESTION_MS: i64 = 8_000;
/// A rack that waits longer than this for a place at its station has waited for long.
const LONG: Span = Span::from_secs(60);

/// Gives robots whose rack was just picked from, and is wanted at a station again, that job: the rack need not be put
/// away first.
pub(in crate::fleet) fn chain_deliveries(core: &mut Core, picked: &[RobotId], now: Time) {
    for robot in picked.iter().copied() {
        let floor = core.floor();
        let Task::Store { job: None, rack, store } = floor.ledger.robots[robot].task else { continue };
        if floor.named_job_for(robot).is_some() || floor.is_critical(robot) {
            continue;
        }
        let Some(job) = floor.ledger.index().queue.next_delivery(rack) else { continue };
        let JobKind::Deliver { station, .. } = floor.ledger.jobs[&job].request.kind else { continue };
        let station = floor.warehouse().stations[station].node;
        let is_allowed = floor.is_allowed(robot, &floor.ledger.jobs[&job], now);
        if !floor.may_be_at(robot, station) || !is_allowed {
            continue;
        }
        let task = Task::Deliver { job, rack, station, store };
        core.progress(job, JobState::Carrying { robot }, Some((robot, task)), now);
    }
}

/// Gives jobs to robots, and sends those without a job where they are wanted or in no other robot's way. Gives the
/// robots that have lost a place which they were promised.
pub(in crate::fleet) fn assign(
    core: &mut Core,
    needs: &Needs,
    planners: &mut Planners,
    now: Time,
) -> Vec<RobotId> {
    core.ledger.advance_queue(now);
    give_back_jobs(core, now);
    give_back_blocked(core, needs, now);
    let_leave(core, now);
    send_to_maintenance(core, now);
    assign_named(core, planners, now);
    let floor = core.floor();
    let charger_is_free = floor.a_charger_is_free();
    let idle = floor.idle_robots(now).into_iter();
    let (working, mut resting): (Vec<RobotId>, Vec<RobotId>) =
        idle.partition(|r| floor.is_charged(*r, charger_is_free) && !floor.is_shut_in(*r));
    resting.extend(assign_racks(core, needs, working, now));
    rest(core, resting, now)
}

/// Jobs for a robot that the customer named: one for each idle robot, before any rack.
fn assign_named(core: &mut Core, planners: &mut Planners, now: Time) {
    for robot in core.floor().idle_robots(now) {
        if let Some(job) = core.floor().named_job_for(robot).filter(|j| core.floor().may_begin(robot, *j)) {
            begin_named(core, planners, robot, job, now);
        }
    }
}

/// Sends an idle robot where a job says. The job waits while there is no place for it, and fails where no way
/// leads.
fn begin_named(core: &mut Core, planners: &mut Planners, robot: RobotId, job: JobId, now: Time) {
    let floor = core.floor();
    let (goal, stay, purpose) = match floor.ledger.jobs[&job].request.kind {
        JobKind::Charge { .. } => (None, floor.free_place(robot, NodeKind::Charger), Purpose::Charge),
        JobKind::Park { .. } => (None, floor.free_place(robot, NodeKind::Parking), Purpose::Park),
        JobKind::Go { node, .. } => (Some(node), floor.stay_for(robot, node), Purpose::Go),
        kind => unreachable!("{kind:?} names no robot"),
    };
    let Some(stay) = stay else { return };
    let goal = goal.unwrap_or(stay);
    let ways = [Stage::to_stay(goal), Stage::to_stay(stay)];
    let kind = core.settings.kind(&core.ledger.robots[robot].kind);
    if planners.of_mut(kind).free_flow(core.ledger.node_of(robot), &ways).is_none() {
        return core.progress(job, JobState::Failed(JobFailure::Unreachable), None, now);
    }
    let task = Task::Move { job: Some(job), goal, stay, purpose };
    core.progress(job, JobState::Assigned { robot }, Some((robot, task)), now);
}

/// Gives rack jobs to robots; gives back the robots that got none.
fn assign_racks(core: &mut Core, needs: &Needs, robots: Vec<RobotId>, now: Time) -> Vec<RobotId> {
    if robots.is_empty() || core.ledger.jobs.is_empty() {
        return robots;
    }
    let has_offers = core.ledger.index().queue.has_offers();
    let jobs = if has_offers { candidates(core.floor(), needs, &robots, now) } else { Vec::new() };
    if jobs.is_empty() {
        return robots;
    }
    let (few, mut left) = nearest(core.floor().ways(&robots, &jobs, now));
    let under_way = core.floor().under_way();
    let work = core.floor().work_ahead(now);
    let congestion = |id: &JobId, rack: &NodeId| {
        let floor = core.floor();
        floor.lack_of_work(*id, *rack, &work).unwrap_or_else(|| floor.congestion(*id, &under_way))
    };
    let worth: Vec<i64> =
        jobs.iter().map(|(id, _, node, urgency_ms)| congestion(id, node) - urgency_ms).collect();
    let cost: Vec<Vec<i64>> = (few.iter())
        .map(|(_, ways)| {
            let known = ways.iter().zip(&worth).map(|(way, w)| way.map_or(NEVER, |way| way + w));
            known.chain(std::iter::repeat_n(NEVER, few.len())).collect()
        })
        .collect();
    for ((robot, _), column) in few.into_iter().zip(least_cost(&cost)) {
        match column.and_then(|c| jobs.get(c)) {
            Some(&(job, rack, node, _)) => {
                let task = Task::Fetch { job: Some(job), rack, node };
                core.progress(job, JobState::Assigned { robot }, Some((robot, task)), now);
            }
            None => left.push(robot),
        }
    }
    left
}

/// Waiting jobs whose rack stands in storage and no robot moves, with their urgency, most urgent first; one per
/// rack. A rack above a robot that is not one of these, which come by number, is left out: no other robot can get
/// beneath it.
fn candidates(
    floor: Floor<'_>,
    needs: &Needs,
    robots: &[RobotId],
    now: Time,
) -> Vec<(JobId, RackId, NodeId, i64)> {
    let queue = &floor.ledger.index().queue;
    let (oldest, wanted) = (queue.oldest(now), queue.racks_wanted());
    let enough = stations_with_enough(floor, needs, now);
    let has_room = |goal| !matches!(goal, RackGoal::Station(s) if enough.contains(&s));
    let mut seen: BTreeSet<RackId> = BTreeSet::new();
    let mut found = Vec::new();
    for id in queue.offers(now, has_room) {
        if found.len() == JOBS || seen.len() == wanted {
            break;
        }
        let rack = floor.ledger.jobs[&id].request.kind.rack().expect("offers are for racks");
        let RackAt::Stored(node) = floor.ledger.racks[rack] else { continue };
        let is_another = |r: RobotId| robots.binary_search(&r).is_err();
        if seen.contains(&rack) || floor.ledger.resident(node).is_some_and(is_another) {
            continue;
        }
        let is_open = |id: &JobId| !floor.job_is_closed_off(&floor.ledger.jobs[id].request.kind, node);
        // Only relocations in one line have goals of their own: behind one that is closed may be one that is not.
        let is_shut = floor.is_shut_off(node) || floor.ledger.jobs[&id].request.kind.station().is_some();
        let others = queue.behind(id).take_while(|_| !is_shut);
        if let Some(id) = std::iter::once(id).chain(others).find(is_open) {
            seen.insert(rack);
            found.push((id, rack, node, queue.urgency_ms(id, now, &oldest)));
        } else if floor.is_shut_off(node) {
            seen.insert(rack);
        }
    }
    found
}

/// Stations for which enough robots wait with their racks, or which are paused, or blocked for long by a robot that
/// cannot drive: fetching another rack now would leave its robot waiting while others need it.
pub(in crate::fleet) fn stations_with_enough(
    floor: Floor<'_>,
    needs: &Needs,
    now: Time,
) -> BTreeSet<StationId> {
    let mut waiting = IdVec::filled((0, Span::ZERO), floor.warehouse().stations.len());
    for robot in floor.ledger.present().filter(|r| floor.waits_for_room(*r)) {
        let station = floor.station_of(robot).expect("it waits for one");
        let (number, longest): &mut (usize, Span) = &mut waiting[station];
        (*number, *longest) = (*number + 1, needs.waited(robot, now).max(*longest));
    }
    let places = |s: StationId| floor.warehouse().stations[s].queue.len() + 1;
    let enough = |s: StationId, longest: Span| enough(places(s), needs.set_off.get(&s).copied(), longest);
    let paused = floor.ledger.paused_stations.keys().copied();
    let full = waiting.pairs().filter(|(s, w)| w.0 >= enough(*s, w.1)).map(|(s, _)| s);
    let blocked = floor.restrictions.cut_off.blocked_for_long(now);
    full.chain(paused).chain(blocked).collect()
}

impl Floor<'_> {
    /// The node itself if robots may stay there, whichever robot is there now; else some other place to stay.
    fn stay_for(&self, robot: RobotId, node: NodeId) -> Option<NodeId> {
        let lasting = self.warehouse().nodes[node].kind.is_lasting();
        if lasting { Some(node) } else { self.any_stay(robot) }
    }

    /// For each robot, how long its ways to the racks of these jobs take.
    fn ways(
        &self,
        robots: &[RobotId],
        jobs: &[(JobId, RackId, NodeId, i64)],
        now: Time,
    ) -> Vec<(RobotId, Ways)> {
        let ways = |r: RobotId| -> Ways {
            jobs.iter().map(|(id, rack, node, _)| self.way_ms(r, *id, (*rack, *node), now)).collect()
        };
        robots.iter().map(|r| (*r, ways(*r))).collect()
    }

    /// How long the robot's way to a rack takes, milliseconds; nothing if another robot stands there for ever, or the
    /// robot is not of a kind for the job, or its charge does not last for it, or a broken robot stands between, or an
    /// operator wants another robot to do it.
    fn way_ms(&self, robot: RobotId, job: JobId, (rack, node): (RackId, NodeId), now: Time) -> Option<i64> {
        let job = &self.ledger.jobs[&job];
        let kind = &job.request.kind;
        if self.ledger.resident(node).is_some_and(|r| r != robot)
            || !job.request.is_for(self.warehouse(), self.body(robot), (rack, node))
            || !self.is_allowed(robot, job, now)
            || !self.restrictions.cut_off.may_fetch(self.ledger.node_of(robot), node)
        {
            return None;
        }
        let at = |n: NodeId| self.warehouse().nodes[n].at;
        let here = self.ledger.node_of(robot);
        let way_m = along_axes(at(here), at(node));
        let goal = match *kind {
            JobKind::Deliver { station, .. } => self.warehouse().stations[station].node,
            JobKind::Relocate { node, .. } => node,
            _ => node,
        };
        let whole_m = way_m + 2.0 * along_axes(at(node), at(goal));
        if self.battery(robot) - self.charge_for(robot, whole_m) < self.charging(robot).critical / 2.0 {
            return None;
        }
        Some((way_m / self.kinematics(robot).speed_mps * 1000.0) as i64)
    }

    /// For each station, how many robots work on deliveries to it.
    fn under_way(&self) -> IdVec<StationId, usize> {
        let mut under_way = IdVec::filled(0, self.warehouse().stations.len());
        let jobs = self.ledger.robots.iter().filter_map(|r| self.ledger.jobs.get(&r.task.job()?));
        for job in jobs {
            if let JobKind::Deliver { station, .. } = job.request.kind {
                under_way[station] += 1;
            }
        }
        under_way
    }

    /// What it costs that many racks are on their way to the job's station already.
    fn congestion(&self, job: JobId, under_way: &IdVec<StationId, usize>) -> i64 {
        let JobKind::Deliver { station, .. } = self.ledger.jobs[&job].request.kind else { return 0 };
        let places = self.warehouse().stations[station].queue.len() + 1;
        CONGESTION_MS * (under_way[station].saturating_sub(places / 2)) as i64
    }
}

/// How long a robot's ways to the racks of some jobs take, milliseconds; nothing where it cannot do the job.
type Ways = Vec<Option<i64>>;

/// The robots that one step matches, by number, and those that are left over: the ones nearest to some rack, so that
/// a robot that alone can do a job has its turn however many cannot.
fn nearest(mut robots: Vec<(RobotId, Ways)>) -> (Vec<(RobotId, Ways)>, Vec<RobotId>) {
    if robots.len() <= ROBOTS {
        return (robots, Vec::new());
    }
    robots.sort_by_cached_key(|(r, ways)| (ways.iter().flatten().min().copied().unwrap_or(i64::MAX), *r));
    let left = robots.split_off(ROBOTS).into_iter().map(|(r, _)| r).collect();
    robots.sort_by_key(|(r, _)| *r);
    (robots, left)
}

/// How many robots with their racks may wait for a station, whose queue takes `places`, before no robot fetches
/// another: twice as many where the line moves, so that there are some to choose from where ways are long and crowded;
/// as many once one has waited for long, or the last one to set off had, or none has yet; none while the line stands.
fn enough(places: usize, last: Option<Span>, longest: Span) -> usize {
    match () {
        () if longest > LONG * 3 => 0,
        () if longest > LONG || last.is_none_or(|waited| waited > LONG) => places,
        () => 2 * places,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn racks_wait_for_a_station_as_its_line_moves() {
        let [moment, long, stands] = [10, 100, 200].map(Span::from_secs);
        assert_eq!(enough(5, None, Span::ZERO), 5, "nobody knows yet how fast it goes");
        assert_eq!(enough(5, Some(moment), moment), 10);
        assert_eq!(enough(5, Some(long), moment), 5);
        assert_eq!(enough(5, Some(moment), long), 5);
        assert_eq!(enough(5, Some(moment), stands), 0);
    }
}

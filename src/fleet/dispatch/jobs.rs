//! Fourth phase: which robot gets which waiting job? Idle robots and robots that were just picked from are matched with
//! jobs all together, at the least sum of costs.
//!
//! Refuses: first come, first served; and to give a job to a robot that should charge first.

use crate::dispatch::assignment::{NEVER, least_cost};
use crate::dispatch::blocked::give_back_blocked;
use crate::dispatch::chains::{ChainedJob, chains};
use crate::dispatch::charging::{give_back_jobs, rest};
use crate::dispatch::enough::stations_with_enough;
use crate::dispatch::leaving::let_leave;
use crate::dispatch::maintenance::send_to_maintenance;
use crate::dispatch::named::assign_named;
use crate::dispatch::silent::give_back_silent;
use crate::state::fact::Task;
use crate::state::floor::Floor;
use crate::state::index::RackGoal;
use crate::state::job::JobState;
use crate::state::job_kind::JobKind;
use crate::state::ledger::RackAt;
use crate::state::needs::Needs;
use crate::state::planners::Planners;
use crate::state::storage::along_axes;
use crate::state::writer::Writer;
use giveway_floor::id::{IdVec, JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::Time;
use std::collections::{BTreeMap, BTreeSet};

/// How many idle robots one step matches at most, how many waiting jobs with them, and how many pairs of both. Jobs
/// that are all as urgent, such as a stock count in the order of the map, are for neighbouring racks: with few of them
/// to choose from, all robots would crowd in one aisle.
const ROBOTS: usize = 64;
const JOBS: usize = 2_048;
const PAIRS: usize = 32_768;
/// Cost of each rack that is under way to a station beyond half of its places, milliseconds.
const CONGESTION_MS: i64 = 8_000;

/// Gives jobs to robots, and sends robots without a job where they are wanted or in no other robot's way. `picked` are
/// the robots that have just been picked from. Returns the robots that have lost a place that they were promised.
pub(crate) fn assign(
    writer: &mut Writer,
    needs: &Needs,
    planners: &mut Planners,
    picked: &[RobotId],
    now: Time,
) -> Vec<RobotId> {
    writer.advance_queue(now);
    give_back_jobs(writer, now);
    give_back_blocked(writer, now);
    give_back_silent(writer, now);
    let_leave(writer, now);
    send_to_maintenance(writer, now);
    assign_named(writer, needs, planners, now);
    let floor = writer.floor();
    let charger_is_free = floor.a_charger_is_free();
    let idle = floor.idle_robots(now).into_iter();
    let (working, mut resting): (Vec<RobotId>, Vec<RobotId>) =
        idle.partition(|r| floor.is_charged(*r, charger_is_free) && !floor.is_shut_in(*r));
    resting.extend(assign_racks(writer, needs, working, picked, now));
    rest(writer, resting, now)
}

/// Gives rack jobs to idle robots, and jobs for the racks that they carry to robots that were just picked from. Returns
/// the idle robots that got none. If a job in storage is worth more for a robot than one for its own rack, the robot
/// puts its rack away, and is idle then.
fn assign_racks(
    writer: &mut Writer,
    needs: &Needs,
    robots: Vec<RobotId>,
    picked: &[RobotId],
    now: Time,
) -> Vec<RobotId> {
    let chains = chains(writer.floor(), needs, picked, now);
    if robots.is_empty() && chains.is_empty() || writer.ledger().jobs.is_empty() {
        return robots;
    }
    let has_offers = writer.ledger().index().queue.has_offers();
    let carriers: Vec<RobotId> = chains.iter().map(|chain| chain.robot).collect();
    let jobs = match has_offers {
        true => candidates(writer.floor(), needs, (&robots, &carriers), now),
        false => Vec::new(),
    };
    if jobs.is_empty() && chains.is_empty() {
        return robots;
    }
    let (few, mut left) = nearest(writer.floor().ways(&robots, &jobs, now));
    let cost = costs(writer.floor(), &few, &jobs, &chains, now);
    let mut found = least_cost(&cost);
    let goes_on = |(i, column): (usize, &Option<usize>)| *column == Some(jobs.len() + i);
    if !few.is_empty() && !found[few.len()..].iter().enumerate().all(goes_on) {
        // No job that an idle robot can take now is left to a robot that first has to put its rack away.
        found[..few.len()].copy_from_slice(&least_cost(&cost[..few.len()]));
    }
    for ((robot, _), column) in few.iter().zip(&found) {
        match column.and_then(|c| jobs.get(c)) {
            Some(&(job, rack, node, _)) => {
                let task = Task::Fetch { job: Some(job), rack, node };
                writer.progress(job, JobState::Assigned { robot: *robot }, Some((*robot, task)), now);
            }
            None => left.push(*robot),
        }
    }
    for (i, (chain, column)) in chains.iter().zip(&found[few.len()..]).enumerate() {
        if *column == Some(jobs.len() + i) {
            let (robot, state) = (chain.robot, JobState::Carrying { robot: chain.robot });
            writer.progress(chain.job, state, Some((robot, chain.task())), now);
        }
    }
    left
}

/// The cost of each job for each robot, milliseconds. Rows are idle robots, then the robots of chains; columns are jobs
/// for racks in storage, then the jobs of chains, then as many columns for no job as there are rows.
fn costs(
    floor: Floor<'_>,
    few: &[(RobotId, Ways)],
    jobs: &[(JobId, RackId, NodeId, i64)],
    chains: &[ChainedJob],
    now: Time,
) -> Vec<Vec<i64>> {
    let under_way = floor.under_way();
    let work = floor.work_ahead(now);
    let congestion = |id: JobId, rack: NodeId| {
        floor.lack_of_work(id, rack, &work).unwrap_or_else(|| floor.congestion(id, &under_way))
    };
    let worth: Vec<i64> =
        jobs.iter().map(|(id, _, node, urgency_ms)| congestion(*id, *node) - urgency_ms).collect();
    let rows = few.len() + chains.len();
    let row = |ways: &Ways, before_ms: i64, chain: Option<(usize, i64)>| -> Vec<i64> {
        let known = ways.iter().zip(&worth).map(|(way, w)| way.map_or(NEVER, |way| before_ms + way + w));
        let mut row: Vec<i64> = known.chain(std::iter::repeat_n(NEVER, chains.len() + rows)).collect();
        if let Some((i, cost)) = chain {
            row[jobs.len() + i] = cost;
        }
        row
    };
    let queue = &floor.ledger.index().queue;
    let oldest = queue.oldest(now);
    let charger_is_free = floor.a_charger_is_free();
    let idle = few.iter().map(|(_, ways)| row(ways, 0, None));
    let carriers = chains.iter().enumerate().map(|(i, chain)| {
        let here = floor.ledger.node_of(chain.robot);
        let own = congestion(chain.job, here) - queue.urgency_ms(chain.job, now, &oldest);
        // A robot that is to charge would take no other job.
        let ways = match floor.is_charged(chain.robot, charger_is_free) {
            true => floor.ways_from(chain.robot, chain.store, jobs, now),
            false => vec![None; jobs.len()],
        };
        row(&ways, floor.saves_ms(chain), Some((i, own)))
    });
    idle.chain(carriers).collect()
}

/// Waiting jobs whose rack stands in storage and is moved by no robot, with their urgency, most urgent first; one per
/// rack. A rack above a robot that is not one of the idle ones, which are sorted by number, is left out: no other robot
/// can get beneath it. So is a job that neither an idle robot nor one that could go on with its rack may do.
fn candidates(
    floor: Floor<'_>,
    needs: &Needs,
    (robots, carriers): (&[RobotId], &[RobotId]),
    now: Time,
) -> Vec<(JobId, RackId, NodeId, i64)> {
    let queue = &floor.ledger.index().queue;
    let (oldest, wanted) = (queue.oldest(now), queue.racks_wanted());
    let enough = stations_with_enough(floor, needs, now);
    let has_room = |goal| !matches!(goal, RackGoal::Station(s) if enough.contains(&s));
    let mut seen: BTreeSet<RackId> = BTreeSet::new();
    // Jobs from behind one that cannot go on: for the same rack, the first job of another line may be more urgent.
    let mut behind: BTreeMap<RackId, (JobId, RackId, NodeId, i64)> = BTreeMap::new();
    let mut found = Vec::new();
    let most = (PAIRS / (robots.len().min(ROBOTS) + carriers.len()).max(1)).min(JOBS);
    for id in queue.offers(now, has_room) {
        if found.len() == most || seen.len() == wanted {
            break;
        }
        let rack = floor.ledger.jobs[&id].request.kind.rack().expect("offers are for racks");
        let RackAt::Stored(node) = floor.ledger.racks[rack] else { continue };
        let is_another = |r: RobotId| robots.binary_search(&r).is_err();
        if seen.contains(&rack) || floor.ledger.resident(node).is_some_and(is_another) {
            continue;
        }
        let is_open = |id: &JobId| !floor.job_is_closed_off(&floor.ledger.jobs[id].request.kind, node);
        // A job that is for another robot does not keep these robots from the jobs behind it.
        let is_theirs = |id: &JobId| {
            let job = &floor.ledger.jobs[id];
            let is_for = |r: &RobotId| job.request.is_for(floor.warehouse(), floor.body(*r), (rack, node));
            robots.iter().chain(carriers).any(|r| floor.is_allowed(*r, job, now) && is_for(r))
        };
        // Only relocations in one line have goals of their own: behind a closed one may be an open one.
        let has_one_goal = floor.ledger.jobs[&id].request.kind.station().is_some();
        let is_shut = floor.is_shut_off(node) || has_one_goal && !is_open(&id);
        let mut all = std::iter::once(id).chain(queue.behind(id).take_while(|_| !is_shut));
        if let Some(job) = all.find(|id| is_open(id) && is_theirs(id)) {
            let offer = (job, rack, node, queue.urgency_ms(job, now, &oldest));
            let best =
                behind.remove(&rack).filter(|(.., urgency_ms)| *urgency_ms >= offer.3).unwrap_or(offer);
            // What the other lines have for this rack is no more urgent than the first job of this one.
            if best.3 >= queue.urgency_ms(id, now, &oldest) {
                seen.insert(rack);
                found.push(best);
            } else {
                behind.insert(rack, best);
            }
        } else if floor.is_shut_off(node) {
            seen.insert(rack);
        }
    }
    found.extend(behind.into_values());
    found.sort_by_key(|(.., urgency_ms)| std::cmp::Reverse(*urgency_ms));
    found
}

impl Floor<'_> {
    /// For each robot, how long its ways to the racks of these jobs take, milliseconds.
    fn ways(
        &self,
        robots: &[RobotId],
        jobs: &[(JobId, RackId, NodeId, i64)],
        now: Time,
    ) -> Vec<(RobotId, Ways)> {
        robots.iter().map(|r| (*r, self.ways_from(*r, self.ledger.node_of(*r), jobs, now))).collect()
    }

    /// How long a robot's ways from a node to the racks of these jobs take, milliseconds.
    fn ways_from(
        &self,
        robot: RobotId,
        from: NodeId,
        jobs: &[(JobId, RackId, NodeId, i64)],
        now: Time,
    ) -> Ways {
        let way_to = |id, rack| self.way_ms((robot, from), id, rack, now);
        jobs.iter().map(|(id, rack, node, _)| way_to(*id, (*rack, *node))).collect()
    }

    /// How long the robot's way from a node to a rack takes, milliseconds; nothing if another robot stands there for
    /// ever, the robot is not of a kind for the job, its charge does not last for it, a broken robot stands between, or
    /// an operator wants another robot to do it.
    pub(crate) fn way_ms(
        &self,
        (robot, from): (RobotId, NodeId),
        job: JobId,
        (rack, node): (RackId, NodeId),
        now: Time,
    ) -> Option<i64> {
        let job = &self.ledger.jobs[&job];
        let kind = &job.request.kind;
        if self.ledger.resident(node).is_some_and(|r| r != robot)
            || !job.request.is_for(self.warehouse(), self.body(robot), (rack, node))
            || !self.is_allowed(robot, job, now)
            || !self.restrictions.cut_off.may_fetch(from, node)
        {
            return None;
        }
        let at = |n: NodeId| self.warehouse().nodes[n].at;
        let way_m = along_axes(at(from), at(node));
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

    /// The cost of many racks being under way to the job's station already, milliseconds.
    fn congestion(&self, job: JobId, under_way: &IdVec<StationId, usize>) -> i64 {
        let JobKind::Deliver { station, .. } = self.ledger.jobs[&job].request.kind else { return 0 };
        let places = self.warehouse().stations[station].queue.len() + 1;
        CONGESTION_MS * (under_way[station].saturating_sub(places / 2)) as i64
    }
}

/// How long a robot's ways to the racks of some jobs take, milliseconds; nothing for a job that it cannot do.
type Ways = Vec<Option<i64>>;

/// The robots that one step matches, by number, and the robots that are left over. Those nearest to some rack are
/// matched, so that a robot that alone can do a job has its turn however many others cannot.
fn nearest(mut robots: Vec<(RobotId, Ways)>) -> (Vec<(RobotId, Ways)>, Vec<RobotId>) {
    if robots.len() <= ROBOTS {
        return (robots, Vec::new());
    }
    robots.sort_by_cached_key(|(r, ways)| (ways.iter().flatten().min().copied().unwrap_or(i64::MAX), *r));
    let left = robots.split_off(ROBOTS).into_iter().map(|(r, _)| r).collect();
    robots.sort_by_key(|(r, _)| *r);
    (robots, left)
}

//! What closing an area would do: which stations and racks it cuts off, which robots it traps, which jobs would wait,
//! and which jobs are under way through it.
//!
//! Main types: [`ClosingEffect`], [`Affected`]. The walks are those that later decide which jobs wait ([`CutOff`]), so
//! the answer is what will happen. Refuses: to close anything.

use crate::Fleet;
use crate::state::closed_areas::nodes_of;
use crate::state::cut_off::CutOff;
use crate::state::fact::Task;
use crate::state::job::Job;
use crate::state::job_kind::JobKind;
use crate::state::ledger::RackAt;
use crate::state::worker::Closure;
use giveway_floor::id::{ClosureId, JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::Time;
use std::collections::BTreeSet;

/// How many of each are named.
pub const NAMED: usize = 20;

/// How many things are affected, and the first of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Affected<T> {
    /// How many things are affected.
    pub total: usize,
    /// The first [`NAMED`] of these things.
    pub first: Vec<T>,
}

impl<T> FromIterator<T> for Affected<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Affected<T> {
        let mut found = Affected { total: 0, first: Vec::new() };
        for item in items {
            found.total += 1;
            if found.first.len() < NAMED {
                found.first.push(item);
            }
        }
        found
    }
}

/// What closing an area would do to robots, racks and jobs, as things stand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClosingEffect {
    /// How many nodes are inside.
    pub nodes: usize,
    /// Stations that no rack would get to, or that none would get away from.
    pub stations: Vec<StationId>,
    /// Racks in storage that would get to no station.
    pub racks: Affected<RackId>,
    /// Robots that would get to no place where they can stay until the area is opened.
    pub trapped: Affected<RobotId>,
    /// Jobs that would wait until the area is opened.
    pub waiting: Affected<JobId>,
    /// Jobs whose robots have to pass the area, each with its robot.
    pub under_way: Affected<(JobId, RobotId)>,
    /// When the last of these robots is expected to be out of the area, if any has a route through.
    pub clear: Option<Time>,
}

impl Fleet {
    /// The nodes that a closure closes, each once.
    pub fn closed_by(&self, area: &Closure) -> Vec<NodeId> {
        nodes_of(area, self.writer.warehouse())
    }

    /// What closing an area would do.
    ///
    /// O(nodes × stations + open jobs): for a query, not for a step.
    pub fn effect_of_closing(&self, area: &Closure, now: Time) -> ClosingEffect {
        let w = self.writer.warehouse();
        let nodes = nodes_of(area, w);
        let (ledger, before) = (&self.writer.ledger(), &self.writer.restrictions.cut_off);
        let after = before.with_closed(w, &nodes, ClosureId(ledger.next_closure), now);
        let closed: BTreeSet<NodeId> = nodes.iter().copied().collect();
        let is_new = |s: &StationId| !before.blocked().any(|b| b == *s);
        let is_cut = |cut: &CutOff, n: NodeId| cut.storage().contains_key(&n);
        let racks = ledger.racks.pairs().filter_map(|(rack, at)| match at {
            RackAt::Stored(n) if is_cut(&after, *n) && !is_cut(before, *n) => Some(rack),
            RackAt::Stored(_) | RackAt::On(_) => None,
        });
        let traps = |r: &RobotId| after.traps(w, ledger.node_of(*r)) && !before.traps(w, ledger.node_of(*r));
        let waits = |job: &Job| self.would_wait(job, &after, now) && !self.would_wait(job, before, now);
        let waiting = ledger.jobs.iter().filter(|(_, job)| waits(job)).map(|(id, _)| *id);
        let through: Vec<(JobId, RobotId, Time)> =
            ledger.present().filter_map(|r| self.passes_until(r, &closed)).collect();
        ClosingEffect {
            nodes: nodes.len(),
            stations: after.blocked().filter(is_new).collect(),
            racks: racks.collect(),
            trapped: ledger.present().filter(traps).collect(),
            waiting: waiting.collect(),
            under_way: through.iter().map(|(job, robot, _)| (*job, *robot)).collect(),
            clear: through.iter().map(|(_, _, until)| *until).max(),
        }
    }

    /// Whether a job that has not lifted its rack would wait because of what is cut off.
    fn would_wait(&self, job: &Job, cut: &CutOff, now: Time) -> bool {
        let kind = &job.request.kind;
        let rack = kind.rack().map(|rack| self.writer.ledger().racks[rack]);
        let Some(RackAt::Stored(node)) = rack else { return false };
        let station = match *kind {
            JobKind::Deliver { station, .. } => cut.blocks_for_long(station, now),
            _ => None,
        };
        station.or_else(|| cut.blocks_job(self.writer.warehouse(), kind, node)).is_some()
    }

    /// The job of a robot that holds nodes of an area, and when the robot is to leave the last of them, apart from the
    /// node where its route ends.
    fn passes_until(&self, robot: RobotId, closed: &BTreeSet<NodeId>) -> Option<(JobId, RobotId, Time)> {
        let task = self.writer.ledger().robots[robot].task;
        if task == Task::Idle {
            return None;
        }
        let visits = self.writer.ledger().chain(robot).visits().filter(|v| closed.contains(&v.node));
        let until = visits.map(|v| v.leave).filter(|t| !t.is_forever()).max()?;
        Some((task.job()?, robot, until))
    }
}

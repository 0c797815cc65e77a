//! Jobs that name a robot, and send it somewhere.
//!
//! Main function: [`assign_named`]. Refuses: to send a robot where another one is going to stay for a job: it would
//! stand without a route until that one leaves, and does other jobs meanwhile.

use crate::state::fact::{Purpose, Task};
use crate::state::floor::Floor;
use crate::state::job::{JobFailure, JobState};
use crate::state::job_kind::RobotErrand;
use crate::state::needs::Needs;
use crate::state::planners::Planners;
use crate::state::writer::Writer;
use giveway_floor::id::{JobId, NodeId, RobotId};
use giveway_floor::route::Stage;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// A robot that has had no route for this long gives its job back, if the job could not begin now.
const LONG: Span = Span::from_secs(60);

/// Gives idle robots the jobs that name them: one for each robot, before any rack. More urgent jobs come first.
pub(crate) fn assign_named(writer: &mut Writer, needs: &Needs, planners: &mut Planners, now: Time) {
    give_back_kept(writer, needs, now);
    let floor = writer.floor();
    let named = |robot: RobotId| {
        let job = floor.named_job_for(robot).filter(|job| floor.may_begin(robot, *job))?;
        Some((floor.named_urgency_ms(job), robot, job))
    };
    let mut jobs: Vec<(i64, RobotId, JobId)> = floor.idle_robots(now).into_iter().filter_map(named).collect();
    if jobs.is_empty() {
        return;
    }
    jobs.sort_by_key(|(urgency_ms, _, job)| (Reverse(*urgency_ms), *job));
    let mut kept = floor.kept_nodes();
    for (_, robot, job) in jobs {
        begin(writer, planners, &mut kept, (robot, job), now);
    }
}

/// Sends an idle robot where a job says. The job waits while there is no place for it, while another robot keeps the
/// place, and while closed areas or broken robots are on all ways; it fails if no way leads there.
fn begin(
    writer: &mut Writer,
    planners: &mut Planners,
    kept: &mut BTreeMap<NodeId, RobotId>,
    (robot, job): (RobotId, JobId),
    now: Time,
) {
    let floor = writer.floor();
    let errand = floor.ledger.jobs[&job].request.kind.errand();
    let (goal, stay, purpose) = match errand.expect("a job that names a robot sends it somewhere") {
        RobotErrand::Charge => (None, floor.free_place(robot, NodeKind::Charger), Purpose::Charge),
        RobotErrand::Park => (None, floor.free_place(robot, NodeKind::Parking), Purpose::Park),
        RobotErrand::Go(node) => (Some(node), floor.stay_for(robot, node), Purpose::Go),
    };
    let Some(stay) = stay else { return };
    let goal = goal.unwrap_or(stay);
    if !floor.may_go(robot, goal, kept) {
        return;
    }
    let here = writer.ledger().node_of(robot);
    let ways = [Stage::to_stay(goal), Stage::to_stay(stay)];
    let kind = writer.ledger().kinds().of(&writer.ledger().robots[robot].kind);
    if planners.of_mut(kind).free_flow(here, &ways).is_none() {
        return writer.progress(job, JobState::Failed(JobFailure::Unreachable), None, now);
    }
    let task = Task::Move { job: Some(job), goal, stay, purpose };
    writer.progress(job, JobState::Assigned { robot }, Some((robot, task)), now);
    kept.insert(stay, robot);
}

/// Robots that have long had no route to where a job sends them give the job back, if it could not begin now.
fn give_back_kept(writer: &mut Writer, needs: &Needs, now: Time) {
    let floor = writer.floor();
    let lacks = needs.waiting.iter().filter(|(_, need)| now - need.since >= LONG);
    let stuck = lacks.filter_map(|(robot, _)| match floor.ledger.robots[*robot].task {
        Task::Move { job: Some(job), goal, .. } if floor.lacks_route(*robot) => Some((*robot, job, goal)),
        _ => None,
    });
    let stuck: Vec<(RobotId, JobId, NodeId)> = stuck.collect();
    if stuck.is_empty() {
        return;
    }
    let kept = floor.kept_nodes();
    for (robot, job, goal) in stuck {
        if !writer.floor().may_go(robot, goal, &kept) {
            writer.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
        }
    }
}

impl Floor<'_> {
    /// Where robots are going to stay for a job, and where they stand with a rack and no route: no other robot gets
    /// there before something else changes. Linear in robots.
    pub(crate) fn kept_nodes(&self) -> BTreeMap<NodeId, RobotId> {
        let kept = |robot: RobotId| match self.ledger.robots[robot].task {
            Task::Move { job: Some(_), stay, .. } => Some((stay, robot)),
            task if task.carried().is_some() && self.lacks_route(robot) => {
                Some((self.ledger.node_of(robot), robot))
            }
            _ => None,
        };
        self.ledger.present().filter_map(kept).collect()
    }

    /// Whether a robot could go to a node now: no other robot keeps it, and nothing is on all ways.
    fn may_go(&self, robot: RobotId, goal: NodeId, kept: &BTreeMap<NodeId, RobotId>) -> bool {
        let cut_off = &self.restrictions.cut_off;
        let ends = (self.ledger.node_of(robot), goal);
        kept.get(&goal).is_none_or(|other| *other == robot)
            && cut_off.between(self.warehouse(), ends, false, std::iter::empty()).is_none()
    }

    /// The node itself if robots may stay there, whichever robot is there now; else another place to stay.
    fn stay_for(&self, robot: RobotId, node: NodeId) -> Option<NodeId> {
        let lasting = self.warehouse().nodes[node].kind.is_lasting();
        if lasting { Some(node) } else { self.any_stay(robot) }
    }
}

//! Robots that hold one another's goals: deadlock cycles, chains that end in an idle robot, and how both are broken.
//!
//! A robot without a route whose goal another robot holds for ever waits until that robot leaves. If that robot waits
//! likewise, and so on back to the first, none of them ever gets a route: each stands where it may stay, so nothing
//! moves it. Then one of them leaves for a free place and keeps its task. This frees its place, so the robot behind it
//! gets its route, and the others follow one by one; the robot that left comes last. Each broken cycle ends with all of
//! its tasks done, so this cannot go on for ever. At the end of a chain, the idle robot leaves. If the robot that is to
//! leave has had no free place to go to for [`HOPE`], the newest of the jobs fails, and says why.
//!
//! Refuses: to move robots if one of them cannot drive or has been halted by a person, who also ends that; and to send
//! away from its charger a robot that has no charge to drive on.

use crate::state::fact::Task;
use crate::state::floor::Floor;
use crate::state::job::{JobFailure, JobState};
use crate::state::writer::Writer;
use crate::traffic::stages::commit;
use crate::traffic::state::Traffic;
use crate::traffic::tentative::PLACES;
use giveway_floor::id::{JobId, NodeId, RobotId};
use giveway_floor::route::Stage;
use giveway_floor::time::{Span, Time};

/// A chain that no robot can leave is given up after this; until then, a place may become free.
const HOPE: Span = Span::from_secs(30);

/// Robots, each of which waits for the place of the next.
struct GoalChain {
    robots: Vec<RobotId>,
    /// The robot that leaves for a free place: in a cycle, the first one; otherwise the last one, which is idle.
    leaver: RobotId,
}

impl Traffic {
    /// If a robot waits for places in a cycle, or behind an idle robot, sends one of the robots to a free place, or
    /// gives up a job if there has been no free place for long.
    pub(super) fn break_goal_chain(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        let floor = writer.floor();
        let Some(GoalChain { robots, leaver }) = floor.goal_chain(robot) else { return };
        debug_assert!(robots.contains(&leaver), "{leaver:?} leaves a chain in which it does not wait");
        let can_drive = |r: &RobotId| floor.scene.fit(*r, now).is_some() && !floor.is_halted(*r);
        if !robots.iter().all(can_drive) || leaver != robot && floor.is_critical(leaver) {
            return;
        }
        if self.leave_aside(writer, leaver, now) {
            for other in robots.iter().filter(|r| **r != leaver) {
                self.needs.waiting.entry(*other).and_modify(|need| need.next_try = now);
            }
            return;
        }
        let fails_since = self.needs.waiting.get(&robot).and_then(|need| need.fails_since);
        let is_hopeless = |r: &RobotId| writer.floor().places_aside(*r).is_empty();
        if fails_since.is_some_and(|since| now - since > HOPE) && robots.iter().all(is_hopeless) {
            give_up_newest(writer, &robots, now);
        }
    }

    /// Sends a resting robot to a free place, the nearest ones first and others at later tries. The robot does nothing
    /// of its task there. Returns whether it goes.
    fn leave_aside(&mut self, writer: &mut Writer, robot: RobotId, now: Time) -> bool {
        let loaded = writer.floor().ledger.rack_on(robot).is_some();
        let tries = self.needs.waiting.get(&robot).map_or(0, |need| need.tries as usize);
        let places = writer.floor().places_aside(robot);
        let first = if places.is_empty() { 0 } else { (tries / PLACES) * PLACES % places.len() };
        for place in places.into_iter().cycle().skip(first).take(PLACES) {
            let stage = Stage { loaded, ..Stage::to_stay(place) };
            if let Ok(mut route) = self.search(writer.floor(), robot, &[stage], now) {
                route.stops.clear();
                commit(writer, robot, route);
                return true;
            }
        }
        false
    }
}

/// The newest job of the robots in a chain fails; its robot stays where it is, or puts its rack away.
fn give_up_newest(writer: &mut Writer, chain: &[RobotId], now: Time) {
    let job_of = |r: &RobotId| Some((writer.ledger().robots[*r].task.job()?, *r));
    let Some((job, robot)): Option<(JobId, RobotId)> = chain.iter().filter_map(job_of).max() else { return };
    let floor = writer.floor();
    let task = match floor.ledger.rack_on(robot) {
        Some(rack) => {
            let here = floor.ledger.node_of(robot);
            Task::Store { job: None, rack, store: floor.best_storage(robot, rack, here, 0) }
        }
        None => Task::Idle,
    };
    writer.progress(job, JobState::Failed(JobFailure::NoPlaceAside), Some((robot, task)), now);
}

impl Floor<'_> {
    /// Free places, other than its current one, where a resting robot could stay, the nearest first.
    fn places_aside(&self, robot: RobotId) -> Vec<NodeId> {
        let here = self.ledger.node_of(robot);
        self.stays_near(robot, usize::MAX, |n| n != here)
    }

    /// The robot that, as things stand, holds for ever a place to which the rest of this robot's task leads.
    pub(crate) fn keeper_of_goal(&self, robot: RobotId) -> Option<RobotId> {
        let stages = self.stages(robot);
        let goals = stages.iter().map(|stage| (stage.goal, stage.loaded));
        let mut lasting = goals.filter(|(goal, _)| self.warehouse().kind(*goal).is_lasting());
        lasting.find_map(|(goal, loaded)| self.keeper(robot, goal, loaded))
    }

    /// The other robot that has a hold without end on a place, or on a place in conflict with it.
    fn keeper(&self, robot: RobotId, place: NodeId, loaded: bool) -> Option<RobotId> {
        let timeline = self.ledger.timeline();
        let line = timeline.line(robot, loaded, self.warehouse().node_resource(place));
        let mut held = timeline.held_by_others(line, robot).filter(|h| h.window.end().is_forever());
        held.next().map(|h| h.holder)
    }

    /// The robots that wait for one another's places, from this one on, if their chain ends in this robot or in an idle
    /// one. A chain that leads into a cycle behind this robot is left to the robots of that cycle.
    fn goal_chain(&self, robot: RobotId) -> Option<GoalChain> {
        let mut robots = vec![robot];
        let mut at = robot;
        while self.lacks_route(at) && self.rests(at) {
            at = self.keeper_of_goal(at)?;
            if at == robot {
                return Some(GoalChain { robots, leaver: robot });
            }
            if robots.contains(&at) {
                return None;
            }
            robots.push(at);
        }
        let is_idle = self.ledger.robots[at].task == Task::Idle && self.rests(at);
        is_idle.then_some(GoalChain { robots, leaver: at })
    }
}

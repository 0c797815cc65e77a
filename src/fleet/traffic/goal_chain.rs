//! Robots that keep one another's goals: cycles of them, chains that end in an idle robot, and how both are broken.
//!
//! A robot without a route whose goal another robot keeps for ever waits until that one leaves. If that one waits
//! likewise, and so on back to the first, none of them ever gets a route: each stands where it may stay, so nothing
//! moves it. Then one of them leaves for a free place and keeps its task. Its place is free then, so the robot behind
//! it gets its route, and the others one after the other; the one that left is the last. Each cycle that is broken ends
//! with all of its tasks done, so it is not broken for ever. At the end of a chain, the idle robot leaves. If the one
//! that is to leave has had no free place to go to for [`HOPE`], the newest of the jobs fails, and says why.
//!
//! Refuses: to move robots if one of them cannot drive or is held by a person, who ends that; and to send a robot away
//! from its charger that has no charge to drive on.

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

/// A chain that no robot can leave is given up after this: a place may become free meanwhile.
const HOPE: Span = Span::from_secs(30);

/// Robots each of which waits for the place of the next one.
struct GoalChain {
    robots: Vec<RobotId>,
    /// The one that leaves for a free place: the first, if the last keeps its goal from going on in a cycle; the last,
    /// if that one is idle.
    leaver: RobotId,
}

impl Traffic {
    /// If a robot waits for places in a cycle, or behind an idle robot, sends one of them to a free place, or gives a
    /// job up if there has been none for long.
    pub(super) fn break_goal_chain(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        let floor = writer.floor();
        let Some(GoalChain { robots, leaver }) = floor.goal_chain(robot) else { return };
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

    /// Sends a robot that rests to a free place, the nearest ones first and others at later tries. Nothing of its task
    /// is done there. Whether it goes.
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
    /// Free places other than its own where a robot that rests could stay, the nearest first.
    fn places_aside(&self, robot: RobotId) -> Vec<NodeId> {
        let here = self.ledger.node_of(robot);
        self.stays_near(robot, usize::MAX, |n| n != here)
    }

    /// The robot that keeps the place where the rest of a robot's task leads for ever, as things stand.
    pub(crate) fn keeper_of_goal(&self, robot: RobotId) -> Option<RobotId> {
        let stages = self.stages(robot);
        let goals = stages.iter().map(|stage| (stage.goal, stage.loaded));
        let mut lasting = goals.filter(|(goal, _)| self.warehouse().kind(*goal).is_lasting());
        lasting.find_map(|(goal, loaded)| self.keeper(robot, goal, loaded))
    }

    /// The other robot that has a hold without end on a place, or on one in conflict with it.
    fn keeper(&self, robot: RobotId, place: NodeId, loaded: bool) -> Option<RobotId> {
        let timeline = self.ledger.timeline();
        let line = timeline.line(robot, loaded, self.warehouse().node_resource(place));
        let mut held = timeline.held_by_others(line, robot).filter(|h| h.window.end().is_forever());
        held.next().map(|h| h.holder)
    }

    /// The robots that wait for one another's places, from this one on, if their chain ends in itself or in an idle
    /// robot. A chain that leads into a cycle behind this robot is left to the robots of that cycle.
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

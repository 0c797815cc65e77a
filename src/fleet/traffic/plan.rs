//! Fifth phase: which robots need a route? One search each, within a budget of expansions per step.
//!
//! Robots in need are in [`Needs`](crate::state::needs::Needs). A new route replaces the old one only when it is
//! complete up to a place where the robot may stay for ever; else the old one stands (DESIGN §5, invariant
//! a). Refuses: to let the time of day decide how much is planned.

use crate::state::cut_off::Barrier;
use crate::state::fact::{RobotFact, Task};
use crate::state::floor::Floor;
use crate::state::job_kind::JobKind;
use crate::state::needs::Need;
use crate::state::passing::{HeldChoice, cheapest};
use crate::state::writer::Writer;
use crate::traffic::stages::commit;
use crate::traffic::state::Traffic;
use giveway_floor::id::{IdVec, NodeId, RobotId};
use giveway_floor::route::{NoRoute, Route, RouteQuery, Stage};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::Visit;
use std::collections::BTreeSet;

/// The first pause after a failed search; it doubles up to [`RETRY_MAX`].
const RETRY: Span = Span::from_millis(400);
const RETRY_MAX: Span = Span::from_millis(6400);
/// How many times at most the budget of a search is doubled.
const DOUBLINGS: u32 = 4;
/// Each time this many searches have failed, others are asked to make way.
const INSERT_EVERY: u32 = 3;
/// A robot that has waited this long for another searches for a better route.
const PATIENCE: Span = Span::from_secs(4);
/// A better route saves at least this.
pub(super) const WORTH: Span = Span::from_secs(1);

/// Whether a route can be searched for now: the robot needs one and can drive, and its next stop is not granted (it may
/// be working there already).
fn is_ready(floor: Floor<'_>, robot: RobotId, now: Time) -> bool {
    let fit = floor.scene.fit(robot, now).is_some() && !floor.next_stop_is_granted(robot);
    fit && floor.lacks_route(robot)
}

impl Traffic {
    /// Plans routes for robots that need one, longest waiting first, and earlier routes for robots that may go on
    /// earlier.
    pub(crate) fn plan_needed(&mut self, writer: &mut Writer, now: Time) {
        self.needs.tickets.note(writer.floor(), now);
        self.lapse_places(writer, now);
        let in_need = self.in_need(writer.floor(), now);
        let mut bound = if in_need.is_empty() { IdVec::new() } else { writer.floor().bound_for_stations() };
        for (i, robot) in in_need.iter().copied().enumerate() {
            if self.effort.is_spent() {
                let left = in_need[i..].iter().copied();
                let ready = left
                    .filter(|r| is_ready(writer.floor(), *r, now))
                    .filter(|r| self.needs.has_its_turn(writer.floor(), *r, &bound, now));
                self.needs.postponed = self.needs.still_postponed(ready, now);
                return;
            }
            if !is_ready(writer.floor(), robot, now) {
                continue;
            }
            if !self.needs.has_its_turn(writer.floor(), robot, &bound, now) {
                self.wait_for_turn(writer, robot, now);
                continue;
            }
            let waited = self.needs.waited(robot, now);
            self.plan_one(writer, robot, now);
            if let Some(station) =
                writer.floor().station_of(robot).filter(|_| !writer.floor().lacks_route(robot))
            {
                self.needs.set_off.insert(station, waited);
                bound[station] += 1;
            }
        }
        self.needs.postponed.clear();
        self.plan_early(writer, now);
    }

    /// Searches for an earlier route for each robot whose stop ended before its planned end.
    fn plan_early(&mut self, writer: &mut Writer, now: Time) {
        for robot in std::mem::take(&mut self.needs.early) {
            let is_fit = writer.scene.fit(robot, now).is_some() && !writer.ledger().robots[robot].failed;
            if is_fit && !writer.floor().lacks_route(robot) {
                self.improve_one(writer, robot, now);
            }
        }
    }

    /// Robots whose task asks for a route that they do not have, longest waiting first. A robot bound for a station has
    /// waited since it lifted its rack. If one of them is sent to a node, so are those that have waited for that node,
    /// even if their pauses are not over: otherwise each newcomer would get there before them.
    fn in_need(&mut self, floor: Floor<'_>, now: Time) -> Vec<RobotId> {
        for robot in floor.ledger.present() {
            if floor.lacks_route(robot) {
                let fresh =
                    Need { since: now, next_try: now, tries: 0, fails_since: None, behind: None, cut: None };
                self.needs.waiting.entry(robot).or_insert(fresh);
            } else {
                self.needs.waiting.remove(&robot);
            }
        }
        let goal = |robot: &RobotId| match floor.ledger.robots[*robot].task {
            Task::Move { goal, .. } => Some(goal),
            Task::Idle | Task::Fetch { .. } | Task::Deliver { .. } | Task::Store { .. } => None,
        };
        let is_due = |need: &Need| need.next_try <= now;
        let wanted: BTreeSet<NodeId> =
            self.needs.waiting.iter().filter(|(_, n)| is_due(n)).filter_map(|(r, _)| goal(r)).collect();
        let is_wanted = |robot: &RobotId| goal(robot).is_some_and(|n| wanted.contains(&n));
        let due = self.needs.waiting.iter().filter(|(r, n)| is_due(n) || is_wanted(r));
        let turn = |robot: &RobotId, need: &Need| self.needs.tickets.since(*robot).unwrap_or(need.since);
        let mut robots: Vec<(Time, RobotId)> = due.map(|(r, n)| (turn(r, n), *r)).collect();
        robots.sort_unstable();
        robots.into_iter().map(|(_, r)| r).collect()
    }

    /// Runs one search for one robot; after several failed searches, others make way, or the robot does.
    fn plan_one(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        debug_assert!(writer.floor().lacks_route(robot), "{robot:?} has the route that its task asks for");
        self.choose_storage(writer, robot);
        let stages = writer.floor().stages(robot);
        match self.search(writer.floor(), robot, &stages, now) {
            Ok(route) => {
                commit(writer, robot, route);
                self.needs.waiting.remove(&robot);
            }
            Err(why) => {
                self.tally.failures += 1;
                let cut = writer.floor().cut_before_goal(robot, self.obstructed());
                let need = self.needs.waiting.get_mut(&robot).expect("it is in need");
                need.next_try = now + Span((RETRY.0 << need.tries.min(4)).min(RETRY_MAX.0));
                need.tries += 1;
                need.fails_since.get_or_insert(now);
                need.cut = cut;
                tracing::debug!(?robot, ?why, tries = need.tries, "no route");
                if need.tries.is_multiple_of(INSERT_EVERY) {
                    self.ask_for_room(writer, robot, now);
                }
            }
        }
    }

    /// Makes others give way to a robot that finds no route; else sends it to a place where it may stay, or breaks a
    /// chain of goals.
    fn ask_for_room(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        if self.insert(writer, robot, now) {
            self.needs.waiting.remove(&robot);
        } else if !self.step_out(writer, robot, None, now) {
            self.break_goal_chain(writer, robot, now);
        }
    }

    /// Looks for a better storage node before a rack leaves, and after each failed search.
    fn choose_storage(&mut self, writer: &mut Writer, robot: RobotId) {
        let tries = self.needs.waiting.get(&robot).map_or(0, |n| n.tries as usize);
        let task = match writer.ledger().robots[robot].task {
            Task::Deliver { job, rack, station, store } => {
                let best = writer.floor().best_storage(robot, rack, station, tries);
                (best != store).then_some(Task::Deliver { job, rack, station, store: best })
            }
            Task::Store { job, rack, store } if tries > 0 && !writer.floor().is_relocation(job) => {
                let here = writer.ledger().node_of(robot);
                // A robot that already stands at its storage node can set the rack down, whatever is in its way.
                if store == here {
                    return;
                }
                let best = writer.floor().best_storage(robot, rack, here, tries);
                (best != store).then_some(Task::Store { job, rack, store: best })
            }
            _ => None,
        };
        if let Some(task) = task {
            writer.record(RobotFact::Tasked { robot, task });
        }
    }

    /// Labels that a search for a robot may expand: twice as many after each failed search. On a crowded floor a route
    /// may be farther from the first labels than one budget reaches; with a constant budget, the search would fail for
    /// ever.
    fn budget(&self, floor: Floor<'_>, robot: RobotId) -> u32 {
        let tries = self.needs.waiting.get(&robot).map_or(0, |need| need.tries);
        let usual = floor.settings.expansions_per_plan;
        // A step expands no more than its limit plus the usual budget of its last search.
        (usual << tries.min(DOUBLINGS)).min(self.effort.left().max(usual))
    }

    /// A route from where the robot's grants end.
    pub(crate) fn search(
        &mut self,
        floor: Floor<'_>,
        robot: RobotId,
        stages: &[Stage],
        now: Time,
    ) -> Result<Route, NoRoute> {
        let (from, heading) = floor.grant_end(robot);
        self.search_from(floor, robot, (from, heading), stages, now)
    }

    /// A route from a visit, with the robot's heading at its end, as if the robot held nothing else.
    pub(super) fn search_from(
        &mut self,
        floor: Floor<'_>,
        robot: RobotId,
        (from, heading): (Visit, f64),
        stages: &[Stage],
        now: Time,
    ) -> Result<Route, NoRoute> {
        if self.effort.is_spent() {
            return Err(NoRoute::BudgetSpent);
        }
        floor.at_hand.note(robot);
        debug_assert!(!floor.ledger.robots[robot].failed, "{robot:?} has failed and goes nowhere");
        let ready = now.max(from.arrive) + floor.settings.period;
        let (budget, exemptions) = (self.budget(floor, robot), floor.exemptions(robot, now));
        let body = floor.body(robot);
        let conditions = floor.restrictions.conditions.of(body);
        let ask =
            RouteQuery { from: &from, heading, ready, stages, budget, conditions, exemptions: &exemptions };
        let kind = floor.kind(robot);
        let planner = self.planners.of_mut(kind);
        let start = (floor.settings.stopwatch)();
        let found = planner.plan(&ask, &floor.ledger.timeline().without(&[robot]));
        self.effort.spend(planner.expanded());
        self.plan_times.push((floor.settings.stopwatch)() - start);
        self.tally.plans += 1;
        found
    }

    /// Robots that wait for others search for a better route now and then. This changes the order on a resource where
    /// keeping it would pass one robot's delay on to the fleet. The new windows fit between the holds of all robots, so
    /// the overall order stays free of cycles.
    pub(crate) fn improve(&mut self, writer: &mut Writer, now: Time) {
        for robot in writer.ledger().present() {
            if self.effort.is_spent() {
                return;
            }
            let looked = self.needs.looked.get(&robot).copied().unwrap_or(Time::ZERO);
            if now - looked < PATIENCE || !writer.floor().is_held_up(robot, now) {
                continue;
            }
            self.needs.looked.insert(robot, now);
            self.improve_one(writer, robot, now);
        }
    }

    fn improve_one(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        let Some(stop) = writer.ledger().robots[robot].stops.first().copied() else { return };
        let chain = writer.ledger().chain(robot);
        let Some(planned) = chain.get(stop.serial).map(|v| v.arrive) else { return };
        if stop.serial < chain.granted() {
            return;
        }
        let stages = writer.floor().stages_left(robot);
        match self.search(writer.floor(), robot, &stages, now) {
            Ok(route) if reached(&route) + WORTH < planned => commit(writer, robot, route),
            Ok(_) | Err(_) => {}
        }
    }

    /// Searches for a route that avoids people, and takes it if it is earlier than the rest of the old one after the
    /// wait, and than passing the people, if the robot can do that. Returns the best choice.
    pub(crate) fn reroute(
        &mut self,
        writer: &mut Writer,
        robot: RobotId,
        (waited, passes): (Span, Option<Time>),
        now: Time,
    ) -> HeldChoice {
        let Some(stop) = writer.ledger().robots[robot].stops.first().copied() else {
            return HeldChoice::Wait;
        };
        let planned = writer.floor().expected(robot, stop.serial, waited, now);
        let stages = writer.floor().stages_left(robot);
        let found = self.search(writer.floor(), robot, &stages, now).ok();
        let choice = cheapest(planned, found.as_ref().map(reached), passes);
        if let (HeldChoice::Reroute, Some(route)) = (choice, found) {
            commit(writer, robot, route);
            self.tally.replans += 1;
        }
        choice
    }

    /// Replans an interrupted robot; the old route stands unless the new one is earlier.
    pub(crate) fn plan_again(&mut self, writer: &mut Writer, robot: RobotId, waited: Span, now: Time) {
        let stop = writer.ledger().robots[robot].stops.first().copied();
        let Some(stop) = stop.filter(|s| s.serial >= writer.ledger().chain(robot).granted()) else { return };
        let planned = writer.floor().expected(robot, stop.serial, waited, now);
        let stages = writer.floor().stages_left(robot);
        self.tally.replans += 1;
        match self.search(writer.floor(), robot, &stages, now) {
            Ok(route) if reached(&route) < planned => commit(writer, robot, route),
            Ok(_) | Err(_) => {}
        }
    }

    /// Plans a route to a place aside and then on with the task. Returns whether a route was found and taken.
    pub fn detour(&mut self, writer: &mut Writer, robot: RobotId, place: NodeId, now: Time) -> bool {
        let Some(stages) = writer.floor().stages_aside(robot, place) else { return false };
        let Ok(route) = self.search(writer.floor(), robot, &stages, now) else { return false };
        let route = writer.floor().with_own_stops(robot, route);
        commit(writer, robot, route);
        true
    }
}

impl Floor<'_> {
    /// What cuts a robot off from the next goal of its task, if something does.
    fn cut_before_goal(&self, robot: RobotId, obstructed: impl Iterator<Item = NodeId>) -> Option<Barrier> {
        let stages = self.stages(robot);
        let (here, next) = (self.ledger.node_of(robot), stages.first()?);
        let cut_off = &self.restrictions.cut_off;
        cut_off.between(self.warehouse(), (here, next.goal), next.loaded, obstructed)
    }

    fn is_relocation(&self, job: Option<giveway_floor::id::JobId>) -> bool {
        let kind = job.and_then(|j| self.ledger.jobs.get(&j)).map(|j| j.request.kind);
        matches!(kind, Some(JobKind::Relocate { .. }))
    }

    /// When a robot reaches a visit if it waits for all people and closures on its way and has already waited for
    /// `waited`.
    fn expected(&self, robot: RobotId, serial: u64, waited: Span, now: Time) -> Time {
        let chain = self.ledger.chain(robot);
        let planned = chain.get(serial).map_or(now, |v| v.arrive);
        let late = match self.waits_until(robot, now) {
            Some(until) => {
                let next = chain.get(chain.granted()).map_or(now, |v| v.enter.max(now));
                (until - next).max(Span::ZERO)
            }
            None => Span::ZERO,
        };
        // How long people stay is unknown; the best guess is as long again as so far.
        planned + late.max(waited)
    }

    /// Whether the robot stands at the end of what it was granted because another robot comes first.
    fn is_held_up(&self, robot: RobotId, now: Time) -> bool {
        let chain = self.ledger.chain(robot);
        let at_end = chain.first() + 1 == chain.granted() && chain.granted() < chain.end();
        let slow = self.scene.fit(robot, now).is_some_and(|t| t.speed_mps < 0.1);
        let late = chain.get(chain.granted()).is_some_and(|v| v.enter < now);
        at_end && slow && late && !self.lacks_route(robot)
    }
}

/// When a route reaches the first stop.
pub(super) fn reached(route: &Route) -> Time {
    route.first_arrival()
}

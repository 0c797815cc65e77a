//! Areas that are closed for a time, announced in advance. A robot whose route leads into such an area gets another one
//! before the closure begins, no robot sets off for a place inside, robots that rest inside leave, and closures that
//! ended long ago are forgotten. The place of a person who has been standing for long is treated alike.
//!
//! The search knows every announced closure as a condition, so new routes need nothing from this module. Refuses: to
//! stop robots (grants do), and to take back what was granted.

use crate::state::closed_areas::storage_behind;
use crate::state::fact::{AreaFact, Purpose, RobotFact, Task};
use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::recurring::ANNOUNCED;
use crate::state::regions::KindConditions;
use crate::state::restrictions::ClosedNodes;
use crate::state::worker::Closure;
use crate::state::writer::Writer;
use crate::state::yielding::STANDS;
use crate::traffic::stages::commit;
use crate::traffic::state::Traffic;
use giveway_floor::id::{ClosureId, JobId, NodeId, RackId, RobotId, SeriesId};
use giveway_floor::route::{COME_OUT, Cause, Condition, Conditions, Effect, Stage};
use giveway_floor::time::{Span, Time, Window};
use giveway_people::aware::{HumanAwarePolicy, Zone};
use std::collections::BTreeMap;

/// A robot whose route leads into a closed area searches for another one at most this often.
const AGAIN: Span = Span::from_secs(5);

/// A robot that has stood with its rack for this long, cut off from where the rack is to go, sets it down elsewhere.
const LONG: Span = Span::from_secs(60);

/// Begins and ends announced closures, and forgets those that ended long ago. All other restrictions of the previous
/// step are dropped.
pub(crate) fn renew_areas(writer: &mut Writer, now: Time) {
    announce_recurring(writer, now);
    for closure in writer.renew_restrictions(now) {
        writer.record(AreaFact::Reopened { closure, at: now });
    }
}

/// Announces the occurrences of recurring closures that begin within the hour, and the next one in any case. A
/// series without further occurrences ends when its last one is over.
fn announce_recurring(writer: &mut Writer, now: Time) {
    let changes = writer.ledger().index().closure_changes();
    if writer.ledger().recurring.is_empty() || !writer.restrictions.areas.looks_at_recurring(changes, now) {
        return;
    }
    let all: Vec<SeriesId> = writer.ledger().recurring.keys().copied().collect();
    for series in all {
        announce_next(writer, series, now);
        let is_open = |c: &Closure| c.series == Some(series) && now < c.window.end();
        let goes_on = writer.ledger().recurring[&series].next.is_some();
        if !goes_on && !writer.ledger().closures.values().any(is_open) {
            writer.record(AreaFact::SeriesEnded { series, at: now });
        }
    }
}

fn announce_next(writer: &mut Writer, series: SeriesId, now: Time) {
    loop {
        let recurring = &writer.ledger().recurring[&series];
        let Some(begins) = recurring.due(now) else {
            if recurring.next.is_some() {
                writer.record(AreaFact::Scheduled { series, next: None });
            }
            return;
        };
        let ahead = |c: &Closure| c.series == Some(series) && now < c.window.start();
        if begins > now + ANNOUNCED && writer.ledger().closures.values().any(ahead) {
            return;
        }
        let (area, next) = (recurring.occurrence(begins), recurring.first_from(begins + Span(1)));
        writer.record(AreaFact::Closed { closure: ClosureId(writer.ledger().next_closure), area });
        writer.record(AreaFact::Scheduled { series, next });
    }
}

/// Nodes that count as closed because a person has been standing there for long, from the conditions that people cause.
pub(crate) fn stood_on(floor: Floor<'_>, people: &KindConditions, now: Time) -> ClosedNodes {
    if floor.settings.policy != HumanAwarePolicy::Giveway {
        return ClosedNodes::default();
    }
    let areas = &floor.restrictions.areas;
    let shuts = |c: &&Condition| c.effect == Effect::NoEntryOrExit && c.window.end() > now + STANDS;
    let of = |n: NodeId| people.all().flat_map(move |set| set.of(n));
    let begins = |n: NodeId| of(n).filter(shuts).map(|c| c.window.start()).min();
    let shut = |n: NodeId| Some((n, begins(n)?.min(areas.begins_here(n).unwrap_or(Time::MAX))));
    let closing: BTreeMap<NodeId, Time> =
        people.all().flat_map(Conditions::passing).filter_map(shut).collect();
    let either = |n: NodeId| closing.get(&n).copied().or_else(|| areas.begins_here(n));
    let cut_off = closing.keys().flat_map(|n| storage_behind(floor.warehouse(), *n, either));
    let since = closing.iter().map(|(n, t)| (*n, *t)).chain(cut_off).collect();
    ClosedNodes { conditions: Vec::new(), since }
}

impl Traffic {
    /// Gives another route to each robot whose promised route leads through a closed area or ends in one.
    pub(crate) fn route_round_closures(&mut self, writer: &mut Writer, now: Time) {
        if writer.restrictions.closing.is_empty() && writer.restrictions.areas.is_empty() {
            return;
        }
        for robot in writer.ledger().present() {
            let looked = self.looked_round.get(&robot).is_some_and(|t| now - *t < AGAIN);
            if self.effort.is_spent() || looked || !writer.floor().can_be_routed_round(robot, now) {
                continue;
            }
            let floor = writer.floor();
            let ends_there = floor.task_elsewhere(robot) != floor.ledger.robots[robot].task;
            if ends_there || floor.fetches_too_late(robot, now) || floor.leads_into_closed(robot, now) {
                self.looked_round.insert(robot, now);
                self.route_round(writer, robot, now);
            }
        }
    }

    /// Searches for another route for the rest of the task, to another place if the goal is closed. If there is no
    /// route, the old one stands.
    fn route_round(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        if gives_job_back(writer, robot, now) {
            return;
        }
        let old = writer.ledger().robots[robot].task;
        let floor = writer.floor();
        let task = floor.task_elsewhere(robot);
        if task != old {
            writer.record(RobotFact::Tasked { robot, task });
        }
        let stages = writer.floor().stages_left(robot);
        self.tally.replans += 1;
        match self.search(writer.floor(), robot, &stages, now) {
            Ok(route) => commit(writer, robot, route),
            Err(_) if task != old => writer.record(RobotFact::Tasked { robot, task: old }),
            Err(_) => self.set_down_instead(writer, robot, 0, now),
        }
    }

    /// Robots that have stood with racks for a while, cut off from where these are to go, set them down elsewhere.
    pub(crate) fn set_down_cut_off(&mut self, writer: &mut Writer, now: Time) {
        if writer.restrictions.cut_off.is_empty() {
            self.cut_off.clear();
            return;
        }
        for robot in writer.ledger().present() {
            if !writer.floor().stands_cut_off(robot, now) {
                self.cut_off.remove(&robot);
                continue;
            }
            let (due, tries) = *self.cut_off.entry(robot).or_insert((now + LONG, 0));
            if due <= now && !self.effort.is_spent() {
                self.cut_off.insert(robot, (now + AGAIN, tries + 1));
                self.set_down_instead(writer, robot, tries, now);
            }
        }
    }

    /// A robot that is cut off from where its rack is to go brings it to storage that it can reach, and gives the job
    /// back if it has one: it would stand with the rack until the area is opened, or the robot repaired.
    /// `choice` counts down the list of places.
    fn set_down_instead(&mut self, writer: &mut Writer, robot: RobotId, choice: usize, now: Time) {
        let floor = writer.floor();
        let Some((job, rack)) = floor.carries_in_vain(robot, now) else { return };
        let store = floor.best_storage(robot, rack, floor.ledger.node_of(robot), choice);
        let lift = floor.kinematics(robot).lift;
        let stage = Stage { loaded: true, stay: lift, ..Stage::to_stay(store) };
        if let Ok(route) = self.search(writer.floor(), robot, &[stage], now) {
            let task = Task::Store { job: None, rack, store };
            match job {
                Some(job) => writer.progress(job, JobState::Waiting, Some((robot, task)), now),
                None => writer.record(RobotFact::Tasked { robot, task }),
            }
            commit(writer, robot, route);
        }
    }
}

/// If a robot would fetch a rack from a closed place, it gives the job back, and another robot gets the job later.
/// Returns whether it did.
fn gives_job_back(writer: &mut Writer, robot: RobotId, now: Time) -> bool {
    let Task::Fetch { job: Some(job), node, .. } = writer.ledger().robots[robot].task else { return false };
    if !writer.floor().job_is_closed_off(&writer.ledger().jobs[&job].request.kind, node) {
        return false;
    }
    let Some(stay) = writer.floor().any_stay(robot) else { return false };
    let task = Task::rest_at(stay, Purpose::Park);
    writer.progress(job, JobState::Waiting, Some((robot, task)), now);
    true
}

impl Floor<'_> {
    /// Whether a visit that the robot was promised, but not granted, meets a closure.
    fn leads_into_closed(&self, robot: RobotId, now: Time) -> bool {
        let chain = self.ledger.chain(robot);
        let ahead = (chain.granted()..chain.end()).filter_map(|s| chain.get(s));
        let conditions = self.conditions(robot);
        let mut ahead = ahead.filter(|v| conditions.is_touched(v.node)).peekable();
        if ahead.peek().is_none() {
            return false;
        }
        let exemptions = self.exemptions(robot, now);
        ahead.any(|v| {
            // A robot does not really stay for ever where its route ends, but it needs time to come out.
            let enter = v.enter.max(now);
            let leave = if v.leave.is_forever() { v.arrive.max(now) + COME_OUT } else { v.leave };
            let robot = Window::new(enter, leave.max(enter + Span(1)));
            let binding = conditions.binding(v.node, self.warehouse().nodes[v.node].at, &exemptions);
            binding
                .filter(|c| c.effect == Effect::Closed && !matches!(c.cause, Cause::Worker(_)))
                .any(|c| Zone { robot, worker: c.window }.meets())
        })
    }

    /// The rack that a robot carries, and its job if it has one, if closed areas or broken robots are on all ways to
    /// where the rack is to go.
    fn carries_in_vain(&self, robot: RobotId, now: Time) -> Option<(Option<JobId>, RackId)> {
        let (job, rack, goal) = match self.ledger.robots[robot].task {
            Task::Deliver { job, rack, station, store } => match self.ledger.jobs.get(&job).map(|j| &j.state)
            {
                Some(JobState::Carrying { .. }) => (Some(job), rack, station),
                Some(JobState::Picking { .. }) => return None,
                _ => (None, rack, store),
            },
            Task::Store { job, rack, store } => (job, rack, store),
            Task::Idle | Task::Fetch { .. } | Task::Move { .. } => return None,
        };
        let (here, cut_off) = (self.ledger.node_of(robot), &self.restrictions.cut_off);
        let station = self.warehouse().kind(goal).reserved_for();
        let is_blocked = station.is_some_and(|s| cut_off.blocks_for_long(s, now).is_some());
        (is_blocked || cut_off.keeps_rack_from(self.warehouse(), here, goal)).then_some((job, rack))
    }

    /// Whether a robot stands with a rack, cut off from where it is to bring it, at the end of what it was granted.
    fn stands_cut_off(&self, robot: RobotId, now: Time) -> bool {
        let chain = self.ledger.chain(robot);
        let stands = chain.first() + 1 == chain.granted() && !self.next_stop_is_granted(robot);
        let can_drive = !self.ledger.robots[robot].failed && self.scene.fit(robot, now).is_some();
        stands && can_drive && self.carries_in_vain(robot, now).is_some()
    }

    /// Whether a robot on its way to a rack could not come out with it before the way is closed.
    fn fetches_too_late(&self, robot: RobotId, now: Time) -> bool {
        let record = &self.ledger.robots[robot];
        let (Task::Fetch { node, .. }, Some(lift)) = (record.task, record.stops.first()) else {
            return false;
        };
        let Some(begins) = self.restrictions.closes(node) else { return false };
        let arrive = self.ledger.chain(robot).get(lift.serial).map_or(now, |v| v.arrive.max(now));
        arrive + self.kinematics(robot).lift + COME_OUT > begins
    }

    /// The robot's task, with another end if its own end is closed and the task may end elsewhere.
    fn task_elsewhere(&self, robot: RobotId) -> Task {
        let here = self.ledger.node_of(robot);
        match self.ledger.robots[robot].task {
            Task::Deliver { job, rack, station, store } if self.is_no_end(robot, store) => {
                Task::Deliver { job, rack, station, store: self.best_storage(robot, rack, station, 0) }
            }
            Task::Store { job: None, rack, store } if self.is_no_end(robot, store) => {
                Task::Store { job: None, rack, store: self.best_storage(robot, rack, here, 0) }
            }
            Task::Move { job: None, goal, stay, purpose } if goal == stay && self.is_closing(stay) => {
                let stay = self.any_stay(robot).unwrap_or(stay);
                Task::rest_at(stay, purpose)
            }
            task => task,
        }
    }

    /// Whether a storage node is closed, will be soon, or is cut off from a robot.
    fn is_no_end(&self, robot: RobotId, store: NodeId) -> bool {
        self.is_closing(store) || self.is_cut_off_from(robot, store)
    }

    /// Whether a robot has a route of which a part can still be changed.
    fn can_be_routed_round(&self, robot: RobotId, now: Time) -> bool {
        let at_stop = self.ledger.robots[robot].stops.first().map(|s| s.serial);
        let free = at_stop.is_some_and(|s| s >= self.ledger.chain(robot).granted());
        free && !self.lacks_route(robot) && self.scene.fit(robot, now).is_some()
    }
}

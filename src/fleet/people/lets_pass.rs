//! People who let a robot pass: the last resort for a robot that people have kept in one place for long, though each of
//! them walks on.
//!
//! Where people come and go, no chain of waiting stands still, and a robot can wait without end all the same. So a
//! robot that has made no progress for [`STARVES`] goes first: people in its way are led to a place aside, or told to
//! stand where they are if that is aside already, until the robot has passed or [`AT_MOST`] is over. A person who
//! stands as told is a standing obstacle, which a slow robot passes at the distance at which it can still stop. A robot
//! that keeps a person in one spot and itself waits for other people goes first, too: a person who is shut in waits for
//! all of them. A person whose headset is unsure of its place closes more floor than the person does, and is asked to
//! touch marks first. Refuses: to keep a person for longer, and to ask the same person again within [`AGAIN`].

use crate::people::blocked::WaysPast;
use crate::people::state::{HumanState, LetsPass, LetsPassStage, WalkMode};
use crate::state::floor::Floor;
use crate::state::wait_graph::{Edge, Party};
use crate::state::yielding::YieldingState;
use giveway_floor::geometry::Point;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::route::{Cause, Effect};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::HumanAwarePolicy;
use giveway_people::human::{Presence, SourceId, Whereabouts};
use std::collections::BTreeSet;

/// A robot that people have kept from making progress for this long goes first.
const STARVES: Span = Span::from_secs(90);
/// A robot that has waited for people for this long since it last acted goes first, wherever: it may drive to and fro.
const STARVES_ON_ITS_WAY: Span = Span::from_secs(180);
/// A robot for which people have stood aside within [`LATELY`] goes first after this: it is still in the same crowd.
const STARVES_AGAIN: Span = Span::from_secs(20);
const LATELY: Span = Span::from_secs(300);
/// A robot for which a worker waits inherits the worker's wait: if robots have kept the worker in one spot for this
/// long, people in the robot's way stand aside.
const SHUT_IN: Span = Span::from_secs(18);
/// No person stands aside for longer than this.
const AT_MOST: Span = Span::from_secs(30);
/// The fleet keeps no person in one spot for longer than this to let robots pass, whatever else it kept the person for.
const KEEPS_AT_MOST: Span = Span::from_secs(40);
/// Standing aside for less than this lets no robot pass.
const AT_LEAST: Span = Span::from_secs(10);
/// No person is asked to let a robot pass again within this.
const AGAIN: Span = Span::from_secs(60);
/// How many nodes ahead of a robot are what it is about to drive.
const AHEAD: usize = 5;
/// How much farther from the robot's way a person aside is than the distance at which the robot would stop, metres.
const ROOM_M: f64 = 0.4;
/// A person whose headset knows its place worse than this is to touch marks; one standard deviation, metres.
const UNSURE_M: f64 = 0.4;
/// No person is asked for marks for a robot again within this.
const MARKS_AGAIN: Span = Span::from_secs(300);
/// A person who waits on the way and is not seen for this long after the end of the wait does not wait any more.
const UNSEEN: Span = Span::from_secs(1);
/// A person who has stood for this long stands still.
const STANDS_STILL: Span = Span::from_secs(1);

impl HumanState {
    /// Lets people who have let a robot pass go on, and asks people in the way of robots that have waited for long.
    pub(super) fn let_robots_pass(&mut self, floor: Floor<'_>, yielding: &YieldingState, now: Time) {
        if floor.settings.policy != HumanAwarePolicy::Giveway || self.people.is_empty() {
            return;
        }
        for worker in self.people.ids() {
            let place = self.whereabouts(worker, now);
            let Some(lets_pass) = self.people[worker].lets_pass else { continue };
            if self.people[worker].message.is_some_and(|message| message.is_standoff(now)) {
                // The robot waits for the worker all the same: the worker goes first.
                self.people[worker].waited_at = Some(now);
                self.go_on(floor, yielding, worker, now);
                continue;
            }
            if lets_pass.stage == LetsPassStage::Waits {
                // A worker who is not seen any more is not told to go on either.
                if now >= lets_pass.until + UNSEEN {
                    self.people[worker].lets_pass = None;
                }
                continue;
            }
            let knows = place.as_ref().is_some_and(|p| p.sigma_m <= UNSURE_M);
            if floor.has_passed(&lets_pass, place.as_ref(), now) {
                self.go_on(floor, yielding, worker, now);
            } else if lets_pass.stage == LetsPassStage::TouchesMarks && knows {
                self.people[worker].lets_pass = None;
            }
        }
        self.passed.retain(|_, last| now - *last < LATELY);
        self.let_out(floor, yielding, now);
        for (robot, worker, waited) in floor.waits.starving(now, STARVES_AGAIN, STARVES_ON_ITS_WAY) {
            if waited < STARVES && !self.passed.contains_key(&robot) {
                continue;
            }
            self.clear_the_way(floor, yielding, (robot, worker), None, now);
        }
    }

    /// Asks the people in the way of a robot to let it pass, also the worker for whom it waits, but not one whom it
    /// shuts in.
    fn clear_the_way(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        (robot, waits_for): (RobotId, WorkerId),
        inside: Option<WorkerId>,
        now: Time,
    ) {
        let mut in_the_way = floor.in_the_way_of(robot);
        in_the_way.insert(waits_for);
        for worker in in_the_way.into_iter().filter(|w| Some(*w) != inside) {
            self.ask_to_let_pass(floor, yielding, worker, robot, now);
        }
    }

    /// Has people stand aside for robots that keep others in one spot: a robot inherits the wait of the worker whom it
    /// shuts in, along the chain of waiting (priority inheritance).
    fn let_out(&mut self, floor: Floor<'_>, yielding: &YieldingState, now: Time) {
        for inside in self.people.ids() {
            if floor.waits.kept_in_one_spot(inside) < SHUT_IN {
                continue;
            }
            let Some(at) = self.whereabouts(inside, now).map(|w| w.at) else { continue };
            let ahead = floor.waits.worker(inside).edge.robot();
            let around = floor.ledger.present().filter(|r| floor.stands_near(*r, at));
            let mut keep: Vec<RobotId> = around.chain(ahead).collect();
            keep.iter_mut().for_each(|r| *r = floor.waits.last_robot(*r));
            keep.sort_unstable();
            keep.dedup();
            for robot in keep {
                let Edge::On(Party::Worker(outside)) = floor.waits.robot(robot).edge else { continue };
                self.clear_the_way(floor, yielding, (robot, outside), Some(inside), now);
            }
        }
    }

    /// Has a person go on with the task: the robot has passed, or the time is over.
    fn go_on(&mut self, floor: Floor<'_>, yielding: &YieldingState, worker: WorkerId, now: Time) {
        let place = self.whereabouts(worker, now);
        let person = &mut self.people[worker];
        (person.lets_pass, person.let_pass_at) = (None, Some(now));
        let aside = person.plan.as_ref().is_some_and(|plan| plan.assignment.is_none());
        if aside {
            (person.plan, person.mode) = (None, WalkMode::Idle);
            if let Some(place) = place {
                self.route_on(floor, yielding, worker, place.at, now);
            }
        }
    }

    fn ask_to_let_pass(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        robot: RobotId,
        now: Time,
    ) {
        let Some(place) = self.whereabouts(worker, now).filter(|p| p.presence != Presence::Lost) else {
            return;
        };
        let person = &self.people[worker];
        let lately = person.let_pass_at.is_some_and(|at| now - at < AGAIN);
        // A worker who stands where robots wait and has no way to go is asked to make room (`routing.rs`).
        let has_a_way = person.plan.is_some() && !matches!(person.mode, WalkMode::Stopped { .. });
        let to_touch_marks = self.has_to_touch_marks(worker, &place, now);
        let is_free = match floor.waits.worker(worker).edge {
            Edge::Moves => true,
            Edge::Still => has_a_way || to_touch_marks,
            Edge::Until(_) => person.waits().is_some(),
            _ => false,
        };
        let lets_pass = person.lets_pass.is_some() && person.waits().is_none();
        if lets_pass || lately || !is_free {
            return;
        }
        let ahead = floor.about_to_drive(robot);
        let enough_m = floor.regions(robot).towards(&place).stop_radius_m(true, place.sigma_m) + ROOM_M;
        let is_aside = ahead.iter().all(|p| (p - place.at).norm() > enough_m);
        let reached = floor.ledger.chain(robot).first();
        let stage = match is_aside {
            _ if to_touch_marks => LetsPassStage::TouchesMarks,
            true => LetsPassStage::Stands,
            false => LetsPassStage::Walks,
        };
        let mut longest = AT_MOST;
        if stage != LetsPassStage::Walks {
            longest = longest.min(KEEPS_AT_MOST - floor.waits.kept_in_one_spot(worker));
            if longest < AT_LEAST {
                return;
            }
        }
        if stage == LetsPassStage::TouchesMarks {
            self.people[worker].marks_asked = Some(now);
        }
        if stage == LetsPassStage::Walks {
            let body = (place.mover, place.at);
            let cut = self.edges_blocked_for_long(floor, yielding, place.mover, now);
            let ways = WaysPast::new(self, floor, body, &cut);
            let Some(points) = self.place_aside(floor, &ahead, body, enough_m, &ways) else {
                tracing::debug!(?worker, ?robot, enough_m, "there is no place aside");
                return;
            };
            let person = &mut self.people[worker];
            person.give(points, None, Span::ZERO, now);
            person.mode = WalkMode::Redirected;
        }
        tracing::debug!(?worker, ?robot, ?stage, "lets a robot pass");
        self.people[worker].lets_pass =
            Some(LetsPass { robot, reached, since: now, until: now + longest, stage });
        self.passed.insert(robot, now);
    }

    /// Whether a person's headset is so unsure of its place that marks are to be touched first.
    fn has_to_touch_marks(&self, worker: WorkerId, place: &Whereabouts, now: Time) -> bool {
        let person = &self.people[worker];
        let asked = person.marks_asked.is_some_and(|at| now - at < MARKS_AGAIN);
        let by_headset = person.track.newest().is_some_and(|s| s.source == SourceId::Headset);
        place.sigma_m > UNSURE_M && by_headset && !asked
    }

    /// Follows a person who lets a robot pass; at the end of the way aside, the person stands.
    pub(super) fn watch_aside(&mut self, worker: WorkerId, place: &Whereabouts) {
        let person = &mut self.people[worker];
        let arrived = match &mut person.plan {
            Some(plan) if plan.assignment.is_none() => {
                plan.follower.observe(place.at, place.sigma_m);
                plan.is_there(place.at)
            }
            _ => true,
        };
        if let Some(lets_pass) = &mut person.lets_pass
            && lets_pass.stage == LetsPassStage::Walks
            && arrived
        {
            lets_pass.stage = LetsPassStage::Stands;
        }
    }

    /// Whether a person was told to let a robot pass, and stands.
    pub(crate) fn stands_aside(&self, worker: WorkerId, now: Time) -> bool {
        let person = &self.people[worker];
        let stands = person.stands_since.is_some_and(|since| now - since >= STANDS_STILL);
        let told = person.lets_pass.map(|l| l.stage);
        matches!(told, Some(LetsPassStage::Stands | LetsPassStage::Waits)) && stands
    }

    /// People who stand to let robots pass.
    pub(super) fn standing_aside(&self, now: Time) -> BTreeSet<WorkerId> {
        self.people.ids().filter(|w| self.stands_aside(*w, now)).collect()
    }
}

impl Floor<'_> {
    /// Whether a person no longer has to let a robot pass.
    fn has_passed(&self, lets_pass: &LetsPass, place: Option<&Whereabouts>, now: Time) -> bool {
        let robot = lets_pass.robot;
        let is_far = |w: &Whereabouts| {
            let far_m = self.regions(robot).towards(w).keep_out_radius_m(true, w.sigma_m);
            self.about_to_drive(robot).iter().all(|p| (p - w.at).norm() > far_m)
        };
        let has_left = self.ledger.chain(robot).first() > lets_pass.reached && place.is_none_or(is_far);
        has_left || now >= lets_pass.until || self.scene.fit(robot, now).is_none() || self.is_halted(robot)
    }

    /// The places that a robot is about to drive over.
    fn about_to_drive(&self, robot: RobotId) -> Vec<Point> {
        let visits = self.ledger.chain(robot).visits().take(AHEAD);
        let ahead = visits.map(|v| self.warehouse().nodes[v.node].at);
        std::iter::once(self.place_of(robot)).chain(ahead).collect()
    }

    /// The workers whose regions keep a robot from where it is about to drive.
    fn in_the_way_of(&self, robot: RobotId) -> BTreeSet<WorkerId> {
        let visits = self.ledger.chain(robot).visits().take(AHEAD);
        let conditions = visits.flat_map(|v| self.conditions(robot).of(v.node));
        let hard = conditions.filter(|c| matches!(c.effect, Effect::NoEntryOrExit | Effect::Closed));
        let workers = hard.filter_map(|c| if let Cause::Worker(w) = c.cause { Some(w) } else { None });
        workers.collect()
    }
}

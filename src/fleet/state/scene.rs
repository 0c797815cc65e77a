//! What is seen: the newest observation of each robot. Lost at a restart and seen again.
//!
//! Main types: [`Scene`], [`RobotSeen`]. Refuses: older observations than it has, and to trust any for ever.

use crate::state::displaced::Displaced;
use crate::state::fault::Fault;
use crate::state::io::Telemetry;
use crate::state::link::{LinkReach, LinkState};
use crate::state::robot_clock::ReportOrder;
use giveway_floor::id::{Dense, RobotId};
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// A robot without an observation for this long is silent: it gets no new grants.
pub const SILENCE: Span = Span::from_secs(3);
/// If a robot that may drive has stood for this long by its own reports, something keeps it from driving: its scanner
/// sees what the fleet does not know of. Turning on the spot takes less.
const KEPT: Span = Span::from_secs(15);

/// What is seen of one robot.
#[derive(Clone, Debug, Default)]
pub struct RobotSeen {
    /// The newest observation.
    pub newest: Option<Telemetry>,
    /// When the newest observation came in, by the fleet's own clock: robots' clocks may be wrong.
    heard: Option<Time>,
    /// Which of the robot's reports are news.
    order: ReportOrder,
    /// The state of the robot's link, if it is not as usual.
    link: Option<Box<LinkState>>,
    /// When the robot's link last came up again.
    up: Option<Time>,
    /// How long the robot has stood in its place, if it stands.
    still: Option<StandsStill>,
    /// When orders were last sent to the robot.
    pub told: Option<Time>,
    /// Whether the robot was found where the ledger has it, and not elsewhere since.
    placed: bool,
    /// How far the robot has driven, metres: the sum of the steps between its poses.
    driven_m: f64,
}

/// How long a robot has stood in its place.
#[derive(Clone, Copy, Debug)]
struct StandsStill {
    /// How long of that time the robot had more to drive and was not told to stand. A stop or a revoked grant in
    /// between does not restart this: a robot whose scanner sees a person whom the fleet believes beside it is stopped,
    /// called back and released in turn.
    free: Span,
    /// When the robot last reported that it stands.
    said: Time,
}

/// What is seen of all robots.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    robots: Vec<RobotSeen>,
    /// Robots that report a fault.
    faulty: BTreeSet<RobotId>,
    /// Robots that have stood for [`KEPT`] though they may drive.
    kept: BTreeSet<RobotId>,
    /// Robots that pass people beside the line: they may stand there though nothing keeps them.
    passing: BTreeSet<RobotId>,
    /// Robots that cannot go on from where they stand.
    displaced: BTreeMap<RobotId, Displaced>,
    /// When the first step was.
    began: Option<Time>,
}

impl Scene {
    /// Takes in an observation that arrived at `now`; one that was overtaken is ignored. Its date says how old it is,
    /// as far as the robot's clock can be trusted; from here on, the date is in the fleet's own time.
    pub fn see(&mut self, t: Telemetry, now: Time) {
        let seen = self.robot_mut(t.robot);
        let Some(made) = seen.order.take(t.seq, t.seen, now) else { return };
        let t = Telemetry { seen: made, ..t };
        seen.heard = Some(now);
        let before = seen.still.filter(|_| seen.newest.is_some_and(|n| n.reached == t.reached));
        let may_drive = t.known > t.reached;
        let is_free = may_drive && t.limit_mps != Some(0.0);
        let since = before.filter(|_| is_free).map_or(Span::ZERO, |b| now - b.said);
        let free = before.map_or(Span::ZERO, |b| b.free) + since;
        // The time of a robot that was kept from driving restarts when it has forgotten its way.
        seen.still = (t.stands() && (may_drive || free < KEPT)).then_some(StandsStill { free, said: now });
        seen.driven_m += seen.newest.filter(|_| !t.stands()).map_or(0.0, |n| (t.pose.at - n.pose.at).norm());
        let before = seen.newest.replace(t).and_then(|n| n.fault);
        match seen.still.is_some_and(|still| still.free >= KEPT) {
            true => _ = self.kept.insert(t.robot),
            false => _ = self.kept.remove(&t.robot),
        }
        match t.fault {
            Some(_) => _ = self.faulty.insert(t.robot),
            None if before.is_some() => _ = self.faulty.remove(&t.robot),
            None => {}
        }
    }

    /// Forgets what was seen of a robot that is another one now, or stands elsewhere. Reports that are still under way
    /// from before stay overtaken.
    pub fn forget(&mut self, robot: RobotId) {
        let seen = self.robot_mut(robot);
        *seen = RobotSeen { order: seen.order, link: seen.link.take(), ..RobotSeen::default() };
        self.faulty.remove(&robot);
        self.kept.remove(&robot);
        self.passing.remove(&robot);
        self.displaced.remove(&robot);
    }

    /// Takes over the states of links, and which reports are news, from another fleet of the same robots.
    pub fn keep_links_of(&mut self, before: &Scene) {
        for (i, was) in before.robots.iter().enumerate() {
            let seen = self.robot_mut(RobotId::at(i));
            (seen.order, seen.link) = (was.order, was.link.clone());
        }
    }

    /// When the first step was; nothing before it.
    pub fn began(&self) -> Option<Time> {
        self.began
    }

    /// Notes that a step begins.
    pub fn begin(&mut self, now: Time) {
        self.began.get_or_insert(now);
    }

    /// The newest observation of a robot.
    pub fn robot(&self, robot: RobotId) -> Option<&Telemetry> {
        self.robots.get(robot.ix())?.newest.as_ref()
    }

    /// How far a robot was seen to drive, metres.
    pub fn driven_m(&self, robot: RobotId) -> f64 {
        self.robots.get(robot.ix()).map_or(0.0, |seen| seen.driven_m)
    }

    /// When the newest observation of a robot came in.
    pub fn heard(&self, robot: RobotId) -> Option<Time> {
        self.robots.get(robot.ix())?.heard
    }

    /// When orders were last sent to a robot.
    pub fn told(&self, robot: RobotId) -> Option<Time> {
        self.robots.get(robot.ix())?.told
    }

    /// Takes a link's report of its state for a robot.
    pub fn hear_link(&mut self, robot: RobotId, state: LinkState, now: Time) {
        let is_usual = state == LinkState::default();
        let comes_up = state.reach.is_up() && !self.is_connected(robot);
        let seen = self.robot_mut(robot);
        seen.up = if comes_up { Some(now) } else { seen.up };
        seen.link = (!is_usual).then(|| Box::new(state));
    }

    /// The state of a robot's link; nothing if it is as usual.
    pub fn link(&self, robot: RobotId) -> Option<&LinkState> {
        self.robots.get(robot.ix())?.link.as_deref()
    }

    /// Whether messages get through to a robot, as far as its link knows.
    pub fn reach(&self, robot: RobotId) -> LinkReach {
        self.link(robot).map_or(LinkReach::default(), |link| link.reach)
    }

    /// Whether the link of a robot is up.
    pub fn is_connected(&self, robot: RobotId) -> bool {
        self.reach(robot).is_up()
    }

    /// Since when a robot has been silent: since its newest observation or, if later, since its link came up. Before
    /// that it was silent whatever it had to say.
    pub fn silent_since(&self, robot: RobotId) -> Option<Time> {
        let seen = self.robots.get(robot.ix())?;
        seen.heard.max(seen.up)
    }

    /// Whether a robot's link takes no orders for it.
    pub fn is_refused(&self, robot: RobotId) -> bool {
        self.link(robot).is_some_and(|link| link.refuses.is_some())
    }

    /// The newest observation of a robot that was heard of lately, can drive and takes orders.
    pub fn fit(&self, robot: RobotId, now: Time) -> Option<&Telemetry> {
        let takes_orders = |t: &&Telemetry| !t.cannot_drive() && !self.is_refused(robot);
        self.robot(robot).filter(takes_orders).filter(|_| self.is_heard(robot, now))
    }

    /// Robots that report a fault, each with the fault, if they were heard of lately and can drive.
    pub fn faults(&self, now: Time) -> Vec<(RobotId, Fault)> {
        let fault = |r: &RobotId| Some((*r, self.fit(*r, now)?.fault?));
        self.faulty.iter().filter_map(fault).collect()
    }

    /// Robots that something keeps from driving, by their own report or because they have stood for long though they
    /// may drive, if they were heard of lately.
    pub fn kept_from_driving(&self, now: Time) -> Vec<RobotId> {
        let suspects = self.faulty.union(&self.kept).copied();
        suspects.filter(|r| self.is_kept_from_driving(*r, now)).collect()
    }

    /// Whether something keeps a robot from driving, by its own report or because it has stood for long though it may.
    pub fn is_kept_from_driving(&self, robot: RobotId, now: Time) -> bool {
        let Some(seen) = self.fit(robot, now) else { return false };
        seen.fault == Some(Fault::Obstructed) || self.kept.contains(&robot) && !self.passing.contains(&robot)
    }

    /// Notes whether a robot passes people beside the line.
    pub fn set_passing(&mut self, robot: RobotId, passes: bool) {
        match passes {
            true => _ = self.passing.insert(robot),
            false => _ = self.passing.remove(&robot),
        }
    }

    /// Whether a robot was heard of lately, or its link knows that it answers.
    pub fn is_heard(&self, robot: RobotId, now: Time) -> bool {
        let Some(heard) = self.heard(robot) else { return false };
        match self.reach(robot) {
            LinkReach::ByReports => now - heard <= SILENCE,
            LinkReach::Answers => true,
            LinkReach::Lost | LinkReach::Off | LinkReach::LineDown => false,
        }
    }

    /// Whether a robot was found where the ledger has it, and has not been found elsewhere since.
    pub fn is_placed(&self, robot: RobotId) -> bool {
        self.robots.get(robot.ix()).is_some_and(|r| r.placed)
    }

    /// Notes that a robot is where the ledger has it. Returns what was wrong before, if anything was.
    pub fn place(&mut self, robot: RobotId) -> Option<Displaced> {
        debug_assert!(self.robot(robot).is_some(), "{robot:?} is placed and was never seen");
        self.robot_mut(robot).placed = true;
        self.displaced.remove(&robot)
    }

    /// Notes that a robot cannot go on from where it stands.
    pub fn displace(&mut self, robot: RobotId, how: Displaced) {
        self.robot_mut(robot).placed = false;
        self.displaced.insert(robot, how);
    }

    /// Why a robot cannot go on from where it stands, if that is so.
    pub fn displaced(&self, robot: RobotId) -> Option<&Displaced> {
        self.displaced.get(&robot)
    }

    /// All robots that cannot go on from where they stand.
    pub fn all_displaced(&self) -> impl Iterator<Item = (RobotId, &Displaced)> {
        self.displaced.iter().map(|(r, d)| (*r, d))
    }

    /// The record of a robot.
    pub fn robot_mut(&mut self, robot: RobotId) -> &mut RobotSeen {
        if self.robots.len() <= robot.ix() {
            self.robots.resize_with(robot.ix() + 1, RobotSeen::default);
        }
        &mut self.robots[robot.ix()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::geometry::{Point, Pose};

    const R0: RobotId = RobotId(0);

    /// Reports of a robot that stands, with more to drive, under these limits, one each second.
    fn stands_under(limits: impl IntoIterator<Item = Option<f64>>) -> (Scene, Time) {
        reports(limits.into_iter().map(|limit| (limit, 5)))
    }

    /// Reports of a robot that stands, one each second, each with a limit and the last visit that it knows.
    fn reports(reports: impl IntoIterator<Item = (Option<f64>, u64)>) -> (Scene, Time) {
        let (mut scene, mut now) = (Scene::default(), Time::ZERO);
        for (limit_mps, known) in reports {
            now += Span::from_secs(1);
            let pose = Pose { at: Point::new(0.0, 0.0), heading: 0.0 };
            let (rack, fault, acted) = (None, None, None);
            let (speed_mps, battery, recalls) = (0.0, 1.0, 0);
            let t = Telemetry {
                robot: R0,
                seq: now.0.unsigned_abs(),
                seen: now,
                pose,
                speed_mps,
                reached: 3,
                known,
                acted,
                rack,
                battery,
                fault,
                limit_mps,
                recalls,
            };
            scene.see(t, now);
        }
        (scene, now)
    }

    #[test]
    fn a_robot_that_stands_for_long_though_it_may_drive_is_kept_from_driving_and_stays_so_when_told_to_stand()
    {
        let (scene, now) = stands_under([Some(0.5); 15]);
        assert_eq!(scene.kept_from_driving(now), [], "it may be about to set off");
        let (scene, now) = stands_under([Some(0.5); 16].into_iter().chain([Some(0.0); 3]));
        assert_eq!(scene.kept_from_driving(now), [R0]);
        let later = now + SILENCE + Span::from_secs(1);
        assert_eq!(scene.kept_from_driving(later), [], "it has not been heard of since");
    }

    #[test]
    fn a_robot_that_is_told_to_stand_is_not_kept_from_driving() {
        let (scene, now) = stands_under([Some(0.5); 10].into_iter().chain([Some(0.0); 30]));
        assert_eq!(scene.kept_from_driving(now), []);
    }

    #[test]
    fn a_robot_that_is_stopped_and_released_by_turns_and_never_moves_is_kept_from_driving() {
        let by_turns =
            |times| stands_under([Some(0.5), Some(0.5), Some(0.0)].into_iter().cycle().take(times));
        let (scene, now) = by_turns(21);
        assert_eq!(scene.kept_from_driving(now), []);
        let (scene, now) = by_turns(24);
        assert_eq!(scene.kept_from_driving(now), [R0]);
    }

    #[test]
    fn a_robot_that_is_called_back_and_released_by_turns_is_kept_from_driving_until_it_has_forgotten_its_way()
    {
        let by_turns =
            |times| [(Some(0.5), 5), (Some(0.5), 5), (Some(0.5), 3)].into_iter().cycle().take(times);
        let (scene, now) = reports(by_turns(23));
        assert_eq!(scene.kept_from_driving(now), [R0]);
        let (scene, now) = reports(by_turns(24).chain([(Some(0.5), 5); 5]));
        assert_eq!(scene.kept_from_driving(now), [], "it has another way");
    }
}

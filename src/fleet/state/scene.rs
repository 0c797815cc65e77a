//! What is seen: the newest observation of each robot. Lost at a restart and seen again.
//!
//! Main types: [`Scene`], [`RobotSeen`]. Refuses: older observations than it has, and to trust any for ever.

use crate::fleet::state::displaced::Displaced;
use crate::fleet::state::fault::Fault;
use crate::fleet::state::io::Telemetry;
use crate::id::{Dense, RobotId};
use crate::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// After this long without an observation a robot is silent: it gets no new grants.
pub const SILENCE: Span = Span::from_secs(3);

/// One robot as it is seen.
#[derive(Clone, Debug, Default)]
pub struct RobotSeen {
    /// The newest observation.
    pub newest: Option<Telemetry>,
    /// When that came in, by the fleet's own clock: robots' clocks may be wrong.
    heard: Option<Time>,
    /// When orders were sent to it last.
    pub told: Option<Time>,
    /// Whether it was found once where the ledger has it.
    placed: bool,
}

/// All robots as they are seen.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    robots: Vec<RobotSeen>,
    /// Robots that say that something is wrong with them.
    faulty: BTreeSet<RobotId>,
    /// Robots that cannot go on from where they stand.
    displaced: BTreeMap<RobotId, Displaced>,
    /// Since when anything could be seen.
    began: Option<Time>,
}

impl Scene {
    /// Takes an observation in that arrived `now`; an older one than the newest is ignored. The date of an observation
    /// only orders those of one robot.
    pub fn see(&mut self, t: Telemetry, now: Time) {
        let seen = self.robot_mut(t.robot);
        if seen.newest.is_some_and(|n| n.seen >= t.seen) {
            return;
        }
        seen.heard = Some(now);
        let before = seen.newest.replace(t).and_then(|n| n.fault);
        match t.fault {
            Some(_) => _ = self.faulty.insert(t.robot),
            None if before.is_some() => _ = self.faulty.remove(&t.robot),
            None => {}
        }
    }

    /// Forgets what was seen of a robot: it is another one, or stands elsewhere.
    pub fn forget(&mut self, robot: RobotId) {
        *self.robot_mut(robot) = RobotSeen::default();
        self.faulty.remove(&robot);
        self.displaced.remove(&robot);
    }

    /// Since when anything could be seen; nothing before the first step.
    pub fn began(&self) -> Option<Time> {
        self.began
    }

    /// A step begins.
    pub fn begin(&mut self, now: Time) {
        self.began.get_or_insert(now);
    }

    /// A robot as it is seen.
    pub fn robot(&self, robot: RobotId) -> Option<&Telemetry> {
        self.robots.get(robot.ix())?.newest.as_ref()
    }

    /// When the newest observation of a robot came in.
    pub fn heard(&self, robot: RobotId) -> Option<Time> {
        self.robots.get(robot.ix())?.heard
    }

    /// When orders were sent to a robot last.
    pub fn told(&self, robot: RobotId) -> Option<Time> {
        self.robots.get(robot.ix())?.told
    }

    /// A robot that was heard of lately and can drive.
    pub fn fit(&self, robot: RobotId, now: Time) -> Option<&Telemetry> {
        self.robot(robot).filter(|t| !t.cannot_drive() && self.is_heard(robot, now))
    }

    /// Robots that say that something is wrong with them, with what, if they were heard of lately and can drive.
    pub fn faults(&self, now: Time) -> Vec<(RobotId, Fault)> {
        let fault = |r: &RobotId| Some((*r, self.fit(*r, now)?.fault?));
        self.faulty.iter().filter_map(fault).collect()
    }

    /// Whether a robot was heard of lately.
    pub fn is_heard(&self, robot: RobotId, now: Time) -> bool {
        self.heard(robot).is_some_and(|t| now - t <= SILENCE)
    }

    /// Whether a robot was found where the ledger has it, and has not been found elsewhere since.
    pub fn is_placed(&self, robot: RobotId) -> bool {
        self.robots.get(robot.ix()).is_some_and(|r| r.placed)
    }

    /// A robot is where the ledger has it. What was wrong before, if anything was.
    pub fn place(&mut self, robot: RobotId) -> Option<Displaced> {
        debug_assert!(self.robot(robot).is_some(), "{robot:?} is placed and was never seen");
        self.robot_mut(robot).placed = true;
        self.displaced.remove(&robot)
    }

    /// A robot cannot go on from where it stands.
    pub fn displace(&mut self, robot: RobotId, how: Displaced) {
        self.robot_mut(robot).placed = false;
        self.displaced.insert(robot, how);
    }

    /// How it is with a robot that cannot go on from where it stands.
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

//! What is remembered of each robot that yields, from step to step. Lost at a restart, and found out again.
//!
//! Main types: [`YieldingState`], [`RobotYielding`] (one robot). Refuses: to decide; it says what was noted, and what
//! follows from that alone.

use crate::state::floor::Floor;
use crate::state::passing::RobotPassing;
use crate::state::worker::Reaction;
use giveway_floor::id::{IdVec, NodeId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::zone_answers::{self, OpenZone, ZoneAnswer, ZoneCounts};

/// A person who has stood for longer than this is not about to set off: the place counts as closed, and a robot that
/// has yielded for this long leaves, if it can.
pub(crate) const STANDS: Span = Span::from_secs(20);
/// After a robot has yielded for this long while a worker is near, each of them waits for the other.
const STUCK: Span = Span::from_secs(60);
/// Places farther from a person than this do not matter, metres: the distance of a place aside from robots' ways.
const FACES_M: f64 = 2.5;

/// A robot that stands still to yield to a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Standing {
    /// The worker; the last one if there were several.
    pub worker: WorkerId,
    /// Since when the robot has stood.
    pub since: Time,
    /// Since when the robot has yielded to this worker.
    pub facing_since: Time,
    /// The node where the robot came to stand.
    pub node: NodeId,
}

/// A robot that stops or goes elsewhere because of a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GivesWay {
    pub worker: WorkerId,
    pub reaction: Reaction,
    pub since: Time,
}

/// What is remembered of one robot that yields.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RobotYielding {
    /// The worker that the robot gives way to, until it is on its way again.
    pub to: Option<GivesWay>,
    /// The speed limit that the robot was last told, metres per second, and when.
    pub limit_told: Option<(Option<f64>, Time)>,
    /// The worker for whom the robot stands, or drives back slowly.
    pub stands: Option<Standing>,
    /// When the robot last searched for another route because of a worker.
    pub rerouted: Option<Time>,
    /// The zone that the robot is to share with a worker.
    zone: Option<OpenZone>,
    /// The worker whom the robot passes beside the line, and where.
    pub passing: Option<RobotPassing>,
    /// When the robot last looked for room to pass a person from between two nodes.
    pub passing_looked: Option<Time>,
}

impl RobotYielding {
    /// The speed limit that the robot was told, metres per second, if there is one.
    pub fn limit_mps(&self) -> Option<f64> {
        self.limit_told.and_then(|(limit, _)| limit)
    }

    /// Whether the robot was told to stand.
    pub fn is_told_to_stand(&self) -> bool {
        self.limit_mps() == Some(0.0)
    }

    /// The worker whom the robot passes on the lane that leads to a visit, if it passes one there.
    pub fn passes(&self, serial: u64) -> Option<WorkerId> {
        let what = self.passing?.what;
        (what.from < serial && serial <= what.to).then_some(what.worker)
    }

    /// For how long the robot has been giving way.
    pub fn waited(&self, now: Time) -> Span {
        self.to.map_or(Span::ZERO, |to| now - to.since)
    }
}

/// What is remembered of all robots that yield.
#[derive(Clone, Debug, Default)]
pub struct YieldingState {
    robots: IdVec<RobotId, RobotYielding>,
    /// How robots answered zones that are over. The counts promise nothing, so they start at zero with the process.
    pub answered: ZoneCounts,
}

impl YieldingState {
    /// What was noted of one robot; the default if nothing was noted.
    pub fn of(&self, robot: RobotId) -> RobotYielding {
        self.robots.get(robot).copied().unwrap_or_default()
    }

    /// The record of one robot, to note something in it.
    pub fn of_mut(&mut self, robot: RobotId) -> &mut RobotYielding {
        while self.robots.get(robot).is_none() {
            self.robots.push(RobotYielding::default());
        }
        &mut self.robots[robot]
    }

    /// Robots that give way to a worker, each with the worker, its reaction and since when.
    pub fn giving_way(&self) -> impl Iterator<Item = (RobotId, GivesWay)> {
        self.robots.pairs().filter_map(|(robot, y)| Some((robot, y.to?)))
    }

    /// Robots that pass a worker beside the line.
    pub fn passing(&self) -> impl Iterator<Item = (RobotId, RobotPassing)> {
        self.robots.pairs().filter_map(|(robot, y)| Some((robot, y.passing?)))
    }

    /// Robots that stand still to yield to a worker.
    pub fn standing(&self) -> impl Iterator<Item = RobotId> {
        self.robots.pairs().filter(|(_, y)| y.stands.is_some()).map(|(robot, _)| robot)
    }

    /// Notes how a robot answers the zone that it shares with a worker now, if it does.
    pub fn note_answer(&mut self, robot: RobotId, answer: Option<(WorkerId, ZoneAnswer)>, now: Time) {
        let zone = zone_answers::note(self.of(robot).zone, answer, now, &mut self.answered);
        self.of_mut(robot).zone = zone;
    }

    /// Notes that no worker is near any more, so that no robot gives way.
    pub fn no_worker_is_near(&mut self, now: Time) {
        for y in self.robots.iter_mut() {
            y.to = None;
            y.zone = zone_answers::note(y.zone, None, now, &mut self.answered);
        }
    }

    /// Forgets how these robots stood: they stand somewhere else by now.
    pub fn forget_standing(&mut self, robots: &[RobotId]) {
        robots.iter().for_each(|r| self.of_mut(*r).stands = None);
    }

    /// The worker to whom a robot has yielded for so long that it should leave: for long to this worker, or for twice
    /// as long to several workers in turn.
    pub fn stood_for(&self, robot: RobotId, now: Time) -> Option<WorkerId> {
        let standing = self.of(robot).stands?;
        debug_assert!(standing.since <= standing.facing_since, "{robot:?} stood for one before it stood");
        let long = now - standing.facing_since > STANDS || now - standing.since > STANDS * 2;
        long.then_some(standing.worker)
    }

    /// The worker to whom a robot has yielded for so long that each waits for the other.
    pub fn stuck_with(&self, robot: RobotId, now: Time) -> Option<WorkerId> {
        let noted = self.of(robot);
        let stands = noted.stands.filter(|s| now - s.since > STUCK).map(|s| s.worker);
        stands.or(noted.to.filter(|to| now - to.since > STUCK).map(|to| to.worker))
    }

    /// The worker to whom a robot has yielded for long, if this node is nearer to that worker than the robot is now:
    /// driving up again would help neither. Between workers who take turns, the robot has to go nearer to one of them.
    pub fn faces(&self, floor: Floor<'_>, robot: RobotId, node: NodeId, now: Time) -> Option<WorkerId> {
        let standing = self.of(robot).stands?;
        let lets_pass = floor.restrictions.let_pass.contains(&standing.worker);
        if now - standing.facing_since <= STANDS || lets_pass {
            return None;
        }
        let w = floor.restrictions.whereabouts(standing.worker)?.at;
        let (there, here) = (floor.warehouse().nodes[node].at, floor.place_of(robot));
        let near = (there - w).norm();
        (near < (here - w).norm() && near < FACES_M).then_some(standing.worker)
    }
}

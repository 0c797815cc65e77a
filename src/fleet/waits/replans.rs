//! Which robots got another route, and why: recorded after each step, and no input to any decision.
//!
//! Main type: [`Replans`]. It compares the route that a robot had for its task with the one that it has since. A better
//! route past other robots is not recorded, since that happens all the time. Costs nothing in steps in which no route
//! changes. Refuses: more than one record of a robot in five seconds for one cause.

use crate::state::fact::{Booking, Fact, RobotFact, RouteFact, Task};
use crate::state::floor::Floor;
use crate::state::note::{FloorNote, ReplanCause};
use crate::state::writer::Writer;
use crate::traffic::state::Traffic;
use crate::yielding::state::Yielding;
use giveway_floor::geometry::Spot;
use giveway_floor::id::{JobId, NodeId, RackId, RobotId};
use giveway_floor::route::Cause;
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// A replan of a robot for the same cause is recorded again after this long.
const AGAIN: Span = Span::from_secs(5);

/// How many nodes of a route are recorded.
const MOST_NODES: usize = 40;

/// What a robot is to do, wherever it ends: a new route for the same aim is a replan; for another task it is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct RouteAim {
    stage: u8,
    job: Option<JobId>,
    rack: Option<RackId>,
}

impl From<Task> for RouteAim {
    fn from(task: Task) -> RouteAim {
        let (stage, rack) = match task {
            Task::Idle => (0, None),
            Task::Fetch { rack, .. } => (1, Some(rack)),
            Task::Deliver { rack, .. } => (2, Some(rack)),
            Task::Store { rack, .. } => (3, Some(rack)),
            Task::Move { .. } => (4, None),
        };
        RouteAim { stage, job: task.job(), rack }
    }
}

/// The planned route of a robot.
#[derive(Clone, Debug)]
struct PlannedWay {
    aim: RouteAim,
    /// Serial number and node of each visit ahead.
    visits: Vec<(u64, NodeId)>,
}

impl PlannedWay {
    fn of(floor: Floor<'_>, robot: RobotId) -> PlannedWay {
        let chain = floor.ledger.chain(robot);
        let ahead = floor.reached(robot) + 1..chain.end();
        let visits = ahead.filter_map(|s| Some((s, chain.get(s)?.node))).collect();
        PlannedWay { aim: floor.ledger.robots[robot].task.into(), visits }
    }

    /// The nodes beyond a visit.
    fn beyond(&self, reached: u64) -> Vec<NodeId> {
        self.visits.iter().filter(|(serial, _)| *serial > reached).map(|(_, node)| *node).collect()
    }
}

/// What is remembered about the routes of robots. Lost at a restart.
#[derive(Clone, Debug, Default)]
pub struct Replans {
    ways: BTreeMap<RobotId, PlannedWay>,
    /// Robots that lost their route and have no other yet, each with the cause.
    lost: BTreeMap<RobotId, ReplanCause>,
    last: BTreeMap<RobotId, (ReplanCause, Time)>,
}

impl Replans {
    /// Why a robot was last replanned, and when.
    pub fn last(&self, robot: RobotId) -> Option<(ReplanCause, Time)> {
        self.last.get(&robot).copied()
    }

    /// Records the replans of a step at its end.
    pub fn note(&mut self, writer: &mut Writer, yielding: &Yielding, traffic: &Traffic, now: Time) {
        let mut notes = Vec::new();
        let facts = writer.facts();
        let broken = facts.iter().find_map(|fact| match fact {
            Fact::Robot(RobotFact::Failed { robot, .. } | RobotFact::Fenced { robot, .. })
            | Fact::Route(RouteFact::Placed { robot, .. }) => Some(*robot),
            _ => None,
        });
        let floor = writer.floor();
        for fact in facts {
            match fact {
                Fact::Route(RouteFact::Truncated { robots: cut } | RouteFact::Placed { cut, .. }) => {
                    let by = broken.map(ReplanCause::Robot);
                    let cut = cut.iter().map(|kept| kept.robot).filter(|r| Some(*r) != broken);
                    self.lost.extend(cut.filter_map(|robot| Some((robot, by?))));
                }
                Fact::Route(RouteFact::Revoked { robot, .. }) => {
                    let cause = yields_to(yielding, *robot).or_else(|| self.in_the_way(floor, *robot));
                    self.lost.extend(cause.map(|cause| (*robot, cause)));
                }
                Fact::Robot(RobotFact::Left { robot, .. }) => _ = self.ways.remove(robot),
                Fact::Route(RouteFact::Routed { bookings }) => {
                    let cause =
                        bookings.iter().find_map(|b| self.cause(floor, (yielding, traffic), b.robot, now));
                    for Booking { robot, .. } in bookings {
                        notes.extend(self.routed(floor, *robot, cause, now));
                    }
                }
                _ => {}
            }
        }
        notes.into_iter().for_each(|note| writer.record(Fact::Noted(note)));
    }

    /// Takes in a robot's new route. Returns what there is to record, if the robot had another route for the same aim.
    fn routed(
        &mut self,
        floor: Floor<'_>,
        robot: RobotId,
        cause: Option<ReplanCause>,
        now: Time,
    ) -> Option<FloorNote> {
        let (way, lost) = (PlannedWay::of(floor, robot), self.lost.remove(&robot));
        let nodes: Vec<NodeId> = way.visits.iter().map(|(_, node)| *node).collect();
        let aim = way.aim;
        let old = self.ways.insert(robot, way).filter(|old| old.aim == aim)?;
        let was = old.beyond(floor.reached(robot));
        let cause = cause.or(lost).filter(|_| !was.is_empty() && was != nodes)?;
        let last = self.last.get(&robot);
        if last.is_some_and(|(before, at)| *before == cause && now - *at < AGAIN) {
            return None;
        }
        self.last.insert(robot, (cause, now));
        let spots = |nodes: &[NodeId]| -> Vec<Spot> {
            nodes.iter().take(MOST_NODES).map(|n| floor.warehouse().nodes[*n].at.into()).collect()
        };
        Some(FloorNote::Replanned { robot, cause, was: spots(&was), now: spots(&nodes), at: now })
    }

    /// Why a robot was routed in this step, if not because of other robots.
    fn cause(
        &self,
        floor: Floor<'_>,
        (yielding, traffic): (&Yielding, &Traffic),
        robot: RobotId,
        now: Time,
    ) -> Option<ReplanCause> {
        if yielding.state.of(robot).rerouted == Some(now) || yielding.procedure.holds(robot) {
            return yields_to(yielding, robot);
        }
        if traffic.looked_round(robot) == Some(now) {
            return self.in_the_way(floor, robot);
        }
        self.lost.get(&robot).copied()
    }

    /// What closes the route that a robot had, if anything does.
    fn in_the_way(&self, floor: Floor<'_>, robot: RobotId) -> Option<ReplanCause> {
        let nodes = self.ways.get(&robot)?.beyond(floor.reached(robot));
        let conditions = floor.conditions(robot);
        let mut causes = nodes.iter().flat_map(|node| conditions.of(*node)).map(|condition| condition.cause);
        causes.find_map(|cause| match cause {
            Cause::Worker(worker) => Some(ReplanCause::Worker(worker)),
            Cause::Closure(closure) => Some(ReplanCause::Closure(closure)),
            Cause::Robot(other) => Some(ReplanCause::Robot(other)),
            Cause::Obstruction(_) => Some(ReplanCause::Obstruction),
            Cause::Evacuation => None,
        })
    }
}

fn yields_to(yielding: &Yielding, robot: RobotId) -> Option<ReplanCause> {
    yielding.state.of(robot).to.map(|to| ReplanCause::Worker(to.worker))
}

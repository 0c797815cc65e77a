//! What is kept in mind of each robot that gives way, from step to step. Lost at a restart, and found out again.
//!
//! Main types: [`YieldingState`], [`Yielding`] (one robot). Refuses: to decide; it says what was noted.

use crate::fleet::state::worker::Reaction;
use crate::id::{IdVec, NodeId, RobotId, WorkerId};
use crate::time::{Span, Time};

/// A robot that stands for a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fleet) struct Standing {
    /// For which one, the last of several.
    pub worker: WorkerId,
    /// Since when it stands.
    pub since: Time,
    /// Since when it does so for this one.
    pub facing_since: Time,
    /// Where it came to stand.
    pub node: NodeId,
}

/// A robot that stops or goes elsewhere because of a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fleet) struct GivesWay {
    pub worker: WorkerId,
    pub reaction: Reaction,
    pub since: Time,
}

/// What is kept in mind of one robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::fleet) struct Yielding {
    /// To whom it gives way, until it is on its way again.
    pub to: Option<GivesWay>,
    /// The speed limit that it was told last, and when.
    pub limit_told: Option<(Option<f64>, Time)>,
    /// For whom it stands, or comes back slowly.
    pub stands: Option<Standing>,
    /// When it was called back last while it stood for a worker.
    pub called_back: Option<Time>,
    /// When it last looked for another route because of a worker.
    pub rerouted: Option<Time>,
    /// When it last looked for a route round a closed area.
    pub looked_round: Option<Time>,
}

impl Yielding {
    /// The speed limit that it was told, if there is one.
    pub fn limit_mps(&self) -> Option<f64> {
        self.limit_told.and_then(|(limit, _)| limit)
    }

    /// Whether it was told to stand.
    pub fn is_told_to_stand(&self) -> bool {
        self.limit_mps() == Some(0.0)
    }

    /// For how long it has been giving way.
    pub fn waited(&self, now: Time) -> Span {
        self.to.map_or(Span::ZERO, |to| now - to.since)
    }
}

/// What is kept in mind of all robots.
#[derive(Debug, Default)]
pub(in crate::fleet) struct YieldingState(IdVec<RobotId, Yielding>);

impl YieldingState {
    /// Of one robot; nothing where nothing was noted.
    pub fn of(&self, robot: RobotId) -> Yielding {
        self.0.get(robot).copied().unwrap_or_default()
    }

    /// Of one robot, to note something.
    pub fn of_mut(&mut self, robot: RobotId) -> &mut Yielding {
        while self.0.get(robot).is_none() {
            self.0.push(Yielding::default());
        }
        &mut self.0[robot]
    }

    /// Robots that give way to a worker, each with which one and how.
    pub fn giving_way(&self) -> impl Iterator<Item = (RobotId, GivesWay)> {
        self.0.pairs().filter_map(|(robot, y)| Some((robot, y.to?)))
    }

    /// Robots that stand for a worker.
    pub fn standing(&self) -> impl Iterator<Item = RobotId> {
        self.0.pairs().filter(|(_, y)| y.stands.is_some()).map(|(robot, _)| robot)
    }

    /// No worker is near any more: no robot gives way.
    pub fn no_worker_is_near(&mut self) {
        self.0.iter_mut().for_each(|y| y.to = None);
    }

    /// Forgets calls that are older than this.
    pub fn forget_calls(&mut self, now: Time, after: Span) {
        self.0.iter_mut().for_each(|y| y.called_back = y.called_back.filter(|called| now - *called < after));
    }
}

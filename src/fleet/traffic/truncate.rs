//! What happens around a robot that stands where others were to drive: they lose their routes and get others.
//!
//! Refuses: to move anything; it takes promises back, and the planning phase makes new ones.

use crate::state::fact::{KeptRoute, RouteFact};
use crate::state::floor::Floor;
use crate::state::writer::Writer;
use giveway_floor::id::RobotId;
use std::collections::{BTreeSet, VecDeque};

/// Takes back what was promised, but not granted, to every robot that would have to pass one that stands still for an
/// unknown time, and to every robot that would have to pass these in turn. All of them keep what they were granted:
/// robots that may be broken are not asked to come back.
pub(crate) fn truncate_behind(writer: &mut Writer, broken: RobotId) {
    let found = writer.floor().all_behind(BTreeSet::from([broken]), None);
    let robots = writer.floor().kept_by(found);
    debug_assert!(robots.iter().any(|kept| kept.robot == broken), "{broken:?} keeps what it was granted");
    writer.record(RouteFact::Truncated { robots });
}

impl Floor<'_> {
    /// These robots, the robots that would have to pass them, and the robots behind those in turn; except for
    /// `without`, which holds nothing here from now on.
    pub(crate) fn all_behind(&self, first: BTreeSet<RobotId>, without: Option<RobotId>) -> BTreeSet<RobotId> {
        let broken = if without.is_none() { first.first().copied() } else { None };
        let mut queue: VecDeque<RobotId> = first.iter().copied().collect();
        let mut found = first;
        while let Some(robot) = queue.pop_front() {
            for other in self.behind(robot, Some(robot) == broken) {
                if Some(other) != without && found.insert(other) {
                    queue.push_back(other);
                }
            }
        }
        found
    }

    /// What robots keep when they lose all that was not granted to them.
    pub(super) fn kept_by(&self, robots: BTreeSet<RobotId>) -> Vec<KeptRoute> {
        let stuck = |r| (r, self.ledger.robots[r].failed);
        let holders: Vec<(RobotId, bool)> = robots.into_iter().map(stuck).collect();
        let kept = self.ledger.timeline().truncation(&holders);
        kept.into_iter().map(|(h, end, shifts)| KeptRoute { robot: h, end, shifts }).collect()
    }

    /// Robots that were promised something that `robot` will now keep: its last granted visit or, if it is broken and
    /// may stand anywhere along them, all its granted visits.
    fn behind(&self, robot: RobotId, broken: bool) -> Vec<RobotId> {
        let chain = self.ledger.chain(robot);
        let from =
            if broken || self.ledger.robots[robot].failed { chain.first() } else { chain.granted() - 1 };
        (from..chain.granted()).flat_map(|s| self.ledger.timeline().after(robot, s)).collect()
    }
}

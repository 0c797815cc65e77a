//! Which robots wait behind which party: for each robot and worker at the end of a chain, the robots that wait for it.
//!
//! Main type: [`Roots`]. Refuses: to find out why anything waits; the wait-for graph knows.

use crate::{ChainEnd, Edge, Fleet, Party};
use giveway_floor::id::RobotId;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms;
use std::collections::{BTreeMap, BTreeSet};

/// The ends of all chains of waiting.
#[derive(Debug, Default)]
pub(super) struct Roots {
    behind: BTreeMap<Party, Vec<RobotId>>,
    root: BTreeMap<RobotId, Party>,
}

impl Roots {
    /// Follows each robot's chain to its end. Of a cycle, the party with the least number stands for the whole cycle.
    pub fn of(fleet: &Fleet) -> Roots {
        let mut roots = Roots::default();
        for robot in fleet.ledger().present() {
            let start = Party::Robot(robot);
            let end = match fleet.wait(start).end {
                ChainEnd::Cycle(first) => first,
                _ => last(fleet, start),
            };
            roots.root.insert(robot, end);
            if end != start {
                roots.behind.entry(end).or_default().push(robot);
            }
        }
        roots
    }

    /// Robots that wait for a party, directly or behind others.
    pub fn behind(&self, party: Party) -> &[RobotId] {
        self.behind.get(&party).map_or(&[], Vec::as_slice)
    }

    /// The party for which a robot waits in the end; the robot itself if it waits for no other party.
    pub fn root(&self, robot: RobotId) -> Party {
        self.root.get(&robot).copied().unwrap_or(Party::Robot(robot))
    }
}

/// The last party of a chain.
fn last(fleet: &Fleet, start: Party) -> Party {
    let (mut at, mut seen) = (start, BTreeSet::from([start]));
    while let Edge::On(next) = fleet.wait(at).edge
        && seen.insert(next)
    {
        at = next;
    }
    at
}

/// How many robots wait for one thing, as the end of a sentence.
pub(super) fn robots_wait(waiting: usize) -> Option<Sentence> {
    match waiting {
        0 => None,
        1 => Some(alarms::one_robot_waits_for_it()),
        n => Some(alarms::robots_wait_for_it(n)),
    }
}

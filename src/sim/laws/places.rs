//! The law about where robots stand: the fleet places no robot where it is not, and calls none displaced that is not.
//!
//! Main type: [`PlaceLaws`]. Refuses: to judge robots that drive or cannot report, and reports that are still on their
//! way.

use super::violation::Violation;
use crate::world::World;
use giveway_fleet::Fleet;
use giveway_floor::id::RobotId;
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// The fleet knows where a standing robot is within this time while its link is up, whatever messages were lost.
const SEEN: Span = Span::from_secs(30);
/// Number of steps between two checks of the robots.
const LOOKS_EVERY: u64 = 10;

/// Robots about which the fleet is wrong, and since when.
#[derive(Debug, Default)]
pub(super) struct PlaceLaws {
    wrong: BTreeMap<RobotId, Time>,
    steps: u64,
}

impl PlaceLaws {
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        self.steps += 1;
        if !self.steps.is_multiple_of(LOOKS_EVERY) {
            return Vec::new();
        }
        let mut broken = Vec::new();
        for (robot, truth) in world.truth() {
            let believed = fleet.displacement(robot).is_none();
            if !world.is_connected(robot) || truth.speed_mps > 0.0 || believed == fleet.is_in_place(&truth) {
                self.wrong.remove(&robot);
                continue;
            }
            let since = *self.wrong.entry(robot).or_insert(now);
            if now - since > SEEN {
                self.wrong.insert(robot, now);
                broken.push(Violation::Misjudged(robot));
            }
        }
        broken
    }
}

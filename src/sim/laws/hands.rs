//! The law about hands in openings: no rack arrives or leaves while a hand is inside, and the fleet does not leave that
//! to the guards of stations.
//!
//! Main type: [`HandLaws`]. Refuses: to blame the fleet for a hand that no device has seen; that is what the guard is
//! for.

use super::violation::Violation;
use crate::world::World;
use giveway_fleet::Fleet;
use giveway_floor::id::{RobotId, StationId};
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// Within this time a robot learns that a hand is seen inside, whatever messages were lost.
const TOLD: Span = Span::from_secs(3);

/// Robots that moved, or were held, while a hand was inside.
#[derive(Debug, Default)]
pub(super) struct HandLaws {
    moved: usize,
    /// Robots that only a guard holds at a hand that the fleet sees, and since when.
    held: BTreeMap<RobotId, Time>,
}

impl HandLaws {
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        let all = world.moved_at_hands();
        let mut broken: Vec<Violation> =
            all[self.moved..].iter().map(|(r, s)| Violation::MovedAtHand(*r, *s)).collect();
        self.moved = all.len();
        let held: Vec<(RobotId, StationId)> =
            world.held_at_hands().filter(|(_, s)| fleet.sees_hand_inside(*s, now)).collect();
        self.held.retain(|robot, _| held.iter().any(|(r, _)| r == robot));
        for (robot, station) in held {
            let since = self.held.entry(robot).or_insert(now);
            if now - *since > TOLD {
                *since = now;
                broken.push(Violation::LeftToGuard(robot, station));
            }
        }
        broken
    }
}

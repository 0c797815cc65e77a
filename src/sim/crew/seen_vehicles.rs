//! How people on foot and drivers see one another.
//!
//! Main type: [`SeenVehicles`]. Whoever is on foot minds a vehicle as they mind a robot: they stop before it, step
//! aside, and do not walk in front of it. A driver minds people as they mind robots: the vehicle stops before them.
//! Refuses: to move anybody.

use super::member::Member;
use crate::walker::{BODY_M, PersonNear, RobotNear, parts};
use giveway_floor::time::Time;
use giveway_people::human::Mover;
use std::borrow::Cow;

/// The vehicles on the floor at one moment.
#[derive(Debug)]
pub(super) struct SeenVehicles {
    /// For each worker, whether they drive a vehicle.
    vehicles: Vec<bool>,
    /// The discs that cover each vehicle, with the number of its driver.
    parts: Vec<(usize, RobotNear)>,
}

impl SeenVehicles {
    /// The vehicles of these workers.
    pub fn of(members: &[Member], now: Time) -> SeenVehicles {
        let mut all = Vec::new();
        for (i, member) in members.iter().enumerate().filter(|(_, m)| m.mover != Mover::OnFoot) {
            let Some(walker) = member.walker.as_ref().filter(|w| !w.is_gone()) else { continue };
            let velocity = walker.velocity();
            let disc = |at| (i, RobotNear { at, velocity, half_m: BODY_M });
            all.extend(parts(&member.mover, walker.pose(now)).into_iter().map(disc));
        }
        SeenVehicles { vehicles: members.iter().map(|m| m.mover != Mover::OnFoot).collect(), parts: all }
    }

    /// Whether a worker drives a vehicle.
    pub fn is_vehicle(&self, worker: usize) -> bool {
        self.vehicles[worker]
    }

    /// The robots as a worker sees them: with the vehicles of others among them, and for a driver also people.
    pub fn among<'a, 'p>(
        &self,
        robots: &'a [RobotNear],
        worker: usize,
        others: impl Iterator<Item = &'p PersonNear>,
    ) -> Cow<'a, [RobotNear]> {
        if self.parts.is_empty() {
            return Cow::Borrowed(robots);
        }
        let vehicles = self.parts.iter().filter(|(driver, _)| *driver != worker).map(|(_, part)| *part);
        let on_foot = others.filter(|p| self.vehicles[worker] && !self.vehicles[p.who]);
        let people = on_foot.map(|p| RobotNear { at: p.at, velocity: p.velocity, half_m: BODY_M });
        Cow::Owned(robots.iter().copied().chain(vehicles).chain(people).collect())
    }
}

//! Robots that would only stand at the end of what they were granted until a worker has gone drive more slowly, to
//! arrive when the way is free.
//!
//! A slow robot brakes gently, and its separation distance is shorter, so it stops for fewer people. Main function:
//! `arrival_limit`. Refuses: to make any robot later, the robot itself or one that waits for what it leaves.

use crate::yielding::speed_limit::SpeedLimits;
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;
use giveway_people::aware::{HumanAwarePolicy, SLOW_MPS, leaves_after, quantised};
use giveway_people::human::Presence;

/// How long before the way is expected to be free robots arrive, seconds: people are sometimes faster.
const BEFORE_S: f64 = 1.0;
/// A robot this near to the end of what it was granted gets no such limit, metres.
const NEAR_M: f64 = 0.5;

impl SpeedLimits<'_> {
    /// The limit at which a robot arrives at the end of what it was granted just before the worker who keeps it there
    /// is expected to have left; metres per second, in steps of 0.25, and never below the speed of robots near people.
    /// Nothing if no worker keeps the robot, if the worker stays or is not seen, if another robot waits for this one,
    /// or if it has no more time than it needs.
    pub fn arrival_limit(&self, robot: RobotId, now: Time) -> Option<f64> {
        if self.floor.settings.policy != HumanAwarePolicy::Giveway || self.direction.is_some() {
            return None;
        }
        let (worker, way_m) = self.traffic.kept_by_a_worker(self.floor, robot)?;
        let place = self.people.whereabouts(worker, now).filter(|w| w.presence == Presence::Tracked)?;
        if way_m < NEAR_M {
            return None;
        }
        let chain = self.floor.ledger.chain(robot);
        let next = self.floor.warehouse().nodes[chain.get(chain.granted())?.node].at;
        let loaded = self.floor.ledger.rack_on(robot).is_some();
        let walk = self.walk_of(worker, &place, (robot, self.floor.place_of(robot)), now);
        let radius_m = self.floor.regions(robot).towards(&place).keep_out_radius_m(loaded, place.sigma_m);
        let free_s = leaves_after(&walk, next, radius_m)? - BEFORE_S;
        if free_s <= 0.0 {
            return None;
        }
        let limit = quantised(way_m / free_s).max(SLOW_MPS);
        (limit < self.floor.kinematics(robot).top_mps(loaded)).then_some(limit)
    }
}

//! How near a robot may come to a person, and how fast.
//!
//! Main type: [`Regions`]. The separation distance is that of ISO/TS 15066, 5.5.4: what the person walks while the
//! robot reacts and brakes, what the robot drives meanwhile, and the uncertainty of both positions. Region 1 is where a
//! slow robot must stand, region 2 where the slow speed would be too fast, region 3 where full speed would be. A person
//! is always taken to walk at 1.6 m/s (ISO 13855): predictions add caution and never take any away. For a worker in a
//! vehicle, [`Regions::towards`] takes the vehicle's size, and how far it can come from the speed at which it is seen.
//! Refuses: to be a safety function; robots' own scanners and brakes are.

use super::safe_space::StoppingTimes;
use crate::human::{BODY_M, Mover, Presence, WALK_MPS, Whereabouts};
use giveway_floor::route::Kinematics;

/// Room between a person on a path and a robot, metres.
const GAP_M: f64 = 0.1;
/// Uncertainty of a robot's position, metres.
const ROBOT_M: f64 = 0.1;
/// Speed of robots near people, metres per second.
pub const SLOW_MPS: f64 = 0.5;
/// Speed of robots that come towards people who are near, metres per second.
pub const CREEP_MPS: f64 = 0.25;
/// Within this distance of people, robots approach so slowly that twice the separation distance is left, metres.
pub const APPROACH_M: f64 = 3.0;

/// Radii and speeds for one kind of robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regions {
    kinematics: Kinematics,
    /// Half the robot's width, without and with a rack, metres.
    half_m: [f64; 2],
    /// Time from a pose being valid to the robot's brakes: age, control period, radio, controller; seconds.
    reaction_s: f64,
    /// What the worker moves as.
    mover: Mover,
    /// The speed at which the worker is taken to move now, metres per second.
    moves_mps: f64,
}

impl Regions {
    /// Regions for robots of this kind, `footprint_m` wide, in a fleet that decides every `period_s`.
    pub fn new(kinematics: Kinematics, footprint_m: f64, period_s: f64) -> Regions {
        Regions::for_outlines(kinematics, [footprint_m / 2.0; 2], period_s)
    }

    /// Regions for robots of this kind that extend this far from their middle, without and with a rack, metres.
    pub fn for_outlines(kinematics: Kinematics, half_m: [f64; 2], period_s: f64) -> Regions {
        let reaction_s = 0.1 + 2.0 * period_s + kinematics.reaction.as_secs_f64();
        Regions { kinematics, half_m, reaction_s, mover: Mover::OnFoot, moves_mps: WALK_MPS }
    }

    /// The regions around one worker, who may be in a vehicle.
    pub fn towards(&self, w: &Whereabouts) -> Regions {
        let moves_mps = match w.presence {
            Presence::Tracked => w.mover.moves_mps(w.velocity.norm(), w.sigma_m),
            _ => w.mover.assumed_mps(),
        };
        Regions { mover: w.mover, moves_mps, ..*self }
    }

    /// The regions around a worker of whom no more is known than what the worker moves as.
    pub fn for_mover(&self, mover: Mover) -> Regions {
        Regions { mover, moves_mps: mover.assumed_mps(), ..*self }
    }

    /// Reaction and braking time of a robot at speed `v`.
    pub fn times(&self, v: f64, loaded: bool) -> StoppingTimes {
        StoppingTimes { react_s: self.reaction_s, stop_s: v / self.kinematics.accel_mps2(loaded) }
    }

    /// Distance from decision to stand, metres.
    fn stop_m(&self, v: f64, loaded: bool) -> f64 {
        let times = self.times(v, loaded);
        times.reacting_m(v) + times.stopping_m(v)
    }

    /// Half of a worker and half of a robot, metres: the difference between distances of centres and separations.
    pub fn bodies_m(&self, loaded: bool) -> f64 {
        self.mover.body_m() + self.half_m[usize::from(loaded)]
    }

    /// Distance that a worker on a path and a robot beside it need between their centres, metres.
    pub fn beside_m(&self) -> f64 {
        self.bodies_m(true) + GAP_M
    }

    /// The separation distance at speed `v`, from surface to surface, metres. `sigma_m` is one standard deviation of
    /// the person's position.
    pub fn separation_m(&self, v: f64, loaded: bool, sigma_m: f64) -> f64 {
        self.comes_m(v, loaded) + self.stop_m(v, loaded) + 2.0 * sigma_m + ROBOT_M
    }

    /// How far the worker comes while a robot at speed `v` reacts and brakes, metres.
    fn comes_m(&self, v: f64, loaded: bool) -> f64 {
        let times = self.times(v, loaded);
        match self.mover {
            Mover::OnFoot => times.walked_m(),
            Mover::Vehicle(_) => self.mover.comes_m(self.moves_mps, times.react_s + times.stop_s),
        }
    }

    /// Radius of region 1, in which a robot stops: between the centres, metres, for robots at the slow speed required
    /// near people.
    pub fn stop_radius_m(&self, loaded: bool, sigma_m: f64) -> f64 {
        self.stop_radius_at_m(SLOW_MPS, loaded, sigma_m)
    }

    /// Radius of region 1 for a robot at speed `v`, metres: if it is faster than it should be, it must brake earlier.
    pub fn stop_radius_at_m(&self, v: f64, loaded: bool, sigma_m: f64) -> f64 {
        self.bodies_m(loaded) + self.stop_m(v.max(SLOW_MPS), loaded) + 2.0 * sigma_m
    }

    /// Radius of region 2, which no robot enters or leaves, metres.
    pub fn keep_out_radius_m(&self, loaded: bool, sigma_m: f64) -> f64 {
        self.bodies_m(loaded) + self.separation_m(SLOW_MPS, loaded, sigma_m)
    }

    /// Radius of region 3, in which robots are slower than they could be, metres.
    pub fn slow_radius_m(&self, loaded: bool, sigma_m: f64) -> f64 {
        self.bodies_m(loaded) + self.separation_m(self.kinematics.top_mps(loaded), loaded, sigma_m)
    }

    /// The speed at which the separation distance is just kept, never below [`SLOW_MPS`], metres per second. Nothing if
    /// any speed is slow enough.
    pub fn limit_mps(&self, distance_m: f64, loaded: bool, sigma_m: f64) -> Option<f64> {
        let (top, a) = (self.kinematics.top_mps(loaded), self.kinematics.accel_mps2(loaded));
        if self.mover != Mover::OnFoot {
            return self.limit_by_steps_mps(distance_m, loaded, sigma_m);
        }
        // v²/2a + v·(T + walk/a) + walk·T + doubt = distance
        let b = self.reaction_s + WALK_MPS / a;
        let left = distance_m - self.bodies_m(loaded) - WALK_MPS * self.reaction_s - 2.0 * sigma_m - ROBOT_M;
        let v = if left <= 0.0 { 0.0 } else { a * ((b * b + 2.0 * left / a).sqrt() - b) };
        (v < top).then(|| quantised(v).clamp(SLOW_MPS.min(top), top))
    }

    /// The limit near a vehicle, which may gather speed meanwhile: the greatest step of speed that keeps the distance.
    fn limit_by_steps_mps(&self, distance_m: f64, loaded: bool, sigma_m: f64) -> Option<f64> {
        let (top, apart_m) = (self.kinematics.top_mps(loaded), distance_m - self.bodies_m(loaded));
        let keeps = |v: f64| self.separation_m(v, loaded, sigma_m) <= apart_m;
        if keeps(top) {
            return None;
        }
        let mut v = quantised(top);
        while v > SLOW_MPS && !keeps(v) {
            v -= STEP_MPS;
        }
        Some(v.clamp(SLOW_MPS.min(top), top))
    }

    /// Greatest speed at which a robot may approach a person, metres per second: within three metres, twice the
    /// separation distance is left to a person who walks at `walks_mps`; a robot farther away must have slowed down to
    /// that when it gets there. Never below 0.25 m/s. Nothing if any speed is slow enough.
    pub fn approach_limit_mps(
        &self,
        distance_m: f64,
        walks_mps: f64,
        loaded: bool,
        sigma_m: f64,
    ) -> Option<f64> {
        let (top, a) = (self.kinematics.top_mps(loaded), self.kinematics.accel_mps2(loaded));
        // 2·(v²/2a + v·(T + walks/a) + walks·T + doubt) = distance
        let b = self.reaction_s + walks_mps / a;
        let doubt_m = 2.0 * sigma_m + ROBOT_M;
        // The distance counts from a person's middle; a vehicle is larger.
        let approach_m = APPROACH_M + self.mover.body_m() - BODY_M;
        let half_m = 0.5 * (distance_m.min(approach_m) - self.bodies_m(loaded));
        let left = half_m - walks_mps * self.reaction_s - doubt_m;
        let there = if left <= 0.0 { 0.0 } else { a * ((b * b + 2.0 * left / a).sqrt() - b) };
        let there = quantised(there).max(CREEP_MPS);
        // v·T + (v² - there²)/2a = distance left to drive until there
        let (t, until_m) = (self.reaction_s * a, (distance_m - approach_m).max(0.0));
        let v = ((t * t + there * there + 2.0 * a * until_m).sqrt() - t).max(there);
        (v < top).then(|| quantised(v))
    }

    /// [`Regions::limit_mps`] without and with a rack, infinite if there is no limit.
    pub fn limits_mps(&self, distance_m: f64, sigma_m: f64) -> [f64; 2] {
        [false, true].map(|l| self.limit_mps(distance_m, l, sigma_m).unwrap_or(f64::INFINITY))
    }
}

/// Steps of speed limits, metres per second.
const STEP_MPS: f64 = 0.25;

/// A limit in steps of 0.25 m/s, so that it does not change with every centimetre.
pub fn quantised(v: f64) -> f64 {
    (v / STEP_MPS).floor() * STEP_MPS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::mover_tests::forklift;
    use giveway_floor::geometry::{Point, Vector};

    fn regions(accel: f64) -> Regions {
        let k = Kinematics {
            accel_unloaded_mps2: accel,
            accel_loaded_mps2: accel,
            reaction: giveway_floor::time::Span::from_millis(100),
            ..Kinematics::default()
        };
        Regions::new(k, 0.9, 0.1)
    }

    #[test]
    fn separation_distances_are_those_of_the_published_table() {
        // T = 0.4 s; the table has 0.15 m of uncertainty, of which 0.1 m are the robot's.
        let sigma = 0.025;
        for (v, a, d) in
            [(0.3, 0.5, 1.96), (0.5, 1.0, 1.92), (1.0, 0.5, 5.39), (1.5, 1.0, 4.92), (2.0, 2.0, 4.19)]
        {
            let found = regions(a).separation_m(v, false, sigma);
            assert!((found - d).abs() < 0.006, "{v} m/s, {a} m/s²: {found}, not {d}");
        }
    }

    #[test]
    fn regions_lie_within_one_another() {
        for loaded in [false, true] {
            let r = Regions::new(Kinematics::default(), 0.9, 0.1);
            let (one, two, three) = (
                r.stop_radius_m(loaded, 0.02),
                r.keep_out_radius_m(loaded, 0.02),
                r.slow_radius_m(loaded, 0.02),
            );
            assert!(one < two && two < three, "{one} {two} {three}");
        }
    }

    #[test]
    fn the_limit_keeps_the_separation_distance() {
        let r = regions(0.5);
        for d in [3.0, 4.0, 5.0, 6.0, 8.0] {
            let v = r.limit_mps(d, true, 0.02).unwrap();
            let apart = d - r.bodies_m(true);
            assert!(v == SLOW_MPS || r.separation_m(v, true, 0.02) <= apart, "{v} at {d}");
        }
        assert_eq!(r.limit_mps(20.0, true, 0.02), None);
    }

    #[test]
    fn who_comes_towards_a_person_leaves_twice_the_separation_within_three_metres_and_brakes_before() {
        let r = Regions::new(Kinematics::default(), 0.9, 0.1);
        for (loaded, walks) in [(false, 0.2), (true, 0.2), (false, 1.4), (true, 1.4)] {
            for d in [1.0, 1.5, 2.0, 2.5, 3.0] {
                let v = r.approach_limit_mps(d, walks, loaded, 0.02).expect("no robot is that slow");
                let times = r.times(v, loaded);
                let separation_m =
                    walks * (times.react_s + times.stop_s) + r.stop_m(v, loaded) + 0.04 + ROBOT_M;
                let left_m = d - r.bodies_m(loaded);
                assert!(v == CREEP_MPS || 2.0 * separation_m <= left_m, "{v} m/s at {d} m, {walks} m/s");
            }
            // Braking from the limit farther away ends in the limit there.
            let there = r.approach_limit_mps(3.0, walks, loaded, 0.02).expect("a limit");
            for d in [3.5, 4.0, 5.0] {
                let Some(v) = r.approach_limit_mps(d, walks, loaded, 0.02) else { continue };
                let a = r.kinematics.accel_mps2(loaded);
                let braking_m = r.reaction_s * v + (v * v - there * there) / (2.0 * a);
                assert!(
                    v >= there && braking_m <= d - 3.0 + 0.3,
                    "{v} m/s at {d} m brakes to {there} in {braking_m} m"
                );
            }
        }
        assert_eq!(r.approach_limit_mps(12.0, 1.4, false, 0.02), None);
        // The figures of docs/people.md: a person who stands, and one who walks at 1.2 m/s.
        let at_3_m = |walks, loaded| r.approach_limit_mps(3.0, walks, loaded, 0.02);
        assert_eq!(
            [at_3_m(0.2, false), at_3_m(0.2, true), at_3_m(1.4, false)],
            [Some(0.75), Some(0.5), Some(0.25)]
        );
    }

    fn seen(mover: Mover, mps: f64, presence: Presence) -> Whereabouts {
        let (at, velocity) = (Point::origin(), Vector::new(mps, 0.0));
        Whereabouts { at, sigma_m: 0.1, reach_m: 0.0, velocity, heading: None, presence, mover }
    }

    #[test]
    fn around_a_person_regions_do_not_depend_on_the_speed_at_which_the_person_is_seen() {
        let r = Regions::new(Kinematics::default(), 0.9, 0.1);
        for mps in [0.0, 1.5] {
            let near = r.towards(&seen(Mover::OnFoot, mps, Presence::Tracked));
            for (v, d) in [(0.5, 2.0), (1.5, 4.0), (1.0, 9.0)] {
                assert_eq!(near.separation_m(v, true, 0.1), r.separation_m(v, true, 0.1));
                assert_eq!(near.limit_mps(d, true, 0.1), r.limit_mps(d, true, 0.1));
            }
        }
    }

    #[test]
    fn regions_around_a_vehicle_grow_with_its_size_and_with_the_speed_that_it_has_or_may_have() {
        let r = Regions::new(Kinematics::default(), 0.9, 0.1);
        let keep_out =
            |mps, presence| r.towards(&seen(forklift(), mps, presence)).keep_out_radius_m(true, 0.1);
        let [stands, drives, fast] = [0.0, 2.0, 4.0].map(|mps| keep_out(mps, Presence::Tracked));
        assert!(stands < drives && drives < fast, "{stands} {drives} {fast}");
        assert_eq!(
            keep_out(0.0, Presence::Stale),
            keep_out(9.0, Presence::Tracked),
            "nobody knows how fast it is"
        );
        let one = r.for_mover(forklift()).stop_radius_m(false, 0.1) - r.stop_radius_m(false, 0.1);
        assert!((one - (forklift().body_m() - BODY_M)).abs() < 1e-9, "region 1 grows by the vehicle's size");
    }

    #[test]
    fn the_limit_near_a_vehicle_keeps_the_separation_distance_too() {
        let r = regions(0.5).towards(&seen(forklift(), 2.0, Presence::Tracked));
        let mut found = Vec::new();
        for d in [3.0, 6.0, 9.0, 12.0, 15.0, 18.0] {
            let Some(v) = r.limit_mps(d, true, 0.1) else { continue };
            let apart = d - r.bodies_m(true);
            assert!(v == SLOW_MPS || r.separation_m(v, true, 0.1) <= apart, "{v} at {d}");
            found.push(v);
        }
        assert!(found.is_sorted() && found.last() > found.first(), "{found:?}");
        assert_eq!(r.limit_mps(40.0, true, 0.1), None);
    }

    #[test]
    fn a_worse_pose_widens_every_region() {
        let r = Regions::new(Kinematics::default(), 0.9, 0.1);
        assert!(r.stop_radius_m(false, 0.3) > r.stop_radius_m(false, 0.02) + 0.5);
        assert!(r.slow_radius_m(false, 0.3) > r.slow_radius_m(false, 0.02) + 0.5);
    }
}

//! What a worker moves as: on foot, or in a vehicle with a driver.
//!
//! Main types: [`Mover`], [`Vehicle`]. All that robots assume of a worker's size and pace comes from here, so that a
//! forklift and a person on foot are followed, predicted and given way to by the same code. A person is a disc who
//! walks at 1.6 m/s at any moment (ISO 13855); a vehicle is the disc around the point that its tag measures in which it
//! can turn, and gathers speed no faster than it can accelerate. Refuses: vehicles faster than 4 m/s, and to know where
//! anything is.

use super::passage::Band;
use giveway_floor::geometry::{Point, Pose, to_mm};
use giveway_floor::time::Span;
use nalgebra::Rotation2;
use std::ops::RangeInclusive;

/// Radius of a standing person, metres.
pub const BODY_M: f64 = 0.25;
/// Half of what a person needs to get past something sideways, metres.
const SQUEEZES_M: f64 = 0.2;
/// Walking speed assumed of everybody who might walk, metres per second (ISO 13855).
pub const WALK_MPS: f64 = 1.6;
/// Greatest running speed in a warehouse, metres per second.
const RUN_MPS: f64 = 3.0;
/// How fast workers walk to their tasks, metres per second.
const USUAL_MPS: f64 = 1.2;
/// How fast people walk once they set off, metres per second.
const GAIT_MPS: f64 = 1.3;
/// Greatest speed of a person whose speed was measured, metres per second.
const FASTEST_MPS: f64 = 2.2;

/// How long an unseen person is taken to walk straight away, at walking speed. After that the person is taken to turn
/// at random after each such stretch, so that the distance grows with the square root of time.
const STRAIGHT: Span = Span::from_secs(3);
/// How long an unseen worker is taken to move at the assumed speed at most: 8 m on foot. The wearer is told to stand
/// while the place is not known; robots' own scanners see a wearer who has walked farther, as they see everybody
/// without a headset.
const UNSEEN_S: f64 = 5.0;

/// Share of its top speed at which a vehicle usually drives to its tasks.
const USUAL_SHARE: f64 = 0.6;
/// A vehicle that is faster than its stated top speed by this factor is not the vehicle.
const MEASURED: f64 = 1.2;
/// How far the measured speed of a vehicle may be wrong, metres per second.
const MEASURED_MPS: f64 = 0.2;
/// Room between a vehicle and obstacles on either side of its way, metres.
const SIDE_M: f64 = 0.1;
/// How long a driver takes to begin to brake, seconds.
const DRIVER_S: f64 = 1.0;

/// What a vehicle may be, in the units of its figures.
const LENGTH_M: RangeInclusive<f64> = 0.5..=8.0;
const WIDTH_M: RangeInclusive<f64> = 0.4..=3.0;
const SPEED_MPS: RangeInclusive<f64> = 0.3..=4.0;
const ACCEL_MPS2: RangeInclusive<f64> = 0.1..=3.0;
const BRAKE_MPS2: RangeInclusive<f64> = 0.3..=6.0;

/// What a worker moves as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Mover {
    /// On foot.
    #[default]
    OnFoot,
    /// In a vehicle that the worker drives.
    Vehicle(Vehicle),
}

/// A vehicle with a driver, such as a forklift: what it takes of the floor and how fast it may be. Whole millimetres,
/// so that it is written down as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Vehicle {
    length_mm: i64,
    width_mm: i64,
    behind_mm: i64,
    top_mmps: i64,
    accel_mmps2: i64,
    brake_mmps2: i64,
}

/// The figures of a vehicle as people state them: metres and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleFigures {
    /// Length with forks and load, metres.
    pub length_m: f64,
    /// Width with load, metres.
    pub width_m: f64,
    /// Distance from the tag to the rear end, metres.
    pub behind_m: f64,
    /// Top speed, metres per second.
    pub speed_mps: f64,
    /// Greatest acceleration, metres per second squared.
    pub accel_mps2: f64,
    /// Least deceleration when the driver brakes, metres per second squared.
    pub brake_mps2: f64,
}

/// A figure that no vehicle has.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleFault {
    /// The key of the figure.
    pub key: &'static str,
    /// The stated figure.
    pub found: f64,
    /// The least figure that is accepted.
    pub least: f64,
    /// The greatest figure that is accepted.
    pub most: f64,
}

impl VehicleFigures {
    /// A vehicle of this size of which no more is known: as fast as any, with the tag in its middle. Acceleration and
    /// braking are those of a counterbalance truck.
    pub fn of_size(length_m: f64, width_m: f64) -> VehicleFigures {
        let behind_m = length_m / 2.0;
        VehicleFigures { length_m, width_m, behind_m, speed_mps: 4.0, accel_mps2: 1.0, brake_mps2: 2.0 }
    }
}

impl Vehicle {
    /// A vehicle with these figures.
    ///
    /// # Errors
    /// All figures that no vehicle has.
    pub fn new(figures: VehicleFigures) -> Result<Vehicle, Vec<VehicleFault>> {
        let VehicleFigures { length_m, width_m, behind_m, speed_mps, accel_mps2, brake_mps2 } = figures;
        let all = [
            ("length_m", length_m, LENGTH_M),
            ("width_m", width_m, WIDTH_M),
            ("behind_m", behind_m, 0.0..=length_m.max(0.0)),
            ("speed_mps", speed_mps, SPEED_MPS),
            ("accel_mps2", accel_mps2, ACCEL_MPS2),
            ("brake_mps2", brake_mps2, BRAKE_MPS2),
        ];
        let wrong = all.into_iter().filter(|(_, found, range)| !range.contains(found));
        let fault = |(key, found, range): (&'static str, f64, RangeInclusive<f64>)| VehicleFault {
            key,
            found,
            least: *range.start(),
            most: *range.end(),
        };
        let faults: Vec<VehicleFault> = wrong.map(fault).collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Vehicle {
            length_mm: to_mm(length_m),
            width_mm: to_mm(width_m),
            behind_mm: to_mm(behind_m),
            top_mmps: to_mm(speed_mps),
            accel_mmps2: to_mm(accel_mps2),
            brake_mmps2: to_mm(brake_mps2),
        })
    }

    /// The figures of the vehicle.
    pub fn figures(&self) -> VehicleFigures {
        VehicleFigures {
            length_m: metres(self.length_mm),
            width_m: metres(self.width_mm),
            behind_m: metres(self.behind_mm),
            speed_mps: metres(self.top_mmps),
            accel_mps2: metres(self.accel_mmps2),
            brake_mps2: metres(self.brake_mmps2),
        }
    }

    /// Length, width, distance from the tag to the rear, top speed, acceleration and braking, in whole millimetres.
    pub fn whole_mm(&self) -> [i64; 6] {
        [self.length_mm, self.width_mm, self.behind_mm, self.top_mmps, self.accel_mmps2, self.brake_mmps2]
    }

    /// The vehicle with these figures, in the order of [`Vehicle::whole_mm`]; nothing if no vehicle has them.
    pub fn of_whole_mm(figures: [i64; 6]) -> Option<Vehicle> {
        let [length_m, width_m, behind_m, speed_mps, accel_mps2, brake_mps2] = figures.map(metres);
        Vehicle::new(VehicleFigures { length_m, width_m, behind_m, speed_mps, accel_mps2, brake_mps2 }).ok()
    }

    /// Distance from the tag to the front end, metres.
    pub fn ahead_m(&self) -> f64 {
        metres(self.length_mm - self.behind_mm)
    }

    /// The corners of the vehicle if its tag is at a pose, anticlockwise from behind on the right.
    pub fn outline(&self, pose: Pose) -> [Point; 4] {
        let (turn, half_m) = (Rotation2::new(pose.heading), metres(self.width_mm) / 2.0);
        let (behind_m, ahead_m) = (-metres(self.behind_mm), self.ahead_m());
        [(behind_m, -half_m), (ahead_m, -half_m), (ahead_m, half_m), (behind_m, half_m)]
            .map(|(x, y)| pose.at + (turn * Point::new(x, y)).coords)
    }

    /// Radius of the disc around the tag in which the vehicle turns, metres.
    fn turning_m(&self) -> f64 {
        metres(self.behind_mm).max(self.ahead_m()).hypot(metres(self.width_mm) / 2.0)
    }

    /// How far the vehicle comes within `seconds` if it gathers speed from `from_mps` on, metres.
    fn comes_m(&self, from_mps: f64, seconds: f64) -> f64 {
        let VehicleFigures { speed_mps: top, accel_mps2: accel, .. } = self.figures();
        let from = from_mps.min(top);
        let gathers_s = ((top - from) / accel).min(seconds);
        from * gathers_s + accel * gathers_s * gathers_s / 2.0 + top * (seconds - gathers_s)
    }
}

impl Mover {
    /// Radius of the disc that holds the worker, whichever way they are turned, metres.
    pub fn body_m(&self) -> f64 {
        match self {
            Mover::OnFoot => BODY_M,
            Mover::Vehicle(v) => v.turning_m(),
        }
    }

    /// Half of what the worker takes to either side of the way, metres.
    pub fn half_width_m(&self) -> f64 {
        match self {
            Mover::OnFoot => BODY_M,
            Mover::Vehicle(v) => metres(v.width_mm) / 2.0,
        }
    }

    /// Half of what the worker needs to get past a robot that stands, metres: a person turns sideways.
    pub fn squeezes_m(&self) -> f64 {
        match self {
            Mover::OnFoot => SQUEEZES_M,
            Mover::Vehicle(_) => self.half_width_m(),
        }
    }

    /// Distance from obstacles that ways for the worker keep, metres; people go wherever there is floor.
    pub fn clearance_m(&self) -> f64 {
        match self {
            Mover::OnFoot => 0.0,
            Mover::Vehicle(_) => self.half_width_m() + SIDE_M,
        }
    }

    /// The speed assumed of a worker whose speed is not known, metres per second.
    pub fn assumed_mps(&self) -> f64 {
        self.speed(WALK_MPS, 1.0)
    }

    /// How fast the worker usually goes to a task, metres per second.
    pub fn usual_mps(&self) -> f64 {
        self.speed(USUAL_MPS, USUAL_SHARE)
    }

    /// How fast the worker goes once they set off, metres per second.
    pub fn sets_off_mps(&self) -> f64 {
        self.speed(GAIT_MPS, USUAL_SHARE)
    }

    /// Greatest speed of a worker whose speed was measured, metres per second.
    pub fn fastest_mps(&self) -> f64 {
        self.speed(FASTEST_MPS, 1.0)
    }

    /// Speed beyond which a sighting cannot be true, metres per second.
    pub fn possible_mps(&self) -> f64 {
        self.speed(RUN_MPS, MEASURED)
    }

    /// A speed on foot, or a share of a vehicle's top speed, metres per second.
    fn speed(&self, on_foot_mps: f64, share: f64) -> f64 {
        match self {
            Mover::OnFoot => on_foot_mps,
            Mover::Vehicle(v) => metres(v.top_mmps) * share,
        }
    }

    /// How far the worker may come within `seconds`, metres, if they were seen to move at `seen_mps`. A person may walk
    /// at any moment, whatever was seen.
    pub fn comes_m(&self, seen_mps: f64, seconds: f64) -> f64 {
        match self {
            Mover::OnFoot => WALK_MPS * seconds,
            Mover::Vehicle(v) => v.comes_m(seen_mps, seconds),
        }
    }

    /// How fast the worker may move now who was seen to move at `seen_mps`, metres per second. That speed is a mean
    /// over the last moments, during which a vehicle may have gathered more.
    pub fn moves_mps(&self, seen_mps: f64, sigma_m: f64) -> f64 {
        match self {
            Mover::OnFoot => WALK_MPS,
            Mover::Vehicle(v) => {
                let gained = metres(v.accel_mmps2) * measured_over_s(sigma_m) / 2.0;
                (seen_mps + MEASURED_MPS + gained).min(metres(v.top_mmps))
            }
        }
    }

    /// How far a worker may have come who has been unseen for this long, and moved at `seen_mps` before, metres.
    pub fn unseen_m(&self, seen_mps: f64, silent: Span) -> f64 {
        let (t, straight) = (silent.as_secs_f64(), STRAIGHT.as_secs_f64());
        let assumed_mps = self.assumed_mps();
        let straight_m = self.comes_m(seen_mps, t.min(straight));
        match silent {
            s if s <= STRAIGHT => straight_m,
            _ => (assumed_mps * (straight * t).sqrt()).min(assumed_mps * UNSEEN_S),
        }
    }

    /// The range of speeds of a worker who was seen to move at this speed, metres per second.
    pub fn band(&self, seen_mps: f64) -> Band {
        match self {
            Mover::OnFoot => Band::around(seen_mps),
            Mover::Vehicle(v) => {
                let top = metres(v.top_mmps);
                let slow = (0.6 * seen_mps).clamp(0.15 * top, 0.5 * top);
                let fast = (1.25 * seen_mps + metres(v.accel_mmps2)).clamp(0.4 * top, top);
                Band { slow_mps: slow, fast_mps: fast }
            }
        }
    }

    /// The range of speeds of a worker whose speed is not known, metres per second.
    pub fn any_band(&self) -> Band {
        match self {
            Mover::OnFoot => Band::ANY,
            Mover::Vehicle(_) => Band { fast_mps: self.assumed_mps(), ..self.band(0.0) },
        }
    }

    /// How far the worker goes on after they are told to stand, metres; nothing on foot.
    pub fn stops_m(&self, seen_mps: f64) -> f64 {
        match self {
            Mover::OnFoot => 0.0,
            Mover::Vehicle(v) => seen_mps * DRIVER_S + seen_mps * seen_mps / (2.0 * metres(v.brake_mmps2)),
        }
    }

    /// A distance that is far enough for a person on foot, as it is for this mover: larger and faster ones matter from
    /// farther away.
    pub fn far_m(&self, on_foot_m: f64) -> f64 {
        on_foot_m * self.pace() + self.body_m() - BODY_M
    }

    /// How many times as fast as a person the worker may be; never less than 1.
    pub fn pace(&self) -> f64 {
        (self.assumed_mps() / WALK_MPS).max(1.0)
    }
}

/// Over how many seconds the velocity of a worker is measured: the less exact the source, the longer.
pub(super) fn measured_over_s(accuracy_m: f64) -> f64 {
    (0.4 + 4.0 * accuracy_m).clamp(0.4, 1.5)
}

fn metres(mm: i64) -> f64 {
    mm as f64 / 1000.0
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    fn truck() -> Vehicle {
        let figures = VehicleFigures { behind_m: 1.6, ..VehicleFigures::of_size(3.0, 1.2) };
        Vehicle::new(figures).expect("it is a vehicle")
    }

    /// A counterbalance forklift with a pallet on its forks, and the tag over its mast.
    pub fn forklift() -> Mover {
        Mover::Vehicle(truck())
    }

    fn near(found: f64, wanted: f64) {
        assert!((found - wanted).abs() < 1e-9, "{found}, not {wanted}");
    }

    #[test]
    fn all_figures_that_no_vehicle_has_are_named_at_once() {
        let figures =
            VehicleFigures { behind_m: 9.0, speed_mps: 5.0, ..VehicleFigures::of_size(0.1, f64::NAN) };
        let faults = Vehicle::new(figures).expect_err("no vehicle is like that");
        let keys: Vec<&str> = faults.iter().map(|f| f.key).collect();
        assert_eq!(keys, ["length_m", "width_m", "behind_m", "speed_mps"]);
        assert_eq!((faults[3].least, faults[3].most), (0.3, 4.0));
    }

    #[test]
    fn a_person_comes_and_is_sought_as_far_as_ever() {
        let mover = Mover::OnFoot;
        near(mover.comes_m(0.0, 2.5), 4.0);
        near(mover.unseen_m(9.0, Span::from_secs(2)), 3.2);
        near(mover.unseen_m(0.0, Span::from_secs(6)), 1.6 * 18f64.sqrt());
        near(mover.unseen_m(0.0, Span::from_secs(60)), 8.0);
        near(mover.far_m(12.0), 12.0);
        assert_eq!(mover.band(1.0), Band::around(1.0));
    }

    #[test]
    fn a_vehicle_gathers_speed_no_faster_than_it_can_and_is_never_faster_than_it_goes() {
        let mover = forklift();
        near(mover.comes_m(0.0, 1.0), 0.5);
        near(mover.comes_m(0.0, 6.0), 8.0 + 8.0);
        near(mover.comes_m(4.0, 2.0), 8.0);
        near(mover.comes_m(7.0, 2.0), 8.0);
        near(mover.unseen_m(4.0, Span::from_secs(2)), 8.0);
        near(mover.unseen_m(0.0, Span::from_secs(600)), 20.0);
        assert!(mover.unseen_m(4.0, Span::from_secs(3)) <= mover.unseen_m(0.0, Span::from_millis(3001)));
    }

    #[test]
    fn the_outline_lies_about_the_tag_and_within_the_turning_disc() {
        let pose = Pose { at: Point::new(5.0, 2.0), heading: std::f64::consts::FRAC_PI_2 };
        let corners = truck().outline(pose);
        let expected = [(5.6, 0.4), (5.6, 3.4), (4.4, 3.4), (4.4, 0.4)];
        for (corner, (x, y)) in corners.iter().zip(expected) {
            assert!((corner - Point::new(x, y)).norm() < 1e-9, "{corners:?}");
        }
        let farthest = corners.iter().map(|c| (c - pose.at).norm()).fold(0.0, f64::max);
        near(forklift().body_m(), farthest);
    }
}

//! Vehicles with a driver as they travel.
//!
//! Main types: [`VehicleDto`], [`NewVehicle`]. Refuses: figures that no vehicle has, all at once.

use crate::wire::error::FieldError;
use giveway_floor::text::SentenceArg;
use giveway_floor::text::sentence::requests;
use giveway_people::human::{Mover, Vehicle, VehicleFault, VehicleFigures};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The vehicle that a worker drives, such as a forklift: what it takes of the floor, and how fast it may be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct VehicleDto {
    /// Length with forks and load, metres.
    #[schema(example = 2.4)]
    pub length_m: f64,
    /// Width with load, metres.
    #[schema(example = 1.0)]
    pub width_m: f64,
    /// Distance from the tag to the rear end, metres.
    #[schema(example = 1.0)]
    pub behind_m: f64,
    /// Top speed, metres per second.
    #[schema(example = 3.0)]
    pub speed_mps: f64,
    /// Greatest acceleration, metres per second squared.
    #[schema(example = 1.0)]
    pub accel_mps2: f64,
    /// Least deceleration when the driver brakes, metres per second squared.
    #[schema(example = 2.0)]
    pub brake_mps2: f64,
}

/// A vehicle that a worker drives. Figures that are left out are the most cautious ones: the tag in the middle, 4 m/s.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewVehicle {
    /// Length with forks and load, metres, 0.5 to 8.
    #[schema(example = 2.4)]
    length_m: f64,
    /// Width with load, metres, 0.4 to 3.
    #[schema(example = 1.0)]
    width_m: f64,
    /// Distance from the tag to the rear end, metres; half of the length if absent.
    #[schema(example = 1.0)]
    behind_m: Option<f64>,
    /// Top speed, metres per second, 0.3 to 4; 4 if absent.
    #[schema(example = 3.0)]
    speed_mps: Option<f64>,
    /// Greatest acceleration, metres per second squared, 0.1 to 3; 1 if absent.
    #[schema(example = 1.0)]
    accel_mps2: Option<f64>,
    /// Least deceleration when the driver brakes, metres per second squared, 0.3 to 6; 2 if absent.
    #[schema(example = 2.0)]
    brake_mps2: Option<f64>,
}

impl VehicleDto {
    /// The vehicle of a worker; nothing on foot.
    pub fn of(mover: &Mover) -> Option<VehicleDto> {
        let Mover::Vehicle(vehicle) = mover else { return None };
        let VehicleFigures { length_m, width_m, behind_m, speed_mps, accel_mps2, brake_mps2 } =
            vehicle.figures();
        Some(VehicleDto { length_m, width_m, behind_m, speed_mps, accel_mps2, brake_mps2 })
    }
}

impl NewVehicle {
    /// The worker in this vehicle.
    ///
    /// # Errors
    /// Each figure that no vehicle has, by the path of its field.
    pub fn mover(&self) -> Result<Mover, Vec<FieldError>> {
        let usual = VehicleFigures::of_size(self.length_m, self.width_m);
        let figures = VehicleFigures {
            behind_m: self.behind_m.unwrap_or(usual.behind_m),
            speed_mps: self.speed_mps.unwrap_or(usual.speed_mps),
            accel_mps2: self.accel_mps2.unwrap_or(usual.accel_mps2),
            brake_mps2: self.brake_mps2.unwrap_or(usual.brake_mps2),
            ..usual
        };
        let wrong = |fault: VehicleFault| {
            let number = |n: f64| SentenceArg::rounded(n, 3);
            let sentence =
                requests::not_between(number(fault.found), number(fault.least), number(fault.most));
            FieldError::new(format!("vehicle.{}", fault.key), sentence)
        };
        let vehicle = Vehicle::new(figures);
        vehicle.map(Mover::Vehicle).map_err(|faults| faults.into_iter().map(wrong).collect())
    }
}

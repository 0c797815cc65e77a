//! The part of a scenario about vehicles with a driver.
//!
//! Main type: [`DrivenVehicle`]. Refuses: figures that no vehicle has, all at once.

use super::sensors::SecondTag;
use giveway_people::human::{Vehicle, VehicleFault, VehicleFigures};
use giveway_site::SiteError;
use serde::Deserialize;

/// One vehicle with a driver, who follows assignments as workers on foot do.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivenVehicle {
    /// Length with forks and load, metres.
    pub length_m: f64,
    /// Width with load, metres.
    pub width_m: f64,
    /// Distance from the tag to the rear end, metres; absent for half the length.
    pub behind_m: Option<f64>,
    /// Top speed, metres per second; absent for 4.
    pub speed_mps: Option<f64>,
    /// Greatest acceleration, metres per second squared; absent for 1.
    pub accel_mps2: Option<f64>,
    /// Deceleration when the driver brakes, metres per second squared; absent for 2.
    pub brake_mps2: Option<f64>,
    /// The tag on the vehicle.
    #[serde(default)]
    pub tag: SecondTag,
}

impl DrivenVehicle {
    /// The vehicle, if there can be one with these figures.
    fn made(&self) -> Result<Vehicle, Vec<VehicleFault>> {
        let usual = VehicleFigures::of_size(self.length_m, self.width_m);
        Vehicle::new(VehicleFigures {
            behind_m: self.behind_m.unwrap_or(usual.behind_m),
            speed_mps: self.speed_mps.unwrap_or(usual.speed_mps),
            accel_mps2: self.accel_mps2.unwrap_or(usual.accel_mps2),
            brake_mps2: self.brake_mps2.unwrap_or(usual.brake_mps2),
            ..usual
        })
    }

    /// The vehicle of a scenario that was checked.
    pub(crate) fn vehicle(&self) -> Vehicle {
        self.made().expect("a scenario is checked when it is read")
    }

    /// Refuses figures that no vehicle has.
    pub(super) fn check(&self) -> Result<(), SiteError> {
        self.tag.check("workers.vehicles.tag")?;
        let Err(faults) = self.made() else { return Ok(()) };
        let say = |f: &VehicleFault| {
            format!("{} is {}, but must be from {} to {}", f.key, f.found, f.least, f.most)
        };
        let message = faults.iter().map(say).collect::<Vec<_>>().join("; ");
        Err(SiteError::Wrong { key: "workers.vehicles", message })
    }
}

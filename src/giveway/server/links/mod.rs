//! What robots and people are behind: the one room of the server that knows the simulator.
//!
//! Main type: [`Links`]. Data goes through it: what is heard comes as inputs of the fleet, what leaves as
//! [`giveway_drive::LinkOutput`]. `sim` is the floor that this process simulates, `trial` tries a map out, `recording`
//! plays what was recorded. A floor without a link has no robots. Refuses: to decide, and to keep what was not taken.

pub mod recording;
mod sim;
pub mod trial;

pub use sim::{FloorSource, SimulatedFloor};

use giveway_drive::{Drive, LinkOutput};
use giveway_fleet::Input;
use giveway_floor::time::Time;

/// All links of a floor.
#[derive(Default)]
pub struct Links {
    /// Simulated robots, people and customers.
    sim: Option<SimulatedFloor>,
}

impl Links {
    /// Those of a floor that this process simulates, if it does.
    pub fn new(sim: Option<SimulatedFloor>) -> Links {
        Links { sim }
    }

    /// Everything that was heard since the last time.
    pub fn hear(&mut self, now: Time, drive: &mut Drive) -> Vec<Input> {
        self.sim.as_mut().map(|sim| sim.hear(now, drive)).unwrap_or_default()
    }

    /// Hands on what leaves.
    pub fn take<'a>(&mut self, now: Time, out: impl Into<LinkOutput<'a>>) {
        if let Some(sim) = &mut self.sim {
            sim.take(now, out.into());
        }
    }

    /// The floor was made anew for another map: robots stay as they were before.
    pub fn keep_robots_of(&mut self, before: &Links) {
        if let (Some(sim), Some(before)) = (&mut self.sim, &before.sim) {
            sim.keep_robots_of(before);
        }
    }

    /// The simulated floor, for tests.
    #[cfg(test)]
    pub fn sim(&self) -> &SimulatedFloor {
        self.sim.as_ref().expect("the test has one")
    }
}

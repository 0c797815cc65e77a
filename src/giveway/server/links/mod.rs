//! The links to robots and people: the only room of the server that knows the simulator.
//!
//! Main type: [`Links`]. Data passes through it: what is heard becomes inputs of the fleet, what leaves is
//! [`giveway_drive::LinkOutput`]. `sim` is the floor that this process simulates, `trial` tries out a map, `recording`
//! plays a recording. A floor without a link has no robots. Refuses: to decide, and to keep output that a link did not
//! take.

mod mqtt;
pub mod recording;
mod sim;
pub mod trial;

pub use mqtt::{MqttRobots, connect};

pub use sim::{FloorSource, SimulatedFloor};

use giveway_api::{LinkQuestion, LinkTally};
use giveway_drive::{Drive, DriveAlarm, LinkOutput};
use giveway_fleet::Input;
use giveway_floor::time::Time;
use tokio::sync::mpsc;

/// All links of a floor.
#[derive(Default)]
pub struct Links {
    /// Simulated robots, people and customers.
    sim: Option<SimulatedFloor>,
    /// Robots that speak VDA 5050.
    mqtt: Option<MqttRobots>,
}

impl Links {
    /// The links of a floor; simulated, if this process simulates it.
    pub fn new(sim: Option<SimulatedFloor>, mqtt: Option<MqttRobots>) -> Links {
        Links { sim, mqtt }
    }

    /// Everything that was heard since the last call.
    pub fn hear(&mut self, now: Time, drive: &mut Drive) -> Vec<Input> {
        let mut heard = self.sim.as_mut().map(|sim| sim.hear(now, drive)).unwrap_or_default();
        heard.extend(self.mqtt.iter_mut().flat_map(|mqtt| mqtt.hear(now, drive.fleet())));
        heard
    }

    /// Where questions to the link to robots of others go, if there is one.
    pub fn desk(&self) -> Option<mpsc::Sender<LinkQuestion>> {
        self.mqtt.as_ref().map(MqttRobots::desk)
    }

    /// Alarms of links that began or ended since the last call.
    pub fn take_alarms(&mut self) -> Vec<DriveAlarm> {
        self.mqtt.as_mut().map(MqttRobots::take_alarms).unwrap_or_default()
    }

    /// What the link to robots of others counted since the last call, if there is one.
    pub fn take_counts(&mut self) -> Option<LinkTally> {
        self.mqtt.as_mut().map(MqttRobots::take_counts)
    }

    /// Passes output on to the links.
    pub fn take<'a>(&mut self, now: Time, out: impl Into<LinkOutput<'a>>) {
        let out = out.into();
        if let Some(sim) = &mut self.sim {
            sim.take(now, out);
        }
        if let Some(mqtt) = &mut self.mqtt {
            mqtt.take(now, out);
        }
    }

    /// Keeps the robots as they were when the floor is rebuilt for another map.
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

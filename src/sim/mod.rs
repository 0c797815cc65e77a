//! STUB for the server side; the real simulation replaces this folder.
use crate::fleet::*;
use crate::id::*;
use crate::time::*;
use crate::warehouse::Warehouse;
use std::sync::Arc;
/// A scenario file.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Name.
    pub name: String,
    /// Map, a path relative to the scenario file.
    pub map: String,
    /// Robots.
    pub robots: usize,
    /// Settings of the core.
    pub settings: Settings,
    /// Seed.
    pub seed: u64,
}
impl Scenario {
    /// Reads a scenario file.
    pub fn parse(_text: &str) -> Result<Scenario, String> {
        Ok(Scenario {
            name: "stub".into(),
            map: "../maps/lab.json".into(),
            robots: 2,
            settings: Settings { kinematics: Default::default(), period: Span::from_millis(50) },
            seed: 1,
        })
    }
}
/// The simulated floor.
pub struct World;
impl World {
    /// A floor with robots as the scenario says; robots that the fleet knows stand where its ledger has them.
    pub fn new(_w: Arc<Warehouse>, _s: &Scenario, _seed: u64, _fleet: &Fleet, _now: Time) -> World {
        World
    }
    /// Moves everything to `now` and says what is seen, and which jobs the simulated customers hand in.
    pub fn advance(&mut self, _now: Time) -> Vec<Input> {
        vec![]
    }
    /// Hands over orders to robots.
    pub fn command(&mut self, _now: Time, _c: Vec<(RobotId, Command)>) {}
}

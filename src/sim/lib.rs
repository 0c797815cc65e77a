//! A floor that exists only in memory: robots with inertia, people with minds of their own, links that lose and delay
//! messages, customers that order.
//!
//! Main types: [`Scenario`] (what to simulate), [`World`] (turns commands into inputs), [`Simulation`] (the driver that
//! steps world and fleet and checks the [`laws`]). Each folder is a room, and each knows those before it in this list:
//! `random`, `askers`, `scenario`, `link`, `walker`, `picker`, `robot`, `arm`, `crew`, `customers`, `incidents`,
//! `measure`, `world`, `laws`, `recording`, `run`, `swarm`; `tests/walls/rooms.rs` enforces it. Pure and deterministic:
//! same build, same seed, same bytes. Refuses: to show the fleet anything that a real floor would not.

pub mod arm;
mod askers;
mod crew;
mod customers;
mod incidents;
pub mod laws;
mod link;
pub mod measure;
pub mod picker;
pub mod random;
pub mod recording;
mod robot;
mod run;
mod scenario;
pub mod swarm;
#[cfg(test)]
mod tests;
mod walker;
mod world;

pub use arm::simulated_arm::SimulatedArm;
pub use customers::{OrderFileLine, nothing_to_order};
pub use laws::{CalmFigures, Laws, Violation};
pub use measure::digest::Digest;
pub use measure::encounter::EncounterFigures;
pub use measure::rings::RingColumn;
pub use measure::tally::JobTally;
pub use recording::replay::{Player, Turn};
pub use run::consistency::{Consistency, NeesFigures};
pub use run::warm_up::{WarmUp, warm_up};
pub use run::{Outcome, People, SimTurn, Simulation};
pub use scenario::{
    Assignments, Causes, Closing, Demand, Deviations, Faults, Habits, HandSensor, HandSide, LineDemand,
    LocalPlannerWord, Personas, PickerHabits, Rates, Scenario, SecondTag, SeenGaze, Sensor, Source,
    TaskSharing, WorkCells, Workers,
};
pub use walker::WalkCause;
pub use world::{World, starting_places};

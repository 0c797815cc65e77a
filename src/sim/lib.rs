//! A floor that exists only in memory: robots with inertia, people with minds of their own, links that lose and
//! delay, customers that order.
//!
//! Main types: [`Scenario`] (what to simulate), [`World`] (turns commands into inputs), [`Simulation`] (the driver that
//! steps world and fleet and checks the [`laws`]). Pure and deterministic: same build, same seed, same bytes. Refuses:
//! to show the fleet anything that a real floor would not.

mod announce;
pub mod arm;
pub mod arms;
mod askers;
mod beside;
mod beside_log;
mod consistency;
mod crew;
mod customers;
pub mod detection;
mod digest;
pub mod encounter;
mod entrance;
mod guard;
mod host;
mod journal;
pub mod laws;
mod leavers;
mod link;
mod outages;
mod pairs;
pub mod picker;
mod pushes;
pub mod random;
pub mod recording;
pub mod replay;
pub mod rings;
mod robot;
pub mod run;
mod scenario;
mod sensor;
mod shared_tasks;
pub mod swarm;
mod tally;
#[cfg(test)]
mod tests;
pub mod walker;
mod warm_up;
mod world;

pub use consistency::{Consistency, NeesFigures};
pub use customers::{OrderFileLine, nothing_to_order};
pub use digest::Digest;
pub use laws::{CalmFigures, Violation};
pub use run::{JobTally, Outcome, People, SimTurn, Simulation};
pub use scenario::{
    Assignments, Causes, Closing, Demand, Deviations, Faults, Habits, HandSensor, HandSide, LineDemand,
    LocalPlannerWord, Personas, PickerHabits, Rates, Scenario, SecondTag, SeenGaze, Sensor, Source,
    TaskSharing, WorkCells, Workers,
};
pub use warm_up::{WarmUp, warm_up};
pub use world::{World, starting_places};

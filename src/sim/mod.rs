//! A floor that exists only in memory: robots with inertia, people with minds of their own, links that lose and
//! delay, customers that order.
//!
//! Main types: [`Scenario`] (what to simulate), [`World`] (turns commands into inputs), [`Simulation`] (the driver that
//! steps world and fleet and checks the [`laws`]). Pure and deterministic: same build, same seed, same bytes. Refuses:
//! to show the fleet anything that a real floor would not.

mod closures;
mod crew;
mod customers;
pub mod detection;
mod digest;
pub mod encounter;
mod guard;
mod habits;
mod job_laws;
pub mod laws;
mod link;
mod place_laws;
mod pushes;
mod random;
pub mod recording;
pub mod replay;
mod robot;
pub mod run;
mod scenario;
mod sensor;
mod tally;
pub mod walker;
mod workforce;
mod world;

pub use closures::Closing;
pub use customers::{FIRST_TOKEN, OrderLine};
pub use digest::Digest;
pub use habits::Habits;
pub use laws::Violation;
pub use run::{Outcome, People, Simulation, Tally};
pub use scenario::{Demand, Faults, Scenario, ScenarioError};
pub use workforce::{Assignments, Causes, Deviations, Personas, Rates, Sensor, Source, Workers};
pub use world::{World, starting_places};

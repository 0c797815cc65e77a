//! A floor that exists only in memory: robots with inertia, links that lose and delay, customers that order.
//!
//! Main types: [`Scenario`] (what to simulate), [`World`] (turns commands into inputs), [`Simulation`] (the driver that
//! steps world and fleet and checks the [`laws`]). Pure and deterministic: same build, same seed, same bytes. Refuses:
//! to show the fleet anything that a real floor would not.

mod customers;
mod digest;
pub mod laws;
mod link;
mod random;
pub mod recording;
mod robot;
pub mod run;
mod scenario;
mod world;

pub use customers::OrderLine;
pub use digest::Digest;
pub use laws::Violation;
pub use run::{Outcome, Simulation};
pub use scenario::{Demand, Faults, Scenario, ScenarioError};
pub use world::{World, starting_places};

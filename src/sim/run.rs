//! The driver without a server: world, step, laws, and the figures at the end.
//!
//! Main types: [`Simulation`], [`Outcome`]. Refuses: clocks; step times are measured with a stopwatch that
//! whoever runs it passes in, and decide nothing.

use super::customers::OrderLine;
use super::digest::Digest;
use super::laws::Laws;
use super::scenario::Scenario;
use super::world::World;
use crate::fleet::{Counts, Fleet, Input, Settings, Step};
use crate::time::{Span, Time};
use crate::warehouse::Warehouse;
use std::sync::Arc;

/// A run in progress.
pub struct Simulation {
    /// The fleet under test.
    pub fleet: Fleet,
    /// The floor.
    pub world: World,
    laws: Laws,
    now: Time,
    period: Span,
    end: Time,
    ghosts: bool,
    stopwatch: fn() -> u64,
    plan_ns: Vec<u64>,
    step_ns: Vec<u64>,
    trace: Digest,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Simulated time.
    pub simulated: Span,
    /// Sums.
    pub counts: Counts,
    /// Durations of searches, nanoseconds, ascending.
    pub plan_ns: Vec<u64>,
    /// Durations of steps, nanoseconds, ascending.
    pub step_ns: Vec<u64>,
    /// How often laws were broken.
    pub law_violations: u64,
    /// The first of them, in words.
    pub broken: Vec<String>,
    /// A digest of all facts: same build, same seed, same digest.
    pub trace_hash: u64,
}

impl Simulation {
    /// Everything at its start. `ghosts` lets robots pass through one another.
    pub fn new(
        warehouse: Arc<Warehouse>,
        scenario: &Scenario,
        lines: &[OrderLine],
        seed: u64,
        ghosts: bool,
        stopwatch: fn() -> u64,
    ) -> Simulation {
        let settings = Settings { ghosts, stopwatch, ..scenario.settings() };
        let fleet = Fleet::new(warehouse.clone(), settings);
        let world = World::new(warehouse, scenario, lines, seed, &fleet, Time::ZERO);
        Simulation {
            laws: Laws::new(&fleet),
            fleet,
            world,
            now: Time::ZERO,
            period: scenario.period,
            end: Time::ZERO + scenario.duration,
            ghosts,
            stopwatch,
            plan_ns: Vec::new(),
            step_ns: Vec::new(),
            trace: Digest::default(),
        }
    }

    /// The time now.
    pub fn now(&self) -> Time {
        self.now
    }

    /// Whether the time is up.
    pub fn is_over(&self) -> bool {
        self.now >= self.end
    }

    /// One control period. Gives the inputs and what the step made of them, for recordings.
    pub fn step(&mut self) -> (Vec<Input>, Step) {
        let inputs = self.world.advance(self.now, &self.fleet);
        let start = (self.stopwatch)();
        let step = self.fleet.step(self.now, inputs.clone());
        self.step_ns.push((self.stopwatch)() - start);
        self.plan_ns.append(&mut self.fleet.take_plan_times());
        if !self.ghosts {
            self.laws.check(self.now, &self.world, &self.fleet, &step.facts);
        }
        self.trace.add(&step.facts);
        self.world.command(self.now, step.urgent.clone());
        self.world.command(self.now, step.commands.clone());
        self.world.tell(self.now, step.guidance.clone());
        self.now += self.period;
        (inputs, step)
    }

    /// The digest of all facts so far.
    pub fn trace_hash(&self) -> u64 {
        self.trace.value()
    }

    /// The figures.
    pub fn outcome(mut self) -> Outcome {
        self.plan_ns.sort_unstable();
        self.step_ns.sort_unstable();
        Outcome {
            simulated: self.now - Time::ZERO,
            counts: self.fleet.view(self.now).counts,
            plan_ns: self.plan_ns,
            step_ns: self.step_ns,
            law_violations: self.laws.count,
            broken: self.laws.broken.iter().map(|(t, v)| format!("{t}: {v}")).collect(),
            trace_hash: self.trace.value(),
        }
    }
}

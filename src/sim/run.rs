//! The driver without a server: world, step, laws, and the figures at the end.
//!
//! Main types: [`Simulation`], [`Outcome`]. Refuses: clocks; step times are measured with a stopwatch that
//! the caller passes in, and decide nothing.

use super::consistency::Consistency;
use super::customers::OrderFileLine;
use super::detection::{Score, Watch};
use super::digest::Digest;
use super::encounter::EncounterFigures;
use super::laws::{CalmFigures, Laws, Violation, undrained};
use super::scenario::Scenario;
pub use super::tally::JobTally;
use super::tally::Tallies;
use super::world::World;
use giveway_fleet::{Counts, Fleet, Input, Settings, Step};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeMap;
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
    drain: Span,
    measured: Option<(Counts, u64)>,
    tallies: Tallies,
    without_conflicts: bool,
    stopwatch: fn() -> u64,
    plan_ns: Vec<u64>,
    step_ns: Vec<u64>,
    trace: Digest,
    watch: Watch,
    consistency: Consistency,
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
    /// Whether every job ended and every rack came to storage after the customers stopped; nothing where they did not.
    pub drained: Option<bool>,
    /// How long that took.
    pub drain: Span,
    /// What became of jobs of each kind, to the very end.
    pub jobs: BTreeMap<&'static str, JobTally>,
    /// A digest of all facts of the duration: same build, same seed, same digest.
    pub trace_hash: u64,
    /// What became of people, measured where they truly were.
    pub people: People,
}

/// What became of people.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct People {
    /// Meetings with robots, contacts, time on the floor.
    pub figures: EncounterFigures,
    /// Assignments that they truly completed.
    pub completed: u64,
    /// How well the fleet knew what they did.
    pub score: Score,
    /// How often one was kept in one spot for a minute by robots, or without a way; for each minute of it.
    pub standstills: u64,
    /// How calm guidance was.
    pub calm: CalmFigures,
    /// Whether the filter of their motion knew how wrong it was.
    pub consistency: Consistency,
}

impl Simulation {
    /// Everything at its start. `without_conflicts` lets robots pass through one another.
    pub fn new(
        warehouse: Arc<Warehouse>,
        scenario: &Scenario,
        lines: &[OrderFileLine],
        seed: u64,
        without_conflicts: bool,
        stopwatch: fn() -> u64,
    ) -> Simulation {
        let warehouse =
            scenario.fit(&warehouse).expect("a scenario is refused with its map where it is read");
        let settings = Settings { without_conflicts, stopwatch, ..scenario.settings() };
        let fleet = Fleet::new(warehouse.clone(), settings);
        let world = World::new(warehouse, scenario, lines, seed, &fleet, Time::ZERO);
        Simulation {
            laws: Laws::new(&fleet),
            fleet,
            world,
            now: Time::ZERO,
            period: scenario.period,
            end: Time::ZERO + scenario.duration,
            drain: if without_conflicts { Span::ZERO } else { scenario.drain },
            measured: None,
            tallies: Tallies::default(),
            without_conflicts,
            stopwatch,
            plan_ns: Vec::new(),
            step_ns: Vec::new(),
            trace: Digest::default(),
            watch: Watch::default(),
            consistency: Consistency::default(),
        }
    }

    /// The time now.
    pub fn now(&self) -> Time {
        self.now
    }

    /// Whether the time is up.
    pub fn is_over(&self) -> bool {
        let drained = || undrained(&self.world, &self.fleet) == (0, 0);
        self.now >= self.end && (self.now >= self.end + self.drain || drained())
    }

    /// Whether the duration is over, and the floor only drains.
    pub fn drains(&self) -> bool {
        self.now >= self.end
    }

    /// One control period. Gives the inputs and what the step made of them, for recordings.
    pub fn step(&mut self) -> (Vec<Input>, Step) {
        if self.now >= self.end && self.measured.is_none() {
            // What is counted is counted until here; then everything has to end.
            self.measured = Some((self.fleet.view(self.now).counts, self.trace.value()));
            self.world.stop_customers();
        }
        let inputs = self.world.advance(self.now, &self.fleet);
        let start = (self.stopwatch)();
        let step = self.fleet.step(self.now, inputs.clone());
        self.step_ns.push((self.stopwatch)() - start);
        self.plan_ns.append(&mut self.fleet.take_plan_times());
        if !self.without_conflicts {
            self.laws.check(self.now, &self.world, &self.fleet, &step.facts);
        }
        self.trace.add(&step.facts);
        self.tallies.note(&step.facts);
        self.world.answer(self.now, &step.replies);
        self.watch.note(self.now, &step.facts, &step.guidance);
        self.watch.look(self.now, &self.fleet);
        self.consistency.note(self.now, &self.world, &self.fleet);
        self.world.command(self.now, step.urgent.clone());
        self.world.command(self.now, step.commands.clone());
        self.world.tell(self.now, step.guidance.clone());
        self.world.warn(self.now, &step.warnings);
        self.world.move_arms(&step.arms);
        self.now += self.period;
        (inputs, step)
    }

    /// The laws that were broken so far, and when; the first hundred.
    pub fn broken(&self) -> &[(Time, Violation)] {
        &self.laws.broken
    }

    /// Racks that were served so far.
    pub fn robot_deliveries(&self) -> u64 {
        self.fleet.ledger().counts.robot_deliveries
    }

    /// The digest of all facts so far.
    pub fn trace_hash(&self) -> u64 {
        self.trace.value()
    }

    /// The figures.
    pub fn outcome(mut self) -> Outcome {
        self.plan_ns.sort_unstable();
        self.step_ns.sort_unstable();
        let people = self.people();
        let drains = self.drain > Span::ZERO;
        let drained = drains.then(|| self.laws.check_drained(self.now, &self.world, &self.fleet));
        let (counts, trace_hash) =
            self.measured.unwrap_or_else(|| (self.fleet.view(self.now).counts, self.trace.value()));
        Outcome {
            simulated: self.now.min(self.end) - Time::ZERO,
            drained,
            drain: (self.now - self.end).max(Span::ZERO),
            jobs: self.tallies.all(&self.fleet),
            counts,
            plan_ns: self.plan_ns,
            step_ns: self.step_ns,
            law_violations: self.laws.count,
            broken: self.laws.broken.iter().map(|(t, v)| format!("{t}: {v}")).collect(),
            trace_hash,
            people,
        }
    }

    fn people(&self) -> People {
        let logs = self.world.walkers().map(|(id, w)| (id, w.log()));
        People {
            figures: self.world.figures(),
            completed: self.world.completed(),
            score: self.watch.score(logs, self.now),
            standstills: self.laws.standstills(),
            calm: self.laws.calm(),
            consistency: self.consistency.clone(),
        }
    }
}

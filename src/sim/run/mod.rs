//! A floor in memory around the same driver that the server runs: world, turn, laws, and the figures at the end.
//!
//! Main types: [`Simulation`], [`SimTurn`], [`Outcome`]. Refuses: clocks; turns are measured with a stopwatch that the
//! caller passes in, which decides nothing.

pub mod consistency;
mod host;
mod journal;
pub mod warm_up;

use crate::customers::OrderFileLine;
use crate::laws::{CalmFigures, Laws, Violation, undrained};
use crate::measure::detection::{Score, Watch};
use crate::measure::digest::Digest;
use crate::measure::encounter::EncounterFigures;
use crate::measure::tally::{JobTally, Tallies};
use crate::run::consistency::Consistency;
use crate::run::host::{Host, HostTurn};
use crate::scenario::Scenario;
use crate::world::World;
use giveway_drive::{Drive, Released, Sent};
use giveway_fleet::{Counts, Fact, Fleet, Input, Settings};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A run in progress.
pub struct Simulation {
    host: Host,
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

/// What one turn of a simulation did.
#[derive(Clone, Debug, Default)]
pub struct SimTurn {
    /// The inputs of the turn.
    pub inputs: Vec<Input>,
    /// Output that left at once, and what was written to the journal.
    pub sent: Sent,
    /// Output that left because its facts are durable.
    pub released: Released,
}

impl SimTurn {
    /// The facts of the turn, in order.
    pub fn facts(&self) -> &[Fact] {
        self.sent.written.as_ref().map_or(&[], |written| &written.facts)
    }
}

/// The results of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Simulated time.
    pub simulated: Span,
    /// Totals from the ledger.
    pub counts: Counts,
    /// Durations of searches, nanoseconds, ascending.
    pub plan_ns: Vec<u64>,
    /// Durations of steps, nanoseconds, ascending.
    pub step_ns: Vec<u64>,
    /// How often laws were broken.
    pub law_violations: u64,
    /// The first violations, in words.
    pub broken: Vec<String>,
    /// Whether every job ended and every rack came to storage after the customers stopped; nothing if they did not
    /// stop.
    pub drained: Option<bool>,
    /// How long draining took.
    pub drain: Span,
    /// Outcomes of jobs of each kind, to the very end.
    pub jobs: BTreeMap<&'static str, JobTally>,
    /// A digest of all facts of the duration: same build, same seed, same digest.
    pub trace_hash: u64,
    /// Figures of people, measured where they truly were.
    pub people: People,
}

/// Figures of people.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct People {
    /// Encounters with robots, contacts, time on the floor.
    pub figures: EncounterFigures,
    /// Assignments that people truly completed.
    pub completed: u64,
    /// How well the fleet knew what people did.
    pub score: Score,
    /// How often a person was kept in one spot for a minute by robots, or without a way; counted for each minute.
    pub standstills: u64,
    /// How calm guidance was.
    pub calm: CalmFigures,
    /// Whether the filter of people's motion knew how wrong it was.
    pub consistency: Consistency,
}

impl Simulation {
    /// A simulation at its start. `without_conflicts` lets robots pass through one another.
    pub fn new(
        warehouse: Arc<Warehouse>,
        scenario: &Scenario,
        lines: &[OrderFileLine],
        seed: u64,
        without_conflicts: bool,
        stopwatch: fn() -> u64,
    ) -> Simulation {
        let warehouse =
            scenario.site.fit(&warehouse).expect("a scenario is refused with its map where it is read");
        let settings = Settings { without_conflicts, stopwatch, ..scenario.site.settings() };
        let fleet = Fleet::new(warehouse.clone(), settings);
        // The bound on throughput is computed without people.
        let alone = without_conflicts
            .then(|| Scenario { workers: crate::scenario::Workers::default(), ..scenario.clone() });
        let floor = alone.as_ref().unwrap_or(scenario);
        let world = World::new(warehouse, floor, lines, seed, fleet.ledger(), Time::ZERO);
        Simulation {
            laws: Laws::new(&fleet),
            host: Host::new(fleet, &scenario.faults, seed),
            world,
            now: Time::ZERO,
            period: scenario.site.period,
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

    /// The fleet under test.
    pub fn fleet(&self) -> &Fleet {
        self.host.drive.fleet()
    }

    /// How many searches there were.
    pub fn searches(&self) -> usize {
        self.plan_ns.len()
    }

    /// How often each kind of fault has happened, on the floor and to Giveway itself.
    pub fn injected(&self) -> BTreeMap<&'static str, u64> {
        let mut all = self.world.injected();
        all.extend(self.host.injected());
        all
    }

    /// The driver, for tests that plant faults in it.
    pub fn drive_mut(&mut self) -> &mut Drive {
        &mut self.host.drive
    }

    /// Whether the run is over.
    pub fn is_over(&self) -> bool {
        let drained = || undrained(&self.world, self.fleet()) == (0, 0);
        self.now >= self.end && (self.now >= self.end + self.drain || drained())
    }

    /// Whether the duration is over and the floor only drains.
    pub fn drains(&self) -> bool {
        self.now >= self.end
    }

    /// Runs one control period.
    pub fn step(&mut self) -> SimTurn {
        let now = self.now;
        if now >= self.end && self.measured.is_none() {
            // Counting ends here; then everything has to end.
            self.measured = Some((self.fleet().view(now).counts, self.trace.value()));
            self.world.stop_customers();
        }
        let fleet = self.host.drive.fleet();
        self.world.foretell(fleet.people_near(&self.world.robots_beside(), self.world.now()));
        let inputs = self.world.advance(now, fleet.ledger());
        let start = (self.stopwatch)();
        let host = self.host.turn(now - self.period, now, inputs.clone());
        self.step_ns.push((self.stopwatch)() - start);
        self.plan_ns.append(&mut self.host.drive.take_plan_times());
        self.look(&host);
        let HostTurn { sent, released, .. } = host;
        self.world.take(now, &sent);
        self.world.take(now, &released);
        self.now += self.period;
        SimTurn { inputs, sent, released }
    }

    /// Checks the laws and updates the figures.
    fn look(&mut self, turn: &HostTurn) {
        let (now, fleet) = (self.now, self.host.drive.fleet());
        let written = turn.sent.written.as_ref().map_or(&[][..], |written| &written.facts);
        for violation in &turn.broken {
            self.laws.break_law(now, violation.clone());
        }
        let durable = turn.durable.as_deref().unwrap_or(written);
        self.trace.add(durable);
        self.tallies.note(durable);
        if let Some(fold) = &turn.anew {
            self.laws.begin_again(fleet, fold.clone());
            self.world.meet_another(fleet.ledger());
        }
        if turn.begun {
            self.world.say_links_again();
        }
        if turn.anew.is_some() || !self.host.is_up() {
            return self.laws.check_floor(now, &self.world);
        }
        if !self.without_conflicts {
            self.laws.check(now, &self.world, fleet, written);
        }
        self.watch.note(now, written, &turn.sent.guidance);
        self.watch.look(now, fleet);
        self.consistency.note(now, &self.world, fleet);
    }

    /// The first hundred violations so far, with their times.
    pub fn broken(&self) -> &[(Time, Violation)] {
        &self.laws.broken
    }

    /// How many racks were served so far.
    pub fn robot_deliveries(&self) -> u64 {
        self.fleet().ledger().counts.robot_deliveries
    }

    /// The digest of all facts so far.
    pub fn trace_hash(&self) -> u64 {
        self.trace.value()
    }

    /// The results of the run.
    pub fn outcome(mut self) -> Outcome {
        self.plan_ns.sort_unstable();
        self.step_ns.sort_unstable();
        let people = self.people();
        let drains = self.drain > Span::ZERO;
        let drained = drains.then(|| self.laws.check_drained(self.now, &self.world, self.host.drive.fleet()));
        let (counts, trace_hash) = self
            .measured
            .unwrap_or_else(|| (self.host.drive.fleet().view(self.now).counts, self.trace.value()));
        Outcome {
            simulated: self.now.min(self.end) - Time::ZERO,
            drained,
            drain: (self.now - self.end).max(Span::ZERO),
            jobs: self.tallies.all(self.host.drive.fleet()),
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

//! The driver around the core: hearing, deciding, recording and sending as one pure machine.
//!
//! Main types: [`Drive`], [`Heard`], [`Sent`], [`Released`], [`LinkOutput`]. The server is sockets, a clock and a
//! database around it; a simulation is a loop around the same machine, with a journal that may be late, refuse or lose
//! its last writes, and a process that may die at any point. Stops and guidance leave in the turn that decided them
//! ([`Sent`]); orders and answers leave when the journal has the facts behind them ([`Released`]). Every call of the
//! fleet is guarded: if one panics, the robot being dealt with is fenced off, and the others go on (`rescue.rs`).
//! Refuses: clocks, sockets, files; decisions about robots; to keep more than the stated limits.

mod gate;
mod intake;
mod link;
mod outbox;
mod rescue;
mod settle;

pub use gate::{JournalReport, JournalState, MOST_PENDING};
pub use intake::MOST_REQUESTS;
pub use link::LinkOutput;
pub use rescue::{GuardedCall, PLANTED, Trap, panic_text};
pub use settle::NotStanding;

use gate::JournalGate;
use giveway_cell::arm::ArmOrder;
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{CausedFacts, CellWarning, Command, Fact, Fleet, Guidance, Input, Reply, Request, Token};
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::Time;
use intake::{Asked, KeptRequests};
use outbox::Outbox;
use rescue::{Mode, Rescue};
use settle::Settling;

/// The inputs of a turn.
#[derive(Clone, Debug, Default)]
pub struct Heard {
    /// The latest report of the journal.
    pub journal: JournalReport,
    /// Requests of clients, in their order.
    pub requests: Vec<(Token, Request)>,
    /// Reports of robots, observations of people, and requests of simulated customers.
    pub inputs: Vec<Input>,
}

/// The output of a turn. Everything but the facts leaves at once; orders and answers come later, as [`Released`].
#[derive(Clone, Debug, Default)]
pub struct Sent {
    /// The next step for the journal.
    pub written: Option<WrittenStep>,
    /// Stops, slow-downs and their ends.
    pub limits: Vec<(RobotId, Command)>,
    /// Guidance for workers.
    pub guidance: Vec<(WorkerId, Guidance)>,
    /// Warnings for people at work cells.
    pub warnings: Vec<CellWarning>,
    /// Trajectories for robot arms.
    pub arms: Vec<ArmOrder>,
    /// Requests that come to nothing: the journal takes no facts, or the step that they were part of panicked.
    pub refused: Vec<Token>,
    /// Alarms that are raised and cleared.
    pub alarms: Vec<DriveAlarm>,
    /// Result of a request that all robots stand.
    pub settled: Option<Result<(), NotStanding>>,
    /// Whether a step was made.
    pub stepped: bool,
}

/// The facts of a step, for the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenStep {
    /// Time of the step.
    pub at: Time,
    /// The facts of the step, in order; at least one.
    pub facts: Vec<Fact>,
    /// The facts that requests caused themselves.
    pub caused: Vec<CausedFacts>,
}

/// Messages that leave because the facts behind them are durable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Released {
    /// Orders to robots.
    pub orders: Vec<(RobotId, Command)>,
    /// Answers to requests.
    pub replies: Vec<Reply>,
}

/// An alarm about the loop itself.
#[derive(Clone, Debug, PartialEq)]
pub enum DriveAlarm {
    /// The alarm is raised, with this text.
    Raise(AlarmKind, Sentence),
    /// The alarm is cleared.
    Clear(AlarmKind),
}

/// Fleet and journal gate, driven by a loop that has a clock: the server's or the simulation's.
pub struct Drive {
    fleet: Fleet,
    gate: JournalGate,
    intake: KeptRequests,
    outbox: Outbox,
    settling: Settling,
    rescue: Rescue,
    /// Whether all robots were told to stand, since no fact may be added.
    halted: bool,
    alarms: Vec<DriveAlarm>,
}

impl Drive {
    /// A driver of this fleet, all of whose facts are durable.
    pub fn new(fleet: Fleet) -> Drive {
        Drive {
            fleet,
            gate: JournalGate::default(),
            intake: KeptRequests::default(),
            outbox: Outbox::default(),
            settling: Settling::default(),
            rescue: Rescue::default(),
            halted: false,
            alarms: Vec::new(),
        }
    }

    /// One control period: takes all inputs, decides once, and gives what must be written and sent.
    pub fn turn(&mut self, now: Time, heard: Heard) -> Sent {
        let mut sent = Sent::default();
        self.gate.note(heard.journal);
        sent.refused = self.intake.take(heard.requests, self.refuses());
        self.fence_off(now);
        match self.rescue.mode() {
            Mode::Runs if self.gate.is_full() => self.halt(heard.inputs, &mut sent),
            Mode::Runs => {
                self.resume();
                self.decide(now, heard.inputs, &mut sent);
            }
            Mode::Mends => {
                sent.limits = stops(drivers(&heard.inputs));
                sent.refused.extend(self.intake.keep(heard.inputs));
            }
            Mode::Broken => {
                sent.limits = stops(drivers(&heard.inputs));
                sent.refused.extend(self.intake.keep(heard.inputs));
                sent.refused.extend(self.intake.give_up());
            }
        }
        self.settle(now, &mut sent);
        sent.alarms = std::mem::take(&mut self.alarms);
        sent
    }

    /// The messages that may leave after this report of the journal.
    pub fn release(&mut self, journal: JournalReport) -> Released {
        self.gate.note(journal);
        match self.gate.releases() {
            Some(durable) => self.outbox.take(durable),
            None => Released::default(),
        }
    }

    /// Whether new requests are refused at present; stops and releases by hand never are.
    pub fn refuses(&self) -> bool {
        self.gate.refuses()
    }

    /// Number of clients' requests that may be handed to the next turn. Further ones wait where they are.
    pub fn room(&self) -> usize {
        self.intake.room()
    }

    /// Whether all decisions are durable.
    pub fn is_settled(&self) -> bool {
        self.gate.is_settled()
    }

    /// The fleet in its present state.
    pub fn fleet(&self) -> &Fleet {
        &self.fleet
    }

    /// Durations of searches since the last call, nanoseconds.
    pub fn take_plan_times(&mut self) -> Vec<u64> {
        self.fleet.take_plan_times()
    }

    /// The fleet, for tests that plant faults in it.
    #[doc(hidden)]
    pub fn fleet_mut(&mut self) -> &mut Fleet {
        &mut self.fleet
    }

    /// One step of the fleet, unless it panics.
    fn decide(&mut self, now: Time, inputs: Vec<Input>, sent: &mut Sent) {
        let inputs = self.intake.with(inputs);
        let asked = Asked::of(&inputs);
        let Some(step) = self.step(now, inputs) else {
            sent.refused.extend(asked.tokens);
            sent.refused.extend(self.intake.keep(asked.again));
            return;
        };
        sent.stepped = true;
        (sent.limits, sent.guidance) = (step.urgent, step.guidance);
        (sent.warnings, sent.arms) = (step.warnings, step.arms);
        // A revoked grant must not be given again by an order that has waited since before.
        let revoked = sent.limits.iter().filter(|(_, order)| matches!(order, Command::Revoke { .. }));
        revoked.for_each(|(robot, _)| self.outbox.forget_orders(*robot));
        step.held_back.iter().for_each(|robot| self.outbox.forget_orders(*robot));
        let after = self.gate.record(step.facts.len());
        self.outbox.put(after, step.commands, step.replies);
        let written = WrittenStep { at: now, facts: step.facts, caused: step.caused };
        sent.written = (!written.facts.is_empty()).then_some(written);
    }

    /// Tells all robots to stand, until they report a limit of zero. A decision changes promises and must be recorded,
    /// so none is made; without the halt, robots would finish their grants while people walk on.
    fn halt(&mut self, inputs: Vec<Input>, sent: &mut Sent) {
        if self.halted {
            sent.limits = stops(drivers(&inputs));
        } else {
            self.halted = true;
            self.alarms.push(DriveAlarm::Raise(AlarmKind::Halt, sentence::journal_full()));
            sent.limits = stops(self.fleet.ledger().robots.ids());
        }
        sent.refused.extend(self.intake.keep(inputs));
    }

    /// Ends the halt, since the journal takes facts again: the step that follows lifts the limits, which it did not
    /// set.
    fn resume(&mut self) {
        if std::mem::take(&mut self.halted) {
            self.alarms.push(DriveAlarm::Clear(AlarmKind::Halt));
            tracing::info!("the journal has room again: robots drive on");
        }
    }
}

/// Orders to stand.
fn stops(robots: impl IntoIterator<Item = RobotId>) -> Vec<(RobotId, Command)> {
    robots.into_iter().map(|robot| (robot, Command::Limit(Some(0.0)))).collect()
}

/// Robots that do not report that they were told to stand.
fn drivers(inputs: &[Input]) -> Vec<RobotId> {
    let driver = |input: &Input| match input {
        Input::Telemetry(t) if t.limit_mps != Some(0.0) => Some(t.robot),
        _ => None,
    };
    inputs.iter().filter_map(driver).collect()
}

#[cfg(test)]
mod tests;

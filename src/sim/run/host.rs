//! The process that runs the driver, and its journal, with their failures.
//!
//! Main types: [`Host`], [`HostTurn`]. A process dies at a random point of a turn and restarts some seconds later from
//! what is durable; clients repeat requests that it did not acknowledge. Refuses: to go on after a panic that was not
//! planted.

use super::journal::SimJournal;
use crate::askers::{SUPERVISORS, is_made_again};
use crate::laws::Violation;
use crate::random::Stream;
use crate::scenario::Faults;
use giveway_drive::{Drive, GuardedCall, Heard, JournalReport, JournalState, PLANTED, Released, Sent, Trap};
use giveway_fleet::{Answer, Command, Fact, Fleet, FloorAction, Input, Ledger, Made, Token};
use giveway_floor::id::{Dense, JobId, RobotId};
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// Purpose of the host's stream of random numbers.
const HOST: u64 = 40;
/// Probability that a restarted process dies in its first turn.
const AGAIN: f64 = 0.25;
/// Least time between two planted panics: more of them stop the floor for good.
const PANICS_APART: Span = Span::from_secs(30);

/// Outcome of a turn of the process.
#[derive(Debug, Default)]
pub struct HostTurn {
    /// Output that left at once.
    pub sent: Sent,
    /// Output that left because its facts are durable.
    pub released: Released,
    /// Facts that became durable, if other than the turn's own.
    pub durable: Option<Vec<Fact>>,
    /// The ledger that a new fleet was made from, if the process died or a step panicked.
    pub anew: Option<Ledger>,
    /// Whether a new process has begun, which knows nothing of links.
    pub begun: bool,
    /// Violations of the laws about durability.
    pub broken: Vec<Violation>,
}

/// A process with its journal.
pub struct Host {
    /// The driver.
    pub drive: Drive,
    /// How many steps with facts are durable, if the journal writes everything at once.
    durable: u64,
    /// The failing process and journal, if anything can fail.
    failing: Option<Box<FailingHost>>,
}

impl Host {
    /// A host whose process has just begun.
    pub fn new(fleet: Fleet, faults: &Faults, seed: u64) -> Host {
        let failing = faults.has_host_faults().then(|| {
            let delay = Span::from_millis(faults.journal_delay_ms);
            let journal = SimJournal::new(fleet.ledger().clone(), delay);
            Box::new(FailingHost::new(journal, *faults, seed))
        });
        Host { drive: Drive::new(fleet), durable: 0, failing }
    }

    /// Whether the process runs, so that its fleet can be read.
    pub fn is_up(&self) -> bool {
        self.drive.decides() && self.failing.as_ref().is_none_or(|failing| failing.down_until.is_none())
    }

    /// How often each failure of the host has happened.
    pub fn injected(&self) -> BTreeMap<&'static str, u64> {
        self.failing.as_ref().map_or_else(BTreeMap::new, |failing| failing.counts.clone())
    }

    /// Runs one turn, and gives what may leave after it; the previous turn was at `from`.
    ///
    /// # Panics
    /// If the fleet does, and the panic was not planted.
    pub fn turn(&mut self, from: Time, now: Time, inputs: Vec<Input>) -> HostTurn {
        let turn = match &mut self.failing {
            Some(failing) => failing.turn(&mut self.drive, (from, now), inputs),
            None => self.prompt_turn(now, inputs),
        };
        if let Some(said) = self.drive.take_panic().filter(|said| !said.contains(PLANTED)) {
            // Not `panic!`, which would report this place.
            std::panic::resume_unwind(Box::new(said));
        }
        turn
    }

    fn prompt_turn(&mut self, now: Time, inputs: Vec<Input>) -> HostTurn {
        let journal = |durable| JournalReport { durable, state: JournalState::Writes };
        let heard = Heard { journal: journal(self.durable), requests: Vec::new(), inputs };
        let sent = self.drive.turn(now, heard);
        self.durable += u64::from(sent.written.is_some());
        let released = self.drive.release(journal(self.durable));
        HostTurn { sent, released, ..HostTurn::default() }
    }
}

/// The point in a turn at which a process dies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DeathPoint {
    /// Before it takes in any input.
    Before,
    /// After it has decided, before any output has left.
    Decided,
    /// After stops and guidance have left and facts are with the journal, but before any order or reply.
    Handed,
}

/// A process and a journal that can fail.
struct FailingHost {
    journal: SimJournal,
    faults: Faults,
    luck: Stream,
    /// Until when the process is down, if it is.
    down_until: Option<Time>,
    /// Requests that no process has taken in.
    unheard: Vec<Input>,
    /// Requests taken in, each with the step of this process whose facts make it durable.
    asked: Vec<(u64, Input)>,
    /// Number of steps of this process with facts.
    recorded: u64,
    /// Fences that a person will take down, and when.
    fenced: Vec<(Time, RobotId)>,
    panicked: Option<Time>,
    /// Whether the process dies again in the next turn.
    dies_again: bool,
    /// The newest job that was acknowledged.
    acknowledged: Option<JobId>,
    counts: BTreeMap<&'static str, u64>,
}

impl FailingHost {
    fn new(journal: SimJournal, faults: Faults, seed: u64) -> FailingHost {
        FailingHost {
            journal,
            faults,
            luck: Stream::new(seed, HOST, 0),
            down_until: None,
            unheard: Vec::new(),
            asked: Vec::new(),
            recorded: 0,
            fenced: Vec::new(),
            panicked: None,
            dies_again: false,
            acknowledged: None,
            counts: BTreeMap::new(),
        }
    }

    fn turn(&mut self, drive: &mut Drive, (from, now): (Time, Time), inputs: Vec<Input>) -> HostTurn {
        let begun = self.down_until.take_if(|until| now >= *until).is_some();
        let mut turn = HostTurn { begun, ..HostTurn::default() };
        if self.down_until.is_some() {
            self.keep(inputs);
            return turn;
        }
        let death = self.meet_faults(drive, from, now);
        let mut all = std::mem::take(&mut self.unheard);
        all.extend(self.release_robots(now));
        all.extend(inputs);
        if death == Some(DeathPoint::Before) {
            self.keep(all);
            self.die(drive, now, &mut turn);
            return turn;
        }
        self.note_asked(&all);
        let heard = Heard { journal: self.journal.report(now), requests: Vec::new(), inputs: all };
        let sent = drive.turn(now, heard);
        if death == Some(DeathPoint::Decided) {
            self.die(drive, now, &mut turn);
            return turn;
        }
        self.forget(&sent.refused);
        if let Some(written) = sent.written.clone() {
            self.recorded += 1;
            self.journal.write(now, written);
        }
        turn.sent = sent;
        self.ask(drive, now);
        if death == Some(DeathPoint::Handed) {
            self.die(drive, now, &mut turn);
            return turn;
        }
        turn.durable = Some(self.journal.advance(now));
        let journal = self.journal.report(now);
        self.asked.retain(|(after, _)| *after > journal.durable);
        turn.released = drive.release(journal);
        self.look(&mut turn);
        if drive.wants_fold() {
            drive.restore(now, Ok((self.journal.ledger().clone(), Vec::new())));
            turn.anew = Some(self.journal.ledger().clone());
        }
        turn
    }

    /// Keeps requests that come while the process is down: clients repeat them.
    fn keep(&mut self, inputs: Vec<Input>) {
        self.unheard.extend(inputs.into_iter().filter(is_made_again));
    }

    /// Records which requests this turn takes in.
    fn note_asked(&mut self, inputs: &[Input]) {
        let after = self.recorded + 1;
        self.asked.extend(inputs.iter().filter(|i| is_made_again(i)).map(|i| (after, i.clone())));
    }

    /// Forgets requests that were refused: clients repeat them.
    fn forget(&mut self, refused: &[Token]) {
        self.asked.retain(|(_, input)| match input {
            Input::Ask { token, .. } => !refused.contains(token),
            _ => true,
        });
    }

    /// Draws the failures between `from` and `now`; gives the point where the process dies, if it does.
    fn meet_faults(&mut self, drive: &mut Drive, from: Time, now: Time) -> Option<DeathPoint> {
        if self.faults.until_s.is_some_and(|s| now >= Time::ZERO + Span::from_secs_f64(s)) {
            (self.journal.delay, self.journal.slow_until, self.journal.refuses_until) = Default::default();
            self.faults = self.faults.ended();
            return None;
        }
        let hours = (now - from).as_secs_f64() / 3600.0;
        let outage = Span::from_secs_f64(self.faults.journal_outage_s);
        if self.happens("journal_slow", self.faults.journal_slow_per_hour * hours) {
            self.journal.slow_until = now + outage;
        }
        if self.happens("journal_refuses", self.faults.journal_refuses_per_hour * hours) {
            self.journal.refuses_until = now + outage;
        }
        self.plant(drive, now, hours);
        let again = std::mem::take(&mut self.dies_again);
        let dies = self.happens("restarts", if again { 1.0 } else { self.faults.restarts_per_hour * hours });
        let points = [DeathPoint::Before, DeathPoint::Decided, DeathPoint::Handed];
        dies.then(|| points[self.luck.below(points.len())])
    }

    fn happens(&mut self, what: &'static str, probability: f64) -> bool {
        let happens = probability > 0.0 && self.luck.happens_of(probability);
        *self.counts.entry(what).or_default() += u64::from(happens);
        happens
    }

    /// Plants a panic at a random robot.
    fn plant(&mut self, drive: &mut Drive, now: Time, hours: f64) {
        let robots = drive.fleet().ledger().robots.len();
        let lately = self.panicked.is_some_and(|at| now - at < PANICS_APART);
        let probability = self.faults.panics_per_hour * hours;
        if robots == 0 || lately || !drive.decides() || !self.happens("panics", probability) {
            return;
        }
        let calls = [GuardedCall::Step, GuardedCall::View, GuardedCall::Query];
        let robot = RobotId::at(self.luck.below(robots));
        drive.plant(Trap { call: calls[self.luck.below(calls.len())], robot: Some(robot), times: 1 });
        self.panicked = Some(now);
        self.fenced.push((now + Span::from_secs_f64(self.faults.repair_s), robot));
    }

    /// Makes the queries that a server makes in each turn.
    fn ask(&mut self, drive: &mut Drive, now: Time) {
        if self.panicked == Some(now) {
            drive.ask(GuardedCall::View, now, |fleet| fleet.view(now).robots.len());
            drive.ask(GuardedCall::Query, now, |fleet| fleet.unsettled().len());
        }
    }

    /// Requests of a person who has looked at fenced robots and lets them go on.
    fn release_robots(&mut self, now: Time) -> Vec<Input> {
        let due = self.fenced.extract_if(.., |(at, _)| now >= *at);
        let token = Token { asker: SUPERVISORS, number: 0 };
        due.map(|(_, robot)| Input::ask(token, FloorAction::Release(Some(robot)))).collect()
    }

    /// The process dies, and restarts from what is durable.
    fn die(&mut self, drive: &mut Drive, now: Time, turn: &mut HostTurn) {
        let pending = self.journal.pending();
        let on_disk = if self.faults.torn_writes { self.luck.below(pending + 1) } else { 0 };
        let kept = self.journal.report(now).durable + on_disk as u64;
        turn.durable = Some(self.journal.die(on_disk));
        let lost = self.asked.drain(..).filter(|(after, _)| *after > kept).map(|(_, input)| input);
        let before = std::mem::take(&mut self.unheard);
        self.unheard = lost.chain(before).collect();
        self.recorded = 0;
        let settings = drive.fleet().settings().clone();
        *drive = Drive::new(Fleet::resume(self.journal.ledger().clone(), settings, []));
        let is_lost = |job: &JobId| drive.fleet().ledger().next_job <= job.0;
        turn.broken.extend(self.acknowledged.filter(is_lost).map(Violation::AcknowledgedLost));
        turn.anew = Some(self.journal.ledger().clone());
        self.dies_again = self.luck.happens_of(AGAIN);
        let down_s = self.luck.between(0.0, self.faults.restart_s);
        self.down_until = Some(now + Span::from_secs_f64(down_s));
    }

    /// Checks that nothing leaves before its facts are durable.
    fn look(&mut self, turn: &mut HostTurn) {
        for (robot, order) in &turn.released.orders {
            let Command::Drive { waypoints, .. } = order else { continue };
            if waypoints.last().is_some_and(|last| !self.journal.has_granted(*robot, last.serial)) {
                turn.broken.push(Violation::SentUndurable(*robot));
            }
        }
        for reply in &turn.released.replies {
            if let Ok(Answer::Job(Made { id, .. })) = reply.answer {
                self.acknowledged = self.acknowledged.max(Some(id));
                if self.journal.ledger().next_job <= id.0 {
                    turn.broken.push(Violation::AcknowledgedLost(id));
                }
            }
        }
    }
}

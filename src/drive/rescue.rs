//! Handles a panic in a call of the fleet: the robot being dealt with is fenced off, and the others go on.
//!
//! A step that panicked leaves the fleet half-way, so it is rebuilt from the durable facts; a query leaves it
//! unchanged. Main types: [`Rescue`] (the state about panics), [`Mode`], [`Trap`]. If no robot can be named, if panics
//! are too frequent, or if the journal cannot be folded, all robots are told to stand, and the driver goes on to report
//! that. Refuses: to go on with a fleet that a panic left half-way, and to lose a stop given by hand in that step.

use super::{Drive, DriveAlarm};
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{Fact, Fleet, Input, Ledger, Settings, Step};
use giveway_floor::id::RobotId;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::{Span, Time};
use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Number of panics within [`WHILE`] that are survived.
const MOST: usize = 3;

/// Time for which a panic counts.
const WHILE: Span = Span::from_secs(60);

/// The places where the driver calls the fleet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GuardedCall {
    /// A step.
    Step,
    /// The view for screens.
    View,
    /// Another query, such as one of the API.
    Query,
    /// The limits that a pose or a hand calls for before the next step.
    Pose,
    /// The watchdog, which checks whether laws hold.
    Watch,
}

/// A planted panic, to see its effects: for tests, the swarm, and scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trap {
    /// The call in which the panic occurs.
    pub call: GuardedCall,
    /// The robot being dealt with then, if any.
    pub robot: Option<RobotId>,
    /// Number of panics.
    pub times: u32,
}

/// The text of a planted panic.
pub const PLANTED: &str = "this panic was planted";

/// The mode of the driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Steps are made.
    Runs,
    /// A step panicked: no step is made until [`Drive::restore`].
    Mends,
    /// No step is made any more.
    Broken,
}

/// The state about panics.
#[derive(Debug, Default)]
pub struct Rescue {
    /// The panic of a step, until the fleet is rebuilt: the robot being dealt with, and the panic's text.
    open: Option<(RobotId, String)>,
    /// A robot to be fenced off before the next step.
    fence: Option<RobotId>,
    recent: VecDeque<Time>,
    broken: bool,
    /// Text of the last panic.
    said: Option<String>,
    trap: Option<Trap>,
}

impl Rescue {
    /// The mode of the driver.
    pub fn mode(&self) -> Mode {
        match (self.broken, &self.open) {
            (true, _) => Mode::Broken,
            (false, Some(_)) => Mode::Mends,
            (false, None) => Mode::Runs,
        }
    }

    /// Counts a panic; gives whether it is one too many.
    fn count(&mut self, now: Time) -> bool {
        self.recent.retain(|at| now - *at < WHILE);
        self.recent.push_back(now);
        self.recent.len() > MOST
    }
}

/// Calls the fleet, unless the trap is planted there.
fn call<T>(fleet: &mut Fleet, sprung: Option<Trap>, call: impl FnOnce(&mut Fleet) -> T) -> Result<T, String> {
    let guarded = AssertUnwindSafe(|| {
        fleet.note_at_hand(sprung.and_then(|trap| trap.robot));
        assert!(sprung.is_none(), "{PLANTED}");
        call(fleet)
    });
    catch_unwind(guarded).map_err(|panic| panic_text(&*panic))
}

impl Drive {
    /// Queries the fleet. Nothing while the fleet is being rebuilt, and if the query panics; then the robot being dealt
    /// with is fenced off before the next step.
    pub fn ask<T>(&mut self, what: GuardedCall, now: Time, question: impl FnOnce(&Fleet) -> T) -> Option<T> {
        if self.rescue.mode() == Mode::Mends {
            return None;
        }
        let sprung = self.sprung(what);
        match call(&mut self.fleet, sprung, |fleet| question(fleet)) {
            Ok(answer) => Some(answer),
            Err(said) => {
                let robot = self.fleet.at_hand();
                tracing::error!(?robot, ?what, "a question panicked: {said}");
                self.rescue.said = Some(said.clone());
                if self.rescue.count(now) {
                    self.give_up(&said, "it happens again and again");
                } else {
                    self.rescue.fence = robot;
                }
                None
            }
        }
    }

    /// Makes one step, unless it panics: then no step follows until [`Drive::restore`].
    pub(super) fn step(&mut self, now: Time, inputs: Vec<Input>) -> Option<Step> {
        let sprung = self.sprung(GuardedCall::Step);
        let said = match call(&mut self.fleet, sprung, |fleet| fleet.step(now, inputs)) {
            Ok(step) => return Some(step),
            Err(said) => said,
        };
        let robot = self.fleet.at_hand();
        tracing::error!(?robot, "a step panicked and was discarded: {said}");
        self.rescue.said = Some(said.clone());
        match robot {
            None => self.give_up(&said, "no robot can be named"),
            Some(_) if self.rescue.count(now) => self.give_up(&said, "it happens again and again"),
            Some(robot) => self.rescue.open = Some((robot, said)),
        }
        None
    }

    /// Fences off the robot being dealt with when a query panicked.
    pub(super) fn fence_off(&mut self, now: Time) {
        let Some(robot) = self.rescue.fence.take().filter(|_| self.rescue.mode() == Mode::Runs) else {
            return;
        };
        if let Err(said) = call(&mut self.fleet, None, |fleet| fleet.fence(robot, now)) {
            tracing::error!(?robot, "it cannot be fenced off: {said}");
            self.rescue.said = Some(said.clone());
            self.rescue.open = Some((robot, said));
        }
    }

    /// Whether the fleet must be rebuilt from the journal, with [`Drive::restore`]: all decisions from before the panic
    /// are durable now.
    pub fn wants_fold(&self) -> bool {
        self.rescue.mode() == Mode::Mends && self.is_settled()
    }

    /// The ledger with which a fold of the journal begins.
    pub fn empty_ledger(&self) -> Ledger {
        self.fleet.ledger().emptied()
    }

    /// Rebuilds the fleet from a ledger and the facts behind it, or takes the reason why there are none; the robot that
    /// was being dealt with is fenced off.
    pub fn restore(&mut self, now: Time, folded: Result<(Ledger, Vec<Fact>), String>) {
        let Some((robot, said)) = self.rescue.open.take() else { return };
        let (ledger, facts) = match folded {
            Ok(folded) => folded,
            Err(why) => return self.give_up(&said, &format!("the journal cannot be read: {why}")),
        };
        let settings: Settings = self.fleet.settings().clone();
        let anew = AssertUnwindSafe(|| {
            let mut fleet = Fleet::resume(ledger, settings, facts);
            fleet.keep_links_of(&self.fleet);
            fleet.fence(robot, now);
            fleet
        });
        match catch_unwind(anew) {
            Ok(fleet) => {
                tracing::error!(
                    ?robot,
                    "the fleet was made anew from the journal, and the robot is fenced off"
                );
                self.fleet = fleet;
                self.outbox.forget_orders(robot);
            }
            Err(panic) => self.give_up(&panic_text(&*panic), "the journal contradicts itself"),
        }
    }

    /// Makes no step any more if the fleet is half-way: for the last turn of a process that ends then.
    pub fn stop_deciding(&mut self) {
        self.rescue.broken |= self.rescue.mode() == Mode::Mends;
    }

    /// Whether the next turn makes a step, if the journal has room for its facts.
    pub fn decides(&self) -> bool {
        self.rescue.mode() == Mode::Runs
    }

    /// Whether no step is made any more.
    pub fn is_broken(&self) -> bool {
        self.rescue.mode() == Mode::Broken
    }

    /// Text of the last panic, if it was not taken yet.
    pub fn take_panic(&mut self) -> Option<String> {
        self.rescue.said.take()
    }

    /// Plants a panic.
    pub fn plant(&mut self, trap: Trap) {
        self.rescue.trap = Some(trap);
    }

    /// The trap, if it is planted in this call.
    fn sprung(&mut self, call: GuardedCall) -> Option<Trap> {
        let trap = self.rescue.trap.as_mut().filter(|trap| trap.call == call && trap.times > 0)?;
        trap.times -= 1;
        Some(*trap)
    }

    /// Stops all decisions; from now on the driver only tells the robots to stand and reports it.
    fn give_up(&mut self, said: &str, why: &str) {
        tracing::error!("nothing is decided any more, since {why}: {said}");
        self.rescue.said = Some(said.to_owned());
        let text = sentence::fleet_contradicts_itself(said, why);
        self.alarms.push(DriveAlarm::Raise(AlarmKind::Broken, text));
        // Nothing may use the state that a panic left half-way.
        self.fleet = Fleet::resume(self.fleet.ledger().emptied(), self.fleet.settings().clone(), []);
        self.rescue.broken = true;
    }
}

/// The text of a panic.
pub fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("it does not say why").to_owned()
}

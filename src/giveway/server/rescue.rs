//! What happens when a step ends in a panic: the fleet in memory is not trusted any more, and made anew from what is
//! durable; the robot that was being dealt with is fenced off; the others go on.
//!
//! Main types: [`Rescue`] (what is remembered of panics), [`Asked`]. Where no robot can be named, where it happens too
//! often, or where the journal cannot be folded, all robots are told to stand, and the process stays up to say so.
//! Refuses: to go on with a fleet that a panic left half-way, and to lose a stop given by hand in that step.

use super::drive::DriveLoop;
use super::inbox::token_of_client;
use super::start::panic_text;
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{Fleet, Input, Ledger, Step, Token};
use giveway_floor::id::RobotId;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use tokio::sync::watch;

/// So many panics within [`WHILE`] are survived.
const MOST: usize = 3;

/// For so long a panic counts.
const WHILE: Span = Span::from_secs(60);

/// A step that ended in a panic.
#[derive(Debug)]
struct Panicked {
    robot: Option<RobotId>,
    said: String,
}

/// What is remembered of panics.
#[derive(Debug, Default)]
pub struct Rescue {
    open: Option<Panicked>,
    recent: VecDeque<Time>,
    broken: bool,
}

impl Rescue {
    /// Whether nothing is decided any more.
    pub fn is_broken(&self) -> bool {
        self.broken
    }

    /// Whether the fleet must be made anew before the next step.
    pub fn is_needed(&self) -> bool {
        self.open.is_some()
    }
}

/// Robots that do not say that they were told to stand.
pub fn drivers(inputs: &[Input]) -> impl Iterator<Item = RobotId> {
    inputs.iter().filter_map(|i| match i {
        Input::Telemetry(t) if t.limit_mps != Some(0.0) => Some(t.robot),
        _ => None,
    })
}

/// What was asked from outside in a step: had it ended in a panic, nothing of it would have happened.
pub struct Asked {
    /// Tokens of all else that was asked.
    pub tokens: Vec<Token>,
    /// Stops and releases, which are asked again.
    pub by_hand: Vec<Input>,
}

impl Asked {
    /// Looks through the inputs of a step.
    pub fn of(inputs: &[Input]) -> Asked {
        let mut asked = Asked { tokens: Vec::new(), by_hand: Vec::new() };
        for input in inputs {
            let Some(token) = token_of_client(input) else { continue };
            if matches!(input, Input::Ask { request, .. } if request.is_by_hand()) {
                asked.by_hand.push(input.clone());
            } else {
                asked.tokens.push(token);
            }
        }
        asked
    }

    /// Tokens of all of it.
    pub fn all(&self) -> Vec<Token> {
        self.tokens.iter().copied().chain(self.by_hand.iter().filter_map(token_of_client)).collect()
    }
}

impl DriveLoop {
    /// One step, unless it ends in a panic: then there is work for [`DriveLoop::rebuild`].
    pub(super) fn step(&mut self, now: Time, inputs: Vec<Input>) -> Option<Step> {
        let asked = Asked::of(&inputs);
        match catch_unwind(AssertUnwindSafe(|| self.fleet.step(now, inputs))) {
            Ok(step) => Some(step),
            Err(panic) => {
                let (robot, said) = (self.fleet.at_hand(), panic_text(&*panic));
                tracing::error!(?robot, "a step panicked and was discarded: {said}");
                self.inbox.forget(&asked.tokens);
                self.inbox.keep(asked.by_hand);
                self.rescue.open = Some(Panicked { robot, said });
                None
            }
        }
    }

    /// Makes the fleet anew from what is durable, without the robot that was being dealt with.
    pub(super) async fn rebuild(&mut self, stop: &mut watch::Receiver<bool>) {
        let Some(Panicked { robot, said }) = self.rescue.open.take() else { return };
        let now = self.clock.now();
        self.rescue.recent.retain(|at| now - *at < WHILE);
        self.rescue.recent.push_back(now);
        let Some(robot) = robot else { return self.give_up(&said, "no robot can be named") };
        if self.rescue.recent.len() > MOST {
            return self.give_up(&said, "it happens again and again");
        }
        // What was decided before is in the journal soon, or the journal's own alarm says why not.
        while !self.journal.is_settled() {
            tokio::select! {
                () = self.journal.confirmed() => {}
                _ = stop.wait_for(|stop| *stop) => {
                    // The last step must not be one of a fleet that a panic left half-way.
                    self.rescue.broken = true;
                    return;
                }
            }
        }
        let (map, settings) = (self.fleet.warehouse().clone(), self.fleet.settings().clone());
        let empty = Ledger::new(map, settings.clearance(), false);
        let loaded = match self.store.load(empty).await {
            Ok(loaded) => loaded,
            Err(e) => return self.give_up(&said, &format!("the journal cannot be read: {e}")),
        };
        let now = self.clock.now();
        let anew = catch_unwind(AssertUnwindSafe(|| {
            let (ledger, facts) = loaded.into_parts();
            let mut fleet = Fleet::resume(ledger, settings, facts);
            fleet.fence(robot, now);
            fleet
        }));
        match anew {
            Ok(fleet) => {
                tracing::error!(
                    ?robot,
                    "the fleet was rebuilt from the journal, and the robot is fenced off"
                );
                self.fleet = fleet;
                self.outbox.forget_orders(robot);
            }
            Err(again) => self.give_up(&panic_text(&*again), "the journal contradicts itself"),
        }
    }

    /// Nothing is decided any more; what is left is to tell the robots to stand, and to say so.
    fn give_up(&mut self, said: &str, why: &str) {
        let text = sentence::fleet_contradicts_itself(said, why);
        self.alarms.raise(AlarmKind::Broken, text, self.clock.now());
        // Nothing may look at what a panic left half-way.
        self.fleet = Fleet::new(self.fleet.warehouse().clone(), self.fleet.settings().clone());
        self.rescue.broken = true;
    }

    /// What is left of a turn when nothing is decided: requests are refused, robots that drive are told to stand.
    pub(super) fn turn_broken(&mut self, now: Time) {
        let asked = self.inbox.drain(true);
        self.inbox.forget(&Asked::of(&asked).all());
        let seen = catch_unwind(AssertUnwindSafe(|| self.world.advance(now, &self.fleet)));
        self.inbox.look(&mut Vec::new());
        self.stand(drivers(&seen.unwrap_or_default()).collect());
    }
}

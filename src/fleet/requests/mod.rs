//! What is asked for becomes a fact or a refusal: jobs, robots that join, workers and their assignments, closures, what
//! operators and stations say.
//!
//! Main function: [`absorb`]; main type: [`Heard`]. Refuses: to decide anything about robots.

mod absorb;
mod enrolment;
mod operator;
mod station;
mod workers;

use crate::fleet::state::core::Core;
use crate::fleet::state::io::Input;
use crate::human::Sighting;
use crate::id::{RobotId, WorkerId};
use crate::time::Time;
use crate::warehouse::walkway::Walkways;

/// What was heard of one worker, in order.
#[derive(Clone, Copy, Debug)]
pub(in crate::fleet) enum OfWorker {
    /// A worker was seen.
    Seen(Sighting),
    /// What was believed of a worker is wrong.
    Cleared(WorkerId),
}

/// What inputs mean for other rooms.
#[derive(Debug, Default)]
pub(in crate::fleet) struct Heard {
    /// What was heard of workers.
    pub people: Vec<OfWorker>,
    /// Robots from whose rack has been picked.
    pub picked: Vec<RobotId>,
    /// Robots that may go on earlier than planned.
    pub left_early: Vec<RobotId>,
}

/// Inputs as they are taken in.
struct Intake<'a> {
    core: &'a mut Core,
    walkways: &'a Walkways,
    heard: Heard,
}

/// Takes all inputs in: observations of robots go to the scene, requests become facts or refusals. `walkways` is where
/// workers can walk.
pub(in crate::fleet) fn absorb(core: &mut Core, walkways: &Walkways, now: Time, inputs: Vec<Input>) -> Heard {
    let mut intake = Intake { core, walkways, heard: Heard::default() };
    intake.take_in(now, inputs);
    intake.heard
}

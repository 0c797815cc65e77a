//! Questions to the fleet whose answers are not in the view.
//!
//! Main types: [`Question`], [`AnswerAt`]. Refuses: questions that change anything.

use giveway_fleet::{Area, ClosingEffect, Closure, Fleet, NodeOccupancy, Waiting};
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::{Span, Time};
use tokio::sync::oneshot;

/// A question about what is too large for every view: the thread that owns the fleet computes the answer on request,
/// from the fleet's current state. Questions change nothing, and a replay answers them, too.
#[derive(Debug)]
pub enum Question {
    /// Why a robot does not go on.
    Robot(RobotId, oneshot::Sender<WaitChain>),
    /// Why a job does not go on.
    Job(JobId, oneshot::Sender<WaitChain>),
    /// What closing an area would do.
    Closing(Closure, oneshot::Sender<AnswerAt<ClosingEffect>>),
    /// The occupancy of an area's nodes, for this long ahead.
    Occupancy(Area, Span, oneshot::Sender<AnswerAt<Result<Vec<NodeOccupancy>, usize>>>),
}

/// A wait chain, link by link.
pub type WaitChain = AnswerAt<Vec<Waiting>>;

/// An answer and the time at which it was true.
#[derive(Clone, Debug, PartialEq)]
pub struct AnswerAt<T> {
    /// The time at which the answer was true.
    pub at: Time,
    /// The answer.
    pub what: T,
}

impl Question {
    /// Answers the question; a receiver that is gone is no error.
    pub fn answer(self, fleet: &Fleet, at: Time) {
        match self {
            Question::Robot(robot, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.waits(robot, at) });
            }
            Question::Job(job, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.job_waits(job, at) });
            }
            Question::Closing(area, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.effect_of_closing(&area, at) });
            }
            Question::Occupancy(area, ahead, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.occupancy(area, ahead, at) });
            }
        }
    }
}

/// The most questions that wait.
pub const QUESTIONS: usize = 64;

/// The most questions that are answered between two steps: robots come first.
pub const QUESTIONS_AT_ONCE: usize = 4;

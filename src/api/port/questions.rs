//! Questions to the fleet whose answers are not in the view.
//!
//! Main types: [`Question`], [`AnswerAt`]. Refuses: questions that change anything.

use giveway_fleet::{Area, ClosingEffect, Closure, Fleet, NodeOccupancy, Waiting};
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::{Span, Time};
use tokio::sync::oneshot;

/// What is too much to be in every view: the thread that owns the fleet works it out on request, from the fleet as it
/// is then. Questions change nothing, and a replay answers them, too.
#[derive(Debug)]
pub enum Question {
    /// Why a robot does not go on.
    Robot(RobotId, oneshot::Sender<WaitChain>),
    /// Why a job does not go on.
    Job(JobId, oneshot::Sender<WaitChain>),
    /// What closing an area would do.
    Closing(Closure, oneshot::Sender<AnswerAt<ClosingEffect>>),
    /// What holds the nodes of an area, for so long ahead.
    Occupancy(Area, Span, oneshot::Sender<AnswerAt<Result<Vec<NodeOccupancy>, usize>>>),
}

/// A wait chain, link by link.
pub type WaitChain = AnswerAt<Vec<Waiting>>;

/// An answer, and when it was so.
#[derive(Clone, Debug, PartialEq)]
pub struct AnswerAt<T> {
    /// When.
    pub at: Time,
    /// What.
    pub what: T,
}

impl Question {
    /// Answers it; a receiver that is gone is no error.
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

/// How many questions may wait.
pub const QUESTIONS: usize = 64;

/// How many questions are answered between two steps: robots come first.
pub const QUESTIONS_AT_ONCE: usize = 4;

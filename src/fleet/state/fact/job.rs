//! What happens to a job.
//!
//! Main type: [`JobFact`]. Refuses: which change of a job's state may follow which; `life` knows that.

use super::robot::Task;
use crate::state::job::{JobRequest, JobState, RobotChoice};
use crate::state::job_kind::JobKind;
use giveway_cell::LineChange;
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::Time;

/// Something that happened to a job.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum JobFact {
    /// A job was accepted. Jobs are numbered in order of acceptance.
    Accepted {
        /// The new number.
        job: JobId,
        /// What is wanted.
        request: JobRequest,
        /// Time of the fact.
        at: Time,
    } = 1,
    /// A job changed its state, and the robot that serves or served it changed its task: one fact, so that the two
    /// never disagree.
    Progressed {
        /// The job.
        job: JobId,
        /// The new state.
        state: JobState,
        /// The robot whose task changes with the state, and its new task.
        tasked: Option<(RobotId, Task)>,
        /// Time of the fact.
        at: Time,
    } = 2,
    /// A rack was served at a station and is wanted at another one: its robot goes there, and the job goes on.
    Served {
        /// The job.
        job: JobId,
        /// The robot, and its task to go to the next station.
        tasked: (RobotId, Task),
        /// Time of the fact.
        at: Time,
    } = 3,
    /// An operator said which robots may do a job that no robot has yet.
    Chosen {
        /// The job.
        job: JobId,
        /// The robots.
        choice: RobotChoice,
        /// Time of the fact.
        at: Time,
    } = 4,
    /// A waiting job got another priority.
    Prioritised {
        /// The job.
        job: JobId,
        /// 0 to 9.
        priority: u8,
        /// Time of the fact.
        at: Time,
    } = 34,
    /// A waiting job was changed in more than its priority.
    Changed {
        /// The job.
        job: JobId,
        /// What is wanted now.
        kind: JobKind,
        /// The new priority, 0 to 9.
        priority: u8,
        /// The new deadline of the job, if it has one.
        deadline: Option<Time>,
        /// Time of the fact.
        at: Time,
    } = 35,
    /// A line of the visit at which the job's rack stands has changed.
    LineChanged {
        /// The job.
        job: JobId,
        /// The line of this visit, counted from 0.
        line: usize,
        /// What is said about the line.
        change: LineChange,
        /// Time of the fact.
        at: Time,
    } = 46,
}

//! Answers of the master to what robots ask for, 3.0.
//!
//! Main types: [`Response`], [`Grant`]. Refuses: to know what was asked.

/// An answer to a request of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Response {
    /// The request's id.
    pub request: String,
    /// The answer.
    pub grant: Grant,
    /// When a grant ends, microseconds since 1970 in UTC; nothing if it does not end by itself. Milliseconds are
    /// written.
    pub until_us: Option<i64>,
}

/// What a master answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grant {
    /// The robot may.
    Granted,
    /// The master knows that the robot asks, and has not decided.
    Queued,
    /// The robot may no more. The master counts it as granted until the robot's state says that it is not.
    Revoked,
    /// The robot may not.
    Rejected,
}

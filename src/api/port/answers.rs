//! Answers that are kept for requests that must be carried out only once.
//!
//! Main types: [`AnswerPort`], [`KeyedRequest`], [`KnownRequest`]. Refuses: to know what the requests are about.

use crate::port::Later;
use giveway_floor::time::Time;

/// A request that must be carried out only once.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct KeyedRequest {
    /// The caller; keys of different callers are independent.
    pub caller: String,
    /// The route.
    pub route: String,
    /// The key.
    pub key: String,
}

/// An answer that is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptAnswer {
    /// The HTTP status.
    pub status: u16,
    /// The `Location` of the thing created.
    pub location: Option<String>,
    /// The body, as JSON.
    pub body: String,
}

/// What is known about a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KnownRequest {
    /// Nothing was known: the request is now recorded as begun.
    New,
    /// The key came before with another body.
    Other,
    /// The request is being carried out.
    Running,
    /// The request had begun when the server ended, or its outcome could not be determined.
    Unknown,
    /// The request came before and got this answer.
    Answered(KeptAnswer),
}

/// Keeps the answers to requests that must be carried out only once. Errors are texts for people.
pub trait AnswerPort: Send + Sync {
    /// What is known about a request whose body has this digest. If nothing is, the request is recorded as begun.
    fn begin(
        &self,
        request: KeyedRequest,
        digest: String,
        now: Time,
    ) -> Later<'_, Result<KnownRequest, String>>;
    /// Keeps the answer to a request that began.
    fn finish(&self, request: KeyedRequest, answer: KeptAnswer) -> Later<'_, ()>;
    /// Forgets a request that changed nothing: the client may try again.
    fn forget(&self, request: KeyedRequest) -> Later<'_, ()>;
    /// Records that a request's outcome is unknown.
    fn leave(&self, request: &KeyedRequest);
}

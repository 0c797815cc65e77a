//! Answers that are kept for requests that are to be carried out once.
//!
//! Main types: [`AnswerPort`], [`KeyedRequest`], [`KnownRequest`]. Refuses: to know what is asked.

use crate::port::Later;
use giveway_floor::time::Time;

/// A request that is to be carried out once.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct KeyedRequest {
    /// Who asked; keys of different callers have nothing to do with one another.
    pub caller: String,
    /// The route.
    pub route: String,
    /// The key.
    pub key: String,
}

/// An answer that is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptAnswer {
    /// Its status.
    pub status: u16,
    /// Where what was made is.
    pub location: Option<String>,
    /// Its body, JSON.
    pub body: String,
}

/// What is known of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KnownRequest {
    /// Nothing: it is noted now that it has begun.
    New,
    /// It came before with another body.
    Other,
    /// It is being carried out.
    Running,
    /// It had begun when the server ended, or its answer was that nobody knows.
    Unknown,
    /// It came before, with this answer.
    Answered(KeptAnswer),
}

/// Keeps the answers to requests that are to be carried out once. Errors are texts for people.
pub trait AnswerPort: Send + Sync {
    /// What is known of a request whose body has this digest. If nothing is, it is noted that it begins.
    fn begin(
        &self,
        request: KeyedRequest,
        digest: String,
        now: Time,
    ) -> Later<'_, Result<KnownRequest, String>>;
    /// Keeps the answer of a request that began.
    fn finish(&self, request: KeyedRequest, answer: KeptAnswer) -> Later<'_, ()>;
    /// Forgets a request that came to nothing: it may be tried again.
    fn forget(&self, request: KeyedRequest) -> Later<'_, ()>;
    /// Leaves open what came of a request.
    fn leave(&self, request: &KeyedRequest);
}

//! What the API needs from the program that runs it, independent of the caller: the clock, the fleet at one moment,
//! answers to questions about it and about links, answers to repeated requests, trials of maps.
//!
//! Main types: [`Now`], [`Later`], `moment::Moment`, `questions::Question`, `answers::AnswerPort`, `trial::Trials`. It
//! is the lowest room: parts that know the caller are in `access` and `state`. Refuses: to know what answers, and to
//! know callers, words and HTTP.

pub mod answers;
pub mod linked;
pub mod moment;
pub mod questions;
pub mod trial;

use giveway_floor::time::Time;
use std::pin::Pin;
use std::sync::Arc;

/// An answer that comes later.
pub type Later<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// Reads the clock of the program that runs the API.
pub type Now = Arc<dyn Fn() -> Time + Send + Sync>;

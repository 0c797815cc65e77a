//! How single values are written and read on the wire: ids, times, words, sentences, parts of requests, and problems.
//!
//! Main types: [`error::Problem`], [`extract::JsonBody`]; main functions: [`text::time_text`], [`text::job_name`].
//! Refuses: to know the caller, and what stands on the floor.

pub mod error;
pub mod extract;
pub mod sentence;
pub mod text;
pub mod words;

//! Access control: callers and their roles, tokens and sessions, wrong secrets, pseudonyms, the audit.
//!
//! Main types: [`caller::Caller`], [`caller::Role`], [`auth::Gate`], [`audit::AuditLog`], [`pseudonyms::Pseudonyms`];
//! [`roles`] is the table of routes, [`tokens`] the port that keeps tokens. Refuses: to know more of a request than its
//! route.

pub mod acts;
pub mod audit;
pub mod auth;
pub mod caller;
pub mod cookie;
pub mod peer;
pub mod pseudonyms;
pub mod roles;
pub mod secrets;
pub mod tokens;

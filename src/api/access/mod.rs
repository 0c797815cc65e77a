//! Who may do what, and who did: callers and their roles, tokens and sessions, wrong secrets, pseudonyms, the audit.
//!
//! Main types: [`caller::Caller`], [`caller::Role`], [`auth::Gate`], [`audit::AuditLog`], [`pseudonyms::Pseudonyms`];
//! [`roles`] is the table of routes, [`tokens`] where tokens are kept. Refuses: to know what a request is about beyond
//! its route.

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

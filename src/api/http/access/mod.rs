//! Handlers for access: sessions, signing in with an identity provider, tokens, the audit.
//!
//! Main types: [`session::SessionDto`], [`tokens::NewToken`]. Refuses: to decide what a role may do.

pub mod audit;
pub mod oidc;
pub mod session;
pub mod tokens;

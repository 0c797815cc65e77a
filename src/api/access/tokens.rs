//! The port that keeps named tokens and sessions.
//!
//! Main type: [`TokenPort`]. Refuses: to know how they are kept.

use crate::access::caller::{NamedToken, TokenHash, WebSession};
use crate::port::Later;

/// Keeps named tokens and sessions. A change is in force when its answer arrives. Errors are texts for people.
pub trait TokenPort: Send + Sync {
    /// All tokens, including invalid ones, in the order in which they were added.
    fn list(&self) -> Later<'_, Result<Vec<NamedToken>, String>>;
    /// Adds a token, whose number and time of creation are filled in; nothing if another valid token has its name.
    fn add(&self, new: NamedToken) -> Later<'_, Result<Option<NamedToken>, String>>;
    /// Revokes a token. False if there is none of this number that was not revoked.
    fn revoke(&self, id: i64) -> Later<'_, Result<bool, String>>;
    /// Replaces a valid token by another one, known by its digest; nothing if there is no such token.
    fn rotate(&self, id: i64, hash: TokenHash) -> Later<'_, Result<Option<NamedToken>, String>>;
    /// Begins a session.
    fn sign_in(&self, session: WebSession) -> Later<'_, Result<(), String>>;
    /// Ends a session.
    fn sign_out(&self, hash: TokenHash) -> Later<'_, Result<(), String>>;
}

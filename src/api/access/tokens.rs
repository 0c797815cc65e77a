//! Where named tokens and sessions are kept.
//!
//! Main type: [`TokenPort`]. Refuses: to know how.

use crate::access::caller::{NamedToken, TokenHash, WebSession};
use crate::port::Later;

/// Keeps named tokens and sessions. What it answers is in force already. Errors are texts for people.
pub trait TokenPort: Send + Sync {
    /// All tokens, also those that no longer hold, in the order in which they were added.
    fn list(&self) -> Later<'_, Result<Vec<NamedToken>, String>>;
    /// Adds one whose number, and time of making, are not known yet; nothing where another one of its name holds.
    fn add(&self, new: NamedToken) -> Later<'_, Result<Option<NamedToken>, String>>;
    /// Revokes one. Whether there was such a one that was not revoked.
    fn revoke(&self, id: i64) -> Later<'_, Result<bool, String>>;
    /// Puts another token, known by its digest, in the place of one that holds; nothing where there is no such one.
    fn rotate(&self, id: i64, hash: TokenHash) -> Later<'_, Result<Option<NamedToken>, String>>;
    /// Begins a session.
    fn sign_in(&self, session: WebSession) -> Later<'_, Result<(), String>>;
    /// Ends one.
    fn sign_out(&self, hash: TokenHash) -> Later<'_, Result<(), String>>;
}

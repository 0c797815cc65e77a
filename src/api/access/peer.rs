//! What connections and the API tell each other about a request: where it comes from, who asked, what is sent.
//!
//! Main types: [`Peer`], [`Recognised`], [`SharedBody`]. All travel as extensions of requests and answers. Refuses: to
//! decide what follows from them; the budget of connections does.

use std::net::IpAddr;

/// The address from which a request comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peer(pub IpAddr);

/// The caller of this answer was recognised, by a token, a session, or as this machine where none is needed. Routes
/// that are open to everybody recognise nobody.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recognised;

/// The body of this answer is in memory once, however many clients are being sent it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedBody;

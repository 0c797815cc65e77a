//! What connections and the API tell each other about a request: its address, whether its caller is known, its body.
//!
//! Main types: [`Peer`], [`Recognised`], [`SharedBody`]. All travel as extensions of requests and answers. Refuses: to
//! decide what follows from them; the budget of connections does.

use std::net::IpAddr;

/// The address from which a request comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peer(pub IpAddr);

/// The caller of this answer was recognised: by a token, a session, or as this machine if none is needed. Open routes
/// recognise no caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recognised;

/// The body of this answer is in memory once, however many clients receive it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedBody;

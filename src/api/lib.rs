//! The server's API: HTTP under `/v1`, the live feed, the feeds of headsets, metrics, the API's description, and the
//! web page.
//!
//! Main types: [`Api`] (what handlers share), [`router`]. Each folder is a room, and each knows those before it in this
//! list: `port`, `wire`, `access`, `dto`, `outgoing`, `oidc`, `live`, `recording`, `feed`, `page`, `state`, `http`.
//! `tests/walls/rooms.rs` has the table and enforces it. Reads use the latest view or the durable lists; writes queue a
//! request and answer when its facts are durable. Refuses: to decide anything about robots, and to know store or
//! server.

pub mod access;
mod dto;
mod feed;
mod http;
mod live;
mod oidc;
pub mod outgoing;
pub mod page;
mod port;
pub mod recording;
mod state;
pub mod wire;

pub use access::audit::{AuditEntry, AuditLog, AuditQuery};
pub use access::auth::Gate;
pub use access::caller::{Caller, MOST_TOKENS, NamedToken, Role, SessionHolder, TokenHash, WebSession};
pub use access::peer::{Peer, Recognised, SharedBody};
pub use access::pseudonyms::{NamedPerson, PersonPort, Pseudonyms};
pub use access::tokens::TokenPort;
pub use dto::building::map_version;
pub use dto::names::Names;
pub use feed::hub::{Feeds, HeardHands, HeardSighting, Told};
pub use feed::massrobotics::{Datum, Interop};
pub use http::operate::health::alive;
pub use http::router;
pub use live::{Frame, Live};
pub use oidc::{Oidc, OidcSettings};
pub use outgoing::Outgoing;
pub use outgoing::targets::{Network, Targets};
pub use outgoing::webhooks::{FailedMessage, HookReply, HookRequest, Taken, Webhook, WebhookAccess};
pub use port::answers::{AnswerPort, KeptAnswer, KeyedRequest, KnownRequest};
pub use port::linked::{
    ActionFate, FigureRow, LINK_QUESTIONS, LinkQuestion, LinkTally, LinkedRobot, NewLinked, NotDone,
    NoticedOfRobot, OperatorAction, RobotTrust, SaidError, SaidMessage, SaidState, UnlistedRobot,
};
pub use port::moment::{FloorSimulation, LoopFigures, Moment, SharedHistory};
pub use port::questions::{AnswerAt, QUESTIONS, QUESTIONS_AT_ONCE, Question, WaitChain};
pub use port::trial::{NoTrial, Simulate, TrialFigures, TrialOrder, Trials};
pub use port::{Later, Now};
pub use state::alarms::Alarms;
pub use state::api::Api;
pub use state::kind_checks::KindChecks;
pub use state::metrics::Metrics;
pub use state::publish::{MapDone, MapOrder, MapOrigin, MapOutlook, MapPort, MapRefusal, MapRequest};
pub use state::records::{QueuedRequest, Records};
pub use wire::error::Problem;

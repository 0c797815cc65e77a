//! Messages of the server to headsets: JSON texts with a `type`.
//!
//! Main type: [`FeedMessage`]. Refuses: to decide what headsets are told.

use super::lights::CellLightsDto;
use super::wire::PoseFrame;
use crate::dto::guidance::GuidanceDto;
use crate::wire::sentence::SentenceSchema;
use giveway_floor::text::Sentence;
use serde::Serialize;
use utoipa::ToSchema;

/// A message to a headset.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum FeedMessage {
    /// The answer to `hello`.
    Welcome {
        /// The version of the protocol that both sides speak.
        version: u32,
        /// The worker.
        #[schema(example = "w1")]
        worker: String,
        /// The name under which the worker was registered.
        name: Option<String>,
        /// The frame of the client's poses.
        frame: PoseFrame,
        /// The alignment to which poses belong.
        epoch: u32,
        /// Whether the position of the device's frame on the map is known.
        aligned: bool,
        /// The most poses per second that are useful.
        rate_hz: u32,
    },
    /// Asks for a `pong`, which tells how the clocks differ.
    Ping {
        /// The ping's number.
        id: u64,
    },
    /// The device's clock is now known, or it has jumped.
    Clock {
        /// How wrong the times of poses may be, milliseconds.
        error_ms: f64,
        /// Whether the clock has jumped.
        jumped: bool,
    },
    /// The device's frame is aligned with the map.
    Aligned {
        /// The alignment to which poses belong from here on.
        epoch: u32,
        /// How far the device's frame is turned against the map, radians.
        theta: f64,
        /// Where the origin of the device's frame is on the map, metres.
        shift: [f64; 2],
        /// Root mean square of the marks' errors, metres.
        rms_m: f64,
        /// One standard deviation of `theta`, radians.
        heading_error: f64,
        /// Marks that were left out, by position in the list.
        dropped: Vec<usize>,
        /// Whether the marks lie on one line, so that an axis of the device may be mirrored: robots then give way on
        /// both sides of the line, until a mark beside the line, another source or the map shows which side is right.
        provisional: bool,
    },
    /// No alignment fits the marks.
    Refused {
        /// What is refused: `anchors`.
        what: &'static str,
        /// Why it is refused.
        #[schema(value_type = SentenceSchema)]
        reason: Sentence,
        /// What the wearer can do.
        #[schema(value_type = SentenceSchema)]
        remedy: Sentence,
        /// The alignment that stays in use.
        epoch: u32,
        /// Whether there is an alignment.
        aligned: bool,
    },
    /// The answer to `reset`.
    Epoch {
        /// The alignment to which poses belong from here on.
        epoch: u32,
        /// Whether the position of the device's frame on the map is known.
        aligned: bool,
    },
    /// Guidance for the worker: sent at once when it changed, else four times a second.
    Guidance(Box<GuidanceDto>),
    /// What to pick at the wearer's station, sent at once when it changed. A client sends hands from a message that
    /// asks for them until a message that does not.
    Cell(Box<CellLightsDto>),
    /// The answer to `done`.
    Done {
        /// The assignment.
        #[schema(example = "a3")]
        assignment: String,
        /// Why the assignment could not be finished; null if it is done.
        #[schema(value_type = Option<SentenceSchema>)]
        refused: Option<Sentence>,
    },
    /// A fault in what the headset sends.
    Warning {
        /// The kind of fault, in a word.
        #[schema(example = "too-old")]
        code: String,
        /// How many faults of this kind occurred since the last warning about it.
        count: u64,
        /// What is wrong, and what to do.
        #[schema(value_type = SentenceSchema)]
        text: Sentence,
    },
    /// The last message before the server closes the connection.
    Error {
        /// Why the server closes the connection.
        #[schema(value_type = SentenceSchema)]
        text: Sentence,
    },
}

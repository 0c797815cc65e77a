//! What the server says to headsets, as it travels: JSON texts with a `type`.
//!
//! Main type: [`FeedMessage`]. Refuses: to decide what is said.

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
        /// The version of the protocol that both speak.
        version: u32,
        /// The worker.
        #[schema(example = "w1")]
        worker: String,
        /// The name under which the worker was registered.
        name: Option<String>,
        /// Which frame poses are in.
        frame: PoseFrame,
        /// The alignment to which poses belong.
        epoch: u32,
        /// Whether the device's frame is known.
        aligned: bool,
        /// Poses a second that are of use.
        rate_hz: u32,
    },
    /// Asks for a `pong`, which tells how the clocks differ.
    Ping {
        /// Its number.
        id: u64,
    },
    /// The device's clock is known, or it jumped.
    Clock {
        /// How wrong the times of poses may be, milliseconds.
        error_ms: f64,
        /// Whether it jumped.
        jumped: bool,
    },
    /// The device's frame is aligned with the map.
    Aligned {
        /// The alignment to which poses belong from here on.
        epoch: u32,
        /// How far the frame is turned, radians.
        theta: f64,
        /// Where its origin is on the map, metres.
        shift: [f64; 2],
        /// How far the marks are off, root of the mean square, metres.
        rms_m: f64,
        /// One standard deviation of `theta`, radians.
        heading_error: f64,
        /// Marks that were left out, by position in the list.
        dropped: Vec<usize>,
        /// Whether the marks lie on one line and an axis of the device may be exchanged: then robots give way on both
        /// sides of the line, until a mark beside it, another source or the map shows which is right.
        provisional: bool,
    },
    /// The marks make no alignment.
    Refused {
        /// What is refused: `anchors`.
        what: &'static str,
        /// Why.
        #[schema(value_type = SentenceSchema)]
        reason: Sentence,
        /// What to do.
        #[schema(value_type = SentenceSchema)]
        remedy: Sentence,
        /// The alignment that stays.
        epoch: u32,
        /// Whether there is one.
        aligned: bool,
    },
    /// The answer to `reset`.
    Epoch {
        /// The alignment to which poses belong from here on.
        epoch: u32,
        /// Whether the device's frame is known.
        aligned: bool,
    },
    /// What the worker is told: at once when it changed, else four times a second.
    Guidance(Box<GuidanceDto>),
    /// What is to be picked where the wearer stands, at once when it changed. Hands are wanted from a message that says
    /// so to the next one that does not.
    Cell(Box<CellLightsDto>),
    /// The answer to `done`.
    Done {
        /// The assignment.
        #[schema(example = "a3")]
        assignment: String,
        /// Why it is not done; null if it is.
        #[schema(value_type = Option<SentenceSchema>)]
        refused: Option<Sentence>,
    },
    /// Something is wrong with what the headset sends.
    Warning {
        /// What kind of fault, in a word.
        #[schema(example = "too-old")]
        code: String,
        /// How often since the last one.
        count: u64,
        /// What, and what to do.
        #[schema(value_type = SentenceSchema)]
        text: Sentence,
    },
    /// The last message before the server closes the connection.
    Error {
        /// Why.
        #[schema(value_type = SentenceSchema)]
        text: Sentence,
    },
}

//! Robots of other vendors: what their link knows of them, as JSON.
//!
//! Main types: [`LinkedRobotDto`], [`UnlistedRobotDto`]. Refuses: to judge what a robot says.

use crate::port::linked::{
    ActionFate, FigureRow, LinkedRobot, NoticedOfRobot, SaidError, SaidMessage, SaidState, UnlistedRobot,
};
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::time_text;
use giveway_floor::text::Sentence;
use serde::Serialize;
use utoipa::ToSchema;

/// A robot that speaks VDA 5050: who it is, whether it is commanded, and what it says.
#[derive(Debug, Serialize, ToSchema)]
pub struct LinkedRobotDto {
    /// The robot's name on the floor.
    #[schema(example = "tug-1")]
    pub id: String,
    /// The manufacturer, as in the robot's topics.
    #[schema(example = "acme")]
    pub manufacturer: String,
    /// The serial number, as in the robot's topics.
    #[schema(example = "0001")]
    pub serial: String,
    /// The robot's kind.
    #[schema(example = "tug")]
    pub kind: String,
    /// The version of the protocol that is spoken with the robot.
    #[schema(example = "2.1.0")]
    pub version: String,
    /// Whether the robot has joined the fleet: it stands on the floor, and others drive round it.
    pub joined: bool,
    /// Why the robot is not commanded; null if it is.
    #[schema(value_type = Option<SentenceSchema>)]
    pub not_ready: Option<Sentence>,
    /// Whether the robot waits for PUT /v1/robots/{id}/consent: it does not pause when told to.
    pub needs_consent: bool,
    /// The action that failed, in words. Null if none did.
    pub failed: Option<String>,
    /// Whether the robot waits for POST /v1/robots/{id}/settled: an action failed, or it refuses orders.
    pub needs_care: bool,
    /// The order that the robot has, in words.
    #[schema(example = "no order")]
    pub order: String,
    /// What the robot said in its last state; null if none has come.
    pub said: Option<SaidStateDto>,
    /// What was noticed of the robot, the newest last.
    pub noticed: Vec<NoticedDto>,
    /// How many false claims count still. Each halves the robot's longest base, and is forgiven after half an hour.
    pub false_claims: usize,
    /// How far the robot is released at most, metres.
    #[schema(example = 4.0)]
    pub longest_base_m: f64,
    /// The figures of the robot's kind, once the kind is known: what its file leaves out comes from the factsheet of
    /// the first robot of the kind, then from defaults.
    pub figures: Vec<FigureDto>,
    /// Where the robot's factsheet promises less than its kind.
    pub contradictions: Vec<String>,
}

/// A figure of a kind.
#[derive(Debug, Serialize, ToSchema)]
pub struct FigureDto {
    /// `speed`, `acceleration`, `outline` or `payload`.
    #[schema(example = "speed")]
    pub figure: &'static str,
    /// Its value with its unit; `-` if the map's outline, or any load, holds.
    #[schema(example = "1.2 m/s")]
    pub value: String,
    /// Where it comes from: `file`, `factsheet` or `default`.
    #[schema(example = "factsheet")]
    pub origin: &'static str,
}

/// What a robot says in its last state.
#[derive(Debug, Serialize, ToSchema)]
pub struct SaidStateDto {
    /// When the state arrived, RFC 3339.
    pub at: String,
    /// The operating mode.
    #[schema(example = "AUTOMATIC")]
    pub mode: String,
    /// The emergency stop.
    #[schema(example = "NONE")]
    pub e_stop: String,
    /// Whether something is in the robot's protective field.
    pub field_violation: bool,
    /// Whether the robot is paused; null if it does not say.
    pub paused: Option<bool>,
    /// The last node, as the robot names it.
    pub last_node: String,
    /// The charge, from 0 to 1; null if the robot does not say.
    pub charge: Option<f64>,
    /// Whether the robot charges.
    pub charging: bool,
    /// The loads on the robot; null if it cannot tell.
    pub loads: Option<Vec<String>>,
    /// The robot's errors, in its own words.
    pub errors: Vec<SaidErrorDto>,
    /// Whether the robot asks for a longer base.
    pub wants_base: bool,
}

/// An error that a robot reports.
#[derive(Debug, Serialize, ToSchema)]
pub struct SaidErrorDto {
    /// How bad it is: WARNING, URGENT, CRITICAL or FATAL.
    #[schema(example = "WARNING")]
    pub level: String,
    /// The error's type.
    #[schema(example = "orderError")]
    pub kind: String,
    /// The robot's words; empty if it has none.
    pub words: String,
}

/// Something that was noticed of a robot.
#[derive(Debug, Serialize, ToSchema)]
pub struct NoticedDto {
    /// When, RFC 3339.
    pub at: String,
    /// What; the robot is the subject.
    #[schema(value_type = SentenceSchema)]
    pub said: Sentence,
    /// Whether the robot claimed what is not so.
    pub is_false_claim: bool,
}

/// A robot that was heard of and that nobody listed. It is never driven.
#[derive(Debug, Serialize, ToSchema)]
pub struct UnlistedRobotDto {
    /// The manufacturer, as in the robot's topics.
    pub manufacturer: String,
    /// The serial number, as in the robot's topics.
    pub serial: String,
    /// The version in the robot's topics.
    #[schema(example = "v2")]
    pub version: String,
    /// When it was heard of last, RFC 3339.
    pub heard: String,
    /// The last word about its connection; null if none came. A broker keeps such words for ever.
    #[schema(example = "ONLINE")]
    pub connection: Option<String>,
}

/// A message from or to a robot.
#[derive(Debug, Serialize, ToSchema)]
pub struct SaidMessageDto {
    /// When it was sent or arrived, RFC 3339.
    pub at: String,
    /// Whether it is for the robot.
    pub to_robot: bool,
    /// The last level of its topic.
    #[schema(example = "state")]
    pub topic: String,
    /// The text, or its first 8,192 bytes.
    pub text: String,
}

/// What became of an action.
#[derive(Debug, Serialize, ToSchema)]
pub struct ActionFateDto {
    /// The action's id.
    pub id: String,
    /// Its type.
    #[schema(example = "initPosition")]
    pub kind: String,
    /// When it was sent, RFC 3339.
    pub sent: String,
    /// SENT if the robot has said nothing of it, else the robot's last word: WAITING, RUNNING, FINISHED, FAILED, ….
    #[schema(example = "FINISHED")]
    pub status: String,
    /// The robot's words; null if it has none.
    pub result: Option<String>,
}

impl From<FigureRow> for FigureDto {
    fn from(FigureRow { figure, value, origin }: FigureRow) -> FigureDto {
        FigureDto { figure, value, origin }
    }
}

impl From<LinkedRobot> for LinkedRobotDto {
    fn from(of: LinkedRobot) -> LinkedRobotDto {
        LinkedRobotDto {
            id: of.listed.name,
            manufacturer: of.listed.manufacturer,
            serial: of.listed.serial,
            kind: of.listed.kind,
            version: of.version,
            joined: of.joined,
            not_ready: of.not_ready,
            needs_consent: of.needs_consent,
            failed: of.failed,
            needs_care: of.needs_care,
            order: of.order,
            said: of.said.map(SaidStateDto::from),
            noticed: of.noticed.into_iter().map(NoticedDto::from).collect(),
            false_claims: of.trust.false_claims,
            longest_base_m: of.trust.longest_base_m,
            figures: of.figures.into_iter().map(FigureDto::from).collect(),
            contradictions: of.contradictions,
        }
    }
}

impl From<SaidState> for SaidStateDto {
    fn from(of: SaidState) -> SaidStateDto {
        SaidStateDto {
            at: time_text(of.at),
            mode: of.mode,
            e_stop: of.e_stop,
            field_violation: of.field_violation,
            paused: of.paused,
            last_node: of.last_node,
            charge: of.charge,
            charging: of.charging,
            loads: of.loads,
            errors: of.errors.into_iter().map(SaidErrorDto::from).collect(),
            wants_base: of.wants_base,
        }
    }
}

impl From<SaidError> for SaidErrorDto {
    fn from(of: SaidError) -> SaidErrorDto {
        SaidErrorDto { level: of.level, kind: of.kind, words: of.words }
    }
}

impl From<NoticedOfRobot> for NoticedDto {
    fn from(of: NoticedOfRobot) -> NoticedDto {
        NoticedDto { at: time_text(of.at), said: of.said, is_false_claim: of.is_false_claim }
    }
}

impl From<UnlistedRobot> for UnlistedRobotDto {
    fn from(of: UnlistedRobot) -> UnlistedRobotDto {
        UnlistedRobotDto {
            manufacturer: of.manufacturer,
            serial: of.serial,
            version: of.version,
            heard: time_text(of.heard),
            connection: of.connection,
        }
    }
}

impl From<SaidMessage> for SaidMessageDto {
    fn from(of: SaidMessage) -> SaidMessageDto {
        SaidMessageDto { at: time_text(of.at), to_robot: of.is_to_robot, topic: of.topic, text: of.text }
    }
}

impl ActionFateDto {
    /// What became of an action with this id.
    pub fn new(id: String, of: ActionFate) -> ActionFateDto {
        let ActionFate { kind, sent, status, result } = of;
        ActionFateDto { id, kind, sent: time_text(sent), status, result }
    }
}

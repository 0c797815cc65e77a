//! Robots behind a link to other vendors' robots: what the link knows of them, and what people ask of it.
//!
//! Main types: [`LinkQuestion`], [`LinkedRobot`], [`UnlistedRobot`]. The thread that owns the link answers between two
//! turns. Refuses: to know a protocol's messages beyond their text.

use giveway_floor::geometry::Pose;
use giveway_floor::text::Sentence;
use giveway_floor::time::{Span, Time};
use serde_json::Value;
use tokio::sync::oneshot;

/// Something that is asked of a link.
#[derive(Debug)]
pub enum LinkQuestion {
    /// What the link knows of a robot, by its name; nothing if it does not list the robot.
    Robot(String, oneshot::Sender<Option<LinkedRobot>>),
    /// All robots that the link lists and that have not joined, with their names.
    Waiting(oneshot::Sender<Vec<LinkedRobot>>),
    /// Robots that were heard of and that nobody listed.
    Unlisted(oneshot::Sender<Vec<UnlistedRobot>>),
    /// The last messages from and to a robot, the newest last.
    Messages(String, oneshot::Sender<Option<Vec<SaidMessage>>>),
    /// Sends a robot an action at once. The answer is the action's id.
    Act(String, OperatorAction, oneshot::Sender<Result<String, NotDone>>),
    /// What became of an action, by the robot's name and the action's id.
    Fate(String, String, oneshot::Sender<Option<ActionFate>>),
    /// Agrees that a robot drives although it does not pause when told to.
    Consent(String, oneshot::Sender<Result<(), NotDone>>),
    /// Says that people looked after a robot whose action failed.
    Settle(String, oneshot::Sender<Result<(), NotDone>>),
    /// Lists a robot, or the same robot again. The answer says whether it is new.
    List(NewLinked, oneshot::Sender<Result<bool, NotDone>>),
    /// Lists a robot no more that is not on the floor. The answer says whether it was listed so.
    Unlist(String, oneshot::Sender<bool>),
}

/// The most questions to a link that wait.
pub const LINK_QUESTIONS: usize = 64;

/// What a link counted, and how many of its robots are commanded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkTally {
    /// Messages that arrived from listed robots.
    pub heard: u64,
    /// Messages that were sent.
    pub sent: u64,
    /// Messages that could not be read.
    pub unreadable: u64,
    /// How long each order took from being sent until a state showed that its robot has it.
    pub taken: Vec<Span>,
    /// Listed robots that are commanded.
    pub ready: usize,
    /// Listed robots that are not.
    pub not_ready: usize,
}

/// Why something was not done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotDone {
    /// The link lists no such robot.
    Unknown,
    /// It cannot be done, for this reason.
    Refused(Sentence),
}

/// A robot that is to be reached by the link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NewLinked {
    /// Its name on the floor.
    pub name: String,
    /// Its manufacturer, as in its topics.
    pub manufacturer: String,
    /// Its serial number.
    pub serial: String,
    /// The name of its kind.
    pub kind: String,
    /// The version that is spoken with it; the one that it says if absent.
    pub version: Option<String>,
}

/// What a link knows of a robot that it lists.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkedRobot {
    /// Who it is.
    pub listed: NewLinked,
    /// The version that is spoken with it.
    pub version: String,
    /// Whether it has joined the fleet.
    pub joined: bool,
    /// Why it is not commanded; nothing if it is.
    pub not_ready: Option<Sentence>,
    /// Whether it waits for an operator to agree that it drives although it does not pause.
    pub needs_consent: bool,
    /// An action that failed, in words: people have to look after the robot.
    pub failed: Option<String>,
    /// Whether it waits for people: an action failed, or it refuses orders.
    pub needs_care: bool,
    /// The order that it has of us, in words.
    pub order: String,
    /// When its last state arrived, and what it says there.
    pub said: Option<SaidState>,
    /// What was noticed of it, the newest last.
    pub noticed: Vec<NoticedOfRobot>,
    /// What trust is left, and why.
    pub trust: RobotTrust,
    /// The figures of its kind, once that is known.
    pub figures: Vec<FigureRow>,
    /// Differences between what is set for its kind and what it says of itself.
    pub contradictions: Vec<String>,
}

/// A figure of a kind, and where it comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FigureRow {
    /// The word for the figure.
    pub figure: &'static str,
    /// Its value with its unit.
    pub value: String,
    /// The word for where it comes from.
    pub origin: &'static str,
}

/// What a robot says in its last state.
#[derive(Clone, Debug, PartialEq)]
pub struct SaidState {
    /// When it arrived.
    pub at: Time,
    /// The operating mode, as the protocol has it.
    pub mode: String,
    /// The emergency stop, as the protocol has it.
    pub e_stop: String,
    /// Whether something is in its protective field.
    pub field_violation: bool,
    /// Whether it is paused, if it says so.
    pub paused: Option<bool>,
    /// The last node, as it names it.
    pub last_node: String,
    /// Its charge, from 0 to 1, if it says so.
    pub charge: Option<f64>,
    /// Whether it charges.
    pub charging: bool,
    /// The loads on it, if it says so.
    pub loads: Option<Vec<String>>,
    /// Its errors.
    pub errors: Vec<SaidError>,
    /// Whether it asks for a longer base.
    pub wants_base: bool,
}

/// An error that a robot reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SaidError {
    /// How bad it is: `WARNING`, `URGENT`, `CRITICAL` or `FATAL`.
    pub level: String,
    /// Its type.
    pub kind: String,
    /// The robot's words; empty if it has none.
    pub words: String,
}

/// Something that was noticed of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoticedOfRobot {
    /// When.
    pub at: Time,
    /// What; the robot is the subject.
    pub said: Sentence,
    /// Whether the robot claimed what is not so.
    pub is_false_claim: bool,
}

/// How far a robot's claims are trusted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotTrust {
    /// False claims that count still.
    pub false_claims: usize,
    /// The longest base that it gets, metres.
    pub longest_base_m: f64,
}

/// A robot that nobody listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnlistedRobot {
    /// Its manufacturer, as in its topics.
    pub manufacturer: String,
    /// Its serial number.
    pub serial: String,
    /// The version in its topics.
    pub version: String,
    /// When it was heard of last.
    pub heard: Time,
    /// What it was last said to be: `ONLINE`, `OFFLINE`, …; nothing if no such word came.
    pub connection: Option<String>,
}

/// A message from or to a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SaidMessage {
    /// When it was sent or arrived.
    pub at: Time,
    /// Whether it is for the robot.
    pub is_to_robot: bool,
    /// The last level of its topic.
    pub topic: String,
    /// Its text.
    pub text: String,
}

/// An action that an operator sends.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorAction {
    /// Its type.
    pub kind: String,
    /// Its parameters.
    pub parameters: serde_json::Map<String, Value>,
    /// For `initPosition`: where the robot stands on the floor. The link puts it in the robot's words.
    pub place: Option<Pose>,
}

/// What became of an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActionFate {
    /// Its type.
    pub kind: String,
    /// When it was sent.
    pub sent: Time,
    /// `SENT` if the robot has not said anything of it, else the robot's word: `WAITING`, `RUNNING`, `FINISHED`, ….
    pub status: String,
    /// The robot's words.
    pub result: Option<String>,
}

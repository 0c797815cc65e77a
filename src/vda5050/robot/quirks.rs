//! What a virtual robot does otherwise than the standard says, as data.
//!
//! Main type: [`RobotQuirks`]; its default is a robot that follows the standard. Robots A (npm `vda-5050-lib`), B (PyPI
//! `vda5050-sdk`) and C (PyPI `vda5050-core`) are three real implementations whose behaviour was measured; each variant
//! names the robot that has it. Refuses: faults of the transport (delay, loss, doubling), which come from outside.

use crate::version::Version;
use serde::{Deserialize, Serialize};

/// Habits and lies of a virtual robot. The default of each field is the standard's behaviour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RobotQuirks {
    /// The key under which the robot looks for instant actions. A matter of reading: the caller, which knows the JSON,
    /// reports a message with the wrong key by [`super::VirtualRobot::receive_unreadable`].
    pub instant_actions_key: InstantActionsKey,
    /// The spelling of the allowed deviation that the robot reads. A matter of reading: the caller leaves the deviation
    /// out of an order that spells it otherwise.
    pub deviation_key: DeviationKey,
    /// Which versions the robot accepts in headers. A matter of reading: the caller, which knows the headers, reports
    /// a message of another version as [`super::GarbledMessage::WrongForm`].
    pub version_check: VersionCheck,
    /// The answer to a message that cannot be read.
    pub unreadable: UnreadableReply,
    /// How many instant actions a message may hold.
    pub instant_batch: InstantBatch,
    /// What happens with numbers as values of parameters of instant actions.
    pub numeric_parameters: NumericParameters,
    /// Whether instant actions have an effect.
    pub instant_actions: InstantHabit,
    /// How long finished instant actions are listed.
    pub instant_memory: InstantMemory,
    /// When the robot reads messages.
    pub reading: ReadingHabit,
    /// The answer to an update whose number the robot already has.
    pub equal_update: EqualUpdate,
    /// What happens with the actions of the stitching node when they are sent again.
    pub stitched_actions: StitchedActions,
    /// How an update changes the reported base.
    pub reported_base: ReportedBase,
    /// Whether an update in mid-way is driven.
    pub midway_update: MidwayUpdate,
    /// The answer to another order while one is active.
    pub other_order: OtherOrder,
    /// The type and level of errors about rejected orders.
    pub rejection_words: RejectionWords,
    /// What counts as standing on the first node of an order.
    pub start_rule: StartRule,
    /// How the heading demanded at the first node is checked.
    pub heading_check: HeadingCheck,
    /// The first state after an order was accepted.
    pub first_state: FirstState,
    /// What happens with the actions of an order.
    pub order_actions: OrderActionHabit,
    /// Which parameters `pick` and `drop` need.
    pub handling_parameters: HandlingParameters,
    /// Whether orders are accepted while the robot charges.
    pub charging_orders: ChargingOrders,
    /// What `startPause` does.
    pub pause: PauseHabit,
    /// The answer to `startPause` while the robot is paused.
    pub repeated_pause: RepeatedPause,
    /// What `cancelOrder` does.
    pub cancel: CancelHabit,
    /// The answer to `cancelOrder` without an order.
    pub idle_cancel: IdleCancel,
    /// Whether the robot stops at nodes that do not ask for it.
    pub node_stops: NodeStops,
    /// How long errors stand.
    pub error_memory: ErrorMemory,
    /// What happens when the broker is back after a loss.
    pub reconnect: ReconnectHabit,
    /// When states are sent.
    pub states: StateHabit,
    /// Whether `driving` is true when the robot drives.
    pub driving_flag: DrivingFlag,
    /// Whether `paused` is reported.
    pub paused_flag: PausedFlag,
    /// Whether a speed is reported.
    pub velocity_flag: VelocityFlag,
    /// Whether the robot says that it is localised.
    pub localized_flag: LocalizedFlag,
    /// When `newBaseRequest` is true.
    pub base_request: BaseRequestHabit,
    /// What a factsheet has. A matter of writing: see [`super::WireRobot`].
    pub factsheet_form: FactsheetForm,
}

/// The key under which a robot looks for instant actions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InstantActionsKey {
    /// `actions`: the standard since the corrections of 2.0; robots B and C.
    #[default]
    Actions,
    /// `instantActions`: robot A.
    InstantActions,
}

impl InstantActionsKey {
    /// Whether the robot understands a message that has these keys. A message with both keys suits every robot.
    pub fn understands(self, has_actions: bool, has_instant_actions: bool) -> bool {
        match self {
            InstantActionsKey::Actions => has_actions,
            InstantActionsKey::InstantActions => has_instant_actions,
        }
    }
}

/// The spelling of the allowed deviation that a robot reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeviationKey {
    /// `allowedDeviationXY`: the standard; robots B and C.
    #[default]
    UpperCase,
    /// `allowedDeviationXy`: robot A, after the schema as it was published in 2021.
    LowerCase,
}

/// Which versions a robot accepts in headers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VersionCheck {
    /// The robot accepts its own major version: robot B.
    #[default]
    OwnMajor,
    /// The robot accepts any: robot C drives orders of 3.0 that come on a topic of 2.0.
    Any,
}

impl VersionCheck {
    /// Whether a robot of a version accepts messages of another.
    pub fn accepts(self, own: Version, other: Version) -> bool {
        self == VersionCheck::Any || own.topic_level() == other.topic_level()
    }
}

/// The answer to a message that cannot be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UnreadableReply {
    /// An error of level WARNING, whatever is wrong: the standard; robot B.
    #[default]
    Warning,
    /// An error of level WARNING about a wrong form, silence about text that is no JSON: robot A.
    WarningButSilentAboutText,
    /// `JSON_DESERIALIZATION_ERROR` of level FATAL: robot C.
    Fatal,
}

/// How many instant actions a message may hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InstantBatch {
    /// A message may hold any number of actions: the standard; robots B and C.
    #[default]
    Any,
    /// The process dies of two actions that end at once: robot A.
    DiesOfTwo,
}

/// What happens with numbers as values of parameters of instant actions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NumericParameters {
    /// Numbers are read: the standard.
    #[default]
    Read,
    /// A message with a number is a parse error of level FATAL: robot C with `initPosition`.
    FatalParseError,
}

/// Whether instant actions have an effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InstantHabit {
    /// Instant actions are done, and unknown ones refused: the standard.
    #[default]
    Obeyed,
    /// Instant actions say FINISHED and do nothing, but for requests, pause and cancel: robot C with the callbacks of
    /// its own example.
    Claimed,
}

/// How long finished instant actions are listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InstantMemory {
    /// Listed until the next order before 3.0, until `clearInstantActions` since: the standard; robot B.
    #[default]
    ByVersion,
    /// Listed in five states: robot A.
    FiveStates,
    /// Listed for ever: robot C.
    ForEver,
}

/// When a robot reads messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReadingHabit {
    /// Messages are read at once: the standard; robots A and C.
    #[default]
    AtOnce,
    /// Messages are read only after the base is driven and its actions are done, late and in order: robot B.
    AtEndOfBase,
}

/// The answer to an update whose number the robot already has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EqualUpdate {
    /// The update is ignored, with a state; since 3.0 other content is an error: the standard.
    #[default]
    ByVersion,
    /// The update is ignored with a state, whatever its content: robot A.
    Ignored,
    /// The update is ignored without a state, whatever its content: robot B.
    IgnoredInSilence,
    /// The update is an error, even if the bytes are the same: robot C.
    Error,
}

/// What happens with the actions of the stitching node when they are sent again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StitchedActions {
    /// The actions are known by their ids and not done again: the standard; robots B and C.
    #[default]
    KnownById,
    /// The actions are listed a second time as WAITING, for ever, and the robot is not idle again until `cancelOrder`:
    /// robot A.
    ListedAgain,
}

/// How an update changes the reported base.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReportedBase {
    /// The reported base stays as it is: the standard; robot A.
    #[default]
    Kept,
    /// Nodes of the base that are not passed yet vanish from `nodeStates`; the robot drives over them all the same:
    /// robot B if its executor runs beside its reader, and robot C as recorded.
    Vanishes,
}

/// Whether an update in mid-way is driven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MidwayUpdate {
    /// The robot drives on along the update: the standard.
    #[default]
    Driven,
    /// The robot stands with released nodes ahead, without an error: robot B, at times, if its executor runs beside
    /// its reader.
    Strands,
}

/// The answer to another order while one is active.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OtherOrder {
    /// The other order is an error: the standard; robots B and C.
    #[default]
    Refused,
    /// An order that starts at the end of the base is stitched: robot A.
    Stitched,
}

/// The type and level of errors about rejected orders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RejectionWords {
    /// Types and levels are those of the version: the standard; robot A.
    #[default]
    ByVersion,
    /// `orderError` is the type for all but malformed orders and lower numbers: robot B.
    OrderError,
    /// `orderUpdateError` of level FATAL is the error for all, and the robot goes on obeying: robot C.
    FatalUpdateError,
}

/// What counts as standing on the first node of an order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StartRule {
    /// The distance from the node decides: the standard; robots A and C.
    #[default]
    Distance,
    /// The distance decides, unless the node is the last one with the same number: robot B.
    DistanceOrLastNode,
}

/// How the heading demanded at the first node is checked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HeadingCheck {
    /// The heading is checked if the node gives a deviation: the standard.
    #[default]
    IfDeviationGiven,
    /// The heading is always checked, within this many radians: robot A with 0.35.
    WithinRad(f64),
}

/// The first state after an order was accepted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FirstState {
    /// The first state does not list the node on which the robot stands: the standard; robot B.
    #[default]
    Settled,
    /// The first state still lists the node on which the robot stands, the second does not: robots A and C.
    ListsFirstNode,
}

/// What happens with the actions of an order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OrderActionHabit {
    /// Actions are done, and an order with an unknown one is refused: the standard; robot A.
    #[default]
    Done,
    /// Actions are done, unknown ones as if the robot knew them: robot B.
    DoneEvenUnknown,
    /// No action is done, none is listed, and the order ends as done: robot C.
    SkippedInSilence,
    /// Each action is said to be done and nothing is: what an integrator in a hurry writes.
    ClaimedNotDone,
}

/// Which parameters `pick` and `drop` need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HandlingParameters {
    /// All parameters are optional: the standard.
    #[default]
    Optional,
    /// `stationType` must begin with `floor` and `loadType` be `EPAL`; `duration` in seconds is obeyed: robot A.
    FloorAndEpal,
}

/// Whether orders are accepted while a robot charges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChargingOrders {
    /// Orders are accepted, and driving off ends the charging: the standard.
    #[default]
    Accepted,
    /// Orders are refused, even if their first action is `stopCharging`: robot A.
    Refused,
}

/// What `startPause` does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PauseHabit {
    /// The robot brakes at once: the standard; robot A.
    #[default]
    AtOnce,
    /// The robot stops at the next node.
    AtNextNode,
    /// The action fails and the robot drives on: robot C.
    FailsAndDrivesOn,
}

/// The answer to `startPause` while a robot is paused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RepeatedPause {
    /// The action says FINISHED: the standard, in which it is idempotent.
    #[default]
    Finished,
    /// The action is FAILED, with `instantActionError`: robot A.
    Failed,
}

/// What `cancelOrder` does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CancelHabit {
    /// The robot brakes at once and drops the order: the standard.
    #[default]
    AtOnce,
    /// It does so, and a pause ends with the order: robot A.
    AtOnceAndUnpauses,
    /// The robot stops at the next node and drops the order: the standard for line-guided robots.
    AtNextNode,
    /// The action says FINISHED, and the robot drives on to the end of its base: robot C.
    ClaimsAndDrivesOn,
}

/// The answer to `cancelOrder` without an order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IdleCancel {
    /// The action is FAILED, with an error: the standard; robot B.
    #[default]
    FailedWithError,
    /// The error comes without any action state: robot A.
    ErrorOnly,
    /// The action says FINISHED: robot C.
    Finished,
}

/// Whether a robot stops at nodes that do not ask for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NodeStops {
    /// The robot passes such nodes without a stop: the standard.
    #[default]
    OnDemand,
    /// The robot stops at each node: robot A for up to 200 000 µs.
    EachNode {
        /// How long the robot stands there, microseconds.
        dwell_us: i64,
    },
}

/// How long errors stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorMemory {
    /// Errors stand as the standard says, mostly until the next order is accepted: robot A.
    #[default]
    ByStandard,
    /// Errors about instant actions stand for ever, the others as the standard says: robot B.
    InstantActionsForEver,
    /// All errors stand for ever: robot C.
    ForEver,
}

/// What happens when the broker is back after a loss.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReconnectHabit {
    /// The robot says ONLINE and sends a state: the standard.
    #[default]
    Announced,
    /// The robot says no ONLINE, and the next state comes when it is due: robot A.
    Unannounced,
    /// The robot does not come back until it is rebooted: robots B and C.
    Never,
}

/// When states are sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StateHabit {
    /// States are sent on events and at least once an interval: the standard; robots A and B.
    #[default]
    EventsAndInterval,
    /// States are sent on events alone, so none after the start: robot C.
    EventsOnly,
}

/// Whether `driving` is true when a robot drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DrivingFlag {
    /// `driving` is reported as it is: the standard; robots A and B.
    #[default]
    Reported,
    /// `driving` is always false: robot C.
    AlwaysFalse,
}

/// Whether `paused` is reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PausedFlag {
    /// `paused` is reported: the standard; robots A and B.
    #[default]
    Reported,
    /// `paused` is absent: robot C.
    Absent,
}

/// Whether a speed is reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VelocityFlag {
    /// The speed is reported: robot A.
    #[default]
    Reported,
    /// The speed is absent, as the standard allows: robots B and C as recorded.
    Absent,
}

/// Whether a robot says that it is localised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LocalizedFlag {
    /// Localisation is reported as it is: the standard; robots A and B.
    #[default]
    Reported,
    /// Localisation is always denied, with a right position beside it: robot C as recorded.
    AlwaysFalse,
}

/// When `newBaseRequest` is true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BaseRequestHabit {
    /// True if the robot will soon brake at the end of its base and has a horizon: the standard.
    #[default]
    WhenShort,
    /// True at the end of every base, also without a horizon: robot B.
    AtEveryEnd,
    /// Never true: robots A and C.
    Never,
}

/// What a factsheet has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FactsheetForm {
    /// The factsheet is whole: the standard.
    #[default]
    Whole,
    /// The factsheet has a header and nothing else: robot A.
    HeaderOnly,
    /// The factsheet's `loadSpecification` is null, which the schema forbids: robot C.
    LoadsAreNull,
}

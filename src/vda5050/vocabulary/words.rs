//! The words of all enumerations, in each version.
//!
//! Main type: [`WireWords`]. If a version has no word for a value, the table has the word that takes its place; such
//! rows stand behind the row to which the word belongs. Refuses: vendors' own words.

use super::WireWords;
use crate::model::action::{ActionStatus, BlockingType};
use crate::model::answer::Grant;
use crate::model::error::ErrorLevel;
use crate::model::factsheet::ActionScope;
use crate::model::state::{ConnectionState, EStop, OperatingMode, RequestStatus};

const fn same(word: &'static str) -> [Option<&'static str>; 3] {
    [Some(word); 3]
}

const fn renamed(before: &'static str, since: &'static str) -> [Option<&'static str>; 3] {
    [Some(before), Some(before), Some(since)]
}

/// What may happen beside an action of an order. `SINGLE` allows more than `HARD`, so `HARD` takes its place.
pub(crate) const BLOCKING: WireWords<BlockingType> = WireWords {
    rows: &[
        (BlockingType::None, same("NONE")),
        (BlockingType::Soft, same("SOFT")),
        (BlockingType::Hard, same("HARD")),
        (BlockingType::Single, renamed("HARD", "SINGLE")),
    ],
    careful: Some(BlockingType::Hard),
};

/// What may happen beside an instant action: 3.0 allows no word but `NONE`.
pub(crate) const INSTANT_BLOCKING: WireWords<BlockingType> = WireWords {
    rows: &[
        (BlockingType::None, same("NONE")),
        (BlockingType::Soft, renamed("SOFT", "NONE")),
        (BlockingType::Hard, renamed("HARD", "NONE")),
        (BlockingType::Single, renamed("HARD", "NONE")),
    ],
    careful: Some(BlockingType::None),
};

/// How far an action is. An unknown word concludes nothing. The schema of 2.1 has no `PAUSED`, though its text has.
pub(crate) const ACTION_STATUS: WireWords<ActionStatus> = WireWords {
    rows: &[
        (ActionStatus::Waiting, same("WAITING")),
        (ActionStatus::Initializing, same("INITIALIZING")),
        (ActionStatus::Running, same("RUNNING")),
        (ActionStatus::Finished, same("FINISHED")),
        (ActionStatus::Failed, same("FAILED")),
        (ActionStatus::Paused, [Some("PAUSED"), Some("RUNNING"), Some("PAUSED")]),
        (ActionStatus::Retriable, renamed("FAILED", "RETRIABLE")),
    ],
    careful: Some(ActionStatus::Running),
};

/// How bad an error is. After a critical one a new order can be done without a person, so it is no fatal one.
pub(crate) const ERROR_LEVEL: WireWords<ErrorLevel> = WireWords {
    rows: &[
        (ErrorLevel::Warning, same("WARNING")),
        (ErrorLevel::Fatal, same("FATAL")),
        (ErrorLevel::Urgent, renamed("WARNING", "URGENT")),
        (ErrorLevel::Critical, renamed("WARNING", "CRITICAL")),
    ],
    careful: Some(ErrorLevel::Fatal),
};

/// Who drives a robot. `MANUAL` takes the place of what takes no orders, and robots with unknown words get none.
pub(crate) const MODE: WireWords<OperatingMode> = WireWords {
    rows: &[
        (OperatingMode::Automatic, same("AUTOMATIC")),
        (OperatingMode::SemiAutomatic, same("SEMIAUTOMATIC")),
        (OperatingMode::Manual, same("MANUAL")),
        (OperatingMode::Service, same("SERVICE")),
        (OperatingMode::TeachIn, renamed("TEACHIN", "TEACH_IN")),
        (OperatingMode::Startup, renamed("MANUAL", "STARTUP")),
        (OperatingMode::Intervened, renamed("MANUAL", "INTERVENED")),
    ],
    careful: Some(OperatingMode::Manual),
};

/// A robot's emergency stop. An unknown word counts as pressed.
pub(crate) const E_STOP: WireWords<EStop> = WireWords {
    rows: &[
        (EStop::None, same("NONE")),
        (EStop::Manual, same("MANUAL")),
        (EStop::Remote, same("REMOTE")),
        (EStop::AutoAck, renamed("AUTOACK", "MANUAL")),
    ],
    careful: Some(EStop::Manual),
};

/// Whether a robot is connected. An unknown word counts as broken: such a robot may drive on to the end of its base.
pub(crate) const CONNECTION: WireWords<ConnectionState> = WireWords {
    rows: &[
        (ConnectionState::Online, same("ONLINE")),
        (ConnectionState::Offline, same("OFFLINE")),
        (ConnectionState::Broken, renamed("CONNECTIONBROKEN", "CONNECTION_BROKEN")),
        (ConnectionState::Hibernating, renamed("OFFLINE", "HIBERNATING")),
    ],
    careful: Some(ConnectionState::Broken),
};

/// How far a request is. With an unknown word nothing is granted.
pub(crate) const REQUEST_STATUS: WireWords<RequestStatus> = WireWords {
    rows: &[
        (RequestStatus::Requested, same("REQUESTED")),
        (RequestStatus::Granted, same("GRANTED")),
        (RequestStatus::Revoked, same("REVOKED")),
        (RequestStatus::Expired, same("EXPIRED")),
    ],
    careful: Some(RequestStatus::Requested),
};

/// Whether a robot asks for another way through a zone (`REPLANNING`), not for the way that it has.
pub(crate) const ZONE_REQUEST_TYPE: WireWords<bool> =
    WireWords { rows: &[(false, same("ACCESS")), (true, same("REPLANNING"))], careful: Some(false) };

/// What a master answers. With an unknown word nothing is granted.
pub(crate) const GRANT: WireWords<Grant> = WireWords {
    rows: &[
        (Grant::Granted, same("GRANTED")),
        (Grant::Queued, same("QUEUED")),
        (Grant::Revoked, same("REVOKED")),
        (Grant::Rejected, same("REJECTED")),
    ],
    careful: Some(Grant::Rejected),
};

/// The type of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ZoneWord {
    Blocked,
    Release,
    SpeedLimit,
}

/// The type of a zone. Nobody enters one with an unknown rule.
pub(crate) const ZONE_WORD: WireWords<ZoneWord> = WireWords {
    rows: &[
        (ZoneWord::Blocked, same("BLOCKED")),
        (ZoneWord::Release, same("RELEASE")),
        (ZoneWord::SpeedLimit, same("SPEED_LIMIT")),
    ],
    careful: Some(ZoneWord::Blocked),
};

/// Whether a stored zone set is in force. An unknown word says that it is not.
pub(crate) const ZONE_SET_STATUS: WireWords<bool> =
    WireWords { rows: &[(true, same("ENABLED")), (false, same("DISABLED"))], careful: Some(false) };

/// The type of all requests about edges.
pub(crate) const EDGE_REQUEST_TYPE: &str = "CORRIDOR";

/// Whether the outline must stay within a corridor, which is narrower than if the centre must.
pub(crate) const CORRIDOR_POINT: WireWords<bool> = WireWords {
    rows: &[(false, renamed("KINEMATICCENTER", "KINEMATIC_CENTER")), (true, same("CONTOUR"))],
    careful: Some(true),
};

/// Where an action may be asked for. An unknown word is no place.
pub(crate) const SCOPE: WireWords<ActionScope> = WireWords {
    rows: &[
        (ActionScope::AtOnce, same("INSTANT")),
        (ActionScope::Node, same("NODE")),
        (ActionScope::Edge, same("EDGE")),
        (ActionScope::Zone, [None, None, Some("ZONE")]),
    ],
    careful: None,
};

/// The types of zones, 3.0.
pub(crate) const ZONE_TYPES: [&str; 10] = [
    "BLOCKED",
    "LINE_GUIDED",
    "RELEASE",
    "COORDINATED_REPLANNING",
    "SPEED_LIMIT",
    "ACTION",
    "PRIORITY",
    "PENALTY",
    "DIRECTED",
    "BIDIRECTED",
];

//! The errors of a virtual robot: their types, levels and references by version, and how long they stand.
//!
//! Main types: [`StandingError`], [`OrderRejection`]. Source: VDA 5050 2.1, section 6.6.4; 3.0, sections 6.1.4, 6.6.5.
//! Refuses: to decide what is an error.

use super::VirtualRobot;
use super::quirks::{ErrorMemory, RejectionWords, UnreadableReply};
use crate::model::action::Action;
use crate::model::error::{ErrorLevel, ErrorReference, RobotError};
use crate::model::order::Order;
use crate::topic::TopicKind;
use crate::version::Version;

/// The most errors that stand at once; the oldest give way, so that no master can fill a robot's memory.
const ERRORS_MOST: usize = 100;

/// An error and the end of it.
#[derive(Clone, Debug)]
pub(super) struct StandingError {
    pub(super) error: RobotError,
    pub(super) until: ErrorEnd,
}

/// When an error is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ErrorEnd {
    /// When an order or an update is accepted.
    OrderAccepted,
    /// When an order is accepted; the error is about an instant action, which some robots never forget.
    OrderAcceptedIfForgotten,
    /// When an instant action is accepted.
    InstantActionAccepted,
    /// When orders are allowed again.
    OrdersAllowed,
    /// When the robot is localised.
    Localized,
    /// When it is granted what it has lost, or needs it no more.
    ReleaseGranted,
    /// When the robot is out of the zone.
    ZoneLeft,
}

/// Why an order is rejected.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum OrderRejection {
    /// It is not formed as an order.
    Malformed(&'static str),
    /// It has an action that the robot cannot do there, with these parameters.
    Action { id: String, kind: String },
    /// Its number is lower than the one the robot has.
    Outdated,
    /// Its number is the one the robot has, and its content is another.
    SameNumber,
    /// It is an update of an order that was cancelled.
    AfterCancel,
    /// Another order is active.
    OtherActive,
    /// It does not begin at the last released node.
    NotStitched,
    /// The robot is not at its first node.
    TooFar { node: String },
    /// A node cannot be reached.
    NoRoute { node: String },
    /// The mode does not allow orders, or the robot does not know where it is.
    NotAvailable,
    /// A node is on a map that the robot does not know.
    UnknownMap { map: String },
    /// The robot charges and takes no orders meanwhile.
    Charging,
}

impl OrderRejection {
    /// The error's type in a version.
    fn kind(&self, version: Version) -> &'static str {
        use OrderRejection as R;
        if version >= Version::V3_0 {
            return match self {
                R::Malformed(_) | R::NotStitched => "VALIDATION_FAILURE",
                R::Action { .. } => "INVALID_ORDER_ACTION",
                R::Outdated => "OUTDATED_ORDER_UPDATE",
                R::SameNumber => "SAME_ORDER_UPDATE_ID",
                R::AfterCancel => "ORDER_UPDATE_FOLLOWING_CANCEL",
                R::OtherActive => "OTHER_ORDER_ACTIVE",
                R::TooFar { .. } => "START_NODE_OUT_OF_RANGE",
                R::NoRoute { .. } => "NO_ROUTE_TO_TARGET",
                R::NotAvailable | R::Charging => "MOBILE_ROBOT_NOT_AVAILABLE",
                R::UnknownMap { .. } => "UNKNOWN_MAP_ID",
            };
        }
        match self {
            R::Malformed(_) => "validationError",
            R::Outdated | R::SameNumber | R::AfterCancel | R::NotStitched => "orderUpdateError",
            R::TooFar { .. } | R::NoRoute { .. } => "noRouteError",
            R::Action { .. } | R::OtherActive | R::NotAvailable | R::UnknownMap { .. } | R::Charging => {
                "orderError"
            }
        }
    }

    fn description(&self) -> &'static str {
        use OrderRejection as R;
        match self {
            R::Malformed(words) => words,
            R::Action { .. } => "the order has an action that the robot cannot do there",
            R::Outdated => "the robot already has a higher orderUpdateId",
            R::SameNumber => "the robot already has this orderUpdateId with other content",
            R::AfterCancel => "the order was cancelled",
            R::OtherActive => "another order is active",
            R::NotStitched => "the update does not begin at the last released node",
            R::TooFar { .. } => "the robot is not at the first node",
            R::NoRoute { .. } => "a node cannot be reached",
            R::NotAvailable => "the robot takes no orders now",
            R::UnknownMap { .. } => "a node is on an unknown map",
            R::Charging => "the robot charges",
        }
    }

    fn reference(&self) -> Option<ErrorReference> {
        use OrderRejection as R;
        match self {
            R::Action { id, .. } => Some(reference("actionId", id)),
            R::TooFar { node } | R::NoRoute { node } => Some(reference("nodeId", node)),
            R::UnknownMap { map } => Some(reference("mapId", map)),
            _ => None,
        }
    }
}

fn reference(key: &str, value: &str) -> ErrorReference {
    ErrorReference { key: key.to_owned(), value: value.to_owned() }
}

impl VirtualRobot {
    /// Reports why an order is rejected.
    pub(super) fn reject(&mut self, order: &Order, why: &OrderRejection) {
        let (kind, level) = match (self.setup.quirks.rejection_words, why) {
            (RejectionWords::FatalUpdateError, _) => ("orderUpdateError", ErrorLevel::Fatal),
            (RejectionWords::ByVersion, _)
            | (RejectionWords::OrderError, OrderRejection::Outdated | OrderRejection::Malformed(_)) => {
                (why.kind(self.setup.version), ErrorLevel::Warning)
            }
            (RejectionWords::OrderError, _) => ("orderError", ErrorLevel::Warning),
        };
        let mut references = vec![
            reference("topic", TopicKind::Order.level()),
            reference("orderId", &order.id),
            reference("orderUpdateId", &order.update.to_string()),
        ];
        references.extend(why.reference());
        if let OrderRejection::Action { kind, .. } = why {
            references.push(reference("actionType", kind));
        }
        let until = match why {
            OrderRejection::NotAvailable => ErrorEnd::OrdersAllowed,
            _ => ErrorEnd::OrderAccepted,
        };
        self.complain(kind, level, references, why.description(), until);
    }

    /// Reports that there is no order to cancel.
    pub(super) fn complain_of_cancel(&mut self, action: &Action) {
        let kind = if self.speaks_3_0() { "NO_ORDER_TO_CANCEL" } else { "noOrderToCancel" };
        let words = "there is no such active order to be cancelled";
        let until = ErrorEnd::OrderAcceptedIfForgotten;
        self.complain(kind, ErrorLevel::Warning, about_instant(action), words, until);
    }

    /// Reports that an instant action cannot be done.
    pub(super) fn complain_of_instant(&mut self, action: &Action, words: &'static str) {
        let (kind, until) = if self.speaks_3_0() {
            ("INVALID_INSTANT_ACTION", ErrorEnd::InstantActionAccepted)
        } else {
            ("instantActionError", ErrorEnd::OrderAcceptedIfForgotten)
        };
        self.complain(kind, ErrorLevel::Warning, about_instant(action), words, until);
    }

    /// Reports a message that could not be read.
    pub(super) fn complain_of_unreadable(&mut self, topic: TopicKind) {
        let (kind, level) = match self.setup.quirks.unreadable {
            UnreadableReply::Fatal => ("JSON_DESERIALIZATION_ERROR", ErrorLevel::Fatal),
            _ if self.speaks_3_0() => ("VALIDATION_FAILURE", ErrorLevel::Warning),
            _ => ("validationError", ErrorLevel::Warning),
        };
        let references = vec![reference("topic", topic.level())];
        let words = "the message could not be read";
        self.complain(kind, level, references, words, ErrorEnd::OrderAccepted);
    }

    /// Reports that the robot does not know where it is, as long as it does not.
    pub(super) fn complain_of_localization(&mut self) {
        if self.is_localized {
            self.forget_errors(&[ErrorEnd::Localized]);
            return;
        }
        let kind = if self.speaks_3_0() { "LOCALIZATION_ERROR" } else { "localizationError" };
        let words = "the robot does not know where it is";
        self.complain(kind, ErrorLevel::Fatal, Vec::new(), words, ErrorEnd::Localized);
    }

    /// An order was accepted: errors that stood until then go.
    pub(super) fn forgive_order(&mut self) {
        self.forgive_mode();
        match self.setup.quirks.error_memory {
            ErrorMemory::ByStandard => {
                self.forget_errors(&[ErrorEnd::OrderAccepted, ErrorEnd::OrderAcceptedIfForgotten]);
            }
            ErrorMemory::InstantActionsForEver | ErrorMemory::ForEver => {
                self.forget_errors(&[ErrorEnd::OrderAccepted]);
            }
        }
    }

    /// An instant action was accepted: errors that stood until then go.
    pub(super) fn forgive_instant(&mut self) {
        if self.setup.quirks.error_memory == ErrorMemory::ByStandard {
            self.forget_errors(&[ErrorEnd::InstantActionAccepted]);
        }
    }

    /// Orders are allowed again: errors that stood until then go.
    pub(super) fn forgive_mode(&mut self) {
        self.forget_errors(&[ErrorEnd::OrdersAllowed]);
    }

    pub(super) fn forget_errors(&mut self, ends: &[ErrorEnd]) {
        if self.setup.quirks.error_memory != ErrorMemory::ForEver {
            self.errors.retain(|standing| !ends.contains(&standing.until));
        }
    }

    pub(super) fn complain(
        &mut self,
        kind: &str,
        level: ErrorLevel,
        references: Vec<ErrorReference>,
        words: &str,
        until: ErrorEnd,
    ) {
        let error = RobotError {
            kind: kind.to_owned(),
            level,
            references,
            description: Some(words.to_owned()),
            hint: None,
        };
        if self.errors.iter().any(|standing| standing.error == error) {
            return;
        }
        if self.errors.len() >= ERRORS_MOST {
            self.errors.remove(0);
        }
        self.errors.push(StandingError { error, until });
    }

    pub(super) fn speaks_3_0(&self) -> bool {
        self.setup.version >= Version::V3_0
    }
}

fn about_instant(action: &Action) -> Vec<ErrorReference> {
    vec![
        reference("topic", TopicKind::InstantActions.level()),
        reference("actionId", &action.id),
        reference("actionType", &action.kind),
    ]
}

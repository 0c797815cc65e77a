//! Reads states, visualizations and connections of robots.
//!
//! Main functions: [`state`], [`visualization`], [`connection`]. What a robot does not say is taken as what least is
//! built on. Refuses: states whose remaining nodes or edges have no numbers, because without them the robot would seem
//! to have arrived; connections without a state.

use super::object::ObjectReader;
use super::oddity::Unreadable;
use crate::model::action::ActionState;
use crate::model::error::{ErrorReference, RobotError};
use crate::model::state::{
    ConnectionState, Load, NodeLeft, Position, Power, Request, RequestSubject, State, Velocity, Visualization,
};
use crate::model::zone::StoredZoneSet;
use crate::vocabulary::{WireName, names, words};

pub(super) fn state(top: &ObjectReader<'_>) -> Result<State, Unreadable> {
    let safety = top.object_or_empty(&names::SAFETY);
    Ok(State {
        order: top.text_or_empty(&names::ORDER_ID),
        update: top.count_or_zero(&names::ORDER_UPDATE),
        last_node: top.text_or_empty(&names::LAST_NODE),
        last_sequence: top.count_or_zero(&names::LAST_SEQUENCE),
        nodes: left(top, &names::NODE_STATES, &names::NODE_ID)?,
        edges: left(top, &names::EDGE_STATES, &names::EDGE_ID)?,
        actions: list_or_empty(top, &names::ACTION_STATES, action_state),
        instant_actions: instant_actions(top),
        position: top.part(&names::POSITION, position),
        velocity: top.object(&names::VELOCITY).map(|object| velocity(&object)),
        driving: top.flag_or(&names::DRIVING, false),
        paused: top.flag(&names::PAUSED),
        wants_base: top.flag(&names::NEW_BASE).unwrap_or(false),
        loads: top.readable(&names::LOADS, load),
        power: power(&top.object_or_empty(&names::POWER)),
        mode: top.word_or_careful(&names::MODE, &words::MODE)?,
        errors: list_or_empty(top, &names::ERRORS, robot_error),
        e_stop: safety.word_or_careful(&names::E_STOP, &words::E_STOP)?,
        field_violation: safety.flag_or(&names::FIELD_VIOLATION, false),
        requests: requests(top),
        zone_sets: top.readable(&names::ZONE_SETS, stored_zone_set).unwrap_or_default(),
    })
}

pub(super) fn visualization(top: &ObjectReader<'_>) -> Visualization {
    Visualization {
        state_header: top.count(&names::STATE_HEADER),
        position: top.part(&names::POSITION, position),
        velocity: top.object(&names::VELOCITY).map(|object| velocity(&object)),
    }
}

pub(super) fn connection(top: &ObjectReader<'_>) -> Result<ConnectionState, Unreadable> {
    top.word(&names::CONNECTION, &words::CONNECTION).ok_or_else(|| top.missing(&names::CONNECTION))
}

fn list_or_empty<T>(
    top: &ObjectReader<'_>,
    name: &WireName,
    read: impl FnMut(&ObjectReader<'_>) -> Result<T, Unreadable>,
) -> Vec<T> {
    top.readable(name, read).unwrap_or_else(|| top.assumed(name, "empty", Vec::new()))
}

/// Versions that have no list for instant actions have them among those of the order.
fn instant_actions(top: &ObjectReader<'_>) -> Vec<ActionState> {
    if !top.expects(&names::INSTANT_ACTION_STATES) {
        return top.readable(&names::INSTANT_ACTION_STATES, action_state).unwrap_or_default();
    }
    list_or_empty(top, &names::INSTANT_ACTION_STATES, action_state)
}

/// Nodes or edges that are left. One of which is not said whether it is released may be driven to.
fn left(top: &ObjectReader<'_>, list: &WireName, id: &WireName) -> Result<Vec<NodeLeft>, Unreadable> {
    let each = |object: &ObjectReader<'_>| {
        Ok(NodeLeft {
            id: object.text_or_empty(id),
            sequence: object.need_count(&names::SEQUENCE)?,
            released: object.flag_or(&names::RELEASED, true),
        })
    };
    let all = top.all(list, each)?;
    Ok(all.unwrap_or_else(|| top.assumed(list, "empty", Vec::new())))
}

fn action_state(object: &ObjectReader<'_>) -> Result<ActionState, Unreadable> {
    Ok(ActionState {
        id: object.need_text(&names::ACTION_ID)?,
        kind: object.text(&names::ACTION_TYPE),
        status: object.word_or_careful(&names::ACTION_STATUS, &words::ACTION_STATUS)?,
        result: object.text(&names::ACTION_RESULT),
    })
}

fn position(object: &ObjectReader<'_>) -> Result<Position, Unreadable> {
    Ok(Position {
        x: object.need_number(&names::X)?,
        y: object.need_number(&names::Y)?,
        theta: object.number_or_zero(&names::THETA),
        map: object.need_text(&names::MAP)?,
        localized: object.flag_or(&names::LOCALIZED, false),
    })
}

/// A component that is not said is 0: no version requires any of them.
fn velocity(object: &ObjectReader<'_>) -> Velocity {
    let component = |name: &WireName| object.number(name).unwrap_or(0.0);
    Velocity { vx: component(&names::VX), vy: component(&names::VY), omega: component(&names::OMEGA) }
}

fn power(object: &ObjectReader<'_>) -> Power {
    let charge = object.share(&names::CHARGE);
    Power {
        charge: charge.or_else(|| object.assumed(&names::CHARGE, "unknown", None)),
        charging: object.flag_or(&names::CHARGING, false),
    }
}

fn load(object: &ObjectReader<'_>) -> Result<Load, Unreadable> {
    Ok(Load { id: object.text(&names::LOAD_ID), kind: object.text(&names::LOAD_TYPE) })
}

fn robot_error(object: &ObjectReader<'_>) -> Result<RobotError, Unreadable> {
    let reference = |object: &ObjectReader<'_>| {
        Ok(ErrorReference {
            key: object.need_text(&names::REFERENCE_KEY)?,
            value: object.need_text(&names::REFERENCE_VALUE)?,
        })
    };
    Ok(RobotError {
        kind: object.text_or_empty(&names::ERROR_TYPE),
        level: object.word_or_careful(&names::ERROR_LEVEL, &words::ERROR_LEVEL)?,
        references: object.readable(&names::ERROR_REFERENCES, reference).unwrap_or_default(),
        description: object.text(&names::ERROR_DESCRIPTION),
        hint: object.text(&names::ERROR_HINT),
    })
}

fn stored_zone_set(object: &ObjectReader<'_>) -> Result<StoredZoneSet, Unreadable> {
    Ok(StoredZoneSet {
        id: object.need_text(&names::ZONE_SET_ID)?,
        map: object.text_or_empty(&names::MAP),
        enabled: object.word_or_careful(&names::ZONE_SET_STATUS, &words::ZONE_SET_STATUS)?,
    })
}

fn requests(top: &ObjectReader<'_>) -> Vec<Request> {
    let zones = top.readable(&names::ZONE_REQUESTS, |object| {
        let subject = RequestSubject::Zone {
            zone: object.need_text(&names::ZONE_ID)?,
            zone_set: object.text_or_empty(&names::ZONE_SET_ID),
            replanning: object.word_or_careful(&names::REQUEST_TYPE, &words::ZONE_REQUEST_TYPE)?,
        };
        request(object, subject)
    });
    let corridors = top.readable(&names::EDGE_REQUESTS, |object| {
        let subject = RequestSubject::Corridor {
            edge: object.need_text(&names::EDGE_ID)?,
            sequence: object.need_count(&names::SEQUENCE)?,
        };
        request(object, subject)
    });
    [zones, corridors].into_iter().flatten().flatten().collect()
}

fn request(object: &ObjectReader<'_>, subject: RequestSubject) -> Result<Request, Unreadable> {
    Ok(Request {
        id: object.need_text(&names::REQUEST_ID)?,
        subject,
        status: object.word_or_careful(&names::REQUEST_STATUS, &words::REQUEST_STATUS)?,
    })
}

//! Writes states and visualizations.
//!
//! Main functions: [`state`], [`visualization`]. Refuses: positions with a coordinate that is not finite.

use super::object::ObjectWriter;
use crate::model::action::ActionState;
use crate::model::error::{ErrorReference, RobotError};
use crate::model::state::{
    Load, NodeLeft, Position, Request, RequestSubject, State, Velocity, Visualization,
};
use crate::model::zone::StoredZoneSet;
use crate::vocabulary::{WireName, names, words};

pub(super) fn state(top: &mut ObjectWriter, state: &State) {
    top.put(&names::ORDER_ID, state.order.as_str());
    top.put(&names::ORDER_UPDATE, state.update);
    top.put(&names::LAST_NODE, state.last_node.as_str());
    top.put(&names::LAST_SEQUENCE, state.last_sequence);
    left(top, &names::NODE_STATES, &names::NODE_ID, &state.nodes);
    left(top, &names::EDGE_STATES, &names::EDGE_ID, &state.edges);
    action_states(top, state);
    motion(top, state.position.as_ref(), state.velocity.as_ref());
    top.put(&names::DRIVING, state.driving);
    top.put_any(&names::PAUSED, state.paused);
    top.put(&names::NEW_BASE, state.wants_base);
    if let Some(loads) = &state.loads {
        top.list(&names::LOADS, loads, |object, load: &Load| {
            object.put_any(&names::LOAD_ID, load.id.as_deref());
            object.put_any(&names::LOAD_TYPE, load.kind.as_deref());
        });
    }
    top.object(&names::POWER, |power| {
        // A charge that is not known, or no number, is written as empty: the schemas require one.
        power.share(&names::CHARGE, state.power.charge.filter(|charge| !charge.is_nan()).unwrap_or(0.0));
        power.put(&names::CHARGING, state.power.charging);
    });
    top.word(&names::MODE, &words::MODE, state.mode);
    top.list(&names::ERRORS, &state.errors, robot_error);
    top.object(&names::SAFETY, |safety| {
        safety.word(&names::E_STOP, &words::E_STOP, state.e_stop);
        safety.put(&names::FIELD_VIOLATION, state.field_violation);
    });
    requests(top, &state.requests);
    top.list(&names::ZONE_SETS, &state.zone_sets, |object, set: &StoredZoneSet| {
        object.put(&names::ZONE_SET_ID, set.id.as_str());
        object.put(&names::MAP, set.map.as_str());
        object.word(&names::ZONE_SET_STATUS, &words::ZONE_SET_STATUS, set.enabled);
    });
}

pub(super) fn visualization(top: &mut ObjectWriter, visualization: &Visualization) {
    top.put(&names::STATE_HEADER, visualization.state_header.unwrap_or(0));
    motion(top, visualization.position.as_ref(), visualization.velocity.as_ref());
}

fn left(top: &mut ObjectWriter, list: &WireName, id: &WireName, nodes: &[NodeLeft]) {
    top.list(list, nodes, |object, node: &NodeLeft| {
        object.put(id, node.id.as_str());
        object.put(&names::SEQUENCE, node.sequence);
        object.put(&names::RELEASED, node.released);
    });
}

/// A version without a list for instant actions has them behind those of the order.
fn action_states(top: &mut ObjectWriter, state: &State) {
    let instant = state.instant_actions.iter();
    if top.has(&names::INSTANT_ACTION_STATES) {
        top.list(&names::ACTION_STATES, &state.actions, action_state);
        top.list(&names::INSTANT_ACTION_STATES, instant, action_state);
    } else {
        top.list(&names::ACTION_STATES, state.actions.iter().chain(instant), action_state);
    }
}

fn action_state(object: &mut ObjectWriter, state: &ActionState) {
    object.put(&names::ACTION_ID, state.id.as_str());
    object.put_any(&names::ACTION_TYPE, state.kind.as_deref());
    object.word(&names::ACTION_STATUS, &words::ACTION_STATUS, state.status);
    object.put_any(&names::ACTION_RESULT, state.result.as_deref());
}

fn motion(top: &mut ObjectWriter, position: Option<&Position>, velocity: Option<&Velocity>) {
    let is_known = |at: &&Position| at.x.is_finite() && at.y.is_finite() && at.theta.is_finite();
    if let Some(at) = position.filter(is_known) {
        top.object(&names::POSITION, |object| {
            object.number(&names::X, at.x);
            object.number(&names::Y, at.y);
            object.angle(&names::THETA, at.theta);
            object.put(&names::MAP, at.map.as_str());
            object.put(&names::LOCALIZED, at.localized);
        });
    }
    if let Some(velocity) = velocity {
        top.object(&names::VELOCITY, |object| {
            object.number(&names::VX, velocity.vx);
            object.number(&names::VY, velocity.vy);
            object.number(&names::OMEGA, velocity.omega);
        });
    }
}

fn robot_error(object: &mut ObjectWriter, error: &RobotError) {
    object.put(&names::ERROR_TYPE, error.kind.as_str());
    object.word(&names::ERROR_LEVEL, &words::ERROR_LEVEL, error.level);
    object.list(&names::ERROR_REFERENCES, &error.references, |object, reference: &ErrorReference| {
        object.put(&names::REFERENCE_KEY, reference.key.as_str());
        object.put(&names::REFERENCE_VALUE, reference.value.as_str());
    });
    object.put_any(&names::ERROR_DESCRIPTION, error.description.as_deref());
    object.put_any(&names::ERROR_HINT, error.hint.as_deref());
}

fn requests(top: &mut ObjectWriter, requests: &[Request]) {
    let (zones, corridors): (Vec<&Request>, Vec<&Request>) =
        requests.iter().partition(|request| matches!(request.subject, RequestSubject::Zone { .. }));
    top.list(&names::ZONE_REQUESTS, zones, request);
    top.list(&names::EDGE_REQUESTS, corridors, request);
}

fn request(object: &mut ObjectWriter, request: &Request) {
    object.put(&names::REQUEST_ID, request.id.as_str());
    match &request.subject {
        RequestSubject::Zone { zone, zone_set, replanning } => {
            object.word(&names::REQUEST_TYPE, &words::ZONE_REQUEST_TYPE, *replanning);
            object.put(&names::ZONE_ID, zone.as_str());
            object.put(&names::ZONE_SET_ID, zone_set.as_str());
        }
        RequestSubject::Corridor { edge, sequence } => {
            object.put(&names::REQUEST_TYPE, words::EDGE_REQUEST_TYPE);
            object.put(&names::EDGE_ID, edge.as_str());
            object.put(&names::SEQUENCE, *sequence);
        }
    }
    object.word(&names::REQUEST_STATUS, &words::REQUEST_STATUS, request.status);
}

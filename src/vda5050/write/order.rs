//! Writes orders and instant actions.
//!
//! Main functions: [`order`], [`instant_actions`]. Refuses: corridors that a version would understand as wider or freer
//! than they are.

use super::object::ObjectWriter;
use crate::model::action::{Action, BlockingType, Parameter};
use crate::model::order::{Corridor, Edge, Node, NodePosition, Order};
use crate::vocabulary::{WireWords, names, words};
use std::f64::consts::PI;

pub(super) fn order(top: &mut ObjectWriter, order: &Order) {
    top.put(&names::ORDER_ID, order.id.as_str());
    top.put(&names::ORDER_UPDATE, order.update);
    top.list(&names::NODES, &order.nodes, node);
    top.list(&names::EDGES, &order.edges, edge);
}

pub(super) fn instant_actions(top: &mut ObjectWriter, actions: &[Action]) {
    top.list(&names::ACTIONS, actions, |object, one| action(object, one, &words::INSTANT_BLOCKING));
}

fn node(object: &mut ObjectWriter, node: &Node) {
    object.put(&names::NODE_ID, node.id.as_str());
    object.put(&names::SEQUENCE, node.sequence);
    object.put(&names::RELEASED, node.released);
    let place = node.position.as_ref().filter(|place| place.x.is_finite() && place.y.is_finite());
    if let Some(place) = place {
        object.object(&names::NODE_POSITION, |object| node_position(object, place));
    }
    actions_of(object, &node.actions);
}

fn node_position(object: &mut ObjectWriter, place: &NodePosition) {
    object.number(&names::X, place.x);
    object.number(&names::Y, place.y);
    object.angle(&names::THETA, place.theta);
    object.magnitude(&names::DEVIATION_RADIUS, place.deviation_m);
    if let Some(radius) = place.deviation_m.filter(|radius| radius.is_finite()) {
        object.object(&names::DEVIATION_ELLIPSE, |ellipse| {
            ellipse.magnitude(&names::ELLIPSE_A, radius);
            ellipse.magnitude(&names::ELLIPSE_B, radius);
            ellipse.number(&names::THETA, 0.0);
        });
    }
    object.magnitude(&names::DEVIATION_THETA, place.deviation_rad.map(|angle| angle.min(PI)));
    object.put(&names::MAP, place.map.as_str());
}

fn edge(object: &mut ObjectWriter, edge: &Edge) {
    object.put(&names::EDGE_ID, edge.id.as_str());
    object.put(&names::SEQUENCE, edge.sequence);
    object.put(&names::RELEASED, edge.released);
    object.put(&names::START_NODE, edge.from.as_str());
    object.put(&names::END_NODE, edge.to.as_str());
    object.magnitude(&names::EDGE_SPEED, edge.max_speed_mps);
    if let Some(corridor) = edge.corridor.filter(|corridor| can_be_said(object, corridor)) {
        object.object(&names::CORRIDOR, |object| write_corridor(object, &corridor));
    }
    actions_of(object, &edge.actions);
}

/// Whether a robot of the version would keep to the corridor: without a word for it, it would not ask for the release.
fn can_be_said(object: &ObjectWriter, corridor: &Corridor) -> bool {
    let is_free = !corridor.release_required || object.has(&names::RELEASE_REQUIRED);
    is_free && corridor.left_m.is_finite() && corridor.right_m.is_finite()
}

fn write_corridor(object: &mut ObjectWriter, corridor: &Corridor) {
    object.magnitude(&names::LEFT_WIDTH, corridor.left_m);
    object.magnitude(&names::RIGHT_WIDTH, corridor.right_m);
    object.word(&names::CORRIDOR_POINT, &words::CORRIDOR_POINT, corridor.of_contour);
    object.put(&names::RELEASE_REQUIRED, corridor.release_required);
}

fn actions_of(object: &mut ObjectWriter, actions: &[Action]) {
    object.list(&names::ACTIONS, actions, |object, one| {
        action(object, one, &words::BLOCKING);
        object.put(&names::RETRIABLE, one.retriable);
    });
}

fn action(object: &mut ObjectWriter, action: &Action, blocking: &WireWords<BlockingType>) {
    object.put(&names::ACTION_TYPE, action.kind.as_str());
    object.put(&names::ACTION_ID, action.id.as_str());
    object.word(&names::BLOCKING, blocking, action.blocking);
    // No version allows null.
    let said = action.parameters.iter().filter(|parameter| !parameter.value.is_null());
    object.list(&names::PARAMETERS, said, |object, parameter: &Parameter| {
        object.put(&names::KEY, parameter.key.as_str());
        object.put(&names::VALUE, parameter.value.clone());
    });
}

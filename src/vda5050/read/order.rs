//! Reads orders and instant actions.
//!
//! Main functions: [`order`], [`instant_actions`]. An order is read as a whole or not at all: a robot must not drive
//! one of which parts are missing. An instant action that cannot be read is left out, so that it does not stop others.
//! Refuses: orders without ids, numbers or places.

use super::object::ObjectReader;
use super::oddity::Unreadable;
use crate::model::action::{Action, BlockingType, Parameter};
use crate::model::order::{Corridor, Edge, Node, NodePosition, Order};
use crate::vocabulary::{WireName, WireWords, names, words};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn order(top: &ObjectReader<'_>) -> Result<Order, Unreadable> {
    let id = top.need_text(&names::ORDER_ID)?;
    let update = top.need_count(&names::ORDER_UPDATE)?;
    let nodes = top.all(&names::NODES, node)?.ok_or_else(|| top.missing(&names::NODES))?;
    let by_sequence = nodes.iter().map(|node| (node.sequence, node.id.as_str())).collect();
    let edges = top.all(&names::EDGES, |object| edge(object, &by_sequence))?;
    let edges = edges.unwrap_or_else(|| top.assumed(&names::EDGES, "empty", Vec::new()));
    Ok(Order { id, update, nodes, edges })
}

/// Under `actions`, under the key of the tag 2.0.0, or under both: many masters write both, for robots that want one.
pub(super) fn instant_actions(top: &ObjectReader<'_>) -> Result<Vec<Action>, Unreadable> {
    let read = |object: &ObjectReader<'_>| action(object, &words::INSTANT_BLOCKING);
    let lists = [&names::ACTIONS, &names::TAGGED_ACTIONS].map(|name| top.readable(name, read));
    if lists.iter().all(Option::is_none) {
        return Err(top.missing(&names::ACTIONS));
    }
    let [plain, tagged] = lists.map(Option::unwrap_or_default);
    let known: BTreeSet<String> = plain.iter().map(|action| action.id.clone()).collect();
    let tagged = tagged.into_iter().filter(|action| !known.contains(&action.id));
    Ok(plain.into_iter().chain(tagged).collect())
}

fn node(object: &ObjectReader<'_>) -> Result<Node, Unreadable> {
    Ok(Node {
        id: object.need_text(&names::NODE_ID)?,
        sequence: object.need_count(&names::SEQUENCE)?,
        released: object.flag_or(&names::RELEASED, false),
        position: object.object(&names::NODE_POSITION).as_ref().map(node_position).transpose()?,
        actions: actions(object)?,
    })
}

fn node_position(object: &ObjectReader<'_>) -> Result<NodePosition, Unreadable> {
    Ok(NodePosition {
        x: object.need_number(&names::X)?,
        y: object.need_number(&names::Y)?,
        theta: object.number(&names::THETA),
        deviation_m: deviation(object),
        deviation_rad: object.magnitude(&names::DEVIATION_THETA),
        map: object.need_text(&names::MAP)?,
    })
}

/// The radius, or the smaller half axis of the ellipse of 3.0.
fn deviation(object: &ObjectReader<'_>) -> Option<f64> {
    if !object.is_object(&names::DEVIATION_RADIUS) {
        return object.magnitude(&names::DEVIATION_RADIUS);
    }
    let ellipse = object.object(&names::DEVIATION_RADIUS)?;
    let axes = [ellipse.magnitude(&names::ELLIPSE_A), ellipse.magnitude(&names::ELLIPSE_B)];
    axes.into_iter().flatten().reduce(f64::min)
}

fn edge(object: &ObjectReader<'_>, by_sequence: &BTreeMap<u32, &str>) -> Result<Edge, Unreadable> {
    let sequence = object.need_count(&names::SEQUENCE)?;
    Ok(Edge {
        id: object.need_text(&names::EDGE_ID)?,
        sequence,
        released: object.flag_or(&names::RELEASED, false),
        from: end(object, &names::START_NODE, sequence.checked_sub(1), by_sequence),
        to: end(object, &names::END_NODE, sequence.checked_add(1), by_sequence),
        max_speed_mps: object.magnitude(&names::EDGE_SPEED),
        corridor: object.object(&names::CORRIDOR).map(|object| corridor(&object)).transpose()?,
        actions: actions(object)?,
    })
}

/// The node at an end of an edge: as the message says, or as the number next to the edge's says.
fn end(
    object: &ObjectReader<'_>,
    name: &WireName,
    sequence: Option<u32>,
    by_sequence: &BTreeMap<u32, &str>,
) -> String {
    if let Some(id) = object.text(name) {
        return id;
    }
    let neighbour = sequence.and_then(|sequence| by_sequence.get(&sequence));
    match neighbour {
        Some(id) if !object.expects(name) => (*id).to_owned(),
        Some(id) => object.assumed(name, id, (*id).to_owned()),
        None => object.assumed(name, "empty", String::new()),
    }
}

/// The width on a side that is missing is taken as 0: the robot stays on the line.
fn corridor(object: &ObjectReader<'_>) -> Result<Corridor, Unreadable> {
    let width = |name: &WireName| object.magnitude(name).unwrap_or_else(|| object.assumed(name, "0", 0.0));
    Ok(Corridor {
        left_m: width(&names::LEFT_WIDTH),
        right_m: width(&names::RIGHT_WIDTH),
        of_contour: object.word(&names::CORRIDOR_POINT, &words::CORRIDOR_POINT).unwrap_or(false),
        release_required: object.flag(&names::RELEASE_REQUIRED).unwrap_or(false),
    })
}

fn actions(object: &ObjectReader<'_>) -> Result<Vec<Action>, Unreadable> {
    let all = object.all(&names::ACTIONS, |object| action(object, &words::BLOCKING))?;
    Ok(all.unwrap_or_else(|| object.assumed(&names::ACTIONS, "empty", Vec::new())))
}

fn action(object: &ObjectReader<'_>, blocking: &WireWords<BlockingType>) -> Result<Action, Unreadable> {
    Ok(Action {
        kind: object.need_text(&names::ACTION_TYPE)?,
        id: object.need_text(&names::ACTION_ID)?,
        blocking: object.word_or_careful(&names::BLOCKING, blocking)?,
        parameters: object.all(&names::PARAMETERS, parameter)?.unwrap_or_default(),
        retriable: object.flag(&names::RETRIABLE).unwrap_or(false),
    })
}

fn parameter(object: &ObjectReader<'_>) -> Result<Parameter, Unreadable> {
    let key = object.need_text(&names::KEY)?;
    let value =
        object.anything(&names::VALUE).unwrap_or_else(|| object.assumed(&names::VALUE, "null", Value::Null));
    Ok(Parameter { key, value })
}

//! Whether a virtual robot accepts an order, as the standard of its version and its quirks say.
//!
//! Main function: `take_order`. Source: VDA 5050 2.1, sections 6.6.2 and 6.6.4; 3.0, sections 6.1.2 and 6.1.4. Refuses:
//! to change anything before the whole order is judged.

use super::VirtualRobot;
use super::actions::ActionPlace;
use super::body::angle_between;
use super::complaints::OrderRejection;
use super::execution::OrderPhase;
use super::quirks::{ChargingOrders, EqualUpdate, HeadingCheck, OtherOrder, StartRule};
use crate::model::factsheet::Factsheet;
use crate::model::order::{Edge, Node, Order};
use crate::model::state::OperatingMode;
use std::collections::BTreeSet;

/// What an acceptable order is to the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OrderVerdict {
    /// A new order.
    New,
    /// A new order that is driven after the base of the active one: a quirk.
    NewAtEndOfBase,
    /// An update of the order that the robot has.
    Update,
    /// A repetition, ignored with a state.
    Repetition,
    /// A repetition, ignored without a state: a quirk.
    SilentRepetition,
}

/// Coordinates beyond this many metres are on no map.
const MAP_MOST_M: f64 = 1e6;

impl VirtualRobot {
    /// Accepts, ignores or rejects an order or an update.
    pub(super) fn take_order(&mut self, order: Order) {
        match self.judge(&order) {
            Ok(OrderVerdict::SilentRepetition) => return,
            Ok(OrderVerdict::Repetition) => {}
            Ok(OrderVerdict::New) => self.begin_order(order, false),
            Ok(OrderVerdict::NewAtEndOfBase) => self.begin_order(order, true),
            Ok(OrderVerdict::Update) => self.extend_order(order),
            Err(why) => self.reject(&order, &why),
        }
        self.reporting.must_say = true;
    }

    /// Whether the robot's mode and localisation allow new orders.
    pub(super) fn takes_new_orders(&self) -> bool {
        let is_allowed = self.mode.takes_orders() || self.mode == OperatingMode::Intervened;
        is_allowed && self.is_localized
    }

    fn judge(&self, order: &Order) -> Result<OrderVerdict, OrderRejection> {
        check_shape(order, self.setup.factsheet.as_ref()).map_err(OrderRejection::Malformed)?;
        if !self.takes_new_orders() {
            return Err(OrderRejection::NotAvailable);
        }
        let is_known = order.id == self.order.id;
        let verdict = if is_known { self.judge_update(order)? } else { self.judge_new(order)? };
        if !matches!(verdict, OrderVerdict::Repetition | OrderVerdict::SilentRepetition) {
            self.check_content(order)?;
        }
        Ok(verdict)
    }

    fn judge_update(&self, order: &Order) -> Result<OrderVerdict, OrderRejection> {
        if order.update < self.order.update {
            return Err(OrderRejection::Outdated);
        }
        if order.update == self.order.update {
            let is_same = self.order.content.as_ref() == Some(order);
            return match self.setup.quirks.equal_update {
                EqualUpdate::Error => Err(OrderRejection::SameNumber),
                EqualUpdate::ByVersion if self.speaks_3_0() && !is_same => Err(OrderRejection::SameNumber),
                EqualUpdate::IgnoredInSilence => Ok(OrderVerdict::SilentRepetition),
                EqualUpdate::ByVersion | EqualUpdate::Ignored => Ok(OrderVerdict::Repetition),
            };
        }
        if self.order.phase != OrderPhase::Running {
            return Err(OrderRejection::AfterCancel);
        }
        // Before 3.0 the robot keeps to what it knows of the stitching node, whatever is sent again.
        let is_stitched = |first: &Node, last: &Node| {
            if self.speaks_3_0() {
                first == last
            } else {
                first.id == last.id && first.sequence == last.sequence
            }
        };
        match (order.nodes.first(), &self.order.decision) {
            (Some(first), Some(last)) if is_stitched(first, last) => Ok(OrderVerdict::Update),
            _ => Err(OrderRejection::NotStitched),
        }
    }

    fn judge_new(&self, order: &Order) -> Result<OrderVerdict, OrderRejection> {
        let Some(first) = order.nodes.first() else {
            return Err(OrderRejection::Malformed("an order needs a node"));
        };
        if self.equipment.is_charging && self.setup.quirks.charging_orders == ChargingOrders::Refused {
            return Err(OrderRejection::Charging);
        }
        if !self.is_idle() {
            let continues = self.order.phase == OrderPhase::Running
                && self.order.decision.as_ref().is_some_and(|last| last.id == first.id);
            return if self.setup.quirks.other_order == OtherOrder::Stitched && continues {
                Ok(OrderVerdict::NewAtEndOfBase)
            } else {
                Err(OrderRejection::OtherActive)
            };
        }
        if first.sequence != 0 || (self.speaks_3_0() && order.update != 0) {
            return Err(OrderRejection::Malformed("a new order begins with the numbers 0"));
        }
        if self.is_at_start(first) {
            Ok(OrderVerdict::New)
        } else {
            Err(OrderRejection::TooFar { node: first.id.clone() })
        }
    }

    fn is_at_start(&self, first: &Node) -> bool {
        let is_last = first.id == self.last_node;
        let quirks = &self.setup.quirks;
        if quirks.start_rule == StartRule::DistanceOrLastNode
            && is_last
            && first.sequence == self.last_sequence
        {
            return true;
        }
        let Some((x, y)) = self.place_of(first) else { return is_last };
        let own_m = self.setup.abilities.own_deviation_m;
        let allowed_m = first.position.as_ref().and_then(|p| p.deviation_m).map_or(own_m, |m| m.max(own_m));
        let is_near = (x - self.body.x).hypot(y - self.body.y) <= allowed_m;
        let theta = first.position.as_ref().and_then(|p| p.theta);
        let allowed_rad = match quirks.heading_check {
            HeadingCheck::IfDeviationGiven => first.position.as_ref().and_then(|p| p.deviation_rad),
            HeadingCheck::WithinRad(rad) => Some(rad),
        };
        let is_turned = match (theta, allowed_rad) {
            (Some(theta), Some(rad)) => angle_between(self.body.theta, theta).abs() <= rad,
            _ => true,
        };
        is_near && is_turned
    }

    /// Maps, places and actions of the whole order, its horizon as well.
    fn check_content(&self, order: &Order) -> Result<(), OrderRejection> {
        for node in &order.nodes {
            if let Some(position) = node.position.as_ref().filter(|p| p.map != self.map) {
                return Err(OrderRejection::UnknownMap { map: position.map.clone() });
            }
            let is_on_map = |(x, y): (f64, f64)| x.abs() <= MAP_MOST_M && y.abs() <= MAP_MOST_M;
            // Where the robot stands needs no place.
            let is_first = std::ptr::eq(node, &order.nodes[0]);
            if !self.place_of(node).map_or(is_first, is_on_map) {
                return Err(OrderRejection::NoRoute { node: node.id.clone() });
            }
        }
        let of_nodes =
            order.nodes.iter().flat_map(|node| node.actions.iter().map(|a| (a, ActionPlace::Node)));
        let of_edges =
            order.edges.iter().flat_map(|edge| edge.actions.iter().map(|a| (a, ActionPlace::Edge)));
        for (action, place) in of_nodes.chain(of_edges) {
            if !self.can_do(action, place) {
                return Err(OrderRejection::Action { id: action.id.clone(), kind: action.kind.clone() });
            }
        }
        Ok(())
    }
}

/// Whether a message is formed as an order or an update.
fn check_shape(order: &Order, factsheet: Option<&Factsheet>) -> Result<(), &'static str> {
    let Some(first) = order.nodes.first() else { return Err("an order needs a node") };
    if order.id.is_empty() {
        return Err("the orderId is empty");
    }
    if order.edges.len() + 1 != order.nodes.len() {
        return Err("an order has one edge less than nodes");
    }
    if !first.released {
        return Err("the first node is not released");
    }
    check_sequence(order, first.sequence)?;
    let pairs = order.nodes.iter().zip(order.nodes.iter().skip(1)).zip(&order.edges);
    for ((from, to), edge) in pairs {
        check_edge(from, to, edge)?;
    }
    for position in order.nodes.iter().filter_map(|node| node.position.as_ref()) {
        let optional = [position.theta, position.deviation_m, position.deviation_rad];
        let numbers = [position.x, position.y].into_iter().chain(optional.into_iter().flatten());
        if numbers.into_iter().any(|number| !number.is_finite()) {
            return Err("a number is not finite");
        }
    }
    check_limits(order, factsheet)?;
    check_ids(order)
}

fn check_sequence(order: &Order, first: u32) -> Result<(), &'static str> {
    let words = "the sequenceIds are not continuous, even at nodes and odd at edges";
    let mut expected = first;
    if !first.is_multiple_of(2) {
        return Err(words);
    }
    for (edge, node) in order.edges.iter().zip(order.nodes.iter().skip(1)) {
        for sequence in [edge.sequence, node.sequence] {
            expected = expected.checked_add(1).ok_or(words)?;
            if sequence != expected {
                return Err(words);
            }
        }
    }
    Ok(())
}

fn check_edge(from: &Node, to: &Node, edge: &Edge) -> Result<(), &'static str> {
    if edge.released != to.released || (to.released && !from.released) {
        return Err("something is released after something that is not");
    }
    // 3.0 does not write the ends of an edge.
    let is_end = |written: &str, node: &Node| written.is_empty() || written == node.id;
    if !is_end(&edge.from, from) || !is_end(&edge.to, to) {
        return Err("an edge does not join the nodes beside it");
    }
    if edge.max_speed_mps.is_some_and(|speed_mps| !speed_mps.is_finite() || speed_mps <= 0.0) {
        return Err("an edge's speed is no speed");
    }
    Ok(())
}

fn check_limits(order: &Order, factsheet: Option<&Factsheet>) -> Result<(), &'static str> {
    let most_nodes = factsheet.and_then(|f| f.most_nodes).unwrap_or(usize::MAX);
    let longest_id = factsheet.and_then(|f| f.longest_id).unwrap_or(usize::MAX);
    let mut ids =
        order.nodes.iter().map(|n| &n.id).chain(order.edges.iter().map(|e| &e.id)).chain([&order.id]);
    if order.nodes.len() > most_nodes {
        return Err("the order has more nodes than the factsheet allows");
    }
    if ids.any(|id| id.chars().count() > longest_id) {
        return Err("an id is longer than the factsheet allows");
    }
    Ok(())
}

fn check_ids(order: &Order) -> Result<(), &'static str> {
    let mut seen = BTreeSet::new();
    let of_nodes = order.nodes.iter().flat_map(|node| &node.actions);
    let mut actions = of_nodes.chain(order.edges.iter().flat_map(|edge| &edge.actions));
    if actions.any(|action| action.id.is_empty() || !seen.insert(&action.id)) {
        return Err("two actions of the order have one id, or one has none");
    }
    Ok(())
}

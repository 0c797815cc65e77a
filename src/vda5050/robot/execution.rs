//! The order that a virtual robot has, and how far it is: nodes passed, pause, cancel, and where the body may drive.
//!
//! Main types: [`HeldOrder`], [`PauseStage`]; main functions: `begin_order`, `extend_order`, `pass_nodes`, `command`.
//! Refuses: to give the body a point that is not released.

use super::VirtualRobot;
use super::actions::ActionStage;
use super::body::{BodyCommand, BodyMotion, PathPoint};
use super::quirks::{
    CancelHabit, FirstState, MidwayUpdate, NodeStops, PauseHabit, ReportedBase, StitchedActions,
};
use crate::model::Message;
use crate::model::order::{Edge, Node, Order};
use crate::model::state::{EStop, NodeLeft};
use crate::topic::TopicKind;

/// The order that a robot has.
#[derive(Clone, Debug, Default)]
pub(super) struct HeldOrder {
    /// The order's id; empty if the robot never had one.
    pub(super) id: String,
    pub(super) update: u32,
    pub(super) phase: OrderPhase,
    /// Nodes to reach, first those of the base.
    pub(super) nodes: Vec<HeldNode>,
    /// The edge that leads to each of the nodes.
    pub(super) edges: Vec<HeldEdge>,
    /// The last released node, at which an update must begin.
    pub(super) decision: Option<Node>,
    /// The last accepted message.
    pub(super) content: Option<Order>,
    /// Whether the robot does not see that it could drive: a quirk.
    is_stranded: bool,
    /// Until when the robot stands at a node: a quirk.
    dwell_until_us: i64,
    /// The last key that was given to a node or an edge.
    last_key: u32,
}

/// Where an order is in its life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum OrderPhase {
    /// There was none since the robot was switched on.
    #[default]
    Never,
    /// It is driven, or was driven to its end.
    Running,
    /// It is being cancelled; the robot stops at once or after the node with this key.
    Cancelling(Option<u32>),
    /// It was cancelled, or cleared by a mode.
    Cleared,
}

/// Whether a robot is paused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PauseStage {
    /// It is not.
    Off,
    /// It stops at once or after the node with this key.
    Stopping(Option<u32>),
    /// It is.
    On,
}

/// A node to reach. Keys are unique over all orders, so that a late report of the body means nothing to a later order.
#[derive(Clone, Debug)]
pub(super) struct HeldNode {
    pub(super) key: u32,
    pub(super) node: Node,
    /// Whether the node is left out of states: a quirk.
    pub(super) is_hidden: bool,
}

/// An edge to drive.
#[derive(Clone, Debug)]
pub(super) struct HeldEdge {
    pub(super) key: u32,
    pub(super) edge: Edge,
    pub(super) is_hidden: bool,
}

/// The most points of a path that the body is given at once. They reach further than it needs to brake.
const PATH_MOST: usize = 64;

impl HeldOrder {
    /// How many released nodes are still to be reached.
    pub(super) fn released_left(&self) -> usize {
        self.nodes.iter().take_while(|held| held.node.released).count()
    }

    fn next_key(&mut self) -> u32 {
        self.last_key = self.last_key.wrapping_add(1);
        self.last_key
    }
}

impl VirtualRobot {
    pub(super) fn now_us(&self) -> i64 {
        self.stepped_us.unwrap_or(0)
    }

    /// Where a node is, metres; nothing if neither the order nor the robot knows.
    pub(super) fn place_of(&self, node: &Node) -> Option<(f64, f64)> {
        let known = || self.setup.places.get(&node.id).copied();
        node.position.as_ref().map(|p| (p.x, p.y)).or_else(known)
    }

    /// Whether the robot has nothing to do: VDA 5050 3.0, section 6.6.8.
    pub(super) fn is_idle(&self) -> bool {
        let is_cancelling = matches!(self.order.phase, OrderPhase::Cancelling(_));
        self.order.nodes.is_empty()
            && !is_cancelling
            && self.actions.iter().all(|entry| entry.stage.is_over())
    }

    pub(super) fn is_paused(&self) -> bool {
        self.pause == PauseStage::On
    }

    /// Takes a new order, after the base of the one that the robot has or in its place.
    pub(super) fn begin_order(&mut self, order: Order, keeps_base: bool) {
        self.forgive_order();
        self.forget_instants_at_order();
        let before = std::mem::take(&mut self.order);
        self.order.last_key = before.last_key;
        if keeps_base {
            self.keep_base(before);
        } else {
            self.actions.clear();
        }
        self.order.id.clone_from(&order.id);
        self.order.phase = OrderPhase::Running;
        let start = self.order.next_key();
        if let Some(first) = order.nodes.first() {
            self.order.decision = Some(first.clone());
            self.list_actions(&first.actions, start);
            let is_there = self.order.nodes.is_empty();
            self.append(&order);
            if is_there {
                self.say_first_state(first);
                self.last_node.clone_from(&first.id);
                self.last_sequence = first.sequence;
                self.trigger(start);
            } else if let Some(last) = self.order.nodes.iter().rposition(|n| n.key < start) {
                // The first node of the new order is the last one of the old base: its actions wait there.
                let key = self.order.nodes[last].key;
                self.move_actions(start, key);
            }
        }
        self.order.update = order.update;
        self.order.content = Some(order);
    }

    /// The quirk of robot A: the base of an order goes on under the next one.
    fn keep_base(&mut self, before: HeldOrder) {
        let base = before.released_left();
        self.order.nodes = before.nodes.into_iter().take(base).collect();
        self.order.edges = before.edges.into_iter().take(base).collect();
        let nodes = self.order.nodes.iter().map(|held| held.key);
        let kept: Vec<u32> = nodes.chain(self.order.edges.iter().map(|held| held.key)).collect();
        self.actions.retain(|entry| {
            !entry.stage.is_over() && (entry.stage != ActionStage::Announced || kept.contains(&entry.key))
        });
    }

    /// Takes an update: the horizon is replaced, the base goes on.
    pub(super) fn extend_order(&mut self, order: Order) {
        self.forgive_order();
        let base = self.order.released_left();
        let dropped: Vec<u32> = self.order.nodes.drain(base..).map(|held| held.key).collect();
        let dropped_edges: Vec<u32> = self.order.edges.drain(base..).map(|held| held.key).collect();
        self.actions.retain(|a| !dropped.contains(&a.key) && !dropped_edges.contains(&a.key));
        if self.setup.quirks.reported_base == ReportedBase::Vanishes {
            self.order.nodes.iter_mut().for_each(|held| held.is_hidden = true);
            self.order.edges.iter_mut().for_each(|held| held.is_hidden = true);
        }
        self.order.is_stranded = base > 0 && self.setup.quirks.midway_update == MidwayUpdate::Strands;
        if self.setup.quirks.stitched_actions == StitchedActions::ListedAgain {
            // Key 0 is nowhere, so these actions never begin.
            let again = order.nodes.first().map(|first| first.actions.clone()).unwrap_or_default();
            self.list_actions(&again, 0);
        }
        self.append(&order);
        self.order.update = order.update;
        self.order.content = Some(order);
    }

    /// Appends all but the first node of an order.
    fn append(&mut self, order: &Order) {
        for (edge, node) in order.edges.iter().zip(order.nodes.iter().skip(1)) {
            let (edge_key, key) = (self.order.next_key(), self.order.next_key());
            self.list_actions(&edge.actions, edge_key);
            self.list_actions(&node.actions, key);
            self.order.edges.push(HeldEdge { key: edge_key, edge: edge.clone(), is_hidden: false });
            self.order.nodes.push(HeldNode { key, node: node.clone(), is_hidden: false });
            if node.released {
                self.order.decision = Some(node.clone());
            }
        }
    }

    /// The quirk of robots A and C: a state that lists the node on which the robot stands.
    fn say_first_state(&mut self, first: &Node) {
        if self.setup.quirks.first_state == FirstState::ListsFirstNode {
            let mut state = self.compose_state();
            let left = NodeLeft { id: first.id.clone(), sequence: first.sequence, released: true };
            state.nodes.insert(0, left);
            self.say(TopicKind::State, Message::State(Box::new(state)));
        }
    }

    /// Passes the points that the body has reached, as far as they are the next released nodes.
    pub(super) fn pass_nodes(&mut self, now_us: i64, reached: &[u32]) {
        for key in reached {
            let is_next = |held: &HeldNode| held.key == *key && held.node.released;
            if !self.order.nodes.first().is_some_and(is_next) {
                continue;
            }
            let held = self.order.nodes.remove(0);
            if !self.order.edges.is_empty() {
                let driven = self.order.edges.remove(0);
                self.end_edge_actions(driven.key);
            }
            self.last_node = held.node.id;
            self.last_sequence = held.node.sequence;
            self.trigger(held.key);
            if let NodeStops::EachNode { dwell_us } = self.setup.quirks.node_stops {
                self.order.dwell_until_us = now_us.saturating_add(dwell_us);
            }
        }
    }

    /// Begins a pause, unless the robot is paused already.
    pub(super) fn begin_pause(&mut self) {
        if self.pause == PauseStage::Off {
            let at_node = self.setup.quirks.pause == PauseHabit::AtNextNode;
            self.pause = PauseStage::Stopping(self.next_node().filter(|_| at_node));
        }
    }

    /// Begins to cancel the order: its actions fail, the robot stops.
    pub(super) fn begin_cancel(&mut self) {
        if self.order.phase == OrderPhase::Running {
            let at_node = self.setup.quirks.cancel == CancelHabit::AtNextNode;
            self.order.phase = OrderPhase::Cancelling(self.next_node().filter(|_| at_node));
            self.fail_actions("the order was cancelled");
        }
    }

    fn next_node(&self) -> Option<u32> {
        self.order.nodes.first().filter(|held| held.node.released).map(|held| held.key)
    }

    /// Whether the body has stopped where it was to: at once, or after the node with a key.
    fn has_stopped(&self, after: Option<u32>) -> bool {
        let is_passed = |key: u32| self.order.nodes.iter().all(|held| held.key != key);
        self.body.stands() && after.is_none_or(is_passed)
    }

    pub(super) fn settle_pause(&mut self) {
        if let PauseStage::Stopping(after) = self.pause
            && self.has_stopped(after)
        {
            self.pause = PauseStage::On;
            self.finish_running("startPause");
        }
    }

    pub(super) fn settle_cancel(&mut self) {
        if let OrderPhase::Cancelling(after) = self.order.phase
            && self.has_stopped(after)
        {
            self.drop_order();
        }
    }

    /// A mode takes the robot from the master: its order is cleared at once.
    pub(super) fn clear_order(&mut self) {
        self.fail_actions("the mode does not allow orders");
        if self.order.phase != OrderPhase::Never {
            self.drop_order();
        }
    }

    fn drop_order(&mut self) {
        self.order.nodes.clear();
        self.order.edges.clear();
        self.order.is_stranded = false;
        self.order.phase = OrderPhase::Cleared;
        self.finish_running("cancelOrder");
    }

    /// Whether the robot may drive now, if it has a released way.
    pub(super) fn may_drive(&self, now_us: i64) -> bool {
        let is_before = |key: u32| self.order.nodes.iter().any(|held| held.key == key);
        let phase_allows = match self.order.phase {
            OrderPhase::Running => true,
            OrderPhase::Cancelling(after) => after.is_some_and(is_before),
            OrderPhase::Never | OrderPhase::Cleared => false,
        };
        let pause_allows = match self.pause {
            PauseStage::Off => true,
            PauseStage::Stopping(after) => after.is_some_and(is_before),
            PauseStage::On => false,
        };
        phase_allows
            && pause_allows
            && self.mode.takes_orders()
            && self.e_stop == EStop::None
            && !self.is_field_violated
            && self.is_localized
            && !self.order.is_stranded
            && !self.waits_for_release()
            && !self.is_blocked()
            && now_us >= self.order.dwell_until_us
            && !self.actions.iter().any(|entry| entry.blocks_driving())
    }

    /// What the body is to do until the next step.
    pub(super) fn command(&mut self, now_us: i64) -> BodyCommand {
        if !self.is_alive() {
            return BodyCommand::default();
        }
        let path = self.path();
        let is_driving = self.may_drive(now_us) && !path.is_empty();
        if is_driving {
            // A robot that drives off has left the charger.
            self.equipment.is_charging = false;
        }
        let motion = if is_driving { BodyMotion::Go } else { BodyMotion::Brake };
        BodyCommand { path, motion, placed: self.placed.take() }
    }

    /// The released way to the next node at which the robot must stand.
    fn path(&self) -> Vec<PathPoint> {
        let (mut path, mut from) = (Vec::new(), (self.body.x, self.body.y));
        for (i, (held, way)) in self.order.nodes.iter().zip(&self.order.edges).take(PATH_MOST).enumerate() {
            let place = self.place_of(&held.node).filter(|_| held.node.released && way.edge.released);
            let Some((x, y)) = place.filter(|to| !self.is_barred(from, *to)) else { break };
            let zones_mps = self.speed_through(from, (x, y));
            from = (x, y);
            let position = held.node.position.as_ref();
            let heading = position.and_then(|p| Some((p.theta?, p.deviation_rad.unwrap_or(0.0))));
            let speed_mps = way.edge.max_speed_mps.unwrap_or(f64::INFINITY).min(zones_mps);
            path.push(PathPoint { key: held.key, x, y, heading, speed_mps });
            if self.must_stand_at(i) {
                break;
            }
        }
        path
    }

    /// Whether the robot must stand at one of the nodes to reach: for actions there or on the way on, or by a quirk.
    fn must_stand_at(&self, index: usize) -> bool {
        let Some(held) = self.order.nodes.get(index) else { return true };
        let stops_here = |after: Option<u32>| after == Some(held.key);
        let stops = match (self.pause, self.order.phase) {
            (PauseStage::Stopping(after), _) | (_, OrderPhase::Cancelling(after)) => stops_here(after),
            _ => false,
        };
        let way_on = self.order.edges.get(index + 1).map(|way| way.key);
        let is_here = |key: u32| key == held.key || Some(key) == way_on;
        stops
            || self.setup.quirks.node_stops != NodeStops::OnDemand
            || self.actions.iter().any(|entry| is_here(entry.key) && entry.will_block_driving())
    }
}

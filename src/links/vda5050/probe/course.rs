//! The way on which a probed robot drives, and what its orders look like.
//!
//! Main types: [`DriveCourse`], [`DeviationSpelling`]. One node is half way, so that a robot that stops at nodes is
//! told from one that stops at once. Refuses: ways that are too short to tell anything.

use super::RobotProbe;
use giveway_floor::geometry::Point;
use giveway_vda5050::{Action, Edge, Node, NodePosition, Order};
use serde_json::Value;

/// The shortest way on which something can be told, metres.
pub(super) const SHORTEST_M: f64 = 3.0;
/// How far beside the robot a node may be without a deviation being read, metres: none of the measured robots is that
/// lenient by itself.
const BESIDE_M: f64 = 0.6;
/// The deviation that orders allow, metres.
const ALLOWED_M: f64 = 1.0;

/// The spelling of the allowed deviation in orders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviationSpelling {
    /// `allowedDeviationXY`.
    #[default]
    Official,
    /// `allowedDeviationXy`, as 2.0 was published.
    Published,
    /// Both.
    Both,
}

/// The way on which the robot drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct DriveCourse {
    pub spelling: DeviationSpelling,
    /// Where it began, half way, and its end.
    pub from: Option<Point>,
    pub middle: Option<Point>,
    pub to: Option<Point>,
    /// Where the robot was when it first said that what it was asked for is done.
    pub said_done: Option<Point>,
}

impl DeviationSpelling {
    /// Spells the deviations of an order of 2.0 or 2.1; that of 3.0 has one spelling.
    pub(super) fn spell(self, order: &mut Value) {
        let nodes = order.get_mut("nodes").and_then(Value::as_array_mut).into_iter().flatten();
        for position in nodes.filter_map(|node| node.get_mut("nodePosition")?.as_object_mut()) {
            let Some(allowed) = position.get("allowedDeviationXY").cloned() else { continue };
            if !allowed.is_number() || self == DeviationSpelling::Official {
                continue;
            }
            position.insert("allowedDeviationXy".to_owned(), allowed);
            if self == DeviationSpelling::Published {
                position.remove("allowedDeviationXY");
            }
        }
    }
}

impl RobotProbe {
    /// An order of one node, where the robot stands, with these actions.
    pub(super) fn order_here(&mut self, actions: Vec<Action>) -> Option<Order> {
        let here = self.said.place()?;
        let name = self.said.state().map(|state| state.last_node.clone()).unwrap_or_default();
        let name = if name.is_empty() { "~probe".to_owned() } else { name };
        let mut node = self.node(&name, 0, here)?;
        node.actions = actions;
        let id = self.new_id();
        Some(Order { id, update: 0, nodes: vec![node], edges: Vec::new() })
    }

    /// An order from where the robot stands over a node half way to a place, if that is far enough. With `beside`, the
    /// first node is beside the robot, so that only a robot that reads the deviation accepts it.
    pub(super) fn order_to(&mut self, to: Point, beside: bool) -> Option<Order> {
        let here = self.said.place()?;
        let way = to - here;
        if way.norm() < SHORTEST_M {
            return None;
        }
        let middle = here + way * 0.5;
        let first = if beside { here - way.normalize() * BESIDE_M } else { here };
        (self.course.from, self.course.middle, self.course.to) = (Some(here), Some(middle), Some(to));
        self.course.said_done = None;
        Some(self.order_along(&[first, middle, to]))
    }

    /// An order along places, all of them released.
    pub(super) fn order_along(&mut self, places: &[Point]) -> Order {
        let id = self.new_id();
        let named = places.iter().enumerate().map(|(i, place)| (format!("~{id}-{i}"), 2 * i as u32, *place));
        let nodes: Vec<Node> =
            named.filter_map(|(name, number, place)| self.node(&name, number, place)).collect();
        let edges = nodes.iter().zip(nodes.iter().skip(1)).map(|(from, to)| Edge {
            id: format!("{}-{}", from.id, to.sequence),
            sequence: from.sequence + 1,
            released: true,
            from: from.id.clone(),
            to: to.id.clone(),
            max_speed_mps: None,
            corridor: None,
            actions: Vec::new(),
        });
        let edges = edges.collect();
        Order { id, update: 0, nodes, edges }
    }

    fn node(&self, id: &str, sequence: u32, place: Point) -> Option<Node> {
        let map = self.said.state()?.position.as_ref()?.map.clone();
        let position = NodePosition {
            x: place.x,
            y: place.y,
            theta: None,
            deviation_m: Some(ALLOWED_M),
            deviation_rad: None,
            map,
        };
        Some(Node {
            id: id.to_owned(),
            sequence,
            released: true,
            position: Some(position),
            actions: Vec::new(),
        })
    }
}

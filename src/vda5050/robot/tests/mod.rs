//! Tests of the virtual robot, and what they share: a bench on which a robot drives along a line.
//!
//! Main type: [`RobotBench`]. Refuses: JSON and brokers; everything happens in memory, on a clock that the test sets.

mod body;
mod control;
mod handling;
mod laws;
mod like_a;
mod like_b;
mod like_c;
mod link;
mod orders;
mod rejections;
mod wire;
mod zones;

use super::{EmbodiedRobot, RobotMessage, RobotSetup};
use crate::model::Message;
use crate::model::action::{Action, ActionStatus, BlockingType, Parameter};
use crate::model::order::{Edge, Node, NodePosition, Order};
use crate::model::state::{ConnectionState, State};
use crate::version::Version;
use serde_json::Value;

/// The time between two steps, microseconds.
const TICK_US: i64 = 50_000;

/// A robot, its clock, and all that it said.
struct RobotBench {
    robot: EmbodiedRobot,
    now_us: i64,
    said: Vec<RobotMessage>,
}

impl RobotBench {
    /// A robot that has taken its first step.
    fn new(setup: RobotSetup) -> RobotBench {
        let mut bench = RobotBench { robot: EmbodiedRobot::new(setup), now_us: 0, said: Vec::new() };
        bench.hear(&[]);
        bench
    }

    fn of_version(version: Version) -> RobotBench {
        RobotBench::new(RobotSetup::new(version, "maker", "r1", "lab", "n0"))
    }

    /// Lets the robot receive messages now.
    fn hear(&mut self, messages: &[Message]) {
        let said = self.robot.step(self.now_us, messages);
        self.said.extend(said);
    }

    fn order(&mut self, order: &Order) {
        self.hear(&[Message::Order(order.clone())]);
    }

    fn instant(&mut self, kind: &str, id: &str) {
        self.hear(&[Message::InstantActions(vec![action(kind, id)])]);
    }

    fn instant_with(&mut self, kind: &str, id: &str, parameters: &[(&str, Value)]) {
        self.hear(&[Message::InstantActions(vec![with(action(kind, id), parameters)])]);
    }

    /// Lets time pass.
    fn run(&mut self, seconds: f64) {
        let end_us = self.now_us + (seconds * 1e6) as i64;
        while self.now_us < end_us {
            self.now_us += TICK_US;
            self.hear(&[]);
        }
    }

    fn x(&self) -> f64 {
        self.robot.body().report(Vec::new()).x
    }

    fn stands(&self) -> bool {
        self.robot.body().report(Vec::new()).stands()
    }

    fn state(&self) -> State {
        self.robot.robot.state()
    }

    /// The states that were said, oldest first.
    fn states(&self) -> Vec<State> {
        let state = |said: &RobotMessage| match &said.message {
            Message::State(state) => Some(state.as_ref().clone()),
            _ => None,
        };
        self.said.iter().filter_map(state).collect()
    }

    fn connections(&self) -> Vec<ConnectionState> {
        let connection = |said: &RobotMessage| match said.message {
            Message::Connection(connection) => Some(connection),
            _ => None,
        };
        self.said.iter().filter_map(connection).collect()
    }

    /// The ids of the nodes to reach, as said now.
    fn nodes_left(&self) -> Vec<String> {
        self.state().nodes.into_iter().map(|node| node.id).collect()
    }

    /// The status of an action, of the order or instant.
    fn status(&self, id: &str) -> Option<ActionStatus> {
        let state = self.state();
        let mut all = state.actions.iter().chain(&state.instant_actions);
        all.find(|action| action.id == id).map(|action| action.status)
    }

    /// The types of the errors that stand.
    fn errors(&self) -> Vec<String> {
        self.state().errors.into_iter().map(|error| error.kind).collect()
    }
}

fn action(kind: &str, id: &str) -> Action {
    Action {
        kind: kind.to_owned(),
        id: id.to_owned(),
        blocking: BlockingType::None,
        parameters: Vec::new(),
        retriable: false,
    }
}

fn hard(kind: &str, id: &str) -> Action {
    Action { blocking: BlockingType::Hard, ..action(kind, id) }
}

fn with(action: Action, parameters: &[(&str, Value)]) -> Action {
    let parameter = |(key, value): &(&str, Value)| Parameter { key: (*key).to_owned(), value: value.clone() };
    Action { parameters: parameters.iter().map(parameter).collect(), ..action }
}

/// An order along the x axis: nodes by name and place in metres, of which the first so many are released.
fn order(id: &str, update: u32, first: u32, nodes: &[(&str, f64)], released: usize) -> Order {
    let nodes: Vec<Node> = (nodes.iter().enumerate())
        .map(|(i, (name, x))| Node {
            id: (*name).to_owned(),
            sequence: first + 2 * i as u32,
            released: i < released,
            position: Some(NodePosition {
                x: *x,
                y: 0.0,
                theta: None,
                deviation_m: None,
                deviation_rad: None,
                map: "lab".to_owned(),
            }),
            actions: Vec::new(),
        })
        .collect();
    let edges = (nodes.iter().zip(nodes.iter().skip(1)))
        .map(|(from, to)| Edge {
            id: format!("{}-{}", from.id, to.id),
            sequence: from.sequence + 1,
            released: to.released,
            from: from.id.clone(),
            to: to.id.clone(),
            max_speed_mps: None,
            corridor: None,
            actions: Vec::new(),
        })
        .collect();
    Order { id: id.to_owned(), update, nodes, edges }
}

/// An order from `n0` over three metres to `n1`.
fn short_order(id: &str) -> Order {
    order(id, 0, 0, &[("n0", 0.0), ("n1", 3.0)], 2)
}

/// An order over two nodes of the base with one more in the horizon, three metres each.
fn order_with_horizon() -> Order {
    order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 2)
}

//! Corridors: on the edges of orders for robots that may leave the line, as their version says it.

use super::*;
use giveway_floor::geometry::Point;
use giveway_floor::warehouse::{Corridor, Draft, DraftLane, DraftNode, Users};
use giveway_vda5050::{Edge, Velocity};

/// A straight way with a charger, six nodes 4 m apart and a parking place; the lanes between the nodes have corridors,
/// as seen by those who drive from the charger on.
pub(super) fn way() -> Warehouse {
    let mut draft = Draft { name: "way".into(), footprint_m: 0.9, ..Draft::default() };
    let mut node = |name: &str, x: f64| {
        draft.nodes.push(DraftNode { name: name.into(), at: Point::new(x, 0.0) });
    };
    node("home", -2.0);
    (0..6).for_each(|i| node(&format!("n{i}"), 4.0 * f64::from(i)));
    node("end", 22.0);
    let mut lane = |a: &str, b: &str, corridor| {
        draft.lanes.push(DraftLane { corridor, ..DraftLane::both_ways(a, b, Users::ALL) });
    };
    let corridor = Some(Corridor { left_m: 1.5, right_m: 0.75 });
    (0..5).for_each(|i| lane(&format!("n{i}"), &format!("n{}", i + 1), corridor));
    lane("home", "n0", None);
    lane("n5", "end", None);
    (draft.chargers, draft.parking) = (vec!["home".into()], vec!["end".into()]);
    draft.walkable =
        vec![[(-3.0, -5.0), (27.0, -5.0), (27.0, 5.0), (-3.0, 5.0)].map(|(x, y)| Point::new(x, y)).into()];
    draft.build().expect("it is a map")
}

/// A robot at the charger of that way, of a kind that may leave the line.
pub(super) fn free(setup: RobotSetup) -> LinkFloor {
    let settings = RobotLinkSettings { free_navigation: true, ..settings() };
    let mut floor = LinkFloor::of_kind(way(), vec![setup], settings);
    floor.all_ready();
    floor
}

impl LinkFloor {
    pub(super) fn node(&self, name: &str) -> NodeId {
        let map = self.map();
        map.nodes.pairs().find(|(_, node)| node.name == name).expect("the map has it").0
    }

    /// Sends the robot to a node.
    pub(super) fn go(&mut self, name: &str) -> JobId {
        let (robot, node) = (self.pairs[0].number.expect("it has joined"), self.node(name));
        self.submit(JobRequest::new(JobKind::Go { robot, node }))
    }

    /// The edges of all orders to the first robot.
    fn edges(&self) -> Vec<Edge> {
        let told = self.pairs[0].told.iter();
        let orders = told.filter_map(|(.., message)| match message {
            Message::Order(order) => Some(order.edges.clone()),
            _ => None,
        });
        orders.flatten().collect()
    }
}

fn widths(edge: &Edge) -> Option<(f64, f64)> {
    edge.corridor.map(|corridor| (corridor.left_m, corridor.right_m))
}

#[test]
fn each_edge_of_a_lane_with_a_corridor_has_it_in_the_direction_of_travel() {
    for version in [Version::V2_1, Version::V3_0] {
        let mut floor = free(standard(version));
        let there = floor.go("end");
        floor.until_done(&[there], 120);
        let home = floor.go("home");
        floor.until_done(&[home], 120);
        let edges = floor.edges();
        for (from, to) in [("n0", "n1"), ("n1", "n0")] {
            assert!(edges.iter().any(|edge| edge.released && edge.from == from && edge.to == to));
        }
        for edge in &edges {
            let is_lane = !edge.from.starts_with("home") && !edge.to.starts_with("home");
            let has = is_lane && edge.from != "end" && edge.to != "end";
            let expected = if edge.from < edge.to { (1.5, 0.75) } else { (0.75, 1.5) };
            assert_eq!(widths(edge), has.then_some(expected), "{edge:?}");
            let asks = edge.corridor.is_none_or(|c| c.release_required == (version == Version::V3_0));
            assert!(asks && edge.corridor.is_none_or(|c| c.of_contour), "{edge:?}");
        }
    }
}

#[test]
fn no_robot_of_2_0_and_none_whose_kind_keeps_to_the_line_gets_a_corridor() {
    let mut old = free(standard(Version::V2_0));
    let mut bound = LinkFloor::new(way(), vec![standard(Version::V2_1)]);
    bound.all_ready();
    for floor in [&mut old, &mut bound] {
        let job = floor.go("end");
        floor.until_done(&[job], 120);
        assert!(floor.edges().iter().all(|edge| edge.corridor.is_none()));
    }
}

#[test]
fn a_robot_that_is_wider_than_a_corridor_keeps_to_the_line() {
    let has_any = |width_m: f64| {
        let mut setup = standard(Version::V2_1);
        setup.factsheet.as_mut().expect("it has one").width_m = Some(width_m);
        let mut floor = free(setup);
        let job = floor.go("end");
        floor.until_done(&[job], 120);
        floor.edges().iter().any(|edge| edge.corridor.is_some())
    };
    assert!(has_any(1.5) && !has_any(1.6) && !has_any(1e9));
}

#[test]
fn a_robot_beside_the_line_within_its_corridor_is_not_displaced() {
    let mut floor = free(standard(Version::V2_1));
    let job = floor.go("end");
    floor.until(60, "it is on a lane with a corridor", |f| f.pairs[0].place().0 > 5.0);
    let robot = floor.pairs[0].number.expect("it has joined");
    let beside = |floor: &LinkFloor, y: f64| {
        let (_, state) = floor.pairs[0].session.state().expect("it was heard");
        let mut state = state.clone();
        state.position.as_mut().expect("it says where").y = y;
        state.velocity = Some(Velocity { vx: 0.0, vy: 0.0, omega: 0.0 });
        let stamp = MessageStamp { id: floor.pairs[0].next, timestamp: format!("{:020}", floor.now.0) };
        RobotHeard::State(Box::new(state), stamp)
    };
    for (y, is_displaced) in [(1.2, false), (3.0, true)] {
        // It stands there in the second report.
        for _report in 0..2 {
            let said = beside(&floor, y);
            let (out, mut inputs) = (floor.pairs[0].session.hear(floor.now, said), Vec::new());
            floor.take(0, out, &mut inputs);
            floor.fleet.step(floor.now, inputs);
            floor.now += PERIOD;
        }
        assert_eq!(floor.fleet.displacement(robot).is_some(), is_displaced, "{y} m beside the line");
    }
    floor.until_done(&[job], 240);
}

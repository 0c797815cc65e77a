//! Tests that simulated robots drive, turn, brake and act on orders.

use super::*;
use giveway_floor::id::BodyId;
use giveway_floor::timeline::{Reserved, Timeline};
use giveway_floor::warehouse::lab;
use std::sync::Arc;

fn proof(warehouse: &Warehouse, node: NodeId) -> Reserved {
    let mut timeline = Timeline::new(Arc::new(warehouse.clone()), Span::from_millis(100));
    let stands = giveway_fleet::state::ledger::stand(node, Time::ZERO);
    timeline.reserve(RobotId(0), vec![stands]).expect("nobody else is there")
}

/// A robot on a node of the laboratory, and the nodes of a lane that begins there.
fn body_on_a_lane(w: &Warehouse) -> (RobotBody, [NodeId; 2]) {
    let arc = w.arcs.iter().next().expect("a lane of the laboratory");
    let footprints = [false, true].map(|loaded| w.footprint(BodyId(0), loaded).clone());
    let at = w.nodes[arc.from].at;
    let body = RobotBody::new(RobotId(0), arc.from, at, 1.0, (&RobotKind::default(), footprints));
    (body, [arc.from, arc.to])
}

fn drive(w: &Warehouse, first: u64, nodes: &[NodeId], act: Option<Act>, recalls: u64) -> Command {
    let waypoints = (first..).zip(nodes).map(|(serial, n)| Waypoint { serial, node: *n, act, passes: None });
    Command::Drive { grant: proof(w, nodes[0]), waypoints: waypoints.collect(), recalls, horizon: vec![] }
}

#[test]
fn a_robot_that_forgot_its_way_between_two_nodes_goes_to_either_and_turns_only_when_it_stands() {
    let w = lab();
    let (mut body, [home, next]) = body_on_a_lane(&w);
    let mut now = Time::ZERO;
    let mut live = |body: &mut RobotBody, seconds: f64| {
        let from = now;
        now += Span::from_secs_f64(seconds);
        body.advance(from, now, false);
        (body.pose.at - w.nodes[home].at).norm()
    };
    body.obey(&drive(&w, 0, &[home, next], None, 0), &w);
    while live(&mut body, 0.1) < 0.3 {}
    body.obey(&Command::Revoke { reached: 0, number: 1 }, &w);
    assert_eq!((body.recalls, body.known()), (0, 1), "it drives");
    body.obey(&Command::Limit(Some(0.0)), &w);
    let stood = live(&mut body, 2.0);
    body.obey(&Command::Revoke { reached: 0, number: 1 }, &w);
    body.obey(&Command::Limit(None), &w);
    assert_eq!((body.recalls, body.known(), live(&mut body, 1.0)), (1, 0, stood), "it stays where it is");
    body.obey(&drive(&w, 0, &[home, next], None, 0), &w);
    assert_eq!(live(&mut body, 1.0), stood, "an order from before");
    body.obey(&drive(&w, 0, &[home], None, 1), &w);
    let back = live(&mut body, 2.5);
    body.obey(&drive(&w, 0, &[home, next], None, 1), &w);
    assert!(back < stood && body.returns(), "it does not turn round while it drives");
    body.obey(&Command::Limit(Some(0.0)), &w);
    live(&mut body, 2.0);
    body.obey(&drive(&w, 0, &[home, next], None, 1), &w);
    body.obey(&Command::Limit(None), &w);
    live(&mut body, 10.0);
    assert_eq!((body.reached, body.node), (1, next));
}

#[test]
fn a_robot_that_was_pushed_ignores_orders_for_where_it_was_and_takes_the_one_for_where_it_is() {
    let w = lab();
    let (mut body, [home, next]) = body_on_a_lane(&w);
    let far = |n: &NodeId| (w.nodes[*n].at - w.nodes[home].at).norm() > 3.0;
    let away = w.nodes.ids().find(far).expect("the laboratory is larger than that");
    body.put(w.nodes[away].at, away);
    assert!(body.is_astray());
    body.obey(&drive(&w, 0, &[home, next], Some(Act::Lift(RackId(0))), 0), &w);
    body.obey(&Command::Revoke { reached: 0, number: 1 }, &w);
    body.advance(Time::ZERO, Time::from_secs_f64(5.0), false);
    let said = body.report(Time::ZERO);
    assert_eq!((said.reached, said.known, said.rack, said.recalls), (0, 0, None, 0));
    assert_eq!(said.pose.at, w.nodes[away].at, "it stays where it was put");
    body.obey(&drive(&w, 7, &[away], None, 0), &w);
    assert_eq!((body.reached, body.node, body.is_astray()), (7, away, false));
    body.put(w.nodes[home].at, home);
    body.obey(&drive(&w, 7, &[away], None, 0), &w);
    assert!(body.is_astray(), "the same order says nothing about where it was put next");
}

#[test]
fn a_robot_that_the_guard_of_a_station_holds_neither_drives_nor_turns() {
    let w = lab();
    let (mut body, [home, next]) = body_on_a_lane(&w);
    body.obey(&drive(&w, 0, &[home, next], None, 0), &w);
    let heading = turned_away(&w, &mut body);
    body.hand_guard = true;
    let (before, now) = (body.pose, Time::from_secs_f64(3.0));
    body.advance(Time::ZERO, now, false);
    assert_eq!((body.pose.at, body.pose.heading), (before.at, heading));
    assert!(body.would_move(), "nothing else keeps it");
    body.hand_guard = false;
    body.advance(now, Time::from_secs_f64(6.0), false);
    assert!(body.pose.heading != heading && body.pose.at != before.at);
}

/// Turns a robot a quarter away from its path. Gives its heading then.
fn turned_away(w: &Warehouse, body: &mut RobotBody) -> f64 {
    let next = body.path.iter().find(|t| (t.at - body.pose.at).norm() > 0.1).expect("it has a way");
    let way = Segment { a: w.nodes[body.node].at, b: next.at };
    body.pose.heading = wrap_angle(way.heading() + 1.5);
    body.pose.heading
}

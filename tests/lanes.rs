//! Lanes that cross without a common node: a robot that has left one must not block another there.
use giveway::id::*;
use giveway::time::*;
use giveway::timeline::*;
use giveway::warehouse::formats::json;
use std::sync::Arc;

#[test]
fn a_lane_is_free_as_soon_as_the_robot_stands_at_its_end() {
    let text = r#"{"giveway_map":1,"name":"x","footprint_m":0.4,"nodes":[{"id":"W","x":0,"y":0},{"id":"X","x":1,"y":0},
    {"id":"s","x":1,"y":1},{"id":"Y","x":0,"y":1},{"id":"P","x":2,"y":0}],
    "lanes":[{"from":"W","to":"s","both":true},{"from":"X","to":"Y","both":true},{"from":"s","to":"X","both":true},
    {"from":"W","to":"X","both":true},{"from":"X","to":"P","both":true}],"parking":["P"]}"#;
    let w = Arc::new(json::parse(text).expect("ok"));
    let lane = |a: &str, b: &str| {
        let (a, b) = (w.node_named(a).unwrap(), w.node_named(b).unwrap());
        w.lanes
            .pairs()
            .find(|(_, l)| (l.a == a && l.b == b) || (l.a == b && l.b == a))
            .map(|(i, _)| w.lane_resource(i))
            .unwrap()
    };
    let (l, m) = (lane("W", "s"), lane("X", "Y"));
    let n = |a: &str| w.node_named(a).unwrap();
    let t = |s: f64| Time::from_secs_f64(s);
    let mut tl = Timeline::new(w.clone(), Span::from_millis(100));
    let v = |node, lane, e, a, d, le, stay| Visit {
        node,
        lane,
        loaded: false,
        enter: e,
        arrive: a,
        depart: d,
        leave: le,
        stay: Span::from_secs(stay),
    };
    let (a, b) = (RobotId(0), RobotId(1));
    tl.reserve(
        a,
        vec![
            v(n("W"), None, t(0.), t(0.), t(0.), t(2.1), 0),
            v(n("s"), Some(l), t(0.), t(2.), t(12.), t(14.1), 10),
            v(n("X"), None, t(12.), t(14.), t(14.), t(16.1), 0),
            v(n("P"), None, t(14.), t(16.), Time::MAX, Time::MAX, 0),
        ],
    )
    .unwrap();
    tl.reserve(
        b,
        vec![
            v(n("X"), None, t(0.), t(0.), t(3.), t(5.1), 0),
            v(n("Y"), Some(m), t(3.), t(5.), Time::MAX, Time::MAX, 0),
        ],
    )
    .unwrap();
    tl.grant(a, 0, t(0.));
    tl.grant(b, 0, t(0.));
    tl.grant(a, 1, t(0.));
    tl.release(a, 1); // A has reached s
    assert!(tl.waits_for(a, 2).is_none() || tl.waits_for(b, 1).is_none(), "both wait for each other");
}

/// Nodes in a row, so close that the node beyond is in conflict with the node before it and with the lane to that.
#[test]
fn a_delay_keeps_free_what_a_node_and_the_lane_to_it_are_both_in_conflict_with() {
    use giveway::geometry::Point;
    use giveway::warehouse::{Draft, DraftLane, DraftNode, Users};
    let name = |i: usize| format!("N{i}");
    let nodes = (0..8).map(|i| DraftNode { name: name(i), at: Point::new(i as f64 * 0.5, 0.0) }).collect();
    let lane = |i| DraftLane {
        kinds: None,
        corridor: None,
        from: name(i),
        to: name(i + 1),
        both: true,
        length_m: None,
        speed_limit_mps: None,
        users: Users::ALL,
    };
    let lanes = (0..7).map(lane).collect();
    let draft = Draft { name: "row".into(), footprint_m: 0.9, nodes, lanes, ..Draft::default() };
    let w = Arc::new(draft.build_unchecked());
    let (lane, beyond) = (w.lane_resource(LaneId(1)), ResourceId(3));
    for r in [ResourceId(2), lane] {
        assert!(w.conflicts(r).contains(&beyond), "the node beyond is in conflict with node and lane");
    }
    let v = |node, lane, [enter, arrive, depart, leave]: [i64; 4], stay| Visit {
        node: NodeId(node),
        lane,
        loaded: false,
        enter: Time(enter),
        arrive: Time(arrive),
        depart: Time(depart),
        leave: Time(leave),
        stay: Span(stay),
    };
    let robot = RobotId(0);
    let last = v(6, None, [25, 28, i64::MAX, i64::MAX], 0);
    let visits = vec![v(1, None, [0, 0, 6, 13], 0), v(2, Some(lane), [5, 8, 20, 30], 12), last];
    let mut timeline = Timeline::new(w, Span(1));
    timeline.reserve(robot, visits).expect("nobody else is there");
    timeline.grant(robot, 0, Time(0));
    let slip = timeline.delay(robot, 0, Time(10));
    let slip: Vec<_> = slip.iter().map(|(h, shifts)| (*h, shifts.as_slice())).collect();
    timeline.slide(&slip);
    let free: Vec<FreeWindow> = timeline.view().free_windows(LineId(beyond.0), Time(0)).collect();
    assert_eq!((free[0].end, free[1].start), (Time(9), Time(34)), "until the robot has left: {free:?}");
}

//! The physical and the conflicting layer of places, on the figure of the thesis.

use super::*;

/// Figure 4.3b of Petković 2021: the node C is in conflict with B, D and E. Blue's way to B leads over C.
fn figure() -> Arc<Warehouse> {
    let mut draft = Draft { name: "figure 4.3".into(), footprint_m: 0.9, ..Draft::default() };
    for (name, x, y) in
        [("A", -1.4, 0.0), ("B", 0.8, 0.0), ("C", 0.0, 0.0), ("D", -0.35, 0.6), ("E", -0.35, -0.6)]
    {
        draft.nodes.push(DraftNode { name: name.into(), at: Point::new(x, y) });
    }
    for to in ["A", "B"] {
        draft.lanes.push(DraftLane::both_ways("C", to, Users::ALL));
    }
    Arc::new(draft.build_unchecked())
}

#[test]
fn a_plan_fails_on_the_conflicting_layer_of_a_place_that_is_physically_free() {
    let warehouse = figure();
    let resource = |n: u32| warehouse.node_resource(NodeId(n));
    let (a, b, c, d, e) = (0, 1, 2, 3, 4);
    let mut conflicts = warehouse.conflicts(resource(c)).to_vec();
    conflicts.retain(|r| warehouse.resource(*r).is_ok());
    conflicts.sort_unstable();
    assert_eq!(conflicts, [resource(b), resource(d), resource(e)]);

    let mut timeline = Timeline::new(warehouse.clone(), Span::from_millis(100));
    let red = RobotId(1);
    timeline.reserve(red, vec![still(e, Time(0), Time::MAX)]).expect("the floor is empty");
    let layers = |n: u32| {
        let held = timeline.holds(resource(n), Window::new(Time(0), Time(1_000_000)));
        held.into_iter().map(|h| (h.holder, h.layer)).collect::<Vec<_>>()
    };
    assert_eq!(layers(e), [(red, crate::timeline::Layer::Physical)]);
    assert_eq!(layers(c), [(red, crate::timeline::Layer::Conflict)], "nobody stands there, and nobody may");
    assert_eq!([layers(a), layers(b), layers(d)], [vec![], vec![], vec![]], "Red is in no other's way");

    let (blue, goal) = (still(a, Time(0), Time::MAX), [to(b)]);
    let plan = |timeline: &Timeline| {
        let mut planner = Planner::new(warehouse.clone(), drive());
        planner.plan(&ask(&blue, &goal), &timeline.view()).is_ok()
    };
    assert!(!plan(&timeline), "C is free on its physical layer, and its conflicting layer has Red");
    timeline.remove(red);
    assert!(plan(&timeline), "without Red the same plan is found");
}

//! Never stuck, exhaustively: every interleaving of grants and moves of three robots on tiny floors, with delays.

use giveway_floor::id::{Dense, NodeId, RobotId};
use giveway_floor::route::{Kinematics, NO_PEOPLE, Planner, RouteQuery, Rules, Stage};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::{Chain, Timeline, Visit};
use giveway_floor::warehouse::{Warehouse, sketch};
use std::collections::HashSet;
use std::sync::Arc;

const LATE: Span = Span::from_secs(7);

fn holder(i: usize) -> RobotId {
    RobotId::at(i)
}

fn stand(node: NodeId) -> Visit {
    let (from, to) = (Time::ZERO, Time::MAX);
    let stay = Span::ZERO;
    Visit { node, lane: None, loaded: false, enter: from, arrive: from, depart: to, leave: to, stay }
}

/// Until then, robots that are still to be planned are assumed to stand where they are.
const HEAD_START: Time = Time(20_000_000);

/// Routes of all robots, planned in this order, each around those before it; `None` if one finds no way.
fn plan(planner: &mut Planner, ways: &[(NodeId, NodeId)], order: &[usize]) -> Option<Timeline> {
    let mut timeline = Timeline::new(planner.warehouse().clone(), Kinematics::default().clearance);
    for (turn, &i) in order.iter().enumerate() {
        let mut others = timeline.view();
        for &later in &order[turn + 1..] {
            let waits = Visit { depart: HEAD_START, leave: HEAD_START, ..stand(ways[later].0) };
            others.add(holder(later), &[waits]).ok()?;
        }
        let (from, stage) = (stand(ways[i].0), Stage::to_stay(ways[i].1));
        let ask = RouteQuery {
            from: &from,
            heading: 0.0,
            ready: Time::ZERO,
            stages: &[stage],
            budget: 100_000,
            conditions: &NO_PEOPLE,
            exemptions: &[],
        };
        let route = planner.plan(&ask, &others).ok()?;
        let visits = std::iter::once(route.kept).chain(route.visits).collect();
        timeline.reserve(holder(i), visits).ok()?;
    }
    for &i in order {
        timeline.grant(holder(i), 0, Time::ZERO);
    }
    Some(timeline)
}

/// What was found while visiting all states.
#[derive(Default)]
struct Explored {
    seen: HashSet<(Vec<Chain>, usize)>,
    finals: usize,
    stuck: Vec<Vec<Chain>>,
}

impl Explored {
    /// Visits every state that can be reached, in any order, by granting a robot its next visit, by a robot arriving
    /// there, and by at most `delays` times a robot being late.
    fn explore(start: Timeline, delays: usize) -> Explored {
        let mut found = Explored::default();
        let mut open = vec![(start, delays)];
        while let Some((timeline, delays)) = open.pop() {
            let chains: Vec<Chain> = timeline.chains().map(|(_, c)| c.clone()).collect();
            if !found.seen.insert((chains.clone(), delays)) {
                continue;
            }
            timeline.assert_sound();
            let holders: Vec<RobotId> = timeline.chains().map(|(h, _)| h).collect();
            let moves: Vec<Timeline> = holders.iter().flat_map(|h| moves(&timeline, *h)).collect();
            if chains.iter().all(|c| c.first() + 1 == c.end()) {
                found.finals += 1;
            } else if moves.is_empty() {
                found.stuck.push(chains);
            }
            open.extend(moves.into_iter().map(|t| (t, delays)));
            if delays > 0 {
                open.extend(holders.iter().filter_map(|h| Some((delayed(&timeline, *h)?, delays - 1))));
            }
        }
        found
    }
}

/// What a robot can do next: get its next visit, or arrive at the next one that it was given.
fn moves(timeline: &Timeline, h: RobotId) -> Vec<Timeline> {
    let chain = timeline.chain(h).expect("it holds something");
    let mut next = Vec::new();
    if chain.granted() < chain.end() && timeline.waits_for(h, chain.granted()).is_none() {
        let before = chain.get(chain.granted() - 1).expect("it is still held").enter;
        let mut granted = timeline.clone();
        // The grant comes as early as it can.
        granted.grant(h, chain.granted(), before + Span(1));
        next.push(granted);
    }
    if chain.first() + 1 < chain.granted() {
        let mut passed = timeline.clone();
        passed.release(h, chain.first() + 1);
        next.push(passed);
    }
    next
}

fn delayed(timeline: &Timeline, h: RobotId) -> Option<Timeline> {
    let chain = timeline.chain(h)?;
    let here = chain.get(chain.first()).filter(|v| !v.depart.is_forever())?;
    let mut late = timeline.clone();
    late.postpone(h, chain.first(), here.depart + LATE);
    Some(late)
}

fn permutations(items: &[usize]) -> Vec<Vec<usize>> {
    if items.is_empty() {
        return vec![vec![]];
    }
    let mut all = Vec::new();
    for &first in items {
        let rest: Vec<usize> = items.iter().copied().filter(|i| *i != first).collect();
        all.extend(permutations(&rest).into_iter().map(|p| [vec![first], p].concat()));
    }
    all
}

/// All ways to give these goals to robots at these starts, planned in all orders.
#[track_caller]
fn check(drawing: &str, starts: [&str; 3], goals: [&str; 3], delays: usize, at_least: usize) {
    let warehouse: Arc<Warehouse> = Arc::new(sketch(drawing).build_unchecked());
    let mut planner = Planner::new(warehouse.clone(), Rules::Drive(Kinematics::default()));
    let node = |name: &str| warehouse.node_named(name).unwrap_or_else(|| panic!("there is no node {name}"));
    let mut planned = 0;
    for goal in permutations(&[0, 1, 2]) {
        let ways: Vec<(NodeId, NodeId)> = (0..3).map(|i| (node(starts[i]), node(goals[goal[i]]))).collect();
        for order in permutations(&[0, 1, 2]) {
            let Some(timeline) = plan(&mut planner, &ways, &order) else { continue };
            planned += 1;
            let found = Explored::explore(timeline, delays);
            assert_eq!(found.stuck, Vec::<Vec<Chain>>::new(), "{ways:?} planned in the order {order:?}");
            assert!(found.finals > 0, "{ways:?}: everybody arrives");
        }
    }
    assert!(planned >= at_least, "only {planned} of 36 were planned");
}

#[test]
fn robots_that_change_places_on_a_small_grid_can_always_move() {
    check("...\n...", ["0,0", "1,0", "2,0"], ["0,0", "1,0", "2,0"], 0, 10);
}

#[test]
fn robots_that_cross_a_small_grid_can_always_move_also_when_one_is_late() {
    check("...\n...", ["0,0", "1,0", "2,0"], ["0,1", "1,1", "2,1"], 1, 10);
}

#[test]
fn robots_on_a_ring_can_always_move_also_when_one_is_late() {
    check("...\n. .\n...", ["0,0", "2,0", "2,2"], ["0,0", "2,0", "2,2"], 1, 10);
}

#[test]
fn robots_that_pass_one_another_in_a_bay_can_always_move() {
    check(".....\n..  .", ["0,0", "2,1", "4,0"], ["0,1", "3,1", "4,1"], 1, 6);
}

#[test]
fn without_a_clearance_a_ring_of_robots_is_stuck_and_the_exploration_sees_it() {
    let warehouse: Arc<Warehouse> = Arc::new(sketch("..\n..").build_unchecked());
    let mut timeline = Timeline::new(warehouse.clone(), Span::ZERO);
    let ring: Vec<NodeId> =
        ["0,0", "1,0", "1,1", "0,1"].iter().map(|n| warehouse.node_named(n).expect("it is drawn")).collect();
    let turn = Time::from_secs_f64(10.0);
    for i in 0..4 {
        let first = Visit { depart: turn, leave: turn, ..stand(ring[i]) };
        let second = Visit { enter: turn, arrive: turn, ..stand(ring[(i + 1) % 4]) };
        timeline.reserve(holder(i), vec![first, second]).expect("windows that touch do not overlap");
        timeline.grant(holder(i), 0, Time::ZERO);
    }
    let found = Explored::explore(timeline, 0);
    assert_eq!((found.stuck.len(), found.finals), (1, 0));
}

//! The search against brute force: every walk, motion and choice of windows on small floors.

mod layers;

use super::*;
use crate::geometry::Point;
use crate::id::{ArcId, ClosureId, Dense, LineId, RobotId};
use crate::time::Window;
use crate::timeline::{FreeWindow, Timeline};
use crate::warehouse::{Body, Draft, DraftLane, DraftNode, Footprint, Users};
use proptest::prelude::*;

fn grid(columns: usize, rows: usize) -> Arc<Warehouse> {
    let name = |x: usize, y: usize| format!("{x},{y}");
    let mut draft = Draft { name: "grid".into(), footprint_m: 0.9, ..Draft::default() };
    for y in 0..rows {
        for x in 0..columns {
            draft.nodes.push(DraftNode { name: name(x, y), at: Point::new(x as f64, y as f64) });
            let right = (x + 1 < columns).then(|| name(x + 1, y));
            let up = (y + 1 < rows).then(|| name(x, y + 1));
            for to in right.into_iter().chain(up) {
                draft.lanes.push(DraftLane {
                    kinds: None,
                    corridor: None,
                    from: name(x, y),
                    to,
                    both: true,
                    length_m: None,
                    speed_limit_mps: None,
                    users: Users::ALL,
                });
            }
        }
    }
    Arc::new(draft.build_unchecked())
}

fn still(node: u32, enter: Time, leave: Time) -> Visit {
    let depart = leave;
    let stay = Span::ZERO;
    Visit { node: NodeId(node), lane: None, loaded: false, enter, arrive: enter, depart, leave, stay }
}

fn start() -> Visit {
    still(0, Time(0), Time::MAX)
}

fn drive() -> Rules {
    Rules::Drive(Kinematics::default())
}

const PEBBLE: Rules = Rules::Pebble { step: Span(1_000_000), turns: false };
const TURNS: Rules = Rules::Pebble { step: Span(1_000_000), turns: true };

/// A timeline with holds of other robots: `(node, start, length)` in half seconds; clashing ones are left out.
fn strangers(warehouse: &Arc<Warehouse>, holds: &[(u32, i64, i64)], unit: i64) -> Timeline {
    let mut timeline = Timeline::new(warehouse.clone(), Span::from_millis(100));
    for (i, (node, from, length)) in holds.iter().enumerate() {
        let (from, to) = (Time(from * unit), Time((from + length) * unit));
        let _ = timeline.reserve(RobotId(100 + i as u32), vec![still(*node, from, to)]);
    }
    timeline
}

fn ask<'a>(from: &'a Visit, stages: &'a [Stage]) -> RouteQuery<'a> {
    RouteQuery {
        from,
        heading: 0.0,
        ready: Time(0),
        stages,
        budget: 1_000_000,
        conditions: &NO_PEOPLE,
        exemptions: &[],
    }
}

fn to(goal: u32) -> Stage {
    Stage::to_stay(NodeId(goal))
}

/// Earliest arrival at `goal` by trying everything: walks of at most `steps` arcs, all gaits, all choices of free
/// windows.
struct Brute<'a> {
    warehouse: &'a Warehouse,
    pace: &'a Pace,
    timeline: &'a Timeline,
    goal: NodeId,
    best: i64,
    walk: Vec<TestStep>,
}

#[derive(Clone, Copy)]
struct TestStep {
    arc: ArcId,
    free: FreeWindow,
    motion: MotionState,
}

impl Brute<'_> {
    fn go(&mut self, at: NodeId, start_gap: FreeWindow, steps: usize) {
        let Some(arrival) = self.schedule(start_gap) else { return };
        let last = self.walk.last();
        let standing = last.is_none_or(|s| s.motion == MotionState::Standing);
        if at == self.goal && standing && last.map_or(start_gap, |s| s.free).end.is_forever() {
            self.best = self.best.min(arrival);
        }
        if steps == 0 || arrival >= self.best {
            return;
        }
        let hops: Vec<(ArcId, NodeId)> = self.warehouse.out(at).map(|(id, a)| (id, a.to)).collect();
        for (arc, next) in hops {
            for free in self.timeline.view().free_windows(LineId(next.0), Time(0)).collect::<Vec<_>>() {
                for motion in [MotionState::Standing, MotionState::Rolling] {
                    self.walk.push(TestStep { arc, free, motion });
                    self.go(next, start_gap, steps - 1);
                    self.walk.pop();
                }
            }
        }
    }

    /// Earliest arrival of the walk so far as a system of difference constraints, solved by repetition.
    fn schedule(&self, start_gap: FreeWindow) -> Option<i64> {
        let n = self.walk.len();
        let mut depart = vec![0i64; n];
        let (clear, lead) = (self.pace.clearance().0, self.pace.lead(false).0);
        let motion = |i: usize| if i == 0 { MotionState::Standing } else { self.walk[i - 1].motion };
        let span = |i: usize| self.pace.drive(self.walk[i].arc, false, motion(i), self.walk[i].motion).0;
        for round in 0..=2 * n {
            let mut changed = false;
            for i in 0..n {
                let arc = self.warehouse.arcs[self.walk[i].arc];
                let heading = if i == 0 { 0.0 } else { self.warehouse.arcs[self.walk[i - 1].arc].heading };
                let arrive = if i == 0 { 0 } else { depart[i - 1] + span(i - 1) };
                let straight = crate::geometry::turn_between(heading, arc.heading) < 0.1;
                let rolling = motion(i) == MotionState::Rolling;
                if rolling && !straight
                    || !self.pace.can_roll() && self.walk[i].motion == MotionState::Rolling
                {
                    return None;
                }
                let turn = if rolling { 0 } else { self.pace.turn_between(heading, arc.heading).0 };
                let window = self.walk[i].free.start.0 + if rolling { lead } else { 0 };
                let need = depart[i].max(arrive + turn).max(window);
                changed |= need > depart[i];
                depart[i] = need;
                // A rolling robot departs when it arrives: a later departure means a later one before.
                if rolling && depart[i] > arrive {
                    depart[i - 1] += depart[i] - arrive;
                    changed = true;
                }
                let own_gap = if i == 0 { start_gap } else { self.walk[i - 1].free };
                let reached = depart[i] + span(i);
                if reached + clear > own_gap.end.0 || reached >= self.walk[i].free.end.0 {
                    return None;
                }
            }
            if !changed {
                return Some(n.checked_sub(1).map_or(0, |l| depart[l] + span(l)));
            }
            assert!(round < 2 * n, "difference constraints along a walk settle");
        }
        None
    }
}

fn brute(warehouse: &Warehouse, pace: &Pace, timeline: &Timeline, goal: u32, steps: usize) -> Option<i64> {
    let start_gap = timeline.view().free_windows(LineId(0), Time(0)).next()?;
    if start_gap.start > Time(0) {
        return None;
    }
    let mut b = Brute { warehouse, pace, timeline, goal: NodeId(goal), best: i64::MAX, walk: Vec::new() };
    b.go(NodeId(0), start_gap, steps);
    (b.best < i64::MAX).then_some(b.best)
}

/// Asserts that a route fits between the holds of others, without changing any order.
fn assert_fits(timeline: &mut Timeline, route: &Route) {
    let own = RobotId(0);
    timeline.reserve(own, vec![start()]).expect("the start is free for ever or the search would have failed");
    timeline.replace(own, 0, route.kept.clone(), route.visits.clone()).expect("routes fit into windows");
    timeline.assert_sound();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn with_inertia_the_search_arrives_as_early_as_brute_force(
        holds in proptest::collection::vec((0u32..6, 1i64..24, 1i64..8), 0..4),
        goal in 0u32..6,
    ) {
        let warehouse = grid(3, 2);
        // The start stays free, so that the route can be reserved from it.
        let holds: Vec<_> = holds.into_iter().filter(|h| h.0 != 0).collect();
        let mut timeline = strangers(&warehouse, &holds, 500_000);
        let mut planner = Planner::new(warehouse.clone(), drive());
        let (from, stages) = (start(), [to(goal)]);
        let found = planner.plan(&ask(&from, &stages), &timeline.view());
        let best = brute(&warehouse, &planner.pace().clone(), &timeline, goal, 5);
        prop_assert_eq!(found.as_ref().ok().map(|r| r.arrival.0), best);
        if let Ok(route) = found { assert_fits(&mut timeline, &route); }
    }

    #[test]
    fn pebbles_arrive_as_early_as_a_breadth_first_search_over_time(
        holds in proptest::collection::vec((1u32..6, 1i64..7, 1i64..4), 0..8),
        goal in 0u32..6,
        turns in any::<bool>(),
    ) {
        let warehouse = grid(3, 2);
        let timeline = strangers(&warehouse, &holds, 1_000_000);
        let mut planner = Planner::new(warehouse.clone(), if turns { TURNS } else { PEBBLE });
        let (from, stages) = (start(), [to(goal)]);
        let found = planner.plan(&ask(&from, &stages), &timeline.view());
        let best = breadth_first(&warehouse, &timeline, goal, turns);
        prop_assert_eq!(found.ok().map(|r| r.arrival.0 / 1_000_000), best);
    }
}

/// Number of steps until `goal` is reached and free from then on; one step is a second.
fn breadth_first(warehouse: &Warehouse, timeline: &Timeline, goal: u32, turns: bool) -> Option<i64> {
    let free = |n: NodeId, t: i64| {
        let at = Time(t * 1_000_000);
        timeline.view().free_windows(LineId(n.0), at).next().is_some_and(|g| g.start <= at)
    };
    let for_ever = |n: NodeId, t: i64| (t..24).all(|u| free(n, u));
    let mut here = vec![(NodeId(0), 0i64)];
    for t in 0..20 {
        if here.iter().any(|(n, _)| n.0 == goal && for_ever(*n, t)) {
            return Some(t);
        }
        let mut next = Vec::new();
        for (n, quarter) in here {
            let mut add = |m: NodeId, q: i64| {
                if free(m, t + 1) && !next.contains(&(m, q)) {
                    next.push((m, q));
                }
            };
            add(n, quarter);
            if turns {
                add(n, (quarter + 1) % 4);
                add(n, (quarter + 3) % 4);
            }
            for (_, arc) in warehouse.out(n) {
                let q = ((arc.heading / std::f64::consts::FRAC_PI_2).round() as i64).rem_euclid(4);
                if !turns || q == quarter {
                    add(arc.to, q);
                }
            }
        }
        here = next;
    }
    None
}

#[test]
fn every_pattern_of_three_busy_nodes_over_four_steps_is_planned_optimally() {
    let warehouse = grid(2, 2);
    let mut planner = Planner::new(warehouse.clone(), PEBBLE);
    for pattern in 0u32..1 << 12 {
        let busy = (0..12).filter(|b| pattern >> b & 1 == 1);
        let holds: Vec<_> = busy.map(|b| (1 + b % 3, 1 + i64::from(b / 3), 1)).collect();
        let timeline = strangers(&warehouse, &holds, 1_000_000);
        for goal in 1..4 {
            let (from, stages) = (start(), [to(goal)]);
            let found =
                planner.plan(&ask(&from, &stages), &timeline.view()).ok().map(|r| r.arrival.0 / 1_000_000);
            assert_eq!(
                found,
                breadth_first(&warehouse, &timeline, goal, false),
                "pattern {pattern:#b} to {goal}"
            );
        }
    }
}

#[test]
fn two_pebbles_do_not_change_places() {
    let warehouse = grid(2, 1);
    let mut timeline = Timeline::new(warehouse.clone(), Span::ZERO);
    let second = Time(1_000_000);
    // Another robot leaves node 1 for node 0 in the same step in which this one would go the other way.
    let other = vec![still(1, Time(0), second), still(0, second, Time::MAX)];
    timeline.reserve(RobotId(7), other).unwrap();
    let mut planner = Planner::new(warehouse, PEBBLE);
    let (from, stages) = (start(), [to(1)]);
    assert_eq!(planner.plan(&ask(&from, &stages), &timeline.view()), Err(NoRoute::Blocked));
}

#[test]
fn nobody_plans_through_a_robot_that_stays_for_ever() {
    let warehouse = grid(3, 1);
    let timeline = {
        let mut t = Timeline::new(warehouse.clone(), Span::ZERO);
        t.reserve(RobotId(7), vec![still(1, Time(0), Time::MAX)]).unwrap();
        t
    };
    let mut planner = Planner::new(warehouse, drive());
    let (from, stages) = (start(), [to(2)]);
    assert_eq!(planner.plan(&ask(&from, &stages), &timeline.view()), Err(NoRoute::Blocked));
}

#[test]
fn a_late_robot_does_not_plan_over_one_that_is_to_pass_where_it_still_stands() {
    let warehouse = grid(4, 2);
    let mut planner = Planner::new(warehouse.clone(), drive());
    // It came at 0 and was due to leave by 4; another robot passes from 5 to 7, and now it is 8.
    let timeline = strangers(&warehouse, &[(0, 5, 2)], 1_000_000);
    let (from, stages) = (start(), [to(3)]);
    let late = |ready: i64| RouteQuery { ready: Time(ready * 1_000_000), ..ask(&from, &stages) };
    assert_eq!(planner.plan(&late(8), &timeline.view()).map(|r| r.visits.len()), Err(NoRoute::Blocked));
    assert_eq!(
        planner.plan(&late(0), &timeline.view()).map(|r| r.visits.len()),
        Ok(3),
        "in time there is a way"
    );
}

#[test]
fn a_straight_run_takes_what_the_kinematics_say() {
    let warehouse = grid(11, 1);
    let timeline = Timeline::new(warehouse.clone(), Span::from_millis(100));
    let mut planner = Planner::new(warehouse, drive());
    let (from, stages) = (start(), [to(10)]);
    let route = planner.plan(&ask(&from, &stages), &timeline.view()).unwrap();
    assert!((route.arrival.as_secs_f64() - (10.0 / 1.5 + 1.5)).abs() < 1e-3);
    assert_eq!(route.visits.len(), 10);
}

#[test]
fn a_stop_on_the_way_is_planned_together_with_the_way_home() {
    let warehouse = grid(4, 1);
    let mut timeline = strangers(&warehouse, &[(2, 8, 10)], 500_000);
    let mut planner = Planner::new(warehouse, drive());
    let stages = [Stage { stay: Span::from_secs(3), ..to(2) }, to(0)];
    let from = start();
    let route = planner.plan(&ask(&from, &stages), &timeline.view()).unwrap();
    let stop = &route.visits[route.stops[0] - 1];
    assert_eq!(stop.node, NodeId(2));
    assert!(stop.depart - stop.arrive >= Span::from_secs(3), "{stop:?}");
    assert!(stop.enter >= Time(9_000_000), "the stop does not fit before the stranger: {stop:?}");
    assert_eq!(route.visits.last().unwrap().node, NodeId(0));
    assert_fits(&mut timeline, &route);
}

#[test]
fn a_search_that_fails_is_bounded_by_its_budget() {
    let warehouse = grid(3, 3);
    let timeline = strangers(&warehouse, &[(8, 40, 10)], 500_000);
    let mut planner = Planner::new(warehouse, drive());
    let (from, stages) = (start(), [to(8)]);
    let small = RouteQuery { budget: 3, ..ask(&from, &stages) };
    assert_eq!(planner.plan(&small, &timeline.view()), Err(NoRoute::BudgetSpent));
}

#[test]
fn bounds_never_exceed_what_the_search_finds_on_an_empty_floor() {
    let warehouse = grid(4, 3);
    let timeline = Timeline::new(warehouse.clone(), Span::from_millis(100));
    let mut planner = Planner::new(warehouse.clone(), drive());
    for goal in warehouse.nodes.ids() {
        let table = planner.estimates().table(goal, false);
        let Some(bound) = planner.estimates().bound_from(&table, NodeId(0)) else { continue };
        let (from, stages) = (start(), [to(goal.ix() as u32)]);
        let best = (warehouse.headings(NodeId(0)).iter())
            .map(|&heading| RouteQuery { heading, ..ask(&from, &stages) })
            .map(|a| planner.plan(&a, &timeline.view()).unwrap().arrival.0)
            .min()
            .unwrap();
        assert!(bound.0 <= best && best < bound.0 + 20_000, "{goal:?}: bound {bound:?}, found {best} µs");
    }
}

/// Conditions that close a node of a grid by hand.
fn closed(warehouse: &Warehouse, node: u32, from_s: i64, until_s: i64) -> Conditions {
    let mut conditions = Conditions::none(warehouse);
    let window = Window::new(Time(from_s * 1_000_000), Time(until_s * 1_000_000));
    let cause = Cause::Closure(ClosureId(1));
    conditions.add(NodeId(node), Condition { window, effect: Effect::Closed, cause });
    conditions
}

#[test]
fn a_route_leads_round_a_closed_place_in_its_time_and_through_it_before_and_after() {
    let warehouse = grid(3, 2);
    let timeline = Timeline::new(warehouse.clone(), Span::from_millis(100));
    let conditions = closed(&warehouse, 1, 100, 200);
    let mut planner = Planner::new(warehouse.clone(), drive());
    let (from, stages) = (start(), [to(2)]);
    let mut through = |ready_s: i64| {
        let ask =
            RouteQuery { ready: Time(ready_s * 1_000_000), conditions: &conditions, ..ask(&from, &stages) };
        let route = planner.plan(&ask, &timeline.view()).expect("there are two ways");
        let visit = route.visits.iter().find(|v| v.node == NodeId(1)).cloned();
        if let Some(v) = &visit {
            let window = Window::new(Time(100_000_000), Time(200_000_000));
            assert!(!v.window().overlaps(window), "{v:?}");
        }
        visit.is_some()
    };
    assert!(through(0) && through(90), "before");
    assert!(!through(98), "it would be inside when it is closed");
    assert!(!through(120), "meanwhile");
    assert!(through(199), "a second is less than the way round");
    assert!(through(200), "after");
}

#[test]
fn a_route_may_end_where_it_will_be_closed_only_with_time_to_come_out() {
    let warehouse = grid(3, 1);
    let timeline = Timeline::new(warehouse.clone(), Span::from_millis(100));
    let conditions = closed(&warehouse, 2, 100, 200);
    let mut planner = Planner::new(warehouse.clone(), drive());
    let (from, stages) = (start(), [Stage { stay: Span::from_secs(5), ..to(2) }]);
    let mut arrival = |ready_s: i64| {
        let ask =
            RouteQuery { ready: Time(ready_s * 1_000_000), conditions: &conditions, ..ask(&from, &stages) };
        planner.plan(&ask, &timeline.view()).expect("it may wait").arrival
    };
    assert!(arrival(0) < Time(10_000_000));
    assert!(arrival(25) + Span::from_secs(5) + COME_OUT < Time(100_000_000));
    assert!(arrival(35) >= Time(200_000_000), "it would not be out again");
}

/// A floor with room for detours, with holds of other robots on it.
fn crowded(holds: &[(u32, i64, i64)]) -> (Arc<Warehouse>, Timeline) {
    let warehouse = grid(6, 4);
    let holds: Vec<_> = holds.iter().copied().filter(|h| h.0 != 0).collect();
    let timeline = strangers(&warehouse, &holds, 500_000);
    (warehouse, timeline)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_weighted_search_finds_a_route_where_there_is_one_and_within_its_factor(
        holds in proptest::collection::vec((1u32..24, 1i64..40, 1i64..12), 0..40),
        goals in (0u32..24, 0u32..24),
        two in any::<bool>(),
        weight in prop::sample::select(vec![0.1, 0.5, 1.0, 3.0]),
    ) {
        let (warehouse, mut timeline) = crowded(&holds);
        let mut planner = Planner::new(warehouse, drive());
        let from = start();
        let stages = [Stage { stay: Span::from_secs(2), ..to(goals.0) }, to(goals.1)];
        let stages = if two { &stages[..] } else { &stages[..1] };
        let plain = planner.plan(&ask(&from, stages), &timeline.view());
        planner.weigh(weight);
        let found = planner.plan(&ask(&from, stages), &timeline.view());
        prop_assert_eq!(found.is_ok(), plain.is_ok());
        if let (Ok(found), Ok(plain)) = (found, plain) {
            // The plain search is best at the first goal; with two goals, it may be beaten at the last one.
            prop_assert!(found.arrival.0 as f64 <= (1.0 + weight) * plain.arrival.0 as f64 + 1.0);
            prop_assert!(two || found.arrival >= plain.arrival);
            assert_fits(&mut timeline, &found);
        }
    }

    #[test]
    fn a_search_that_was_weighted_once_and_is_no_more_is_as_before(
        holds in proptest::collection::vec((1u32..24, 1i64..40, 1i64..12), 0..20),
        goal in 0u32..24,
    ) {
        let (warehouse, timeline) = crowded(&holds);
        let (from, stages) = (start(), [to(goal)]);
        let fresh = Planner::new(warehouse.clone(), drive()).plan(&ask(&from, &stages), &timeline.view());
        let mut planner = Planner::new(warehouse, drive());
        planner.weigh(1.0);
        let _ = planner.plan(&ask(&from, &stages), &timeline.view());
        planner.weigh(0.0);
        prop_assert_eq!(planner.plan(&ask(&from, &stages), &timeline.view()), fresh);
    }

    #[test]
    fn robots_that_plan_in_turn_on_an_overlay_find_the_routes_that_they_would_find_if_it_were_booked(
        holds in proptest::collection::vec((1u32..24, 1i64..40, 1i64..12), 0..40),
        gone in proptest::collection::vec(0u32..40, 0..20),
        ways in proptest::collection::vec((0u32..24, 0u32..24), 1..5),
        rules in prop::sample::select(vec![drive(), PEBBLE, TURNS]),
    ) {
        let (warehouse, timeline) = crowded(&holds);
        let mut planner = Planner::new(warehouse, rules);
        let gone: Vec<RobotId> = gone.into_iter().map(|i| RobotId(100 + i)).collect();
        let (mut seen, mut booked) = (timeline.without(&gone), timeline.clone());
        gone.iter().for_each(|robot| booked.remove(*robot));
        for (robot, (from, goal)) in (0..).map(RobotId).zip(ways) {
            let (from, stages) = (still(from, Time(0), Time::MAX), [to(goal)]);
            let found = planner.plan(&ask(&from, &stages), &seen);
            prop_assert_eq!(&found, &planner.plan(&ask(&from, &stages), &booked.view()));
            let Ok(route) = found else { continue };
            let visits: Vec<Visit> = std::iter::once(route.kept).chain(route.visits).collect();
            prop_assert_eq!(seen.add(robot, &visits), Ok(()));
            booked.reserve(robot, visits).expect("what fits beneath fits here");
            booked.assert_sound();
        }
    }
}

#[test]
fn a_weighted_search_expands_less_on_a_floor_where_much_is_equal() {
    let warehouse = grid(14, 14);
    let timeline = Timeline::new(warehouse.clone(), Span::from_millis(100));
    let mut planner = Planner::new(warehouse, PEBBLE);
    let (from, stages) = (start(), [to(13 * 14 + 13)]);
    let holds: Vec<_> = (0..13).map(|i| (14 * i + 13 - i, 20, 8)).collect();
    let busy = strangers(planner.warehouse(), &holds, 500_000);
    for timeline in [&timeline, &busy] {
        planner.weigh(0.0);
        let plain = planner.plan(&ask(&from, &stages), &timeline.view()).unwrap();
        planner.weigh(1.0);
        let quick = planner.plan(&ask(&from, &stages), &timeline.view()).unwrap();
        assert!(quick.expansions <= plain.expansions, "{} and {}", quick.expansions, plain.expansions);
    }
}

/// Nodes in a row, a metre apart, for robots that fit beside one another unless both have a rack.
fn row_for_racks(n: usize) -> Arc<Warehouse> {
    let name = |i: usize| format!("n{i}");
    let nodes = (0..n).map(|i| DraftNode { name: name(i), at: Point::new(i as f64, 0.0) }).collect();
    let lanes = (1..n).map(|i| DraftLane::both_ways(name(i - 1), name(i), Users::ALL)).collect();
    let draft = Draft { name: "row".into(), footprint_m: 1.2, nodes, lanes, ..Draft::default() };
    let outlines = [0.2, 0.6].map(|radius_m| Some(Footprint::Circle { radius_m }));
    Arc::new(draft.build_unchecked().with_bodies(vec![Body { footprints: outlines, ..Body::usual("grows") }]))
}

#[test]
fn room_for_a_rack_is_held_from_where_it_is_lifted_on() {
    let warehouse = row_for_racks(4);
    let timeline = strangers(&warehouse, &[], 500_000);
    let mut planner = Planner::new(warehouse, drive());
    let loaded = |route: &Route| {
        let visits = std::iter::once(&route.kept).chain(&route.visits);
        visits.map(|v| (v.node.0, v.loaded)).collect::<Vec<_>>()
    };
    let (from, lift) = (start(), Stage { lifts: true, ..to(2) });
    let fetch = planner.plan(&ask(&from, &[lift]), &timeline.view()).unwrap();
    assert_eq!(loaded(&fetch), [(0, false), (1, false), (2, true)], "it lifts at the end");
    let stages = [lift, Stage { loaded: true, ..to(3) }, to(1)];
    let whole = planner.plan(&ask(&from, &stages), &timeline.view()).unwrap();
    let wanted = [(0, false), (1, false), (2, true), (3, true), (2, false), (1, false)];
    assert_eq!(loaded(&whole), wanted, "it carries the rack from 2 to 3");
    let had = Visit { loaded: true, ..start() };
    let after = planner.plan(&ask(&had, &[to(1)]), &timeline.view()).unwrap();
    assert_eq!(loaded(&after), [(0, true), (1, false)], "where it set a rack down it holds as before");
}

#[test]
fn a_rack_is_not_lifted_while_a_robot_stands_too_near_for_one_with_a_rack() {
    let warehouse = row_for_racks(4);
    // Another robot with a rack is on the next node until 20 s.
    let mut timeline = strangers(&warehouse, &[], 500_000);
    let other = Visit { loaded: true, ..still(3, Time(0), Time(20_000_000)) };
    timeline.reserve(RobotId(7), vec![other]).expect("the floor is empty");
    let mut planner = Planner::new(warehouse, drive());
    let from = start();
    let passes = planner.plan(&ask(&from, &[to(2)]), &timeline.view()).unwrap();
    let lifts = planner.plan(&ask(&from, &[Stage { lifts: true, ..to(2) }]), &timeline.view()).unwrap();
    let entered = |route: &Route| route.visits.last().unwrap().enter;
    assert!(entered(&passes) < Time(20_000_000), "{:?}", entered(&passes));
    assert!(entered(&lifts) >= Time(20_000_000), "{:?}", entered(&lifts));
}

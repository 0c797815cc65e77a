//! The timeline against a model (bitmaps of seconds), and delays against their guarantees.

use super::*;
use crate::geometry::Point;
use crate::id::LaneId;
use crate::warehouse::{Body, Draft, DraftLane, DraftNode, Footprint, Users};
use proptest::prelude::*;
use std::collections::BTreeSet;

const LENGTH: i64 = 40;

/// `n` nodes in a row, so close that each is in conflict with its neighbours' neighbours if `dense`.
fn row(n: usize, dense: bool) -> Arc<Warehouse> {
    let name = |i: usize| format!("N{i}");
    let pitch = if dense { 0.5 } else { 1.0 };
    let nodes = (0..n).map(|i| DraftNode { name: name(i), at: Point::new(i as f64 * pitch, 0.0) }).collect();
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
    let draft = Draft {
        name: "row".into(),
        footprint_m: 0.9,
        nodes,
        lanes: (0..n - 1).map(lane).collect(),
        ..Draft::default()
    };
    Arc::new(draft.build_unchecked())
}

fn visit(node: u32, enter: i64, leave: i64) -> Visit {
    let (arrive, depart) = (Time(enter), if leave == i64::MAX { Time::MAX } else { Time(leave) });
    Visit {
        node: NodeId(node),
        lane: None,
        loaded: false,
        enter: Time(enter),
        arrive,
        depart,
        leave: Time(leave),
        stay: Span::ZERO,
    }
}

/// The dense row for small robots, which do not exclude robots on the next node, and large ones.
fn row_for_two_kinds(n: usize) -> Arc<Warehouse> {
    let small = [Some(Footprint::Circle { radius_m: 0.04 }), Some(Footprint::Circle { radius_m: 0.1 })];
    let small = Body { footprints: small, ..Body::usual("small") };
    Arc::new(row(n, true).with_bodies(vec![small, Body::usual("large")]))
}

fn robot(i: u32) -> RobotId {
    RobotId(i)
}

#[test]
fn in_a_building_for_one_more_kind_the_same_is_held_and_its_robots_keep_away() {
    let mut timeline = Timeline::new(row(6, true), Span(1));
    timeline.reserve(robot(0), vec![visit(0, 0, 10), visit(1, 5, i64::MAX)]).expect("nothing is held");
    timeline.reserve(robot(1), vec![visit(4, 0, i64::MAX)]).expect("it is far enough");
    let before = timeline.clone();
    let small = [Some(Footprint::Circle { radius_m: 0.04 }), Some(Footprint::Circle { radius_m: 0.1 })];
    let small = Body { footprints: small, ..Body::usual("small") };
    let both = Arc::new(row(6, true).with_bodies(vec![Body::usual("robot"), small]));
    timeline.refit(both, vec![BodyId(0), BodyId(0)]);
    timeline.assert_sound();
    assert!(timeline == before, "what is held is the same");
    timeline.set_body(robot(2), BodyId(1));
    assert!(timeline.reserve(robot(2), vec![visit(1, 20, i64::MAX)]).is_err(), "another one stands there");
    timeline.reserve(robot(2), vec![visit(2, 20, i64::MAX)]).expect("a small one has room beside it");
    timeline.remove(robot(2));
    timeline.refit(row(6, true), vec![BodyId(0), BodyId(0)]);
    let lines = |timeline: &Timeline| format!("{:?}", timeline.lines);
    assert_eq!(lines(&timeline), lines(&before), "as if there never had been another one");
}

proptest! {
    #[test]
    fn free_windows_are_the_holes_of_a_bitmap(
        asks in proptest::collection::vec((0u32..4, 0i64..LENGTH - 1, 1i64..12), 1..40),
        drops in proptest::collection::vec(any::<bool>(), 40),
        dense in any::<bool>(),
    ) {
        let warehouse = row(4, dense);
        let mut timeline = Timeline::new(warehouse.clone(), Span(1));
        let mut taken = [[0u8; LENGTH as usize]; 4];
        let near: Vec<Vec<u32>> = (0..4u32).map(|n| {
            let others = warehouse.conflicts(ResourceId(n));
            (0..4).filter(|m| *m == n || others.contains(&ResourceId(*m))).collect()
        }).collect();
        for (i, (node, start, length)) in asks.into_iter().enumerate() {
            let end = (start + length).min(LENGTH);
            let span = start as usize..end as usize;
            // Physical use of `node` clashes with physical use of itself and of everything in conflict.
            let free = near[node as usize].iter().all(|m| span.clone().all(|t| taken[*m as usize][t] & 1 == 0));
            let got = timeline.reserve(robot(i as u32), vec![visit(node, start, end)]);
            prop_assert_eq!(got.is_ok(), free);
            if got.is_ok() {
                if drops[i] {
                    timeline.remove(robot(i as u32));
                } else {
                    for t in span { taken[node as usize][t] |= 1; }
                }
            }
            timeline.assert_sound();
        }
        for node in 0..4u32 {
            let busy = |t: i64| near[node as usize].iter().any(|m| taken[*m as usize][t as usize] & 1 == 1);
            let mut model = Vec::new();
            for t in 0..LENGTH {
                if !busy(t) && (t == 0 || busy(t - 1)) { model.push((t, t + 1)); }
                else if !busy(t) { model.last_mut().unwrap().1 = t + 1; }
            }
            let real: Vec<(i64, i64)> = timeline.view().free_windows(LineId(node), Time(0))
                .map(|g| (g.start.0.max(0), g.end.0.min(LENGTH))).filter(|(a, b)| a < b).collect();
            prop_assert_eq!(real, model);
        }
    }

    #[test]
    fn free_windows_of_each_kind_are_the_holes_between_robots_that_would_touch_it(
        asks in proptest::collection::vec((0u32..5, 0i64..LENGTH - 1, 1i64..12, any::<bool>(), any::<bool>()), 1..40),
    ) {
        let mut timeline = Timeline::new(row_for_two_kinds(5), Span(1));
        let half_m = |large: bool, loaded: bool| if large { 0.45 } else if loaded { 0.1 } else { 0.04 };
        // Nodes are half a metre apart; robots on one node always touch.
        let touch = |a: (u32, f64), b: (u32, f64)| a.0 == b.0 || f64::from(a.0.abs_diff(b.0)) * 0.5 < a.1 + b.1;
        let mut held: Vec<((u32, f64), i64, i64)> = Vec::new();
        let mut clear = |at: (u32, f64), from: i64, to: i64, add: bool| {
            let free = held.iter().all(|(other, a, b)| !touch(at, *other) || *b <= from || to <= *a);
            if free && add { held.push((at, from, to)); }
            free
        };
        for (i, (node, start, length, large, loaded)) in asks.into_iter().enumerate() {
            let end = (start + length).min(LENGTH);
            timeline.set_body(RobotId(i as u32), BodyId(u32::from(large)));
            let wanted = Visit { loaded, ..visit(node, start, end) };
            let got = timeline.reserve(robot(i as u32), vec![wanted]);
            prop_assert_eq!(got.is_ok(), clear((node, half_m(large, loaded)), start, end, true));
            timeline.assert_sound();
        }
        for (node, large, loaded) in (0..5).flat_map(|n| [(n, false, false), (n, false, true), (n, true, true)]) {
            let line = timeline.warehouse().line(BodyId(u32::from(large)), loaded, ResourceId(node));
            let free: Vec<_> = timeline.view().free_windows(line, Time(0)).collect();
            for t in 0..LENGTH {
                let real = free.iter().any(|g| g.start.0 <= t && t < g.end.0);
                prop_assert_eq!(real, clear((node, half_m(large, loaded)), t, t + 1, false), "{} at {}", node, t);
            }
        }
    }

    #[test]
    fn delays_keep_every_order_and_never_make_an_overlap(
        starts in proptest::collection::vec(0i64..6, 2..6),
        late in 0i64..50,
        who in any::<prop::sample::Index>(),
        (dense, kinds) in (any::<bool>(), any::<bool>()),
    ) {
        let mut timeline = if kinds { convoy_of_two_kinds(&starts) } else { convoy(&starts, dense) };
        let before = orders(&timeline);
        let who = robot(who.index(starts.len()) as u32);
        let depart = timeline.chain(who).unwrap().get(1).unwrap().depart + Span(late);
        timeline.postpone(who, 1, depart);
        timeline.assert_sound();
        prop_assert_eq!(orders(&timeline), before);
        prop_assert!(timeline.chain(who).unwrap().get(1).unwrap().depart >= depart);
    }

    #[test]
    fn what_was_granted_early_recalled_and_is_late_then_is_entered_in_order(
        starts in proptest::collection::vec(0i64..6, 1..4),
        (granted, kept) in (1u64..6, 0u64..4),
        now in 0i64..30,
        late in proptest::collection::vec(1i64..30, 1..4),
        (dense, lead) in (any::<bool>(), 0i64..25),
    ) {
        let mut timeline = convoy_with(lead, &starts, dense);
        let before = orders(&timeline);
        let first = robot(0);
        let last = (1..=granted).take_while(|s| timeline.waits_for(first, *s).is_none()).last().unwrap_or(0);
        timeline.grant(first, last, Time(now));
        let kept = kept.min(last);
        timeline.revoke(first, kept);
        timeline.assert_sound();
        for by in late {
            let depart = timeline.chain(first).unwrap().get(kept).unwrap().depart + Span(by);
            timeline.postpone(first, kept, depart);
            timeline.assert_sound();
            prop_assert_eq!(orders(&timeline), before.clone());
        }
        timeline.grant(first, last, Time(now));
        timeline.assert_sound();
    }
}

proptest! {
    #[test]
    fn grants_releases_delays_and_advances_in_any_order_keep_every_order_and_never_make_an_overlap(
        starts in proptest::collection::vec(0i64..6, 2..6),
        changes in proptest::collection::vec((0u8..4, any::<prop::sample::Index>(), 1i64..40), 1..60),
        (dense, kinds, lead) in (any::<bool>(), any::<bool>(), 0i64..25),
    ) {
        let mut timeline = if kinds { convoy_of_two_kinds(&starts) } else { convoy_with(lead, &starts, dense) };
        for (change, who, by) in changes {
            let who = robot(who.index(starts.len()) as u32);
            let chain = timeline.chain(who).unwrap().clone();
            let here = chain.get(chain.granted() - 1).unwrap().clone();
            let before = orders(&timeline);
            match change {
                0 => {
                    if timeline.waits_for(who, chain.granted()).is_none() && chain.granted() < chain.end() {
                        timeline.grant(who, chain.granted(), here.enter + Span(by));
                    }
                }
                1 => {
                    timeline.release(who, chain.granted() - 1);
                    timeline.assert_sound();
                    continue;
                }
                2 => {
                    if !here.depart.is_forever() {
                        timeline.postpone(who, chain.granted() - 1, here.depart + Span(by));
                    }
                }
                _ => go_early(&mut timeline, who, here.enter.max(here.depart - Span(by))),
            }
            timeline.assert_sound();
            prop_assert_eq!(orders(&timeline), before);
        }
    }
}

/// Lets a robot leave its last granted visit earlier; visits of others do not move, and nothing begins later.
fn go_early(timeline: &mut Timeline, who: RobotId, depart: Time) {
    let before: Vec<(RobotId, Chain)> = timeline.chains().map(|(h, c)| (h, c.clone())).collect();
    let shifts = timeline.advance(who, depart);
    timeline.slide(&[(who, &shifts)]);
    for (holder, old) in before {
        let new = timeline.chain(holder).unwrap();
        if holder != who {
            assert_eq!(*new, old, "{holder:?} did not move");
            continue;
        }
        let mut pairs = old.visits().zip(new.visits());
        assert!(pairs.all(|(a, b)| b.enter <= a.enter && b.arrive <= a.arrive && b.leave <= a.leave));
        if let Some(first) = shifts.first() {
            let next = new.get(first.serial + 1).unwrap();
            let is_free = timeline.waits_for(who, first.serial + 1).is_none();
            assert!(
                !is_free || new.get(first.serial).unwrap().depart == depart,
                "as early as asked: {next:?}"
            );
        }
    }
}

/// A drawn drive: when it starts, its nodes with the time until each next one and how much longer the hold lasts then,
/// whether with a rack, and whether it ends by standing there for ever.
type Drawn = (i64, Vec<(u32, i64, i64)>, bool, bool);

fn drawn() -> impl Strategy<Value = Drawn> {
    let steps = proptest::collection::vec((0u32..5, 2i64..9, 0i64..4), 1..5);
    (0i64..40, steps, any::<bool>(), proptest::bool::weighted(0.2))
}

/// The visits of a drive. It holds a lane wherever it comes on an odd tick.
fn drive(warehouse: &Warehouse, start: i64, (_, steps, loaded, stays): &Drawn) -> Vec<Visit> {
    let mut enter = start;
    let mut visits: Vec<Visit> = Vec::new();
    for (node, length, more) in steps {
        let lane = (enter % 2 != 0).then(|| warehouse.lane_resource(LaneId(*node.min(&3))));
        let (arrive, depart) = (Time(enter + 1), Time(enter + length));
        let leave = depart + Span(1 + more);
        visits.push(Visit { lane, loaded: *loaded, arrive, depart, leave, ..visit(*node, enter, leave.0) });
        enter += length;
    }
    if *stays {
        let last = visits.last_mut().expect("a drive has visits");
        (last.depart, last.leave) = (Time::MAX, Time::MAX);
    }
    visits
}

/// Asserts that an overlay answers all queries about all lines as the true timeline does.
fn assert_same(seen: &Overlay<'_>, truth: &Timeline) {
    for line in truth.lines.ids() {
        let holders: Vec<RobotId> = truth.lines[line].all().map(|h| h.holder).collect();
        for t in (-3..90).step_by(3).map(Time) {
            let windows: Vec<FreeWindow> = seen.free_windows(line, t).collect();
            let times = |w: &FreeWindow| (w.start, w.end);
            let expected: Vec<FreeWindow> = truth.view().free_windows(line, t).collect();
            assert_eq!(
                windows.iter().map(times).collect::<Vec<_>>(),
                expected.iter().map(times).collect::<Vec<_>>(),
                "{line:?} from {t:?}"
            );
            assert!(windows.is_sorted_by(|a, b| a.index < b.index), "indices tell windows apart");
            for (window, there) in windows.iter().zip(&expected) {
                // On the timeline itself, the index is that of the hold at which the window ends.
                let after = there.index as usize;
                let before = after.checked_sub(1).map(|b| holders[b]);
                let neighbours = (before, holders.get(after).copied());
                assert_eq!(seen.neighbours(line, *window), neighbours, "{line:?}, {window:?}");
            }
            for (length, own) in [(1, 0), (4, 2), (30, 5)] {
                let (window, own) = (Window::new(t, t + Span(length)), robot(own));
                let there: Vec<RobotId> = truth.holders_during(line, window, own).collect();
                assert_eq!(seen.holders_during(line, window, own).collect::<Vec<_>>(), there);
            }
        }
    }
}

proptest! {
    #[test]
    fn an_overlay_answers_as_the_timeline_would_if_all_that_were_true(
        drives in proptest::collection::vec(drawn(), 1..12),
        releases in proptest::collection::vec((0u32..12, 0u64..4), 0..4),
        gone in proptest::collection::vec((0u32..14, 0u64..6), 0..8),
        routes in proptest::collection::vec((0u32..14, drawn()), 0..6),
        (dense, kinds) in (any::<bool>(), any::<bool>()),
    ) {
        let warehouse = if kinds { row_for_two_kinds(5) } else { row(5, dense) };
        let mut timeline = Timeline::new(warehouse.clone(), Span(1));
        (0..14).filter(|_| kinds).for_each(|i| timeline.set_body(robot(i), BodyId(i % 2)));
        for (i, drawn) in (0..).zip(&drives) {
            let _ = timeline.reserve(robot(i), drive(&warehouse, drawn.0, drawn));
        }
        for (i, serial) in releases {
            if timeline.chain(robot(i)).is_some_and(|c| (c.first()..c.end()).contains(&serial)) {
                timeline.release(robot(i), serial);
            }
        }
        let untouched = timeline.clone();
        let (mut seen, mut truth) = (timeline.view(), timeline.clone());
        for (holder, serial) in gone.into_iter().map(|(i, serial)| (robot(i), serial)) {
            seen.withdraw(holder, serial);
            if let Some(chain) = truth.chain(holder) {
                let from = serial.clamp(chain.first(), chain.end());
                truth.take_from(holder, from);
            }
        }
        assert_same(&seen, &truth);
        let mut added = BTreeSet::new();
        for (holder, drawn) in routes.into_iter().map(|(i, drawn)| (robot(i), drawn)) {
            // A route continues from what the holder has kept, where it leaves that at all.
            let start = truth.chain(holder).and_then(Chain::last).map_or(Time(drawn.0), |v| v.depart);
            if start.is_forever() || !added.insert(holder) {
                continue;
            }
            let visits = drive(&warehouse, start.0, &drawn);
            let fits = seen.add(holder, &visits);
            prop_assert_eq!(fits, truth.check(holder, &visits));
            if fits.is_err() {
                added.remove(&holder);
            } else if truth.chain(holder).is_some() {
                truth.put(holder, visits);
            } else {
                truth.reserve(holder, visits).expect("it fits");
            }
            truth.assert_sound();
            assert_same(&seen, &truth);
        }
        prop_assert!(timeline == untouched);
        prop_assert_eq!(orders(&timeline), orders(&untouched));
    }
}

#[test]
#[should_panic(expected = "gives up visits after a route was added")]
fn what_is_given_up_is_said_before_routes_are_added() {
    let timeline = convoy(&[0, 0], false);
    let mut seen = timeline.without(&[robot(0)]);
    seen.add(robot(0), &[visit(7, 0, 5)]).expect("no robot is there so early");
    seen.withdraw(robot(1), 0);
}

#[test]
#[should_panic(expected = "has visits out of order")]
fn a_route_goes_on_from_where_the_holder_is() {
    let timeline = convoy(&[0, 0], false);
    let mut seen = timeline.view();
    seen.withdraw(robot(0), 1);
    let first = timeline.chain(robot(0)).and_then(|c| c.get(0)).expect("it stands there");
    let late = first.leave.0 + 100;
    let _ = seen.add(robot(0), &[visit(7, late, late + 5)]);
}

/// Robots standing in a row, two nodes apart, that drive up the row one after the other.
fn convoy(waits: &[i64], dense: bool) -> Timeline {
    convoy_with(0, waits, dense)
}

/// A convoy in which the first robot must be sure of a node this long before it drives there.
fn convoy_with(lead: i64, waits: &[i64], dense: bool) -> Timeline {
    let length = 4 * waits.len() + 4;
    drive_up(Timeline::new(row(length, dense), Span(1)), lead, waits, dense)
}

/// A convoy of small and large robots by turns.
fn convoy_of_two_kinds(waits: &[i64]) -> Timeline {
    let mut timeline = Timeline::new(row_for_two_kinds(4 * waits.len() + 4), Span(1));
    (0..waits.len() as u32).for_each(|i| timeline.set_body(RobotId(i), BodyId(i % 2)));
    drive_up(timeline, 0, waits, true)
}

fn drive_up(mut timeline: Timeline, lead: i64, waits: &[i64], dense: bool) -> Timeline {
    let robots = waits.len() as u32;
    let length = 4 * robots + 4;
    let mut start = 0;
    for (i, wait) in (0..).zip(waits) {
        start += wait + if dense { 45 } else { 25 };
        let (first, last) = (2 * (robots - 1 - i), length - 1 - 2 * i);
        let mut visits: Vec<Visit> =
            (first..=last).map(|n| pass(n, start + 10 * i64::from(n), n == last)).collect();
        if i == 0 {
            let begins = visits[1].enter;
            visits.iter_mut().skip(2).for_each(|v| v.enter = (v.enter + Span(-lead)).max(begins));
        }
        (visits[0].enter, visits[0].arrive) = (Time(0), Time(0));
        timeline.reserve(robot(i), visits).expect("spaced so that they fit");
        timeline.grant(robot(i), 0, Time(0));
    }
    timeline
}

/// Ten ticks from node to node, two of them waiting; the hold outlasts the arrival at the next node by two.
fn pass(node: u32, enter: i64, last: bool) -> Visit {
    let forever = |t: i64| if last { Time::MAX } else { Time(t) };
    Visit {
        arrive: Time(enter + 8),
        depart: forever(enter + 10),
        leave: forever(enter + 20),
        ..visit(node, enter, enter + 20)
    }
}

fn orders(timeline: &Timeline) -> Vec<Vec<RobotId>> {
    timeline.lines.iter().map(|l| l.order().collect()).collect()
}

#[test]
fn a_delay_is_absorbed_where_the_next_robot_waits_anyway() {
    let mut timeline = convoy(&[0, 30], false);
    let second = timeline.chain(robot(1)).unwrap().clone();
    let depart = timeline.chain(robot(0)).unwrap().get(0).unwrap().depart + Span(4);
    let slip = timeline.postpone(robot(0), 0, depart);
    let [(late, shifts)] = &slip[..] else { panic!("only the late one moves: {slip:?}") };
    assert_eq!(
        (*late, shifts.len()),
        (robot(0), 3),
        "the wait of two ticks at each node on the way is used up first"
    );
    assert_eq!(timeline.chain(robot(1)), Some(&second));
}

#[test]
fn the_follower_waits_for_whoever_was_promised_the_resource_first() {
    let mut timeline = convoy(&[0, 0], false);
    // Robot 0 stands on node 2, which is the third visit of robot 1.
    assert_eq!(timeline.waits_for(robot(1), 2), Some((ResourceId(2), robot(0))));
    timeline.grant(robot(0), 1, Time(0));
    timeline.release(robot(0), 1);
    assert_eq!(timeline.waits_for(robot(1), 2), None);
    assert_eq!(timeline.waits_for(robot(1), 3), Some((ResourceId(3), robot(0))));
}

#[test]
#[should_panic(expected = "is granted what others hold before it")]
fn granting_out_of_order_stops_the_process() {
    let mut timeline = convoy(&[0, 0], false);
    timeline.grant(robot(1), 2, Time(0));
}

#[test]
fn a_replacement_that_clashes_leaves_everything_as_it_was() {
    let mut timeline = convoy(&[0, 0], false);
    let before = timeline.clone();
    let kept = Visit {
        leave: Time(1000),
        depart: Time(1000),
        ..timeline.chain(robot(1)).unwrap().get(0).unwrap().clone()
    };
    let clash = timeline.replace(robot(1), 0, kept, vec![visit(3, 60, i64::MAX)]).unwrap_err();
    assert_eq!(clash.by, robot(0));
    assert!(timeline == before);
    assert_eq!(orders(&timeline), orders(&before));
}

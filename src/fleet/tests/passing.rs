//! Robots that may leave the line pass people within corridors where that is cheapest.

use super::people::Puppet;
use super::*;
use giveway_floor::geometry::Point;
use giveway_floor::warehouse::{Corridor, Draft, DraftLane, DraftNode, Footprint, Users};

/// A straight way of 24 m from a charger to a parking place with this corridor, and a way round of this many metres.
fn floor(side_m: Option<f64>, round_m: f64, free_navigation: bool) -> TestFloor {
    floor_of(side_m, round_m, free_navigation, ObeyedLimits::Speeds)
}

/// The same with a robot that obeys these limits.
fn floor_of(side_m: Option<f64>, round_m: f64, free_navigation: bool, limits: ObeyedLimits) -> TestFloor {
    let mut draft = Draft { name: "way".into(), footprint_m: 0.9, ..Draft::default() };
    let mut node = |name: &str, x: f64, y: f64| {
        draft.nodes.push(DraftNode { name: name.into(), at: Point::new(x, y) });
    };
    for i in 0..=6 {
        node(&format!("n{i}"), 4.0 * f64::from(i), 0.0);
    }
    node("home", -2.0, 0.0);
    node("end", 26.0, 0.0);
    node("up0", 0.0, round_m);
    node("up6", 24.0, round_m);
    let mut lane = |a: &str, b: &str, corridor| {
        draft.lanes.push(DraftLane { corridor, ..DraftLane::both_ways(a, b, Users::ALL) });
    };
    for i in 0..6 {
        let corridor = side_m.map(|m| Corridor { left_m: m, right_m: m });
        lane(&format!("n{i}"), &format!("n{}", i + 1), corridor);
    }
    for (a, b) in [("home", "n0"), ("n6", "end"), ("n0", "up0"), ("up0", "up6"), ("up6", "n6")] {
        lane(a, b, None);
    }
    (draft.chargers, draft.parking) = (vec!["home".into()], vec!["end".into()]);
    draft.walkable =
        vec![[(-3.0, -5.0), (27.0, -5.0), (27.0, 60.0), (-3.0, 60.0)].map(|(x, y)| Point::new(x, y)).into()];
    let mut scenario = scenario(1);
    let circle = Some(Footprint::Circle { radius_m: 0.35 });
    scenario.site.kinds[0].footprints = [circle.clone(), circle];
    scenario.site.kinds[0].free_navigation = free_navigation;
    scenario.site.kinds[0].capabilities.limits = limits;
    TestFloor::new(draft.build().expect("it is a map"), &scenario)
}

/// What became of a robot that was to drive the whole way while a person stands on it, or walks.
struct PassTrip {
    arrived: Option<f64>,
    passed: bool,
    aside_m: f64,
    rerouted: bool,
    closest_m: f64,
}

fn trip(floor: &mut TestFloor, seconds: i64, mut walk: impl FnMut(&TestFloor, &mut Puppet, f64)) -> PassTrip {
    let robot = RobotId(0);
    let mut ana = floor.hire(Point::new(12.0, 0.0));
    ana.own = true;
    // She has stood there for a while when the robot sets off.
    let begun = floor.now;
    while floor.now - begun < Span::from_secs(40) {
        walk(floor, &mut ana, -1.0);
        floor.walk(&mut ana);
    }
    let go = JobKind::Go { robot, node: floor.node("end") };
    floor.submit(JobRequest { priority: 5, ..JobRequest::new(go) });
    let mut trip =
        PassTrip { arrived: None, passed: false, aside_m: 0.0, rerouted: false, closest_m: f64::INFINITY };
    let start = floor.now;
    while floor.now - start < Span::from_secs(seconds) {
        let after_s = (floor.now - start).as_secs_f64();
        walk(floor, &mut ana, after_s);
        let step = floor.walk(&mut ana);
        trip.passed |= floor.fleet.passing(robot).is_some();
        let marked = |c: &Command| match c {
            Command::Drive { waypoints, .. } => waypoints.iter().any(|w| w.passes.is_some()),
            _ => false,
        };
        assert!(!step.commands.iter().any(|(_, c)| marked(c)) || trip.passed, "a mark is a passing grant");
        let at = floor.world.truth().next().expect("there is one").1.pose.at;
        if at.y < 4.0 {
            trip.aside_m = trip.aside_m.max(at.y.abs());
        }
        trip.rerouted |= at.y > 4.0;
        trip.closest_m = trip.closest_m.min((at - ana.at).norm());
        assert_eq!(floor.fleet.displacement(robot), None, "it is where it may be");
        if floor.done() > 0 {
            trip.arrived = Some(after_s);
            break;
        }
    }
    trip
}

fn stands(_: &TestFloor, _: &mut Puppet, _: f64) {}

#[test]
fn a_free_robot_passes_somebody_who_stands_for_long_where_the_way_round_is_long() {
    let mut floor = floor(Some(3.5), 55.0, true);
    let trip = trip(&mut floor, 120, stands);
    assert!(trip.passed && !trip.rerouted, "it passes");
    assert!(
        trip.aside_m > 1.0 && trip.closest_m > 1.2,
        "{} m aside, {} m near",
        trip.aside_m,
        trip.closest_m
    );
    let arrived = trip.arrived.expect("it arrives");
    assert!(arrived < 70.0, "{arrived} s");
    assert_eq!(floor.fleet.passing(RobotId(0)), None, "and is on the line again");
}

#[test]
fn it_takes_the_way_round_where_that_is_cheaper() {
    let trip = trip(&mut floor(Some(3.5), 5.5, true), 120, stands);
    assert!(trip.rerouted && !trip.passed && trip.arrived.is_some());
}

#[test]
fn it_waits_where_the_person_soon_leaves() {
    let leaves = |_: &TestFloor, ana: &mut Puppet, after_s: f64| {
        if after_s < 0.0 {
            // She walks to and fro beside the way until then.
            if ana.way.is_empty() {
                ana.way = vec![Point::new(12.0, -4.5), Point::new(12.0, -3.5)];
            }
        } else if (9.0..9.1).contains(&after_s) {
            ana.way = vec![Point::new(12.0, 40.0)];
        }
    };
    let trip = trip(&mut floor(Some(3.5), 55.0, true), 120, leaves);
    assert!(!trip.passed && trip.aside_m < 0.01 && trip.arrived.is_some());
}

#[test]
fn without_free_navigation_without_a_corridor_and_without_room_no_robot_leaves_the_line() {
    for (side_m, free) in [(Some(3.5), false), (None, true), (Some(1.5), true)] {
        let trip = trip(&mut floor(side_m, 55.0, free), 60, stands);
        assert!(!trip.passed && trip.aside_m < 0.01, "{side_m:?} {free}");
    }
}

#[test]
fn a_robot_that_cannot_be_slow_is_not_led_past_anybody() {
    let trip = trip(&mut floor_of(Some(3.5), 55.0, true, ObeyedLimits::Stops), 60, stands);
    assert!(!trip.passed && trip.aside_m < 0.01);
}

#[test]
fn a_robot_stands_when_the_person_turns_into_the_free_side_and_goes_on_when_there_is_room_again() {
    let mut floor = floor(Some(3.5), 55.0, true);
    let (mut side, mut turned, mut stood) = (0.0, None, false);
    let robot = RobotId(0);
    let turns = |floor: &TestFloor, ana: &mut Puppet, after_s: f64| {
        let t = floor.world.truth().next().expect("there is one").1;
        if turned.is_none() && t.pose.at.y.abs() > 0.8 && t.pose.at.x < 11.0 {
            side = t.pose.at.y.signum();
            turned = Some(after_s);
            ana.way = vec![Point::new(12.0, 2.4 * side)];
        }
        let since = turned.map_or(0.0, |t| after_s - t);
        if (1.0..8.0).contains(&since) {
            stood |= t.limit_mps == Some(0.0) && t.speed_mps == 0.0 && floor.fleet.passing(robot).is_some();
        }
        if (10.0..10.1).contains(&since) {
            ana.way = vec![Point::new(12.0, -4.5 * side)];
        }
    };
    let trip = trip(&mut floor, 120, turns);
    assert!(trip.passed && turned.is_some(), "it began to pass");
    assert!(stood, "it stands beside the line");
    assert!(trip.arrived.is_some() && trip.closest_m > 1.0, "{} m", trip.closest_m);
}

/// Shifts the robot aside while it drives, beside the line or on it, and says which laws that breaks.
fn shifted(beside: bool, by_m: f64) -> Vec<giveway_sim::Violation> {
    let mut floor = floor(Some(3.5), 55.0, true);
    let mut ana = floor.hire(Point::new(12.0, 0.0));
    ana.own = true;
    (0..400).for_each(|_| _ = floor.walk(&mut ana));
    let go = JobKind::Go { robot: RobotId(0), node: floor.node("end") };
    floor.submit(JobRequest { priority: 5, ..JobRequest::new(go) });
    loop {
        floor.walk(&mut ana);
        let seen = floor.world.truth().next().expect("there is one").1;
        let is_beside = seen.pose.at.y.abs() > 1.5;
        if seen.speed_mps > 0.3 && seen.pose.at.x > 5.0 && is_beside == beside {
            floor
                .world
                .shift(RobotId(0), giveway_floor::geometry::Vector::new(0.0, by_m * seen.pose.at.y.signum()));
            break;
        }
    }
    let near = floor.fleet.people_near(&floor.world.robots_beside(), floor.world.now());
    floor.world.foretell(near);
    let inputs = floor.world.advance(floor.now, floor.fleet.ledger());
    let step = floor.fleet.step(floor.now, inputs);
    floor.laws.check(floor.now, &floor.world, &floor.fleet, &step.facts);
    floor.laws.broken.iter().map(|(_, violation)| violation.clone()).collect()
}

#[test]
fn a_robot_that_leaves_its_corridor_or_its_line_breaks_a_law() {
    use giveway_sim::Violation;
    assert_eq!(shifted(true, 0.0), [], "a robot that passes somebody breaks none");
    assert_eq!(shifted(true, 3.0), [Violation::LeftCorridor(RobotId(0))], "out of its corridor");
    assert_eq!(shifted(false, 0.6), [Violation::LeftCorridor(RobotId(0))], "off its line");
}

#[test]
fn a_robot_beside_the_line_is_where_it_may_be_and_a_restarted_fleet_finds_it_there() {
    let mut floor = floor(Some(3.5), 55.0, true);
    let robot = RobotId(0);
    let mut off = None;
    trip(&mut floor, 60, |floor, _, _| {
        let t = floor.world.truth().next().expect("there is one").1;
        if t.pose.at.y.abs() > 0.8 && off.is_none() {
            off = Some((t, floor.fleet.ledger().clone()));
        }
    });
    let (seen, ledger) = off.expect("it was beside the line");
    let mut again = Fleet::resume(ledger, floor.fleet.settings().clone(), []);
    let stands = Telemetry { speed_mps: 0.0, ..seen };
    again.step(floor.now, vec![Input::Telemetry(stands)]);
    assert!(again.is_in_place(&stands) && again.displacement(robot).is_none());
    let outside = Telemetry {
        pose: giveway_floor::geometry::Pose { at: Point::new(seen.pose.at.x, 4.0), ..seen.pose },
        ..stands
    };
    assert!(!again.is_in_place(&outside), "not outside of the corridor");
}

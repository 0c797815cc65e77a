//! People who keep walking on in front of a robot, until they are asked to let it pass.

use super::people::Puppet;
use super::*;
use giveway_fleet::internals::WaysPast;
use giveway_floor::geometry::Point;
use giveway_floor::warehouse::sketch;
use giveway_people::human::{BODY_M, Mover};

/// A floor with one delivery, and a person near its station with the two ends of a way in front of it.
fn before_the_station() -> (TestFloor, Puppet, [Point; 2]) {
    let mut floor = TestFloor::lab(1);
    floor.submit(request(deliver(3)));
    let station = floor.fleet.warehouse().stations[StationId(0)].node;
    let at: Point = floor.fleet.warehouse().nodes[station].at;
    let ends = [at + nalgebra::Vector2::new(0.0, 1.0), at + nalgebra::Vector2::new(1.5, 1.0)];
    let ana = floor.hire(ends[0]);
    (floor, ana, ends)
}

/// Seconds after which the first delivery is over although a person paces up and down where the robot has to pass, if
/// it ends within `seconds`; the longest time that the person was told to stand for a robot, and whether the person was
/// led aside.
fn paced(seconds: i64, obeys: bool) -> (Option<i64>, Span, bool) {
    let (mut floor, mut ana, ends) = before_the_station();
    let (mut next, mut stood, mut longest, mut was_led) = (0, Span::ZERO, Span::ZERO, false);
    for step in 0..seconds * 10 {
        let told = floor.fleet.view(floor.now).workers[0].guidance.reason;
        let asked = matches!(told, Some(GuidanceReason::RobotWaits(_) | GuidanceReason::RobotPasses(_)));
        was_led |= asked;
        stood = if matches!(told, Some(GuidanceReason::RobotPasses(_))) {
            stood + floor.fleet.settings().period
        } else {
            Span::ZERO
        };
        longest = longest.max(stood);
        ana.own = !(asked && obeys);
        if ana.own && ana.way.is_empty() {
            next = 1 - next;
            ana.way = vec![ends[next]];
        }
        floor.walk(&mut ana);
        if floor.fleet.ledger().counts.robot_deliveries > 0 {
            return (Some(step / 10), longest, was_led);
        }
    }
    (None, longest, was_led)
}

#[test]
fn a_person_who_paces_up_and_down_before_a_robot_is_asked_to_let_it_pass_after_a_while() {
    let (delivered, longest, was_led) = paced(500, true);
    assert!(was_led, "nobody asked");
    assert!(delivered.is_some(), "the robot did not pass");
    assert!(longest <= Span::from_secs(31), "stood for {longest:?}");
}

#[test]
fn a_person_who_does_not_let_a_robot_pass_is_not_driven_up_to() {
    let (delivered, _, was_led) = paced(500, false);
    assert_eq!((delivered, was_led), (None, true));
}

#[test]
fn a_person_whose_headset_knows_its_place_badly_is_asked_for_marks_before_robots_pass() {
    for touches in [true, false] {
        let (mut floor, mut ana, ends) = before_the_station();
        ana.accuracy_m = 1.2;
        let (mut next, mut reasons) = (0, Vec::new());
        for _ in 0..6000 {
            let told = floor.fleet.view(floor.now).workers[0].guidance.reason;
            if told != reasons.last().copied() {
                reasons.extend(told);
            }
            let asked = matches!(told, Some(GuidanceReason::RobotWaits(_) | GuidanceReason::RobotPasses(_)));
            // She trusts what she is told once the headset knows where she is.
            ana.own = !(asked && ana.accuracy_m < 0.1);
            if matches!(told, Some(GuidanceReason::PlaceUnsure(_))) {
                ana.way.clear();
                if touches {
                    ana.accuracy_m = 0.02;
                }
            } else if ana.own && ana.way.is_empty() {
                next = 1 - next;
                ana.way = vec![ends[next]];
            }
            floor.walk(&mut ana);
        }
        let asked = reasons.iter().position(|r| matches!(r, GuidanceReason::PlaceUnsure(_)));
        let asked = asked.unwrap_or_else(|| panic!("nobody asked: {reasons:?}"));
        let again =
            reasons[asked + 1..].iter().filter(|r| matches!(r, GuidanceReason::PlaceUnsure(_))).count();
        assert!(again <= usize::from(!touches), "touches {touches}: {reasons:?}");
        let delivered = floor.fleet.ledger().counts.robot_deliveries;
        assert!(!touches || delivered == 1, "{reasons:?}");
    }
}

/// Whether a person for whom a robot waits is asked at once to let it pass, if the robot has kept another worker in one
/// spot for this many seconds.
fn asked_for_another(kept_s: i64) -> bool {
    let (mut floor, mut ana, ends) = before_the_station();
    let nodes = floor.fleet.warehouse().nodes.iter().map(|n| n.at);
    let far =
        nodes.max_by(|a, b| (a - ends[0]).norm().total_cmp(&(b - ends[0]).norm())).expect("it has nodes");
    let mut ben = floor.hire_as("Ben", far);
    let robot = RobotId(0);
    let waits = |floor: &TestFloor| floor.fleet.wait(Party::Robot(robot)).edge;
    let mut next = 0;
    ana.own = true;
    for _ in 0..600 {
        if waits(&floor) == Edge::On(Party::Worker(ana.worker)) {
            break;
        }
        if ana.way.is_empty() {
            next = 1 - next;
            ana.way = vec![ends[next]];
        }
        floor.walk(&mut ana);
        floor.walk(&mut ben);
    }
    assert_eq!(waits(&floor), Edge::On(Party::Worker(ana.worker)), "the robot does not wait for her");
    for kept in [Span::ZERO, Span::from_secs(kept_s)] {
        let (edge, until) = (Edge::On(Party::Robot(robot)), floor.now + kept);
        floor.fleet.internals_mut().writer.waits.note_worker(ben.worker, Some(ben.at), edge, until);
    }
    floor.walk(&mut ana);
    floor.fleet.internals().people.people[ana.worker].lets_pass.is_some_and(|l| l.robot == robot)
}

#[test]
fn a_robot_that_shuts_a_worker_in_inherits_the_wait_and_the_person_before_it_is_asked_at_once() {
    assert_eq!([10, 20].map(asked_for_another), [false, true]);
}

#[test]
fn a_person_who_is_measured_inside_a_robot_and_stays_there_is_led_out_at_one_side_after_the_other() {
    let drawing = "
        .......
        .......
        ...P...
        .......
        .R...S1";
    let map = sketch(drawing).build().expect("nobody gets stuck there");
    let mut floor = TestFloor::new(map, &scenario(1));
    floor.run(1);
    let (fleet, robot) = (&floor.fleet, fleet_floor(&floor).place_of(RobotId(0)));
    let inside = robot + nalgebra::Vector2::new(0.1, 0.05);
    let nodes = fleet.warehouse().nodes.iter().map(|n| n.at);
    let goal = nodes.max_by(|a, b| (a - robot).norm().total_cmp(&(b - robot).norm())).expect("it has nodes");
    let cut = fleet.internals().people.walkways.no_edges();
    let first = |kept_s: i64| {
        let ways =
            WaysPast::new(fleet.internals().people, fleet_floor(&floor), (Mover::OnFoot, inside), &cut);
        let way = ways.by_sides(Span::from_secs(kept_s)).to(goal).expect("there is a way");
        assert_eq!(way[0], inside);
        way[1]
    };
    let firsts = [20, 29, 38, 47].map(first);
    let reach_m = fleet_floor(&floor).beside_m(RobotId(0), BODY_M);
    let (mut sides, beside): (Vec<_>, _) =
        (firsts.iter().map(|p| (p - inside).map(|d| d.round() as i64)).collect(), |p: &Point| {
            (p - robot).amax() >= reach_m
        });
    assert!(firsts.iter().all(beside), "{firsts:?} lead out of the robot at {robot:?}");
    sides.dedup();
    assert!(sides.len() == 4, "one side after the other: {firsts:?}");
    assert_eq!(first(19), first(0), "the nearest side comes first");
}

fn fleet_floor(floor: &TestFloor) -> giveway_fleet::internals::Floor<'_> {
    floor.fleet.internals().writer.floor()
}

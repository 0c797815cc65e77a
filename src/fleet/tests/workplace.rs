//! People in the workplace of a station are apart from robots; a person who steps out of it is a worker like any other.

use super::people::Puppet;
use super::*;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::warehouse::stations;

/// A floor with a person in the workplace of the first station.
fn at_work() -> (TestFloor, Puppet) {
    let mut floor = TestFloor::new(stations(), &scenario(2));
    let cell = floor.fleet.warehouse().stations[StationId(0)].cell.clone().expect("it is a work cell");
    let middle = cell.workplace.iter().map(|p| p.coords).sum::<Vector>() / cell.workplace.len() as f64;
    let mut ana = floor.hire(Point::from(middle));
    ana.own = true;
    floor.walk(&mut ana);
    (floor, ana)
}

fn restricts(floor: &TestFloor) -> bool {
    !floor.fleet.internals().writer.restrictions.conditions.is_empty()
}

#[test]
fn a_rack_comes_and_goes_while_the_picker_stands_in_the_workplace_as_if_nobody_were_there() {
    let (mut floor, mut ana) = at_work();
    let mut alone = TestFloor::new(stations(), &scenario(2));
    let job = floor.submit(request(deliver(3)));
    let same = alone.submit(request(deliver(3)));
    for _ in 0..3000 {
        if floor.state(job).is_none() {
            break;
        }
        floor.walk(&mut ana);
        assert!(!restricts(&floor), "at {}", floor.now);
    }
    alone.until_over(300);
    let took = |f: &TestFloor, job| f.when(job, "done") - f.when(job, "assigned");
    assert!((took(&floor, job) - took(&alone, same)).0.abs() < 1_000_000, "{:?}", took(&floor, job));
    assert_eq!(floor.fleet.ledger().counts.interruptions, 0);
}

#[test]
fn whoever_steps_out_of_the_workplace_is_a_worker_like_any_other() {
    let (mut floor, mut ana) = at_work();
    assert!(!restricts(&floor));
    let station = floor.fleet.warehouse().stations[StationId(0)].node;
    ana.way = vec![floor.fleet.warehouse().nodes[station].at];
    let mut out = false;
    for _ in 0..40 {
        floor.walk(&mut ana);
        out |= restricts(&floor);
    }
    assert!(out, "she stands where racks stand, and nothing comes of it");
}

/// The middle of the workplace of the first station, a little to one side.
fn place_beside(floor: &TestFloor, aside_m: f64) -> Point {
    let cell = floor.fleet.warehouse().stations[StationId(0)].cell.clone().expect("it is a work cell");
    let middle = cell.workplace.iter().map(|p| p.coords).sum::<Vector>() / cell.workplace.len() as f64;
    Point::from(middle) + Vector::new(aside_m, aside_m)
}

#[test]
fn no_robot_moves_at_the_opening_while_two_persons_are_in_the_workplace() {
    let (mut floor, mut ana) = at_work();
    let beside = place_beside(&floor, 0.2);
    let mut ben = floor.hire_as("Ben", beside);
    ben.own = true;
    let job = floor.submit(request(deliver(3)));
    for _ in 0..1200 {
        floor.step(vec![ana.sighting(floor.now), ben.sighting(floor.now)]);
        assert!(!floor.is(job, "picking"), "the rack came beside two persons");
    }
    let robot = floor.fleet.ledger().jobs[&job].state.robot().expect("a robot is on its way");
    assert_eq!(floor.fleet.why(robot), Some(Why::HandInOpening(StationId(0))), "it says why");
}

#[test]
fn a_picker_whose_headset_goes_silent_stops_nobody_while_buttons_are_pressed() {
    for presses in [false, true] {
        let (mut floor, _) = at_work();
        let mut stopped = false;
        for i in 0..600 {
            let pressed = Input::ask(9, Request::Station(StationId(0), StationOrder::Done));
            let inputs = if presses && i % 100 == 0 { vec![pressed] } else { Vec::new() };
            floor.step(inputs);
            stopped |= restricts(&floor);
        }
        assert_eq!(stopped, !presses, "with buttons: {presses}");
    }
}

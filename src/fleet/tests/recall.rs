//! Robots that come back from what they were granted, and take their turn at stations, where people are in the way.

use super::people::Puppet;
use super::*;
use giveway_floor::geometry::{Point, Vector};

/// A robot on its way, and a person who appears this far ahead of it and stands there.
fn face_to_face(faults: Faults, ahead_m: f64) -> (TestFloor, Puppet) {
    let mut floor = TestFloor::new(thesis(), &Scenario { faults, ..scenario(1) });
    floor.submit(request(deliver(40)));
    let drives = |f: &TestFloor| f.world.truth().next().is_some_and(|(_, t)| t.speed_mps > 1.2);
    floor.until(60, "it drives", drives);
    let at = floor.robot_at() + floor.ahead() * ahead_m;
    let mut ana = floor.hire(at);
    ana.own = true;
    (floor, ana)
}

impl TestFloor {
    pub(super) fn robot_at(&self) -> Point {
        self.world.truth().next().expect("there is one").1.pose.at
    }

    pub(super) fn ahead(&self) -> Vector {
        let heading = self.world.truth().next().expect("there is one").1.pose.heading;
        Vector::new(heading.cos(), heading.sin())
    }

    fn place(&self, name: &str) -> Point {
        self.fleet.warehouse().nodes[self.node(name)].at
    }

    fn came_back(&self) -> usize {
        self.facts.iter().filter(|f| matches!(f, Fact::Route(RouteFact::Revoked { .. }))).count()
    }
}

#[test]
fn a_robot_that_faces_somebody_for_long_comes_back_and_takes_another_way() {
    let (mut floor, mut ana) = face_to_face(Faults::default(), 3.0);
    let robot = RobotId(0);
    for _ in 0..150 {
        floor.walk(&mut ana);
    }
    let chain = floor.fleet.ledger().chain(robot);
    assert!(chain.first() + 1 < chain.granted(), "more was granted than where it stands");
    let stood = floor.robot_at();
    assert_eq!(floor.came_back(), 0, "she may set off any moment");
    for _ in 0..150 {
        floor.walk(&mut ana);
    }
    assert!(floor.came_back() > 0, "nobody called it back");
    assert_eq!(floor.fleet.ledger().robots[robot].recalls, floor.came_back() as u64);
    assert!((floor.robot_at() - ana.at).norm() > (stood - ana.at).norm() + 0.5, "it drove off");
    for _ in 0..3000 {
        floor.walk(&mut ana);
    }
    assert_eq!(floor.fleet.ledger().counts.robot_deliveries, 1, "it went round her");
}

#[test]
fn a_robot_between_two_nodes_goes_on_to_the_one_that_it_can_get_to() {
    let mut seen = 0;
    // She stays before the robot, or is behind it this many steps after it has forgotten where it was going.
    for (ahead_m, behind_after) in [(3.1, None), (3.2, None), (3.0, Some(0)), (3.3, Some(5)), (3.4, Some(9))]
    {
        let (mut floor, mut ana) = face_to_face(Faults::default(), ahead_m);
        let (robot, ahead) = (RobotId(0), floor.ahead());
        let halfway = |f: &TestFloor| f.fleet.internals().writer.floor().is_halfway(robot);
        for _ in 0..600 {
            if halfway(&floor) {
                break;
            }
            floor.walk(&mut ana);
        }
        if !halfway(&floor) {
            continue;
        }
        seen += 1;
        let chain = floor.fleet.ledger().chain(robot);
        assert_eq!(chain.granted(), chain.first() + 2, "it holds both, and gave back what was beyond");
        (0..behind_after.unwrap_or(0)).for_each(|_| drop(floor.walk(&mut ana)));
        let from = floor.robot_at();
        if behind_after.is_some() {
            ana.at = from - ahead * 2.2;
            let appears = ana.appear(floor.now);
            floor.step(vec![appears]);
        }
        (0..100).for_each(|_| drop(floor.walk(&mut ana)));
        let gone = (floor.robot_at() - from).dot(&ahead);
        let there = if behind_after.is_some() { gone > 0.1 } else { gone < -0.1 };
        assert!(there, "{ahead_m} m, behind it after {behind_after:?}: {gone} m");
    }
    assert!(seen > 3, "{seen} of five were between two nodes");
}

#[test]
fn a_robot_that_stands_for_one_and_then_for_another_comes_back_as_for_one() {
    let (mut floor, mut ana) = face_to_face(Faults::default(), 3.0);
    let here = ana.at;
    let far = |p: &Point| (p - here).norm();
    let places = floor.fleet.warehouse().nodes.iter().map(|n| n.at);
    let away = places.max_by(|a, b| far(a).total_cmp(&far(b))).expect("there are some");
    let mut ben = floor.hire_as("Ben", away);
    let spend = |seconds: u32, floor: &mut TestFloor, both: [&mut Puppet; 2]| {
        for _ in 0..seconds * 10 {
            let seen = [both[0].sighting(floor.now), both[1].sighting(floor.now)];
            floor.step(seen.into());
        }
    };
    spend(15, &mut floor, [&mut ana, &mut ben]);
    let robot = RobotId(0);
    let stood = floor.robot_at();
    // Seven times they take turns, as people do who pass one another; none of them stands there for long.
    for turn in 0..7 {
        (ana.at, ben.at) = if turn % 2 == 0 { (away, here) } else { (here, away) };
        let seen = [ana.appear(floor.now), ben.appear(floor.now)];
        floor.step(seen.into());
        assert_eq!(
            (floor.came_back(), floor.robot_at()),
            (0, stood),
            "turn {turn}: they may set off any moment"
        );
        spend(5, &mut floor, [&mut ana, &mut ben]);
    }
    spend(15, &mut floor, [&mut ana, &mut ben]);
    assert!(floor.came_back() > 0, "nobody called it back");
    assert!(floor.fleet.ledger().robots[robot].recalls > 0);
}

#[test]
fn laws_hold_while_recalls_and_orders_are_late_and_lost() {
    let mut recalls = 0;
    for (seed, ahead_m) in [(1, 3.0), (2, 3.1), (3, 3.2), (4, 3.3), (5, 3.4)] {
        let faults = Faults { message_delay_ms: 100, message_loss: 0.3, ..Faults::default() };
        let (mut floor, mut ana) = face_to_face(faults, ahead_m);
        let home = ana.at;
        for i in 0..1500 {
            // She steps aside and back again, so that orders and revocations cross.
            if i % 240 == 200 {
                ana.way = vec![home + Vector::new(0.0, 0.3), home];
            }
            floor.walk(&mut ana);
        }
        recalls += floor.came_back();
        let said = floor.world.truth().next().unwrap().1.recalls;
        assert!(said >= floor.fleet.ledger().robots[RobotId(0)].recalls, "seed {seed}");
    }
    assert!(recalls > 0);
}

#[test]
fn who_waits_for_a_place_in_a_queue_does_not_overtake_by_stepping_aside() {
    let mut floor = TestFloor::thesis(12);
    let racks = floor.fleet.warehouse().racks.len() as u32;
    for i in 0..12 {
        floor.submit(request(deliver(i * 5 % racks)));
    }
    let waiting = |f: &TestFloor| {
        f.fleet.ledger().robots.ids().find(|r| f.fleet.internals().writer.floor().waits_for_room(*r))
    };
    floor.until(120, "the queue is full", |f| waiting(f).is_some());
    let robot = waiting(&floor).expect("just seen");
    let here = floor.fleet.ledger().node_of(robot);
    let (_, way) = floor.fleet.warehouse().ways(here).next().expect("it came somewhere");
    let InternalsMut { writer, traffic } = floor.fleet.internals_mut();
    assert!(traffic.detour(writer, robot, way.to, floor.now), "there is room beside it");
    let chain = floor.fleet.ledger().chain(robot);
    assert!(chain.end() > chain.granted() && chain.last().map(|v| v.node) == Some(here), "it comes back");
    assert!(floor.fleet.internals().writer.floor().lacks_route(robot), "and it stands in line as before");
    floor.until_over(1200);
}

#[test]
fn nobody_fetches_another_rack_for_a_station_for_which_enough_wait() {
    let mut floor = TestFloor::thesis(20);
    let racks = floor.fleet.warehouse().racks.len() as u32;
    for i in 0..40 {
        floor.submit(request(deliver(i % racks)));
    }
    floor.run(90);
    let robots: Vec<RobotId> = floor.fleet.ledger().robots.ids().collect();
    let places = floor.fleet.warehouse().stations[StationId(0)].queue.len() + 1;
    let wait = robots.iter().filter(|r| floor.fleet.internals().writer.floor().waits_for_room(**r)).count();
    assert!(wait >= places, "{wait} wait for {places} places");
    floor.run(5);
    let fetches = |r: &&RobotId| matches!(floor.fleet.ledger().robots[**r].task, Task::Fetch { .. });
    let jobs = floor.fleet.ledger().jobs.values().filter(|j| j.state == JobState::Waiting).count();
    assert!(robots.iter().filter(fetches).count() == 0 && jobs > 0, "somebody is still sent for a rack");
    assert!(
        robots.iter().any(|r| !floor.fleet.internals().writer.floor().waits_for_room(*r)),
        "and some are free for others"
    );
}

#[test]
fn a_robot_that_may_only_drive_slowly_is_granted_less() {
    let mut floor = TestFloor::thesis(1);
    floor.submit(request(deliver(40)));
    floor.run(2);
    let needed = |limit_mps| floor.fleet.internals().writer.floor().needed_ahead_m(RobotId(0), limit_mps);
    let (free, slow, stop) = (needed(None), needed(Some(0.5)), needed(Some(0.0)));
    assert!(free > slow + 1.0, "{free} m at full speed, {slow} m at half a metre per second");
    assert_eq!(slow, stop, "who is to stand now may be let go slowly in a moment");
}

#[test]
fn whoever_comes_back_to_work_goes_on_with_it() {
    let mut floor = TestFloor::thesis(1);
    let (work, aside) = (floor.node("G3-7"), floor.place("G3-9"));
    let mut ana = floor.hire(floor.place("G3-7"));
    floor.assign(&ana, work, 20);
    let done = |floor: &TestFloor| floor.fleet.ledger().counts.human_deliveries;
    let spend = |seconds: usize, floor: &mut TestFloor, ana: &mut Puppet| {
        (0..seconds * 10).for_each(|_| drop(floor.walk(ana)));
    };
    spend(12, &mut floor, &mut ana);
    // Off for a while, and back where she is led.
    (ana.own, ana.way) = (true, vec![aside]);
    spend(6, &mut floor, &mut ana);
    assert!(done(&floor) == 0 && floor.deviations() > 0);
    ana.own = false;
    spend(14, &mut floor, &mut ana);
    assert_eq!(done(&floor), 1, "twelve seconds and ten are more than twenty");
}

#[test]
fn who_stands_for_long_after_the_work_should_be_done_is_not_about_to_set_off() {
    let mut floor = TestFloor::thesis(1);
    let mut ana = floor.hire(floor.place("G3-7"));
    floor.assign(&ana, floor.node("G3-7"), 20);
    for _ in 0..100 {
        floor.walk(&mut ana);
    }
    let (robot, there) = ((RobotId(0), floor.robot_at()), ana.worker);
    let seen = floor.fleet.internals().people.whereabouts(there, floor.now).expect("she is seen");
    let speed = |later_s: i64| {
        let later = floor.now + Span::from_secs(later_s);
        let Internals { writer, people, traffic, yielding } = floor.fleet.internals();
        yielding.limits(writer.floor(), people, traffic).walk_of(there, &seen, robot, later).speed_mps
    };
    assert!(speed(0) > 1.0 && speed(20) > 1.0, "she sets off when it is done, or a little later");
    assert!(speed(60) < 0.1, "something else keeps her, maybe the robot");
}

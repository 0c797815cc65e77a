//! What a robot is doing: one word that is true at every moment, and since when.

use super::*;

const R0: RobotId = RobotId(0);

impl TestFloor {
    fn activity(&self, robot: RobotId) -> (Activity, Time) {
        let view = self.fleet.view(self.now);
        (view.robots[robot.ix()].activity, view.robots[robot.ix()].since)
    }
}

#[test]
fn a_delivery_is_told_activity_by_activity_each_with_when_it_began() {
    let mut floor = TestFloor::thesis(1);
    floor.run(2);
    assert_eq!(floor.activity(R0).0, Activity::Charging, "robots begin at chargers");
    floor.submit(request(deliver(3)));
    let mut last = floor.activity(R0);
    let mut told = vec![Activity::Charging, last.0];
    while !floor.fleet.ledger().jobs.is_empty() || !floor.is_idle(R0) {
        floor.step(vec![]);
        let now = floor.activity(R0);
        let began = floor.now - floor.fleet.settings().period;
        match now.0 == last.0 {
            true => assert_eq!(now.1, last.1, "{now:?} has not begun again at {began}"),
            false => assert_eq!(now.1, began, "{now:?} began in the last step"),
        }
        if now.0 != last.0 && now.0 != Activity::Waiting {
            told.push(now.0);
        }
        last = now;
        assert!(floor.now < Time::from_secs_f64(900.0), "{told:?}");
    }
    told.dedup();
    let mut rest = told.iter();
    for next in [
        Activity::Driving,
        Activity::Handling,
        Activity::Driving,
        Activity::Picking,
        Activity::Driving,
        Activity::Handling,
    ] {
        assert!(rest.any(|a| *a == next), "{next:?} is missing in {told:?}");
    }
    assert!(floor.fleet.view(floor.now).robots[0].driven_m > 5.0);
}

#[test]
fn no_robot_that_is_said_to_drive_stands_for_long_and_those_that_wait_all_stand() {
    let mut floor = TestFloor::new(thesis(), &Scenario { demand: Demand::Backlog(20), ..scenario(16) });
    let mut stood = [Span::ZERO; 16];
    let (mut waited, mut longest) = (0, Span::ZERO);
    while floor.now < Time::from_secs_f64(240.0) {
        floor.step(vec![]);
        let (view, period) = (floor.fleet.view(floor.now), floor.fleet.settings().period);
        for (r, robot) in view.robots.iter().enumerate() {
            let stands = robot.speed_mps < 0.01;
            let drives = robot.activity == Activity::Driving;
            stood[r] = if stands && drives { stood[r] + period } else { Span::ZERO };
            // Turning on the spot takes some seconds.
            assert!(
                stood[r] < Span::from_secs(8),
                "robot {r} drives at {} and stands: {:?}",
                view.now,
                robot.why
            );
            if robot.activity == Activity::Waiting {
                waited += 1;
                longest = longest.max(view.now - robot.since);
                assert!(robot.speed_mps < 0.06, "robot {r} waits at {} m/s", robot.speed_mps);
            }
        }
    }
    assert!(waited > 100 && longest > Span::from_secs(2), "{waited} times, {longest:?} at most");
}

#[test]
fn what_a_person_ordered_has_lasted_since_the_order_also_after_a_restart() {
    let mut floor = TestFloor::lab(2);
    floor.run(2);
    let ordered = floor.now;
    floor.step(vec![Input::ask(4, FloorAction::Halt(Some(R0)))]);
    floor.run(5);
    assert_eq!(floor.activity(R0), (Activity::Paused, ordered));
    let stopped = floor.now;
    floor.step(vec![Input::ask(5, FloorAction::Halt(None))]);
    let (map, settings) = (floor.fleet.warehouse().clone(), floor.fleet.settings().clone());
    floor.fleet = Fleet::restore(map, settings, floor.facts.iter().cloned());
    assert_eq!(floor.activity(R0), (Activity::Paused, ordered), "it is so before the first step");
    floor.run(3);
    assert_eq!(floor.activity(R0), (Activity::Paused, ordered));
    assert_eq!(floor.activity(RobotId(1)), (Activity::Stopped, stopped));
}

#[test]
fn a_robot_that_cannot_drive_is_failed_and_one_in_maintenance_is_out_of_service() {
    let mut floor = TestFloor::lab(2);
    floor.run(2);
    floor.world.fail(R0, floor.now + Span::from_secs(60));
    floor.until(30, "it is failed", |f| f.activity(R0).0 == Activity::Failed);
    floor.step(vec![Input::ask(4, RobotAction::BeginMaintenance(RobotId(1)))]);
    let rests = |f: &TestFloor| f.activity(RobotId(1)).0 == Activity::OutOfService;
    floor.until(120, "it rests in maintenance", rests);
    floor.until(120, "it is repaired", |f| f.activity(R0).0 != Activity::Failed);
    assert_eq!(floor.fleet.why(R0), None);
}

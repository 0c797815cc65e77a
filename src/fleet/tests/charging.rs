//! Charging: low robots come to a charger, full ones leave it, flat ones stand, and jobs go on meanwhile.

use super::*;
use giveway_sim::Closing;

fn charging_so(charging: Charging) -> [RobotKind; 1] {
    [RobotKind { charging, ..RobotKind::default() }]
}

/// The hall of the thesis with this many chargers, and batteries that last for an hour of driving.
fn few_chargers(robots: usize, chargers: usize) -> Scenario {
    let closed = (chargers + 1..=10).map(|i| format!("C{i}-15")).collect();
    let closing = Closing { nodes: closed, ..Closing::default() };
    let charging = Charging { driving_h: 1.0, ..Charging::default() };
    let floor = scenario(robots).with_kinds(charging_so(charging));
    Scenario { demand: Demand::Backlog(robots), closures: vec![closing], ..floor }
}

#[test]
fn with_one_charger_for_eight_robots_the_floor_delivers_for_hours() {
    let mut floor = TestFloor::new(thesis(), &few_chargers(8, 1));
    let mut before = 0;
    for hour in 1..=3 {
        floor.run(3600);
        let delivered = floor.fleet.ledger().counts.robot_deliveries;
        assert!(delivered > before + 20, "hour {hour}: {delivered} after {before}");
        before = delivered;
    }
    let c7 = floor.node("C1-15");
    let came = |f: &&Fact| {
        let Fact::Robot(RobotFact::Tasked { task: Task::Move { stay, .. }, .. }) = f else { return false };
        *stay == c7
    };
    assert!(floor.facts.iter().filter(came).count() > 5, "robots take turns at the charger");
}

#[test]
fn a_robot_that_has_enough_leaves_its_charger_for_one_that_is_low() {
    let mut floor = TestFloor::new(thesis(), &Scenario { demand: Demand::None, ..few_chargers(2, 1) });
    floor.run(30);
    let charger = floor.node("C1-15");
    floor.until(2_000, "a robot is at the charger", |f| {
        (0..2).any(|r| f.fleet.ledger().node_of(RobotId::at(r)) == charger && f.is_idle(RobotId::at(r)))
    });
    let at =
        (0..2).map(RobotId::at).find(|r| floor.fleet.ledger().node_of(*r) == charger).expect("just seen");
    let other = RobotId::at(1 - at.ix());
    floor.until(20_000, "the other one had to charge and came", |f| {
        f.fleet.ledger().node_of(other) == charger
    });
}

#[test]
fn a_robot_with_a_flat_battery_has_failed_and_another_one_does_its_job() {
    let mut floor = TestFloor::lab(2);
    let job = floor.submit(request(deliver(3)));
    floor.until(60, "a robot has it", |f| f.is(job, "assigned"));
    let robot = floor.state(job).and_then(|s| s.robot()).expect("it is assigned");
    // The robot drives off the charger on which it began.
    floor.run(4);
    floor.world.drain(robot);
    floor.until(10, "it has failed", |f| f.fleet.ledger().robots[robot].failed);
    floor.until_over(3_000);
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn a_critical_robot_gives_its_job_back_and_goes_to_charge() {
    let critical = Charging { critical: 0.99, low: 0.99, enough: 0.995, full: 1.0, ..Charging::default() };
    let mut floor = TestFloor::new(lab(), &scenario(1).with_kinds(charging_so(critical)));
    let job = floor.submit(request(deliver(3)));
    floor.run(60);
    assert!(floor.is(job, "waiting"), "{:?}", floor.state(job));
    floor.until(4_000, "it has charged and begins", |f| f.is(job, "assigned"));
    floor.until_over(600);
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn a_robot_that_is_sent_to_charge_gets_a_charger_although_full_robots_stand_at_all_of_them() {
    let kinds = charging_so(Charging::default());
    let one = Scenario { demand: Demand::None, ..few_chargers(3, 1) }.with_kinds(kinds);
    let mut floor = TestFloor::new(thesis(), &one);
    let charger = floor.node("C1-15");
    floor.until(4_000, "a robot is full at the charger", |f| {
        let full = |r: usize| f.fleet.view(f.now).robots[r].battery >= 0.9;
        (0..3).any(|r| f.fleet.ledger().node_of(RobotId::at(r)) == charger && full(r))
    });
    let other = (0..3)
        .map(RobotId::at)
        .find(|r| floor.fleet.ledger().node_of(*r) != charger)
        .expect("two are elsewhere");
    let job = floor.submit(request(JobKind::Charge { robot: other }));
    floor.until(4_000, "it charges", |f| f.state(job).is_none());
    assert_eq!(floor.story(job), ["assigned", "done"]);
}

#[test]
fn a_robot_that_is_sent_to_park_gets_a_place_although_resting_robots_stand_at_all_of_them() {
    let parking = lab().nodes_where(|k| k == NodeKind::Parking).len();
    assert!(parking > 0, "the hall has places to park at");
    let full = Charging { opportunity: false, ..Charging::default() };
    let many = scenario(parking + 1).with_kinds(charging_so(full));
    let mut floor = TestFloor::new(lab(), &many);
    let robots: Vec<RobotId> = floor.fleet.ledger().present().collect();
    for robot in robots {
        let job = floor.submit(request(JobKind::Park { robot }));
        floor.until(600, "it parks", |f| f.state(job).is_none());
        assert_eq!(floor.story(job), ["assigned", "done"], "{robot:?}");
    }
}

//! Robots of several kinds: each is planned, granted and charged as robots of its kind are.

use super::*;
use crate::timeline::Holder;

/// A kind that takes its time.
fn slow() -> RobotKind {
    let kinematics = Kinematics {
        speed_mps: 0.5,
        speed_loaded_mps: 0.4,
        accel_unloaded_mps2: 0.4,
        accel_loaded_mps2: 0.2,
        lift: Span::from_secs(5),
        ..Kinematics::default()
    };
    RobotKind { name: "mover".into(), kinematics, ..RobotKind::default() }
}

/// As many robots, of the usual kind and of another one in turn.
fn two_kinds(robots: usize, other: RobotKind) -> Scenario {
    let share = |kind| KindShare { kind, share: 1 };
    Scenario { kinds: vec![share(RobotKind::default()), share(other)], ..scenario(robots) }
}

/// How long the way to another place of the same distance is planned to take, for the robot of each kind.
fn planned(floor: &Floor, robot: usize) -> Span {
    let chain = floor.fleet.ledger().chain(RobotId::at(robot));
    let (first, last) = (chain.get(chain.first()), chain.last());
    last.expect("it stands somewhere").arrive - first.expect("it stands somewhere").depart
}

#[test]
fn a_slow_robot_is_planned_as_slow_as_it_drives() {
    let mut floor = Floor::new(thesis(), &two_kinds(2, slow()));
    let goals = [floor.free_storage(), floor.free_storage()];
    for (robot, node) in goals.into_iter().enumerate() {
        // One after the other, each from where it began to the same place and back.
        let home = floor.fleet.ledger().node_of(RobotId::at(robot));
        let go = |node| request(JobKind::Go { robot: RobotId::at(robot), node });
        let there = floor.submit(go(node));
        floor.until(10, "it has a route", |f| {
            f.fleet.ledger().chain(RobotId::at(robot)).end()
                > f.fleet.ledger().chain(RobotId::at(robot)).first() + 1
        });
        let began = floor.now;
        let takes = planned(&floor, robot);
        floor.until(300, "it is there", |f| f.state(there).is_none());
        let took = floor.now - began;
        let off = (took - takes).as_secs_f64().abs();
        assert!(off < 3.0, "robot {robot} was planned to take {takes:?} and took {took:?}");
        let back = floor.submit(go(home));
        floor.until(300, "it is back", |f| f.state(back).is_none());
    }
    let late = floor.facts.iter().filter(|f| matches!(f, Fact::Delayed { .. })).count();
    assert_eq!(late, 0, "a robot alone is never later than planned");
}

#[test]
fn robots_of_two_kinds_deliver_on_one_floor_without_being_late_for_one_another() {
    let mut floor = Floor::new(thesis(), &two_kinds(8, slow()));
    let jobs = floor.submit_batch(16);
    floor.until_over(3_000);
    floor.assert_done_once(&jobs);
    let by = |kind: &str| {
        let of = |r: &RobotId| floor.fleet.ledger().robots[*r].kind == kind;
        let lifted = floor.facts.iter().filter_map(|f| match f {
            Fact::Progressed { state: JobState::Carrying { robot }, .. } => Some(*robot),
            _ => None,
        });
        lifted.filter(of).count()
    };
    assert!(by("robot") > by("mover") && by("mover") > 0, "{} and {}", by("robot"), by("mover"));
}

#[test]
fn robots_charge_as_their_kind_does() {
    let thirsty = Charging { critical: 0.999, low: 0.999, enough: 0.9995, full: 1.0, ..Charging::default() };
    let other = RobotKind { name: "thirsty".into(), charging: thirsty, ..RobotKind::default() };
    let mut floor = Floor::new(lab(), &two_kinds(2, other));
    let jobs: Vec<JobId> = (0..3).map(|rack| floor.submit(request(deliver(rack)))).collect();
    floor.until_over(2_000);
    let served = |r: usize| {
        let assigned = JobState::Assigned { robot: RobotId::at(r) };
        let by = |f: &&Fact| matches!(f, Fact::Progressed { state, .. } if *state == assigned);
        floor.facts.iter().filter(by).count()
    };
    assert_eq!((served(0), served(1)), (jobs.len(), 0), "the one below its critical charge takes no job");
}

#[test]
fn a_robot_of_an_unknown_kind_cannot_join_and_one_in_the_ledger_is_found() {
    let mut floor = Floor::new(thesis(), &two_kinds(2, slow()));
    let node = floor.free_storage();
    let join = |kind: &str| Input::Register { token: 7, name: "late".into(), kind: kind.into(), node };
    floor.step(vec![join("forklift")]);
    assert_eq!(floor.fleet.ledger().robots.len(), 2);
    let known = floor.fleet.settings().unknown_kinds(floor.fleet.ledger());
    assert_eq!(known, Vec::<(&str, &str)>::new());
    let usual = scenario(2).settings();
    assert_eq!(usual.unknown_kinds(floor.fleet.ledger()), [("robot-2", "mover")]);
    let holder = Holder::Robot(RobotId::at(1));
    assert!(floor.fleet.ledger().timeline().chain(holder).is_some());
}

//! Robots of several kinds: each is planned, granted and charged as robots of its kind are.

use super::*;
use giveway_floor::geometry::Point;
use giveway_floor::id::BodyId;
use giveway_floor::warehouse::{Footprint, mixed};

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
    scenario(robots).with_kinds([RobotKind::default(), other])
}

/// How long the way to another place of the same distance is planned to take, for the robot of each kind.
fn planned(floor: &TestFloor, robot: usize) -> Span {
    let chain = floor.fleet.ledger().chain(RobotId::at(robot));
    let (first, last) = (chain.get(chain.first()), chain.last());
    last.expect("it stands somewhere").arrive - first.expect("it stands somewhere").depart
}

#[test]
fn a_slow_robot_is_planned_as_slow_as_it_drives() {
    let mut floor = TestFloor::new(thesis(), &two_kinds(2, slow()));
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
    let late = floor.facts.iter().filter(|f| matches!(f, Fact::Route(RouteFact::Retimed { .. }))).count();
    assert_eq!(late, 0, "a robot alone is never later than planned");
}

#[test]
fn robots_of_two_kinds_deliver_on_one_floor_without_being_late_for_one_another() {
    let mut floor = TestFloor::new(thesis(), &two_kinds(8, slow()));
    let jobs = floor.submit_batch(16);
    floor.until_over(3_000);
    floor.assert_done_once(&jobs);
    let by = |kind: &str| {
        let of = |r: &RobotId| floor.fleet.ledger().robots[*r].kind == kind;
        let lifted = floor.facts.iter().filter_map(|f| match f {
            Fact::Job(JobFact::Progressed { state: JobState::Carrying { robot }, .. }) => Some(*robot),
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
    let mut floor = TestFloor::new(lab(), &two_kinds(2, other));
    let jobs: Vec<JobId> = (0..3).map(|rack| floor.submit(request(deliver(rack)))).collect();
    floor.until_over(2_000);
    let served = |r: usize| {
        let assigned = JobState::Assigned { robot: RobotId::at(r) };
        let by = |f: &&Fact| matches!(f, Fact::Job(JobFact::Progressed { state, .. }) if *state == assigned);
        floor.facts.iter().filter(by).count()
    };
    assert_eq!((served(0), served(1)), (jobs.len(), 0), "the one below its critical charge takes no job");
}

#[test]
fn a_robot_of_an_unknown_kind_cannot_join_and_one_in_the_ledger_is_found() {
    let mut floor = TestFloor::new(thesis(), &two_kinds(2, slow()));
    let node = floor.free_storage();
    let join =
        |kind: &str| Input::ask(7, RobotAction::Register { name: "late".into(), kind: kind.into(), node });
    floor.step(vec![join("forklift")]);
    assert_eq!(floor.fleet.ledger().robots.len(), 2);
    let known = floor.fleet.settings().unknown_kinds(floor.fleet.ledger());
    assert_eq!(known, Vec::<(&str, &str)>::new());
    let usual = scenario(2).site.settings();
    assert_eq!(usual.unknown_kinds(floor.fleet.ledger()), [("robot-2", "mover")]);
    let holder = RobotId::at(1);
    assert!(floor.fleet.ledger().timeline().chain(holder).is_some());
}

/// Small robots for bins, and large ones for everything, on the hall that is for both.
fn shuttles_and_movers(robots: usize) -> Scenario {
    let disc = |radius_m| Some(Footprint::Circle { radius_m });
    let (footprints, carries) = ([disc(0.2), disc(0.3)], Some(vec!["bin".into()]));
    let shuttle =
        RobotKind { name: "shuttle".into(), footprints, carries, payload_kg: 60.0, ..RobotKind::default() };
    let mover = RobotKind { name: "mover".into(), payload_kg: 600.0, ..slow() };
    scenario(robots).with_kinds([shuttle, mover])
}

#[test]
fn a_rack_is_fetched_by_robots_that_can_carry_it() {
    let mut floor = TestFloor::new(mixed(), &shuttles_and_movers(4));
    let jobs = floor.submit_batch(8);
    floor.until_over(3_000);
    floor.assert_done_once(&jobs);
    let bookings = floor.facts.iter().filter_map(|f| match f {
        Fact::Route(RouteFact::Routed { bookings }) => Some(bookings),
        _ => None,
    });
    let carried = bookings.flatten().flat_map(|b| {
        b.stops.iter().filter_map(|stop| match stop.act {
            Act::Lift(rack) => Some((b.robot, rack)),
            _ => None,
        })
    });
    let carried: Vec<(RobotId, RackId)> = carried.collect();
    let w = floor.fleet.warehouse();
    let kind = |r: RobotId| floor.fleet.ledger().robots[r].kind.as_str();
    let is_bin = |rack: RackId| w.racks[rack].load.as_deref() == Some("bin");
    assert!(carried.iter().all(|(r, rack)| kind(*r) == "mover" || is_bin(*rack)), "{carried:?}");
    assert!(carried.iter().any(|(r, _)| kind(*r) == "shuttle") && carried.iter().any(|(_, k)| !is_bin(*k)));
}

#[test]
fn a_job_that_no_robot_of_the_floor_can_do_says_so_and_one_that_no_kind_can_do_is_refused() {
    let few = shuttles_and_movers(1);
    let shelf = RackId(1);
    let mut floor = TestFloor::new(mixed(), &few);
    let job = floor.submit(request(JobKind::Deliver { rack: shelf, station: StationId(0), pick: None }));
    floor.run(5);
    let view = floor.fleet.view(floor.now);
    let why = view.why_job(floor.fleet.warehouse(), job, &floor.fleet.ledger().jobs[&job]);
    assert_eq!(why, Some(JobWhy::NoKind), "one shuttle, and a shelf");
    let only = few.site.kinds[0].clone();
    let few = few.with_kinds([only]);
    let mut floor = TestFloor::new(mixed(), &few);
    let Err(why) = floor.ask(request(JobKind::Return { rack: shelf })) else {
        panic!("no kind carries shelves")
    };
    assert_eq!(why, Refusal::Rack(RackRefusal::NoKindFor(shelf)));
}

#[test]
fn robots_of_a_kind_drive_over_lanes_that_are_for_it() {
    let mut floor = TestFloor::new(mixed(), &shuttles_and_movers(2));
    let named =
        |floor: &TestFloor, name: &str| floor.fleet.warehouse().node_named(name).expect("it is there");
    let passed = |floor: &mut TestFloor, robot: usize| {
        let robot = RobotId::at(robot);
        for name in ["S1-1", "S1-6"] {
            let node = named(floor, name);
            let job = floor.submit(request(JobKind::Go { robot, node }));
            floor.until(300, "it is there", |f| f.state(job).is_none());
        }
        let goal = named(floor, "S1-6");
        let bookings = floor.facts.iter().rev().filter_map(|f| match f {
            Fact::Route(RouteFact::Routed { bookings }) => bookings.iter().find(|b| b.robot == robot),
            _ => None,
        });
        let there = bookings.map(|b| b.visits.iter().map(|v| v.node).collect::<Vec<NodeId>>());
        let mut there = there.filter(|way| way.last() == Some(&goal));
        there.next().expect("it drove there")
    };
    let (small, large) = (passed(&mut floor, 0), passed(&mut floor, 1));
    let w = floor.fleet.warehouse();
    let beneath = |way: &[NodeId]| way.iter().filter(|n| w.kind(**n) == NodeKind::Storage).count();
    assert!(beneath(&small) > 2, "a shuttle passes beneath racks: {small:?}");
    assert_eq!(beneath(&large), 1, "a mover goes round: {large:?}");
}

#[test]
fn the_laws_and_the_regions_near_people_are_those_of_the_robot_at_hand() {
    let mut floor = TestFloor::new(mixed(), &shuttles_and_movers(4));
    floor.run(1);
    let [a, b] = ["G3-9", "G3-9~G3-10"].map(|n| floor.fleet.warehouse().node_named(n).expect("it is there"));
    let at = |n: NodeId, floor: &TestFloor| floor.fleet.warehouse().nodes[n].at;
    let (here, there): (Point, Point) = (at(a, &floor), at(b, &floor));
    for (i, j, overlap) in [(0, 2, false), (1, 3, true), (0, 1, true)] {
        let [i, j] = [i, j].map(RobotId::at);
        floor.world.put(i, here);
        floor.world.put(j, there);
        assert_eq!(floor.world.overlap(i, j, 0.001), overlap, "{i:?} and {j:?}, half a metre apart");
        floor.world.put(i, Point::new(-20.0, 0.0));
        floor.world.put(j, Point::new(-25.0, 0.0));
    }
    let regions = |body| *floor.fleet.internals().writer.regions.of(BodyId(body));
    let keep_out = |body| regions(body).keep_out_radius_m(false, 0.0);
    assert!(
        (regions(0).bodies_m(false) - 0.45).abs() < 1e-9 && (regions(0).bodies_m(true) - 0.55).abs() < 1e-9
    );
    assert!((regions(1).bodies_m(false) - 0.7).abs() < 1e-9, "the square of the map");
    assert!(keep_out(1) > keep_out(0), "larger, with weaker brakes");
}

#[test]
fn a_robot_that_cannot_carry_the_rack_above_it_makes_way_for_one_that_can() {
    let mut two = shuttles_and_movers(2);
    two.site.kinds[0].charging.opportunity = false;
    let mut floor = TestFloor::new(mixed(), &two);
    let shelf = RackId(1);
    let beneath = floor.fleet.warehouse().racks[shelf].home;
    let job = floor.submit(request(JobKind::Go { robot: RobotId::at(0), node: beneath }));
    floor.until(300, "the shuttle is beneath", |f| f.state(job).is_none());
    floor.run(3);
    assert_eq!(floor.fleet.ledger().node_of(RobotId::at(0)), beneath);
    let job = floor.submit(request(JobKind::Deliver { rack: shelf, station: StationId(0), pick: None }));
    floor.until(600, "the mover has fetched it", |f| f.state(job).is_none());
    floor.assert_done_once(&[job]);
}

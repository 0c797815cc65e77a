//! Robots of several kinds: each is planned, granted and charged as robots of its kind are.

use super::*;
use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::{BodyId, ClosureId};
use giveway_floor::route::{Cause, Effect};
use giveway_floor::time::Window;
use giveway_floor::warehouse::{Footprint, mixed};
use giveway_sim::recording::{Header, Playback, Played, Recorder};

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

/// This many robots, of the usual kind and of another one in turn.
fn two_kinds(robots: usize, other: RobotKind) -> Scenario {
    scenario(robots).with_kinds([RobotKind::default(), other])
}

/// How long the way to another place at the same distance is planned to take, for the robot of each kind.
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
        // One robot after the other, each from where it began to the same place and back.
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
    let join = |kind: &str| {
        Input::ask(7, RobotAction::Register { name: "late".into(), kind: kind.into(), node, link: None })
    };
    floor.step(vec![join("forklift")]);
    assert_eq!(floor.fleet.ledger().robots.len(), 2);
    assert_eq!(floor.fleet.ledger().unknown_kinds(), Vec::<(&str, &str)>::new());
    let (map, usual) = (floor.fleet.warehouse().clone(), scenario(2).site.kinds);
    let of_one = Ledger::from_parts(map, &usual, floor.fleet.ledger().to_parts()).expect("it is sound");
    assert_eq!(of_one.unknown_kinds(), [("robot-2", "mover")]);
    let holder = RobotId::at(1);
    assert!(floor.fleet.ledger().timeline().chain(holder).is_some());
}

/// Small robots for bins, and large ones for everything, in the hall that is drawn for both.
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

/// A hall with people in which movers work, before there are shuttles.
fn movers_among_people(movers: usize) -> (Scenario, RobotKind) {
    let both = shuttles_and_movers(movers);
    let [shuttle, mover] = [0, 1].map(|i| both.site.kinds[i].clone());
    let workers = Workers { count: 2, ..Workers::default() };
    (Scenario { workers, ..both.with_kinds([mover]) }, shuttle)
}

fn put(kind: &RobotKind) -> Input {
    Input::ask(7, FloorAction::PutKind(Box::new(kind.clone())))
}

fn remove(name: &str) -> Input {
    Input::ask(7, FloorAction::RemoveKind(name.into()))
}

fn join(name: &str, kind: &RobotKind, node: NodeId) -> Input {
    let (name, kind) = (name.into(), kind.name.clone());
    Input::ask(8, RobotAction::Register { name, kind, node, link: None })
}

fn refused(why: KindRefusal) -> Answered {
    Err(Refusal::Kind(why))
}

fn made(body: u32, new: bool) -> Answered {
    Ok(Answer::Kind(Made { id: BodyId(body), new }))
}

/// A ledger from the stored parts of another one, in the building of the site.
fn read_back(floor: &TestFloor, scenario: &Scenario) -> Ledger {
    let base = scenario.site.fit(&Arc::new(mixed())).expect("the map is for the site's robots");
    Ledger::from_parts(base, &scenario.site.kinds, floor.fleet.ledger().to_parts()).expect("it is sound")
}

#[test]
fn a_kind_is_added_while_robots_drive_and_a_robot_of_it_joins_in_the_same_step_and_delivers() {
    let (scenario, shuttle) = movers_among_people(4);
    let mut floor = TestFloor::new(mixed(), &scenario);
    let jobs = floor.submit_batch(6);
    floor.run(40);
    let chains: Vec<_> = floor.fleet.ledger().timeline().chains().map(|(r, c)| (r, c.clone())).collect();
    assert!(chains.iter().any(|(_, c)| c.end() > c.granted()), "some robots are on their way");
    let node = floor.free_storage();
    let replies = floor.step(vec![put(&shuttle), join("late", &shuttle, node)]).replies;
    let said = |token: u64| replies.iter().find(|r| r.token == token.into()).map(|r| r.answer.clone());
    let late = RobotId::at(4);
    assert_eq!(said(7), Some(made(1, true)));
    assert_eq!(said(8), Some(Ok(Answer::Robot(Made { id: late, new: true }))));
    floor.fleet.ledger().assert_sound();
    let bins = |r: &RackId| {
        let w = floor.fleet.warehouse();
        w.can_carry(BodyId(1), *r) && w.may_be_at(BodyId(1), w.racks[*r].home)
    };
    let rack = floor.fleet.warehouse().racks.ids().filter(bins).last().expect("there are bins");
    let job = floor.submit(request(JobKind::Deliver { rack, station: StationId(0), pick: None }));
    floor.step(vec![Input::ask(9, JobAction::Reassign(job, Some(late)))]);
    floor
        .until(600, "the shuttle has the rack", |f| f.state(job) == Some(JobState::Carrying { robot: late }));
    floor.until_over(3_000);
    floor.assert_done_once(&jobs);
    floor.assert_done_once(&[job]);
    floor.assert_fold();
    assert!(read_back(&floor, &scenario) == *floor.fleet.ledger(), "what is written down is all of it");
    let base = scenario.site.fit(&Arc::new(mixed())).expect("the map is for the site's robots");
    let again = Fleet::restore(base, scenario.site.settings(), floor.facts.clone());
    assert!(again.ledger() == floor.fleet.ledger(), "a restart folds to the same ledger");
    assert_eq!(again.warehouse().bodies(), floor.fleet.warehouse().bodies(), "and to the same building");
    floor.fleet = again;
    let more = floor.submit_batch(3);
    floor.until_over(3_000);
    floor.assert_done_once(&more);
}

#[test]
fn a_kind_is_replaced_or_removed_only_while_no_robot_is_of_it_or_was() {
    let (scenario, shuttle) = movers_among_people(1);
    let mut floor = TestFloor::new(mixed(), &scenario);
    let mover = scenario.site.kinds[0].clone();
    assert_eq!(floor.answer_to(7, vec![put(&mover)]), refused(KindRefusal::OfSite));
    assert_eq!(floor.answer_to(7, vec![remove("mover")]), refused(KindRefusal::OfSite));
    assert_eq!(floor.answer_to(7, vec![remove("shuttle")]), refused(KindRefusal::Unknown));
    let large = Some(Footprint::Circle { radius_m: 3.0 });
    let wide = RobotKind { footprints: [large.clone(), large], ..shuttle.clone() };
    assert_eq!(floor.answer_to(7, vec![put(&wide)]), refused(KindRefusal::TooLarge));
    let kinematics = Kinematics { clearance: Span::from_secs(9), ..shuttle.kinematics };
    let slow = RobotKind { kinematics, ..shuttle.clone() };
    assert_eq!(floor.answer_to(7, vec![put(&slow)]), refused(KindRefusal::Clearance));
    assert_eq!(floor.answer_to(7, vec![put(&shuttle)]), made(1, true));
    let light = RobotKind { payload_kg: 20.0, ..shuttle.clone() };
    assert_eq!(floor.answer_to(7, vec![put(&light)]), made(1, false), "another one of its name");
    assert_eq!(floor.answer_to(7, vec![remove("shuttle")]), Ok(Answer::Done));
    assert_eq!(floor.fleet.warehouse().bodies().len(), 1);
    floor.assert_fold();
    assert_eq!(floor.answer_to(7, vec![put(&shuttle)]), made(1, true));
    let facts = floor.facts.len();
    let (node, late) = (floor.free_storage(), RobotId::at(1));
    floor.step(vec![join("late", &shuttle, node)]);
    assert_eq!(floor.answer_to(7, vec![put(&shuttle)]), made(1, false), "it is just so");
    assert_eq!(floor.answer_to(7, vec![put(&light)]), refused(KindRefusal::InUse(1)));
    assert_eq!(floor.answer_to(7, vec![remove("shuttle")]), refused(KindRefusal::InUse(1)));
    floor.until(600, "it has nothing to do", |f| f.is_idle(late));
    floor.fleet.internals_mut().writer.record(RobotFact::Retired { robot: late, at: floor.now });
    floor.fleet.internals_mut().writer.record(RobotFact::Left { robot: late, at: floor.now });
    let replies = floor.fleet.step(floor.now, vec![remove("shuttle")]).replies;
    assert_eq!(replies[0].answer, refused(KindRefusal::InUse(1)), "it may come back");
    let kinds = floor.facts[facts..].iter().filter(|f| matches!(f, Fact::Floor(FloorFact::KindPut { .. })));
    assert_eq!(kinds.count(), 0, "what changes nothing is no fact");
}

#[test]
fn a_floor_takes_as_many_kinds_as_it_can_tell_apart() {
    let mut floor = TestFloor::lab(1);
    for i in 1..giveway_floor::warehouse::MOST_BODIES {
        let kind = RobotKind { name: format!("kind-{i}"), ..RobotKind::default() };
        assert_eq!(floor.answer_to(7, vec![put(&kind)]), made(i as u32, true));
    }
    let kind = RobotKind { name: "one more".into(), ..RobotKind::default() };
    assert_eq!(floor.answer_to(7, vec![put(&kind)]), Err(Refusal::TooMany(Bounded::Kinds, 32)));
    let job = floor.submit(request(deliver(0)));
    floor.until_over(600);
    floor.assert_done_once(&[job]);
}

#[test]
fn what_was_closed_before_a_kind_was_added_binds_its_robots_and_all_others() {
    let (scenario, shuttle) = movers_among_people(2);
    let mut floor = TestFloor::new(mixed(), &scenario);
    let node = floor.free_storage();
    let corner = |x_mm, y_mm| Spot { x_mm, y_mm };
    let area = Closure {
        outline: vec![corner(0, 0), corner(1, 0), corner(0, 1)],
        nodes: vec![node],
        window: Window::new(floor.now, floor.now + Span::from_secs(3600)),
        reason: "paint".into(),
        binds: Binds::default(),
        series: None,
    };
    floor.step(vec![Input::ask(9, FloorAction::Close(area))]);
    let closed = |f: &TestFloor, body: u32| {
        let internals = f.fleet.internals();
        let restrictions = &internals.writer.restrictions;
        let all = restrictions.conditions.of(BodyId(body)).of(node).iter();
        let causes: Vec<Cause> = all.filter(|c| c.effect == Effect::Closed).map(|c| c.cause).collect();
        (causes, restrictions.is_closing(node))
    };
    let by_the_closure = (vec![Cause::Closure(ClosureId(1))], true);
    assert_eq!(closed(&floor, 0), by_the_closure);
    floor.step(vec![put(&shuttle)]);
    assert_eq!((closed(&floor, 0), closed(&floor, 1)), (by_the_closure.clone(), by_the_closure.clone()));
    floor.step(vec![Input::ask(9, FloorAction::Reopen(ClosureId(1)))]);
    assert_eq!((closed(&floor, 0), closed(&floor, 1)), ((vec![], false), (vec![], false)));
    floor.step(vec![remove("shuttle")]);
    floor.run(5);
}

#[test]
fn a_map_that_is_not_for_a_kind_that_was_added_is_refused_and_others_keep_it() {
    let (scenario, shuttle) = movers_among_people(1);
    let mut floor = TestFloor::new(mixed(), &scenario);
    assert_eq!(floor.answer_to(7, vec![put(&shuttle)]), made(1, true));
    let base = scenario.site.fit(&Arc::new(mixed())).expect("the map is for the site's robots");
    let carried = giveway_fleet::carry::carry(floor.fleet.ledger(), &base, floor.now);
    assert_eq!(carried.parts.expect("nothing is in the way").added_kinds, [shuttle]);
    let mut narrow = Warehouse::clone(&base);
    narrow.footprint_m = 0.3;
    let carried = giveway_fleet::carry::carry(floor.fleet.ledger(), &narrow, floor.now);
    let said = carried.report.to_string();
    assert!(said.contains("not for robots of the kind \"shuttle\", which was added"), "{said}");
    assert!(carried.parts.is_none() && said.contains("DELETE /v1/kinds/shuttle"), "{said}");
}

#[test]
fn a_recording_of_a_floor_that_kinds_are_added_to_and_removed_from_plays_to_the_same_facts() {
    let (scenario, shuttle) = movers_among_people(2);
    let mut floor = TestFloor::new(mixed(), &scenario);
    let mut again = floor.fleet.clone();
    let (begin, node) = (floor.facts.len(), floor.free_storage());
    let header = Header {
        giveway_recording: 1,
        seed: 1,
        scenario: String::new(),
        map: String::new(),
        model: None,
        picks: None,
    };
    let (_, mut playback) = Playback::open(&Recorder::header(&header)).expect("it is a recording");
    let (mut recorder, mut played) = (Recorder::default(), Vec::new());
    let odd = RobotKind { name: "odd".into(), payload_kg: 0.1 + 0.2, ..shuttle.clone() };
    for step in 0..600 {
        let asked = match step {
            50 => vec![put(&shuttle), put(&odd)],
            51 => vec![join("late", &shuttle, node)],
            300 => vec![remove("odd"), remove("shuttle")],
            _ => vec![],
        };
        let inputs: Vec<Input> =
            floor.world.advance(floor.now, floor.fleet.ledger()).into_iter().chain(asked).collect();
        match playback.read(&recorder.step(floor.now, &inputs)).expect("it is in order") {
            Played::Step(now, inputs) => played.extend(again.step(now, inputs).facts),
            Played::End(_) => panic!("it goes on"),
        }
        floor.take(inputs);
    }
    let of_kinds =
        |f: &&Fact| matches!(f, Fact::Floor(FloorFact::KindPut { .. } | FloorFact::KindRemoved { .. }));
    assert_eq!(played.iter().filter(of_kinds).count(), 3);
    assert!(played == floor.facts[begin..], "the same facts");
    assert!(again.ledger() == floor.fleet.ledger());
}

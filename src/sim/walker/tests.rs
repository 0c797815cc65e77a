//! Walkers in the hall of the thesis, without a fleet.

use super::persona::{Persona, SPEEDS};
use super::*;
use crate::scenario::{Causes, Deviations, Personas, Rates};
use giveway_floor::geometry::{Vector, axis_distance};
use giveway_floor::id::NodeId;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{NodeKind, Warehouse, thesis};

const DT: f64 = 0.02;

struct TestHall {
    warehouse: Warehouse,
    walkways: Walkways,
    robots: Vec<RobotNear>,
    now: Time,
    job: Option<Errand>,
}

impl TestHall {
    fn new() -> TestHall {
        let warehouse = thesis();
        let walkways = Walkways::of(&warehouse);
        TestHall { warehouse, walkways, robots: vec![], now: Time::ZERO, job: None }
    }

    fn place(&self, name: &str) -> Point {
        self.warehouse.nodes[self.warehouse.node_named(name).expect("in the hall")].at
    }

    fn work_at(&mut self, name: &str) {
        let at = ease(self.walkways.on_floor(self.place(name)).expect("on the floor"), &self.walkways);
        self.job = Some(Errand { id: AssignmentId(1), at, stay: Span::from_secs(5) });
    }

    /// Advances a walker; calls `each` after every tick.
    fn live(&mut self, walker: &mut Walker, seconds: f64, mut each: impl FnMut(&TestHall, &Walker)) {
        let known: Vec<Point> = ["G0-14", "G12-13"].map(|n| self.place(n)).to_vec();
        for _ in 0..(seconds / DT) as i64 {
            self.now += Span::from_secs_f64(DT);
            let around = WalkerSurroundings { walkways: &self.walkways, robots: &self.robots, people: &[] };
            let work = WorkKnowledge { job: self.job, known: &known, colleagues: &[], companion: None };
            walker.tick(self.now, DT, &around, &work);
            if walker.finished.pop().is_some() {
                self.job = None;
            }
            each(self, walker);
        }
    }
}

fn workers(causes: Causes, at_s: &[f64], persona: Persona) -> Workers {
    let mut personas = Personas { yields: 0.0, hurries: 0.0, freezes: 0.0, cuts_through: 0.0 };
    match persona {
        Persona::Yields => personas.yields = 1.0,
        Persona::Hurries => personas.hurries = 1.0,
        Persona::Freezes => personas.freezes = 1.0,
        Persona::CutsThrough => personas.cuts_through = 1.0,
    }
    let deviations = Deviations { at_s: at_s.to_vec(), causes };
    Workers { count: 1, deviations, personas, ..Workers::default() }
}

fn walker(hall: &TestHall, workers: &Workers, at: &str) -> Walker {
    Walker::new(workers, 3, 0, hall.place(at), Time::ZERO, Time::ZERO)
}

#[test]
fn a_walker_without_guidance_finds_its_way_to_work_and_does_it() {
    let mut hall = TestHall::new();
    hall.work_at("S7-4");
    let mut w = walker(&hall, &workers(Causes::None, &[], Persona::CutsThrough), "G0-14");
    let goal = hall.job.unwrap().at;
    let mut worked = 0.0;
    hall.live(&mut w, 60.0, |hall, w| {
        if matches!(w.doing, WalkerDoing::Work(..)) {
            assert!((w.legs.at - goal).norm() < 0.6);
            worked += DT;
        }
        assert!(hall.walkways.is_free(w.legs.at));
    });
    assert!((worked - 5.0f64).abs() < 0.1 && hall.job.is_none(), "worked for {worked} s");
}

#[test]
fn gait_speed_and_sway_keep_their_bounds() {
    let mut hall = TestHall::new();
    hall.work_at("S10-1");
    let mut w = walker(&hall, &workers(Causes::None, &[], Persona::CutsThrough), "G0-14");
    let mut before: Option<Point> = None;
    hall.live(&mut w, 40.0, |hall, w| {
        assert!((0.0..=SPEEDS.1).contains(&w.speed_mps()));
        let at = w.pose(hall.now).at;
        assert!((at - w.legs.at).norm() <= 0.03 + 1e-9);
        // The trunk sways at up to 0.17 m/s, and turns with the heading.
        assert!(before.is_none_or(|b| (at - b).norm() < (SPEEDS.1 + 0.5) * DT));
        before = Some(at);
    });
    assert!(w.walked_m() > 15.0);
}

#[test]
fn usual_speeds_are_those_of_people() {
    let speeds: Vec<f64> =
        (0..2000).map(|i| Traits::draw(&Personas::default(), Stream::new(1, 30, i)).speed_mps).collect();
    let mean = speeds.iter().sum::<f64>() / 2000.0;
    assert!((mean - 1.2).abs() < 0.02, "{mean}");
    assert!(speeds.iter().all(|s| (SPEEDS.0..=SPEEDS.1).contains(s)));
}

#[test]
fn a_walker_never_enters_a_rack_or_a_pillar_whatever_comes_to_its_mind() {
    let mut hall = TestHall::new();
    let often = Rates {
        pause_per_hour: 60.0,
        look_per_hour: 120.0,
        mind_per_hour: 120.0,
        unknown_per_hour: 120.0,
        wander_per_hour: 60.0,
        help_per_hour: 60.0,
        ignore: 0.5,
    };
    let racks: Vec<Point> = hall
        .warehouse
        .nodes_where(|k| k == NodeKind::Storage)
        .iter()
        .map(|n| hall.warehouse.nodes[*n].at)
        .collect();
    for who in 0..3 {
        let workers = workers(Causes::Rates(often), &[100.0], Persona::Yields);
        let mut w = Walker::new(&workers, 5, who, hall.place("G0-14"), Time::ZERO, hall.now);
        for round in 0..20 {
            hall.work_at(["S7-4", "S1-9", "S11-13", "S2-1"][round % 4]);
            hall.live(&mut w, 60.0, |hall, w| {
                let at = w.pose(hall.now).at;
                assert!(hall.walkways.is_free(at), "off the floor at {at}");
                assert!(racks.iter().all(|r| axis_distance(*r, at) > 0.5));
            });
        }
        let causes: std::collections::BTreeSet<WalkCause> =
            w.log().segments().iter().map(|s| s.cause).collect();
        assert!(causes.len() >= 6, "{causes:?}");
    }
}

#[test]
fn a_walker_stops_before_a_robot_and_takes_another_way_after_a_while() {
    let mut hall = TestHall::new();
    hall.work_at("S1-1");
    let mut w = walker(&hall, &workers(Causes::None, &[], Persona::Yields), "G0-14");
    hall.robots = vec![RobotNear { at: hall.place("G0-9"), velocity: Vector::zeros(), half_m: 0.45 }];
    let mut detour = false;
    hall.live(&mut w, 80.0, |hall, w| {
        assert!(hall.robots[0].gap(w.legs.at) >= 0.0);
        detour |= matches!(w.log().segments().last(), Some(s) if s.cause == WalkCause::Detour);
    });
    assert!(detour && hall.job.is_none(), "it did not get to work");
}

#[test]
fn a_walker_gives_up_an_errand_to_where_a_robot_stands_and_goes_to_work() {
    let mut hall = TestHall::new();
    hall.work_at("S10-13");
    let mut w = walker(&hall, &workers(Causes::None, &[], Persona::Yields), "G0-14");
    let goal = hall.place("G0-9");
    w.doing = WalkerDoing::Job { cause: WalkCause::ChangeOfMind, goal, stay: Span::ZERO, until: None };
    hall.robots = vec![RobotNear { at: goal, velocity: Vector::zeros(), half_m: 0.45 }];
    hall.live(&mut w, 30.0, |_, _| {});
    assert!(matches!(w.doing, WalkerDoing::Job { .. }), "it waits for a while");
    hall.live(&mut w, 120.0, |_, _| {});
    assert!(hall.job.is_none(), "it went to work");
}

#[test]
fn nobody_who_minds_robots_steps_in_front_of_one_that_moves() {
    let mut hall = TestHall::new();
    hall.work_at("S4-10");
    let mut w = walker(&hall, &workers(Causes::None, &[], Persona::Hurries), "G0-10");
    // A robot that drives to and fro on the cross street before the walker.
    hall.robots = vec![RobotNear { at: hall.place("G0-7"), velocity: Vector::new(1.5, 0.0), half_m: 0.45 }];
    for _ in 0..600 {
        let r = &mut hall.robots[0];
        if !(0.0..=12.0).contains(&(r.at.x + r.velocity.x * 0.1)) {
            r.velocity = -r.velocity;
        }
        r.at += r.velocity * 0.1;
        hall.live(&mut w, 0.1, |hall, w| {
            let gap = hall.robots[0].gap(w.legs.at);
            let on_street = (w.legs.at.y - 7.0).abs() < 0.45 + BODY_M;
            assert!(gap > 0.0 || on_street, "touched at {}", w.legs.at);
        });
    }
}

#[test]
fn a_scripted_deviation_leads_to_a_place_that_nobody_knows_and_back_to_work() {
    let mut hall = TestHall::new();
    hall.work_at("S10-4");
    let mut w = walker(&hall, &workers(Causes::None, &[3.0], Persona::CutsThrough), "G0-14");
    hall.live(&mut w, 120.0, |_, _| {});
    let log = w.log().segments();
    let scripted = log.iter().find(|s| s.cause == WalkCause::Scripted).expect("it deviates");
    assert!((scripted.from.as_secs_f64() - 3.0).abs() < 0.1);
    let goal = scripted.goal.expect("to a place");
    assert!(["G0-14", "G12-13"].iter().all(|n| (hall.place(n) - goal).norm() > 1.5));
    assert!(hall.job.is_none(), "it did not come back to work");
    assert!(log.windows(2).all(|w| w[0].to == w[1].from), "the log has gaps");
}

fn show(version: u64, path: Vec<Point>) -> Shown {
    Shown { version, path, redirected: false, stop: false, leave: false }
}

#[test]
fn a_walker_follows_the_path_that_is_shown_not_the_shortest() {
    let mut hall = TestHall::new();
    hall.work_at("S1-1");
    let mut w = walker(&hall, &workers(Causes::None, &[], Persona::CutsThrough), "G0-14");
    let path = ["G0-14", "G3-14", "G3-7", "G3-1"].map(|n| hall.place(n)).to_vec();
    w.hear(hall.now, show(1, path));
    let mut passed = false;
    let corner = hall.place("G3-7");
    hall.live(&mut w, 40.0, |_, w| passed |= (w.legs.at - corner).norm() < 0.5);
    assert!(passed);
}

#[test]
fn a_walker_that_is_told_to_stop_stands_after_its_reaction_time_until_told_otherwise() {
    let mut hall = TestHall::new();
    hall.work_at("S1-1");
    let mut w = walker(&hall, &workers(Causes::None, &[], Persona::CutsThrough), "G0-14");
    hall.live(&mut w, 4.0, |_, w| assert!(w.speed_mps() >= 0.0));
    assert!(w.speed_mps() > 0.5);
    w.hear(hall.now, Shown { stop: true, ..show(1, vec![]) });
    hall.live(&mut w, 2.5, |_, _| {});
    assert_eq!(w.speed_mps(), 0.0);
    let rest = w.legs.at;
    hall.live(&mut w, 5.0, |_, w| assert_eq!(w.legs.at, rest));
    w.hear(hall.now, show(2, vec![]));
    hall.live(&mut w, 15.0, |_, _| {});
    assert!((w.legs.at - rest).norm() > 1.0);
}

#[test]
fn who_ignores_a_redirection_keeps_the_old_path_and_the_log_says_so() {
    for (ignore, cause) in [(1.0, WalkCause::IgnoresGuidance), (0.0, WalkCause::OnPath)] {
        let mut hall = TestHall::new();
        hall.work_at("S1-1");
        let rates = Rates { ignore, ..Rates::default() };
        let mut w = walker(&hall, &workers(Causes::Rates(rates), &[], Persona::CutsThrough), "G0-14");
        w.hear(hall.now, show(1, ["G0-14", "G0-1"].map(|n| hall.place(n)).to_vec()));
        hall.live(&mut w, 4.0, |_, _| {});
        let path = ["G0-12", "G0-14", "G3-14", "G3-1"].map(|n| hall.place(n)).to_vec();
        w.hear(hall.now, Shown { redirected: true, ..show(2, path) });
        hall.live(&mut w, 5.0, |_, _| {});
        assert_eq!(w.log().segments().last().unwrap().cause, cause);
        assert_eq!(w.legs.heading < -1.0, ignore == 1.0, "heading {}", w.legs.heading);
    }
}

#[test]
fn nobody_is_caught_at_the_corner_of_a_rack_on_the_way_to_a_place_in_sight() {
    let hall = TestHall::new();
    let around = WalkerSurroundings { walkways: &hall.walkways, robots: &[], people: &[] };
    let fronts = hall.warehouse.nodes_where(|k| k == NodeKind::Storage);
    let goal = |n: &NodeId| hall.walkways.on_floor(hall.warehouse.nodes[*n].at);
    let goals: Vec<Point> = fronts.iter().filter_map(goal).map(|p| ease(p, &hall.walkways)).collect();
    let mut walks = 0;
    // The walker is pushed anywhere, also close to racks, as robots and other people do.
    for i in 0..130 * 150 {
        let from = Point::new(f64::from(i % 130) * 0.1, f64::from(i / 130) * 0.1);
        if hall.walkways.clearance_m(from) < 0.15 {
            continue;
        }
        let seen = |g: &&Point| (0.5..2.5).contains(&(**g - from).norm()) && hall.walkways.sees(from, **g);
        for &goal in goals.iter().filter(seen) {
            let mut legs = legs::Legs::new(from, 0.6, 0.0);
            legs.set_off([goal], &hall.walkways);
            let mut ticks = 0;
            while !legs.route.is_empty() && ticks < 1000 {
                legs.walk(DT, 1.2, 1.0, &around);
                ticks += 1;
            }
            assert!(legs.route.is_empty(), "from {from} to {goal} it is still at {}", legs.at);
            walks += 1;
        }
    }
    assert!(walks > 10_000, "{walks}");
}

//! Walkers among other walkers and driving robots, in the hall of the thesis, without a fleet.

use super::*;
use crate::scenario::Personas;
use giveway_floor::geometry::Vector;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{Warehouse, thesis};

const DT: f64 = 0.02;

struct TestCrowd {
    warehouse: Warehouse,
    walkways: Walkways,
    walkers: Vec<Walker>,
    jobs: Vec<Option<Errand>>,
    robots: Vec<RobotNear>,
    pairs: bool,
    now: Time,
}

impl TestCrowd {
    fn new() -> TestCrowd {
        let warehouse = thesis();
        let walkways = Walkways::of(&warehouse);
        let (walkers, jobs, robots) = (vec![], vec![], vec![]);
        TestCrowd { warehouse, walkways, walkers, jobs, robots, pairs: false, now: Time::ZERO }
    }

    fn place(&self, name: &str) -> Point {
        self.warehouse.nodes[self.warehouse.node_named(name).expect("in the hall")].at
    }

    /// Adds a walker on the way from one place to the other; each seed makes a different one.
    fn walks(&mut self, seed: u64, from: Point, to: Point, stay_s: f64, personas: Personas) {
        let workers = Workers { count: 9, personas, ..Workers::default() };
        let who = self.walkers.len();
        self.walkers.push(Walker::new(&workers, seed, who as u64, from, Time::ZERO, Time::ZERO));
        let id = AssignmentId(who as u64 + 1);
        self.jobs.push(Some(Errand { id, at: to, stay: Span::from_secs_f64(stay_s) }));
    }

    /// Runs one tick for all; gives the least distance between the middles of two trunks.
    fn tick(&mut self) -> f64 {
        self.now += Span::from_secs_f64(DT);
        let mut people: Vec<PersonNear> = self.walkers.iter().map(|w| w.seen(self.now)).collect();
        for i in 0..self.walkers.len() {
            let others: Vec<PersonNear> = people.iter().filter(|p| p.who != i).copied().collect();
            let around =
                WalkerSurroundings { walkways: &self.walkways, robots: &self.robots, people: &others };
            let companion = if self.pairs { others.first().copied() } else { None };
            let work = WorkKnowledge { job: self.jobs[i], known: &[], colleagues: &[], companion };
            self.walkers[i].tick(self.now, DT, &around, &work);
            assert!(self.walkways.is_free(self.walkers[i].pose(self.now).at), "in a rack");
            if self.walkers[i].finished.pop().is_some() {
                self.jobs[i] = None;
            }
            people[i] = self.walkers[i].seen(self.now);
        }
        for r in &mut self.robots {
            r.at += r.velocity * DT;
        }
        let at: Vec<Point> = self.walkers.iter().map(|w| w.pose(self.now).at).collect();
        let pairs = (0..at.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs.map(|(i, j)| (at[i] - at[j]).norm()).fold(f64::INFINITY, f64::min)
    }

    /// Runs until all have done their work; gives the time, seconds, and the least distance of two on the way.
    fn live(&mut self, limit_s: f64) -> (f64, f64) {
        let mut least = f64::INFINITY;
        while self.jobs.iter().any(Option::is_some) {
            least = least.min(self.tick());
            let doing: Vec<_> = self.walkers.iter().map(|w| (w.doing, w.legs.at)).collect();
            assert!(self.now.as_secs_f64() < limit_s, "they have not got past one another: {doing:?}");
        }
        assert!(least >= 2.0 * BODY_M, "two bodies overlap: {least} m");
        (self.now.as_secs_f64(), least)
    }
}

fn heedless() -> Personas {
    Personas { yields: 0.0, hurries: 0.0, freezes: 0.0, cuts_through: 1.0 }
}

#[test]
fn two_who_meet_in_an_aisle_of_a_metre_pass_one_another() {
    for seed in 0..40 {
        let mut crowd = TestCrowd::new();
        let (south, north) = (crowd.place("G3-8"), crowd.place("G3-13"));
        crowd.walks(seed, south, north, 0.0, heedless());
        crowd.walks(seed, north, south, 0.0, heedless());
        let (seconds, _) = crowd.live(40.0);
        // Five metres take 4.2 s at the usual 1.2 m/s, and 6.3 s at the slowest.
        assert!(seconds < 12.0, "{seconds} s with seed {seed}");
    }
}

#[test]
fn four_who_meet_at_a_crossing_pass_one_another() {
    let mut sum = 0.0;
    for seed in 0..40 {
        let mut crowd = TestCrowd::new();
        let [west, east, south, north] = ["G0-7", "G6-7", "G3-4", "G3-10"].map(|n| crowd.place(n));
        for (from, to) in [(west, east), (east, west), (south, north), (north, south)] {
            crowd.walks(seed, from, to, 0.0, heedless());
        }
        let (seconds, _) = crowd.live(45.0);
        sum += seconds;
    }
    // Six metres take 7.5 s at the slowest; two walkers who cut each other off step out and try again.
    assert!(sum / 40.0 < 12.0, "{} s on average", sum / 40.0);
}

#[test]
fn others_pass_somebody_who_works_in_an_aisle_and_his_work_goes_on() {
    for seed in 0..20 {
        let mut crowd = TestCrowd::new();
        let (middle, south, north) = (crowd.place("G3-11"), crowd.place("G3-8"), crowd.place("G3-13"));
        crowd.walks(seed, middle, middle, 30.0, heedless());
        crowd.walks(seed, south, north, 0.0, heedless());
        crowd.walks(seed, north, south, 0.0, heedless());
        while crowd.jobs[1].is_some() || crowd.jobs[2].is_some() {
            assert!(crowd.tick() >= 2.0 * BODY_M);
            assert!(crowd.now.as_secs_f64() < 25.0, "they have not got past, seed {seed}");
        }
        let (seconds, _) = crowd.live(60.0);
        assert!((30.0..31.0).contains(&seconds), "he worked until {seconds} s");
    }
}

#[test]
fn two_who_are_to_work_at_one_place_both_do() {
    let mut crowd = TestCrowd::new();
    let (south, north, middle) = (crowd.place("G3-8"), crowd.place("G3-13"), crowd.place("G3-11"));
    crowd.walks(1, south, middle, 10.0, heedless());
    crowd.walks(1, north, middle, 10.0, heedless());
    let (seconds, _) = crowd.live(60.0);
    assert!(seconds < 20.0, "one waited for the other: {seconds} s");
}

#[test]
fn eight_who_go_to_and_fro_on_one_floor_all_get_to_their_work() {
    let names = ["G0-7", "G12-7", "G3-1", "G3-13", "G6-1", "G6-13", "G9-4", "G9-10"];
    let mut done = 0;
    for seed in 0..10 {
        let mut crowd = TestCrowd::new();
        let places = names.map(|n| crowd.place(n));
        (0..8).for_each(|i| crowd.walks(seed, places[i], places[7 - i], 3.0, Personas::default()));
        let mut round = 0;
        while crowd.now.as_secs_f64() < 240.0 {
            assert!(crowd.tick() >= 2.0 * BODY_M, "two bodies overlap, seed {seed}");
            for i in 0..8 {
                if crowd.jobs[i].is_none() {
                    round += 1;
                    let at = places[(i * 3 + round * 5) % 8];
                    crowd.jobs[i] =
                        Some(Errand { id: AssignmentId(100 + round as u64), at, stay: Span::from_secs(3) });
                }
            }
        }
        // Each job is some ten metres of way and three seconds of work.
        assert!(round > 8 * 10, "{round} jobs in four minutes with seed {seed}");
        done += round;
    }
    assert!(done > 1000, "{done}");
}

/// A walker on a cross street, and a robot that drives across it. Gives the seconds to get there, the least gap, and
/// whether the walker took another path.
fn crosses(personas: Personas, seed: u64, robot_from_m: f64) -> (f64, f64, bool) {
    let mut crowd = TestCrowd::new();
    let (from, to) = (crowd.place("G0-7"), crowd.place("G6-7"));
    crowd.walks(seed, from, to, 0.0, personas);
    let at = crowd.place("G3-7") + Vector::new(0.0, -robot_from_m);
    crowd.robots = vec![RobotNear { at, velocity: Vector::new(0.0, 1.0), half_m: 0.45 }];
    let (mut gap, mut detour) = (f64::INFINITY, false);
    while crowd.jobs[0].is_some() {
        crowd.tick();
        assert!(crowd.now.as_secs_f64() < 60.0, "it waits for ever");
        gap = gap.min(crowd.robots[0].gap(crowd.walkers[0].pose(crowd.now).at));
        detour |= crowd.walkers[0].log().segments().iter().any(|s| s.cause == WalkCause::Detour);
    }
    (crowd.now.as_secs_f64(), gap, detour)
}

#[test]
fn a_walker_waits_a_moment_for_a_robot_that_crosses_its_way_and_takes_no_other() {
    let frozen = Personas { yields: 0.0, hurries: 0.0, freezes: 1.0, cuts_through: 0.0 };
    let (mut kept, mut nearest) = (0, f64::INFINITY);
    for seed in 0..10 {
        for robot_from_m in [1.5, 2.0, 2.5, 3.0, 3.5] {
            let (seconds, gap, detour) = crosses(frozen, seed, robot_from_m);
            nearest = nearest.min(gap);
            assert!(!detour && seconds < 20.0, "{seconds} s, detour {detour}");
            kept += u64::from(gap > 0.2);
        }
    }
    assert!(nearest > 0.0 && kept >= 45, "nearest {nearest} m, {kept} of 50 kept 0.2 m");
}

#[test]
fn who_takes_no_notice_of_robots_goes_nearer_to_them_than_who_waits() {
    let yields = Personas { yields: 0.0, hurries: 0.0, freezes: 1.0, cuts_through: 0.0 };
    let least = |personas: Personas| (0..10).map(move |seed| crosses(personas, seed, 4.0).1);
    let (waits, cuts): (f64, f64) = (least(yields).sum(), least(heedless()).sum());
    assert!(cuts < 0.8 * waits, "{cuts} m and {waits} m");
}

#[test]
fn two_of_a_pair_walk_side_by_side_where_there_is_room_and_behind_one_another_elsewhere() {
    let mut beside = 0;
    let mut together = 0;
    let mut all = 0;
    for seed in 0..10 {
        let mut crowd = TestCrowd::new();
        crowd.pairs = true;
        let [a, b, west, east] = ["G0-7", "G0-8", "G12-7", "G12-6"].map(|n| crowd.place(n));
        crowd.walks(seed, a, west, 0.0, heedless());
        crowd.walks(seed, b, east, 0.0, heedless());
        while crowd.jobs.iter().all(Option::is_some) {
            assert!(crowd.tick() >= 2.0 * BODY_M, "they touch");
            assert!(crowd.now.as_secs_f64() < 60.0);
            let [x, y] = [0, 1].map(|i| crowd.walkers[i].way_at());
            if (2.5..10.0).contains(&x.x) {
                all += 1;
                together += u64::from((x - y).norm() < 1.6);
                beside += u64::from((x.x - y.x).abs() < 0.5);
            }
        }
    }
    assert!(all > 2000 && together * 10 > all * 8, "{together} of {all} together");
    // Streets are a metre wide except at crossings: less than two side by side need, more than single file does.
    assert!(beside * 10 > all * 4, "{beside} of {all} side by side");
}

//! A wide hall with robots and people: the same robots, jobs and people with and without leaving the line.
//!
//! Main types: [`HallReport`], [`HallArm`], [`HallRun`]; main function: [`halls`]. Robots carry racks from one end of
//! the hall to stations at the other one. People work on the lanes between, walk along and across them, and follow
//! impulses. Refuses: a rival that pays for corridors that it does not use: it also runs on the same map without them.

use crate::robot_time::{RobotTime, TimeUse};
use crate::statistics::{Interval, Summary};
use giveway_floor::geometry::Point;
use giveway_floor::id::RobotId;
use giveway_floor::time::Span;
use giveway_floor::warehouse::{
    Corridor, Draft, DraftLane, DraftNode, DraftRack, DraftStation, Users, Warehouse,
};
use giveway_sim::{Scenario, Simulation};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Number of one-way lanes across the hall, in alternating directions, and the distance between them, metres.
const ROWS: usize = 4;
const APART_M: f64 = 7.5;
/// Number of nodes of such a lane, and the distance between them, metres.
const NODES: usize = 7;
const STEP_M: f64 = 4.0;
/// Distance between nodes at both ends of the hall, metres.
const END_STEP_M: f64 = 1.5;
/// Room on both sides of such a lane, metres.
const SIDE_M: f64 = 3.3;

/// Whether robots leave the line, and on which map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HallArm {
    /// Lanes have corridors, and robots may leave the line, by the improved dynamic window.
    Free,
    /// Lanes have corridors, and robots may leave the line, by the traditional dynamic window.
    Traditional,
    /// Lanes have corridors, and robots keep to the line.
    Lines,
    /// Lanes have no corridors.
    NoCorridors,
}

impl HallArm {
    /// All arms.
    pub const ALL: [HallArm; 4] = [HallArm::Free, HallArm::Traditional, HallArm::Lines, HallArm::NoCorridors];

    /// The arm's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            HallArm::Free => "free",
            HallArm::Traditional => "free_traditional",
            HallArm::Lines => "lines",
            HallArm::NoCorridors => "lines_no_corridors",
        }
    }
}

/// Size of the experiment in the hall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HallSetup {
    /// Number of robots.
    pub robots: usize,
    /// Number of people.
    pub workers: usize,
    /// Duration of a run, seconds.
    pub seconds: f64,
}

impl Default for HallSetup {
    fn default() -> HallSetup {
        HallSetup { robots: 8, workers: 5, seconds: 1200.0 }
    }
}

/// Figures of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct HallRun {
    /// Racks served per hour.
    pub deliveries_per_hour: f64,
    /// How long robots waited for people, including behind other robots that did, seconds per robot and hour.
    pub wait_s: f64,
    /// Moving robots that came into region 1 of a person, per hour of people on the floor.
    pub encounters: f64,
    /// How often robots' own scanners stopped them while they drove, per hour.
    pub own_stops: f64,
    /// The least distance between the middles of a moving robot and of a person, metres; nothing beyond three.
    pub closest_m: Option<f64>,
    /// Assignments that people completed, per hour.
    pub assignments_per_hour: f64,
    /// How often robots passed a person beside the line.
    pub passes: u64,
    /// Number of broken laws.
    pub law_violations: u64,
    /// The first broken laws, in words.
    pub broken: Vec<String>,
}

/// Results of many runs.
#[derive(Clone, Debug)]
pub struct HallReport {
    /// The runs of each arm, in order.
    pub runs: Vec<(HallArm, Vec<HallRun>)>,
}

impl HallReport {
    /// The runs of an arm.
    pub fn of(&self, arm: HallArm) -> &[HallRun] {
        let (_, runs) = self.runs.iter().find(|(a, _)| *a == arm).expect("all arms were run");
        runs
    }

    /// Mean and standard deviation of a figure.
    pub fn summary(&self, arm: HallArm, figure: fn(&HallRun) -> f64) -> Summary {
        let all: Vec<f64> = self.of(arm).iter().map(figure).collect();
        Summary::of(&all)
    }

    /// Interval of `ours − theirs`, run by run.
    pub fn paired(&self, ours: HallArm, theirs: HallArm, figure: fn(&HallRun) -> f64) -> Interval {
        let of = |arm| self.of(arm).iter().map(figure).collect::<Vec<f64>>();
        Interval::of_pairs(&of(ours), &of(theirs))
    }

    /// How often a law was broken in the runs of an arm.
    pub fn law_violations(&self, arm: HallArm) -> u64 {
        self.of(arm).iter().map(|r| r.law_violations).sum()
    }
}

/// Runs all arms on seeds from `seed` on; calls `progress` after each run.
pub fn halls(setup: HallSetup, seed: u64, runs: u64, mut progress: impl FnMut()) -> HallReport {
    let mut all: Vec<(HallArm, Vec<HallRun>)> = HallArm::ALL.map(|arm| (arm, Vec::new())).into();
    for run in 0..runs {
        for (arm, of) in &mut all {
            of.push(hall(setup, *arm, seed + run));
            progress();
        }
    }
    HallReport { runs: all }
}

/// Runs one arm once.
pub fn hall(setup: HallSetup, arm: HallArm, seed: u64) -> HallRun {
    let (map, scenario) = (hall_map(arm != HallArm::NoCorridors), hall_scenario(setup, arm));
    let mut sim = Simulation::new(map, &scenario, &[], seed, false, || 0);
    let (mut time, mut passing, mut passes) = (RobotTime::default(), BTreeSet::new(), 0);
    while !sim.is_over() {
        sim.step();
        time.look(sim.fleet(), sim.now());
        let robots = sim.fleet().ledger().present();
        let now: BTreeSet<RobotId> = robots.filter(|r| sim.fleet().passing(*r).is_some()).collect();
        passes += now.difference(&passing).count() as u64;
        passing = now;
    }
    let own_stops = sim.world.own_stops();
    let outcome = sim.outcome();
    let hours = outcome.simulated.as_secs_f64() / 3600.0;
    let figures = &outcome.people.figures;
    let share = |u| time.share(u).unwrap_or(0.0);
    let closest = figures.rings.iter().flat_map(|ring| ring.closest_m.iter().copied()).reduce(f64::min);
    let people_h = figures.worker_time.max(Span(1)).as_secs_f64() / 3600.0;
    HallRun {
        deliveries_per_hour: outcome.counts.robot_deliveries as f64 / hours,
        wait_s: 3600.0 * (share(TimeUse::GivesWay) + share(TimeUse::BehindOneThatGivesWay)),
        encounters: figures.encounters as f64 / people_h,
        own_stops: own_stops as f64 / hours,
        closest_m: closest,
        assignments_per_hour: outcome.people.completed as f64 / hours,
        passes,
        law_violations: outcome.law_violations,
        broken: outcome.broken,
    }
}

/// The scenario with the robots and people of the hall.
fn hall_scenario(setup: HallSetup, arm: HallArm) -> Scenario {
    let HallSetup { robots, workers, seconds } = setup;
    let (free, backlog) = (matches!(arm, HallArm::Free | HallArm::Traditional), 2 * robots);
    let planner = if arm == HallArm::Traditional { "traditional" } else { "improved" };
    let places = ["r1n3", "r0n2", "r2n4", "r3n3", "r0n4", "r1n2", "r3n2", "r2n3", "r1n4", "r0n3", "r2n2"];
    let text = format!(
        r#"{{"giveway_scenario": 1, "name": "hall", "map": "", "robots": {robots}, "period_ms": 100,
            "duration_s": {seconds}, "jobs": {{"backlog": {backlog}}}, "local_planner": "{planner}",
            "fleet": {{"footprint": {{"circle_m": 0.35}}, "free_navigation": {free}}},
            "workers": {{"count": {workers}, "enter_s": 10, "deviations": {{"causes": "all"}},
                "assignments": {{"list": {{"places": {places:?}, "stay_s": 25}}}},
                "sensor": {{"jitter_ms": 80, "loss": 0.02}}}}}}"#
    );
    Scenario::parse(&text).expect("the hall is a scenario")
}

/// The map: racks on the left, stations on the right, four lanes across between two rows of pillars, and people's work
/// on the lanes.
pub fn hall_map(corridors: bool) -> Arc<Warehouse> {
    let mut draft = Draft { name: "hall".into(), footprint_m: 0.9, ..Draft::default() };
    let width_m = STEP_M * (NODES - 1) as f64;
    let ends = (APART_M * (ROWS - 1) as f64 / END_STEP_M) as i32;
    for k in -4..=ends {
        let y = END_STEP_M * f64::from(k);
        node(&mut draft, format!("a{k}"), 0.0, y);
        node(&mut draft, format!("b{k}"), width_m, y);
        if k > -4 {
            for end in ["a", "b"] {
                lane(&mut draft, format!("{end}{}", k - 1), format!("{end}{k}"), true);
            }
        }
    }
    storage_and_stations(&mut draft, ends, width_m);
    for row in 0..ROWS {
        across(&mut draft, row, corridors);
    }
    for row in 0..ROWS - 1 {
        for i in 1..NODES - 2 {
            let middle = Point::new(STEP_M * (i as f64 + 0.5), APART_M * (row as f64 + 0.5));
            let corner = |x: f64, y: f64| Point::new(middle.x + 0.4 * x, middle.y + 0.4 * y);
            draft.obstacles.push(vec![
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ]);
        }
    }
    let (low, high) = (-APART_M / 2.0, APART_M * (ROWS as f64 - 0.5));
    let floor = [(1.2, low), (width_m - 1.2, low), (width_m - 1.2, high), (1.2, high)];
    draft.walkable.push(floor.map(|(x, y)| Point::new(x, y)).into());
    node(&mut draft, "door".into(), STEP_M * 3.0, high - 0.5);
    let way = DraftLane::both_ways("door", format!("r{}n3", ROWS - 1), Users::PEOPLE);
    draft.lanes.push(way);
    draft.exits.push("door".into());
    Arc::new(draft.build().unwrap_or_else(|e| panic!("the hall is a map: {e}")))
}

/// Adds both ends: racks and chargers on the left, stations and parking places on the right.
fn storage_and_stations(draft: &mut Draft, ends: i32, width_m: f64) {
    for k in -4..=ends {
        let y = END_STEP_M * f64::from(k);
        let name = format!("s{k}");
        node(draft, name.clone(), -END_STEP_M, y);
        lane(draft, name.clone(), format!("a{k}"), true);
        if k < 0 {
            draft.chargers.push(name);
            continue;
        }
        if k % 6 != 5 {
            draft.racks.push(DraftRack::plain(format!("rack-{k}"), &name));
        }
        draft.storage.push(name);
    }
    for k in [-2, -4] {
        let name = format!("p{k}");
        node(draft, name.clone(), width_m + END_STEP_M, END_STEP_M * f64::from(k));
        lane(draft, name.clone(), format!("b{k}"), true);
        draft.parking.push(name);
    }
    for k in [1, 4, 7, 10] {
        let (at, queue) = (format!("w{k}"), format!("q{k}"));
        node(draft, at.clone(), width_m + END_STEP_M, END_STEP_M * f64::from(k));
        node(draft, queue.clone(), width_m + END_STEP_M, END_STEP_M * f64::from(k + 1));
        lane(draft, format!("b{}", k + 1), queue.clone(), false);
        lane(draft, queue.clone(), at.clone(), false);
        lane(draft, at.clone(), format!("b{k}"), false);
        let pick = Span::from_secs(8);
        draft.stations.push(DraftStation {
            name: format!("W{k}"),
            node: at,
            queue: vec![queue],
            pick,
            cell: None,
        });
    }
}

/// Adds one lane across: people may walk on it, and in the middle of the hall it has room on both sides.
fn across(draft: &mut Draft, row: usize, corridors: bool) {
    let y = APART_M * row as f64;
    let end = (y / END_STEP_M).round() as i32;
    for i in 1..NODES - 1 {
        node(draft, format!("r{row}n{i}"), STEP_M * i as f64, y);
    }
    let name = |i: usize| match i {
        0 => format!("a{end}"),
        _ if i == NODES - 1 => format!("b{end}"),
        _ => format!("r{row}n{i}"),
    };
    for i in 0..NODES - 1 {
        let (from, to) = if row.is_multiple_of(2) { (i, i + 1) } else { (i + 1, i) };
        let is_inside = (1..NODES - 2).contains(&i);
        let corridor = (corridors && is_inside).then_some(Corridor { left_m: SIDE_M, right_m: SIDE_M });
        draft.lanes.push(DraftLane { corridor, ..DraftLane::one_way(name(from), name(to), Users::ALL) });
    }
}

fn node(draft: &mut Draft, name: String, x: f64, y: f64) {
    draft.nodes.push(DraftNode { name, at: Point::new(x, y) });
}

fn lane(draft: &mut Draft, from: String, to: String, both: bool) {
    draft.lanes.push(DraftLane { both, ..DraftLane::one_way(from, to, Users::ROBOTS) });
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: HallSetup = HallSetup { robots: 6, workers: 4, seconds: 420.0 };

    #[test]
    fn in_a_hall_with_people_free_robots_pass_them_and_no_law_is_broken() {
        let mut passes = 0;
        for seed in [3, 4] {
            let run = hall(SHORT, HallArm::Free, seed);
            assert_eq!(run.broken, Vec::<String>::new(), "seed {seed}");
            assert!(run.deliveries_per_hour > 0.0);
            assert_eq!(run, hall(SHORT, HallArm::Free, seed), "the same seed, the same run");
            passes += run.passes;
        }
        assert!(passes > 0, "nobody was passed");
    }

    #[test]
    fn robots_that_keep_to_the_line_pass_nobody() {
        for arm in [HallArm::Lines, HallArm::NoCorridors] {
            let run = hall(SHORT, arm, 3);
            assert_eq!((run.passes, run.law_violations), (0, 0), "{arm:?}: {:?}", run.broken);
        }
    }
}

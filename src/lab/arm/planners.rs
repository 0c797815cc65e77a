//! Path planners of an arm compared: twelve workspaces, random queries (Liu et al. 2024, table I).
//!
//! Main types: [`Workshops`], [`PlannerKind`], [`QueryAnswer`]. Refuses: to read a clock, and to train the net with the
//! queries that it is asked.

use super::person::BenchPerson;
use super::teaching::{NetStep, step_error, teach_graph};
use crate::arm::marching::bfmt_star;
use crate::arm::net::{GraphNet, NET_STEP_RAD, WorkGraph};
use crate::arm::random_trees::{rrt, rrt_star};
use giveway_cell::arm::{ArmKind, ArmSpace, ArmWay, Capsule, Joints, joint_distance, rrt_connect};
use giveway_sim::random::Stream;
use nalgebra::{Isometry3, Point3, Vector3};

/// A planner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlannerKind {
    /// A rapidly exploring random tree.
    Rrt,
    /// A random tree that is rewired.
    RrtStar,
    /// Two wavefronts over samples.
    BfmtStar,
    /// The graph net alone.
    Graph,
    /// The graph net, and RRT-Connect if the net finds no path.
    GraphFallback,
}

impl PlannerKind {
    /// All planners.
    pub const ALL: [PlannerKind; 5] = [
        PlannerKind::Rrt,
        PlannerKind::RrtStar,
        PlannerKind::BfmtStar,
        PlannerKind::Graph,
        PlannerKind::GraphFallback,
    ];

    /// The planner's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            PlannerKind::Rrt => "rrt",
            PlannerKind::RrtStar => "rrt_star",
            PlannerKind::BfmtStar => "bfmt_star",
            PlannerKind::Graph => "graph",
            PlannerKind::GraphFallback => "graph_fallback",
        }
    }
}

/// Number of samples of each planner.
const RRT_SAMPLES: usize = 1500;
const STAR_SAMPLES: usize = 400;
const MARCHING_SAMPLES: usize = 300;
const CONNECT_SAMPLES: usize = 5000;
/// Steps of the net from either end.
const NET_STEPS: usize = 12;
/// Samples of the oracle, and the number of paths it is asked for per workspace.
const ORACLE_SAMPLES: usize = 700;
const LESSONS: usize = 60;
/// Rounds of learning.
const ROUNDS: usize = 12;

/// Result of one planner for one query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueryAnswer {
    /// Length of the path at the tool's tip, metres; nothing if none was found.
    pub length_m: Option<f64>,
    /// Duration by the caller's clock, milliseconds.
    pub took_ms: f64,
    /// Whether the path fails a second, finer check.
    pub is_wrong: bool,
}

/// An arm among obstacles, and a person's arm at rest.
pub struct Workshops {
    seed: u64,
    spaces: Vec<ArmSpace>,
    graphs: Vec<WorkGraph>,
    net: GraphNet,
    /// Mean squared error of the net's steps on paths that it did not learn from, rad².
    pub net_error: f64,
}

impl Workshops {
    /// `count` workspaces, and the net trained in them.
    pub fn new(seed: u64, count: usize) -> Option<Workshops> {
        let (spaces, graphs): (Vec<_>, Vec<_>) = (0..count as u64).map(|k| workspace(seed, k)).unzip();
        let lessons = |first: u64, per: usize| -> Vec<NetStep> {
            let of = |k: usize| (first..first + per as u64).map(move |n| (k, n));
            let pairs: Vec<(usize, u64)> = (0..spaces.len()).flat_map(of).collect();
            pairs.into_iter().flat_map(|(k, n)| oracle(seed, &spaces[k], k, n)).collect()
        };
        let (learned, left_out) = (lessons(0, LESSONS), lessons(10_000, 5));
        let net = teach_graph(seed, &graphs, &learned, ROUNDS)?;
        let net_error = step_error(&net, &graphs, &left_out);
        Some(Workshops { seed, spaces, graphs, net, net_error })
    }

    /// Number of workspaces.
    pub fn count(&self) -> usize {
        self.spaces.len()
    }

    /// Results of all planners for one query; `clock` gives milliseconds.
    pub fn ask(&self, workspace: usize, n: u64, clock: &mut dyn FnMut() -> f64) -> Vec<QueryAnswer> {
        let space = &self.spaces[workspace];
        let (start, goal) = query(self.seed, space, workspace, 1_000_000 + n);
        let mut ask = |kind: PlannerKind| {
            let mut chance = Stream::new(self.seed, 93, workspace as u64 * 1_000_003 + n);
            let begun = clock();
            let way = self.plan(kind, workspace, &start, &goal, &mut || chance.unit());
            let took_ms = clock() - begun;
            let is_wrong = way.as_ref().is_some_and(|way| !is_right(space, way, &start, &goal));
            QueryAnswer { length_m: way.map(|way| space.tip_length_m(&way)), took_ms, is_wrong }
        };
        PlannerKind::ALL.into_iter().map(&mut ask).collect()
    }

    fn plan(
        &self,
        kind: PlannerKind,
        workspace: usize,
        start: &Joints,
        goal: &Joints,
        draw: &mut dyn FnMut() -> f64,
    ) -> Option<ArmWay> {
        let space = &self.spaces[workspace];
        let by_net = || self.net.plan(space, &self.graphs[workspace], start, goal, NET_STEPS);
        match kind {
            PlannerKind::Rrt => rrt(space, start, goal, RRT_SAMPLES, draw),
            PlannerKind::RrtStar => rrt_star(space, start, goal, STAR_SAMPLES, draw),
            PlannerKind::BfmtStar => bfmt_star(space, start, goal, MARCHING_SAMPLES, draw),
            PlannerKind::Graph => by_net(),
            PlannerKind::GraphFallback => by_net().or_else(|| {
                let way = rrt_connect(space, start, goal, CONNECT_SAMPLES, draw)?;
                Some(space.shortened(&way, 30, draw))
            }),
        }
    }

    /// The net, for other experiments with it.
    pub fn net(&self) -> &GraphNet {
        &self.net
    }
}

/// Whether a path leads from start to goal and its configurations, in steps of a fifth of the planners', touch no
/// obstacle.
fn is_right(space: &ArmSpace, way: &ArmWay, start: &Joints, goal: &Joints) -> bool {
    let ends = way.configurations();
    let steps = (way.length_rad() / 0.01).ceil() as usize;
    let links = |q: &Joints| space.kind.capsules(&space.kind.pose(&space.base, q), 0.0);
    let touches = |q: &Joints| links(q).iter().any(|l| space.obstacles.iter().any(|o| l.distance_m(o) < 0.0));
    let at = |k: usize| way.at_rad(way.length_rad() * k as f64 / steps.max(1) as f64);
    let ends_fit = ends.first() == Some(start) && ends.last() == Some(goal);
    ends_fit && (0..=steps).all(|k| !touches(&at(k)))
}

/// Lower bounds of the usual range of an arm on a table, radians.
pub(super) const LOW_RAD: Joints = [-2.6, -2.8, -2.4, -3.0, -2.2, -2.0];
/// Upper bounds of that range, see [`LOW_RAD`].
pub(super) const HIGH_RAD: Joints = [2.6, -0.3, 2.4, 1.0, 2.2, 2.0];

/// An arm on a table among five to eight obstacles.
fn workspace(seed: u64, k: u64) -> (ArmSpace, WorkGraph) {
    let mut chance = Stream::new(seed, 92, k);
    let person = BenchPerson::random(&mut chance, Point3::new(0.15, -0.95, 0.35));
    let joints = person.joints(Point3::new(0.1, -0.7, 0.05));
    let mut obstacles: Vec<Capsule> =
        (0..3).map(|i| Capsule { a: joints[i], b: joints[i + 1], radius_m: 0.05 }).collect();
    let count = 5 + chance.below(4);
    while obstacles.len() < count + 3 {
        let (angle, far) = (chance.between(0.0, std::f64::consts::TAU), chance.between(0.35, 0.85));
        let a = Point3::new(far * angle.cos(), far * angle.sin(), chance.between(0.05, 0.6));
        let along = Vector3::new(chance.normal(), chance.normal(), chance.normal()).normalize();
        let b = a + along * chance.between(0.0, 0.4);
        let radius_m = chance.between(0.04, 0.1);
        // The space around the arm's own column stays free.
        if a.coords.xy().norm().min(b.coords.xy().norm()) > 0.3 {
            obstacles.push(Capsule { a, b, radius_m });
        }
    }
    let graph = WorkGraph::new(&obstacles[3..], &joints, &[joints; 5]);
    (space_with(obstacles), graph)
}

/// The arm on its table among these obstacles.
pub(super) fn space_with(obstacles: Vec<Capsule>) -> ArmSpace {
    ArmSpace {
        kind: ArmKind::collaborative().clone(),
        base: Isometry3::identity(),
        obstacles,
        floor_m: 0.0,
        low_rad: LOW_RAD,
        high_rad: HIGH_RAD,
    }
}

/// A random start and goal, both free.
fn query(seed: u64, space: &ArmSpace, workspace: usize, n: u64) -> (Joints, Joints) {
    let mut chance = Stream::new(seed, 94 + workspace as u64 * 16, n);
    let mut free = || loop {
        let q = space.configuration(&mut || chance.unit());
        if space.is_free(&q) {
            break q;
        }
    };
    (free(), free())
}

/// Steps of the oracle's path for a query, in both directions; none if it finds no path.
fn oracle(seed: u64, space: &ArmSpace, workspace: usize, n: u64) -> Vec<NetStep> {
    let (start, goal) = query(seed, space, workspace, n);
    let mut chance = Stream::new(seed, 95, workspace as u64 * 1_000_003 + n);
    let mut draw = || chance.unit();
    let Some(way) = rrt_star(space, &start, &goal, ORACLE_SAMPLES, &mut draw) else { return Vec::new() };
    let way = space.shortened(&way, 60, &mut draw);
    let length = way.length_rad();
    let count = (length / NET_STEP_RAD).ceil().max(1.0) as usize;
    let at = |k: usize| way.at_rad(length * k as f64 / count as f64);
    let all: Vec<Joints> = (0..=count).map(at).collect();
    let step = |from: usize, to: usize, goal: Joints| NetStep {
        workspace,
        now: all[from],
        goal,
        step: std::array::from_fn(|i| all[to][i] - all[from][i]),
    };
    let there = (0..count).map(|k| step(k, k + 1, goal));
    let back = (0..count).map(|k| step(k + 1, k, start));
    there.chain(back).filter(|s| joint_distance(&s.step, &[0.0; 6]) > 1e-6).collect()
}

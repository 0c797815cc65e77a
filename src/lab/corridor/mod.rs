//! Robots with corridors meet a worker: on the line, with the traditional dynamic window, and with the improved one.
//!
//! Main types: [`CorridorReport`], [`CorridorArm`], [`CorridorFigures`]; main functions: [`corridor`], [`by_angle`].
//! Source: Ye, Guo, Guo and Luo (2024), table 3. All arms see the same scenes, the same steps of the worker and the
//! same noise. Refuses: weights tuned on the reported seeds (`docs/corridors.md` names the seeds of the tuning).

mod drive;
mod hall;
mod scanner;
mod scene;
mod worker;

pub use drive::{CorridorRun, drive};
pub use hall::{HallArm, HallReport, HallRun, HallSetup, hall, hall_map, halls};
pub use scene::{CorridorScene, SceneKind, WorkerWalk};

use super::statistics::{Interval, Summary};
use giveway_people::local::{ImprovedWeights, LocalMethod, TraditionalWeights};
use giveway_sim::random::Stream;

/// How the robot passes the worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CorridorArm {
    /// The robot stays on the line and stops before the worker's safe space.
    Stop,
    /// The traditional dynamic window, with the weights that serve it best.
    Traditional,
    /// The traditional dynamic window with equal weights.
    TraditionalEqual,
    /// The improved dynamic window.
    Improved,
}

impl CorridorArm {
    /// All arms.
    pub const ALL: [CorridorArm; 4] =
        [CorridorArm::Stop, CorridorArm::Traditional, CorridorArm::TraditionalEqual, CorridorArm::Improved];

    /// The arm's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            CorridorArm::Stop => "stop",
            CorridorArm::Traditional => "traditional",
            CorridorArm::TraditionalEqual => "traditional_equal",
            CorridorArm::Improved => "improved",
        }
    }

    fn method(self) -> LocalMethod {
        match self {
            CorridorArm::Stop => LocalMethod::Line,
            CorridorArm::Traditional => LocalMethod::Traditional(TraditionalWeights::default()),
            CorridorArm::TraditionalEqual => LocalMethod::Traditional(TraditionalWeights::EQUAL),
            CorridorArm::Improved => LocalMethod::Improved(ImprovedWeights::default()),
        }
    }
}

/// Means over runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorridorFigures {
    /// Distance driven, metres.
    pub path_m: f64,
    /// Time to the goal, seconds.
    pub time_s: f64,
    /// Least distance between the robot's outline and the worker's body, metres.
    pub closest_m: f64,
    /// Share of crossings behind the worker; nothing if there was no crossing.
    pub behind: Option<f64>,
    /// Share of runs that reached the goal.
    pub reached: f64,
    /// Stops by the robot's own scanner per run.
    pub own_stops: f64,
}

impl CorridorFigures {
    /// The means of these runs.
    pub fn of(runs: &[CorridorRun]) -> CorridorFigures {
        let mean = |f: fn(&CorridorRun) -> f64| {
            let all: Vec<f64> = runs.iter().map(f).collect();
            Summary::of(&all).mean.unwrap_or(f64::NAN)
        };
        let crossed: Vec<f64> = runs.iter().filter_map(|r| r.behind.map(f64::from)).collect();
        CorridorFigures {
            path_m: mean(|r| r.path_m),
            time_s: mean(|r| r.time_s),
            closest_m: mean(|r| r.closest_m),
            behind: Summary::of(&crossed).mean,
            reached: mean(|r| f64::from(r.reached)),
            own_stops: mean(|r| f64::from(r.own_stops)),
        }
    }
}

/// Results of many runs.
#[derive(Clone, Debug)]
pub struct CorridorReport {
    /// For each kind of scene and each arm, the runs in order.
    pub runs: Vec<(SceneKind, CorridorArm, Vec<CorridorRun>)>,
}

/// Number of random streams that each run may use.
const STREAMS: u64 = 64;
/// Purpose of the random stream for scenes.
const SCENES: u64 = 0xc0_00;

/// Drives all kinds of scenes `runs` times with all arms.
pub fn corridor(seed: u64, runs: u64) -> CorridorReport {
    let kinds = SceneKind::CASES.into_iter().chain(SceneKind::AISLES);
    let mut all = Vec::new();
    for kind in kinds {
        for arm in CorridorArm::ALL {
            all.push((kind, arm, driven(kind, arm.method(), seed, runs)));
        }
    }
    CorridorReport { runs: all }
}

/// Drives scenes of one kind with one method.
pub fn driven(kind: SceneKind, method: LocalMethod, seed: u64, runs: u64) -> Vec<CorridorRun> {
    let one = |run: u64| {
        let which = run * STREAMS + kind as u64;
        let scene = CorridorScene::drawn(kind, &mut Stream::new(seed, SCENES, which));
        drive(&scene, method, seed, which)
    };
    (0..runs).map(one).collect()
}

impl CorridorReport {
    /// The runs of an arm in scenes of these kinds.
    pub fn of(&self, kinds: &[SceneKind], arm: CorridorArm) -> Vec<CorridorRun> {
        let some = self.runs.iter().filter(|(kind, a, _)| kinds.contains(kind) && *a == arm);
        some.flat_map(|(_, _, runs)| runs.iter().copied()).collect()
    }

    /// Interval of `ours − theirs`, run by run.
    pub fn paired(
        &self,
        kinds: &[SceneKind],
        ours: CorridorArm,
        theirs: CorridorArm,
        figure: fn(&CorridorRun) -> f64,
    ) -> Interval {
        let of = |arm| self.of(kinds, arm).iter().map(figure).collect::<Vec<f64>>();
        Interval::of_pairs(&of(ours), &of(theirs))
    }

    /// How often a law was broken, over all arms and scenes.
    pub fn law_violations(&self) -> u32 {
        self.runs.iter().flat_map(|(_, _, runs)| runs).map(|r| r.violations).sum()
    }
}

/// Angles between the paths of robot and worker in the table, degrees: 180 is head-on.
pub const ANGLES_DEG: [f64; 5] = [30.0, 60.0, 90.0, 120.0, 150.0];
/// Speeds of workers in the table, metres per second.
pub const WALKS_MPS: [f64; 4] = [0.4, 0.7, 1.0, 1.4];

/// Drives all arms in an aisle of 12 m that a worker crosses in its middle, at each angle and speed.
pub fn by_angle(seed: u64, runs: u64) -> Vec<(f64, f64, [Vec<CorridorRun>; 4])> {
    let mut table = Vec::new();
    for (i, degrees) in ANGLES_DEG.into_iter().enumerate() {
        for (j, walks) in WALKS_MPS.into_iter().enumerate() {
            let cell = (i * WALKS_MPS.len() + j) as u64;
            let runs_of = |arm: CorridorArm| {
                let one = |run: u64| {
                    let which = (1 << 32) + (run * STREAMS) + cell;
                    let late_s = Stream::new(seed, SCENES, which).between(-1.0, 1.0);
                    drive(
                        &CorridorScene::crossing(degrees.to_radians(), walks, late_s),
                        arm.method(),
                        seed,
                        which,
                    )
                };
                (0..runs).map(one).collect()
            };
            table.push((degrees, walks, CorridorArm::ALL.map(runs_of)));
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_law_is_broken_and_the_same_seed_gives_the_same_runs() {
        let report = corridor(3, 1);
        assert_eq!(report.law_violations(), 0);
        for (kind, arm, runs) in &report.runs {
            assert_eq!(*runs, driven(*kind, arm.method(), 3, 1), "{kind:?} {arm:?}");
            for r in runs.iter().filter(|r| r.reached) {
                assert!(r.path_m > 4.8 && r.time_s > 8.0 && r.closest_m > 0.0, "{kind:?} {arm:?} {r:?}");
            }
        }
    }

    #[test]
    fn who_keeps_to_the_line_drives_its_length_and_waits_for_ever_behind_who_stands() {
        let line = |kind| driven(kind, CorridorArm::Stop.method(), 5, 2);
        for run in line(SceneKind::CaseOne) {
            assert!(run.reached && (run.path_m - 4.9).abs() < 1e-6, "{run:?}");
        }
        assert!(line(SceneKind::Standing).iter().all(|r| !r.reached));
        let round = driven(SceneKind::Standing, CorridorArm::Improved.method(), 5, 2);
        assert!(round.iter().all(|r| r.reached && r.own_stops == 0), "{round:?}");
    }

    #[test]
    fn a_planner_that_sees_nobody_is_stopped_by_the_robots_own_scanner_and_touches_nobody() {
        // An inflated obstacle of no size, and no weight on distance: the robot drives straight on.
        let blind = TraditionalWeights { clearance: 0.0, inflated_m: -0.4, ..TraditionalWeights::default() };
        let runs = driven(SceneKind::CaseOne, LocalMethod::Traditional(blind), 2, 4);
        assert!(runs.iter().map(|r| r.own_stops).sum::<u32>() > 0, "{runs:?}");
        assert!(runs.iter().all(|r| r.violations == 0 && r.closest_m > 0.0), "{runs:?}");
    }
}

//! `giveway experiment table-4-1` and `detection`: robots and people together, many seeds on all cores.
//!
//! Main types: [`TableArgs`], [`DetectionArgs`]. Refuses: results that depend on the order in which runs end.

use super::{in_parallel, read_map, rings};
use crate::statistics::{Interval, Summary};
use crate::table::{Column, RunRow, TableSetup};
use clap::{Args, ValueEnum};
use giveway_floor::warehouse::{Warehouse, room_for, thesis};
use giveway_people::aware::{HumanAwarePolicy, NodeWindows};
use giveway_sim::measure::detection::{Score, TO_GOAL_S};
use giveway_sim::{Causes, EncounterFigures, Sensor, Source};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Pairs of arms to compare.
const PAIRS: [(HumanAwarePolicy, HumanAwarePolicy); 5] = [
    (HumanAwarePolicy::Giveway, HumanAwarePolicy::Phir),
    (HumanAwarePolicy::Phir, HumanAwarePolicy::Nhir),
    (HumanAwarePolicy::Phir, HumanAwarePolicy::Shir),
    (HumanAwarePolicy::Giveway, HumanAwarePolicy::Nhir),
    (HumanAwarePolicy::Giveway, HumanAwarePolicy::Shir),
];

/// An arm, on the command line.
#[derive(Clone, Copy, ValueEnum)]
pub enum ArmArgument {
    /// No prediction.
    Nhir,
    /// Straight ahead.
    Shir,
    /// As published.
    Phir,
    /// Ours.
    Giveway,
}

impl ArmArgument {
    /// The policy of this name.
    pub fn arm(self) -> HumanAwarePolicy {
        match self {
            ArmArgument::Nhir => HumanAwarePolicy::Nhir,
            ArmArgument::Shir => HumanAwarePolicy::Shir,
            ArmArgument::Phir => HumanAwarePolicy::Phir,
            ArmArgument::Giveway => HumanAwarePolicy::Giveway,
        }
    }
}

/// What both experiments share.
#[derive(Args)]
struct Runs {
    /// Seeds for each arm and number of workers.
    #[arg(long, default_value_t = 10)]
    runs: u64,
    /// The first seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How long each run is, seconds.
    #[arg(long, default_value_t = 750.0)]
    seconds: f64,
    /// How many robots.
    #[arg(long, default_value_t = 20)]
    robots: usize,
    /// The hall; the one of the thesis if absent.
    #[arg(long)]
    map: Option<PathBuf>,
    /// Runs at a time; as many as there are cores if absent.
    #[arg(long)]
    jobs: Option<usize>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `experiment table-4-1`.
#[derive(Args)]
pub struct TableArgs {
    #[command(flatten)]
    runs: Runs,
    /// Numbers of workers.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 3, 5])]
    workers: Vec<usize>,
    /// Arms.
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["nhir", "shir", "phir", "giveway"])]
    arms: Vec<ArmArgument>,
    /// Why workers leave their paths besides the six departures of the published experiment: not at all, or for all
    /// causes that scenarios know.
    #[arg(long, value_enum, default_value = "all")]
    causes: CausesArgument,
}

/// Causes, on the command line.
#[derive(Clone, Copy, ValueEnum)]
pub enum CausesArgument {
    /// Only the six departures: the published condition.
    None,
    /// All.
    All,
}

impl CausesArgument {
    /// The causes of this name.
    pub fn causes(self) -> Causes {
        match self {
            CausesArgument::None => Causes::None,
            CausesArgument::All => Causes::All,
        }
    }
}

/// Arguments of `experiment detection`.
#[derive(Args)]
pub struct DetectionArgs {
    #[command(flatten)]
    runs: Runs,
    /// How many workers.
    #[arg(long, default_value_t = 1)]
    workers: usize,
    /// The arm.
    #[arg(long, value_enum, default_value = "giveway")]
    arm: ArmArgument,
}

impl Runs {
    fn hall(&self) -> anyhow::Result<Arc<Warehouse>> {
        anyhow::ensure!(self.runs > 0, "--runs must be at least 1");
        anyhow::ensure!((1.0..=1e6).contains(&self.seconds), "--seconds must be from 1 to 1000000");
        let hall = self.map.as_deref().map_or_else(|| Ok(Arc::new(thesis())), read_map)?;
        room_for(&hall, self.robots)
            .map_err(|e| anyhow::anyhow!("the map has no room for {} robots:\n{e}", self.robots))?;
        Ok(hall)
    }

    fn run(&self, cases: &[(TableSetup, HumanAwarePolicy)]) -> Vec<Vec<RunRow>> {
        run_all(cases, self.runs, self.seed, self.jobs)
    }
}

/// Runs all seeds of all cases, `jobs` at a time; gives the rows of each case, seed by seed.
pub fn run_all(
    cases: &[(TableSetup, HumanAwarePolicy)],
    runs: u64,
    seed: u64,
    jobs: Option<usize>,
) -> Vec<Vec<RunRow>> {
    let rows = in_parallel(cases.len() * runs as usize, jobs, |i| {
        let (setup, arm) = &cases[i / runs as usize];
        setup.run(*arm, seed + i as u64 % runs)
    });
    rows.chunks(runs as usize).map(<[RunRow]>::to_vec).collect()
}

/// Reports which laws were broken; gives how many.
pub fn violations<'a>(rows: impl Iterator<Item = &'a RunRow>) -> u64 {
    rows.map(|row| {
        row.broken.iter().for_each(|b| eprintln!("broken law at {b}"));
        row.law_violations
    })
    .sum()
}

/// The exit code for scripts: failure if a law was broken.
pub fn exit(violations: u64) -> ExitCode {
    if violations == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

impl TableArgs {
    /// Runs all and prints the table.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let warehouse = self.runs.hall()?;
        let mut arms: Vec<HumanAwarePolicy> = self.arms.iter().map(|a| a.arm()).collect();
        arms.sort_unstable();
        arms.dedup();
        let setup = |workers| TableSetup {
            warehouse: warehouse.clone(),
            robots: self.runs.robots,
            workers,
            seconds: self.runs.seconds,
            sensor: Sensor::default(),
            causes: self.causes.causes(),
            node_windows: NodeWindows::default(),
        };
        let cases: Vec<(TableSetup, HumanAwarePolicy)> =
            self.workers.iter().flat_map(|w| arms.iter().map(|a| (setup(*w), *a))).collect();
        let rows = self.runs.run(&cases);
        let broken = violations(rows.iter().flatten());
        let scenarios: Vec<Value> = (self.workers.iter().zip(rows.chunks(arms.len())))
            .map(|(workers, rows)| scenario(*workers, &arms, rows))
            .collect();
        let report = json!({"scenarios": scenarios, "law_violations": broken});
        if self.runs.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            for (workers, rows) in self.workers.iter().zip(rows.chunks(arms.len())) {
                print_table(*workers, &arms, rows, &self.runs);
            }
            println!("broken laws: {broken}");
        }
        Ok(exit(broken))
    }
}

/// Results for one number of workers: all arms, and their differences.
fn scenario(workers: usize, arms: &[HumanAwarePolicy], rows: &[Vec<RunRow>]) -> Value {
    let mut by_arm = Map::new();
    for (arm, rows) in arms.iter().zip(rows) {
        let mut columns =
            Map::from_iter(Column::ALL.map(|c| (c.word().to_owned(), summary(c.summary(rows)))));
        columns.insert("encounters".to_owned(), rings::of_runs(&met(rows)));
        by_arm.insert(arm.word().to_owned(), columns.into());
    }
    let mut paired = Map::new();
    for (ours, theirs) in PAIRS {
        let rows = |arm| arms.iter().position(|a| *a == arm).map(|i| &rows[i]);
        if let Some((a, b)) = rows(ours).zip(rows(theirs)) {
            let mut columns =
                Map::from_iter(Column::ALL.map(|c| (c.word().to_owned(), rings::interval(c.paired(a, b)))));
            columns.insert("encounters".to_owned(), rings::paired(&met(a), &met(b)));
            paired.insert(format!("{}-{}", ours.word(), theirs.word()), columns.into());
        }
    }
    json!({"workers": workers, "arms": by_arm, "paired": paired})
}

fn met(rows: &[RunRow]) -> Vec<&EncounterFigures> {
    rows.iter().map(|row| &row.met).collect()
}

fn summary(s: Summary) -> Value {
    json!({"mean": s.mean, "sd": s.sd})
}

fn print_table(workers: usize, arms: &[HumanAwarePolicy], rows: &[Vec<RunRow>], runs: &Runs) {
    let Runs { runs, robots, seconds, .. } = runs;
    println!("{workers} workers, {robots} robots, {runs} runs of {seconds} s: mean (standard deviation)");
    let heads: String = arms.iter().map(|a| format!("{:>18}", a.word())).collect();
    println!("{:30}{heads}", "");
    for column in Column::ALL {
        let cell = |rows: &Vec<RunRow>| {
            let Summary { mean, sd } = column.summary(rows);
            format!("{:>10.2} ({:>5.2})", mean.unwrap_or(0.0), sd.unwrap_or(0.0))
        };
        println!("{:30}{}", column.word(), rows.iter().map(cell).collect::<String>());
    }
    let curves: Vec<_> = arms.iter().zip(rows).map(|(arm, rows)| (arm.word(), met(rows))).collect();
    rings::print(&curves);
    println!("differences of pairs with one seed: mean [95 % interval]");
    for (ours, theirs) in PAIRS {
        let rows = |arm| arms.iter().position(|a| *a == arm).map(|i| &rows[i]);
        let Some((a, b)) = rows(ours).zip(rows(theirs)) else { continue };
        for column in [Column::TotalDeliveries, Column::EncountersPerWorkerMinute] {
            let Interval { mean, ci95 } = column.paired(a, b);
            let (low, high) = ci95.unwrap_or((f64::NAN, f64::NAN));
            let names = format!("{} - {}", ours.word(), theirs.word());
            println!("{names:20}{:30}{:8.2} [{low:.2}, {high:.2}]", column.word(), mean.unwrap_or(0.0));
        }
    }
    println!();
}

impl DetectionArgs {
    /// Runs all and prints the scores.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let warehouse = self.runs.hall()?;
        let tag = Sensor { source: Source::Tag, ..Sensor::default() };
        let sensors = [
            ("headset_clean", Sensor::default()),
            ("headset_faulty", Sensor::default().faulty()),
            ("tag_clean", tag),
            ("tag_faulty", tag.faulty()),
        ];
        let setup = |sensor| TableSetup {
            warehouse: warehouse.clone(),
            robots: self.runs.robots,
            workers: self.workers,
            seconds: self.runs.seconds,
            sensor,
            causes: Causes::All,
            node_windows: NodeWindows::default(),
        };
        let cases: Vec<(TableSetup, HumanAwarePolicy)> =
            sensors.iter().map(|(_, sensor)| (setup(*sensor), self.arm.arm())).collect();
        let rows = self.runs.run(&cases);
        let broken = violations(rows.iter().flatten());
        let mut report = Map::new();
        for ((name, _), rows) in sensors.iter().zip(&rows) {
            let mut all = Score::default();
            rows.iter().for_each(|r| all.merge(&r.score));
            report.insert((*name).to_owned(), score(&all));
        }
        let report = json!({
            "arm": self.arm.arm().word(),
            "workers": self.workers,
            "sensors": report,
            "law_violations": broken,
        });
        if self.runs.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            print_scores(&report);
        }
        Ok(exit(broken))
    }
}

fn score(s: &Score) -> Value {
    let at = |q: f64| s.delays_s.get((s.delays_s.len() as f64 * q) as usize);
    let share = |n: u64, of: u64| (of > 0).then(|| n as f64 / of as f64);
    let is_deviation =
        |word: &str| giveway_sim::WalkCause::ALL.iter().any(|c| c.word() == word && c.is_deviation());
    let (mut recall, mut false_alarms) = (Map::new(), Map::new());
    for (word, c) in &s.causes {
        if is_deviation(word) {
            let value = json!({"times": c.times, "noticed": c.noticed, "recall": share(c.noticed, c.times)});
            recall.insert((*word).to_owned(), value);
        } else {
            false_alarms.insert((*word).to_owned(), json!({"times": c.times, "false_alarms": c.noticed}));
        }
    }
    let goals: Vec<Value> = (TO_GOAL_S.iter().zip(&s.top1))
        .map(|(to, (looks, hits))| {
            let to = to.is_finite().then_some(*to);
            json!({"seconds_to_goal_below": to, "looks": looks, "top1": share(*hits, *looks)})
        })
        .collect();
    json!({
        "worker_hours": s.hours,
        "delay_s": {"mean": Summary::of(&s.delays_s).mean, "p50": at(0.5), "p95": at(0.95)},
        "alarms": s.alarms,
        "false_alarms_per_hour": (s.hours > 0.0).then(|| s.false_alarms as f64 / s.hours),
        "precision": s.precision(),
        "recall": recall,
        "false_alarms": false_alarms,
        "goal_top1": goals,
    })
}

fn print_scores(report: &Value) {
    let Some(sensors) = report["sensors"].as_object() else { return };
    for (name, s) in sensors {
        println!("{name}: {:.2} hours of workers", s["worker_hours"].as_f64().unwrap_or(0.0));
        for key in ["delay_s", "false_alarms_per_hour", "precision"] {
            println!("  {key:24} {}", s[key]);
        }
        for (cause, v) in s["recall"].as_object().into_iter().flatten() {
            println!("  recall of {cause:20} {} of {}", v["noticed"], v["times"]);
        }
        for (cause, v) in s["false_alarms"].as_object().into_iter().flatten() {
            println!("  false alarms in {cause:14} {} in {}", v["false_alarms"], v["times"]);
        }
        for class in s["goal_top1"].as_array().into_iter().flatten() {
            println!("  goal known below {:>6} s   {}", class["seconds_to_goal_below"], class["top1"]);
        }
    }
    println!("broken laws: {}", report["law_violations"]);
}

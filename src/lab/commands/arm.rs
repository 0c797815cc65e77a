//! `giveway experiment overlap` and `bolts`: the robot arm beside a picker in figures.
//!
//! Main types: [`OverlapArgs`], [`BoltsArgs`]. Refuses: to compute anything itself; it only measures how long
//! computations take.

use crate::arm::bolts::{BoltsArm, BoltsBench, BoltsRun};
use crate::arm::overlap::{Failure, OverlapCase, RiskKind, RoundEnd, Rounds, calibration_error, cases};
use crate::statistics::{Interval, Summary};
use clap::Args;
use serde_json::{Map, Value, json};
use std::process::ExitCode;
use std::time::Instant;

/// Thresholds to compare (Liu and Jebelli 2023, figure 10).
const DELTAS: [f64; 10] = [0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.08, 0.10, 0.15, 0.20];
/// The published threshold.
const DELTA: f64 = 0.05;
/// Number of timed decisions.
const TIMED: u64 = 200;

/// Arguments of `experiment overlap`.
#[derive(Args)]
pub struct OverlapArgs {
    /// Seed of people, postures and draws.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cases whose stated probability is compared with a sampled one.
    #[arg(long, default_value_t = 300)]
    cases: usize,
    /// Draws per case.
    #[arg(long, default_value_t = 100_000)]
    draws: usize,
    /// Rounds per threshold.
    #[arg(long, default_value_t = 120)]
    rounds: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Result for one threshold.
struct SweptDelta {
    success: f64,
    needless: f64,
    reached: f64,
    forecast: usize,
    lag: usize,
    link: usize,
}

impl OverlapArgs {
    /// Prints the table.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!((1..=100_000).contains(&self.cases), "--cases must be from 1 to 100000");
        anyhow::ensure!((1..=10_000_000).contains(&self.draws), "--draws must be from 1 to 10000000");
        anyhow::ensure!((1..=100_000).contains(&self.rounds), "--rounds must be from 1 to 100000");
        let cases = cases(self.seed, self.cases, self.draws);
        let bench = Rounds::new(self.seed);
        let play = |delta: f64, risk: RiskKind| -> SweptDelta {
            swept(&(0..self.rounds).map(|n| bench.play(n, delta, risk)).collect::<Vec<_>>())
        };
        let delta: Vec<(f64, SweptDelta)> = DELTAS.map(|d| (d, play(d, RiskKind::Giveway))).into();
        let others = [RiskKind::Printed, RiskKind::Normalised].map(|risk| (risk, play(DELTA, risk)));
        // No probability is above one: this run never avoids anything.
        let unaware = play(1.0, RiskKind::Giveway);
        let (forecast_ms, choice_ms) = timed(&bench);
        if self.json {
            let report = json!({
                "seed": self.seed, "cases": self.cases, "draws": self.draws, "rounds": self.rounds,
                "ece": by_kind(|k| calibration_error(&pairs(&cases, k))),
                "mean_absolute_error": by_kind(|k| absolute_error(&pairs(&cases, k))),
                "delta": delta.iter().map(|(d, s)| (d.to_string(), value(s))).collect::<Map<_, _>>(),
                "at_0.05": others.iter().map(|(k, s)| (k.word().into(), value(s))).collect::<Map<_, _>>(),
                "unaware": value(&unaware),
                "forecast_ms": round(forecast_ms), "choice_ms": round(choice_ms),
            });
            println!("{}", serde_json::to_string_pretty(&report)?);
            return Ok(ExitCode::SUCCESS);
        }
        println!("giveway experiment overlap --seed {} --rounds {}", self.seed, self.rounds);
        println!("\nstated against sampled overlap, {} cases of {} draws", self.cases, self.draws);
        for (k, kind) in RiskKind::ALL.into_iter().enumerate() {
            let pairs = pairs(&cases, k);
            let (ece, off) = (calibration_error(&pairs), absolute_error(&pairs));
            println!("  {:<11} calibration error {ece:.4}, mean absolute error {off:.4}", kind.word());
        }
        println!("\n  delta  success  needless  reached  failures: forecast, lag, link");
        delta.iter().for_each(|(d, s)| print_row(&format!("{d}"), s));
        others.iter().for_each(|(kind, s)| print_row(kind.word(), s));
        print_row("unaware", &unaware);
        println!("\nforecast {forecast_ms:.3} ms, choice {choice_ms:.3} ms");
        Ok(ExitCode::SUCCESS)
    }
}

fn by_kind(figure: impl Fn(usize) -> f64) -> Map<String, Value> {
    let kinds = RiskKind::ALL.into_iter().enumerate();
    kinds.map(|(k, kind)| (kind.word().to_owned(), json!(round(figure(k))))).collect()
}

fn pairs(cases: &[OverlapCase], kind: usize) -> Vec<(f64, f64)> {
    cases.iter().map(|c| (c.stated[kind], c.sampled)).collect()
}

fn absolute_error(pairs: &[(f64, f64)]) -> f64 {
    pairs.iter().map(|(stated, sampled)| (stated - sampled).abs()).sum::<f64>() / pairs.len().max(1) as f64
}

fn swept(ends: &[RoundEnd]) -> SweptDelta {
    let failed = |why: Failure| ends.iter().filter(|e| e.failure == Some(why)).count();
    let share = |n: usize, of: usize| n as f64 / of.max(1) as f64;
    let sum = |f: fn(&RoundEnd) -> usize| ends.iter().map(f).sum::<usize>();
    SweptDelta {
        success: share(sum(|e| usize::from(e.failure.is_none())), ends.len()),
        needless: share(sum(|e| e.needless), sum(|e| e.decisions)),
        reached: share(sum(|e| usize::from(e.reached)), ends.len()),
        forecast: failed(Failure::Forecast),
        lag: failed(Failure::Lag),
        link: failed(Failure::Link),
    }
}

fn value(s: &SweptDelta) -> Value {
    json!({
        "success": round(s.success), "needless": round(s.needless), "reached": round(s.reached),
        "failures": {"forecast": s.forecast, "lag": s.lag, "link": s.link},
    })
}

fn print_row(name: &str, s: &SweptDelta) {
    print!("{name:>10}{:8.3}{:10.3}{:9.3}", s.success, s.needless, s.reached);
    println!("{:11}{:5}{:6}", s.forecast, s.lag, s.link);
}

/// Mean milliseconds of a forecast and of a choice.
fn timed(bench: &Rounds) -> (f64, f64) {
    let (mut forecast_ms, mut choice_ms) = (0.0, 0.0);
    for n in 0..TIMED {
        let moment = bench.moment(n);
        let start = Instant::now();
        let forecast = bench.forecast(&moment);
        forecast_ms += start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        let chosen = bench.choose(&moment, &forecast, DELTA, RiskKind::Giveway);
        choice_ms += start.elapsed().as_secs_f64() * 1e3;
        debug_assert!(!chosen.1.is_empty());
    }
    (forecast_ms / TIMED as f64, choice_ms / TIMED as f64)
}

fn round(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

/// Arguments of `experiment bolts`.
#[derive(Args)]
pub struct BoltsArgs {
    /// People at the bench; each meets every arm.
    #[arg(long, default_value_t = 30)]
    runs: u64,
    /// Seed of people and movements.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Shares of a movement after which its target is recognised, percent.
const PERCENTS: [u32; 5] = [20, 30, 40, 50, 60];
/// Number of new people whose targets are recognised.
const ASKED: u64 = 10;

/// A figure's name, and the figure of a run.
type Figure = (&'static str, fn(&BoltsRun) -> f64);

/// Figures with printed means and differences.
const FIGURES: [Figure; 7] = [
    ("min_distance_cm", |r| r.min_distance_cm),
    ("min_capsule_cm", |r| r.min_capsule_cm),
    ("length_cm", |r| r.length_cm),
    ("time_s", |r| r.time_s),
    ("products_per_hour", |r| r.products_per_hour),
    ("person_waits_s", |r| r.person_waits_s),
    ("stops", |r| r.stops as f64),
];

/// Pairs of arms to compare.
const PAIRS: [(usize, usize); 3] = [(2, 1), (2, 0), (1, 0)];

impl BoltsArgs {
    /// Prints the table.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!((2..=10_000).contains(&self.runs), "--runs must be from 2 to 10000");
        let bench = BoltsBench::new(self.seed);
        let run = |how: BoltsArm| -> Vec<BoltsRun> { (0..self.runs).map(|n| bench.run(n, how)).collect() };
        let runs: Vec<Vec<BoltsRun>> = BoltsArm::ALL.map(run).into();
        let accuracy = bench.accuracy(&PERCENTS.map(|p| f64::from(p) / 100.0), ASKED);
        let agreement = bench.table_2_agreement(DELTA);
        if self.json {
            let share = |of: fn(&(f64, f64)) -> f64| -> Map<String, Value> {
                let shares = PERCENTS.iter().zip(&accuracy);
                shares.map(|(p, both)| (p.to_string(), json!(round(of(both))))).collect()
            };
            let report = json!({
                "seed": self.seed, "runs": self.runs,
                "arms": BoltsArm::ALL.iter().zip(&runs).map(|(how, runs)| {
                    (how.word().to_owned(), arm_value(runs))
                }).collect::<Map<_, _>>(),
                "paired": PAIRS.iter().map(|(a, b)| (pair_name(*a, *b), paired(&runs[*a], &runs[*b])))
                    .collect::<Map<_, _>>(),
                "accuracy": {"observed": share(|both| both.0), "ahead": share(|both| both.1)},
                "table_2_agreement": round(agreement),
            });
            println!("{}", serde_json::to_string_pretty(&report)?);
            return Ok(ExitCode::SUCCESS);
        }
        println!("giveway experiment bolts --runs {} --seed {}\n", self.runs, self.seed);
        print_bolts(&runs);
        println!("\ntarget known after     observed  with what is ahead");
        for (percent, (observed, ahead)) in PERCENTS.iter().zip(&accuracy) {
            println!("{percent:>5} % of the time{observed:13.3}{ahead:10.3}");
        }
        println!("\nTable II as derived agrees with the printed one in {agreement:.3} of its cells");
        Ok(ExitCode::SUCCESS)
    }
}

fn pair_name(a: usize, b: usize) -> String {
    format!("{}-{}", BoltsArm::ALL[a].word(), BoltsArm::ALL[b].word())
}

fn sample(runs: &[BoltsRun], figure: fn(&BoltsRun) -> f64) -> Vec<f64> {
    runs.iter().map(figure).collect()
}

fn arm_value(runs: &[BoltsRun]) -> Value {
    let figure = |(name, figure): &Figure| {
        let summary = Summary::of(&sample(runs, *figure));
        (name.to_string(), json!({"mean": summary.mean.map(round), "sd": summary.sd.map(round)}))
    };
    let mut value: Map<String, Value> = FIGURES.iter().map(figure).collect();
    let sum = |of: fn(&BoltsRun) -> usize| runs.iter().map(of).sum::<usize>();
    value.insert("contacts".into(), json!(sum(|r| r.contacts)));
    value.insert("touched_standing".into(), json!(sum(|r| r.touched)));
    value.insert("unsolved".into(), json!(sum(|r| r.unsolved)));
    Value::Object(value)
}

fn paired(ours: &[BoltsRun], theirs: &[BoltsRun]) -> Value {
    let difference = |(name, figure): &Figure| {
        let interval = Interval::of_pairs(&sample(ours, *figure), &sample(theirs, *figure));
        let ci95 = interval.ci95.map(|(low, high)| [round(low), round(high)]);
        (name.to_string(), json!({"mean": interval.mean.map(round), "ci95": ci95}))
    };
    Value::Object(FIGURES.iter().map(difference).collect())
}

fn print_bolts(runs: &[Vec<BoltsRun>]) {
    println!(
        "{:<18}{:>18}{:>18}{:>18}   predictive-reactive",
        "mean (sd)", "turns", "reactive", "predictive"
    );
    for (name, figure) in FIGURES {
        print!("{name:<18}");
        for runs in runs {
            let Summary { mean, sd } = Summary::of(&sample(runs, figure));
            let cell = format!("{:.2} ({:.2})", mean.unwrap_or(f64::NAN), sd.unwrap_or(f64::NAN));
            print!("{cell:>18}");
        }
        let interval = Interval::of_pairs(&sample(&runs[2], figure), &sample(&runs[1], figure));
        let (low, high) = interval.ci95.unwrap_or((f64::NAN, f64::NAN));
        println!("   {:.2} ({low:.2} to {high:.2})", interval.mean.unwrap_or(f64::NAN));
    }
    let sums = |of: fn(&BoltsRun) -> usize| -> Vec<usize> {
        runs.iter().map(|runs| runs.iter().map(of).sum()).collect()
    };
    println!("contacts {:?}, touched while it stood {:?}", sums(|r| r.contacts), sums(|r| r.touched));
}

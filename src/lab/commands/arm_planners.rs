//! `giveway experiment planners`: planners of an arm's ways, dropout as spread, and smoothness.
//!
//! Main type: [`PlannersArgs`]. Refuses: to compute anything itself; it provides the clock for timing planners.

use crate::arm::dropout::{self, DropoutFigures};
use crate::arm::moving::{self, Sight, Smoothness};
use crate::arm::planners::{PlannerKind, QueryAnswer, Workshops};
use crate::statistics::Summary;
use clap::Args;
use serde_json::{Map, Value, json};
use std::process::ExitCode;
use std::time::Instant;

/// Arguments of `experiment planners`.
#[derive(Args)]
pub struct PlannersArgs {
    /// Workspaces.
    #[arg(long, default_value_t = 12)]
    workspaces: usize,
    /// Queries in each of them.
    #[arg(long, default_value_t = 800)]
    queries: u64,
    /// Seed of obstacles, queries and learning.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Motions per case of smoothness.
    #[arg(long, default_value_t = 30)]
    motions: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Results of one planner.
struct PlannerFigures {
    length_m: Summary,
    mean_ms: f64,
    p95_ms: f64,
    success: f64,
    ci95: (f64, f64),
}

impl PlannersArgs {
    /// Prints the tables.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!((1..=100).contains(&self.workspaces), "--workspaces must be from 1 to 100");
        anyhow::ensure!((1..=100_000).contains(&self.queries), "--queries must be from 1 to 100000");
        let workshops = Workshops::new(self.seed, self.workspaces);
        let workshops = workshops.ok_or_else(|| anyhow::anyhow!("the oracle found no ways to learn from"))?;
        let start = Instant::now();
        let mut clock = || start.elapsed().as_secs_f64() * 1e3;
        let all = (0..self.workspaces).flat_map(|k| (0..self.queries).map(move |n| (k, n)));
        let answers: Vec<Vec<QueryAnswer>> = all.map(|(k, n)| workshops.ask(k, n, &mut clock)).collect();
        let figures: Vec<PlannerFigures> =
            (0..PlannerKind::ALL.len()).map(|kind| figures(&answers, kind)).collect();
        let dropout = dropout::figures(self.seed, &SAMPLES);
        let smoothness = moving::cases(self.seed, workshops.net(), self.motions);
        let unchecked = answers.iter().flatten().filter(|answer| answer.is_wrong).count();
        if self.json {
            let planners = PlannerKind::ALL.iter().zip(&figures);
            let report = json!({
                "seed": self.seed, "workspaces": self.workspaces, "queries": self.queries,
                "planners": planners.map(|(kind, f)| (kind.word().to_owned(), planner_value(f)))
                    .collect::<Map<_, _>>(),
                "unchecked_paths": unchecked,
                "dropout": SAMPLES.iter().zip(&dropout).map(|(k, d)| (k.to_string(), dropout_value(d)))
                    .collect::<Map<_, _>>(),
                "smoothness": Sight::ALL.iter().zip(&smoothness)
                    .map(|(sight, s)| (sight.word().to_owned(), smooth_value(s))).collect::<Map<_, _>>(),
                "net_step_error_rad2": round(workshops.net_error),
            });
            println!("{}", serde_json::to_string_pretty(&report)?);
            return Ok(ExitCode::SUCCESS);
        }
        println!(
            "giveway experiment planners --workspaces {} --queries {} --seed {}\n",
            self.workspaces, self.queries, self.seed
        );
        println!("planner          success (95 % interval)   length m (sd)    time ms    95 % below");
        for (kind, f) in PlannerKind::ALL.iter().zip(&figures) {
            print!("{:<16}{:8.4} ({:.4} to {:.4})", kind.word(), f.success, f.ci95.0, f.ci95.1);
            let (mean, sd) = (f.length_m.mean.unwrap_or(f64::NAN), f.length_m.sd.unwrap_or(f64::NAN));
            println!("{mean:10.3} ({sd:.3}){:11.2}{:14.2}", f.mean_ms, f.p95_ms);
        }
        println!("ways that do not stand a second, finer check: {unchecked}");
        println!("\nsamples   sd mm   error mm   correlation   within 95 %   scaled");
        for (k, d) in SAMPLES.iter().zip(&dropout) {
            print!("{k:>7}{:8.1}{:11.1}{:14.3}", d.sd_mm, d.error_mm, d.correlation);
            println!("{:14.3}{:9.3} (by {:.2})", d.cov95, d.cov95_scaled, d.scale);
        }
        println!("\nplanned with   acceleration rad/s2   jerk rad/s3   met the person   time s   new ways");
        for (sight, s) in Sight::ALL.iter().zip(&smoothness) {
            print!("{:<15}{:19.4}{:14.4}", sight.word(), s.acceleration, s.jerk);
            println!("{:17.3}{:9.2}{:11.2}", s.met, s.time_s, s.replans);
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn figures(answers: &[Vec<QueryAnswer>], kind: usize) -> PlannerFigures {
    let lengths: Vec<f64> = answers.iter().filter_map(|a| a[kind].length_m).collect();
    let mut times: Vec<f64> = answers.iter().map(|a| a[kind].took_ms).collect();
    times.sort_by(f64::total_cmp);
    let count = answers.len().max(1) as f64;
    let success = lengths.len() as f64 / count;
    // Wilson's interval of a share.
    const Z: f64 = 1.96;
    let middle = (success + Z * Z / (2.0 * count)) / (1.0 + Z * Z / count);
    let half = Z / (1.0 + Z * Z / count)
        * (success * (1.0 - success) / count + Z * Z / (4.0 * count * count)).sqrt();
    PlannerFigures {
        length_m: Summary::of(&lengths),
        mean_ms: times.iter().sum::<f64>() / count,
        p95_ms: times.get(times.len() * 95 / 100).copied().unwrap_or(f64::NAN),
        success,
        ci95: (middle - half, (middle + half).min(1.0)),
    }
}

/// Samples per forecast (table II).
const SAMPLES: [usize; 3] = [5, 10, 20];

fn dropout_value(d: &DropoutFigures) -> Value {
    json!({
        "sd_mm": round(d.sd_mm), "error_mm": round(d.error_mm), "correlation": round(d.correlation),
        "cov95": round(d.cov95), "cov95_scaled": round(d.cov95_scaled), "scale": round(d.scale),
    })
}

fn smooth_value(s: &Smoothness) -> Value {
    json!({
        "acc": round(s.acceleration), "jerk": round(s.jerk), "met": round(s.met), "time_s": round(s.time_s),
        "replans": round(s.replans),
    })
}

fn planner_value(f: &PlannerFigures) -> Value {
    json!({
        "length_m": {"mean": f.length_m.mean.map(round), "sd": f.length_m.sd.map(round)},
        "time_ms": {"mean": round(f.mean_ms), "p95": round(f.p95_ms)},
        "success": round(f.success), "ci95": [round(f.ci95.0), round(f.ci95.1)],
    })
}

fn round(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

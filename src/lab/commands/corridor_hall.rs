//! `giveway experiment corridor --hall`: a hall of robots that leave the line to pass people, against the same robots
//! on lines.
//!
//! Main function: [`run`]. Refuses: to compute anything itself.

use crate::corridor::{HallArm, HallReport, HallRun, HallSetup, halls};
use crate::statistics::{Interval, Summary};
use serde_json::{Map, Value, json};
use std::process::ExitCode;

/// Pairs of arms to compare.
const PAIRS: [(HallArm, HallArm); 4] = [
    (HallArm::Free, HallArm::Traditional),
    (HallArm::Free, HallArm::Lines),
    (HallArm::Free, HallArm::NoCorridors),
    (HallArm::Lines, HallArm::NoCorridors),
];

/// A figure of a run with its key in the report.
type HallFigure = (&'static str, fn(&HallRun) -> f64);
/// Figures of the report.
const FIGURES: [HallFigure; 7] = [
    ("deliveries_per_hour", |r| r.deliveries_per_hour),
    ("wait_s", |r| r.wait_s),
    ("encounters_per_hour", |r| r.encounters),
    ("own_stops_per_hour", |r| r.own_stops),
    ("closest_m", |r| r.closest_m.unwrap_or(3.0)),
    ("assignments_per_hour", |r| r.assignments_per_hour),
    ("passes", |r| r.passes as f64),
];

/// Runs all arms and prints the results. A broken law is a failure, except in the traditional window's runs, where it
/// is a finding: that arm is only there for comparison.
pub fn run(setup: HallSetup, seed: u64, runs: u64, as_json: bool) -> anyhow::Result<ExitCode> {
    let report = halls(setup, seed, runs, || {});
    let violations = violations(&report);
    if as_json {
        println!("{}", serde_json::to_string_pretty(&all(&report, setup, (seed, runs)))?);
    } else {
        print(&report, setup, (seed, runs));
    }
    Ok(if violations == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Number of broken laws in the runs of all arms except the traditional window's.
fn violations(report: &HallReport) -> u64 {
    let arms = HallArm::ALL.into_iter().filter(|arm| *arm != HallArm::Traditional);
    arms.map(|arm| report.law_violations(arm)).sum()
}

fn all(report: &HallReport, setup: HallSetup, (seed, runs): (u64, u64)) -> Value {
    let arms = HallArm::ALL.map(|arm| {
        let mut of: Map<_, _> =
            FIGURES.map(|(key, f)| (key.to_owned(), summary(report.summary(arm, f)))).into_iter().collect();
        of.insert("law_violations".to_owned(), report.law_violations(arm).into());
        (arm.name().to_owned(), Value::Object(of))
    });
    let paired = PAIRS.map(|(ours, theirs)| {
        let of = FIGURES.map(|(key, f)| (key.to_owned(), interval(report.paired(ours, theirs, f))));
        (format!("{}-{}", ours.name(), theirs.name()), Value::Object(of.into_iter().collect()))
    });
    let broken = report.runs.iter().flat_map(|(_, runs)| runs).flat_map(|r| r.broken.iter().take(3));
    json!({
        "arms": arms.into_iter().collect::<Map<_, _>>(),
        "paired": paired.into_iter().collect::<Map<_, _>>(),
        "robots": setup.robots, "workers": setup.workers, "seconds": setup.seconds,
        "runs": runs, "seed": seed,
        "law_violations": violations(report), "broken": broken.collect::<Vec<_>>(),
    })
}

fn summary(s: Summary) -> Value {
    json!({"mean": s.mean.map(round), "sd": s.sd.map(round)})
}

fn interval(i: Interval) -> Value {
    json!({"mean": i.mean.map(round), "ci95": i.ci95.map(|(low, high)| [round(low), round(high)])})
}

fn round(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0
}

fn print(report: &HallReport, setup: HallSetup, (seed, runs): (u64, u64)) {
    let HallSetup { robots, workers, seconds } = setup;
    println!(
        "giveway experiment corridor --hall --runs {runs} --seed {seed} --robots {robots} --workers {workers} \
         --seconds {seconds}\n"
    );
    for (key, f) in FIGURES {
        println!("{key}");
        for arm in HallArm::ALL {
            let s = report.summary(arm, f);
            let (mean, sd) = (s.mean.unwrap_or(f64::NAN), s.sd.unwrap_or(f64::NAN));
            println!("  {:<34}{mean:10.2} (sd {sd:.2})", arm.name());
        }
        for (ours, theirs) in PAIRS {
            let i = report.paired(ours, theirs, f);
            let (mean, (low, high)) = (i.mean.unwrap_or(f64::NAN), i.ci95.unwrap_or((f64::NAN, f64::NAN)));
            let pair = format!("{} − {}", ours.name(), theirs.name());
            println!("  {pair:<34}{mean:+10.2} ({low:+.2} to {high:+.2})");
        }
    }
    println!("\nlaw violations");
    for arm in HallArm::ALL {
        println!("  {:<34}{:10}", arm.name(), report.law_violations(arm));
    }
    for broken in report.runs.iter().flat_map(|(_, runs)| runs).flat_map(|r| r.broken.iter().take(3)) {
        println!("  {broken}");
    }
}

//! `giveway bench steps`: what one step of the fleet costs, on this machine.
//!
//! Main type: [`StepsArgs`]. Refuses: to print a figure without the command that made it.

use super::{progress, read_map, stopwatch};
use crate::steps::{StepSetup, StepsCase, run};
use clap::Args;
use giveway::cli::sim::quantiles;
use giveway_floor::warehouse::{room_for, with_cells};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Steps until racks stand at stations: five minutes.
const SETTLED: usize = 6_000;

/// Arguments of `bench steps`.
#[derive(Args)]
pub struct StepsArgs {
    /// Map.
    #[arg(long, default_value = "maps/kiva.json")]
    map: PathBuf,
    /// How many robots.
    #[arg(long, default_value_t = 800)]
    robots: usize,
    /// How many robots work where jobs could start at once.
    #[arg(long, default_value_t = 50)]
    busy: usize,
    /// How many closures are announced.
    #[arg(long, default_value_t = 1_000)]
    closures: usize,
    /// How many jobs wait.
    #[arg(long, default_value_t = 100_000)]
    jobs: usize,
    /// How many stations have a robot arm where all of them are work cells.
    #[arg(long, default_value_t = 8)]
    arms: usize,
    /// How many assignments are open.
    #[arg(long, default_value_t = 10_000)]
    assignments: usize,
    /// Steps before any is measured.
    #[arg(long, default_value_t = 400)]
    settle: usize,
    /// Steps that are measured in each case.
    #[arg(long, default_value_t = 1_000)]
    steps: usize,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl StepsArgs {
    /// Measures every case and prints a row for each.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let warehouse = Arc::new(read_map(&self.map)?);
        let most = self.robots.max(self.busy);
        room_for(&warehouse, most).map_err(|e| anyhow::anyhow!("{}:\n{e}", self.map.display()))?;
        anyhow::ensure!(self.robots > 0 && self.busy > 0, "--robots and --busy must be at least 1");
        anyhow::ensure!(self.steps > 0 && self.settle > 0, "--steps and --settle must be at least 1");
        let cases = self.cases();
        let bar = progress(cases.len() as u64, "cases");
        let mut rows = Vec::new();
        let furnished = Arc::new(with_cells(&warehouse, self.arms));
        for (name, robots, case) in cases {
            // Racks must already stand at stations.
            let has_cells = matches!(case, StepsCase::Lines(_) | StepsCase::Staffed(_));
            let settle = if has_cells { self.settle.max(SETTLED) } else { self.settle };
            let setup = StepSetup { robots, settle, steps: self.steps };
            let out = run(if has_cells { &furnished } else { &warehouse }, case, &setup, stopwatch);
            let mean_us = out.step_ns.iter().sum::<u64>() as f64 / out.step_ns.len() as f64 / 1000.0;
            rows.push(json!({
                "case": name, "robots": robots, "open": out.open, "mean_us": mean_us,
                "step_us": quantiles(&out.step_ns), "waits_us": quantiles(&out.waits_ns),
            }));
            bar.inc(1);
        }
        bar.finish_and_clear();
        self.print(&rows)?;
        Ok(ExitCode::SUCCESS)
    }

    /// The cases: each crowded floor next to the same floor with little on it.
    fn cases(&self) -> Vec<(&'static str, usize, StepsCase)> {
        let (all, busy) = (self.robots, self.busy);
        vec![
            ("idle", all, StepsCase::Idle),
            ("closures", all, StepsCase::Closures(self.closures)),
            ("waiting after another job", all, StepsCase::WaitingAfter(self.jobs)),
            ("waiting for one rack", all, StepsCase::WaitingRack(self.jobs)),
            ("all at work", all, StepsCase::Waiting(all * 4)),
            ("work cells, not staffed", all, StepsCase::Lines(all * 4)),
            ("work cells, staffed", all, StepsCase::Staffed(all * 4)),
            ("busy, few jobs wait", busy, StepsCase::Waiting(busy * 4)),
            ("busy, many jobs wait", busy, StepsCase::Waiting(self.jobs)),
            ("few assignments", busy, StepsCase::Assignments(10)),
            ("many assignments", busy, StepsCase::Assignments(self.assignments)),
        ]
    }

    fn print(&self, rows: &[Value]) -> anyhow::Result<()> {
        let command = format!(
            "giveway bench steps --map {} --robots {} --busy {} --closures {} --jobs {} --arms {} --assignments {} \
             --settle {} --steps {}",
            self.map.display(),
            self.robots,
            self.busy,
            self.closures,
            self.jobs,
            self.arms,
            self.assignments,
            self.settle,
            self.steps
        );
        if self.json {
            let report = json!({"command": command, "cases": rows});
            println!("{}", serde_json::to_string_pretty(&report)?);
            return Ok(());
        }
        println!("{command}");
        println!(
            "{:28} {:>6} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
            "microseconds a step", "robots", "open", "mean", "p50", "p99", "max", "waits p50", "p99"
        );
        for row in rows {
            let name = row["case"].as_str().unwrap_or_default();
            let figure = |of: &str, key: &str| row[of][key].as_f64().unwrap_or_default();
            println!(
                "{name:28} {:>6} {:>8} {:>9.1} {:>9.1} {:>9.1} {:>9.1} {:>9.1} {:>9.1}",
                row["robots"].to_string(),
                row["open"].to_string(),
                row["mean_us"].as_f64().unwrap_or_default(),
                figure("step_us", "p50"),
                figure("step_us", "p99"),
                figure("step_us", "max"),
                figure("waits_us", "p50"),
                figure("waits_us", "p99")
            );
        }
        Ok(())
    }
}

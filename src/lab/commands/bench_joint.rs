//! `giveway bench joint`: what it costs to plan one robot together with the few in its way, on this machine.
//!
//! Main type: [`JointArgs`]. Refuses: to print a figure without the command that made it.

use super::{progress, read_map, stopwatch};
use crate::joint::{JointSetup, run};
use clap::Args;
use giveway::cli::sim::quantiles;
use giveway_floor::warehouse::room_for;
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Arguments of `bench joint`.
#[derive(Args)]
pub struct JointArgs {
    /// Map.
    #[arg(long, default_value = "maps/kiva.json")]
    map: PathBuf,
    /// How many robots are at work.
    #[arg(long, default_value_t = 300)]
    robots: usize,
    /// Steps before anything is measured.
    #[arg(long, default_value_t = 2_400)]
    settle: usize,
    /// How many plans are measured.
    #[arg(long, default_value_t = 600)]
    plans: usize,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl JointArgs {
    /// Measures and prints.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let warehouse = Arc::new(read_map(&self.map)?);
        room_for(&warehouse, self.robots).map_err(|e| anyhow::anyhow!("{}:\n{e}", self.map.display()))?;
        let JointArgs { robots, settle, plans, .. } = self;
        anyhow::ensure!(robots > 0 && plans > 0, "--robots and --plans must be at least 1");
        let command = format!(
            "giveway bench joint --map {} --robots {robots} --settle {settle} --plans {plans}",
            self.map.display()
        );
        let bar = progress(plans as u64, "plans");
        let step = |plan| bar.set_position(plan as u64);
        let out = run(&warehouse, &JointSetup { robots, settle, plans }, stopwatch, step);
        bar.finish_and_clear();
        let figures = |ns: &[u64]| {
            let mean_us = ns.iter().sum::<u64>() as f64 / ns.len().max(1) as f64 / 1000.0;
            json!({"mean_us": mean_us, "us": quantiles(ns)})
        };
        let (found, failed) = (figures(&out.found_ns), figures(&out.failed_ns));
        if self.json {
            let report = json!({"command": command, "found": found, "failed": failed});
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            println!("{command}\n  found  {found}\n  failed {failed}");
        }
        Ok(ExitCode::SUCCESS)
    }
}

//! `giveway bench`: planning measured on this machine.
//!
//! Main type: [`Bench`]. Refuses: to print a figure without the command that made it.

use super::{progress, read};
use crate::experiment::grid::Grid;
use crate::experiment::lifelong::{self, Setup};
use clap::{Args, Subcommand, ValueEnum};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// What to measure.
#[derive(Subcommand)]
pub enum Bench {
    /// Goals reached per step on a benchmark floor, by the product's own search.
    Lifelong(Lifelong),
}

/// Pebble rules, with or without turns.
#[derive(Clone, Copy, ValueEnum)]
enum RulesArgument {
    /// Robots step to any of four neighbours.
    Pebble,
    /// A quarter turn takes a step, too.
    Turns,
}

/// Arguments of `bench lifelong`.
#[derive(Args)]
pub struct Lifelong {
    /// Floor: octile `.map` or kiva format.
    #[arg(long)]
    map: PathBuf,
    /// Start cells, one per robot.
    #[arg(long)]
    agents: PathBuf,
    /// Goals; robot i of k takes entries i, i + k, i + 2k, …
    #[arg(long)]
    tasks: PathBuf,
    /// How many steps.
    #[arg(long, default_value_t = 1000)]
    steps: usize,
    /// What a step is.
    #[arg(long, value_enum, default_value = "pebble")]
    rules: RulesArgument,
    /// Plan all robots again every so many steps; 0 for never.
    #[arg(long, default_value_t = 5)]
    improve_every: usize,
    /// Labels that one search may expand.
    #[arg(long, default_value_t = 20_000)]
    budget: u32,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Bench {
    /// Runs the measurement.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self {
            Bench::Lifelong(arguments) => arguments.run(),
        }
    }
}

impl Lifelong {
    fn run(self) -> anyhow::Result<ExitCode> {
        let named = |path: &PathBuf, e: String| anyhow::anyhow!("{}: {e}", path.display());
        let grid = Grid::parse(&read(&self.map)?).map_err(|e| named(&self.map, e))?;
        let cells = |path: &PathBuf| lifelong::parse_cells(&grid, &read(path)?).map_err(|e| named(path, e));
        let setup = Setup {
            starts: cells(&self.agents)?,
            tasks: cells(&self.tasks)?,
            steps: self.steps,
            turns: matches!(self.rules, RulesArgument::Turns),
            improve_every: self.improve_every,
            budget: self.budget,
        };
        let bar = progress(self.steps as u64, "steps");
        let start = Instant::now();
        let out = lifelong::run(&grid, &setup, |step| bar.set_position(step as u64));
        let wall = start.elapsed().as_secs_f64();
        bar.finish_and_clear();
        let report = json!({
            "robots": setup.starts.len(), "steps": self.steps, "tasks": out.tasks,
            "tasks_per_step": out.tasks_per_step, "vertex_conflicts": out.vertex_conflicts, "swaps": out.swaps,
            "jumps": out.jumps, "plans": out.plans, "failed_plans": out.failures,
            "expansions_per_plan": out.expansions as f64 / out.plans.max(1) as f64, "wall_seconds": wall,
        });
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            println!(
                "{:.3} tasks per step with {} robots over {} steps",
                out.tasks_per_step,
                setup.starts.len(),
                self.steps
            );
            println!("{} plans, {} failed, {wall:.1} s", out.plans, out.failures);
        }
        let clean = out.vertex_conflicts + out.swaps + out.jumps == 0;
        Ok(if clean { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

//! `giveway bench`: planning and steps measured on this machine.
//!
//! Main type: [`Bench`]. Refuses: to print a figure without the command that made it.

use super::{progress, read, read_map, stopwatch};
use crate::grid::Grid;
use crate::lifelong::{self, LifelongSetup};
use crate::{distances, planning};
use clap::{Args, Subcommand, ValueEnum};
use giveway::cli::sim::quantiles;
use giveway_fleet::Settings;
use giveway_floor::warehouse::{room_for, thesis};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// What to measure.
#[derive(Subcommand)]
pub enum Bench {
    /// Goals reached per step on a benchmark floor, by the product's own search.
    Lifelong(LifelongArgs),
    /// How long one route takes to plan while all other robots hold theirs.
    Plan(PlanArgs),
    /// How long distances to goals take to repair when one edge is cut or restored.
    Distances(DistancesArgs),
    /// What one step of the fleet costs if much exists and little changes.
    Steps(super::bench_steps::StepsArgs),
    /// How long it takes to plan one robot together with the few in its way.
    Joint(super::bench_joint::JointArgs),
    /// Whether memory stays flat while days go by.
    Memory(super::bench_memory::MemoryArgs),
    /// What one sample of a hand costs, and a forecast of the arm.
    Picks(super::bench_picks::BenchPicksArgs),
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
pub struct LifelongArgs {
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
    /// Plan all robots again every this many steps; 0 for never.
    #[arg(long, default_value_t = 5)]
    improve_every: usize,
    /// Labels that one search may expand.
    #[arg(long, default_value_t = 20_000)]
    budget: u32,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `bench plan`.
#[derive(Args)]
pub struct PlanArgs {
    /// Map.
    #[arg(long)]
    map: PathBuf,
    /// How many robots hold routes.
    #[arg(long, default_value_t = 800)]
    robots: usize,
    /// How many single routes to plan.
    #[arg(long, default_value_t = 4000)]
    queries: usize,
    /// Labels that one search may expand.
    #[arg(long)]
    budget: Option<u32>,
    /// Seed of the errands.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Plan every route once more with the way ahead weighted, f = g + w·h with w = 1 + K·(1 − g/(g + h)), and compare.
    #[arg(long, default_value_t = 0.0, value_name = "K")]
    weight: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `bench distances`.
#[derive(Args)]
pub struct DistancesArgs {
    /// How many edges to cut and to restore, one after the other.
    #[arg(long, default_value_t = 2000)]
    changes: usize,
    /// Seed of the choice of edges.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl DistancesArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!(self.changes > 0, "--changes must be at least 1");
        let map = thesis();
        let setups = [
            distances::DistanceSetup::of_map(&map, false),
            distances::DistanceSetup::of_map(&map, true),
            distances::DistanceSetup::grid(100),
        ];
        let command = format!("giveway bench distances --changes {} --seed {}", self.changes, self.seed);
        let mut rows = Vec::new();
        for setup in &setups {
            let out = distances::run(setup, self.changes, self.seed, stopwatch);
            rows.push(json!({
                "graph": setup.name, "nodes": out.nodes, "edges": out.edges, "goals": out.goals,
                "repair_us": quantiles(&out.repair_ns), "anew_us": quantiles(&out.anew_ns),
            }));
        }
        if self.json {
            println!("{}", serde_json::to_string_pretty(&json!({"command": command, "graphs": rows}))?);
        } else {
            println!("{command}");
            for row in &rows {
                println!(
                    "{}: {} nodes, {} edges, {} goals",
                    row["graph"], row["nodes"], row["edges"], row["goals"]
                );
                println!("  repaired, microseconds {}", row["repair_us"]);
                println!("  anew, microseconds     {}", row["anew_us"]);
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}

impl PlanArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let warehouse = read_map(&self.map)?;
        room_for(&warehouse, self.robots).map_err(|e| anyhow::anyhow!("{}:\n{e}", self.map.display()))?;
        anyhow::ensure!(self.robots > 0 && self.queries > 0, "--robots and --queries must be at least 1");
        let budget = self.budget.unwrap_or(Settings::default().expansions_per_plan);
        let bar = progress(self.queries as u64, "queries");
        let step = |query| bar.set_position(query as u64);
        anyhow::ensure!((0.0..=100.0).contains(&self.weight), "--weight must be from 0 to 100");
        let setup = planning::PlanningSetup {
            robots: self.robots,
            queries: self.queries,
            budget,
            seed: self.seed,
            weight: self.weight,
        };
        let out = planning::run(&warehouse, &setup, stopwatch, step);
        bar.finish_and_clear();
        let weighted = (self.weight > 0.0).then(|| weighted(&out.weighted, self.weight));
        let report = json!({
            "map": warehouse.name, "robots": self.robots, "routes_held": out.routes, "holds": out.holds,
            "budget_expansions": budget,
            "plan_us": quantiles(&out.found_ns), "failed_us": quantiles(&out.failed_ns),
            "expansions": {"p50": at(&out.expansions, 0.5), "p99": at(&out.expansions, 0.99)},
            "weighted": weighted,
            "cold_all_ms": out.cold_ns as f64 / 1e6,
            "memory_mb": {"process_peak": peak_memory_mb(), "lower_bounds": out.estimate_bytes as f64 / 1e6},
        });
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            println!("{} routes held; one more:", out.routes);
            println!("  found  {}", report["plan_us"]);
            println!("  failed {}", report["failed_us"]);
            println!("  memory {}", report["memory_mb"]);
            if self.weight > 0.0 {
                println!("with weight {}: {}", self.weight, report["weighted"]);
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// The figure at a share of ascending figures.
fn at<T: Copy>(ascending: &[T], q: f64) -> Option<T> {
    ascending.get((ascending.len() as f64 * q) as usize).copied()
}

/// Time and work with a weight, and the cost of its routes relative to the plain search.
fn weighted(w: &planning::Weighted, k: f64) -> serde_json::Value {
    let ratio = |r: &[f64]| json!({"p50": at(r, 0.5), "p99": at(r, 0.99), "max": r.last()});
    json!({
        "k": k, "bound": 1.0 + k, "compared": w.last.len(),
        "last_goal": ratio(&w.last), "first_goal": ratio(&w.first),
        "plan_us": quantiles(&w.found_ns), "failed_us": quantiles(&w.failed_ns),
        "expansions": {"p50": at(&w.expansions, 0.5), "p99": at(&w.expansions, 0.99)},
        "found_only_without": w.only[0], "found_only_with": w.only[1],
    })
}

/// Peak memory of the process, as the kernel reports it; nothing if it does not.
fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1000.0)
}

impl Bench {
    /// Runs the measurement.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self {
            Bench::Lifelong(arguments) => arguments.run(),
            Bench::Plan(arguments) => arguments.run(),
            Bench::Distances(arguments) => arguments.run(),
            Bench::Steps(arguments) => arguments.run(),
            Bench::Joint(arguments) => arguments.run(),
            Bench::Memory(arguments) => arguments.run(),
            Bench::Picks(picks) => picks.run(),
        }
    }
}

impl LifelongArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let named = |path: &PathBuf, e: String| anyhow::anyhow!("{}: {e}", path.display());
        let grid = Grid::parse(&read(&self.map)?).map_err(|e| named(&self.map, e))?;
        let cells = |path: &PathBuf| lifelong::parse_cells(&grid, &read(path)?).map_err(|e| named(path, e));
        let setup = LifelongSetup {
            starts: cells(&self.agents)?,
            tasks: cells(&self.tasks)?,
            steps: self.steps,
            turns: matches!(self.rules, RulesArgument::Turns),
            improve_every: self.improve_every,
            budget: self.budget,
        };
        if let Some(cell) = lifelong::first_shared(&setup.starts) {
            let message = format!(
                "two robots start at {}; give each a cell of its own",
                grid.warehouse.nodes[cell].name
            );
            return Err(named(&self.agents, message));
        }
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

//! The commands of `giveway-lab`: `experiment`, `learn` and `bench`.
//!
//! Main function: [`run`]. One file per command. `giveway` hands these three on to the program built here, so they are
//! documented as its own. Refuses: to contain anything that a library user would miss.

mod alarms;
mod arm;
mod arm_planners;
mod bench;
mod bench_joint;
mod bench_memory;
mod bench_picks;
mod bench_steps;
mod corridor;
mod corridor_hall;
mod experiment;
mod learn;
mod objects;
mod people;
mod picks;
mod price;
mod recorded;
mod rings;
mod safe_space;
mod stations;

use clap::{Parser, Subcommand};
use giveway::cli::files::{read, read_map, write};
use giveway::cli::progress::{progress, stopwatch};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Giveway's laboratory: published experiments, learning, benchmarks.
#[derive(Parser)]
#[command(name = "giveway-lab", bin_name = "giveway", version, max_term_width = 100)]
struct LabArguments {
    #[command(subcommand)]
    command: LabCommand,
}

#[derive(Subcommand)]
enum LabCommand {
    /// Measure planning on this machine.
    #[command(subcommand)]
    Bench(bench::Bench),
    /// Learn about people from recorded tracks; the server and simulations use what was learned.
    Learn(learn::LearnArgs),
    /// Rerun published experiments.
    #[command(subcommand)]
    Experiment(experiment::Experiment),
}

/// Parses arguments, runs the command, and prints an error with all its causes.
pub fn run() -> ExitCode {
    let result = match LabArguments::parse().command {
        LabCommand::Bench(bench) => bench.run(),
        LabCommand::Learn(learn) => learn.run(),
        LabCommand::Experiment(experiment) => experiment.run(),
    };
    result.unwrap_or_else(|error| {
        eprintln!("giveway: {error:#}");
        ExitCode::FAILURE
    })
}

/// Results of `parts` pieces of work, in order.
fn in_parallel<T: Send>(parts: usize, jobs: Option<usize>, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let results: Vec<Mutex<Option<T>>> = (0..parts).map(|_| Mutex::new(None)).collect();
    let next = AtomicUsize::new(0);
    let bar = progress(parts as u64, "runs");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..jobs.unwrap_or(cores).clamp(1, parts.max(1)) {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(slot) = results.get(i) else { break };
                    let result = work(i);
                    *slot.lock().expect("nobody panics while holding it") = Some(result);
                    bar.inc(1);
                }
            });
        }
    });
    bar.finish_and_clear();
    let result = |slot: Mutex<Option<T>>| slot.into_inner().expect("all are done").expect("all were run");
    results.into_iter().map(result).collect()
}

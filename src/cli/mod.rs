//! The command line: reads files, calls the library, prints tables or JSON.
//!
//! Main function: [`run`]. One file per command. Refuses: to contain anything that a library user would miss. Exit
//! codes: 0 done, 1 the work failed or a law was broken, 2 wrong arguments, 141 the reader of the output has left.

// First, since its `println!` and `eprintln!` hold in all that follow.
#[macro_use]
mod out;

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
mod database;
mod experiment;
mod frames;
mod learn;
mod map;
mod objects;
mod people;
mod picks;
mod price;
mod recorded;
mod recording;
mod replay;
mod rings;
mod safe_space;
mod serve;
mod sim;
mod stations;
mod swarm;
mod token;

use crate::warehouse::{Warehouse, formats};
use clap::{Parser, Subcommand};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A warehouse fleet manager in which robots give way to people.
///
/// Giveway is an efficiency layer, not a safety function: detection, braking and emergency stop are the robots' own.
#[derive(Parser)]
#[command(name = "giveway", version, max_term_width = 100, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<CliCommand>,
    /// Without a command: serve.
    #[command(flatten)]
    serve: serve::Serve,
}

#[derive(Subcommand)]
enum CliCommand {
    /// Run the server (the default command).
    Serve(serve::Serve),
    /// Run a scenario without a server, far faster than real time, and print its figures.
    Sim(sim::SimArgs),
    /// Draw floors, people, jobs and faults from seeds, check all laws, and shrink what fails.
    Swarm(swarm::SwarmArgs),
    /// Replay a recording.
    Replay(replay::ReplayArgs),
    /// Check, show, make and import maps.
    #[command(subcommand)]
    Map(map::Map),
    /// Measure planning on this machine.
    #[command(subcommand)]
    Bench(bench::Bench),
    /// Check, back up and restore the server's database.
    Database(database::DatabaseArgs),
    /// Make, list, renew and revoke named tokens.
    Token(token::TokenArgs),
    /// Learn about people from recorded tracks; the server and simulations use what was learned.
    Learn(learn::LearnArgs),
    /// Rerun published experiments.
    #[command(subcommand)]
    Experiment(experiment::Experiment),
}

/// Parses arguments, runs the command, prints what went wrong with all its causes.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.command {
        Some(CliCommand::Sim(sim)) => sim.run(),
        Some(CliCommand::Swarm(swarm)) => swarm.run(),
        Some(CliCommand::Map(map)) => map.run(),
        Some(CliCommand::Replay(replay)) => replay.run(),
        Some(CliCommand::Serve(serve)) => serve.run(),
        Some(CliCommand::Bench(bench)) => bench.run(),
        Some(CliCommand::Database(database)) => database.run(),
        Some(CliCommand::Token(token)) => token.run(),
        Some(CliCommand::Learn(learn)) => learn.run(),
        Some(CliCommand::Experiment(experiment)) => experiment.run(),
        None => arguments.serve.run(),
    };
    result.unwrap_or_else(|error| {
        eprintln!("giveway: {error:#}");
        ExitCode::FAILURE
    })
}

/// Reads a text file, naming it where that fails. However a program wrote it, it begins without a byte order mark and
/// its lines end with LF.
fn read(path: &std::path::Path) -> anyhow::Result<String> {
    use anyhow::Context;
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let text = String::from_utf8(bytes);
    let text = text.with_context(|| format!("{} is not text in UTF-8: save it as UTF-8", path.display()))?;
    Ok(text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n"))
}

/// Writes a text file, or standard output where no path is given.
fn write(path: Option<&std::path::Path>, text: &str) -> anyhow::Result<()> {
    use anyhow::Context;
    match path {
        Some(path) => std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display())),
        None => {
            out::bytes(text.as_bytes());
            Ok(())
        }
    }
}

/// Reads a map of any known format; notes of an import go to standard error.
fn read_map(path: &std::path::Path) -> anyhow::Result<std::sync::Arc<Warehouse>> {
    let (warehouse, notes) = formats::import(&read(path)?, &formats::Options::default())
        .map_err(|e| anyhow::anyhow!("{} is refused:\n{e}", path.display()))?;
    notes.0.iter().for_each(|n| eprintln!("note: {n}"));
    Ok(std::sync::Arc::new(warehouse))
}

/// Nanoseconds of a monotonic clock, for the figures of a run.
fn stopwatch() -> u64 {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed().as_nanos() as u64
}

/// A progress bar on standard error; nothing where that is no terminal.
fn progress(length: u64, what: &'static str) -> indicatif::ProgressBar {
    let style = indicatif::ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}");
    indicatif::ProgressBar::new(length)
        .with_style(style.expect("the template is well-formed"))
        .with_message(what)
}

/// Results of work in parts, in their order.
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

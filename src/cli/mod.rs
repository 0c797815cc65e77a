//! The command line: reads files, calls the library, prints tables or JSON.
//!
//! Main function: [`run`]. One file per command. Refuses: to contain anything that a library user would miss. Exit
//! codes: 0 done, 1 the work failed or a law was broken, 2 wrong arguments.

mod bench;
mod serve;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// A warehouse fleet manager in which robots give way to people.
///
/// Giveway is an efficiency layer and no safety function: detection, braking and emergency stop are the robots' own.
#[derive(Parser)]
#[command(name = "giveway", version, max_term_width = 100, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Without a command: serve.
    #[command(flatten)]
    serve: serve::Serve,
}

#[derive(Subcommand)]
enum Command {
    /// Run the server (the default command).
    Serve(serve::Serve),
    /// Measure planning on this machine.
    #[command(subcommand)]
    Bench(bench::Bench),
}

/// Parses arguments, runs the command, prints what went wrong with all its causes.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.command {
        Some(Command::Serve(serve)) => serve.run(),
        Some(Command::Bench(bench)) => bench.run(),
        None => arguments.serve.run(),
    };
    result.unwrap_or_else(|error| {
        eprintln!("giveway: {error:#}");
        ExitCode::FAILURE
    })
}

/// Reads a text file, naming it where that fails.
fn read(path: &std::path::Path) -> anyhow::Result<String> {
    use anyhow::Context;
    std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

/// A progress bar on standard error; nothing where that is no terminal.
fn progress(length: u64, what: &'static str) -> indicatif::ProgressBar {
    let style = indicatif::ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}");
    indicatif::ProgressBar::new(length)
        .with_style(style.expect("the template is well-formed"))
        .with_message(what)
}

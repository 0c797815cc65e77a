//! The command line: reads files, calls the library, prints tables or JSON.
//!
//! Main function: [`run`]. One file per command. Refuses: to contain anything that a user of the library would miss.
//! Exit codes: 0 done, 1 the work failed or a law was broken, 2 wrong arguments, 141 the reader of the output has left.

// This module comes first, since its `println!` and `eprintln!` apply to all modules that follow.
#[macro_use]
pub mod out;

mod database;
pub mod files;
mod frames;
mod laboratory;
mod map;
pub mod progress;
mod recording;
mod replay;
pub mod rings;
mod robot;
mod serve;
pub mod sim;
mod swarm;
mod token;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// A warehouse fleet manager in which robots give way to people.
///
/// Giveway is an efficiency layer, not a safety function: detection, braking and emergency stop are the robots' own.
#[derive(Parser)]
#[command(name = "giveway", version, max_term_width = 100, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<CliCommand>,
    /// Without a command, `serve` runs.
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
    /// Run virtual robots that speak VDA 5050; write a broker's rights; probe a robot.
    Robot(robot::RobotArgs),
    /// Replay a recording.
    Replay(replay::ReplayArgs),
    /// Check, show, make and import maps.
    #[command(subcommand)]
    Map(map::Map),
    /// Measure planning on this machine (the laboratory's).
    Bench(laboratory::LabArgs),
    /// Check, back up and restore the server's database.
    Database(database::DatabaseArgs),
    /// Make, list, rotate and revoke named tokens.
    Token(token::TokenArgs),
    /// Learn about people from recorded tracks; the server and simulations use what was learned (the laboratory's).
    Learn(laboratory::LabArgs),
    /// Rerun published experiments (the laboratory's).
    Experiment(laboratory::LabArgs),
}

/// Parses the arguments, runs the command, and prints an error with all its causes.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.command {
        Some(CliCommand::Sim(sim)) => sim.run(),
        Some(CliCommand::Swarm(swarm)) => swarm.run(),
        Some(CliCommand::Map(map)) => map.run(),
        Some(CliCommand::Robot(robot)) => robot.run(),
        Some(CliCommand::Replay(replay)) => replay.run(),
        Some(CliCommand::Serve(serve)) => serve.run(),
        Some(CliCommand::Bench(lab)) => lab.run("bench"),
        Some(CliCommand::Database(database)) => database.run(),
        Some(CliCommand::Token(token)) => token.run(),
        Some(CliCommand::Learn(lab)) => lab.run("learn"),
        Some(CliCommand::Experiment(lab)) => lab.run("experiment"),
        None => arguments.serve.run(),
    };
    result.unwrap_or_else(|error| {
        eprintln!("giveway: {error:#}");
        ExitCode::FAILURE
    })
}

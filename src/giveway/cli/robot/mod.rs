//! `giveway robot`: robots that speak VDA 5050, for tests of this and of any other master.
//!
//! Main type: [`RobotArgs`]. Without a subcommand, virtual robots drive until they are told to stop. Refuses: to know
//! anything of a running server; everything goes through the broker.

mod acl;
mod client;
mod faults;
mod listing;
mod places;
mod probe;
mod run;
mod transport;

use clap::{Args, Subcommand};
use std::process::ExitCode;

/// Arguments of `robot`.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct RobotArgs {
    #[command(subcommand)]
    command: Option<RobotCommand>,
    #[command(flatten)]
    run: run::VirtualArgs,
}

#[derive(Subcommand)]
enum RobotCommand {
    /// Write the rights of robots and of Giveway for Mosquitto's `acl_file`, from a file of robots.
    Acl(acl::AclArgs),
    /// Find out what is special about a robot before it joins; it moves only with --drive.
    Probe(probe::ProbeArgs),
}

impl RobotArgs {
    /// Runs virtual robots, or the subcommand.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self.command {
            Some(RobotCommand::Acl(acl)) => acl.run(),
            Some(RobotCommand::Probe(probe)) => probe.run(),
            None => self.run.run(),
        }
    }
}

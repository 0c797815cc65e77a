//! `giveway experiment`, `learn` and `bench`: the laboratory's commands, which run the program `giveway-lab` beside
//! this one.
//!
//! Main type: [`LabArgs`]. Refuses: to look for that program anywhere except beside this one, where the build puts it.

use anyhow::Context;
use clap::Args;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Arguments of a laboratory command, which the laboratory itself parses.
#[derive(Args)]
#[command(disable_help_flag = true)]
pub struct LabArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

impl LabArgs {
    /// Runs `giveway-lab` with these arguments; its exit code becomes this program's.
    pub fn run(self, command: &str) -> anyhow::Result<ExitCode> {
        let ours = std::env::current_exe().context("cannot tell where this program is")?;
        let lab = ours.with_file_name(format!("giveway-lab{}", std::env::consts::EXE_SUFFIX));
        if !lab.exists() {
            anyhow::bail!(
                "`giveway {command}` is part of the laboratory, which is not built: {}",
                how(&ours)
            );
        }
        let ran = Command::new(&lab).arg(command).args(&self.arguments).status();
        let status = ran.with_context(|| format!("cannot run {}", lab.display()))?;
        // A program that a signal ended has no code; shells show 128 plus the signal's number, but here it is a plain
        // failure.
        Ok(status.code().map_or(ExitCode::FAILURE, |code| ExitCode::from(code.clamp(0, 255) as u8)))
    }
}

/// The command that builds `giveway-lab` beside this program.
fn how(ours: &Path) -> &'static str {
    let is_release = ours.parent().is_some_and(|folder| folder.ends_with("release"));
    if is_release {
        "type `cargo build --release -p giveway-lab`"
    } else {
        "type `cargo build -p giveway-lab`"
    }
}

//! `giveway experiment`, `learn` and `bench`: the laboratory's commands, by the program `giveway-lab` beside this one.
//!
//! Main type: [`LabArgs`]. Refuses: to look for that program anywhere but beside this one, where the build puts it.

use anyhow::Context;
use clap::Args;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Arguments of one of the laboratory's commands, which it reads itself.
#[derive(Args)]
#[command(disable_help_flag = true)]
pub struct LabArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

impl LabArgs {
    /// Runs `giveway-lab` with them; its exit code is ours.
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
        // One that a signal ended has no code; shells would see 128 and its number, and here that it failed.
        Ok(status.code().map_or(ExitCode::FAILURE, |code| ExitCode::from(code.clamp(0, 255) as u8)))
    }
}

/// The command that builds it beside this program.
fn how(ours: &Path) -> &'static str {
    let is_release = ours.parent().is_some_and(|folder| folder.ends_with("release"));
    if is_release {
        "type `cargo build --release -p giveway-lab`"
    } else {
        "type `cargo build -p giveway-lab`"
    }
}

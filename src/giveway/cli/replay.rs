//! `giveway replay`: steps through a recording again, or makes a reel or a page of it.
//!
//! Main type: [`ReplayArgs`]. Refuses: to simulate; the recorded messages of robots and customers are replayed, and the
//! digest tells whether the core still decides the same.

use super::frames::{FrameWriter, write_page};
use super::recording;
use crate::server::Show;
use anyhow::Context;
use clap::Args;
use giveway_api::recording::is_reel;
use giveway_floor::time::Time;
use giveway_sim::{Player, Turn};
use serde_json::json;
use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Arguments of `replay`.
#[derive(Args)]
pub struct ReplayArgs {
    /// Recording made with `giveway sim --record`; for a page, a reel is also accepted.
    recording: PathBuf,
    /// Write a reel to this file; the dashboard of any server can open it.
    #[arg(long, value_name = "FILE")]
    reel: Option<PathBuf>,
    /// Write a page that contains the reel; it opens in a browser without a server.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Only step through the recording, as fast as possible, and report whether the core still decides the same.
    #[arg(long)]
    check: bool,
    /// Address and port on which to show the recording.
    #[arg(long, default_value = "127.0.0.1:8081")]
    listen: std::net::SocketAddr,
    /// Playback speed, as a multiple of real time.
    #[arg(long, default_value_t = 1.0)]
    speed: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl ReplayArgs {
    /// Plays the recording.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        if is_reel(&self.recording) {
            let page =
                self.page.as_deref().context("this is a reel: open it in the page, or give --page FILE")?;
            write_page(page, &self.recording)?;
            return Ok(ExitCode::SUCCESS);
        }
        let mut player = open(&self.recording)?;
        if !self.check && self.reel.is_none() && self.page.is_none() {
            anyhow::ensure!((0.01..=1000.0).contains(&self.speed), "--speed must be from 0.01 to 1000");
            super::serve::trace_to_stderr();
            let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
            return runtime.block_on(self.show(player));
        }
        let bar = super::progress::progress(player.scenario.duration.0 as u64 / 1_000_000, "replaying");
        let mut last = Time::ZERO;
        let name = player.scenario.site.name.clone();
        let mut reeler =
            FrameWriter::create(self.reel.as_deref(), self.page.as_deref(), &player.fleet, name)?;
        let same = loop {
            match player.turn()? {
                Turn::Step(now, step) => {
                    last = now;
                    if let Some(reeler) = &mut reeler {
                        reeler.step(&player.fleet, now, &step.facts)?;
                    }
                }
                Turn::End { same } => break same,
            }
            bar.set_position(last.0 as u64 / 1_000_000);
        };
        bar.finish_and_clear();
        reeler.map_or(Ok(()), FrameWriter::finish)?;
        let counts = player.fleet.view(last).counts;
        let report = json!({
            "scenario": player.scenario.site.name, "steps": player.steps(), "sim_seconds": last.as_secs_f64(),
            "robot_deliveries": counts.robot_deliveries, "trace_hash": format!("{:016x}", player.trace_hash()),
            "same_as_recorded": same,
        });
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else if same {
            println!("{} steps, {} deliveries: as recorded", player.steps(), counts.robot_deliveries);
        } else {
            println!("{} steps: this build decides differently from the one that recorded", player.steps());
        }
        Ok(if same { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    async fn show(self, player: Player) -> anyhow::Result<ExitCode> {
        anyhow::ensure!(
            self.listen.ip().is_loopback(),
            "a recording is shown on this machine only: --listen must be a loopback address, not {}",
            self.listen
        );
        let name = player.scenario.site.name.clone();
        let mut show = Show::start(player, open(&self.recording)?, self.listen, self.speed).await?;
        println!("the recording of {name} is at http://{}/", show.address());
        tokio::select! {
            ended = show.ended() => ended?,
            signal = super::serve::asked_to_stop() => signal?,
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn open(path: &Path) -> anyhow::Result<Player> {
    let lines = recording::open(path)?.lines().map(|l| l.map_err(|e| e.to_string()));
    Player::open(Box::new(lines), super::progress::stopwatch)
        .with_context(|| format!("{} cannot be replayed", path.display()))
}

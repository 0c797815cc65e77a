//! `giveway replay`: step through a recording again.
//!
//! Main type: [`Replay`]. Refuses: to simulate; robots and customers say what they said then, and the digest tells
//! whether the core still makes the same of it.

use super::recording;
use crate::fleet::{Fleet, Settings};
use crate::sim::recording::{Played, Playback};
use crate::sim::{Digest, Scenario};
use crate::time::Time;
use crate::warehouse::formats;
use anyhow::Context;
use clap::Args;
use serde_json::json;
use std::io::BufRead;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Arguments of `replay`.
#[derive(Args)]
pub struct Replay {
    /// Recording made with `giveway sim --record`.
    recording: PathBuf,
    /// Only step through it, as fast as it goes, and say whether the core still decides the same.
    #[arg(long)]
    check: bool,
    /// Where to show it.
    #[arg(long, default_value = "127.0.0.1:8081")]
    listen: String,
    /// So many times as fast as it was.
    #[arg(long, default_value_t = 1.0)]
    speed: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// A recording being played.
pub struct Player {
    /// The fleet as it was then.
    pub fleet: Fleet,
    /// The scenario that was recorded.
    pub scenario: Scenario,
    lines: std::io::Lines<Box<dyn BufRead + Send>>,
    playback: Playback,
    digest: Digest,
    steps: u64,
}

/// What one line of a recording did.
pub enum Turn {
    /// A step at this time.
    Step(Time, crate::fleet::Step),
    /// The end; whether the core decided the same.
    End {
        /// Whether it did.
        same: bool,
    },
}

impl Player {
    /// Opens a recording.
    pub fn open(path: &std::path::Path) -> anyhow::Result<Player> {
        let mut lines = recording::open(path)?.lines();
        let first = lines.next().transpose().with_context(|| format!("cannot read {}", path.display()))?;
        let (header, playback) = Playback::open(&first.unwrap_or_default())
            .with_context(|| format!("{} cannot be replayed", path.display()))?;
        let scenario = Scenario::parse(&header.scenario).context("the scenario in the recording is refused")?;
        let warehouse = formats::json::parse(&header.map)
            .map_err(|e| anyhow::anyhow!("the map in the recording is refused:\n{e}"))?;
        let settings = Settings { stopwatch: super::stopwatch, ..scenario.settings() };
        let fleet = Fleet::new(Arc::new(warehouse), settings);
        Ok(Player { fleet, scenario, lines, playback, digest: Digest::default(), steps: 0 })
    }

    /// Plays the next line.
    pub fn turn(&mut self) -> anyhow::Result<Turn> {
        let line = self.lines.next().context("the recording ends without its last line: it was cut off")??;
        match self.playback.read(&line)? {
            Played::Step(now, inputs) => {
                let step = self.fleet.step(now, inputs);
                self.digest.add(&step.facts);
                self.steps += 1;
                Ok(Turn::Step(now, step))
            }
            Played::End(hash) => Ok(Turn::End { same: hash == self.digest.value() }),
        }
    }
}

impl Replay {
    /// Plays the recording.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let mut player = Player::open(&self.recording)?;
        if !self.check {
            anyhow::ensure!((0.01..=1000.0).contains(&self.speed), "--speed must be from 0.01 to 1000");
            return crate::server::show(player, &self.listen, self.speed);
        }
        let bar = super::progress(player.scenario.duration.0 as u64 / 1_000_000, "replaying");
        let mut last = Time::ZERO;
        let same = loop {
            match player.turn()? {
                Turn::Step(now, _) => last = now,
                Turn::End { same } => break same,
            }
            bar.set_position(last.0 as u64 / 1_000_000);
        };
        bar.finish_and_clear();
        let counts = player.fleet.view(last).counts;
        let report = json!({
            "scenario": player.scenario.name, "steps": player.steps, "sim_seconds": last.as_secs_f64(),
            "robot_deliveries": counts.robot_deliveries, "trace_hash": format!("{:016x}", player.digest.value()),
            "same_as_recorded": same,
        });
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else if same {
            println!("{} steps, {} deliveries: as recorded", player.steps, counts.robot_deliveries);
        } else {
            println!("{} steps: this build decides differently from the one that recorded", player.steps);
        }
        Ok(if same { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

//! Stepping through a recording: the core runs on the recorded inputs.
//!
//! Main types: [`Player`], [`Turn`]. Refuses: to simulate anything.

use crate::measure::digest::Digest;
use crate::recording::{Broken, Playback, Played};
use crate::scenario::Scenario;
use giveway_fleet::{Fleet, Settings, Step};
use giveway_floor::time::Time;
use giveway_floor::warehouse::formats;
use giveway_people::human::Model;
use giveway_people::reach::PickModel;
use std::sync::Arc;

/// The lines of a recording, or why one could not be read.
pub type Lines = Box<dyn Iterator<Item = Result<String, String>> + Send>;

/// A recording being played.
pub struct Player {
    /// The fleet at the current step.
    pub fleet: Fleet,
    /// The scenario that was recorded.
    pub scenario: Scenario,
    lines: Lines,
    playback: Playback,
    digest: Digest,
    steps: u64,
}

/// What one line of a recording did.
pub enum Turn {
    /// A step at this time.
    Step(Time, Box<Step>),
    /// The end of the recording.
    End {
        /// Whether the core reached the recorded digest.
        same: bool,
    },
}

impl Player {
    /// Reads the first line.
    ///
    /// # Errors
    /// If it is no recording, or its scenario or map is refused.
    pub fn open(mut lines: Lines, stopwatch: fn() -> u64) -> Result<Player, Broken> {
        let broken = |message: String| Broken { line: 1, message };
        let first = lines.next().unwrap_or_else(|| Err("it is empty".into())).map_err(broken)?;
        let (header, playback) = Playback::open(&first)?;
        let mut scenario = Scenario::parse(&header.scenario).map_err(|e| broken(format!("scenario: {e}")))?;
        if let Some(model) = &header.model {
            scenario.site.learned = Arc::new(Model::parse(model).map_err(|e| broken(format!("model: {e}")))?);
        }
        if let Some(picks) = &header.picks {
            scenario.site.picks =
                Arc::new(PickModel::parse(picks).map_err(|e| broken(format!("picks: {e}")))?);
        }
        let warehouse = formats::json::parse(&header.map).map_err(|e| broken(format!("map: {e}")))?;
        let warehouse = scenario.site.fit(&Arc::new(warehouse)).map_err(|e| broken(format!("map: {e}")))?;
        scenario.check_method(&warehouse).map_err(|e| broken(format!("scenario: {e}")))?;
        let settings = Settings { stopwatch, ..scenario.site.settings() };
        let fleet = Fleet::new(warehouse, settings);
        Ok(Player { fleet, scenario, lines, playback, digest: Digest::default(), steps: 0 })
    }

    /// Plays the next line.
    ///
    /// # Errors
    /// If the recording is cut off or a line cannot be read.
    pub fn turn(&mut self) -> Result<Turn, Broken> {
        let cut = "the recording was cut off before its last line".to_owned();
        let line = self.lines.next().unwrap_or(Err(cut));
        let line = line.map_err(|message| Broken { line: self.steps as usize + 2, message })?;
        match self.playback.read(&line)? {
            Played::Step(now, inputs) => {
                let step = self.fleet.step(now, inputs);
                self.digest.add(&step.facts);
                self.steps += 1;
                Ok(Turn::Step(now, Box::new(step)))
            }
            Played::End(hash) => Ok(Turn::End { same: hash == self.digest.value() }),
        }
    }

    /// Number of steps played.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The digest of all facts so far.
    pub fn trace_hash(&self) -> u64 {
        self.digest.value()
    }
}

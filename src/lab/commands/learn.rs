//! `giveway learn`: figures about people from recorded tracks, and from recorded or simulated reaches.
//!
//! Main type: [`LearnArgs`]. Refuses: to guess the format of a file that looks like none.

use super::picks::LearnPicksArgs;
use super::{read, write};
use crate::learning::{Lesson, learn};
use crate::recorded::{Format, RecordedWalks, goals};
use anyhow::Context;
use clap::{Args, Subcommand, ValueEnum};
use giveway::cli::files::read_model;
use giveway_floor::geometry::Point;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Formats of recorded tracks.
#[derive(Clone, Copy, ValueEnum)]
pub enum FormatArgument {
    /// ETH and UCY: frame, person, x, y.
    Eth,
    /// THÖR-MAGNI: a table of tracklets.
    Magni,
    /// THÖR: seconds, person, x, y, speed, heading.
    Thor,
}

impl FormatArgument {
    fn format(self) -> Format {
        match self {
            FormatArgument::Eth => Format::Eth,
            FormatArgument::Magni => Format::Magni,
            FormatArgument::Thor => Format::Thor,
        }
    }
}

/// Reads recorded tracks, in the given format or one guessed from the first line.
pub fn read_tracks(path: &Path, format: Option<FormatArgument>) -> anyhow::Result<RecordedWalks> {
    let text = read(path)?;
    let format = format.map(FormatArgument::format).or_else(|| Format::guess(&text));
    let format = format.with_context(|| {
        format!("cannot tell the format of {}: give it with --format eth, magni or thor", path.display())
    })?;
    RecordedWalks::parse(&text, format).with_context(|| format!("{} is refused", path.display()))
}

/// Reads goals: lines of name, x, y or of x, y.
pub fn read_goals(path: Option<&Path>) -> anyhow::Result<Vec<(String, Point)>> {
    path.map_or(Ok(Vec::new()), |p| goals(&read(p)?).with_context(|| format!("{} is refused", p.display())))
}

/// Arguments of `learn`.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct LearnArgs {
    #[command(subcommand)]
    what: Option<Learnt>,
    /// Without a word before them: recorded tracks.
    #[command(flatten)]
    tracks: Option<LearnTracksArgs>,
}

/// What else there is to learn.
#[derive(Subcommand)]
enum Learnt {
    /// Where hands go, where arms will be and where eyes look, from people who reach for places.
    Picks(LearnPicksArgs),
}

/// Arguments of `learn TRACKS`.
#[derive(Args)]
struct LearnTracksArgs {
    /// Files of recorded tracks.
    #[arg(required = true)]
    tracks: Vec<PathBuf>,
    /// Format of the files; told by their first lines if absent.
    #[arg(long, value_enum)]
    format: Option<FormatArgument>,
    /// Places where people go (CSV of name, x, y in metres), in the recordings named by --goals-of.
    #[arg(long)]
    goals: Option<PathBuf>,
    /// Which of the recordings have those goals; all of them if absent.
    #[arg(long, value_name = "TRACKS")]
    goals_of: Vec<PathBuf>,
    /// Leave out what applies to one building only: where people go next from each place.
    #[arg(long)]
    general: bool,
    /// Where to write what was learned.
    #[arg(long)]
    out: PathBuf,
    /// A model to start from; the built-in one if absent.
    #[arg(long)]
    from: Option<PathBuf>,
}

impl LearnArgs {
    /// Learns and writes the model.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match (self.what, self.tracks) {
            (Some(Learnt::Picks(picks)), _) => picks.run(),
            (None, Some(tracks)) => tracks.run(),
            (None, None) => anyhow::bail!("name files of recorded tracks, or `picks` and folders of reaches"),
        }
    }
}

impl LearnTracksArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let start = read_model(self.from.as_deref())?;
        let places: Vec<Point> = read_goals(self.goals.as_deref())?.into_iter().map(|g| g.1).collect();
        for named in &self.goals_of {
            let is_known = self.tracks.contains(named);
            anyhow::ensure!(is_known, "--goals-of {} is not one of the tracks", named.display());
        }
        let lessons = self.tracks.iter().map(|path| {
            let has_goals = self.goals_of.is_empty() || self.goals_of.contains(path);
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let goals = if has_goals { places.clone() } else { Vec::new() };
            Ok(Lesson { name, recording: read_tracks(path, self.format)?, goals })
        });
        let lessons = lessons.collect::<anyhow::Result<Vec<Lesson>>>()?;
        let mut model = learn(&lessons, &start, |what| eprintln!("learning {what}"));
        if self.general {
            Arc::make_mut(&mut model.purpose).places.clear();
        }
        write(Some(&self.out), &model.to_json())?;
        println!("learned from {}", model.learned_from.join(", "));
        println!("written to {}", self.out.display());
        Ok(ExitCode::SUCCESS)
    }
}

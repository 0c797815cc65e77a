//! `giveway map`: check, show, make and import maps.
//!
//! Main type: [`Map`]. Refuses: to write a map that it would not accept.

use super::files::{read, write};
use clap::{Args, Subcommand};
use giveway_floor::time::Span;
use giveway_floor::warehouse::{
    Blocks, Finding, MapSummary, Remark, Review, Severity, ShutIn, formats, review, review_to_svg, room_for,
    shut_in_text, summary,
};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Commands about maps.
#[derive(Subcommand)]
pub enum Map {
    /// Read a map, list every problem with its place and remedy, and summarise the map's content.
    Check(CheckArgs),
    /// Draw a map as SVG, even a refused one, with its errors in red.
    Show(ShowArgs),
    /// Make a map of rack blocks from parameters.
    Generate(GenerateArgs),
    /// Turn an octile grid (`.map`) or a warehouse grid with endpoints into a map.
    Import(ImportArgs),
}

/// Arguments of `map check`.
#[derive(Args)]
pub struct CheckArgs {
    /// Map file.
    map: PathBuf,
    /// Also check that this many robots have a place to stay.
    #[arg(long)]
    robots: Option<usize>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The output of `map check --json` for an accepted map.
#[derive(Serialize)]
struct Checked {
    #[serde(flatten)]
    summary: MapSummary,
    /// Places where a broken robot would shut others in.
    findings: Vec<ShutIn>,
    /// Other warnings.
    warnings: Vec<Found>,
}

/// The output of `map check --json` for a refused map.
#[derive(Serialize)]
struct Refused {
    /// Errors because of which the map is refused.
    errors: Vec<Found>,
    /// Warnings.
    warnings: Vec<Found>,
}

/// A finding in a form for programs.
#[derive(Serialize)]
struct Found {
    place: String,
    problem: String,
    remedy: String,
    /// Places on the floor, metres.
    at: Vec<[f64; 2]>,
}

impl From<&Remark> for Found {
    fn from(r: &Remark) -> Found {
        let Finding { place, problem, remedy, .. } = r.finding.clone();
        Found { place, problem, remedy, at: r.at.iter().map(|p| [p.x, p.y]).collect() }
    }
}

/// Arguments of `map show`.
#[derive(Args)]
pub struct ShowArgs {
    /// Map file.
    map: PathBuf,
    /// Where to write the drawing; standard output if absent.
    #[arg(long, short)]
    output: Option<PathBuf>,
}

/// Arguments of `map generate`.
#[derive(Args)]
pub struct GenerateArgs {
    /// Name of the map.
    #[arg(long, default_value = "blocks")]
    name: String,
    /// Groups of blocks, across and along, between main roads.
    #[arg(long, num_args = 2, default_values_t = [1, 1])]
    groups: Vec<usize>,
    /// Blocks in a group, across and along.
    #[arg(long, num_args = 2, default_values_t = [3, 5])]
    blocks: Vec<usize>,
    /// Racks along a block; a block is two racks deep.
    #[arg(long, default_value_t = 5)]
    block_length: usize,
    /// Stations on the west side.
    #[arg(long, default_value_t = 2)]
    stations_west: usize,
    /// Stations on the east side.
    #[arg(long, default_value_t = 2)]
    stations_east: usize,
    /// Queue places before each station.
    #[arg(long, default_value_t = 4)]
    queue: usize,
    /// Usual duration of a pick, seconds.
    #[arg(long, default_value_t = 8.0)]
    pick: f64,
    /// Chargers.
    #[arg(long, default_value_t = 8)]
    chargers: usize,
    /// Parking places.
    #[arg(long, default_value_t = 8)]
    parking: usize,
    /// Share of the storage nodes with a rack.
    #[arg(long, default_value_t = 0.85)]
    fill: f64,
    /// Metres between the two lanes of a main road, 1 to 10: 2.5 or more lets robots pass a truck there.
    #[arg(long, default_value_t = 1.0)]
    road: f64,
    /// Where to write the map; standard output if absent.
    #[arg(long, short)]
    output: Option<PathBuf>,
}

/// Arguments of `map import`.
#[derive(Args)]
pub struct ImportArgs {
    /// Grid file.
    grid: PathBuf,
    /// Name of the map; the name of the file if absent.
    #[arg(long)]
    name: Option<String>,
    /// Stations to add beside a warehouse grid.
    #[arg(long, default_value_t = 8)]
    stations: usize,
    /// Where to write the map; standard output if absent.
    #[arg(long, short)]
    output: Option<PathBuf>,
}

impl Map {
    /// Runs the command.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self {
            Map::Check(c) => c.run(),
            Map::Show(s) => s.run(),
            Map::Generate(g) => g.run(),
            Map::Import(i) => i.run(),
        }
    }
}

/// Reads a map of any known format and reviews it instead of refusing it; notes of an import go to standard error.
fn reviewed(path: &Path) -> anyhow::Result<Review> {
    let (draft, notes) = formats::import_draft(&read(path)?, &formats::Options::default())
        .map_err(|e| anyhow::anyhow!("{} is refused:\n{e}", path.display()))?;
    notes.0.iter().for_each(|n| eprintln!("note: {n}"));
    Ok(review(&draft))
}

/// The errors of a refused map, as one text.
fn refusal(path: &Path, review: &Review) -> String {
    let errors: Vec<String> = review.of(Severity::Error).map(Remark::to_string).collect();
    format!("{} is refused:\n{}", path.display(), errors.join("\n"))
}

impl ShowArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let review = reviewed(&self.map)?;
        let Some(drawing) = review_to_svg(&review) else { anyhow::bail!(refusal(&self.map, &review)) };
        write(self.output.as_deref(), &drawing)?;
        if review.is_good() {
            return Ok(ExitCode::SUCCESS);
        }
        eprintln!("giveway: {}", refusal(&self.map, &review));
        Ok(ExitCode::FAILURE)
    }
}

impl CheckArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let review = reviewed(&self.map)?;
        let of = |severity| review.of(severity).map(Found::from).collect::<Vec<_>>();
        let Some(warehouse) = review.warehouse.as_ref().filter(|_| review.is_good()) else {
            if self.json {
                let refused = Refused { errors: of(Severity::Error), warnings: of(Severity::Warning) };
                println!("{}", serde_json::to_string_pretty(&refused)?);
                return Ok(ExitCode::FAILURE);
            }
            review.of(Severity::Warning).for_each(|w| println!("warning: {w}"));
            anyhow::bail!(refusal(&self.map, &review));
        };
        if let Some(robots) = self.robots {
            room_for(warehouse, robots).map_err(|e| anyhow::anyhow!("{}:\n{e}", self.map.display()))?;
        }
        let (summary, findings) = (summary(warehouse), review.shut_in.clone());
        if self.json {
            println!(
                "{}",
                serde_json::to_string_pretty(&Checked {
                    summary,
                    findings,
                    warnings: of(Severity::Warning)
                })?
            );
        } else {
            println!("{summary}");
            review.of(Severity::Warning).for_each(|w| println!("warning: {w}"));
            shut_in_text(&findings).iter().for_each(|line| println!("warning: {line}"));
        }
        Ok(ExitCode::SUCCESS)
    }
}

impl GenerateArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let count = |n: usize, what: &str| {
            anyhow::ensure!((1..=500).contains(&n), "{what} must be from 1 to 500, not {n}");
            Ok(n)
        };
        anyhow::ensure!((0.0..=1.0).contains(&self.fill), "--fill must be from 0 to 1, not {}", self.fill);
        anyhow::ensure!(
            (1.0..=10.0).contains(&self.road),
            "--road must be from 1 to 10 m, not {}",
            self.road
        );
        anyhow::ensure!(
            (0.0..=3600.0).contains(&self.pick),
            "--pick must be from 0 to 3600 s, not {}",
            self.pick
        );
        let blocks = Blocks {
            name: self.name,
            groups: (count(self.groups[0], "--groups")?, count(self.groups[1], "--groups")?),
            blocks: (count(self.blocks[0], "--blocks")?, count(self.blocks[1], "--blocks")?),
            block_length: count(self.block_length, "--block-length")?,
            stations_west: self.stations_west,
            stations_east: self.stations_east,
            queue: self.queue,
            pick: Span::from_secs_f64(self.pick),
            chargers: self.chargers,
            parking: self.parking,
            fill: self.fill,
            road_m: self.road,
        };
        let warehouse =
            blocks.draft().build().map_err(|e| anyhow::anyhow!("these parameters make no map:\n{e}"))?;
        write(self.output.as_deref(), &formats::json::write(&warehouse))?;
        eprintln!("{}", summary(&warehouse));
        Ok(ExitCode::SUCCESS)
    }
}

impl ImportArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let stem = self.grid.file_stem().map(|s| s.to_string_lossy().into_owned());
        let name = self.name.or(stem).unwrap_or_else(|| "imported".into());
        let options = formats::Options { name, stations: self.stations, ..Default::default() };
        let (warehouse, notes) = formats::import(&read(&self.grid)?, &options)
            .map_err(|e| anyhow::anyhow!("{} is refused:\n{e}", self.grid.display()))?;
        write(self.output.as_deref(), &formats::json::write(&warehouse))?;
        notes.0.iter().for_each(|n| eprintln!("note: {n}"));
        eprintln!("{}", summary(&warehouse));
        Ok(ExitCode::SUCCESS)
    }
}

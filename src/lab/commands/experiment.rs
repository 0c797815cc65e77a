//! `giveway experiment`: published experiments again.
//!
//! Main type: [`Experiment`]. Refuses: to print a figure that depends on chance without its seed.

use super::alarms::AlarmsArgs;
use super::arm::{BoltsArgs, OverlapArgs};
use super::arm_planners::PlannersArgs;
use super::corridor::CorridorArgs;
use super::objects::ObjectsArgs;
use super::people::{DetectionArgs, TableArgs};
use super::picks::PicksArgs;
use super::price::PriceArgs;
use super::recorded::{EncountersArgs, ForecastArgs, PurposeArgs};
use super::safe_space::SafeSpaceArgs;
use super::stations::StationsArgs;
use super::write;
use crate::stories::{self, StoryKind};
use clap::{Args, Subcommand, ValueEnum};
use giveway_people::human::Method;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::ExitCode;

/// Which experiment.
#[derive(Subcommand)]
pub enum Experiment {
    /// Guess where a person is going, in one of three stories.
    Story(StoryArgs),
    /// Robots and people together, by four ways of giving way (Petković 2021, table 4.1).
    #[command(name = "table-4-1")]
    Table(TableArgs),
    /// What people on a floor cost the robots, and the robots the people.
    Price(PriceArgs),
    /// How soon and how surely the fleet notices that people leave their path.
    Detection(DetectionArgs),
    /// Where recorded people will be within five seconds: errors, regions, calibration.
    Forecast(ForecastArgs),
    /// Where recorded people are going: the right goal along the way, calibration.
    Intention(PurposeArgs),
    /// Recorded people among robots that know nothing of them: which robots brake in time, and which for nothing.
    Meetings(EncountersArgs),
    /// Faults that are brought about one at a time, and which alarms follow.
    Alarms(AlarmsArgs),
    /// Safe spaces of workers and robots, and when a route is kept (Ye et al.), beside ours.
    SafeSpace(SafeSpaceArgs),
    /// What picking stations gain by knowing lines and hands: lines per hour with each flow.
    Stations(StationsArgs),
    /// Recorded people who reach for places: which place, where the arm will be, where they look.
    Picks(PicksArgs),
    /// Simulated people who fetch objects: which one, by published nets (Petković 2021, chapter 5).
    Objects(ObjectsArgs),
    /// A robot arm beside a person who places things: stated against sampled overlap, and choices by it (Liu and
    /// Jebelli).
    Overlap(OverlapArgs),
    /// A robot arm and a person at twelve targets: by turns, reacting, predicting (Lyu et al.).
    Bolts(BoltsArgs),
    /// Planners of an arm's ways, dropout as spread, smoothness (Liu et al.).
    Planners(PlannersArgs),
    /// Robots that leave the line of a lane to pass a worker (Ye et al., dynamic windows), and robots that wait.
    Corridor(CorridorArgs),
}

/// The stories.
#[derive(Clone, Copy, ValueEnum)]
enum StoryArgument {
    /// Three goals on tiles, a change of mind, a dead end.
    Grid,
    /// The laboratory; a robot closes the way.
    Lab,
    /// A large hall with 24 robots; a goal is added.
    Hall,
}

/// The recognisers.
#[derive(Clone, Copy, ValueEnum)]
enum MethodArgument {
    /// Petković 2021, chapter 3: goals, undecided, elsewhere.
    Chapter3,
    /// Petković 2021, chapter 4: goals only.
    Chapter4,
    /// Ours: metres of detour.
    Detour,
}

/// Arguments of `experiment story`.
#[derive(Args)]
pub struct StoryArgs {
    /// Which story.
    #[arg(value_enum)]
    tale: StoryArgument,
    /// Which recogniser; the story on tiles has its own.
    #[arg(long, value_enum, default_value = "chapter3")]
    method: MethodArgument,
    /// Seed of the robots in the hall.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON: all beliefs over time.
    #[arg(long)]
    json: bool,
    /// Draw probabilities over time into this SVG file.
    #[arg(long)]
    svg: Option<PathBuf>,
}

impl Experiment {
    /// Runs it.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        match self {
            Experiment::Story(story) => story.run(),
            Experiment::Table(table) => table.run(),
            Experiment::Price(price) => price.run(),
            Experiment::Detection(detection) => detection.run(),
            Experiment::Forecast(forecast) => forecast.run(),
            Experiment::Intention(purpose) => purpose.run(),
            Experiment::Meetings(encounters) => encounters.run(),
            Experiment::Alarms(alarms) => alarms.run(),
            Experiment::SafeSpace(spaces) => spaces.run(),
            Experiment::Stations(stations) => stations.run(),
            Experiment::Picks(picks) => picks.run(),
            Experiment::Objects(objects) => objects.run(),
            Experiment::Overlap(overlap) => overlap.run(),
            Experiment::Bolts(bolts) => bolts.run(),
            Experiment::Planners(planners) => planners.run(),
            Experiment::Corridor(corridor) => corridor.run(),
        }
    }
}

impl StoryArgs {
    fn run(self) -> anyhow::Result<ExitCode> {
        let tale = match self.tale {
            StoryArgument::Grid => StoryKind::Grid,
            StoryArgument::Lab => StoryKind::Lab,
            StoryArgument::Hall => StoryKind::Hall,
        };
        let method = match self.method {
            MethodArgument::Chapter3 => Method::Chapter3,
            MethodArgument::Chapter4 => Method::Chapter4,
            MethodArgument::Detour => Method::Detour,
        };
        let story = tale.tell(method, self.seed);
        if let Some(path) = &self.svg {
            write(Some(path), &story.chart().to_svg())?;
        }
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report(&story))?);
        } else {
            table(&story);
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn report(story: &stories::Story) -> Value {
    let name = |id: u64| story.goals[id as usize].0;
    let goals = |b: &giveway_people::human::Belief| {
        b.goals.iter().map(|(g, p)| (name(g.0).to_string(), json!(p))).collect::<serde_json::Map<_, _>>()
    };
    let beliefs: Vec<Value> = (story.beliefs.iter())
        .map(|(t, b)| json!({"at": t, "goals": goals(b), "undecided": b.undecided, "elsewhere": b.elsewhere}))
        .collect();
    let events: Vec<Value> = story.events.iter().map(|e| json!({"at": e.at, "what": e.what})).collect();
    json!({"title": story.title, "method": story.subtitle, "unit": story.unit, "events": events, "beliefs": beliefs})
}

/// The belief at each event and at the end.
fn table(story: &stories::Story) {
    println!("{}\n{}\n", story.title, story.subtitle);
    let names: Vec<&str> = story.goals.iter().map(|g| g.0.split(' ').next().unwrap_or(g.0)).collect();
    let names: Vec<String> = match names.iter().all(|n| *n == names[0]) {
        true => (1..=names.len()).map(|i| format!("{} {i}", names[0])).collect(),
        false => names.iter().map(|n| n.to_string()).collect(),
    };
    let heads: String = names.iter().map(|n| format!("{n:>8}")).collect();
    println!("{:>8}{heads}  undecided  elsewhere", story.unit);
    let end = story.beliefs.last().map_or(0.0, |b| b.0);
    let rows = story.events.iter().map(|e| (e.at, e.what.as_str())).chain([(end, "the end")]);
    for (at, what) in rows {
        let belief = story.at(at);
        let cells: String = (0..names.len() as u64)
            .map(|g| format!("{:8.2}", belief.of(giveway_floor::id::GoalId(g))))
            .collect();
        println!("{at:8.1}{cells}{:11.2}{:11.2}  {what}", belief.undecided, belief.elsewhere);
    }
}

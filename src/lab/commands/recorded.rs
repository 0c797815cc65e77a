//! `giveway experiment forecast`, `intention`, `meetings`: predictions of recorded people, scored.
//!
//! Main types: [`ForecastArgs`], [`PurposeArgs`]. Refuses: to hide the tracks that the model was learned from: the
//! report names them.

use super::learn::{FormatArgument, read_goals, read_tracks};
use super::write;
use crate::learning::RECORDED_M;
use crate::plot::{LineChart, Series};
use crate::recorded::forecasting::{self, ForecastScore, LEVELS, Predictor};
use crate::recorded::meetings::{MeetingReplay, Meetings, RuleScore, StatedRisk, THRESHOLDS};
use crate::recorded::purposes::{self, BEFORE_S, PARTS, PurposeScore, Recogniser};
use crate::recorded::{Degrade, PREDICTED, RecordedWalks, STEP_S, Stretch, TrackPoint, Trip, scored, trips};
use clap::Args;
use giveway::cli::files::read_model;
use giveway_floor::geometry::Point;
use giveway_people::human::{Method, Model};
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// What both experiments read.
#[derive(Args)]
struct TrackSource {
    /// Recorded tracks.
    #[arg(long)]
    tracks: PathBuf,
    /// Their format; told by the first line if absent.
    #[arg(long, value_enum)]
    format: Option<FormatArgument>,
    /// Places where people go: CSV of name, x, y.
    #[arg(long)]
    goals: Option<PathBuf>,
    /// What was learned about people; the built-in figures if absent.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Seed of the noise in worse views.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Leave out the worse views (other rates, noise, losses, gaps).
    #[arg(long)]
    no_degraded: bool,
    /// Draw charts into files whose names begin with this.
    #[arg(long, value_name = "PREFIX")]
    svg: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `experiment forecast`.
#[derive(Args)]
pub struct ForecastArgs {
    #[command(flatten)]
    source: TrackSource,
}

/// Arguments of `experiment intention`.
#[derive(Args)]
pub struct PurposeArgs {
    #[command(flatten)]
    source: TrackSource,
}

/// Arguments of `experiment meetings`.
#[derive(Args)]
pub struct EncountersArgs {
    #[command(flatten)]
    source: TrackSource,
    /// Robots beside each person.
    #[arg(long, default_value_t = 8)]
    robots: usize,
}

impl EncountersArgs {
    /// Replays people among robots and prints which robots would have braked.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let case = self.source.read()?;
        anyhow::ensure!((1..=1000).contains(&self.robots), "--robots must be from 1 to 1000");
        let mut report = case.header();
        let outcomes = MeetingReplay::of_speeds(self.robots, case.seed)
            .map(|replay| outcome(&replay, &replay.run(&case.recording, &case.goals, &case.model)));
        report["runs"] = outcomes.to_vec().into();
        println!("{}", serde_json::to_string_pretty(&report)?);
        Ok(ExitCode::SUCCESS)
    }
}

/// Figures of one speed.
fn outcome(replay: &MeetingReplay, found: &Meetings) -> Value {
    let score = |j: &RuleScore| {
        let share = |n: u64, of: u64| (of > 0).then(|| n as f64 / of as f64);
        json!({
            "missed": j.missed,
            "missed_share": share(j.missed, found.meetings),
            "alarm_share_of_looks": share(j.alarms, found.looks),
            "false_share_of_alarms": share(j.false_alarms, j.alarms),
            "false_share_of_looks": share(j.false_alarms, found.looks),
        })
    };
    let by_threshold = THRESHOLDS.iter().zip(&found.by_threshold);
    let thresholds: Map<String, Value> = by_threshold.map(|(t, j)| (format!("{t}"), score(j))).collect();
    let mean = |s: &StatedRisk| {
        let share = |sum: f64| (s.looks > 0).then(|| sum / s.looks as f64);
        json!({"looks": s.looks, "said": share(s.stated), "came": share(s.came as f64)})
    };
    let said: Vec<Value> = found.said.iter().map(mean).collect();
    json!({
        "speed_mps": replay.speed_mps,
        "lead_s": replay.lead_s,
        "meetings": found.meetings,
        "looks": found.looks,
        "thresholds": thresholds,
        "distance": score(&found.by_distance),
        "said_and_came": said,
    })
}

/// Everything that was read from files.
struct RecordedCase {
    recording: RecordedWalks,
    stretches: Vec<Stretch>,
    goals: Vec<Point>,
    trips: Vec<Trip>,
    model: Arc<Model>,
    seed: u64,
}

/// A view of the samples: all of them, or a worse view.
type SampleView = Option<Degrade>;

impl TrackSource {
    fn read(&self) -> anyhow::Result<RecordedCase> {
        let recording = read_tracks(&self.tracks, self.format)?;
        let goals: Vec<Point> = read_goals(self.goals.as_deref())?.into_iter().map(|g| g.1).collect();
        let (stretches, trips) = (scored(&recording), trips(&recording, &goals));
        Ok(RecordedCase {
            recording,
            stretches,
            goals,
            trips,
            model: read_model(self.model.as_deref())?,
            seed: self.seed,
        })
    }

    /// The recording as it is, and worse views of it.
    fn views(&self) -> Vec<SampleView> {
        let worse = if self.no_degraded { &[] } else { &Degrade::ALL[..] };
        std::iter::once(None).chain(worse.iter().copied().map(Some)).collect()
    }

    fn draw(&self, name: &str, chart: &LineChart) -> anyhow::Result<()> {
        let Some(prefix) = &self.svg else { return Ok(()) };
        let mut path = prefix.clone().into_os_string();
        path.push(format!("-{name}.svg"));
        write(Some(&PathBuf::from(path)), &chart.to_svg())
    }
}

impl RecordedCase {
    fn sigma_m(view: SampleView) -> f64 {
        view.map_or(RECORDED_M, |d| d.noise_m.max(RECORDED_M))
    }

    /// The view of each stretch or trip; the same for every model.
    fn seen(&self, view: SampleView) -> impl FnMut(&[TrackPoint]) -> Vec<TrackPoint> {
        let mut seed = self.seed;
        move |samples| {
            seed += 1;
            view.map_or_else(|| samples.to_vec(), |d| d.apply(samples, seed))
        }
    }

    fn forecast(&self, predictor: Predictor, view: SampleView) -> ForecastScore {
        let RecordedCase { recording, stretches, goals, model, .. } = self;
        forecasting::score(
            recording,
            stretches,
            goals,
            model,
            predictor,
            RecordedCase::sigma_m(view),
            self.seen(view),
        )
    }

    fn purpose(&self, recogniser: Recogniser, view: SampleView) -> PurposeScore {
        let RecordedCase { recording, trips, goals, model, .. } = self;
        purposes::score(
            recording,
            trips,
            goals,
            model,
            recogniser,
            RecordedCase::sigma_m(view),
            self.seen(view),
        )
    }

    fn header(&self) -> Value {
        json!({
            "walks": self.recording.walks.len(),
            "windows": self.stretches.len(),
            "goals": self.goals.len(),
            "trips": self.trips.len(),
            "model_learned_from": self.model.learned_from,
        })
    }
}

/// A view in words, for the report.
fn view_words(view: SampleView) -> Value {
    view.map_or(
        Value::Null,
        |d| json!({"rate_hz": d.rate_hz, "noise_m": d.noise_m, "loss": d.loss, "gap_s": d.gap_s}),
    )
}

/// A horizon as the report names it.
fn horizon(i: usize) -> String {
    format!("{:.1}", STEP_S * (i + 1) as f64)
}

fn by_horizon(values: &[f64; PREDICTED]) -> Value {
    values.iter().enumerate().map(|(i, v)| (horizon(i), json!(v))).collect::<Map<_, _>>().into()
}

fn forecast_json(s: &ForecastScore) -> Map<String, Value> {
    let mut report = Map::new();
    let mut put = |key: &str, value: Value| report.insert(key.to_owned(), value);
    put("ade", json!(s.ade));
    put("fde", json!(s.fde));
    put("error", by_horizon(&s.errors));
    put("nll", json!(s.nll));
    for (level, covered) in LEVELS.iter().zip(&s.covered) {
        put(&format!("cov{:.0}", level * 100.0), by_horizon(covered));
    }
    put("cov95_throughout", json!(s.covered_throughout));
    put("area95_m2", by_horizon(&s.area95));
    let classes = ["standing", "slow", "walking", "brisk"].iter().zip(&s.by_class);
    let class = |(share, n): &(f64, usize)| json!({"cov95": (*n > 0).then_some(share), "windows": n});
    put("by_speed", classes.map(|(name, c)| ((*name).to_owned(), class(c))).collect::<Map<_, _>>().into());
    report
}

fn purpose_json(s: &PurposeScore) -> Map<String, Value> {
    let parts = PARTS.iter().zip(&s.top1).map(|(p, v)| (format!("{:.0}", p * 100.0), json!(v)));
    let before = BEFORE_S.iter().zip(&s.top1_before).map(|(p, v)| (format!("{p:.1}"), json!(v)));
    let bins = s.reliability.iter().map(|(share, said, right)| json!([share, said, right]));
    let mut report = Map::new();
    let mut put = |key: &str, value: Value| report.insert(key.to_owned(), value);
    put("goal_top1", parts.collect::<Map<_, _>>().into());
    put("goal_top1_seconds_before", before.collect::<Map<_, _>>().into());
    put("goal_top1_samples", json!(s.top1_of_samples));
    put("goal_nll", json!(s.nll));
    put("goal_brier", json!(s.brier));
    put("goal_ece", json!(s.ece));
    put("goal_miss5", json!(s.miss5));
    put("goal_set", json!(s.set));
    put("goal_reliability", bins.collect::<Vec<_>>().into());
    report
}

/// Adds fields to a model's entry.
fn add(models: &mut Map<String, Value>, name: &str, fields: Map<String, Value>) {
    let entry = models.entry(name).or_insert_with(|| json!({}));
    entry.as_object_mut().expect("entries are objects").extend(fields);
}

impl ForecastArgs {
    /// Scores all predictors and prints the table.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let case = self.source.read()?;
        anyhow::ensure!(!case.stretches.is_empty(), "the recording has no stretch of 20 steps without a gap");
        let mut report = case.header();
        let mut degraded = Vec::new();
        for view in self.source.views() {
            let mut models = Map::new();
            for predictor in Predictor::ALL {
                let needs_goals = matches!(
                    predictor,
                    Predictor::Thesis | Predictor::ByHand | Predictor::Heading | Predictor::Free
                );
                let main = matches!(predictor, Predictor::Giveway | Predictor::Constant);
                if (needs_goals && case.goals.is_empty()) || (view.is_some() && !main) {
                    continue;
                }
                let score = case.forecast(predictor, view);
                if view.is_none() && predictor == Predictor::Giveway {
                    self.source.draw("coverage", &coverage_chart(&score))?;
                }
                add(&mut models, predictor.word(), forecast_json(&score));
            }
            goal_scores(&case, view, &mut models);
            match view {
                None => report["models"] = models.into(),
                Some(_) => degraded.push(json!({"view": view_words(view), "models": models})),
            }
        }
        report["degraded"] = degraded.into();
        finish(&self.source, &report)
    }
}

impl PurposeArgs {
    /// Scores all recognisers and prints the table.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let case = self.source.read()?;
        anyhow::ensure!(!case.goals.is_empty(), "name the places where people go: --goals FILE");
        anyhow::ensure!(
            !case.trips.is_empty(),
            "nobody in the recording walks from one of the goals to another"
        );
        let mut report = case.header();
        let mut degraded = Vec::new();
        for view in self.source.views() {
            let mut models = Map::new();
            goal_scores(&case, view, &mut models);
            match view {
                None => report["models"] = models.into(),
                Some(_) => degraded.push(json!({"view": view_words(view), "models": models})),
            }
        }
        report["degraded"] = degraded.into();
        if self.source.svg.is_some() {
            self.source.draw("goals", &goal_chart(&case))?;
        }
        finish(&self.source, &report)
    }
}

/// Adds scores of goals, if there are goals: of all recognisers for the plain view, of those with memory for worse
/// views.
fn goal_scores(case: &RecordedCase, view: SampleView, models: &mut Map<String, Value>) {
    if case.trips.is_empty() {
        return;
    }
    for recogniser in Recogniser::ALL {
        if view.is_none() || matches!(recogniser, Recogniser::Method(Method::Detour | Method::Chapter4)) {
            add(models, recogniser.word(), purpose_json(&case.purpose(recogniser, view)));
        }
    }
}

fn finish(source: &TrackSource, report: &Value) -> anyhow::Result<ExitCode> {
    if source.json {
        println!("{}", serde_json::to_string_pretty(report)?);
    } else {
        print(report);
    }
    Ok(ExitCode::SUCCESS)
}

fn print(report: &Value) {
    println!(
        "{} windows of 20 steps, {} trips between {} goals; the model was learned from {}",
        report["windows"], report["trips"], report["goals"], report["model_learned_from"]
    );
    table("", &report["models"]);
    for worse in report["degraded"].as_array().into_iter().flatten() {
        let v = &worse["view"];
        let title = format!(
            "at {} Hz with {} m of noise, {} lost, gaps to {} s",
            v["rate_hz"], v["noise_m"], v["loss"], v["gap_s"]
        );
        table(&title, &worse["models"]);
    }
}

fn table(title: &str, models: &Value) {
    println!("\n{title}");
    println!(
        "{:24}{:>7}{:>7}{:>8}{:>7}{:>7}{:>7}  {:>24}{:>8}{:>7}{:>7}",
        "",
        "ADE",
        "FDE",
        "NLL",
        "95@0.8",
        "95@2.0",
        "95@4.8",
        "top-1 at 10/30/50/70/90 %",
        "NLL",
        "ECE",
        "miss5"
    );
    for (name, m) in models.as_object().into_iter().flatten() {
        let cell = |v: &Value, width: usize| {
            v.as_f64().map_or_else(|| " ".repeat(width), |x| format!("{x:>width$.3}"))
        };
        let top1: Vec<String> = (m["goal_top1"].as_object().into_iter().flatten())
            .map(|(_, v)| format!("{:.0}", 100.0 * v.as_f64().unwrap_or(0.0)))
            .collect();
        println!(
            "{name:24}{}{}{}{}{}{}  {:>25}{}{}{}",
            cell(&m["ade"], 7),
            cell(&m["fde"], 7),
            cell(&m["nll"], 8),
            cell(&m["cov95"]["0.8"], 7),
            cell(&m["cov95"]["2.0"], 7),
            cell(&m["cov95"]["4.8"], 7),
            top1.join("/"),
            cell(&m["goal_nll"], 8),
            cell(&m["goal_ece"], 7),
            cell(&m["goal_miss5"], 7),
        );
    }
}

/// Colours of the lines: those of the other charts.
const COLOURS: [&str; 4] = ["#2f6fde", "#d9822b", "#2e9e5b", "#8a4fbf"];

/// Chart of the share of people within the stated regions over the horizon.
fn coverage_chart(score: &ForecastScore) -> LineChart {
    let line = |(i, level): (usize, &f64)| {
        let points = (0..PREDICTED).map(|h| (STEP_S * (h + 1) as f64, score.covered[i][h])).collect();
        Series { label: format!("stated {:.0} %", level * 100.0), colour: COLOURS[i], points }
    };
    LineChart {
        title: "How many people were where the forecast said".into(),
        subtitle: format!("share within the stated regions, {} windows", score.stretches),
        x: "seconds ahead".into(),
        y: "share of people".into(),
        range: (0.0, 1.0),
        series: LEVELS.iter().enumerate().map(line).collect(),
        marks: Vec::new(),
    }
}

/// Chart of right goals along the way, by recogniser.
fn goal_chart(case: &RecordedCase) -> LineChart {
    let shown = [
        (Recogniser::Method(Method::Detour), "ours"),
        (Recogniser::Method(Method::Chapter4), "thesis, chapter 4"),
        (Recogniser::Heading, "heading alone"),
        (Recogniser::Nearest, "nearest goal"),
    ];
    let line = |(i, (recogniser, label)): (usize, &(Recogniser, &str))| {
        let score = case.purpose(*recogniser, None);
        let points = PARTS.iter().zip(&score.top1).map(|(p, v)| (100.0 * p, *v)).collect();
        Series { label: (*label).into(), colour: COLOURS[i], points }
    };
    LineChart {
        title: "Whose goal was known, and when".into(),
        subtitle: format!("share of {} trips with the right goal on top", case.trips.len()),
        x: "percent of the way".into(),
        y: "share of trips".into(),
        range: (0.0, 1.0),
        series: shown.iter().enumerate().map(line).collect(),
        marks: Vec::new(),
    }
}

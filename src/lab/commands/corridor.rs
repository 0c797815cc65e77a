//! `giveway experiment corridor`: robots that leave the line to pass a worker, against robots that wait on it.
//!
//! Main type: [`CorridorArgs`]. Refuses: to compute anything itself.

use super::corridor_hall;
use crate::corridor::{
    CorridorArm, CorridorFigures, CorridorReport, CorridorRun, HallSetup, SceneKind, by_angle, corridor,
};
use crate::statistics::Interval;
use clap::Args;
use serde_json::{Map, Value, json};
use std::process::ExitCode;

/// Arguments of `experiment corridor`.
#[derive(Args)]
pub struct CorridorArgs {
    /// So many scenes of each kind.
    #[arg(long, default_value_t = 30)]
    runs: u64,
    /// Seed of scenes, workers and sensors.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Also cross an aisle at five angles with four speeds, so many times each.
    #[arg(long, default_value_t = 0)]
    angles: u64,
    /// A hall of robots that leave the line to pass people, against the same robots on lines.
    #[arg(long, conflicts_with = "angles")]
    hall: bool,
    /// So many robots in the hall.
    #[arg(long, default_value_t = 8, requires = "hall")]
    robots: usize,
    /// So many people in the hall.
    #[arg(long, default_value_t = 5, requires = "hall")]
    workers: usize,
    /// How long a run in the hall is, seconds.
    #[arg(long, default_value_t = 1200.0, requires = "hall")]
    seconds: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Pairs of arms to compare.
const PAIRS: [(CorridorArm, CorridorArm); 4] = [
    (CorridorArm::Improved, CorridorArm::Traditional),
    (CorridorArm::Improved, CorridorArm::TraditionalEqual),
    (CorridorArm::Improved, CorridorArm::Stop),
    (CorridorArm::Traditional, CorridorArm::Stop),
];

/// A figure of a run with its key in the report.
type Figure = (&'static str, fn(&CorridorRun) -> f64);
/// Figures to compare run by run.
const FIGURES: [Figure; 3] =
    [("path_m", |r| r.path_m), ("time_s", |r| r.time_s), ("closest_m", |r| r.closest_m)];

impl CorridorArgs {
    /// Drives all scenes and prints the results. A broken law is a failure.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!((2..=1000).contains(&self.runs), "--runs must be from 2 to 1000");
        anyhow::ensure!(self.angles <= 1000, "--angles must be from 0 to 1000");
        if self.hall {
            return self.hall();
        }
        let report = corridor(self.seed, self.runs);
        let table = if self.angles > 0 { by_angle(self.seed, self.angles) } else { Vec::new() };
        let in_table = table.iter().flat_map(|(_, _, arms)| arms.iter().flatten());
        let violations = report.law_violations() + in_table.map(|r| r.violations).sum::<u32>();
        if self.json {
            let mut all = scenes(&report, &SceneKind::CASES);
            all.insert("aisles".into(), Value::Object(scenes(&report, &SceneKind::AISLES)));
            let kinds = SceneKind::CASES.into_iter().chain(SceneKind::AISLES);
            let by_scene = kinds.map(|k| (k.name().to_owned(), Value::Object(arms(&report, &[k]))));
            all.insert("scenes".into(), by_scene.collect::<Map<_, _>>().into());
            if !table.is_empty() {
                all.insert("angles".into(), table.iter().map(cell).collect());
            }
            all.insert("runs".into(), self.runs.into());
            all.insert("seed".into(), self.seed.into());
            all.insert("law_violations".into(), violations.into());
            println!("{}", serde_json::to_string_pretty(&all)?);
        } else {
            println!("giveway experiment corridor --runs {} --seed {}\n", self.runs, self.seed);
            print_scenes(&report);
            print_table(&table);
            println!("\nlaw violations: {violations}");
        }
        Ok(if violations == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

impl CorridorArgs {
    fn hall(self) -> anyhow::Result<ExitCode> {
        let CorridorArgs { robots, workers, seconds, .. } = self;
        anyhow::ensure!(
            (1..=12).contains(&robots),
            "--robots must be from 1 to 12: the hall has room for so many"
        );
        anyhow::ensure!((1..=30).contains(&workers), "--workers must be from 1 to 30");
        anyhow::ensure!((60.0..=1e6).contains(&seconds), "--seconds must be from 60 to 1000000");
        corridor_hall::run(HallSetup { robots, workers, seconds }, self.seed, self.runs, self.json)
    }
}

/// Results of arms and pairs over some kinds of scenes.
fn scenes(report: &CorridorReport, kinds: &[SceneKind]) -> Map<String, Value> {
    let paired = PAIRS.map(|(ours, theirs)| {
        let all = FIGURES.map(|(key, f)| (key, interval(report.paired(kinds, ours, theirs, f))));
        let mut all: Map<String, Value> = all.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
        all.insert("path_relative".into(), json!(round(relative(report, kinds, ours, theirs))));
        (format!("{}-{}", ours.name(), theirs.name()), Value::Object(all))
    });
    let mut both = Map::new();
    both.insert("arms".into(), Value::Object(arms(report, kinds)));
    both.insert("paired".into(), paired.into_iter().collect::<Map<_, _>>().into());
    both
}

fn arms(report: &CorridorReport, kinds: &[SceneKind]) -> Map<String, Value> {
    let one = |arm: CorridorArm| (arm.name().to_owned(), figures(&report.of(kinds, arm)));
    CorridorArm::ALL.into_iter().map(one).collect()
}

/// How much longer the paths of one arm are than those of another, as a share of the latter.
fn relative(report: &CorridorReport, kinds: &[SceneKind], ours: CorridorArm, theirs: CorridorArm) -> f64 {
    let path = |arm| CorridorFigures::of(&report.of(kinds, arm)).path_m;
    path(ours) / path(theirs) - 1.0
}

fn figures(runs: &[CorridorRun]) -> Value {
    let f = CorridorFigures::of(runs);
    json!({
        "path_m": round(f.path_m), "time_s": round(f.time_s), "closest_m": round(f.closest_m),
        "behind": f.behind.map(round), "reached": round(f.reached), "own_stops": round(f.own_stops),
    })
}

fn interval(i: Interval) -> Value {
    json!({"mean": i.mean.map(round), "ci95": i.ci95.map(|(low, high)| [round(low), round(high)])})
}

fn cell((degrees, walks, arms): &(f64, f64, [Vec<CorridorRun>; 4])) -> Value {
    let of = CorridorArm::ALL.into_iter().zip(arms).map(|(a, runs)| (a.name().to_owned(), figures(runs)));
    json!({"angle_deg": degrees, "walking_mps": walks, "arms": of.collect::<Map<_, _>>()})
}

fn round(x: f64) -> f64 {
    (x * 10_000.0).round() / 10_000.0
}

fn print_scenes(report: &CorridorReport) {
    println!("scene      arm                  path m   time s  closest m  behind  reached  own stops");
    for kind in SceneKind::CASES.into_iter().chain(SceneKind::AISLES) {
        for arm in CorridorArm::ALL {
            print_row(kind.name(), arm, &report.of(&[kind], arm));
        }
    }
    for (name, kinds) in [("cases", &SceneKind::CASES[..]), ("aisles", &SceneKind::AISLES)] {
        println!();
        CorridorArm::ALL.into_iter().for_each(|arm| print_row(name, arm, &report.of(kinds, arm)));
        for (ours, theirs) in PAIRS {
            let pair = format!("{} − {}", ours.name(), theirs.name());
            print!("{name:<11}{pair:<30}");
            for (key, f) in FIGURES {
                let i = report.paired(kinds, ours, theirs, f);
                let (mean, (low, high)) =
                    (i.mean.unwrap_or(f64::NAN), i.ci95.unwrap_or((f64::NAN, f64::NAN)));
                print!(" {key} {mean:+.2} ({low:+.2} to {high:+.2})");
            }
            println!(" path {:+.1} %", 100.0 * relative(report, kinds, ours, theirs));
        }
    }
}

fn print_row(name: &str, arm: CorridorArm, runs: &[CorridorRun]) {
    let f = CorridorFigures::of(runs);
    let behind = f.behind.map_or_else(|| "–".into(), |b| format!("{b:.2}"));
    print!("{name:<11}{:<18}{:9.2}{:9.1}{:11.2}", arm.name(), f.path_m, f.time_s, f.closest_m);
    println!("{behind:>8}{:9.2}{:11.2}", f.reached, f.own_stops);
}

fn print_table(table: &[(f64, f64, [Vec<CorridorRun>; 4])]) {
    if table.is_empty() {
        return;
    }
    println!(
        "\nangle  walking | path m and time s: stop, traditional, improved | behind: traditional, improved"
    );
    for (degrees, walks, arms) in table {
        let [stop, traditional, _, improved] = arms.each_ref().map(|runs| CorridorFigures::of(runs));
        print!("{degrees:4.0}°  {walks:.1} m/s |");
        for f in [stop, traditional, improved] {
            print!(" {:6.2} {:5.1} ", f.path_m, f.time_s);
        }
        let share = |f: CorridorFigures| f.behind.map_or_else(|| "–".into(), |b| format!("{b:.2}"));
        println!("| {} {}", share(traditional), share(improved));
    }
}

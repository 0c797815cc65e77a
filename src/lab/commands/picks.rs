//! `giveway experiment picks` and `giveway learn picks`: people who reach for places.
//!
//! Main types: [`PicksArgs`], [`LearnPicksArgs`]. Refuses: folders with missing or bad tables, by file and line.

use super::{in_parallel, read, write};
use crate::learning::picks::{
    END_COURSE, LearnedPicks, PickCourse, PickLessons, SIMULATED_COURSE, learn_picks, simulated_lessons,
};
use crate::picks::{
    ARM_LOOK_WORDS, ARM_WORDS, ArmScore, PARTS, PickRecording, PickReport, PickTexts, SlotChoice, SlotScore,
    fold, folds, report, with_model,
};
use anyhow::Context;
use clap::{Args, ValueEnum};
use giveway_people::reach::model::PickModel;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Word for the built-in model, in place of a file.
const BUILTIN: &str = "builtin";

/// Which places are candidates.
#[derive(Clone, Copy, ValueEnum)]
enum SlotsArgument {
    /// The nearest place of each direction.
    Near,
    /// All places, also those behind one another.
    All,
}

/// Arguments of `experiment picks`.
#[derive(Args)]
pub struct PicksArgs {
    /// Folder with moves.csv, samples.csv, targets.csv, slots.csv and gaze.csv.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// A model that was learned elsewhere, or `builtin`. Without it, people are left out two at a time.
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Which places are candidates.
    #[arg(long, value_enum, default_value = "near")]
    slots: SlotsArgument,
    /// Seed of what is learned.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Arguments of `learn picks`.
#[derive(Args)]
pub struct LearnPicksArgs {
    /// Folders of recordings, as for `experiment picks`.
    #[arg(required_unless_present = "simulated", conflicts_with = "simulated")]
    folders: Vec<PathBuf>,
    /// Learn from so many simulated pickers instead.
    #[arg(long, value_name = "PICKERS")]
    simulated: Option<usize>,
    /// Seed of what is learned, and of simulated pickers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where to write what was learned.
    #[arg(long)]
    out: PathBuf,
}

/// Reads the tables of a folder.
fn read_recording(folder: &Path) -> anyhow::Result<PickRecording> {
    let table = |name: &str| read(&folder.join(name));
    let texts = PickTexts {
        moves: table("moves.csv")?,
        samples: table("samples.csv")?,
        targets: table("targets.csv")?,
        slots: table("slots.csv")?,
        gaze: table("gaze.csv")?,
    };
    PickRecording::parse(&texts).with_context(|| format!("{} is refused", folder.display()))
}

/// Reads a file of `learn picks`, or takes the built-in one.
fn read_learned(path: &Path) -> anyhow::Result<LearnedPicks> {
    if path.as_os_str() == BUILTIN {
        return Ok(LearnedPicks { model: PickModel::clone(&PickModel::builtin()), published: None });
    }
    LearnedPicks::parse(&read(path)?).with_context(|| format!("{} is refused", path.display()))
}

impl PicksArgs {
    /// Predicts and prints.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let recording = read_recording(&self.data)?;
        let slots = match self.slots {
            SlotsArgument::Near => SlotChoice::Near,
            SlotsArgument::All => SlotChoice::All,
        };
        let candidates = recording.candidates(slots).len();
        anyhow::ensure!(
            candidates > 1,
            "targets.csv has {candidates} places of that kind; at least two are needed"
        );
        let parts = match &self.model {
            Some(path) => {
                let learned = read_learned(path)?;
                let known = recording.people.iter().filter(|p| learned.model.people.contains(p)).count();
                if known > 0 {
                    eprintln!("note: {known} of the people may be those that the model was learned from");
                }
                vec![with_model(&recording, slots, &learned)]
            }
            None => {
                let people = recording.people.len();
                anyhow::ensure!(people > 4, "{people} people are too few to leave two out: give --model");
                let course = PickCourse {
                    seed: self.seed,
                    command: String::new(),
                    ends: END_COURSE,
                    published: true,
                    drawn: PickModel::builtin().gaze.drawn,
                };
                in_parallel(folds(&recording), None, |f| fold(&recording, slots, f, &course, |_| ()))
            }
        };
        let report = report(&recording, parts);
        if self.json {
            println!("{}", serde_json::to_string_pretty(&self.value(&report))?);
        } else {
            self.print(&report);
        }
        Ok(ExitCode::SUCCESS)
    }

    fn word(&self) -> &'static str {
        match self.slots {
            SlotsArgument::Near => "near",
            SlotsArgument::All => "all",
        }
    }

    fn value(&self, report: &PickReport) -> Value {
        let models: Map<String, Value> =
            report.models.iter().map(|(word, score)| ((*word).to_owned(), slot_value(score))).collect();
        let arm: Map<String, Value> =
            report.arm.iter().map(|(word, score)| ((*word).to_owned(), arm_value(score))).collect();
        let angles =
            |(median, p90): &(f64, f64)| json!({"median_deg": round(*median), "p90_deg": round(*p90)});
        let gaze: Map<String, Value> =
            report.gaze.iter().map(|(word, of)| ((*word).to_owned(), angles(of))).collect();
        json!({
            "slots": self.word(),
            "people": report.people,
            "movements": report.movements,
            "seed": self.seed,
            "model": self.model,
            "models": models,
            "arm": arm,
            "gaze": gaze,
        })
    }

    fn print(&self, report: &PickReport) {
        let model = self.model.as_ref().map(|m| format!(" --model {}", m.display())).unwrap_or_default();
        let (data, slots, seed) = (self.data.display(), self.word(), self.seed);
        println!("giveway experiment picks --data {data}{model} --slots {slots} --seed {seed}");
        println!("{} people, {} movements\n", report.people, report.movements);
        let heads: String = PARTS.iter().map(|p| format!("{p:>4}")).collect();
        println!("right place, % at % of the way {heads}   mean   (5.1)    NLL    ECE  miss5");
        for (word, s) in &report.models {
            let shares: String = s.top1.iter().map(|t| format!("{:4.0}", t * 100.0)).collect();
            print!("{word:<31}{shares}{:7.3}{:8.3}", s.top1_mean, s.location_error);
            println!("{:7.3}{:7.3}{:7.3}", s.nll, s.ece, s.miss5);
        }
        println!("\nerror of the arm, mm after 0.08/0.20/0.40 s; share in 95 % regions");
        for (word, score) in &report.arm {
            print!("{word:<10}");
            for (p, part) in ARM_WORDS.iter().enumerate() {
                let [a, b, c] = [0, 1, 2].map(|look| score.error_mm(look, p));
                print!("  {part} {a:.0}/{b:.0}/{c:.0}");
                if let Some(held) = (0..3).map(|look| score.cov95(look, p)).collect::<Option<Vec<f64>>>() {
                    print!(" ({:.2} {:.2} {:.2})", held[0], held[1], held[2]);
                }
            }
            println!();
        }
        println!("\ngaze from the head alone, degrees: median, 90 %");
        for (word, (median, p90)) in &report.gaze {
            println!("{word:<10}{median:7.1}{p90:7.1}");
        }
    }
}

fn slot_value(s: &SlotScore) -> Value {
    let top1: Map<String, Value> =
        PARTS.iter().zip(s.top1).map(|(part, share)| (part.to_string(), round(share))).collect();
    json!({
        "top1": top1, "top1_mean": round(s.top1_mean), "location_error": round(s.location_error),
        "nll": round(s.nll), "ece": round(s.ece), "miss5": round(s.miss5),
    })
}

fn arm_value(score: &ArmScore) -> Value {
    let by_look = |of: &dyn Fn(usize) -> Value| -> Map<String, Value> {
        ARM_LOOK_WORDS.iter().enumerate().map(|(look, word)| ((*word).to_owned(), of(look))).collect()
    };
    let by_part = |of: &dyn Fn(usize, usize) -> Value| -> Map<String, Value> {
        let part = |(p, word): (usize, &&str)| ((*word).to_owned(), by_look(&|look| of(look, p)).into());
        ARM_WORDS.iter().enumerate().map(part).collect()
    };
    let mut value = json!({
        "windows": score.windows, "error_mm": by_part(&|look, p| round(score.error_mm(look, p))),
    });
    if score.cov95(0, 0).is_some() {
        value["cov95"] = by_part(&|look, p| score.cov95(look, p).map_or(Value::Null, round)).into();
    }
    value
}

fn round(x: f64) -> Value {
    json!((x * 10_000.0).round() / 10_000.0)
}

impl LearnPicksArgs {
    /// Learns and writes the model.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let out = self.out.display();
        let (lessons, command, ends, drawn) = match self.simulated {
            Some(pickers) => {
                anyhow::ensure!((8..=2000).contains(&pickers), "--simulated must be from 8 to 2000");
                let (lessons, drawn) = simulated_lessons(pickers, self.seed);
                (lessons, format!("--simulated {pickers}"), SIMULATED_COURSE, drawn)
            }
            None => {
                let named = self.folders.iter().map(|folder| {
                    let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy();
                    Ok((name.into_owned(), read_recording(folder)?))
                });
                let named = named.collect::<anyhow::Result<Vec<_>>>()?;
                let names: Vec<&str> = named.iter().map(|n| n.0.as_str()).collect();
                let lessons = PickLessons::of(&named);
                let people = lessons.people.len();
                anyhow::ensure!(people > 2, "{people} people are too few: some must be left out");
                // No recording has eyes beside hands; simulated people take their place.
                (lessons, names.join(" "), END_COURSE, PickModel::builtin().gaze.drawn)
            }
        };
        let course = PickCourse {
            seed: self.seed,
            command: format!("giveway learn picks {command} --seed {}", self.seed),
            ends,
            published: self.simulated.is_none(),
            drawn,
        };
        let learned = learn_picks(&lessons, &course, |what| eprintln!("learning {what}"));
        write(Some(&self.out), &learned.to_json())?;
        let s = &learned.model.left_out;
        println!("{} --out {out}", learned.model.command);
        println!("learned from {}", learned.model.sources.join(", "));
        println!("people left out: right place {:.3}, NLL {:.3}, ECE {:.3}", s.top1_mean, s.nll, s.ece);
        println!(
            "hand after 0.2 and 0.4 s: {:.0} and {:.0} mm, {:.3} and {:.3} in 95 % regions",
            s.hand_mm[0], s.hand_mm[1], s.hand_cov95[0], s.hand_cov95[1]
        );
        println!("written to {out}");
        Ok(ExitCode::SUCCESS)
    }
}

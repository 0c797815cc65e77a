//! `giveway experiment objects`: which object a simulated person fetches, by the thesis' predictors.
//!
//! Main type: [`ObjectsArgs`]. Refuses: to compute anything itself; it provides the clock for timing frames.

use super::{in_parallel, stopwatch};
use crate::objects::{
    CHANGES, ChangeFigures, FEATURES, FRAMES, FeatureStudy, FrameBench, GroupReport, ObjectGroup, ObjectRow,
    ObjectTable, ObjectsBench, ObjectsCourse, ObjectsReport, RowKind, RowReport, feature_study, rows_of,
};
use crate::statistics::Interval;
use clap::Args;
use serde_json::{Map, Value, json};
use std::process::ExitCode;

/// Remark beside every table.
const SIMULATED: &str = "simulated people: MoGaze and SubMotion are not part of this repository";

/// Arguments of `experiment objects`.
#[derive(Args)]
pub struct ObjectsArgs {
    /// Simulated people in either room.
    #[arg(long, default_value_t = 6)]
    people: usize,
    /// Movements of each person.
    #[arg(long, default_value_t = 100)]
    movements: usize,
    /// Steps of learning of every net.
    #[arg(long, default_value_t = 160)]
    steps: usize,
    /// Seed of people and learning.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Cost of a frame of a row in milliseconds: of the net that was scored, and of one of the published size.
type FrameCost = (Option<f64>, Option<f64>);

impl ObjectsArgs {
    /// Simulates, learns, judges and prints.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!((3..=60).contains(&self.people), "--people must be from 3 to 60");
        anyhow::ensure!((10..=1000).contains(&self.movements), "--movements must be from 10 to 1000");
        anyhow::ensure!((1..=100_000).contains(&self.steps), "--steps must be from 1 to 100000");
        let bench = ObjectsBench::new(ObjectsCourse {
            people: self.people,
            movements: self.movements,
            steps: self.steps,
            seed: self.seed,
        });
        let jobs = bench.jobs();
        let pieces = in_parallel(jobs.len(), None, |i| bench.run(i, jobs[i]));
        let report = ObjectsReport::of(pieces.into_iter().flatten().collect());
        let study = feature_study(&bench.moves(ObjectTable::Shelves));
        let changes = bench.changes();
        // Frames are timed while nothing else of this program runs.
        let costs = ObjectTable::ALL.map(|table| costs_of(&bench, table));
        if self.json {
            let value = self.value(&report, &study, &changes, &costs);
            println!("{}", serde_json::to_string_pretty(&value)?);
        } else {
            self.print(&report, &study, &changes, &costs);
        }
        Ok(ExitCode::SUCCESS)
    }

    fn value(
        &self,
        report: &ObjectsReport,
        study: &FeatureStudy,
        changes: &ChangeFigures,
        costs: &[Vec<FrameCost>; 2],
    ) -> Value {
        let group = |group: ObjectGroup, costs: Option<&[FrameCost]>| {
            report.groups.get(&group).map_or(Value::Null, |g| rows_value(g, costs))
        };
        let paired = |group: ObjectGroup| report.groups.get(&group).map_or(Value::Null, paired_value);
        let tables = |of: &dyn Fn(ObjectTable) -> Value| -> Map<String, Value> {
            ObjectTable::ALL.iter().map(|t| (t.word().to_owned(), of(*t))).collect()
        };
        let by_costs = |t: ObjectTable| Some(&costs[t as usize][..]);
        let estimated = |g: ObjectGroup| {
            let degrees = report.groups.get(&g).and_then(|g| g.degrees);
            let angle =
                |(median, p90): (f64, f64)| json!({"median_deg": round(median), "p90_deg": round(p90)});
            json!({
                "models": group(g, None), "paired": paired(g),
                "gaze_error": degrees.map(|[estimate, head]| {
                    json!({"estimated_gaze": angle(estimate), "head": angle(head)})
                }),
            })
        };
        let mut left_out = tables(&|t| group(ObjectGroup::LeftOut(t), by_costs(t)));
        left_out.insert("paired".into(), tables(&|t| paired(ObjectGroup::LeftOut(t))).into());
        left_out.insert("eg_lstm".into(), estimated(ObjectGroup::EstimatedLeftOut));
        let agrees: Map<String, Value> = [CHANGES[0], CHANGES[2]]
            .iter()
            .zip(changes.agrees_after)
            .map(|(frame, after)| (frame.to_string(), round(after)))
            .collect();
        json!({
            "data": SIMULATED, "people": self.people, "movements": self.movements, "steps": self.steps,
            "seed": self.seed, "frames": FRAMES,
            "tables": tables(&|t| group(ObjectGroup::Within(t), by_costs(t))),
            "paired": tables(&|t| paired(ObjectGroup::Within(t))),
            "eg_lstm": estimated(ObjectGroup::Estimated),
            "people_left_out": left_out,
            "features": study_value(study),
            "goal_changes": {
                "movements": changes.movements, "first_at_end": round(changes.first_at_end),
                "first_at_end_changed": round(changes.first_at_end_changed), "frames_until_agreement": agrees,
            },
        })
    }

    fn print(
        &self,
        report: &ObjectsReport,
        study: &FeatureStudy,
        changes: &ChangeFigures,
        costs: &[Vec<FrameCost>; 2],
    ) {
        let (people, movements, steps, seed) = (self.people, self.movements, self.steps, self.seed);
        print!("giveway experiment objects --people {people} --movements {movements}");
        println!(" --steps {steps} --seed {seed}\n{SIMULATED}");
        for (group, g) in &report.groups {
            let (title, table) = match group {
                ObjectGroup::Within(t) => {
                    (format!("Table {}: folds within every person", t.word()), Some(*t))
                }
                ObjectGroup::LeftOut(t) => (format!("Table {}: people left out", t.word()), Some(*t)),
                ObjectGroup::Estimated => ("EG-LSTM: three parts of every person's movements".into(), None),
                ObjectGroup::EstimatedLeftOut => ("EG-LSTM: three groups of people".into(), None),
            };
            println!("\n{title}");
            println!("{:18}  AUC sum   mean (sd)      error sum   mean (sd)   ms   published", "");
            let rows = table.map(rows_of).unwrap_or_default();
            for (i, row) in g.rows.iter().enumerate() {
                let cost = table.map_or((None, None), |t| costs[t as usize][i]);
                print_row(row, rows.get(i), cost);
            }
            for (a, b, auc, error) in &g.paired {
                println!("{:34} AUC {}   error {}", format!("{a} − {b}"), interval(auc), interval(error));
            }
            if let Some([estimate, head]) = g.degrees {
                print!(
                    "angle to measured gaze, degrees, median and 90 %: estimate {:.1} {:.1}",
                    estimate.0, estimate.1
                );
                println!(", head {:.1} {:.1}", head.0, head.1);
            }
        }
        println!("\nTable 5.1: correlation of features, and share of right answers of each alone");
        for (i, word) in FEATURES.iter().enumerate() {
            let cells: String = study.correlation[i].iter().map(|c| format!("{c:6.2}")).collect();
            println!("{word:20}{cells}   {:.3}", study.merit[i]);
        }
        let selected: Vec<&str> = study.selected.iter().map(|i| FEATURES[*i]).collect();
        println!("selected by correlation and merit: {}", selected.join(", "));
        println!("\nFigure 5.8: the right object comes at frame 100, goes at 180 and comes again at 220");
        print!(
            "{} movements; most probable at the end in {:.3}",
            changes.movements, changes.first_at_end_changed
        );
        print!(" ({:.3} without changes); judged as without changes", changes.first_at_end);
        println!(" after {:.1} and {:.1} frames", changes.agrees_after[0], changes.agrees_after[1]);
    }
}

fn print_row(row: &RowReport, known: Option<&ObjectRow>, cost: FrameCost) {
    let sd = |sd: Option<f64>| sd.map_or_else(|| "-".into(), |sd| format!("{sd:.3}"));
    let (score, word) = (&row.score, row.word);
    print!("{word:18}{:9.1}  {:.3} ({})", score.auc_sum(), score.auc_mean, sd(row.sd.0));
    print!("{:11.1}  {:.3} ({})", score.error_sum(), score.error_mean, sd(row.sd.1));
    print!("{:>8}", cost.0.map_or_else(|| "-".into(), |ms| format!("{ms:.3}")));
    match known.and_then(|k| k.published) {
        Some((auc, error)) => println!("   {auc:.1} {error:.1}"),
        None => println!(),
    }
}

fn interval(of: &Interval) -> String {
    match (of.mean, of.ci95) {
        (Some(mean), Some((low, high))) => format!("{mean:+.3} ({low:+.3} to {high:+.3})"),
        (Some(mean), None) => format!("{mean:+.3}"),
        _ => "-".into(),
    }
}

/// Cost of frames for all rows of a table: the fastest of several runs over a movement.
fn costs_of(bench: &ObjectsBench, table: ObjectTable) -> Vec<FrameCost> {
    const RUNS: usize = 5;
    let movement = bench.moves(table)[0];
    let fastest = |variant, hidden| {
        let frames = FrameBench::new(table, variant, hidden, movement);
        (0..RUNS).map(|_| frames.frame_ms(stopwatch)).fold(f64::INFINITY, f64::min)
    };
    let cost = |row: ObjectRow| match row.kind {
        RowKind::Net(variant, hidden) => {
            let published = row.published_ms.map(|(_, hidden)| fastest(variant, hidden));
            (Some(fastest(variant, hidden)), published)
        }
        _ => (None, None),
    };
    rows_of(table).into_iter().map(cost).collect()
}

fn rows_value(group: &GroupReport, costs: Option<&[FrameCost]>) -> Value {
    let row = |(i, row): (usize, &RowReport)| {
        let (ms, ms_published) = costs.map_or((None, None), |c| c[i]);
        let value = json!({
            "auc_sum": round(row.score.auc_sum()), "auc_mean": round(row.score.auc_mean),
            "auc_sd": row.sd.0.map(round),
            "error_sum": round(row.score.error_sum()), "error_mean": round(row.score.error_mean),
            "error_sd": row.sd.1.map(round),
            "ms": ms.map(round), "ms_published_size": ms_published.map(round),
            "auc_half_seconds": row.halves.map(round),
        });
        (row.word.to_owned(), value)
    };
    group.rows.iter().enumerate().map(row).collect::<Map<_, _>>().into()
}

fn paired_value(group: &GroupReport) -> Value {
    let value =
        |i: &Interval| json!({"mean": i.mean.map(round), "ci95": i.ci95.map(|(a, b)| [round(a), round(b)])});
    let pair = |(a, b, auc, error): &(&'static str, &'static str, Interval, Interval)| {
        (format!("{a}-{b}"), json!({"auc_mean": value(auc), "error_mean": value(error)}))
    };
    group.paired.iter().map(pair).collect::<Map<_, _>>().into()
}

fn study_value(study: &FeatureStudy) -> Value {
    let correlation: Map<String, Value> = (FEATURES.iter().zip(&study.correlation))
        .map(|(word, row)| {
            let row: Map<String, Value> =
                FEATURES.iter().zip(row).map(|(w, c)| ((*w).to_owned(), round(*c))).collect();
            ((*word).to_owned(), row.into())
        })
        .collect();
    let merit: Map<String, Value> = (FEATURES.iter().zip(study.merit))
        .map(|(word, m)| {
            ((*word).to_owned(), json!({"auc_sum": round(m * FRAMES as f64), "auc_mean": round(m)}))
        })
        .collect();
    let selected: Vec<&str> = study.selected.iter().map(|i| FEATURES[*i]).collect();
    json!({"correlation": correlation, "merit": merit, "selected": selected})
}

fn round(x: f64) -> Value {
    json!((x * 10_000.0).round() / 10_000.0)
}

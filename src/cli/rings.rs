//! Encounters within several radii, as JSON and as a table.
//!
//! Main functions: [`of_run`], [`of_runs`], [`print()`]. Refuses: to measure.

use crate::experiment::rings::{RingColumn, closest_quantiles};
use crate::experiment::statistics::{Interval, Summary};
use crate::sim::encounter::{EncounterFigures, RINGS_M};
use serde_json::{Map, Value, json};

/// The radius as a key.
pub fn key(ring: usize) -> String {
    format!("{:.1}", RINGS_M[ring])
}

/// Each radius with a value.
fn by_radius(value: impl Fn(usize) -> Value) -> Value {
    (0..RINGS_M.len()).map(|ring| (key(ring), value(ring))).collect::<Map<_, _>>().into()
}

/// The curve of one run.
pub fn of_run(figures: &EncounterFigures) -> Value {
    by_radius(|ring| {
        let mut columns =
            Map::from_iter(RingColumn::ALL.map(|c| (c.word().to_owned(), json!(c.of(figures, ring)))));
        columns.insert("entries".to_owned(), json!(figures.rings[ring].entries));
        columns.insert("closest_m".to_owned(), closest(&[figures], ring));
        columns.into()
    })
}

/// The curve of many runs: means with standard deviations, closest distances of all encounters together.
pub fn of_runs(runs: &[&EncounterFigures]) -> Value {
    by_radius(|ring| {
        let mut columns = Map::from_iter(RingColumn::ALL.map(|c| {
            let Summary { mean, sd } = summary(runs, c, ring);
            (c.word().to_owned(), json!({"mean": mean, "sd": sd}))
        }));
        columns.insert("closest_m".to_owned(), closest(runs, ring));
        columns.into()
    })
}

/// Differences of two arms, seed by seed, with their intervals.
pub fn paired(ours: &[&EncounterFigures], theirs: &[&EncounterFigures]) -> Value {
    by_radius(|ring| {
        Map::from_iter(RingColumn::ALL.map(|column| {
            let both =
                ours.iter().zip(theirs).filter_map(|(a, b)| Some((column.of(a, ring)?, column.of(b, ring)?)));
            let (ours, theirs): (Vec<f64>, Vec<f64>) = both.unzip();
            (column.word().to_owned(), interval(Interval::of_pairs(&ours, &theirs)))
        }))
        .into()
    })
}

/// A difference with its interval.
pub fn interval(p: Interval) -> Value {
    json!({"mean": p.mean, "ci95": p.ci95.map(|(low, high)| [low, high])})
}

/// Prints the curve of each arm.
pub fn print(arms: &[(&str, Vec<&EncounterFigures>)]) {
    println!("within metres between the centres");
    for column in RingColumn::ALL {
        let heads: String = (0..RINGS_M.len()).map(|ring| format!("{:>9}", key(ring))).collect();
        println!("  {:38}{heads}", column.word());
        for (arm, runs) in arms {
            let cell = |ring| format!("{:>9.2}", summary(runs, column, ring).mean.unwrap_or(0.0));
            println!("    {arm:36}{}", (0..RINGS_M.len()).map(cell).collect::<String>());
        }
    }
}

fn summary(runs: &[&EncounterFigures], column: RingColumn, ring: usize) -> Summary {
    Summary::of(&runs.iter().filter_map(|figures| column.of(figures, ring)).collect::<Vec<_>>())
}

fn closest(runs: &[&EncounterFigures], ring: usize) -> Value {
    let quantiles = closest_quantiles(runs.iter().copied(), ring);
    Map::from_iter(quantiles.map(|(name, metres)| (name.to_owned(), json!(metres)))).into()
}

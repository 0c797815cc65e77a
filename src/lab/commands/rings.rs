//! Encounters within several radii, as JSON and as a table.
//!
//! Main functions: [`of_runs`], [`print()`]. Refuses: to measure.

use crate::statistics::{Interval, Summary};
use giveway::cli::rings::{by_radius, closest, key};
use giveway_sim::measure::encounter::RINGS_M;
use giveway_sim::{EncounterFigures, RingColumn};
use serde_json::{Map, Value, json};

/// The curve of many runs: means with standard deviations, and the closest distances of all encounters together.
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

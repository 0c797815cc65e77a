//! Encounters of a run within several radii, as JSON.
//!
//! Main functions: [`of_run`], [`by_radius`], [`closest`]. Refuses: to measure.

use giveway_sim::measure::encounter::RINGS_M;
use giveway_sim::measure::rings::closest_quantiles;
use giveway_sim::{EncounterFigures, RingColumn};
use serde_json::{Map, Value, json};

/// The key of a radius.
pub fn key(ring: usize) -> String {
    format!("{:.1}", RINGS_M[ring])
}

/// An object with a value for each radius.
pub fn by_radius(value: impl Fn(usize) -> Value) -> Value {
    (0..RINGS_M.len()).map(|ring| (key(ring), value(ring))).collect::<Map<_, _>>().into()
}

/// The encounters of one run by radius.
pub fn of_run(figures: &EncounterFigures) -> Value {
    by_radius(|ring| {
        let mut columns =
            Map::from_iter(RingColumn::ALL.map(|c| (c.word().to_owned(), json!(c.of(figures, ring)))));
        columns.insert("entries".to_owned(), json!(figures.rings[ring].entries));
        columns.insert("closest_m".to_owned(), closest(&[figures], ring));
        columns.into()
    })
}

/// Quantiles of the closest distances within one of the radii, by name.
pub fn closest(runs: &[&EncounterFigures], ring: usize) -> Value {
    let quantiles = closest_quantiles(runs.iter().copied(), ring);
    Map::from_iter(quantiles.map(|(name, metres)| (name.to_owned(), json!(metres)))).into()
}

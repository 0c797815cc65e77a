//! Where people may be in the coming seconds, as it travels: few bell curves each, in centimetres and percent.
//!
//! Main types: [`ForecastDto`], [`PartDto`]; [`packed`] is the thin form, which says the same. Refuses: to forecast.

use crate::wire::text::{round3, worker_name};
use giveway_fleet::Expected;
use giveway_floor::id::Dense;
use giveway_floor::time::Span;
use giveway_people::human::Part;
use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

/// What is forecast of one worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ForecastDto {
    /// The worker.
    #[schema(example = "w1")]
    pub worker: String,
    /// In order of time.
    pub parts: Vec<PartDto>,
    #[serde(skip)]
    row: usize,
}

/// One bell curve: metres, standard deviations and correlation, and its share of the probability at that moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct PartDto {
    /// Seconds from now.
    pub after_s: f64,
    /// Its share of the probability at that moment.
    pub p: f64,
    /// Its middle, metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Standard deviation along x, metres.
    pub sx: f64,
    /// Along y.
    pub sy: f64,
    /// The correlation of the two, -0.99 to 0.99.
    pub tilt: f64,
}

pub fn forecasts(expected: &[Expected]) -> Vec<ForecastDto> {
    let one = |e: &Expected| ForecastDto {
        worker: worker_name(e.worker),
        row: e.worker.ix(),
        parts: e.ahead.iter().flat_map(|(after, m)| m.parts.iter().map(|p| part(*after, p))).collect(),
    };
    expected.iter().map(one).collect()
}

fn part(after: Span, part: &Part) -> PartDto {
    let (sx, sy) = (part.cov[(0, 0)].max(0.0).sqrt(), part.cov[(1, 1)].max(0.0).sqrt());
    let tilt = part.cov[(0, 1)] / (sx * sy).max(1e-9);
    let hundredth = |x: f64| round3((x * 100.0).round() / 100.0);
    PartDto {
        after_s: round3(after.as_secs_f64()),
        p: hundredth(part.weight),
        x: hundredth(part.mean.x),
        y: hundredth(part.mean.y),
        sx: hundredth(sx),
        sy: hundredth(sy),
        tilt: hundredth(tilt.clamp(-0.99, 0.99)),
    }
}

/// One list for each worker: row, then for each bell curve seconds ahead, percent, x, y, standard deviations along x
/// and y in centimetres, and the correlation in percent.
pub fn packed(all: &[ForecastDto]) -> Value {
    let whole = |x: f64| (x * 100.0).round() as i64;
    let one = |f: &ForecastDto| {
        let part = |p: &PartDto| {
            [
                p.after_s.round() as i64,
                whole(p.p),
                whole(p.x),
                whole(p.y),
                whole(p.sx),
                whole(p.sy),
                whole(p.tilt),
            ]
        };
        std::iter::once(f.row as i64).chain(f.parts.iter().flat_map(part)).collect::<Vec<i64>>()
    };
    json!(all.iter().map(one).collect::<Vec<_>>())
}

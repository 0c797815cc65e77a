//! Forecasts of people on the wire: a few normal distributions each, in centimetres and percent.
//!
//! Main types: [`ForecastDto`], [`PartDto`]; [`packed`] is the thin form with the same content. Refuses: to forecast.

use crate::wire::text::{round3, worker_name};
use giveway_fleet::Expected;
use giveway_floor::id::Dense;
use giveway_floor::time::Span;
use giveway_people::human::Part;
use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

/// The forecast of one worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ForecastDto {
    /// The worker.
    #[schema(example = "w1")]
    pub worker: String,
    /// The parts in order of time.
    pub parts: Vec<PartDto>,
    #[serde(skip)]
    row: usize,
}

/// One normal distribution, with its share of the probability at that time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct PartDto {
    /// How far ahead the forecast is, seconds.
    pub after_s: f64,
    /// The part's share of the probability at that time.
    pub p: f64,
    /// The mean's x, metres.
    pub x: f64,
    /// The mean's y, metres.
    pub y: f64,
    /// Standard deviation along x, metres.
    pub sx: f64,
    /// Standard deviation along y, metres.
    pub sy: f64,
    /// The correlation of x and y, -0.99 to 0.99.
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

/// One list for each worker: the row, then for each part the seconds ahead, percent, x, y, the standard deviations
/// along x and y in centimetres, and the correlation in percent.
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

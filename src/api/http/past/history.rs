//! `/v1/history`: deliveries, encounters, interruptions, planning and waiting over time, in buckets.
//!
//! Main types: [`HistoryDto`], [`BucketDto`]. Refuses: more than 2000 buckets at once, and buckets for times without
//! data.

use crate::http::shared::stretch::stretch;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::Params;
use crate::wire::text::{round3, time_text};
use crate::wire::words::PolicyDto;
use axum::Json;
use giveway_fleet::history::{Bucket, TIERS, floor};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Span;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// The most buckets in an answer.
const MOST: i64 = 2000;

/// About how many buckets an answer has at most if the request gives no length.
const USUAL: i64 = 400;

/// Lengths of buckets, in seconds, for requests that give none.
const LENGTHS_S: [i64; 5] = [10, 60, 600, 3600, 21_600];

/// Period and step of figures over time.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct HistoryParams {
    /// Start of the period, RFC 3339; an hour before the end if absent.
    #[param(example = "2027-01-31T06:00:00Z")]
    from: Option<String>,
    /// End of the period, RFC 3339; now if absent.
    to: Option<String>,
    /// Length of a bucket, seconds: a multiple of 10 up to 86400. If absent, a length that makes at most 400 buckets.
    #[param(example = 60)]
    step: Option<i64>,
}

/// Figures over time.
#[derive(Debug, Serialize, ToSchema)]
pub struct HistoryDto {
    /// When the first bucket begins, RFC 3339, whether it has data or not.
    pub from: String,
    /// When the last bucket ends, RFC 3339.
    pub to: String,
    /// Length of a bucket, seconds.
    pub step_s: i64,
    /// When `time_s` of the live feed was zero, RFC 3339.
    pub started: String,
    /// The human-aware policy of the fleet.
    #[schema(value_type = PolicyDto)]
    pub arm: &'static str,
    /// The buckets in order of time. A bucket without data is left out: the server was not running.
    pub buckets: Vec<BucketDto>,
}

/// Figures for one bucket of time.
#[derive(Debug, Serialize, ToSchema)]
pub struct BucketDto {
    /// When the bucket begins, RFC 3339.
    pub at: String,
    /// How many seconds of the bucket were recorded: all, except in the last bucket and at a restart.
    pub covered_s: f64,
    /// Racks served at stations.
    pub robot_deliveries: u64,
    /// Assignments completed by workers.
    pub human_deliveries: u64,
    /// How often a robot came into region 1 of a worker.
    pub encounters: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
    /// Routes planned anew because of workers and closures.
    pub replans: u64,
    /// Routes planned.
    pub plans: u64,
    /// Searches that found no route.
    pub plan_failures: u64,
    /// Seconds that workers spent on the floor, all workers together.
    pub worker_s: f64,
    /// Seconds that robots stood still although they had to drive on, all robots together.
    pub waiting_s: f64,
    /// Order lines that were over at picking stations: done or short.
    pub lines: u64,
    /// Reaches to wrong slots or totes that were warned of.
    pub wrong_reaches: u64,
    /// Seconds in which picking stations had no rack to pick from, all stations together.
    pub idle_s: f64,
    /// Duration of a route search, median, microseconds, within a tenth; null if there was no search.
    pub plan_us_p50: Option<u64>,
    /// Duration of a route search, 95th percentile, microseconds, within a tenth; null if there was no search.
    pub plan_us_p95: Option<u64>,
    /// Duration of the longest route search, microseconds, exact; null if there was no search.
    pub plan_us_max: Option<u64>,
    /// Duration of the longest step, microseconds; null if there was no step.
    pub step_us_max: Option<u64>,
}

/// Get deliveries, encounters, interruptions, planning and waiting over time. The last hour is kept in steps of ten
/// seconds, the last day in steps of a minute, and the last 31 days in steps of ten minutes, even across a restart.
#[utoipa::path(get, path = "/v1/history", tag = "floor", operation_id = "getHistory", params(HistoryParams), responses(
    (status = 200, description = "Figures over time", body = HistoryDto)))]
pub async fn history(
    Called(api): Called,
    Params(p): Params<HistoryParams>,
) -> Result<Json<HistoryDto>, Problem> {
    let (from, to) = stretch(&api, p.from.as_deref(), p.to.as_deref())?;
    let step = match p.step {
        Some(s) => checked_step(s, to - from)?,
        None => usual_step(to - from),
    };
    let buckets = api.figures.with(|h| h.read(from, to, step));
    Ok(Json(HistoryDto {
        from: time_text(floor(from, step)),
        to: time_text(to),
        step_s: step.0 / 1_000_000,
        started: time_text(api.figures.started),
        arm: api.figures.arm,
        buckets: buckets.iter().map(BucketDto::from).collect(),
    }))
}

fn checked_step(s: i64, stretch: Span) -> Result<Span, Problem> {
    let refused = |detail| Problem::invalid(vec![FieldError::new("step", requests::malformed(detail))]);
    let finest_s = TIERS[0].0.0 / 1_000_000;
    if !(finest_s..=86_400).contains(&s) || s % finest_s != 0 {
        return Err(refused(format!("must be a multiple of {finest_s} up to 86400, in seconds")));
    }
    let step = Span::from_secs(s);
    let buckets = stretch.0 / step.0;
    if buckets > MOST {
        return Err(refused(format!(
            "{buckets} buckets are more than {MOST}: choose a longer step or a shorter time"
        )));
    }
    Ok(step)
}

fn usual_step(stretch: Span) -> Span {
    let fits = |s: &i64| stretch.0 / Span::from_secs(*s).0 <= USUAL;
    Span::from_secs(LENGTHS_S.into_iter().find(fits).unwrap_or(86_400))
}

impl From<&Bucket> for BucketDto {
    fn from(b: &Bucket) -> BucketDto {
        BucketDto {
            at: time_text(b.start),
            covered_s: round3(b.covered.as_secs_f64()),
            robot_deliveries: b.robot_deliveries,
            human_deliveries: b.human_deliveries,
            encounters: b.encounters,
            deviations: b.deviations,
            interruptions: b.interruptions,
            replans: b.replans,
            plans: b.plans,
            plan_failures: b.plan_failures,
            worker_s: round3(b.worker_time.as_secs_f64()),
            waiting_s: round3(b.waiting_time.as_secs_f64()),
            lines: b.lines,
            wrong_reaches: b.wrong_reaches,
            idle_s: round3(b.idle_time.as_secs_f64()),
            plan_us_p50: b.searches.quantile_us(50),
            plan_us_p95: b.searches.quantile_us(95),
            plan_us_max: b.searches.quantile_us(100).map(|_| b.searches.max_us()),
            step_us_max: (b.step_max_us > 0).then_some(b.step_max_us),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_does_not_say_gets_at_most_400_buckets() {
        let step_s = |s: i64| usual_step(Span::from_secs(s)).0 / 1_000_000;
        assert_eq!([900, 3600, 86_400, 31 * 86_400].map(step_s), [10, 10, 600, 21_600]);
    }

    #[test]
    fn steps_that_nothing_is_kept_in_are_refused() {
        let hour = Span::from_secs(3600);
        for bad in [0, -10, 5, 15, 86_410, i64::MAX] {
            assert!(checked_step(bad, hour).is_err(), "{bad}");
        }
        assert!(checked_step(10, hour).is_ok() && checked_step(30, hour).is_ok());
        assert!(checked_step(10, Span::from_secs(86_400)).is_err(), "too many");
    }
}

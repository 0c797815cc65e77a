//! How well goals of recorded people are recognised on the way.
//!
//! Main types: [`PurposeScore`], [`Recogniser`]. Refuses: credit for the goal where a trip began; it is left out and
//! the others are scaled up.

use super::recipe;
use super::subject::{Ground, Subject};
use super::tracks::{RecordedWalks, TrackPoint};
use super::windows::Trip;
use giveway_floor::geometry::{Point, turn_between};
use giveway_floor::id::GoalId;
use giveway_people::human::{Method, Model};

/// Shares of the way at which the top goal is scored.
pub const PARTS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Times before arrival at which the top goal is also scored, seconds.
pub const BEFORE_S: [f64; 3] = [4.8, 3.2, 2.0];
/// Least probability of a goal.
const FLOOR: f64 = 1e-6;
/// Concentration of directions of the simple predictor.
const KAPPA: f64 = 4.0;
/// Number of bins of the calibration error.
const BINS: usize = 10;
/// A true goal less probable than this counts as missed.
const MISS: f64 = 0.05;

/// A recogniser to compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recogniser {
    /// One of the product's methods.
    Method(Method),
    /// Our method with figures set by hand.
    ByHand,
    /// By the direction of the last two steps alone.
    Heading,
    /// By distance alone.
    Nearest,
    /// All goals with equal probability.
    Chance,
}

impl Recogniser {
    /// All recognisers.
    pub const ALL: [Recogniser; 7] = [
        Recogniser::Method(Method::Detour),
        Recogniser::Method(Method::Chapter4),
        Recogniser::Method(Method::Chapter3),
        Recogniser::ByHand,
        Recogniser::Heading,
        Recogniser::Nearest,
        Recogniser::Chance,
    ];

    /// The recogniser's name in tables.
    pub fn word(self) -> &'static str {
        match self {
            Recogniser::Method(Method::Detour) => "giveway",
            Recogniser::Method(Method::Chapter4) => "thesis",
            Recogniser::Method(Method::Chapter3) => "thesis_chapter_3",
            Recogniser::Method(Method::Chapter3Tiles) => "thesis_chapter_3_tiles",
            Recogniser::ByHand => "by_hand",
            Recogniser::Heading => "heading",
            Recogniser::Nearest => "nearest",
            Recogniser::Chance => "chance",
        }
    }
}

/// Scores of one recogniser.
#[derive(Clone, Debug, PartialEq)]
pub struct PurposeScore {
    /// Number of trips.
    pub trips: usize,
    /// Number of samples.
    pub samples: usize,
    /// Share of trips whose top goal was right at [`PARTS`] of the way.
    pub top1: [f64; 5],
    /// Share of trips whose top goal was right at [`BEFORE_S`] before arrival.
    pub top1_before: [f64; 3],
    /// Share of all samples with the right goal on top.
    pub top1_of_samples: f64,
    /// Mean negative logarithm of the true goal's probability.
    pub nll: f64,
    /// Mean squared error over all goals (Brier).
    pub brier: f64,
    /// Expected calibration error of the top goal.
    pub ece: f64,
    /// Share of samples in which the true goal had less than five percent.
    pub miss5: f64,
    /// Mean number of goals with at least five percent.
    pub set: f64,
    /// For each bin of the top probability: share of samples, mean probability, share right.
    pub reliability: Vec<(f64, f64, f64)>,
}

/// A recogniser's output at one sample of a trip.
struct Recognition {
    /// Share of the way.
    part: f64,
    /// Seconds before arrival.
    before_s: f64,
    shares: Vec<f64>,
    truth: usize,
    trip: usize,
}

/// Scores a recogniser. `observe` gives what it sees of a trip: the samples as they are, or degraded; it is evaluated
/// at the trip's own samples in any case.
pub fn score(
    recording: &RecordedWalks,
    trips: &[Trip],
    goals: &[Point],
    model: &Model,
    recogniser: Recogniser,
    sigma_m: f64,
    mut observe: impl FnMut(&[TrackPoint]) -> Vec<TrackPoint>,
) -> PurposeScore {
    let ground = Ground::new(goals);
    let by_hand = recipe::by_hand(model);
    let model = if recogniser == Recogniser::ByHand { &by_hand } else { model };
    let mut looks = Vec::new();
    for (number, trip) in trips.iter().enumerate() {
        let way = &recording.walks[trip.walk].seen[trip.first..=trip.last];
        let seen = observe(way);
        let said = follow(&ground, model, recogniser, sigma_m, way, &seen);
        let mut walked = vec![0.0];
        way.windows(2).for_each(|p| walked.push(walked[walked.len() - 1] + (p[1].at - p[0].at).norm()));
        let whole = walked[way.len() - 1].max(1e-9);
        for (i, mut shares) in said.into_iter().enumerate() {
            let i = i + 1;
            shares[trip.origin] = 0.0;
            let total: f64 = shares.iter().sum();
            let others = (goals.len() - 1).max(1) as f64;
            for (g, s) in shares.iter_mut().enumerate() {
                let even = if g == trip.origin { 0.0 } else { 1.0 / others };
                *s = if total > 0.0 { *s / total } else { even };
            }
            let before_s = (way[way.len() - 1].t - way[i].t).as_secs_f64();
            looks.push(Recognition {
                part: walked[i] / whole,
                before_s,
                shares,
                truth: trip.goal,
                trip: number,
            });
        }
    }
    tally(&looks, trips.len())
}

/// The recogniser's output at each sample between the first and the last.
fn follow(
    ground: &Ground,
    model: &Model,
    recogniser: Recogniser,
    sigma_m: f64,
    way: &[TrackPoint],
    seen: &[TrackPoint],
) -> Vec<Vec<f64>> {
    let mut said = Vec::with_capacity(way.len());
    let method = match recogniser {
        Recogniser::Method(method) => method,
        Recogniser::ByHand => Method::Detour,
        _ => return (1..way.len() - 1).map(|i| simple(recogniser, &ground.goals, &way[..=i])).collect(),
    };
    let mut subject = Subject::new(ground, model, method, sigma_m);
    let mut next = 0;
    for (i, sample) in way.iter().enumerate().take(way.len() - 1) {
        while let Some(s) = seen.get(next).filter(|s| s.t <= sample.t) {
            subject.see(s.t, s.at);
            next += 1;
        }
        if i > 0 {
            let belief = subject.belief();
            said.push((0..ground.goals.len()).map(|g| belief.of(GoalId(g as u64))).collect());
        }
    }
    said
}

fn simple(recogniser: Recogniser, goals: &[Point], way: &[TrackPoint]) -> Vec<f64> {
    let now = way[way.len() - 1].at;
    let from = way[way.len().saturating_sub(3)].at;
    let bearing = |from: Point, to: Point| (to.y - from.y).atan2(to.x - from.x);
    let weigh = |g: &Point| match recogniser {
        Recogniser::Heading => (KAPPA * turn_between(bearing(from, now), bearing(now, *g)).cos()).exp(),
        Recogniser::Nearest => 1.0 / (g - now).norm().max(0.1),
        _ => 1.0,
    };
    goals.iter().map(weigh).collect()
}

fn tally(looks: &[Recognition], trips: usize) -> PurposeScore {
    let n = looks.len().max(1) as f64;
    let top = |l: &Recognition| {
        (0..l.shares.len()).max_by(|a, b| l.shares[*a].total_cmp(&l.shares[*b])).unwrap_or(0)
    };
    let right = |l: &Recognition| top(l) == l.truth;
    let mean = |f: &dyn Fn(&Recognition) -> f64| looks.iter().map(f).sum::<f64>() / n;
    let of_trips = |near: &dyn Fn(&Recognition) -> f64| {
        let at = |trip: usize| {
            looks
                .iter()
                .filter(|l| l.trip == trip)
                .min_by(|a, b| near(a).total_cmp(&near(b)))
                .is_some_and(right)
        };
        (0..trips).filter(|t| at(*t)).count() as f64 / trips.max(1) as f64
    };
    let mut bins = vec![(0.0, 0.0, 0.0); BINS];
    for l in looks {
        let p = l.shares[top(l)];
        let bin = &mut bins[((p * BINS as f64) as usize).min(BINS - 1)];
        (bin.0, bin.1, bin.2) = (bin.0 + 1.0, bin.1 + p, bin.2 + f64::from(right(l)));
    }
    let ece = bins.iter().map(|(_, p, hit)| (p - hit).abs()).sum::<f64>() / n;
    let reliability = bins.iter().filter(|b| b.0 > 0.0).map(|(k, p, hit)| (k / n, p / k, hit / k)).collect();
    let brier = |l: &Recognition| {
        let square = |(g, s): (usize, &f64)| (s - f64::from(g == l.truth)).powi(2);
        l.shares.iter().enumerate().map(square).sum::<f64>()
    };
    PurposeScore {
        trips,
        samples: looks.len(),
        top1: PARTS.map(|part| of_trips(&|l| if l.part >= part { l.part } else { 2.0 - l.part })),
        top1_before: BEFORE_S.map(|s| of_trips(&|l| (l.before_s - s).abs())),
        top1_of_samples: mean(&|l| f64::from(right(l))),
        nll: mean(&|l| -l.shares[l.truth].max(FLOOR).ln()),
        brier: mean(&brier),
        ece,
        miss5: mean(&|l| f64::from(l.shares[l.truth] < MISS)),
        set: mean(&|l| l.shares.iter().filter(|s| **s >= MISS).count() as f64),
        reliability,
    }
}

//! Fits the motion filter: the figures that predict people best in the recording that suits them least.
//!
//! Main functions: [`fit`], [`calmer`]. The likelihood of the next sample alone would make the filter follow every
//! sway; forecasts need a small mean error over their horizon, and an honest uncertainty. Errors are relative to those
//! of continuing the last step, and the worst recording counts most, so that the figures suit people of whom there is
//! no recording. Refuses: goals.

use super::{Lesson, RECORDED_M};
use crate::recorded::{OBSERVED, PREDICTED, TrackPoint, all};
use giveway_people::human::motion::{Fix, Motion, MotionModel};
use giveway_people::human::{Mixture, Part};

/// Weight of a nat of surprise, as a share of the error.
const SURENESS: f64 = 0.03;
/// Largest allowed excess over the error of the last step.
const COST: f64 = 0.005;
/// Number of steps ahead for judging the filter's certainty: two seconds.
const SURE: usize = 5;
/// Number of stretches of each lesson that are used.
const STRETCHES: usize = 250;
/// Number of rounds over all figures; steps shrink with each.
const ROUNDS: i32 = 4;

/// Fits all figures except those fixed by rates and shares.
pub fn fit(lessons: &[Lesson], start: MotionModel) -> MotionModel {
    // The search only goes downhill, so it starts in more than one place.
    let starts = [0.01, 0.02, 0.04].map(|sway_m| MotionModel { sway_m, ..start });
    let found = starts.map(|s| downhill(lessons, s));
    found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are three").1
}

fn downhill(lessons: &[Lesson], start: MotionModel) -> (f64, MotionModel) {
    let mut best = (error(lessons, &start), start);
    for round in 0..ROUNDS {
        let factor = 1.0 + 1.0 / f64::from(1 << round);
        for figure in 0..9 {
            for by in [factor, 1.0 / factor] {
                let tried = changed(best.1, figure, by);
                if tried.fault().is_some() {
                    continue;
                }
                let e = error(lessons, &tried);
                if e < best.0 {
                    best = (e, tried);
                }
            }
        }
    }
    best
}

/// Variants with less or more process noise, as long as their error is no greater than that of continuing the last
/// step: positions alone do not tell how certain the filter may be.
pub fn calmer(lessons: &[Lesson], m: MotionModel) -> Vec<MotionModel> {
    let worst = |m: &MotionModel| lessons.iter().map(|l| ratio(l, m)).fold(0.0, f64::max);
    let allowed = worst(&m).max(1.0) + COST;
    let sized = |k: i32| {
        let factor = 2f64.powi(k);
        MotionModel { accel_psd: m.accel_psd.map(|q| q * factor), ..m }
    };
    (-8..=1).map(sized).filter(|m| m.fault().is_none() && worst(m) <= allowed).collect()
}

/// Mean logarithm of the density at people's true positions over the next steps.
fn likelihood(lesson: &Lesson, m: &MotionModel) -> f64 {
    let (mut sum, mut n) = (0.0, 0);
    each(lesson, m, |motion, _, later| {
        for p in &later[..SURE] {
            let a = motion.ahead(p.t).expect("eight samples were seen");
            let density = Mixture { parts: vec![Part { weight: 1.0, mean: a.at, cov: a.cov }] }.density(p.at);
            sum += density.max(1e-6).ln();
            n += 1;
        }
    });
    sum / f64::from(n.max(1))
}

/// Calls `f` for each stretch with the filter after its observed samples, these samples, and the following ones.
fn each(lesson: &Lesson, m: &MotionModel, mut f: impl FnMut(&Motion, &[TrackPoint], &[TrackPoint])) {
    let stretches = all(&lesson.recording);
    let every = stretches.len().div_ceil(STRETCHES).max(1);
    for s in stretches.iter().step_by(every) {
        let seen = &lesson.recording.walks[s.walk].seen[s.first..s.first + OBSERVED + PREDICTED];
        let (observed, later) = seen.split_at(OBSERVED);
        let mut motion = Motion::new(*m);
        for p in observed {
            motion.see(Fix { seen: p.t, at: p.at, sigma_m: RECORDED_M });
        }
        f(&motion, observed, later);
    }
}

fn changed(mut m: MotionModel, figure: usize, by: f64) -> MotionModel {
    match figure {
        0 => m.changes_per_s *= by,
        1 | 2 => {
            let i = if figure == 1 { 0 } else { 2 };
            m.shares[i] = (m.shares[i] * by).clamp(0.02, 0.45);
            m.shares[1] = 1.0 - m.shares[0] - m.shares[2];
        }
        3 => m.accel_psd.iter_mut().for_each(|q| *q *= by),
        4 => m.accel_psd[0] *= by,
        5 => m.turn_rps *= by,
        // Turns do not last: more than half a second makes no sense.
        6 => m.straighten_s = (m.straighten_s * by).min(0.5),
        7 => m.sway_m = (m.sway_m * by).clamp(0.005, 0.1),
        // Uncertainty of fixes and of people together: this hardly moves positions, but sets how certain they are.
        _ => {
            m.sway_m = (m.sway_m * by.sqrt()).clamp(0.005, 0.1);
            m.accel_psd = m.accel_psd.map(|q| q * by);
        }
    }
    m
}

/// The worst ratio of the mean error to that of continuing the last step, plus a little of the mean ratio, minus a
/// reward for the filter's certainty about what came next.
fn error(lessons: &[Lesson], m: &MotionModel) -> f64 {
    let n = lessons.len().max(1) as f64;
    let ratios: Vec<f64> = lessons.iter().map(|l| ratio(l, m)).collect();
    let likelihood = lessons.iter().map(|l| likelihood(l, m)).sum::<f64>() / n;
    let mean = ratios.iter().sum::<f64>() / n;
    ratios.iter().copied().fold(0.0, f64::max) + 0.1 * mean - SURENESS * likelihood
}

fn ratio(lesson: &Lesson, m: &MotionModel) -> f64 {
    let (mut sum, mut plain) = (0.0, 0.0);
    each(lesson, m, |motion, observed, later| {
        let [before, last] = [observed[OBSERVED - 2], observed[OBSERVED - 1]];
        let velocity = (last.at - before.at) / (last.t - before.t).as_secs_f64();
        for p in later {
            sum += (motion.ahead(p.t).expect("eight samples were seen").at - p.at).norm();
            plain += (last.at + velocity * (p.t - last.t).as_secs_f64() - p.at).norm();
        }
    });
    if plain > 0.0 { sum / plain } else { 1.0 }
}

//! Scores of forecasts for recorded people.
//!
//! Main types: [`ForecastScore`], [`Predictor`]. The protocol is that of the public benchmarks: eight samples are
//! observed, twelve predicted, one prediction each. Refuses: the best of several predictions, which no planner can use.

use super::recipe;
use super::subject::{Ground, Subject};
use super::tracks::{RecordedWalks, TrackPoint};
use super::windows::{OBSERVED, PREDICTED, STEPS, Stretch};
use giveway_floor::geometry::{Point, Vector};
use giveway_people::human::{Method, Mixture, Model, Part};
use nalgebra::Matrix2;

/// Probabilities of the scored regions.
pub const LEVELS: [f64; 4] = [0.5, 0.9, 0.95, 0.99];
/// Least density, per m².
const DENSITY_MIN: f64 = 1e-8;

/// A predictor to compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predictor {
    /// Our filter, goals and learned shapes.
    Giveway,
    /// Our filter and learned shapes, goals not known.
    Free,
    /// Our filter and shapes, with goals weighted by the published recogniser of chapter 4.
    Thesis,
    /// The mean of straight ways to all goals, with figures set by hand.
    ByHand,
    /// Repeats the last step.
    Constant,
    /// Repeats the mean of seven steps.
    Mean,
    /// Goes to the goal straight ahead, at the speed of the last step.
    Heading,
    /// Stays at the last position.
    Still,
}

impl Predictor {
    /// All predictors.
    pub const ALL: [Predictor; 8] = [
        Predictor::Giveway,
        Predictor::Free,
        Predictor::Thesis,
        Predictor::ByHand,
        Predictor::Constant,
        Predictor::Mean,
        Predictor::Heading,
        Predictor::Still,
    ];

    /// The predictor's name in tables.
    pub fn word(self) -> &'static str {
        match self {
            Predictor::Giveway => "giveway",
            Predictor::Free => "giveway_without_goals",
            Predictor::Thesis => "thesis",
            Predictor::ByHand => "by_hand",
            Predictor::Constant => "cv",
            Predictor::Mean => "cv_mean",
            Predictor::Heading => "heading",
            Predictor::Still => "still",
        }
    }
}

/// Scores of one predictor.
#[derive(Clone, Debug, PartialEq)]
pub struct ForecastScore {
    /// Number of stretches.
    pub stretches: usize,
    /// Mean error over all steps, metres.
    pub ade: f64,
    /// Mean error at the last step, metres.
    pub fde: f64,
    /// Mean error of each step, metres.
    pub errors: [f64; PREDICTED],
    /// Mean negative logarithm of the density per m², nats.
    pub nll: f64,
    /// Share of people within the stated regions, by level and step.
    pub covered: [[f64; PREDICTED]; 4],
    /// Share of stretches that were within the 95 % region at all steps.
    pub covered_throughout: f64,
    /// Median area of the 95 % region at each step, m².
    pub area95: [f64; PREDICTED],
    /// Coverage of the 95 % region over all steps by class of speed (standing, slow, walking, brisk), with the number
    /// of stretches.
    pub by_class: [(f64, usize); 4],
}

/// The twelve predictions for one stretch: a point each, and a probability.
struct Prediction {
    points: [Point; PREDICTED],
    mixtures: Vec<Mixture>,
    class: usize,
}

/// Scores a predictor. `observe` gives what the predictor sees before the stretch's last [`PREDICTED`] samples: the
/// first samples as they are, or degraded; `sigma_m` is their stated accuracy.
pub fn score(
    recording: &RecordedWalks,
    stretches: &[Stretch],
    goals: &[Point],
    model: &Model,
    predictor: Predictor,
    sigma_m: f64,
    mut observe: impl FnMut(&[TrackPoint]) -> Vec<TrackPoint>,
) -> ForecastScore {
    let ground = Ground::new(if predictor == Predictor::Free { &[] } else { goals });
    let mut runs = Vec::with_capacity(stretches.len());
    for s in stretches {
        let all = &recording.walks[s.walk].seen[s.first..s.first + STEPS];
        let seen = observe(&all[..OBSERVED]);
        runs.push((predict(&seen, &all[OBSERVED..], &ground, model, predictor, sigma_m), &all[OBSERVED..]));
    }
    if !matches!(predictor, Predictor::Giveway | Predictor::Free | Predictor::Thesis) {
        spread_in_hindsight(&mut runs);
    }
    tally(&runs)
}

fn predict(
    seen: &[TrackPoint],
    later: &[TrackPoint],
    ground: &Ground,
    model: &Model,
    predictor: Predictor,
    sigma_m: f64,
) -> Prediction {
    let times = |i: usize| later[i].t;
    let last = seen[seen.len() - 1];
    let velocity = |back: usize| -> Vector {
        let from = seen[seen.len().saturating_sub(back + 1)];
        let dt = (last.t - from.t).as_secs_f64();
        if dt > 0.0 { (last.at - from.at) / dt } else { Vector::zeros() }
    };
    let ahead = |i: usize| (times(i) - last.t).as_secs_f64();
    let method = if predictor == Predictor::Thesis { Method::Chapter4 } else { Method::Detour };
    let point = |f: &dyn Fn(usize) -> Point| std::array::from_fn(f);
    let plain = |points| Prediction { points, mixtures: Vec::new(), class: 0 };
    match predictor {
        Predictor::Still => plain([last.at; PREDICTED]),
        Predictor::Constant => plain(point(&|i| last.at + velocity(1) * ahead(i))),
        Predictor::Mean => plain(point(&|i| last.at + velocity(seen.len() - 1) * ahead(i))),
        Predictor::Heading => {
            let v = velocity(2);
            let off = |g: &&Point| -v.dot(&(**g - last.at)) / (**g - last.at).norm().max(1e-9);
            let goal = ground.goals.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            plain(point(&|i| match goal {
                Some(g) => {
                    let way = g - last.at;
                    last.at + way * (v.norm() * ahead(i) / way.norm().max(1e-9)).min(1.0)
                }
                None => last.at + v * ahead(i),
            }))
        }
        Predictor::ByHand => {
            let model = recipe::by_hand(model);
            let mut subject = Subject::new(ground, &model, method, sigma_m);
            seen.iter().for_each(|s| subject.see(s.t, s.at));
            plain(recipe::mean_ways(&subject, &ground.goals, seen, later))
        }
        Predictor::Giveway | Predictor::Free | Predictor::Thesis => {
            let mut subject = Subject::new(ground, model, method, sigma_m);
            seen.iter().for_each(|s| subject.see(s.t, s.at));
            let speed = subject.motion().ahead(last.t).map_or(0.0, |a| a.velocity.norm());
            let (mixtures, points) = subject.forecast(|o| {
                let mixture = |i| o.at(times(i)).unwrap_or_default();
                let point = |i| o.point(times(i)).unwrap_or(last.at);
                ((0..PREDICTED).map(mixture).collect(), std::array::from_fn(point))
            });
            Prediction { points, mixtures, class: giveway_people::human::forecast::class_of(speed) }
        }
    }
}

/// Predictors that only give points get the round Gaussian that suits them best on these very people.
fn spread_in_hindsight(runs: &mut [(Prediction, &[TrackPoint])]) {
    let variance: [f64; PREDICTED] = std::array::from_fn(|i| {
        let square = |(p, later): &(Prediction, &[TrackPoint])| (p.points[i] - later[i].at).norm_squared();
        (runs.iter().map(square).sum::<f64>() / (2 * runs.len().max(1)) as f64).max(1e-4)
    });
    for (p, _) in runs {
        let part = |i: usize| Part { weight: 1.0, mean: p.points[i], cov: Matrix2::identity() * variance[i] };
        p.mixtures = (0..PREDICTED).map(|i| Mixture { parts: vec![part(i)] }).collect();
    }
}

fn tally(runs: &[(Prediction, &[TrackPoint])]) -> ForecastScore {
    let n = runs.len().max(1) as f64;
    let mut score = ForecastScore {
        stretches: runs.len(),
        ade: 0.0,
        fde: 0.0,
        errors: [0.0; PREDICTED],
        nll: 0.0,
        covered: [[0.0; PREDICTED]; 4],
        covered_throughout: 0.0,
        area95: [0.0; PREDICTED],
        by_class: [(0.0, 0); 4],
    };
    let mut areas: [Vec<f64>; PREDICTED] = std::array::from_fn(|_| Vec::with_capacity(runs.len()));
    for (p, later) in runs {
        let mut within = 0;
        for i in 0..PREDICTED {
            let truth = later[i].at;
            score.errors[i] += (p.points[i] - truth).norm() / n;
            score.nll -= p.mixtures[i].density(truth).max(DENSITY_MIN).ln() / (n * PREDICTED as f64);
            let level = p.mixtures[i].level(truth);
            for (k, stated) in LEVELS.iter().enumerate() {
                score.covered[k][i] += f64::from(level <= *stated) / n;
            }
            within += usize::from(level <= 0.95);
            areas[i].push(p.mixtures[i].area(0.95));
        }
        score.covered_throughout += f64::from(within == PREDICTED) / n;
        let class = &mut score.by_class[p.class];
        (class.0, class.1) = (class.0 + within as f64 / PREDICTED as f64, class.1 + 1);
    }
    score.by_class.iter_mut().for_each(|c| c.0 /= c.1.max(1) as f64);
    for (i, areas) in areas.iter_mut().enumerate() {
        areas.sort_by(f64::total_cmp);
        score.area95[i] = areas.get(areas.len() / 2).copied().unwrap_or(0.0);
    }
    score.ade = score.errors.iter().sum::<f64>() / PREDICTED as f64;
    score.fde = score.errors[PREDICTED - 1];
    score
}

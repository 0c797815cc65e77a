//! Training of which place a hand goes to, with people left out.
//!
//! Main functions: [`learn_slots`], [`end_scores`], [`sharpness_of`]. One net per left-out group of people; all nets
//! together are the predictor, and each one's scores on people it never saw give the temperature. Refuses: temperatures
//! from people that were learned from.

use super::course::motions;
use super::ends::{EndCourse, learn_ends};
use super::items::{ReachItem, Variety};
use super::lessons::PickLessons;
use crate::picks::way_samples;
use giveway_people::reach::ends::{END_FIGURES, EndNet, end_coordinates, end_score};
use giveway_people::reach::features::BODY;
use giveway_people::reach::net::squash::softmax;
use giveway_sim::random::Stream;

/// Number of groups of people to leave out, and of nets to train.
pub(super) const GROUPS: usize = 4;
/// The least probability, as in scores.
const FLOOR: f64 = 1e-6;

/// Scores of all candidates of a movement at the ten parts of its way, with the right candidate.
#[derive(Clone, Debug, PartialEq)]
pub struct Scored {
    /// Index of the movement.
    pub item: usize,
    /// Scores at each part.
    pub scores: Vec<Vec<f64>>,
    /// The right candidate.
    pub right: usize,
}

/// Training parameters for recorded people.
pub const END_COURSE: EndCourse = EndCourse {
    hidden: 24,
    epochs: 24,
    batch: 16,
    rate: 0.01,
    dropout: 0.1,
    decay: 0.01,
    variety: Variety {
        size: 0.09,
        pace: 0.15,
        turn: 0.09,
        gain: 0.22,
        bias: 0.075,
        ends: 0.03,
        noise: 0.002,
    },
    strangers: None,
};

/// Scores of a net at every sample of a movement.
pub fn end_scores(net: &EndNet, item: &ReachItem) -> Vec<Vec<f64>> {
    let (mut state, mut said, mut body) = (net.state(), [0.0f32; END_FIGURES], [0.0f32; BODY]);
    let mut all = Vec::with_capacity(item.samples.len());
    for motion in motions(item) {
        motion.body(&mut body);
        net.step(&mut state, &body, &mut said);
        let score = |t| f64::from(end_score(&said, &end_coordinates(&motion, t)));
        all.push(item.targets.iter().map(score).collect());
    }
    all
}

/// The mean of several nets' scores. A shift common to all candidates changes no probability among them, but it decides
/// whether none of them is meant.
pub fn mean_scores(all: &[Vec<Vec<f64>>]) -> Vec<Vec<f64>> {
    let mut mean = vec![vec![0.0; all[0][0].len()]; all[0].len()];
    for scores in all {
        for (mean, scores) in mean.iter_mut().zip(scores) {
            mean.iter_mut().zip(scores).for_each(|(m, s)| *m += s / all.len() as f64);
        }
    }
    mean
}

/// The scores at the ten parts of the way only.
pub fn at_parts(item: &ReachItem, scores: &[Vec<f64>]) -> Vec<Vec<f64>> {
    way_samples(item).into_iter().map(|t| scores[t].clone()).collect()
}

/// Mean negative logarithm of the right candidates' probabilities at a sharpness.
pub fn surprise(all: &[Scored], sharpness: f64) -> f64 {
    let (mut sum, mut count, mut p) = (0.0, 0.0, Vec::new());
    for scored in all {
        for scores in &scored.scores {
            p.clear();
            p.extend(scores.iter().map(|s| s * sharpness));
            softmax(&mut p);
            sum -= libm::log(p[scored.right].max(FLOOR));
            count += 1.0;
        }
    }
    sum / f64::max(count, 1.0)
}

/// The sharpness of least surprise, from a hundredth to a hundred (golden section on its logarithm).
pub fn sharpness_of(all: &[Scored]) -> f64 {
    let golden = 0.5 * (libm::sqrt(5.0) - 1.0);
    let (mut low, mut high) = (libm::log(0.01), libm::log(100.0));
    for _ in 0..24 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if surprise(all, libm::exp(a)) < surprise(all, libm::exp(b)) {
            high = b;
        } else {
            low = a;
        }
    }
    libm::exp(0.5 * (low + high))
}

/// The score of "none of these" with the least surprise if every second movement goes to none of the candidates.
pub(super) fn none_of(all: &[Scored], sharpness: f64) -> f64 {
    let surprise = |none: f64| {
        let mut sum = 0.0;
        for scored in all {
            for scores in &scored.scores {
                let mut with: Vec<f64> = scores.iter().map(|s| s * sharpness).collect();
                let mut without = with.clone();
                with.push(none);
                without[scored.right] = none;
                softmax(&mut with);
                softmax(&mut without);
                sum -= libm::log(with[scored.right].max(FLOOR)) + libm::log(without[scored.right].max(FLOOR));
            }
        }
        sum
    };
    let tried = (0..=60).map(|k| -15.0 + 0.25 * f64::from(k));
    let scored = tried.map(|none| (surprise(none), none));
    scored.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(-3.0, |best| best.1)
}

/// The nets, and each net's scores on people it never saw.
pub(super) fn learn_slots(
    lessons: &PickLessons,
    course: &EndCourse,
    seed: u64,
    tell: &mut impl FnMut(&str),
) -> (Vec<EndNet>, Vec<Scored>) {
    let groups = GROUPS.min(lessons.present().len()).max(2);
    let group_of: Vec<usize> = lessons.items.iter().map(|i| lessons.group(i.person, groups)).collect();
    let (mut nets, mut left_out) = (Vec::new(), Vec::new());
    for group in 0..groups {
        tell(&format!("where hands end, {} of {groups}", group + 1));
        let kept = lessons.items.iter().zip(&group_of).filter(|(_, g)| **g != group);
        let kept: Vec<ReachItem> = kept.map(|k| k.0.clone()).collect();
        let mut net = learn_ends(&kept, course, &mut Stream::new(seed, 301, group as u64));
        net.memory.gates.round();
        net.out.round();
        let mut strange = Stream::new(seed, 306, group as u64);
        for (i, item) in lessons.items.iter().enumerate().filter(|(i, _)| group_of[*i] == group) {
            let varied = course.strangers.map(|v| v.vary(item, &mut strange));
            let item = varied.as_ref().unwrap_or(item);
            let scores = at_parts(item, &end_scores(&net, item));
            left_out.push(Scored { item: i, scores, right: item.right });
        }
        nets.push(net);
    }
    left_out.sort_by_key(|s| s.item);
    (nets, left_out)
}

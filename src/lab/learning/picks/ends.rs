//! Training of nets that predict where a hand will end.
//!
//! Main function: [`learn_ends`]. The loss is the probability of the right place among its candidates, at every step of
//! the movement. Refuses: to know people apart.

use super::adam::Adam;
use super::course::{motions, rate_at, shuffle, step_weights};
use super::items::{ReachItem, Variety};
use super::layers::{LstmTape, Sequence, affine, affine_back, lstm};
use giveway_people::reach::ends::{END_FIGURES, ENDS, EndNet, end_coordinates, end_score};
use giveway_people::reach::features::{ArmMotion, BODY};
use giveway_people::reach::net::squash::exp;
use giveway_people::reach::net::{Affine, Lstm};
use giveway_sim::random::Stream;

/// Parameters of the training.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndCourse {
    /// Size of the state.
    pub hidden: usize,
    /// Number of passes over all movements.
    pub epochs: usize,
    /// Number of movements in a batch.
    pub batch: usize,
    /// First learning rate; it shrinks to a fiftieth.
    pub rate: f32,
    /// Share of inputs that are dropped.
    pub dropout: f64,
    /// Weight decay.
    pub decay: f32,
    /// How movements are varied.
    pub variety: Variety,
    /// How movements of left-out people are varied before temperatures and regions are fitted: for people who differ
    /// more than those who were learned from.
    pub strangers: Option<Variety>,
}

/// Trains a net on movements.
pub fn learn_ends(items: &[ReachItem], course: &EndCourse, chance: &mut Stream) -> EndNet {
    let mut net =
        EndNet { memory: lstm(BODY, course.hidden, chance), out: affine(course.hidden, END_FIGURES, chance) };
    net.out.bias[..ENDS].copy_from_slice(&[1.9, 0.3, 0.6, 0.0, 0.0]);
    net.out.weights.iter_mut().for_each(|w| *w *= 0.3);
    let mut gradient =
        EndNet { memory: Lstm::new(BODY, course.hidden), out: Affine::new(course.hidden, END_FIGURES) };
    let (mut adam, mut tape) = (Adam::new(course.decay), LstmTape::default());
    let mut order: Vec<usize> = (0..items.len()).collect();
    let batches = items.len().div_ceil(course.batch) * course.epochs;
    let mut done = 0;
    for _ in 0..course.epochs {
        shuffle(&mut order, chance);
        for batch in order.chunks(course.batch) {
            let varied: Vec<ReachItem> =
                batch.iter().map(|i| course.variety.vary(&items[*i], chance)).collect();
            batch_gradient(&net, &varied, course.dropout, &mut tape, &mut gradient, chance);
            let rate = rate_at(course.rate, done as f64 / batches as f64);
            let EndNet { memory, out } = &mut net;
            let mut weights =
                [&mut memory.gates.weights[..], &mut memory.gates.bias, &mut out.weights, &mut out.bias];
            let (m, o) = (&mut gradient.memory.gates, &mut gradient.out);
            adam.step(
                rate,
                &mut weights,
                &mut [&mut m.weights[..], &mut m.bias, &mut o.weights, &mut o.bias],
            );
            done += 1;
        }
    }
    net
}

fn batch_gradient(
    net: &EndNet,
    items: &[ReachItem],
    dropout: f64,
    tape: &mut LstmTape,
    gradient: &mut EndNet,
    chance: &mut Stream,
) {
    let steps = items.iter().map(|i| i.samples.len()).max().unwrap_or(0);
    let shape = Sequence { steps, rows: items.len() };
    let mut x = vec![0.0f32; steps * shape.rows * BODY];
    let motions: Vec<Vec<ArmMotion>> = items.iter().map(motions).collect();
    for (row, motions) in motions.iter().enumerate() {
        for (t, motion) in motions.iter().enumerate() {
            let at = (t * shape.rows + row) * BODY;
            motion.body(&mut x[at..at + BODY]);
        }
    }
    let n = net.memory.hidden;
    tape.run(&net.memory, &x, shape, None);
    // The same states are dropped at all steps of a movement.
    let mask: Vec<f32> = (0..shape.rows * n)
        .map(|_| if chance.happens(dropout) { 0.0 } else { 1.0 / (1.0 - dropout) as f32 })
        .collect();
    let mut states = tape.states(shape.rows, n).to_vec();
    states.chunks_exact_mut(mask.len()).for_each(|s| s.iter_mut().zip(&mask).for_each(|(s, m)| *s *= m));
    let mut said = vec![0.0f32; steps * shape.rows * END_FIGURES];
    net.out.apply(&states, &mut said);
    let mut slopes = vec![0.0f32; said.len()];
    let mut scores = Vec::new();
    for (row, (item, motions)) in items.iter().zip(&motions).enumerate() {
        let weights = step_weights(item);
        for (t, motion) in motions.iter().enumerate() {
            let at = (t * shape.rows + row) * END_FIGURES;
            let said = &said[at..at + END_FIGURES];
            let places: Vec<[f32; ENDS]> = item.targets.iter().map(|p| end_coordinates(motion, p)).collect();
            scores.clear();
            scores.extend(places.iter().map(|p| f64::from(end_score(said, p))));
            giveway_people::reach::net::squash::softmax(&mut scores);
            let slopes = &mut slopes[at..at + END_FIGURES];
            for (i, place) in places.iter().enumerate() {
                let wrong = scores[i] as f32 - f32::from(u8::from(i == item.right));
                let wrong = wrong * weights[t] / shape.rows as f32;
                for k in 0..ENDS {
                    let sharp = exp(2.0 * said[ENDS + k]);
                    let apart = place[k] - said[k];
                    slopes[k] += wrong * sharp * apart;
                    slopes[ENDS + k] -= wrong * sharp * apart * apart;
                }
            }
        }
    }
    let mut d_states = vec![0.0f32; states.len()];
    affine_back(&net.out, &states, &slopes, &mut gradient.out, Some(&mut d_states));
    d_states.chunks_exact_mut(mask.len()).for_each(|s| s.iter_mut().zip(&mask).for_each(|(s, m)| *s *= m));
    tape.back(&net.memory, &x, &d_states, None, &mut gradient.memory, None);
}

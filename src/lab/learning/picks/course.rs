//! Shared parts of training: order, weights of steps, learning rates.
//!
//! Main functions: [`motions`], [`step_weights`], [`rate_at`], [`shuffle`]. Refuses: nothing.

use super::items::ReachItem;
use giveway_people::reach::features::ArmMotion;
use giveway_sim::random::Stream;

/// Weights of the steps of one movement: those on the way sum to one, those before and after count less.
pub(super) fn step_weights(item: &ReachItem) -> Vec<f32> {
    let on_the_way = (item.arrival - item.onset).max(1) as f32;
    let is_on_the_way = |t: usize| t > item.onset && t <= item.arrival;
    let weight = |t: usize| if is_on_the_way(t) { 1.0 / on_the_way } else { 0.3 / on_the_way };
    (0..item.samples.len()).map(weight).collect()
}

/// The person's motion at every step.
pub(super) fn motions(item: &ReachItem) -> Vec<ArmMotion> {
    let mut motion = ArmMotion::new(item.samples[0]);
    let mut all = Vec::with_capacity(item.samples.len());
    for sample in &item.samples {
        motion = motion.then(*sample);
        all.push(motion);
    }
    all
}

/// Learning rate at a share of the course: rises briefly, then falls along a cosine to a fiftieth.
pub(super) fn rate_at(rate: f32, share: f64) -> f32 {
    let rises = (share / 0.05).min(1.0);
    let falls = 0.5 * (1.0 + libm::cos(std::f64::consts::PI * share)) * 0.98 + 0.02;
    rate * (rises * falls) as f32
}

/// Shuffles (Fisher and Yates).
pub(super) fn shuffle<T>(items: &mut [T], chance: &mut Stream) {
    for i in (1..items.len()).rev() {
        items.swap(i, chance.below(i + 1));
    }
}

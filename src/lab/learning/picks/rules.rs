//! Two rules with only a temperature to fit: the place nearest to the finger tip, and the one nearest to the head ray.
//!
//! Main functions: [`hand_scores`], [`head_scores`]. Refuses: memory.

use super::items::ReachItem;
use giveway_people::reach::ArmSample;
use giveway_people::reach::sample::ray;

/// Minus the distance of the finger tip from every candidate at every sample, metres.
pub fn hand_scores(item: &ReachItem) -> Vec<Vec<f64>> {
    let scores = |s: &ArmSample| item.targets.iter().map(|t| -(t.hand - s.finger).norm()).collect();
    item.samples.iter().map(scores).collect()
}

/// Minus the distance between the unit vectors of the head and of the direction from it to the place.
pub fn head_scores(item: &ReachItem) -> Vec<Vec<f64>> {
    let scores = |s: &ArmSample| {
        let head = ray(s.yaw, s.pitch);
        item.targets.iter().map(|t| -((t.look - s.head).normalize() - head).norm()).collect()
    };
    item.samples.iter().map(scores).collect()
}

//! Rules on one feature, with no or one fitted number.
//!
//! Main functions: [`inverse`] (as published), [`sharpness_of`] and [`sharpened`] (with one number from the training
//! movements), [`enhanced`] (a net overruled by eyes). Refuses: memory.

use super::body::{FRAMES, GAZE, ObjectMove};
use super::score::{ObjectTally, best_of};
use giveway_people::reach::net::squash::softmax;

/// Values of sharpness to try.
const SHARPNESSES: [f64; 10] = [1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 18.0, 27.0, 40.0, 60.0];
/// One of this many frames is enough to choose a sharpness.
const EVERY: usize = 10;
/// A net with a higher probability than this is not overruled (section 5.4.1).
const SURE: f64 = 0.49;
/// Eyes within this of an object are at it (section 5.4.1).
const AT_IT: f64 = 0.2;

fn figures(m: &ObjectMove, frame: usize, feature: usize) -> impl Iterator<Item = f64> {
    (0..m.objects.len()).map(move |o| f64::from(m.figures_at(frame, o)[feature]))
}

/// Probabilities in proportion to the inverse of the feature, as published.
pub fn inverse(m: &ObjectMove, feature: usize, tally: &mut ObjectTally) {
    for frame in 0..FRAMES {
        let mut p: Vec<f64> = figures(m, frame, feature).map(|f| 1.0 / f.max(1e-3)).collect();
        let sum: f64 = p.iter().sum();
        p.iter_mut().for_each(|p| *p /= sum);
        tally.add(m, frame, &p);
    }
}

fn softened(m: &ObjectMove, frame: usize, feature: usize, sharpness: f64) -> Vec<f64> {
    let mut p: Vec<f64> = figures(m, frame, feature).map(|f| -f * sharpness).collect();
    softmax(&mut p);
    p
}

/// The sharpness with the highest likelihood for these movements.
pub fn sharpness_of(moves: &[&ObjectMove], feature: usize) -> f64 {
    let surprise = |sharpness: f64| -> f64 {
        let of = |m: &&ObjectMove| -> f64 {
            let frames = (0..FRAMES).step_by(EVERY);
            frames.map(|f| -libm::log(softened(m, f, feature, sharpness)[m.right].max(1e-9))).sum()
        };
        moves.iter().map(of).sum()
    };
    let tried = SHARPNESSES.map(|s| (surprise(s), s));
    tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(1.0, |best| best.1)
}

/// Probabilities that fall exponentially with the feature.
pub fn sharpened(m: &ObjectMove, feature: usize, sharpness: f64, tally: &mut ObjectTally) {
    (0..FRAMES).for_each(|frame| tally.add(m, frame, &softened(m, frame, feature, sharpness)));
}

/// A net's probabilities by frame, overruled if it is unsure and the eyes are at an object (*Enhanced LSTM*).
pub fn enhanced(m: &ObjectMove, by_frame: &[Vec<f64>], tally: &mut ObjectTally) {
    for (frame, p) in by_frame.iter().enumerate() {
        let gaze: Vec<f64> = figures(m, frame, GAZE).map(|f| -f).collect();
        let (net, eyes) = (best_of(p), best_of(&gaze));
        if p[net] > SURE || -gaze[eyes] > AT_IT {
            tally.add(m, frame, p);
        } else {
            let only: Vec<f64> = (0..p.len()).map(|i| f64::from(u8::from(i == eyes))).collect();
            tally.add(m, frame, &only);
        }
    }
}

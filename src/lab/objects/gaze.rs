//! EG-LSTM: gaze that is not measured is estimated from head and hand (thesis, section 5.2.3).
//!
//! Main functions: [`learn_estimate`], [`with_estimated_gaze`]. The first of three parts of the movements has measured
//! eyes, from which the estimate is learned; in the second and the third they are estimated. The second trains the
//! nets, the third scores them. Refuses: to call its estimates eyes.

use super::body::{BodyFrame, ObjectMove, features};
use crate::learning::picks::{Perceptron, learn_gaze_from};
use giveway_people::reach::ArmVector;
use giveway_sim::random::Stream;

/// Number of inputs of the estimate: position of the hand and direction of the head, in the room's frame.
const SEEN: usize = 6;
/// One of this many frames is learned from.
const EVERY: usize = 10;

fn seen(frame: &BodyFrame) -> [f32; SEEN] {
    let (hand, head) = (frame.hand.0, frame.head.1);
    [hand.x, hand.y, hand.z, head.x, head.y, head.z].map(|v| v as f32)
}

/// Learns the estimate from movements whose eyes were measured.
pub fn learn_estimate(moves: &[&ObjectMove], chance: &mut Stream) -> Perceptron {
    let frames: Vec<&BodyFrame> = moves.iter().flat_map(|m| m.frames.iter().step_by(EVERY)).collect();
    let x: Vec<f32> = frames.iter().flat_map(|f| seen(f)).collect();
    let y: Vec<f32> = frames.iter().flat_map(|f| [f.gaze.x, f.gaze.y, f.gaze.z].map(|v| v as f32)).collect();
    learn_gaze_from(SEEN, &x, &y, chance)
}

/// The movement as known without an eye tracker.
pub fn with_estimated_gaze(estimate: &Perceptron, m: &ObjectMove) -> ObjectMove {
    let x: Vec<f32> = m.frames.iter().flat_map(seen).collect();
    let said = estimate.apply(&x);
    let frame = |(frame, said): (&BodyFrame, &[f32])| {
        let gaze = ArmVector::new(said[0].into(), said[1].into(), said[2].into());
        BodyFrame { gaze: gaze.try_normalize(1e-6).unwrap_or(frame.head.1), ..*frame }
    };
    let frames: Vec<BodyFrame> = m.frames.iter().zip(said.chunks_exact(3)).map(frame).collect();
    let figures = frames.iter().flat_map(|f| m.objects.iter().flat_map(|o| features(f, *o))).collect();
    ObjectMove { frames, figures, objects: m.objects.clone(), ..*m }
}

/// Angles between measured eyes and another direction of the same frames, degrees, of every tenth frame.
pub fn degrees(m: &ObjectMove, other: impl Fn(usize) -> ArmVector) -> Vec<f64> {
    let angle = |i: usize| libm::acos(m.frames[i].gaze.dot(&other(i)).clamp(-1.0, 1.0)).to_degrees();
    (0..m.frames.len()).step_by(EVERY).map(angle).collect()
}

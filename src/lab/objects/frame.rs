//! One frame of a net at run time, for a caller with a clock.
//!
//! Main type: [`FrameBench`]. Weights are random: the cost of a frame does not depend on them. Refuses: a clock.

use super::body::{ObjectMove, ObjectTable};
use super::nets::{ObjectNet, ObjectWatch, random_net};
use super::rows::choice_of;
use crate::learning::picks::PlaceVariant;
use giveway_sim::random::Stream;

/// A net and a movement to run it over.
#[derive(Clone, Debug)]
pub struct FrameBench<'a> {
    net: ObjectNet,
    movement: &'a ObjectMove,
}

impl<'a> FrameBench<'a> {
    /// A variant with a state of this size, and the objects of a movement.
    pub fn new(
        table: ObjectTable,
        variant: PlaceVariant,
        hidden: usize,
        movement: &'a ObjectMove,
    ) -> FrameBench<'a> {
        let mut chance = Stream::new(1, 342, 0);
        let net = random_net(variant, &choice_of(table), hidden, movement.objects.len(), &mut chance);
        FrameBench { net, movement }
    }

    /// Milliseconds per frame by a clock that gives nanoseconds: features, one step for every object, and
    /// probabilities; the mean over the movement.
    pub fn frame_ms(&self, clock: impl Fn() -> u64) -> f64 {
        let mut watch = ObjectWatch::new(&self.net, &self.movement.objects);
        let (begun, mut sum) = (clock(), 0.0);
        for frame in &self.movement.frames {
            watch.observe(frame);
            sum += watch.probabilities()[0];
        }
        let took = clock() - begun;
        assert!(sum.is_finite(), "probabilities are numbers");
        took as f64 * 1e-6 / self.movement.frames.len() as f64
    }
}

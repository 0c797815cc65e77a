//! Where a hand will end, from the movement of the body alone: one recurrent net for all places.
//!
//! Main types: [`EndNet`], [`EndState`]. After every step the net predicts where, as seen from the shoulder, the finger
//! tip will end and in which direction its place will be seen from the head, with a spread each; the probability of a
//! place follows from its distance to both. So the cost does not grow with the number of places, and a new place needs
//! no history. Refuses: to know places.

use super::features::{ArmMotion, BODY};
use super::net::squash::exp;
use super::net::{Affine, Lstm};
use super::sample::{ReachTarget, angles};
use serde::{Deserialize, Serialize};

/// Number of compared coordinates of a place: where the hand ends (three), where it is seen (two).
pub const ENDS: usize = 5;
/// Number of outputs of the net: each coordinate and the logarithm of its sharpness.
pub const END_FIGURES: usize = 2 * ENDS;

/// The net that predicts where a hand ends.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndNet {
    /// From body features ([`BODY`]) to a state.
    pub memory: Lstm,
    /// From the state to [`END_FIGURES`].
    pub out: Affine,
}

/// State of an [`EndNet`] of one person.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EndState {
    h: Vec<f32>,
    c: Vec<f32>,
    z: Vec<f32>,
}

/// Coordinates of a place as the net compares them: relative to the shoulder and to the head.
pub fn end_coordinates(motion: &ArmMotion, target: &ReachTarget) -> [f32; ENDS] {
    let now = motion.now();
    let hand = target.hand - now.shoulder;
    let (yaw, pitch) = angles(target.look - now.head);
    [hand.x * 3.0, hand.y * 3.0, hand.z * 3.0, yaw * 2.0, pitch * 2.0].map(|v| v as f32)
}

/// The score of a place: minus half its squared distance, each coordinate by its sharpness.
pub fn end_score(said: &[f32], place: &[f32; ENDS]) -> f32 {
    let square = |k: usize| {
        let apart = (place[k] - said[k]) * exp(said[ENDS + k]);
        apart * apart
    };
    -0.5 * (0..ENDS).map(square).sum::<f32>()
}

impl EndNet {
    /// A state that has seen nothing.
    pub fn state(&self) -> EndState {
        let n = self.memory.hidden;
        EndState { h: vec![0.0; n], c: vec![0.0; n], z: vec![0.0; 4 * n] }
    }

    /// Copies the state.
    pub fn copy(&self, from: &EndState, to: &mut EndState) {
        to.h.copy_from_slice(&from.h);
        to.c.copy_from_slice(&from.c);
    }

    /// Resets the state.
    pub fn clear(&self, state: &mut EndState) {
        state.h.fill(0.0);
        state.c.fill(0.0);
    }

    /// One step: updates the state with the body features, and writes the net's outputs to `said`.
    pub fn step(&self, state: &mut EndState, body: &[f32; BODY], said: &mut [f32; END_FIGURES]) {
        self.memory.step(body, &mut state.h, &mut state.c, &mut state.z);
        self.out.apply(&state.h, said);
    }

    /// What is wrong with the net's shape or weights, if anything.
    pub fn fault(&self) -> Option<String> {
        self.memory.fault(BODY).or_else(|| self.out.fault(self.memory.hidden, END_FIGURES))
    }
}

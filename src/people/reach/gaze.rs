//! Where the eyes look if only the head is seen.
//!
//! Main type: [`GazeModel`]. Eyes turn farther than heads: the head's angles are stretched, by weights learned from a
//! wearer whose eyes were recorded. If places and their probabilities are known, the estimate is drawn towards them.
//! The result is an estimate and must never be passed off as measured eyes. Refuses: to say which eye.

use super::sample::{ArmPoint, ReachTarget, angles};
use serde::{Deserialize, Serialize};

/// Number of head features that the estimate is linear in.
pub const GAZE_FIGURES: usize = 8;

/// Model of where the eyes look.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeModel {
    /// Weights of [`gaze_figures`] for yaw and pitch.
    pub weights: [[f64; GAZE_FIGURES]; 2],
    /// Share of the distance by which the estimate moves to the probable places, if those are known surely.
    pub drawn: f64,
}

/// Features of head angles (radians) and their speeds (radians per second).
pub fn gaze_figures(head: (f64, f64), speed: (f64, f64)) -> [f64; GAZE_FIGURES] {
    let (yaw, pitch) = head;
    let clamp = |v: f64| v.clamp(-3.0, 3.0);
    [1.0, yaw, pitch, yaw * yaw, pitch * pitch, yaw * pitch, clamp(speed.0), clamp(speed.1)]
}

impl GazeModel {
    /// Yaw and pitch of the eyes from the head alone.
    pub fn from_head(&self, head: (f64, f64), speed: (f64, f64)) -> (f64, f64) {
        let figures = gaze_figures(head, speed);
        let sum = |w: &[f64; GAZE_FIGURES]| w.iter().zip(&figures).map(|(w, f)| w * f).sum();
        (sum(&self.weights[0]), sum(&self.weights[1]))
    }

    /// Yaw and pitch of the eyes, drawn towards the places that a hand may go to.
    pub fn with_places(
        &self,
        head: (f64, f64),
        speed: (f64, f64),
        at: ArmPoint,
        places: &[ReachTarget],
        probabilities: &[f64],
    ) -> (f64, f64) {
        let alone = self.from_head(head, speed);
        let seen = places.iter().map(|p| angles(p.look - at)).zip(probabilities);
        let (mut yaw, mut pitch, mut sure) = (0.0, 0.0, 0.0);
        for (angles, p) in seen {
            (yaw, pitch, sure) = (yaw + angles.0 * p, pitch + angles.1 * p, sure + p * p);
        }
        let all: f64 = probabilities.iter().sum();
        if all < 1e-6 {
            return alone;
        }
        let drawn = self.drawn * sure.min(1.0);
        (alone.0 + (yaw / all - alone.0) * drawn, alone.1 + (pitch / all - alone.1) * drawn)
    }

    /// What is wrong with the model's weights, if anything.
    pub fn fault(&self) -> Option<String> {
        let is_sound = self.weights.iter().flatten().all(|w| w.abs() < 100.0);
        (!is_sound || !(0.0..=1.0).contains(&self.drawn))
            .then(|| "weights must be below 100, drawn from 0 to 1".to_owned())
    }
}

//! Adam (Kingma and Ba 2015): steps along gradients, with a separate step length for every weight.
//!
//! Main type: [`Adam`]. Weights shrink a little at every step (decoupled, Loshchilov and Hutter 2019), and a gradient
//! that is too long is cut. Refuses: gradients of another shape than the weights.

/// Decay of the mean gradient.
const BETA_1: f32 = 0.9;
/// Decay of the gradient's mean square.
const BETA_2: f32 = 0.999;
const EPSILON: f32 = 1e-8;
/// Greatest length of a gradient.
const LONGEST: f32 = 2.0;

/// State that is kept between steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Adam {
    moments: Vec<(f32, f32)>,
    /// The missing share of the sums of both decays' weights.
    missing: Option<(f32, f32)>,
    /// Share of a weight that is lost in a step of length one.
    decay: f32,
}

impl Adam {
    /// An optimiser before its first step; `decay` is the share of a weight that is lost in a step of length one.
    pub fn new(decay: f32) -> Adam {
        Adam { decay, ..Adam::default() }
    }

    /// One step of the given length. Sets gradients to zero for the next batch.
    pub fn step(&mut self, length: f32, weights: &mut [&mut [f32]], gradients: &mut [&mut [f32]]) {
        let count: usize = weights.iter().map(|w| w.len()).sum();
        self.moments.resize(count, (0.0, 0.0));
        let (a, b) = self.missing.unwrap_or((1.0, 1.0));
        let missing = (a * BETA_1, b * BETA_2);
        self.missing = Some(missing);
        let square: f32 = gradients.iter().flat_map(|g| g.iter()).map(|g| g * g).sum();
        let cut = (LONGEST / square.sqrt().max(1e-12)).min(1.0);
        let (c1, c2) = (1.0 - missing.0, 1.0 - missing.1);
        let mut moments = self.moments.iter_mut();
        for (weights, gradients) in weights.iter_mut().zip(gradients.iter_mut()) {
            assert_eq!(weights.len(), gradients.len(), "every weight has its gradient");
            for ((w, g), (m, v)) in weights.iter_mut().zip(gradients.iter_mut()).zip(&mut moments) {
                let cut_g = *g * cut;
                *m = BETA_1 * *m + (1.0 - BETA_1) * cut_g;
                *v = BETA_2 * *v + (1.0 - BETA_2) * cut_g * cut_g;
                let ahead = (*m / c1) / ((*v / c2).sqrt() + EPSILON);
                *w -= length * (ahead + self.decay * *w);
                *g = 0.0;
            }
        }
    }
}

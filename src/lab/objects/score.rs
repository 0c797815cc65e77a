//! How well the object is predicted in the last three seconds: area under the curve and error of the expected location.
//!
//! Main types: [`ObjectTally`], [`ObjectScore`]. Both are given as the sums over 360 frames that the thesis prints and
//! as means. Refuses: movements of another length.

use super::body::{FRAMES, ObjectMove};
use giveway_people::reach::ArmVector;

/// Sums over movements, by frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectTally {
    /// Number of movements whose right object was the most probable.
    right: Vec<f64>,
    /// Sums of the normalised errors of the expected location.
    error: Vec<f64>,
    /// Number of movements.
    count: Vec<f64>,
}

impl Default for ObjectTally {
    fn default() -> ObjectTally {
        ObjectTally { right: vec![0.0; FRAMES], error: vec![0.0; FRAMES], count: vec![0.0; FRAMES] }
    }
}

/// The figures of one predictor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectScore {
    /// Share of right answers, averaged over frames.
    pub auc_mean: f64,
    /// Expected distance from the right object in mean distances of all objects (equation 5.1), mean over frames.
    pub error_mean: f64,
}

impl ObjectScore {
    /// The sum over frames of the share of right answers, from 0 to 360, as the thesis prints it.
    pub fn auc_sum(&self) -> f64 {
        self.auc_mean * FRAMES as f64
    }

    /// The sum over frames of the errors, as the thesis prints it.
    pub fn error_sum(&self) -> f64 {
        self.error_mean * FRAMES as f64
    }
}

/// The index of the first of the largest numbers.
pub(super) fn best_of(scores: &[f64]) -> usize {
    let larger = |best: usize, i: usize| if scores[i] > scores[best] { i } else { best };
    (0..scores.len()).fold(0, larger)
}

impl ObjectTally {
    /// Adds one frame of a movement with the probabilities of its objects.
    pub fn add(&mut self, m: &ObjectMove, frame: usize, probabilities: &[f64]) {
        let right = m.objects[m.right];
        let mean: ArmVector = m.objects.iter().zip(probabilities).map(|(o, p)| o.coords * *p).sum();
        let all: f64 = m.objects.iter().map(|o| (o - right).norm()).sum();
        self.right[frame] += f64::from(u8::from(best_of(probabilities) == m.right));
        self.error[frame] += m.objects.len() as f64 * (mean - right.coords).norm() / all;
        self.count[frame] += 1.0;
    }

    /// Adds the counts of another tally.
    pub fn merge(&mut self, other: &ObjectTally) {
        let pairs = [
            (&mut self.right, &other.right),
            (&mut self.error, &other.error),
            (&mut self.count, &other.count),
        ];
        for (ours, theirs) in pairs {
            ours.iter_mut().zip(theirs).for_each(|(a, b)| *a += b);
        }
    }

    /// The score; nothing if there are no movements.
    pub fn score(&self) -> Option<ObjectScore> {
        let count: f64 = self.count.iter().sum();
        let mean = |sums: &[f64]| sums.iter().sum::<f64>() / count;
        (count > 0.0).then(|| ObjectScore { auc_mean: mean(&self.right), error_mean: mean(&self.error) })
    }

    /// Share of right answers within some frames.
    pub fn right_within(&self, frames: std::ops::Range<usize>) -> f64 {
        let count: f64 = self.count[frames.clone()].iter().sum();
        self.right[frames].iter().sum::<f64>() / count.max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_people::reach::ArmPoint;

    fn movement() -> ObjectMove {
        let objects = [0.0, 1.0, 3.0].map(|x| ArmPoint::new(x, 0.0, 1.0)).to_vec();
        ObjectMove { person: 0, frames: Vec::new(), objects, right: 0, figures: Vec::new() }
    }

    #[test]
    fn the_error_is_counted_in_mean_distances_as_equation_5_1_has_it() {
        let m = movement();
        let mut tally = ObjectTally::default();
        (0..FRAMES).for_each(|f| tally.add(&m, f, &[0.5, 0.5, 0.0]));
        let score = tally.score().unwrap();
        // 3 × 0.5 m over 4 m.
        assert!((score.error_mean - 0.375).abs() < 1e-12 && (score.error_sum() - 135.0).abs() < 1e-9);
        assert_eq!(score.auc_sum(), 360.0, "of equals the first counts");
    }

    #[test]
    fn a_right_answer_from_half_way_on_is_half_the_area() {
        let m = movement();
        let mut tally = ObjectTally::default();
        for f in 0..FRAMES {
            let p = if f < FRAMES / 2 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
            tally.add(&m, f, &p);
        }
        let mut both = ObjectTally::default();
        both.merge(&tally);
        both.merge(&tally);
        assert_eq!(both.score(), tally.score());
        assert_eq!(tally.score().unwrap().auc_sum(), 180.0);
        assert_eq!((tally.right_within(0..180), tally.right_within(180..360)), (0.0, 1.0));
    }
}

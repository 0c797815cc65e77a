//! Means, deviations and intervals of small samples.
//!
//! Main types: [`Summary`], [`Interval`]. Refuses: samples of different lengths as pairs.

/// Mean and standard deviation of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Mean; nothing for an empty sample.
    pub mean: Option<f64>,
    /// Standard deviation of the sample (divisor n − 1); nothing for fewer than two.
    pub sd: Option<f64>,
}

/// A mean with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The mean; nothing for an empty sample.
    pub mean: Option<f64>,
    /// Interval that contains the true mean for 95 of 100 such samples (Student 1908); nothing for fewer than two.
    pub ci95: Option<(f64, f64)>,
}

impl Summary {
    /// The summary of these numbers.
    pub fn of(sample: &[f64]) -> Summary {
        let n = sample.len() as f64;
        let mean = sample.iter().sum::<f64>() / n;
        let squares: f64 = sample.iter().map(|x| (x - mean).powi(2)).sum();
        Summary {
            mean: (!sample.is_empty()).then_some(mean),
            sd: (sample.len() > 1).then(|| (squares / (n - 1.0)).sqrt()),
        }
    }
}

impl Interval {
    /// The interval of these numbers.
    pub fn of(sample: &[f64]) -> Interval {
        let Summary { mean, sd } = Summary::of(sample);
        let ci95 = mean.zip(sd).map(|(mean, sd)| {
            let half = student975(sample.len() - 1) * sd / (sample.len() as f64).sqrt();
            (mean - half, mean + half)
        });
        Interval { mean, ci95 }
    }

    /// The interval of `ours − theirs`, pair by pair.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn of_pairs(ours: &[f64], theirs: &[f64]) -> Interval {
        assert_eq!(ours.len(), theirs.len(), "every number has its pair");
        let differences: Vec<f64> = ours.iter().zip(theirs).map(|(a, b)| a - b).collect();
        Interval::of(&differences)
    }
}

/// The 97.5 % quantile of Student's distribution with this many degrees of freedom.
pub fn student975(freedom: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1000.0);
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if tails(middle, freedom) > 0.05 { low = middle } else { high = middle }
    }
    (low + high) / 2.0
}

/// Probability that Student's variable is farther from zero than `t`: a finite sum for whole degrees of freedom
/// (Abramowitz and Stegun 1964, 26.7.3 and 26.7.4).
fn tails(t: f64, freedom: usize) -> f64 {
    let angle = (t / (freedom as f64).sqrt()).atan();
    let cos2 = angle.cos().powi(2);
    // Each term is the previous one times (k / (k + 1)) cos².
    let series = |first: f64, from: usize| {
        let mut sum = 0.0;
        let mut term = first;
        let mut k = from;
        while k < freedom {
            sum += term;
            term *= k as f64 / (k + 1) as f64 * cos2;
            k += 2;
        }
        sum
    };
    let within = if freedom.is_multiple_of(2) {
        angle.sin() * series(1.0, 1)
    } else {
        std::f64::consts::FRAC_2_PI * (angle + angle.sin() * series(angle.cos(), 2))
    };
    1.0 - within
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_printed_tables() {
        let table = [(1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (9, 2.262), (10, 2.228), (30, 2.042)];
        for (freedom, quantile) in table {
            let found = student975(freedom);
            assert!((found - quantile).abs() < 6e-4, "{freedom}: {found}, not {quantile}");
        }
        assert!((student975(2000) - 1.961).abs() < 1e-3);
    }

    #[test]
    fn the_interval_of_paired_differences_is_the_one_worked_out_by_hand() {
        // Differences 1, 2, 3: mean 2, deviation 1, half width 4.303 / √3 = 2.484.
        let paired = Interval::of_pairs(&[2.0, 4.0, 6.0], &[1.0, 2.0, 3.0]);
        let (low, high) = paired.ci95.unwrap();
        assert!((paired.mean.unwrap() - 2.0).abs() < 1e-12);
        assert!((low + 0.484).abs() < 1e-3 && (high - 4.484).abs() < 1e-3, "{low} {high}");
    }

    #[test]
    fn one_pair_has_no_interval_and_no_numbers_have_no_mean() {
        assert_eq!(Interval::of_pairs(&[2.0], &[1.0]), Interval { mean: Some(1.0), ci95: None });
        assert_eq!(Summary::of(&[]), Summary { mean: None, sd: None });
        assert_eq!(Summary::of(&[1.0, 3.0]).sd, Some(2f64.sqrt()));
    }
}

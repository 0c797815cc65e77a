//! Exponential, sigmoid and hyperbolic tangent of many numbers at once.
//!
//! Main functions: [`exp`], [`sigmoid`], [`tanh`]. They use additions, multiplications and divisions only, so their
//! bits are equal on every machine, and the compiler may vectorise them: gates take most of a net's time. Decisions
//! afterwards (probabilities) are computed with `libm` in double precision. Refuses: more accuracy than single
//! precision holds.

/// Adding this moves the integer part of a small number into the lowest bits.
const SHIFT: f32 = 12_582_912.0;
/// The upper part of ln 2: its product with a small integer is exact.
const LN2_HIGH: f32 = 0.693_359_4;
/// The rest of ln 2.
const LN2_LOW: f32 = -2.121_944_4e-4;

/// e to the power of `x`, which is clamped to −80 to 80. Relative error below 3e-7: argument reduced by multiples of ln
/// 2, then the Taylor series.
#[inline]
pub fn exp(x: f32) -> f32 {
    let x = x.clamp(-80.0, 80.0);
    let shifted = x * std::f32::consts::LOG2_E + SHIFT;
    let whole = shifted - SHIFT;
    let power = shifted.to_bits().wrapping_sub(SHIFT.to_bits()).wrapping_add(127) << 23;
    let r = x - whole * LN2_HIGH - whole * LN2_LOW;
    let series = 1.0 / 720.0 * r + 1.0 / 120.0;
    let series = series * r + 1.0 / 24.0;
    let series = series * r + 1.0 / 6.0;
    let series = series * r + 0.5;
    ((series * r + 1.0) * r + 1.0) * f32::from_bits(power)
}

/// 1 / (1 + e^−x).
#[inline]
pub fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}

/// The hyperbolic tangent.
#[inline]
pub fn tanh(x: f32) -> f32 {
    2.0 * sigmoid(2.0 * x) - 1.0
}

/// Turns scores into probabilities that sum to one, in double precision; an empty list stays empty.
pub fn softmax(scores: &mut [f64]) {
    let highest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut sum = 0.0;
    for s in scores.iter_mut() {
        *s = libm::exp(*s - highest);
        sum += *s;
    }
    scores.iter_mut().for_each(|s| *s /= sum);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_functions_agree_with_libm() {
        for i in -3000..=3000 {
            let x = i as f32 * 0.01;
            let (wide, f) = (f64::from(x), f64::from);
            assert!((f(exp(x)) / libm::exp(wide) - 1.0).abs() < 5e-6, "exp of {x}");
            assert!((f(tanh(x)) - libm::tanh(wide)).abs() < 1e-6, "tanh of {x}");
            assert!((f(sigmoid(x)) - 1.0 / (1.0 + libm::exp(-wide))).abs() < 1e-6, "sigmoid of {x}");
        }
    }

    #[test]
    fn probabilities_sum_to_one_even_where_scores_are_huge() {
        let mut scores = [1e6, 1e6 - 1.0, -1e6];
        softmax(&mut scores);
        assert!((scores.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((scores[0] / scores[1] - std::f64::consts::E).abs() < 1e-9 && scores[2] == 0.0);
    }
}

//! How long things took, in classes a quarter of an octave wide: quantiles of many values, in few bytes, to be added.
//!
//! Main type: [`Lengths`]. A quantile is off by at most a tenth. Refuses: single values, except the longest.

use std::collections::BTreeMap;

/// Classes per octave.
const PER_OCTAVE: f64 = 4.0;

/// The last class: 2^32 µs, more than an hour.
const LAST: u8 = 128;

/// Lengths of time in microseconds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lengths {
    classes: BTreeMap<u8, u64>,
    max_us: u64,
}

impl Lengths {
    /// Takes in one length, microseconds.
    pub fn note(&mut self, us: u64) {
        let class = (PER_OCTAVE * (us.max(1) as f64).log2()).floor() as u8;
        *self.classes.entry(class.min(LAST)).or_default() += 1;
        self.max_us = self.max_us.max(us);
    }

    /// Takes in all lengths of another value.
    pub fn add(&mut self, other: &Lengths) {
        for (class, n) in &other.classes {
            *self.classes.entry(*class).or_default() += n;
        }
        self.max_us = self.max_us.max(other.max_us);
    }

    /// How many lengths there are.
    pub fn count(&self) -> u64 {
        self.classes.values().sum()
    }

    /// The longest length, microseconds.
    pub fn max_us(&self) -> u64 {
        self.max_us
    }

    /// The length that this many percent do not exceed, microseconds: the middle of a class; nothing if there are none.
    pub fn quantile_us(&self, percent: u64) -> Option<u64> {
        let wanted = (self.count() * percent).div_ceil(100).max(1);
        let mut passed = 0;
        for (class, n) in &self.classes {
            passed += n;
            if passed >= wanted {
                let middle = ((f64::from(*class) + 0.5) / PER_OCTAVE).exp2();
                return Some((middle.round() as u64).min(self.max_us));
            }
        }
        None
    }

    /// The lengths as text, to be stored: `class:count` with blanks between, then the longest.
    pub fn text(&self) -> String {
        let classes = self.classes.iter().map(|(class, n)| format!("{class}:{n} "));
        format!("{}max:{}", classes.collect::<String>(), self.max_us)
    }

    /// Reads such a text; nothing if it is not one.
    pub fn parse(text: &str) -> Option<Lengths> {
        let mut out = Lengths::default();
        for word in text.split(' ') {
            match word.split_once(':')? {
                ("max", n) => out.max_us = n.parse().ok()?,
                (class, n) => _ = out.classes.insert(class.parse().ok()?, n.parse().ok()?),
            }
        }
        Some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_off_by_at_most_a_tenth_and_lengths_can_be_added() {
        let (mut low, mut high) = (Lengths::default(), Lengths::default());
        (1..=500).for_each(|us| low.note(us * 10));
        (501..=1000).for_each(|us| high.note(us * 10));
        low.add(&high);
        for (percent, exact) in [(50, 5000.0), (95, 9500.0), (1, 100.0)] {
            let told = low.quantile_us(percent).unwrap() as f64;
            assert!((told / exact - 1.0).abs() < 0.1, "{percent} %: {told}, not {exact}");
        }
        assert_eq!((low.max_us(), low.count()), (10_000, 1000));
        assert_eq!(Lengths::default().quantile_us(50), None);
    }

    #[test]
    fn what_is_written_down_is_read_again_and_anything_else_is_not() {
        let mut lengths = Lengths::default();
        [0, 1, 700, u64::MAX].iter().for_each(|us| lengths.note(*us));
        assert_eq!(Lengths::parse(&lengths.text()), Some(lengths.clone()));
        assert_eq!(Lengths::parse(&Lengths::default().text()), Some(Lengths::default()));
        assert_eq!(lengths.quantile_us(100), Some(((128.5f64 / 4.0).exp2()).round() as u64));
        for bad in ["", "7", "999:1 max:3", "4:x max:3"] {
            assert_eq!(Lengths::parse(bad), None, "{bad}");
        }
    }
}

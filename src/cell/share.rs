//! How often the person at a work cell goes to the lit slot, before anything is seen of the hand.
//!
//! Main type: [`LitShare`]. It is learned from this person's reaches and kept no longer than the hands are seen.
//! Refuses: to become so sure of a person that no wrong reach would be warned of.

/// Share of a person who was not seen yet, and the number of reaches that it counts for.
const LIT: f64 = 0.985;
const PRIOR_REACHES: f64 = 200.0;
/// Bounds of the share, whatever was learned.
const LEAST: f64 = 0.8;
const MOST: f64 = 0.998;

/// Reaches to the lit slot and all reaches, including the ones that stand for prior knowledge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LitShare {
    lit: f64,
    all: f64,
}

impl Default for LitShare {
    fn default() -> LitShare {
        LitShare { lit: LIT * PRIOR_REACHES, all: PRIOR_REACHES }
    }
}

impl LitShare {
    /// Learns whether a reach went to the lit slot or to another one.
    pub fn learn(&mut self, is_lit: bool) {
        self.lit += f64::from(u8::from(is_lit));
        self.all += 1.0;
    }

    /// The share of reaches that go to the lit slot.
    pub fn get(&self) -> f64 {
        (self.lit / self.all).clamp(LEAST, MOST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_the_lit_slot_is_learned_and_never_certain() {
        let learned = |wrong: usize, of: usize| {
            let mut share = LitShare::default();
            (0..of).for_each(|i| share.learn(i >= wrong));
            share.get()
        };
        assert!((learned(0, 0) - LIT).abs() < 1e-12);
        assert!(learned(20, 200) < 0.95 && learned(20, 200) > 0.9, "{}", learned(20, 200));
        assert!((learned(0, 100_000) - MOST).abs() < 1e-12);
        assert!((learned(5000, 5000) - LEAST).abs() < 1e-12);
    }
}

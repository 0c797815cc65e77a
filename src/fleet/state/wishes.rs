//! How often each rack was wanted lately: a fading count over accepted jobs.
//!
//! Main type: [`Wishes`]. Refuses: to know where racks are.

use giveway_floor::id::{IdVec, RackId};

/// When this many wishes per rack have been counted, all counts are halved, so that old wishes fade.
const HALVE_AT: u64 = 4;

/// How often each rack was wanted lately.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wishes {
    racks: IdVec<RackId, u32>,
    total: u64,
}

impl Wishes {
    /// Counts of zero: no rack was ever wanted.
    pub fn none(racks: usize) -> Wishes {
        Wishes::of(vec![0; racks])
    }

    /// The wishes with these counts, by rack.
    pub fn of(counts: Vec<u32>) -> Wishes {
        let total = counts.iter().map(|w| u64::from(*w)).sum();
        Wishes { racks: counts.into(), total }
    }

    /// How often each rack was wanted, by rack.
    pub fn counts(&self) -> &IdVec<RackId, u32> {
        &self.racks
    }

    /// Counts one wish.
    pub(crate) fn note(&mut self, rack: RackId) {
        self.racks[rack] += 1;
        self.total += 1;
        if self.total > HALVE_AT * self.racks.len() as u64 {
            self.racks.iter_mut().for_each(|w| *w /= 2);
            self.total = self.racks.iter().map(|w| u64::from(*w)).sum();
        }
    }

    /// How wanted a rack is, relative to the mean: 0 never, 1 average, 3 at most.
    pub(crate) fn heat(&self, rack: RackId) -> f64 {
        if self.total == 0 {
            return 1.0;
        }
        let mean = self.total as f64 / self.racks.len() as f64;
        (f64::from(self.racks[rack]) / mean).min(3.0)
    }
}

//! Where robots waited, and for how long: seconds per place, in buckets of five minutes, for a day.
//!
//! Main types: [`Heat`], [`HeatBucket`]. In each bucket, the places with the most waiting are kept, 2000 at most.
//! Refuses: to know which robots waited, or why.

use super::floor;
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, VecDeque};

/// Length of a bucket.
pub const STEP: Span = Span::from_secs(300);

/// How many buckets are kept: a day.
pub const DAY: usize = 288;

/// How many places are kept in a bucket.
const PLACES: usize = 2000;

/// Waiting in one span of time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HeatBucket {
    /// When the bucket began.
    pub start: Time,
    /// How long robots waited at each node.
    pub waited: BTreeMap<NodeId, Span>,
}

/// Waiting over time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Heat {
    buckets: VecDeque<HeatBucket>,
}

impl Heat {
    /// The heat with the buckets that were kept of earlier runs, in any order.
    pub fn restore(mut kept: Vec<HeatBucket>) -> Heat {
        kept.sort_by_key(|b| b.start);
        let skip = kept.len().saturating_sub(DAY);
        Heat { buckets: kept.into_iter().skip(skip).collect() }
    }

    /// Notes that robots waited at these places for this long.
    pub fn note(&mut self, now: Time, span: Span, places: &[NodeId]) {
        let start = floor(now, STEP);
        if self.buckets.back().is_none_or(|b| b.start != start) {
            if let Some(last) = self.buckets.back_mut() {
                last.thin_out();
            }
            self.buckets.push_back(HeatBucket { start, waited: BTreeMap::new() });
            while self.buckets.len() > DAY {
                self.buckets.pop_front();
            }
        }
        let Some(bucket) = self.buckets.back_mut() else { return };
        for place in places {
            *bucket.waited.entry(*place).or_default() += span;
        }
        if bucket.waited.len() > 2 * PLACES {
            bucket.thin_out();
        }
    }

    /// How long robots waited at each node, in all buckets from `from` on and before `to`.
    pub fn read(&self, from: Time, to: Time) -> BTreeMap<NodeId, Span> {
        let mut out = BTreeMap::new();
        for bucket in self.buckets.iter().filter(|b| floor(from, STEP) <= b.start && b.start < to) {
            for (place, span) in &bucket.waited {
                *out.entry(*place).or_default() += *span;
            }
        }
        out
    }

    /// Buckets that changed since `saved`.
    pub fn since(&self, saved: Time) -> Vec<HeatBucket> {
        self.buckets.iter().rev().take_while(|b| b.start + STEP > saved).cloned().collect()
    }

    pub(super) fn forget_after(&mut self, now: Time) {
        self.buckets.retain(|b| b.start < floor(now, STEP));
    }
}

impl HeatBucket {
    /// Keeps the places with the most waiting.
    fn thin_out(&mut self) {
        if self.waited.len() > PLACES {
            let mut all: Vec<_> = std::mem::take(&mut self.waited).into_iter().collect();
            all.sort_by_key(|(place, span)| (std::cmp::Reverse(*span), *place));
            self.waited = all.into_iter().take(PLACES).collect();
        }
    }
}

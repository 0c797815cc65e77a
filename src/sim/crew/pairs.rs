//! Which simulated workers walk in pairs, and where the second of a pair works.
//!
//! Main type: [`Pairs`]. The second of a pair works next to the first, so that they have the same way to work; each has
//! assignments and a headset of its own. Refuses: to draw from the streams of workers who walk alone.

use crate::random::Stream;
use giveway_floor::geometry::Point;

/// Purpose of the stream, see [`Stream::new`].
const PURPOSE: u64 = 35;

/// For each worker, the other one of the pair, if there is one.
#[derive(Clone, Debug)]
pub(super) struct Pairs(Vec<Option<usize>>);

impl Pairs {
    /// Pairs workers with neighbouring numbers, each pair with the probability `share`.
    pub fn draw(share: f64, count: usize, seed: u64) -> Pairs {
        let pair = |k: u64| Stream::new(seed, PURPOSE, k).happens_of(share);
        let mate = |i: usize| (i ^ 1 < count && pair(i as u64 / 2)).then_some(i ^ 1);
        Pairs((0..count).map(mate).collect())
    }

    /// The other worker of the pair, if there is one; drivers have none.
    pub fn mate(&self, worker: usize) -> Option<usize> {
        self.0.get(worker).copied().flatten()
    }

    /// The worker that decides where this one works: the first of the pair, or the worker itself if it has no mate.
    pub fn leader(&self, worker: usize) -> usize {
        self.mate(worker).map_or(worker, |mate| mate.min(worker))
    }
}

/// The place nearest to place number `place`, as a number.
pub(super) fn next_to(place: usize, places: &[Point]) -> usize {
    let far = |i: &usize| (places[*i] - places[place]).norm();
    let others = (0..places.len()).filter(|i| *i != place);
    others.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_workers_in_pairs_is_as_stated_and_everybody_has_one_mate() {
        for (share, low, high) in [(0.0, 0, 0), (0.2, 700, 900), (1.0, 4000, 4000)] {
            let mut paired = 0;
            for seed in 0..20 {
                let pairs = Pairs::draw(share, 200, seed);
                let found: Vec<usize> = (0..200).filter(|i| pairs.mate(*i).is_some()).collect();
                assert!(found.iter().all(|i| pairs.mate(*i).and_then(|m| pairs.mate(m)) == Some(*i)));
                paired += found.len();
            }
            assert!((low..=high).contains(&paired), "{paired} at {share}");
        }
        assert_eq!(Pairs::draw(1.0, 3, 7).mate(2), None, "there is nobody left");
    }

    #[test]
    fn the_second_of_a_pair_works_at_the_next_place() {
        let places = [0.0, 5.0, 6.0].map(|x| Point::new(x, 0.0));
        assert_eq!([0, 1, 2].map(|i| next_to(i, &places)), [1, 2, 1]);
    }
}

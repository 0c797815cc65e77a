//! Whether corners form a valid outline: in the order in which one walks around an area.
//!
//! Main function: [`outline_area_m2`]. Refuses: to put corners in order, which would be a guess.

use super::{FARTHEST_M, Point, Segment};
use crate::text::sentence::requests;
use crate::text::{Sentence, SentenceArg};
use std::fmt;

/// Least area of an outline, square metres; small, since openings of cells are thin.
const FLAT_M2: f64 = 1e-4;

/// Why some corners are not an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineFault {
    /// The outline has too few corners; this many remain without those that repeat the one before.
    Corners(usize),
    /// The corner with this number, from 1, is not finite or is farther away than any map reaches.
    Far(usize),
    /// The outline encloses next to nothing; its area in square metres.
    Flat(f64),
    /// The sides that begin at these corners, counted from 1, cross, touch or overlap.
    Crosses(usize, usize),
}

impl OutlineFault {
    /// The fault and its remedy.
    pub fn sentence(&self) -> Sentence {
        match self {
            OutlineFault::Corners(n) => requests::outline_corners(*n),
            OutlineFault::Far(i) => requests::outline_far(*i, FARTHEST_M as i64),
            OutlineFault::Flat(m2) => requests::outline_flat(SentenceArg::rounded(*m2, 6)),
            OutlineFault::Crosses(i, j) => requests::outline_crosses(*i, *j),
        }
    }
}

impl fmt::Display for OutlineFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence().text())
    }
}

/// The area inside an outline, square metres. A corner that repeats the one before, or the first one at the end, is
/// skipped.
///
/// # Errors
/// Why the corners are not an outline.
pub fn outline_area_m2(corners: &[Point]) -> Result<f64, OutlineFault> {
    let is_far = |p: &Point| [p.x, p.y].iter().any(|v| !v.is_finite() || v.abs() > FARTHEST_M);
    if let Some(i) = corners.iter().position(is_far) {
        return Err(OutlineFault::Far(i + 1));
    }
    let mut ring: Vec<(usize, Point)> = (1..).zip(corners.iter().copied()).collect();
    ring.dedup_by_key(|(_, p)| *p);
    while ring.len() > 1 && ring[ring.len() - 1].1 == ring[0].1 {
        ring.pop();
    }
    if ring.len() < 3 {
        return Err(OutlineFault::Corners(ring.len()));
    }
    let n = ring.len();
    let side = |i: usize| Segment { a: ring[i].1, b: ring[(i + 1) % n].1 };
    let folds = |i: usize| {
        let (s, t) = (side(i), side((i + 1) % n));
        let (s, t) = (s.b - s.a, t.b - t.a);
        s.perp(&t) == 0.0 && s.dot(&t) < 0.0
    };
    let neighbours = |i: usize, j: usize| i + 1 == j || i == 0 && j == n - 1;
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    let mut apart = pairs.filter(|(i, j)| !neighbours(*i, *j));
    // Relative to a corner, so that no digits are lost far from the map's zero.
    let area = (0..n).map(|i| (ring[i].1 - ring[0].1).perp(&(ring[(i + 1) % n].1 - ring[0].1))).sum::<f64>();
    let area = area.abs() / 2.0;
    if let Some((i, j)) = apart.find(|(i, j)| meet(side(*i), side(*j))) {
        return Err(OutlineFault::Crosses(ring[i].0, ring[j].0));
    }
    if area < FLAT_M2 {
        return Err(OutlineFault::Flat(area));
    }
    match (0..n).find(|i| folds(*i)) {
        Some(i) => Err(OutlineFault::Crosses(ring[i].0, ring[(i + 1) % n].0)),
        None => Ok(area),
    }
}

/// Whether two segments have a point in common.
fn meet(s: Segment, t: Segment) -> bool {
    let turn = |a: Point, b: Point, c: Point| {
        let turn = (b - a).perp(&(c - a));
        if turn == 0.0 { 0 } else { turn.signum() as i32 }
    };
    let on = |s: Segment, p: Point| {
        let between = |a: f64, b: f64, v: f64| a.min(b) <= v && v <= a.max(b);
        between(s.a.x, s.b.x, p.x) && between(s.a.y, s.b.y, p.y)
    };
    let (sa, sb) = (turn(t.a, t.b, s.a), turn(t.a, t.b, s.b));
    let (ta, tb) = (turn(s.a, s.b, t.a), turn(s.a, s.b, t.b));
    sa * sb < 0 && ta * tb < 0
        || sa == 0 && on(t, s.a)
        || sb == 0 && on(t, s.b)
        || ta == 0 && on(s, t.a)
        || tb == 0 && on(s, t.b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(corners: &[(f64, f64)]) -> Result<f64, OutlineFault> {
        outline_area_m2(&corners.iter().map(|c| Point::new(c.0, c.1)).collect::<Vec<_>>())
    }

    #[test]
    fn outlines_in_order_have_their_area() {
        assert_eq!(area(&[(2.0, 4.0), (8.0, 4.0), (8.0, 9.0), (2.0, 9.0)]), Ok(30.0));
        assert_eq!(area(&[(0.0, 0.0), (0.0, 2.0), (2.0, 0.0)]), Ok(2.0), "clockwise");
        // An L, and one that is closed by its first corner as in GeoJSON, with a corner given twice.
        assert_eq!(area(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]), Ok(3.0));
        assert_eq!(area(&[(0.0, 0.0), (2.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 0.0)]), Ok(2.0));
        // A corner on a straight side; far from the map's zero.
        assert_eq!(area(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0)]), Ok(1.0));
        assert_eq!(
            area(&[(9e4, -9e4), (9e4 + 0.5, -9e4), (9e4 + 0.5, -9e4 + 0.5), (9e4, -9e4 + 0.5)]),
            Ok(0.25)
        );
    }

    #[test]
    fn outlines_that_mean_something_else_are_refused_with_the_reason() {
        let crosses = Err(OutlineFault::Crosses(1, 3));
        assert_eq!(area(&[(2.0, 4.0), (8.0, 9.0), (8.0, 4.0), (2.0, 8.0)]), crosses, "a bow tie");
        assert_eq!(area(&[(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0)]), crosses, "one without area");
        for crossed in [
            // A star, a bow tie whose crossing is a corner, a spike, a side that overlaps another one, a pinched waist.
            &[(0.0, 3.0), (2.0, -3.0), (-3.0, 1.0), (3.0, 1.0), (-2.0, -3.0)][..],
            &[(0.0, 0.0), (2.0, 2.0), (4.0, 4.0), (4.0, 0.0), (2.0, 2.0), (0.0, 4.0)],
            &[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (2.0, 5.0), (2.0, 2.0), (0.0, 2.0)],
            &[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (3.0, 2.0), (1.0, 2.0), (0.0, 2.0)],
            &[(0.0, 0.0), (2.0, 1.0), (4.0, 0.0), (4.0, 2.0), (2.0, 1.0), (0.0, 2.0)],
        ] {
            assert!(
                matches!(area(crossed), Err(OutlineFault::Crosses(..))),
                "{crossed:?}: {:?}",
                area(crossed)
            );
        }
        assert_eq!(area(&[]), Err(OutlineFault::Corners(0)));
        assert_eq!(area(&[(1.0, 1.0), (1.0, 1.0), (2.0, 2.0), (1.0, 1.0)]), Err(OutlineFault::Corners(2)));
        assert_eq!(area(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]), Err(OutlineFault::Flat(0.0)));
        assert_eq!(area(&[(0.0, 0.0), (0.01, 0.0), (0.0, 0.01)]), Err(OutlineFault::Flat(0.00005)));
        assert_eq!(area(&[(0.0, 0.0), (1.0, f64::NAN), (2.0, 2.0)]), Err(OutlineFault::Far(2)));
        assert_eq!(area(&[(0.0, 0.0), (1.0, 0.0), (2.0, 1e6)]), Err(OutlineFault::Far(3)));
    }

    proptest! {
        /// Corners around a point make an outline; with two of them swapped, it crosses itself.
        #[test]
        fn a_round_outline_is_taken_and_one_with_two_corners_swapped_is_not(
            radii in prop::collection::vec(4.0f64..5.0, 5..12),
            x in -50_000.0f64..50_000.0,
        ) {
            let n = radii.len();
            let corner = |(i, r): (usize, &f64)| {
                let (sin, cos) = (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
                (x + r * cos, r * sin)
            };
            let mut corners: Vec<(f64, f64)> = radii.iter().enumerate().map(corner).collect();
            prop_assert!(area(&corners).is_ok(), "{:?}", area(&corners));
            corners.swap(1, 3);
            prop_assert!(matches!(area(&corners), Err(OutlineFault::Crosses(..))));
        }
    }
}

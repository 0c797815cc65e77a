//! Points in square buckets, to find the points near a place.
//!
//! Main type: [`PointIndex`]. Refuses: points that move; it is built once.

use crate::geometry::Point;

/// Side of a bucket, metres.
const SIDE: f64 = 2.0;

/// Numbered points, sorted into buckets.
#[derive(Clone, Debug, Default)]
pub(super) struct PointIndex {
    low: Point,
    columns: usize,
    rows: usize,
    /// Where each bucket begins in `members`, and the end of the last.
    start: Vec<u32>,
    /// Numbers, bucket by bucket, ascending in each.
    members: Vec<u32>,
    points: Vec<Point>,
}

impl PointIndex {
    /// Sorts the points, which are numbered in the order given.
    pub fn new(points: Vec<Point>) -> PointIndex {
        let Some(&first) = points.first() else { return PointIndex::default() };
        let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
        let count = |extent: f64| (extent / SIDE).floor() as usize + 1;
        let (columns, rows) = (count(high.x - low.x), count(high.y - low.y));
        let mut near =
            PointIndex { low, columns, rows, start: vec![0; columns * rows + 1], ..PointIndex::default() };
        let buckets: Vec<usize> = points.iter().map(|p| near.bucket(*p)).collect();
        buckets.iter().for_each(|b| near.start[b + 1] += 1);
        for b in 0..columns * rows {
            near.start[b + 1] += near.start[b];
        }
        let mut next = near.start.clone();
        near.members = vec![0; points.len()];
        for (i, &b) in buckets.iter().enumerate() {
            near.members[next[b] as usize] = i as u32;
            next[b] += 1;
        }
        near.points = points;
        near
    }

    fn bucket(&self, p: Point) -> usize {
        let column = (((p.x - self.low.x) / SIDE) as usize).min(self.columns - 1);
        let row = (((p.y - self.low.y) / SIDE) as usize).min(self.rows - 1);
        row * self.columns + column
    }

    /// The points no farther than `radius` (metres) from `at`, ascending, with their distances in metres.
    pub fn within(&self, at: Point, radius: f64) -> Vec<(usize, f64)> {
        let mut found = Vec::new();
        self.each_within(at, radius, |i, distance| found.push((i, distance)));
        found.sort_unstable_by_key(|(i, _)| *i);
        found
    }

    /// Calls `each` with the points no farther than `radius` (metres), in no stated order, and with their distances.
    pub fn each_within(&self, at: Point, radius: f64, mut each: impl FnMut(usize, f64)) {
        let span = |from: f64, count: usize| {
            let first = ((from - radius) / SIDE).floor().max(0.0) as usize;
            let last = ((from + radius) / SIDE).floor();
            // An empty range if the place is beyond all buckets.
            if last < 0.0 { 0..0 } else { first..(last as usize + 1).min(count) }
        };
        for row in span(at.y - self.low.y, self.rows) {
            for column in span(at.x - self.low.x, self.columns) {
                let b = row * self.columns + column;
                for &i in &self.members[self.start[b] as usize..self.start[b + 1] as usize] {
                    let distance = (self.points[i as usize] - at).norm();
                    if distance <= radius {
                        each(i as usize, distance);
                    }
                }
            }
        }
    }

    /// The nearest point, the first of equals; nothing if there are no points.
    pub fn nearest(&self, at: Point) -> Option<(usize, f64)> {
        let far = SIDE * (self.columns + self.rows) as f64 + (at - self.low).norm();
        let mut radius = SIDE;
        loop {
            let found = self.within(at, radius);
            let best = found.into_iter().min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            if best.is_some() || radius > far {
                return best;
            }
            radius *= 2.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_is_what_a_look_at_all_points_finds() {
        let points: Vec<Point> = (0..200)
            .map(|i| Point::new((i * 37 % 101) as f64 * 0.3 - 7.0, (i * 53 % 89) as f64 * 0.2))
            .collect();
        let near = PointIndex::new(points.clone());
        for (x, y, radius) in [(0.0, 0.0, 3.0), (-7.0, 17.0, 5.5), (40.0, 3.0, 20.0), (-30.0, -30.0, 2.0)] {
            let at = Point::new(x, y);
            let all: Vec<usize> = (0..200).filter(|i| (points[*i] - at).norm() <= radius).collect();
            let found: Vec<usize> = near.within(at, radius).into_iter().map(|(i, _)| i).collect();
            assert_eq!(found, all, "{at} {radius}");
            let least = points.iter().map(|p| (p - at).norm()).fold(f64::INFINITY, f64::min);
            assert_eq!(near.nearest(at).expect("some point").1, least);
        }
        assert!(PointIndex::new(Vec::new()).nearest(Point::origin()).is_none());
    }

    #[test]
    fn a_building_tells_which_nodes_are_near() {
        let w = crate::warehouse::lab();
        let near = |radius: f64| -> Vec<String> {
            w.nodes_within(Point::new(3.0, 0.0), radius)
                .into_iter()
                .map(|n| w.nodes[n].name.clone())
                .collect()
        };
        assert_eq!(
            (near(0.1), near(1.0)),
            (vec!["R103".to_string()], ["R104", "R103", "R30", "R17", "P"].map(String::from).to_vec())
        );
    }
}

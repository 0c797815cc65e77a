//! Whether a worker keeps to the assigned path.
//!
//! Main types: [`Follower`] (progress along one path), [`Conduct`]. The allowed area of an edge is an ellipse with the
//! edge's ends as foci and a major axis of their distance plus `2r` (Petković 2021, section 4.3.1); its half-width is
//! capped, since `√(r·L + r²)` grows with the length of an edge, and widened by the accuracy of the pose. Being early
//! or late is no deviation. Refuses: to say where the worker goes instead.

use giveway_floor::geometry::{Point, Segment};

/// Radius around a node within which it counts as reached, and half the excess of the major axis over the edge, metres.
pub const NODE_M: f64 = 0.25;
/// Half-width of a one-metre edge's ellipse, metres; longer edges are allowed no more.
const HALF_WIDTH_M: f64 = 0.56;
/// Number of control cycles outside before a worker deviates.
const CYCLES: u32 = 4;
/// Number of edges ahead that may be entered directly: people cut corners.
const AHEAD: usize = 3;

/// A worker's conduct with respect to the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conduct {
    /// Within the allowed area.
    OnPath,
    /// Outside the allowed area, but not yet long enough to deviate.
    Outside,
    /// Outside the allowed area for long enough to deviate.
    Deviating,
    /// At the end of the path.
    Arrived,
}

/// Progress along one path.
#[derive(Clone, Debug, PartialEq)]
pub struct Follower {
    path: Vec<Point>,
    /// Index of the node reached last.
    current: usize,
    outside: u32,
}

impl Follower {
    /// A follower at the start of a path.
    ///
    /// # Panics
    /// If the path has no point.
    pub fn new(path: Vec<Point>) -> Follower {
        assert!(!path.is_empty(), "a path leads somewhere");
        Follower { path, current: 0, outside: 0 }
    }

    /// The whole path.
    pub fn path(&self) -> &[Point] {
        &self.path
    }

    /// The path that is still ahead, without the node reached last.
    pub fn ahead(&self) -> &[Point] {
        &self.path[(self.current + 1).min(self.path.len())..]
    }

    /// The next node.
    pub fn next(&self) -> Option<Point> {
        self.ahead().first().copied()
    }

    /// The end of the path.
    pub fn goal(&self) -> Point {
        *self.path.last().expect("a path leads somewhere")
    }

    /// How many nodes of the path were reached.
    pub fn progress(&self) -> usize {
        self.current
    }

    /// Checks the worker's position, once per control cycle. `sigma_m` is one standard deviation of it.
    pub fn observe(&mut self, at: Point, sigma_m: f64) -> Conduct {
        let r = NODE_M.hypot(2.0 * sigma_m);
        let last = self.path.len() - 1;
        while self.current < last && (at - self.path[self.current + 1]).norm() < r {
            self.current += 1;
            self.outside = 0;
        }
        if self.current == last {
            let left = (at - self.goal()).norm() > 2.0 * r;
            return self.debounce(!left, Conduct::Arrived, sigma_m);
        }
        let edges = self.current..last.min(self.current + AHEAD);
        match edges.clone().find(|&i| is_allowed(self.edge(i), at, r, sigma_m)) {
            Some(i) => {
                self.current = i;
                self.debounce(true, Conduct::OnPath, sigma_m)
            }
            None => self.debounce(false, Conduct::OnPath, sigma_m),
        }
    }

    fn debounce(&mut self, inside: bool, conduct: Conduct, sigma_m: f64) -> Conduct {
        if inside {
            self.outside = 0;
            return conduct;
        }
        self.outside += 1;
        // A source less exact than a headset must stray for longer before it counts.
        let patience = CYCLES + (20.0 * (sigma_m - 0.05).max(0.0)) as u32;
        if self.outside >= patience { Conduct::Deviating } else { Conduct::Outside }
    }

    fn edge(&self, i: usize) -> Segment {
        Segment { a: self.path[i], b: self.path[i + 1] }
    }
}

fn is_allowed(edge: Segment, at: Point, r: f64, sigma_m: f64) -> bool {
    let sum = (at - edge.a).norm() + (at - edge.b).norm();
    let along = edge.b - edge.a;
    let length = edge.length().max(1e-9);
    let across = (along.x * (at.y - edge.a.y) - along.y * (at.x - edge.a.x)).abs() / length;
    sum <= edge.length() + 2.0 * r && across <= HALF_WIDTH_M.hypot(2.0 * sigma_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(points: &[(f64, f64)]) -> Follower {
        Follower::new(points.iter().map(|(x, y)| Point::new(*x, *y)).collect())
    }

    fn straight() -> Follower {
        path(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0)])
    }

    #[test]
    fn swaying_by_a_few_centimetres_is_no_deviation() {
        let mut f = straight();
        for i in 0..=160 {
            let x = i as f64 * 0.025;
            let sway = 0.05 * (x * 5.0).sin();
            let conduct = f.observe(Point::new(x, sway), 0.02);
            assert!(matches!(conduct, Conduct::OnPath | Conduct::Arrived), "{x}: {conduct:?}");
        }
        assert_eq!(f.observe(Point::new(4.0, 0.0), 0.02), Conduct::Arrived);
    }

    #[test]
    fn three_cycles_outside_are_none_and_the_fourth_is_one() {
        let mut f = straight();
        f.observe(Point::new(1.0, 0.0), 0.02);
        let outside = Point::new(1.5, 1.2);
        let seen: Vec<Conduct> = (0..4).map(|_| f.observe(outside, 0.02)).collect();
        assert_eq!(seen[..3], [Conduct::Outside; 3]);
        assert_eq!(seen[3], Conduct::Deviating);
    }

    #[test]
    fn coming_back_in_time_starts_the_count_anew() {
        let mut f = straight();
        for i in 0..40 {
            let y = if i % 4 == 3 { 0.0 } else { 1.2 };
            assert_ne!(f.observe(Point::new(0.5, y), 0.02), Conduct::Deviating);
        }
    }

    #[test]
    fn a_corner_may_be_cut() {
        let mut f = path(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 2.0)]);
        for (x, y) in [(0.9, 0.0), (1.4, 0.2), (1.6, 0.4), (1.8, 0.8), (2.0, 1.4)] {
            assert_eq!(f.observe(Point::new(x, y), 0.02), Conduct::OnPath, "{x} {y}");
        }
        assert_eq!(f.progress(), 3);
    }

    #[test]
    fn a_long_edge_allows_no_more_than_a_short_one() {
        let mut f = path(&[(0.0, 0.0), (10.0, 0.0)]);
        let conduct: Vec<_> = (0..4).map(|_| f.observe(Point::new(5.0, 0.8), 0.0)).collect();
        assert_eq!(conduct.last(), Some(&Conduct::Deviating));
    }

    #[test]
    fn a_worse_source_strays_farther_and_longer() {
        let mut f = straight();
        for _ in 0..6 {
            assert_ne!(f.observe(Point::new(1.5, 0.9), 0.25), Conduct::Deviating);
        }
    }
}

//! Paths between standing robots: searched cell by cell, since the middle lines of the floor lead into the robots.
//!
//! Middle lines are right for a free floor. Past a robot that stands half across one, a person walks along its side.
//! Main type: [`WaysBetween`]. Refuses: to look farther than a few metres: from there on middle lines serve.

use super::Walkways;
use crate::geometry::Point;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Steps from a cell to its neighbours: columns, rows, tenths of a cell.
const STEPS: [(i64, i64, u32); 8] =
    [(1, 0, 10), (-1, 0, 10), (0, 1, 10), (0, -1, 10), (1, 1, 14), (1, -1, 14), (-1, 1, 14), (-1, -1, 14)];

/// Floor that is not free for walking: a square with sides along the map's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// Centre of the square.
    pub at: Point,
    /// Half a side, metres.
    pub half_m: f64,
}

/// The shortest paths from one place to everything near it.
#[derive(Debug)]
pub struct WaysBetween<'a> {
    walkways: &'a Walkways,
    squares: Vec<Square>,
    from: Point,
    /// Number of cells along a side of the window; the paths begin in its middle.
    side: i64,
    /// Length of the path to each cell, tenths of a cell, and the cell before it.
    reached: Vec<(u32, u32)>,
}

impl Square {
    /// Depth of a point inside the square, metres; negative outside.
    pub fn depth_m(&self, p: Point) -> f64 {
        self.half_m - (p.x - self.at.x).abs().max((p.y - self.at.y).abs())
    }
}

impl Walkways {
    /// The shortest paths from a place to everything within a window of `reach_m` (metres) on each side, around
    /// squares. From inside a square, where a measurement may put a person, paths lead straight out of it. O(cells log
    /// cells) of the window, times the squares.
    pub fn ways_between(&self, from: Point, squares: Vec<Square>, reach_m: f64) -> WaysBetween<'_> {
        let cells = (reach_m / self.cell_m()).ceil() as i64;
        let side = 2 * cells + 1;
        let reached = vec![(u32::MAX, u32::MAX); (side * side) as usize];
        let mut ways = WaysBetween { walkways: self, squares, from, side, reached };
        ways.search();
        ways
    }
}

impl WaysBetween<'_> {
    fn search(&mut self) {
        let start = (self.side / 2) * self.side + self.side / 2;
        self.reached[start as usize] = (0, u32::MAX);
        let mut queue = BinaryHeap::from([Reverse((0u32, start))]);
        while let Some(Reverse((length, cell))) = queue.pop() {
            if length > self.reached[cell as usize].0 {
                continue;
            }
            let here = self.middle(cell);
            for (dx, dy, step) in STEPS {
                let (x, y) = (cell % self.side + dx, cell / self.side + dy);
                if x < 0 || y < 0 || x >= self.side || y >= self.side {
                    continue;
                }
                let (next, there) = (y * self.side + x, length + step);
                if there < self.reached[next as usize].0 && self.is_step(here, self.middle(next)) {
                    self.reached[next as usize] = (there, cell as u32);
                    queue.push(Reverse((there, next)));
                }
            }
        }
    }

    /// The middle of a cell of the window.
    fn middle(&self, cell: i64) -> Point {
        let half = self.side / 2;
        let (x, y) = ((cell % self.side - half) as f64, (cell / self.side - half) as f64);
        Point::new(self.from.x + x * self.walkways.cell_m(), self.from.y + y * self.walkways.cell_m())
    }

    /// The cell of the window that contains a point.
    fn cell(&self, p: Point) -> Option<usize> {
        let at = |v: f64| (v / self.walkways.cell_m()).round() as i64 + self.side / 2;
        let (x, y) = (at(p.x - self.from.x), at(p.y - self.from.y));
        let within = x >= 0 && y >= 0 && x < self.side && y < self.side;
        within.then(|| (y * self.side + x) as usize)
    }

    /// Whether a person can walk from one point to another close by: onto free floor, and within a square only
    /// outwards.
    fn is_step(&self, here: Point, there: Point) -> bool {
        let leaves = |s: &Square| s.depth_m(there) <= 0.0 || s.depth_m(there) < s.depth_m(here);
        self.walkways.is_free(there) && self.squares.iter().all(leaves)
    }

    fn sees(&self, a: Point, b: Point) -> bool {
        let steps = ((b - a).norm() / (self.walkways.cell_m() * 0.5)).ceil().max(1.0) as usize;
        let along = |k: usize| a + (b - a) * (k as f64 / steps as f64);
        (1..=steps).all(|k| self.is_step(along(k - 1), along(k)))
    }

    /// Whether a point is clear of all squares.
    pub fn is_clear(&self, p: Point) -> bool {
        self.squares.iter().all(|s| s.depth_m(p) <= 0.0)
    }

    /// Length of the path to a place, metres; nothing if there is none within the window.
    pub fn length_m(&self, to: Point) -> Option<f64> {
        let (length, _) = self.reached[self.cell(to)?];
        (length != u32::MAX).then(|| f64::from(length) * 0.1 * self.walkways.cell_m())
    }

    /// The path to a place, including its ends, with as few corners as it needs.
    pub fn way_to(&self, to: Point) -> Option<Vec<Point>> {
        self.length_m(to)?;
        let back = std::iter::successors(self.cell(to), |cell| {
            let (_, before) = self.reached[*cell];
            (before != u32::MAX).then_some(before as usize)
        });
        let mut all: Vec<Point> = back.map(|cell| self.middle(cell as i64)).collect();
        all.reverse();
        all.push(to);
        let mut way = vec![self.from];
        let mut i = 0;
        while i + 1 < all.len() {
            let far = (i + 2..all.len()).rev().find(|k| self.sees(all[i], all[*k]));
            i = far.unwrap_or(i + 1);
            way.push(all[i]);
        }
        Some(way)
    }
}

//! The floor on which people walk, as a raster with the clearance of every cell.
//!
//! Main type: [`Raster`]. Refuses: holes that lifted racks leave; the places of racks are never floor.

use crate::geometry::{Point, inside};
use crate::warehouse::{NodeKind, Warehouse};

/// Side of a cell unless the building is too large for it, metres.
const CELL_M: f64 = 0.1;
/// Largest number of cells; larger buildings get larger cells.
const CELLS_MAX: f64 = 8e6;
/// Half width of a person, metres: slits between racks too narrow for it are not floor.
const HALF_WIDTH_M: f64 = 0.2;
/// The sampled points of a cell, as parts of its side from its middle. A border through the middle of a cell thus takes
/// the cell away, whichever side the floor is on: aisles stay symmetric.
const SAMPLES: [(f64, f64); 4] = [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)];

/// The raster. Cells are numbered row by row from the south; the outermost ones are never free.
#[derive(Clone, Debug)]
pub(super) struct Raster {
    /// Side of a cell, metres.
    pub cell_m: f64,
    /// Middle of the first cell.
    pub low: Point,
    pub columns: usize,
    pub rows: usize,
    /// Squared distance to the nearest cell that is not free, in cells; 0 for cells that are not free.
    pub clear2: Vec<u32>,
}

impl Raster {
    /// The free floor of a building.
    pub fn of(w: &Warehouse) -> Raster {
        let (low, high) = w.bounds();
        let size = high - low;
        let fine = size.x.max(1.0) * size.y.max(1.0) / (CELL_M * CELL_M);
        let cell_m = CELL_M * (fine / CELLS_MAX).sqrt().ceil().max(1.0);
        // Middles are multiples of the cell, as nodes and borders mostly are. The margin holds half a footprint.
        let margin = (w.footprint_m / cell_m).ceil() + 2.0;
        let first = |v: f64| ((v / cell_m).floor() - margin) * cell_m;
        let count = |from: f64, to: f64| ((to - from) / cell_m).ceil() as usize + margin as usize + 1;
        let low = Point::new(first(low.x), first(low.y));
        let (columns, rows) = (count(low.x, high.x), count(low.y, high.y));
        let mut floor = Raster { cell_m, low, columns, rows, clear2: Vec::new() };
        let free = floor.free(w);
        floor.clear2 = distances2(columns, rows, |i| !free[i]);
        floor.close_slits();
        floor
    }

    /// Which cells are inside the outlines and outside of obstacles and places of racks.
    fn free(&self, w: &Warehouse) -> Vec<bool> {
        let (mut walkable, mut taken) = (self.blank(), self.blank());
        if w.walkable.is_empty() {
            self.paint(&mut walkable, &around_aisles(w));
        }
        w.walkable.iter().for_each(|outline| self.paint(&mut walkable, outline));
        w.obstacles.iter().for_each(|outline| self.paint(&mut taken, outline));
        for n in w.nodes_where(|k| k == NodeKind::Storage) {
            let at = w.nodes[n].at;
            self.paint(&mut taken, &rectangle(at, at, w.footprint_m / 2.0));
        }
        let inner = |i: usize| {
            let (x, y) = (i % self.columns, i / self.columns);
            x > 0 && y > 0 && x + 1 < self.columns && y + 1 < self.rows
        };
        (0..walkable.len()).map(|i| inner(i) && walkable[i] & !taken[i] == 0b1111).collect()
    }

    fn blank(&self) -> Vec<u8> {
        vec![0; self.columns * self.rows]
    }

    /// Marks which samples of each cell are inside the outline.
    fn paint(&self, samples: &mut [u8], outline: &[Point]) {
        let Some(&first) = outline.first() else { return };
        let (low, high) = outline.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
        let span = |from: f64, to: f64, count: usize| {
            let at = |v: f64| (v / self.cell_m).clamp(0.0, count as f64) as usize;
            at(from - self.cell_m)..(at(to + self.cell_m) + 1).min(count)
        };
        for y in span(low.y - self.low.y, high.y - self.low.y, self.rows) {
            for x in span(low.x - self.low.x, high.x - self.low.x, self.columns) {
                let i = y * self.columns + x;
                let middle = self.middle(i);
                for (bit, (dx, dy)) in SAMPLES.into_iter().enumerate() {
                    let p = Point::new(middle.x + dx * self.cell_m, middle.y + dy * self.cell_m);
                    samples[i] |= u8::from(inside(outline, p)) << bit;
                }
            }
        }
    }

    /// Removes floor that is too narrow for a person: cells beyond the reach of a disc that fits.
    fn close_slits(&mut self) {
        let half = ((HALF_WIDTH_M / self.cell_m) as u32).pow(2);
        let reach = distances2(self.columns, self.rows, |i| self.clear2[i] >= half.max(1));
        let keep = |i: usize| self.clear2[i] > 0 && reach[i] < half.max(1);
        self.clear2 = distances2(self.columns, self.rows, |i| !keep(i));
    }

    /// The cell at a point; nothing beyond the raster.
    pub fn cell(&self, p: Point) -> Option<usize> {
        let at = |v: f64, low: f64| (v - low) / self.cell_m + 0.5;
        let (x, y) = (at(p.x, self.low.x), at(p.y, self.low.y));
        let within = x >= 0.0 && y >= 0.0 && x < self.columns as f64 && y < self.rows as f64;
        within.then(|| y as usize * self.columns + x as usize)
    }

    /// The middle of a cell.
    pub fn middle(&self, i: usize) -> Point {
        let (x, y) = (i % self.columns, i / self.columns);
        Point::new(self.low.x + x as f64 * self.cell_m, self.low.y + y as f64 * self.cell_m)
    }

    /// Whether the point is on free floor.
    pub fn is_free(&self, p: Point) -> bool {
        self.cell(p).is_some_and(|i| self.clear2[i] > 0)
    }

    /// Distance from a cell to the nearest one that is not free, metres.
    pub fn clearance_m(&self, i: usize) -> f64 {
        f64::from(self.clear2[i]).sqrt() * self.cell_m
    }

    /// Whether the straight line between two points is free, sampled every half cell, ends included.
    pub fn sees(&self, a: Point, b: Point) -> bool {
        // The same samples from either end.
        let (a, b) = if (a.x, a.y) <= (b.x, b.y) { (a, b) } else { (b, a) };
        let steps = ((b - a).norm() / (self.cell_m * 0.5)).ceil().max(1.0) as usize;
        (0..=steps).all(|k| self.is_free(a + (b - a) * (k as f64 / steps as f64)))
    }

    /// The middle of the free cell nearest to a point, no farther than `reach` (metres); the point itself if it is
    /// free.
    pub fn nearest_free(&self, p: Point, reach: f64) -> Option<Point> {
        if self.is_free(p) {
            return Some(p);
        }
        let span = |v: f64, low: f64, count: usize| {
            let at = |v: f64| ((v - low) / self.cell_m + 0.5).clamp(0.0, count as f64) as usize;
            at(v - reach)..(at(v + reach) + 1).min(count)
        };
        let rows = span(p.y, self.low.y, self.rows);
        let cells = rows.flat_map(|y| span(p.x, self.low.x, self.columns).map(move |x| y * self.columns + x));
        let free = cells.filter(|i| self.clear2[*i] > 0).map(|i| self.middle(i));
        let near = free.map(|m| ((m - p).norm(), m)).filter(|(d, _)| *d <= reach);
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, m)| m)
    }
}

/// The rectangle around the aisles, for a map without outlines of its floor.
fn around_aisles(w: &Warehouse) -> Vec<Point> {
    let aisles = w.nodes_where(|k| matches!(k, NodeKind::Aisle | NodeKind::Exit));
    let points = aisles.into_iter().map(|n| w.nodes[n].at);
    let box_of = points.map(|p| (p, p)).reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)));
    box_of.map(|(low, high)| rectangle(low, high, w.footprint_m / 2.0)).unwrap_or_default()
}

fn rectangle(low: Point, high: Point, wider: f64) -> Vec<Point> {
    let (left, below, right, above) = (low.x - wider, low.y - wider, high.x + wider, high.y + wider);
    vec![Point::new(left, below), Point::new(right, below), Point::new(right, above), Point::new(left, above)]
}

/// Squared distance of every cell to the nearest one in the set, in cells, exact (Felzenszwalb and
/// Huttenlocher 2012: columns first, then the lower envelope of parabolas along each row).
fn distances2(columns: usize, rows: usize, set: impl Fn(usize) -> bool) -> Vec<u32> {
    const FAR: u32 = 1 << 14;
    let mut down = vec![FAR; columns * rows];
    for x in 0..columns {
        let mut since = FAR;
        let mut visit = |y: usize, down: &mut Vec<u32>| {
            let i = y * columns + x;
            since = if set(i) { 0 } else { (since + 1).min(FAR) };
            down[i] = down[i].min(since);
        };
        (0..rows).for_each(|y| visit(y, &mut down));
        (0..rows).rev().for_each(|y| visit(y, &mut down));
    }
    let mut out = vec![0; columns * rows];
    let (mut at, mut from) = (vec![0_usize; columns], vec![0_f64; columns + 1]);
    for y in 0..rows {
        let height = |x: usize| f64::from(down[y * columns + x]).powi(2);
        let mut k = 0;
        (at[0], from[0], from[1]) = (0, f64::NEG_INFINITY, f64::INFINITY);
        for x in 1..columns {
            let meet = |v: usize| {
                let (x, v2) = (x as f64, v as f64);
                (height(x as usize) + x * x - height(v) - v2 * v2) / (2.0 * (x - v2))
            };
            let mut s = meet(at[k]);
            while s <= from[k] {
                k -= 1;
                s = meet(at[k]);
            }
            k += 1;
            (at[k], from[k], from[k + 1]) = (x, s, f64::INFINITY);
        }
        k = 0;
        for x in 0..columns {
            while from[k + 1] < x as f64 {
                k += 1;
            }
            let d = height(at[k]) + (x as f64 - at[k] as f64).powi(2);
            out[y * columns + x] = d as u32;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_that_a_look_at_all_cells_finds() {
        let (columns, rows) = (23, 17);
        let set = |i: usize| (i * 7919).is_multiple_of(41);
        let found = distances2(columns, rows, set);
        for (i, d) in found.iter().enumerate() {
            let far = |j: usize| {
                let (dx, dy) = ((i % columns).abs_diff(j % columns), (i / columns).abs_diff(j / columns));
                (dx * dx + dy * dy) as u32
            };
            let least = (0..columns * rows).filter(|j| set(*j)).map(far).min();
            assert_eq!(Some(*d), least, "cell {i}");
        }
    }
}

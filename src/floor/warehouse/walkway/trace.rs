//! From middle lines of cells to nodes and straight edges.
//!
//! Main function: [`graph`]. Refuses: edges longer than the pitch, and to move a line by more than a cell.

use super::floor::Raster;
use super::thin::around;
use super::{PITCH_M, WalkEdge, WalkNode};
use crate::geometry::{Point, Segment};
use crate::id::{IdVec, WalkEdgeId, WalkNodeId};
use std::collections::{BTreeMap, BTreeSet};

/// Distance within which crossings count as one, metres.
const SAME_CROSSING_M: f64 = 0.35;
/// A middle line as cells, including both ends.
type CellLines = Vec<usize>;

/// The graph of a skeleton; cells in `keep` become nodes.
pub(super) fn graph(
    floor: &Raster,
    skeleton: &[bool],
    keep: &BTreeSet<usize>,
) -> (IdVec<WalkNodeId, WalkNode>, IdVec<WalkEdgeId, WalkEdge>) {
    let chains = chains(floor, skeleton, keep);
    let heads = crossings(floor, &chains, keep);
    let mut out = MiddleGraph { floor, nodes: IdVec::new(), edges: IdVec::new(), known: BTreeMap::new() };
    for i in (0..skeleton.len()).filter(|i| skeleton[*i]) {
        if neighbours(floor, skeleton, i).is_empty() {
            out.node(i);
        }
    }
    for mut chain in chains {
        let (first, last) = (heads[&chain[0]], heads[&chain[chain.len() - 1]]);
        if first == last && length(floor, &chain) < 2.0 * SAME_CROSSING_M {
            continue;
        }
        let end = chain.len() - 1;
        (chain[0], chain[end]) = (first, last);
        out.chain(&chain);
    }
    (out.nodes, out.edges)
}

/// Neighbours along the line; a diagonal one only if no cell between leads there too.
fn neighbours(floor: &Raster, skeleton: &[bool], i: usize) -> Vec<usize> {
    let ring = around(floor.columns, i);
    let is_next = |k: usize| {
        skeleton[ring[k]] && (k.is_multiple_of(2) || !(skeleton[ring[k - 1]] || skeleton[ring[(k + 1) % 8]]))
    };
    (0..8).filter(|k| is_next(*k)).map(|k| ring[k]).collect()
}

/// The lines between crossings, ends and kept cells, each once, in the order of its first cell.
fn chains(floor: &Raster, skeleton: &[bool], keep: &BTreeSet<usize>) -> Vec<CellLines> {
    let lines: BTreeMap<usize, Vec<usize>> =
        (0..skeleton.len()).filter(|i| skeleton[*i]).map(|i| (i, neighbours(floor, skeleton, i))).collect();
    let mut ends: BTreeSet<usize> =
        lines.iter().filter(|(i, next)| next.len() != 2 || keep.contains(i)).map(|(i, _)| *i).collect();
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    let from_all = |ends: &BTreeSet<usize>, starts: &[usize], seen: &mut BTreeSet<usize>| {
        let mut found = Vec::new();
        for &start in starts {
            for &step in &lines[&start] {
                let chain = follow(&lines, ends, start, step);
                seen.extend(&chain);
                let (last, before) = (chain[chain.len() - 1], chain[chain.len() - 2]);
                if (start, step) <= (last, before) {
                    found.push(chain);
                }
            }
        }
        found
    };
    let starts: Vec<usize> = ends.iter().copied().collect();
    found.extend(from_all(&ends, &starts, &mut seen));
    // Rings without any crossing.
    for &i in lines.keys().filter(|i| lines[*i].len() == 2) {
        if !seen.contains(&i) {
            ends.insert(i);
            found.extend(from_all(&ends, &[i], &mut seen));
        }
    }
    found
}

fn follow(
    lines: &BTreeMap<usize, Vec<usize>>,
    ends: &BTreeSet<usize>,
    start: usize,
    step: usize,
) -> CellLines {
    let mut chain = vec![start, step];
    while !ends.contains(&chain[chain.len() - 1]) {
        let (before, here) = (chain[chain.len() - 2], chain[chain.len() - 1]);
        let next = lines[&here].iter().copied().find(|n| *n != before);
        chain.push(next.expect("a cell that is no end has two neighbours"));
    }
    chain
}

fn length(floor: &Raster, chain: &[usize]) -> f64 {
    chain.windows(2).map(|pair| (floor.middle(pair[1]) - floor.middle(pair[0])).norm()).sum()
}

/// For each end of a chain the cell that represents it: crossings close together are one, at the kept cell or else
/// where there is most room.
fn crossings(floor: &Raster, chains: &[CellLines], keep: &BTreeSet<usize>) -> BTreeMap<usize, usize> {
    let mut head: BTreeMap<usize, usize> =
        chains.iter().flat_map(|c| [c[0], c[c.len() - 1]]).map(|end| (end, end)).collect();
    let find = |head: &BTreeMap<usize, usize>, mut i: usize| {
        while head[&i] != i {
            i = head[&i];
        }
        i
    };
    for chain in chains.iter().filter(|c| length(floor, c) < SAME_CROSSING_M) {
        let (a, b) = (find(&head, chain[0]), find(&head, chain[chain.len() - 1]));
        let rank = |i: usize| (keep.contains(&i), floor.clear2[i], std::cmp::Reverse(i));
        let (winner, loser) = if rank(a) >= rank(b) { (a, b) } else { (b, a) };
        head.insert(loser, winner);
    }
    head.keys().map(|&end| (end, find(&head, end))).collect()
}

struct MiddleGraph<'a> {
    floor: &'a Raster,
    nodes: IdVec<WalkNodeId, WalkNode>,
    edges: IdVec<WalkEdgeId, WalkEdge>,
    /// Nodes by their cell, where chains end.
    known: BTreeMap<usize, WalkNodeId>,
}

impl MiddleGraph<'_> {
    fn node(&mut self, cell: usize) -> WalkNodeId {
        if let Some(&known) = self.known.get(&cell) {
            return known;
        }
        let id = self.push(self.floor.middle(cell));
        self.known.insert(cell, id);
        id
    }

    fn push(&mut self, at: Point) -> WalkNodeId {
        let clearance_m = self.floor.cell(at).map_or(0.0, |i| self.floor.clearance_m(i));
        self.nodes.push(WalkNode { at, clearance_m })
    }

    /// A chain as straight edges between nodes at its corners, none longer than the pitch.
    fn chain(&mut self, cells: &[usize]) {
        let points: Vec<Point> = cells.iter().map(|i| self.floor.middle(*i)).collect();
        let mut corners = vec![0];
        straighten(&points, 0, points.len() - 1, self.floor.cell_m * 0.55, &mut corners);
        let (mut from, end) = (self.node(cells[0]), self.node(cells[cells.len() - 1]));
        for pair in corners.windows(2) {
            let piece = Segment { a: points[pair[0]], b: points[pair[1]] };
            let parts = (piece.length() / PITCH_M - 1e-9).ceil().max(1.0) as usize;
            for k in 1..=parts {
                let is_end = pair[1] == points.len() - 1 && k == parts;
                let to = if is_end { end } else { self.push(piece.point(k as f64 / parts as f64)) };
                self.edge(from, to);
                from = to;
            }
        }
    }

    fn edge(&mut self, a: WalkNodeId, b: WalkNodeId) {
        let piece = Segment { a: self.nodes[a].at, b: self.nodes[b].at };
        let parts = (piece.length() / self.floor.cell_m).ceil().max(1.0) as usize;
        let along = (0..=parts).filter_map(|k| self.floor.cell(piece.point(k as f64 / parts as f64)));
        let clearance_m = along.map(|i| self.floor.clearance_m(i)).fold(f64::INFINITY, f64::min);
        self.edges.push(WalkEdge { a, b, length_m: piece.length(), clearance_m });
    }
}

/// Appends the corners after `from` up to `to`, such that all points are within `tolerance` of the straight segments
/// (Douglas and Peucker 1973).
fn straighten(points: &[Point], from: usize, to: usize, tolerance: f64, corners: &mut Vec<usize>) {
    let (a, b) = (points[from], points[to]);
    let away = |p: Point| {
        let d = b - a;
        let u = if d.norm() > 0.0 { ((p - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
        (p - (a + d * u)).norm()
    };
    let farthest = (from + 1..to).map(|i| (away(points[i]), i)).max_by(|x, y| x.0.total_cmp(&y.0));
    match farthest {
        Some((distance, i)) if distance > tolerance => {
            straighten(points, from, i, tolerance, corners);
            straighten(points, i, to, tolerance, corners);
        }
        _ => corners.push(to),
    }
}

//! Where people walk: the free floor and its middle lines.
//!
//! The middle lines are the generalised Voronoi diagram of the free floor, made into a graph: crossings, corners and
//! points between, no farther apart than the robots' nodes usually are (Petković 2021, section 3.3, uses such a diagram
//! of the floor plan; section 4.3.2 a network at the pitch of the road nodes). Main type: [`Walkways`], made once per
//! building; [`EdgeSet`] tells which edges are cut at present. Refuses: robots, goals, anything that moves, and holes
//! that lifted racks leave.

mod between;
mod floor;
mod path;
mod reach;
mod thin;
mod timed;
mod trace;

#[cfg(test)]
mod tests;

pub use between::{Square, WaysBetween};
pub use path::WalkPath;
pub use timed::{Occupied, TimedPath};

use super::near::PointIndex;
use super::{NodeKind, Warehouse};
use crate::geometry::{Point, Segment, runs_through};
use crate::id::{Dense, IdVec, NodeId, WalkEdgeId, WalkNodeId};
use floor::Raster;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Greatest length of an edge, metres.
pub(super) const PITCH_M: f64 = 1.0;
/// Distance between places where people can stand, and their least distance from obstacles, metres.
const STANDING_PITCH_M: f64 = 0.5;
const STANDING_CLEARANCE_M: f64 = 0.3;
/// A straight path that comes this near to the middle of a cut edge, and goes on, is cut too, metres.
const CUT_REACH_M: f64 = 0.5;
/// A vehicle that does not fit where a person would stand serves a place from this far away at most, metres.
const SERVES_M: f64 = 4.0;
/// A person whose pose is this far off the floor at most is taken to be on the nearest free cell, metres.
const OFF_FLOOR_M: f64 = 1.0;

/// A point on a middle line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkNode {
    /// Position, metres.
    pub at: Point,
    /// Distance to the nearest obstacle, metres.
    pub clearance_m: f64,
}

/// A straight segment of a middle line, walked either way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkEdge {
    /// One end.
    pub a: WalkNodeId,
    /// The other end.
    pub b: WalkNodeId,
    /// Length, metres.
    pub length_m: f64,
    /// Least distance to obstacles, metres.
    pub clearance_m: f64,
}

impl WalkEdge {
    /// The end that is not `n`.
    pub fn beyond(&self, n: WalkNodeId) -> WalkNodeId {
        if n == self.a { self.b } else { self.a }
    }
}

/// The free floor of a building and its middle lines.
#[derive(Clone, Debug)]
pub struct Walkways {
    floor: Raster,
    nodes: IdVec<WalkNodeId, WalkNode>,
    edges: IdVec<WalkEdgeId, WalkEdge>,
    /// Where the links of each node begin in `links`, and the end of the last.
    start: Vec<u32>,
    links: Vec<(WalkEdgeId, WalkNodeId)>,
    near_nodes: PointIndex,
    near_edges: PointIndex,
}

impl Walkways {
    /// The walkways of a building: inside its outlines, outside of its obstacles and of all places of racks.
    /// Where the map has no outlines, the rectangle around its aisles takes their place.
    pub fn of(w: &Warehouse) -> Walkways {
        let floor = Raster::of(w);
        let keep: BTreeSet<usize> = places(w).into_iter().filter_map(|p| floor.cell(p)).collect();
        let skeleton = thin::skeleton(&floor, &keep);
        let (nodes, edges) = trace::graph(&floor, &skeleton, &keep);
        Walkways::new(floor, nodes, edges)
    }

    fn new(
        floor: Raster,
        nodes: IdVec<WalkNodeId, WalkNode>,
        edges: IdVec<WalkEdgeId, WalkEdge>,
    ) -> Walkways {
        let mut links: Vec<(WalkNodeId, WalkEdgeId, WalkNodeId)> =
            edges.pairs().flat_map(|(e, edge)| [(edge.a, e, edge.b), (edge.b, e, edge.a)]).collect();
        links.sort_unstable();
        let mut start = vec![0; nodes.len() + 1];
        links.iter().for_each(|(from, ..)| start[from.ix() + 1] += 1);
        for n in 0..nodes.len() {
            start[n + 1] += start[n];
        }
        let near_nodes = PointIndex::new(nodes.iter().map(|n| n.at).collect());
        let middle = |e: &WalkEdge| nalgebra::center(&nodes[e.a].at, &nodes[e.b].at);
        let near_edges = PointIndex::new(edges.iter().map(middle).collect());
        let links = links.into_iter().map(|(_, e, to)| (e, to)).collect();
        Walkways { floor, nodes, edges, start, links, near_nodes, near_edges }
    }

    /// All nodes.
    pub fn nodes(&self) -> &IdVec<WalkNodeId, WalkNode> {
        &self.nodes
    }

    /// All edges.
    pub fn edges(&self) -> &IdVec<WalkEdgeId, WalkEdge> {
        &self.edges
    }

    /// The edges at a node with the nodes at their other ends, in the order of the edges.
    pub fn links(&self, n: WalkNodeId) -> &[(WalkEdgeId, WalkNodeId)] {
        &self.links[self.start[n.ix()] as usize..self.start[n.ix() + 1] as usize]
    }

    /// The straight segment of an edge.
    pub fn segment(&self, e: WalkEdgeId) -> Segment {
        let edge = &self.edges[e];
        Segment { a: self.nodes[edge.a].at, b: self.nodes[edge.b].at }
    }

    /// An empty set of edges, of the right size.
    pub fn no_edges(&self) -> EdgeSet {
        EdgeSet { words: vec![0; self.edges.len().div_ceil(64)], areas: Vec::new(), clearance_m: 0.0 }
    }

    /// The edges that come nearer to obstacles than `clearance_m`, metres: a vehicle that needs that much to either
    /// side does not fit there. With these cut, straight paths keep that distance from obstacles, too.
    pub fn edges_narrower_than(&self, clearance_m: f64) -> EdgeSet {
        let mut cut = EdgeSet { clearance_m, ..self.no_edges() };
        // People need no room besides their own, and are asked for many times in a step.
        if clearance_m <= 0.0 {
            return cut;
        }
        for (e, _) in self.edges.pairs().filter(|(_, edge)| edge.clearance_m < clearance_m) {
            cut.insert(e);
        }
        cut
    }

    /// Where something that keeps `clearance_m` (metres) from obstacles can stand to serve a place: for a person, who
    /// needs none, the nearest point of the floor; else the nearest middle line in sight that is wide enough, no
    /// farther than a few metres away. Nothing if there is none.
    pub fn stand_near(&self, place: Point, clearance_m: f64) -> Option<Point> {
        let on_floor = self.on_floor(place)?;
        if self.clearance_m(on_floor) >= clearance_m {
            return Some(on_floor);
        }
        let wide = |e: &WalkEdgeId| self.edges[*e].clearance_m >= clearance_m;
        let mut near = self.near(on_floor, SERVES_M);
        near.retain(|(n, _)| self.links(*n).iter().any(|(e, _)| wide(e)));
        near.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(n, _)| self.nodes[n].at)
    }

    /// Side of a cell of the floor's raster, metres.
    pub fn cell_m(&self) -> f64 {
        self.floor.cell_m
    }

    /// Whether the point is on free floor.
    pub fn is_free(&self, p: Point) -> bool {
        self.floor.is_free(p)
    }

    /// Distance from a point to the nearest obstacle, metres; zero off the floor.
    pub fn clearance_m(&self, p: Point) -> f64 {
        self.floor.cell(p).map_or(0.0, |i| self.floor.clearance_m(i))
    }

    /// Whether the straight line between two points runs over free floor only.
    pub fn sees(&self, a: Point, b: Point) -> bool {
        self.floor.sees(a, b)
    }

    /// Whether a person can walk straight from `a` to `b`: over free floor, and past no cut edge.
    pub fn sees_past(&self, a: Point, b: Point, cut: &EdgeSet) -> bool {
        self.sees(a, b) && !self.leads_past(a, b, cut)
    }

    /// The point, or the nearest point on free floor if it is off the floor by less than a metre.
    pub fn on_floor(&self, p: Point) -> Option<Point> {
        self.floor.nearest_free(p, OFF_FLOOR_M)
    }

    /// Places where a person can stand no farther than `radius` (metres) from `p` as the crow flies, half a metre
    /// apart, the nearest first. Middle lines lead through the middle of the floor; these places are also at its edges.
    pub fn standing_places(&self, p: Point, radius: f64) -> Vec<Point> {
        let steps = (radius / STANDING_PITCH_M).floor() as i64;
        let along =
            move |origin: f64, i: i64| ((origin / STANDING_PITCH_M).round() + i as f64) * STANDING_PITCH_M;
        let column = |i: i64| (-steps..=steps).map(move |j| Point::new(along(p.x, i), along(p.y, j)));
        let all = (-steps..=steps).flat_map(column);
        let mut places: Vec<Point> = all
            .filter(|q| (q - p).norm() <= radius && self.clearance_m(*q) >= STANDING_CLEARANCE_M)
            .collect();
        places.sort_by(|a, b| (a - p).norm().total_cmp(&(b - p).norm()));
        places
    }

    /// The nodes in sight of `p` no farther than `radius` (metres), by id, with their distances in metres.
    pub fn near(&self, p: Point, radius: f64) -> Vec<(WalkNodeId, f64)> {
        let all = self.near_nodes.within(p, radius).into_iter();
        let all = all.map(|(i, distance)| (WalkNodeId::at(i), distance));
        all.filter(|(n, _)| self.sees(p, self.nodes[*n].at)).collect()
    }

    /// The nodes no farther than `radius` (metres) from `p`, in sight or not, by id.
    pub fn around(&self, p: Point, radius: f64) -> impl Iterator<Item = WalkNodeId> {
        self.near_nodes.within(p, radius).into_iter().map(|(i, _)| WalkNodeId::at(i))
    }

    /// The node nearest to `p` as the crow flies; nothing if the map has no walkways.
    pub fn nearest(&self, p: Point) -> Option<(WalkNodeId, f64)> {
        self.near_nodes.nearest(p).map(|(i, distance)| (WalkNodeId::at(i), distance))
    }

    /// The edges that come nearer to `p` than `radius` (metres), by id: the edges that a robot of that radius blocks.
    pub fn edges_within(&self, p: Point, radius: f64) -> Vec<WalkEdgeId> {
        let close = self.near_edges.within(p, radius + PITCH_M / 2.0).into_iter();
        let close = close.map(|(i, _)| WalkEdgeId::at(i));
        close.filter(|e| distance_to(p, self.segment(*e)).0 < radius).collect()
    }

    /// Cuts an area off: all edges that run into it, and all straight paths.
    pub fn cut_area(&self, cut: &mut EdgeSet, outline: &Arc<[Point]>) {
        for e in self.edges.ids().filter(|e| runs_through(outline, self.segment(*e))) {
            cut.insert(e);
        }
        cut.areas.push(outline.clone());
    }

    /// Whether the straight path from `a` to `b` runs into a cut area or between obstacles that are too near, or goes
    /// past a robot: it approaches the middle of a cut edge and leaves it behind. A path that ends before it, or starts
    /// there and leads away, does not.
    fn leads_past(&self, a: Point, b: Point, cut: &EdgeSet) -> bool {
        if cut.is_empty() {
            return false;
        }
        let way = Segment { a, b };
        if self.narrows(way, cut.clearance_m) {
            return true;
        }
        if cut.areas.iter().any(|outline| runs_through(outline, way)) {
            return true;
        }
        let reach = way.length() / 2.0 + CUT_REACH_M;
        self.near_edges.within(way.point(0.5), reach).into_iter().any(|(i, _)| {
            let e = WalkEdgeId::at(i);
            let (away, u) = distance_to(self.segment(e).point(0.5), way);
            cut.contains(e) && away < CUT_REACH_M && u > 0.0 && u < 1.0
        })
    }
}

impl Walkways {
    /// Whether a straight path comes nearer to obstacles than `clearance_m`, and nearer than where it begins: whatever
    /// stands in a narrow place may leave it.
    fn narrows(&self, way: Segment, clearance_m: f64) -> bool {
        if clearance_m <= 0.0 {
            return false;
        }
        let least_m = clearance_m.min(self.clearance_m(way.a));
        let steps = (way.length() / self.floor.cell_m).ceil().max(1.0) as u32;
        (0..=steps).any(|i| self.clearance_m(way.point(f64::from(i) / f64::from(steps))) < least_m)
    }
}

/// The places to which walkways lead even if these are dead ends: doors, stations, and ends of aisles.
fn places(w: &Warehouse) -> Vec<Point> {
    let is_aisle = |n: NodeId| matches!(w.kind(n), NodeKind::Aisle | NodeKind::Exit);
    let mut beside = vec![BTreeSet::new(); w.nodes.len()];
    for lane in w.lanes.iter().filter(|l| l.users.people && is_aisle(l.a) && is_aisle(l.b)) {
        beside[lane.a.ix()].insert(lane.b);
        beside[lane.b.ix()].insert(lane.a);
    }
    let kept = |n: &NodeId| match w.kind(*n) {
        NodeKind::Exit | NodeKind::Station(_) => true,
        NodeKind::Aisle => beside[n.ix()].len() == 1,
        _ => false,
    };
    w.nodes.ids().filter(kept).map(|n| w.nodes[n].at).collect()
}

/// The distance of a point from a straight segment, and where along the segment (0 to 1) it is nearest.
fn distance_to(p: Point, s: Segment) -> (f64, f64) {
    let d = s.b - s.a;
    let u = if d.norm_squared() > 0.0 { ((p - s.a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
    ((p - s.point(u)).norm(), u)
}

/// A set of edges, one bit each, areas that no straight path may run into, and how near to obstacles a straight path
/// may come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EdgeSet {
    words: Vec<u64>,
    areas: Vec<Arc<[Point]>>,
    /// Least distance of straight paths from obstacles, metres.
    clearance_m: f64,
}

impl EdgeSet {
    /// Adds an edge; gives whether it was not there before.
    pub fn insert(&mut self, e: WalkEdgeId) -> bool {
        let (word, bit) = (&mut self.words[e.ix() / 64], 1 << (e.ix() % 64));
        let new = *word & bit == 0;
        *word |= bit;
        new
    }

    /// Removes an edge; gives whether it was there.
    pub fn remove(&mut self, e: WalkEdgeId) -> bool {
        let (word, bit) = (&mut self.words[e.ix() / 64], 1 << (e.ix() % 64));
        let there = *word & bit != 0;
        *word &= !bit;
        there
    }

    /// Whether an edge is in the set.
    pub fn contains(&self, e: WalkEdgeId) -> bool {
        self.words[e.ix() / 64] >> (e.ix() % 64) & 1 == 1
    }

    /// Whether the set cuts nothing off.
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty() && self.clearance_m <= 0.0 && self.words.iter().all(|w| *w == 0)
    }

    /// All edges, in order.
    pub fn iter(&self) -> impl Iterator<Item = WalkEdgeId> {
        let bits = |w: u64| (0..64).filter(move |b| w >> b & 1 == 1);
        self.words
            .iter()
            .enumerate()
            .flat_map(move |(i, w)| bits(*w).map(move |b| WalkEdgeId::at(i * 64 + b)))
    }
}

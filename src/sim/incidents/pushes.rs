//! Where people push robots: onto a node nearby, or to a place between nodes that no robot is about to reach.
//!
//! Main type: [`PushSurroundings`]. Refuses: to put a robot in front of a driving one; people would see it coming, and
//! the fleet learns of the push only after a report and an order.

use crate::random::Stream;
use giveway_fleet::{OFF_ROUTE_M, RackAt};
use giveway_floor::geometry::{Point, Segment, Vector, axis_distance, axis_distance_to_segment};
use giveway_floor::id::{IdVec, NodeId, RackId};
use giveway_floor::route::Kinematics;
use giveway_floor::warehouse::Warehouse;

/// People push a robot at most this far, if there is a place, metres.
pub(crate) const NEARBY_M: f64 = 4.0;
/// A place between nodes is this much farther from each node than the distance that counts as being there, metres.
const BETWEEN_M: f64 = 0.05;
/// Largest distance of a pushed robot from its lane, metres: as far as robots on parallel lanes are apart. Within
/// [`OFF_ROUTE_M`] of its own lane a robot counts as on it, so farther out others would touch it.
const BESIDE_M: f64 = 0.1;
/// How many places are tried.
const TRIES: usize = 20;
/// A robot is pushed no nearer than this to a person, metres between centres.
const PERSON_M: f64 = 1.2;
/// Extra room around a robot, since robots that just touch are too near, metres.
const ROOM_M: f64 = 0.05;

/// The surroundings of a robot that is pushed.
pub(crate) struct PushSurroundings<'a> {
    pub warehouse: &'a Warehouse,
    pub racks: &'a IdVec<RackId, RackAt>,
    /// Positions and speeds of other robots.
    pub others: Vec<(Point, f64)>,
    /// Ways of robots that cannot be told to stop, with those on which an order that is under way may send them.
    pub headlong: Vec<Segment>,
    /// Where people are: a robot is never pushed onto a person.
    pub people: Vec<Point>,
    pub kinematics: Kinematics,
    /// How long another robot may drive on before it learns of a push, seconds.
    pub blind_s: f64,
}

impl PushSurroundings<'_> {
    /// A free place near `at`, with the node nearest to it; nothing if none was found.
    pub fn place_near(
        &self,
        (at, nearby_m): (Point, f64),
        loaded: bool,
        onto_node: bool,
        random: &mut Stream,
    ) -> Option<(Point, NodeId)> {
        let nodes = self.warehouse.nodes_within(at, nearby_m);
        if nodes.is_empty() {
            return None;
        }
        let mut tries = (0..TRIES).map(|_| {
            let node = nodes[random.below(nodes.len())];
            if onto_node { self.warehouse.nodes[node].at } else { self.beside(node, random) }
        });
        let there = tries.find(|p| self.is_free(*p, loaded) && (onto_node || self.is_between(*p)))?;
        let place = |n: NodeId| (self.warehouse.nodes[n].at - there).norm();
        let nearest = nodes.into_iter().min_by(|a, b| place(*a).total_cmp(&place(*b)))?;
        Some((there, nearest))
    }

    /// A place on or a little beside a lane that begins at a node.
    fn beside(&self, node: NodeId, random: &mut Stream) -> Point {
        let ways: Vec<NodeId> = self.warehouse.ways(node).map(|(_, w)| w.to).collect();
        let at = |n: NodeId| self.warehouse.nodes[n].at;
        if ways.is_empty() {
            return at(node);
        }
        let lane = Segment { a: at(node), b: at(ways[random.below(ways.len())]) };
        let along = lane.b - lane.a;
        let aside = Vector::new(-along.y, along.x) / along.norm().max(1e-9);
        lane.point(random.between(0.3, 0.7)) + aside * random.between(-BESIDE_M, BESIDE_M)
    }

    fn is_between(&self, p: Point) -> bool {
        self.warehouse.nodes_within(p, OFF_ROUTE_M + BETWEEN_M).is_empty()
    }

    /// Whether no robot can reach this place before it learns of the push, and a loaded robot meets no stored rack
    /// there.
    fn is_free(&self, p: Point, loaded: bool) -> bool {
        let side = self.warehouse.footprint_m;
        let of_robots =
            self.others.iter().all(|(at, speed)| axis_distance(p, *at) >= side + self.reach(*speed));
        let stored = |at: &RackAt| match at {
            RackAt::Stored(n) => axis_distance(p, self.warehouse.nodes[*n].at) < side,
            RackAt::On(_) => false,
        };
        let of_people = self.people.iter().all(|at| (p - at).norm() >= PERSON_M);
        let of_ways = self.headlong.iter().all(|way| axis_distance_to_segment(p, *way) >= side + ROOM_M);
        of_robots && of_ways && of_people && !(loaded && self.racks.iter().any(stored))
    }

    /// How far a robot may drive before it stands, metres: one that stands now accelerates and brakes for as long.
    fn reach(&self, speed_mps: f64) -> f64 {
        let (top, accel) = (self.kinematics.top_mps(false), self.kinematics.accel_mps2(true));
        let driving = top * self.blind_s + top * top / (2.0 * accel);
        let standing = top.min(self.kinematics.accel_mps2(false) * self.blind_s) * self.blind_s;
        ROOM_M + if speed_mps > 0.0 { driving } else { standing }
    }
}

//! The building: nodes, lanes, racks, stations, chargers, and which of them exclude each other.
//!
//! Main types: [`Warehouse`] (exists only validated), [`Node`], [`Arc`], [`Station`]; [`formats`] reads and writes maps
//! as text. Refuses: anything that moves or changes with time, and reading files itself.

mod bay;
mod body;
mod build;
pub mod cell;
mod check;
mod conflict;
mod corridor;
mod differences;
mod footprint;
pub mod formats;
mod generate;
mod near;
mod sketch;
mod summary;
mod svg;
pub mod walkway;

pub use body::{Body, MOST_BODIES};
pub use build::{Draft, DraftLane, DraftNode, DraftRack, DraftStation};
pub use cell::{ArmMount, Cell, Place, RackType, SlotName, SlotNameError, Tote};
pub use check::{
    Finding, Findings, Remark, Review, Severity, ShutIn, review, room_for, shut_in, shut_in_text,
};
pub use corridor::{CORRIDOR_MAX_M, Corridor};
pub use differences::{Difference, HowDifferent, differences};
pub use footprint::{Footprint, Hull};
pub use generate::{Blocks, docks, kiva, lab, mixed, stations, thesis, with_cells};
pub use sketch::sketch;
pub use summary::{MapSummary, summary};
pub use svg::{review_to_svg, to_svg};

use crate::geometry::Point;
use crate::id::{ArcId, BodyId, Dense, IdVec, LaneId, NodeId, RackId, RackTypeId, ResourceId, StationId};
use crate::time::Span;
use smallvec::SmallVec;

/// The purpose of a node. Only `Aisle` nodes carry through traffic of loaded robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NodeKind {
    /// Open floor to drive over.
    Aisle,
    /// A place for one rack. Unloaded robots may drive beneath; a loaded one only ends or starts here.
    Storage,
    /// The place of a robot while a person picks from its rack.
    Station(StationId),
    /// A waiting place before a station; entered only by robots bound for it.
    Queue(StationId),
    /// A charging place.
    Charger,
    /// A place to stay.
    Parking,
    /// A door for people; robots treat it as open floor.
    Exit,
}

impl NodeKind {
    /// Whether a robot may stay here for ever without being in another robot's way (DESIGN §5, invariant a).
    #[inline]
    pub fn is_lasting(self) -> bool {
        matches!(self, NodeKind::Storage | NodeKind::Charger | NodeKind::Parking)
    }

    /// The station, if only robots bound for one station may enter.
    #[inline]
    pub fn reserved_for(self) -> Option<StationId> {
        match self {
            NodeKind::Station(s) | NodeKind::Queue(s) => Some(s),
            _ => None,
        }
    }
}

/// A place where a robot can stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The map's own name for the node, unique.
    pub name: String,
    /// Position, metres.
    pub at: Point,
    /// Purpose of the node.
    pub kind: NodeKind,
}

/// Which robots may use a lane, and whether people may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Users {
    /// Robots that carry a rack.
    pub loaded: bool,
    /// Robots that carry nothing.
    pub unloaded: bool,
    /// People on foot.
    pub people: bool,
}

impl Users {
    /// All robots, and people.
    pub const ALL: Users = Users { loaded: true, unloaded: true, people: true };

    /// Only robots that carry nothing.
    pub const UNLOADED: Users = Users { loaded: false, unloaded: true, people: false };
    /// Robots with or without a rack, no people.
    pub const ROBOTS: Users = Users { loaded: true, unloaded: true, people: false };
    /// People only.
    pub const PEOPLE: Users = Users { loaded: false, unloaded: false, people: true };

    /// Whether a robot may use the lane, with or without a rack.
    #[inline]
    pub fn allows(self, loaded: bool) -> bool {
        if loaded { self.loaded } else { self.unloaded }
    }
}

/// A lane, in either direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    /// One end.
    pub a: NodeId,
    /// The other end.
    pub b: NodeId,
    /// Whether the lane may also be driven from `b` to `a`.
    pub both: bool,
    /// Length, metres.
    pub length_m: f64,
    /// Speed limit of the lane, metres per second.
    pub speed_limit_mps: Option<f64>,
    /// Which robots may use the lane, and whether people may.
    pub users: Users,
    /// The kinds of robots that may use the lane; nothing for all.
    pub kinds: Option<Vec<String>>,
    /// How far robots that need not keep to the line may leave it; nothing if all keep to it.
    pub corridor: Option<Corridor>,
}

/// A lane driven in one direction: the search expands arcs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// The lane of the arc.
    pub lane: LaneId,
    /// Start of the arc.
    pub from: NodeId,
    /// End of the arc.
    pub to: NodeId,
    /// Heading while driving, radians.
    pub heading: f64,
    /// Index of this heading among the distinct arrival headings of `to`; see [`Warehouse::headings`].
    pub slot: u8,
    /// Length, metres.
    pub length_m: f64,
    /// Speed limit, metres per second; infinite if there is none.
    pub speed_limit_mps: f64,
    /// Which robots may use the arc, and whether people may.
    pub users: Users,
}

/// The data that the search needs of an arc, packed: it looks at millions of them.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// End of the arc.
    pub to: NodeId,
    /// The lane of the arc.
    pub lane: LaneId,
    /// See [`Arc::slot`].
    pub slot: u8,
    /// Whether driving the lane needs nothing beyond its ends.
    pub lane_is_free: bool,
    /// Which robots may use the arc, and whether people may.
    pub users: Users,
    /// A bit for each kind of robots that may use the arc.
    pub bodies: u32,
}

impl Way {
    /// Whether robots of a kind may drive the arc.
    #[inline]
    pub fn is_for(&self, body: BodyId) -> bool {
        self.bodies >> body.ix() & 1 == 1
    }
}

/// A picking station.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// The map's name for the station, unique.
    pub name: String,
    /// The place of a robot while a person picks.
    pub node: NodeId,
    /// Waiting places, the one next to the station first.
    pub queue: Vec<NodeId>,
    /// Duration of a pick unless the job says otherwise.
    pub pick: Span,
    /// The station's work cell; without one, picks are spans of time.
    pub cell: Option<Cell>,
}

/// A rack as the map knows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rack {
    /// Unique name.
    pub name: String,
    /// The storage node where it stands when the system starts for the first time.
    pub home: NodeId,
    /// The type of load, for robots that carry some types only.
    pub load: Option<String>,
    /// Weight of the rack, kilograms.
    pub weight_kg: f64,
    /// The arrangement of the rack's bins; without a type it has no slots.
    pub rack_type: Option<RackTypeId>,
}

/// A mark on the floor: a place that can be touched or seen, with which a headset finds its position.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorMark {
    /// Unique name. A node with the same name is at the same place.
    pub name: String,
    /// Position, metres.
    pub at: Point,
}

/// A validated building. Made only by [`Draft::build`], which lists every problem of a bad one.
#[derive(Clone, Debug)]
pub struct Warehouse {
    /// Name of the map.
    pub name: String,
    /// Side of the square that a robot with its rack takes, metres.
    pub footprint_m: f64,
    /// All nodes.
    pub nodes: IdVec<NodeId, Node>,
    /// All lanes.
    pub lanes: IdVec<LaneId, Lane>,
    /// All lanes by direction, sorted by their start.
    pub arcs: IdVec<ArcId, Arc>,
    /// All stations.
    pub stations: IdVec<StationId, Station>,
    /// All racks.
    pub racks: IdVec<RackId, Rack>,
    /// Arrangements of bins in racks.
    pub rack_types: IdVec<RackTypeId, RackType>,
    /// Outlines of the floor on which people may walk.
    pub walkable: Vec<Vec<Point>>,
    /// Outlines of obstacles.
    pub obstacles: Vec<Vec<Point>>,
    /// Marks on the floor.
    pub marks: Vec<FloorMark>,
    out_start: Vec<u32>,
    ways: IdVec<ArcId, Way>,
    kinds: IdVec<NodeId, NodeKind>,
    headings: IdVec<NodeId, SmallVec<[f64; 4]>>,
    conflicts: IdVec<ResourceId, SmallVec<[ResourceId; 2]>>,
    bodies: body::Bodies,
    lines: body::Conflicts,
    near: near::PointIndex,
}

impl Warehouse {
    /// The arcs that leave `n`.
    #[inline]
    pub fn out(&self, n: NodeId) -> impl Iterator<Item = (ArcId, &Arc)> {
        let (from, to) = (self.out_start[n.ix()] as usize, self.out_start[n.ix() + 1] as usize);
        (from..to).map(|i| (ArcId::at(i), &self.arcs[ArcId::at(i)]))
    }

    /// The arcs that leave `n`, packed.
    #[inline]
    pub fn ways(&self, n: NodeId) -> impl Iterator<Item = (ArcId, Way)> {
        let (from, to) = (self.out_start[n.ix()] as usize, self.out_start[n.ix() + 1] as usize);
        (from..to).map(|i| (ArcId::at(i), self.ways[ArcId::at(i)]))
    }

    /// The purpose of a node, without the rest of it.
    #[inline]
    pub fn kind(&self, n: NodeId) -> NodeKind {
        self.kinds[n]
    }

    /// The distinct headings with which a robot can arrive at `n`, radians.
    #[inline]
    pub fn headings(&self, n: NodeId) -> &[f64] {
        &self.headings[n]
    }

    /// The node as a resource.
    #[inline]
    pub fn node_resource(&self, n: NodeId) -> ResourceId {
        ResourceId(n.0)
    }

    /// The lane as a resource.
    #[inline]
    pub fn lane_resource(&self, l: LaneId) -> ResourceId {
        ResourceId::at(self.nodes.len() + l.ix())
    }

    /// The node, or else the lane, of a resource.
    #[inline]
    pub fn resource(&self, r: ResourceId) -> Result<NodeId, LaneId> {
        if r.ix() < self.nodes.len() { Ok(NodeId(r.0)) } else { Err(LaneId::at(r.ix() - self.nodes.len())) }
    }

    /// Number of nodes and lanes together.
    #[inline]
    pub fn resource_count(&self) -> usize {
        self.nodes.len() + self.lanes.len()
    }

    /// The resources that no other robot may hold while `r` is held, without `r` itself, if both robots take the square
    /// of the map (see [`Warehouse::lines_in_conflict`] for others). A lane's own end nodes are not included: a robot
    /// that drives a lane holds both ends anyway, so most lanes have no conflicts at all.
    #[inline]
    pub fn conflicts(&self, r: ResourceId) -> &[ResourceId] {
        &self.conflicts[r]
    }

    /// Whether driving the lane needs nothing beyond its two ends, so that it needs no timeline.
    #[inline]
    pub fn lane_is_free_of_conflicts(&self, l: LaneId) -> bool {
        self.lines_of(self.lane_resource(l)).all(|line| self.lines[line].is_empty())
    }

    /// Number of resources that need a timeline of their own: all nodes, and the lanes that reach beyond their ends.
    #[inline]
    pub fn timeline_count(&self) -> usize {
        self.nodes.len() + self.lanes.ids().filter(|l| !self.lane_is_free_of_conflicts(*l)).count()
    }

    /// A resource's name for people.
    pub fn resource_name(&self, r: ResourceId) -> String {
        match self.resource(r) {
            Ok(n) => self.nodes[n].name.clone(),
            Err(l) => {
                let lane = &self.lanes[l];
                format!("{}–{}", self.nodes[lane.a].name, self.nodes[lane.b].name)
            }
        }
    }

    /// The node with this name.
    #[inline]
    pub fn node_named(&self, name: &str) -> Option<NodeId> {
        self.nodes.pairs().find(|(_, n)| n.name == name).map(|(i, _)| i)
    }

    /// The position of the mark with this name; every node is a mark, too.
    #[inline]
    pub fn mark_named(&self, name: &str) -> Option<Point> {
        let mark = self.marks.iter().find(|m| m.name == name).map(|m| m.at);
        mark.or_else(|| self.node_named(name).map(|n| self.nodes[n].at))
    }

    /// The rack with this name.
    #[inline]
    pub fn rack_named(&self, name: &str) -> Option<RackId> {
        self.racks.pairs().find(|(_, r)| r.name == name).map(|(i, _)| i)
    }

    /// The station with this name.
    #[inline]
    pub fn station_named(&self, name: &str) -> Option<StationId> {
        self.stations.pairs().find(|(_, s)| s.name == name).map(|(i, _)| i)
    }

    /// Nodes of one kind.
    #[inline]
    pub fn nodes_where(&self, keep: impl Fn(NodeKind) -> bool) -> Vec<NodeId> {
        self.nodes.pairs().filter(|(_, n)| keep(n.kind)).map(|(i, _)| i).collect()
    }

    /// The nodes no farther than `radius` (metres) from a point, by id.
    #[inline]
    pub fn nodes_within(&self, at: Point, radius: f64) -> Vec<NodeId> {
        self.near.within(at, radius).into_iter().map(|(i, _)| NodeId::at(i)).collect()
    }

    /// Calls `each` with the nodes no farther than `radius` (metres) from a point, in no stated order.
    #[inline]
    pub fn each_node_within(&self, at: Point, radius: f64, mut each: impl FnMut(NodeId)) {
        self.near.each_within(at, radius, |i, _| each(NodeId::at(i)));
    }

    /// The smallest rectangle around all nodes, as `(low corner, high corner)`.
    pub fn bounds(&self) -> (Point, Point) {
        let mut low = Point::new(f64::INFINITY, f64::INFINITY);
        let mut high = Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY);
        let outlines = self.walkable.iter().chain(&self.obstacles).flatten().copied();
        for p in self.nodes.iter().map(|n| n.at).chain(outlines) {
            low = Point::new(low.x.min(p.x), low.y.min(p.y));
            high = Point::new(high.x.max(p.x), high.y.max(p.y));
        }
        (low, high)
    }
}

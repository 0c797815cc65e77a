//! From a draft with names to a [`Warehouse`] with ids: the only way to make one.
//!
//! Main types: [`Draft`] and its parts. Refuses: to build anything on which [`super::check`] finds a problem.

use super::body::Bodies;
use super::cell::{Cell, RackType};
use super::check::{self, Findings};
use super::conflict;
use super::corridor::Corridor;
use super::near::PointIndex;
use super::{Arc, FloorMark, Lane, Node, NodeKind, Rack, Station, Users, Warehouse, Way};
use crate::geometry::{Point, Segment, turn_between};
use crate::id::{Dense, IdVec, NodeId, RackTypeId, StationId};
use crate::time::Span;
use smallvec::SmallVec;
use std::collections::{BTreeMap, BTreeSet};

/// Arrival headings closer than this count as one, radians.
const SAME_HEADING: f64 = 0.02;

/// A building as a person or a file describes it: by names, unchecked.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Draft {
    /// Name of the map.
    pub name: String,
    /// Side of the square that a robot with its rack takes, metres.
    pub footprint_m: f64,
    /// The nodes.
    pub nodes: Vec<DraftNode>,
    /// The lanes between them.
    pub lanes: Vec<DraftLane>,
    /// Picking stations.
    pub stations: Vec<DraftStation>,
    /// Racks.
    pub racks: Vec<DraftRack>,
    /// How bins are arranged in racks.
    pub rack_types: Vec<RackType>,
    /// Names of nodes for racks.
    pub storage: Vec<String>,
    /// Names of charging nodes.
    pub chargers: Vec<String>,
    /// Names of parking nodes.
    pub parking: Vec<String>,
    /// Names of nodes where people come in.
    pub exits: Vec<String>,
    /// Outlines of the floor on which people may walk.
    pub walkable: Vec<Vec<Point>>,
    /// Outlines of obstacles.
    pub obstacles: Vec<Vec<Point>>,
    /// Marks on the floor.
    pub marks: Vec<FloorMark>,
}

/// A named place.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftNode {
    /// Unique name.
    pub name: String,
    /// Position, metres.
    pub at: Point,
}

/// A lane between two named places.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftLane {
    /// Name of one end.
    pub from: String,
    /// Name of the other end.
    pub to: String,
    /// Whether the lane may be driven backwards too.
    pub both: bool,
    /// Length, metres; the straight distance where absent.
    pub length_m: Option<f64>,
    /// Speed limit, metres per second.
    pub speed_limit_mps: Option<f64>,
    /// Which robots may use the lane, and whether people may.
    pub users: Users,
    /// The kinds of robots that may use the lane; nothing for all.
    pub kinds: Option<Vec<String>>,
    /// How far robots that need not keep to the line may leave it, as seen from `from` to `to`.
    pub corridor: Option<Corridor>,
}

impl DraftLane {
    /// A lane driven from `from` to `to` only, as long as the straight line.
    pub fn one_way(from: impl Into<String>, to: impl Into<String>, users: Users) -> DraftLane {
        let (from, to) = (from.into(), to.into());
        DraftLane {
            from,
            to,
            both: false,
            length_m: None,
            speed_limit_mps: None,
            users,
            kinds: None,
            corridor: None,
        }
    }

    /// A lane driven both ways, as long as the straight line.
    pub fn both_ways(from: impl Into<String>, to: impl Into<String>, users: Users) -> DraftLane {
        DraftLane { both: true, ..DraftLane::one_way(from, to, users) }
    }
}

/// A rack, described by names.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftRack {
    /// Unique name.
    pub name: String,
    /// Name of the rack's storage node.
    pub node: String,
    /// The type of load, for robots that carry some types only.
    pub load: Option<String>,
    /// Weight of the rack, kilograms.
    pub weight_kg: f64,
    /// Name of the rack's type, which determines the arrangement of its bins.
    pub rack_type: Option<String>,
}

impl DraftRack {
    /// A rack without type and weight: every robot can carry it.
    pub fn plain(name: impl Into<String>, node: impl Into<String>) -> DraftRack {
        DraftRack { name: name.into(), node: node.into(), load: None, weight_kg: 0.0, rack_type: None }
    }
}

/// A picking station, described by names.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftStation {
    /// Unique name.
    pub name: String,
    /// Name of the node where the robot stands.
    pub node: String,
    /// Names of the waiting places, the one next to the station first.
    pub queue: Vec<String>,
    /// Usual length of a pick.
    pub pick: Span,
    /// The station's work cell.
    pub cell: Option<Cell>,
}

impl Draft {
    /// Builds and validates.
    ///
    /// # Errors
    /// All problems found, each with its place and remedy.
    pub fn build(self) -> Result<Warehouse, Findings> {
        if let Err(mut findings) = check::names_and_numbers(&self) {
            if let Some((rest, doubts)) = check::without_bad_parts(&self) {
                let rest = rest.assemble();
                findings.also(check::well_formed(&rest, &doubts));
                findings.also(check::clear_of_things(&rest));
            }
            return Err(findings);
        }
        let warehouse = self.assemble();
        let mut findings = Findings::default();
        findings.also(check::clear_of_things(&warehouse));
        findings.also(check::well_formed(&warehouse, &check::Doubts::default()));
        findings.into_result()?;
        Ok(warehouse)
    }

    /// The draft without its bad parts, unchecked: for drawings only. Nothing if there are no nodes, or far too many.
    pub(super) fn salvaged(&self) -> Option<Warehouse> {
        let (mut rest, _) = check::without_bad_parts(self)?;
        let mut free: BTreeSet<&str> = rest.storage.iter().map(String::as_str).collect();
        let good = self.racks.iter().filter(|r| free.remove(r.node.as_str())).cloned().collect();
        rest.racks = good;
        let good = |o: &Vec<Point>| o.iter().all(|p| p.x.is_finite() && p.y.is_finite());
        rest.walkable.retain(good);
        rest.obstacles.retain(good);
        Some(rest.assemble())
    }

    /// Builds without the checks on the whole floor, for tests of single parts and benchmark grids.
    #[doc(hidden)]
    pub fn build_unchecked(self) -> Warehouse {
        self.assemble()
    }

    /// Turns names into ids. All names are known to exist here.
    fn assemble(self) -> Warehouse {
        let ids: BTreeMap<&str, NodeId> =
            self.nodes.iter().enumerate().map(|(i, n)| (n.name.as_str(), NodeId::at(i))).collect();
        let id = |name: &String| ids[name.as_str()];
        let stations: IdVec<StationId, Station> = (self.stations.iter())
            .map(|s| Station {
                name: s.name.clone(),
                node: id(&s.node),
                queue: s.queue.iter().map(id).collect(),
                pick: s.pick,
                cell: s.cell.clone(),
            })
            .collect();
        let kinds = self.kinds(&ids, &stations);
        let nodes: IdVec<NodeId, Node> = (self.nodes.iter().zip(kinds.iter()))
            .map(|(n, &kind)| Node { name: n.name.clone(), at: n.at, kind })
            .collect();
        let straight = |a: NodeId, b: NodeId| Segment { a: nodes[a].at, b: nodes[b].at }.length();
        let lanes = (self.lanes.iter())
            .map(|l| Lane {
                a: id(&l.from),
                b: id(&l.to),
                both: l.both,
                length_m: l.length_m.unwrap_or_else(|| straight(id(&l.from), id(&l.to))),
                speed_limit_mps: l.speed_limit_mps,
                users: l.users,
                kinds: l.kinds.clone(),
                corridor: l.corridor,
            })
            .collect();
        let racks = (self.racks.iter())
            .map(|r| Rack {
                name: r.name.clone(),
                home: id(&r.node),
                load: r.load.clone(),
                weight_kg: r.weight_kg,
                rack_type: r.rack_type.as_ref().and_then(|t| self.rack_type_named(t)),
            })
            .collect();
        let mut warehouse = Warehouse {
            name: self.name,
            footprint_m: self.footprint_m,
            conflicts: conflict::between(&nodes, &lanes, self.footprint_m),
            bodies: Bodies::one(self.footprint_m, nodes.len()),
            lines: IdVec::new(),
            near: PointIndex::new(nodes.iter().map(|n| n.at).collect()),
            nodes,
            lanes,
            arcs: IdVec::new(),
            stations,
            racks,
            rack_types: self.rack_types.into(),
            walkable: self.walkable,
            obstacles: self.obstacles,
            marks: self.marks,
            out_start: Vec::new(),
            ways: IdVec::new(),
            kinds: IdVec::new(),
            headings: IdVec::new(),
        };
        warehouse.index_lines();
        warehouse.index_arcs();
        warehouse
    }

    fn rack_type_named(&self, name: &str) -> Option<RackTypeId> {
        self.rack_types.iter().position(|t| t.name == name).map(RackTypeId::at)
    }

    fn kinds(
        &self,
        ids: &BTreeMap<&str, NodeId>,
        stations: &IdVec<StationId, Station>,
    ) -> IdVec<NodeId, NodeKind> {
        let mut kinds: IdVec<NodeId, NodeKind> = IdVec::filled(NodeKind::Aisle, self.nodes.len());
        let lists = [
            (&self.storage, NodeKind::Storage),
            (&self.chargers, NodeKind::Charger),
            (&self.parking, NodeKind::Parking),
            (&self.exits, NodeKind::Exit),
        ];
        for (names, kind) in lists {
            for name in names {
                kinds[ids[name.as_str()]] = kind;
            }
        }
        for (s, station) in stations.pairs() {
            kinds[station.node] = NodeKind::Station(s);
            for &q in &station.queue {
                kinds[q] = NodeKind::Queue(s);
            }
        }
        kinds
    }
}

impl Warehouse {
    /// Fills `arcs`, `out_start` and `headings` from nodes and lanes.
    pub(super) fn index_arcs(&mut self) {
        let mut arcs: Vec<Arc> = Vec::new();
        for (id, lane) in self.lanes.pairs() {
            let ways = [(lane.a, lane.b), (lane.b, lane.a)];
            for &(from, to) in &ways[..if lane.both { 2 } else { 1 }] {
                let heading = Segment { a: self.nodes[from].at, b: self.nodes[to].at }.heading();
                arcs.push(Arc {
                    lane: id,
                    from,
                    to,
                    heading,
                    slot: 0,
                    length_m: lane.length_m,
                    speed_limit_mps: lane.speed_limit_mps.unwrap_or(f64::INFINITY),
                    users: lane.users,
                });
            }
        }
        arcs.sort_by_key(|a| (a.from, a.to, a.lane));
        self.headings = IdVec::filled(SmallVec::new(), self.nodes.len());
        for arc in &mut arcs {
            let known = &mut self.headings[arc.to];
            let slot = known.iter().position(|h| turn_between(*h, arc.heading) < SAME_HEADING);
            arc.slot = slot.unwrap_or_else(|| {
                known.push(arc.heading);
                known.len() - 1
            }) as u8;
        }
        self.out_start = vec![0; self.nodes.len() + 1];
        for arc in &arcs {
            self.out_start[arc.from.ix() + 1] += 1;
        }
        for i in 0..self.nodes.len() {
            self.out_start[i + 1] += self.out_start[i];
        }
        self.ways = (arcs.iter())
            .map(|a| Way {
                to: a.to,
                lane: a.lane,
                slot: a.slot,
                lane_is_free: self.lane_is_free_of_conflicts(a.lane),
                users: a.users,
                bodies: self.bodies_on(a.lane),
            })
            .collect();
        self.kinds = self.nodes.iter().map(|n| n.kind).collect();
        self.arcs = arcs.into();
    }
}

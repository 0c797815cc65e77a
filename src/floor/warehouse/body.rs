//! Which kinds of robots each lane, place and rack is for, and which resources exclude one another where two kinds
//! meet.
//!
//! Main types: [`Body`] (the building's view of a kind), [`Conflicts`]. Main function: [`Warehouse::for_bodies`].
//!
//! The rule: a robot with footprint `f` on a resource `r` excludes a robot with footprint `g` from a resource `s`
//! exactly if the areas that the two outlines take there overlap. Each resource therefore has a timeline for each
//! footprint ([`LineId`]), with everything in it that excludes a robot with that footprint. Reading costs as much as
//! with one footprint; a hold is written once for each footprint and conflict, so the cost of writing is multiplied by
//! the number of footprints.
//!
//! Refuses: footprints that reach beyond the one for which the map was drawn, since the map was checked with that for
//! being well-formed (invariant a); kinds whose lanes are not a well-formed floor of their own.

use super::check::{self, Doubts, Findings};
use super::footprint::Footprint;
use super::{Lane, Users, Warehouse};
use crate::geometry::Segment;
use crate::id::{ArcId, BodyId, Dense, IdVec, LaneId, LineId, NodeId, RackId, ResourceId};
use smallvec::SmallVec;

/// Largest number of kinds on one floor.
pub const MOST_BODIES: usize = 32;

/// The building's view of a kind of robots.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// The name of the kind.
    pub kind: String,
    /// Outlines of the kind without and with a rack; nothing for the square of the map.
    pub footprints: [Option<Footprint>; 2],
    /// The types of racks that the kind can carry; nothing for all.
    pub carries: Option<Vec<String>>,
    /// The heaviest rack that the kind can carry, kilograms.
    pub payload_kg: f64,
}

impl Body {
    /// A kind that takes the square of the map, carries every rack and drives all lanes that are not for other kinds.
    pub fn usual(kind: &str) -> Body {
        Body { kind: kind.into(), footprints: [None, None], carries: None, payload_kg: f64::INFINITY }
    }

    /// The outlines of the kind without and with a rack.
    fn outlines(&self, square: &Footprint) -> [Footprint; 2] {
        self.footprints.each_ref().map(|f| f.clone().unwrap_or_else(|| square.clone()))
    }
}

/// The bodies on a floor, with what follows from their footprints.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    bodies: IdVec<BodyId, Body>,
    /// All different footprints.
    footprints: Vec<Footprint>,
    /// For each body the index of its footprint without and with a rack.
    of: IdVec<BodyId, [usize; 2]>,
    /// For each node, a bit for each body that may be there.
    places: IdVec<NodeId, u32>,
}

impl Bodies {
    /// The bodies of a floor with one kind that takes the square of the map.
    pub fn one(footprint_m: f64, nodes: usize) -> Bodies {
        Bodies {
            bodies: vec![Body::usual("robot")].into(),
            footprints: vec![Footprint::Square { side_m: footprint_m }],
            of: vec![[0, 0]].into(),
            places: IdVec::filled(u32::MAX, nodes),
        }
    }
}

/// For each line, the other lines that a hold on it blocks.
pub(super) type Conflicts = IdVec<LineId, SmallVec<[LineId; 2]>>;

impl Warehouse {
    /// The same building for robots of these kinds.
    ///
    /// # Errors
    /// Each kind for which the floor was not drawn, with a remedy.
    pub fn for_bodies(&self, bodies: Vec<Body>) -> Result<Warehouse, Findings> {
        let mut found = Findings::default();
        if bodies.is_empty() || bodies.len() > MOST_BODIES {
            let problem = format!("there are {}", bodies.len());
            found.add("robot kinds", problem, format!("give from one to {MOST_BODIES}"));
            return Err(found);
        }
        let square = Footprint::Square { side_m: self.footprint_m };
        bodies.iter().for_each(|body| check_footprints(body, &square, &mut found));
        let w = self.with_bodies(bodies);
        w.bodies.bodies.ids().for_each(|body| w.check_floor_of(body, &mut found));
        found.into_result()?;
        Ok(w)
    }

    /// Whether the floor was drawn for robots of a kind, whatever other kinds there are. Looks at the whole floor,
    /// which takes a while on a large map.
    ///
    /// # Errors
    /// Why the floor was not drawn for the kind, with a remedy.
    pub fn check_body(&self, body: &Body) -> Result<(), Findings> {
        self.check_outlines(body)?;
        let mut found = Findings::default();
        self.with_bodies(vec![body.clone()]).check_floor_of(BodyId(0), &mut found);
        found.into_result()
    }

    /// Whether the outlines of a kind lie within the square for which the map was drawn, and the outline without a rack
    /// within the one with a rack. Takes almost no time.
    ///
    /// # Errors
    /// The outlines that do not, with a remedy.
    pub fn check_outlines(&self, body: &Body) -> Result<(), Findings> {
        let mut found = Findings::default();
        check_footprints(body, &Footprint::Square { side_m: self.footprint_m }, &mut found);
        found.into_result()
    }

    /// The same building for robots of these kinds, unchecked: stored kinds were checked before.
    pub fn with_bodies(&self, bodies: Vec<Body>) -> Warehouse {
        let square = Footprint::Square { side_m: self.footprint_m };
        let (mut footprints, mut of) = (Vec::new(), IdVec::new());
        for body in &bodies {
            of.push(body.outlines(&square).map(|f| {
                let known = footprints.iter().position(|k| *k == f);
                known.unwrap_or_else(|| {
                    footprints.push(f);
                    footprints.len() - 1
                })
            }));
        }
        let bodies = Bodies { bodies: bodies.into(), footprints, of, places: self.bodies.places.clone() };
        let mut w = Warehouse { bodies, ..self.clone() };
        w.index_lines();
        w.index_arcs();
        w.bodies.places = w.places_of_bodies();
        w
    }

    /// Fills the conflicts of all footprints.
    pub(super) fn index_lines(&mut self) {
        self.lines = self.conflicts_of_footprints();
    }

    /// Checks that the lanes that a kind may drive are a floor in which it is never stuck. Without rules about kinds,
    /// that is the floor of the map, which was checked.
    fn check_floor_of(&self, body: BodyId, found: &mut Findings) {
        let kind = &self.bodies.bodies[body].kind;
        let mut own = self.clone();
        // A place from which the kind cannot come back is no place for it, nor is a lane to there a lane for it.
        let leads = |l: &Lane| self.may_be_at(body, l.a) && self.may_be_at(body, l.b);
        let robots = |l: &Lane| l.users.unloaded || l.users.loaded;
        for lane in own.lanes.iter_mut().filter(|l| robots(l) && !(is_for(l, kind) && leads(l))) {
            lane.users = Users { unloaded: false, loaded: false, ..lane.users };
        }
        if own.lanes == self.lanes {
            return;
        }
        own.index_arcs();
        let places = self.nodes.pairs().filter(|(n, _)| !self.may_be_at(body, *n));
        let doubts = Doubts { places: places.map(|(_, n)| n.name.clone()).collect(), ..Doubts::default() };
        if let Err(problems) = check::well_formed(&own, &doubts) {
            for problem in problems.0 {
                let place = format!("robots of kind {kind:?}, {}", problem.place);
                found.add(place, problem.problem, problem.remedy);
            }
        }
    }

    /// The conflicts of each pair of footprints, among pairs of resources that overlap for the map's square: the
    /// footprints lie within the square, so there are no other conflicts.
    fn conflicts_of_footprints(&self) -> Conflicts {
        let count = self.resource_count();
        let footprints = &self.bodies.footprints;
        let mut found = Conflicts::filled(SmallVec::new(), footprints.len() * count);
        let square = Footprint::Square { side_m: self.footprint_m };
        for (i, f) in footprints.iter().enumerate() {
            for (r, s) in self.pairs_near() {
                for (j, g) in footprints.iter().enumerate() {
                    let same = r == s;
                    let taken = if same {
                        i != j
                    } else if *f == square && *g == square {
                        true
                    } else {
                        self.taken(f, r).overlaps(&self.taken(g, s), super::conflict::TOUCH)
                    };
                    if taken {
                        found[LineId::at(i * count + r.ix())].push(LineId::at(j * count + s.ix()));
                    }
                }
            }
        }
        found.iter_mut().for_each(|list| list.sort_unstable());
        found
    }

    /// Pairs of resources in conflict for the square of the map, both ways round, and each node with itself.
    fn pairs_near(&self) -> impl Iterator<Item = (ResourceId, ResourceId)> {
        let nodes = self.nodes.ids().map(|n| (self.node_resource(n), self.node_resource(n)));
        let others = self.conflicts.ids().flat_map(|r| self.conflicts[r].iter().map(move |s| (r, *s)));
        nodes.chain(others)
    }

    /// The floor area that a robot with a footprint may take while it holds a resource; conflicts are computed from it.
    pub fn taken(&self, footprint: &Footprint, r: ResourceId) -> super::footprint::Hull {
        match self.resource(r) {
            Ok(n) => footprint.standing(self.nodes[n].at),
            Err(l) => {
                let lane = &self.lanes[l];
                let line = Segment { a: self.nodes[lane.a].at, b: self.nodes[lane.b].at };
                match lane.corridor {
                    Some(corridor) => footprint.free(line, corridor),
                    None => footprint.driving(line),
                }
            }
        }
    }

    /// For each node the bodies that can come there and leave again.
    fn places_of_bodies(&self) -> IdVec<NodeId, u32> {
        let mut came: IdVec<NodeId, u32> = IdVec::filled(0, self.nodes.len());
        let mut left = came.clone();
        for (arc, way) in self.arcs.iter().zip(self.ways.iter()).filter(|(a, _)| a.users.allows(false)) {
            came[arc.to] |= way.bodies;
            left[arc.from] |= way.bodies;
        }
        self.nodes.ids().map(|n| came[n] & left[n]).collect()
    }

    /// A bit for each kind that may drive a lane.
    pub(super) fn bodies_on(&self, lane: LaneId) -> u32 {
        let bodies = self.bodies.bodies.pairs().filter(|(_, b)| is_for(&self.lanes[lane], &b.kind));
        bodies.fold(0, |bits, (b, _)| bits | 1 << b.ix())
    }

    /// Whether robots of a kind may drive an arc.
    pub fn may_drive(&self, body: BodyId, arc: ArcId) -> bool {
        self.ways[arc].is_for(body)
    }

    /// The kind with this name; the first kind if the building does not know it.
    pub fn body_of(&self, kind: &str) -> BodyId {
        let found = self.bodies.bodies.pairs().find(|(_, b)| b.kind == kind);
        found.map_or(BodyId(0), |(id, _)| id)
    }

    /// The kinds of robots that the building knows.
    pub fn bodies(&self) -> &IdVec<BodyId, Body> {
        &self.bodies.bodies
    }

    /// The footprint of a robot of a kind, without or with a rack.
    pub fn footprint(&self, body: BodyId, loaded: bool) -> &Footprint {
        &self.bodies.footprints[self.bodies.of[body][usize::from(loaded)]]
    }

    /// Half of the width of the widest robot, metres.
    pub fn widest_half_m(&self) -> f64 {
        self.bodies.footprints.iter().map(Footprint::half_m).fold(0.0, f64::max)
    }

    /// Whether robots of a kind may be at a node.
    pub fn may_be_at(&self, body: BodyId, node: NodeId) -> bool {
        self.bodies.places[node] >> body.ix() & 1 == 1
    }

    /// Whether a robot of a kind can carry a rack.
    pub fn can_carry(&self, body: BodyId, rack: RackId) -> bool {
        let (body, rack) = (&self.bodies.bodies[body], &self.racks[rack]);
        let fits =
            body.carries.as_ref().is_none_or(|types| rack.load.as_ref().is_some_and(|l| types.contains(l)));
        fits && rack.weight_kg <= body.payload_kg
    }

    /// The timeline of a resource that robots of a kind use, without or with a rack.
    pub fn line(&self, body: BodyId, loaded: bool, r: ResourceId) -> LineId {
        LineId::at(self.bodies.of[body][usize::from(loaded)] * self.resource_count() + r.ix())
    }

    /// The timelines of a resource, one for each footprint.
    pub fn lines_of(&self, r: ResourceId) -> impl Iterator<Item = LineId> {
        (r.ix()..self.line_count()).step_by(self.resource_count()).map(LineId::at)
    }

    /// The resource of a timeline.
    pub fn resource_of(&self, line: LineId) -> ResourceId {
        ResourceId::at(line.ix() % self.resource_count())
    }

    /// Number of timelines: one for each resource and footprint.
    pub fn line_count(&self) -> usize {
        self.bodies.footprints.len() * self.resource_count()
    }

    /// The timelines that a hold on `line` is also written in: those of everything that it excludes.
    pub fn lines_in_conflict(&self, line: LineId) -> &[LineId] {
        &self.lines[line]
    }
}

fn is_for(lane: &Lane, kind: &str) -> bool {
    lane.kinds.as_ref().is_none_or(|kinds| kinds.iter().any(|k| k == kind))
}

fn check_footprints(body: &Body, square: &Footprint, found: &mut Findings) {
    let (kind, [unloaded, loaded]) = (&body.kind, &body.outlines(square));
    for (footprint, which) in [(unloaded, "footprint"), (loaded, "footprint_loaded")] {
        if !footprint.is_within(square) {
            let (half_m, side_m) = (footprint.half_m(), 2.0 * square.half_m());
            let problem = format!(
                "it reaches {half_m:.3} m from its middle, and the map is for robots {side_m} m wide"
            );
            let remedy = "make it smaller, or draw the map for a larger `footprint_m`";
            found.add(format!("{which} of kind {kind:?}"), problem, remedy);
        }
    }
    if !unloaded.is_within(loaded) {
        let problem = "without a rack it covers floor that it does not cover with one";
        let remedy = "give `footprint_loaded` an outline that contains the robot";
        found.add(format!("footprints of kind {kind:?}"), problem, remedy);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::warehouse::{Draft, DraftLane, DraftNode, mixed, thesis};
    use proptest::prelude::*;

    fn disc(kind: &str, radius_m: f64) -> Body {
        let footprints = [Some(Footprint::Circle { radius_m }), Some(Footprint::Circle { radius_m })];
        Body { footprints, ..Body::usual(kind) }
    }

    /// Nodes half a metre apart in a row.
    fn row(n: usize) -> Warehouse {
        let name = |i: usize| format!("N{i}");
        let at = |i: usize| Point::new(i as f64 * 0.5, 0.0);
        let nodes = (0..n).map(|i| DraftNode { name: name(i), at: at(i) }).collect();
        let lanes = (1..n).map(|i| DraftLane::both_ways(name(i - 1), name(i), Users::ALL)).collect();
        Draft { name: "row".into(), footprint_m: 1.2, nodes, lanes, ..Draft::default() }.build_unchecked()
    }

    fn problems(w: &Warehouse, body: Body) -> Vec<String> {
        let found = w.for_bodies(vec![body]).err().unwrap_or_default();
        found.0.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn small_robots_stand_where_large_ones_exclude_one_another_and_both() {
        let w = row(6).with_bodies(vec![disc("small", 0.2), Body::usual("large")]);
        let (small, large) = (BodyId(0), BodyId(1));
        let excludes = |a: BodyId, r: u32, b: BodyId, s: u32| {
            let (a, b) = (w.line(a, false, ResourceId(r)), w.line(b, false, ResourceId(s)));
            w.lines_in_conflict(a).contains(&b)
        };
        assert!(!excludes(small, 2, small, 3), "0.4 m wide, 0.5 m apart");
        assert!(
            excludes(large, 2, large, 4) && !excludes(large, 0, large, 3),
            "1.2 m wide, 1 m and 1.5 m apart"
        );
        assert!(excludes(small, 2, large, 3) && excludes(large, 3, small, 2), "0.2 m and 0.6 m, 0.5 m apart");
        assert!(!excludes(small, 2, large, 4) && !excludes(large, 4, small, 2), "1 m apart");
        assert!(excludes(small, 2, large, 2), "one robot on a node, of whichever kind");
    }

    #[test]
    fn kinds_for_which_a_map_was_not_drawn_are_refused_with_a_remedy() {
        let wide = problems(&thesis(), disc("wide", 0.5));
        assert!(wide[0].contains("0.9 m wide") && wide[0].contains("footprint_m"), "{wide:?}");
        let outlines = [0.4, 0.3].map(|radius_m| Some(Footprint::Circle { radius_m }));
        let shrinks = problems(&thesis(), Body { footprints: outlines, ..Body::usual("odd") });
        assert!(shrinks[0].contains("does not cover with one"), "{shrinks:?}");
        assert!(thesis().for_bodies(vec![]).is_err());
    }

    #[test]
    fn lanes_of_a_kind_have_to_be_a_floor_of_their_own() {
        let mut w = thesis();
        let node = w.node_named("G6-7").expect("it is there");
        for lane in w.lanes.iter_mut().filter(|l| l.a == node) {
            lane.kinds = Some(vec!["shuttle".into()]);
        }
        assert!(w.for_bodies(vec![Body::usual("shuttle")]).is_ok(), "all lanes are for shuttles");
        assert!(w.for_bodies(vec![Body::usual("mover")]).is_ok(), "movers go round");
        let south = |n: NodeId| thesis().nodes[n].at.y < 7.5;
        for lane in w.lanes.iter_mut().filter(|l| south(l.a) != south(l.b)) {
            lane.kinds = Some(vec!["shuttle".into()]);
        }
        w.index_arcs();
        let cut = problems(&w, Body::usual("mover"));
        assert!(cut.iter().all(|p| p.contains("\"mover\"")) && cut.len() > 1, "two floors: {cut:?}");
    }

    #[test]
    fn what_a_kind_can_carry_is_told_by_type_and_weight() {
        let bins = Body { carries: Some(vec!["bin".into()]), payload_kg: 30.0, ..Body::usual("weak") };
        let strong = Body { payload_kg: 30.0, carries: None, ..Body::usual("any") };
        let w = mixed().with_bodies(vec![Body { payload_kg: 60.0, ..bins.clone() }, bins, strong]);
        let (bin, shelf) = (RackId(0), RackId(1));
        assert_eq!((w.racks[bin].weight_kg, w.racks[shelf].weight_kg), (40.0, 400.0));
        let can = |body: u32, rack| w.can_carry(BodyId(body), rack);
        assert_eq!([can(0, bin), can(0, shelf)], [true, false], "bins alone");
        assert_eq!([can(1, bin), can(2, bin)], [false, false], "too heavy");
    }

    #[test]
    fn a_place_is_for_the_kinds_that_come_there_and_leave_again() {
        let w = mixed().with_bodies(vec![Body::usual("shuttle"), Body::usual("mover")]);
        assert!(w.nodes.ids().all(|n| w.may_be_at(BodyId(0), n)), "shuttles go everywhere");
        assert!(w.nodes.ids().all(|n| w.may_be_at(BodyId(1), n)), "movers come beneath racks from the aisle");
        let beneath = |body: BodyId| w.arcs.ids().filter(|a| w.may_drive(body, *a)).count();
        assert!(beneath(BodyId(1)) < beneath(BodyId(0)), "but do not pass there");
    }

    proptest! {
        #[test]
        fn two_resources_exclude_each_other_exactly_if_what_is_taken_there_overlaps(
            radii in prop::collection::vec(1u32..12, 1..4),
        ) {
            let bodies = radii.iter().enumerate().map(|(i, r)| disc(&format!("k{i}"), f64::from(*r) * 0.05));
            let w = row(7).with_bodies(bodies.collect());
            let count = w.resource_count() as u32;
            for (a, b) in w.bodies().ids().flat_map(|a| w.bodies().ids().map(move |b| (a, b))) {
                for (r, s) in (0..count).flat_map(|r| (0..count).map(move |s| (ResourceId(r), ResourceId(s)))) {
                    let (la, lb) = (w.line(a, true, r), w.line(b, true, s));
                    let found = w.lines_in_conflict(la).contains(&lb);
                    prop_assert_eq!(found, w.lines_in_conflict(lb).contains(&la), "one way only");
                    let overlap = w.taken(w.footprint(a, true), r)
                        .overlaps(&w.taken(w.footprint(b, true), s), super::super::conflict::TOUCH);
                    let ends = |r| match w.resource(r) {
                        Ok(n) => [n, n],
                        Err(l) => [w.lanes[l].a, w.lanes[l].b],
                    };
                    let share = ends(r).iter().any(|n| ends(s).contains(n));
                    let node = r == s && w.resource(r).is_ok();
                    let wanted = if node { la != lb } else { overlap && !share };
                    prop_assert_eq!(found, wanted, "{:?} {:?}", (a, r), (b, s));
                }
            }
        }
    }
}

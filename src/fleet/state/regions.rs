//! Regions around people for each kind of robots, and the conditions that follow from them.
//!
//! Main types: [`KindRegions`], [`KindConditions`]. Kinds with the same speeds, brakes and footprints share theirs, so
//! a fleet of one kind computes each once. Refuses: to look at people.

use crate::state::kind::{RobotKind, most_dangerous};
use giveway_floor::id::{BodyId, IdVec, NodeId};
use giveway_floor::route::{Cause, Condition, Conditions};
use giveway_floor::time::Span;
use giveway_floor::warehouse::Warehouse;
use giveway_people::aware::Regions;
use giveway_people::human::{Mover, Whereabouts};

/// Radii and speeds near people, by robot kind.
#[derive(Clone, Debug)]
pub struct KindRegions {
    sets: Vec<Regions>,
    of: IdVec<BodyId, usize>,
}

impl KindRegions {
    /// The regions of the kinds in a building. Kinds that the building does not tell apart get those of the most
    /// dangerous.
    pub fn new(warehouse: &Warehouse, all_kinds: &[RobotKind], period: Span) -> KindRegions {
        let period_s = period.as_secs_f64();
        let mut all = KindRegions { sets: Vec::new(), of: IdVec::new() };
        for body in warehouse.bodies().ids() {
            let is_it = |k: &&RobotKind| warehouse.body_of(&k.name) == body;
            let kinds: Vec<RobotKind> = all_kinds.iter().filter(is_it).cloned().collect();
            let kinds = if kinds.is_empty() { all_kinds } else { &kinds };
            let half_m = [false, true].map(|loaded| warehouse.footprint(body, loaded).half_m());
            let regions = Regions::for_outlines(most_dangerous(kinds), half_m, period_s);
            let known = all.sets.iter().position(|r| *r == regions);
            all.of.push(known.unwrap_or(all.sets.len()));
            if known.is_none() {
                all.sets.push(regions);
            }
        }
        all
    }

    /// All regions that differ, in the order of [`KindConditions::with_regions`].
    pub fn all(&self) -> &[Regions] {
        &self.sets
    }

    /// The regions of a kind.
    pub fn of(&self, body: BodyId) -> &Regions {
        &self.sets[self.of[body]]
    }

    /// The largest radii of regions 1, 2 and 3 around a worker that any robot without a rack keeps, metres.
    pub fn widest_m(&self, w: &Whereabouts) -> [f64; 3] {
        self.widest_of(w.sigma_m, |r| r.towards(w))
    }

    /// The same for a worker who is not on the floor.
    pub fn widest_for_m(&self, mover: Mover) -> [f64; 3] {
        self.widest_of(0.0, |r| r.for_mover(mover))
    }

    fn widest_of(&self, sigma_m: f64, towards: impl Fn(&Regions) -> Regions) -> [f64; 3] {
        let of = |r: &Regions| {
            let r = towards(r);
            let (stop, keep_out) = (r.stop_radius_m(false, sigma_m), r.keep_out_radius_m(false, sigma_m));
            [stop, keep_out, r.slow_radius_m(false, sigma_m)]
        };
        let wider = |a: [f64; 3], b: [f64; 3]| [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])];
        self.sets.iter().map(of).reduce(wider).expect("a fleet has a kind of robots")
    }
}

/// Conditions on nodes, for robots of each kind.
#[derive(Clone, Debug, Default)]
pub struct KindConditions {
    sets: Vec<Conditions>,
    of: IdVec<BodyId, usize>,
}

impl KindConditions {
    /// No conditions yet.
    pub fn none(warehouse: &Warehouse, regions: &KindRegions) -> KindConditions {
        let sets = regions.sets.iter().map(|_| Conditions::none(warehouse)).collect();
        KindConditions { sets, of: regions.of.clone() }
    }

    /// The conditions for robots of a kind.
    pub fn of(&self, body: BodyId) -> &Conditions {
        &self.sets[self.of[body]]
    }

    /// Each set of conditions with the regions that it follows from.
    pub fn with_regions<'a>(
        &'a mut self,
        regions: &'a KindRegions,
    ) -> impl Iterator<Item = (&'a mut Conditions, &'a Regions)> {
        assert_eq!(self.sets.len(), regions.sets.len(), "conditions follow from regions");
        self.sets.iter_mut().zip(&regions.sets)
    }

    /// All sets of conditions.
    pub fn all(&self) -> impl Iterator<Item = &Conditions> {
        self.sets.iter()
    }

    /// All sets of conditions, to change what holds for every robot.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut Conditions> {
        self.sets.iter_mut()
    }

    /// Adds the conditions of another value that pass with the step, kind by kind.
    pub fn include(&mut self, other: &KindConditions) {
        assert_eq!(self.sets.len(), other.sets.len(), "conditions of the same kinds");
        self.sets.iter_mut().zip(&other.sets).for_each(|(set, other)| set.include(other));
    }

    /// Adds a condition that passes with the step, for every robot.
    pub fn add(&mut self, node: NodeId, condition: Condition) {
        self.sets.iter_mut().for_each(|set| set.add(node, condition));
    }

    /// Adds a condition that lasts until it is lifted, for every robot.
    pub fn announce(&mut self, node: NodeId, condition: Condition) {
        self.sets.iter_mut().for_each(|set| set.announce(node, condition));
    }

    /// Takes the lasting conditions of a cause back from a node, for every robot.
    pub fn lift(&mut self, node: NodeId, cause: Cause) {
        self.sets.iter_mut().for_each(|set| set.lift(node, cause));
    }

    /// Takes the passing conditions of a cause back, for every robot.
    pub fn withdraw(&mut self, cause: Cause) {
        self.sets.iter_mut().for_each(|set| set.withdraw(cause));
    }

    /// Whether there are no conditions for any robot.
    pub fn is_empty(&self) -> bool {
        self.sets.iter().all(Conditions::is_empty)
    }

    /// Whether any condition passes with the step.
    pub fn has_passing(&self) -> bool {
        self.sets.iter().any(Conditions::has_passing)
    }
}

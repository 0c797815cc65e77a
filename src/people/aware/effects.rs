//! Turns beliefs about people into conditions for the search.
//!
//! Main type: [`Effects`]. Where a person is, no robot enters or leaves, and around that robots are slower; where a
//! person will almost surely walk within seconds, no robot may be; where a person may walk, a place has a cost in
//! proportion to the probability. Refuses: to look at robots.

use super::afoot::Afoot;
use super::occupancy::Occupancy;
use super::regions::Regions;
use crate::human::{Band, Hypothesis, Mover, Whereabouts, passages};
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{NodeId, WorkerId};
use giveway_floor::route::{Cause, Condition, Conditions, Effect};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeMap;

/// Probability from which a place is closed instead of having a soft cost.
const SURE: f64 = 0.5;
/// Probability below which a place is neither closed nor has a soft cost.
const NEGLIGIBLE: f64 = 0.05;
/// Cost of being surely in a person's way, seconds.
const IN_THE_WAY_S: f64 = 8.0;
/// How far ahead places are closed, and how far ahead they have a soft cost.
const HARD: Span = Span::from_secs(6);
const SOFT: Span = Span::from_secs(15);
/// The same for vehicles, beside which robots find no room on most roads: they leave the road before it comes.
const HARD_VEHICLE: Span = Span::from_secs(15);
const SOFT_VEHICLE: Span = Span::from_secs(30);
/// Without forecasts: places that a walker reaches within the first time are closed, within the second they have a soft
/// cost; seconds.
const HARD_REACH_S: f64 = 2.0;
const SOFT_REACH_S: f64 = 5.0;
/// How long conditions around a walking worker hold …
const NOW: Span = Span::from_millis(900);
/// … and the longest time they hold around a standing one.
const STOOD: Span = Span::from_secs(120);
/// Distance between region 1 and a robot that passes a person who stands aside for it, metres.
const ASIDE_M: f64 = 0.3;

/// How the fleet predicts when a worker occupies a node. In the halls that were measured, the first delivers more and
/// people wait less (docs/experiments.md).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum NodeWindows {
    /// For each path: from the arrival of a fast walker until a slow one has left; a worker who follows the assigned
    /// path is taken to keep to it.
    #[default]
    Speeds,
    /// By the calibrated forecast that robots brake by, node by node.
    Mixture,
}

/// Inputs for making conditions.
#[derive(Debug)]
pub struct Effects<'a> {
    /// The building.
    pub warehouse: &'a Warehouse,
    /// Radii and speeds.
    pub regions: &'a Regions,
    /// Distances of nodes on foot.
    pub afoot: &'a Afoot,
    /// The time now.
    pub now: Time,
}

impl Effects<'_> {
    /// Regions 2 and 3 around a worker's present place. A person who has stood for long is expected to stand as long
    /// again, so that robots look for other ways; conditions are made anew every step.
    pub fn presence(&self, conditions: &mut Conditions, worker: WorkerId, w: &Whereabouts, stood: Span) {
        let window = Window::new(self.now, self.now + stood.clamp(NOW, STOOD));
        let keep_out = self.regions.towards(w).keep_out_radius_m(true, w.sigma_m) + w.reach_m;
        self.around(conditions, worker, w, (window, keep_out));
    }

    /// Regions around a worker who stands aside for a robot: a slow robot may come as near as it can still stop.
    pub fn stands_aside(&self, conditions: &mut Conditions, worker: WorkerId, w: &Whereabouts) {
        let keep_out = self.regions.towards(w).stop_radius_m(true, w.sigma_m) + ASIDE_M + w.reach_m;
        self.around(conditions, worker, w, (Window::new(self.now, self.now + NOW), keep_out));
    }

    fn around(
        &self,
        conditions: &mut Conditions,
        worker: WorkerId,
        w: &Whereabouts,
        (window, keep_out): (Window, f64),
    ) {
        let cause = Cause::Worker(worker);
        let regions = self.regions.towards(w);
        let slow = regions.slow_radius_m(true, w.sigma_m) + w.reach_m;
        for (node, distance) in self.afoot.nodes_within(self.warehouse, w.at, slow) {
            let effect = if distance <= keep_out {
                Effect::NoEntryOrExit
            } else {
                Effect::Slow(regions.limits_mps(distance - w.reach_m, w.sigma_m))
            };
            conditions.add(node, Condition { window, effect, cause });
        }
    }

    /// Nodes on the paths that a worker may take, each from the arrival of a fast walker until a slow one has left,
    /// weighted by the probability of the path: our method ([`NodeWindows::Speeds`]).
    pub fn forecast(
        &self,
        conditions: &mut Conditions,
        (worker, mover): (WorkerId, Mover),
        paths: &[Hypothesis],
        band: Band,
    ) {
        let beside_m = self.regions.for_mover(mover).beside_m();
        let (hard, soft) = match mover {
            Mover::OnFoot => (HARD, SOFT),
            Mover::Vehicle(_) => (HARD_VEHICLE, SOFT_VEHICLE),
        };
        let mut found: BTreeMap<NodeId, (f64, usize, Window)> = BTreeMap::new();
        for (i, h) in paths.iter().enumerate().filter(|(_, h)| h.probability >= NEGLIGIBLE / 4.0) {
            passages(i, h, band, self.now, soft, |p| {
                for node in self.warehouse.nodes_within(p.at, beside_m) {
                    let entry = found.entry(node).or_insert((0.0, usize::MAX, p.window));
                    if entry.1 != i {
                        (entry.0, entry.1) = (entry.0 + h.probability, i);
                    }
                    entry.2 = hull(entry.2, p.window);
                }
            });
        }
        let cause = Cause::Worker(worker);
        for (node, (probability, _, window)) in found {
            let effect = match probability {
                p if p >= SURE && window.start() <= self.now + hard => Effect::Closed,
                p if p >= NEGLIGIBLE => Effect::SoftCost(Span::from_secs_f64(IN_THE_WAY_S * p.min(1.0))),
                _ => continue,
            };
            conditions.add(node, Condition { window, effect, cause });
        }
    }

    /// Nodes that a worker will occupy by the calibrated forecast ([`NodeWindows::Mixture`]).
    pub fn occupied(&self, conditions: &mut Conditions, worker: WorkerId, occupied: &[Occupancy]) {
        let cause = Cause::Worker(worker);
        for o in occupied.iter().filter(|o| o.window.end() > self.now) {
            let sure = o.likely.filter(|_| o.probability >= SURE);
            let closed = sure.filter(|w| w.start() <= self.now + HARD && w.end() > self.now);
            let (window, effect) = match closed {
                Some(window) => (window, Effect::Closed),
                None => (o.window, Effect::SoftCost(Span::from_secs_f64(IN_THE_WAY_S * o.probability))),
            };
            conditions.add(o.node, Condition { window, effect, cause });
        }
    }

    /// All nodes that a worker can reach, for use when forecasts have proved wrong.
    pub fn reachable(&self, conditions: &mut Conditions, worker: WorkerId, w: &Whereabouts) {
        let cause = Cause::Worker(worker);
        let comes_m = |seconds| w.mover.far_m(0.0) + w.mover.comes_m(w.velocity.norm(), seconds);
        let (hard_m, soft_m) = (comes_m(HARD_REACH_S), comes_m(SOFT_REACH_S));
        for (node, distance) in self.afoot.nodes_within(self.warehouse, w.at, soft_m) {
            let window = Window::new(self.now, self.now + Span::from_secs_f64(SOFT_REACH_S));
            let effect = if distance <= hard_m {
                Effect::Closed
            } else {
                Effect::SoftCost(Span::from_secs_f64(IN_THE_WAY_S))
            };
            conditions.add(node, Condition { window, effect, cause });
        }
    }

    /// A worker's whole planned path with regions 2 and 3 around it, as published (Petković 2021, sections 4.2.3 and
    /// 4.3.3).
    pub fn plan(
        &self,
        conditions: &mut Conditions,
        (worker, mover): (WorkerId, Mover),
        path: &Hypothesis,
        band: Band,
    ) {
        let (cause, regions) = (Cause::Worker(worker), self.regions.for_mover(mover));
        let keep_out = regions.keep_out_radius_m(true, 0.0);
        let slow = regions.slow_radius_m(true, 0.0);
        passages(0, path, band, self.now, Span::from_secs(120), |p| {
            for (node, distance) in self.afoot.nodes_within(self.warehouse, p.at, slow) {
                let effect = match distance {
                    d if d <= regions.beside_m() => Effect::Closed,
                    d if d <= keep_out => Effect::NoEntryOrExit,
                    d => Effect::Slow(regions.limits_mps(d, 0.0)),
                };
                conditions.add(node, Condition { window: p.window, effect, cause });
            }
        });
    }
}

fn hull(a: Window, b: Window) -> Window {
    Window::new(a.start().min(b.start()), a.end().max(b.end()))
}

/// Nodes on which a robot would reach into an outline.
pub fn nodes_in(warehouse: &Warehouse, outline: &[Point]) -> Vec<NodeId> {
    let half = warehouse.footprint_m / 2.0;
    let range = |of: fn(&Point) -> f64| {
        let ends = outline.iter().map(of);
        (ends.clone().fold(f64::INFINITY, f64::min) - half, ends.fold(f64::NEG_INFINITY, f64::max) + half)
    };
    let ((left, right), (low, high)) = (range(|p| p.x), range(|p| p.y));
    let near = |at: Point| left <= at.x && at.x <= right && low <= at.y && at.y <= high;
    let inside = |at: Point| near(at) && (is_inside(outline, at) || distance_to(outline, at) < half);
    warehouse.nodes.pairs().filter(|(_, n)| inside(n.at)).map(|(id, _)| id).collect()
}

/// Whether a point is inside an outline, by the even-odd rule.
fn is_inside(outline: &[Point], p: Point) -> bool {
    let edges = outline.iter().zip(outline.iter().cycle().skip(1));
    let crossings = edges
        .filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x);
    crossings.count() % 2 == 1
}

fn distance_to(outline: &[Point], p: Point) -> f64 {
    let edges = outline.iter().zip(outline.iter().cycle().skip(1));
    let distances = edges.map(|(a, b)| Segment { a: *a, b: *b }.distance_to(p));
    distances.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::Presence;
    use giveway_floor::geometry::Vector;
    use giveway_floor::route::Kinematics;
    use giveway_floor::warehouse::thesis;
    use giveway_floor::warehouse::walkway::Walkways;
    use std::sync::Arc;

    fn hall() -> (Warehouse, Regions, Afoot) {
        let w = thesis();
        let r = Regions::new(Kinematics::default(), w.footprint_m, 0.1);
        let afoot = Afoot::new(&w, Arc::new(Walkways::of(&w)));
        (w, r, afoot)
    }

    fn standing(at: Point) -> Whereabouts {
        let presence = Presence::Tracked;
        let (velocity, mover) = (Vector::zeros(), Mover::OnFoot);
        Whereabouts { at, sigma_m: 0.02, reach_m: 0.0, velocity, heading: None, presence, mover }
    }

    #[test]
    fn around_a_worker_nothing_comes_or_goes_and_beyond_it_is_slow() {
        let (warehouse, regions, afoot) = hall();
        let effects = Effects { warehouse: &warehouse, regions: &regions, afoot: &afoot, now: Time::ZERO };
        let mut conditions = Conditions::none(&warehouse);
        let node = warehouse.nodes.ids().next().unwrap();
        let at = warehouse.nodes[node].at;
        effects.presence(&mut conditions, WorkerId(0), &standing(at), Span::ZERO);
        assert!(matches!(conditions.of(node)[0].effect, Effect::NoEntryOrExit));
        let keep_out = regions.keep_out_radius_m(true, 0.02);
        let near: Vec<_> = afoot.nodes_within(&warehouse, at, keep_out);
        assert!(near.len() > 4);
        for n in warehouse.nodes.ids() {
            let no_entry = conditions.of(n).iter().any(|c| c.effect == Effect::NoEntryOrExit);
            assert_eq!(no_entry, near.iter().any(|(m, _)| *m == n), "{n:?}");
        }
    }

    #[test]
    fn the_surer_a_way_the_harder_its_conditions() {
        let (warehouse, regions, afoot) = hall();
        let effects = Effects { warehouse: &warehouse, regions: &regions, afoot: &afoot, now: Time::ZERO };
        let at = |i: usize| warehouse.nodes.iter().nth(i).unwrap().at;
        for (p, closed) in [(0.9, true), (0.3, false)] {
            let mut conditions = Conditions::none(&warehouse);
            let path = Hypothesis { probability: p, path: vec![at(0), at(1)], stay: None };
            effects.forecast(&mut conditions, (WorkerId(0), Mover::OnFoot), &[path], Band::ANY);
            let first = warehouse.nodes.ids().next().unwrap();
            assert_eq!(matches!(conditions.of(first)[0].effect, Effect::Closed), closed);
        }
    }

    #[test]
    fn hypotheses_that_share_a_place_add_up() {
        let (warehouse, regions, afoot) = hall();
        let effects = Effects { warehouse: &warehouse, regions: &regions, afoot: &afoot, now: Time::ZERO };
        let at = |i: usize| warehouse.nodes.iter().nth(i).unwrap().at;
        let h = |to: usize| Hypothesis { probability: 0.4, path: vec![at(0), at(to)], stay: None };
        let mut conditions = Conditions::none(&warehouse);
        effects.forecast(&mut conditions, (WorkerId(0), Mover::OnFoot), &[h(1), h(1)], Band::ANY);
        let first = warehouse.nodes.ids().next().unwrap();
        assert!(matches!(conditions.of(first)[0].effect, Effect::Closed), "0.4 and 0.4 make sure");
    }

    #[test]
    fn the_surer_a_node_is_taken_and_the_sooner_the_harder_its_condition() {
        let (warehouse, regions, afoot) = hall();
        let now = Time(20_000_000);
        let effects = Effects { warehouse: &warehouse, regions: &regions, afoot: &afoot, now };
        let node = warehouse.nodes.ids().next().unwrap();
        let window =
            |from_s: i64, to_s: i64| Window::new(now + Span::from_secs(from_s), now + Span::from_secs(to_s));
        let effect = |probability: f64, from_s: i64| {
            let likely = Some(window(from_s + 1, from_s + 2));
            let taken = Occupancy { node, probability, window: window(from_s, from_s + 4), likely };
            let mut conditions = Conditions::none(&warehouse);
            effects.occupied(&mut conditions, WorkerId(0), &[taken]);
            conditions.of(node).first().map(|c| (c.effect, c.window))
        };
        assert_eq!(effect(0.9, 0), Some((Effect::Closed, window(1, 2))));
        let soft = |s: f64| Effect::SoftCost(Span::from_secs_f64(s));
        assert_eq!(effect(0.25, 0), Some((soft(2.0), window(0, 4))));
        assert_eq!(effect(0.75, 8), Some((soft(6.0), window(8, 12))), "there is time to see");
        assert_eq!(effect(0.9, -4), None, "over");
    }

    #[test]
    fn without_forecasts_all_that_can_be_reached_is_closed_or_has_a_soft_cost() {
        let (warehouse, regions, afoot) = hall();
        let effects = Effects { warehouse: &warehouse, regions: &regions, afoot: &afoot, now: Time::ZERO };
        let node = warehouse.nodes.ids().next().unwrap();
        let at = warehouse.nodes[node].at;
        let mut conditions = Conditions::none(&warehouse);
        effects.reachable(&mut conditions, WorkerId(0), &standing(at));
        for (n, distance) in afoot.nodes_within(&warehouse, at, 20.0) {
            let found = conditions.of(n).first().map(|c| c.effect);
            match distance {
                d if d <= 3.2 => assert_eq!(found, Some(Effect::Closed), "{n:?}"),
                d if d <= 8.0 => assert!(matches!(found, Some(Effect::SoftCost(_))), "{n:?}"),
                _ => assert_eq!(found, None, "{n:?}"),
            }
        }
    }

    #[test]
    fn an_area_takes_all_nodes_whose_robots_would_reach_into_it() {
        let (warehouse, ..) = hall();
        let node = warehouse.nodes.ids().next().unwrap();
        let p = warehouse.nodes[node].at;
        let corner = |x: f64, y: f64| Point::new(p.x + x, p.y + y);
        let small = [corner(0.3, 0.3), corner(0.4, 0.3), corner(0.4, 0.4)];
        assert_eq!(nodes_in(&warehouse, &small), vec![node]);
        let far = [corner(-9.0, -9.0), corner(-8.0, -9.0), corner(-8.0, -8.0)];
        assert!(nodes_in(&warehouse, &far).is_empty());
    }
}

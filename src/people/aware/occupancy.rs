//! Which nodes a person will occupy, when, and with what probability.
//!
//! Main type: [`Occupancy`], main function: [`occupancies`]. It evaluates the calibrated mixture that robots brake by
//! (`collision`) node by node: a few places of each part are followed through time, so a person who passes a node
//! counts once there. Nobody walks through racks: a node counts only once a person can have come there on foot.
//! Refuses: to say what that means for robots (`effects`).

use crate::human::{FEW_PLACES, Mixture, Mover};
use giveway_floor::geometry::Point;
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::Warehouse;
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// Nodes that a person occupies with less than this probability are ignored.
const NEGLIGIBLE: f64 = 0.05;
/// A person is likely at a node while the probability of being there is at least this.
const LIKELY: f64 = 0.25;
/// Parts of a forecast with less than this share are ignored.
const SMALL: f64 = 0.01;
/// Number and length in milliseconds of the time slices ahead: finer where more is known.
const SLICES: [(i64, i64); 2] = [(10, 500), (10, 1000)];

/// When a person will be at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occupancy {
    /// The node.
    pub node: NodeId,
    /// The probability that the person comes to the node within the time looked ahead.
    pub probability: f64,
    /// When the probability of being there is not negligible.
    pub window: Window,
    /// When the person is likely to be there at each moment.
    pub likely: Option<Window>,
}

/// A person's expected stay at the end of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stay {
    /// Position of the stay.
    pub at: Point,
    /// From the arrival of a fast walker until a slow one has left.
    pub window: Window,
    /// Probability of the stay.
    pub probability: f64,
}

/// State of one node while the time slices are evaluated.
#[derive(Debug, Default)]
struct Seen {
    /// The places of each part that have been here, as bits.
    met: SmallVec<[u16; 24]>,
    /// The probability that the person has been here.
    ever: f64,
    /// The probability that the person is here in the current slice.
    during: f64,
    window: Option<Window>,
    likely: Option<Window>,
}

/// The nodes that a person occupies within 15 seconds of `now`. `person` gives the forecast for a moment, `on_foot` the
/// reachable nodes with their distances in metres; a person is at a node whose middle is within `beside_m`. Linear in
/// slices × parts of the forecast × [`FEW_PLACES`].
pub fn occupancies(
    warehouse: &Warehouse,
    (mover, beside_m): (Mover, f64),
    on_foot: &[(NodeId, f64)],
    stays: &[Stay],
    now: Time,
    person: impl Fn(Time) -> Option<Mixture>,
) -> Vec<Occupancy> {
    debug_assert!(on_foot.is_sorted_by_key(|(node, _)| *node));
    let mut nodes: BTreeMap<NodeId, Seen> = BTreeMap::new();
    let mut from = now;
    for span in SLICES.iter().flat_map(|(count, ms)| (0..*count).map(|_| Span::from_millis(*ms))) {
        let slice = Window::new(from, from + span);
        let Some(mixture) = person(from + Span(span.0 / 2)) else { return Vec::new() };
        let walked_m = mover.fastest_mps() * (slice.end() - now).as_secs_f64() + beside_m;
        let can_be = |node: NodeId| {
            let found = on_foot.binary_search_by_key(&node, |(n, _)| *n);
            found.is_ok_and(|i| on_foot[i].1 <= walked_m)
        };
        for (i, part) in mixture.parts.iter().enumerate().filter(|(_, p)| p.weight >= SMALL) {
            let share = part.weight / FEW_PLACES as f64;
            for (k, at) in part.few_places() {
                warehouse.each_node_within(at, beside_m, |node| {
                    if can_be(node) {
                        nodes.entry(node).or_default().visit(i, k, share);
                    }
                });
            }
        }
        nodes.values_mut().for_each(|seen| seen.end_slice(slice));
        from = slice.end();
    }
    for stay in stays.iter().filter(|s| s.window.start() <= from) {
        warehouse.each_node_within(stay.at, beside_m, |node| nodes.entry(node).or_default().stay(stay));
    }
    nodes.into_iter().filter_map(|(node, seen)| seen.occupancy(node)).collect()
}

impl Seen {
    /// Counts a place of a part that is here.
    fn visit(&mut self, part: usize, place: usize, share: f64) {
        if self.met.len() <= part {
            self.met.resize(part + 1, 0);
        }
        let bit = 1 << place;
        if self.met[part] & bit == 0 {
            self.met[part] |= bit;
            self.ever += share;
        }
        self.during += share;
    }

    fn end_slice(&mut self, slice: Window) {
        if self.during >= NEGLIGIBLE {
            self.window = Some(hull(self.window, slice));
        }
        if self.during >= LIKELY {
            self.likely = Some(hull(self.likely, slice));
        }
        self.during = 0.0;
    }

    /// Adds a stay of the person at the end of a path.
    fn stay(&mut self, stay: &Stay) {
        self.ever = self.ever.max(stay.probability);
        if stay.probability >= NEGLIGIBLE {
            self.window = Some(hull(self.window, stay.window));
        }
        if stay.probability >= LIKELY {
            self.likely = Some(hull(self.likely, stay.window));
        }
    }

    fn occupancy(self, node: NodeId) -> Option<Occupancy> {
        let probability = self.ever.min(1.0);
        let window = self.window.filter(|_| probability >= NEGLIGIBLE)?;
        Some(Occupancy { node, probability, window, likely: self.likely })
    }
}

fn hull(a: Option<Window>, b: Window) -> Window {
    a.map_or(b, |a| Window::new(a.start().min(b.start()), a.end().max(b.end())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::Part;
    use giveway_floor::warehouse::thesis;
    use nalgebra::Matrix2;

    const BESIDE_M: f64 = 0.8;

    /// Occupancies of a person who walks along x from the first node at `mps` metres per second, each share 20 metres
    /// further to the side, with a spread that grows by a fifth of the way.
    fn taken(
        w: &Warehouse,
        mps: f64,
        shares: &[f64],
        stays: &[Stay],
        reach: impl Fn(f64) -> bool,
    ) -> Vec<Occupancy> {
        let start = start(w);
        let person = |t: Time| {
            let m = mps * (t - Time::ZERO).as_secs_f64();
            let cov = Matrix2::identity() * (0.1 + 0.2 * m).powi(2);
            let part = |(i, weight): (usize, &f64)| {
                let mean = Point::new(start.x + m, start.y - 20.0 * i as f64);
                Part { weight: *weight, mean, cov }
            };
            Some(Mixture { parts: shares.iter().enumerate().map(part).collect() })
        };
        let distance = |n: NodeId| (w.nodes[n].at - start).norm();
        let on_foot: Vec<_> = w.nodes.ids().map(|n| (n, distance(n))).filter(|(_, m)| reach(*m)).collect();
        occupancies(w, (Mover::OnFoot, BESIDE_M), &on_foot, stays, Time::ZERO, person)
    }

    fn start(w: &Warehouse) -> Point {
        w.nodes.iter().next().unwrap().at
    }

    fn at(all: &[Occupancy], node: NodeId) -> Option<Occupancy> {
        all.iter().find(|o| o.node == node).copied()
    }

    fn node(w: &Warehouse, ahead_m: f64) -> NodeId {
        let from = start(w);
        w.nodes_within(Point::new(from.x + ahead_m, from.y), 0.6)[0]
    }

    #[test]
    fn a_node_on_the_way_is_taken_when_the_person_passes_it() {
        let w = thesis();
        let all = taken(&w, 1.0, &[1.0], &[], |_| true);
        let passed = at(&all, node(&w, 4.0)).expect("it is on the way");
        let likely = passed.likely.expect("surely");
        assert!(passed.probability > 0.4, "{passed:?}");
        assert!(likely.contains(Time(4_000_000)) && !likely.contains(Time(7_000_000)), "{passed:?}");
        assert!(passed.window.start() <= likely.start() && likely.end() <= passed.window.end());
        let here = at(&all, node(&w, 0.0)).unwrap();
        assert!(here.window.start() == Time::ZERO && here.window.end() < Time(3_000_000), "{here:?}");
    }

    #[test]
    fn a_person_who_passes_a_node_slowly_counts_once_there() {
        let w = thesis();
        for mps in [0.0, 0.2, 1.4] {
            let all = taken(&w, mps, &[0.3], &[], |_| true);
            assert!(all.iter().all(|o| o.probability <= 0.3 + 1e-9), "{mps}");
            assert!(at(&all, node(&w, 0.0)).unwrap().probability > 0.28, "{mps}");
        }
    }

    #[test]
    fn shares_of_a_forecast_that_take_one_node_add_up() {
        let w = thesis();
        let both = taken(&w, 1.0, &[0.4, 0.4], &[], |_| true);
        let one = at(&both, node(&w, 2.0)).unwrap().probability;
        assert!(one < 0.42, "the second share is twenty metres off: {one}");
        let person = |_| {
            let part = Part { weight: 0.4, mean: start(&w), cov: Matrix2::identity() * 0.01 };
            Some(Mixture { parts: vec![part, part] })
        };
        let on_foot: Vec<_> = w.nodes.ids().map(|n| (n, 0.0)).collect();
        let all = occupancies(&w, (Mover::OnFoot, BESIDE_M), &on_foot, &[], Time::ZERO, person);
        assert!((at(&all, node(&w, 0.0)).unwrap().probability - 0.8).abs() < 0.03);
    }

    #[test]
    fn nobody_walks_through_racks() {
        let w = thesis();
        let all = taken(&w, 1.0, &[1.0], &[], |m| m < 3.0);
        assert!(at(&all, node(&w, 2.0)).is_some() && at(&all, node(&w, 5.0)).is_none());
    }

    #[test]
    fn who_stays_at_the_end_of_a_way_keeps_the_node_as_long() {
        let w = thesis();
        let end = w.nodes[node(&w, 3.0)].at;
        let window = Window::new(Time(2_000_000), Time(40_000_000));
        let stay = |probability| taken(&w, 1.0, &[1.0], &[Stay { at: end, window, probability }], |_| true);
        let long = at(&stay(0.8), node(&w, 3.0)).unwrap();
        assert_eq!(long.likely.unwrap().end(), window.end());
        let maybe = at(&stay(0.1), node(&w, 3.0)).unwrap();
        assert!(maybe.window.end() == window.end() && maybe.likely.unwrap().end() < window.end());
    }

    #[test]
    fn nobody_who_was_never_seen_takes_a_node() {
        let w = thesis();
        let stay = Stay { at: start(&w), window: Window::new(Time::ZERO, Time(1)), probability: 1.0 };
        assert!(occupancies(&w, (Mover::OnFoot, BESIDE_M), &[], &[stay], Time::ZERO, |_| None).is_empty());
    }
}

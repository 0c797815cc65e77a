//! Areas that are closed to people: which way leads round them, which places lie inside, which people have to come out.
//!
//! Main type: [`Barred`]. Looked at when a closure is announced or taken back, and in no other step. Refuses: closures
//! that bind robots alone, and to lead people.

use crate::state::worker::Closure;
use giveway_floor::geometry::{Point, Segment, Spot, inside, runs_through};
use giveway_floor::id::{ClosureId, NodeId};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::walkway::{EdgeSet, Walkways};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The speed of slow walkers, metres per second: an area that begins before they would be through is walked round.
const SLOW_MPS: f64 = 0.8;
/// An area counts as closed from this long before it begins: people inside are led out from then on.
pub(super) const MARGIN: Span = Span::from_secs(10);
/// How far to each side of a node that is closed by name the floor is closed to people, metres.
const AROUND_NODE_M: f64 = 0.5;

/// One area that is closed to people.
#[derive(Clone, Debug)]
pub struct BarredArea {
    pub id: ClosureId,
    window: Window,
    outlines: Vec<Arc<[Point]>>,
}

/// All areas that are closed to people, now or later.
#[derive(Clone, Debug, Default)]
pub struct Barred {
    areas: Vec<BarredArea>,
    changes: u64,
}

impl BarredArea {
    fn of(id: ClosureId, closure: &Closure, warehouse: &Warehouse) -> BarredArea {
        let square = |n: &NodeId| {
            let (at, d) = (warehouse.nodes[*n].at, AROUND_NODE_M);
            let corner = |(x, y): (f64, f64)| Point::new(at.x + x, at.y + y);
            Arc::from([(-d, -d), (d, -d), (d, d), (-d, d)].map(corner))
        };
        let corner = |s: &Spot| Point::from(*s);
        let outlines = match closure.nodes.as_slice() {
            [] => vec![closure.outline.iter().map(corner).collect()],
            named => named.iter().map(square).collect(),
        };
        BarredArea { id, window: closure.window, outlines }
    }

    /// Whether a place lies inside the area.
    pub fn has(&self, p: Point) -> bool {
        self.outlines.iter().any(|o| inside(o, p))
    }

    /// Whether the area is closed at a time, or will be in a moment.
    pub fn is_shut(&self, at: Time) -> bool {
        self.window.start() <= at + MARGIN && at < self.window.end()
    }

    /// Whether a person who sets off now along a way would be inside the area while it is closed.
    fn is_met(&self, way: &[Point], now: Time) -> bool {
        let (mut length_m, mut last_m) = (0.0, None);
        for w in way.windows(2) {
            let step = Segment { a: w[0], b: w[1] };
            length_m += step.length();
            if self.outlines.iter().any(|o| runs_through(o, step)) {
                last_m = Some(length_m);
            }
        }
        let through = last_m.map(|m: f64| now + Span::from_secs_f64(m / SLOW_MPS));
        through.is_some_and(|t| self.window.start() <= t + MARGIN && now < self.window.end())
    }
}

impl Barred {
    /// Looks at the closures if some were announced or taken back.
    pub fn update(&mut self, closures: &BTreeMap<ClosureId, Closure>, changes: u64, warehouse: &Warehouse) {
        if changes == self.changes {
            return;
        }
        self.changes = changes;
        let people = closures.iter().filter(|(_, c)| c.binds.people());
        self.areas = people.map(|(id, c)| BarredArea::of(*id, c, warehouse)).collect();
    }

    /// Whether nothing is closed to people, now or later.
    pub fn is_empty(&self, now: Time) -> bool {
        self.areas.iter().all(|a| a.window.end() <= now)
    }

    /// The area around a place that is closed, or will be in a moment.
    pub fn around(&self, at: Point, now: Time) -> Option<&BarredArea> {
        self.areas.iter().find(|a| a.is_shut(now) && a.has(at))
    }

    /// The area around a place that has been closed for at least this long.
    pub fn closed_for(&self, at: Point, since: Span, now: Time) -> Option<ClosureId> {
        let shut = |a: &&BarredArea| a.window.start() + since <= now && now < a.window.end();
        self.areas.iter().filter(shut).find(|a| a.has(at)).map(|a| a.id)
    }

    /// The area that closes before a person who is now at `at` would have been at `place` for `stay`.
    pub fn shuts(&self, at: Point, place: Point, stay: Span, now: Time) -> Option<ClosureId> {
        let done = now + Span::from_secs_f64((place - at).norm() / SLOW_MPS) + stay;
        let shut = |a: &&BarredArea| a.window.start() <= done + MARGIN && now < a.window.end();
        self.areas.iter().filter(shut).find(|a| a.has(place)).map(|a| a.id)
    }

    /// The first area that a way leads into while it is closed, except for areas in which the way begins or ends.
    pub fn met(&self, way: &[Point], now: Time) -> Option<ClosureId> {
        self.met_areas(way, now).next().map(|a| a.id)
    }

    fn met_areas<'a>(&'a self, way: &'a [Point], now: Time) -> impl Iterator<Item = &'a BarredArea> {
        let ends = [way.first(), way.last()];
        let holds_an_end = move |a: &BarredArea| ends.iter().flatten().any(|p| a.has(**p));
        self.areas.iter().filter(move |a| a.is_met(way, now) && !holds_an_end(a))
    }

    /// Cuts the walkways in areas that are closed at this moment.
    pub fn cut_shut(&self, walkways: &Walkways, cut: &mut EdgeSet, now: Time) {
        let shut = self.areas.iter().filter(|a| a.is_shut(now)).flat_map(|a| &a.outlines);
        shut.for_each(|outline| walkways.cut_area(cut, outline));
    }

    /// The shortest way that uses no cut walkway and is in no area while that is closed; with an area that the way
    /// leads round.
    pub fn way_round(
        &self,
        walkways: &Walkways,
        (at, goal): (Point, Point),
        cut: &EdgeSet,
        now: Time,
    ) -> Option<(Vec<Point>, Option<ClosureId>)> {
        let (mut cut, mut round, mut avoided) = (cut.clone(), None, BTreeSet::new());
        loop {
            let way = walkways.path(at, goal, &cut)?.points;
            let met: Vec<&BarredArea> = self.met_areas(&way, now).collect();
            let Some(first) = met.first() else { return Some((way, round)) };
            round.get_or_insert(first.id);
            // From a place where no one can stand, the first piece may lead through an area that is cut already: then
            // there is no way round it.
            let new: Vec<&BarredArea> = met.into_iter().filter(|a| avoided.insert(a.id)).collect();
            if new.is_empty() {
                return None;
            }
            for outline in new.iter().flat_map(|a| &a.outlines) {
                walkways.cut_area(&mut cut, outline);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::lab;

    /// A small area around a point, closed for ever.
    fn around(p: Point) -> BarredArea {
        let corner = |x, y| Point::new(p.x + x, p.y + y);
        let outline = [corner(-0.02, -0.02), corner(0.02, -0.02), corner(0.02, 0.02), corner(-0.02, 0.02)];
        BarredArea { id: ClosureId(1), window: Window::from(Time::ZERO), outlines: vec![outline.into()] }
    }

    #[test]
    fn from_a_place_where_nobody_can_stand_the_search_for_a_way_round_an_area_ends() {
        let w = lab();
        let walkways = Walkways::of(&w);
        let free = walkways.no_edges();
        let goal = walkways.nodes().iter().next().expect("people walk there").at;
        let mut tried = 0;
        for (x, y) in (0..120).flat_map(|x| (0..80).map(move |y| (f64::from(x) * 0.17, f64::from(y) * 0.17)))
        {
            let at = Point::new(x, y);
            let Some(on) = walkways.on_floor(at).filter(|on| (on - at).norm() > 0.1) else { continue };
            let Some(way) = walkways.path(at, goal, &free) else { continue };
            let first = Segment { a: at, b: way.points[1] };
            let area = around(first.point(0.3));
            // The area lies across the way from where the worker is said to be, and not from where the worker can be.
            if area.outlines.iter().any(|o| runs_through(o, Segment { a: on, b: first.b })) || area.has(at) {
                continue;
            }
            tried += 1;
            let barred = Barred { areas: vec![area], changes: 0 };
            if let Some((way, _)) = barred.way_round(&walkways, (at, goal), &free, Time::ZERO) {
                assert_eq!(barred.met(&way, Time::ZERO), None);
            }
        }
        assert!(tried > 10, "only {tried} places");
    }
}

//! The earliest path on foot between robots: it is known when robots take a walkway, and a walker may wait.
//!
//! Main types: [`Occupied`] (when which points of the middle lines are taken), [`TimedPath`]. The search is safe
//! interval path planning (Phillips and Likhachev 2011): a label is a point and one of its free intervals, with the
//! earliest time of being there; the walker may wait wherever the interval lasts. Refuses: to know which robot takes a
//! place, and to look at more labels than it may.

use super::{EdgeSet, Walkways};
use crate::geometry::Point;
use crate::id::{RobotId, WalkNodeId};
use crate::time::{Span, Time, Window};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Distance within which a point of a path counts as a point of the middle lines, metres.
const ON_M: f64 = 0.5;

/// Length beyond which a straight segment leads past points of the middle lines, metres.
const STEP_M: f64 = 1.3;

/// When points of the middle lines are taken, and by which robots.
#[derive(Clone, Debug, Default)]
pub struct Occupied {
    windows: BTreeMap<WalkNodeId, Vec<(Window, RobotId)>>,
}

impl Occupied {
    /// Records that a robot takes a point for a while.
    pub fn add(&mut self, n: WalkNodeId, window: Window, robot: RobotId) {
        self.windows.entry(n).or_default().push((window, robot));
    }

    /// Sorts the recorded windows. Call this before any query.
    pub fn sort(&mut self) {
        self.windows
            .values_mut()
            .for_each(|w| w.sort_unstable_by_key(|(w, robot)| (w.start(), w.end(), *robot)));
    }

    /// The windows of a point that end after `from`, by their start.
    fn of(&self, n: WalkNodeId, from: Time) -> impl Iterator<Item = &(Window, RobotId)> {
        self.windows.get(&n).into_iter().flatten().filter(move |(w, _)| w.end() > from)
    }

    /// The free intervals of a point from `from` on, each with the robot that took it before the interval.
    fn free(&self, n: WalkNodeId, from: Time) -> Vec<(Window, Option<RobotId>)> {
        let (mut free, mut since, mut after) = (Vec::new(), from, None);
        for (window, robot) in self.of(n, from) {
            if window.start() > since {
                free.push((Window::new(since, window.start()), after));
            }
            if window.end() > since {
                (since, after) = (window.end(), Some(*robot));
            }
        }
        if since < Time::MAX {
            free.push((Window::from(since), after));
        }
        free
    }
}

/// A path with times.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedPath {
    /// All points, including the ends.
    pub points: Vec<Point>,
    /// Arrival time at each point.
    pub arrivals: Vec<Time>,
    /// For each point, the robot that the walker waits for before going there, if any.
    pub waits_for: Vec<Option<RobotId>>,
}

impl TimedPath {
    /// Arrival time at the end.
    pub fn arrival(&self) -> Time {
        *self.arrivals.last().expect("a way has two ends")
    }
}

/// Of the points that a walker can reach straight, the ones with no other point between; all, if none is near.
fn nearest_steps(steps: Vec<(WalkNodeId, f64)>) -> Vec<(WalkNodeId, f64)> {
    let near: Vec<_> = steps.iter().copied().filter(|(_, metres)| *metres <= STEP_M).collect();
    if near.is_empty() { steps } else { near }
}

/// The path with points added on long segments.
fn in_steps(points: &[Point]) -> Vec<Point> {
    let mut all = vec![points[0]];
    for piece in points.windows(2) {
        let parts = ((piece[1] - piece[0]).norm() / STEP_M).ceil().max(1.0) as u32;
        all.extend((1..=parts).map(|i| piece[0] + (piece[1] - piece[0]) * (f64::from(i) / f64::from(parts))));
    }
    all
}

/// How the walker came to a point.
#[derive(Clone, Copy)]
struct TimedLabel {
    node: WalkNodeId,
    interval: Window,
    at: Time,
    before: Option<usize>,
    /// The robot that the walker waited for.
    after: Option<RobotId>,
}

/// One search.
struct TimedSearch<'a> {
    walkways: &'a Walkways,
    cut: &'a EdgeSet,
    occupied: &'a Occupied,
    start: Time,
    speed_mps: f64,
    goal: Point,
    labels: Vec<TimedLabel>,
    best: BTreeMap<(WalkNodeId, Time), Time>,
    open: BinaryHeap<Reverse<(Time, usize)>>,
}

impl Walkways {
    /// The path from one point to another with the earliest arrival, for a walker that sets off no earlier than
    /// `start`, walks at `speed_mps`, and is nowhere while the place is taken; nothing if there is none, or none was
    /// found among the first `most` labels. The points at the start are free at first, even if a robot stands beside
    /// them.
    pub fn timed_path(
        &self,
        (from, to): (Point, Point),
        cut: &EdgeSet,
        occupied: &Occupied,
        (start, speed_mps): (Time, f64),
        most: usize,
    ) -> Option<TimedPath> {
        let last = nearest_steps(self.doorsteps(to, cut));
        let (labels, best, open) = (Vec::new(), BTreeMap::new(), BinaryHeap::new());
        let mut search =
            TimedSearch { walkways: self, cut, occupied, start, speed_mps, goal: to, labels, best, open };
        // A person standing somewhere may stay there until a robot takes the nearest point.
        let stays = self
            .nearest(from)
            .and_then(|(n, _)| occupied.of(n, start).map(|(w, _)| w.start()).find(|t| *t > start));
        let here = Window::new(start, stays.unwrap_or(Time::MAX));
        for (n, metres) in nearest_steps(self.doorsteps(from, cut)) {
            search.reach(n, metres, (start, here), None);
        }
        let end = search.run(&last, most)?;
        Some(search.path(from, to, end))
    }

    /// The arrival time at each of these points, walking from one to the next and waiting where that is free; nothing
    /// if the walker would have to be where a robot is.
    pub fn time_along(
        &self,
        points: &[Point],
        occupied: &Occupied,
        (start, speed_mps): (Time, f64),
    ) -> Option<TimedPath> {
        let near = |p: Point| self.nearest(p).filter(|(_, metres)| *metres < ON_M).map(|(n, _)| n);
        let points = in_steps(points);
        let (mut arrivals, mut waits_for) = (vec![start], vec![None]);
        let leaves = |n: WalkNodeId| occupied.of(n, start).map(|(w, _)| w.start()).find(|t| *t > start);
        let mut stays = near(points[0]).and_then(leaves).unwrap_or(Time::MAX);
        for step in points.windows(2) {
            let walk = Span::from_secs_f64((step[1] - step[0]).norm() / speed_mps);
            let earliest = *arrivals.last().expect("the start is there") + walk;
            let latest = if stays == Time::MAX { Time::MAX } else { stays + walk };
            let Some(n) = near(step[1]) else {
                arrivals.push(earliest);
                waits_for.push(None);
                continue;
            };
            let fits = |(w, _): &(Window, Option<RobotId>)| earliest.max(w.start()) < w.end();
            let (interval, after) = occupied.free(n, start).into_iter().find(fits)?;
            let there = earliest.max(interval.start());
            if there > latest {
                return None;
            }
            arrivals.push(there);
            waits_for.push(after.filter(|_| there > earliest));
            stays = interval.end();
        }
        Some(TimedPath { points, arrivals, waits_for })
    }
}

impl TimedSearch<'_> {
    fn walks(&self, metres: f64) -> Span {
        Span::from_secs_f64(metres / self.speed_mps)
    }

    /// Goes to a point from another one where the walker arrives at `at` and may stay until the end of `stays`.
    fn reach(&mut self, node: WalkNodeId, metres: f64, (at, stays): (Time, Window), before: Option<usize>) {
        let walk = self.walks(metres);
        let (earliest, latest) =
            (at + walk, if stays.end() == Time::MAX { Time::MAX } else { stays.end() + walk });
        for (interval, after) in self.occupied.free(node, self.start) {
            let there = earliest.max(interval.start());
            if there >= interval.end() || there > latest {
                continue;
            }
            let known = self.best.entry((node, interval.start())).or_insert(Time::MAX);
            if there >= *known {
                continue;
            }
            *known = there;
            let after = after.filter(|_| there > earliest);
            self.labels.push(TimedLabel { node, interval, at: there, before, after });
            let rest = self.walks((self.walkways.nodes()[node].at - self.goal).norm());
            self.open.push(Reverse((there + rest, self.labels.len() - 1)));
        }
    }

    /// The label from which the goal is reached first, with the remaining length in metres.
    fn run(&mut self, last: &[(WalkNodeId, f64)], most: usize) -> Option<(usize, f64)> {
        let mut found: Option<(Time, usize, f64)> = None;
        let mut expanded = 0;
        while let Some(Reverse((bound, i))) = self.open.pop() {
            if found.is_some_and(|(t, ..)| t <= bound) || expanded >= most {
                break;
            }
            let label = self.labels[i];
            if self.best[&(label.node, label.interval.start())] < label.at {
                continue;
            }
            expanded += 1;
            if let Ok(k) = last.binary_search_by_key(&label.node, |(n, _)| *n) {
                let there = label.at + self.walks(last[k].1);
                if found.is_none_or(|(t, ..)| there < t) {
                    found = Some((there, i, last[k].1));
                }
            }
            for &(e, next) in self.walkways.links(label.node).iter().filter(|(e, _)| !self.cut.contains(*e)) {
                self.reach(next, self.walkways.edges()[e].length_m, (label.at, label.interval), Some(i));
            }
        }
        found.map(|(_, i, metres)| (i, metres))
    }

    fn path(&self, from: Point, to: Point, (end, metres): (usize, f64)) -> TimedPath {
        let mut chain: Vec<&TimedLabel> =
            std::iter::successors(Some(&self.labels[end]), |l| l.before.map(|b| &self.labels[b])).collect();
        chain.reverse();
        let there = chain.last().map_or(self.start, |l| l.at) + self.walks(metres);
        let points = chain.iter().map(|l| self.walkways.nodes()[l.node].at);
        TimedPath {
            points: std::iter::once(from).chain(points).chain([to]).collect(),
            arrivals: std::iter::once(self.start).chain(chain.iter().map(|l| l.at)).chain([there]).collect(),
            waits_for: std::iter::once(None).chain(chain.iter().map(|l| l.after)).chain([None]).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::Dense;
    use crate::warehouse::thesis;
    use proptest::prelude::*;

    const MPS: f64 = 1.2;
    const MANY: usize = 100_000;

    fn at(seconds: f64) -> Time {
        Time::ZERO + Span::from_secs_f64(seconds)
    }

    /// From one end of an aisle of the hall to the other.
    fn aisle() -> (Walkways, Point, Point) {
        (Walkways::of(&thesis()), Point::new(3.0, 0.5), Point::new(3.0, 6.5))
    }

    fn taken(walkways: &Walkways, place: Point, from: f64, until: f64) -> Occupied {
        let mut occupied = Occupied::default();
        for n in walkways.around(place, 0.8) {
            occupied.add(n, Window::new(at(from), at(until)), RobotId(7));
        }
        occupied.sort();
        occupied
    }

    #[test]
    fn where_nothing_is_taken_the_earliest_way_is_the_shortest() {
        let (walkways, from, to) = aisle();
        let none = walkways.no_edges();
        let way = walkways.timed_path((from, to), &none, &Occupied::default(), (at(3.0), MPS), MANY).unwrap();
        let shortest = walkways.path(from, to, &none).unwrap();
        let seconds = (way.arrival() - at(3.0)).as_secs_f64();
        assert!((seconds - shortest.length_m / MPS).abs() < 1e-3, "{seconds}");
        assert!(way.waits_for.iter().all(Option::is_none));
    }

    #[test]
    fn one_waits_for_a_robot_that_passes_and_goes_round_one_that_stays() {
        let (walkways, from, to) = aisle();
        let none = walkways.no_edges();
        let find = |until| {
            let occupied = taken(&walkways, Point::new(3.0, 4.0), 0.0, until);
            walkways.timed_path((from, to), &none, &occupied, (at(0.0), MPS), MANY).unwrap()
        };
        let waits = find(8.0);
        assert!(waits.waits_for.contains(&Some(RobotId(7))), "{waits:?}");
        assert!(waits.points.iter().all(|p| (p.x - 3.0).abs() < 0.5), "{waits:?}");
        assert!(waits.arrival() > at(8.0) && waits.arrival() < at(11.5), "{waits:?}");
        let round = find(60.0);
        assert!(round.waits_for.iter().all(Option::is_none) && round.arrival() < at(20.0), "{round:?}");
    }

    #[test]
    fn who_stands_where_a_robot_comes_by_leaves_before() {
        let (walkways, from, to) = aisle();
        let mut occupied = taken(&walkways, Point::new(3.0, 4.0), 0.0, 30.0);
        for n in walkways.around(Point::new(3.0, 0.5), 1.0) {
            occupied.add(n, Window::new(at(5.0), at(30.0)), RobotId(8));
        }
        occupied.sort();
        let way =
            walkways.timed_path((from, to), &walkways.no_edges(), &occupied, (at(0.0), MPS), MANY).unwrap();
        let second = way.arrivals[1];
        assert!(second < at(5.0), "sets off before the robot is there: {way:?}");
        assert!(way.arrival() < at(25.0), "{way:?}");
    }

    #[test]
    fn a_path_that_meets_a_robot_head_on_has_no_time() {
        let (walkways, from, to) = aisle();
        let mut occupied = Occupied::default();
        for second in 0..8 {
            for n in walkways.around(Point::new(3.0, 7.0 - f64::from(second)), 0.8) {
                occupied.add(n, Window::new(at(f64::from(second)), at(f64::from(second) + 3.0)), RobotId(7));
            }
        }
        occupied.sort();
        let path = walkways.path(from, to, &walkways.no_edges()).unwrap().points;
        assert_eq!(walkways.time_along(&path, &occupied, (at(0.0), MPS)), None);
        assert!(walkways.time_along(&path, &Occupied::default(), (at(0.0), MPS)).is_some());
    }

    /// No point is reached, or waited at, while it is taken.
    fn assert_free(walkways: &Walkways, way: &TimedPath, occupied: &Occupied) {
        for i in 1..way.points.len() - 1 {
            let (n, _) = walkways.nearest(way.points[i]).unwrap();
            let step = (way.points[i + 1] - way.points[i]).norm();
            let departs = way.arrivals[i + 1] - Span::from_secs_f64(step / MPS);
            let there = Window::new(way.arrivals[i], departs.max(way.arrivals[i]) + Span(1));
            let hit = occupied.of(n, Time::ZERO).find(|(w, _)| {
                // Ends are accurate to a microsecond.
                w.overlaps(there) && w.start() + Span(2) < there.end() && there.start() + Span(2) < w.end()
            });
            assert!(hit.is_none(), "at {n:?} in {there:?}: {hit:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn ways_are_never_where_a_robot_is_and_never_later_than_walking_the_shortest_path_with_waits(
            ends in (any::<prop::sample::Index>(), any::<prop::sample::Index>()),
            robots in prop::collection::vec((any::<prop::sample::Index>(), 0u32..20, 1u32..12), 0..15),
        ) {
            let walkways = Walkways::of(&thesis());
            let place = |i: prop::sample::Index| {
                walkways.nodes()[WalkNodeId::at(i.index(walkways.nodes().len()))].at
            };
            let (from, to, none) = (place(ends.0), place(ends.1), walkways.no_edges());
            let mut occupied = Occupied::default();
            for (robot, (middle, start, length)) in (0..).zip(robots) {
                let window = Window::new(at(f64::from(start)), at(f64::from(start + length)));
                for n in walkways.around(place(middle), 0.8) {
                    occupied.add(n, window, RobotId(robot));
                }
            }
            occupied.sort();
            let way = walkways.timed_path((from, to), &none, &occupied, (at(0.0), MPS), MANY);
            let free = Occupied::default();
            let path = walkways.timed_path((from, to), &none, &free, (at(0.0), MPS), MANY).unwrap().points;
            if let Some(along) = walkways.time_along(&path, &occupied, (at(0.0), MPS)) {
                let way = way.as_ref().expect("walking the shortest path with waits is one");
                prop_assert!(way.arrival() <= along.arrival() + Span(10), "{way:?}, not {along:?}");
            }
            if let Some(way) = &way {
                assert_free(&walkways, way, &occupied);
            }
        }
    }
}

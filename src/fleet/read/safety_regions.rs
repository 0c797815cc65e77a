//! Which nodes are in the safety regions of which robots and people, and when: layers of the timelines (Petković 2021,
//! section 4.2.3).
//!
//! Main types: [`RegionStay`], [`SafetyRegion`]. A node is in region 2 of a person while a robot on it would be too
//! near, and in region 2 of a robot while a person on it would be; region 3 is what lies around region 2. For robots,
//! all windows of their reservations count; for people, the places where they may walk within the time shown. For
//! display only. Refuses: to restrict robots or people; conditions do that, from the same radii.

use crate::Fleet;
use crate::people::state::Person;
use crate::read::area::Area;
use crate::state::wait_graph::Party;
use giveway_floor::geometry::Point;
use giveway_floor::id::{BodyId, NodeId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_people::human::{Hypothesis, Whereabouts, passages};
use std::collections::BTreeMap;

/// Ways of a person that are less probable than this have no regions.
const NEGLIGIBLE: f64 = 0.05;
/// How long at least a person stays near the present place.
const NOW: Span = Span::from_millis(900);

/// A region around a robot or a person that others keep out of, or in which they are slow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SafetyRegion {
    /// Region 2: nothing is planned into it.
    KeepOut,
    /// Region 3: robots are slow.
    Slow,
}

/// A time during which a node is in a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RegionStay {
    /// The robot or worker whose region it is.
    pub of: Party,
    /// The region.
    pub region: SafetyRegion,
    /// When the node is in the region.
    pub window: Window,
}

/// Windows found so far, by node, robot or worker, and region.
type Stays = BTreeMap<(NodeId, Party, SafetyRegion), Vec<Window>>;

/// Nodes in the regions around one place.
type Around = Vec<(NodeId, SafetyRegion)>;

impl Fleet {
    /// The nodes of an area that are in regions within a time, each with its stays in order of time.
    pub(super) fn region_stays(
        &self,
        area: Area,
        window: Window,
        now: Time,
    ) -> BTreeMap<NodeId, Vec<RegionStay>> {
        let mut found = Stays::new();
        self.robots_regions(area, window, &mut found);
        for (worker, place) in self.people.among_robots(now) {
            self.workers_regions((worker, &place), now, window, &mut found);
        }
        let mut by_node: BTreeMap<NodeId, Vec<RegionStay>> = BTreeMap::new();
        for ((node, of, region), mut windows) in found {
            windows.sort_by_key(|w| (w.start(), w.end()));
            let mut joined: Vec<Window> = Vec::new();
            for w in windows {
                match joined.last_mut() {
                    Some(last) if w.start() <= last.end() => {
                        *last = Window::new(last.start(), last.end().max(w.end()));
                    }
                    _ => joined.push(w),
                }
            }
            let stays = joined.into_iter().map(|window| RegionStay { of, region, window });
            by_node.entry(node).or_default().extend(stays);
        }
        by_node
    }

    /// Regions around the reservations of all robots that are near an area.
    fn robots_regions(&self, area: Area, window: Window, found: &mut Stays) {
        let mut known: BTreeMap<(NodeId, BodyId, bool), Around> = BTreeMap::new();
        for robot in self.writer.ledger().present() {
            let (chain, reach) = (self.writer.ledger().chain(robot), self.radii(robot, true, 0.0).1);
            for visit in (chain.first()..chain.end()).filter_map(|s| chain.get(s)) {
                let at = self.writer.warehouse().nodes[visit.node].at;
                if !visit.window().overlaps(window) || area.distance_m(at) > reach {
                    continue;
                }
                let around = known
                    .entry((visit.node, self.floor().body(robot), visit.loaded))
                    .or_insert_with(|| self.around(at, self.radii(robot, visit.loaded, 0.0)));
                for (node, region) in around {
                    found.entry((*node, Party::Robot(robot), *region)).or_default().push(visit.window());
                }
            }
        }
    }

    /// Regions around the places that a worker takes, or may take.
    fn workers_regions(
        &self,
        (worker, place): (WorkerId, &Whereabouts),
        now: Time,
        window: Window,
        found: &mut Stays,
    ) {
        // The widest regions of all kinds, with a rack.
        let sizes = self.writer.regions.widest_m(place);
        let radii = (sizes[1] + place.reach_m, sizes[2] + place.reach_m);
        let mut add = |at: Point, when: Window| {
            if when.overlaps(window) {
                for (node, region) in self.around(at, radii) {
                    found.entry((node, Party::Worker(worker), region)).or_default().push(when);
                }
            }
        };
        add(place.at, Window::new(now, now + NOW));
        let ways = planned(&self.people.people[worker], place);
        for (i, way) in ways.iter().enumerate() {
            let ahead = window.end() - now;
            passages(i, way, place.mover.band(place.velocity.norm()), now, ahead, |p| add(p.at, p.window));
        }
    }

    /// Radii of regions 2 and 3 of a robot, metres.
    fn radii(&self, robot: RobotId, loaded: bool, sigma_m: f64) -> (f64, f64) {
        let regions = self.floor().regions(robot);
        (regions.keep_out_radius_m(loaded, sigma_m), regions.slow_radius_m(loaded, sigma_m))
    }

    /// The nodes around a place within these distances on foot.
    fn around(&self, at: Point, (keep_out, slow): (f64, f64)) -> Around {
        let near = self.people.afoot.nodes_within(self.writer.warehouse(), at, slow).into_iter();
        let region = |d: f64| if d <= keep_out { SafetyRegion::KeepOut } else { SafetyRegion::Slow };
        near.map(|(node, d)| (node, region(d))).collect()
    }
}

/// The ways that a worker may take: the given path or, once the worker has left it, the probable ways.
fn planned(person: &Person, place: &Whereabouts) -> Vec<Hypothesis> {
    let likely: Vec<Hypothesis> =
        person.ways.iter().filter(|w| w.probability >= NEGLIGIBLE).cloned().collect();
    if !likely.is_empty() {
        return likely;
    }
    let path = person.rest_of_path(place.at).into_iter();
    let stay = person.plan.as_ref().map(|p| p.stay);
    path.map(|path| Hypothesis { probability: 1.0, path, stay }).collect()
}

//! Zones, 3.0: closed areas of the floor as BLOCKED zones, so that a robot that plans for itself keeps out of them,
//! too; and a SPEED_LIMIT zone over the way of a robot that is to drive slowly.
//!
//! Main types: [`BlockedArea`], [`SlowWay`], [`ZoneLife`]; main function: `mind_zones`. A set of zones never changes:
//! another one is sent, put in force when the robot has stored it, and the old one deleted then. A robot is stuck in a
//! BLOCKED zone, so an area is none for a robot that is in it or was promised a way through it, until it is out. A
//! robot obeys a speed limit some messages later, so that the fleet does not count on it. Refuses: zones of types that
//! the robot does not say that it knows, and maps for which somebody else has put zones in force.

use super::session::{AskedAction, RobotSession};
use giveway_fleet::{ClosureState, Ledger};
use giveway_floor::geometry::{Point, Segment, Vector, axis_distance_of_segments, inside, outline_area_m2};
use giveway_floor::id::ClosureId;
use giveway_floor::time::{Span, Time};
use giveway_site::MapFrame;
use giveway_vda5050::{Message, Parameter, StoredZoneSet, TopicKind, Version, Zone, ZoneKind, ZoneSet};
use std::collections::BTreeSet;
use std::sync::Arc;

const ENABLE: &str = "enableZoneSet";
const DELETE: &str = "deleteZoneSet";
const BLOCKED: &str = "BLOCKED";
const SPEED_LIMIT: &str = "SPEED_LIMIT";
/// A SPEED_LIMIT zone reaches this far beyond the way, so that not every grant needs another one, metres.
const BEYOND_M: f64 = 3.0;
/// The most areas of a set.
const MOST: usize = 64;
/// What is to be added to a set waits until this long after the last change; what is to be taken out does not.
const SETTLES: Span = Span::from_secs(5);
/// What is in the robot's way is looked at this often.
const LOOKS: Span = Span::from_millis(500);
/// A set that a state does not list after this was lost, and is sent again; so is a request that failed.
const AGAIN: Span = Span::from_secs(2);
/// How often a set is sent, and asked to be put in force.
const TIMES: u32 = 5;

/// An area of the floor that is closed to robots now.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockedArea {
    /// The closure's number.
    pub closure: ClosureId,
    /// The corners, in the floor's frame; the sides do not cross.
    pub outline: Vec<Point>,
}

/// The areas that are closed to robots at a time, oldest first, as far as an outline says what is closed.
pub fn closed_areas(ledger: &Ledger, now: Time) -> Vec<BlockedArea> {
    let closed = ledger.closures.iter().filter(|(_, closure)| {
        closure.state(now) == ClosureState::Closed && closure.binds.robots() && closure.nodes.is_empty()
    });
    let areas = closed.map(|(closure, area)| {
        let mut outline: Vec<Point> = area.outline.iter().map(|spot| Point::from(*spot)).collect();
        outline.dedup();
        outline.pop_if(|last| area.outline.first().is_some_and(|first| Point::from(*first) == *last));
        BlockedArea { closure: *closure, outline }
    });
    areas.filter(|area| outline_area_m2(&area.outline).is_ok()).take(MOST).collect()
}

/// The box around the way ahead of a robot that is to drive slowly, in the floor's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SlowWay {
    least: Point,
    most: Point,
    /// The greatest speed, metres per second.
    mps: f64,
}

/// What a robot's zones are, or are to be.
#[derive(Clone, Debug, Default, PartialEq)]
struct ZonesOfRobot {
    areas: BTreeSet<ClosureId>,
    slow: Option<SlowWay>,
}

/// What a robot was told of zones.
#[derive(Clone, Debug, Default)]
pub(super) struct ZoneLife {
    /// The closed areas of the floor.
    closed: Arc<[BlockedArea]>,
    /// What the robot's zones are to be, and when that was looked at.
    wanted: ZonesOfRobot,
    looked: Option<Time>,
    sent: Option<SentSet>,
    /// An old set that the robot was asked to delete.
    deletes: Option<(String, AskedAction)>,
}

/// A set that was sent.
#[derive(Clone, Debug)]
struct SentSet {
    zones: ZonesOfRobot,
    message: ZoneSet,
    /// When it was sent first and last, and how often.
    since: Time,
    last: Time,
    times: u32,
    enable: Option<AskedAction>,
}

impl RobotSession {
    /// The areas of the floor that are closed to robots now.
    pub fn close(&mut self, areas: &Arc<[BlockedArea]>) {
        if !Arc::ptr_eq(&self.zones.closed, areas) {
            (self.zones.closed, self.zones.looked) = (areas.clone(), None);
        }
    }

    /// Lets the robot's zones be the areas that are closed.
    pub(super) fn mind_zones(&mut self, now: Time) {
        let Some(frame) = self.frame_with_zones(now) else { return };
        if self.zones.looked.is_none_or(|looked| now - looked >= LOOKS) {
            (self.zones.looked, self.zones.wanted) = (Some(now), self.zones_wanted());
        }
        let (has, since) = match &self.zones.sent {
            Some(sent) => (&sent.zones, Some(sent.since)),
            None => (&ZonesOfRobot::default(), None),
        };
        let wanted = &self.zones.wanted;
        let is_settled = since.is_none_or(|since| now - since >= SETTLES);
        let frees = has.areas.difference(&wanted.areas).next().is_some();
        let is_urgent = frees || has.lacks(wanted.slow) && self.is_last_in_force(&frame.name);
        // What an earlier process put in force ends as well.
        let begins = since.is_none()
            && (*wanted != ZonesOfRobot::default() || self.enabled_set(&frame.name).is_some());
        if begins || has != wanted && (is_urgent || is_settled) {
            self.send_zones(now, &frame);
        } else {
            self.follow_zones(now);
        }
    }

    /// The frame of the robot's map, if the robot takes zones there from us.
    fn frame_with_zones(&self, now: Time) -> Option<MapFrame> {
        let (_, state) = self.state.as_ref()?;
        let knows = self.knows_zones(BLOCKED) || self.knows_zones(SPEED_LIMIT);
        if self.version < Version::V3_0 || !knows || !self.has_proven() || self.unreachable(now).is_some() {
            return None;
        }
        let map = &state.position.as_ref()?.map;
        let frame = self.settings.maps.iter().find(|frame| frame.name == *map)?;
        let is_free = self.enabled_set(map).is_none_or(|set| is_ours(&set.id));
        is_free.then(|| frame.clone())
    }

    /// Whether the robot says that it knows zones of a type.
    fn knows_zones(&self, kind: &str) -> bool {
        self.factsheet.as_ref().is_some_and(|sheet| sheet.zones.iter().any(|zone| zone == kind))
    }

    /// Whether the last set that was sent is in force.
    fn is_last_in_force(&self, map: &str) -> bool {
        let sent = self.zones.sent.as_ref().map(|sent| &sent.message.id);
        self.enabled_set(map).is_some_and(|set| Some(&set.id) == sent)
    }

    /// The set that the robot has in force on a map.
    fn enabled_set(&self, map: &str) -> Option<&StoredZoneSet> {
        let (_, state) = self.state.as_ref()?;
        state.zone_sets.iter().find(|set| set.enabled && set.map == map)
    }

    /// What the robot's zones are to be now.
    fn zones_wanted(&self) -> ZonesOfRobot {
        let areas = if self.knows_zones(BLOCKED) { self.clear_areas() } else { BTreeSet::new() };
        ZonesOfRobot { areas, slow: self.slow_way() }
    }

    /// The speed to which the fleet limits a robot that is not to stand, metres per second.
    pub(super) fn slow_mps(&self) -> Option<f64> {
        self.limit_mps.filter(|mps| *mps > 0.0)
    }

    /// Where the robot is to drive slowly: on all of its way. The last box stays as long as the way is within.
    fn slow_way(&self) -> Option<SlowWay> {
        let mps = self.slow_mps().filter(|_| self.knows_zones(SPEED_LIMIT))?;
        let ways = self.promised_ways();
        let least = ways.iter().flatten().copied().reduce(|a, b| a.inf(&b))?;
        let most = ways.iter().flatten().copied().reduce(|a, b| a.sup(&b))?;
        let last = self.zones.sent.as_ref().and_then(|sent| sent.zones.slow);
        let last = last.filter(|last| last.has(least) && last.has(most));
        let margin = Vector::repeat(self.reach_m() + BEYOND_M);
        let (least, most) = last.map_or((least - margin, most + margin), |last| (last.least, last.most));
        Some(SlowWay { least, most, mps })
    }

    /// The closed areas in which the robot neither is nor was promised a way.
    fn clear_areas(&self) -> BTreeSet<ClosureId> {
        let reach_m = self.reach_m();
        let ways = self.promised_ways();
        let touches = |area: &&BlockedArea, way: &[Point]| {
            let sides = || {
                let n = area.outline.len();
                (0..n).map(move |i| Segment { a: area.outline[i], b: area.outline[(i + 1) % n] })
            };
            let parts = way.iter().zip(way.iter().skip(1).chain(way.last()));
            parts.map(|(a, b)| Segment { a: *a, b: *b }).any(|part| {
                inside(&area.outline, part.a)
                    || sides().any(|side| axis_distance_of_segments(side, part) <= reach_m)
            })
        };
        let is_clear = |area: &&BlockedArea| !ways.iter().any(|way| touches(area, way));
        self.zones.closed.iter().filter(is_clear).map(|area| area.closure).collect()
    }

    /// How far the robot reaches from its centre, metres.
    fn reach_m(&self) -> f64 {
        const MOST_M: f64 = 10.0;
        let side_m = self.map.footprint_m;
        let sheet = self.factsheet.as_ref();
        let length_m = sheet.and_then(|sheet| sheet.length_m).unwrap_or(side_m);
        let width_m = sheet.and_then(|sheet| sheet.width_m).unwrap_or(side_m);
        (length_m.hypot(width_m) / 2.0).min(MOST_M)
    }

    /// Where the robot is, and the ways that its order and the fleet's wish promise it.
    fn promised_ways(&self) -> [Vec<Point>; 2] {
        let here = self.motion.pose().map(|pose| pose.at);
        let reached = self.progress.as_ref().map_or(0, |progress| progress.reached);
        let at = |node| self.map.nodes[node].at;
        let wanted = self.wanted.iter().flat_map(|wanted| &wanted.waypoints);
        let wanted = wanted.filter(|waypoint| waypoint.serial >= reached).map(|waypoint| at(waypoint.node));
        let leg = self.leg();
        let ordered = leg.iter().flat_map(|leg| (leg.first..).zip(&leg.nodes));
        let ordered = ordered.filter(|(serial, _)| *serial >= reached).filter_map(|(_, node)| node.map(at));
        [here.into_iter().chain(wanted).collect(), here.into_iter().chain(ordered).collect()]
    }

    /// Sends a new set in place of the last one.
    fn send_zones(&mut self, now: Time, frame: &MapFrame) {
        let wanted = self.zones.wanted.clone();
        let chosen = self.zones.closed.iter().filter(|area| wanted.areas.contains(&area.closure));
        let blocked = chosen
            .map(|area| zone(format!("closure-{}", area.closure.0), ZoneKind::Blocked, &area.outline, frame));
        let slow = wanted
            .slow
            .map(|slow| zone("slow".to_owned(), ZoneKind::SpeedLimit(slow.mps), &slow.corners(), frame));
        let zones = blocked.chain(slow).collect();
        let message = ZoneSet { id: format!("{}{ENDING}", self.new_id()), map: frame.name.clone(), zones };
        self.tell(TopicKind::ZoneSet, Message::ZoneSet(message.clone()));
        self.zones.sent =
            Some(SentSet { zones: wanted, message, since: now, last: now, times: 1, enable: None });
    }

    /// Sends the last set again if it was lost, puts it in force, and deletes older ones.
    fn follow_zones(&mut self, now: Time) {
        let (Some((heard, state)), Some(mut sent)) = (&self.state, self.zones.sent.take()) else { return };
        let (heard, id) = (*heard, sent.message.id.as_str());
        let stored = state.zone_sets.iter().find(|set| set.id == id).map(|set| set.enabled);
        let is_old = |set: &&StoredZoneSet| is_ours(&set.id) && set.id != id && !set.enabled;
        let old = state.zone_sets.iter().find(is_old).map(|set| set.id.clone());
        match stored {
            None if sent.times < TIMES => {
                self.look_again(now);
                // Each time it may take longer until the robot has stored it.
                if heard >= sent.last + AGAIN * i64::from(sent.times) {
                    (sent.last, sent.times) = (now, sent.times + 1);
                    self.tell(TopicKind::ZoneSet, Message::ZoneSet(sent.message.clone()));
                }
            }
            None => {}
            Some(false) => sent.enable = self.put_in_force(now, &sent),
            Some(true) => self.delete_old(now, old),
        }
        self.zones.sent = Some(sent);
    }

    fn put_in_force(&mut self, now: Time, sent: &SentSet) -> Option<AskedAction> {
        let parameters = about(&sent.message.id);
        let asked = match sent.enable.clone() {
            None => self.ask_with(now, ENABLE, parameters),
            Some(asked) if asked.tries >= TIMES => asked,
            Some(asked) if self.has_failed(&asked) && now - asked.last >= AGAIN => {
                let tries = asked.tries + 1;
                AskedAction { tries, ..self.ask_with(now, ENABLE, parameters) }
            }
            Some(asked) => self.ask_again_with(now, asked, ENABLE, parameters),
        };
        Some(asked)
    }

    /// Deletes older sets of ours, one after another, when another one is in force.
    fn delete_old(&mut self, now: Time, old: Option<String>) {
        self.zones.deletes = match (old, self.zones.deletes.take()) {
            (None, _) => None,
            (Some(old), Some((id, asked))) if id == old => {
                // A robot that keeps what it was to delete may.
                let is_over = self.has_failed(&asked) || asked.tries >= TIMES;
                let asked = if is_over { asked } else { self.ask_again_with(now, asked, DELETE, about(&id)) };
                Some((id, asked))
            }
            (Some(old), _) => Some((old.clone(), self.ask_with(now, DELETE, about(&old)))),
        };
    }
}

/// What the ids of our sets end with.
const ENDING: &str = "-zones";

fn is_ours(set: &str) -> bool {
    set.starts_with("gw-") && set.ends_with(ENDING)
}

fn about(set: &str) -> Vec<Parameter> {
    vec![Parameter { key: "zoneSetId".to_owned(), value: set.into() }]
}

impl ZonesOfRobot {
    /// Whether the robot may be too fast on the way on which it is to drive slowly.
    fn lacks(&self, slow: Option<SlowWay>) -> bool {
        slow.is_some_and(|wanted| {
            let is_slow =
                |has: &SlowWay| has.mps <= wanted.mps && has.has(wanted.least) && has.has(wanted.most);
            !self.slow.as_ref().is_some_and(is_slow)
        })
    }
}

impl SlowWay {
    /// Whether the box has a place in it.
    fn has(&self, at: Point) -> bool {
        (self.least.x..=self.most.x).contains(&at.x) && (self.least.y..=self.most.y).contains(&at.y)
    }

    fn corners(&self) -> [Point; 4] {
        let (least, most) = (self.least, self.most);
        [least, Point::new(most.x, least.y), most, Point::new(least.x, most.y)]
    }
}

/// An area of the floor as a zone of the robot's map, anticlockwise.
fn zone(id: String, kind: ZoneKind, outline: &[Point], frame: &MapFrame) -> Zone {
    let n = outline.len();
    let doubled: f64 = (0..n).map(|i| outline[i].coords.perp(&outline[(i + 1) % n].coords)).sum();
    let mut corners: Vec<(f64, f64)> = outline.iter().map(|corner| frame.to_robot(*corner)).collect();
    if doubled < 0.0 {
        corners.reverse();
    }
    Zone { id, kind, corners }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_zone_is_anticlockwise_in_the_robots_map_whichever_way_round_the_area_was_drawn() {
        let frame = MapFrame { name: "hall".into(), moved: Vector::new(10.0, 0.0), turn: FRAC_PI_2 };
        let corners = [(10.0, 0.0), (12.0, 0.0), (12.0, 1.0)].map(|(x, y)| Point::new(x, y));
        let back = corners.iter().rev().copied().collect();
        for outline in [corners.to_vec(), back] {
            let zone = zone("closure-3".to_owned(), ZoneKind::Blocked, &outline, &frame);
            let at: Vec<(i64, i64)> =
                zone.corners.iter().map(|(x, y)| (x.round() as i64, y.round() as i64)).collect();
            assert_eq!((zone.id.as_str(), at), ("closure-3", vec![(0, 0), (0, -2), (1, -2)]));
        }
    }
}

//! The zone sets that a virtual robot of 3.0 has stored, and where its zones let it drive.
//!
//! Main type: [`ZoneStore`]; main functions: `take_zone_set`, `enable_zone_set`, `delete_zone_set`. Source: VDA 5050
//! 3.0, sections 6.4.1 and 6.4.2. Refuses: zones of other types than BLOCKED,
//! RELEASE and SPEED_LIMIT, a set with the id of another
//! one, and more than [`SETS_MOST`] sets.

use super::VirtualRobot;
use super::complaints::ErrorEnd;
use crate::model::error::ErrorLevel;
use crate::model::state::{RequestStatus, RequestSubject};
use crate::model::zone::{StoredZoneSet, Zone, ZoneKind, ZoneSet};

/// The most zone sets that are stored.
const SETS_MOST: usize = 8;
/// How far the robot reaches from its centre, metres.
const REACH_M: f64 = 0.4;

/// Zone sets and which of them are in force.
#[derive(Clone, Debug, Default)]
pub(super) struct ZoneStore {
    sets: Vec<(ZoneSet, bool)>,
}

impl ZoneStore {
    /// The store of a robot that was given these sets when it was set up: the first one of each map is in force.
    pub(super) fn new(sets: &[ZoneSet]) -> ZoneStore {
        let is_first = |i: usize| sets[..i].iter().all(|before| before.map != sets[i].map);
        ZoneStore { sets: (0..sets.len()).map(|i| (sets[i].clone(), is_first(i))).collect() }
    }

    pub(super) fn to_states(&self) -> Vec<StoredZoneSet> {
        let state = |(set, enabled): &(ZoneSet, bool)| StoredZoneSet {
            id: set.id.clone(),
            map: set.map.clone(),
            enabled: *enabled,
        };
        self.sets.iter().map(state).collect()
    }
}

impl VirtualRobot {
    /// Stores a zone set, which is not in force yet.
    pub(super) fn take_zone_set(&mut self, set: ZoneSet) {
        self.reporting.must_say = true;
        let is_known = self.zones.sets.iter().any(|(known, _)| known.id == set.id);
        let fault = match is_known {
            true => Some(("DUPLICATE_ZONE_SET", "a zone set with this id is stored already")),
            false if self.zones.sets.len() >= SETS_MOST => {
                Some(("INSUFFICIENT_MEMORY", "there is no room for another zone set"))
            }
            false => None,
        };
        match fault {
            Some((kind, words)) => {
                self.complain(kind, ErrorLevel::Warning, Vec::new(), words, ErrorEnd::OrderAccepted);
            }
            None => self.zones.sets.push((set, false)),
        }
    }

    /// Puts a stored set in force, in place of the one of its map that is; whether there is such a set.
    pub(super) fn enable_zone_set(&mut self, id: &str) -> bool {
        let Some(map) = self.zones.sets.iter().find(|(set, _)| set.id == id).map(|(set, _)| set.map.clone())
        else {
            return false;
        };
        for (set, enabled) in self.zones.sets.iter_mut().filter(|(set, _)| set.map == map) {
            *enabled = set.id == id;
        }
        true
    }

    /// Forgets a stored set that is not in force; whether there is such a set.
    pub(super) fn delete_zone_set(&mut self, id: &str) -> bool {
        let before = self.zones.sets.len();
        self.zones.sets.retain(|(set, enabled)| *enabled || set.id != id);
        self.zones.sets.len() < before
    }

    /// Notes whether the robot stands or drives where nobody may be.
    pub(super) fn note_blocked(&mut self) {
        let at = (self.body.x, self.body.y);
        if self.zones_at(at, at).any(|(_, zone)| zone.kind == ZoneKind::Blocked) {
            let words = "the robot is in a BLOCKED zone";
            self.complain(
                "BLOCKED_ZONE_VIOLATION",
                ErrorLevel::Critical,
                Vec::new(),
                words,
                ErrorEnd::ZoneLeft,
            );
        } else {
            self.forget_errors(&[ErrorEnd::ZoneLeft]);
        }
    }

    /// Whether the robot is where nobody may be.
    pub(super) fn is_blocked(&self) -> bool {
        self.errors.iter().any(|standing| standing.until == ErrorEnd::ZoneLeft)
    }

    /// Whether a zone keeps the robot from driving from one place to another.
    pub(super) fn is_barred(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        self.zones_at(from, to).any(|(set, zone)| match zone.kind {
            ZoneKind::Blocked => true,
            ZoneKind::Release => !self.has_release(&access(set, zone)),
            ZoneKind::SpeedLimit(_) => false,
        })
    }

    /// The speed that zones allow from one place to another, metres per second; infinite if none limits it.
    pub(super) fn speed_through(&self, from: (f64, f64), to: (f64, f64)) -> f64 {
        let limits = self.zones_at(from, to).filter_map(|(_, zone)| match zone.kind {
            ZoneKind::SpeedLimit(mps) => Some(mps),
            ZoneKind::Blocked | ZoneKind::Release => None,
        });
        limits.fold(f64::INFINITY, f64::min)
    }

    /// The RELEASE zones through which the released way leads, or in which the robot is.
    pub(super) fn zones_to_enter(&self) -> Vec<RequestSubject> {
        let released = self.order.nodes.iter().filter(|held| held.node.released);
        let (mut from, mut all) = ((self.body.x, self.body.y), Vec::new());
        for to in [from].into_iter().chain(released.filter_map(|held| self.place_of(&held.node))) {
            for (set, zone) in self.zones_at(from, to).filter(|(_, zone)| zone.kind == ZoneKind::Release) {
                let subject = access(set, zone);
                if !all.contains(&subject) {
                    all.push(subject);
                }
            }
            from = to;
        }
        all
    }

    fn has_release(&self, subject: &RequestSubject) -> bool {
        self.requests.is(subject, RequestStatus::Granted)
    }

    /// The zones in force into which the robot's outline reaches on a straight way.
    fn zones_at(&self, from: (f64, f64), to: (f64, f64)) -> impl Iterator<Item = (&ZoneSet, &Zone)> {
        let sets = self.zones.sets.iter().filter(|(set, enabled)| *enabled && set.map == self.map);
        let zones = sets.flat_map(|(set, _)| set.zones.iter().map(move |zone| (set, zone)));
        zones.filter(move |(_, zone)| reaches(&zone.corners, from, to))
    }
}

fn access(set: &ZoneSet, zone: &Zone) -> RequestSubject {
    RequestSubject::Zone { zone: zone.id.clone(), zone_set: set.id.clone(), replanning: false }
}

/// Whether a disc that moves along a straight way touches an area.
fn reaches(corners: &[(f64, f64)], from: (f64, f64), to: (f64, f64)) -> bool {
    let sides = || (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
    let crossed = sides().filter(|(a, b)| {
        (a.1 > from.1) != (b.1 > from.1) && from.0 < (b.0 - a.0) * (from.1 - a.1) / (b.1 - a.1) + a.0
    });
    crossed.count() % 2 == 1 || sides().any(|side| distance_m(side, (from, to)) <= REACH_M)
}

type StraightLine = ((f64, f64), (f64, f64));

/// The distance between two straight lines.
fn distance_m(s: StraightLine, t: StraightLine) -> f64 {
    let side =
        |o: (f64, f64), a: (f64, f64), b: (f64, f64)| (a.0 - o.0) * (b.1 - o.1) - (a.1 - o.1) * (b.0 - o.0);
    let parts = |s: StraightLine, t: StraightLine| side(s.0, s.1, t.0) * side(s.0, s.1, t.1) < 0.0;
    if parts(s, t) && parts(t, s) {
        return 0.0;
    }
    let to_line = |p: (f64, f64), (a, b): StraightLine| {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let length2 = dx * dx + dy * dy;
        let along = if length2 > 0.0 { ((p.0 - a.0) * dx + (p.1 - a.1) * dy) / length2 } else { 0.0 };
        let u = along.clamp(0.0, 1.0);
        (p.0 - a.0 - u * dx).hypot(p.1 - a.1 - u * dy)
    };
    [to_line(s.0, t), to_line(s.1, t), to_line(t.0, s), to_line(t.1, s)]
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

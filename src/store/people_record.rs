//! The written form of facts about people: parts of the journal's wire form.
//!
//! Main types: the records named by `record`. Refuses: to stand alone; versions are `record`'s business.

use giveway_fleet::{
    AssignmentRequest, AssignmentState, Binds, ClientKey, Closure, Encounter, LastPlace, LocalClock,
    Reaction, Recurrence, RecurringClosure, Weekdays,
};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{CustomerId, NodeId, RobotId, SeriesId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_people::human::{Mover, Vehicle};
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
pub(super) struct AssignmentRecord {
    pub place: u32,
    pub stay: i64,
    pub what: String,
    pub key: Option<String>,
    /// The owner of the key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub owner: Option<u64>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum AssignmentStateRecord {
    Waiting,
    Walking,
    Working,
    Done,
    Cancelled,
}

/// The last known place of a worker, millimetres.
#[derive(Serialize, Deserialize)]
pub(super) struct LastPlaceRecord {
    pub at: (i64, i64),
    pub seen: i64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<i64>,
}

impl From<LastPlace> for LastPlaceRecord {
    fn from(p: LastPlace) -> LastPlaceRecord {
        LastPlaceRecord { at: (p.at.x_mm, p.at.y_mm), seen: p.seen.0, within: p.within_mm }
    }
}

impl From<LastPlaceRecord> for LastPlace {
    fn from(r: LastPlaceRecord) -> LastPlace {
        let at = Spot { x_mm: r.at.0, y_mm: r.at.1 };
        LastPlace { at, seen: Time(r.seen), within_mm: r.within }
    }
}

/// A vehicle with a driver: millimetres and seconds.
#[derive(Serialize, Deserialize)]
pub(super) struct VehicleRecord {
    pub length: i64,
    pub width: i64,
    pub behind: i64,
    pub top: i64,
    pub accel: i64,
    pub brake: i64,
}

/// What a worker moves as; nothing on foot.
#[derive(Serialize, Deserialize)]
pub(super) struct MoverRecord {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<VehicleRecord>,
}

impl From<Vehicle> for VehicleRecord {
    fn from(v: Vehicle) -> VehicleRecord {
        let [length, width, behind, top, accel, brake] = v.whole_mm();
        VehicleRecord { length, width, behind, top, accel, brake }
    }
}

impl VehicleRecord {
    /// The vehicle; nothing if the figures are none that a vehicle has, which were never written.
    pub fn vehicle(&self) -> Option<Vehicle> {
        Vehicle::of_whole_mm([self.length, self.width, self.behind, self.top, self.accel, self.brake])
    }
}

impl From<Mover> for MoverRecord {
    fn from(mover: Mover) -> MoverRecord {
        let vehicle = if let Mover::Vehicle(v) = mover { Some(v.into()) } else { None };
        MoverRecord { vehicle }
    }
}

impl From<MoverRecord> for Mover {
    fn from(r: MoverRecord) -> Mover {
        r.vehicle.and_then(|v| v.vehicle()).map_or(Mover::OnFoot, Mover::Vehicle)
    }
}

/// Where, when and why robots or people keep out; corners in millimetres.
#[derive(Serialize, Deserialize)]
pub(super) struct ClosureRecord {
    pub outline: Vec<(i64, i64)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<u32>,
    pub from: i64,
    pub until: i64,
    pub reason: String,
    #[serde(default, skip_serializing_if = "BindsRecord::is_robots")]
    pub binds: BindsRecord,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<u64>,
}

/// Whether a closure keeps out robots, people or both. Closures from before people could be kept out bind robots alone,
/// and still do.
#[derive(Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum BindsRecord {
    #[default]
    Robots,
    People,
    Both,
}

impl BindsRecord {
    fn is_robots(&self) -> bool {
        *self == BindsRecord::Robots
    }
}

impl From<Binds> for BindsRecord {
    fn from(binds: Binds) -> BindsRecord {
        match binds {
            Binds::Robots => BindsRecord::Robots,
            Binds::People => BindsRecord::People,
            Binds::Both => BindsRecord::Both,
        }
    }
}

impl From<BindsRecord> for Binds {
    fn from(r: BindsRecord) -> Binds {
        match r {
            BindsRecord::Robots => Binds::Robots,
            BindsRecord::People => Binds::People,
            BindsRecord::Both => Binds::Both,
        }
    }
}

/// A recurring closure; the window of the area is that of the first occurrence.
#[derive(Serialize, Deserialize)]
pub(super) struct RecurringRecord {
    pub area: ClosureRecord,
    pub every: i64,
    pub weekdays: u8,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub utc_offset: i64,
    /// The time zone, and when its clocks change to which offset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zone: Option<(String, Vec<(i64, i64)>)>,
    pub until: i64,
    pub next: Option<i64>,
}

fn is_zero(n: &i64) -> bool {
    *n == 0
}

impl From<&RecurringClosure> for RecurringRecord {
    fn from(c: &RecurringClosure) -> RecurringRecord {
        RecurringRecord {
            area: (&c.area).into(),
            every: c.recurrence.every.0,
            weekdays: c.recurrence.weekdays.0,
            utc_offset: c.recurrence.clock.offset.0,
            zone: c.recurrence.clock.zone.clone().map(|zone| {
                (zone, c.recurrence.clock.changes.iter().map(|(from, offset)| (from.0, offset.0)).collect())
            }),
            until: c.recurrence.until.0,
            next: c.next.map(|t| t.0),
        }
    }
}

impl From<RecurringRecord> for RecurringClosure {
    fn from(r: RecurringRecord) -> RecurringClosure {
        let (zone, changes) = r.zone.map_or((None, Vec::new()), |(zone, changes)| (Some(zone), changes));
        let changes = changes.into_iter().map(|(from, offset)| (Time(from), Span(offset))).collect();
        let recurrence = Recurrence {
            every: Span(r.every),
            weekdays: Weekdays(r.weekdays),
            clock: LocalClock { zone, offset: Span(r.utc_offset), changes },
            until: Time(r.until),
        };
        RecurringClosure { area: r.area.into(), recurrence, next: r.next.map(Time) }
    }
}

/// An encounter: lengths in millimetres, speeds in millimetres per second.
#[derive(Serialize, Deserialize)]
pub(super) struct EncounterRecord {
    pub worker: u32,
    pub robot: u32,
    pub began: i64,
    pub ended: i64,
    pub at: (i64, i64),
    pub radius: i64,
    pub closest: i64,
    pub robot_speed: i64,
    pub worker_speed: i64,
    pub reaction: ReactionRecord,
    pub delay: i64,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ReactionRecord {
    Kept,
    Slowed,
    Held,
    Rerouted,
    Stopped,
}

impl From<&AssignmentRequest> for AssignmentRecord {
    fn from(r: &AssignmentRequest) -> AssignmentRecord {
        let (what, key) = (r.what.clone(), r.key.as_ref().map(|key| key.text.clone()));
        AssignmentRecord {
            place: r.place.0,
            stay: r.stay.0,
            what,
            key,
            owner: r.key.as_ref().and_then(|key| key.owner).map(|owner| owner.0),
        }
    }
}

impl From<AssignmentRecord> for AssignmentRequest {
    fn from(r: AssignmentRecord) -> AssignmentRequest {
        let key = r.key.map(|text| ClientKey { owner: r.owner.map(CustomerId), text });
        AssignmentRequest { place: NodeId(r.place), stay: Span(r.stay), what: r.what, key }
    }
}

impl From<&Closure> for ClosureRecord {
    fn from(area: &Closure) -> ClosureRecord {
        ClosureRecord {
            outline: area.outline.iter().map(|p| (p.x_mm, p.y_mm)).collect(),
            nodes: area.nodes.iter().map(|n| n.0).collect(),
            from: area.window.start().0,
            until: area.window.end().0,
            reason: area.reason.clone(),
            binds: area.binds.into(),
            series: area.series.map(|s| s.0),
        }
    }
}

impl From<ClosureRecord> for Closure {
    fn from(r: ClosureRecord) -> Closure {
        Closure {
            outline: r.outline.into_iter().map(|(x_mm, y_mm)| Spot { x_mm, y_mm }).collect(),
            nodes: r.nodes.into_iter().map(NodeId).collect(),
            window: Window::new(Time(r.from), Time(r.until)),
            reason: r.reason,
            binds: r.binds.into(),
            series: r.series.map(SeriesId),
        }
    }
}

impl From<AssignmentState> for AssignmentStateRecord {
    fn from(s: AssignmentState) -> AssignmentStateRecord {
        match s {
            AssignmentState::Waiting => AssignmentStateRecord::Waiting,
            AssignmentState::Walking => AssignmentStateRecord::Walking,
            AssignmentState::Working => AssignmentStateRecord::Working,
            AssignmentState::Done => AssignmentStateRecord::Done,
            AssignmentState::Cancelled => AssignmentStateRecord::Cancelled,
        }
    }
}

impl From<AssignmentStateRecord> for AssignmentState {
    fn from(s: AssignmentStateRecord) -> AssignmentState {
        match s {
            AssignmentStateRecord::Waiting => AssignmentState::Waiting,
            AssignmentStateRecord::Walking => AssignmentState::Walking,
            AssignmentStateRecord::Working => AssignmentState::Working,
            AssignmentStateRecord::Done => AssignmentState::Done,
            AssignmentStateRecord::Cancelled => AssignmentState::Cancelled,
        }
    }
}

impl From<Reaction> for ReactionRecord {
    fn from(r: Reaction) -> ReactionRecord {
        match r {
            Reaction::Kept => ReactionRecord::Kept,
            Reaction::Slowed => ReactionRecord::Slowed,
            Reaction::Held => ReactionRecord::Held,
            Reaction::Rerouted => ReactionRecord::Rerouted,
            Reaction::Stopped => ReactionRecord::Stopped,
        }
    }
}

impl From<ReactionRecord> for Reaction {
    fn from(r: ReactionRecord) -> Reaction {
        match r {
            ReactionRecord::Kept => Reaction::Kept,
            ReactionRecord::Slowed => Reaction::Slowed,
            ReactionRecord::Held => Reaction::Held,
            ReactionRecord::Rerouted => Reaction::Rerouted,
            ReactionRecord::Stopped => Reaction::Stopped,
        }
    }
}

impl From<&Encounter> for EncounterRecord {
    fn from(e: &Encounter) -> EncounterRecord {
        EncounterRecord {
            worker: e.worker.0,
            robot: e.robot.0,
            began: e.began.0,
            ended: e.ended.0,
            at: (e.at.x_mm, e.at.y_mm),
            radius: e.radius_mm,
            closest: e.closest_mm,
            robot_speed: e.robot_mmps,
            worker_speed: e.worker_mmps,
            reaction: e.reaction.into(),
            delay: e.delay.0,
        }
    }
}

impl From<EncounterRecord> for Encounter {
    fn from(e: EncounterRecord) -> Encounter {
        Encounter {
            worker: WorkerId(e.worker),
            robot: RobotId(e.robot),
            began: Time(e.began),
            ended: Time(e.ended),
            at: Spot { x_mm: e.at.0, y_mm: e.at.1 },
            radius_mm: e.radius,
            closest_mm: e.closest,
            robot_mmps: e.robot_speed,
            worker_mmps: e.worker_speed,
            reaction: e.reaction.into(),
            delay: Span(e.delay),
        }
    }
}

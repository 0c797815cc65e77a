//! The written form of routes: part of the wire form of journal and snapshots.
//!
//! Main types: the records named by `record` and `ledger_record`. Visits are arrays, since they are most of the bytes,
//! and their times are relative to the first one, which saves half of the digits. Refuses: to stand alone; versions are
//! `record`'s business.

use super::act_record::ActRecord;
use giveway_fleet::{Booking, KeptRoute, Moved, Stop};
use giveway_floor::id::{NodeId, ResourceId, RobotId};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::{Shift, Visit};
use serde::{Deserialize, Serialize};

/// Time of enter; from there to arrive; from arrive to depart and to leave, nothing where that is for ever.
#[derive(Serialize, Deserialize)]
struct TimesRecord(i64, i64, Option<i64>, Option<i64>);

/// A visit: node, lane, stay, times, whether for a robot with a rack, as all were before robots were told apart.
#[derive(Serialize, Deserialize)]
pub(super) struct VisitRecord(
    u32,
    Option<u32>,
    i64,
    TimesRecord,
    #[serde(default = "with_rack", skip_serializing_if = "Clone::clone")] bool,
);

fn with_rack() -> bool {
    true
}

/// A visit with changed times: serial, times.
#[derive(Serialize, Deserialize)]
struct ShiftRecord(u64, TimesRecord);

/// The moved visits of a robot: robot, visits that moved.
#[derive(Serialize, Deserialize)]
pub(super) struct MovedRecord(u32, Vec<ShiftRecord>);

/// The kept visits of a robot: robot, one past the last visit that stays, visits that moved.
#[derive(Serialize, Deserialize)]
pub(super) struct KeptRecord(u32, u64, Vec<ShiftRecord>);

/// A stop: serial of the visit, act.
#[derive(Serialize, Deserialize)]
pub(super) struct StopRecord(u64, ActRecord);

/// A booking: robot, kept serial, kept visit, visits after it, stops.
#[derive(Serialize, Deserialize)]
pub(super) struct BookingRecord(u32, u64, VisitRecord, Vec<VisitRecord>, Vec<StopRecord>);

impl TimesRecord {
    fn of(enter: Time, arrive: Time, depart: Time, leave: Time) -> TimesRecord {
        let after = |t: Time| (!t.is_forever()).then(|| (t - arrive).0);
        TimesRecord(enter.0, (arrive - enter).0, after(depart), after(leave))
    }

    /// The times of enter, arrive, depart and leave.
    fn times(&self) -> [Time; 4] {
        let enter = Time(self.0);
        let arrive = enter + Span(self.1);
        let after = |span: Option<i64>| span.map_or(Time::MAX, |s| arrive + Span(s));
        [enter, arrive, after(self.2), after(self.3)]
    }
}

impl From<&Visit> for VisitRecord {
    fn from(v: &Visit) -> VisitRecord {
        let times = TimesRecord::of(v.enter, v.arrive, v.depart, v.leave);
        VisitRecord(v.node.0, v.lane.map(|l| l.0), v.stay.0, times, v.loaded)
    }
}

impl From<VisitRecord> for Visit {
    fn from(VisitRecord(node, lane, stay, times, loaded): VisitRecord) -> Visit {
        let [enter, arrive, depart, leave] = times.times();
        let lane = lane.map(ResourceId);
        Visit { node: NodeId(node), lane, loaded, enter, arrive, depart, leave, stay: Span(stay) }
    }
}

impl From<&Shift> for ShiftRecord {
    fn from(s: &Shift) -> ShiftRecord {
        ShiftRecord(s.serial, TimesRecord::of(s.enter, s.arrive, s.depart, s.leave))
    }
}

impl From<ShiftRecord> for Shift {
    fn from(ShiftRecord(serial, times): ShiftRecord) -> Shift {
        let [enter, arrive, depart, leave] = times.times();
        Shift { serial, enter, arrive, depart, leave }
    }
}

impl From<&Moved> for MovedRecord {
    fn from(m: &Moved) -> MovedRecord {
        MovedRecord(m.robot.0, m.shifts.iter().map(ShiftRecord::from).collect())
    }
}

impl From<MovedRecord> for Moved {
    fn from(MovedRecord(robot, shifts): MovedRecord) -> Moved {
        Moved { robot: RobotId(robot), shifts: shifts.into_iter().map(Shift::from).collect() }
    }
}

impl From<&KeptRoute> for KeptRecord {
    fn from(k: &KeptRoute) -> KeptRecord {
        KeptRecord(k.robot.0, k.end, k.shifts.iter().map(ShiftRecord::from).collect())
    }
}

impl From<KeptRecord> for KeptRoute {
    fn from(KeptRecord(robot, end, shifts): KeptRecord) -> KeptRoute {
        KeptRoute { robot: RobotId(robot), end, shifts: shifts.into_iter().map(Shift::from).collect() }
    }
}

impl From<&Stop> for StopRecord {
    fn from(s: &Stop) -> StopRecord {
        StopRecord(s.serial, s.act.into())
    }
}

impl From<StopRecord> for Stop {
    fn from(StopRecord(serial, act): StopRecord) -> Stop {
        Stop { serial, act: act.into() }
    }
}

impl From<&Booking> for BookingRecord {
    fn from(b: &Booking) -> BookingRecord {
        let visits = b.visits.iter().map(VisitRecord::from).collect();
        let stops = b.stops.iter().map(StopRecord::from).collect();
        BookingRecord(b.robot.0, b.keep, (&b.kept).into(), visits, stops)
    }
}

impl From<BookingRecord> for Booking {
    fn from(BookingRecord(robot, keep, kept, visits, stops): BookingRecord) -> Booking {
        Booking {
            robot: RobotId(robot),
            keep,
            kept: kept.into(),
            visits: visits.into_iter().map(Visit::from).collect(),
            stops: stops.into_iter().map(Stop::from).collect(),
        }
    }
}

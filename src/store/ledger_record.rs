//! The written form of the ledger in a snapshot: a versioned wire form of its own.
//!
//! Main functions: [`encode`], [`decode`]; [`VERSION`]. Everything is spelled out, so that a change of the ledger in
//! the program does not silently change the form on disk. Refuses: data of a newer program, and data that contradicts
//! itself.

use super::body_record::RobotKindRecord;
use super::job_record::{
    ChoiceRecord, RequestRecord, StateRecord, StationRecord, TaskRecord, visit_record, visiting,
};
use super::line_record::LinesRecord;
use super::people_record::{
    AssignmentRecord, AssignmentStateRecord, ClosureRecord, LastPlaceRecord, RecurringRecord, VehicleRecord,
};
use super::record::{is_usual_kind, is_usual_link, usual_kind, usual_link};
use super::route_record::{StopRecord, VisitRecord};
use giveway_fleet::{
    Assignment, ClientKey, Closure, Contradiction, Job, Keys, Ledger, Parts, Promises, RackAt, Robot,
    RobotChoice, RobotKind, Service, Stop, Sums, Unconfirmed, Wishes,
};
use giveway_floor::id::{
    AssignmentId, ClosureId, CustomerId, JobId, NodeId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::time::Time;
use giveway_floor::timeline::{ChainParts, Visit};
use giveway_floor::warehouse::Warehouse;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The version that this program writes; it reads all earlier ones. It goes up as [`super::record::VERSION`] does, and
/// for the same reasons; 2 has the added kinds of robots.
pub const VERSION: i64 = 2;

/// Why a snapshot cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SnapshotError {
    /// The snapshot was written by a newer program.
    #[error(
        "it is in wire version {0}, this Giveway reads up to {VERSION}: use the newer Giveway that wrote it"
    )]
    Newer(i64),
    /// The snapshot is damaged.
    #[error("it is damaged ({0}): restore the database from a backup")]
    Damaged(#[from] serde_json::Error),
    /// The snapshot contradicts itself or the map.
    #[error("it contradicts itself or the map ({0}): restore the database from a backup")]
    Contradiction(#[from] Contradiction),
}

/// Keys of open jobs and of ended ones, the latter with the time of acceptance.
#[derive(Serialize, Deserialize)]
struct KeysRecord {
    open: Vec<(String, u64)>,
    over: Vec<(u64, i64, String)>,
    /// Owners of the keys, by the job or assignment; keys with an unknown owner are left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    owners: Vec<(u64, u64)>,
}

#[derive(Serialize, Deserialize)]
struct JobRecord {
    request: RequestRecord,
    state: StateRecord,
    accepted: i64,
    /// Stations that were served, and when.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    served: Vec<(StationRecord, i64)>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    choice: Option<ChoiceRecord>,
    /// Progress of the lines of each station.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lines: Vec<LinesRecord>,
}

#[derive(Serialize, Deserialize)]
struct RobotRecord {
    name: String,
    #[serde(default = "usual_kind", skip_serializing_if = "is_usual_kind")]
    kind: String,
    #[serde(default = "usual_link", skip_serializing_if = "is_usual_link")]
    link: String,
    task: TaskRecord,
    stops: Vec<StopRecord>,
    acted: Option<u64>,
    failed: bool,
    interrupted: bool,
    paused: Option<i64>,
    fenced: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    maintenance: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    leaving: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gone: Option<i64>,
    recalls: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum RackPlaceRecord {
    Stored(u32),
    On(u32),
}

/// Robot, first serial, granted, visits, whether it has left the floor.
#[derive(Serialize, Deserialize)]
struct ChainRecord(
    u32,
    u64,
    u64,
    Vec<VisitRecord>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")] bool,
);

#[derive(Serialize, Deserialize)]
struct PromiseRecord {
    worker: Option<u32>,
    request: AssignmentRecord,
    state: AssignmentStateRecord,
    accepted: i64,
}

#[derive(Serialize, Deserialize)]
struct SumsRecord {
    robot_deliveries: u64,
    human_deliveries: u64,
    done: u64,
    cancelled: u64,
    failed: u64,
    encounters: u64,
    deviations: u64,
    interruptions: u64,
}

#[derive(Serialize, Deserialize)]
struct LedgerRecord {
    jobs: Vec<(u64, JobRecord)>,
    next_job: u64,
    keys: KeysRecord,
    robots: Vec<RobotRecord>,
    racks: Vec<RackPlaceRecord>,
    chains: Vec<ChainRecord>,
    served: Vec<u64>,
    workers: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    on_floor: Vec<(u32, LastPlaceRecord)>,
    /// Workers who drive a vehicle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    vehicles: Vec<(u32, VehicleRecord)>,
    assignments: Vec<(u64, PromiseRecord)>,
    next_assignment: u64,
    assignment_keys: KeysRecord,
    closures: Vec<(u64, ClosureRecord)>,
    next_closure: u64,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    recurring: Vec<(u64, RecurringRecord)>,
    #[serde(default = "first")]
    next_series: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    evacuation: Option<i64>,
    paused_stations: Vec<(u32, i64)>,
    /// Station, job, its lines there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    unconfirmed: Vec<(u32, u64, LinesRecord)>,
    stopped: Option<i64>,
    ended_badly: Vec<(u64, i64)>,
    sums: SumsRecord,
    wishes: Vec<u32>,
    /// Kinds of robots that were added to the site's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    kinds: Vec<RobotKindRecord>,
}

/// Default number: snapshots from before closures recurred have no number for the first occurrence.
fn first() -> u64 {
    1
}

/// A ledger as text.
pub fn encode(parts: &Parts) -> String {
    serde_json::to_string(&LedgerRecord::from(parts))
        .expect("records have no maps with keys that are not text")
}

/// A ledger from text, in a building made for the kinds of its site.
///
/// # Errors
/// If it was written by a newer program, is damaged, or contradicts itself or the map.
pub fn decode(
    version: i64,
    text: &str,
    warehouse: &Arc<Warehouse>,
    site_kinds: &[RobotKind],
) -> Result<Ledger, SnapshotError> {
    if version > VERSION {
        return Err(SnapshotError::Newer(version));
    }
    let parts = serde_json::from_str::<LedgerRecord>(text)?.into();
    Ok(Ledger::from_parts(warehouse.clone(), site_kinds, parts)?)
}

impl From<&Parts> for LedgerRecord {
    fn from(p: &Parts) -> LedgerRecord {
        LedgerRecord {
            jobs: p.jobs.iter().map(|(id, job)| (id.0, job.into())).collect(),
            next_job: p.next_job,
            keys: keys_record(&p.keys, |id| id.0),
            robots: p.robots.iter().map(RobotRecord::from).collect(),
            racks: p.racks.iter().map(|at| (*at).into()).collect(),
            chains: p.chains.iter().map(ChainRecord::from).collect(),
            served: p.served.iter().copied().collect(),
            workers: p.workers.iter().cloned().collect(),
            on_floor: p.on_floor.iter().map(|(w, place)| (w.0, (*place).into())).collect(),
            vehicles: p.vehicles.iter().map(|(w, vehicle)| (w.0, (*vehicle).into())).collect(),
            assignments: p.assignments.iter().map(|(id, a)| (id.0, a.into())).collect(),
            next_assignment: p.next_assignment,
            assignment_keys: keys_record(&p.assignment_keys, |id| id.0),
            closures: p.closures.iter().map(|(id, area)| (id.0, area.into())).collect(),
            next_closure: p.next_closure,
            recurring: p.recurring.iter().map(|(id, c)| (id.0, c.into())).collect(),
            next_series: p.next_series,
            evacuation: p.evacuation.map(|t| t.0),
            paused_stations: p.paused_stations.iter().map(|(s, at)| (s.0, at.0)).collect(),
            unconfirmed: p.unconfirmed.iter().map(unconfirmed_record).collect(),
            stopped: p.stopped.map(|t| t.0),
            ended_badly: p.ended_badly.iter().map(|(id, at)| (id.0, at.0)).collect(),
            sums: p.counts.into(),
            wishes: p.wishes.counts().iter().copied().collect(),
            kinds: p.added_kinds.iter().map(RobotKindRecord::from).collect(),
        }
    }
}

fn unconfirmed_record((station, left): (&StationId, &Unconfirmed)) -> (u32, u64, LinesRecord) {
    (station.0, left.job.0, LinesRecord(left.lines.clone()))
}

fn unconfirmed((station, job, LinesRecord(lines)): (u32, u64, LinesRecord)) -> (StationId, Unconfirmed) {
    (StationId(station), Unconfirmed { job: JobId(job), lines })
}

impl From<LedgerRecord> for Parts {
    fn from(r: LedgerRecord) -> Parts {
        let closure = |(id, area): (u64, ClosureRecord)| (ClosureId(id), Closure::from(area));
        let promises = Promises {
            jobs: r.jobs.into_iter().map(|(id, job)| (JobId(id), job.into())).collect(),
            next_job: r.next_job,
            keys: keys(r.keys, JobId),
            robots: r.robots.into_iter().map(Robot::from).collect(),
            racks: r.racks.into_iter().map(RackAt::from).collect(),
            served: r.served.into(),
            workers: r.workers.into(),
            on_floor: r.on_floor.into_iter().map(|(w, place)| (WorkerId(w), place.into())).collect(),
            vehicles: r.vehicles.into_iter().filter_map(|(w, v)| Some((WorkerId(w), v.vehicle()?))).collect(),
            assignments: r.assignments.into_iter().map(|(id, a)| (AssignmentId(id), a.into())).collect(),
            next_assignment: r.next_assignment,
            assignment_keys: keys(r.assignment_keys, AssignmentId),
            closures: r.closures.into_iter().map(closure).collect(),
            next_closure: r.next_closure,
            recurring: r.recurring.into_iter().map(|(id, c)| (SeriesId(id), c.into())).collect(),
            next_series: r.next_series,
            evacuation: r.evacuation.map(Time),
            paused_stations: r.paused_stations.into_iter().map(|(s, at)| (StationId(s), Time(at))).collect(),
            unconfirmed: r.unconfirmed.into_iter().map(unconfirmed).collect(),
            stopped: r.stopped.map(Time),
            ended_badly: r.ended_badly.into_iter().map(|(id, at)| (JobId(id), Time(at))).collect(),
            counts: r.sums.into(),
            wishes: Wishes::of(r.wishes),
        };
        let added_kinds = r.kinds.into_iter().map(RobotKind::from).collect();
        Parts { promises, added_kinds, chains: r.chains.into_iter().map(ChainParts::from).collect() }
    }
}

fn keys_record<I: Copy + Ord>(keys: &Keys<I>, number: impl Fn(I) -> u64) -> KeysRecord {
    let all = keys.open().chain(keys.over().map(|(id, _, key)| (key, id)));
    KeysRecord {
        open: keys.open().map(|(key, id)| (key.text.clone(), number(id))).collect(),
        over: keys.over().map(|(id, accepted, key)| (number(id), accepted.0, key.text.clone())).collect(),
        owners: all.filter_map(|(key, id)| Some((number(id), key.owner?.0))).collect(),
    }
}

fn keys<I: Copy + Ord>(r: KeysRecord, id: impl Fn(u64) -> I) -> Keys<I> {
    let owners: BTreeMap<u64, u64> = r.owners.into_iter().collect();
    let owner = |n: u64| owners.get(&n).copied().map(CustomerId);
    let open = r.open.into_iter().map(|(text, n)| (ClientKey { owner: owner(n), text }, id(n)));
    let over = r.over.into_iter();
    Keys::of(open, over.map(|(n, at, text)| (id(n), Time(at), ClientKey { owner: owner(n), text })))
}

impl From<&Job> for JobRecord {
    fn from(j: &Job) -> JobRecord {
        JobRecord {
            request: (&j.request).into(),
            state: j.state.into(),
            accepted: j.accepted.0,
            served: j.served.iter().map(|(v, at)| (visit_record(v), at.0)).collect(),
            choice: (j.choice != RobotChoice::Any).then(|| j.choice.into()),
            lines: j.lines.iter().cloned().map(LinesRecord).collect(),
        }
    }
}

impl From<JobRecord> for Job {
    fn from(r: JobRecord) -> Job {
        Job {
            request: r.request.into(),
            state: r.state.into(),
            accepted: Time(r.accepted),
            served: r.served.into_iter().map(|(v, at)| (visiting(v), Time(at))).collect(),
            choice: r.choice.map_or(RobotChoice::Any, RobotChoice::from),
            lines: r.lines.into_iter().map(|LinesRecord(lines)| lines).collect(),
        }
    }
}

impl From<&Robot> for RobotRecord {
    fn from(r: &Robot) -> RobotRecord {
        let [maintenance, leaving, gone] = match r.service {
            Service::Works => [None; 3],
            Service::Maintenance { since } => [Some(since.0), None, None],
            Service::Leaving { since } => [None, Some(since.0), None],
            Service::Gone { since } => [None, None, Some(since.0)],
        };
        RobotRecord {
            name: r.name.clone(),
            kind: r.kind.clone(),
            link: r.link.clone(),
            task: r.task.into(),
            stops: r.stops.iter().map(StopRecord::from).collect(),
            acted: r.acted,
            failed: r.failed,
            interrupted: r.interrupted,
            paused: r.paused.map(|t| t.0),
            fenced: r.fenced.map(|t| t.0),
            maintenance,
            leaving,
            gone,
            recalls: r.recalls,
        }
    }
}

impl From<RobotRecord> for Robot {
    fn from(r: RobotRecord) -> Robot {
        let at = |t: i64| Time(t);
        let service = match (r.maintenance.map(at), r.leaving.map(at), r.gone.map(at)) {
            (_, _, Some(since)) => Service::Gone { since },
            (_, Some(since), None) => Service::Leaving { since },
            (Some(since), None, None) => Service::Maintenance { since },
            (None, None, None) => Service::Works,
        };
        Robot {
            name: r.name,
            kind: r.kind,
            link: r.link,
            task: r.task.into(),
            stops: r.stops.into_iter().map(Stop::from).collect(),
            acted: r.acted,
            failed: r.failed,
            interrupted: r.interrupted,
            paused: r.paused.map(Time),
            fenced: r.fenced.map(Time),
            service,
            recalls: r.recalls,
        }
    }
}

impl From<RackAt> for RackPlaceRecord {
    fn from(at: RackAt) -> RackPlaceRecord {
        match at {
            RackAt::Stored(node) => RackPlaceRecord::Stored(node.0),
            RackAt::On(robot) => RackPlaceRecord::On(robot.0),
        }
    }
}

impl From<RackPlaceRecord> for RackAt {
    fn from(r: RackPlaceRecord) -> RackAt {
        match r {
            RackPlaceRecord::Stored(node) => RackAt::Stored(NodeId(node)),
            RackPlaceRecord::On(robot) => RackAt::On(RobotId(robot)),
        }
    }
}

impl From<&ChainParts> for ChainRecord {
    fn from(c: &ChainParts) -> ChainRecord {
        let visits = c.visits.iter().map(VisitRecord::from).collect();
        ChainRecord(c.holder.0, c.first, c.granted, visits, c.absent)
    }
}

impl From<ChainRecord> for ChainParts {
    fn from(ChainRecord(robot, first, granted, visits, absent): ChainRecord) -> ChainParts {
        let visits = visits.into_iter().map(Visit::from).collect();
        ChainParts { holder: RobotId(robot), first, granted, visits, absent }
    }
}

impl From<&Assignment> for PromiseRecord {
    fn from(a: &Assignment) -> PromiseRecord {
        let (request, state) = ((&a.request).into(), a.state.into());
        PromiseRecord { worker: a.worker.map(|w| w.0), request, state, accepted: a.accepted.0 }
    }
}

impl From<PromiseRecord> for Assignment {
    fn from(r: PromiseRecord) -> Assignment {
        let (request, state) = (r.request.into(), r.state.into());
        Assignment { worker: r.worker.map(WorkerId), request, state, accepted: Time(r.accepted) }
    }
}

impl From<Sums> for SumsRecord {
    fn from(s: Sums) -> SumsRecord {
        SumsRecord {
            robot_deliveries: s.robot_deliveries,
            human_deliveries: s.human_deliveries,
            done: s.done,
            cancelled: s.cancelled,
            failed: s.failed,
            encounters: s.encounters,
            deviations: s.deviations,
            interruptions: s.interruptions,
        }
    }
}

impl From<SumsRecord> for Sums {
    fn from(r: SumsRecord) -> Sums {
        Sums {
            robot_deliveries: r.robot_deliveries,
            human_deliveries: r.human_deliveries,
            done: r.done,
            cancelled: r.cancelled,
            failed: r.failed,
            encounters: r.encounters,
            deviations: r.deviations,
            interruptions: r.interruptions,
        }
    }
}

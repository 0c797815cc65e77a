//! The report of a stretch of time: what was delivered, how long orders took, what robots and stations were at, what
//! they waited for, alarms, people.
//!
//! Main types: [`ShiftReportDto`], [`ShiftSources`]. Refuses: figures by person.

use crate::access::acts::AuditAct;
use crate::wire::text::{round3, time_text};
use giveway_fleet::alarm::Alarm;
use giveway_fleet::history::{Bucket, RobotTimes, WaitCause};
use giveway_fleet::{Activity, Encounter, EndedJob, ShiftRows};
use giveway_floor::id::StationId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// The word for jobs that bring a rack to a station.
const DELIVER: &str = "deliver";

/// What happened from one time to another.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ShiftReportDto {
    /// From when, RFC 3339.
    pub from: String,
    /// Until when.
    pub to: String,
    /// How many seconds of that the server was running; rates and shares are of these.
    pub covered_s: f64,
    /// Racks brought to stations.
    pub deliveries: DeliveriesDto,
    /// Jobs that ended, by kind.
    pub jobs: Vec<EndedJobsDto>,
    /// Stations, in the order of the map.
    pub stations: Vec<StationShiftDto>,
    /// What robots were at.
    pub robots: RobotsShiftDto,
    /// What waiting robots waited for in the end, the longest first.
    pub waiting: Vec<WaitingCauseDto>,
    /// Chargers.
    pub chargers: ChargersShiftDto,
    /// Alarms that were active, by kind, the longest first.
    pub alarms: Vec<AlarmsShiftDto>,
    /// What people and other systems did, the most frequent first.
    pub acts: Vec<ActsShiftDto>,
    /// People, all together.
    pub people: PeopleShiftDto,
    /// Robots that came into region 1 of a worker.
    pub encounters: EncountersShiftDto,
}

/// Racks brought to stations.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct DeliveriesDto {
    /// How many were done.
    pub done: u64,
    /// How many an hour.
    pub per_hour: f64,
    /// How many of those had a deadline.
    pub with_deadline: u64,
    /// How many were done after it.
    pub late: u64,
    /// Jobs of any kind whose deadline passed and that were not over at the end.
    pub overdue: u64,
    /// From submission until the rack stood at the station.
    pub order_to_station_s: Option<QuantilesDto>,
    /// From submission until the job was done.
    pub order_to_done_s: Option<QuantilesDto>,
}

/// How long something took, seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct QuantilesDto {
    /// Half took at most this long.
    pub p50: f64,
    /// 95 % took at most this long.
    pub p95: f64,
}

/// Jobs of one kind that ended.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EndedJobsDto {
    /// Their kind.
    pub kind: String,
    /// How many were done.
    pub done: u64,
    /// How many failed.
    pub failed: u64,
    /// How many were cancelled.
    pub cancelled: u64,
}

/// One station.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct StationShiftDto {
    /// Its name.
    pub station: String,
    /// Racks brought to it.
    pub deliveries: u64,
    /// How many an hour.
    pub per_hour: f64,
    /// How many of them were done after their deadline.
    pub late: u64,
    /// From submission until the rack stood there.
    pub order_to_station_s: Option<QuantilesDto>,
    /// From then until the job was done.
    pub pick_s: Option<QuantilesDto>,
    /// Share of the time in which somebody picked there, from 0 to 1.
    pub picking_share: f64,
}

/// What robots were at.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct RobotsShiftDto {
    /// How many there were on the floor, on average.
    pub mean: f64,
    /// Share of their time by activity, from 0 to 1; together 1 if there were any.
    pub shares: BTreeMap<String, f64>,
}

/// Something that robots waited for.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct WaitingCauseDto {
    /// What: traffic, person, closure, station, `robot_out` (one that cannot drive), `by_hand` (one that is paused or
    /// stopped), obstacle, `no_route`.
    pub cause: String,
    /// Seconds, all robots together.
    pub robot_s: f64,
    /// Share of the time of all robots, from 0 to 1.
    pub share: f64,
}

/// Chargers.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ChargersShiftDto {
    /// How many the map has.
    pub count: u64,
    /// Share of their time in which a robot stood at them, from 0 to 1; 0 if there are none.
    pub share: f64,
}

/// Alarms of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmsShiftDto {
    /// The kind.
    pub kind: String,
    /// How many were active at any time of this.
    pub count: u64,
    /// For how many seconds of this, all together.
    pub lasted_s: f64,
}

/// An act.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ActsShiftDto {
    /// Which.
    pub act: AuditAct,
    /// How often it was done.
    pub count: u64,
}

/// People, all together.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct PeopleShiftDto {
    /// Hours that workers spent on the floor.
    pub worker_h: f64,
    /// Assignments that they completed.
    pub assignments_done: u64,
    /// How often somebody left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
}

/// Robots that came into region 1 of a worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EncountersShiftDto {
    /// How many times.
    pub count: u64,
    /// How many times in an hour of a worker on the floor; nothing if nobody was.
    pub per_worker_hour: Option<f64>,
    /// The smallest distance of the encounters, metres: of the closest, and of the middle one.
    pub closest_m: Option<ClosestDto>,
    /// How many for each reaction of the robot.
    pub reactions: BTreeMap<String, u64>,
}

/// How near robots came.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct ClosestDto {
    /// Of all.
    pub min: f64,
    /// Half of them came no nearer.
    pub p50: f64,
}

/// What a report is made of.
#[derive(Debug)]
pub struct ShiftSources<'a> {
    /// The building.
    pub map: &'a Warehouse,
    /// From when to when.
    pub between: (Time, Time),
    /// Figures over time.
    pub buckets: &'a [Bucket],
    /// What the lists say.
    pub rows: &'a ShiftRows,
    /// Alarms that were active.
    pub alarms: &'a [Alarm],
    /// What was asked and done, as the audit has it, and how often.
    pub acts: &'a [(String, u64)],
}

impl ShiftSources<'_> {
    /// The report.
    pub fn report(&self) -> ShiftReportDto {
        let mut sum = Bucket::default();
        self.buckets.iter().for_each(|bucket| sum.add(bucket));
        let ended = &self.rows.ended;
        let delivered: Vec<&EndedJob> =
            ended.iter().filter(|j| j.kind == DELIVER && j.state == "done").collect();
        let covered = sum.covered;
        let all: Span = total(&sum.robots.activities);
        ShiftReportDto {
            from: time_text(self.between.0),
            to: time_text(self.between.1),
            covered_s: round3(covered.as_secs_f64()),
            deliveries: DeliveriesDto {
                done: delivered.len() as u64,
                per_hour: per_hour(delivered.len(), covered),
                with_deadline: delivered.iter().filter(|j| j.deadline.is_some()).count() as u64,
                late: delivered.iter().filter(|j| is_late(j)).count() as u64,
                overdue: self.rows.overdue,
                order_to_station_s: quantiles(delivered.iter().filter_map(|j| to_station(j))),
                order_to_done_s: quantiles(delivered.iter().map(|j| j.ended - j.accepted)),
            },
            jobs: by_kind(ended),
            stations: self.map.stations.ids().map(|s| self.station(s, &delivered, covered)).collect(),
            robots: robots(&sum.robots, all, covered),
            waiting: waiting(&sum.robots, all),
            chargers: self.chargers(&sum.robots, covered),
            alarms: self.alarms(),
            acts: self.acts(),
            people: PeopleShiftDto {
                worker_h: round3(sum.worker_time.as_secs_f64() / 3600.0),
                assignments_done: self.rows.assignments_done,
                deviations: sum.deviations,
                interruptions: sum.interruptions,
            },
            encounters: encounters(&self.rows.encounters, sum.worker_time),
        }
    }

    fn station(&self, station: StationId, delivered: &[&EndedJob], covered: Span) -> StationShiftDto {
        let here: Vec<&&EndedJob> = delivered.iter().filter(|j| j.station == Some(station)).collect();
        let picked = self.rows.picking.get(&station).copied().unwrap_or_default();
        StationShiftDto {
            station: self.map.stations[station].name.clone(),
            deliveries: here.len() as u64,
            per_hour: per_hour(here.len(), covered),
            late: here.iter().filter(|j| is_late(j)).count() as u64,
            order_to_station_s: quantiles(here.iter().filter_map(|j| to_station(j))),
            pick_s: quantiles(here.iter().filter_map(|j| Some(j.ended - j.arrived?))),
            picking_share: share(picked, covered),
        }
    }

    fn chargers(&self, times: &RobotTimes, covered: Span) -> ChargersShiftDto {
        let count = self.map.nodes.iter().filter(|n| n.kind == NodeKind::Charger).count();
        let charging = times.activities[Activity::Charging as usize];
        ChargersShiftDto { count: count as u64, share: share(charging, covered * count as i64) }
    }

    /// What another version calls otherwise is left out.
    fn acts(&self) -> Vec<ActsShiftDto> {
        let mut counts: BTreeMap<AuditAct, u64> = BTreeMap::new();
        for (what, count) in self.acts {
            if let Some(act) = AuditAct::of(what) {
                *counts.entry(act).or_default() += count;
            }
        }
        let mut out: Vec<_> = counts.into_iter().map(|(act, count)| ActsShiftDto { act, count }).collect();
        out.sort_by_key(|row| std::cmp::Reverse(row.count));
        out
    }

    fn alarms(&self) -> Vec<AlarmsShiftDto> {
        let (from, to) = self.between;
        let mut kinds: BTreeMap<&str, (u64, Span)> = BTreeMap::new();
        // A group counts once, its members do not.
        for alarm in self.alarms.iter().filter(|alarm| alarm.group.is_none()) {
            let lasted = alarm.cleared.unwrap_or(to).min(to) - alarm.since.max(from);
            let (count, sum) = kinds.entry(alarm.kind.word()).or_default();
            *count += 1;
            *sum += lasted.max(Span::ZERO);
        }
        let row = |(kind, (count, lasted)): (&str, (u64, Span))| AlarmsShiftDto {
            kind: kind.into(),
            count,
            lasted_s: round3(lasted.as_secs_f64()),
        };
        let mut out: Vec<_> = kinds.into_iter().map(row).collect();
        out.sort_by(|a, b| b.lasted_s.total_cmp(&a.lasted_s));
        out
    }
}

fn by_kind(ended: &[EndedJob]) -> Vec<EndedJobsDto> {
    let mut kinds: BTreeMap<&str, EndedJobsDto> = BTreeMap::new();
    for job in ended {
        let kind = job.kind.as_str();
        let fresh = || EndedJobsDto { kind: kind.into(), done: 0, failed: 0, cancelled: 0 };
        let row = kinds.entry(kind).or_insert_with(fresh);
        match job.state.as_str() {
            "done" => row.done += 1,
            "cancelled" => row.cancelled += 1,
            _ => row.failed += 1,
        }
    }
    kinds.into_values().collect()
}

fn robots(times: &RobotTimes, all: Span, covered: Span) -> RobotsShiftDto {
    let gone = times.activities[Activity::Gone as usize];
    let present = all - gone;
    let shown = Activity::ALL.into_iter().zip(times.activities).filter(|(a, _)| *a != Activity::Gone);
    RobotsShiftDto {
        mean: if covered > Span::ZERO { round3(present.as_secs_f64() / covered.as_secs_f64()) } else { 0.0 },
        shares: shown.map(|(activity, span)| (activity.word().to_owned(), share(span, present))).collect(),
    }
}

fn waiting(times: &RobotTimes, all: Span) -> Vec<WaitingCauseDto> {
    let present = all - times.activities[Activity::Gone as usize];
    let causes = WaitCause::ALL.into_iter().zip(times.waiting).filter(|(_, span)| *span > Span::ZERO);
    let row = |(cause, span): (WaitCause, Span)| WaitingCauseDto {
        cause: cause.word().into(),
        robot_s: round3(span.as_secs_f64()),
        share: share(span, present),
    };
    let mut out: Vec<_> = causes.map(row).collect();
    out.sort_by(|a, b| b.robot_s.total_cmp(&a.robot_s));
    out
}

fn encounters(met: &[Encounter], worker_time: Span) -> EncountersShiftDto {
    let mut closest: Vec<i64> = met.iter().map(|e| e.closest_mm).collect();
    closest.sort_unstable();
    let metres = |mm: i64| round3(mm as f64 / 1000.0);
    let mut reactions: BTreeMap<String, u64> = BTreeMap::new();
    for e in met {
        *reactions.entry(e.reaction.word().into()).or_default() += 1;
    }
    let hours = worker_time.as_secs_f64() / 3600.0;
    EncountersShiftDto {
        count: met.len() as u64,
        per_worker_hour: (worker_time > Span::ZERO).then(|| round3(met.len() as f64 / hours)),
        closest_m: closest
            .first()
            .map(|min| ClosestDto { min: metres(*min), p50: metres(at_share(&closest, 50)) }),
        reactions,
    }
}

fn is_late(job: &EndedJob) -> bool {
    job.deadline.is_some_and(|deadline| job.ended > deadline)
}

fn to_station(job: &EndedJob) -> Option<Span> {
    Some(job.arrived? - job.accepted)
}

fn total(spans: &[Span]) -> Span {
    Span(spans.iter().map(|s| s.0).sum())
}

fn share(part: Span, whole: Span) -> f64 {
    if whole > Span::ZERO { round3(part.as_secs_f64() / whole.as_secs_f64()) } else { 0.0 }
}

fn per_hour(n: usize, covered: Span) -> f64 {
    if covered > Span::ZERO { round3(n as f64 * 3600.0 / covered.as_secs_f64()) } else { 0.0 }
}

fn quantiles(spans: impl Iterator<Item = Span>) -> Option<QuantilesDto> {
    let mut all: Vec<i64> = spans.map(|s| s.0).collect();
    all.sort_unstable();
    let seconds = |percent| round3(Span(at_share(&all, percent)).as_secs_f64());
    (!all.is_empty()).then(|| QuantilesDto { p50: seconds(50), p95: seconds(95) })
}

/// So many percent of these, which are in order and not none, are at most that.
fn at_share(sorted: &[i64], percent: usize) -> i64 {
    sorted[(sorted.len() * percent).div_ceil(100).max(1) - 1]
}

#[cfg(test)]
mod tests;

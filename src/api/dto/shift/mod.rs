//! The report of a period: deliveries, how long orders took, what robots and stations did, what robots waited for,
//! alarms, people.
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

/// The name of the job kind that brings a rack to a station.
const DELIVER: &str = "deliver";

/// What happened in a period.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ShiftReportDto {
    /// Start of the period, RFC 3339.
    pub from: String,
    /// End of the period, RFC 3339.
    pub to: String,
    /// How many seconds of the period the server was running; rates and shares refer to these.
    pub covered_s: f64,
    /// Racks brought to stations.
    pub deliveries: DeliveriesDto,
    /// Jobs that ended, by kind.
    pub jobs: Vec<EndedJobsDto>,
    /// Stations, in the order of the map.
    pub stations: Vec<StationShiftDto>,
    /// What robots did.
    pub robots: RobotsShiftDto,
    /// Root causes of robots' waiting, the longest first.
    pub waiting: Vec<WaitingCauseDto>,
    /// Use of the chargers.
    pub chargers: ChargersShiftDto,
    /// Alarms that were active, by kind, the longest first.
    pub alarms: Vec<AlarmsShiftDto>,
    /// Acts of people and of other systems, the most frequent first.
    pub acts: Vec<ActsShiftDto>,
    /// People, all together.
    pub people: PeopleShiftDto,
    /// Robots that came into region 1 of a worker.
    pub encounters: EncountersShiftDto,
}

/// Racks brought to stations.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct DeliveriesDto {
    /// How many deliveries were done.
    pub done: u64,
    /// Deliveries done per hour.
    pub per_hour: f64,
    /// How many of the deliveries done had a deadline.
    pub with_deadline: u64,
    /// How many were done after their deadline.
    pub late: u64,
    /// Jobs of any kind that were past their deadline and not over at the end of the period.
    pub overdue: u64,
    /// Seconds from submission until the rack stood at the station; null if nothing was delivered.
    pub order_to_station_s: Option<QuantilesDto>,
    /// Seconds from submission until the job was done; null if nothing was delivered.
    pub order_to_done_s: Option<QuantilesDto>,
}

/// Quantiles of a duration, seconds.
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
    /// The kind of job.
    pub kind: String,
    /// How many were done.
    pub done: u64,
    /// How many failed.
    pub failed: u64,
    /// How many were cancelled.
    pub cancelled: u64,
}

/// Deliveries to one station.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct StationShiftDto {
    /// The station's name.
    pub station: String,
    /// Racks brought to the station.
    pub deliveries: u64,
    /// Racks brought to the station per hour.
    pub per_hour: f64,
    /// How many of these deliveries were done after their deadline.
    pub late: u64,
    /// Seconds from submission until the rack stood at the station; null if nothing was delivered.
    pub order_to_station_s: Option<QuantilesDto>,
    /// Seconds from the arrival of the rack until the job was done; null if nothing was delivered.
    pub pick_s: Option<QuantilesDto>,
    /// Share of the covered time in which a rack was picked from, 0 to 1.
    pub picking_share: f64,
}

/// What robots did.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct RobotsShiftDto {
    /// The mean number of robots on the floor.
    pub mean: f64,
    /// Share of the robots' time by activity, 0 to 1; the shares add up to 1 if there were any robots.
    pub shares: BTreeMap<String, f64>,
}

/// A root cause of robots' waiting.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct WaitingCauseDto {
    /// The cause: traffic, person, closure, station, `robot_out` (a robot that cannot drive), `by_hand` (a robot that
    /// is paused or stopped), obstacle, `no_route`.
    pub cause: String,
    /// Seconds of waiting, summed over all robots.
    pub robot_s: f64,
    /// Share of the time of all robots, 0 to 1.
    pub share: f64,
}

/// Use of the chargers.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ChargersShiftDto {
    /// How many chargers the map has.
    pub count: u64,
    /// Share of the chargers' time in which a robot charged there, 0 to 1; 0 if there are no chargers.
    pub share: f64,
}

/// Alarms of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AlarmsShiftDto {
    /// The kind of alarm.
    pub kind: String,
    /// How many alarms were active at any time of the period.
    pub count: u64,
    /// Seconds of the period in which they were active, summed over all alarms.
    pub lasted_s: f64,
}

/// How often an act was done.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct ActsShiftDto {
    /// The act.
    pub act: AuditAct,
    /// How many times it was done.
    pub count: u64,
}

/// Figures on all people together.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct PeopleShiftDto {
    /// Hours that workers spent on the floor.
    pub worker_h: f64,
    /// Assignments that workers completed.
    pub assignments_done: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
}

/// Robots that came into region 1 of a worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EncountersShiftDto {
    /// How many encounters there were.
    pub count: u64,
    /// Encounters per hour that a worker spent on the floor; null if no worker was there.
    pub per_worker_hour: Option<f64>,
    /// Smallest distances of the encounters, metres; null if there were none.
    pub closest_m: Option<ClosestDto>,
    /// How many encounters had each reaction of the robot.
    pub reactions: BTreeMap<String, u64>,
}

/// How close robots came to workers, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct ClosestDto {
    /// The smallest distance of all encounters.
    pub min: f64,
    /// The median of the encounters' smallest distances.
    pub p50: f64,
}

/// The data from which a report is made.
#[derive(Debug)]
pub struct ShiftSources<'a> {
    /// The building.
    pub map: &'a Warehouse,
    /// Start and end of the period.
    pub between: (Time, Time),
    /// Figures over time, in buckets.
    pub buckets: &'a [Bucket],
    /// Rows of the lists of jobs, assignments and encounters.
    pub rows: &'a ShiftRows,
    /// Alarms that were active in the period.
    pub alarms: &'a [Alarm],
    /// Acts with their counts, by the names that the audit uses.
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

    /// The acts with their counts; acts that this version does not know are left out.
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
        // A group counts once; its members do not count.
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

/// The value that `percent` of the values do not exceed; `sorted` is in ascending order and not empty.
fn at_share(sorted: &[i64], percent: usize) -> i64 {
    sorted[(sorted.len() * percent).div_ceil(100).max(1) - 1]
}

#[cfg(test)]
mod tests;

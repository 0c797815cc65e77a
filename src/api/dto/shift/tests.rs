//! Reports from made-up rows.

use super::*;
use giveway_fleet::alarm::{AlarmKind, AlarmSeverity, AlarmSubject, SubjectKind};
use giveway_floor::text::Sentence;

const HOUR: Span = Span::from_secs(3600);
const FROM: Time = Time(20_000 * 86_400 * 1_000_000);

fn at(s: i64) -> Time {
    FROM + Span::from_secs(s)
}

fn job(station: u32, state: &str, times: [i64; 3], deadline: Option<i64>) -> EndedJob {
    EndedJob {
        kind: DELIVER.into(),
        state: state.into(),
        station: Some(StationId(station)),
        accepted: at(times[0]),
        deadline: deadline.map(at),
        arrived: Some(at(times[1])),
        ended: at(times[2]),
    }
}

fn lab() -> Warehouse {
    giveway_floor::warehouse::formats::json::parse(include_str!("../../../../maps/lab.json")).unwrap()
}

fn report(rows: &ShiftRows, bucket: Bucket, alarms: &[Alarm]) -> ShiftReportDto {
    let map = lab();
    let acts =
        [("POST /v1/closures", 2), ("POST /v1/assignments", 1), ("POST /v1/workers/{id}/assignments", 4)];
    let acts = acts.map(|(what, count)| (what.to_owned(), count)).to_vec();
    let between = (FROM, FROM + HOUR);
    ShiftSources { map: &map, between, buckets: &[bucket], rows, alarms, acts: &acts }.report()
}

#[test]
fn deliveries_are_counted_by_station_and_orders_timed_from_their_submission() {
    let rows = ShiftRows {
        // Accepted before the shift, late, on time, and one that was cancelled.
        ended: vec![
            job(0, "done", [-600, 100, 110], None),
            job(0, "done", [0, 300, 320], Some(310)),
            job(0, "done", [200, 400, 440], Some(500)),
            job(0, "cancelled", [0, 10, 20], Some(5)),
        ],
        overdue: 2,
        picking: [(StationId(0), Span::from_secs(900))].into(),
        ..ShiftRows::default()
    };
    let report = report(&rows, Bucket { covered: HOUR, ..Bucket::default() }, &[]);
    let d = &report.deliveries;
    assert_eq!((d.done, d.per_hour, d.with_deadline, d.late, d.overdue), (3, 3.0, 2, 1, 2));
    assert_eq!(d.order_to_station_s, Some(QuantilesDto { p50: 300.0, p95: 700.0 }));
    assert_eq!(d.order_to_done_s, Some(QuantilesDto { p50: 320.0, p95: 710.0 }));
    let station = &report.stations[0];
    assert_eq!((station.deliveries, station.late, station.picking_share), (3, 1, 0.25));
    assert_eq!(station.pick_s, Some(QuantilesDto { p50: 20.0, p95: 40.0 }));
    assert_eq!(report.jobs, vec![EndedJobsDto { kind: DELIVER.into(), done: 3, failed: 0, cancelled: 1 }]);
}

#[test]
fn rates_are_of_the_time_in_which_the_server_ran() {
    let rows = ShiftRows { ended: vec![job(0, "done", [0, 100, 110], None)], ..ShiftRows::default() };
    let covered = Span::from_secs(900);
    assert_eq!(report(&rows, Bucket { covered, ..Bucket::default() }, &[]).deliveries.per_hour, 4.0);
    let nothing = report(&rows, Bucket::default(), &[]);
    assert_eq!((nothing.deliveries.per_hour, nothing.robots.mean), (0.0, 0.0));
}

#[test]
fn shares_of_robots_are_of_those_on_the_floor_and_chargers_of_those_on_the_map() {
    let mut robots = RobotTimes::default();
    robots.activities[Activity::Driving as usize] = HOUR;
    robots.activities[Activity::Charging as usize] = Span::from_secs(1800);
    robots.activities[Activity::Waiting as usize] = Span::from_secs(1800);
    robots.activities[Activity::Gone as usize] = HOUR * 5;
    robots.waiting[WaitCause::Person as usize] = Span::from_secs(1200);
    robots.waiting[WaitCause::Traffic as usize] = Span::from_secs(600);
    let bucket = Bucket { covered: HOUR, worker_time: HOUR * 2, deviations: 3, robots, ..Bucket::default() };
    let report = report(&ShiftRows::default(), bucket, &[]);
    assert_eq!(report.robots.mean, 2.0);
    assert_eq!(report.robots.shares["driving"], 0.5);
    assert!(!report.robots.shares.contains_key("gone"));
    assert_eq!((report.robots.shares.values().sum::<f64>() * 1000.0).round(), 1000.0);
    let causes: Vec<_> = report.waiting.iter().map(|w| (w.cause.as_str(), w.robot_s, w.share)).collect();
    assert_eq!(causes, [("person", 1200.0, 0.167), ("traffic", 600.0, 0.083)]);
    let count = lab().nodes.iter().filter(|n| n.kind == NodeKind::Charger).count();
    assert!(count > 0);
    assert_eq!(report.chargers.share, round3(0.5 / count as f64));
    assert_eq!((report.people.worker_h, report.people.deviations), (2.0, 3));
}

#[test]
fn alarms_last_as_long_as_they_did_within_the_time() {
    let alarm = |kind, since: i64, cleared: Option<i64>| Alarm {
        id: 1,
        kind,
        severity: AlarmSeverity::Warning,
        subject: AlarmSubject::new(SubjectKind::Robot, "robot-1"),
        text: Sentence::default(),
        remedy: Sentence::default(),
        at: None,
        waiting: 0,
        since: at(since),
        acknowledged: None,
        shelved: None,
        notes: Vec::new(),
        group: None,
        members: Vec::new(),
        cleared: cleared.map(at),
    };
    let alarms = [
        alarm(AlarmKind::Paused, -100, Some(50)),
        alarm(AlarmKind::Paused, 100, Some(150)),
        alarm(AlarmKind::Stopped, 3000, None),
    ];
    let report = report(&ShiftRows::default(), Bucket::default(), &alarms);
    let rows: Vec<_> = report.alarms.iter().map(|a| (a.kind.as_str(), a.count, a.lasted_s)).collect();
    assert_eq!(rows, [("stopped", 1, 600.0), ("paused", 2, 100.0)]);
}

#[test]
fn acts_are_counted_by_what_they_are_and_not_by_how_they_were_asked_for() {
    let report = report(&ShiftRows::default(), Bucket::default(), &[]);
    let acts: Vec<_> = report.acts.iter().map(|a| (a.act.word(), a.count)).collect();
    assert_eq!(acts, [("assign_task", 5), ("close_area", 2)]);
}

//! Zones, requests and answers of 3.0.

use super::*;
use crate::model::answer::{Grant, Response};
use crate::model::error::ErrorLevel;
use crate::model::order::Corridor;
use crate::model::state::{Request, RequestStatus};
use crate::model::zone::{StoredZoneSet, Zone, ZoneKind, ZoneSet};

impl RobotBench {
    fn requests(&self) -> Vec<Request> {
        self.robot.robot.state().requests
    }

    fn answers(&mut self, grant: Grant, until_us: Option<i64>) {
        let request = self.requests().first().expect("it asks").id.clone();
        self.hear(&[Message::Responses(vec![Response { request, grant, until_us }])]);
    }

    fn sets(&self) -> Vec<(String, bool)> {
        let sets = self.robot.robot.state().zone_sets.into_iter();
        sets.map(|StoredZoneSet { id, enabled, .. }| (id, enabled)).collect()
    }

    fn error(&self, kind: &str) -> Option<ErrorLevel> {
        self.robot.robot.state().errors.iter().find(|error| error.kind == kind).map(|error| error.level)
    }
}

/// An order along the line, all of it released.
fn along(at_x: &[f64]) -> Order {
    let names: Vec<String> = (0..at_x.len()).map(|i| format!("n{i}")).collect();
    let nodes: Vec<(&str, f64)> = names.iter().map(String::as_str).zip(at_x.iter().copied()).collect();
    order("o", 0, 0, &nodes, nodes.len())
}

/// A set with one zone that lies across the line, from one place along it to another.
fn across(id: &str, kind: ZoneKind, from_x: f64, to_x: f64) -> ZoneSet {
    let corners = vec![(from_x, -1.0), (to_x, -1.0), (to_x, 1.0), (from_x, 1.0)];
    ZoneSet { id: id.into(), map: "lab".into(), zones: vec![Zone { id: "z".into(), kind, corners }] }
}

#[test]
fn a_zone_set_is_in_force_once_it_is_enabled_and_stops_the_robot_before_it() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.hear(&[Message::ZoneSet(across("s1", ZoneKind::Blocked, 4.5, 5.5))]);
    assert_eq!(bench.sets(), [("s1".to_owned(), false)]);
    bench.instant_with("enableZoneSet", "e", &[("zoneSetId", "s1".into())]);
    assert_eq!(bench.sets(), [("s1".to_owned(), true)]);
    bench.order(&along(&[0.0, 2.0, 4.0, 6.0]));
    bench.run(30.0);
    assert!((bench.x() - 4.0).abs() < 0.01 && bench.stands(), "{}", bench.x());
    bench.hear(&[Message::ZoneSet(ZoneSet {
        zones: Vec::new(),
        ..across("s2", ZoneKind::Blocked, 0.0, 1.0)
    })]);
    bench.instant_with("enableZoneSet", "e2", &[("zoneSetId", "s2".into())]);
    bench.run(10.0);
    assert!((bench.x() - 6.0).abs() < 0.01);
    bench.instant_with("deleteZoneSet", "d", &[("zoneSetId", "s1".into())]);
    bench.instant_with("deleteZoneSet", "d2", &[("zoneSetId", "s2".into())]);
    assert_eq!(bench.sets(), [("s2".to_owned(), true)], "the one in force stays");
}

#[test]
fn a_second_set_with_one_id_is_refused_and_so_are_more_than_there_is_room_for() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    for (id, far) in [("s1", 5.0), ("s1", 7.0)] {
        bench.hear(&[Message::ZoneSet(across(id, ZoneKind::Blocked, far, far + 1.0))]);
    }
    assert_eq!((bench.sets().len(), bench.error("DUPLICATE_ZONE_SET")), (1, Some(ErrorLevel::Warning)));
    for i in 0..100 {
        bench.hear(&[Message::ZoneSet(across(&format!("n{i}"), ZoneKind::Blocked, 5.0, 6.0))]);
    }
    assert_eq!((bench.sets().len(), bench.error("INSUFFICIENT_MEMORY")), (8, Some(ErrorLevel::Warning)));
}

#[test]
fn a_robot_in_a_blocked_zone_is_stuck_and_says_so() {
    let mut bench = RobotBench::of_version(Version::V3_0);
    bench.hear(&[Message::ZoneSet(across("s", ZoneKind::Blocked, -1.0, 1.0))]);
    bench.instant_with("enableZoneSet", "e", &[("zoneSetId", "s".into())]);
    bench.order(&along(&[0.0, 2.0]));
    bench.run(5.0);
    assert_eq!((bench.x(), bench.error("BLOCKED_ZONE_VIOLATION")), (0.0, Some(ErrorLevel::Critical)));
}

#[test]
fn a_robot_enters_a_release_zone_when_it_is_granted_and_stops_when_the_lease_ends() {
    let mut setup = RobotSetup::new(Version::V3_0, "maker", "r1", "lab", "n0");
    setup.zone_sets = vec![across("s", ZoneKind::Release, 2.0, 9.0)];
    let mut bench = RobotBench::new(setup);
    bench.order(&along(&[0.0, 1.0, 10.0]));
    bench.run(10.0);
    assert!((bench.x() - 1.0).abs() < 0.01, "it waits before the zone");
    assert_eq!(bench.requests()[0].status, RequestStatus::Requested);
    bench.answers(Grant::Granted, Some(bench.now_us + 3_000_000));
    bench.run(5.0);
    assert_eq!(bench.requests()[0].status, RequestStatus::Expired);
    assert!(bench.x() > 1.5 && bench.stands() && bench.error("RELEASE_LOST") == Some(ErrorLevel::Critical));
    bench.run(10.0);
    assert_eq!(bench.requests()[0].status, RequestStatus::Requested, "it asks anew");
    bench.answers(Grant::Granted, None);
    bench.run(20.0);
    assert!((bench.x() - 10.0).abs() < 0.01 && bench.requests().is_empty());
    assert_eq!(bench.error("RELEASE_LOST"), None);
}

#[test]
fn a_robot_with_something_in_its_way_goes_on_where_it_may_leave_the_line_and_asks_if_it_must() {
    let with = |corridor: Option<bool>| {
        let mut order = along(&[0.0, 4.0]);
        order.edges[0].corridor = corridor.map(|release_required| Corridor {
            left_m: 1.0,
            right_m: 1.0,
            of_contour: true,
            release_required,
        });
        let mut bench = RobotBench::of_version(Version::V3_0);
        bench.robot.robot.set_obstructed(true);
        bench.order(&order);
        bench.run(10.0);
        bench
    };
    assert_eq!(with(None).x(), 0.0);
    assert!(with(Some(false)).x() > 3.9);
    let mut bench = with(Some(true));
    assert_eq!((bench.x(), bench.requests().len()), (0.0, 1));
    bench.answers(Grant::Rejected, None);
    assert_eq!(bench.requests(), []);
    bench.run(10.0);
    bench.answers(Grant::Queued, None);
    bench.run(2.0);
    assert_eq!(bench.x(), 0.0);
    bench.answers(Grant::Granted, Some(i64::MAX));
    bench.run(1.5);
    bench.answers(Grant::Revoked, None);
    bench.run(2.0);
    assert!(bench.x() > 0.1 && bench.x() < 3.0 && bench.stands());
}

//! The body: it stops where its path ends, brakes when told, turns in place, and heeds speed limits.

use crate::robot::{BodyCommand, BodyLimits, BodyMotion, PathPoint, VirtualBody};

fn point(key: u32, x: f64, y: f64) -> PathPoint {
    PathPoint { key, x, y, heading: None, speed_mps: f64::INFINITY }
}

fn go(path: Vec<PathPoint>) -> BodyCommand {
    BodyCommand { path, motion: BodyMotion::Go, placed: None }
}

fn body() -> VirtualBody {
    VirtualBody::new(BodyLimits::default(), 0.0, 0.0, 0.0)
}

#[test]
fn a_body_takes_the_time_that_its_acceleration_and_braking_need_and_stops_at_the_last_point() {
    let mut body = body();
    // 1.875 s to 1.5 m/s over 1.41 m, 1.5 s of braking over 1.13 m, and 7.47 m at top speed between.
    let path = go(vec![point(1, 5.0, 0.0), point(2, 10.0, 0.0)]);
    let report = body.advance(8_200_000, &path);
    assert_eq!(report.reached, [1]);
    assert!(report.x > 9.7 && report.x < 10.0, "{report:?}");
    let report = body.advance(1_000_000, &go(vec![point(2, 10.0, 0.0)]));
    assert_eq!((report.reached.as_slice(), report.x, report.stands()), ([2].as_slice(), 10.0, true));
}

#[test]
fn a_braking_body_stands_after_its_braking_way_and_reports_the_points_on_it() {
    let mut body = body();
    let path = vec![point(1, 4.0, 0.0), point(2, 30.0, 0.0)];
    let report = body.advance(3_300_000, &go(path.clone()));
    assert!(report.reached.is_empty() && report.x > 3.0, "{report:?}");
    let brake = BodyCommand { path, motion: BodyMotion::Brake, placed: None };
    let report = body.advance(1_600_000, &brake);
    assert!(report.stands() && report.reached == [1], "{report:?}");
    assert!(report.x < 4.0 + 1.5 * 1.5 / 2.0 + 0.1, "{report:?}");
}

#[test]
fn a_body_stops_at_a_corner_turns_in_place_and_takes_the_heading_that_a_point_demands() {
    let mut body = body();
    let end = PathPoint { heading: Some((0.0, 0.05)), ..point(2, 2.0, 2.0) };
    let path = vec![point(1, 2.0, 0.0), end];
    let mut turned_at = None;
    let mut left = path.clone();
    for _ in 0..200 {
        let report = body.advance(50_000, &go(left.clone()));
        left.drain(..report.reached.len());
        if report.turn_radps != 0.0 {
            turned_at.get_or_insert((report.x, report.y));
        }
    }
    assert_eq!(turned_at, Some((2.0, 0.0)));
    assert!(left.is_empty());
    let report = body.report(Vec::new());
    assert_eq!((report.x, report.y), (2.0, 2.0));
    assert!(report.theta.abs() <= 0.05, "{report:?}");
}

#[test]
fn a_speed_limit_holds_from_the_point_where_it_begins() {
    let mut body = body();
    let slow = PathPoint { speed_mps: 0.3, ..point(2, 8.0, 0.0) };
    let mut left = vec![point(1, 5.0, 0.0), slow];
    for _ in 0..2_000 {
        let report = body.advance(10_000, &go(left.clone()));
        left.drain(..report.reached.len());
        assert!(left.len() == 2 || report.speed_mps <= 0.35, "{report:?}");
    }
    assert!(left.is_empty());
}

#[test]
fn a_body_that_is_placed_elsewhere_stands_there() {
    let mut body = body();
    body.advance(2_000_000, &go(vec![point(1, 9.0, 0.0)]));
    let placed = BodyCommand { placed: Some((1.0, 2.0, 3.0)), ..BodyCommand::default() };
    let report = body.advance(1_000_000, &placed);
    assert_eq!((report.x, report.y, report.theta, report.stands()), (1.0, 2.0, 3.0, true));
}

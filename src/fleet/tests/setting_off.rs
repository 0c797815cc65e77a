//! Robots that stand and are to go on while a person walks up from behind.

use super::*;
use giveway_people::aware::Meter;
use giveway_people::aware::Near;

/// A robot between the racks, released by an operator when a person behind it, on the way past it, is this near; what
/// both do for ten seconds from then on.
fn walked_up_to(apart_m: f64) -> Vec<(Near, Option<f64>)> {
    let mut floor = TestFloor::new(thesis(), &scenario(1));
    let robot = RobotId(0);
    floor.submit(request(deliver(40)));
    let drives = |f: &TestFloor| f.world.truth().next().is_some_and(|(_, t)| t.speed_mps > 1.2);
    floor.until(60, "it drives", drives);
    floor.step(vec![Input::ask(4, FloorAction::Halt(Some(robot)))]);
    floor.run(4);
    let (stood, ahead) = (floor.robot_at(), floor.ahead());
    let mut ana = floor.hire(stood - ahead * (apart_m + 2.0));
    (ana.own, ana.way) = (true, vec![stood + ahead * 8.0]);
    while (ana.at - stood).norm() > apart_m {
        floor.walk(&mut ana);
    }
    floor.step(vec![Input::ask(5, FloorAction::Release(Some(robot)))]);
    let mut seen = Vec::new();
    for _ in 0..80 {
        floor.walk(&mut ana);
        let (_, t) = floor.world.truth().next().expect("there is one");
        let distance_m = (t.pose.at - ana.at).norm();
        let (worker, at, radius_m) = (ana.worker, ana.at, 1.4);
        let (robot_at, robot_mps, worker_mps) = (t.pose.at, t.speed_mps, 1.2);
        let near = Near { worker, robot, at, robot_at, radius_m, distance_m, robot_mps, worker_mps };
        seen.push((near, t.limit_mps));
    }
    seen
}

#[test]
fn a_robot_sets_off_before_somebody_only_where_it_gets_away() {
    let meets = |apart_m: &f64| {
        let mut meter = Meter::default();
        for (i, (near, _)) in walked_up_to(*apart_m).iter().enumerate() {
            meter.observe(Time(i as i64 * 100_000), &[*near]);
        }
        meter.begun() > 0
    };
    let met: Vec<f64> = (15..50).map(|d| f64::from(d) / 10.0).filter(meets).collect();
    // People are seen with a delay: one of the distances may be the wrong one.
    assert!(met.len() <= 1, "it set off too late, with her at {met:?} m");
}

#[test]
fn a_robot_that_drives_away_from_somebody_is_not_slowed_down_at_every_place_that_it_passes() {
    let seen = walked_up_to(3.4);
    let began = seen.iter().position(|(near, _)| near.robot_mps > 0.5).expect("it sets off");
    let limits: Vec<_> =
        seen[began..began + 20].iter().filter_map(|(near, l)| Some((near.distance_m, (*l)?))).collect();
    assert!(limits.is_empty(), "{limits:?}");
}

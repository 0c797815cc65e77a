//! Robots that would only stand until a worker has gone by drive more slowly instead, and arrive no later for it.

use super::*;
use giveway_people::aware::SLOW_MPS;

impl TestFloor {
    fn arrival_limit(&self) -> Option<f64> {
        let Internals { writer, people, yielding, traffic } = self.fleet.internals();
        yielding.limits(writer.floor(), people, traffic).arrival_limit(RobotId(0), self.now)
    }

    /// A robot at full speed, and a person who crosses from the side this far ahead of it, or comes to stand there: the
    /// limits with which the robot was to arrive later, in the order of steps.
    fn crossed(ahead_m: f64, stays: bool) -> Vec<f64> {
        let mut floor = TestFloor::new(thesis(), &scenario(1));
        floor.submit(request(deliver(40)));
        let drives = |f: &TestFloor| f.world.truth().next().is_some_and(|(_, t)| t.speed_mps > 1.2);
        floor.until(60, "it drives", drives);
        let (from, ahead) = (floor.robot_at(), floor.ahead());
        let side = giveway_floor::geometry::Vector::new(-ahead.y, ahead.x);
        let mut ana = floor.hire(from + ahead * ahead_m + side * 4.0);
        let end = from + ahead * ahead_m + side * if stays { 0.0 } else { -8.0 };
        (ana.own, ana.way) = (true, vec![end]);
        let mut limits = Vec::new();
        for _ in 0..120 {
            floor.walk(&mut ana);
            limits.extend(floor.arrival_limit());
        }
        limits
    }
}

#[test]
fn a_robot_before_which_somebody_crosses_arrives_when_the_way_is_free() {
    let top = Kinematics::default().top_mps(true);
    let limits: Vec<f64> = (5..10).flat_map(|m| TestFloor::crossed(f64::from(m), false)).collect();
    assert!(!limits.is_empty(), "no robot was slowed down beforehand");
    assert!(limits.iter().all(|l| (SLOW_MPS..top).contains(l)), "{limits:?}");
}

#[test]
fn a_robot_is_not_slowed_down_for_somebody_who_will_stay() {
    for ahead_m in [6.0, 8.0] {
        let limits = TestFloor::crossed(ahead_m, true);
        // While she comes it is not known that she will stay.
        assert!(limits.len() < 60, "{} of 120 steps", limits.len());
    }
}

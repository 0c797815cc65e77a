//! Where a simulated worker enters: at the door, or close to it if another person stands in the door.
//!
//! Main functions: [`entrance`], and [`vehicle_entrance`] for vehicles. Refuses: to let anybody step out in front of a
//! robot that could not stop.

use crate::walker::{APART_M, PersonNear, RobotNear};
use giveway_floor::geometry::Point;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_people::human::Mover;

/// A robot nearer to a door than this keeps a worker from entering, metres.
const DOOR_M: f64 = 1.5;
/// A moving robot keeps workers out from this many seconds of travel farther away.
const DOOR_S: f64 = 2.5;
/// No worker enters nearer than this to a person who is there, metres.
const DOOR_APART_M: f64 = APART_M + 0.05;

/// Where a worker can enter at a door now; nothing while robots or people are in the way.
pub(super) fn entrance<'a>(
    door: Point,
    walkways: &Walkways,
    people: impl Iterator<Item = &'a PersonNear> + Clone,
    robots: &[RobotNear],
) -> Option<Point> {
    let keeps = |r: &RobotNear| DOOR_M + DOOR_S * r.velocity.norm();
    let is_clear = |at: &Point| robots.iter().all(|r| (r.at - at).norm() > keeps(r));
    let is_free = |at: &Point| people.clone().all(|p| (p.at - at).norm() >= DOOR_APART_M);
    if !is_clear(&door) {
        return None;
    }
    if is_free(&door) {
        return Some(door);
    }
    walkways.standing_places(door, DOOR_M).into_iter().find(|at| is_free(at) && is_clear(at))
}

/// Where a vehicle enters at a door now; nothing while robots or people are in the way.
pub(super) fn vehicle_entrance<'a>(
    door: Point,
    mover: Mover,
    mut people: impl Iterator<Item = &'a PersonNear>,
    robots: &[RobotNear],
) -> Option<Point> {
    let body_m = mover.body_m();
    let keeps = |r: &RobotNear| DOOR_M + body_m + DOOR_S * r.velocity.norm();
    let is_clear = robots.iter().all(|r| (r.at - door).norm() > keeps(r));
    (is_clear && people.all(|p| (p.at - door).norm() > DOOR_M + body_m)).then_some(door)
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::geometry::Vector;
    use giveway_floor::id::WalkNodeId;
    use giveway_floor::warehouse::thesis;

    #[test]
    fn who_finds_somebody_in_the_door_comes_in_beside_it_unless_a_robot_is_near_there() {
        let (hall, still) = (thesis(), Vector::zeros());
        let walkways = Walkways::of(&hall);
        let door = walkways.on_floor(walkways.nodes()[WalkNodeId(0)].at).expect("it is on the floor");
        let inside = PersonNear {
            who: 1,
            at: door,
            velocity: still,
            aim: None,
            works: false,
            kept: false,
            usual_mps: 1.2,
        };
        let enter = |robots: &[RobotNear]| entrance(door, &walkways, [&inside].into_iter(), robots);
        let beside = enter(&[]).expect("there is room beside the door");
        assert!((beside - door).norm() >= DOOR_APART_M);
        // A robot that is just far enough from the door is too near to the place beside it.
        let away = (beside - door).normalize() * (DOOR_M + 0.01);
        let robot = RobotNear { at: door + away, velocity: still, half_m: 0.45 };
        let other = enter(&[robot]);
        assert!(other.is_none_or(|at| (at - robot.at).norm() > DOOR_M), "{other:?}");
        assert_ne!(other, Some(beside));
    }
}

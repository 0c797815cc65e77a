//! Robots that claim what is not so: each claim is noticed, and costs that robot, never the floor.

use super::*;

#[test]
fn a_robot_that_fails_to_pause_does_not_join_until_an_operator_agrees() {
    let mut floor = LinkFloor::new(lab(), vec![RobotSetup::like_c()]);
    floor.run(20);
    let not_ready = floor.pairs[0].session.not_ready(floor.now);
    assert!(
        matches!(not_ready, Some(NotReady::NoPause(_) | NotReady::NotLocalized)),
        "{not_ready:?}: robot C never says that it is localised, and fails to pause"
    );
    assert_eq!(floor.pairs[0].number, None);
}

//! Stops: a pause at once, and again until the robot stands.

use super::*;
use giveway_fleet::Command;

#[test]
fn a_stop_is_a_pause_in_the_same_turn_and_ends_with_one() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_0)]);
    floor.all_ready();
    floor.submit_deliveries(1);
    floor.until(30, "it drives", |f| f.pairs[0].speed_mps() > 0.5);
    let now = floor.now;
    let out = floor.pairs[0].session.command(now, &Command::Limit(Some(0.0)));
    let Some(RobotTold { message: Message::InstantActions(actions), .. }) = out.told.first() else {
        panic!("{out:?}")
    };
    assert_eq!(actions[0].kind, "startPause");
    floor.take(0, out, &mut Vec::new());
    for _ in 0..30 {
        // The fleet itself would let it go on.
        let out = floor.pairs[0].session.command(floor.now, &Command::Limit(Some(0.0)));
        floor.take(0, out, &mut Vec::new());
        floor.hear(0, &mut Vec::new());
        floor.now += PERIOD;
    }
    assert!(floor.pairs[0].speed_mps() < 0.01 && floor.pairs[0].session.is_paused_by_us());
    let starts = floor.pairs[0].told.iter().filter(|(at, _, message)| {
        *at >= now && matches!(message, Message::InstantActions(a) if a[0].kind == "startPause")
    });
    assert_eq!(starts.count(), 1, "it was heard at once and is not told again");
}

//! Stops: a pause at once, and again until the robot stands.

use super::*;
use giveway_fleet::{Command, FloorAction};
use giveway_vda5050::ActionStatus;

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

#[test]
fn a_robot_whose_pause_ends_with_its_cancelled_order_is_paused_again_before_it_gets_another() {
    let mut floor = LinkFloor::new(lab(), vec![RobotSetup::like_a()]);
    floor.all_ready();
    floor.submit_deliveries(1);
    floor.until(60, "it drives", |f| f.pairs[0].speed_mps() > 0.3);
    floor.step(vec![Input::ask(5, FloorAction::Halt(None))]);
    floor.until(10, "it is paused", |f| f.pairs[0].session.says_paused());
    floor.run(3);
    let progress = floor.pairs[0].session.progress.clone().expect("it has joined");
    let revokes = Command::Revoke { reached: progress.reached, number: progress.recalls + 1 };
    let out = floor.pairs[0].session.command(floor.now, &revokes);
    floor.take(0, out, &mut Vec::new());
    floor.run(5);
    let told = floor.pairs[0].told.iter().filter_map(|(_, _, message)| match message {
        Message::InstantActions(actions) => Some(actions[0].kind.as_str()),
        Message::Order(_) => Some("order"),
        _ => None,
    });
    let since: Vec<&str> = told.skip_while(|kind| *kind != "cancelOrder").collect();
    let next = since.iter().find(|kind| ["order", "startPause"].contains(kind));
    assert_eq!(next, Some(&"startPause"), "{since:?}");
    assert!(floor.pairs[0].session.says_paused() && floor.pairs[0].speed_mps() < 0.01);
}

/// How often a robot was told something since a time.
fn count(floor: &LinkFloor, since: Time, kind: &str) -> usize {
    let told = floor.pairs[0].told.iter().filter(|(at, ..)| *at >= since);
    told.filter(|(.., m)| matches!(m, Message::InstantActions(a) if a[0].kind == kind)).count()
}

#[test]
fn a_robot_that_is_to_stand_and_to_go_on_by_turns_is_not_told_so_several_times_a_second() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_0)]);
    floor.all_ready();
    floor.submit_deliveries(1);
    floor.until(30, "it drives", |f| f.pairs[0].speed_mps() > 0.5);
    let begun = floor.now;
    for turn in 0..100 {
        let limit = Command::Limit((turn % 2 == 0).then_some(0.0));
        let out = floor.pairs[0].session.command(floor.now, &limit);
        floor.take(0, out, &mut Vec::new());
        floor.hear(0, &mut Vec::new());
        floor.now += PERIOD;
    }
    assert_eq!((count(&floor, begun, "startPause"), count(&floor, begun, "stopPause")), (1, 0));
    floor.run(30);
    assert!(count(&floor, begun, "stopPause") >= 1 && floor.pairs[0].session.pause.since.is_none());
}

/// Robot A listed a pause as PAUSED, went on when told to, and paused after that by what it still had to carry out.
#[test]
fn a_pause_that_a_robot_carries_out_after_it_was_told_to_go_on_is_lifted_and_not_taken_for_a_hand() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_0)]);
    floor.all_ready();
    floor.run(60);
    let state = floor.pairs[0].session.state().expect("it was heard").1.clone();
    let act = |id: &str, kind: &str, status| ActionState {
        id: id.to_owned(),
        kind: Some(kind.to_owned()),
        status,
        result: None,
    };
    let began = floor.now;
    let says = |floor: &mut LinkFloor, paused: bool, start, n: u32| {
        let actions =
            vec![act("gw-1-8", "startPause", start), act("gw-1-9", "stopPause", ActionStatus::Finished)];
        let said = giveway_vda5050::State { paused: Some(paused), actions, ..state.clone() };
        let stamp = MessageStamp { id: 9_000 + n, timestamp: format!("{:020}", i64::MAX / 2 + i64::from(n)) };
        let out = floor.pairs[0].session.hear(floor.now, RobotHeard::State(Box::new(said), stamp));
        floor.take(0, out, &mut Vec::new());
        floor.now += PERIOD;
    };
    says(&mut floor, false, ActionStatus::Paused, 0);
    says(&mut floor, true, ActionStatus::Finished, 1);
    assert_eq!(count(&floor, began, "stopPause"), 1);
    assert!(!floor.pairs[0].session.is_paused_by_hand());
}

#[test]
fn a_pause_pressed_at_the_robot_is_lifted_by_who_pressed_it_and_by_nobody_here() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_1)]);
    floor.all_ready();
    // Longer than a robot may need to carry out the pause with which it was proven.
    floor.run(5);
    let job = floor.submit_deliveries(1);
    floor.until(60, "it drives", |f| f.pairs[0].speed_mps() > 0.3);
    let since = floor.now;
    floor.pairs[0].robot.robot.press_pause(true);
    floor.run(60);
    assert!(floor.pairs[0].session.is_paused_by_hand() && floor.pairs[0].speed_mps() < 0.01);
    assert_eq!(count(&floor, since, "stopPause"), 0);
    floor.pairs[0].robot.robot.press_pause(false);
    floor.until_done(&job, 300);
}

#[test]
fn a_robot_that_a_person_paused_before_its_first_contact_says_that_it_waits_for_that_person() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_0)]);
    floor.pairs[0].robot.robot.press_pause(true);
    floor.run(60);
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), Some(NotReady::PausedByHand));
    assert_eq!(count(&floor, Time::ZERO, "stopPause"), 0);
    floor.pairs[0].robot.robot.press_pause(false);
    floor.all_ready();
}

#[test]
fn a_drive_that_the_fleet_repeats_while_its_revocation_is_being_obeyed_is_not_driven_afterwards() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_1)]);
    floor.all_ready();
    floor.submit_deliveries(1);
    floor.until(60, "it drives", |f| f.pairs[0].speed_mps() > 0.3);
    floor.step(vec![Input::ask(5, FloorAction::Halt(None))]);
    floor.until(10, "it is paused", |f| f.pairs[0].session.is_paused_by_us());
    floor.run(2);
    let progress = floor.pairs[0].session.progress.clone().expect("it has joined");
    assert!(progress.known > progress.reached, "it was released farther than it is");
    let drive = floor.pairs[0].drive.clone().expect("it was told to drive");
    let revokes = Command::Revoke { reached: progress.reached, number: progress.recalls + 1 };
    let since = floor.now;
    for command in [&revokes, &drive, &Command::Limit(None)] {
        let out = floor.pairs[0].session.command(floor.now, command);
        floor.take(0, out, &mut Vec::new());
    }
    for _period in 0..100 {
        floor.hear(0, &mut Vec::new());
        floor.now += PERIOD;
    }
    let after = floor.pairs[0].session.progress.clone().expect("it has joined");
    assert_eq!((after.recalls, after.known), (progress.recalls + 1, progress.reached), "it has obeyed");
    assert!(!floor.told_since(since).contains(&"order"), "{:?}", floor.told_since(since));
}

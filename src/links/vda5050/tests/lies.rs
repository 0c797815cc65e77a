//! Robots that claim what is not so: each claim is noticed, and costs that robot, never the floor.

use super::*;
use giveway_vda5050::robot::OrderActionHabit;

#[test]
fn a_robot_that_fails_to_pause_gets_no_orders_until_an_operator_agrees() {
    let mut floor = LinkFloor::new(lab(), vec![RobotSetup::like_c()]);
    floor.run(20);
    let not_ready = floor.pairs[0].session.not_ready(floor.now);
    assert!(matches!(not_ready, Some(NotReady::NoPause(_))), "{not_ready:?}");
    let robot = floor.pairs[0].number.expect("it has joined: it is in others' way");
    let link = floor.fleet.link_state(robot).expect("its link has said so");
    assert!(link.refuses.as_ref().is_some_and(|why| why.text().contains("does not pause")), "{link:?}");
    floor.pairs[0].session.consent();
    floor.all_ready();
    floor.run(1);
    let link = floor.fleet.link_state(robot).expect("its link has said so");
    assert_eq!(link.refuses, None);
    assert_eq!(link.limits, ObeyedLimits::Nothing, "it is granted one node at a time");
}

/// Whether a robot that does not pick is named, and costs the floor nothing but the rack that it stands under.
fn is_named(version: Version, habit: OrderActionHabit, said: &str) {
    let mut liar = standard(version);
    liar.quirks.order_actions = habit;
    let mut floor = LinkFloor::new(thesis(), vec![liar, standard(version), standard(version)]);
    floor.all_ready();
    let jobs = floor.submit_deliveries(8);
    let begun = floor.now;
    floor.until(120, "the lie is noticed", |f| !f.pairs[0].noticed.is_empty());
    assert_eq!(floor.notices(0), [said], "{:?} after the beginning", floor.now - begun);
    let of_others = jobs.clone();
    floor.until(1800, "all others end", move |f| {
        of_others.iter().filter(|job| f.ended.contains_key(job)).count() == 7
    });
    assert!(floor.ended.values().all(|state| *state == JobState::Done));
    let waits = jobs.into_iter().find(|job| !floor.ended.contains_key(job)).expect("one waits");
    let (view, map) = (floor.fleet.view(floor.now), floor.map());
    let why = view.why_job(&map, waits, &floor.fleet.ledger().jobs[&waits]);
    let liar = floor.pairs[0].number.expect("it has joined");
    let blocks =
        matches!(why, Some(JobWhy::RackBlocked(_, robot) | JobWhy::WayBlocked(robot)) if robot == liar);
    assert!(blocks, "{why:?}");
    assert_eq!(floor.notices(1), [""; 0]);
}

#[test]
fn a_robot_that_ends_its_order_without_a_word_about_its_pick_is_named_and_its_job_is_given_back() {
    let said = "ended its order without a word about pick";
    is_named(Version::V2_0, OrderActionHabit::SkippedInSilence, said);
}

#[test]
fn a_robot_that_says_that_it_has_picked_and_carries_nothing_is_named_and_its_job_is_given_back() {
    let said = "says that pick is finished, and carries nothing";
    is_named(Version::V3_0, OrderActionHabit::ClaimedNotDone, said);
}

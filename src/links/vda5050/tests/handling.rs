//! Actions of 3.0: what may be tried again is, once, and a robot waits at a work cell until it is dismissed.

use super::*;
use giveway_vda5050::ActionStatus;
use giveway_vda5050::robot::ReadingHabit;

/// A fleet of one robot that is to carry a rack to a station and back.
fn carries(setup: RobotSetup) -> (LinkFloor, JobId) {
    let mut floor = LinkFloor::new(lab(), vec![setup]);
    floor.all_ready();
    let job = floor.submit_deliveries(1)[0];
    (floor, job)
}

impl LinkFloor {
    fn count(&self, kind: &str) -> usize {
        self.told_since(Time::ZERO).iter().filter(|told| **told == kind).count()
    }

    pub(super) fn says_of(&self, kind: &str, status: ActionStatus) -> bool {
        let is_it = |a: &ActionState| a.kind.as_deref() == Some(kind) && a.status == status;
        self.pairs[0].robot.robot.state().actions.iter().any(is_it)
    }
}

#[test]
fn a_pick_that_may_be_tried_again_is_tried_once_and_the_job_is_done() {
    let (mut floor, job) = carries(standard(Version::V3_0));
    floor.pairs[0].robot.robot.set_handling_fault(true);
    floor.until(120, "it has failed", |f| f.says_of("pick", ActionStatus::Retriable));
    floor.pairs[0].robot.robot.set_handling_fault(false);
    floor.until_done(&[job], 600);
    assert_eq!((floor.count("retry"), floor.count("skipRetry")), (1, 0));
    assert_eq!(floor.notices(0), [""; 0]);
}

#[test]
fn a_pick_that_fails_twice_is_given_up_for_the_reason_that_the_robot_gave() {
    let (mut floor, _job) = carries(standard(Version::V3_0));
    floor.pairs[0].robot.robot.set_handling_fault(true);
    floor.until(120, "it has failed", |f| f.pairs[0].session.failure().is_some());
    assert_eq!((floor.count("retry"), floor.count("skipRetry")), (1, 1));
    assert_eq!(floor.notices(0), ["pick failed: there is no load to pick"]);
}

#[test]
fn a_robot_that_neither_tries_again_nor_gives_up_waits_for_a_person() {
    let (mut floor, _job) = carries(standard(Version::V3_0));
    floor.pairs[0].robot.robot.set_handling_fault(true);
    floor.until(120, "it has failed", |f| f.says_of("pick", ActionStatus::Retriable));
    // Whatever it is told is lost, and its states still come.
    for _period in 0..600 {
        floor.pairs[0].to_robot.clear();
        floor.step(Vec::new());
    }
    assert!(floor.says_of("pick", ActionStatus::Retriable), "it still waits");
    assert_eq!(floor.pairs[0].session.failure(), Some("pick failed: there is no load to pick"));
}

#[test]
fn before_3_0_a_failed_pick_is_not_tried_again() {
    let (mut floor, _job) = carries(standard(Version::V2_1));
    floor.pairs[0].robot.robot.set_handling_fault(true);
    floor.until(120, "it has failed", |f| f.pairs[0].session.failure().is_some());
    assert_eq!((floor.count("retry"), floor.count("skipRetry")), (0, 0));
}

#[test]
fn a_robot_waits_at_the_station_for_a_trigger_that_is_its_dismissal() {
    let (mut floor, job) = carries(standard(Version::V3_0));
    floor.until(240, "it waits", |f| f.says_of("waitForTrigger", ActionStatus::Running));
    assert_eq!(floor.count("trigger"), 0);
    floor.run(2);
    let since = floor.now;
    // The picker takes long.
    floor.picks.values_mut().for_each(|picks| *picks += Span::from_secs(60));
    floor.run(55);
    let asked = floor.told_since(since).iter().filter(|told| **told == "stateRequest").count();
    assert!(asked <= 3, "asked {asked} times in a minute");
    let orders = floor.orders().len();
    floor.until(60, "it is dismissed", |f| f.count("trigger") > 0);
    let robot = floor.pairs[0].number.expect("it has joined");
    assert!(!floor.fleet.ledger().is_picked_from(robot), "the picker is done");
    assert_eq!(floor.orders().len(), orders, "the order comes when it waits no more");
    floor.until_done(&[job], 600);
    assert_eq!(floor.count("trigger"), 1);
    assert_eq!(floor.notices(0), [""; 0]);
}

#[test]
fn a_robot_that_was_dismissed_by_hand_or_does_not_offer_to_wait_goes_on_as_well() {
    let mut plain = standard(Version::V3_0);
    plain.factsheet.as_mut().expect("it has one").actions = None;
    let (mut floor, job) = carries(plain);
    floor.until_done(&[job], 600);
    assert_eq!(floor.count("trigger"), 0);
    let (mut floor, job) = carries(standard(Version::V3_0));
    floor.until(240, "it waits", |f| f.says_of("waitForTrigger", ActionStatus::Running));
    floor.pairs[0].robot.robot.press_trigger();
    floor.until_done(&[job], 600);
    assert_eq!(floor.count("trigger"), 0, "somebody pressed the button at the robot");
}

#[test]
fn a_robot_that_takes_no_trigger_says_that_it_needs_a_hand_and_is_not_made_to_wait_again() {
    let mut deaf = standard(Version::V3_0);
    deaf.quirks.reading = ReadingHabit::AtEndOfBase;
    let (mut floor, job) = carries(deaf);
    let needs_hand = |f: &LinkFloor| f.pairs[0].session.not_ready(f.now) == Some(NotReady::NeedsButton);
    floor.until(300, "it needs a hand", needs_hand);
    floor.pairs[0].robot.robot.press_trigger();
    floor.until(10, "it goes on", |f| f.pairs[0].session.not_ready(f.now).is_none());
    floor.until_done(&[job], 600);
    let job = floor.submit_deliveries(1);
    floor.until_done(&job, 600);
    let orders = floor.orders();
    let waits = orders.iter().flat_map(|order| &order.nodes).flat_map(|node| &node.actions);
    assert_eq!(waits.filter(|action| action.kind == "waitForTrigger").count(), 1);
}

#[test]
fn a_robot_that_waits_when_the_process_dies_is_dismissed_by_the_next_one() {
    let (mut floor, job) = carries(standard(Version::V3_0));
    floor.until(240, "it waits", |f| f.says_of("waitForTrigger", ActionStatus::Running));
    floor.restart();
    floor.until_done(&[job], 600);
    assert_eq!(floor.count("trigger"), 1);
    assert_eq!(floor.notices(0), [""; 0]);
}

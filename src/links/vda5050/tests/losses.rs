//! Messages that are lost, a process that dies, robots that begin anew: every job is done once.

use super::*;
use crate::vda5050::order::{OrderLife, complaint};
use giveway_vda5050::robot::ReadingHabit;
use giveway_vda5050::{ActionStatus, ErrorLevel, ErrorReference, RobotError};
use std::collections::BTreeSet;

/// When the first process begins, milliseconds since 1970.
pub(super) const FIRST_BOOT_MS: u64 = 1_800_000_000_000;

impl LinkFloor {
    /// Something happens to the line to all robots.
    fn tell_all(&mut self, act: impl Fn(&mut RobotSession, Time) -> SessionOutput) {
        let mut inputs = Vec::new();
        for i in 0..self.pairs.len() {
            let out = act(&mut self.pairs[i].session, self.now);
            self.take(i, out, &mut inputs);
        }
        self.step(inputs);
    }

    /// The process dies and begins anew from the ledger; robots go on.
    pub(super) fn restart(&mut self) {
        let (ledger, settings) = (self.fleet.ledger().clone(), self.fleet.settings().clone());
        self.fleet = Fleet::resume(ledger, settings, []);
        // A process begins after the one before it.
        let now_ms = FIRST_BOOT_MS + self.now.0.unsigned_abs() / 1_000;
        self.boot = now_ms.max(self.boot + 1_000);
        let map = self.map();
        for pair in &mut self.pairs {
            pair.session =
                RobotSession::new(pair.session.version(), pair.settings.clone(), map.clone(), self.boot);
            pair.number = None;
            pair.to_robot.clear();
            pair.to_fleet.clear();
        }
        self.picks.clear();
    }

    /// The sessions with all robots begin anew in this process.
    fn begin_again(&mut self) {
        for pair in &mut self.pairs {
            pair.session = pair.session.begin_again(pair.session.version());
            pair.number = None;
        }
    }
}

#[test]
fn a_session_that_begins_anew_uses_no_id_of_the_one_before_and_no_job_is_done_twice() {
    for version in Version::ALL {
        let mut floor = LinkFloor::new(lab(), vec![standard(version), standard(version)]);
        floor.run(1);
        floor.begin_again();
        floor.all_ready();
        let jobs = floor.submit_deliveries(4);
        for seconds in [3, 11, 17, 24] {
            floor.run(seconds);
            floor.begin_again();
        }
        floor.until_done(&jobs, 1800);
    }
}

#[test]
fn a_process_that_dies_again_and_again_knows_its_own_orders_and_no_job_is_done_twice() {
    for version in Version::ALL {
        let mut floor = LinkFloor::new(lab(), vec![standard(version), standard(version)]);
        floor.all_ready();
        let jobs = floor.submit_deliveries(6);
        for seconds in [3, 7, 12, 17, 23, 29, 8, 14] {
            floor.run(seconds);
            floor.restart();
        }
        floor.until_done(&jobs, 1800);
    }
}

#[test]
fn messages_that_are_lost_doubled_late_and_overtaken_change_no_outcome() {
    for seed in 1..=12 {
        let setups = vec![standard(Version::V2_0), standard(Version::V2_1), standard(Version::V3_0)];
        let mut floor = LinkFloor::new(lab(), setups);
        floor.chance = Chance { state: seed, lost: 0.05, doubled: 0.1, late_ms: 400.0 };
        floor.all_ready();
        let jobs = floor.submit_deliveries(8);
        floor.until_done(&jobs, 3600);
    }
}

#[test]
fn while_the_line_to_all_robots_is_down_no_job_changes_hands_and_afterwards_all_are_done() {
    let setups = vec![standard(Version::V2_0), standard(Version::V2_1), standard(Version::V3_0)];
    let mut floor = LinkFloor::new(thesis(), setups);
    floor.all_ready();
    let jobs = floor.submit_deliveries(6);
    let work = |f: &LinkFloor| f.fleet.ledger().robots.iter().map(|r| r.task.job()).collect::<Vec<_>>();
    floor.until(60, "all have jobs", |f| work(f).iter().all(Option::is_some));
    let before = work(&floor);
    floor.chance.lost = 1.0;
    floor.tell_all(|session, now| session.line_is_down(now));
    floor.run(90);
    assert_eq!(work(&floor), before);
    floor.chance.lost = 0.0;
    floor.tell_all(|session, now| session.line_is_back(now));
    floor.until_done(&jobs, 1800);
}

#[test]
fn a_robot_that_is_silent_for_long_gives_back_a_job_that_it_has_not_begun() {
    let setups = vec![standard(Version::V2_1), standard(Version::V2_1)];
    let mut floor = LinkFloor::new(thesis(), setups);
    floor.all_ready();
    let jobs = floor.submit_deliveries(2);
    let has_job = |f: &LinkFloor| f.fleet.ledger().robots.iter().all(|r| r.task.job().is_some());
    floor.until(60, "both have jobs", has_job);
    floor.pairs[0].robot.robot.lose_broker();
    let lost = RobotHeard::Connection(giveway_vda5050::ConnectionState::Broken);
    let (out, mut inputs) = (floor.pairs[0].session.hear(floor.now, lost), Vec::new());
    floor.take(0, out, &mut inputs);
    floor.step(inputs);
    let silent = floor.pairs[0].number.expect("it has joined");
    let job = floor.fleet.ledger().robots[silent].task.job().expect("it has one");
    let has_it = |f: &LinkFloor| f.fleet.ledger().robots[silent].task.job() == Some(job);
    floor.run(30);
    assert!(has_it(&floor), "it may come back");
    floor.run(10);
    assert!(!has_it(&floor), "others do it");
    floor.pairs[0].robot.robot.find_broker();
    floor.until_done(&jobs, 1800);
}

impl LinkFloor {
    /// A robot that carries nothing and stands is switched off and on again where it is.
    pub(super) fn reboot(&mut self, i: usize) {
        let pair = &mut self.pairs[i];
        let state = pair.robot.robot.state();
        let carries = state.loads.as_ref().is_none_or(|loads| !loads.is_empty());
        let acts = state.actions.iter().any(|action| !action.status.is_over());
        if let (Some(position), false, false, true) = (state.position, carries, acts, pair.speed_mps() == 0.0)
        {
            pair.robot.robot.reboot(position, &state.last_node);
            pair.to_robot.clear();
            pair.next = 0;
        }
    }
}

#[test]
fn an_order_of_ours_with_numbers_that_no_order_has_is_not_taken_for_one() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_0)]);
    floor.all_ready();
    let (_, state) = floor.pairs[0].session.state().expect("it was heard");
    for order in [format!("gw-1-1-{}", u64::MAX), "gw-1-1-0".to_owned()] {
        let said =
            giveway_vda5050::State { order, update: u32::MAX, last_sequence: u32::MAX, ..state.clone() };
        let stamp = MessageStamp { id: 1, timestamp: "2026".into() };
        let settings = floor.pairs[0].settings.clone();
        let mut session = RobotSession::new(Version::V2_0, settings, floor.map(), 2);
        session.tick(floor.now);
        let later = floor.now + Span::from_secs(2);
        session.hear(later, RobotHeard::State(Box::new(said), stamp));
        let robot = RobotId::at(0);
        session.join(later, SessionStart { robot, at: 0, granted: 3, recalls: 0, rack: None });
        assert!(session.knows_what_was_ordered());
        assert_eq!(session.order_text(), "no order");
    }
}

#[test]
fn a_robot_that_says_nothing_more_is_silent_however_often_it_is_asked() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_1)]);
    floor.all_ready();
    floor.submit_deliveries(1);
    floor.until(60, "it drives", |f| f.pairs[0].speed_mps() > 0.3);
    // Nobody says that its connection is broken: it died without its broker noticing.
    floor.pairs[0].robot.robot.lose_broker();
    floor.step(vec![Input::ask(5, giveway_fleet::FloorAction::Halt(None))]);
    for _second in 0..40 {
        floor.pairs[0].session.look_again(floor.now);
        floor.run(1);
    }
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), Some(NotReady::Silent));
}

#[test]
fn a_robot_whose_new_order_is_cancelled_at_once_is_not_taken_for_a_liar() {
    let mut floor = LinkFloor::new(thesis(), vec![RobotSetup::like_a()]);
    floor.all_ready();
    floor.submit_deliveries(1);
    floor.until(60, "it is under way", |f| {
        f.pairs[0]
            .session
            .state()
            .is_some_and(|(_, state)| state.last_sequence >= 8 && !state.nodes.is_empty())
    });
    let now = floor.now;
    floor.pairs[0].session.begin_cancel(now, None);
    let id = |f: &LinkFloor| f.pairs[0].session.leg().map(|leg| leg.id.clone());
    let cancelled = id(&floor);
    floor.until(60, "it has another order", move |f| id(f).is_some_and(|id| Some(id) != cancelled));
    let now = floor.now;
    floor.pairs[0].session.begin_cancel(now, None);
    floor.run(5);
    assert_eq!(floor.notices(0), [""; 0]);
}

#[test]
fn an_action_that_goes_on_when_its_order_is_cancelled_is_waited_for_and_not_asked_for_again() {
    let mut deaf = standard(Version::V2_1);
    deaf.quirks.reading = ReadingHabit::AtEndOfBase;
    let mut floor = LinkFloor::new(lab(), vec![deaf]);
    floor.all_ready();
    let job = floor.submit_deliveries(1);
    floor.until(120, "it drives to the rack", |f| f.says_of("pick", ActionStatus::Waiting));
    let now = floor.now;
    floor.pairs[0].session.begin_cancel(now, None);
    floor.until_done(&job, 600);
    let orders = floor.orders();
    let acts = orders.iter().flat_map(|order| &order.nodes).flat_map(|node| &node.actions);
    let picks: BTreeSet<&str> = acts.filter(|act| act.kind == "pick").map(|act| act.id.as_str()).collect();
    assert_eq!(picks.len(), 1, "{picks:?}");
    assert_eq!(floor.pairs[0].session.failure(), None);
}

#[test]
fn a_cancel_that_found_no_order_says_nothing_against_the_next_order() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_1)]);
    floor.all_ready();
    floor.submit_deliveries(1);
    floor.until(60, "it has an order", |f| matches!(f.pairs[0].session.order, OrderLife::Has(_)));
    let OrderLife::Has(leg) = &floor.pairs[0].session.order else { panic!("it has an order") };
    let error = |kind: &str, order: Option<&str>| RobotError {
        kind: kind.to_owned(),
        level: ErrorLevel::Warning,
        references: order
            .into_iter()
            .map(|id| ErrorReference { key: "orderId".into(), value: id.into() })
            .collect(),
        description: None,
        hint: None,
    };
    let against = |kind: &str, order: Option<&str>| complaint(leg, &[error(kind, order)]).is_some();
    assert!(against("orderError", None) && against("anything", Some(&leg.id)));
    assert!(!against("noOrderToCancel", None) && !against("NO_ORDER_TO_CANCEL", Some(&leg.id)));
    assert!(!against("orderUpdateError", Some("gw-1-1-1")), "it is about another order");
}

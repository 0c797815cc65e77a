//! What users of other fleet managers complain of, each as a test. The comment names where the complaint was read.

use super::*;
use giveway_vda5050::{ActionStatus, ConnectionState, OperatingMode, State};

impl LinkFloor {
    /// A robot that has joined an empty floor and may be commanded.
    fn with_one(setup: RobotSetup) -> LinkFloor {
        let mut floor = LinkFloor::new(thesis(), vec![setup]);
        floor.all_ready();
        floor
    }

    /// Its robot gets a job and drives.
    fn drives(&mut self) -> Vec<JobId> {
        let jobs = self.submit_deliveries(1);
        self.until(60, "it drives", |f| f.pairs[0].speed_mps() > 0.5);
        jobs
    }

    /// The session with the robot hears this, from whomever.
    pub(super) fn says(&mut self, said: RobotHeard) {
        let (out, mut inputs) = (self.pairs[0].session.hear(self.now, said), Vec::new());
        self.take(0, out, &mut inputs);
        self.step(inputs);
    }

    /// What the robot was told since a time: `order`, or the type of an instant action.
    pub(super) fn told_since(&self, since: Time) -> Vec<&str> {
        let told = self.pairs[0].told.iter().filter(|(at, ..)| *at >= since);
        told.flat_map(|(.., message)| match message {
            Message::InstantActions(actions) => actions.iter().map(|a| a.kind.as_str()).collect(),
            Message::Order(_) => vec!["order"],
            _ => Vec::new(),
        })
        .collect()
    }

    pub(super) fn orders(&self) -> Vec<&Order> {
        let told = self.pairs[0].told.iter();
        told.filter_map(|(.., message)| if let Message::Order(order) = message { Some(order) } else { None })
            .collect()
    }
}

/// opentcs-commadapter-vda5050 #14.
#[test]
fn a_retained_online_that_is_heard_after_a_reconnect_is_not_taken_for_old() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_0));
    floor.run(3);
    floor.says(RobotHeard::Connection(ConnectionState::Broken));
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), Some(NotReady::ConnectionBroken));
    // The broker gives out again what it keeps: that has no newer stamp and no greater number.
    floor.says(RobotHeard::Connection(ConnectionState::Online));
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), None);
}

/// opentcs-commadapter-vda5050 #11.
#[test]
fn a_last_will_counts_although_its_stamp_is_older_than_all_that_the_robot_said() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_1));
    floor.drives();
    // A connection has no stamp where it is judged: the order of arrival is all that counts.
    floor.says(RobotHeard::Connection(ConnectionState::Broken));
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), Some(NotReady::ConnectionBroken));
}

/// vda-5050-lib #38.
#[test]
fn a_robot_that_is_never_said_to_be_online_again_is_online_as_soon_as_it_says_a_state() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_0));
    let jobs = floor.drives();
    floor.says(RobotHeard::Connection(ConnectionState::Broken));
    floor.until_done(&jobs, 1800);
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), None);
}

/// opentcs-commadapter-vda5050 #1 and #2.
#[test]
fn a_robot_that_began_anew_while_its_order_was_being_cancelled_is_not_told_to_cancel_for_ever() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_1));
    let jobs = floor.drives();
    let begun = floor.now;
    // The robot hears nothing of it: it is switched off, and on again where it stands.
    floor.chance.lost = 1.0;
    floor.pairs[0].session.begin_cancel(begun, None);
    floor.until(30, "it stands", |f| f.pairs[0].speed_mps() == 0.0);
    floor.reboot(0);
    floor.chance.lost = 0.0;
    floor.until_done(&jobs, 1800);
    let cancels = floor.told_since(begun).iter().filter(|kind| **kind == "cancelOrder").count();
    assert!(cancels <= 3, "{cancels}");
}

/// opentcs-commadapter-vda5050 #3.
#[test]
fn a_robot_that_has_said_no_state_for_long_is_not_shown_as_idle() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_1));
    let robot = floor.pairs[0].number.expect("it has joined");
    floor.run(60);
    assert_eq!(floor.fleet.why(robot), None, "it is idle");
    floor.pairs[0].robot.robot.lose_broker();
    floor.run(120);
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), Some(NotReady::Silent));
    assert!(floor.fleet.why(robot).is_some(), "it is silent");
}

/// opentcs #275.
#[test]
fn an_idle_robot_is_asked_again_and_again_how_it_is() {
    let mut quiet = standard(Version::V2_0);
    quiet.state_interval_us = i64::MAX / 2;
    quiet.visualization_interval_us = None;
    let mut floor = LinkFloor::with_one(quiet);
    floor.run(30);
    let since = floor.now;
    floor.run(600);
    let asked = floor.told_since(since).iter().filter(|kind| **kind == "stateRequest").count();
    assert!((10..=30).contains(&asked), "{asked} times in ten minutes");
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), None);
}

/// opentcs-commadapter-vda5050 #9.
#[test]
fn a_robot_is_taken_whether_it_is_automatic_at_first_contact_or_becomes_so_later() {
    for later in [false, true] {
        let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_0)]);
        if later {
            floor.pairs[0].robot.robot.set_mode(OperatingMode::Manual);
            floor.run(20);
            let not_ready = floor.pairs[0].session.not_ready(floor.now);
            assert_eq!(not_ready, Some(NotReady::Mode(OperatingMode::Manual)));
            floor.pairs[0].robot.robot.set_mode(OperatingMode::Automatic);
        }
        floor.all_ready();
    }
}

/// The same adapter: the robot answers such an order with an error.
#[test]
fn no_order_is_sent_while_the_one_before_is_being_cancelled() {
    for version in Version::ALL {
        let mut floor = LinkFloor::with_one(standard(version));
        floor.delay = Span::from_millis(400);
        let jobs = floor.drives();
        let begun = floor.now;
        floor.pairs[0].session.begin_cancel(begun, None);
        while matches!(floor.pairs[0].session.order, super::super::order::OrderLife::Cancels { .. }) {
            assert!(!floor.told_since(begun).contains(&"order"), "{:?}", floor.told_since(begun));
            floor.step(Vec::new());
        }
        floor.until_done(&jobs, 1800);
    }
}

/// opentcs-commadapter-vda5050 #12.
#[test]
fn no_horizon_is_left_to_a_robot_that_has_parked() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_1));
    let jobs = floor.submit_deliveries(2);
    floor.until_done(&jobs, 1800);
    floor.run(300);
    assert!(floor.orders().iter().any(|order| order.nodes.iter().any(|node| !node.released)));
    let state = floor.pairs[0].robot.robot.state();
    assert!(state.nodes.is_empty() && state.edges.is_empty(), "{state:?}");
}

/// opentcs-commadapter-vda5050 #16.
#[test]
fn no_place_is_freed_under_a_robot_by_nodes_that_its_state_leaves_out() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_0));
    let jobs = floor.drives();
    let (_, state) = floor.pairs[0].session.state().expect("it was heard");
    let state = State { nodes: Vec::new(), edges: Vec::new(), ..state.clone() };
    let before = floor.pairs[0].session.progress.clone().expect("it has joined").reached;
    let stamp = MessageStamp { id: floor.pairs[0].next, timestamp: format!("{:020}", floor.now.0) };
    floor.pairs[0].next += 1;
    let out = floor.pairs[0].session.hear(floor.now, RobotHeard::State(Box::new(state), stamp));
    assert_eq!(floor.pairs[0].session.progress.clone().expect("it has joined").reached, before);
    floor.take(0, out, &mut Vec::new());
    floor.until_done(&jobs, 1800);
}

/// VDA5050 #624.
#[test]
fn a_robot_that_is_switched_on_where_another_was_promised_to_drive_stops_that_one_in_time() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_1));
    let driver = floor.pairs[0].number.expect("it has joined");
    let jobs = floor.submit_deliveries(4);
    floor.until(300, "a long route", move |f| node_ahead(f, driver).is_some());
    let node = node_ahead(&floor, driver).expect("there is one");
    floor.switch_on(standard(Version::V2_0), node);
    floor.until(5, "the newcomer is on the floor", |f| f.pairs[1].number.is_some());
    // The laws of the floor are checked in every step: the two never touch.
    floor.until_done(&jobs, 1800);
}

/// A node in the middle of a robot's route that it was not granted yet.
fn node_ahead(floor: &LinkFloor, robot: RobotId) -> Option<NodeId> {
    let chain = floor.fleet.ledger().chain(robot);
    let granted = chain.granted();
    chain.visits().zip(chain.first()..).find(|(_, serial)| *serial > granted + 2).map(|(visit, _)| visit.node)
}

/// VDA5050 #342.
#[test]
fn an_order_that_is_lost_is_sent_again() {
    for version in Version::ALL {
        let mut floor = LinkFloor::with_one(standard(version));
        let since = floor.now;
        let jobs = floor.submit_deliveries(1);
        floor.until(10, "an order is sent", |f| f.told_since(since).contains(&"order"));
        floor.pairs[0].to_robot.clear();
        floor.until(10, "it is sent again", |f| {
            f.told_since(since).iter().filter(|kind| **kind == "order").count() > 1
        });
        let orders = floor.orders();
        assert_eq!(orders[orders.len() - 1], orders[orders.len() - 2], "with the same content");
        floor.until_done(&jobs, 1800);
    }
}

/// VDA5050 #531.
#[test]
fn an_order_that_is_no_update_always_has_a_new_id() {
    let mut floor = LinkFloor::with_one(standard(Version::V3_0));
    let jobs = floor.submit_deliveries(4);
    for seconds in [10, 30, 20] {
        floor.run(seconds);
        floor.restart();
    }
    floor.until_done(&jobs, 1800);
    let mut orders = floor.orders();
    orders.dedup();
    let mut ids: Vec<&String> = orders.iter().filter(|o| o.update == 0).map(|order| &order.id).collect();
    let all = ids.len();
    ids.sort();
    ids.dedup();
    assert!(ids.len() == all && all > 8, "{all}");
}

/// ros_amr_interop #58: the observer of orders checks each update.
#[test]
fn an_update_is_stitched_at_the_end_of_the_base_although_a_horizon_was_announced() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_0));
    let jobs = floor.submit_deliveries(2);
    floor.until_done(&jobs, 1800);
    let orders = floor.orders();
    let announces = |order: &Order| order.nodes.iter().any(|node| !node.released);
    let stitched = orders.windows(2).filter(|o| announces(o[0]) && o[0].id == o[1].id && o[0] != o[1]);
    assert!(stitched.count() > 3, "{orders:?}");
}

/// ros_amr_interop #76.
#[test]
fn an_instant_action_that_runs_for_long_keeps_back_no_order() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_1));
    let jobs = floor.submit_deliveries(2);
    let (id, out) = floor.pairs[0].session.act(floor.now, "beep", Vec::new()).expect("it is sent");
    floor.take(0, out, &mut Vec::new());
    let (kind, status) = (Some("beep".into()), ActionStatus::Running);
    floor.pairs[0].says_also = Some(ActionState { id: id.clone(), kind, status, result: None });
    floor.until_done(&jobs, 1800);
    let sent = floor.pairs[0].session.sent_action(&id).and_then(|sent| sent.status);
    assert_eq!(sent, Some(ActionStatus::Running));
}

/// VDA5050 #269.
#[test]
fn an_action_that_failed_keeps_back_no_later_order() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_0));
    floor.pairs[0].robot.robot.set_handling_fault(true);
    floor.submit_deliveries(1);
    floor.until(300, "the pick fails", |f| f.pairs[0].session.failure().is_some());
    floor.run(5);
    floor.pairs[0].robot.robot.set_handling_fault(false);
    floor.pairs[0].session.settle(None);
    let all: Vec<JobId> = floor.fleet.ledger().jobs.keys().copied().collect();
    floor.until(1800, "every job ends", move |f| all.iter().all(|job| f.ended.contains_key(job)));
    assert!(floor.ended.values().all(|state| *state == JobState::Done), "{:?}", floor.ended);
}

/// rumqtt #211.
#[test]
fn nothing_that_was_meant_for_a_robot_while_the_line_was_down_is_sent_afterwards() {
    let mut floor = LinkFloor::with_one(standard(Version::V2_1));
    floor.drives();
    let begun = floor.now;
    let out = floor.pairs[0].session.line_is_down(begun);
    floor.take(0, out, &mut Vec::new());
    floor.step(vec![Input::ask(5, giveway_fleet::FloorAction::Halt(None))]);
    floor.run(20);
    assert_eq!(floor.told_since(begun), [""; 0]);
    let back = floor.now;
    let out = floor.pairs[0].session.line_is_back(back);
    floor.take(0, out, &mut Vec::new());
    floor.run(5);
    let told = floor.told_since(back);
    assert!(told.contains(&"stateRequest") && told.contains(&"startPause"), "{told:?}");
    assert!(!told.contains(&"order"), "the floor is halted: {told:?}");
}

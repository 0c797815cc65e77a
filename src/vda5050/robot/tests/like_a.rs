//! Robot A, npm `vda-5050-lib` 1.4.0: each line of `data/vda5050/README.md` that the preset shows.

use super::*;
use crate::TopicKind;
use crate::model::error::ErrorLevel;
use crate::robot::GarbledMessage;
use serde_json::json;

fn robot() -> RobotBench {
    RobotBench::new(RobotSetup::like_a())
}

#[test]
fn key_must_be_instant_actions_with_actions_alone_a_validation_error_and_nothing_happens() {
    let mut bench = robot();
    let key = bench.robot.robot.setup().quirks.instant_actions_key;
    assert!(!key.understands(true, false) && key.understands(false, true) && key.understands(true, true));
    bench.robot.robot.receive_unreadable(TopicKind::InstantActions, GarbledMessage::WrongForm);
    bench.run(0.1);
    let state = bench.states().last().cloned().expect("a state");
    assert_eq!(
        (state.errors[0].kind.as_str(), state.errors[0].level),
        ("validationError", ErrorLevel::Warning)
    );
}

#[test]
fn two_instant_actions_in_one_message_and_the_process_dies() {
    let mut bench = robot();
    let both = vec![action("stateRequest", "s1"), action("factsheetRequest", "f1")];
    bench.order(&short_order("o1"));
    bench.run(0.5);
    bench.said.clear();
    bench.hear(&[Message::InstantActions(both)]);
    assert!(!bench.robot.robot.is_alive() && !bench.robot.robot.is_online());
    let stood = bench.x();
    bench.instant("stateRequest", "s2");
    bench.run(60.0);
    assert!(bench.said.is_empty() && bench.x() - stood < 0.2);
    let position = bench.robot.robot.setup().position.clone();
    bench.robot.robot.reboot(position, "n0");
    bench.run(0.1);
    assert_eq!(bench.connections(), [ConnectionState::Online]);
}

#[test]
fn factsheet_not_sent_by_itself_on_request_the_header_and_nothing_else() {
    let mut bench = robot();
    assert!(bench.said.iter().all(|said| said.topic != TopicKind::Factsheet));
    bench.instant("factsheetRequest", "f1");
    let empty = Message::Factsheet(Box::default());
    assert!(bench.said.iter().any(|said| said.message == empty));
}

#[test]
fn order_accepted_the_first_state_still_lists_the_node_it_stands_on_the_second_one_does_not() {
    let mut bench = robot();
    bench.said.clear();
    bench.order(&short_order("o1"));
    let listed: Vec<usize> = bench.states().iter().map(|s| s.nodes.len()).collect();
    assert_eq!(listed, [2, 1]);
}

#[test]
fn same_number_again_same_or_different_content_silently_ignored_a_state_is_sent() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    let before = bench.states().len();
    bench.order(&order("o1", 0, 0, &[("n0", 0.0), ("elsewhere", 9.0)], 2));
    assert_eq!((bench.states().len(), bench.errors().len()), (before + 1, 0));
    assert_eq!(bench.nodes_left(), ["n1"]);
}

#[test]
fn lower_number_unknown_action_start_too_far_away_all_warning_all_kept_until_the_next_order_is_accepted() {
    let mut bench = robot();
    bench.order(&order("o0", 1, 0, &[("n0", 0.0)], 1));
    bench.order(&order("o0", 0, 0, &[("n0", 0.0)], 1));
    let mut unknown = short_order("o1");
    unknown.nodes[1].actions = vec![hard("juggle", "j1")];
    bench.order(&unknown);
    bench.order(&order("o2", 0, 0, &[("n9", 9.0)], 1));
    assert_eq!(bench.errors(), ["orderUpdateError", "orderError", "noRouteError"]);
    assert!(bench.state().errors.iter().all(|error| error.level == ErrorLevel::Warning));
    bench.order(&short_order("o3"));
    assert!(bench.errors().is_empty());
}

#[test]
fn text_that_is_no_json_dropped_without_a_state() {
    let mut bench = robot();
    let before = bench.states().len();
    bench.robot.robot.receive_unreadable(TopicKind::Order, GarbledMessage::NotJson);
    bench.run(1.0);
    assert_eq!((bench.states().len(), bench.errors().len()), (before, 0));
}

#[test]
fn update_that_resends_the_actions_of_the_stitching_node_and_it_is_never_idle_again_until_cancel_order() {
    let mut bench = robot();
    let epal = [("stationType", json!("floor")), ("loadType", json!("EPAL")), ("duration", json!(1))];
    let mut first = short_order("o1");
    first.nodes[1].actions = vec![with(hard("pick", "p1"), &epal)];
    bench.order(&first);
    bench.run(10.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Finished));
    let mut update = order("o1", 1, 2, &[("n1", 3.0), ("n2", 6.0)], 2);
    update.nodes[0].actions = first.nodes[1].actions.clone();
    bench.order(&update);
    bench.run(30.0);
    assert_eq!(bench.x(), 6.0, "it finishes the route");
    let listed: Vec<ActionStatus> = bench.state().actions.iter().map(|a| a.status).collect();
    assert_eq!(listed, [ActionStatus::Finished, ActionStatus::Waiting]);
    bench.order(&order("o2", 0, 0, &[("x", 5.9), ("n1", 3.0)], 2));
    assert_eq!(bench.errors(), ["orderError"]);
    bench.instant("cancelOrder", "c1");
    bench.order(&order("o3", 0, 0, &[("n2", 6.0), ("n1", 3.0)], 2));
    bench.run(10.0);
    assert_eq!((bench.x(), bench.errors().len()), (3.0, 0));
}

#[test]
fn new_order_while_one_is_active_starting_at_the_end_of_its_base_stitched_whatever_its_order_id() {
    let mut bench = robot();
    bench.order(&order_with_horizon());
    bench.run(1.0);
    let mut next = order("o2", 0, 0, &[("n1", 3.0), ("m2", 5.0)], 2);
    let epal = [("stationType", json!("floor-3")), ("loadType", json!("EPAL"))];
    next.nodes[0].actions = vec![with(hard("pick", "p1"), &epal)];
    bench.order(&next);
    assert_eq!((bench.state().order.as_str(), bench.errors().len()), ("o2", 0));
    assert_eq!(bench.nodes_left(), ["n1", "m2"]);
    bench.run(2.0);
    assert_eq!((bench.x(), bench.status("p1")), (3.0, Some(ActionStatus::Initializing)));
    bench.run(20.0);
    assert_eq!((bench.x(), bench.status("p1")), (5.0, Some(ActionStatus::Finished)));
}

#[test]
fn pick_and_drop_need_floor_and_epal_and_initialize_for_a_second() {
    let mut bench = robot();
    let mut driven = short_order("o1");
    driven.nodes[0].actions = vec![hard("pick", "p1")];
    bench.order(&driven);
    assert_eq!(bench.errors(), ["orderError"]);
    let epal = [("stationType", json!("floor")), ("loadType", json!("EPAL")), ("duration", json!(2))];
    driven.nodes[0].actions = vec![with(hard("pick", "p1"), &epal)];
    bench.order(&driven);
    bench.run(0.5);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Initializing));
    bench.run(1.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Running));
    bench.run(2.0);
    assert_eq!(bench.status("p1"), Some(ActionStatus::Finished));
    assert_eq!(bench.state().loads.map(|l| l.len()), Some(1));
}

#[test]
fn start_pause_finished_within_one_tick_and_a_second_one_failed_instant_action_error() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    bench.run(1.0);
    bench.instant("startPause", "a1");
    bench.run(0.2);
    assert_eq!((bench.status("a1"), bench.state().paused), (Some(ActionStatus::Finished), Some(true)));
    bench.instant("startPause", "a2");
    assert_eq!(bench.status("a2"), Some(ActionStatus::Failed));
    assert_eq!(bench.errors(), ["instantActionError"]);
}

#[test]
fn cancel_order_stands_where_it_is_and_without_an_order_no_action_state_at_all() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    bench.run(1.0);
    bench.instant("cancelOrder", "c1");
    assert_eq!(bench.status("c1"), Some(ActionStatus::Running));
    bench.run(0.3);
    assert_eq!((bench.status("c1"), bench.nodes_left().len()), (Some(ActionStatus::Finished), 0));
    assert!(bench.x() > 1.0 && bench.x() < 2.0);
    bench.instant("cancelOrder", "c2");
    assert_eq!((bench.status("c2"), bench.errors()), (None, vec!["noOrderToCancel".to_owned()]));
}

#[test]
fn after_that_order_from_the_last_node_no_route_error_its_tolerance_is_half_a_metre() {
    let mut bench = robot();
    bench.order(&short_order("o1"));
    bench.run(1.0);
    bench.instant("cancelOrder", "c1");
    bench.run(0.3);
    // The caller leaves a deviation out that is spelled `…XY`; one in the robot's own spelling is read.
    let mut next = order("o2", 0, 0, &[("n0", 0.0), ("n1", 3.0)], 2);
    bench.order(&next);
    assert_eq!(bench.errors(), ["noRouteError"]);
    next.nodes[0].position.as_mut().expect("given").deviation_m = Some(3.0);
    bench.order(&Order { id: "o3".to_owned(), ..next });
    assert!(bench.errors().is_empty());
    bench.instant("cancelOrder", "c2");
    bench.run(0.3);
    bench.order(&order("o4", 0, 0, &[("~a1", bench.x() + 0.4), ("n1", 3.0)], 2));
    assert!(bench.errors().is_empty(), "from a temporary node at its pose: accepted");
}

#[test]
fn start_charging_orders_are_refused_while_it_charges_also_one_whose_first_action_is_stop_charging() {
    let mut bench = robot();
    bench.instant("startCharging", "s1");
    assert!(bench.state().power.charging);
    let mut driven = short_order("o1");
    driven.nodes[0].actions = vec![hard("stopCharging", "s2")];
    bench.order(&driven);
    assert_eq!(bench.errors(), ["orderError"]);
    bench.instant("stopCharging", "s3");
    bench.order(&short_order("o2"));
    assert!(bench.errors().is_empty());
    let mut bench = robot();
    bench.robot.robot.set_charge(0.999);
    bench.instant("startCharging", "s1");
    bench.run(5.0);
    assert!(!bench.state().power.charging, "at 100 % it stops by itself");
}

#[test]
fn new_base_request_never() {
    let mut bench = robot();
    bench.order(&order_with_horizon());
    bench.run(10.0);
    assert!(bench.x() == 3.0 && bench.states().iter().all(|s| !s.wants_base));
}

#[test]
fn nodes_stops_at_each_one_and_a_theta_on_the_first_node_off_its_heading_is_a_no_route_error() {
    let mut bench = robot();
    let mut driven = order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 3);
    driven.nodes[0].position.as_mut().expect("given").theta = Some(0.5);
    bench.order(&driven);
    assert_eq!(bench.errors(), ["noRouteError"]);
    driven.nodes[0].position.as_mut().expect("given").theta = Some(0.3);
    bench.order(&driven);
    while bench.x() < 3.0 {
        bench.run(0.05);
    }
    bench.run(0.1);
    assert_eq!((bench.x(), bench.stands()), (3.0, true));
    bench.run(5.0);
    assert_eq!(bench.x(), 6.0);
}

#[test]
fn back_after_a_loss_says_no_online_only_states_come_and_several_nodes_are_passed_in_one_state() {
    let mut bench = robot();
    bench.order(&order("o1", 0, 0, &[("n0", 0.0), ("n1", 3.0), ("n2", 6.0)], 3));
    bench.run(1.0);
    bench.robot.robot.lose_broker();
    bench.said.clear();
    bench.run(20.0);
    bench.robot.robot.find_broker();
    bench.run(5.0);
    assert!(bench.states().is_empty(), "it dropped all states meanwhile and has nothing new to say");
    bench.run(30.0);
    assert!(bench.connections().is_empty());
    assert_eq!(bench.states().first().map(|s| s.last_sequence), Some(4));
}

#[test]
fn finished_instant_actions_listed_in_five_states_then_dropped() {
    let mut bench = robot();
    bench.said.clear();
    bench.instant("stateRequest", "s1");
    for i in 2..8 {
        bench.instant("stateRequest", &format!("s{i}"));
    }
    let listed: Vec<bool> = bench.states().iter().map(|s| s.actions.iter().any(|a| a.id == "s1")).collect();
    assert_eq!(listed, [true, true, true, true, true, false, false]);
}

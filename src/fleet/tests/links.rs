//! What robots are reached by, and what their kinds cannot do: no order asks for more.

use super::*;
use giveway_floor::geometry::Pose;
use giveway_floor::text::Sentence;

const R0: RobotId = RobotId(0);

fn join(name: &str, node: NodeId, link: Option<&str>) -> Input {
    let (name, kind, link) = (name.into(), USUAL_KIND.into(), link.map(str::to_owned));
    Input::ask(7, RobotAction::Register { name, kind, node, link })
}

fn refused(why: RobotRefusal) -> Answered {
    Err(Refusal::Robot(why))
}

/// What a fleet with these links answers to robots that join, and which links they have then.
fn joins(links: &[&str], wanted: &[Option<&str>]) -> (Vec<Answered>, Vec<String>) {
    let links = links.iter().map(|l| (*l).to_owned()).collect();
    let mut fleet = Fleet::new(Arc::new(lab()), Settings { links, ..Settings::default() });
    let places = fleet.warehouse().nodes_where(NodeKind::is_lasting);
    let inputs = wanted.iter().enumerate().map(|(i, link)| join(&format!("robot-{i}"), places[i], *link));
    let replies = fleet.step(Time::ZERO, inputs.collect()).replies;
    let linked = fleet.ledger().robots.iter().map(|r| r.link.clone()).collect();
    (replies.into_iter().map(|reply| reply.answer).collect(), linked)
}

#[test]
fn a_robot_is_reached_by_a_link_of_the_floor_or_does_not_join() {
    let (answers, linked) = joins(&["sim"], &[None, Some("sim"), Some("mqtt")]);
    assert!(answers[0].is_ok() && answers[1].is_ok());
    assert_eq!(
        (&answers[2], linked),
        (&refused(RobotRefusal::UnknownLink), vec!["sim".into(), "sim".into()])
    );
    let (answers, linked) = joins(&["sim", "mqtt"], &[None, Some("mqtt")]);
    assert_eq!((&answers[0], answers[1].is_ok()), (&refused(RobotRefusal::WhichLink), true));
    assert_eq!(linked, ["mqtt"]);
    assert_eq!(joins(&["mqtt"], &[None]).1, ["mqtt"], "the only one");
    let (answers, linked) = joins(&[], &[None, Some("sim")]);
    assert_eq!(
        (answers, linked),
        (vec![refused(RobotRefusal::NoLink); 2], vec![]),
        "no robot would be heard of"
    );
}

#[test]
fn a_ledger_that_is_read_again_has_each_robot_at_its_link() {
    let settings = || Settings { links: vec!["sim".into(), "mqtt".into()], ..Settings::default() };
    let map = Arc::new(lab());
    let mut fleet = Fleet::new(map.clone(), settings());
    let node = map.nodes_where(|kind| kind == NodeKind::Parking)[0];
    let facts = fleet.step(Time::ZERO, vec![join("robot-1", node, Some("mqtt"))]).facts;
    let again = Fleet::restore(map, settings(), facts);
    assert_eq!((again.ledger().robots[R0].link.as_str(), again.link_state(R0)), ("mqtt", None));
    let without = Fleet::resume(again.ledger().clone(), Settings::default(), []);
    let state = without.link_state(R0).expect("its link is gone");
    assert_eq!(
        (state.reach, state.refuses.as_ref().map(Sentence::text)),
        (LinkReach::Lost, Some("the site has no link named mqtt"))
    );
}

fn link(state: LinkState) -> Vec<Input> {
    vec![Input::Link(R0, state)]
}

#[test]
fn a_robot_whose_link_is_down_is_silent_at_once_and_goes_on_when_it_is_up_again() {
    let mut floor = TestFloor::lab(1);
    let job = floor.submit(request(deliver(3)));
    floor.until(60, "it is on its way", |f| f.is(job, "assigned"));
    floor.step(link(LinkState { reach: LinkReach::Lost, ..LinkState::default() }));
    let granted = floor.fleet.ledger().chain(R0).granted();
    assert_eq!(floor.fleet.why(R0), Some(Why::Silent), "after no three seconds");
    floor.run(20);
    assert_eq!(floor.fleet.ledger().chain(R0).granted(), granted, "it is granted nothing");
    floor.step(link(LinkState::default()));
    floor.until_over(300);
    floor.assert_done_once(&[job]);
}

#[test]
fn a_robot_whose_link_takes_no_orders_gets_none_and_is_told_why() {
    let mut floor = TestFloor::lab(2);
    floor.step(link(LinkState {
        refuses: Some(Sentence::without_code("in manual mode")),
        ..LinkState::default()
    }));
    let jobs = floor.submit_batch(2);
    floor.until_over(600);
    floor.assert_done_once(&jobs);
    assert_eq!(floor.fleet.why(R0), Some(Why::Refused));
    let state = floor.fleet.view(floor.now).robots[0].link_state.clone().expect("it is not as usual");
    assert_eq!(
        (state.reach, state.refuses.as_ref().map(Sentence::text)),
        (LinkReach::ByReports, Some("in manual mode"))
    );
    assert_eq!(floor.fleet.ledger().chain(R0).granted(), 1, "the other one did both");
}

#[test]
fn no_robot_is_granted_more_visits_than_its_link_has_room_for() {
    for room in [1, 2] {
        let mut floor = TestFloor::lab(1);
        floor.step(link(LinkState { capacity: Some(room), ..LinkState::default() }));
        let job = floor.submit(request(deliver(3)));
        let mut most = 0;
        while !floor.fleet.ledger().jobs.is_empty() {
            floor.step(vec![]);
            let chain = floor.fleet.ledger().chain(R0);
            most = most.max(chain.granted() - chain.first() - 1);
            assert!(floor.now < Time::ZERO + Span::from_secs(900), "it gets on all the same");
        }
        assert_eq!(most, room as u64);
        floor.assert_done_once(&[job]);
    }
}

/// The orders to robots with these capabilities that deliver on the thesis' floor among people.
fn orders_to(capabilities: Capabilities) -> Vec<Command> {
    let mut scenario = scenario(6);
    scenario.site.kinds[0].capabilities = capabilities;
    scenario.workers = Workers { count: 3, enter_s: 5.0, ..Workers::default() };
    let mut floor = TestFloor::new(thesis(), &scenario);
    let jobs = floor.submit_batch(30);
    let mut orders = Vec::new();
    while !floor.fleet.ledger().jobs.is_empty() {
        let step = floor.step(vec![]);
        orders.extend(step.urgent.into_iter().chain(step.commands).map(|(_, command)| command));
        assert!(floor.now < Time::ZERO + Span::from_secs(3600), "not done: {:?}", floor.fleet.ledger().jobs);
    }
    floor.assert_done_once(&jobs);
    orders
}

#[test]
fn robots_that_can_do_everything_are_slowed_stopped_and_shown_no_horizon() {
    let orders = orders_to(Capabilities::default());
    let limits =
        |mps: fn(f64) -> bool| orders.iter().any(|c| matches!(c, Command::Limit(Some(limit)) if mps(*limit)));
    assert!(limits(|mps| mps == 0.0) && limits(|mps| mps > 0.0), "the person is met");
    let is_shown = |c: &Command| matches!(c, Command::Drive { horizon, .. } if !horizon.is_empty());
    assert!(!orders.iter().any(is_shown));
}

#[test]
fn robots_that_can_only_stop_are_stopped_and_their_links_told_how_fast_they_may_leave() {
    let can = Capabilities { limits: ObeyedLimits::Stops, revocation: false, ..Capabilities::default() };
    let orders = orders_to(can);
    let told: Vec<&Command> = orders.iter().filter(|c| !matches!(c, Command::Drive { .. })).collect();
    assert!(told.iter().all(|c| matches!(c, Command::Limit(_))), "{told:?}");
    assert!(told.contains(&&Command::Limit(Some(0.0))), "the person is met");
    let slow = told.iter().filter(|c| matches!(c, Command::Limit(Some(mps)) if *mps > 0.0)).count();
    let stops = told.iter().filter(|c| matches!(c, Command::Limit(Some(0.0)))).count();
    assert!(slow > 0 && slow < 20 * stops, "{slow} limits, {stops} stops: none is insisted on for ever");
}

#[test]
fn robots_that_obey_no_limit_are_told_none_and_granted_one_node_at_a_time() {
    let can = Capabilities {
        limits: ObeyedLimits::Nothing,
        revocation: false,
        drives_back: false,
        horizon_nodes: 2,
    };
    let (mut shown, mut most) = (0, 0);
    for order in orders_to(can) {
        let Command::Drive { grant, horizon, .. } = order else { panic!("{order:?}") };
        most = most.max(grant.serials().count() - 1);
        shown = shown.max(horizon.len());
    }
    // The visit where the robot arrives just now, and one more.
    assert_eq!((shown, most), (2, 2));
}

#[test]
fn a_robot_that_obeys_no_limit_is_not_told_what_it_was_granted_into_a_robot_that_stands_there_now() {
    let mut scenario = scenario(2);
    scenario.site.kinds[0].capabilities =
        Capabilities { limits: ObeyedLimits::Nothing, revocation: false, ..Capabilities::default() };
    let mut floor = TestFloor::new(thesis(), &scenario);
    floor.run(1);
    let reports: Vec<Telemetry> = floor.world.truth().map(|(_, seen)| seen).collect();
    // The order is lost on its way.
    let (mut now, mut turns) = (floor.now, 0);
    let mut step = |inputs: Vec<Input>, reports: &[Telemetry]| {
        (now, turns) = (now + Span::from_millis(100), turns + 1);
        let again = |seen: &Telemetry| Telemetry { seen: now, seq: seen.seq + turns, ..*seen };
        let seen = reports.iter().map(|seen| Input::Telemetry(again(seen)));
        floor.fleet.step(now, seen.chain(inputs).collect())
    };
    let job = JobAction::Submit(request(deliver(40)));
    let drives = |step: &Step| {
        step.commands
            .iter()
            .find(|(_, order)| matches!(order, Command::Drive { .. }))
            .map(|(robot, _)| *robot)
    };
    let first = step(vec![Input::ask(7, job)], &reports);
    let driver = drives(&first).expect("a robot is sent");
    // People push the other robot to just beyond the first lane.
    let Some((_, Command::Drive { waypoints, .. })) = first.commands.first() else { panic!("{first:?}") };
    let warehouse = thesis();
    let at = |waypoint: &Waypoint| warehouse.nodes[waypoint.node].at;
    let (from, to) = (at(&waypoints[0]), at(&waypoints[1]));
    let beyond = to + (to - from) * 0.4;
    let pushed = |seen: &Telemetry| match seen.robot == driver {
        true => *seen,
        false => Telemetry { pose: Pose { at: beyond, ..seen.pose }, ..*seen },
    };
    let reports: Vec<Telemetry> = reports.iter().map(pushed).collect();
    assert_eq!(drives(&step(vec![], &reports)), None);
    for _ in 0..20 {
        let step = step(vec![], &reports);
        assert!(drives(&step).is_none() && step.held_back.contains(&driver), "{step:?}");
    }
}

#[test]
fn a_robot_that_cannot_be_called_back_from_before_an_obstacle_goes_on_when_that_is_gone() {
    let mut scenario = scenario(1);
    scenario.site.kinds[0].capabilities = Capabilities { revocation: false, ..Capabilities::default() };
    let mut floor = TestFloor::new(lab(), &scenario);
    let job = floor.submit(request(deliver(3)));
    floor.until(60, "it drives", |f| f.world.truth().any(|(_, t)| t.speed_mps > 0.5));
    floor.world.afflict(R0, Fault::Obstructed, floor.now + Span::from_secs(60));
    floor.run(40);
    assert!(matches!(floor.fleet.why(R0), Some(Why::Obstructed(_))), "{:?}", floor.fleet.why(R0));
    floor.until_over(400);
    floor.assert_done_once(&[job]);
}

/// What the robot truly reports.
fn truth(floor: &TestFloor) -> Telemetry {
    floor.world.truth().find(|(r, _)| *r == R0).expect("it has a body").1
}

fn has_heard(fleet: &Fleet) -> bool {
    fleet.internals().writer.scene.robot(R0).is_some()
}

#[test]
fn a_fleet_that_takes_the_place_of_another_one_knows_what_links_said_to_it() {
    let mut floor = TestFloor::lab(1);
    floor.run(1);
    let busy =
        LinkState { refuses: Some(Sentence::without_code("somebody works on it")), ..LinkState::default() };
    floor.step(link(busy.clone()));
    let mut anew = Fleet::resume(floor.fleet.ledger().clone(), floor.fleet.settings().clone(), []);
    assert_eq!(anew.link_state(R0), None);
    anew.keep_links_of(&floor.fleet);
    assert_eq!(anew.link_state(R0), Some(&busy));
    let overtaken = Telemetry { seq: 1, speed_mps: 0.0, ..truth(&floor) };
    anew.step(floor.now, vec![Input::Telemetry(overtaken)]);
    assert!(!has_heard(&anew), "it was overtaken before the fleet was made anew");
}

#[test]
fn just_after_a_start_a_report_from_before_what_is_durable_is_not_where_its_robot_stands() {
    let mut floor = TestFloor::lab(1);
    floor.submit(request(deliver(3)));
    floor.run(1);
    let stood = Telemetry { speed_mps: 0.0, ..truth(&floor) };
    let stood = Telemetry { known: stood.reached, ..stood };
    floor.until(60, "it has left some nodes", |f| f.fleet.ledger().chain(R0).first() > stood.reached + 2);
    let ledger = floor.fleet.ledger().clone();
    let hears = |after_s: u64, report: Telemetry| {
        let mut fleet = Fleet::resume(ledger.clone(), floor.fleet.settings().clone(), []);
        fleet.step(floor.now, vec![]);
        let now = floor.now + Span::from_secs_f64(after_s as f64);
        let facts = fleet.step(now, vec![Input::Telemetry(report)]).facts;
        (has_heard(&fleet), facts.iter().any(|f| matches!(f, Fact::Route(RouteFact::Placed { .. }))))
    };
    assert_eq!(hears(1, stood), (false, false), "it was on its way already");
    assert_eq!(hears(1, truth(&floor)), (true, false), "it is where the ledger has it");
    assert_eq!(hears(4, stood), (true, true), "no later one has come: somebody pushed it back");
}

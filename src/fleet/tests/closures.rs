//! Areas closed for a time: known ahead, kept out of meanwhile, used before and after.

use super::*;
use giveway_floor::geometry::Point;
use giveway_floor::time::Window;

/// The lower middle aisle of the hall: six nodes, with racks on both sides that have no other way out.
const AISLE: [(f64, f64); 4] = [(5.8, 0.8), (6.2, 0.8), (6.2, 6.2), (5.8, 6.2)];

fn seconds(s: f64) -> Time {
    Time::from_secs_f64(s)
}

fn aisle(from_s: f64, until_s: f64) -> Closure {
    let outline = AISLE.iter().map(|(x, y)| Point::new(*x, *y).into()).collect();
    Closure {
        outline,
        nodes: Vec::new(),
        window: Window::new(seconds(from_s), seconds(until_s)),
        reason: "repair".into(),
        binds: Binds::Robots,
        series: None,
    }
}

/// Whether a robot at this place reaches into the aisle.
fn is_in(p: Point) -> bool {
    (p.x - 6.0).abs() < 0.5 && (0.5..6.5).contains(&p.y)
}

impl TestFloor {
    fn close(&mut self, area: Closure) -> giveway_floor::id::ClosureId {
        match self.step(vec![Input::ask(5, FloorAction::Close(area))]).replies.remove(0).answer {
            Ok(Answer::Closure(closure)) => closure,
            other => panic!("not closed: {other:?}"),
        }
    }

    fn inside(&self) -> Vec<RobotId> {
        self.world.truth().filter(|(_, t)| is_in(t.pose.at)).map(|(r, _)| r).collect()
    }

    /// Submits jobs at all racks in turn until then; returns how many robot-steps are spent in the aisle.
    fn busy_until(&mut self, end: Time) -> usize {
        let mut spent = 0;
        while self.now < end {
            if self.fleet.ledger().jobs.len() < 20 {
                let next = self.fleet.ledger().next_job as usize;
                let rack = RackId::at(next * 7 % self.fleet.warehouse().racks.len());
                let station = StationId::at(next % self.fleet.warehouse().stations.len());
                self.submit(request(JobKind::Deliver { rack, station, pick: None }));
            }
            self.step(vec![]);
            spent += self.inside().len();
        }
        spent
    }

    /// Nodes with windows that a robot was promised, but not granted.
    fn promised(&self, robot: RobotId) -> Vec<(NodeId, Time, Time)> {
        let chain = self.fleet.ledger().chain(robot);
        let ahead = (chain.granted()..chain.end()).filter_map(|s| chain.get(s));
        ahead.map(|v| (v.node, v.enter, v.leave)).collect()
    }
}

#[test]
fn an_aisle_is_used_before_and_after_its_hour_and_empty_meanwhile() {
    let mut floor = TestFloor::thesis(10);
    floor.close(aisle(400.0, 700.0));
    let before = floor.busy_until(seconds(400.0));
    // A robot that was granted a way through may be on it for some seconds more.
    let first = floor.busy_until(seconds(415.0));
    let meanwhile = floor.busy_until(seconds(700.0));
    let after = floor.busy_until(seconds(1100.0));
    assert_eq!(meanwhile, 0, "{first} in the first seconds");
    assert!(first <= 100, "they drive out: {first}");
    assert!(before > 500 && after > 500, "{before} before, {after} after");
    assert!(floor.done() > 60, "{}", floor.done());
}

/// A node, closed from now on.
fn closed(floor: &TestFloor, names: &[&str], until: Time) -> Closure {
    let nodes: Vec<NodeId> = names.iter().map(|n| floor.node(n)).collect();
    let window = Window::new(floor.now, until);
    // People see the outline; the nodes alone count.
    let at = floor.fleet.warehouse().nodes[nodes[0]].at;
    let corners = [(-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)];
    let outline = corners.iter().map(|(x, y)| Point::new(at.x + x, at.y + y).into()).collect();
    Closure { outline, nodes, window, reason: "oil".into(), binds: Binds::Robots, series: None }
}

#[test]
fn a_rack_is_not_lifted_while_a_closed_area_cuts_its_station_off_and_goes_at_once_when_that_is_opened() {
    let mut floor = TestFloor::small(1);
    let closure = floor.close(closed(&floor, &["a2"], Time::MAX));
    let deliver = request(JobKind::Deliver { rack: RackId(0), station: StationId(0), pick: None });
    let job = floor.submit(deliver);
    floor.run(60);
    assert_eq!(
        (floor.state(job), floor.why_job(job)),
        (Some(JobState::Waiting), Some(JobWhy::WayClosed(closure)))
    );
    assert_eq!(floor.where_is(RobotId(0)), floor.node("c"), "the robot stays free");
    let go = floor.go(RobotId(0), floor.node("s1"));
    floor.until(60, "it does its other jobs", |f| f.state(go).is_none());
    floor.step(vec![Input::ask(6, FloorAction::Reopen(closure))]);
    floor.until(60, "it begins", |f| f.is(job, "assigned"));
    floor.until_over(120);
}

#[test]
fn a_robot_is_not_sent_to_a_place_that_a_closed_area_cuts_off_and_goes_when_that_is_opened() {
    let mut floor = TestFloor::small(1);
    let closure = floor.close(closed(&floor, &["a2"], Time::MAX));
    let goal = floor.node("p");
    let go = floor.go(RobotId(0), goal);
    floor.run(30);
    assert_eq!(
        (floor.state(go), floor.why_job(go)),
        (Some(JobState::Waiting), Some(JobWhy::WayClosed(closure)))
    );
    floor.step(vec![Input::ask(6, FloorAction::Reopen(closure))]);
    floor.until(60, "it goes", |f| f.state(go).is_none());
}

#[test]
fn a_robot_with_a_rack_sets_it_down_when_a_closed_area_cuts_its_station_off() {
    let mut floor = TestFloor::thesis(1);
    let deliver = request(JobKind::Deliver { rack: RackId(0), station: StationId(0), pick: None });
    let job = floor.submit(deliver);
    floor.until(120, "it carries the rack", |f| f.is(job, "carrying"));
    let station = floor.fleet.warehouse().stations[StationId(0)].node;
    let name = floor.fleet.warehouse().nodes[station].name.clone();
    let closure = floor.close(closed(&floor, &[&name], Time::MAX));
    floor.until(120, "it gives the job back and sets the rack down", |f| {
        f.is(job, "waiting") && matches!(f.rack(0), RackAt::Stored(_))
    });
    assert_eq!(floor.why_job(job), Some(JobWhy::WayClosed(closure)));
    floor.step(vec![Input::ask(6, FloorAction::Reopen(closure))]);
    floor.until_over(200);
    assert_eq!(floor.story(job).last(), Some(&"done"));
}

#[test]
fn before_an_area_is_closed_it_is_said_what_that_cuts_off_and_which_jobs_are_under_way_through_it() {
    let mut floor = TestFloor::small(1);
    let area = closed(&floor, &["a2"], Time::MAX);
    let deliver = request(JobKind::Deliver { rack: RackId(0), station: StationId(0), pick: None });
    let waits = floor.submit(deliver.clone());
    let effect = floor.fleet.effect_of_closing(&area, floor.now);
    assert_eq!((effect.nodes, effect.stations), (1, vec![StationId(0)]));
    assert_eq!(effect.under_way.total + effect.waiting.total, 1, "{waits:?}");
    floor.until(60, "it is carried", |f| f.is(waits, "carrying"));
    let next = floor.submit(JobRequest {
        kind: JobKind::Deliver { rack: RackId(1), station: StationId(0), pick: None },
        ..deliver
    });
    floor.run(1);
    let effect = floor.fleet.effect_of_closing(&area, floor.now);
    assert_eq!((effect.under_way.first, effect.waiting.first), (vec![(waits, RobotId(0))], vec![next]));
    assert!(
        effect.clear.is_some_and(|at| floor.now < at && at < floor.now + Span::from_secs(120)),
        "{:?}",
        effect.clear
    );
    let harmless = closed(&floor, &["p"], Time::MAX);
    let effect = floor.fleet.effect_of_closing(&harmless, floor.now);
    assert_eq!((effect.stations, effect.racks.total, effect.waiting.total), (vec![], 0, 0));
}

#[test]
fn a_robot_that_a_closed_area_shuts_in_is_named_before_and_names_the_area_after() {
    let mut floor = TestFloor::small(1);
    let deliver = request(JobKind::Deliver { rack: RackId(0), station: StationId(0), pick: None });
    let job = floor.submit(deliver);
    floor.until(120, "it is at the station", |f| f.is(job, "picking"));
    let area = closed(&floor, &["a2"], Time::MAX);
    let effect = floor.fleet.effect_of_closing(&area, floor.now);
    assert_eq!(effect.trapped.first, vec![RobotId(0)], "the lane out of the station leads through the area");
    let closure = floor.close(area);
    floor.run(30);
    assert_eq!(floor.fleet.why(RobotId(0)), Some(Why::Closed(closure)));
    floor.step(vec![Input::ask(6, FloorAction::Reopen(closure))]);
    floor.until_over(120);
}

#[test]
fn nobody_is_sent_for_a_rack_that_cannot_leave_while_others_are_served() {
    let mut floor = TestFloor::thesis(4);
    floor.close(aisle(0.0, 600.0));
    let w = floor.fleet.warehouse().clone();
    let behind = w.racks.pairs().find(|(_, r)| w.nodes[r.home].at == Point::new(5.0, 5.0)).map(|(k, _)| k);
    let deliver = |rack| request(JobKind::Deliver { rack, station: StationId(0), pick: None });
    let shut = floor.submit(deliver(behind.expect("the map has a rack there")));
    let open = floor.submit(deliver(RackId(0)));
    floor.until(400, "the other rack is served", |f| f.state(open).is_none());
    assert!(floor.now < seconds(600.0) && floor.is(shut, "waiting"));
    floor.until(900, "it is served when the aisle is open", |f| f.state(shut).is_none());
    assert!(floor.when(shut, "assigned") >= seconds(600.0));
}

#[test]
fn a_closure_that_is_announced_changes_routes_that_were_promised_before() {
    let mut floor = TestFloor::thesis(10);
    let mut changed = 0;
    while changed == 0 {
        floor.busy_until(floor.now + Span::from_secs(5));
        assert!(floor.now < seconds(600.0), "nobody drives through the aisle");
        // A person is to be in the aisle in twenty seconds or more.
        let soon = floor.now + Span::from_secs(20);
        let w = floor.fleet.warehouse().clone();
        let meets = |f: &TestFloor, r: RobotId, window: Window| {
            let in_aisle = |n: NodeId| is_in(w.nodes[n].at);
            f.promised(r).iter().any(|(n, a, b)| in_aisle(*n) && Window::new(*a, *b).overlaps(window))
        };
        let ids: Vec<RobotId> = floor.fleet.ledger().robots.ids().collect();
        let window = Window::new(soon, soon + Span::from_secs(600));
        let through: Vec<RobotId> = ids.into_iter().filter(|r| meets(&floor, *r, window)).collect();
        if through.is_empty() {
            continue;
        }
        let from_s = soon.as_secs_f64();
        floor.close(aisle(from_s, from_s + 600.0));
        floor.run(10);
        assert!(floor.now < soon, "before it begins");
        changed = through.iter().filter(|r| !meets(&floor, **r, window)).count();
        assert_eq!(changed, through.len(), "all of them were routed anew");
    }
    floor.run(60);
    assert_eq!(floor.inside(), [], "nobody is there when it is closed");
}

#[test]
fn robots_that_rest_inside_leave_before_it_begins() {
    let mut floor = TestFloor::lab(2);
    let robot = RobotId::at(0);
    let home = floor.fleet.ledger().node_of(robot);
    let at = floor.fleet.warehouse().nodes[home].at;
    let corners = [(-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)];
    let outline = corners.iter().map(|(x, y)| Point::new(at.x + x, at.y + y).into()).collect();
    let window = Window::new(seconds(60.0), seconds(600.0));
    floor.close(Closure {
        outline,
        nodes: Vec::new(),
        window,
        reason: "floor is painted".into(),
        binds: Binds::Robots,
        series: None,
    });
    floor.run(60);
    assert_ne!(floor.fleet.ledger().node_of(robot), home);
    assert!(floor.is_idle(robot), "and rests somewhere else");
}

#[test]
fn a_closure_survives_a_restart_and_is_forgotten_a_day_after_it_is_over() {
    let scenario = scenario(4);
    let mut floor = TestFloor::new(thesis(), &scenario);
    let closure = floor.close(aisle(60.0, 200.0));
    let warehouse = floor.fleet.warehouse().clone();
    floor.fleet = Fleet::restore(warehouse.clone(), scenario.site.settings(), floor.facts.clone());
    floor.world = World::new(warehouse, &scenario, &[], scenario.seed, floor.fleet.ledger(), floor.now);
    let state = |f: &TestFloor| f.fleet.view(f.now).closures[0].closure.state(f.now);
    assert_eq!(state(&floor), ClosureState::Announced);
    floor.busy_until(seconds(60.0));
    assert_eq!(state(&floor), ClosureState::Closed);
    floor.busy_until(seconds(75.0));
    assert_eq!(floor.busy_until(seconds(200.0)), 0);
    assert_eq!(state(&floor), ClosureState::Over);
    let day = Span::from_secs(24 * 3600 + 200);
    let step = floor.fleet.step(floor.now + day, vec![]);
    assert!(
        step.facts
            .iter()
            .any(|f| matches!(f, Fact::Area(AreaFact::Reopened { closure: c, .. }) if *c == closure))
    );
    assert_eq!(floor.fleet.view(floor.now + day).closures, []);
}

#[test]
fn a_job_behind_one_whose_goal_is_closed_does_not_pass_by_a_more_urgent_one_for_the_same_rack() {
    let mut floor = TestFloor::thesis(1);
    let w = floor.fleet.warehouse().clone();
    let is_free = |n: &NodeId| (0..w.racks.len()).all(|k| floor.rack(k as u32) != RackAt::Stored(*n));
    let storage = w.nodes.ids().filter(|n| w.kind(*n) == NodeKind::Storage && is_free(n));
    let free: Vec<NodeId> = storage.take(2).collect();
    floor.step(vec![Input::ask(5, FloorAction::Halt(Some(RobotId(0))))]);
    floor.close(closed(&floor, &[&w.nodes[free[0]].name], Time::MAX));
    let rack = RackId(0);
    let mut submit = |kind| {
        let job = floor.submit(request(kind));
        floor.run(20);
        job
    };
    let shut = submit(JobKind::Relocate { rack, node: free[0] });
    let deliver = submit(deliver(0));
    let relocate = submit(JobKind::Relocate { rack, node: free[1] });
    floor.step(vec![Input::ask(7, FloorAction::Release(Some(RobotId(0))))]);
    let waits = |f: &TestFloor| [shut, deliver, relocate].map(|job| f.is(job, "waiting"));
    floor.until(60, "one of them begins", |f| waits(f) != [true; 3]);
    assert_eq!(waits(&floor), [true, false, true], "the most urgent one that can be done");
}

//! People on the floor: a puppet that walks where it is told, or where it wants, and robots that give way.

use super::*;
use giveway_floor::geometry::Point;
use giveway_floor::id::{BodyId, WorkerId};
use giveway_people::human::{Quality, Sighting, SourceId};

const STEP_S: f64 = 0.1;

/// A person who walks along points at 1.2 m/s and stops before robots.
pub(super) struct Puppet {
    pub worker: WorkerId,
    pub at: Point,
    pub way: Vec<Point>,
    /// Whether the way is the puppet's own, not the one that was shown.
    pub own: bool,
    epoch: u32,
    seq: u64,
    pub waited_s: f64,
    /// The accuracy that the headset reports, one standard deviation, metres.
    pub accuracy_m: f64,
}

impl Puppet {
    pub(super) fn sighting(&mut self, now: Time) -> Input {
        self.seq += 1;
        Input::Sighted(Sighting {
            mirror: None,
            worker: self.worker,
            seen: now,
            epoch: self.epoch,
            at_marks: true,
            source: SourceId::Headset,
            seq: self.seq,
            at: self.at,
            heading: None,
            accuracy_m: self.accuracy_m,
            quality: Quality::Tracked,
        })
    }

    /// Seen where she did not walk to: the source's frame changed.
    pub(super) fn appear(&mut self, now: Time) -> Input {
        self.epoch += 1;
        self.sighting(now)
    }

    /// Goes on along the way for one period.
    pub(super) fn walk_on(&mut self, floor: &TestFloor) {
        let mut left = 1.2 * STEP_S;
        while let Some(next) = self.way.first().copied() {
            let to = next - self.at;
            if to.norm() < 1e-6 {
                self.way.remove(0);
                continue;
            }
            let stride = to.norm().min(left);
            let there = self.at + to * (stride / to.norm());
            let hits = |p: Point| giveway_floor::geometry::axis_distance(p, there) < 0.45 + 0.3;
            let nearer = |p: Point| (p - there).norm() < (p - self.at).norm();
            if floor.world.truth().any(|(_, t)| hits(t.pose.at) && nearer(t.pose.at)) {
                self.waited_s += STEP_S;
                return;
            }
            self.at = there;
            left -= stride;
            if left <= 1e-9 {
                return;
            }
        }
    }
}

impl TestFloor {
    pub(super) fn hire(&mut self, at: Point) -> Puppet {
        self.hire_as("Ana", at)
    }

    pub(super) fn hire_as(&mut self, name: &str, at: Point) -> Puppet {
        let reply =
            self.step(vec![Input::ask(1, WorkerAction::Register(name.into()))]).replies.remove(0).answer;
        let Ok(Answer::Worker(Made { id: worker, .. })) = reply else { panic!("not hired: {reply:?}") };
        Puppet { worker, at, way: vec![], own: false, epoch: 0, seq: 0, waited_s: 0.0, accuracy_m: 0.02 }
    }

    pub(super) fn assign(
        &mut self,
        puppet: &Puppet,
        place: NodeId,
        stay_s: i64,
    ) -> giveway_floor::id::AssignmentId {
        let (stay, what) = (Span::from_secs(stay_s), "pick".to_owned());
        let request = AssignmentRequest { place, stay, what, key: None };
        let input = Input::ask(2, WorkerAction::Assign { worker: Some(puppet.worker), request });
        match self.step(vec![input]).replies.remove(0).answer {
            Ok(Answer::Assignment(Made { id: assignment, .. })) => assignment,
            other => panic!("not assigned: {other:?}"),
        }
    }

    /// One period in which the puppet is seen, told and walks.
    pub(super) fn walk(&mut self, puppet: &mut Puppet) -> Step {
        let seen = puppet.sighting(self.now);
        let step = self.step(vec![seen]);
        let told = step.guidance.iter().rev().find(|(w, _)| *w == puppet.worker);
        if let Some((_, g)) = told.filter(|_| !puppet.own) {
            puppet.way = if g.state == GuidanceState::Stop { vec![] } else { g.path.clone() };
        }
        puppet.walk_on(self);
        // No person is run over: a robot that touches a person stands, or nearly.
        for (r, t) in self.world.truth() {
            let touches = giveway_floor::geometry::axis_distance(t.pose.at, puppet.at) < 0.45 + 0.2;
            assert!(!touches || t.speed_mps < 0.3, "{r:?} runs into somebody at {} m/s", t.speed_mps);
        }
        step
    }

    fn point(&self, name: &str) -> Point {
        self.fleet.warehouse().nodes[self.node(name)].at
    }

    pub(super) fn deviations(&self) -> usize {
        self.facts.iter().filter(|f| matches!(f, Fact::Encounter(EncounterFact::Deviated { .. }))).count()
    }
}

#[test]
fn a_worker_who_follows_the_path_does_the_assignment_and_never_deviates() {
    let mut floor = TestFloor::lab(2);
    let mut ana = floor.hire(floor.point("R32"));
    let place = floor.node("R116");
    floor.assign(&ana, place, 5);
    for _ in 0..400 {
        floor.walk(&mut ana);
    }
    assert_eq!(floor.fleet.ledger().counts.human_deliveries, 1);
    assert_eq!(floor.deviations(), 0);
}

#[test]
fn a_robot_beside_the_place_where_somebody_works_is_not_in_the_way() {
    let mut floor = TestFloor::thesis(1);
    let w = floor.fleet.warehouse().clone();
    let place = w.nodes_where(|k| k == NodeKind::Storage)[20];
    let go = JobKind::Go { robot: RobotId(0), node: place };
    let request = JobRequest { priority: 5, ..JobRequest::new(go) };
    floor.step(vec![Input::ask(1, JobAction::Submit(request))]);
    let robot = |floor: &TestFloor| floor.world.truth().next().unwrap().1.pose.at;
    while (robot(&floor) - w.nodes[place].at).norm() > 0.01 {
        floor.step(vec![]);
    }
    floor.step(vec![Input::ask(2, FloorAction::Halt(Some(RobotId(0))))]);
    // She cannot stand just where her path ends, which is too near to the robot.
    let end = floor.fleet.internals().people.walkways.on_floor(w.nodes[place].at).expect("people get there");
    let mut ana = floor.hire(end + (end - w.nodes[place].at).normalize() * 0.3);
    ana.own = true;
    floor.assign(&ana, place, 10);
    for _ in 0..200 {
        floor.walk(&mut ana);
    }
    assert!((robot(&floor) - w.nodes[place].at).norm() < 0.1, "the robot had no reason to leave");
    assert_eq!(
        floor.fleet.ledger().counts.human_deliveries,
        1,
        "she is at {} of {}",
        ana.at,
        w.nodes[place].at
    );
}

#[test]
fn robots_deliver_and_a_worker_works_and_then_stands_about_on_the_same_floor() {
    let mut floor = TestFloor::thesis(8);
    floor.submit_batch(60);
    let exits = floor.fleet.warehouse().nodes_where(|k| k == NodeKind::Aisle);
    let mut ana = floor.hire(floor.fleet.warehouse().nodes[exits[0]].at);
    for i in 0..12 {
        floor.assign(&ana, exits[(i * 37 + 20) % exits.len()], 4);
    }
    for _ in 0..6000 {
        floor.walk(&mut ana);
    }
    let counts = floor.fleet.ledger().counts;
    assert!(counts.human_deliveries >= 10, "{counts:?}, waited {} s", ana.waited_s);
    assert!(counts.robot_deliveries >= 25, "{counts:?}");
    assert_eq!(floor.deviations(), 0);
    // With her work done she stands in an aisle for good. Robots that were on their way past her, or to places
    // beside her, find others instead of waiting for her and holding up the rest.
    let before = counts.robot_deliveries;
    floor.submit_batch(40);
    for _ in 0..2000 {
        floor.walk(&mut ana);
    }
    let after = floor.fleet.ledger().counts.robot_deliveries;
    assert!(after >= before + 10, "{before} before, {after} after");
}

#[test]
fn whoever_leaves_the_path_is_found_out_within_a_second_and_shown_a_new_one() {
    let mut floor = TestFloor::thesis(2);
    let w = floor.fleet.warehouse().clone();
    let aisles = w.nodes_where(|k| k == NodeKind::Aisle);
    let start = aisles[0];
    let mut ana = floor.hire(w.nodes[start].at);
    floor.assign(&ana, *aisles.last().unwrap(), 4);
    for _ in 0..30 {
        floor.walk(&mut ana);
    }
    assert_eq!(floor.deviations(), 0);
    // Back to where she came from.
    (ana.own, ana.way) = (true, vec![w.nodes[start].at]);
    let before = floor.now;
    while floor.deviations() == 0 {
        floor.walk(&mut ana);
        assert!(floor.now - before < Span::from_secs(3), "nobody noticed");
    }
    ana.own = false;
    for _ in 0..400 {
        floor.walk(&mut ana);
    }
    assert_eq!(floor.fleet.ledger().counts.human_deliveries, 1, "the new path leads there, too");
}

#[test]
fn a_pose_calls_for_a_stop_while_nobody_was_told_and_only_if_it_can_be_true() {
    let mut floor = TestFloor::thesis(6);
    floor.submit_batch(20);
    floor.run(40);
    let calls = |floor: &TestFloor, input: &Input| {
        let Input::Sighted(s) = input else { panic!("{input:?}") };
        floor.fleet.calls_for_stop(s, floor.now)
    };
    let mut ana = floor.hire(floor.fleet.warehouse().bounds().0);
    let first = ana.sighting(floor.now);
    assert!(calls(&floor, &first), "nobody has seen her before");
    floor.step(vec![first]);
    assert!(!calls(&floor, &ana.sighting(floor.now)), "no robot is near");
    ana.at = Point::new(1e6, 0.0);
    assert!(!calls(&floor, &ana.sighting(floor.now)), "nobody can be there");
    ana.worker = WorkerId(9);
    assert!(!calls(&floor, &ana.sighting(floor.now)), "nobody hired her");
    let (_, t) = floor.world.truth().find(|(_, t)| t.speed_mps > 1.0).expect("somebody drives");
    let ahead = giveway_floor::geometry::Vector::new(t.pose.heading.cos(), t.pose.heading.sin());
    (ana.worker, ana.at) = (WorkerId(0), t.pose.at + ahead * 1.4);
    let near = ana.appear(floor.now);
    assert!(calls(&floor, &near), "she is in front of a robot");
    let step = floor.step(vec![near]);
    assert!(step.urgent.iter().any(|(_, c)| *c == Command::Limit(Some(0.0))));
    assert!(!calls(&floor, &ana.sighting(floor.now)), "all were told");
}

#[test]
fn a_stop_leaves_in_the_step_in_which_the_pose_arrives() {
    let mut floor = TestFloor::thesis(6);
    floor.submit_batch(20);
    floor.run(40);
    let (robot, t) = floor.world.truth().find(|(_, t)| t.speed_mps > 1.0).expect("somebody drives");
    let ahead = giveway_floor::geometry::Vector::new(t.pose.heading.cos(), t.pose.heading.sin());
    let mut ana = floor.hire(t.pose.at + ahead * 1.4);
    let seen = ana.sighting(floor.now);
    let step = floor.step(vec![seen]);
    let stop = step.urgent.iter().find(|(r, _)| *r == robot);
    assert_eq!(stop.map(|(_, c)| c.clone()), Some(Command::Limit(Some(0.0))));
    let told = &step.guidance.iter().find(|(w, _)| *w == ana.worker).unwrap().1;
    let because = Some(GuidanceReason::RobotComes(robot));
    assert_eq!((told.state, told.reason), (GuidanceState::Stop, because));
    assert_eq!(told.near[0].robot, robot);
}

#[test]
fn robots_keep_out_of_a_closed_area_until_it_is_open_again() {
    let mut floor = TestFloor::thesis(4);
    let w = floor.fleet.warehouse().clone();
    let (low, high) = w.bounds();
    let middle = (low.y + high.y) / 2.0;
    let outline = [
        (low.x - 1.0, middle),
        (high.x + 1.0, middle),
        (high.x + 1.0, middle + 0.1),
        (low.x - 1.0, middle + 0.1),
    ];
    let outline = outline.map(|(x, y)| Point::new(x, y).into()).to_vec();
    let window = giveway_floor::time::Window::new(Time::ZERO, Time(120_000_000));
    let area = Closure {
        outline: outline.clone(),
        nodes: vec![],
        window,
        reason: "a spill".into(),
        binds: Binds::Robots,
        series: None,
    };
    floor.step(vec![Input::ask(3, FloorAction::Close(area))]);
    floor.submit_batch(10);
    let inside = |p: Point| (p.y - (middle + 0.05)).abs() < 0.45;
    let were_inside: Vec<_> =
        floor.world.truth().filter(|(_, t)| inside(t.pose.at)).map(|(r, _)| r).collect();
    while floor.now < Time(118_000_000) {
        floor.step(vec![]);
        for (r, t) in floor.world.truth() {
            assert!(!inside(t.pose.at) || were_inside.contains(&r), "{r:?} is in the closed area");
        }
    }
    floor.until_over(900);
}

#[test]
fn a_worker_of_whom_nothing_is_heard_stops_robots_nearby_on_foot_until_cleared_and_no_others() {
    let mut floor = TestFloor::thesis(6);
    floor.submit_batch(40);
    floor.run(20);
    let middle = floor.fleet.warehouse().nodes.iter().nth(100).unwrap().at;
    let mut ana = floor.hire(middle);
    floor.walk(&mut ana);
    floor.run(25);
    let warehouse = floor.fleet.warehouse().clone();
    let reached = floor.fleet.internals().people.afoot.nodes_within(&warehouse, middle, 8.0);
    let is_reached = |n: NodeId| reached.iter().any(|(m, _)| *m == n);
    let moves = |r: &RobotId| floor.world.truth().any(|(robot, t)| robot == *r && t.speed_mps > 0.0);
    let ledger = floor.fleet.ledger();
    let within: Vec<RobotId> = ledger.present().filter(|r| is_reached(ledger.node_of(*r))).collect();
    assert!(!within.is_empty() && !within.iter().any(moves), "after 25 s she may be there");
    let before = floor.fleet.ledger().counts.robot_deliveries;
    assert!(
        floor.fleet.internals().yielding.state.giving_way().next().is_some(),
        "robots wait because of her"
    );
    floor.step(vec![Input::ask(4, WorkerAction::Clear { worker: ana.worker, by: "Ben".into() })]);
    assert!(floor.fleet.internals().yielding.state.giving_way().next().is_none(), "and nobody does any more");
    floor.run(120);
    assert!(floor.fleet.ledger().counts.robot_deliveries > before, "they go on");
}

#[test]
fn a_limit_that_a_robot_has_but_the_fleet_did_not_set_is_lifted() {
    let mut floor = TestFloor::thesis(2);
    floor.run(1);
    // As after a restart of the fleet, or where the server let all robots stand.
    let robots: Vec<_> = floor.fleet.ledger().robots.ids().collect();
    let limits: Vec<_> = robots.into_iter().map(|r| (r, Command::Limit(Some(0.0)))).collect();
    floor.world.take(floor.now, LinkOutput { limits: &limits, ..LinkOutput::default() });
    (0..3).for_each(|_| drop(floor.step(vec![])));
    assert!(floor.world.truth().all(|(_, t)| t.limit_mps == Some(0.0)), "they know it");
    floor.run(1);
    assert!(floor.world.truth().all(|(_, t)| t.limit_mps.is_none()));
}

#[test]
fn of_an_area_of_nodes_exactly_these_are_closed() {
    let mut floor = TestFloor::lab(1);
    let mut nodes = vec![floor.node("R30"), floor.node("R32")];
    nodes.sort_unstable();
    // Whatever outline is drawn around them.
    let outline = [(-9.0, -9.0), (99.0, -9.0), (0.0, 99.0)].map(|(x, y)| Point::new(x, y).into()).to_vec();
    let window = giveway_floor::time::Window::new(Time::ZERO, Time::MAX);
    let area = Closure {
        outline,
        nodes: nodes.clone(),
        window,
        reason: "posts".into(),
        binds: Binds::Robots,
        series: None,
    };
    floor.step(vec![Input::ask(3, FloorAction::Close(area.clone()))]);
    let mut closed: Vec<NodeId> =
        floor.fleet.internals().writer.restrictions.conditions.of(BodyId(0)).nodes().collect();
    closed.sort_unstable();
    assert_eq!(closed, nodes);
    let unknown = Closure { nodes: vec![NodeId(9999)], ..area };
    let refused = floor.step(vec![Input::ask(4, FloorAction::Close(unknown))]).replies;
    assert_eq!(refused, [Reply { token: 4.into(), answer: Err(Refusal::UnknownPlace) }]);
}

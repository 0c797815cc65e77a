//! The fleet with robots and a worker that move in steps; what may happen next, and what states have in common.
//!
//! Main types: [`TinyWorld`], [`TinyMove`].

use super::actors::{FootMove, FootWorker, HALF_M, StepRobot};
use super::floors::{LANE_M, Manner, TinyFloor, node_of};
use crate::{request, scenario};
use giveway_fleet::internals::Internals;
use giveway_fleet::{
    Fact, Fleet, Input, JobAction, JobFact, Reply, Request, RobotAction, RouteFact, StationOrder, Task,
    WorkerAction,
};
use giveway_floor::geometry::{Point, axis_distance};
use giveway_floor::id::{RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use std::fmt::Write;
use std::sync::Arc;

/// The fleet is stepped twice in a second, but keeps the period that it has elsewhere, since that decides how near
/// robots come to people.
const PERIOD: Span = Span::from_millis(500);
/// Between two decisions about which actors move, robots can drive a lane and the worker can walk as far.
pub(super) const QUANTUM_S: i64 = 2;

/// What happens in one quantum.
#[derive(Clone, Debug)]
pub(super) struct TinyMove {
    /// Which robots are not late.
    pub moves: Vec<bool>,
    /// What the worker does.
    pub worker: FootMove,
}

/// A fleet on a tiny floor.
#[derive(Clone)]
pub(super) struct TinyWorld {
    pub fleet: Fleet,
    pub robots: Vec<StepRobot>,
    pub worker: Option<FootWorker>,
    pub now: Time,
    /// When a robot last made progress, or a job ended.
    pub progress: Time,
}

impl TinyWorld {
    pub fn new(floor: &TinyFloor) -> TinyWorld {
        let scenario = scenario(floor.starts.len());
        let w = scenario.site.fit(&Arc::new(floor.build())).expect("the map is for these robots");
        let settings = scenario.site.settings();
        let kind = settings.site_kinds[0].name.clone();
        let nodes = floor.starts.iter().map(|name| node_of(&w, name));
        let robots = nodes.enumerate().map(|(i, n)| StepRobot::new(RobotId(i as u32), n, w.nodes[n].at));
        let robots: Vec<StepRobot> = robots.collect();
        let register = |r: &StepRobot| {
            let (name, kind) = (format!("robot {}", r.id.0), kind.clone());
            Input::ask(1, RobotAction::Register { name, kind, node: r.node, link: None })
        };
        let mut inputs: Vec<Input> = robots.iter().map(register).collect();
        let fleet = Fleet::new(w.clone(), settings);
        let mut world = TinyWorld { fleet, robots, worker: None, now: Time::ZERO, progress: Time::ZERO };
        if let Some(hired) = floor.worker {
            inputs.push(Input::ask(2, WorkerAction::Register("Ana".into())));
            world.worker = Some(FootWorker::new(WorkerId(0), w.nodes[node_of(&w, hired.at)].at));
        }
        world.step(None, inputs);
        let mut inputs = Vec::new();
        if let Some(to) = floor.worker.and_then(|h| h.assignment) {
            let (place, what) = (node_of(&w, to), "look".to_owned());
            let request =
                giveway_fleet::AssignmentRequest { place, stay: Span::from_secs(4), what, key: None };
            inputs.push(Input::ask(3, WorkerAction::Assign { worker: Some(WorkerId(0)), request }));
        }
        let jobs = floor.kinds(&w).into_iter();
        inputs.extend(jobs.map(|kind| Input::ask(4, JobAction::Submit(request(kind)))));
        world.step(None, inputs);
        world
    }

    pub fn warehouse(&self) -> Arc<Warehouse> {
        self.fleet.warehouse().clone()
    }

    pub fn person(&self) -> Option<Point> {
        self.worker.as_ref().map(|p| p.at)
    }

    /// One control period. In the middle of a second, `before` is the state of robots before that second.
    fn step(&mut self, before: Option<&[StepRobot]>, mut inputs: Vec<Input>) {
        let (w, now) = (self.warehouse(), self.now);
        for (i, robot) in self.robots.iter().enumerate() {
            inputs.push(Input::Telemetry(robot.report(&w, before.map(|b| &b[i]), now)));
            if before.is_none() && robot.acted >= Some(robot.reached) && self.fleet.is_picked_from(robot.id) {
                let order = StationOrder::Done;
                inputs.push(Input::ask(9, Request::Station(StationId(0), order)));
            }
        }
        inputs.extend(self.worker.as_mut().map(|p| Input::Sighted(p.sighting(before.is_some(), now))));
        let step = self.fleet.step(now, inputs);
        for reply in &step.replies {
            assert!(!matches!(reply, Reply { answer: Err(_), .. }), "{reply:?}");
        }
        let gets_on = |f: &Fact| {
            matches!(
                f,
                Fact::Route(RouteFact::Passed { .. } | RouteFact::Acted { .. })
                    | Fact::Job(JobFact::Progressed { .. })
            )
        };
        if step.facts.iter().any(gets_on) {
            self.progress = now;
        }
        for (robot, order) in step.urgent.iter().chain(&step.commands) {
            self.robots[robot.0 as usize].obey(order);
        }
        for (_, told) in step.guidance {
            self.worker.iter_mut().for_each(|p| p.hear(told.clone()));
        }
        self.now += PERIOD;
    }

    /// One quantum.
    pub fn take(&mut self, m: &TinyMove) {
        for _ in 0..QUANTUM_S {
            self.second(m);
        }
    }

    fn second(&mut self, m: &TinyMove) {
        let (w, person, before) = (self.warehouse(), self.person(), self.robots.clone());
        for (robot, moves) in self.robots.iter_mut().zip(&m.moves) {
            if *moves { robot.live(&w, person) } else { robot.rest(&w) }
        }
        let ways: Vec<(Point, Point)> = self.robots.iter().map(|r| (r.was_at, r.at(&w))).collect();
        if let Some(worker) = &mut self.worker {
            worker.live(m.worker, &ways);
        }
        self.step(Some(&before), Vec::new());
        self.step(None, Vec::new());
    }

    /// The worker leaves through a door.
    pub fn dismiss(&mut self) {
        if let Some(p) = self.worker.take() {
            self.step(None, vec![Input::ask(5, WorkerAction::Clear { worker: p.worker, by: "Ben".into() })]);
        }
    }

    /// Which robots would do something in a second in which they act.
    pub fn able(&self) -> Vec<bool> {
        let (w, person) = (self.warehouse(), self.person());
        self.robots.iter().map(|r| r.is_able(&w, person)).collect()
    }

    /// Whether a robot would drive if no person were before it.
    pub fn is_scanning(&self, robot: RobotId) -> bool {
        let (w, robot) = (self.warehouse(), &self.robots[robot.0 as usize]);
        !robot.is_able(&w, self.person()) && robot.is_able(&w, None)
    }

    /// All that may happen next: some of the robots that are able are late, but not all of them, and the worker does
    /// what a worker of this manner may do. Time passes alone only if no robot is able.
    pub fn moves(&self, manner: Manner) -> Vec<TinyMove> {
        let able = self.able();
        let count = able.iter().filter(|a| **a).count() as u32;
        let sets = (0..1u32 << count).filter(|set| *set > 0 || count == 0).map(|set| {
            let mut turn = 0;
            let mut moves = |a: &bool| {
                let is_late = *a && set >> turn & 1 == 0;
                turn += u32::from(*a);
                !is_late
            };
            able.iter().map(&mut moves).collect::<Vec<bool>>()
        });
        let steps = self.foot_moves(manner);
        sets.flat_map(|moves| steps.iter().map(move |s| TinyMove { moves: moves.clone(), worker: *s }))
            .collect()
    }

    fn foot_moves(&self, manner: Manner) -> Vec<FootMove> {
        let Some(at) = self.person() else { return vec![FootMove::Stays] };
        let mut all = vec![FootMove::Stays];
        match manner {
            Manner::Stands => {}
            Manner::Obeys => all.push(FootMove::Follows),
            Manner::Wanders => {
                let walkways = &self.fleet.internals().people.walkways;
                let near = |p: &Point| (0.1..LANE_M + 0.1).contains(&(p - at).norm());
                let free = |p: &Point| walkways.is_free(*p) && walkways.sees(at, *p);
                let places = self.fleet.warehouse().nodes.iter().map(|n| n.at);
                all.extend(places.filter(|p| near(p) && free(p)).map(FootMove::Towards));
            }
        }
        all
    }

    /// Asserts what must hold in every state: holds are sound, no two robots were granted the same floor, and no robot
    /// touches another.
    pub fn assert_lawful(&self) {
        let (w, ledger) = (self.warehouse(), self.fleet.ledger());
        ledger.timeline().assert_sound();
        let granted = |r: &StepRobot| {
            let chain = ledger.chain(r.id);
            (chain.first()..chain.granted()).filter_map(|s| chain.get(s)).map(|v| v.node).collect::<Vec<_>>()
        };
        for (i, a) in self.robots.iter().enumerate() {
            for b in &self.robots[..i] {
                let apart = axis_distance(a.at(&w), b.at(&w));
                assert!(apart > 2.0 * HALF_M - 1e-6, "{:?} and {:?} touch", a.id, b.id);
                let theirs = granted(b);
                for node in granted(a) {
                    let near = w.conflicts(w.node_resource(node));
                    let clash =
                        |m: &giveway_floor::id::NodeId| *m == node || near.contains(&w.node_resource(*m));
                    assert!(!theirs.iter().any(clash), "{:?} and {:?} were granted {node:?}", a.id, b.id);
                }
            }
        }
    }

    /// Whether no job is left.
    pub fn is_over(&self) -> bool {
        self.fleet.ledger().jobs.is_empty()
    }

    /// Whether a robot has nothing left to do.
    pub fn is_idle(&self, robot: RobotId) -> bool {
        self.fleet.ledger().robots[robot].task == Task::Idle
    }

    /// The key by which states are the same and explored once: all that decides, with times as ages in classes.
    pub fn key(&self) -> String {
        let mut key = String::new();
        self.robots.iter().for_each(|r| self.robot_key(r, &mut key));
        self.order_key(&mut key);
        for (id, job) in &self.fleet.ledger().jobs {
            _ = write!(key, "{}{}{:?};", id.0, job.state.word(), job.state.robot());
        }
        self.worker_key(&mut key);
        key
    }

    fn age(&self, since: Time) -> usize {
        let age = self.now - since;
        [2, 10, 20, 40, 60].iter().take_while(|s| age >= Span::from_secs(**s)).count()
    }

    fn robot_key(&self, r: &StepRobot, key: &mut String) {
        let Internals { writer, traffic, yielding, .. } = self.fleet.internals();
        let (chain, record) = (writer.ledger().chain(r.id), &writer.ledger().robots[r.id]);
        _ = write!(key, "{:?}{:?}{:?}", r.node, r.lane, r.path.iter().map(|p| p.node).collect::<Vec<_>>());
        _ = write!(key, "{:?}{:?}{:?}{}", r.acting.map(|a| a.1), r.rack, r.limit_mps, r.has_forgotten);
        _ = write!(key, "{:?}{}", r.acted == Some(r.reached), record.interrupted);
        let nodes: Vec<_> = chain.visits().map(|v| v.node).collect();
        _ = write!(key, "{nodes:?}{}{:?}", chain.granted() - chain.first(), record.task);
        for stop in &record.stops {
            _ = write!(key, "{}{:?}", stop.serial - chain.first(), stop.act);
        }
        let due = chain.get(chain.granted()).map(|v| v.enter - self.now);
        let due = due.map(|d| usize::from(d > Span::ZERO) + usize::from(d > Span::from_secs(4)));
        let need = traffic.needs.waiting.get(&r.id).map(|n| n.tries.min(6));
        let turned = traffic.direction(r.id);
        let noted = yielding.state.of(r.id);
        let to = noted.to.map(|to| (to.reaction, self.age(to.since)));
        let stands = noted.stands.map(|s| (self.age(s.since), self.age(s.facing_since)));
        let revoked = traffic.is_revoked(r.id);
        _ = writeln!(key, "{due:?}{need:?}{turned:?}{to:?}{stands:?}{revoked}");
    }

    /// The order of robots on each node.
    fn order_key(&self, key: &mut String) {
        let mut all = Vec::new();
        for (holder, chain) in self.fleet.ledger().timeline().chains() {
            all.extend(chain.visits().map(|v| (v.node, v.enter, holder)));
        }
        all.sort_unstable();
        all.dedup_by_key(|(node, _, robot)| (*node, *robot));
        all.iter().for_each(|(node, _, robot)| _ = write!(key, "{}:{} ", node.0, robot.0));
    }

    fn worker_key(&self, key: &mut String) {
        let Some(seen) = &self.worker else { return };
        let Some(person) = self.fleet.internals().people.people.get(seen.worker) else { return };
        let half_m = |p: Point| ((p.x * 2.0).round() as i64, (p.y * 2.0).round() as i64);
        let mode = format!("{:?}", person.mode);
        let mode = mode.split(' ').next().unwrap_or_default();
        let moved = half_m(seen.at + (seen.at - seen.was_at));
        let plan = person.plan.as_ref();
        let path: Option<Vec<_>> = plan.map(|p| p.follower.ahead().iter().map(|p| half_m(*p)).collect());
        let stood = person.stands_since.map(|t| self.age(t));
        let blocked = person.blocked_since.map(|(r, t)| (r, self.age(t)));
        let there = person.there_since.map(|t| self.age(t));
        _ = write!(key, "{:?}{moved:?}{mode}{path:?}{stood:?}{blocked:?}{there:?}", half_m(seen.at));
        _ = write!(key, "{:?}", seen.told.state);
    }
}

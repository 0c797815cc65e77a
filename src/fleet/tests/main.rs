//! The core as a whole, step by step, on a simulated floor whose laws are checked at every step.

mod activity;
mod after;
mod arms;
mod arrive;
mod asks;
mod cancel;
mod carry;
mod charging;
mod closures;
mod displaced;
mod enrolment;
mod evacuation;
mod failure;
mod fair;
mod faults;
mod hand;
mod hands;
mod interleavings;
mod jobs;
mod keep_out;
mod keys;
mod kinds;
mod lets_pass;
mod life;
mod limits;
mod lines;
mod links;
mod lost;
mod messages;
mod nearest;
mod order;
mod passing;
mod people;
mod published;
mod racks;
mod reassign;
mod recall;
mod recurring;
mod replans;
mod restart;
mod setting_off;
mod shut_in;
mod station;
mod stops;
mod stuck;
mod trades;
mod turns;
mod vehicles;
mod why;
mod workplace;

use giveway_drive::LinkOutput;
use giveway_fleet::internals::{Internals, InternalsMut};
use giveway_fleet::*;
use giveway_floor::id::{Dense, JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::route::Kinematics;
use giveway_floor::time::Span;
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::{lab, thesis};
use giveway_sim::Laws;
use giveway_sim::{Demand, Faults, Habits, Scenario, Workers, World};
use giveway_site::{Site, SiteLinks};
use std::sync::Arc;

/// A fleet on a simulated floor, with everything that happened.
struct TestFloor {
    fleet: Fleet,
    world: World,
    laws: Laws,
    now: Time,
    facts: Vec<Fact>,
}

fn scenario(robots: usize) -> Scenario {
    let links = SiteLinks::simulated(robots);
    Scenario::from(Site { name: "test".into(), period: Span::from_millis(100), links, ..Site::default() })
}

/// The usual kind, but holds outlast the robot by this much.
fn with_clearance(clearance: Span) -> RobotKind {
    let kinematics = Kinematics { clearance, ..Kinematics::default() };
    RobotKind { kinematics, ..RobotKind::default() }
}

/// A small generator of numbers that look random.
struct TestDice(u64);

impl TestDice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n
    }

    fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

fn deliver(rack: u32) -> JobKind {
    JobKind::Deliver { rack: RackId(rack), station: StationId(0), pick: None }
}

fn request(kind: JobKind) -> JobRequest {
    JobRequest::new(kind)
}

impl TestFloor {
    fn new(warehouse: Warehouse, scenario: &Scenario) -> TestFloor {
        let warehouse = scenario.site.fit(&Arc::new(warehouse)).expect("the map is for these robots");
        let fleet = Fleet::new(warehouse.clone(), scenario.site.settings());
        let world = World::new(warehouse, scenario, &[], scenario.seed, fleet.ledger(), Time::ZERO);
        let laws = Laws::new(&fleet);
        let mut floor = TestFloor { fleet, world, laws, now: Time::ZERO, facts: Vec::new() };
        floor.step(vec![]);
        assert_eq!(floor.fleet.ledger().robots.len(), scenario.robots, "all robots join in the first step");
        floor
    }

    fn lab(robots: usize) -> TestFloor {
        TestFloor::new(lab(), &scenario(robots))
    }

    fn thesis(robots: usize) -> TestFloor {
        TestFloor::new(thesis(), &scenario(robots))
    }

    /// One control period with the inputs `extra` besides the usual ones.
    fn step(&mut self, extra: Vec<Input>) -> Step {
        let near = self.fleet.people_near(&self.world.robots_beside(), self.world.now());
        self.world.foretell(near);
        let mut inputs = self.world.advance(self.now, self.fleet.ledger());
        inputs.extend(extra);
        self.take(inputs)
    }

    /// One control period in which the fleet hears only these inputs.
    fn take(&mut self, inputs: Vec<Input>) -> Step {
        let step = self.fleet.step(self.now, inputs);
        self.laws.check(self.now, &self.world, &self.fleet, &step.facts);
        assert_eq!(self.laws.broken, [], "laws hold");
        self.world.take(self.now, &step);
        self.facts.extend(step.facts.iter().cloned());
        self.now += self.fleet.settings().period;
        step
    }

    /// The answer to a request with this token; simulated pickers are answered in the same step.
    fn answer_to(&mut self, token: u64, extra: Vec<Input>) -> Answered {
        let replies = self.step(extra).replies;
        replies.into_iter().find(|r| r.token == token.into()).expect("every request is answered").answer
    }

    fn ask(&mut self, request: JobRequest) -> Answered {
        self.answer_to(7, vec![Input::ask(7, JobAction::Submit(request))])
    }

    fn submit(&mut self, request: JobRequest) -> JobId {
        match self.ask(request) {
            Ok(Answer::Job(Made { id: job, new: true })) => job,
            other => panic!("not accepted: {other:?}"),
        }
    }

    /// Deliveries of this many racks, to all stations in turn.
    fn submit_batch(&mut self, count: usize) -> Vec<JobId> {
        let w = self.fleet.warehouse();
        let (racks, stations) = (w.racks.len(), w.stations.len());
        let kind = |i: usize| JobKind::Deliver {
            rack: RackId::at(i * 7 % racks),
            station: StationId::at(i % stations),
            pick: None,
        };
        (0..count).map(|i| self.submit(request(kind(i)))).collect()
    }

    fn assert_done_once(&self, jobs: &[JobId]) {
        for job in jobs {
            let done = self.story(*job).iter().filter(|w| **w == "done").count();
            assert_eq!(done, 1, "{job:?} went {:?}", self.story(*job));
        }
    }

    fn cancel(&mut self, job: JobId) -> Answered {
        self.answer_to(8, vec![Input::ask(8, JobAction::Cancel(job))])
    }

    fn run(&mut self, seconds: i64) {
        let end = self.now + Span::from_secs(seconds);
        while self.now < end {
            self.step(vec![]);
        }
    }

    /// Steps until `so` holds, for at most this many simulated seconds.
    fn until(&mut self, seconds: i64, what: &str, so: impl Fn(&TestFloor) -> bool) {
        let end = self.now + Span::from_secs(seconds);
        while !so(self) {
            let (jobs, robots) = (&self.fleet.ledger().jobs, &self.fleet.ledger().robots);
            assert!(self.now < end, "not within {seconds} s: {what}; jobs {jobs:?}; robots {robots:?}");
            self.step(vec![]);
        }
    }

    fn until_over(&mut self, seconds: i64) {
        self.until(seconds, "all jobs are over", |f| f.fleet.ledger().jobs.is_empty());
    }

    /// All states that a job came to, in order, in the words of the wire.
    fn story(&self, job: JobId) -> Vec<&'static str> {
        self.progress(job).map(|(s, _)| s.word()).collect()
    }

    fn progress(&self, job: JobId) -> impl Iterator<Item = (JobState, Time)> {
        self.facts.iter().filter_map(move |f| match f {
            Fact::Job(JobFact::Progressed { job: j, state, at, .. }) if *j == job => Some((*state, *at)),
            _ => None,
        })
    }

    /// When a job came to a state for the first time.
    fn when(&self, job: JobId, word: &str) -> Time {
        let at = self.progress(job).find(|(s, _)| s.word() == word).map(|(_, at)| at);
        at.unwrap_or_else(|| panic!("{job:?} never was {word}: {:?}", self.story(job)))
    }

    fn state(&self, job: JobId) -> Option<JobState> {
        self.fleet.ledger().jobs.get(&job).map(|j| j.state)
    }

    fn is(&self, job: JobId, word: &str) -> bool {
        self.state(job).is_some_and(|s| s.word() == word)
    }

    fn done(&self) -> u64 {
        self.fleet.ledger().counts.done
    }

    fn node(&self, name: &str) -> NodeId {
        self.fleet.warehouse().node_named(name).unwrap_or_else(|| panic!("there is no node {name}"))
    }

    fn rack(&self, rack: u32) -> RackAt {
        self.fleet.ledger().racks[RackId(rack)]
    }

    fn assert_stored(&self, rack: u32) {
        let at = self.rack(rack);
        let stored =
            matches!(at, RackAt::Stored(n) if self.fleet.warehouse().nodes[n].kind == NodeKind::Storage);
        assert!(stored, "rack {rack} is {at:?}");
    }

    /// A storage node without a rack.
    fn free_storage(&self) -> NodeId {
        let taken = |n: &NodeId| self.fleet.ledger().racks.iter().any(|r| *r == RackAt::Stored(*n));
        let all = self.fleet.warehouse().nodes_where(|k| k == NodeKind::Storage);
        let resident = |n: &NodeId| self.fleet.ledger().resident(*n).is_some();
        all.into_iter().find(|n| !taken(n) && !resident(n)).expect("some storage is free")
    }

    /// Whether a robot has no task but to stand somewhere.
    fn is_idle(&self, robot: RobotId) -> bool {
        self.fleet.ledger().robots[robot].task == Task::Idle
    }

    fn first_robot_is_idle(&self) -> bool {
        self.is_idle(RobotId::at(0))
    }
}

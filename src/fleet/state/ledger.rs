//! What was promised: jobs, holds, routes, racks. A fold over facts, durable.
//!
//! Main types: [`Ledger`], [`Robot`]. [`Ledger::evolve`] is the only code that changes it, live and on load
//! alike, and it asserts that what it is told is possible: a journal that books a lane twice does not load.
//! Refuses: to plan, to read a clock, to know where anything is seen.

use crate::fleet::state::fact::{Act, Booking, Fact, Kept, Stop, Task};
use crate::fleet::state::index::Index;
use crate::fleet::state::job::{Job, JobKind, JobRequest, JobState};
use crate::fleet::state::keys::Keys;
use crate::fleet::state::life::{self, Stage, Work};
use crate::fleet::state::wishes::Wishes;
use crate::fleet::state::worker::{Assignment, AssignmentRequest, AssignmentState, Closure};
use crate::id::{AssignmentId, ClosureId, Dense, IdVec, JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use crate::time::{Span, Time};
use crate::timeline::{self, Chain, Holder, Timeline, Visit};
use crate::warehouse::Warehouse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Where a rack is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RackAt {
    /// On a storage node.
    Stored(NodeId),
    /// On a robot.
    On(RobotId),
}

/// A robot as it was told to be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Robot {
    /// Its name.
    pub name: String,
    /// The name of its kind.
    pub kind: String,
    /// What it is doing.
    pub task: Task,
    /// Stops ahead, in order.
    pub stops: Vec<Stop>,
    /// The last stop at which it is done.
    pub acted: Option<u64>,
    /// Whether it cannot drive.
    pub failed: bool,
    /// Whether its route was cut and not yet replaced.
    pub interrupted: bool,
    /// Since when it is to stand, by hand.
    pub paused: Option<Time>,
    /// Since when it is fenced off, since what is promised about it contradicts itself.
    pub fenced: Option<Time>,
    /// Since when it is to be maintained, or is.
    pub maintenance: Option<Time>,
    /// How often it was called back and came.
    pub recalls: u64,
}

/// Everything that was promised.
#[derive(Clone, Debug, PartialEq)]
pub struct Ledger {
    /// Jobs that are not over.
    pub jobs: BTreeMap<JobId, Job>,
    /// The number of the next job.
    pub next_job: u64,
    /// Customers' keys of jobs, over or not.
    pub keys: Keys<JobId>,
    /// Waiting jobs for a robot that the customer named. It follows from the rest: see [`Ledger::reindex`].
    pub named: BTreeMap<RobotId, BTreeSet<JobId>>,
    /// All robots.
    pub robots: IdVec<RobotId, Robot>,
    /// Where each rack is.
    pub racks: IdVec<RackId, RackAt>,
    /// Who holds what when.
    pub timeline: Timeline,
    /// Racks served per station.
    pub served: IdVec<StationId, u64>,
    /// All workers' names.
    pub workers: IdVec<WorkerId, String>,
    /// Assignments that are not over.
    pub assignments: BTreeMap<AssignmentId, Assignment>,
    /// The number of the next assignment.
    pub next_assignment: u64,
    /// Customers' keys of assignments, over or not.
    pub assignment_keys: Keys<AssignmentId>,
    /// Areas that robots keep out of.
    pub closures: BTreeMap<ClosureId, Closure>,
    /// The number of the next closure.
    pub next_closure: u64,
    /// Stations at which nobody picks, since when.
    pub paused_stations: BTreeMap<StationId, Time>,
    /// Since when the whole fleet is to stand, by hand.
    pub stopped: Option<Time>,
    /// Jobs that were cancelled or failed lately, with when: jobs that are to come after them fail as well.
    pub ended_badly: BTreeMap<JobId, Time>,
    /// Sums.
    pub counts: Sums,
    /// How often each rack was wanted lately.
    pub wishes: Wishes,
    /// What is looked up instead of searched. It follows from the rest: see [`Ledger::reindex`].
    pub index: Index,
}

/// Sums over facts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Sums {
    /// Racks served at stations.
    pub robot_deliveries: u64,
    /// Assignments completed by workers.
    pub human_deliveries: u64,
    /// Jobs done.
    pub done: u64,
    /// Jobs cancelled.
    pub cancelled: u64,
    /// Jobs that could not be done.
    pub failed: u64,
    /// Encounters of robots and workers.
    pub encounters: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
}

impl Ledger {
    /// Nothing promised; racks at home. `ghostly` is for the bound on throughput only.
    pub fn new(warehouse: Arc<Warehouse>, clearance: Span, ghostly: bool) -> Ledger {
        let racks = warehouse.racks.iter().map(|r| RackAt::Stored(r.home)).collect();
        let served = IdVec::filled(0, warehouse.stations.len());
        let index = Index::new(&warehouse);
        let wishes = Wishes::none(warehouse.racks.len());
        let timeline = if ghostly { Timeline::ghostly } else { Timeline::new }(warehouse, clearance);
        let mut ledger = Ledger {
            jobs: BTreeMap::new(),
            next_job: 1,
            keys: Keys::default(),
            named: BTreeMap::new(),
            robots: IdVec::new(),
            racks,
            timeline,
            served,
            workers: IdVec::new(),
            assignments: BTreeMap::new(),
            next_assignment: 1,
            assignment_keys: Keys::default(),
            closures: BTreeMap::new(),
            next_closure: 1,
            paused_stations: BTreeMap::new(),
            stopped: None,
            ended_badly: BTreeMap::new(),
            counts: Sums::default(),
            wishes,
            index,
        };
        ledger.reindex();
        ledger
    }

    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        self.timeline.warehouse()
    }

    /// The visits of a robot.
    pub fn chain(&self, robot: RobotId) -> &Chain {
        self.timeline.chain(Holder::Robot(robot)).expect("every robot stands somewhere")
    }

    /// The node on which a robot stands or which it passed last.
    pub fn node_of(&self, robot: RobotId) -> NodeId {
        self.chain(robot).visits().next().expect("every robot stands somewhere").node
    }

    /// The rack on a robot.
    pub fn rack_on(&self, robot: RobotId) -> Option<RackId> {
        let rack = self.robots[robot].task.carried()?;
        (self.racks[rack] == RackAt::On(robot)).then_some(rack)
    }

    /// Takes one fact in.
    ///
    /// # Panics
    /// If the fact cannot be: the journal or the planner is broken, and going on would make it worse.
    pub fn evolve(&mut self, fact: &Fact) {
        let moved = self.rack_moved_by(fact);
        self.take_in(fact);
        self.keep_index(fact, moved);
    }

    fn take_in(&mut self, fact: &Fact) {
        match fact {
            Fact::Accepted { job, request, at } => self.accept(*job, request, *at),
            Fact::Progressed { job, state, tasked, .. } => self.progress(*job, *state, *tasked),
            Fact::Prioritised { job, priority, .. } => {
                self.jobs.get_mut(job).expect("only live jobs change").request.priority = *priority;
            }
            Fact::KeysExpired { jobs, assignments } => {
                jobs.iter().for_each(|job| self.keys.forget(*job));
                assignments.iter().for_each(|assignment| self.assignment_keys.forget(*assignment));
            }
            Fact::WorkerRegistered { worker, name, .. } => {
                let id = self.workers.push(name.clone());
                assert_eq!(id, *worker, "workers are numbered in order");
            }
            Fact::Assigned { assignment, worker, request, at } => {
                self.hand_out(*assignment, *worker, request, *at);
            }
            Fact::Advanced { assignment, state, .. } => self.advance(*assignment, *state),
            Fact::Closed { closure, area } => {
                assert_eq!(closure.0, self.next_closure, "closures are numbered in order");
                self.next_closure += 1;
                self.closures.insert(*closure, area.clone());
            }
            Fact::Reopened { closure, .. } => {
                self.closures.remove(closure).expect("only what is closed is opened again");
            }
            Fact::StationPaused { station, at } => {
                self.paused_stations.insert(*station, *at);
            }
            Fact::StationResumed { station, .. } => {
                self.paused_stations.remove(station);
            }
            Fact::Encountered(_) => self.counts.encounters += 1,
            Fact::Deviated { .. } => self.counts.deviations += 1,
            Fact::Interrupted { .. } => self.counts.interruptions += 1,
            about_robots => self.take_in_of_robots(about_robots),
        }
    }

    /// Facts that change what robots hold, do or are.
    fn take_in_of_robots(&mut self, fact: &Fact) {
        match fact {
            Fact::Registered { robot, name, kind, node, at } => self.enlist(*robot, (name, kind), *node, *at),
            Fact::Tasked { robot, task } => self.task(*robot, *task),
            Fact::Routed { bookings } => self.route(bookings),
            Fact::Granted { robot, serial, at } => {
                self.timeline.grant(Holder::Robot(*robot), *serial, *at);
            }
            Fact::Revoked { robot, serial, recalls, .. } => {
                self.robots[*robot].recalls = *recalls;
                self.timeline.recall(Holder::Robot(*robot), *serial);
            }
            Fact::Passed { robot, serial } => self.timeline.release(Holder::Robot(*robot), *serial),
            Fact::Acted { robot, serial } => self.act(*robot, *serial),
            Fact::Delayed { moved } => {
                let slip: Vec<_> =
                    moved.iter().map(|m| (Holder::Robot(m.robot), m.shifts.as_slice())).collect();
                self.timeline.slide(&slip);
            }
            Fact::Truncated { robots } => self.cut(robots),
            Fact::Placed { robot, node, serial, cut, at } => self.place(*robot, *node, *serial, cut, *at),
            Fact::Failed { robot, .. } => self.robots[*robot].failed = true,
            Fact::Repaired { robot, .. } => {
                self.robots[*robot].failed = false;
                self.robots[*robot].interrupted = true;
            }
            Fact::Fenced { robot, at } => {
                self.robots[*robot].failed = true;
                self.robots[*robot].fenced = Some(*at);
            }
            Fact::Maintenance { robot, since } => self.robots[*robot].maintenance = *since,
            Fact::Halted { robot, at } => *self.halted(*robot) = Some(*at),
            Fact::Released { robot, .. } => {
                *self.halted(*robot) = None;
                if let Some(robot) = robot {
                    self.robots[*robot].fenced = None;
                }
            }
            other => unreachable!("{other:?} is taken in above"),
        }
    }

    fn accept(&mut self, id: JobId, request: &JobRequest, at: Time) {
        assert_eq!(id.0, self.next_job, "jobs are numbered in order");
        self.next_job += 1;
        if let Some(key) = &request.key {
            self.keys.insert(key.clone(), id);
        }
        if let Some(rack) = request.kind.rack() {
            self.wishes.note(rack);
        }
        self.jobs.insert(id, Job { request: request.clone(), state: JobState::Waiting, accepted: at });
        self.note_named(id, &request.kind, JobState::Waiting);
    }

    /// Since when one robot, or the whole fleet, is to stand.
    fn halted(&mut self, robot: Option<RobotId>) -> &mut Option<Time> {
        match robot {
            Some(r) => &mut self.robots[r].paused,
            None => &mut self.stopped,
        }
    }

    fn hand_out(&mut self, id: AssignmentId, worker: WorkerId, request: &AssignmentRequest, at: Time) {
        assert_eq!(id.0, self.next_assignment, "assignments are numbered in order");
        self.next_assignment += 1;
        if let Some(key) = &request.key {
            self.assignment_keys.insert(key.clone(), id);
        }
        let (request, state) = (request.clone(), AssignmentState::Waiting);
        self.assignments.insert(id, Assignment { worker, request, state, accepted: at });
    }

    fn advance(&mut self, id: AssignmentId, state: AssignmentState) {
        self.assignments.get_mut(&id).expect("only live assignments advance").state = state;
        if state.is_over() {
            let over = self.assignments.remove(&id).expect("just seen");
            if let Some(key) = over.request.key {
                self.assignment_keys.end(id, key, over.accepted);
            }
            self.counts.human_deliveries += u64::from(state == AssignmentState::Done);
        }
    }

    fn enlist(&mut self, robot: RobotId, (name, kind): (&str, &str), node: NodeId, at: Time) {
        let id = self.robots.push(Robot {
            name: name.to_owned(),
            kind: kind.to_owned(),
            task: Task::Idle,
            stops: Vec::new(),
            acted: None,
            failed: false,
            interrupted: false,
            paused: None,
            fenced: None,
            maintenance: None,
            recalls: 0,
        });
        assert_eq!(id, robot, "robots are numbered in order");
        let holder = Holder::Robot(robot);
        self.timeline.reserve(holder, vec![stand(node, at)]).expect("robots join on free nodes");
        self.timeline.grant(holder, 0, at);
    }

    /// Brings a job to another state, and its robot to the task that goes with it.
    fn progress(&mut self, id: JobId, state: JobState, tasked: Option<(RobotId, Task)>) {
        let job = self.jobs.get_mut(&id).expect("only live jobs progress");
        let (kind, before) = (job.request.kind, job.state);
        let event = life::event(&kind, Stage::of(before), Stage::of(state));
        assert!(event.is_some(), "{id:?} ({kind:?}) cannot go from {before:?} to {state:?}");
        let robots = (before.robot(), state.robot());
        assert!(!matches!(robots, (Some(a), Some(b)) if a != b), "{id:?} changes its robot: {robots:?}");
        job.state = state;
        self.note_named(id, &kind, state);
        if let Some((robot, task)) = tasked {
            let old = self.robots[robot].task;
            assert!(old.job().is_none_or(|j| j == id), "{robot:?} serves another job than {id:?}: {old:?}");
            self.give(robot, task);
        }
        self.assert_served(id, &kind, state);
        let left = robots.0.filter(|r| self.robots[*r].task.job() == Some(id));
        assert!(state.robot() == left.or(state.robot()), "{left:?} still serves {id:?}, which is {state:?}");
        if !state.is_over() {
            return;
        }
        let job = self.jobs.remove(&id).expect("just seen");
        match state {
            JobState::Done => self.counts.done += 1,
            JobState::Cancelled => self.counts.cancelled += 1,
            _ => self.counts.failed += 1,
        }
        if let (JobKind::Deliver { station, .. }, JobState::Done) = (job.request.kind, state) {
            self.counts.robot_deliveries += 1;
            self.served[station] += 1;
        }
        if let Some(key) = job.request.key {
            self.keys.end(id, key, job.accepted);
        }
    }

    /// Keeps the list of jobs that wait for a robot that the customer named.
    pub(in crate::fleet) fn note_named(&mut self, id: JobId, kind: &JobKind, state: JobState) {
        let Some(robot) = kind.robot() else { return };
        let waiting = self.named.entry(robot).or_default();
        match state {
            JobState::Waiting => waiting.insert(id),
            _ => waiting.remove(&id),
        };
        if waiting.is_empty() {
            self.named.remove(&robot);
        }
    }

    /// Gives a robot another task that changes no job's state.
    fn task(&mut self, robot: RobotId, task: Task) {
        let old = self.robots[robot].task;
        self.give(robot, task);
        let same = old.job() == task.job() && Work::of(&old) == Work::of(&task);
        assert!(same, "{robot:?} cannot go from {old:?} to {task:?} without its job");
    }

    /// A robot gets a task. What it does not ask for any more is not done on the route that the robot has, which it
    /// drives on until there is a better one; what was granted is done all the same.
    fn give(&mut self, robot: RobotId, task: Task) {
        let granted = self.chain(robot).granted();
        let record = &mut self.robots[robot];
        record.task = task;
        record.stops.retain(|s| s.serial < granted || task.asks_for(s.act));
    }

    /// Asserts that the robot of a job does what the job's stage asks for.
    fn assert_served(&self, id: JobId, kind: &JobKind, state: JobState) {
        let wanted = life::work(kind, Stage::of(state)).expect("the table leads to stages that the kind has");
        let Some(robot) = state.robot() else { return };
        let task = self.robots[robot].task;
        let serves = task.job() == Some(id) && Work::of(&task) == wanted;
        assert!(serves, "{id:?} is {state:?}, but {robot:?} has the task {task:?}");
    }

    /// Asserts for everything open what each fact asserts for itself: for laws, looks at everything.
    pub fn assert_sound(&self) {
        self.timeline.assert_sound();
        for (id, job) in &self.jobs {
            assert!(!job.state.is_over(), "{id:?} is over and still open");
            self.assert_served(*id, &job.request.kind, job.state);
        }
        for (robot, record) in self.robots.pairs() {
            let job = record.task.job().map(|j| self.jobs.get(&j).and_then(|j| j.state.robot()));
            assert!(job.is_none_or(|r| r == Some(robot)), "{robot:?} serves a job that does not know it");
        }
        for (rack, at) in self.racks.pairs() {
            let RackAt::On(robot) = at else { continue };
            let task = self.robots[*robot].task;
            assert_eq!(task.carried(), Some(rack), "{robot:?} has {rack:?} on it and the task {task:?}");
        }
    }

    /// # Panics
    /// If a route clashes, or drops what a robot was granted to do: the robot would do it all the same.
    fn route(&mut self, bookings: &[Booking]) {
        for b in bookings {
            let next = self.robots[b.robot].stops.first();
            let granted = next.is_some_and(|s| s.serial < self.chain(b.robot).granted());
            assert!(!granted, "{:?} gets a route in place of the one on which it is to do {next:?}", b.robot);
        }
        let routes = (bookings.iter())
            .map(|b| (Holder::Robot(b.robot), b.keep, b.kept.clone(), b.visits.clone()))
            .collect();
        let reserved = self.timeline.replace_all(routes);
        reserved.unwrap_or_else(|clash| panic!("a robot was given a route that clashes: {clash:?}"));
        for b in bookings {
            self.robots[b.robot].stops = b.stops.clone();
            self.robots[b.robot].interrupted = false;
        }
    }

    fn act(&mut self, robot: RobotId, serial: u64) {
        let record = &mut self.robots[robot];
        assert!(record.acted < Some(serial), "{robot:?} acts once at a stop");
        assert_eq!(record.stops.first().map(|s| s.serial), Some(serial), "{robot:?} acts at its next stop");
        let stop = record.stops.remove(0);
        record.acted = Some(serial);
        match stop.act {
            Act::Lift(rack) => {
                assert_eq!(
                    self.racks[rack],
                    RackAt::Stored(self.node_of(robot)),
                    "{robot:?} lifts what is there"
                );
                self.racks[rack] = RackAt::On(robot);
            }
            Act::Set(rack) => {
                assert_eq!(self.racks[rack], RackAt::On(robot), "{robot:?} sets down what it has");
                let node = self.node_of(robot);
                assert_eq!(self.index.places.rack_on(node), None, "one rack on a node");
                self.racks[rack] = RackAt::Stored(node);
            }
            Act::Pick(_) | Act::Arrive => {}
        }
    }

    fn cut(&mut self, robots: &[Kept]) {
        self.timeline.keep(&kept(robots));
        self.interrupt(robots);
    }

    /// A robot stands elsewhere: it holds that place alone, and others lose what they were promised there.
    fn place(&mut self, robot: RobotId, node: NodeId, serial: u64, cut: &[Kept], at: Time) {
        self.timeline.place(Holder::Robot(robot), serial, stand(node, at), &kept(cut));
        let record = &mut self.robots[robot];
        record.stops.clear();
        record.interrupted = true;
        self.interrupt(cut);
    }

    fn interrupt(&mut self, robots: &[Kept]) {
        for k in robots {
            self.robots[k.robot].stops.retain(|s| s.serial < k.end);
            self.robots[k.robot].interrupted = true;
        }
    }

    /// The robot that stands on a node, or will be there in the end.
    pub fn resident(&self, node: NodeId) -> Option<RobotId> {
        self.index.places.resident(node)
    }
}

fn kept(robots: &[Kept]) -> Vec<timeline::Kept<'_>> {
    robots.iter().map(|k| (Holder::Robot(k.robot), k.end, k.shifts.as_slice())).collect()
}

/// Standing on a node for ever.
pub fn stand(node: NodeId, at: Time) -> Visit {
    Visit { node, lane: None, enter: at, arrive: at, depart: Time::MAX, leave: Time::MAX, stay: Span::ZERO }
}

/// All robots by number.
pub fn all(robots: &IdVec<RobotId, Robot>) -> impl Iterator<Item = RobotId> + use<> {
    (0..robots.len()).map(RobotId::at)
}

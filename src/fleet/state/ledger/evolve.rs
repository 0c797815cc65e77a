//! How facts change the ledger: the only code that does, live and on load alike.
//!
//! Main function: [`Ledger::evolve`]. It asserts that each fact is possible: a journal that books a lane twice does not
//! load. Refuses: to decide anything.

use super::{Ledger, RackAt, Robot, Service, Unconfirmed, stand};
use crate::state::fact::{
    Act, AreaFact, AssignmentFact, Booking, EncounterFact, Fact, FloorFact, JobFact, KeptRoute, RobotFact,
    RouteFact, Task, WorkerFact,
};
use crate::state::job::{Job, JobRequest, JobState, RobotChoice};
use crate::state::job_kind::JobKind;
use crate::state::life::{self, JobStage, Work};
use crate::state::link::USUAL_LINK;
use crate::state::worker::{Assignment, AssignmentRequest, AssignmentState};
use giveway_cell::{LineChange, LineOutcome};
use giveway_floor::id::{AssignmentId, JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::Time;
use giveway_floor::timeline::{self, Visit};
use giveway_people::human::Mover;

impl Ledger {
    /// Takes one fact in.
    ///
    /// # Panics
    /// If the fact is impossible: the journal or the planner is broken, and going on would make it worse.
    pub fn evolve(&mut self, fact: &Fact) {
        let moved = self.rack_moved_by(fact);
        self.take_in(fact);
        self.keep_index(fact, moved);
    }

    fn take_in(&mut self, fact: &Fact) {
        match fact {
            Fact::Robot(of) => self.take_in_of_robots(of),
            Fact::Route(of) => self.take_in_of_routes(of),
            Fact::Job(of) => self.take_in_of_jobs(of),
            Fact::Worker(of) => self.take_in_of_workers(of),
            Fact::Assignment(of) => self.take_in_of_assignments(of),
            Fact::Area(of) => self.take_in_of_areas(of),
            Fact::Floor(of) => self.take_in_of_the_floor(of),
            Fact::Encounter(EncounterFact::Met(_)) => self.promises.counts.encounters += 1,
            Fact::Encounter(EncounterFact::Deviated { .. }) => self.promises.counts.deviations += 1,
            Fact::Encounter(EncounterFact::Interrupted { .. }) => self.promises.counts.interruptions += 1,
            Fact::Noted(_) => {}
        }
    }

    fn take_in_of_jobs(&mut self, fact: &JobFact) {
        match fact {
            JobFact::Accepted { job, request, at } => self.accept(*job, request, *at),
            JobFact::Progressed { job, state, tasked, .. } => self.progress(*job, *state, *tasked),
            JobFact::Served { job, tasked, at } => self.serve(*job, *tasked, *at),
            JobFact::LineChanged { job, line, change, .. } => self.change_line(*job, *line, *change),
            JobFact::Chosen { job, choice, .. } => {
                let job = self.promises.jobs.get_mut(job).expect("only live jobs change");
                assert_eq!(job.state, JobState::Waiting, "a robot works on the job that is given to another");
                job.choice = *choice;
            }
            JobFact::Prioritised { job, priority, .. } => {
                self.promises.jobs.get_mut(job).expect("only live jobs change").request.priority = *priority;
            }
            JobFact::Changed { job, kind, priority, deadline, .. } => {
                self.change_job(*job, *kind, *priority, *deadline);
            }
        }
    }

    fn take_in_of_workers(&mut self, fact: &WorkerFact) {
        match fact {
            WorkerFact::Registered { worker, name, .. } => {
                // The number may have been that of a driver who has gone.
                self.promises.vehicles.remove(worker);
                if self.promises.workers.get(*worker).is_some() {
                    self.promises.workers[*worker].clone_from(name);
                } else {
                    let id = self.promises.workers.push(name.clone());
                    assert_eq!(id, *worker, "workers are numbered in order");
                }
            }
            WorkerFact::Noted { worker, place } | WorkerFact::Narrowed { worker, place, .. } => {
                self.promises.on_floor.insert(*worker, *place);
            }
            WorkerFact::Cleared { worker, .. } => _ = self.promises.on_floor.remove(worker),
            WorkerFact::Moves { worker, mover: Mover::Vehicle(vehicle), .. } => {
                self.promises.vehicles.insert(*worker, *vehicle);
            }
            WorkerFact::Moves { worker, mover: Mover::OnFoot, .. } => {
                self.promises.vehicles.remove(worker);
            }
        }
    }

    fn take_in_of_assignments(&mut self, fact: &AssignmentFact) {
        match fact {
            AssignmentFact::Assigned { assignment, worker, request, at } => {
                self.assign(*assignment, *worker, request, *at);
            }
            AssignmentFact::Given { assignment, worker, .. } => {
                let given = self.promises.assignments.get_mut(assignment).expect("only live ones are given");
                assert_eq!(given.worker.replace(*worker), None, "an assignment is given once");
            }
            AssignmentFact::Advanced { assignment, state, .. } => self.advance(*assignment, *state),
        }
    }

    fn take_in_of_the_floor(&mut self, fact: &FloorFact) {
        match fact {
            FloorFact::Evacuated { at } => self.promises.evacuation = Some(*at),
            FloorFact::EvacuationEnded { .. } => self.promises.evacuation = None,
            FloorFact::StationPaused { station, at } => {
                self.promises.paused_stations.insert(*station, *at);
            }
            FloorFact::StationResumed { station, .. } => {
                self.promises.paused_stations.remove(station);
            }
            FloorFact::Halted { robot, at } => *self.halted(*robot) = Some(*at),
            FloorFact::Released { robot, .. } => {
                *self.halted(*robot) = None;
                if let Some(robot) = robot {
                    self.promises.robots[*robot].fenced = None;
                }
            }
            FloorFact::KeysExpired { jobs, assignments } => {
                jobs.iter().for_each(|job| self.promises.keys.forget(*job));
                assignments.iter().for_each(|assignment| self.promises.assignment_keys.forget(*assignment));
            }
            FloorFact::KindPut { kind, .. } => self.put_kind(kind),
            FloorFact::KindRemoved { name, .. } => self.remove_kind(name),
        }
    }

    fn take_in_of_areas(&mut self, fact: &AreaFact) {
        match fact {
            AreaFact::Closed { closure, area } => {
                assert_eq!(closure.0, self.promises.next_closure, "closures are numbered in order");
                self.promises.next_closure += 1;
                self.promises.closures.insert(*closure, area.clone());
            }
            AreaFact::Reopened { closure, .. } => {
                self.promises.closures.remove(closure).expect("only what is closed is opened again");
            }
            AreaFact::Recurs { series, closure } => {
                assert_eq!(series.0, self.promises.next_series, "recurring closures are numbered in order");
                self.promises.next_series += 1;
                self.promises.recurring.insert(*series, closure.clone());
            }
            AreaFact::Scheduled { series, next } => {
                let recurring = self.promises.recurring.get_mut(series);
                recurring.expect("only what recurs has a next occurrence").next = *next;
            }
            AreaFact::SeriesEnded { series, .. } => {
                self.promises.recurring.remove(series).expect("only what recurs is ended");
            }
        }
    }

    /// Facts that change what robots do or are.
    fn take_in_of_robots(&mut self, fact: &RobotFact) {
        match fact {
            RobotFact::Registered { robot, name, kind, node, at } => {
                self.register(*robot, (name, kind), *node, *at);
            }
            RobotFact::Linked { robot, link } => self.promises.robots[*robot].link.clone_from(link),
            RobotFact::Tasked { robot, task } => self.task(*robot, *task),
            RobotFact::Failed { robot, .. } => self.promises.robots[*robot].failed = true,
            RobotFact::Repaired { robot, .. } => {
                self.promises.robots[*robot].failed = false;
                self.promises.robots[*robot].interrupted = true;
            }
            RobotFact::Fenced { robot, at } => {
                self.promises.robots[*robot].failed = true;
                self.promises.robots[*robot].fenced = Some(*at);
            }
            RobotFact::Maintenance { robot, since } => {
                let service = since.map_or(Service::Works, |since| Service::Maintenance { since });
                self.promises.robots[*robot].service = service;
            }
            RobotFact::Retired { robot, at } => {
                self.promises.robots[*robot].service = Service::Leaving { since: *at };
            }
            RobotFact::Left { robot, at } => self.leave(*robot, *at),
            RobotFact::Returned { robot, kind, node, at } => self.come_back(*robot, kind, *node, *at),
            RobotFact::RackTaken { robot, rack, node, .. } => self.take_rack(*robot, *rack, *node),
        }
    }

    /// Facts that change what robots hold.
    fn take_in_of_routes(&mut self, fact: &RouteFact) {
        match fact {
            RouteFact::Routed { bookings } => self.route(bookings),
            RouteFact::Granted { robot, serial, at } => self.timeline.grant(*robot, *serial, *at),
            RouteFact::Revoked { robot, serial, recalls, .. } => {
                self.promises.robots[*robot].recalls = *recalls;
                self.timeline.revoke(*robot, *serial);
            }
            RouteFact::Passed { robot, serial } => self.timeline.release(*robot, *serial),
            RouteFact::Acted { robot, serial } => self.act(*robot, *serial),
            RouteFact::Retimed { moved } => {
                let slip: Vec<_> = moved.iter().map(|m| (m.robot, m.shifts.as_slice())).collect();
                self.timeline.slide(&slip);
            }
            RouteFact::Truncated { robots } => self.truncate(robots),
            RouteFact::Placed { robot, node, serial, cut, at } => {
                self.place(*robot, *node, *serial, cut, *at);
            }
        }
    }

    fn accept(&mut self, id: JobId, request: &JobRequest, at: Time) {
        assert_eq!(id.0, self.promises.next_job, "jobs are numbered in order");
        self.promises.next_job += 1;
        if let Some(key) = &request.key {
            self.promises.keys.insert(key.clone(), id);
        }
        if let Some(rack) = request.kind.rack() {
            self.promises.wishes.note(rack);
        }
        self.promises.jobs.insert(id, Job::new(request.clone(), at));
        self.index.note_named(id, &request.kind, JobState::Waiting);
    }

    /// Changes a line of the visit in progress, or of one whose rack left before its last line was confirmed.
    fn change_line(&mut self, id: JobId, line: usize, change: LineChange) {
        let left = self.promises.unconfirmed.iter_mut().find(|(_, u)| u.job == id);
        let lines = if let Some((_, unconfirmed)) = left {
            &mut unconfirmed.lines
        } else {
            let job = self.promises.jobs.get_mut(&id).expect("only live jobs have lines");
            let is_here = matches!(job.state, JobState::Picking { .. });
            assert!(is_here, "{id:?} is picked for while its rack is elsewhere");
            job.lines_now_mut().expect("only visits with lines have changes of lines")
        };
        let outcome = lines.change(line, change);
        assert_eq!(
            outcome,
            Ok(LineOutcome::Changed),
            "only what changes a line is a fact: {id:?}, {line}, {change:?}"
        );
        self.promises.unconfirmed.retain(|_, u| !u.lines.are_over());
    }

    /// Changes a waiting job in more than its priority.
    fn change_job(&mut self, id: JobId, kind: JobKind, priority: u8, deadline: Option<Time>) {
        let job = self.promises.jobs.get_mut(&id).expect("only live jobs change");
        assert_eq!(job.state, JobState::Waiting, "{id:?} is changed while a robot has it");
        assert_eq!(job.request.kind.rack(), kind.rack(), "{id:?} gets another rack");
        let before = std::mem::replace(&mut job.request.kind, kind);
        (job.request.priority, job.request.deadline) = (priority, deadline);
        // The robot that was named before has nothing to wait for any more.
        self.index.note_named(id, &before, JobState::Cancelled);
        self.index.note_named(id, &kind, JobState::Waiting);
    }

    /// Since when one robot, or the whole fleet, is to stand.
    fn halted(&mut self, robot: Option<RobotId>) -> &mut Option<Time> {
        match robot {
            Some(r) => &mut self.promises.robots[r].paused,
            None => &mut self.promises.stopped,
        }
    }

    fn assign(&mut self, id: AssignmentId, worker: Option<WorkerId>, request: &AssignmentRequest, at: Time) {
        assert_eq!(id.0, self.promises.next_assignment, "assignments are numbered in order");
        self.promises.next_assignment += 1;
        if let Some(key) = &request.key {
            self.promises.assignment_keys.insert(key.clone(), id);
        }
        let (request, state) = (request.clone(), AssignmentState::Waiting);
        self.promises.assignments.insert(id, Assignment { worker, request, state, accepted: at });
    }

    fn advance(&mut self, id: AssignmentId, state: AssignmentState) {
        self.promises.assignments.get_mut(&id).expect("only live assignments advance").state = state;
        if state.is_over() {
            let over = self.promises.assignments.remove(&id).expect("just seen");
            if let Some(key) = over.request.key {
                self.promises.assignment_keys.end(id, key, over.accepted);
            }
            self.promises.counts.human_deliveries += u64::from(state == AssignmentState::Done);
        }
    }

    fn register(&mut self, robot: RobotId, (name, kind): (&str, &str), node: NodeId, at: Time) {
        let id = self.promises.robots.push(new_robot(name, kind));
        assert_eq!(id, robot, "robots are numbered in order");
        let body = self.warehouse().body_of(kind);
        self.timeline.set_body(robot, body);
        self.timeline.reserve(robot, vec![stand(node, at)]).expect("robots join on free nodes");
        self.timeline.grant(robot, 0, at);
    }

    /// A robot has left the floor. Only a robot that has nothing to do and carries nothing may leave.
    fn leave(&mut self, robot: RobotId, at: Time) {
        assert_eq!(self.rack_on(robot), None, "{robot:?} leaves with a rack");
        let record = &mut self.promises.robots[robot];
        assert_eq!(record.task, Task::Idle, "{robot:?} leaves while it has something to do");
        assert!(matches!(record.service, Service::Leaving { .. }), "{robot:?} leaves unasked");
        record.stops.clear();
        record.service = Service::Gone { since: at };
        self.timeline.depart(robot);
    }

    /// A robot that had left stands on the floor again.
    fn come_back(&mut self, robot: RobotId, kind: &str, node: NodeId, at: Time) {
        let (body, serial) = (self.warehouse().body_of(kind), self.chain(robot).end());
        let record = &mut self.promises.robots[robot];
        assert!(record.is_gone(), "{robot:?} comes back and had not left");
        *record = Robot { acted: record.acted, recalls: record.recalls, ..new_robot(&record.name, kind) };
        self.timeline.set_body(robot, body);
        self.timeline.place(robot, serial, stand(node, at), &[]);
    }

    /// Changes the state of a job and, with it, the task of its robot.
    fn progress(&mut self, id: JobId, state: JobState, tasked: Option<(RobotId, Task)>) {
        let job = self.promises.jobs.get_mut(&id).expect("only live jobs progress");
        let (kind, before) = (job.request.kind, job.state);
        let event = life::event(&kind, JobStage::of(before), JobStage::of(state));
        assert!(event.is_some(), "{id:?} ({kind:?}) cannot go from {before:?} to {state:?}");
        let robots = (before.robot(), state.robot());
        assert!(!matches!(robots, (Some(a), Some(b)) if a != b), "{id:?} changes its robot: {robots:?}");
        job.state = state;
        if matches!(state, JobState::Assigned { .. } | JobState::Carrying { .. }) {
            job.choice = RobotChoice::Any;
        }
        self.index.note_named(id, &kind, state);
        if let Some((robot, task)) = tasked {
            let old = self.promises.robots[robot].task;
            assert!(old.job().is_none_or(|j| j == id), "{robot:?} serves another job than {id:?}: {old:?}");
            self.give(robot, task);
        }
        self.assert_served(id, &kind, state);
        let left = robots.0.filter(|r| self.promises.robots[*r].task.job() == Some(id));
        assert!(state.robot() == left.or(state.robot()), "{left:?} still serves {id:?}, which is {state:?}");
        if !state.is_over() {
            return;
        }
        let job = self.promises.jobs.remove(&id).expect("just seen");
        match state {
            JobState::Done => self.promises.counts.done += 1,
            JobState::Cancelled => self.promises.counts.cancelled += 1,
            _ => self.promises.counts.failed += 1,
        }
        if let (JobKind::Deliver { station, .. }, JobState::Done) = (job.request.kind, state) {
            self.count_delivery(station);
            if let Some(lines) = job.lines_now().filter(|lines| !lines.are_over()) {
                let unconfirmed = Unconfirmed { job: id, lines: lines.clone() };
                self.promises.unconfirmed.insert(station, unconfirmed);
            }
        }
        if let Some(key) = job.request.key {
            self.promises.keys.end(id, key, job.accepted);
        }
    }

    /// A pick has ended, and the rack goes on to the job's next station.
    fn serve(&mut self, id: JobId, (robot, task): (RobotId, Task), at: Time) {
        let job = self.promises.jobs.get_mut(&id).expect("only live jobs are served");
        assert_eq!(job.state, JobState::Picking { robot }, "{id:?} is served where its rack does not stand");
        let station = job.go_on(robot, at).expect("the rack is wanted at another station");
        let (kind, state) = (job.request.kind, job.state);
        self.give(robot, task);
        self.assert_served(id, &kind, state);
        self.count_delivery(station);
    }

    fn count_delivery(&mut self, station: StationId) {
        self.promises.counts.robot_deliveries += 1;
        self.promises.served[station] += 1;
    }

    /// Gives a robot another task that changes no job's state.
    fn task(&mut self, robot: RobotId, task: Task) {
        let old = self.promises.robots[robot].task;
        self.give(robot, task);
        let same = old.job() == task.job() && Work::of(&old) == Work::of(&task);
        assert!(same, "{robot:?} cannot go from {old:?} to {task:?} without its job");
    }

    /// Gives a robot a task. Stops that the task does not ask for are dropped from the robot's present route, on which
    /// it drives on until there is a better one; granted stops are done all the same.
    fn give(&mut self, robot: RobotId, task: Task) {
        let granted = self.chain(robot).granted();
        let record = &mut self.promises.robots[robot];
        record.task = task;
        record.stops.retain(|s| s.serial < granted || task.asks_for(s.act));
    }

    /// Asserts that the robot of a job does what the job's stage asks for.
    fn assert_served(&self, id: JobId, kind: &JobKind, state: JobState) {
        let wanted =
            life::work(kind, JobStage::of(state)).expect("the table leads to stages that the kind has");
        let Some(robot) = state.robot() else { return };
        let task = self.promises.robots[robot].task;
        let serves = task.job() == Some(id) && Work::of(&task) == wanted;
        assert!(serves, "{id:?} is {state:?}, but {robot:?} has the task {task:?}");
    }

    /// # Panics
    /// If a route clashes, or drops what a robot was granted to do: the robot would do it all the same.
    fn route(&mut self, bookings: &[Booking]) {
        for b in bookings {
            let next = self.promises.robots[b.robot].stops.first();
            let granted = next.is_some_and(|s| s.serial < self.chain(b.robot).granted());
            assert!(!granted, "{:?} gets a route in place of the one on which it is to do {next:?}", b.robot);
        }
        let routes = (bookings.iter()).map(|b| (b.robot, b.keep, b.kept.clone(), b.visits.clone())).collect();
        let reserved = self.timeline.replace_all(routes);
        reserved.unwrap_or_else(|clash| panic!("a robot was given a route that clashes: {clash:?}"));
        for b in bookings {
            self.promises.robots[b.robot].stops = b.stops.clone();
            self.promises.robots[b.robot].interrupted = false;
        }
    }

    fn act(&mut self, robot: RobotId, serial: u64) {
        let record = &mut self.promises.robots[robot];
        assert!(record.acted < Some(serial), "{robot:?} acts once at a stop");
        assert_eq!(record.stops.first().map(|s| s.serial), Some(serial), "{robot:?} acts at its next stop");
        let stop = record.stops.remove(0);
        record.acted = Some(serial);
        let room = self.chain(robot).get(serial).is_some_and(|v| v.loaded);
        assert!(
            room || !matches!(stop.act, Act::Lift(_)),
            "{robot:?} lifts a rack where it holds no room for one"
        );
        match stop.act {
            Act::Lift(rack) => {
                assert_eq!(
                    self.promises.racks[rack],
                    RackAt::Stored(self.node_of(robot)),
                    "{robot:?} lifts what is there"
                );
                self.promises.racks[rack] = RackAt::On(robot);
            }
            Act::Set(rack) => {
                assert_eq!(self.promises.racks[rack], RackAt::On(robot), "{robot:?} sets down what it has");
                let node = self.node_of(robot);
                assert_eq!(self.index.places.rack_on(node), None, "one rack on a node");
                self.promises.racks[rack] = RackAt::Stored(node);
            }
            Act::Pick(_) | Act::Arrive => {}
        }
    }

    /// People took a rack off a robot and set it down.
    fn take_rack(&mut self, robot: RobotId, rack: RackId, node: NodeId) {
        assert_eq!(self.promises.racks[rack], RackAt::On(robot), "{robot:?} had {rack:?} on it");
        assert_eq!(self.index.places.rack_on(node), None, "one rack on a node");
        self.promises.racks[rack] = RackAt::Stored(node);
        self.promises.robots[robot].stops.clear();
    }

    fn truncate(&mut self, robots: &[KeptRoute]) {
        self.timeline.keep(&kept(robots));
        self.interrupt(robots);
    }

    /// A robot stands elsewhere: it holds that node alone, and others lose what they were promised there.
    fn place(&mut self, robot: RobotId, node: NodeId, serial: u64, cut: &[KeptRoute], at: Time) {
        let visit = Visit { loaded: self.rack_on(robot).is_some(), ..stand(node, at) };
        self.timeline.place(robot, serial, visit, &kept(cut));
        let record = &mut self.promises.robots[robot];
        record.stops.clear();
        record.interrupted = true;
        self.interrupt(cut);
    }

    fn interrupt(&mut self, robots: &[KeptRoute]) {
        for k in robots {
            self.promises.robots[k.robot].stops.retain(|s| s.serial < k.end);
            self.promises.robots[k.robot].interrupted = true;
        }
    }

    /// Asserts for everything open what each fact asserts for itself. For the laws of simulations: it checks
    /// everything.
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
}

fn kept(robots: &[KeptRoute]) -> Vec<timeline::KeptVisits<'_>> {
    robots.iter().map(|k| (k.robot, k.end, k.shifts.as_slice())).collect()
}

/// A robot that has just joined.
fn new_robot(name: &str, kind: &str) -> Robot {
    Robot {
        name: name.to_owned(),
        kind: kind.to_owned(),
        link: USUAL_LINK.to_owned(),
        task: Task::Idle,
        stops: Vec::new(),
        acted: None,
        failed: false,
        interrupted: false,
        paused: None,
        fenced: None,
        service: Service::Works,
        recalls: 0,
    }
}

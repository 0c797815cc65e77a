//! Laws about jobs: every job ends or has a true reason to wait, ends are true, the floor delivers, and it drains.
//!
//! Main type: [`JobLaws`]. It compares ends with where racks and robots truly are. Refuses: to accept a reason that the
//! floor does not show.

use crate::world::World;

use super::violation::{DELIVERS, OVERDUE, Violation};
use giveway_fleet::alarm::Deliveries;
use giveway_fleet::{Fact, Fleet, Job, JobFact, JobKind, JobState, JobWhy, RackAt, Task};
use giveway_floor::id::{BodyId, JobId, RobotId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;
use std::collections::{BTreeMap, BTreeSet};

/// Number of steps between two checks of open jobs.
const LOOKS_EVERY: u64 = 100;

/// State of the laws about jobs.
#[derive(Debug)]
pub(super) struct JobLaws {
    open: BTreeMap<JobId, (JobKind, JobState, Time)>,
    /// Jobs without a true reason at the last check.
    suspects: BTreeSet<JobId>,
    deliveries: Deliveries,
    steps: u64,
}

impl JobLaws {
    pub fn new(fleet: &Fleet) -> JobLaws {
        let open = fleet.ledger().jobs.iter();
        let open = open.map(|(id, j)| (*id, (j.request.kind, j.state, j.accepted)));
        JobLaws {
            open: open.collect(),
            suspects: BTreeSet::new(),
            deliveries: Deliveries::default(),
            steps: 0,
        }
    }

    /// Checks what happened in one step.
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet, facts: &[Fact]) -> Vec<Violation> {
        let mut broken = Vec::new();
        for fact in facts {
            match fact {
                Fact::Job(JobFact::Accepted { job, request, .. }) => {
                    self.open.insert(*job, (request.kind, JobState::Waiting, now));
                }
                Fact::Job(JobFact::Changed { job, kind, .. }) => match self.open.get_mut(job) {
                    Some(entry) => entry.0 = *kind,
                    None => broken.push(Violation::JobLost(*job)),
                },
                Fact::Job(JobFact::Served { job, tasked: (robot, _), .. }) => {
                    broken.extend(self.served(*job, *robot, now, world, fleet));
                }
                Fact::Job(JobFact::Progressed { job, state, .. }) => {
                    broken.extend(self.progress(*job, *state, now, world, fleet))
                }
                _ => {}
            }
        }
        self.steps += 1;
        if self.steps.is_multiple_of(LOOKS_EVERY) {
            broken.extend(self.unexplained(now, world, fleet));
            broken.extend(self.delivers(now, fleet));
        }
        broken
    }

    /// Checks that a rack served at a station other than its last one truly stood there.
    fn served(
        &mut self,
        job: JobId,
        robot: RobotId,
        now: Time,
        world: &World,
        fleet: &Fleet,
    ) -> Option<Violation> {
        let Some((kind, before, since)) = self.open.get_mut(&job) else {
            return Some(Violation::JobLost(job));
        };
        let (was, lie) = (*kind, !happened(kind, *before, world, fleet));
        (*before, *since) = (JobState::Carrying { robot }, now);
        if let Some(next) = fleet.ledger().jobs.get(&job) {
            *kind = next.request.kind;
        }
        lie.then_some(Violation::UntrueEnd(job, was))
    }

    fn progress(
        &mut self,
        job: JobId,
        state: JobState,
        now: Time,
        world: &World,
        fleet: &Fleet,
    ) -> Option<Violation> {
        let Some(entry) = self.open.get_mut(&job) else { return Some(Violation::JobLost(job)) };
        let (kind, before, _) = *entry;
        (entry.1, entry.2) = (state, now);
        if !state.is_over() {
            return None;
        }
        self.open.remove(&job);
        let lie = state == JobState::Done && !happened(&kind, before, world, fleet);
        lie.then_some(Violation::UntrueEnd(job, kind))
    }

    /// Jobs that have been in one state for long, without a true reason now and at the previous check.
    fn unexplained(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        let overdue: Vec<(JobId, JobState)> = (self.open.iter())
            .filter(|(_, (_, _, since))| now - *since > OVERDUE)
            .map(|(id, (_, state, _))| (*id, *state))
            .collect();
        if overdue.is_empty() {
            self.suspects.clear();
            return Vec::new();
        }
        let view = fleet.view(now);
        let mut broken = Vec::new();
        let mut suspects = BTreeSet::new();
        for (id, state) in overdue {
            let Some(job) = fleet.ledger().jobs.get(&id) else { continue };
            let why = view.why_job(fleet.warehouse(), id, job);
            // A job being carried out is covered by the law about its robot's progress.
            let at_work = state.robot().is_some() && why.is_none();
            if at_work || why.is_some_and(|w| is_true(w, job, now, (world, fleet))) {
                continue;
            }
            suspects.insert(id);
            if self.suspects.contains(&id) {
                broken.push(Violation::Unexplained(id, state, why));
                self.open.get_mut(&id).expect("it is open").2 = now;
            }
        }
        self.suspects = suspects;
        broken
    }

    fn delivers(&mut self, now: Time, fleet: &Fleet) -> Option<Violation> {
        let late = self.deliveries.note(fleet, &fleet.view(now)) > DELIVERS;
        if late {
            self.deliveries.restart(now);
        }
        late.then_some(Violation::NothingDelivered)
    }
}

/// Whether a job reported as done truly was, by where racks and robots are.
fn happened(kind: &JobKind, before: JobState, world: &World, fleet: &Fleet) -> bool {
    let w = fleet.warehouse();
    let stands = |r: RobotId| world.node_of(r);
    let robot = before.robot();
    match *kind {
        JobKind::Deliver { rack, station, .. } => {
            let there = robot.and_then(stands) == Some(w.stations[station].node);
            there && robot.is_some_and(|r| world.racks()[rack] == RackAt::On(r))
        }
        JobKind::Return { rack } => {
            matches!(world.racks()[rack], RackAt::Stored(n) if w.kind(n) == NodeKind::Storage)
        }
        JobKind::Relocate { rack, node } => world.racks()[rack] == RackAt::Stored(node),
        JobKind::Charge { robot } => stands(robot).is_some_and(|n| w.kind(n) == NodeKind::Charger),
        JobKind::Park { robot } => stands(robot).is_some_and(|n| w.kind(n) == NodeKind::Parking),
        JobKind::Go { robot, node } => stands(robot) == Some(node),
    }
}

/// Whether the floor shows the reason why a job waits.
fn is_true(why: JobWhy, job: &Job, now: Time, (world, fleet): (&World, &Fleet)) -> bool {
    let ledger = fleet.ledger();
    let works = |r: RobotId| ledger.robots[r].task != Task::Idle;
    match why {
        JobWhy::After(job) => ledger.jobs.contains_key(&job),
        JobWhy::RackBusy(rack, robot, _) => {
            let fetches = matches!(ledger.robots[robot].task, Task::Fetch { rack: k, .. } if k == rack);
            // The robot has set the rack down, and its report is on the way.
            let there = world.node_of(robot).is_some_and(|n| world.racks()[rack] == RackAt::Stored(n));
            fetches || there || world.racks()[rack] == RackAt::On(robot)
        }
        JobWhy::RobotBusy(robot, _) => works(robot),
        // The law about places covers whether a displaced robot truly is.
        JobWhy::Robot(_, why) if why.is_by_itself() => true,
        JobWhy::Robot(robot, _) => works(robot),
        JobWhy::RobotLow(robot) => {
            let critical = ledger.kinds().of(&ledger.robots[robot].kind).charging.critical;
            world.truth().any(|(r, t)| r == robot && t.battery <= critical + 0.01)
        }
        JobWhy::NoRobot => !is_any_fit(fleet.view(now).free.into_keys(), job, fleet),
        JobWhy::NoKind => !is_any_fit(fleet.view(now).kinds.into_iter(), job, fleet),
        JobWhy::Outranked(ahead) => {
            let others = ledger.jobs.values().filter(|j| j.state == JobState::Waiting);
            let urgency = fleet.urgency_ms(job, now);
            let before =
                others.filter(|j| fleet.urgency_ms(j, now) >= urgency && j.request.kind.rack().is_some());
            let (higher, others): (Vec<&Job>, Vec<&Job>) =
                before.partition(|j| j.request.priority > job.request.priority);
            let counted = higher.len() >= ahead.higher && others.len() > ahead.others;
            counted && !is_any_fit(fleet.view(now).free.into_keys(), job, fleet)
        }
        JobWhy::StationFull(station) => {
            let place = &fleet.warehouse().stations[station];
            let is_taken = |n| ledger.present().any(|r| ledger.node_of(r) == n);
            place.queue.iter().chain([&place.node]).all(|n| is_taken(*n))
        }
        JobWhy::RacksWait(station, robot) => {
            let goes_there =
                |t| matches!(t, Task::Deliver { station: s, .. } if s == w_station(fleet, station));
            goes_there(ledger.robots[robot].task) && fleet.lacks_route(robot)
        }
        JobWhy::StationBlocked(_, robot) | JobWhy::WayBlocked(robot) => ledger.robots[robot].failed,
        JobWhy::StationPaused(station) => ledger.paused_stations.contains_key(&station),
        JobWhy::ClosedOff => {
            let displaced = || ledger.present().any(|r| fleet.displacement(r).is_some());
            let people = || !ledger.workers.is_empty();
            !ledger.closures.is_empty() || people() || displaced() || fleet.has_obstructions()
        }
        JobWhy::WayClosed(closure) => ledger.closures.contains_key(&closure),
        JobWhy::RackBlocked(rack, robot) => {
            let last = ledger.chain(robot).last().map(|v| v.node);
            matches!((world.racks()[rack], last), (RackAt::Stored(a), Some(b)) if a == b)
        }
        JobWhy::NodeTaken(node, robot) => {
            let ends = ledger.robots[robot].task.destination() == Some(node);
            let stands = ledger.chain(robot).last().map(|v| v.node) == Some(node);
            ends || stands && ledger.rack_on(robot).is_some()
        }
        JobWhy::NoPlace(kind) => {
            let places = fleet.warehouse().nodes_where(|k| k == kind);
            let ends = |r| ledger.chain(r).last().map(|v| v.node);
            let is_for = |r: RobotId, n| ends(r) == Some(n) || ledger.robots[r].task.destination() == Some(n);
            let taken = |n| ledger.present().any(|r| is_for(r, n));
            // Places without current are closed for a while.
            let closing = fleet.view(now).closing;
            places.into_iter().all(|n| taken(n) || closing.contains(&n))
        }
    }
}

/// Whether a robot of any of these kinds can do a job that waits for a robot.
fn is_any_fit(mut kinds: impl Iterator<Item = BodyId>, job: &Job, fleet: &Fleet) -> bool {
    let Some(rack) = job.request.kind.rack() else { return false };
    let RackAt::Stored(node) = fleet.ledger().racks[rack] else { return false };
    kinds.any(|body| job.request.is_for(fleet.warehouse(), body, (rack, node)))
}

fn w_station(fleet: &Fleet, station: giveway_floor::id::StationId) -> giveway_floor::id::NodeId {
    fleet.warehouse().stations[station].node
}

/// How many jobs are open and how many racks are not in storage.
pub(crate) fn undrained(world: &World, fleet: &Fleet) -> (usize, usize) {
    let w = fleet.warehouse();
    let stored = |at: &&RackAt| !matches!(at, RackAt::Stored(n) if w.kind(*n) == NodeKind::Storage);
    (fleet.ledger().jobs.len(), world.racks().iter().filter(stored).count())
}

/// Why the first open jobs and the first loaded robots wait.
pub(super) fn why_undrained(now: Time, fleet: &Fleet) -> Vec<String> {
    let view = fleet.view(now);
    let jobs = fleet.ledger().jobs.iter().take(3).map(|(id, job)| {
        let (kind, state, why) = (job.request.kind, job.state, view.why_job(fleet.warehouse(), *id, job));
        format!("{id:?} {kind:?} {state:?}: {why:?}")
    });
    let carries = |r: &RobotId| fleet.ledger().rack_on(*r).is_some();
    let robots = fleet.ledger().present().filter(carries).take(3).map(|r| {
        let record = &fleet.ledger().robots[r];
        let battery = fleet.telemetry(r).map_or(0.0, |t| t.battery);
        format!("{r:?} {:?}, failed {}, battery {battery:.2}: {:?}", record.task, record.failed, fleet.why(r))
    });
    jobs.chain(robots).collect()
}

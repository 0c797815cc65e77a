//! Laws that hold in every simulation, checked at every step (DESIGN §8).
//!
//! Main types: [`Laws`], [`Violation`]. They look at where robots truly are, not at what the fleet believes.
//! Refuses: to mend anything; one violation fails the run.

use super::job_laws::{DELIVERS, JobLaws, OVERDUE, undrained, why_undrained};
use super::place_laws::PlaceLaws;
use super::world::World;
use crate::fleet::{Fact, Fleet, JobKind, JobState, JobWhy, Ledger, Task, Why};
use crate::geometry::{Point, axis_distance};
use crate::id::{Dense, JobId, RackId, RobotId};
use crate::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A robot with a task, but without any progress for this long, is stuck.
pub const STUCK: Span = Span::from_secs(600);
/// Every how many steps the whole timeline and ledger are compared.
const AUDIT_EVERY: u64 = 500;
/// Rounding allowed between squares, metres.
const SLACK_M: f64 = 1e-3;

/// A broken law.
#[derive(Clone, Debug, PartialEq)]
pub enum Violation {
    /// Two robots overlap.
    Overlap(RobotId, RobotId),
    /// A robot is beyond what it was granted.
    BeyondGrant(RobotId),
    /// A robot has had a task without progress for too long.
    Stuck(RobotId, Task, Option<Why>),
    /// A job vanished.
    JobLost(JobId),
    /// A job was done twice.
    DoneTwice(JobId),
    /// A rack was lifted where it did not stand, or set down onto another one.
    Misplaced(RobotId, RackId),
    /// A job ended as what did not happen.
    UntrueEnd(JobId, JobKind),
    /// A job has been in one state for too long without a reason that is true.
    Unexplained(JobId, JobState, Option<JobWhy>),
    /// Jobs wait and robots can drive, but nothing has been delivered for too long.
    NothingDelivered,
    /// After the customers stopped, so many jobs did not end, and so many racks are not in storage.
    NotDrained(usize, usize, Vec<String>),
    /// A robot drove into a worker and did not brake.
    RunOver(RobotId, usize),
    /// A robot has been standing where the fleet does not know it to be, or is called displaced and is not.
    Misjudged(RobotId),
    /// The ledger is not the fold of the facts.
    Fold,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Violation::Overlap(a, b) => write!(f, "robots {} and {} overlap", a.0 + 1, b.0 + 1),
            Violation::BeyondGrant(r) => write!(f, "robot {} drove beyond its grant", r.0 + 1),
            Violation::Stuck(r, task, why) => {
                write!(f, "robot {} made no progress for {STUCK:?} on {task:?}: {why:?}", r.0 + 1)
            }
            Violation::JobLost(j) => write!(f, "job {j:?} was lost"),
            Violation::DoneTwice(j) => write!(f, "job {j:?} was done twice"),
            Violation::Misplaced(r, k) => {
                write!(f, "robot {} lifted rack {k:?} where it was not, or set it onto another one", r.0 + 1)
            }
            Violation::UntrueEnd(j, kind) => {
                write!(f, "job {j:?} ({kind:?}) is done, but that did not happen")
            }
            Violation::Unexplained(j, state, why) => {
                write!(f, "job {j:?} has been {state:?} for {OVERDUE:?} without a true reason: {why:?}")
            }
            Violation::NothingDelivered => {
                write!(f, "jobs wait and robots can drive, but nothing was delivered for {DELIVERS:?}")
            }
            Violation::NotDrained(jobs, racks, whys) => {
                let whys = whys.join("; ");
                write!(
                    f,
                    "the floor did not drain: {jobs} jobs are open, {racks} racks are not in storage: {whys}"
                )
            }
            Violation::RunOver(r, w) => {
                write!(f, "robot {} drove into worker {} and did not brake", r.0 + 1, w + 1)
            }
            Violation::Misjudged(r) => {
                write!(f, "robot {} does not stand where the fleet believes it to be", r.0 + 1)
            }
            Violation::Fold => write!(f, "the ledger is not the fold of its facts"),
        }
    }
}

/// Everything the laws remember.
#[derive(Debug)]
pub struct Laws {
    shadow: Ledger,
    over: BTreeSet<JobId>,
    accepted: u64,
    progress: BTreeMap<RobotId, (u64, Option<u64>, Time)>,
    run_over: usize,
    misplaced: usize,
    jobs: JobLaws,
    places: PlaceLaws,
    steps: u64,
    reach_m: f64,
    /// What was broken, and when; the first hundred.
    pub broken: Vec<(Time, Violation)>,
    /// How often laws were broken.
    pub count: u64,
}

impl Laws {
    /// Laws for a fleet that starts as `fleet` is.
    pub fn new(fleet: &Fleet) -> Laws {
        Laws {
            shadow: fleet.ledger().clone(),
            over: BTreeSet::new(),
            accepted: fleet.ledger().next_job - 1,
            progress: BTreeMap::new(),
            run_over: 0,
            misplaced: 0,
            jobs: JobLaws::new(fleet),
            places: PlaceLaws::default(),
            steps: 0,
            reach_m: fleet.warehouse().footprint_m - SLACK_M,
            broken: Vec::new(),
            count: 0,
        }
    }

    fn break_law(&mut self, now: Time, violation: Violation) {
        self.count += 1;
        if self.broken.len() < 100 {
            tracing::error!(%now, %violation, "a law is broken");
            self.broken.push((now, violation));
        }
    }

    /// Looks at the floor and at the facts of one step.
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet, facts: &[Fact]) {
        self.steps += 1;
        self.check_places(now, world);
        self.check_people(now, world);
        self.check_grants(now, world, fleet);
        self.check_jobs(now, facts, fleet);
        self.check_racks(now, world);
        let broken = self.jobs.check(now, world, fleet, facts);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.places.check(now, world, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        self.check_progress(now, fleet);
        for fact in facts {
            self.shadow.evolve(fact);
        }
        if self.steps.is_multiple_of(AUDIT_EVERY) {
            fleet.ledger().assert_sound();
            fleet.ledger().assert_indexed();
            if self.shadow != *fleet.ledger() {
                self.break_law(now, Violation::Fold);
            }
        }
    }

    /// No two robots' squares overlap: neighbours are found on a grid of cells as wide as a footprint.
    fn check_places(&mut self, now: Time, world: &World) {
        let mut places: Vec<((i64, i64), RobotId, Point)> =
            world.truth().map(|(r, t)| (self.cell(t.pose.at), r, t.pose.at)).collect();
        places.sort_unstable_by_key(|(c, r, _)| (*c, *r));
        let mut overlaps = Vec::new();
        for (i, (cell, r, at)) in places.iter().enumerate() {
            // Half of the neighbourhood: each pair is looked at once.
            for (dx, dy) in [(0, 0), (0, 1), (1, -1), (1, 0), (1, 1)] {
                let other = (cell.0 + dx, cell.1 + dy);
                let from =
                    if (dx, dy) == (0, 0) { i + 1 } else { places.partition_point(|(c, _, _)| *c < other) };
                for (_, s, there) in places[from..].iter().take_while(|(c, _, _)| *c == other) {
                    if axis_distance(*at, *there) < self.reach_m {
                        overlaps.push(Violation::Overlap(*r, *s));
                    }
                }
            }
        }
        for o in overlaps {
            self.break_law(now, o);
        }
    }

    fn cell(&self, p: Point) -> (i64, i64) {
        ((p.x / self.reach_m).floor() as i64, (p.y / self.reach_m).floor() as i64)
    }

    /// No robot drives on into a worker.
    fn check_people(&mut self, now: Time, world: &World) {
        let all = world.run_over();
        let new: Vec<(RobotId, usize)> = all[self.run_over..].to_vec();
        self.run_over = all.len();
        new.into_iter().for_each(|(r, w)| self.break_law(now, Violation::RunOver(r, w)));
    }

    /// Racks are lifted where they stand, and set down where none is.
    fn check_racks(&mut self, now: Time, world: &World) {
        let all = world.misplaced();
        let new: Vec<(RobotId, RackId)> = all[self.misplaced..].to_vec();
        self.misplaced = all.len();
        new.into_iter().for_each(|(r, k)| self.break_law(now, Violation::Misplaced(r, k)));
    }

    /// The time is up in which everything was to end after the customers stopped. Whether it has.
    pub fn check_drained(&mut self, now: Time, world: &World, fleet: &Fleet) -> bool {
        let (jobs, racks) = undrained(world, fleet);
        if jobs + racks > 0 {
            self.break_law(now, Violation::NotDrained(jobs, racks, why_undrained(now, fleet)));
        }
        jobs + racks == 0
    }

    fn check_grants(&mut self, now: Time, world: &World, fleet: &Fleet) {
        let beyond: Vec<RobotId> = (world.truth())
            .filter(|(r, t)| t.reached.max(t.known) >= fleet.ledger().chain(*r).granted())
            .map(|(r, _)| r)
            .collect();
        for r in beyond {
            self.break_law(now, Violation::BeyondGrant(r));
        }
    }

    fn check_jobs(&mut self, now: Time, facts: &[Fact], fleet: &Fleet) {
        for fact in facts {
            match fact {
                Fact::Accepted { .. } => self.accepted += 1,
                Fact::Progressed { job, state, .. } if state.is_over() && !self.over.insert(*job) => {
                    self.break_law(now, Violation::DoneTwice(*job));
                }
                Fact::Progressed { job, state: JobState::Done, .. } if job.0 > self.accepted => {
                    self.break_law(now, Violation::JobLost(*job));
                }
                _ => {}
            }
        }
        let live = fleet.ledger().jobs.len() as u64;
        if live + self.over.len() as u64 != self.accepted {
            self.break_law(now, Violation::JobLost(JobId(self.accepted)));
        }
    }

    fn check_progress(&mut self, now: Time, fleet: &Fleet) {
        for (r, record) in fleet.ledger().robots.pairs() {
            let here = (fleet.ledger().chain(r).first(), record.acted);
            let entry = self.progress.entry(r).or_insert((here.0, here.1, now));
            let halted = record.paused.is_some() || fleet.ledger().stopped.is_some();
            if (entry.0, entry.1) != here || record.task == Task::Idle || record.failed || halted {
                *entry = (here.0, here.1, now);
            } else if now - entry.2 > STUCK {
                entry.2 = now;
                let task = record.task;
                let why = fleet.why(r, now);
                self.break_law(now, Violation::Stuck(r, task, why));
            }
        }
        debug_assert!(self.progress.len() <= RobotId::at(fleet.ledger().robots.len()).ix());
    }
}

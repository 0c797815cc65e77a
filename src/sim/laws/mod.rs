//! Laws that hold in every simulation, checked at every step (DESIGN §8).
//!
//! Main types: [`Laws`], [`Violation`]. They judge by where robots truly are, not by what the fleet believes. Refuses:
//! to repair anything; one violation fails the run.

mod calm;
mod carried;
mod corridors;
mod evacuation;
mod fairness;
mod hands;
mod jobs;
mod places;
mod progress;
mod violation;
mod waits;

pub(super) use jobs::undrained;
use places::PlaceLaws;
use progress::ProgressLaws;
pub use violation::{DELIVERS, KEPT, OVERDUE, PASSED_BY, STUCK, Violation};

pub use calm::CalmFigures;

use crate::world::World;
use calm::CalmLaws;
use carried::CarryLaws;
use corridors::CorridorLaws;
use fairness::FairLaws;
use giveway_fleet::{Fact, Fleet, JobFact, JobState, Ledger};
use giveway_floor::geometry::{Point, axis_distance};
use giveway_floor::id::{JobId, RackId, RobotId};
use giveway_floor::time::Time;
use hands::HandLaws;
use jobs::{JobLaws, why_undrained};
use std::collections::BTreeSet;
use waits::WaitLaws;

/// Number of steps between two full comparisons of timeline and ledger.
const AUDIT_EVERY: u64 = 500;
/// Rounding allowed between footprints, metres.
const SLACK_M: f64 = 1e-3;

/// State of all laws.
#[derive(Debug)]
pub struct Laws {
    shadow: Ledger,
    over: BTreeSet<JobId>,
    /// How many jobs had ended before the laws began to check.
    before: u64,
    accepted: u64,
    progress: ProgressLaws,
    run_over: usize,
    misplaced: usize,
    hands: HandLaws,
    arms: (usize, usize),
    jobs: JobLaws,
    fair: FairLaws,
    places: PlaceLaws,
    waits: WaitLaws,
    calm: CalmLaws,
    carried: CarryLaws,
    corridors: CorridorLaws,
    steps: u64,
    reach_m: f64,
    /// The first hundred violations, with their times.
    pub broken: Vec<(Time, Violation)>,
    /// How many violations there were.
    pub count: u64,
}

/// Robots farther apart than this along both axes do not touch; computed anew, since kinds of robots may be added.
fn reach_m(fleet: &Fleet) -> f64 {
    2.0 * fleet.warehouse().widest_half_m() - SLACK_M
}

impl Laws {
    /// Laws for a fleet in its current state.
    pub fn new(fleet: &Fleet) -> Laws {
        Laws {
            shadow: fleet.ledger().clone(),
            over: BTreeSet::new(),
            before: fleet.ledger().next_job - 1 - fleet.ledger().jobs.len() as u64,
            accepted: fleet.ledger().next_job - 1,
            progress: ProgressLaws::default(),
            run_over: 0,
            misplaced: 0,
            hands: HandLaws::default(),
            arms: (0, 0),
            jobs: JobLaws::new(fleet),
            fair: FairLaws::new(fleet),
            places: PlaceLaws::default(),
            waits: WaitLaws::default(),
            calm: CalmLaws::default(),
            carried: CarryLaws::default(),
            corridors: CorridorLaws::default(),
            steps: 0,
            reach_m: reach_m(fleet),
            broken: Vec::new(),
            count: 0,
        }
    }

    /// How often people were kept in one spot for a minute.
    pub fn standstills(&self) -> u64 {
        self.waits.standstills()
    }

    /// How calm guidance was.
    pub fn calm(&self) -> CalmFigures {
        self.calm.figures
    }

    /// Continues with another fleet, made from `fold`, after the process died or a step panicked. What the laws
    /// remember of the floor stays.
    pub fn begin_again(&mut self, fleet: &Fleet, fold: Ledger) {
        // Facts of the new fleet that leave with its first step are in its ledger already.
        let anew = Laws { shadow: fold, ..Laws::new(fleet) };
        let old = std::mem::replace(self, anew);
        (self.run_over, self.misplaced, self.arms) = (old.run_over, old.misplaced, old.arms);
        (self.broken, self.count, self.steps) = (old.broken, old.count, old.steps);
        self.corridors = old.corridors;
        self.calm.figures = old.calm.figures;
        self.waits.keep_count(&old.waits);
    }

    /// Checks the floor alone, while there is no fleet.
    pub fn check_floor(&mut self, now: Time, world: &World) {
        self.check_places(now, world);
        self.check_people(now, world);
        self.check_racks(now, world);
        self.check_arms(now, world);
    }

    /// Records a violation.
    pub(super) fn break_law(&mut self, now: Time, violation: Violation) {
        self.count += 1;
        if self.broken.len() < 100 {
            tracing::error!(%now, %violation, "a law is broken");
            self.broken.push((now, violation));
        }
    }

    /// Checks the floor and the facts of one step.
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet, facts: &[Fact]) {
        self.steps += 1;
        self.reach_m = reach_m(fleet);
        self.check_places(now, world);
        self.check_people(now, world);
        self.check_grants(now, world, fleet);
        self.check_jobs(now, facts, fleet);
        self.check_racks(now, world);
        let broken = self.hands.check(now, world, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        self.check_arms(now, world);
        let broken = self.jobs.check(now, world, fleet, facts);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.fair.check(now, world, fleet, facts);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.places.check(now, world, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.waits.check(now, world, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.carried.check(now, world, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.calm.check(now, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.corridors.check(world, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
        evacuation::entered(fleet, facts).into_iter().for_each(|v| self.break_law(now, v));
        let broken = self.progress.check(now, world, fleet);
        broken.into_iter().for_each(|v| self.break_law(now, v));
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

    /// No two robots overlap: neighbours are found on a grid of cells as wide as the widest robot.
    fn check_places(&mut self, now: Time, world: &World) {
        let mut places: Vec<((i64, i64), RobotId, Point)> =
            world.places().map(|(r, at)| (self.cell(at), r, at)).collect();
        places.sort_unstable_by_key(|(c, r, _)| (*c, *r));
        let mut overlaps = Vec::new();
        for (i, (cell, r, at)) in places.iter().enumerate() {
            // Half of the neighbourhood: each pair is compared once.
            for (dx, dy) in [(0, 0), (0, 1), (1, -1), (1, 0), (1, 1)] {
                let other = (cell.0 + dx, cell.1 + dy);
                let from =
                    if (dx, dy) == (0, 0) { i + 1 } else { places.partition_point(|(c, _, _)| *c < other) };
                for (_, s, there) in places[from..].iter().take_while(|(c, _, _)| *c == other) {
                    if axis_distance(*at, *there) < self.reach_m && world.overlap(*r, *s, SLACK_M) {
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

    /// No moving arm touches a person, and no line is picked by both arm and hand.
    fn check_arms(&mut self, now: Time, world: &World) {
        let Some(arms) = world.arms() else { return };
        let (touched, twice) = (&arms.contacts()[self.arms.0..], &arms.twice()[self.arms.1..]);
        self.arms = (arms.contacts().len(), arms.twice().len());
        touched.iter().for_each(|s| self.break_law(now, Violation::ArmTouched(*s)));
        twice.iter().for_each(|(job, line)| self.break_law(now, Violation::PickedTwice(*job, *line)));
    }

    /// Checks at the end of the drain time that everything has ended. Gives whether it has.
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
                Fact::Job(JobFact::Accepted { .. }) => self.accepted += 1,
                Fact::Job(JobFact::Progressed { job, state, .. })
                    if state.is_over() && !self.over.insert(*job) =>
                {
                    self.break_law(now, Violation::DoneTwice(*job));
                }
                Fact::Job(JobFact::Progressed { job, state: JobState::Done, .. })
                    if job.0 > self.accepted =>
                {
                    self.break_law(now, Violation::JobLost(*job));
                }
                _ => {}
            }
        }
        let live = fleet.ledger().jobs.len() as u64;
        if self.before + live + self.over.len() as u64 != self.accepted {
            self.break_law(now, Violation::JobLost(JobId(self.accepted)));
        }
    }
}

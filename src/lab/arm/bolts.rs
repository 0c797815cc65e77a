//! The experiment "bolts on a bench" again: an arm and a person at twelve targets, by turns, reacting, and predicting
//! (Lyu et al. 2022, section IV).
//!
//! Main types: [`BoltsBench`], [`BoltsArm`], [`BoltsRun`]. Refuses: forecasts learned from the people who are measured,
//! and a planner that sees the protective stop.

use super::forecast::{Analogues, SENSOR_M, STEP_S, Watched};
use super::library::MixtureLibrary;
use super::person::{ArmJoints, BenchPerson, Reaching, certain};
use crate::arm::schedule::TargetTable;
use giveway_cell::arm::{
    ArmControl, ArmGoal, ArmKind, ArmPlan, CYCLE_S, Capsule, HORIZON, Joints, WorkPlane, joint_distance,
    least_distance_m, overlap_probability,
};
use giveway_sim::SimulatedArm;
use giveway_sim::random::Stream;
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::VecDeque;

/// How the arm works beside the person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoltsArm {
    /// The arm works only while the person does not.
    Turns,
    /// The arm avoids the person's present arm.
    Reactive,
    /// The arm avoids the forecast of the person's arm.
    Predictive,
}

impl BoltsArm {
    /// All modes.
    pub const ALL: [BoltsArm; 3] = [BoltsArm::Turns, BoltsArm::Reactive, BoltsArm::Predictive];

    /// The mode's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            BoltsArm::Turns => "turns",
            BoltsArm::Reactive => "reactive",
            BoltsArm::Predictive => "predictive",
        }
    }
}

/// Figures of one person at the bench.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoltsRun {
    /// Least distance between palm and tool's tip while the arm goes from target 7 to 6 and the person to 3,
    /// centimetres.
    pub min_distance_cm: f64,
    /// Least distance between the surfaces of both arms in that move, centimetres.
    pub min_capsule_cm: f64,
    /// Length of the tip's path in that move, centimetres.
    pub length_cm: f64,
    /// Duration of that move, seconds.
    pub time_s: f64,
    /// Targets that the arm touched per hour while the person filled all twelve.
    pub products_per_hour: f64,
    /// Overlaps of a moving arm with the person, in both parts.
    pub contacts: usize,
    /// How often the person touched an arm that stood.
    pub touched: usize,
    /// How long the person waited for the arm, seconds.
    pub person_waits_s: f64,
    /// Number of protective stops.
    pub stops: usize,
    /// Cycles in which the solver found no trajectory.
    pub unsolved: usize,
}

/// Position of target `k`, from 0: 0 to 5 in the far row, 6 to 11 in the near one, from the person's left.
pub fn target(k: usize) -> Point3<f64> {
    let (row, column) = (k / 6, (k % 6) as f64);
    Point3::new(-0.25 + 0.1 * column, if row == 0 { 0.1 } else { -0.1 }, 0.05)
}

const REST: [f64; 3] = [0.05, -0.38, 0.05];
const SHOULDER: [f64; 3] = [0.17, -0.42, 0.36];
/// Tick of the simulation, seconds.
const TICK_S: f64 = 0.01;
/// Age of observations, seconds.
const SEEN_AGO_S: f64 = 0.05;
/// Margin of the limbs' capsules for planning, as if they had the published 10 cm.
const LIMB_MARGIN_M: f64 = 0.055;
/// Where the arm waits for its turn, metres.
const PARK: [f64; 3] = [0.0, 0.2, 0.2];
/// Distance at which a target counts as reached, metres.
const THERE_M: f64 = 0.015;
/// Longest duration of a run, seconds.
const LONGEST_S: f64 = 200.0;
/// How long the person works at a target when all twelve are filled, seconds.
const WORKS_S: f64 = 2.0;
/// Number of cycles that are timed per movement.
const TIMED_CYCLES: usize = 30;
/// The published time at target 3, seconds.
const STAYS_S: f64 = 5.0;

/// The bench, and the models learned there from other people.
pub struct BoltsBench {
    seed: u64,
    control: ArmControl,
    learned: Analogues,
    library: MixtureLibrary,
    table: TargetTable,
}

/// Number of people to learn from, and how often each reaches for each target.
const TEACHERS: u64 = 8;
const REPEATS: usize = 4;

impl BoltsBench {
    /// The bench of a seed.
    pub fn new(seed: u64) -> BoltsBench {
        let base = Isometry3::translation(0.0, 0.62, 0.0);
        let plane = |normal: Vector3<f64>, offset_m: f64| WorkPlane { normal, offset_m };
        let planes = vec![
            plane(-Vector3::z(), 0.0),
            plane(Vector3::z(), 0.8),
            plane(Vector3::x(), 0.6),
            plane(-Vector3::x(), 0.6),
            plane(Vector3::y(), 1.2),
            plane(-Vector3::y(), 0.3),
        ];
        let mut kind = ArmKind::collaborative().clone();
        // The tool moves at most at 0.25 m/s, the reduced speed of arms beside people.
        kind.speed_radps = [0.25, 0.25, 0.25, 0.5, 0.5, 0.5];
        let control = ArmControl::new(kind, base, planes);
        let (mut watched, mut left_out) = (Vec::new(), Vec::new());
        let mut palms: Vec<Vec<Vec<Point3<f64>>>> = vec![Vec::new(); 12];
        for who in 0..TEACHERS + 2 {
            for (k, palms) in palms.iter_mut().enumerate() {
                for (full, reach) in recorded(seed, who, k, REPEATS) {
                    if who < TEACHERS {
                        palms.push(reach.iter().map(|joints| joints[3]).collect());
                        watched.push(full);
                    } else {
                        left_out.push(full);
                    }
                }
            }
        }
        let learned = Analogues::learn(watched, &left_out);
        let library = MixtureLibrary::learn(&palms);
        BoltsBench { seed, control, learned, library, table: TargetTable::published() }
    }

    /// Runs one person at the bench.
    pub fn run(&self, n: u64, how: BoltsArm) -> BoltsRun {
        let mut run = BoltsRun::default();
        self.one_move(n, how, &mut run);
        self.all_targets(n, how, &mut run);
        run
    }

    /// Durations of control cycles while people reach for all targets, by the caller's clock and in its unit.
    pub fn control_times(&self, clock: &mut dyn FnMut() -> f64) -> Vec<f64> {
        let mut times = Vec::new();
        for k in 0..12 {
            let mut chance = Stream::new(self.seed, 84, k as u64);
            let person = BenchPerson::random(&mut chance, SHOULDER.into());
            let work = Working::new(&mut chance, person, &[k], STAYS_S);
            let Some(mut present) = self.posture(target(6)) else { continue };
            let (mut plan, goal) =
                (ArmPlan::standing(&present), ArmGoal { tip: target(5), along: -Vector3::z() });
            for cycle in 0..TIMED_CYCLES {
                let at = |ahead: usize| BEGINS_S + (cycle + ahead) as f64 * CYCLE_S;
                let limbs = |ahead: usize| certain(&work.joints(at(ahead)), SENSOR_M).capsules(0.0);
                let limbs: Vec<Vec<Capsule>> = (0..HORIZON).map(limbs).collect();
                let begun = clock();
                let next = self.control.plan(&present, &plan, &goal, &limbs);
                times.push(clock() - begun);
                plan = next.unwrap_or_else(|_| plan.a_cycle_later());
                present = plan.steps[0];
            }
        }
        times
    }

    /// The arm goes from target 7 to 6 while the person puts a bolt to 3, stays, and leaves.
    fn one_move(&self, n: u64, how: BoltsArm, run: &mut BoltsRun) {
        let mut chance = Stream::new(self.seed, 82, n);
        let person = BenchPerson::random(&mut chance, SHOULDER.into());
        let work = Working::new(&mut chance, person, &[2], STAYS_S);
        let mut cell = BenchCell::new(self, work, how, 6, chance);
        (run.min_distance_cm, run.min_capsule_cm) = (f64::INFINITY, f64::INFINITY);
        let goal = target(5);
        let mut t = 0.0;
        while t < 20.0 {
            let is_cycle = cell.ticks.is_multiple_of(10);
            if is_cycle {
                cell.cycle(t, Some(goal), run);
            }
            t += TICK_S;
            let before = cell.arm.tip();
            let distance_m = cell.tick(run);
            let tip = cell.arm.tip();
            let palm = cell.work.joints(cell.work.now_s)[3];
            run.min_distance_cm = run.min_distance_cm.min((tip - palm).norm() * 100.0);
            run.min_capsule_cm = run.min_capsule_cm.min(distance_m * 100.0);
            run.length_cm += (tip - before).norm() * 100.0;
            if (tip - goal).norm() < THERE_M {
                break;
            }
        }
        run.time_s = t - BEGINS_S;
    }

    /// The arm touches one target after the other while the person fills all twelve in random order.
    fn all_targets(&self, n: u64, how: BoltsArm, run: &mut BoltsRun) {
        let mut chance = Stream::new(self.seed, 83, n);
        let person = BenchPerson::random(&mut chance, SHOULDER.into());
        let mut order: Vec<usize> = (0..12).collect();
        (1..12).rev().for_each(|k| order.swap(k, chance.below(k + 1)));
        let work = Working::new(&mut chance, person, &order, WORKS_S);
        let mut cell = BenchCell::new(self, work, how, 5, chance);
        let (mut aim, mut touched, mut t) = (6, 0usize, 0.0);
        while !cell.work.is_over() && t < LONGEST_S {
            let is_cycle = cell.ticks.is_multiple_of(10);
            if is_cycle {
                let open = cell.open_target(aim);
                aim = open.unwrap_or(aim);
                cell.cycle(t, open.map(target), run);
            }
            t += TICK_S;
            cell.tick(run);
            if (cell.arm.tip() - target(aim)).norm() < THERE_M {
                touched += 1;
                aim = (aim + 1) % 12;
            }
        }
        run.products_per_hour = touched as f64 / t * 3600.0;
    }

    /// The share of movements of new people whose target is recognised after these shares of their time: from the
    /// observed palms alone, and from the forecast ones as well.
    pub fn accuracy(&self, shares: &[f64], people: u64) -> Vec<(f64, f64)> {
        let mut right = vec![(0usize, 0usize); shares.len()];
        let mut count = 0;
        for who in 500..500 + people {
            for k in 0..12 {
                for (full, reach) in recorded(self.seed, who, k, 1) {
                    let begins = (BEGINS_S / STEP_S) as usize;
                    count += 1;
                    for (share, right) in shares.iter().zip(&mut right) {
                        let seen = ((reach.len() as f64 * share) as usize).max(1);
                        let palms: Vec<Point3<f64>> = reach[..seen].iter().map(|j| j[3]).collect();
                        right.0 += usize::from(self.library.target(&palms) == k);
                        let ahead = self.ahead(&palms, &full[..begins + seen]);
                        right.1 += usize::from(self.library.target(&ahead) == k);
                    }
                }
            }
        }
        right.iter().map(|(a, b)| (*a as f64 / count as f64, *b as f64 / count as f64)).collect()
    }

    /// The observed palms, followed by half a second of forecast ones.
    fn ahead(&self, palms: &[Point3<f64>], seen: &[ArmJoints]) -> Vec<Point3<f64>> {
        let forecast = self.learned.forecast(seen);
        palms.iter().copied().chain(forecast.iter().take(10).map(|limbs| limbs.points[3].mean)).collect()
    }

    /// Table II as derived from geometry: a usual person's arm at their target, and the arm's way down to its own.
    pub fn derived_table(&self, delta: f64) -> TargetTable {
        let person = BenchPerson {
            shoulder: SHOULDER.into(),
            lengths_m: [0.30, 0.26, 0.09],
            swivel: 0.0,
            pace: 1.0,
            bend: 0.12,
            habit: Vector3::zeros(),
        };
        let limbs = |k: usize| {
            let mut limbs = certain(&person.joints(target(k)), 0.03);
            limbs.bones.iter_mut().for_each(|bone| bone.radius_m += LIMB_MARGIN_M);
            limbs
        };
        let links = |k: usize| -> Vec<Vec<Capsule>> {
            let heights = [0.0, 0.05, 0.1];
            let postures = heights.iter().filter_map(|h| self.posture(target(k) + Vector3::z() * *h));
            let kind = &self.control.kind;
            let capsules =
                |q: Joints| kind.capsules(&kind.pose(&self.control.base, &q), self.control.link_margin_m);
            postures.map(capsules).collect()
        };
        let (limbs, links): (Vec<_>, Vec<_>) = (0..12).map(|k| (limbs(k), links(k))).unzip();
        TargetTable::derived(12, delta, |person, arm| {
            links[arm].iter().map(|l| overlap_probability(l, &limbs[person])).fold(0.0, f64::max)
        })
    }

    /// The share of Table II that [`BoltsBench::derived_table`] agrees with.
    pub fn table_2_agreement(&self, delta: f64) -> f64 {
        self.derived_table(delta).agreement(&TargetTable::published())
    }

    fn posture(&self, tip: Point3<f64>) -> Option<Joints> {
        let seed = [1.57, -1.3, 1.7, -1.97, -1.57, 0.0];
        let (kind, base) = (&self.control.kind, &self.control.base);
        let middle = kind.reach(base, Point3::new(0.0, 0.1, 0.2), -Vector3::z(), &seed)?;
        kind.reach(base, tip, -Vector3::z(), &middle)
    }
}

/// When the person begins, seconds.
const BEGINS_S: f64 = 0.3;
/// How far ahead people look for an arm, seconds: they give way only at the last moment.
const LOOKS_AHEAD_S: f64 = 0.12;
/// Distance that people keep from the arm, metres.
const GIVES_WAY_M: f64 = 0.005;
/// Time in which a hand stops, seconds.
const BRAKES_S: f64 = 0.1;
/// Rest between two movements, seconds.
const RESTS_S: f64 = 3.0;

/// A person who puts bolts to targets, one after the other.
struct Working {
    person: BenchPerson,
    /// For each visit: when it begins, the way there, seconds at the target, and the way back.
    visits: Vec<(f64, Reaching, f64, Reaching)>,
    /// The person's own time, seconds.
    now_s: f64,
    /// Share of the usual speed: people wait if an arm is in their way.
    pace: f64,
}

impl Working {
    fn new(chance: &mut Stream, person: BenchPerson, targets: &[usize], stays_s: f64) -> Working {
        let (mut t, mut visits) = (BEGINS_S, Vec::new());
        for k in targets {
            let there = person.reach(chance, REST.into(), target(*k));
            let back = person.reach(chance, there.to, REST.into());
            let ends = t + there.lasts_s + stays_s + back.lasts_s;
            visits.push((t, there, stays_s, back));
            t = ends + RESTS_S;
        }
        Working { person, visits, now_s: 0.0, pace: 1.0 }
    }

    fn lasts_s(&self) -> f64 {
        self.visits.last().map_or(0.0, |(t, there, stays, back)| t + there.lasts_s + stays + back.lasts_s)
    }

    /// Advances the person, unless an arm is where the hand would soon be.
    fn advance(&mut self, links: &[Capsule]) {
        let soon = certain(&self.joints(self.now_s + LOOKS_AHEAD_S), 0.0).capsules(0.0);
        let now = certain(&self.joints(self.now_s), 0.0).capsules(0.0);
        let then_m = least_distance_m(&soon, links);
        let is_free = then_m > GIVES_WAY_M || then_m > least_distance_m(&now, links);
        let change = if is_free { TICK_S } else { -TICK_S } / BRAKES_S;
        self.pace = (self.pace + change).clamp(0.0, 1.0);
        self.now_s += TICK_S * self.pace;
    }

    fn is_over(&self) -> bool {
        self.now_s >= self.lasts_s()
    }

    fn joints(&self, t: f64) -> ArmJoints {
        let visit = self.visits.iter().rev().find(|v| v.0 <= t);
        let palm = visit.map_or(REST.into(), |(begins, there, stays, back)| {
            let after = t - begins;
            let left = there.lasts_s + stays;
            if after < left { there.palm(after) } else { back.palm(after - left) }
        });
        self.person.joints(palm)
    }
}

/// Recorded movements of a person to a target: each from rest to rest, and the reach alone.
pub(super) fn recorded(seed: u64, who: u64, target: usize, times: usize) -> Vec<(Watched, Watched)> {
    let mut chance = Stream::new(seed, 81, who * 100 + target as u64);
    let person = BenchPerson::random(&mut Stream::new(seed, 80, who), SHOULDER.into());
    let mut record = || {
        let stays_s = chance.between(1.5, 6.0);
        let work = Working::new(&mut chance, person.clone(), &[target], stays_s);
        // Hands rest much of the time; a forecast must know that as well.
        let ends = work.lasts_s() + 2.5;
        let reach_s = work.visits[0].1.lasts_s;
        let full: Watched = (0..(ends / STEP_S) as usize)
            .map(|k| measured(&work.joints(k as f64 * STEP_S), &mut chance))
            .collect();
        let begins = (BEGINS_S / STEP_S) as usize;
        let reach = full[begins..begins + (reach_s / STEP_S) as usize].to_vec();
        (full, reach)
    };
    (0..times).map(|_| record()).collect()
}

fn measured(joints: &ArmJoints, chance: &mut Stream) -> ArmJoints {
    joints.map(|p| p + Vector3::new(chance.normal(), chance.normal(), chance.normal()) * SENSOR_M)
}

/// A person and an arm at the bench.
struct BenchCell<'a> {
    bench: &'a BoltsBench,
    work: Working,
    how: BoltsArm,
    arm: SimulatedArm,
    plan: ArmPlan,
    chance: Stream,
    ticks: usize,
    /// The person's recent true joints.
    past: VecDeque<ArmJoints>,
    /// Observed joints, [`STEP_S`] apart.
    seen: Watched,
    /// Palms since the hand left its resting place.
    palms: Vec<Point3<f64>>,
}

impl<'a> BenchCell<'a> {
    fn new(
        bench: &'a BoltsBench,
        work: Working,
        how: BoltsArm,
        from: usize,
        chance: Stream,
    ) -> BenchCell<'a> {
        let joints = bench.posture(target(from)).unwrap_or([1.57, -1.3, 1.7, -1.97, -1.57, 0.0]);
        let (kind, base) = (bench.control.kind.clone(), bench.control.base);
        BenchCell {
            bench,
            work,
            how,
            arm: SimulatedArm::new(kind, base, joints),
            plan: ArmPlan::standing(&joints),
            chance,
            ticks: 0,
            past: VecDeque::new(),
            seen: Vec::new(),
            palms: Vec::new(),
        }
    }

    /// Observes the person, and advances the arm; gives the distance between both, metres.
    fn tick(&mut self, run: &mut BoltsRun) -> f64 {
        self.ticks += 1;
        self.work.advance(&self.arm.links());
        let joints = self.work.joints(self.work.now_s);
        self.past.push_back(joints);
        if self.past.len() > (SEEN_AGO_S / TICK_S).round() as usize + 1 {
            self.past.pop_front();
        }
        if self.ticks.is_multiple_of(5) {
            let joints = measured(&self.past[0], &mut self.chance);
            self.seen.push(joints);
            if self.at_rest() {
                self.palms.clear();
            } else {
                self.palms.push(joints[3]);
            }
        }
        let limbs = certain(&joints, 0.0).capsules(0.0);
        run.person_waits_s += TICK_S * (1.0 - self.work.pace);
        let step = self.arm.advance(TICK_S, &limbs);
        run.contacts += usize::from(step.contact);
        run.touched += usize::from(step.touched);
        run.stops += usize::from(step.stopped);
        step.distance_m
    }

    fn at_rest(&self) -> bool {
        self.seen.last().is_none_or(|joints| (joints[3] - Point3::from(REST)).norm() < 0.06)
    }

    /// The arm's next target: one that the table does not close for the person's most probable target.
    fn open_target(&self, aim: usize) -> Option<usize> {
        if self.at_rest() || self.palms.is_empty() {
            return Some(aim);
        }
        let person = match self.how {
            BoltsArm::Turns => return None,
            BoltsArm::Reactive => self.bench.library.target(&self.palms),
            BoltsArm::Predictive => self.bench.library.target(&self.bench.ahead(&self.palms, &self.seen)),
        };
        let certain: [f64; 12] = std::array::from_fn(|k| f64::from(u8::from(k == person)));
        self.bench.table.next(&certain, aim, 0.5)
    }

    /// Runs one cycle of the planner.
    fn cycle(&mut self, t: f64, goal: Option<Point3<f64>>, run: &mut BoltsRun) {
        if t < BEGINS_S - 1e-9 {
            return;
        }
        let waits = self.how == BoltsArm::Turns && !self.at_rest();
        let goal = if waits { Some(PARK.into()) } else { goal };
        let goal = goal.unwrap_or_else(|| self.arm.tip());
        let limbs = self.limbs();
        let present = *self.arm.joints();
        if self.arm.is_stopped() || joint_distance(&self.plan.steps[0], &present) > 0.02 {
            self.plan = ArmPlan::standing(&present);
        }
        let goal = ArmGoal { tip: goal, along: -Vector3::z() };
        match self.bench.control.plan(&present, &self.plan, &goal, &limbs) {
            Ok(plan) => self.plan = plan,
            Err(_) => {
                run.unsolved += 1;
                self.plan = self.plan.a_cycle_later();
            }
        }
        self.arm.follow(&self.plan.steps, CYCLE_S);
    }

    /// The person's capsules at the planner's steps.
    fn limbs(&self) -> Vec<Vec<Capsule>> {
        let Some(now) = self.seen.last() else { return Vec::new() };
        match self.how {
            BoltsArm::Turns | BoltsArm::Reactive => {
                vec![certain(now, 0.0).capsules(LIMB_MARGIN_M)]
            }
            BoltsArm::Predictive => {
                let forecast = self.bench.learned.forecast(&self.seen);
                // Observations are SEEN_AGO_S old: the step of 0.1 s is the third of the forecast.
                let at = |k: usize| forecast.get((2 * k + 2).min(forecast.len() - 1));
                let limbs = |k: usize| at(k).map(|limbs| limbs.capsules(LIMB_MARGIN_M));
                (0..HORIZON).filter_map(limbs).collect()
            }
        }
    }
}

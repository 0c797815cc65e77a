//! The seed on intention-aware planning again: stated against sampled overlap, and 120 rounds of choosing a trajectory
//! beside a person who places things (Liu and Jebelli 2023, sections 4.3 and 6).
//!
//! Main types: [`OverlapCase`], [`Rounds`], [`RoundEnd`]. Refuses: to let the arm know the person's goal, and a
//! protective stop that would hide a bad choice.

use super::forecast::{AHEAD, Analogues, SENSOR_M, STEP_S, Watched};
use super::person::{ArmJoints, BONES, BenchPerson, Reaching, certain};
use giveway_cell::arm::{
    ArmKind, Capsule, Choice, Joints, UncertainLimbs, UncertainPoint, between, choose,
    first_order_probability, joint_distance, least_distance_m, normalised_probability, overlap_probability,
    printed_probability,
};
use giveway_sim::random::Stream;
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};

/// How the probability of an overlap is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RiskKind {
    /// Equation 15 as printed, clamped.
    Printed,
    /// Equation 15 normalised by its peak.
    Normalised,
    /// Our probability, from the capsules' distance and its spread.
    Giveway,
}

impl RiskKind {
    /// All kinds.
    pub const ALL: [RiskKind; 3] = [RiskKind::Printed, RiskKind::Normalised, RiskKind::Giveway];

    /// The kind's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            RiskKind::Printed => "printed",
            RiskKind::Normalised => "normalised",
            RiskKind::Giveway => "giveway",
        }
    }

    fn of(self, links: &[Capsule], limbs: &UncertainLimbs) -> f64 {
        match self {
            RiskKind::Printed => printed_probability(links, &limbs.capsules(0.0)),
            RiskKind::Normalised => normalised_probability(links, &limbs.capsules(0.0)),
            RiskKind::Giveway => overlap_probability(links, limbs),
        }
    }
}

/// One arm beside one person, with the probabilities of an overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlapCase {
    /// Stated probability for each [`RiskKind`], in order.
    pub stated: [f64; 3],
    /// Our probability to first order only.
    pub first_order: f64,
    /// The share of random draws that overlap.
    pub sampled: f64,
}

/// Random arms beside random people, from touching to 0.3 m apart, with spreads from 1 to 12 cm.
pub fn cases(seed: u64, count: usize, draws: usize) -> Vec<OverlapCase> {
    (0..count).map(|k| case(&mut Stream::new(seed, 71, k as u64), draws)).collect()
}

fn case(chance: &mut Stream, draws: usize) -> OverlapCase {
    let kind = ArmKind::collaborative();
    let person = BenchPerson::random(chance, Point3::new(0.15, -0.4, 0.35));
    let at = |chance: &mut Stream| {
        Point3::new(chance.between(-0.3, 0.3), chance.between(-0.25, 0.25), chance.between(0.0, 0.25))
    };
    let joints = person.joints(at(chance));
    let point = |k: usize, chance: &mut Stream| {
        let sigma = if k == 0 { chance.between(0.005, 0.03) } else { chance.between(0.01, 0.12) };
        let along = Vector3::new(chance.normal(), chance.normal(), chance.normal()).normalize();
        // Movements spread more along their path than across it.
        let cov = (Matrix3::identity() * 0.25 + along * along.transpose() * 0.75) * sigma * sigma;
        UncertainPoint { mean: joints[k], cov }
    };
    let points = (0..4).map(|k| point(k, chance)).collect();
    let limbs = UncertainLimbs { points, bones: BONES.to_vec() };
    let turn =
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), chance.between(0.0, std::f64::consts::TAU));
    let base = Isometry3::from_parts(Translation3::new(0.0, 0.55, 0.0), turn);
    let mut posture = [0.0, -1.6, 1.6, -1.6, -1.6, 0.0];
    posture.iter_mut().for_each(|q| *q += chance.between(-1.2, 1.2));
    let links = kind.capsules(&kind.pose(&base, &posture), 0.0);
    let links = placed(links, &limbs.capsules(0.0), chance.between(-0.06, 0.3));
    let stated = RiskKind::ALL.map(|risk| risk.of(&links, &limbs));
    let sampled = sampled(chance, &links, &limbs, draws);
    OverlapCase { stated, first_order: first_order_probability(&links, &limbs), sampled }
}

/// The links, moved along the closest direction until the least distance is about this.
fn placed(mut links: Vec<Capsule>, limbs: &[Capsule], distance_m: f64) -> Vec<Capsule> {
    for _ in 0..4 {
        let pairs = links.iter().flat_map(|a| limbs.iter().map(move |b| (a, b)));
        let least = pairs.min_by(|x, y| x.0.distance_m(x.1).total_cmp(&y.0.distance_m(y.1)));
        let Some((link, limb)) = least else { break };
        let shift = link.nearest(limb).normal() * (distance_m - link.distance_m(limb));
        for link in &mut links {
            (link.a, link.b) = (link.a + shift, link.b + shift);
        }
    }
    links
}

fn sampled(chance: &mut Stream, links: &[Capsule], limbs: &UncertainLimbs, draws: usize) -> f64 {
    let root = |p: &UncertainPoint| p.cov.cholesky().map_or_else(Matrix3::zeros, |c| c.l());
    let roots: Vec<Matrix3<f64>> = limbs.points.iter().map(root).collect();
    let mut overlaps = 0;
    for _ in 0..draws {
        let mut drawn = [Point3::origin(); 4];
        for (k, at) in drawn.iter_mut().enumerate() {
            let error = Vector3::new(chance.normal(), chance.normal(), chance.normal());
            *at = limbs.points[k].mean + roots[k] * error;
        }
        let limb = |b: &giveway_cell::arm::LimbBone| Capsule {
            a: drawn[b.from],
            b: drawn[b.to],
            radius_m: b.radius_m,
        };
        let bodies: [Capsule; 3] = std::array::from_fn(|k| limb(&limbs.bones[k]));
        overlaps += usize::from(bodies.iter().any(|b| links.iter().any(|l| l.distance_m(b) < 0.0)));
    }
    overlaps as f64 / draws as f64
}

/// Expected calibration error with ten bins of equal width: the mean over cases of how far a bin's mean sampled
/// overlap lies from its mean stated one.
pub fn calibration_error(pairs: &[(f64, f64)]) -> f64 {
    const BINS: usize = 10;
    let mut bins = [(0.0, 0.0); BINS];
    for (stated, sampled) in pairs {
        let bin = ((stated * BINS as f64) as usize).min(BINS - 1);
        bins[bin].0 += stated;
        bins[bin].1 += sampled;
    }
    bins.iter().map(|(stated, sampled)| (stated - sampled).abs()).sum::<f64>() / pairs.len().max(1) as f64
}

/// Why a round failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Failure {
    /// The person was elsewhere than forecast.
    Forecast,
    /// The observation behind the decision was late.
    Lag,
    /// A choice did not reach the arm.
    Link,
}

/// Result of one round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoundEnd {
    /// Why arm and person overlapped, if they did.
    pub failure: Option<Failure>,
    /// Number of decisions.
    pub decisions: usize,
    /// Decisions that left the planned path though following it for a second would have met nobody.
    pub needless: usize,
    /// Whether the arm reached a place.
    pub reached: bool,
}

/// How long a round lasts, seconds.
const ROUND_S: f64 = 8.0;
/// How long the arm picks after its arrival, seconds.
const PICKS_S: f64 = 0.6;
/// Interval of decisions, seconds.
const DECIDE_S: f64 = 0.2;
/// Interval of checks for overlaps, seconds.
const LOOK_S: f64 = 0.02;
/// Number of steps of a trajectory, [`STEP_S`] apart, that are evaluated: every second one.
const JUDGED: usize = AHEAD / 2;
/// Age of the observation behind a decision, usually and if it is late, seconds; then the probabilities of a late
/// observation and of a lost choice.
const DELAYS_S: [f64; 2] = [0.05, 0.35];
const LATE: f64 = 0.02;
const LOST: f64 = 0.01;

/// A bench with three places, an arm and people.
pub struct Rounds {
    seed: u64,
    base: Isometry3<f64>,
    home: Joints,
    goals: Vec<Joints>,
    aside: Vec<Joints>,
    learned: Analogues,
}

/// What is known when the arm decides.
pub struct Deciding {
    seen: Watched,
    present: Joints,
    aim: Joints,
}

const PLACES: [[f64; 3]; 3] = [[-0.25, 0.0, 0.06], [0.0, 0.0, 0.06], [0.25, 0.0, 0.06]];
const REST: [f64; 3] = [0.1, -0.4, 0.03];
const SHOULDER: [f64; 3] = [0.15, -0.42, 0.35];

impl Rounds {
    /// The bench; forecasts are learned from other people.
    pub fn new(seed: u64) -> Rounds {
        let base = Isometry3::translation(0.0, 0.6, 0.0);
        let kind = ArmKind::collaborative();
        let seed_posture = [1.57, -1.3, 1.7, -1.97, -1.57, 0.0];
        let down = -Vector3::z();
        let place = |p: [f64; 3], from: &Joints| kind.reach(&base, p.into(), down, from).unwrap_or(*from);
        let home = place([0.0, 0.25, 0.30], &seed_posture);
        let goals = PLACES.iter().map(|p| place(*p, &home)).collect();
        let high = PLACES.iter().map(|p| place([p[0], 0.15, 0.28], &home));
        let aside = high.chain([home]).collect();
        let people = |from: u64, count: u64| -> Vec<Watched> {
            (from..from + count).flat_map(|who| watch_person(seed, who, 12)).collect()
        };
        let learned = Analogues::learn(people(1000, 8), &people(2000, 3));
        Rounds { seed, base, home, goals, aside, learned }
    }

    /// Plays round number `n` with this threshold.
    pub fn play(&self, n: u64, delta: f64, risk: RiskKind) -> RoundEnd {
        let mut world = RoundWorld::new(self, n);
        let mut end = RoundEnd { failure: None, decisions: 0, needless: 0, reached: false };
        let (mut way, mut begun, mut fault) = (vec![self.home], 0.0, None);
        let (mut t, mut next, mut leaves) = (world.starts_s, world.starts_s, f64::INFINITY);
        while t < ROUND_S {
            if t >= next {
                next += DECIDE_S;
                let (deciding, late, lost) = world.observe(t);
                let (choice, chosen) = self.decide(&deciding, delta, risk);
                end.decisions += 1;
                let needless = choice != Choice::Planned && !world.would_meet(t, &deciding);
                end.needless += usize::from(needless);
                fault = if lost { Some(Failure::Link) } else { late.then_some(Failure::Lag) };
                if !lost {
                    (way, begun) = (chosen, t);
                }
            }
            t += LOOK_S;
            world.present = at_time(&way, t - begun);
            if least_distance_m(&self.links(&world.present), &world.limbs(t)) < 0.0 {
                end.failure = Some(fault.unwrap_or(Failure::Forecast));
                return end;
            }
            if !end.reached && joint_distance(&world.present, &world.aim) < 0.02 {
                (end.reached, leaves) = (true, t + PICKS_S);
            }
            if t >= leaves {
                world.aim = self.home;
            }
        }
        end
    }

    /// A typical state for measuring the cost of a decision.
    pub fn moment(&self, n: u64) -> Deciding {
        let mut world = RoundWorld::new(self, n);
        world.present = between(&self.home, &world.aim, 0.3);
        world.observe(world.starts_s).0
    }

    /// The forecast for a state.
    pub fn forecast(&self, deciding: &Deciding) -> Vec<UncertainLimbs> {
        self.learned.forecast(&deciding.seen)
    }

    /// The choice by a forecast, and its trajectory.
    pub fn choose(
        &self,
        deciding: &Deciding,
        forecast: &[UncertainLimbs],
        delta: f64,
        risk: RiskKind,
    ) -> (Choice, Vec<Joints>) {
        let planned = self.trajectory(&deciding.present, &deciding.aim);
        let others = self.goals.iter().chain(&self.aside);
        let set: Vec<Vec<Joints>> = others.map(|to| self.trajectory(&deciding.present, to)).collect();
        let judged = |way: &[Joints]| -> Vec<Joints> { way.iter().skip(1).step_by(2).copied().collect() };
        let probability = |q: &Joints, step: usize| match forecast.get(2 * step + 1) {
            Some(limbs) => risk.of(&self.links(q), limbs),
            None => 0.0,
        };
        let short: Vec<Vec<Joints>> = set.iter().map(|way| judged(way)).collect();
        let choice = choose(&deciding.present, &judged(&planned), &short, delta, probability);
        let way = match choice {
            Choice::Planned => planned,
            Choice::Other(k) => set[k].clone(),
            Choice::Stand => vec![deciding.present],
        };
        (choice, way)
    }

    fn decide(&self, deciding: &Deciding, delta: f64, risk: RiskKind) -> (Choice, Vec<Joints>) {
        self.choose(deciding, &self.forecast(deciding), delta, risk)
    }

    fn links(&self, joints: &Joints) -> Vec<Capsule> {
        let kind = ArmKind::collaborative();
        kind.capsules(&kind.pose(&self.base, joints), 0.0)
    }

    /// One second of the straight path there, at most as fast as the axes allow.
    fn trajectory(&self, from: &Joints, to: &Joints) -> Vec<Joints> {
        let kind = ArmKind::collaborative();
        let takes = (0..6).map(|k| (to[k] - from[k]).abs() / kind.speed_radps[k]).fold(1e-6, f64::max);
        (1..=AHEAD).map(|h| between(from, to, (h as f64 * STEP_S / takes).min(1.0))).collect()
    }
}

/// The configuration of a trajectory after a time.
fn at_time(way: &[Joints], after_s: f64) -> Joints {
    let exact = (after_s / STEP_S - 1.0).clamp(0.0, (way.len() - 1) as f64);
    let low = exact as usize;
    between(&way[low], &way[(low + 1).min(way.len() - 1)], exact - low as f64)
}

/// A person who places something and comes back.
struct Placing {
    person: BenchPerson,
    there: Reaching,
    back: Reaching,
    stays_s: f64,
    begins_s: f64,
}

impl Placing {
    fn random(chance: &mut Stream, person: BenchPerson) -> Placing {
        let place = PLACES[chance.below(3)];
        let there = person.reach(chance, REST.into(), place.into());
        let back = person.reach(chance, there.to, REST.into());
        let (stays_s, begins_s) = (chance.between(0.3, 1.2), chance.between(0.25, 1.2));
        Placing { person, there, back, stays_s, begins_s }
    }

    fn joints(&self, t: f64) -> ArmJoints {
        let after = t - self.begins_s;
        let left = self.there.lasts_s + self.stays_s;
        let palm = if after < left { self.there.palm(after) } else { self.back.palm(after - left) };
        self.person.joints(palm)
    }
}

/// Recorded movements of a person.
fn watch_person(seed: u64, who: u64, movements: usize) -> Vec<Watched> {
    let mut chance = Stream::new(seed, 72, who);
    let person = BenchPerson::random(&mut chance, SHOULDER.into());
    let mut watch = || {
        let placing = Placing::random(&mut chance, person.clone());
        let steps = (5.0 / STEP_S) as usize;
        (0..steps).map(|k| measured(&placing.joints(k as f64 * STEP_S), &mut chance)).collect()
    };
    (0..movements).map(|_| watch()).collect()
}

fn measured(joints: &ArmJoints, chance: &mut Stream) -> ArmJoints {
    joints.map(|p| p + Vector3::new(chance.normal(), chance.normal(), chance.normal()) * SENSOR_M)
}

/// The true state of one round.
struct RoundWorld<'a> {
    rounds: &'a Rounds,
    placing: Placing,
    chance: Stream,
    present: Joints,
    aim: Joints,
    starts_s: f64,
}

impl<'a> RoundWorld<'a> {
    fn new(rounds: &'a Rounds, n: u64) -> RoundWorld<'a> {
        let mut chance = Stream::new(rounds.seed, 73, n);
        let person = BenchPerson::random(&mut chance, SHOULDER.into());
        let placing = Placing::random(&mut chance, person);
        let aim = rounds.goals[chance.below(3)];
        // The arm should be there at about the same time as the person.
        let starts_s = (placing.begins_s + chance.between(-0.5, 0.8)).max(0.0);
        RoundWorld { rounds, placing, chance, present: rounds.home, aim, starts_s }
    }

    fn limbs(&self, t: f64) -> Vec<Capsule> {
        certain(&self.placing.joints(t), 0.0).capsules(0.0)
    }

    /// The observation at a time, whether it is late, and whether the choice will be lost.
    fn observe(&mut self, t: f64) -> (Deciding, bool, bool) {
        let late = self.chance.happens_of(LATE);
        let lost = self.chance.happens_of(LOST);
        let seen_at = t - DELAYS_S[usize::from(late)];
        let seen = (0..5).rev().map(|k| self.placing.joints(seen_at - f64::from(k) * STEP_S));
        let seen: Vec<ArmJoints> = seen.collect();
        let seen = seen.iter().map(|joints| measured(joints, &mut self.chance)).collect();
        (Deciding { seen, present: self.present, aim: self.aim }, late, lost)
    }

    /// Whether the planned path, followed for a second, would truly have met the person.
    fn would_meet(&self, t: f64, deciding: &Deciding) -> bool {
        let way = self.rounds.trajectory(&deciding.present, &deciding.aim);
        (0..50).map(|k| f64::from(k) * LOOK_S).any(|after| {
            let links = self.rounds.links(&at_time(&way, after));
            least_distance_m(&links, &self.limbs(t + after)) < 0.0
        })
    }
}

/// Number of steps of a trajectory that are evaluated.
pub const fn judged_steps() -> usize {
    JUDGED
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stated_probabilities_are_those_of_samples_and_the_printed_ones_are_not() {
        let cases = cases(1, 60, 3000);
        let error = |k: usize| {
            let pairs: Vec<(f64, f64)> = cases.iter().map(|c| (c.stated[k], c.sampled)).collect();
            calibration_error(&pairs)
        };
        assert!(error(2) < 0.03, "ours: {}", error(2));
        assert!(error(0) > 0.1, "as printed: {}", error(0));
        assert!(error(1) > error(2), "normalised: {}", error(1));
    }

    #[test]
    fn what_is_stated_as_it_is_has_no_calibration_error() {
        assert_eq!(calibration_error(&[(0.1, 0.1), (0.9, 0.9)]), 0.0);
        assert!((calibration_error(&[(0.1, 0.3), (0.15, 0.0), (0.9, 0.9)]) - 0.05 / 3.0).abs() < 1e-12);
    }
}

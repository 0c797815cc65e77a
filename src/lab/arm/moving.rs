//! How smoothly an arm moves beside a person: planned without the person's arm, with the present one, and with forecast
//! ones (Liu et al. 2024, table III).
//!
//! Main types: [`Sight`], [`Smoothness`]. Refuses: a path that was not checked; if there is none the arm waits.

use super::forecast::{Analogues, STEP_S, Watched};
use super::person::{ArmJoints, BenchPerson, Reaching, certain};
use super::planners::space_with;
use crate::arm::net::{GraphNet, WorkGraph};
use giveway_cell::arm::{ArmSpace, ArmWay, Capsule, Joints, joint_distance, least_distance_m, rrt_connect};
use giveway_sim::random::Stream;
use nalgebra::{Point3, Vector3};

/// What the planner knows of the person's arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// Nothing.
    NoArm,
    /// The present position.
    Present,
    /// The present position and the forecast ones, widened by two standard deviations.
    Forecast,
}

impl Sight {
    /// All cases.
    pub const ALL: [Sight; 3] = [Sight::NoArm, Sight::Present, Sight::Forecast];

    /// The case's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            Sight::NoArm => "no_arm",
            Sight::Present => "present",
            Sight::Forecast => "forecast",
        }
    }
}

/// Means over all steps and axes of all motions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Smoothness {
    /// Mean absolute acceleration, rad/s².
    pub acceleration: f64,
    /// Mean absolute jerk, rad/s³.
    pub jerk: f64,
    /// Share of motions in which arm and person overlapped.
    pub met: f64,
    /// Mean time to the goal, seconds.
    pub time_s: f64,
    /// Number of replans per motion.
    pub replans: f64,
}

/// Interval of the arm's steps, seconds, and of the planner, steps.
const TICK_S: f64 = 0.02;
const PLANS_TICKS: usize = 5;
/// Speed along the path, and its acceleration.
const SPEED_RADPS: f64 = 0.8;
const SPEEDS_UP_RADPS2: f64 = 2.0;
/// Longest duration of a motion, seconds.
const LONGEST_S: f64 = 12.0;
const CONNECT_SAMPLES: usize = 3000;
const NET_STEPS: usize = 12;

const SHOULDER: [f64; 3] = [0.1, -1.0, 0.4];
const REST: [f64; 3] = [0.05, -0.8, 0.05];

/// The three cases, each over `motions` motions, with a net learned elsewhere.
pub fn cases(seed: u64, net: &GraphNet, motions: u64) -> [Smoothness; 3] {
    let people = |from: u64, count: u64| -> Vec<Watched> {
        (from..from + count).flat_map(|n| watched(seed, n)).collect()
    };
    let learned = Analogues::learn(people(1000, 60), &people(2000, 10));
    Sight::ALL.map(|sight| {
        let all: Vec<Smoothness> = (0..motions).map(|n| motion(seed, n, net, &learned, sight)).collect();
        let mean = |of: fn(&Smoothness) -> f64| all.iter().map(of).sum::<f64>() / all.len().max(1) as f64;
        Smoothness {
            acceleration: mean(|s| s.acceleration),
            jerk: mean(|s| s.jerk),
            met: mean(|s| s.met),
            time_s: mean(|s| s.time_s),
            replans: mean(|s| s.replans),
        }
    })
}

/// A person who reaches into the arm's place and stays there a while.
struct Intruder {
    person: BenchPerson,
    there: Reaching,
    begins_s: f64,
}

impl Intruder {
    fn new(seed: u64, n: u64) -> Intruder {
        let mut chance = Stream::new(seed, 98, n);
        let person = BenchPerson::random(&mut chance, SHOULDER.into());
        let goal =
            Point3::new(chance.between(-0.15, 0.2), chance.between(-0.5, -0.4), chance.between(0.1, 0.25));
        let there = person.reach(&mut chance, REST.into(), goal);
        Intruder { person, there, begins_s: chance.between(0.2, 0.9) }
    }

    fn joints(&self, t: f64) -> ArmJoints {
        self.person.joints(self.there.palm(t - self.begins_s))
    }
}

fn watched(seed: u64, n: u64) -> Vec<Watched> {
    let intruder = Intruder::new(seed, n);
    vec![(0..80).map(|k| intruder.joints(f64::from(k) * STEP_S)).collect()]
}

/// Runs one motion: the tool from one side to the other.
fn motion(seed: u64, n: u64, net: &GraphNet, learned: &Analogues, sight: Sight) -> Smoothness {
    let intruder = Intruder::new(seed, n);
    let mut chance = Stream::new(seed, 99, n);
    let mut draw = || chance.unit();
    let Some((start, goal)) = ends(&mut draw) else { return Smoothness::default() };
    let (mut at, mut speed, mut along) = (start, 0.0, 0.0);
    let mut way: Option<ArmWay> = None;
    let (mut path, mut result) = (vec![start], Smoothness::default());
    let mut seen: Watched = (0..5).map(|_| intruder.joints(0.0)).collect();
    let mut ticks = 0;
    while ticks as f64 * TICK_S < LONGEST_S && joint_distance(&at, &goal) > 0.01 {
        let t = ticks as f64 * TICK_S;
        if ticks % PLANS_TICKS == 0 {
            seen.push(intruder.joints(t));
            let (space, graph) = known(sight, &seen, learned);
            let rest = way.as_ref().map(|way| rest_of(way, along));
            let is_free = rest.is_some_and(|rest| space.check(rest).is_some());
            if !is_free {
                result.replans += f64::from(u8::from(way.is_some()));
                let found = net.plan(&space, &graph, &at, &goal, NET_STEPS);
                way = found.or_else(|| {
                    let way = rrt_connect(&space, &at, &goal, CONNECT_SAMPLES, &mut draw)?;
                    Some(space.shortened(&way, 30, &mut draw))
                });
                along = 0.0;
            }
        }
        if let Some(way) = &way {
            let left = way.length_rad() - along;
            let most = SPEED_RADPS.min((2.0 * SPEEDS_UP_RADPS2 * left.max(0.0)).sqrt());
            speed = (speed + SPEEDS_UP_RADPS2 * TICK_S).min(most);
            along += speed * TICK_S;
            at = way.at_rad(along);
        } else {
            speed = 0.0;
        }
        ticks += 1;
        path.push(at);
        let links = space_with(Vec::new());
        let links = links.kind.capsules(&links.kind.pose(&links.base, &at), 0.0);
        let limbs = certain(&intruder.joints(ticks as f64 * TICK_S), 0.0).capsules(0.0);
        if least_distance_m(&links, &limbs) < 0.0 {
            result.met = 1.0;
        }
    }
    result.time_s = ticks as f64 * TICK_S;
    (result.acceleration, result.jerk) = changes(&path);
    result
}

/// Start and goal on both sides of the table before the arm.
fn ends(draw: &mut dyn FnMut() -> f64) -> Option<(Joints, Joints)> {
    let space = space_with(Vec::new());
    let seed = [1.57, -1.3, 1.7, -1.97, -1.57, 0.0];
    let mut at = |x: f64| {
        let tip = Point3::new(x + 0.05 * draw(), -0.45 + 0.05 * draw(), 0.15 + 0.05 * draw());
        space.kind.reach(&space.base, tip, -Vector3::z(), &seed)
    };
    Some((at(-0.35)?, at(0.3)?))
}

/// The arm's space with what is known of the person, and the same for the net.
fn known(sight: Sight, seen: &Watched, learned: &Analogues) -> (ArmSpace, WorkGraph) {
    let now = seen[seen.len() - 1];
    let present = certain(&now, 0.0).capsules(0.01);
    let forecast = if sight == Sight::Forecast { learned.forecast(&at_steps(seen)) } else { Vec::new() };
    let ahead = [2, 5, 9, 13, 19];
    let arms: [ArmJoints; 5] =
        ahead.map(|h| forecast.get(h).map_or(now, |limbs| std::array::from_fn(|k| limbs.points[k].mean)));
    let mut obstacles: Vec<Capsule> = if sight == Sight::NoArm { Vec::new() } else { present };
    // Two standard deviations, but no more than 10 cm.
    let later = ahead.iter().filter_map(|h| forecast.get(*h)).flat_map(|limbs| {
        let mut capsules = limbs.thickened(2.0);
        capsules.iter_mut().for_each(|c| c.radius_m = c.radius_m.min(0.15));
        capsules
    });
    obstacles.extend(later);
    (space_with(obstacles), WorkGraph::new(&[], &now, &arms))
}

/// Observations every 0.1 s, resampled to every [`STEP_S`] as forecasts need: halfway between two.
fn at_steps(seen: &Watched) -> Watched {
    let middle = |a: &ArmJoints, b: &ArmJoints| std::array::from_fn(|k| a[k] + (b[k] - a[k]) * 0.5);
    let pairs = seen.windows(2).flat_map(|pair| [middle(&pair[0], &pair[1]), pair[1]]);
    pairs.collect()
}

/// The remaining configurations of a path.
fn rest_of(way: &ArmWay, along: f64) -> Vec<Joints> {
    let mut rest = vec![way.at_rad(along)];
    let mut length = 0.0;
    for pair in way.configurations().windows(2) {
        length += joint_distance(&pair[0], &pair[1]);
        if length > along {
            rest.push(pair[1]);
        }
    }
    rest
}

/// Mean absolute second and third differences.
fn changes(path: &[Joints]) -> (f64, f64) {
    // Over 0.1 s, like the planner's cycle.
    let coarse: Vec<&Joints> = path.iter().step_by(PLANS_TICKS).collect();
    let dt = TICK_S * PLANS_TICKS as f64;
    let differences = |of: &[Joints]| -> Vec<Joints> {
        of.windows(2).map(|p| std::array::from_fn(|k| (p[1][k] - p[0][k]) / dt)).collect()
    };
    let mean =
        |of: &[Joints]| of.iter().flatten().map(|x| x.abs()).sum::<f64>() / (6 * of.len().max(1)) as f64;
    let speeds = differences(&coarse.into_iter().copied().collect::<Vec<_>>());
    let accelerations = differences(&speeds);
    let jerks = differences(&accelerations);
    (mean(&accelerations), mean(&jerks))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_motion_has_neither_acceleration_nor_jerk_and_a_corner_has_both() {
        let even: Vec<Joints> = (0..60).map(|k| [f64::from(k) * 0.01; 6]).collect();
        let (a, j) = changes(&even);
        assert!(a < 1e-9 && j < 1e-6, "{a} {j}");
        let corner: Vec<Joints> = (0..60).map(|k| [(f64::from(k) - 30.0).abs() * 0.01; 6]).collect();
        let (a, j) = changes(&corner);
        assert!(a > 0.5 && j > a, "{a} {j}");
    }
}

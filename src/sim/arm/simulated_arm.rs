//! A robot arm that follows trajectories, with its own protective stop.
//!
//! Main types: [`SimulatedArm`], [`StopRule`]. The stop knows nothing of the planner: it sees true distances a little
//! late and brakes along the path. Refuses: trajectories that do not begin where the arm is.

use giveway_cell::arm::{ArmKind, Capsule, Joints, between, joint_distance, least_distance_m};
use nalgebra::Isometry3;

/// When the arm's own stop acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopRule {
    /// Delay from a measured distance to the brakes, seconds.
    pub react_s: f64,
    /// Time from full speed to a stand, seconds.
    pub brake_s: f64,
    /// Distance that must remain at the stand, metres.
    pub left_m: f64,
    /// Additional distance before the arm moves on, metres …
    pub hysteresis_m: f64,
    /// … and for how long it must last, seconds.
    pub clear_s: f64,
}

impl Default for StopRule {
    fn default() -> StopRule {
        StopRule { react_s: 0.05, brake_s: 0.15, left_m: 0.02, hysteresis_m: 0.03, clear_s: 0.2 }
    }
}

/// Outcome of one simulation step of an arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmStep {
    /// Whether arm and person overlap while the arm moves.
    pub contact: bool,
    /// Whether the person overlaps an arm that stands.
    pub touched: bool,
    /// Whether the protective stop began.
    pub stopped: bool,
    /// Least distance between the surfaces of arm and person, metres.
    pub distance_m: f64,
}

/// A simulated arm and its state.
#[derive(Clone, Debug)]
pub struct SimulatedArm {
    kind: ArmKind,
    base: Isometry3<f64>,
    rule: StopRule,
    joints: Joints,
    /// Configurations at this interval; the first is where the arm was when the trajectory began.
    way: Vec<Joints>,
    step_s: f64,
    at_s: f64,
    /// Share of the trajectory's speed: 1 follows it, 0 stands.
    pace: f64,
    is_stopped: bool,
    /// For how long there has been room enough to go on, seconds.
    clear_s: f64,
    /// The person's limbs a step ago.
    before: Vec<Capsule>,
}

/// A trajectory does not begin if its start is farther than this from the arm's joints, radians.
const OFF_RAD: f64 = 0.02;
/// Distance that an arm may start at from a person who does not come nearer, metres.
const RESTS_M: f64 = 0.02;
/// A person slower than this does not come nearer, metres per second.
const COMES_NEARER_MPS: f64 = 0.01;

impl SimulatedArm {
    /// An arm that stands at these joints.
    pub fn new(kind: ArmKind, base: Isometry3<f64>, joints: Joints) -> SimulatedArm {
        let way = vec![joints];
        let rule = StopRule::default();
        SimulatedArm {
            kind,
            base,
            rule,
            joints,
            way,
            step_s: 0.1,
            at_s: 0.0,
            pace: 1.0,
            is_stopped: false,
            clear_s: 0.0,
            before: Vec::new(),
        }
    }

    /// The arm with another stop rule.
    pub fn with_rule(self, rule: StopRule) -> SimulatedArm {
        SimulatedArm { rule, ..self }
    }

    /// The arm's joint angles.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Whether the arm's own stop holds it.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Where the tool's tip is.
    pub fn tip(&self) -> nalgebra::Point3<f64> {
        self.kind.pose(&self.base, &self.joints).points[7]
    }

    /// The arm's links with their thickness.
    pub fn links(&self) -> Vec<Capsule> {
        self.kind.capsules(&self.kind.pose(&self.base, &self.joints), 0.0)
    }

    /// Takes a trajectory from now on: its configurations are `step_s` apart, the first one `step_s` from now. A
    /// trajectory that does not begin where the arm is, or that the arm cannot follow, is dropped: the arm keeps the
    /// one it has. While its own stop holds the arm, it takes only a trajectory that leads away from the person.
    pub fn follow(&mut self, steps: &[Joints], step_s: f64) -> bool {
        let can = |q: &Joints| q.iter().all(|x| x.is_finite()) && self.kind.allows(q);
        let fastest = self.kind.speed_radps.iter().map(|v| v * v).sum::<f64>().sqrt();
        let near =
            steps.first().is_some_and(|q| joint_distance(q, &self.joints) < fastest * step_s + OFF_RAD);
        if !near || !steps.iter().all(can) || (self.is_stopped && !self.leads_away(steps)) {
            return false;
        }
        self.way = std::iter::once(self.joints).chain(steps.iter().copied()).collect();
        (self.step_s, self.at_s, self.is_stopped) = (step_s, 0.0, false);
        true
    }

    /// Whether the arm stands and these configurations move farther and farther from where the person was seen.
    fn leads_away(&self, steps: &[Joints]) -> bool {
        let distance = |q: &Joints| {
            let links = self.kind.capsules(&self.kind.pose(&self.base, q), 0.0);
            least_distance_m(&links, &self.before)
        };
        let all: Vec<f64> = std::iter::once(&self.joints).chain(steps).map(distance).collect();
        let enough = self.rule.left_m + self.rule.hysteresis_m;
        let away = |pair: &[f64]| pair[1] >= pair[0] || pair[1] > enough;
        self.pace <= 0.0 && all.windows(2).all(away) && all.last() > all.first()
    }

    /// Advances the arm by `dt_s` beside a person with these limbs.
    pub fn advance(&mut self, dt_s: f64, limbs: &[Capsule]) -> ArmStep {
        let links_before = self.links();
        let before = self.joints;
        let change = dt_s / self.rule.brake_s;
        self.pace =
            if self.is_stopped { (self.pace - change).max(0.0) } else { (self.pace + change).min(1.0) };
        self.at_s += dt_s * self.pace;
        let exact = (self.at_s / self.step_s).clamp(0.0, (self.way.len() - 1) as f64);
        let low = exact as usize;
        self.joints =
            between(&self.way[low], &self.way[(low + 1).min(self.way.len() - 1)], exact - low as f64);
        let moved = joint_distance(&before, &self.joints);
        let distance_m = least_distance_m(&self.links(), limbs);
        let step = ArmStep {
            contact: distance_m < 0.0 && moved > 1e-5,
            touched: distance_m < 0.0 && moved <= 1e-5,
            stopped: self.guard(dt_s, &links_before, limbs),
            distance_m,
        };
        self.before = limbs.to_vec();
        step
    }

    /// The protective stop: while a link and a limb come nearer, they must stay apart if both go on as they do until
    /// the arm stands (ISO/TS 15066, 5.5.4, with directed speeds of both). An arm that stands is held in the same way
    /// (5.5.2, monitored standstill), so that it does not start towards a person. Gives whether it stopped a moving
    /// arm.
    fn guard(&mut self, dt_s: f64, links_before: &[Capsule], limbs: &[Capsule]) -> bool {
        let links = self.links();
        let takes_s = self.rule.react_s + self.rule.brake_s;
        let (mut least, mut is_clear) = (f64::INFINITY, true);
        for (link, link_before) in links.iter().zip(links_before) {
            for (limb, limb_before) in limbs.iter().zip(&self.before) {
                let nearest = link.nearest(limb);
                let normal = nearest.normal();
                let arm = (link.at(nearest.s) - link_before.at(nearest.s)).dot(&-normal) / dt_s;
                let person = (limb.at(nearest.t) - limb_before.at(nearest.t)).dot(&normal) / dt_s;
                // While the arm brakes it covers half the distance that it would cover at full speed.
                let arm_m = arm * (self.rule.react_s + self.rule.brake_s / 2.0);
                let apart_m = nearest.apart_m - link.radius_m - limb.radius_m;
                let left_m = apart_m - arm_m - person.max(0.0) * takes_s;
                let comes_nearer = arm + person >= COMES_NEARER_MPS;
                // A limb at rest holds the arm only if it almost touches the arm, or neither would ever move away.
                let enough_m = if comes_nearer { self.rule.left_m + self.rule.hysteresis_m } else { RESTS_M };
                is_clear &= left_m > enough_m;
                if comes_nearer {
                    least = least.min(left_m);
                }
            }
        }
        let moves = links.iter().zip(links_before).any(|(a, b)| a != b);
        let began = !self.is_stopped && least < self.rule.left_m;
        self.clear_s = if is_clear { self.clear_s + dt_s } else { 0.0 };
        if began {
            self.is_stopped = true;
        } else if self.is_stopped && self.clear_s >= self.rule.clear_s {
            self.is_stopped = false;
            // The arm drops its trajectory and stands until a newer one comes.
            self.way = vec![self.joints];
            (self.at_s, self.pace) = (0.0, 1.0);
        }
        began && moves
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_cell::arm::CYCLE_S;
    use nalgebra::Point3;

    const HOME: Joints = [1.57, -1.3, 1.7, -1.97, -1.57, 0.0];

    fn arm() -> SimulatedArm {
        SimulatedArm::new(ArmKind::collaborative().clone(), Isometry3::identity(), HOME)
    }

    /// A trajectory that turns the base at a constant rate.
    fn turning() -> Vec<Joints> {
        let step = |k: usize| {
            let mut q = HOME;
            q[0] += 0.05 * k as f64;
            q
        };
        (1..=10).map(step).collect()
    }

    #[test]
    fn it_follows_what_it_is_given_and_stands_at_the_end() {
        let mut arm = arm();
        assert!(arm.follow(&turning(), CYCLE_S));
        (0..50).for_each(|_| _ = arm.advance(0.01, &[]));
        assert!((arm.joints()[0] - HOME[0] - 0.25).abs() < 1e-9);
        (0..200).for_each(|_| _ = arm.advance(0.01, &[]));
        assert_eq!(arm.joints(), &turning()[9]);
    }

    #[test]
    fn what_begins_elsewhere_or_cannot_be_is_not_taken() {
        let mut arm = arm();
        let mut far = turning();
        far[0][1] += 1.0;
        assert!(!arm.follow(&far, CYCLE_S) && !arm.follow(&[], CYCLE_S));
        let mut impossible = turning();
        impossible[5][2] = f64::NAN;
        assert!(!arm.follow(&impossible, CYCLE_S));
        arm.advance(0.01, &[]);
        assert_eq!(arm.joints(), &HOME);
    }

    /// A person who stands where the arm would turn to.
    fn in_its_way(arm: &SimulatedArm) -> [Capsule; 1] {
        let tip = SimulatedArm::new(arm.kind.clone(), arm.base, turning()[7]).tip();
        [Capsule { a: tip, b: tip + nalgebra::Vector3::z() * 0.3, radius_m: 0.05 }]
    }

    #[test]
    fn its_own_stop_holds_it_before_it_touches_and_lets_go_of_what_leads_away() {
        let mut arm = arm().with_rule(StopRule { left_m: 0.0, ..StopRule::default() });
        let person = in_its_way(&arm);
        assert!(arm.follow(&turning(), CYCLE_S));
        let steps: Vec<ArmStep> = (0..150).map(|_| arm.advance(0.01, &person)).collect();
        assert_eq!(steps.iter().filter(|s| s.stopped).count(), 1);
        assert!(arm.is_stopped() && steps.iter().all(|s| !s.contact && s.distance_m > 0.0));
        let here = *arm.joints();
        let mut on = turning();
        on.iter_mut().enumerate().for_each(|(k, q)| q[0] = here[0] + 0.02 * (k + 1) as f64);
        assert!(!arm.follow(&on, CYCLE_S), "nearer");
        on.iter_mut().enumerate().for_each(|(k, q)| q[0] = here[0] - 0.02 * (k + 1) as f64);
        assert!(arm.follow(&on, CYCLE_S), "away");
        (0..100).for_each(|_| _ = arm.advance(0.01, &person));
        assert!(arm.joints()[0] < here[0] - 0.1);
        assert!((arm.tip() - Point3::origin()).norm() > 0.1);
    }

    #[test]
    fn who_rests_beside_it_does_not_hold_it_for_ever_and_it_stops_again_before_it_touches_them() {
        let mut arm = arm().with_rule(StopRule { left_m: 2.0 * RESTS_M, ..StopRule::default() });
        let person = in_its_way(&arm);
        let mut stops = 0;
        for k in 0..1000 {
            if k % 100 == 0 {
                let here = *arm.joints();
                let mut on = turning();
                on.iter_mut().enumerate().for_each(|(k, q)| q[0] = here[0] + 0.02 * (k + 1) as f64);
                arm.follow(&on, CYCLE_S);
            }
            let step = arm.advance(0.01, &person);
            stops += u32::from(step.stopped);
            assert!(step.distance_m > 0.0 && !step.contact, "step {k}: {} m", step.distance_m);
        }
        assert!(stops > 2, "{stops}");
    }
}

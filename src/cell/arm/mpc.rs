//! Trajectories of one second around a person's arm, ten times a second (Lyu et al. 2022, equations 6 to 14).
//!
//! Main types: [`ArmControl`], [`ArmPlan`], [`ArmGoal`]. A plan is the optimum of a quadratic program about the
//! trajectory of the cycle before. Refuses: to break the arm's own limits, and to plan from anywhere but the reported
//! joints.
//!
//! Planes stand between the closest points **of capsules**, not of joints; the speed limits are the arm's own, since
//! with the printed 0.02 rad/s no arm moves 0.87 m in 3.9 s.

use super::capsule::Capsule;
use super::kinematics::{ARM_POINTS, ArmKind, ArmPosture, Joints, LinkShape};
use super::qp::QuadraticProgram;
use nalgebra::{Isometry3, Point3, Vector3};

/// Steps of a trajectory.
pub const HORIZON: usize = 10;
/// Interval between the steps, seconds; a cycle is as long.
pub const CYCLE_S: f64 = 0.1;
/// Number of first steps that are kept from the trajectory of the cycle before.
pub const FROZEN: usize = 2;
/// Number of closest pairs per step that get planes.
const MOST_PLANES: usize = 6;
/// Largest distance of a step from where it was linearised, radians.
const TRUST_RAD: f64 = 0.35;
/// Number of steps that are optimised.
const FREE: usize = HORIZON - FROZEN;

/// Where the tool should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmGoal {
    /// Place of the tool's tip, map frame, metres.
    pub tip: Point3<f64>,
    /// Direction of the tool's z axis, a unit vector.
    pub along: Vector3<f64>,
}

/// A limit of the workplace: all links stay where `normal · place ≤ offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkPlane {
    /// The outward normal, a unit vector.
    pub normal: Vector3<f64>,
    /// Distance of the plane from the origin, metres.
    pub offset_m: f64,
}

/// A trajectory: the configurations 0.1 s from now, 0.2 s, and so on up to one second. It is slow enough at its end for
/// the arm to stand one step later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmPlan {
    /// The configurations, one for each step.
    pub steps: [Joints; HORIZON],
}

/// Weights of the costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmWeights {
    /// Weight of the tip's distance to the goal (equation 6), per m².
    pub position: f64,
    /// Distance beyond which the tip's distance to the goal counts no more, metres.
    pub most_m: f64,
    /// Weight of the tool's direction (equation 7).
    pub direction: f64,
    /// Weight of speeds (`b` of equation 11), per (rad/s)².
    pub speed: f64,
    /// Weight of accelerations (`c` of equation 11), per (rad/s²)².
    pub acceleration: f64,
    /// Weight of how far a link is behind a plane (equation 13), per m².
    pub behind: f64,
}

/// An arm that keeps clear of a person.
#[derive(Clone, Debug)]
pub struct ArmControl {
    /// The kind of arm.
    pub kind: ArmKind,
    /// Where the arm stands.
    pub base: Isometry3<f64>,
    /// Limits of the workplace.
    pub planes: Vec<WorkPlane>,
    /// By how much links are thickened, metres.
    pub link_margin_m: f64,
    /// Least distance between capsules that is wanted (`d` of equation 13), metres.
    pub keep_m: f64,
    /// Planes are made where capsules are nearer than `keep_m` plus this, metres.
    pub watch_m: f64,
    /// Preferred direction of evasion (`B` of equation 12).
    pub bias: Vector3<f64>,
    /// Weights of the costs.
    pub weights: ArmWeights,
}

/// Why there is no trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArmPlanRefusal {
    /// The arm cannot be at the reported joints.
    #[error("the arm reports joints that it cannot have")]
    Joints,
    /// The goal is not a valid place.
    #[error("the arm's goal is not a place")]
    Goal,
    /// The solver found no optimum.
    #[error("no trajectory was found within the solver's iterations")]
    Unsolved,
}

impl ArmPlan {
    /// A trajectory that stands at these joints.
    pub fn standing(joints: &Joints) -> ArmPlan {
        ArmPlan { steps: [*joints; HORIZON] }
    }

    /// The trajectory one cycle later: its first step is over, and at its end the arm stands.
    pub fn a_cycle_later(&self) -> ArmPlan {
        ArmPlan { steps: std::array::from_fn(|k| self.steps[(k + 1).min(HORIZON - 1)]) }
    }
}

impl ArmControl {
    /// A control with the usual weights and margins: links are thickened to the published 10 cm, and 3 cm more are kept
    /// (published: 0).
    pub fn new(kind: ArmKind, base: Isometry3<f64>, planes: Vec<WorkPlane>) -> ArmControl {
        let thinnest = kind.links.iter().map(|l| l.radius_m).fold(0.1, f64::min);
        ArmControl {
            kind,
            base,
            planes,
            link_margin_m: 0.1 - thinnest,
            keep_m: 0.03,
            watch_m: 0.3,
            bias: Vector3::new(0.0, 0.0, 0.5),
            weights: ArmWeights {
                position: 1.0,
                most_m: 0.25,
                direction: 0.05,
                speed: 1e-3,
                acceleration: 1e-3,
                behind: 60.0,
            },
        }
    }

    /// The trajectory that follows `before`, whose first step is now `present`: its own first two steps are the next
    /// two of `before`. `limbs` are the person's capsules at the steps; where there are fewer, the last ones stay.
    ///
    /// # Errors
    /// Why there is none; the arm then follows the trajectory that it has, and stands at its end.
    pub fn plan(
        &self,
        present: &Joints,
        before: &ArmPlan,
        goal: &ArmGoal,
        limbs: &[Vec<Capsule>],
    ) -> Result<ArmPlan, ArmPlanRefusal> {
        if !present.iter().all(|q| q.is_finite()) || !self.kind.allows(present) {
            return Err(ArmPlanRefusal::Joints);
        }
        let finite = goal.tip.coords.iter().chain(goal.along.iter()).all(|x| x.is_finite());
        if !finite || (goal.along.norm() - 1.0).abs() > 1e-3 {
            return Err(ArmPlanRefusal::Goal);
        }
        let about = before.a_cycle_later();
        let planes = self.separating(&about, limbs);
        let mut program = QuadraticProgram::new(FREE * 6 + planes.len());
        for step in FROZEN..HORIZON {
            let pose = self.kind.pose(&self.base, &about.steps[step]);
            self.goal_costs(&mut program, &about, step, &pose, goal);
            self.place_bounds(&mut program, &about, step, &pose);
        }
        self.motion(&mut program, present, &about);
        for (k, plane) in planes.iter().enumerate() {
            let slack = FREE * 6 + k;
            program.cost(self.weights.behind, &[(slack, 1.0)], 0.0);
            program.at_most(&[(slack, -1.0)], 0.0);
            let mut terms = vec![(slack, -1.0)];
            terms.extend((0..6).map(|a| (variable(plane.step, a), -plane.slope[a])));
            let at_reference: f64 = (0..6).map(|a| plane.slope[a] * about.steps[plane.step][a]).sum();
            program.at_most(&terms, plane.clear_m - at_reference);
        }
        let x = program.solve().ok_or(ArmPlanRefusal::Unsolved)?;
        let mut plan = about;
        for step in FROZEN..HORIZON {
            for axis in 0..6 {
                let q = x[variable(step, axis)];
                plan.steps[step][axis] = q.clamp(self.kind.low_rad[axis], self.kind.high_rad[axis]);
            }
        }
        Ok(plan)
    }

    /// Equations 6 and 7: the clipped loss pulls to a place at most `most_m` away.
    fn goal_costs(
        &self,
        program: &mut QuadraticProgram,
        about: &ArmPlan,
        step: usize,
        pose: &ArmPosture,
        goal: &ArmGoal,
    ) {
        let apart = goal.tip - pose.points[7];
        let pull = apart * (self.weights.most_m / apart.norm().max(self.weights.most_m));
        let axis = pose.tool.matrix().column(2).into_owned();
        let columns: [Vector3<f64>; 6] = std::array::from_fn(|k| pose.jacobian_column(7, k));
        let turns: [Vector3<f64>; 6] = std::array::from_fn(|k| pose.axes[k].cross(&axis));
        for i in 0..3 {
            let row = |of: &[Vector3<f64>; 6], wanted: f64| {
                let terms: [(usize, f64); 6] = std::array::from_fn(|k| (variable(step, k), of[k][i]));
                let reference: f64 = (0..6).map(|k| of[k][i] * about.steps[step][k]).sum();
                (terms, wanted + reference)
            };
            let (terms, wanted) = row(&columns, pull[i]);
            program.cost(self.weights.position, &terms, wanted);
            let (terms, wanted) = row(&turns, goal.along[i] - axis[i]);
            program.cost(self.weights.direction, &terms, wanted);
        }
    }

    /// Equations 8 and 14. A point that is beyond a plane already may stay there, but not go farther.
    fn place_bounds(&self, program: &mut QuadraticProgram, about: &ArmPlan, step: usize, pose: &ArmPosture) {
        for axis in 0..6 {
            let q = about.steps[step][axis];
            let low = self.kind.low_rad[axis].max(q - TRUST_RAD);
            let high = self.kind.high_rad[axis].min(q + TRUST_RAD);
            program.within(&[(variable(step, axis), 1.0)], low, high.max(low));
        }
        let radius = |point: usize| {
            let ends = self.kind.links.iter().filter(|l| l.from == point || l.to == point);
            ends.map(|l| l.radius_m).fold(0.0, f64::max)
        };
        for point in 2..ARM_POINTS {
            // The tip touches what it works on.
            let radius = if point == 7 { 0.0 } else { radius(point) };
            for plane in &self.planes {
                let room = plane.offset_m - radius - plane.normal.dot(&pose.points[point].coords);
                if room > 0.4 {
                    continue;
                }
                let slope: [f64; 6] =
                    std::array::from_fn(|k| plane.normal.dot(&pose.jacobian_column(point, k)));
                let terms: [(usize, f64); 6] = std::array::from_fn(|k| (variable(step, k), slope[k]));
                let reference: f64 = (0..6).map(|k| slope[k] * about.steps[step][k]).sum();
                program.at_most(&terms, room.max(0.0) + reference);
            }
        }
    }

    /// Equations 9 to 11: limits of speed and acceleration, and their costs.
    fn motion(&self, program: &mut QuadraticProgram, present: &Joints, about: &ArmPlan) {
        let known = |step: isize, axis: usize| match step {
            -1 => Some(present[axis]),
            step if (step as usize) < FROZEN => Some(about.steps[step as usize][axis]),
            _ => None,
        };
        // Σ factor · q of these steps, as terms and a constant.
        let sum = |parts: &[(isize, f64)], axis: usize| {
            let (mut terms, mut constant) = (Vec::with_capacity(3), 0.0);
            for (step, factor) in parts {
                match known(*step, axis) {
                    Some(q) => constant += factor * q,
                    None => terms.push((variable(*step as usize, axis), *factor)),
                }
            }
            (terms, constant)
        };
        for step in FROZEN as isize..HORIZON as isize {
            for axis in 0..6 {
                let speed = self.kind.speed_radps[axis];
                let most = self.kind.acceleration_radps2[axis];
                let (terms, constant) = sum(&[(step, 1.0 / CYCLE_S), (step - 1, -1.0 / CYCLE_S)], axis);
                program.cost(self.weights.speed, &terms, -constant);
                // Slow enough to stand one step later.
                let speed = if step as usize == HORIZON - 1 { speed.min(most * CYCLE_S) } else { speed };
                program.within(&terms, -speed - constant, speed - constant);
                let f = 1.0 / (CYCLE_S * CYCLE_S);
                let (terms, constant) = sum(&[(step, f), (step - 1, -2.0 * f), (step - 2, f)], axis);
                program.cost(self.weights.acceleration, &terms, -constant);
                program.within(&terms, -most - constant, most - constant);
            }
        }
    }

    /// Planes between the closest points of links and limbs (equations 12 and 13).
    fn separating(&self, about: &ArmPlan, limbs: &[Vec<Capsule>]) -> Vec<SeparatingPlane> {
        let mut planes = Vec::new();
        for step in FROZEN..HORIZON {
            let Some(limbs) = limbs.get(step).or(limbs.last()) else { continue };
            let pose = self.kind.pose(&self.base, &about.steps[step]);
            let links = self.kind.capsules(&pose, self.link_margin_m);
            let pairs = self.kind.links.iter().zip(&links);
            let mut found: Vec<SeparatingPlane> = pairs
                .flat_map(|(shape, link)| limbs.iter().map(move |limb| (shape, link, limb)))
                .filter_map(|(shape, link, limb)| self.plane(step, &pose, shape, link, limb))
                .collect();
            found.sort_by(|a, b| a.clear_m.total_cmp(&b.clear_m));
            found.truncate(MOST_PLANES);
            planes.append(&mut found);
        }
        planes
    }

    fn plane(
        &self,
        step: usize,
        pose: &ArmPosture,
        shape: &LinkShape,
        link: &Capsule,
        limb: &Capsule,
    ) -> Option<SeparatingPlane> {
        let nearest = link.nearest(limb);
        let keep_m = link.radius_m + limb.radius_m + self.keep_m;
        if nearest.apart_m > keep_m + self.watch_m {
            return None;
        }
        let normal = (nearest.normal() + self.bias).try_normalize(1e-6).unwrap_or_else(Vector3::z);
        let clear_m = normal.dot(&(nearest.first - nearest.second)) - keep_m;
        let slope = std::array::from_fn(|k| normal.dot(&pose.column_at(nearest.first, shape.to, k)));
        Some(SeparatingPlane { step, slope, clear_m })
    }
}

/// A plane that a link should stay in front of at a step.
struct SeparatingPlane {
    step: usize,
    /// How the link's distance to the plane changes with the axes, metres per radian.
    slope: [f64; 6],
    /// Distance of the link in front of the plane where it was linearised, metres.
    clear_m: f64,
}

/// Index of the variable of an axis at a step that is not frozen.
fn variable(step: usize, axis: usize) -> usize {
    (step - FROZEN) * 6 + axis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::capsule::least_distance_m;

    fn control() -> (ArmControl, Joints) {
        let base = Isometry3::translation(0.0, 0.6, 0.0);
        let kind = ArmKind::collaborative().clone();
        let seed = [1.57, -1.3, 1.7, -1.97, -1.57, 0.0];
        let home = kind.reach(&base, Point3::new(-0.2, 0.1, 0.15), -Vector3::z(), &seed).expect("near");
        let table = WorkPlane { normal: -Vector3::z(), offset_m: 0.0 };
        (ArmControl::new(kind, base, vec![table]), home)
    }

    /// Follows the control's own plans for some cycles; gives all configurations.
    fn followed(control: &ArmControl, from: Joints, goal: &ArmGoal, limbs: &[Vec<Capsule>]) -> Vec<Joints> {
        let (mut plan, mut all) = (ArmPlan::standing(&from), vec![from]);
        for _ in 0..40 {
            let present = *all.last().unwrap();
            plan = control.plan(&present, &plan, goal, limbs).expect("a plan");
            all.push(plan.steps[0]);
        }
        all
    }

    #[test]
    fn it_reaches_its_goal_within_the_limits_of_its_axes() {
        let (control, home) = control();
        let goal = ArmGoal { tip: Point3::new(0.2, 0.1, 0.06), along: -Vector3::z() };
        let all = followed(&control, home, &goal, &[]);
        let tip = control.kind.pose(&control.base, all.last().unwrap()).points[7];
        assert!((tip - goal.tip).norm() < 0.01, "{tip}");
        for three in all.windows(3) {
            let speed = |i: usize, k: usize| (three[i][k] - three[i - 1][k]) / CYCLE_S;
            let limits = control.kind.speed_radps.iter().zip(&control.kind.acceleration_radps2);
            for (k, (fastest, most)) in limits.enumerate() {
                assert!(speed(2, k).abs() < fastest + 1e-3);
                let acceleration = (speed(2, k) - speed(1, k)) / CYCLE_S;
                assert!(acceleration.abs() < most + 1e-2, "{k}: {acceleration}");
            }
        }
    }

    #[test]
    fn the_first_two_steps_are_those_that_were_planned_before() {
        let (control, home) = control();
        let goal = ArmGoal { tip: Point3::new(0.2, 0.1, 0.06), along: -Vector3::z() };
        let first = control.plan(&home, &ArmPlan::standing(&home), &goal, &[]).unwrap();
        let elsewhere = ArmGoal { tip: Point3::new(-0.3, 0.0, 0.2), ..goal };
        let second = control.plan(&first.steps[0], &first, &elsewhere, &[]).unwrap();
        assert_eq!(second.steps[..FROZEN], first.steps[1..=FROZEN]);
        assert_ne!(second.steps[FROZEN], first.steps[FROZEN + 1]);
    }

    #[test]
    fn it_goes_round_an_arm_in_its_way_and_through_where_there_is_none() {
        let (control, home) = control();
        let goal = ArmGoal { tip: Point3::new(0.25, 0.1, 0.06), along: -Vector3::z() };
        let arm = Capsule { a: Point3::new(0.1, -0.4, 0.3), b: Point3::new(0.02, 0.0, 0.08), radius_m: 0.05 };
        let closest = |all: &[Joints]| {
            let links = |q: &Joints| control.kind.capsules(&control.kind.pose(&control.base, q), 0.0);
            all.iter().map(|q| least_distance_m(&links(q), &[arm])).fold(f64::INFINITY, f64::min)
        };
        let (clear, blind) =
            (followed(&control, home, &goal, &[vec![arm]]), followed(&control, home, &goal, &[]));
        assert!(closest(&clear) > closest(&blind) + 0.02, "{} {}", closest(&clear), closest(&blind));
        assert!(closest(&clear) > 0.03, "{}", closest(&clear));
    }

    #[test]
    fn impossible_joints_and_goals_are_refused() {
        let (control, home) = control();
        let goal = ArmGoal { tip: Point3::new(0.2, 0.1, 0.06), along: -Vector3::z() };
        let plan = ArmPlan::standing(&home);
        let mut wrong = home;
        wrong[2] = 9.0;
        assert_eq!(control.plan(&wrong, &plan, &goal, &[]), Err(ArmPlanRefusal::Joints));
        wrong[2] = f64::NAN;
        assert_eq!(control.plan(&wrong, &plan, &goal, &[]), Err(ArmPlanRefusal::Joints));
        let nowhere = ArmGoal { tip: Point3::new(f64::NAN, 0.0, 0.0), ..goal };
        assert_eq!(control.plan(&home, &plan, &nowhere, &[]), Err(ArmPlanRefusal::Goal));
    }
}

//! Chooses a robot's next speed and turn rate.
//!
//! Main types: [`LocalPlanner`], [`LocalMethod`]. A choice is made among a fixed number of samples, in a fixed order,
//! without memory of the past and without allocation. Whatever is chosen, the robot can then come to rest within its
//! corridor, on the arc that it drives: so there is always a way to go on, if only to brake. Refuses: a trajectory on
//! which the robot's outline leaves its corridor, whatever it gains; if none is left, the robot brakes and stands.

use super::drive::{DriveLimits, DriveState, Twist, aim};
use super::improved::{ImprovedWeights, Outlook};
use super::outline::RobotOutline;
use super::spaces::{AHEAD_STEP_S, NearPerson, Spaces};
use super::traditional::TraditionalWeights;
use giveway_floor::geometry::{Point, Segment, Vector};
use giveway_floor::warehouse::{Corridor, Footprint, Hull};

/// The method of choosing the next speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LocalMethod {
    /// Straight on to the goal, as fast as safe spaces allow; the robot never leaves the line.
    Line,
    /// By heading, clearance and speed; a person is an inflated obstacle.
    Traditional(TraditionalWeights),
    /// By time, detour and the forecast of where people will be.
    Improved(ImprovedWeights),
}

/// The planner of one robot on one corridor.
#[derive(Clone, Debug)]
pub struct LocalPlanner {
    outline: RobotOutline,
    spaces: Spaces,
    line: Segment,
    room_m: (f64, f64),
    floor: Hull,
    method: LocalMethod,
}

/// Least distance between an outline and the edge of a corridor, metres, unless the robot is already nearer: it covers
/// what lies between two checked poses.
pub(super) const MARGIN_M: f64 = 0.02;
/// Spacing of checked poses on an arc, metres and radians, as long as there are few enough.
const POSES: (f64, f64) = (0.08, 0.08);
/// Largest number of checked poses.
const POSES_MAX: usize = 24;
/// A robot nearer to its goal than this no longer turns, metres.
const THERE_M: f64 = 0.05;

impl LocalPlanner {
    /// A planner for a robot with this footprint on a lane with a corridor, both in driving direction: its floor is
    /// that of [`Footprint::free`].
    pub fn new(
        footprint: &Footprint,
        limits: DriveLimits,
        line: Segment,
        corridor: Corridor,
        method: LocalMethod,
    ) -> LocalPlanner {
        let outline = RobotOutline::of(footprint);
        let spaces = Spaces { circle_m: outline.circle_m(), limits };
        let room = |side_m: f64| (side_m - outline.circle_m() - MARGIN_M).max(0.0);
        let room_m = (room(corridor.left_m), room(corridor.right_m));
        let floor = footprint.free(line, corridor);
        LocalPlanner { outline, spaces, line, room_m, floor, method }
    }

    /// The planner for a line that lies `left_m` to the left of the lane, metres, or to the right if negative, on the
    /// same floor.
    pub fn beside(mut self, left_m: f64) -> LocalPlanner {
        let ahead = (self.line.b - self.line.a).try_normalize(1e-12).unwrap_or(Vector::x());
        let across = Vector::new(-ahead.y, ahead.x) * left_m;
        self.line = Segment { a: self.line.a + across, b: self.line.b + across };
        let (left, right) = self.room_m;
        self.room_m = ((left - left_m).max(0.0), (right + left_m).max(0.0));
        self
    }

    /// The motion for the next period towards a goal within the corridor. The robot brakes if every motion would leave
    /// the corridor or come too near to a person.
    pub fn choose(&self, state: &DriveState, goal: Point, people: &[NearPerson<'_>]) -> Twist {
        let limits = &self.spaces.limits;
        let left = (goal - state.pose.at).norm();
        if left < THERE_M {
            return limits.braked(state.twist);
        }
        let window = limits.window(state.twist, left, aim(state.pose, goal));
        let (room_m, line) = (self.room_m, self.line);
        let look = Outlook { limits, spaces: &self.spaces, room_m, line, state, goal, people };
        let mut best: Option<(f64, Twist)> = None;
        for twist in window.twists() {
            let Some(value) = self.value(&look, twist, best.map(|(b, _)| b)) else { continue };
            if best.is_none_or(|(b, _)| value > b) && self.keeps_to_floor(state, twist) {
                best = Some((value, twist));
            }
        }
        best.map_or_else(|| limits.braked(state.twist), |(_, twist)| twist)
    }

    /// The value of a motion; nothing if it is not allowed, or surely no better than the `best` so far.
    fn value(&self, look: &Outlook<'_>, twist: Twist, best: Option<f64>) -> Option<f64> {
        match &self.method {
            LocalMethod::Line => {
                (twist.turn_rps == 0.0 && self.is_safe(look, twist)).then_some(twist.speed_mps)
            }
            LocalMethod::Traditional(weights) => {
                let circle_m = self.spaces.circle_m;
                weights.value(look.limits, circle_m, look.state, twist, look.goal, look.people)
            }
            LocalMethod::Improved(weights) => {
                let bound = best.map_or(f64::INFINITY, |b| -b);
                let cost = self.is_safe(look, twist).then(|| weights.cost(look, twist, bound))?;
                (cost < f64::INFINITY).then_some(-cost)
            }
        }
    }

    /// Whether the robot stays out of every person's safe space, now and at the expected positions a little later.
    fn is_safe(&self, look: &Outlook<'_>, twist: Twist) -> bool {
        const LATER: usize = 1;
        let later_s = AHEAD_STEP_S * LATER as f64;
        let velocity = |heading: f64| Vector::new(libm::cos(heading), libm::sin(heading)) * twist.speed_mps;
        let (now, later) = (look.state.pose, twist.moved(look.state.pose, later_s));
        look.people.iter().all(|p| {
            let mean = p.ahead.get(LATER - 1).and_then(crate::human::Mixture::mean);
            let then = mean.unwrap_or(p.at);
            self.spaces.allow(velocity(now.heading), p.velocity, p.at - now.at)
                && self.spaces.allow(velocity(later.heading), p.velocity, then - later.at)
        })
    }

    /// Whether the outline stays within the corridor during the next period and while the robot brakes after it. The
    /// robot must then have room to turn on the spot, unless it stands no farther from the line than now: so it never
    /// stands at the edge unable to turn or go on.
    fn keeps_to_floor(&self, state: &DriveState, twist: Twist) -> bool {
        let limits = &self.spaces.limits;
        let all_s = limits.period_s + limits.stop_s(twist.speed_mps) / 2.0;
        let (way, turned) = (twist.speed_mps * all_s, twist.turn_rps.abs() * all_s);
        let poses = (way / POSES.0).max(turned / POSES.1).ceil().clamp(1.0, POSES_MAX as f64) as usize;
        let least_m = self.outline.depth_m(&self.floor, state.pose).clamp(0.0, MARGIN_M);
        let aside = |at: Point| {
            let way = self.line.b - self.line.a;
            (way.perp(&(at - self.line.a)) / way.norm().max(1e-9)).abs()
        };
        let end = twist.moved(state.pose, all_s).at;
        let turns = self.floor.depth_of(end) >= self.spaces.circle_m + MARGIN_M;
        let may_end = turns || aside(end) <= aside(state.pose.at) + 1e-9;
        may_end
            && (1..=poses).all(|k| {
                let pose = twist.moved(state.pose, all_s * k as f64 / poses as f64);
                self.outline.depth_m(&self.floor, pose) >= least_m
            })
    }
}

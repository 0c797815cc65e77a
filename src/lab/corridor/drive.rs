//! Drives one robot through one scene.
//!
//! Main type: [`CorridorRun`]; main function: [`drive`]. The planner sees the worker through a sensor with noise and
//! delay, and the product's own filter and forecast. Laws are checked at every instant. Refuses: to show the planner
//! the truth.

use super::scanner::{OwnStop, braked_hard};
use super::scene::CorridorScene;
use super::worker::Stroller;
use giveway_floor::geometry::{Point, Pose, Vector};
use giveway_floor::time::{Span, Time};
use giveway_people::human::motion::{Fix, Motion};
use giveway_people::human::{BODY_M, Forecast, Mixture, Model};
use giveway_people::local::{
    AHEAD_STEP_S, AHEAD_STEPS, DriveState, LocalMethod, LocalPlanner, NearPerson, RobotOutline, Twist,
};
use giveway_sim::random::Stream;
use std::collections::VecDeque;

/// Time from one instant to the next.
const TICK: Span = Span::from_millis(20);
/// Number of instants in one period of the planner and of the sensor.
const TICKS: u32 = 5;
/// Age of an observation, periods.
const DELAY: usize = 1;
/// Noise of an observed position along each axis, metres.
const NOISE_M: f64 = 0.05;
/// How long the worker is observed before the robot starts, periods.
const WARM_UP: u32 = 20;
/// Time limit of a scene, seconds.
const LIMIT_S: f64 = 90.0;
/// A robot this near to its goal has reached it, metres.
const THERE_M: f64 = 0.08;
/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 1e-6;

/// Result of one scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorridorRun {
    /// Whether the robot reached its goal.
    pub reached: bool,
    /// Distance driven, metres.
    pub path_m: f64,
    /// Duration, seconds.
    pub time_s: f64,
    /// The least distance between the robot's outline and the worker's body, metres.
    pub closest_m: f64,
    /// Whether the robot crossed the worker's path behind the worker; nothing if it did not cross.
    pub behind: Option<bool>,
    /// How often the robot's own scanner stopped it.
    pub own_stops: u32,
    /// How often the robot's outline left the corridor, or touched a person while it moved.
    pub violations: u32,
}

/// The sensor's observations of the worker, and the forecast from them.
struct WorkerWatch {
    model: std::sync::Arc<Model>,
    motion: Motion,
    seen: VecDeque<(Time, Point)>,
    dice: Stream,
    ahead: Vec<Mixture>,
}

impl WorkerWatch {
    fn new(dice: Stream) -> WorkerWatch {
        let model = Model::builtin();
        let motion = Motion::new(model.motion);
        WorkerWatch { model, motion, seen: VecDeque::new(), dice, ahead: Vec::new() }
    }

    fn see(&mut self, now: Time, at: Point) {
        let noise = Vector::new(self.dice.normal(), self.dice.normal()) * NOISE_M;
        self.seen.push_back((now, at + noise));
        if self.seen.len() > DELAY {
            let (seen, at) = self.seen.pop_front().expect("it is not empty");
            self.motion.see(Fix { seen, at, sigma_m: NOISE_M });
        }
    }

    /// The worker as currently believed.
    fn person(&mut self, now: Time) -> Option<NearPerson<'_>> {
        let forecast =
            Forecast { motion: &self.motion, ways: &[], bound: &self.model.bound, free: &self.model.free };
        let here = self.motion.carried(now)?;
        let step = Span::from_secs_f64(AHEAD_STEP_S);
        self.ahead.clear();
        self.ahead.extend((1..=AHEAD_STEPS).filter_map(|k| forecast.at(now + step * k as i64)));
        Some(NearPerson { at: here.at, velocity: here.velocity, ahead: &self.ahead })
    }
}

/// Drives a scene with a method; `seed` and `run` determine the worker's steps and the sensor's noise.
pub fn drive(scene: &CorridorScene, method: LocalMethod, seed: u64, run: u64) -> CorridorRun {
    let mut worker = Stroller::new(scene.walk, Stream::new(seed, WALKS, run));
    let mut watch = WorkerWatch::new(Stream::new(seed, SEES, run));
    let planner = LocalPlanner::new(&scene.footprint, scene.limits, scene.lane, scene.corridor, method);
    let mut robot = CorridorRobot::new(scene);
    let goal = scene.line().b;
    let dt = TICK.as_secs_f64();
    let mut now = Time::ZERO;
    // Before the robot starts, the worker is observed standing at the start of the walk.
    for _ in 0..WARM_UP {
        watch.see(now, worker.at());
        now += TICK * i64::from(TICKS);
    }
    let (start, mut tick) = (now, 0);
    while (now - start).as_secs_f64() < LIMIT_S {
        if tick % TICKS == 0 {
            watch.see(now, worker.at());
            let wanted = watch.person(now).map_or_else(Twist::default, |person| {
                planner.choose(&robot.state, goal, std::slice::from_ref(&person))
            });
            robot.wanted = wanted;
        }
        robot.move_on(worker.at(), dt);
        let stands = robot.state.twist.speed_mps <= STANDS_MPS;
        let standing = stands.then_some((&robot.outline, robot.state.pose));
        worker.walk(dt, standing);
        now += TICK;
        tick += 1;
        robot.check(scene, &worker);
        if (goal - robot.state.pose.at).norm() < THERE_M {
            robot.run.reached = true;
            robot.run.path_m += (goal - robot.state.pose.at).norm();
            break;
        }
    }
    CorridorRun { time_s: (now - start).as_secs_f64(), own_stops: robot.own.stops, ..robot.run }
}

/// Purposes of random streams.
const WALKS: u64 = 0xc0_01;
const SEES: u64 = 0xc0_02;

struct CorridorRobot {
    outline: RobotOutline,
    state: DriveState,
    wanted: Twist,
    own: OwnStop,
    run: CorridorRun,
    /// The side of the worker's path that the robot is on.
    side: Option<bool>,
    broke: [bool; 2],
}

impl CorridorRobot {
    fn new(scene: &CorridorScene) -> CorridorRobot {
        let pose = Pose { at: scene.line().a, heading: 0.0 };
        CorridorRobot {
            outline: RobotOutline::of(&scene.footprint),
            state: DriveState { pose, twist: Twist::default() },
            wanted: Twist::default(),
            own: OwnStop::default(),
            run: CorridorRun {
                reached: false,
                path_m: 0.0,
                time_s: 0.0,
                closest_m: f64::INFINITY,
                behind: None,
                own_stops: 0,
                violations: 0,
            },
            side: None,
            broke: [false; 2],
        }
    }

    fn move_on(&mut self, person: Point, dt: f64) {
        let wanted = DriveState { twist: self.wanted, ..self.state };
        // The scanner looks along the arc that the robot is about to drive.
        self.state.twist = if self.own.holds(&self.outline, &wanted, person, dt) {
            let held = braked_hard(self.state.twist, dt);
            self.wanted = held;
            held
        } else {
            self.wanted
        };
        self.state.pose = self.state.twist.moved(self.state.pose, dt);
        self.run.path_m += self.state.twist.speed_mps * dt;
    }

    /// Measures distances, and checks the laws: a law that stays broken counts once.
    fn check(&mut self, scene: &CorridorScene, worker: &Stroller) {
        let gap = self.outline.gap_m(self.state.pose, worker.at()) - BODY_M;
        self.run.closest_m = self.run.closest_m.min(gap);
        let outside = !scene.floor.holds(&scene.footprint.at(self.state.pose), 1e-6);
        let touches = gap <= 0.0 && self.state.twist.speed_mps > STANDS_MPS;
        for (was, is) in self.broke.iter_mut().zip([outside, touches]) {
            self.run.violations += u32::from(is && !*was);
            *was = is;
        }
        if scene.crosses {
            let heading = worker.heading();
            let way = Vector::new(heading.cos(), heading.sin());
            let from_worker = self.state.pose.at - worker.at();
            let side = way.perp(&from_worker) > 0.0;
            if self.side.is_some_and(|s| s != side) {
                self.run.behind = Some(way.dot(&from_worker) < 0.0);
            }
            self.side = Some(side);
        }
    }
}

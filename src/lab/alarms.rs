//! Faults injected one at a time, and the alarms that follow; floors without faults, on which no alarm should follow.
//!
//! Main types: [`InjectedFault`], [`AlarmTrial`] (one fault), [`TrialRow`] (what followed), [`HealthyFloor`]. The
//! alarms are those of a server: the same watch looks at the fleet every second, the same register raises them.
//! Refuses: faults of the server's own parts, which a simulation does not have, and threads.

use super::dice::Dice;
use giveway_fleet::alarm::{
    Alarm, AlarmKind, AlarmRegister, AlarmScope, FloorWatch, LoopHealth, SubjectKind,
};
use giveway_fleet::{Doing, Fault, RobotState, RobotView, Task, View};
use giveway_floor::id::{Dense, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_sim::{Demand, Faults, Scenario, Simulation, Workers};
use giveway_site::{Site, SiteLinks};
use std::sync::Arc;

/// Least time that the floor works before the fault; up to as much again is drawn from the seed.
const WARM: Span = Span::from_secs(120);
/// Duration of a fault.
const LASTS: Span = Span::from_secs(150);
/// An alarm raised this long after the end of a fault still counts for it.
const AFTER: Span = Span::from_secs(60);
/// How long a trial waits for a robot or a worker that the fault can happen to.
const WAITED_FOR: Span = Span::from_secs(4 * 3600);
/// Charge that is too low for any job, as a share of 1.
const LOW: f64 = 0.04;

/// A fault to inject.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum InjectedFault {
    /// A robot with a task breaks down.
    BreakDown,
    /// The emergency stop of a driving robot is pressed.
    EmergencyStop,
    /// The radio of a robot with a task is dead.
    RadioSilence,
    /// An obstacle stands on a robot's way.
    Obstacle,
    /// People push a standing robot between two nodes.
    Pushed,
    /// A charging robot gets no current.
    Unplugged,
    /// Many robots are low on charge at once, more than there are chargers.
    LowCharge,
    /// A headset falls silent.
    HeadsetSilence,
    /// A person takes over a robot, which is no fault: no alarm is expected.
    TakenOver,
}

impl InjectedFault {
    /// All faults.
    pub const ALL: [InjectedFault; 9] = [
        InjectedFault::BreakDown,
        InjectedFault::EmergencyStop,
        InjectedFault::RadioSilence,
        InjectedFault::Obstacle,
        InjectedFault::Pushed,
        InjectedFault::Unplugged,
        InjectedFault::LowCharge,
        InjectedFault::HeadsetSilence,
        InjectedFault::TakenOver,
    ];

    /// The fault's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            InjectedFault::BreakDown => "break_down",
            InjectedFault::EmergencyStop => "emergency_stop",
            InjectedFault::RadioSilence => "radio_silence",
            InjectedFault::Obstacle => "obstacle",
            InjectedFault::Pushed => "pushed",
            InjectedFault::Unplugged => "unplugged",
            InjectedFault::LowCharge => "low_charge",
            InjectedFault::HeadsetSilence => "headset_silence",
            InjectedFault::TakenOver => "taken_over",
        }
    }

    /// The alarm that the fault should raise; nothing if it should raise none.
    pub fn expected(self) -> Option<AlarmKind> {
        match self {
            InjectedFault::BreakDown => Some(AlarmKind::RobotFailed),
            InjectedFault::EmergencyStop => Some(AlarmKind::EmergencyStop),
            InjectedFault::RadioSilence => Some(AlarmKind::RobotSilent),
            InjectedFault::Obstacle => Some(AlarmKind::RobotObstructed),
            InjectedFault::Pushed => Some(AlarmKind::RobotDisplaced),
            InjectedFault::Unplugged => Some(AlarmKind::RobotUnplugged),
            InjectedFault::LowCharge => Some(AlarmKind::RobotLow),
            InjectedFault::HeadsetSilence => Some(AlarmKind::WorkerLost),
            InjectedFault::TakenOver => None,
        }
    }

    /// Whether the fault can happen to this robot now.
    fn can_happen_to(self, robot: &RobotView) -> bool {
        let works = robot.task != Task::Idle && robot.state != RobotState::Failed && robot.fault.is_none();
        match self {
            InjectedFault::Pushed => works && robot.speed_mps == 0.0,
            InjectedFault::Unplugged => robot.doing == Doing::Charging && robot.fault.is_none(),
            InjectedFault::LowCharge => true,
            InjectedFault::HeadsetSilence => false,
            _ => works && robot.speed_mps > 0.0,
        }
    }
}

/// One fault on one floor.
#[derive(Clone, Debug)]
pub struct AlarmTrial {
    /// The floor of the trial.
    pub warehouse: Arc<Warehouse>,
    /// Number of robots.
    pub robots: usize,
    /// The fault to inject.
    pub fault: InjectedFault,
}

/// Result of one trial.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialRow {
    /// Time from the fault to the expected alarm; nothing if it was not raised.
    pub delay: Option<Span>,
    /// The kinds of all alarms raised from the fault on, including the expected one.
    pub raised: Vec<AlarmKind>,
    /// Whether none of these alarms is active a minute after the end of the fault.
    pub cleared: bool,
}

/// A floor without faults.
#[derive(Clone, Debug)]
pub struct HealthyFloor {
    /// The floor's name in reports.
    pub map: String,
    /// The floor's map.
    pub warehouse: Arc<Warehouse>,
    /// Number of robots.
    pub robots: usize,
    /// Number of people.
    pub workers: usize,
    /// Duration of a run, seconds.
    pub seconds: f64,
}

/// The alarms that a server would raise, looking once a second.
struct AlarmLog {
    watch: FloorWatch,
    register: AlarmRegister,
    health: LoopHealth,
    looked: Option<Time>,
    raised: Vec<(Time, Alarm)>,
}

impl AlarmLog {
    fn new(period: Span) -> AlarmLog {
        AlarmLog {
            watch: FloorWatch::default(),
            register: AlarmRegister::default(),
            health: LoopHealth { period, ..LoopHealth::default() },
            looked: None,
            raised: Vec::new(),
        }
    }

    fn look(&mut self, sim: &Simulation) {
        let now = sim.now();
        if self.looked.is_some_and(|at| now - at < Span::from_secs(1)) {
            return;
        }
        self.looked = Some(now);
        let view = sim.fleet().view(now);
        let found = self.watch.look(sim.fleet(), &view, &self.health);
        let new = self.register.observe(AlarmScope::Watch, found, now);
        self.raised.extend(new.into_iter().map(|alarm| (now, alarm)));
    }
}

impl AlarmTrial {
    /// Runs the trial with this seed; nothing if for hours there is no robot or worker that the fault can happen to.
    pub fn run(&self, seed: u64) -> Option<TrialRow> {
        let workers = usize::from(self.fault == InjectedFault::HeadsetSilence);
        let end = WARM * 2 + WAITED_FOR + LASTS + AFTER;
        let scenario = scenario("alarms", (self.robots, workers), end, seed);
        let mut sim = Simulation::new(self.warehouse.clone(), &scenario, &[], seed, false, || 0);
        let mut log = AlarmLog::new(scenario.site.period);
        let mut dice = Dice::new(seed);
        let warm = Time::ZERO + WARM + Span::from_secs(dice.below(WARM.0 as usize / 1_000_000) as i64);
        let run_to = |sim: &mut Simulation, log: &mut AlarmLog, until: Time| {
            while sim.now() < until {
                sim.step();
                log.look(sim);
            }
        };
        run_to(&mut sim, &mut log, warm);
        let subject = loop {
            if sim.now() > warm + WAITED_FOR {
                return None;
            }
            if let Some(subject) = self.bring_about(&mut sim, &mut dice) {
                break subject;
            }
            let next = sim.now() + scenario.site.period;
            run_to(&mut sim, &mut log, next);
        };
        let from = sim.now();
        run_to(&mut sim, &mut log, from + LASTS + AFTER);
        let raised: Vec<&(Time, Alarm)> = log.raised.iter().filter(|(at, _)| *at >= from).collect();
        let is_it = |a: &Alarm| Some(a.kind) == self.fault.expected() && subject.is_it(a);
        let first = raised.iter().find(|(_, a)| is_it(a)).map(|(at, _)| *at - from);
        let active = log.register.active();
        Some(TrialRow {
            delay: first,
            raised: raised.iter().map(|(_, a)| a.kind).collect(),
            cleared: raised.iter().all(|(_, a)| !active.iter().any(|b| b.id == a.id)),
        })
    }

    /// Injects the fault into a random subject that it can happen to. Gives the subject.
    fn bring_about(&self, sim: &mut Simulation, dice: &mut Dice) -> Option<FaultSubject> {
        let view = sim.fleet().view(sim.now());
        let until = sim.now() + LASTS;
        let fits = |(_, r): &(usize, &RobotView)| self.fault.can_happen_to(r);
        let all: Vec<RobotId> =
            view.robots.iter().enumerate().filter(fits).map(|(i, _)| RobotId::at(i)).collect();
        let mut one = || (!all.is_empty()).then(|| all[dice.below(all.len())]);
        let of = |robot: RobotId| FaultSubject::Robot(view.robots[robot.ix()].name.clone());
        let world = &mut sim.world;
        let fault = match self.fault {
            InjectedFault::HeadsetSilence => {
                let (worker, _) = world.walkers().find(|(w, _)| is_seen(&view, *w))?;
                return world.silence(worker, until).then_some(FaultSubject::Worker(worker));
            }
            InjectedFault::LowCharge => {
                all.iter().for_each(|robot| world.set_battery(*robot, LOW));
                return (!all.is_empty()).then_some(FaultSubject::AnyRobot);
            }
            InjectedFault::Pushed => return one().filter(|robot| world.push_away(*robot)).map(of),
            InjectedFault::RadioSilence => {
                let robot = one()?;
                world.mute(robot, until);
                return Some(of(robot));
            }
            InjectedFault::BreakDown => Fault::Broken,
            InjectedFault::EmergencyStop => Fault::EmergencyStop,
            InjectedFault::Obstacle => Fault::Obstructed,
            InjectedFault::Unplugged => Fault::Unplugged,
            InjectedFault::TakenOver => Fault::Manual,
        };
        let robot = one()?;
        world.afflict(robot, fault, until);
        Some(of(robot))
    }
}

/// The subject of an injected fault.
enum FaultSubject {
    Robot(String),
    AnyRobot,
    Worker(WorkerId),
}

impl FaultSubject {
    fn is_it(&self, alarm: &Alarm) -> bool {
        match self {
            FaultSubject::Robot(name) => alarm.subject.id == *name,
            FaultSubject::AnyRobot => matches!(alarm.subject.kind, SubjectKind::Robot | SubjectKind::Floor),
            FaultSubject::Worker(worker) => alarm.subject.id == format!("w{}", worker.0 + 1),
        }
    }
}

fn is_seen(view: &View, worker: WorkerId) -> bool {
    view.workers.get(worker.ix()).is_some_and(|w| w.pose.is_some())
}

impl HealthyFloor {
    /// The kinds of all alarms raised in a run without faults.
    pub fn run(&self, seed: u64) -> Vec<AlarmKind> {
        let length = Span::from_secs_f64(self.seconds);
        let scenario = scenario("healthy", (self.robots, self.workers), length, seed);
        let mut sim = Simulation::new(self.warehouse.clone(), &scenario, &[], seed, false, || 0);
        let mut log = AlarmLog::new(scenario.site.period);
        while !sim.is_over() {
            sim.step();
            log.look(&sim);
        }
        log.raised.into_iter().map(|(_, alarm)| alarm.kind).collect()
    }
}

fn scenario(name: &str, (robots, workers): (usize, usize), duration: Span, seed: u64) -> Scenario {
    let links = SiteLinks::simulated(robots);
    let site = Site { name: name.into(), period: Span::from_millis(100), links, ..Site::default() };
    Scenario {
        duration,
        seed,
        demand: Demand::Backlog(robots),
        faults: Faults { repair_s: LASTS.as_secs_f64(), ..Faults::default() },
        workers: Workers { count: workers, enter_s: 10.0, ..Workers::default() },
        ..Scenario::from(site)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::thesis;

    fn trial(fault: InjectedFault) -> TrialRow {
        let trial = AlarmTrial { warehouse: Arc::new(thesis()), robots: 8, fault };
        trial.run(3).expect("it can happen")
    }

    #[test]
    fn a_break_down_is_one_alarm_soon_and_ends_with_it() {
        let row = trial(InjectedFault::BreakDown);
        assert!(row.delay.is_some_and(|d| d < Span::from_secs(5)), "{row:?}");
        assert_eq!((&row.raised[..], row.cleared), (&[AlarmKind::RobotFailed][..], true));
    }

    #[test]
    fn an_obstacle_is_an_alarm_whether_the_robot_stands_before_it_or_goes_round() {
        let warehouse = Arc::new(thesis());
        let trial = AlarmTrial { warehouse, robots: 8, fault: InjectedFault::Obstacle };
        for seed in 1..=6 {
            let row = trial.run(seed).expect("it can happen");
            assert!(row.delay.is_some_and(|d| d < Span::from_secs(30)), "seed {seed}: {row:?}");
        }
    }

    #[test]
    fn a_headset_that_falls_silent_is_a_lost_worker() {
        let row = trial(InjectedFault::HeadsetSilence);
        assert!(row.delay.is_some_and(|d| d < Span::from_secs(60)), "{row:?}");
    }

    #[test]
    fn a_robot_that_somebody_drives_by_hand_raises_no_alarm() {
        let row = trial(InjectedFault::TakenOver);
        assert_eq!((row.delay, row.raised), (None, vec![]));
    }
}

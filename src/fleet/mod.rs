//! The core: one pure state machine. `step(now, inputs)` takes everything in, then decides once.
//!
//! Main types: [`Fleet`], [`Settings`], [`Input`], [`Step`], [`View`]. Two halves of state: the [`Ledger`] (what was
//! promised, a fold over facts) and the [`state::scene`] (what is seen). A restart is a step with an empty scene.
//! Refuses: clocks, I/O, random numbers, hash order; reacting to messages (it reacts to state, so repeated and
//! late ones do no harm).

pub mod carry;
pub mod dispatch;
mod people;
pub mod read;
pub mod requests;
pub mod state;
mod traffic;
mod yielding;

pub use people::forecast::{AHEAD_S, Expected};
pub use read::backlog::{Backlog, Pending};
pub use read::occupancy::{Area, MOST_STRIPS, Strip};
pub use read::view::{Counts, Doing, JobWhy, RobotState, RobotView, StationView, View, Why};
pub use read::why::{Because, Waiting, Who};
pub use state::displaced::{Displaced, Displacement, OFF_ROUTE_M};
pub use state::fact::{Act, Booking, Fact, Kept, Moved, Purpose, Stop, Task};
pub use state::io::{Bounded, Command, Input, Refusal, Reply, StationOrder, Step, Telemetry, Waypoint};
pub use state::job::{Job, JobFailure, JobKind, JobRequest, JobState};
pub use state::keys::{KEY_LIFE, Keys};
pub use state::kind::{Charging, RobotKind, USUAL_KIND, most_dangerous};
pub use state::ledger::{Ledger, RackAt, Robot, Sums};
pub use state::parts::{Contradiction, Parts};
pub use state::wishes::Wishes;
pub use state::worker::{
    Assignment, AssignmentRequest, AssignmentState, Closure, ClosureState, ClosureView, Encounter,
    FeedCounts, Guidance, GuidanceReason, GuidanceState, NearRobot, Presence, Reaction, WorkerView,
};

use crate::aware::{HumanAwarePolicy, Regions};
use crate::human::{Method, Model};
use crate::id::{IdVec, RobotId};
use crate::time::{Span, Time};
use crate::warehouse::Warehouse;
use people::state::HumanState;
use state::floor::Floor;
use state::scene::Scene;
use std::collections::BTreeSet;
use std::sync::Arc;
use traffic::grant::Withheld;
use traffic::plan::Needs;
use traffic::planners::Planners;
use yielding::state::YieldingState;

/// Settings of the core. They never change while it runs.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The kinds of robots that there are, at least one, each with a name of its own.
    pub kinds: Vec<RobotKind>,
    /// The control period.
    pub period: Span,
    /// Labels that one search may expand.
    pub expansions_per_plan: u32,
    /// Labels that all searches of one step may expand together.
    pub expansions_per_step: u32,
    /// How many jobs may be open.
    pub waiting_max: usize,
    /// How many assignments may be open.
    pub assignments_max: usize,
    /// How many robots may join.
    pub robots_max: usize,
    /// How many workers may be known.
    pub workers_max: usize,
    /// How many closures there may be, announced, closed, or over since less than a day.
    pub closures_max: usize,
    /// After how many others a job may come.
    pub after_max: usize,
    /// How many corners an area may have.
    pub corners_max: usize,
    /// How the fleet deals with people.
    pub policy: HumanAwarePolicy,
    /// How our own policy recognises intentions.
    pub method: Method,
    /// What was learned about people.
    pub model: Arc<Model>,
    /// Robots pass through one another: only for the bound on throughput.
    pub ghosts: bool,
    /// Reads any clock in nanoseconds, to tell how long searches take. Nothing is ever decided by it.
    pub stopwatch: fn() -> u64,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            kinds: vec![RobotKind::default()],
            period: Span::from_millis(50),
            expansions_per_plan: 2_000,
            expansions_per_step: 30_000,
            waiting_max: 100_000,
            assignments_max: 10_000,
            robots_max: 10_000,
            workers_max: 1_000,
            closures_max: 2_000,
            after_max: 100,
            corners_max: 100,
            policy: HumanAwarePolicy::default(),
            method: Method::Detour,
            model: Model::builtin(),
            ghosts: false,
            stopwatch: || 0,
        }
    }
}

impl Settings {
    /// The kind of this name.
    ///
    /// # Panics
    /// If there is none. Of robots in a ledger, [`Settings::unknown_kinds`] says so beforehand; others cannot join.
    pub fn kind(&self, name: &str) -> &RobotKind {
        let kind = self.kinds.iter().find(|k| k.name == name);
        kind.unwrap_or_else(|| panic!("there is no kind of robots named {name:?}"))
    }

    /// By how much a hold outlasts the moment in which a robot stands on the next node: for all kinds the same, since
    /// they hand places to one another.
    pub fn clearance(&self) -> Span {
        most_dangerous(&self.kinds).clearance
    }

    /// Robots of a ledger that are of no kind that there is, each with its kind.
    pub fn unknown_kinds<'a>(&self, ledger: &'a Ledger) -> Vec<(&'a str, &'a str)> {
        let known = |kind: &str| self.kinds.iter().any(|k| k.name == kind);
        let unknown = ledger.robots.iter().filter(|r| !known(&r.kind));
        unknown.map(|r| (r.name.as_str(), r.kind.as_str())).collect()
    }
}

/// How often routes were searched for. Nobody is promised anything by it, so it is no fact and starts at zero with the
/// process.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    plans: u64,
    failures: u64,
    replans: u64,
}

/// The fleet.
pub struct Fleet {
    settings: Settings,
    ledger: Ledger,
    scene: Scene,
    planners: Planners,
    needs: Needs,
    storage: dispatch::storage::Storage,
    tally: Tally,
    crowd: HumanState,
    yielding: YieldingState,
    plan_times: Vec<u64>,
    /// The robot that is being dealt with: named where a contradiction ends the step.
    at_hand: Option<RobotId>,
    /// Robots of which the ledger knew at the start and that have not been heard of since.
    unheard: BTreeSet<RobotId>,
    /// When the first step was, if there were such robots.
    started: Option<Time>,
    /// Why the last step granted each robot no more than it did.
    withheld: IdVec<RobotId, Option<Withheld>>,
    /// A robot over which the next step panics: for tests of what happens then.
    #[cfg(test)]
    pub trap: Option<RobotId>,
    out: Step,
}

impl Fleet {
    /// An empty fleet in a building.
    pub fn new(warehouse: Arc<Warehouse>, settings: Settings) -> Fleet {
        let clearance = settings.clearance();
        let period_s = settings.period.as_secs_f64();
        let regions = Regions::new(most_dangerous(&settings.kinds), warehouse.footprint_m, period_s);
        Fleet {
            crowd: HumanState::new(&warehouse, regions),
            yielding: YieldingState::default(),
            ledger: Ledger::new(warehouse.clone(), clearance, settings.ghosts),
            scene: Scene::default(),
            planners: Planners::new(&warehouse, &settings.kinds),
            needs: Needs::default(),
            storage: dispatch::storage::Storage::new(&warehouse),
            tally: Tally::default(),
            plan_times: Vec::new(),
            at_hand: None,
            unheard: BTreeSet::new(),
            started: None,
            withheld: IdVec::new(),
            #[cfg(test)]
            trap: None,
            out: Step::default(),
            settings,
        }
    }

    /// The fleet after these facts, with nothing seen yet.
    ///
    /// # Panics
    /// If the facts contradict each other.
    pub fn restore(
        warehouse: Arc<Warehouse>,
        settings: Settings,
        facts: impl IntoIterator<Item = Fact>,
    ) -> Fleet {
        let ledger = Ledger::new(warehouse, settings.clearance(), settings.ghosts);
        Fleet::resume(ledger, settings, facts)
    }

    /// The fleet of a ledger after these facts, with nothing seen yet.
    ///
    /// # Panics
    /// If the facts contradict the ledger or each other.
    pub fn resume(mut ledger: Ledger, settings: Settings, facts: impl IntoIterator<Item = Fact>) -> Fleet {
        facts.into_iter().for_each(|fact| ledger.evolve(&fact));
        let fleet = Fleet::new(ledger.warehouse().clone(), settings);
        let unheard = ledger.robots.ids().collect();
        Fleet { ledger, unheard, ..fleet }
    }

    /// Takes all inputs in, then decides once from what is known now.
    pub fn step(&mut self, now: Time, inputs: Vec<Input>) -> Step {
        self.at_hand = None;
        self.absorb(now, inputs);
        #[cfg(test)]
        self.spring();
        self.evaluate_people(now);
        self.note_progress(now);
        self.assign(now);
        self.plan(now);
        self.grant(now);
        std::mem::take(&mut self.out)
    }

    /// The floor as it is now, for questions.
    fn floor(&self) -> Floor<'_> {
        Floor { ledger: &self.ledger, scene: &self.scene, settings: &self.settings }
    }

    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        self.ledger.warehouse()
    }

    /// What was promised.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// The newest that a robot said of itself.
    pub fn telemetry(&self, robot: RobotId) -> Option<&Telemetry> {
        self.scene.robot(robot)
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// How long the searches since the last call took, nanoseconds by the stopwatch of the settings.
    pub fn take_plan_times(&mut self) -> Vec<u64> {
        std::mem::take(&mut self.plan_times)
    }

    /// Panics over the robot of the trap.
    #[cfg(test)]
    fn spring(&mut self) {
        if let Some(robot) = self.trap {
            self.at_hand = Some(robot);
            panic!("a test asked for it");
        }
    }

    /// Takes a fact into the ledger and into the step's result.
    fn record(&mut self, fact: Fact) {
        self.at_hand = traffic::fence::robot_of(&fact).or(self.at_hand);
        self.ledger.evolve(&fact);
        self.out.facts.push(fact);
    }
}

#[cfg(test)]
mod tests;

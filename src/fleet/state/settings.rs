//! What never changes while a fleet runs: robot kinds of the site, control period, budgets, limits, the policy for
//! people.
//!
//! Main types: [`Settings`], [`FloorLimits`]. Refuses: to be changed by requests.

use super::kind::RobotKind;
use super::link::USUAL_LINK;
use giveway_cell::Flow;
use giveway_cell::arm::ArmMode;
use giveway_floor::time::Span;
use giveway_people::aware::{HumanAwarePolicy, NodeWindows};
use giveway_people::human::{Method, Model};
use giveway_people::reach::PickModel;
use std::sync::Arc;

/// Settings of the core. They never change while it runs.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The robot kinds of the site, with which an empty ledger begins: at least one, each with a unique name. The
    /// ledger has all kinds, including those that were added.
    pub site_kinds: Vec<RobotKind>,
    /// The names of the links by which robots are reached.
    pub links: Vec<String>,
    /// The control period.
    pub period: Span,
    /// Labels that one search may expand.
    pub expansions_per_plan: u32,
    /// Labels that all searches of one step may expand together.
    pub expansions_per_step: u32,
    /// How much of everything the fleet accepts.
    pub limits: FloorLimits,
    /// How the fleet deals with people.
    pub policy: HumanAwarePolicy,
    /// How our own policy recognises intents; [`Method::Chapter3Tiles`] on floors that fit it only.
    pub method: Method,
    /// How our own policy determines when a worker takes a node.
    pub node_windows: NodeWindows,
    /// How order lines and hands at work cells are used.
    pub flow: Flow,
    /// When robot arms move beside pickers.
    pub arm_mode: ArmMode,
    /// What a second of a worker is worth, in seconds of a robot: a robot that waits for a worker goes first if that
    /// costs less ([`HumanAwarePolicy::Giveway`] only).
    pub worker_price: f64,
    /// What was learned about people.
    pub model: Arc<Model>,
    /// What was learned about people who reach for slots.
    pub picks: Arc<PickModel>,
    /// Robots pass through one another: only for the bound on throughput.
    pub without_conflicts: bool,
    /// Reads any clock in nanoseconds, to measure how long searches take. It decides nothing.
    pub stopwatch: fn() -> u64,
}

/// How much of everything a floor accepts. A request beyond a limit is refused, and the refusal names the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FloorLimits {
    /// How many jobs may be open.
    pub open_jobs: usize,
    /// How many assignments may be open.
    pub open_assignments: usize,
    /// How many robots may join.
    pub robots: usize,
    /// How many workers may be known.
    pub workers: usize,
    /// How many closures there may be, announced, closed, or over since less than a day.
    pub closures: usize,
    /// How many closures may recur.
    pub recurring_closures: usize,
    /// How many other jobs a job may come after.
    pub after: usize,
    /// How many corners an area may have.
    pub corners: usize,
}

impl Default for FloorLimits {
    fn default() -> FloorLimits {
        FloorLimits {
            open_jobs: 100_000,
            open_assignments: 10_000,
            robots: 10_000,
            workers: 1_000,
            closures: 2_000,
            recurring_closures: 100,
            after: 100,
            corners: 100,
        }
    }
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            site_kinds: vec![RobotKind::default()],
            links: vec![USUAL_LINK.to_owned()],
            period: Span::from_millis(50),
            expansions_per_plan: 2_000,
            expansions_per_step: 30_000,
            limits: FloorLimits::default(),
            policy: HumanAwarePolicy::default(),
            method: Method::Detour,
            node_windows: NodeWindows::default(),
            flow: Flow::default(),
            arm_mode: ArmMode::default(),
            worker_price: 3.0,
            model: Model::builtin(),
            picks: PickModel::builtin(),
            without_conflicts: false,
            stopwatch: || 0,
        }
    }
}

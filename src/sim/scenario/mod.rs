//! Scenario files: a map, a fleet, customers, faults, how long and with which seed.
//!
//! Main type: [`Scenario`]. Takes text; the caller reads the file and resolves the paths in it. Refuses: unknown
//! keys and numbers that cannot be.

mod cells;
mod check;
mod closures;
mod evacuations;
mod faults;
mod habits;
mod kinds;
mod workforce;

pub use cells::{ArmModeWord, FlowWord, HandSensor, HandSide, LineDemand, PickerHabits, SeenGaze, WorkCells};
pub use check::ScenarioError;
pub use closures::Closing;
pub use evacuations::Evacuation;
pub use faults::Faults;
pub use habits::Habits;
pub use kinds::{KindShare, LocalPlannerWord};
pub use workforce::{
    Assignments, Causes, Deviations, MethodWord, NodeWindowsWord, Personas, Rates, SecondTag, Sensor, Source,
    TaskSharing, Workers,
};

use check::check;
use giveway_fleet::{Closure, RecurringClosure, RobotKind, fitted};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Findings, Warehouse};
use giveway_people::aware::HumanAwarePolicy;
use giveway_people::human::Model;
use giveway_people::human::tiles::Tiles;
use giveway_people::reach::PickModel;
use kinds::{KindFigures, KindFile};
use serde::Deserialize;
use std::sync::Arc;

/// What to simulate.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// The map file, relative to the scenario file.
    pub map: String,
    /// How many robots.
    pub robots: usize,
    /// How long.
    pub duration: Span,
    /// The control period.
    pub period: Span,
    /// The seed unless another is given.
    pub seed: u64,
    /// Where jobs come from.
    pub demand: Demand,
    /// What customers want beside deliveries, and what is done by hand.
    pub customers: Habits,
    /// How long everything may take to end after the customers have stopped, which they do at the end of the
    /// duration; zero for no such phase.
    pub drain: Span,
    /// For how long the floor has worked already when a server begins with an empty database.
    pub warm_up: Span,
    /// What goes wrong.
    pub faults: Faults,
    /// The kinds of robots, at least one; the robots are of them in turn.
    pub kinds: Vec<KindShare>,
    /// The people on the floor.
    pub workers: Workers,
    /// Picking stations with people at them; nothing where customers' jobs have no lines.
    pub cells: Option<WorkCells>,
    /// Areas closed for a time.
    pub closures: Vec<Closing>,
    /// When the building is evacuated, in order.
    pub evacuations: Vec<Evacuation>,
    /// How the fleet gives way to people.
    pub policy: HumanAwarePolicy,
    /// How robots find their way that leave the line to pass people.
    pub local_planner: LocalPlannerWord,
    /// File with what was learned about people, relative to the scenario; the built-in figures where absent.
    pub model: Option<String>,
    /// What is in it.
    pub learned: Arc<Model>,
    /// What pickers are expected to do; the built-in figures unless somebody reads others.
    pub picks: Arc<PickModel>,
}

/// Where jobs come from.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Demand {
    /// Nowhere but from outside.
    None,
    /// So many jobs are always waiting; racks by a skewed popularity, stations evenly.
    Backlog(usize),
    /// So many an hour, at random times.
    PerHour(f64),
    /// Order lines from a file, relative to the scenario file, so many always waiting; repeated from the start
    /// when used up.
    File {
        /// The file.
        path: String,
        /// How many lines are always waiting.
        backlog: usize,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    giveway_scenario: u32,
    name: String,
    map: String,
    robots: usize,
    #[serde(default = "hour")]
    duration_s: f64,
    #[serde(default = "period")]
    period_ms: i64,
    #[serde(default = "one")]
    seed: u64,
    #[serde(default = "none")]
    jobs: Demand,
    #[serde(default)]
    customers: Habits,
    #[serde(default)]
    drain_s: f64,
    #[serde(default)]
    warm_up_s: f64,
    #[serde(default)]
    faults: Faults,
    #[serde(default)]
    fleet: Option<KindFigures>,
    #[serde(default)]
    kinds: Vec<KindFile>,
    #[serde(default)]
    workers: Workers,
    #[serde(default)]
    cells: Option<WorkCells>,
    #[serde(default)]
    closures: Vec<Closing>,
    #[serde(default)]
    evacuations: Vec<Evacuation>,
    #[serde(default)]
    arm: PolicyWord,
    #[serde(default)]
    local_planner: LocalPlannerWord,
    #[serde(default)]
    model: Option<String>,
}

/// [`HumanAwarePolicy`] as files name it.
#[derive(Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum PolicyWord {
    Nhir,
    Shir,
    Phir,
    #[default]
    Giveway,
}

impl From<PolicyWord> for HumanAwarePolicy {
    fn from(word: PolicyWord) -> HumanAwarePolicy {
        match word {
            PolicyWord::Nhir => HumanAwarePolicy::Nhir,
            PolicyWord::Shir => HumanAwarePolicy::Shir,
            PolicyWord::Phir => HumanAwarePolicy::Phir,
            PolicyWord::Giveway => HumanAwarePolicy::Giveway,
        }
    }
}

fn hour() -> f64 {
    3600.0
}

fn period() -> i64 {
    100
}

fn one() -> u64 {
    1
}

fn none() -> Demand {
    Demand::None
}

impl Scenario {
    /// Reads a scenario file.
    ///
    /// # Errors
    /// Where and what is wrong.
    pub fn parse(text: &str) -> Result<Scenario, ScenarioError> {
        let file: File = serde_json::from_str(text).map_err(|e| ScenarioError::syntax(&e))?;
        check(
            "giveway_scenario",
            f64::from(file.giveway_scenario),
            1.0..=1.0,
            "1, the only version there is",
        )?;
        check("robots", file.robots as f64, 0.0..=10_000.0, "from 0 to 10000")?;
        check("duration_s", file.duration_s, 1.0..=1e7, "from 1 to 10000000")?;
        check("period_ms", file.period_ms as f64, 10.0..=1000.0, "from 10 to 1000")?;
        file.faults.check()?;
        check("drain_s", file.drain_s, 0.0..=1e6, "from 0 to 1000000")?;
        check("warm_up_s", file.warm_up_s, 0.0..=3600.0, "from 0 to 3600")?;
        file.customers.check()?;
        file.workers.check()?;
        file.cells.iter().try_for_each(WorkCells::check)?;
        file.closures.iter().try_for_each(Closing::check)?;
        Evacuation::check_all(&file.evacuations)?;
        Ok(Scenario {
            name: file.name,
            map: file.map,
            robots: file.robots,
            duration: Span::from_secs_f64(file.duration_s),
            period: Span::from_millis(file.period_ms),
            seed: file.seed,
            demand: file.jobs,
            customers: file.customers,
            drain: Span::from_secs_f64(file.drain_s),
            warm_up: Span::from_secs_f64(file.warm_up_s),
            faults: file.faults,
            kinds: kinds::read(file.fleet, file.kinds)?,
            workers: file.workers,
            cells: file.cells,
            closures: file.closures,
            evacuations: file.evacuations,
            policy: file.arm.into(),
            local_planner: file.local_planner,
            model: file.model,
            learned: Model::builtin(),
            picks: PickModel::builtin(),
        })
    }

    /// All areas that the scenario closes again and again, if it begins at `start`.
    ///
    /// # Errors
    /// Where the map does not have a node that is to be closed.
    pub fn recurring(
        &self,
        warehouse: &Warehouse,
        start: Time,
    ) -> Result<Vec<RecurringClosure>, ScenarioError> {
        let mut all = Vec::new();
        for closing in self.closures.iter().filter(|c| c.every_s.is_some()) {
            all.extend(
                closing.areas(warehouse, start)?.into_iter().filter_map(|area| closing.recurring(area)),
            );
        }
        Ok(all)
    }

    /// All areas that the scenario closes once, if it begins at `start`.
    ///
    /// # Errors
    /// Where the map does not have a node that is to be closed.
    pub fn areas(&self, warehouse: &Warehouse, start: Time) -> Result<Vec<Closure>, ScenarioError> {
        let once = self.closures.iter().filter(|c| c.every_s.is_none());
        let areas: Result<Vec<_>, _> = once.map(|c| c.areas(warehouse, start)).collect();
        Ok(areas?.concat())
    }

    /// Adds a kind that the file does not have and none of its robots are of. `figures` is an object like `fleet`.
    ///
    /// # Errors
    /// Figures that cannot be, by their keys; a name that there is already.
    pub fn add_kind(&mut self, name: &str, figures: &str) -> Result<(), ScenarioError> {
        if self.kinds.iter().any(|k| k.kind.name == name) {
            let message = format!("there are two kinds named {name:?}");
            return Err(ScenarioError::Wrong { key: "kinds", message });
        }
        self.kinds.push(kinds::read_one(name, figures)?);
        Ok(())
    }

    /// The building for the kinds of robots that the scenario has.
    ///
    /// # Errors
    /// Kinds for which it was not drawn.
    pub fn fit(&self, warehouse: &Arc<Warehouse>) -> Result<Arc<Warehouse>, Findings> {
        let kinds: Vec<RobotKind> = self.kinds.iter().map(|k| k.kind.clone()).collect();
        fitted(warehouse, &kinds)
    }

    /// Whether the policy and the floor have room for the method by which goals of workers are recognised.
    ///
    /// # Errors
    /// What has none, and what to do.
    pub fn check_method(&self, warehouse: &Warehouse) -> Result<(), ScenarioError> {
        let wrong = |message| Err(ScenarioError::Wrong { key: "workers.method", message });
        if self.workers.method == MethodWord::default() {
            return Ok(());
        }
        if self.policy != HumanAwarePolicy::Giveway {
            let arm = self.policy.word();
            return wrong(format!("the arm {arm} recognises goals in its own way: leave the method out"));
        }
        match Tiles::fit(warehouse) {
            Err(e) if self.workers.method == MethodWord::Chapter3Tiles => {
                wrong(format!("{e}: take \"chapter3\", which has no such limit, or \"detour\""))
            }
            _ => Ok(()),
        }
    }

    /// The settings of the core for this scenario.
    pub fn settings(&self) -> giveway_fleet::Settings {
        let Scenario { period, policy, .. } = *self;
        let (method, node_windows) = (self.workers.method.into(), self.workers.node_windows.into());
        let worker_price = self.workers.price;
        let flow = self.cells.as_ref().map(|cells| cells.flow.into()).unwrap_or_default();
        let arm_mode = self.cells.as_ref().map(|cells| cells.arm_mode.into()).unwrap_or_default();
        let (kinds, model) = (self.kinds.iter().map(|k| k.kind.clone()).collect(), self.learned.clone());
        let picks = self.picks.clone();
        giveway_fleet::Settings {
            kinds,
            period,
            policy,
            method,
            node_windows,
            flow,
            arm_mode,
            worker_price,
            model,
            picks,
            ..Default::default()
        }
    }

    /// The kind of robot number `i`, from 0: the robots are of the kinds in turn.
    pub fn kind_of(&self, i: usize) -> &RobotKind {
        let all: usize = self.kinds.iter().map(|k| k.share).sum();
        let mut left = i % all;
        let kind = self.kinds.iter().find(|k| {
            let is_it = left < k.share;
            left = left.saturating_sub(k.share);
            is_it
        });
        &kind.expect("shares are positive").kind
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str =
        r#"{"giveway_scenario": 1, "name": "x", "map": "m.json", "robots": 2, "jobs": {"backlog": 5}}"#;

    #[test]
    fn what_is_left_out_has_sensible_values() {
        let s = Scenario::parse(GOOD).unwrap();
        assert_eq!(s.demand, Demand::Backlog(5));
        assert_eq!(s.duration, Span::from_secs(3600));
    }

    #[test]
    fn a_misspelt_key_is_named_with_its_place() {
        let e = Scenario::parse(&GOOD.replace("robots", "robbots")).unwrap_err();
        assert!(e.to_string().contains("robbots"), "{e}");
    }

    #[test]
    fn absurd_numbers_are_refused_with_what_they_may_be() {
        let e =
            Scenario::parse(&GOOD.replace("\"robots\": 2", "\"robots\": 2, \"duration_s\": -1")).unwrap_err();
        assert_eq!(e.to_string(), "`duration_s` is -1, but must be from 1 to 10000000");
    }

    #[test]
    fn a_bad_headset_among_good_ones_is_named_with_how_many_wear_it() {
        let workers = |of: &str| with(&format!(r#", "workers": {{"count": 3, {of}}}"#));
        let s = workers(r#""liars": 1, "liar_sensor": {"loss": 0.5}"#).unwrap();
        assert_eq!([0, 1, 2].map(|i| s.workers.sensor_of(i).loss), [0.5, 0.0, 0.0]);
        let refused = |of: &str| workers(of).unwrap_err();
        assert_eq!(
            refused(r#""liars": 4, "liar_sensor": {}"#),
            "`workers.liars`: 4 of 3 workers: name no more than there are"
        );
        assert_eq!(
            refused(r#""liars": 1"#),
            "`workers.liar_sensor`: say how the first `liars` workers are seen"
        );
        assert_eq!(
            refused(r#""liars": 1, "liar_sensor": {"loss": 2}"#),
            "`workers.liar_sensor.loss` is 2, but must be from 0 to 1"
        );
    }

    #[test]
    fn a_tag_besides_the_headset_has_an_accuracy_and_a_period_that_can_be() {
        let tag = |of: &str| with(&format!(r#", "workers": {{"count": 1, "tag": {of}}}"#));
        assert_eq!(tag("null").unwrap().workers.tag, None);
        let sensor = tag(r#"{"period_s": 0.5}"#).unwrap().workers.tag.unwrap().sensor();
        assert_eq!((sensor.source, sensor.rate(), sensor.sigma()), (Source::Tag, 2.0, 0.25));
        assert_eq!(
            tag(r#"{"period_s": 0}"#).unwrap_err(),
            "`workers.tag.period_s` is 0, but must be from 0.02 to 2"
        );
    }

    fn with(fleet: &str) -> Result<Scenario, String> {
        let text = format!(r#"{{"giveway_scenario": 1, "name": "x", "map": "m.json", "robots": 7{fleet}}}"#);
        Scenario::parse(&text).map_err(|e| e.to_string())
    }

    #[test]
    fn robots_are_of_the_kinds_in_turn_by_their_shares() {
        let s = with(r#", "kinds": [{"name": "a", "share": 2}, {"name": "b", "fleet": {"speed_mps": 2}}]"#)
            .unwrap();
        let kinds: Vec<&str> = (0..s.robots).map(|i| s.kind_of(i).name.as_str()).collect();
        assert_eq!(kinds, ["a", "a", "b", "a", "a", "b", "a"]);
        assert_eq!((s.kind_of(0).kinematics.speed_mps, s.kind_of(2).kinematics.speed_mps), (1.5, 2.0));
        assert_eq!(with("").unwrap().kind_of(3).name, "robot", "without kinds there is one");
    }

    #[test]
    fn kinds_that_cannot_be_are_refused_with_their_place() {
        let refused = |fleet: &str| with(fleet).unwrap_err();
        assert_eq!(
            refused(r#", "kinds": [{"name": "a"}, {"name": "b", "fleet": {"speed_mps": 9}}]"#),
            "`kinds[1].fleet.speed_mps` is 9, but must be from 0.1 to 5"
        );
        assert!(refused(r#", "kinds": [{"name": "a"}, {"name": "a"}]"#).contains("two kinds named \"a\""));
        assert!(refused(r#", "fleet": {}, "kinds": [{"name": "a"}]"#).contains("leave `fleet` out"));
        assert!(refused(r#", "kinds": [{"name": "a", "share": 0}]"#).contains("kinds[0].share"));
    }
}

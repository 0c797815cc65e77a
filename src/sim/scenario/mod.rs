//! Scenario files: a map, a fleet, customers, faults, the duration and the seed.
//!
//! Main type: [`Scenario`]. Takes text; the caller reads the file and resolves the paths in it. Refuses: unknown keys
//! and impossible numbers.

mod cells;
mod closures;
mod evacuations;
mod faults;
mod habits;
mod sensors;
mod shares;
mod vehicles;
mod workforce;

pub use cells::{HandSensor, HandSide, LineDemand, PickerHabits, SeenGaze, WorkCells};
pub use closures::Closing;
pub use evacuations::Evacuation;
pub use faults::Faults;
pub use habits::Habits;
pub use sensors::{SecondTag, Sensor, Source};
pub use shares::LocalPlannerWord;
pub use workforce::{Assignments, Causes, Deviations, Personas, Rates, TaskSharing, Workers};

use giveway_fleet::{Closure, RecurringClosure, RobotKind};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_people::aware::HumanAwarePolicy;
use giveway_site::{KindFigures, Site, SiteError, SiteLinks, check, words};
use serde::Deserialize;
use shares::KindFile;

/// What to simulate: a site, and what is simulated on it.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The site to simulate.
    pub site: Site,
    /// Number of robots.
    pub robots: usize,
    /// How many robots of each round are of each of the site's kinds. With shares 1 and 2, of three robots the first is
    /// of the first kind and the others of the second. Kinds after the last share get none of the scenario's robots.
    pub shares: Vec<usize>,
    /// Duration of the run.
    pub duration: Span,
    /// The default seed.
    pub seed: u64,
    /// Where jobs come from.
    pub demand: Demand,
    /// What customers want besides deliveries, and what operators do by hand.
    pub customers: Habits,
    /// Longest time for everything to end after the customers have stopped, which they do at the end of the duration;
    /// zero for no such phase.
    pub drain: Span,
    /// How long the floor has already worked when a server begins with an empty database.
    pub warm_up: Span,
    /// All faults.
    pub faults: Faults,
    /// The people on the floor.
    pub workers: Workers,
    /// Picking stations with people at them; nothing if customers' jobs have no lines.
    pub cells: Option<WorkCells>,
    /// Areas closed for a time.
    pub closures: Vec<Closing>,
    /// Evacuations of the building, in order.
    pub evacuations: Vec<Evacuation>,
    /// The local planner of robots that leave the line to pass people.
    pub local_planner: LocalPlannerWord,
}

impl From<Site> for Scenario {
    /// The site with the robots of its simulated link, and nothing else simulated.
    fn from(site: Site) -> Scenario {
        Scenario {
            robots: site.links.sim.map_or(0, |sim| sim.robots),
            shares: vec![1; site.kinds.len()],
            duration: Span::from_secs(3600),
            seed: 1,
            demand: Demand::None,
            customers: Habits::default(),
            drain: Span::ZERO,
            warm_up: Span::ZERO,
            faults: Faults::default(),
            workers: Workers::default(),
            cells: None,
            closures: Vec::new(),
            evacuations: Vec::new(),
            local_planner: LocalPlannerWord::default(),
            site,
        }
    }
}

/// The source of jobs.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Demand {
    /// No simulated jobs; only those from outside.
    None,
    /// A constant number of waiting jobs; racks by a skewed popularity, stations evenly.
    Backlog(usize),
    /// Jobs per hour, at random times.
    PerHour(f64),
    /// Order lines from a file, relative to the scenario file, with a constant number waiting; repeated from the start
    /// when used up.
    File {
        /// Path of the file.
        path: String,
        /// How many lines are always waiting.
        backlog: usize,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScenarioFile {
    giveway_scenario: u32,
    name: String,
    map: String,
    robots: usize,
    #[serde(default = "hour")]
    duration_s: f64,
    #[serde(default)]
    period_ms: Option<i64>,
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
    #[serde(default, deserialize_with = "words::policy")]
    arm: Option<HumanAwarePolicy>,
    #[serde(default)]
    local_planner: LocalPlannerWord,
    #[serde(default)]
    model: Option<String>,
}

fn hour() -> f64 {
    3600.0
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
    /// Where the problem is and what it is.
    pub fn parse(text: &str) -> Result<Scenario, SiteError> {
        let file: ScenarioFile = serde_json::from_str(text).map_err(|e| SiteError::syntax(&e))?;
        check(
            "giveway_scenario",
            f64::from(file.giveway_scenario),
            1.0..=1.0,
            "1, the only version there is",
        )?;
        check("robots", file.robots as f64, 0.0..=10_000.0, "from 0 to 10000")?;
        check("duration_s", file.duration_s, 1.0..=1e7, "from 1 to 10000000")?;
        let usual = Site::default();
        let period_ms = file.period_ms.unwrap_or(usual.period.0 / 1000);
        check("period_ms", period_ms as f64, 10.0..=1000.0, "from 10 to 1000")?;
        file.faults.check()?;
        check("drain_s", file.drain_s, 0.0..=1e6, "from 0 to 1000000")?;
        check("warm_up_s", file.warm_up_s, 0.0..=3600.0, "from 0 to 3600")?;
        file.customers.check()?;
        file.workers.check()?;
        file.cells.iter().try_for_each(WorkCells::check)?;
        file.closures.iter().try_for_each(Closing::check)?;
        Evacuation::check_all(&file.evacuations)?;
        let (kinds, shares) = shares::read(file.fleet, file.kinds)?;
        let (mut workers, mut cells) = (file.workers, file.cells);
        let (flow, arm_mode) = cells.as_mut().map(WorkCells::take_choices).unwrap_or_default();
        let site = Site {
            name: file.name,
            map: file.map,
            kinds,
            policy: file.arm.unwrap_or(usual.policy),
            method: workers.method.take().unwrap_or(usual.method),
            node_windows: workers.node_windows.take().unwrap_or(usual.node_windows),
            worker_price: workers.price.take().unwrap_or(usual.worker_price),
            period: Span::from_millis(period_ms),
            flow: flow.unwrap_or(usual.flow),
            arm_mode: arm_mode.unwrap_or(usual.arm_mode),
            links: SiteLinks::simulated(file.robots),
            model: file.model,
            ..usual
        };
        Ok(Scenario {
            site,
            robots: file.robots,
            shares,
            duration: Span::from_secs_f64(file.duration_s),
            seed: file.seed,
            demand: file.jobs,
            customers: file.customers,
            drain: Span::from_secs_f64(file.drain_s),
            warm_up: Span::from_secs_f64(file.warm_up_s),
            faults: file.faults,
            workers,
            cells,
            closures: file.closures,
            evacuations: file.evacuations,
            local_planner: file.local_planner,
        })
    }

    /// All areas that the scenario closes repeatedly, if it begins at `start`.
    ///
    /// # Errors
    /// If the map lacks a node that is to be closed.
    pub fn recurring(&self, warehouse: &Warehouse, start: Time) -> Result<Vec<RecurringClosure>, SiteError> {
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
    /// If the map lacks a node that is to be closed.
    pub fn areas(&self, warehouse: &Warehouse, start: Time) -> Result<Vec<Closure>, SiteError> {
        let once = self.closures.iter().filter(|c| c.every_s.is_none());
        let areas: Result<Vec<_>, _> = once.map(|c| c.areas(warehouse, start)).collect();
        Ok(areas?.concat())
    }

    /// Whether the policy and the floor support the method by which workers' goals are recognised.
    ///
    /// # Errors
    /// What does not support the method, with a remedy.
    pub fn check_method(&self, warehouse: &Warehouse) -> Result<(), SiteError> {
        self.site.check_method(warehouse, "workers.method")
    }

    /// The scenario with robots of these kinds in turn.
    pub fn with_kinds(mut self, kinds: impl Into<Vec<RobotKind>>) -> Scenario {
        self.site.kinds = kinds.into();
        self.shares = vec![1; self.site.kinds.len()];
        self
    }

    /// The kind of robot number `i`, from 0: the robots are of the kinds in turn.
    pub fn kind_of(&self, i: usize) -> &RobotKind {
        let mut left = i % self.shares.iter().sum::<usize>();
        let kind = self.site.kinds.iter().zip(&self.shares).find(|(_, share)| {
            let is_it = left < **share;
            left = left.saturating_sub(**share);
            is_it
        });
        kind.expect("shares are positive").0
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

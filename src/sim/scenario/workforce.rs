//! The part of a scenario about people: how many, their assignments, what they do instead, how devices see them.
//!
//! Main types: [`Workers`], [`Assignments`], [`Deviations`], [`Rates`], [`Personas`]. Refuses: impossible
//! numbers, and to simulate anybody.

use super::sensors::{SecondTag, Sensor};
use super::vehicles::DrivenVehicle;
use giveway_people::aware::NodeWindows;
use giveway_people::human::{Method, Mover};
use giveway_site::{SiteError, check, words};
use serde::Deserialize;

/// The people of a scenario.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Workers {
    /// Number of workers on foot.
    pub count: usize,
    /// Vehicles with a driver, besides the workers on foot.
    pub vehicles: Vec<DrivenVehicle>,
    /// When the first worker enters by a door, seconds; the others follow, three seconds apart.
    pub enter_s: f64,
    /// When the workers go to a door and leave, seconds; absent for never.
    pub leave_s: Option<f64>,
    /// The workers' assignments.
    pub assignments: Assignments,
    /// How assignments are shared among workers.
    pub tasks: TaskSharing,
    /// What workers do instead of their assignments.
    pub deviations: Deviations,
    /// How devices see the workers.
    pub sensor: Sensor,
    /// Number of workers, counted from the first, seen by [`Workers::liar_sensor`] instead.
    pub liars: usize,
    /// How devices see the `liars`; needed if there are any.
    pub liar_sensor: Option<Sensor>,
    /// A tag that every worker also wears; absent for none.
    pub tag: Option<SecondTag>,
    /// How workers respond to robots, in shares of all workers.
    pub personas: Personas,
    /// Share of the workers who walk in pairs.
    pub pairs: f64,
    /// Radius within which a moving robot counts as encountered, metres.
    pub encounter_m: f64,
    /// How the fleet recognises workers' goals. Only in files: a scenario that was read has it in its site, and so with
    /// the two that follow.
    #[serde(deserialize_with = "words::method")]
    pub method: Option<Method>,
    /// How the fleet predicts when workers occupy a node.
    #[serde(deserialize_with = "words::node_windows")]
    pub node_windows: Option<NodeWindows>,
    /// What a second of a worker's time is worth to the fleet, in seconds of a robot.
    pub price: Option<f64>,
}

/// What workers are assigned to do.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Assignments {
    /// Only assignments from outside.
    None,
    /// One rack after another, at random.
    Random {
        /// Duration of each assignment, seconds.
        stay_s: f64,
    },
    /// The listed places in turn, from the start again when done.
    List {
        /// Names of nodes.
        places: Vec<String>,
        /// Duration of each assignment, seconds.
        stay_s: f64,
    },
}

/// How assignments are shared among workers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskSharing {
    /// Each worker has assignments of its own.
    #[default]
    Own,
    /// The nearest free worker takes the oldest assignment.
    Nearest,
}

/// What workers do instead of their assignments.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Deviations {
    /// When every worker sets off to a place unknown to the fleet, seconds.
    pub at_s: Vec<f64>,
    /// Other causes of deviations.
    pub causes: Causes,
}

/// Causes of deviations besides robots in the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Causes {
    /// No causes.
    #[default]
    None,
    /// All causes, as often as [`Rates::USUAL`] says.
    All,
    /// Causes at these rates.
    Rates(Rates),
}

/// How often each deviation happens to a worker who walks to work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rates {
    /// Stops for a moment, perhaps for the phone, per hour.
    pub pause_per_hour: f64,
    /// Looks around while walking, per hour.
    pub look_per_hour: f64,
    /// Turns to another place that the fleet knows of, per hour.
    pub mind_per_hour: f64,
    /// Goes to a place that the fleet does not know of, per hour.
    pub unknown_per_hour: f64,
    /// Walks about without any goal, per hour.
    pub wander_per_hour: f64,
    /// Runs to help a colleague, or to something that fell, per hour.
    pub help_per_hour: f64,
    /// Probability that a new path is not followed.
    pub ignore: f64,
}

impl Rates {
    /// Default rates of simulated workers: a proposal, since there are no published rates.
    pub const USUAL: Rates = Rates {
        pause_per_hour: 30.0,
        look_per_hour: 60.0,
        mind_per_hour: 40.0,
        unknown_per_hour: 12.0,
        wander_per_hour: 6.0,
        help_per_hour: 6.0,
        ignore: 0.1,
    };
}

impl Causes {
    /// The causes as rates.
    pub fn rates(self) -> Rates {
        match self {
            Causes::None => Rates::default(),
            Causes::All => Rates::USUAL,
            Causes::Rates(rates) => rates,
        }
    }
}

/// How workers respond to robots, in shares of all workers.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Personas {
    /// Share who step aside, or stop.
    pub yields: f64,
    /// Share who walk faster.
    pub hurries: f64,
    /// Share who stand until the robot stands, or is away.
    pub freezes: f64,
    /// Share who take no notice.
    pub cuts_through: f64,
}

impl Default for Personas {
    fn default() -> Personas {
        Personas { yields: 0.4, hurries: 0.2, freezes: 0.2, cuts_through: 0.2 }
    }
}

impl Default for Workers {
    fn default() -> Workers {
        Workers {
            count: 0,
            vehicles: Vec::new(),
            enter_s: 0.0,
            leave_s: None,
            assignments: Assignments::Random { stay_s: 15.0 },
            tasks: TaskSharing::Own,
            deviations: Deviations::default(),
            sensor: Sensor::default(),
            liars: 0,
            liar_sensor: None,
            tag: None,
            personas: Personas::default(),
            pairs: 0.0,
            encounter_m: 1.5,
            method: None,
            node_windows: None,
            price: None,
        }
    }
}

impl Workers {
    /// Refuses impossible numbers.
    pub(super) fn check(&self) -> Result<(), SiteError> {
        let times = 0.0..=1e7;
        check("workers.price", self.price.unwrap_or(0.0), 0.0..=1000.0, "from 0 to 1000")?;
        check("workers.count", self.count as f64, 0.0..=200.0, "from 0 to 200")?;
        check("workers.enter_s", self.enter_s, times.clone(), "from 0 to 10000000")?;
        check("workers.leave_s", self.leave_s.unwrap_or(0.0), times.clone(), "from 0 to 10000000")?;
        check("workers.encounter_m", self.encounter_m, 0.1..=20.0, "from 0.1 to 20")?;
        check("workers.pairs", self.pairs, 0.0..=1.0, "a share from 0 to 1")?;
        if let Assignments::Random { stay_s } | Assignments::List { stay_s, .. } = self.assignments {
            check("workers.assignments.stay_s", stay_s, 0.0..=1e5, "from 0 to 100000")?;
        }
        for at in &self.deviations.at_s {
            check("workers.deviations.at_s", *at, times.clone(), "from 0 to 10000000")?;
        }
        let p = self.personas;
        let shares = [p.yields, p.hurries, p.freezes, p.cuts_through];
        for share in shares {
            check("workers.personas", share, 0.0..=1.0, "shares from 0 to 1")?;
        }
        check("workers.personas", shares.iter().sum(), 0.999..=1.001, "shares that add up to 1")?;
        self.deviations.causes.rates().check()?;
        self.sensor.check("workers.sensor")?;
        self.tag.map_or(Ok(()), |tag| tag.check("workers.tag"))?;
        check("workers.vehicles", self.vehicles.len() as f64, 0.0..=50.0, "0 to 50 vehicles")?;
        self.vehicles.iter().try_for_each(DrivenVehicle::check)?;
        self.check_liars()
    }

    fn check_liars(&self) -> Result<(), SiteError> {
        let wrong = |key, message: String| Err(SiteError::Wrong { key, message });
        if self.liars > self.count {
            let message = format!("{} of {} workers: name no more than there are", self.liars, self.count);
            return wrong("workers.liars", message);
        }
        match &self.liar_sensor {
            Some(sensor) => sensor.check("workers.liar_sensor"),
            None if self.liars > 0 => {
                wrong("workers.liar_sensor", "say how the first `liars` workers are seen".to_owned())
            }
            None => Ok(()),
        }
    }

    /// Number of all workers: those on foot, then those in vehicles.
    pub fn all(&self) -> usize {
        self.count + self.vehicles.len()
    }

    /// What worker number `i` moves as.
    pub(crate) fn mover_of(&self, i: usize) -> Mover {
        let driven = i.checked_sub(self.count).and_then(|k| self.vehicles.get(k));
        driven.map_or(Mover::OnFoot, |driven| Mover::Vehicle(driven.vehicle()))
    }

    /// How the device of worker number `i` sees the worker.
    pub(crate) fn sensor_of(&self, i: usize) -> Sensor {
        if let Some(driven) = i.checked_sub(self.count).and_then(|k| self.vehicles.get(k)) {
            return driven.tag.sensor();
        }
        self.liar_sensor.filter(|_| i < self.liars).unwrap_or(self.sensor)
    }
}

impl Rates {
    fn check(&self) -> Result<(), SiteError> {
        let rates = [
            self.pause_per_hour,
            self.look_per_hour,
            self.mind_per_hour,
            self.unknown_per_hour,
            self.wander_per_hour,
            self.help_per_hour,
        ];
        for rate in rates {
            check("workers.deviations.causes.rates", rate, 0.0..=3600.0, "from 0 to 3600 an hour")?;
        }
        check("workers.deviations.causes.rates.ignore", self.ignore, 0.0..=1.0, "from 0 to 1")
    }
}

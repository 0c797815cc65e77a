//! The description of one floor: its map, kinds of robots, how it gives way to people, limits and links; and its file.
//!
//! Main type: [`Site`]. A scenario is a site with toys: simulated customers, people and faults. Takes text; the caller
//! reads the file and resolves the paths in it. Refuses: unknown keys, numbers out of range, and to hold anything that
//! changes while the floor works.

mod check;
mod file;
mod frame;
mod kinds;
mod open_kind;
mod robots;
mod vda5050;
pub mod words;

pub use check::{SiteError, check};
pub use frame::MapFrame;
pub use kinds::{KindFigures, NamedKind, read_kind, read_kinds};
pub use open_kind::{FigureOrigin, KindFigure, OpenKind};
pub use robots::{BrokerSettings, RobotsFile, RobotsFileError};
pub use vda5050::{
    ActionForm, InstantKey, LinkFigures, ListedRobot, MQTT_LINK, MqttLink, MqttVersion, RepeatRule,
    RobotLinkSettings, SpeltDeviation,
};

use giveway_cell::Flow;
use giveway_cell::arm::ArmMode;
use giveway_fleet::{FloorLimits, RobotKind, Settings, USUAL_LINK, fitted};
use giveway_floor::time::Span;
use giveway_floor::warehouse::{Findings, Warehouse};
use giveway_people::aware::{HumanAwarePolicy, NodeWindows};
use giveway_people::human::tiles::Tiles;
use giveway_people::human::{Method, Model};
use giveway_people::reach::PickModel;
use std::sync::Arc;

/// The description of one floor.
#[derive(Clone, Debug)]
pub struct Site {
    /// Name of the floor.
    pub name: String,
    /// The map file, relative to the site's own file.
    pub map: String,
    /// The kinds of robots, at least one, each with a name of its own.
    pub kinds: Vec<RobotKind>,
    /// How the fleet gives way to people.
    pub policy: HumanAwarePolicy,
    /// How our own policy recognises where workers are going.
    pub method: Method,
    /// How our own policy finds out when a worker takes a node.
    pub node_windows: NodeWindows,
    /// The cost of a second of a worker, in seconds of a robot.
    pub worker_price: f64,
    /// The control period.
    pub period: Span,
    /// How the fleet uses order lines and hands at picking stations.
    pub flow: Flow,
    /// When robot arms move beside pickers.
    pub arm_mode: ArmMode,
    /// Limits on how much of everything the fleet accepts.
    pub limits: FloorLimits,
    /// The links to the robots.
    pub links: SiteLinks,
    /// The file with the learned model of people, relative to the site's own file; the built-in figures if absent.
    pub model: Option<String>,
    /// The contents of the model file, or the built-in figures.
    pub learned: Arc<Model>,
    /// The expected behaviour of pickers; the built-in figures unless others are read.
    pub picks: Arc<PickModel>,
}

/// The links to the robots of a site.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SiteLinks {
    /// Simulated robots on this floor; nothing if there are none.
    pub sim: Option<SimLink>,
    /// Robots that speak VDA 5050; nothing if there are none.
    pub mqtt: Option<MqttLink>,
}

/// The link to simulated robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimLink {
    /// Number of robots, of the site's kinds in turn.
    pub robots: usize,
}

impl SiteLinks {
    /// A link to this many simulated robots.
    pub fn simulated(robots: usize) -> SiteLinks {
        SiteLinks { sim: Some(SimLink { robots }), mqtt: None }
    }

    /// The names of the links.
    pub fn names(&self) -> Vec<String> {
        let sim = self.sim.iter().map(|_| USUAL_LINK.to_owned());
        sim.chain(self.mqtt.iter().map(|_| MQTT_LINK.to_owned())).collect()
    }
}

impl Default for Site {
    /// A floor with robots of one kind, a map without a name yet, and no links.
    fn default() -> Site {
        let Settings { site_kinds: kinds, period, policy, method, node_windows, flow, arm_mode, .. } =
            Settings::default();
        let Settings { worker_price, limits, model, picks, .. } = Settings::default();
        Site {
            name: String::new(),
            map: String::new(),
            kinds,
            policy,
            method,
            node_windows,
            worker_price,
            period,
            flow,
            arm_mode,
            limits,
            links: SiteLinks::default(),
            model: None,
            learned: model,
            picks,
        }
    }
}

impl Site {
    /// Reads a site file.
    ///
    /// # Errors
    /// Where and what is wrong.
    pub fn parse(text: &str) -> Result<Site, SiteError> {
        file::parse(text)
    }

    /// The settings of the core for this floor.
    pub fn settings(&self) -> Settings {
        Settings {
            site_kinds: self.kinds.clone(),
            period: self.period,
            policy: self.policy,
            method: self.method,
            node_windows: self.node_windows,
            flow: self.flow,
            arm_mode: self.arm_mode,
            links: self.links.names(),
            worker_price: self.worker_price,
            limits: self.limits,
            model: self.learned.clone(),
            picks: self.picks.clone(),
            ..Settings::default()
        }
    }

    /// The building for the site's kinds of robots.
    ///
    /// # Errors
    /// Kinds for which the building was not drawn.
    pub fn fit(&self, warehouse: &Arc<Warehouse>) -> Result<Arc<Warehouse>, Findings> {
        let open = self.links.mqtt.iter().flat_map(|link| &link.open);
        for kind in open.filter_map(|kind| kind.filled(None).ok()) {
            fitted(warehouse, &[kind])?;
        }
        fitted(warehouse, &self.kinds)
    }

    /// Checks that the policy and the floor support the method by which goals of workers are recognised. `key` names
    /// the setting in refusals.
    ///
    /// # Errors
    /// What does not support the method, with a remedy.
    pub fn check_method(&self, warehouse: &Warehouse, key: &'static str) -> Result<(), SiteError> {
        let wrong = |message| Err(SiteError::Wrong { key, message });
        if self.method == Method::Detour {
            return Ok(());
        }
        if self.policy != HumanAwarePolicy::Giveway {
            let policy = self.policy.word();
            return wrong(format!(
                "the policy {policy} recognises goals in its own way: leave the method out"
            ));
        }
        match Tiles::fit(warehouse) {
            Err(e) if self.method == Method::Chapter3Tiles => {
                wrong(format!("{e}: take \"chapter3\", which has no such limit, or \"detour\""))
            }
            _ => Ok(()),
        }
    }
}

//! What one floor is: its map, kinds of robots, how it gives way to people, limits and links; and the file that says
//! so.
//!
//! Main type: [`Site`]. A scenario is a site with toys: simulated customers, people and faults. Takes text; the caller
//! reads the file and resolves the paths in it. Refuses: unknown keys, numbers that cannot be, and to hold anything
//! that changes while the floor works.

mod check;
mod file;
mod kinds;
pub mod words;

pub use check::{SiteError, check};
pub use kinds::{KindFigures, NamedKind, read_kind, read_kinds};

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

/// What one floor is.
#[derive(Clone, Debug)]
pub struct Site {
    /// Its name.
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
    /// What a second of a worker is worth, in seconds of a robot.
    pub worker_price: f64,
    /// The control period.
    pub period: Span,
    /// What the fleet makes of order lines and hands at picking stations.
    pub flow: Flow,
    /// When robot arms move beside pickers.
    pub arm_mode: ArmMode,
    /// How much of everything there may be.
    pub limits: FloorLimits,
    /// What robots are behind.
    pub links: SiteLinks,
    /// The file with what was learned about people, relative to the site's own file; the built-in figures where absent.
    pub model: Option<String>,
    /// What is in it.
    pub learned: Arc<Model>,
    /// What pickers are expected to do; the built-in figures unless others are read.
    pub picks: Arc<PickModel>,
}

/// What the robots of a site are behind. Robots of others will be behind a link of their own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SiteLinks {
    /// Simulated robots on this floor; nothing for none.
    pub sim: Option<SimLink>,
}

/// The link to simulated robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimLink {
    /// How many robots there are, of the site's kinds in turn.
    pub robots: usize,
}

impl SiteLinks {
    /// A link to so many simulated robots.
    pub fn simulated(robots: usize) -> SiteLinks {
        SiteLinks { sim: Some(SimLink { robots }) }
    }

    /// The names of its links.
    pub fn names(&self) -> Vec<String> {
        self.sim.iter().map(|_| USUAL_LINK.to_owned()).collect()
    }
}

impl Default for Site {
    /// A floor with robots of one kind, a map that is still to be named, and no links.
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
    /// Kinds for which it was not drawn.
    pub fn fit(&self, warehouse: &Arc<Warehouse>) -> Result<Arc<Warehouse>, Findings> {
        fitted(warehouse, &self.kinds)
    }

    /// Whether the policy and the floor have room for the method by which goals of workers are recognised. `key` names
    /// the setting in refusals.
    ///
    /// # Errors
    /// What has none, and what to do.
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

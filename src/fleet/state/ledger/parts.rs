//! An empty ledger, and a ledger restored from what was stored of it.
//!
//! Main types: [`Parts`] (all contents of a ledger, plain), [`Contradiction`]. Refuses: parts that contradict the map
//! or one another, in words; a ledger that this program stored never does.

use super::{Ledger, Promises, RackAt, Sums};
use crate::state::fact::{Act, Task};
use crate::state::index::Index;
use crate::state::job::RobotChoice;
use crate::state::keys::Keys;
use crate::state::kind::RobotKind;
use crate::state::kinds::RobotKinds;
use crate::state::wishes::Wishes;
use giveway_floor::id::{Dense, IdVec, NodeId, RackId, RobotId};
use giveway_floor::timeline::{ChainParts, Flaw, Timeline};
use giveway_floor::warehouse::Warehouse;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Deref;
use std::sync::Arc;

/// All contents of a ledger.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// What was promised, without the holds.
    pub promises: Promises,
    /// The kinds of robots that were added to those of the site.
    pub added_kinds: Vec<RobotKind>,
    /// All holds.
    pub chains: Vec<ChainParts>,
}

impl Deref for Parts {
    type Target = Promises;

    fn deref(&self) -> &Promises {
        &self.promises
    }
}

/// Why parts do not make a ledger.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Contradiction {
    /// Holds contradict one another.
    #[error(transparent)]
    Holds(#[from] Flaw),
    /// The number of entries is not that of the map.
    #[error("there are {found} {what}, and the map has {expected}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A part names something that does not exist.
    #[error("{what} names something that does not exist")]
    Unknown {
        /// The part that does.
        what: String,
    },
    /// A rack is at a place where it cannot be.
    #[error("rack {rack:?} is at a place where another one is")]
    Rack {
        /// The rack.
        rack: RackId,
    },
}

impl Ledger {
    /// A ledger in which nothing is promised and racks are at home. The building is for the kinds of the site.
    /// `without_conflicts` is for the bound on throughput only.
    pub fn new(warehouse: Arc<Warehouse>, site_kinds: &[RobotKind], without_conflicts: bool) -> Ledger {
        let kinds = RobotKinds::of_site(site_kinds);
        let clearance = kinds.clearance();
        let racks = warehouse.racks.iter().map(|r| RackAt::Stored(r.home)).collect();
        let served = IdVec::filled(0, warehouse.stations.len());
        let index = Index::new(&warehouse);
        let wishes = Wishes::none(warehouse.racks.len());
        let timeline =
            if without_conflicts { Timeline::without_conflicts } else { Timeline::new }(warehouse, clearance);
        let promises = Promises {
            jobs: BTreeMap::new(),
            next_job: 1,
            keys: Keys::default(),
            robots: IdVec::new(),
            racks,
            served,
            workers: IdVec::new(),
            on_floor: BTreeMap::new(),
            vehicles: BTreeMap::new(),
            assignments: BTreeMap::new(),
            next_assignment: 1,
            assignment_keys: Keys::default(),
            closures: BTreeMap::new(),
            next_closure: 1,
            recurring: BTreeMap::new(),
            next_series: 1,
            evacuation: None,
            paused_stations: BTreeMap::new(),
            unconfirmed: BTreeMap::new(),
            stopped: None,
            ended_badly: BTreeMap::new(),
            counts: Sums::default(),
            wishes,
        };
        let mut ledger = Ledger { promises, kinds, timeline, index };
        ledger.reindex();
        ledger
    }

    /// An empty ledger in the same building, with the kinds of the site alone: what a fold of all facts begins with.
    pub fn emptied(&self) -> Ledger {
        let bodies = self.kinds.site().iter().map(RobotKind::body).collect();
        let warehouse = match self.kinds.added() {
            [] => self.warehouse().clone(),
            _ => Arc::new(self.warehouse().with_bodies(bodies)),
        };
        Ledger::new(warehouse, self.kinds.site(), false)
    }

    /// All contents, to be stored.
    pub fn to_parts(&self) -> Parts {
        let chains = self.timeline.chains().map(|(holder, chain)| ChainParts {
            holder,
            first: chain.first(),
            granted: chain.granted(),
            visits: chain.visits().cloned().collect(),
            absent: chain.is_absent(),
        });
        let added_kinds = self.kinds.added().to_vec();
        Parts { promises: self.promises.clone(), added_kinds, chains: chains.collect() }
    }

    /// A ledger with exactly these parts, in a building for the kinds of its site.
    ///
    /// # Errors
    /// The first contradiction.
    pub fn from_parts(
        warehouse: Arc<Warehouse>,
        site_kinds: &[RobotKind],
        parts: Parts,
    ) -> Result<Ledger, Contradiction> {
        let kinds = RobotKinds::of_site(site_kinds).with_added(parts.added_kinds);
        let bodies = kinds.iter().map(RobotKind::body).collect();
        let warehouse = match kinds.added() {
            [] => warehouse,
            _ => Arc::new(warehouse.with_bodies(bodies)),
        };
        check_counts(&warehouse, (&parts.promises, &parts.chains))?;
        check_names(&warehouse, &parts.promises)?;
        check_racks(&parts.promises)?;
        let index = Index::new(&warehouse);
        let bodies = parts.promises.robots.iter().map(|r| warehouse.body_of(&r.kind)).collect();
        let timeline = Timeline::restore(warehouse, kinds.clearance(), bodies, parts.chains)?;
        let mut ledger = Ledger { promises: parts.promises, kinds, timeline, index };
        ledger.reindex();
        Ok(ledger)
    }
}

fn check_counts(w: &Warehouse, (p, chains): (&Promises, &[ChainParts])) -> Result<(), Contradiction> {
    let robots = (0..p.robots.len()).map(RobotId::at);
    let standing = robots.filter(|h| chains.iter().any(|c| c.holder == *h)).count();
    for (what, found, expected) in [
        ("racks", p.racks.len(), w.racks.len()),
        ("racks with wishes", p.wishes.counts().len(), w.racks.len()),
        ("stations", p.served.len(), w.stations.len()),
    ] {
        if found != expected {
            return Err(Contradiction::Count { what, found, expected });
        }
    }
    match standing == p.robots.len() && standing == chains.len() {
        true => Ok(()),
        false => Err(Contradiction::Unknown { what: "the list of who stands where".into() }),
    }
}

/// Checks that everything that is named exists.
fn check_names(w: &Warehouse, p: &Promises) -> Result<(), Contradiction> {
    let node = |n: NodeId| n.ix() < w.nodes.len();
    let rack = |r: RackId| r.ix() < w.racks.len();
    let robot = |r: RobotId| r.ix() < p.robots.len();
    let known = |so: bool, what: String| if so { Ok(()) } else { Err(Contradiction::Unknown { what }) };
    for (id, at) in p.racks.pairs() {
        let fits = match *at {
            RackAt::Stored(n) => node(n),
            RackAt::On(r) => robot(r),
        };
        known(fits, format!("rack {id:?}"))?;
    }
    for (id, job) in &p.jobs {
        let fits = job.request.kind.is_known(w, p.robots.len());
        let served = job.served.iter().map(|(v, _)| v);
        let mut visits = job.request.then.iter().chain(served);
        let fits = fits && visits.all(|v| v.station.ix() < w.stations.len());
        let chosen = match job.choice {
            RobotChoice::Any => true,
            RobotChoice::Except(r, _) | RobotChoice::Only(r, _) => robot(r),
        };
        let fits = fits && chosen && id.0 < p.next_job && job.state.robot().is_none_or(robot);
        known(fits, format!("job {id:?}"))?;
    }
    for (id, record) in p.robots.pairs() {
        let task = match record.task {
            Task::Idle => true,
            Task::Fetch { rack: r, node: n, .. } => rack(r) && node(n),
            Task::Deliver { rack: r, station, store, .. } => rack(r) && node(station) && node(store),
            Task::Store { rack: r, store, .. } => rack(r) && node(store),
            Task::Move { goal, stay, .. } => node(goal) && node(stay),
        };
        let stops = record.stops.iter().all(|s| match s.act {
            Act::Lift(r) | Act::Set(r) => rack(r),
            Act::Pick(_) | Act::Arrive => true,
        });
        known(task && stops, format!("robot {id:?}"))?;
    }
    for id in p.paused_stations.keys().chain(p.unconfirmed.keys()) {
        known(id.ix() < w.stations.len(), format!("paused station {id:?}"))?;
    }
    for (id, a) in &p.assignments {
        let worker = a.worker.is_none_or(|w| w.ix() < p.workers.len());
        let fits = node(a.request.place) && worker && id.0 < p.next_assignment;
        known(fits, format!("assignment {id:?}"))?;
    }
    for id in p.vehicles.keys() {
        known(id.ix() < p.workers.len(), format!("driver {id:?}"))?;
    }
    for (id, area) in &p.closures {
        known(area.nodes.iter().all(|n| node(*n)) && id.0 < p.next_closure, format!("closure {id:?}"))?;
    }
    for (id, recurring) in &p.recurring {
        let fits = recurring.area.nodes.iter().all(|n| node(*n)) && id.0 < p.next_series;
        known(fits, format!("recurring closure {id:?}"))?;
    }
    Ok(())
}

/// Checks that no node and no robot has two racks.
fn check_racks(p: &Promises) -> Result<(), Contradiction> {
    let (mut nodes, mut robots) = (BTreeSet::new(), BTreeSet::new());
    for (rack, at) in p.racks.pairs() {
        let alone = match *at {
            RackAt::Stored(node) => nodes.insert(node),
            RackAt::On(robot) => robots.insert(robot),
        };
        if !alone {
            return Err(Contradiction::Rack { rack });
        }
    }
    Ok(())
}

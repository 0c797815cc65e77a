//! Routes and grants: which robots need a route, what has come true, what is late, how far each robot may drive now.
//!
//! Main type: [`Traffic`]; main functions: `note_progress`, `plan_needed`, `grant`. Refuses: to decide what a robot
//! does, and to know why a robot yields.

pub(in crate::fleet) mod binding;
pub(in crate::fleet) mod closures;
pub(in crate::fleet) mod displaced;
pub(in crate::fleet) mod fence;
pub(in crate::fleet) mod grant;
pub(in crate::fleet) mod joint;
pub(in crate::fleet) mod plan;
pub(in crate::fleet) mod progress;
pub(in crate::fleet) mod revoke;
pub(in crate::fleet) mod truncate;

use crate::fleet::state::kind::RobotKind;
use crate::fleet::state::needs::Needs;
use crate::fleet::state::planners::Planners;
use crate::id::{IdVec, RobotId};
use crate::time::Time;
use crate::warehouse::Warehouse;
use grant::Withheld;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How often routes were searched for. Nobody is promised anything by it, so it is no fact and starts at zero with the
/// process.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::fleet) struct Tally {
    pub plans: u64,
    pub failures: u64,
    pub replans: u64,
}

/// What is kept in mind about routes and grants, from step to step. Lost at a restart, and found out again.
#[derive(Debug)]
pub(in crate::fleet) struct Traffic {
    pub planners: Planners,
    pub needs: Needs,
    pub tally: Tally,
    /// How long searches took, nanoseconds by the stopwatch of the settings.
    pub plan_times: Vec<u64>,
    /// Robots of which the ledger knew at the start and that have not been heard of since.
    unheard: BTreeSet<RobotId>,
    /// When the first step was, if there were such robots.
    started: Option<Time>,
    /// Why the last step granted each robot no more than it did.
    withheld: IdVec<RobotId, Option<Withheld>>,
    /// When each robot was called back last while it stood for a worker.
    called_back: BTreeMap<RobotId, Time>,
    /// When each robot last looked for a route round a closed area.
    looked_round: BTreeMap<RobotId, Time>,
}

impl Traffic {
    /// Nothing is planned. `unheard` are the robots that a ledger knows.
    pub fn new(warehouse: &Arc<Warehouse>, kinds: &[RobotKind], unheard: BTreeSet<RobotId>) -> Traffic {
        Traffic {
            planners: Planners::new(warehouse, kinds),
            needs: Needs::default(),
            tally: Tally::default(),
            plan_times: Vec::new(),
            unheard,
            started: None,
            withheld: IdVec::new(),
            called_back: BTreeMap::new(),
            looked_round: BTreeMap::new(),
        }
    }

    /// Why the last step granted a robot no more than it did, if there was a reason.
    pub fn withheld(&self, robot: RobotId) -> Option<Withheld> {
        self.withheld.get(robot).copied().flatten()
    }

    /// Whether a robot was called back and has not left yet.
    pub fn is_called_back(&self, robot: RobotId) -> bool {
        self.called_back.contains_key(&robot)
    }
}

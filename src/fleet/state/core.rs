//! What the rooms build on: what was promised, what is seen, what restricts robots now, and what the step gives out.
//!
//! Main type: [`Core`]. Each room has it as an argument, reads it through [`Floor`], and changes what was promised by
//! facts alone. Refuses: to keep anything that belongs to one room.

use crate::fleet::state::activity::Activities;
use crate::fleet::state::arms::Arms;
use crate::fleet::state::at_hand::AtHand;
use crate::fleet::state::fact::{Fact, JobFact, Task};
use crate::fleet::state::floor::Floor;
use crate::fleet::state::io::Step;
use crate::fleet::state::job::JobState;
use crate::fleet::state::ledger::Ledger;
use crate::fleet::state::regions::KindRegions;
use crate::fleet::state::restrictions::Restrictions;
use crate::fleet::state::scene::Scene;
use crate::fleet::state::settings::Settings;
use crate::fleet::state::storage::Storage;
use crate::fleet::state::visits::Visits;
use crate::fleet::state::wait_graph::WaitGraph;
use crate::id::{JobId, RobotId};
use crate::time::Time;
use crate::warehouse::Warehouse;
use std::sync::Arc;

/// What the rooms of a fleet share.
#[derive(Clone, Debug)]
pub(in crate::fleet) struct Core {
    /// The settings.
    pub settings: Settings,
    /// What was promised.
    pub ledger: Ledger,
    /// What is seen.
    pub scene: Scene,
    /// What people, closed areas and displaced robots mean for robots, in this step.
    pub restrictions: Restrictions,
    /// What robots and workers wait for, as of the end of the last step.
    pub waits: WaitGraph,
    /// What robots are at, as of the end of the last step.
    pub activities: Activities,
    /// How near robots of each kind come to people, and how fast.
    pub regions: KindRegions,
    /// What the map says about storage.
    pub storage: Storage,
    /// What is kept in mind about visits at work cells.
    pub visits: Visits,
    /// The robot arms at work cells.
    pub arms: Arms,
    /// What the step gives out so far.
    pub out: Step,
    /// The robot that is being dealt with: named where a contradiction ends the step.
    pub at_hand: AtHand,
}

impl Core {
    /// What a ledger says, with nothing seen yet.
    pub fn new(ledger: Ledger, settings: Settings) -> Core {
        let warehouse = ledger.warehouse();
        let regions = KindRegions::new(warehouse, &settings);
        Core {
            restrictions: Restrictions::none(warehouse, &regions),
            waits: WaitGraph::default(),
            activities: Activities::default(),
            regions,
            storage: Storage::new(warehouse),
            scene: Scene::default(),
            visits: Visits::new(settings.flow.counts_lines()),
            arms: Arms::new(warehouse),
            out: Step::default(),
            at_hand: AtHand::default(),
            ledger,
            settings,
        }
    }

    /// The floor as it is now, for questions.
    pub fn floor(&self) -> Floor<'_> {
        let Core {
            settings,
            ledger,
            scene,
            restrictions,
            waits,
            regions,
            storage,
            visits,
            arms,
            at_hand,
            ..
        } = self;
        Floor { ledger, scene, settings, restrictions, waits, regions, storage, visits, arms, at_hand }
    }

    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        self.ledger.warehouse()
    }

    /// Takes a fact into the ledger and into the step's result.
    pub fn record(&mut self, fact: impl Into<Fact>) {
        let fact = fact.into();
        if let Some(robot) = fact.robot() {
            self.at_hand.note(robot);
        }
        self.visits.note(&self.ledger, &fact);
        self.ledger.evolve(&fact);
        self.out.facts.push(fact);
    }

    /// A job comes to another state, and its robot to another task with it.
    pub fn progress(&mut self, job: JobId, state: JobState, tasked: Option<(RobotId, Task)>, now: Time) {
        self.record(JobFact::Progressed { job, state, tasked, at: now });
    }
}

//! What the parts of the core share, for code that changes it in a step: what was promised, what is seen, what
//! restricts robots now, and the output of the step.
//!
//! Main type: [`Writer`]. What was promised changes by facts alone, and the output is only ever added to. Queries take
//! a [`Floor`], through which nothing can be changed. Refuses: to keep anything that belongs to one part alone.

use crate::state::activity::Activities;
use crate::state::arms::Arms;
use crate::state::at_hand::AtHand;
use crate::state::fact::{Fact, FloorFact, JobFact, Task};
use crate::state::floor::Floor;
use crate::state::io::{CausedFacts, CellWarning, Command, Step};
use crate::state::job::JobState;
use crate::state::ledger::Ledger;
use crate::state::link::{LinkReach, LinkState};
use crate::state::regions::KindRegions;
use crate::state::request::{Answered, Reply, Token};
use crate::state::restrictions::Restrictions;
use crate::state::scene::Scene;
use crate::state::settings::Settings;
use crate::state::storage::Storage;
use crate::state::visits::Visits;
use crate::state::wait_graph::WaitGraph;
use crate::state::worker::Guidance;
use giveway_cell::arm::ArmOrder;
use giveway_floor::id::{ClosureId, JobId, RobotId, WorkerId};
use giveway_floor::route::Conditions;
use giveway_floor::text::sentence::links;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use std::ops::Range;
use std::sync::Arc;

/// What the parts of the core share, with the right to change it.
#[derive(Clone, Debug)]
pub struct Writer {
    /// The settings.
    pub settings: Settings,
    /// What was promised.
    ledger: Ledger,
    /// What is seen.
    pub scene: Scene,
    /// How people, closed areas and displaced robots restrict robots in this step.
    pub restrictions: Restrictions,
    /// What robots and workers wait for, as of the end of the last step.
    pub waits: WaitGraph,
    /// What robots are doing, as of the end of the last step.
    pub activities: Activities,
    /// How near robots of each kind come to people, and how fast they drive there.
    pub regions: KindRegions,
    /// What the map says about storage.
    pub storage: Storage,
    /// What is remembered about visits at work cells.
    pub visits: Visits,
    /// The robot arms at work cells.
    pub arms: Arms,
    /// The output of the step so far.
    out: Step,
    /// The robot that is being dealt with, to be named if a contradiction ends the step.
    pub at_hand: AtHand,
}

impl Writer {
    /// A writer for a ledger, with nothing seen yet.
    pub fn new(ledger: Ledger, settings: Settings) -> Writer {
        let warehouse = ledger.warehouse();
        let regions = KindRegions::new(warehouse, ledger.kinds(), settings.period);
        Writer {
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

    /// Notes robots whose link the site no longer has as not connected: no link will ever report that.
    pub fn cut_off_unlinked(&mut self) {
        let is_unlinked = |link: &String| !self.settings.links.contains(link);
        let robots = self.ledger.robots.pairs().filter(|(_, r)| is_unlinked(&r.link));
        let unlinked: Vec<(RobotId, String)> = robots.map(|(robot, r)| (robot, r.link.clone())).collect();
        for (robot, link) in unlinked {
            let refuses = Some(links::no_such_link(link));
            self.scene.hear_link(
                robot,
                LinkState { reach: LinkReach::Lost, refuses, ..LinkState::default() },
                Time::ZERO,
            );
        }
    }

    /// The floor as it is now, for queries.
    pub fn floor(&self) -> Floor<'_> {
        let Writer {
            settings, ledger, scene, restrictions, waits, regions, storage, visits, at_hand, ..
        } = self;
        Floor { ledger, scene, settings, restrictions, waits, regions, storage, visits, at_hand }
    }

    /// What was promised.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Has the queue of waiting jobs go by this time from now on.
    pub fn advance_queue(&mut self, now: Time) {
        self.ledger.advance_queue(now);
    }

    /// The ledger, and what is remembered about visits, which may change meanwhile.
    pub fn ledger_and_visits(&mut self) -> (&Ledger, &mut Visits) {
        (&self.ledger, &mut self.visits)
    }

    /// Forgets what restricted robots in the step before, except announced closures, which begin and end. Returns the
    /// closures that ended long ago.
    pub fn renew_restrictions(&mut self, now: Time) -> Vec<ClosureId> {
        let Restrictions { conditions, areas, .. } = &mut self.restrictions;
        conditions.all_mut().for_each(Conditions::clear);
        let (closures, changes) = (&self.ledger.closures, self.ledger.index().closure_changes());
        areas.update(closures, changes, conditions, self.ledger.warehouse(), now);
        areas.forgotten(closures, now)
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
        if matches!(fact, Fact::Floor(FloorFact::KindPut { .. } | FloorFact::KindRemoved { .. })) {
            self.refit();
        }
        self.out.facts.push(fact);
    }

    /// Rebuilds what follows from the robot kinds, after they have changed.
    fn refit(&mut self) {
        let warehouse = self.ledger.warehouse();
        self.regions = KindRegions::new(warehouse, self.ledger.kinds(), self.settings.period);
        self.restrictions.refit(warehouse, &self.regions);
    }

    /// What happened in this step so far, in order.
    pub fn facts(&self) -> &[Fact] {
        &self.out.facts
    }

    /// Gives an order to a robot. It leaves once the facts are durable.
    pub fn send(&mut self, robot: RobotId, command: Command) {
        self.out.commands.push((robot, command));
    }

    /// Gives a robot an order that takes no hold from any robot. It leaves at once.
    pub fn tell_at_once(&mut self, robot: RobotId, command: Command) {
        self.out.urgent.push((robot, command));
    }

    /// Keeps from a robot every order that has not left yet.
    pub fn hold_back(&mut self, robot: RobotId) {
        self.out.held_back.push(robot);
    }

    /// Answers a request, and notes which facts it caused directly. The answer leaves once these are durable.
    pub fn answer(&mut self, token: Token, answer: Answered, caused: Range<usize>) {
        assert!(caused.end <= self.out.facts.len(), "a request caused facts that are there");
        self.out.replies.push(Reply { token, answer });
        if !caused.is_empty() {
            self.out.caused.push(CausedFacts { token, facts: caused });
        }
    }

    /// Gives guidance to workers. It leaves at once.
    pub fn guide(&mut self, guidance: Vec<(WorkerId, Guidance)>) {
        self.out.guidance.extend(guidance);
    }

    /// Warns a person at a work cell. It leaves at once.
    pub fn warn(&mut self, warning: CellWarning) {
        self.out.warnings.push(warning);
    }

    /// Gives robot arms trajectories. They leave at once.
    pub fn move_arm(&mut self, order: impl IntoIterator<Item = ArmOrder>) {
        self.out.arms.extend(order);
    }

    /// Ends the step and returns its output.
    pub fn take_step(&mut self) -> Step {
        std::mem::take(&mut self.out)
    }

    /// Changes the state of a job and, with it, the task of its robot.
    pub fn progress(&mut self, job: JobId, state: JobState, tasked: Option<(RobotId, Task)>, now: Time) {
        self.record(JobFact::Progressed { job, state, tasked, at: now });
    }
}

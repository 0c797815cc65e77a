//! The core: one pure state machine. `step(now, inputs)` takes everything in, then decides once.
//!
//! Main types: [`Fleet`], [`Settings`], [`Input`], [`Step`], [`View`]. Two halves of state: the [`Ledger`] (what was
//! promised, a fold over facts) and the [`state::scene`] (what is seen). A restart is a step with an empty scene.
//! Refuses: clocks, I/O, random numbers, hash order; reacting to messages (it reacts to state, so repeated and
//! late ones do no harm).

pub mod alarm;
pub mod carry;
mod dispatch;
pub mod history;
#[doc(hidden)]
pub mod internals;
mod people;
pub mod read;
mod requests;
pub mod state;
mod traffic;
mod waits;
mod yielding;

pub use dispatch::chains::{CHAIN_BEHIND_MS, chain_saves_ms};
pub use giveway_people::aware::zone_answers::ZoneCounts;
pub use people::forecast::{AHEAD_S, Expected};
pub use people::foreseen::ForeseenPerson;
pub use people::message::{MESSAGE, STANDOFF, replaces};
pub use read::area::Area;
pub use read::backlog::{Backlog, Pending};
pub use read::closing::{Affected, ClosingEffect, NAMED};
pub use read::events::{EventKind, EventQuery, EventRow, EventSpan, FloorEvent, floor_event};
pub use read::occupancy::{MOST_NODES, NodeOccupancy};
pub use read::robot_events::{
    RobotChange, RobotEventQuery, RobotEventRow, RobotEventSource, RobotJobCounts, robot_change,
};
pub use read::rows::{
    AssignmentQuery, AssignmentRow, EncounterQuery, EncounterRow, GoneNames, JOB_STATES, JobQuery, JobRow,
    JobTimes, Listed,
};
pub use read::safety_regions::{RegionStay, SafetyRegion};
pub use read::shift::{EndedJob, ShiftRows};
pub use read::unsettled::Unsettled;
pub use read::untrue::untrue;
pub use read::view::{Counts, JobWhy, JobsAhead, RobotState, RobotView, StationView, View, ViewBuilding};
pub use read::why::{Because, LostWorker, Standstill, Waiting, Who};
pub use state::activity::{Activity, Doing};
pub use state::arms::ArmView;
pub use state::displaced::{Displaced, Displacement, OFF_ROUTE_M};
pub use state::fact::{
    Act, AreaFact, AssignmentFact, Booking, EncounterFact, Fact, FloorFact, JobFact, KeptRoute, Moved,
    Purpose, RobotFact, RouteFact, Stop, Task, WorkerFact,
};
pub use state::fault::Fault;
pub use state::io::{CausedFacts, CellWarning, Command, Input, Step, Telemetry, Waypoint, WrongReach};
pub use state::job::{Job, JobChange, JobFailure, JobRequest, JobState, RobotChoice, Visiting};
pub use state::job_kind::{JobField, JobKind, JobParts, JobWord};
pub use state::keys::{ClientKey, KEY_LIFE, Keys};
pub use state::kind::{Capabilities, Charging, ObeyedLimits, RobotKind, USUAL_KIND, fitted, most_dangerous};
pub use state::kinds::RobotKinds;
pub use state::ledger::{Contradiction, Ledger, Parts, Promises, RackAt, Robot, Service, Sums, Unconfirmed};
pub use state::link::{LinkReach, LinkState, USUAL_LINK};
pub use state::local_clock::LocalClock;
pub use state::note::{EventDetails, FloorNote, ReplanCause};
pub use state::passing::Passing;
pub use state::recurring::{MOST_OFTEN, Recurrence, RecurringClosure, Weekdays};
pub use state::refusal::{
    AreaRefusal, Bounded, JobRefusal, KindRefusal, PickRefusal, RackRefusal, Refusal, RobotRefusal,
    WorkerRefusal,
};
pub use state::request::{
    Answer, Answered, Ask, Asker, FloorAction, JobAction, JobTaken, LineNoted, Made, Reply, Request,
    RobotAction, StationOrder, Token, WorkerAction,
};
pub use state::scene::SILENCE;
pub use state::settings::{FloorLimits, Settings};
pub use state::visits::EndsHeld;
pub use state::wait_graph::{ChainEnd, Edge, Party, Wait};
pub use state::why::Why;
pub use state::wishes::Wishes;
pub use state::worker::{
    Assignment, AssignmentRequest, AssignmentState, Binds, Closure, ClosureState, ClosureView, Encounter,
    FeedCounts, Guidance, GuidanceReason, GuidanceState, LastPlace, NearRobot, Presence, Reaction,
    WorkerEpisode, WorkerView,
};
pub use traffic::state::InsertionCounts;

use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use people::state::HumanState;
use state::floor::Floor;
use state::heard::WorkerInput;
use state::restrictions::FoundRestrictions;
use state::writer::Writer;
use std::sync::Arc;
use traffic::state::{Effort, Traffic};
use traffic::{closures, displaced, failure, fence};
use waits::replans::Replans;
use yielding::state::Yielding;

/// The fleet: the whole state of the core.
#[derive(Clone)]
pub struct Fleet {
    writer: Writer,
    people: HumanState,
    yielding: Yielding,
    traffic: Traffic,
    /// Which robots were rerouted, and because of what.
    replans: Replans,
    /// How long the last step took to note why robots and people wait, nanoseconds by the stopwatch of the settings.
    waits_ns: u64,
}

impl Fleet {
    /// An empty fleet in a building.
    pub fn new(warehouse: Arc<Warehouse>, settings: Settings) -> Fleet {
        Fleet::restore(warehouse, settings, [])
    }

    /// Restores the fleet from these facts, with nothing seen yet.
    ///
    /// # Panics
    /// If the facts contradict each other.
    pub fn restore(
        warehouse: Arc<Warehouse>,
        settings: Settings,
        facts: impl IntoIterator<Item = Fact>,
    ) -> Fleet {
        let ledger = Ledger::new(warehouse, &settings.site_kinds, settings.without_conflicts);
        Fleet::resume(ledger, settings, facts)
    }

    /// Resumes the fleet from a ledger and the facts after it, with nothing seen yet.
    ///
    /// # Panics
    /// If the facts contradict the ledger or each other.
    pub fn resume(mut ledger: Ledger, settings: Settings, facts: impl IntoIterator<Item = Fact>) -> Fleet {
        facts.into_iter().for_each(|fact| ledger.evolve(&fact));
        let warehouse = ledger.warehouse().clone();
        let writer = Writer::new(ledger, settings);
        let mut fleet = Fleet {
            people: HumanState::new(&warehouse, &writer.regions, writer.settings.method),
            yielding: Yielding::default(),
            traffic: Traffic::new(writer.floor()),
            writer,
            replans: Replans::default(),
            waits_ns: 0,
        };
        fleet.people.remember(fleet.writer.ledger());
        fleet.writer.cut_off_unlinked();
        // Before the first step, queries answer from the facts alone: paused robots are known, poses are not.
        fleet.note_waits(Time::ZERO);
        fleet
    }

    /// Takes over what links said to the fleet that this one replaces in the same process: links say once how they are,
    /// and reports still under way to the old fleet were overtaken long ago. The links of the site still count.
    pub fn keep_links_of(&mut self, before: &Fleet) {
        self.writer.scene.keep_links_of(&before.writer.scene);
        self.writer.cut_off_unlinked();
    }

    fn note_waits(&mut self, now: Time) {
        let start = (self.writer.settings.stopwatch)();
        waits::note_waits(&mut self.writer, &self.people, &self.yielding, &self.traffic, now);
        self.waits_ns = (self.writer.settings.stopwatch)() - start;
    }

    /// Takes all inputs in, then decides once from what is known now.
    pub fn step(&mut self, now: Time, inputs: Vec<Input>) -> Step {
        self.writer.at_hand.clear();
        self.traffic.effort = Effort::of_a_step(self.writer.floor());
        self.note_workplaces(now);
        let lost = self.people.lost(now);
        let kinds = self.writer.ledger().kinds().clone();
        let heard = requests::absorb(&mut self.writer, (&self.people.walkways, &lost), now, inputs);
        if kinds != *self.writer.ledger().kinds() {
            self.refit();
        }
        self.restrict(&heard.people, now);
        self.react(now);
        self.traffic.needs.left_early(heard.left_early);
        let taken_up = self.traffic.note_progress(&mut self.writer, now);
        self.yielding.state.forget_standing(&taken_up);
        traffic::visits::retime_visits(&mut self.writer, now);
        self.dispatch(&heard.picked, now);
        self.plan(now);
        let interrupted = |robot| self.yielding.procedure.holds(robot);
        self.traffic.grant(&mut self.writer, &self.yielding.state, interrupted, now);
        self.note_waits(now);
        waits::note_activities(&mut self.writer, now);
        self.replans.note(&mut self.writer, &self.yielding, &self.traffic, now);
        self.writer.take_step()
    }

    /// Rebuilds what people and traffic keep for each robot kind, after the kinds and with them the building have
    /// changed. What all parts share was rebuilt when the fact was recorded.
    fn refit(&mut self) {
        let Fleet { writer, people, traffic, .. } = self;
        people.refit(writer.floor());
        traffic.refit(writer.floor());
    }

    /// Notes at which stations buttons are pressed (a person may be there whose headset is silent) and, where hands are
    /// tracked, at which stations two people are in the workplace.
    fn note_workplaces(&mut self, now: Time) {
        let Fleet { writer, people, .. } = self;
        people.note_used(writer.visits.used(), now);
        if writer.settings.flow.hears_hands() {
            people.in_company(now).into_iter().for_each(|station| writer.visits.note_company(station, now));
        }
    }

    /// Collects what restricts robots in this step: closed areas, people, displaced robots, obstructions, ways out and
    /// what all of these cut off. Each part says what it finds, and only this function merges it. Also guides workers.
    fn restrict(&mut self, heard: &[WorkerInput], now: Time) {
        let Fleet { writer, people, yielding, traffic, .. } = self;
        closures::renew_areas(writer, now);
        let report = people.evaluate(writer, heard, &yielding.state, now);
        writer.guide(report.guidance);
        let floor = writer.floor();
        let found = FoundRestrictions {
            stood_on: closures::stood_on(floor, people.conditions(), now),
            displaced: displaced::closed_by_displaced(floor, now),
            obstructed: traffic.note_obstructions(floor, now),
            ways_out: traffic.ways_out(floor, &people.ways_out(floor, now), now),
            cut_off: failure::cut_off_anew(floor, now),
            conditions: people.conditions(),
            workers: report.places,
            others: report.others,
            let_pass: report.let_pass,
        };
        writer.restrictions.merge(found);
    }

    /// What robots do at once about these restrictions: they stop, slow down, or forget what they were granted.
    fn react(&mut self, now: Time) {
        let Fleet { writer, people, yielding, traffic, .. } = self;
        if let Some((worker, led)) = yielding.follow_procedure(writer, people, traffic, now) {
            people.lead(worker, led, now);
        }
        yielding.follow_passing(writer, people, now);
        yielding.turn_halfway(writer, people, traffic, now);
        yielding.limit_robots(writer, people, traffic, now);
        yielding.revoke_grants(writer, people, traffic, now);
        traffic.revoke_grants_into_displaced(writer, now);
        traffic.revoke_obstructed(writer, now);
        traffic.revoke_ways_out(writer, now);
        yielding.meet(writer, people, now);
    }

    /// Dispatch: which robot does what.
    fn dispatch(&mut self, picked: &[RobotId], now: Time) {
        let Fleet { writer, traffic, .. } = self;
        // No job begins while the building is evacuated.
        if writer.ledger().evacuation.is_some() {
            return;
        }
        let lapsed = dispatch::jobs::assign(writer, &traffic.needs, &mut traffic.planners, picked, now);
        traffic.lose_places(writer, &lapsed);
    }

    /// Plans routes within the step's budget of expansions: for robots that need one, and better ones for robots that
    /// were interrupted, would drive into a closed area, meet people or wait for others.
    fn plan(&mut self, now: Time) {
        let Fleet { writer, people, yielding, traffic, .. } = self;
        if writer.ledger().evacuation.is_some() {
            return traffic.clear_ways_out(writer, now);
        }
        traffic.plan_needed(writer, now);
        yielding.plan_interrupted(writer, traffic, now);
        traffic.route_round_closures(writer, now);
        traffic.set_down_cut_off(writer, now);
        yielding.give_way(writer, people, traffic, now);
        traffic.improve(writer, now);
    }

    /// The floor as it is now, for queries.
    fn floor(&self) -> Floor<'_> {
        self.writer.floor()
    }

    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        self.writer.warehouse()
    }

    /// The ledger: what was promised.
    pub fn ledger(&self) -> &Ledger {
        self.writer.ledger()
    }

    /// The newest telemetry of a robot.
    pub fn telemetry(&self, robot: RobotId) -> Option<&Telemetry> {
        self.writer.scene.robot(robot)
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.writer.settings
    }

    /// How long the searches since the last call took, nanoseconds by the stopwatch of the settings.
    pub fn take_plan_times(&mut self) -> Vec<u64> {
        std::mem::take(&mut self.traffic.plan_times)
    }

    /// Replans a robot together with the few robots in its way, with the whole budget of a step, as a step does for a
    /// robot that finds no route. Returns whether that worked; the facts leave with those of the next step. Used to
    /// measure how long this takes.
    pub fn plan_jointly(&mut self, robot: RobotId, now: Time) -> bool {
        self.traffic.effort = Effort::of_a_step(self.writer.floor());
        self.traffic.insert(&mut self.writer, robot, now)
    }

    /// How long the last step took to note why robots and people wait, nanoseconds by the stopwatch of the settings.
    pub fn waits_ns(&self) -> u64 {
        self.waits_ns
    }

    /// Whether a node is on the way of a worker to a door while the building is evacuated.
    pub fn is_on_way_out(&self, node: NodeId) -> bool {
        self.writer.restrictions.ways_out.contains(&node)
    }

    /// Whether a robot is on the way of a worker to a door, and so may drive on along it to leave it.
    pub fn leaves_way_out(&self, robot: RobotId) -> bool {
        self.floor().is_on(robot, &self.writer.restrictions.ways_out)
    }

    /// Notes that a call begins in which this robot is being dealt with, or none yet.
    pub fn note_at_hand(&self, robot: Option<RobotId>) {
        self.writer.at_hand.clear();
        robot.into_iter().for_each(|robot| self.writer.at_hand.note(robot));
    }

    /// The robot that was being dealt with when a call ended in a panic, if there was one.
    pub fn at_hand(&self) -> Option<RobotId> {
        self.writer.at_hand.robot()
    }

    /// Fences a robot off. The facts leave with those of the next step.
    ///
    /// # Panics
    /// If even that contradicts the ledger.
    pub fn fence(&mut self, robot: RobotId, now: Time) {
        fence::fence(&mut self.writer, robot, now);
    }

    /// Gives robots no further grants from now on: each drives to the end of what it was granted, and stands on a node
    /// there. This is no fact: a restart forgets it.
    pub fn settle(&mut self) {
        self.traffic.settling = true;
    }

    /// Gives robots grants again, after `settle`.
    pub fn go_on(&mut self) {
        self.traffic.settling = false;
    }
}

//! Queries that drivers of the fleet make between two steps.
//!
//! Refuses: to change anything, and to decide: the next step does that, with everything that it knows.

use crate::Fleet;
use crate::dispatch::enough::stations_with_enough;
use crate::people::forecast::Expected;
use crate::people::foreseen::ForeseenPerson;
use crate::requests::hands::warning_of;
use crate::state::displaced::Displacement;
use crate::state::index::urgency_ms;
use crate::state::io::{CellWarning, Telemetry};
use crate::state::job::{Job, JobRequest};
use crate::state::ledger::RackAt;
use crate::state::link::LinkState;
use crate::state::passing::Passing;
use crate::state::worker::{GuidanceReason, GuidanceState};
use giveway_cell::HandsSeen;
use giveway_floor::geometry::Point;
use giveway_floor::id::{JobId, NodeId, RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Hull;
use giveway_people::human::Sighting;
use giveway_people::human::motion::MotionEstimate;
use std::collections::BTreeSet;

/// Robots are told of people within this distance, metres.
const TOLD_M: f64 = 12.0;

impl Fleet {
    /// Whether a robot stands where the ledger has it, and carries what the ledger says.
    pub fn is_in_place(&self, seen: &Telemetry) -> bool {
        self.floor().is_in_place(seen)
    }

    /// Why a robot cannot go on from where it stands, if that is so.
    pub fn displacement(&self, robot: RobotId) -> Option<Displacement> {
        self.floor().displacement(robot)
    }

    /// Whether a hand is seen in the opening of a station or in the rack there.
    pub fn sees_hand_inside(&self, station: StationId, now: Time) -> bool {
        self.writer.visits.sees_inside(station, now)
    }

    /// Whether a robot stands at its station and the pick has not ended.
    pub fn is_picked_from(&self, robot: RobotId) -> bool {
        self.writer.ledger().is_picked_from(robot)
    }

    /// Whether a robot was heard of lately, can drive and takes orders.
    pub fn is_fit(&self, robot: RobotId, now: Time) -> bool {
        self.writer.scene.fit(robot, now).is_some()
    }

    /// The node at which a robot of a kind that was found at a place can join: the nearest one that is free. Nothing if
    /// the place is not on the floor.
    pub fn place_to_join(&self, kind: &str, at: Point) -> Option<NodeId> {
        self.writer.floor().place_to_join(kind, at)
    }

    /// The state of a robot at its link; nothing if it is as usual.
    pub fn link_state(&self, robot: RobotId) -> Option<&LinkState> {
        self.writer.scene.link(robot)
    }

    /// Whether a robot has no route for its task.
    pub fn lacks_route(&self, robot: RobotId) -> bool {
        self.floor().lacks_route(robot)
    }

    /// Whether it is known where a worker is.
    pub fn knows_place_of(&self, worker: WorkerId, now: Time) -> bool {
        self.people.whereabouts(worker, now).is_some()
    }

    /// How urgent a job for a rack is, milliseconds: the order in which robots are matched with jobs.
    pub fn urgency_ms(&self, job: &Job, now: Time) -> i64 {
        let JobRequest { priority, deadline, .. } = job.request;
        let oldest = self.writer.ledger().index().queue.oldest(now)[usize::from(priority)];
        urgency_ms(priority, job.accepted, deadline, now, oldest)
    }

    /// Stations for which no more racks are fetched: enough robots with racks wait for the station, or it is paused, or
    /// a robot that cannot drive has blocked it for long.
    pub fn full_stations(&self, now: Time) -> BTreeSet<StationId> {
        stations_with_enough(self.floor(), &self.traffic.needs, now)
    }

    /// Whether a robot may do a job as far as operators and its kind are concerned.
    pub fn is_allowed_for(&self, robot: RobotId, job: &Job, now: Time) -> bool {
        self.floor().is_allowed(robot, job, now)
    }

    /// Whether a robot that has nothing else to do could do a job whose rack stands in storage.
    pub fn could_do(&self, robot: RobotId, id: JobId, now: Time) -> bool {
        let (floor, job) = (self.floor(), &self.writer.ledger().jobs[&id]);
        let Some(rack) = job.request.kind.rack() else { return false };
        let RackAt::Stored(node) = self.writer.ledger().racks[rack] else { return false };
        let from = self.writer.ledger().node_of(robot);
        !floor.job_is_closed_off(&job.request.kind, node)
            && floor.way_ms((robot, from), id, (rack, node), now).is_some()
    }

    /// Robots for which a route could be searched, but whose search was put off because each step has searched as much
    /// as it may; the longest waiting first, each with for how long.
    pub fn plan_queue(&self, now: Time) -> Vec<(RobotId, Span)> {
        let postponed = self.traffic.needs.postponed.iter();
        let mut queue: Vec<_> = postponed.map(|(r, since)| (*r, now - *since)).collect();
        queue.sort_by_key(|(r, waited)| (std::cmp::Reverse(*waited), *r));
        queue
    }

    /// Where workers who are seen may be in the coming seconds, for display. Policies that do not decide by such
    /// forecasts have none.
    pub fn expectations(&self, now: Time) -> Vec<Expected> {
        self.people.expectations(self.floor(), now)
    }

    /// What robots at these places are told of the people near them: where the people are and will be, as the fleet
    /// believes.
    pub fn people_near(&self, robots: &[(RobotId, Point)], now: Time) -> Vec<(RobotId, Vec<ForeseenPerson>)> {
        let near = |at| self.people.foreseen(self.floor(), at, TOLD_M, now);
        robots.iter().map(|(robot, at)| (*robot, near(*at))).collect()
    }

    /// What a worker is told now, besides the path, and since when; nothing if the worker is not on the floor.
    pub fn message(&self, worker: WorkerId) -> Option<(GuidanceState, Option<GuidanceReason>, Time)> {
        let message = self.people.people.get(worker)?.message?;
        Some((message.words.0, message.words.1, message.since))
    }

    /// The passing of a worker beside the line that a robot is doing, if any.
    pub fn passing(&self, robot: RobotId) -> Option<Passing> {
        self.yielding.state.of(robot).passing.map(|p| p.what)
    }

    /// What a robot that passes a person may take of the floor: the corridor from where the robot was last on a node to
    /// where it is on the line again.
    pub fn passing_floor(&self, robot: RobotId) -> Option<Hull> {
        let what = self.passing(robot)?;
        let stretch = self.floor().stretch(robot, self.writer.ledger().chain(robot).first(), what.to)?;
        Some(self.floor().footprint(robot).free(stretch.line, stretch.corridor))
    }

    /// What is known of how each worker moves, at the newest pose that was taken in.
    pub fn motion_estimates(&self) -> impl Iterator<Item = (WorkerId, MotionEstimate)> {
        let people = self.people.people.pairs();
        people.filter_map(|(worker, p)| Some((worker, p.motion.as_ref()?.estimate()?)))
    }

    /// Whether a step that took in this sighting now would, as things were last seen, stop a robot that drives, or tell
    /// the worker to stand, unless the worker was already told.
    pub fn calls_for_stop(&self, sighting: &Sighting, now: Time) -> bool {
        self.yielding.calls_for_stop(self.writer.floor(), &self.people, &self.traffic, sighting, now)
    }

    /// What a step would warn of if it took in these hands now.
    pub fn warning_of(&self, seen: &HandsSeen, now: Time) -> Option<CellWarning> {
        warning_of(self.writer.floor(), seen, now)
    }
}

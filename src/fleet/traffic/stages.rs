//! The legs that tasks ask for, and the bookings of routes over them.
//!
//! Refuses: to search for routes.

use crate::state::fact::{Act, Booking, RouteFact, Stop, Task};
use crate::state::floor::Floor;
use crate::state::job_kind::JobKind;
use crate::state::writer::Writer;
use giveway_floor::geometry::Segment;
use giveway_floor::id::{JobId, NodeId, RobotId};
use giveway_floor::route::{Route, Stage};
use giveway_floor::time::Span;
use giveway_floor::timeline::Visit;
use giveway_floor::warehouse::NodeKind;
use smallvec::{SmallVec, smallvec};

impl Floor<'_> {
    /// The legs that the rest of a robot's task asks for.
    pub(crate) fn stages(&self, robot: RobotId) -> SmallVec<[Stage; 3]> {
        let lift = self.kinematics(robot).lift;
        let leg = |goal, loaded, stay| Stage { goal, loaded, lifts: false, stay };
        match self.ledger.robots[robot].task {
            Task::Idle => smallvec![],
            Task::Fetch { node, .. } => smallvec![Stage { lifts: true, ..leg(node, false, lift) }],
            Task::Deliver { station, store, job, .. } => {
                smallvec![leg(station, true, self.pick_span(station, job)), leg(store, true, lift)]
            }
            Task::Store { store, .. } => smallvec![leg(store, true, lift)],
            Task::Move { goal, stay, .. } if goal == stay => smallvec![leg(goal, false, Span::ZERO)],
            Task::Move { goal, stay, .. } => {
                smallvec![leg(goal, false, Span::ZERO), leg(stay, false, Span::ZERO)]
            }
        }
    }

    fn pick_span(&self, station: NodeId, job: JobId) -> Span {
        let NodeKind::Station(id) = self.warehouse().nodes[station].kind else { return Span::ZERO };
        let (usual, record) = (self.warehouse().stations[id].pick, self.ledger.jobs.get(&job));
        // At a work cell, the order lines say how long the pick takes.
        let counts = self.settings.flow.counts_lines();
        if let Some(stay) = record.filter(|_| counts).and_then(|record| self.visits.stay(record)) {
            return stay;
        }
        match record.map(|j| j.request.kind) {
            Some(JobKind::Deliver { pick: Some(pick), .. }) => pick,
            _ => usual,
        }
    }

    /// What the robot does at the goal of each stage.
    fn acts(&self, robot: RobotId, stages: &[Stage]) -> SmallVec<[Act; 3]> {
        match self.ledger.robots[robot].task {
            Task::Idle => smallvec![],
            Task::Fetch { rack, .. } => smallvec![Act::Lift(rack)],
            Task::Deliver { rack, .. } if stages.len() < 2 => smallvec![Act::Set(rack)],
            Task::Deliver { rack, .. } => smallvec![Act::Pick(stages[0].stay), Act::Set(rack)],
            Task::Store { rack, .. } => smallvec![Act::Set(rack)],
            Task::Move { .. } => stages.iter().map(|_| Act::Arrive).collect(),
        }
    }

    /// The last granted visit, and the robot's heading on arrival there.
    pub(crate) fn grant_end(&self, robot: RobotId) -> (Visit, f64) {
        let chain = self.ledger.chain(robot);
        let serial = chain.granted() - 1;
        let visit = chain.get(serial).expect("the last granted visit is still held").clone();
        let at = |n: NodeId| self.warehouse().nodes[n].at;
        let before = serial.checked_sub(1).and_then(|s| chain.get(s)).filter(|b| b.node != visit.node);
        let seen = self.scene.robot(robot).map_or(0.0, |t| t.pose.heading);
        let heading = before.map_or(seen, |b| Segment { a: at(b.node), b: at(visit.node) }.heading());
        (visit, heading)
    }

    /// The booking of a route. A stop where the robot already stands becomes a visit of its own.
    pub(crate) fn booking(&self, robot: RobotId, route: Route) -> Booking {
        let keep = self.ledger.chain(robot).granted() - 1;
        let Route { mut kept, mut visits, stops, .. } = route;
        let here = stops.contains(&0);
        if here {
            let again = Visit { lane: None, arrive: kept.arrive.max(kept.enter), ..kept.clone() };
            // The robot leaves the first visit for the second at the same place: a delay of the first must not hold the
            // place longer than the second does.
            let gone = (again.arrive + self.ledger.timeline().clearance()).min(again.leave);
            (kept.depart, kept.leave, kept.stay) = (again.arrive, gone, Span::ZERO);
            visits.insert(0, again);
        }
        let last = visits.last().unwrap_or(&kept);
        let lasts = last.leave.is_forever() && self.warehouse().kind(last.node).is_lasting();
        assert!(lasts, "a route of {robot:?} ends where it may not stay for ever: {last:?}");
        assert_eq!(
            kept.node,
            self.grant_end(robot).0.node,
            "a route of {robot:?} begins where its grant ends"
        );
        let acts = self.acts(robot, &self.stages_left(robot));
        let serials = stops.iter().map(|s| keep + (s + usize::from(here)) as u64);
        let stops = serials.zip(acts).map(|(serial, act)| Stop { serial, act }).collect();
        Booking { robot, keep, kept, visits, stops }
    }

    /// The legs of a robot's task that are still ahead, given the stops that it has done.
    pub(crate) fn stages_left(&self, robot: RobotId) -> SmallVec<[Stage; 3]> {
        let mut stages = self.stages(robot);
        let left = self.ledger.robots[robot].stops.len();
        if !self.lacks_route(robot) && left < stages.len() {
            stages.drain(..stages.len() - left);
        }
        stages
    }

    /// The legs to a place aside and then of the rest of the task. A robot that waits for room comes back to where it
    /// stands; nothing if it may not stay there.
    pub(crate) fn stages_aside(&self, robot: RobotId, place: NodeId) -> Option<SmallVec<[Stage; 4]>> {
        let rest = self.stages_after(robot);
        let loaded = self.ledger.rack_on(robot).is_some();
        let leg = |goal| Stage { loaded, ..Stage::to_stay(goal) };
        let mut stages = smallvec![leg(place)];
        if rest.is_empty() {
            let here = self.ledger.chain(robot).last().expect("it stands somewhere").node;
            if !self.warehouse().kind(here).is_lasting() {
                return None;
            }
            stages.push(leg(here));
        }
        stages.extend(rest);
        Some(stages)
    }

    /// The legs that a robot goes on with after it has stepped aside.
    fn stages_after(&self, robot: RobotId) -> SmallVec<[Stage; 3]> {
        if self.waits_for_room(robot) { SmallVec::new() } else { self.stages_left(robot) }
    }

    /// A route over `stages_aside` with only the stops of the task: the robot does nothing at the place aside.
    pub(crate) fn with_own_stops(&self, robot: RobotId, mut route: Route) -> Route {
        route.stops.remove(0);
        if self.stages_after(robot).is_empty() {
            route.stops.clear();
        }
        route
    }
}

/// Books a route.
pub(super) fn commit(writer: &mut Writer, robot: RobotId, route: Route) {
    let booking = writer.floor().booking(robot, route);
    writer.record(RouteFact::Routed { bookings: vec![booking] });
}

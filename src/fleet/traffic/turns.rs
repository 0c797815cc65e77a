//! Places at stations and chargers that lapse, and robots that wait for one where they may not stay.
//!
//! A place is promised with a route. If the robot cannot drive on, and nothing says that it will, the place would stay
//! empty while others wait with their racks. So the promise lapses: the robot keeps its rack, its task and its ticket,
//! and gets a place again as soon as the robots that could go have gone. Refuses: to take a place from a robot that
//! stands in the queue or drives.

use crate::state::floor::Floor;
use crate::state::writer::Writer;
use crate::traffic::state::Traffic;
use crate::traffic::truncate::truncate_behind;
use giveway_floor::id::{RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;
use std::collections::BTreeSet;

/// A robot that waits for its turn where it may not stay searches for a place to stay this often.
const AGAIN: Span = Span::from_millis(6400);

impl Traffic {
    /// Takes places at stations from robots that have no prospect of getting there, if other robots wait for one.
    pub(super) fn lapse_places(&mut self, writer: &mut Writer, now: Time) {
        let floor = writer.floor();
        let waits =
            |r: RobotId| floor.lacks_route(r) && !floor.is_halted(r) && floor.scene.fit(r, now).is_some();
        let wanted: BTreeSet<StationId> =
            self.needs.tickets.all().filter(|(r, _)| waits(*r)).map(|(_, ticket)| ticket.station).collect();
        if wanted.is_empty() {
            return;
        }
        let lapsed = |(r, _): &(RobotId, _)| floor.lies_still_outside(*r, now);
        let tickets = self.needs.tickets.all().filter(|(_, ticket)| wanted.contains(&ticket.station));
        let lapsed: Vec<RobotId> = tickets.filter(lapsed).map(|(r, _)| r).collect();
        for robot in lapsed {
            tracing::debug!(?robot, "its place at the station lapses");
            self.needs.tickets.lapse(robot, now);
            truncate_behind(writer, robot);
            debug_assert!(
                writer.floor().lacks_route(robot),
                "{robot:?} keeps the way to the place that it lost"
            );
        }
    }

    /// Takes from these robots the places that they were promised at chargers, and the routes there.
    pub(crate) fn lose_places(&mut self, writer: &mut Writer, robots: &[RobotId]) {
        robots.iter().for_each(|robot| truncate_behind(writer, *robot));
    }

    /// If a robot whose turn has not come has lost its route and stands where it may not stay, it leaves for a place to
    /// stay, where it is in no robot's way.
    pub(super) fn wait_for_turn(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        let need = self.needs.waiting.get_mut(&robot).expect("it is in need");
        need.fails_since = None;
        let here = writer.warehouse().kind(writer.ledger().node_of(robot));
        let may_stay = here.is_lasting() || matches!(here, NodeKind::Station(_));
        if !may_stay && writer.floor().rests(robot) {
            need.next_try = now + AGAIN;
            self.step_out(writer, robot, None, now);
        }
    }
}

impl Floor<'_> {
    /// Whether a robot has a route to its station, is not in the queue yet, and has no prospect of getting there.
    fn lies_still_outside(&self, robot: RobotId, now: Time) -> bool {
        let has_route = !self.ledger.robots[robot].failed && !self.lacks_route(robot);
        has_route && !self.is_in_line(robot) && self.has_no_prospect(robot, now)
    }

    fn is_in_line(&self, robot: RobotId) -> bool {
        let here = self.warehouse().kind(self.ledger.node_of(robot));
        matches!(here, NodeKind::Queue(_) | NodeKind::Station(_))
    }
}

//! Which robots gave way to which workers, and which robots met which workers.
//!
//! Refuses: to react; it only records.

use crate::people::state::HumanState;
use crate::state::fact::EncounterFact;
use crate::state::floor::Floor;
use crate::state::worker::{Encounter, Reaction};
use crate::state::writer::Writer;
use crate::state::yielding::GivesWay;
use crate::yielding::state::{EncounterCost, Yielding};
use giveway_floor::geometry::to_mm;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::{Meeting, Near};
use giveway_people::human::Presence;
use std::collections::BTreeMap;

/// Up to this distance a robot and a worker are looked at together, metres.
const NEAR_M: f64 = 4.0;

impl Yielding {
    /// Notes that a robot gives way to a worker, once until it is on its way again.
    pub(crate) fn gives_way(
        &mut self,
        writer: &mut Writer,
        robot: RobotId,
        worker: WorkerId,
        reaction: Reaction,
        now: Time,
    ) {
        debug_assert!(reaction != Reaction::Kept, "{robot:?} gives way and keeps on");
        debug_assert!(writer.ledger().workers.get(worker).is_some(), "{robot:?} gives way to nobody");
        let before = self.state.of(robot).to;
        let since = before.map_or(now, |y| y.since);
        self.state.of_mut(robot).to = Some(GivesWay { worker, reaction, since });
        if before.is_none() {
            writer.record(EncounterFact::Interrupted { robot, worker, reaction, at: now });
        }
    }

    /// Records encounters, as far as they are seen.
    pub(crate) fn meet(&mut self, writer: &mut Writer, people: &HumanState, now: Time) {
        let mut near = Vec::new();
        for (worker, w) in people.among_robots(now) {
            for robot in writer.ledger().present() {
                let Some(seen) = writer.scene.robot(robot) else { continue };
                let distance_m = (seen.pose.at - w.at).norm();
                if distance_m > w.mover.far_m(NEAR_M) || w.presence == Presence::Lost {
                    continue;
                }
                let loaded = writer.ledger().rack_on(robot).is_some();
                let radius_m = writer.floor().regions(robot).towards(&w).stop_radius_m(loaded, 0.0);
                let (robot_mps, worker_mps) = (seen.speed_mps, w.velocity.norm());
                let (at, robot_at) = (w.at, seen.pose.at);
                near.push(Near { worker, robot, at, robot_at, radius_m, distance_m, robot_mps, worker_mps });
            }
        }
        let over = self.meter.observe(now, &near);
        for pair in self.meter.open().map(Meeting::pair).chain(over.iter().map(Meeting::pair)) {
            note_cost(&mut self.costs, writer.floor(), pair, now);
        }
        for meeting in over {
            let start = meeting.start;
            let cost = self.costs.remove(&meeting.pair());
            debug_assert!(meeting.began <= now, "an encounter ends before it began");
            let yielding = self.state.of(start.robot).to;
            let reaction = yielding.map_or(Reaction::Kept, |y| y.reaction);
            writer.record(EncounterFact::Met(Encounter {
                worker: start.worker,
                robot: start.robot,
                began: meeting.began,
                ended: now,
                at: start.at.into(),
                radius_mm: to_mm(start.radius_m),
                closest_mm: to_mm(meeting.closest_m),
                robot_mmps: to_mm(start.robot_mps),
                worker_mmps: to_mm(start.worker_mps),
                reaction,
                delay: cost.map_or(Span::ZERO, |cost| cost.delay()),
            }));
        }
    }
}

/// Notes when the task that a robot had when it met a worker is to end now. While the robot has no route, the task ends
/// no earlier than it was to end before, and not before now.
fn note_cost(
    costs: &mut BTreeMap<(WorkerId, RobotId), EncounterCost>,
    floor: Floor<'_>,
    pair: (WorkerId, RobotId),
    now: Time,
) {
    let robot = &floor.ledger.robots[pair.1];
    let end = floor.ledger.chain(pair.1).visits().last().map_or(now, |v| v.enter).max(now);
    let task = robot.task;
    let cost = costs.entry(pair).or_insert(EncounterCost { task, planned: end, expected: end });
    if cost.task == task {
        cost.expected = if robot.interrupted { cost.expected.max(now) } else { end };
    }
}

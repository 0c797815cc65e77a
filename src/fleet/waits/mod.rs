//! What each robot and each worker waits for, noted once in every step: the wait-for graph; and what each robot is
//! doing.
//!
//! Main functions: [`note_waits`], [`note_activities`]. All that is shown or decided about waiting reads the graph
//! ([`WaitGraph`](crate::state::wait_graph::WaitGraph)), and nothing else finds out why something waits.
//! Refuses: to decide what is done about it.

pub(crate) mod replans;
mod robots;
mod workers;

use crate::people::state::HumanState;
use crate::state::wait_graph::WorkProgress;
use crate::state::writer::Writer;
use crate::traffic::state::Traffic;
use crate::yielding::state::Yielding;
use giveway_floor::time::Time;
use robots::RobotWaits;

/// Notes what all parties wait for, after the grants of a step, and how each chain of waiting ends. O(robots and
/// workers).
pub(crate) fn note_waits(
    writer: &mut Writer,
    people: &HumanState,
    yielding: &Yielding,
    traffic: &Traffic,
    now: Time,
) {
    let mut graph = std::mem::take(&mut writer.waits);
    let floor = writer.floor();
    let waits = RobotWaits::new(floor, yielding, traffic, now);
    for robot in floor.ledger.robots.ids() {
        let why = waits.why(robot);
        let edge = waits.edge(robot, why);
        debug_assert!(edge.robot() != Some(robot), "{robot:?} waits for itself: {why:?}");
        let progress = WorkProgress {
            visit: floor.ledger.chain(robot).first(),
            acted: floor.ledger.robots[robot].acted,
        };
        graph.note_robot(robot, progress, (why, edge), now);
    }
    for worker in people.people.ids() {
        let at = people.whereabouts(worker, now).map(|place| place.at);
        graph.note_worker(worker, at, people.edge(worker, now), now);
    }
    graph.find_ends(now);
    writer.waits = graph;
}

/// Notes what each robot is doing, after [`note_waits`]. O(robots).
pub(crate) fn note_activities(writer: &mut Writer, now: Time) {
    let mut activities = std::mem::take(&mut writer.activities);
    for robot in writer.ledger().robots.ids() {
        let why = writer.waits.robot(robot).why;
        activities.note(robot, writer.floor().activity(robot, why), now);
    }
    writer.activities = activities;
}

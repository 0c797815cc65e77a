//! Where robots in maintenance go, and robots that are to leave.
//!
//! Refuses: to say which robots these are; operators do.

use crate::state::fact::{Purpose, RobotFact, Task};
use crate::state::job::JobState;
use crate::state::ledger::Service;
use crate::state::writer::Writer;
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;

/// Has robots in maintenance give back jobs that they have not begun, and go to a parking place. If none is free, they
/// rest where they are.
pub(crate) fn send_to_maintenance(writer: &mut Writer, now: Time) {
    for robot in writer.ledger().present() {
        let record = &writer.ledger().robots[robot];
        if record.service == Service::Works || record.failed || writer.floor().is_halted(robot) {
            continue;
        }
        if writer.scene.fit(robot, now).is_none() {
            continue;
        }
        match record.task {
            Task::Fetch { job: Some(job), node, .. } if !writer.floor().next_stop_is_granted(robot) => {
                let stay = writer.floor().free_place(robot, NodeKind::Parking).unwrap_or(node);
                let task = Task::rest_at(stay, Purpose::Park);
                writer.progress(job, JobState::Waiting, Some((robot, task)), now);
            }
            Task::Idle if writer.warehouse().kind(writer.ledger().node_of(robot)) != NodeKind::Parking => {
                if let Some(stay) = writer.floor().free_place(robot, NodeKind::Parking) {
                    let task = Task::rest_at(stay, Purpose::Park);
                    writer.record(RobotFact::Tasked { robot, task });
                }
            }
            _ => {}
        }
    }
}

//! A robot about which the ledger contradicts itself is fenced off, so that the others go on.
//!
//! Main function: [`fence`]. A fenced robot is treated like a robot that failed, whatever it reports: it keeps what it
//! was granted, robots behind it get other routes, and its job goes to another. It stays fenced over a restart, until a
//! person releases it. Refuses: to repair anything; a person has to find out what is wrong.

use crate::state::fact::RobotFact;
use crate::state::writer::Writer;
use crate::traffic::failure::give_up;
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;

/// Fences a robot off, unless it has left the floor.
pub(crate) fn fence(writer: &mut Writer, robot: RobotId, now: Time) {
    let on_floor = writer.ledger().robots.get(robot).is_some_and(|record| !record.is_gone());
    if on_floor && writer.ledger().robots[robot].fenced.is_none() {
        writer.record(RobotFact::Fenced { robot, at: now });
        give_up(writer, robot, now);
        assert!(writer.ledger().robots[robot].failed, "{robot:?} is fenced off and counts as failed");
    }
}

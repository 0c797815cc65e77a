//! Keeps the expected ends of visits at work cells true on the timelines, so that robots behind are planned with them.
//!
//! Main function: `retime_visits`. If an expectation has moved only a little, nothing is retimed, so a long visit
//! causes a few changes, not a stream of them. Refuses: to end a visit.

use crate::state::fact::{Moved, RouteFact, Task};
use crate::state::floor::Floor;
use crate::state::writer::Writer;
use giveway_cell::Remaining;
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::{Span, Time};

/// An expected end stays as it is if it is off by less than this, or by less than this share of the time left.
const OFF: Span = Span::from_millis(1000);
const OFF_SHARE: f64 = 0.25;

/// Moves the planned end of each visit at a work cell to its expected end, later or earlier.
pub(crate) fn retime_visits(writer: &mut Writer, now: Time) {
    if !writer.settings.flow.counts_lines() {
        return;
    }
    for robot in writer.ledger().present() {
        let Some(job) = visit_of(writer.floor(), robot) else { continue };
        writer.visits.begin(job, now);
        let record = &writer.ledger().jobs[&job];
        let ends_out = writer.floor().ends_out(record);
        if let Some(remaining) = writer.visits.remaining(job, record, ends_out, now) {
            writer.visits.expect(job, &remaining, now);
            writer.at_hand.note(robot);
            retime(writer, robot, remaining, now);
        }
    }
    writer.at_hand.clear();
}

/// The job with order lines for which a robot is being picked from, if any.
fn visit_of(floor: Floor<'_>, robot: RobotId) -> Option<JobId> {
    let Task::Deliver { job, .. } = floor.ledger.robots[robot].task else { return None };
    let has_lines = floor.ledger.jobs.get(&job)?.lines_now().is_some();
    (has_lines && floor.ledger.is_picked_from(robot)).then_some(job)
}

fn retime(writer: &mut Writer, robot: RobotId, remaining: Remaining, now: Time) {
    let chain = writer.ledger().chain(robot);
    let serial = chain.first();
    let Some(here) = chain.get(serial).filter(|v| !v.depart.is_forever()) else { return };
    let left = Span::from_secs_f64(remaining.mean_s);
    let off = now + left - here.depart;
    let bearable = OFF.max(Span::from_secs_f64(OFF_SHARE * remaining.mean_s));
    let moved = if off > bearable {
        let slip = writer.ledger().timeline().delay(robot, serial, now + left);
        slip.into_iter().map(|(h, shifts)| Moved { robot: h, shifts }).collect()
    } else if -off > bearable && chain.granted() == serial + 1 {
        let shifts = writer.ledger().timeline().advance(robot, now + left);
        if shifts.is_empty() { Vec::new() } else { vec![Moved { robot, shifts }] }
    } else {
        Vec::new()
    };
    if !moved.is_empty() {
        writer.record(RouteFact::Retimed { moved });
    }
}

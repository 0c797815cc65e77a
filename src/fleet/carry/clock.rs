//! A ledger that goes on at an earlier time than that of its last step, because the clock had been wrong.
//!
//! Main function: [`set_back`]. Refuses: to change times that customers gave (deadlines, ends of closures).

use super::{Carried, Report, carry_fitted};
use crate::{Ledger, Promises, Service};
use giveway_floor::time::{Time, Window};

/// Carries a ledger over to its own map at another time: from then on robots stand where they are, and the jobs that
/// they had wait again. Times that are later than `now` become `now`. `last` is the time of the last step.
pub fn set_back(ledger: &Ledger, last: Time, now: Time) -> Carried {
    let kinds = (ledger.kinds().added().to_vec(), Report::default());
    let mut carried = carry_fitted(ledger, ledger.warehouse(), kinds, now);
    if let Some(parts) = &mut carried.parts {
        not_after(&mut parts.promises, last, now);
    }
    carried
}

fn not_after(p: &mut Promises, last: Time, now: Time) {
    let set = |time: &mut Time| *time = (*time).min(now);
    for job in p.jobs.values_mut() {
        set(&mut job.accepted);
        job.served.iter_mut().for_each(|(_, at)| set(at));
    }
    for robot in p.robots.iter_mut() {
        robot.paused.iter_mut().chain(&mut robot.fenced).for_each(set);
        match &mut robot.service {
            Service::Works => {}
            Service::Maintenance { since } | Service::Leaving { since } | Service::Gone { since } => {
                set(since)
            }
        }
    }
    p.on_floor.values_mut().for_each(|place| set(&mut place.seen));
    p.assignments.values_mut().for_each(|assignment| set(&mut assignment.accepted));
    // What is closed stays closed; what was announced begins when it was announced for.
    let in_force = p.closures.values_mut().filter(|closure| closure.window.start() <= last);
    in_force.for_each(|c| c.window = Window::new(c.window.start().min(now), c.window.end()));
    p.evacuation.iter_mut().chain(&mut p.stopped).for_each(set);
    p.paused_stations.values_mut().for_each(set);
    p.ended_badly.values_mut().for_each(set);
}

//! What one look at the fleet finds wrong, in words with names.
//!
//! Refuses: to remember anything from look to look.

use super::LOOKS;
use crate::api::displaced::words;
use crate::fleet::{ChainEnd, Fault, Fleet, LostWorker, Party, Standstill};
use crate::id::{ClosureId, RobotId, WorkerId};
use crate::sim::laws::{KEPT, untrue};
use crate::time::{Span, Time};

/// A standstill that the fleet did not end within this is an alarm.
const LASTS: Span = Span::from_secs(60);
/// A worker whom no source has known for so long has to be looked for.
const LOST_LONG: Span = Span::from_secs(30);

/// Standstills that have lasted for long, each in words.
pub(super) fn standstills(fleet: &Fleet, now: Time) -> Vec<String> {
    let ledger = fleet.ledger();
    let name = |party: &Party| match party {
        Party::Robot(r) => ledger.robots[*r].name.clone(),
        Party::Worker(w) => worker_name(fleet, *w),
    };
    let found = fleet.standstills().into_iter().filter(|s| now - s.since > LASTS);
    found.map(|s| in_words(&s, name)).collect()
}

/// Workers whom no source has known for long, each with how many robots wait for that.
pub(super) fn lost_workers(fleet: &Fleet, now: Time) -> Vec<String> {
    let words = |lost: LostWorker| {
        let name = worker_name(fleet, lost.worker);
        let robots = match lost.waiting.len() {
            0 => "no robot waits".to_owned(),
            1 => "1 robot waits".to_owned(),
            n => format!("{n} robots wait"),
        };
        let seconds = LOST_LONG.0 / 1_000_000;
        format!("{name} (w{}) for more than {seconds} s, {robots}", lost.worker.0 + 1)
    };
    fleet.lost_workers(LOST_LONG, now).into_iter().map(words).collect()
}

/// What stands still, with names.
fn in_words(found: &Standstill, name: impl Fn(&Party) -> String) -> String {
    let roots: Vec<String> = found.root.iter().map(&name).collect();
    let root = roots.join(" and ");
    let behind = match &found.behind[..] {
        [] => String::new(),
        [one] => format!("; {} waits for that", name(one)),
        [first, others @ ..] => format!("; {} and {} more wait for that", name(first), others.len()),
    };
    match found.root.first() {
        Some(_) if matches!(found.end, ChainEnd::Cycle(_)) => format!("{root} wait for one another{behind}"),
        Some(Party::Worker(_)) => format!("{root} stands in the way{behind}"),
        _ => format!("{root} has no way to go{behind}"),
    }
}

/// Robots that cannot go on from where they stand, each with why and what to do.
pub(super) fn displaced(fleet: &Fleet) -> Vec<String> {
    let (ledger, map) = (fleet.ledger(), fleet.warehouse());
    let name = |r: RobotId| ledger.robots[r].name.clone();
    let found = ledger.present().filter_map(|r| Some((r, fleet.displacement(r)?)));
    found.map(|(r, why)| format!("{} {}", name(r), words(map, name, why))).collect()
}

/// Robots that a person has to look after, each with why. A robot that is broken counts as failed and is listed as
/// that; one that is driven by hand has a person with it; an obstructed one looks for another way.
pub(super) fn faults(fleet: &Fleet, now: Time) -> Vec<String> {
    let words = |robot: RobotId| match fleet.telemetry(robot)?.fault? {
        Fault::EmergencyStop => Some("emergency stop pressed"),
        Fault::Unplugged => Some("no current from its charger"),
        Fault::Broken | Fault::Manual | Fault::Obstructed => None,
    };
    let robots = fleet.ledger().robots.pairs();
    robots
        .filter_map(|(r, record)| {
            Some(format!("{} ({})", record.name, back(fleet, r, now).or_else(|| words(r))?))
        })
        .collect()
}

/// A robot that has left and can be heard: other robots do not make way for it.
fn back(fleet: &Fleet, robot: RobotId, now: Time) -> Option<&'static str> {
    let heard = fleet.telemetry(robot).is_some_and(|t| now - t.seen <= LOOKS + LOOKS);
    (fleet.ledger().robots[robot].is_gone() && heard)
        .then_some("has left the floor but still reports: register it again")
}

/// Robots that say that they reached, or know of, more than they were granted.
pub(super) fn beyond_grant(fleet: &Fleet) -> Vec<String> {
    let ledger = fleet.ledger();
    let beyond = |r: &RobotId| {
        let granted = ledger.chain(*r).granted();
        fleet.telemetry(*r).is_some_and(|t| t.reached.max(t.known) >= granted)
    };
    ledger.present().filter(beyond).map(|r| ledger.robots[r].name.clone()).collect()
}

/// People whom the fleet has kept in one spot for long.
pub(super) fn kept_workers(fleet: &Fleet) -> Vec<String> {
    let words = |(worker, waited): (WorkerId, Span)| {
        format!("{} (w{}) for {:.0} s", worker_name(fleet, worker), worker.0 + 1, waited.as_secs_f64())
    };
    fleet.kept_workers(KEPT).into_iter().map(words).collect()
}

/// Workers in areas that are closed to people.
pub(super) fn in_closed_areas(fleet: &Fleet, now: Time) -> Vec<String> {
    let words = |(worker, closure): (WorkerId, ClosureId)| {
        let why = fleet.ledger().closures.get(&closure).map_or("", |c| c.reason.as_str());
        format!("{} (w{}) in c{} ({why})", worker_name(fleet, worker), worker.0 + 1, closure.0)
    };
    fleet.in_closed_areas(now).into_iter().map(words).collect()
}

/// Robots that wait for what does not keep them.
pub(super) fn waits_in_vain(fleet: &Fleet) -> Vec<String> {
    let in_vain = fleet.ledger().present().filter(|r| untrue(fleet, *r).is_some());
    in_vain.map(|r| fleet.ledger().robots[r].name.clone()).collect()
}

fn worker_name(fleet: &Fleet, worker: WorkerId) -> String {
    let known = fleet.ledger().workers.get(worker).cloned();
    known.unwrap_or_else(|| format!("worker {}", worker.0 + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standstill_is_told_with_names() {
        let (robot, worker) = (Party::Robot(RobotId(3)), Party::Worker(crate::id::WorkerId(0)));
        let name = |p: &Party| if *p == worker { "Ana".to_owned() } else { "robot-4".to_owned() };
        let told = |end, root: &[Party], behind: &[Party]| {
            in_words(&Standstill { end, root: root.into(), behind: behind.into(), since: Time(1) }, name)
        };
        assert_eq!(
            told(ChainEnd::Cycle(robot), &[robot, worker], &[]),
            "robot-4 and Ana wait for one another"
        );
        assert_eq!(
            told(ChainEnd::Still(worker), &[worker], &[robot]),
            "Ana stands in the way; robot-4 waits for that"
        );
        assert_eq!(
            told(ChainEnd::Still(robot), &[robot], &[robot, robot, robot]),
            "robot-4 has no way to go; robot-4 and 2 more wait for that"
        );
    }
}

//! The law that no robot stands for ever: a robot with a task makes progress, or waits its turn in a line that moves.
//!
//! Main type: [`ProgressLaws`]. A robot blocked by one that truly cannot drive waits for the person who repairs it; a
//! robot at a station whose picker is truly away waits for the picker, and so do the robots behind it. Refuses: to
//! excuse a robot for any other reason; a line that stands is no excuse.

use super::violation::{STUCK, Violation};
use crate::world::World;
use giveway_fleet::{Edge, Fleet, Party, Task, Why};
use giveway_floor::id::{NodeId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// Number of steps between two checks of lines at stations.
const LOOKS_EVERY: u64 = 100;
/// A robot's turn at a station comes within this time, however many racks are wanted there; so does the repair of a
/// robot in its way, and the return of a picker who is away.
const TURN: Span = Span::from_secs(3600);

/// The progress of each robot, and how many racks each station has served and when.
#[derive(Debug, Default)]
pub(super) struct ProgressLaws {
    robots: BTreeMap<RobotId, Stood>,
    served: BTreeMap<StationId, (u64, Time)>,
    steps: u64,
}

/// A robot that has made no progress.
#[derive(Clone, Copy, Debug)]
struct Stood {
    /// The visit that the robot is at, and the last stop it has done.
    at: (u64, Option<u64>),
    /// Since when the robot is there.
    since: Time,
    /// Since when the robot has not been waiting in a line that moves.
    unexcused: Time,
}

impl ProgressLaws {
    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        self.steps += 1;
        if self.steps.is_multiple_of(LOOKS_EVERY) {
            self.look_at_lines(now, world, fleet);
        }
        let mut broken = Vec::new();
        for (r, record) in fleet.ledger().robots.pairs().filter(|(_, r)| !r.is_gone()) {
            let at = (fleet.ledger().chain(r).first(), record.acted);
            let fresh = Stood { at, since: now, unexcused: now };
            let stood = self.robots.entry(r).or_insert(fresh);
            let halted = record.paused.is_some() || fleet.ledger().stopped.is_some();
            if stood.at != at || record.task == Task::Idle || record.failed || halted {
                *stood = fresh;
            } else if now - stood.unexcused > STUCK {
                stood.unexcused = now;
                broken.push(Violation::Stuck(r, record.task, fleet.why(r)));
            }
        }
        debug_assert!(self.robots.len() <= fleet.ledger().robots.len());
        broken
    }

    /// A robot that waits with its rack until its station has room waits its turn while the station serves others. A
    /// robot behind a broken one waits for the repair, and one whose picker is away waits for the picker.
    fn look_at_lines(&mut self, now: Time, world: &World, fleet: &Fleet) {
        let away: Vec<StationId> = world.pickers_away().collect();
        let nodes: Vec<NodeId> = away.iter().map(|s| fleet.warehouse().stations[*s].node).collect();
        for (station, served) in fleet.ledger().served.pairs() {
            let known = self.served.entry(station).or_insert((*served, now));
            if known.0 != *served {
                *known = (*served, now);
            }
        }
        for (robot, stood) in &mut self.robots {
            if now - stood.since > TURN || stood.unexcused == now {
                continue;
            }
            let in_line = |s: &StationId| now - self.served[s].1 < STUCK || away.contains(s);
            let in_moving_line = fleet.why(*robot).and_then(Why::station).is_some_and(|s| in_line(&s));
            if in_moving_line || waits_for_people(fleet, *robot, &nodes) {
                stood.unexcused = now;
            }
        }
    }
}

/// Whether following what a robot waits for leads to a broken robot, or to a robot that is picked from at one of the
/// places `away`, where the picker is absent; that may be the robot itself.
fn waits_for_people(fleet: &Fleet, robot: RobotId, away: &[NodeId]) -> bool {
    let ledger = fleet.ledger();
    let mut at = robot;
    for _ in 0..ledger.robots.len() {
        if away.contains(&ledger.node_of(at)) && fleet.is_picked_from(at) {
            return true;
        }
        match fleet.wait(Party::Robot(at)).edge {
            Edge::On(Party::Robot(next)) if ledger.robots[next].failed => return true,
            Edge::On(Party::Robot(next)) => at = next,
            _ => return false,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Simulation;
    use crate::scenario::Scenario;
    use giveway_floor::warehouse::stations;
    use std::sync::Arc;

    /// How often the law finds a robot stuck in 25 minutes, with these pickers.
    fn stood(change: impl FnOnce(&mut Scenario)) -> usize {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/stations.json")).unwrap();
        (scenario.robots, scenario.duration, scenario.drain) = (14, Span::from_secs(1500), Span::ZERO);
        change(&mut scenario);
        let mut sim = Simulation::new(Arc::new(stations()), &scenario, &[], 3, false, || 0);
        while !sim.is_over() {
            sim.step();
        }
        sim.broken().iter().filter(|(_, v)| matches!(v, Violation::Stuck(..))).count()
    }

    #[test]
    fn robots_wait_for_a_picker_who_is_away_and_not_for_one_who_does_nothing() {
        let away = stood(|scenario| {
            for habits in scenario.cells.as_mut().unwrap().pickers.iter_mut().flatten() {
                (habits.away_per_hour, habits.away_s) = (1000.0, 3600.0);
            }
        });
        assert_eq!(away, 0, "each waits for somebody who is away, or behind such a robot");
        let idle = stood(|scenario| scenario.cells.as_mut().unwrap().pickers = Some(Vec::new()));
        assert!(idle > 0, "nobody picks, and nobody is away");
    }
}

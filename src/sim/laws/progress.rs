//! The law that no robot stands for ever: one with a task gets on with it, or waits its turn in a line that moves.
//!
//! Main type: [`ProgressLaws`]. A robot behind one that truly cannot drive waits for the person who repairs that one.
//! Refuses: to excuse a robot because it has any other reason; a line that stands is no excuse.

use super::violation::{STUCK, Violation};
use crate::fleet::{Edge, Fleet, Party, Task, Why};
use crate::id::{RobotId, StationId};
use crate::time::{Span, Time};
use std::collections::BTreeMap;

/// Every how many steps lines at stations are looked at.
const LOOKS_EVERY: u64 = 100;
/// A robot's turn at a station comes within this, however many racks are wanted there; so does the repair of one that
/// is in its way.
const TURN: Span = Span::from_secs(3600);

/// How far each robot has come, and which stations serve.
#[derive(Debug, Default)]
pub(super) struct ProgressLaws {
    robots: BTreeMap<RobotId, Stood>,
    served: BTreeMap<StationId, (u64, Time)>,
    steps: u64,
}

/// A robot that is where it was.
#[derive(Clone, Copy, Debug)]
struct Stood {
    /// The visit at which it is, and the last stop that it has done.
    at: (u64, Option<u64>),
    /// Since when it is there.
    since: Time,
    /// Since when it has not been waiting in a line that moves.
    unexcused: Time,
}

impl ProgressLaws {
    pub fn check(&mut self, now: Time, fleet: &Fleet) -> Vec<Violation> {
        self.steps += 1;
        if self.steps.is_multiple_of(LOOKS_EVERY) {
            self.look_at_lines(now, fleet);
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

    /// A robot that waits with its rack until its station has room waits its turn while the station serves others. One
    /// behind a broken robot waits for the repair.
    fn look_at_lines(&mut self, now: Time, fleet: &Fleet) {
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
            let in_line = |s: &StationId| now - self.served[s].1 < STUCK;
            let in_moving_line =
                matches!(fleet.why(*robot), Some(Why::QueueFull(station)) if in_line(&station));
            if in_moving_line || is_behind_broken(fleet, *robot) {
                stood.unexcused = now;
            }
        }
    }
}

/// Whether what a robot waits for leads to one that cannot drive.
fn is_behind_broken(fleet: &Fleet, robot: RobotId) -> bool {
    let mut at = robot;
    for _ in 0..fleet.ledger().robots.len() {
        match fleet.wait(Party::Robot(at)).edge {
            Edge::On(Party::Robot(next)) if fleet.ledger().robots[next].failed => return true,
            Edge::On(Party::Robot(next)) => at = next,
            _ => return false,
        }
    }
    false
}

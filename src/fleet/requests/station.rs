//! Stations say when a pick has ended, and whether they work at all.
//!
//! Main function: `hear_station`. A pick lasts until the person at the station says that it is done, or that goods were
//! missing; how long it was planned to take only decides when others come. A paused station gets no more racks; those
//! in its queue wait. Refuses: to end a pick by the clock, and one that has not begun.

use crate::fleet::requests::intake::Intake;
use crate::fleet::state::fact::{Act, Fact, Task};
use crate::fleet::state::floor::Floor;
use crate::fleet::state::io::StationOrder;
use crate::fleet::state::io::{Refusal, Reply};
use crate::fleet::state::job::{JobFailure, JobState};
use crate::id::{Dense, RobotId, StationId};
use crate::time::Time;

impl Intake<'_> {
    /// Takes in what a station says.
    pub(in crate::fleet) fn hear_station(
        &mut self,
        token: u64,
        station: StationId,
        order: StationOrder,
        now: Time,
    ) -> Result<Reply, Refusal> {
        if station.ix() >= self.core.warehouse().stations.len() {
            return Err(Refusal::UnknownPlace);
        }
        let paused = self.core.ledger.paused_stations.contains_key(&station);
        match order {
            StationOrder::Pause if !paused => self.core.record(Fact::StationPaused { station, at: now }),
            StationOrder::Resume if paused => self.core.record(Fact::StationResumed { station, at: now }),
            StationOrder::Pause | StationOrder::Resume => {}
            StationOrder::Done | StationOrder::Short => {
                let robot = self.core.floor().picked_from(station).ok_or(Refusal::NothingToPick(station))?;
                let state = match order {
                    StationOrder::Done => JobState::Done,
                    _ => JobState::Failed(JobFailure::Short),
                };
                self.end_pick(robot, state, now);
            }
        }
        Ok(Reply::Done { token })
    }

    /// Ends the pick at which a robot stands: its job ends so, if it is not over already, and the robot may leave.
    fn end_pick(&mut self, robot: RobotId, state: JobState, now: Time) {
        self.core.record(Fact::Acted { robot, serial: self.core.ledger.chain(robot).first() });
        self.heard.left_early.push(robot);
        if let Task::Deliver { job, rack, store, .. } = self.core.ledger.robots[robot].task {
            let next = self.core.ledger.jobs[&job].request.then.first().copied();
            if let Some(next) = next.filter(|_| state == JobState::Done) {
                let station = self.core.warehouse().stations[next.station].node;
                let task = Task::Deliver { job, rack, station, store };
                self.core.record(Fact::Served { job, tasked: (robot, task), at: now });
                return;
            }
            let task = Task::Store { job: None, rack, store };
            self.core.progress(job, state, Some((robot, task)), now);
            self.heard.picked.push(robot);
        }
    }

    /// Nobody picks for a job that was cancelled: the robot need not wait.
    pub(in crate::fleet) fn end_cancelled_pick(&mut self, robot: RobotId) {
        if self.core.floor().is_picked_from(robot) {
            self.core.record(Fact::Acted { robot, serial: self.core.ledger.chain(robot).first() });
            self.heard.left_early.push(robot);
        }
    }
}

impl Floor<'_> {
    /// The robot that stands at a station with a rack to pick from.
    pub(in crate::fleet) fn picked_from(&self, station: StationId) -> Option<RobotId> {
        let node = self.warehouse().stations[station].node;
        let mut there = self.ledger.present().filter(|r| self.ledger.node_of(*r) == node);
        there.find(|r| self.is_picked_from(*r))
    }

    /// Whether a robot stands at its station and the pick has not ended.
    pub fn is_picked_from(&self, robot: RobotId) -> bool {
        let here = self.ledger.chain(robot).first();
        let stop = self.ledger.robots[robot].stops.first();
        stop.is_some_and(|s| s.serial == here && matches!(s.act, Act::Pick(_)))
    }
}

//! Stations say when a pick has ended, and whether they work at all.
//!
//! Main function: `hear_station`. A pick lasts until the person at the station says that it is done, or that goods were
//! missing; how long it was planned to take only decides when others come. A paused station gets no more racks; those
//! in its queue wait. A visit with order lines ends with the last of them. Refuses: to end a pick by the clock, and one
//! that has not begun.

use crate::cell::{LineChange, LineOutcome, LineProgress, LineRefusal, LineState, Lines};
use crate::fleet::requests::intake::Intake;
use crate::fleet::state::fact::{Act, Fact, Task};
use crate::fleet::state::floor::Floor;
use crate::fleet::state::io::Reply;
use crate::fleet::state::io::StationOrder;
use crate::fleet::state::job::{JobFailure, JobState};
use crate::fleet::state::refusal::Refusal;
use crate::id::{Dense, JobId, RobotId, StationId};
use crate::time::Time;

/// What a change of a line came to.
pub(super) struct NotedLine {
    job: JobId,
    line: usize,
    outcome: LineOutcome,
    state: LineState,
    pieces: u32,
}

impl NotedLine {
    fn reply(self, token: u64) -> Reply {
        let NotedLine { job, line, outcome, state, pieces } = self;
        Reply::LineNoted { token, job, line, outcome, state, pieces }
    }
}

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
            StationOrder::Done | StationOrder::Short | StationOrder::Release => {
                let robot = self.core.floor().picked_from(station).ok_or(Refusal::NothingToPick(station))?;
                self.settle_lines(robot, order == StationOrder::Done, now);
                let state = match order {
                    StationOrder::Short => JobState::Failed(JobFailure::Short),
                    _ => JobState::Done,
                };
                self.end_pick(robot, state, now);
            }
            StationOrder::Line(line, change) => {
                return self.hear_of_line(token, station, (line, change), now);
            }
            StationOrder::Last(change) => {
                let noted = self.hear_of_last(station, (None, change), now);
                return Ok(noted.ok_or(Refusal::NothingToPick(station))??.reply(token));
            }
        }
        Ok(Reply::Done { token })
    }

    /// Takes in what is said about a line. The visit ends with its last one. What the hand has just confirmed, a button
    /// confirms once more.
    fn hear_of_line(
        &mut self,
        token: u64,
        station: StationId,
        (line, change): (usize, LineChange),
        now: Time,
    ) -> Result<Reply, Refusal> {
        let noted = if let Some(robot) = self.core.floor().picked_from(station) {
            self.change_line(robot, (line, change), now)
        } else if let Some(noted) = self.hear_of_last(station, (Some(line), change), now) {
            noted
        } else {
            let (job, lines) = self.core.visits.ended(station, now).ok_or(Refusal::NothingToPick(station))?;
            let is_so =
                |p: &LineProgress| p.state == LineState::Done && matches!(change, LineChange::Done(_));
            let noted = lines.all().get(line).filter(|p| is_so(p)).ok_or(Refusal::NothingToPick(station))?;
            let LineProgress { state, pieces, .. } = *noted;
            let outcome = LineOutcome::Already;
            return Ok(Reply::LineNoted { token, job, line, outcome, state, pieces });
        };
        Ok(noted?.reply(token))
    }

    /// Changes a line of the visit for which a robot is picked from. The visit ends with its last line, unless a hand is
    /// inside: then when it is out.
    pub(super) fn change_line(
        &mut self,
        robot: RobotId,
        (line, change): (usize, LineChange),
        now: Time,
    ) -> Result<NotedLine, Refusal> {
        let Some((job, lines)) = self.lines_under(robot) else {
            return Err(Refusal::Line(LineRefusal::NoLine(0)));
        };
        let mut lines = lines.clone();
        let outcome = lines.change(line, change).map_err(Refusal::Line)?;
        if outcome == LineOutcome::Changed {
            self.core.record(Fact::LineChanged { job, line, change, at: now });
        }
        if lines.are_over() {
            let station = self.core.floor().station_of(robot);
            match station.filter(|station| self.is_hand_inside(*station, now)) {
                Some(station) => self.core.visits.keep(station, true),
                None => self.end_pick(robot, JobState::Done, now),
            }
        }
        let LineProgress { state, pieces, .. } = lines.all()[line];
        Ok(NotedLine { job, line, outcome, state, pieces })
    }

    /// What is said about the line that was not confirmed when its rack left, if there is one: about that with this
    /// number, or the one that is lit.
    fn hear_of_last(
        &mut self,
        station: StationId,
        (line, change): (Option<usize>, LineChange),
        now: Time,
    ) -> Option<Result<NotedLine, Refusal>> {
        let left = self.core.ledger.unconfirmed.get(&station)?;
        let (job, line, mut lines) = (left.job, line.or(left.lines.lit())?, left.lines.clone());
        Some(lines.change(line, change).map_err(Refusal::Line).map(|outcome| {
            if outcome == LineOutcome::Changed {
                self.core.record(Fact::LineChanged { job, line, change, at: now });
            }
            let LineProgress { state, pieces, .. } = lines.all()[line];
            NotedLine { job, line, outcome, state, pieces }
        }))
    }

    /// What is left of the visit is picked, as a person says, or short.
    fn settle_lines(&mut self, robot: RobotId, done: bool, now: Time) {
        let Some((job, lines)) = self.lines_under(robot) else { return };
        let left: Vec<_> =
            lines.all().iter().map(LineProgress::left).enumerate().filter(|(_, n)| *n > 0).collect();
        for (line, pieces) in left {
            let change = if done { LineChange::Done(pieces) } else { LineChange::Short };
            self.core.record(Fact::LineChanged { job, line, change, at: now });
        }
    }

    /// The job for which a robot is picked from, with the lines of this visit, if it has lines.
    pub(super) fn lines_under(&self, robot: RobotId) -> Option<(JobId, &Lines)> {
        let ledger = &self.core.ledger;
        let job = ledger.robots[robot].task.job()?;
        Some((job, ledger.jobs.get(&job)?.lines_now()?))
    }

    /// Ends the pick at which a robot stands: its job ends so, if it is not over already, and the robot may leave.
    pub(super) fn end_pick(&mut self, robot: RobotId, state: JobState, now: Time) {
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

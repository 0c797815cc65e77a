//! The visit in progress at a work cell: its lines change, and it ends, but not while a hand is inside.
//!
//! Main type: [`OnVisit`]. Refuses: to observe; buttons and hands report.

use crate::requests::intake::Intake;
use crate::state::fact::{JobFact, RouteFact, Task};
use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::refusal::{PickRefusal, Refusal};
use crate::state::request::LineNoted;
use crate::state::visits::ConfirmedBy;
use giveway_cell::{LineChange, LineOutcome, LineProgress, LineRefusal, Lines, PickFace};
use giveway_floor::id::{JobId, RobotId, StationId};
use giveway_floor::time::Time;
use std::sync::Arc;

/// The visit in progress at a station.
#[derive(Clone, Copy)]
pub(super) struct OnVisit {
    pub robot: RobotId,
    pub job: JobId,
}

impl Intake<'_> {
    /// The job for which a robot is picked from, with the lines of this visit, if it has any.
    pub(super) fn lines_under(&self, robot: RobotId) -> Option<(JobId, &Lines)> {
        let ledger = &self.writer.ledger();
        let job = ledger.robots[robot].task.job()?;
        Some((job, ledger.jobs.get(&job)?.lines_now()?))
    }

    /// Changes a line of the visit for which a robot is picked from. The visit ends with its last line or, if a hand is
    /// inside then, when the hand is out. A hand that was last seen inside may still be there until a button is
    /// pressed.
    pub(super) fn change_line(
        &mut self,
        robot: RobotId,
        (line, change): (usize, LineChange),
        by: ConfirmedBy,
        now: Time,
    ) -> Result<LineNoted, Refusal> {
        let Some((job, lines)) = self.lines_under(robot) else {
            return Err(Refusal::Pick(PickRefusal::Line(LineRefusal::NoLine(0))));
        };
        let mut lines = lines.clone();
        let outcome = lines.change(line, change)?;
        if outcome == LineOutcome::Changed {
            self.writer.record(JobFact::LineChanged { job, line, change, at: now });
        }
        if lines.are_over() {
            let station = self.writer.floor().station_of(robot);
            match station.filter(|station| self.keeps_rack(*station, by, now)) {
                Some(station) => self.writer.visits.keep(station, true),
                None => self.end_pick(robot, JobState::Done, now),
            }
        }
        let LineProgress { state, pieces, .. } = lines.all()[line];
        Ok(LineNoted { job, line, outcome, state, pieces })
    }

    /// Whether the rack at a station stays although its lines are over.
    fn keeps_rack(&mut self, station: StationId, by: ConfirmedBy, now: Time) -> bool {
        match by {
            ConfirmedBy::Hand => self.may_hand_be_inside(station, now),
            ConfirmedBy::Button => {
                self.writer.visits.hands_at(station).forget_lost(now);
                self.is_hand_inside(station, now)
            }
        }
    }

    /// Ends the pick at which a robot stands: its job gets this state, if it is not over already, and the robot may
    /// leave.
    pub(super) fn end_pick(&mut self, robot: RobotId, state: JobState, now: Time) {
        if let Some(station) = self.writer.floor().station_of(robot) {
            self.writer.visits.keep(station, false);
        }
        self.writer.record(RouteFact::Acted { robot, serial: self.writer.ledger().chain(robot).first() });
        self.heard.left_early.push(robot);
        if let Task::Deliver { job, rack, store, .. } = self.writer.ledger().robots[robot].task {
            let next = self.writer.ledger().jobs[&job].request.then.first().copied();
            if let Some(next) = next.filter(|_| state == JobState::Done) {
                let station = self.writer.warehouse().stations[next.station].node;
                let task = Task::Deliver { job, rack, station, store };
                self.writer.record(JobFact::Served { job, tasked: (robot, task), at: now });
                return;
            }
            let task = Task::Store { job: None, rack, store };
            self.writer.progress(job, state, Some((robot, task)), now);
            self.heard.picked.push(robot);
        }
    }

    /// The visit at a station, with lines. It is looked up once for all observations of a step.
    pub(super) fn visit_at(&mut self, station: StationId, now: Time) -> Option<OnVisit> {
        let robot = match self.writer.visits.looked_up(station, now) {
            Some(robot) => robot,
            None => {
                let robot = self.writer.floor().picked_from(station);
                self.writer.visits.note_robot(station, robot, now);
                robot
            }
        };
        let robot = robot.filter(|robot| self.writer.ledger().is_picked_from(*robot))?;
        let (job, _) = self.lines_under(robot)?;
        Some(OnVisit { robot, job })
    }

    /// The rack's face at a station: of the rack that stands there, or of the rack before.
    pub(super) fn face(&mut self, station: StationId, visit: Option<OnVisit>) -> Option<Arc<PickFace>> {
        let rack = visit.and_then(|v| self.writer.ledger().jobs[&v.job].request.kind.rack());
        let (ledger, visits) = self.writer.ledger_and_visits();
        visits.face(ledger.warehouse(), station, rack).cloned()
    }

    /// Whether the rack at a station has to wait before it leaves: a hand is seen inside, or the robot arm is inside,
    /// or two people are there.
    pub(super) fn is_hand_inside(&mut self, station: StationId, now: Time) -> bool {
        let visit = self.visit_at(station, now);
        let Some(face) = self.face(station, visit) else { return false };
        self.writer.visits.hands_at(station).is_inside(&face, now)
            || self.writer.arms.is_inside(station)
            || self.writer.visits.is_shared(station, now)
    }

    /// Whether the rack has to wait, or a hand was last seen inside and no one has said since that it is out.
    pub(super) fn may_hand_be_inside(&mut self, station: StationId, now: Time) -> bool {
        let visit = self.visit_at(station, now);
        let lost_inside = self
            .face(station, visit)
            .is_some_and(|face| self.writer.visits.hands_at(station).may_be_inside(&face));
        lost_inside || self.is_hand_inside(station, now)
    }
}

impl Floor<'_> {
    /// The robot that stands at a station with a rack to pick from.
    pub(crate) fn picked_from(&self, station: StationId) -> Option<RobotId> {
        let node = self.warehouse().stations[station].node;
        let mut there = self.ledger.present().filter(|r| self.ledger.node_of(*r) == node);
        there.find(|r| self.ledger.is_picked_from(*r))
    }
}

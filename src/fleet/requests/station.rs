//! Stations report when a pick has ended, and whether they work at all.
//!
//! Main function: `hear_station`. A pick lasts until the person at the station says that it is done, or that goods were
//! missing; how long it was planned to take only decides when other robots come. A paused station gets no more racks;
//! racks in its queue wait. A visit with order lines ends with the last of them. Refuses: to end a pick by the clock,
//! and to end one that has not begun.

use crate::requests::intake::Intake;
use crate::state::fact::{FloorFact, JobFact, RouteFact};
use crate::state::job::{JobFailure, JobState};
use crate::state::refusal::{PickRefusal, Refusal};
use crate::state::request::{Answer, Answered, LineNoted, StationOrder};
use crate::state::visits::ConfirmedBy;
use giveway_cell::{LineChange, LineOutcome, LineProgress, LineState};
use giveway_floor::id::{Dense, RobotId, StationId};
use giveway_floor::time::Time;

impl Intake<'_> {
    /// Takes in a station's report.
    pub(crate) fn hear_station(&mut self, station: StationId, order: StationOrder, now: Time) -> Answered {
        if station.ix() >= self.writer.warehouse().stations.len() {
            return Err(Refusal::UnknownPlace);
        }
        if !matches!(order, StationOrder::Pause | StationOrder::Resume) {
            self.writer.visits.note_use(station, now);
        }
        let paused = self.writer.ledger().paused_stations.contains_key(&station);
        match order {
            StationOrder::Pause if !paused => {
                self.writer.record(FloorFact::StationPaused { station, at: now })
            }
            StationOrder::Resume if paused => {
                self.writer.record(FloorFact::StationResumed { station, at: now })
            }
            StationOrder::Pause | StationOrder::Resume => {}
            StationOrder::Done | StationOrder::Short | StationOrder::Release => {
                let robot = self
                    .writer
                    .floor()
                    .picked_from(station)
                    .ok_or(Refusal::Pick(PickRefusal::NothingThere(station)))?;
                self.vouch_for_arm(station, now);
                self.writer.visits.hands_at(station).forget_lost(now);
                self.settle_lines(robot, order == StationOrder::Done, now);
                let state = match order {
                    StationOrder::Short => JobState::Failed(JobFailure::Short),
                    _ => JobState::Done,
                };
                self.end_pick(robot, state, now);
            }
            StationOrder::Line(line, change) => {
                return self.hear_of_line(station, (line, change), now);
            }
            StationOrder::Last(change) => {
                let noted = self.hear_of_last(station, (None, change), now);
                return Ok(Answer::Line(noted.ok_or(Refusal::Pick(PickRefusal::NothingThere(station)))??));
            }
        }
        Ok(Answer::Done)
    }

    /// Takes in a report about a line. The visit ends with its last line. If a button confirms what the hand has just
    /// confirmed, that counts once.
    fn hear_of_line(
        &mut self,
        station: StationId,
        (line, change): (usize, LineChange),
        now: Time,
    ) -> Answered {
        let noted = if let Some(robot) = self.writer.floor().picked_from(station) {
            self.press(robot, station, (line, change), now)
        } else if let Some(noted) = self.hear_of_last(station, (Some(line), change), now) {
            noted
        } else {
            let (job, lines) = self
                .writer
                .visits
                .ended(station, now)
                .ok_or(Refusal::Pick(PickRefusal::NothingThere(station)))?;
            let is_so =
                |p: &LineProgress| p.state == LineState::Done && matches!(change, LineChange::Done(_));
            let noted = lines
                .all()
                .get(line)
                .filter(|p| is_so(p))
                .ok_or(Refusal::Pick(PickRefusal::NothingThere(station)))?;
            let LineProgress { state, pieces, .. } = *noted;
            let outcome = LineOutcome::Already;
            return Ok(Answer::Line(LineNoted { job, line, outcome, state, pieces }));
        };
        Ok(Answer::Line(noted?))
    }

    /// Takes in a button press for a line of the visit in progress. Pieces just confirmed by hand are not confirmed
    /// again.
    fn press(
        &mut self,
        robot: RobotId,
        station: StationId,
        (line, change): (usize, LineChange),
        now: Time,
    ) -> Result<LineNoted, Refusal> {
        let Some((job, lines)) = self.lines_under(robot) else {
            return self.change_line(robot, (line, change), ConfirmedBy::Button, now);
        };
        let LineChange::Done(pieces) = change else {
            return self.change_line(robot, (line, change), ConfirmedBy::Button, now);
        };
        let by_button = (ConfirmedBy::Button, pieces);
        let known = lines.all().get(line).map(|p| (p.state, p.pieces));
        if let Some((state, pieces)) = known
            && state == LineState::Lit
            && self.writer.visits.is_confirmed(station, (job, line), by_button, now)
        {
            return Ok(LineNoted { job, line, outcome: LineOutcome::Already, state, pieces });
        }
        let noted = self.change_line(robot, (line, change), ConfirmedBy::Button, now)?;
        if noted.outcome == LineOutcome::Changed {
            self.writer.visits.note_confirmed(station, (job, line), by_button, now);
        }
        Ok(noted)
    }

    /// Takes in a report about the line that was not confirmed when its rack left, if there is one: about the line with
    /// this number or, without a number, the lit one.
    fn hear_of_last(
        &mut self,
        station: StationId,
        (line, change): (Option<usize>, LineChange),
        now: Time,
    ) -> Option<Result<LineNoted, Refusal>> {
        let left = self.writer.ledger().unconfirmed.get(&station)?;
        let (job, line, mut lines) = (left.job, line.or(left.lines.lit())?, left.lines.clone());
        Some(lines.change(line, change).map_err(Refusal::from).map(|outcome| {
            if outcome == LineOutcome::Changed {
                self.writer.record(JobFact::LineChanged { job, line, change, at: now });
            }
            let LineProgress { state, pieces, .. } = lines.all()[line];
            LineNoted { job, line, outcome, state, pieces }
        }))
    }

    /// Settles the lines that are left of a visit: picked, as a person says, or short.
    fn settle_lines(&mut self, robot: RobotId, done: bool, now: Time) {
        let Some((job, lines)) = self.lines_under(robot) else { return };
        let left: Vec<_> =
            lines.all().iter().map(LineProgress::left).enumerate().filter(|(_, n)| *n > 0).collect();
        for (line, pieces) in left {
            let change = if done { LineChange::Done(pieces) } else { LineChange::Short };
            self.writer.record(JobFact::LineChanged { job, line, change, at: now });
        }
    }

    /// Ends the pick for a job that was cancelled: no person picks for it, so the robot need not wait.
    pub(crate) fn end_cancelled_pick(&mut self, robot: RobotId) {
        if self.writer.ledger().is_picked_from(robot) {
            self.writer.record(RouteFact::Acted { robot, serial: self.writer.ledger().chain(robot).first() });
            self.heard.left_early.push(robot);
        }
    }
}

//! Hands at work cells confirm lines, let a rack go at the last grasp, and are warned.
//!
//! Main function: `hear_hands`. A line is confirmed by a grasp in its slot and a stop in its tote, by a hand that was
//! seen all the way; what was not seen so, a button decides. No rack leaves while a hand is seen inside. Refuses: to
//! confirm by guessing.

use crate::cell::{DeskEvent, HandsSeen, LineChange, OrderLine, PickFace};
use crate::fleet::requests::intake::Intake;
use crate::fleet::requests::visit::OnVisit;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::io::{CellWarning, WrongReach};
use crate::fleet::state::job::JobState;
use crate::id::{Dense, RobotId, StationId};
use crate::time::Time;
use crate::warehouse::SlotName;

impl Intake<'_> {
    /// Takes in hands of a person in a workplace.
    pub(super) fn hear_hands(&mut self, seen: &HandsSeen, now: Time) {
        let station = seen.station;
        let known = station.ix() < self.core.warehouse().stations.len();
        if !known || !self.core.settings.flow.hears_hands() || seen.seen > now {
            return;
        }
        let visit = self.visit_at(station, now);
        let lit = visit.and_then(|v| self.lit(v)).and_then(|(_, line)| {
            let cell = self.core.warehouse().stations[station].cell.as_ref()?;
            Some((line.slot, cell.totes.iter().position(|t| t.name == line.tote)?))
        });
        let Some(face) = self.face(station, visit) else { return };
        let events = self.core.visits.desk(station).see(&face, lit, seen);
        for event in events {
            match event {
                DeskEvent::Grasped(slot) if lit.is_some_and(|(wanted, _)| wanted != slot) => {
                    self.warn(station, WrongReach::Slot(slot), (seen.seen, now));
                }
                DeskEvent::Grasped(_) => {}
                DeskEvent::Placed(slot, tote) => {
                    self.hear_of_piece(station, visit, (slot, tote, true), (seen.seen, now));
                }
                DeskEvent::Seems(slot, tote) => {
                    self.hear_of_piece(station, visit, (slot, tote, false), (seen.seen, now));
                }
                DeskEvent::AimsAt(slot) => self.warn(station, WrongReach::Slot(slot), (seen.seen, now)),
            }
        }
        self.let_go(station, &face, now);
    }

    /// The line that is lit in a visit, and its number.
    fn lit(&self, visit: OnVisit) -> Option<(usize, &OrderLine)> {
        let lines = self.core.ledger.jobs[&visit.job].lines_now()?;
        lines.lit().map(|n| (n, &lines.all()[n].line))
    }

    /// A piece from a slot was put into a tote: it confirms the line that wants it, of the rack that has left before
    /// that of the one that is here; if that is not sure, it is warned of a wrong tote alone.
    fn hear_of_piece(
        &mut self,
        station: StationId,
        visit: Option<OnVisit>,
        (slot, tote, is_sure): (SlotName, usize, bool),
        (seen, now): (Time, Time),
    ) {
        let name = self.core.warehouse().stations[station].cell.as_ref().map(|c| c.totes[tote].name.clone());
        let left = self.core.ledger.unconfirmed.get(&station).and_then(|u| {
            let n = u.lines.lit()?;
            Some((u.job, n, u.lines.all()[n].line.clone()))
        });
        let here = visit.and_then(|v| self.lit(v).map(|(n, line)| (v.job, n, line.clone())));
        let wanted = [left, here].into_iter().flatten().find(|(_, _, line)| line.slot == slot);
        let Some((job, line, order)) = wanted else { return };
        if name.as_ref() != Some(&order.tote) {
            return self.warn(station, WrongReach::Tote(tote), (seen, now));
        }
        if !is_sure {
            return;
        }
        if let Some(visit) = visit.filter(|v| v.job == job) {
            let _ = self.change_line(visit.robot, (line, LineChange::Done(1)), now);
        } else {
            self.core.record(Fact::LineChanged { job, line, change: LineChange::Done(1), at: now });
        }
    }

    /// Ends the visit whose last line is confirmed and whose rack was kept because of a hand; or whose last pieces are
    /// in hands that are out of the opening.
    fn let_go(&mut self, station: StationId, face: &PickFace, now: Time) {
        let Some(visit) = self.visit_at(station, now) else { return };
        if self.core.visits.desk(station).comes_inside(face, now) {
            return;
        }
        let job = &self.core.ledger.jobs[&visit.job];
        let Some(lines) = job.lines_now() else { return };
        if lines.are_over() {
            return self.end_pick(visit.robot, JobState::Done, now);
        }
        let leaves = self.core.settings.flow.leaves_at_last_grasp()
            && job.request.then.is_empty()
            && !self.core.ledger.unconfirmed.contains_key(&station);
        let Some(lit) = lines.lit().filter(|_| leaves) else { return };
        let lit = &lines.all()[lit];
        if lines.pieces_left() == lit.left()
            && self.core.visits.desk(station).in_hand(lit.line.slot) >= lit.left()
        {
            self.end_pick(visit.robot, JobState::Done, now);
        }
    }

    /// Lets racks go that were kept because of hands which are seen no more, and notes which robots must not move
    /// because of others.
    pub(super) fn let_kept_go(&mut self, now: Time) {
        self.core.visits.begin_hands();
        for station in self.core.visits.watched(now) {
            if self.core.visits.comes_inside(station, now) {
                let node = self.core.warehouse().stations[station].node;
                let ledger = &self.core.ledger;
                let moves = |r: &RobotId| {
                    ledger.chain(*r).visits().take(2).any(|v| v.node == node)
                        && !self.core.floor().is_picked_from(*r)
                };
                let robots: Vec<RobotId> = ledger.present().filter(moves).collect();
                self.core.visits.stop_at_hands(robots);
            }
        }
        for station in self.core.visits.kept() {
            if self.is_hand_inside(station, now) {
                continue;
            }
            self.core.visits.keep(station, false);
            let Some(visit) = self.visit_at(station, now) else { continue };
            if self.lines_under(visit.robot).is_some_and(|(_, lines)| lines.are_over()) {
                self.end_pick(visit.robot, JobState::Done, now);
            }
        }
    }

    fn warn(&mut self, station: StationId, wrong: WrongReach, (seen, now): (Time, Time)) {
        self.core.visits.note_warning(station, wrong, now);
        self.core.out.warnings.push(CellWarning { station, wrong, seen });
    }
}

//! Hands at work cells confirm lines, let a rack go at the last grasp, and are warned.
//!
//! Main function: `hear_hands`. A line is confirmed by a grasp in its slot and a stop in its tote, by a hand that was
//! seen all the way; otherwise a button decides. No rack leaves while a hand is seen inside. Refuses: to confirm by
//! guessing.

use crate::requests::intake::Intake;
use crate::requests::visit::OnVisit;
use crate::state::fact::JobFact;
use crate::state::floor::Floor;
use crate::state::io::{CellWarning, WrongReach};
use crate::state::job::JobState;
use crate::state::visits::ConfirmedBy;
use giveway_cell::{
    CellHandsEvent, CellHandsScene, HandsSeen, HeldPiece, LineChange, Lines, OrderLine, PickFace,
};
use giveway_floor::id::{Dense, JobId, NodeId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::SlotName;

/// How far the clocks of headsets may be ahead.
const AHEAD: Span = Span::from_millis(200);

/// How long after it is told to stop a robot brakes, seconds, and how far before an opening it stands so that its rack
/// is not in it, metres.
const BRAKES_AFTER_S: f64 = 0.3;
const STOPS_BEFORE_M: f64 = 1.2;
/// A robot that is held there stays so until it is farther away by this, metres.
const STAYS_M: f64 = 0.6;

/// A line that waits for a piece.
struct WaitingLine {
    job: JobId,
    line: usize,
    slot: SlotName,
    tote: usize,
}

impl Intake<'_> {
    /// Takes in the hands of a person in a workplace.
    pub(super) fn hear_hands(&mut self, seen: &HandsSeen, now: Time) {
        let station = seen.station;
        self.show_picker(seen);
        let known = station.ix() < self.writer.warehouse().stations.len();
        if !known || !self.writer.settings.flow.hears_hands() || seen.seen > now + AHEAD {
            return;
        }
        let visit = self.visit_at(station, now);
        let (lit, left) = (visit.and_then(|v| self.lit(station, v)), self.unconfirmed(station));
        let Some(face) = self.face(station, visit) else { return };
        let tote = lit.as_ref().or(left.as_ref()).map(|line| line.tote);
        let lit = lit.map(|line| line.slot);
        let model = self.writer.settings.picks.clone();
        let scene = CellHandsScene { face: &face, model: &model, lit, tote };
        let events = self.writer.visits.see(scene, seen);
        for event in events {
            match event {
                CellHandsEvent::Grasped(slot) if lit.is_some_and(|wanted| wanted != slot) => {
                    self.warn(seen, WrongReach::Slot(slot), now);
                }
                CellHandsEvent::Grasped(_) => {}
                CellHandsEvent::Placed(piece, tote) => self.hear_of_piece(seen, visit, (piece, tote), now),
                CellHandsEvent::AimsAt(slot) => self.warn(seen, WrongReach::Slot(slot), now),
            }
        }
        self.let_go(station, &face, now);
    }

    /// The line that is lit in a visit.
    fn lit(&self, station: StationId, visit: OnVisit) -> Option<WaitingLine> {
        self.writer.floor().lit_line(station, visit.job)
    }

    /// The line of the previous rack that is not confirmed yet.
    fn unconfirmed(&self, station: StationId) -> Option<WaitingLine> {
        self.writer.floor().unconfirmed_line(station)
    }

    /// Takes in a piece that was put into a tote: it confirms the line that waits for it, of the rack that is there or
    /// of the one before. If the piece is not sure, only a wrong tote is warned of.
    fn hear_of_piece(
        &mut self,
        seen: &HandsSeen,
        visit: Option<OnVisit>,
        (piece, tote): (HeldPiece, usize),
        now: Time,
    ) {
        let station = seen.station;
        let of_this = visit.filter(|_| !piece.is_of_before);
        let wanted = of_this.map_or_else(|| self.unconfirmed(station), |visit| self.lit(station, visit));
        let Some(wanted) = wanted.filter(|line| line.slot == piece.from) else { return };
        if wanted.tote != tote {
            return self.warn(seen, WrongReach::Tote(tote), now);
        }
        let WaitingLine { job, line, .. } = wanted;
        let by_hand = (ConfirmedBy::Hand, 1);
        if !piece.sure || self.writer.visits.is_confirmed(station, (job, line), by_hand, now) {
            return;
        }
        self.writer.visits.note_confirmed(station, (job, line), by_hand, now);
        let change = LineChange::Done(1);
        match of_this {
            Some(visit) => {
                let noted = self.change_line(visit.robot, (line, change), ConfirmedBy::Hand, now);
                debug_assert!(noted.is_ok(), "a lit line waits for a piece");
            }
            None => self.writer.record(JobFact::LineChanged { job, line, change, at: now }),
        }
    }

    /// Ends the visit if its last line is confirmed and its rack was kept because of a hand, or if its last pieces are
    /// in hands that are out of the opening.
    fn let_go(&mut self, station: StationId, face: &PickFace, now: Time) {
        let Some(visit) = self.visit_at(station, now) else { return };
        let visits = &mut self.writer.visits;
        if visits.hands_at(station).comes_inside(face, now)
            || visits.is_shared(station, now)
            || self.writer.arms.is_inside(station)
        {
            return;
        }
        // A hand that was last seen inside may still be there: then a button ends the visit.
        let may_be_inside = self.writer.visits.hands_at(station).may_be_inside(face);
        let ends_out = self.writer.floor().ends_out(&self.writer.ledger().jobs[&visit.job]);
        let (ledger, visits) = self.writer.ledger_and_visits();
        let Some(lines) = ledger.jobs[&visit.job].lines_now() else { return };
        if lines.are_over() && !may_be_inside {
            return self.end_pick(visit.robot, JobState::Done, now);
        }
        let leaves = ends_out && !may_be_inside && !ledger.unconfirmed.contains_key(&station);
        let Some(lit) = lines.lit().filter(|_| leaves) else { return };
        let lit = &lines.all()[lit];
        if lines.pieces_left() == lit.left() && visits.hands_at(station).in_hand(lit.line.slot) >= lit.left()
        {
            self.end_pick(visit.robot, JobState::Done, now);
        }
    }

    /// Lets racks go that were kept because of hands that are out now, and notes which robots must not move because of
    /// other hands.
    pub(super) fn let_kept_go(&mut self, now: Time) {
        let held = self.writer.visits.begin_hands();
        let mut at_hands = self.writer.visits.hands_inside(now);
        at_hands.extend(self.writer.arms.inside());
        if !at_hands.is_empty() {
            let stations = &self.writer.warehouse().stations;
            let nodes: Vec<(NodeId, StationId)> = at_hands.iter().map(|s| (stations[*s].node, *s)).collect();
            let floor = self.writer.floor();
            let comes = |r: RobotId| Some((r, floor.comes_to(r, &nodes, held.contains_key(&r))?));
            let robots: Vec<(RobotId, StationId)> =
                self.writer.ledger().present().filter_map(comes).collect();
            self.writer.visits.stop_at_hands(robots);
        }
        for station in self.writer.visits.kept() {
            if self.may_hand_be_inside(station, now) {
                continue;
            }
            self.writer.visits.keep(station, false);
            let Some(visit) = self.visit_at(station, now) else { continue };
            if self.lines_under(visit.robot).is_some_and(|(_, lines)| lines.are_over()) {
                self.end_pick(visit.robot, JobState::Done, now);
            }
        }
    }

    fn warn(&mut self, seen: &HandsSeen, wrong: WrongReach, now: Time) {
        let HandsSeen { station, person, seen, .. } = *seen;
        self.writer.visits.note_warning(station, wrong, now);
        self.writer.warn(CellWarning { station, person, wrong, seen });
    }
}

/// What a step would warn of if it took in these hands now.
pub(crate) fn warning_of(floor: Floor<'_>, seen: &HandsSeen, now: Time) -> Option<CellWarning> {
    let station = seen.station;
    if station.ix() >= floor.warehouse().stations.len() || !floor.settings.flow.hears_hands() {
        return None;
    }
    if seen.seen > now + AHEAD || !floor.visits.can_be_wrong(seen) {
        return None;
    }
    let job = floor.picked_from(station).and_then(|robot| floor.ledger.robots[robot].task.job());
    let lit = job.and_then(|job| floor.lit_line(station, job));
    let tote = lit.as_ref().map(|line| line.tote).or(floor.unconfirmed_line(station).map(|line| line.tote));
    let expected = (lit.map(|line| line.slot), tote);
    let wrong = match floor.visits.would_warn(&floor.settings.picks, expected, seen)? {
        CellHandsEvent::AimsAt(slot) | CellHandsEvent::Grasped(slot) => WrongReach::Slot(slot),
        CellHandsEvent::Placed(_, tote) => WrongReach::Tote(tote),
    };
    Some(CellWarning { station, person: seen.person, wrong, seen: seen.seen })
}

impl Floor<'_> {
    /// The station, among these with their nodes, at which a robot is that is not picked from, or to which it will have
    /// come unless it brakes now. A robot that is held already stays held a little farther away.
    fn comes_to(&self, robot: RobotId, nodes: &[(NodeId, StationId)], is_held: bool) -> Option<StationId> {
        let speed_mps = self.scene.robot(robot).map_or(0.0, |seen| seen.speed_mps);
        let loaded = self.ledger.rack_on(robot).is_some();
        let brakes_m = self.kinematics(robot).braking_m(speed_mps, loaded);
        let stops_before_m = STOPS_BEFORE_M + if is_held { STAYS_M } else { 0.0 };
        let reach_m = brakes_m + speed_mps * BRAKES_AFTER_S + stops_before_m;
        let (mut at, mut way_m) = (self.place_of(robot), 0.0);
        for (n, visit) in self.ledger.chain(robot).visits().enumerate() {
            // The robot has left the centre of the first node, or is there.
            if n > 0 {
                let next = self.warehouse().nodes[visit.node].at;
                (way_m, at) = (way_m + (next - at).norm(), next);
            }
            if n > 1 && way_m > reach_m {
                return None;
            }
            if let Some((_, station)) = nodes.iter().find(|(node, _)| *node == visit.node) {
                return Some(*station).filter(|_| !self.ledger.is_picked_from(robot));
            }
        }
        None
    }

    /// The line that is lit at a station in the visit for a job.
    fn lit_line(&self, station: StationId, job: JobId) -> Option<WaitingLine> {
        self.waiting(station, job, self.ledger.jobs.get(&job)?.lines_now()?)
    }

    /// The line at a station whose rack has left before it was confirmed.
    fn unconfirmed_line(&self, station: StationId) -> Option<WaitingLine> {
        let left = self.ledger.unconfirmed.get(&station)?;
        self.waiting(station, left.job, &left.lines)
    }

    fn waiting(&self, station: StationId, job: JobId, lines: &Lines) -> Option<WaitingLine> {
        let line = lines.lit()?;
        let OrderLine { slot, tote, .. } = &lines.all()[line].line;
        let cell = self.warehouse().stations[station].cell.as_ref()?;
        let tote = cell.totes.iter().position(|t| t.name == *tote)?;
        Some(WaitingLine { job, line, slot: *slot, tote })
    }
}

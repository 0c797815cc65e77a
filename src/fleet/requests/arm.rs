//! Robot arms at work cells take lines, pick them beside the hand, and give them back if something is wrong.
//!
//! Main functions: `hear_arm`, `move_arms`. A line for the arm alone waits for the arm; a line for either is the arm's
//! if the hand will not come to it before the arm is done. If an arm is silent, late, or reports a place to which it
//! cannot have come, it gets no trajectory and all its lines go to the hand, or else the visit would never end.
//! Refuses: to give the arm the line that is lit, and to count a piece that was not put down.

use crate::requests::intake::Intake;
use crate::requests::visit::OnVisit;
use crate::state::fact::JobFact;
use crate::state::visits::ConfirmedBy;
use giveway_cell::arm::{ArmDeed, ArmMode, ArmOrder, ArmSaid, ArmTask, Surroundings};
use giveway_cell::{LineChange, LineProgress, LineState, PickedBy};
use giveway_floor::id::{JobId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_people::reach::PickModel;

/// A line for either is the arm's if the arm needs at most this share of what the hand takes for its other lines.
const ENOUGH: f64 = 0.6;
/// A line for either goes back to the hand if the visit would end sooner by this, seconds.
const GAINS_S: f64 = 1.5;
/// How long the arm takes at least from before a slot to the tote, seconds.
const AT_LEAST_S: f64 = 4.0;
/// A hand that has been out for less than this is about to be in again.
const OUT_FOR: Span = Span::from_millis(200);

impl Intake<'_> {
    /// Takes in an arm's report.
    pub(super) fn hear_arm(&mut self, said: &ArmSaid, now: Time) {
        let station = said.station;
        let Some(post) = self.writer.arms.post(station) else {
            return tracing::warn!(?station, "a report from an arm that is not known");
        };
        let Some(deed) = post.arm.hear(now, said) else { return };
        let Some((job, line)) = post.line else { return };
        let spent_s = (now - std::mem::replace(&mut post.piece_since, now)).as_secs_f64();
        self.writer.visits.learn_arm(station, spent_s);
        if deed == ArmDeed::FoundNothing || post.arm.task().is_none() {
            post.line = None;
        }
        if deed == ArmDeed::FoundNothing {
            post.left.push((job, line));
        }
        let visit = self.visit_at(station, now).filter(|visit| visit.job == job);
        let Some(visit) = visit.filter(|_| self.is_arms(job, line)) else { return };
        match deed {
            ArmDeed::Placed => {
                let noted =
                    self.change_line(visit.robot, (line, LineChange::Done(1)), ConfirmedBy::Hand, now);
                debug_assert!(noted.is_ok(), "the arm's line waits for a piece");
            }
            ArmDeed::FoundNothing => self.give_to(LineChange::ToHand, job, line, now),
        }
    }

    /// Lets every arm decide what it does next. Only stations with an arm cost anything.
    pub(super) fn move_arms(&mut self, now: Time) {
        for station in self.writer.arms.stations() {
            let visit = self.visit_at(station, now);
            self.withdraw(station, visit, now);
            if let Some(visit) = visit {
                self.share_lines(station, visit, now);
            }
            self.move_arm(station, visit, now);
        }
    }

    /// Whether a line of the visit in progress is the arm's.
    fn is_arms(&self, job: JobId, line: usize) -> bool {
        let lines = self.writer.ledger().jobs.get(&job).and_then(|job| job.lines_now());
        lines.and_then(|lines| lines.all().get(line)).is_some_and(|p| p.state == LineState::Arm)
    }

    fn give_to(&mut self, change: LineChange, job: JobId, line: usize, now: Time) {
        self.writer.record(JobFact::LineChanged { job, line, change, at: now });
    }

    /// Takes from the arm a task whose visit or line is over, or which the arm cannot do.
    fn withdraw(&mut self, station: StationId, visit: Option<OnVisit>, now: Time) {
        let Some(post) = self.writer.arms.post(station) else { return };
        let gives_up = post.arm.gives_up();
        let spent_s = (now - post.piece_since).as_secs_f64();
        let troubled = post.arm.trouble(now).is_some();
        if visit.is_none() {
            post.left.clear();
        }
        let Some((job, line)) = post.line else { return };
        if gives_up {
            post.left.push((job, line));
            self.writer.visits.learn_arm(station, spent_s);
        }
        let is_on = visit.is_some_and(|visit| visit.job == job) && self.is_arms(job, line);
        if gives_up || troubled || !is_on {
            let post = self.writer.arms.post(station).expect("it is there");
            post.line = None;
            post.arm.drop_task();
        }
    }

    /// Decides which lines of a visit are the arm's. Lines that the arm cannot pick are the hand's.
    fn share_lines(&mut self, station: StationId, visit: OnVisit, now: Time) {
        let Some(face) = self.face(station, Some(visit)) else { return };
        let Some((_, lines)) = self.lines_under(visit.robot) else { return };
        let lines = lines.clone();
        let was_heard = self.writer.arms.post(station).is_some_and(|post| post.arm.was_heard());
        if !was_heard && lines.all().iter().all(|p| p.state != LineState::Arm) {
            return;
        }
        let tote = |name: &str| {
            let cell = self.writer.warehouse().stations[station].cell.as_ref()?;
            cell.totes.iter().position(|t| t.name == name)
        };
        let totes: Vec<Option<usize>> = lines.all().iter().map(|p| tote(&p.line.tote)).collect();
        let visits = &self.writer.visits;
        let hand_s = visits.hand_s(visit.job, &self.writer.ledger().jobs[&visit.job], now).unwrap_or(0.0);
        let takes = |p: &LineProgress| {
            let (line_s, arm_piece_s) = visits.line_s(station, p.left());
            TakenBy { hand_s, line_s, arm_piece_s }
        };
        let takes: Vec<TakenBy> = lines.all().iter().map(takes).collect();
        let Some(post) = self.writer.arms.post(station) else { return };
        post.arm.turn_to(&face);
        let is_well = post.arm.was_heard() && post.arm.trouble(now).is_none();
        let mut reaches = |n: usize| {
            let tote = totes[n].filter(|_| is_well && !post.left.contains(&(visit.job, n)));
            tote.map_or(Some(false), |tote| post.arm.reaches(lines.all()[n].line.slot, tote))
        };
        let at = |n: &usize| lines.all()[*n].state == LineState::Arm;
        let arms: Vec<usize> = (0..lines.all().len()).filter(at).collect();
        let reached: Vec<(usize, Option<bool>)> = arms.into_iter().map(|n| (n, reaches(n))).collect();
        let mut back: Vec<usize> =
            reached.iter().filter(|(_, r)| *r == Some(false)).map(|(n, _)| *n).collect();
        let mine = reached.iter().find(|(_, r)| *r == Some(true)).map(|(n, _)| *n);
        let chosen = mine.or_else(|| {
            let fits = |n: &usize| is_for_arm(&lines.all()[*n], takes[*n]) && reaches(*n) == Some(true);
            (0..lines.all().len()).rev().find(fits)
        });
        // A person may be there whose hands are not seen.
        let is_clear = post.sight.is_fresh(now) || lines.lit().is_none();
        let begins = chosen.filter(|_| is_well && is_clear && post.line.is_none() && post.arm.is_free());
        if let Some(n) = begins {
            let p = &lines.all()[n];
            let tote = totes[n].expect("the arm reaches it");
            post.arm.begin(ArmTask { slot: p.line.slot, tote, pieces: p.left() });
            (post.line, post.piece_since) = (Some((visit.job, n)), now);
        }
        // The hand may be sooner at a line that the arm has not reached yet.
        let own = post.line.filter(|(job, _)| *job == visit.job && begins.is_none() && post.arm.can_leave());
        let spent_s = (now - post.piece_since).as_secs_f64();
        let sooner = |n: &usize| is_sooner_by_hand(&lines.all()[*n], takes[*n], spent_s) && !back.contains(n);
        if let Some(n) = own.map(|(_, n)| n).filter(sooner) {
            post.left.push((visit.job, n));
            back.push(n);
        }
        let taken = begins.filter(|n| lines.all()[*n].state != LineState::Arm);
        back.into_iter().for_each(|n| self.give_to(LineChange::ToHand, visit.job, n, now));
        if let Some(n) = taken {
            self.give_to(LineChange::ToArm, visit.job, n, now);
        }
    }

    fn move_arm(&mut self, station: StationId, visit: Option<OnVisit>, now: Time) {
        let Some(face) = self.face(station, visit) else { return };
        let mode = self.writer.settings.arm_mode;
        let is_inside =
            mode == ArmMode::Turns && self.writer.visits.hands_at(station).comes_inside(&face, now);
        let Some(post) = self.writer.arms.post(station) else { return };
        if is_inside {
            post.hand_inside = now;
        }
        let holds = mode == ArmMode::Turns && now - post.hand_inside < OUT_FOR;
        if !post.arm.is_due() {
            return;
        }
        let model = (mode == ArmMode::Predictive).then(PickModel::builtin);
        let picker = post.sight.ahead(&face, now, model.as_deref());
        let line = post.line;
        let order = post.arm.cycle(now, Surroundings { picker: picker.as_ref(), holds });
        self.writer.move_arm(order.map(|order| ArmOrder { line, ..order }));
    }

    /// Takes a silent arm to be out of the rack, since a person lets the rack go.
    pub(super) fn vouch_for_arm(&mut self, station: StationId, now: Time) {
        if let Some(post) = self.writer.arms.post(station).filter(|post| post.arm.trouble(now).is_some()) {
            post.arm.vouch_outside();
        }
    }

    /// Notes what was seen of a picker beside an arm.
    pub(super) fn show_picker(&mut self, seen: &giveway_cell::HandsSeen) {
        if let Some(post) = self.writer.arms.post(seen.station) {
            post.sight.see(seen);
        }
    }
}

/// How long hand and arm take, seconds.
#[derive(Clone, Copy)]
struct TakenBy {
    /// How long the hand takes for all its lines.
    hand_s: f64,
    /// How long the hand takes for this line.
    line_s: f64,
    /// How long the arm takes for a piece.
    arm_piece_s: f64,
}

/// Whether the arm would be done with a line for either before the hand is done with the others.
fn is_for_arm(line: &LineProgress, takes: TakenBy) -> bool {
    let is_open = matches!(line.state, LineState::Open | LineState::Undone);
    let is_soon = |t: TakenBy| t.arm_piece_s * f64::from(line.left()) <= ENOUGH * (t.hand_s - t.line_s);
    is_open && line.line.by == PickedBy::Either && is_soon(takes)
}

/// Whether the visit ends sooner if the hand picks the line at which the arm has been for this long.
fn is_sooner_by_hand(line: &LineProgress, takes: TakenBy, spent_s: f64) -> bool {
    let is_sooner = |t: TakenBy| {
        let arm_s = (t.arm_piece_s * f64::from(line.left()) - spent_s).max(AT_LEAST_S);
        t.hand_s + t.line_s + GAINS_S < arm_s.max(t.hand_s)
    };
    line.line.by == PickedBy::Either && line.state == LineState::Arm && is_sooner(takes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_cell::{Lines, OrderLine};

    fn line(state: LineState, quantity: u32, by: PickedBy) -> LineProgress {
        let slot = "A1".parse().expect("a slot");
        let mut lines = Lines::new([OrderLine { slot, quantity, tote: "A".into(), item: None, by }]);
        if state == LineState::Arm {
            lines.change(0, LineChange::ToArm).expect("it may be the arm's");
        }
        LineProgress { state, ..lines.all()[0].clone() }
    }

    fn takes(hand_s: f64) -> TakenBy {
        TakenBy { hand_s, line_s: 4.0, arm_piece_s: 9.0 }
    }

    #[test]
    fn a_line_is_the_arms_only_if_the_hand_takes_longer_for_the_others() {
        let open = line(LineState::Open, 1, PickedBy::Either);
        assert!(is_for_arm(&open, takes(20.0)) && !is_for_arm(&open, takes(18.0)));
        assert!(
            !is_for_arm(&line(LineState::Open, 2, PickedBy::Either), takes(20.0)),
            "two pieces take longer"
        );
        assert!(!is_for_arm(&line(LineState::Open, 1, PickedBy::Hand), takes(60.0)));
        assert!(!is_for_arm(&line(LineState::Lit, 1, PickedBy::Either), takes(60.0)));
    }

    #[test]
    fn a_line_goes_back_to_the_hand_that_would_be_sooner_but_not_the_arms_own() {
        let arms = line(LineState::Arm, 1, PickedBy::Either);
        assert!(is_sooner_by_hand(&arms, takes(0.0), 1.0), "the hand has nothing else to do");
        assert!(!is_sooner_by_hand(&arms, takes(0.0), 6.0), "the arm is nearly done");
        assert!(!is_sooner_by_hand(&arms, takes(9.0), 1.0), "the hand has enough to do");
        assert!(!is_sooner_by_hand(&line(LineState::Arm, 1, PickedBy::Arm), takes(0.0), 1.0));
    }
}

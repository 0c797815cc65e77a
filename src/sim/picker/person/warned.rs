//! How a picker reacts to warnings, and what the warnings are worth.
//!
//! A warning is right if it names the place where a hand truly is or goes, or was heading a moment ago, and that place
//! is a wrong one. Refuses: to act on a warning before it has come, and on one that is not right.

use super::{Next, SimPicker};
use crate::picker::work::LineWork;
use giveway_fleet::WrongReach;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::SlotName;

/// Reaction time of a warned person, seconds; then the share of people who react.
const REACTS_S: f64 = 0.25;
const REACTS: f64 = 0.95;
/// A warning this soon after a hand was astray is about that.
const ASTRAY: Span = Span::from_secs(1);

impl SimPicker {
    /// Adds a warning that the screen will show at `at`.
    pub fn warn(&mut self, at: Time, wrong: WrongReach) {
        self.warnings.push((at, wrong));
    }

    /// Takes the next warning, or acts on one, if that is due by `until`. Gives whether one of them happened.
    pub(super) fn is_warned_until(&mut self, until: Time) -> bool {
        let next = self.warnings.iter().map(|(at, _)| *at).min().filter(|at| *at <= until);
        let acts = self.react.map(|(at, _)| at).filter(|at| *at <= until);
        if let Some(at) = acts.filter(|acts| next.is_none_or(|next| *acts <= next)) {
            let (_, wrong) = self.react.take().expect("it was just seen");
            self.mend(at, wrong);
            return true;
        }
        let Some(i) = self.warnings.iter().position(|(at, _)| Some(*at) == next) else { return false };
        let (at, wrong) = self.warnings.remove(i);
        self.hear(at, wrong);
        true
    }

    fn hear(&mut self, now: Time, wrong: WrongReach) {
        let is_right = self.is_wrong(now, wrong);
        self.figures.note_warning(wrong, is_right, self.work.as_mut(), now);
        if is_right && self.react.is_none() && self.random.happens_of(REACTS) {
            self.react = Some((now + Span::from_secs_f64(REACTS_S), wrong));
        }
    }

    /// Whether a hand is wrong at the place that a warning names.
    fn is_wrong(&self, now: Time, warned: WrongReach) -> bool {
        let was_there = self.astray.is_some_and(|(at, wrong)| wrong == warned && now - at < ASTRAY);
        was_there
            || match warned {
                WrongReach::Slot(slot) => self.is_at_wrong(slot, now),
                WrongReach::Tote(tote) => self.is_wrong_tote(tote),
            }
    }

    /// Whether a hand wrongly goes to this slot or is in it.
    fn is_at_wrong(&self, slot: SlotName, now: Time) -> bool {
        let Some(work) = self.work.as_ref().filter(|w| w.line.slot != slot) else { return false };
        let is_in = || self.hands.iter().any(|hand| self.face.slot_at(hand.at(now)) == Some(slot));
        work.aims_at == slot || self.next == Next::PutBack(slot) || is_in()
    }

    /// Whether a piece is wrongly in this tote, or about to be.
    fn is_wrong_tote(&self, tote: usize) -> bool {
        match (self.next, &self.work) {
            (Next::Over(to) | Next::Put(to), Some(work)) => to == tote && to != work.line.tote,
            _ => self.figures.is_misplaced(tote, self.work.as_ref(), self.claim.map(|c| (c.job, c.n))),
        }
    }

    /// Counts a reach to a wrong slot that was warned of, with when the hand passed the face and reached the piece, or
    /// would have.
    pub(super) fn note_lead(&mut self, now: Time) {
        let ends = [self.passes_face(), self.is_at_piece()].map(|at| at.unwrap_or(now));
        let wrong = self.work.as_mut().filter(|w| w.aims_at != w.line.slot);
        if let Some(work) = wrong {
            self.figures.note_lead_of(work, ends);
        }
    }

    /// Acts on a warning, unless it is too late.
    fn mend(&mut self, at: Time, wrong: WrongReach) {
        match (wrong, self.next) {
            (WrongReach::Slot(_), Next::Enter | Next::Out) => self.mend_reach(at),
            (WrongReach::Slot(_), Next::Over(_)) => self.mend_grasp(at),
            (WrongReach::Tote(_), Next::Over(tote) | Next::Put(tote)) => {
                let right = self.work.as_ref().expect("a piece is in hand").line.tote;
                if tote != right {
                    self.astray = Some((at, WrongReach::Tote(tote)));
                    self.carry(at, right);
                }
            }
            (
                WrongReach::Tote(tote),
                Next::Look | Next::SetOut(_) | Next::Enter | Next::Redirect(_) | Next::Press(_),
            ) => self.mend_put(at, tote),
            _ => {}
        }
    }

    /// Redirects a hand that goes to a wrong slot, or searches it, to the right one.
    fn mend_reach(&mut self, at: Time) {
        let Some(work) = self.work.as_ref().filter(|w| w.aims_at != w.line.slot) else { return };
        let (wrong, slot) = (work.aims_at, work.line.slot);
        self.note_lead(at);
        self.astray = Some((at, WrongReach::Slot(wrong)));
        self.aim(at, slot);
    }

    /// Puts a wrong piece back, and fetches the right one.
    fn mend_grasp(&mut self, at: Time) {
        let Some(work) = self.work.as_mut().filter(|w| w.aims_at != w.line.slot) else { return };
        work.drop_pieces();
        let wrong = std::mem::replace(&mut work.aims_at, work.line.slot);
        self.astray = Some((at, WrongReach::Slot(wrong)));
        self.put_back(at, wrong);
    }

    /// Takes a piece out of a wrong tote again.
    fn mend_put(&mut self, at: Time, tote: usize) {
        let is_there = |w: &&mut LineWork| w.misplaced == Some(tote);
        if self.work.as_mut().filter(is_there).is_none() {
            // A person who has begun another line leaves the piece there.
            let done = self.figures.finished.take_if(|w| self.work.is_none() && is_there(&w));
            let Some(done) = done else { return };
            self.work = Some(done);
        }
        self.claim = None;
        self.astray = Some((at, WrongReach::Tote(tote)));
        self.fetch(at, tote);
    }
}

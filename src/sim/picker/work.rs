//! What truly happens to a line that a simulated person picks.
//!
//! Main types: [`LineWork`] (the line in hand), [`PickFigures`] (the truth about all lines). Refuses: to ask the fleet.

use super::screen::ShownLine;
use giveway_fleet::WrongReach;
use giveway_floor::id::JobId;
use giveway_floor::time::Time;
use giveway_floor::warehouse::SlotName;
use std::collections::BTreeMap;

/// A line in progress.
#[derive(Clone, Debug)]
pub struct LineWork {
    /// The line as the screen showed it when it began.
    pub line: ShownLine,
    /// Whether both hands pick.
    pub both_hands: bool,
    /// The slot that the hand goes to.
    pub aims_at: SlotName,
    /// The wrong tote that the last piece was put into, if any.
    pub misplaced: Option<usize>,
    /// When a warning about the present reach came.
    warned: Option<Time>,
    is_missing: bool,
    in_hand: u32,
    /// Whether the pieces in hand come from a wrong slot.
    is_wrong: bool,
    put: u32,
}

/// True contents of the totes for one line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrueLine {
    /// Right pieces in the right tote.
    pub right: u32,
    /// Wrong pieces, or pieces in a wrong tote.
    pub wrong: u32,
    /// Whether a button was pressed for the line.
    pub is_pressed: bool,
}

/// How long before a hand was in a wrong slot a warning came; negative if it came later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarnedLead {
    /// Time before the finger tips passed the rack's face, seconds.
    pub face_s: f64,
    /// Time before the finger tips came to rest at the piece, seconds.
    pub piece_s: f64,
}

/// True figures of one station.
#[derive(Clone, Debug, Default)]
pub struct PickFigures {
    /// Lines that were picked, with the contents of the totes.
    pub lines: BTreeMap<(JobId, usize), TrueLine>,
    /// The last line with all its pieces put down, until another one begins.
    pub finished: Option<LineWork>,
    /// Reaches to a wrong slot.
    pub wrong: u64,
    /// Reaches to a wrong slot with a warning before the piece was out.
    pub wrong_warned: u64,
    /// For each reach to a wrong slot with a warning: how early the warning came.
    pub warned_leads: Vec<WarnedLead>,
    /// Pieces put into a wrong tote.
    pub wrong_totes: u64,
    /// Pieces put into a wrong tote with a warning.
    pub wrong_totes_warned: u64,
    /// Whether there was a warning about the tote of the last piece.
    tote_is_warned: bool,
    /// Warnings about a right place, or about another place than the wrong one.
    pub false_warnings: u64,
    /// Racks that left while pieces were still to be taken from them.
    pub dismissed_early: u64,
    /// How often a button was pressed.
    pub presses: u64,
    /// How often a button was pressed to release a rack with nothing left to pick.
    pub released: u64,
}

impl LineWork {
    /// A line that begins. `is_missing` says whether its slot has one piece too few.
    pub fn new(line: ShownLine, is_missing: bool, both_hands: bool) -> LineWork {
        LineWork {
            aims_at: line.slot,
            line,
            // An empty hand does not go to the tote.
            both_hands: both_hands && line.left >= 2 + u32::from(is_missing),
            misplaced: None,
            warned: None,
            is_missing,
            in_hand: 0,
            is_wrong: false,
            put: 0,
        }
    }

    /// Whether the slot has no more pieces for this line.
    pub fn finds_nothing(&self) -> bool {
        self.is_missing && self.aims_at == self.line.slot && self.put + 1 == self.line.left
    }

    /// Takes as many pieces as the hands can hold.
    pub fn grasp(&mut self) {
        let left = self.line.left - self.put - u32::from(self.is_missing);
        self.in_hand = if self.both_hands { left.clamp(1, 2) } else { 1 };
        self.is_wrong = self.aims_at != self.line.slot;
    }

    /// Puts the pieces in hand back.
    pub fn drop_pieces(&mut self) {
        (self.in_hand, self.is_wrong) = (0, false);
    }

    /// How many pieces are put down.
    pub fn put(&self) -> u32 {
        self.put
    }

    /// Whether all pieces are put down, as far as the person knows.
    pub fn is_filled(&self) -> bool {
        self.put >= self.line.left
    }
}

impl PickFigures {
    /// Counts a reach to a wrong slot.
    pub fn begin_wrong(&mut self, work: &mut LineWork) {
        work.warned = None;
        self.wrong += 1;
    }

    /// Takes a warning. `is_right` says whether it names a place where the hand wrongly is or goes.
    pub fn note_warning(
        &mut self,
        wrong: WrongReach,
        is_right: bool,
        work: Option<&mut LineWork>,
        now: Time,
    ) {
        match (wrong, work) {
            _ if !is_right => self.false_warnings += 1,
            (WrongReach::Slot(slot), Some(work))
                if work.aims_at == slot && slot != work.line.slot && work.in_hand == 0 =>
            {
                if work.warned.is_none() {
                    self.wrong_warned += 1;
                }
                work.warned = work.warned.or(Some(now));
            }
            (WrongReach::Slot(_), _) => {}
            (WrongReach::Tote(_), _) if !std::mem::replace(&mut self.tote_is_warned, true) => {
                self.wrong_totes_warned += 1;
            }
            (WrongReach::Tote(_), _) => {}
        }
    }

    /// Whether the piece put down last for a line went into this tote, which is a wrong one.
    pub fn is_misplaced(&self, tote: usize, work: Option<&LineWork>, claim: Option<(JobId, usize)>) -> bool {
        let of = |w: &LineWork| w.misplaced == Some(tote);
        let done = self.finished.as_ref().filter(|w| claim == Some((w.line.job, w.line.n)));
        work.is_some_and(of) || done.is_some_and(of)
    }

    /// Counts the warning of a reach to a wrong slot, if one came, with how long it came before two instants: when the
    /// finger tips passed the rack's face, and when they came to rest at the piece, or would have.
    pub fn note_lead_of(&mut self, work: &mut LineWork, [passes, arrives]: [Time; 2]) {
        let lead = |warned: Time| WarnedLead {
            face_s: (passes - warned).as_secs_f64(),
            piece_s: (arrives - warned).as_secs_f64(),
        };
        self.warned_leads.extend(work.warned.take().map(lead));
    }

    /// Counts pieces on their way to a tote, which may be a wrong one.
    pub fn carry(&mut self, is_wrong: bool) {
        self.wrong_totes += u64::from(is_wrong);
        self.tote_is_warned = false;
    }

    /// Counts pieces put into a tote.
    pub fn put(&mut self, work: &mut LineWork, tote: usize) {
        let line = self.lines.entry((work.line.job, work.line.n)).or_default();
        let is_right = !work.is_wrong && tote == work.line.tote;
        *(if is_right { &mut line.right } else { &mut line.wrong }) += work.in_hand;
        work.put += work.in_hand;
        work.both_hands &= work.put + 1 < work.line.left;
        work.misplaced = (tote != work.line.tote).then_some(tote);
        work.in_hand = 0;
        self.finished = None;
    }

    /// Counts a piece taken out of a wrong tote again.
    pub fn take_up(&mut self, work: &mut LineWork, from: usize) {
        if work.misplaced == Some(from) {
            let line = self.lines.entry((work.line.job, work.line.n)).or_default();
            line.wrong = line.wrong.saturating_sub(1);
            (work.in_hand, work.put, work.misplaced) = (1, work.put - 1, None);
        }
    }
}

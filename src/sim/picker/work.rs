//! What truly becomes of a line that a simulated person picks.
//!
//! Main types: [`LineWork`] (the line in hand), [`PickFigures`] (the truth about all of them). Refuses: to ask the
//! fleet.

use super::screen::ShownLine;
use giveway_fleet::WrongReach;
use giveway_floor::id::JobId;
use giveway_floor::time::Time;
use giveway_floor::warehouse::SlotName;
use std::collections::BTreeMap;

/// A line that is picked.
#[derive(Clone, Debug)]
pub struct LineWork {
    /// As it was on the screen when it began.
    pub line: ShownLine,
    /// Whether both hands pick.
    pub both_hands: bool,
    /// Where the hand goes.
    pub aims_at: SlotName,
    /// The tote where a piece was put last that belongs elsewhere.
    pub misplaced: Option<usize>,
    /// When a warning about the present reach came.
    warned: Option<Time>,
    is_missing: bool,
    in_hand: u32,
    /// Whether these are of a wrong slot.
    is_wrong: bool,
    put: u32,
}

/// What is truly in totes for a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrueLine {
    /// Right pieces in the right tote.
    pub right: u32,
    /// Wrong pieces, or pieces in a wrong tote.
    pub wrong: u32,
    /// Whether a button was pressed for it.
    pub is_pressed: bool,
}

/// How long before a hand was in a wrong slot a warning came; less than 0 after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarnedLead {
    /// Before the finger tips passed the rack's face, seconds.
    pub face_s: f64,
    /// Before they came to rest at the piece, seconds.
    pub piece_s: f64,
}

/// What truly happened at one station.
#[derive(Clone, Debug, Default)]
pub struct PickFigures {
    /// Lines that were picked, with what is in the totes.
    pub lines: BTreeMap<(JobId, usize), TrueLine>,
    /// The line whose pieces were all put down last, as long as nothing else was begun.
    pub finished: Option<LineWork>,
    /// Reaches to a wrong slot, and those of them that were warned of before the piece was out.
    pub wrong: u64,
    /// Those of them.
    pub wrong_warned: u64,
    /// How long before a hand was in a wrong slot the warning of that came.
    pub warned_leads: Vec<WarnedLead>,
    /// Pieces put into a wrong tote, and those of them that were warned of.
    pub wrong_totes: u64,
    /// Those of them.
    pub wrong_totes_warned: u64,
    /// Whether the tote of the last piece was warned of.
    tote_is_warned: bool,
    /// Warnings of what was right, or of another place than the wrong one.
    pub false_warnings: u64,
    /// Racks that left while pieces were still to be taken from them.
    pub dismissed_early: u64,
    /// How often a button was pressed.
    pub presses: u64,
    /// How often it was pressed to let a rack go of which nothing was left to pick.
    pub released: u64,
}

impl LineWork {
    /// A line that is begun. `is_missing` says whether its slot has one piece too few.
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

    /// Whether the slot has no more pieces.
    pub fn finds_nothing(&self) -> bool {
        self.is_missing && self.aims_at == self.line.slot && self.put + 1 == self.line.left
    }

    /// Takes what the hands can hold.
    pub fn grasp(&mut self) {
        let left = self.line.left - self.put - u32::from(self.is_missing);
        self.in_hand = if self.both_hands { left.clamp(1, 2) } else { 1 };
        self.is_wrong = self.aims_at != self.line.slot;
    }

    /// What is in the hands goes back.
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
    /// A reach to a wrong slot begins.
    pub fn begin_wrong(&mut self, work: &mut LineWork) {
        work.warned = None;
        self.wrong += 1;
    }

    /// A warning came. `is_right` says whether it names the place where the hand is, or goes, and should not.
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

    /// The warning of a reach to a wrong slot, if one came, is counted with how long before two instants it came: when
    /// the finger tips passed the rack's face, and when they came to rest at the piece, or would have.
    pub fn note_lead_of(&mut self, work: &mut LineWork, [passes, arrives]: [Time; 2]) {
        let lead = |warned: Time| WarnedLead {
            face_s: (passes - warned).as_secs_f64(),
            piece_s: (arrives - warned).as_secs_f64(),
        };
        self.warned_leads.extend(work.warned.take().map(lead));
    }

    /// Pieces are carried to a tote, which may be a wrong one.
    pub fn carry(&mut self, is_wrong: bool) {
        self.wrong_totes += u64::from(is_wrong);
        self.tote_is_warned = false;
    }

    /// Pieces are put into a tote.
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

    /// A piece is taken out of a wrong tote again.
    pub fn take_up(&mut self, work: &mut LineWork, from: usize) {
        if work.misplaced == Some(from) {
            let line = self.lines.entry((work.line.job, work.line.n)).or_default();
            line.wrong = line.wrong.saturating_sub(1);
            (work.in_hand, work.put, work.misplaced) = (1, work.put - 1, None);
        }
    }
}

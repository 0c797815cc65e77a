//! Order lines of one visit: which one is lit, and what was confirmed of each.
//!
//! Main type: [`Lines`]. A line is open until it is lit, and lit until all its pieces are confirmed or it is short; an
//! undo makes it undone, and it is lit again after the lines before it. A line that the robot arm picks is not lit
//! until it is given back to the hand. Refuses: to confirm more pieces than were ordered, and to confirm a line twice.

use super::{OrderLine, PickedBy};

/// The state of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineState {
    /// No piece has been picked yet.
    Open,
    /// The line is being picked now.
    Lit,
    /// All pieces are in the tote.
    Done,
    /// Pieces are missing from the slot; those that were there are in the tote.
    Short,
    /// The line was done or short, and that was undone: it must be picked again.
    Undone,
    /// The robot arm picks the line.
    Arm,
}

impl LineState {
    /// Whether no more pieces need to be picked.
    pub fn is_over(self) -> bool {
        matches!(self, LineState::Done | LineState::Short)
    }

    /// The word for the state on the wire.
    pub fn word(self) -> &'static str {
        match self {
            LineState::Open => "open",
            LineState::Lit => "lit",
            LineState::Done => "done",
            LineState::Short => "short",
            LineState::Undone => "undone",
            LineState::Arm => "arm",
        }
    }
}

/// A statement about a line, by a button, a scanner, a scale, the hand or the robot arm; and who picks it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineChange {
    /// This number of further pieces is in the tote.
    Done(u32),
    /// The slot has no more pieces.
    Short,
    /// Earlier statements are undone: no piece counts.
    Undo,
    /// The robot arm picks the line from now on.
    ToArm,
    /// The hand picks the line from now on.
    ToHand,
}

/// The result of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineOutcome {
    /// The line has changed.
    Changed,
    /// The line was in that state already, and nothing was counted again.
    Already,
}

/// Why a change is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineRefusal {
    /// The visit has no line with this number; the value is the number of its lines.
    NoLine(usize),
    /// A confirmation must be of at least one piece.
    NoPieces,
    /// There are more pieces than are left to pick; the value is the number left.
    TooMany(u32),
}

/// One line and its progress.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LineProgress {
    /// What was ordered.
    pub line: OrderLine,
    /// The state of the line.
    pub state: LineState,
    /// Pieces in the tote.
    pub pieces: u32,
}

impl LineProgress {
    /// Number of pieces still to be picked; zero when the line is over.
    pub fn left(&self) -> u32 {
        if self.state.is_over() { 0 } else { self.line.quantity - self.pieces }
    }

    /// Whether a hand has something to pick from the line.
    fn is_by_hand(&self) -> bool {
        !self.state.is_over() && self.state != LineState::Arm
    }
}

/// The lines of a visit, in the order in which they are lit.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Lines {
    all: Vec<LineProgress>,
}

impl Lines {
    /// The lines of a visit that begins: the first line that a hand may pick is lit.
    pub fn new(lines: impl IntoIterator<Item = OrderLine>) -> Lines {
        let open = |line: OrderLine| {
            let state = if line.by == PickedBy::Arm { LineState::Arm } else { LineState::Open };
            LineProgress { line, state, pieces: 0 }
        };
        let mut lines = Lines { all: lines.into_iter().map(open).collect() };
        lines.light();
        lines
    }

    /// Restores saved lines; nothing if they contradict themselves: more pieces than ordered, a line that is done with
    /// pieces left, or none or several lit while a hand has something to pick.
    pub fn restore(all: Vec<LineProgress>) -> Option<Lines> {
        let sound = |p: &LineProgress| {
            p.pieces <= p.line.quantity && (p.state == LineState::Done) == (p.pieces == p.line.quantity)
        };
        let lines = Lines { all };
        let lit = lines.all.iter().filter(|p| p.state == LineState::Lit).count();
        let is_by_hand = lines.all.iter().any(LineProgress::is_by_hand);
        (lines.all.iter().all(sound) && lit == usize::from(is_by_hand)).then_some(lines)
    }

    /// All lines, in their order.
    pub fn all(&self) -> &[LineProgress] {
        &self.all
    }

    /// The line that is picked by hand now, counted from 0; nothing where all others are over or the arm's.
    pub fn lit(&self) -> Option<usize> {
        self.all.iter().position(|p| p.state == LineState::Lit)
    }

    /// Whether all lines are over.
    pub fn are_over(&self) -> bool {
        self.all.iter().all(|p| p.state.is_over())
    }

    /// Number of pieces still to be picked.
    pub fn pieces_left(&self) -> u32 {
        self.all.iter().map(LineProgress::left).sum()
    }

    /// What a change of line `n`, counted from 0, would result in; [`Lines::change`] makes it.
    ///
    /// # Errors
    /// Why the change is refused.
    pub fn outcome(&self, n: usize, change: LineChange) -> Result<LineOutcome, LineRefusal> {
        let progress = self.all.get(n).ok_or(LineRefusal::NoLine(self.all.len()))?;
        let is_over = progress.state.is_over();
        match change {
            LineChange::Done(0) => Err(LineRefusal::NoPieces),
            // A button may confirm again what the hand has confirmed.
            LineChange::Done(_) | LineChange::Short if is_over => Ok(LineOutcome::Already),
            LineChange::Done(pieces) if pieces > progress.left() => {
                Err(LineRefusal::TooMany(progress.left()))
            }
            LineChange::Done(_) | LineChange::Short => Ok(LineOutcome::Changed),
            LineChange::Undo if progress.pieces == 0 && !is_over => Ok(LineOutcome::Already),
            LineChange::ToArm if !progress.is_by_hand() || progress.line.by == PickedBy::Hand => {
                Ok(LineOutcome::Already)
            }
            LineChange::ToHand if progress.state != LineState::Arm => Ok(LineOutcome::Already),
            LineChange::Undo | LineChange::ToArm | LineChange::ToHand => Ok(LineOutcome::Changed),
        }
    }

    /// Changes line `n`, counted from 0, and lights the next one if that is over.
    ///
    /// # Errors
    /// Why the change is refused; nothing has changed then.
    pub fn change(&mut self, n: usize, change: LineChange) -> Result<LineOutcome, LineRefusal> {
        let outcome = self.outcome(n, change)?;
        if outcome == LineOutcome::Already {
            return Ok(outcome);
        }
        let progress = &mut self.all[n];
        match change {
            LineChange::Done(pieces) => {
                progress.pieces += pieces;
                if progress.pieces == progress.line.quantity {
                    progress.state = LineState::Done;
                }
            }
            LineChange::Short => progress.state = LineState::Short,
            LineChange::Undo => (progress.state, progress.pieces) = (LineState::Undone, 0),
            LineChange::ToArm => progress.state = LineState::Arm,
            LineChange::ToHand => progress.state = LineState::Open,
        }
        // A hand is on its way to the lit line: only an undone line comes before it.
        if self.lit().is_none() || change == LineChange::Undo {
            self.light();
        }
        Ok(outcome)
    }

    /// Lights one line if any is left for the hand: the first, unless the lit line has pieces in its tote already.
    fn light(&mut self) {
        if self.lit().is_some_and(|n| self.all[n].pieces > 0) {
            return;
        }
        let first = self.all.iter().position(LineProgress::is_by_hand);
        if self.lit() == first {
            return;
        }
        if let Some(lit) = self.lit() {
            self.all[lit].state = LineState::Open;
        }
        if let Some(first) = first {
            self.all[first].state = LineState::Lit;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use LineChange::{Done, Short, ToArm, ToHand, Undo};
    use proptest::prelude::*;

    fn lines(quantities: &[u32]) -> Lines {
        let line = |(i, quantity): (usize, &u32)| OrderLine {
            slot: giveway_floor::warehouse::SlotName::new(i as u8, 0),
            quantity: *quantity,
            tote: "A".into(),
            item: None,
            by: PickedBy::Either,
        };
        Lines::new(quantities.iter().enumerate().map(line))
    }

    fn states(lines: &Lines) -> Vec<&'static str> {
        lines.all().iter().map(|p| p.state.word()).collect()
    }

    #[test]
    fn lines_are_lit_one_after_the_other_until_all_are_over() {
        let mut visit = lines(&[2, 1, 3]);
        assert_eq!((states(&visit), visit.pieces_left()), (vec!["lit", "open", "open"], 6));
        assert_eq!(visit.change(0, Done(1)), Ok(LineOutcome::Changed));
        assert_eq!((states(&visit), visit.pieces_left()), (vec!["lit", "open", "open"], 5));
        visit.change(0, Done(1)).unwrap();
        assert_eq!(states(&visit), ["done", "lit", "open"]);
        visit.change(1, Short).unwrap();
        assert_eq!((states(&visit), visit.pieces_left()), (vec!["done", "short", "lit"], 3));
        visit.change(2, Done(3)).unwrap();
        assert!(visit.are_over() && visit.lit().is_none());
    }

    #[test]
    fn a_line_that_is_over_is_not_counted_twice() {
        let mut visit = lines(&[1, 1]);
        visit.change(0, Done(1)).unwrap();
        let before = visit.clone();
        for again in [Done(1), Short] {
            assert_eq!(visit.change(0, again), Ok(LineOutcome::Already));
        }
        assert_eq!(visit, before);
    }

    #[test]
    fn what_is_taken_back_is_picked_anew() {
        let mut visit = lines(&[2, 2]);
        visit.change(0, Done(2)).unwrap();
        visit.change(1, Done(1)).unwrap();
        assert_eq!(visit.change(0, Undo), Ok(LineOutcome::Changed));
        assert_eq!(states(&visit), ["undone", "lit"], "what has begun goes on first");
        visit.change(1, Done(1)).unwrap();
        assert_eq!((states(&visit), visit.pieces_left()), (vec!["lit", "done"], 2));
        assert_eq!(visit.change(0, Undo), Ok(LineOutcome::Already), "there is nothing to take back");
    }

    #[test]
    fn what_cannot_be_confirmed_is_refused_and_changes_nothing() {
        let mut visit = lines(&[2]);
        let before = visit.clone();
        assert_eq!(visit.change(1, Done(1)), Err(LineRefusal::NoLine(1)));
        assert_eq!(visit.change(0, Done(0)), Err(LineRefusal::NoPieces));
        assert_eq!(visit.change(0, Done(3)), Err(LineRefusal::TooMany(2)));
        assert_eq!(visit, before);
    }

    #[test]
    fn the_arms_line_is_not_lit_and_comes_back_behind_the_one_that_a_hand_is_at() {
        let mut visit = lines(&[1, 2, 1]);
        visit.change(1, ToArm).unwrap();
        visit.change(0, Done(1)).unwrap();
        assert_eq!(states(&visit), ["done", "arm", "lit"]);
        visit.change(1, Done(1)).unwrap();
        assert_eq!(visit.change(1, ToHand), Ok(LineOutcome::Changed));
        assert_eq!((states(&visit), visit.pieces_left()), (vec!["done", "open", "lit"], 2));
        visit.change(2, Done(1)).unwrap();
        assert_eq!((states(&visit), visit.all()[1].pieces), (vec!["done", "lit", "done"], 1));
        assert_eq!(visit.change(1, ToArm), Ok(LineOutcome::Changed), "nobody else picks");
        assert_eq!((visit.lit(), visit.are_over()), (None, false));
        assert_eq!(visit.change(1, ToArm), Ok(LineOutcome::Already));
        visit.change(1, Done(1)).unwrap();
        assert!(visit.are_over());
    }

    #[test]
    fn a_line_for_the_arm_begins_with_it_and_one_for_the_hand_never_comes_to_it() {
        let line = |by| OrderLine { by, ..lines(&[1]).all()[0].line.clone() };
        let mut visit = Lines::new([PickedBy::Arm, PickedBy::Hand].map(line));
        assert_eq!(states(&visit), ["arm", "lit"]);
        assert_eq!(visit.change(1, ToArm), Ok(LineOutcome::Already));
        assert_eq!(Lines::restore(visit.all().to_vec()), Some(visit));
    }

    proptest! {
        #[test]
        fn whatever_is_said_one_line_is_lit_as_long_as_any_is_left_and_pieces_add_up(
            quantities in prop::collection::vec(1u32..4, 0..6),
            said in prop::collection::vec((0usize..7, 0u32..8), 0..40),
        ) {
            let mut visit = lines(&quantities);
            for (n, what) in said {
                let change = match what {
                    0 => Short,
                    1 => Undo,
                    6 => ToArm,
                    7 => ToHand,
                    pieces => Done(pieces - 1),
                };
                let (before, expected) = (visit.clone(), visit.outcome(n, change));
                prop_assert_eq!(visit.change(n, change), expected);
                if expected != Ok(LineOutcome::Changed) {
                    prop_assert_eq!(&visit, &before);
                }
                let lit = visit.all().iter().filter(|p| p.state == LineState::Lit).count();
                prop_assert_eq!(lit, usize::from(visit.all().iter().any(LineProgress::is_by_hand)));
                for p in visit.all() {
                    prop_assert!(p.pieces <= p.line.quantity);
                    prop_assert_eq!(p.state == LineState::Done, p.pieces == p.line.quantity);
                }
            }
        }
    }
}

//! Order lines of one visit: which one is lit, and what was confirmed of each.
//!
//! Main type: [`Lines`]. A line is open until it is lit, and lit until all its pieces are confirmed or it is short; who
//! takes that back makes it undone, and it is lit again after the lines before it. Refuses: to confirm more pieces than
//! were ordered, and to confirm a line twice.

use super::OrderLine;

/// How far a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineState {
    /// Nothing was done about it yet.
    Open,
    /// The one that is picked now.
    Lit,
    /// All pieces are in the tote.
    Done,
    /// Pieces are missing from the slot; what was there is in the tote.
    Short,
    /// It was done or short, and that was taken back: it is to be picked anew.
    Undone,
}

impl LineState {
    /// Whether nothing more is to be picked.
    pub fn is_over(self) -> bool {
        matches!(self, LineState::Done | LineState::Short)
    }

    /// The word for it on the wire.
    pub fn word(self) -> &'static str {
        match self {
            LineState::Open => "open",
            LineState::Lit => "lit",
            LineState::Done => "done",
            LineState::Short => "short",
            LineState::Undone => "undone",
        }
    }
}

/// What is said about a line, by a button, a scanner, a scale or the hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineChange {
    /// So many more pieces are in the tote.
    Done(u32),
    /// The slot has no more pieces.
    Short,
    /// What was said before is taken back: no piece counts.
    Undo,
}

/// What a change came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineOutcome {
    /// The line has changed.
    Changed,
    /// It was so already, and nothing was counted again.
    Already,
}

/// Why a change is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineRefusal {
    /// The visit has no line of this number; it has so many.
    NoLine(usize),
    /// Of no pieces nothing is confirmed.
    NoPieces,
    /// More pieces than are left to pick, which are so many.
    TooMany(u32),
}

/// One line and how far it is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LineProgress {
    /// What was ordered.
    pub line: OrderLine,
    /// How far it is.
    pub state: LineState,
    /// Pieces in the tote.
    pub pieces: u32,
}

impl LineProgress {
    /// Pieces that are still to be picked: none of a line that is over.
    pub fn left(&self) -> u32 {
        if self.state.is_over() { 0 } else { self.line.quantity - self.pieces }
    }
}

/// The lines of a visit, in the order in which they are lit.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Lines {
    all: Vec<LineProgress>,
}

impl Lines {
    /// The lines of a visit that begins: the first one is lit.
    pub fn new(lines: impl IntoIterator<Item = OrderLine>) -> Lines {
        let open = |line| LineProgress { line, state: LineState::Open, pieces: 0 };
        let mut lines = Lines { all: lines.into_iter().map(open).collect() };
        lines.light();
        lines
    }

    /// Lines as they were kept; nothing if they contradict themselves: more pieces than ordered, a line that is done
    /// with pieces left, or none or several lit.
    pub fn restore(all: Vec<LineProgress>) -> Option<Lines> {
        let sound = |p: &LineProgress| {
            p.pieces <= p.line.quantity && (p.state == LineState::Done) == (p.pieces == p.line.quantity)
        };
        let lines = Lines { all };
        let lit = lines.all.iter().filter(|p| p.state == LineState::Lit).count();
        (lines.all.iter().all(sound) && lit == usize::from(!lines.are_over())).then_some(lines)
    }

    /// All of them, in their order.
    pub fn all(&self) -> &[LineProgress] {
        &self.all
    }

    /// The line that is picked now, counted from 0; nothing where all are over.
    pub fn lit(&self) -> Option<usize> {
        self.all.iter().position(|p| p.state == LineState::Lit)
    }

    /// Whether the visit is: nothing more is to be picked.
    pub fn are_over(&self) -> bool {
        self.all.iter().all(|p| p.state.is_over())
    }

    /// Pieces that are still to be picked.
    pub fn pieces_left(&self) -> u32 {
        self.all.iter().map(LineProgress::left).sum()
    }

    /// What a change of the line `n`, counted from 0, would come to; [`Lines::change`] makes it.
    ///
    /// # Errors
    /// Why it is refused.
    pub fn outcome(&self, n: usize, change: LineChange) -> Result<LineOutcome, LineRefusal> {
        let progress = self.all.get(n).ok_or(LineRefusal::NoLine(self.all.len()))?;
        let is_over = progress.state.is_over();
        match change {
            LineChange::Done(0) => Err(LineRefusal::NoPieces),
            // What the hand has confirmed, a button confirms once more.
            LineChange::Done(_) | LineChange::Short if is_over => Ok(LineOutcome::Already),
            LineChange::Done(pieces) if pieces > progress.left() => {
                Err(LineRefusal::TooMany(progress.left()))
            }
            LineChange::Done(_) | LineChange::Short => Ok(LineOutcome::Changed),
            LineChange::Undo if progress.pieces == 0 && !is_over => Ok(LineOutcome::Already),
            LineChange::Undo => Ok(LineOutcome::Changed),
        }
    }

    /// Makes a change of the line `n`, counted from 0, and lights the next one if that is over.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
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
        }
        self.light();
        Ok(outcome)
    }

    /// One line is lit if any is left: the first, unless one is lit that has pieces in its tote already.
    fn light(&mut self) {
        if self.lit().is_some_and(|n| self.all[n].pieces > 0) {
            return;
        }
        let first = self.all.iter().position(|p| !p.state.is_over());
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
    use super::super::PickedBy;
    use super::*;
    use LineChange::{Done, Short, Undo};
    use proptest::prelude::*;

    fn lines(quantities: &[u32]) -> Lines {
        let line = |(i, quantity): (usize, &u32)| OrderLine {
            slot: crate::warehouse::SlotName::new(i as u8, 0),
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

    proptest! {
        #[test]
        fn whatever_is_said_one_line_is_lit_as_long_as_any_is_left_and_pieces_add_up(
            quantities in prop::collection::vec(1u32..4, 0..6),
            said in prop::collection::vec((0usize..7, 0u32..6), 0..40),
        ) {
            let mut visit = lines(&quantities);
            for (n, what) in said {
                let change = match what { 0 => Short, 1 => Undo, pieces => Done(pieces - 1) };
                let (before, expected) = (visit.clone(), visit.outcome(n, change));
                prop_assert_eq!(visit.change(n, change), expected);
                if expected != Ok(LineOutcome::Changed) {
                    prop_assert_eq!(&visit, &before);
                }
                let lit = visit.all().iter().filter(|p| p.state == LineState::Lit).count();
                prop_assert_eq!(lit, usize::from(!visit.are_over()));
                for p in visit.all() {
                    prop_assert!(p.pieces <= p.line.quantity);
                    prop_assert_eq!(p.state == LineState::Done, p.pieces == p.line.quantity);
                }
            }
        }
    }
}

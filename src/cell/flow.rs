//! How the fleet uses lines and hands at work cells: the variants that experiments compare.
//!
//! Main type: [`Flow`]. Refuses: to be changed while a fleet runs.

/// How much of a visit the fleet takes notice of. Each variant adds to the one before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Flow {
    /// A visit is expected to take the station's usual time; a button confirms each line.
    Usual,
    /// A visit is expected to take as long as its lines at the learned pace.
    Counted,
    /// The hand confirms lines: a grasp in the right slot, then a stop in the right tote.
    Hand,
    /// The rack leaves when the hand is out for the last time, while the last piece is on its way to the tote.
    #[default]
    Seen,
    /// As `Seen`, and the true end of each visit is told: the ceiling of any predictor. For experiments only.
    Known,
}

impl Flow {
    /// All variants, each knowing more than the one before it.
    pub const ALL: [Flow; 5] = [Flow::Usual, Flow::Counted, Flow::Hand, Flow::Seen, Flow::Known];

    /// The word for the variant in scenarios and reports.
    pub fn word(self) -> &'static str {
        match self {
            Flow::Usual => "usual",
            Flow::Counted => "counted",
            Flow::Hand => "hand",
            Flow::Seen => "seen",
            Flow::Known => "known",
        }
    }

    /// Whether the lines determine how long a visit takes.
    pub fn counts_lines(self) -> bool {
        self >= Flow::Counted
    }

    /// Whether hands confirm lines.
    pub fn hears_hands(self) -> bool {
        self >= Flow::Hand
    }

    /// Whether a rack leaves at the last grasp.
    pub fn leaves_at_last_grasp(self) -> bool {
        self >= Flow::Seen
    }
}

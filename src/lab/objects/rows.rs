//! The rows of the thesis' Tables 5.2 and 5.3, with the printed figures.
//!
//! Main types: [`ObjectRow`], [`RowKind`]; main functions: [`rows_of`], [`choice_of`]. Refuses: a row without a word.

use super::body::{FEATURES, GAZE, HAND, HAND_AND_HEAD, HEAD, ObjectTable};
use super::nets::FeatureChoice;
use crate::learning::picks::PlaceVariant;

/// The kind of predictor of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// The inverse of one feature.
    Rule(usize),
    /// The same feature with a sharpness fitted on the training movements; not in the thesis.
    Sharpened(usize),
    /// A net with a state of this size.
    Net(PlaceVariant, usize),
    /// The net `mlp` with a narrow layer of this width.
    Narrow(usize),
    /// The net `lstm`, overruled by eyes; in the thesis' Figure 5.5, not in its table.
    Enhanced,
}

/// One row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectRow {
    /// The row's word in tables.
    pub word: &'static str,
    /// The row's predictor.
    pub kind: RowKind,
    /// Printed in the thesis: area under the curve and error, both as sums; nothing if it has no such row.
    pub published: Option<(f64, f64)>,
    /// Printed in the thesis: milliseconds per frame, and the size of the state they apply to.
    pub published_ms: Option<(f64, usize)>,
}

/// Size of the state of nets with shared weights: smaller than the published 128 and 32, for two slow cores.
pub const SHARED: usize = 16;

/// The rows of a table, in its order; rows that the thesis lacks come last.
pub fn rows_of(table: ObjectTable) -> Vec<ObjectRow> {
    use PlaceVariant::{All, Full, Lstm, Mlp, Rnn};
    let rule = |word, feature, auc, error| ObjectRow {
        word,
        kind: RowKind::Rule(feature),
        published: Some((auc, error)),
        published_ms: None,
    };
    let net = |word, variant, hidden, published, ms| ObjectRow {
        word,
        kind: RowKind::Net(variant, hidden),
        published: Some(published),
        published_ms: Some(ms),
    };
    let ours = |word, kind| ObjectRow { word, kind, published: None, published_ms: None };
    match table {
        ObjectTable::Shelves => vec![
            rule("gaze", GAZE, 168.0, 206.3),
            rule("hand", HAND, 87.1, 339.0),
            rule("head", HEAD, 96.0, 237.8),
            net("lstm", Lstm, SHARED, (169.9, 175.9), (1.7, 128)),
            net("mlp", Mlp, SHARED, (166.6, 178.2), (2.5, 128)),
            net("rnn", Rnn, SHARED, (149.5, 218.2), (0.9, 128)),
            net("full", Full, 32, (124.4, 248.5), (2.1, 32)),
            net("all", All, 4, (102.9, 304.6), (4.1, 4)),
            ours("all_32", RowKind::Net(All, 32)),
            ours("enhanced", RowKind::Enhanced),
            ours("gaze_sharpened", RowKind::Sharpened(GAZE)),
            ours("mlp_1", RowKind::Narrow(1)),
            ours("mlp_4", RowKind::Narrow(4)),
            ours("mlp_8", RowKind::Narrow(8)),
        ],
        ObjectTable::Tables => vec![
            rule("hand", HAND, 129.9, 296.2),
            rule("head", HEAD, 253.1, 173.5),
            net("lstm", Lstm, SHARED, (240.9, 158.2), (1.1, 32)),
            net("mlp", Mlp, SHARED, (240.2, 153.9), (1.2, 32)),
            net("rnn", Rnn, SHARED, (229.0, 191.8), (0.7, 32)),
            net("full", Full, 16, (191.8, 197.7), (1.9, 16)),
            ours("head_sharpened", RowKind::Sharpened(HEAD)),
        ],
    }
}

/// The features of a table's nets: eyes, hand and head of the whole body, or hand and head alone.
pub fn choice_of(table: ObjectTable) -> FeatureChoice {
    match table {
        ObjectTable::Shelves => {
            FeatureChoice { columns: (0..FEATURES.len()).collect(), selected: 3, narrow: 2 }
        }
        ObjectTable::Tables => FeatureChoice { columns: HAND_AND_HEAD.to_vec(), selected: 2, narrow: 1 },
    }
}

/// Pairs of rows whose differences are reported if both exist.
pub const PAIRS: [(&str, &str); 11] = [
    ("lstm", "rnn"),
    ("lstm", "mlp"),
    ("mlp_8", "mlp"),
    ("lstm", "full"),
    ("full", "all"),
    ("full", "all_32"),
    ("lstm", "gaze"),
    ("lstm", "gaze_sharpened"),
    ("lstm", "head"),
    ("lstm", "head_sharpened"),
    ("eg_lstm", "lstm_without_gaze"),
];

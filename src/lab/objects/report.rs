//! Pieces of work merged: figures of every row, deviations between people, and differences of rows.
//!
//! Main types: [`ObjectsReport`], [`GroupReport`]. Refuses: differences of rows that were not scored on the same
//! people.

use super::bench::{ObjectGroup, ObjectPiece};
use super::rows::PAIRS;
use super::score::{ObjectScore, ObjectTally};
use crate::learning::picks::gaze_quantiles;
use crate::statistics::{Interval, Summary};
use std::collections::BTreeMap;

/// One row of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct RowReport {
    /// The word of the row.
    pub word: &'static str,
    /// Score over all movements.
    pub score: ObjectScore,
    /// Standard deviations of both means between people.
    pub sd: (Option<f64>, Option<f64>),
    /// Share of right answers in each half second of the last three seconds, from the earliest on.
    pub halves: [f64; 6],
    people: Vec<ObjectScore>,
}

/// Rows that were scored on the same movements.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupReport {
    /// Rows in their order.
    pub rows: Vec<RowReport>,
    /// Differences of the means of both figures, person by person: names of the rows, area, error.
    pub paired: Vec<(&'static str, &'static str, Interval, Interval)>,
    /// Median and 90 % quantile of the angle in degrees between measured gaze and its estimate, and the head.
    pub degrees: Option<[(f64, f64); 2]>,
}

/// The whole report.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectsReport {
    /// Reports by group.
    pub groups: BTreeMap<ObjectGroup, GroupReport>,
}

impl ObjectsReport {
    /// The report of all pieces, in the order of their work.
    pub fn of(pieces: Vec<ObjectPiece>) -> ObjectsReport {
        let mut by_group: BTreeMap<ObjectGroup, Vec<ObjectPiece>> = BTreeMap::new();
        for piece in pieces {
            by_group.entry(piece.group).or_default().push(piece);
        }
        ObjectsReport { groups: by_group.into_iter().map(|(g, pieces)| (g, group_of(pieces))).collect() }
    }
}

fn group_of(pieces: Vec<ObjectPiece>) -> GroupReport {
    let mut words: Vec<&'static str> = Vec::new();
    let mut by_row: BTreeMap<(&'static str, usize), ObjectTally> = BTreeMap::new();
    let (mut estimate, mut head) = (Vec::new(), Vec::new());
    for mut piece in pieces {
        if !words.contains(&piece.word) {
            words.push(piece.word);
        }
        estimate.append(&mut piece.degrees.0);
        head.append(&mut piece.degrees.1);
        by_row.entry((piece.word, piece.person)).or_default().merge(&piece.tally);
    }
    let rows: Vec<RowReport> = words.iter().filter_map(|word| row_of(word, &by_row)).collect();
    let find = |word: &str| rows.iter().find(|r| r.word == word);
    let pair = |(a, b): &(&'static str, &'static str)| {
        let (ours, theirs) = (find(a)?, find(b)?);
        let of = |of: fn(&ObjectScore) -> f64| {
            let figures = |row: &RowReport| row.people.iter().map(of).collect::<Vec<f64>>();
            Interval::of_pairs(&figures(ours), &figures(theirs))
        };
        Some((*a, *b, of(|s| s.auc_mean), of(|s| s.error_mean)))
    };
    let paired = PAIRS.iter().filter_map(pair).collect();
    let degrees = gaze_quantiles(estimate).zip(gaze_quantiles(head)).map(|(a, b)| [a, b]);
    GroupReport { rows, paired, degrees }
}

fn row_of(word: &'static str, by_row: &BTreeMap<(&'static str, usize), ObjectTally>) -> Option<RowReport> {
    let own: Vec<&ObjectTally> = by_row.iter().filter(|(key, _)| key.0 == word).map(|(_, t)| t).collect();
    let mut all = ObjectTally::default();
    own.iter().for_each(|t| all.merge(t));
    let people: Vec<ObjectScore> = own.iter().filter_map(|t| t.score()).collect();
    let sd = |of: fn(&ObjectScore) -> f64| Summary::of(&people.iter().map(of).collect::<Vec<f64>>()).sd;
    Some(RowReport {
        word,
        score: all.score()?,
        sd: (sd(|s| s.auc_mean), sd(|s| s.error_mean)),
        halves: std::array::from_fn(|k| all.right_within(k * 60..(k + 1) * 60)),
        people,
    })
}

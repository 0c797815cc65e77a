//! The report about carrying a ledger over: in words, each entry with what to do.
//!
//! Main types: [`Report`], [`ReportEntry`]. Refuses: to leave an entry out; texts for people are cut, and say how much.

use giveway_floor::geometry::Spot;
use std::fmt;

/// How many entries of each kind are shown as text.
const SHOWN: usize = 20;

/// Something that is in the way or would be lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportEntry {
    /// What is in the way or would be lost, and where.
    pub what: String,
    /// What to do.
    pub remedy: String,
    /// Where that is on the old map; nothing if it is at no place.
    pub at: Option<Spot>,
}

impl fmt::Display for ReportEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.what, self.remedy)
    }
}

/// The report about carrying a ledger over to a changed map.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// What has to be changed on the floor or on the map first: until then, nothing is carried over.
    pub obstacles: Vec<ReportEntry>,
    /// What would be lost: the ledger is carried over only if the operator accepts that.
    pub losses: Vec<ReportEntry>,
    /// What differs between the maps.
    pub changes: Vec<String>,
    /// What else happens on the floor, and needs nothing.
    pub notes: Vec<String>,
}

impl Report {
    /// Whether nothing is in the way and nothing would be lost.
    pub fn is_clean(&self) -> bool {
        self.obstacles.is_empty() && self.losses.is_empty()
    }

    /// What differs, and what else happens.
    pub fn all_notes(&self) -> Vec<String> {
        self.changes.iter().chain(&self.notes).cloned().collect()
    }

    pub(super) fn refuse(&mut self, at: Option<Spot>, what: String, remedy: &str) {
        self.obstacles.push(ReportEntry { what, remedy: remedy.to_owned(), at });
    }

    pub(super) fn lose(&mut self, at: Option<Spot>, what: String, remedy: &str) {
        self.losses.push(ReportEntry { what, remedy: remedy.to_owned(), at });
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts = |entries: &[ReportEntry]| entries.iter().map(ToString::to_string).collect::<Vec<_>>();
        let lists =
            [("obstacle", texts(&self.obstacles)), ("loss", texts(&self.losses)), ("note", self.all_notes())];
        let mut first = true;
        for (kind, list) in lists {
            let more = list.len().saturating_sub(SHOWN);
            let rest = (more > 0).then(|| format!("and {more} more"));
            for text in list.into_iter().take(SHOWN).chain(rest) {
                if !std::mem::take(&mut first) {
                    f.write_str("\n")?;
                }
                write!(f, "  {kind}: {text}")?;
            }
        }
        Ok(())
    }
}

//! Problems of a map: all at once, each with its place and its remedy.
//!
//! Main types: [`Finding`], [`Findings`]. `draft` checks names and numbers before ids exist, `cell` checks work cells;
//! `floor` checks the finished graph, whether robots can always move on (DESIGN §5, invariant a); `shut_in` warns of
//! places from which robots cannot leave past a broken-down one, `improbable` of sizes that look like a slip; `review`
//! combines all of them. Refuses: to stop at the first problem, and to mend anything itself.

mod cell;
mod corridor;
mod draft;
mod floor;
mod improbable;
mod place;
mod review;
#[cfg(test)]
mod review_tests;
mod shut_in;
#[cfg(test)]
mod tests;

pub(super) use corridor::clear_of_things;
pub(super) use draft::{names_and_numbers, without_bad_parts};
pub(super) use floor::well_formed;
pub use review::{Remark, Review, Severity, review};
pub use shut_in::{ShutIn, shut_in, shut_in_text};

use super::Warehouse;
use crate::geometry::Point;
use place::FindingPlace;
use std::collections::BTreeSet;
use std::fmt;

/// One problem of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The place in the map, in words.
    pub place: String,
    /// The nodes of that place by their names; some may not exist.
    pub nodes: Vec<String>,
    /// Corners of the outline in question, metres; none for other places.
    pub corners: Vec<Point>,
    /// The problem.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}

/// All problems of a map; never empty in an error.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Findings(pub Vec<Finding>);

/// What is unknown about a floor that was built without the bad parts of its draft. A problem that the missing parts
/// could explain is not reported: one mistake, one finding.
#[derive(Debug, Default)]
pub(super) struct Doubts {
    /// Names of places at which something was left out; the missing parts may join them to anything.
    pub places: BTreeSet<String>,
    /// Whether places to stay were left out.
    pub stays: bool,
}

impl Findings {
    /// Adds the findings of another check.
    pub(super) fn also(&mut self, other: Result<(), Findings>) {
        self.0.extend(other.err().into_iter().flat_map(|more| more.0));
    }

    pub(super) fn add(
        &mut self,
        place: impl Into<FindingPlace>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let FindingPlace { words, nodes, corners } = place.into();
        let (problem, remedy) = (problem.into(), remedy.into());
        self.0.push(Finding { place: words, nodes, corners, problem, remedy });
    }

    pub(super) fn into_result(self) -> Result<(), Findings> {
        if self.0.is_empty() { Ok(()) } else { Err(self) }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}; {}", self.place, self.problem, self.remedy)
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, finding) in self.0.iter().enumerate() {
            let gap = if i == 0 { "" } else { "\n" };
            write!(f, "{gap}{finding}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Findings {}

/// Whether this many robots can all stay somewhere for ever without being in one another's way.
///
/// # Errors
/// One finding, if there are fewer storage, charging and parking places than robots.
pub fn room_for(warehouse: &Warehouse, robots: usize) -> Result<(), Findings> {
    let places = warehouse.nodes_where(|kind| kind.is_lasting()).len();
    let mut found = Findings::default();
    if places < robots {
        found.add(
            format!("map {}", warehouse.name),
            format!("{robots} robots, but only {places} storage, charging and parking places to stay at"),
            format!("add {} parking places or take fewer robots", robots - places),
        );
    }
    found.into_result()
}

/// The first few names, and how many more there are.
fn list(names: &[&str]) -> String {
    const SHOWN: usize = 12;
    let head = names.iter().take(SHOWN).copied().collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN { format!("{head} and {} more", names.len() - SHOWN) } else { head }
}

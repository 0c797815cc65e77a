//! All remarks about a map, with places on the floor: what makes it refused, and what looks odd.
//!
//! Main types: [`Review`], [`Remark`]; main function: [`review`]. Refuses: nothing; of a bad map it keeps what can be
//! drawn.

use super::improbable::improbable;
use super::place::FindingPlace;
use super::shut_in::{ShutIn, remarks_of, shut_in};
use super::{Finding, Findings};
use crate::geometry::Point;
use crate::warehouse::{Draft, Warehouse};
use std::collections::BTreeMap;
use std::fmt;

/// How serious a remark is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The map is refused.
    Error,
    /// The map can be used, but should be looked at again.
    Warning,
}

impl Severity {
    /// `error` or `warning`.
    pub fn word(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        }
    }
}

/// One remark about a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// How serious the remark is.
    pub severity: Severity,
    /// The place in the map, the problem, and the remedy.
    pub finding: Finding,
    /// Positions of the nodes and corners in question, metres; none if the remark has no place on the floor.
    pub at: Vec<Point>,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.finding.fmt(f)
    }
}

/// All remarks about a map.
#[derive(Clone, Debug)]
pub struct Review {
    /// Errors first, then likely slips.
    pub remarks: Vec<Remark>,
    /// Where a broken robot would shut others in; checked only for valid maps.
    pub shut_in: Vec<ShutIn>,
    /// The entries of `shut_in` as warnings.
    pub dead_ends: Vec<Remark>,
    /// The building; for a refused map, without its bad parts and for drawings only. Nothing if there are no nodes, or
    /// far too many.
    pub warehouse: Option<Warehouse>,
}

impl Review {
    /// Whether the map can be used.
    pub fn is_good(&self) -> bool {
        self.remarks.iter().all(|r| r.severity != Severity::Error)
    }

    /// The remarks of this severity.
    pub fn of(&self, severity: Severity) -> impl Iterator<Item = &Remark> {
        self.remarks.iter().filter(move |r| r.severity == severity)
    }
}

/// Checks a draft, and looks at what it would be without its bad parts.
pub fn review(draft: &Draft) -> Review {
    let (warehouse, errors) = match draft.clone().build() {
        Ok(warehouse) => (Some(warehouse), Findings::default()),
        Err(errors) => (draft.salvaged(), errors),
    };
    let (mut warnings, mut ends) = (nothing_to_do(draft), Vec::new());
    if let Some(w) = &warehouse {
        warnings.0.extend(improbable(w).0);
        if errors.0.is_empty() {
            ends = shut_in(w);
        }
    }
    let mut at: BTreeMap<&str, Vec<Point>> = BTreeMap::new();
    let good = |p: &Point| p.x.is_finite() && p.y.is_finite();
    for node in draft.nodes.iter().filter(|n| good(&n.at)) {
        at.entry(&node.name).or_default().push(node.at);
    }
    let remark = |severity, finding: Finding| {
        let nodes = finding.nodes.iter().flat_map(|name| at.get(name.as_str()).into_iter().flatten());
        let at = nodes.chain(finding.corners.iter().filter(|p| good(p))).copied().collect();
        Remark { severity, finding, at }
    };
    let errors = errors.0.into_iter().map(|f| remark(Severity::Error, f));
    let remarks = errors.chain(warnings.0.into_iter().map(|f| remark(Severity::Warning, f))).collect();
    let dead_ends = remarks_of(&ends).0.into_iter().map(|f| remark(Severity::Warning, f)).collect();
    Review { remarks, shut_in: ends, dead_ends, warehouse }
}

/// Missing things without which robots have nothing to do.
fn nothing_to_do(draft: &Draft) -> Findings {
    let mut found = Findings::default();
    if draft.stations.is_empty() {
        let place = FindingPlace::from("stations");
        found.add(
            place,
            "there are none, so nothing can be delivered",
            "add a station with a way in and out",
        );
    } else if draft.racks.is_empty() {
        found.add("racks", "there are none, so nothing can be delivered", "put racks on storage places");
    }
    found
}

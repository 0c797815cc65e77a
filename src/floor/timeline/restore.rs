//! Restores a timeline from its stored form.
//!
//! Main function: [`Timeline::restore`], which takes [`ChainParts`]. Refuses: holds that contradict one another, with
//! reasons ([`Flaw`]); a timeline written by this program never does.

use super::{Chain, Clash, Timeline, Visit, in_order};
use crate::id::{BodyId, Dense, RobotId};
use crate::time::Span;
use crate::warehouse::Warehouse;
use std::sync::Arc;

/// The stored visits of one holder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChainParts {
    /// The holder.
    pub holder: RobotId,
    /// Serial number of the oldest visit.
    pub first: u64,
    /// One past the serial number of the last granted visit.
    pub granted: u64,
    /// The visits, oldest first.
    pub visits: Vec<Visit>,
    /// Whether the holder has left the floor, and holds nothing.
    pub absent: bool,
}

/// Why visits cannot be held.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Flaw {
    /// Two holders want one resource at once.
    #[error(
        "{resource} is held by {holder:?} during {:?}, and by {:?} during {:?}",
        .clash.wanted, .clash.by, .clash.held
    )]
    Overlap {
        /// Name of the resource.
        resource: String,
        /// The holder of the visit that was checked.
        holder: RobotId,
        /// What the holder wants, and the other holder that has it.
        clash: Clash,
    },
    /// Two successive visits do not fit together, or one is not a valid visit.
    #[error("visits {serial} and {} of {holder:?} are out of order", .serial + 1)]
    Disorder {
        /// The holder.
        holder: RobotId,
        /// Serial number of the earlier visit.
        serial: u64,
    },
    /// A visit is on a node or a lane that the map does not have.
    #[error("visit {serial} of {holder:?} is at a place that the map does not have")]
    UnknownPlace {
        /// The holder.
        holder: RobotId,
        /// Serial number of the visit.
        serial: u64,
    },
    /// A holder holds nothing, or its last visit ends, or it was granted more or less than it holds.
    #[error("{holder:?} stands nowhere, or was granted what it does not hold")]
    Nowhere {
        /// The holder.
        holder: RobotId,
    },
    /// A holder is listed twice.
    #[error("{holder:?} is there twice")]
    Twice {
        /// The holder.
        holder: RobotId,
    },
}

impl Timeline {
    /// A timeline with exactly these visits. `bodies` are the kinds of robots, by their numbers.
    ///
    /// # Errors
    /// The first contradiction.
    pub fn restore(
        warehouse: Arc<Warehouse>,
        clearance: Span,
        bodies: Vec<BodyId>,
        chains: Vec<ChainParts>,
    ) -> Result<Timeline, Flaw> {
        let mut timeline = Timeline { bodies, ..Timeline::new(warehouse, clearance) };
        for parts in chains {
            let holder = parts.holder;
            if timeline.chains.contains_key(&holder) {
                return Err(Flaw::Twice { holder });
            }
            timeline.validate(&parts)?;
            if parts.absent {
                let ChainParts { first, granted, visits, absent, .. } = parts;
                timeline.chains.insert(holder, Chain { first, granted, visits: visits.into(), absent });
                continue;
            }
            timeline.check(holder, &parts.visits).map_err(|clash| {
                let resource = timeline.warehouse.resource_name(clash.resource);
                Flaw::Overlap { resource, holder, clash }
            })?;
            timeline.chains.insert(holder, Chain { first: parts.first, ..Chain::default() });
            timeline.put(holder, parts.visits);
            timeline.chains.get_mut(&holder).expect("just put").granted = parts.granted;
        }
        Ok(timeline)
    }

    fn validate(&self, parts: &ChainParts) -> Result<(), Flaw> {
        let ChainParts { holder, first, granted, visits, .. } = parts;
        let (holder, w) = (*holder, &self.warehouse);
        let end = first.checked_add(visits.len() as u64).ok_or(Flaw::Nowhere { holder })?;
        if visits.last().is_none_or(|v| !v.leave.is_forever()) || *granted <= *first || *granted > end {
            return Err(Flaw::Nowhere { holder });
        }
        for (serial, v) in (*first..).zip(visits) {
            let known = v.node.ix() < w.nodes.len() && v.lane.is_none_or(|l| l.ix() < w.resource_count());
            if !known {
                return Err(Flaw::UnknownPlace { holder, serial });
            }
            if v.enter >= v.leave || v.arrive > v.depart {
                return Err(Flaw::Disorder { holder, serial });
            }
        }
        let mut pairs = (*first..).zip(visits.windows(2));
        match pairs.find(|(_, pair)| !in_order(&pair[0], &pair[1])) {
            Some((serial, _)) => Err(Flaw::Disorder { holder, serial }),
            None => Ok(()),
        }
    }
}

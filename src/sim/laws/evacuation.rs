//! The law of evacuations: no robot is granted a place on a worker's way to a door, except to leave that way.
//!
//! Refuses: to judge earlier grants; a robot may drive those to their end.

use super::violation::Violation;
use giveway_fleet::{Fact, Fleet, RouteFact};

/// Robots that were granted a place on a way out while they were on no way out.
pub(super) fn entered(fleet: &Fleet, facts: &[Fact]) -> Vec<Violation> {
    if fleet.ledger().evacuation.is_none() {
        return Vec::new();
    }
    let enters = |fact: &Fact| {
        let Fact::Route(RouteFact::Granted { robot, serial, .. }) = fact else { return None };
        let chain = fleet.ledger().chain(*robot);
        let nodes = (chain.first()..=*serial).filter_map(|s| chain.get(s)).map(|v| v.node);
        let onto = nodes.into_iter().find(|n| fleet.is_on_way_out(*n))?;
        (!fleet.leaves_way_out(*robot)).then_some(Violation::OntoWayOut(*robot, onto))
    };
    facts.iter().filter_map(enters).collect()
}

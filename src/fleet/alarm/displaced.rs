//! What is wrong with where a robot stands, in words: where it stands, why it cannot be taken up there, what to do.
//!
//! Main function: [`words`]. Refuses: to know more than the fleet does; a person has to find out what became of a lost
//! load.

use crate::Displacement;
use giveway_floor::geometry::Point;
use giveway_floor::id::{NodeId, RackId, RobotId};
use giveway_floor::text::sentence::reasons;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::warehouse::Warehouse;

/// A predicate: "stands at (4.1, 7.9), 0.6 m from the nearest node n-12: push …".
pub fn words(map: &Warehouse, robot: impl Fn(RobotId) -> String, displacement: Displacement) -> Sentence {
    let node = |n: NodeId| map.nodes.get(n).map_or_else(|| format!("{n:?}"), |n| n.name.clone());
    let rack = |r: RackId| map.racks.get(r).map_or_else(|| format!("{r:?}"), |r| r.name.clone());
    match displacement {
        Displacement::OffNode { at, nearest, off_mm } => {
            let (at, tenths) = (Point::from(at), |m| SentenceArg::rounded(m, 1));
            reasons::off_node(tenths(at.x), tenths(at.y), tenths(off_mm as f64 / 1000.0), node(nearest))
        }
        Displacement::KnowsWaypoints(n) => reasons::knows_old_route(node(n)),
        Displacement::GrantedTo(n, other) => reasons::on_granted_node(node(n), robot(other)),
        Displacement::RackThere(n, k) => reasons::on_stored_rack(node(n), rack(k)),
        Displacement::NoWayOut(n) => reasons::no_way_out(node(n)),
        Displacement::ByHand => reasons::displaced_by_hand(),
        Displacement::Load { carries: None, expected: Some(k) } => reasons::rack_missing(rack(k)),
        Displacement::Load { carries: Some(k), expected: None } => reasons::rack_unexpected(rack(k)),
        Displacement::Load { carries, expected } => {
            let named = |r: Option<RackId>| r.map_or_else(reasons::no_rack, |r| reasons::rack_named(rack(r)));
            reasons::other_rack(named(carries), named(expected))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::lab;

    #[test]
    fn the_sentence_says_where_a_robot_stands_and_what_to_do() {
        let map = lab();
        let nearest = map.node_named("R118").expect("a node of the laboratory");
        let at = map.nodes[nearest].at;
        let said = |d| words(&map, |r| format!("robot-{}", r.0 + 1), d).text().to_owned();
        let off = said(Displacement::OffNode { at: at.into(), nearest, off_mm: 600 });
        let place = format!(
            "stands at ({:.1}, {:.1}), 0.6 m from the nearest node R118: push or drive it",
            at.x, at.y
        );
        assert!(off.starts_with(&place), "{off}");
        let taken = said(Displacement::GrantedTo(nearest, RobotId(4)));
        assert!(taken.starts_with("stands on R118, to which robot-5 may drive already: push"), "{taken}");
        let gone = said(Displacement::Load { carries: None, expected: Some(RackId(0)) });
        let rack = &map.racks[RackId(0)].name;
        assert!(
            gone.starts_with(&format!("carries no rack, but rack {rack} was on it: set rack {rack}")),
            "{gone}"
        );
    }
}

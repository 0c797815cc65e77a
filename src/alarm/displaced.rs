//! What is wrong with where a robot stands, in words: where it is, why it cannot be taken up there, what to do.
//!
//! Main function: [`words`]. Refuses: to know more than the fleet does; what became of a lost load is for a person to
//! see.

use crate::fleet::Displacement;
use crate::geometry::Point;
use crate::id::{NodeId, RackId, RobotId};
use crate::warehouse::Warehouse;

/// A predicate: "stands at (4.1, 7.9), 0.6 m from the nearest node n-12: push …".
pub fn words(map: &Warehouse, robot: impl Fn(RobotId) -> String, displacement: Displacement) -> String {
    let node = |n: NodeId| map.nodes.get(n).map_or_else(|| format!("{n:?}"), |n| n.name.clone());
    let rack = |r: RackId| map.racks.get(r).map_or_else(|| format!("{r:?}"), |r| r.name.clone());
    let elsewhere = "push or drive it onto a free node; it rejoins the fleet there by itself";
    match displacement {
        Displacement::OffNode { at, nearest, off_mm } => {
            let (at, off_m) = (Point::from(at), off_mm as f64 / 1000.0);
            let near = node(nearest);
            format!(
                "stands at ({:.1}, {:.1}), {off_m:.1} m from the nearest node {near}: {elsewhere}",
                at.x, at.y
            )
        }
        Displacement::KnowsWaypoints(n) => format!(
            "stands on {}, which it does not hold, and still has its old route: clear that (switch it off \
             and on); it rejoins the fleet there by itself",
            node(n)
        ),
        Displacement::GrantedTo(n, other) => format!(
            "stands on {}, to which {} may drive already: {elsewhere}, or where it is once {} has backed off",
            node(n),
            robot(other),
            robot(other)
        ),
        Displacement::RackThere(n, k) => {
            format!("stands with its rack on {}, where rack {} is stored: {elsewhere}", node(n), rack(k))
        }
        Displacement::NoWayOut(n) => {
            format!("stands on {}, from which it has no lane to drive on: {elsewhere}", node(n))
        }
        Displacement::ByHand => {
            "is driven by hand: leave it on a free node; once that ends, it rejoins the fleet by itself"
                .to_owned()
        }
        Displacement::Load { carries: None, expected: Some(k) } => {
            let k = rack(k);
            format!(
                "carries no rack, but rack {k} was on it: set rack {k} onto it, and it goes on by itself; or set the \
                 rack down in storage and say where with POST /v1/racks/{k}/taken"
            )
        }
        Displacement::Load { carries: Some(k), expected: None } => {
            let k = rack(k);
            format!(
                "carries rack {k}, but had no rack on it: take rack {k} off it and back to its place; it goes on by \
                 itself"
            )
        }
        Displacement::Load { carries, expected } => {
            let name =
                |r: Option<RackId>| r.map_or_else(|| "no rack".into(), |r| format!("rack {}", rack(r)));
            let (has, had) = (name(carries), name(expected));
            format!("carries {has}, but {had} was on it: put {had} onto it instead; it goes on by itself")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::lab;

    #[test]
    fn the_sentence_says_where_a_robot_stands_and_what_to_do() {
        let map = lab();
        let nearest = map.node_named("R118").expect("a node of the laboratory");
        let at = map.nodes[nearest].at;
        let said = |d| words(&map, |r| format!("robot-{}", r.0 + 1), d);
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

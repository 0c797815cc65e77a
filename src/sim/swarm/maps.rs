//! Maps that a seed draws: those that ship, and random halls.
//!
//! Main function: [`draw_map`]. A random hall is made by the rule of `giveway map generate` with drawn parameters, then
//! parts of it are removed or changed. Each goes through the checks of every map; one that fails them is drawn again.
//! Refuses: to repair a map.

use crate::random::Stream;
use giveway_floor::time::Span;
use giveway_floor::warehouse::{Blocks, Draft, Users, Warehouse, kiva, lab, mixed, thesis};

/// How many halls with drawn changes are tried before one without changes is taken.
const TRIES: usize = 8;

/// A map: a random one, or, unless `random_only`, perhaps one of those that ship.
pub(super) fn draw_map(random_only: bool, random: &mut Stream) -> Warehouse {
    let share = random.unit();
    match share {
        _ if random_only || share < 0.6 => random_hall(random),
        _ if share < 0.78 => thesis(),
        _ if share < 0.88 => lab(),
        _ if share < 0.97 => mixed(),
        _ => kiva(),
    }
}

fn random_hall(random: &mut Stream) -> Warehouse {
    for _ in 0..TRIES {
        let mut draft = blocks(random).draft();
        change(&mut draft, random);
        if let Ok(warehouse) = draft.build() {
            return warehouse;
        }
    }
    Blocks { name: "random".into(), ..Blocks::default() }
        .draft()
        .build()
        .expect("the usual hall is well-formed")
}

/// Draws blocks: from a single one to two groups of several; short and long ones; few and many places beside them.
fn blocks(random: &mut Stream) -> Blocks {
    let mut upto = |low: usize, high: usize| low + random.below(high - low + 1);
    let groups = (upto(1, 2), upto(1, 2));
    let blocks = (upto(1, 3), upto(1, 4));
    let (block_length, queue) = (upto(1, 5), upto(1, 4));
    let (west, east) = (upto(0, 3), upto(0, 3));
    let (chargers, parking) = (upto(1, 6), upto(0, 8));
    Blocks {
        name: "random".into(),
        groups,
        blocks,
        block_length,
        stations_west: if east == 0 { west.max(1) } else { west },
        stations_east: east,
        queue,
        pick: Span::from_secs_f64(random.between(3.0, 20.0)),
        chargers,
        parking,
        fill: random.between(0.2, 0.9),
        road_m: 1.0,
    }
}

/// Removes storage nodes and lanes beneath racks, and sets speed limits.
fn change(draft: &mut Draft, random: &mut Stream) {
    if random.happens_of(0.4) {
        let share = random.between(0.05, 0.3);
        let gone: Vec<String> = draft.storage.iter().filter(|_| random.happens_of(share)).cloned().collect();
        draft.storage.retain(|n| !gone.contains(n));
        draft.nodes.retain(|n| !gone.contains(&n.name));
        draft.lanes.retain(|l| !gone.contains(&l.from) && !gone.contains(&l.to));
        draft.racks.retain(|r| !gone.contains(&r.node));
    }
    if random.happens_of(0.3) {
        let share = random.between(0.1, 1.0);
        draft.lanes.retain(|l| l.users != Users::UNLOADED || !random.happens_of(share));
    }
    if random.happens_of(0.3) {
        let share = random.between(0.05, 0.5);
        for lane in &mut draft.lanes {
            if random.happens_of(share) {
                lane.speed_limit_mps = Some(random.between(0.3, 1.2));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::{NodeKind, summary};
    use std::collections::BTreeSet;

    #[test]
    fn seeds_draw_halls_of_many_sizes_and_the_maps_that_ship() {
        let (mut names, mut nodes) = (BTreeSet::new(), Vec::new());
        for seed in 0..60 {
            let map = draw_map(false, &mut Stream::new(seed, 100, 0));
            assert!(!map.nodes_where(NodeKind::is_lasting).is_empty());
            nodes.extend((map.name == "random").then(|| summary(&map).nodes));
            names.insert(map.name);
        }
        let shipped: Vec<&str> = names.iter().map(String::as_str).collect();
        assert_eq!(shipped, ["kiva", "lab", "mixed", "random", "thesis"]);
        nodes.sort_unstable();
        assert!(nodes[0] < 60 && nodes[nodes.len() - 1] > 250, "{nodes:?}");
    }

    #[test]
    fn the_same_seed_draws_the_same_map() {
        let draw = |seed| {
            giveway_floor::warehouse::formats::json::write(&draw_map(true, &mut Stream::new(seed, 100, 0)))
        };
        assert!((0..5).all(|seed| draw(seed) == draw(seed)));
        assert_ne!(draw(1), draw(2));
    }
}

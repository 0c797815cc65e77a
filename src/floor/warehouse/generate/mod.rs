//! Maps made by rule: the maps shipped in `maps/`, and [`Blocks`] for others like them.
//!
//! Main type: [`Blocks`]; [`lab`], [`thesis`], [`mixed()`], [`stations()`], [`docks`] and [`kiva`] are the
//! shipped halls. Refuses: chance; the same parameters give the same map.

mod blocks;
mod halls;
mod mixed;
mod pen;
mod side;
mod stations;

pub use blocks::Blocks;
pub use halls::{lab, thesis};
pub use mixed::mixed;
pub use stations::{stations, with_cells};

use super::Warehouse;
use crate::time::Span;

/// A hall for robots and trucks: 60 blocks of ten storage places in four groups, one-way aisles, main roads whose two
/// lanes are 3 m apart, so that a robot in its lane can be passed, and six stations on either side.
pub fn docks() -> Warehouse {
    let blocks = Blocks {
        name: "docks".into(),
        groups: (2, 2),
        blocks: (3, 5),
        stations_west: 6,
        stations_east: 6,
        chargers: 16,
        parking: 16,
        road_m: 3.0,
        ..Blocks::default()
    };
    blocks.draft().build().expect("the shipped map is well-formed, a test builds it")
}

/// A hall for 800 robots: 220 blocks of ten storage places in four groups, one-way aisles, main roads with a
/// lane each way around and between the groups, 24 stations on the west side and 24 on the east side.
pub fn kiva() -> Warehouse {
    let blocks = Blocks {
        name: "kiva".into(),
        groups: (2, 2),
        blocks: (5, 11),
        block_length: 5,
        stations_west: 24,
        stations_east: 24,
        queue: 4,
        pick: Span::from_secs(8),
        chargers: 88,
        parking: 64,
        fill: 0.85,
        road_m: 1.0,
    };
    blocks.draft().build().expect("the shipped map is well-formed, a test builds it")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::{NodeKind, room_for, summary};

    #[test]
    fn the_laboratory_has_the_nodes_and_the_ways_of_the_story() {
        let w = lab();
        let s = summary(&w);
        assert_eq!((s.racks, s.stations, s.queue_places), (12, 1, 1));
        let way = |names: &[&str]| {
            names.windows(2).all(|pair| {
                let [from, to] = [pair[0], pair[1]].map(|n| w.node_named(n).expect(n));
                w.out(from).any(|(_, a)| a.to == to && a.users.people)
            })
        };
        assert!(way(&["R32", "R33", "R34", "R101", "R102", "R107", "R117"]), "the near way, to be blocked");
        assert!(way(&["R32", "R31", "R30", "R103", "R17"]), "the way to the goal between the racks");
        assert!(way(&["R103", "R104", "R105", "R106", "R108", "R109"]), "the far way, past R17");
        assert!(way(&["R109", "R110", "R111", "R112", "R113", "R116", "R117"]), "and on to the first goal");
        assert!(way(&["R30", "R100", "P", "R103"]), "the picking station");
        let r15 = w.node_named("R15").expect("R15");
        assert_eq!(w.nodes[r15].kind, NodeKind::Parking, "a robot stands there all the time");
    }

    #[test]
    fn the_hall_of_the_thesis_has_228_nodes_and_348_edges_and_room_for_50_robots() {
        let w = thesis();
        let s = summary(&w);
        assert_eq!((s.nodes, s.lanes, s.stations), (228, 348, 2));
        assert!(s.racks >= 24 && s.chargers + s.parking >= 20, "{s}");
        room_for(&w, 50).expect("room for 50 robots");
    }

    #[test]
    fn the_large_hall_has_room_for_800_robots_on_about_5000_timelines() {
        let w = kiva();
        let s = summary(&w);
        println!("{s}");
        assert!((4_500..5_500).contains(&s.timeline_resources), "{s}");
        assert_eq!(s.conflicts, 0, "{s}");
        assert_eq!((s.storage, s.racks, s.stations), (2_200, 1_870, 48));
        assert!(s.chargers >= 80 && s.parking > 0, "{s}");
        room_for(&w, 1_600).expect("twice the room that 800 robots need");
    }

    #[test]
    fn lanes_of_main_roads_are_as_far_apart_as_wanted_and_all_else_stays_a_metre() {
        let narrow = Blocks { groups: (2, 1), ..Blocks::default() };
        let wide = Blocks { road_m: 3.0, ..narrow.clone() };
        let [narrow, wide] = [narrow, wide].map(|blocks| blocks.draft().build().expect("a map"));
        assert_eq!(narrow.nodes.len(), wide.nodes.len());
        let lengths = |w: &Warehouse| {
            let mut all: Vec<i64> = w.arcs.iter().map(|arc| (arc.length_m * 10.0).round() as i64).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        assert_eq!((lengths(&narrow), lengths(&wide)), (vec![10], vec![10, 30]));
        let at = |name: &str| wide.nodes[wide.node_named(name).expect(name)].at;
        assert_eq!([at("A1-5").x - at("A0-5").x, at("S2-2").x - at("A1-2").x], [3.0, 1.0]);
    }

    #[test]
    fn blocks_of_many_sizes_are_well_formed() {
        for (groups, blocks, length) in
            [((1, 1), (1, 1), 1), ((1, 2), (3, 4), 4), ((3, 1), (2, 6), 5), ((2, 2), (4, 3), 2)]
        {
            let b = Blocks { groups, blocks, block_length: length, ..Blocks::default() };
            let w = b.draft().build().unwrap_or_else(|findings| panic!("{b:?}:\n{findings}"));
            assert_eq!(summary(&w).storage, groups.0 * groups.1 * blocks.0 * blocks.1 * 2 * length);
        }
    }
}

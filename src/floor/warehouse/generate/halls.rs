//! The two halls of the thesis that the project follows: its laboratory and its simulated warehouse.
//!
//! Main functions: [`lab`], [`thesis`]. The drawings of both are lost in the text; what the text says about them
//! (names, counts, which robot can go where) is kept, and the rest is a plausible guess. Refuses: parameters.

use super::pen::{Cell, Pen, outline};
use crate::time::Span;
use crate::warehouse::{Draft, DraftStation, Users, Warehouse};

/// The laboratory's street around the racks, from R32 northwards and anticlockwise round to R32.
const LAB_RING: [(&str, Cell); 20] = [
    ("R32", (6, 0)),
    ("R33", (6, 1)),
    ("R34", (6, 2)),
    ("R101", (6, 3)),
    ("R102", (6, 4)),
    ("R107", (5, 4)),
    ("R117", (4, 4)),
    ("R116", (3, 4)),
    ("R113", (2, 4)),
    ("R112", (1, 4)),
    ("R111", (0, 4)),
    ("R110", (0, 3)),
    ("R109", (0, 2)),
    ("R108", (0, 1)),
    ("R106", (0, 0)),
    ("R105", (1, 0)),
    ("R104", (2, 0)),
    ("R103", (3, 0)),
    ("R30", (4, 0)),
    ("R31", (5, 0)),
];

/// The laboratory: two blocks of six racks, a street around them and one between them. The latter ends at R15, where
/// one of the two robots stands: from R32 to R117 there are only two ways, by R101 or by R104.
pub fn lab() -> Warehouse {
    let mut pen = Pen::new("lab");
    for (name, cell) in LAB_RING {
        pen.node(cell, name);
    }
    for i in 0..LAB_RING.len() {
        pen.both_ways(LAB_RING[i].1, LAB_RING[(i + 1) % LAB_RING.len()].1, Users::ALL);
    }
    for (name, y) in [("R17", 1), ("R16", 2)] {
        pen.node((3, y), name);
        pen.both_ways((3, y - 1), (3, y), Users::ALL);
    }
    pen.place((3, 3), (3, 2), "R15", false);
    pen.both_ways((3, 3), (3, 4), Users::ROBOTS);
    for (i, (x, y)) in [1, 2, 4, 5].into_iter().flat_map(|x| [1, 2, 3].map(|y| (x, y))).enumerate() {
        pen.storage((x, y), format!("S{}", i + 1));
        let beside = if x == 1 || x == 4 { (x - 1, y) } else { (x + 1, y) };
        let open = if beside == (3, 3) { (x, 4) } else { beside };
        pen.both_ways((x, y), open, Users::ROBOTS);
    }
    for (x, y) in [(1, 1), (1, 2), (2, 1), (2, 2), (4, 1), (4, 2), (5, 1), (5, 2)] {
        pen.both_ways((x, y), (x, y + 1), Users::UNLOADED);
    }
    pen.place((5, 5), (5, 4), "R118", true);
    pen.place((1, 5), (1, 4), "R119", true);
    station(&mut pen, "P", &[("R100", (4, -1)), ("P", (3, -1))], ((4, 0), (3, 0)), 1);
    pen.draft.exits.push("R106".into());
    pen.racks(1.0);
    pen.draft.walkable.extend([outline((0, 0), (6, 4)), outline((3, -1), (4, -1))]);
    pen.draft.obstacles.extend([outline((1, 1), (2, 3)), outline((4, 1), (5, 3))]);
    pen.draft.build().expect("the shipped map is well-formed, a test builds it")
}

/// The simulated warehouse: eight blocks of twelve storage places, two-way aisles, two stations in the south,
/// chargers in the north; 228 nodes and 348 lanes. A pillar takes the north-east corner.
pub fn thesis() -> Warehouse {
    thesis_draft().build().expect("the shipped map is well-formed, a test builds it")
}

pub(super) fn thesis_draft() -> Draft {
    const PILLAR: Cell = (12, 14);
    let mut pen = Pen::new("thesis");
    let is_street = |(x, y): Cell| x % 3 == 0 || y % 7 == 0;
    let cells = || (0..=14).flat_map(|y| (0..=12).map(move |x| (x, y))).filter(|&c| c != PILLAR);
    for (x, y) in cells() {
        if is_street((x, y)) {
            pen.node((x, y), format!("G{x}-{y}"));
        } else {
            pen.storage((x, y), format!("S{x}-{y}"));
        }
    }
    for (x, y) in cells() {
        for next in [(x + 1, y), (x, y + 1)].into_iter().filter(|&next| pen.has(next)).collect::<Vec<_>>() {
            match (is_street((x, y)), is_street(next)) {
                (true, true) => pen.both_ways((x, y), next, Users::ALL),
                (false, false) if next.0 == x => pen.both_ways((x, y), next, Users::UNLOADED),
                (false, false) => {}
                _ => pen.both_ways((x, y), next, Users::ROBOTS),
            }
        }
    }
    for x in 0..=11 {
        let charger = (1..=10).contains(&x);
        let letter = if charger { "C" } else { "P" };
        pen.place((x, 15), (x, 14), format!("{letter}{x}-15"), charger);
    }
    for y in 9..=13 {
        pen.place((-1, y), (0, y), format!("PW{y}"), false);
        pen.place((13, y), (12, y), format!("PE{y}"), false);
    }
    let bay = [(0, -1), (0, -2), (1, -2), (2, -2), (3, -2), (3, -1)];
    for (letter, mirror) in [("W", false), ("E", true)] {
        let turn = |(x, y): Cell| if mirror { (12 - x, y) } else { (x, y) };
        let names = [".q4", ".q3", ".q2", ".q1", "", ".out"].map(|end| format!("{letter}{end}"));
        let way: Vec<(&str, Cell)> = names.iter().map(String::as_str).zip(bay.map(turn)).collect();
        station(&mut pen, letter, &way, (turn((0, 0)), turn((3, 0))), 4);
    }
    pen.draft.exits.extend(["G0-14".to_string(), "G12-13".to_string()]);
    pen.racks(0.75);
    pen.draft.walkable.push(outline((0, 0), (12, 14)));
    pen.draft.obstacles.push(outline(PILLAR, PILLAR));
    for (x, y) in [1, 4, 7, 10].into_iter().flat_map(|x| [(x, 1), (x, 8)]) {
        pen.draft.obstacles.push(outline((x, y), (x + 1, y + 5)));
    }
    pen.draft
}

/// Adds a station along `way`, of which the first `queue` nodes are its queue and the next is the station
/// itself; `ends` are the floor cells before and after.
fn station(pen: &mut Pen, name: &str, way: &[(&str, Cell)], ends: (Cell, Cell), queue: usize) {
    for &(name, cell) in way {
        pen.node(cell, name);
    }
    let cells: Vec<Cell> =
        std::iter::once(ends.0).chain(way.iter().map(|(_, c)| *c)).chain([ends.1]).collect();
    for pair in cells.windows(2) {
        pen.one_way(pair[0], pair[1], Users::ALL);
    }
    pen.draft.stations.push(DraftStation {
        name: name.into(),
        node: way[queue].0.into(),
        queue: way[..queue].iter().rev().map(|(name, _)| name.to_string()).collect(),
        pick: Span::from_secs(8),
        cell: None,
    });
}

//! Small maps drawn with letters, for tests and examples.
//!
//! Main function: [`sketch`]. Refuses: anything that letters cannot express; add that to the draft.

use super::{Draft, DraftLane, DraftNode, DraftRack, DraftStation, Users};
use crate::geometry::Point;
use crate::time::Span;
use std::collections::BTreeMap;

/// A draft drawn with letters, one metre apart, the last row at `y = 0`, nodes named `x,y`.
///
/// `.` open floor, `X` exit, `R` storage with a rack, `S` storage without one, `C` charger, `P` parking,
/// `1` to `9` station without a queue; anything else is no node. Neighbours are joined by lanes both ways if
/// one of them is open floor; two storage nodes are joined for unloaded robots only.
pub fn sketch(drawing: &str) -> Draft {
    let rows: Vec<&str> = drawing.lines().map(str::trim).filter(|row| !row.is_empty()).collect();
    let mut cells: BTreeMap<(usize, usize), char> = BTreeMap::new();
    for (y, row) in rows.iter().rev().enumerate() {
        let known = row.chars().enumerate().filter(|(_, c)| ".XRSCP123456789".contains(*c));
        cells.extend(known.map(|(x, c)| ((x, y), c)));
    }
    let mut draft = Draft { name: "sketch".into(), footprint_m: 0.9, ..Draft::default() };
    for (&(x, y), &letter) in &cells {
        let name = format!("{x},{y}");
        draft.nodes.push(DraftNode { name: name.clone(), at: Point::new(x as f64, y as f64) });
        for next in [(x + 1, y), (x, y + 1)] {
            if let Some(users) = cells.get(&next).and_then(|&other| users_between(letter, other)) {
                let to = format!("{},{}", next.0, next.1);
                draft.lanes.push(DraftLane::both_ways(name.clone(), to, users));
            }
        }
        role(&mut draft, letter, name);
    }
    draft
}

fn users_between(one: char, other: char) -> Option<Users> {
    let (open, storage) = (['.', 'X'], ['R', 'S']);
    if open.contains(&one) || open.contains(&other) {
        Some(Users::ALL)
    } else if storage.contains(&one) && storage.contains(&other) {
        Some(Users::UNLOADED)
    } else {
        None
    }
}

fn role(draft: &mut Draft, letter: char, node: String) {
    match letter {
        'X' => draft.exits.push(node),
        'C' => draft.chargers.push(node),
        'P' => draft.parking.push(node),
        'S' => draft.storage.push(node),
        'R' => {
            draft.racks.push(DraftRack::plain(format!("rack {node}"), &node));
            draft.storage.push(node);
        }
        '1'..='9' => {
            let name = format!("station {letter}");
            draft.stations.push(DraftStation {
                name,
                node,
                queue: Vec::new(),
                pick: Span::from_secs(8),
                cell: None,
            });
        }
        _ => {}
    }
}

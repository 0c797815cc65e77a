//! The area beyond the west or the east road of a hall: station bays, chargers, doors.
//!
//! Main type: [`Side`]. Everything is laid out for the west side, where the outer lane runs south; the east side is the
//! same turned by half a circle, and so is the traffic. A bay turns in from the outer lane one row before it comes out
//! again, so that robots coming out never meet robots turning in. Refuses: bays at the ends of roads between groups,
//! which carry the through traffic.

use super::blocks::HallDraft;
use super::pen::{Cell, outline, point};
use crate::time::Span;
use crate::warehouse::Users;
use crate::warehouse::bay::Bay;

/// One side of a hall. Rows count as on the west side, from the south.
pub(super) struct Side {
    turned: bool,
    width: i64,
    height: i64,
    /// Rows in which stations are entered; each station is left in the row south of its own.
    bays: Vec<i64>,
    /// Rows that are left for chargers and parking places.
    free: Vec<i64>,
    /// Rows at the ends of roads between groups, and the south-west corner.
    doors: Vec<i64>,
}

impl Side {
    /// Finds room for up to `stations` bays; `turned` means the east side.
    pub fn new(hall: &HallDraft, turned: bool, stations: usize) -> Side {
        let (width, height) = (hall.along_y.extent, hall.along_x.extent);
        let row = |y: i64| if turned { height - 1 - y } else { y };
        // Whether the street in a row runs towards this side.
        let inwards = |y: i64| hall.along_x.at(row(y)).map(|forward| forward == turned);
        let mut left: Vec<bool> = (0..height).map(|y| !hall.along_x.on_road(row(y))).collect();
        let mut take = |wanted: usize, fits: &dyn Fn(i64) -> bool| {
            let (mut rows, mut trial) = (Vec::new(), left.clone());
            for y in (1..height).rev() {
                if trial[y as usize] && trial[y as usize - 1] && fits(y) {
                    rows.push(y);
                    trial[y as usize] = false;
                    trial[y as usize - 1] = false;
                }
            }
            let count = wanted.min(rows.len());
            let chosen: Vec<i64> = (0..count).map(|i| rows[(2 * i + 1) * rows.len() / (2 * count)]).collect();
            for &y in &chosen {
                left[y as usize] = false;
                left[y as usize - 1] = false;
            }
            chosen
        };
        // Best: straight in from an aisle, or straight out into one. Then any other row.
        let mut bays = take(stations, &|y| inwards(y) == Some(true) || inwards(y - 1) == Some(false));
        bays.extend(take(stations - bays.len(), &|_| true));
        bays.sort_unstable();
        let free = (0..height).filter(|&y| left[y as usize]).collect();
        let roads = hall.along_x.roads.iter().map(|&r| row(r)).filter(|&y| y > 1 && y < height - 2);
        let doors = std::iter::once(0).chain(roads).collect();
        Side { turned, width, height, bays, free, doors }
    }

    fn cell(&self, (x, y): Cell) -> Cell {
        if self.turned { (self.width - 1 - x, self.height - 1 - y) } else { (x, y) }
    }

    /// Adds the bays, and lanes across the two lanes of the road before them.
    pub fn stations(&self, hall: &mut HallDraft, queue: usize, pick: Span) {
        let letter = if self.turned { "E" } else { "W" };
        for (i, &y) in self.bays.iter().enumerate() {
            let (entry, exit) = (self.cell((0, y)), self.cell((0, y - 1)));
            let (before, after) = (self.cell((1, y)), self.cell((1, y - 1)));
            if hall.along_x.at(entry.1) != Some(self.turned) {
                hall.pen.one_way(before, entry, Users::ALL);
            }
            if hall.along_x.at(exit.1) != Some(!self.turned) {
                hall.pen.one_way(exit, after, Users::ALL);
            }
            let named = |cell: Cell| (hall.pen.name(cell).to_string(), point(cell));
            let bay = Bay {
                name: format!("{letter}{}", i + 1),
                entry: named(entry),
                exit: named(exit),
                outward: point(entry) - point(before),
                queue,
                pick,
            };
            bay.add_to(&mut hall.pen.draft);
        }
    }

    /// The places beside the road between the bays, each with the floor cell before it.
    pub fn places(&self) -> Vec<(Cell, Cell)> {
        self.free.iter().map(|&y| (self.cell((-1, y)), self.cell((0, y)))).collect()
    }

    /// Adds doors for people.
    pub fn doors(&self, hall: &mut HallDraft) {
        for &y in &self.doors {
            let (door, floor) = (self.cell((-1, y)), self.cell((0, y)));
            let name = hall.pen.node(door, format!("D{}", hall.pen.draft.exits.len() + 1));
            hall.pen.draft.exits.push(name);
            hall.pen.both_ways(door, floor, Users::PEOPLE);
            hall.pen.draft.walkable.push(outline(door, door));
        }
    }
}

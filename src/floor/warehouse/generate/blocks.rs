//! Halls of storage blocks two deep, with one-way aisles between them and main roads around groups of them.
//!
//! Main type: [`Blocks`]. Every street runs across the whole floor in one direction, roads are two streets side by side
//! with traffic on the right; so the outermost lanes are a ring that can be reached from every node, and from which
//! every node can be reached. Refuses: dead ends.

use super::pen::{Cell, Pen, outline};
use super::side::Side;
use crate::time::Span;
use crate::warehouse::{Draft, Users};

/// Parameters of a hall; see [`Blocks::draft`].
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    /// Name of the map.
    pub name: String,
    /// Numbers of groups of blocks along x and y, with main roads around each.
    pub groups: (usize, usize),
    /// Numbers of blocks in each group along x and y, with aisles between them.
    pub blocks: (usize, usize),
    /// Number of storage places of a block along x; along y it has two.
    pub block_length: usize,
    /// Number of stations beyond the west road, limited by the room.
    pub stations_west: usize,
    /// Number of stations beyond the east road, limited by the room.
    pub stations_east: usize,
    /// Number of waiting places of each station.
    pub queue: usize,
    /// Usual length of a pick.
    pub pick: Span,
    /// Number of charging places, limited by the room: between the stations, then north and south.
    pub chargers: usize,
    /// Number of parking places beside the north and south roads, limited by the room.
    pub parking: usize,
    /// Share of the storage places with a rack, 0 to 1.
    pub fill: f64,
    /// Metres between the two lanes of a main road: 1, or more for vehicles that robots are to pass there.
    pub road_m: f64,
}

impl Default for Blocks {
    fn default() -> Blocks {
        Blocks {
            name: "blocks".into(),
            groups: (1, 1),
            blocks: (3, 6),
            block_length: 5,
            stations_west: 2,
            stations_east: 2,
            queue: 4,
            pick: Span::from_secs(8),
            chargers: 8,
            parking: 8,
            fill: 0.85,
            road_m: 1.0,
        }
    }
}

/// Streets along one axis, by their coordinate on the other.
pub(super) struct Streets {
    /// Length of the other axis, cells.
    pub extent: i64,
    /// Whether the street at each coordinate runs towards growing coordinates; nothing if there is none.
    pub forward: Vec<Option<bool>>,
    /// The first coordinate of each road of two streets.
    pub roads: Vec<i64>,
}

impl Streets {
    /// Lays out streets; `first` is the direction of the first street of each road; aisles alternate.
    fn new(groups: usize, blocks: usize, block: usize, first: bool) -> Streets {
        let (mut forward, mut roads) = (Vec::new(), Vec::new());
        for group in 0..=groups {
            roads.push(forward.len() as i64);
            forward.extend([Some(first), Some(!first)]);
            let mut last = !first;
            for b in 0..if group < groups { blocks } else { 0 } {
                if b > 0 {
                    last = !last;
                    forward.push(Some(last));
                }
                forward.extend(vec![None; block]);
            }
        }
        Streets { extent: forward.len() as i64, forward, roads }
    }

    pub fn at(&self, coordinate: i64) -> Option<bool> {
        self.forward[coordinate as usize]
    }

    pub fn on_road(&self, coordinate: i64) -> bool {
        self.roads.iter().any(|&r| coordinate == r || coordinate == r + 1)
    }
}

/// A hall that is being drawn.
pub(super) struct HallDraft {
    pub pen: Pen,
    /// Streets along y, by x.
    pub along_y: Streets,
    /// Streets along x, by y.
    pub along_x: Streets,
}

impl Blocks {
    /// The hall: from south to north and from west to east a road, then blocks and aisles and further roads, with a
    /// road at the end; station bays, chargers and parking places beyond the outermost roads; a door for people at two
    /// corners and at the ends of the roads between the groups.
    ///
    /// The pitch is 1 m, but for the lanes of main roads. Storage places open to the aisle along their row and, at the
    /// ends of a block, to the aisle there; unloaded robots also drive beneath the racks of a block.
    pub fn draft(&self) -> Draft {
        let mut hall = HallDraft {
            pen: Pen::new(&self.name),
            along_y: Streets::new(self.groups.0, self.blocks.0, self.block_length, false),
            along_x: Streets::new(self.groups.1, self.blocks.1, 2, true),
        };
        hall.cells();
        hall.streets();
        hall.storage();
        hall.pen.racks(self.fill);
        hall.outlines();
        let west = Side::new(&hall, false, self.stations_west);
        let east = Side::new(&hall, true, self.stations_east);
        for side in [&west, &east] {
            side.stations(&mut hall, self.queue, self.pick);
            side.doors(&mut hall);
        }
        self.places(&mut hall, &[west, east]);
        hall.widened(self.road_m)
    }

    /// Adds chargers between the stations; the others and the parking places go north and south, mixed evenly.
    fn places(&self, hall: &mut HallDraft, sides: &[Side; 2]) {
        let between = sides.iter().flat_map(|side| side.places()).take(self.chargers);
        let between: Vec<(Cell, Cell)> = between.collect();
        let (w, h) = (hall.along_y.extent, hall.along_x.extent);
        let south = (2..w - 2).map(|x| ((x, -1), (x, 0)));
        let north = (2..w - 2).map(|x| ((x, h), (x, h - 1)));
        let north_south: Vec<(Cell, Cell)> = south.chain(north).collect();
        let chargers = self.chargers - between.len();
        let wanted = (chargers + self.parking).min(north_south.len());
        let room = north_south.len();
        let spread = (0..wanted).map(|i| north_south[(2 * i + 1) * room / (2 * wanted)]);
        let is_charger = |i: usize| (i + 1) * chargers / wanted.max(1) > i * chargers / wanted.max(1);
        let roles = (0..wanted).map(is_charger);
        let all: Vec<((Cell, Cell), bool)> =
            between.into_iter().map(|p| (p, true)).chain(spread.zip(roles)).collect();
        let (mut c, mut p) = (0, 0);
        for ((cell, floor), charger) in all {
            let (letter, count) = if charger { ("C", &mut c) } else { ("P", &mut p) };
            *count += 1;
            hall.pen.place(cell, floor, format!("{letter}{count}"), charger);
        }
    }
}

impl Streets {
    /// Where a coordinate comes to lie if the lanes of each road are this many metres apart.
    fn widened(&self, coordinate: f64, road_m: f64) -> f64 {
        let between = self.roads.iter().map(|&road| (coordinate - road as f64).clamp(0.0, 1.0));
        coordinate + (road_m - 1.0) * between.sum::<f64>()
    }
}

impl HallDraft {
    /// The draft with the lanes of each main road this many metres apart.
    fn widened(self, road_m: f64) -> Draft {
        let HallDraft { pen, along_y, along_x } = self;
        let mut draft = pen.draft;
        let outlines = draft.walkable.iter_mut().chain(&mut draft.obstacles).flatten();
        for at in draft.nodes.iter_mut().map(|node| &mut node.at).chain(outlines) {
            (at.x, at.y) = (along_y.widened(at.x, road_m), along_x.widened(at.y, road_m));
        }
        draft
    }

    pub fn is_street(&self, (x, y): Cell) -> bool {
        self.along_y.at(x).is_some() || self.along_x.at(y).is_some()
    }

    fn cells(&mut self) {
        for y in 0..self.along_x.extent {
            for x in 0..self.along_y.extent {
                if self.is_street((x, y)) {
                    self.pen.node((x, y), format!("A{x}-{y}"));
                } else {
                    self.pen.storage((x, y), format!("S{x}-{y}"));
                }
            }
        }
    }

    fn streets(&mut self) {
        let (w, h) = (self.along_y.extent, self.along_x.extent);
        let mut lane = |a: Cell, b: Cell, forward: bool| {
            let (from, to) = if forward { (a, b) } else { (b, a) };
            self.pen.one_way(from, to, Users::ALL);
        };
        for (y, forward) in (0..h).filter_map(|y| Some((y, self.along_x.at(y)?))) {
            (1..w).for_each(|x| lane((x - 1, y), (x, y), forward));
        }
        for (x, forward) in (0..w).filter_map(|x| Some((x, self.along_y.at(x)?))) {
            (1..h).for_each(|y| lane((x, y - 1), (x, y), forward));
        }
    }

    fn storage(&mut self) {
        for y in 0..self.along_x.extent {
            for x in (0..self.along_y.extent).filter(|&x| !self.is_street((x, y))).collect::<Vec<_>>() {
                for (dx, dy) in [(0, -1), (0, 1), (-1, 0), (1, 0)] {
                    let next = (x + dx, y + dy);
                    if !self.is_street(next) {
                        if dx + dy > 0 {
                            self.pen.both_ways((x, y), next, Users::UNLOADED);
                        }
                    } else if dx == 0 || !self.along_y.on_road(next.0) {
                        self.pen.both_ways((x, y), next, Users::ROBOTS);
                    }
                }
            }
        }
    }

    /// Adds outlines: people walk on the streets, and the blocks are obstacles.
    fn outlines(&mut self) {
        let (w, h) = (self.along_y.extent, self.along_x.extent);
        self.pen.draft.walkable.push(outline((0, 0), (w - 1, h - 1)));
        let runs = |streets: &Streets| -> Vec<(i64, i64)> {
            let starts =
                (1..streets.extent).filter(|&c| streets.at(c).is_none() && streets.at(c - 1).is_some());
            starts.map(|s| (s, (s..).take_while(|&c| streets.at(c).is_none()).last().unwrap_or(s))).collect()
        };
        let (columns, rows) = (runs(&self.along_y), runs(&self.along_x));
        for &(bottom, top) in &rows {
            for &(left, right) in &columns {
                self.pen.draft.obstacles.push(outline((left, bottom), (right, top)));
            }
        }
    }
}

//! Benchmark floors: octile `.map` files and the kiva endpoint format, as four-connected grids of single cells.
//!
//! Main type: [`Grid`]. Refuses: to know what cells are for; to run a fleet on such a floor, import the map instead.

use giveway_floor::geometry::Point;
use giveway_floor::id::NodeId;
use giveway_floor::warehouse::{Draft, DraftLane, DraftNode, Users, Warehouse};
use std::sync::Arc;

/// Letters of free floor. Swamp (`S`) is free in octile maps, as are the places for picking and delivery that maps of
/// the League of Robot Runners call `S` and `E`; `e` and `r` are endpoints and homes of the kiva format.
const FREE: &str = ".GSEer";

/// Letters of cells that robots cannot enter.
const WALLS: &str = "@OTW";

/// A floor of square cells.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Number of cells in a row.
    pub width: usize,
    /// The floor, one node per free cell, one metre apart.
    pub warehouse: Arc<Warehouse>,
    nodes: Vec<Option<NodeId>>,
}

impl Grid {
    /// Reads either format: octile floors start with `type`, kiva floors with `rows,columns`. Cells are numbered as in
    /// the file, row after row, walls included.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn parse(text: &str) -> Result<Grid, String> {
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        let header = if text.starts_with("type") {
            lines
                .iter()
                .position(|l| *l == "map")
                .ok_or("an octile map needs a line `map` before its rows")?
                + 1
        } else {
            4
        };
        let rows: Vec<&str> =
            lines.get(header..).unwrap_or(&[]).iter().copied().filter(|l| !l.is_empty()).collect();
        let width = rows.first().map_or(0, |r| r.len());
        if width == 0 || rows.iter().any(|r| r.len() != width) {
            return Err(format!("rows {header} and after must be of one length and not empty"));
        }
        let mut cells = Vec::with_capacity(width * rows.len());
        for (row, text) in rows.iter().enumerate() {
            for (column, letter) in text.bytes().enumerate() {
                let free = is_free(letter).ok_or_else(|| {
                    let letter = char::from(letter);
                    format!("row {row}, column {column}: {letter:?} is none of {FREE:?} (free) and {WALLS:?} (walls)")
                })?;
                cells.push(free);
            }
        }
        Ok(Grid::from_cells(width, &cells))
    }

    fn from_cells(width: usize, cells: &[bool]) -> Grid {
        let mut draft = Draft { name: "grid".into(), footprint_m: 0.9, ..Draft::default() };
        let mut nodes = vec![None; cells.len()];
        for i in (0..cells.len()).filter(|i| cells[*i]) {
            nodes[i] = Some(NodeId(draft.nodes.len() as u32));
            let at = Point::new((i % width) as f64, -((i / width) as f64));
            draft.nodes.push(DraftNode { name: format!("c{i}"), at });
            let left = (i % width > 0 && cells[i - 1]).then(|| i - 1);
            let up = (i >= width && cells[i - width]).then(|| i - width);
            for other in left.into_iter().chain(up) {
                draft.lanes.push(DraftLane::both_ways(format!("c{other}"), format!("c{i}"), Users::ALL));
            }
        }
        Grid { width, warehouse: Arc::new(draft.build_unchecked()), nodes }
    }

    /// The node of a cell, counted along rows; nothing for walls and beyond the floor.
    pub fn node(&self, cell: usize) -> Option<NodeId> {
        self.nodes.get(cell).copied().flatten()
    }

    /// Whether two nodes are the same cell or neighbours.
    pub fn adjacent(&self, a: NodeId, b: NodeId) -> bool {
        let d = self.warehouse.nodes[a].at - self.warehouse.nodes[b].at;
        d.x.abs() + d.y.abs() < 1.5
    }
}

/// Whether robots can enter a cell of this letter; nothing for a letter of neither format, so that a floor is never
/// read with walls that are not there.
fn is_free(letter: u8) -> Option<bool> {
    let letter = char::from(letter);
    if FREE.contains(letter) { Some(true) } else { WALLS.contains(letter).then_some(false) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn emitters_and_shelves_of_the_league_of_robot_runners_are_free_floor() {
        let grid = Grid::parse("type octile\nheight 2\nwidth 4\nmap\nE.S@\n@SST\n").expect("a floor");
        let free: Vec<usize> = (0..8).filter(|&c| grid.node(c).is_some()).collect();
        assert_eq!(free, [0, 1, 2, 5, 6]);
        let node = |cell| grid.node(cell).expect("free");
        assert!(grid.adjacent(node(2), node(6)));
        assert_eq!(grid.warehouse.lanes.len(), 5, "every two neighbours are joined");
    }

    #[test]
    fn endpoints_and_homes_of_the_kiva_format_are_free_floor() {
        let grid = Grid::parse("1,4\n1\n1\n100\nre.@\n").expect("a floor");
        assert_eq!(grid.warehouse.nodes.len(), 3);
    }

    #[test]
    fn a_letter_of_neither_format_is_refused_with_its_place() {
        let error = Grid::parse("type octile\nheight 1\nwidth 2\nmap\n.x\n").expect_err("no letter x");
        assert!(error.starts_with("row 0, column 1: 'x'"), "{error}");
    }
}

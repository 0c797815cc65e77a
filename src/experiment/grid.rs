//! Benchmark floors: octile `.map` files and the kiva endpoint format, as four-connected grids of single cells.
//!
//! Main type: [`Grid`]. Refuses: to know what cells are for; for a floor to work on, import the map instead.

use crate::geometry::Point;
use crate::id::NodeId;
use crate::warehouse::{Draft, DraftLane, DraftNode, Users, Warehouse};
use std::sync::Arc;

/// A floor of square cells.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Cells in a row.
    pub width: usize,
    /// The floor, one node per free cell, one metre apart.
    pub warehouse: Arc<Warehouse>,
    nodes: Vec<Option<NodeId>>,
}

impl Grid {
    /// Reads either format: octile floors start with `type`, kiva floors with `rows,columns`.
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
        let free = |c: u8| matches!(c, b'.' | b'G' | b'e' | b'r');
        let cells: Vec<bool> = rows.iter().flat_map(|r| r.bytes().map(free)).collect();
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
                draft.lanes.push(DraftLane {
                    from: format!("c{other}"),
                    to: format!("c{i}"),
                    both: true,
                    length_m: None,
                    speed_limit_mps: None,
                    users: Users::ALL,
                });
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

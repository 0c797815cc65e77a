//! The middle lines of the free floor: its generalised Voronoi diagram, one cell wide.
//!
//! Main function: [`skeleton`]. Free cells are removed from the walls inwards, in the order of their distance to the
//! cells that are not free, as long as the floor stays connected and keeps its loops (distance-ordered homotopic
//! thinning, Pudney 1998). The remaining cells have the same distance to two walls, and exactly one line runs between
//! any two obstacles. A dead end is removed from its end, unless a cell in it is to be kept. Refuses: branches into
//! corners, which a plain diagram has everywhere and people do not walk.

use super::floor::Raster;
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// Which cells are middle lines. Cells in `keep` are, if they are free.
pub(super) fn skeleton(floor: &Raster, keep: &BTreeSet<usize>) -> Vec<bool> {
    let mut left: Vec<bool> = floor.clear2.iter().map(|c| *c > 0).collect();
    let mut queued = vec![false; left.len()];
    let mut queue = BinaryHeap::new();
    for i in (0..left.len()).filter(|i| floor.clear2[*i] == 1) {
        queued[i] = true;
        queue.push(Reverse((floor.clear2[i], i)));
    }
    while let Some(Reverse((_, i))) = queue.pop() {
        queued[i] = false;
        if !left[i] || keep.contains(&i) || !is_simple(&left, &around(floor.columns, i)) {
            continue;
        }
        left[i] = false;
        for j in around(floor.columns, i) {
            if left[j] && !queued[j] {
                queued[j] = true;
                queue.push(Reverse((floor.clear2[j], j)));
            }
        }
    }
    left
}

/// The eight neighbours, anticlockwise from the east. Free cells are never outermost.
pub(super) fn around(columns: usize, i: usize) -> [usize; 8] {
    let (north, south) = (i + columns, i - columns);
    [i + 1, north + 1, north, north - 1, i - 1, south - 1, south, south + 1]
}

/// Whether removing the cell changes neither the number of parts of the floor (with diagonal neighbours) nor the number
/// of holes: Hilditch's crossing number is one.
fn is_simple(left: &[bool], around: &[usize; 8]) -> bool {
    let x = around.map(|j| left[j]);
    let crossings = [0, 2, 4, 6].into_iter().filter(|&k| !x[k] && (x[k + 1] || x[(k + 2) % 8])).count();
    crossings == 1
}

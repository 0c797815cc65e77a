//! Whether lines can be picked at all.
//!
//! Main type: [`LineProblem`], main function: [`problem`]. Refuses: to know whether a slot has goods.

use super::{OrderLine, PickedBy};
use giveway_floor::id::{RackId, StationId};
use giveway_floor::warehouse::Warehouse;

/// Largest number of lines in one visit.
pub const MOST_LINES: usize = 200;
/// Largest number of pieces in one line.
pub const MOST_PIECES: u32 = 10_000;

/// Why a line cannot be picked from a rack at a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LineProblem {
    /// The station has no work cell.
    NoCell,
    /// The map does not say what slots the rack has.
    NoSlots,
    /// The rack does not have the slot.
    UnknownSlot,
    /// The station does not have the tote.
    UnknownTote,
    /// No piece, or more than [`MOST_PIECES`].
    Quantity,
    /// An earlier line, with this number counted from 0, has the same slot, tote and item.
    Twice(usize),
    /// Only an arm may pick it, and the station has none.
    NoArm,
    /// The visit has more than [`MOST_LINES`] lines.
    TooMany,
}

/// The first line, counted from 0, that cannot be picked from a rack at a station, and why. Linear in the number of
/// lines, except for lines of one slot, which are compared with one another.
pub fn problem(
    w: &Warehouse,
    rack: RackId,
    station: StationId,
    lines: &[OrderLine],
) -> Option<(usize, LineProblem)> {
    if lines.len() > MOST_LINES {
        return Some((MOST_LINES, LineProblem::TooMany));
    }
    let found =
        |(n, line): (usize, &OrderLine)| Some((n, line_problem(w, rack, station, (&lines[..n], line))?));
    lines.iter().enumerate().find_map(found)
}

fn line_problem(
    w: &Warehouse,
    rack: RackId,
    station: StationId,
    (before, line): (&[OrderLine], &OrderLine),
) -> Option<LineProblem> {
    let Some(cell) = &w.stations[station].cell else { return Some(LineProblem::NoCell) };
    let Some(rack_type) = w.racks[rack].rack_type else { return Some(LineProblem::NoSlots) };
    if !w.rack_types[rack_type].has(line.slot) {
        return Some(LineProblem::UnknownSlot);
    }
    if cell.tote_named(&line.tote).is_none() {
        return Some(LineProblem::UnknownTote);
    }
    if !(1..=MOST_PIECES).contains(&line.quantity) {
        return Some(LineProblem::Quantity);
    }
    if line.by == PickedBy::Arm && cell.arm.is_none() {
        return Some(LineProblem::NoArm);
    }
    let same =
        |other: &OrderLine| (other.slot, &other.tote, &other.item) == (line.slot, &line.tote, &line.item);
    before.iter().position(same).map(LineProblem::Twice)
}

//! Warehouse grids with endpoints: a header (`rows,columns`, endpoints, homes, longest time), then rows of `@` shelf,
//! `e` endpoint, `r` robot's home, `.` floor.
//!
//! Main function: [`parse`]. Things missing from the format are added: racks on the shelf cells beside endpoints,
//! chargers in place of some homes, station bays beyond the left and right end of the floor. Refuses: to give robots a
//! home that can only be reached through another home; such cells stay floor.

use super::grid::LetterGrid;
use super::{ImportNotes, MapError, Options};
use crate::time::Span;
use crate::warehouse::bay::Bay;
use crate::warehouse::{Draft, DraftRack, Users};
use nalgebra::Vector2;

const LETTERS: &str = "@er.";

/// Reads a warehouse grid.
///
/// # Errors
/// [`MapError::Syntax`] if header or rows do not follow the format.
pub fn parse(text: &str, options: &Options) -> Result<(Draft, ImportNotes), MapError> {
    let (grid, said) = read(text)?;
    let mut notes = ImportNotes::default();
    let mut floor = grid.which("er.");
    let dropped = grid.keep_largest_part(&mut floor);
    if dropped > 0 {
        notes.0.push(format!("{dropped} cells left out: no path joins them to the largest part"));
    }
    let homes = grid.which("r");
    let driven = floor.clone();
    let mut places = grid.take_places(&mut floor, &homes, usize::MAX);
    grid.take_more_places(&mut floor, &homes, &mut places, usize::MAX);
    let lost = (0..homes.len()).filter(|&c| homes[c] && driven[c] && !places[c]).count();
    if lost > 0 {
        notes.0.push(format!("{lost} homes stay floor, so that the others can be reached"));
    }
    let storage = storage(&grid, &floor);
    let mut draft = grid.draft(options);
    let cells = Cells { floor, places, storage };
    nodes(&grid, &cells, options, &mut draft, &mut notes);
    grid.add_lanes(&mut draft, |a, b| cells.users_between(a, b));
    grid.add_outlines(&mut draft, &driven, options);
    stations(&grid, &cells.floor, options, &mut draft, &mut notes);
    for (said, letter, what) in [(said.endpoints, "e", "endpoints"), (said.homes, "r", "homes")] {
        let found = grid.which(letter).iter().filter(|c| **c).count();
        if found != said {
            notes.0.push(format!("the header says {said} {what}, the rows have {found}: the rows count"));
        }
    }
    Ok((draft, notes))
}

/// The purpose of each cell; at most one is true.
struct Cells {
    floor: Vec<bool>,
    places: Vec<bool>,
    storage: Vec<bool>,
}

impl Cells {
    fn users_between(&self, a: usize, b: usize) -> Option<Users> {
        let stays = |c: usize| self.places[c] || self.storage[c];
        if self.floor[a] && self.floor[b] {
            Some(Users::ALL)
        } else if self.floor[a] && stays(b) || stays(a) && self.floor[b] {
            Some(Users::ROBOTS)
        } else if self.storage[a] && self.storage[b] {
            Some(Users::UNLOADED)
        } else {
            None
        }
    }
}

/// What the header says besides the size.
struct Said {
    endpoints: usize,
    homes: usize,
}

fn read(text: &str) -> Result<(LetterGrid, Said), MapError> {
    let mut lines = text.lines();
    let mut numbers = |line: usize, many: usize, what: &str| {
        let read: Option<Vec<usize>> =
            lines.next().unwrap_or_default().split(',').map(|n| n.trim().parse().ok()).collect();
        let message = || MapError::syntax(line, 0, format!("{what} expected"));
        read.filter(|n| n.len() == many && n.iter().all(|&n| n <= 1_000_000_000)).ok_or_else(message)
    };
    let size = numbers(1, 2, "rows,columns")?;
    let endpoints = numbers(2, 1, "the number of endpoints")?[0];
    let homes = numbers(3, 1, "the number of homes")?[0];
    numbers(4, 1, "the longest time")?;
    let (height, width) = (size[0], size[1]);
    if !(1..=4096).contains(&height) || !(1..=4096).contains(&width) {
        return Err(MapError::syntax(1, 0, "rows and columns must be from 1 to 4096"));
    }
    let grid = LetterGrid::read(lines, (width, height), 5, LETTERS)?;
    Ok((grid, Said { endpoints, homes }))
}

/// Shelf cells that touch an endpoint on the floor, and become storage.
fn storage(grid: &LetterGrid, floor: &[bool]) -> Vec<bool> {
    let touches = |c: usize| grid.around(c).any(|n| floor[n] && grid.cells[n] == b'e');
    (0..grid.cells.len()).map(|c| grid.cells[c] == b'@' && touches(c)).collect()
}

fn nodes(grid: &LetterGrid, cells: &Cells, options: &Options, draft: &mut Draft, notes: &mut ImportNotes) {
    let share = options.charger_share.clamp(0.0, 1.0);
    let mut homes = 0.0;
    for c in 0..grid.cells.len() {
        let name = grid.name(c);
        if cells.places[c] {
            let is_charger = ((homes + 1.0) * share).floor() > (homes * share).floor();
            homes += 1.0;
            if is_charger { &mut draft.chargers } else { &mut draft.parking }.push(name);
        } else if cells.storage[c] {
            draft.racks.push(DraftRack::plain(format!("k{}", draft.racks.len() + 1), &name));
            draft.storage.push(name);
        } else if !cells.floor[c] {
            continue;
        }
        grid.add_node(draft, c, options);
    }
    let (racks, chargers) = (draft.racks.len(), draft.chargers.len());
    notes.0.push(format!("{racks} shelf cells beside endpoints became storage with a rack each"));
    notes.0.push(format!("{chargers} of {homes} homes became chargers, the others parking places"));
    let shelves = grid.which("@").iter().filter(|s| **s).count();
    if shelves > racks {
        notes.0.push(format!("{} shelf cells that touch no endpoint were left out", shelves - racks));
    }
}

/// Adds station bays beyond the first and the last column with floor, evenly spaced, entered by one row and left by the
/// next.
fn stations(
    grid: &LetterGrid,
    floor: &[bool],
    options: &Options,
    draft: &mut Draft,
    notes: &mut ImportNotes,
) {
    let has_floor = |column: &usize| (0..grid.height).any(|row| floor[row * grid.width + column]);
    let (Some(first), Some(last)) = ((0..grid.width).find(has_floor), (0..grid.width).rfind(has_floor))
    else {
        return;
    };
    let sides = [(first, -1.0, "W", options.stations.div_ceil(2)), (last, 1.0, "E", options.stations / 2)];
    for (column, outward, side, wanted) in sides {
        let rows = pairs_of_rows(grid, floor, column, wanted);
        if rows.len() < wanted {
            notes.0.push(format!("{} of {wanted} stations added on side {side}: no more room", rows.len()));
        }
        for (i, row) in rows.into_iter().enumerate() {
            let (entry, exit) = (row * grid.width + column, (row + 1) * grid.width + column);
            Bay {
                name: format!("{side}{}", i + 1),
                entry: (grid.name(entry), grid.at(entry, options)),
                exit: (grid.name(exit), grid.at(exit, options)),
                outward: Vector2::new(outward * options.pitch_m, 0.0),
                queue: options.queue,
                pick: Span::from_secs_f64(options.pick_s),
            }
            .add_to(draft);
        }
    }
    notes.0.push(format!("{} stations added beside the grid", draft.stations.len()));
}

/// Up to `wanted` rows, each free at the border together with the next one, no two of the pairs overlapping.
fn pairs_of_rows(grid: &LetterGrid, floor: &[bool], column: usize, wanted: usize) -> Vec<usize> {
    let free = |row: usize| floor[row * grid.width + column];
    let mut left: Vec<usize> =
        (1..grid.height).map(|row| row - 1).filter(|&r| free(r) && free(r + 1)).collect();
    let mut chosen = Vec::new();
    for i in 0..wanted {
        let ideal = (2 * i + 1) * grid.height / (2 * wanted);
        let Some(&row) = left.iter().min_by_key(|row| row.abs_diff(ideal)) else { break };
        left.retain(|r| r.abs_diff(row) > 1);
        chosen.push(row);
    }
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::Dense;
    use crate::warehouse::{NodeKind, summary};

    const SMALL: &str =
        "9,12\n20\n16\n5000\n............\n.rr.eeeee.r.\n.rr.@@@@@.r.\n.rr.eeeee.r.\n............
.rr.eeeee.r.\n.rr.@@@@@.r.\n.rr.eeeee.r.\n............\n";

    #[test]
    fn a_small_floor_becomes_a_well_formed_map_with_racks_stations_and_chargers() {
        let options = Options { stations: 4, queue: 2, ..Options::default() };
        let (draft, notes) = parse(SMALL, &options).expect("a warehouse grid");
        let s = summary(&draft.build().expect("well-formed"));
        assert_eq!((s.storage, s.racks, s.stations, s.queue_places), (10, 10, 4, 8));
        assert_eq!((s.chargers, s.parking), (1, 17));
        assert_eq!(s.nodes, 9 * 12 + 4 * 6, "{notes}");
        let said = "the header says 16 homes, the rows have 18: the rows count";
        assert_eq!(notes.0.last().map(String::as_str), Some(said), "and the 20 endpoints are there");
    }

    #[test]
    fn loaded_robots_do_not_pass_beneath_racks() {
        let (draft, _) = parse(SMALL, &Options::default()).expect("a warehouse grid");
        let w = draft.build().expect("well-formed");
        let beneath = w
            .arcs
            .iter()
            .filter(|a| w.nodes[a.from].kind == NodeKind::Storage && w.nodes[a.to].kind == NodeKind::Storage);
        assert!(beneath.clone().count() == 16 && beneath.clone().all(|a| a.users == Users::UNLOADED));
    }

    #[test]
    fn homes_in_a_large_block_give_way_to_floor_until_each_can_be_reached() {
        let text = "6,7\n2\n20\n100\n.......\n.rrrrr.\n.rrrrr.\n.rrrrr.\n.rrrrr.\n.......\n";
        let (draft, notes) = parse(text, &Options { stations: 0, ..Options::default() }).expect("a grid");
        let w = draft.build().expect("well-formed");
        let staying = w.nodes_where(|kind| kind.is_lasting()).len();
        assert!((12..20).contains(&staying), "{staying} homes\n{notes}");
        assert!(notes.0[0].contains(&format!("{} homes stay floor", 20 - staying)), "{notes}");
    }

    #[test]
    fn station_bays_are_spread_and_never_overlap() {
        let (draft, notes) = parse(SMALL, &Options { stations: 20, ..Options::default() }).expect("a grid");
        let w = draft.build().expect("well-formed");
        assert_eq!(w.stations.len(), 8, "four pairs of nine rows on each side\n{notes}");
        assert!(notes.to_string().contains("4 of 10 stations added on side W"), "{notes}");
        assert!((0..w.resource_count()).all(|r| w.conflicts(Dense::at(r)).is_empty()));
    }

    #[test]
    fn stations_find_room_behind_a_wall_around_the_floor() {
        let text = "6,8\n8\n2\n9\n@@@@@@@@\n@......@\n@.eeee.@\n@.e@@e.@\n@r....r@\n@@@@@@@@\n";
        let (draft, notes) = parse(text, &Options { stations: 2, ..Options::default() }).expect("a grid");
        let w = draft.build().expect("well-formed");
        assert_eq!(w.stations.len(), 2, "{notes}");
    }

    #[test]
    fn bad_headers_and_rows_are_refused() {
        for (text, at) in [
            ("2,2\nx\n0\n0\n..\n..\n", 2),
            ("0,2\n0\n0\n0\n", 1),
            ("2,2\n0\n0\n0\n..\n.T\n", 6),
            ("2,2\n0\n0\n0\n..\n", 6),
        ] {
            match parse(text, &Options::default()) {
                Err(MapError::Syntax { line, .. }) => assert_eq!(line, at, "{text}"),
                other => panic!("{text}: {other:?}"),
            }
        }
    }
}

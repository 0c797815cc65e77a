//! Moving AI `.map` grids: free cells become nodes, some of them parking places.
//!
//! Main function: [`parse`]. The format knows neither racks nor stations, so neither does the map: robots
//! can drive on it from place to place. Refuses: diagonal moves, which cut corners between robots.

use super::grid::LetterGrid;
use super::{ImportNotes, MapError, Options};
use crate::warehouse::{Draft, Users};

/// Every letter of the format, and `E` of the League of Robot Runners, whose `S` is floor like the format's own swamp;
/// the first four are free.
const LETTERS: &str = ".GSE@OTW";
const FREE: &str = ".GSE";

/// Reads an octile grid.
///
/// # Errors
/// [`MapError::Syntax`] if header or rows do not follow the format.
pub fn parse(text: &str, options: &Options) -> Result<(Draft, ImportNotes), MapError> {
    let grid = read(text)?;
    let mut floor = grid.which(FREE);
    let dropped = grid.keep_largest_part(&mut floor);
    let free = floor.iter().filter(|f| **f).count();
    let nodes = floor.clone();
    let most = (free as f64 * options.parking_share.clamp(0.0, 1.0)) as usize;
    let mut parking = grid.take_places(&mut floor, &nodes, most.max(1));
    if !parking.contains(&true) {
        // A ring: each cell joins two others, but any one can go, since the rest is joined the long way round.
        grid.take_more_places(&mut floor, &nodes, &mut parking, 1);
    }

    let mut draft = grid.draft(options);
    for c in (0..nodes.len()).filter(|&c| nodes[c]) {
        grid.add_node(&mut draft, c, options);
        if parking[c] {
            draft.parking.push(grid.name(c));
        }
    }
    grid.add_lanes(&mut draft, |a, b| match (floor[a], floor[b]) {
        (true, true) => Some(Users::ALL),
        (true, false) if parking[b] => Some(Users::ROBOTS),
        (false, true) if parking[a] => Some(Users::ROBOTS),
        _ => None,
    });
    grid.add_outlines(&mut draft, &nodes, options);
    let mut notes = ImportNotes::default();
    if dropped > 0 {
        notes.0.push(format!("{dropped} free cells left out: no path joins them to the largest part"));
    }
    notes.0.push(format!("{} of {free} free cells became parking places", draft.parking.len()));
    Ok((draft, notes))
}

fn read(text: &str) -> Result<LetterGrid, MapError> {
    let mut lines = text.lines();
    let (mut width, mut height) = (None, None);
    for number in 1..=4 {
        let line = lines.next().unwrap_or_default().trim();
        let (key, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let size = || {
            let n = value.trim().parse::<usize>().ok().filter(|n| (1..=4096).contains(n));
            n.ok_or_else(|| MapError::syntax(number, 0, format!("{key} must be a number from 1 to 4096")))
        };
        match (number, key) {
            (1, "type") => {}
            (2 | 3, "height") => height = Some(size()?),
            (2 | 3, "width") => width = Some(size()?),
            (4, "map") => {}
            _ => {
                return Err(MapError::syntax(
                    number,
                    0,
                    "the header is: type octile, height N, width N, map",
                ));
            }
        }
    }
    let (Some(width), Some(height)) = (width, height) else {
        return Err(MapError::syntax(2, 0, "the header must give height and width once each"));
    };
    LetterGrid::read(lines, (width, height), 5, LETTERS)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOMS: &str =
        "type octile\nheight 5\nwidth 9\nmap\n....@....\n....@....\n.........\n....@....\n....@.TT.\n";

    #[test]
    fn rooms_become_a_well_formed_map_with_parking() {
        let (draft, notes) = parse(ROOMS, &Options::default()).expect("an octile grid");
        let w = draft.build().expect("well-formed");
        assert_eq!(w.nodes.len(), 39);
        assert_eq!(w.nodes_where(|kind| kind.is_lasting()).len(), 5);
        assert_eq!(notes.0, ["5 of 39 free cells became parking places"]);
        let top_right = w.node_named("r0c8").expect("a corner");
        assert_eq!((w.nodes[top_right].at.x, w.nodes[top_right].at.y), (8.0, 4.0));
    }

    #[test]
    fn places_of_the_league_of_robot_runners_are_floor_like_any_other() {
        let text = "type octile\nheight 3\nwidth 4\nmap\nE.SS\n..@S\nE.ST\n";
        let (draft, _) = parse(text, &Options::default()).expect("an octile grid");
        let w = draft.build().expect("well-formed");
        assert_eq!(w.nodes.len(), 10);
        assert!(["r0c0", "r0c3", "r2c0", "r2c2"].iter().all(|name| w.node_named(name).is_some()));
    }

    #[test]
    fn one_cell_of_a_ring_becomes_a_place_and_the_rest_stays_joined() {
        for text in [
            "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n",
            // Two rings with a cell in common.
            "type octile\nheight 5\nwidth 5\nmap\n...@@\n.@.@@\n.....\n@@.@.\n@@...\n",
        ] {
            let (draft, notes) = parse(text, &Options::default()).expect("an octile grid");
            let places = draft.parking.len();
            let w = draft.build().unwrap_or_else(|e| panic!("{e}"));
            assert_eq!((w.nodes_where(|kind| kind.is_lasting()).len(), places), (1, 1), "{notes}");
        }
    }

    #[test]
    fn a_floor_in_two_parts_keeps_the_larger_one_and_says_so() {
        let text = "type octile\nheight 2\nwidth 5\nmap\n..@..\n..@.@\n";
        let options = Options { parking_share: 0.3, ..Options::default() };
        let (draft, notes) = parse(text, &options).expect("an octile grid");
        assert_eq!(draft.nodes.len(), 4);
        assert!(notes.0[0].contains("3 free cells left out"), "{notes}");
    }

    #[test]
    fn a_bad_header_is_refused_at_its_line() {
        let line_of = |text: &str| match parse(text, &Options::default()) {
            Err(MapError::Syntax { line, .. }) => line,
            other => panic!("{other:?}"),
        };
        assert_eq!(line_of("type octile\nheight x\nwidth 3\nmap\n"), 2);
        assert_eq!(line_of("type octile\nheight 1\nwidth 99999\nmap\n"), 3);
        assert_eq!(line_of("type octile\nheight 1\nheight 1\nmap\n.\n"), 2);
        assert_eq!(line_of("type octile\nheight 2\nwidth 2\n..\n..\n"), 4);
        assert_eq!(line_of("type octile\nheight 2\nwidth 2\nmap\n..\n.\n"), 6);
    }
}

//! Work cells and types of racks: slots out of every hand's reach, misplaced openings, pickers where robots drive.
//!
//! Main functions: [`rack_types`], [`cells`]. Refuses: to say whether a cell is safe; its walls and guards are outside
//! the map.

use super::Findings;
use super::draft::{good_name, good_outline};
use super::place::FindingPlace;
use crate::geometry::{Point, Segment, inside};
use crate::warehouse::build::{Draft, DraftStation};
use crate::warehouse::cell::{COLUMNS_MAX, Cell, CellOpening, Place, ROWS_MAX, RackType};
use std::collections::{BTreeMap, BTreeSet};

/// Greatest height that a picker reaches, metres.
const HIGH_M: f64 = 3.0;
/// Greatest width and depth of a rack, metres.
const WIDE_M: f64 = 5.0;
/// Greatest distance of an opening from the middle of the robot behind it, metres …
const OPENING_M: f64 = 3.0;
/// … and least distance.
const AT_ROBOT_M: f64 = 0.05;
/// Greatest distance of totes and arms from the workplace, metres.
const BESIDE_M: f64 = 2.0;

/// Checks how bins are arranged, and that racks name existing types.
pub(super) fn rack_types(draft: &Draft, found: &mut Findings) {
    let mut names = BTreeSet::new();
    for rack_type in &draft.rack_types {
        let place = FindingPlace::from(format!("rack type {}", rack_type.name));
        good_name(&rack_type.name, &place, found);
        if !names.insert(rack_type.name.as_str()) {
            found.add(&place, "the name is used twice", "rename one of the two");
        }
        rack_type_numbers(rack_type, &place, found);
    }
    for rack in &draft.racks {
        if let Some(rack_type) = rack.rack_type.as_deref().filter(|t| !names.contains(t)) {
            let place = FindingPlace::of(format!("rack {}", rack.name), [&rack.node]);
            found.add(
                place,
                format!("there is no rack type {rack_type}"),
                "add it to rack_types, or correct the name",
            );
        }
    }
}

fn rack_type_numbers(rack_type: &RackType, place: &FindingPlace, found: &mut Findings) {
    let RackType { columns, heights_m, width_m, face_m, .. } = rack_type;
    if !(1..=COLUMNS_MAX).contains(columns) {
        found.add(
            place,
            format!("{columns} columns"),
            format!("give 1 to {COLUMNS_MAX}: slots have a letter for the column"),
        );
    }
    if heights_m.is_empty() || heights_m.len() > usize::from(ROWS_MAX) {
        let remedy = format!("give a height for each row, 1 to {ROWS_MAX} of them");
        found.add(place, format!("{} heights", heights_m.len()), remedy);
    }
    let rises = heights_m.windows(2).all(|two| two[0] < two[1]);
    if !rises || !heights_m.iter().all(|h| (0.0..=HIGH_M).contains(h)) {
        let remedy = format!("give metres from 0 to {HIGH_M} above the floor, the lowest row first");
        found.add(place, "its rows are not one above the other within reach", remedy);
    }
    if !(*width_m > 0.0 && *width_m <= WIDE_M) {
        found.add(
            place,
            format!("it is {width_m} m wide"),
            format!("give metres, above 0 and up to {WIDE_M}"),
        );
    }
    if !(0.0..=WIDE_M).contains(face_m) {
        let remedy = format!("give metres from the middle of the rack, 0 to {WIDE_M}");
        found.add(place, format!("its face is at {face_m} m"), remedy);
    }
}

/// Checks the work cells of all stations.
pub(super) fn cells(draft: &Draft, at: &BTreeMap<&str, Point>, found: &mut Findings) {
    let driven = driven(draft, at);
    for station in &draft.stations {
        if let Some(cell) = &station.cell {
            one_cell(draft.footprint_m, station, cell, (at, &driven), found);
        }
    }
}

/// The nodes that robots drive over.
fn driven<'a>(draft: &'a Draft, at: &BTreeMap<&str, Point>) -> BTreeMap<&'a str, Point> {
    let lanes = draft.lanes.iter().filter(|l| l.users.loaded || l.users.unloaded);
    let ends = lanes.flat_map(|l| [l.from.as_str(), l.to.as_str()]);
    ends.filter_map(|name| Some((name, *at.get(name)?))).collect()
}

fn one_cell(
    footprint_m: f64,
    station: &DraftStation,
    cell: &Cell,
    (at, driven): (&BTreeMap<&str, Point>, &BTreeMap<&str, Point>),
    found: &mut Findings,
) {
    let name = |part: &str| format!("{part} of station {}", station.name);
    let place = FindingPlace::outline(name("the workplace"), &cell.workplace);
    if !good_outline(&cell.workplace, &place, found) {
        return;
    }
    let half_m = footprint_m / 2.0;
    let reaches = |p: Point| inside(&cell.workplace, p) || distance_m(&cell.workplace, p) < half_m;
    let in_it: Vec<&str> = driven.iter().filter(|(_, p)| reaches(**p)).map(|(name, _)| *name).collect();
    if !in_it.is_empty() {
        let place = FindingPlace { nodes: in_it.iter().map(|n| n.to_string()).collect(), ..place.clone() };
        let problem = format!("robots reach into it at {}", in_it.join(", "));
        found.add(place, problem, "pickers stand apart from robots: move or shrink the workplace");
    }
    let stands = at.get(station.node.as_str()).copied();
    opening(&cell.opening, stands, &FindingPlace::outline(name("the opening"), &cell.opening.outline), found);
    let near = |p: &Place| {
        let below = Point::new(p.x, p.y);
        let is_beside = inside(&cell.workplace, below) || distance_m(&cell.workplace, below) <= BESIDE_M;
        is_beside && (0.0..=HIGH_M).contains(&p.z)
    };
    let remedy = format!("give [x, y, z] within {BESIDE_M} m of the workplace, z from 0 to {HIGH_M} m");
    if cell.totes.is_empty() {
        found.add(name("the cell"), "it has no totes", "add a tote: each order line goes into one");
    }
    let mut names = BTreeSet::new();
    for tote in &cell.totes {
        let place = FindingPlace::from(name(&format!("tote {}", tote.name)));
        good_name(&tote.name, &place, found);
        if !names.insert(tote.name.as_str()) {
            found.add(&place, "the name is used twice", "rename one of the two");
        }
        if !near(&tote.at) {
            found.add(&place, "the picker does not reach it", remedy.as_str());
        }
    }
    if let Some(arm) = &cell.arm {
        let place = FindingPlace::from(name("the arm"));
        good_name(&arm.kind, &place, found);
        if !near(&arm.base) || !arm.heading.is_finite() {
            found.add(&place, "it is not beside the picker", remedy.as_str());
        }
    }
}

fn opening(opening: &CellOpening, stands: Option<Point>, place: &FindingPlace, found: &mut Findings) {
    let (from_m, to_m) = (opening.from_m, opening.to_m);
    if !(from_m >= 0.0 && from_m < to_m && to_m <= HIGH_M) {
        let remedy = format!("give metres above the floor, from_m below to_m, up to {HIGH_M}");
        found.add(place, format!("it is open from {from_m} to {to_m} m"), remedy);
    }
    if !good_outline(&opening.outline, place, found) {
        return;
    }
    let far_m = stands.map(|p| (opening.middle() - p).norm());
    if let Some(far_m) = far_m.filter(|m| !(AT_ROBOT_M..=OPENING_M).contains(m)) {
        let problem = format!("its middle is {far_m:.2} m from where the rack stands");
        found.add(
            place,
            problem,
            format!("put it between rack and picker, {AT_ROBOT_M} to {OPENING_M} m from the node"),
        );
    }
}

/// Distance of a point from the edge of an outline, metres.
fn distance_m(outline: &[Point], p: Point) -> f64 {
    let edges = outline.iter().zip(outline.iter().cycle().skip(1));
    edges.map(|(a, b)| Segment { a: *a, b: *b }.distance_to(p)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::cell::{ArmMount, Tote};
    use crate::warehouse::formats::json;
    use crate::warehouse::lab;

    /// The lab, whose station has a picker one metre south of its rack.
    fn with_cell() -> Draft {
        let mut draft = json::parse_draft(&json::write(&lab())).unwrap();
        let node = draft.stations[0].node.clone();
        let at = draft.nodes.iter().find(|n| n.name == node).unwrap().at;
        // Away from everything that robots drive over.
        let off = crate::geometry::Vector::new(0.0, -1.2);
        let square = |middle: Point, x: f64, y: f64| {
            [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| Point::new(middle.x + x, middle.y + y)).to_vec()
        };
        let workplace = square(at + off, 0.5, 0.4);
        let opening = CellOpening { outline: square(at + off / 2.0, 0.5, 0.02), from_m: 0.2, to_m: 2.0 };
        let tote = |name: &str, x: f64| Tote { name: name.into(), at: Place::new(at.x + x, at.y - 1.8, 0.9) };
        let arm = ArmMount {
            base: Place::new(at.x + 0.8, at.y - 1.0, 0.8),
            heading: 90_f64.to_radians(),
            kind: "ur5".into(),
        };
        let cell = Cell { workplace, opening, totes: vec![tote("A", -0.3), tote("B", 0.3)], arm: Some(arm) };
        draft.stations[0].cell = Some(cell);
        let heights_m = vec![0.4, 0.8, 1.2];
        draft.rack_types.push(RackType {
            name: "shelf".into(),
            columns: 4,
            heights_m,
            width_m: 0.8,
            face_m: 0.4,
        });
        draft.racks.iter_mut().for_each(|r| r.rack_type = Some("shelf".into()));
        draft
    }

    fn problems(change: impl FnOnce(&mut Draft)) -> Vec<String> {
        let mut draft = with_cell();
        change(&mut draft);
        let found = draft.build().err().unwrap_or_default();
        found.0.iter().map(|f| format!("{}: {}", f.place, f.problem)).collect()
    }

    fn cell(draft: &mut Draft) -> &mut Cell {
        draft.stations[0].cell.as_mut().unwrap()
    }

    #[test]
    fn a_map_with_a_cell_is_read_as_it_was_written() {
        let built = with_cell().build().unwrap();
        let again = json::parse(&json::write(&built)).unwrap();
        assert_eq!(again.stations[crate::id::StationId(0)], built.stations[crate::id::StationId(0)]);
        assert!(built.racks.iter().all(|r| r.rack_type.is_some()));
        assert_eq!(json::write(&again), json::write(&built));
        assert_eq!(crate::warehouse::differences(&built, &again), []);
    }

    #[test]
    fn each_mistake_in_a_cell_is_named_with_its_place() {
        type Change = fn(&mut Draft);
        let cases: [(&str, Change); 15] = [
            ("the workplace of station P: it is no outline", |d| cell(d).workplace.truncate(2)),
            ("the workplace of station P: a corner is nowhere", |d| cell(d).workplace[0].x = f64::NAN),
            ("the workplace of station P: robots reach into it at", |d| {
                cell(d).workplace.iter_mut().for_each(|p| p.y += 1.2);
            }),
            ("the workplace of station P: the area that it encloses", |d| cell(d).workplace.swap(1, 2)),
            ("the opening of station P: it is no outline", |d| {
                let y = cell(d).opening.outline[0].y;
                cell(d).opening.outline.iter_mut().for_each(|p| p.y = y);
            }),
            ("tote A\u{200b} of station P: its name \"A\\u{200b}\"", |d| {
                cell(d).totes[0].name = "A\u{200b}".into()
            }),
            ("the opening of station P: it is open from 2 to 2 m", |d| cell(d).opening.from_m = 2.0),
            ("the opening of station P: its middle is", |d| {
                cell(d).opening.outline.iter_mut().for_each(|p| p.y -= 9.0);
            }),
            ("the cell of station P: it has no totes", |d| cell(d).totes.clear()),
            ("tote A of station P: the name is used twice", |d| cell(d).totes[1].name = "A".into()),
            ("tote B of station P: the picker does not reach it", |d| cell(d).totes[1].at.z = 3.5),
            ("the arm of station P: it is not beside the picker", |d| {
                cell(d).arm.as_mut().unwrap().base.x = f64::INFINITY;
            }),
            ("rack type shelf: 27 columns", |d| d.rack_types[0].columns = 27),
            ("rack type shelf: its rows are not one above the other", |d| {
                d.rack_types[0].heights_m.reverse()
            }),
            ("rack K1: there is no rack type crate", |d| {
                d.racks.iter_mut().find(|r| r.name == "K1").unwrap().rack_type = Some("crate".into());
            }),
        ];
        for (expected, change) in cases {
            let found = problems(change);
            assert!(found.len() == 1 && found[0].starts_with(expected), "{expected}: {found:?}");
        }
        assert_eq!(problems(|_| ()), [""; 0]);
    }
}

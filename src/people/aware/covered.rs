//! What a closed area covers, and whether an outline is valid: it encloses one area once, lies on this floor, and
//! covers some of it.
//!
//! Main types: [`Covered`], [`AreaFault`]; main functions [`covered`], [`check_area`]. Refuses: to say what a closure
//! cuts off, which depends on the ways through the rest of the floor.

use super::nodes_in;
use giveway_floor::geometry::{OutlineFault, Point, Segment, Vector, inside, outline_area_m2, runs_through};
use giveway_floor::id::{NodeId, StationId};
use giveway_floor::text::sentence::requests;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use std::fmt;

/// The smallest area of an outline, square metres.
const SMALLEST_M2: f64 = 0.01;

/// How far a corner may lie outside the map, beyond the map's own size, metres: people draw past an edge.
const PAST_EDGE_M: f64 = 10.0;

/// What a closed area covers.
#[derive(Clone, Debug, PartialEq)]
pub struct Covered {
    /// Nodes that are closed to robots.
    pub nodes: Vec<NodeId>,
    /// Stations at which no robot can stand.
    pub stations: Vec<StationId>,
    /// How many of the nodes are storage.
    pub storage: usize,
    /// The area inside the outline, square metres; nothing if the closure names nodes.
    pub area_m2: Option<f64>,
}

/// Why an outline is not a valid area of a floor.
#[derive(Clone, Debug, PartialEq)]
pub enum AreaFault {
    /// The corners form no outline.
    Outline(OutlineFault),
    /// The area is too small, square metres.
    Small(f64),
    /// A corner is far off the floor.
    OffFloor {
        /// Number of the corner, from 1.
        corner: usize,
        /// Position of the corner.
        at: Point,
        /// Lower and upper corner of the map.
        bounds: (Point, Point),
    },
    /// Robots are to keep out, and the area has no node; or people, and nobody can walk there.
    Nothing((Point, Point)),
}

impl From<OutlineFault> for AreaFault {
    fn from(fault: OutlineFault) -> AreaFault {
        AreaFault::Outline(fault)
    }
}

impl AreaFault {
    /// What is wrong with the outline, and what to do.
    pub fn sentence(&self) -> Sentence {
        let metres = |m: f64| SentenceArg::up_to(m, 3);
        let reach = |(low, high): &(Point, Point)| {
            requests::map_reaches(metres(low.x), metres(low.y), metres(high.x), metres(high.y))
        };
        match self {
            AreaFault::Outline(fault) => fault.sentence(),
            AreaFault::Small(m2) => {
                requests::area_too_small(SentenceArg::rounded(*m2, 4), SentenceArg::rounded(SMALLEST_M2, 2))
            }
            AreaFault::OffFloor { corner, at, bounds } => {
                requests::area_off_floor(*corner, metres(at.x), metres(at.y), reach(bounds))
            }
            AreaFault::Nothing(bounds) => requests::area_covers_nothing(reach(bounds)),
        }
    }
}

impl fmt::Display for AreaFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence().text())
    }
}

/// What an area covers: the named nodes, or if there are none, all nodes on which a robot would reach into the outline.
pub fn covered(w: &Warehouse, outline: &[Point], named: &[NodeId]) -> Covered {
    let is_named = !named.is_empty();
    let nodes = if is_named { named.to_vec() } else { nodes_in(w, outline) };
    let stations = nodes.iter().filter_map(|n| match w.kind(*n) {
        NodeKind::Station(station) => Some(station),
        _ => None,
    });
    Covered {
        stations: stations.collect(),
        storage: nodes.iter().filter(|n| w.kind(**n) == NodeKind::Storage).count(),
        area_m2: if is_named { None } else { outline_area_m2(outline).ok() },
        nodes,
    }
}

/// Whether an outline can be closed to robots, people or both.
///
/// # Errors
/// Why the outline cannot be closed.
pub fn check_area(w: &Warehouse, outline: &[Point], robots: bool, people: bool) -> Result<(), AreaFault> {
    let area = outline_area_m2(outline)?;
    if area < SMALLEST_M2 {
        return Err(AreaFault::Small(area));
    }
    let bounds = w.bounds();
    let size = bounds.1 - bounds.0;
    let margin = Vector::repeat(size.x.max(size.y).max(PAST_EDGE_M));
    let (low, high) = (bounds.0 - margin, bounds.1 + margin);
    let is_off = |p: &Point| p.x < low.x || p.y < low.y || p.x > high.x || p.y > high.y;
    if let Some(i) = outline.iter().position(is_off) {
        return Err(AreaFault::OffFloor { corner: i + 1, at: outline[i], bounds });
    }
    let has_node = !nodes_in(w, outline).is_empty();
    if has_node && (robots || people) || people && has_floor(w, outline) {
        return Ok(());
    }
    Err(AreaFault::Nothing(bounds))
}

/// Whether people can walk on some of an area.
fn has_floor(w: &Warehouse, outline: &[Point]) -> bool {
    fn sides(o: &[Point]) -> impl Iterator<Item = Segment> {
        o.iter().zip(o.iter().cycle().skip(1)).map(|(a, b)| Segment { a: *a, b: *b })
    }
    let meets =
        |o: &Vec<Point>| o.iter().any(|p| inside(outline, *p)) || sides(outline).any(|s| runs_through(o, s));
    let is_within =
        |o: &Vec<Point>| outline.iter().all(|p| inside(o, *p)) && !sides(o).any(|s| runs_through(outline, s));
    w.walkable.iter().any(meets) && !w.obstacles.iter().any(is_within)
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::{Draft, sketch, thesis};

    fn corners(of: &[(f64, f64)]) -> Vec<Point> {
        of.iter().map(|c| Point::new(c.0, c.1)).collect()
    }

    fn scaled(of: &[(f64, f64)], by: f64) -> Vec<Point> {
        of.iter().map(|c| Point::new(c.0 * by, c.1 * by)).collect()
    }

    const SQUARE: [(f64, f64); 4] = [(2.0, 4.0), (8.0, 4.0), (8.0, 9.0), (2.0, 9.0)];

    #[test]
    fn an_area_says_what_it_covers() {
        let w = thesis();
        let outline = corners(&SQUARE);
        assert_eq!(check_area(&w, &outline, true, true), Ok(()));
        let found = covered(&w, &outline, &[]);
        assert_eq!(found.nodes, nodes_in(&w, &outline));
        assert_eq!((found.nodes.len() >= 30, found.area_m2), (true, Some(30.0)), "{found:?}");
        let storage = w.nodes_where(|kind| kind == NodeKind::Storage);
        let named = covered(&w, &[], &storage[..3]);
        assert_eq!((named.nodes.len(), named.storage, named.area_m2), (3, 3, None));
        let station = w.stations.ids().next().unwrap();
        assert_eq!(covered(&w, &[], &[w.stations[station].node]).stations, [station]);
    }

    #[test]
    fn what_is_no_area_of_this_floor_is_refused_with_the_reason() {
        let w = thesis();
        let says = |outline: &[Point]| check_area(&w, outline, true, true).unwrap_err().to_string();
        assert!(says(&corners(&[(2.0, 4.0), (8.0, 9.0), (8.0, 4.0), (2.0, 8.0)])).contains("crosses itself"));
        assert!(says(&scaled(&SQUARE, 1000.0)).contains("millimetres"));
        // In millimetres, with a corner at the map's origin: it would have closed the whole floor.
        assert!(
            says(&scaled(&[(0.0, 0.0), (12.0, 0.0), (12.0, 14.0), (0.0, 14.0)], 1000.0)).contains("corner 2")
        );
        assert!(says(&corners(&[(-6.0, -6.0), (-4.0, -6.0), (-4.0, -4.0)])).contains("covers nothing"));
        assert!(says(&corners(&[(2.0, 4.0), (2.05, 4.0), (2.05, 4.05)])).contains("at least 0.01"));
        // Corners past the edge of the floor are no mistake.
        let past = corners(&[(-3.0, -3.0), (20.0, -3.0), (20.0, 2.0), (-3.0, 2.0)]);
        assert_eq!(check_area(&w, &past, true, true), Ok(()));
    }

    #[test]
    fn floor_without_nodes_is_closed_to_people_alone() {
        let mut draft: Draft = sketch("RS..C\n.....\nP.1.X");
        let square = |x: f64, y: f64, half: f64| {
            corners(&[(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)])
        };
        draft.walkable = vec![square(2.0, -1.0, 12.0)];
        draft.obstacles = vec![square(-6.0, -6.0, 2.0)];
        let w = draft.build().unwrap();
        let (free, shelf) = (square(-6.0, 6.0, 1.0), square(-6.0, -6.0, 1.0));
        assert_eq!(check_area(&w, &free, false, true), Ok(()));
        assert_eq!(check_area(&w, &free, true, true), Ok(()));
        assert!(matches!(check_area(&w, &free, true, false), Err(AreaFault::Nothing(_))));
        assert!(
            matches!(check_area(&w, &shelf, true, true), Err(AreaFault::Nothing(_))),
            "inside an obstacle"
        );
        assert_eq!(check_area(&w, &square(-6.0, -6.0, 3.0), false, true), Ok(()), "around an obstacle");
    }
}

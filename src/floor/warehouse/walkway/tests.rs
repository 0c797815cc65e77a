//! Walkways of the shipped maps and of small drawings.

use super::*;
use crate::warehouse::{kiva, lab, sketch, stations, thesis};

fn p(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

fn drawn(drawing: &str) -> Walkways {
    Walkways::of(&sketch(drawing).build().expect("well-formed"))
}

/// Directions from a node to the obstacle cells that are about as near as the nearest.
fn walls(walks: &Walkways, at: Point) -> Vec<f64> {
    let (cell, clear) = (walks.cell_m(), walks.clearance_m(at));
    let reach = clear + 2.1 * cell;
    let span = (reach / cell).ceil() as i64;
    let cells = (-span..=span).flat_map(|y| (-span..=span).map(move |x| (x as f64 * cell, y as f64 * cell)));
    let walls = cells.filter(|(x, y)| x.hypot(*y) <= reach && !walks.is_free(p(at.x + x, at.y + y)));
    walls.map(|(x, y)| y.atan2(x)).collect()
}

#[test]
fn every_point_of_a_middle_line_is_as_far_from_one_wall_as_from_another() {
    for w in [lab(), thesis(), kiva()] {
        let walks = Walkways::of(&w);
        let kept = places(&w);
        for node in walks.nodes().iter() {
            // Where a line is kept up to a door or the end of an aisle, it leaves the middle.
            if kept.iter().any(|k| (k - node.at).norm() < 1.5) {
                continue;
            }
            let walls = walls(&walks, node.at);
            let widest =
                walls.iter().flat_map(|a| walls.iter().map(|b| crate::geometry::turn_between(*a, *b)));
            let widest = widest.fold(0.0, f64::max);
            assert!(widest > 1.0, "{}: only one wall is near {:?}", w.name, node);
        }
    }
}

#[test]
fn no_edge_is_longer_than_a_metre_and_all_run_over_free_floor() {
    for w in [lab(), thesis(), kiva()] {
        let walks = Walkways::of(&w);
        for e in walks.edges().ids() {
            let (edge, s) = (&walks.edges()[e], walks.segment(e));
            assert!(edge.length_m <= PITCH_M + 1e-9 && edge.a != edge.b, "{edge:?}");
            assert!(walks.sees(s.a, s.b) && edge.clearance_m >= 0.3, "{}: {edge:?} {s:?}", w.name);
        }
    }
}

#[test]
fn every_aisle_and_every_door_of_the_shipped_maps_is_reached_from_every_other() {
    for w in [lab(), thesis(), kiva()] {
        let (walks, none) = (Walkways::of(&w), Walkways::of(&w).no_edges());
        let people = w.nodes_where(|k| matches!(k, NodeKind::Aisle | NodeKind::Exit));
        let on_floor: Vec<NodeId> = people.into_iter().filter(|n| walks.is_free(w.nodes[*n].at)).collect();
        assert!(on_floor.len() > w.nodes.len() / 3, "{}: {} on the floor", w.name, on_floor.len());
        let mut seen = vec![false; walks.nodes().len()];
        let mut todo = vec![WalkNodeId(0)];
        while let Some(n) = todo.pop() {
            if !std::mem::replace(&mut seen[n.ix()], true) {
                todo.extend(walks.links(n).iter().map(|(_, to)| *to));
            }
        }
        assert!(seen.iter().all(|s| *s), "{}: the walkways are in parts", w.name);
        for n in on_floor {
            let steps = walks.doorsteps(w.nodes[n].at, &none);
            assert!(!steps.is_empty(), "{}: no way from {}", w.name, w.nodes[n].name);
        }
        for station in w.stations.iter() {
            let away = walks.nearest(w.nodes[station.node].at).expect("walkways").1;
            // Most stations are beyond the floor, at the ends of bays for robots.
            let most = if walks.is_free(w.nodes[station.node].at) { 0.1 } else { 6.0 };
            assert!(away < most, "{}: the station {} is {away} m away", w.name, station.name);
        }
    }
}

#[test]
fn the_aisles_of_the_hall_have_their_middle_lines_where_the_robots_nodes_are() {
    let w = thesis();
    let walks = Walkways::of(&w);
    for name in ["G3-3", "G6-10", "G3-7", "G6-7"] {
        let n = w.node_named(name).expect(name);
        let away = walks.nearest(w.nodes[n].at).expect("walkways").1;
        assert!(away < 0.25, "{name}: the nearest node is {away} m away");
    }
    let count = walks.nodes().len();
    assert!((100..250).contains(&count), "{count} nodes for 132 places of the floor");
}

#[test]
fn walkways_are_the_same_each_time() {
    let (one, other) = (Walkways::of(&kiva()), Walkways::of(&kiva()));
    assert_eq!((&one.nodes, &one.edges), (&other.nodes, &other.edges));
}

#[test]
fn without_outlines_the_rectangle_around_the_aisles_is_the_floor() {
    let walks = drawn(".....\n.RRR.\n.RRR.\n.....\nC...P");
    assert!(walks.is_free(p(0.0, 0.0)) && walks.is_free(p(4.4, 4.4)));
    assert!(!walks.is_free(p(2.0, 2.0)) && !walks.is_free(p(4.6, 0.0)) && !walks.is_free(p(9.0, 9.0)));
    // The slits between racks are too narrow for people.
    assert!(!walks.is_free(p(1.5, 2.5)) && !walks.sees(p(1.5, 1.0), p(1.5, 4.0)));
    assert!(walks.sees(p(0.0, 0.0), p(4.0, 0.0)) && !walks.sees(p(0.0, 0.0), p(2.0, 4.0)));
}

#[test]
fn a_dead_end_keeps_its_line_only_where_it_leads_to_an_aisle() {
    let walks = drawn(".....\n.RRRR\n.....\n.RRRR\n.....\nCP");
    let in_aisle = walks.nearest(p(4.0, 3.0)).expect("walkways").1;
    assert!(in_aisle < 0.2, "the aisle's end is {in_aisle} m from its line");
    let corner = walks.nearest(p(-0.4, 5.4)).expect("walkways").1;
    assert!(corner > 0.3, "no line into a corner");
}

#[test]
fn a_robot_in_an_aisle_cuts_the_way_through_and_it_goes_round_the_block() {
    let w = thesis();
    let walks = Walkways::of(&w);
    let mut cut = walks.no_edges();
    let (from, to) = (p(3.0, 1.0), p(3.0, 6.0));
    let straight = walks.path(from, to, &cut).expect("a way");
    assert!((straight.length_m - 5.0).abs() < 0.2, "{}", straight.length_m);
    for e in walks.edges_within(p(3.0, 3.0), 1.0) {
        assert!(cut.insert(e) && !cut.insert(e) && cut.contains(e));
    }
    assert_eq!(cut.iter().collect::<Vec<_>>(), walks.edges_within(p(3.0, 3.0), 1.0));
    let round = walks.path(from, to, &cut).expect("a way round");
    assert!((13.0..15.1).contains(&round.length_m), "{}", round.length_m);
    // A person may walk up to the robot, but not past it, though its far side is in sight.
    assert!(walks.sees_past(from, p(3.0, 1.5), &cut) && !walks.sees_past(from, p(3.0, 4.5), &cut));
    assert!(walks.sees_past(p(3.0, 1.4), p(3.0, 0.5), &cut), "and away from it");
    assert!(walks.doorsteps(from, &cut).iter().all(|(n, _)| walks.nodes()[*n].at.y < 2.6));
    for e in cut.clone().iter() {
        assert!(cut.remove(e));
    }
    assert!(cut.is_empty());
    assert_eq!(walks.path(from, to, &cut), Some(straight));
}

#[test]
fn there_is_no_way_off_the_floor_and_none_for_the_enclosed() {
    let w = lab();
    let walks = Walkways::of(&w);
    let mut cut = walks.no_edges();
    assert!(walks.path(p(0.0, 0.0), p(40.0, 0.0), &cut).is_none());
    walks.edges().ids().for_each(|e| assert!(cut.insert(e)));
    assert!(walks.path(p(6.0, 0.0), p(0.0, 4.0), &cut).is_none());
}

#[test]
fn sight_is_mutual() {
    let walks = Walkways::of(&lab());
    let points: Vec<Point> =
        (0..60).map(|i| p(f64::from(i % 10) * 0.7, f64::from(i / 10) * 0.83 - 0.3)).collect();
    for a in &points {
        for b in &points {
            assert_eq!(walks.sees(*a, *b), walks.sees(*b, *a), "{a} {b}");
        }
    }
}

#[test]
fn the_shortest_way_is_no_longer_than_any_other_through_the_graph() {
    let walks = Walkways::of(&lab());
    let none = walks.no_edges();
    let n = walks.nodes().len();
    let mut all = vec![vec![f64::INFINITY; n]; n];
    (0..n).for_each(|i| all[i][i] = 0.0);
    for e in walks.edges().iter() {
        let shorter = all[e.a.ix()][e.b.ix()].min(e.length_m);
        (all[e.a.ix()][e.b.ix()], all[e.b.ix()][e.a.ix()]) = (shorter, shorter);
    }
    for k in 0..n {
        for i in 0..n {
            for j in 0..n {
                all[i][j] = all[i][j].min(all[i][k] + all[k][j]);
            }
        }
    }
    for i in (0..n).step_by(3) {
        for j in (0..n).step_by(5) {
            let (from, to) = (walks.nodes()[WalkNodeId::at(i)].at, walks.nodes()[WalkNodeId::at(j)].at);
            let found = walks.path(from, to, &none).expect("connected");
            assert!(found.length_m <= all[i][j] + 1e-9, "{from} {to}");
            assert!(found.length_m >= (to - from).norm() - 1e-9);
            let along: f64 = found.points.windows(2).map(|s| (s[1] - s[0]).norm()).sum();
            assert!((along - found.length_m).abs() < 1e-9);
        }
    }
}

#[test]
fn places_to_stand_are_on_free_floor_also_beside_the_middle_lines() {
    let walkways = Walkways::of(&lab());
    let here = Point::new(3.0, 2.0);
    let places = walkways.standing_places(here, 3.0);
    assert!(places.windows(2).all(|w| (w[0] - here).norm() <= (w[1] - here).norm()), "the nearest first");
    assert!(places.iter().all(|p| walkways.is_free(*p) && (p - here).norm() <= 3.0));
    let beside = |p: &&Point| walkways.nodes().iter().all(|n| (n.at - **p).norm() > 0.4);
    assert!(places.iter().filter(beside).count() > 3, "{places:?}");
}

/// A hall of ten by ten metres without racks, and robots of one metre with half a person beside them.
fn in_an_open_hall(robots: &[(f64, f64)]) -> (Walkways, Vec<Square>) {
    let row = "..........";
    let walks = drawn(&format!("{}\nC........P", [row; 10].join("\n")));
    (walks, robots.iter().map(|(x, y)| Square { at: p(*x, *y), half_m: 0.75 }).collect())
}

#[test]
fn a_way_between_robots_leads_along_their_sides_and_through_none() {
    let (walks, squares) = in_an_open_hall(&[(4.0, 4.0), (4.0, 6.0), (6.0, 4.0)]);
    let ways = walks.ways_between(p(5.0, 5.0), squares.clone(), 4.0);
    let way = ways.way_to(p(2.0, 5.0)).expect("half a metre is left between the squares");
    assert!(way.len() <= 4, "{way:?}");
    for s in way.windows(2) {
        let along = (0..=50).map(|k| s[0] + (s[1] - s[0]) * (f64::from(k) / 50.0));
        along.for_each(|q| assert!(squares.iter().all(|s| s.depth_m(q) < 0.06), "{q:?} of {way:?}"));
    }
    assert!((ways.length_m(p(2.0, 5.0)).expect("there is a way") - 3.0).abs() < 0.1);
}

#[test]
fn who_is_shut_in_has_no_way_between_and_who_is_measured_inside_a_robot_may_leave_it() {
    let around: Vec<(f64, f64)> =
        [(3.6, 3.6), (5.0, 3.6), (6.4, 3.6), (3.6, 5.0), (6.4, 5.0), (3.6, 6.4), (5.0, 6.4), (6.4, 6.4)]
            .to_vec();
    let (walks, squares) = in_an_open_hall(&around);
    assert_eq!(walks.ways_between(p(5.0, 5.0), squares, 4.0).way_to(p(1.5, 5.0)), None);
    let (walks, squares) = in_an_open_hall(&[(5.0, 5.0)]);
    let ways = walks.ways_between(p(5.5, 5.0), squares.clone(), 4.0);
    assert!(!ways.is_clear(p(5.5, 5.0)));
    for to in [p(7.0, 5.0), p(3.0, 5.0), p(5.0, 7.5)] {
        let way = ways.way_to(to).expect("out of it, and round it");
        let points =
            way.windows(2).flat_map(|s| (0..=50).map(|k| s[0] + (s[1] - s[0]) * (f64::from(k) / 50.0)));
        let depths: Vec<f64> = points.map(|q| squares[0].depth_m(q).max(0.0)).collect();
        assert!(depths.is_sorted_by(|a, b| a + 1e-9 >= *b), "not deeper into it: {way:?}");
    }
}

#[test]
fn what_needs_more_room_than_an_aisle_has_goes_round_by_wide_roads_or_not_at_all() {
    let w = stations();
    let walkways = Walkways::of(&w);
    // Roads of two metres lead round blocks with aisles of one metre between.
    let (from, to) = (Point::new(0.5, 0.5), Point::new(0.5, 13.5));
    let across = Point::new(22.0, 7.5);
    let long = |clearance_m: f64, to: Point| {
        let cut = walkways.edges_narrower_than(clearance_m);
        walkways.path(from, to, &cut).map(|way| (way.length_m, way.points))
    };
    for clearance_m in [0.6, 0.8] {
        let (_, points) = long(clearance_m, across).expect("by the roads");
        let narrow = |p: &&Point| walkways.clearance_m(**p) < clearance_m - 0.11;
        assert_eq!(points[1..points.len() - 1].iter().find(narrow), None, "{clearance_m} m");
    }
    let on_foot = long(0.0, to).expect("everywhere");
    assert!(long(0.6, to).expect("by the roads").0 >= on_foot.0 - 1e-9);
    assert_eq!(long(1.5, to), None, "no road is three metres wide");
}

#[test]
fn what_does_not_fit_beside_a_rack_serves_it_from_the_nearest_wide_road_in_sight() {
    let w = stations();
    let walkways = Walkways::of(&w);
    let rack = Point::new(2.0, 2.0);
    assert_eq!(walkways.stand_near(rack, 0.0), walkways.on_floor(rack), "a person stands in front of it");
    let stand = walkways.stand_near(rack, 0.6).expect("the road is beside the block");
    assert!((stand - rack).norm() < 4.0 && walkways.clearance_m(stand) > 0.6, "{stand}");
    let inner = Point::new(8.0, 6.0);
    assert_eq!(walkways.stand_near(inner, 0.6), None, "in the middle there are narrow aisles alone");
}

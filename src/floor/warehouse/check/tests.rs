//! Each finding provoked by a small drawing.

use super::room_for;
use crate::geometry::Point;
use crate::time::Span;
use crate::warehouse::{
    Corridor, Draft, DraftLane, DraftNode, DraftRack, DraftStation, FloorMark, Users, sketch,
};
use proptest::prelude::*;

const GOOD: &str = "
    RR.C
    ....
    P.1.";

fn good() -> Draft {
    sketch(GOOD)
}

/// Asserts that `draft` is refused with a finding whose text contains all of `texts`.
fn refused(draft: Draft, texts: &[&str]) {
    let findings = draft.build().expect_err("a bad map is refused");
    let all = findings.to_string();
    let fits = |line: &str| texts.iter().all(|text| line.contains(text));
    assert!(all.lines().any(fits), "no finding says {texts:?} in:\n{all}");
}

fn lane<'a>(draft: &'a mut Draft, from: &str, to: &str) -> &'a mut DraftLane {
    (draft.lanes.iter_mut()).find(|l| l.from == from && l.to == to).expect("the lane is in the drawing")
}

fn without(mut draft: Draft, from: &str, to: &str) -> Draft {
    lane(&mut draft, from, to);
    draft.lanes.retain(|l| !(l.from == from && l.to == to));
    draft
}

fn node(name: &str, x: f64, y: f64) -> DraftNode {
    DraftNode { name: name.into(), at: Point::new(x, y) }
}

#[test]
fn a_good_map_is_built() {
    good().build().expect("nothing is wrong with it");
}

#[test]
fn all_problems_are_told_at_once() {
    let mut draft = good();
    draft.footprint_m = 0.0;
    draft.chargers.push("nowhere".into());
    draft.lanes.push(DraftLane::one_way("0,0", "also nowhere", Users::ALL));
    assert_eq!(draft.build().expect_err("three problems").0.len(), 3);
}

/// Asserts that the findings are exactly these, each given by the beginning of its text.
fn all_findings(draft: Draft, beginnings: &[&str]) {
    let all = draft.build().expect_err("a bad map is refused").to_string();
    let lines: Vec<&str> = all.lines().collect();
    assert_eq!(lines.len(), beginnings.len(), "not as many as expected in:\n{all}");
    for (line, beginning) in lines.iter().zip(beginnings) {
        assert!(line.starts_with(beginning), "no \"{beginning}\" in:\n{all}");
    }
}

#[test]
fn a_wrong_name_does_not_hide_what_is_wrong_with_the_floor() {
    let mut draft = good();
    draft.lanes.push(DraftLane::one_way("0,1", "nowhere", Users::ALL));
    draft.nodes.push(node("island", 9.0, 9.0));
    draft.nodes.push(node("end", 4.0, 1.0));
    draft.lanes.push(DraftLane::one_way("3,1", "end", Users::ALL));
    all_findings(
        draft.clone(),
        &[
            "lane 0,1–nowhere: there is no node nowhere",
            "nodes island: no lane touches them",
            "nodes end: loaded robots cannot get from there",
            "nodes end: unloaded robots cannot get from there",
        ],
    );
    draft.footprint_m = -1.0;
    assert_eq!(draft.build().expect_err("five problems").0.len(), 5, "nor does a wrong footprint");
}

#[test]
fn marks_have_names_of_their_own_or_stand_where_their_node_is() {
    let mark = |name: &str, x: f64, y: f64| FloorMark { name: name.into(), at: Point::new(x, y) };
    let with = |marks: &[FloorMark]| Draft { marks: marks.to_vec(), ..good() };
    let there = good().nodes[0].clone();
    let good_marks = [mark("door", 0.4, -3.0), mark(&there.name, there.at.x, there.at.y)];
    let built = with(&good_marks).build().expect("nothing is wrong with it");
    assert_eq!(built.mark_named("door"), Some(Point::new(0.4, -3.0)));
    assert_eq!(built.mark_named(&there.name), Some(there.at), "every node is a mark");
    assert_eq!(built.mark_named("window"), None);
    refused(with(&[mark("door", 0.0, 0.0), mark("door", 1.0, 0.0)]), &["mark door: the name is used twice"]);
    refused(with(&[mark(&there.name, 7.0, 7.0)]), &["a node elsewhere has this name"]);
    refused(with(&[mark("door", f64::NAN, 0.0)]), &["mark door: it is at (NaN, 0)"]);
}

/// Two halves of a floor that only the lane from `2,1` to `3,1` joins.
fn two_halves() -> Draft {
    let halves = sketch("RR...RR\n.......\nP.1.2.C");
    without(without(halves, "2,2", "3,2"), "2,0", "3,0")
}

#[test]
fn what_merely_follows_from_a_bad_part_is_not_listed() {
    two_halves().build().expect("nothing is wrong with it");
    let mut draft = two_halves();
    lane(&mut draft, "2,1", "3,1").to = "3,1x".into();
    all_findings(draft, &["lane 2,1–3,1x: there is no node 3,1x"]);
    let mut draft = two_halves();
    lane(&mut draft, "2,1", "3,1").length_m = Some(0.1);
    all_findings(draft, &["lane 2,1–3,1: 0.1 m is shorter"]);
    let mut draft = two_halves();
    draft.nodes.iter_mut().find(|n| n.name == "3,1").expect("it is drawn").at.x = f64::NAN;
    all_findings(draft, &["node 3,1: it stands at (NaN, 1)"]);
    let mut draft = two_halves();
    draft.parking.push("3,1".into());
    draft.exits.push("3,1".into());
    all_findings(draft, &["node 3,1: listed in parking and in exits"]);
    let mut draft = sketch("..\n..");
    draft.chargers.push("0,O".into());
    all_findings(draft, &["chargers: there is no node 0,O"]);
    let mut draft = with_queue();
    draft.stations[0].queue[0] = "q0".into();
    all_findings(draft, &["the queue of station W: there is no node q0"]);
}

#[test]
fn a_map_without_nodes_is_refused() {
    refused(Draft { footprint_m: 0.9, ..Draft::default() }, &["nodes: there are none"]);
}

#[test]
fn doubled_empty_and_endless_names_are_refused() {
    let mut draft = good();
    draft.nodes.push(node("0,0", 9.0, 9.0));
    draft.nodes.push(node("", 9.0, 8.0));
    draft.nodes.push(node(&"n".repeat(200), 9.0, 7.0));
    refused(draft.clone(), &["node 0,0", "twice"]);
    refused(draft.clone(), &["node :", "empty"]);
    refused(draft, &["nnn", "too long"]);
}

#[test]
fn doubled_stations_and_racks_are_refused() {
    let mut draft = good();
    draft.stations.push(DraftStation { node: "1,0".into(), ..draft.stations[0].clone() });
    draft.racks.push(DraftRack::plain("rack 0,2", "1,2"));
    refused(draft.clone(), &["station station 1", "twice"]);
    refused(draft.clone(), &["rack rack 0,2: the name is used twice"]);
    refused(draft, &["rack rack 0,2: rack rack 1,2 stands on 1,2 too"]);
}

#[test]
fn a_rack_on_open_floor_is_refused() {
    let mut draft = good();
    draft.racks[0].node = "1,1".into();
    refused(draft, &["rack rack 0,2", "1,1 is not a storage node"]);
}

#[test]
fn absurd_numbers_are_refused() {
    let mut draft = good();
    draft.nodes[0].at.x = f64::NAN;
    draft.nodes[1].at.y = 2e5;
    draft.stations[0].pick = Span::from_secs(-1);
    draft.walkable = vec![vec![Point::new(0.0, 0.0)]];
    draft.obstacles = vec![vec![Point::new(0.0, f64::INFINITY); 3]];
    refused(draft.clone(), &["stands at (NaN"]);
    refused(draft.clone(), &["stands at (", "200000"]);
    refused(draft.clone(), &["a pick of -1 s"]);
    refused(draft.clone(), &["outline 1 of walkable: it is no outline; 1 corners enclose no area"]);
    refused(draft, &["outline 1 of obstacles", "far away"]);
}

#[test]
fn every_bad_footprint_is_refused() {
    for footprint_m in [0.0, -1.0, f64::NAN, f64::INFINITY, 11.0] {
        refused(Draft { footprint_m, ..good() }, &["footprint_m"]);
    }
}

#[test]
fn lanes_with_bad_numbers_are_refused() {
    let bad = |change: fn(&mut DraftLane), text: &str| {
        let mut draft = good();
        change(lane(&mut draft, "0,1", "1,1"));
        refused(draft, &["lane 0,1–1,1", text]);
    };
    bad(|l| l.length_m = Some(0.0), "length is 0 m");
    bad(|l| l.length_m = Some(f64::NAN), "length is NaN m");
    bad(|l| l.length_m = Some(0.5), "shorter than the straight");
    bad(|l| l.length_m = Some(5_000.0), "5000 m long");
    bad(|l| l.speed_limit_mps = Some(0.0), "speed limit is 0");
    bad(|l| l.speed_limit_mps = Some(f64::NAN), "speed limit is NaN");
    bad(
        |l| l.corridor = Some(Corridor { left_m: f64::NAN, right_m: 0.6 }),
        "corridor is NaN m wide on the left",
    );
    bad(
        |l| l.corridor = Some(Corridor { left_m: 0.6, right_m: -0.1 }),
        "corridor is -0.1 m wide on the right",
    );
    bad(|l| l.corridor = Some(Corridor { left_m: 0.6, right_m: 21.0 }), "corridor is 21 m wide on the right");
    bad(|l| l.users = Users { loaded: false, unloaded: false, people: false }, "nothing may use it");
}

#[test]
fn lanes_that_go_nowhere_are_refused() {
    let mut draft = good();
    draft.lanes.push(DraftLane::one_way("0,1", "0,1", Users::ALL));
    draft.lanes.push(DraftLane::one_way("1,1", "0,1", Users::ALL));
    draft.nodes.push(node("twin", 0.0, 1.0));
    draft.lanes.push(DraftLane::both_ways("twin", "0,1", Users::ALL));
    refused(draft.clone(), &["lane 0,1–0,1: it ends where it starts"]);
    refused(draft.clone(), &["lane 1,1–0,1: a second lane from 1,1 to 0,1"]);
    refused(draft, &["lane twin–0,1: its length is 0 m"]);
}

#[test]
fn a_node_at_which_too_many_lanes_end_is_refused() {
    let mut draft = good();
    for i in 0..300 {
        draft.nodes.push(node(&format!("far {i}"), 10.0, f64::from(i)));
        draft.lanes.push(DraftLane::both_ways(format!("far {i}"), "3,1", Users::ALL));
    }
    refused(draft, &["node 3,1: 303 lanes end here"]);
}

#[test]
fn a_node_in_two_roles_is_refused() {
    let mut draft = good();
    draft.chargers.push("0,2".into());
    draft.parking.push("0,0".into());
    draft.exits.push("2,0".into());
    refused(draft.clone(), &["node 0,2: listed in storage and in chargers"]);
    refused(draft.clone(), &["node 0,0: listed twice in parking"]);
    refused(draft, &["node 2,0: listed in exits and in station station 1"]);
}

#[test]
fn a_map_without_a_place_to_stay_is_refused() {
    refused(sketch("..\n.."), &["no storage, charging or parking place"]);
}

#[test]
fn a_node_without_lanes_is_refused() {
    let mut draft = good();
    draft.nodes.push(node("island", 9.0, 9.0));
    refused(draft, &["nodes island: no lane touches them"]);
}

#[test]
fn floor_that_only_a_parking_place_joins_is_refused() {
    refused(
        sketch("...P..\n......").build_without(&["2,0", "3,0"]),
        &["loaded robots cannot get from there"],
    );
}

#[test]
fn a_one_way_street_into_a_dead_end_is_refused() {
    let mut draft = good();
    draft.nodes.push(node("end", 4.0, 1.0));
    draft.lanes.push(DraftLane::one_way("3,1", "end", Users::ALL));
    refused(draft, &["nodes end: loaded robots cannot get from there to the main floor"]);
}

#[test]
fn a_floor_node_that_nothing_leads_to_is_refused() {
    let mut draft = good();
    draft.nodes.push(node("source", 4.0, 1.0));
    draft.lanes.push(DraftLane::one_way("source", "3,1", Users::ALL));
    refused(draft, &["nodes source: loaded robots cannot get there"]);
}

#[test]
fn storage_that_loaded_robots_cannot_reach_is_refused() {
    let mut draft = good();
    lane(&mut draft, "0,1", "0,2").users = Users::UNLOADED;
    refused(draft, &["node 0,2: loaded robots cannot reach it from, nor leave it to,"]);
}

#[test]
fn storage_behind_storage_is_refused() {
    refused(
        sketch("R.P\nR..\nR..").build_without(&["1,0"]),
        &["node 0,0: unloaded robots", "crossing another"],
    );
}

#[test]
fn parking_that_cannot_be_left_is_refused() {
    let mut draft = without(good(), "0,0", "0,1");
    lane(&mut draft, "0,0", "1,0").both = false;
    refused(draft, &["node 0,0: unloaded robots cannot reach it from"]);
    let mut draft = without(good(), "0,0", "0,1");
    *lane(&mut draft, "0,0", "1,0") = DraftLane::one_way("1,0", "0,0", Users::ALL);
    refused(draft, &["node 0,0: unloaded robots cannot leave it to"]);
}

/// A street along `y = 0` with a station below it: queue `q1`, `q2`, way out `out`.
fn with_queue() -> Draft {
    let mut draft = sketch("RR..P\n.....");
    let places = [("q2", 0.0, -1.0), ("q1", 0.0, -2.0), ("pick", 1.0, -2.0), ("out", 1.0, -1.0)];
    draft.nodes.extend(places.map(|(name, x, y)| node(name, x, y)));
    let ways = [("0,0", "q2"), ("q2", "q1"), ("q1", "pick"), ("pick", "out"), ("out", "1,0")];
    draft.lanes.extend(ways.map(|(from, to)| DraftLane::one_way(from, to, Users::ROBOTS)));
    let queue = vec!["q1".to_string(), "q2".to_string()];
    let (name, node) = ("W".to_string(), "pick".to_string());
    draft.stations.push(DraftStation { name, node, queue, pick: Span::from_secs(8), cell: None });
    draft
}

#[test]
fn a_station_branch_with_its_own_way_out_is_fine() {
    with_queue().build().expect("in through the queue, out beside it");
}

#[test]
fn a_station_needs_its_queue_in_order_and_a_way_out() {
    refused(without(with_queue(), "0,0", "q2"), &["station W: loaded robots cannot reach q2"]);
    refused(without(with_queue(), "q2", "q1"), &["station W: loaded robots cannot move up from q2 to q1"]);
    let mut draft = with_queue();
    draft.stations[0].queue.reverse();
    refused(draft, &["cannot move up from q2 to pick", "from the station outwards"]);
    let mut draft = without(with_queue(), "pick", "out");
    lane(&mut draft, "q1", "pick").both = true;
    refused(draft, &["station W: loaded robots cannot leave it", "without its queue"]);
}

#[test]
fn an_open_node_that_leads_into_a_queue_only_is_refused() {
    let mut draft = with_queue();
    draft.stations[0].queue.pop();
    refused(draft, &["nodes q2: loaded robots cannot get from there to the main floor"]);
}

#[test]
fn places_that_overlap_are_refused() {
    let mut draft = good();
    draft.nodes.push(node("close", 3.0, 2.5));
    draft.lanes.push(DraftLane::both_ways("close", "2,2", Users::ALL));
    draft.parking.push("close".into());
    refused(draft.clone(), &["nodes 3,2 and close: robots standing at both would overlap"]);
    draft.nodes.last_mut().expect("just added").at = Point::new(3.8, 1.0);
    refused(draft, &["nodes close and 3,1: a robot at close blocks 3,1"]);
}

#[test]
fn a_lane_past_a_parked_robot_is_of_no_use() {
    let mut draft = sketch("..P..");
    draft.lanes.retain(|l| l.from == "0,0" || l.from == "3,0");
    draft.lanes.push(DraftLane::both_ways("1,0", "3,0", Users::ALL));
    draft.lanes.push(DraftLane::both_ways("1,0", "2,0", Users::ALL));
    refused(draft, &["to the main floor", "a robot at 2,0 blocks lane 1,0–3,0"]);
}

#[test]
fn people_may_have_ways_of_their_own() {
    let mut draft = good();
    draft.nodes.push(node("door", 4.0, 1.0));
    draft.lanes.push(DraftLane::both_ways("3,1", "door", Users::PEOPLE));
    draft.exits.push("door".into());
    draft.build().expect("robots need not reach a door");
}

#[test]
fn there_must_be_room_for_all_robots() {
    let w = good().build().expect("a good map");
    assert!(room_for(&w, 4).is_ok());
    let findings = room_for(&w, 6).expect_err("four places only");
    assert!(findings.to_string().contains("add 2 parking places"), "{findings}");
}

impl Draft {
    /// The draft without some nodes and everything attached to them.
    fn build_without(mut self, names: &[&str]) -> Draft {
        self.nodes.retain(|n| !names.contains(&n.name.as_str()));
        self.lanes.retain(|l| !names.contains(&l.from.as_str()) && !names.contains(&l.to.as_str()));
        self
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn whatever_lanes_are_missing_the_check_answers(
        keep in prop::collection::vec(any::<bool>(), 64),
        wide in 0.1..3.0,
    ) {
        let mut draft = with_queue();
        draft.footprint_m = wide;
        let mut keep = keep.into_iter();
        draft.lanes.retain(|_| keep.next().unwrap_or(true));
        if let Err(findings) = draft.build() {
            prop_assert!(!findings.0.is_empty());
        }
    }

    #[test]
    fn bad_lanes_of_a_good_map_are_all_that_is_listed(
        bad in prop::collection::btree_set(0usize..18, 1..18),
    ) {
        let mut draft = with_queue();
        for &i in &bad {
            draft.lanes[i].length_m = Some(0.0);
        }
        let findings = draft.build().expect_err("no lane is that short");
        prop_assert_eq!(findings.0.len(), bad.len(), "{}", findings);
    }
}

#[test]
fn a_corridor_through_racks_walls_or_obstacles_is_refused_with_the_name_of_its_lane() {
    // Storage nodes stand a metre above the lane, robots and racks are 0.9 m wide.
    let with = |left_m, right_m| {
        let mut draft = good();
        lane(&mut draft, "0,1", "1,1").corridor = Some(Corridor { left_m, right_m });
        draft
    };
    with(0.5, 0.5).build().expect("it passes racks and robots at rest");
    let rack = |draft: &Draft| draft.clone().build().expect_err("refused").to_string();
    let (left, right) = (rack(&with(0.6, 0.5)), rack(&with(0.5, 0.6)));
    for text in [&left, &right] {
        assert!(text.contains("lane 0,1–1,1: its corridor runs through a r"), "{text}");
    }
    assert!(left.contains("a rack at") != right.contains("a rack at"), "{left}\n{right}");
    let box_at = |x: f64, y: f64| [(0.0, 0.0), (0.2, 0.0), (0.2, 0.2)].map(|(u, v)| Point::new(x + u, y + v));
    let mut draft = with(0.5, 0.5);
    let (a, b) = (draft.nodes.iter().find(|n| n.name == "0,1"), draft.nodes.iter().find(|n| n.name == "1,1"));
    let (a, b) = (a.unwrap().at, b.unwrap().at);
    draft.obstacles.push(box_at((a.x + b.x) / 2.0, a.y + 0.5).to_vec());
    draft.clone().build().expect("it touches the obstacle");
    draft.obstacles.push(box_at((a.x + b.x) / 2.0, a.y + 0.4).to_vec());
    refused(draft, &["lane 0,1–1,1", "through outline 2 of obstacles"]);
    let hall = |low: f64| [(-9.0, low), (9.0, low), (9.0, 9.0), (-9.0, 9.0)].map(|(x, y)| Point::new(x, y));
    let mut draft = with(0.5, 0.5);
    draft.walkable = vec![hall(a.y - 0.5).to_vec()];
    draft.clone().build().expect("the wall is where the corridor ends");
    draft.walkable = vec![hall(a.y - 0.4).to_vec()];
    refused(draft, &["lane 0,1–1,1", "leaves the floor"]);
}

//! Remarks about odd maps, and their places on the floor.

use super::{Severity, review};
use crate::geometry::Point;
use crate::warehouse::{
    Draft, DraftLane, DraftNode, Users, docks, kiva, lab, mixed, review_to_svg, sketch, thesis,
};

fn warnings(draft: &Draft) -> Vec<String> {
    let review = review(draft);
    assert!(review.is_good(), "{:?}", review.remarks);
    review.of(Severity::Warning).map(ToString::to_string).collect()
}

fn good() -> Draft {
    sketch("RR.C\n....\nP.1.")
}

/// The good map with its distances multiplied by `by`.
fn stretched(by: f64) -> Draft {
    let mut draft = good();
    draft.nodes.iter_mut().for_each(|n| n.at *= by);
    draft
}

#[test]
fn maps_that_ship_have_sizes_that_nobody_wonders_about() {
    for map in [lab(), thesis(), mixed(), docks(), kiva()] {
        let text = crate::warehouse::formats::json::write(&map);
        let draft = crate::warehouse::formats::json::parse_draft(&text).expect("our own writing");
        assert_eq!(warnings(&draft), [""; 0], "{}", map.name);
    }
}

#[test]
fn a_map_without_stations_or_racks_is_used_with_a_warning() {
    let all = warnings(&sketch("RR.C\n....\nP..."));
    assert!(all.len() == 1 && all[0].starts_with("stations: there are none"), "{all:?}");
    let all = warnings(&sketch("SS.C\n....\nP.1."));
    assert!(all.len() == 1 && all[0].starts_with("racks: there are none"), "{all:?}");
}

#[test]
fn a_map_in_another_unit_is_used_with_warnings() {
    let all = warnings(&stretched(900.0)).join("\n");
    assert!(all.contains("it is 2700 × 1800 m; check the unit"), "{all}");
    assert!(all.contains("they are longer than 200 m"), "{all}");
    let mut small = stretched(0.2);
    small.footprint_m = 0.15;
    let all = warnings(&small).join("\n");
    assert!(all.contains("footprint_m: 0.15 m; robots with their racks are"), "{all}");
    assert!(all.contains("they are shorter than 0.3 m"), "{all}");
    let mut slow = good();
    slow.lanes[0].speed_limit_mps = Some(0.01);
    let all = warnings(&slow).join("\n");
    assert!(all.contains("it is limited to a speed below 0.1 m/s"), "{all}");
}

#[test]
fn robots_that_are_wider_than_the_lanes_are_apart_are_wondered_about() {
    let mut draft = Draft { name: "tight".into(), footprint_m: 1.5, ..Draft::default() };
    for i in 0..6 {
        draft.nodes.push(DraftNode { name: format!("n{i}"), at: Point::new(f64::from(i), 0.0) });
        if i > 0 {
            draft.lanes.push(DraftLane::both_ways(format!("n{}", i - 1), format!("n{i}"), Users::ALL));
        }
    }
    draft.nodes.push(DraftNode { name: "p".into(), at: Point::new(7.0, 0.0) });
    draft.lanes.push(DraftLane::both_ways("n5", "p", Users::ALL));
    draft.parking.push("p".into());
    let all = warnings(&draft).join("\n");
    assert!(all.contains("robots of 1.5 m block the next place too at 6 of 7 nodes"), "{all}");
}

#[test]
fn errors_come_first_and_say_where_on_the_floor() {
    let mut draft = good();
    draft.stations.clear();
    draft.lanes.push(DraftLane::one_way("0,0", "nowhere", Users::ALL));
    draft.obstacles.push(vec![Point::new(1.0, 1.0), Point::new(2.0, 1.0)]);
    let review = review(&draft);
    let severities: Vec<Severity> = review.remarks.iter().map(|r| r.severity).collect();
    assert!(!review.is_good() && severities.is_sorted(), "{:?}", review.remarks);
    let at = |begins: &str| {
        let remark = review.remarks.iter().find(|r| r.finding.place.starts_with(begins));
        remark.unwrap_or_else(|| panic!("no {begins} in {:?}", review.remarks)).at.clone()
    };
    assert_eq!(at("lane 0,0–nowhere"), [Point::new(0.0, 0.0)], "of the end that exists");
    assert_eq!(at("outline 1"), [Point::new(1.0, 1.0), Point::new(2.0, 1.0)]);
    assert_eq!(at("stations"), [], "nowhere");
}

#[test]
fn dead_ends_are_warnings_with_their_places() {
    let review = review(&sketch("RR.C\n....\nP.1.").clone());
    for remark in &review.dead_ends {
        assert!(remark.severity == Severity::Warning && !remark.at.is_empty(), "{remark:?}");
    }
    assert_eq!(review.dead_ends.len(), review.shut_in.len());
}

#[test]
fn a_refused_map_is_drawn_with_its_errors_in_red() {
    let mut draft = good();
    draft.nodes.push(DraftNode { name: "<island>".into(), at: Point::new(9.0, 1.0) });
    let bad = review_to_svg(&review(&draft)).expect("it has nodes");
    assert_eq!(bad.matches("<circle class=\"mark\"").count(), 1, "{bad}");
    assert!(bad.contains("1  nodes &lt;island&gt;: no lane touches them"), "{bad}");
    assert!(bad.contains("#rack\""), "racks are drawn all the same");
    let fine = review_to_svg(&review(&good())).expect("it has nodes");
    assert!(!fine.contains("class=\"mark\""));
    assert_eq!(review_to_svg(&review(&Draft::default())), None, "there is nothing to draw");
}

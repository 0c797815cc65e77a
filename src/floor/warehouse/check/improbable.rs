//! Sizes that are possible but look like a slip: a wrong unit, a misplaced node. Warnings, since buildings differ.
//!
//! Main function: [`improbable`]. Refuses: to refuse a map.

use super::place::FindingPlace;
use super::{Findings, list};
use crate::warehouse::{Lane, Warehouse};

/// Length below which a lane is probably two nodes that should be one, metres.
const LANE_SHORT_M: f64 = 0.3;
/// Length above which a lane probably lacks nodes, metres: only one robot may be on a lane and its ends.
const LANE_LONG_M: f64 = 200.0;
/// Width above which a hall is probably drawn in another unit, metres.
const HALL_MAX_M: f64 = 2_000.0;
/// Usual range of the size of robots with their racks, metres.
const FOOTPRINTS_M: (f64, f64) = (0.2, 3.0);
/// Usual range of the speed on lanes, metres per second.
const SPEEDS_MPS: (f64, f64) = (0.1, 6.0);

/// The likely slips on a floor that is otherwise valid.
pub(in crate::warehouse) fn improbable(w: &Warehouse) -> Findings {
    let mut found = Findings::default();
    hall(w, &mut found);
    footprint(w, &mut found);
    lanes(
        w,
        |l| l.length_m < LANE_SHORT_M,
        &format!("shorter than {LANE_SHORT_M} m"),
        "check the unit, or make one node of the two ends",
        &mut found,
    );
    lanes(
        w,
        |l| l.length_m > LANE_LONG_M,
        &format!("longer than {LANE_LONG_M} m"),
        "check the unit, or put nodes in between: only one robot at a time drives a lane",
        &mut found,
    );
    let (slow, fast) = SPEEDS_MPS;
    lanes(
        w,
        |l| l.speed_limit_mps.is_some_and(|v| !(slow..=fast).contains(&v)),
        &format!("limited to a speed below {slow} m/s or above {fast} m/s"),
        "check the unit: metres per second",
        &mut found,
    );
    found
}

fn hall(w: &Warehouse, found: &mut Findings) {
    let (low, high) = w.bounds();
    let size = high - low;
    if size.x.max(size.y) > HALL_MAX_M {
        let (sides, corners) = (format!("it is {:.0} × {:.0} m", size.x, size.y), [low, high]);
        let place = FindingPlace::outline(format!("map {}", w.name), &corners);
        found.add(place, sides, "check the unit: all lengths are metres, and one place may be far off");
    }
}

/// Checks the size of robots by itself, and against the distances between places.
fn footprint(w: &Warehouse, found: &mut Findings) {
    let f = w.footprint_m;
    if f <= 0.0 {
        return;
    }
    let (small, large) = FOOTPRINTS_M;
    if !(small..=large).contains(&f) {
        let remedy = format!("robots with their racks are {small} to {large} m wide: check the unit");
        found.add("footprint_m", format!("{f} m"), remedy);
    }
    let tight = |n: &crate::id::NodeId| {
        w.conflicts(w.node_resource(*n)).iter().any(|other| w.resource(*other).is_ok())
    };
    let tight = w.nodes.ids().filter(tight).count();
    if tight * 4 > w.nodes.len() * 3 {
        let problem =
            format!("robots of {f} m block the next place too at {tight} of {} nodes", w.nodes.len());
        found.add("footprint_m", problem, "draw places and lanes farther apart, or give a smaller footprint");
    }
}

/// Reports that the lanes selected by `fits` are `what`.
fn lanes(w: &Warehouse, fits: impl Fn(&Lane) -> bool, what: &str, remedy: &str, found: &mut Findings) {
    let lanes: Vec<&Lane> = w.lanes.iter().filter(|l| fits(l)).collect();
    if lanes.is_empty() {
        return;
    }
    let ends = |l: &Lane| [l.a, l.b].map(|n| w.nodes[n].name.clone());
    let names: Vec<String> = lanes.iter().map(|l| ends(l).join("–")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (word, verb) = if lanes.len() == 1 { ("lane", "it is") } else { ("lanes", "they are") };
    let place = FindingPlace::of(format!("{word} {}", list(&names)), lanes.iter().flat_map(|l| ends(l)));
    found.add(place, format!("{verb} {what}"), remedy);
}

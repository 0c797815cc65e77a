//! Patches in few bytes: whole numbers by row for what changes all the time, rows with names for the rest.
//!
//! Main function: [`patch`]. Rows with names spend most bytes on names, and on routes that were sent before; steps in
//! millimetres from the base, which every reader has, avoid both. The format is still JSON. Refuses: to be read without
//! the contract, which is in docs/api.md.

use super::forecast;
use super::frame::{Frame, changes};
use crate::dto::names::RobotDto;
use crate::dto::people::WorkerDto;
use serde_json::{Value, json};

/// Keys of robots that are sent as numbers.
const ROBOT: [&str; 6] = ["x", "y", "heading", "speed", "granted", "held"];

/// Keys of workers that are sent as numbers, and keys that thin patches leave out.
const WORKER: [&str; 9] = ["x", "y", "heading", "speed", "path", "seen", "eta", "version", "feed"];

/// The patch to `new` from `old`, which has version `base`.
pub fn patch(old: &Frame, new: &Frame, base: u64) -> Value {
    let mut out = old.head(new, base);
    let mut put = |key: &str, value: Value| {
        if value.as_array().is_some_and(|list| !list.is_empty()) {
            out.insert(key.into(), value);
        }
    };
    let robots = || old.robots.iter().zip(&new.robots).enumerate();
    put("moves", packed(robots().filter_map(moved)));
    put("turns", packed(robots().filter_map(turned)));
    put("speeds", packed(robots().filter_map(sped)));
    put("ways", robots().filter_map(way).collect());
    put("robots", changes(&old.robots, &new.robots, &ROBOT));
    let workers = || old.workers.iter().zip(&new.workers).enumerate();
    put("walks", packed(workers().filter_map(walked)));
    put("paths", workers().filter_map(path).collect());
    put("workers", changes(&coarse(&old.workers), &coarse(&new.workers), &WORKER));
    put("racks", changes(&old.racks, &new.racks, &[]));
    put("stations", changes(&old.stations, &new.stations, &[]));
    if old.forecasts != new.forecasts {
        out.insert("ahead".into(), forecast::packed(&new.forecasts));
    }
    Value::Object(out)
}

type Pair<'a, T> = (usize, (&'a T, &'a T));

fn thousandths(x: f64) -> i64 {
    (x * 1000.0).round() as i64
}

/// One list of all entries. Each is preceded by the number of rows skipped since the previous one, which is smaller
/// than the row's own number.
fn packed<V: Into<Value>, const N: usize>(entries: impl Iterator<Item = (usize, [V; N])>) -> Value {
    let mut next = 0;
    let pack = |(row, numbers): (usize, [V; N])| {
        let passed = row - next;
        next = row + 1;
        std::iter::once(json!(passed)).chain(numbers.into_iter().map(Into::into))
    };
    entries.flat_map(pack).collect()
}

/// The row, and the step in millimetres.
fn moved((i, (old, new)): Pair<RobotDto<usize>>) -> Option<(usize, [i64; 2])> {
    let step = [thousandths(new.x) - thousandths(old.x), thousandths(new.y) - thousandths(old.y)];
    (step != [0, 0]).then_some((i, step))
}

/// The row, and the heading in milliradians.
fn turned((i, (old, new)): Pair<RobotDto<usize>>) -> Option<(usize, [i64; 1])> {
    (old.heading != new.heading).then(|| (i, [thousandths(new.heading)]))
}

/// The row, and the speed in centimetres per second.
fn sped((i, (old, new)): Pair<RobotDto<usize>>) -> Option<(usize, [i64; 1])> {
    let cmps = |r: &RobotDto<usize>| (r.speed * 100.0).round() as i64;
    (cmps(old) != cmps(new)).then(|| (i, [cmps(new)]))
}

/// The row, how many nodes were left behind, how many are granted now, how many of the rest stay, and the nodes that
/// follow them. The route is the granted nodes and then the held ones.
fn way((i, (old, new)): Pair<RobotDto<usize>>) -> Option<Vec<usize>> {
    if old.granted == new.granted && old.held == new.held {
        return None;
    }
    let before: Vec<usize> = old.granted.iter().chain(&old.held).copied().collect();
    let now: Vec<usize> = new.granted.iter().chain(&new.held).copied().collect();
    let first = now.first();
    let left = before.iter().position(|n| Some(n) == first).unwrap_or(before.len());
    let stay = before[left..].iter().zip(&now).take_while(|(a, b)| a == b).count();
    Some([i, left, new.granted.len(), stay].into_iter().chain(now[stay..].iter().copied()).collect())
}

/// Workers in the resolution of a screen: centimetres and percent, the five most probable goals.
fn coarse(workers: &[WorkerDto]) -> Vec<WorkerDto> {
    let hundredth = |x: f64| (x * 100.0).round() / 100.0;
    let coarse = |w: &WorkerDto| {
        let mut w = w.clone();
        w.accuracy = hundredth(w.accuracy);
        w.regions = w.regions.map(hundredth);
        w.goals.truncate(5);
        w.goals.iter_mut().for_each(|g| g.p = hundredth(g.p));
        w.goals.retain(|g| g.p > 0.0);
        (w.undecided, w.elsewhere) = (hundredth(w.undecided), hundredth(w.elsewhere));
        w
    };
    workers.iter().map(coarse).collect()
}

/// The row, the position in millimetres, the heading in milliradians, the speed in centimetres per second.
fn walked((i, (old, new)): Pair<WorkerDto>) -> Option<(usize, [Value; 4])> {
    let whole = |x: Option<f64>| json!(x.map(thousandths));
    let all =
        |w: &WorkerDto| [whole(w.x), whole(w.y), whole(w.heading), json!((w.speed * 100.0).round() as i64)];
    let now = all(new);
    (all(old) != now).then_some((i, now))
}

/// The row, how many points at the end of the path stay, and the points before them, as x and y in millimetres.
fn path((i, (old, new)): Pair<WorkerDto>) -> Option<Vec<i64>> {
    if old.path == new.path {
        return None;
    }
    let same = old.path.iter().rev().zip(new.path.iter().rev()).take_while(|(a, b)| a == b).count();
    let fresh = new.path[..new.path.len() - same].iter().flatten().map(|v| thousandths(*v));
    Some([i as i64, same as i64].into_iter().chain(fresh).collect())
}

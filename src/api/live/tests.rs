//! The feed as readers of both formats see it, against frames that change all the time.

use super::*;
use axum::extract::ws::{Message, Utf8Bytes};
use flate2::read::MultiGzDecoder;
use giveway_fleet::{AHEAD_S, Activity, Doing, Expected, Presence, RobotState, RobotView, Task, WorkerView};
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::{Dense, NodeId, WorkerId};
use giveway_floor::time::Span;
use giveway_floor::time::Time;
use giveway_people::human::{Mixture, Part};
use serde_json::{Value, json};
use std::io::Read;

fn robot(name: &str, x: f64) -> RobotView {
    RobotView {
        kind: "robot".into(),
        link: "sim".into(),
        link_state: None,
        critical: 0.15,
        maintenance: false,
        leaving: false,
        fault: None,
        name: name.into(),
        pose: Pose { at: Point::new(x, 2.0), heading: 0.0 },
        seen: None,
        speed_mps: 1.0,
        battery: 1.0,
        state: RobotState::Idle,
        task: Task::Idle,
        rack: None,
        doing: Doing::Idle,
        activity: Activity::Driving,
        since: Time::ZERO,
        driven_m: 0.0,
        heard: None,
        job: None,
        granted: vec![],
        held: vec![],
        why: None,
        passes: None,
        replanned: None,
    }
}

fn anna() -> WorkerView {
    WorkerView {
        name: "Anna".into(),
        mover: Default::default(),
        presence: Presence::Absent,
        pose: None,
        seen: None,
        speed_mps: 0.25,
        accuracy_m: 0.1,
        area: vec![],
        regions_m: [1.0, 2.0, 3.0],
        guidance: Default::default(),
        goals: vec![],
        undecided: 1.0,
        elsewhere: 0.0,
        episodes: Vec::new(),
        feed: Default::default(),
    }
}

/// A robot and a worker that go round and round, at time `t`.
fn picture(t: usize) -> Moment {
    let nodes = |from: usize, n: usize| (from..from + n).map(|i| NodeId::at(i % 17)).collect::<Vec<_>>();
    let robot = |r: usize| {
        let t = t + r;
        let angle = t as f64 / 7.0;
        RobotView {
            pose: Pose { at: Point::new(9.0 * angle.cos(), 4.0 * angle.sin()), heading: angle.sin() },
            speed_mps: (t % 4) as f64 / 4.0,
            battery: 1.0 - t as f64 / 1000.0,
            granted: nodes(t / 3, 1 + t % 3),
            // Now and then a route that has nothing to do with the previous one.
            held: if t.is_multiple_of(11) { nodes(5, t % 2) } else { nodes(t / 3 + 1 + t % 3, 4) },
            doing: if t.is_multiple_of(5) { Doing::Going } else { Doing::Idle },
            ..robot(&format!("r{r}"), 0.0)
        }
    };
    let mut worker = anna();
    if t % 13 > 2 {
        worker.presence = Presence::Tracked;
        worker.pose = Some(Pose { at: Point::new(t as f64 / 3.0, 1.0), heading: t as f64 / 9.0 });
        let here = Point::new(t as f64 / 3.0, 1.0);
        worker.guidance.path =
            std::iter::once(here).chain((t / 5..20).map(|i| Point::new(i as f64, 1.5))).collect();
    }
    let robots = (0..=t / 10).map(robot).collect();
    let forecasts = if t % 13 > 2 { vec![expected(0, t, 2)] } else { vec![] };
    Moment {
        view: giveway_fleet::View { robots, workers: vec![worker], ..Default::default() },
        forecasts: Arc::new(forecasts),
        ..Default::default()
    }
}

/// Where a worker may be, at time `t`: this changes five times slower than the frame.
fn expected(worker: usize, t: usize, parts: usize) -> Expected {
    let shift = (t / 5) as f64;
    let part = |k: usize| Part {
        weight: 1.0 / parts as f64,
        mean: Point::new(3.0 + 0.123 * shift + k as f64, -2.0 - 0.05 * shift),
        cov: nalgebra::Matrix2::new(0.5, 0.2, 0.2, 0.3 + 0.01 * shift),
    };
    let at = |s: f64| (Span::from_secs_f64(s), Mixture { parts: (0..parts).map(part).collect() });
    Expected { worker: WorkerId::at(worker), ahead: AHEAD_S.map(at).to_vec() }
}

fn moment(robots: Vec<RobotView>) -> Moment {
    Moment { view: giveway_fleet::View { robots, ..Default::default() }, ..Default::default() }
}

/// Applies a message as the contract describes it, in either format.
fn apply(mirror: &mut Value, text: &str) {
    let message: Value = serde_json::from_str(text).unwrap();
    if message["type"] == "snapshot" {
        *mirror = message;
        return;
    }
    assert_eq!(message["base"], mirror["version"], "patches follow one another");
    apply_numbers(mirror, &message);
    for list in ["robots", "racks", "stations", "workers"] {
        for change in message[list].as_array().unwrap_or(&vec![]) {
            let known = mirror[list].as_array_mut().unwrap();
            match known.iter_mut().find(|k| k["id"] == change["id"]) {
                Some(item) => item.as_object_mut().unwrap().extend(change.as_object().unwrap().clone()),
                None => known.push(change.clone()),
            }
        }
    }
    for key in ["jobs", "counters", "alarms", "closures", "forecasts", "version", "time_s"] {
        if !message[key].is_null() {
            mirror[key] = message[key].clone();
        }
    }
}

fn apply_numbers(mirror: &mut Value, message: &Value) {
    let numbers = |key: &str| message[key].as_array().cloned().unwrap_or_default();
    let row = |v: &Value| v.as_u64().unwrap() as usize;
    let parts = |v: &Value, by: f64| if v.is_null() { Value::Null } else { json!(v.as_f64().unwrap() / by) };
    let entries = |key: &str, n: usize| {
        let mut next = 0;
        let all = numbers(key);
        let row = |m: &[Value]| {
            let at = next + row(&m[0]);
            next = at + 1;
            (at, m[1..].to_vec())
        };
        all.chunks(n).map(row).collect::<Vec<_>>()
    };
    for (i, m) in entries("moves", 3) {
        let robot = &mut mirror["robots"][i];
        for (key, step) in [("x", &m[0]), ("y", &m[1])] {
            let mm = (robot[key].as_f64().unwrap() * 1000.0).round() + step.as_f64().unwrap();
            robot[key] = json!(mm / 1000.0);
        }
    }
    for (i, m) in entries("turns", 2) {
        mirror["robots"][i]["heading"] = parts(&m[0], 1000.0);
    }
    for (i, m) in entries("speeds", 2) {
        mirror["robots"][i]["speed"] = parts(&m[0], 100.0);
    }
    for way in numbers("ways") {
        let way: Vec<usize> = way.as_array().unwrap().iter().map(row).collect();
        let robot = &mut mirror["robots"][way[0]];
        let list = |key: &str| robot[key].as_array().unwrap().clone();
        let before = [list("granted"), list("held")].concat();
        let mut now: Vec<Value> = before[way[1]..way[1] + way[3]].to_vec();
        now.extend(way[4..].iter().map(|n| json!(n)));
        let held = now.split_off(way[2]);
        (robot["granted"], robot["held"]) = (now.into(), held.into());
    }
    for (i, m) in entries("walks", 5) {
        let worker = &mut mirror["workers"][i];
        for (key, value) in [("x", &m[0]), ("y", &m[1]), ("heading", &m[2])] {
            worker[key] = parts(value, 1000.0);
        }
        worker["speed"] = parts(&m[3], 100.0);
    }
    if message["ahead"].is_array() {
        let forecast = |numbers: &Value| {
            let n: Vec<f64> = numbers.as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect();
            let part = |p: &[f64]| {
                let [p_, x, y, sx, sy, tilt] = [1, 2, 3, 4, 5, 6].map(|i| p[i] / 100.0);
                json!({"after_s": p[0], "p": p_, "x": x, "y": y, "sx": sx, "sy": sy, "tilt": tilt})
            };
            let worker = mirror["workers"][n[0] as usize]["id"].clone();
            json!({"worker": worker, "parts": n[1..].chunks(7).map(part).collect::<Vec<_>>()})
        };
        let all: Vec<Value> = numbers("ahead").iter().map(forecast).collect();
        mirror["forecasts"] = json!(all);
    }
    for path in numbers("paths") {
        let path = path.as_array().unwrap();
        let worker = &mut mirror["workers"][row(&path[0])];
        let before = worker["path"].as_array().unwrap().clone();
        let fresh = path[2..].chunks(2).map(|p| json!([parts(&p[0], 1000.0), parts(&p[1], 1000.0)]));
        worker["path"] = fresh.chain(before[before.len() - row(&path[1])..].iter().cloned()).collect();
    }
}

fn live() -> Live {
    let map = giveway_floor::warehouse::formats::json::parse(include_str!("../../../maps/lab.json")).unwrap();
    Live::new(Arc::new(map), 1000)
}

/// What a reader of text messages lacks.
fn after(live: &Live, patches: PatchFormat, since: Option<u64>, most: u64) -> (Vec<Utf8Bytes>, u64) {
    let (messages, version) =
        live.after(FeedReader { patches, snapshots: SnapshotFormat::Text }, since, most);
    (messages.into_iter().map(|m| m.into_text().unwrap()).collect(), version)
}

#[test]
fn a_packed_snapshot_is_the_text_of_the_other_and_made_once() {
    let live = live();
    live.publish(&picture(3), &[], 0.0);
    let reader = FeedReader { patches: PatchFormat::Plain, snapshots: SnapshotFormat::Gzip };
    let packed = || match live.after(reader, None, LAGGING).0.remove(0) {
        Message::Binary(bytes) => bytes,
        other => panic!("{other:?}"),
    };
    let bytes = packed();
    let mut text = String::new();
    MultiGzDecoder::new(&bytes[..]).read_to_string(&mut text).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), fresh(&live));
    assert!(bytes.len() * 2 < text.len(), "{} of {}", bytes.len(), text.len());
    assert_eq!(packed().as_ptr(), bytes.as_ptr());
    live.publish(&picture(4), &[], 0.0);
    assert_ne!(packed(), bytes);
}

fn fresh(live: &Live) -> Value {
    let (texts, _) = after(live, PatchFormat::Plain, None, LAGGING);
    serde_json::from_str(&texts[0]).unwrap()
}

#[test]
fn a_reader_of_patches_sees_what_a_reader_of_snapshots_sees() {
    for shape in [PatchFormat::Plain, PatchFormat::Thin] {
        let live = live();
        live.publish(&picture(0), &[], 0.0);
        let (first, mut version) = after(&live, shape, None, LAGGING);
        let mut mirror = Value::Null;
        apply(&mut mirror, &first[0]);
        for t in 0..60 {
            live.publish(&picture(t), &[], 0.0);
            if t % 3 == 0 {
                let (texts, now) = after(&live, shape, Some(version), LAGGING);
                assert!(texts.iter().all(|t| !t.contains("snapshot")), "nothing is sent twice");
                texts.iter().for_each(|t| apply(&mut mirror, t));
                version = now;
            }
        }
        let (texts, _) = after(&live, shape, Some(version), LAGGING);
        texts.iter().for_each(|t| apply(&mut mirror, t));
        assert_eq!(mirror["robots"].as_array().unwrap().len(), 6);
        assert!(mirror["workers"][0]["path"].as_array().unwrap().len() > 2);
        assert_eq!(mirror["forecasts"][0]["parts"].as_array().unwrap().len(), 6);
        assert_eq!(mirror, fresh(&live), "{shape:?}");
    }
}

#[test]
fn a_patch_names_only_what_changed() {
    let live = live();
    live.publish(&moment(vec![robot("a", 1.0), robot("b", 1.0)]), &[], 0.0);
    for shape in [PatchFormat::Plain, PatchFormat::Thin] {
        after(&live, shape, None, LAGGING);
    }
    live.publish(&moment(vec![robot("a", 1.0), robot("b", 1.5)]), &[], 0.0);
    let patch = |shape| -> Value {
        let (texts, version) = after(&live, shape, Some(1001), LAGGING);
        assert_eq!(version, 1002);
        serde_json::from_str(&texts[0]).unwrap()
    };
    let plain = patch(PatchFormat::Plain);
    assert_eq!(plain["robots"], json!([{"id": "b", "x": 1.5}]));
    assert_eq!(plain["racks"], json!([]));
    assert!(plain["jobs"].is_null());
    let thin = patch(PatchFormat::Thin);
    assert_eq!(
        thin,
        json!({"type": "patch", "base": 1001, "version": 1002, "time_s": 0.0, "moves": [1, 500, 0]})
    );
}

#[test]
fn eight_hundred_moving_robots_and_twenty_people_are_150_kilobytes_a_second() {
    // Every robot moves in every patch and reaches a node each second; half of them change speed, a tenth turn.
    let nodes = |from: usize, n: usize| (from..from + n).map(|i| NodeId::at(i % 4000)).collect::<Vec<_>>();
    let robot = |r: usize, t: usize| RobotView {
        pose: Pose {
            at: Point::new(30.0 + 0.123 * t as f64, r as f64),
            heading: if r.is_multiple_of(10) { 0.1 * t as f64 } else { 0.0 },
        },
        speed_mps: if r.is_multiple_of(2) { 0.11 * (t % 10) as f64 } else { 1.2 },
        granted: nodes(1000 + r + (r + t) / 10, 4),
        held: nodes(1004 + r + (r + t) / 10, 40),
        ..robot(&format!("robot-{r}"), 0.0)
    };
    let worker = |t: usize| {
        let here = Point::new(5.0 + 0.13 * t as f64, 7.123);
        let mut worker = WorkerView { presence: Presence::Tracked, ..anna() };
        worker.pose = Some(Pose { at: here, heading: 0.01 * t as f64 });
        worker.goals = (0..10).map(|g| (Point::new(g as f64, 1.234), 0.1 + 0.002 * (t % 7) as f64)).collect();
        worker.guidance.path =
            std::iter::once(here).chain((0..20).map(|i| Point::new(30.0, i as f64))).collect();
        worker
    };
    let moment = |t: usize| {
        let robots = (0..800).map(|r| robot(r, t)).collect();
        let workers = (0..20).map(|_| worker(t)).collect();
        // Twice a second, with the most parts that there can be.
        let forecasts = Arc::new((0..20).map(|w| expected(w, t, 4)).collect());
        let view = giveway_fleet::View { robots, workers, ..Default::default() };
        Moment { view, forecasts, ..Default::default() }
    };
    let live = live();
    live.publish(&moment(0), &[], 0.0);
    let (_, first) = after(&live, PatchFormat::Thin, None, LAGGING);
    for t in 1..=10 {
        live.publish(&moment(t), &[], 0.0);
    }
    let (texts, _) = after(&live, PatchFormat::Thin, Some(first), LAGGING);
    let bytes: usize = texts.iter().map(|t| t.len()).sum();
    assert_eq!(texts.len(), 10, "one second");
    assert!(bytes <= 150_000, "{bytes} bytes a second");
}

#[test]
fn a_reader_too_far_behind_or_from_another_run_gets_a_snapshot() {
    let live = live();
    for i in 0..400 {
        live.publish(&moment(vec![robot("a", f64::from(i))]), &[], 0.0);
        after(&live, PatchFormat::Plain, None, LAGGING);
    }
    let kind = |since, most| {
        let (texts, _) = after(&live, PatchFormat::Plain, since, most);
        (texts.len(), texts.first().is_some_and(|t| t.contains("\"snapshot\"")))
    };
    assert_eq!(kind(Some(1400), 300), (0, false), "nothing is missing");
    assert_eq!(kind(Some(1100), 300), (300, false));
    assert_eq!(kind(Some(1099), 300), (1, true), "not kept any more");
    assert_eq!(kind(Some(1300), LAGGING), (1, true), "lagging while it reads");
    assert_eq!(kind(Some(5000), 300), (1, true), "a version from the future");
    assert_eq!(kind(Some(3), 300), (1, true), "a version of an earlier run");
}

#[test]
fn patches_are_written_only_while_somebody_reads_them() {
    let live = live();
    live.publish(&moment(vec![robot("a", 0.0)]), &[], 0.0);
    after(&live, PatchFormat::Thin, None, LAGGING);
    for i in 0..KEPT + 5 {
        live.publish(&moment(vec![robot("a", i as f64)]), &[], 0.0);
        assert!(live.state().plain.patches.is_empty());
    }
    let version = live.state().version;
    assert!(live.state().thin.patches.is_empty(), "nobody read for half a minute");
    let (texts, _) = after(&live, PatchFormat::Thin, Some(version - 1), LAGGING);
    assert!(texts[0].contains("\"snapshot\""), "who comes back late begins anew");
    live.publish(&moment(vec![robot("a", 0.5)]), &[], 0.0);
    let (texts, _) = after(&live, PatchFormat::Thin, Some(version), LAGGING);
    assert!(texts[0].contains("\"patch\""));
}

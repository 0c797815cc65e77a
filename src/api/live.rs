//! The live feed: a snapshot, then patches with base and version, made once for everybody.
//!
//! Main type: [`Live`]. [`Live::publish`] compares the new picture with the last one and writes one patch;
//! readers fetch what they miss by version, so that a slow reader costs nothing but its own fresh snapshot.
//! Versions start above those of every earlier run, so that a reader who resumes after a restart gets a
//! snapshot. Refuses: a queue per reader.

use super::dto::{JobCountsDto, Names};
use super::port::{Alarm, Moment};
use crate::warehouse::Warehouse;
use axum::extract::ws::Utf8Bytes;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use tokio::sync::watch;

/// How many patches are kept for readers who resume: half a minute.
const KEPT: usize = 300;

/// A reader further behind than this while it reads gets a snapshot: five seconds.
pub const LAGGING: u64 = 50;

type Item = Map<String, Value>;

/// The picture as it travels.
#[derive(Clone, Debug, Default, PartialEq)]
struct Frame {
    robots: Vec<Item>,
    racks: Vec<Item>,
    stations: Vec<Item>,
    workers: Vec<Item>,
    closures: Value,
    jobs: Value,
    counters: Value,
    alarms: Value,
    time_s: f64,
}

#[derive(Debug)]
struct State {
    version: u64,
    frame: Frame,
    snapshot: Option<Utf8Bytes>,
    patches: VecDeque<Utf8Bytes>,
}

/// The feed.
#[derive(Debug)]
pub struct Live {
    map: Arc<Warehouse>,
    state: Mutex<State>,
    newest: watch::Sender<u64>,
}

impl Live {
    /// A feed whose first version is `first`, which no earlier run may have reached.
    pub fn new(map: Arc<Warehouse>, first: u64) -> Live {
        let state =
            State { version: first, frame: Frame::default(), snapshot: None, patches: VecDeque::new() };
        Live { map, state: Mutex::new(state), newest: watch::Sender::new(first) }
    }

    /// Tells of every new version.
    pub fn subscribe(&self) -> watch::Receiver<u64> {
        self.newest.subscribe()
    }

    /// Takes a new picture.
    pub fn publish(&self, moment: &Moment, alarms: &[Alarm], started_s: f64) {
        let frame = Frame::of(&self.map, moment, alarms, started_s);
        let mut state = self.state.lock().expect("nobody panics with this lock");
        let version = state.version + 1;
        let patch = patch(&state.frame, &frame, state.version);
        state.patches.push_back(patch.to_string().into());
        if state.patches.len() > KEPT {
            state.patches.pop_front();
        }
        state.version = version;
        state.frame = frame;
        state.snapshot = None;
        drop(state);
        self.newest.send_replace(version);
    }

    /// What a reader at version `since` misses, with the version it has then: patches if there are at most
    /// `most`, else a snapshot.
    pub fn after(&self, since: Option<u64>, most: u64) -> (Vec<Utf8Bytes>, u64) {
        let mut state = self.state.lock().expect("nobody panics with this lock");
        let missing = since.and_then(|s| state.version.checked_sub(s));
        let most = most.min(state.patches.len() as u64);
        if let Some(missing) = missing.filter(|m| *m <= most) {
            let skip = state.patches.len() - missing as usize;
            return (state.patches.iter().skip(skip).cloned().collect(), state.version);
        }
        let version = state.version;
        let text = match &state.snapshot {
            Some(text) => text.clone(),
            None => {
                let text: Utf8Bytes = state.frame.snapshot(version).to_string().into();
                state.snapshot = Some(text.clone());
                text
            }
        };
        (vec![text], version)
    }

    /// How far back a reader may resume.
    pub fn kept(&self) -> u64 {
        KEPT as u64
    }
}

impl Frame {
    fn of(map: &Warehouse, moment: &Moment, alarms: &[Alarm], started_s: f64) -> Frame {
        let names = Names { map, view: &moment.view };
        let counts = moment.view.counts;
        let m = moment.measured;
        Frame {
            robots: items(names.robots()),
            racks: items(names.racks()),
            stations: items(names.stations()),
            workers: items(names.workers()),
            closures: plain(names.closures()),
            jobs: plain(JobCountsDto::from(counts)),
            counters: json!({
                "robot_deliveries": counts.robot_deliveries, "human_deliveries": counts.human_deliveries,
                "deliveries_per_hour": m.deliveries_per_hour.round(), "encounters": counts.encounters,
                "deviations": counts.deviations, "interruptions": counts.interruptions, "replans": counts.replans,
                "plan_us_p50": m.plan_us_p50, "plan_us_p99": m.plan_us_p99, "step_us_p99": m.step_us_p99,
            }),
            alarms: alarms
                .iter()
                .map(|a| {
                    let since_s = super::dto::round3(a.since.as_secs_f64() - started_s);
                    json!({"id": a.id, "text": a.text, "since_s": since_s})
                })
                .collect(),
            time_s: super::dto::round3(moment.time_s),
        }
    }

    fn snapshot(&self, version: u64) -> Value {
        json!({
            "type": "snapshot", "version": version, "time_s": self.time_s, "simulated": true,
            "robots": self.robots, "racks": self.racks, "stations": self.stations,
            "workers": self.workers, "closures": self.closures,
            "jobs": self.jobs, "counters": self.counters, "alarms": self.alarms,
        })
    }
}

fn plain(item: impl Serialize) -> Value {
    serde_json::to_value(item).expect("wire types are plain")
}

fn items(list: Vec<impl Serialize>) -> Vec<Item> {
    let item = |i| match plain(i) {
        Value::Object(map) => map,
        _ => Map::new(),
    };
    list.into_iter().map(item).collect()
}

/// What changed from `old`, which has version `base`, to `new`.
fn patch(old: &Frame, new: &Frame, base: u64) -> Value {
    let mut out = Map::new();
    out.insert("type".into(), "patch".into());
    out.insert("base".into(), base.into());
    out.insert("version".into(), (base + 1).into());
    out.insert("time_s".into(), new.time_s.into());
    out.insert("robots".into(), changes(&old.robots, &new.robots));
    out.insert("racks".into(), changes(&old.racks, &new.racks));
    out.insert("stations".into(), changes(&old.stations, &new.stations));
    out.insert("workers".into(), changes(&old.workers, &new.workers));
    for (key, old, new) in [
        ("jobs", &old.jobs, &new.jobs),
        ("counters", &old.counters, &new.counters),
        ("alarms", &old.alarms, &new.alarms),
        ("closures", &old.closures, &new.closures),
    ] {
        if old != new {
            out.insert(key.into(), new.clone());
        }
    }
    Value::Object(out)
}

/// Items that changed: their id and the keys that did. New items are whole.
fn changes(old: &[Item], new: &[Item]) -> Value {
    let changed = |(i, item): (usize, &Item)| {
        let Some(before) = old.get(i) else { return Some(Value::Object(item.clone())) };
        let mut keys: Item = item
            .iter()
            .filter(|(k, v)| before.get(*k) != Some(v))
            .map(|(k, v)| (k.clone(), v.clone()))
            .collect();
        if keys.is_empty() {
            return None;
        }
        keys.insert("id".into(), item.get("id").cloned().unwrap_or_default());
        Some(Value::Object(keys))
    };
    new.iter().enumerate().filter_map(changed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::{Doing, RobotState, RobotView, Task};
    use crate::geometry::{Point, Pose};

    fn robot(name: &str, x: f64) -> RobotView {
        RobotView {
            name: name.into(),
            pose: Pose { at: Point::new(x, 2.0), heading: 0.0 },
            seen: None,
            speed_mps: 1.0,
            battery: 1.0,
            state: RobotState::Idle,
            task: Task::Idle,
            rack: None,
            doing: Doing::Idle,
            job: None,
            granted: vec![],
            held: vec![],
            why: None,
        }
    }

    fn moment(robots: Vec<RobotView>) -> Moment {
        Moment { view: crate::fleet::View { robots, ..Default::default() }, ..Default::default() }
    }

    /// A reader as the contract describes it.
    fn apply(mirror: &mut Value, text: &str) {
        let message: Value = serde_json::from_str(text).unwrap();
        if message["type"] == "snapshot" {
            *mirror = message;
            return;
        }
        assert_eq!(message["base"], mirror["version"], "patches follow one another");
        for list in ["robots", "racks", "stations", "workers"] {
            for change in message[list].as_array().unwrap() {
                let known = mirror[list].as_array_mut().unwrap();
                match known.iter_mut().find(|k| k["id"] == change["id"]) {
                    Some(item) => item.as_object_mut().unwrap().extend(change.as_object().unwrap().clone()),
                    None => known.push(change.clone()),
                }
            }
        }
        for key in ["jobs", "counters", "alarms", "closures", "version", "time_s"] {
            if !message[key].is_null() {
                mirror[key] = message[key].clone();
            }
        }
    }

    fn live() -> Live {
        let map = crate::warehouse::formats::json::parse(include_str!("../../maps/lab.json")).unwrap();
        Live::new(Arc::new(map), 1000)
    }

    #[test]
    fn a_reader_of_patches_sees_what_a_reader_of_snapshots_sees() {
        let live = live();
        live.publish(&moment(vec![robot("r0", 1.0)]), &[], 0.0);
        let (first, mut version) = live.after(None, LAGGING);
        let mut mirror = Value::Null;
        apply(&mut mirror, &first[0]);
        for i in 0..40 {
            let robots = (0..=i / 10).map(|r| robot(&format!("r{r}"), f64::from(i * r) / 3.0)).collect();
            live.publish(&moment(robots), &[], 0.0);
            if i % 3 == 0 {
                let (texts, now) = live.after(Some(version), LAGGING);
                texts.iter().for_each(|t| apply(&mut mirror, t));
                version = now;
            }
        }
        let (texts, _) = live.after(Some(version), LAGGING);
        texts.iter().for_each(|t| apply(&mut mirror, t));
        let (fresh, _) = live.after(None, LAGGING);
        assert_eq!(mirror["robots"].as_array().unwrap().len(), 4);
        assert_eq!(mirror, serde_json::from_str::<Value>(&fresh[0]).unwrap());
    }

    #[test]
    fn a_patch_names_only_what_changed() {
        let live = live();
        live.publish(&moment(vec![robot("a", 1.0), robot("b", 1.0)]), &[], 0.0);
        live.publish(&moment(vec![robot("a", 1.0), robot("b", 1.5)]), &[], 0.0);
        let (texts, version) = live.after(Some(1001), LAGGING);
        let patch: Value = serde_json::from_str(&texts[0]).unwrap();
        assert_eq!(version, 1002);
        assert_eq!(patch["robots"], json!([{"id": "b", "x": 1.5}]));
        assert_eq!(patch["racks"], json!([]));
        assert!(patch["jobs"].is_null());
    }

    #[test]
    fn a_reader_too_far_behind_or_from_another_run_gets_a_snapshot() {
        let live = live();
        for i in 0..400 {
            live.publish(&moment(vec![robot("a", f64::from(i))]), &[], 0.0);
        }
        let kind = |since, most| {
            let (texts, _) = live.after(since, most);
            (texts.len(), texts.first().is_some_and(|t| t.contains("\"snapshot\"")))
        };
        assert_eq!(kind(Some(1400), 300), (0, false), "nothing is missing");
        assert_eq!(kind(Some(1100), 300), (300, false));
        assert_eq!(kind(Some(1099), 300), (1, true), "not kept any more");
        assert_eq!(kind(Some(1300), LAGGING), (1, true), "lagging while it reads");
        assert_eq!(kind(Some(5000), 300), (1, true), "a version from the future");
        assert_eq!(kind(Some(3), 300), (1, true), "a version of an earlier run");
    }
}

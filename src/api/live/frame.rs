//! A frame: the view on the wire; and the changes from one frame to the next, in rows with names.
//!
//! Main type: [`Frame`]. Refuses: to know versions or readers.

use super::forecast::{ForecastDto, forecasts};
use crate::dto::alarms;
use crate::dto::cell::shown::ShownCell;
use crate::dto::names::{CountersDto, JobCountsDto, Names, RackDto, RobotDto, StationDto};
use crate::dto::people::WorkerDto;
use crate::port::moment::{FloorSimulation, Moment};
use crate::wire::text::{round3, time_text};
use giveway_fleet::alarm::Alarm;
use giveway_fleet::history::waits;
use giveway_fleet::{Backlog, Presence};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// One row, or its changes.
pub type FrameItem = Map<String, Value>;

/// The view on the wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    pub(crate) robots: Vec<RobotDto<usize>>,
    pub(crate) racks: Vec<RackDto<usize>>,
    pub(crate) stations: Vec<StationDto>,
    pub(crate) workers: Vec<WorkerDto>,
    pub(crate) forecasts: Vec<ForecastDto>,
    pub(crate) closures: Value,
    pub(crate) jobs: Value,
    pub(crate) counters: Value,
    pub(crate) alarms: Value,
    pub(crate) time_s: f64,
    /// The simulation, where all is simulated; said once, in the snapshot.
    pub(crate) simulation: Option<FloorSimulation>,
    /// Data for recordings; the live feed sends only `zero` of it.
    pub(crate) beside: Beside,
}

/// Data of a frame that the live feed does not send.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beside {
    /// The time at which the frame's seconds are zero.
    pub(crate) zero: Time,
    /// The first of the waiting jobs.
    pub(crate) backlog: Arc<Backlog>,
    /// How many robots stand although they should drive, as in the figures over time.
    pub(crate) waiting: usize,
    /// How many workers are on the floor.
    pub(crate) people: usize,
    /// The states of work cells.
    pub(crate) cells: Vec<ShownCell>,
}

impl Beside {
    fn of(names: &Names<'_>, moment: &Moment) -> Beside {
        let view = &moment.view;
        let zero = view.now - Span::from_secs_f64(moment.time_s);
        Beside {
            zero,
            cells: names.shown_cells(zero),
            backlog: moment.backlog.clone(),
            waiting: view.robots.iter().filter(|r| waits(r)).count(),
            people: view.workers.iter().filter(|w| w.presence != Presence::Absent).count(),
        }
    }
}

impl Frame {
    /// The frame of a moment; times of alarms count from `started_s`.
    pub fn of(map: &Warehouse, moment: &Moment, active: &[Alarm], started_s: f64) -> Frame {
        let names = Names { map, view: &moment.view };
        let counts = moment.view.counts;
        let m = moment.measured;
        Frame {
            robots: names.robot_rows(),
            racks: names.rack_rows(),
            stations: names.stations(),
            workers: names.workers(),
            forecasts: forecasts(&moment.forecasts),
            closures: plain(names.closures()),
            jobs: plain(JobCountsDto::from(counts)),
            counters: plain(CountersDto {
                robot_deliveries: counts.robot_deliveries,
                human_deliveries: counts.human_deliveries,
                deliveries_per_hour: m.deliveries_per_hour.round(),
                encounters: counts.encounters,
                deviations: counts.deviations,
                interruptions: counts.interruptions,
                replans: counts.replans,
                plan_us_p50: m.plan_us_p50,
                plan_us_p99: m.plan_us_p99,
                step_us_p99: m.step_us_p99,
            }),
            alarms: active.iter().map(|a| alarms::row(a, started_s)).collect(),
            time_s: round3(moment.time_s),
            simulation: moment.simulation,
            beside: Beside::of(&names, moment),
        }
    }

    pub(crate) fn snapshot(&self, version: u64) -> Value {
        json!({
            "type": "snapshot", "version": version, "time_s": self.time_s,
            "simulated": self.simulation.is_some(), "speed": self.simulation.map_or(1, |s| s.speed),
            "started": time_text(self.beside.zero),
            "robots": self.robots, "racks": self.racks, "stations": self.stations,
            "workers": self.workers, "forecasts": self.forecasts, "closures": self.closures,
            "jobs": self.jobs, "counters": self.counters, "alarms": self.alarms,
        })
    }

    /// The fields with which every patch begins; the patch leads to `new` from this frame, which has version `base`.
    pub(super) fn head(&self, new: &Frame, base: u64) -> FrameItem {
        let mut out = FrameItem::new();
        out.insert("type".into(), "patch".into());
        out.insert("base".into(), base.into());
        out.insert("version".into(), (base + 1).into());
        out.insert("time_s".into(), new.time_s.into());
        for (key, old, new) in [
            ("jobs", &self.jobs, &new.jobs),
            ("counters", &self.counters, &new.counters),
            ("alarms", &self.alarms, &new.alarms),
            ("closures", &self.closures, &new.closures),
        ] {
            if old != new {
                out.insert(key.into(), new.clone());
            }
        }
        out
    }

    /// The patch to `new` from this frame, which has version `base`.
    pub(super) fn patch(&self, new: &Frame, base: u64) -> Value {
        let mut out = self.head(new, base);
        if self.forecasts != new.forecasts {
            out.insert("forecasts".into(), plain(&new.forecasts));
        }
        out.insert("robots".into(), changes(&self.robots, &new.robots, &[]));
        out.insert("racks".into(), changes(&self.racks, &new.racks, &[]));
        out.insert("stations".into(), changes(&self.stations, &new.stations, &[]));
        out.insert("workers".into(), changes(&self.workers, &new.workers, &[]));
        Value::Object(out)
    }
}

fn plain(item: impl Serialize) -> Value {
    serde_json::to_value(item).expect("wire types are plain")
}

fn item(row: impl Serialize) -> FrameItem {
    match plain(row) {
        Value::Object(map) => map,
        _ => FrameItem::new(),
    }
}

/// Rows that changed: their ids and changed keys, except the keys in `besides`. New rows are complete.
pub fn changes<T: Serialize + PartialEq>(old: &[T], new: &[T], besides: &[&str]) -> Value {
    let changed = |(i, row): (usize, &T)| match old.get(i) {
        None => Some(Value::Object(item(row))),
        Some(before) if before == row => None,
        Some(before) => {
            let before = item(before);
            let mut row = item(row);
            let id = row.remove("id").unwrap_or_default();
            row.retain(|key, value| !besides.contains(&key.as_str()) && before.get(key) != Some(value));
            if row.is_empty() {
                return None;
            }
            row.insert("id".into(), id);
            Some(Value::Object(row))
        }
    };
    new.iter().enumerate().filter_map(changed).collect()
}

//! `giveway sim`: runs a scenario without a server.
//!
//! Main type: [`SimArgs`]. Refuses: to exit with success if a law was broken.

use super::files::{read, read_map, read_model, read_pick_model};
use super::frames::FrameWriter;
use super::progress::{progress, stopwatch};
use super::rings;
use crate::server::{FloorFile, FloorSource, ServedFloor};
use anyhow::Context;
use clap::Args;
use giveway_fleet::InsertionCounts;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Warehouse, room_for};
use giveway_people::human::Model;
use giveway_people::reach::PickModel;
use giveway_sim::recording::{Header, Recorder};
use giveway_sim::{
    Consistency, Demand, JobTally, NeesFigures, OrderFileLine, Outcome, Scenario, Simulation,
    nothing_to_order,
};
use giveway_site::{BrokerSettings, RobotsFile, Site};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// Arguments of `sim`.
#[derive(Args)]
pub struct SimArgs {
    /// Scenario file.
    scenario: PathBuf,
    /// Seed; the scenario's if absent.
    #[arg(long)]
    seed: Option<u64>,
    /// A map other than the scenario's, in any format that `map import` knows.
    #[arg(long)]
    map: Option<PathBuf>,
    /// Number of robots, instead of the scenario's.
    #[arg(long)]
    robots: Option<usize>,
    /// Duration, seconds, instead of the scenario's.
    #[arg(long)]
    duration: Option<f64>,
    /// Jobs from this file of order lines (CSV with `OrderNumber` and `AlleyCell`, `Location` or `SKU`).
    #[arg(long)]
    orders: Option<PathBuf>,
    /// What was learned about people (`giveway learn`); the scenario's own, or the built-in figures, if absent.
    #[arg(long)]
    model: Option<PathBuf>,
    /// What was learned about pickers (`giveway learn picks`); the built-in figures if absent.
    #[arg(long)]
    pick_model: Option<PathBuf>,
    /// Skip the second run, which measures the throughput bound.
    #[arg(long)]
    no_bound: bool,
    /// Write a recording for `giveway replay`; compressed if the name ends with `.gz`.
    #[arg(long)]
    record: Option<PathBuf>,
    /// Write a reel of the run to this file; the dashboard of any server can open it.
    #[arg(long, value_name = "FILE")]
    reel: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// The input of a run.
pub struct Setup {
    /// The scenario.
    pub scenario: Scenario,
    /// The scenario's map.
    pub warehouse: Arc<Warehouse>,
    /// The scenario's order lines.
    pub lines: Vec<OrderFileLine>,
    /// The text of the file, as it was read.
    pub text: String,
    /// Whether the file is a site without toys.
    is_site: bool,
}

impl Setup {
    /// Reads the floor for a server; `map` replaces the map that the file names.
    pub fn of_floor(file: &FloorFile, map: Option<&Path>) -> anyhow::Result<Setup> {
        match file {
            FloorFile::Scenario(path) => Setup::read(path, map, None),
            FloorFile::Site(path) => {
                let text = read(path)?;
                let mut site =
                    Site::parse(&text).with_context(|| format!("{} is refused", path.display()))?;
                let robots = site.links.sim.map_or(0, |sim| sim.robots);
                let warehouse = take_map(&mut site, path, map, robots)?;
                site.check_method(&warehouse, "method")
                    .with_context(|| format!("{} is refused", path.display()))?;
                if let Some(mqtt) = &mut site.links.mqtt {
                    let files = mqtt.ca.iter_mut().chain(mqtt.identity.iter_mut().flatten());
                    files.for_each(|file| *file = beside(path, file).display().to_string());
                }
                let scenario = Scenario::from(site);
                Ok(Setup { scenario, warehouse, lines: Vec::new(), text, is_site: true })
            }
        }
    }

    /// Reads a scenario with its map and orders; paths in the file are relative to it.
    pub fn read(path: &Path, map: Option<&Path>, orders: Option<&Path>) -> anyhow::Result<Setup> {
        let text = read(path)?;
        let refused = || format!("{} is refused", path.display());
        let mut scenario = Scenario::parse(&text).with_context(refused)?;
        if let Some(orders) = orders {
            let backlog = scenario.robots.max(1) * 2;
            scenario.demand = Demand::File { path: orders.display().to_string(), backlog };
        }
        let lines = match (&scenario.demand, orders) {
            (_, Some(file)) => Some(file.to_path_buf()),
            (Demand::File { path: file, .. }, None) => Some(beside(path, file)),
            _ => None,
        };
        let lines = lines.map_or(Ok(Vec::new()), |file| {
            OrderFileLine::parse_csv(&read(&file)?).map_err(|e| anyhow::anyhow!("{}: {e}", file.display()))
        })?;
        let warehouse = take_map(&mut scenario.site, path, map, scenario.robots)?;
        scenario.check_method(&warehouse).with_context(refused)?;
        if let Some(cells) = &scenario.cells {
            cells.check_stations(&warehouse).with_context(refused)?;
        }
        scenario.areas(&warehouse, Time::ZERO).with_context(refused)?;
        scenario.recurring(&warehouse, Time::ZERO).with_context(refused)?;
        Ok(Setup { scenario, warehouse, lines, text, is_site: false })
    }

    /// The floor for a server. On a site without simulated robots, nothing is simulated.
    pub fn served(self) -> ServedFloor {
        let Setup { scenario, warehouse, lines, is_site, .. } = self;
        let is_simulated = !is_site || scenario.site.links.sim.is_some();
        ServedFloor::new(FloorSource { lines, is_simulated, ..FloorSource::from(scenario) }, warehouse)
    }

    /// Replaces the figures about people by those in a file, if one is named.
    pub fn use_model(&mut self, path: Option<&Path>) -> anyhow::Result<()> {
        if path.is_some() {
            self.scenario.site.learned = read_model(path)?;
        }
        Ok(())
    }

    /// Replaces the figures about pickers by those in a file, if one is named.
    pub fn use_pick_model(&mut self, path: Option<&Path>) -> anyhow::Result<()> {
        if let Some(path) = path {
            self.scenario.site.picks = read_pick_model(path)?;
        }
        Ok(())
    }

    /// Adds robots behind a broker to the floor: those of a file, if one is named, at the broker or at the site's own.
    pub fn use_robots(&mut self, broker: Option<BrokerSettings>, file: Option<&Path>) -> anyhow::Result<()> {
        if broker.is_none() && file.is_none() {
            return Ok(());
        }
        let site = &mut self.scenario.site;
        let robots = match file {
            None => None,
            Some(path) => {
                let refused = || format!("{} is refused", path.display());
                Some(RobotsFile::parse(&read(path)?, Some((&*site, &self.warehouse))).with_context(refused)?)
            }
        };
        site.add_robots(broker, robots).context("the robots are refused")?;
        let listed = site.links.mqtt.as_ref().map_or(0, |mqtt| mqtt.robots.len());
        let robots = self.scenario.robots + listed;
        room_for(&self.warehouse, robots).map_err(|e| {
            anyhow::anyhow!("the map has no room for {robots} robots, {listed} of them listed:\n{e}")
        })?;
        let fitted = self.scenario.site.fit(&self.warehouse);
        self.warehouse = fitted.map_err(|e| anyhow::anyhow!("the map is not for the robots:\n{e}"))?;
        Ok(())
    }
}

/// The path that a file names, resolved relative to that file.
fn beside(file: &Path, named: &str) -> PathBuf {
    file.parent().unwrap_or(Path::new(".")).join(named)
}

/// Reads the map that the site names in the file at `path`, or another one, with room for this many robots of the
/// site's kinds; and the figures about people that the site names.
fn take_map(
    site: &mut Site,
    path: &Path,
    map: Option<&Path>,
    robots: usize,
) -> anyhow::Result<Arc<Warehouse>> {
    let warehouse = read_map(&map.map_or_else(|| beside(path, &site.map), Path::to_path_buf))?;
    room_for(&warehouse, robots)
        .map_err(|e| anyhow::anyhow!("the map has no room for {robots} robots:\n{e}"))?;
    let warehouse = site
        .fit(&warehouse)
        .map_err(|e| anyhow::anyhow!("the map is not for the robots of {}:\n{e}", path.display()))?;
    if let Some(model) = &site.model {
        site.learned = read_model(Some(&beside(path, model)))?;
    }
    Ok(warehouse)
}

impl SimArgs {
    /// Runs the scenario and prints its figures.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let mut setup = Setup::read(&self.scenario, self.map.as_deref(), self.orders.as_deref())?;
        setup.use_model(self.model.as_deref())?;
        setup.use_pick_model(self.pick_model.as_deref())?;
        setup.scenario.robots = self.robots.unwrap_or(setup.scenario.robots);
        if let Some(seconds) = self.duration {
            anyhow::ensure!((1.0..=1e7).contains(&seconds), "--duration must be from 1 to 10000000 seconds");
            setup.scenario.duration = Span::from_secs_f64(seconds);
        }
        giveway_floor::warehouse::room_for(&setup.warehouse, setup.scenario.robots)
            .map_err(|e| anyhow::anyhow!("the map has no room for {} robots:\n{e}", setup.scenario.robots))?;
        if let Some(why) = nothing_to_order(&setup.scenario, &setup.warehouse) {
            eprintln!("{why}");
        }
        let seed = self.seed.unwrap_or(setup.scenario.seed);
        let start = Instant::now();
        let outcome = simulate(&setup, seed, false, self.record.as_deref(), self.reel.as_deref())?;
        let wall = start.elapsed().as_secs_f64();
        let bound = match self.no_bound {
            true => None,
            false => {
                let unhindered = simulate(&setup, seed, true, None, None)?.counts.robot_deliveries;
                Some(throughput_bound(outcome.counts.robot_deliveries, unhindered))
            }
        };
        let report = report(&setup, seed, &outcome, wall, bound);
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            print_table(&report);
        }
        outcome.broken.iter().for_each(|b| eprintln!("broken law at {b}"));
        Ok(if outcome.law_violations == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }
}

fn simulate(
    setup: &Setup,
    seed: u64,
    without_conflicts: bool,
    record: Option<&Path>,
    reel: Option<&Path>,
) -> anyhow::Result<Outcome> {
    let Setup { scenario, warehouse, lines, text, .. } = setup;
    let mut sim = Simulation::new(warehouse.clone(), scenario, lines, seed, without_conflicts, stopwatch);
    let mut recorder = Recorder::default();
    let mut file = record.map(super::recording::create).transpose()?;
    if let Some(file) = &mut file {
        let map = giveway_floor::warehouse::formats::json::write(warehouse);
        let is_builtin = *scenario.site.learned == *Model::builtin();
        let model = (!is_builtin).then(|| scenario.site.learned.to_json());
        let picks = (*scenario.site.picks != *PickModel::builtin()).then(|| scenario.site.picks.to_json());
        let header = Header { giveway_recording: 1, scenario: text.clone(), map, seed, model, picks };
        file.write(&Recorder::header(&header))?;
    }
    let mut reeler = FrameWriter::create(reel, None, sim.fleet(), scenario.site.name.clone())?;
    let what = if without_conflicts { "bound" } else { "simulating" };
    let bar = progress(scenario.duration.0 as u64 / 1_000_000, what);
    while !sim.is_over() {
        let now = sim.now();
        if let Some(file) = file.take_if(|_| sim.drains()) {
            end_recording(file, &sim)?;
        }
        let turn = sim.step();
        if let Some(reeler) = &mut reeler {
            reeler.step(sim.fleet(), now, turn.facts())?;
        }
        if let Some(file) = &mut file {
            file.write(&recorder.step(now, &turn.inputs))?;
        }
        bar.set_position(now.0 as u64 / 1_000_000);
    }
    bar.finish_and_clear();
    reeler.map_or(Ok(()), FrameWriter::finish)?;
    if let Some(file) = file {
        end_recording(file, &sim)?;
    }
    Ok(sim.outcome())
}

/// A recording covers the duration, like the digest of the report, but not the time in which the floor drains.
fn end_recording(mut file: super::recording::RecordingWriter, sim: &Simulation) -> anyhow::Result<()> {
    file.write(&Recorder::end(sim.trace_hash()))?;
    file.finish()
}

/// A lower bound on what the floor could deliver if robots never got in each other's way. A run in which they pass
/// through one another estimates it, but does not prove it: the same heuristics dispatch that run, meet other
/// situations and sometimes choose worse. On a floor that is limited by its stations, such a run can deliver slightly
/// less than the real one. Whatever the real run delivered is possible, so the bound is never less than that.
fn throughput_bound(delivered: u64, unhindered: u64) -> u64 {
    unhindered.max(delivered)
}

fn report(setup: &Setup, seed: u64, o: &Outcome, wall: f64, bound: Option<u64>) -> Value {
    let deliveries = o.counts.robot_deliveries;
    let met = &o.people.figures;
    json!({
        "scenario": setup.scenario.site.name,
        "seed": seed,
        "robots": setup.scenario.robots,
        "workers": setup.scenario.workers.all(),
        "sim_seconds": o.simulated.as_secs_f64(),
        "wall_seconds": wall,
        "robot_deliveries": deliveries,
        "human_deliveries": o.counts.human_deliveries,
        "throughput_bound": bound,
        "throughput_bound_ratio": bound.map(|b| deliveries as f64 / b.max(1) as f64),
        "encounters": met.encounters,
        "encounters_recorded": o.counts.encounters,
        "closest_m": met.closest_m,
        "contacts": met.contacts,
        "encounters_within": rings::of_run(met),
        "driven_m": met.driven_m,
        "worker_minutes": met.worker_time.as_secs_f64() / 60.0,
        "interruptions": o.counts.interruptions,
        "deviations": o.counts.deviations,
        "replans": o.counts.replans,
        "zones": { "keep": o.counts.zones.keep, "slow": o.counts.zones.slow, "change": o.counts.zones.change },
        "plan_us": quantiles(&o.plan_ns),
        "plan_failures": o.counts.plan_failures,
        "insertions": insertions(&o.counts.insertions),
        "filter_nees": nees(&o.people.consistency),
        "step_us": quantiles(&o.step_ns),
        "jobs": o.jobs.iter().map(|(kind, t)| (kind.to_string(), tally(t))).collect::<serde_json::Map<_, _>>(),
        "drained": o.drained,
        "drain_seconds": o.drained.map(|_| o.drain.as_secs_f64()),
        "law_violations": o.law_violations,
        "trace_hash": format!("{:016x}", o.trace_hash),
    })
}

/// Counts of routes that were inserted by moving other robots.
fn insertions(counts: &InsertionCounts) -> Value {
    json!({
        "tried": counts.tried,
        "succeeded": counts.succeeded,
        "only_way": counts.only_way,
        "gain_s": counts.gain.as_secs_f64(),
    })
}

/// Whether the error estimates of the motion filter for people are consistent; null if no person was seen.
fn nees(c: &Consistency) -> Value {
    let figures = |n: &NeesFigures| {
        json!({
            "degrees_of_freedom": n.freedom,
            "samples": n.samples,
            "mean": n.mean,
            "mean_bounds_95": n.mean_bounds,
            "within_95": n.within,
        })
    };
    let [place, motion] = c.figures();
    json!({ "place": place.as_ref().map(figures), "place_and_velocity": motion.as_ref().map(figures) })
}

/// How the jobs of one kind ended.
pub fn tally(t: &JobTally) -> Value {
    json!({
        "accepted": t.accepted,
        "done": t.done,
        "failed": t.failed,
        "cancelled": t.cancelled,
        "open_at_end": t.open_at_end,
    })
}

/// Quantiles of durations in ascending order: input nanoseconds, output microseconds.
pub fn quantiles(ns: &[u64]) -> Value {
    let at = |q: f64| {
        ns.get(((ns.len() as f64 * q) as usize).min(ns.len().saturating_sub(1))).copied().unwrap_or(0)
    };
    let us = |v: u64| v as f64 / 1000.0;
    json!({"p50": us(at(0.5)), "p95": us(at(0.95)), "p99": us(at(0.99)), "max": us(at(1.0)), "count": ns.len()})
}

fn print_table(report: &Value) {
    let Some(rows) = report.as_object() else { return };
    for (key, value) in rows {
        match value {
            Value::Object(parts) => {
                let parts: Vec<String> = parts.iter().map(|(k, v)| format!("{k} {v}")).collect();
                println!("{key:24} {}", parts.join("  "));
            }
            _ => println!("{key:24} {value}"),
        }
    }
}

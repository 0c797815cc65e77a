//! `giveway experiment alarms`: which alarms follow from faults, how soon, and how many come without any.
//!
//! Main types: [`AlarmsArgs`]. Refuses: to measure; it runs `experiment::alarms` and prints.

use super::{in_parallel, read_map};
use crate::alarms::{AlarmTrial, HealthyFloor, InjectedFault, TrialRow};
use clap::Args;
use giveway_fleet::alarm::AlarmKind;
use giveway_floor::time::Span;
use giveway_floor::warehouse::thesis;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Number of robots on the floor where faults are injected.
const ROBOTS: usize = 20;

/// Arguments of `experiment alarms`.
#[derive(Args)]
pub struct AlarmsArgs {
    /// Trials of each kind of fault, one seed each.
    #[arg(long, default_value_t = 20)]
    runs: u64,
    /// The first seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How long each floor without faults is watched, seconds.
    #[arg(long, default_value_t = 3600.0)]
    healthy_s: f64,
    /// The file of the kiva floor.
    #[arg(long, default_value = "maps/kiva.json")]
    kiva_map: PathBuf,
    /// Runs at a time; as many as there are cores if absent.
    #[arg(long)]
    jobs: Option<usize>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Results of all trials of one fault.
struct FaultSummary {
    fault: InjectedFault,
    trials: usize,
    detected: usize,
    /// Delays, ascending, seconds.
    delays_s: Vec<f64>,
    alarms: usize,
    cleared: usize,
    others: BTreeMap<&'static str, usize>,
}

impl AlarmsArgs {
    /// Runs all and prints what was raised.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!(self.runs > 0, "--runs must be at least 1");
        anyhow::ensure!(
            self.healthy_s >= 1.0 && self.healthy_s <= 1e6,
            "--healthy-s must be from 1 to 1000000"
        );
        let faults = self.faults();
        let floors = self.healthy_floors()?;
        let raised = in_parallel(floors.len(), self.jobs, |i| floors[i].run(self.seed));
        if self.json {
            let faults: Vec<Value> = faults.iter().map(FaultSummary::report).collect();
            let healthy: Vec<Value> = floors.iter().zip(&raised).map(|(f, r)| healthy_report(f, r)).collect();
            let report = json!({"faults": faults, "healthy": healthy});
            println!("{}", serde_json::to_string_pretty(&report)?);
            return Ok(ExitCode::SUCCESS);
        }
        println!(
            "fault            alarm             trials  detected  delay p50   p95 s  alarms each  cleared"
        );
        faults.iter().for_each(FaultSummary::print);
        println!("\nwithout faults            robots  people   hours  alarms  an hour");
        for (floor, raised) in floors.iter().zip(&raised) {
            let hours = floor.seconds / 3600.0;
            let (n, rate) = (raised.len(), raised.len() as f64 / hours);
            println!("{:24}{:>8}{:>8}{hours:>8.2}{n:>8}{rate:>9.2}", floor.map, floor.robots, floor.workers);
        }
        Ok(ExitCode::SUCCESS)
    }

    fn faults(&self) -> Vec<FaultSummary> {
        let warehouse = Arc::new(thesis());
        let trial = |fault| AlarmTrial { warehouse: warehouse.clone(), robots: ROBOTS, fault };
        let trials = InjectedFault::ALL.map(trial);
        let runs = self.runs as usize;
        let rows = in_parallel(trials.len() * runs, self.jobs, |i| {
            trials[i / runs].run(self.seed + (i % runs) as u64)
        });
        let of_kind = trials.iter().zip(rows.chunks(runs));
        of_kind.map(|(trial, rows)| FaultSummary::of(trial.fault, rows.iter().flatten())).collect()
    }

    fn healthy_floors(&self) -> anyhow::Result<Vec<HealthyFloor>> {
        let (hall, kiva) = (Arc::new(thesis()), read_map(&self.kiva_map)?);
        let seconds = self.healthy_s;
        let of = |map: &str, warehouse, robots, workers| HealthyFloor {
            map: map.into(),
            warehouse,
            robots,
            workers,
            seconds,
        };
        let mut floors = vec![of("thesis", hall.clone(), 20, 0), of("thesis", hall, 20, 3)];
        floors.extend([50, 100, 200, 400, 800].map(|robots| of("kiva", kiva.clone(), robots, 0)));
        Ok(floors)
    }
}

impl FaultSummary {
    fn of<'a>(fault: InjectedFault, rows: impl Iterator<Item = &'a TrialRow>) -> FaultSummary {
        let (mut trials, mut alarms, mut cleared) = (0, 0, 0);
        let (mut delays_s, mut others) = (Vec::new(), BTreeMap::new());
        for row in rows {
            trials += 1;
            alarms += row.raised.len();
            cleared += usize::from(row.cleared);
            delays_s.extend(row.delay.map(Span::as_secs_f64));
            for kind in row.raised.iter().filter(|k| Some(**k) != fault.expected()) {
                *others.entry(kind.word()).or_default() += 1;
            }
        }
        delays_s.sort_unstable_by(f64::total_cmp);
        FaultSummary { fault, trials, detected: delays_s.len(), delays_s, alarms, cleared, others }
    }

    fn each(&self) -> f64 {
        self.alarms as f64 / self.trials.max(1) as f64
    }

    fn report(&self) -> Value {
        let share = |n: usize| n as f64 / self.trials.max(1) as f64;
        json!({
            "fault": self.fault.word(),
            "alarm": self.fault.expected().map(AlarmKind::word),
            "trials": self.trials,
            "detected_share": self.fault.expected().map(|_| share(self.detected)),
            "delay_s": { "p50": quantile(&self.delays_s, 0.5), "p95": quantile(&self.delays_s, 0.95) },
            "alarms_per_fault": self.each(),
            "cleared_share": share(self.cleared),
            "other_alarms": self.others,
        })
    }

    fn print(&self) {
        let expected = self.fault.expected().map_or("none", AlarmKind::word);
        let delay = |q| quantile(&self.delays_s, q).map_or("–".to_owned(), |s| format!("{s:.1}"));
        let others: Vec<String> = self.others.iter().map(|(kind, n)| format!("{n} {kind}")).collect();
        println!(
            "{:17}{expected:17}{:>7}{:>10}{:>11}{:>8}{:>13.2}{:>9}  {}",
            self.fault.word(),
            self.trials,
            self.detected,
            delay(0.5),
            delay(0.95),
            self.each(),
            self.cleared,
            others.join(", ")
        );
    }
}

fn healthy_report(floor: &HealthyFloor, raised: &[AlarmKind]) -> Value {
    let hours = floor.seconds / 3600.0;
    let mut kinds = BTreeMap::new();
    raised.iter().for_each(|kind| *kinds.entry(kind.word()).or_insert(0) += 1);
    json!({
        "map": floor.map, "robots": floor.robots, "workers": floor.workers, "hours": hours,
        "false_alarms_per_hour": raised.len() as f64 / hours, "alarms": kinds,
    })
}

/// The value below which this share of ascending values lies.
fn quantile(ascending: &[f64], q: f64) -> Option<f64> {
    let at = (ascending.len() as f64 * q) as usize;
    ascending.get(at.min(ascending.len().saturating_sub(1))).copied()
}

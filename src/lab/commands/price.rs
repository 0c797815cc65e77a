//! `giveway experiment price`: what people cost robots, and robots people.
//!
//! Main types: [`PriceArgs`]. Refuses: to measure; it runs `experiment::price` and prints.

use super::people::{ArmArgument, CausesArgument, exit, run_all, violations};
use super::{read_map, rings};
use crate::price::{PriceFloor, Shares};
use crate::robot_time::{RobotTime, TimeUse};
use crate::statistics::Interval;
use crate::table::{ENTER_S, RunRow, TableSetup};
use clap::{Args, ValueEnum};
use giveway_floor::warehouse::{room_for, thesis};
use giveway_people::aware::{HumanAwarePolicy, NodeWindows};
use giveway_sim::{CalmFigures, EncounterFigures};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// A floor, on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FloorArgument {
    /// The hall of the thesis: 20 robots, one, three and five workers.
    Thesis,
    /// A kiva floor: 200 robots, five and twenty workers.
    Kiva,
}

/// Arguments of `experiment price`.
#[derive(Args)]
pub struct PriceArgs {
    /// Seeds for each floor and number of workers.
    #[arg(long, default_value_t = 10)]
    runs: u64,
    /// The first seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How long each run is, seconds; workers come in after 250 seconds.
    #[arg(long, default_value_t = 750.0)]
    seconds: f64,
    /// Floors.
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["thesis", "kiva"])]
    floors: Vec<FloorArgument>,
    /// The file of the kiva floor.
    #[arg(long, default_value = "maps/kiva.json")]
    kiva_map: PathBuf,
    /// Policies.
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["giveway"])]
    policies: Vec<ArmArgument>,
    /// Why workers leave their paths besides the six departures of the published experiment.
    #[arg(long, value_enum, default_value = "all")]
    causes: CausesArgument,
    /// How the fleet finds out when workers take a node.
    #[arg(long, value_enum, default_value = "speeds")]
    node_windows: NodeWindowsArgument,
    /// Runs at a time; as many as there are cores if absent.
    #[arg(long)]
    jobs: Option<usize>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Windows of nodes, on the command line.
#[derive(Clone, Copy, ValueEnum)]
enum NodeWindowsArgument {
    /// From a fast walker's coming to a slow one's going.
    Speeds,
    /// By the calibrated forecast.
    Mixture,
}

impl From<NodeWindowsArgument> for NodeWindows {
    fn from(argument: NodeWindowsArgument) -> NodeWindows {
        match argument {
            NodeWindowsArgument::Speeds => NodeWindows::Speeds,
            NodeWindowsArgument::Mixture => NodeWindows::Mixture,
        }
    }
}

/// Results for one number of workers on a floor, with one policy.
struct PriceRow<'a> {
    workers: usize,
    policy: HumanAwarePolicy,
    shares: Shares,
    both: &'a [RunRow],
    /// Runs of the same seeds without workers.
    alone: &'a [RunRow],
}

/// Rates of calm guidance, per minute of a worker on the floor.
struct CalmRates {
    /// Messages that replaced another one, per minute.
    changes: f64,
    /// Messages to stop, per minute.
    stops: f64,
    /// Share of the time in which a worker was told to stop for a robot that waited for that worker.
    against: f64,
}

impl PriceArgs {
    /// Runs all and prints the shares.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!(self.runs > 0, "--runs must be at least 1");
        anyhow::ensure!(
            self.seconds > ENTER_S && self.seconds <= 1e6,
            "--seconds must be above {ENTER_S}, when workers come in, and at most 1000000"
        );
        let floors = self.floors.iter().map(|f| self.floor(*f)).collect::<anyhow::Result<Vec<_>>>()?;
        let policies: Vec<HumanAwarePolicy> = self.policies.iter().map(|a| a.arm()).collect();
        let (mut broken, mut reports) = (0, Vec::new());
        for floor in &floors {
            let rows = run_all(&self.cases(floor, &policies), self.runs, self.seed, self.jobs);
            broken += violations(rows.iter().flatten());
            let rows = price_rows(floor, &policies, &rows);
            if self.json {
                let rows: Vec<Value> = rows.iter().map(PriceRow::report).collect();
                reports.push(json!({"map": floor.map, "robots": floor.robots, "rows": rows}));
            } else {
                self.print(floor, &rows);
            }
        }
        if self.json {
            let report = json!({"floors": reports, "law_violations": broken});
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            println!("broken laws: {broken}");
        }
        Ok(exit(broken))
    }

    fn floor(&self, floor: FloorArgument) -> anyhow::Result<PriceFloor> {
        let (map, warehouse, robots, workers) = match floor {
            FloorArgument::Thesis => ("thesis", Arc::new(thesis()), 20, vec![1, 3, 5]),
            FloorArgument::Kiva => ("kiva", read_map(&self.kiva_map)?, 200, vec![5, 20]),
        };
        room_for(&warehouse, robots)
            .map_err(|e| anyhow::anyhow!("the map has no room for {robots} robots:\n{e}"))?;
        Ok(PriceFloor { map: map.to_owned(), warehouse, robots, workers })
    }

    /// The cases: the robots alone; then for each number of workers, the workers alone and both with each policy.
    fn cases(
        &self,
        floor: &PriceFloor,
        policies: &[HumanAwarePolicy],
    ) -> Vec<(TableSetup, HumanAwarePolicy)> {
        let setup = |robots, workers| TableSetup {
            node_windows: self.node_windows.into(),
            ..floor.setup(robots, workers, self.seconds, self.causes.causes())
        };
        let mut cases = vec![(setup(floor.robots, 0), HumanAwarePolicy::Giveway)];
        for workers in &floor.workers {
            cases.push((setup(0, *workers), HumanAwarePolicy::Giveway));
            cases.extend(policies.iter().map(|p| (setup(floor.robots, *workers), *p)));
        }
        cases
    }

    fn print(&self, floor: &PriceFloor, rows: &[PriceRow<'_>]) {
        let PriceArgs { runs, seconds, .. } = self;
        println!("{}: {} robots, {runs} runs of {seconds} s: share [95 % interval]", floor.map, floor.robots);
        println!(
            "workers  policy        robot_share            human_share            standstills  messages/min  \
             stops/min  against"
        );
        for row in rows {
            println!(
                "{:>7}  {:10}{}{}{:>10}{:>14.2}{:>11.2}{:>9.4}",
                row.workers,
                row.policy.word(),
                cell(row.shares.robot_share),
                cell(row.shares.human_share),
                row.standstills(),
                row.calm().changes,
                row.calm().stops,
                row.calm().against
            );
        }
        let curves: Vec<(String, Vec<&EncounterFigures>)> = rows
            .iter()
            .map(|row| (format!("{} workers, {}", row.workers, row.policy.word()), row.met()))
            .collect();
        let curves: Vec<_> = curves.iter().map(|(name, met)| (name.as_str(), met.clone())).collect();
        rings::print(&curves);
        print_times(rows);
        println!();
    }
}

/// The shares of each number of workers and policy, in the order of [`PriceArgs::cases`].
fn price_rows<'a>(
    floor: &PriceFloor,
    policies: &[HumanAwarePolicy],
    rows: &'a [Vec<RunRow>],
) -> Vec<PriceRow<'a>> {
    let (robots, rest) = rows.split_first().expect("the robots alone are the first case");
    let of_workers = floor.workers.iter().zip(rest.chunks(1 + policies.len()));
    let of_policy = of_workers.flat_map(|(workers, rows)| {
        policies.iter().zip(&rows[1..]).map(|(policy, both)| PriceRow {
            workers: *workers,
            policy: *policy,
            shares: Shares::of(both, robots, &rows[0]),
            both,
            alone: robots,
        })
    });
    of_policy.collect()
}

impl PriceRow<'_> {
    fn standstills(&self) -> u64 {
        self.both.iter().map(|row| row.standstills).sum()
    }

    /// Rates of calm guidance, per minute of a worker on the floor.
    fn calm(&self) -> CalmRates {
        let minutes: f64 = self.both.iter().map(|row| row.calm.1).sum();
        let sum = |of: fn(&CalmFigures) -> f64| self.both.iter().map(|row| of(&row.calm.0)).sum::<f64>();
        let per = |of: fn(&CalmFigures) -> f64| if minutes > 0.0 { sum(of) / minutes } else { 0.0 };
        CalmRates {
            changes: per(|c| c.changes as f64),
            stops: per(|c| c.stops as f64),
            against: per(|c| c.against.as_secs_f64() / 60.0),
        }
    }

    fn met(&self) -> Vec<&EncounterFigures> {
        self.both.iter().map(|row| &row.met).collect()
    }

    fn report(&self) -> Value {
        json!({
            "workers": self.workers,
            "policy": self.policy.word(),
            "robot_share": rings::interval(self.shares.robot_share),
            "human_share": rings::interval(self.shares.human_share),
            "standstills": self.standstills(),
            "messages_per_worker_minute": self.calm().changes,
            "stops_per_worker_minute": self.calm().stops,
            "stopped_for_a_waiting_robot_share": self.calm().against,
            "robot_time": {"beside": time_report(self.both), "alone": time_report(self.alone)},
            "encounters": rings::of_runs(&self.met()),
        })
    }
}

/// Shares of the robots' time by use, over all runs of a row.
fn time_report(rows: &[RunRow]) -> Value {
    let time = RobotTime::of_runs(rows.iter().map(|row| &row.robot_time));
    let shares: Value =
        TimeUse::ALL.into_iter().map(|u| (u.word().to_owned(), json!(time.share(u)))).collect();
    json!({"shares": shares, "mean_mps": time.mean_mps()})
}

/// Prints these shares as a table, with a column for the robots alone.
fn print_times(rows: &[PriceRow<'_>]) {
    let Some(first) = rows.first() else { return };
    let of = |rows: &[RunRow]| RobotTime::of_runs(rows.iter().map(|row| &row.robot_time));
    let mut columns = vec![("robots alone".to_owned(), of(first.alone))];
    columns.extend(rows.iter().map(|r| (format!("{} {}", r.workers, r.policy.word()), of(r.both))));
    print!("{:<28}", "share of the robots' time");
    columns.iter().for_each(|(name, _)| print!("{name:>14}"));
    println!();
    for time_use in TimeUse::ALL {
        print!("{:<28}", time_use.word());
        columns.iter().for_each(|(_, t)| print!("{:>14.3}", t.share(time_use).unwrap_or(f64::NAN)));
        println!();
    }
    print!("{:<28}", "metres a second, driving");
    columns.iter().for_each(|(_, t)| print!("{:>14.3}", t.mean_mps().unwrap_or(f64::NAN)));
    println!();
}

fn cell(share: Interval) -> String {
    let (low, high) = share.ci95.unwrap_or((f64::NAN, f64::NAN));
    format!("{:>8.2} [{low:.2}, {high:.2}]", share.mean.unwrap_or(f64::NAN))
}

//! `giveway experiment stations`: what picking stations gain by knowing lines and hands.
//!
//! Main type: [`StationsArgs`]. Refuses: to measure; it runs `experiment::stations` and prints.

use super::in_parallel;
use super::people::exit;
use crate::stations::{StationsRow, StationsSetup};
use crate::statistics::{Interval, Summary};
use clap::Args;
use giveway::cli::files::read_pick_model;
use giveway::cli::sim::Setup;
use giveway_cell::Flow;
use giveway_cell::arm::ArmMode;
use giveway_floor::time::Span;
use giveway_floor::warehouse::room_for;
use giveway_sim::Scenario;
use giveway_sim::picker::WarnedLead;
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// The shipped scenario, used if none is named.
const SHIPPED: &str = include_str!("../../../scenarios/stations.json");
/// Numbers of robots if no scenario is named.
const ROBOTS: [usize; 3] = [14, 18, 24];
/// The flows in order, each with the flow that it is compared with.
const FLOWS: [(Flow, &str); 5] = [
    (Flow::Usual, "usual"),
    (Flow::Counted, "counted"),
    (Flow::Hand, "hand"),
    (Flow::Seen, "seen"),
    (Flow::Known, "known"),
];
const PAIRS: [(&str, &str); 5] =
    [("seen", "usual"), ("counted", "usual"), ("hand", "counted"), ("seen", "hand"), ("known", "seen")];

/// Modes of robot arms, each with the one that it is compared with; `none` is the flow `seen` without an arm.
const ARM_MODES: [(ArmMode, &str); 3] =
    [(ArmMode::Turns, "turns"), (ArmMode::Reactive, "reactive"), (ArmMode::Predictive, "predictive")];
const ARM_PAIRS: [(&str, &str); 4] =
    [("turns", "none"), ("reactive", "none"), ("predictive", "none"), ("predictive", "reactive")];

/// Arguments of `experiment stations`.
#[derive(Args)]
pub struct StationsArgs {
    /// Scenario file with `cells`; the shipped one, with 14, 18 and 24 robots, if absent.
    #[arg(long)]
    scenario: Option<PathBuf>,
    /// Seeds.
    #[arg(long, default_value_t = 20)]
    runs: u64,
    /// The first seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How long each run is, seconds; as long as the scenario says if absent.
    #[arg(long)]
    seconds: Option<f64>,
    /// Numbers of robots, instead of the scenario's.
    #[arg(long, value_delimiter = ',')]
    robots: Vec<usize>,
    /// Compare the modes of robot arms only, not the flows.
    #[arg(long)]
    arms: bool,
    /// Runs at a time; as many as there are cores if absent.
    #[arg(long)]
    jobs: Option<usize>,
    /// What was learned of pickers (`giveway learn picks`); the built-in figures if absent.
    #[arg(long)]
    pick_model: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl StationsArgs {
    /// Runs all and prints the figures.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        anyhow::ensure!(self.runs > 0, "--runs must be at least 1");
        let setup = self.setup()?;
        let robots = match (self.robots.is_empty(), &self.scenario) {
            (false, _) => self.robots.clone(),
            (true, Some(_)) => vec![setup.scenario.robots],
            (true, None) => ROBOTS.to_vec(),
        };
        for n in &robots {
            room_for(&setup.warehouse, *n)
                .map_err(|e| anyhow::anyhow!("the map has no room for {n} robots:\n{e}"))?;
        }
        let flows: Vec<Flow> = match self.arms {
            true => vec![Flow::Seen],
            false => FLOWS.iter().map(|f| f.0).collect(),
        };
        let modes = if setup.stations_with_arm().is_empty() { &[][..] } else { &ARM_MODES[..] };
        let (runs, kinds) = (self.runs as usize, flows.len() + modes.len());
        let rows = in_parallel(robots.len() * kinds * runs, self.jobs, |i| {
            let (robots, kind) = (robots[i / (kinds * runs)], i / runs % kinds);
            let seed = self.seed + (i % runs) as u64;
            match flows.get(kind) {
                Some(flow) => setup.run(robots, *flow, seed),
                None => setup.run_with_arms(robots, modes[kind - flows.len()].0, seed),
            }
        });
        let broken: u64 = rows.iter().map(|r| r.law_violations).sum();
        rows.iter().flat_map(|r| &r.broken).for_each(|b| eprintln!("broken law at {b}"));
        let scenarios: Vec<Value> = (robots.iter().zip(rows.chunks(kinds * runs)))
            .map(|(robots, rows)| {
                let rows: Vec<&[StationsRow]> = rows.chunks(runs).collect();
                let (of_flows, of_arms) = rows.split_at(flows.len());
                let mut said =
                    if self.arms { json!({"robots": robots}) } else { scenario(*robots, of_flows) };
                if !of_arms.is_empty() {
                    let seen = flows.iter().position(|f| *f == Flow::Seen).expect("it is a flow");
                    said["with_arm"] = with_arm(of_flows[seen], of_arms);
                }
                said
            })
            .collect();
        if self.json {
            let report = json!({"scenarios": scenarios, "law_violations": broken});
            println!("{}", serde_json::to_string_pretty(&report)?);
        } else {
            scenarios.iter().for_each(print);
            println!("broken laws: {broken}");
        }
        Ok(exit(broken))
    }

    fn setup(&self) -> anyhow::Result<StationsSetup> {
        let mut setup = match &self.scenario {
            Some(path) => {
                let Setup { scenario, warehouse, .. } = Setup::read(path, None, None)?;
                anyhow::ensure!(scenario.cells.is_some(), "{} has no `cells`", path.display());
                StationsSetup { warehouse, scenario }
            }
            None => {
                let warehouse = Arc::new(giveway_floor::warehouse::stations());
                StationsSetup { warehouse, scenario: Scenario::parse(SHIPPED)? }
            }
        };
        if let Some(path) = &self.pick_model {
            setup.scenario.site.picks = read_pick_model(path)?;
        }
        if let Some(seconds) = self.seconds {
            anyhow::ensure!((60.0..=1e6).contains(&seconds), "--seconds must be from 60 to 1000000");
            setup.scenario.duration = Span::from_secs_f64(seconds);
        }
        Ok(setup)
    }
}

fn scenario(robots: usize, flows: &[&[StationsRow]]) -> Value {
    let of = |name: &str| flows[FLOWS.iter().position(|f| f.1 == name).expect("it is a flow")];
    let arms: Map<String, Value> =
        FLOWS.iter().zip(flows).map(|((_, name), rows)| ((*name).to_owned(), arm(rows))).collect();
    let paired: Map<String, Value> = (PAIRS.iter())
        .map(|(one, other)| {
            let relative = of(one).iter().zip(of(other)).map(|(a, b)| rate(a) / rate(b).max(1e-9) - 1.0);
            let interval = Interval::of(&relative.collect::<Vec<_>>());
            let ci95 = interval.ci95.map(|(low, high)| [low, high]);
            (format!("{one}-{other}"), json!({"relative": {"mean": interval.mean, "ci95": ci95}}))
        })
        .collect();
    json!({"robots": robots, "arms": arms, "paired": paired})
}

/// Figures of the arms in each mode, beside the same hours without one.
fn with_arm(without: &[StationsRow], modes: &[&[StationsRow]]) -> Value {
    let all =
        || std::iter::once(("none", without)).chain(ARM_MODES.iter().map(|m| m.1).zip(modes.iter().copied()));
    let mut said: Map<String, Value> = all().map(|(name, rows)| (name.to_owned(), mode(rows))).collect();
    let relative = |one: &[StationsRow], other: &[StationsRow]| {
        let gains = one.iter().zip(other).map(|(a, b)| rate_at_arms(a) / rate_at_arms(b).max(1e-9) - 1.0);
        let interval = Interval::of(&gains.collect::<Vec<_>>());
        json!({"relative": {"mean": interval.mean, "ci95": interval.ci95.map(|(low, high)| [low, high])}})
    };
    let of = |name: &str| all().find(|(n, _)| *n == name).expect("it is a mode").1;
    let paired: Map<String, Value> = ARM_PAIRS
        .iter()
        .map(|(one, other)| (format!("{one}-{other}"), relative(of(one), of(other))))
        .collect();
    said.insert("paired".to_owned(), Value::Object(paired));
    Value::Object(said)
}

fn mode(rows: &[StationsRow]) -> Value {
    let hours: f64 = rows.iter().map(|r| r.hours).sum();
    let per_hour = |of: fn(&StationsRow) -> f64| rows.iter().map(of).sum::<f64>() / hours;
    let summary = |of: fn(&StationsRow) -> f64| {
        let summary = Summary::of(&rows.iter().map(of).collect::<Vec<_>>());
        json!({"mean": summary.mean, "sd": summary.sd})
    };
    json!({
        "lines_per_hour": summary(rate),
        "lines_per_hour_at_arms": summary(rate_at_arms),
        "pieces_per_hour": per_hour(|r| r.arms.pieces as f64),
        "protective_stops_per_hour": per_hour(|r| r.arms.stops as f64),
        "contacts": rows.iter().map(|r| r.arms.contacts).sum::<u64>(),
        "touched_per_hour": per_hour(|r| r.arms.touched as f64),
        "picker_waits_s_per_hour": per_hour(|r| r.arms.person_waits_s),
    })
}

fn rate_at_arms(row: &StationsRow) -> f64 {
    row.arms.lines as f64 / row.hours
}

/// Lines per hour.
fn rate(row: &StationsRow) -> f64 {
    row.lines as f64 / row.hours
}

fn arm(rows: &[StationsRow]) -> Value {
    let sum = |of: fn(&StationsRow) -> u64| rows.iter().map(of).sum::<u64>();
    let mean = |of: fn(&StationsRow) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
    let share = |n: u64, of: u64| (of > 0).then(|| n as f64 / of as f64);
    let lines = Summary::of(&rows.iter().map(rate).collect::<Vec<_>>());
    let (all, visits) = (sum(|r| r.lines), sum(|r| r.visits));
    let per_1000 = |n: u64, of: u64| 1000.0 * n as f64 / of.max(1) as f64;
    let lead_p50 = |of: fn(&WarnedLead) -> f64| {
        let mut leads: Vec<f64> = rows.iter().flat_map(|r| r.warned_leads.iter().map(of)).collect();
        leads.sort_by(f64::total_cmp);
        leads.get(leads.len() / 2).copied()
    };
    json!({
        "lines_per_hour": {"mean": lines.mean, "sd": lines.sd},
        "visits": visits,
        "picker_idle": mean(|r| r.picker_idle),
        "robot_wait_s": mean(|r| r.robot_wait_s),
        "wrong": sum(|r| r.wrong),
        "wrong_warned": share(sum(|r| r.wrong_warned), sum(|r| r.wrong)),
        "warned_lead_s": {"p50": lead_p50(|l| l.face_s), "to_piece_p50": lead_p50(|l| l.piece_s)},
        "wrong_totes": sum(|r| r.wrong_totes),
        "wrong_totes_warned": share(sum(|r| r.wrong_totes_warned), sum(|r| r.wrong_totes)),
        "wrong_confirmed_per_1000": per_1000(sum(|r| r.wrong_confirmed), all),
        "wrong_by_hand_per_1000": per_1000(sum(|r| r.wrong_by_hand), all),
        "false_warnings_per_1000": per_1000(sum(|r| r.false_warnings), all),
        "dismissed_early_per_1000": per_1000(sum(|r| r.dismissed_early), visits),
        "guard_stops_per_1000": per_1000(sum(|r| r.guard_stops), visits),
        "presses_per_1000": per_1000(sum(|r| r.presses), all),
        "end_cov80": share(sum(|r| r.ends_held), sum(|r| r.ends)),
    })
}

fn print(scenario: &Value) {
    println!("{} robots", scenario["robots"]);
    if scenario.get("arms").is_some() {
        print_flows(scenario);
    }
    if let Some(with_arm) = scenario.get("with_arm") {
        print_arms(with_arm);
    }
}

fn print_arms(with_arm: &Value) {
    println!(
        "{:10} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8}",
        "arm", "lines/h", "at arms", "pieces/h", "stops/h", "contacts", "touched", "waits, s"
    );
    let n = |v: &Value| v.as_f64().map_or("–".to_owned(), |x| format!("{x:.1}"));
    for name in std::iter::once("none").chain(ARM_MODES.map(|m| m.1)) {
        let a = &with_arm[name];
        println!(
            "{:10} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8}",
            name,
            n(&a["lines_per_hour"]["mean"]),
            n(&a["lines_per_hour_at_arms"]["mean"]),
            n(&a["pieces_per_hour"]),
            n(&a["protective_stops_per_hour"]),
            a["contacts"],
            n(&a["touched_per_hour"]),
            n(&a["picker_waits_s_per_hour"]),
        );
    }
    print_pairs(&with_arm["paired"], &ARM_PAIRS);
}

fn print_flows(scenario: &Value) {
    println!(
        "{:8} {:>9} {:>6} {:>8} {:>6} {:>7} {:>6} {:>10} {:>9} {:>9} {:>8} {:>6}",
        "flow",
        "lines/h",
        "idle",
        "wait, s",
        "wrong",
        "warned",
        "lead",
        "confirmed",
        "false",
        "early",
        "presses",
        "cov80"
    );
    let n = |v: &Value, digits: usize| v.as_f64().map_or("–".to_owned(), |x| format!("{x:.digits$}"));
    for (_, name) in FLOWS {
        let a = &scenario["arms"][name];
        println!(
            "{:8} {:>9} {:>6} {:>8} {:>6} {:>7} {:>6} {:>10} {:>9} {:>9} {:>8} {:>6}",
            name,
            n(&a["lines_per_hour"]["mean"], 1),
            n(&a["picker_idle"], 3),
            n(&a["robot_wait_s"], 1),
            n(&a["wrong"], 0),
            n(&a["wrong_warned"], 2),
            n(&a["warned_lead_s"]["p50"], 2),
            n(&a["wrong_confirmed_per_1000"], 2),
            n(&a["false_warnings_per_1000"], 2),
            n(&a["dismissed_early_per_1000"], 2),
            n(&a["presses_per_1000"], 0),
            n(&a["end_cov80"], 3),
        );
    }
    print_pairs(&scenario["paired"], &PAIRS);
}

fn print_pairs(paired: &Value, pairs: &[(&str, &str)]) {
    let n = |v: &Value| v.as_f64().map_or("–".to_owned(), |x| format!("{x:.4}"));
    for (one, other) in pairs {
        let relative = &paired[format!("{one}-{other}")]["relative"];
        let (low, high) = (&relative["ci95"][0], &relative["ci95"][1]);
        println!("{one} - {other}: {} ({} to {})", n(&relative["mean"]), n(low), n(high));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_has_every_key_that_other_programs_read() {
        let row = StationsRow { hours: 1.0, lines: 100, visits: 30, wrong: 2, ..StationsRow::default() };
        let rows = [row.clone(), row];
        let report = scenario(24, &[rows.as_slice(); 5]);
        let arms = report["arms"].as_object().expect("one of each flow");
        assert!(["usual", "counted", "hand", "seen", "known"].iter().all(|flow| arms.contains_key(*flow)));
        let keys = [
            "lines_per_hour",
            "picker_idle",
            "robot_wait_s",
            "wrong",
            "wrong_warned",
            "warned_lead_s",
            "wrong_confirmed_per_1000",
            "false_warnings_per_1000",
            "dismissed_early_per_1000",
            "end_cov80",
        ];
        let missing = keys.into_iter().filter(|key| arms["seen"].get(key).is_none());
        assert_eq!(missing.collect::<Vec<_>>(), [""; 0]);
        for pair in ["seen-usual", "counted-usual", "hand-counted", "seen-hand", "known-seen"] {
            let relative = &report["paired"][pair]["relative"];
            assert_eq!(
                (&relative["mean"], relative["ci95"].as_array().map(Vec::len)),
                (&json!(0.0), Some(2))
            );
        }
        let with_arm = with_arm(&rows, &[rows.as_slice(); 3]);
        for mode in ["turns", "reactive", "predictive"] {
            assert!(with_arm[mode]["protective_stops_per_hour"].is_number(), "{with_arm}");
            assert_eq!(with_arm[mode]["contacts"], 0);
        }
    }
}

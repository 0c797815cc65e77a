//! `giveway bench memory`: whether memory stays flat while days go by.
//!
//! Main type: [`MemoryArgs`]. Refuses: to print a figure without the command that made it.

use super::{progress, read_map};
use crate::month::{Day, run};
use clap::Args;
use giveway_floor::warehouse::room_for;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Arguments of `bench memory`.
#[derive(Args)]
pub struct MemoryArgs {
    /// Map.
    #[arg(long, default_value = "maps/lab.json")]
    map: PathBuf,
    /// How many robots.
    #[arg(long, default_value_t = 4)]
    robots: usize,
    /// How many simulated days.
    #[arg(long, default_value_t = 30)]
    days: u64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Columns of a row with their names.
const COLUMNS: [(&str, &str); 10] = [
    ("day", "day"),
    ("memory kB", "memory_kb"),
    ("jobs", "accepted"),
    ("done", "done"),
    ("open", "open_jobs"),
    ("bad ends", "bad_ends"),
    ("keys", "keys"),
    ("assignments", "assignments"),
    ("closures", "closures"),
    ("kept", "kept_closures"),
];

impl MemoryArgs {
    /// Simulates the days and prints a row for each.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let warehouse = Arc::new(read_map(&self.map)?);
        room_for(&warehouse, self.robots).map_err(|e| anyhow::anyhow!("{}:\n{e}", self.map.display()))?;
        anyhow::ensure!(self.robots > 0 && self.days > 0, "--robots and --days must be at least 1");
        let (map, robots, days) = (self.map.display(), self.robots, self.days);
        let command = format!("giveway bench memory --map {map} --robots {robots} --days {days}");
        let bar = progress(days, "days");
        let mut rows: Vec<Value> = Vec::new();
        run(&warehouse, robots, days, |day| {
            rows.push(row(day));
            bar.inc(1);
        });
        bar.finish_and_clear();
        if self.json {
            println!("{}", serde_json::to_string_pretty(&json!({"command": command, "days": rows}))?);
            return Ok(ExitCode::SUCCESS);
        }
        println!("{command}");
        println!("{}", COLUMNS.map(|(title, _)| format!("{title:>11}")).join(" "));
        for row in &rows {
            println!("{}", COLUMNS.map(|(_, key)| format!("{:>11}", row[key].to_string())).join(" "));
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn row(day: &Day) -> Value {
    json!({
        "day": day.day, "memory_kb": resident_kb(), "accepted": day.jobs[0], "done": day.jobs[1],
        "assignments": day.assignments, "closures": day.closures, "open_jobs": day.open_jobs,
        "open_assignments": day.open_assignments, "kept_closures": day.kept_closures, "bad_ends": day.bad_ends,
        "keys": day.keys,
    })
}

/// Memory of the process, as the kernel reports it; nothing if it does not.
fn resident_kb() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

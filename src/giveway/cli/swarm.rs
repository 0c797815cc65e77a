//! `giveway swarm`: runs floors drawn from seeds under all laws; failures are shrunk and printed as commands.
//!
//! Main types: [`SwarmArgs`], [`SwarmReport`]. Seeds are spread over threads; the output does not depend on their
//! number. Refuses: to end the sweep when a step panics, and to exit with success if a run failed.

use super::files::{read_map, write};
use super::progress::progress;
use clap::Args;
use giveway_drive::PLANTED;
use giveway_sim::Simulation;
use giveway_sim::swarm::{
    HEALS_WITHIN, Shrunk, SwarmCase, SwarmFailure, SwarmMap, SwarmPart, SwarmRun, SwarmSetup, SwarmTally,
    shrink,
};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// The most runs for shrinking one failure.
const SHRINK_RUNS: usize = 80;

thread_local! {
    /// The last panic on this thread: its place in the sources, and its message.
    static PANIC: RefCell<Option<(String, String)>> = const { RefCell::new(None) };
}

/// Arguments of `swarm`.
#[derive(Args)]
pub struct SwarmArgs {
    /// Seeds: one, or the first and the last, as in 1..200.
    #[arg(long, value_name = "A..B", value_parser = seeds)]
    seeds: (u64, u64),
    /// How long faults last in each run, minutes. After that, all jobs must come to an end.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    minutes: u32,
    /// `random` for random halls only, or a map file; if absent, drawn from random halls and the maps that ship.
    #[arg(long, value_name = "random|FILE")]
    map: Option<String>,
    /// Number of robots, fewer on maps without enough room; drawn if absent.
    #[arg(long)]
    robots: Option<usize>,
    /// Number of people; drawn if absent.
    #[arg(long)]
    workers: Option<usize>,
    /// What to switch off: restart, panic, journal_refuses, journal_slow, journal_torn, clock_steps, links, loss,
    /// delay, jitter, skew, failures, estops, obstacles, manual, unplugged, chargers, stations, pushes, closures,
    /// returns, relocations, charges, parks, goes, wishes, cancels, picks, stops, reassigned, trades, holds,
    /// departures, sensors, causes, fleet, abilities.
    #[arg(long, value_delimiter = ',', value_parser = part)]
    without: Vec<SwarmPart>,
    /// Number of threads; the number of the machine's cores if absent.
    #[arg(long)]
    threads: Option<usize>,
    /// Write each failure into this folder, as a file with its shrunk command; the tests run the files in tests/seeds
    /// until they pass.
    #[arg(long, value_name = "FOLDER")]
    keep: Option<PathBuf>,
    /// Do not shrink failures.
    #[arg(long)]
    no_shrink: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

fn seeds(text: &str) -> Result<(u64, u64), String> {
    let number = |t: &str| t.parse::<u64>().map_err(|e| format!("{t:?}: {e}"));
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    let (first, last) = (number(first)?, number(last)?);
    if first <= last && last - first < 10_000_000 {
        Ok((first, last))
    } else {
        Err("from a seed up to one that is no smaller, ten million seeds at most".into())
    }
}

fn part(word: &str) -> Result<SwarmPart, String> {
    let words = || SwarmPart::ALL.iter().map(|p| p.word()).collect::<Vec<_>>().join(", ");
    SwarmPart::of_word(word).ok_or_else(|| format!("must be one of {}", words()))
}

/// A case that failed.
struct SwarmFinding {
    seed: u64,
    /// How the whole case failed.
    failure: SwarmFailure,
    /// The smallest case found that fails in the same way.
    shrunk: Shrunk,
}

/// The results of a sweep.
#[derive(Default)]
struct SwarmReport {
    tally: SwarmTally,
    findings: Vec<SwarmFinding>,
}

/// A change to a simulation before each step: none, except in tests.
type Meddling = fn(&mut Simulation);

impl SwarmArgs {
    /// Runs all seeds and prints the results.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let case = self.case()?;
        SwarmSetup::draw(&case).map_err(|e| anyhow::anyhow!("{case} cannot be run:\n{e}"))?;
        let threads = self.threads.or_else(|| std::thread::available_parallelism().ok().map(usize::from));
        let most = if self.no_shrink { 0 } else { SHRINK_RUNS };
        let report = sweep(&case, self.seeds, threads.unwrap_or(1).clamp(1, 256), most, |_| {})?;
        if let Some(folder) = &self.keep {
            report.findings.iter().try_for_each(|finding| keep(folder, finding))?;
        }
        if self.json {
            println!("{}", serde_json::to_string_pretty(&report.json())?);
        } else {
            report.print();
        }
        Ok(if report.findings.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    /// The case of the first seed.
    fn case(&self) -> anyhow::Result<SwarmCase> {
        let map = match self.map.as_deref() {
            None => SwarmMap::Any,
            Some("random") => SwarmMap::Random,
            Some(file) => SwarmMap::Given(file.to_owned(), read_map(Path::new(file))?),
        };
        let (seed, minutes, robots, workers) = (self.seeds.0, self.minutes, self.robots, self.workers);
        Ok(SwarmCase { seed, minutes, map, robots, workers, without: self.without.iter().copied().collect() })
    }
}

/// Writes a failure to a file of its own.
fn keep(folder: &Path, finding: &SwarmFinding) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)?;
    let Shrunk { case, failure, .. } = &finding.shrunk;
    let kept = json!({
        "giveway_seed": 1,
        "command": case.to_string(),
        "what": format!("{} at {}: {}", failure.kind, failure.at, failure.words),
        "build": env!("CARGO_PKG_VERSION"),
    });
    let text = serde_json::to_string_pretty(&kept)? + "\n";
    write(Some(&folder.join(format!("seed-{}.json", finding.seed))), &text)
}

/// Runs the case with each of the seeds, and shrinks failures.
fn sweep(
    case: &SwarmCase,
    (first, last): (u64, u64),
    threads: usize,
    most: usize,
    meddle: Meddling,
) -> anyhow::Result<SwarmReport> {
    let bar = progress(last - first + 1, "swarm");
    let next = AtomicU64::new(first);
    let report: Mutex<Result<SwarmReport, String>> = Mutex::new(Ok(SwarmReport::default()));
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(note_panic));
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed > last {
                        break;
                    }
                    let outcome = run_seed(&SwarmCase { seed, ..case.clone() }, most, meddle);
                    let mut all = report.lock().expect("no thread panics while it holds this");
                    match (outcome, all.as_mut()) {
                        (Ok((tally, finding)), Ok(all)) => {
                            all.tally.add(&tally);
                            // Printed now, since a sweep may be ended before it prints its report.
                            if let Some(f) = &finding {
                                bar.suspend(|| {
                                    eprintln!("seed {seed}: {}; repeat: {}", f.failure.kind, f.shrunk.case)
                                });
                            }
                            all.findings.extend(finding);
                        }
                        (Err(e), Ok(_)) => *all = Err(e),
                        (_, Err(_)) => {}
                    }
                    bar.inc(1);
                }
            });
        }
    });
    std::panic::set_hook(hook);
    bar.finish_and_clear();
    let mut report = report.into_inner().expect("as above").map_err(anyhow::Error::msg)?;
    report.findings.sort_by_key(|f| f.seed);
    Ok(report)
}

fn run_seed(
    case: &SwarmCase,
    most: usize,
    meddle: Meddling,
) -> Result<(SwarmTally, Option<SwarmFinding>), String> {
    let setup = SwarmSetup::draw(case).map_err(|e| format!("{case} cannot be run:\n{e}"))?;
    let (tally, failure) = run(&setup, meddle);
    let finding = failure.map(|failure| {
        let size = (setup.scenario.robots, setup.scenario.workers.count);
        let again = |smaller: &SwarmCase| run(&SwarmSetup::draw(smaller).ok()?, meddle).1;
        let shrunk = shrink(case, size, &failure, most, again);
        SwarmFinding { seed: case.seed, failure, shrunk }
    });
    Ok((tally, finding))
}

/// Runs a drawn case; a panic is a failure like any other.
fn run(setup: &SwarmSetup, meddle: Meddling) -> (SwarmTally, Option<SwarmFailure>) {
    let mut run = SwarmRun::new(setup);
    let go = AssertUnwindSafe(|| {
        meddle(run.simulation());
        while run.step() {
            meddle(run.simulation());
        }
    });
    let panic = catch_unwind(go).is_err().then(|| {
        let (place, words) = PANIC.take().unwrap_or_default();
        (format!("panic at {place}"), words)
    });
    run.end(panic)
}

fn note_panic(info: &std::panic::PanicHookInfo<'_>) {
    let place = info.location().map(|l| format!("{}:{}", l.file(), l.line())).unwrap_or_default();
    let words = info.payload_as_str().unwrap_or("without words").to_owned();
    if std::env::var_os("RUST_BACKTRACE").is_some_and(|wanted| wanted != "0") && !words.contains(PLANTED) {
        eprintln!("{place}: {words}\n{}", std::backtrace::Backtrace::force_capture());
    }
    PANIC.set(Some((place, words)));
}

impl SwarmReport {
    fn json(&self) -> Value {
        let t = &self.tally;
        let finding = |f: &SwarmFinding| {
            json!({
                "seed": f.seed,
                "kind": f.failure.kind,
                "at_s": f.failure.at.as_secs_f64(),
                "what": f.failure.words,
                "command": f.shrunk.case.to_string(),
                "shrunk_at_s": f.shrunk.failure.at.as_secs_f64(),
                "shrunk_what": f.shrunk.failure.words,
                "shrink_runs": f.shrunk.runs,
            })
        };
        let jobs = t.jobs.iter().map(|(kind, j)| (kind.to_string(), super::sim::tally(j)));
        json!({
            "runs": t.runs,
            "heals_within_s": HEALS_WITHIN.as_secs_f64(),
            "robot_hours": t.robot_hours(),
            "searches": t.searches,
            "robot_deliveries": t.deliveries,
            "human_deliveries": t.human_deliveries,
            "maps": t.maps,
            "jobs": jobs.collect::<serde_json::Map<_, _>>(),
            "injected": t.injected,
            "failures": t.failures,
            "findings": self.findings.iter().map(finding).collect::<Vec<_>>(),
        })
    }

    fn print(&self) {
        let t = &self.tally;
        for f in &self.findings {
            println!("seed {}: {} at {}: {}", f.seed, f.failure.kind, f.failure.at, f.failure.words);
            let now = &f.shrunk.failure;
            println!("  shrunk in {} runs: at {}: {}", f.shrunk.runs, now.at, now.words);
            println!("  repeat: {}\n", f.shrunk.case);
        }
        println!("after the faults, everything has to end within {} s", HEALS_WITHIN.as_secs_f64());
        println!("{:24} {:>10}", "runs", t.runs);
        println!("{:24} {:>10.1}", "robot hours", t.robot_hours());
        println!("{:24} {:>10}", "searches", t.searches);
        println!("{:24} {:>10}", "robot deliveries", t.deliveries);
        println!("{:24} {:>10}", "human deliveries", t.human_deliveries);
        println!(
            "\n{:24} {:>10} {:>10} {:>10} {:>10} {:>10}",
            "jobs", "accepted", "done", "failed", "cancelled", "open"
        );
        for (kind, j) in &t.jobs {
            let numbers = [j.accepted, j.done, j.failed, j.cancelled, j.open_at_end];
            println!("{kind:24} {}", numbers.map(|n| format!("{n:>10}")).join(" "));
        }
        table("faults and acts by hand", t.injected.iter().map(|(k, n)| (*k, *n)));
        table("maps", t.maps.iter().map(|(k, n)| (k.as_str(), *n)));
        table("failures", t.failures.iter().map(|(k, n)| (k.as_str(), *n)));
        println!("{:24} {:>10}", "failed runs", self.findings.len());
    }
}

fn table<'a>(title: &str, rows: impl Iterator<Item = (&'a str, u64)>) {
    println!("\n{title}");
    rows.for_each(|(key, count)| println!("{key:24} {count:>10}"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::time::Time;

    /// After half a minute, a robot is put onto another one, if there are three.
    fn overlaps(sim: &mut Simulation) {
        let places: Vec<_> = sim.world.places().collect();
        if sim.now() == Time::from_secs_f64(30.0) && places.len() >= 3 {
            sim.world.put(places[0].0, places[1].1);
        }
    }

    /// After half a minute, every step panics over a robot, if there are two.
    fn panics(sim: &mut Simulation) {
        let many = sim.fleet().ledger().robots.len() >= 2;
        assert!(sim.now() < Time::from_secs_f64(30.0) || !many, "a test asked for it");
    }

    fn found(meddle: Meddling) -> SwarmReport {
        let case = SwarmCase { robots: Some(9), ..SwarmCase::whole(0, 3) };
        sweep(&case, (4, 5), 2, 60, meddle).expect("both seeds can be run")
    }

    #[test]
    fn a_planted_failure_is_found_shrunk_and_printed_as_a_command() {
        let report = found(overlaps);
        assert_eq!(report.tally.failures, [("overlap".to_owned(), 2)].into());
        let words = SwarmPart::ALL.iter().copied().collect::<std::collections::BTreeSet<_>>();
        let words: Vec<&str> = words.into_iter().map(SwarmPart::word).collect();
        for (finding, seed) in report.findings.iter().zip([4, 5]) {
            let command = finding.shrunk.case.to_string();
            let start = format!("giveway swarm --seeds {seed} --minutes 1 --robots 3 ");
            assert!(command.starts_with(&start), "{command}");
            assert!(command.ends_with(&format!("--without {}", words.join(","))), "{command}");
            assert!(finding.shrunk.failure.words.contains("overlap"), "{}", finding.shrunk.failure.words);
            let json = report.json().to_string();
            assert!(json.contains(&command), "{json}");
            // The printed command reproduces the failure.
            let again = run(&SwarmSetup::draw(&finding.shrunk.case).expect("as before"), overlaps).1;
            assert_eq!(again.as_ref(), Some(&finding.shrunk.failure));
        }
    }

    #[test]
    fn a_panic_is_a_failure_with_its_place_and_the_sweep_goes_on() {
        let report = found(panics);
        assert_eq!(report.tally.runs, 2);
        for finding in &report.findings {
            assert!(
                finding.failure.kind.starts_with(&format!("panic at {}:", file!())),
                "{}",
                finding.failure.kind
            );
            assert_eq!(finding.failure.words, "a test asked for it");
            assert_eq!(finding.shrunk.case.robots, Some(2));
        }
        assert_eq!(report.findings.len(), 2);
    }

    #[test]
    fn the_report_of_some_seeds_does_not_depend_on_the_number_of_threads() {
        let case = SwarmCase { workers: Some(0), ..SwarmCase::whole(0, 2) };
        let report = |threads| sweep(&case, (20, 23), threads, 0, |_| {}).expect("they can be run").json();
        assert_eq!(report(1).to_string(), report(3).to_string());
    }

    #[test]
    fn seeds_are_one_or_a_range_with_both_ends() {
        assert_eq!(seeds("7"), Ok((7, 7)));
        assert_eq!(seeds("1..200"), Ok((1, 200)));
        assert!(seeds("9..1").is_err() && seeds("x").is_err() && seeds("1..").is_err());
        assert!(part("weather").unwrap_err().contains("one of restart, panic, "));
    }
}

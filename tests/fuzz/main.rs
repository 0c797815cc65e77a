//! Files that somebody broke: maps, scenarios, order lines, tracks, models and recordings are read or refused, never
//! worse. `GIVEWAY_FUZZ_ROUNDS` says how many texts each test breaks, `GIVEWAY_FUZZ_SEED` where it begins.
//!
//! Feeds and requests are broken in `tests/it/mutated.rs`.

mod mutate;

use giveway::human::Model;
use giveway::sim::{OrderFileLine, Scenario, recording};
use giveway::warehouse::formats::{self, Options};
use mutate::Mutator;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// All texts of a folder that end so.
fn texts(name: &str, end: &str) -> Vec<String> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder(name)).unwrap().map(|f| f.unwrap().path()).collect();
    files.retain(|f| f.to_str().is_some_and(|f| f.ends_with(end)));
    files.sort();
    assert!(!files.is_empty(), "{name} has no {end}");
    files.iter().map(|f| std::fs::read_to_string(f).unwrap()).collect()
}

/// Breaks the texts in turn and lets `read` read them; it says whether it took one. Fails where it panics, and says how
/// to repeat it.
fn each(what: &str, texts: &[String], usual: u64, read: impl Fn(&str) -> bool) {
    let (rounds, first) = (number("GIVEWAY_FUZZ_ROUNDS", usual), number("GIVEWAY_FUZZ_SEED", 1));
    assert!(texts.iter().all(|text| read(text)), "{what}: the texts are in order before they are broken");
    let mut taken = 0;
    for round in 0..rounds {
        let seed = first + round;
        let broken = Mutator::new(seed).text(&texts[round as usize % texts.len()]);
        match catch_unwind(AssertUnwindSafe(|| read(&broken))) {
            Ok(is_taken) => taken += u64::from(is_taken),
            Err(_) => {
                let file = std::env::temp_dir().join(format!("giveway-fuzz-{seed}.txt"));
                std::fs::write(&file, &broken).unwrap();
                let text = file.display();
                panic!(
                    "{what}: GIVEWAY_FUZZ_SEED={seed} GIVEWAY_FUZZ_ROUNDS=1 repeats it; the text is in {text}"
                );
            }
        }
    }
    println!("{what}: {rounds} broken texts, {taken} of them still in order");
}

#[test]
fn broken_maps_are_built_or_refused() {
    let is_small_map = |t: &String| t.len() < 60_000 && !t.contains("json-schema.org");
    let small: Vec<String> = texts("maps", ".json").into_iter().filter(is_small_map).collect();
    assert!(!small.is_empty());
    each("maps", &small, 400, |text| formats::import(text, &Options::default()).is_ok());
}

#[test]
fn broken_grids_are_built_or_refused() {
    let octile = format!("type octile\nheight 6\nwidth 9\nmap\n{}", "....@....\n".repeat(6));
    let kiva = format!("6,9\n2\n2\n100\n{}", "..e@e.@..\n..e@e.@r.\n".repeat(3));
    each("octile grids", &[octile], 400, |text| {
        formats::import(text, &Options::default()).is_ok() || text.starts_with("type octile")
    });
    each("warehouse grids", &[kiva], 400, |text| {
        formats::import(text, &Options::default()).is_ok() || text.starts_with("6,9")
    });
}

#[test]
fn broken_scenarios_are_read_or_refused_and_fit_a_map_or_do_not() {
    let lab = std::fs::read_to_string(folder("maps/lab.json")).unwrap();
    let (lab, _) = formats::import(&lab, &Options::default()).unwrap();
    let lab = Arc::new(lab);
    each("scenarios", &texts("scenarios", ".json"), 2000, |text| match Scenario::parse(text) {
        Ok(scenario) => {
            let _ = scenario.site.fit(&lab);
            true
        }
        Err(why) => {
            assert!(!why.to_string().is_empty(), "a refusal says why");
            false
        }
    });
}

#[test]
fn broken_order_lines_are_read_or_refused() {
    let lines = "OrderNumber,AlleyCell,Quantity\n1,A.01.02,3\n1,B.04.05,1\n2,\"A, 01\",7\n".to_owned();
    each("order lines", &[lines], 2000, |text| OrderFileLine::parse_csv(text).is_ok());
}

#[test]
fn broken_models_are_read_or_refused() {
    let built_in = Model::builtin().to_json();
    each("models", &[built_in], 200, |text| Model::parse(text).is_ok());
}

#[test]
fn broken_recordings_are_read_or_refused_line_by_line() {
    let lines = recorded();
    let play = |text: &str| {
        let mut lines = text.lines();
        let Ok((_, mut playback)) = recording::Playback::open(lines.next().unwrap_or_default()) else {
            return false;
        };
        lines.all(|line| playback.read(line).is_ok())
    };
    each("recordings", &[lines.join("\n")], 100, play);
    // Each line for itself is JSON, so that more of what is broken is still read.
    each("lines of recordings", &lines[1..], 1200, |line| {
        let (_, mut playback) = recording::Playback::open(&lines[0]).expect("it is in order");
        playback.read(line).is_ok()
    });
}

/// A recording of half a minute with jobs of all kinds, people, cancels and faults.
fn recorded() -> Vec<String> {
    let file = std::env::temp_dir().join(format!("giveway-fuzz-{}.jsonl", std::process::id()));
    let run = std::process::Command::new(env!("CARGO_BIN_EXE_giveway"))
        .args(["sim", "--no-bound", "--record"])
        .arg(&file)
        .arg(folder("docs/small-scenario.json"))
        .output()
        .unwrap();
    let text = std::fs::read_to_string(&file)
        .unwrap_or_else(|e| panic!("no recording ({e}): {}", String::from_utf8_lossy(&run.stderr)));
    std::fs::remove_file(&file).unwrap();
    let lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let every = (lines.len() / 120).max(1);
    let some = lines.iter().skip(1).step_by(every).cloned();
    std::iter::once(lines[0].clone()).chain(some).collect()
}

//! The JSON output of experiments at the picking station: every key that docs and issues name, from the smallest
//! possible runs. Docs explain the figures; this test only checks that they are there.

use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn giveway(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_giveway-lab")).args(arguments).output().unwrap()
}

/// A test's own folder, below the one for build results.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The output of an experiment with `--json`.
fn report(arguments: &str) -> Value {
    let arguments: Vec<&str> =
        ["experiment"].into_iter().chain(arguments.split(' ')).chain(["--json"]).collect();
    let ran = giveway(&arguments);
    assert!(ran.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&ran.stderr));
    serde_json::from_slice(&ran.stdout).unwrap_or_else(|e| panic!("{arguments:?}: {e}"))
}

/// Keys that lead nowhere, each a path through the report with `|` between words that must all be there.
fn missing(report: &Value, keys: &[&str]) -> Vec<String> {
    let mut missing = Vec::new();
    for key in keys {
        let mut all: Vec<(String, &Value)> = vec![(String::new(), report)];
        for part in key.split('/') {
            all = all
                .into_iter()
                .flat_map(|(way, value)| {
                    part.split('|').map(move |word| (format!("{way}/{word}"), &value[word]))
                })
                .collect();
        }
        missing.extend(all.into_iter().filter(|(_, value)| value.is_null()).map(|(way, _)| way));
    }
    missing
}

#[test]
fn the_report_of_the_bench_with_an_arm_has_its_keys() {
    let report = report("bolts --runs 2");
    let keys = [
        "arms/turns|reactive|predictive/min_distance_cm|min_capsule_cm|length_cm|time_s|products_per_hour/mean|sd",
        "arms/turns|reactive|predictive/contacts",
        "paired/predictive-reactive/length_cm|time_s|min_distance_cm/mean|ci95",
        "accuracy/observed|ahead/20|60",
        "table_2_agreement",
    ];
    assert_eq!(missing(&report, &keys), [""; 0]);
}

#[test]
fn the_report_of_planners_has_its_keys_and_no_path_is_unchecked() {
    let report = report("planners --workspaces 1 --queries 2 --motions 2");
    let keys = [
        "planners/rrt|rrt_star|bfmt_star|graph|graph_fallback/length_m|time_ms/mean",
        "planners/rrt|rrt_star|bfmt_star|graph|graph_fallback/success|ci95",
        "planners/graph_fallback/time_ms/p95",
        "dropout/5|10|20/sd_mm|correlation|cov95|cov95_scaled",
        "smoothness/no_arm|present|forecast/acc|jerk",
    ];
    assert_eq!(missing(&report, &keys), [""; 0]);
    assert_eq!(report["unchecked_paths"], 0);
}

#[test]
fn the_report_of_overlaps_has_its_keys() {
    let report = report("overlap --cases 20 --draws 1000 --rounds 2");
    let keys = [
        "ece/printed|normalised|giveway",
        "delta/0.05|0.1|0.005/success|needless",
        "delta/0.05/failures/forecast|lag|link",
        "rounds",
        "forecast_ms",
        "choice_ms",
    ];
    assert_eq!(missing(&report, &keys), [""; 0]);
}

#[test]
fn the_report_of_corridors_has_its_keys_and_no_law_is_broken() {
    let report = report("corridor --runs 2");
    let keys = [
        "arms/stop|traditional|improved/path_m|time_s|closest_m|behind",
        "paired/improved-traditional/path_m|time_s|closest_m/mean|ci95",
    ];
    assert_eq!(missing(&report, &keys), [""; 0]);
    assert_eq!(report["law_violations"], 0);
}

#[test]
fn the_report_of_objects_has_every_row_of_both_tables() {
    let report = report("objects --people 3 --movements 12 --steps 1");
    let keys = [
        "tables/5.2/lstm|mlp|mlp_1|mlp_8|rnn|full|all|enhanced|gaze|head|hand/auc_sum|auc_mean|error_sum|error_mean",
        "tables/5.3/lstm|mlp|rnn|full|head|hand/auc_sum|auc_mean|error_sum|error_mean",
        "tables/5.2/lstm|mlp|rnn|full|all/ms",
        "tables/5.3/lstm|mlp|rnn|full/ms",
        "people_left_out/5.2|5.3/lstm/auc_sum|auc_mean|error_sum|error_mean",
        "eg_lstm/models",
        "features/correlation|merit|selected",
    ];
    assert_eq!(missing(&report, &keys), [""; 0]);
}

/// Tables of people who point at two places, as `experiment picks` reads them.
fn write_recording(folder: &Path) {
    let mut moves = "move,person,target,onset_ms,arrival_ms\n".to_owned();
    let mut samples = "move,t_ms".to_owned();
    for part in ["shoulder", "forearm", "hand", "finger", "head"] {
        ["x", "y", "z"].iter().for_each(|axis| write!(samples, ",{part}_{axis}").unwrap());
    }
    samples += ",head_yaw,head_pitch\n";
    for (person, target, to) in (1..=6).flat_map(|p| [(p, "A1", [520, 0, 1100]), (p, "B1", [540, 280, 1250])])
    {
        let name = format!("p{person}-{target}");
        writeln!(moves, "{name},p{person},{target},240,{}", 1000 + 40 * (person % 3)).unwrap();
        for t in (0..=1120).step_by(40) {
            let share = (f64::from(t - 240) / 760.0).clamp(0.0, 1.0);
            let share = share * share * (3.0 - 2.0 * share);
            let from = [10 * person, -150, 950];
            let finger = [0, 1, 2].map(|i| f64::from(from[i]) + share * f64::from(to[i] - from[i]));
            let [x, y, z] = finger;
            write!(samples, "{name},{t},-250,-180,1400,{:.0},-170,1150,", -120.0 + 0.4 * x).unwrap();
            write!(samples, "{:.0},{:.0},{z:.0},{x:.0},{y:.0},{z:.0},", x - 80.0, y - 10.0).unwrap();
            writeln!(samples, "-260,0,1600,{:.1},{:.1}", 20.0 * share, -10.0).unwrap();
        }
    }
    let gaze: String = (0..4)
        .flat_map(|trial| (0..30).map(move |i| (trial, i)))
        .map(|(trial, i)| format!("{trial},{},{i},20,{},12,5,25\n", 40 * i - 1200, f64::from(i) * 0.7))
        .collect();
    let places = "target,x,y,z\n";
    let tables = [
        ("moves.csv", moves),
        ("samples.csv", samples),
        ("targets.csv", format!("{places}A1,1,0,1\nB1,1,1,1\n")),
        ("slots.csv", format!("{places}A1,0.52,0,1.1\nB1,0.54,0.28,1.25\n")),
        (
            "gaze.csv",
            format!("trial,t_ms,eye_yaw,eye_pitch,head_yaw,head_pitch,target_yaw,target_pitch\n{gaze}"),
        ),
    ];
    for (name, text) in tables {
        std::fs::write(folder.join(name), text).unwrap();
    }
}

#[test]
fn the_report_of_recorded_people_has_every_model() {
    let folder = folder("recorded");
    write_recording(&folder);
    let report = report(&format!("picks --data {}", folder.display()));
    let keys = [
        "models/giveway|lstm|mlp|rnn|full|all|mixtures|mixtures_ahead|hand|head/top1/10|50|100",
        "models/giveway|lstm|mlp|rnn|full|all|mixtures|mixtures_ahead|hand|head/top1_mean|location_error|nll|ece|miss5",
        "arm/giveway|seq2seq|bones|vae|still|velocity/error_mm/hand|shoulder|forearm|finger/0.08|0.20|0.40",
        "arm/giveway/cov95/hand/0.08|0.20|0.40",
        "gaze/head_ray|mlp|giveway/median_deg|p90_deg",
        "slots",
        "people",
        "movements",
    ];
    assert_eq!(missing(&report, &keys), [""; 0]);
}

#[test]
fn a_model_of_another_version_runs_nothing_and_its_refusal_names_the_command_that_makes_one() {
    let folder = folder("model");
    let model = folder.join("picks.json");
    std::fs::write(&model, r#"{"model": {"version": 1}}"#).unwrap();
    let model = model.to_str().unwrap();
    let ran = giveway(&["experiment", "stations", "--runs", "2", "--pick-model", model]);
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(!ran.status.success(), "it ran");
    assert!(said.contains(model) && said.contains("giveway learn picks"), "{said}");
}

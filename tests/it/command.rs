//! The program itself, called like from a shell: exit codes, and what it prints where.

use crate::carry::{is_over, until};
use crate::helper::{Folder, delivery, eventually, get, map, post, send, until_ready};
use giveway::warehouse::formats;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Runs the program to its end.
fn giveway(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_giveway")).args(arguments).output().unwrap()
}

fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {output:?}"))
}

/// Two minutes of the lab on file, and the report of the run.
fn record(folder: &Folder, name: &str) -> (PathBuf, Value) {
    let path = folder.path().join(name);
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/lab.json");
    let file = path.to_str().unwrap();
    let run = ["sim", scenario, "--seed", "3", "--duration", "120", "--no-bound", "--json", "--record", file];
    let ran = giveway(&run);
    assert!(ran.status.success(), "{ran:?}");
    (path, json_of(&ran))
}

/// The program, running until the test is over.
struct Shown(Child);

impl Shown {
    fn start(recording: &str) -> (Shown, SocketAddr) {
        Shown::of(&["replay", recording, "--listen", "127.0.0.1:0", "--speed", "1000"])
    }

    /// The program with these arguments, which listens and says where in its first line.
    fn of(arguments: &[&str]) -> (Shown, SocketAddr) {
        let program = Command::new(env!("CARGO_BIN_EXE_giveway"))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut shown = Shown(program.unwrap());
        let mut line = String::new();
        BufReader::new(shown.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().rsplit_once("http://").map(|(_, at)| at.trim_end_matches('/'));
        (shown, address.and_then(|at| at.parse().ok()).unwrap_or_else(|| panic!("no address in {line:?}")))
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_throughput_bound_is_never_below_what_was_delivered() {
    // Stations are the limit on this floor: with this seed, robots that pass through one another deliver less.
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/thesis-20.json");
    let ran = giveway(&["sim", scenario, "--seed", "2", "--duration", "1200", "--json"]);
    assert!(ran.status.success(), "{ran:?}");
    let report = json_of(&ran);
    let figure = |key: &str| report[key].as_f64().unwrap_or_else(|| panic!("no {key} in {report}"));
    assert!(figure("robot_deliveries") > 100.0, "{report}");
    assert!(figure("throughput_bound") >= figure("robot_deliveries"), "{report}");
    assert!(figure("throughput_bound_ratio") <= 1.0, "{report}");
}

#[test]
fn a_recording_steps_through_the_same_and_a_changed_one_is_found_out() {
    let folder = Folder::new();
    let (path, report) = record(&folder, "lab.jsonl");
    let check = ["replay", path.to_str().unwrap(), "--check", "--json"];
    let checked = giveway(&check);
    assert!(checked.status.success(), "{checked:?}");
    assert_eq!(json_of(&checked)["trace_hash"], report["trace_hash"]);
    assert_eq!(json_of(&checked)["same_as_recorded"], true);

    let text = std::fs::read_to_string(&path).unwrap();
    let hash = report["trace_hash"].as_str().unwrap();
    assert!(text.contains(hash), "the digest is in the recording");
    std::fs::write(&path, text.replace(hash, "0123456789abcdef")).unwrap();
    let checked = giveway(&check);
    assert_eq!(checked.status.code(), Some(1), "{checked:?}");
    assert_eq!(json_of(&checked)["same_as_recorded"], false);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_recording_is_shown_and_takes_no_requests() {
    let folder = Folder::new();
    let (path, _) = record(&folder, "lab.jsonl.gz");
    let (_shown, at) = Shown::start(path.to_str().unwrap());
    let page = get(at, "/").await;
    assert!(page.status == 200 && page.text.contains("<html"), "{page:?}");
    for path in ["/v1/map", "/v1/robots", "/v1/racks", "/v1/stations", "/v1/jobs", "/metrics"] {
        assert_eq!(get(at, path).await.status, 200, "{path}");
    }
    let refused = [
        post(at, None, &delivery(0)).await.unwrap(),
        send(at, "DELETE", "/v1/jobs/j1", &[], "").await.unwrap(),
    ];
    for answer in refused {
        let problem = answer.problem(409);
        assert_eq!(problem["type"], json!("/problems/recording"));
        assert!(problem["detail"].as_str().unwrap().contains("a recording is shown here"), "{problem}");
    }
}

#[test]
fn map_check_lists_wrong_names_and_a_wrong_floor_at_once() {
    let folder = Folder::new();
    let path = folder.path().join("bad.json");
    let mut bad: serde_json::Value = serde_json::from_str(&formats::json::write(&map())).unwrap();
    let lane = serde_json::json!({"from": bad["nodes"][0]["id"], "to": "nowhere"});
    bad["lanes"].as_array_mut().unwrap().push(lane);
    bad["nodes"].as_array_mut().unwrap().push(serde_json::json!({"id": "island", "x": 90, "y": 90}));
    std::fs::write(&path, bad.to_string()).unwrap();
    let checked = giveway(&["map", "check", path.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&checked.stderr);
    assert_eq!(checked.status.code(), Some(1), "{said}");
    let findings: Vec<&str> = said.lines().skip(1).collect();
    assert_eq!(findings.len(), 2, "{said}");
    assert!(findings[0].ends_with("there is no node nowhere; add the node or correct the name"), "{said}");
    assert_eq!(findings[1], "nodes island: no lane touches them; add lanes or remove them");
}

#[test]
fn map_check_warns_where_a_broken_robot_shuts_others_in_and_the_map_is_good_all_the_same() {
    let folder = Folder::new();
    let path = folder.path().join("lab.json");
    std::fs::write(&path, formats::json::write(&map())).unwrap();
    let checked = giveway(&["map", "check", path.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&checked.stdout);
    assert_eq!(checked.status.code(), Some(0), "{said}");
    let warnings: Vec<&str> = said.lines().filter(|l| l.starts_with("warning: ")).collect();
    assert_eq!(warnings.len(), 1, "{said}");
    assert!(
        warnings[0].contains("if a robot breaks down there") && warnings[0].contains("add a lane"),
        "{said}"
    );
    let checked = giveway(&["map", "check", path.to_str().unwrap(), "--json"]);
    let found = &json_of(&checked)["findings"][0];
    assert_eq!(found["shut_in"].as_array().map(Vec::len), Some(2), "{found}");
    assert_eq!(json_of(&checked)["stations"], 1);
}

#[test]
fn map_check_tells_a_program_what_is_wrong_and_where_and_map_show_draws_it_in_red() {
    let folder = Folder::new();
    let path = folder.path().join("bad.json");
    let mut bad: serde_json::Value = serde_json::from_str(&formats::json::write(&map())).unwrap();
    bad["nodes"].as_array_mut().unwrap().push(serde_json::json!({"id": "island", "x": 9, "y": 9}));
    bad["stations"] = serde_json::json!([]);
    std::fs::write(&path, bad.to_string()).unwrap();
    let path = path.to_str().unwrap();
    let checked = giveway(&["map", "check", path, "--json"]);
    assert_eq!(checked.status.code(), Some(1));
    let told = json_of(&checked);
    let errors = told["errors"].as_array().unwrap();
    let island = errors.iter().find(|e| e["place"] == "nodes island").unwrap();
    assert_eq!(island["at"], serde_json::json!([[9.0, 9.0]]), "{told}");
    assert_eq!(told["warnings"][0]["place"], "stations", "{told}");
    let shown = giveway(&["map", "show", path]);
    assert_eq!(shown.status.code(), Some(1), "it is refused all the same");
    let drawing = String::from_utf8_lossy(&shown.stdout);
    assert!(drawing.starts_with("<svg") && drawing.contains("class=\"mark\""), "{drawing}");
    assert!(String::from_utf8_lossy(&shown.stderr).contains("nodes island: no lane touches them"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_starts_with_another_map_than_the_one_of_its_scenario() {
    let folder = Folder::new();
    let path = folder.path().join("drawn.json");
    let mut drawn: serde_json::Value = serde_json::from_str(&formats::json::write(&map())).unwrap();
    drawn["name"] = serde_json::json!("drawn");
    std::fs::write(&path, drawn.to_string()).unwrap();
    let (path, database) = (path.to_str().unwrap(), folder.database());
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/lab.json");
    let database = database.to_str().unwrap();
    let listen = ["serve", "--listen", "127.0.0.1:0", "--scenario", scenario];
    let (_server, at) = Shown::of(&[&listen[..], &["--database", database, "--map", path]].concat());
    let answers = async || Some(get(at, "/v1/map").await).filter(|answer| answer.status == 200);
    assert_eq!(eventually("the map is there", answers).await.json()["name"], "drawn");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_runs_a_site_without_any_scenario_and_refuses_to_run_both() {
    let folder = Folder::new();
    let site = folder.path().join("site.json");
    let map = concat!(env!("CARGO_MANIFEST_DIR"), "/maps/lab.json");
    let text = json!({"giveway_site": 1, "name": "lab", "map": map, "links": {"sim": {"robots": 2}}});
    std::fs::write(&site, text.to_string()).unwrap();
    let (site, database) = (site.to_str().unwrap(), folder.database());
    let serve =
        ["serve", "--site", site, "--listen", "127.0.0.1:0", "--database", database.to_str().unwrap()];
    let (_server, at) = Shown::of(&serve);
    until_ready(at).await;
    let job = post(at, None, &delivery(0)).await.unwrap();
    assert_eq!(job.status, 201, "{job:?}");
    let alone = |jobs: &[Value]| jobs.len() == 1 && jobs.iter().all(is_over);
    let jobs = until(at, "the one job is over, and no other was ordered", alone).await;
    assert_eq!(jobs[0]["state"], "done", "{jobs:?}");
    assert_eq!(get(at, "/v1/robots").await.json()["items"].as_array().unwrap().len(), 2);
    let both = Command::new(env!("CARGO_BIN_EXE_giveway"))
        .args(["serve", "--site", site])
        .env("GIVEWAY_SCENARIO", "x.json")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&both.stderr);
    assert!(!both.status.success() && said.contains("leave one of them out"), "{said}");
}

#[tokio::test]
async fn a_simulated_floor_runs_as_many_times_as_fast_as_it_is_told_and_one_with_real_robots_does_not() {
    let folder = Folder::new();
    let (scenario, database) =
        (concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/lab.json"), folder.database());
    let floor = ["serve", "--speed", "20", "--scenario", scenario, "--database", database.to_str().unwrap()];
    let (_server, at) = Shown::of(&[&floor[..], &["--listen", "127.0.0.1:0"]].concat());
    until_ready(at).await;
    let began = Instant::now();
    let id = post(at, None, &delivery(0)).await.unwrap().json()["id"].as_str().unwrap().to_owned();
    let path = format!("/v1/jobs/{id}");
    let over = async || Some(get(at, &path).await.json()).filter(is_over);
    let job = eventually("the job is over", over).await;
    let time = |key: &str| job[key].as_str().unwrap().parse::<jiff::Timestamp>().unwrap();
    let lasted = Duration::try_from(time("updated").duration_since(time("created"))).unwrap();
    assert_eq!(job["state"], "done", "{job}");
    assert!(lasted > began.elapsed(), "{lasted:?} on the floor");
    let refused = giveway(&[&floor[..], &["--mqtt", "mqtt://127.0.0.1:1"]].concat());
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && said.contains("leave --speed out"), "{said}");
}

#[tokio::test]
async fn on_a_site_without_links_no_robot_joins_and_the_refusal_says_what_to_do() {
    let folder = Folder::new();
    let site = folder.path().join("site.json");
    let map = concat!(env!("CARGO_MANIFEST_DIR"), "/maps/lab.json");
    std::fs::write(&site, json!({"giveway_site": 1, "name": "lab", "map": map}).to_string()).unwrap();
    let (site, database) = (site.to_str().unwrap(), folder.database());
    let serve =
        ["serve", "--site", site, "--listen", "127.0.0.1:0", "--database", database.to_str().unwrap()];
    let (_server, at) = Shown::of(&serve);
    until_ready(at).await;
    let node = get(at, "/v1/map").await.json()["nodes"][0]["id"].clone();
    let robot = json!({"name": "agv-1", "node": node});
    let json = [("content-type", "application/json")];
    let answer = send(at, "POST", "/v1/robots", &json, &robot.to_string()).await.unwrap();
    assert_eq!((answer.status, answer.json()["type"].as_str().unwrap()), (409, "/problems/no-link"));
    assert!(answer.json()["detail"].as_str().unwrap().contains("add one to `links`"), "{answer:?}");
}

#[test]
fn what_the_server_writes_is_for_its_user_alone() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let database = folder.database();
    let (server, address) = Shown::of(&[
        "serve",
        "--scenario",
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/quiet.json"),
        "--listen",
        "127.0.0.1:0",
        "--database",
        database.to_str().unwrap(),
    ]);
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let answer = runtime.block_on(post(address, None, &delivery(0))).unwrap();
    assert_eq!(answer.status, 201);
    let mut found = 0;
    let mut folders = vec![folder.path().to_owned()];
    while let Some(path) = folders.pop() {
        for entry in std::fs::read_dir(path).unwrap().map(Result::unwrap) {
            let file = entry.metadata().unwrap();
            assert_eq!(file.permissions().mode() & 0o077, 0, "{}", entry.path().display());
            found += 1;
            folders.extend(file.is_dir().then(|| entry.path()));
        }
    }
    assert!(found > 2, "only {found} files");
    drop(server);
}

#[test]
fn a_model_of_another_version_starts_nothing_and_its_refusal_names_the_command_that_makes_one() {
    let folder = Folder::new();
    let model = folder.path().join("picks.json");
    std::fs::write(&model, r#"{"model": {"version": 1}}"#).unwrap();
    let (model, database) = (model.to_str().unwrap(), folder.database());
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/stations.json");
    let database = database.to_str().unwrap();
    for arguments in [
        vec!["serve", "--scenario", scenario, "--database", database, "--pick-model", model],
        vec!["sim", scenario, "--pick-model", model],
    ] {
        let ran = giveway(&arguments);
        let said = String::from_utf8_lossy(&ran.stderr);
        assert!(!ran.status.success(), "{arguments:?} started");
        assert!(said.contains(model) && said.contains("giveway learn picks"), "{said}");
    }
}

#[test]
fn a_command_of_the_laboratory_that_is_not_built_says_how_to_build_it() {
    // A copy of the program in a folder of its own has nothing beside it.
    let folder = Folder::new();
    let alone = folder.path().join("giveway");
    std::fs::copy(env!("CARGO_BIN_EXE_giveway"), &alone).unwrap();
    for command in ["experiment", "learn", "bench"] {
        let ran = Command::new(&alone).args([command, "--help"]).output().unwrap();
        let said = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(1), "{said}");
        assert!(said.contains(command) && said.contains("cargo build -p giveway-lab"), "{said}");
    }
}

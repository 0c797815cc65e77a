//! Robots that speak VDA 5050, over a real broker: virtual ones of three versions drive for a server, and are probed.
//!
//! The broker is Mosquitto, which `tests/all` installs. Where it is missing, a test says so on standard error, past
//! what the test program captures, and is left out.

use crate::helper::{Answer, Folder, PATIENCE, all_jobs, eventually, get, post, send};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const MAP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/maps/thesis.json");
/// A floor on which nothing is simulated but time.
const SCENARIO: &str =
    r#"{"giveway_scenario": 1, "name": "others", "map": "MAP", "robots": 0, "jobs": "none"}"#;

/// A process, running until the test is over.
struct Process(Child);

impl Process {
    /// The program with these arguments; what it prints comes line by line.
    fn giveway(arguments: &[&str]) -> (Process, impl Iterator<Item = String> + use<>) {
        let program = Command::new(env!("CARGO_BIN_EXE_giveway"))
            .args(arguments)
            .env("RUST_LOG", "warn")
            .stdout(Stdio::piped())
            .spawn();
        let mut process = Process(program.unwrap());
        let lines = BufReader::new(process.0.stdout.take().unwrap()).lines();
        (process, lines.map_while(Result::ok))
    }

    /// Asks the process to end, as Ctrl-C does, and waits for it.
    fn interrupt(mut self) {
        let told = Command::new("kill").args(["-INT", &self.0.id().to_string()]).status().unwrap();
        assert!(told.success() && self.0.wait().unwrap().success());
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A broker on a port of its own.
struct Broker {
    url: String,
    port: u16,
    _process: Process,
}

impl Broker {
    /// A broker with these rights; nothing if Mosquitto is not installed.
    fn start(folder: &Folder, rights: Option<&Path>) -> Option<Broker> {
        let program = ["/usr/sbin/mosquitto", "/usr/bin/mosquitto", "/usr/local/sbin/mosquitto"];
        let Some(program) = program.into_iter().find(|path| Path::new(path).exists()) else {
            let said = "LEFT OUT: mosquitto is not installed, so no robot of others was tried over a broker. Type: \
                        apt-get install --no-install-recommends mosquitto\n";
            std::io::stderr().write_all(said.as_bytes()).unwrap();
            return None;
        };
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut settings = format!("listener {port} 127.0.0.1\nallow_anonymous true\n");
        if let Some(rights) = rights {
            settings += &format!("acl_file {}\n", rights.display());
        }
        if rustix::process::geteuid().is_root() {
            // Else it would change to a user who cannot read the test's folder.
            settings += "user root\n";
        }
        let file = folder.path().join("mosquitto.conf");
        std::fs::write(&file, settings).unwrap();
        let process = Command::new(program).arg("-c").arg(&file).stderr(Stdio::null()).spawn().unwrap();
        let broker = Broker { url: format!("mqtt://127.0.0.1:{port}"), port, _process: Process(process) };
        let end = Instant::now() + PATIENCE;
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(Instant::now() < end, "the broker never listens");
            std::thread::sleep(Duration::from_millis(50));
        }
        Some(broker)
    }

    /// Has the broker keep a text under a topic.
    fn keep(&self, topic: &str, text: &Value) {
        let options = rumqttc::MqttOptions::new("test-keeps", "127.0.0.1", self.port);
        let (client, mut line) = rumqttc::Client::new(options, 10);
        client.publish(topic, rumqttc::QoS::AtLeastOnce, true, text.to_string()).unwrap();
        let is_kept = |event: Result<rumqttc::Event, _>| {
            matches!(event.unwrap(), rumqttc::Event::Incoming(rumqttc::Packet::PubAck(_)))
        };
        assert!(line.iter().any(is_kept), "the broker keeps it");
    }

    /// What the broker keeps under a topic, for a user.
    fn retained(&self, user: &str, topic: &str) -> Value {
        let mut options = rumqttc::MqttOptions::new(format!("test-{user}"), "127.0.0.1", self.port);
        options.set_credentials(user, "");
        let (client, mut line) = rumqttc::Client::new(options, 10);
        client.subscribe(topic, rumqttc::QoS::AtLeastOnce).unwrap();
        for event in line.iter() {
            if let rumqttc::Event::Incoming(rumqttc::Packet::Publish(heard)) = event.unwrap() {
                return serde_json::from_slice(&heard.payload).unwrap();
            }
        }
        panic!("the line ended")
    }
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Switches on one virtual robot of a version at a node, as a user of its own; gives it with its file for the server.
fn robot(folder: &Folder, url: &str, version: &str, node: &str) -> (Process, PathBuf) {
    let short = version.replace('.', "");
    let (places, out) =
        (folder.path().join(format!("places-{short}")), folder.path().join(format!("out-{short}")));
    let place = json!({"robots": [{"serial": format!("v{short}"), "node": node}]});
    std::fs::write(&places, place.to_string()).unwrap();
    let user = format!("giveway-v{short}");
    let arguments = ["robot", "--mqtt", url, "--mqtt-user", &user, "--version", version, "--map", MAP];
    let files = ["--places", text(&places), "--robots-out", text(&out)];
    let (process, mut lines) = Process::giveway(&[&arguments[..], &files[..]].concat());
    lines.find(|line| line.starts_with("robot ")).expect("a robot");
    (process, out)
}

/// One file of the robots of several.
fn together(folder: &Folder, files: &[PathBuf]) -> PathBuf {
    let mut all = json!({"giveway_robots": 1, "map_id": "thesis", "kinds": {}, "robots": []});
    for file in files {
        let file: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        let kinds = file["kinds"].as_object().unwrap().clone();
        all["kinds"].as_object_mut().unwrap().extend(kinds);
        all["robots"].as_array_mut().unwrap().extend(file["robots"].as_array().unwrap().clone());
    }
    let path = folder.path().join("robots.json");
    std::fs::write(&path, all.to_string()).unwrap();
    path
}

/// A server for a floor whose robots are all behind the broker.
fn serve(folder: &Folder, url: &str, robots: &Path) -> (Process, SocketAddr) {
    let scenario = folder.path().join("floor.json");
    std::fs::write(&scenario, SCENARIO.replace("MAP", MAP)).unwrap();
    let database = folder.database();
    let (process, mut lines) = Process::giveway(&[
        "serve",
        "--scenario",
        text(&scenario),
        "--database",
        text(&database),
        "--listen",
        "127.0.0.1:0",
        "--mqtt",
        url,
        "--mqtt-user",
        "giveway",
        "--robots",
        text(robots),
    ]);
    let line = lines.next().expect("a line");
    let address = line.split_once("http://").map(|(_, at)| at.trim_end_matches('/').parse());
    (process, address.unwrap_or_else(|| panic!("no address in {line:?}")).unwrap())
}

/// The rights that the program writes for a file of robots.
fn rights(robots: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_giveway")).args(["robot", "acl", text(robots)]).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Waits until this many jobs are done. Robots drive in real time, so this takes longer than what other tests wait for.
async fn until_done(at: SocketAddr, count: usize) {
    let end = Instant::now() + 5 * PATIENCE;
    loop {
        let jobs = all_jobs(at, 100).await;
        if jobs.iter().filter(|job| job["state"] == "done").count() >= count {
            break;
        }
        assert!(Instant::now() < end, "never done: {jobs:#?}");
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
}

/// The places of three robots that are far from one another.
const ROBOTS: [(&str, &str); 3] = [("2.0.0", "P0-15"), ("2.1.0", "PW10"), ("3.0.0", "PE12")];

#[tokio::test(flavor = "multi_thread")]
async fn three_robots_of_three_versions_do_five_jobs_with_no_more_rights_than_they_need() {
    let folder = Folder::new();
    // What the robots' own processes will say, since the broker wants the rights before they come.
    let listed = ROBOTS.map(|(version, _)| {
        let serial = format!("v{}", version.replace('.', ""));
        json!({"name": serial, "manufacturer": "giveway", "serial": serial, "kind": "any", "version": version})
    });
    let planned = folder.path().join("planned.json");
    let file = json!({"giveway_robots": 1, "map_id": "thesis", "kinds": {"any": {}}, "robots": listed});
    std::fs::write(&planned, file.to_string()).unwrap();
    let acl = folder.path().join("acl");
    std::fs::write(&acl, rights(&planned)).unwrap();
    let Some(broker) = Broker::start(&folder, Some(&acl)) else { return };
    let robots = ROBOTS.map(|(version, node)| robot(&folder, &broker.url, version, node));
    let file = together(&folder, &robots.each_ref().map(|(_, file)| file.clone()));
    assert_eq!(rights(&file), rights(&planned), "the rights do not depend on the kinds");
    let (_server, at) = serve(&folder, &broker.url, &file);
    let joined = async || {
        let robots = get(at, "/v1/robots").await.json();
        (robots["items"].as_array().map(Vec::len) == Some(3)).then_some(())
    };
    eventually("three robots join", joined).await;
    for rack in 1..=5 {
        let job = json!({"kind": "deliver", "rack": format!("K{rack}"), "station": "W"});
        assert_eq!(post(at, None, &job).await.unwrap().status, 201);
    }
    until_done(at, 5).await;
    for (process, _) in robots {
        process.interrupt();
    }
    for (level, serial) in [("v2", "v200"), ("v2", "v210"), ("v3", "v300")] {
        let topic = format!("uagv/{level}/giveway/{serial}/connection");
        let kept = tokio::task::block_in_place(|| broker.retained("giveway", &topic));
        assert_eq!(kept["connectionState"], "OFFLINE", "{kept}");
    }
}

/// A request with a body, or with none.
async fn ask(at: SocketAddr, method: &str, path: &str, body: &Value) -> Answer {
    let json = [("content-type", "application/json")];
    let body = if body.is_null() { String::new() } else { body.to_string() };
    send(at, method, path, if body.is_empty() { &[] } else { &json }, &body).await.unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_is_killed_knows_robots_again_that_people_listed_and_whose_version_nobody_named() {
    let folder = Folder::new();
    let Some(broker) = Broker::start(&folder, None) else { return };
    let robots = [("2.1.0", "PW10"), ("3.0.0", "PE12")];
    let _robots = robots.map(|(version, node)| robot(&folder, &broker.url, version, node));
    let file = folder.path().join("robots.json");
    let kinds = json!({"giveway_robots": 1, "map_id": "thesis", "kinds": {"any": {}}, "robots": []});
    std::fs::write(&file, kinds.to_string()).unwrap();
    let (server, at) = serve(&folder, &broker.url, &file);
    let heard = async || {
        let all = get(at, "/v1/robots?unlisted=true").await.json();
        (all["unlisted"].as_array().map(Vec::len) == Some(2)).then_some(all)
    };
    let all = eventually("both are heard of", heard).await;
    assert_eq!((all["items"].as_array().map(Vec::len), &all["waiting"]), (Some(0), &json!([])));
    let list =
        |serial: &str| json!({"name": serial, "kind": "any", "manufacturer": "giveway", "serial": serial});
    for serial in ["v210", "v300"] {
        assert_eq!(ask(at, "POST", "/v1/robots", &list(serial)).await.status, 201);
        assert_eq!(ask(at, "POST", "/v1/robots", &list(serial)).await.status, 200);
    }
    let wrong = json!({"name": "x", "kind": "none", "manufacturer": "giveway", "serial": "x"});
    ask(at, "POST", "/v1/robots", &wrong).await.problem(409);
    ask(at, "POST", "/v1/robots", &json!({"name": "x", "node": "PW9", "serial": "x"})).await.problem(422);
    let ready = async |at: SocketAddr| {
        let v210 = get(at, "/v1/robots/v210/link").await.json();
        let v300 = get(at, "/v1/robots/v300/link").await.json();
        let versions = (&v210["version"], &v300["version"]) == (&json!("2.1.0"), &json!("3.0.0"));
        (versions && [&v210, &v300].iter().all(|v| v["joined"] == true && v["not_ready"].is_null()))
            .then_some(())
    };
    eventually("both are ready", async || ready(at).await).await;
    let sent = ask(at, "POST", "/v1/robots/v300/actions", &json!({"type": "stateRequest"})).await;
    assert_eq!(sent.status, 202);
    let fate = sent.header("location").expect("where its fate is").to_owned();
    let finished = async || (get(at, &fate).await.json()["status"] == "FINISHED").then_some(());
    eventually("the action is done", finished).await;
    ask(at, "POST", "/v1/robots/v300/actions", &json!({"type": "cancelOrder"})).await.problem(409);
    ask(at, "PUT", "/v1/robots/v300/consent", &Value::Null).await.problem(409);
    ask(at, "POST", "/v1/robots/v300/settled", &Value::Null).await.problem(409);
    get(at, "/v1/robots/nobody/link").await.problem(404);
    for rack in 1..=4 {
        let job = json!({"kind": "deliver", "rack": format!("K{rack}"), "station": "W"});
        assert_eq!(post(at, None, &job).await.unwrap().status, 201);
    }
    until_done(at, 1).await;
    drop(server);
    // What the robot said before it learned its version is still on the broker.
    let before = json!({"headerId": 1, "timestamp": "2026-01-01T00:00:00.000Z", "version": "2.0.0",
        "manufacturer": "giveway", "serialNumber": "v300", "connectionState": "OFFLINE"});
    tokio::task::block_in_place(|| broker.keep("uagv/v2/giveway/v300/connection", &before));
    let (_server, at) = serve(&folder, &broker.url, &file);
    until_done(at, 4).await;
    eventually("both are ready again", async || ready(at).await).await;
    let said = get(at, "/v1/robots/v300/messages").await.json();
    let said = said["messages"].as_array().expect("messages").clone();
    assert!(said.iter().any(|m| m["to_robot"] == true) && said.iter().any(|m| m["to_robot"] == false));
    // A robot that drives is retired. One that is not on the floor is listed no more.
    assert_eq!(ask(at, "DELETE", "/v1/robots/v300", &Value::Null).await.status, 204);
    assert_eq!(get(at, "/v1/robots/v300/link").await.json()["joined"], true);
    assert_eq!(ask(at, "POST", "/v1/robots", &list("nobody")).await.status, 201);
    assert_eq!(get(at, "/v1/robots/nobody/link").await.json()["joined"], false);
    assert_eq!(ask(at, "DELETE", "/v1/robots/nobody", &Value::Null).await.status, 204);
    get(at, "/v1/robots/nobody/link").await.problem(404);
}

#[test]
fn a_probe_finds_out_over_a_broker_that_a_robot_lies_and_does_not_move_it() {
    let folder = Folder::new();
    let Some(broker) = Broker::start(&folder, None) else { return };
    let (_robot, mut lines) =
        Process::giveway(&["robot", "--mqtt", &broker.url, "--map", MAP, "--like", "c"]);
    lines.find(|line| line.starts_with("robot ")).expect("a robot");
    let arguments = ["robot", "probe", "--mqtt", &broker.url, "--robot", "giveway/c-1", "--json"];
    let probed = Command::new(env!("CARGO_BIN_EXE_giveway")).args(arguments).output().unwrap();
    assert!(probed.status.success(), "{probed:?}");
    let found: Value = serde_json::from_slice(&probed.stdout).unwrap();
    let expected = json!({"version": "2.0.0", "factsheet": "invalid", "pause": "none", "cancel": "not tried",
        "actions": "silent", "repeat": "fatal", "alive": true});
    for (key, value) in expected.as_object().unwrap() {
        assert_eq!(&found[key], value, "{key}: {found:#}");
    }
    assert_eq!(found["kind"]["link"]["maps"], json!({"thesis": {}}), "{found:#}");
}

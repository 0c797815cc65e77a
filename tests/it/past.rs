//! What a server keeps of the past: it answers while it runs, and after it was killed.

use crate::helper::{Folder, config, eventually, floor, get, send, start};
use giveway::api::recording::lines;
use giveway::server::{Config, Server};
use serde_json::{Value, json};
use std::net::SocketAddr;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// Asks until there is a past of so many seconds.
async fn past(at: SocketAddr, seconds: f64) -> Value {
    eventually(&format!("there is a past of {seconds} s"), async || {
        let past = get(at, "/v1/past").await.json();
        let last = past["spans"].as_array().and_then(|spans| spans.last().cloned()).unwrap_or_default();
        last["to_s"].as_f64().is_some_and(|to| to >= seconds).then_some(past)
    })
    .await
}

/// The lines of a recording, by way of a file, as a person would keep it.
async fn recording(at: SocketAddr, folder: &Folder, query: &str) -> Vec<Value> {
    let mut stream = TcpStream::connect(at).await.unwrap();
    let ask = format!("GET /v1/past/reel?{query} HTTP/1.0\r\nhost: {at}\r\n\r\n");
    stream.write_all(ask.as_bytes()).await.unwrap();
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).await.unwrap();
    let head = bytes.windows(4).position(|w| w == b"\r\n\r\n").expect("headers end") + 4;
    let said = String::from_utf8_lossy(&bytes[..head]).to_lowercase();
    assert!(said.contains(" 200 ") && said.contains("content-type: application/gzip"), "{said}");
    let path = folder.path().join("answer.reel");
    std::fs::write(&path, &bytes[head..]).unwrap();
    lines(&path).unwrap().map(|line| serde_json::from_str(&line).unwrap()).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_shows_what_happened_before_and_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    past(at, 1.0).await;
    assert_eq!(send(at, "POST", "/v1/fleet/stop", &[], "").await.unwrap().status / 100, 2);
    let now = past(at, 1.0).await["now_s"].as_f64().unwrap();
    let kept = past(at, now + 1.0).await;
    let marks = kept["bookmarks"].as_array().unwrap();
    assert_eq!((marks.len(), &marks[0]["kind"]), (1, &json!("stop")), "{kept}");
    let found = recording(at, &folder, &format!("from=0&to={}", now + 1.0)).await;
    assert_eq!(found[0]["start"].as_f64().map(|s| s > 1e9), Some(true));
    assert!(found[0]["map"]["nodes"].is_array() && found[1].get("mark").is_some(), "{}", found[1]);
    // A quick client has the first picture before any robot has joined.
    let has_robots = |l: &Value| {
        let of = |kind: &str| l[kind]["robots"].as_array().is_some_and(|r| !r.is_empty());
        of("key") || of("patch")
    };
    assert!(found.iter().any(|l| l.get("key").is_some()), "no whole picture");
    assert!(found.iter().any(has_robots), "{found:?}");
    assert!(found.iter().any(|l| l.get("patch").is_some()));
    assert!(found.iter().any(|l| l["waiting"].is_array()) && found.iter().any(|l| l["sum"].is_object()));
    let sums = get(at, "/v1/past/figures?from=0&step=60").await.json();
    assert_eq!(sums["start"], kept["start"]);
    assert_eq!(
        (&sums["sums"][0]["covered_s"], &sums["sums"][0]["robot_deliveries"]),
        (&json!(0.0), &json!(0))
    );
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let kept = past(at, 0.5).await;
    let first = &kept["spans"][0];
    assert!(first["from_s"].as_f64() < Some(0.0), "{kept}");
    assert_eq!(kept["bookmarks"][0]["words"]["text"], "all robots were stopped by hand");
    // A restart may be so quick that both runs are one span.
    let [from, to] = [&first["from"], &kept["start"]].map(|t| t.as_str().unwrap());
    let query = format!("from={from}&to={to}&map=false");
    let found = recording(at, &folder, &query).await;
    assert!(found[0]["map"].is_null() && found.last().unwrap()["at"].as_f64() <= Some(0.0));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn wrong_spans_and_a_server_without_a_past_are_said_in_words() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    past(at, 0.4).await;
    for (query, field) in [("from=noon", "from"), ("from=0&to=soon", "to"), ("from=0&to=4000", "to")] {
        let problem = get(at, &format!("/v1/past/reel?{query}")).await.problem(422);
        assert_eq!(problem["errors"][0]["field"], field, "{problem}");
    }
    get(at, "/v1/past/reel?from=-90&to=-80").await.problem(404);
    get(at, "/v1/past?since=1").await.problem(400);
    get(at, "/v1/past/figures?map=false").await.problem(400);
    let problem = get(at, "/v1/past/figures?step=0").await.problem(422);
    assert_eq!(problem["errors"][0]["field"], "step");
    server.stop().await.unwrap();

    let folder = Folder::new();
    let none = Config { past_hours: 0, ..config(&folder) };
    let server = Server::start(&none, floor()).await.unwrap();
    let problem = get(server.address(), "/v1/past").await.problem(404);
    assert!(problem["detail"].as_str().unwrap().contains("--past-hours"), "{problem}");
    get(server.address(), "/v1/past/figures").await.problem(404);
    assert!(!folder.path().join("giveway.past").exists());
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn where_the_past_cannot_be_kept_the_fleet_goes_on() {
    let folder = Folder::new();
    // A file stands where the folder should be.
    std::fs::write(folder.path().join("giveway.past"), "in the way").unwrap();
    let server = start(&folder).await;
    assert_eq!(get(server.address(), "/v1/robots").await.status, 200);
    get(server.address(), "/v1/past").await.problem(404);
    server.stop().await.unwrap();

    let folder = Folder::new();
    let server = start(&folder).await;
    past(server.address(), 0.4).await;
    // Its folder is deleted while it writes: only the past is lost.
    std::fs::remove_dir_all(folder.path().join("giveway.past")).unwrap();
    assert_eq!(get(server.address(), "/v1/health").await.status, 200);
    server.stop().await.unwrap();
}

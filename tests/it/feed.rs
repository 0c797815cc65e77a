//! The feed of a headset over a real WebSocket, against a real server.

use crate::helper::{Folder, eventually, get, in_time, send, start_in_real_time};
use futures_util::{SinkExt, StreamExt};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::time::Instant;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async_with_config};

/// A headset as docs/headset.md describes it: its clock began a while ago.
pub struct Headset {
    socket: WebSocketStream<MaybeTlsStream<tokio::net::TcpStream>>,
    began: Instant,
    pub epoch: u64,
    pub seq: u64,
}

impl Headset {
    pub async fn open(at: SocketAddr, worker: &str) -> Result<Headset, Error> {
        let url = format!("ws://{at}/v1/workers/{worker}/feed");
        // As browsers do: small messages leave at once.
        let (socket, _) = connect_async_with_config(url, None, true).await?;
        Ok(Headset { socket, began: Instant::now() - Duration::from_secs(5), epoch: 1, seq: 0 })
    }

    /// Connected, greeted, with a known clock.
    pub async fn connect(at: SocketAddr, worker: &str, frame: &str) -> Headset {
        let mut headset = Headset::open(at, worker).await.unwrap();
        headset.say(json!({"type": "hello", "versions": [2, 7], "frame": frame})).await;
        headset.next("clock").await;
        headset
    }

    pub fn clock_ms(&self) -> f64 {
        self.began.elapsed().as_secs_f64() * 1000.0
    }

    pub async fn say(&mut self, message: Value) {
        self.socket.send(Message::Text(message.to_string().into())).await.unwrap();
    }

    /// A pose on the map, now.
    pub async fn stand(&mut self, x: f64, y: f64) {
        self.seq += 1;
        let (epoch, seq, t) = (self.epoch, self.seq, self.clock_ms());
        self.say(json!({"type": "pose", "epoch": epoch, "seq": seq, "t": t, "at": [x, y], "heading": 0.0}))
            .await;
    }

    /// The next message of any kind, with pings answered; `None` when the feed ends.
    pub async fn any(&mut self) -> Option<Value> {
        loop {
            let message = in_time("a message of the feed", self.socket.next()).await;
            match message {
                Some(Ok(Message::Text(text))) => {
                    let message: Value = serde_json::from_str(&text).unwrap();
                    if message["type"] != "ping" {
                        return Some(message);
                    }
                    let t = self.clock_ms();
                    self.say(json!({"type": "pong", "id": message["id"], "t1": t, "t2": t})).await;
                }
                Some(Ok(Message::Close(_)) | Err(_)) | None => return None,
                Some(Ok(_)) => {}
            }
        }
    }

    /// The next message of a kind.
    pub async fn next(&mut self, kind: &str) -> Value {
        loop {
            let message = self.any().await.unwrap_or_else(|| panic!("the feed ended before {kind}"));
            if message["type"] == kind {
                return message;
            }
        }
    }

    /// The text of the error with which the feed ends.
    pub async fn end(&mut self) -> String {
        let mut last = String::new();
        while let Some(message) = self.any().await {
            if message["type"] == "error" {
                // Bare text before the version is known, and in version 1.
                let text = &message["text"];
                last = text.as_str().or(text["text"].as_str()).unwrap().into();
            }
        }
        last
    }
}

pub async fn hire(at: SocketAddr, name: &str) -> String {
    let body = json!({"name": name}).to_string();
    let answer =
        send(at, "POST", "/v1/workers", &[("content-type", "application/json")], &body).await.unwrap();
    answer.json()["id"].as_str().unwrap().to_owned()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_headset_and_the_server_agree_on_a_version_or_part_with_a_reason() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let Err(Error::Http(response)) = Headset::open(at, "w1").await else { panic!("nobody is known yet") };
    assert_eq!(response.status().as_u16(), 404);
    hire(at, "anna").await;
    get(at, "/v1/workers/w1/feed").await.problem(426);
    let mut headset = Headset::open(at, "w1").await.unwrap();
    headset.say(json!({"type": "hello", "versions": [3, 1]})).await;
    let welcome = headset.next("welcome").await;
    assert_eq!((welcome["version"].clone(), welcome["aligned"].clone()), (json!(1), json!(false)));
    assert_eq!((welcome["worker"].clone(), welcome["name"].clone()), (json!("w1"), json!("anna")));
    assert!(headset.next("clock").await["error_ms"].as_f64().unwrap() < 1000.0);
    for (first, word) in [
        (json!({"type": "hello", "versions": [99]}), "versions [2, 1]"),
        (json!({"type": "hello", "versions": []}), "versions [2, 1]"),
        (json!({"type": "pose", "epoch": 1, "seq": 1, "t": 1}), "hello"),
        (json!({"type": "nonsense"}), "hello"),
    ] {
        let mut stranger = Headset::open(at, "w1").await.unwrap();
        stranger.say(first).await;
        let text = stranger.end().await;
        assert!(text.contains(word), "{text}");
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn marks_that_do_not_fit_are_refused_with_what_to_do_and_good_ones_begin_an_epoch() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut headset = Headset::connect(at, "w1", "device").await;
    let pose = |epoch: u64, t: f64| {
        let (pos, quat) = ([0.0, 1.6, 0.0], [0, 0, 0, 1]);
        json!({"type": "pose", "epoch": epoch, "seq": 1, "t": t, "pos": pos, "quat": quat})
    };
    headset.say(pose(1, headset.clock_ms())).await;
    assert_eq!(headset.next("warning").await["code"], "not-aligned");
    let anchor = |x: f64, z: f64, map: [f64; 2]| json!({"device": [x, 0, z], "map": map});
    let wrong = json!([anchor(0.0, 0.0, [5.0, 5.0]), anchor(10.0, 0.0, [5.0, 19.0])]);
    headset.say(json!({"type": "anchors", "pairs": wrong})).await;
    let refused = headset.next("refused").await;
    assert_eq!((refused["epoch"].clone(), refused["aligned"].clone()), (json!(1), json!(false)), "{refused}");
    assert!(
        !refused["remedy"]["text"].as_str().unwrap().is_empty()
            && refused["reason"]["text"].as_str().unwrap().contains("off")
    );
    headset.say(json!({"type": "anchors", "pairs": [{"device": [0, 0, 0], "mark": "nowhere"}]})).await;
    assert!(headset.next("refused").await["reason"]["text"].as_str().unwrap().contains("nowhere"));
    // Ahead of the device is the map's +x.
    let right = json!([anchor(0.0, 0.0, [5.0, 5.0]), anchor(0.0, -10.0, [15.0, 5.0])]);
    headset.say(json!({"type": "anchors", "pairs": right})).await;
    let aligned = headset.next("aligned").await;
    assert_eq!(aligned["epoch"], 2);
    assert!((aligned["theta"].as_f64().unwrap() + std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{aligned}");
    assert_eq!(aligned["provisional"], true, "two marks leave left and right open: {aligned}");
    let warning = headset.next("warning").await;
    assert_eq!(warning["code"], "one-line");
    assert!(
        warning["text"]["text"].as_str().unwrap().contains("at least 1 m"),
        "it says what to do: {warning}"
    );
    headset.say(pose(1, headset.clock_ms())).await;
    assert_eq!(headset.next("warning").await["code"], "old-epoch");
    headset.say(json!({"type": "reset"})).await;
    let epoch = headset.next("epoch").await;
    assert_eq!((epoch["epoch"].clone(), epoch["aligned"].clone()), (json!(3), json!(false)));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn bad_poses_are_told_once_in_a_while_and_counted() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut headset = Headset::connect(at, "w1", "map").await;
    headset.stand(5.0, 5.0).await;
    headset.seq -= 1;
    headset.stand(5.0, 5.0).await;
    assert_eq!(headset.next("warning").await["code"], "repeated");
    let future = headset.clock_ms() + 5000.0;
    headset.say(json!({"type": "pose", "epoch": 1, "seq": 9, "t": future, "at": [5, 5]})).await;
    assert_eq!(headset.next("warning").await["code"], "future");
    headset.say(json!({"type": "pose", "epoch": 1, "seq": 10, "t": 1, "at": [5, 1e9]})).await;
    assert_eq!(headset.next("warning").await["code"], "absurd");
    headset.say(json!({"type": "pose", "epoch": 1, "seq": 10, "t": 1, "at": "here"})).await;
    assert_eq!(headset.next("warning").await["code"], "unreadable");
    for _ in 0..50 {
        headset.say(json!({"nonsense": true})).await;
    }
    headset.say(json!({"type": "reset"})).await;
    loop {
        let message = headset.any().await.expect("fifty are forgiven");
        assert_ne!(message["code"], "unreadable", "told already");
        if message["type"] == "epoch" {
            break;
        }
    }
    let text = get(at, "/metrics").await.text;
    for line in [
        "giveway_poses_refused_total{reason=\"future\"} 1",
        "giveway_poses_refused_total{reason=\"absurd\"} 1",
        "giveway_poses_refused_total{reason=\"unreadable\"} 51",
        "giveway_feed_clients 1",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    for _ in 0..101 {
        headset.say(json!({"nonsense": true})).await;
    }
    assert!(headset.end().await.contains("could not be read"));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_second_headset_takes_the_place_of_the_first_and_tags_count_beside_it() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut first = Headset::connect(at, "w1", "map").await;
    let mut second = Headset::connect(at, "w1", "map").await;
    assert!(first.end().await.contains("another connection"));
    second.stand(5.0, 5.0).await;
    let battery = json!({"type": "pose", "epoch": 1, "seq": 9, "t": second.clock_ms(), "at": [5, 5], "battery": 0.5,
        "gaze": {"kind": "head", "origin": [5, 1.6, -5], "dir": [0, 0, -2]}, "hands": {"l": [[5, 1, -5, 0.01]]}});
    second.say(battery).await;
    second.say(json!({"type": "ack", "version": 0})).await;
    second.say(json!({"type": "reset"})).await;
    second.next("epoch").await;
    let worker = get(at, "/v1/workers/w1").await.json();
    assert_eq!(
        (worker["battery"].clone(), worker["connected"].clone()),
        (json!(0.5), json!(true)),
        "{worker}"
    );
    assert_eq!(worker["gaze"]["dir"], json!([0.0, 1.0, 0.0]), "the map's +y, level");
    assert_eq!(worker["hands"], json!({"l": [[5.0, 5.0, 1.0, 0.01]], "r": null}));
    let json = [("content-type", "application/json")];
    let tag = send(at, "POST", "/v1/workers/w1/position", &json, r#"{"x": 1, "y": 1}"#).await.unwrap();
    assert_eq!(tag.status, 202);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn guidance_comes_at_least_twice_a_second_whatever_happens() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut headset = Headset::connect(at, "w1", "map").await;
    headset.stand(5.0, 5.0).await;
    for _ in 0..4 {
        let message = tokio::time::timeout(Duration::from_secs(3), headset.next("guidance")).await.unwrap();
        for key in ["state", "version", "path", "near", "next", "eta_s", "reason", "pose"] {
            assert!(message.get(key).is_some(), "{key} of {message}");
        }
    }
    let heard = headset.next("guidance").await;
    assert_eq!(heard["pose"], json!({"epoch": 1, "seq": 1}), "the pose that was taken into account");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_open_feed_does_not_hold_the_server_up() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut headset = Headset::connect(at, "w1", "map").await;
    let reader = tokio::spawn(async move { headset.end().await });
    in_time("it goes down", server.stop()).await.unwrap();
    assert!(reader.await.unwrap().contains("shutting down"));
}

/// Waits until the worker's entry says so.
async fn wait_for(at: SocketAddr, headset: &mut Headset, what: &str, is_so: impl Fn(&Value) -> bool) {
    eventually(what, async || {
        let worker = get(at, "/v1/workers/w1").await.json();
        if is_so(&worker) {
            return Some(());
        }
        headset.next("guidance").await;
        None
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn poses_that_came_in_show_where_the_worker_is() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut headset = Headset::connect(at, "w1", "map").await;
    headset.stand(5.0, 5.0).await;
    headset.stand(5.0, 5.0).await;
    wait_for(at, &mut headset, "tracked", |w| w["presence"] == "tracked").await;
    let worker = get(at, "/v1/workers/w1").await.json();
    assert!((worker["x"].as_f64().unwrap() - 5.0).abs() < 0.5, "{worker}");
    assert!(worker["regions"][0].as_f64().unwrap() > 0.2, "{worker}");
    // On a busy machine the worker may be lost again by the time that is asked for.
    let counted = async || {
        headset.stand(5.0, 5.0).await;
        let live = get(at, "/metrics").await.text;
        live.contains("giveway_workers{state=\"tracked\"} 1").then_some(())
    };
    eventually("the worker is counted", counted).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn repeated_and_late_poses_are_counted_once_and_change_nothing() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut headset = Headset::connect(at, "w1", "map").await;
    headset.stand(5.0, 5.0).await;
    let t = headset.clock_ms();
    for seq in [2, 2, 2, 1] {
        headset.say(json!({"type": "pose", "epoch": 1, "seq": seq, "t": t, "at": [5.1, 5]})).await;
    }
    wait_for(at, &mut headset, "late", |w| w["feed"]["late"] == 3 && w["feed"]["taken"] == 2).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn poses_across_the_hall_and_outside_of_it_are_counted_and_told() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let mut headset = Headset::connect(at, "w1", "map").await;
    for _ in 0..5 {
        headset.stand(0.5, 0.5).await;
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    headset.stand(5.5, 4.5).await;
    assert_eq!(headset.next("warning").await["code"], "jump");
    headset.stand(55.0, 4.5).await;
    assert_eq!(headset.next("warning").await["code"], "impossible");
    let worker = get(at, "/v1/workers/w1").await.json();
    assert_eq!((worker["feed"]["jumps"].clone(), worker["feed"]["absurd"].clone()), (json!(1), json!(1)));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_with_an_assignment_gets_a_path_and_is_done_at_its_end() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let map = crate::helper::map();
    let station = map.nodes[map.stations.iter().next().unwrap().node].clone();
    let mut headset = Headset::connect(at, "w1", "map").await;
    headset.stand(station.at.x, station.at.y).await;
    let body = json!({"place": station.name, "stay_s": 0.5}).to_string();
    let json = [("content-type", "application/json")];
    let made = send(at, "POST", "/v1/workers/w1/assignments", &json, &body).await.unwrap();
    assert_eq!(made.status, 201, "{made:?}");
    let mut followed = false;
    for _ in 0..200 {
        let message = headset.next("guidance").await;
        followed |= message["assignment"] == "a1";
        if let Some(next) = message["next"].as_array() {
            headset.stand(next[0].as_f64().unwrap(), next[1].as_f64().unwrap()).await;
        } else {
            headset.stand(station.at.x, station.at.y).await;
        }
        if get(at, "/v1/assignments/a1").await.json()["state"] == "done" {
            assert!(followed, "it was shown the way, or that it is there");
            return server.stop().await.unwrap();
        }
    }
    panic!("never done");
}

#[tokio::test]
async fn who_says_to_be_done_is_done_wherever_the_device_believes_to_be() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    hire(at, "ben").await;
    let map = crate::helper::map();
    let at_name = |name: &str| map.nodes[map.node_named(name).unwrap()].clone();
    let (here, there) = (at_name("R106"), at_name("R111"));
    let mut headset = Headset::connect(at, "w1", "map").await;
    headset.stand(here.at.x, here.at.y).await;
    let json = [("content-type", "application/json")];
    for worker in ["w1", "w2"] {
        let body = json!({"place": there.name, "stay_s": 600}).to_string();
        let made =
            send(at, "POST", &format!("/v1/workers/{worker}/assignments"), &json, &body).await.unwrap();
        assert_eq!(made.status, 201, "{made:?}");
    }
    let told = loop {
        let told = headset.next("guidance").await;
        if told["assignment"] == "a1" {
            break told;
        }
    };
    assert_eq!((&told["arrived"], &told["cause"]), (&json!(false), &json!(null)), "{told}");
    headset.say(json!({"type": "done", "assignment": "a1"})).await;
    assert_eq!(headset.next("done").await, json!({"type": "done", "assignment": "a1", "refused": null}));
    assert_eq!(get(at, "/v1/assignments/a1").await.json()["state"], "done");
    while !headset.next("guidance").await["assignment"].is_null() {}

    for not_hers in ["a1", "a2", "a77"] {
        headset.say(json!({"type": "done", "assignment": not_hers})).await;
        let answer = headset.next("done").await;
        assert!(answer["refused"]["text"].as_str().is_some_and(|why| why.contains("over")), "{answer}");
    }
    headset.say(json!({"type": "done", "assignment": "everything"})).await;
    assert_eq!(headset.next("warning").await["code"], "done");
    assert_ne!(get(at, "/v1/assignments/a2").await.json()["state"], "done", "that is another's");

    let said = send(at, "POST", "/v1/assignments/a2/done", &json, "").await.unwrap();
    assert_eq!((said.status, &said.json()["state"]), (200, &json!("done")));
    assert_eq!(send(at, "POST", "/v1/assignments/a2/done", &json, "").await.unwrap().status, 409);
    assert_eq!(send(at, "POST", "/v1/assignments/a77/done", &json, "").await.unwrap().status, 404);
    server.stop().await.unwrap();
}

/// Waits until a worker is known so, and gives the worker.
async fn until_presence(at: SocketAddr, worker: &str, presence: &str) -> Value {
    let path = format!("/v1/workers/{worker}");
    let becomes = async || Some(get(at, &path).await.json()).filter(|seen| seen["presence"] == presence);
    eventually(&format!("{worker} becomes {presence}"), becomes).await
}

#[tokio::test(flavor = "multi_thread")]
async fn who_takes_the_headset_off_is_lost_at_once_and_a_supervisor_narrows_then_clears_that() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let post = async |path: &str, body: Value| {
        let json = ("content-type", "application/json");
        send(at, "POST", &format!("/v1/workers/{path}"), &[json], &body.to_string()).await.unwrap()
    };
    send(at, "POST", "/v1/workers", &[("content-type", "application/json")], r#"{"name": "anna"}"#)
        .await
        .unwrap();
    let node = crate::helper::map();
    let place = node.nodes[node.stations.iter().next().unwrap().node].at;
    let mut headset = Headset::connect(at, "w1", "map").await;
    headset.stand(place.x, place.y).await;
    until_presence(at, "w1", "tracked").await;
    let wanted = json!({"by": "Ben", "at": [place.x, place.y], "within_m": 0.8});
    assert_eq!(post("w1/narrow", wanted.clone()).await.problem(409)["type"], "/problems/worker-not-lost");
    headset.say(json!({"type": "bye"})).await;
    while headset.any().await.is_some() {}
    until_presence(at, "w1", "lost").await;
    tokio::time::sleep(Duration::from_secs(3)).await;
    let wide = until_presence(at, "w1", "lost").await["area"].as_array().unwrap().len();
    for (wrong, field) in [
        (json!({"at": [place.x, place.y], "within_m": 0.8, "by": ""}), "by"),
        (json!({"by": "Ben", "within_m": 0.8}), "at"),
        (json!({"by": "Ben", "node": "nowhere", "within_m": 0.8}), "node"),
        (json!({"by": "Ben", "at": [place.x, place.y], "within_m": 80}), "within_m"),
        (json!({"by": "Ben", "at": [5000, 5000], "within_m": 2}), "at"),
    ] {
        assert_eq!(post("w1/narrow", wrong).await.problem(422)["errors"][0]["field"], field);
    }
    assert_eq!(post("w1/narrow", wanted).await.status, 204);
    tokio::time::sleep(Duration::from_millis(300)).await;
    let narrow = until_presence(at, "w1", "lost").await["area"].as_array().unwrap().len();
    assert!(0 < narrow && narrow < wide, "{narrow} of {wide} places");
    server.stop().await.unwrap();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let after = until_presence(at, "w1", "lost").await;
    assert_eq!(after["area"].as_array().unwrap().len(), narrow, "a restart forgets neither: {after}");
    let cleared =
        send(at, "POST", "/v1/workers/w1/clear", &[("content-type", "application/json")], r#"{"by": "Ben"}"#);
    assert_eq!(cleared.await.unwrap().status, 204);
    until_presence(at, "w1", "absent").await;
    server.stop().await.unwrap();
}

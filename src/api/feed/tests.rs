//! A connection over a real socket; the test plays the fleet.

use super::hub::{Feeds, HeardSighting};
use crate::access::audit::AuditLog;
use crate::access::auth::Gate;
use crate::access::caller::Caller;
use crate::feed::massrobotics::Interop;
use crate::live::Live;
use crate::port::Later;
use crate::port::moment::{FloorSimulation, Moment, SharedHistory};
use crate::port::questions::Question;
use crate::router;
use crate::state::alarms::Alarms;
use crate::state::api::Api;
use crate::state::metrics::Metrics;
use crate::state::records::Records;
use futures_util::{SinkExt, StreamExt};
use giveway_fleet::alarm::{Alarm, AlarmQuery};
use giveway_fleet::{
    AssignmentQuery, AssignmentRow, EncounterQuery, EncounterRow, Guidance, GuidanceReason, GuidanceState,
    JobQuery, JobRow, Listed, RobotEventQuery, RobotEventRow, RobotJobCounts, ShiftRows, View,
};
use giveway_floor::geometry::Point;
use giveway_floor::id::{AssignmentId, IdVec, JobId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::human::{SightingOutcome, Track};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::sync::{mpsc, watch};
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

const ANNA: WorkerId = WorkerId(0);

/// An empty store.
struct Nothing;

impl Records for Nothing {
    fn alarms(&self, _: AlarmQuery) -> Later<'_, Result<Vec<Alarm>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }

    fn job(&self, _: JobId) -> Later<'_, Result<Option<JobRow>, String>> {
        Box::pin(async { Ok(None) })
    }
    fn jobs(&self, _: JobQuery) -> Later<'_, Result<Listed<JobRow, JobId>, String>> {
        Box::pin(async { Ok(Listed { rows: Vec::new(), next: None }) })
    }
    fn assignment(&self, _: AssignmentId) -> Later<'_, Result<Option<AssignmentRow>, String>> {
        Box::pin(async { Ok(None) })
    }
    fn assignments(
        &self,
        _: AssignmentQuery,
    ) -> Later<'_, Result<Listed<AssignmentRow, AssignmentId>, String>> {
        Box::pin(async { Ok(Listed { rows: Vec::new(), next: None }) })
    }
    fn encounters(&self, _: EncounterQuery) -> Later<'_, Result<Listed<EncounterRow, i64>, String>> {
        Box::pin(async { Ok(Listed { rows: Vec::new(), next: None }) })
    }
    fn robot_events(&self, _: RobotEventQuery) -> Later<'_, Result<Vec<RobotEventRow>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
    fn shift(&self, _: (Time, Time), _: Time) -> Later<'_, Result<ShiftRows, String>> {
        Box::pin(async { Ok(ShiftRows::default()) })
    }
    fn robot_jobs(&self, _: RobotId) -> Later<'_, Result<RobotJobCounts, String>> {
        Box::pin(async { Ok(RobotJobCounts::default()) })
    }
}

/// A server without a fleet; its clock stands still unless the test moves it.
struct TestServer {
    at: SocketAddr,
    feeds: Arc<Feeds>,
    heard: mpsc::Receiver<HeardSighting>,
    questions: mpsc::Receiver<Question>,
    clock: Arc<AtomicI64>,
    metrics: Arc<Metrics>,
    moments: watch::Sender<Arc<Moment>>,
    _closing: watch::Sender<bool>,
}

impl TestServer {
    async fn new() -> TestServer {
        let map =
            giveway_floor::warehouse::formats::json::parse(include_str!("../../../maps/lab.json")).unwrap();
        let map = Arc::new(map);
        let (feeds, heard) = Feeds::new();
        feeds.know(&IdVec::from(vec!["anna".to_owned()]));
        let feeds = Arc::new(feeds);
        let (moments, picture) = watch::channel(Arc::new(Moment::default()));
        let (closing, closes) = watch::channel(false);
        let clock = Arc::new(AtomicI64::new(1_800_000_000_000_000));
        let (asked, questions) = mpsc::channel(1);
        let (ticks, metrics) = (clock.clone(), Arc::new(Metrics::default()));
        let api = Api {
            map: map.clone(),
            kind_checks: Default::default(),
            moments: picture,
            records: Arc::new(Nothing),
            figures: Arc::new(SharedHistory::new(Time::ZERO, "giveway", Default::default())),
            queue: Some(mpsc::channel(1).0),
            hooks: None,
            link: None,
            questions: asked,
            alarms: Arc::new(Alarms::default()),
            past: None,
            live: Arc::new(Live::new(map, 1)),
            feeds: feeds.clone(),
            pseudonyms: Arc::default(),
            interop: Arc::new(Interop::default()),
            now: Arc::new(move || Time(ticks.fetch_add(1, Ordering::Relaxed))),
            metrics: metrics.clone(),
            trials: crate::port::trial::Trials::default(),
            maps: crate::state::publish::MapPort::default(),
            gate: Arc::new(Gate::default()),
            oidc: None,
            tokens: None,
            answers: None,
            audit: Arc::new(AuditLog::new(0).0),
            caller: Arc::new(Caller::this_machine()),
            entry: None,
            closing: closes,
        };
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let at = listener.local_addr().unwrap();
        tokio::spawn(async move { axum::serve(listener, router(api).0).await });
        TestServer { at, feeds, heard, questions, clock, metrics, moments, _closing: closing }
    }

    fn now(&self) -> Time {
        Time(self.clock.load(Ordering::Relaxed))
    }

    async fn connect(&self, frame: &str) -> Client {
        let (socket, _) = connect_async(format!("ws://{}/v1/workers/w1/feed", self.at)).await.unwrap();
        let mut client = Client { socket };
        client.say(json!({"type": "hello", "versions": [2], "frame": frame})).await;
        client
    }
}

struct Client {
    socket: WebSocketStream<MaybeTlsStream<tokio::net::TcpStream>>,
}

impl Client {
    async fn say(&mut self, message: Value) {
        self.socket.send(Message::Text(message.to_string().into())).await.unwrap();
    }

    /// The next message of this type; answers pings in between, with a clock that always reads 5000 ms.
    async fn next(&mut self, kind: &str) -> Value {
        loop {
            let message = tokio::time::timeout(std::time::Duration::from_secs(5), self.socket.next()).await;
            let Message::Text(text) = message.expect("a message in time").unwrap().unwrap() else { continue };
            let message: Value = serde_json::from_str(&text).unwrap();
            if message["type"] == "ping" {
                self.say(json!({"type": "pong", "id": message["id"], "t1": 5000.0, "t2": 5000.0})).await;
            }
            if message["type"] == kind {
                return message;
            }
        }
    }
}

fn told(state: GuidanceState, version: u64) -> Guidance {
    Guidance {
        state,
        reason: Some(GuidanceReason::NoWay),
        version,
        path: vec![Point::new(1.0, 2.0)],
        next: None,
        eta: None,
        wait: None,
        assignment: None,
        arrived: false,
        near: vec![],
    }
}

#[tokio::test]
async fn a_stop_leaves_at_once_and_says_which_pose_it_was_decided_with() {
    let mut stage = TestServer::new().await;
    let mut anna = stage.connect("map").await;
    anna.next("clock").await;
    anna.say(json!({"type": "pose", "epoch": 1, "seq": 7, "t": 5000.0, "at": [3.0, 4.0]})).await;
    let heard = stage.heard.recv().await.unwrap();
    assert_eq!((heard.sighting.worker, heard.sighting.at), (ANNA, Point::new(3.0, 4.0)));
    // From here on the clock stands still, so that nothing is sent because it is due.
    stage.feeds.tell(stage.now(), vec![(ANNA, told(GuidanceState::Stop, 1))]);
    let stop = loop {
        let message = anna.next("guidance").await;
        if message["state"] == "stop" {
            break message;
        }
    };
    assert_eq!(stop["reason"]["text"], "no path to the place is free");
    assert_eq!(stop["reason"]["code"], "no_way");
    assert_eq!(stop["cause"], json!({"kind": "no_way", "robot": null, "closure": null}));
    assert_eq!(stop["pose"], json!({"epoch": 1, "seq": 7}));
    let text = stage.metrics.text(&Moment::default());
    assert!(text.contains("giveway_pose_to_stop_seconds_count 1"), "{text}");
}

#[tokio::test]
async fn a_floor_that_runs_faster_than_a_person_walks_refuses_a_headset_and_says_why() {
    let stage = TestServer::new().await;
    let simulation = Some(FloorSimulation { speed: 4 });
    stage.moments.send_replace(Arc::new(Moment { simulation, ..Moment::default() }));
    let refusal = stage.connect("map").await.next("error").await;
    let text = &refusal["text"];
    assert_eq!((&text["code"], &text["args"]["speed"]), (&json!("floor_is_fast"), &json!(4)));
}

#[tokio::test]
async fn guidance_that_does_not_change_leaves_four_times_a_second_and_only_the_newest() {
    let stage = TestServer::new().await;
    let mut anna = stage.connect("map").await;
    assert_eq!(anna.next("guidance").await["state"], "idle", "nothing to say is said, too");
    for version in 1..=100 {
        stage.feeds.tell(stage.now(), vec![(ANNA, told(GuidanceState::Following, version))]);
    }
    let first = anna.next("guidance").await["version"].as_u64().unwrap();
    assert_eq!(first, 100, "of what came between two messages, the newest");
    stage.feeds.tell(stage.now(), vec![(ANNA, told(GuidanceState::Following, 100))]);
    stage.feeds.tell(stage.now(), vec![(ANNA, told(GuidanceState::Deviating, 100))]);
    assert_eq!(anna.next("guidance").await["state"], "deviating", "the one that is the same was left out");
    stage.clock.fetch_add(Span::from_millis(300).0, Ordering::Relaxed);
    let lab = giveway_floor::warehouse::formats::json::parse(include_str!("../../../maps/lab.json")).unwrap();
    stage.feeds.refresh(&View { now: stage.now(), ..View::default() }, &lab);
    assert_eq!(anna.next("guidance").await["state"], "idle");
}

#[tokio::test]
async fn a_new_socket_is_no_new_person() {
    let mut stage = TestServer::new().await;
    let mut track = Track::default();
    let mut seen = Vec::new();
    // Two devices one after the other; the second reports the worker ten metres away.
    for (x, poses, later) in [(3.0, 3, 0.0), (13.0, 4, 20.0)] {
        let mut anna = stage.connect("map").await;
        anna.next("clock").await;
        for seq in 1..=poses {
            // The client's clock stands still: only the number distinguishes poses. The second device may be asked for
            // its clock within the same millisecond as the first.
            let t = 5000.0 + later + seq as f64;
            anna.say(json!({"type": "pose", "epoch": 1, "seq": seq, "t": t, "at": [x, 4.0]})).await;
            let heard = stage.heard.recv().await.unwrap();
            assert!(!heard.sighting.at_marks);
            seen.push(track.see(&heard.sighting, heard.received, |_| true));
        }
    }
    let (moved, ignored) = (SightingOutcome::Moved, SightingOutcome::Ignored);
    assert_eq!(seen[1..], [moved, moved, ignored, ignored, ignored, ignored]);
    let (place, counts) = (track.whereabouts(stage.now()).unwrap(), track.counts());
    assert_eq!((place.at, counts.jumps), (Point::new(3.0, 4.0), 4), "it neither moved her nor began anew");
}

#[tokio::test]
async fn an_acknowledgement_is_kept_for_those_who_ask() {
    let stage = TestServer::new().await;
    let mut anna = stage.connect("map").await;
    anna.next("welcome").await;
    anna.say(json!({"type": "ack", "version": 12})).await;
    anna.say(json!({"type": "reset"})).await;
    anna.next("epoch").await;
    let carried = stage.feeds.carried(ANNA).unwrap();
    assert_eq!((carried.acknowledged, carried.connected), (Some(12), true));
}

/// Joints of a hand in WebXR axes, near a person at (3, 4).
fn joints(x: f64) -> Value {
    json!((0..25).map(|i| [x + 0.004 * f64::from(i), 1.2, -4.3, 0.01]).collect::<Vec<_>>())
}

#[tokio::test]
async fn a_null_joint_drops_its_hand_alone_and_the_wearer_is_told() {
    let mut stage = TestServer::new().await;
    let mut anna = stage.connect("map").await;
    anna.next("clock").await;
    let mut unknown = joints(3.2);
    unknown[7][1] = Value::Null;
    let mut short = joints(3.2);
    short[7].as_array_mut().unwrap().pop();
    for (seq, bad) in [unknown, short, json!("here")].into_iter().enumerate() {
        let hands = json!({"l": joints(2.8 + 0.01 * seq as f64), "r": bad});
        let at =
            json!({"type": "pose", "epoch": 1, "seq": seq + 1, "t": 5000.0 + seq as f64, "at": [3.0, 4.0]});
        let mut pose = at.clone();
        pose["hands"] = hands;
        anna.say(pose).await;
        let heard = stage.heard.recv().await.unwrap();
        assert_eq!(heard.sighting.at, Point::new(3.0, 4.0), "the pose counts");
        let hands = heard.hands.expect("the left hand counts").hands;
        assert_eq!(hands.map(|hand| hand.is_some()), [true, false]);
    }
    let warning = anna.next("warning").await;
    assert_eq!((&warning["code"], &warning["count"]), (&json!("hands"), &json!(1)), "the first at once");
    assert!(warning["text"]["text"].as_str().unwrap().contains("no four numbers"), "{warning}");
    let text = stage.metrics.text(&Moment::default());
    assert!(text.contains("giveway_hands_refused_total 3"), "{text}");
    assert!(!text.contains("unreadable"), "{text}");
}

#[tokio::test]
async fn hands_that_cannot_be_are_not_seen_and_the_wearer_is_told() {
    let mut stage = TestServer::new().await;
    let mut anna = stage.connect("map").await;
    anna.next("clock").await;
    let (step_ms, mut ms) = (250, 0);
    let many = json!(vec![[3.2, 1.2, -4.3, 0.01]; 40]);
    let mut frames = vec![
        ("both hands", 50, joints(2.8), joints(3.2), [true, true]),
        ("left and right changed places", 50, joints(3.21), joints(2.81), [false, false]),
        ("and changed back", 50, joints(2.8), joints(3.2), [true, true]),
        ("too many joints", 50, joints(2.81), many, [true, false]),
        ("far from any shoulder", 50, joints(2.8), joints(6.0), [true, false]),
    ];
    for i in 0..5 {
        let left = joints(2.8 + 0.001 * f64::from(i));
        frames.push(("the right one does not tremble", step_ms, left, joints(3.2), [true, i < 4]));
    }
    for (seq, (what, after_ms, l, r, expected)) in frames.into_iter().enumerate() {
        stage.clock.fetch_add(Span::from_millis(after_ms).0, Ordering::Relaxed);
        ms += after_ms;
        let (t, hands) = (5000 + ms, json!({"l": l, "r": r}));
        let pose =
            json!({"type": "pose", "epoch": 1, "seq": seq + 1, "t": t, "at": [3.0, 4.0], "hands": hands});
        anna.say(pose).await;
        let heard = stage.heard.recv().await.unwrap();
        let hands = heard.hands.map_or([false; 2], |heard| heard.hands.map(|hand| hand.is_some()));
        assert_eq!((heard.sighting.at, hands), (Point::new(3.0, 4.0), expected), "{what}");
    }
    let warning = anna.next("warning").await;
    assert_eq!((&warning["code"], &warning["count"]), (&json!("hands"), &json!(2)), "{warning}");
    assert!(warning["text"]["text"].as_str().unwrap().contains("left and right changed places"), "{warning}");
    let text = stage.metrics.text(&Moment::default());
    assert!(text.contains("giveway_hands_refused_total 5"), "{text}");
}

#[tokio::test]
async fn a_question_beyond_those_that_may_wait_is_refused_until_one_is_answered() {
    let mut server = TestServer::new().await;
    let at = server.at;
    let ask = move || async move {
        let mut stream = tokio::net::TcpStream::connect(at).await.unwrap();
        let request = format!(
            "GET /v1/timelines?x0=0&y0=0&x1=1&y1=1 HTTP/1.1\r\nhost: {at}\r\nconnection: close\r\n\r\n"
        );
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).await.unwrap();
        answer.to_lowercase()
    };
    let first = tokio::spawn(ask());
    while server.questions.is_empty() {
        tokio::task::yield_now().await;
    }
    let busy = ask().await;
    assert!(busy.starts_with("http/1.1 503") && busy.contains("retry-after: 1\r\n"), "{busy}");
    // The answer never comes.
    drop(server.questions.recv().await);
    assert!(first.await.unwrap().starts_with("http/1.1 503"));
    assert!(server.questions.is_empty());
}

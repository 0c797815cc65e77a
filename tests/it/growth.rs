//! What fills to its limit, and gets room again: the tables of the database that no fleet bounds.

use crate::helper::{Answer, Folder, eventually, get, map, send, start_in_real_time};
use crate::live::connect;
use crate::people::{delete, post};
use futures_util::StreamExt;
use giveway::alarm::{Alarm, AlarmKind, AlarmQuery, AlarmSubject, SubjectKind};
use giveway::fleet::{EventKind, EventQuery, Fact, FloorFact};
use giveway::store::{MOST_OVER, MOST_PAST, SessionRow, StepEntry, Store, TokenDraft};
use giveway::text::Sentence;
use giveway::time::{Span, Time};
use serde_json::json;
use std::net::SocketAddr;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::task::JoinHandle;
use tokio_tungstenite::tungstenite::Error;

const DAY: Span = Span::from_secs(24 * 3600);
const AT: Time = Time(1_800_000_000_000_000);

async fn store(folder: &Folder) -> Store {
    Store::open(&folder.database(), &map()).await.unwrap()
}

fn halts(at: Time, count: usize) -> StepEntry {
    let facts = vec![Fact::Floor(FloorFact::Halted { robot: None, at }); count];
    StepEntry { at, facts, causes: Vec::new() }
}

#[tokio::test]
async fn events_are_forgotten_after_a_week_from_the_first_on() {
    let folder = Folder::new();
    let store = store(&folder).await;
    store.append(1, &[halts(AT, 500)]).await.unwrap();
    store.append(2, &[halts(AT + DAY * 6, 3)]).await.unwrap();
    assert_eq!(store.event_span().await.unwrap().before, 0, "nothing is too old");
    let all = EventQuery { kinds: vec![EventKind::Fleet], after: 0, limit: 1000 };
    let mut left = Vec::new();
    for step in 3..7 {
        store.append(step, &[halts(AT + DAY * 8, 1)]).await.unwrap();
        let span = store.event_span().await.unwrap();
        assert_eq!(store.events(&all).await.unwrap()[0].seq, span.before + 1, "none is missing between");
        left.push(span.last - span.before);
    }
    assert_eq!(left, [304, 105, 6, 7], "a slice with each step, until what is a week old is gone");
    store.close().await;
}

#[tokio::test]
async fn of_alarms_that_are_over_the_newest_are_kept() {
    let folder = Folder::new();
    let store = store(&folder).await;
    let alarm = |id: i64| {
        let since = AT + Span(id);
        Alarm {
            id: id.unsigned_abs(),
            kind: AlarmKind::Journal,
            severity: AlarmKind::Journal.severity(),
            subject: AlarmSubject::new(SubjectKind::Server, String::new()),
            text: Sentence::without_code("slow"),
            remedy: Sentence::without_code("make room"),
            at: None,
            waiting: 0,
            since,
            acknowledged: None,
            shelved: None,
            notes: Vec::new(),
            group: None,
            members: Vec::new(),
            cleared: (id > 1).then_some(since + Span(1)),
        }
    };
    let all: Vec<Alarm> = (1..=MOST_PAST + 50).map(alarm).collect();
    for some in all.chunks(5_000) {
        store.keep_alarms(some).await.unwrap();
    }
    let query = AlarmQuery { from: None, to: None, group: None, before: None, limit: 30_000 };
    let kept = store.alarms(&query).await.unwrap();
    assert_eq!(kept.len() as i64, MOST_PAST + 1, "and the one that is active");
    assert_eq!(kept.last().unwrap().id, 1);
    store.close().await;
}

#[tokio::test]
async fn of_sessions_the_newest_are_kept() {
    let folder = Folder::new();
    let store = store(&folder).await;
    for n in 0..110_i64 {
        for token in [1_u8, 2] {
            let hash = (2 * n + i64::from(token)).to_le_bytes().repeat(4);
            let created = AT + Span(n);
            let row =
                SessionRow { hash, token: vec![token; 32], person: None, created, expires: created + DAY };
            store.add_session(&row).await.unwrap();
        }
    }
    let kept = store.sessions().await.unwrap();
    assert_eq!(kept.len(), 200, "100 of each token");
    assert_eq!(kept.iter().map(|s| s.created).min(), Some(AT + Span(10)), "the oldest end first");
    store.end_session(&kept[0].hash).await.unwrap();
    assert_eq!(store.sessions().await.unwrap().len(), 199);
    store.close().await;
}

#[tokio::test]
async fn of_messages_that_were_given_up_the_newest_are_kept() {
    let folder = Folder::new();
    let store = store(&folder).await;
    let hook = store.add_webhook("http://127.0.0.1:9/", &[], "secret", AT).await.unwrap().id;
    for n in 1..=1_005 {
        store.webhook_missed(hook, n, "nobody there").await.unwrap();
        store.webhook_given_up(hook, (n, n), AT).await.unwrap();
    }
    let kept = store.webhook_failures(hook, None, 2_000).await.unwrap();
    assert_eq!((kept.len(), kept[0].last, kept[999].last), (1_000, 1_005, 6));
    assert!(store.remove_webhook(hook).await.unwrap());
    assert!(store.webhook_failures(hook, None, 10).await.unwrap().is_empty(), "they go with it");
    store.close().await;
}

#[tokio::test]
async fn answers_are_forgotten_after_seven_days() {
    let folder = Folder::new();
    let store = store(&folder).await;
    for n in 0..300 {
        let key = format!("key-{n}");
        assert_eq!(store.begin_keyed(["wms", "POST /v1/closures", &key], "body", AT).await.unwrap(), None);
    }
    let again = ["wms", "POST /v1/closures", "key-7"];
    assert!(store.begin_keyed(again, "body", AT + DAY * 6).await.unwrap().is_some(), "it is known");
    assert_eq!(store.begin_keyed(again, "body", AT + DAY * 8).await.unwrap(), None, "it is not any more");
    store.close().await;
}

/// A limit is reached, and whether it is worth another try later by itself.
fn is_full(answer: &Answer, again: bool) {
    let detail = answer.problem(429)["detail"].as_str().unwrap().to_owned();
    assert!(detail.contains("limit"), "{detail}");
    assert_eq!(answer.header("retry-after").is_some(), again, "{answer:?}");
}

fn token(n: i64) -> TokenDraft {
    let mut hash = [0; 32];
    hash[..8].copy_from_slice(&n.to_le_bytes());
    let (name, role) = (format!("system {n}"), "viewer".into());
    TokenDraft { name, role, subject: None, hash, created: AT + Span(n), expires: None }
}

#[tokio::test(flavor = "multi_thread")]
async fn of_tokens_a_thousand_hold_until_one_is_revoked_and_the_newest_that_hold_no_more_are_kept() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let (at, table) = (server.address(), server.store().tokens());
    for n in 0..MOST_OVER + 5 {
        let id = table.add(&token(n)).await.unwrap().unwrap();
        assert!(table.revoke(id, AT + Span(n)).await.unwrap());
    }
    for n in 0..1_000 {
        table.add(&token(2_000 + n)).await.unwrap().unwrap();
    }
    let all = table.all().await.unwrap();
    assert_eq!(all.len(), 2_000, "those that hold, and as many that do not");
    assert_eq!(all[0].name, "system 5", "the oldest of those went first");
    let more = json!({"name": "one more", "role": "viewer"});
    is_full(&post(at, "/v1/tokens", &more).await, false);
    assert_eq!(delete(at, "/v1/tokens/t1500").await.status, 204);
    assert_eq!(post(at, "/v1/tokens", &more).await.status, 201);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn of_webhooks_there_are_thirty_two_until_one_is_removed() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let hook = json!({"url": "http://127.0.0.1:9/"});
    let mut last = String::new();
    for _ in 0..32 {
        let made = post(at, "/v1/webhooks", &hook).await;
        assert_eq!(made.status, 201, "{made:?}");
        last = made.json()["id"].as_str().unwrap().to_owned();
    }
    is_full(&post(at, "/v1/webhooks", &hook).await, false);
    assert_eq!(delete(at, &format!("/v1/webhooks/{last}")).await.status, 204);
    assert_eq!(post(at, "/v1/webhooks", &hook).await.status, 201);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn of_kinds_of_robots_there_are_thirty_two_until_one_is_removed() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let put = |n: usize| async move {
        let headers = [("content-type", "application/json")];
        send(at, "PUT", &format!("/v1/kinds/kind-{n}"), &headers, "{}").await.unwrap()
    };
    let of_scenario = get(at, "/v1/kinds").await.json().as_array().unwrap().len();
    for n in of_scenario..32 {
        let made = put(n).await;
        assert_eq!(made.status, 201, "{made:?}");
    }
    is_full(&put(100).await, false);
    assert_eq!(put(7).await.status, 200, "another one of a name that is there");
    assert_eq!(delete(at, "/v1/kinds/kind-7").await.status, 204);
    assert_eq!(put(100).await.status, 201);
    server.stop().await.unwrap();
}

/// Opens a stream of events; its status.
async fn stream(at: SocketAddr) -> (TcpStream, String) {
    let mut stream = TcpStream::connect(at).await.unwrap();
    let request = format!("GET /v1/events HTTP/1.1\r\nhost: {at}\r\naccept: text/event-stream\r\n\r\n");
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut head = [0; 12];
    stream.read_exact(&mut head).await.unwrap();
    (stream, String::from_utf8_lossy(&head[9..]).into_owned())
}

#[tokio::test(flavor = "multi_thread")]
async fn of_streams_of_events_a_hundred_are_open_until_one_leaves() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let mut open = Vec::new();
    for _ in 0..100 {
        let (stream, status) = stream(at).await;
        assert_eq!(status, "200");
        open.push(stream);
    }
    let headers = [("accept", "text/event-stream")];
    is_full(&send(at, "GET", "/v1/events", &headers, "").await.unwrap(), true);
    assert_eq!(get(at, "/v1/events").await.status, 200, "a page is no stream");
    open.clear();
    // The server sees that a reader has left when it next has something to say, in fifteen seconds at most.
    let is_room = async || (stream(at).await.1 == "200").then_some(());
    eventually("there is room again", is_room).await;
    server.stop().await.unwrap();
}

/// A reader of the live feed who answers the server's pings for as long as the task runs: who does not is gone after a
/// minute, and to open a thousand may take longer.
async fn reader(at: SocketAddr) -> Result<JoinHandle<()>, Error> {
    let mut socket = connect(at, "?thin=true&packed=true", "giveway").await?;
    Ok(tokio::spawn(async move { while socket.next().await.is_some() {} }))
}

#[tokio::test(flavor = "multi_thread")]
async fn of_readers_of_the_live_feed_a_thousand_are_there_until_one_leaves() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let mut open = Vec::new();
    for _ in 0..1_000 {
        open.push(reader(at).await.unwrap());
    }
    match reader(at).await {
        Err(Error::Http(answer)) => assert_eq!(answer.status(), 429),
        other => panic!("{:?}", other.map(|_| "one too many is taken")),
    }
    for leaves in open.split_off(990) {
        leaves.abort();
    }
    eventually("there is room again", async || reader(at).await.ok()).await;
    server.stop().await.unwrap();
}

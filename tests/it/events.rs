//! Events: another system that follows them knows what the lists know, also over kills.

use crate::helper::{Answer, Folder, all_jobs, delivery, get, in_time, post, send, start};
use crate::recovery::Program;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::Instant;

/// Follows a stream: each event with its `id` and its data; ends with the stream.
struct Follower {
    lines: tokio::io::Lines<BufReader<TcpStream>>,
}

impl Follower {
    async fn open(at: SocketAddr, query: &str, last: Option<i64>) -> std::io::Result<Follower> {
        Follower::open_as(at, query, last, "").await
    }

    /// With a token.
    async fn open_as(
        at: SocketAddr,
        query: &str,
        last: Option<i64>,
        token: &str,
    ) -> std::io::Result<Follower> {
        let mut stream = TcpStream::connect(at).await?;
        let resume = last.map_or(String::new(), |last| format!("last-event-id: {last}\r\n"));
        let head = format!(
            "GET /v1/events{query} HTTP/1.1\r\nhost: {at}\r\naccept: text/event-stream\r\n\
             connection: close\r\nauthorization: Bearer {token}\r\n{resume}\r\n"
        );
        stream.write_all(head.as_bytes()).await?;
        let mut lines = BufReader::new(stream).lines();
        let status = lines.next_line().await?.unwrap_or_default();
        assert!(status.contains(" 200 "), "{status}");
        Ok(Follower { lines })
    }

    /// The next event; nothing where the stream has ended.
    async fn next(&mut self) -> Option<(i64, Value)> {
        let mut id = None;
        loop {
            let line = self.lines.next_line().await.ok()??;
            if let Some(number) = line.strip_prefix("id: ") {
                id = number.parse().ok();
            }
            if let Some(data) = line.strip_prefix("data: ") {
                return Some((id.expect("an event has a number"), serde_json::from_str(data).unwrap()));
            }
        }
    }
}

async fn cancel(at: SocketAddr, id: &str) -> std::io::Result<Answer> {
    send(at, "DELETE", &format!("/v1/jobs/{id}"), &[], "").await
}

async fn page(at: SocketAddr, query: &str) -> Value {
    let answer = get(at, &format!("/v1/events{query}")).await;
    assert_eq!(answer.status, 200, "{answer:?}");
    answer.json()
}

#[tokio::test(flavor = "multi_thread")]
async fn each_change_of_a_job_is_an_event_with_the_state_before_in_pages_and_in_a_stream() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut follower = Follower::open(at, "?kind=job&after=0", None).await.unwrap();
    let mut job = delivery(0);
    job["reference"] = json!("order 4711");
    let made = post(at, None, &job).await.unwrap().json();
    let id = made["id"].as_str().unwrap();
    let next = json!({"kind": "deliver", "after": [id], "rack": job["rack"], "station": job["station"]});
    let later = post(at, None, &next).await.unwrap().json();
    assert_eq!(cancel(at, later["id"].as_str().unwrap()).await.unwrap().status, 200);
    let mut seen = Vec::new();
    while seen.len() < 5 {
        let (seq, event) = in_time("an event", follower.next()).await.unwrap();
        assert_eq!((event["seq"].as_i64(), event["kind"].as_str()), (Some(seq), Some("job")));
        seen.push(event);
    }
    let states = |of: &str| -> Vec<(Value, Value)> {
        seen.iter().filter(|e| e["id"] == of).map(|e| (e["old"].clone(), e["new"].clone())).collect()
    };
    let first = states(id);
    assert_eq!(first[0], (Value::Null, json!("waiting")));
    assert_eq!(first[1], (json!("waiting"), json!("assigned")));
    assert!(seen.iter().filter(|e| e["id"] == id).all(|e| e["reference"] == "order 4711"), "{seen:#?}");
    let second = states(later["id"].as_str().unwrap());
    assert_eq!(second, [(Value::Null, json!("waiting")), (json!("waiting"), json!("cancelled"))]);
    let paged = page(at, "?kind=job&limit=5").await;
    assert_eq!(paged["items"].as_array().unwrap()[..], seen[..], "a page has what the stream has");
    let rest = page(at, &format!("?after={}", paged["next"])).await;
    assert!(rest["items"].as_array().unwrap().iter().all(|e| e["seq"].as_i64() > paged["next"].as_i64()));
    let robots = page(at, "?kind=robot,fleet").await;
    assert!(
        robots["items"].as_array().unwrap().iter().any(|e| e["new"] == "joined" && e["id"] == e["robot"])
    );
    for (query, status) in
        [("?after=999999", 410), ("?after=-1", 422), ("?kind=jobs", 422), ("?limit=0", 422)]
    {
        get(at, &format!("/v1/events{query}")).await.problem(status);
    }
    server.stop().await.unwrap();
    in_time("a stream ends with the server", async { while follower.next().await.is_some() {} }).await;
}

/// What somebody who follows knows of jobs.
#[derive(Default)]
struct Books {
    last: i64,
    states: BTreeMap<String, String>,
}

impl Books {
    /// Follows until the stream ends or `enough` says so.
    async fn follow(&mut self, at: SocketAddr, enough: impl Fn(&Books) -> bool) {
        let Ok(mut follower) = Follower::open(at, "?kind=job", Some(self.last)).await else { return };
        while !enough(self) {
            let Some((seq, event)) = in_time("news", follower.next()).await else { return };
            assert!(seq > self.last, "{seq} after {}", self.last);
            self.last = seq;
            let id = event["id"].as_str().unwrap().to_owned();
            let new = event["new"].as_str().unwrap().to_owned();
            let before = self.states.insert(id.clone(), new);
            assert_eq!(event["old"].as_str(), before.as_deref(), "the state before of {id}: none was missed");
        }
    }

    fn are_over(&self, jobs: usize) -> bool {
        let is_over = |state: &String| ["done", "cancelled", "failed"].contains(&state.as_str());
        self.states.len() == jobs && self.states.values().all(is_over)
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn who_follows_a_thousand_jobs_over_three_kills_has_the_books_of_the_server() {
    let folder = Folder::new();
    let mut books = Books::default();
    let mut program = Program::start(&folder);
    let row = |i: usize| {
        let mut job = delivery(i);
        job["pick_s"] = json!(0.1);
        job["reference"] = json!(format!("order {i}"));
        json!({ "job": job })
    };
    let jobs: Vec<Value> = (0..1000).map(row).collect();
    let headers = [("content-type", "application/json")];
    let made =
        send(program.address, "POST", "/v1/jobs:batch", &headers, &json!({ "jobs": jobs }).to_string())
            .await
            .unwrap();
    assert_eq!(made.json()["accepted"], 1000, "{made:?}");
    for round in 0..3 {
        let at = program.address;
        // Most are cancelled, while others are on their way.
        let cancels = tokio::spawn(async move {
            for i in (round * 330 + 1)..(round * 330 + 329) {
                if cancel(at, &format!("j{i}")).await.is_err() {
                    return;
                }
            }
        });
        let begun = Instant::now();
        books.follow(at, |_| begun.elapsed() > Duration::from_millis(1500)).await;
        program.kill();
        cancels.await.unwrap();
        program = Program::start(&folder);
    }
    let at = program.address;
    let at_once: Vec<_> = (1..=995).collect();
    for some in at_once.chunks(50) {
        let cancels = some.iter().map(|i| async move { cancel(at, &format!("j{i}")).await.unwrap() });
        futures_util::future::join_all(cancels).await;
    }
    books.follow(at, |books| books.are_over(1000)).await;
    let listed: BTreeMap<String, String> = all_jobs(at, 500)
        .await
        .iter()
        .map(|job| (job["id"].as_str().unwrap().to_owned(), job["state"].as_str().unwrap().to_owned()))
        .collect();
    assert_eq!(books.states, listed);
    assert!(listed.values().any(|state| state == "done"), "some were done");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stream_of_events_ends_when_its_token_is_revoked() {
    let folder = Folder::new();
    let server = crate::tokens::start_closed(&folder).await;
    let at = server.address();
    let made = crate::tokens::make(at, "warehouse system", "integrator", None).await;
    let token = made["token"].as_str().unwrap();
    let mut follower = Follower::open_as(at, "?after=0", None, token).await.unwrap();
    let path = format!("/v1/tokens/{}", made["id"].as_str().unwrap());
    assert_eq!(crate::tokens::with(at, crate::tokens::ADMIN, "DELETE", &path, "").await.status, 204);
    in_time("the stream ends with its token", async { while follower.next().await.is_some() {} }).await;
    server.stop().await.unwrap();
}

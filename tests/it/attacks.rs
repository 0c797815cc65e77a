//! Attacks on a server that needs tokens: slow readers, wrong secrets by each door, sessions without end, and webhooks
//! that take nothing. During each of them an operator asks sixty times, each time on a new connection, and is answered.
//!
//! The attackers and the operator share one address, as behind a proxy. What is asserted is that the operator is
//! answered at all, within a bound that only a server that keeps operators out exceeds.

use crate::helper::{Answer, Folder, SCENARIO, config, delivery, eventually, floor, send};
use crate::tokens::{ADMIN, make, start_closed, until_robots, with};
use giveway::server::{Config, Server};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream};
use tokio::process::{Child, Command};
use tokio::task::JoinSet;
use tokio::time::{Instant, timeout};

/// How often the operator asks.
const PROBES: usize = 60;

/// Long enough for two slow cores, and far below what an attack on connections costs, which is minutes.
const ANSWERED: Duration = Duration::from_secs(10);

/// How many of the operator's requests are answered as they should be.
async fn probe(at: SocketAddr, token: &str) -> usize {
    let mut answered = 0;
    for i in 0..PROBES {
        let path = if i % 2 == 0 { "/v1/robots" } else { "/v1/jobs" };
        let bearer = format!("Bearer {token}");
        let headers = [("authorization", bearer.as_str())];
        let asked = timeout(ANSWERED, send(at, "GET", path, &headers, "")).await;
        answered += usize::from(asked.is_ok_and(|answer| answer.is_ok_and(|a| a.status == 200)));
    }
    answered
}

async fn connect(at: SocketAddr, says: &str) -> Option<TcpStream> {
    let mut stream = timeout(ANSWERED, TcpStream::connect(at)).await.ok()?.ok()?;
    stream.write_all(says.as_bytes()).await.ok()?;
    Some(stream)
}

/// One request that shows a secret; its status, if it is answered while the test waits.
async fn try_secret(at: SocketAddr, door: &str, i: usize) -> Option<u16> {
    let guess = format!("a-wrong-token-{i:06}");
    let (method, path, header, body) = match door {
        "token" => ("GET", "/v1/robots", ("authorization", format!("Bearer {guess}")), String::new()),
        "sign-in" => {
            let body = json!({ "token": guess }).to_string();
            ("POST", "/v1/session", ("content-type", "application/json".into()), body)
        }
        "cookie" => {
            let cookie = format!("giveway_session_{}={guess}", at.port());
            ("GET", "/v1/robots", ("cookie", cookie), String::new())
        }
        other => panic!("no door {other}"),
    };
    let answer = send(at, method, path, &[(header.0, &header.1)], &body).await.ok()?;
    Some(answer.status)
}

/// The list at this path, once it is so.
async fn until(at: SocketAddr, path: &str, is_so: impl Fn(&Value) -> bool) -> Value {
    let list = async || Some(with(at, ADMIN, "GET", path, "").await.json()).filter(&is_so);
    eventually(&format!("{path} is as it should be"), list).await
}

fn entries(listed: &Value, what: &str) -> Vec<Value> {
    let items = listed["items"].as_array().cloned().unwrap_or_default();
    items.into_iter().filter(|e| e["what"].as_str().is_some_and(|w| w.starts_with(what))).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn wrong_secrets_by_each_door_are_slowed_by_one_memory_written_down_and_an_alarm_and_keep_nobody_out() {
    for (door, what) in [
        ("token", "wrong token"),
        ("sign-in", "wrong token when signing in"),
        ("cookie", "wrong cookie of a session"),
    ] {
        let folder = Folder::new();
        let server = start_closed(&folder).await;
        let at = server.address();
        until_robots(at, ADMIN).await;
        let operator = make(at, "operator", "operator", None).await["token"].as_str().unwrap().to_owned();
        let (mut guesses, began) = (JoinSet::new(), Instant::now());
        (0..200).for_each(|i| _ = guesses.spawn(try_secret(at, door, i)));
        assert_eq!(probe(at, &operator).await, PROBES, "{door}: right tokens do not wait");
        let alarms = until(at, "/v1/alarms", |l| l.to_string().contains("wrong tokens or cookies")).await;
        assert!(alarms.to_string().contains("127.0.0.1 (at least "), "{door}: {alarms}");
        let audit = until(at, "/v1/audit", |l| entries(l, what).len() >= 3).await;
        let noted = entries(&audit, what);
        let said: Vec<&str> = noted.iter().rev().map(|e| e["what"].as_str().unwrap()).collect();
        let expected = [what.to_owned(), format!("{what}, 10 times"), format!("{what}, 100 times")];
        assert_eq!(said, expected, "{door}");
        assert!(noted.iter().all(|e| e["subject"] == "127.0.0.1" && e["actor"] == "anonymous"), "{noted:?}");
        let mut answers = 0u64;
        while let Some(done) = guesses.try_join_next() {
            let status = done.unwrap();
            assert!(status.is_none_or(|status| status == 401), "{door}: {status:?}");
            answers += u64::from(status.is_some());
        }
        // No answer waits for longer than twenty seconds; until then there are ten a second at most.
        let passed = began.elapsed().as_secs();
        println!("{door}: {answers} of 200 wrong ones answered in {passed} s");
        assert!(passed >= 19 || answers <= 10 * (passed + 2), "{door}: {answers} in {passed} s");
        guesses.abort_all();
        server.stop().await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_doors_share_one_memory_and_a_session_that_has_ended_is_no_guess() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    for (i, door) in ["token", "cookie", "sign-in"].into_iter().cycle().take(10).enumerate() {
        tokio::spawn(try_secret(at, door, i));
    }
    // The tenth of all doors together, whichever that is.
    let ends = |listed: &Value, end: &str| {
        let all = entries(listed, "wrong ");
        all.iter().filter(|e| e["what"].as_str().unwrap().ends_with(end)).count()
    };
    until(at, "/v1/audit", |l| ends(l, ", 10 times") == 1).await;
    let origin = format!("http://{at}");
    let signed = sign_in(at, ADMIN).await;
    let cookie = signed.header("set-cookie").unwrap().split(';').next().unwrap().to_owned();
    let headers = [("cookie", cookie.as_str()), ("origin", origin.as_str())];
    assert_eq!(send(at, "DELETE", "/v1/session", &headers, "").await.unwrap().status, 204);
    for _ in 0..100 {
        send(at, "GET", "/v1/robots", &headers, "").await.unwrap().problem(401);
    }
    assert_eq!(with(at, ADMIN, "POST", "/v1/fleet/stop", "").await.status, 204);
    let audit = until(at, "/v1/audit", |l| entries(l, "POST /v1/fleet/stop").len() == 1).await;
    assert_eq!(ends(&audit, ", 100 times"), 0, "{audit}");
    server.stop().await.unwrap();
}

async fn sign_in(at: SocketAddr, token: &str) -> Answer {
    let (body, origin) = (json!({ "token": token }).to_string(), format!("http://{at}"));
    let headers = [("content-type", "application/json"), ("origin", origin.as_str())];
    send(at, "POST", "/v1/session", &headers, &body).await.unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_viewer_who_signs_in_a_thousand_times_signs_nobody_else_out() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    let operator = make(at, "operator", "operator", None).await["token"].as_str().unwrap().to_owned();
    let viewer = make(at, "viewer", "viewer", None).await["token"].as_str().unwrap().to_owned();
    let cookie = |answer: &Answer| answer.header("set-cookie").unwrap().split(';').next().unwrap().to_owned();
    let of_admin = cookie(&sign_in(at, ADMIN).await);
    let first = cookie(&sign_in(at, &viewer).await);
    let attack = tokio::spawn(async move {
        let mut last = String::new();
        for _ in 0..1000 {
            let answer = sign_in(at, &viewer).await;
            assert_eq!(answer.status, 201, "{answer:?}");
            last = answer.header("set-cookie").unwrap().split(';').next().unwrap().to_owned();
        }
        last
    });
    assert_eq!(probe(at, &operator).await, PROBES);
    let last = attack.await.unwrap();
    for (cookie, status) in [(&of_admin, 200), (&last, 200), (&first, 401)] {
        let answer = send(at, "GET", "/v1/session", &[("cookie", cookie)], "").await.unwrap();
        assert_eq!(answer.status, status, "the viewer's own oldest sessions end: {answer:?}");
    }
    server.stop().await.unwrap();
}

/// A receiver that answers each message so, or never; and how many it got.
async fn receiver(answer: Option<&'static str>) -> (String, Arc<AtomicUsize>) {
    let messages = Arc::new(AtomicUsize::new(0));
    let counted = messages.clone();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let url = format!("http://{}/hook", listener.local_addr().unwrap());
    tokio::spawn(async move {
        let mut kept = Vec::new();
        while let Ok((mut stream, _)) = listener.accept().await {
            counted.fetch_add(1, Ordering::Relaxed);
            let Some(answer) = answer else {
                kept.push(stream);
                continue;
            };
            tokio::spawn(async move {
                let mut message = vec![0; 65_536];
                let _ = stream.read(&mut message).await;
                let text = format!("HTTP/1.1 {answer}\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
                let _ = stream.write_all(text.as_bytes()).await;
                let _ = stream.shutdown().await;
                let _ = stream.read(&mut message).await;
            });
        }
    });
    (url, messages)
}

#[tokio::test(flavor = "multi_thread")]
async fn only_200_to_299_takes_a_message_and_every_other_answer_is_a_failure_that_is_shown_and_alarmed() {
    let folder = Folder::new();
    let settings = Config { token: Some(ADMIN.into()), webhook_alarm_s: 1, ..config(&folder) };
    let server = Server::start(&settings, floor()).await.unwrap();
    let at = server.address();
    until_robots(at, ADMIN).await;
    let taken = ["200 OK", "202 Accepted", "204 No Content", "299 Odd"];
    let failed = [
        "101 Switching Protocols",
        "300 Multiple Choices",
        "301 Moved\r\nlocation: http://127.0.0.1:1/",
        "302 Found\r\nlocation: /elsewhere",
        "303 See Other",
        "304 Not Modified",
        "307 Temporary Redirect",
        "308 Permanent Redirect",
        "400 Bad Request",
        "401 Unauthorized",
        "404 Not Found",
        "410 Gone",
        "429 Too Many",
        "500 No",
        "503 Not Now",
        "599 Odd",
    ];
    let mut hooks = Vec::new();
    for answer in taken.into_iter().chain(failed).map(Some).chain([None]) {
        let (url, messages) = receiver(answer).await;
        let body = json!({"url": url, "kinds": ["job"]}).to_string();
        let made = with(at, ADMIN, "POST", "/v1/webhooks", &body).await;
        assert_eq!(made.status, 201, "{made:?}");
        hooks.push((made.json()["id"].as_str().unwrap().to_owned(), answer, messages));
    }
    let job = delivery(0).to_string();
    assert_eq!(with(at, ADMIN, "POST", "/v1/jobs", &job).await.status, 201);
    assert_eq!(
        probe(at, ADMIN).await,
        PROBES,
        "receivers that fail or never answer keep no operator waiting"
    );
    let is_taken = |answer: &Option<&'static str>| answer.is_some_and(|answer| taken.contains(&answer));
    let listed = until(at, "/v1/webhooks", |listed| {
        let all = listed.as_array().into_iter().flatten().zip(&hooks);
        all.into_iter().all(|(hook, (_, answer, messages))| match is_taken(answer) {
            true => messages.load(Ordering::Relaxed) > 0,
            false => hook["failing"].is_string(),
        })
    })
    .await;
    for (hook, (id, answer, _)) in listed.as_array().unwrap().iter().zip(&hooks) {
        assert_eq!(hook["id"], id.as_str());
        let why = hook["failing"].as_str();
        let is_taken = is_taken(answer);
        assert_eq!((why.is_none(), hook["attempts"] == 0), (is_taken, is_taken), "{answer:?}: {hook}");
        if let Some(status) = answer.filter(|a| !is_taken && !a.starts_with('1')).map(|a| &a[..3]) {
            assert!(why.unwrap().contains(status), "it says what it was: {hook}");
        }
    }
    let alarms = until(at, "/v1/alarms", |alarms| {
        let failing = hooks.iter().filter(|(_, answer, _)| answer.is_some_and(|a| failed.contains(&a)));
        failing.into_iter().all(|(id, ..)| alarms.to_string().contains(&format!("{id} (")))
    })
    .await;
    assert!(!alarms.to_string().contains("h1 ("), "{alarms}");
    server.stop().await.unwrap();
}

/// A server in a process of its own, which may have so many descriptors.
struct Process(Child, SocketAddr);

impl Process {
    async fn start(folder: &Folder, descriptors: u32) -> Process {
        let database = folder.database();
        let command = format!(
            "ulimit -n {descriptors}; exec {} serve --scenario {SCENARIO} --listen 127.0.0.1:0 --database {}",
            env!("CARGO_BIN_EXE_giveway"),
            database.display()
        );
        let mut child = Command::new("sh")
            .args(["-c", &command])
            .env("GIVEWAY_TOKEN", ADMIN)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .kill_on_drop(true)
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        while let Some(line) = lines.next_line().await.unwrap() {
            if let Some(at) = line.strip_prefix("Giveway is at http://") {
                let at = at.trim_end_matches('/').parse().unwrap();
                tokio::spawn(async move { while let Ok(Some(_)) = lines.next_line().await {} });
                return Process(child, at);
            }
        }
        panic!("it does not start");
    }

    /// What it has in memory, megabytes.
    fn memory_mb(&self) -> u64 {
        let id = self.0.id().unwrap();
        let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() / 1024
    }
}

/// Requests whose long answers are never read.
async fn slow_readers(at: SocketAddr, count: usize, request: &str) -> Vec<TcpStream> {
    let mut streams = Vec::new();
    for _ in 0..count {
        streams.extend(connect(at, request).await);
    }
    streams
}

fn open_request(encoding: &str) -> String {
    format!("GET /openapi.json HTTP/1.1\r\nhost: localhost\r\naccept-encoding: {encoding}\r\n\r\n")
}

#[tokio::test(flavor = "multi_thread")]
async fn three_thousand_slow_readers_take_neither_memory_nor_the_place_of_an_operator() {
    let folder = Folder::new();
    let server = Process::start(&folder, 65_536).await;
    let at = server.1;
    until_robots(at, ADMIN).await;
    let before = server.memory_mb();
    let mut readers = Vec::new();
    for encoding in ["identity", "br", "gzip"] {
        readers.extend(slow_readers(at, 1000, &open_request(encoding)).await);
    }
    assert_eq!(probe(at, ADMIN).await, PROBES);
    let grown = server.memory_mb().saturating_sub(before);
    println!(
        "slow readers of /openapi.json: {before} MB before, {grown} MB more with {} of them",
        readers.len()
    );
    assert!(grown < 100, "{grown} MB more");
}

#[tokio::test(flavor = "multi_thread")]
async fn slow_readers_who_may_read_cost_no_more_than_the_budget_and_the_operator_is_answered() {
    let folder = Folder::new();
    let server = Process::start(&folder, 65_536).await;
    let at = server.1;
    until_robots(at, ADMIN).await;
    let before = server.memory_mb();
    let bearer = format!("authorization: Bearer {ADMIN}");
    let request =
        format!("GET /v1/history HTTP/1.1\r\nhost: localhost\r\n{bearer}\r\naccept-encoding: br\r\n\r\n");
    let many = request.repeat(20);
    let readers = slow_readers(at, 1000, &many).await;
    assert_eq!(probe(at, ADMIN).await, PROBES);
    let grown = server.memory_mb().saturating_sub(before);
    println!("slow readers with a token: {before} MB before, {grown} MB more with {} of them", readers.len());
    assert!(grown < 300, "{grown} MB more");
}

#[tokio::test(flavor = "multi_thread")]
async fn with_few_descriptors_four_hundred_connections_keep_no_operator_out() {
    let folder = Folder::new();
    let server = Process::start(&folder, 300).await;
    let at = server.1;
    until_robots(at, ADMIN).await;
    let readers = slow_readers(at, 400, &open_request("identity")).await;
    assert_eq!(probe(at, ADMIN).await, PROBES, "{} slow readers", readers.len());
    let mut silent = Vec::new();
    for _ in 0..400 {
        silent.extend(connect(at, "").await);
    }
    assert_eq!(probe(at, ADMIN).await, PROBES, "{} who say nothing", silent.len());
    // Those who are known and idle make room for one another, too.
    let known =
        format!("GET /v1/robots HTTP/1.1\r\nhost: localhost\r\nauthorization: Bearer {ADMIN}\r\n\r\n");
    let mut idle = Vec::new();
    for _ in 0..400 {
        let Some(mut stream) = connect(at, &known).await else { continue };
        let mut head = [0; 12];
        let _ = timeout(ANSWERED, stream.read_exact(&mut head)).await;
        idle.push(stream);
    }
    assert_eq!(probe(at, ADMIN).await, PROBES, "{} who are idle", idle.len());
}

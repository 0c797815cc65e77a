//! The server and its database: taken away under it, slow to load, and let go in the end.

use crate::helper::{Folder, all_jobs, config, delivery, eventually, floor, get, map, post, send, start};
use giveway::server::{Config, Server};
use giveway::store::Store;
use serde_json::json;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{Connection, query};
use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

/// Waits until health says this.
async fn health(at: SocketAddr, status: u16, word: &str) {
    let says_so = async || {
        let answer = get(at, "/v1/health").await;
        (answer.status == status && answer.text.contains(word)).then_some(())
    };
    eventually(&format!("health becomes {status} with \"{word}\""), says_so).await;
}

/// Takes the database from under a server in some way, while customers hand in jobs.
async fn taken_away(how: fn(&Path)) {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    for i in 0..3 {
        assert_eq!(post(at, None, &delivery(i)).await.unwrap().status, 201);
    }
    how(&folder.database());
    // No pause: the first request after the loss must not be acknowledged any more.
    for i in 0..25 {
        let answer = post(at, Some(&format!("k{i}")), &delivery(i)).await.unwrap();
        answer.problem(503);
        if i == 0 {
            health(at, 503, "nothing is acknowledged any more").await;
        }
    }
    assert_eq!(get(at, "/v1/health/live").await.status, 200, "the process lives");
    server.stop().await.unwrap_err();
}

#[tokio::test(flavor = "multi_thread")]
async fn after_its_database_was_deleted_the_server_acknowledges_nothing() {
    taken_away(|path| fs::remove_file(path).unwrap()).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn after_its_database_was_replaced_the_server_acknowledges_nothing() {
    taken_away(|path| {
        let other = path.with_extension("other");
        fs::copy(path, &other).unwrap();
        fs::rename(&other, path).unwrap();
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn after_its_write_ahead_log_was_deleted_the_server_acknowledges_nothing() {
    taken_away(|path| fs::remove_file(PathBuf::from(format!("{}-wal", path.display()))).unwrap()).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_that_was_renamed_and_is_back_is_used_again() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let away = folder.path().join("away.sqlite");
    fs::rename(folder.database(), &away).unwrap();
    health(at, 503, "was deleted or moved away").await;
    post(at, None, &delivery(0)).await.unwrap().problem(503);
    fs::rename(&away, folder.database()).unwrap();
    health(at, 200, "ok").await;
    let made = post(at, None, &delivery(0)).await.unwrap();
    assert_eq!(made.status, 201, "{made:?}");
    server.stop().await.unwrap();
    let server = start(&folder).await;
    assert!(all_jobs(server.address(), 50).await.iter().any(|j| j["id"] == made.json()["id"]));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_port_answers_while_the_journal_is_being_loaded() {
    let folder = Folder::new();
    Store::open(&folder.database(), &map()).await.unwrap().close().await;
    // While another program writes, the start has to wait.
    let options = SqliteConnectOptions::new().filename(folder.database());
    let mut other = SqliteConnection::connect_with(&options).await.unwrap();
    query("BEGIN IMMEDIATE").execute(&mut other).await.unwrap();
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let settings = Config { listen: port.to_string(), ..config(&folder) };
    let starting = tokio::spawn(async move { Server::start(&settings, floor()).await });
    let early = loop {
        match send(port, "GET", "/v1/health", &[], "").await {
            Ok(answer) => break answer,
            Err(_) => tokio::task::yield_now().await,
        }
    };
    assert_eq!(early.problem(503)["type"], "/problems/starting");
    assert_eq!(early.header("retry-after"), Some("1"));
    post(port, None, &delivery(0)).await.unwrap().problem(503);
    assert_eq!(get(port, "/v1/health/live").await.json()["status"], "alive");
    assert!(!starting.is_finished());
    query("ROLLBACK").execute(&mut other).await.unwrap();
    other.close().await.unwrap();
    let server = starting.await.unwrap().unwrap();
    health(port, 200, "ok").await;
    assert_eq!(post(port, None, &delivery(0)).await.unwrap().status, 201);
    server.stop().await.unwrap();
}

/// Asks for lists and hands in jobs until told to stop.
async fn customer(at: SocketAddr, over: Arc<AtomicBool>) {
    while !over.load(Ordering::Relaxed) {
        let _ = send(at, "GET", "/v1/jobs?limit=500", &[], "").await;
        let _ = post(at, None, &delivery(1)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_has_stopped_has_let_go_of_its_database_with_requests_in_flight() {
    let folder = Folder::new();
    for round in 0..30 {
        let server = start(&folder).await;
        let at = server.address();
        let over = Arc::new(AtomicBool::new(false));
        let customers: Vec<_> = (0..4).map(|_| tokio::spawn(customer(at, over.clone()))).collect();
        let (live, _) = tokio_tungstenite::connect_async(format!("ws://{at}/v1/live")).await.unwrap();
        assert_eq!(post(at, None, &delivery(0)).await.unwrap().status, 201);
        // A child process that is being started has the lock file open for a moment.
        let child = std::thread::spawn(|| std::process::Command::new("true").status());
        server.stop().await.unwrap_or_else(|e| panic!("round {round}: {e:#}"));
        let store = Store::open(&folder.database(), &map()).await;
        store.unwrap_or_else(|e| panic!("round {round}: {e}")).close().await;
        over.store(true, Ordering::Relaxed);
        drop(live);
        for customer in customers {
            customer.await.unwrap();
        }
        child.join().unwrap().unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_never_ends_its_request_does_not_keep_the_database_of_a_stopped_server() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut stream = TcpStream::connect(at).await.unwrap();
    let head = format!("POST /v1/jobs HTTP/1.1\r\nhost: {at}\r\ncontent-type: application/json");
    let half = format!("{head}\r\ncontent-length: 99\r\n\r\n{{");
    stream.write_all(half.as_bytes()).await.unwrap();
    // The answer to a whole request on another connection: by then the half one has been taken in, too.
    assert_eq!(post(at, None, &delivery(0)).await.unwrap().status, 201);
    server.stop().await.unwrap();
    let server = Server::start(&config(&folder), floor()).await.unwrap_or_else(|e| panic!("{e:#}"));
    server.stop().await.unwrap();
    drop(stream);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_starts_empty_only_where_it_is_told_to_and_never_over_a_whole_database() {
    let folder = Folder::new();
    let server = start(&folder).await;
    assert_eq!(post(server.address(), None, &delivery(0)).await.unwrap().status, 201);
    server.stop().await.unwrap();
    let new = Config { new: true, ..config(&folder) };
    let refused = Server::start(&new, floor()).await.err().unwrap().to_string();
    assert!(refused.contains("only if there is none"), "{refused}");
    fs::remove_file(folder.database()).unwrap();
    let refused = Server::start(&config(&folder), floor()).await.err().unwrap().to_string();
    assert!(refused.contains("--new"), "{refused}");
    let server = Server::start(&new, floor()).await.unwrap();
    assert_eq!(all_jobs(server.address(), 50).await, Vec::<serde_json::Value>::new());
    server.stop().await.unwrap();
    let kept = fs::read_dir(folder.path()).unwrap().flatten();
    let kept: Vec<_> = kept.map(|e| e.file_name().into_string().unwrap()).collect();
    assert!(kept.iter().any(|n| n.starts_with("giveway.past.2")), "moved aside: {}", json!(kept));
}

#[tokio::test(flavor = "multi_thread")]
async fn robots_of_a_kind_that_the_scenario_no_longer_has_are_refused_in_words() {
    let folder = Folder::new();
    let mut mixed = floor();
    mixed.source.scenario.site.kinds[0].name = "mover".into();
    let server = Server::start(&config(&folder), mixed).await.unwrap_or_else(|e| panic!("{e:#}"));
    let at = server.address();
    let is_mover = async || get(at, "/v1/robots").await.text.contains("\"kind\":\"mover\"").then_some(());
    eventually("a robot is a mover", is_mover).await;
    server.stop().await.unwrap();
    let refused = Server::start(&config(&folder), floor()).await.err().expect("it is refused").to_string();
    assert!(refused.contains("is of kind \"mover\"") && refused.contains("scenario has robot"), "{refused}");
}

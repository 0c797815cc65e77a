//! Webhooks: a receiver that is away for a while is told everything in order, once it is back.

use crate::authority::{Authority, serve_tls};
use crate::helper::{Folder, config, delivery, eventually, floor, get, in_time, post, send, start};
use axum::routing;
use giveway::api::outgoing::webhooks::{read_secret, signature};
use giveway::server::{Config, Server};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpListener;

/// Takes messages, or refuses them for so many times first.
async fn receiver(refuse: usize) -> (String, Arc<Mutex<Vec<(String, String)>>>) {
    receiver_that_says(refuse, "500 No").await
}

/// Takes messages, or answers so for so many times first.
async fn receiver_that_says(
    refuse: usize,
    refusal: &'static str,
) -> (String, Arc<Mutex<Vec<(String, String)>>>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let url = format!("http://{}/hook", listener.local_addr().unwrap());
    let taken = Arc::new(Mutex::new(Vec::new()));
    let messages = taken.clone();
    tokio::spawn(async move {
        let mut refuse = refuse;
        while let Ok((mut stream, _)) = listener.accept().await {
            let mut bytes = Vec::new();
            let (head, body) = loop {
                let mut some = [0; 4096];
                let n = stream.read(&mut some).await.unwrap_or(0);
                bytes.extend_from_slice(&some[..n]);
                let text = String::from_utf8_lossy(&bytes).into_owned();
                let Some((head, body)) = text.split_once("\r\n\r\n") else { continue };
                let length = header(head, "content-length").parse::<usize>().unwrap();
                if body.len() >= length || n == 0 {
                    break (head.to_owned(), body.to_owned());
                }
            };
            let status = if refuse > 0 { refusal } else { "204 Taken" };
            if refuse == 0 {
                messages.lock().unwrap().push((head, body));
            }
            refuse = refuse.saturating_sub(1);
            let answer = format!("HTTP/1.1 {status}\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
            let _ = stream.write_all(answer.as_bytes()).await;
        }
    });
    (url, taken)
}

fn header<'a>(head: &'a str, name: &str) -> &'a str {
    let line = head.lines().find(|line| line.to_lowercase().starts_with(&format!("{name}:")));
    line.and_then(|line| line.split_once(':')).map_or("0", |(_, value)| value.trim())
}

async fn add(at: std::net::SocketAddr, hook: &Value) -> crate::helper::Answer {
    let headers = [("content-type", "application/json")];
    send(at, "POST", "/v1/webhooks", &headers, &hook.to_string()).await.unwrap()
}

/// The webhooks, as soon as the first of them is said to fail.
async fn failing(at: SocketAddr) -> Value {
    let fails = async || Some(get(at, "/v1/webhooks").await.json()).filter(|l| l[0]["failing"].is_string());
    eventually("the webhook is said to fail", fails).await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_webhook_is_told_in_order_signed_and_again_until_it_takes_it() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    // A redirect is followed nowhere: what it answers is told again, as after any other failure.
    let (url, taken) = receiver_that_says(2, "302 Found\r\nlocation: /elsewhere").await;
    let made = add(at, &json!({"url": url, "kinds": ["job"]})).await;
    assert_eq!(made.status, 201, "{made:?}");
    let secret = read_secret(made.json()["secret"].as_str().unwrap()).unwrap();
    let job = post(at, None, &delivery(0)).await.unwrap().json();
    let events_of = |(_, body): &(String, String)| {
        let message: Value = serde_json::from_str(body).unwrap();
        message["data"]["events"].as_array().unwrap().clone()
    };
    let are_told = async || {
        let events: Vec<Value> = taken.lock().unwrap().iter().flat_map(events_of).collect();
        (events.len() >= 2).then_some(events)
    };
    let events = eventually("two events are told", are_told).await;
    let states: Vec<_> = events.iter().take(2).map(|e| (e["id"].clone(), e["new"].clone())).collect();
    assert_eq!(states, [(job["id"].clone(), json!("waiting")), (job["id"].clone(), json!("assigned"))]);
    for (head, body) in taken.lock().unwrap().iter() {
        let seconds = header(head, "webhook-timestamp").parse().unwrap();
        let expected = signature(&secret, header(head, "webhook-id"), seconds, body);
        assert_eq!(header(head, "webhook-signature"), expected);
    }
    let listed = get(at, "/v1/webhooks").await.json();
    assert_eq!(
        (&listed[0]["id"], &listed[0]["secret"]),
        (&json!("h1"), &Value::Null),
        "secrets are not told again"
    );
    assert_eq!(get(at, "/v1/webhooks/h1/failures").await.json()["items"], json!([]));
    assert_eq!(send(at, "DELETE", "/v1/webhooks/h1", &[], "").await.unwrap().status, 204);
    get(at, "/v1/webhooks/h1/failures").await.problem(404);
    let wrong = json!({"url": "ftp://x", "kinds": ["jobs"], "secret": "short"});
    assert_eq!(add(at, &wrong).await.problem(422)["errors"].as_array().unwrap().len(), 3);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_webhook_that_stays_away_shows_why_and_its_message_is_given_up_after_twenty_attempts_over_a_restart()
 {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let gone = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let url = format!("http://{}/hook", gone.local_addr().unwrap());
    drop(gone);
    assert_eq!(add(at, &json!({"url": url})).await.status, 201);
    post(at, None, &delivery(0)).await.unwrap();
    let listed = failing(at).await;
    server.stop().await.unwrap();
    let store = giveway::store::Store::open(&folder.database(), &crate::helper::map()).await.unwrap();
    let hook = store.webhooks().await.unwrap().remove(0);
    assert_eq!(hook.cursor, listed[0]["cursor"], "it goes on where it was");
    let pending = hook.pending.expect("a message was tried");
    for _ in hook.attempts..19 {
        store.webhook_missed(hook.id, pending, "refused by the test").await.unwrap();
    }
    store.close().await;
    let again = start(&folder).await;
    let at = again.address();
    let are_shown = async || {
        let failures = get(at, "/v1/webhooks/h1/failures").await.json()["items"].clone();
        failures[0].is_object().then_some(failures)
    };
    let failures = eventually("the message is given up", are_shown).await;
    let given_up = (&failures[0]["attempts"], &failures[0]["first"], &failures[0]["last"]);
    assert_eq!(given_up, (&json!(20), &json!(hook.cursor + 1), &json!(pending)), "{failures}");
    let after = get(at, "/v1/webhooks").await.json();
    assert!(after[0]["cursor"].as_i64() >= Some(pending), "it goes on behind what was given up: {after}");
    again.stop().await.unwrap();
}

/// The active alarms about webhooks, as soon as there are so many.
async fn alarms(at: SocketAddr, count: usize) -> Vec<Value> {
    eventually(&format!("there are {count} alarms about webhooks"), async || {
        let listed = get(at, "/v1/alarms").await.json();
        let items = listed["items"].as_array().unwrap().iter();
        let found: Vec<Value> = items.filter(|a| a["kind"] == "webhook").cloned().collect();
        (found.len() == count).then_some(found)
    })
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_webhook_that_takes_nothing_for_a_while_is_an_alarm_until_it_takes_something_or_is_removed() {
    let folder = Folder::new();
    let settings = Config { webhook_alarm_s: 1, ..config(&folder) };
    let server = Server::start(&settings, floor()).await.unwrap();
    let at = server.address();
    let (url, taken) = receiver(3).await;
    assert_eq!(add(at, &json!({"url": url, "kinds": ["job"]})).await.status, 201);
    post(at, None, &delivery(0)).await.unwrap();
    let alarm = alarms(at, 1).await.remove(0);
    assert_eq!((&alarm["severity"], &alarm["subject"]["kind"]), (&json!("warning"), &json!("server")));
    let text = alarm["text"].as_str().unwrap();
    assert!(text.contains("h1 (") && text.contains("500"), "it says which, and why: {text}");
    assert!(taken.lock().unwrap().is_empty(), "it is raised while nothing is taken");
    alarms(at, 0).await;
    assert!(!taken.lock().unwrap().is_empty(), "it ends when something is taken");

    let gone = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let url = format!("http://{}/hook", gone.local_addr().unwrap());
    drop(gone);
    assert_eq!(add(at, &json!({"url": url, "kinds": ["job"]})).await.status, 201);
    post(at, None, &delivery(1)).await.unwrap();
    let text = alarms(at, 1).await.remove(0)["text"].as_str().unwrap().to_owned();
    assert!(text.contains("h2 (") && !text.contains("h1 ("), "{text}");
    assert_eq!(send(at, "DELETE", "/v1/webhooks/h2", &[], "").await.unwrap().status, 204);
    alarms(at, 0).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_address_inside_is_refused_by_every_name_of_it_and_for_each_message_unless_a_setting_names_its_network()
 {
    let folder = Folder::new();
    let (url, taken) = receiver(0).await;
    let none = Config { webhook_inside: Vec::new(), ..config(&folder) };
    let server = start(&folder).await;
    assert_eq!(add(server.address(), &json!({"url": url, "kinds": ["job"]})).await.status, 201);
    server.stop().await.unwrap();
    // The setting is taken back: what was added before is told nothing, and says why.
    let server = Server::start(&none, floor()).await.unwrap();
    let at = server.address();
    let hosts = [
        "127.0.0.1:9",
        "localhost",
        "[::1]:80",
        "169.254.169.254",
        "10.1.2.3",
        "192.168.0.9",
        "[fd00::1]",
        "0",
    ];
    for host in hosts {
        let refused = add(at, &json!({"url": format!("http://{host}/hook")})).await.problem(422);
        assert!(refused["detail"].as_str().unwrap().contains("webhook_inside"), "{host}: {refused}");
    }
    post(at, None, &delivery(0)).await.unwrap();
    let listed = failing(at).await;
    assert!(listed[0]["failing"].as_str().is_some_and(|why| why.contains("webhook_inside")), "{listed}");
    assert!(taken.lock().unwrap().is_empty());
    server.stop().await.unwrap();
    let wrong = Config { webhook_inside: vec!["10.0.0.0/99".into()], ..config(&folder) };
    let refused = Server::start(&wrong, floor()).await.err().expect("no such network");
    assert!(refused.to_string().contains("10.0.0.0/99"), "{refused:#}");
}

#[tokio::test(flavor = "multi_thread")]
async fn user_and_password_in_an_address_are_sent_to_the_receiver_and_shown_to_nobody() {
    let folder = Folder::new();
    let server = Server::start(&Config { webhook_alarm_s: 1, ..config(&folder) }, floor()).await.unwrap();
    let at = server.address();
    let (url, taken) = receiver(3).await;
    let secret = url.replace("http://", "http://wms:pass-word@");
    let made = add(at, &json!({"url": secret, "kinds": ["job"]})).await;
    post(at, None, &delivery(0)).await.unwrap();
    let alarm = alarms(at, 1).await.remove(0);
    let listed = get(at, "/v1/webhooks").await;
    for shown in [&made.text, &listed.text, &alarm.to_string()] {
        assert!(!shown.contains("pass-word") && !shown.contains("wms:"), "{shown}");
    }
    assert_eq!(listed.json()[0]["url"], url.replace("http://", "http://***@"));
    alarms(at, 0).await;
    let head = taken.lock().unwrap()[0].0.clone();
    assert_eq!(header(&head, "authorization"), "Basic d21zOnBhc3Mtd29yZA==");
    server.stop().await.unwrap();
}

/// A server that tells a webhook at `url` of a job, and trusts these authorities.
async fn tell(folder: &Folder, url: &str, ca_file: Option<PathBuf>) -> Server {
    let server = Server::start(&Config { ca_file, ..config(folder) }, floor()).await.unwrap();
    assert_eq!(add(server.address(), &json!({"url": url, "kinds": ["job"]})).await.status, 201);
    post(server.address(), None, &delivery(0)).await.unwrap();
    server
}

#[tokio::test(flavor = "multi_thread")]
async fn a_webhook_with_a_certificate_of_a_private_authority_is_told_where_the_setting_names_that() {
    let (folder, other) = (Folder::new(), Folder::new());
    let authority = Authority::new(folder.path());
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let url = format!("https://localhost:{}/hook", listener.local_addr().unwrap().port());
    let (told, mut bodies) = tokio::sync::mpsc::unbounded_channel();
    let take = async move |body: String| told.send(body).map_err(|_| axum::http::StatusCode::GONE);
    let router = axum::Router::new().route("/hook", routing::post(take));
    tokio::spawn(serve_tls(listener, authority.server_config(), router));

    let server = tell(&other, &url, None).await;
    let listed = failing(server.address()).await;
    let why = listed[0]["failing"].as_str().unwrap();
    assert!(why.contains("`ca_file` names others"), "{why}");
    server.stop().await.unwrap();

    let server = tell(&folder, &url, Some(authority.file.clone())).await;
    let body = in_time("the webhook is told", bodies.recv()).await.unwrap();
    assert!(body.contains("\"new\":\"waiting\""), "{body}");
    server.stop().await.unwrap();
}

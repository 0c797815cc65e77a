//! Named tokens: made, renewed, revoked and expired while the server runs.

use crate::helper::{Answer, Folder, SCENARIO, config, eventually, floor, in_time, send, start};
use futures_util::StreamExt;
use giveway::server::{Config, Server};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::process::Command;
use std::time::Duration;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;

/// The token of the settings.
pub const ADMIN: &str = "a-long-enough-token";

/// A server that needs tokens.
pub async fn start_closed(folder: &Folder) -> Server {
    Server::start(&Config { token: Some(ADMIN.into()), ..config(folder) }, floor()).await.unwrap()
}

/// Waits until the robots of the floor have joined.
pub async fn until_robots(at: SocketAddr, token: &str) {
    let have_joined = async || {
        let listed = with(at, token, "GET", "/v1/robots", "").await.json();
        listed["items"].as_array().is_some_and(|robots| robots.len() == 2).then_some(())
    };
    eventually("the robots join", have_joined).await;
}

/// A request with a token.
pub async fn with(at: SocketAddr, token: &str, method: &str, path: &str, body: &str) -> Answer {
    let bearer = format!("Bearer {token}");
    let mut headers = vec![("authorization", bearer.as_str())];
    headers.extend((!body.is_empty()).then_some(("content-type", "application/json")));
    send(at, method, path, &headers, body).await.unwrap()
}

/// Makes a token with the one of the settings; gives the answer.
pub async fn make(at: SocketAddr, name: &str, role: &str, subject: Option<&str>) -> Value {
    let body = json!({"name": name, "role": role, "subject": subject}).to_string();
    let made = with(at, ADMIN, "POST", "/v1/tokens", &body).await;
    assert_eq!(made.status, 201, "{made:?}");
    made.json()
}

fn text(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap_or_else(|| panic!("{key} of {value}")).to_owned()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_token_is_shown_once_and_holds_until_it_is_rotated_or_revoked() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    let made = make(at, "night shift", "viewer", None).await;
    let (token, id) = (text(&made, "token"), text(&made, "id"));
    assert_eq!(with(at, &token, "GET", "/v1/robots", "").await.status, 200);
    let listed = with(at, ADMIN, "GET", "/v1/tokens", "").await;
    assert!(!listed.text.contains(&token), "the server does not know it");
    assert_eq!(
        (&listed.json()["items"][0]["name"], &listed.json()["items"][0]["holds"]),
        (&json!("night shift"), &json!(true))
    );
    with(at, &token, "GET", "/v1/tokens", "").await.problem(403);
    let again = json!({"name": "night shift", "role": "viewer"}).to_string();
    with(at, ADMIN, "POST", "/v1/tokens", &again).await.problem(409);

    let rotated = with(at, ADMIN, "POST", &format!("/v1/tokens/{id}/rotate"), "").await.json();
    let fresh = text(&rotated, "token");
    assert_eq!((&rotated["id"], fresh == token), (&json!(id), false));
    with(at, &token, "GET", "/v1/robots", "").await.problem(401);
    assert_eq!(with(at, &fresh, "GET", "/v1/robots", "").await.status, 200);

    assert_eq!(with(at, ADMIN, "DELETE", &format!("/v1/tokens/{id}"), "").await.status, 204);
    with(at, &fresh, "GET", "/v1/robots", "").await.problem(401);
    with(at, ADMIN, "DELETE", &format!("/v1/tokens/{id}"), "").await.problem(404);
    with(at, ADMIN, "POST", &format!("/v1/tokens/{id}/rotate"), "").await.problem(404);
    assert!(with(at, ADMIN, "GET", "/v1/tokens", "").await.json()["items"][0]["revoked"].is_string());
    make(at, "night shift", "viewer", None).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn tokens_with_wrong_fields_are_refused_and_those_that_expire_do() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    for (body, field) in [
        (json!({"name": "", "role": "viewer"}), "name"),
        (json!({"name": "configuration", "role": "viewer"}), "name"),
        (json!({"name": "a", "role": "device"}), "subject"),
        (json!({"name": "a", "role": "device", "subject": "w99"}), "subject"),
        (json!({"name": "a", "role": "viewer", "subject": "robot-1"}), "subject"),
        (json!({"name": "a", "role": "viewer", "expires": "2020-01-01T00:00:00Z"}), "expires"),
    ] {
        let answer = with(at, ADMIN, "POST", "/v1/tokens", &body.to_string()).await;
        assert_eq!(answer.problem(422)["errors"][0]["field"], field, "{body}");
    }
    let expires = std::time::SystemTime::now() + Duration::from_millis(1500);
    let expires = expires.duration_since(std::time::UNIX_EPOCH).unwrap().as_micros();
    let expires = giveway::api::wire::text::time_text(giveway::time::Time(expires.try_into().unwrap()));
    let body = json!({"name": "guest", "role": "viewer", "expires": expires}).to_string();
    let token = text(&with(at, ADMIN, "POST", "/v1/tokens", &body).await.json(), "token");
    assert_eq!(with(at, &token, "GET", "/v1/robots", "").await.status, 200);
    tokio::time::sleep(Duration::from_millis(1600)).await;
    with(at, &token, "GET", "/v1/robots", "").await.problem(401);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_live_feed_ends_when_its_token_is_revoked() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    let made = make(at, "wall screen", "viewer", None).await;
    let mut request = format!("ws://{at}/v1/live").into_client_request().unwrap();
    let offer = format!("giveway, bearer.{}", text(&made, "token"));
    request.headers_mut().insert("sec-websocket-protocol", offer.parse().unwrap());
    let (mut socket, _) = tokio_tungstenite::connect_async(request).await.unwrap();
    assert!(matches!(socket.next().await, Some(Ok(Message::Text(_)))));
    with(at, ADMIN, "DELETE", &format!("/v1/tokens/{}", text(&made, "id")), "").await;
    let closed = async {
        loop {
            match socket.next().await {
                Some(Ok(Message::Close(Some(frame)))) => return frame.reason.to_string(),
                Some(Ok(_)) => {}
                other => panic!("{other:?}"),
            }
        }
    };
    let reason = in_time("the feed is closed", closed).await;
    assert!(reason.contains("no longer holds"), "{reason}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_open_server_needs_tokens_from_the_first_administrator_on() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let post = async |body: Value| {
        let headers = [("content-type", "application/json")];
        send(at, "POST", "/v1/tokens", &headers, &body.to_string()).await.unwrap()
    };
    assert_eq!(post(json!({"name": "screen", "role": "viewer"})).await.status, 201);
    assert_eq!(send(at, "GET", "/v1/robots", &[], "").await.unwrap().status, 200, "it is still open");
    let admin = text(&post(json!({"name": "chief", "role": "admin"})).await.json(), "token");
    send(at, "GET", "/v1/robots", &[], "").await.unwrap().problem(401);
    assert_eq!(with(at, &admin, "GET", "/v1/robots", "").await.status, 200);
    server.stop().await.unwrap();
    // After a restart, too; and it may be reached from elsewhere.
    let server =
        Server::start(&Config { listen: "0.0.0.0:0".into(), ..config(&folder) }, floor()).await.unwrap();
    let at = SocketAddr::from(([127, 0, 0, 1], server.address().port()));
    send(at, "GET", "/v1/robots", &[], "").await.unwrap().problem(401);
    assert_eq!(with(at, &admin, "GET", "/v1/robots", "").await.status, 200);
    server.stop().await.unwrap();
}

/// `giveway token …` on the database of a test.
fn token_command(folder: &Folder, arguments: &[&str]) -> (bool, Value) {
    let database = folder.database();
    let run = Command::new(env!("CARGO_BIN_EXE_giveway"))
        .arg("token")
        .args(arguments)
        .args(["--json", "--database", database.to_str().unwrap()])
        .env("GIVEWAY_SCENARIO", SCENARIO)
        .output()
        .unwrap();
    (run.status.success(), serde_json::from_slice(&run.stdout).unwrap_or_default())
}

#[tokio::test(flavor = "multi_thread")]
async fn the_command_line_makes_and_revokes_tokens_of_a_running_server() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    let (ok, made) = token_command(&folder, &["add", "erp", "--role", "integrator", "--days", "30"]);
    assert!(ok, "{made}");
    let token = text(&made[0], "token");
    let until = async |status: u16| {
        let is_so = async || {
            (with(at, &token, "GET", "/v1/health", "").await.status == 200
                && with(at, &token, "GET", "/v1/jobs", "").await.status == status)
                .then_some(())
        };
        eventually(&format!("jobs are answered with {status}"), is_so).await;
    };
    until(200).await;
    assert!(!token_command(&folder, &["add", "erp", "--role", "viewer"]).0, "the name is taken");
    assert!(!token_command(&folder, &["add", "x", "--role", "king"]).0);
    let (_, listed) = token_command(&folder, &["list"]);
    assert_eq!((&listed[0]["name"], &listed[0]["role"]), (&json!("erp"), &json!("integrator")));
    assert!(token_command(&folder, &["revoke", "erp"]).0);
    until(401).await;
    assert!(!token_command(&folder, &["revoke", "erp"]).0, "it was revoked before");
    server.stop().await.unwrap();
}

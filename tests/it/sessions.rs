//! Signing in and out of a browser: the cookie, who may use it, and what ends it.

use crate::helper::{Answer, Folder, config, eventually, floor, get, in_time, send};
use crate::tokens::{ADMIN, make, start_closed, with};
use futures_util::StreamExt;
use giveway::server::{Config, Server};
use serde_json::{Value, json};
use std::net::SocketAddr;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};

/// Signs in as a page of the server does; gives the answer and the cookie.
async fn sign_in(at: SocketAddr, token: &str) -> (Answer, String) {
    let body = json!({ "token": token }).to_string();
    let origin = format!("http://{at}");
    let headers = [("content-type", "application/json"), ("origin", origin.as_str())];
    let answer = send(at, "POST", "/v1/session", &headers, &body).await.unwrap();
    let cookie = answer.header("set-cookie").and_then(|c| c.split(';').next()).unwrap_or_default().to_owned();
    (answer, cookie)
}

/// A request with a cookie, and headers as browsers add them.
async fn ask(at: SocketAddr, cookie: &str, request: (&str, &str), more: &[(&str, &str)]) -> Answer {
    let headers: Vec<(&str, &str)> = [("cookie", cookie)].into_iter().chain(more.iter().copied()).collect();
    send(at, request.0, request.1, &headers, "").await.unwrap()
}

/// What the audit says of signing in and out, oldest first: who, and what.
async fn signed(at: SocketAddr, wanted: usize) -> Vec<(String, String)> {
    eventually(&format!("the audit has {wanted} entries"), async || {
        let listed = with(at, ADMIN, "GET", "/v1/audit", "").await.json();
        let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        let items = listed["items"].as_array().unwrap().iter().rev();
        let of_sessions = items.filter(|e| text(e, "what").ends_with("/v1/session"));
        let found: Vec<_> = of_sessions.map(|e| (text(e, "actor"), text(e, "what"))).collect();
        (found.len() >= wanted).then_some(found)
    })
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_cookie_stands_for_the_token_until_its_user_signs_out() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    let token = make(at, "night shift", "operator", None).await["token"].as_str().unwrap().to_owned();
    with(at, "wrong-token-of-nobody", "GET", "/v1/session", "").await.problem(401);
    let (refused, cookie) = sign_in(at, "wrong-token-of-nobody").await;
    refused.problem(401);
    assert_eq!(cookie, "", "a wrong token gets no cookie");

    let (answer, cookie) = sign_in(at, &token).await;
    assert_eq!(answer.status, 201, "{answer:?}");
    let set = answer.header("set-cookie").unwrap();
    assert!(set.contains("; Path=/; HttpOnly; SameSite=Strict"), "{set}");
    assert!(!set.contains("Secure"), "a browser would not keep it over plain HTTP: {set}");
    assert!(!answer.text.contains(cookie.split_once('=').unwrap().1), "scripts cannot read it");
    let me = ask(at, &cookie, ("GET", "/v1/session"), &[]).await.json();
    assert_eq!(
        (&me["name"], &me["role"], &me["by"]),
        (&json!("night shift"), &json!("operator"), &json!("session"))
    );
    assert!(me["expires"].is_string(), "{me}");

    let own = format!("http://{at}");
    let stop = ("POST", "/v1/fleet/stop");
    ask(at, &cookie, stop, &[]).await.problem(403);
    ask(at, &cookie, stop, &[("origin", "http://evil.example")]).await.problem(403);
    ask(at, &cookie, stop, &[("sec-fetch-site", "same-site")]).await.problem(403);
    assert_eq!(ask(at, &cookie, stop, &[("origin", &own)]).await.status, 204);
    assert_eq!(
        ask(at, &cookie, ("POST", "/v1/fleet/resume"), &[("sec-fetch-site", "same-origin")]).await.status,
        204
    );
    ask(at, &cookie, ("GET", "/v1/tokens"), &[]).await.problem(403);

    let out = ask(at, &cookie, ("DELETE", "/v1/session"), &[("origin", &own)]).await;
    assert_eq!(out.status, 204, "{out:?}");
    assert!(out.header("set-cookie").unwrap().contains("Max-Age=0"), "{out:?}");
    ask(at, &cookie, ("GET", "/v1/session"), &[]).await.problem(401);
    let again = ask(at, &cookie, ("DELETE", "/v1/session"), &[("origin", &own)]).await;
    assert_eq!(again.status, 204, "who is not signed in can still have the cookie taken away");
    let of = |what: &str| ("night shift".to_owned(), what.to_owned());
    assert_eq!(signed(at, 2).await, [of("POST /v1/session"), of("DELETE /v1/session")]);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_survives_a_restart_and_ends_with_its_token() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    let made = make(at, "anna", "viewer", None).await;
    let token = made["token"].as_str().unwrap().to_owned();
    let rotate = format!("/v1/tokens/{}/rotate", made["id"].as_str().unwrap());
    let (_, of_anna) = sign_in(at, &token).await;
    let (_, of_settings) = sign_in(at, ADMIN).await;
    server.stop().await.unwrap();

    let bytes = std::fs::read(folder.database()).unwrap();
    let secret = of_anna.split_once('=').unwrap().1;
    assert!(!bytes.windows(secret.len()).any(|w| w == secret.as_bytes()), "the database has its digest only");
    let listen = at.to_string();
    let restart = async |token: &str| {
        let settings = Config { token: Some(token.into()), listen: listen.clone(), ..config(&folder) };
        Server::start(&settings, floor()).await.unwrap()
    };
    let server = restart(ADMIN).await;
    for (cookie, name) in [(&of_anna, "anna"), (&of_settings, "configuration")] {
        assert_eq!(ask(at, cookie, ("GET", "/v1/session"), &[]).await.json()["name"], name);
    }
    assert_eq!(with(at, ADMIN, "POST", &rotate, "").await.status, 200);
    ask(at, &of_anna, ("GET", "/v1/session"), &[]).await.problem(401);
    server.stop().await.unwrap();

    let server = restart("another-long-enough-token").await;
    ask(at, &of_settings, ("GET", "/v1/session"), &[]).await.problem(401);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_feed_opens_with_the_cookie_for_own_pages_alone_and_ends_with_the_session() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    let (_, cookie) = sign_in(at, ADMIN).await;
    let own = format!("http://{at}");
    let open = async |origin: Option<&str>| {
        let mut request = format!("ws://{at}/v1/live").into_client_request().unwrap();
        request.headers_mut().insert("cookie", cookie.parse().unwrap());
        origin.map(|origin| request.headers_mut().insert("origin", origin.parse().unwrap()));
        tokio_tungstenite::connect_async(request).await
    };
    for foreign in [None, Some("http://evil.example"), Some("http://localhost:1")] {
        let Err(Error::Http(refused)) = open(foreign).await else { panic!("{foreign:?} opens a feed") };
        assert_eq!(refused.status(), 403, "{foreign:?}");
    }
    let (mut feed, _) = open(Some(&own)).await.expect("an own page");
    assert!(matches!(feed.next().await, Some(Ok(Message::Text(_)))));
    let stream = ask(at, &cookie, ("GET", "/v1/events?after=0"), &[("sec-fetch-site", "cross-site")]).await;
    stream.problem(403);
    assert_eq!(ask(at, &cookie, ("DELETE", "/v1/session"), &[("origin", &own)]).await.status, 204);
    let closed = async {
        while let Some(Ok(message)) = feed.next().await {
            if let Message::Close(Some(frame)) = message {
                return frame.reason.to_string();
            }
        }
        String::new()
    };
    let reason = in_time("the feed is closed", closed).await;
    assert!(reason.contains("no longer"), "{reason}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_without_tokens_asks_nobody_to_sign_in() {
    let folder = Folder::new();
    let server = crate::helper::start(&folder).await;
    let me = get(server.address(), "/v1/session").await.json();
    assert_eq!(
        (&me["name"], &me["role"], &me["by"]),
        (&json!("this machine"), &json!("admin"), &json!("nothing"))
    );
    let (refused, _) = sign_in(server.address(), "wrong-token-of-nobody").await;
    refused.problem(401);
    server.stop().await.unwrap();
}

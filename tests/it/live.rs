//! The live feed over a real WebSocket.

use crate::helper::{Folder, config, floor, in_time, map, start};
use futures_util::StreamExt;
use giveway::server::{Config, Server};
use serde_json::Value;
use std::net::SocketAddr;
use std::time::Duration;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

type Socket = WebSocketStream<MaybeTlsStream<tokio::net::TcpStream>>;

pub async fn connect(at: SocketAddr, query: &str, protocols: &str) -> Result<Socket, Error> {
    let mut request = format!("ws://{at}/v1/live{query}").into_client_request()?;
    if !protocols.is_empty() {
        request.headers_mut().insert("sec-websocket-protocol", protocols.parse().unwrap());
    }
    connect_async(request).await.map(|(socket, _)| socket)
}

/// The next text; `None` when the feed ends.
pub async fn next(socket: &mut Socket) -> Option<Value> {
    loop {
        let message = in_time("a message of the live feed", socket.next()).await;
        match message {
            Some(Ok(Message::Text(text))) => return Some(serde_json::from_str(&text).unwrap()),
            Some(Ok(Message::Close(_)) | Err(_)) | None => return None,
            Some(Ok(_)) => {}
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_reader_gets_a_snapshot_then_patches_and_resumes_where_it_was() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut socket = connect(at, "", "giveway").await.unwrap();
    let snapshot = next(&mut socket).await.unwrap();
    assert_eq!(snapshot["type"], "snapshot");
    assert_eq!(snapshot["racks"].as_array().unwrap().len(), map().racks.len());
    for key in ["robots", "stations", "workers", "closures", "alarms"] {
        assert!(snapshot[key].is_array(), "{key} of {snapshot}");
    }
    for key in ["waiting", "active", "done", "cancelled", "failed"] {
        assert!(snapshot["jobs"][key].is_u64(), "{key} of {snapshot}");
    }
    for key in
        ["robot_deliveries", "human_deliveries", "encounters", "plan_us_p50", "plan_us_p99", "step_us_p99"]
    {
        assert!(snapshot["counters"][key].is_u64(), "{key} of {snapshot}");
    }
    let mut version = snapshot["version"].as_u64().unwrap();
    for _ in 0..5 {
        let patch = next(&mut socket).await.unwrap();
        assert_eq!((patch["type"].as_str(), patch["base"].as_u64()), (Some("patch"), Some(version)));
        version = patch["version"].as_u64().unwrap();
    }
    drop(socket);
    tokio::time::sleep(Duration::from_millis(300)).await;
    let mut again = connect(at, &format!("?since={version}"), "").await.unwrap();
    let patch = next(&mut again).await.unwrap();
    assert_eq!((patch["type"].as_str(), patch["base"].as_u64()), (Some("patch"), Some(version)));
    let mut stranger = connect(at, "?since=3", "").await.unwrap();
    assert_eq!(next(&mut stranger).await.unwrap()["type"], "snapshot");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn gaze_and_hands_come_to_those_who_ask() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    crate::feed::hire(at, "anna").await;
    let mut asks = connect(at, "?senses=true", "").await.unwrap();
    let mut others = connect(at, "", "").await.unwrap();
    assert_eq!(next(&mut asks).await.unwrap()["type"], "snapshot");
    let senses = next(&mut asks).await.unwrap();
    assert_eq!((senses["type"].as_str(), senses["workers"][0]["id"].as_str()), (Some("senses"), Some("w1")));
    assert!(senses["workers"][0]["hands"]["l"].is_null() && senses["workers"][0].get("gaze").is_some());
    assert_eq!(next(&mut asks).await.unwrap()["type"], "patch");
    assert_eq!(next(&mut others).await.unwrap()["type"], "snapshot");
    assert_eq!(next(&mut others).await.unwrap()["type"], "patch");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_feed_ends_in_order_when_the_server_goes_down() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let mut socket = connect(server.address(), "", "").await.unwrap();
    let reader = tokio::spawn(async move {
        loop {
            match socket.next().await {
                Some(Ok(Message::Close(why))) => return why,
                Some(Ok(_)) => {}
                other => panic!("{other:?}"),
            }
        }
    });
    in_time("an open feed does not hold the server up", server.stop()).await.unwrap();
    assert!(reader.await.unwrap().is_some(), "it says why it ends");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_token_comes_as_a_protocol() {
    let folder = Folder::new();
    let config = Config { token: Some("the-token-of-the-page".into()), ..config(&folder) };
    let server = Server::start(&config, floor()).await.unwrap();
    let at = server.address();
    let status = |result: Result<Socket, Error>| match result {
        Err(Error::Http(response)) => response.status().as_u16(),
        other => panic!("{other:?}"),
    };
    assert_eq!(status(connect(at, "", "giveway").await), 401);
    assert_eq!(status(connect(at, "", "giveway, bearer.wrong").await), 401);
    let mut socket = connect(at, "", "giveway, bearer.the-token-of-the-page").await.unwrap();
    assert_eq!(next(&mut socket).await.unwrap()["type"], "snapshot");
    server.stop().await.unwrap();
}

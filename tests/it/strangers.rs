//! Clients that say nothing, half of something, or the wrong token: they keep nobody out.

use crate::helper::{Folder, get, in_time, send, start};
use std::net::SocketAddr;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

async fn connect(at: SocketAddr, says: &str) -> TcpStream {
    let mut stream = TcpStream::connect(at).await.unwrap();
    stream.write_all(says.as_bytes()).await.unwrap();
    stream
}

/// What the server says until it hangs up.
async fn until_hung_up(stream: &mut TcpStream) -> String {
    let mut said = Vec::new();
    let read = in_time("the server hangs up", stream.read_to_end(&mut said)).await;
    // Being reset is being hung up on, too.
    read.map_or_else(|_| String::new(), |_| String::from_utf8_lossy(&said).into_owned())
}

#[tokio::test(flavor = "multi_thread")]
async fn five_hundred_strangers_who_are_idle_or_slow_keep_nobody_out_and_are_hung_up_on() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    // Somebody who belongs here keeps the connection.
    let mut operator = connect(at, "GET /v1/robots HTTP/1.1\r\nhost: localhost\r\n\r\n").await;
    let mut head = [0; 12];
    operator.read_exact(&mut head).await.unwrap();
    assert_eq!(&head, b"HTTP/1.1 200");
    let mut slow_body = connect(
        at,
        "POST /v1/workers HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 99\r\n\r\n{",
    )
    .await;
    let mut strangers = Vec::new();
    for i in 0..500 {
        let says = if i % 2 == 0 { "" } else { "GET /v1/health HTTP/1.1\r\nhost: loc" };
        strangers.push(connect(at, says).await);
        if i % 100 == 99 {
            assert_eq!(get(at, "/v1/health").await.status, 200);
            let name = format!(r#"{{"name": "picker-{i}"}}"#);
            let hired = send(at, "POST", "/v1/workers", &[("content-type", "application/json")], &name);
            assert_eq!(hired.await.unwrap().status, 201);
        }
    }
    // The oldest had to leave for the newest.
    until_hung_up(&mut strangers[0]).await;
    operator.write_all(b"GET /v1/health HTTP/1.1\r\nhost: localhost\r\n\r\n").await.unwrap();
    let answered = in_time("the operator is answered", operator.read_exact(&mut head)).await;
    assert!(answered.is_ok(), "the operator's connection is still good");
    // These never say what they want.
    for stranger in &mut strangers[480..] {
        until_hung_up(stranger).await;
    }
    let answer = until_hung_up(&mut slow_body).await;
    // It was a stranger itself, so it may have had to leave before the time for its body was over.
    assert!(answer.is_empty() || answer.contains(" 408 "), "{answer:?}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_that_does_not_come_in_time_is_refused_with_408() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let mut slow = connect(
        server.address(),
        "POST /v1/workers HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 99\r\n\r\n{",
    )
    .await;
    let mut head = [0; 12];
    in_time("it is answered", slow.read_exact(&mut head)).await.unwrap();
    assert_eq!(&head, b"HTTP/1.1 408");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_answer_says_for_how_long_its_connection_is_kept() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    for (path, told) in [("/v1/robots", "timeout=60"), ("/openapi.json", "timeout=10")] {
        let mut stream = connect(at, &format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n")).await;
        let mut said = String::new();
        while !said.contains("\r\n\r\n") {
            let mut some = [0; 512];
            let n = stream.read(&mut some).await.unwrap();
            said += &String::from_utf8_lossy(&some[..n]);
        }
        assert!(said.to_lowercase().contains(&format!("keep-alive: {told}\r\n")), "{path}: {said}");
    }
    assert_eq!(get(at, "/v1/robots").await.header("keep-alive"), None, "it was asked to close");
    server.stop().await.unwrap();
}

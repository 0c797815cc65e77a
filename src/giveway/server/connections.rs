//! Serves connections until the server closes.
//!
//! Main function: [`serve`]. A client must make progress in both directions: send its request, and take what it is
//! sent. Refuses: to let connections of strangers, or of stalled clients, keep others out.

use super::budget::{Budget, Guest};
use super::metered::{BodyKind, CountedBody, Metered};
use super::tls::shake;
use axum::Router;
use axum::body::Body;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Request, Response, StatusCode, Version, header};
use giveway_api::{Peer, Recognised, SharedBody};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::pin::pin;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::JoinSet;
use tokio::time::{interval, sleep};
use tokio_rustls::TlsAcceptor;
use tower::ServiceExt;

/// How long a known connection may take to its next request; strangers have less time (`Guest::is_overdue`).
const KEPT: Duration = Duration::from_secs(75);
/// The timeout that known clients are told. They should stop some time before the server does.
const TOLD_KNOWN: &str = "timeout=60";
/// The timeout that strangers are told.
const TOLD_STRANGERS: &str = "timeout=10";
/// How often the server checks whether a connection is overdue.
const LOOK: Duration = Duration::from_secs(1);
/// The most bytes that are written for a client and not yet taken, besides one piece of a body.
const BUFFER: usize = 64 << 10;
/// How many open descriptors the server requests from the system, if it may have so many.
const DESCRIPTORS: u64 = 65_536;

/// What all connections share.
#[derive(Clone)]
struct ConnectionService {
    router: Router,
    /// Present if the server speaks HTTPS.
    tls: Option<TlsAcceptor>,
    closes: watch::Receiver<bool>,
}

/// Serves every connection to a listener, with TLS if there is a certificate, until `closes` turns true; then ends the
/// connections in order.
pub(super) async fn serve(
    listener: TcpListener,
    tls: Option<Arc<rustls::ServerConfig>>,
    router: Router,
    mut closes: watch::Receiver<bool>,
) {
    let budget = Budget::of(descriptors());
    let service = ConnectionService { router, tls: tls.map(TlsAcceptor::from), closes: closes.clone() };
    let mut open = JoinSet::new();
    loop {
        tokio::select! {
            (stream, from) = accept(&listener) => {
                let guest = Arc::new(budget.arrive(from.ip(), Instant::now()));
                open.spawn(begin(stream, from, service.clone(), guest));
            }
            Some(_) = open.join_next() => {}
            () = is_closing(&mut closes) => break,
        }
    }
    while open.join_next().await.is_some() {}
}

/// The next connection.
async fn accept(listener: &TcpListener) -> (TcpStream, SocketAddr) {
    loop {
        match listener.accept().await {
            Ok((stream, from)) => {
                if let Err(e) = stream.set_nodelay(true) {
                    tracing::debug!("TCP_NODELAY: {e}");
                }
                return (stream, from);
            }
            Err(e) if is_of_client(&e) => {}
            Err(e) => {
                tracing::warn!("cannot accept a connection: {e}");
                sleep(LOOK).await;
            }
        }
    }
}

/// Whether the error means that a client went away before it was accepted.
fn is_of_client(e: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
    matches!(e.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset)
}

/// Serves one connection, from its first byte.
async fn begin(stream: TcpStream, from: SocketAddr, service: ConnectionService, guest: Arc<Guest>) {
    let Some(acceptor) = service.tls.clone() else { return connection(stream, from, service, guest).await };
    let shaken = tokio::select! {
        shaken = shake(stream, &acceptor) => shaken,
        () = guest.is_to_leave() => return,
    };
    match shaken {
        Ok(Some(stream)) => connection(stream, from, service, guest).await,
        Ok(None) => tracing::debug!("{from} spoke plain HTTP"),
        Err(e) => tracing::debug!("handshake with {from}: {e}"),
    }
}

/// Serves the requests of a connection, to the last, or until it becomes a WebSocket.
async fn connection<I>(io: I, from: SocketAddr, service: ConnectionService, guest: Arc<Guest>)
where
    I: tokio::io::AsyncRead + tokio::io::AsyncWrite + Unpin + Send + 'static,
{
    let ConnectionService { router, mut closes, .. } = service;
    let answers = guest.clone();
    let service = hyper::service::service_fn(move |request: Request<Incoming>| {
        answer(router.clone(), answers.clone(), Peer(from.ip()), request)
    });
    let http = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(KEPT)
        .max_buf_size(BUFFER)
        .serve_connection(TokioIo::new(Metered::new(io, guest.clone())), service)
        .with_upgrades();
    let mut http = pin!(http);
    let ended = tokio::select! {
        ended = http.as_mut() => ended,
        () = guest.is_to_leave() => return,
        () = is_overdue(&guest) => return,
        () = is_closing(&mut closes) => {
            http.as_mut().graceful_shutdown();
            http.await
        }
    };
    if let Err(e) = ended {
        tracing::debug!("connection from {from}: {e}");
    }
}

/// Waits until a stranger has sent no request for too long.
async fn is_overdue(guest: &Guest) {
    let mut looks = interval(LOOK);
    while !guest.is_overdue(Instant::now()) {
        looks.tick().await;
    }
}

/// Waits until the server closes.
async fn is_closing(closes: &mut watch::Receiver<bool>) {
    _ = closes.wait_for(|closing| *closing).await.is_ok();
}

async fn answer(
    router: Router,
    guest: Arc<Guest>,
    from: Peer,
    request: Request<Incoming>,
) -> Result<Response<CountedBody>, Infallible> {
    guest.asks();
    let is_kept = request.version() == Version::HTTP_11 && !asks_to_close(request.headers());
    let mut request = request.map(Body::new);
    request.extensions_mut().insert(from);
    let mut response = router.oneshot(request).await.unwrap_or_else(|never| match never {});
    if response.extensions().get::<Recognised>().is_some() {
        guest.let_in();
    }
    let kind = kind_of(&response);
    if is_kept && kind != BodyKind::Upgraded {
        let told = if guest.is_known() { TOLD_KNOWN } else { TOLD_STRANGERS };
        response.headers_mut().insert(HeaderName::from_static("keep-alive"), HeaderValue::from_static(told));
    }
    Ok(response.map(|body| CountedBody::new(body, guest, kind)))
}

fn asks_to_close(headers: &HeaderMap) -> bool {
    let said = headers.get(header::CONNECTION).and_then(|v| v.to_str().ok()).unwrap_or_default();
    said.split(',').any(|word| word.trim().eq_ignore_ascii_case("close"))
}

fn kind_of(response: &Response<Body>) -> BodyKind {
    if response.status() == StatusCode::SWITCHING_PROTOCOLS {
        BodyKind::Upgraded
    } else if response.extensions().get::<SharedBody>().is_some() {
        BodyKind::Shared
    } else if response.headers().contains_key(header::CONTENT_ENCODING) {
        BodyKind::Compressed
    } else {
        BodyKind::Own
    }
}

/// How many descriptors the process may have open, after raising the limit to what the system allows: robots, headsets
/// and dashboards need one each.
fn descriptors() -> usize {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let limit = getrlimit(Resource::Nofile);
    let most = limit.maximum.unwrap_or(u64::MAX).min(DESCRIPTORS);
    let now = limit.current.unwrap_or(u64::MAX);
    let raised = if now < most {
        match setrlimit(Resource::Nofile, Rlimit { current: Some(most), maximum: limit.maximum }) {
            Ok(()) => most,
            Err(e) => {
                tracing::warn!("at most {now} descriptors: the limit cannot be raised ({e})");
                now
            }
        }
    } else {
        now.min(DESCRIPTORS)
    };
    usize::try_from(raised).unwrap_or(usize::MAX)
}

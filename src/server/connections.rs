//! Serves connections until the server closes.
//!
//! Main function: [`serve`]. The server hangs up on a client that is slow to say what it wants. Refuses: to let
//! connections of strangers keep others out.

use super::strangers::{Stranger, Strangers};
use axum::Router;
use axum::body::Body;
use axum::http::{Request, Response, StatusCode, header};
use axum::serve::Listener;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::net::{IpAddr, SocketAddr};
use std::pin::pin;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;
use tokio::task::JoinSet;
use tower::ServiceExt;

/// A request's head has to be there after so long; so has the next request of a connection that was let in.
const HEAD: Duration = Duration::from_secs(15);
/// Open descriptors that the server asks the system for, if it may have so many.
const DESCRIPTORS: u64 = 65_536;

/// Serves every connection that comes to a listener, until `closes` says so; then ends them in order.
pub(super) async fn serve<L>(mut listener: L, router: Router, mut closes: watch::Receiver<bool>)
where
    L: Listener<Addr = SocketAddr>,
{
    raise_limit();
    let strangers = Strangers::default();
    let mut open = JoinSet::new();
    let closing = closes.clone();
    loop {
        tokio::select! {
            (io, from) = listener.accept() => {
                let stranger = strangers.arrive();
                open.spawn(connection(io, from, router.clone(), strangers.clone(), stranger, closing.clone()));
            }
            Some(_) = open.join_next() => {}
            () = is_closing(&mut closes) => break,
        }
    }
    while open.join_next().await.is_some() {}
}

/// One connection, from its first byte to its last.
async fn connection<I>(
    io: I,
    from: SocketAddr,
    router: Router,
    strangers: Strangers,
    stranger: Stranger,
    mut closes: watch::Receiver<bool>,
) where
    I: tokio::io::AsyncRead + tokio::io::AsyncWrite + Unpin + Send + 'static,
{
    let stranger = Arc::new(stranger);
    let answers = stranger.clone();
    let service = hyper::service::service_fn(move |request: Request<Incoming>| {
        let (router, strangers, stranger) = (router.clone(), strangers.clone(), answers.clone());
        answer(router, (strangers, stranger), from.ip(), request)
    });
    let http = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .serve_connection(TokioIo::new(io), service)
        .with_upgrades();
    let mut http = pin!(http);
    let ended = tokio::select! {
        ended = http.as_mut() => ended,
        () = stranger.is_to_leave() => return,
        () = is_closing(&mut closes) => {
            http.as_mut().graceful_shutdown();
            http.await
        }
    };
    if let Err(e) = ended {
        tracing::debug!("connection from {from}: {e}");
    }
}

/// Waits until the server closes.
async fn is_closing(closes: &mut watch::Receiver<bool>) {
    _ = closes.wait_for(|closing| *closing).await.is_ok();
}

async fn answer(
    router: Router,
    (strangers, stranger): (Strangers, Arc<Stranger>),
    from: IpAddr,
    request: Request<Incoming>,
) -> Result<Response<Body>, Infallible> {
    let has_token = request.headers().contains_key(header::AUTHORIZATION)
        || request.headers().contains_key(header::SEC_WEBSOCKET_PROTOCOL);
    let response = router.oneshot(request.map(Body::new)).await.unwrap_or_else(|never| match never {});
    match response.status() {
        StatusCode::UNAUTHORIZED if has_token => {
            tokio::time::sleep(strangers.wrong_token(from, Instant::now())).await;
        }
        StatusCode::UNAUTHORIZED | StatusCode::FORBIDDEN => {}
        _ => stranger.let_in(),
    }
    Ok(response)
}

/// Raises the number of descriptors that the process may have open to what the system allows it: robots, headsets and
/// dashboards need one each.
fn raise_limit() {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let limit = getrlimit(Resource::Nofile);
    let most = limit.maximum.unwrap_or(u64::MAX).min(DESCRIPTORS);
    if limit.current.is_some_and(|now| now < most) {
        let wanted = Rlimit { current: Some(most), maximum: limit.maximum };
        if let Err(e) = setrlimit(Resource::Nofile, wanted) {
            tracing::warn!("at most {:?} connections: the limit cannot be raised ({e})", limit.current);
        }
    }
}

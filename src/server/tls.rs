//! Connections over TLS, as axum takes them.
//!
//! Main type: [`TlsListener`]. Handshakes run in parallel, so that a client which says nothing keeps no other one out.
//! A client that speaks plain HTTP is told so in words. Refuses: handshakes that take longer than ten seconds, and too
//! many at once.

use axum::serve::Listener;
use rustls::ServerConfig;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, mpsc};
use tokio::time::{sleep, timeout};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

/// How long a handshake may take.
const HANDSHAKE: Duration = Duration::from_secs(10);

/// How many handshakes there may be at once; others wait.
const MOST_HANDSHAKES: usize = 256;

/// The first byte of every TLS connection: a handshake record (RFC 8446, section 5.1).
const HANDSHAKE_RECORD: u8 = 22;

/// The answer to a client that speaks plain HTTP here.
const PLAIN: &str = "HTTP/1.1 400 Bad Request\r\ncontent-type: text/plain; charset=utf-8\r\nconnection: close\r\n\r\n\
    This port speaks HTTPS: write https:// before the address.\n";

/// Connections after their handshake.
pub struct TlsListener {
    ready: mpsc::Receiver<(TlsStream<TcpStream>, SocketAddr)>,
    address: SocketAddr,
}

impl TlsListener {
    /// Takes over a listener.
    ///
    /// # Errors
    /// Where the address of the listener is not known.
    pub fn new(listener: TcpListener, config: Arc<ServerConfig>) -> io::Result<TlsListener> {
        let address = listener.local_addr()?;
        let (done, ready) = mpsc::channel(MOST_HANDSHAKES);
        tokio::spawn(accept(listener, TlsAcceptor::from(config), done));
        Ok(TlsListener { ready, address })
    }
}

impl Listener for TlsListener {
    type Io = TlsStream<TcpStream>;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Self::Io, Self::Addr) {
        match self.ready.recv().await {
            Some(connection) => connection,
            None => std::future::pending().await,
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        Ok(self.address)
    }
}

type Done = mpsc::Sender<(TlsStream<TcpStream>, SocketAddr)>;

/// Accepts until the listener is dropped.
async fn accept(listener: TcpListener, acceptor: TlsAcceptor, done: Done) {
    let room = Arc::new(Semaphore::new(MOST_HANDSHAKES));
    loop {
        let permit = room.clone().acquire_owned().await.expect("the semaphore is never closed");
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = done.closed() => return,
        };
        let (stream, from) = match accepted {
            Ok(accepted) => accepted,
            Err(e) => {
                // Mostly too many open files: some will be closed soon.
                tracing::warn!("cannot accept a connection: {e}");
                sleep(Duration::from_secs(1)).await;
                continue;
            }
        };
        let (acceptor, done) = (acceptor.clone(), done.clone());
        tokio::spawn(async move {
            match timeout(HANDSHAKE, shake(stream, &acceptor)).await {
                Ok(Ok(Some(stream))) => _ = done.send((stream, from)).await,
                Ok(Ok(None)) => tracing::debug!("{from} spoke plain HTTP"),
                Ok(Err(e)) => tracing::debug!("handshake with {from}: {e}"),
                Err(_) => tracing::debug!("handshake with {from}: it took too long"),
            }
            drop(permit);
        });
    }
}

/// A connection after its handshake; none if the client speaks plain HTTP.
async fn shake(mut stream: TcpStream, acceptor: &TlsAcceptor) -> io::Result<Option<TlsStream<TcpStream>>> {
    stream.set_nodelay(true)?;
    let mut first = [0];
    if stream.peek(&mut first).await? == 1 && first[0] != HANDSHAKE_RECORD {
        stream.write_all(PLAIN.as_bytes()).await?;
        stream.shutdown().await?;
        return Ok(None);
    }
    acceptor.accept(stream).await.map(Some)
}

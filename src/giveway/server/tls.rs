//! The first bytes of a connection if the server speaks HTTPS.
//!
//! Main function: [`shake`]. A client that speaks plain HTTP is told so in words. Refuses: handshakes that take longer
//! than ten seconds.

use std::io;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

/// How long a handshake may take.
const HANDSHAKE: Duration = Duration::from_secs(10);

/// The first byte of every TLS connection: a handshake record (RFC 8446, section 5.1).
const HANDSHAKE_RECORD: u8 = 22;

/// The answer to a client that speaks plain HTTP here.
const PLAIN: &str = "HTTP/1.1 400 Bad Request\r\ncontent-type: text/plain; charset=utf-8\r\nconnection: close\r\n\r\n\
    This port speaks HTTPS: write https:// before the address.\n";

/// A connection after its handshake; nothing if the client speaks plain HTTP.
///
/// # Errors
/// If the handshake fails or takes too long.
pub(super) async fn shake(
    stream: TcpStream,
    acceptor: &TlsAcceptor,
) -> io::Result<Option<TlsStream<TcpStream>>> {
    timeout(HANDSHAKE, begin(stream, acceptor)).await.map_err(|_| io::Error::from(io::ErrorKind::TimedOut))?
}

async fn begin(mut stream: TcpStream, acceptor: &TlsAcceptor) -> io::Result<Option<TlsStream<TcpStream>>> {
    let mut first = [0];
    if stream.peek(&mut first).await? == 1 && first[0] != HANDSHAKE_RECORD {
        stream.write_all(PLAIN.as_bytes()).await?;
        stream.shutdown().await?;
        return Ok(None);
    }
    acceptor.accept(stream).await.map(Some)
}

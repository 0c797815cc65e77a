//! Counts a connection's outgoing bytes: those that wait, and those that the client takes.
//!
//! Main types: [`Metered`] (around a socket), [`CountedBody`] (around an answer). Refuses: clients that take an answer
//! more slowly than [`LEAST`] bytes in [`PATIENCE`]; even people with a bad connection are faster.

use super::budget::Guest;
use axum::body::{Body, HttpBody};
use bytes::Bytes;
use hyper::body::{Frame, SizeHint};
use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::{Duration, Instant};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Sleep, sleep};

/// While bytes wait, a client must take this many of them within [`PATIENCE`], or all of them.
const LEAST: usize = 16 << 10;
/// The time within which a client must take [`LEAST`] bytes.
const PATIENCE: Duration = Duration::from_secs(15);
/// Approximate memory for compressing an answer.
const COMPRESSOR: usize = 1 << 20;

/// A socket whose client must make progress.
pub(super) struct Metered<I> {
    io: I,
    guest: Arc<Guest>,
    patience: Duration,
    /// If the client keeps the server waiting: when it must have taken [`LEAST`] bytes, and how many it has taken.
    waits: Option<(Pin<Box<Sleep>>, usize)>,
}

impl<I> Metered<I> {
    /// The socket of a connection.
    pub fn new(io: I, guest: Arc<Guest>) -> Metered<I> {
        Metered { io, guest, patience: PATIENCE, waits: None }
    }

    /// The result of an attempt to write or flush `wanted` bytes, after checking the client's progress.
    fn judged(
        &mut self,
        cx: &mut Context<'_>,
        wanted: usize,
        polled: Poll<io::Result<usize>>,
    ) -> Poll<io::Result<usize>> {
        match polled {
            Poll::Ready(Ok(taken)) => {
                self.guest.takes(taken, Instant::now());
                if let Some((_, before)) = &mut self.waits {
                    *before += taken;
                    if taken == wanted || *before >= LEAST {
                        self.waits = None;
                    }
                }
                Poll::Ready(Ok(taken))
            }
            Poll::Pending => {
                let patience = self.patience;
                let (deadline, _) = self.waits.get_or_insert_with(|| (Box::pin(sleep(patience)), 0));
                ready!(deadline.as_mut().poll(cx));
                Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client takes nothing")))
            }
            failed => failed,
        }
    }

    /// Fails if the connection was told to leave.
    fn stays(&self) -> io::Result<()> {
        if self.guest.is_told() { Err(io::ErrorKind::ConnectionAborted.into()) } else { Ok(()) }
    }
}

impl<I: AsyncRead + Unpin> AsyncRead for Metered<I> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        self.stays()?;
        Pin::new(&mut self.io).poll_read(cx, buffer)
    }
}

impl<I: AsyncWrite + Unpin> AsyncWrite for Metered<I> {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.stays()?;
        let polled = Pin::new(&mut self.io).poll_write(cx, bytes);
        self.judged(cx, bytes.len(), polled)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        parts: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        self.stays()?;
        let polled = Pin::new(&mut self.io).poll_write_vectored(cx, parts);
        self.judged(cx, parts.iter().map(|part| part.len()).sum(), polled)
    }

    fn is_write_vectored(&self) -> bool {
        self.io.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        let polled = Pin::new(&mut self.io).poll_flush(cx).map_ok(|()| 0);
        self.judged(cx, 0, polled).map_ok(|_| ())
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        let polled = Pin::new(&mut self.io).poll_shutdown(cx).map_ok(|()| 0);
        self.judged(cx, 0, polled).map_ok(|_| ())
    }
}

/// The body of an answer, whose bytes count as waiting from their creation until the client takes them.
pub(super) struct CountedBody {
    inner: Body,
    guest: Arc<Guest>,
    kind: BodyKind,
}

/// The kind of an answer's body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BodyKind {
    /// The body was made for this answer.
    Own,
    /// The body was made for this answer, and is compressed while it is sent.
    Compressed,
    /// The body is in memory once for all clients: it costs nothing.
    Shared,
    /// The connection becomes a WebSocket, for which HTTP's idle time does not apply.
    Upgraded,
}

impl CountedBody {
    /// The body of an answer on a connection.
    pub fn new(inner: Body, guest: Arc<Guest>, kind: BodyKind) -> CountedBody {
        if kind == BodyKind::Compressed {
            guest.is_sent(COMPRESSOR, Instant::now());
        }
        CountedBody { inner, guest, kind }
    }
}

impl HttpBody for CountedBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let polled = Pin::new(&mut self.inner).poll_frame(cx);
        if let Poll::Ready(Some(Ok(frame))) = &polled
            && self.kind != BodyKind::Shared
            && let Some(bytes) = frame.data_ref()
        {
            self.guest.is_sent(bytes.len(), Instant::now());
        }
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

impl Drop for CountedBody {
    fn drop(&mut self) {
        if self.kind == BodyKind::Compressed {
            self.guest.releases(COMPRESSOR);
        }
        if self.kind != BodyKind::Upgraded {
            self.guest.is_answered(Instant::now());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::budget::Budget;
    use super::*;
    use std::net::IpAddr;
    use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};

    fn guest() -> Arc<Guest> {
        let budget = Budget::of(1000);
        Arc::new(budget.arrive(IpAddr::from([10, 0, 0, 1]), Instant::now()))
    }

    /// A socket with a small buffer, whose client has this much time, and the client's end of it.
    fn socket(patience: Duration) -> (Metered<DuplexStream>, DuplexStream) {
        let (ours, theirs) = tokio::io::duplex(1024);
        (Metered { patience, ..Metered::new(ours, guest()) }, theirs)
    }

    #[tokio::test]
    async fn a_client_that_takes_nothing_or_hardly_anything_is_given_up() {
        for each in [0, 100] {
            let (mut ours, mut theirs) = socket(Duration::from_millis(50));
            let client = tokio::spawn(async move {
                let mut some = vec![0; each];
                while theirs.read_exact(&mut some).await.is_ok() {
                    tokio::time::sleep(Duration::from_millis(10)).await;
                }
            });
            let error = ours.write_all(&vec![7; LEAST * 20]).await.unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::TimedOut, "{each} bytes at a time");
            client.abort();
        }
    }

    #[tokio::test]
    async fn a_client_that_gets_on_is_served_however_long_the_answer_is_and_a_pause_does_not_count() {
        let (mut ours, mut theirs) = socket(Duration::from_secs(2));
        let client = tokio::spawn(async move {
            let mut all = Vec::new();
            theirs.read_to_end(&mut all).await.map(|_| all.len())
        });
        ours.write_all(&vec![7; LEAST * 50]).await.unwrap();
        assert!(ours.waits.is_none(), "nothing waits any more");
        ours.write_all(&[7; 5000]).await.unwrap();
        drop(ours);
        assert_eq!(client.await.unwrap().unwrap(), LEAST * 50 + 5000);
    }
}

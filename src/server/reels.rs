//! Keeps the past: a thread of its own writes the pictures of the live feed to disk, five a second.
//!
//! Main types: [`Tap`] (the loop's end, which never waits), [`keep`]. Where the disk takes no more, the log says so,
//! the fleet goes on, and the thread tries again. Refuses: to hold anybody up; a fact that comes too fast loses its
//! bookmark, not its place in the journal.

use super::clock::Clock;
use crate::api::live::Live;
use crate::api::reel::{EVERY, Folder, Limits, Roll, is_notable};
use crate::fleet::Fact;
use crate::time::Span;
use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::Duration;

/// So many facts may wait for their bookmarks.
const WAITING: usize = 1024;

/// How long it rests after the disk refused something.
const REST: Span = Span::from_secs(10);

/// Where the loop tells what happened.
#[derive(Debug, Default)]
pub struct Tap(Option<SyncSender<Fact>>);

impl Tap {
    /// Tells of the facts of a step, as far as they make bookmarks.
    pub fn note(&self, facts: &[Fact]) {
        let Some(send) = &self.0 else { return };
        for fact in facts.iter().filter(|fact| is_notable(fact)) {
            let _ = send.try_send(fact.clone());
        }
    }
}

/// Begins to keep the past in a folder; ends when the tap is dropped.
///
/// # Errors
/// Where there can be no thread.
pub fn keep(folder: Arc<Folder>, limits: Limits, live: Arc<Live>, clock: Arc<Clock>) -> io::Result<Tap> {
    let (send, facts) = sync_channel(WAITING);
    let keeper = Keeper { roll: Roll::new(folder, limits), live, clock, rest: None };
    std::thread::Builder::new().name("past".into()).spawn(move || keeper.run(&facts))?;
    Ok(Tap(Some(send)))
}

struct Keeper {
    roll: Roll,
    live: Arc<Live>,
    clock: Arc<Clock>,
    /// Until when nothing is written, since the disk refused something.
    rest: Option<crate::time::Time>,
}

impl Keeper {
    fn run(mut self, facts: &Receiver<Fact>) {
        let mut due = self.clock.now();
        loop {
            let wait = (due - self.clock.now()).0.max(0).unsigned_abs();
            match facts.recv_timeout(Duration::from_micros(wait)) {
                Ok(fact) => self.roll.note(&fact),
                Err(RecvTimeoutError::Timeout) => {
                    due = self.clock.now() + EVERY;
                    self.shoot();
                }
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        if let Err(e) = self.roll.finish() {
            tracing::error!("the last pictures of the past were not written: {e}");
        }
    }

    fn shoot(&mut self) {
        let now = self.clock.now();
        if self.rest.is_some_and(|until| now < until) {
            return;
        }
        match self.roll.take(&self.live.frame()) {
            Ok(()) if self.rest.take().is_some() => tracing::info!("the past is kept again"),
            Ok(()) => {}
            Err(e) => {
                if self.rest.is_none() {
                    tracing::error!("the past is not kept: {e}. The fleet goes on; make room on the disk.");
                }
                self.rest = Some(now + REST);
            }
        }
    }
}

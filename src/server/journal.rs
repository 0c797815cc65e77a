//! The journal's task: everything that waits becomes one transaction, tried until the database takes it.
//!
//! Main types: [`Journal`] (the loop's end: records, knows what is durable), [`Writer`] (the task). While the
//! database refuses, facts wait in order and an alarm stands; nothing is dropped, and what is not durable is
//! not acknowledged. Refuses: to try again what contradicts the journal; that ends the process.

use super::clock::Clock;
use crate::api::metrics::Metrics;
use crate::api::port::Alarms;
use crate::fleet::Fact;
use crate::store::{Entry, Store, StoreError};
use crate::time::Time;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};

/// The alarm that stands while facts do not become durable.
pub const ALARM: &str = "journal";

/// So many facts may wait; then the fleet stands until the database is back.
const MOST_PENDING: u64 = 20_000;

/// So many facts go into one transaction.
const MOST_AT_ONCE: usize = 5_000;

/// A transaction that takes longer raises the alarm.
const SLOW: Duration = Duration::from_secs(1);

/// The first pause after a failure; each one is twice as long as the one before, up to the last.
const PAUSES: (Duration, Duration) = (Duration::from_millis(250), Duration::from_secs(2));

/// The loop's end of the journal.
#[derive(Debug)]
pub struct Journal {
    facts: mpsc::UnboundedSender<Entry>,
    recorded: u64,
    durable: watch::Receiver<u64>,
    failing: watch::Receiver<bool>,
}

/// The task's end.
pub struct Writer {
    facts: mpsc::UnboundedReceiver<Entry>,
    durable: watch::Sender<u64>,
    failing: watch::Sender<bool>,
    next: i64,
    store: Arc<Store>,
    clock: Arc<Clock>,
    alarms: Arc<Alarms>,
    metrics: Arc<Metrics>,
}

/// Both ends; `next` is the number of the first fact.
pub fn journal(
    store: Arc<Store>,
    next: i64,
    clock: Arc<Clock>,
    alarms: Arc<Alarms>,
    metrics: Arc<Metrics>,
) -> (Journal, Writer) {
    let (send, receive) = mpsc::unbounded_channel();
    let (durable, confirmed) = watch::channel(0);
    let (failing, fails) = watch::channel(false);
    let journal = Journal { facts: send, recorded: 0, durable: confirmed, failing: fails };
    (journal, Writer { facts: receive, durable, failing, next, store, clock, alarms, metrics })
}

impl Journal {
    /// Records the facts of a step. What depends on them may leave when so many are durable as this says.
    pub fn record(&mut self, at: Time, facts: Vec<Fact>) -> u64 {
        for fact in facts {
            // Fails only where the task has ended; the server ends then, too.
            let _ = self.facts.send(Entry { at, fact });
            self.recorded += 1;
        }
        self.recorded
    }

    /// How many facts are durable.
    pub fn durable(&self) -> u64 {
        *self.durable.borrow()
    }

    /// Waits until more are durable.
    pub async fn confirmed(&mut self) {
        if self.durable.changed().await.is_err() {
            std::future::pending::<()>().await;
        }
    }

    /// Whether facts do not become durable at present.
    pub fn is_failing(&self) -> bool {
        *self.failing.borrow()
    }

    /// Whether everything that was recorded is durable.
    pub fn is_settled(&self) -> bool {
        self.recorded == self.durable()
    }

    /// Whether so many facts wait that there may be no more.
    pub fn is_full(&self) -> bool {
        self.recorded - self.durable() >= MOST_PENDING
    }
}

impl Writer {
    /// Writes until the loop's end is dropped and everything is durable.
    ///
    /// # Errors
    /// Where the database contradicts what is to be written.
    pub async fn run(mut self) -> Result<(), StoreError> {
        let mut batch = Vec::new();
        while self.facts.recv_many(&mut batch, MOST_AT_ONCE).await > 0 {
            self.metrics.journal_pending.set((batch.len() + self.facts.len()) as i64);
            self.write(&batch).await?;
            self.metrics.journal_batch.observe(batch.len() as f64);
            let oldest = batch.first().map_or(self.clock.now(), |e| e.at);
            self.metrics.journal_lag.observe((self.clock.now() - oldest).as_secs_f64());
            self.metrics.journal_pending.set(self.facts.len() as i64);
            self.next += batch.len() as i64;
            self.durable.send_modify(|n| *n += batch.len() as u64);
            batch.clear();
        }
        Ok(())
    }

    /// Writes one batch, however long it takes.
    async fn write(&self, batch: &[Entry]) -> Result<(), StoreError> {
        let (mut pause, longest) = PAUSES;
        loop {
            match self.attempt(batch).await {
                Ok(()) => {
                    if self.failing.send_if_modified(std::mem::take) {
                        self.alarms.clear(ALARM);
                        tracing::info!("the journal is back: every fact is durable");
                    }
                    return Ok(());
                }
                Err(e) if e.is_fatal() => return Err(e),
                Err(e) => {
                    self.metrics.journal_errors.inc();
                    self.fail(format!(
                        "the journal cannot be written: {e}. Robots get no new orders meanwhile."
                    ));
                }
            }
            tokio::time::sleep(pause).await;
            pause = longest.min(pause * 2);
        }
    }

    /// One try; raises the alarm where it takes long.
    async fn attempt(&self, batch: &[Entry]) -> Result<(), StoreError> {
        // Never dropped half-way: a statement already sent would be carried out all the same.
        let append = self.store.append(self.next, batch);
        tokio::pin!(append);
        if let Ok(result) = tokio::time::timeout(SLOW, &mut append).await {
            return result;
        }
        let waiting = batch.len() + self.facts.len();
        self.fail(format!(
            "the journal is slow: {waiting} facts wait for {}. Robots get no new orders meanwhile.",
            self.store.path().display()
        ));
        append.await
    }

    fn fail(&self, text: String) {
        if self.alarms.raise(ALARM, text.clone(), self.clock.now()) {
            tracing::error!("{text}");
        }
        self.failing.send_replace(true);
    }
}

//! The journal's task: all waiting steps become one transaction, which is retried until the database accepts it.
//!
//! Main types: [`Journal`] (the loop's end: passes facts on, knows what is durable), [`JournalSender`] (the task).
//! While the database refuses, steps wait in order and an alarm is active; nothing is dropped, and only durable facts
//! are acknowledged. The task folds durable facts into a ledger of its own and stores a snapshot of it now and then, so
//! that this costs the loop nothing. Refuses: to retry what contradicts the journal; that ends the process.

use super::clock::Clock;
use super::watchdog::Auditor;
use giveway_api::{Alarms, Metrics};
use giveway_drive::{JournalReport, JournalState};
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{Fact, Ledger};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::Time;
use giveway_store::{SNAPSHOT_AFTER, StepCause, StepEntry, Store, StoreError};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::{mpsc, watch};

/// The most steps in one transaction.
const MOST_AT_ONCE: usize = 200;

/// After a snapshot that could not be stored, it is retried after this many facts.
const SNAPSHOT_AGAIN: usize = 1_000;

/// A transaction that takes longer than this raises the alarm.
const SLOW: Duration = Duration::from_secs(1);

/// The first pause after a failure, and the longest; each pause is twice as long as the previous one.
const PAUSES: (Duration, Duration) = (Duration::from_millis(250), Duration::from_secs(2));

/// The loop's end of the journal.
#[derive(Debug)]
pub struct Journal {
    steps: mpsc::UnboundedSender<StepEntry>,
    durable: watch::Receiver<u64>,
    failing: watch::Receiver<bool>,
    pending: Arc<AtomicU64>,
}

/// The task's end.
pub struct JournalSender {
    steps: mpsc::UnboundedReceiver<StepEntry>,
    durable: watch::Sender<u64>,
    failing: watch::Sender<bool>,
    /// The number of facts that are not durable.
    pending: Arc<AtomicU64>,
    next: i64,
    shadow: Shadow,
    auditor: Auditor,
    store: Arc<Store>,
    clock: Arc<Clock>,
    alarms: Arc<Alarms>,
    metrics: Arc<Metrics>,
}

/// Where the journal continues.
pub struct Start {
    /// The number of the first step.
    pub next: i64,
    /// The ledger before it.
    pub ledger: Ledger,
    /// How many facts there are since the last snapshot.
    pub behind: usize,
}

/// The fold of everything durable, and the number of facts since the last snapshot.
struct Shadow {
    ledger: Ledger,
    behind: usize,
}

/// Both ends of the channel.
pub fn journal(
    store: Arc<Store>,
    start: Start,
    clock: Arc<Clock>,
    alarms: Arc<Alarms>,
    metrics: Arc<Metrics>,
) -> (Journal, JournalSender) {
    let (send, receive) = mpsc::unbounded_channel();
    let (durable, confirmed) = watch::channel(0);
    let (failing, fails) = watch::channel(false);
    let pending = Arc::new(AtomicU64::new(0));
    let journal = Journal { steps: send, durable: confirmed, failing: fails, pending: pending.clone() };
    let Start { next, ledger, behind } = start;
    let shadow = Shadow { ledger, behind };
    let steps = receive;
    let auditor = Auditor::default();
    (
        journal,
        JournalSender {
            steps,
            durable,
            failing,
            pending,
            next,
            shadow,
            auditor,
            store,
            clock,
            alarms,
            metrics,
        },
    )
}

impl Journal {
    /// Queues the facts of a step to be stored, with the requests that caused them.
    pub fn record(&mut self, at: Time, facts: Vec<Fact>, causes: Vec<StepCause>) {
        self.pending.fetch_add(facts.len() as u64, Ordering::Relaxed);
        // This fails only if the task has ended; then the server ends, too.
        let _ = self.steps.send(StepEntry { at, facts, causes });
    }

    /// The state of the journal; `gone` is whether the database is no longer in its place.
    pub fn report(&self, gone: bool) -> JournalReport {
        let state = match (gone, *self.failing.borrow()) {
            (true, _) => JournalState::Gone,
            (false, true) => JournalState::Refuses,
            (false, false) => JournalState::Writes,
        };
        JournalReport { durable: *self.durable.borrow(), state }
    }

    /// Waits until more steps are durable.
    pub async fn confirmed(&mut self) {
        if self.durable.changed().await.is_err() {
            std::future::pending::<()>().await;
        }
    }
}

impl JournalSender {
    /// Stores steps until the loop's end is dropped and everything is durable.
    ///
    /// # Errors
    /// If the database contradicts what is to be stored.
    pub async fn run(mut self) -> Result<(), StoreError> {
        let mut batch = Vec::new();
        while self.steps.recv_many(&mut batch, MOST_AT_ONCE).await > 0 {
            self.metrics.journal_pending.set(self.pending().cast_signed());
            self.write(&batch).await?;
            let facts: usize = batch.iter().map(|step| step.facts.len()).sum();
            self.metrics.journal_batch.observe(facts as f64);
            let oldest = batch.first().map_or(self.clock.now(), |e| e.at);
            self.metrics.journal_lag.observe((self.clock.now() - oldest).as_secs_f64());
            self.pending.fetch_sub(facts as u64, Ordering::Relaxed);
            self.metrics.journal_pending.set(self.pending().cast_signed());
            self.next += batch.len() as i64;
            self.durable.send_modify(|n| *n += batch.len() as u64);
            self.shadow.fold(&batch);
            self.auditor.note(facts, &self.shadow.ledger, self.clock.now(), &self.alarms);
            if self.shadow.behind >= SNAPSHOT_AFTER {
                self.snapshot(batch.last().map_or(oldest, |e| e.at)).await?;
            }
            batch.clear();
        }
        Ok(())
    }

    /// The number of facts that are not durable.
    fn pending(&self) -> u64 {
        self.pending.load(Ordering::Relaxed)
    }

    /// Stores a snapshot of the ledger. If that fails, nothing is lost: the steps are durable, and a start reads more
    /// of them.
    async fn snapshot(&mut self, at: Time) -> Result<(), StoreError> {
        match self.store.snapshot(self.next - 1, at, self.shadow.ledger.to_parts()).await {
            Ok(()) => self.shadow.behind = 0,
            Err(e) if e.is_fatal() => return Err(e),
            Err(e) => {
                self.metrics.journal_errors.inc();
                tracing::warn!("the snapshot could not be saved, so the next start takes longer: {e}");
                self.shadow.behind = SNAPSHOT_AFTER - SNAPSHOT_AGAIN;
            }
        }
        Ok(())
    }

    /// Stores one batch, however long that takes.
    async fn write(&self, batch: &[StepEntry]) -> Result<(), StoreError> {
        let (mut pause, longest) = PAUSES;
        loop {
            match self.attempt(batch).await {
                Ok(()) => {
                    if self.failing.send_if_modified(std::mem::take) {
                        self.alarms.clear(AlarmKind::Journal, self.clock.now());
                        tracing::info!("the journal is back: every fact is durable");
                    }
                    return Ok(());
                }
                Err(e) if e.is_fatal() => return Err(e),
                Err(e) => {
                    self.metrics.journal_errors.inc();
                    self.fail(sentence::journal_not_written(e.to_string()));
                }
            }
            tokio::time::sleep(pause).await;
            pause = longest.min(pause * 2);
        }
    }

    /// Tries once; raises the alarm if that takes long.
    async fn attempt(&self, batch: &[StepEntry]) -> Result<(), StoreError> {
        // The future is never dropped half-way: a statement that was already sent would still be carried out.
        let append = self.store.append(self.next, batch);
        tokio::pin!(append);
        if let Ok(result) = tokio::time::timeout(SLOW, &mut append).await {
            return result;
        }
        let waiting = self.pending();
        let file = self.store.path().display().to_string();
        self.fail(sentence::journal_slow(waiting, file));
        append.await
    }

    fn fail(&self, text: Sentence) {
        self.alarms.raise(AlarmKind::Journal, text, self.clock.now());
        self.failing.send_replace(true);
    }
}

impl Shadow {
    fn fold(&mut self, batch: &[StepEntry]) {
        for fact in batch.iter().flat_map(|step| &step.facts) {
            self.ledger.evolve(fact);
            self.behind += 1;
        }
    }
}

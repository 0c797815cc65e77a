//! Writes down who asked for what, once it was answered.
//!
//! Main function: [`keep_audit`]. Requests that caused facts are in the journal's transaction already; here they get
//! their outcome. Refuses: to let anything wait for it.

use giveway_api::AuditEntry;
use giveway_store::{AuditRow, Store};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;

/// So many are written at once.
const MOST_AT_ONCE: usize = 200;

/// How long it rests after the database refused.
const REST: Duration = Duration::from_secs(2);

/// How long the last entries may take when the server goes down.
const LAST: Duration = Duration::from_secs(2);

/// An entry as the database has it.
pub fn row_of(entry: &AuditEntry) -> AuditRow {
    let AuditEntry { id, actor, role, what, subject, status } = entry.clone();
    AuditRow { id, actor, role: role.word().into(), what, subject, outcome: status }
}

/// Writes entries down as they arrive, until `stop` says so, then the last ones.
pub async fn keep_audit(
    store: Arc<Store>,
    mut answered: mpsc::Receiver<AuditEntry>,
    mut stop: watch::Receiver<bool>,
) {
    let mut batch = Vec::new();
    loop {
        tokio::select! {
            n = answered.recv_many(&mut batch, MOST_AT_ONCE) => if n == 0 { break },
            _ = stop.wait_for(|stop| *stop) => break,
        }
        while !save(&store, &mut batch).await && !*stop.borrow() {
            let _ = timeout(REST, stop.wait_for(|stop| *stop)).await;
        }
    }
    while let Ok(entry) = answered.try_recv() {
        batch.push(entry);
    }
    if !timeout(LAST, save(&store, &mut batch)).await.unwrap_or(false) {
        tracing::warn!("the last entries of the audit were not written down");
    }
}

/// Whether everything is written down.
async fn save(store: &Store, batch: &mut Vec<AuditEntry>) -> bool {
    if batch.is_empty() {
        return true;
    }
    let rows: Vec<AuditRow> = batch.iter().map(row_of).collect();
    match store.keep_audit(&rows).await {
        Ok(()) => batch.clear(),
        Err(e) => tracing::warn!("the audit cannot be written and is kept in memory: {e}"),
    }
    batch.is_empty()
}

//! Stores audit entries once their requests have been answered.
//!
//! Main function: [`keep_audit`]. Requests that caused facts are already in the journal's transaction; here they get
//! their outcome. Refuses: to let anything wait for it.

use giveway_api::AuditEntry;
use giveway_store::{AuditRow, Store};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;

/// How many entries are written at once.
const MOST_AT_ONCE: usize = 200;

/// How long to wait after the database refused.
const REST: Duration = Duration::from_secs(2);

/// How long the last entries may take when the server shuts down.
const LAST: Duration = Duration::from_secs(2);

/// An entry as a row of the database.
pub fn row_of(entry: &AuditEntry) -> AuditRow {
    let AuditEntry { id, actor, role, what, subject, status } = entry.clone();
    AuditRow { id, actor, role: role.word().into(), what, subject, outcome: status }
}

/// Stores entries as they arrive until `stop` turns true, then the last ones.
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

/// Stores the batch; true if that succeeded.
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

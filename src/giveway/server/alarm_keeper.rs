//! Writes alarms down as they change, so that they outlast a restart.
//!
//! Main function: [`keep_alarms`]. Where the database refuses, alarms go on in memory and are written later. Refuses:
//! to make anything wait for it.

use giveway_api::Alarms;
use giveway_store::Store;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::timeout;

/// What changes within this is written at once.
const GATHER: Duration = Duration::from_millis(200);

/// How long it rests after the database refused.
const REST: Duration = Duration::from_secs(2);

/// How long the last alarms may take when the server goes down.
const LAST: Duration = Duration::from_secs(2);

/// Writes changes down until `stop` says so, then the last ones.
pub async fn keep_alarms(store: Arc<Store>, alarms: Arc<Alarms>, mut stop: watch::Receiver<bool>) {
    let mut refused = false;
    while !*stop.borrow_and_update() {
        tokio::select! {
            () = alarms.changed() => {}
            _ = stop.changed() => break,
        }
        let pause = if save(&store, &alarms, &mut refused).await { GATHER } else { REST };
        let _ = timeout(pause, stop.wait_for(|stop| *stop)).await;
    }
    if timeout(LAST, save(&store, &alarms, &mut refused)).await.is_err() {
        tracing::warn!("the last alarms were not written down");
    }
}

/// Whether everything is written down.
async fn save(store: &Store, alarms: &Alarms, refused: &mut bool) -> bool {
    let changes = alarms.take_changes();
    if changes.is_empty() {
        return true;
    }
    let result = store.keep_alarms(&changes).await;
    if let Err(e) = &result {
        if !std::mem::replace(refused, true) {
            tracing::warn!("alarms cannot be written down and are kept in memory: {e}");
        }
        alarms.put_back(changes);
        return false;
    }
    *refused = false;
    true
}

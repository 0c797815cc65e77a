//! Stores alarms as they change, so that they survive a restart.
//!
//! Main function: [`keep_alarms`]. If the database refuses, alarms continue in memory and are stored later. Refuses: to
//! make anything wait for it.

use giveway_api::Alarms;
use giveway_store::Store;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::timeout;

/// Changes within this time are stored together.
const GATHER: Duration = Duration::from_millis(200);

/// How long to wait after the database refused.
const REST: Duration = Duration::from_secs(2);

/// How long the last alarms may take when the server shuts down.
const LAST: Duration = Duration::from_secs(2);

/// Stores changes until `stop` turns true, then the last ones.
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

/// Stores all changes; true if that succeeded.
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

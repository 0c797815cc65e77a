//! Watches the database files: raises an alarm within a second if they are no longer in their place.
//!
//! Main function: [`watch_over`]. Refuses: to touch them.

use super::clock::Clock;
use giveway_api::Alarms;
use giveway_fleet::alarm::AlarmKind;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_store::Store;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::interval;

/// How often the files are checked.
const EVERY: Duration = Duration::from_millis(250);

/// Watches the files until it is aborted, and reports through `displaced`. About once a second, the content of the lock
/// file is made to survive a loss of power.
pub async fn watch_over(
    store: Arc<Store>,
    alarms: Arc<Alarms>,
    clock: Arc<Clock>,
    displaced: watch::Sender<bool>,
) {
    let mut tick = interval(EVERY);
    for round in 0_u64.. {
        tick.tick().await;
        match store.check_place() {
            Ok(()) => {
                if displaced.send_if_modified(std::mem::take) {
                    alarms.clear(AlarmKind::Database, clock.now());
                    tracing::info!("the database is back in its place");
                }
            }
            Err(e) => {
                displaced.send_replace(true);
                let text = sentence::database_gone(e.to_string());
                alarms.raise(AlarmKind::Database, text, clock.now());
            }
        }
        if round % 4 == 0 {
            let store = store.clone();
            let synced = tokio::task::spawn_blocking(move || store.sync_lock()).await;
            if let Ok(Err(e)) = synced {
                tracing::debug!("the lock file is not synced: {e}");
            }
        }
    }
}

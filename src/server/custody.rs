//! Watches over the files of the database: an alarm within a second where they are no longer in their place.
//!
//! Main function: [`watch_over`]. Refuses: to touch them.

use super::clock::Clock;
use crate::api::port::Alarms;
use crate::store::Store;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::interval;

/// The alarm that stands while the database is not where it was.
pub const ALARM: &str = "database";

/// How often it looks.
const EVERY: Duration = Duration::from_millis(250);

/// Looks after the files until it is aborted, and tells through `displaced`. About once a second what the lock file
/// knows is made to outlast a loss of power.
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
                    alarms.clear(ALARM);
                    tracing::info!("the database is back in its place");
                }
            }
            Err(e) => {
                displaced.send_replace(true);
                let text = format!("{e}. Robots drive to the end of their grants and stop.");
                if alarms.raise(ALARM, text.clone(), clock.now()) {
                    tracing::error!("{text}");
                }
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

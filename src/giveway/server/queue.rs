//! The jobs that wait, looked up once a second for the past that is kept.
//!
//! Main type: [`LastBacklog`]. Recordings list them every ten seconds, with a key frame. The thread that writes them
//! cannot ask the fleet, so every frame carries a list that is at most a second old. Refuses: to look them up for
//! every frame.

use giveway_fleet::{Backlog, Fleet};
use giveway_floor::time::{Span, Time};
use std::sync::Arc;

/// How often, a little less than a second, so that a frame does not just miss it.
const EVERY: Span = Span::from_millis(980);

/// How many are listed; a frame says how many there are in all.
const MOST: usize = 200;

/// The last list.
#[derive(Debug, Default)]
pub struct LastBacklog(Option<Arc<Backlog>>);

impl LastBacklog {
    /// The list for a frame.
    pub fn of(&mut self, fleet: &Fleet, now: Time) -> Arc<Backlog> {
        if let Some(kept) = &self.0
            && (Span::ZERO..EVERY).contains(&(now - kept.at))
        {
            return kept.clone();
        }
        let fresh = Arc::new(fleet.backlog(MOST, now));
        self.0 = Some(fresh.clone());
        fresh
    }
}

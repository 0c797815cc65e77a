//! Waiting jobs, queried once a second for kept recordings.
//!
//! Main type: [`LastBacklog`]. Recordings list them every ten seconds, with a key frame. The thread that writes
//! recordings cannot ask the fleet, so every frame carries a list that is at most a second old. Refuses: to query them
//! for every frame.

use giveway_fleet::{Backlog, Fleet};
use giveway_floor::time::{Span, Time};
use std::sync::Arc;

/// Interval between queries, a little less than a second, so that a frame does not just miss the next one.
const EVERY: Span = Span::from_millis(980);

/// The most jobs in the list; a frame has their total number.
const MOST: usize = 200;

/// The latest list.
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

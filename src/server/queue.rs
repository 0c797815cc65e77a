//! The jobs that wait, looked up once a second for the past that is kept.
//!
//! Main type: [`LastBacklog`]. Recordings list them every ten seconds, with a whole picture; whoever writes recordings
//! cannot ask the fleet, so that the pictures carry a list that is never old. Refuses: to look at them for every
//! picture.

use crate::fleet::{Backlog, Fleet};
use crate::time::{Span, Time};
use std::sync::Arc;

/// How often, a little less than a second, so that a picture does not just miss it.
const EVERY: Span = Span::from_millis(980);

/// How many are listed; of the others a picture has the number.
const MOST: usize = 200;

/// The last list.
#[derive(Debug, Default)]
pub struct LastBacklog(Option<Arc<Backlog>>);

impl LastBacklog {
    /// The list for a picture.
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

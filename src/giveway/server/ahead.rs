//! Forecasts of people for dashboards and kept recordings, computed twice a second.
//!
//! Main type: [`LastForecasts`]. Refuses: to forecast for every frame.

use giveway_fleet::{Expected, Fleet};
use giveway_floor::time::{Span, Time};
use std::sync::Arc;

/// Interval between forecasts, a little less than half a second, so that a frame does not just miss the next one.
const EVERY: Span = Span::from_millis(480);

/// The latest forecasts.
#[derive(Debug, Default)]
pub struct LastForecasts {
    last: Option<(Time, Arc<Vec<Expected>>)>,
}

impl LastForecasts {
    /// The forecasts for a frame.
    pub fn of(&mut self, fleet: &Fleet, now: Time) -> Arc<Vec<Expected>> {
        if let Some((at, kept)) = &self.last
            && (Span::ZERO..EVERY).contains(&(now - *at))
        {
            return kept.clone();
        }
        let fresh = Arc::new(fleet.expectations(now));
        self.last = Some((now, fresh.clone()));
        fresh
    }
}

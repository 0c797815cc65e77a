//! Takes frames of a fleet that is stepped without a server: a simulation, or a recording.
//!
//! Main type: [`FrameRecorder`]. Refuses: to step the fleet itself.

use super::ahead::LastForecasts;
use super::measure::Measure;
use super::queue::LastBacklog;
use giveway_api::recording::EVERY;
use giveway_api::{Alarms, Frame, Moment};
use giveway_fleet::Fleet;
use giveway_floor::time::Time;
use std::sync::Arc;

/// Takes frames of a fleet, at the interval of recordings.
#[derive(Debug, Default)]
pub struct FrameRecorder {
    alarms: Alarms,
    measure: Measure,
    ahead: LastForecasts,
    queue: LastBacklog,
    due: Option<Time>,
}

impl FrameRecorder {
    /// The frame after a step, if one is due.
    pub fn take_frame(&mut self, fleet: &Fleet, now: Time) -> Option<Arc<Frame>> {
        if self.due.is_some_and(|due| now < due) {
            return None;
        }
        self.due = Some(now + EVERY);
        let view = fleet.view(now);
        self.alarms.note(&view);
        let measured = self.measure.figures(now, view.counts.robot_deliveries);
        let forecasts = self.ahead.of(fleet, now);
        let backlog = self.queue.of(fleet, now);
        let moment = Moment {
            view,
            unheard: Some(0),
            time_s: now.as_secs_f64(),
            simulation: None,
            measured,
            forecasts,
            backlog,
        };
        Some(Arc::new(Frame::of(fleet.warehouse(), &moment, &self.alarms.list(), 0.0)))
    }
}

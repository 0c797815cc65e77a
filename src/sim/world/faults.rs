//! Begins and ends a robot's faults by the rates of a scenario.
//!
//! Adds to [`SimRobot`]. Refuses: faults that a test causes at a chosen moment (`incidents.rs`).

use super::SimRobot;
use crate::scenario::Faults;
use giveway_fleet::Fault;
use giveway_floor::time::{Span, Time};

/// Largest change of a robot's clock, either way, seconds.
const CLOCK_S: f64 = 3600.0;

impl SimRobot {
    /// While its charger gives no current, the robot reports that. The fault ends when the robot is elsewhere.
    pub(super) fn mind_charger(&mut self, out_until: Option<Time>) {
        if self.charger_is_out && out_until.is_none() {
            self.body.fault = self.body.fault.filter(|(fault, _)| *fault != Fault::Unplugged);
            self.charger_is_out = false;
        } else if let (Some(until), None) = (out_until, self.body.fault) {
            self.body.fault = Some((Fault::Unplugged, until));
            self.charger_is_out = true;
        }
    }

    /// Begins and ends the robot's faults. `charging` says whether it stands on a charger.
    pub(super) fn meet_faults(&mut self, faults: &Faults, charging: bool, from: Time, to: Time) {
        if let Some((_, until)) = self.body.fault {
            self.body.fault = self.body.fault.filter(|_| until > to);
            return;
        }
        let hours = (to - from).as_secs_f64() / 3600.0;
        self.set_clock(faults.clock_steps_per_hour * hours);
        let until = to + Span::from_secs_f64(faults.repair_s);
        let (moving, on_its_way) = (self.body.speed_mps > 0.0, self.body.is_on_its_way());
        if moving && self.luck.happens(faults.failures_per_hour * hours) {
            self.body.fault = Some((Fault::Broken, until));
            return;
        }
        // Rates of zero draw no number, so that older scenarios run as they did.
        let luck = &mut self.luck;
        let mut happens = |per_hour: f64| per_hour > 0.0 && luck.happens(per_hour * hours);
        if moving && happens(faults.emergency_stops_per_hour) {
            self.body.fault = Some((Fault::EmergencyStop, until));
        } else if on_its_way && happens(faults.obstacles_per_hour) {
            self.body.fault = Some((Fault::Obstructed, until));
        } else if charging && !moving && happens(faults.unplugged_per_hour) {
            self.body.fault = Some((Fault::Unplugged, until));
        } else if moving && happens(faults.manual_drives_per_hour) {
            self.body.take_over(until);
            // Meanwhile, a person drives the robot onto a node if it stands between two.
            self.push_on = Some(to + Span::from_secs_f64(faults.repair_s / 2.0));
        }
    }

    /// Sets the robot's clock with this probability.
    fn set_clock(&mut self, probability: f64) {
        if probability > 0.0 && self.setting.happens(probability) {
            self.clock = Span::from_secs_f64(self.setting.between(-CLOCK_S, CLOCK_S));
            self.clock_steps += 1;
        }
    }
}

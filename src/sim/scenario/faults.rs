//! The part of a scenario about faults: of radios, clocks, robots, stations and chargers.
//!
//! Main type: [`Faults`]. Refuses: impossible shares, rates and times.

use giveway_site::{SiteError, check};
use serde::Deserialize;

/// The longest delay of a message, milliseconds.
const LONGEST_DELAY_MS: f64 = 30_000.0;

/// All faults of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Faults {
    /// Share of messages that get lost, both ways.
    pub message_loss: f64,
    /// Delay of each message, milliseconds.
    pub message_delay_ms: i64,
    /// Largest additional delay, drawn for each message, milliseconds: messages overtake one another.
    pub message_jitter_ms: i64,
    /// Largest error of a robot's clock, either way, milliseconds; drawn once for each robot.
    pub clock_skew_ms: i64,
    /// Break-downs per robot and hour of driving.
    pub failures_per_hour: f64,
    /// Emergency stops per robot and hour of driving.
    pub emergency_stops_per_hour: f64,
    /// Obstacles on the way, per robot and hour of driving.
    pub obstacles_per_hour: f64,
    /// How often a person takes over each driving robot, per hour of driving.
    pub manual_drives_per_hour: f64,
    /// How often each robot loses the current at a charger, per hour on it.
    pub unplugged_per_hour: f64,
    /// How often each charger is out of order, per hour, whichever robot stands on it.
    pub charger_outages_per_hour: f64,
    /// How often each station stops, per hour.
    pub station_stops_per_hour: f64,
    /// How long each of these faults lasts, seconds; also how long a robot pushed between nodes stands there.
    pub repair_s: f64,
    /// How often people push each standing robot elsewhere, per hour.
    pub robot_pushes_per_hour: f64,
    /// How often a robot's clock is set, per hour, by up to an hour either way.
    pub clock_steps_per_hour: f64,
    /// How often each robot's link is down, takes no orders, or holds few visits, per hour, for up to `repair_s`.
    pub link_outages_per_hour: f64,
    /// How often the Giveway process is killed at any point and restarts, per hour. This fault and the following ones
    /// are about Giveway itself: a simulation has them, a server has its own.
    pub restarts_per_hour: f64,
    /// Longest time that the process is down, seconds.
    pub restart_s: f64,
    /// How long the journal takes to write a step, milliseconds.
    pub journal_delay_ms: i64,
    /// How often the journal takes a second and a half longer for a while, per hour.
    pub journal_slow_per_hour: f64,
    /// How often the journal writes nothing for a while, per hour.
    pub journal_refuses_per_hour: f64,
    /// How long each of these journal faults lasts, seconds.
    pub journal_outage_s: f64,
    /// Whether steps that the journal has not confirmed may be on the disk when the process dies.
    pub torn_writes: bool,
    /// How often a step or a query panics at some robot, per hour; a person lets that robot go on after `repair_s`.
    pub panics_per_hour: f64,
    /// When all faults end, seconds from the start: what is broken is repaired, messages arrive soon, and nothing more
    /// goes wrong. Clocks stay wrong. Absent for never.
    pub until_s: Option<f64>,
}

impl Default for Faults {
    fn default() -> Faults {
        Faults {
            message_loss: 0.0,
            message_delay_ms: 20,
            message_jitter_ms: 0,
            clock_skew_ms: 0,
            failures_per_hour: 0.0,
            emergency_stops_per_hour: 0.0,
            obstacles_per_hour: 0.0,
            manual_drives_per_hour: 0.0,
            unplugged_per_hour: 0.0,
            charger_outages_per_hour: 0.0,
            station_stops_per_hour: 0.0,
            repair_s: 300.0,
            robot_pushes_per_hour: 0.0,
            clock_steps_per_hour: 0.0,
            link_outages_per_hour: 0.0,
            restarts_per_hour: 0.0,
            restart_s: 10.0,
            journal_delay_ms: 0,
            journal_slow_per_hour: 0.0,
            journal_refuses_per_hour: 0.0,
            journal_outage_s: 20.0,
            torn_writes: false,
            panics_per_hour: 0.0,
            until_s: None,
        }
    }
}

impl Faults {
    pub(super) fn check(&self) -> Result<(), SiteError> {
        check("faults.message_loss", self.message_loss, 0.0..=0.9, "from 0 to 0.9")?;
        let (delay, jitter) = (self.message_delay_ms as f64, self.message_jitter_ms as f64);
        check("faults.message_delay_ms", delay, 0.0..=LONGEST_DELAY_MS, "from 0 to 30000")?;
        let left = LONGEST_DELAY_MS - delay;
        check("faults.message_jitter_ms", jitter, 0.0..=left, "0 or more, and up to 30000 with the delay")?;
        check("faults.clock_skew_ms", self.clock_skew_ms as f64, 0.0..=60_000.0, "from 0 to 60000")?;
        for (key, per_hour) in [
            ("faults.failures_per_hour", self.failures_per_hour),
            ("faults.emergency_stops_per_hour", self.emergency_stops_per_hour),
            ("faults.obstacles_per_hour", self.obstacles_per_hour),
            ("faults.manual_drives_per_hour", self.manual_drives_per_hour),
            ("faults.unplugged_per_hour", self.unplugged_per_hour),
            ("faults.charger_outages_per_hour", self.charger_outages_per_hour),
            ("faults.station_stops_per_hour", self.station_stops_per_hour),
            ("faults.robot_pushes_per_hour", self.robot_pushes_per_hour),
            ("faults.clock_steps_per_hour", self.clock_steps_per_hour),
            ("faults.link_outages_per_hour", self.link_outages_per_hour),
            ("faults.restarts_per_hour", self.restarts_per_hour),
            ("faults.journal_slow_per_hour", self.journal_slow_per_hour),
            ("faults.journal_refuses_per_hour", self.journal_refuses_per_hour),
            ("faults.panics_per_hour", self.panics_per_hour),
        ] {
            check(key, per_hour, 0.0..=1000.0, "from 0 to 1000")?;
        }
        check("faults.restart_s", self.restart_s, 0.0..=600.0, "from 0 to 600")?;
        check("faults.journal_delay_ms", self.journal_delay_ms as f64, 0.0..=60_000.0, "from 0 to 60000")?;
        check("faults.journal_outage_s", self.journal_outage_s, 0.0..=600.0, "from 0 to 600")?;
        check("faults.repair_s", self.repair_s, 1.0..=1e6, "from 1 to 1000000")?;
        check("faults.until_s", self.until_s.unwrap_or(0.0), 0.0..=1e7, "from 0 to 10000000")
    }

    /// Whether any of these faults is about Giveway itself.
    pub fn has_host_faults(&self) -> bool {
        let rates = [
            self.restarts_per_hour,
            self.journal_slow_per_hour,
            self.journal_refuses_per_hour,
            self.panics_per_hour,
        ];
        self.journal_delay_ms > 0 || rates.iter().any(|rate| *rate > 0.0)
    }

    /// The longest time that a message may be under way, seconds.
    pub(crate) fn longest_delay_s(&self) -> f64 {
        (self.message_delay_ms + self.message_jitter_ms) as f64 / 1000.0
    }

    /// The faults that remain after all faults have ended.
    pub(crate) fn ended(&self) -> Faults {
        let clock_skew_ms = self.clock_skew_ms;
        let message_delay_ms = self.message_delay_ms.min(Faults::default().message_delay_ms);
        Faults { message_delay_ms, clock_skew_ms, repair_s: self.repair_s, ..Faults::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scenario;
    use super::*;

    fn read(faults: &str) -> Result<Faults, String> {
        let text =
            format!(r#"{{"giveway_scenario": 1, "name": "x", "map": "m", "robots": 1, "faults": {faults}}}"#);
        Scenario::parse(&text).map(|s| s.faults).map_err(|e| e.to_string())
    }

    #[test]
    fn faults_that_are_left_out_do_not_happen() {
        assert_eq!(read("{}"), Ok(Faults::default()));
        let slow = read(r#"{"message_delay_ms": 10000, "message_jitter_ms": 20000}"#).unwrap();
        assert_eq!((slow.message_delay_ms, slow.message_jitter_ms), (10_000, 20_000));
    }

    #[test]
    fn faults_that_cannot_be_are_refused_with_what_they_may_be() {
        for (faults, error) in [
            (
                r#"{"message_delay_ms": 30001}"#,
                "`faults.message_delay_ms` is 30001, but must be from 0 to 30000",
            ),
            (
                r#"{"message_delay_ms": 29000, "message_jitter_ms": 2000}"#,
                "`faults.message_jitter_ms` is 2000, but must be 0 or more, and up to 30000 with the delay",
            ),
            (r#"{"clock_skew_ms": -1}"#, "`faults.clock_skew_ms` is -1, but must be from 0 to 60000"),
            (
                r#"{"station_stops_per_hour": 1001}"#,
                "`faults.station_stops_per_hour` is 1001, but must be from 0 to 1000",
            ),
            (
                r#"{"charger_outages_per_hour": -2}"#,
                "`faults.charger_outages_per_hour` is -2, but must be from 0 to 1000",
            ),
            (r#"{"until_s": -1}"#, "`faults.until_s` is -1, but must be from 0 to 10000000"),
        ] {
            assert_eq!(read(faults), Err(error.to_owned()));
        }
    }
}

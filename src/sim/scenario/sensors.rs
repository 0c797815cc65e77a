//! The part of a scenario about devices: how the fleet sees workers.
//!
//! Main types: [`Sensor`], [`SecondTag`], [`Source`]. Refuses: impossible numbers, and to measure anything.

use giveway_site::{SiteError, check};
use serde::Deserialize;

/// A device that a worker carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// A headset: good positions that drift, a heading.
    Headset,
    /// A tag on the body: positions only, noisy ones.
    Tag,
}

/// How devices see workers. The usual values are those of a source without faults.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sensor {
    /// The device that workers carry.
    pub source: Source,
    /// Poses per second; where absent 20 for a headset, 5 for a tag.
    pub rate_hz: Option<f64>,
    /// Standard deviation of each pose, metres; where absent 0.02 for a headset, 0.25 for a tag.
    pub sigma_m: Option<f64>,
    /// Standard deviation of the head's direction, degrees.
    pub yaw_sigma_deg: f64,
    /// Age of a pose on arrival, milliseconds.
    pub delay_ms: f64,
    /// Largest additional random delay, milliseconds: poses overtake each other.
    pub jitter_ms: f64,
    /// Share of poses that get lost.
    pub loss: f64,
    /// Share of poses that arrive twice.
    pub repeat: f64,
    /// Error gained per metre walked since the last anchor, metres.
    pub drift: f64,
    /// Metres walked from one anchor to the next.
    pub anchor_m: f64,
    /// Largest rotation of an anchor, either way, degrees.
    pub anchor_deg: f64,
    /// How often a position is off by one to three metres for a moment, per hour.
    pub jumps_per_hour: f64,
    /// How often the device loses itself and starts a new frame, per hour.
    pub resets_per_hour: f64,
    /// How often the device is silent for a while, per hour.
    pub silences_per_hour: f64,
    /// Duration of a silence, seconds.
    pub silence_s: f64,
}

impl Default for Sensor {
    fn default() -> Sensor {
        Sensor {
            source: Source::Headset,
            rate_hz: None,
            sigma_m: None,
            yaw_sigma_deg: 2.0,
            delay_ms: 60.0,
            jitter_ms: 0.0,
            loss: 0.0,
            repeat: 0.0,
            drift: 0.0,
            anchor_m: 30.0,
            anchor_deg: 0.0,
            jumps_per_hour: 0.0,
            resets_per_hour: 0.0,
            silences_per_hour: 0.0,
            silence_s: 3.0,
        }
    }
}

impl Sensor {
    /// The same source with all kinds of faults.
    pub fn faulty(self) -> Sensor {
        let tag = self.source == Source::Tag;
        Sensor {
            jitter_ms: 120.0,
            loss: 0.05,
            repeat: 0.02,
            drift: if tag { 0.0 } else { 0.01 },
            anchor_deg: if tag { 0.0 } else { 5.0 },
            jumps_per_hour: if tag { 60.0 } else { 6.0 },
            resets_per_hour: if tag { 0.0 } else { 6.0 },
            silences_per_hour: 12.0,
            ..self
        }
    }

    /// Poses per second.
    pub fn rate(&self) -> f64 {
        self.rate_hz.unwrap_or(if self.source == Source::Tag { 5.0 } else { 20.0 })
    }

    /// Standard deviation of a position, metres.
    pub fn sigma(&self) -> f64 {
        self.sigma_m.unwrap_or(if self.source == Source::Tag { 0.25 } else { 0.02 })
    }
}

/// A tag that a worker also wears: positions without faults, less exact than a headset's.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SecondTag {
    /// Standard deviation of each position, metres.
    pub accuracy_m: f64,
    /// Interval between two positions, seconds.
    pub period_s: f64,
    /// Age of a position on arrival, milliseconds.
    pub delay_ms: f64,
}

impl Default for SecondTag {
    fn default() -> SecondTag {
        SecondTag { accuracy_m: 0.25, period_s: 0.2, delay_ms: 60.0 }
    }
}

impl SecondTag {
    /// The tag as a sensor.
    pub(crate) fn sensor(self) -> Sensor {
        Sensor {
            source: Source::Tag,
            rate_hz: Some(1.0 / self.period_s),
            sigma_m: Some(self.accuracy_m),
            delay_ms: self.delay_ms,
            ..Sensor::default()
        }
    }

    /// Refuses impossible numbers.
    pub(super) fn check(&self, of: &str) -> Result<(), SiteError> {
        check(&format!("{of}.accuracy_m"), self.accuracy_m, 0.0..=5.0, "from 0 to 5")?;
        check(&format!("{of}.period_s"), self.period_s, 0.02..=2.0, "from 0.02 to 2")?;
        check(&format!("{of}.delay_ms"), self.delay_ms, 0.0..=5000.0, "from 0 to 5000")
    }
}

impl Sensor {
    /// Refuses impossible numbers.
    pub(super) fn check(&self, of: &str) -> Result<(), SiteError> {
        let (rare, once) = ((0.0..=3600.0), (0.0..=1.0));
        let all = [
            ("rate_hz", self.rate(), 0.5..=50.0, "from 0.5 to 50"),
            ("sigma_m", self.sigma(), 0.0..=5.0, "from 0 to 5"),
            ("yaw_sigma_deg", self.yaw_sigma_deg, 0.0..=180.0, "from 0 to 180"),
            ("delay_ms", self.delay_ms, 0.0..=5000.0, "from 0 to 5000"),
            ("jitter_ms", self.jitter_ms, 0.0..=5000.0, "from 0 to 5000"),
            ("loss", self.loss, once.clone(), "from 0 to 1"),
            ("repeat", self.repeat, once.clone(), "from 0 to 1"),
            ("drift", self.drift, once, "from 0 to 1"),
            ("anchor_m", self.anchor_m, 1.0..=1e6, "from 1 to 1000000"),
            ("anchor_deg", self.anchor_deg, 0.0..=180.0, "from 0 to 180"),
            ("jumps_per_hour", self.jumps_per_hour, rare.clone(), "from 0 to 3600"),
            ("resets_per_hour", self.resets_per_hour, rare.clone(), "from 0 to 3600"),
            ("silences_per_hour", self.silences_per_hour, rare.clone(), "from 0 to 3600"),
            ("silence_s", self.silence_s, rare, "from 0 to 3600"),
        ];
        all.into_iter()
            .try_for_each(|(key, found, range, wanted)| check(&format!("{of}.{key}"), found, range, wanted))
    }
}

//! Reports of the MassRobotics AMR Interoperability Standard, as a source of workers' positions.
//!
//! Main types: [`Interop`] (which uuids are workers, where frames lie), [`InteropReport`]. The standard (JSON schema of
//! the AMR_Interop_Standard repository, May 2022) lets people carry a device that reports like a robot: a
//! `statusReport` with location, orientation and time. Pure. Refuses: unknown uuids, since a robot of another maker
//! must not be taken for a person.

use crate::feed::intake::align::Alignment;
use crate::wire::text::parse_time;
use giveway_floor::geometry::{FARTHEST_M, Point, Vector, wrap_angle};
use giveway_floor::id::WorkerId;
use giveway_people::human::{Quality, Sighting, SourceId};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// Default standard deviation of a position, metres: ultra-wideband in a hall with a line of sight (Sensors 22/8/2927:
/// 0.21 to 0.25 m).
pub const USUAL_ACCURACY_M: f64 = 0.3;

/// Settings for these reports.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Interop {
    /// Names of workers by uuid. A worker whose name is the uuid needs no entry.
    pub workers: BTreeMap<String, String>,
    /// Positions of planar datums by uuid. If there are none, every datum is the map's own frame.
    pub datums: BTreeMap<String, Datum>,
}

/// The position of a frame on the map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Datum {
    /// The origin's x, metres.
    pub x: f64,
    /// The origin's y, metres.
    pub y: f64,
    /// The direction of the frame's x axis, degrees, counter-clockwise from the map's.
    #[serde(default)]
    pub heading_deg: f64,
}

/// An identityReport or a statusReport; keys that do not concern a position are ignored.
#[derive(Clone, Debug, PartialEq, Deserialize, ToSchema)]
pub struct InteropReport {
    /// The uuid of the worker's device.
    pub uuid: String,
    /// The time of the report, RFC 3339.
    pub timestamp: String,
    /// In an identityReport, the maker of the device.
    #[serde(rename = "manufacturerName")]
    pub manufacturer: Option<String>,
    /// In a statusReport, the state of the device: navigating, idle, disabled, offline, …
    #[serde(rename = "operationalState")]
    pub state: Option<String>,
    /// In a statusReport, the location of the device.
    pub location: Option<Location>,
}

/// The location of a device.
#[derive(Clone, Debug, PartialEq, Deserialize, ToSchema)]
pub struct Location {
    /// Position x in the frame of the datum, metres.
    pub x: f64,
    /// Position y in the frame of the datum, metres.
    pub y: f64,
    /// The device's orientation; z up.
    pub angle: Angle,
    /// The uuid of the frame.
    #[serde(rename = "planarDatum", alias = "planarDatumUUID")]
    pub datum: String,
}

/// A quaternion, z up.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, ToSchema)]
pub struct Angle {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

/// Why a report gives no sighting.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfit {
    /// No worker has this uuid.
    #[error(
        "no worker is known as {0}: POST /v1/workers with this uuid as the name, or name the worker under \
         [massrobotics.workers] of the settings file"
    )]
    UnknownUuid(String),
    /// The settings do not contain the frame.
    #[error("planarDatum {0} is not set up: give its place under [massrobotics.datums] in the settings file")]
    UnknownDatum(String),
    /// The timestamp is no time.
    #[error("timestamp \"{0}\" is not a time such as 2027-01-31T12:00:00Z")]
    Time(String),
    /// The report is neither of the two kinds.
    #[error(
        "neither a statusReport (location is missing) nor an identityReport (manufacturerName is missing)"
    )]
    Neither,
    /// Impossible numbers.
    #[error("location has impossible numbers: give metres, and a quaternion of length 1")]
    Absurd,
}

impl Interop {
    /// The worker's name for a uuid, if the settings contain it.
    pub fn worker(&self, uuid: &str) -> Option<&str> {
        let found = self.workers.iter().find(|(known, _)| known.eq_ignore_ascii_case(uuid));
        found.map(|(_, name)| name.as_str())
    }

    /// The position of a frame.
    fn datum(&self, uuid: &str) -> Option<Alignment> {
        if self.datums.is_empty() {
            return Some(Alignment::identity());
        }
        let (_, datum) = self.datums.iter().find(|(known, _)| known.eq_ignore_ascii_case(uuid))?;
        Some(Alignment::exact(datum.heading_deg.to_radians(), Vector::new(datum.x, datum.y)))
    }

    /// The sighting in a report; nothing if the report only identifies the device.
    ///
    /// # Errors
    /// Why the report gives no sighting.
    pub fn sighting(&self, worker: WorkerId, report: &InteropReport) -> Result<Option<Sighting>, Unfit> {
        let seen = parse_time(&report.timestamp).ok_or_else(|| Unfit::Time(report.timestamp.clone()))?;
        let Some(location) = &report.location else {
            return if report.manufacturer.is_some() { Ok(None) } else { Err(Unfit::Neither) };
        };
        let datum = self.datum(&location.datum).ok_or_else(|| Unfit::UnknownDatum(location.datum.clone()))?;
        let Angle { x, y, z, w } = location.angle;
        let length = (x * x + y * y + z * z + w * w).sqrt();
        let near = |v: f64| v.abs() <= FARTHEST_M;
        if !(near(location.x) && near(location.y) && (length - 1.0).abs() <= 0.1) {
            return Err(Unfit::Absurd);
        }
        let yaw = (2.0 * (w * z + x * y)).atan2(w * w + x * x - y * y - z * z);
        let at: Point = datum.point(Vector::new(location.x, location.y));
        let quality = match report.state.as_deref() {
            Some("offline" | "disabled") => Quality::Lost,
            _ => Quality::Tracked,
        };
        let (heading, accuracy_m) = (Some(wrap_angle(datum.heading(yaw))), USUAL_ACCURACY_M);
        let (source, epoch, at_marks, seq) = (SourceId::Interop, 0, false, 0);
        Ok(Some(Sighting {
            worker,
            source,
            seen,
            epoch,
            at_marks,
            seq,
            at,
            mirror: None,
            heading,
            accuracy_m,
            quality,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const UUID: &str = "6948DF80-14BD-4E04-8842-7668D9C001F5";
    const DATUM: &str = "4B8302DA-21AD-401F-AF45-1DFD956B80B5";

    fn status() -> serde_json::Value {
        json!({
            "uuid": UUID, "timestamp": "2027-04-21T18:25:43-05:00", "operationalState": "navigating",
            "location": {"x": 0.5, "y": 1, "angle": {"w": 0.924, "x": 0.0, "y": 0.0, "z": 0.383}, "planarDatum": DATUM},
        })
    }

    fn read(interop: &Interop, report: serde_json::Value) -> Result<Option<Sighting>, Unfit> {
        interop.sighting(WorkerId(0), &serde_json::from_value(report).unwrap())
    }

    #[test]
    fn a_status_report_says_where_somebody_is() {
        let s = read(&Interop::default(), status()).unwrap().unwrap();
        assert_eq!(s.at, Point::new(0.5, 1.0));
        assert!((s.heading.unwrap() - std::f64::consts::FRAC_PI_4).abs() < 1e-3, "{s:?}");
        assert_eq!(s.quality, Quality::Tracked);
        let turned = Datum { x: 10.0, y: 20.0, heading_deg: 90.0 };
        let interop = Interop { datums: [(DATUM.to_lowercase(), turned)].into(), ..Interop::default() };
        let s = read(&interop, status()).unwrap().unwrap();
        assert!((s.at - Point::new(9.0, 20.5)).norm() < 1e-9, "{s:?}");
        let mut renamed = status();
        let location = renamed["location"].as_object_mut().unwrap();
        let datum = location.remove("planarDatum").unwrap();
        location.insert("planarDatumUUID".into(), datum);
        assert_eq!(read(&interop, renamed).unwrap(), Some(s), "as the revision of 2022 calls it");
    }

    #[test]
    fn what_cannot_be_placed_is_refused_with_what_to_do() {
        let interop = Interop {
            datums: [("another".into(), Datum { x: 0.0, y: 0.0, heading_deg: 0.0 })].into(),
            ..Interop::default()
        };
        let text = read(&interop, status()).unwrap_err().to_string();
        assert!(text.contains(DATUM) && text.contains("massrobotics.datums"), "{text}");
        let mut report = status();
        report["location"]["angle"]["w"] = json!(9);
        assert_eq!(read(&Interop::default(), report), Err(Unfit::Absurd));
        let mut report = status();
        report["timestamp"] = json!("yesterday");
        assert!(matches!(read(&Interop::default(), report), Err(Unfit::Time(_))));
        let identity = json!({"uuid": UUID, "timestamp": "2027-04-21T18:25:43Z", "manufacturerName": "M"});
        assert_eq!(read(&Interop::default(), identity), Ok(None));
        let neither = json!({"uuid": UUID, "timestamp": "2027-04-21T18:25:43Z"});
        assert_eq!(read(&Interop::default(), neither), Err(Unfit::Neither));
    }
}

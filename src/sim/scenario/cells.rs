//! The part of a scenario about picking stations: what is ordered there, who picks, and how devices see hands.
//!
//! Main types: [`WorkCells`], [`PickerHabits`], [`HandSensor`]. Refuses: shares, rates and stations that cannot be.

use giveway_cell::Flow;
use giveway_cell::arm::{ArmKind, ArmMode};
use giveway_floor::warehouse::Warehouse;
use giveway_site::{SiteError, check, words};
use serde::Deserialize;

/// Picking stations.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WorkCells {
    /// How the fleet uses lines and hands. Only in files: a scenario that was read has it in its site, like the mode of
    /// the arms.
    #[serde(deserialize_with = "words::flow")]
    pub flow: Option<Flow>,
    /// Order lines of customers' deliveries to stations with a cell.
    pub lines: LineDemand,
    /// Stations whose arm is switched on.
    pub arms: Vec<String>,
    /// When arms move beside pickers.
    #[serde(deserialize_with = "words::arm_mode")]
    pub arm_mode: Option<ArmMode>,
    /// How often an arm falls silent, per hour.
    pub arm_silences_per_hour: f64,
    /// How long an arm stays silent, seconds.
    pub arm_silent_s: f64,
    /// The pickers; where absent, one usual person at each station with a cell; none where empty.
    pub pickers: Option<Vec<PickerHabits>>,
    /// How devices see hands.
    pub sensor: HandSensor,
}

/// Order lines of a visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LineDemand {
    /// Fewest and most lines of a visit, each number equally likely.
    pub per_visit: [u32; 2],
    /// Fewest and most pieces of a line.
    pub quantity: [u32; 2],
}

/// A person who picks, and the person's habits.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PickerHabits {
    /// Name of the station.
    pub station: String,
    /// Duration of movements, relative to usual people.
    pub pace: f64,
    /// The hand that picks.
    pub hand: HandSide,
    /// Body height, metres.
    pub height_m: f64,
    /// How long the eyes search before the first reach of a line, seconds.
    pub looks_first_s: f64,
    /// Share of reaches in which the eyes are on another slot at first.
    pub wanders: f64,
    /// Share of reaches to a wrong slot.
    pub mispick: f64,
    /// Share of pieces that go to a wrong tote.
    pub mistote: f64,
    /// Share of reaches that begin towards another slot.
    pub changes_mind: f64,
    /// Median time that the hand is in a slot before it has a piece, seconds.
    pub rummage_s: f64,
    /// Share of lines of several pieces that both hands pick.
    pub both_hands: f64,
    /// Tremor of the hands, metres.
    pub tremor_m: f64,
    /// Share of lines with a missing piece.
    pub missing: f64,
    /// How often the person goes away, per hour.
    pub away_per_hour: f64,
    /// Mean time that the person is away, seconds.
    pub away_s: f64,
}

/// The left or the right hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HandSide {
    /// The left hand.
    Left,
    /// The right hand.
    #[default]
    Right,
}

/// How a headset sees hands. Faults act on the measurement only.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HandSensor {
    /// Observations per second.
    pub rate_hz: f64,
    /// Standard deviation of each coordinate, metres.
    pub sigma_m: f64,
    /// Mean delay of an observation, milliseconds.
    pub delay_ms: f64,
    /// Standard deviation of the delay, milliseconds.
    pub jitter_ms: f64,
    /// Width and height of the field of view, degrees.
    pub view_deg: [f64; 2],
    /// Share of observations that get lost.
    pub loss: f64,
    /// How often left and right are taken for each other, per hour, for half a second.
    pub swaps_per_hour: f64,
    /// How often a hand is seen elsewhere, per hour, for a tenth of a second.
    pub jumps_per_hour: f64,
    /// The ray that the headset sends for where the picker looks.
    pub gaze: SeenGaze,
}

/// The ray that a headset sends for where its wearer looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeenGaze {
    /// No ray.
    None,
    /// Where the head faces.
    #[default]
    Head,
    /// Where the eyes look, as the headset measures them.
    Eyes,
}

impl Default for WorkCells {
    fn default() -> WorkCells {
        WorkCells {
            flow: None,
            lines: LineDemand::default(),
            arms: Vec::new(),
            arm_mode: None,
            arm_silences_per_hour: 0.0,
            arm_silent_s: 20.0,
            pickers: None,
            sensor: HandSensor::default(),
        }
    }
}

impl Default for LineDemand {
    fn default() -> LineDemand {
        LineDemand { per_visit: [1, 5], quantity: [1, 3] }
    }
}

impl Default for PickerHabits {
    fn default() -> PickerHabits {
        PickerHabits {
            station: String::new(),
            pace: 1.0,
            hand: HandSide::Right,
            height_m: 1.75,
            looks_first_s: 0.3,
            wanders: 0.2,
            mispick: 0.01,
            mistote: 0.005,
            changes_mind: 0.03,
            rummage_s: 0.8,
            both_hands: 0.1,
            tremor_m: 0.003,
            missing: 0.02,
            away_per_hour: 4.0,
            away_s: 60.0,
        }
    }
}

impl Default for HandSensor {
    fn default() -> HandSensor {
        HandSensor {
            rate_hz: 60.0,
            sigma_m: 0.006,
            delay_ms: 40.0,
            jitter_ms: 10.0,
            view_deg: [86.0, 70.0],
            loss: 0.02,
            swaps_per_hour: 4.0,
            jumps_per_hour: 10.0,
            gaze: SeenGaze::Head,
        }
    }
}

impl WorkCells {
    /// The file's choices for the site.
    pub(super) fn take_choices(&mut self) -> (Option<Flow>, Option<ArmMode>) {
        (self.flow.take(), self.arm_mode.take())
    }

    pub(super) fn check(&self) -> Result<(), SiteError> {
        for (key, [low, high], most) in [
            ("cells.lines.per_visit", self.lines.per_visit, 20),
            ("cells.lines.quantity", self.lines.quantity, 100),
        ] {
            if low == 0 || low > high || high > most {
                let message = format!("[{low}, {high}]: give the fewest and the most, from 1 to {most}");
                return Err(SiteError::Wrong { key, message });
            }
        }
        let silences = self.arm_silences_per_hour;
        check("cells.arm_silences_per_hour", silences, 0.0..=3600.0, "from 0 to 3600")?;
        check("cells.arm_silent_s", self.arm_silent_s, 1.0..=3600.0, "from 1 to 3600")?;
        let pickers = self.pickers.iter().flatten();
        pickers.enumerate().try_for_each(|(i, picker)| picker.check(&format!("cells.pickers[{i}]")))?;
        self.sensor.check()
    }

    /// Whether the named stations are in the building, have what the scenario needs of them, and are named once.
    ///
    /// # Errors
    /// The first station for which that is not so.
    pub fn check_stations(&self, warehouse: &Warehouse) -> Result<(), SiteError> {
        let station = |name: &str| warehouse.stations.iter().find(|s| s.name == name);
        let wrong = |key, message| Err(SiteError::Wrong { key, message });
        let mut seen: Vec<&str> = Vec::new();
        for PickerHabits { station: name, .. } in self.pickers.iter().flatten() {
            if station(name).is_none_or(|s| s.cell.is_none()) {
                return wrong("cells.pickers", format!("the map has no station {name:?} with a cell"));
            }
            if seen.contains(&name.as_str()) {
                return wrong("cells.pickers", format!("two people pick at {name}: name one"));
            }
            seen.push(name);
        }
        for name in &self.arms {
            let Some(arm) = station(name).and_then(|s| s.cell.as_ref()?.arm.as_ref()) else {
                return wrong("cells.arms", format!("the map has no station {name:?} with an arm"));
            };
            if ArmKind::named(&arm.kind).is_none() {
                let (kind, known) = (&arm.kind, ArmKind::NAMES.join(", "));
                return wrong(
                    "cells.arms",
                    format!("the arm of {name} is of kind {kind:?}; known are {known}"),
                );
            }
        }
        Ok(())
    }

    /// The pickers in a building.
    pub fn pickers_in(&self, warehouse: &Warehouse) -> Vec<PickerHabits> {
        let usual = |name: &String| PickerHabits { station: name.clone(), ..PickerHabits::default() };
        let cells = || warehouse.stations.iter().filter(|s| s.cell.is_some()).map(|s| usual(&s.name));
        self.pickers.clone().unwrap_or_else(|| cells().collect())
    }
}

impl PickerHabits {
    fn check(&self, of: &str) -> Result<(), SiteError> {
        for (key, share) in [
            ("wanders", self.wanders),
            ("mispick", self.mispick),
            ("mistote", self.mistote),
            ("changes_mind", self.changes_mind),
            ("both_hands", self.both_hands),
            ("missing", self.missing),
        ] {
            check(&format!("{of}.{key}"), share, 0.0..=1.0, "from 0 to 1")?;
        }
        check(&format!("{of}.pace"), self.pace, 0.3..=4.0, "from 0.3 to 4")?;
        check(&format!("{of}.height_m"), self.height_m, 1.2..=2.2, "from 1.2 to 2.2")?;
        check(&format!("{of}.looks_first_s"), self.looks_first_s, 0.0..=10.0, "from 0 to 10")?;
        check(&format!("{of}.rummage_s"), self.rummage_s, 0.2..=30.0, "from 0.2 to 30")?;
        check(&format!("{of}.tremor_m"), self.tremor_m, 0.0..=0.05, "from 0 to 0.05")?;
        check(&format!("{of}.away_per_hour"), self.away_per_hour, 0.0..=60.0, "from 0 to 60")?;
        check(&format!("{of}.away_s"), self.away_s, 1.0..=3600.0, "from 1 to 3600")
    }
}

impl HandSensor {
    fn check(&self) -> Result<(), SiteError> {
        check("cells.sensor.rate_hz", self.rate_hz, 1.0..=240.0, "from 1 to 240")?;
        check("cells.sensor.sigma_m", self.sigma_m, 0.0..=0.2, "from 0 to 0.2")?;
        check("cells.sensor.delay_ms", self.delay_ms, 0.0..=2000.0, "from 0 to 2000")?;
        check("cells.sensor.jitter_ms", self.jitter_ms, 0.0..=1000.0, "from 0 to 1000")?;
        for view in self.view_deg {
            check("cells.sensor.view_deg", view, 1.0..=360.0, "from 1 to 360")?;
        }
        check("cells.sensor.loss", self.loss, 0.0..=1.0, "from 0 to 1")?;
        check("cells.sensor.swaps_per_hour", self.swaps_per_hour, 0.0..=3600.0, "from 0 to 3600")?;
        check("cells.sensor.jumps_per_hour", self.jumps_per_hour, 0.0..=3600.0, "from 0 to 3600")
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scenario;
    use super::*;
    use giveway_floor::warehouse::{lab, stations};

    fn scenario(cells: &str) -> Result<Scenario, String> {
        let text = format!(
            r#"{{"giveway_scenario": 1, "name": "x", "map": "m.json", "robots": 2, "cells": {cells}}}"#
        );
        Scenario::parse(&text).map_err(|e| e.to_string())
    }

    #[test]
    fn every_part_may_be_left_out_and_then_usual_people_pick_at_every_cell() {
        let usual = scenario("{}").unwrap();
        assert_eq!(usual.site.flow, Flow::Seen);
        let cells = usual.cells.unwrap();
        assert_eq!(cells.lines.per_visit, [1, 5]);
        let at = |w: &Warehouse| cells.pickers_in(w).into_iter().map(|p| p.station).collect::<Vec<_>>();
        assert_eq!(at(&stations()), ["S1", "S2", "S3", "S4"]);
        assert!(at(&lab()).is_empty(), "its stations are no cells");
        let nobody = scenario(r#"{"pickers": []}"#).unwrap().cells.unwrap();
        assert!(nobody.pickers_in(&stations()).is_empty());
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_key() {
        let refused = |cells: &str| scenario(cells).unwrap_err();
        assert_eq!(
            refused(r#"{"pickers": [{"station": "S1"}, {"station": "S2", "mispick": 2}]}"#),
            "`cells.pickers[1].mispick` is 2, but must be from 0 to 1"
        );
        assert!(refused(r#"{"lines": {"per_visit": [3, 1]}}"#).contains("cells.lines.per_visit"));
        assert!(refused(r#"{"sensor": {"rate_hz": 0}}"#).contains("cells.sensor.rate_hz"));
        assert!(refused(r#"{"flow": "guess"}"#).contains("guess"));
        assert!(refused(r#"{"picker": []}"#).contains("picker"));
    }

    #[test]
    fn stations_that_are_no_cells_have_no_arm_or_are_named_twice_are_refused() {
        let wrong = |cells: &str| {
            let cells = scenario(cells).unwrap().cells.unwrap();
            cells.check_stations(&stations()).unwrap_err().to_string()
        };
        assert!(wrong(r#"{"pickers": [{"station": "S9"}]}"#).contains("S9"));
        assert!(wrong(r#"{"pickers": [{"station": "S1"}, {"station": "S1"}]}"#).contains("two people"));
        assert!(wrong(r#"{"arms": ["S3"]}"#).contains("S3"));
    }
}

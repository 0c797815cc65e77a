//! Kinds of robots in scenario files: one for all (`fleet`), or several with their shares (`kinds`). Kinds that come
//! from elsewhere are added to them.
//!
//! Main types: [`KindShare`], and the file's own [`KindFigures`] and [`KindFile`]. Refuses: kinds of one name.

use super::check::{ScenarioError, check};
use giveway_fleet::{Charging, RobotKind, USUAL_KIND};
use giveway_floor::geometry::Point;
use giveway_floor::route::Kinematics;
use giveway_floor::text::name_fault;
use giveway_floor::time::Span;
use giveway_floor::warehouse::Footprint;
use giveway_people::local::{ImprovedWeights, LocalMethod, TraditionalWeights};
use serde::Deserialize;

/// A kind of robots, and how many of each round of robots are of it.
#[derive(Clone, Debug, PartialEq)]
pub struct KindShare {
    /// The kind.
    pub kind: RobotKind,
    /// With kinds of shares 1 and 2, of three robots the first is of the first kind and the others of the second. None
    /// of the scenario's robots are of a kind of share 0, which others may be of.
    pub share: usize,
}

impl KindShare {
    /// All robots are of this kind.
    fn only(kind: RobotKind) -> Vec<KindShare> {
        vec![KindShare { kind, share: 1 }]
    }

    /// All robots are of one kind.
    pub fn one(kinematics: Kinematics, charging: Charging) -> Vec<KindShare> {
        KindShare::only(RobotKind { kinematics, charging, ..RobotKind::default() })
    }
}

/// The figures of a kind as files give them; what is left out is as usual.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct KindFigures {
    speed_mps: Option<f64>,
    speed_loaded_mps: Option<f64>,
    accel_unloaded_mps2: Option<f64>,
    accel_loaded_mps2: Option<f64>,
    lift_s: Option<f64>,
    battery: Battery,
    footprint: Option<Outline>,
    footprint_loaded: Option<Outline>,
    drive: DriveWord,
    carries: Option<Vec<String>>,
    payload_kg: Option<f64>,
    free_navigation: bool,
}

/// An outline as files name it.
#[derive(Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Outline {
    /// The side of a square along the map's axes.
    SquareM(f64),
    /// The radius of a disc.
    CircleM(f64),
    /// Corners, x ahead and y to the left of the point on which the robot turns.
    PolygonM(Vec<[f64; 2]>),
}

/// Whether a robot turns to where it drives.
#[derive(Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum DriveWord {
    #[default]
    Differential,
    Omnidirectional,
}

/// A kind with its name and share.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KindFile {
    name: String,
    #[serde(default = "one")]
    share: usize,
    #[serde(default)]
    fleet: KindFigures,
}

/// [`Charging`] as files name it.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Battery {
    critical: f64,
    low: f64,
    enough: f64,
    full: f64,
    opportunity: bool,
    driving_h: f64,
}

impl Default for Battery {
    fn default() -> Battery {
        let Charging { critical, low, enough, full, opportunity, driving_h } = Charging::default();
        Battery { critical, low, enough, full, opportunity, driving_h }
    }
}

fn one() -> usize {
    1
}

/// The kinds of a file: `fleet` for all robots, or `kinds`.
pub(super) fn read(
    fleet: Option<KindFigures>,
    kinds: Vec<KindFile>,
) -> Result<Vec<KindShare>, ScenarioError> {
    if kinds.is_empty() {
        let figures = fleet.unwrap_or_default();
        return Ok(KindShare::only(figures.kind(USUAL_KIND.to_owned(), "fleet")?));
    }
    let wrong = |message: String| Err(ScenarioError::Wrong { key: "kinds", message });
    if fleet.is_some() {
        return wrong("leave `fleet` out if there are kinds: each has a `fleet` of its own".into());
    }
    for (i, kind) in kinds.iter().enumerate() {
        let at = |what: &str| format!("kinds[{i}].{what}");
        check(&at("share"), kind.share as f64, 1.0..=1000.0, "from 1 to 1000")?;
        if let Some(fault) = name_fault(&kind.name, 50) {
            return wrong(format!("{}: {fault}", at("name")));
        }
        if kinds[..i].iter().any(|k| k.name == kind.name) {
            return wrong(format!("there are two kinds named {:?}", kind.name));
        }
    }
    kinds.into_iter().enumerate().map(|(i, kind)| kind.share(i)).collect()
}

/// [`LocalMethod`] as files name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LocalPlannerWord {
    /// The improved dynamic window.
    #[default]
    Improved,
    /// The traditional one.
    Traditional,
}

impl From<LocalPlannerWord> for LocalMethod {
    fn from(word: LocalPlannerWord) -> LocalMethod {
        match word {
            LocalPlannerWord::Improved => LocalMethod::Improved(ImprovedWeights::default()),
            LocalPlannerWord::Traditional => LocalMethod::Traditional(TraditionalWeights::default()),
        }
    }
}

/// A kind that none of the scenario's robots are of. `figures` is an object like `fleet`.
pub(super) fn read_one(name: &str, figures: &str) -> Result<KindShare, ScenarioError> {
    let figures: KindFigures = serde_json::from_str(figures).map_err(|e| ScenarioError::syntax(&e))?;
    Ok(KindShare { kind: figures.kind(name.to_owned(), "kind")?, share: 0 })
}

impl KindFile {
    fn share(self, i: usize) -> Result<KindShare, ScenarioError> {
        Ok(KindShare { kind: self.fleet.kind(self.name, &format!("kinds[{i}].fleet"))?, share: self.share })
    }
}

impl Outline {
    fn check(&self, key: &str) -> Result<(), ScenarioError> {
        match self {
            Outline::SquareM(m) | Outline::CircleM(m) => {
                check(key, *m, 0.05..=10.0, "from 0.05 to 10 metres")
            }
            Outline::PolygonM(corners) => {
                check(&format!("{key}: corners"), corners.len() as f64, 3.0..=32.0, "from 3 to 32")?;
                let mut numbers = corners.iter().flatten();
                numbers.try_for_each(|m| check(key, *m, -10.0..=10.0, "from -10 to 10 metres"))
            }
        }
    }

    fn footprint(&self, turns: bool) -> Footprint {
        match self {
            Outline::SquareM(side_m) => Footprint::Square { side_m: *side_m },
            Outline::CircleM(radius_m) => Footprint::Circle { radius_m: *radius_m },
            Outline::PolygonM(corners) => {
                let corners = corners.iter().map(|[x, y]| Point::new(*x, *y)).collect();
                Footprint::Polygon { corners, turns }
            }
        }
    }
}

impl Battery {
    fn charging(&self, of: &str) -> Result<Charging, ScenarioError> {
        let Battery { critical, low, enough, full, opportunity, driving_h } = *self;
        let field = |name: &str| format!("{of}.{name}");
        check(&field("critical"), critical, 0.0..=1.0, "from 0 to 1")?;
        check(&field("low"), low, critical..=1.0, "from `critical` to 1")?;
        check(&field("enough"), enough, low..=1.0, "from `low` to 1")?;
        check(&field("full"), full, enough..=1.0, "from `enough` to 1")?;
        check(&field("driving_h"), driving_h, 0.01..=1000.0, "from 0.01 to 1000")?;
        Ok(Charging { critical, low, enough, full, opportunity, driving_h })
    }
}

impl KindFigures {
    fn kind(self, name: String, of: &str) -> Result<RobotKind, ScenarioError> {
        let kinematics = self.kinematics(of)?;
        let charging = self.battery.charging(&format!("{of}.battery"))?;
        let outlines = [("footprint", &self.footprint), ("footprint_loaded", &self.footprint_loaded)];
        for (key, outline) in outlines {
            outline.as_ref().map_or(Ok(()), |o| o.check(&format!("{of}.{key}")))?;
        }
        let payload_kg = self.payload_kg.unwrap_or(f64::INFINITY);
        check(&format!("{of}.payload_kg"), payload_kg, 0.0..=f64::INFINITY, "0 or more")?;
        let turns = self.drive == DriveWord::Differential;
        let footprints = outlines.map(|(_, outline)| outline.as_ref().map(|o| o.footprint(turns)));
        let KindFigures { carries, free_navigation, .. } = self;
        Ok(RobotKind { name, kinematics, charging, footprints, carries, payload_kg, free_navigation })
    }

    fn kinematics(&self, of: &str) -> Result<Kinematics, ScenarioError> {
        let usual = Kinematics::default();
        let speed = self.speed_mps.unwrap_or(usual.speed_mps);
        let speed_loaded = self.speed_loaded_mps.unwrap_or(speed);
        let unloaded = self.accel_unloaded_mps2.unwrap_or(usual.accel_unloaded_mps2);
        let loaded = self.accel_loaded_mps2.unwrap_or(usual.accel_loaded_mps2);
        let lift = self.lift_s.unwrap_or(usual.lift.as_secs_f64());
        let field = |name: &str| format!("{of}.{name}");
        check(&field("speed_mps"), speed, 0.1..=5.0, "from 0.1 to 5")?;
        check(&field("speed_loaded_mps"), speed_loaded, 0.1..=5.0, "from 0.1 to 5")?;
        check(&field("accel_unloaded_mps2"), unloaded, 0.05..=5.0, "from 0.05 to 5")?;
        check(&field("accel_loaded_mps2"), loaded, 0.05..=5.0, "from 0.05 to 5")?;
        check(&field("lift_s"), lift, 0.0..=60.0, "from 0 to 60")?;
        Ok(Kinematics {
            speed_mps: speed,
            speed_loaded_mps: speed_loaded,
            accel_unloaded_mps2: unloaded,
            accel_loaded_mps2: loaded,
            lift: Span::from_secs_f64(lift),
            turn_radps: if self.drive == DriveWord::Differential { usual.turn_radps } else { f64::INFINITY },
            ..usual
        })
    }
}

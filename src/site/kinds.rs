//! Kinds of robots in files and requests: one for all (`fleet`), or several by name (`kinds`).
//!
//! Main types: [`KindFigures`], [`NamedKind`]; main functions: [`read_kinds`], [`read_kind`]. Refuses: two kinds of one
//! name, and impossible figures.

use crate::check::{SiteError, check};
use crate::open_kind::{KindFigure, OpenKind};
use crate::vda5050::{LinkFigures, RobotLinkSettings};
use crate::words;
use giveway_fleet::{Capabilities, Charging, ObeyedLimits, RobotKind, USUAL_KIND};
use giveway_floor::geometry::Point;
use giveway_floor::route::Kinematics;
use giveway_floor::text::name_fault;
use giveway_floor::time::Span;
use giveway_floor::warehouse::Footprint;
use giveway_vda5050::Factsheet;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The figures of a kind in files; missing ones take their defaults.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct KindFigures {
    speed_mps: Option<f64>,
    speed_loaded_mps: Option<f64>,
    accel_unloaded_mps2: Option<f64>,
    accel_loaded_mps2: Option<f64>,
    turn_radps: Option<f64>,
    lift_s: Option<f64>,
    battery: Battery,
    footprint: Option<Outline>,
    footprint_loaded: Option<Outline>,
    drive: DriveWord,
    carries: Option<Vec<String>>,
    payload_kg: Option<f64>,
    free_navigation: bool,
    can: Option<CapabilityFigures>,
}

/// The least and the greatest speed of turning in place, radians per second.
const TURNING: (f64, f64) = (0.1, 10.0);

/// [`Capabilities`] in their file form.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct CapabilityFigures {
    revocation: bool,
    #[serde(deserialize_with = "words::limits")]
    limits: ObeyedLimits,
    drives_back: bool,
    horizon_nodes: usize,
}

impl Default for CapabilityFigures {
    fn default() -> CapabilityFigures {
        let Capabilities { revocation, limits, drives_back, horizon_nodes } = Capabilities::default();
        CapabilityFigures { revocation, limits, drives_back, horizon_nodes }
    }
}

/// An outline in its file form.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Outline {
    /// The side of a square along the map's axes, metres.
    SquareM(f64),
    /// The radius of a disc, metres.
    CircleM(f64),
    /// Corners in metres, x ahead and y to the left of the point on which the robot turns.
    PolygonM(Vec<[f64; 2]>),
}

/// Whether a robot turns to where it drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum DriveWord {
    #[default]
    Differential,
    Omnidirectional,
}

/// A kind with its name.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NamedKind {
    /// Name of the kind.
    pub name: String,
    /// Figures of the kind.
    #[serde(default)]
    pub fleet: KindFigures,
    /// How its robots are spoken to, if they speak VDA 5050.
    #[serde(default)]
    pub link: Option<LinkFigures>,
}

/// [`Charging`] in its file form.
#[derive(Clone, Debug, PartialEq, Deserialize)]
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

/// The kinds of a file: `fleet` for all robots, or `kinds`.
///
/// # Errors
/// If both are given, two kinds have one name, or names or figures are invalid.
pub fn read_kinds(fleet: Option<KindFigures>, kinds: Vec<NamedKind>) -> Result<Vec<RobotKind>, SiteError> {
    check_names(fleet.as_ref(), &kinds)?;
    if kinds.is_empty() {
        return Ok(vec![fleet.unwrap_or_default().kind(USUAL_KIND.to_owned(), "fleet")?]);
    }
    let read = |(i, kind): (usize, NamedKind)| kind.fleet.kind(kind.name, &format!("kinds[{i}].fleet"));
    kinds.into_iter().enumerate().map(read).collect()
}

/// Checks that there are kinds or a `fleet`, not both, and the kinds' names.
fn check_names(fleet: Option<&KindFigures>, kinds: &[NamedKind]) -> Result<(), SiteError> {
    let wrong = |message: String| Err(SiteError::Wrong { key: "kinds", message });
    if fleet.is_some() && !kinds.is_empty() {
        return wrong("leave `fleet` out if there are kinds: each has a `fleet` of its own".into());
    }
    for (i, kind) in kinds.iter().enumerate() {
        if let Some(fault) = name_fault(&kind.name, 50) {
            return wrong(format!("kinds[{i}].name: {fault}"));
        }
        if kinds[..i].iter().any(|k| k.name == kind.name) {
            return wrong(format!("there are two kinds named {:?}", kind.name));
        }
    }
    Ok(())
}

/// The kinds of a site's file, and those that are known only once a robot of them is heard: they speak VDA 5050, and
/// the file leaves figures out that a factsheet may say. Where all kinds are so, simulated robots are of the usual one.
///
/// # Errors
/// As [`read_kinds`], also for what the file says of kinds that are not known yet.
pub(crate) fn read_site_kinds(
    fleet: Option<KindFigures>,
    kinds: Vec<NamedKind>,
    links: &BTreeMap<String, RobotLinkSettings>,
) -> Result<(Vec<RobotKind>, Vec<OpenKind>), SiteError> {
    check_names(fleet.as_ref(), &kinds)?;
    // The usual kind is there from the start.
    let is_open = |name: &str, figures: &KindFigures| {
        let leaves_out = KindFigure::ALL.iter().any(|figure| figures.leaves_out(*figure));
        links.contains_key(name) && name != USUAL_KIND && leaves_out
    };
    let (mut known, mut open) = (Vec::new(), Vec::new());
    for (i, NamedKind { name, fleet: figures, .. }) in kinds.into_iter().enumerate() {
        let usual = figures.clone().kind(name.clone(), &format!("kinds[{i}].fleet"))?;
        match is_open(&name, &figures) {
            true => open.push(OpenKind { name, figures }),
            false => known.push(usual),
        }
    }
    if known.is_empty() {
        known = read_kinds(fleet, Vec::new())?;
    }
    Ok((known, open))
}

/// What is set for the robots of each kind that speaks VDA 5050, by the kind's name. What the kinds' figures do not say
/// of their abilities is what such robots can do: forget what they were released when an order is cancelled, and stand.
///
/// # Errors
/// The invalid figures, by their keys.
pub(crate) fn read_links(kinds: &mut [NamedKind]) -> Result<BTreeMap<String, RobotLinkSettings>, SiteError> {
    let mut links = BTreeMap::new();
    for (i, kind) in kinds.iter_mut().enumerate() {
        let Some(link) = kind.link.take() else { continue };
        let link = link.read(&format!("kinds[{i}].link"), None)?;
        limited_as_linked(&mut kind.fleet, &link);
        links.insert(kind.name.clone(), link);
    }
    Ok(links)
}

/// Lets the figures of a kind that speaks VDA 5050 say what such robots can do, if they do not say it themselves.
/// Robots whose orders have corridors are not displaced beside the line.
pub(crate) fn limited_as_linked(fleet: &mut KindFigures, link: &RobotLinkSettings) {
    let RobotLinkSettings { horizon_nodes, free_navigation, .. } = *link;
    fleet.free_navigation |= free_navigation;
    fleet.can.get_or_insert(CapabilityFigures {
        revocation: true,
        limits: ObeyedLimits::Stops,
        drives_back: false,
        horizon_nodes,
    });
}

/// A kind by its name and figures, an object like `fleet`.
///
/// # Errors
/// The invalid figures, by their keys after `kind.`.
pub fn read_kind(name: &str, figures: &str) -> Result<RobotKind, SiteError> {
    let figures: KindFigures = serde_json::from_str(figures).map_err(|e| SiteError::syntax(&e))?;
    figures.kind(name.to_owned(), "kind")
}

impl Outline {
    fn check(&self, key: &str) -> Result<(), SiteError> {
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
    fn charging(&self, of: &str) -> Result<Charging, SiteError> {
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

impl CapabilityFigures {
    fn read(&self, of: &str) -> Result<Capabilities, SiteError> {
        let CapabilityFigures { revocation, limits, drives_back, horizon_nodes } = *self;
        check(&format!("{of}.horizon_nodes"), horizon_nodes as f64, 0.0..=100.0, "from 0 to 100")?;
        Ok(Capabilities { revocation, limits, drives_back, horizon_nodes })
    }
}

impl KindFigures {
    /// Whether the file leaves a figure out.
    pub(crate) fn leaves_out(&self, figure: KindFigure) -> bool {
        match figure {
            KindFigure::Speed => self.speed_mps.is_none() && self.speed_loaded_mps.is_none(),
            KindFigure::Acceleration => {
                self.accel_unloaded_mps2.is_none() && self.accel_loaded_mps2.is_none()
            }
            // A robot that does not turn has no such figure.
            KindFigure::Turning => self.turn_radps.is_none() && self.drive == DriveWord::Differential,
            KindFigure::Outline => self.footprint.is_none() && self.footprint_loaded.is_none(),
            KindFigure::Payload => self.payload_kg.is_none(),
        }
    }

    /// Takes what is left out from a factsheet, where it says something that a file might say.
    pub(crate) fn fill(&mut self, sheet: &Factsheet) {
        let within = |said: Option<f64>, least: f64, most: f64| said.filter(|x| (least..=most).contains(x));
        if self.leaves_out(KindFigure::Speed) {
            self.speed_mps = within(sheet.speed_mps, 0.1, 5.0);
        }
        if self.leaves_out(KindFigure::Acceleration) {
            // A kind brakes as it accelerates: the weaker of the two holds for both.
            let said = [sheet.accel_mps2, sheet.brake_mps2].map(|said| within(said, 0.05, 5.0));
            let weaker = said.into_iter().flatten().reduce(f64::min);
            (self.accel_unloaded_mps2, self.accel_loaded_mps2) = (weaker, weaker);
        }
        if self.leaves_out(KindFigure::Turning) {
            self.turn_radps = within(sheet.turn_radps, TURNING.0, TURNING.1);
        }
        let size = [sheet.length_m, sheet.width_m].map(|said| within(said, 0.05, 10.0));
        if let ([Some(length), Some(width)], true) = (size, self.leaves_out(KindFigure::Outline)) {
            let (x, y) = (length / 2.0, width / 2.0);
            self.footprint = Some(Outline::PolygonM(vec![[x, y], [-x, y], [-x, -y], [x, -y]]));
        }
        if self.leaves_out(KindFigure::Payload) {
            self.payload_kg = sheet.payload_kg.filter(|kg| kg.is_finite() && *kg > 0.0);
        }
    }

    pub(crate) fn kind(self, name: String, of: &str) -> Result<RobotKind, SiteError> {
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
        let capabilities =
            self.can.as_ref().map_or(Ok(Capabilities::default()), |can| can.read(&format!("{of}.can")))?;
        let KindFigures { carries, free_navigation, .. } = self;
        Ok(RobotKind {
            name,
            kinematics,
            charging,
            footprints,
            carries,
            payload_kg,
            free_navigation,
            capabilities,
        })
    }

    fn kinematics(&self, of: &str) -> Result<Kinematics, SiteError> {
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
        let turn = self.turn_radps.unwrap_or(usual.turn_radps);
        check(&field("turn_radps"), turn, TURNING.0..=TURNING.1, "from 0.1 to 10")?;
        let turns = self.drive == DriveWord::Differential;
        if !turns && self.turn_radps.is_some() {
            let message =
                "leave it out: an omnidirectional robot does not turn to where it drives".to_owned();
            return Err(SiteError::Wrong { key: "turn_radps", message });
        }
        Ok(Kinematics {
            speed_mps: speed,
            speed_loaded_mps: speed_loaded,
            accel_unloaded_mps2: unloaded,
            accel_loaded_mps2: loaded,
            lift: Span::from_secs_f64(lift),
            turn_radps: if turns { turn } else { f64::INFINITY },
            ..usual
        })
    }
}

//! Kinds that are known only once a robot of them is heard: what their file leaves out comes from its factsheet.
//!
//! Main type: [`OpenKinds`]. A kind that the ledger has stays as it is. Refuses: to let robots join before their kind
//! is known.

use super::robot::RobotHere;
use giveway_api::FigureRow;
use giveway_fleet::{Asker, Fleet, FloorAction, Input, KindRefusal, Refusal, RobotKind, Token};
use giveway_floor::geometry::Point;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::links;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Footprint;
use giveway_links::vda5050::NotReady;
use giveway_site::{FigureOrigin, KindFigure, OpenKind};
use giveway_vda5050::Factsheet;
use std::collections::BTreeMap;

/// The token of kinds that are to be added.
pub const ADDS_KIND: Token = Token { asker: Asker(7), number: 1 };
/// A kind that was refused, or got no answer, is asked for again after this.
const ASKS_AGAIN: Span = Span::from_secs(10);

/// The kinds whose files leave figures out.
pub struct OpenKinds {
    all: Vec<OpenKind>,
    /// The one that the fleet was asked to add and has not answered about, and when it was asked.
    asked: Option<(String, Time)>,
    /// Those that it did not add: when it was asked, and why.
    refused: BTreeMap<String, (Time, Sentence)>,
}

impl OpenKinds {
    /// These kinds, of which no robot was heard yet.
    pub fn new(all: Vec<OpenKind>) -> OpenKinds {
        OpenKinds { all, asked: None, refused: BTreeMap::new() }
    }

    /// Whether a kind is to be known by a name some day.
    pub fn has(&self, name: &str) -> bool {
        self.all.iter().any(|kind| kind.name == name)
    }

    /// The request for the next kind that can be added: a robot of it has said what it says of itself.
    pub fn next<'a>(
        &mut self,
        now: Time,
        fleet: &Fleet,
        mut robots: impl Iterator<Item = &'a RobotHere>,
    ) -> Option<Input> {
        // A fleet that was made anew meanwhile has forgotten the question.
        if self.asked.as_ref().is_some_and(|(_, at)| now - *at < ASKS_AGAIN) {
            return None;
        }
        let kinds = fleet.ledger().kinds();
        let rests = |name: &str| self.refused.get(name).is_some_and(|(at, _)| now - *at < ASKS_AGAIN);
        let open = |here: &RobotHere| self.all.iter().find(|kind| kind.name == here.listed.kind);
        let (open, sheet) = robots.find_map(|here| {
            let open = open(here).filter(|open| kinds.named(&open.name).is_none() && !rests(&open.name))?;
            Some((open, here.session.answered_factsheet(now)?))
        })?;
        let kind = open.filled(sheet).ok()?;
        self.asked = Some((open.name.clone(), now));
        Some(Input::ask(ADDS_KIND, FloorAction::PutKind(Box::new(kind))))
    }

    /// Takes the fleet's answer to the last request.
    pub fn answer(&mut self, now: Time, answer: Result<(), &Refusal>) {
        let Some((name, _)) = self.asked.take() else { return };
        let why = match answer {
            Ok(()) => return,
            Err(Refusal::Kind(KindRefusal::TooLarge)) => links::kind_too_large(),
            Err(Refusal::Kind(KindRefusal::Clearance)) => links::kind_brakes_slowly(),
            Err(Refusal::TooMany(..)) => links::kinds_are_full(),
            Err(other) => links::kind_refused(format!("{other:?}")),
        };
        self.refused.insert(name, (now, why));
    }

    /// Why a robot has not joined whose kind is not known yet, if nothing else keeps it.
    pub fn why_not(&self, name: &str, why: Option<&NotReady>) -> Option<Sentence> {
        match (self.refused.get(name), why) {
            (Some((_, refused)), _) => Some(refused.clone()),
            (None, None | Some(NotReady::Unproven)) => Some(links::kind_waits()),
            (None, Some(_)) => None,
        }
    }

    /// The figures of a kind on the floor, and where each comes from.
    pub fn figures(&self, kind: &RobotKind) -> Vec<FigureRow> {
        let open = self.all.iter().find(|open| open.name == kind.name);
        let row = |figure: KindFigure| FigureRow {
            figure: figure.word(),
            value: value_text(kind, figure),
            origin: open.map_or(FigureOrigin::File, |open| open.origin(figure, kind)).word(),
        };
        KindFigure::ALL.map(row).into()
    }
}

fn value_text(kind: &RobotKind, figure: KindFigure) -> String {
    let motion = &kind.kinematics;
    match figure {
        KindFigure::Speed => format!("{} m/s", motion.speed_mps),
        KindFigure::Acceleration => format!("{} m/s²", motion.accel_unloaded_mps2),
        KindFigure::Turning if motion.turn_radps.is_finite() => format!("{:.2} rad/s", motion.turn_radps),
        KindFigure::Turning => "-".to_owned(),
        KindFigure::Outline => match kind.footprints[0].as_ref().map(extent_m) {
            Some([length, width]) => format!("{length} × {width} m"),
            None => "-".to_owned(),
        },
        KindFigure::Payload if kind.payload_kg.is_finite() => format!("{} kg", kind.payload_kg),
        KindFigure::Payload => "-".to_owned(),
    }
}

/// The length and the width of a footprint, metres.
fn extent_m(of: &Footprint) -> [f64; 2] {
    match of {
        Footprint::Square { side_m } => [*side_m; 2],
        Footprint::Circle { radius_m } => [2.0 * radius_m; 2],
        Footprint::Polygon { corners, .. } => {
            let side = |along: fn(&Point) -> f64| {
                let all = corners.iter().map(along);
                all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
            };
            [side(|at| at.x), side(|at| at.y)]
        }
    }
}

/// Where a factsheet promises less than the kind.
pub fn contradictions(kind: &RobotKind, sheet: &Factsheet) -> Vec<String> {
    let motion = &kind.kinematics;
    let size = kind.footprints[0].as_ref().map(extent_m);
    let most = |says: Option<f64>, has: f64, what: &str, unit: &str| {
        let says = says.filter(|says| *says + 1e-6 < has && *says > 0.0)?;
        Some(format!("{what}: the kind has {has} {unit}, the robot says that it can do {says} {unit}"))
    };
    let larger = |says: Option<f64>, has: Option<f64>, what: &str| {
        let (says, has) = (says?, has?);
        (says > has + 1e-3).then(|| format!("{what}: the kind has {has} m, the robot says {says} m"))
    };
    let mut all: Vec<String> = [
        most(sheet.speed_mps, motion.speed_mps.max(motion.speed_loaded_mps), "speed", "m/s"),
        most(
            sheet.accel_mps2,
            motion.accel_unloaded_mps2.max(motion.accel_loaded_mps2),
            "acceleration",
            "m/s²",
        ),
        most(sheet.brake_mps2, motion.accel_unloaded_mps2.max(motion.accel_loaded_mps2), "braking", "m/s²"),
        most(
            sheet.turn_radps.filter(|_| motion.turn_radps.is_finite()),
            motion.turn_radps,
            "turning",
            "rad/s",
        ),
        larger(sheet.length_m, size.map(|size| size[0]), "length"),
        larger(sheet.width_m, size.map(|size| size[1]), "width"),
    ]
    .into_iter()
    .flatten()
    .collect();
    if kind.payload_kg.is_finite() {
        all.extend(most(sheet.payload_kg, kind.payload_kg, "payload", "kg"));
    }
    all
}

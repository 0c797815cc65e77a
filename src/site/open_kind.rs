//! Kinds of robots of which a file leaves figures out: these come from the factsheet of the first robot that is heard,
//! then from defaults.
//!
//! Main types: [`OpenKind`], [`KindFigure`], [`FigureOrigin`]. Refuses: figures of a factsheet that no file might have.

use crate::check::SiteError;
use crate::kinds::KindFigures;
use giveway_fleet::RobotKind;
use giveway_vda5050::Factsheet;

/// A kind whose file leaves figures out.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenKind {
    /// Its name.
    pub name: String,
    pub(crate) figures: KindFigures,
}

/// A figure of a kind that a factsheet may say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum KindFigure {
    /// The greatest speed.
    Speed,
    /// The acceleration, and the deceleration of the brakes.
    Acceleration,
    /// The speed of turning in place.
    Turning,
    /// The outline.
    Outline,
    /// The heaviest load.
    Payload,
}

/// Where a figure of a kind comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureOrigin {
    /// The file says it.
    File,
    /// The file leaves it out, and the factsheet of the kind's first robot said it.
    Factsheet,
    /// Neither says it.
    Default,
}

impl KindFigure {
    /// All of them.
    pub const ALL: [KindFigure; 5] = [
        KindFigure::Speed,
        KindFigure::Acceleration,
        KindFigure::Turning,
        KindFigure::Outline,
        KindFigure::Payload,
    ];

    /// Its word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            KindFigure::Speed => "speed",
            KindFigure::Acceleration => "acceleration",
            KindFigure::Turning => "turning",
            KindFigure::Outline => "outline",
            KindFigure::Payload => "payload",
        }
    }

    /// Whether two kinds have the same figure.
    fn is_equal(self, a: &RobotKind, b: &RobotKind) -> bool {
        let (moves, other) = (&a.kinematics, &b.kinematics);
        match self {
            KindFigure::Speed => moves.speed_mps == other.speed_mps,
            KindFigure::Acceleration => moves.accel_unloaded_mps2 == other.accel_unloaded_mps2,
            KindFigure::Turning => moves.turn_radps == other.turn_radps,
            KindFigure::Outline => a.footprints == b.footprints,
            KindFigure::Payload => a.payload_kg == b.payload_kg,
        }
    }
}

impl FigureOrigin {
    /// Its word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            FigureOrigin::File => "file",
            FigureOrigin::Factsheet => "factsheet",
            FigureOrigin::Default => "default",
        }
    }
}

impl OpenKind {
    /// The kind, with what a factsheet says in place of what the file leaves out.
    ///
    /// # Errors
    /// If a figure is out of its range: none is that comes from the factsheet.
    pub fn filled(&self, sheet: Option<&Factsheet>) -> Result<RobotKind, SiteError> {
        let mut figures = self.figures.clone();
        if let Some(sheet) = sheet {
            figures.fill(sheet);
        }
        figures.kind(self.name.clone(), &format!("kinds.{}.fleet", self.name))
    }

    /// Where a figure of this kind comes from, as it is on the floor.
    pub fn origin(&self, figure: KindFigure, on_floor: &RobotKind) -> FigureOrigin {
        if !self.figures.leaves_out(figure) {
            return FigureOrigin::File;
        }
        let is_default = self.filled(None).is_ok_and(|usual| figure.is_equal(&usual, on_floor));
        if is_default { FigureOrigin::Default } else { FigureOrigin::Factsheet }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(figures: &str) -> OpenKind {
        OpenKind { name: "tug".into(), figures: serde_json::from_str(figures).expect("figures") }
    }

    #[test]
    fn what_a_file_leaves_out_comes_from_the_factsheet_and_then_from_defaults() {
        let tug = open(r#"{"speed_mps": 1.2}"#);
        let sheet = Factsheet {
            speed_mps: Some(2.0),
            accel_mps2: Some(0.8),
            brake_mps2: Some(0.6),
            turn_radps: Some(1.1),
            length_m: Some(0.9),
            width_m: Some(0.5),
            ..Factsheet::default()
        };
        let kind = tug.filled(Some(&sheet)).expect("a kind");
        assert_eq!((kind.kinematics.speed_mps, kind.kinematics.accel_loaded_mps2), (1.2, 0.6));
        assert_eq!(kind.kinematics.turn_radps, 1.1);
        let origins = KindFigure::ALL.map(|figure| tug.origin(figure, &kind).word());
        assert_eq!(origins, ["file", "factsheet", "factsheet", "factsheet", "default"]);
        let usual = tug.filled(None).expect("a kind");
        let origins = KindFigure::ALL.map(|figure| tug.origin(figure, &usual).word());
        assert_eq!(origins, ["file", "default", "default", "default", "default"]);
    }

    #[test]
    fn figures_of_a_factsheet_that_no_robot_has_count_as_left_out() {
        let absurd = |x: f64| Factsheet {
            speed_mps: Some(x),
            accel_mps2: Some(x),
            brake_mps2: Some(x),
            turn_radps: Some(x),
            length_m: Some(x),
            width_m: Some(x),
            payload_kg: Some(x),
            ..Factsheet::default()
        };
        let tug = open("{}");
        for x in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e9] {
            let kind = tug.filled(Some(&absurd(x))).expect("a kind");
            let payload = if x == 1e9 { x } else { f64::INFINITY };
            assert_eq!(kind, RobotKind { payload_kg: payload, ..tug.filled(None).expect("a kind") }, "{x}");
        }
    }
}

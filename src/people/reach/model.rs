//! All learned figures about people at arm's length in one file.
//!
//! Main types: [`PickModel`], [`PickModelError`]. `giveway learn picks` writes the file, the server and simulations
//! load it; without one the built-in figures apply, which were learned from simulated people. Refuses: other versions,
//! wrong shapes and impossible figures, by name.

use super::arm::{ARM_STEPS, ArmForecast, ArmNet, SPEED_CLASSES};
use super::ends::EndNet;
use super::gaze::GazeModel;
use super::sample::{ARM_PARTS, ArmSample};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, LazyLock};

/// Version of the file's format.
pub const PICK_MODEL_VERSION: u32 = 2;
/// Number of speed classes.
pub const CLASSES: usize = SPEED_CLASSES.len() + 1;

/// Learned figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PickModel {
    /// Version of the file's format.
    pub version: u32,
    /// The sources that the model was learned from.
    pub sources: Vec<String>,
    /// The command that makes the model again.
    pub command: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The people that the model was learned from.
    pub people: Vec<String>,
    /// Number of groups of people, each left out once: temperatures, regions and scores come from people left out.
    pub folds: usize,
    /// Scores on people left out.
    pub left_out: LeftOutScores,
    /// Model of which place a hand goes to.
    pub slots: SlotModel,
    /// Model of where the arm will be.
    pub arm: ArmModel,
    /// Model of where the eyes look.
    pub gaze: GazeModel,
}

/// Scores on people left out of training.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeftOutScores {
    /// Number of movements.
    pub movements: usize,
    /// Share of right places, averaged over ten parts of the way.
    pub top1_mean: f64,
    /// Mean negative log-likelihood, nats.
    pub nll: f64,
    /// Expected calibration error.
    pub ece: f64,
    /// Mean error of the hand after 0.2 and 0.4 s, millimetres.
    pub hand_mm: [f64; 2],
    /// Share of hands in their 95 % region after 0.2 and 0.4 s.
    pub hand_cov95: [f64; 2],
}

/// Model of which place a hand goes to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlotModel {
    /// Nets whose scores are averaged as logarithms of probabilities.
    pub nets: Vec<EndNet>,
    /// Factor on scores (the inverse of a temperature).
    pub sharpness: f64,
    /// Score of "none of these places".
    pub none: f64,
    /// Sharpness per metre of the rule by distance of the finger tip.
    pub hand_rule: f64,
    /// Sharpness of the rule by distance between head ray and place.
    pub head_rule: f64,
}

/// Model of where the arm will be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmModel {
    /// Nets whose forecasts are averaged.
    pub nets: Vec<ArmNet>,
    /// Radius of the 95 % region in units of width, by class of speed, step and part.
    pub regions: Vec<[[f64; ARM_PARTS]; ARM_STEPS]>,
}

/// Why a file is no model.
#[derive(Debug, thiserror::Error)]
pub enum PickModelError {
    /// The file cannot be read.
    #[error("this is not a model of picks: {0}; make one with `giveway learn picks`")]
    Unreadable(#[from] serde_json::Error),
    /// The file has another version.
    #[error(
        "the model has version {0}; this program reads version {PICK_MODEL_VERSION}: make a new one with \
         `giveway learn picks`"
    )]
    Version(u64),
    /// The file has impossible figures.
    #[error("the model's {0}; make a new one with `giveway learn picks`")]
    Figures(String),
}

/// The file's content: the model, and the learned published methods, which only experiments read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PickFile {
    model: PickModel,
    #[serde(default)]
    #[allow(dead_code, reason = "read by experiments")]
    published: IgnoredAny,
}

/// The version alone.
#[derive(Deserialize)]
struct Versioned {
    model: VersionOnly,
}

#[derive(Deserialize)]
struct VersionOnly {
    version: u64,
}

impl PickModel {
    /// Reads a model file.
    pub fn parse(text: &str) -> Result<PickModel, PickModelError> {
        let versioned: Versioned = serde_json::from_str(text)?;
        if versioned.model.version != u64::from(PICK_MODEL_VERSION) {
            return Err(PickModelError::Version(versioned.model.version));
        }
        let PickFile { model, .. } = serde_json::from_str(text)?;
        match model.fault() {
            Some(fault) => Err(PickModelError::Figures(fault)),
            None => Ok(model),
        }
    }

    /// The text of the model's file, which reads back as the same model.
    pub fn to_json(&self) -> String {
        serde_json::json!({ "model": self }).to_string()
    }

    /// Figures learned from simulated people; `docs/picks.md` has the command.
    pub fn builtin() -> Arc<PickModel> {
        static BUILTIN: LazyLock<Arc<PickModel>> = LazyLock::new(|| {
            Arc::new(PickModel::parse(PickModel::BUILTIN).expect("the file in the source is a model"))
        });
        BUILTIN.clone()
    }

    /// Text of the built-in file.
    pub const BUILTIN: &str = include_str!("builtin.json");

    fn fault(&self) -> Option<String> {
        let slots = self.slots.fault().map(|f| format!("slots: {f}"));
        let arm = slots.or_else(|| self.arm.fault().map(|f| format!("arm: {f}")));
        let gaze = arm.or_else(|| self.gaze.fault().map(|f| format!("gaze: {f}")));
        gaze.or_else(|| self.left_out.fault().map(|f| format!("left_out: {f}")))
    }
}

impl LeftOutScores {
    fn fault(&self) -> Option<&'static str> {
        let shares = [self.top1_mean, self.ece, self.hand_cov95[0], self.hand_cov95[1]];
        let is_sound = shares.iter().all(|s| (0.0..=1.0).contains(s)) && (0.0..=20.0).contains(&self.nll);
        (!is_sound).then_some("shares must be from 0 to 1, nll from 0 to 20")
    }
}

impl SlotModel {
    fn fault(&self) -> Option<String> {
        if !(1..=16).contains(&self.nets.len()) {
            return Some(format!("{} nets are not from 1 to 16", self.nets.len()));
        }
        if let Some(fault) = self.nets.iter().find_map(EndNet::fault) {
            return Some(fault);
        }
        let is_sharp = |s: f64| (1e-3..=1e3).contains(&s);
        let sharp = [self.sharpness, self.hand_rule, self.head_rule];
        let is_sound = sharp.into_iter().all(is_sharp) && self.none.abs() <= 1e3;
        (!is_sound).then(|| "sharpness and rules must be from 0.001 to 1000, none within 1000".into())
    }
}

impl ArmModel {
    fn fault(&self) -> Option<String> {
        if !(1..=16).contains(&self.nets.len()) || self.regions.len() != CLASSES {
            return Some(format!("nets must be from 1 to 16, regions {CLASSES}"));
        }
        let radii = self.regions.iter().flatten().flatten();
        if !radii.into_iter().all(|r| (1e-3..=1e3).contains(r)) {
            return Some("regions must be from 0.001 to 1000 widths".into());
        }
        self.nets.iter().find_map(ArmNet::fault)
    }

    /// Forecast of the arm: the mean of all nets, with 95 % regions by [`ArmModel::radius_m`].
    pub fn forecast(&self, observed: &[ArmSample]) -> Option<ArmForecast> {
        average(self.nets.iter().map(|net| net.forecast(observed)).collect::<Option<Vec<_>>>()?)
    }

    /// Radius of the 95 % region of a part at a step, metres.
    pub fn radius_m(&self, forecast: &ArmForecast, step: usize, part: usize) -> f64 {
        self.regions[forecast.class][step][part] * forecast.width_m[step][part]
    }
}

/// The mean of several forecasts; nothing if there are none.
pub fn average(all: Vec<ArmForecast>) -> Option<ArmForecast> {
    let count = all.len() as f64;
    let mut mean = all.first()?.clone();
    for k in 0..ARM_STEPS {
        for p in 0..ARM_PARTS {
            let sum: nalgebra::Vector3<f64> = all.iter().map(|f| f.middle[k][p].coords).sum();
            mean.middle[k][p] = (sum / count).into();
            mean.width_m[k][p] = all.iter().map(|f| f.width_m[k][p]).sum::<f64>() / count;
        }
    }
    Some(mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_file_is_small_and_learned_from_simulated_people_only() {
        let model = PickModel::builtin();
        assert!(PickModel::BUILTIN.len() < 300_000, "{} bytes", PickModel::BUILTIN.len());
        assert!(model.command.contains("--simulated"), "{}", model.command);
        assert!(model.people.iter().all(|p| p.starts_with("simulated")));
        assert!(model.left_out.top1_mean > 0.5 && model.left_out.ece < 0.05, "{:?}", model.left_out);
    }

    #[test]
    fn other_versions_wrong_shapes_and_impossible_figures_are_refused_by_name() {
        let file: serde_json::Value = serde_json::from_str(PickModel::BUILTIN).unwrap();
        let refused = |change: &dyn Fn(&mut serde_json::Value)| {
            let mut changed = file.clone();
            change(&mut changed);
            PickModel::parse(&changed.to_string()).unwrap_err().to_string()
        };
        type Change<'a> = &'a dyn Fn(&mut serde_json::Value);
        let wrong: [(&str, Change); 5] = [
            ("version 1", &|v| v["model"]["version"] = 1.into()),
            ("slots: a memory of 7 inputs", &|v| {
                v["model"]["slots"]["nets"][0]["memory"]["inputs"] = 7.into()
            }),
            ("invalid type: null", &|v| v["model"]["slots"]["sharpness"] = serde_json::Value::Null),
            ("slots: sharpness", &|v| v["model"]["slots"]["sharpness"] = (-1.0).into()),
            ("arm: regions", &|v| v["model"]["arm"]["regions"][0][0][0] = 0.0.into()),
        ];
        for (what, change) in wrong {
            let error = refused(change);
            assert!(error.contains(what) && error.contains("giveway learn picks"), "{what}: {error}");
        }
    }
}

//! All learned figures about people in one file.
//!
//! Main types: [`Model`], [`ModelError`]. `giveway learn` writes the file, the server and simulations load it; without
//! one the built-in figures apply, which were learned in the same way from public recordings. Refuses: impossible
//! figures.

use super::forecast::{CLASSES, HORIZONS, Kernel, Shapes};
use super::intention::PurposeModel;
use super::motion::MotionModel;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, LazyLock};

/// Version of the file's format.
const VERSION: u32 = 1;

/// Learned figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Version of the file's format.
    pub version: u32,
    /// The sources that the model was learned from.
    pub learned_from: Vec<String>,
    /// Figures of the motion filter.
    pub motion: MotionModel,
    /// Figures of the goal recogniser.
    pub purpose: Arc<PurposeModel>,
    /// Forecast shapes for people with known goals.
    pub bound: Shapes,
    /// Forecast shapes for people without a known goal.
    pub free: Shapes,
}

/// Why a file is no model.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("this is not a model of people: {0}")]
    Unreadable(#[from] serde_json::Error),
    /// The file has another version.
    #[error("the model has version {0}; this program reads version {VERSION}: learn it again")]
    Version(u32),
    /// The file has impossible figures.
    #[error("the model's {0}")]
    Figures(String),
}

impl Model {
    /// Reads a model.
    pub fn parse(text: &str) -> Result<Model, ModelError> {
        let model: Model = serde_json::from_str(text)?;
        if model.version != VERSION {
            return Err(ModelError::Version(model.version));
        }
        match model.fault() {
            Some(fault) => Err(ModelError::Figures(fault)),
            None => Ok(model),
        }
    }

    /// The model as text, for a file.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("figures are numbers and names") + "\n"
    }

    /// Figures learned from public recordings of people in halls and streets.
    pub fn builtin() -> Arc<Model> {
        static BUILTIN: LazyLock<Arc<Model>> = LazyLock::new(|| {
            Arc::new(Model::parse(include_str!("builtin.json")).expect("the file in the source is a model"))
        });
        BUILTIN.clone()
    }

    fn fault(&self) -> Option<String> {
        if let Some(fault) = self.motion.fault() {
            return Some(format!("motion: {fault}"));
        }
        if let Some(fault) = self.purpose.fault() {
            return Some(format!("purpose: {fault}"));
        }
        let faults = [("bound", &self.bound), ("free", &self.free)].into_iter();
        faults.filter_map(|(name, s)| Some(format!("{name}: {}", s.fault()?))).next()
    }
}

impl PurposeModel {
    fn fault(&self) -> Option<&'static str> {
        let share = |s: &f64| (0.0..=1.0).contains(s);
        if self.betas_per_m.iter().any(|b| !(0.0..=1e3).contains(b)) || !self.beta_shares.iter().all(share) {
            return Some("betas_per_m must be from 0 to 1000 and beta_shares from 0 to 1");
        }
        if (self.beta_shares.iter().sum::<f64>() - 1.0).abs() > 1e-6 {
            return Some("beta_shares must sum to one");
        }
        if !(1e-6..=0.9).contains(&self.elsewhere) || !(0.0..=100.0).contains(&self.kappa) {
            return Some("elsewhere must be from 0.000001 to 0.9, kappa from 0 to 100");
        }
        if !(0.0..=100.0).contains(&self.changes_per_s) || !(0.01..=1e6).contains(&self.dwell_s) {
            return Some("changes_per_s must be from 0 to 100, dwell_s at least 0.01");
        }
        let places = self.places.len();
        let is_place = |p: &super::intention::DetourPlace| {
            p.next.len() == places && p.next.iter().all(share) && p.x_m.is_finite() && p.y_m.is_finite()
        };
        (!self.places.iter().all(is_place)).then_some("places must have a share for every place")
    }
}

impl Shapes {
    fn fault(&self) -> Option<&'static str> {
        if self.classes.len() != CLASSES || self.classes.iter().any(|c| c.len() != HORIZONS) {
            return Some("classes must be four lists of twelve");
        }
        let is_sound = |k: &Kernel| {
            let sigmas = k.tight_m.iter().chain(&k.wide_m);
            (0.0..=1.0).contains(&k.weight)
                && (0.0..=1.0).contains(&k.wide_share)
                && k.shift_m.abs() < 100.0
                && sigmas.into_iter().all(|s| (1e-4..=100.0).contains(s))
        };
        let all = self.classes.iter().flatten();
        if !all.clone().all(|s| [&s.drive, &s.goal, &s.stay].into_iter().all(is_sound)) {
            return Some("weights and shares must be from 0 to 1, standard deviations from 0.0001 to 100");
        }
        if all.clone().any(|s| s.drive.weight + s.stay.weight < 1e-9 || !(0.1..=10.0).contains(&s.scale)) {
            return Some("drive or stay must have weight, and scale be from 0.1 to 10");
        }
        (!(0.05..=100.0).contains(&self.blend_s)).then_some("blend_s must be from 0.05 to 100")
    }
}

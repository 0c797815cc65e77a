//! Trained published methods, for comparison.
//!
//! Main types: [`PublishedPicks`], [`LearnedPicks`] (a whole file). Refuses: to be used for anything but tables.

use super::bones::BoneNet;
use super::destination::DestinationNets;
use super::gaze::gaze_net_fault;
use super::perceptron::Perceptron;
use super::places::PlaceVariant;
use super::seq2seq::SeqToSeq;
use giveway_people::reach::mixtures::PalmMixture;
use giveway_people::reach::model::{PickModel, PickModelError};
use giveway_people::reach::places::PlaceNet;
use serde::{Deserialize, Serialize};

/// One trained variant of the published predictor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedNet {
    /// Name of the variant: `lstm`, `mlp`, `rnn`, `full` or `all`.
    pub variant: String,
    /// The trained net.
    pub net: PlaceNet,
    /// Factor on scores.
    pub sharpness: f64,
}

/// All trained published methods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedPicks {
    /// Variants; those for all places together, once per number of places.
    pub nets: Vec<PublishedNet>,
    /// Palm points per place.
    pub mixtures: Vec<PalmMixture>,
    /// Sharpness of observed palm points.
    pub observed: f64,
    /// Sharpness of observed and forecast palm points.
    pub ahead: f64,
    /// Weight of palm mixtures beside our nets that helps most on people left out, and the sharpness of both together.
    pub both: [f64; 2],
    /// The sequence-to-sequence net.
    pub seq2seq: SeqToSeq,
    /// The net of bones.
    pub bones: BoneNet,
    /// The destination-first nets.
    pub vae: DestinationNets,
    /// The gaze net.
    pub gaze: Option<Perceptron>,
}

/// Content of a whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearnedPicks {
    /// The model in use.
    pub model: PickModel,
    /// Methods to compare with it.
    #[serde(default)]
    pub published: Option<PublishedPicks>,
}

impl LearnedPicks {
    /// Reads a file and checks its model as [`PickModel::parse`] does.
    pub fn parse(text: &str) -> Result<LearnedPicks, PickModelError> {
        PickModel::parse(text)?;
        let learned: LearnedPicks = serde_json::from_str(text)?;
        match learned.published.as_ref().and_then(PublishedPicks::fault) {
            Some(fault) => Err(PickModelError::Figures(format!("published: {fault}"))),
            None => Ok(learned),
        }
    }

    /// The text for a file.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("figures are numbers and names") + "\n"
    }
}

impl PublishedPicks {
    /// The net of a variant for this number of places.
    pub fn net(&self, variant: PlaceVariant, places: usize) -> Option<&PublishedNet> {
        let fits = |n: &&PublishedNet| n.variant == variant.word() && [1, places].contains(&n.net.group);
        self.nets.iter().find(fits)
    }

    fn fault(&self) -> Option<String> {
        let is_sharp = |s: f64| (1e-4..=1e4).contains(&s);
        let sharp = self.nets.iter().map(|n| n.sharpness).chain([self.observed, self.ahead]);
        if !sharp.into_iter().all(is_sharp) {
            return Some("sharpness must be from 0.0001 to 10000".into());
        }
        let named = |n: &PublishedNet| n.net.fault().map(|f| format!("{}: {f}", n.variant));
        let nets = self.nets.iter().find_map(named);
        let mixtures = nets.or_else(|| self.mixtures.iter().find_map(PalmMixture::fault));
        let seq2seq = mixtures.or_else(|| self.seq2seq.fault().map(|f| format!("seq2seq: {f}")));
        let bones = seq2seq.or_else(|| self.bones.fault().map(|f| format!("bones: {f}")));
        let vae = bones.or_else(|| self.vae.fault().map(|f| format!("vae: {f}")));
        vae.or_else(|| self.gaze.as_ref().and_then(gaze_net_fault).map(|f| format!("gaze: {f}")))
    }
}

//! The kinds of a scenario's robots, and how simulated robots pass people.
//!
//! Main types: [`KindFile`], [`LocalPlannerWord`]. Refuses: kinds without a robot.

use giveway_fleet::RobotKind;
use giveway_people::local::{ImprovedWeights, LocalMethod, TraditionalWeights};
use giveway_site::{KindFigures, NamedKind, SiteError, check, read_kinds};
use serde::Deserialize;

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

fn one() -> usize {
    1
}

/// Reads the kinds of a file and their shares: `fleet` for all robots, or `kinds`.
pub(super) fn read(
    fleet: Option<KindFigures>,
    kinds: Vec<KindFile>,
) -> Result<(Vec<RobotKind>, Vec<usize>), SiteError> {
    for (i, kind) in kinds.iter().enumerate() {
        check(&format!("kinds[{i}].share"), kind.share as f64, 1.0..=1000.0, "from 1 to 1000")?;
    }
    let shares = if kinds.is_empty() { vec![1] } else { kinds.iter().map(|k| k.share).collect() };
    let named = kinds.into_iter().map(|KindFile { name, fleet, .. }| NamedKind { name, fleet, link: None });
    Ok((read_kinds(fleet, named.collect())?, shares))
}

/// [`LocalMethod`] as files name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LocalPlannerWord {
    /// The improved dynamic window approach.
    #[default]
    Improved,
    /// The traditional dynamic window approach.
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

//! Choices of the core as site and scenario files spell them.
//!
//! Main functions: [`policy`], [`method`], [`node_windows`], [`flow`], [`arm_mode`], for `deserialize_with`; a key that
//! is left out is `None` with `#[serde(default)]`. [`method_of`] reads the word of a setting. Refuses: words unknown to
//! the core; the refusal lists the known ones.

use giveway_cell::Flow;
use giveway_cell::arm::ArmMode;
use giveway_fleet::ObeyedLimits;
use giveway_people::aware::{HumanAwarePolicy, NodeWindows};
use giveway_people::human::Method;
use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Methods that our own policy may have. The method of chapter 4 belongs to a policy of its own (`phir`).
const METHODS: [(&str, Method); 3] =
    [("detour", Method::Detour), ("chapter3", Method::Chapter3), ("chapter3_tiles", Method::Chapter3Tiles)];
const NODE_WINDOWS: [(&str, NodeWindows); 2] =
    [("speeds", NodeWindows::Speeds), ("mixture", NodeWindows::Mixture)];

fn find<T: Copy>(word: &str, all: &[(&str, T)]) -> Result<T, String> {
    let words: Vec<String> = all.iter().map(|(word, _)| format!("`{word}`")).collect();
    let found = all.iter().find(|(known, _)| *known == word).map(|(_, value)| *value);
    found.ok_or_else(|| format!("unknown word `{word}`, expected one of {}", words.join(", ")))
}

fn read<'de, T: Copy, D: Deserializer<'de>>(from: D, all: &[(&str, T)]) -> Result<Option<T>, D::Error> {
    find(&String::deserialize(from)?, all).map(Some).map_err(D::Error::custom)
}

/// The method that a word names.
///
/// # Errors
/// The known words.
pub fn method_of(word: &str) -> Result<Method, String> {
    find(word, &METHODS)
}

/// Reads how the fleet deals with people.
pub fn policy<'de, D: Deserializer<'de>>(from: D) -> Result<Option<HumanAwarePolicy>, D::Error> {
    read(from, &HumanAwarePolicy::ALL.map(|policy| (policy.word(), policy)))
}

/// Reads how goals of workers are recognised.
pub fn method<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Method>, D::Error> {
    read(from, &METHODS)
}

/// Reads how the fleet finds out when a worker takes a node.
pub fn node_windows<'de, D: Deserializer<'de>>(from: D) -> Result<Option<NodeWindows>, D::Error> {
    read(from, &NODE_WINDOWS)
}

/// Reads which limits of its speed a robot obeys within its grants.
pub fn limits<'de, D: Deserializer<'de>>(from: D) -> Result<ObeyedLimits, D::Error> {
    find(&String::deserialize(from)?, &ObeyedLimits::ALL.map(|limits| (limits.word(), limits)))
        .map_err(D::Error::custom)
}

/// Reads how the fleet uses order lines and hands at picking stations.
pub fn flow<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Flow>, D::Error> {
    read(from, &Flow::ALL.map(|flow| (flow.word(), flow)))
}

/// Reads when robot arms move beside pickers.
pub fn arm_mode<'de, D: Deserializer<'de>>(from: D) -> Result<Option<ArmMode>, D::Error> {
    read(from, &ArmMode::ALL.map(|mode| (mode.word(), mode)))
}

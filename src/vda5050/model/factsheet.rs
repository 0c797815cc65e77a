//! What a robot says that it is and can do.
//!
//! Main type: [`Factsheet`]. Every field may be missing: of three robots that were measured, none sent a valid one.
//! Refuses: to fill in what is missing.

/// What a robot says that it is and can do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Factsheet {
    /// The name of the series.
    pub series: Option<String>,
    /// The greatest speed, metres per second.
    pub speed_mps: Option<f64>,
    /// The greatest acceleration, metres per second squared.
    pub accel_mps2: Option<f64>,
    /// The greatest deceleration, metres per second squared.
    pub brake_mps2: Option<f64>,
    /// The greatest speed of turning in place, radians per second, 3.0.
    pub turn_radps: Option<f64>,
    /// How long it is, metres.
    pub length_m: Option<f64>,
    /// How wide it is, metres.
    pub width_m: Option<f64>,
    /// The heaviest load, kilograms.
    pub payload_kg: Option<f64>,
    /// The most nodes of an order.
    pub most_nodes: Option<usize>,
    /// The longest id, characters.
    pub longest_id: Option<usize>,
    /// The least time between two orders, seconds.
    pub order_interval_s: Option<f64>,
    /// The actions that it offers; nothing if it does not say.
    pub actions: Option<Vec<OfferedAction>>,
    /// The types of zones that it knows, 3.0.
    pub zones: Vec<String>,
    /// Charge at which it must charge, from 0 to 1.
    pub critical: Option<f64>,
}

/// An action that a robot offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OfferedAction {
    /// The action's kind.
    pub kind: String,
    /// Where it may be asked for.
    pub scopes: Vec<ActionScope>,
}

/// Where an action may be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionScope {
    /// At once.
    AtOnce,
    /// At a node.
    Node,
    /// On an edge.
    Edge,
    /// In a zone, 3.0.
    Zone,
}

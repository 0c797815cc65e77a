//! Areas of a map with rules, 3.0.
//!
//! Main types: [`ZoneSet`], [`Zone`]. Refuses: types of zones that neither this master nor this robot has a use for.

/// All zones of a map. A set with an id never changes: another one takes its place.
#[derive(Clone, Debug, PartialEq)]
pub struct ZoneSet {
    /// The set's id.
    pub id: String,
    /// The robot's name of the map.
    pub map: String,
    /// The zones.
    pub zones: Vec<Zone>,
}

/// An area with a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// The zone's id, unique in its set.
    pub id: String,
    /// The rule.
    pub kind: ZoneKind,
    /// The corners, anticlockwise, three at least: x and y in metres, in the map's frame.
    pub corners: Vec<(f64, f64)>,
}

/// The rule of a zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ZoneKind {
    /// No robot may enter. A robot that is within stops and is stuck.
    Blocked,
    /// A robot asks before it enters. If it loses the release within, it stops.
    Release,
    /// No robot drives faster than this within, metres per second.
    SpeedLimit(f64),
}

/// A zone set that a robot has stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredZoneSet {
    /// The set's id.
    pub id: String,
    /// The robot's name of the map.
    pub map: String,
    /// Whether the set is in force: one set of a map at most.
    pub enabled: bool,
}

//! Robot kinds: what all robots of one kind have in common.
//!
//! Main types: [`RobotKind`], [`Charging`], [`Capabilities`]. Main function: [`fitted`]. A robot's kind is known by its
//! name. A kind of the site may be changed between two starts; an added kind is a fact, and stays while robots are of
//! it. Refuses: to know of a robot's state.

use giveway_floor::route::Kinematics;
use giveway_floor::time::Span;
use giveway_floor::warehouse::{Body, Findings, Footprint, Warehouse};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// The name of the kind if a scenario tells none apart, and of robots from before there were kinds.
pub const USUAL_KIND: &str = "robot";

/// What all robots of a kind have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotKind {
    /// The name of the kind.
    pub name: String,
    /// How the robots move, and how long they take to lift.
    pub kinematics: Kinematics,
    /// When the robots charge, and how long a charge lasts.
    pub charging: Charging,
    /// The robots' outlines without and with a rack; nothing for the square of the map.
    pub footprints: [Option<Footprint>; 2],
    /// The types of racks that the robots can carry; nothing for all.
    pub carries: Option<Vec<String>>,
    /// The heaviest rack that the robots can carry, kilograms.
    pub payload_kg: f64,
    /// Whether the robots may leave the line of a lane that has a corridor, to pass people.
    pub free_navigation: bool,
    /// What the robots can do besides driving to where they were granted to drive.
    pub capabilities: Capabilities,
}

/// What robots of a kind can do besides driving to where they were granted to drive. Simulated robots can do all of it;
/// few others can.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// Whether a robot that stands forgets what it was granted when told to, and says how often it has. Nothing is
    /// taken back from other robots.
    pub revocation: bool,
    /// Which speed limits a robot obeys within what it was granted.
    pub limits: ObeyedLimits,
    /// Whether a robot drives back from between two nodes to the one that it came from.
    pub drives_back: bool,
    /// How many visits that are not granted yet a robot's orders show it, so that it need not brake before it is told
    /// more.
    pub horizon_nodes: usize,
}

/// Which speed limits a robot obeys within what it was granted. The least obedient is the greatest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ObeyedLimits {
    /// Any speed, and a stop.
    Speeds,
    /// Only a stop: where others would be slow, the robot stands.
    Stops,
    /// None: the robot is granted one node at a time, and nothing towards a person for whom it would have to stop.
    Nothing,
}

impl Default for Capabilities {
    /// All capabilities, and no horizon.
    fn default() -> Capabilities {
        Capabilities { revocation: true, limits: ObeyedLimits::Speeds, drives_back: true, horizon_nodes: 0 }
    }
}

impl ObeyedLimits {
    /// All values.
    pub const ALL: [ObeyedLimits; 3] = [ObeyedLimits::Speeds, ObeyedLimits::Stops, ObeyedLimits::Nothing];

    /// The word in files and requests.
    pub fn word(self) -> &'static str {
        match self {
            ObeyedLimits::Speeds => "speed",
            ObeyedLimits::Stops => "stop",
            ObeyedLimits::Nothing => "none",
        }
    }

    /// The value that a word names.
    pub fn of_word(word: &str) -> Option<ObeyedLimits> {
        Self::ALL.into_iter().find(|limits| limits.word() == word)
    }
}

impl Default for RobotKind {
    fn default() -> RobotKind {
        RobotKind {
            name: USUAL_KIND.to_owned(),
            kinematics: Kinematics::default(),
            charging: Charging::default(),
            footprints: [None, None],
            carries: None,
            payload_kg: f64::INFINITY,
            free_navigation: false,
            capabilities: Capabilities::default(),
        }
    }
}

impl Eq for RobotKind {}

impl Hash for RobotKind {
    /// Hashes all figures as they are written out: each is read back as the same number.
    fn hash<H: Hasher>(&self, to: &mut H) {
        format!("{self:?}").hash(to);
    }
}

impl RobotKind {
    /// A kind of which only what the building knows is known, and how long holds outlast it: all else is as usual.
    pub fn of_body(body: &Body, clearance: Span) -> RobotKind {
        let Body { kind, footprints, carries, payload_kg } = body.clone();
        let kinematics = Kinematics { clearance, ..Kinematics::default() };
        RobotKind { name: kind, kinematics, footprints, carries, payload_kg, ..RobotKind::default() }
    }

    /// What the building must know of the kind.
    pub fn body(&self) -> Body {
        let (footprints, carries) = (self.footprints.clone(), self.carries.clone());
        Body { kind: self.name.clone(), footprints, carries, payload_kg: self.payload_kg }
    }
}

/// A building for robots of these kinds.
///
/// # Errors
/// Kinds for which the building was not drawn.
pub fn fitted(warehouse: &Arc<Warehouse>, kinds: &[RobotKind]) -> Result<Arc<Warehouse>, Findings> {
    let has_rules = warehouse.lanes.iter().any(|l| l.kinds.is_some());
    let bodies: Vec<Body> = kinds.iter().map(RobotKind::body).collect();
    if !has_rules && bodies.iter().eq(warehouse.bodies().iter()) {
        return Ok(warehouse.clone());
    }
    warehouse.for_bodies(bodies).map(Arc::new)
}

/// When robots of a kind charge, in shares of a full charge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charging {
    /// Below this charge a robot takes no job and charges before all others.
    pub critical: f64,
    /// Below this charge an idle robot charges before it takes a job, if a charger is free.
    pub low: f64,
    /// From this charge on a robot at a charger takes jobs, and leaves if another robot needs its charger.
    pub enough: f64,
    /// From this charge on an idle robot does not go to a charger.
    pub full: f64,
    /// Whether idle robots above `low` use chargers that are free.
    pub opportunity: bool,
    /// Hours of driving on a full charge.
    pub driving_h: f64,
}

impl Default for Charging {
    fn default() -> Charging {
        Charging { critical: 0.15, low: 0.3, enough: 0.5, full: 0.9, opportunity: true, driving_h: 8.0 }
    }
}

/// The figures of the robot among these that is worst for a person in its way: the fastest, with the weakest brakes.
/// Regions around people are computed for it, whichever robot comes.
pub fn most_dangerous(kinds: &[RobotKind]) -> Kinematics {
    let all = kinds.iter().map(|k| k.kinematics);
    let worse = |a: Kinematics, b: Kinematics| Kinematics {
        speed_mps: a.speed_mps.max(b.speed_mps),
        speed_loaded_mps: a.speed_loaded_mps.max(b.speed_loaded_mps),
        accel_unloaded_mps2: a.accel_unloaded_mps2.min(b.accel_unloaded_mps2),
        accel_loaded_mps2: a.accel_loaded_mps2.min(b.accel_loaded_mps2),
        turn_radps: a.turn_radps.min(b.turn_radps),
        lift: a.lift.max(b.lift),
        clearance: a.clearance.max(b.clearance),
        reaction: a.reaction.max(b.reaction),
    };
    all.reduce(worse).expect("a fleet has a kind of robots")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_dangerous_robot_is_the_fastest_with_the_weakest_brakes() {
        let fast = Kinematics { speed_mps: 2.0, accel_loaded_mps2: 1.0, ..Kinematics::default() };
        let heavy = Kinematics { speed_mps: 0.8, accel_loaded_mps2: 0.2, ..Kinematics::default() };
        let kinds = [fast, heavy].map(|kinematics| RobotKind { kinematics, ..RobotKind::default() });
        let worst = most_dangerous(&kinds);
        assert_eq!((worst.speed_mps, worst.accel_loaded_mps2), (2.0, 0.2));
        assert_eq!(most_dangerous(&kinds[..1]), fast, "of one kind it is that kind");
    }
}

//! What is seen of a person among objects, and features of the person relative to each object.
//!
//! Main types: [`ObjectTable`] (which published experiment), [`BodyFrame`], [`ObjectMove`] (the last three seconds of
//! one movement); main constant: [`FEATURES`], the eleven features of the thesis' Table 5.1: distances in metres from a
//! joint to the object, and lengths, from 0 to 2, of the difference between a joint's unit vector and that of the
//! direction from it to the object. Refuses: to name places, so that nothing can be learned about a room.

use giveway_people::reach::{ArmPoint, ArmVector};

/// Frames per second.
pub const HZ: f64 = 120.0;
/// Number of frames of each movement that count: the last three seconds.
pub const FRAMES: usize = 360;
/// Names of the features. The first three were selected in the thesis.
pub const FEATURES: [&str; 11] = [
    "hand_distance",
    "head_direction",
    "gaze",
    "head_distance",
    "hand_direction",
    "shoulders_distance",
    "pelvis_distance",
    "torso_distance",
    "shoulders_direction",
    "pelvis_direction",
    "torso_direction",
];

/// Indices of the features of Table 5.3: hand and head only.
pub const HAND_AND_HEAD: [usize; 4] = [0, 1, 3, 4];
/// Index of the distance from the hand.
pub const HAND: usize = 0;
/// Index of the direction of the head.
pub const HEAD: usize = 1;
/// Index of the direction of the eyes.
pub const GAZE: usize = 2;

/// A published experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ObjectTable {
    /// Table 5.2: ten objects on two shelves and a table, carried about (MoGaze).
    Shelves,
    /// Table 5.3: five objects that stay on three tables; only head and hand are seen (SubMotion).
    Tables,
}

impl ObjectTable {
    /// Both experiments.
    pub const ALL: [ObjectTable; 2] = [ObjectTable::Shelves, ObjectTable::Tables];

    /// The table's number in the thesis.
    pub fn word(self) -> &'static str {
        match self {
            ObjectTable::Shelves => "5.2",
            ObjectTable::Tables => "5.3",
        }
    }

    /// Number of objects in the room.
    pub fn objects(self) -> usize {
        match self {
            ObjectTable::Shelves => 10,
            ObjectTable::Tables => 5,
        }
    }

    /// Number of parts into which a person's movements are divided.
    pub fn folds(self) -> usize {
        match self {
            ObjectTable::Shelves => 5,
            ObjectTable::Tables => 3,
        }
    }
}

/// A person in one frame: positions in metres, directions as unit vectors, all in the room's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyFrame {
    /// Position of the right palm, and direction of the forearm.
    pub hand: (ArmPoint, ArmVector),
    /// Position of the head, and where it faces.
    pub head: (ArmPoint, ArmVector),
    /// Position between the shoulders, and where they face.
    pub shoulders: (ArmPoint, ArmVector),
    /// Position of the pelvis, and where it faces.
    pub pelvis: (ArmPoint, ArmVector),
    /// Position of the middle of the back, and where it faces.
    pub torso: (ArmPoint, ArmVector),
    /// Direction of the eyes.
    pub gaze: ArmVector,
}

/// The last [`FRAMES`] frames of a movement that ends with a hand at an object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectMove {
    /// Number of the person.
    pub person: usize,
    /// Frames in order of time.
    pub frames: Vec<BodyFrame>,
    /// Positions of the objects.
    pub objects: Vec<ArmPoint>,
    /// Index of the object that the hand goes to.
    pub right: usize,
    /// All [`FEATURES`] by frame, then by object.
    pub figures: Vec<f32>,
}

impl ObjectMove {
    /// Features of one object in one frame.
    pub fn figures_at(&self, frame: usize, object: usize) -> &[f32] {
        let at = (frame * self.objects.len() + object) * FEATURES.len();
        &self.figures[at..at + FEATURES.len()]
    }
}

/// All features of an object.
pub fn features(frame: &BodyFrame, object: ArmPoint) -> [f32; FEATURES.len()] {
    let far = |p: (ArmPoint, ArmVector)| (object - p.0).norm();
    let apart = |p: (ArmPoint, ArmVector)| {
        (p.1 - (object - p.0).try_normalize(1e-9).unwrap_or_else(ArmVector::x)).norm()
    };
    [
        far(frame.hand),
        apart(frame.head),
        apart((frame.head.0, frame.gaze)),
        far(frame.head),
        apart(frame.hand),
        far(frame.shoulders),
        far(frame.pelvis),
        far(frame.torso),
        apart(frame.shoulders),
        apart(frame.pelvis),
        apart(frame.torso),
    ]
    .map(|f| f as f32)
}

//! One observed pose of a worker, in the map's frame and in the server's time.
//!
//! Main types: [`Sighting`], [`SourceId`], [`Quality`]. Refuses: frames of devices and their clocks; the program that
//! receives poses aligns them first.

use giveway_floor::geometry::Point;
use giveway_floor::id::WorkerId;
use giveway_floor::time::Time;

/// How well a source knows its pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quality {
    /// Position and heading are measured.
    Tracked,
    /// The position is guessed by the device (last known place and a model of the neck): not for deciding where
    /// somebody goes.
    Emulated,
    /// The device says that it does not know where it is.
    Lost,
}

/// Which source of a worker's says so. A worker has one of each at most: a second headset continues what the first
/// said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum SourceId {
    /// A headset, a phone or a gateway with a connection of its own.
    #[default]
    Headset,
    /// A tag, whose positions somebody reports.
    Tag,
    /// A device that reports like a robot (MassRobotics).
    Interop,
}

impl SourceId {
    /// All of them: a worker has no more sources.
    pub const ALL: [SourceId; 3] = [SourceId::Headset, SourceId::Tag, SourceId::Interop];
}

/// A pose of a worker, as one source saw it. Sightings may be late, repeated, out of order or wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Who.
    pub worker: WorkerId,
    /// Which of the worker's sources says so.
    pub source: SourceId,
    /// When this was so, in the server's time.
    pub seen: Time,
    /// The alignment of the source's frame. Within one epoch a displacement is a movement; across epochs it
    /// is not.
    pub epoch: u32,
    /// Whether this epoch began with marks that were touched: only then is a place that nobody can have walked to
    /// believed at once.
    pub at_marks: bool,
    /// Number of the message within its epoch.
    pub seq: u64,
    /// Where, metres.
    pub at: Point,
    /// Where else, as long as nothing has shown on which side of a line the worker is: the marks of a headset lie on
    /// one line, and its frame may have an axis exchanged.
    pub mirror: Option<Point>,
    /// Where the head faces, radians; nothing for tags that know positions only.
    pub heading: Option<f64>,
    /// One standard deviation of the position, metres.
    pub accuracy_m: f64,
    /// How well the source knows.
    pub quality: Quality,
}

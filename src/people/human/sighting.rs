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
    /// The device guesses the position (last known place and a model of the neck): not to be used for deciding where a
    /// person goes.
    Emulated,
    /// The device reports that it is lost.
    Lost,
}

/// The source of a sighting. A worker has at most one of each: a second headset continues what the first reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum SourceId {
    /// A headset, a phone or a gateway with a connection of its own.
    #[default]
    Headset,
    /// A tag, whose positions another system reports.
    Tag,
    /// A device that reports like a robot (MassRobotics).
    Interop,
}

impl SourceId {
    /// All sources: a worker has no more.
    pub const ALL: [SourceId; 3] = [SourceId::Headset, SourceId::Tag, SourceId::Interop];
}

/// A pose of a worker, as one source saw it. Sightings may be late, repeated, out of order or wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// The worker.
    pub worker: WorkerId,
    /// The worker's source of this sighting.
    pub source: SourceId,
    /// When the pose was true, in the server's time.
    pub seen: Time,
    /// The alignment of the source's frame. Within one epoch a displacement is a movement; across epochs it is not.
    pub epoch: u32,
    /// Whether this epoch began with marks that were touched: only then is a place believed at once that the worker
    /// cannot have walked to.
    pub at_marks: bool,
    /// Number of the message within its epoch.
    pub seq: u64,
    /// Position, metres.
    pub at: Point,
    /// Alternative position, as long as it is unknown on which side of a line the worker is: the marks of a headset lie
    /// on one line, and its frame may be mirrored.
    pub mirror: Option<Point>,
    /// Direction of the head, radians; nothing for tags, which know positions only.
    pub heading: Option<f64>,
    /// Standard deviation of the position, metres.
    pub accuracy_m: f64,
    /// How well the source knows the pose.
    pub quality: Quality,
}

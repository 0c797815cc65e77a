//! What a robot reports as wrong with itself; each fault has one meaning and one reaction.
//!
//! Main type: [`Fault`]. A flat battery and a lost load are no faults of their own: the battery and the rack in the
//! telemetry say so. Refuses: to say in words how bad it is; those are in the API.

/// What keeps a robot from doing what it was told, by its own report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fault {
    /// The robot is broken. It stands until a person repairs it; others take over what they can and go round it.
    Broken,
    /// The robot's emergency stop is pressed. It is treated like a broken robot until the stop is released, then goes
    /// on.
    EmergencyStop,
    /// A person drives the robot: it obeys no orders and has forgotten its way. It keeps what it was granted, the floor
    /// at its true place is closed, and it is taken up where it stands when the person is done.
    Manual,
    /// Something that the robot cannot pass stands on its way to the next node. The robot goes back, and that node is
    /// closed for a while.
    Obstructed,
    /// The robot stands at a charger and gets no current. For a while no robot is sent to that charger; this one
    /// leaves.
    Unplugged,
}

impl Fault {
    /// All faults.
    pub const ALL: [Fault; 5] =
        [Fault::Broken, Fault::EmergencyStop, Fault::Manual, Fault::Obstructed, Fault::Unplugged];

    /// The fault's name for machines: on the wire and in recordings.
    pub fn word(self) -> &'static str {
        match self {
            Fault::Broken => "broken",
            Fault::EmergencyStop => "emergency_stop",
            Fault::Manual => "manual",
            Fault::Obstructed => "obstructed",
            Fault::Unplugged => "unplugged",
        }
    }

    /// The fault of this name.
    pub fn of_word(word: &str) -> Option<Fault> {
        Fault::ALL.into_iter().find(|fault| fault.word() == word)
    }

    /// Whether a robot with this fault obeys no order to drive until a person helps.
    pub fn is_immobile(self) -> bool {
        matches!(self, Fault::Broken | Fault::EmergencyStop | Fault::Manual)
    }
}

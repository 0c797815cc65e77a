//! What a robot says is wrong with it, each with one meaning and one reaction.
//!
//! Main type: [`Fault`]. A battery that is flat and a load that is lost are no faults of their own: the battery and the
//! rack in the telemetry say so. Refuses: to say how bad it is in words; those are in the API.

/// What keeps a robot from doing what it was told, by its own word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fault {
    /// It is broken. It stands until a person repairs it; others take over what they can and go round it.
    Broken,
    /// Its emergency stop is pressed. It is treated like a broken robot until the stop is released, and goes on then.
    EmergencyStop,
    /// A person drives it: it obeys no orders and has forgotten its way. What was granted to it stays its own, the
    /// floor where it truly is is closed, and it is taken up where it stands when that is over.
    Manual,
    /// Something that it cannot pass stands on its way to the next node. It goes back, and that node is closed for
    /// a while.
    Obstructed,
    /// It stands at a charger and gets no current. No robot is sent to that charger for a while, and this one leaves.
    Unplugged,
}

impl Fault {
    /// All of them.
    pub const ALL: [Fault; 5] =
        [Fault::Broken, Fault::EmergencyStop, Fault::Manual, Fault::Obstructed, Fault::Unplugged];

    /// Its name for machines: on the wire and in recordings.
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

    /// Whether a robot with it obeys no order to drive until a person helps.
    pub fn is_immobile(self) -> bool {
        matches!(self, Fault::Broken | Fault::EmergencyStop | Fault::Manual)
    }
}

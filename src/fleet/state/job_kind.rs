//! What customers may ask of the fleet: the one list of job kinds.
//!
//! Main types: [`JobKind`], [`JobWord`] (a kind without what the job is about), [`JobParts`] (what it is about, without
//! the kind). Code that reads or writes jobs (records, recordings, columns, the API) goes by the parts, so that it does
//! not have to know the kinds. Refuses: to know how a job is carried out.

use giveway_floor::id::{BodyId, Dense, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::Span;
use giveway_floor::warehouse::{NodeKind, Warehouse};

/// Makes the types from the list of kinds: for each kind its word, what a job of this kind is about and, after a
/// semicolon, what may be left out.
macro_rules! job_kinds {
    ($(
        $(#[$doc:meta])*
        $kind:ident $word:literal ($($field:ident)+ $(; $left:ident)?) {
            $($(#[$of:meta])* $needed:ident: $type:ty,)+
            $(? $(#[$opt_of:meta])* $optional:ident: $opt_type:ty,)?
        }
    )+) => {
        /// What is wanted.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum JobKind {
            $(
                $(#[$doc])*
                $kind {
                    $($(#[$of])* $needed: $type,)+
                    $($(#[$opt_of])* $optional: Option<$opt_type>,)?
                },
            )+
        }

        /// A job kind by its word.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum JobWord {
            $($(#[$doc])* $kind,)+
        }

        impl JobWord {
            /// All kinds.
            pub const ALL: &[JobWord] = &[$(JobWord::$kind),+];
            /// The words of all kinds, in the same order.
            pub const WORDS: &[&str] = &[$($word),+];

            /// The word on the wire.
            pub fn word(self) -> &'static str {
                match self {
                    $(JobWord::$kind => $word,)+
                }
            }

            /// What a job of this kind is about; what may be left out comes last.
            pub fn fields(self) -> &'static [JobField] {
                match self {
                    $(JobWord::$kind => &[$(JobField::$field,)+ $(JobField::$left,)?],)+
                }
            }

            /// A job of this kind from its parts; parts that this kind does not have are ignored.
            ///
            /// # Errors
            /// The first missing part that this kind needs.
            pub fn with(self, parts: JobParts) -> Result<JobKind, JobField> {
                Ok(match self {
                    $(JobWord::$kind => JobKind::$kind {
                        $($needed: parts.$needed.ok_or(JobField::$field)?,)+
                        $($optional: parts.$optional,)?
                    },)+
                })
            }
        }

        impl JobKind {
            /// The kind of the job.
            pub fn name(&self) -> JobWord {
                match self {
                    $(JobKind::$kind { .. } => JobWord::$kind,)+
                }
            }

            /// What the job is about.
            pub fn parts(&self) -> JobParts {
                match *self {
                    $(JobKind::$kind { $($needed,)+ $($optional,)? } => JobParts {
                        $($needed: Some($needed),)+
                        $($optional,)?
                        ..JobParts::default()
                    },)+
                }
            }
        }
    };
}

job_kinds! {
    /// Bring a rack to a station, let a person pick from it, and put it back somewhere sensible.
    Deliver "deliver" (Rack Station; Pick) {
        /// The rack.
        rack: RackId,
        /// The station.
        station: StationId,
        ?
        /// How long the pick takes; the station's usual time where absent.
        pick: Span,
    }
    /// Put a rack onto the best free storage node.
    Return "return" (Rack) {
        /// The rack.
        rack: RackId,
    }
    /// Put a rack onto this storage node.
    Relocate "relocate" (Rack Node) {
        /// The rack.
        rack: RackId,
        /// The storage node.
        node: NodeId,
    }
    /// Send a robot to a free charger.
    Charge "charge" (Robot) {
        /// The robot.
        robot: RobotId,
    }
    /// Send a robot to a free parking place.
    Park "park" (Robot) {
        /// The robot.
        robot: RobotId,
    }
    /// Send a robot to a node and, if it may not stay there, on to a place where it may.
    Go "go" (Robot Node) {
        /// The robot.
        robot: RobotId,
        /// The node.
        node: NodeId,
    }
}

/// Something that a job may be about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum JobField {
    /// The rack that has to be moved.
    Rack,
    /// The station at which the rack is wanted.
    Station,
    /// The node to which the rack, or the robot, goes.
    Node,
    /// The robot that has to do the job.
    Robot,
    /// How long the pick takes.
    Pick,
}

impl JobField {
    /// All fields.
    pub const ALL: [JobField; 5] =
        [JobField::Rack, JobField::Station, JobField::Node, JobField::Robot, JobField::Pick];

    /// The field's word in records.
    pub fn word(self) -> &'static str {
        match self {
            JobField::Rack => "rack",
            JobField::Station => "station",
            JobField::Node => "node",
            JobField::Robot => "robot",
            JobField::Pick => "pick",
        }
    }

    /// The field of this word.
    pub fn of_word(word: &str) -> Option<JobField> {
        JobField::ALL.into_iter().find(|field| field.word() == word)
    }
}

/// What a job is about, whatever its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JobParts {
    /// The rack that has to be moved.
    pub rack: Option<RackId>,
    /// The station at which the rack is wanted.
    pub station: Option<StationId>,
    /// The node to which the rack, or the robot, goes.
    pub node: Option<NodeId>,
    /// The robot that has to do the job.
    pub robot: Option<RobotId>,
    /// How long the pick takes.
    pub pick: Option<Span>,
}

impl JobParts {
    /// A part as a number: an id, or microseconds.
    pub fn number(&self, field: JobField) -> Option<i64> {
        match field {
            JobField::Rack => self.rack.map(|rack| rack.0.into()),
            JobField::Station => self.station.map(|station| station.0.into()),
            JobField::Node => self.node.map(|node| node.0.into()),
            JobField::Robot => self.robot.map(|robot| robot.0.into()),
            JobField::Pick => self.pick.map(|pick| pick.0),
        }
    }

    /// The parts with this one set from its number; the part is empty if the number is no id.
    #[must_use]
    pub fn with_number(mut self, field: JobField, number: i64) -> JobParts {
        let id = u32::try_from(number).ok();
        match field {
            JobField::Rack => self.rack = id.map(RackId),
            JobField::Station => self.station = id.map(StationId),
            JobField::Node => self.node = id.map(NodeId),
            JobField::Robot => self.robot = id.map(RobotId),
            JobField::Pick => self.pick = Some(Span(number)),
        }
        self
    }
}

impl JobWord {
    /// The kind of this word.
    pub fn of_word(word: &str) -> Option<JobWord> {
        JobWord::ALL.iter().copied().find(|kind| kind.word() == word)
    }
}

/// Where a robot is sent without a rack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotErrand {
    /// To a free charger.
    Charge,
    /// To a free parking place.
    Park,
    /// To a node.
    Go(NodeId),
}

impl JobKind {
    /// The rack that has to be moved, if any.
    pub fn rack(&self) -> Option<RackId> {
        self.parts().rack
    }

    /// The station that the rack is wanted at, if any.
    pub fn station(&self) -> Option<StationId> {
        self.parts().station
    }

    /// The robot that has to do the job, if the customer named one.
    pub fn robot(&self) -> Option<RobotId> {
        self.parts().robot
    }

    /// The kind's word on the wire.
    pub fn word(&self) -> &'static str {
        self.name().word()
    }

    /// Where the robot that the job names is sent; nothing if a rack has to be moved.
    pub fn errand(&self) -> Option<RobotErrand> {
        match *self {
            JobKind::Charge { .. } => Some(RobotErrand::Charge),
            JobKind::Park { .. } => Some(RobotErrand::Park),
            JobKind::Go { node, .. } => Some(RobotErrand::Go(node)),
            JobKind::Deliver { .. } | JobKind::Return { .. } | JobKind::Relocate { .. } => None,
        }
    }

    /// The kind of place that the robot is to find by itself, if any.
    pub fn place(&self) -> Option<NodeKind> {
        match self.errand()? {
            RobotErrand::Charge => Some(NodeKind::Charger),
            RobotErrand::Park => Some(NodeKind::Parking),
            RobotErrand::Go(_) => None,
        }
    }

    /// The node to which the job leads, where it names one or a station.
    pub fn goal(&self, w: &Warehouse) -> Option<NodeId> {
        let JobParts { station, node, .. } = self.parts();
        station.map(|station| w.stations[station].node).or(node)
    }

    /// Whether the map has everything that the job names, and the robot that it names has joined.
    pub fn is_known(&self, w: &Warehouse, robots: usize) -> bool {
        let JobParts { rack, station, node, robot, pick: _ } = self.parts();
        rack.is_none_or(|r| r.ix() < w.racks.len())
            && station.is_none_or(|s| s.ix() < w.stations.len())
            && node.is_none_or(|n| n.ix() < w.nodes.len())
            && robot.is_none_or(|r| r.ix() < robots)
    }

    /// Whether robots of a kind can do the job with its rack on a node: carry the rack, and drive to the node and to
    /// where the rack is wanted.
    pub fn is_for(&self, w: &Warehouse, body: BodyId, (rack, node): (RackId, NodeId)) -> bool {
        let goal = self.goal(w).unwrap_or(node);
        w.can_carry(body, rack) && w.may_be_at(body, node) && w.may_be_at(body, goal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_made_anew_from_its_word_and_its_parts() {
        for word in JobWord::ALL {
            let all = JobField::ALL.into_iter().fold(JobParts::default(), |parts, f| parts.with_number(f, 7));
            let kind = word.with(all).unwrap();
            assert_eq!((kind.name(), JobWord::of_word(kind.word())), (*word, Some(*word)));
            let own = word.fields().iter().fold(JobParts::default(), |parts, f| parts.with_number(*f, 7));
            assert_eq!(
                (kind.parts(), word.with(own)),
                (own, Ok(kind)),
                "a job has the parts of its kind alone"
            );
        }
    }

    #[test]
    fn a_job_without_a_part_that_it_needs_is_none() {
        for word in JobWord::ALL {
            assert_eq!(word.with(JobParts::default()), Err(word.fields()[0]));
        }
        let parts = JobParts { rack: Some(RackId(1)), station: Some(StationId(2)), ..JobParts::default() };
        let deliver = JobKind::Deliver { rack: RackId(1), station: StationId(2), pick: None };
        assert_eq!(JobWord::Deliver.with(parts), Ok(deliver), "the pick may be left out");
    }
}

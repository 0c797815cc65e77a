//! What happened to a robot, as lists have it: its jobs, alarms about it, and what the facts say of it alone.
//!
//! Main types: [`RobotChange`], [`RobotEventRow`], [`RobotEventQuery`]. Refuses: to know where they are kept.

use crate::state::fact::{Fact, FloorFact, RobotFact};
use crate::state::note::EventDetails;
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;

/// What a fact says of a robot alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotChange {
    /// It joined.
    Joined,
    /// It cannot drive.
    Failed,
    /// It works again.
    Repaired,
    /// What is promised about it contradicts itself.
    Fenced,
    /// It was paused by hand.
    Paused,
    /// It was resumed.
    Resumed,
    /// The whole fleet was stopped.
    FleetStopped,
    /// The whole fleet was resumed.
    FleetResumed,
    /// It was sent to maintenance.
    OutOfService,
    /// Its maintenance ended, or it is to stay on the floor.
    BackInService,
    /// It is to leave the floor.
    Leaving,
    /// It has left the floor.
    Left,
    /// It came back.
    Returned,
}

impl RobotChange {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            RobotChange::Joined => "joined",
            RobotChange::Failed => "failed",
            RobotChange::Repaired => "repaired",
            RobotChange::Fenced => "fenced",
            RobotChange::Paused => "paused",
            RobotChange::Resumed => "resumed",
            RobotChange::FleetStopped => "fleet_stopped",
            RobotChange::FleetResumed => "fleet_resumed",
            RobotChange::OutOfService => "out_of_service",
            RobotChange::BackInService => "back_in_service",
            RobotChange::Leaving => "leaving",
            RobotChange::Left => "left",
            RobotChange::Returned => "returned",
        }
    }
}

/// What a fact says of a robot alone, or of all of them, if it does.
pub fn robot_change(fact: &Fact) -> Option<(Option<RobotId>, RobotChange)> {
    let (robot, change) = match fact {
        Fact::Robot(RobotFact::Registered { robot, .. }) => (robot, RobotChange::Joined),
        Fact::Robot(RobotFact::Failed { robot, .. }) => (robot, RobotChange::Failed),
        Fact::Robot(RobotFact::Repaired { robot, .. }) => (robot, RobotChange::Repaired),
        Fact::Robot(RobotFact::Fenced { robot, .. }) => (robot, RobotChange::Fenced),
        Fact::Floor(FloorFact::Halted { robot: Some(robot), .. }) => (robot, RobotChange::Paused),
        Fact::Floor(FloorFact::Released { robot: Some(robot), .. }) => (robot, RobotChange::Resumed),
        Fact::Floor(FloorFact::Halted { robot: None, .. }) => return Some((None, RobotChange::FleetStopped)),
        Fact::Floor(FloorFact::Released { robot: None, .. }) => {
            return Some((None, RobotChange::FleetResumed));
        }
        Fact::Robot(RobotFact::Maintenance { robot, since: Some(_) }) => (robot, RobotChange::OutOfService),
        Fact::Robot(RobotFact::Maintenance { robot, since: None }) => (robot, RobotChange::BackInService),
        Fact::Robot(RobotFact::Retired { robot, .. }) => (robot, RobotChange::Leaving),
        Fact::Robot(RobotFact::Left { robot, .. }) => (robot, RobotChange::Left),
        Fact::Robot(RobotFact::Returned { robot, .. }) => (robot, RobotChange::Returned),
        _ => return None,
    };
    Some((Some(*robot), change))
}

/// From which list an entry is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RobotEventSource {
    /// A job that the robot has, or had last.
    Job,
    /// An alarm about it.
    Alarm,
    /// A [`RobotChange`].
    Change,
    /// It got another way.
    Replan,
}

impl RobotEventSource {
    /// Its place among entries of the same time.
    pub fn number(self) -> i64 {
        match self {
            RobotEventSource::Job => 1,
            RobotEventSource::Alarm => 2,
            RobotEventSource::Change => 3,
            RobotEventSource::Replan => 4,
        }
    }

    /// The one of this number.
    pub fn of_number(number: i64) -> Option<RobotEventSource> {
        use RobotEventSource::{Alarm, Change, Job, Replan};
        [Job, Alarm, Change, Replan].into_iter().find(|source| source.number() == number)
    }
}

/// Something that happened to a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotEventRow {
    /// When: of a job, when its state changed last; of an alarm, when it was raised.
    pub at: Time,
    /// From which list it is.
    pub source: RobotEventSource,
    /// Its number there.
    pub id: i64,
    /// The state of the job, the kind of the alarm, the change, or because of what it was replanned.
    pub word: String,
    /// The kind of the job, or the text of the alarm.
    pub text: Option<String>,
    /// When the alarm ended.
    pub ended: Option<Time>,
    /// Of a replan, because of whom or what, and both ways.
    pub details: Option<EventDetails>,
}

/// What to list of a robot, newest first.
#[derive(Clone, Debug)]
pub struct RobotEventQuery {
    /// Which robot.
    pub robot: RobotId,
    /// Its name, by which alarms know it.
    pub name: String,
    /// Only what happened at this time or later.
    pub from: Option<Time>,
    /// Only what happened before this time.
    pub to: Option<Time>,
    /// Only what comes after this entry in the list.
    pub before: Option<(Time, RobotEventSource, i64)>,
    /// How many at most.
    pub limit: u32,
}

/// What became of the jobs of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct RobotJobCounts {
    /// Done.
    pub done: u64,
    /// Could not be done.
    pub failed: u64,
}

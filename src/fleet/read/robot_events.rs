//! What happened to a robot, as lists show it: its jobs, alarms about it, and facts about it alone.
//!
//! Main types: [`RobotChange`], [`RobotEventRow`], [`RobotEventQuery`]. Refuses: to know where they are stored.

use crate::state::fact::{Fact, FloorFact, RobotFact};
use crate::state::note::EventDetails;
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;

/// What a fact says about a robot alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotChange {
    /// The robot joined.
    Joined,
    /// The robot cannot drive.
    Failed,
    /// The robot works again.
    Repaired,
    /// What is promised about the robot contradicts itself.
    Fenced,
    /// The robot was paused by hand.
    Paused,
    /// The robot was resumed.
    Resumed,
    /// The whole fleet was stopped.
    FleetStopped,
    /// The whole fleet was resumed.
    FleetResumed,
    /// The robot was sent to maintenance.
    OutOfService,
    /// The robot's maintenance ended, or it is to stay on the floor.
    BackInService,
    /// The robot is to leave the floor.
    Leaving,
    /// The robot has left the floor.
    Left,
    /// The robot came back.
    Returned,
}

impl RobotChange {
    /// The word for the change.
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

/// What a fact says about a robot alone, or about all robots, if anything.
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

/// The list that an entry is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RobotEventSource {
    /// A job that the robot has, or had last.
    Job,
    /// An alarm about the robot.
    Alarm,
    /// A [`RobotChange`].
    Change,
    /// A replan: the robot got another route.
    Replan,
}

impl RobotEventSource {
    /// The order of the lists among entries of the same time.
    pub fn number(self) -> i64 {
        match self {
            RobotEventSource::Job => 1,
            RobotEventSource::Alarm => 2,
            RobotEventSource::Change => 3,
            RobotEventSource::Replan => 4,
        }
    }

    /// The list with this number.
    pub fn of_number(number: i64) -> Option<RobotEventSource> {
        use RobotEventSource::{Alarm, Change, Job, Replan};
        [Job, Alarm, Change, Replan].into_iter().find(|source| source.number() == number)
    }
}

/// Something that happened to a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotEventRow {
    /// When it happened: of a job, when its state last changed; of an alarm, when it was raised.
    pub at: Time,
    /// The list that the entry is from.
    pub source: RobotEventSource,
    /// The number of the entry in that list.
    pub id: i64,
    /// The state of the job, the kind of the alarm, the change, or the cause of the replan, in a word.
    pub word: String,
    /// The kind of the job, or the text of the alarm.
    pub text: Option<String>,
    /// When the alarm ended.
    pub ended: Option<Time>,
    /// The cause of a replan, and both routes.
    pub details: Option<EventDetails>,
}

/// Which entries of a robot to list, newest first.
#[derive(Clone, Debug)]
pub struct RobotEventQuery {
    /// The robot.
    pub robot: RobotId,
    /// The robot's name, by which alarms know it.
    pub name: String,
    /// Only what happened at this time or later.
    pub from: Option<Time>,
    /// Only what happened before this time.
    pub to: Option<Time>,
    /// Only what comes after this entry in the list.
    pub before: Option<(Time, RobotEventSource, i64)>,
    /// How many entries at most.
    pub limit: u32,
}

/// What became of the jobs of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct RobotJobCounts {
    /// Jobs done.
    pub done: u64,
    /// Jobs that could not be done.
    pub failed: u64,
}

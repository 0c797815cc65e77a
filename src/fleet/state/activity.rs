//! What a robot is doing, in one word, and since when. Lists, feeds, metrics and pages all show this word, and none of
//! them works it out again.
//!
//! Main types: [`Activity`], `Activities`; [`Doing`] says what a robot does for its task, whether it makes progress or
//! not. Refuses: to be an input of any decision.

use crate::state::fact::{Act, Purpose, Task};
use crate::state::floor::Floor;
use crate::state::why::Why;
use giveway_floor::id::{IdVec, RobotId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;

/// What a robot is doing, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Activity {
    /// The robot has nothing to do.
    Idle,
    /// The robot is on its way.
    Driving,
    /// The robot stands on its way: another robot, a person, a closed area, a full queue, or the time of its
    /// reservation holds it up, or it has no route yet.
    Waiting,
    /// The robot lifts a rack or sets it down.
    Handling,
    /// The robot is in the queue of a station.
    Queueing,
    /// The robot is at a station.
    Picking,
    /// The robot is at a charger.
    Charging,
    /// The robot was paused by hand.
    Paused,
    /// The robot was stopped with the whole fleet, or because the building is evacuated.
    Stopped,
    /// The robot rests in maintenance, or before it leaves the floor.
    OutOfService,
    /// The robot cannot drive until a person helps.
    Failed,
    /// The robot has not been heard of.
    Offline,
    /// The robot has left the floor.
    Gone,
}

impl Activity {
    /// All activities.
    pub const ALL: [Activity; 13] = [
        Activity::Idle,
        Activity::Driving,
        Activity::Waiting,
        Activity::Handling,
        Activity::Queueing,
        Activity::Picking,
        Activity::Charging,
        Activity::Paused,
        Activity::Stopped,
        Activity::OutOfService,
        Activity::Failed,
        Activity::Offline,
        Activity::Gone,
    ];

    /// The activity's word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            Activity::Idle => "idle",
            Activity::Driving => "driving",
            Activity::Waiting => "waiting",
            Activity::Handling => "handling",
            Activity::Queueing => "queueing",
            Activity::Picking => "picking",
            Activity::Charging => "charging",
            Activity::Paused => "paused",
            Activity::Stopped => "stopped",
            Activity::OutOfService => "out_of_service",
            Activity::Failed => "failed",
            Activity::Offline => "offline",
            Activity::Gone => "gone",
        }
    }

    /// The activity of this word.
    pub fn of_word(word: &str) -> Option<Activity> {
        Activity::ALL.into_iter().find(|activity| activity.word() == word)
    }

    /// The activity that a reason alone implies, if it concerns the robot itself, whatever the robot was doing.
    fn of_reason(why: Why) -> Option<Activity> {
        match why {
            Why::Gone => Some(Activity::Gone),
            Why::Paused => Some(Activity::Paused),
            Why::Failed | Why::EmergencyStop | Why::Manual | Why::Displaced(_) => Some(Activity::Failed),
            Why::Silent | Why::Refused => Some(Activity::Offline),
            Why::Stopped | Why::Evacuation => Some(Activity::Stopped),
            Why::Maintenance | Why::Leaving => Some(Activity::OutOfService),
            Why::WaitsFor(..)
            | Why::GivesWay(_)
            | Why::Closed(_)
            | Why::QueueFull(_)
            | Why::NotItsTurn(..)
            | Why::StationPaused(_)
            | Why::NoRoute
            | Why::HandInOpening(_)
            | Why::Obstructed(_)
            | Why::Unplugged
            | Why::BlockedBy(_)
            | Why::WayObstructed(_) => None,
        }
    }
}

/// What a robot does for its task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Doing {
    /// Nothing.
    Idle,
    /// Driving to a rack.
    ToRack,
    /// Lifting the rack.
    Lifting,
    /// Carrying the rack to a station.
    Carrying,
    /// In the queue of a station.
    Queueing,
    /// At the station, under the rack that is picked from.
    Picking,
    /// Bringing the rack to storage.
    Returning,
    /// Setting the rack down.
    SettingDown,
    /// Driving to a charger.
    ToCharger,
    /// Charging.
    Charging,
    /// Driving to a parking place.
    Parking,
    /// Driving to where a customer sent it.
    Going,
    /// Broken.
    Failed,
}

/// What each robot is doing, and since when.
#[derive(Clone, Debug, Default)]
pub struct Activities {
    robots: IdVec<RobotId, Option<(Activity, Time)>>,
}

impl Activities {
    /// Notes what a robot is doing now.
    pub fn note(&mut self, robot: RobotId, activity: Activity, now: Time) {
        while self.robots.get(robot).is_none() {
            self.robots.push(None);
        }
        let before = self.robots[robot].filter(|(last, _)| *last == activity);
        self.robots[robot] = Some(before.unwrap_or((activity, now)));
    }

    /// What a robot was doing in the last step, and since when; nothing before the first step.
    pub fn of(&self, robot: RobotId) -> Option<(Activity, Time)> {
        self.robots.get(robot).copied().flatten()
    }
}

impl Floor<'_> {
    /// What a robot does for its task.
    pub fn doing(&self, r: RobotId) -> Doing {
        let record = &self.ledger.robots[r];
        let chain = self.ledger.chain(r);
        let at_stop = record.stops.first().filter(|s| s.serial == chain.first()).map(|s| s.act);
        let queueing = || matches!(self.warehouse().nodes[self.ledger.node_of(r)].kind, NodeKind::Queue(_));
        match (record.task, at_stop) {
            _ if record.failed => Doing::Failed,
            (Task::Fetch { .. }, Some(Act::Lift(_))) => Doing::Lifting,
            (Task::Fetch { .. }, _) => Doing::ToRack,
            (Task::Deliver { .. }, Some(Act::Pick(_))) => Doing::Picking,
            (Task::Deliver { .. }, _) if queueing() => Doing::Queueing,
            (Task::Deliver { .. }, _) => Doing::Carrying,
            (Task::Store { .. }, Some(Act::Set(_))) => Doing::SettingDown,
            (Task::Store { .. }, _) => Doing::Returning,
            (Task::Move { purpose: Purpose::Charge, .. }, _) => Doing::ToCharger,
            (Task::Move { purpose: Purpose::Park, .. }, _) => Doing::Parking,
            (Task::Move { purpose: Purpose::Go, .. }, _) => Doing::Going,
            (Task::Idle, _) if self.at_charger(r) => Doing::Charging,
            (Task::Idle, _) => Doing::Idle,
        }
    }

    /// What a robot is doing, given why it does not go on; nothing if it goes on.
    pub fn activity(&self, robot: RobotId, why: Option<Why>) -> Activity {
        if self.ledger.robots[robot].is_gone() {
            return Activity::Gone;
        }
        if let Some(activity) = why.and_then(Activity::of_reason) {
            return activity;
        }
        match self.doing(robot) {
            Doing::Failed => Activity::Failed,
            Doing::Lifting | Doing::SettingDown => Activity::Handling,
            Doing::Picking => Activity::Picking,
            Doing::Queueing => Activity::Queueing,
            Doing::Charging => Activity::Charging,
            Doing::Idle => Activity::Idle,
            Doing::ToRack
            | Doing::Carrying
            | Doing::Returning
            | Doing::ToCharger
            | Doing::Parking
            | Doing::Going => {
                let chain = self.ledger.chain(robot);
                let may_drive = chain.granted() > chain.first() + 1;
                let stands = self.scene.robot(robot).is_none_or(|t| t.stands());
                // A robot that may drive and stands for no reason is about to set off.
                let waits = stands && (why.is_some() || !may_drive);
                if waits { Activity::Waiting } else { Activity::Driving }
            }
        }
    }
}

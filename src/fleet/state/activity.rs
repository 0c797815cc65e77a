//! What a robot is at, in one word, and since when. Lists, feeds, metrics and pages all show this word, and none of
//! them finds it out again.
//!
//! Main types: [`Activity`], `Activities`; [`Doing`] says what a robot does for its task, whether it gets on or not.
//! Refuses: to be an input of any decision.

use crate::state::fact::{Act, Purpose, Task};
use crate::state::floor::Floor;
use crate::state::why::Why;
use giveway_floor::id::{IdVec, RobotId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;

/// What a robot is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Activity {
    /// Nothing to do.
    Idle,
    /// On its way.
    Driving,
    /// Standing on its way: another robot, a person, a closed area, a full queue, or the time of its reservation keeps
    /// it, or it has no route yet.
    Waiting,
    /// Lifting a rack or setting it down.
    Handling,
    /// In the queue of a station.
    Queueing,
    /// At a station.
    Picking,
    /// At a charger.
    Charging,
    /// Paused by hand.
    Paused,
    /// Stopped with the whole fleet, or because the building is evacuated.
    Stopped,
    /// Resting in maintenance, or before it leaves the floor.
    OutOfService,
    /// It cannot drive until a person helps.
    Failed,
    /// It has not been heard of.
    Offline,
    /// It has left the floor.
    Gone,
}

impl Activity {
    /// All of them.
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

    /// The word for it on the wire.
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

    /// What a reason alone says that concerns the robot itself, whatever it was doing.
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
    /// Lifting it.
    Lifting,
    /// Carrying it to a station.
    Carrying,
    /// In the queue of a station.
    Queueing,
    /// At the station.
    Picking,
    /// Bringing the rack to storage.
    Returning,
    /// Setting it down.
    SettingDown,
    /// Driving to a charger.
    ToCharger,
    /// Charging.
    Charging,
    /// Driving to a parking place.
    Parking,
    /// Driving where it was sent.
    Going,
    /// Broken.
    Failed,
}

/// What each robot is at, and since when.
#[derive(Clone, Debug, Default)]
pub struct Activities {
    robots: IdVec<RobotId, Option<(Activity, Time)>>,
}

impl Activities {
    /// Notes what a robot is at now.
    pub fn note(&mut self, robot: RobotId, activity: Activity, now: Time) {
        while self.robots.get(robot).is_none() {
            self.robots.push(None);
        }
        let before = self.robots[robot].filter(|(last, _)| *last == activity);
        self.robots[robot] = Some(before.unwrap_or((activity, now)));
    }

    /// What a robot was at in the last step, and since when; nothing before the first step.
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

    /// What a robot is at that does not go on for this reason, or goes on.
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
                // One that may drive and stands for no reason is about to set off.
                let waits = stands && (why.is_some() || !may_drive);
                if waits { Activity::Waiting } else { Activity::Driving }
            }
        }
    }
}

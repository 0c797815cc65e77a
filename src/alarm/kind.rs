//! The kinds of alarms: their words, how bad each is, how long a cause must last, and what to do about it.
//!
//! Main types: [`AlarmKind`], [`AlarmSeverity`], [`AlarmScope`]. Refuses: to look at the fleet.

use crate::time::Span;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AlarmSeverity {
    /// Somebody wanted it so, and should not forget it.
    Notice,
    /// Somebody should look soon; the floor goes on.
    Warning,
    /// Somebody has to act now: work stands still, or nothing can be promised.
    Critical,
}

impl AlarmSeverity {
    /// All of them, the least first.
    pub const ALL: [AlarmSeverity; 3] =
        [AlarmSeverity::Notice, AlarmSeverity::Warning, AlarmSeverity::Critical];

    /// The word for it on the wire.
    pub fn word(self) -> &'static str {
        match self {
            AlarmSeverity::Notice => "notice",
            AlarmSeverity::Warning => "warning",
            AlarmSeverity::Critical => "critical",
        }
    }

    /// The severity of this word.
    pub fn of_word(word: &str) -> Option<AlarmSeverity> {
        AlarmSeverity::ALL.into_iter().find(|s| s.word() == word)
    }
}

/// What finds out whether a cause is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlarmScope {
    /// What operators asked for: read off every view.
    Operator,
    /// Regular looks at the whole fleet and the control loop. A look that does not find a cause again ends it.
    Watch,
    /// Parts of the server, which say themselves when a cause begins and ends.
    Server,
}

macro_rules! kinds {
    ($(
        $(#[$doc:meta])*
        $name:ident: $word:literal, $severity:ident, $scope:ident, $raise:literal, $clear:literal;
    )*) => {
        /// What an alarm is about.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum AlarmKind {
            $($(#[$doc])* $name,)*
        }

        impl AlarmKind {
            /// All of them.
            pub const ALL: [AlarmKind; [$(AlarmKind::$name),*].len()] = [$(AlarmKind::$name),*];

            /// The word for it on the wire.
            pub fn word(self) -> &'static str {
                match self { $(AlarmKind::$name => $word,)* }
            }

            /// How bad it is, as long as nothing makes it worse.
            pub fn severity(self) -> AlarmSeverity {
                match self { $(AlarmKind::$name => AlarmSeverity::$severity,)* }
            }

            /// What finds out about it.
            pub fn scope(self) -> AlarmScope {
                match self { $(AlarmKind::$name => AlarmScope::$scope,)* }
            }

            /// A cause that lasts for less raises no alarm.
            pub fn raised_after(self) -> Span {
                match self { $(AlarmKind::$name => Span::from_secs($raise),)* }
            }

            /// A cause that is gone for less has not ended.
            pub fn cleared_after(self) -> Span {
                match self { $(AlarmKind::$name => Span::from_secs($clear),)* }
            }
        }
    };
}

kinds! {
    /// A robot says that it is broken, or was found to be.
    RobotFailed: "robot_failed", Warning, Watch, 1, 3;
    /// A robot's emergency stop is pressed.
    EmergencyStop: "emergency_stop", Warning, Watch, 1, 2;
    /// A robot has not been heard of.
    RobotSilent: "robot_silent", Warning, Watch, 4, 3;
    /// A robot stands where nothing is held for it, or does not carry what it should.
    RobotDisplaced: "robot_displaced", Warning, Watch, 4, 3;
    /// Something that a robot cannot pass stands on its way.
    RobotObstructed: "robot_obstructed", Warning, Watch, 20, 10;
    /// A robot stands at a charger and gets no current.
    RobotUnplugged: "robot_unplugged", Warning, Watch, 3, 5;
    /// A robot is low on charge, and no charger is free for it.
    RobotLow: "robot_low", Warning, Watch, 60, 15;
    /// A robot finds no route, and nothing is known to be in its way.
    RobotBlocked: "robot_blocked", Warning, Watch, 60, 10;
    /// A robot has a task and does not get on.
    RobotStuck: "robot_stuck", Warning, Watch, 0, 5;
    /// A robot says that it is beyond what it was granted.
    BeyondGrant: "grant", Critical, Watch, 1, 5;
    /// A robot that has left the floor still reports.
    RobotReturned: "robot_returned", Warning, Watch, 1, 15;
    /// What is known about a robot contradicts itself.
    RobotFenced: "fenced", Critical, Watch, 0, 0;
    /// Robots wait for what does not keep them.
    WaitsInVain: "waits", Warning, Watch, 3, 5;
    /// Robots and people wait, and nothing that goes on by itself will set them free.
    Standstill: "standstill", Warning, Watch, 0, 5;
    /// Nothing moves on the whole floor, though there is work.
    FloorStandstill: "floor_standstill", Critical, Watch, 0, 5;
    /// Nothing is delivered, though jobs wait and robots can drive.
    NoDeliveries: "deliveries", Critical, Watch, 0, 5;
    /// Nobody knows where a worker is.
    WorkerLost: "worker_lost", Warning, Watch, 0, 2;
    /// Robots have kept a person in one spot.
    WorkerKept: "worker_kept", Warning, Watch, 0, 5;
    /// A worker is in an area that is closed to people.
    WorkerInClosedArea: "closed_areas", Warning, Watch, 0, 3;
    /// Jobs wait without a reason, or for a robot that does not exist.
    JobStuck: "job_stuck", Warning, Watch, 0, 10;
    /// Jobs will probably not be done by their deadline.
    DeadlineAtRisk: "deadline_at_risk", Warning, Watch, 5, 30;
    /// Jobs are past their deadline.
    DeadlineMissed: "deadline_missed", Warning, Watch, 0, 5;
    /// Jobs wait for a station, and no robot is on its way there.
    StationStarved: "station_starved", Warning, Watch, 0, 10;
    /// Stations idle beside racks that are brought to them, or most of the fleet waits.
    Flow: "flow", Warning, Watch, 0, 15;
    /// A robot arm beside a picker gets no trajectory.
    ArmTrouble: "arm_trouble", Warning, Watch, 1, 3;
    /// Steps take longer than the control period.
    StepsLate: "steps_late", Warning, Watch, 5, 20;
    /// Robots wait for long before a route is searched for them.
    PlanBacklog: "plan_backlog", Warning, Watch, 5, 15;
    /// Forecasts of people do not hold.
    ForecastBad: "forecast", Warning, Watch, 30, 60;
    /// The system's clock and the server's are far apart.
    ClockOff: "clock", Warning, Watch, 0, 5;
    /// The facts do not become durable.
    Journal: "journal", Critical, Server, 0, 0;
    /// So many facts are not durable that all robots have to stand.
    Halt: "halt", Critical, Server, 0, 0;
    /// The files of the database are not in their place.
    Database: "database", Critical, Server, 0, 0;
    /// The control loop does not turn.
    LoopStuck: "loop", Critical, Server, 0, 0;
    /// The fleet in memory cannot be trusted.
    Broken: "broken", Critical, Server, 0, 0;
    /// What was promised contradicts itself.
    LedgerUnsound: "ledger", Critical, Server, 0, 0;
    /// The past is not recorded.
    PastNotKept: "past", Warning, Server, 0, 0;
    /// A webhook has taken no events for a while.
    WebhookFailing: "webhook", Warning, Server, 0, 0;
    /// An address shows many tokens or cookies that are wrong.
    SecretsGuessed: "secrets", Warning, Server, 0, 0;
    /// A recording is shown to its end.
    RecordingEnded: "end", Notice, Server, 0, 0;
    /// All robots are stopped by hand.
    Stopped: "stopped", Notice, Operator, 0, 0;
    /// Single robots are paused by hand.
    Paused: "paused", Notice, Operator, 0, 0;
    /// The building is evacuated.
    Evacuation: "evacuation", Critical, Operator, 0, 0;
}

impl AlarmKind {
    /// The kind of this word.
    pub fn of_word(word: &str) -> Option<AlarmKind> {
        AlarmKind::ALL.into_iter().find(|kind| kind.word() == word)
    }

    /// Whether there is one alarm for all of its subjects: they have one cause more often than not.
    pub fn is_collective(self) -> bool {
        use AlarmKind as K;
        let by_subject = matches!(self, K::Standstill | K::StationStarved | K::ArmTrouble | K::RobotFenced)
            || self.is_about_a_robot()
            || matches!(self, K::WorkerLost | K::WorkerKept | K::WorkerInClosedArea);
        !by_subject
    }

    /// Whether it is about one robot, and becomes one alarm for all of them where many have it at once.
    pub fn is_about_a_robot(self) -> bool {
        use AlarmKind as K;
        matches!(
            self,
            K::RobotFailed
                | K::EmergencyStop
                | K::RobotSilent
                | K::RobotDisplaced
                | K::RobotObstructed
                | K::RobotUnplugged
                | K::RobotLow
                | K::RobotBlocked
                | K::RobotStuck
                | K::BeyondGrant
                | K::RobotReturned
        )
    }

    /// After a restart, for so long it is not known whether its cause is still there: robots have to report again, and
    /// some causes are found only when they have lasted.
    pub fn settles_after(self) -> Span {
        use AlarmKind as K;
        let by_report = matches!(
            self,
            K::RobotFailed
                | K::EmergencyStop
                | K::RobotSilent
                | K::RobotDisplaced
                | K::RobotUnplugged
                | K::BeyondGrant
                | K::RobotReturned
                | K::RobotFenced
                | K::ArmTrouble
                | K::StepsLate
                | K::ClockOff
        );
        match self.scope() {
            AlarmScope::Watch if by_report => Span::from_secs(10),
            AlarmScope::Watch => Span::from_secs(180),
            AlarmScope::Operator | AlarmScope::Server => Span::ZERO,
        }
    }

    /// Whether the server cannot promise anything while it stands: requests that change something are refused.
    pub fn ends_readiness(self) -> bool {
        use AlarmKind as K;
        matches!(self, K::Journal | K::Halt | K::Database | K::LoopStuck | K::Broken)
    }

    /// What can be said at most of many robots that have it: "5 robots …".
    pub(super) fn of_many(self) -> &'static str {
        use AlarmKind as K;
        match self {
            K::RobotFailed => "have failed",
            K::EmergencyStop => "have their emergency stop pressed",
            K::RobotSilent => "send no reports",
            K::RobotDisplaced => "stand where they are not expected",
            K::RobotObstructed => "are obstructed",
            K::RobotUnplugged => "get no current from their chargers",
            K::RobotLow => "are low on charge and find no free charger",
            K::RobotBlocked => "find no route",
            K::RobotStuck => "make no progress",
            K::BeyondGrant => "report more than they were granted",
            K::RobotReturned => "have left the floor but still report",
            _ => "need attention",
        }
    }

    /// What to do about it.
    pub fn remedy(self) -> &'static str {
        use AlarmKind as K;
        match self {
            K::RobotFailed => {
                "Go to the robot and repair it, or take it off the floor. Others drive round it."
            }
            K::EmergencyStop => "Check why it was pressed, then release it: the robot goes on by itself.",
            K::RobotSilent => "Check the robot's power and radio. Its place stays closed until it reports.",
            K::RobotDisplaced => "Bring the robot, or its rack, where the text says.",
            K::RobotObstructed => "Clear the way ahead of the robot.",
            K::RobotUnplugged => "Check the charger's power and contacts.",
            K::RobotLow => "Free a charger, or charge the robot by hand.",
            K::RobotBlocked => "Look at why it waits: open an area that is closed, or clear its goal.",
            K::RobotStuck => "Go to the robot and see what keeps it, or pause and resume it.",
            K::BeyondGrant => "Stop the robot and check where it is.",
            K::RobotReturned => "Register the robot again, or switch it off: others do not make way for it.",
            K::RobotFenced => "Check where the robot and its rack are, then resume the robot.",
            K::WaitsInVain => "Pause and resume these robots, and report this.",
            K::Standstill => "Ask the person to make room, or move the robot that the others wait for.",
            K::FloorStandstill => "Look at why the named robots and jobs wait, and start with the first.",
            K::NoDeliveries => "Look at why the jobs wait: the list of jobs says it of each.",
            other => other.remedy_of_others(),
        }
    }

    fn remedy_of_others(self) -> &'static str {
        use AlarmKind as K;
        match self {
            K::WorkerLost => "Look where the worker was last seen. If nobody is there, clear the worker.",
            K::WorkerKept => "Tell the worker to walk on: robots give way to people who walk.",
            K::WorkerInClosedArea => "Call the worker out, or open the area.",
            K::JobStuck => "Cancel these jobs, or add what they need; submit them again then.",
            K::DeadlineAtRisk => "Raise the priority of these jobs, or postpone others.",
            K::DeadlineMissed => "Tell the customer, and raise the priority of these jobs.",
            K::StationStarved => "Look at why the first of these jobs waits.",
            K::Flow => {
                "Look at what the first of these robots waits for, and clear that way; or send fewer robots."
            }
            K::ArmTrouble => {
                "Check the arm's power and connection, and bring it out of the opening. If it stays off, release the \
                 rack: by that you say that the arm is outside."
            }
            K::StepsLate => "Give the server more processor time, or run fewer robots on it.",
            K::PlanBacklog => "Give the server more processor time; if a robot blocks a main aisle, move it.",
            K::ForecastBad => {
                "Nothing at once: robots keep out of all that people can reach. Check the tags."
            }
            K::ClockOff => {
                "Set the system's clock right and restart Giveway. If the system's clock is behind and right, stop \
                 Giveway and type `giveway database set-clock` before that."
            }
            K::Journal | K::Halt => "Check the disk of the database: make room, or bring it back.",
            K::Database => "Put the files of the database back, or restart with a backup.",
            K::LoopStuck => "If this does not end within a minute, restart Giveway.",
            K::Broken | K::LedgerUnsound => {
                "Keep a copy of the database, restart Giveway, and restore a backup if that does not help."
            }
            K::WebhookFailing => {
                "Bring its receiver back, or remove the webhook. Events wait for about an hour; then they are given up."
            }
            K::SecretsGuessed => {
                "Find out who sends them: a device with an old token, or somebody who guesses. The audit has the \
                 addresses."
            }
            K::PastNotKept => "Make room on the disk of the recordings.",
            K::RecordingEnded => "Seek in the recording, or close it.",
            K::Stopped => "Resume the fleet when it may go on.",
            K::Paused => "Resume the robots when they may go on.",
            K::Evacuation => "End the evacuation when everybody may come back.",
            other => other.word(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_kind_has_a_word_of_its_own_and_says_what_to_do() {
        let words: BTreeSet<&str> = AlarmKind::ALL.iter().map(|k| k.word()).collect();
        assert_eq!(words.len(), AlarmKind::ALL.len());
        for kind in AlarmKind::ALL {
            assert_eq!(AlarmKind::of_word(kind.word()), Some(kind));
            let remedy = kind.remedy();
            assert!(remedy.ends_with('.') && remedy.len() > 20, "{kind:?}: {remedy}");
            assert_eq!(kind.is_about_a_robot(), kind.of_many() != "need attention", "{kind:?}");
        }
    }

    #[test]
    fn what_an_operator_wanted_never_ends_readiness() {
        let operator = AlarmKind::ALL.iter().filter(|k| k.scope() == AlarmScope::Operator);
        assert!(operator.clone().count() == 3 && operator.clone().all(|k| !k.ends_readiness()));
        assert!(AlarmKind::Journal.ends_readiness() && AlarmKind::LoopStuck.ends_readiness());
    }
}

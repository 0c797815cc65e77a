//! The kinds of alarms: their words, how bad each is, how long a cause must last, and what to do about it.
//!
//! Main types: [`AlarmKind`], [`AlarmSeverity`], [`AlarmScope`]. Refuses: to look at the fleet.

use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::remedies;
use giveway_floor::time::Span;

/// How bad an alarm is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AlarmSeverity {
    /// A person wanted it so, and should not forget it.
    Notice,
    /// A person should look soon; the floor goes on.
    Warning,
    /// A person has to act now: work stands still, or nothing can be promised.
    Critical,
}

impl AlarmSeverity {
    /// All severities, the least first.
    pub const ALL: [AlarmSeverity; 3] =
        [AlarmSeverity::Notice, AlarmSeverity::Warning, AlarmSeverity::Critical];

    /// The word for the severity on the wire.
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

/// What finds out whether the cause of an alarm is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlarmScope {
    /// What operators asked for: it is read off every view.
    Operator,
    /// Regular looks at the whole fleet and the control loop. A look that does not find a cause again ends it.
    Watch,
    /// Parts of the server, which report by themselves when a cause begins and ends.
    Server,
}

macro_rules! kinds {
    ($(
        $(#[$doc:meta])*
        $name:ident: $word:literal, $severity:ident, $scope:ident, $raise:literal, $clear:literal, $remedy:ident;
    )*) => {
        /// What an alarm is about.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum AlarmKind {
            $($(#[$doc])* $name,)*
        }

        impl AlarmKind {
            /// All kinds of alarms.
            pub const ALL: [AlarmKind; [$(AlarmKind::$name),*].len()] = [$(AlarmKind::$name),*];

            /// The word for the kind on the wire.
            pub fn word(self) -> &'static str {
                match self { $(AlarmKind::$name => $word,)* }
            }

            /// How bad such an alarm is, as long as nothing makes it worse.
            pub fn severity(self) -> AlarmSeverity {
                match self { $(AlarmKind::$name => AlarmSeverity::$severity,)* }
            }

            /// What finds out about such an alarm.
            pub fn scope(self) -> AlarmScope {
                match self { $(AlarmKind::$name => AlarmScope::$scope,)* }
            }

            /// How long a cause has to last to raise an alarm.
            pub fn raised_after(self) -> Span {
                match self { $(AlarmKind::$name => Span::from_secs($raise),)* }
            }

            /// How long a cause has to be gone to end its alarm.
            pub fn cleared_after(self) -> Span {
                match self { $(AlarmKind::$name => Span::from_secs($clear),)* }
            }

            /// What to do about such an alarm.
            pub fn remedy(self) -> Sentence {
                match self { $(AlarmKind::$name => remedies::$remedy(),)* }
            }
        }
    };
}

kinds! {
    /// A robot reports that it is broken, or was found to be.
    RobotFailed: "robot_failed", Warning, Watch, 1, 3, do_repair_robot;
    /// A robot's emergency stop is pressed.
    EmergencyStop: "emergency_stop", Warning, Watch, 1, 2, do_release_emergency_stop;
    /// A robot has not been heard of.
    RobotSilent: "robot_silent", Warning, Watch, 4, 3, do_check_radio;
    /// A robot stands where nothing is held for it, or does not carry what it should.
    RobotDisplaced: "robot_displaced", Warning, Watch, 4, 3, do_bring_robot;
    /// Something that a robot cannot pass stands on its way.
    RobotObstructed: "robot_obstructed", Warning, Watch, 20, 10, do_clear_way;
    /// A robot stands at a charger and gets no current.
    RobotUnplugged: "robot_unplugged", Warning, Watch, 3, 5, do_check_charger;
    /// A robot is low on charge, and no charger is free for it.
    RobotLow: "robot_low", Warning, Watch, 60, 15, do_free_charger;
    /// A robot finds no route, and nothing is known to be in its way.
    RobotBlocked: "robot_blocked", Warning, Watch, 60, 10, do_open_area_or_clear_goal;
    /// A robot has a task and makes no progress.
    RobotStuck: "robot_stuck", Warning, Watch, 0, 5, do_see_what_keeps_robot;
    /// A robot reports that it is beyond what it was granted.
    BeyondGrant: "grant", Critical, Watch, 1, 5, do_stop_robot;
    /// A robot that has left the floor still reports.
    RobotReturned: "robot_returned", Warning, Watch, 1, 15, do_register_or_switch_off;
    /// What is known about a robot contradicts itself.
    RobotFenced: "fenced", Critical, Watch, 0, 0, do_check_and_resume_robot;
    /// Robots wait for something that does not keep them.
    WaitsInVain: "waits", Warning, Watch, 3, 5, do_pause_resume_and_report;
    /// Robots and people wait for something that will not go on by itself.
    Standstill: "standstill", Warning, Watch, 0, 5, do_make_room;
    /// Nothing moves on the whole floor, though there is work.
    FloorStandstill: "floor_standstill", Critical, Watch, 0, 5, do_look_at_first_named;
    /// Nothing is delivered, though jobs wait and robots can drive.
    NoDeliveries: "deliveries", Critical, Watch, 0, 5, do_look_at_jobs;
    /// It is not known where a worker is.
    WorkerLost: "worker_lost", Warning, Watch, 0, 2, do_look_for_worker;
    /// Robots have kept a person in one spot.
    WorkerKept: "worker_kept", Warning, Watch, 0, 5, do_ask_worker_to_walk;
    /// A worker is in an area that is closed to people.
    WorkerInClosedArea: "closed_areas", Warning, Watch, 0, 3, do_call_worker_out;
    /// Jobs wait without a reason, or for a robot that does not exist.
    JobStuck: "job_stuck", Warning, Watch, 0, 10, do_cancel_or_add;
    /// Jobs will probably not be done by their deadline.
    DeadlineAtRisk: "deadline_at_risk", Warning, Watch, 5, 30, do_raise_priority_or_postpone;
    /// Jobs are past their deadline.
    DeadlineMissed: "deadline_missed", Warning, Watch, 0, 5, do_tell_customer;
    /// Jobs wait for a station, and no robot is on its way there.
    StationStarved: "station_starved", Warning, Watch, 0, 10, do_look_at_first_job;
    /// Stations idle beside racks that are brought to them, or most of the fleet waits.
    Flow: "flow", Warning, Watch, 0, 15, do_look_at_first_robot;
    /// A robot arm beside a picker gets no trajectory.
    ArmTrouble: "arm_trouble", Warning, Watch, 1, 3, do_check_arm;
    /// Steps take longer than the control period.
    StepsLate: "steps_late", Warning, Watch, 5, 20, do_more_processor_or_fewer_robots;
    /// Robots wait for long before a route is searched for them.
    PlanBacklog: "plan_backlog", Warning, Watch, 5, 15, do_more_processor_or_move_robot;
    /// Forecasts of people do not come true.
    ForecastBad: "forecast", Warning, Watch, 30, 60, do_check_tags;
    /// The system's clock and the server's are far apart.
    ClockOff: "clock", Warning, Watch, 0, 5, do_set_clock;
    /// The facts do not become durable.
    Journal: "journal", Critical, Server, 0, 0, do_check_disk;
    /// So many facts are not durable that all robots have to stand.
    Halt: "halt", Critical, Server, 0, 0, do_check_disk;
    /// The files of the database are not in their place.
    Database: "database", Critical, Server, 0, 0, do_put_database_back;
    /// The control loop does not run.
    LoopStuck: "loop", Critical, Server, 0, 0, do_restart_if_it_stays;
    /// The fleet in memory cannot be trusted.
    Broken: "broken", Critical, Server, 0, 0, do_restart_and_restore;
    /// What was promised contradicts itself.
    LedgerUnsound: "ledger", Critical, Server, 0, 0, do_restart_and_restore;
    /// The broker of robots is gone.
    BrokerGone: "broker", Critical, Server, 0, 0, do_restart_clients;
    /// Another server has taken the robots behind the broker over.
    RobotsTakenOver: "taken_over", Critical, Server, 0, 0, do_end_other_server;
    /// Robots claim what is not so.
    RobotClaims: "robot_claims", Warning, Server, 0, 0, do_ask_vendor;
    /// The past is not recorded.
    PastNotKept: "past", Warning, Server, 0, 0, do_make_room_on_disk;
    /// A webhook has taken no events for a while.
    WebhookFailing: "webhook", Warning, Server, 0, 0, do_bring_receiver_back;
    /// An address sends many wrong tokens or cookies.
    SecretsGuessed: "secrets", Warning, Server, 0, 0, do_find_guesser;
    /// A recording is shown to its end.
    RecordingEnded: "end", Notice, Server, 0, 0, do_seek_or_close;
    /// All robots are stopped by hand.
    Stopped: "stopped", Notice, Operator, 0, 0, do_resume_fleet;
    /// Single robots are paused by hand.
    Paused: "paused", Notice, Operator, 0, 0, do_resume_robots;
    /// The building is evacuated.
    Evacuation: "evacuation", Critical, Operator, 0, 0, do_end_evacuation;
}

impl AlarmKind {
    /// The kind of this word.
    pub fn of_word(word: &str) -> Option<AlarmKind> {
        AlarmKind::ALL.into_iter().find(|kind| kind.word() == word)
    }

    /// Whether there is one alarm for all subjects of the kind: they have one cause more often than not.
    pub fn is_collective(self) -> bool {
        use AlarmKind as K;
        let by_subject = matches!(self, K::Standstill | K::StationStarved | K::ArmTrouble | K::RobotFenced)
            || self.is_about_a_robot()
            || matches!(self, K::WorkerLost | K::WorkerKept | K::WorkerInClosedArea);
        !by_subject
    }

    /// Whether the kind is about single robots, and becomes one alarm for all of them if many have it at once.
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

    /// How long after a restart it is not known whether the cause is still there: robots have to report again, and some
    /// causes are found only when they have lasted.
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

    /// Whether the server cannot promise anything while the alarm is active: requests that change something are
    /// refused.
    pub fn ends_readiness(self) -> bool {
        use AlarmKind as K;
        matches!(self, K::Journal | K::Halt | K::Database | K::LoopStuck | K::Broken)
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
            assert!(remedy.text().ends_with('.') && remedy.text().len() > 20, "{kind:?}: {remedy}");
        }
    }

    #[test]
    fn what_an_operator_wanted_never_ends_readiness() {
        let operator = AlarmKind::ALL.iter().filter(|k| k.scope() == AlarmScope::Operator);
        assert!(operator.clone().count() == 3 && operator.clone().all(|k| !k.ends_readiness()));
        assert!(AlarmKind::Journal.ends_readiness() && AlarmKind::LoopStuck.ends_readiness());
    }
}

//! The words of the wire: every field that takes one of a few words has an enum here, which the API's description
//! shows.
//!
//! Main macro: `words`. An enum that corresponds to a type of the core is made from it variant by variant, so the
//! compiler finds missing words. Refuses: words without a meaning.

use giveway_cell::{LineState, PickedBy};
use giveway_fleet::alarm::{AlarmKind, AlarmSeverity, SubjectKind};
use giveway_fleet::{
    Activity, AssignmentState, Binds, ClosureState, Doing, Fault, GuidanceReason, GuidanceState, JobKind,
    JobState, JobWord, Presence, Reaction, RobotState,
};
use giveway_people::aware::HumanAwarePolicy;
use giveway_people::human::IntentState;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use utoipa::openapi::{ObjectBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// An enum whose variants are words on the wire; with `of`, each variant of a core type has one.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($variant:ident $word:tt,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
        #[allow(missing_docs, reason = "the variants are the words")]
        pub enum $name { $(#[serde(rename = $word)] $variant,)+ }

        impl $name {
            /// All words.
            #[allow(dead_code, reason = "some are only serialised")]
            pub const ALL: [$name; [$($name::$variant),+].len()] = [$($name::$variant),+];

            /// The word on the wire.
            #[allow(dead_code, reason = "some are only serialised")]
            pub fn word(self) -> &'static str {
                match self { $($name::$variant => $word,)+ }
            }
        }
    };
    ($(#[$doc:meta])* $name:ident of $core:ident { $($variant:ident $word:tt,)+ }) => {
        words! { $(#[$doc])* $name { $($variant $word,)+ } }

        impl From<$core> for $name {
            fn from(core: $core) -> $name {
                match core { $($core::$variant { .. } => $name::$variant,)+ }
            }
        }
    };
}

words! {
    /// The state of a robot. `busy`: at work on a job; `free`: without a job, on its way to a place to stay;
    /// `interrupted`: without a route, waiting for a new one; `failed`: unable to drive; `gone` in the live feed only,
    /// where robots go by number.
    RobotStateDto of RobotState {
        Idle "idle", Busy "busy", Free "free", Interrupted "interrupted", Failed "failed", Gone "gone",
    }
}

words! {
    /// The activity of a robot. `handling`: lifting a rack or setting it down; `waiting`: standing on its way;
    /// `offline`: not reporting; `gone` in the live feed only, where robots go by number.
    ActivityDto of Activity {
        Idle "idle", Driving "driving", Waiting "waiting", Handling "handling", Queueing "queueing",
        Picking "picking", Charging "charging", Paused "paused", Stopped "stopped",
        OutOfService "out_of_service", Failed "failed", Offline "offline", Gone "gone",
    }
}

words! {
    /// The step of its task that a robot performs.
    DoingDto of Doing {
        Idle "idle", ToRack "to_rack", Lifting "lifting", Carrying "carrying", Queueing "queueing",
        Picking "picking", Returning "returning", SettingDown "setting_down", ToCharger "to_charger",
        Charging "charging", Parking "parking", Going "going", Failed "failed",
    }
}

words! {
    /// A fault that a robot reports.
    FaultDto of Fault {
        Broken "broken", EmergencyStop "emergency_stop", Manual "manual", Obstructed "obstructed",
        Unplugged "unplugged",
    }
}

/// What is wanted. `deliver`: bring a rack to a station, and put it back; `return`: put a rack onto the best free
/// storage node; `relocate`: put a rack onto this storage node; `charge`: send a robot to a free charger; `park`: to a
/// free parking place; `go`: to a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobKindDto(pub JobWord);

impl From<JobKind> for JobKindDto {
    fn from(kind: JobKind) -> JobKindDto {
        JobKindDto(kind.name())
    }
}

impl Serialize for JobKindDto {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.0.word())
    }
}

impl<'de> Deserialize<'de> for JobKindDto {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<JobKindDto, D::Error> {
        let word = String::deserialize(from)?;
        let unknown = || serde::de::Error::unknown_variant(&word, JobWord::WORDS);
        JobWord::of_word(&word).map(JobKindDto).ok_or_else(unknown)
    }
}

impl PartialSchema for JobKindDto {
    fn schema() -> RefOr<Schema> {
        let words = ObjectBuilder::new().schema_type(Type::String).enum_values(Some(JobWord::WORDS.to_vec()));
        let kinds = "What is wanted. `deliver`: bring a rack to a station, and put it back; `return`: put a \
                     rack onto the best free storage node; `relocate`: put a rack onto this storage node; \
                     `charge`: send a robot to a free charger; `park`: to a free parking place; `go`: to a node.";
        words.description(Some(kinds)).build().into()
    }
}

impl ToSchema for JobKindDto {}

words! {
    /// How far a job has come.
    JobStateDto of JobState {
        Waiting "waiting", Assigned "assigned", Carrying "carrying", Picking "picking", Done "done",
        Cancelled "cancelled", Failed "failed",
    }
}

words! {
    /// Whether a hand or the robot arm may pick a line.
    PickedByDto of PickedBy { Hand "hand", Arm "arm", Either "either", }
}

impl From<PickedByDto> for PickedBy {
    fn from(dto: PickedByDto) -> PickedBy {
        match dto {
            PickedByDto::Hand => PickedBy::Hand,
            PickedByDto::Arm => PickedBy::Arm,
            PickedByDto::Either => PickedBy::Either,
        }
    }
}

words! {
    /// How far the picking of a line has come. `lit`: being picked now; `short`: pieces are missing; `undone`:
    /// confirmed before, and taken back; `arm`: the robot arm picks it.
    LineStateDto of LineState {
        Open "open", Lit "lit", Done "done", Short "short", Undone "undone", Arm "arm",
    }
}

words! {
    /// The sort of thing that an alarm is about.
    SubjectKindDto of SubjectKind {
        Robot "robot", Worker "worker", Job "job", Station "station", Closure "closure", Floor "floor",
        Server "server",
    }
}

words! {
    /// How severe an alarm is.
    AlarmSeverityDto of AlarmSeverity { Notice "notice", Warning "warning", Critical "critical", }
}

words! {
    /// Whether the cause of an alarm is still present.
    AlarmStateDto { Active "active", Cleared "cleared", }
}

words! {
    /// Whether a worker is on the floor, and how well the position is known.
    PresenceDto of Presence { Absent "absent", Tracked "tracked", Stale "stale", Lost "lost", }
}

words! {
    /// The state of a worker's guidance.
    GuidanceStateDto of GuidanceState {
        Idle "idle", Following "following", Deviating "deviating", Redirected "redirected", Stop "stop",
    }
}

words! {
    /// Why a worker is told something.
    GuidanceReasonDto of GuidanceReason {
        LeftPath "left_path", RobotComes "robot_comes", RobotInTheWay "robot_in_the_way", RobotWaits "robot_waits",
        RobotPasses "robot_passes", RobotCrosses "robot_crosses", PlaceUnsure "place_unsure", CutsOff "cuts_off",
        RoundClosure "round_closure", LeavesClosure "leaves_closure", PlaceClosed "place_closed",
        Evacuation "evacuation", NoWay "no_way", NotTracked "not_tracked",
    }
}

words! {
    /// What a worker is doing. `goal`: walking to the place; `undecided`: to one of several places; `elsewhere`: to no
    /// known place.
    IntentStateDto of IntentState { Goal "goal", Undecided "undecided", Elsewhere "elsewhere", }
}

words! {
    /// How far an assignment has come.
    AssignmentStateDto of AssignmentState {
        Waiting "waiting", Walking "walking", Working "working", Done "done", Cancelled "cancelled",
    }
}

words! {
    /// Whether an area is closed.
    ClosureStateDto of ClosureState { Announced "announced", Closed "closed", Over "over", }
}

words! {
    /// Whether a closed area keeps out robots, people or both.
    BindsDto of Binds { Robots "robots", People "people", Both "both", }
}

words! {
    /// A day of the week.
    WeekdayDto {
        Monday "monday", Tuesday "tuesday", Wednesday "wednesday", Thursday "thursday", Friday "friday",
        Saturday "saturday", Sunday "sunday",
    }
}

words! {
    /// What the fleet did about a robot near a worker.
    ReactionDto of Reaction {
        Kept "kept", Slowed "slowed", Held "held", Rerouted "rerouted", Stopped "stopped",
    }
}

words! {
    /// How the fleet deals with people: the human-aware policy.
    PolicyDto of HumanAwarePolicy { Nhir "nhir", Shir "shir", Phir "phir", Giveway "giveway", }
}

words! {
    /// The unit of an amount.
    HeatUnitDto { Seconds "seconds", Encounters "encounters", }
}

words! {
    /// What holds a node, or has a safety region around it.
    HolderKindDto { Robot "robot", Worker "worker", }
}

words! {
    /// What imposes a condition on a node.
    CauseKindDto {
        Worker "worker", Closure "closure", Robot "robot", Obstruction "obstruction", Evacuation "evacuation",
    }
}

words! {
    /// The effect of a condition on a node. `closed`: no robot may be there; `still`: no robot may enter or leave;
    /// `slow`: only at `limit_mps`; `price`: being there costs the search as much as a delay of `price_s`, which grows
    /// with the probability that a worker is there.
    EffectDto { Closed "closed", Still "still", Slow "slow", Price "price", }
}

words! {
    /// The party that waits.
    WaiterKindDto { Robot "robot", Job "job", Worker "worker", }
}

words! {
    /// What a party waits for.
    WaitedKindDto { Robot "robot", Worker "worker", Job "job", Closure "closure", Station "station", }
}

words! {
    /// What a link of a wait chain is about. The causes `stop`, `drives`, `later` and `stays` are of robots that wait
    /// for nothing; a worker has `robot`, `no_way`, `walks`, `stands` or `lost`.
    WaitCauseDto {
        Resource "resource", Queue "queue", Turn "turn", Person "person", Closure "closure", Route "route",
        Failed "failed",
        EmergencyStop "emergency_stop", Manual "manual", Obstructed "obstructed", Unplugged "unplugged",
        Displaced "displaced", Silent "silent", Refused "refused", Paused "paused",
        Maintenance "maintenance", Leaving "leaving",
        Stopped "stopped", Evacuation "evacuation", Job "job", Rack "rack", Robot "robot", NoRobot "no_robot",
        Station "station", Closed "closed", Blocked "blocked", Place "place", Battery "battery", Stop "stop",
        Drives "drives", Later "later", Stays "stays", NoWay "no_way", Walks "walks", Stands "stands",
        Lost "lost",
    }
}

/// What an alarm is about; docs/alarms.md has a table of all kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlarmKindDto(pub AlarmKind);

impl Serialize for AlarmKindDto {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.word())
    }
}

impl PartialSchema for AlarmKindDto {
    fn schema() -> RefOr<Schema> {
        let words = AlarmKind::ALL.map(AlarmKind::word);
        let text = "What an alarm is about; docs/alarms.md has a table of all kinds.";
        let schema = ObjectBuilder::new().schema_type(Type::String).enum_values(Some(words));
        schema.description(Some(text)).build().into()
    }
}

impl ToSchema for AlarmKindDto {}

/// Where a gaze ray comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum GazeKind {
    /// Straight ahead from the head.
    Head,
    /// Measured by eye tracking.
    Eye,
    /// Estimated by a model.
    Estimated,
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::id::RobotId;

    #[test]
    fn words_of_the_wire_are_those_that_the_core_writes_down_and_filters_by() {
        let robot = RobotId(0);
        let at_work =
            [JobState::Assigned { robot }, JobState::Carrying { robot }, JobState::Picking { robot }];
        for state in [JobState::Waiting, JobState::Done, JobState::Cancelled].into_iter().chain(at_work) {
            assert_eq!(JobStateDto::from(state).word(), state.word());
        }
        for severity in AlarmSeverity::ALL {
            assert_eq!(AlarmSeverityDto::from(severity).word(), severity.word());
        }
        for state in crate::dto::people::ASSIGNMENT_STATES {
            assert_eq!(AssignmentStateDto::from(state).word(), state.word());
        }
        for policy in [HumanAwarePolicy::Nhir, HumanAwarePolicy::Giveway] {
            assert_eq!(PolicyDto::from(policy).word(), policy.word());
        }
        assert_eq!(serde_json::to_value(FaultDto::EmergencyStop).unwrap(), Fault::EmergencyStop.word());
    }
}

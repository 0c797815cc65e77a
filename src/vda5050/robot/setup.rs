//! What a virtual robot is: version, names, place, abilities, and the presets for the three measured robots.
//!
//! Main types: [`RobotSetup`], [`RobotAbilities`]. Refuses: to check a setup; a senseless one makes a senseless robot.

use super::body::BodyLimits;
use super::quirks::{
    BaseRequestHabit, CancelHabit, ChargingOrders, DeviationKey, DrivingFlag, EqualUpdate, ErrorMemory,
    FactsheetForm, FirstState, HandlingParameters, HeadingCheck, IdleCancel, InstantActionsKey, InstantBatch,
    InstantHabit, InstantMemory, LocalizedFlag, NodeStops, NumericParameters, OrderActionHabit, OtherOrder,
    PauseHabit, PausedFlag, ReadingHabit, ReconnectHabit, RejectionWords, RepeatedPause, ReportedBase,
    RobotQuirks, StartRule, StateHabit, StitchedActions, UnreadableReply, VelocityFlag, VersionCheck,
};
use crate::model::factsheet::{ActionScope, Factsheet, OfferedAction};
use crate::model::state::Position;
use crate::model::zone::ZoneSet;
use crate::version::Version;
use std::collections::BTreeMap;

/// One second in microseconds.
pub(super) const SECOND_US: i64 = 1_000_000;

/// What a virtual robot is.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSetup {
    /// The version that it speaks.
    pub version: Version,
    /// Its manufacturer.
    pub manufacturer: String,
    /// Its serial number.
    pub serial: String,
    /// Where it stands at the start, with its name of the map.
    pub position: Position,
    /// The node on which it stands at the start; empty if on none.
    pub last_node: String,
    /// Nodes that it knows by their ids, for orders without positions: x and y in metres.
    pub places: BTreeMap<String, (f64, f64)>,
    /// The longest time between two states, microseconds.
    pub state_interval_us: i64,
    /// The time between two visualizations, microseconds; nothing if it sends none.
    pub visualization_interval_us: Option<i64>,
    /// Its answer to `factsheetRequest`; nothing if it has none.
    pub factsheet: Option<Factsheet>,
    /// The zone sets that it has stored from the start, 3.0: the first one of each map is in force.
    pub zone_sets: Vec<ZoneSet>,
    /// Whether it sends the factsheet by itself when it comes online.
    pub announces_factsheet: bool,
    /// What it can do.
    pub abilities: RobotAbilities,
    /// How its body moves.
    pub body: BodyLimits,
    /// What it does otherwise than the standard.
    pub quirks: RobotQuirks,
}

/// What a virtual robot can do.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotAbilities {
    /// The charge at the start, from 0 to 1.
    pub charge: f64,
    /// The charge that a second at the charger adds, from 0 to 1.
    pub charge_per_s: f64,
    /// The charge that a second of driving takes, from 0 to 1.
    pub drain_per_s: f64,
    /// Where it can charge.
    pub charging_places: ChargingPlaces,
    /// How long `pick` and `drop` are INITIALIZING, microseconds.
    pub handling_prepare_us: i64,
    /// How long `pick` is RUNNING, microseconds.
    pub lift_us: i64,
    /// How long `drop` is RUNNING, microseconds.
    pub set_us: i64,
    /// Kinds of actions that it knows beyond the standard's.
    pub vendor_actions: Vec<String>,
    /// How long any other action takes, microseconds.
    pub other_action_us: i64,
    /// Whether it can tell what it carries.
    pub load_reading: LoadReading,
    /// How far from a node counts as there, if the node does not allow more, metres.
    pub own_deviation_m: f64,
}

/// Where a robot can charge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChargingPlaces {
    /// The robot charges wherever it stands.
    Anywhere,
    /// The robot charges at these nodes; `startCharging` fails at others.
    Nodes(Vec<String>),
}

/// Whether a robot can tell what it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadReading {
    /// Loads are reported.
    Reported,
    /// No loads are reported at all; robots B and C.
    Unknown,
}

impl Default for RobotAbilities {
    fn default() -> RobotAbilities {
        RobotAbilities {
            charge: 0.8,
            charge_per_s: 0.001,
            drain_per_s: 0.0001,
            charging_places: ChargingPlaces::Anywhere,
            handling_prepare_us: 0,
            lift_us: 3 * SECOND_US,
            set_us: 2 * SECOND_US,
            vendor_actions: Vec::new(),
            other_action_us: SECOND_US,
            load_reading: LoadReading::Reported,
            own_deviation_m: 0.1,
        }
    }
}

impl RobotSetup {
    /// A robot that follows the standard of its version and stands at the origin of a map, heading along x, on a node.
    pub fn new(version: Version, manufacturer: &str, serial: &str, map: &str, last_node: &str) -> RobotSetup {
        let body = BodyLimits::default();
        RobotSetup {
            version,
            manufacturer: manufacturer.to_owned(),
            serial: serial.to_owned(),
            position: Position { x: 0.0, y: 0.0, theta: 0.0, map: map.to_owned(), localized: true },
            last_node: last_node.to_owned(),
            places: BTreeMap::new(),
            state_interval_us: 30 * SECOND_US,
            visualization_interval_us: Some(SECOND_US),
            factsheet: Some(Factsheet {
                series: Some("virtual".to_owned()),
                speed_mps: Some(body.speed_mps),
                accel_mps2: Some(body.accel_mps2),
                brake_mps2: Some(body.brake_mps2),
                turn_radps: (version >= Version::V3_0).then_some(body.turn_radps),
                zones: if version >= Version::V3_0 {
                    vec!["BLOCKED".into(), "RELEASE".into(), "SPEED_LIMIT".into()]
                } else {
                    Vec::new()
                },
                actions: (version >= Version::V3_0).then(RobotSetup::offered),
                ..Factsheet::default()
            }),
            zone_sets: Vec::new(),
            announces_factsheet: true,
            abilities: RobotAbilities::default(),
            body,
            quirks: RobotQuirks::default(),
        }
    }

    /// What a robot of 3.0 says that it offers: all that it can do.
    fn offered() -> Vec<OfferedAction> {
        use ActionScope::{AtOnce, Edge, Node};
        let of = |scopes: &[ActionScope], kinds: &[&str]| -> Vec<OfferedAction> {
            let one = |kind: &&str| OfferedAction { kind: (*kind).to_owned(), scopes: scopes.to_vec() };
            kinds.iter().map(one).collect()
        };
        let mut all = of(
            &[AtOnce],
            &["startPause", "stopPause", "cancelOrder", "stateRequest", "factsheetRequest", "logReport"],
        );
        all.extend(of(&[AtOnce], &["trigger", "retry", "skipRetry", "deleteZoneSet"]));
        all.extend(of(&[AtOnce, Node], &["startCharging", "stopCharging", "initializePosition"]));
        all.extend(of(&[AtOnce, Node], &["clearInstantActions", "enableZoneSet"]));
        all.extend(of(&[Node, Edge], &["pick", "drop", "detectObject", "finePositioning"]));
        all.extend(of(&[Node], &["waitForTrigger"]));
        all
    }

    /// A robot that behaves as robot A was measured: npm `vda-5050-lib` 1.4.0, which speaks 2.0.
    pub fn like_a() -> RobotSetup {
        let mut setup = RobotSetup::new(Version::V2_0, "coaty", "a1", "lab", "n0");
        setup.factsheet = Some(Factsheet::default());
        setup.announces_factsheet = false;
        setup.abilities.handling_prepare_us = SECOND_US;
        setup.abilities.own_deviation_m = 0.5;
        // It was measured without acceleration; this is as good as none.
        setup.body.accel_mps2 = 10.0;
        setup.body.brake_mps2 = 10.0;
        setup.quirks = RobotQuirks {
            instant_actions_key: InstantActionsKey::InstantActions,
            deviation_key: DeviationKey::LowerCase,
            unreadable: UnreadableReply::WarningButSilentAboutText,
            instant_batch: InstantBatch::DiesOfTwo,
            instant_memory: InstantMemory::FiveStates,
            equal_update: EqualUpdate::Ignored,
            stitched_actions: StitchedActions::ListedAgain,
            other_order: OtherOrder::Stitched,
            heading_check: HeadingCheck::WithinRad(0.35),
            first_state: FirstState::ListsFirstNode,
            handling_parameters: HandlingParameters::FloorAndEpal,
            charging_orders: ChargingOrders::Refused,
            repeated_pause: RepeatedPause::Failed,
            cancel: CancelHabit::AtOnceAndUnpauses,
            idle_cancel: IdleCancel::ErrorOnly,
            node_stops: NodeStops::EachNode { dwell_us: SECOND_US / 5 },
            reconnect: ReconnectHabit::Unannounced,
            base_request: BaseRequestHabit::Never,
            factsheet_form: FactsheetForm::HeaderOnly,
            ..RobotQuirks::default()
        };
        setup
    }

    /// A robot that behaves as robot B was measured with its own executor: PyPI `vda5050-sdk` 0.2.0, which speaks 2.1.
    /// For its executor beside the reader set `reading` to [`ReadingHabit::AtOnce`]; its nodes then vanish on updates.
    pub fn like_b() -> RobotSetup {
        let mut setup = RobotSetup::new(Version::V2_1, "sdk", "b1", "lab", "n0");
        setup.factsheet = None;
        setup.announces_factsheet = false;
        setup.visualization_interval_us = None;
        setup.abilities.load_reading = LoadReading::Unknown;
        // Exactly there, but for the noise of floating point.
        setup.abilities.own_deviation_m = 0.001;
        setup.quirks = RobotQuirks {
            reading: ReadingHabit::AtEndOfBase,
            equal_update: EqualUpdate::IgnoredInSilence,
            reported_base: ReportedBase::Vanishes,
            rejection_words: RejectionWords::OrderError,
            start_rule: StartRule::DistanceOrLastNode,
            order_actions: OrderActionHabit::DoneEvenUnknown,
            error_memory: ErrorMemory::InstantActionsForEver,
            reconnect: ReconnectHabit::Never,
            velocity_flag: VelocityFlag::Absent,
            base_request: BaseRequestHabit::AtEveryEnd,
            ..RobotQuirks::default()
        };
        setup
    }

    /// A robot that behaves as robot C was measured: PyPI `vda5050-core` 0.1.0rc2, which speaks 2.0, with the
    /// callbacks of its own example.
    pub fn like_c() -> RobotSetup {
        let mut setup = RobotSetup::new(Version::V2_0, "rosi", "c0", "lab", "");
        setup.announces_factsheet = false;
        setup.visualization_interval_us = None;
        setup.abilities.load_reading = LoadReading::Unknown;
        setup.abilities.own_deviation_m = 0.5;
        setup.quirks = RobotQuirks {
            version_check: VersionCheck::Any,
            unreadable: UnreadableReply::Fatal,
            numeric_parameters: NumericParameters::FatalParseError,
            instant_actions: InstantHabit::Claimed,
            instant_memory: InstantMemory::ForEver,
            equal_update: EqualUpdate::Error,
            reported_base: ReportedBase::Vanishes,
            rejection_words: RejectionWords::FatalUpdateError,
            first_state: FirstState::ListsFirstNode,
            order_actions: OrderActionHabit::SkippedInSilence,
            pause: PauseHabit::FailsAndDrivesOn,
            cancel: CancelHabit::ClaimsAndDrivesOn,
            idle_cancel: IdleCancel::Finished,
            error_memory: ErrorMemory::ForEver,
            reconnect: ReconnectHabit::Never,
            states: StateHabit::EventsOnly,
            driving_flag: DrivingFlag::AlwaysFalse,
            paused_flag: PausedFlag::Absent,
            velocity_flag: VelocityFlag::Absent,
            localized_flag: LocalizedFlag::AlwaysFalse,
            base_request: BaseRequestHabit::Never,
            factsheet_form: FactsheetForm::LoadsAreNull,
            ..RobotQuirks::default()
        };
        setup
    }
}

//! A virtual robot: the protocol side of VDA 5050 as a state machine, for tests of any master.
//!
//! Main types: [`VirtualRobot`] (the protocol), [`VirtualBody`] (what moves), [`EmbodiedRobot`] (both together),
//! [`WireRobot`] (with its messages as bytes), [`RobotSetup`] (what the robot is; presets behave as three real robots),
//! [`RobotQuirks`] (habits and lies).
//! Time, messages and the body's report come in, messages and the body's command go out; the same calls give the same
//! answers. Source: VDA 5050, section 6 of each version. Refuses: clocks, input and output, randomness,
//! faults of the transport (they come from outside), and what no master here uses: downloads, hibernation, most zones.

mod acceptance;
mod actions;
mod body;
mod complaints;
mod embodied;
mod execution;
mod instant;
mod link;
mod quirks;
mod report;
mod requests;
mod setup;
#[cfg(test)]
mod tests;
mod wire;
mod zones;

pub use body::{BodyCommand, BodyLimits, BodyMotion, BodyReport, PathPoint, VirtualBody};
pub use embodied::EmbodiedRobot;
pub use link::GarbledMessage;
pub use quirks::{
    BaseRequestHabit, CancelHabit, ChargingOrders, DeviationKey, DrivingFlag, EqualUpdate, ErrorMemory,
    FactsheetForm, FirstState, HandlingParameters, HeadingCheck, IdleCancel, InstantActionsKey, InstantBatch,
    InstantHabit, InstantMemory, LocalizedFlag, MidwayUpdate, NodeStops, NumericParameters, OrderActionHabit,
    OtherOrder, PauseHabit, PausedFlag, ReadingHabit, ReconnectHabit, RejectionWords, RepeatedPause,
    ReportedBase, RobotQuirks, StartRule, StateHabit, StitchedActions, UnreadableReply, VelocityFlag,
    VersionCheck,
};
pub use setup::{ChargingPlaces, LoadReading, RobotAbilities, RobotSetup};
pub use wire::{ReadMessage, WireMessage, WireRobot};

use crate::model::Message;
use crate::model::state::{EStop, Load, OperatingMode, Position, State};
use crate::topic::TopicKind;
use crate::version::Version;
use actions::ActionEntry;
use complaints::StandingError;
use execution::{HeldOrder, PauseStage};
use instant::InstantList;
use link::LinkStage;
use report::Reporting;
use requests::RequestList;
use std::collections::VecDeque;
use zones::ZoneStore;

/// The protocol side of a robot.
#[derive(Clone, Debug)]
pub struct VirtualRobot {
    setup: RobotSetup,
    /// The time of the last step, microseconds; nothing before the first one.
    stepped_us: Option<i64>,
    link: LinkStage,
    order: HeldOrder,
    actions: Vec<ActionEntry>,
    instants: InstantList,
    errors: Vec<StandingError>,
    mode: OperatingMode,
    e_stop: EStop,
    is_field_violated: bool,
    pause: PauseStage,
    equipment: Equipment,
    body: BodyReport,
    map: String,
    is_localized: bool,
    last_node: String,
    last_sequence: u32,
    inbox: VecDeque<Message>,
    outbox: Vec<RobotMessage>,
    placed: Option<(f64, f64, f64)>,
    reporting: Reporting,
    requests: RequestList,
    zones: ZoneStore,
}

/// What a robot carries besides its wheels.
#[derive(Clone, Debug)]
struct Equipment {
    loads: Vec<Load>,
    /// From 0 to 1.
    charge: f64,
    is_charging: bool,
    /// Whether `pick` and `drop` fail.
    has_handling_fault: bool,
    /// Loads without a name that were picked so far.
    nameless: u32,
}

/// A message that a robot sends; its header is for the caller.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotMessage {
    /// The topic on which it is sent.
    pub topic: TopicKind,
    /// The message.
    pub message: Message,
}

/// What comes of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotStep {
    /// Messages to send, in order.
    pub messages: Vec<RobotMessage>,
    /// What the body is to do until the next step.
    pub command: BodyCommand,
}

impl VirtualRobot {
    /// A robot that is switched on and not yet connected: its first step says ONLINE.
    pub fn new(setup: RobotSetup) -> VirtualRobot {
        VirtualRobot {
            stepped_us: None,
            link: LinkStage::Starting,
            order: HeldOrder::default(),
            actions: Vec::new(),
            instants: InstantList::default(),
            errors: Vec::new(),
            mode: OperatingMode::Automatic,
            e_stop: EStop::None,
            is_field_violated: false,
            pause: PauseStage::Off,
            equipment: Equipment {
                loads: Vec::new(),
                charge: setup.abilities.charge.clamp(0.0, 1.0),
                is_charging: false,
                has_handling_fault: false,
                nameless: 0,
            },
            body: BodyReport {
                x: setup.position.x,
                y: setup.position.y,
                theta: setup.position.theta,
                ..BodyReport::default()
            },
            map: setup.position.map.clone(),
            is_localized: setup.position.localized,
            last_node: setup.last_node.clone(),
            last_sequence: 0,
            inbox: VecDeque::new(),
            outbox: Vec::new(),
            placed: None,
            reporting: Reporting::default(),
            requests: RequestList::default(),
            zones: ZoneStore::new(&setup.zone_sets),
            setup,
        }
    }

    /// Lets the robot act at a time in microseconds, given what it received since the last step and what its body
    /// reports. A time before the last step's counts as that one. A robot that is not connected receives nothing.
    pub fn step(&mut self, now_us: i64, received: &[Message], body: &BodyReport) -> RobotStep {
        let before_us = self.stepped_us.unwrap_or(now_us);
        let now_us = now_us.max(before_us);
        let elapsed_us = now_us.saturating_sub(before_us);
        self.stepped_us = Some(now_us);
        self.body = BodyReport { reached: Vec::new(), ..body.clone() };
        if self.link == LinkStage::Dead {
            return RobotStep { messages: Vec::new(), command: BodyCommand::default() };
        }
        self.come_online();
        self.pass_nodes(now_us, &body.reached);
        self.use_battery(elapsed_us);
        self.listen(received);
        self.note_blocked();
        self.ask_for_releases(now_us);
        self.work(elapsed_us);
        self.settle_pause();
        self.settle_cancel();
        self.report(now_us);
        RobotStep { messages: self.take_messages(), command: self.command(now_us) }
    }

    /// What the robot was set up as.
    pub fn setup(&self) -> &RobotSetup {
        &self.setup
    }

    /// The state that the robot would send now, true or not.
    pub fn state(&self) -> State {
        self.compose_state()
    }

    /// Sets who drives the robot. Modes that take the robot from the master clear its order. INTERVENED and STARTUP
    /// are of 3.0; before, MANUAL is set instead.
    pub fn set_mode(&mut self, mode: OperatingMode) {
        let is_new = matches!(mode, OperatingMode::Intervened | OperatingMode::Startup);
        self.mode = if is_new && self.setup.version < Version::V3_0 { OperatingMode::Manual } else { mode };
        if !self.mode.takes_orders() && self.mode != OperatingMode::Intervened {
            self.clear_order();
        }
        let forgets_node =
            matches!(self.mode, OperatingMode::Startup | OperatingMode::Service | OperatingMode::TeachIn);
        if forgets_node && self.setup.version >= Version::V3_0 {
            self.last_node.clear();
        }
        if self.takes_new_orders() {
            self.forgive_mode();
        }
    }

    /// Presses or releases the emergency stop. The order is kept.
    pub fn set_e_stop(&mut self, e_stop: EStop) {
        self.e_stop = e_stop;
    }

    /// Sets whether something is in the protective field; the robot stands as long as it is.
    pub fn set_field_violation(&mut self, is_violated: bool) {
        self.is_field_violated = is_violated;
    }

    /// Sets whether the robot knows where it is; if it does not, it stands and refuses orders.
    pub fn set_localized(&mut self, is_localized: bool) {
        self.is_localized = is_localized;
        self.complain_of_localization();
        if self.takes_new_orders() {
            self.forgive_mode();
        }
    }

    /// Puts loads on the robot by hand, in place of those it has.
    pub fn set_loads(&mut self, loads: Vec<Load>) {
        self.equipment.loads = loads;
    }

    /// Sets whether `pick` and `drop` fail, for example because the station is empty or full.
    pub fn set_handling_fault(&mut self, is_faulty: bool) {
        self.equipment.has_handling_fault = is_faulty;
    }

    /// Sets the charge, from 0 to 1.
    pub fn set_charge(&mut self, charge: f64) {
        self.equipment.charge = if charge.is_finite() { charge.clamp(0.0, 1.0) } else { 0.0 };
    }

    /// Presses the button at the robot that ends `waitForTrigger`.
    pub fn press_trigger(&mut self) {
        self.pull_trigger();
    }

    /// Presses the button at the robot that pauses it, or the one that lets it go on.
    pub fn press_pause(&mut self, pauses: bool) {
        if pauses {
            self.begin_pause();
        } else {
            self.pause = PauseStage::Off;
        }
    }

    /// Switches the robot off and on again: order, actions, errors and loads are forgotten, pause and emergency stop
    /// are released. The robot comes back at the given position, on a node or, with an empty name, on none.
    pub fn reboot(&mut self, position: Position, last_node: &str) {
        let mut setup = self.setup.clone();
        let initial = (setup.position.clone(), setup.last_node.clone());
        let stepped_us = self.stepped_us;
        setup.position = position;
        setup.last_node = last_node.to_owned();
        setup.abilities.charge = self.equipment.charge;
        let placed = Some((setup.position.x, setup.position.y, setup.position.theta));
        *self = VirtualRobot { stepped_us, placed, ..VirtualRobot::new(setup) };
        (self.setup.position, self.setup.last_node) = initial;
    }

    fn use_battery(&mut self, elapsed_us: i64) {
        let seconds = elapsed_us as f64 * 1e-6;
        let abilities = &self.setup.abilities;
        let equipment = &mut self.equipment;
        if equipment.is_charging {
            equipment.charge = (equipment.charge + seconds * abilities.charge_per_s).min(1.0);
            // The robot itself protects its battery from overcharging.
            equipment.is_charging = equipment.charge < 1.0 && self.body.stands();
        } else if !self.body.stands() {
            equipment.charge = (equipment.charge - seconds * abilities.drain_per_s).max(0.0);
        }
    }
}

//! What a virtual robot says of itself, and when: states on events and at least once an interval, visualizations.
//!
//! Main type: [`Reporting`]; main functions: `report`, `compose_state`. Source: VDA 5050 3.0, section 6.6. Refuses: to
//! send two states in one step, but for the quirk of robots A and C at a new order.

use super::VirtualRobot;
use super::execution::{OrderPhase, PauseStage};
use super::quirks::{
    BaseRequestHabit, DrivingFlag, InstantMemory, LocalizedFlag, PausedFlag, StateHabit, VelocityFlag,
};
use super::setup::LoadReading;
use crate::model::Message;
use crate::model::state::{NodeLeft, Position, Power, State, Velocity, Visualization};
use crate::topic::TopicKind;

/// When a robot reported, and what.
#[derive(Clone, Debug, Default)]
pub(super) struct Reporting {
    /// Whether the next step sends a state in any case.
    pub(super) must_say: bool,
    /// What of the last state is worth a new one if it changes.
    said: Option<State>,
    /// When the next state is due at the latest, microseconds; nothing before the first one.
    next_state_us: Option<i64>,
    /// When the next visualization is due, microseconds; nothing before the first one.
    next_visualization_us: Option<i64>,
}

/// The rest of the base at which a robot asks for more, beyond the way it needs to brake; metres.
const BASE_MARGIN_M: f64 = 0.5;

impl VirtualRobot {
    /// Says what is due.
    pub(super) fn report(&mut self, now_us: i64) {
        if !self.is_alive() {
            return;
        }
        let state = self.compose_state();
        let mut events = events_of(&state);
        let is_changed = match &self.reporting.said {
            Some(said) => *said != events,
            // A robot that speaks on events alone has nothing to say at the start.
            None => self.setup.quirks.states == StateHabit::EventsAndInterval,
        };
        let is_due = self.setup.quirks.states == StateHabit::EventsAndInterval
            && self.reporting.next_state_us.is_none_or(|due_us| due_us <= now_us);
        if self.reporting.must_say || is_changed || is_due {
            self.say(TopicKind::State, Message::State(Box::new(state)));
            self.reporting.must_say = false;
            self.reporting.next_state_us = Some(now_us.saturating_add(self.setup.state_interval_us.max(1)));
            if self.setup.quirks.instant_memory == InstantMemory::FiveStates {
                // What is dropped now is no event: the next state that comes anyway is the first without it.
                self.instants.count_state();
                events = events_of(&self.compose_state());
            }
        }
        self.reporting.said = Some(events);
        self.visualize(now_us);
    }

    fn visualize(&mut self, now_us: i64) {
        let Some(interval_us) = self.setup.visualization_interval_us else { return };
        let due_us =
            self.reporting.next_visualization_us.unwrap_or(now_us.saturating_add(interval_us.max(1)));
        self.reporting.next_visualization_us = Some(due_us);
        if due_us <= now_us {
            let visualization = Visualization {
                position: Some(self.compose_position()),
                velocity: self.compose_velocity(),
                state_header: None,
            };
            self.say(TopicKind::Visualization, Message::Visualization(visualization));
            self.reporting.next_visualization_us = Some(now_us.saturating_add(interval_us.max(1)));
        }
    }

    /// The state as the robot would say it now.
    pub(super) fn compose_state(&self) -> State {
        let quirks = &self.setup.quirks;
        let is_halted = self.pause != PauseStage::Off;
        let mut actions: Vec<_> = self.actions.iter().map(|entry| entry.to_state(is_halted)).collect();
        let mut instant_actions = self.instants.to_states();
        if !self.speaks_3_0() {
            actions.append(&mut instant_actions);
        }
        let nodes = self.order.nodes.iter().filter(|held| !held.is_hidden);
        let edges = self.order.edges.iter().filter(|held| !held.is_hidden);
        State {
            order: self.order.id.clone(),
            update: self.order.update,
            last_node: self.last_node.clone(),
            last_sequence: self.last_sequence,
            nodes: nodes.map(|h| left(&h.node.id, h.node.sequence, h.node.released)).collect(),
            edges: edges.map(|h| left(&h.edge.id, h.edge.sequence, h.edge.released)).collect(),
            actions,
            instant_actions,
            position: Some(self.compose_position()),
            velocity: self.compose_velocity(),
            driving: quirks.driving_flag == DrivingFlag::Reported && !self.body.stands(),
            paused: (quirks.paused_flag == PausedFlag::Reported).then_some(self.is_paused()),
            wants_base: self.wants_base(),
            loads: match self.setup.abilities.load_reading {
                LoadReading::Reported => Some(self.equipment.loads.clone()),
                LoadReading::Unknown => None,
            },
            power: Power { charge: Some(self.equipment.charge), charging: self.equipment.is_charging },
            mode: self.mode,
            errors: self.errors.iter().map(|standing| standing.error.clone()).collect(),
            e_stop: self.e_stop,
            field_violation: self.is_field_violated,
            requests: self.requests.to_states(),
            zone_sets: self.zones.to_states(),
        }
    }

    fn compose_position(&self) -> Position {
        Position {
            x: self.body.x,
            y: self.body.y,
            theta: self.body.theta,
            map: self.map.clone(),
            localized: self.is_localized && self.setup.quirks.localized_flag == LocalizedFlag::Reported,
        }
    }

    fn compose_velocity(&self) -> Option<Velocity> {
        let is_said = self.setup.quirks.velocity_flag == VelocityFlag::Reported;
        is_said.then_some(Velocity { vx: self.body.speed_mps, vy: 0.0, omega: self.body.turn_radps })
    }

    fn wants_base(&self) -> bool {
        let is_running = self.order.phase == OrderPhase::Running;
        match self.setup.quirks.base_request {
            BaseRequestHabit::Never => false,
            BaseRequestHabit::AtEveryEnd => is_running && self.order.released_left() == 0,
            BaseRequestHabit::WhenShort => {
                let released = self.order.released_left();
                let has_horizon = self.order.nodes.len() > released;
                is_running && has_horizon && self.base_left_m(released) <= self.braking_m() + BASE_MARGIN_M
            }
        }
    }

    fn braking_m(&self) -> f64 {
        let limits = &self.setup.body;
        limits.speed_mps * limits.speed_mps / (2.0 * limits.brake_mps2)
    }

    /// The way to the end of the base along straight lines, metres.
    fn base_left_m(&self, released: usize) -> f64 {
        let places = self.order.nodes[..released].iter().filter_map(|held| self.place_of(&held.node));
        let mut at = (self.body.x, self.body.y);
        let mut length_m = 0.0;
        for place in places {
            length_m += (place.0 - at.0).hypot(place.1 - at.1);
            at = place;
        }
        length_m
    }
}

fn left(id: &str, sequence: u32, released: bool) -> NodeLeft {
    NodeLeft { id: id.to_owned(), sequence, released }
}

/// What of a state is worth a new one if it changes: all but where the robot is, how fast, and its charge.
fn events_of(state: &State) -> State {
    State {
        position: None,
        velocity: None,
        power: Power { charge: None, charging: state.power.charging },
        ..state.clone()
    }
}

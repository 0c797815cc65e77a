//! What is left of a message after a version has said it.
//!
//! Main function: [`as_said`], which states in code, apart from the tables by which messages are read and written, what
//! each version cannot say. Refuses: numbers that are not finite.

use crate::*;
use std::f64::consts::{PI, TAU};

/// The first instant of the year 10000, microseconds.
const YEAR_10000_US: i64 = 253_402_300_800_000_000;

/// What a reader can know of a message that was written in a version.
pub(super) fn as_said(message: &Message, version: Version) -> Message {
    let mut message = message.clone();
    match &mut message {
        Message::Order(order) => order_as_said(order, version),
        Message::InstantActions(actions) => {
            for action in actions {
                action.retriable = false;
                // 3.0 has no word for instant actions but NONE.
                action.blocking = match (version, action.blocking) {
                    (Version::V3_0, _) => BlockingType::None,
                    (_, BlockingType::Single) => BlockingType::Hard,
                    (_, other) => other,
                };
            }
        }
        Message::State(state) => state_as_said(state, version),
        Message::Visualization(visualization) => {
            // 3.0 must have a header id; the others cannot have one.
            visualization.state_header =
                (version == Version::V3_0).then(|| visualization.state_header.unwrap_or(0));
            turn(&mut visualization.position);
        }
        Message::Connection(connection) => {
            if version < Version::V3_0 && *connection == ConnectionState::Hibernating {
                *connection = ConnectionState::Offline;
            }
        }
        Message::Factsheet(sheet) => factsheet_as_said(sheet, version),
        Message::ZoneSet(_) => {}
        Message::Responses(responses) => {
            for response in responses {
                // Milliseconds of the years 1970 to 9999; only what is granted ends.
                response.until_us = response.until_us.filter(|_| response.grant == Grant::Granted);
                response.until_us =
                    response.until_us.map(|us| us.clamp(0, YEAR_10000_US - 1) / 1_000 * 1_000);
            }
        }
    }
    message
}

fn order_as_said(order: &mut Order, version: Version) {
    let positions = order.nodes.iter_mut().flat_map(|node| &mut node.position);
    positions.for_each(|place| place.theta = place.theta.map(within_half_a_turn));
    for edge in &mut order.edges {
        // 2.0 has no corridors; 2.1 has none for which the robot must ask.
        edge.corridor = edge.corridor.filter(|corridor| match version {
            Version::V2_0 => false,
            Version::V2_1 => !corridor.release_required,
            Version::V3_0 => true,
        });
    }
    let at_nodes = order.nodes.iter_mut().flat_map(|node| &mut node.actions);
    for action in at_nodes.chain(order.edges.iter_mut().flat_map(|edge| &mut edge.actions)) {
        if version < Version::V3_0 {
            action.retriable = false;
            if action.blocking == BlockingType::Single {
                action.blocking = BlockingType::Hard;
            }
        }
    }
}

fn state_as_said(state: &mut State, version: Version) {
    turn(&mut state.position);
    // Every version must have a charge.
    state.power.charge = Some(in_percent(state.power.charge.unwrap_or(0.0)));
    if version == Version::V3_0 {
        if state.e_stop == EStop::AutoAck {
            state.e_stop = EStop::Manual;
        }
        // Requests about zones and about corridors are in two lists.
        state.requests.sort_by_key(|request| matches!(request.subject, RequestSubject::Corridor { .. }));
        return;
    }
    state.requests.clear();
    state.zone_sets.clear();
    state.actions.append(&mut state.instant_actions);
    for action in &mut state.actions {
        action.status = match (version, action.status) {
            (_, ActionStatus::Retriable) => ActionStatus::Failed,
            (Version::V2_1, ActionStatus::Paused) => ActionStatus::Running,
            (_, other) => other,
        };
    }
    if matches!(state.mode, OperatingMode::Startup | OperatingMode::Intervened) {
        state.mode = OperatingMode::Manual;
    }
    for error in &mut state.errors {
        if error.level != ErrorLevel::Fatal {
            error.level = ErrorLevel::Warning;
        }
        if version == Version::V2_0 {
            error.hint = None;
        }
    }
}

fn factsheet_as_said(sheet: &mut Factsheet, version: Version) {
    // Every version must have these.
    sheet.actions.get_or_insert_default();
    sheet.payload_kg.get_or_insert_default();
    sheet.turn_radps = sheet.turn_radps.filter(|_| version == Version::V3_0);
    sheet.critical = sheet.critical.map(in_percent).filter(|_| version == Version::V3_0);
    let is_zone =
        |zone: &String| version == Version::V3_0 && ["BLOCKED", "SPEED_LIMIT"].contains(&zone.as_str());
    sheet.zones.retain(is_zone);
    for action in sheet.actions.iter_mut().flatten() {
        action.scopes.retain(|scope| version == Version::V3_0 || *scope != ActionScope::Zone);
    }
}

fn turn(position: &mut Option<Position>) {
    if let Some(position) = position {
        position.theta = within_half_a_turn(position.theta);
    }
}

fn within_half_a_turn(angle: f64) -> f64 {
    if angle.abs() <= PI { angle } else { (angle - TAU * (angle / TAU).round()).clamp(-PI, PI) }
}

/// A share that went through percent.
fn in_percent(share: f64) -> f64 {
    share * 100.0 / 100.0
}

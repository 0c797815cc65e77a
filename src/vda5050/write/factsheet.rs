//! Writes factsheets.
//!
//! Main function: [`factsheet`]. The schemas require more than the model has: robots of this project are carriers with
//! two driven wheels, and what is not known is written as 0, as an empty text or as an empty list, which the reader
//! takes for not said wherever it cannot be meant. Refuses: types of zones that no version knows.

use super::object::ObjectWriter;
use crate::model::factsheet::{Factsheet, OfferedAction};
use crate::vocabulary::{names, words};

/// How the robots of this project drive, in a word of every version.
const KINEMATICS: &str = "DIFF";

/// What the robots of this project are, in a word of every version.
const CLASS: &str = "CARRIER";

pub(super) fn factsheet(top: &mut ObjectWriter, sheet: &Factsheet) {
    top.object(&names::TYPE, |object| type_specification(object, sheet));
    top.object(&names::BODY, |object| {
        object.put(&names::LEAST_SPEED, 0.0);
        object.magnitude_or_zero(&names::SPEED, sheet.speed_mps);
        object.magnitude_or_zero(&names::ACCELERATION, sheet.accel_mps2);
        object.magnitude_or_zero(&names::DECELERATION, sheet.brake_mps2);
        object.magnitude(&names::TURNING, sheet.turn_radps);
        object.put(&names::LEAST_HEIGHT, 0.0);
        object.put(&names::HEIGHT, 0.0);
        object.magnitude_or_zero(&names::WIDTH, sheet.width_m);
        object.magnitude_or_zero(&names::LENGTH, sheet.length_m);
    });
    top.object(&names::LIMITS, |object| protocol_limits(object, sheet));
    top.object(&names::FEATURES, |object| {
        object.put(&names::OPTIONAL_PARAMETERS, Vec::<String>::new());
        object.list(&names::OFFERED_ACTIONS, sheet.actions.iter().flatten(), offered);
    });
    top.object(&names::GEOMETRY, |_| ());
    top.object(&names::LOAD_SPECIFICATION, |_| ());
    if let Some(critical) = sheet.critical.filter(|critical| critical.is_finite()) {
        top.object(&names::CONFIGURATION, |object| {
            object.object(&names::BATTERY_CHARGING, |object| object.share(&names::CRITICAL_CHARGE, critical));
        });
    }
}

fn type_specification(object: &mut ObjectWriter, sheet: &Factsheet) {
    object.put(&names::SERIES, sheet.series.as_deref().unwrap_or_default());
    object.put(&names::KINEMATICS, KINEMATICS);
    object.put(&names::CLASS, CLASS);
    object.magnitude_or_zero(&names::PAYLOAD, sheet.payload_kg);
    object.put(&names::LOCALIZATION, Vec::<String>::new());
    object.put(&names::NAVIGATION, Vec::<String>::new());
    let zones = sheet.zones.iter().map(String::as_str);
    object.put(&names::ZONES, zones.filter(|zone| words::ZONE_TYPES.contains(zone)).collect::<Vec<_>>());
}

fn protocol_limits(object: &mut ObjectWriter, sheet: &Factsheet) {
    object.object(&names::TEXT_LIMITS, |limits| limits.put_any(&names::ID_LENGTH, sheet.longest_id));
    object.object(&names::LIST_LIMITS, |limits| limits.put_any(&names::ORDER_NODES, sheet.most_nodes));
    object.object(&names::TIMING, |timing| {
        timing.magnitude_or_zero(&names::ORDER_INTERVAL, sheet.order_interval_s);
        timing.put(&names::STATE_INTERVAL, 0.0);
    });
}

fn offered(object: &mut ObjectWriter, action: &OfferedAction) {
    object.put(&names::ACTION_TYPE, action.kind.as_str());
    object.words(&names::SCOPES, &words::SCOPE, &action.scopes);
    // The robots of this project stop and cancel every action.
    object.put(&names::PAUSE_ALLOWED, true);
    object.put(&names::CANCEL_ALLOWED, true);
}

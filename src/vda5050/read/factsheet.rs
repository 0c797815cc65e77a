//! Reads factsheets.
//!
//! Main function: [`factsheet`]. What a sheet does not say, the model does not have. Zeros that
//! stand for nothing (a robot without length, a limit of no nodes) are read as not said. Refuses: no sheet.

use super::object::ObjectReader;
use super::oddity::Unreadable;
use crate::model::factsheet::{Factsheet, OfferedAction};
use crate::vocabulary::{WireName, names, words};

/// What every version wants a factsheet to have.
const REQUIRED: [&WireName; 6] = [
    &names::TYPE,
    &names::BODY,
    &names::LIMITS,
    &names::FEATURES,
    &names::GEOMETRY,
    &names::LOAD_SPECIFICATION,
];

pub(super) fn factsheet(top: &ObjectReader<'_>) -> Factsheet {
    for part in REQUIRED {
        if !top.has(part) {
            top.assumed(part, "unknown", ());
        }
    }
    let kind = top.object(&names::TYPE);
    let body = top.object(&names::BODY);
    let limits = top.object(&names::LIMITS);
    let limit = |part: &WireName, name: &WireName| {
        limits?.object(part)?.count(name).filter(|most| *most > 0).and_then(|most| usize::try_from(most).ok())
    };
    let measure = |name: &WireName| body?.magnitude(name).filter(|length| *length > 0.0);
    Factsheet {
        series: kind.and_then(|kind| kind.text(&names::SERIES)).filter(|series| !series.is_empty()),
        speed_mps: measure(&names::SPEED),
        accel_mps2: measure(&names::ACCELERATION),
        brake_mps2: brake(body.as_ref()),
        turn_radps: measure(&names::TURNING),
        length_m: measure(&names::LENGTH),
        width_m: measure(&names::WIDTH),
        payload_kg: kind.and_then(|kind| kind.magnitude(&names::PAYLOAD)),
        most_nodes: limit(&names::LIST_LIMITS, &names::ORDER_NODES),
        longest_id: limit(&names::TEXT_LIMITS, &names::ID_LENGTH),
        order_interval_s: limits
            .and_then(|limits| limits.object(&names::TIMING)?.magnitude(&names::ORDER_INTERVAL))
            .filter(|interval| *interval > 0.0),
        actions: top.object(&names::FEATURES).and_then(|all| all.readable(&names::OFFERED_ACTIONS, offered)),
        zones: kind.map(|kind| kind.texts(&names::ZONES)).unwrap_or_default(),
        critical: top
            .object(&names::CONFIGURATION)
            .and_then(|all| all.object(&names::BATTERY_CHARGING)?.share(&names::CRITICAL_CHARGE)),
    }
}

/// Some sheets have braking as a negative acceleration.
fn brake(body: Option<&ObjectReader<'_>>) -> Option<f64> {
    body?.number(&names::DECELERATION).map(f64::abs).filter(|brake| *brake > 0.0)
}

fn offered(object: &ObjectReader<'_>) -> Result<OfferedAction, Unreadable> {
    Ok(OfferedAction {
        kind: object.need_text(&names::ACTION_TYPE)?,
        scopes: object.words(&names::SCOPES, &words::SCOPE),
    })
}

//! Writes answers to robots' requests, and zone sets.
//!
//! Main functions: [`responses`], [`zone_set`]. Refuses: zones with fewer than three corners, and corners that are not
//! finite.

use super::object::ObjectWriter;
use crate::model::answer::{Grant, Response};
use crate::model::zone::{Zone, ZoneKind, ZoneSet};
use crate::stamp;
use crate::vocabulary::words::ZoneWord;
use crate::vocabulary::{names, words};

/// What a robot does in a RELEASE zone whose release it loses: the standard's default.
const STOPS: &str = "STOP";

pub(super) fn responses(top: &mut ObjectWriter, responses: &[Response]) {
    top.list(&names::RESPONSES, responses, |object, response: &Response| {
        object.put(&names::REQUEST_ID, response.request.as_str());
        object.word(&names::GRANT_TYPE, &words::GRANT, response.grant);
        let until_us = response.until_us.filter(|_| response.grant == Grant::Granted);
        object.put_any(&names::LEASE_EXPIRY, until_us.map(stamp::text));
    });
}

pub(super) fn zone_set(top: &mut ObjectWriter, set: &ZoneSet) {
    top.object(&names::ZONE_SET, |object| {
        object.put(&names::MAP, set.map.as_str());
        object.put(&names::ZONE_SET_ID, set.id.as_str());
        let zones = set.zones.iter().filter(|zone| finite_corners(zone).count() >= 3);
        object.list(&names::ZONES_OF_SET, zones, zone);
    });
}

fn zone(object: &mut ObjectWriter, zone: &Zone) {
    object.put(&names::ZONE_ID, zone.id.as_str());
    let word = match zone.kind {
        ZoneKind::Blocked => ZoneWord::Blocked,
        ZoneKind::Release => {
            object.put(&names::RELEASE_LOSS, STOPS);
            ZoneWord::Release
        }
        ZoneKind::SpeedLimit(mps) => {
            object.magnitude_or_zero(&names::ZONE_SPEED, Some(mps));
            ZoneWord::SpeedLimit
        }
    };
    object.word(&names::ZONE_TYPE, &words::ZONE_WORD, word);
    object.list(&names::VERTICES, finite_corners(zone), |object, (x, y): &(f64, f64)| {
        object.number(&names::X, *x);
        object.number(&names::Y, *y);
    });
}

fn finite_corners(zone: &Zone) -> impl Iterator<Item = &(f64, f64)> {
    zone.corners.iter().filter(|(x, y)| x.is_finite() && y.is_finite())
}

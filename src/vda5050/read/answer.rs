//! Reads answers to robots' requests, and zone sets.
//!
//! Main functions: [`responses`], [`zone_set`]. An answer that cannot be read is left out, so that it does not stop
//! others: without an answer nothing is granted. A zone set is read as a whole or not at all. Refuses: zone sets
//! without ids and corners, and leases whose end cannot be read.

use super::object::ObjectReader;
use super::oddity::Unreadable;
use crate::model::answer::Response;
use crate::model::zone::{Zone, ZoneKind, ZoneSet};
use crate::stamp;
use crate::vocabulary::words::ZoneWord;
use crate::vocabulary::{names, words};

pub(super) fn responses(top: &ObjectReader<'_>) -> Result<Vec<Response>, Unreadable> {
    top.readable(&names::RESPONSES, response).ok_or_else(|| top.missing(&names::RESPONSES))
}

fn response(object: &ObjectReader<'_>) -> Result<Response, Unreadable> {
    let until = object.text(&names::LEASE_EXPIRY);
    let until_us = until.as_deref().map(stamp::of_text);
    if until_us == Some(None) {
        return Err(object.missing(&names::LEASE_EXPIRY));
    }
    Ok(Response {
        request: object.need_text(&names::REQUEST_ID)?,
        grant: object.word_or_careful(&names::GRANT_TYPE, &words::GRANT)?,
        until_us: until_us.flatten(),
    })
}

pub(super) fn zone_set(top: &ObjectReader<'_>) -> Result<ZoneSet, Unreadable> {
    let set = top.object_or_empty(&names::ZONE_SET);
    let zones = set.all(&names::ZONES_OF_SET, zone)?.ok_or_else(|| set.missing(&names::ZONES_OF_SET))?;
    Ok(ZoneSet { id: set.need_text(&names::ZONE_SET_ID)?, map: set.need_text(&names::MAP)?, zones })
}

fn zone(object: &ObjectReader<'_>) -> Result<Zone, Unreadable> {
    let corner =
        |object: &ObjectReader<'_>| Ok((object.need_number(&names::X)?, object.need_number(&names::Y)?));
    let corners = object.all(&names::VERTICES, corner)?.filter(|corners| corners.len() >= 3);
    let kind = match object.word_or_careful(&names::ZONE_TYPE, &words::ZONE_WORD)? {
        ZoneWord::Blocked => ZoneKind::Blocked,
        ZoneWord::Release => ZoneKind::Release,
        ZoneWord::SpeedLimit => ZoneKind::SpeedLimit(object.need_number(&names::ZONE_SPEED)?),
    };
    Ok(Zone {
        id: object.need_text(&names::ZONE_ID)?,
        kind,
        corners: corners.ok_or_else(|| object.missing(&names::VERTICES))?,
    })
}

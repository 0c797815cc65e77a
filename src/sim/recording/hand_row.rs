//! Hands at work cells as recordings have them.
//!
//! Main type: [`HandsRow`]. Refuses: to round, since a recording must play again to the same digest.

use giveway_cell::{HandPoints, HandsSeen};
use giveway_floor::id::StationId;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Place;
use serde::{Deserialize, Serialize};

/// Wrist, palm, two finger tips: three numbers each.
type HandRow = [f64; 12];

/// Station, person, seen, head, left hand, right hand, where the head points, where the eyes look.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct HandsRow(
    u32,
    u32,
    i64,
    [f64; 3],
    Option<HandRow>,
    Option<HandRow>,
    #[serde(default)] Option<[f64; 3]>,
    #[serde(default)] Option<[f64; 3]>,
);

fn row(hand: &HandPoints) -> HandRow {
    let [tip, other] = hand.tips;
    let mut row = [0.0; 12];
    for (i, p) in [hand.wrist, hand.palm, tip, other].into_iter().enumerate() {
        row[3 * i..3 * i + 3].copy_from_slice(&[p.x, p.y, p.z]);
    }
    row
}

fn hand(row: HandRow) -> HandPoints {
    let at = |i: usize| Place::new(row[3 * i], row[3 * i + 1], row[3 * i + 2]);
    HandPoints { wrist: at(0), palm: at(1), tips: [at(2), at(3)] }
}

impl From<&HandsSeen> for HandsRow {
    fn from(s: &HandsSeen) -> HandsRow {
        let [left, right] = s.hands.map(|h| h.as_ref().map(row));
        let [facing, eyes] = [s.facing, s.eyes].map(|ray| ray.map(<[f64; 3]>::from));
        HandsRow(s.station.0, s.person, s.seen.0, [s.head.x, s.head.y, s.head.z], left, right, facing, eyes)
    }
}

impl From<HandsRow> for HandsSeen {
    fn from(HandsRow(station, person, seen, [x, y, z], left, right, facing, eyes): HandsRow) -> HandsSeen {
        HandsSeen {
            station: StationId(station),
            person,
            seen: Time(seen),
            head: Place::new(x, y, z),
            facing: facing.map(Into::into),
            eyes: eyes.map(Into::into),
            hands: [left.map(hand), right.map(hand)],
        }
    }
}

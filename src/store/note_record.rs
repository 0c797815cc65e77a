//! The journal's written form of notes that are recorded but change nothing.
//!
//! Main type: [`NoteRecord`]. Refuses: other facts.

use giveway_fleet::{FloorNote, ReplanCause};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};

/// The written form of a [`FloorNote`].
#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub(super) enum NoteRecord {
    Replanned { robot: u32, cause: String, of: Option<u64>, was: Vec<[i64; 2]>, now: Vec<[i64; 2]>, at: i64 },
    Goal { worker: u32, place: [i64; 2], percent: u8, at: i64 },
}

impl From<&FloorNote> for NoteRecord {
    fn from(note: &FloorNote) -> NoteRecord {
        let list = |spots: &[Spot]| spots.iter().map(|s| [s.x_mm, s.y_mm]).collect();
        match note {
            FloorNote::Replanned { robot, cause, was, now, at } => NoteRecord::Replanned {
                robot: robot.0,
                cause: cause.word().to_owned(),
                of: cause.number(),
                was: list(was),
                now: list(now),
                at: at.0,
            },
            FloorNote::Goal { worker, place, percent, at } => NoteRecord::Goal {
                worker: worker.0,
                place: [place.x_mm, place.y_mm],
                percent: *percent,
                at: at.0,
            },
        }
    }
}

impl From<NoteRecord> for FloorNote {
    fn from(record: NoteRecord) -> FloorNote {
        let spots = |list: Vec<[i64; 2]>| list.into_iter().map(|[x_mm, y_mm]| Spot { x_mm, y_mm }).collect();
        match record {
            NoteRecord::Replanned { robot, cause, of, was, now, at } => FloorNote::Replanned {
                robot: RobotId(robot),
                // A cause of a newer version has no name here.
                cause: ReplanCause::of(&cause, of).unwrap_or(ReplanCause::Obstruction),
                was: spots(was),
                now: spots(now),
                at: Time(at),
            },
            NoteRecord::Goal { worker, place: [x_mm, y_mm], percent, at } => FloorNote::Goal {
                worker: WorkerId(worker),
                place: Spot { x_mm, y_mm },
                percent,
                at: Time(at),
            },
        }
    }
}

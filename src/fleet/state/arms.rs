//! The robot arms at work cells: what each picks, what was seen of the picker beside it, and what is wrong with the
//! arm.
//!
//! Main types: `Arms`, `ArmPost`, [`ArmView`]. Lost at a restart: then an arm's lines are given to the hand or taken
//! anew. Refuses: to move anything; `requests` asks each arm what it does next.

use giveway_cell::arm::{ArmActivity, ArmKind, PickerSight, StationArm};
use giveway_floor::id::{JobId, StationId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeMap;

/// An arm with the line that it picks.
#[derive(Clone, Debug)]
pub struct ArmPost {
    /// The arm.
    pub arm: StationArm,
    /// What was seen of the picker lately.
    pub sight: PickerSight,
    /// The line on which the arm works: the job, and the line's number.
    pub line: Option<(JobId, usize)>,
    /// Since when the arm has been at the piece that it picks.
    pub piece_since: Time,
    /// Lines that the arm leaves to the hand: it found nothing there, or no way.
    pub left: Vec<(JobId, usize)>,
    /// When a hand was last in the opening, or about to be.
    pub hand_inside: Time,
}

/// An arm as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmView {
    /// What the arm does.
    pub activity: ArmActivity,
    /// The line that the arm picks: the job, and the line's number, from 0.
    pub line: Option<(JobId, usize)>,
    /// Whether the arm has not moved in the opening for a minute.
    pub is_stuck_inside: bool,
}

/// All arms of a building, by their stations.
#[derive(Clone, Debug, Default)]
pub struct Arms {
    all: BTreeMap<StationId, ArmPost>,
}

impl Arms {
    /// The arms of a building whose kinds are known. Nothing was heard of them yet.
    pub fn new(warehouse: &Warehouse) -> Arms {
        let post = |(id, station): (StationId, &giveway_floor::warehouse::Station)| {
            let mount = station.cell.as_ref()?.arm.as_ref()?;
            let Some(arm) = StationArm::new(id, mount) else {
                let (station, kind) = (&station.name, &mount.kind);
                tracing::warn!(station, kind, known = ?ArmKind::NAMES, "unknown kind of arm");
                return None;
            };
            let (sight, left, hand_inside) = (PickerSight::default(), Vec::new(), Time::ZERO);
            let (line, piece_since) = (None, Time::ZERO);
            Some((id, ArmPost { arm, sight, line, piece_since, left, hand_inside }))
        };
        Arms { all: warehouse.stations.pairs().filter_map(post).collect() }
    }

    /// Stations with an arm.
    pub fn stations(&self) -> Vec<StationId> {
        self.all.keys().copied().collect()
    }

    /// The arm at a station.
    pub fn post(&mut self, station: StationId) -> Option<&mut ArmPost> {
        self.all.get_mut(&station)
    }

    /// Whether an arm was in the opening of a station, or beyond it, when last heard of.
    pub fn is_inside(&self, station: StationId) -> bool {
        self.all.get(&station).is_some_and(|post| post.arm.is_inside())
    }

    /// Stations in whose opening an arm is.
    pub fn inside(&self) -> impl Iterator<Item = StationId> {
        self.all.iter().filter(|(_, post)| post.arm.is_inside()).map(|(station, _)| *station)
    }

    /// The arm at a station as it is shown.
    pub fn view(&self, station: StationId, now: Time) -> Option<ArmView> {
        let post = self.all.get(&station)?;
        let ArmPost { arm, line, .. } = post;
        Some(ArmView { activity: arm.activity(now), line: *line, is_stuck_inside: arm.is_stuck_inside(now) })
    }
}

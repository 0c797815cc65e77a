//! What recordings keep of a work cell.
//!
//! Main type: [`ShownCell`]. Refuses: to say which person's hands were seen.

use super::station::{ArmDto, CellWarningDto, EndsHeldDto};
use super::{LineDto, lines_dto};
use crate::dto::names::Names;
use giveway_fleet::StationView;
use giveway_floor::id::StationId;
use giveway_floor::time::Time;
use serde::Serialize;

/// A work cell at one time of the recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShownCell {
    /// The station.
    #[serde(skip)]
    pub station: String,
    /// The lines that are picked there; empty for a job without lines, and if no rack is picked from.
    lines: Vec<LineDto>,
    /// When the visit was expected to end, in seconds of the recording: 10th, 50th and 90th percentile. Whole seconds,
    /// so that the value does not change in every frame.
    ends_s: Option<[i64; 3]>,
    warnings: Vec<CellWarningDto>,
    arm: Option<ArmDto>,
    ends: EndsHeldDto,
}

impl Names<'_> {
    /// All work cells; seconds count from `zero`.
    pub fn shown_cells(&self, zero: Time) -> Vec<ShownCell> {
        let at_s = (self.view.now - zero).as_secs_f64();
        let shown = |(id, seen): (StationId, &StationView)| {
            let detail = self.station_detail(id);
            let ends =
                seen.left.filter(|_| seen.lines.is_some()).map(|left| [left.p10_s, left.p50_s, left.p90_s]);
            ShownCell {
                station: detail.station.id,
                lines: seen.lines.as_ref().map_or_else(Vec::new, |lines| lines_dto(lines, true)),
                ends_s: ends.map(|all| all.map(|s| (at_s + s).round() as i64)),
                warnings: detail.warnings,
                arm: detail.arm,
                ends: detail.ends,
            }
        };
        let cells = self.map.stations.pairs().filter(|(_, station)| station.cell.is_some());
        cells.filter_map(|(id, _)| Some((id, self.view.stations.get(id.0 as usize)?))).map(shown).collect()
    }
}

//! What is picked at a station, on the wire.
//!
//! Main types: [`LineDto`], [`StationDetailDto`]; [`new_lines`] reads lines that customers submit. Refuses: to know who
//! picks.

pub mod new_lines;

use super::dto::StationDto;
use super::text::round3;
use super::words::{LineStateDto, PickedByDto};
use crate::cell::{LineState, Lines, OrderLine, Progress, Remaining};
use serde::Serialize;
use utoipa::ToSchema;

/// A line: so many pieces from a slot of the rack into a tote of the station.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct LineDto {
    /// Its number in the visit, from 1.
    pub n: usize,
    /// From where: column `A` is the leftmost for the picker, row `1` the lowest.
    #[schema(example = "C3")]
    pub slot: String,
    /// How many pieces were ordered.
    pub quantity: u32,
    /// The name of the tote.
    #[schema(example = "B")]
    pub tote: String,
    /// What it is, in the customer's words.
    pub item: Option<String>,
    /// Who may pick it.
    pub by: PickedByDto,
    /// How far it is.
    pub state: LineStateDto,
    /// Pieces in the tote.
    pub done: u32,
}

/// What happens at a station.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct StationDetailDto {
    /// The station as lists have it.
    #[serde(flatten)]
    pub station: StationDto,
    /// Whether it has a work cell, at which order lines are picked.
    pub has_cell: bool,
    /// The names of its totes.
    pub totes: Vec<String>,
    /// The rack that stands there to be picked from; null if none does.
    pub visit: Option<VisitDto>,
}

/// A rack's time at a station.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct VisitDto {
    /// The job.
    #[schema(example = "j17")]
    pub job: String,
    /// The rack.
    pub rack: Option<String>,
    /// The robot under it.
    pub robot: String,
    /// When the rack came, RFC 3339.
    pub since: Option<String>,
    /// What is to be picked, in the order in which it is lit; nothing for a job without lines.
    pub lines: Vec<LineDto>,
    /// Pieces that are still to be picked.
    pub pieces_left: u32,
    /// How long it goes on from now, where the job has lines.
    pub expected_end: Option<ExpectedEndDto>,
}

/// How long a visit goes on from now, by how long lines took before; seconds.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ExpectedEndDto {
    /// One visit in ten ends sooner.
    pub p10: f64,
    /// Half of them do.
    pub p50: f64,
    /// Nine in ten do.
    pub p90: f64,
}

impl From<Remaining> for ExpectedEndDto {
    fn from(r: Remaining) -> ExpectedEndDto {
        ExpectedEndDto { p10: round3(r.p10_s), p50: round3(r.p50_s), p90: round3(r.p90_s) }
    }
}

/// What a change of a line came to.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct LineChangedDto {
    /// The job.
    #[schema(example = "j17")]
    pub job: String,
    /// The line's number in the visit, from 1.
    pub n: usize,
    /// How far it is now.
    pub state: LineStateDto,
    /// Pieces in the tote now.
    pub done: u32,
    /// False where it was so already, and nothing was counted again.
    pub changed: bool,
}

/// The lines of one visit. `is_on` says whether the rack stands at the station; else no line is lit.
pub fn lines_dto(lines: &Lines, is_on: bool) -> Vec<LineDto> {
    let dto = |(i, p): (usize, &Progress)| {
        let OrderLine { slot, quantity, tote, item, by } = &p.line;
        let state = if p.state == LineState::Lit && !is_on { LineState::Open } else { p.state };
        LineDto {
            n: i + 1,
            slot: slot.to_string(),
            quantity: *quantity,
            tote: tote.clone(),
            item: item.clone(),
            by: (*by).into(),
            state: state.into(),
            done: p.pieces,
        }
    };
    lines.all().iter().enumerate().map(dto).collect()
}

//! What is picked at a station, on the wire.
//!
//! Main type: [`LineDto`]; [`new_lines`] reads lines that customers submit, [`station`] shows what happens at one
//! station, [`shown`] what recordings keep. Refuses: to know the picker.

pub mod new_lines;
pub mod shown;
pub mod station;

use crate::wire::words::{LineStateDto, PickedByDto};
use giveway_cell::{LineProgress, LineState, Lines, OrderLine};
use serde::Serialize;
use utoipa::ToSchema;

/// An order line: a number of pieces to move from a slot of the rack into a tote of the station.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct LineDto {
    /// The line's number in the visit, from 1.
    pub n: usize,
    /// The slot to pick from: column `A` is the leftmost for the picker, row `1` the lowest.
    #[schema(example = "C3")]
    pub slot: String,
    /// How many pieces were ordered.
    pub quantity: u32,
    /// The name of the tote.
    #[schema(example = "B")]
    pub tote: String,
    /// The item, in the customer's words.
    pub item: Option<String>,
    /// Whether a hand or the robot arm may pick the line.
    pub by: PickedByDto,
    /// How far the picking of the line has come.
    pub state: LineStateDto,
    /// How many pieces are in the tote.
    pub done: u32,
}

/// The result of a change to a line.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct LineChangedDto {
    /// The job.
    #[schema(example = "j17")]
    pub job: String,
    /// The line's number in the visit, from 1.
    pub n: usize,
    /// How far the picking of the line has come now.
    pub state: LineStateDto,
    /// How many pieces are in the tote now.
    pub done: u32,
    /// Whether the request changed the line; false if the line was in this state already and no piece was counted
    /// again.
    pub changed: bool,
}

/// The lines of one visit. `is_on` says whether the rack stands at the station; if not, no line is lit.
pub fn lines_dto(lines: &Lines, is_on: bool) -> Vec<LineDto> {
    let dto = |(i, p): (usize, &LineProgress)| {
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

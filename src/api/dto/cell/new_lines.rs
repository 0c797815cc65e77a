//! Order lines as customers submit them.
//!
//! Main type: [`NewLine`], main function: [`read_lines`]. Refuses: lines that cannot be picked, and names the field.

use crate::wire::error::FieldError;
use crate::wire::words::PickedByDto;
use giveway_cell::{LineProblem, MOST_LINES, MOST_PIECES, OrderLine, PickedBy, problem};
use giveway_floor::id::{RackId, StationId};
use giveway_floor::text::sentence::{refusals, requests};
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::warehouse::Warehouse;
use serde::Deserialize;
use utoipa::ToSchema;

/// The longest name of an item, in characters.
const LONGEST_ITEM: usize = 200;

/// A number of pieces to move from a slot of the rack into a tote of the station.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewLine {
    /// The slot to pick from: column `A` is the leftmost for the picker, row `1` the lowest.
    #[schema(example = "C3")]
    pub slot: String,
    /// How many pieces, 1 to 10,000.
    #[schema(minimum = 1, maximum = 10000)]
    pub quantity: i64,
    /// The name of a tote of the station.
    #[schema(example = "B")]
    pub tote: String,
    /// The item, in your words, up to 200 characters.
    #[schema(example = "M6 bolts", max_length = 200)]
    pub item: Option<String>,
    /// Whether a hand or the robot arm may pick the line; `either` if absent.
    pub by: Option<PickedByDto>,
}

/// Reads the lines of one visit; reports each wrong field. `field` is the path of the list in the request.
pub fn read_lines(field: &str, lines: &[NewLine], errors: &mut Vec<FieldError>) -> Option<Vec<OrderLine>> {
    if lines.len() > MOST_LINES {
        errors.push(FieldError::new(field, describe(LineProblem::TooMany, None)));
        return None;
    }
    let before = errors.len();
    let read = |(i, line): (usize, &NewLine)| read_line(&format!("{field}[{i}]"), line, errors);
    let read: Vec<_> = lines.iter().enumerate().filter_map(read).collect();
    (errors.len() == before).then_some(read)
}

fn read_line(field: &str, line: &NewLine, errors: &mut Vec<FieldError>) -> Option<OrderLine> {
    let mut wrong =
        |name: &str, detail: Sentence| errors.push(FieldError::new(format!("{field}.{name}"), detail));
    let slot = line.slot.parse().map_err(|e| wrong("slot", requests::malformed(format!("{e}")))).ok();
    let quantity = u32::try_from(line.quantity).ok().filter(|n| (1..=MOST_PIECES).contains(n));
    if quantity.is_none() {
        wrong("quantity", describe(LineProblem::Quantity, None));
    }
    let fits = |text: &str| {
        (1..=LONGEST_ITEM).contains(&text.chars().count()) && !text.chars().any(char::is_control)
    };
    if line.item.as_deref().is_some_and(|text| !fits(text)) {
        wrong("item", requests::characters_without_line_breaks(LONGEST_ITEM));
        return None;
    }
    let by = line.by.map_or(PickedBy::default(), PickedBy::from);
    Some(OrderLine { slot: slot?, quantity: quantity?, tote: line.tote.clone(), item: line.item.clone(), by })
}

/// The problem of lines that are to be picked from a rack at a station, if there is one.
pub fn check_lines(
    field: &str,
    map: &Warehouse,
    (rack, station): (RackId, StationId),
    lines: &[OrderLine],
) -> Option<FieldError> {
    let (n, problem) = problem(map, rack, station, lines)?;
    let names = LineNames { map, rack, station, line: lines.get(n) };
    Some(FieldError::new(field_of(field, n, problem), describe(problem, Some(names))))
}

/// The path of the field that causes the problem.
pub fn field_of(field: &str, n: usize, problem: LineProblem) -> String {
    match problem {
        LineProblem::UnknownSlot | LineProblem::Twice(_) => format!("{field}[{n}].slot"),
        LineProblem::UnknownTote => format!("{field}[{n}].tote"),
        LineProblem::Quantity => format!("{field}[{n}].quantity"),
        LineProblem::NoArm => format!("{field}[{n}].by"),
        LineProblem::NoCell | LineProblem::NoSlots | LineProblem::TooMany => field.to_owned(),
    }
}

/// The things that a problem names.
#[derive(Clone, Copy)]
pub struct LineNames<'a> {
    /// The map, for names.
    pub map: &'a Warehouse,
    /// The rack.
    pub rack: RackId,
    /// The station.
    pub station: StationId,
    /// The line.
    pub line: Option<&'a OrderLine>,
}

/// A problem in words, with names where they are known.
pub fn describe(problem: LineProblem, names: Option<LineNames<'_>>) -> Sentence {
    let rack = || match names {
        Some(n) => SentenceArg::from(&n.map.racks[n.rack].name),
        None => refusals::this_rack().into(),
    };
    let station = || match names {
        Some(n) => SentenceArg::from(&n.map.stations[n.station].name),
        None => refusals::this_station().into(),
    };
    let line = names.and_then(|n| n.line);
    match problem {
        LineProblem::NoCell => refusals::no_work_cell(station()),
        LineProblem::NoSlots => refusals::no_slots_known(rack()),
        LineProblem::UnknownSlot => match line {
            Some(line) => refusals::no_such_slot(rack(), line.slot.to_string()),
            None => refusals::slot_unknown(rack()),
        },
        LineProblem::UnknownTote => match (line, names) {
            (Some(line), Some(n)) => {
                let cell = n.map.stations[n.station].cell.as_ref();
                let totes: Vec<_> = cell.iter().flat_map(|c| &c.totes).map(|t| t.name.as_str()).collect();
                refusals::no_such_tote(station(), &line.tote, totes)
            }
            _ => refusals::tote_unknown(station()),
        },
        LineProblem::Quantity => refusals::pieces_out_of_range(MOST_PIECES),
        LineProblem::Twice(first) => refusals::line_twice(first + 1),
        LineProblem::NoArm => refusals::no_arm(station()),
        LineProblem::TooMany => refusals::too_many_lines(MOST_LINES),
    }
}

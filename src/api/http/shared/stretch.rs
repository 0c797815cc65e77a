//! The period that a request asks about.
//!
//! Main function: [`stretch`]. Refuses: periods that end before they begin.

use crate::state::api::Api;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{read_end, read_time};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::{Span, Time};

/// The length of the period if the request gives no beginning.
const HOUR: Span = Span::from_secs(3600);

/// Beginning and end of the period; the last hour if the request gives neither.
pub fn stretch(api: &Api, from: Option<&str>, to: Option<&str>) -> Result<(Time, Time), Problem> {
    let mut errors = Vec::new();
    let (from, to) = (read_time("from", from, &mut errors), read_end("to", to, &mut errors));
    // A recording has its own time. Events of this very moment belong to the period.
    let to = to.unwrap_or_else(|| api.moment().view.now + Span(1));
    let from = from.unwrap_or(to - HOUR);
    if errors.is_empty() && from >= to {
        errors.push(FieldError::new("from", requests::must_be_before_to()));
    }
    if errors.is_empty() { Ok((from, to)) } else { Err(Problem::invalid(errors)) }
}

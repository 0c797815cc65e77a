//! What the durable lists say about a span of time, for reports.
//!
//! Main type: [`ShiftRows`]. Refuses: figures by person.

use super::rows::JobRow;
use crate::{Encounter, JobState};
use giveway_floor::id::StationId;
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// A job that ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EndedJob {
    /// The word for the kind of the job.
    pub kind: String,
    /// The word for the state in which it ended.
    pub state: String,
    /// The station that the job was for.
    pub station: Option<StationId>,
    /// When the job was accepted.
    pub accepted: Time,
    /// The deadline of the job.
    pub deadline: Option<Time>,
    /// When the job's rack came to the station.
    pub arrived: Option<Time>,
    /// When the job ended.
    pub ended: Time,
}

/// What the lists say about the time from one moment to another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShiftRows {
    /// Jobs that ended in that time.
    pub ended: Vec<EndedJob>,
    /// How long picking went on at each station in that time.
    pub picking: BTreeMap<StationId, Span>,
    /// Jobs whose deadline passed in that time and that were not over at its end.
    pub overdue: u64,
    /// Assignments that workers completed.
    pub assignments_done: u64,
    /// Encounters that began.
    pub encounters: Vec<Encounter>,
}

impl ShiftRows {
    /// Takes in a job as listed, if it says anything about the time from `from` to `to`; what is not over lasts until
    /// `now`.
    pub fn note(&mut self, row: &JobRow, (from, to): (Time, Time), now: Time) {
        let request = &row.job.request;
        let station = request.kind.station();
        let within = |t: Time| from <= t && t < to;
        let picks = matches!(row.job.state, JobState::Picking { .. });
        if let (Some(station), Some(arrived)) = (station, row.times.arrived)
            && (picks || row.times.ended.is_some())
        {
            let picked = row.times.ended.unwrap_or(now).min(to) - arrived.max(from);
            if picked > Span::ZERO {
                *self.picking.entry(station).or_default() += picked;
            }
        }
        if row.job.accepted < to
            && request.deadline.is_some_and(within)
            && row.times.ended.is_none_or(|ended| ended >= to)
        {
            self.overdue += 1;
        }
        if let Some(ended) = row.times.ended.filter(|t| within(*t)) {
            self.ended.push(EndedJob {
                kind: request.kind.word().into(),
                state: row.job.state.word().into(),
                station,
                accepted: row.job.accepted,
                deadline: request.deadline,
                arrived: row.times.arrived,
                ended,
            });
        }
    }
}

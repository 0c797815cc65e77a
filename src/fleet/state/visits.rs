//! What is kept in mind about visits at work cells: how long lines take, and since when the one that is lit has been.
//!
//! Main type: [`Visits`]. Lost at a restart: the lit line begins anew then, and the pace is learned again. Refuses: to
//! promise anything.

use crate::cell::{LineChange, LineOutcome, LineState, PickPace, Remaining};
use crate::fleet::state::fact::Fact;
use crate::fleet::state::job::{Job, JobKind, JobState};
use crate::fleet::state::ledger::Ledger;
use crate::id::{JobId, StationId};
use crate::time::{Span, Time};
use std::collections::BTreeMap;

/// A visit that is on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct VisitClock {
    /// When the rack came, unless that was before the program started.
    since: Option<Time>,
    /// When the line that is lit was lit.
    lit: Time,
    /// When it had its last piece, or was lit.
    last: Time,
    /// Whether the program has seen the line from its beginning.
    whole: bool,
    /// The line that was done last, which nothing has been learned from yet.
    done: Option<DoneLine>,
}

/// A line that is done, and how long it took.
#[derive(Clone, Copy, Debug, PartialEq)]
struct DoneLine {
    station: StationId,
    pieces: u32,
    seconds: f64,
    at: Time,
}

impl VisitClock {
    fn of(since: Option<Time>, now: Time) -> VisitClock {
        VisitClock { since, lit: now, last: now, whole: since.is_some(), done: None }
    }
}

/// What is kept in mind about visits.
#[derive(Clone, Debug, Default)]
pub(in crate::fleet) struct Visits {
    pace: PickPace,
    clocks: BTreeMap<JobId, VisitClock>,
}

/// The station at which a job's rack is wanted, with how long the customer said that it stays.
fn station_of(job: &Job) -> Option<(StationId, Option<f64>)> {
    match job.request.kind {
        JobKind::Deliver { station, pick, .. } => Some((station, pick.map(Span::as_secs_f64))),
        _ => None,
    }
}

impl Visits {
    /// Takes a fact in, before the ledger does.
    pub fn note(&mut self, ledger: &Ledger, fact: &Fact) {
        match fact {
            Fact::Progressed { job, state: JobState::Picking { .. }, at, .. } => {
                self.clocks.insert(*job, VisitClock::of(Some(*at), *at));
            }
            Fact::Progressed { job, .. } | Fact::Served { job, .. } => {
                let done = self.clocks.remove(job).and_then(|clock| clock.done);
                self.learn(done);
            }
            Fact::LineChanged { job, line, change, at } => {
                self.note_line(ledger, *job, (*line, *change), *at)
            }
            _ => {}
        }
    }

    /// A visit that was on when the program started.
    pub fn begin(&mut self, id: JobId, now: Time) {
        self.clocks.entry(id).or_insert(VisitClock::of(None, now));
    }

    fn learn(&mut self, done: Option<DoneLine>) {
        if let Some(DoneLine { station, pieces, seconds, .. }) = done {
            self.pace.learn(station, pieces, seconds);
        }
    }

    /// A line that was lit all the time teaches how long lines take, once it is done by itself: where several are
    /// confirmed at once, nobody knows what each has taken.
    fn note_line(&mut self, ledger: &Ledger, id: JobId, (n, change): (usize, LineChange), at: Time) {
        let Some(job) = ledger.jobs.get(&id) else { return };
        let (Some((station, _)), Some(lines)) = (station_of(job), job.lines_now()) else { return };
        let mut after = lines.clone();
        if after.change(n, change) != Ok(LineOutcome::Changed) {
            return;
        }
        let clock = self.clocks.entry(id).or_insert(VisitClock::of(None, at));
        let (before, now) = (&lines.all()[n], &after.all()[n]);
        let is_alone = clock.done.is_none_or(|d| d.at != at);
        let is_done = before.state == LineState::Lit && now.state == LineState::Done;
        let (pieces, seconds) = (before.line.quantity, (at - clock.lit).as_secs_f64());
        let done = (is_alone && is_done && clock.whole).then_some(DoneLine { station, pieces, seconds, at });
        let earlier = std::mem::replace(&mut clock.done, done).filter(|_| is_alone);
        clock.last = at;
        if lines.lit() != after.lit() {
            (clock.lit, clock.whole) = (at, is_alone);
        }
        self.learn(earlier);
    }

    /// When the rack of a job came to the station where it is, unless that was before the program started.
    pub fn since(&self, id: JobId) -> Option<Time> {
        self.clocks.get(&id)?.since
    }

    /// How long a robot with a job's rack is planned to stay at the station where it is wanted now; nothing for a job
    /// without lines.
    pub fn stay(&self, job: &Job) -> Option<Span> {
        let ((station, said_s), lines) = (station_of(job)?, job.lines_now()?);
        Some(Span::from_secs_f64(self.pace.remaining(station, lines, 0.0, said_s).mean_s))
    }

    /// How long a job's rack stays at the station where it is wanted now, from now on if it is there; nothing for a job
    /// without lines.
    pub fn remaining(&self, id: JobId, job: &Job, now: Time) -> Option<Remaining> {
        let ((station, said_s), lines) = (station_of(job)?, job.lines_now()?);
        let lit_s = self.clocks.get(&id).map_or(0.0, |clock| (now - clock.last).as_secs_f64());
        Some(self.pace.remaining(station, lines, lit_s.max(0.0), said_s))
    }
}

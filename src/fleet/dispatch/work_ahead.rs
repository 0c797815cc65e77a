//! How much work is on its way to each work cell, in seconds: which station needs the next rack most?
//!
//! Main function: `lack_of_work`. A rack with one screw and a rack with five boxes are not the same to a station.
//! Refuses: to count racks if lines say how long each takes.

use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::job_kind::JobKind;
use crate::state::storage::along_axes;
use giveway_floor::id::{IdVec, JobId, NodeId, StationId};
use giveway_floor::time::{Span, Time};

/// Time from the end of a visit until the next rack stands there, seconds.
const TURNOVER_S: f64 = 6.5;
/// Time from the assignment of a job until its rack is lifted, seconds.
const FETCH_S: f64 = 20.0;
impl Floor<'_> {
    /// For each work cell, how many seconds of work are there or on their way; nothing if lines are not counted.
    pub(super) fn work_ahead(&self, now: Time) -> Option<IdVec<StationId, f64>> {
        let has_cell = self.warehouse().stations.iter().any(|s| s.cell.is_some());
        if !has_cell || !self.settings.flow.counts_lines() {
            return None;
        }
        let mut work = IdVec::filled(0.0, self.warehouse().stations.len());
        for id in self.ledger.robots.iter().filter_map(|r| r.task.job()) {
            let Some(job) = self.ledger.jobs.get(&id) else { continue };
            let JobKind::Deliver { station, .. } = job.request.kind else { continue };
            let left = match job.state {
                JobState::Picking { .. } => {
                    self.visits.remaining(id, job, self.ends_out(job), now).map(|left| left.mean_s)
                }
                _ => self.visits.stay(job).map(Span::as_secs_f64),
            };
            work[station] +=
                left.unwrap_or(self.warehouse().stations[station].pick.as_secs_f64()) + TURNOVER_S;
        }
        Some(work)
    }

    /// Cost of a job, milliseconds: how long its rack, which stands on `rack`, would wait at its work cell for what is
    /// ahead of it; negative if the picker would wait for the rack, since the picker's time is worth more. Nothing for
    /// jobs to other places.
    pub(super) fn lack_of_work(
        &self,
        job: JobId,
        rack: NodeId,
        work: &Option<IdVec<StationId, f64>>,
    ) -> Option<i64> {
        let work = work.as_ref()?;
        let JobKind::Deliver { station, .. } = self.ledger.jobs[&job].request.kind else { return None };
        let place = &self.warehouse().stations[station];
        place.cell.as_ref()?;
        let at = |n: NodeId| self.warehouse().nodes[n].at;
        let kind = self.ledger.kinds().first().expect("there is a kind of robots");
        let carry_s = along_axes(at(rack), at(place.node)) / kind.kinematics.speed_loaded_mps;
        let waits_s = work[station] - FETCH_S - carry_s;
        let price = if waits_s < 0.0 { self.settings.worker_price } else { 1.0 };
        Some((1000.0 * price * waits_s) as i64)
    }
}

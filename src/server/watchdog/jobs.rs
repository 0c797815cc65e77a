//! Whether jobs get on: something is delivered, and each job that waits for long can say what for.
//!
//! Main type: [`JobWatch`]. Where many jobs wait, it looks at some of them each time. Refuses: to compare reasons with
//! the floor, which only a simulation knows; that is a law there.

use crate::fleet::{Fleet, JobState, View};
use crate::id::JobId;
use crate::sim::laws::{Deliveries, OVERDUE};
use crate::time::{Span, Time};
use std::collections::BTreeMap;

/// So many jobs are looked at each time.
const AT_ONCE: usize = 200;
/// A job that has had no reason for so long is an alarm: what it waited for may just have ended.
const WITHOUT_REASON: Span = Span::from_secs(60);

/// What is remembered of jobs from look to look.
#[derive(Debug, Default)]
pub(super) struct JobWatch {
    deliveries: Deliveries,
    /// The last job that was looked at.
    cursor: Option<JobId>,
    /// Jobs that wait without a reason, since when.
    suspects: BTreeMap<JobId, Time>,
}

impl JobWatch {
    /// For how long nothing has been delivered although jobs wait and robots can drive.
    pub fn undelivered(&mut self, fleet: &Fleet, view: &View) -> Span {
        self.deliveries.note(fleet, view)
    }

    /// Jobs that have waited for long and cannot say what for.
    pub fn without_reason(&mut self, fleet: &Fleet, view: &View) -> Vec<JobId> {
        let (jobs, now) = (&fleet.ledger().jobs, view.now);
        let waits_in_vain = |id: &JobId| {
            let waiting = jobs.get(id).filter(|j| j.state == JobState::Waiting && now - j.accepted > OVERDUE);
            waiting.is_some_and(|job| view.why_job(fleet.warehouse(), *id, job).is_none())
        };
        self.suspects.retain(|id, _| waits_in_vain(id));
        let from = self.cursor.map_or(JobId(0), |last| JobId(last.0 + 1));
        let some: Vec<JobId> = jobs.range(from..).map(|(id, _)| *id).take(AT_ONCE).collect();
        self.cursor = some.last().copied().filter(|_| some.len() == AT_ONCE);
        for id in some.into_iter().filter(waits_in_vain) {
            self.suspects.entry(id).or_insert(now);
        }
        let long = self.suspects.iter().filter(|(_, since)| now - **since >= WITHOUT_REASON);
        long.map(|(id, _)| *id).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::{Fact, JobKind, JobRequest, Settings};
    use crate::id::{BodyId, RackId, StationId};
    use crate::warehouse::lab;
    use std::sync::Arc;

    #[test]
    fn jobs_that_wait_for_nothing_are_found_however_many_wait_for_something() {
        let last = 3 * AT_ONCE as u64;
        let facts = (1..=last).map(|n| {
            let (rack, station) = (RackId(u32::from(n < last)), StationId(0));
            let kind = JobKind::Deliver { rack, station, pick: None };
            let request = JobRequest { kind, priority: 0, deadline: None, after: vec![], key: None };
            Fact::Accepted { job: JobId(n), request, at: Time(1) }
        });
        let fleet = Fleet::restore(Arc::new(lab()), Settings::default(), facts);
        let mut watch = JobWatch::default();
        let mut look = |s: i64, free: bool| {
            let mut view = fleet.view(Time(s * 1_000_000));
            // The lower rack is closed off; a robot is free for the other one, or none is.
            let closed = |node| crate::fleet::RackAt::Stored(node) == fleet.ledger().racks[RackId(1)];
            view.closing.extend(fleet.warehouse().nodes.ids().filter(|n| closed(*n)));
            view.free.clear();
            view.free.extend(free.then_some((BodyId(0), 1)));
            watch.without_reason(&fleet, &view)
        };
        let all: Vec<usize> = (0..30).map(|i| look(i * 5, true).len()).collect();
        assert!(all.iter().all(|n| *n == 0), "none waits for long yet: {all:?}");
        let found: Vec<Vec<JobId>> = (140..180).map(|i| look(i * 5, true)).collect();
        let after = found.iter().position(|jobs| *jobs == [JobId(last)]).expect("it is found");
        assert!(after * 5 >= 60, "not at once: {after}");
        assert_eq!(look(905, false), [], "there is a reason: no robot is free");
    }
}

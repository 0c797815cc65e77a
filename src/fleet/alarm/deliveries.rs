//! Whether the floor delivers: while jobs wait, and robots can drive that no job sends elsewhere by name, something is
//! delivered within a stated time.
//!
//! Main type: [`Deliveries`], for simulations and for the server's alarms. Refuses: to say why nothing is delivered.

use crate::{Fleet, JobKind, JobState, Task, View, Why};
use giveway_floor::time::{Span, Time};

/// Since when nothing was delivered although something could have been.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deliveries {
    /// How many deliveries there were, and since when there have been no more; nothing before the first look.
    last: Option<(u64, Time)>,
}

impl Deliveries {
    /// For how long nothing has been delivered although jobs wait, no person picks, and robots can drive that no job
    /// sends elsewhere by name.
    pub fn note(&mut self, fleet: &Fleet, view: &View) -> Span {
        let ledger = fleet.ledger();
        let delivered = ledger.counts.robot_deliveries;
        let paused = |k: &JobKind| match k {
            JobKind::Deliver { station, .. } => ledger.paused_stations.contains_key(station),
            _ => true,
        };
        let is_wanted = || {
            (ledger.jobs.values()).any(|j| {
                !paused(&j.request.kind) && !j.request.after.iter().any(|a| ledger.jobs.contains_key(a))
            })
        };
        let picks = || ledger.jobs.values().any(|j| matches!(j.state, JobState::Picking { .. }));
        let drives = |why: Option<Why>| !why.is_some_and(Why::is_by_itself);
        let is_sent = |task: Task| matches!(task, Task::Move { job: Some(_), .. });
        let can = || view.robots.iter().any(|r| drives(r.why) && r.battery >= r.critical && !is_sent(r.task));
        let since = self.last.filter(|(before, _)| *before == delivered && is_wanted() && !picks() && can());
        let since = since.map_or(view.now, |(_, since)| since);
        self.last = Some((delivered, since));
        view.now - since
    }

    /// Begins anew, so that the same time without deliveries is not reported twice.
    pub fn restart(&mut self, now: Time) {
        self.last = self.last.map(|(delivered, _)| (delivered, now));
    }
}

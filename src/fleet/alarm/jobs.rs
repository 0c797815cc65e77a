//! Whether jobs make progress: something is delivered, each job that waits for long has a reason, deadlines are kept,
//! and stations get racks.
//!
//! Main type: [`JobWatch`]. If many jobs wait, it looks at some of them each time. Refuses: to compare reasons with the
//! floor, which only a simulation knows; that is a law there.

use super::condition::{AlarmCondition, AlarmSubject, SubjectKind, some_of};
use super::deliveries::Deliveries;
use super::kind::AlarmKind;
use crate::{Fleet, JobState, JobWhy, View};
use giveway_floor::id::{Dense, JobId, StationId};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// How many jobs are looked at each time.
const AT_ONCE: usize = 500;
/// A job that has waited for less need not have a reason.
const OVERDUE: Span = Span::from_secs(600);
/// A job that has had no reason for this long is stuck: what it waited for may only just have ended.
const WITHOUT_REASON: Span = Span::from_secs(60);
/// If nothing has been delivered for this long, there is an alarm.
const DELIVERS: Span = Span::from_secs(1200);
/// If a station has got no rack for this long although jobs wait for it, there is an alarm.
const STARVED: Span = Span::from_secs(300);
/// How long a job is taken to need once a robot has it, before any was measured.
const USUAL: Span = Span::from_secs(120);
/// How many of the last jobs are measured.
const MEASURED: usize = 50;

/// What is remembered of jobs from look to look.
#[derive(Clone, Debug, Default)]
pub(super) struct JobWatch {
    deliveries: Deliveries,
    /// The last job that was looked at.
    cursor: Option<JobId>,
    /// Jobs that wait without a reason, and since when.
    suspects: BTreeMap<JobId, Time>,
    /// Jobs that no robot on this floor can do.
    without_kind: BTreeSet<JobId>,
    /// Jobs with a deadline.
    dated: BTreeSet<JobId>,
    /// Jobs that robots have, and since when.
    begun: BTreeMap<JobId, Time>,
    /// How long the last jobs took once a robot had them.
    took: Vec<Span>,
    /// Stations without racks although jobs wait for them: since when, and one of these jobs.
    starved: BTreeMap<StationId, (Time, JobId)>,
}

impl JobWatch {
    /// What is wrong with jobs.
    pub fn conditions(&mut self, fleet: &Fleet, view: &View) -> Vec<AlarmCondition> {
        let some = self.slice(fleet);
        self.measure(fleet, view);
        let mut found = Vec::new();
        found.extend(self.undelivered(fleet, view));
        found.extend(self.stuck(fleet, view, &some));
        found.extend(self.deadlines(fleet, view, &some));
        found.extend(self.starved(fleet, view, &some));
        found
    }

    /// The next jobs to be looked at.
    fn slice(&mut self, fleet: &Fleet) -> Vec<JobId> {
        let from = self.cursor.map_or(JobId(0), |last| JobId(last.0 + 1));
        let some: Vec<JobId> = fleet.ledger().jobs.range(from..).map(|(id, _)| *id).take(AT_ONCE).collect();
        self.cursor = some.last().copied().filter(|_| some.len() == AT_ONCE);
        some
    }

    /// Notes how long jobs take once a robot has them.
    fn measure(&mut self, fleet: &Fleet, view: &View) {
        let jobs = &fleet.ledger().jobs;
        let ended: Vec<JobId> = self.begun.keys().filter(|id| !jobs.contains_key(id)).copied().collect();
        for id in ended {
            let began = self.begun.remove(&id).expect("just seen");
            if self.took.len() == MEASURED {
                self.took.remove(0);
            }
            self.took.push(view.now - began);
        }
        // A robot may have given its job back.
        self.begun.retain(|id, _| jobs.get(id).is_some_and(|j| j.state.robot().is_some()));
        for id in view.robots.iter().filter_map(|r| r.job) {
            self.begun.entry(id).or_insert(view.now);
        }
    }

    /// How long a job usually takes: the median of the last ones.
    fn usual(&self) -> Span {
        let mut took = self.took.clone();
        took.sort_unstable();
        took.get(took.len() / 2).copied().unwrap_or(USUAL)
    }

    fn undelivered(&mut self, fleet: &Fleet, view: &View) -> Option<AlarmCondition> {
        let drought = self.deliveries.note(fleet, view);
        let said = alarms::no_deliveries();
        let one = AlarmCondition::new(AlarmKind::NoDeliveries, AlarmSubject::floor(), said);
        (drought > DELIVERS).then(|| AlarmCondition { since: Some(view.now - drought), ..one })
    }

    /// Jobs that have waited for long without a reason, and jobs that no robot can do.
    fn stuck(&mut self, fleet: &Fleet, view: &View, some: &[JobId]) -> Option<AlarmCondition> {
        let (jobs, now) = (&fleet.ledger().jobs, view.now);
        let reason = |id: &JobId| view.why_job(fleet.warehouse(), *id, &jobs[id]);
        let waits = |id: &JobId, long: Span| {
            jobs.get(id).is_some_and(|j| j.state == JobState::Waiting && now - j.accepted > long)
        };
        let in_vain = |id: &JobId| waits(id, OVERDUE) && reason(id).is_none();
        let impossible = |id: &JobId| waits(id, WITHOUT_REASON) && reason(id) == Some(JobWhy::NoKind);
        self.suspects.retain(|id, _| in_vain(id));
        for id in some.iter().filter(|id| in_vain(id)) {
            self.suspects.entry(*id).or_insert(now);
        }
        self.without_kind.retain(impossible);
        self.without_kind.extend(some.iter().copied().filter(impossible));
        let without_reason: Vec<JobId> = self
            .suspects
            .iter()
            .filter(|(_, since)| now - **since >= WITHOUT_REASON)
            .map(|(id, _)| *id)
            .collect();
        let impossible: Vec<JobId> = self.without_kind.iter().copied().collect();
        let first = without_reason.first().or(impossible.first())?;
        let said = match (without_reason.is_empty(), impossible.is_empty()) {
            (false, false) => {
                let (in_vain, impossible) = (named(&without_reason), named(&impossible));
                alarms::jobs_wait_in_vain_or_impossible(some_of(&in_vain), some_of(&impossible))
            }
            (_, true) => alarms::jobs_wait_in_vain(some_of(&named(&without_reason))),
            (true, false) => alarms::jobs_impossible(some_of(&named(&impossible))),
        };
        Some(AlarmCondition::new(AlarmKind::JobStuck, subject(*first), said))
    }

    fn deadlines(&mut self, fleet: &Fleet, view: &View, some: &[JobId]) -> Vec<AlarmCondition> {
        let jobs = &fleet.ledger().jobs;
        let deadline = |id: &JobId| jobs.get(id).and_then(|job| job.request.deadline);
        self.dated.retain(|id| deadline(id).is_some());
        self.dated.extend(some.iter().copied().filter(|id| deadline(id).is_some()));
        let usual = self.usual();
        let (mut missed, mut at_risk) = (Vec::new(), Vec::new());
        for id in &self.dated {
            let left = deadline(id).map_or(Span::MAX, |due| due - view.now);
            let done = self.begun.get(id).map_or(Span::ZERO, |since| view.now - *since);
            if left < Span::ZERO {
                missed.push(*id);
            } else if left < usual - done {
                at_risk.push(*id);
            }
        }
        let one = |kind, ids: &[JobId], said: Sentence| {
            ids.first().map(|first| AlarmCondition::new(kind, subject(*first), said))
        };
        let late = alarms::deadline_missed(some_of(&named(&missed)));
        let soon = alarms::deadline_at_risk(some_of(&named(&at_risk)));
        let late = one(AlarmKind::DeadlineMissed, &missed, late);
        late.into_iter().chain(one(AlarmKind::DeadlineAtRisk, &at_risk, soon)).collect()
    }

    /// Stations for which jobs wait while no rack is there or on its way.
    fn starved(&mut self, fleet: &Fleet, view: &View, some: &[JobId]) -> Vec<AlarmCondition> {
        let (jobs, map) = (&fleet.ledger().jobs, fleet.warehouse());
        let station = |id: &JobId| jobs.get(id).and_then(|j| j.request.kind.station());
        let served: BTreeSet<StationId> =
            view.robots.iter().filter_map(|r| r.job).filter_map(|id| station(&id)).collect();
        let is_empty = |s: StationId| {
            let row = &view.stations[s.ix()];
            row.robot.is_none() && row.queue.is_empty() && row.paused.is_none() && !served.contains(&s)
        };
        // Robots at work elsewhere are no fault, and robots in the way have causes of their own.
        let waits = |id: &JobId| {
            jobs.get(id).filter(|j| j.state == JobState::Waiting).is_some_and(|job| {
                let why = view.why_job(map, *id, job);
                matches!(why, None | Some(JobWhy::ClosedOff | JobWhy::StationFull(_) | JobWhy::RacksWait(..)))
            })
        };
        self.starved.retain(|s, (_, id)| is_empty(*s) && waits(id));
        for (id, s) in some.iter().filter_map(|id| Some((*id, station(id)?))) {
            if !self.starved.contains_key(&s) && is_empty(s) && waits(&id) {
                self.starved.insert(s, (view.now, id));
            }
        }
        let long = self.starved.iter().filter(|(_, (since, _))| view.now - *since > STARVED);
        let condition = |(s, (since, id)): (&StationId, &(Time, JobId))| {
            let name = &map.stations[*s].name;
            let said = alarms::station_starved(name, format!("j{}", id.0));
            let subject = AlarmSubject::new(SubjectKind::Station, name.clone());
            let one = AlarmCondition::new(AlarmKind::StationStarved, subject, said);
            AlarmCondition { since: Some(*since), ..one }.at(map.nodes[map.stations[*s].node].at)
        };
        long.map(condition).collect()
    }
}

fn named(ids: &[JobId]) -> Vec<String> {
    ids.iter().map(|id| format!("j{}", id.0)).collect()
}

fn subject(id: JobId) -> AlarmSubject {
    AlarmSubject::new(SubjectKind::Job, format!("j{}", id.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fact, JobFact, JobKind, JobRequest, Settings};
    use giveway_floor::id::{BodyId, RackId, StationId};
    use giveway_floor::warehouse::lab;
    use std::sync::Arc;

    #[test]
    fn jobs_that_wait_for_nothing_are_found_however_many_wait_for_something() {
        let last = 3 * AT_ONCE as u64;
        let facts = (1..=last).map(|n| {
            let (rack, station) = (RackId(u32::from(n < last)), StationId(0));
            let kind = JobKind::Deliver { rack, station, pick: None };
            let request = JobRequest::new(kind);
            Fact::Job(JobFact::Accepted { job: JobId(n), request, at: Time(1) })
        });
        let fleet = Fleet::restore(Arc::new(lab()), Settings::default(), facts);
        let mut watch = JobWatch::default();
        let mut look = |s: i64, free: bool| {
            let mut view = fleet.view(Time(s * 1_000_000));
            // The lower rack is closed off; a robot is free for the other one, or none is.
            let closed = |node| crate::RackAt::Stored(node) == fleet.ledger().racks[RackId(1)];
            view.closing.extend(fleet.warehouse().nodes.ids().filter(|n| closed(*n)));
            view.free.clear();
            view.free.extend(free.then_some((BodyId(0), 1)));
            let some = watch.slice(&fleet);
            watch.stuck(&fleet, &view, &some).map(|c| c.text.to_string())
        };
        let all: Vec<_> = (0..30).filter_map(|i| look(i * 5, true)).collect();
        assert_eq!(all, [""; 0], "none waits for long yet");
        let found: Vec<Option<String>> = (140..180).map(|i| look(i * 5, true)).collect();
        let said = Some(format!("jobs wait, and nothing keeps them: j{last}."));
        let after = found.iter().position(|text| *text == said).expect("it is found");
        assert!(after * 5 >= 60, "not at once: {after}");
        assert_eq!(look(905, false), None, "there is a reason: no robot is free");
    }
}

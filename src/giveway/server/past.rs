//! The lists of a recording: its jobs, assignments and encounters, kept in memory.
//!
//! Main type: [`PastLists`]. Refuses: a database.

use giveway_api::{Later, Records};
use giveway_fleet::alarm::{Alarm, AlarmQuery};
use giveway_fleet::{
    Assignment, AssignmentFact, AssignmentQuery, AssignmentRow, AssignmentState, EncounterFact,
    EncounterQuery, EncounterRow, EventKind, Fact, FloorEvent, GoneNames, Job, JobFact, JobQuery, JobRow,
    JobTimes, Listed, RobotEventQuery, RobotEventRow, RobotEventSource, RobotJobCounts, ShiftRows,
    floor_event, robot_change,
};
use giveway_floor::id::{AssignmentId, JobId, RobotId};
use giveway_floor::time::Time;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard};

#[derive(Default)]
struct Lists {
    jobs: BTreeMap<JobId, JobRow>,
    assignments: BTreeMap<AssignmentId, AssignmentRow>,
    encounters: Vec<EncounterRow>,
    /// What happened to robots besides their jobs; events without a robot concern the whole fleet.
    changes: Vec<(Option<RobotId>, RobotEventRow)>,
}

/// What had happened up to the moment that is shown.
#[derive(Default)]
pub struct PastLists(Mutex<Lists>);

impl PastLists {
    /// Adds the facts of a step.
    pub fn add(&self, facts: &[Fact], at: Time) {
        let mut lists = self.lists();
        for fact in facts {
            lists.add(fact);
            lists.note(fact, at);
        }
    }

    fn lists(&self) -> MutexGuard<'_, Lists> {
        self.0.lock().expect("nobody panics with this lock")
    }
}

impl Lists {
    fn note(&mut self, fact: &Fact, at: Time) {
        let id = self.changes.len() as i64 + 1;
        let row = |source, word: &str, details| RobotEventRow {
            at,
            source,
            id,
            word: word.to_owned(),
            text: None,
            ended: None,
            details,
        };
        let noted = match robot_change(fact) {
            Some((robot, change)) => (robot, row(RobotEventSource::Change, change.word(), None)),
            None => match floor_event(fact) {
                Some(FloorEvent { kind: EventKind::RobotReplanned, new, robot, details, .. }) => {
                    (robot, row(RobotEventSource::Replan, new, details))
                }
                _ => return,
            },
        };
        self.changes.push(noted);
    }

    /// What happened to a robot, in no particular order.
    fn events(&self, robot: RobotId) -> Vec<RobotEventRow> {
        let jobs = self.jobs.values().filter(|row| row.robot == Some(robot)).map(|row| RobotEventRow {
            at: row.updated,
            source: RobotEventSource::Job,
            id: row.id.0.cast_signed(),
            word: row.job.state.word().to_owned(),
            text: Some(row.job.request.kind.word().to_owned()),
            ended: None,
            details: None,
        });
        let its = |(of, row): &(Option<RobotId>, RobotEventRow)| {
            of.is_none_or(|of| of == robot).then(|| row.clone())
        };
        jobs.chain(self.changes.iter().filter_map(its)).collect()
    }

    fn add(&mut self, fact: &Fact) {
        match fact {
            Fact::Job(JobFact::Accepted { job: id, request, at }) => {
                let (gone, request) = (GoneNames::default(), request.clone());
                let job = Job::new(request, *at);
                let (robot, times, changed) = (None, JobTimes::default(), false);
                self.jobs.insert(*id, JobRow { id: *id, job, robot, updated: *at, times, changed, gone });
            }
            Fact::Job(JobFact::Progressed { job, state, at, .. }) => {
                if let Some(record) = self.jobs.get_mut(job) {
                    record.job.state = *state;
                    record.robot = state.robot().or(record.robot);
                    record.updated = *at;
                    record.times.note(*state, *at);
                }
            }
            Fact::Job(JobFact::Served { job, tasked: (robot, _), at }) => {
                if let Some(record) = self.jobs.get_mut(job) {
                    record.serve(*robot, *at);
                }
            }
            Fact::Job(JobFact::LineChanged { job, line, change, at }) => {
                if let Some(record) = self.jobs.get_mut(job) {
                    record.change_line(*line, *change, *at);
                }
            }
            Fact::Job(JobFact::Chosen { job, choice, at }) => {
                if let Some(record) = self.jobs.get_mut(job) {
                    (record.job.choice, record.updated) = (*choice, *at);
                }
            }
            Fact::Job(JobFact::Prioritised { job, priority, at }) => {
                if let Some(record) = self.jobs.get_mut(job) {
                    (record.job.request.priority, record.updated, record.changed) = (*priority, *at, true);
                }
            }
            Fact::Job(JobFact::Changed { job, kind, priority, deadline, at }) => {
                if let Some(record) = self.jobs.get_mut(job) {
                    let request = &mut record.job.request;
                    (request.kind, request.priority, request.deadline) = (*kind, *priority, *deadline);
                    (record.updated, record.changed) = (*at, true);
                }
            }
            Fact::Assignment(AssignmentFact::Assigned { assignment: id, worker, request, at }) => {
                let (request, state) = (request.clone(), AssignmentState::Waiting);
                let gone = GoneNames::default();
                let assignment = Assignment { worker: *worker, request, state, accepted: *at };
                self.assignments.insert(*id, AssignmentRow { id: *id, assignment, updated: *at, gone });
            }
            Fact::Assignment(AssignmentFact::Given { assignment, worker, at }) => {
                if let Some(record) = self.assignments.get_mut(assignment) {
                    (record.assignment.worker, record.updated) = (Some(*worker), *at);
                }
            }
            Fact::Assignment(AssignmentFact::Advanced { assignment, state, at }) => {
                if let Some(record) = self.assignments.get_mut(assignment) {
                    (record.assignment.state, record.updated) = (*state, *at);
                }
            }
            Fact::Encounter(EncounterFact::Met(encounter)) => {
                let seq = self.encounters.len() as i64 + 1;
                self.encounters.push(EncounterRow { seq, encounter: encounter.clone(), is_anonymous: false });
            }
            _ => {}
        }
    }
}

impl Records for PastLists {
    fn job(&self, id: JobId) -> Later<'_, Result<Option<JobRow>, String>> {
        let found = self.lists().jobs.get(&id).cloned();
        Box::pin(async move { Ok(found) })
    }

    fn jobs(&self, filter: JobQuery) -> Later<'_, Result<Listed<JobRow, JobId>, String>> {
        let before = filter.before.unwrap_or(JobId(u64::MAX));
        let wanted = |r: &&JobRow| {
            let request = &r.job.request;
            (filter.states.is_empty() || filter.states.contains(&r.job.state.word()))
                && filter.rack.is_none_or(|rack| request.kind.rack() == Some(rack))
                && filter.station.is_none_or(|station| request.kind.station() == Some(station))
                && filter.robot.is_none_or(|robot| r.robot == Some(robot))
                && filter.updated_since.is_none_or(|t| r.updated >= t)
                && filter.from.is_none_or(|t| r.job.accepted >= t)
                && filter.to.is_none_or(|t| r.job.accepted < t)
                && (filter.reference.is_none() || request.reference == filter.reference)
                && filter.label.as_ref().is_none_or(|(key, value)| request.labels.get(key) == Some(value))
        };
        let lists = self.lists();
        let newest_first = lists.jobs.range(..before).rev().map(|(_, r)| r);
        let found = newest_first.filter(wanted).take(filter.limit as usize + 1).cloned().collect();
        let page = Listed::cut(found, filter.limit, None, |row: &JobRow| row.id);
        Box::pin(async move { Ok(page) })
    }

    fn assignment(&self, id: AssignmentId) -> Later<'_, Result<Option<AssignmentRow>, String>> {
        let found = self.lists().assignments.get(&id).cloned();
        Box::pin(async move { Ok(found) })
    }

    fn assignments(
        &self,
        f: AssignmentQuery,
    ) -> Later<'_, Result<Listed<AssignmentRow, AssignmentId>, String>> {
        let before = f.before.unwrap_or(AssignmentId(u64::MAX));
        let wanted = |r: &&AssignmentRow| {
            f.worker.is_none_or(|w| r.assignment.worker == Some(w))
                && (f.states.is_empty() || f.states.contains(&r.assignment.state.word()))
                && f.place.is_none_or(|place| r.assignment.request.place == place)
                && f.updated_since.is_none_or(|t| r.updated >= t)
                && f.from.is_none_or(|t| r.assignment.accepted >= t)
                && f.to.is_none_or(|t| r.assignment.accepted < t)
        };
        let lists = self.lists();
        let newest_first = lists.assignments.range(..before).rev().map(|(_, r)| r);
        let found = newest_first.filter(wanted).take(f.limit as usize + 1).cloned().collect();
        let page = Listed::cut(found, f.limit, None, |row: &AssignmentRow| row.id);
        Box::pin(async move { Ok(page) })
    }

    fn shift(&self, between: (Time, Time), now: Time) -> Later<'_, Result<ShiftRows, String>> {
        let within = |t: Time| between.0 <= t && t < between.1;
        let mut out = ShiftRows::default();
        let lists = self.lists();
        lists.jobs.values().for_each(|row| out.note(row, between, now));
        let done = |r: &&AssignmentRow| r.assignment.state == AssignmentState::Done && within(r.updated);
        out.assignments_done = lists.assignments.values().filter(done).count() as u64;
        let met = lists.encounters.iter().map(|row| &row.encounter).filter(|e| within(e.began));
        out.encounters = met.cloned().collect();
        Box::pin(async move { Ok(out) })
    }

    /// The alarms of the recording are in the feed; there is no list of them.
    fn alarms(&self, _: AlarmQuery) -> Later<'_, Result<Vec<Alarm>, String>> {
        Box::pin(async move { Ok(Vec::new()) })
    }

    fn encounters(&self, f: EncounterQuery) -> Later<'_, Result<Listed<EncounterRow, i64>, String>> {
        let wanted = |r: &&EncounterRow| {
            let e = &r.encounter;
            f.before.is_none_or(|seq| r.seq < seq)
                && f.from.is_none_or(|t| e.began >= t)
                && f.to.is_none_or(|t| e.began < t)
                && f.worker.is_none_or(|w| e.worker == w)
                && f.robot.is_none_or(|robot| e.robot == robot)
                && (f.reactions.is_empty() || f.reactions.contains(&e.reaction.word()))
                && f.updated_since.is_none_or(|t| e.ended >= t)
        };
        let lists = self.lists();
        let newest_first = lists.encounters.iter().rev();
        let found = newest_first.filter(wanted).take(f.limit as usize + 1).cloned().collect();
        let page = Listed::cut(found, f.limit, None, |row: &EncounterRow| row.seq);
        Box::pin(async move { Ok(page) })
    }

    /// Without alarms, of which a recording has no list.
    fn robot_events(&self, q: RobotEventQuery) -> Later<'_, Result<Vec<RobotEventRow>, String>> {
        let mut found = self.lists().events(q.robot);
        let key = |row: &RobotEventRow| (row.at, row.source, row.id);
        found.retain(|row| {
            q.from.is_none_or(|t| row.at >= t)
                && q.to.is_none_or(|t| row.at < t)
                && q.before.is_none_or(|before| key(row) < before)
        });
        found.sort_by_key(|row| std::cmp::Reverse(key(row)));
        found.truncate(q.limit as usize);
        Box::pin(async move { Ok(found) })
    }

    fn robot_jobs(&self, robot: RobotId) -> Later<'_, Result<RobotJobCounts, String>> {
        let lists = self.lists();
        let its = |state| {
            let ended = lists.jobs.values().filter(|r| r.robot == Some(robot) && r.job.state.word() == state);
            ended.count() as u64
        };
        let counts = RobotJobCounts { done: its("done"), failed: its("failed") };
        drop(lists);
        Box::pin(async move { Ok(counts) })
    }
}

//! Waiting jobs in the order in which robots are matched with them, kept so that nothing has to be sorted.
//!
//! Main type: [`Queue`]. Within one priority and one [`DeadlineStage`] of the deadline the order never changes, so each
//! such [`QueueLine`] is a sorted set, and the few lines are merged by urgency when they are read. For each free rack
//! only the first job of each line is offered. Refuses: to say whether a station has room; the caller leaves lines out.

use crate::state::job::{Job, JobState};
use crate::state::job_kind::JobKind;
use giveway_floor::id::{IdVec, JobId, RackId, StationId};
use giveway_floor::time::{Span, Time};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// A deadline counts from this long before it.
const NEAR: Span = Span::from_secs(600);
/// A deadline counts more and more until this long after it.
const LATEST: Span = Span::from_secs(600);
/// What one step of priority is worth, milliseconds; waiting counts for its time divided by `AGE_SHARE`.
const PRIORITY_MS: i64 = 120_000;
const AGE_SHARE: i64 = 4;

/// Where a job's rack is to go, as far as that decides whether the job may start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RackGoal {
    /// To a station.
    Station(StationId),
    /// To storage.
    Storage,
}

/// How near the deadline of a job is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeadlineStage {
    /// The job has no deadline, or a distant one: age counts.
    Plain,
    /// The deadline is near: the nearer, the more urgent.
    Near,
    /// The deadline is over: age counts, and by how much the job is late.
    Late,
    /// The deadline has been over for long: age counts.
    Overdue,
}

/// Jobs whose order among themselves never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct QueueLine {
    priority: u8,
    stage: DeadlineStage,
}

/// A job's place in its line.
pub type Rank = (i64, JobId);

/// Ready jobs for one rack.
type RackQueue = BTreeMap<(RackGoal, QueueLine), BTreeSet<Rank>>;

#[derive(Clone, Debug, PartialEq)]
struct QueueEntry {
    line: QueueLine,
    rank: Rank,
    accepted: Time,
    deadline: Option<Time>,
    is_blocked: bool,
    rack: Option<(RackId, RackGoal)>,
}

/// All waiting jobs.
#[derive(Clone, Debug, PartialEq)]
pub struct Queue {
    entries: BTreeMap<JobId, QueueEntry>,
    lines: BTreeMap<QueueLine, BTreeSet<Rank>>,
    /// Jobs that no other job keeps from starting, by priority and age.
    ready: BTreeMap<u8, BTreeSet<JobId>>,
    racks: BTreeMap<RackId, RackQueue>,
    /// The first job of each line for each rack that is free.
    heads: BTreeMap<(RackGoal, QueueLine), BTreeMap<Rank, RackId>>,
    free: IdVec<RackId, bool>,
    /// Jobs per rack, ready or not.
    wanted: BTreeMap<RackId, BTreeSet<JobId>>,
    /// When deadlines come to another stage.
    changes: BTreeSet<(Time, JobId)>,
    as_of: Time,
}

impl Queue {
    pub(crate) fn new(racks: usize) -> Queue {
        Queue {
            entries: BTreeMap::new(),
            lines: BTreeMap::new(),
            ready: BTreeMap::new(),
            racks: BTreeMap::new(),
            heads: BTreeMap::new(),
            free: IdVec::filled(false, racks),
            wanted: BTreeMap::new(),
            changes: BTreeSet::new(),
            as_of: Time::ZERO,
        }
    }

    /// How many jobs wait.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether no job waits.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Whether any job could start if a robot were free and its goal open.
    pub fn has_offers(&self) -> bool {
        !self.heads.is_empty()
    }

    /// The time up to which deadlines were looked at.
    pub fn as_of(&self) -> Time {
        self.as_of
    }

    /// For each priority, since when the oldest job that no other keeps from starting has waited.
    pub fn oldest(&self, now: Time) -> [Time; 10] {
        let mut oldest = [now; 10];
        for (priority, jobs) in &self.ready {
            let first = jobs.first().map_or(now, |id| self.entries[id].accepted);
            oldest[usize::from(*priority)] = first.min(now);
        }
        oldest
    }

    /// Whether a waiting job asks for a rack, ready or not.
    pub fn is_wanted(&self, rack: RackId) -> bool {
        self.wanted.contains_key(&rack)
    }

    /// How many racks are free and wanted.
    pub fn racks_wanted(&self) -> usize {
        self.racks.keys().filter(|k| self.free[**k]).count()
    }

    /// All waiting jobs, most urgent first.
    pub fn in_order(&self, now: Time) -> impl Iterator<Item = JobId> + '_ {
        let oldest = self.oldest(now);
        let lines = self.lines.values().map(|line| line.iter().map(|(_, id)| *id));
        merge(lines, move |id| self.urgency_ms(id, now, &oldest))
    }

    /// For each free rack the first job of each line whose goal is open, most urgent first. A rack may come several
    /// times, with jobs of different lines.
    pub fn offers<'a>(
        &'a self,
        now: Time,
        is_open: impl Fn(RackGoal) -> bool + 'a,
    ) -> impl Iterator<Item = JobId> + 'a {
        let oldest = self.oldest(now);
        let heads = self.heads.iter().filter(move |((goal, _), _)| is_open(*goal));
        let lines = heads.map(|(_, line)| line.keys().map(|(_, id)| *id));
        merge(lines, move |id| self.urgency_ms(id, now, &oldest))
    }

    /// The jobs behind an offer for the same rack in the same line.
    pub fn behind(&self, id: JobId) -> impl Iterator<Item = JobId> + '_ {
        let entry = &self.entries[&id];
        let line = entry.rack.and_then(|(rack, goal)| self.racks.get(&rack)?.get(&(goal, entry.line)));
        line.into_iter().flat_map(|line| line.iter()).map(|(_, j)| *j).skip_while(move |j| *j != id).skip(1)
    }

    /// The first job of each line for a rack that nothing keeps from starting, whether the rack is free or not.
    pub fn firsts_of(&self, rack: RackId) -> impl Iterator<Item = JobId> + '_ {
        let lines = self.racks.get(&rack).into_iter().flat_map(BTreeMap::values);
        lines.filter_map(|jobs| jobs.first().map(|(_, id)| *id))
    }

    /// Jobs for racks that only the jobs ahead of them keep from starting, and whose goal is open, most urgent first;
    /// among the first `looked` waiting jobs.
    pub fn in_line<'a>(
        &'a self,
        now: Time,
        looked: usize,
        is_open: impl Fn(RackGoal) -> bool + 'a,
    ) -> impl Iterator<Item = JobId> + 'a {
        self.in_order(now).take(looked).filter(move |id| {
            let entry = &self.entries[id];
            !entry.is_blocked && entry.rack.is_some_and(|(_, goal)| is_open(goal))
        })
    }

    /// How urgent a waiting job is, milliseconds.
    pub fn urgency_ms(&self, id: JobId, now: Time, oldest: &[Time; 10]) -> i64 {
        let e = &self.entries[&id];
        urgency_ms(e.line.priority, e.accepted, e.deadline, now, oldest[usize::from(e.line.priority)])
    }

    /// Notes which deadlines have come to another stage.
    pub fn advance(&mut self, now: Time) {
        self.as_of = self.as_of.max(now);
        while let Some((at, id)) = self.changes.first().copied().filter(|(at, _)| *at <= self.as_of) {
            self.changes.remove(&(at, id));
            let mut entry = self.take(id).expect("only waiting jobs have deadlines here");
            self.place(id, &mut entry);
            self.put(id, entry);
        }
    }

    pub(crate) fn insert(&mut self, id: JobId, job: &Job, is_blocked: bool) {
        debug_assert_eq!(job.state, JobState::Waiting, "{id:?} has a robot and stands in the queue");
        let kind = &job.request.kind;
        let goal = match *kind {
            JobKind::Deliver { station, .. } => RackGoal::Station(station),
            _ => RackGoal::Storage,
        };
        let line = QueueLine { priority: job.request.priority, stage: DeadlineStage::Plain };
        let (accepted, deadline) = (job.accepted, job.request.deadline);
        let rack = kind.rack().map(|rack| (rack, goal));
        let mut entry = QueueEntry { line, rank: (0, id), accepted, deadline, is_blocked, rack };
        self.place(id, &mut entry);
        self.put(id, entry);
    }

    pub(crate) fn remove(&mut self, id: JobId) {
        let Some(entry) = self.take(id) else { return };
        if let Some((_, Some(change))) = entry.deadline.map(|d| stage(d, self.as_of)) {
            self.changes.remove(&(change, id));
        }
    }

    pub(crate) fn unblock(&mut self, id: JobId) {
        let mut entry = self.take(id).expect("only waiting jobs are blocked");
        entry.is_blocked = false;
        self.put(id, entry);
    }

    pub(crate) fn set_free(&mut self, rack: RackId, is_free: bool) {
        if std::mem::replace(&mut self.free[rack], is_free) == is_free {
            return;
        }
        for (line, jobs) in self.racks.get(&rack).into_iter().flatten() {
            let first = *jobs.first().expect("no line is empty");
            replace_head(&mut self.heads, *line, rack, (!is_free).then_some(first), is_free.then_some(first));
        }
    }

    /// Finds the line of a job and its place there; notes when that will change.
    fn place(&mut self, id: JobId, entry: &mut QueueEntry) {
        let Some(deadline) = entry.deadline else { return };
        let (stage, change) = stage(deadline, self.as_of);
        entry.line.stage = stage;
        entry.rank.0 = match stage {
            DeadlineStage::Plain | DeadlineStage::Overdue => 0,
            DeadlineStage::Near => deadline.0,
            DeadlineStage::Late => (deadline.0 / 2).saturating_add(entry.accepted.0 / 2),
        };
        self.changes.extend(change.map(|at| (at, id)));
    }

    fn put(&mut self, id: JobId, entry: QueueEntry) {
        self.lines.entry(entry.line).or_default().insert(entry.rank);
        if let Some((rack, _)) = entry.rack {
            self.wanted.entry(rack).or_default().insert(id);
        }
        if !entry.is_blocked {
            self.ready.entry(entry.line.priority).or_default().insert(id);
            if let Some((rack, goal)) = entry.rack {
                let key = (goal, entry.line);
                let jobs = self.racks.entry(rack).or_default().entry(key).or_default();
                let before = jobs.first().copied();
                jobs.insert(entry.rank);
                let after = jobs.first().copied();
                if self.free[rack] {
                    replace_head(&mut self.heads, key, rack, before, after);
                }
            }
        }
        let before = self.entries.insert(id, entry);
        assert!(before.is_none(), "{id:?} stands in the queue twice");
    }

    fn take(&mut self, id: JobId) -> Option<QueueEntry> {
        let entry = self.entries.remove(&id)?;
        drop_from(&mut self.lines, entry.line, &entry.rank);
        if let Some((rack, _)) = entry.rack {
            drop_from(&mut self.wanted, rack, &id);
        }
        if !entry.is_blocked {
            drop_from(&mut self.ready, entry.line.priority, &id);
            if let Some((rack, goal)) = entry.rack {
                let key = (goal, entry.line);
                let lines = self.racks.get_mut(&rack).expect("it is in its rack's queue");
                let before = lines[&key].first().copied();
                drop_from(lines, key, &entry.rank);
                let after = lines.get(&key).and_then(|jobs| jobs.first().copied());
                if lines.is_empty() {
                    self.racks.remove(&rack);
                }
                if self.free[rack] {
                    replace_head(&mut self.heads, key, rack, before, after);
                }
            }
        }
        Some(entry)
    }
}

/// Takes an item out of a set, and the set out of the map if it is empty then.
fn drop_from<K: Ord + Copy, T: Ord>(sets: &mut BTreeMap<K, BTreeSet<T>>, key: K, item: &T) {
    let Some(set) = sets.get_mut(&key) else { return };
    set.remove(item);
    if set.is_empty() {
        sets.remove(&key);
    }
}

fn replace_head(
    heads: &mut BTreeMap<(RackGoal, QueueLine), BTreeMap<Rank, RackId>>,
    line: (RackGoal, QueueLine),
    rack: RackId,
    before: Option<Rank>,
    after: Option<Rank>,
) {
    if before == after {
        return;
    }
    let ranks = heads.entry(line).or_default();
    before.into_iter().for_each(|rank| _ = ranks.remove(&rank));
    after.into_iter().for_each(|rank| _ = ranks.insert(rank, rack));
    if ranks.is_empty() {
        heads.remove(&line);
    }
}

/// Merges lines, each most urgent first, into one; of equally urgent jobs the oldest first.
fn merge<L: Iterator<Item = JobId>>(
    lines: impl Iterator<Item = L>,
    urgency_ms: impl Fn(JobId) -> i64,
) -> impl Iterator<Item = JobId> {
    let mut lines: Vec<L> = lines.collect();
    let rank = move |id: JobId, line: usize| Reverse((-urgency_ms(id), id, line));
    let firsts = lines.iter_mut().enumerate().filter_map(|(i, line)| Some((line.next()?, i)));
    let mut heap: BinaryHeap<_> = firsts.map(|(id, i)| rank(id, i)).collect();
    std::iter::from_fn(move || {
        let Reverse((_, id, line)) = heap.pop()?;
        heap.extend(lines[line].next().map(|next| rank(next, line)));
        Some(id)
    })
}

/// The stage of a deadline, and when that changes.
fn stage(deadline: Time, now: Time) -> (DeadlineStage, Option<Time>) {
    let left = deadline - now;
    match () {
        () if left >= NEAR => (DeadlineStage::Plain, Some(deadline - NEAR + Span(1))),
        () if left > Span::ZERO => (DeadlineStage::Near, Some(deadline)),
        () if left > Span::ZERO - LATEST => (DeadlineStage::Late, Some(deadline + LATEST)),
        () => (DeadlineStage::Overdue, None),
    }
}

/// How urgent a job is by its priority, the nearness of its deadline and its age, milliseconds. A job whose deadline is
/// near counts as if it were the `oldest` of its priority, and the nearer the deadline, the more urgent than that:
/// however long others have waited, they can wait a little longer, and the deadline cannot.
pub fn urgency_ms(priority: u8, accepted: Time, deadline: Option<Time>, now: Time, oldest: Time) -> i64 {
    let left = deadline.map_or(Span::MAX, |d| (d - now).max(Span::from_secs(-3600)));
    let since = if Span::ZERO < left && left < NEAR { oldest } else { accepted };
    let age = (now - since).0 / 1000;
    let due = (NEAR.0.saturating_sub(left.0) / 1000).clamp(0, (NEAR + LATEST).0 / 1000) / 4;
    i64::from(priority) * PRIORITY_MS + age / AGE_SHARE + due
}

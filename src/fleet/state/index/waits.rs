//! Which jobs come after which, and which of them will never start because one before them ended badly.
//!
//! Main type: [`SuccessorIndex`]. Refuses: to know anything else about jobs.

use super::{BAD_END_KNOWN, BAD_ENDS_MAX};
use giveway_floor::id::JobId;
use giveway_floor::time::Time;
use smallvec::SmallVec;
use std::collections::{BTreeMap, BTreeSet};

/// How many of the oldest bad ends are looked at for one that may be forgotten.
const LOOKED_AT: usize = 64;

/// Jobs by the jobs that they come after.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SuccessorIndex {
    /// For each job that is not over, or ended badly: the waiting jobs that come after it.
    dependants: BTreeMap<JobId, BTreeSet<JobId>>,
    /// For each waiting job, the jobs that keep it from starting, in the order of the request.
    pending: BTreeMap<JobId, SmallVec<[JobId; 2]>>,
    /// Jobs that ended badly and still have dependants, all of which have to fail.
    doomed: BTreeSet<JobId>,
    /// Jobs that ended badly, by time.
    bad_ends: BTreeSet<(Time, JobId)>,
}

impl SuccessorIndex {
    /// Whether something keeps a waiting job from starting: a job before it is not over, or ended badly.
    pub fn is_blocked(&self, id: JobId) -> bool {
        self.pending.contains_key(&id)
    }

    /// The first job that keeps a waiting job from starting.
    pub fn first_before(&self, id: JobId) -> Option<JobId> {
        self.pending.get(&id)?.first().copied()
    }

    /// Waiting jobs that may not start yet, each with the first job that keeps it from starting.
    pub fn blocked(&self) -> impl Iterator<Item = (JobId, JobId)> + '_ {
        self.pending.iter().filter_map(|(id, before)| Some((*id, *before.first()?)))
    }

    /// A waiting job that has to fail, and the job before it that ended badly.
    pub fn next_doomed(&self) -> Option<(JobId, JobId)> {
        let bad = *self.doomed.first()?;
        Some((*self.dependants.get(&bad)?.first()?, bad))
    }

    /// Takes in a waiting job and the jobs that keep it from starting. Returns whether there are any.
    pub(crate) fn add(
        &mut self,
        id: JobId,
        before: impl Iterator<Item = JobId>,
        is_bad: impl Fn(&JobId) -> bool,
    ) -> bool {
        let mut pending: SmallVec<[JobId; 2]> = SmallVec::new();
        for job in before {
            assert!(job < id, "{id:?} comes after {job:?}, which came later");
            if self.dependants.entry(job).or_default().insert(id) {
                pending.push(job);
            }
            if is_bad(&job) {
                self.doomed.insert(job);
            }
        }
        let is_blocked = !pending.is_empty();
        if is_blocked {
            let earlier = self.pending.insert(id, pending);
            assert!(earlier.is_none(), "{id:?} begins to come after others once");
        }
        is_blocked
    }

    /// Forgets which jobs a job comes after.
    pub(crate) fn remove(&mut self, id: JobId) {
        for before in self.pending.remove(&id).into_iter().flatten() {
            let Some(dependants) = self.dependants.get_mut(&before) else { continue };
            dependants.remove(&id);
            if dependants.is_empty() {
                self.dependants.remove(&before);
                self.doomed.remove(&before);
            }
        }
    }

    /// Notes that a job is done. Returns the jobs that nothing keeps from starting any more.
    pub(crate) fn ends_well(&mut self, id: JobId) -> Vec<JobId> {
        let dependants = self.dependants.remove(&id).unwrap_or_default();
        let free = dependants.into_iter().filter(|d| {
            let pending = self.pending.get_mut(d).expect("it waits");
            pending.retain(|before| *before != id);
            pending.is_empty()
        });
        let free: Vec<JobId> = free.collect();
        free.iter().for_each(|d| _ = self.pending.remove(d));
        free
    }

    /// Notes that a job was cancelled or failed: the jobs behind it will never start.
    pub(crate) fn note_bad_end(&mut self, id: JobId, at: Time) {
        self.bad_ends.insert((at, id));
        if self.dependants.contains_key(&id) {
            self.doomed.insert(id);
        }
    }

    /// Forgets a bad end that is too old, or one too many, and keeps nothing from starting. Returns the job.
    pub(crate) fn forget_bad_end(&mut self, now: Time) -> Option<JobId> {
        let too_many = self.bad_ends.len() > BAD_ENDS_MAX;
        let oldest = self.bad_ends.iter().take(LOOKED_AT);
        let mut oldest = oldest.take_while(|(at, _)| too_many || now - *at >= BAD_END_KNOWN);
        let found = *oldest.find(|(_, id)| !self.doomed.contains(id))?;
        self.bad_ends.remove(&found);
        Some(found.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_bad_ends_beyond_the_limit_the_oldest_is_forgotten_and_none_before_its_time() {
        let mut index = SuccessorIndex::default();
        let end = |i: usize| (JobId(i as u64), Time(i as i64));
        (0..BAD_ENDS_MAX).map(end).for_each(|(id, at)| index.note_bad_end(id, at));
        let now = Time(BAD_ENDS_MAX as i64);
        assert_eq!(index.forget_bad_end(now), None, "there are as many as there may be");
        let (id, at) = end(BAD_ENDS_MAX);
        index.note_bad_end(id, at);
        assert_eq!(index.forget_bad_end(now), Some(JobId(0)));
        assert_eq!(index.forget_bad_end(now), None);
        assert_eq!(index.forget_bad_end(end(1).1 + BAD_END_KNOWN), Some(JobId(1)), "a week is over");
    }
}

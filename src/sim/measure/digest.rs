//! A digest of facts that is the same on every run, unlike the standard hasher's.
//!
//! Main type: [`Digest`] (FNV-1a, 64 bits). Refuses: to protect against attackers; it finds differences, not forgeries.

use giveway_fleet::Fact;
use std::hash::{Hash, Hasher};

/// The digest of all facts of a run.
#[derive(Clone, Debug, Default)]
pub struct Digest(Fnv);

impl Digest {
    /// Adds the facts of one step. Facts noted only for the record are not part of the digest: recordings of older
    /// builds, which noted fewer, have the same digest.
    pub fn add(&mut self, facts: &[Fact]) {
        let promised = facts.iter().filter(|f| !matches!(f, Fact::Noted(_)));
        promised.for_each(|f| f.hash(&mut self.0));
    }

    /// The digest so far.
    pub fn value(&self) -> u64 {
        self.0.finish()
    }
}

#[derive(Clone, Debug)]
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher for Fnv {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.0 = (self.0 ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::{JobKind, JobRequest, RobotFact, Visiting};
    use giveway_floor::id::{JobId, NodeId, RackId, RobotId};
    use giveway_floor::time::Time;
    use std::collections::BTreeMap;

    fn digest(of: &impl Hash) -> u64 {
        let mut fnv = Fnv::default();
        of.hash(&mut fnv);
        fnv.finish()
    }

    #[test]
    fn kinds_of_facts_that_came_later_leave_the_digests_of_older_ones_as_they_were() {
        let fact = Fact::Robot(RobotFact::RackTaken {
            robot: RobotId(2),
            rack: RackId(3),
            node: NodeId(4),
            at: Time(5),
        });
        let mut all = Digest::default();
        all.add(&[fact]);
        // Its number among the kinds of facts, as eight bytes, then its content.
        assert_eq!(all.value(), 0xf37f_c843_8d0d_2408);
    }

    /// A job as it was before there were order lines.
    #[derive(Hash)]
    struct OlderRequest {
        kind: JobKind,
        then: Vec<Visiting>,
        priority: u8,
        deadline: Option<Time>,
        after: Vec<JobId>,
        key: Option<String>,
        reference: Option<String>,
        labels: BTreeMap<String, String>,
    }

    #[test]
    fn a_job_without_order_lines_has_the_digest_that_it_had_before_there_were_any() {
        let kind = JobKind::Return { rack: RackId(3) };
        let (key, after) = (Some("k".into()), vec![JobId(4)]);
        let request = JobRequest { key, after, deadline: Some(Time(9)), ..JobRequest::new(kind) };
        let JobRequest { then, priority, deadline, after, key, reference, labels, .. } = request.clone();
        let key = key.map(|key| key.text);
        let older = OlderRequest { kind, then, priority, deadline, after, key, reference, labels };
        assert_eq!(digest(&request), digest(&older));
        let with_lines = JobRequest { lines: vec![Vec::new()], ..request.clone() };
        assert_ne!(digest(&with_lines), digest(&request));
    }
}

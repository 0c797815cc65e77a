//! Who asked for what: an entry for each request that is to change something.
//!
//! Main types: [`AuditEntry`], [`AuditDesk`], [`AuditQuery`]. Refuses: reports of where people are; they are
//! observations, and too many.

use super::caller::{Caller, Role};
use crate::time::Time;
use std::sync::atomic::{AtomicI64, Ordering};
use tokio::sync::mpsc;

/// A request that is to change something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AuditEntry {
    /// When it came, microseconds since 1970, later where two came at once: its number.
    pub id: i64,
    /// Who asked.
    pub actor: String,
    /// In which role.
    pub role: Role,
    /// What was asked: method and route.
    pub what: String,
    /// Of what: the id in the path, or of what was made.
    pub subject: Option<String>,
    /// The status of the answer; nothing where none is known.
    pub status: Option<u16>,
}

/// Which entries to list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AuditQuery {
    /// Only those that came at this time or later.
    pub from: Option<Time>,
    /// Only those that came before this time.
    pub to: Option<Time>,
    /// Only those of this name.
    pub actor: Option<String>,
    /// Only those with a smaller number.
    pub before: Option<i64>,
    /// How many at most.
    pub limit: u32,
}

/// Numbers entries, and hands those that were answered on to be written down.
#[derive(Debug)]
pub struct AuditDesk {
    last: AtomicI64,
    answered: mpsc::UnboundedSender<AuditEntry>,
}

impl AuditDesk {
    /// A desk whose entries come after this number, and where they arrive.
    pub fn new(last: i64) -> (AuditDesk, mpsc::UnboundedReceiver<AuditEntry>) {
        let (answered, arrive) = mpsc::unbounded_channel();
        (AuditDesk { last: AtomicI64::new(last), answered }, arrive)
    }

    /// An entry for a request that comes now.
    pub fn begin(&self, caller: &Caller, what: String, subject: Option<String>, now: Time) -> AuditEntry {
        let next = |last: i64| Some(now.0.max(last + 1));
        let last = self.last.fetch_update(Ordering::Relaxed, Ordering::Relaxed, next);
        let last = last.unwrap_or_else(|same| same);
        let id = now.0.max(last + 1);
        AuditEntry { id, actor: caller.name.clone(), role: caller.role, what, subject, status: None }
    }

    /// Hands an entry on whose request was answered. Where nothing keeps entries, as with a recording, it is dropped.
    pub fn end(&self, entry: AuditEntry) {
        let _ = self.answered.send(entry);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_have_the_time_as_their_number_and_each_its_own() {
        let (desk, mut arrive) = AuditDesk::new(100);
        let begin = |now| desk.begin(&Caller::this_machine(), "POST /v1/jobs".into(), None, Time(now));
        assert_eq!([50, 200, 200, 150, 300].map(|now| begin(now).id), [101, 200, 201, 202, 300]);
        desk.end(AuditEntry { status: Some(201), ..begin(400) });
        let entry = arrive.try_recv().unwrap();
        assert_eq!((entry.id, entry.actor.as_str(), entry.status), (400, "this machine", Some(201)));
    }
}

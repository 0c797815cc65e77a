//! The audit: an entry for each request that is to change something.
//!
//! Main types: [`AuditEntry`], [`AuditLog`], [`AuditQuery`]. Refuses: reports of positions; these are observations, and
//! too many.

use super::caller::{Caller, Role};
use giveway_floor::time::Time;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};
use tokio::sync::mpsc;
use tokio::sync::mpsc::error::TrySendError;

/// The most entries that wait for the database. Requests that caused facts are in the journal, and wait there; entries
/// beyond this limit are refusals while the database takes nothing.
pub const MOST_WAITING: usize = 10_000;

/// A request that is to change something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AuditEntry {
    /// The entry's number: microseconds since 1970 when the request came, increased if two came at once.
    pub id: i64,
    /// The caller's name.
    pub actor: String,
    /// The caller's role.
    pub role: Role,
    /// The request: method and route.
    pub what: String,
    /// The thing that the request concerned: the id in the path, or of the thing created.
    pub subject: Option<String>,
    /// The HTTP status of the answer; nothing if none is known.
    pub status: Option<u16>,
}

/// Filters for audit entries.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AuditQuery {
    /// Only entries of this time or later.
    pub from: Option<Time>,
    /// Only entries before this time.
    pub to: Option<Time>,
    /// Only entries of the caller of this name.
    pub actor: Option<String>,
    /// Only entries with a smaller number.
    pub before: Option<i64>,
    /// The most entries to return.
    pub limit: u32,
}

/// Numbers entries, and passes them on to be stored once their requests are answered.
#[derive(Debug)]
pub struct AuditLog {
    last: AtomicI64,
    answered: mpsc::Sender<AuditEntry>,
    /// How many entries found no room since the last entry that reports such a gap.
    missing: AtomicU64,
}

impl AuditLog {
    /// A log that numbers entries from `last` on, and the receiver of finished entries.
    pub fn new(last: i64) -> (AuditLog, mpsc::Receiver<AuditEntry>) {
        let (answered, arrive) = mpsc::channel(MOST_WAITING);
        (AuditLog { last: AtomicI64::new(last), answered, missing: AtomicU64::new(0) }, arrive)
    }

    /// An entry for a request that comes now.
    pub fn begin(&self, caller: &Caller, what: String, subject: Option<String>, now: Time) -> AuditEntry {
        let id = self.number(now);
        AuditEntry { id, actor: caller.name.clone(), role: caller.role, what, subject, status: None }
    }

    fn number(&self, now: Time) -> i64 {
        let next = |last: i64| Some(now.0.max(last + 1));
        let last = self.last.fetch_update(Ordering::Relaxed, Ordering::Relaxed, next);
        now.0.max(last.unwrap_or_else(|same| same) + 1)
    }

    /// Passes on the entry of an answered request. If nothing keeps entries, as with a recording, the entry is dropped.
    /// It is also dropped if too many wait; as soon as there is room again, an entry reports how many are missing.
    pub fn end(&self, entry: AuditEntry) {
        let missing = self.missing.load(Ordering::Relaxed);
        if missing > 0 && self.answered.capacity() > 1 {
            let what = format!(
                "{missing} requests are missing here: the database took nothing, and too many waited"
            );
            let (id, actor) = (self.number(Time(entry.id)), "this server".into());
            let note = AuditEntry { id, actor, role: Role::Admin, what, subject: None, status: None };
            if self.answered.try_send(note).is_ok() {
                self.missing.fetch_sub(missing, Ordering::Relaxed);
            }
        }
        if let Err(TrySendError::Full(_)) = self.answered.try_send(entry) {
            self.missing.fetch_add(1, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_entries_than_may_wait_are_counted_and_said_when_there_is_room_again() {
        let (log, mut arrive) = AuditLog::new(0);
        let ask = |now| log.end(log.begin(&Caller::this_machine(), "POST /v1/jobs".into(), None, Time(now)));
        (0..MOST_WAITING as i64 + 7).for_each(ask);
        for _ in 0..MOST_WAITING {
            assert_eq!(arrive.try_recv().unwrap().what, "POST /v1/jobs");
        }
        assert!(arrive.try_recv().is_err(), "no more than that waits");
        (0..2).for_each(ask);
        let said: Vec<String> = std::iter::from_fn(|| arrive.try_recv().ok()).map(|e| e.what).collect();
        assert!(said[0].starts_with("7 requests are missing here"), "{said:?}");
        assert_eq!(said[1..], ["POST /v1/jobs", "POST /v1/jobs"], "once");
    }

    #[test]
    fn entries_have_the_time_as_their_number_and_each_its_own() {
        let (log, mut arrive) = AuditLog::new(100);
        let begin = |now| log.begin(&Caller::this_machine(), "POST /v1/jobs".into(), None, Time(now));
        assert_eq!([50, 200, 200, 150, 300].map(|now| begin(now).id), [101, 200, 201, 202, 300]);
        log.end(AuditEntry { status: Some(201), ..begin(400) });
        let entry = arrive.try_recv().unwrap();
        assert_eq!((entry.id, entry.actor.as_str(), entry.status), (400, "this machine", Some(201)));
    }
}

//! Connections that have not shown that they belong here: a bounded number of them, so that they keep nobody out.
//!
//! Main types: [`Strangers`], [`Stranger`]. A connection is a stranger until a request of it was let in. If there are
//! too many, the one that has been here longest has to leave. Refuses: to close a connection that was let in.

use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// So many connections may be strangers at once.
pub(super) const MOST_STRANGERS: usize = 256;
/// The pause before the answer to a wrong token, the first time; it doubles each time.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
/// The longest such pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(5);
/// Wrong tokens of an address are forgotten after this.
const FORGOTTEN: Duration = Duration::from_secs(60);
/// So many addresses with wrong tokens are known at once.
const MOST_ADDRESSES: usize = 10_000;

/// All strangers. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub(super) struct Strangers(Arc<Mutex<Known>>);

#[derive(Debug, Default)]
struct Known {
    next: u64,
    /// In order of arrival, each with what asks it to leave.
    waiting: BTreeMap<u64, Arc<Notify>>,
    /// How often an address showed a wrong token, and when last.
    wrong: HashMap<IpAddr, (u32, Instant)>,
}

/// One connection that may be a stranger. It is none any more when this is dropped.
#[derive(Debug)]
pub(super) struct Stranger {
    all: Strangers,
    id: u64,
    leave: Arc<Notify>,
}

impl Strangers {
    /// A new connection; if there are too many, the oldest stranger is asked to leave.
    pub fn arrive(&self) -> Stranger {
        let leave = Arc::new(Notify::new());
        let mut known = self.known();
        let id = known.next;
        known.next += 1;
        known.waiting.insert(id, leave.clone());
        if known.waiting.len() > MOST_STRANGERS
            && let Some((_, oldest)) = known.waiting.pop_first()
        {
            oldest.notify_one();
        }
        Stranger { all: self.clone(), id, leave }
    }

    /// Notes a wrong token, and says how long the answer is to wait.
    pub fn wrong_token(&self, from: IpAddr, now: Instant) -> Duration {
        let mut known = self.known();
        if known.wrong.len() >= MOST_ADDRESSES {
            known.wrong.retain(|_, (_, last)| now.duration_since(*last) < FORGOTTEN);
        }
        if known.wrong.len() >= MOST_ADDRESSES && !known.wrong.contains_key(&from) {
            return LONGEST_PAUSE;
        }
        let (times, last) = known.wrong.entry(from).or_insert((0, now));
        *times = if now.duration_since(*last) < FORGOTTEN { *times + 1 } else { 1 };
        *last = now;
        (FIRST_PAUSE * 2u32.saturating_pow((*times - 1).min(10))).min(LONGEST_PAUSE)
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Stranger {
    /// A request was let in: the connection belongs here.
    pub fn let_in(&self) {
        self.all.known().waiting.remove(&self.id);
    }

    /// Waits until there are too many strangers, and this is the one to leave.
    pub async fn is_to_leave(&self) {
        self.leave.notified().await;
    }
}

impl Drop for Stranger {
    fn drop(&mut self) {
        self.let_in();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    #[tokio::test]
    async fn the_oldest_stranger_leaves_for_a_new_one_and_who_was_let_in_stays() {
        let all = Strangers::default();
        let belongs = all.arrive();
        belongs.let_in();
        let strangers: Vec<_> = (0..MOST_STRANGERS).map(|_| all.arrive()).collect();
        let leaves = async |s: &Stranger| tokio::time::timeout(Duration::ZERO, s.is_to_leave()).await.is_ok();
        assert!(!leaves(&strangers[0]).await, "there is room for them");
        let _newest = all.arrive();
        assert!(leaves(&strangers[0]).await && !leaves(&strangers[1]).await && !leaves(&belongs).await);
    }

    #[test]
    fn each_wrong_token_of_an_address_waits_longer_until_it_is_forgotten() {
        let (all, now) = (Strangers::default(), Instant::now());
        let from = |last| IpAddr::V4(Ipv4Addr::new(10, 0, 0, last));
        let pauses: Vec<u128> = (0..8).map(|_| all.wrong_token(from(1), now).as_millis()).collect();
        assert_eq!(pauses, [100, 200, 400, 800, 1600, 3200, 5000, 5000]);
        assert_eq!(all.wrong_token(from(2), now).as_millis(), 100, "others do not wait");
        assert_eq!(all.wrong_token(from(1), now + FORGOTTEN).as_millis(), 100);
    }
}

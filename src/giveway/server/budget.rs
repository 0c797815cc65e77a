//! One budget for all connections: how many there are, how many of them are strangers, and how many bytes wait for
//! clients to take them.
//!
//! Main types: [`Budget`], [`Guest`]. A connection is a stranger until a caller is recognised on it. Where something is
//! used up, one connection leaves: of strangers, the longest here of the address that has most of them; else the one
//! that has been idle for longest; for bytes, the one that has taken nothing for longest, of the address with most
//! bytes. Refuses: to let strangers use the descriptors of those who are known, and to close one that gets on.

use giveway_api::access::secrets::network;
use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// So many connections may be strangers at once, and never more than half of all.
const MOST_STRANGERS: usize = 256;
/// So many descriptors are kept for the database, recordings and requests to others.
const KEPT_BACK: usize = 64;
/// So many bytes may wait for clients; then those leave that take none.
const MOST_BYTES: usize = 64 << 20;
/// A connection that has taken nothing for so long does not get on.
const STALLED: Duration = Duration::from_secs(1);
/// A stranger has to ask for something within this time, from its arrival and after each answer.
const STRANGER_IDLE: Duration = Duration::from_secs(15);

/// All connections. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Budget(Arc<Mutex<Open>>);

#[derive(Debug)]
struct Open {
    limits: ConnectionLimits,
    next: u64,
    /// By number, so in order of arrival.
    guests: BTreeMap<u64, Place>,
    /// Bytes that wait, of all.
    bytes: usize,
}

/// How much of everything there may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ConnectionLimits {
    connections: usize,
    strangers: usize,
    bytes: usize,
}

/// What is known of one connection.
#[derive(Debug)]
struct Place {
    from: IpAddr,
    is_known: bool,
    /// Whether no request of it is being answered.
    is_idle: bool,
    /// Bytes that wait for it to take them.
    bytes: usize,
    /// Since when it is idle, or when it took something last.
    since: Instant,
    leave: Arc<Leave>,
}

/// Tells a connection to leave.
#[derive(Debug, Default)]
struct Leave {
    told: AtomicBool,
    notify: Notify,
}

/// One connection. Its place is free when this is dropped.
#[derive(Debug)]
pub(super) struct Guest {
    budget: Budget,
    id: u64,
    leave: Arc<Leave>,
}

impl Budget {
    /// A budget for a process that may have so many descriptors.
    pub fn of(descriptors: usize) -> Budget {
        let connections = descriptors.saturating_sub(KEPT_BACK).max(8);
        let strangers = MOST_STRANGERS.min(connections / 2);
        Budget::within(ConnectionLimits { connections, strangers, bytes: MOST_BYTES })
    }

    fn within(limits: ConnectionLimits) -> Budget {
        Budget(Arc::new(Mutex::new(Open { limits, next: 0, guests: BTreeMap::new(), bytes: 0 })))
    }

    /// A new connection. If there are too many, one is told to leave, perhaps this one.
    pub fn arrive(&self, from: IpAddr, now: Instant) -> Guest {
        let leave = Arc::new(Leave::default());
        let mut open = self.open();
        let id = open.next;
        open.next += 1;
        let (is_known, is_idle) = (false, true);
        let place =
            Place { from: network(from), is_known, is_idle, bytes: 0, since: now, leave: leave.clone() };
        open.guests.insert(id, place);
        if open.staying().filter(|(_, p)| !p.is_known).count() > open.limits.strangers {
            open.tell(open.stranger_to_leave(id));
        }
        if open.staying().count() > open.limits.connections {
            open.tell(open.stranger_to_leave(id).or_else(|| open.longest(|p| p.is_idle)).or(Some(id)));
        }
        Guest { budget: self.clone(), id, leave }
    }

    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Open {
    /// Those that were not told to leave.
    fn staying(&self) -> impl Iterator<Item = (&u64, &Place)> {
        self.guests.iter().filter(|(_, place)| !place.leave.told.load(Ordering::Relaxed))
    }

    /// The stranger who is here for longest, of those from the address that has most. A new one is spared.
    fn stranger_to_leave(&self, new: u64) -> Option<u64> {
        let strangers = || self.staying().filter(|(id, place)| !place.is_known && **id != new);
        let mut by_address: HashMap<IpAddr, usize> = HashMap::new();
        strangers().for_each(|(_, place)| *by_address.entry(place.from).or_default() += 1);
        let most = by_address.values().max()?;
        strangers().find(|(_, place)| by_address[&place.from] == *most).map(|(id, _)| *id)
    }

    /// The one of these whose state has not changed for longest.
    fn longest(&self, which: impl Fn(&Place) -> bool) -> Option<u64> {
        let those = self.staying().filter(|(_, place)| which(place));
        those.min_by_key(|(_, place)| place.since).map(|(id, _)| *id)
    }

    /// The one that does not take its bytes, of the address for which most wait.
    fn holder_to_leave(&self, now: Instant) -> Option<u64> {
        let mut by_address: HashMap<IpAddr, usize> = HashMap::new();
        self.staying().for_each(|(_, place)| *by_address.entry(place.from).or_default() += place.bytes);
        let stalled = |place: &Place| place.bytes > 0 && now.saturating_duration_since(place.since) > STALLED;
        let most = self
            .staying()
            .filter(|(_, place)| stalled(place))
            .map(|(_, place)| by_address[&place.from])
            .max()?;
        self.longest(|place| stalled(place) && by_address[&place.from] == most)
    }

    fn tell(&self, who: Option<u64>) {
        if let Some(place) = who.and_then(|id| self.guests.get(&id)) {
            place.leave.told.store(true, Ordering::Relaxed);
            place.leave.notify.notify_one();
        }
    }
}

impl Guest {
    /// A caller was recognised on it.
    pub fn let_in(&self) {
        self.change(|place| place.is_known = true);
    }

    /// Whether a caller was recognised on it.
    pub fn is_known(&self) -> bool {
        self.budget.open().guests.get(&self.id).is_some_and(|place| place.is_known)
    }

    /// A request of it begins to be answered.
    pub fn asks(&self) {
        self.change(|place| place.is_idle = false);
    }

    /// Its request is answered, as far as the server is concerned.
    pub fn is_answered(&self, now: Instant) {
        self.change(|place| (place.is_idle, place.since) = (true, now));
    }

    /// So many bytes wait for it from now on. If that is too much, somebody who takes none is told to leave.
    pub fn is_sent(&self, bytes: usize, now: Instant) {
        let mut open = self.budget.open();
        let Some(place) = open.guests.get_mut(&self.id) else { return };
        if place.bytes == 0 {
            place.since = now;
        }
        place.bytes += bytes;
        open.bytes += bytes;
        if open.bytes > open.limits.bytes {
            open.tell(open.holder_to_leave(now));
        }
    }

    /// So many bytes do not wait for it any more, though it took none.
    pub fn releases(&self, bytes: usize) {
        let mut open = self.budget.open();
        let Some(place) = open.guests.get_mut(&self.id) else { return };
        let counted = bytes.min(place.bytes);
        place.bytes -= counted;
        open.bytes -= counted;
    }

    /// It has taken so many bytes, of which some may be of heads and of shared bodies, which were never counted.
    pub fn takes(&self, bytes: usize, now: Instant) {
        // Flushing what is flushed is no progress.
        if bytes == 0 {
            return;
        }
        let mut open = self.budget.open();
        let Some(place) = open.guests.get_mut(&self.id) else { return };
        let counted = bytes.min(place.bytes);
        place.bytes -= counted;
        place.since = now;
        open.bytes -= counted;
    }

    /// Whether it is a stranger who has asked for nothing for too long.
    pub fn is_overdue(&self, now: Instant) -> bool {
        let open = self.budget.open();
        let overdue = |place: &Place| {
            !place.is_known && place.is_idle && now.saturating_duration_since(place.since) > STRANGER_IDLE
        };
        open.guests.get(&self.id).is_some_and(overdue)
    }

    /// Whether it was told to leave.
    pub fn is_told(&self) -> bool {
        self.leave.told.load(Ordering::Relaxed)
    }

    /// Waits until it is told to leave.
    pub async fn is_to_leave(&self) {
        if !self.is_told() {
            self.leave.notify.notified().await;
        }
    }

    fn change(&self, change: impl FnOnce(&mut Place)) {
        if let Some(place) = self.budget.open().guests.get_mut(&self.id) {
            change(place);
        }
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        let mut open = self.budget.open();
        if let Some(place) = open.guests.remove(&self.id) {
            open.bytes -= place.bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(last: u8) -> IpAddr {
        IpAddr::from([10, 0, 0, last])
    }

    fn budget(connections: usize, strangers: usize, bytes: usize) -> Budget {
        Budget::within(ConnectionLimits { connections, strangers, bytes })
    }

    #[tokio::test]
    async fn the_oldest_stranger_of_the_address_with_most_leaves_for_a_new_one_and_known_ones_stay() {
        let (budget, now) = (budget(100, 3, 100), Instant::now());
        let known = budget.arrive(address(1), now);
        known.let_in();
        let other = budget.arrive(address(2), now);
        let strangers: Vec<Guest> = (0..2).map(|_| budget.arrive(address(1), now)).collect();
        assert!(!strangers[0].is_told(), "there is room for them");
        let newest = budget.arrive(address(3), now);
        assert!(strangers[0].is_told(), "the first of the address with most strangers");
        tokio::time::timeout(Duration::from_secs(5), strangers[0].is_to_leave()).await.expect("it is told");
        assert!([&known, &other, &strangers[1], &newest].iter().all(|guest| !guest.is_told()));
    }

    #[test]
    fn if_all_descriptors_are_used_strangers_leave_first_and_then_the_one_that_is_idle_for_longest() {
        let (budget, now) = (budget(3, 3, 100), Instant::now());
        let guests: Vec<Guest> = (0..3).map(|_| budget.arrive(address(1), now)).collect();
        guests[0].let_in();
        guests[1].let_in();
        let second = budget.arrive(address(1), now);
        assert!(guests[2].is_told(), "the stranger");
        second.let_in();
        guests[0].asks();
        guests[1].is_answered(now + Duration::from_secs(9));
        second.is_answered(now + Duration::from_secs(5));
        let third = budget.arrive(address(2), now + Duration::from_secs(10));
        assert!(second.is_told() && !guests[0].is_told() && !guests[1].is_told() && !third.is_told());
        third.let_in();
        guests[1].asks();
        third.asks();
        let fourth = budget.arrive(address(2), now + Duration::from_secs(10));
        assert!(fourth.is_told(), "nobody who is here is idle");
    }

    #[test]
    fn strangers_have_half_of_the_descriptors_at_most() {
        for (descriptors, connections, strangers) in [(300, 236, 118), (65_536, 65_472, 256), (70, 8, 4)] {
            let limits = Budget::of(descriptors).open().limits;
            assert_eq!((limits.connections, limits.strangers), (connections, strangers), "{descriptors}");
        }
    }

    #[test]
    fn if_too_many_bytes_wait_the_one_leaves_that_has_taken_none_for_longest() {
        let (budget, now) = (budget(9, 9, 100), Instant::now());
        let after = |s| now + Duration::from_secs(s);
        let guests: Vec<Guest> = [1, 2, 2, 3].map(|a| budget.arrive(address(a), now)).into();
        guests[0].is_sent(40, now);
        guests[1].is_sent(30, now);
        guests[2].is_sent(25, now);
        guests[2].takes(1, after(4));
        guests[3].is_sent(10, after(5));
        let told: Vec<bool> = guests.iter().map(Guest::is_told).collect();
        assert_eq!(told, [false, true, false, false], "most wait for the second address");
        drop(guests);
        assert_eq!(budget.open().bytes, 0);
    }

    #[test]
    fn nobody_who_takes_what_is_sent_leaves_however_much_it_is() {
        let (budget, now) = (budget(9, 9, 100), Instant::now());
        let guest = budget.arrive(address(1), now);
        guest.is_sent(1000, now);
        guest.takes(400, now);
        guest.is_sent(1000, now);
        assert!(!guest.is_told());
        guest.takes(5000, now);
        assert_eq!(budget.open().bytes, 0, "heads were never counted");
    }

    #[test]
    fn a_stranger_has_to_ask_for_something_in_time_and_a_known_one_need_not() {
        let (budget, now) = (budget(9, 9, 100), Instant::now());
        let guest = budget.arrive(address(1), now);
        let later = now + STRANGER_IDLE + Duration::from_secs(1);
        assert!(!guest.is_overdue(now) && guest.is_overdue(later));
        guest.takes(0, later);
        assert!(guest.is_overdue(later), "nothing was sent, so nothing was taken");
        guest.asks();
        assert!(!guest.is_overdue(later), "it has asked");
        guest.is_answered(now);
        assert!(guest.is_overdue(later), "and asks for nothing more");
        guest.let_in();
        assert!(!guest.is_overdue(later));
    }
}

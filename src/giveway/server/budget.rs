//! One budget for all connections: how many there are, how many of them are strangers, and how many bytes wait to be
//! taken by clients.
//!
//! Main types: [`Budget`], [`Guest`]. A connection is a stranger until a caller is recognised on it. If a limit is
//! exceeded, one connection must leave: among strangers, the oldest of the address with the most strangers; else the
//! connection that has been idle longest; for bytes, the connection that has taken nothing for longest, of the address
//! with the most bytes. Refuses: to let strangers use the descriptors of known clients, and to close a connection that
//! makes progress.

use giveway_api::access::secrets::network;
use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// The most connections that may be strangers at once, and never more than half of all.
const MOST_STRANGERS: usize = 256;
/// Descriptors that are reserved for the database, recordings and outgoing requests.
const KEPT_BACK: usize = 64;
/// The most bytes that may wait for clients; beyond it, clients that take none must leave.
const MOST_BYTES: usize = 64 << 20;
/// A connection that has taken nothing for this long makes no progress.
const STALLED: Duration = Duration::from_secs(1);
/// A stranger must send a request within this time, from its arrival and after each answer.
const STRANGER_IDLE: Duration = Duration::from_secs(15);

/// All connections. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct Budget(Arc<Mutex<Open>>);

#[derive(Debug)]
struct Open {
    limits: ConnectionLimits,
    next: u64,
    /// Connections by number, and so in order of arrival.
    guests: BTreeMap<u64, Place>,
    /// Waiting bytes of all connections.
    bytes: usize,
}

/// The limits on connections and bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ConnectionLimits {
    connections: usize,
    strangers: usize,
    bytes: usize,
}

/// The state of one connection.
#[derive(Debug)]
struct Place {
    from: IpAddr,
    is_known: bool,
    /// Whether none of the connection's requests is being answered.
    is_idle: bool,
    /// Bytes that wait for the client to take them.
    bytes: usize,
    /// Since when the connection has been idle, or when its client last took bytes.
    since: Instant,
    leave: Arc<Leave>,
}

/// Tells a connection to leave.
#[derive(Debug, Default)]
struct Leave {
    told: AtomicBool,
    notify: Notify,
}

/// One connection. Dropping this frees its place.
#[derive(Debug)]
pub(super) struct Guest {
    budget: Budget,
    id: u64,
    leave: Arc<Leave>,
}

impl Budget {
    /// A budget for a process that may open this many descriptors.
    pub fn of(descriptors: usize) -> Budget {
        let connections = descriptors.saturating_sub(KEPT_BACK).max(8);
        let strangers = MOST_STRANGERS.min(connections / 2);
        Budget::within(ConnectionLimits { connections, strangers, bytes: MOST_BYTES })
    }

    fn within(limits: ConnectionLimits) -> Budget {
        Budget(Arc::new(Mutex::new(Open { limits, next: 0, guests: BTreeMap::new(), bytes: 0 })))
    }

    /// Adds a connection. If there are too many, one is told to leave, perhaps this one.
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
    /// Connections that were not told to leave.
    fn staying(&self) -> impl Iterator<Item = (&u64, &Place)> {
        self.guests.iter().filter(|(_, place)| !place.leave.told.load(Ordering::Relaxed))
    }

    /// The oldest stranger of the address with the most strangers, except the new connection.
    fn stranger_to_leave(&self, new: u64) -> Option<u64> {
        let strangers = || self.staying().filter(|(id, place)| !place.is_known && **id != new);
        let mut by_address: HashMap<IpAddr, usize> = HashMap::new();
        strangers().for_each(|(_, place)| *by_address.entry(place.from).or_default() += 1);
        let most = by_address.values().max()?;
        strangers().find(|(_, place)| by_address[&place.from] == *most).map(|(id, _)| *id)
    }

    /// Of the connections that satisfy `which`, the one whose state has been unchanged for longest.
    fn longest(&self, which: impl Fn(&Place) -> bool) -> Option<u64> {
        let those = self.staying().filter(|(_, place)| which(place));
        those.min_by_key(|(_, place)| place.since).map(|(id, _)| *id)
    }

    /// The stalled connection of the address with the most waiting bytes.
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
    /// Notes that a caller was recognised on the connection.
    pub fn let_in(&self) {
        self.change(|place| place.is_known = true);
    }

    /// Whether a caller was recognised on the connection.
    pub fn is_known(&self) -> bool {
        self.budget.open().guests.get(&self.id).is_some_and(|place| place.is_known)
    }

    /// Notes that a request of the connection is being answered.
    pub fn asks(&self) {
        self.change(|place| place.is_idle = false);
    }

    /// Notes that the server has finished its answer.
    pub fn is_answered(&self, now: Instant) {
        self.change(|place| (place.is_idle, place.since) = (true, now));
    }

    /// Notes that this many more bytes wait for the client. If that exceeds the limit, a stalled connection is told to
    /// leave.
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

    /// Notes that this many bytes no longer wait, although the client did not take them.
    pub fn releases(&self, bytes: usize) {
        let mut open = self.budget.open();
        let Some(place) = open.guests.get_mut(&self.id) else { return };
        let counted = bytes.min(place.bytes);
        place.bytes -= counted;
        open.bytes -= counted;
    }

    /// Notes that the client took this many bytes; some may be of headers and shared bodies, which were never counted.
    pub fn takes(&self, bytes: usize, now: Instant) {
        // Flushing nothing is no progress.
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

    /// Whether the connection is a stranger that has sent no request for too long.
    pub fn is_overdue(&self, now: Instant) -> bool {
        let open = self.budget.open();
        let overdue = |place: &Place| {
            !place.is_known && place.is_idle && now.saturating_duration_since(place.since) > STRANGER_IDLE
        };
        open.guests.get(&self.id).is_some_and(overdue)
    }

    /// Whether the connection was told to leave.
    pub fn is_told(&self) -> bool {
        self.leave.told.load(Ordering::Relaxed)
    }

    /// Waits until the connection is told to leave.
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

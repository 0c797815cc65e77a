//! Wrong secrets, however they are shown: as a bearer token, when signing in, or as a session cookie.
//!
//! Main types: [`WrongSecrets`]. All ways share one record per address. The answer to a wrong secret is delayed, longer
//! each time, and answers to one address leave one after the other, however many requests come at once. The first,
//! tenth, hundredth attempt of an address is audited, and many attempts raise an alarm. Refuses: to delay a right
//! secret, so that an attacker cannot lock out others with the same address, as behind a proxy.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The delay of the first answer to a wrong secret; it doubles each time.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
/// The longest doubled delay.
const LONGEST_PAUSE: Duration = Duration::from_secs(5);
/// The least time between two such answers to one address.
const BETWEEN: Duration = Duration::from_millis(100);
/// No answer is delayed for longer than this.
const MOST: Duration = Duration::from_secs(20);
/// An address that shows no wrong secret for this long is forgotten.
const FORGOTTEN: Duration = Duration::from_secs(60);
/// The most addresses that are tracked at once.
const MOST_ADDRESSES: usize = 10_000;
/// Wrong secrets of one address that raise an alarm: more than people mistype.
pub const ALARMING: u32 = 20;
/// The most audit entries per minute, so that many addresses do not fill the audit.
const MOST_NOTES: u32 = 60;

/// How to treat a wrong secret.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judged {
    /// How long to delay its answer.
    pub pause: Duration,
    /// How many wrong secrets the address has shown, if this one is to be audited.
    pub note: Option<u32>,
}

/// The wrong secrets of all addresses.
#[derive(Debug, Default)]
pub struct WrongSecrets(Mutex<SecretsSeen>);

#[derive(Debug, Default)]
struct SecretsSeen {
    by_address: HashMap<IpAddr, AddressGuesses>,
    /// When the current minute of audit entries began, and how many there were in it.
    notes: Option<(Instant, u32)>,
}

#[derive(Debug)]
struct AddressGuesses {
    times: u32,
    last: Instant,
    /// When the answer to the last wrong secret leaves.
    answered: Instant,
}

impl WrongSecrets {
    /// Counts a wrong secret, and decides how to treat it.
    pub fn note(&self, from: IpAddr, now: Instant) -> Judged {
        let mut seen = self.seen();
        seen.forget(now);
        let from = network(from);
        if seen.by_address.len() >= MOST_ADDRESSES && !seen.by_address.contains_key(&from) {
            return Judged { pause: LONGEST_PAUSE, note: None };
        }
        let fresh = AddressGuesses { times: 0, last: now, answered: now };
        let guesses = seen.by_address.entry(from).or_insert(fresh);
        guesses.times = guesses.times.saturating_add(1);
        guesses.last = now;
        let times = guesses.times;
        let pause = (FIRST_PAUSE * 2u32.saturating_pow((times - 1).min(10))).min(LONGEST_PAUSE);
        guesses.answered = (now + pause).max(guesses.answered + BETWEEN).min(now + MOST);
        let pause = guesses.answered - now;
        let counts = 10u32.checked_pow(times.ilog10()) == Some(times) && seen.may_note(now);
        Judged { pause, note: counts.then_some(times) }
    }

    /// Addresses with so many wrong secrets that a person should know, each with a lower bound on their number.
    pub fn alarming(&self, now: Instant) -> Vec<(IpAddr, u32)> {
        let mut seen = self.seen();
        seen.forget(now);
        let many = seen.by_address.iter().filter(|(_, guesses)| guesses.times >= ALARMING);
        // In steps, so that the alarm does not change all the time.
        let at_least = |times: u32| 10u32.pow(times.ilog10()).max(ALARMING);
        let mut many: Vec<_> = many.map(|(from, guesses)| (*from, at_least(guesses.times))).collect();
        many.sort_unstable();
        many
    }

    fn seen(&self) -> MutexGuard<'_, SecretsSeen> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SecretsSeen {
    /// Forgets addresses that have shown no wrong secret for a while.
    fn forget(&mut self, now: Instant) {
        self.by_address.retain(|_, guesses| now.saturating_duration_since(guesses.last) < FORGOTTEN);
    }

    /// Whether the audit may get another entry in this minute.
    fn may_note(&mut self, now: Instant) -> bool {
        let minute = self.notes.filter(|(since, _)| now.saturating_duration_since(*since) < FORGOTTEN);
        let (since, notes) = minute.unwrap_or((now, 0));
        self.notes = Some((since, notes.saturating_add(1)));
        notes < MOST_NOTES
    }
}

/// The network of an address: the holder of one IPv6 address usually has the whole /64.
pub fn network(from: IpAddr) -> IpAddr {
    match from.to_canonical() {
        IpAddr::V6(v6) => Ipv6Addr::from_bits(v6.to_bits() >> 64 << 64).into(),
        v4 => v4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(last: u8) -> IpAddr {
        IpAddr::from([10, 0, 0, last])
    }

    #[test]
    fn each_wrong_secret_of_an_address_waits_longer_until_it_is_forgotten() {
        let (all, now) = (WrongSecrets::default(), Instant::now());
        let after = |s| now + Duration::from_secs(s);
        let pauses: Vec<u128> =
            (0..8).map(|i| all.note(address(1), after(i * 10)).pause.as_millis()).collect();
        assert_eq!(pauses, [100, 200, 400, 800, 1600, 3200, 5000, 5000]);
        assert_eq!(all.note(address(2), after(70)).pause.as_millis(), 100, "others do not wait");
        assert_eq!(all.note(address(1), after(70) + FORGOTTEN).pause.as_millis(), 100);
    }

    #[test]
    fn answers_to_one_address_leave_one_after_the_other_however_many_it_asks_for_at_once() {
        let (all, now) = (WrongSecrets::default(), Instant::now());
        let mut answers: Vec<Duration> = (0..190).map(|_| all.note(address(1), now).pause).collect();
        answers.sort_unstable();
        let in_the_second = |s: u64| {
            let (from, to) = (Duration::from_secs(s), Duration::from_secs(s + 1));
            answers.iter().filter(|at| (from..to).contains(*at)).count()
        };
        let most = (0..20).map(in_the_second).max();
        assert!(most <= Some(10), "{most:?} in one second");
        assert!(answers.iter().all(|at| *at <= MOST), "none waits for ever");
    }

    #[test]
    fn the_first_tenth_and_hundredth_are_written_down_and_many_addresses_do_not_fill_the_audit() {
        let (all, now) = (WrongSecrets::default(), Instant::now());
        let notes: Vec<u32> = (0..1500).filter_map(|_| all.note(address(1), now).note).collect();
        assert_eq!(notes, [1, 10, 100, 1000]);
        let many =
            (0..1000u32).filter_map(|i| all.note(Ipv6Addr::from_bits(u128::from(i) << 64).into(), now).note);
        assert_eq!(many.count(), MOST_NOTES as usize - 4);
    }

    #[test]
    fn an_address_that_goes_on_is_alarming_and_one_that_mistyped_is_not() {
        let (all, now) = (WrongSecrets::default(), Instant::now());
        (0..5).for_each(|_| _ = all.note(address(1), now));
        assert_eq!(all.alarming(now), []);
        (0..345).for_each(|_| _ = all.note(address(2), now));
        assert_eq!(all.alarming(now), [(address(2), 100)]);
        assert_eq!(all.alarming(now + FORGOTTEN), [], "it is over a minute after the last one");
    }

    #[test]
    fn the_addresses_of_one_ipv6_network_count_as_one() {
        let of = |text: &str| network(text.parse().unwrap());
        assert_eq!(of("2600:1:2:3::1"), of("2600:1:2:3:ffff::9"));
        assert_ne!(of("2600:1:2:3::1"), of("2600:1:2:4::1"));
        assert_eq!(of("::ffff:10.0.0.1"), address(1));
    }
}

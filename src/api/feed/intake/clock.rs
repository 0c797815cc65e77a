//! Clock synchronisation: converts times of a device's clock to the server's clock.
//!
//! Main types: [`ClockSync`], [`Exchange`]. The exchange of four timestamps, and the filter that trusts the sample with
//! the least delay, are those of NTP (RFC 5905, sections 8 and 10). Pure. Refuses: to move the times of poses back and
//! forth; corrections are spread out, unless the device's clock itself has jumped.

use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;

/// How many samples are kept.
const KEPT: usize = 8;

/// How fast the offset in use follows the best one, microseconds per second.
const SLEW_US_PER_S: f64 = 1000.0;

/// The most that device clocks drift: 200 parts per million.
const DRIFT: f64 = 2e-4;

/// Interval between the first pings, and the longer interval after them.
const OFTEN: Span = Span::from_secs(1);
const SELDOM: Span = Span::from_secs(10);
const FIRST_PINGS: u32 = 8;

/// The largest device time, milliseconds: device clocks may count from 1970, but not from much earlier.
const LARGEST_MS: f64 = 1e13;

/// A ping and its answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// When the server sent the ping.
    pub asked: Time,
    /// When the device received the ping, milliseconds of its clock.
    pub got_ms: f64,
    /// When the device answered, milliseconds of its clock.
    pub answered_ms: f64,
    /// When the server received the answer.
    pub heard: Time,
}

/// The outcome of an exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PingOutcome {
    /// The first exchange: the clock is known from now on.
    First,
    /// A further exchange, which was accepted.
    Taken,
    /// The exchange contradicts earlier ones: the device's clock has jumped, and only this exchange counts now.
    Jumped,
    /// The exchange is impossible.
    Absurd,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    /// The server's clock minus the device's, microseconds.
    offset_us: f64,
    delay_us: f64,
    at: Time,
}

/// The offset in use.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Used {
    offset_us: f64,
    at: Time,
}

/// One device's clock.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClockSync {
    samples: VecDeque<Sample>,
    used: Option<Used>,
    pings: u32,
    next: Option<Time>,
    /// When the last ping was sent.
    last: Option<Time>,
}

impl ClockSync {
    /// When the next ping is due; nothing if it is due at once.
    pub fn due(&self) -> Option<Time> {
        self.next
    }

    /// Notes that a ping is sent.
    pub fn pinged(&mut self, now: Time) {
        self.pings += 1;
        self.last = Some(now);
        self.next = Some(now + if self.pings < FIRST_PINGS { OFTEN } else { SELDOM });
    }

    /// Starts over, since the device slept or its frame changed: the next sample counts at once.
    pub fn resync(&mut self) {
        self.samples.clear();
        (self.pings, self.next) = (0, None);
    }

    /// Notes that the clock may have jumped: the next ping is due at once, but not sooner than a second after the last
    /// one. The samples stay until an answer contradicts them.
    pub fn doubt(&mut self, now: Time) {
        if self.last.is_none_or(|last| now - last >= OFTEN) {
            self.next = None;
        }
    }

    /// Evaluates an exchange.
    pub fn take(&mut self, e: Exchange) -> PingOutcome {
        let plausible = |ms: f64| (0.0..LARGEST_MS).contains(&ms);
        let (got, answered) = (e.got_ms * 1000.0, e.answered_ms * 1000.0);
        let (asked, heard) = (e.asked.0 as f64, e.heard.0 as f64);
        let delay_us = (heard - asked) - (answered - got);
        // Devices round their clocks, some to a millisecond.
        if !plausible(e.got_ms) || !plausible(e.answered_ms) || answered < got || delay_us < -2000.0 {
            return PingOutcome::Absurd;
        }
        let offset_us = ((asked - got) + (heard - answered)) / 2.0;
        let sample = Sample { offset_us, delay_us: delay_us.max(0.0), at: e.heard };
        let jumped = self.best().is_some_and(|best| contradict(best, sample));
        if jumped {
            self.resync();
        }
        if self.samples.len() == KEPT {
            self.samples.pop_front();
        }
        let first = self.samples.is_empty();
        self.samples.push_back(sample);
        if first {
            let known = self.used.is_some();
            self.used = Some(Used { offset_us, at: e.heard });
            return match (jumped, known) {
                (true, _) => PingOutcome::Jumped,
                (false, true) => PingOutcome::Taken,
                (false, false) => PingOutcome::First,
            };
        }
        self.slew(e.heard);
        PingOutcome::Taken
    }

    /// The server's time of a moment on the device's clock; nothing while that clock is not known.
    pub fn when(&mut self, device_ms: f64, now: Time) -> Option<Time> {
        self.slew(now);
        let us = device_ms * 1000.0 + self.used?.offset_us;
        // Such a time may be beyond what any clock shows; the cast saturates, so the result is still a time.
        Some(Time(us.round() as i64))
    }

    /// The error bound of [`ClockSync::when`]: half the delay of the best sample, its age times the drift, and the part
    /// of the offset that is not slewed yet.
    pub fn error(&self, now: Time) -> Option<Span> {
        let (best, used) = (self.best()?, self.used?);
        let behind = (best.offset_us - used.offset_us).abs();
        Some(Span((best.bound_us(now) + behind).round() as i64))
    }

    fn best(&self) -> Option<Sample> {
        self.samples.iter().copied().min_by(|a, b| a.delay_us.total_cmp(&b.delay_us))
    }

    /// Moves the offset in use towards the best one.
    fn slew(&mut self, now: Time) {
        let (Some(best), Some(used)) = (self.best(), self.used.as_mut()) else { return };
        let most = SLEW_US_PER_S * (now - used.at).as_secs_f64().max(0.0);
        used.offset_us += (best.offset_us - used.offset_us).clamp(-most, most);
        used.at = used.at.max(now);
    }
}

impl Sample {
    /// The error bound of the sample's offset, microseconds, if the clock has not jumped.
    fn bound_us(self, now: Time) -> f64 {
        self.delay_us / 2.0 + DRIFT * (now - self.at).0.abs() as f64
    }
}

/// Whether no offset is consistent with both samples.
fn contradict(old: Sample, new: Sample) -> bool {
    let slack_us = 5000.0;
    (old.offset_us - new.offset_us).abs() > old.bound_us(new.at) + new.delay_us / 2.0 + slack_us
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ZERO: i64 = 1_800_000_000_000_000;

    /// A device whose clock reads `offset_ms` less than the server's, and runs fast by `ppm`.
    #[derive(Clone, Copy)]
    struct TestDevice {
        offset_ms: f64,
        ppm: f64,
    }

    impl TestDevice {
        fn reads(self, t: Time) -> f64 {
            let s = (t.0 - ZERO) as f64 / 1000.0;
            s * (1.0 + self.ppm * 1e-6) + self.offset_ms
        }

        /// An exchange that starts at second `s`, with these delays in both directions.
        fn exchange(self, s: f64, there_ms: f64, back_ms: f64) -> Exchange {
            let asked = Time(ZERO) + Span::from_secs_f64(s);
            let got = asked + Span::from_secs_f64(there_ms / 1000.0);
            let answered = got + Span::from_millis(1);
            let heard = answered + Span::from_secs_f64(back_ms / 1000.0);
            Exchange { asked, got_ms: self.reads(got), answered_ms: self.reads(answered), heard }
        }
    }

    proptest! {
        #[test]
        fn the_error_is_never_larger_than_stated(
            offset_ms in 0.0f64..1e9, ppm in -100.0f64..100.0,
            delays in prop::collection::vec((0.5f64..80.0, 0.5f64..80.0), 1..60),
        ) {
            let device = TestDevice { offset_ms, ppm };
            let mut sync = ClockSync::default();
            let mut last: Option<(Time, f64)> = None;
            for (i, (there, back)) in delays.iter().enumerate() {
                let e = device.exchange(i as f64 * 10.0, *there, *back);
                prop_assert!(matches!(sync.take(e), PingOutcome::First | PingOutcome::Taken));
                let moment = e.heard + Span::from_millis(3);
                let told = sync.when(device.reads(moment), moment).unwrap();
                let bound = sync.error(moment).unwrap();
                prop_assert!((told - moment).0.abs() <= bound.0 + 5, "{:?} of {:?}", told - moment, bound);
                if let Some((before, offset)) = last {
                    let seconds = (moment - before).as_secs_f64();
                    let moved = sync.used.unwrap().offset_us - offset;
                    prop_assert!(moved.abs() <= SLEW_US_PER_S * seconds + 5.0, "1 ms per second");
                }
                last = Some((moment, sync.used.unwrap().offset_us));
            }
        }
    }

    #[test]
    fn the_sample_with_the_least_delay_counts() {
        let device = TestDevice { offset_ms: 5000.0, ppm: 0.0 };
        let mut sync = ClockSync::default();
        assert_eq!(sync.take(device.exchange(0.0, 200.0, 2.0)), PingOutcome::First);
        assert_eq!(sync.error(device.exchange(0.0, 200.0, 2.0).heard), Some(Span::from_millis(101)));
        assert_eq!(sync.take(device.exchange(1.0, 2.0, 2.0)), PingOutcome::Taken);
        for i in 2..6 {
            sync.take(device.exchange(f64::from(i), 2.0, 150.0));
        }
        let later = Time(ZERO) + Span::from_secs(200);
        let told = sync.when(device.reads(later), later).unwrap();
        assert!((told - later).0.abs() < 100, "after 99 ms at 1 ms a second: {:?}", told - later);
    }

    #[test]
    fn a_clock_that_drifts_is_followed() {
        let device = TestDevice { offset_ms: 0.0, ppm: 80.0 };
        let mut sync = ClockSync::default();
        for i in 0..360 {
            let e = device.exchange(f64::from(i) * 10.0, 5.0, 5.0);
            assert_ne!(sync.take(e), PingOutcome::Jumped);
            let told = sync.when(device.reads(e.heard), e.heard).unwrap();
            assert!((told - e.heard).0.abs() < 8000, "{i}: {:?}", told - e.heard);
        }
    }

    #[test]
    fn a_clock_that_jumps_is_believed_at_once() {
        let mut sync = ClockSync::default();
        let before = TestDevice { offset_ms: 0.0, ppm: 0.0 };
        (0..8).for_each(|i| _ = sync.take(before.exchange(f64::from(i), 3.0, 3.0)));
        let after = TestDevice { offset_ms: -4000.0, ppm: 0.0 };
        let e = after.exchange(20.0, 3.0, 3.0);
        assert_eq!(sync.take(e), PingOutcome::Jumped);
        let told = sync.when(after.reads(e.heard), e.heard).unwrap();
        assert!((told - e.heard).0.abs() < 100, "{:?}", told - e.heard);
        assert_eq!(sync.due(), None, "the next ping goes out at once");
    }

    #[test]
    fn after_a_sleep_the_next_sample_counts_alone() {
        let mut sync = ClockSync::default();
        let device = TestDevice { offset_ms: 0.0, ppm: 0.0 };
        sync.take(device.exchange(0.0, 3.0, 3.0));
        sync.resync();
        let still = Time(ZERO) + Span::from_secs(2);
        assert!(sync.when(device.reads(still), still).is_some(), "the old offset serves meanwhile");
        let slept = TestDevice { offset_ms: -30.0, ppm: 0.0 };
        let e = slept.exchange(60.0, 3.0, 3.0);
        assert_eq!(sync.take(e), PingOutcome::Taken);
        assert!((sync.when(slept.reads(e.heard), e.heard).unwrap() - e.heard).0.abs() < 100);
    }

    #[test]
    fn what_cannot_be_is_not_taken() {
        let mut sync = ClockSync::default();
        let good = TestDevice { offset_ms: 0.0, ppm: 0.0 }.exchange(5.0, 3.0, 3.0);
        for bad in [
            Exchange { got_ms: f64::NAN, ..good },
            Exchange { got_ms: -1.0, ..good },
            Exchange { answered_ms: 1e15, ..good },
            Exchange { answered_ms: good.got_ms - 1.0, ..good },
            Exchange { answered_ms: good.got_ms + 100.0, ..good },
        ] {
            assert_eq!(sync.take(bad), PingOutcome::Absurd, "{bad:?}");
        }
        assert_eq!(sync.when(5000.0, good.heard), None);
    }

    #[test]
    fn pings_go_out_every_second_at_first_and_then_seldom() {
        let mut sync = ClockSync::default();
        assert_eq!(sync.due(), None);
        let mut now = Time(ZERO);
        for _ in 0..10 {
            sync.pinged(now);
            now = sync.due().unwrap();
        }
        assert_eq!(now, Time(ZERO) + Span::from_secs(7 + 30));
        sync.resync();
        assert_eq!(sync.due(), None);
    }
}

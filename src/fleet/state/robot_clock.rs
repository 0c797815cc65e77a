//! A robot's clock, as its reports show it: measured by when they come in, and trusted for nothing but how old a report
//! is.
//!
//! Main types: [`RobotClock`], [`ReportOrder`] (which reports of a robot are news: those with a number above
//! all before).
//! Refuses: reports that were overtaken, and to order reports by their dates.

use giveway_floor::time::{Span, Time};

/// A date further ahead of the measured clock than this is wrong, or the clock was set.
const FAR: Span = Span::from_secs(60);

/// After this many reports in a row that are dated far ahead, the clock was set.
const AGREE: u32 = 10;

/// How unevenly clocks run at most: the measured lead shrinks by this share of the elapsed time.
const DRIFT: f64 = 1e-4;

/// How far a robot's clock is ahead of the fleet's own.
#[derive(Clone, Copy, Debug)]
struct RobotClock {
    /// The largest lead of a report's date over its time of arrival: that of the fastest reports.
    ahead: Span,
    at: Time,
    /// How many reports in a row were dated far ahead of that lead.
    odd: u32,
}

impl RobotClock {
    fn new(date: Time, now: Time) -> RobotClock {
        RobotClock { ahead: date - now, at: now, odd: 0 }
    }

    /// The date of a report or, if it is too far ahead, what the date would be by the measured clock.
    fn believe(&mut self, date: Time, now: Time) -> Time {
        let by_arrival = date - now;
        let elapsed_s = (now - self.at).max(Span::ZERO).as_secs_f64();
        self.ahead = self.ahead - Span::from_secs_f64(elapsed_s * DRIFT);
        self.at = now;
        if by_arrival <= self.ahead + FAR {
            self.odd = 0;
            self.ahead = self.ahead.max(by_arrival);
            return date;
        }
        self.odd += 1;
        if self.odd >= AGREE {
            *self = RobotClock::new(date, now);
            return date;
        }
        now + self.ahead
    }
}

/// In which order a robot made its reports, and when it made them.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReportOrder {
    clock: Option<RobotClock>,
    /// The number of the newest report, and its date.
    newest: Option<(u64, Time)>,
}

impl ReportOrder {
    /// When a report that came in at `now` was made, in the fleet's own time; nothing if a later one came in before it.
    pub fn take(&mut self, seq: u64, date: Time, now: Time) -> Option<Time> {
        if self.newest.is_some_and(|(newest, _)| seq <= newest) {
            return None;
        }
        // A later report with an earlier date: the clock was set back.
        let was_set_back = self.newest.is_some_and(|(_, newest)| date < newest);
        let mut clock = self.clock.filter(|_| !was_set_back).unwrap_or_else(|| RobotClock::new(date, now));
        let believed = clock.believe(date, now);
        (self.clock, self.newest) = (Some(clock), Some((seq, believed)));
        Some((believed - clock.ahead).min(now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How old each report seems, ms; one comes in every 100 ms without delay, dated this much ahead of that time.
    fn ages(ahead_ms: impl IntoIterator<Item = i64>) -> Vec<i64> {
        let mut order = ReportOrder::default();
        let take = |(i, ms): (usize, i64)| {
            let at = Time::ZERO + Span::from_millis(100_000 + 100 * i as i64);
            let made = order.take(i as u64, at + Span::from_millis(ms), at).expect("none was overtaken");
            (at - made).0 / 1000
        };
        ahead_ms.into_iter().enumerate().map(take).collect()
    }

    #[test]
    fn a_report_dated_a_day_ahead_silences_its_robot_for_no_moment_and_ages_no_report() {
        let day = 86_400_000;
        for ahead in [0, 3_600_000, -3_600_000] {
            let reports = (0..30).map(|i| if i == 5 { day } else { ahead });
            assert_eq!(ages(reports), [0; 30], "a clock that is {ahead} ms ahead");
        }
    }

    #[test]
    fn a_clock_that_is_set_back_or_ahead_silences_no_robot_and_ages_no_report() {
        for set in [-3_600_000, -3000, -150, 3_600_000] {
            assert_eq!(ages([0; 10].into_iter().chain([set; 60])), [0; 70], "set by {set} ms");
        }
        let ages = ages([3_000; 10].into_iter().chain([2_950; 10]));
        assert!(ages.iter().all(|age| (0..=50).contains(age)), "set back by less than goes by: {ages:?}");
    }

    #[test]
    fn reports_that_were_overtaken_or_come_twice_are_no_news_whatever_the_clock_shows() {
        for set in [0, -3_600_000, 3_600_000] {
            let mut order = ReportOrder::default();
            let at = |ms: i64| Time::ZERO + Span::from_millis(ms);
            let made = [(10, 1100), (9, 1150), (10, 1200), (13, 1400), (11, 1450), (12, 1500), (13, 9000)];
            let taken = made.map(|(seq, now)| {
                let date = at(i64::try_from(seq).unwrap() * 100 + if seq > 11 { set } else { 0 });
                order.take(seq, date, at(now)).is_some()
            });
            assert_eq!(taken, [true, false, false, true, false, false, false], "set by {set} ms");
        }
    }
}

//! The clock of a robot, as its reports show it: measured by when they come in, and believed about nothing else.
//!
//! Main types: [`RobotClock`], [`ReportOrder`] (which reports of a robot are news). A robot's dates order its own
//! reports while its clock goes on evenly. One report dated ahead, or a clock that is set back, silences no robot.
//! Refuses: reports that were overtaken.

use giveway_floor::time::{Span, Time};

/// No message is under way for longer: one that is overtaken by less may only be late. A date that is ahead by more, or
/// before the newest by more, is wrong, or the clock was set. So a wrong date silences a robot for this long at most.
const LATEST: Span = Span::from_secs(60);

/// After so many reports in a row that say so, the clock was set.
const AGREE: u32 = 10;

/// After so long without news, and ...
const SILENT: Span = Span::from_secs(2);

/// ... so many reports in a row that are later than one another, but dated before the newest, the clock was set back.
const AFRESH: u32 = 3;

/// Clocks run at most so unevenly: the measured difference shrinks by this share of the time that goes by.
const DRIFT: f64 = 1e-4;

/// How far a robot's clock is ahead of the fleet's own.
#[derive(Clone, Copy, Debug)]
struct RobotClock {
    /// The most that dates were ahead of when they came in: those that came in fastest.
    ahead: Span,
    at: Time,
    /// How many reports in a row were dated far ahead of that.
    odd: u32,
}

impl RobotClock {
    fn new(date: Time, now: Time) -> RobotClock {
        RobotClock { ahead: date - now, at: now, odd: 0 }
    }

    /// The date of a report, or what it would be by the clock as measured, if it is too far ahead.
    fn believe(&mut self, date: Time, now: Time) -> Time {
        let by_arrival = date - now;
        let elapsed_s = (now - self.at).max(Span::ZERO).as_secs_f64();
        self.ahead = self.ahead - Span::from_secs_f64(elapsed_s * DRIFT);
        self.at = now;
        if by_arrival <= self.ahead + LATEST {
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

/// In which order the reports of one robot were made.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReportOrder {
    clock: Option<RobotClock>,
    /// The date of the newest report, and when it came in.
    newest: Option<(Time, Time)>,
    /// Reports in a row that are dated before it: the date of the last, and how many.
    older: Option<(Time, u32)>,
}

impl ReportOrder {
    /// When a report that came in `now` was made, in the fleet's own time; nothing if a later one came in before.
    pub fn take(&mut self, date: Time, now: Time) -> Option<Time> {
        let clock = self.clock.get_or_insert_with(|| RobotClock::new(date, now));
        let mut believed = clock.believe(date, now);
        if let Some((newest, heard)) = self.newest.filter(|(newest, _)| believed <= *newest) {
            if newest - believed <= LATEST {
                return None;
            }
            let count = self.older.filter(|(last, _)| *last < date).map_or(1, |(_, count)| count + 1);
            self.older = Some((date, count));
            if now - heard < SILENT || count < AFRESH {
                return None;
            }
            self.clock = Some(RobotClock::new(date, now));
            believed = date;
        }
        self.older = None;
        self.newest = Some((believed, now));
        let ahead = self.clock.map_or(Span::ZERO, |clock| clock.ahead);
        Some((believed - ahead).min(now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether each report is news; reports come in every 100 ms, dated by so much less or more than that.
    fn news(ahead_ms: impl IntoIterator<Item = i64>) -> Vec<bool> {
        let mut order = ReportOrder::default();
        let at = |i: usize| Time::ZERO + Span::from_millis(100_000 + 100 * i as i64);
        let take = |(i, ms)| {
            let made = order.take(at(i) + Span::from_millis(ms), at(i));
            assert!(made.is_none_or(|made| made <= at(i)), "nothing was seen in the future");
            made.is_some()
        };
        ahead_ms.into_iter().enumerate().map(take).collect()
    }

    #[test]
    fn a_report_dated_a_day_ahead_silences_its_robot_for_no_moment() {
        let day = 86_400_000;
        for ahead in [0, 3_600_000, -3_600_000] {
            let reports = (0..30).map(|i| if i == 5 { day } else { ahead });
            assert_eq!(news(reports), [true; 30], "a clock that is {ahead} ms ahead");
        }
    }

    #[test]
    fn a_first_report_dated_ahead_and_a_clock_that_is_set_back_silence_a_robot_for_two_seconds_at_most() {
        for reports in [[3_600_000; 1].to_vec(), [0; 10].to_vec()] {
            let before = reports.len();
            let news = news(reports.into_iter().chain([-3_600_000; 60]));
            let silent = news.iter().skip(before).take_while(|news| !**news).count();
            assert!((1..=22).contains(&silent), "{silent} reports of ten a second");
            assert!(news[before + silent..].iter().all(|news| *news));
        }
    }

    #[test]
    fn a_clock_that_is_set_ahead_counts_after_ten_reports_and_none_is_lost() {
        assert_eq!(news([0; 10].into_iter().chain([3_600_000; 60])), [true; 70]);
    }

    #[test]
    fn reports_that_were_overtaken_or_come_twice_are_no_news() {
        let mut order = ReportOrder::default();
        let at = |ms: i64| Time::ZERO + Span::from_millis(ms);
        let made = [(1000, 1100), (900, 1150), (1000, 1200), (1300, 1400), (1200, 1450), (1250, 1500)];
        let taken = made.map(|(date, now)| order.take(at(date), at(now)).is_some());
        assert_eq!(taken, [true, false, false, true, false, false]);
        assert_eq!(order.take(at(1300), at(9000)), None, "the same again, long after");
        assert_eq!(order.take(at(1200), at(9100)), None, "one that was under way for long");
    }
}

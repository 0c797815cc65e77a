//! Closures that recur, and which of their occurrences is next.
//!
//! Main types: [`RecurringClosure`], [`Recurrence`], [`Weekdays`]. Occurrences begin and end by local time
//! ([`LocalClock`]). Refuses: to read a clock, and to look up when clocks change.

use crate::state::local_clock::LocalClock;
use crate::state::worker::Closure;
use giveway_floor::time::{Span, Time, Window};

/// Least time from the beginning of one occurrence to the next.
pub const MOST_OFTEN: Span = Span::from_secs(300);
/// An occurrence is announced this long before it begins; the next one always is.
pub(crate) const ANNOUNCED: Span = Span::from_secs(3600);
/// How often recurring closures are looked at.
pub(crate) const LOOKS: Span = Span::from_secs(1);
const DAY: i64 = 24 * 3600 * 1_000_000;
/// The clock's zero was a Thursday; weekdays count from Monday.
const THURSDAY: i64 = 3;

/// Days of the week, one bit each, from Monday on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Weekdays(pub u8);

impl Weekdays {
    /// Every day.
    pub const ALL: Weekdays = Weekdays(0b111_1111);

    /// Whether the weekday of a local time is one of these days.
    fn has(self, shown: Time) -> bool {
        let day = (shown.0.div_euclid(DAY) + THURSDAY).rem_euclid(7);
        self.0 >> day & 1 == 1
    }
}

/// When a closure recurs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Recurrence {
    /// From the beginning of one occurrence to that of the next, in local time.
    pub every: Span,
    /// Only occurrences that begin on these days count.
    pub weekdays: Weekdays,
    /// The clock by which occurrences begin and end and weekdays are counted.
    pub clock: LocalClock,
    /// No occurrence begins at this time or later.
    pub until: Time,
}

/// An area that is closed again and again.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct RecurringClosure {
    /// The area; its window is that of one occurrence, whatever the weekday, in which no clock changes and whose ends
    /// the clock shows once. Every occurrence begins and ends at the local times of these ends; none begins before the
    /// window.
    pub area: Closure,
    /// When the closure recurs.
    pub recurrence: Recurrence,
    /// When the next occurrence begins that has not been announced; nothing if there is none.
    pub next: Option<Time>,
}

impl RecurringClosure {
    /// A closure whose first occurrence is in the area's own window, if the weekday fits.
    pub fn new(area: Closure, recurrence: Recurrence) -> RecurringClosure {
        let mut new = RecurringClosure { area, recurrence, next: None };
        new.next = new.first_from(new.area.window.start());
        new
    }

    /// This closure without the occurrences that begin before a time.
    pub fn not_before(self, from: Time) -> RecurringClosure {
        RecurringClosure { next: self.first_from(from), ..self }
    }

    /// Whether each occurrence is over before the next begins, they do not begin too often, and there is at least one.
    pub fn can_be(&self) -> bool {
        let every = self.recurrence.every;
        every >= MOST_OFTEN && self.lasts() <= every && self.next.is_some()
    }

    /// How long an occurrence lasts if no clock changes during it.
    pub fn lasts(&self) -> Span {
        self.area.window.end() - self.area.window.start()
    }

    /// When the first occurrence begins, at a time or later.
    pub fn first_from(&self, from: Time) -> Option<Time> {
        let Recurrence { every, weekdays, clock, until } = &self.recurrence;
        let first = clock.shown(self.area.window.start());
        let passed = ((clock.shown(from) - first).0 + every.0 - 1).div_euclid(every.0.max(1));
        // A changed clock puts an occurrence off by less than a day.
        let passed = (passed - self.slack().0 / every.0.max(1)).max(0);
        let week = 8 * DAY / every.0.max(1) + 8;
        let shown = (passed..=passed + week).map(|i| first + *every * i);
        let begins = shown.map(|shown| (shown, clock.instant(shown))).filter(|(_, at)| from <= *at);
        let found = begins.take_while(|(_, at)| at < until).find(|(shown, _)| weekdays.has(*shown));
        found.map(|(_, at)| at)
    }

    /// When the first occurrence begins, from the next one on, that is not over.
    pub fn due(&self, now: Time) -> Option<Time> {
        let is_over = |begins: Time| self.ends(begins) <= now;
        let next = self.next?;
        if !is_over(next) {
            return Some(next);
        }
        let mut begins = self.first_from(now - self.lasts() - self.slack() + Span(1))?;
        while is_over(begins) {
            begins = self.first_from(begins + Span(1))?;
        }
        Some(begins)
    }

    /// The area as closed by the occurrence that begins at a time.
    pub fn occurrence(&self, begins: Time) -> Closure {
        Closure { window: Window::new(begins, self.ends(begins)), ..self.area.clone() }
    }

    /// When an occurrence ends, by local time.
    fn ends(&self, begins: Time) -> Time {
        let clock = &self.recurrence.clock;
        clock.instant(clock.shown(begins) + self.lasts())
    }

    /// By how much an occurrence may be shifted where clocks change.
    fn slack(&self) -> Span {
        if self.recurrence.clock.changes.is_empty() { Span::ZERO } else { Span(DAY) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::worker::Binds;

    const HOUR: i64 = 3600 * 1_000_000;

    fn at(days: i64, hours: i64) -> Time {
        Time(days * DAY + hours * HOUR)
    }

    fn recurring(first: Time, weekdays: u8, utc_offset: Span, until: Time) -> RecurringClosure {
        let window = Window::new(first, first + Span(HOUR));
        let (outline, nodes, reason) = (vec![], vec![], "cleaning".to_owned());
        let area = Closure { outline, nodes, window, reason, binds: Binds::Both, series: None };
        let every = Span(DAY);
        let clock = LocalClock::fixed(utc_offset);
        RecurringClosure::new(area, Recurrence { every, weekdays: Weekdays(weekdays), clock, until })
    }

    #[test]
    fn weekdays_are_those_of_the_building() {
        // The first day is a Thursday; Friday 23:00 UTC is Saturday where the clocks are two hours ahead.
        let saturday = 1 << 5;
        let utc = recurring(at(0, 23), saturday, Span::ZERO, Time::MAX);
        assert_eq!(utc.next, Some(at(2, 23)));
        let ahead = recurring(at(0, 23), saturday, Span(2 * HOUR), Time::MAX);
        assert_eq!(ahead.next, Some(at(1, 23)));
        assert_eq!(ahead.first_from(at(1, 24)), Some(at(8, 23)), "a week later");
    }

    #[test]
    fn occurrences_that_are_over_are_passed_over_and_none_begins_after_the_end() {
        let all = recurring(at(0, 6), Weekdays::ALL.0, Span::ZERO, at(3, 6));
        assert_eq!(all.next, Some(at(0, 6)));
        assert_eq!(all.due(at(0, 6) + Span(HOUR - 1)), Some(at(0, 6)), "it is in force still");
        assert_eq!(all.due(at(0, 7)), Some(at(1, 6)));
        assert_eq!(all.first_from(at(2, 6)), Some(at(2, 6)));
        assert_eq!(all.first_from(at(2, 7)), None);
        assert!(!recurring(at(0, 6), 0, Span::ZERO, Time::MAX).can_be(), "on no day");
    }

    #[test]
    fn occurrences_follow_the_clock_on_the_wall_and_one_of_02_30_has_a_meaning_on_days_of_change() {
        let change = |day: i64, ahead: i64| (at(day, 1), Span(ahead * HOUR));
        let clock = LocalClock {
            zone: Some("Europe/Berlin".into()),
            offset: Span(HOUR),
            changes: vec![change(88, 2), change(298, 1)],
        };
        let daily = |from: (i64, i64), lasts: i64| {
            let minutes = from.0 * 60 + from.1 - 60;
            let window = Window::new(
                at(80, 0) + Span(minutes * HOUR / 60),
                at(80, 0) + Span((minutes + lasts) * HOUR / 60),
            );
            let area = Closure {
                outline: vec![],
                nodes: vec![],
                window,
                reason: "cleaning".into(),
                binds: Binds::Both,
                series: None,
            };
            let (every, clock) = (Span(DAY), clock.clone());
            RecurringClosure::new(
                area,
                Recurrence { every, weekdays: Weekdays::ALL, clock, until: Time::MAX },
            )
        };
        // From midnight UTC of a day: when it begins, and how many minutes it lasts.
        let on = |series: &RecurringClosure, day: i64| {
            let begins = series.first_from(at(day, 0)).unwrap();
            let window = series.occurrence(begins).window;
            ((begins - at(day, 0)).0 * 60 / HOUR, (window.end() - begins).0 * 60 / HOUR)
        };
        let (evening, night) = (daily((22, 0), 30), daily((22, 0), 480));
        assert_eq!(
            [on(&evening, 87), on(&evening, 88), on(&evening, 298)].map(|o| o.0),
            [21 * 60, 20 * 60, 21 * 60]
        );
        // From 22:00 to 06:00 whatever happens between.
        let begins = |day: i64| night.first_from(at(day, 18)).unwrap();
        let lasts = |day: i64| (night.occurrence(begins(day)).window.end() - begins(day)).0 / HOUR;
        assert_eq!([lasts(80), lasts(87), lasts(88), lasts(297), lasts(298)], [8, 7, 8, 9, 8]);
        // 02:30 does not exist on day 88: it is 03:30. On day 298 it comes twice: the first time counts.
        let small_hours = daily((2, 30), 60);
        assert_eq!([on(&small_hours, 80), on(&small_hours, 87)], [(90, 60); 2]);
        assert_eq!([on(&small_hours, 88), on(&small_hours, 89)], [(90, 60), (30, 60)]);
        assert_eq!(
            [on(&small_hours, 298), on(&small_hours, 299)],
            [(30, 120), (90, 60)],
            "to 03:30 by the clock"
        );
        // One a day, whatever the season, and none twice.
        let mut begins = small_hours.next.unwrap();
        for _ in 80..400 {
            let next = small_hours.first_from(begins + Span(1)).unwrap();
            assert!((22 * HOUR..=26 * HOUR).contains(&(next - begins).0), "{begins:?} {next:?}");
            begins = next;
        }
        assert_eq!(
            small_hours.due(at(88, 2)),
            Some(at(88, 0) + Span(HOUR * 3 / 2)),
            "in force until 02:30 UTC"
        );
        assert_eq!(small_hours.due(at(88, 3)), Some(at(89, 0) + Span(HOUR / 2)));
    }
}

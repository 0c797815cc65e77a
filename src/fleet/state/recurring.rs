//! Closures that recur: which occurrence is the next.
//!
//! Main types: [`RecurringClosure`], [`Recurrence`], [`Weekdays`]. Weekdays are those of a fixed offset from UTC, so
//! that what follows from a recurrence never depends on a calendar that is updated. Refuses: to read a clock, and to
//! know of daylight saving time.

use crate::fleet::state::worker::Closure;
use crate::time::{Span, Time, Window};

/// Occurrences begin no oftener than this.
pub const MOST_OFTEN: Span = Span::from_secs(300);
/// An occurrence is announced so long before it begins; the next one always is.
pub(in crate::fleet) const ANNOUNCED: Span = Span::from_secs(3600);
/// What recurs is looked at this often.
pub(in crate::fleet) const LOOKS: Span = Span::from_secs(1);
const DAY: i64 = 24 * 3600 * 1_000_000;
/// The clock's zero was a Thursday; weekdays count from Monday.
const THURSDAY: i64 = 3;

/// Days of the week, one bit each, from Monday on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Weekdays(pub u8);

impl Weekdays {
    /// Every day.
    pub const ALL: Weekdays = Weekdays(0b111_1111);

    /// Whether the day of a time, so far from UTC, is one of them.
    fn has(self, at: Time, utc_offset: Span) -> bool {
        let day = ((at.0 + utc_offset.0).div_euclid(DAY) + THURSDAY).rem_euclid(7);
        self.0 >> day & 1 == 1
    }
}

/// When a closure recurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Recurrence {
    /// From the beginning of one occurrence to that of the next.
    pub every: Span,
    /// Only occurrences that begin on these days count.
    pub weekdays: Weekdays,
    /// How far the local time, in which weekdays are meant, is ahead of UTC.
    pub utc_offset: Span,
    /// No occurrence begins then or later.
    pub until: Time,
}

/// An area that is closed again and again.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct RecurringClosure {
    /// The area; its window is that of the first occurrence, whatever the weekday.
    pub area: Closure,
    /// When it recurs.
    pub recurrence: Recurrence,
    /// When the next occurrence begins that is not announced yet; nothing where there is none.
    pub next: Option<Time>,
}

impl RecurringClosure {
    /// An area that is closed first in its own window, if the weekday fits.
    pub fn new(area: Closure, recurrence: Recurrence) -> RecurringClosure {
        let mut new = RecurringClosure { area, recurrence, next: None };
        new.next = new.first_from(new.area.window.start());
        new
    }

    /// Whether an occurrence is over before the next begins, they do not begin too often, and there is one.
    pub fn can_be(&self) -> bool {
        let Recurrence { every, .. } = self.recurrence;
        every >= MOST_OFTEN && self.lasts() <= every && self.next.is_some()
    }

    /// How long each occurrence lasts.
    pub fn lasts(&self) -> Span {
        self.area.window.end() - self.area.window.start()
    }

    /// The first occurrence that begins at a time or later.
    pub fn first_from(&self, from: Time) -> Option<Time> {
        let Recurrence { every, weekdays, utc_offset, until } = self.recurrence;
        let first = self.area.window.start();
        let passed = ((from - first).0.max(0) + every.0 - 1) / every.0.max(1);
        let week = 7 * DAY / every.0.max(1) + 8;
        let begins = (passed..=passed + week).map(|i| first + every * i);
        begins.take_while(|t| *t < until).find(|t| weekdays.has(*t, utc_offset))
    }

    /// The first occurrence from the next on that is not over.
    pub fn due(&self, now: Time) -> Option<Time> {
        let next = self.next?;
        if next + self.lasts() > now { Some(next) } else { self.first_from(now - self.lasts() + Span(1)) }
    }

    /// The area as it is closed from a time on.
    pub fn occurrence(&self, begins: Time) -> Closure {
        Closure { window: Window::new(begins, begins + self.lasts()), ..self.area.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::state::worker::Binds;

    const HOUR: i64 = 3600 * 1_000_000;

    fn at(days: i64, hours: i64) -> Time {
        Time(days * DAY + hours * HOUR)
    }

    fn recurring(first: Time, weekdays: u8, utc_offset: Span, until: Time) -> RecurringClosure {
        let window = Window::new(first, first + Span(HOUR));
        let (outline, nodes, reason) = (vec![], vec![], "cleaning".to_owned());
        let area = Closure { outline, nodes, window, reason, binds: Binds::Both, series: None };
        let every = Span(DAY);
        RecurringClosure::new(area, Recurrence { every, weekdays: Weekdays(weekdays), utc_offset, until })
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
}

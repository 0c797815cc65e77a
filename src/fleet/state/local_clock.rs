//! Local time: how far it is ahead of UTC, and when that changes.
//!
//! Main type: [`LocalClock`]. The edge that takes a request looks up the changes and stores them with it, so that the
//! outcome is the same on every machine, after every restart and in every replay, whatever tables of time zones are
//! installed. Refuses: to read such a table.

use giveway_floor::time::{Span, Time};

/// How far local time is ahead of UTC: a first offset, and later ones.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct LocalClock {
    /// Name of the time zone; nothing for a fixed offset.
    pub zone: Option<String>,
    /// How far local time is ahead of UTC before the first change.
    pub offset: Span,
    /// Later offsets, each with the time from which on it applies, ascending.
    pub changes: Vec<(Time, Span)>,
}

impl LocalClock {
    /// A clock that never changes.
    pub fn fixed(offset: Span) -> LocalClock {
        LocalClock { zone: None, offset, changes: Vec::new() }
    }

    /// How far local time is ahead of UTC at a time.
    pub fn offset_at(&self, at: Time) -> Span {
        let before = self.changes.iter().rev().find(|(from, _)| *from <= at);
        before.map_or(self.offset, |(_, offset)| *offset)
    }

    /// The local time, counted as if it were UTC.
    pub fn shown(&self, at: Time) -> Time {
        at + self.offset_at(at)
    }

    /// When the clock shows this local time. If it shows the time twice, as clocks are put back, the first counts. If
    /// it skips the time, as clocks are put forward, the result is later by the skipped span: 02:30 becomes 03:30.
    pub fn instant(&self, shown: Time) -> Time {
        let first = (self.offset, Time(i64::MIN));
        let stretches =
            std::iter::once(first).chain(self.changes.iter().map(|(from, offset)| (*offset, *from)));
        let ends = self.changes.iter().map(|(from, _)| *from).chain([Time::MAX]);
        let mut by_the_one_before = shown;
        for ((offset, from), end) in stretches.zip(ends) {
            let at = shown - offset;
            if at < end {
                return if at < from { by_the_one_before } else { at };
            }
            by_the_one_before = at;
        }
        by_the_one_before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOUR: i64 = 3600 * 1_000_000;

    /// An hour ahead, two in summer: from day 88, 01:00 UTC to day 298, 01:00 UTC.
    fn berlin() -> LocalClock {
        let at = |day: i64| Time((day * 24 + 1) * HOUR);
        let changes = vec![(at(88), Span(2 * HOUR)), (at(298), Span(HOUR))];
        LocalClock { zone: Some("Europe/Berlin".into()), offset: Span(HOUR), changes }
    }

    fn at(day: i64, minutes: i64) -> Time {
        Time((day * 24 * 60 + minutes) * HOUR / 60)
    }

    #[test]
    fn a_time_shown_is_the_time_it_is_shown_at() {
        let clock = berlin();
        for (shown, utc) in [
            (at(10, 120), at(10, 60)),
            (at(88, 119), at(88, 59)),
            // Passed over: 02:30 is 03:30, half past one in UTC; 03:00 is when the clock is put forward.
            (at(88, 150), at(88, 90)),
            (at(88, 180), at(88, 60)),
            (at(200, 120), at(200, 0)),
            // Shown twice: the first time counts.
            (at(298, 150), at(298, 30)),
            (at(298, 180), at(298, 120)),
        ] {
            assert_eq!(clock.instant(shown), utc, "{shown:?}");
        }
        assert_eq!(clock.shown(at(88, 90)), at(88, 210), "what was passed over shows an hour later");
        assert_eq!(LocalClock::fixed(Span(-HOUR)).instant(at(5, 0)), at(5, 60));
    }
}

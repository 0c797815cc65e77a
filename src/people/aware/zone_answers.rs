//! Counts of how robots answered potential collision zones with workers: the replans that keeping a route and waiting
//! save.
//!
//! Main types: [`ZoneAnswer`], [`ZoneCounts`], [`OpenZone`] (one in progress). Source: Ye, Guo, Guo and Luo 2024, the
//! decision model of section 3.4, which changes a route only if neither suffices. Refuses: to decide.

use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};

/// A zone that recurs within this time is the same one: forecasts waver.
const SAME: Span = Span::from_secs(5);

/// A robot's answer to a zone, in order of increasing cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ZoneAnswer {
    /// Keep the route and its times.
    Keep,
    /// Keep the route and arrive later.
    Slow,
    /// Look for another route.
    Change,
}

/// Number of zones by their strongest answer, each counted once when it is over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ZoneCounts {
    /// Zones for which the robot kept its route and its times.
    pub keep: u64,
    /// Zones for which the robot kept its route and arrived later.
    pub slow: u64,
    /// Zones for which the robot looked for another route.
    pub change: u64,
}

impl ZoneCounts {
    fn count(&mut self, answer: ZoneAnswer) {
        match answer {
            ZoneAnswer::Keep => self.keep += 1,
            ZoneAnswer::Slow => self.slow += 1,
            ZoneAnswer::Change => self.change += 1,
        }
    }
}

/// The zone that a robot will share with a worker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenZone {
    worker: WorkerId,
    strongest: ZoneAnswer,
    seen: Time,
}

/// Records the robot's present answer, if any, after its previous one; counts a zone that is over.
pub fn note(
    before: Option<OpenZone>,
    answer: Option<(WorkerId, ZoneAnswer)>,
    now: Time,
    counts: &mut ZoneCounts,
) -> Option<OpenZone> {
    let goes_on =
        |zone: &OpenZone| now - zone.seen < SAME && answer.is_none_or(|(worker, _)| worker == zone.worker);
    if let Some(over) = before.filter(|zone| !goes_on(zone)) {
        counts.count(over.strongest);
    }
    let before = before.filter(goes_on);
    let Some((worker, answer)) = answer else { return before };
    let strongest = before.map_or(answer, |zone| zone.strongest.max(answer));
    Some(OpenZone { worker, strongest, seen: now })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zone_is_counted_once_when_it_is_over_by_the_strongest_answer() {
        let (mut open, mut counts) = (None, ZoneCounts::default());
        let (ana, ben) = (WorkerId(0), WorkerId(1));
        let answers = [
            (0, Some((ana, ZoneAnswer::Keep))),
            (1, Some((ana, ZoneAnswer::Slow))),
            (2, Some((ana, ZoneAnswer::Keep))),
            (3, None),
            (5, Some((ana, ZoneAnswer::Keep))),
            (6, Some((ben, ZoneAnswer::Change))),
            (7, Some((ana, ZoneAnswer::Keep))),
        ];
        for (s, answer) in answers {
            open = note(open, answer, Time(s * 1_000_000), &mut counts);
        }
        assert_eq!(counts, ZoneCounts { keep: 0, slow: 1, change: 1 }, "the last is not over");
        open = note(open, None, Time(8_000_000), &mut counts);
        assert!(open.is_some() && counts.keep == 0, "it may come up again");
        assert_eq!(note(open, None, Time(13_000_000), &mut counts), None);
        assert_eq!(counts.keep, 1);
    }

    #[test]
    fn the_same_worker_much_later_is_another_zone_also_where_nothing_was_noted_in_between() {
        let mut counts = ZoneCounts::default();
        let answer = Some((WorkerId(0), ZoneAnswer::Slow));
        let open = note(None, answer, Time(0), &mut counts);
        note(open, answer, Time(60_000_000), &mut counts);
        assert_eq!(counts.slow, 1);
    }
}

//! Radio between server and robots: it delays and loses messages.
//!
//! Main types: [`Link`], [`LinkFaults`]. Refuses: to resend lost messages; the sender must.

use crate::random::Stream;
use crate::scenario::Faults;
use giveway_floor::time::{Span, Time};
use std::collections::VecDeque;
use std::ops::AddAssign;

/// A message that takes longer than this counts as late.
const LATE: Span = Span::from_secs(2);

/// One direction of one robot's radio.
#[derive(Debug)]
pub(super) struct Link<T> {
    faults: LinkFaults,
    losses: Stream,
    delays: Stream,
    /// Messages under way with their arrival times, in order of arrival.
    under_way: VecDeque<(Time, T)>,
    /// Counts of messages so far.
    pub counts: LinkCounts,
}

/// What a radio does to messages.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkFaults {
    delay: Span,
    /// Largest additional delay, drawn for each message.
    jitter: Span,
    /// Share of messages that get lost.
    loss: f64,
}

impl From<&Faults> for LinkFaults {
    fn from(faults: &Faults) -> LinkFaults {
        LinkFaults {
            delay: Span::from_millis(faults.message_delay_ms),
            jitter: Span::from_millis(faults.message_jitter_ms),
            loss: faults.message_loss,
        }
    }
}

/// Counts of messages that were lost or delayed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LinkCounts {
    pub lost: u64,
    /// Messages that took longer than two seconds.
    pub late: u64,
    /// Messages that arrived before one sent earlier.
    pub overtaking: u64,
}

impl AddAssign for LinkCounts {
    fn add_assign(&mut self, other: LinkCounts) {
        self.lost += other.lost;
        self.late += other.late;
        self.overtaking += other.overtaking;
    }
}

impl<T> Link<T> {
    /// A radio with one stream for losses and one for delays.
    pub fn new(faults: LinkFaults, losses: Stream, delays: Stream) -> Link<T> {
        Link { faults, losses, delays, under_way: VecDeque::new(), counts: LinkCounts::default() }
    }

    /// Changes the faults from now on; messages under way arrive as planned.
    pub fn set_faults(&mut self, faults: LinkFaults) {
        self.faults = faults;
    }

    /// Sends a message; a lost one never arrives.
    pub fn send(&mut self, now: Time, message: T) {
        let LinkFaults { delay, jitter, loss } = self.faults;
        // Without jitter no number is drawn.
        let more = if jitter > Span::ZERO {
            Span((jitter.0 as f64 * self.delays.unit()) as i64)
        } else {
            Span::ZERO
        };
        if self.losses.happens(loss) {
            self.counts.lost += 1;
            return;
        }
        let due = now + delay + more;
        let place = self.under_way.partition_point(|(other, _)| *other <= due);
        self.counts.late += u64::from(delay + more > LATE);
        self.counts.overtaking += u64::from(place < self.under_way.len());
        self.under_way.insert(place, (due, message));
    }

    /// The next message that has arrived by `now`.
    pub fn receive(&mut self, now: Time) -> Option<T> {
        self.under_way.pop_front_if(|(due, _)| *due <= now).map(|(_, m)| m)
    }

    /// Whether no message is under way.
    pub fn is_empty(&self) -> bool {
        self.under_way.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrivals(faults: &Faults) -> (Vec<usize>, LinkCounts) {
        let mut link = Link::new(faults.into(), Stream::new(1, 1, 0), Stream::new(1, 9, 0));
        let at = |i: usize| Time::from_secs_f64(i as f64 / 10.0);
        let mut arrived = Vec::new();
        for i in 0..1000 {
            if i < 500 {
                link.send(at(i), i);
            }
            arrived.extend(std::iter::from_fn(|| link.receive(at(i))));
        }
        (arrived, link.counts)
    }

    #[test]
    fn messages_with_one_delay_arrive_in_order() {
        let faults = Faults { message_delay_ms: 30_000, ..Faults::default() };
        let (arrived, counts) = arrivals(&faults);
        assert_eq!(arrived, (0..500).collect::<Vec<_>>());
        assert_eq!(counts, LinkCounts { lost: 0, late: 500, overtaking: 0 });
    }

    #[test]
    fn messages_with_jitter_overtake_one_another_and_all_arrive() {
        let faults = Faults { message_delay_ms: 100, message_jitter_ms: 3000, ..Faults::default() };
        let (mut arrived, counts) = arrivals(&faults);
        assert!(counts.overtaking > 100 && (50..450).contains(&counts.late), "{counts:?}");
        assert!(!arrived.is_sorted());
        arrived.sort_unstable();
        assert_eq!(arrived, (0..500).collect::<Vec<_>>());
    }

    #[test]
    fn the_same_messages_are_lost_with_and_without_jitter() {
        let faults = Faults { message_loss: 0.3, ..Faults::default() };
        let (plain, _) = arrivals(&faults);
        let (mut shaken, counts) = arrivals(&Faults { message_jitter_ms: 3000, ..faults });
        shaken.sort_unstable();
        assert_eq!(plain, shaken);
        assert!((100..200).contains(&counts.lost), "{counts:?}");
    }
}

//! Calm guidance: a message stays for a while unless a more severe one replaces it, and no worker stands for long for a
//! robot that waits for that worker.
//!
//! Main type: [`Message`]. It says when another message replaces it ([`replaces`]). Refuses: to hold back anything more
//! severe than the present message: stops leave at once.

use crate::state::floor::Floor;
use crate::state::wait_graph::{Edge, Party};
use crate::state::worker::{GuidanceReason, GuidanceState};
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::{Span, Time};

/// How long a message stays, unless a more severe one replaces it: people do not read faster, and do not believe what
/// flickers.
pub const MESSAGE: Span = Span::from_secs(2);

/// How long at most a worker stands for a robot that waits for that worker: then the worker goes. Robots that go first
/// set off within this time once the worker stands.
pub const STANDOFF: Span = Span::from_secs(4);

/// A standoff that is broken for less than this goes on: another robot comes by, or the waiting robot moves a little.
const BREAK: Span = Span::from_secs(1);

/// What a worker is told, besides the path.
pub type Words = (GuidanceState, Option<GuidanceReason>);

/// What a worker is told and since when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message {
    /// What the worker is told.
    pub words: Words,
    /// Since when the state has been the present one; the reason may have changed.
    pub since: Time,
    standoff: Option<Standoff>,
}

/// A standoff: a worker is told to stand for a robot that waits for that worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Standoff {
    since: Time,
    /// When the standoff last held.
    last: Time,
    /// Whether the standoff holds now, and not only a moment ago.
    lasts: bool,
}

impl Standoff {
    fn next(before: Option<Standoff>, is_against: bool, now: Time) -> Option<Standoff> {
        match before {
            _ if is_against => {
                let since = before.map_or(now, |s| s.since);
                Some(Standoff { since, last: now, lasts: true })
            }
            Some(s) if now - s.last < BREAK => Some(Standoff { lasts: false, ..s }),
            _ => None,
        }
    }
}

impl Message {
    /// The message for a worker who is to be told these words. What is actually said decides whether there is a
    /// standoff: words that would end it may come and go while the message that they would replace stays.
    pub fn next(
        before: Option<Message>,
        words: Words,
        is_against: impl Fn(Words) -> bool,
        now: Time,
    ) -> Message {
        let (words, since) = match before {
            // The reason that is given is always the present one.
            Some(m) if m.words.0 == words.0 => (words, m.since),
            Some(m) if !replaces(words, m.words) && now - m.since < MESSAGE => (m.words, m.since),
            _ => (words, now),
        };
        let standoff = Standoff::next(before.and_then(|m| m.standoff), is_against(words), now);
        Message { words, since, standoff }
    }

    /// Until when at least the message stays, if it tells the worker to wait for a robot that crosses.
    pub fn waits_on(self) -> Option<Time> {
        matches!(self.words.1, Some(GuidanceReason::RobotCrosses(_))).then_some(self.since + MESSAGE)
    }

    /// Whether the worker has stood for a robot for so long that the worker had better go.
    pub fn is_standoff(&self, now: Time) -> bool {
        self.standoff.is_some_and(|s| s.lasts && now - s.since >= STANDOFF)
    }

    /// Whether the worker goes before this robot, which waits for the worker: the standoff has lasted long enough, or
    /// the worker has been told to go.
    pub fn goes_before(&self, robot: RobotId, now: Time) -> bool {
        let told = (GuidanceState::Redirected, Some(GuidanceReason::RobotWaits(robot)));
        self.words == told || self.is_standoff(now)
    }
}

/// Whether words replace others at once: they are more severe, or the worker has done what the others asked for, and
/// has to be told what comes next.
pub fn replaces(words: Words, before: Words) -> bool {
    let asked = matches!(before.1, Some(GuidanceReason::PlaceUnsure(_) | GuidanceReason::NotTracked));
    asked || severity(words.0) > severity(before.0)
}

/// How much depends on the worker doing as told.
fn severity(state: GuidanceState) -> u8 {
    match state {
        GuidanceState::Idle => 0,
        GuidanceState::Following => 1,
        GuidanceState::Deviating | GuidanceState::Redirected => 2,
        GuidanceState::Stop => 3,
    }
}

impl GuidanceReason {
    /// The robot for which a worker is told to stand, if the worker goes first should that robot wait for the worker. A
    /// robot that has starved goes first itself and has half a minute for that (`lets_pass.rs`), and a worker who is to
    /// touch marks can end the wait by that.
    pub fn stands_for(self) -> Option<RobotId> {
        match self {
            GuidanceReason::RobotInTheWay(r)
            | GuidanceReason::RobotCrosses(r)
            | GuidanceReason::RobotComes(r) => Some(r),
            _ => None,
        }
    }
}

impl Floor<'_> {
    /// The robot for which a worker is told to stand, if that robot itself waits for the worker.
    pub(crate) fn stands_against(&self, worker: WorkerId, words: Words) -> Option<RobotId> {
        let robot = words.1.filter(|_| words.0 == GuidanceState::Stop)?.stands_for()?;
        (self.waits.robot(robot).edge == Edge::On(Party::Worker(worker))).then_some(robot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: RobotId = RobotId(1);
    const FOLLOW: Words = (GuidanceState::Following, None);
    const STOP: Words = (GuidanceState::Stop, Some(GuidanceReason::RobotComes(R)));
    const GO: Words = (GuidanceState::Redirected, Some(GuidanceReason::RobotWaits(R)));

    fn against(words: Words) -> bool {
        words == STOP
    }

    fn never(_: Words) -> bool {
        false
    }

    #[test]
    fn a_stop_replaces_everything_at_once_and_itself_stands_for_two_seconds() {
        let at = |ms: i64| Time(ms * 1000);
        let first = Message::next(None, FOLLOW, never, at(0));
        let stop = Message::next(Some(first), STOP, never, at(50));
        assert_eq!((stop.words, stop.since), (STOP, at(50)), "at once");
        let held = Message::next(Some(stop), FOLLOW, never, at(2040));
        assert_eq!((held.words, held.since), (STOP, at(50)));
        assert_eq!(Message::next(Some(held), FOLLOW, never, at(2050)).words, FOLLOW);
    }

    #[test]
    fn a_message_that_comes_and_goes_ten_times_a_second_changes_every_two_seconds_at_most() {
        let (mut message, mut changes) = (Message::next(None, FOLLOW, never, Time(0)), 0);
        for i in 1..=900i64 {
            let words = if i % 2 == 0 { FOLLOW } else { STOP };
            let next = Message::next(Some(message), words, never, Time(i * 100_000));
            changes += i32::from(next.words != message.words);
            message = next;
        }
        assert!((40..=90).contains(&changes), "{changes} in 90 s, every stop for two seconds");
    }

    #[test]
    fn another_robot_that_comes_by_for_a_moment_is_no_break_and_one_that_drives_on_is() {
        let other: Words = (GuidanceState::Stop, Some(GuidanceReason::RobotComes(RobotId(2))));
        let after = |moment: std::ops::Range<i64>| {
            let mut message = None;
            for ms in (0..=4000).step_by(100) {
                let wanted = if moment.contains(&ms) { other } else { STOP };
                message = Some(Message::next(message, wanted, against, Time(ms * 1000)));
            }
            message.unwrap().is_standoff(Time(4_000_000))
        };
        assert!(after(1000..1800) && after(2000..2100));
        assert!(!after(1000..2200), "it begins anew");
        assert!(!after(3900..4100), "nobody goes before a robot that does not wait just now");
    }

    #[test]
    fn a_standoff_is_one_after_four_seconds_without_a_break() {
        let mut message = None;
        for ms in (0..4000).step_by(100) {
            let next = Message::next(message, STOP, against, Time(ms * 1000));
            assert!(!next.is_standoff(Time(ms * 1000)));
            message = Some(next);
        }
        let now = Time(4_000_000);
        assert!(Message::next(message, STOP, against, now).is_standoff(now));
        assert!(!Message::next(message, STOP, never, now).is_standoff(now), "the robot drives");
    }

    #[test]
    fn words_that_come_and_go_behind_a_message_that_stands_are_no_break_of_a_standoff() {
        let mut message = None;
        for ms in (0..=4000).step_by(100) {
            let wanted = if (500..1000).contains(&ms) { FOLLOW } else { STOP };
            message = Some(Message::next(message, wanted, against, Time(ms * 1000)));
            assert_eq!(message.unwrap().words, STOP, "nobody hears the other words");
        }
        assert!(message.unwrap().is_standoff(Time(4_000_000)));
    }

    #[test]
    fn who_was_told_to_go_before_a_robot_goes_on_being_told_so() {
        let at = |s: i64| Time(s * 1_000_000);
        let stop = Message::next(None, STOP, against, at(0));
        assert!(!stop.goes_before(R, at(3)) && stop.goes_before(R, at(4)));
        let go = Message::next(Some(stop), GO, against, at(4));
        assert!(go.words == GO && go.goes_before(R, at(4)) && go.goes_before(R, at(9)));
        assert!(!go.goes_before(RobotId(2), at(9)), "the one that comes then is another one");
    }
}

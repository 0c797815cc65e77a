//! What robots that stand on their way wait for in the end.
//!
//! Main types: [`WaitCause`], [`RobotTimes`]. A robot that waits for a waiting robot waits for what that one waits for.
//! Refuses: to change anything; the fleet keeps a graph of its own.

use crate::{Activity, RobotView, View, Why};
use giveway_floor::id::Dense;
use giveway_floor::time::Span;

/// Longer chains than this count as traffic; so do cycles.
const LONGEST_CHAIN: usize = 200;

/// What robots wait for in the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum WaitCause {
    /// Robots that go about their work.
    Traffic,
    /// A person on the floor.
    Person,
    /// A closed area.
    Closure,
    /// A place at a station.
    Station,
    /// A robot that cannot drive or is not heard of.
    RobotOut,
    /// A robot that a person paused, stopped or sent to maintenance.
    ByHand,
    /// Something that stands on the way.
    Obstacle,
    /// A route that has not been found yet.
    NoRoute,
}

impl WaitCause {
    /// All causes, in the order of [`RobotTimes::waiting`].
    pub const ALL: [WaitCause; 8] = [
        WaitCause::Traffic,
        WaitCause::Person,
        WaitCause::Closure,
        WaitCause::Station,
        WaitCause::RobotOut,
        WaitCause::ByHand,
        WaitCause::Obstacle,
        WaitCause::NoRoute,
    ];

    /// The word for the cause on the wire.
    pub fn word(self) -> &'static str {
        match self {
            WaitCause::Traffic => "traffic",
            WaitCause::Person => "person",
            WaitCause::Closure => "closure",
            WaitCause::Station => "station",
            WaitCause::RobotOut => "robot_out",
            WaitCause::ByHand => "by_hand",
            WaitCause::Obstacle => "obstacle",
            WaitCause::NoRoute => "no_route",
        }
    }
}

/// How long robots did what, summed over the robots.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RobotTimes {
    /// Time by activity, as in [`Activity::ALL`].
    pub activities: [Span; Activity::ALL.len()],
    /// Time by what robots waited for while their activity was waiting, as in [`WaitCause::ALL`].
    pub waiting: [Span; WaitCause::ALL.len()],
}

impl RobotTimes {
    /// The times if, for this span, all robots did what they do in this view.
    pub fn of(view: &View, span: Span) -> RobotTimes {
        let mut out = RobotTimes::default();
        for robot in &view.robots {
            out.activities[robot.activity as usize] += span;
            if robot.activity == Activity::Waiting {
                out.waiting[cause(view, robot) as usize] += span;
            }
        }
        out
    }

    /// Adds the times of another span.
    pub fn add(&mut self, other: &RobotTimes) {
        let pairs = self.activities.iter_mut().zip(other.activities);
        pairs.chain(self.waiting.iter_mut().zip(other.waiting)).for_each(|(sum, span)| *sum += span);
    }

    /// The times as text, to be stored: `word:microseconds` with blanks between.
    pub fn text(&self) -> String {
        let activities = Activity::ALL.map(Activity::word).into_iter().zip(self.activities);
        let waiting = WaitCause::ALL.map(WaitCause::word).into_iter().zip(self.waiting);
        let known = activities.chain(waiting).filter(|(_, span)| *span > Span::ZERO);
        known.map(|(word, span)| format!("{word}:{}", span.0)).collect::<Vec<_>>().join(" ")
    }

    /// Reads such a text; unknown words are left out.
    pub fn parse(text: &str) -> RobotTimes {
        let mut out = RobotTimes::default();
        for (word, span) in text.split(' ').filter_map(|entry| entry.split_once(':')) {
            let Ok(span) = span.parse().map(Span) else { continue };
            if let Some(activity) = Activity::of_word(word) {
                out.activities[activity as usize] = span;
            } else if let Some(cause) = WaitCause::ALL.into_iter().find(|c| c.word() == word) {
                out.waiting[cause as usize] = span;
            }
        }
        out
    }
}

/// What a robot waits for in the end. A robot that stands outside a station waits for what keeps the robots before it
/// there.
fn cause(view: &View, from: &RobotView) -> WaitCause {
    let mut robot = from;
    for _ in 0..LONGEST_CHAIN {
        let next = match robot.why {
            Some(Why::GivesWay(_) | Why::HandInOpening(_)) => {
                return WaitCause::Person;
            }
            Some(Why::Closed(_)) => return WaitCause::Closure,
            Some(Why::StationPaused(_)) => return WaitCause::ByHand,
            Some(Why::NoRoute) => return WaitCause::NoRoute,
            Some(Why::BlockedBy(_)) => return WaitCause::RobotOut,
            Some(Why::Obstructed(_) | Why::WayObstructed(_)) => return WaitCause::Obstacle,
            Some(Why::WaitsFor(_, next) | Why::NotItsTurn(_, next)) => Some(next),
            Some(Why::QueueFull(station)) => {
                view.stations.get(station.ix()).and_then(|s| s.robot.or(s.queue.first().copied()))
            }
            _ => return WaitCause::Traffic,
        };
        let Some(next) = next.and_then(|next| view.robots.get(next.ix())) else { return WaitCause::Traffic };
        match next.activity {
            Activity::Waiting => robot = next,
            // Robots in a queue may be kept by something that has nothing to do with the station.
            Activity::Queueing | Activity::Picking if next.why.is_some() => robot = next,
            Activity::Failed | Activity::Offline => return WaitCause::RobotOut,
            Activity::Paused | Activity::Stopped | Activity::OutOfService => return WaitCause::ByHand,
            Activity::Queueing | Activity::Picking => return WaitCause::Station,
            _ => return WaitCause::Traffic,
        }
    }
    WaitCause::Traffic
}

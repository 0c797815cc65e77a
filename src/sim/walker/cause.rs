//! Why a walker does what it does: the truth against which detection is scored. The fleet never sees it.
//!
//! Main types: [`Cause`], [`Segment`], [`Log`]. Refuses: to be known to anybody but the scorer.

use super::persona::Persona;
use crate::geometry::Point;
use crate::time::Time;

/// Why a walker moves, or stands, as it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// It follows its path, works, or waits for work.
    OnPath,
    /// It stands for a moment, the phone perhaps.
    Pause,
    /// It looks around while walking.
    LookAround,
    /// It takes another way to the same place because a robot is in the way.
    Detour,
    /// It goes to another place that the fleet knows of.
    ChangeOfMind,
    /// It goes to a place that the fleet does not know of.
    UnknownGoal,
    /// It walks without any goal.
    Wander,
    /// It runs to a colleague, or to something that fell.
    Help,
    /// It was shown a new path and keeps to the old one.
    IgnoresGuidance,
    /// A robot is near, and it takes that as its persona does.
    Reaction(Persona),
    /// The scenario sent it to a place that the fleet does not know of.
    Scripted,
}

impl Cause {
    /// All of them; one of the reactions stands for all.
    pub const ALL: [Cause; 11] = [
        Cause::OnPath,
        Cause::Pause,
        Cause::LookAround,
        Cause::Detour,
        Cause::ChangeOfMind,
        Cause::UnknownGoal,
        Cause::Wander,
        Cause::Help,
        Cause::IgnoresGuidance,
        Cause::Reaction(Persona::Yields),
        Cause::Scripted,
    ];

    /// Whether the walker leaves its path for it.
    pub fn is_deviation(self) -> bool {
        !matches!(self, Cause::OnPath | Cause::Pause | Cause::LookAround | Cause::Reaction(_))
    }

    /// The word for it in reports.
    pub fn word(self) -> &'static str {
        match self {
            Cause::OnPath => "on_path",
            Cause::Pause => "pause",
            Cause::LookAround => "look_around",
            Cause::Detour => "detour",
            Cause::ChangeOfMind => "change_of_mind",
            Cause::UnknownGoal => "unknown_goal",
            Cause::Wander => "wander",
            Cause::Help => "help",
            Cause::IgnoresGuidance => "ignores_guidance",
            Cause::Reaction(_) => "robot_reaction",
            Cause::Scripted => "scripted",
        }
    }
}

/// A stretch of time with one cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// When it began.
    pub from: Time,
    /// When the next one began; for ever while it lasts.
    pub to: Time,
    /// Why.
    pub cause: Cause,
    /// Where to, where it goes anywhere.
    pub goal: Option<Point>,
}

/// All segments of one walker, in order, without gaps.
#[derive(Clone, Debug, Default)]
pub struct Log {
    segments: Vec<Segment>,
}

impl Log {
    /// Notes what is so from `now` on; nothing where it is as before.
    pub(super) fn note(&mut self, now: Time, cause: Cause, goal: Option<Point>) {
        if let Some(last) = self.segments.last_mut() {
            let same = last.cause == cause && last.goal == goal;
            if same {
                return;
            }
            last.to = now;
        }
        self.segments.push(Segment { from: now, to: Time::MAX, cause, goal });
    }

    /// Closes the log: the walker is gone.
    pub(super) fn close(&mut self, now: Time) {
        if let Some(last) = self.segments.last_mut() {
            last.to = last.to.min(now);
        }
    }

    /// What was so, in order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }
}

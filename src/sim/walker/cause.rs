//! Why a walker does what it does: the truth against which detection is scored. The fleet never sees it.
//!
//! Main types: [`WalkCause`], [`CauseStretch`], [`Log`]. Refuses: to be known to any module but the scorer.

use super::persona::Persona;
use giveway_floor::geometry::Point;
use giveway_floor::time::Time;

/// Why a walker moves, or stands, as it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WalkCause {
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

impl WalkCause {
    /// All of them; one of the reactions stands for all.
    pub const ALL: [WalkCause; 11] = [
        WalkCause::OnPath,
        WalkCause::Pause,
        WalkCause::LookAround,
        WalkCause::Detour,
        WalkCause::ChangeOfMind,
        WalkCause::UnknownGoal,
        WalkCause::Wander,
        WalkCause::Help,
        WalkCause::IgnoresGuidance,
        WalkCause::Reaction(Persona::Yields),
        WalkCause::Scripted,
    ];

    /// Whether the walker leaves its path for it.
    pub fn is_deviation(self) -> bool {
        !matches!(self, WalkCause::OnPath | WalkCause::Pause | WalkCause::LookAround | WalkCause::Reaction(_))
    }

    /// The word for it in reports.
    pub fn word(self) -> &'static str {
        match self {
            WalkCause::OnPath => "on_path",
            WalkCause::Pause => "pause",
            WalkCause::LookAround => "look_around",
            WalkCause::Detour => "detour",
            WalkCause::ChangeOfMind => "change_of_mind",
            WalkCause::UnknownGoal => "unknown_goal",
            WalkCause::Wander => "wander",
            WalkCause::Help => "help",
            WalkCause::IgnoresGuidance => "ignores_guidance",
            WalkCause::Reaction(_) => "robot_reaction",
            WalkCause::Scripted => "scripted",
        }
    }
}

/// A stretch of time with one cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CauseStretch {
    /// When it began.
    pub from: Time,
    /// When the next one began; for ever while it lasts.
    pub to: Time,
    /// Why.
    pub cause: WalkCause,
    /// Where to, where it goes anywhere.
    pub goal: Option<Point>,
}

/// All segments of one walker, in order, without gaps.
#[derive(Clone, Debug, Default)]
pub struct Log {
    segments: Vec<CauseStretch>,
}

impl Log {
    /// Notes what is so from `now` on; nothing where it is as before.
    pub(super) fn note(&mut self, now: Time, cause: WalkCause, goal: Option<Point>) {
        if let Some(last) = self.segments.last_mut() {
            let same = last.cause == cause && last.goal == goal;
            if same {
                return;
            }
            last.to = now;
        }
        self.segments.push(CauseStretch { from: now, to: Time::MAX, cause, goal });
    }

    /// Closes the log: the walker is gone.
    pub(super) fn close(&mut self, now: Time) {
        if let Some(last) = self.segments.last_mut() {
            last.to = last.to.min(now);
        }
    }

    /// What was so, in order.
    pub fn segments(&self) -> &[CauseStretch] {
        &self.segments
    }
}

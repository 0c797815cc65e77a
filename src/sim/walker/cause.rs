//! Why a walker does what it does: the truth against which detection is scored. The fleet never sees it.
//!
//! Main types: [`WalkCause`], [`CauseStretch`], [`Log`]. Refuses: to be known to any module but the scorer.

use super::persona::Persona;
use giveway_floor::geometry::Point;
use giveway_floor::time::Time;

/// Why a walker moves, or stands, as it does; "it" below is the walker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WalkCause {
    /// It follows its path, works, or waits for work.
    OnPath,
    /// It stands for a moment, perhaps with the phone.
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
    /// It reacts to a robot nearby as its persona does.
    Reaction(Persona),
    /// The scenario sent it to a place that the fleet does not know of.
    Scripted,
}

impl WalkCause {
    /// All causes, with one reaction in place of all.
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

    /// Whether the cause makes the walker leave its path.
    pub fn is_deviation(self) -> bool {
        !matches!(self, WalkCause::OnPath | WalkCause::Pause | WalkCause::LookAround | WalkCause::Reaction(_))
    }

    /// The cause's word in reports.
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
    /// When the stretch began.
    pub from: Time,
    /// When the next stretch began; for ever while this one lasts.
    pub to: Time,
    /// The cause of the stretch.
    pub cause: WalkCause,
    /// Goal of the walker in the stretch, if there is one.
    pub goal: Option<Point>,
}

/// All stretches of one walker, in order, without gaps.
#[derive(Clone, Debug, Default)]
pub struct Log {
    segments: Vec<CauseStretch>,
}

impl Log {
    /// Records the cause and goal from `now` on; does nothing if both are unchanged.
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

    /// Closes the log when the walker is gone.
    pub(super) fn close(&mut self, now: Time) {
        if let Some(last) = self.segments.last_mut() {
            last.to = last.to.min(now);
        }
    }

    /// All stretches, in order.
    pub fn segments(&self) -> &[CauseStretch] {
        &self.segments
    }
}

//! Stops: a pause at once, past all queues, again until the robot stands.
//!
//! Main type: [`PauseLife`]. Refuses: to lift a pause that was pressed at the robot.

use super::contact::Obedience;
use super::notice::Notice;
use super::session::{AskedAction, RobotSession};
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{ActionState, ActionStatus};

pub(super) const START_PAUSE: &str = "startPause";
pub(super) const STOP_PAUSE: &str = "stopPause";
/// A pause is told again after this.
const AGAIN: Span = Span::from_millis(500);
/// A robot stands this long after it has begun to brake.
const BRAKES: Span = Span::from_secs(4);
/// How often a pause is told.
const TIMES: u32 = 10;
/// A robot that was told so often to go on is told after this only.
const PATIENCE: Span = Span::from_secs(5);
/// A robot goes on once nobody has wanted it to stand for this long: robots that are told to stand and to go on several
/// times a second carry these out late and in another order.
const HOLDS: Span = Span::from_secs(1);

/// Whether the robot is to stand, and how far it is with that.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PauseLife {
    /// Whether the fleet wants the robot to stand, and when it wanted that last.
    pub wanted: bool,
    pub wanted_at: Option<Time>,
    pub stage: PauseState,
    /// When the robot listed a pause of ours last that it had not carried out.
    pub pending: Option<Time>,
    /// Since when the robot says that it is paused, and when a pause was told last.
    pub since: Option<Time>,
    pub told: Option<Time>,
}

/// How far a robot is with a pause.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum PauseState {
    /// It may drive.
    #[default]
    Drives,
    /// It was told to stand.
    Stops(AskedAction),
    /// It stands because we told it to, since this moment.
    Stands(Time),
    /// It was told to go on.
    GoesOn(AskedAction),
    /// It was told as often as it may be told, and did not stop.
    Failed,
}

impl RobotSession {
    /// Whether the robot was seen to stand by our pause.
    pub(super) fn is_paused_by_us(&self) -> bool {
        matches!(self.pause.stage, PauseState::Stands(_))
    }

    /// Whether somebody has paused the robot where it is. Such a pause is not lifted from here.
    pub fn is_paused_by_hand(&self) -> bool {
        let ours = self.pause.stage != PauseState::Drives
            || matches!(self.obedience, Obedience::Pauses(_) | Obedience::GoesOn(_))
            || self.is_own_pause();
        self.says_paused() && !ours
    }

    /// Whether a pause of the robot is ours although we do not want it any more: it was heard of just after we had told
    /// one, or just after the robot listed one that it had still to carry out, or the last that it lists is that we
    /// told one, in this process or an earlier one. Some robots read what they are told long after it was said.
    fn is_own_pause(&self) -> bool {
        const JUST: Span = Span::from_secs(3);
        const SETTLES: Span = Span::from_secs(1);
        let Some(since) = self.pause.since else { return false };
        self.pause.told.is_some_and(|told| since - told <= JUST)
            || self.pause.pending.is_some_and(|pending| since - pending <= SETTLES)
            || self.lists_pause_last()
    }

    /// Whether the last that the robot lists of pauses that it was told is that one began.
    fn lists_pause_last(&self) -> bool {
        let Some((_, state)) = &self.state else { return false };
        let ours = |a: &&ActionState| a.id.starts_with("gw-") && a.status != ActionStatus::Failed;
        let kinds = state.actions.iter().chain(&state.instant_actions).filter(ours);
        let last =
            kinds.filter_map(|a| a.kind.as_deref()).rfind(|kind| [START_PAUSE, STOP_PAUSE].contains(kind));
        last == Some(START_PAUSE)
    }

    /// Notes in a state since when the robot is paused.
    pub(super) fn note_paused(&mut self, now: Time) {
        self.pause.since = if self.says_paused() { self.pause.since.or(Some(now)) } else { None };
        let is_pending = |a: &ActionState| {
            a.kind.as_deref() == Some(START_PAUSE) && a.id.starts_with("gw-") && !a.status.is_over()
        };
        if self
            .state
            .as_ref()
            .is_some_and(|(_, state)| state.actions.iter().chain(&state.instant_actions).any(is_pending))
        {
            self.pause.pending = Some(now);
        }
    }

    /// Tells the robot to stand or to go on, as the fleet wants, until it does.
    pub(super) fn mind_pause(&mut self, now: Time) {
        if self.unreachable(now).is_some() {
            return;
        }
        if self.pause.wanted {
            self.pause.wanted_at = Some(now);
        }
        match (self.is_pause_wanted(now), self.pause.stage.clone()) {
            (true, PauseState::Drives | PauseState::GoesOn(_)) => {
                self.pause.stage = PauseState::Stops(self.ask(now, START_PAUSE));
            }
            (true, PauseState::Stops(asked)) => match self.was_heeded(&asked, true) {
                Some(Ok(())) => self.pause.stage = PauseState::Stands(now),
                // A robot that is paused already may refuse to be paused.
                Some(Err(_)) if self.says_paused() => self.pause.stage = PauseState::Stands(now),
                _ => self.tell_again(now, asked, START_PAUSE),
            },
            // Some robots lift a pause by themselves when their order is cancelled.
            (true, PauseState::Stands(since)) if self.says_unpaused_since(since) => {
                self.pause.stage = PauseState::Stops(self.ask(now, START_PAUSE));
            }
            (true, PauseState::Stands(since)) => self.note_false_pause(since),
            (false, PauseState::Stops(_) | PauseState::Stands(_) | PauseState::Failed) => {
                self.pause.stage = PauseState::GoesOn(self.ask(now, STOP_PAUSE));
            }
            (false, PauseState::GoesOn(asked)) => match self.was_heeded(&asked, false) {
                Some(Ok(()) | Err(_)) => self.pause.stage = PauseState::Drives,
                None => self.tell_again(now, asked, STOP_PAUSE),
            },
            (false, PauseState::Drives) if self.is_own_pause() && self.has_proven() => {
                self.pause.stage = PauseState::GoesOn(self.ask(now, STOP_PAUSE));
            }
            (true, PauseState::Failed) | (false, PauseState::Drives) => {}
        }
    }

    /// Whether the robot is to stand, or was a moment ago.
    fn is_pause_wanted(&self, now: Time) -> bool {
        self.pause.wanted || self.pause.wanted_at.is_some_and(|last| now - last < HOLDS)
    }

    /// Whether a later state says that the robot is not paused.
    fn says_unpaused_since(&self, since: Time) -> bool {
        self.state.as_ref().is_some_and(|(at, state)| *at > since && state.paused == Some(false))
    }

    /// Whether an order sent now could set the robot off although it is to stand.
    pub(super) fn might_set_off(&self, now: Time) -> bool {
        self.is_pause_wanted(now) && !self.says_paused() && self.pauses()
    }

    /// Whether the robot is paused, as it says; of one that never says it, as the actions tell that it lists.
    pub(super) fn says_paused(&self) -> bool {
        let said = self.state.as_ref().map(|(_, state)| state.paused);
        said.is_some_and(|paused| paused.unwrap_or_else(|| self.lists_pause_last()))
    }

    fn tell_again(&mut self, now: Time, mut asked: AskedAction, kind: &str) {
        // A robot that has the action and brakes need not be told again: some fail what they are told twice.
        let has_it = self.action_state(&asked.id).is_some() && now - asked.since < BRAKES;
        let is_many = asked.tries >= TIMES;
        let again = if is_many && kind == STOP_PAUSE { PATIENCE } else { AGAIN };
        if now - asked.last < again || has_it {
            return;
        }
        if is_many && kind == START_PAUSE {
            let words = self.action_state(&asked.id).and_then(|a| a.result.clone());
            self.notice(Notice::NoPause { words });
            self.pause.stage = PauseState::Failed;
            return;
        }
        (asked.last, asked.tries) = (now, asked.tries + 1);
        if kind == START_PAUSE {
            self.pause.told = Some(now);
        }
        let id = asked.id.clone();
        self.instant(kind, &id, Vec::new());
        self.pause.stage = match kind {
            START_PAUSE => PauseState::Stops(asked),
            _ => PauseState::GoesOn(asked),
        };
    }

    /// Notices a robot that says that it is paused, and was seen to move after it had time to brake.
    fn note_false_pause(&mut self, since: Time) {
        const MOVES_MPS: f64 = 0.1;
        const BRAKES: Span = Span::from_millis(1500);
        let had_time = self.motion.seen().is_some_and(|seen| seen - since >= BRAKES);
        if had_time && self.motion.speed_mps() > MOVES_MPS && !self.motion.stands() {
            self.notice(Notice::FalsePause);
            self.pause.stage = PauseState::Drives;
        }
    }

    /// Whether an action of ours was finished, as the robot says.
    pub(super) fn says_finished(&self, id: &str) -> bool {
        self.action_state(id).is_some_and(|a| a.status == ActionStatus::Finished)
    }
}

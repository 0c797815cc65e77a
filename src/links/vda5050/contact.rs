//! First contact: whether a robot may be commanded, and whether it obeys.
//!
//! Main types: [`NotReady`], [`Obedience`]. Obedience is proven by a pause of the robot while it stands: seen in its
//! state, or in the state of the action. Refuses: to command a robot of which that was not seen.

use super::pause::{START_PAUSE, STOP_PAUSE};
use super::session::{AskedAction, RobotSession};
use giveway_floor::geometry::{Point, to_mm};
use giveway_floor::text::sentence::links;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{ActionStatus, ConnectionState, Factsheet, OperatingMode, Parameter};

/// A state is asked for if none came for this long.
const ASKS: Span = Span::from_secs(30);
/// A question for a state that is not answered is asked again after this at first.
const ASKS_AGAIN: Span = Span::from_secs(2);
/// A robot that was asked for its state and sent none for this long is silent.
const SILENCE: Span = Span::from_secs(35);
/// A robot that was not seen to pause, or to go on, for this long does not obey.
const PROVES: Span = Span::from_secs(10);
/// A robot this near a node is on it, metres.
pub(super) const ON_NODE_M: f64 = 0.3;

/// Why a robot is not commanded.
#[derive(Clone, Debug, PartialEq)]
pub enum NotReady {
    /// It was never heard of.
    NeverSeen,
    /// It has taken its leave.
    Offline,
    /// The broker has lost it.
    ConnectionBroken,
    /// It sleeps.
    Hibernating,
    /// It was asked for its state and has not answered.
    Silent,
    /// It speaks a version that is not spoken here.
    OtherVersion(String),
    /// Nobody but a person drives it.
    Mode(OperatingMode),
    /// It does not say where it is.
    NoPosition,
    /// It does not know where it is.
    NotLocalized,
    /// It is on a map that is not this floor.
    UnknownMap(String),
    /// It is on no node: this far from the nearest one, millimetres.
    OnNoNode(i64),
    /// It drives by an order that is not ours.
    ForeignOrder(String),
    /// It is paused, and not from here as far as is known, so that it cannot be seen to obey.
    PausedByHand,
    /// It was not seen to obey yet.
    Unproven,
    /// It did not pause when told to; its words, if it had some.
    NoPause(Option<String>),
    /// It refuses orders, in its words.
    Rejects(String),
    /// It waits at a work cell for a trigger, and takes none from here.
    NeedsButton,
}

/// Whether a robot was seen to obey.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Obedience {
    Unproven,
    /// It was told to pause.
    Pauses(AskedAction),
    /// It has paused, and was told to go on.
    GoesOn(AskedAction),
    Proven,
    Failed(Option<String>),
    /// It does not pause, and an operator agreed to that.
    Consented,
}

impl RobotSession {
    /// Why the robot is not commanded; nothing if it is.
    pub fn not_ready(&self, now: Time) -> Option<NotReady> {
        self.unreachable(now).or_else(|| self.unfit()).or_else(|| match &self.obedience {
            Obedience::Proven | Obedience::Consented => {
                let (times, words) = &self.rejected;
                let rejects = (*times >= 3).then(|| NotReady::Rejects(words.clone()));
                rejects.or_else(|| self.needs_button().then_some(NotReady::NeedsButton))
            }
            Obedience::Failed(words) => Some(NotReady::NoPause(words.clone())),
            Obedience::Unproven if self.is_paused_by_hand() => Some(NotReady::PausedByHand),
            Obedience::Unproven | Obedience::Pauses(_) | Obedience::GoesOn(_) => Some(NotReady::Unproven),
        })
    }

    /// Where the robot is on this floor, if that is known. It is in others' way there, whether it obeys or not and
    /// whoever drives it.
    pub fn whereabouts(&self, now: Time) -> Option<Point> {
        match self.unreachable(now).or_else(|| self.unfit()) {
            None | Some(NotReady::Mode(_) | NotReady::OnNoNode(_) | NotReady::ForeignOrder(_)) => {
                self.motion.pose().map(|pose| pose.at)
            }
            Some(_) => None,
        }
    }

    /// An operator agrees that the robot drives although it does not pause.
    pub fn consent(&mut self) {
        if matches!(self.obedience, Obedience::Failed(_)) {
            self.obedience = Obedience::Consented;
        }
    }

    /// Whether the robot stops when told to, as far as was seen.
    pub fn pauses(&self) -> bool {
        self.obedience == Obedience::Proven
    }

    /// Why nothing can be said to the robot.
    pub(super) fn unreachable(&self, now: Time) -> Option<NotReady> {
        if let Some(version) = &self.other_version {
            return Some(NotReady::OtherVersion(version.clone()));
        }
        match self.connection {
            Some(ConnectionState::Offline) => return Some(NotReady::Offline),
            Some(ConnectionState::Broken) => return Some(NotReady::ConnectionBroken),
            Some(ConnectionState::Hibernating) => return Some(NotReady::Hibernating),
            Some(ConnectionState::Online) | None => {}
        }
        if self.state.is_none() {
            return Some(NotReady::NeverSeen);
        }
        let is_silent = self.unanswered.is_some_and(|asked| now - asked >= SILENCE);
        is_silent.then_some(NotReady::Silent)
    }

    /// Why the robot, which can be reached, takes no orders.
    fn unfit(&self) -> Option<NotReady> {
        let (_, state) = self.state.as_ref()?;
        if !state.mode.takes_orders() {
            return Some(NotReady::Mode(state.mode));
        }
        let Some(position) = &state.position else { return Some(NotReady::NoPosition) };
        if !position.localized && self.settings.needs_localized {
            return Some(NotReady::NotLocalized);
        }
        if !self.settings.maps.iter().any(|frame| frame.name == position.map) {
            return Some(NotReady::UnknownMap(position.map.clone()));
        }
        let drives_on = !state.nodes.is_empty() || !state.edges.is_empty();
        if drives_on && self.leg().is_none_or(|leg| leg.id != state.order) && !self.is_ours(&state.order) {
            return Some(NotReady::ForeignOrder(state.order.clone()));
        }
        let joined = self.progress.is_some();
        let off = if joined { None } else { self.off_node_mm() };
        off.map(NotReady::OnNoNode)
    }

    /// How far the robot is from the nearest node, if it is on none.
    fn off_node_mm(&self) -> Option<i64> {
        let at = self.motion.pose()?.at;
        if !self.map.nodes_within(at, ON_NODE_M).is_empty() {
            return None;
        }
        let off_m = self.map.nodes.iter().map(|node| (node.at - at).norm()).fold(f64::INFINITY, f64::min);
        Some(to_mm(off_m))
    }

    /// Asks for a state if none came for long: a robot that has nothing to tell may be silent. The question or its
    /// answer may have been lost: it is asked again soon, then ever less often.
    pub(super) fn ask_for_state(&mut self, now: Time) {
        let heard = self.state.as_ref().map(|(at, _)| *at);
        let last = heard.max(self.state_asked);
        let waited = self.unanswered.zip(self.state_asked).map(|(first, last)| last - first);
        let asks = waited.map_or(ASKS, |waited| waited.clamp(ASKS_AGAIN, ASKS));
        if last.is_none_or(|last| now - last >= asks) {
            self.request_state(now);
        }
    }

    /// Asks a robot once what it can do: some do not say it by themselves.
    pub(super) fn ask_for_factsheet(&mut self, now: Time) {
        let is_there = self.state.is_some() && self.unreachable(now).is_none();
        if is_there && self.factsheet.is_none() && self.factsheet_asked.is_none() {
            self.factsheet_asked = Some(now);
            let id = self.new_id();
            self.instant("factsheetRequest", &id, Vec::new());
        }
    }

    /// What the robot says of itself, with nothing if it was asked and says nothing; no answer while it may still say
    /// something.
    pub fn answered_factsheet(&self, now: Time) -> Option<Option<&Factsheet>> {
        const ANSWERS: Span = Span::from_secs(3);
        let is_late = self.factsheet_asked.is_some_and(|asked| now - asked >= ANSWERS);
        (self.factsheet.is_some() || is_late).then_some(self.factsheet.as_deref())
    }

    /// Asks for a state now.
    pub(super) fn request_state(&mut self, now: Time) {
        self.state_asked = Some(now);
        self.unanswered.get_or_insert(now);
        self.first_asked.get_or_insert(now);
        let id = self.new_id();
        self.instant("stateRequest", &id, Vec::new());
    }

    /// Lets a robot that stands pause and go on, and looks whether it does.
    pub(super) fn prove_obedience(&mut self, now: Time) {
        if self.unreachable(now).is_some() || self.unfit().is_some() {
            return;
        }
        match self.obedience.clone() {
            // What an earlier process paused goes on, and what a person paused waits for that person.
            Obedience::Unproven if self.is_paused_by_hand() => {}
            Obedience::Unproven if self.says_paused() => {
                self.obedience = Obedience::GoesOn(self.ask(now, STOP_PAUSE));
            }
            Obedience::Unproven if self.motion.stands() => {
                self.obedience = Obedience::Pauses(self.ask(now, START_PAUSE));
            }
            Obedience::Unproven => self.look_again(now),
            Obedience::Pauses(asked) => match self.was_heeded(&asked, true) {
                Some(Ok(())) => self.obedience = Obedience::GoesOn(self.ask(now, STOP_PAUSE)),
                Some(Err(words)) => self.obedience = Obedience::Failed(words),
                None if now - asked.since >= PROVES => self.obedience = Obedience::Failed(None),
                None => self.obedience = Obedience::Pauses(self.ask_again(now, asked, START_PAUSE)),
            },
            Obedience::GoesOn(asked) => match self.was_heeded(&asked, false) {
                Some(Ok(())) => self.obedience = Obedience::Proven,
                Some(Err(words)) => self.obedience = Obedience::Failed(words),
                None if now - asked.since >= PROVES => self.obedience = Obedience::Failed(None),
                None => self.obedience = Obedience::GoesOn(self.ask_again(now, asked, STOP_PAUSE)),
            },
            Obedience::Proven | Obedience::Failed(_) | Obedience::Consented => {}
        }
    }

    /// Looks again whether the robot has done what it was asked to do, without parameters.
    pub(super) fn ask_again(&mut self, now: Time, asked: AskedAction, kind: &str) -> AskedAction {
        self.ask_again_with(now, asked, kind, Vec::new())
    }

    /// Looks again whether the robot has done what it was asked to do. What a later state does not show at all was
    /// lost, and is sent again, with the same id.
    pub(super) fn ask_again_with(
        &mut self,
        now: Time,
        mut asked: AskedAction,
        kind: &str,
        parameters: Vec<Parameter>,
    ) -> AskedAction {
        const SHOWS: Span = Span::from_millis(1500);
        /// A robot that was asked so often lists no actions: it is asked seldom from then on.
        const OFTEN: u32 = 5;
        const SELDOM: Span = Span::from_secs(30);
        let shows = if asked.tries < OFTEN { SHOWS } else { SELDOM };
        let heard = self.state.as_ref().is_some_and(|(at, _)| *at >= asked.last + shows);
        if heard && self.action_state(&asked.id).is_none() && self.unreachable(now).is_none() {
            (asked.last, asked.tries) = (now, asked.tries + 1);
            self.instant(kind, &asked.id, parameters);
        }
        self.look_again(now);
        asked
    }

    /// Asks for another state while something is to be seen in one.
    pub(super) fn look_again(&mut self, now: Time) {
        const EVERY: Span = Span::from_secs(1);
        let heard = self.state.as_ref().map(|(at, _)| *at);
        if heard.max(self.state_asked).is_none_or(|last| now - last >= EVERY) {
            self.request_state(now);
        }
    }

    /// Whether the first contact is over.
    pub(super) fn has_proven(&self) -> bool {
        matches!(self.obedience, Obedience::Proven | Obedience::Consented)
    }

    /// Asks for an instant action without parameters.
    pub(super) fn ask(&mut self, now: Time, kind: &str) -> AskedAction {
        self.ask_with(now, kind, Vec::new())
    }

    /// Asks for an instant action.
    pub(super) fn ask_with(&mut self, now: Time, kind: &str, parameters: Vec<Parameter>) -> AskedAction {
        if kind == START_PAUSE {
            self.pause.told = Some(now);
        }
        let id = self.new_id();
        self.instant(kind, &id, parameters);
        AskedAction { id, since: now, last: now, tries: 1 }
    }

    /// Whether the robot refused or failed what it was asked to do.
    pub(super) fn has_failed(&self, asked: &AskedAction) -> bool {
        self.action_state(&asked.id).is_some_and(|said| said.status == ActionStatus::Failed)
    }

    /// Whether the robot has paused, or gone on, since it was asked to; its words if it refused.
    pub(super) fn was_heeded(&self, asked: &AskedAction, pauses: bool) -> Option<Result<(), Option<String>>> {
        let (heard, state) = self.state.as_ref()?;
        if *heard < asked.since {
            return None;
        }
        let action = self.action_state(&asked.id);
        if let Some(failed) = action.filter(|a| a.status == ActionStatus::Failed) {
            return Some(Err(failed.result.clone()));
        }
        let finished = action.is_some_and(|a| a.status == ActionStatus::Finished);
        let seen = match state.paused {
            Some(paused) => paused == pauses,
            None => finished,
        };
        seen.then_some(Ok(()))
    }
}

impl NotReady {
    /// Why, for people.
    pub fn said(&self) -> Sentence {
        match self {
            NotReady::NeverSeen => links::never_heard(),
            NotReady::Offline => links::switched_off(),
            NotReady::ConnectionBroken => links::connection_lost(),
            NotReady::Hibernating => links::sleeps(),
            NotReady::Silent => links::does_not_answer(),
            NotReady::OtherVersion(version) => links::speaks_other_version(version),
            NotReady::Mode(mode) => links::not_automatic(format!("{mode:?}").to_uppercase()),
            NotReady::NoPosition => links::says_no_position(),
            NotReady::NotLocalized => links::not_localized(),
            NotReady::UnknownMap(map) => links::on_unknown_map(map),
            NotReady::OnNoNode(off_mm) => links::on_no_node(SentenceArg::rounded(*off_mm as f64 / 1000.0, 2)),
            NotReady::ForeignOrder(order) => links::drives_foreign_order(order),
            NotReady::PausedByHand => links::paused_at_robot(),
            NotReady::Unproven => links::obedience_not_seen(),
            NotReady::NoPause(Some(words)) => links::does_not_pause_since(words),
            NotReady::NoPause(None) => links::does_not_pause(),
            NotReady::Rejects(words) => links::refuses_orders(words),
            NotReady::NeedsButton => links::needs_button(),
        }
    }
}

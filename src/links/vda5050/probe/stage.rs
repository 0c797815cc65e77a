//! The stages of a probe: what is asked in each, and when the answer is there.
//!
//! Main type: [`ProbeStage`]. A stage ends with an answer or after a stated time; silence is an answer, too. Refuses:
//! two questions at once.

use super::RobotProbe;
use super::course::DeviationSpelling;
use super::findings::{ActionAnswer, CancelAnswer, DriveAnswer, IdlePause, KeySpelling};
use crate::vda5050::contact::ON_NODE_M;
use giveway_floor::geometry::Point;
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{Action, ActionStatus, BlockingType};
use std::fmt;

/// A robot is listened to at least and at most for this long before it is asked.
const LISTENS: [Span; 2] = [Span::from_secs(2), Span::from_secs(12)];
/// An answer comes within this, or not at all.
const ANSWERS: Span = Span::from_secs(4);
/// An action that does not exist takes no longer than this.
const ACTS: Span = Span::from_secs(8);
/// A robot that is to drive was seen to within this.
const SETS_OFF: Span = Span::from_secs(20);
/// A robot that says nothing for this long after it took an order reads nothing while it drives.
const SILENT: Span = Span::from_millis(1600);
/// The longest drive.
const DRIVES: Span = Span::from_secs(180);
/// A robot that has driven this far is on its way, metres.
const ON_ITS_WAY_M: f64 = 0.3;
/// An action that no robot has.
const NO_ACTION: &str = "givewayProbe";

/// What a probe is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeStage {
    /// It listens.
    Listens,
    /// It tries a key of instant actions.
    Key(usize),
    /// It waits for the factsheet.
    Sheet,
    /// It pauses the standing robot.
    Pauses,
    /// It lets the standing robot go on.
    Resumes,
    /// It sends an order to where the robot stands.
    Order,
    /// It sends the same order again.
    Again,
    /// It asks for an action that does not exist.
    Unknown,
    /// It cancels although there is no order.
    IdleCancel,
    /// It sends the robot off, with a spelling of the deviation.
    SetsOff(usize),
    /// It waits until the robot is on its way.
    OnWay,
    /// It pauses the robot on its way.
    Brakes,
    /// It lets the robot go on to the end.
    Arrives,
    /// It sends the robot back.
    Returns,
    /// It waits until the robot is on its way back.
    OnWayBack,
    /// It cancels the order on the way.
    Cancels,
    /// It sends the robot home.
    Home,
    /// It sends one more order to where the robot stands, which clears errors about earlier ones.
    Clears,
    /// It asks whether the robot is still there.
    Alive,
    /// It is over.
    Over,
}

impl ProbeStage {
    /// Whether states are asked for all the time.
    pub(super) fn needs_states(self) -> bool {
        !matches!(self, ProbeStage::Listens | ProbeStage::Key(_) | ProbeStage::Alive | ProbeStage::Over)
    }
}

impl fmt::Display for ProbeStage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ProbeStage::Listens => "listens",
            ProbeStage::Key(_) => "asks for a state",
            ProbeStage::Sheet => "asks for the factsheet",
            ProbeStage::Pauses => "pauses the standing robot",
            ProbeStage::Resumes => "lets it go on",
            ProbeStage::Order => "sends an order to where the robot stands",
            ProbeStage::Again => "sends it again",
            ProbeStage::Unknown => "asks for an action that does not exist",
            ProbeStage::IdleCancel => "cancels with nothing to cancel",
            ProbeStage::SetsOff(_) => "sends the robot off",
            ProbeStage::OnWay => "waits until it is on its way",
            ProbeStage::Brakes => "pauses it on its way",
            ProbeStage::Arrives => "lets it arrive",
            ProbeStage::Returns => "sends it back",
            ProbeStage::OnWayBack => "waits until it is on its way back",
            ProbeStage::Cancels => "cancels the order on the way",
            ProbeStage::Home => "sends it home",
            ProbeStage::Clears => "sends a last order to where it stands",
            ProbeStage::Alive => "asks whether it is still there",
            ProbeStage::Over => "is done",
        })
    }
}

impl RobotProbe {
    /// Begins a stage: sends what it asks.
    pub(super) fn enter(&mut self, now: Time, stage: ProbeStage) {
        (self.stage, self.since) = (stage, now);
        self.said.begin();
        match stage {
            ProbeStage::Key(i) => {
                self.findings.key = Some(KeySpelling::ALL[i]);
                self.instant("stateRequest");
            }
            ProbeStage::Sheet => self.instant("factsheetRequest"),
            ProbeStage::Pauses | ProbeStage::Brakes => self.instant("startPause"),
            ProbeStage::Resumes => self.instant("stopPause"),
            ProbeStage::Arrives if self.findings.pause != Some(DriveAnswer::None) => {
                self.instant("stopPause")
            }
            ProbeStage::IdleCancel | ProbeStage::Cancels => self.instant("cancelOrder"),
            ProbeStage::Alive => self.instant("stateRequest"),
            ProbeStage::Order => self.enter_order(now, Vec::new(), ProbeStage::IdleCancel),
            ProbeStage::Clears => self.enter_order(now, Vec::new(), ProbeStage::Alive),
            ProbeStage::Unknown => {
                let action = Action {
                    kind: NO_ACTION.to_owned(),
                    id: self.new_id(),
                    blocking: BlockingType::Hard,
                    parameters: Vec::new(),
                    retriable: false,
                };
                self.enter_order(now, vec![action], ProbeStage::IdleCancel);
            }
            ProbeStage::Again => {
                if let Some(order) = self.order.clone() {
                    self.send_order(order);
                }
            }
            ProbeStage::SetsOff(i) => self.enter_drive(now, i),
            ProbeStage::Returns => match self.home {
                Some(home) => self.enter_way(now, home, false),
                None => self.enter(now, ProbeStage::Clears),
            },
            ProbeStage::Home => self.enter_home(now),
            ProbeStage::Listens | ProbeStage::OnWay | ProbeStage::OnWayBack => {}
            ProbeStage::Arrives | ProbeStage::Over => {}
        }
    }

    /// The next stage, if this one is over.
    pub(super) fn look(&mut self, now: Time) -> Option<ProbeStage> {
        let waited = now - self.since;
        match self.stage {
            ProbeStage::Listens => self.look_listens(waited),
            ProbeStage::Key(i) => self.look_key(i, waited),
            ProbeStage::Sheet => {
                let is_here = self.findings.sheet.is_some() || waited >= ANSWERS;
                is_here.then_some(ProbeStage::Pauses)
            }
            ProbeStage::Pauses => self.look_pauses(waited),
            ProbeStage::Resumes => {
                let is_over = self.said.status(&self.asked).is_some_and(ActionStatus::is_over);
                let is_paused = self.said.state().and_then(|state| state.paused) == Some(true);
                self.findings.stays_paused = is_paused;
                (is_over && !is_paused || waited >= ANSWERS).then_some(ProbeStage::Order)
            }
            ProbeStage::Order => self.look_order(waited),
            ProbeStage::Again => (waited >= ANSWERS).then(|| {
                self.note_repeat();
                ProbeStage::Unknown
            }),
            ProbeStage::Unknown => self.look_unknown(waited),
            ProbeStage::IdleCancel => self.look_idle_cancel(waited),
            ProbeStage::SetsOff(i) => self.look_sets_off(i, waited),
            ProbeStage::OnWay => self.look_on_way(now, ProbeStage::Brakes),
            ProbeStage::Brakes => self.look_brakes(now),
            ProbeStage::Arrives => {
                let is_there = self.is_at_end() && self.said.stands(self.since) && self.said.is_done();
                (is_there || waited >= DRIVES).then_some(ProbeStage::Returns)
            }
            ProbeStage::Returns => match self.said.has_order(&self.asked) {
                true => Some(ProbeStage::OnWayBack),
                false => (waited >= ANSWERS).then_some(ProbeStage::Clears),
            },
            ProbeStage::OnWayBack => self.look_on_way(now, ProbeStage::Cancels),
            ProbeStage::Cancels => self.look_cancels(now),
            ProbeStage::Home => {
                let is_home = self.home.is_none_or(|home| self.is_at(home));
                let is_over = is_home && self.said.stands(self.since) || waited >= DRIVES;
                is_over.then_some(ProbeStage::Clears)
            }
            ProbeStage::Clears => {
                let is_over = self.said.has_order(&self.asked) || waited >= ANSWERS;
                is_over.then_some(ProbeStage::Alive)
            }
            ProbeStage::Alive => {
                let answers = self.said.new_state().is_some();
                (answers || waited >= ANSWERS).then(|| {
                    self.findings.alive = answers;
                    self.findings.note_end(self.said.state());
                    ProbeStage::Over
                })
            }
            ProbeStage::Over => None,
        }
    }

    fn look_listens(&self, waited: Span) -> Option<ProbeStage> {
        let is_heard = self.version.is_some() && waited >= LISTENS[0];
        (is_heard || waited >= LISTENS[1]).then_some(ProbeStage::Key(0))
    }

    fn look_key(&mut self, i: usize, waited: Span) -> Option<ProbeStage> {
        let is_listed = self.said.action(&self.asked).is_some();
        let is_refused = !self.said.new_errors().is_empty();
        let answers = self.said.new_state().is_some();
        if is_listed || waited >= ANSWERS && answers && !is_refused {
            let has_sheet = self.findings.sheet.is_some();
            return Some(if has_sheet { ProbeStage::Pauses } else { ProbeStage::Sheet });
        }
        if !is_refused && waited < ANSWERS {
            return None;
        }
        if i + 1 < KeySpelling::ALL.len() {
            return Some(ProbeStage::Key(i + 1));
        }
        self.findings.key = None;
        Some(ProbeStage::Over)
    }

    fn look_pauses(&mut self, waited: Span) -> Option<ProbeStage> {
        let paused = self.said.new_state().and_then(|state| state.paused);
        let answer = match (self.said.status(&self.asked), paused) {
            (_, Some(true)) => IdlePause::Obeyed,
            (Some(ActionStatus::Failed), _) => IdlePause::Refused,
            (Some(ActionStatus::Finished), None) => IdlePause::Said,
            (Some(ActionStatus::Finished), Some(false)) if waited >= ANSWERS => IdlePause::Claimed,
            _ if waited >= ANSWERS => IdlePause::Silent,
            _ => return None,
        };
        self.findings.idle_pause = Some(answer);
        Some(ProbeStage::Resumes)
    }

    /// Sends an order to where the robot stands, if it says where that is; else another stage follows.
    fn enter_order(&mut self, now: Time, actions: Vec<Action>, otherwise: ProbeStage) {
        let action = actions.first().map(|action| action.id.clone());
        match self.order_here(actions) {
            Some(order) => {
                self.send_order(order);
                // The stage about an action is about the action, not about the order.
                if let Some(action) = action {
                    self.asked = action;
                }
            }
            None => self.enter(now, otherwise),
        }
    }

    fn look_order(&mut self, waited: Span) -> Option<ProbeStage> {
        if self.said.has_order(&self.asked) {
            return Some(ProbeStage::Again);
        }
        let words = self.said.new_errors().first().map(|error| error.kind.clone());
        let is_over = words.is_some() || waited >= ANSWERS;
        is_over.then(|| {
            self.findings.refused_order = Some(words.unwrap_or_else(|| "without a word".to_owned()));
            ProbeStage::Unknown
        })
    }

    fn look_unknown(&mut self, waited: Span) -> Option<ProbeStage> {
        let id = self.order.as_ref().map(|order| order.id.clone()).unwrap_or_default();
        let is_taken = self.said.has_order(&id);
        let answer = match self.said.status(&self.asked) {
            Some(ActionStatus::Finished) => ActionAnswer::Claims,
            Some(ActionStatus::Failed) => ActionAnswer::Refused,
            None if !self.said.new_errors().is_empty() && !is_taken => ActionAnswer::Refused,
            None if is_taken && self.said.is_done() && waited >= ANSWERS => ActionAnswer::Silent,
            _ if waited >= ACTS => ActionAnswer::Unfinished,
            _ => return None,
        };
        self.findings.actions = Some(answer);
        Some(ProbeStage::IdleCancel)
    }

    fn look_idle_cancel(&mut self, waited: Span) -> Option<ProbeStage> {
        let has_errors = !self.said.new_errors().is_empty();
        let answer = match self.said.status(&self.asked) {
            Some(ActionStatus::Finished) => CancelAnswer::SaidDone,
            Some(ActionStatus::Failed) => CancelAnswer::Failed,
            _ if waited < ANSWERS => return None,
            _ if has_errors => CancelAnswer::ErrorOnly,
            _ => CancelAnswer::Silent,
        };
        self.findings.idle_cancel = Some(answer);
        Some(if self.goal.is_some() { ProbeStage::SetsOff(0) } else { ProbeStage::Clears })
    }

    /// Sends the robot off: first with a node beside it that only the deviation makes good, then from where it stands.
    fn enter_drive(&mut self, now: Time, i: usize) {
        const SPELLINGS: [DeviationSpelling; 3] =
            [DeviationSpelling::Official, DeviationSpelling::Published, DeviationSpelling::Both];
        self.course.spelling = SPELLINGS[i];
        self.home = self.home.or(self.said.place());
        if let Some(goal) = self.goal {
            self.enter_way(now, goal, i < 2);
        }
    }

    fn enter_way(&mut self, now: Time, to: Point, beside: bool) {
        match self.order_to(to, beside) {
            Some(order) => self.send_order(order),
            None => {
                self.findings.is_too_near = true;
                self.enter(now, ProbeStage::Clears);
            }
        }
    }

    fn look_sets_off(&mut self, i: usize, waited: Span) -> Option<ProbeStage> {
        if self.said.has_order(&self.asked) {
            self.findings.deviation = (i < 2).then_some(self.course.spelling);
            return Some(ProbeStage::OnWay);
        }
        let is_refused = !self.said.new_errors().is_empty() || waited >= ANSWERS;
        match (is_refused, i) {
            (false, _) => None,
            (true, 0 | 1) => Some(ProbeStage::SetsOff(i + 1)),
            (true, _) => {
                self.findings.drives = Some(false);
                Some(ProbeStage::Clears)
            }
        }
    }

    /// The next stage begins when the robot is on its way, or says nothing, as some do while they drive.
    fn look_on_way(&mut self, now: Time, next: ProbeStage) -> Option<ProbeStage> {
        let driven = self.course.from.zip(self.said.place()).map_or(0.0, |(from, here)| (here - from).norm());
        let is_silent = self.said.placed_at().is_none_or(|at| now - at >= SILENT);
        if driven >= ON_ITS_WAY_M || is_silent {
            self.findings.drives = Some(true);
            return Some(next);
        }
        (now - self.since >= SETS_OFF).then(|| {
            self.findings.drives = Some(false);
            ProbeStage::Home
        })
    }

    fn look_brakes(&mut self, now: Time) -> Option<ProbeStage> {
        let is_late = now - self.since >= DRIVES;
        if !self.said.stands(self.since) && !is_late {
            return None;
        }
        let paused = self.said.state().and_then(|state| state.paused) == Some(true);
        let obeys = paused || self.said.status(&self.asked) == Some(ActionStatus::Finished);
        self.findings.pause = Some(match (self.is_at_end() || is_late, obeys) {
            (true, true) => DriveAnswer::Late,
            (true, false) => DriveAnswer::None,
            (false, _) if self.is_at_middle() => DriveAnswer::AtNodes,
            (false, _) => DriveAnswer::AtOnce,
        });
        Some(ProbeStage::Arrives)
    }

    fn look_cancels(&mut self, now: Time) -> Option<ProbeStage> {
        let said = self.said.status(&self.asked).filter(|status| status.is_over());
        if said.is_some() && self.course.said_done.is_none() {
            self.course.said_done = self.said.place();
        }
        let is_late = now - self.since >= DRIVES;
        if !self.said.stands(self.since) && !is_late {
            return None;
        }
        let end = self.course.to.zip(self.course.said_done);
        let is_on_way = end.is_some_and(|(to, said)| (said - to).norm() >= ON_NODE_M);
        let is_left = !self.said.is_done();
        self.findings.cancel = Some(match (self.is_at_end(), said) {
            (true, Some(ActionStatus::Finished)) if is_on_way => DriveAnswer::Claims,
            (true, Some(_)) if !is_on_way => DriveAnswer::Late,
            (true, _) => DriveAnswer::None,
            (false, _) if is_left && !is_late => return None,
            (false, _) if is_left => DriveAnswer::None,
            (false, _) if self.is_at_middle() => DriveAnswer::AtNodes,
            (false, _) => DriveAnswer::AtOnce,
        });
        Some(ProbeStage::Home)
    }

    fn enter_home(&mut self, now: Time) {
        let (Some(home), Some(here)) = (self.home, self.said.place()) else {
            return self.enter(now, ProbeStage::Clears);
        };
        if self.is_at(home) {
            return self.enter(now, ProbeStage::Clears);
        }
        let order = self.order_along(&[here, home]);
        self.send_order(order);
    }

    fn is_at_end(&self) -> bool {
        self.course.to.is_some_and(|to| self.is_at(to))
    }

    fn is_at_middle(&self) -> bool {
        self.course.middle.is_some_and(|middle| self.is_at(middle))
    }
}

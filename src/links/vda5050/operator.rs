//! What operators send a robot: instant actions, and where it stands.
//!
//! Main type: [`SentAction`]. Refuses: what the fleet itself says to robots: pauses and cancels have their own ways.

use super::cancel::CANCEL;
use super::pause::{START_PAUSE, STOP_PAUSE};
use super::session::{RobotSession, SessionOutput};
use giveway_floor::geometry::{Pose, wrap_angle};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::links;
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{ActionStatus, Parameter};
use serde_json::json;

/// A robot of 3.0 may list this many instant actions that are over, and is told to forget them this often at most.
const MOST_OVER: usize = 32;
const CLEARS: Span = Span::from_secs(10);

/// How many actions of operators are remembered.
const KEPT: usize = 50;

/// The action that tells a robot where it stands.
pub const INIT_POSITION: &str = "initPosition";

/// An action that an operator sent, and what became of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SentAction {
    /// Its id.
    pub id: String,
    /// Its type.
    pub kind: String,
    /// When it was sent.
    pub sent: Time,
    /// What the robot said of it last; nothing if it has said nothing.
    pub status: Option<ActionStatus>,
    /// The robot's words.
    pub result: Option<String>,
}

impl RobotSession {
    /// Sends an action at once, alone in its message. Gives the action's id.
    ///
    /// # Errors
    /// Why it is not sent.
    pub fn act(
        &mut self,
        now: Time,
        kind: &str,
        parameters: Vec<Parameter>,
    ) -> Result<(String, SessionOutput), Sentence> {
        match kind {
            START_PAUSE | STOP_PAUSE => return Err(links::pauses_are_requests(kind)),
            CANCEL => return Err(links::cancels_are_requests(kind)),
            _ => {}
        }
        if let Some(why) = self.unreachable(now) {
            return Err(links::nothing_reaches(why.said()));
        }
        let id = self.new_id();
        self.instant(kind, &id, parameters);
        if self.sent.len() >= KEPT {
            self.sent.pop_front();
        }
        let sent =
            SentAction { id: id.clone(), kind: kind.to_owned(), sent: now, status: None, result: None };
        self.sent.push_back(sent);
        Ok((id, self.tick(now)))
    }

    /// What became of an action that an operator sent; nothing if it is not remembered.
    pub fn sent_action(&self, id: &str) -> Option<&SentAction> {
        self.sent.iter().find(|sent| sent.id == id)
    }

    /// The parameters with which a robot is told where it stands on the floor.
    ///
    /// # Errors
    /// If nobody said which of the robot's maps is the floor.
    pub fn init_position(&self, place: Pose) -> Result<Vec<Parameter>, Sentence> {
        let said = self.state().and_then(|(_, state)| state.position.as_ref()).map(|p| p.map.clone());
        let maps = &self.settings.maps;
        let frame = maps.iter().find(|frame| Some(&frame.name) == said.as_ref()).or(maps.first());
        let frame = frame.ok_or_else(links::kind_has_no_maps)?;
        let (x, y) = frame.to_robot(place.at);
        let far = |at: giveway_floor::geometry::Point| (at - place.at).norm();
        let nodes = self.map.nodes.iter();
        let nearest = nodes.min_by(|a, b| far(a.at).total_cmp(&far(b.at)));
        let node = nearest.map(|node| node.name.clone()).unwrap_or_default();
        let all = [
            ("x", json!(x)),
            ("y", json!(y)),
            ("theta", json!(wrap_angle(place.heading - frame.turn))),
            ("mapId", json!(frame.name)),
            ("lastNodeId", json!(node)),
        ];
        Ok(all.into_iter().map(|(key, value)| Parameter { key: key.to_owned(), value }).collect())
    }

    /// Has a robot forget instant actions that are over: from 3.0 on it lists all of them until it is told to.
    pub(super) fn clear_instants(&mut self, now: Time) {
        let Some((heard, state)) = &self.state else { return };
        let over = state.instant_actions.iter().filter(|said| said.status.is_over()).count();
        let is_answered = self.cleared.is_none_or(|cleared| *heard > cleared && now - cleared >= CLEARS);
        if over > MOST_OVER && is_answered {
            self.cleared = Some(now);
            let id = self.new_id();
            self.instant("clearInstantActions", &id, Vec::new());
        }
    }

    /// Notes in a state what became of operators' actions. Robots list an ended one in a few states only.
    pub(super) fn note_sent(&mut self) {
        let Some((_, state)) = &self.state else { return };
        for said in state.actions.iter().chain(&state.instant_actions) {
            if let Some(sent) = self.sent.iter_mut().find(|sent| sent.id == said.id) {
                (sent.status, sent.result) = (Some(said.status), said.result.clone());
            }
        }
    }
}

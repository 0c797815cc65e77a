//! The connection of a virtual robot: ONLINE, OFFLINE, losses of the broker, and reading what arrives.
//!
//! Main functions: `come_online`, `listen`, `take_messages`. Refuses: to lose or delay messages by itself.

use super::actions::ActionStage;
use super::quirks::{ReadingHabit, ReconnectHabit, StateHabit, UnreadableReply};
use super::{RobotMessage, VirtualRobot};
use crate::model::Message;
use crate::model::state::ConnectionState;
use crate::topic::TopicKind;

/// How a robot is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LinkStage {
    /// It will say ONLINE in its next step.
    Starting,
    /// It lost the broker before it could say ONLINE.
    Waiting,
    /// It is connected.
    Online,
    /// It has lost the broker and drives on to the end of its base.
    Lost,
    /// It has lost the broker and will not look for it again.
    Abandoned,
    /// It will say OFFLINE in its next step.
    Leaving,
    /// It has said OFFLINE.
    Left,
    /// Its process has died.
    Dead,
}

/// Why a message could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GarbledMessage {
    /// The message is no JSON.
    NotJson,
    /// The message is JSON of another form or version, for example without the key of instant actions that the robot
    /// understands.
    WrongForm,
}

/// The most messages that wait to be read; the oldest give way.
const INBOX_MOST: usize = 256;

impl VirtualRobot {
    /// The last will, which the broker sends for the robot when it is lost.
    pub fn will() -> RobotMessage {
        RobotMessage { topic: TopicKind::Connection, message: Message::Connection(ConnectionState::Broken) }
    }

    /// Takes leave: the next step says OFFLINE, and the robot is silent until a reboot.
    pub fn leave(&mut self) {
        if matches!(self.link, LinkStage::Starting | LinkStage::Online) {
            self.link = LinkStage::Leaving;
        }
    }

    /// Loses the broker. The robot drives on to the end of its base and drops what it would say.
    pub fn lose_broker(&mut self) {
        match self.link {
            LinkStage::Starting => self.link = LinkStage::Waiting,
            LinkStage::Online => self.link = LinkStage::Lost,
            _ => {}
        }
    }

    /// Finds the broker again, as its quirk says.
    pub fn find_broker(&mut self) {
        self.link = match (self.link, self.setup.quirks.reconnect) {
            (LinkStage::Waiting, _) | (LinkStage::Lost, ReconnectHabit::Announced) => LinkStage::Starting,
            (LinkStage::Lost, ReconnectHabit::Unannounced) => LinkStage::Online,
            (LinkStage::Lost, ReconnectHabit::Never) => LinkStage::Abandoned,
            (other, _) => other,
        };
    }

    /// Whether the robot sends and receives. If it does not and has not said OFFLINE, the broker sends its will.
    pub fn is_online(&self) -> bool {
        matches!(self.link, LinkStage::Starting | LinkStage::Online | LinkStage::Leaving)
    }

    /// Whether the robot's process is alive; a dead one needs a reboot.
    pub fn is_alive(&self) -> bool {
        self.link != LinkStage::Dead
    }

    /// Takes a message on a topic that could not be read; the robot answers in its next step, or not at all.
    pub fn receive_unreadable(&mut self, topic: TopicKind, why: GarbledMessage) {
        let is_silent = self.setup.quirks.unreadable == UnreadableReply::WarningButSilentAboutText;
        if self.link == LinkStage::Online && !(is_silent && why == GarbledMessage::NotJson) {
            self.complain_of_unreadable(topic);
        }
    }

    pub(super) fn come_online(&mut self) {
        if self.link != LinkStage::Starting {
            return;
        }
        self.link = LinkStage::Online;
        self.say(TopicKind::Connection, Message::Connection(ConnectionState::Online));
        if self.setup.announces_factsheet {
            self.say_factsheet();
        }
        self.reporting.must_say = self.setup.quirks.states == StateHabit::EventsAndInterval;
    }

    pub(super) fn say(&mut self, topic: TopicKind, message: Message) {
        self.outbox.push(RobotMessage { topic, message });
    }

    pub(super) fn say_factsheet(&mut self) {
        if let Some(factsheet) = self.setup.factsheet.clone() {
            self.say(TopicKind::Factsheet, Message::Factsheet(Box::new(factsheet)));
        }
    }

    /// Reads what was received, as far as the robot reads now.
    pub(super) fn listen(&mut self, received: &[Message]) {
        if self.link != LinkStage::Online {
            return;
        }
        self.inbox.extend(received.iter().cloned());
        while self.inbox.len() > INBOX_MOST {
            self.inbox.pop_front();
        }
        while self.link == LinkStage::Online && self.reads_now() {
            match self.inbox.pop_front() {
                Some(Message::Order(order)) => self.take_order(order),
                Some(Message::InstantActions(actions)) => self.take_instants(actions),
                Some(Message::ZoneSet(set)) => self.take_zone_set(set),
                Some(Message::Responses(responses)) => self.take_responses(&responses),
                Some(_) => {}
                None => break,
            }
        }
    }

    fn reads_now(&self) -> bool {
        match self.setup.quirks.reading {
            ReadingHabit::AtOnce => true,
            ReadingHabit::AtEndOfBase => {
                let is_busy = |stage: ActionStage| stage != ActionStage::Announced && !stage.is_over();
                let is_executing =
                    self.order.released_left() > 0 || self.actions.iter().any(|entry| is_busy(entry.stage));
                !is_executing || self.is_paused()
            }
        }
    }

    /// What is to be sent: nothing while the robot is not connected.
    pub(super) fn take_messages(&mut self) -> Vec<RobotMessage> {
        if self.link == LinkStage::Leaving {
            self.say(TopicKind::Connection, Message::Connection(ConnectionState::Offline));
            self.link = LinkStage::Left;
            return std::mem::take(&mut self.outbox);
        }
        let messages = std::mem::take(&mut self.outbox);
        if self.link == LinkStage::Online { messages } else { Vec::new() }
    }
}

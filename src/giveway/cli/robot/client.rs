//! A virtual robot at its line, with the faults that it and its messages are to have.
//!
//! Main type: [`RobotClient`]. Refuses: clocks and brokers; both come from the caller.

use super::faults::{RobotCondition, RobotFaults};
use super::transport::MessageQueue;
use crate::mqtt::LineMessage;
use giveway_sim::random::Stream;
use giveway_vda5050::robot::{ReadMessage, ReconnectHabit, WireMessage, WireRobot};
use giveway_vda5050::{Address, EStop, OperatingMode, Position, RobotSetup, TopicKind, VirtualRobot};

/// The purposes of the streams that decide what happens to messages.
const TO_ROBOT: u64 = 0x70;
const TO_MASTER: u64 = 0x71;

/// A virtual robot, its messages, and their faults.
pub struct RobotClient {
    robot: WireRobot,
    address: Address,
    interface: String,
    faults: RobotFaults,
    heard: MessageQueue<ReadMessage>,
    said: MessageQueue<LineMessage>,
    /// The time of the last step, microseconds.
    stepped_us: i64,
    has_line: bool,
    /// Whether the robot has lost the broker and looks for it no more.
    gave_up: bool,
    /// Whether the robot was told that it does not know where it is.
    is_lost: bool,
}

impl RobotClient {
    /// A robot that is switched on and has no line yet. The seed decides with `number` what happens to its messages.
    pub fn new(
        setup: RobotSetup,
        address: Address,
        interface: &str,
        faults: RobotFaults,
        (seed, number): (u64, usize),
    ) -> RobotClient {
        let quirks = faults.quirks(setup.quirks);
        let mut robot = WireRobot::new(RobotSetup { quirks, ..setup });
        robot.body.robot.lose_broker();
        let chance = |purpose: u64| Stream::new(seed, purpose, number as u64);
        RobotClient {
            robot,
            address,
            interface: interface.to_owned(),
            faults,
            heard: MessageQueue::new(chance(TO_ROBOT)),
            said: MessageQueue::new(chance(TO_MASTER)),
            stepped_us: -1,
            has_line: false,
            gave_up: false,
            is_lost: false,
        }
    }

    /// The topics that the robot listens to.
    pub fn topics(&self) -> Vec<String> {
        let version = self.robot.setup().version;
        let is_for_it = |kind: &TopicKind| !kind.is_from_robot() && kind.is_in(version);
        TopicKind::ALL.into_iter().filter(is_for_it).map(|kind| self.topic(kind)).collect()
    }

    /// What the broker says for the robot when it is lost.
    pub fn will(&mut self, timestamp: &str) -> LineMessage {
        let will = self.robot.will(timestamp);
        self.to_line(will)
    }

    /// Whether the robot is to have a line to the broker.
    pub fn wants_line(&self, now_us: i64) -> bool {
        let is_alive = self.protocol().is_alive() && !self.gave_up;
        is_alive && !self.faults.has(RobotCondition::BrokerLost, now_us)
    }

    /// The line is up.
    pub fn find_line(&mut self) {
        if !std::mem::replace(&mut self.has_line, true) {
            self.robot.body.robot.find_broker();
        }
    }

    /// The line is down; what was on its way is gone.
    pub fn lose_line(&mut self) {
        if std::mem::replace(&mut self.has_line, false) {
            self.robot.body.robot.lose_broker();
            self.heard.clear();
            self.said.clear();
            self.gave_up = self.robot.setup().quirks.reconnect == ReconnectHabit::Never;
        }
    }

    /// Takes leave: the next step says OFFLINE.
    pub fn leave(&mut self) {
        self.robot.body.robot.leave();
    }

    /// A message arrives at the robot's end of the line.
    pub fn hear(&mut self, now_us: i64, topic: &str, payload: &[u8]) {
        let Some((address, level, kind)) = Address::of_topic(topic, &self.interface) else { return };
        if address == self.address && level == self.robot.setup().version.topic_level() {
            let heard = self.robot.read(kind, payload);
            self.heard.put(now_us, heard, &self.faults.transport(now_us));
        }
    }

    /// Lets the robot act, and returns what it says. `timestamp` is the robot's time as messages have it.
    pub fn step(&mut self, now_us: i64, timestamp: &str) -> Vec<LineMessage> {
        self.bring_faults(now_us);
        let is_silent = self.faults.has(RobotCondition::Silent, now_us);
        let mut heard = self.heard.take(now_us);
        if is_silent {
            heard.clear();
        }
        let transport = self.faults.transport(now_us);
        let mut out = Vec::new();
        for said in self.robot.step(now_us, timestamp, heard) {
            let is_connection = said.kind == TopicKind::Connection;
            let message = self.to_line(said);
            match (is_connection, is_silent) {
                // The broker confirms and keeps it: it is not lost on the way.
                (true, _) => out.push(message),
                (false, true) => {}
                (false, false) => self.said.put(now_us, message, &transport),
            }
        }
        out.extend(self.said.take(now_us));
        self.stepped_us = now_us;
        out
    }

    /// Brings the conditions about that hold now, and the reboots that are due.
    fn bring_faults(&mut self, now_us: i64) {
        if let Some(node) = self.faults.reboot(self.stepped_us, now_us) {
            let (node, place) = self.place_of_reboot(node);
            self.robot.body.robot.reboot(place, &node);
            self.gave_up = false;
            self.is_lost = false;
            if !self.has_line {
                self.robot.body.robot.lose_broker();
            }
        }
        let has = |condition| self.faults.has(condition, now_us);
        let robot = &mut self.robot.body.robot;
        robot.set_e_stop(if has(RobotCondition::EStop) { EStop::Manual } else { EStop::None });
        robot.set_field_violation(has(RobotCondition::FieldViolated));
        robot.set_handling_fault(has(RobotCondition::HandlingFails));
        robot.set_obstructed(has(RobotCondition::Obstructed));
        let mode = if has(RobotCondition::Manual) { OperatingMode::Manual } else { OperatingMode::Automatic };
        if robot.state().mode != mode {
            robot.set_mode(mode);
        }
        let is_lost = has(RobotCondition::NotLocalized);
        if std::mem::replace(&mut self.is_lost, is_lost) != is_lost {
            robot.set_localized(!is_lost);
        }
    }

    /// The node and pose at which the robot comes back.
    fn place_of_reboot(&self, node: Option<&str>) -> (String, Position) {
        let setup = self.robot.setup();
        let body = self.robot.body.body().report(Vec::new());
        let named = node.and_then(|name| setup.places.get(name).map(|place| (name.to_owned(), *place)));
        let here = || (self.protocol().state().last_node, (body.x, body.y));
        let (node, (x, y)) = named.unwrap_or_else(here);
        let map = setup.position.map.clone();
        (node, Position { x, y, theta: body.theta, map, localized: true })
    }

    fn protocol(&self) -> &VirtualRobot {
        &self.robot.body.robot
    }

    fn topic(&self, kind: TopicKind) -> String {
        self.address.topic(&self.interface, self.robot.setup().version, kind)
    }

    fn to_line(&self, said: WireMessage) -> LineMessage {
        LineMessage {
            topic: self.topic(said.kind),
            payload: said.payload,
            confirmed: said.kind == TopicKind::Connection,
            retained: said.kind.is_retained(),
            expires: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::faults::FaultsFile;
    use super::*;
    use giveway_vda5050::{ConnectionState, Message, Version, read};

    /// What a robot with these faults says in some seconds, each message with its time in seconds. The broker is there
    /// whenever the robot wants it.
    fn run(faults: &str, seconds: f64) -> Vec<(f64, Message)> {
        let text = format!(r#"{{"giveway_faults": 1, "faults": [{faults}]}}"#);
        let file = FaultsFile::parse(&text, |_| true).unwrap();
        let mut setup = RobotSetup::new(Version::V2_1, "maker", "v-1", "lab", "n0");
        setup.places.insert("far".into(), (9.0, 2.0));
        let address = Address::new("maker", "v-1").unwrap();
        let mut client = RobotClient::new(setup, address, "uagv", file.of_robot(1, 0, "v-1"), (1, 0));
        let mut said = Vec::new();
        for tick in 0..(seconds * 20.0) as i64 {
            let now_us = tick * 50_000;
            if client.wants_line(now_us) {
                client.find_line()
            } else {
                client.lose_line()
            }
            for message in client.step(now_us, "2026-01-01T00:00:00.000Z") {
                let (_, _, kind) = Address::of_topic(&message.topic, "uagv").expect("a topic");
                assert_eq!(message.retained, kind.is_retained());
                let message = read(kind, &message.payload).expect("readable").message;
                said.push((now_us as f64 * 1e-6, message));
            }
        }
        said
    }

    fn connections(said: &[(f64, Message)]) -> Vec<(f64, ConnectionState)> {
        let connection = |(at, message): &(f64, Message)| match message {
            Message::Connection(connection) => Some((*at, *connection)),
            _ => None,
        };
        said.iter().filter_map(connection).collect()
    }

    #[test]
    fn a_robot_that_loses_the_broker_says_online_again() {
        let said = run(r#"{"fault": "broker_lost", "at_s": 5, "for_s": 3}"#, 10.0);
        assert_eq!(connections(&said), [(0.0, ConnectionState::Online), (8.0, ConnectionState::Online)]);
        assert!(said.iter().all(|(at, _)| !(5.0..8.0).contains(at)));
        let never = r#"{"fault": "broker_lost", "at_s": 5, "for_s": 3},
            {"fault": "quirk", "quirk": "reconnect", "value": "never"}, {"fault": "reboot", "at_s": 20}"#;
        let said = run(never, 30.0);
        // It looks for the broker in the step after its reboot.
        assert_eq!(connections(&said), [(0.0, ConnectionState::Online), (20.05, ConnectionState::Online)]);
    }

    #[test]
    fn a_silent_robot_says_nothing_and_a_reboot_puts_a_robot_elsewhere() {
        let said = run(r#"{"fault": "silence", "at_s": 3, "for_s": 4}"#, 10.0);
        assert!(said.iter().all(|(at, _)| !(3.0..7.0).contains(at)) && said.iter().any(|(at, _)| *at >= 7.0));
        let said = run(r#"{"fault": "reboot", "at_s": 3, "node": "far"}"#, 5.0);
        let last = said.iter().rev().find_map(|(_, message)| match message {
            Message::State(state) => Some(state.clone()),
            _ => None,
        });
        let state = last.expect("a state");
        let place = state.position.expect("a position");
        assert_eq!((state.last_node.as_str(), place.x, place.y), ("far", 9.0, 2.0));
    }

    #[test]
    fn conditions_begin_and_end_and_are_said() {
        let said = run(
            r#"{"fault": "manual", "at_s": 1, "for_s": 1}, {"fault": "e_stop", "at_s": 3, "for_s": 1},
                {"fault": "not_localized", "at_s": 5, "for_s": 1}"#,
            8.0,
        );
        let mut seen = Vec::new();
        for (_, message) in said {
            let Message::State(state) = message else { continue };
            let localized = state.position.is_some_and(|p| p.localized);
            let now = (state.mode == OperatingMode::Manual, state.e_stop != EStop::None, localized);
            if seen.last() != Some(&now) {
                seen.push(now);
            }
        }
        let usual = (false, false, true);
        let expected =
            [usual, (true, false, true), usual, (false, true, true), usual, (false, false, false), usual];
        assert_eq!(seen, expected);
    }
}

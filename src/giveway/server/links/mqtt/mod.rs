//! Robots that speak VDA 5050: their sessions on one side, the line to the broker on the other.
//!
//! Main type: [`MqttRobots`]. Robots that the site lists join where they stand, and drive once they have shown that
//! they obey; others that the broker knows are never driven. Refuses: to believe a message that names another robot
//! than its topic.

mod desk;
mod kinds;
mod robot;

use crate::mqtt::broker::PASSWORD;
use crate::mqtt::{LineEvent, LineMessage, LineSetup, MqttLine, broker_of, is_loopback, tls_of};
use anyhow::Context;
use giveway_api::{LINK_QUESTIONS, LinkQuestion, LinkTally, UnlistedRobot};
use giveway_drive::{DriveAlarm, LinkOutput};
use giveway_fleet::alarm::AlarmKind;
use giveway_fleet::{Asker, Fleet, Input, Ledger, Reply, RobotAction, Token};
use giveway_floor::id::RobotId;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::alarms;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_links::vda5050::{
    BlockedArea, MessageStamp, Notice, RobotHeard, RobotSession, SessionOutput, SessionStart, closed_areas,
};
use giveway_site::{ListedRobot, MQTT_LINK, MqttLink};
use giveway_vda5050::{Address, Header, Message, Read, TopicKind, Version, read};
use kinds::{ADDS_KIND, OpenKinds};
use robot::RobotHere;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;

/// Messages taken in one turn; the rest waits for the next.
const AT_ONCE: usize = 2_000;
/// Robots remembered that nobody listed.
const UNLISTED: usize = 200;
/// A robot asks to join again after this, if it was not taken.
const JOINS_AGAIN: Span = Span::from_secs(1);
/// What is closed to robots is looked at this often.
const LOOKS: Span = Span::from_millis(500);
/// The token of robots that ask to join.
const JOINS: Token = Token { asker: Asker(7), number: 0 };
/// A broker that is not there this long after the start is gone.
const BEGINS: Span = Span::from_secs(2);
/// A claim is remembered in an alarm for this long.
const CLAIMS: Span = Span::from_secs(600);
/// Events of the line that wait for the next turn.
const EVENTS: usize = 10_000;
/// What robots say.
const ALL_KINDS: [TopicKind; 4] =
    [TopicKind::State, TopicKind::Connection, TopicKind::Factsheet, TopicKind::Visualization];

/// How the line to the broker is, as far as people have to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BrokerState {
    /// It was not up yet, and nobody was told so.
    Begins,
    Up,
    Down,
}

/// The robots of a broker.
pub struct MqttRobots {
    link: MqttLink,
    map: Arc<Warehouse>,
    /// A number that is greater in each process.
    boot: u64,
    line: MqttLine,
    events: mpsc::Receiver<LineEvent>,
    state: BrokerState,
    robots: BTreeMap<Address, RobotHere>,
    /// Robots that were heard of and that nobody listed.
    unlisted: BTreeMap<Address, UnlistedRobot>,
    /// Where people's questions go, and what was asked.
    desk: mpsc::Sender<LinkQuestion>,
    questions: mpsc::Receiver<LinkQuestion>,
    numbers: BTreeMap<RobotId, Address>,
    kinds: OpenKinds,
    inputs: Vec<Input>,
    alarms: Vec<DriveAlarm>,
    /// Whether an alarm about claims is raised, and when one was noticed last.
    claimed: Option<Time>,
    has_new_claims: bool,
    counts: LinkTally,
    begun: Time,
    /// What is closed to robots, and when that was looked at.
    closed: (Arc<[BlockedArea]>, Time),
}

/// A line to the broker of a site that has begun.
pub struct BegunLine {
    link: MqttLink,
    line: MqttLine,
    heard: mpsc::Receiver<LineEvent>,
}

/// Begins to connect to the broker of a site.
///
/// # Errors
/// What is missing or cannot be read.
pub fn connect(link: MqttLink, floor: &str) -> anyhow::Result<BegunLine> {
    let (broker, with_tls) = broker_of(&link.url).context("the broker's `url` is refused")?;
    let identity = link.identity.as_ref().map(|[certificate, key]| [certificate, key].map(Path::new));
    let tls = match with_tls {
        true => Some(tls_of(link.ca.as_deref().map(Path::new), identity)?),
        false => None,
    };
    let password = std::env::var(PASSWORD).ok();
    let login = link.user.clone().map(|user| (user, password.unwrap_or_default()));
    if !is_loopback(&broker.0) && login.is_none() && link.identity.is_none() {
        anyhow::bail!(
            "the broker at {} is not on this machine: it needs `user` and the environment's {PASSWORD}, or `cert` and \
             `key`. Whoever may write to a broker moves its robots",
            broker.0
        );
    }
    let setup = LineSetup {
        client: format!("giveway-{}", floor.replace(' ', "-")),
        broker,
        tls,
        login,
        version: link.mqtt,
        topics: MqttRobots::topics(&link.interface),
        will: None,
    };
    let (events, heard) = mpsc::channel(EVENTS);
    Ok(BegunLine { link, line: MqttLine::begin(setup, events), heard })
}

impl MqttRobots {
    /// The robots of a site, behind a line that has begun.
    pub fn new(begun: BegunLine, map: Arc<Warehouse>, now: Time) -> MqttRobots {
        let (desk, questions) = mpsc::channel(LINK_QUESTIONS);
        let BegunLine { link, line, heard: events } = begun;
        let boot = now.0.unsigned_abs() / 1_000;
        let mut all = MqttRobots {
            robots: BTreeMap::new(),
            unlisted: BTreeMap::new(),
            desk,
            questions,
            numbers: BTreeMap::new(),
            kinds: OpenKinds::new(link.open.clone()),
            state: BrokerState::Begins,
            inputs: Vec::new(),
            alarms: Vec::new(),
            claimed: None,
            has_new_claims: false,
            counts: LinkTally::default(),
            begun: now,
            closed: (Arc::default(), now),
            link,
            map,
            boot,
            line,
            events,
        };
        for listed in all.link.robots.clone() {
            all.add(listed);
        }
        all
    }

    /// Lists a robot.
    fn add(&mut self, listed: ListedRobot) {
        let version = listed.version.unwrap_or(Version::V2_0);
        let robot = self.begin_session(listed, version);
        self.robots.insert(robot.listed.address.clone(), robot);
    }

    /// Where questions go.
    pub fn desk(&self) -> mpsc::Sender<LinkQuestion> {
        self.desk.clone()
    }

    /// The topics to listen to.
    pub fn topics(interface: &str) -> Vec<String> {
        ALL_KINDS.iter().map(|kind| format!("{interface}/+/+/+/{}", kind.level())).collect()
    }

    /// Everything that was heard since the last call.
    pub fn hear(&mut self, now: Time, fleet: &Fleet) -> Vec<Input> {
        self.join(now, fleet.ledger());
        self.let_leave(fleet.ledger());
        for _ in 0..AT_ONCE {
            let Ok(event) = self.events.try_recv() else { break };
            self.take_event(now, event);
        }
        let closed = self.closed(now, fleet.ledger());
        self.with_all(now, |session| {
            session.close(&closed);
            session.tick(now)
        });
        if self.numbers.len() < self.robots.len() {
            let addresses: Vec<Address> = self.robots.keys().cloned().collect();
            addresses.iter().for_each(|address| self.ask_to_join(now, address, fleet));
            self.inputs.extend(self.kinds.next(now, fleet, self.robots.values()));
        }
        self.answer(now, fleet);
        self.mind_claims(now);
        if self.state == BrokerState::Begins && now - self.begun >= BEGINS {
            self.note_down(now, "it was not there yet".to_owned());
        }
        std::mem::take(&mut self.inputs)
    }

    /// What is closed to robots: the same value as before if nothing has changed.
    fn closed(&mut self, now: Time, ledger: &Ledger) -> Arc<[BlockedArea]> {
        let (areas, looked) = &mut self.closed;
        if now - *looked >= LOOKS {
            *looked = now;
            let closed = closed_areas(ledger, now);
            if **areas != *closed {
                *areas = closed.into();
            }
        }
        areas.clone()
    }

    /// Alarms that began or ended since the last call.
    pub fn take_alarms(&mut self) -> Vec<DriveAlarm> {
        std::mem::take(&mut self.alarms)
    }

    /// What was counted since the last call.
    pub fn take_counts(&mut self) -> LinkTally {
        let ready = self.robots.values().filter(|here| here.session.is_commanded()).count();
        let not_ready = self.robots.len() - ready;
        LinkTally { ready, not_ready, ..std::mem::take(&mut self.counts) }
    }

    /// Passes commands of the fleet on to the robots.
    pub fn take(&mut self, now: Time, out: LinkOutput<'_>) {
        for reply in out.replies {
            match reply {
                Reply { token: JOINS, answer: Err(why) } => tracing::warn!(?why, "a robot cannot join"),
                Reply { token: ADDS_KIND, answer } => self.kinds.answer(now, answer.as_ref().map(drop)),
                Reply { .. } => {}
            }
        }
        for (robot, command) in out.limits.iter().chain(out.orders) {
            if let Some(address) = self.numbers.get(robot).cloned() {
                self.with(now, &address, |session| session.command(now, command));
            }
        }
    }

    fn take_event(&mut self, now: Time, event: LineEvent) {
        match event {
            LineEvent::Up => {
                self.state = BrokerState::Up;
                self.alarms.push(DriveAlarm::Clear(AlarmKind::BrokerGone));
                tracing::info!("the broker is there");
                self.with_all(now, |session| session.line_is_back(now));
            }
            LineEvent::Down(why) => self.note_down(now, why),
            LineEvent::Displaced => {
                tracing::error!("another server has taken the robots over: this one sends nothing any more");
                self.state = BrokerState::Down;
                self.with_all(now, |session| session.line_is_down(now));
                self.alarms.push(DriveAlarm::Raise(AlarmKind::RobotsTakenOver, alarms::robots_taken_over()));
            }
            LineEvent::Heard { topic, payload } => self.take_message(now, &topic, &payload),
        }
    }

    fn note_down(&mut self, now: Time, why: String) {
        if self.state == BrokerState::Down {
            return;
        }
        tracing::warn!(why, "the broker is gone; robots drive to the end of what they were released");
        self.alarms.push(DriveAlarm::Raise(AlarmKind::BrokerGone, alarms::broker_gone(&why)));
        self.state = BrokerState::Down;
        self.with_all(now, |session| session.line_is_down(now));
    }

    /// The alarm about claims ends some time after the last one.
    fn mind_claims(&mut self, now: Time) {
        if self.claimed.is_some_and(|last| now - last >= CLAIMS) {
            self.claimed = None;
            self.alarms.push(DriveAlarm::Clear(AlarmKind::RobotClaims));
        }
    }

    /// Raises the alarm about claims if there is a new one, with the last one of each robot.
    fn raise_claims(&mut self, now: Time) {
        if !std::mem::take(&mut self.has_new_claims) {
            return;
        }
        self.claimed = Some(now);
        let last = |here: &RobotHere| {
            let (at, notice) = here.noticed.iter().rev().find(|(_, notice)| notice.is_lie())?;
            (now - *at < CLAIMS).then(|| alarms::robot_claim(&here.listed.name, notice.said()))
        };
        let all: Vec<Sentence> = self.robots.values().filter_map(last).collect();
        self.alarms.push(DriveAlarm::Raise(AlarmKind::RobotClaims, alarms::robot_claims(all)));
    }

    fn take_message(&mut self, now: Time, topic: &str, payload: &[u8]) {
        let Some((address, level, kind)) = Address::of_topic(topic, &self.link.interface) else { return };
        let Some(here) = self.robots.get_mut(&address) else {
            let said = (kind == TopicKind::Connection).then(|| read(kind, payload));
            let connection = match said {
                Some(Ok(Read { message: Message::Connection(connection), .. })) => {
                    Some(format!("{connection:?}").to_uppercase())
                }
                _ => None,
            };
            return self.note_unlisted(now, &address, level, connection);
        };
        self.counts.heard += 1;
        // One pose a second would leave no room for anything else.
        if kind != TopicKind::Visualization {
            here.keep(now, false, kind, &String::from_utf8_lossy(payload));
        }
        let said = match read(kind, payload) {
            Ok(said) => said,
            Err(why) => {
                self.counts.unreadable += 1;
                tracing::warn!(robot = %address, topic, "a message cannot be read: {why}");
                return;
            }
        };
        for odd in &said.oddities {
            tracing::debug!(robot = %address, topic, "{odd}");
        }
        let heard = self.meaning(&address, level, said.header, said.message);
        if let Some(heard) = heard {
            self.with(now, &address, |session| session.hear(now, heard));
        }
    }

    /// What a message says to a robot's session. The first one tells the version that the robot speaks.
    fn meaning(
        &mut self,
        address: &Address,
        level: &str,
        header: Header,
        message: Message,
    ) -> Option<RobotHeard> {
        let named = [&header.manufacturer, &header.serial];
        if named != [address.manufacturer(), address.serial()] {
            return Some(RobotHeard::OtherName(format!("{}/{}", header.manufacturer, header.serial)));
        }
        let Some(version) = Version::of_text(&header.version).filter(|v| v.topic_level() == level) else {
            return Some(RobotHeard::OtherVersion(header.version));
        };
        let robot = self.robots.get(address)?;
        if robot.listed.version.is_some_and(|wanted| wanted != version) {
            return Some(RobotHeard::OtherVersion(header.version));
        }
        if robot.session.version() != version {
            // A broker keeps what a robot said of its connection before it learned another version.
            if robot.session.state().is_some() && !matches!(message, Message::State(_)) {
                return None;
            }
            let before = self.robots.remove(address)?;
            // A robot that has joined joins its new session in the next turn.
            before.number.map(|number| self.numbers.remove(&number));
            self.robots.insert(address.clone(), before.begin_again(version));
        }
        let stamp = MessageStamp { id: header.id, timestamp: header.timestamp };
        match message {
            Message::State(state) => Some(RobotHeard::State(state, stamp)),
            Message::Connection(connection) => Some(RobotHeard::Connection(connection)),
            Message::Visualization(seen) => Some(RobotHeard::Visualization(seen, stamp)),
            Message::Factsheet(factsheet) => Some(RobotHeard::Factsheet(factsheet)),
            Message::Order(_) | Message::InstantActions(_) | Message::ZoneSet(_) | Message::Responses(_) => {
                None
            }
        }
    }

    fn begin_session(&self, listed: ListedRobot, version: Version) -> RobotHere {
        let settings = self.link.kinds.get(&listed.kind).cloned().unwrap_or_default();
        RobotHere::new(listed, version, settings, (self.map.clone(), self.boot))
    }

    /// Takes robots that the ledger has, by their names, for those that have joined.
    fn join(&mut self, now: Time, ledger: &Ledger) {
        if self.numbers.len() == self.robots.len() {
            return;
        }
        let names: BTreeMap<&str, RobotId> = (ledger.robots.pairs())
            .filter(|(_, record)| record.link == MQTT_LINK && !record.is_gone())
            .map(|(robot, record)| (record.name.as_str(), robot))
            .collect();
        let joined: Vec<(Address, RobotId)> = (self.robots.values())
            .filter(|here| here.number.is_none())
            .filter_map(|here| Some((here.listed.address.clone(), *names.get(here.listed.name.as_str())?)))
            .collect();
        for (address, robot) in joined {
            let chain = ledger.chain(robot);
            let start = SessionStart {
                robot,
                at: chain.first(),
                granted: chain.granted() - 1,
                recalls: ledger.robots[robot].recalls,
                rack: ledger.rack_on(robot),
            };
            self.numbers.insert(robot, address.clone());
            if let Some(here) = self.robots.get_mut(&address) {
                (here.number, here.returns) = (Some(robot), false);
            }
            self.with(now, &address, |session| session.join(now, start));
        }
    }

    /// Robots that have left the floor are commanded no more.
    fn let_leave(&mut self, ledger: &Ledger) {
        let is_gone = |robot: &RobotId| ledger.robots.get(*robot).is_none_or(|record| record.is_gone());
        let gone: Vec<RobotId> = self.numbers.keys().filter(|robot| is_gone(robot)).copied().collect();
        for robot in gone {
            let left = self.numbers.remove(&robot).and_then(|address| self.robots.remove_entry(&address));
            if let Some((address, before)) = left {
                let version = before.session.version();
                self.robots.insert(address, before.begin_again(version));
            }
        }
    }

    /// A robot whose place on the floor is known asks to join, whether it obeys yet or not: it is in others' way. If
    /// nothing is free where it stands, it joins at the nearest place that is, and its report makes others stop for it.
    fn ask_to_join(&mut self, now: Time, address: &Address, fleet: &Fleet) {
        let Some(here) = self.robots.get_mut(address) else { return };
        let waits = here.asked_to_join.is_some_and(|asked| now - asked < JOINS_AGAIN);
        if here.number.is_some() || waits {
            return;
        }
        let Some(at) = here.session.whereabouts(now).filter(|_| !here.has_left(fleet.ledger())) else {
            return;
        };
        here.asked_to_join = Some(now);
        let ListedRobot { name, kind, .. } = here.listed.clone();
        if let Some(node) = fleet.place_to_join(&kind, at) {
            let joins = RobotAction::Register { name, kind, node, link: Some(MQTT_LINK.to_owned()) };
            self.inputs.push(Input::ask(JOINS, joins));
        }
    }

    /// Lets all sessions do something, and sends what comes of it.
    fn with_all(&mut self, now: Time, mut act: impl FnMut(&mut RobotSession) -> SessionOutput) {
        let mut robots = std::mem::take(&mut self.robots);
        for here in robots.values_mut() {
            let output = act(&mut here.session);
            self.pass_on(now, here, output);
        }
        self.robots = robots;
        self.raise_claims(now);
    }

    /// Lets a session do something, and sends what comes of it.
    fn with(&mut self, now: Time, address: &Address, act: impl FnOnce(&mut RobotSession) -> SessionOutput) {
        let Some((address, mut here)) = self.robots.remove_entry(address) else { return };
        let output = act(&mut here.session);
        self.pass_on(now, &mut here, output);
        self.robots.insert(address, here);
        self.raise_claims(now);
    }

    /// Passes on what a session wants to happen.
    fn pass_on(&mut self, now: Time, here: &mut RobotHere, output: SessionOutput) {
        let SessionOutput { told, reports, link, noticed, taken } = output;
        self.counts.taken.extend(taken);
        self.counts.sent += told.len() as u64;
        self.inputs.extend(reports.into_iter().map(Input::Telemetry));
        if let (Some(state), Some(robot)) = (link, here.number) {
            self.inputs.push(Input::Link(robot, state));
        }
        self.has_new_claims |= noticed.iter().any(Notice::is_lie);
        noticed.into_iter().for_each(|notice| here.note(now, notice));
        for told in told {
            let version = here.session.version();
            let message = LineMessage {
                topic: here.listed.address.topic(&self.link.interface, version, told.kind),
                payload: here.text_of(now, &told).into_bytes(),
                confirmed: self.link.qos > 0,
                retained: false,
                expires: Some(Duration::from_micros(told.expires.0.unsigned_abs())),
            };
            // What cannot be sent now is made anew when the line is back.
            let _is_sent = self.line.send(message);
        }
    }
}

//! A fleet whose robots are virtual ones that speak VDA 5050, in memory: every message is written and read as it would
//! travel, and an observer of all orders holds the laws of the link.

use super::*;
use giveway_fleet::{
    Act, Capabilities, Fact, Fleet, Input, JobAction, JobFact, JobKind, JobRequest, JobState, JobWhy,
    ObeyedLimits, Request, RobotAction, Settings, StationOrder, Token,
};
use giveway_floor::id::{Dense, JobId, NodeId, RobotId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{NodeKind, Warehouse, lab, thesis};
use giveway_site::{MapFrame, RobotLinkSettings};
use giveway_vda5050::robot::LocalizedFlag;
use giveway_vda5050::{
    ActionState, EmbodiedRobot, Header, Message, Order, Parameter, RobotSetup, TopicKind, Version, read,
    write,
};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

mod complaints;
mod corridors;
mod drawn;
mod drawn_streets;
mod fuzz;
mod handling;
mod leases;
mod lies;
mod losses;
mod people;
mod presence;
mod slow;
mod validity;
mod zones;

const PERIOD: Span = Span::from_millis(100);
const FLOOR: &str = "lab";
/// Nodes that orders announce beyond the base.
const HORIZON: usize = 3;
const JOINS: Token = Token { asker: giveway_fleet::Asker(7), number: 0 };

/// A robot and its session.
struct Pair {
    robot: EmbodiedRobot,
    session: RobotSession,
    number: Option<RobotId>,
    /// What the fleet last told it to drive.
    drive: Option<giveway_fleet::Command>,
    joined_at: Option<Time>,
    /// Messages on their way, with their arrival.
    to_robot: Vec<(Time, Message)>,
    to_fleet: Vec<(Time, Message, MessageStamp)>,
    /// The number of the robot's next message.
    next: u32,
    settings: RobotLinkSettings,
    told: Vec<(Time, TopicKind, Message)>,
    noticed: Vec<Notice>,
    watch: OrderWatch,
    /// How far its clock is ahead.
    clock: Span,
    /// How often an operator found that an action of it had failed.
    failures: u32,
    /// An action that each state of the robot says besides its own.
    says_also: Option<ActionState>,
    /// What each action was that the robot was ever told, by its id.
    acts: BTreeMap<String, String>,
}

impl Pair {
    /// An id means one action for ever: a robot takes another one under it for a repetition, and does nothing.
    fn see_acts(&mut self, message: &Message) {
        let Message::InstantActions(actions) = message else { return };
        for action in actions {
            let first = self.acts.entry(action.id.clone()).or_insert_with(|| action.kind.clone());
            assert_eq!(*first, action.kind, "{} was used before", action.id);
        }
    }

    /// What the robot has behind it, by the state that it has just sent: of two that come at once, the first one counts
    /// as well.
    fn note_passed(&mut self) {
        let Some((_, state)) = self.session.state() else { return };
        // A robot that has just taken an order may still say the number of the one before.
        if state.nodes.iter().all(|node| node.sequence >= state.last_sequence) {
            self.watch.pass(&state.order, state.last_sequence, state.nodes.is_empty());
        }
    }

    fn place(&self) -> (f64, f64) {
        let report = self.robot.body().report(Vec::new());
        (report.x, report.y)
    }

    fn speed_mps(&self) -> f64 {
        self.robot.body().report(Vec::new()).speed_mps
    }
}

/// What an observer of the broker sees of a robot's orders.
#[derive(Default)]
struct OrderWatch {
    order: Option<Order>,
    /// Nodes released and not passed.
    released: BTreeMap<u32, String>,
}

/// A floor of such robots.
struct LinkFloor {
    fleet: Fleet,
    now: Time,
    boot: u64,
    pairs: Vec<Pair>,
    ended: BTreeMap<JobId, JobState>,
    picks: BTreeMap<RobotId, Time>,
    /// How long messages travel.
    delay: Span,
    /// What else happens to messages.
    chance: Chance,
    /// What is closed, as sessions know it.
    closed: Arc<[BlockedArea]>,
    /// What is set for the robots' kind.
    settings: RobotLinkSettings,
}

/// Faults of the transport, drawn from a seed.
#[derive(Default)]
struct Chance {
    state: u64,
    /// Shares of messages that are lost and doubled, and the most that one is late, milliseconds.
    lost: f64,
    doubled: f64,
    late_ms: f64,
}

impl Chance {
    /// A number from 0 to 1: the generator is Knuth's, its upper bits are used.
    fn unit(&mut self) -> f64 {
        self.state =
            self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 11) as f64 / (1u64 << 53) as f64
    }

    /// How late each copy of a message is.
    fn copies(&mut self) -> Vec<Span> {
        let copies = if self.unit() < self.lost { 0 } else { 1 + usize::from(self.unit() < self.doubled) };
        (0..copies).map(|_| Span::from_millis((self.unit() * self.late_ms) as i64)).collect()
    }
}

fn settings() -> RobotLinkSettings {
    let parameters = || {
        let text = |key: &str, value: &str| Parameter { key: key.into(), value: value.into() };
        vec![text("stationType", "floor"), text("loadType", "EPAL")]
    };
    let maps = vec![MapFrame::same(FLOOR)];
    let mut settings = RobotLinkSettings { maps, horizon_nodes: HORIZON, ..RobotLinkSettings::default() };
    settings.lift.parameters = parameters();
    settings.set.parameters = parameters();
    settings
}

fn deliver(map: &Warehouse, rack: usize) -> JobRequest {
    let station = map.stations.ids().nth(rack % map.stations.len()).expect("there are stations");
    let rack = map.racks.ids().nth(rack).expect("there are as many racks");
    JobRequest::new(JobKind::Deliver { rack, station, pick: None })
}

impl LinkFloor {
    fn new(map: Warehouse, setups: Vec<RobotSetup>) -> LinkFloor {
        LinkFloor::of_kind(map, setups, settings())
    }

    /// A floor whose robots are of a kind with these settings.
    fn of_kind(map: Warehouse, setups: Vec<RobotSetup>, settings: RobotLinkSettings) -> LinkFloor {
        let mut fleet_settings =
            Settings { links: vec!["mqtt".into()], period: PERIOD, ..Settings::default() };
        fleet_settings.site_kinds[0].capabilities = Capabilities {
            revocation: true,
            limits: ObeyedLimits::Stops,
            drives_back: false,
            horizon_nodes: HORIZON,
        };
        fleet_settings.site_kinds[0].free_navigation = settings.free_navigation;
        let fleet = Fleet::new(Arc::new(map), fleet_settings);
        let mut floor = LinkFloor {
            fleet,
            now: Time::ZERO + Span::from_secs(1),
            boot: losses::FIRST_BOOT_MS,
            pairs: Vec::new(),
            ended: BTreeMap::new(),
            picks: BTreeMap::new(),
            delay: Span::from_millis(100),
            chance: Chance::default(),
            closed: Arc::default(),
            settings,
        };
        let map = floor.map();
        let places =
            map.nodes_where(|k| matches!(k, NodeKind::Charger | NodeKind::Parking | NodeKind::Storage));
        for (setup, node) in setups.into_iter().zip(places) {
            floor.switch_on(setup, node);
        }
        floor
    }

    fn map(&self) -> Arc<Warehouse> {
        self.fleet.warehouse().clone()
    }

    fn switch_on(&mut self, setup: RobotSetup, node: NodeId) {
        self.switch_on_beside(setup, node, 0.0);
    }

    /// Switches a robot on this far from a node, metres.
    fn switch_on_beside(&mut self, mut setup: RobotSetup, node: NodeId, off_m: f64) {
        let place = &self.map().nodes[node];
        (setup.position.x, setup.position.y) = (place.at.x + off_m, place.at.y);
        setup.position.map = FLOOR.into();
        setup.last_node = place.name.clone();
        setup.serial = format!("r{}", self.pairs.len());
        let mut settings = self.settings.clone();
        // Robot C says always that it does not know where it is.
        settings.needs_localized = setup.quirks.localized_flag == LocalizedFlag::Reported;
        let session = RobotSession::new(setup.version, settings.clone(), self.map(), self.boot);
        self.pairs.push(Pair {
            robot: EmbodiedRobot::new(setup),
            session,
            number: None,
            drive: None,
            joined_at: None,
            to_robot: Vec::new(),
            to_fleet: Vec::new(),
            next: 0,
            settings,
            told: Vec::new(),
            noticed: Vec::new(),
            watch: OrderWatch::default(),
            clock: Span::ZERO,
            failures: 0,
            says_also: None,
            acts: BTreeMap::new(),
        });
    }

    /// One control period.
    fn step(&mut self, requests: Vec<Input>) {
        let mut inputs = requests;
        self.tell_closed();
        for i in 0..self.pairs.len() {
            self.hear(i, &mut inputs);
        }
        inputs.extend(self.picked());
        let step = self.fleet.step(self.now, inputs);
        self.note(&step.facts);
        for (robot, command) in step.urgent.iter().chain(&step.commands) {
            let i = self.pairs.iter().position(|pair| pair.number == Some(*robot)).expect("it has joined");
            if matches!(command, giveway_fleet::Command::Drive { .. }) {
                self.pairs[i].drive = Some(command.clone());
            }
            let out = self.pairs[i].session.command(self.now, command);
            self.take(i, out, &mut Vec::new());
        }
        self.check();
        self.now += PERIOD;
    }

    /// Lets a robot act and its session hear what it says.
    fn hear(&mut self, i: usize, inputs: &mut Vec<Input>) {
        let now = self.now;
        let pair = &mut self.pairs[i];
        let arrived: Vec<Message> =
            pair.to_robot.extract_if(.., |(at, _)| *at <= now).map(|(_, message)| message).collect();
        let version = pair.session.version();
        for mut said in pair.robot.step(now.0, &arrived) {
            if let (Message::State(state), Some(also)) = (&mut said.message, &pair.says_also) {
                state.actions.retain(|action| action.id != also.id);
                state.actions.push(also.clone());
            }
            let stamp = MessageStamp { id: pair.next, timestamp: format!("{:020}", (now + pair.clock).0) };
            pair.next += 1;
            for late in self.chance.copies() {
                pair.to_fleet.push((now + late, travel(said.topic, &said.message, version), stamp.clone()));
            }
        }
        let mut arrived: Vec<(Time, Message, MessageStamp)> =
            pair.to_fleet.extract_if(.., |(at, ..)| *at <= now).collect();
        arrived.sort_by_key(|(at, ..)| *at);
        for (_, message, stamp) in arrived {
            let Some(heard) = heard(message, stamp) else { continue };
            let out = self.pairs[i].session.hear(now, heard);
            self.pairs[i].note_passed();
            self.take(i, out, inputs);
        }
        let out = self.pairs[i].session.tick(now);
        self.take(i, out, inputs);
        self.join(i, inputs);
    }

    /// A robot that stands on a node joins there.
    fn join(&mut self, i: usize, inputs: &mut Vec<Input>) {
        let name = format!("r{i}");
        let pair = &mut self.pairs[i];
        if pair.number.is_none() {
            let known = self.fleet.ledger().robots.pairs().find(|(_, record)| record.name == name);
            if let Some((robot, record)) = known {
                let chain = self.fleet.ledger().chain(robot);
                let (at, granted, recalls) = (chain.first(), chain.granted() - 1, record.recalls);
                let rack = self.fleet.ledger().rack_on(robot);
                pair.number = Some(robot);
                pair.joined_at.get_or_insert(self.now);
                let out = pair.session.join(self.now, SessionStart { robot, at, granted, recalls, rack });
                self.take(i, out, inputs);
            } else if let Some(at) = pair.session.whereabouts(self.now) {
                let kind = self.fleet.ledger().kinds()[0].name.clone();
                let node = self.fleet.place_to_join(&kind, at).expect("the floor has room");
                let link = Some("mqtt".to_owned());
                inputs.push(Input::ask(JOINS, RobotAction::Register { name, kind, node, link }));
            }
        }
    }

    fn take(&mut self, i: usize, out: SessionOutput, inputs: &mut Vec<Input>) {
        let (arrives, pair) = (self.now + self.delay, &mut self.pairs[i]);
        inputs.extend(out.reports.into_iter().map(Input::Telemetry));
        if let (Some(state), Some(robot)) = (out.link, pair.number) {
            inputs.push(Input::Link(robot, state));
        }
        pair.noticed.extend(out.noticed);
        for told in out.told {
            pair.told.push((self.now, told.kind, told.message.clone()));
            pair.see_acts(&told.message);
            if let Message::Order(order) = &told.message {
                let state = pair.robot.robot.state();
                let released = state.nodes.iter().filter(|n| n.released).map(|n| n.sequence).max();
                let has = (state.order == order.id).then(|| released.unwrap_or(state.last_sequence));
                pair.watch.see(order, has);
            }
            let message = travel(told.kind, &told.message, pair.session.version());
            for late in self.chance.copies() {
                pair.to_robot.push((arrives + late, message.clone()));
            }
        }
    }

    /// Pickers who are done.
    fn picked(&mut self) -> Vec<Input> {
        let ledger = self.fleet.ledger();
        let picked_from: Vec<RobotId> = ledger.present().filter(|r| ledger.is_picked_from(*r)).collect();
        self.picks.retain(|robot, _| picked_from.contains(robot));
        let mut said = Vec::new();
        for robot in picked_from {
            let since = *self.picks.entry(robot).or_insert(self.now);
            let NodeKind::Station(station) = ledger.warehouse().kind(ledger.node_of(robot)) else { continue };
            if self.now - since >= Span::from_secs(3) {
                said.push(Input::ask(9, Request::Station(station, StationOrder::Done)));
            }
        }
        said
    }

    fn note(&mut self, facts: &[Fact]) {
        for fact in facts {
            if let Fact::Job(JobFact::Progressed { job, state, .. }) = fact
                && state.is_over()
            {
                assert_eq!(self.ended.insert(*job, *state), None, "{job:?} ends once");
            }
        }
    }

    /// The laws of the link.
    fn check(&mut self) {
        let mut owners: BTreeMap<&str, usize> = BTreeMap::new();
        for (i, pair) in self.pairs.iter().enumerate() {
            for node in pair.watch.released.values() {
                let before = owners.insert(node, i);
                assert!(before.is_none_or(|b| b == i), "{:?}: {node} is released to two robots", self.now);
            }
        }
        // A robot that has never said where it is cannot be avoided.
        let known = self.pairs.iter().filter(|pair| pair.number.is_some() || pair.session.state().is_some());
        let bodies: Vec<(f64, f64)> = known.map(Pair::place).collect();
        for (i, a) in bodies.iter().enumerate() {
            for b in &bodies[..i] {
                let far = (a.0 - b.0).abs().max((a.1 - b.1).abs());
                assert!(far > 0.6, "{:?}: two robots touch at {a:?} {b:?}: {}", self.now, self.said());
            }
        }
    }

    fn run(&mut self, seconds: i64) {
        let end = self.now + Span::from_secs(seconds);
        while self.now < end {
            self.step(Vec::new());
        }
    }

    fn until(&mut self, seconds: i64, what: &str, is_so: impl Fn(&LinkFloor) -> bool) {
        let end = self.now + Span::from_secs(seconds);
        while !is_so(self) {
            assert!(self.now < end, "{what}, within {seconds} s; {}", self.said());
            self.step(Vec::new());
        }
    }

    fn all_ready(&mut self) {
        let is_ready = |f: &LinkFloor, p: &Pair| p.number.is_some() && p.session.not_ready(f.now).is_none();
        self.until(60, "all are ready", |f| f.pairs.iter().all(|p| is_ready(f, p)));
    }

    fn submit(&mut self, request: JobRequest) -> JobId {
        let id = JobId(self.fleet.ledger().next_job);
        self.step(vec![Input::ask(5, JobAction::Submit(request))]);
        assert!(self.fleet.ledger().jobs.contains_key(&id), "it is accepted");
        id
    }

    fn submit_deliveries(&mut self, count: usize) -> Vec<JobId> {
        let map = self.map();
        (0..count).map(|rack| self.submit(deliver(&map, rack))).collect()
    }

    fn until_done(&mut self, jobs: &[JobId], seconds: i64) {
        let open = jobs.to_vec();
        self.until(seconds, "all jobs end", move |f| open.iter().all(|job| f.ended.contains_key(job)));
        for job in jobs {
            assert_eq!(self.ended[job], JobState::Done, "{job:?}");
        }
    }

    /// How everything is, for failures.
    fn said(&self) -> String {
        let one = |(i, pair): (usize, &Pair)| {
            let robot = pair.number;
            let why = robot.and_then(|r| self.fleet.why(r));
            let not_ready = pair.session.not_ready(self.now);
            let (state, order) = (pair.robot.robot.state(), pair.session.order_text());
            let nodes: Vec<(u32, bool)> = state.nodes.iter().map(|n| (n.sequence, n.released)).collect();
            let at = format!("{} {}: {nodes:?}, paused {:?}", state.order, state.last_sequence, state.paused);
            format!("\n r{i} {why:?} {not_ready:?} {order:?} robot {at} {:?}", pair.noticed)
        };
        let (view, map) = (self.fleet.view(self.now), self.map());
        let jobs = self.fleet.ledger().jobs.iter();
        let open: Vec<_> = jobs.map(|(id, job)| (*id, job.state, view.why_job(&map, *id, job))).collect();
        format!("open {open:?}{}", self.pairs.iter().enumerate().map(one).collect::<String>())
    }

    fn notices(&self, i: usize) -> Vec<String> {
        self.pairs[i].noticed.iter().map(|notice| notice.said().to_string()).collect()
    }
}

impl OrderWatch {
    /// Checks that an order or update is stitched rightly, and takes what it releases. `has` is the last sequence
    /// number that the robot was released to, if it has the order.
    fn see(&mut self, order: &Order, has: Option<u32>) {
        assert!(order.nodes.windows(2).all(|pair| pair[0].sequence + 2 == pair[1].sequence), "{order:?}");
        assert!(order.nodes.windows(2).all(|pair| pair[0].released || !pair[1].released), "{order:?}");
        assert_eq!(order.edges.len() + 1, order.nodes.len(), "{order:?}");
        let repeats = self.order.as_ref() == Some(order);
        match self.order.as_ref().filter(|before| before.id == order.id && order.update > 0) {
            Some(before) if !repeats => {
                let last = before.nodes.iter().rfind(|node| node.released).expect("the first is released");
                // Numbers leap where a process goes on with an order of an earlier one.
                let leaps = order.update > before.update.max(1_000_000);
                assert!(order.update == before.update + 1 || leaps, "{order:?} after {before:?}");
                // What was sent and lost is no part of what the robot has.
                let first = &order.nodes[0];
                // A robot that began anew has nothing, and takes it for another order.
                let fits = has.is_none_or(|has| has == first.sequence);
                let is_end = first == last || fits && order.update > before.update;
                assert!(is_end, "stitched at {first:?}, not at {last:?} or {has:?}");
                assert!(last.actions.is_empty() || first.sequence < last.sequence, "{order:?}");
            }
            Some(_) => {}
            None => {
                assert!(repeats || order.update == 0 || self.order.is_none(), "{order:?}");
                self.released.clear();
            }
        }
        for node in order.nodes.iter().filter(|node| node.released) {
            self.released.insert(node.sequence, node.id.trim_start_matches('~').to_owned());
        }
        self.order = Some(order.clone());
    }

    /// What the robot has behind it.
    fn pass(&mut self, order: &str, sequence: u32, has_ended: bool) {
        if self.order.as_ref().is_some_and(|o| o.id == order) {
            self.released.retain(|s, _| *s >= sequence);
            if has_ended && self.released.len() > 1 && self.released.keys().next() == Some(&sequence) {
                // The order was cancelled where the robot stands.
                let cancelled = self.released.keys().nth(1).is_some();
                if cancelled {
                    self.released.retain(|s, _| *s <= sequence + 2);
                }
            }
        }
    }
}

fn header(version: Version) -> Header {
    Header {
        id: 1,
        timestamp: "2026-11-30T12:00:00.000Z".into(),
        version: version.text().into(),
        manufacturer: "maker".into(),
        serial: "r".into(),
    }
}

/// A message as it travels: written by one side, read by the other.
fn travel(kind: TopicKind, message: &Message, version: Version) -> Message {
    let written = write(&header(version), message, version);
    assert_eq!(validity::faults(kind, version, &written), "", "{written}");
    let text = written.to_string();
    let said = read(kind, text.as_bytes()).expect("what is written can be read");
    assert_eq!(said.oddities, [], "{text}");
    said.message
}

fn heard(message: Message, stamp: MessageStamp) -> Option<RobotHeard> {
    match message {
        Message::State(state) => Some(RobotHeard::State(state, stamp)),
        Message::Visualization(seen) => Some(RobotHeard::Visualization(seen, stamp)),
        Message::Connection(connection) => Some(RobotHeard::Connection(connection)),
        Message::Factsheet(factsheet) => Some(RobotHeard::Factsheet(factsheet)),
        Message::Order(_) | Message::InstantActions(_) | Message::ZoneSet(_) | Message::Responses(_) => None,
    }
}

fn standard(version: Version) -> RobotSetup {
    RobotSetup::new(version, "maker", "r", FLOOR, "n")
}

#[test]
fn robots_of_all_versions_and_two_vendors_join_and_deliver_in_one_fleet() {
    let setups = vec![
        RobotSetup::like_a(),
        RobotSetup::like_b(),
        standard(Version::V2_0),
        standard(Version::V2_1),
        standard(Version::V3_0),
        standard(Version::V3_0),
    ];
    let mut floor = LinkFloor::new(thesis(), setups);
    floor.all_ready();
    let jobs = floor.submit_deliveries(24);
    floor.until_done(&jobs, 3600);
    let served: BTreeSet<usize> = (0..6).filter(|i| !floor.pairs[*i].told.is_empty()).collect();
    assert_eq!(served.len(), 6);
    for i in 0..6 {
        assert_eq!(floor.notices(i), [""; 0], "robot {i}");
    }
}

#[test]
fn a_robot_drives_only_once_it_has_paused_and_gone_on_where_it_stands() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_1)]);
    floor.run(1);
    assert_eq!(floor.pairs[0].session.not_ready(floor.now), Some(NotReady::Unproven));
    floor.all_ready();
    let told: Vec<&str> = (floor.pairs[0].told.iter())
        .filter_map(|(_, _, message)| match message {
            Message::InstantActions(actions) => Some(actions[0].kind.as_str()),
            _ => None,
        })
        .filter(|kind| !kind.ends_with("Request"))
        .collect();
    assert_eq!(told, ["startPause", "stopPause"]);
    let first = |wanted: TopicKind| floor.pairs[0].told.iter().position(|(_, kind, _)| *kind == wanted);
    assert!(
        first(TopicKind::Order).is_none_or(|order| order > first(TopicKind::InstantActions).unwrap_or(0))
    );
}

#[test]
fn an_order_ends_at_the_stop_and_its_action_is_there_once() {
    let mut floor = LinkFloor::new(lab(), vec![standard(Version::V2_0)]);
    floor.all_ready();
    let jobs = floor.submit_deliveries(2);
    floor.until_done(&jobs, 900);
    let mut picks = BTreeMap::new();
    for (_, _, message) in &floor.pairs[0].told {
        let Message::Order(order) = message else { continue };
        for node in &order.nodes {
            for action in &node.actions {
                *picks.entry(action.id.clone()).or_insert(0) += 1;
                assert_eq!(
                    order.nodes.last().map(|n| n.sequence),
                    Some(node.sequence),
                    "it is the last node"
                );
            }
        }
    }
    assert!(picks.len() >= 3 && picks.values().all(|times| *times == 1), "{picks:?}");
    let is_lift = |stop: &giveway_fleet::Stop| matches!(stop.act, Act::Lift(_));
    assert!(!floor.fleet.ledger().robots[RobotId::at(0)].stops.iter().any(is_lift));
}

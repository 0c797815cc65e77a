//! The session of one robot: what is known of it, and what goes in and out.
//!
//! Main types: [`RobotSession`], [`SessionOutput`]. Every call ends with the same look at what is to be done next, so
//! that a lost message is noticed by whatever comes after it. Refuses: clocks, and numbers of messages, which belong to
//! who sends them.

use super::acts::ActFailure;
use super::charge::ChargeLife;
use super::contact::{NotReady, Obedience};
use super::lease::Leases;
use super::motion::SeenMotion;
use super::notice::Notice;
use super::operator::SentAction;
use super::order::{LegOrder, OrderLife, UpdateLife, first_of};
use super::overtaken::MessageOrder;
use super::pause::PauseLife;
use super::trigger::TriggerLife;
use super::trust::Trust;
use super::zones::ZoneLife;
use giveway_fleet::{Command, LinkState, Telemetry, Waypoint};
use giveway_floor::id::{NodeId, RackId, RobotId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use giveway_site::RobotLinkSettings;
use giveway_vda5050::{
    Action, ActionState, BlockingType, ConnectionState, Factsheet, Message, Parameter, State, TopicKind,
    Version, Visualization,
};
use std::collections::VecDeque;
use std::sync::Arc;

/// Orders and instant actions that have not reached the robot after this never do.
pub(super) const EXPIRES: Span = Span::from_secs(3);

/// Something that was heard of a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum RobotHeard {
    /// Its connection, or the broker's word for it.
    Connection(ConnectionState),
    /// Its state, with the number and time of the message.
    State(Box<State>, MessageStamp),
    /// Where it is, with the number and time of the message.
    Visualization(Visualization, MessageStamp),
    /// What it says that it can do.
    Factsheet(Box<Factsheet>),
    /// It speaks a version that is not spoken here.
    OtherVersion(String),
    /// A message under its topic names another robot.
    OtherName(String),
}

/// The number of a message among those of its topic, and its time by the robot's clock.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageStamp {
    /// The number.
    pub id: u32,
    /// The time, as the robot writes it.
    pub timestamp: String,
}

/// A message for the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotTold {
    /// Its topic.
    pub kind: TopicKind,
    /// The message.
    pub message: Message,
    /// After this it is worth nothing any more.
    pub expires: Span,
}

/// What a session wants to happen outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SessionOutput {
    /// Messages for the robot, in order.
    pub told: Vec<RobotTold>,
    /// Reports for the fleet.
    pub reports: Vec<Telemetry>,
    /// The state of the robot at its link, if it changed.
    pub link: Option<LinkState>,
    /// What was noticed of the robot.
    pub noticed: Vec<Notice>,
    /// How long an order or update took from being sent, or asked about, until a state showed that the robot has it.
    pub taken: Option<Span>,
}

/// What the ledger knows of a robot when its session begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SessionStart {
    /// The robot's number.
    pub robot: RobotId,
    /// The serial number of the visit where it is, as far as the ledger knows.
    pub at: u64,
    /// The serial number of the last visit that it was granted.
    pub granted: u64,
    /// How many revocations it has obeyed.
    pub recalls: u64,
    /// The rack on it.
    pub rack: Option<RackId>,
}

/// How far the robot is, as the fleet counts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RobotProgress {
    pub robot: RobotId,
    pub reached: u64,
    pub known: u64,
    pub acted: Option<u64>,
    pub rack: Option<RackId>,
    pub recalls: u64,
    /// An action that failed: the robot waits for a person.
    pub failed: Option<ActFailure>,
}

/// What the fleet last told the robot to drive.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WantedDrive {
    pub waypoints: Vec<Waypoint>,
    pub horizon: Vec<NodeId>,
}

/// An instant action that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AskedAction {
    /// The action's id, the same each time.
    pub id: String,
    /// When it was asked for first and last.
    pub since: Time,
    pub last: Time,
    pub tries: u32,
}

/// The session of one robot.
#[derive(Debug)]
pub struct RobotSession {
    pub(super) version: Version,
    pub(super) settings: RobotLinkSettings,
    pub(super) map: Arc<Warehouse>,
    /// When the process began, milliseconds since 1970: what two processes send never has the same id.
    pub(super) boot: u64,
    /// Ids given out so far.
    pub(super) ids: u64,
    pub(super) connection: Option<ConnectionState>,
    pub(super) other_version: Option<String>,
    pub(super) factsheet: Option<Box<Factsheet>>,
    /// When the robot was asked what it can do.
    pub(super) factsheet_asked: Option<Time>,
    /// When the robot was last told to forget instant actions that are over.
    pub(super) cleared: Option<Time>,
    /// When the last order or update was sent.
    pub(super) ordered: Option<Time>,
    /// The last state, and when it arrived.
    pub(super) state: Option<(Time, Box<State>)>,
    pub(super) states: MessageOrder,
    pub(super) poses: MessageOrder,
    /// Whether the line to all robots is down: nothing is told, and nobody's silence means anything.
    pub(super) line_down: bool,
    /// When a state was asked for last.
    pub(super) state_asked: Option<Time>,
    /// When the first of the requests for a state was sent that are not answered yet.
    pub(super) unanswered: Option<Time>,
    pub(super) motion: SeenMotion,
    pub(super) obedience: Obedience,
    pub(super) pause: PauseLife,
    /// The speed to which the fleet limits the robot, metres per second.
    pub(super) limit_mps: Option<f64>,
    /// What the robot was granted that it asked for.
    pub(super) leases: Leases,
    pub(super) order: OrderLife,
    pub(super) wanted: Option<WantedDrive>,
    pub(super) progress: Option<RobotProgress>,
    /// The last visit that the robot was granted before this process, until this one has ordered something itself.
    pub(super) adopts: Option<u64>,
    /// Whether a state has come that answers this session.
    pub(super) has_answered: bool,
    /// When this session first asked for a state.
    pub(super) first_asked: Option<Time>,
    pub(super) charge: ChargeLife,
    /// The dismissal of a robot that waits at a work cell.
    pub(super) trigger: TriggerLife,
    pub(super) zones: ZoneLife,
    /// The length of the map's shortest lane, metres.
    pub(super) shortest_m: f64,
    pub(super) trust: Trust,
    /// Actions that operators sent, the newest last.
    pub(super) sent: VecDeque<SentAction>,
    /// The last notice, which is not given twice in a row.
    pub(super) last_notice: Option<Notice>,
    /// Whether the robot was seen to claim that it cancelled its order, and to keep it.
    pub(super) claims_cancels: bool,
    /// Rejections in a row, with the robot's last words.
    pub(super) rejected: (u32, String),
    /// Until when no order is sent, after a rejection.
    pub(super) rests_until: Time,
    /// The number of the last report.
    pub(super) seq: u64,
    pub(super) link: LinkState,
    pub(super) out: SessionOutput,
}

impl RobotSession {
    /// A session with a robot of which nothing is known yet.
    pub fn new(
        version: Version,
        settings: RobotLinkSettings,
        map: Arc<Warehouse>,
        boot: u64,
    ) -> RobotSession {
        let shortest_m = map.lanes.iter().map(|lane| lane.length_m).fold(f64::INFINITY, f64::min);
        RobotSession {
            version,
            settings,
            map,
            boot,
            ids: 0,
            connection: None,
            other_version: None,
            factsheet: None,
            factsheet_asked: None,
            cleared: None,
            ordered: None,
            state: None,
            states: MessageOrder::default(),
            poses: MessageOrder::default(),
            line_down: false,
            state_asked: None,
            unanswered: None,
            motion: SeenMotion::default(),
            obedience: Obedience::Unproven,
            pause: PauseLife::default(),
            limit_mps: None,
            leases: Leases::default(),
            order: OrderLife::Idle,
            wanted: None,
            progress: None,
            adopts: None,
            has_answered: false,
            first_asked: None,
            charge: ChargeLife::Off,
            trigger: TriggerLife::default(),
            zones: ZoneLife::default(),
            shortest_m: shortest_m.max(0.05),
            trust: Trust::default(),
            sent: VecDeque::new(),
            last_notice: None,
            claims_cancels: false,
            rejected: (0, String::new()),
            rests_until: Time::ZERO,
            seq: 0,
            link: LinkState::default(),
            out: SessionOutput::default(),
        }
    }

    /// Another session with the same robot, which speaks this version. What is sent in it has other ids, since a robot
    /// takes what has an old one for a repetition.
    #[must_use]
    pub fn begin_again(&self, version: Version) -> RobotSession {
        let new = RobotSession::new(version, self.settings.clone(), self.map.clone(), self.boot);
        RobotSession { ids: self.ids, trust: self.trust, ..new }
    }

    /// The robot has joined the fleet, or was in its ledger when the process began. An order of an earlier process that
    /// it still has is taken for its own.
    pub fn join(&mut self, now: Time, start: SessionStart) -> SessionOutput {
        let SessionStart { robot, at, granted, recalls, rack } = start;
        let acted = None;
        self.progress =
            Some(RobotProgress { robot, reached: at, known: at, acted, rack, recalls, failed: None });
        self.adopts = Some(granted);
        self.adopt(now);
        self.report(now);
        self.go_on(now)
    }

    /// Takes what was heard of the robot.
    pub fn hear(&mut self, now: Time, heard: RobotHeard) -> SessionOutput {
        match heard {
            RobotHeard::Connection(connection) => {
                // A robot that begins anew may take what it refused.
                if connection == ConnectionState::Online && self.connection != Some(connection) {
                    self.rejected.0 = 0;
                }
                self.connection = Some(connection);
            }
            RobotHeard::OtherVersion(version) => self.other_version = Some(version),
            RobotHeard::OtherName(named) => self.notice(Notice::OtherName { named }),
            RobotHeard::Factsheet(factsheet) => self.factsheet = Some(factsheet),
            RobotHeard::State(_, stamp) if !self.states.takes(stamp.id, &stamp.timestamp) => {}
            RobotHeard::Visualization(_, stamp) if !self.poses.takes(stamp.id, &stamp.timestamp) => {}
            RobotHeard::Visualization(seen, _) => {
                self.see(now, seen.position.as_ref(), seen.velocity);
                self.report(now);
            }
            RobotHeard::State(state, _) => self.take_state(now, state),
        }
        self.go_on(now)
    }

    /// Takes a command of the fleet.
    pub fn command(&mut self, now: Time, command: &Command) -> SessionOutput {
        match command {
            Command::Drive { waypoints, recalls, horizon, .. } => {
                let least = self.least_recalls();
                let obeyed = self.progress.as_ref().is_some_and(|p| *recalls >= p.recalls.max(least));
                if obeyed {
                    self.wanted =
                        Some(WantedDrive { waypoints: waypoints.clone(), horizon: horizon.clone() });
                }
            }
            Command::Limit(limit) => {
                (self.limit_mps, self.pause.wanted) = (*limit, *limit == Some(0.0));
            }
            Command::Revoke { reached, number } => self.revoke(now, *reached, *number),
        }
        self.go_on(now)
    }

    /// The line to the broker is back: what was sent while it was down never left, and nobody knows what was heard.
    pub fn line_is_back(&mut self, now: Time) -> SessionOutput {
        (self.line_down, self.unanswered) = (false, None);
        self.request_state(now);
        self.go_on(now)
    }

    /// The line to all robots is down: this one drives on to the end of what it was released, and is not to blame.
    pub fn line_is_down(&mut self, now: Time) -> SessionOutput {
        self.line_down = true;
        self.go_on(now)
    }

    /// Time passes: what was not answered is asked again, and silence is noticed.
    pub fn tick(&mut self, now: Time) -> SessionOutput {
        self.go_on(now)
    }

    /// The version that is spoken with the robot.
    pub fn version(&self) -> Version {
        self.version
    }

    /// What the robot says that it can do, if it has said so.
    pub fn factsheet(&self) -> Option<&Factsheet> {
        self.factsheet.as_deref()
    }

    /// The last state, and when it arrived.
    pub fn state(&self) -> Option<(Time, &State)> {
        self.state.as_ref().map(|(at, state)| (*at, &**state))
    }

    fn take_state(&mut self, now: Time, state: Box<State>) {
        // A state that comes after the broker's word that the robot is gone outweighs it.
        if self.connection == Some(ConnectionState::Broken) {
            self.connection = Some(ConnectionState::Online);
        }
        self.other_version = None;
        self.see(now, state.position.as_ref(), state.velocity);
        self.state = Some((now, state));
        self.unanswered = None;
        // What a state has shown once is known: a robot may list what it was asked in a few states only.
        self.has_answered = self.has_answered || self.is_answer();
        self.note_paused(now);
        self.adopt(now);
        self.note_order(now);
        self.note_act(now);
        self.note_sent();
        self.report(now);
    }

    /// The order that the robot drives by and how far it is, for people who look into trouble.
    pub fn order_text(&self) -> String {
        match &self.order {
            OrderLife::Idle => "no order".to_owned(),
            OrderLife::Has(leg) => {
                let taken = if leg.sent == UpdateLife::Taken { "taken" } else { "not taken yet" };
                let leaves = if self.leases.held() > 0 { ", may leave its line" } else { "" };
                format!("{}, update {}, released to visit {}, {taken}{leaves}", leg.id, leg.update, leg.base)
            }
            OrderLife::Cancels { leg, .. } => format!("{} is being cancelled", leg.id),
        }
    }

    /// What is to be done next, after anything that happened.
    fn go_on(&mut self, now: Time) -> SessionOutput {
        self.trust.regain(now);
        if self.line_down {
            self.note_link(now);
            return std::mem::take(&mut self.out);
        }
        self.ask_for_state(now);
        self.mind_pause(now);
        self.mind_leases(now);
        self.prove_obedience(now);
        self.ask_for_factsheet(now);
        self.mind_zones(now);
        let (cancels, not_ready) = (self.mind_cancel(now), self.not_ready(now));
        if !cancels && not_ready == Some(NotReady::NeedsButton) {
            // It may take a trigger yet.
            self.mind_trigger(now);
        }
        if !cancels && not_ready.is_none() {
            self.note_arrival(now);
            if !self.mind_charge(now) {
                self.mind_order(now);
            }
            self.mind_retry(now);
            self.ask_about_act(now);
            self.ask_where_it_stands(now);
            self.clear_instants(now);
        }
        for _lie in self.out.noticed.iter().filter(|notice| notice.is_lie()) {
            self.trust.lose(now);
        }
        self.note_link(now);
        self.assert_sound();
        std::mem::take(&mut self.out)
    }

    /// What holds after everything that happened.
    fn assert_sound(&self) {
        if let Some(progress) = &self.progress {
            let RobotProgress { reached, known, acted, .. } = *progress;
            debug_assert!(
                reached <= known,
                "the robot is beyond what it was released to: {reached}, {known}"
            );
            debug_assert!(
                acted <= Some(reached),
                "the robot acted where it has not been: {acted:?}, {reached}"
            );
        }
        if let Some(leg) = self.leg() {
            let LegOrder { id, first, base, known, .. } = leg;
            debug_assert!(first <= known && known <= base, "{id} is known beyond its base: {known}, {base}");
            debug_assert_eq!(leg.nodes.len() as u64, base - first + 1, "{id} has a node for each visit");
            debug_assert!(leg.act.as_ref().is_none_or(|act| act.serial == *base), "{id} acts before its end");
            debug_assert_eq!(first_of(id), Some(*first), "its id tells where {id} begins");
            debug_assert!(self.progress.is_some(), "{id} is for a robot that has not joined");
        }
        let orders = self.out.told.iter().filter(|told| told.kind == TopicKind::Order).count();
        debug_assert!(orders <= 1, "{orders} orders at once");
    }

    /// Sends an instant action, alone in its message: two of them kill some robots.
    pub(super) fn instant(&mut self, kind: &str, id: &str, parameters: Vec<Parameter>) {
        let (kind, id) = (kind.to_owned(), id.to_owned());
        let action = Action { kind, id, blocking: BlockingType::None, parameters, retriable: false };
        self.tell(TopicKind::InstantActions, Message::InstantActions(vec![action]));
    }

    pub(super) fn tell(&mut self, kind: TopicKind, message: Message) {
        self.out.told.push(RobotTold { kind, message, expires: EXPIRES });
    }

    /// Passes on what was noticed, unless it was the last thing that was.
    pub(super) fn notice(&mut self, notice: Notice) {
        if self.last_notice.as_ref() != Some(&notice) {
            self.last_notice = Some(notice.clone());
            self.out.noticed.push(notice);
        }
    }

    /// An id that was never used before.
    pub(super) fn new_id(&mut self) -> String {
        self.ids += 1;
        format!("gw-{}-{}", self.boot, self.ids)
    }

    /// What the robot says about one of our actions.
    pub(super) fn action_state(&self, id: &str) -> Option<&ActionState> {
        let (_, state) = self.state.as_ref()?;
        state.actions.iter().chain(&state.instant_actions).find(|action| action.id == id)
    }

    /// The order that the robot drives by, if it is ours.
    pub(super) fn leg(&self) -> Option<&LegOrder> {
        match &self.order {
            OrderLife::Idle => None,
            OrderLife::Has(leg) | OrderLife::Cancels { leg, .. } => Some(leg),
        }
    }
}

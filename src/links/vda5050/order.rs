//! Orders: one for each leg, ending at the stop with its action; and what the robot has taken of them.
//!
//! Main types: [`LegOrder`], [`OrderLife`]. A leg's visits have consecutive serial numbers, so that its sequence
//! numbers are twice the visits beyond its first one; the first one's serial number is part of the order's id, so that
//! a process that begins anew knows an order of an earlier one. Refuses: to send an update before the last one was
//! taken.

use super::acts::LegAct;
use super::cancel::Cancel;
use super::contact::ON_NODE_M;
use super::notice::Notice;
use super::session::{RobotSession, WantedDrive};
use giveway_fleet::{Act, Waypoint};
use giveway_floor::geometry::Point;
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time};
use giveway_site::RepeatRule;
use giveway_vda5050::{Edge, Message, Node, NodePosition, Order, RobotError, State, TopicKind};

/// An order that a state does not reflect after this is asked about.
pub(super) const TAKES: Span = Span::from_millis(1000);
/// How often one order is sent.
const TIMES: u32 = 3;
/// After a rejection no order is sent for this long.
const RESTS: Span = Span::from_secs(5);
/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.05;

/// The order that a robot has of us.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum OrderLife {
    /// None, or one that has ended.
    Idle,
    /// It drives by it, or is to.
    Has(LegOrder),
    /// It is being cancelled.
    Cancels { leg: LegOrder, cancel: Cancel },
}

impl OrderLife {
    /// The order that the robot has, or that is being cancelled.
    pub fn leg_mut(&mut self) -> Option<&mut LegOrder> {
        match self {
            OrderLife::Idle => None,
            OrderLife::Has(leg) | OrderLife::Cancels { leg, .. } => Some(leg),
        }
    }
}

/// An order of one leg.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LegOrder {
    pub id: String,
    /// The serial number of the visit that has the sequence number 0.
    pub first: u64,
    /// The last update that was sent, and the last visit that it releases.
    pub update: u32,
    pub base: u64,
    /// The last visit that the robot is known to have been released to.
    pub known: u64,
    /// How far the last update is.
    pub sent: UpdateLife,
    /// The nodes of all visits that were released, from the first one on; nothing for those of an earlier process.
    pub nodes: Vec<Option<NodeId>>,
    /// Whether the last update announces nodes beyond its base: such an order does not end by itself.
    pub announces: bool,
    /// What it does at its end.
    pub act: Option<LegAct>,
    /// The sequence number that the robot said last before it had this order: it may say it for a while longer.
    pub before: Option<u32>,
    /// The robot's complaints from before the last update.
    pub complaints: Vec<RobotError>,
    /// The message, to be sent again.
    pub message: Option<Order>,
}

/// How far an update is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum UpdateLife {
    /// The robot has it.
    Taken,
    /// It was sent this often, last at this time.
    Sent { times: u32, last: Time },
    /// A state was asked for, to see whether the robot has it.
    Doubted { times: u32, asked: Time },
}

impl LegOrder {
    /// Whether the order is one of an earlier process. No update of it is sent: another one with the same number may
    /// still be on its way, and its last node may have an action.
    fn is_adopted(&self) -> bool {
        self.message.is_none()
    }

    /// The serial number of the visit with a sequence number.
    pub fn serial(&self, sequence: u32) -> u64 {
        self.first + u64::from(sequence / 2)
    }
}

impl RobotSession {
    /// Whether an order has an id of ours.
    pub(super) fn is_ours(&self, order: &str) -> bool {
        first_of(order).is_some()
    }

    /// Notes in a state what the robot has taken of its order, and how far it is with it. It may drive on for a while
    /// when its order is cancelled.
    pub(super) fn note_order(&mut self, now: Time) {
        let is_cancelled = matches!(self.order, OrderLife::Cancels { .. });
        let (Some((_, state)), Some(leg), Some(progress)) =
            (&self.state, self.order.leg_mut(), &mut self.progress)
        else {
            return;
        };
        let has_it = state.order == leg.id;
        if leg.sent != UpdateLife::Taken {
            if has_it && state.update >= leg.update {
                if let UpdateLife::Sent { last, .. } | UpdateLife::Doubted { asked: last, .. } = leg.sent {
                    self.out.taken = Some(now - last);
                }
                (leg.sent, leg.known) = (UpdateLife::Taken, leg.base);
                self.rejected.0 = 0;
            } else if let Some(words) = complaint(leg, &state.errors).filter(|_| !is_cancelled) {
                return self.reject(now, words);
            }
        } else if !has_it && !is_cancelled {
            // The robot has forgotten the order: it began anew, perhaps elsewhere. What it drives next, the fleet says
            // when it has heard where that is.
            (self.order, self.wanted) = (OrderLife::Idle, None);
            progress.known = progress.reached;
            return;
        }
        // A robot that has just taken an order may still say the number that it had in the one before.
        let is_stale = state.nodes.iter().any(|node| node.sequence < state.last_sequence);
        if !has_it || is_stale {
            return;
        }
        let serial = leg.serial(state.last_sequence);
        progress.known = progress.known.max(leg.known);
        let node = leg.nodes.get((serial - leg.first) as usize).copied().flatten();
        let is_named = node.is_none_or(|n| is_name(&self.map.nodes[n].name, &state.last_node));
        let is_false = serial > leg.known || !is_named;
        if is_false && leg.before == Some(state.last_sequence) {
            return;
        }
        if is_false {
            let said = format!("node {:?}, number {}", state.last_node, state.last_sequence);
            self.notice(Notice::FalseProgress { said });
        } else {
            progress.reached = progress.reached.max(serial);
        }
    }

    /// A drive that begins after all that the robot knows is for the place where it stands: people put it there, or it
    /// could not do what it was to do. An order of which only announced nodes are left is cancelled first.
    fn take_up(&mut self, now: Time, drive: &WantedDrive) {
        let (Some(first), Some(progress)) = (drive.waypoints.first(), &mut self.progress) else { return };
        let here =
            self.motion.pose().is_some_and(|p| (self.map.nodes[first.node].at - p.at).norm() <= ON_NODE_M);
        if first.serial <= progress.known || !here {
            return;
        }
        match &self.order {
            OrderLife::Idle => (progress.reached, progress.known) = (first.serial, first.serial),
            OrderLife::Has(leg) if leg.announces && progress.reached == leg.base => {
                self.begin_cancel(now, None)
            }
            OrderLife::Has(_) | OrderLife::Cancels { .. } => {}
        }
    }

    /// A robot that is where it has only to be is done there.
    pub(super) fn note_arrival(&mut self, now: Time) {
        let (Some(wanted), Some(progress)) = (&self.wanted, &mut self.progress) else { return };
        let here = wanted.waypoints.iter().find(|w| w.serial == progress.reached);
        let Some(here) = here.filter(|w| progress.acted < Some(w.serial)) else { return };
        if matches!(here.act, Some(Act::Arrive | Act::Pick(_))) && self.motion.speed_mps() < STANDS_MPS {
            progress.acted = Some(here.serial);
            self.report(now);
        }
    }

    /// Sends what is to be driven and was not sent yet.
    pub(super) fn mind_order(&mut self, now: Time) {
        let Some(wanted) = self.wanted.clone() else { return };
        self.take_up(now, &wanted);
        let Some(progress) = &self.progress else { return };
        let waits = now < self.rests_until.max(self.next_order()) || self.might_set_off(now);
        if progress.failed.is_some() || waits || !self.knows_what_was_ordered() {
            return;
        }
        let Some(end) = self.base_end(&wanted) else { return };
        let (reached, acts) = (progress.reached, self.acts_here(&wanted));
        if (end > reached || acts) && self.mind_trigger(now) {
            return;
        }
        match &self.order {
            OrderLife::Idle if end > reached || acts => self.send_leg(now, &wanted, end),
            OrderLife::Has(leg) if leg.sent != UpdateLife::Taken => self.mind_update(now),
            OrderLife::Has(leg) if leg.act.is_some() => {}
            OrderLife::Has(leg) if leg.is_adopted() => {
                if reached == leg.base && (end > reached || acts) {
                    self.go_on_from_adopted(now, &wanted, acts);
                }
            }
            OrderLife::Has(leg) if end > leg.base => self.send_update(now, &wanted, end),
            OrderLife::Has(leg) if acts && reached == leg.base => self.act_where_it_stands(now, &wanted),
            OrderLife::Idle | OrderLife::Has(_) | OrderLife::Cancels { .. } => {}
        }
    }

    /// Whether the robot has nothing left to drive, as it says.
    pub(super) fn has_driven_all(&self) -> bool {
        self.state.as_ref().is_some_and(|(_, state)| state.nodes.is_empty() && state.edges.is_empty())
    }

    /// The robot has driven its order and is to do something where it is, of which the order says nothing. An order of
    /// an earlier process may have said it.
    pub(super) fn act_where_it_stands(&mut self, now: Time, wanted: &WantedDrive) {
        let OrderLife::Has(leg) = &self.order else { return };
        let (base, announces, is_adopted) = (leg.base, leg.announces, leg.is_adopted());
        let here = wanted.waypoints.iter().find(|w| w.serial == base);
        let act = here.and_then(|w| self.leg_act(&leg.id, w));
        let was_said = |a: &LegAct| a.action.as_ref().is_some_and(|a| self.action_state(&a.id).is_some());
        let said = act.filter(|act| is_adopted && (was_said(act) || self.shows_done(act)));
        match (&mut self.order, said) {
            (OrderLife::Has(leg), Some(act)) => {
                leg.act = Some(act);
                self.note_act(now);
            }
            _ if announces => self.send_update(now, wanted, base),
            _ => {
                self.order = OrderLife::Idle;
                self.send_leg(now, wanted, base);
            }
        }
    }

    /// When the next order or update may be sent, as the robot's factsheet has it.
    fn next_order(&self) -> Time {
        const LONGEST_S: f64 = 10.0;
        let interval_s = self.factsheet.as_ref().and_then(|sheet| sheet.order_interval_s).unwrap_or(0.0);
        // What a robot says of itself must not keep it standing for ever.
        let interval = Span::from_secs_f64(interval_s.clamp(0.0, LONGEST_S));
        self.ordered.map_or(Time::ZERO, |last| last + interval)
    }

    /// The most visits of an order, as the robot's factsheet has it; two at least.
    fn most_nodes(&self) -> usize {
        let said = self.factsheet.as_ref().and_then(|sheet| sheet.most_nodes).filter(|most| *most > 0);
        said.unwrap_or(usize::MAX).max(2)
    }

    /// The last visit that the robot may be released to: no farther than the longest base, and one more at least.
    pub(super) fn base_end(&self, wanted: &WantedDrive) -> Option<u64> {
        let (reached, longest_m) = (self.progress.as_ref()?.reached, self.longest_base_m());
        let ahead = wanted.waypoints.iter().filter(|w| w.serial >= reached).take(self.most_nodes());
        let (mut end, mut length_m, mut last) = (None, 0.0, None::<Point>);
        for waypoint in ahead {
            let at = self.map.nodes[waypoint.node].at;
            length_m += last.map_or(0.0, |last| (at - last).norm());
            if length_m > longest_m && end > Some(reached) {
                break;
            }
            (end, last) = (Some(waypoint.serial), Some(at));
            if waypoint.act.is_some() && waypoint.serial > reached {
                break;
            }
        }
        end
    }

    /// Whether there is something to do where the robot stands.
    fn acts_here(&self, wanted: &WantedDrive) -> bool {
        let Some(progress) = &self.progress else { return false };
        let here = wanted.waypoints.iter().find(|w| w.serial == progress.reached);
        let does = |w: &Waypoint| matches!(w.act, Some(Act::Lift(_) | Act::Set(_)));
        here.is_some_and(|w| does(w) && progress.acted < Some(w.serial))
    }

    /// Sends a new order, from where the robot is.
    fn send_leg(&mut self, now: Time, wanted: &WantedDrive, end: u64) {
        let Some(first) = self.progress.as_ref().map(|p| p.reached) else { return };
        let mut base: Vec<Waypoint> =
            wanted.waypoints.iter().filter(|w| (first..=end).contains(&w.serial)).copied().collect();
        if base.first().is_none_or(|w| w.serial != first) {
            return;
        }
        // What was done here is not done again.
        if self.progress.as_ref().is_some_and(|p| p.acted >= Some(first)) && base.len() > 1 {
            base[0].act = None;
        }
        let id = format!("{}-{first}", self.new_id());
        let act = base.last().and_then(|w| self.leg_act(&id, w));
        let before = self.state.as_ref().map(|(_, state)| state.last_sequence);
        let order = self.order_of(&id, 0, (first, &base), wanted, act.as_ref());
        self.order = OrderLife::Has(LegOrder {
            id,
            first,
            update: 0,
            base: end,
            known: first,
            sent: UpdateLife::Sent { times: 1, last: now },
            nodes: base.iter().map(|w| Some(w.node)).collect(),
            announces: order.nodes.last().is_some_and(|n| !n.released),
            act,
            before,
            complaints: self.complaints(),
            message: Some(order.clone()),
        });
        self.send_order(now, order);
    }

    /// Releases more of the order that the robot has.
    pub(super) fn send_update(&mut self, now: Time, wanted: &WantedDrive, end: u64) {
        let OrderLife::Has(leg) = &self.order else { return };
        let (id, first, base, update) = (leg.id.clone(), leg.first, leg.base, leg.update.saturating_add(1));
        let more: Vec<Waypoint> =
            wanted.waypoints.iter().filter(|w| (base..=end).contains(&w.serial)).copied().collect();
        if more.first().is_none_or(|w| w.serial != base) {
            return;
        }
        let act = more.last().filter(|_| end > base).and_then(|w| self.leg_act(&id, w));
        let order = self.order_of(&id, update, (first, &more), wanted, act.as_ref());
        let complaints = self.complaints();
        if let OrderLife::Has(leg) = &mut self.order {
            leg.complaints = complaints;
            leg.announces = order.nodes.last().is_some_and(|n| !n.released);
            leg.nodes.extend(more[1..].iter().map(|w| Some(w.node)));
            (leg.update, leg.base, leg.act) = (update, end, act);
            leg.sent = UpdateLife::Sent { times: 1, last: now };
            leg.message = Some(order.clone());
        }
        self.send_order(now, order);
    }

    fn send_order(&mut self, now: Time, order: Order) {
        (self.ordered, self.adopts) = (Some(now), None);
        self.tell(TopicKind::Order, Message::Order(order));
    }

    /// An order or update that releases these visits and announces some more. Only the last one has an action.
    fn order_of(
        &self,
        id: &str,
        update: u32,
        (first, base): (u64, &[Waypoint]),
        wanted: &WantedDrive,
        act: Option<&LegAct>,
    ) -> Order {
        let most = if act.is_some() { 0 } else { self.settings.horizon_nodes };
        // What is granted and beyond the longest base is announced first.
        let last = base.last().map_or(first, |w| w.serial);
        let held = wanted.waypoints.iter().filter(|w| w.serial > last).map(|w| w.node);
        let ahead: Vec<NodeId> = held.chain(wanted.horizon.iter().copied()).take(most).collect();
        let released = base.iter().map(|w| (w.serial, w.node, true));
        let announced = (last + 1..).zip(ahead).map(|(serial, node)| (serial, node, false));
        let all: Vec<(u64, NodeId, bool)> = released.chain(announced).collect();
        let sequence = |serial: u64| u32::try_from(2 * (serial - first)).unwrap_or(u32::MAX);
        let mut nodes: Vec<Node> = (all.iter())
            .map(|(serial, node, released)| Node {
                id: self.map.nodes[*node].name.clone(),
                sequence: sequence(*serial),
                released: *released,
                position: Some(self.place_of(self.map.nodes[*node].at)),
                actions: act
                    .filter(|a| a.serial == *serial)
                    .map(|a| a.action.clone())
                    .into_iter()
                    .flatten()
                    .collect(),
            })
            .collect();
        if update == 0 {
            self.begin_between(&mut nodes[0]);
        }
        debug_assert!(nodes[0].released, "an order begins where the robot may be");
        debug_assert!(
            nodes.is_sorted_by_key(|node| !node.released),
            "what is announced comes after the base"
        );
        let lanes = all.windows(2).map(|ends| (ends[0].1, ends[1].1));
        let edges = nodes.windows(2).zip(lanes).map(|(ends, (from, to))| Edge {
            max_speed_mps: self.slow_mps(),
            corridor: self.corridor(from, to).filter(|_| !is_temporary(&ends[0].id)),
            ..edge(&ends[0], &ends[1])
        });
        let edges = edges.collect();
        Order { id: id.to_owned(), update, nodes, edges }
    }

    /// A robot between two nodes begins at a temporary node where it stands.
    fn begin_between(&self, first: &mut Node) {
        let Some(pose) = self.motion.pose() else { return };
        let Some(node) = self.map.nodes.iter().find(|n| n.name == first.id) else { return };
        if (node.at - pose.at).norm() > ON_NODE_M {
            first.id = format!("~{}", first.id);
            first.position = Some(self.place_of(pose.at));
        }
    }

    fn complaints(&self) -> Vec<RobotError> {
        self.state.as_ref().map(|(_, state)| state.errors.clone()).unwrap_or_default()
    }

    fn place_of(&self, at: Point) -> NodePosition {
        let (_, state) = self.state.as_ref().expect("a robot is ready only once it was heard");
        let here = state.position.as_ref().map(|p| p.map.as_str());
        let frame = self.settings.maps.iter().find(|frame| Some(frame.name.as_str()) == here);
        let frame = frame.expect("a robot is ready only on a known map");
        let (x, y) = frame.to_robot(at);
        let deviation_m = Some(self.settings.deviation_m);
        NodePosition { x, y, theta: None, deviation_m, deviation_rad: None, map: frame.name.clone() }
    }

    /// Asks a robot that stands although it was released farther: the word that it passed a node may have been lost.
    pub(super) fn ask_where_it_stands(&mut self, now: Time) {
        const QUIET: Span = Span::from_secs(3);
        let (Some(progress), Some((heard, _))) = (&self.progress, &self.state) else { return };
        let is_on_its_way = progress.known > progress.reached && matches!(self.order, OrderLife::Has(_));
        let is_quiet = now - *heard >= QUIET && self.motion.stands();
        if is_on_its_way && is_quiet && !self.is_paused_by_us() {
            self.look_again(now);
        }
    }

    /// Looks after an update that the robot has not shown to have.
    fn mind_update(&mut self, now: Time) {
        let repeat = self.settings.repeat;
        let heard = self.state.as_ref().map(|(at, _)| *at);
        let OrderLife::Has(leg) = &mut self.order else { return };
        match leg.sent {
            UpdateLife::Taken => {}
            UpdateLife::Sent { times, last } if now - last >= TAKES => {
                leg.sent = UpdateLife::Doubted { times, asked: now };
                self.request_state(now);
            }
            UpdateLife::Sent { .. } => {}
            UpdateLife::Doubted { times, asked } if heard > Some(asked) => {
                match leg.message.clone().filter(|_| repeat == RepeatRule::Safe && times < TIMES) {
                    Some(message) => {
                        leg.sent = UpdateLife::Sent { times: times + 1, last: now };
                        self.tell(TopicKind::Order, Message::Order(message));
                    }
                    None => {
                        self.notice(Notice::NotTaken);
                        self.rejected = (self.rejected.0 + 1, "it does not take what it is sent".to_owned());
                        self.give_up(now);
                    }
                }
            }
            UpdateLife::Doubted { asked, .. } if now - asked >= TAKES => {
                self.look_again(now);
            }
            UpdateLife::Doubted { .. } => {}
        }
    }

    /// The robot has refused its order: it gets another one after a rest, three times at most.
    fn reject(&mut self, now: Time, words: String) {
        self.notice(Notice::Rejected { words: words.clone() });
        self.rejected = (self.rejected.0 + 1, words);
        self.give_up(now);
    }

    /// An order that was not taken is over. If an earlier update of it was, or the robot drives by another order of
    /// ours, that one is cancelled.
    fn give_up(&mut self, now: Time) {
        self.rests_until = now + RESTS;
        let OrderLife::Has(leg) = &self.order else { return };
        let drives = |(_, state): &(Time, Box<State>)| !state.nodes.is_empty() && self.is_ours(&state.order);
        if leg.update > 0 || self.state.as_ref().is_some_and(drives) {
            self.begin_cancel(now, None);
        } else {
            self.order = OrderLife::Idle;
        }
    }
}

fn edge(from: &Node, to: &Node) -> Edge {
    Edge {
        id: format!("{}-{}", from.id, to.id),
        sequence: from.sequence + 1,
        released: to.released,
        from: from.id.clone(),
        to: to.id.clone(),
        max_speed_mps: None,
        corridor: None,
        actions: Vec::new(),
    }
}

/// The robot's words against an order that it has not taken: a new complaint that is about orders, and neither about
/// another one nor about a cancel that found none.
pub(super) fn complaint(leg: &LegOrder, errors: &[RobotError]) -> Option<String> {
    const ABOUT: [&str; 8] = [
        "order",
        "validation",
        "route",
        "start_node",
        "unsupported",
        "node_unreachable",
        "unknown_map",
        "not_available",
    ];
    let is_about = |e: &RobotError| {
        let kind = e.kind.to_ascii_lowercase();
        let is_of_cancel = kind.replace('_', "") == "noordertocancel";
        let says = || ABOUT.iter().any(|word| kind.contains(word));
        !is_of_cancel && e.refers_to("orderId").map_or_else(says, |order| order == leg.id)
    };
    let new = errors.iter().find(|e| !leg.complaints.contains(e) && is_about(e))?;
    Some(match &new.description {
        Some(description) => format!("{}: {description}", new.kind),
        None => new.kind.clone(),
    })
}

/// Whether an id is that of a temporary node, from which the way to the next node is no lane.
fn is_temporary(node: &str) -> bool {
    node.starts_with('~')
}

/// Whether a robot means this node by a name: its own, or that of a temporary node near it.
fn is_name(node: &str, said: &str) -> bool {
    said == node || said.strip_prefix('~') == Some(node)
}

/// The serial number in an order's id, if the id is one of ours: `gw-BOOT-NUMBER-SERIAL`.
pub(super) fn first_of(order: &str) -> Option<u64> {
    let mut parts = order.strip_prefix("gw-")?.split('-');
    let _boot: u64 = parts.next()?.parse().ok()?;
    let _number: u64 = parts.next()?.parse().ok()?;
    let first = parts.next()?.parse().ok()?;
    parts.next().is_none().then_some(first)
}

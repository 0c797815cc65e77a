//! Whatever messages arrive in whatever order: the robot never drives beyond a released node, `nodeStates` shrink in
//! order, sequence numbers never go back within an order, and nothing panics.

use super::*;
use crate::model::state::{EStop, NodeLeft, OperatingMode, Position};
use crate::robot::{
    CancelHabit, GarbledMessage, MidwayUpdate, NodeStops, OtherOrder, PauseHabit, ReadingHabit, ReportedBase,
    RobotQuirks,
};
use proptest::prelude::*;
use serde_json::json;

/// Nodes stand so many metres apart, `n0` where the robot starts.
const APART_M: f64 = 3.0;

/// Something that happens to a robot.
#[derive(Clone, Debug)]
enum Happening {
    Order(Order),
    /// An update that fits what the robot has, as a master would send it: so many nodes more, so many released.
    Extend(usize, usize),
    Instant(&'static str, u8),
    Mode(OperatingMode),
    EStop(bool),
    Link(bool),
    GarbledMessage,
    Fault(bool),
    Reboot(u8),
    Pass(u32),
}

fn any_order() -> impl Strategy<Value = Order> {
    let kinds = ["pick", "drop", "detectObject", "waitForTrigger", "startCharging", "juggle"];
    let actions =
        proptest::collection::vec((prop::sample::select(kinds.to_vec()), 0..4usize, 0..8usize), 0..3);
    let shape = (0..3u8, 0..3u32, 0..4u32, 0..6i32, 1..6usize, 1..6usize);
    (shape, actions, prop::bool::ANY).prop_map(
        |((id, update, first, start, length, released), actions, back)| {
            let step = if back { -1 } else { 1 };
            let names: Vec<String> = (0..length as i32).map(|i| format!("n{}", start + step * i)).collect();
            let place = |i: usize| f64::from(start + step * i as i32) * APART_M;
            let nodes: Vec<(&str, f64)> =
                names.iter().enumerate().map(|(i, name)| (name.as_str(), place(i))).collect();
            let mut made = order(&format!("o{id}"), update, 2 * first, &nodes, released);
            for (i, (kind, blocking, node)) in actions.into_iter().enumerate() {
                let blocking =
                    [BlockingType::None, BlockingType::Soft, BlockingType::Single, BlockingType::Hard]
                        [blocking];
                let made_action =
                    Action { blocking, retriable: i == 0, ..action(kind, &format!("{id}{update}{i}")) };
                let node = node % made.nodes.len();
                made.nodes[node].actions.push(made_action);
            }
            made
        },
    )
}

fn any_happening() -> impl Strategy<Value = Happening> {
    use OperatingMode as Mode;
    let instants = [
        "startPause",
        "stopPause",
        "cancelOrder",
        "stateRequest",
        "factsheetRequest",
        "startCharging",
        "trigger",
        "clearInstantActions",
        "retry",
        "initPosition",
        "initializePosition",
        "juggle",
    ];
    let modes = [
        Mode::Automatic,
        Mode::Automatic,
        Mode::SemiAutomatic,
        Mode::Manual,
        Mode::Intervened,
        Mode::Service,
    ];
    prop_oneof![
        6 => any_order().prop_map(Happening::Order),
        6 => (0..5usize, 0..5usize).prop_map(|(more, released)| Happening::Extend(more, released)),
        5 => (prop::sample::select(instants.to_vec()), 0..30u8).prop_map(|(kind, id)| Happening::Instant(kind, id)),
        1 => prop::sample::select(modes.to_vec()).prop_map(Happening::Mode),
        1 => prop::bool::ANY.prop_map(Happening::EStop),
        1 => prop::bool::ANY.prop_map(Happening::Link),
        1 => Just(Happening::GarbledMessage),
        1 => prop::bool::ANY.prop_map(Happening::Fault),
        1 => (0..6u8).prop_map(Happening::Reboot),
        12 => (0..40u32).prop_map(Happening::Pass),
    ]
}

fn any_setup() -> impl Strategy<Value = RobotSetup> {
    let other_quirks = RobotQuirks {
        pause: PauseHabit::AtNextNode,
        cancel: CancelHabit::AtNextNode,
        midway_update: MidwayUpdate::Strands,
        node_stops: NodeStops::EachNode { dwell_us: 300_000 },
        ..RobotQuirks::default()
    };
    let standard = |version| RobotSetup::new(version, "maker", "r1", "lab", "n0");
    let mut beside = RobotSetup::like_b();
    (beside.quirks.reading, beside.quirks.reported_base) = (ReadingHabit::AtOnce, ReportedBase::Vanishes);
    prop::sample::select(vec![
        standard(Version::V2_0),
        standard(Version::V2_1),
        standard(Version::V3_0),
        RobotSetup { quirks: other_quirks, ..standard(Version::V3_0) },
        RobotSetup::like_a(),
        RobotSetup::like_b(),
        beside,
        RobotSetup::like_c(),
    ])
}

/// Watches a robot from outside: where accepted orders let it be, and what it says.
struct LawWatch {
    bench: RobotBench,
    /// Messages that may be accepted later, because some robots read late.
    sent: Vec<Order>,
    /// The last order that was seen accepted.
    held: Option<Order>,
    /// The stretch of the line that is released, metres.
    allowed: (f64, f64),
    read: usize,
    before: Option<State>,
}

impl LawWatch {
    fn new(setup: RobotSetup) -> LawWatch {
        let bench = RobotBench::new(setup);
        LawWatch { bench, sent: Vec::new(), held: None, allowed: (0.0, 0.0), read: 0, before: None }
    }

    fn happen(&mut self, happening: Happening) {
        match happening {
            Happening::Order(order) => self.send(order),
            Happening::Extend(more, released) => {
                if let Some(order) = self.held.as_ref().and_then(|held| extended(held, more, released)) {
                    self.send(order);
                }
            }
            Happening::Instant(kind, id) => {
                let place = [("x", json!(self.bench.x())), ("y", json!(0.0)), ("theta", json!(0.0))];
                let named = [("mapId", json!("lab")), ("actionId", json!("000"))];
                self.bench.instant_with(kind, &format!("i{id}"), &[&place[..], &named].concat());
            }
            Happening::Mode(mode) => self.bench.robot.robot.set_mode(mode),
            Happening::EStop(pressed) => {
                self.bench.robot.robot.set_e_stop(if pressed { EStop::Manual } else { EStop::None });
            }
            Happening::Link(true) => self.bench.robot.robot.find_broker(),
            Happening::Link(false) => self.bench.robot.robot.lose_broker(),
            Happening::GarbledMessage => {
                self.bench.robot.robot.receive_unreadable(crate::TopicKind::Order, GarbledMessage::NotJson);
            }
            Happening::Fault(is_faulty) => self.bench.robot.robot.set_handling_fault(is_faulty),
            Happening::Reboot(node) => self.reboot(node),
            Happening::Pass(ticks) => {
                for _ in 0..ticks {
                    self.bench.now_us += 100_000;
                    self.bench.hear(&[]);
                    self.check();
                }
            }
        }
        self.check();
    }

    fn send(&mut self, order: Order) {
        self.sent.push(order.clone());
        self.bench.order(&order);
    }

    fn reboot(&mut self, node: u8) {
        let x = f64::from(node) * APART_M;
        let position = Position { x, y: 0.0, theta: 0.0, map: "lab".to_owned(), localized: true };
        self.bench.robot.robot.reboot(position, &format!("n{node}"));
        self.bench.hear(&[]);
        self.allowed = (x, x);
        (self.held, self.before) = (None, None);
        self.sent.clear();
        self.read = self.bench.said.len();
    }

    fn check(&mut self) {
        let state = self.bench.state();
        let key = (state.order.clone(), state.update);
        if self.held.as_ref().map(|held| (held.id.clone(), held.update)) != Some(key.clone())
            && !key.0.is_empty()
        {
            self.accept(&key);
        }
        let x = self.bench.x();
        let slack_m = 1e-6;
        assert!(
            self.allowed.0 - slack_m <= x && x <= self.allowed.1 + slack_m,
            "{x} is outside of {:?}",
            self.allowed
        );
        assert!(self.bench.robot.body().report(Vec::new()).y.abs() < slack_m);
        let states: Vec<State> = (self.bench.said[self.read..].iter())
            .filter_map(|said| match &said.message {
                Message::State(state) => Some(state.as_ref().clone()),
                _ => None,
            })
            .collect();
        self.read = self.bench.said.len();
        for said in states {
            self.check_said(&said);
            self.before = Some(said);
        }
    }

    /// An accepted message widens what is released; a new order begins where the robot is. Most robots read at once, so
    /// it was the last one sent; for one that reads late it may be any of those with its id and number.
    fn accept(&mut self, key: &(String, u32)) {
        let setup = self.bench.robot.robot.setup();
        let goes_on = self.held.as_ref().is_some_and(|held| held.id == key.0);
        let x = self.bench.x();
        // Robot A stitches another order after its base, so what was released for it stays so.
        if !goes_on && setup.quirks.other_order == OtherOrder::Refused {
            self.allowed = (x, x);
        }
        let reads_at_once = setup.quirks.reading == ReadingHabit::AtOnce;
        let candidates = self.sent.iter().rev().filter(|order| order.id == key.0 && order.update == key.1);
        let candidates: Vec<&Order> = candidates.take(if reads_at_once { 1 } else { usize::MAX }).collect();
        for node in candidates.iter().flat_map(|order| &order.nodes).filter(|node| node.released) {
            let place = node.position.as_ref().expect("given").x;
            self.allowed = (self.allowed.0.min(place), self.allowed.1.max(place));
        }
        self.held = candidates.first().map(|order| (*order).clone());
        assert!(self.held.is_some(), "an order was accepted that was never sent");
    }

    fn check_said(&self, said: &State) {
        let Some(before) = &self.before else { return };
        if before.order != said.order {
            return;
        }
        assert!(before.update <= said.update);
        if before.update == said.update {
            let shrunk = before.nodes.len().checked_sub(said.nodes.len()).map(|n| &before.nodes[n..]);
            assert_eq!(shrunk, Some(&said.nodes[..]), "{before:?}\n{said:?}");
        }
        assert!(said.nodes.iter().map(|node| node.released).is_sorted_by(|a, b| a >= b));
        // Robot A drives the base of the order before under the next one's id, with the numbers of both.
        let has_own_numbers = self.bench.robot.robot.setup().quirks.other_order == OtherOrder::Refused;
        if has_own_numbers && !is_first(before) {
            assert!(before.last_sequence <= said.last_sequence, "{before:?}\n{said:?}");
            let follow = |pair: &[NodeLeft]| pair[1].sequence == pair[0].sequence + 2;
            assert!(said.nodes.windows(2).all(follow), "{said:?}");
            let is_hidden = self.bench.robot.robot.setup().quirks.reported_base == ReportedBase::Vanishes;
            let next = said.nodes.first().map_or(said.last_sequence + 2, |node| node.sequence);
            assert!(is_hidden || is_first(said) || next == said.last_sequence + 2, "{said:?}");
        }
    }
}

/// Whether a state is the first one of robots A and C after a new order, which still has the old place.
fn is_first(state: &State) -> bool {
    state.nodes.first().is_some_and(|node| node.sequence == 0)
}

/// An update that continues an order where its base ends.
fn extended(held: &Order, more: usize, released: usize) -> Option<Order> {
    let last = held.nodes.iter().rev().find(|node| node.released)?;
    let number = (last.position.as_ref()?.x / APART_M) as i32;
    let names: Vec<String> = (0..=more as i32).map(|i| format!("n{}", number + i)).collect();
    let places =
        names.iter().enumerate().map(|(i, name)| (name.as_str(), f64::from(number + i as i32) * APART_M));
    let places: Vec<(&str, f64)> = places.collect();
    let mut made = order(&held.id, held.update + 1, last.sequence, &places, released + 1);
    made.nodes[0] = last.clone();
    Some(made)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_arrives_the_robot_stays_on_what_is_released_and_nothing_goes_back(
        setup in any_setup(),
        happenings in prop::collection::vec(any_happening(), 1..60),
    ) {
        let mut watch = LawWatch::new(setup);
        happenings.into_iter().for_each(|happening| watch.happen(happening));
    }
}
